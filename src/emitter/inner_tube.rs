//! The inner sides of tubes that emit on both.

use std::f64::consts::{PI, TAU};

use super::tube::Line;
use super::{Departure, EmitterSample, TubeEmitter};
use crate::math::{DVec3, Vec3};

/// The inner side of a cylinder without lids, with the same radiance from every point in every inward direction. It is seen from inside
/// and, through the open ends, from outside.
///
/// A direction across the tube is chosen uniformly by angle, in the frame in which the tube is round, among those in which the
/// receiver sees some of the inner side, and with it the line of the mantle that it meets. A point of this line is chosen as for the
/// outer side. Near the mantle, lines that are close to the receiver fill much of what it sees, and are chosen as often.
#[derive(Clone, Copy, Debug)]
pub struct InnerTubeEmitter {
    /// The outer side, with the same radiance.
    pub(super) outer: TubeEmitter,
}

/// What a point sees of the inner side, in the tube's frame.
struct Seen {
    /// The point, across the tube.
    own: [f64; 2],
    /// The angle of the direction to the axis, and the largest distance in angle from it of any direction that meets the mantle.
    middle: f64,
    half: f64,
}

impl InnerTubeEmitter {
    /// The inner side of a tube of which this is the outer side, with the same radiance.
    pub fn new(outer: TubeEmitter) -> Self {
        Self { outer }
    }

    /// What `p` sees.
    #[inline]
    fn seen_from(&self, p: DVec3) -> Seen {
        let own = self.outer.to_own.transform_point3(p);
        let distance = own.x.hypot(own.y);
        let half = if distance < 1.0 { PI } else { (1.0 / distance).asin() };
        Seen { own: [own.x, own.y], middle: (-own.y).atan2(-own.x), half }
    }

    /// Where a ray across the tube meets the mantle from within: the angle of the place around the axis.
    #[inline]
    fn far_side(&self, seen: &Seen, direction: f64) -> f64 {
        let (sin, cos) = direction.sin_cos();
        let [x, y] = seen.own;
        let along = x * cos + y * sin;
        let off_axis = x * sin - y * cos;
        let way = ((1.0 - off_axis) * (1.0 + off_axis)).max(0.0).sqrt() - along;
        (y + way * sin).atan2(x + way * cos)
    }

    /// The line of the mantle at this angle with its inward normal, and the density per angle around the axis with which it is chosen.
    #[inline]
    fn line(&self, p: DVec3, seen: &Seen, angle: f64) -> Option<(Line, f64)> {
        let line = self.outer.line(p, angle)?;
        let (sin, cos) = angle.sin_cos();
        let (dx, dy) = (cos - seen.own[0], sin - seen.own[1]);
        // A piece of the circle is seen under its length times the cosine of its normal over the distance.
        let per_angle = (dx * cos + dy * sin) / (dx * dx + dy * dy) / (2.0 * seen.half);
        (per_angle > 0.0).then_some((line.flipped(), per_angle))
    }

    /// Samples a direction from `p`; `None` where the line that it meets has no width for `p`.
    pub(super) fn sample(&self, p: Vec3, u: [f32; 2]) -> Option<EmitterSample> {
        let from = p.as_dvec3();
        let seen = self.seen_from(from);
        let angle = self.far_side(&seen, seen.middle + seen.half * (2.0 * f64::from(u[0]) - 1.0));
        let (line, per_angle) = self.line(from, &seen, angle)?;
        let point = line.sample(u[1]);
        let pdf = line.pdf(per_angle, point - from);
        Some(EmitterSample::of_surface(from, point, line.normal.normalize(), self.outer.radiance, pdf))
    }

    /// Density per solid angle at `p` of the direction that meets the inner side in `hit`.
    pub(super) fn pdf(&self, p: Vec3, hit: Vec3) -> f32 {
        let from = p.as_dvec3();
        let seen = self.seen_from(from);
        let line = self.line(from, &seen, self.outer.angle_of(hit));
        line.map_or(0.0, |(line, per_angle)| line.pdf(per_angle, hit.as_dvec3() - from))
    }

    /// Samples a point as the outer side does, uniformly by angle and height in the tube's frame.
    pub(super) fn sample_departure(&self, u: [f32; 2]) -> Departure {
        let (base, along, normal) = self.outer.line_at(TAU * f64::from(u[0]));
        Departure::of_surface(base + f64::from(u[1]) * along, -normal.normalize())
    }
}
