//! Triangles of emitters. (Embree intersects rays with triangles.)

use crate::math::{DVec3, Vec3};

/// A triangle with its normal and area, scene frame.
#[derive(Clone, Copy, Debug)]
pub struct Triangle {
    /// The vertices as they were given. Sides stored instead of vertices would be rounded, which matters for a point
    /// close to the triangle.
    pub vertices: [Vec3; 3],
    /// Unit normal, along (v1 - v0) x (v2 - v0).
    pub normal: Vec3,
    /// Area.
    pub area: f32,
    /// (v1 - v0) x (v2 - v0) in double precision: twice the area along the normal.
    cross: DVec3,
}

/// The middles of the `steps`^2 equal triangles into which lines parallel to the sides divide a triangle, as the weights of its second
/// and third corner: points at which a function is averaged over the triangle.
pub fn centroids(steps: u32) -> impl Iterator<Item = [f32; 2]> {
    let step = 1.0 / (3.0 * steps as f32);
    let places = (0..steps).flat_map(move |i| (0..steps - i).map(move |j| (i, j)));
    places.flat_map(move |(i, j)| {
        // The small triangle that is upright, and the one beside it that stands on its tip.
        let [s, t] = [i, j].map(|k| (3 * k + 1) as f32 * step);
        let tip = (i + j + 1 < steps).then_some([s + step, t + step]);
        [Some([s, t]), tip].into_iter().flatten()
    })
}

impl Triangle {
    /// The triangle of three vertices, or `None` where it has no area.
    pub fn new(vertices: [Vec3; 3]) -> Option<Self> {
        // Differences and cross product in f64: a needle's normal is lost in f32.
        let [v0, v1, v2] = vertices.map(Vec3::as_dvec3);
        let cross = (v1 - v0).cross(v2 - v0);
        let length = cross.length();
        let area = (0.5 * length) as f32;
        if !(length > 0.0 && length.is_finite() && area > 0.0 && area.is_finite()) {
            return None;
        }
        Some(Self { vertices, normal: (cross / length).as_vec3a(), area, cross })
    }

    /// The two sides that leave the first vertex.
    #[inline]
    pub fn sides(&self) -> [Vec3; 2] {
        let [v0, v1, v2] = self.vertices;
        [v1 - v0, v2 - v0]
    }

    /// The point with these barycentric coordinates of the second and third vertex.
    #[inline]
    pub fn at(&self, b1: f32, b2: f32) -> Vec3 {
        let [e1, e2] = self.sides();
        self.vertices[0] + b1 * e1 + b2 * e2
    }

    /// Twice the area times the height of `p` over the plane, on the normal's side.
    ///
    /// The result is in double precision: seen nearly edge-on, from far away or from close by, the height is a small
    /// fraction of the distance to the vertices, and a normal rounded to single precision gives it only to that
    /// fraction of a ten-millionth.
    #[inline]
    pub fn height_by_twice_area(&self, p: Vec3) -> f64 {
        (p.as_dvec3() - self.vertices[0].as_dvec3()).dot(self.cross)
    }
}
