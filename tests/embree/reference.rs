//! Intersection in double precision, written from the definitions, with what single precision may get wrong.
//!
//! Inputs are those Embree sees (single precision, exact in double), so the reference's own error is 2^-29 of the
//! bounds below and is left out of them.
//!
//! # The bound for triangles
//!
//! Let v be a corner as seen from the ray's origin, e the edges, N = e1 x e2, D the direction. Embree computes
//! t = (v . N) / (D . N) from rounded v, N and products. Rounding v costs eps |v|, each product and sum as much again;
//! a cross product of rounded edges costs a few eps |e1||e2|, and both enter t divided by |D . N|. Hence
//!
//! |t - t_exact| <= `UNITS` eps |v| |e1||e2| / |D . N|,
//!
//! where v is the largest of origin and corners in absolute value, for the subtraction's rounding is relative to its
//! operands' result, but edges are differences of such results. Whether the ray passes an edge from a to b on
//! the inner side is the sign of (e x (a + b)) . D, whose rounding is `UNITS` eps |e| |v| |D| by the same count; a ray
//! within that band may be told to hit or to miss. In a grazing pass D . N goes to 0 and t with it to any value: t is
//! then badly conditioned, while the distance from the plane, |t - t_exact| |D . N| / |N|, stays within the bound.
//!
//! About 20 roundings enter each of these, at most half a unit each, so 10 units bound them if all conspire; as they do
//! not, a random walk of that length stays near 20^(1/2) / 2 = 2.2. The largest number of units met in a million rays
//! is 1.7 (the tests print it), and `UNITS` allows for 4. For a triangle of the size of its distance, met head-on, a
//! unit is one ULP of t.

use etendue::math::{DAffine3, DMat3, DVec3, Ray};

/// Unit roundoff spacing of single precision, 2^-23.
pub const EPS: f64 = f32::EPSILON as f64;

/// Roundings allowed for, in units of `EPS`.
pub const UNITS: f64 = 4.0;

/// SplitMix64 (Steele et al. 2014): small, and good enough to scatter test rays.
pub struct Random(pub u64);

impl Random {
    pub fn bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let z = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// In [0, 1).
    pub fn unit(&mut self) -> f64 {
        (self.bits() >> 11) as f64 * 0.5_f64.powi(53)
    }

    pub fn range(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.unit()
    }

    pub fn below(&mut self, n: usize) -> usize {
        (self.bits() % n as u64) as usize
    }

    pub fn in_cube(&mut self, half: f64) -> DVec3 {
        DVec3::new(self.range(-half, half), self.range(-half, half), self.range(-half, half))
    }

    pub fn on_sphere(&mut self) -> DVec3 {
        let z = self.range(-1.0, 1.0);
        let (sin, cos) = self.range(0.0, std::f64::consts::TAU).sin_cos();
        let r = (1.0 - z * z).sqrt();
        DVec3::new(r * cos, r * sin, z)
    }
}

/// A ray in double precision, with how far off origin and direction may be.
#[derive(Clone, Copy, Debug)]
pub struct Ray64 {
    pub o: DVec3,
    pub d: DVec3,
    pub tnear: f64,
    pub tfar: f64,
    pub o_error: f64,
    pub d_error: f64,
}

impl From<&Ray> for Ray64 {
    fn from(ray: &Ray) -> Self {
        Self {
            o: ray.origin.as_dvec3(),
            d: ray.direction.as_dvec3(),
            tnear: ray.tnear.into(),
            tfar: ray.tfar.into(),
            o_error: 0.0,
            d_error: 0.0,
        }
    }
}

impl Ray64 {
    /// The ray in the frame of an instance. Embree inverts the transform M by cofactors, which is off by about
    /// eps cond(M) |M^-1|, and moves origin and direction with it.
    pub fn into_instance(self, transform: &DAffine3) -> Self {
        let inverse = transform.inverse();
        let norm = |m: &DMat3| m.to_cols_array().iter().map(|x| x * x).sum::<f64>().sqrt();
        let size = norm(&inverse.matrix3);
        let relative = 2.0 * UNITS * EPS * size * norm(&transform.matrix3);
        Self {
            o: inverse.transform_point3(self.o),
            d: inverse.transform_vector3(self.d),
            o_error: relative * size * (self.o.length() + transform.translation.length()),
            d_error: relative * size * self.d.length(),
            ..self
        }
    }
}

/// What the exact test says, as far as single precision can be expected to agree.
#[derive(Clone, Copy, Debug)]
pub struct Crossing {
    /// Where the ray meets the primitive's carrier.
    pub t: f64,
    /// How far Embree's t may be from it.
    pub t_error: f64,
    /// `Some(true)`: any correct program hits; `Some(false)`: it misses; `None`: rounding decides.
    pub hit: Option<bool>,
}

impl Crossing {
    const MISS: Self = Self { t: f64::INFINITY, t_error: 0.0, hit: Some(false) };
}

