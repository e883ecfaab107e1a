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

/// Where a lens is in focus: a plane across the view direction.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum FocusDesc {
    /// The plane through the point that the camera looks at.
    #[default]
    LookAt,
    /// The plane at this distance from the eye along the view direction, in scene units, above 0.
    Distance(f64),
    /// The plane through this point, which is in front of the camera.
    Point(DVec3),
}

/// A thin lens: what is off its plane of focus is blurred.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LensDesc {
    /// Radius of the aperture in scene units, 0 or more. 0 is a pinhole.
    pub radius: f64,
    /// Where things are sharp.
    pub focus: FocusDesc,
    /// Number of sides of the aperture, a regular polygon that is inscribed in the circle of `radius`: 3 to
    /// [`MAX_BLADES`]. 0 is the whole disk.
    pub blades: u32,
    /// Degrees by which the polygon is turned counter-clockwise in the image. At 0, one of its vertices is at the right.
    pub blade_rotation_deg: f64,
    /// Number by which the aperture's width is divided, after it is turned. Above 1, the aperture is taller than wide.
    pub squeeze: f64,
}

/// Greatest number of blades of an aperture; with more, it could not be told from a disk.
pub const MAX_BLADES: u32 = 32;

impl LensDesc {
    /// A round lens that is in focus at the point that the camera looks at.
    pub fn new(radius: f64) -> Self {
        Self { radius, focus: FocusDesc::LookAt, blades: 0, blade_rotation_deg: 0.0, squeeze: 1.0 }
    }
}

/// Least and greatest shift of a film, in its sides.
pub(crate) const SHIFTS: [f64; 2] = [-100.0, 100.0];

/// Least and greatest width of a pixel over its height.
pub(crate) const PIXEL_ASPECTS: [f64; 2] = [0.01, 100.0];

/// The flat film of a camera: where it is, and what its pixels look like.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FilmDesc {
    /// How far the film is moved against the view axis: to the right in widths of the image and upwards in heights of the image, each
    /// from -100 to 100. With `[0.0, 0.5]` the point that the camera looks at is in the middle of the lower edge. The film stays across
    /// the view direction, so that lines across that direction stay parallel in the image, and the plane in focus stays too.
    pub shift: [f64; 2],
    /// Width of a pixel over its height, 0.01 to 100. The side of the image that has no angle or length of its own follows from it and
    /// from the resolution.
    pub pixel_aspect: f64,
}

impl Default for FilmDesc {
    /// A film whose middle the view axis meets, with square pixels.
    fn default() -> Self {
        Self { shift: [0.0; 2], pixel_aspect: 1.0 }
    }
}

/// How the surroundings of a camera lie in its image.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Panorama {
    /// All directions: longitude across the width, latitude across the height, whatever the resolution.
    Spherical,
    /// The mantle of a cylinder around the eye, upright in the image: angles across the width, and as high as pixels that are square
    /// at the horizon make it.
    Cylindrical,
    /// The equisolid projection: the sine of half the angle from the view direction grows as the distance from the middle of the image,
    /// so that every pixel sees the same solid angle. The image is a circle, black beyond.
    Fisheye,
}

/// A view that is not flat.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PanoramaDesc {
    /// Which.
    pub kind: Panorama,
    /// Full angle in degrees: 360 for [`Panorama::Spherical`]; across the width, in (0, 360], for [`Panorama::Cylindrical`]; across
    /// the circle, in (0, 360], for [`Panorama::Fisheye`].
    pub fov_deg: f64,
    /// The side of the image that the circle of a fisheye spans; without meaning for others.
    pub fov_axis: FovAxis,
    /// Width of a pixel over its height as [`FilmDesc::pixel_aspect`] has it; 1 for [`Panorama::Spherical`], which fills any resolution.
    pub pixel_aspect: f64,
}

impl PanoramaDesc {
    /// A view of its usual angle: 180 degrees for a fisheye, which spans the height, and 360 for others.
    pub fn new(kind: Panorama) -> Self {
        let fov_deg = if kind == Panorama::Fisheye { 180.0 } else { 360.0 };
        Self {
            kind,
            fov_deg,
            fov_axis: if kind == Panorama::Fisheye { FovAxis::Vertical } else { FovAxis::Horizontal },
            pixel_aspect: 1.0,
        }
    }

    /// Whether the angle is one that the view can have.
    pub(crate) fn is_possible(&self) -> bool {
        match self.kind {
            Panorama::Spherical => self.fov_deg == 360.0,
            Panorama::Cylindrical | Panorama::Fisheye => self.fov_deg > 0.0 && self.fov_deg <= 360.0,
        }
    }
}

