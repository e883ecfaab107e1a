//! Triangles as emitters see them. (Rays meet them in Embree.)

use crate::math::Vec3;

/// A triangle with its normal and area, scene frame.
#[derive(Clone, Copy, Debug)]
pub struct Triangle {
    /// First vertex.
    pub v0: Vec3,
    /// Second vertex minus the first.
    pub e1: Vec3,
    /// Third vertex minus the first.
    pub e2: Vec3,
    /// Unit normal, e1 x e2 normalised.
    pub normal: Vec3,
    /// Area.
    pub area: f32,
}

impl Triangle {
    /// The triangle of three vertices, or `None` where it has no area.
    pub fn new([v0, v1, v2]: [Vec3; 3]) -> Option<Self> {
        // Differences and cross product in f64: a needle's normal is lost in f32.
        let [d0, d1, d2] = [v0, v1, v2].map(|v| v.as_dvec3());
        let cross = (d1 - d0).cross(d2 - d0);
        let length = cross.length();
        let area = (0.5 * length) as f32;
        if !(length > 0.0 && length.is_finite() && area > 0.0 && area.is_finite()) {
            return None;
        }
        Some(Self { v0, e1: (d1 - d0).as_vec3a(), e2: (d2 - d0).as_vec3a(), normal: (cross / length).as_vec3a(), area })
    }

    /// Its vertices.
    #[inline]
    pub fn vertices(&self) -> [Vec3; 3] {
        [self.v0, self.v0 + self.e1, self.v0 + self.e2]
    }
}
