//! Triangles as seen from a point.

use crate::math::{DVec3, Vec3};

/// Solid angle (sr) of a triangle given by its vertices relative to the point it is seen from, in any order; 0 for a
/// degenerate triangle or one seen edge-on, NaN for vertices that are not numbers. 2 pi for a triangle the point lies
/// in.
///
/// The triple product is formed from differences of vertices, so that small and far triangles keep their digits.
/// Source: Van Oosterom and Strackee 1983, "The Solid Angle of a Plane Triangle".
pub fn triangle_solid_angle(v: [Vec3; 3]) -> f64 {
    solid_angle(v.map(Vec3::as_dvec3))
}

/// The same in double precision.
pub(crate) fn solid_angle([a, b, c]: [DVec3; 3]) -> f64 {
    let (la, lb, lc) = (a.length(), b.length(), c.length());
    let triple = a.dot((b - a).cross(c - a)).abs();
    let denominator = la * lb * lc + a.dot(b) * lc + b.dot(c) * la + c.dot(a) * lb;
    2.0 * triple.atan2(denominator)
}

/// A triangle seen from a point, to be sampled uniformly by solid angle.
///
/// Arvo's construction: a first number cuts off a subtriangle with that fraction of the solid angle, and a second one
/// picks a point on the cut. The cut follows from tangents of half sides, without any difference of angles, so that the
/// construction works from triangles of 1e-12 sr up to almost a hemisphere.
///
/// Source: Arvo 1995, "Stratified Sampling of Spherical Triangles"; half-angle form of the area: Todhunter 1886,
/// *Spherical Trigonometry*, Ch. VIII.
#[derive(Clone, Copy, Debug)]
pub struct SphericalTriangle {
    v: [DVec3; 3],
    /// Unit vectors to the vertices.
    a: DVec3,
    b: DVec3,
    /// Unit tangent at `a` towards the third vertex.
    tangent: DVec3,
    /// tan of half the side from a to b.
    tan_half_ab: f64,
    /// Sine and cosine of the angle at a.
    sin_a: f64,
    cos_a: f64,
    solid_angle: f64,
}

/// Below this solid angle, sampling by area is as good and numerically safer.
const SMALLEST_SOLID_ANGLE: f64 = 1e-12;

/// Just below a hemisphere, which a triangle fills for a point inside it.
const LARGEST_SOLID_ANGLE: f64 = std::f64::consts::TAU - 1e-9;

impl SphericalTriangle {
    /// A triangle given by its vertices relative to the point it is seen from, in any order.
    ///
    /// `None` where sampling by solid angle makes no sense or would lose its digits: degenerate triangles, triangles
    /// seen edge-on or from within their own plane, and solid angles below 1e-12 sr. Sample those by area; their
    /// density is then distance^2 / (area cos(theta)).
    pub fn new(v: [Vec3; 3]) -> Option<Self> {
        Self::around_origin(v.map(Vec3::as_dvec3))
    }

    /// As [`SphericalTriangle::new`], for vertices in the same frame as `p`. The differences are exact: rounded to
    /// single precision, those to the far vertices of a large triangle would move it against a point close to it.
    pub fn seen_from(p: Vec3, vertices: [Vec3; 3]) -> Option<Self> {
        let p = p.as_dvec3();
        Self::around_origin(vertices.map(|v| v.as_dvec3() - p))
    }

    fn around_origin(v: [DVec3; 3]) -> Option<Self> {
        let solid_angle = solid_angle(v);
        // A range holds no NaN.
        if !(SMALLEST_SOLID_ANGLE..LARGEST_SOLID_ANGLE).contains(&solid_angle) {
            return None;
        }
        let [v0, v1, v2] = v;
        let (l0, l1, l2) = (v0.length(), v1.length(), v2.length());
        let a = v0 / l0;
        let b = v1 / l1;
        // Normals of the planes through two sides, as differences again; both contain a.
        let ab = v0.cross(v1 - v0) / (l0 * l1);
        let ac = v0.cross(v2 - v0) / (l0 * l2);
        let (sin_ab, sin_ac) = (ab.length(), ac.length());
        let scale = 1.0 / (sin_ab * sin_ac);
        let sin_a = v0.dot((v1 - v0).cross(v2 - v0)).abs() / (l0 * l1 * l2) * scale;
        let cos_a = ab.dot(ac) * scale;
        let tangent = ac.cross(a) / sin_ac;
        // The half-angle form whose sum does not cancel: seen from just above it, a large triangle's vertices are
        // opposite one another.
        let cos_ab = a.dot(b);
        let tan_half_ab = if cos_ab < 0.0 { (1.0 - cos_ab) / sin_ab } else { sin_ab / (1.0 + cos_ab) };
        let finite = scale.is_finite() && tan_half_ab.is_finite() && tangent.is_finite();
        (finite && sin_a > 0.0).then_some(Self { v, a, b, tangent, tan_half_ab, sin_a, cos_a, solid_angle })
    }

