//! Cameras whose images are not flat: all directions, a cylinder around the eye, or the circle of a fisheye lens.

use crate::desc::{Panorama, PanoramaDesc};
use crate::math::Vec3;

/// From film coordinates to directions. The film's first two coordinates are in radians, but those of a fisheye in radii of its circle,
/// and the second of a cylinder in radii of the cylinder.
#[derive(Clone, Copy, Debug)]
pub(super) struct PanoramaView {
    kind: Panorama,
    right: Vec3,
    above: Vec3,
    forward: Vec3,
    /// Of a fisheye: the sine of a quarter of its angle.
    sine: f32,
}

impl PanoramaView {
    /// A view by these axes. The description has been checked.
    pub fn new(desc: &PanoramaDesc, [right, above, forward]: [Vec3; 3]) -> Self {
        let sine = (0.25 * desc.fov_deg).to_radians().sin() as f32;
        Self { kind: desc.kind, right, above, forward, sine }
    }

    /// Whether the image is a circle, beyond which nothing is seen.
    pub fn has_rim(&self) -> bool {
        self.kind == Panorama::Fisheye
    }

    /// Whether light arrives at this place of the film.
    pub fn sees(&self, film: Vec3) -> bool {
        !self.has_rim() || film.x * film.x + film.y * film.y <= 1.0
    }

    /// The unit direction that is seen at this place of the film; forward beyond the rim of a fisheye.
    pub fn direction(&self, film: Vec3) -> Vec3 {
        let [x, y] = [film.x, film.y];
        let (sin_x, cos_x) = x.sin_cos();
        let local = match self.kind {
            Panorama::Spherical => {
                let (sin_y, cos_y) = y.sin_cos();
                Vec3::new(cos_y * sin_x, sin_y, cos_y * cos_x)
            }
            Panorama::Cylindrical => Vec3::new(sin_x, y, cos_x),
            Panorama::Fisheye => {
                // r = sin(theta / 2) over that of the rim: as large a solid angle in each pixel.
                let half = self.sine * x.hypot(y);
                if half > 1.0 || !self.sees(film) {
                    return self.forward;
                }
                // sin theta = 2 sin(theta / 2) cos(theta / 2), along (x, y).
                let along = 2.0 * self.sine * (1.0 - half * half).sqrt();
                Vec3::new(along * x, along * y, 1.0 - 2.0 * half * half)
            }
        };
        (local.x * self.right + local.y * self.above + local.z * self.forward).normalize()
    }

    /// The place of the film at which a direction of any length is seen; `None` for one that is not seen.
    pub fn film(&self, direction: Vec3) -> Option<Vec3> {
        let [x, y, z] = [self.right, self.above, self.forward].map(|axis| direction.dot(axis));
        let length = direction.length();
        let film = match self.kind {
            Panorama::Spherical => Vec3::new(x.atan2(z), (y / length).clamp(-1.0, 1.0).asin(), 0.0),
            Panorama::Cylindrical => Vec3::new(x.atan2(z), y / x.hypot(z), 0.0),
            Panorama::Fisheye => {
                // sin(theta / 2) from the chord, without cancellation forwards.
                let chord = Vec3::new(x, y, z - length).length() / length;
                let flat = x.hypot(y);
                let radius = 0.5 * chord / self.sine;
                if flat > 0.0 { Vec3::new(radius * x / flat, radius * y / flat, 0.0) } else { Vec3::X * radius }
            }
        };
        (film.is_finite() && self.sees(film)).then_some(film)
    }
}
