//! Quadrics, clipped to a box in their own frame.

use super::ray::DRay;
use super::roots::quadratic;
use crate::math::{Bounds, DAffine3, DMat3, DVec3};

/// The surface p^T A p + 2 b.p + c = 0 inside a box, in a frame of its own.
#[derive(Clone, Copy, Debug)]
pub struct Quadric {
    a: DMat3,
    b: DVec3,
    c: f64,
    clip: Bounds,
    to_own: DAffine3,
    to_scene: DAffine3,
    bounds: Bounds,
    own_bounds: Bounds,
    size: f64,
}

/// Most Newton steps of [`Quadric::settle`].
const MOST_STEPS: usize = 8;

/// A point is on a face of the clip box within this fraction of the surface's extent.
const ON_FACE: f64 = 1e-9;

/// Faces of a clip box: -1 is the lower one of an axis, 1 the upper one, 0 none.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct ClipFaces([i8; 3]);

impl ClipFaces {
    /// The faces that both have.
    pub fn and(self, other: Self) -> Self {
        Self(std::array::from_fn(|axis| if self.0[axis] == other.0[axis] { self.0[axis] } else { 0 }))
    }
}

impl Quadric {
    /// A quadric from its ten coefficients (see [`crate::desc::ShapeDesc::Quadric`]), clip box and own frame to scene.
    ///
    /// `to_scene` must be invertible. A clip that is infinite along an axis is shrunk to the surface's own extent there;
    /// where the surface has none, the bounds stay infinite and the scene builder refuses them.
    pub fn new(coefficients: &[f64; 10], clip: Bounds, to_scene: DAffine3) -> Self {
        let [a, b, c, d, e, f, g, h, i, j] = *coefficients;
        let matrix = DMat3::from_cols(DVec3::new(a, d, f), DVec3::new(d, b, e), DVec3::new(f, e, c));
        let linear = DVec3::new(g, h, i);
        let own_bounds = own_bounds(matrix, linear, j, clip);
        let [x, y, z] = (own_bounds.max - own_bounds.min).to_array();
        let m = to_scene.matrix3;
        let size = 0.25 * (x * m.x_axis.length()).min(y * m.y_axis.length()).min(z * m.z_axis.length());
        Self {
            a: matrix,
            b: linear,
            c: j,
            clip,
            to_own: to_scene.inverse(),
            to_scene,
            bounds: own_bounds.transformed(&to_scene),
            own_bounds,
            size,
        }
    }

    /// The transform from the quadric's own frame to the scene.
    pub fn to_scene(&self) -> &DAffine3 {
        &self.to_scene
    }

    /// The same quadric where another transform places it. Its bounds and its size stay.
    pub(crate) fn placed(&self, to_scene: DAffine3) -> Self {
        Self { to_own: to_scene.inverse(), to_scene, ..*self }
    }

    /// The box around it in its own frame.
    pub(crate) fn own_bounds(&self) -> Bounds {
        self.own_bounds
    }

    /// The nearest t in (tnear, tfar) at which the ray intersects the clipped surface.
    pub fn intersect(&self, ray: &DRay) -> Option<f64> {
        let origin = self.to_own.transform_point3(ray.origin);
        let direction = self.to_own.transform_vector3(ray.direction);
        // Set up around the point of the ray nearest to the frame's origin: a far ray origin would cancel in c.
        let shift = -origin.dot(direction) / direction.length_squared();
        let base = origin + shift * direction;
        let a_direction = self.a * direction;
        let a_base = self.a * base;
        let (near, far) = quadratic(
            direction.dot(a_direction),
            base.dot(a_direction) + self.b.dot(direction),
            base.dot(a_base) + 2.0 * self.b.dot(base) + self.c,
        )?;
        [near, far].into_iter().find_map(|root| {
            let t = root + shift;
            let p = base + root * direction;
            let inside = p.cmpge(self.clip.min).all() && p.cmple(self.clip.max).all();
            (inside && t > ray.tnear && t < ray.tfar).then_some(t)
        })
    }

