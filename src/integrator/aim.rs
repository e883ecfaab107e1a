//! Directions from a surface towards mirrors and glass.
//!
//! Rays aimed at mirrors and glass find large lamps that are seen in them: specular surfaces are sampled by solid angle, as
//! lamps are.

use std::f32::consts::{PI, TAU};
use std::sync::Arc;

use crate::math::{Frame, Vec3};
use crate::sampling::{DirectionCone, SphericalTriangle, triangle_solid_angle, warps};
use crate::scene::{Scene, SpecularPart};

/// Most parts that are sampled separately, since the density of every aimed ray evaluates all of them.
const MOST_PARTS: usize = 16;

/// Least cosine in the weight of a part whose middle is below the horizon while another portion of it is above.
const LEAST_COSINE: f32 = 0.05;

/// All specular surfaces of a scene, as parts that rays are aimed at.
#[derive(Clone, Debug)]
pub(crate) struct Aims(Arc<[SpecularPart]>);

/// A part as it is seen from a point.
#[derive(Clone, Copy)]
enum Seen {
    /// The part is below the horizon.
    Nothing,
    Cone(DirectionCone),
    /// Vectors to the corners, and the solid angle.
    Triangle([Vec3; 3], f32),
    /// The point lies inside the part's ball, so that the part may be seen in every direction.
    Around,
}

impl Aims {
    /// Collects the specular parts of a scene: surfaces with delta lobes, and with glossy lobes below this width.
    pub fn new(scene: &Scene, narrow_below: f32) -> Self {
        Self::of_few(scene, narrow_below, MOST_PARTS)
    }

    /// The same in at most `most` parts (from 1 to 16).
    pub fn of_few(scene: &Scene, narrow_below: f32, most: usize) -> Self {
        Self(scene.specular_parts(narrow_below, most.clamp(1, MOST_PARTS)).into())
    }

    /// A unit direction from `p`, on the side of the unit normal `n`, towards one of the parts, and its density (sr^-1).
    /// `None` where no part is above the horizon.
    ///
    /// `choice` and `u` are uniform in [0, 1) and [0, 1)^2. The density is positive for every direction above the horizon in
    /// which a specular surface lies.
    #[inline]
    pub fn sample(&self, p: Vec3, n: Vec3, choice: f32, u: [f32; 2]) -> Option<(Vec3, f32)> {
        let mut seen = [(Seen::Nothing, 0.0); MOST_PARTS];
        let seen = &mut seen[..self.0.len()];
        let total = self.see(p, n, seen)?;
        let mut left = choice * total;
        let mut chosen = None;
        for (index, (_, weight)) in seen.iter().enumerate().filter(|(_, (_, weight))| *weight > 0.0) {
            chosen = Some(index);
            if left < *weight {
                break;
            }
            left -= weight;
        }
        let chosen = chosen?;
        let (direction, mut density) = seen[chosen].0.sample(n, u)?;
        density *= seen[chosen].1;
        for (index, (other, weight)) in seen.iter().enumerate() {
            if index != chosen && *weight > 0.0 {
                density += weight * other.pdf(n, direction);
            }
        }
        Some((direction, density / total))
    }

    /// Density of [`Self::sample`] for a unit direction (sr^-1).
    #[inline]
    pub fn pdf(&self, p: Vec3, n: Vec3, direction: Vec3) -> f32 {
        let (mut density, mut total) = (0.0, 0.0);
        for part in &*self.0 {
            let (seen, weight) = Seen::new(part, p, n);
            total += weight;
            if weight > 0.0 {
                density += weight * seen.pdf(n, direction);
            }
        }
        if total > 0.0 { density / total } else { 0.0 }
    }

    /// How much of the parts is seen from a point on the side of the unit normal `n`, or from all sides where there is none: approximately
    /// their projected solid angle.
    pub fn weight(&self, p: Vec3, n: Option<Vec3>) -> f32 {
        let towards = |part: &SpecularPart| {
            let middle = match part {
                SpecularPart::Ball(ball) => ball.centre,
                SpecularPart::Triangle([a, b, c]) => (*a + *b + *c) / 3.0,
            };
            (middle - p).try_normalize().unwrap_or(Vec3::Z)
        };
        self.0.iter().map(|part| Seen::new(part, p, n.unwrap_or_else(|| towards(part))).1).sum()
    }

    /// Whether there is nothing to aim at.
    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// Finds how each part is seen from a point, and its weight. Returns the sum of the weights; `None` where no part is above the horizon.
    #[inline]
    fn see(&self, p: Vec3, n: Vec3, seen: &mut [(Seen, f32)]) -> Option<f32> {
        let mut total = 0.0;
        for (seen, part) in seen.iter_mut().zip(&*self.0) {
            *seen = Seen::new(part, p, n);
            total += seen.1;
        }
        (total > 0.0).then_some(total)
    }
}

impl Seen {
    /// How a part is seen, and its weight in the choice of a part: approximately its projected solid angle.
    #[inline]
    fn new(part: &SpecularPart, p: Vec3, n: Vec3) -> (Self, f32) {
        match part {
            SpecularPart::Ball(ball) => {
                let height = (ball.centre - p).dot(n);
                if height <= -ball.radius {
                    return (Self::Nothing, 0.0);
                }
                let Some(cone) = DirectionCone::of_ball(p, ball.centre, ball.radius) else { return (Self::Around, PI) };
                let weight = TAU * cone.one_minus_cos * cone.axis.dot(n).max(LEAST_COSINE);
                (Self::Cone(cone), weight)
            }
            SpecularPart::Triangle(corners) => {
                let corners = corners.map(|corner| corner - p);
                let heights = corners.map(|corner| corner.dot(n));
                if heights.iter().all(|height| *height <= 0.0) {
                    return (Self::Nothing, 0.0);
                }
                let solid_angle = triangle_solid_angle(corners) as f32;
                let middle = corners[0] + corners[1] + corners[2];
                let cosine = (middle.dot(n) / middle.length()).max(LEAST_COSINE);
                let weight = solid_angle * cosine;
                // The point is almost in the triangle's plane, or so far away that the solid angle vanishes.
                if SphericalTriangle::new(corners).is_none() {
                    return if solid_angle > 1.0 { (Self::Around, PI) } else { (Self::Nothing, 0.0) };
                }
                if weight > 0.0 { (Self::Triangle(corners, solid_angle), weight) } else { (Self::Nothing, 0.0) }
            }
        }
    }