/// Ray against triangle; Moller and Trumbore 1997 in its symmetric form, with signed volumes.
pub fn triangle(corners: [DVec3; 3], ray: &Ray64) -> Crossing {
    let [a, b, c] = corners.map(|p| p - ray.o);
    let (e1, e2) = (b - a, c - a);
    let n = e1.cross(e2);
    let along = n.dot(ray.d);
    // A flat triangle or a ray in its plane: within rounding of `along` anything may be said.
    let size = a.abs().max(b.abs()).max(c.abs()).max_element().max(ray.o.abs().max_element() * EPS);
    let edges = e1.length() * e2.length();
    let length = ray.d.length();
    let v = size * 3.0_f64.sqrt();

    let mut hit = Some(true);
    // The three signed volumes share the sign of `along` inside.
    for (p, q) in [(a, b), (b, c), (c, a)] {
        let e = q - p;
        let volume = p.cross(q).dot(ray.d) * along.signum();
        let band = e.length() * (UNITS * EPS * v * length + v * ray.d_error + length * ray.o_error);
        if volume < -band {
            return Crossing::MISS;
        }
        if volume <= band {
            hit = None;
        }
    }
    // Cancellation in N: its components are off by eps |e1||e2|.
    let n_error = UNITS * EPS * edges;
    if along.abs() <= n_error * length + n.length() * ray.d_error {
        return Crossing { t: 0.0, t_error: f64::INFINITY, hit: None };
    }
    let t = a.dot(n) / along;
    let t_error = (UNITS * EPS * v * edges + n.length() * (ray.o_error + t.abs() * ray.d_error)) / along.abs();
    interval(Crossing { t, t_error, hit }, ray)
}

/// Whether the crossing lies within the ray's interval.
fn interval(crossing: Crossing, ray: &Ray64) -> Crossing {
    let Crossing { t, t_error, hit } = crossing;
    if t + t_error < ray.tnear || t - t_error > ray.tfar {
        return Crossing::MISS;
    }
    let sure = t - t_error > ray.tnear && t + t_error < ray.tfar;
    Crossing { t, t_error, hit: if sure { hit } else { None } }
}

/// Both parameters at which a line meets the sphere around `centre`, in order.
pub fn sphere(centre: DVec3, radius: f64, o: DVec3, d: DVec3) -> Option<(f64, f64)> {
    let to_origin = o - centre;
    let dd = d.length_squared();
    let nearest = -to_origin.dot(d) / dd;
    // The distance of the line from the centre is free of the cancellation in b^2 - 4ac.
    let closest = to_origin + d * nearest;
    let rest = radius * radius - closest.length_squared();
    if rest < 0.0 {
        return None;
    }
    let half = (rest / dd).sqrt();
    Some((nearest - half, nearest + half))
}

/// Both parameters at which a line meets the quadric x' A x + 2 b' x + c = 0, in order.
pub fn quadric(a: &DMat3, b: DVec3, c: f64, o: DVec3, d: DVec3) -> Option<(f64, f64)> {
    let qa = d.dot(*a * d);
    let qb = d.dot(*a * o) + b.dot(d);
    let qc = o.dot(*a * o) + 2.0 * b.dot(o) + c;
    let discriminant = qb * qb - qa * qc;
    if discriminant < 0.0 {
        return None;
    }
    let q = -(qb + discriminant.sqrt().copysign(qb));
    let (t0, t1) = (q / qa, qc / q);
    Some((t0.min(t1), t0.max(t1)))
}

/// The closest of many crossings, and Embree's answer against them.
#[derive(Default, Debug)]
pub struct Tally {
    pub rays: usize,
    pub hits: usize,
    /// Another primitive than the exact test's, within the bound.
    pub ties: usize,
    /// Hit or miss where rounding decides.
    pub undecided: usize,
    /// Largest deviation of t, as a fraction of its bound.
    pub worst: f64,
}

impl Tally {
    /// Checks `found` (t and the index into `crossings`) against all that the ray may have met.
    pub fn check(&mut self, crossings: &[Crossing], found: Option<(f32, usize)>, ray: &Ray) {
        self.rays += 1;
        let first = crossings
            .iter()
            .enumerate()
            .filter(|(_, c)| c.hit == Some(true))
            .min_by(|(_, x), (_, y)| x.t.total_cmp(&y.t));
        let Some((t, index)) = found else {
            assert!(first.is_none(), "missed {first:?} with {ray:?}");
            self.undecided += usize::from(crossings.iter().any(|c| c.hit.is_none()));
            return;
        };
        self.hits += 1;
        let t = f64::from(t);
        let met = crossings[index];
        assert!(met.hit != Some(false), "hit primitive {index} at {t}, which {ray:?} misses");
        let off = (t - met.t).abs();
        assert!(off <= met.t_error, "primitive {index} at {t}, exact {met:?}, off by {off:e} with {ray:?}");
        if met.t_error.is_finite() {
            self.worst = self.worst.max(off / met.t_error);
        }
        match first {
            None => self.undecided += 1,
            Some((nearest, _)) if nearest == index => {}
            Some((nearest, exact)) => {
                let allowed = exact.t_error + met.t_error;
                assert!(
                    met.t <= exact.t + allowed,
                    "primitive {index} at {t}, but {nearest} is nearer at {} with {ray:?}",
                    exact.t
                );
                self.ties += 1;
            }
        }
    }

    pub fn report(&self, name: &str) {
        let units = self.worst * UNITS;
        println!(
            "{name}: {} rays, {} hits, {} ties, {} undecided, t off by at most {units:.2} units",
            self.rays, self.hits, self.ties, self.undecided
        );
    }
}
