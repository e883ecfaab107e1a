//! Openings through which light from infinity comes in.

use crate::math::{DVec3, Vec3};
use crate::sampling::{SphericalTriangle, warps};
use crate::shape::Triangle;

/// The share of the light samples, and of the photons, that go through the openings. The rest is sampled by the light alone, so that
/// what comes in elsewhere is found too.
const SHARE: f32 = 0.5;

/// Openings of a room, such as windows, as triangles. They only say where directions are worth sampling: light that comes in elsewhere
/// counts all the same, and no opening lets light through a wall.
///
/// Directions are sampled uniformly over the solid angle of each opening. Where openings overlap, a direction is sampled as often as it
/// has openings, and its density says so.
///
/// Source: Bitterli, Novák, Jarosz 2015, "Portal-Masked Environment Map Sampling", which samples the product with the light too, for
/// openings that are rectangles.
#[derive(Clone, Debug)]
pub struct Portals {
    triangles: Box<[Triangle]>,
}

impl Portals {
    /// The openings; `None` where there are none.
    pub fn new(triangles: impl IntoIterator<Item = Triangle>) -> Option<Self> {
        let triangles: Box<[Triangle]> = triangles.into_iter().collect();
        (!triangles.is_empty()).then_some(Self { triangles })
    }

    /// The solid angle \[sr\] that the openings fill from `p`, each by itself, without those in whose plane it is.
    fn solid_angle(&self, p: Vec3) -> f64 {
        self.triangles.iter().map(|triangle| seen(triangle, p)).sum()
    }

    /// Samples a direction from `p`, either through the openings or as `otherwise` does from what is left of `u`, which is uniform in
    /// [0, 1)^2, and `pdf` gives the density of what it does. Returns the unit direction and the density \[sr^-1\] of both together.
    pub(super) fn sample(
        &self,
        p: Vec3,
        u: [f32; 2],
        otherwise: impl FnOnce([f32; 2]) -> (Vec3, f32),
        pdf: impl FnOnce(Vec3) -> f32,
    ) -> (Vec3, f32) {
        let all = self.solid_angle(p);
        if all <= 0.0 {
            return otherwise(u);
        }
        if u[0] >= SHARE {
            let (wi, plain) = otherwise([below_one((u[0] - SHARE) / (1.0 - SHARE)), u[1]]);
            return (wi, self.both(p, wi, all, plain, None));
        }
        let mut left = f64::from(u[0] / SHARE) * all;
        let mut chosen = None;
        for (index, triangle) in self.triangles.iter().enumerate() {
            let own = seen(triangle, p);
            if own > 0.0 {
                chosen = Some((index, own, left));
                if left < own {
                    break;
                }
            }
            left -= own;
        }
        let spherical = chosen.and_then(|(index, own, left)| {
            let rest = below_one((left / own).clamp(0.0, 1.0) as f32);
            Some((index, SphericalTriangle::seen_from(p, self.triangles[index].vertices)?.sample([rest, u[1]])))
        });
        // What fills a solid angle can be sampled.
        let Some((index, wi)) = spherical else { return otherwise(u) };
        (wi, self.both(p, wi, all, pdf(wi), Some(index)))
    }

    /// The density \[sr^-1\] with which [`Self::sample`] gives a unit direction from `p`, where the other way gives it with `plain`.
    pub(super) fn pdf(&self, p: Vec3, wi: Vec3, plain: f32) -> f32 {
        let all = self.solid_angle(p);
        if all > 0.0 { self.both(p, wi, all, plain, None) } else { plain }
    }

    /// The density of both ways together; `chosen` is an opening that the direction goes through, whatever rounding says.
    fn both(&self, p: Vec3, wi: Vec3, all: f64, plain: f32, chosen: Option<usize>) -> f32 {
        let through = |(index, triangle): (usize, &Triangle)| {
            let holds = Some(index) == chosen || seen(triangle, p) > 0.0 && holds(triangle, p, wi);
            u32::from(holds)
        };
        let count: u32 = self.triangles.iter().enumerate().map(through).sum();
        SHARE * (f64::from(count) / all) as f32 + (1.0 - SHARE) * plain
    }

    /// A point where a photon from the unit direction `from` passes an opening, if it is one of those that go through openings by
    /// `choice`; `d` places it. Both are uniform in [0, 1).
    pub fn passed(&self, from: Vec3, d: [f32; 2], choice: f32) -> Option<Vec3> {
        let all = self.shadow(from);
        if choice >= SHARE || all <= 0.0 {
            return None;
        }
        let mut left = f64::from(choice / SHARE) * all;
        let mut chosen = None;
        for triangle in &self.triangles {
            let own = across(triangle, from);
            if own > 0.0 {
                chosen = Some(triangle);
                if left < own {
                    break;
                }
            }
            left -= own;
        }
        let [_, b1, b2] = warps::uniform_triangle(d);
        chosen.map(|triangle| triangle.at(b1, b2))
    }

    /// The density [length^-2], across the unit direction `from`, of photons along the line through `p`, where those that go anywhere
    /// have the density `plain`; `is_passed` where the line is known to go through an opening.
    pub fn density(&self, from: Vec3, p: Vec3, plain: f64, is_passed: bool) -> f64 {
        let all = self.shadow(from);
        if all <= 0.0 {
            return plain;
        }
        let meets = |triangle: &&Triangle| across(triangle, from) > 0.0 && is_on_line(triangle, p, from);
        let count = self.triangles.iter().filter(meets).count().max(usize::from(is_passed));
        f64::from(SHARE) * count as f64 / all + f64::from(1.0 - SHARE) * plain
    }