    #[inline]
    fn sample(&self, n: Vec3, u: [f32; 2]) -> Option<(Vec3, f32)> {
        match self {
            Self::Nothing => None,
            Self::Cone(cone) => Some((cone.sample(u), cone.pdf())),
            Self::Triangle(corners, _) => {
                let triangle = SphericalTriangle::new(*corners)?;
                Some((triangle.sample(u), triangle.pdf()))
            }
            Self::Around => {
                let local = warps::cosine_hemisphere(u);
                Some((Frame::from_normal(n).to_world(local), warps::cosine_hemisphere_pdf(local.z)))
            }
        }
    }

    /// Density of [`Seen::sample`] (sr^-1).
    #[inline]
    fn pdf(&self, n: Vec3, direction: Vec3) -> f32 {
        match self {
            Self::Nothing => 0.0,
            Self::Cone(cone) if cone.holds(direction) => cone.pdf(),
            Self::Cone(_) => 0.0,
            Self::Triangle([a, b, c], solid_angle) => {
                let sides = [a.cross(*b), b.cross(*c), c.cross(*a)].map(|side| side.dot(direction));
                let inside = sides.iter().all(|side| *side >= 0.0) || sides.iter().all(|side| *side <= 0.0);
                // The triangle must lie in front of the point, not behind.
                if inside && (*a + *b + *c).dot(direction) > 0.0 { 1.0 / solid_angle } else { 0.0 }
            }
            Self::Around => warps::cosine_hemisphere_pdf(direction.dot(n)),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sampling::Rng;
    use crate::scene::Ball;

    /// Compares two estimates of the projected solid angle of the union of parts: by aimed directions and by
    /// cosine-distributed directions of the whole hemisphere.
    #[test]
    fn every_direction_that_meets_a_part_counts_once() {
        let balls = [
            Ball { centre: Vec3::new(0.0, 0.5, 2.0), radius: 0.8 },
            // The first ball is half below the horizon; the second one contains the point.
            Ball { centre: Vec3::new(2.0, 0.0, 0.1), radius: 0.5 },
            Ball { centre: Vec3::new(0.0, 0.0, -0.2), radius: 0.3 },
        ];
        let triangle = [Vec3::new(-2.0, -1.0, 1.5), Vec3::new(1.5, 0.0, 1.0), Vec3::new(0.0, 2.5, 2.5)];
        let sunken = [Vec3::new(-2.0, 0.0, -1.0), Vec3::new(-2.0, 2.0, -1.0), Vec3::new(-1.0, 0.0, 1.0)];
        let of = |ball: usize| SpecularPart::Ball(balls[ball]);
        let scenes = [
            vec![of(0)],
            vec![of(1)],
            vec![SpecularPart::Triangle(triangle)],
            vec![SpecularPart::Triangle(sunken)],
            vec![of(0), of(1), SpecularPart::Triangle(triangle), SpecularPart::Triangle(sunken)],
            vec![of(0), of(2), SpecularPart::Triangle(triangle)],
        ];
        let (p, n) = (Vec3::ZERO, Vec3::Z);
        for (number, parts) in scenes.into_iter().enumerate() {
            let meets = |w: Vec3| {
                parts.iter().any(|part| match Seen::new(part, p, n).0 {
                    Seen::Cone(cone) => cone.holds(w),
                    Seen::Around => true,
                    seen @ Seen::Triangle(..) => seen.pdf(n, w) > 0.0,
                    Seen::Nothing => false,
                })
            };
            let aims = Aims(parts.clone().into());
            const N: u32 = 2_000_000;
            let mut rng = Rng::new(7, number as u64);
            let mut sums = [[0.0_f64; 2]; 2];
            for _ in 0..N {
                let [a, b, c, d] = rng.next_4d();
                let aimed = aims.sample(p, n, a, [b, c]).filter(|(w, _)| w.z > 0.0);
                let aimed = aimed.map_or(0.0, |(w, pdf)| if meets(w) { w.z / pdf } else { 0.0 });
                let [e, _, _, _] = rng.next_4d();
                let w = warps::cosine_hemisphere([d, e]);
                let plain = if meets(w) { PI } else { 0.0 };
                for (sum, x) in sums.iter_mut().zip([aimed, plain]) {
                    sum[0] += f64::from(x);
                    sum[1] += f64::from(x) * f64::from(x);
                }
            }
            let [(aimed, a), (plain, b)] = sums.map(|[sum, squares]| {
                let mean = sum / f64::from(N);
                (mean, (squares / f64::from(N) - mean * mean) / f64::from(N))
            });
            let error = (a + b).sqrt();
            assert!(plain > 0.0 && error < 0.015 * plain, "{number}: {plain} +- {error} proves nothing");
            assert!((aimed - plain).abs() <= 4.0 * error, "{number}: {aimed}, by all directions {plain} +- {error}");
        }
    }
}