    /// Its solid angle (sr).
    #[inline]
    pub fn solid_angle(&self) -> f32 {
        self.solid_angle as f32
    }

    /// Density of [`SphericalTriangle::sample`] (sr^-1).
    #[inline]
    pub fn pdf(&self) -> f32 {
        (1.0 / self.solid_angle) as f32
    }

    /// The unit direction for `u` in [0, 1)^2, uniform over the solid angle.
    #[inline]
    pub fn sample(&self, u: [f32; 2]) -> Vec3 {
        self.direction(u).as_vec3a()
    }

    /// As [`SphericalTriangle::sample`], with the barycentric coordinates of the triangle's point in that direction:
    /// each >= 0, sum 1, for the vertices in order.
    #[inline]
    pub fn sample_barycentric(&self, u: [f32; 2]) -> (Vec3, [f32; 3]) {
        let w = self.direction(u);
        let [v0, v1, v2] = self.v;
        // Fractions of the volume that w spans with each side; the common sign is that of the triangle's winding.
        let side = |p: DVec3, q: DVec3| w.dot(p.cross(q - p));
        let sign = 1.0_f64.copysign(v0.dot((v1 - v0).cross(v2 - v0)));
        let volumes = [side(v1, v2), side(v2, v0), side(v0, v1)].map(|x| (sign * x).max(0.0));
        let scale = 1.0 / (volumes[0] + volumes[1] + volumes[2]);
        (w.as_vec3a(), volumes.map(|x| (x * scale) as f32))
    }

    fn direction(&self, u: [f32; 2]) -> DVec3 {
        // Where the side from a to c has to be cut: a triangle with sides x and y around the angle A has
        // tan(area / 2) = p sin A / (1 + p cos A) with p = tan(x / 2) tan(y / 2).
        let (sin_half, cos_half) = (0.5 * f64::from(u[0]) * self.solid_angle).sin_cos();
        let tan_half = sin_half / (self.tan_half_ab * (self.sin_a * cos_half - self.cos_a * sin_half));
        let scale = 1.0 / (1.0 + tan_half * tan_half);
        let cut = self.a * ((1.0 - tan_half * tan_half) * scale) + self.tangent * (2.0 * tan_half * scale);

        // A point on the arc from b to the cut, with 1 - cos of the distance from b in proportion to u[1].
        let chord = cut - self.b;
        let sin2_half = 0.25 * f64::from(u[1]) * chord.length_squared();
        let across = chord - self.b * chord.dot(self.b);
        let length = across.length();
        if length == 0.0 {
            return self.b;
        }
        let sin = 2.0 * (sin2_half * (1.0 - sin2_half)).max(0.0).sqrt();
        self.b * (1.0 - 2.0 * sin2_half) + across * (sin / length)
    }

    /// The point of the unit square that [`SphericalTriangle::sample`] maps to the unit direction `w`, which must lie
    /// in the triangle; clamped to [0, 1].
    pub fn inverse(&self, w: Vec3) -> [f32; 2] {
        let w = w.as_dvec3().normalize();
        // The cut is where the plane through b and w meets the one through a and c, on w's side of b.
        let normal = self.b.cross(w - self.b);
        // Written in the basis of the side: cut = a cos + tangent sin, perpendicular to the normal.
        let (x, y) = (self.tangent.dot(normal), -self.a.dot(normal));
        let length = x.hypot(y);
        if length == 0.0 {
            return [0.0, 0.0];
        }
        // The side is shorter than half a turn, so its sine is positive.
        let sign = 1.0_f64.copysign(y) / length;
        let (cos, sin) = (x * sign, y * sign);
        let p = self.tan_half_ab * sin / (1.0 + cos);
        let area = 2.0 * (p * self.sin_a).atan2(1.0 + p * self.cos_a);
        let cut = self.a * cos + self.tangent * sin;
        let fraction = (w - self.b).length_squared() / (cut - self.b).length_squared();
        [(area / self.solid_angle).clamp(0.0, 1.0) as f32, fraction.clamp(0.0, 1.0) as f32]
    }
}
