//! Thin lenses: points on an aperture.

use crate::desc::{FocusDesc, LensDesc, MAX_BLADES};
use crate::math::{DVec3, Vec3};
use crate::sampling::warps;
use crate::{Error, Result};

/// A thin lens with its plane of focus, in the scene frame.
///
/// Source: Cook, Porter, Carpenter 1984, "Distributed Ray Tracing"; Pharr, Jakob, Humphreys, *Physically Based Rendering*
/// 4e, Sec. 5.2.3.
#[derive(Clone, Copy, Debug)]
pub(super) struct Lens {
    aperture: Aperture,
    /// From the middle of the lens to the edge of its circle, to the right and upwards in the image; squeezed.
    right: Vec3,
    above: Vec3,
    /// One over the distance of the plane in focus along the view direction.
    inverse_focus: f32,
}

/// The shape of an aperture in the unit circle, before it is squeezed.
#[derive(Clone, Copy, Debug)]
enum Aperture {
    Disk,
    /// Number of sides, and the angle of a vertex in radians.
    Polygon(f32, f32),
}

impl Lens {
    /// The lens of a camera with these unit axes (to the right, upwards and forward), which is at `eye` and looks at the point
    /// `to_target` from it; `None` for a radius of 0, which is a pinhole.
    pub fn new(
        desc: &LensDesc,
        [right, above, forward]: [DVec3; 3],
        to_target: DVec3,
        eye: DVec3,
    ) -> Result<Option<Self>> {
        let invalid = |key: &str, message: String| Err(Error::invalid(format!("camera.{key}"), message));
        if !(desc.radius >= 0.0 && desc.radius.is_finite()) {
            return invalid("lensRadius", format!("{} is no radius", desc.radius));
        }
        if desc.radius == 0.0 {
            return Ok(None);
        }
        let (key, distance) = match desc.focus {
            FocusDesc::LookAt => ("lookAt", to_target.dot(forward)),
            FocusDesc::Distance(distance) => ("focusDistance", distance),
            FocusDesc::Point(point) => ("focusAt", (point - eye).dot(forward)),
        };
        if distance.is_nan() || distance <= 0.0 {
            return invalid(key, format!("the plane in focus is at {distance}, expected one in front of the camera"));
        }
        if !matches!(desc.blades, 0 | 3..=MAX_BLADES) || !desc.blade_rotation_deg.is_finite() {
            let message = format!("{} turned by {} degrees are no polygon", desc.blades, desc.blade_rotation_deg);
            return invalid("blades", message);
        }
        let lens = Self {
            aperture: match desc.blades {
                0 => Aperture::Disk,
                blades => Aperture::Polygon(blades as f32, (desc.blade_rotation_deg % 360.0).to_radians() as f32),
            },
            right: (desc.radius / desc.squeeze * right).as_vec3a(),
            above: (desc.radius * above).as_vec3a(),
            inverse_focus: (1.0 / distance) as f32,
        };
        let [x, y] = [lens.right, lens.above].map(|axis| (axis * lens.inverse_focus).length());
        if !(x.is_finite() && y.is_finite() && desc.squeeze > 0.0) {
            let message = "the lens is too large or too near to its plane of focus for single precision";
            return invalid("lensRadius", message.to_owned());
        }
        Ok(Some(lens))
    }

    /// The point on the lens for `u` in [0, 1)^2, from the middle of the lens, and the direction from there to where the ray through
    /// the middle with direction `to_film` meets the plane in focus; `to_film` is 1 long along the view direction.
    #[inline]
    pub fn ray(&self, to_film: Vec3, u: [f32; 2]) -> (Vec3, Vec3) {
        let [x, y] = self.aperture.point(u);
        let point = x * self.right + y * self.above;
        // All over the distance of the plane, so that the sum keeps its digits however far that is.
        (point, to_film - point * self.inverse_focus)
    }
}

impl Aperture {
    /// The point for `u`, uniform by area.
    #[inline]
    fn point(self, u: [f32; 2]) -> [f32; 2] {
        match self {
            Self::Disk => warps::uniform_disk(u),
            Self::Polygon(sides, angle) => {
                let [x, y] = warps::uniform_polygon(u, sides);
                let (sin, cos) = angle.sin_cos();
                [cos * x - sin * y, sin * x + cos * y]
            }
        }
    }
}