    /// `p` moved onto the surface along the gradient, and the outward (gradient) unit normal there.
    ///
    /// At a singular point such as a cone's apex, where the gradient vanishes, the normal is the first axis of the
    /// quadric's frame: finite, and as good as any.
    pub fn project(&self, p: DVec3) -> (DVec3, DVec3) {
        let mut own = self.to_own.transform_point3(p);
        let mut gradient = self.gradient(own);
        let slope2 = gradient.length_squared();
        if slope2 > 0.0 {
            // One Newton step: the point comes in with an error of a few ULP already.
            let moved = own - gradient * (self.value(own) / slope2);
            if moved.is_finite() {
                own = moved;
                gradient = self.gradient(own);
            }
        }
        self.in_scene(own, gradient)
    }

    /// A point of the surface and the outward unit normal there, from the point and the gradient in the own frame.
    #[inline]
    fn in_scene(&self, own: DVec3, gradient: DVec3) -> (DVec3, DVec3) {
        // Normals go by the inverse transpose of the frame's matrix.
        let normal = (self.to_own.matrix3.transpose() * gradient).try_normalize();
        (self.to_scene.transform_point3(own), normal.unwrap_or_else(|| self.to_scene.matrix3.x_axis.normalize()))
    }

    /// The point of the clipped surface near `p`, by some Newton steps along the gradient, and the outward unit normal there. A step that
    /// leaves the clip box goes on within the face that it met; `faces` are faces of the box in which it begins.
    pub(crate) fn settle(&self, p: DVec3, faces: ClipFaces) -> (DVec3, DVec3) {
        let mut own = self.to_own.transform_point3(p);
        let mut free = DVec3::ONE;
        let (low, high) = (self.clip.min.to_array(), self.clip.max.to_array());
        for (axis, face) in faces.0.into_iter().enumerate() {
            if face != 0 {
                own[axis] = if face < 0 { low[axis] } else { high[axis] };
                free[axis] = 0.0;
            }
        }
        for _ in 0..MOST_STEPS {
            let gradient = free * self.gradient(own);
            let slope2 = gradient.length_squared();
            let moved = own - gradient * (self.value(own) / slope2);
            if slope2 == 0.0 || !moved.is_finite() {
                break;
            }
            let kept = moved.clamp(self.clip.min, self.clip.max);
            for axis in 0..3 {
                if kept[axis] != moved[axis] {
                    free[axis] = 0.0;
                }
            }
            let is_settled = kept.distance(own) <= 4.0 * f64::EPSILON * own.abs().max_element();
            own = kept;
            if is_settled {
                break;
            }
        }
        self.in_scene(own, self.gradient(own))
    }

    /// The faces of the clip box on which a point of the surface lies.
    pub(crate) fn faces_at(&self, p: DVec3) -> ClipFaces {
        let own = self.to_own.transform_point3(p).to_array();
        let extent = (self.own_bounds.max - self.own_bounds.min).max_element();
        let is_at = |x: f64, bound: f64| (x - bound).abs() <= ON_FACE * extent;
        ClipFaces(std::array::from_fn(|axis| {
            let (low, high) = (self.clip.min[axis], self.clip.max[axis]);
            i8::from(is_at(own[axis], high)) - i8::from(is_at(own[axis], low))
        }))
    }

    /// A vector of the scene in cells of the grid of [`Self::triangles`].
    pub(crate) fn in_cells(&self, vector: DVec3, cells: u32) -> DVec3 {
        let step = (self.own_bounds.max - self.own_bounds.min) / f64::from(cells);
        self.to_own.transform_vector3(vector) / step
    }

    /// Bounding box of the clipped surface, scene frame; infinite where nothing bounds it.
    pub fn bounds(&self) -> Bounds {
        self.bounds
    }

    /// A length over which the normal may change: a quarter of the smallest extent along an axis of the quadric's own
    /// frame, which is half of a radius where the box fits.
    #[inline]
    pub(super) fn size(&self) -> f64 {
        self.size
    }