/// A camera. Lengths are in scene units, the frame is right-handed, and angles are in degrees.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum CameraDesc {
    /// A pinhole at `eye`.
    Perspective {
        /// Eye point.
        eye: DVec3,
        /// A point that is seen in the middle of the image, or off it by [`FilmDesc::shift`].
        look_at: DVec3,
        /// The direction that is up in the image. It has any length and is not parallel to the view direction.
        up: DVec3,
        /// Full angle across `fov_axis` in degrees, in (0, 180).
        fov_deg: f64,
        /// The side that `fov_deg` spans.
        fov_axis: FovAxis,
        /// The film.
        film: FilmDesc,
    },
    /// A thin lens around `eye`, whose other fields are those of a pinhole. The lens does not change where things are in
    /// the image.
    ThinLens {
        /// The middle of the lens.
        eye: DVec3,
        /// A point that is seen in the middle of the image, or off it by [`FilmDesc::shift`].
        look_at: DVec3,
        /// The direction that is up in the image. It has any length and is not parallel to the view direction.
        up: DVec3,
        /// Full angle across `fov_axis` in degrees, in (0, 180).
        fov_deg: f64,
        /// The side that `fov_deg` spans.
        fov_axis: FovAxis,
        /// Aperture and focus.
        lens: LensDesc,
        /// The film.
        film: FilmDesc,
    },
    /// Parallel rays, which start on the plane through `eye` across the view direction. What is behind the plane is not
    /// seen.
    Orthographic {
        /// The middle of the image on the plane.
        eye: DVec3,
        /// A point that is seen in the middle of the image, or off it by [`FilmDesc::shift`].
        look_at: DVec3,
        /// The direction that is up in the image. It has any length and is not parallel to the view direction.
        up: DVec3,
        /// What the image spans across `axis`, in scene units, above 0.
        size: f64,
        /// The side that `size` spans.
        axis: FovAxis,
        /// The film, which is the plane through `eye`.
        film: FilmDesc,
    },
    /// A pinhole at `eye` whose image is not flat.
    Panoramic {
        /// Eye point.
        eye: DVec3,
        /// A point that is seen in the middle of the image.
        look_at: DVec3,
        /// The direction that is up in the image. It has any length and is not parallel to the view direction.
        up: DVec3,
        /// What of the surroundings is seen, and how it lies in the image.
        panorama: PanoramaDesc,
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

impl CameraDesc {
    /// The position (of a view plane, its centre), the point that is looked at, and the direction that is up.
    pub fn view(&self) -> [DVec3; 3] {
        let mut camera = *self;
        camera.view_mut().map(|vector| *vector)
    }

    /// The vectors of [`Self::view`], to be changed.
    pub fn view_mut(&mut self) -> [&mut DVec3; 3] {
        match self {
            Self::Perspective { eye, look_at, up, .. }
            | Self::ThinLens { eye, look_at, up, .. }
            | Self::Orthographic { eye, look_at, up, .. }
            | Self::Panoramic { eye, look_at, up, .. }
            | Self::ViewPlane { centre: eye, look_at, up, .. } => [eye, look_at, up],
        }
    }

    /// The flat film; `None` for a camera that has none or, a view plane, whose film follows from the rest.
    pub fn film(&self) -> Option<FilmDesc> {
        match *self {
            Self::Perspective { film, .. } | Self::ThinLens { film, .. } | Self::Orthographic { film, .. } => {
                Some(film)
            }
            Self::Panoramic { .. } | Self::ViewPlane { .. } => None,
        }
    }

    /// Width of a pixel over its height.
    pub fn pixel_aspect(&self) -> f64 {
        match self {
            Self::Panoramic { panorama, .. } => panorama.pixel_aspect,
            _ => self.film().unwrap_or_default().pixel_aspect,
        }
    }

    /// The angle of view in degrees; `None` for parallel rays.
    pub fn fov_deg(&self) -> Option<f64> {
        match *self {
            Self::Perspective { fov_deg, .. } | Self::ThinLens { fov_deg, .. } | Self::ViewPlane { fov_deg, .. } => {
                Some(fov_deg)
            }
            Self::Panoramic { panorama, .. } => Some(panorama.fov_deg),
            Self::Orthographic { .. } => None,
        }
    }
}

impl Default for CameraDesc {
    fn default() -> Self {
        Self::Perspective {
            eye: DVec3::ZERO,
            look_at: DVec3::NEG_Z,
            up: DVec3::Y,
            fov_deg: 90.0,
            fov_axis: FovAxis::Horizontal,
            film: FilmDesc::default(),
        }
    }
}
