//! Tubes without lids that emit outwards.

use std::f64::consts::{PI, TAU};

use super::{Departure, EmitterSample};
use crate::math::{Bounds, DAffine3, DVec3, Vec3};
use crate::spectrum::Rgb;

/// A cylinder without its lids, also one that a transform stretched or sheared, with the same radiance from every point in every
/// outward direction.
///
/// A straight line of the mantle is chosen uniformly by angle among those that face the receiver, then a point on it uniformly by the
/// angle under which the receiver sees the line (Kulla and Fajardo 2012, "Importance Sampling Techniques for Path Tracing in
/// Participating Media", Eq. 5), so that near and long tubes are sampled where their light comes from.
#[derive(Clone, Copy, Debug)]
pub struct TubeEmitter {
    /// From the frame in which the tube is x^2 + y^2 = 1 for z in [0, 1].
    to_scene: DAffine3,
    pub(super) to_own: DAffine3,
    /// Emitted radiance [W m^-2 sr^-1].
    pub radiance: Rgb,
    area: f64,
    /// Largest area that parallel light sees.
    cross_section: f64,
}

/// What a point sees of a tube.
struct Seen {
    /// The angle of the line that faces the point, in the tube's frame, and the largest distance in angle from it of any that does.
    middle: f64,
    half: f64,
}

/// What a point sees of a straight line of the mantle.
pub(super) struct Line {
    /// The line's lower end, and a vector along it, of the tube's height.
    pub base: DVec3,
    pub along: DVec3,
    /// Outward normal, as long as the area of a piece of the mantle with angle 1 and height 1.
    pub normal: DVec3,
    /// Where along it the nearest point of the whole line is, and how far away that is, in heights.
    nearest: f64,
    distance: f64,
    /// The angles between the way to the nearest point and those to both ends.
    ends: [f64; 2],
}

impl Line {
    /// The line with its normal inwards.
    #[inline]
    pub fn flipped(self) -> Self {
        Self { normal: -self.normal, ..self }
    }

    /// Samples a point of the line, uniformly by the angle under which it is seen.
    #[inline]
    pub fn sample(&self, u: f32) -> DVec3 {
        let turn = self.ends[0] + f64::from(u) * (self.ends[1] - self.ends[0]);
        let place = (self.nearest + self.distance * turn.tan()).clamp(0.0, 1.0);
        self.base + place * self.along
    }

    /// Density per solid angle of the direction to a point of this line, `to_light` away, where the line was chosen with the density
    /// `per_angle` among those at all angles around the tube; 0 where its normal does not face the receiver.
    #[inline]
    pub fn pdf(&self, per_angle: f64, to_light: DVec3) -> f32 {
        // Along the line h / ((b - a) (h^2 + (z - z0)^2)), where the sum is the squared distance in heights.
        let by_place = per_angle * self.distance * self.along.length_squared() / (self.ends[1] - self.ends[0]);
        let facing = -to_light.dot(self.normal);
        let pdf = by_place * to_light.length() / facing;
        if facing > 0.0 { pdf as f32 } else { 0.0 }
    }
}

impl TubeEmitter {
    /// The tube x^2 + y^2 = 1, 0 <= z <= 1 under an invertible transform to the scene frame.
    pub fn new(to_scene: DAffine3, radiance: Rgb) -> Self {
        let [area, cross_section] = areas(&to_scene);
        Self { to_own: to_scene.inverse(), to_scene, radiance, area, cross_section }
    }

    /// Its area [length^2].
    pub fn area(&self) -> f64 {
        self.area
    }

    /// The middle of its axis.
    pub fn centre(&self) -> DVec3 {
        self.to_scene.transform_point3(DVec3::Z * 0.5)
    }

    /// Emitted power \[W\].
    pub(super) fn power(&self) -> DVec3 {
        PI * self.area * self.radiance.to_f64()
    }

    /// Radiant intensity in the brightest direction over the emitted power, times pi.
    pub(super) fn intensity_share(&self) -> f64 {
        self.cross_section / self.area
    }

    /// The line of the mantle at this angle in the tube's frame, and its outward normal.
    #[inline]
    pub(super) fn line_at(&self, angle: f64) -> (DVec3, DVec3, DVec3) {
        let (sin, cos) = angle.sin_cos();
        let matrix = &self.to_scene.matrix3;
        let out = cos * matrix.x_axis + sin * matrix.y_axis;
        let along = matrix.z_axis;
        let normal = (cos * matrix.y_axis - sin * matrix.x_axis).cross(along);
        // A transform that mirrors turns the product inwards.
        let normal = if normal.dot(out) < 0.0 { -normal } else { normal };
        (self.to_scene.translation + out, along, normal)
    }

    /// What `p` sees; `None` from inside of the tube and of its prolongation, where no outer side is seen.
    #[inline]
    fn seen_from(&self, p: DVec3) -> Option<Seen> {
        let own = self.to_own.transform_point3(p);
        let distance = own.x.hypot(own.y);
        let beyond = (distance - 1.0) * (distance + 1.0);
        (beyond > 0.0).then(|| Seen { middle: own.y.atan2(own.x), half: beyond.sqrt().atan() })
    }

    /// The line of the mantle at this angle as `p` sees it; `None` from the line itself.
    #[inline]
    pub(super) fn line(&self, p: DVec3, angle: f64) -> Option<Line> {
        let (base, along, normal) = self.line_at(angle);
        let to_base = base - p;
        let length2 = along.length_squared();
        let nearest = -to_base.dot(along) / length2;
        let distance = ((to_base + nearest * along).length_squared() / length2).sqrt();
        let ends = [(-nearest).atan2(distance), (1.0 - nearest).atan2(distance)];
        (distance > 0.0 && ends[1] > ends[0]).then_some(Line { base, along, normal, nearest, distance, ends })
    }