    /// Triangles inscribed in the clipped surface: a grid of `cells` along each axis divides its box into tetrahedra, and
    /// the surface cuts some of them in triangles.
    ///
    /// Source: Doi and Koide 1991, "An Efficient Method of Triangulating Equi-Valued Surfaces by Using Tetrahedral Cells".
    pub(crate) fn triangles(&self, cells: u32) -> Vec<[DVec3; 3]> {
        // Six tetrahedra around the diagonal of each cell, by the order in which its axes are traversed.
        const WALKS: [[usize; 3]; 6] = [[0, 1, 2], [0, 2, 1], [1, 0, 2], [1, 2, 0], [2, 0, 1], [2, 1, 0]];
        let bounds = own_bounds(self.a, self.b, self.c, self.clip);
        let step = (bounds.max - bounds.min) / f64::from(cells);
        let place = |i: [u32; 3]| bounds.min + step * DVec3::new(i[0].into(), i[1].into(), i[2].into());
        let mut triangles = Vec::new();
        for x in 0..cells {
            for y in 0..cells {
                for z in 0..cells {
                    for walk in WALKS {
                        let mut at = [x, y, z];
                        let mut corners = [place(at); 4];
                        for (corner, axis) in corners[1..].iter_mut().zip(walk) {
                            at[axis] += 1;
                            *corner = place(at);
                        }
                        self.cut(&corners, &mut triangles);
                    }
                }
            }
        }
        triangles
    }

    /// Appends the triangles in which the surface cuts a tetrahedron. The corners are in the quadric's own frame, the
    /// triangles in the scene frame.
    fn cut(&self, corners: &[DVec3; 4], triangles: &mut Vec<[DVec3; 3]>) {
        let values = corners.map(|p| self.value(p));
        let (mut inside, mut outside) = (Vec::with_capacity(4), Vec::with_capacity(4));
        for (corner, value) in corners.iter().zip(values) {
            if value < 0.0 { inside.push(*corner) } else { outside.push(*corner) }
        }
        let crossing = |a: DVec3, b: DVec3| self.to_scene.transform_point3(self.between(a, b));
        match (&inside[..], &outside[..]) {
            (&[a], &[b, c, d]) | (&[b, c, d], &[a]) => triangles.push([crossing(a, b), crossing(a, c), crossing(a, d)]),
            (&[a, b], &[c, d]) => {
                let [ac, ad, bc, bd] = [crossing(a, c), crossing(a, d), crossing(b, c), crossing(b, d)];
                triangles.extend([[ac, ad, bd], [ac, bd, bc]]);
            }
            _ => {}
        }
    }

    /// The point of the surface between two points on different sides of it; the same whichever comes first.
    fn between(&self, a: DVec3, b: DVec3) -> DVec3 {
        let (mut low, mut high) = if self.value(a) < 0.0 { (a, b) } else { (b, a) };
        for _ in 0..60 {
            let middle = 0.5 * (low + high);
            if self.value(middle) < 0.0 { low = middle } else { high = middle }
        }
        high
    }

    fn value(&self, p: DVec3) -> f64 {
        p.dot(self.a * p) + 2.0 * self.b.dot(p) + self.c
    }

    /// The mean curvature at a point of the scene frame, from gradient and second derivatives of the implicit function there; 0 where
    /// the gradient vanishes.
    ///
    /// Source: Goldman 2005, "Curvature Formulas for Implicit Curves and Surfaces", Eq. 4.2.
    pub fn mean_curvature(&self, p: DVec3) -> f64 {
        let matrix = self.to_own.matrix3;
        let gradient = matrix.transpose() * self.gradient(self.to_own.transform_point3(p));
        let second = matrix.transpose() * (2.0 * self.a) * matrix;
        let length = gradient.length();
        let normal = gradient / length;
        let trace = second.x_axis.x + second.y_axis.y + second.z_axis.z;
        let curvature = (trace - normal.dot(second * normal)) / (2.0 * length);
        if curvature.is_finite() { curvature } else { 0.0 }
    }

    /// Gradient of the implicit function.
    fn gradient(&self, p: DVec3) -> DVec3 {
        2.0 * (self.a * p + self.b)
    }
}