    /// The area [length^2] of the openings' shadows across a direction, each by itself.
    fn shadow(&self, from: Vec3) -> f64 {
        self.triangles.iter().map(|triangle| across(triangle, from)).sum()
    }
}

fn below_one(x: f32) -> f32 {
    x.min(1.0_f32.next_down())
}

/// The solid angle of an opening where directions through it can be sampled; else 0.
fn seen(triangle: &Triangle, p: Vec3) -> f64 {
    SphericalTriangle::seen_from(p, triangle.vertices).map_or(0.0, |it| f64::from(it.solid_angle()))
}

/// The area of a triangle's shadow.
fn across(triangle: &Triangle, from: Vec3) -> f64 {
    f64::from(triangle.area) * f64::from(triangle.normal.dot(from).abs())
}

/// The volumes that a direction spans with the sides of a triangle, seen from `p`: of one sign where its line meets it.
fn volumes(triangle: &Triangle, p: Vec3, direction: Vec3) -> [f64; 3] {
    let [a, b, c] = triangle.vertices.map(|vertex| vertex.as_dvec3() - p.as_dvec3());
    let w = direction.as_dvec3();
    let volume = |a: DVec3, b: DVec3| w.dot(a.cross(b - a));
    [volume(a, b), volume(b, c), volume(c, a)]
}

fn holds(triangle: &Triangle, p: Vec3, wi: Vec3) -> bool {
    let volumes = volumes(triangle, p, wi);
    let side = triangle.height_by_twice_area(p);
    // Seen from in front the sides go round the other way.
    volumes.iter().all(|volume| volume * side <= 0.0)
}

fn is_on_line(triangle: &Triangle, p: Vec3, direction: Vec3) -> bool {
    let volumes = volumes(triangle, p, direction);
    volumes.iter().all(|volume| *volume >= 0.0) || volumes.iter().all(|volume| *volume <= 0.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sampling::Rng;

    fn openings() -> Portals {
        let corner = |x: f32, y: f32, z: f32| Vec3::new(x, y, z);
        let window = [corner(-1.0, 0.0, 2.0), corner(1.0, 0.0, 2.0), corner(1.0, 1.5, 2.0)];
        let overlapping = [corner(-0.5, 0.2, 2.0), corner(1.5, 0.1, 2.5), corner(0.5, 1.0, 2.0)];
        let turned = [corner(3.0, 0.0, -1.0), corner(3.0, 2.0, 0.0), corner(3.0, -1.0, 1.0)];
        Portals::new([window, overlapping, turned].into_iter().filter_map(Triangle::new)).unwrap()
    }

    /// What a sample says of its density is what is said of its direction, and the density integrates to 1.
    #[test]
    fn directions_have_their_density() {
        let portals = openings();
        let uniform = 1.0 / (4.0 * std::f32::consts::PI);
        let mut rng = Rng::new(9, 1);
        for p in [Vec3::ZERO, Vec3::new(0.3, 0.4, 1.9), Vec3::new(5.0, -1.0, 3.0)] {
            let (mut sum, mut different, mut inverse) = (0.0, 0, 0.0);
            const COUNT: u32 = 1 << 16;
            for _ in 0..COUNT {
                let u = rng.next_2d();
                let (wi, pdf) = portals.sample(p, u, |u| (warps::uniform_sphere(u), uniform), |_| uniform);
                assert!(wi.is_normalized() && pdf > 0.0);
                different += u32::from((portals.pdf(p, wi, uniform) / pdf - 1.0).abs() > 1e-3);
                // The mean of 1 / pdf is the solid angle of all directions.
                inverse += 1.0 / f64::from(pdf);
                sum += f64::from(portals.pdf(p, warps::uniform_sphere(rng.next_2d()), uniform) / uniform);
            }
            assert!(different < 20, "{different} at {p}");
            let [inverse, sum] = [inverse / (4.0 * std::f64::consts::PI), sum].map(|x| x / f64::from(COUNT));
            assert!((inverse - 1.0).abs() < 0.02 && (sum - 1.0).abs() < 0.1, "{inverse} {sum} at {p}");
        }
    }

    /// Photons have the density that is said of their lines: uniform lines and lines of the openings agree.
    #[test]
    fn photons_have_their_density() {
        let portals = openings();
        let mut rng = Rng::new(4, 1);
        for from in [Vec3::Z, Vec3::new(0.6, 0.0, 0.8), Vec3::X] {
            let all = portals.shadow(from);
            let (mut passed, mut count) = (0, 0);
            let plain = 0.01;
            let mut inverse = 0.0;
            for _ in 0..1 << 14 {
                let [x, y] = rng.next_2d();
                let Some(p) = portals.passed(from, [x, y], 0.5 * SHARE * rng.next_f32() * 2.0) else { continue };
                count += 1;
                let density = portals.density(from, p, plain, true);
                passed += u32::from(portals.density(from, p + 3.0 * from, plain, false) == density);
                inverse += 1.0 / (density - f64::from(1.0 - SHARE) * plain);
            }
            assert!(passed > count - 10, "{passed} of {count}");
            // Of openings that overlap, the union is no more than the sum.
            let union = inverse / f64::from(count) * f64::from(SHARE);
            assert!(union <= all * 1.001 && union > 0.4 * all, "{union} {all}");
        }
        assert!(portals.passed(Vec3::Z, [0.5; 2], SHARE).is_none());
    }
}