    /// Samples a direction from `p`; `None` where `p` sees no outer side.
    pub(super) fn sample(&self, p: Vec3, u: [f32; 2]) -> Option<EmitterSample> {
        let from = p.as_dvec3();
        let seen = self.seen_from(from)?;
        let angle = seen.middle + seen.half * (2.0 * f64::from(u[0]) - 1.0);
        let line = self.line(from, angle)?;
        let point = line.sample(u[1]);
        let pdf = line.pdf(1.0 / (2.0 * seen.half), point - from);
        Some(EmitterSample::of_surface(from, point, line.normal.normalize(), self.radiance, pdf))
    }

    /// Samples a point uniformly by angle and height in the tube's frame; see [`Self::power_from`].
    pub(super) fn sample_departure(&self, u: [f32; 2]) -> Departure {
        let (base, along, normal) = self.line_at(TAU * f64::from(u[0]));
        Departure::of_surface(base + f64::from(u[1]) * along, normal.normalize())
    }

    /// The power \[W\] that all photons together would have if each were like one from a sampled point: that of a round tube is the
    /// same everywhere.
    pub(super) fn power_from(&self, p: Vec3) -> DVec3 {
        let (.., normal) = self.line_at(self.angle_of(p));
        PI * TAU * normal.length() * self.radiance.to_f64()
    }

    /// The angle of a point of the mantle, in the tube's frame.
    pub(super) fn angle_of(&self, p: Vec3) -> f64 {
        let own = self.to_own.transform_point3(p.as_dvec3());
        own.y.atan2(own.x)
    }

    /// Density per solid angle at `p` of the direction that meets the tube in `hit`.
    pub(super) fn pdf(&self, p: Vec3, hit: Vec3) -> f32 {
        let from = p.as_dvec3();
        let Some(seen) = self.seen_from(from) else { return 0.0 };
        let line = self.line(from, self.angle_of(hit));
        line.map_or(0.0, |line| line.pdf(1.0 / (2.0 * seen.half), hit.as_dvec3() - from))
    }

    /// A bounding box.
    pub(super) fn bounds(&self) -> Bounds {
        let corner = |i: u32| {
            let pick = |bit: u32| if i >> bit & 1 == 0 { -1.0 } else { 1.0 };
            self.to_scene.transform_point3(DVec3::new(pick(0), pick(1), f64::from(i >> 2 & 1)))
        };
        Bounds::around((0..8).map(corner))
    }
}

/// The area of the unit tube under a transform, and the largest area that parallel light sees of it.
///
/// A piece of the mantle has the area |b' cos - a' sin| for the cross products a', b' of both radii with the height: these are
/// conjugate radii of an ellipse of which the area is the perimeter.
fn areas(to_scene: &DAffine3) -> [f64; 2] {
    let matrix = &to_scene.matrix3;
    let [a, b] = [matrix.x_axis, matrix.y_axis].map(|radius| radius.cross(matrix.z_axis));
    // Half axes from conjugate radii: their squares have the sum a^2 + b^2 and the product |a x b|^2.
    let sum = a.length_squared() + b.length_squared();
    let product = a.cross(b).length();
    let [plus, minus] = [(sum + 2.0 * product).max(0.0).sqrt(), (sum - 2.0 * product).max(0.0).sqrt()];
    let (long, short) = (0.5 * (plus + minus), product / (0.5 * (plus + minus)));
    [perimeter(long, short), 2.0 * long]
}

/// The perimeter of an ellipse of half axes `long` >= `short`, by the arithmetic-geometric mean.
///
/// Source: Abramowitz and Stegun 1964, 17.6.3 and 17.6.4.
fn perimeter(long: f64, short: f64) -> f64 {
    let (mut a, mut b) = (1.0, short / long);
    let (mut sum, mut power) = (0.5 * (a - b) * (a + b), 0.5);
    // Each step doubles the number of digits, after as many steps as the axes' ratio has binary digits of its exponent.
    for _ in 0..32 {
        let c = 0.5 * (a - b);
        power *= 2.0;
        sum += power * c * c;
        (a, b) = (0.5 * (a + b), (a * b).sqrt());
    }
    TAU * long * (1.0 - sum) / a
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::DMat3;

    #[test]
    fn areas_of_stretched_and_sheared_tubes() {
        let shear = DMat3::from_cols(DVec3::new(2.0, 0.1, 0.0), DVec3::new(0.3, 0.5, -0.2), DVec3::new(0.4, 0.9, 3.0));
        for matrix in [DMat3::IDENTITY, DMat3::from_diagonal(DVec3::new(1.0, 1e-3, 2.0)), shear] {
            let tube = TubeEmitter::new(DAffine3 { matrix3: matrix, translation: DVec3::ONE }, Rgb::ONE);
            const N: u32 = 1 << 18;
            let normal = |i: u32| tube.line_at(TAU * (f64::from(i) + 0.5) / f64::from(N)).2;
            let area = (0..N).map(|i| normal(i).length()).sum::<f64>() * TAU / f64::from(N);
            assert!((tube.area() / area - 1.0).abs() < 1e-9, "{} instead of {area}", tube.area());
            // Seen from far away in the direction of any of its normals.
            let seen = |d: DVec3| {
                (0..N / 256).map(|i| normal(256 * i).dot(d).max(0.0)).sum::<f64>() * 256.0 * TAU / f64::from(N)
            };
            let most = (0..N / 256).map(|i| seen(normal(256 * i).normalize())).fold(0.0, f64::max);
            assert!((tube.cross_section / most - 1.0).abs() < 1e-4, "{} instead of {most}", tube.cross_section);
        }
    }
}