/// The box around the surface in its own frame: the clip box, shrunk to the ellipsoid where the surface is one.
fn own_bounds(a: DMat3, b: DVec3, c: f64, clip: Bounds) -> Bounds {
    // With M the inverse of A, centre m = -M b and k = b.M b - c, the extent along axis i is sqrt(k M_ii).
    let inverse = a.inverse();
    let centre = -(inverse * b);
    let k = b.dot(inverse * b) - c;
    let extent2 = k * DVec3::new(inverse.x_axis.x, inverse.y_axis.y, inverse.z_axis.z);
    let definite = {
        let minor1 = a.x_axis.x;
        let minor2 = a.x_axis.x * a.y_axis.y - a.x_axis.y * a.x_axis.y;
        let minor3 = a.determinant();
        (minor1 > 0.0 && minor2 > 0.0 && minor3 > 0.0) || (minor1 < 0.0 && minor2 > 0.0 && minor3 < 0.0)
    };
    if !definite || !extent2.is_finite() || extent2.min_element() < 0.0 {
        return clip;
    }
    // Slightly enlarged: the bounds must hold the surface in spite of rounding.
    let extent = extent2.map(f64::sqrt) * (1.0 + 1e-12);
    Bounds { min: clip.min.max(centre - extent), max: clip.max.min(centre + extent) }
}

#[cfg(test)]
mod tests {
    use super::*;

    const EVERYWHERE: Bounds = Bounds { min: DVec3::NEG_INFINITY, max: DVec3::INFINITY };

    fn hit(coefficients: [f64; 10], origin: DVec3, direction: DVec3) -> Option<f64> {
        Quadric::new(&coefficients, EVERYWHERE, DAffine3::IDENTITY).intersect(&DRay {
            origin,
            direction,
            tnear: 0.0,
            tfar: f64::INFINITY,
        })
    }

    fn near(got: Option<f64>, expected: f64) {
        let got = got.unwrap_or(f64::NAN);
        assert!((got / expected - 1.0).abs() < 1e-13, "{got} instead of {expected}");
    }

    #[test]
    fn nearest_roots() {
        let cylinder = [1.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, -1.0];
        near(hit(cylinder, DVec3::new(10.0, 0.0, 0.6), DVec3::new(-1.0, 1e-3, 0.0)), 9.2);
        assert_eq!(hit(cylinder, DVec3::new(0.5, -3.0, 0.0), DVec3::Y), None, "along the axis");
        let paraboloid = [1.0, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, -0.5, 0.0];
        near(hit(paraboloid, DVec3::new(1e-4, 0.0, 5.0), DVec3::new(1e-3, 0.0, -1.0)), 4.999_973_990_265_3);
        let hyperboloid = [1.0, 1.0, -1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, -1.0];
        near(hit(hyperboloid, DVec3::new(0.0, -4.0, 2.0), DVec3::new(0.1, 1.0, 0.25)), 1.440_755_284_555_7);
        let ellipsoid = [1.0 / 9.0, 1.0, 1e4, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, -1.0];
        near(hit(ellipsoid, DVec3::new(1.2, 0.3, 5.0), DVec3::NEG_Z), 5.0 - 0.008_660_254_037_844_4);
        let cone = [1.0, 1.0, -1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0];
        near(hit(cone, DVec3::new(0.25, 0.0, -3.0), DVec3::Z), 2.75);
        near(hit(cone, DVec3::new(0.0, 0.0, -3.0), DVec3::Z), 3.0);
    }

    #[test]
    fn apex_has_a_finite_normal() {
        let cone = Quadric::new(
            &[1.0, 1.0, -1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0],
            EVERYWHERE,
            DAffine3::from_scale(DVec3::new(1.0, 2.0, 3.0)),
        );
        let (p, n) = cone.project(DVec3::ZERO);
        assert_eq!(p, DVec3::ZERO);
        assert!((n.length() - 1.0).abs() < 1e-15);
    }

    #[test]
    fn ellipsoid_bounds_itself() {
        let ellipsoid = [1.0 / 9.0, 1.0, 1e4, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, -1.0];
        let bounds = Quadric::new(&ellipsoid, EVERYWHERE, DAffine3::IDENTITY).bounds();
        assert!((bounds.max - DVec3::new(3.0, 1.0, 0.01)).abs().max_element() < 1e-11, "{bounds:?}");
    }
}
