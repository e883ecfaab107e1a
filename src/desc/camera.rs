//! Descriptions of cameras.

use crate::math::DVec3;

/// The side of the image that the field of view spans.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum FovAxis {
    /// The width.
    #[default]
    Horizontal,
    /// The height.
    Vertical,
}

/// A camera. Lengths are in scene units, the frame is right-handed, and angles are in degrees.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum CameraDesc {
    /// A pinhole at `eye`.
    Perspective {
        /// Eye point.
        eye: DVec3,
        /// A point that is seen in the middle of the image.
        look_at: DVec3,
        /// The direction that is up in the image. It has any length and is not parallel to the view direction.
        up: DVec3,
        /// Full angle across `fov_axis` in degrees, in (0, 180).
        fov_deg: f64,
        /// The side that `fov_deg` spans.
        fov_axis: FovAxis,
    },
    /// The report's camera: a view plane with the eye behind it. Surfaces between the eye and the plane are not seen.
    ///
    /// With w = normalize(look_at - centre), u = w x up (not normalised) and aspect A, the plane is |u| sqrt(A) wide
    /// and |u| / sqrt(A) high on each side of its centre, and the eye |u| sqrt(A) / tan(fov / 2) behind it.
    ViewPlane {
        /// Centre of the view plane.
        centre: DVec3,
        /// A point that is seen in the middle of the image.
        look_at: DVec3,
        /// The direction that is up in the image. Its length scales the plane.
        up: DVec3,
        /// Full horizontal angle in degrees, in (0, 180).
        fov_deg: f64,
    },
}

impl Default for CameraDesc {
    fn default() -> Self {
        Self::Perspective {
            eye: DVec3::ZERO,
            look_at: DVec3::NEG_Z,
            up: DVec3::Y,
            fov_deg: 90.0,
            fov_axis: FovAxis::Horizontal,
        }
    }
}
