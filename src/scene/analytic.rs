//! A short list of analytic shapes, which every ray tests before it is passed to Embree.
//!
//! If spheres were Embree user geometry, every ray would traverse a second hierarchy; in a room with three spheres that
//! halves the ray rate. Testing a short list costs only a few nanoseconds, and a hit in the list shortens the segment
//! that Embree has to search. Four bounding spheres at a time are rejected in single precision, with a margin that
//! covers the rounding error; the remaining candidates are decided by the exact test in double precision.

use std::sync::Arc;

use super::moving_shape::MovingShape;
use crate::embree::{UserGeometry, UserHit};
use crate::math::{Bounds, Ray, Vec4};
use crate::shape::{Analytic, DRay};

/// Bounding spheres of four shapes, padded for rounding.
#[derive(Clone, Copy, Debug, Default)]
struct Packet {
    x: Vec4,
    y: Vec4,
    z: Vec4,
    radius2: Vec4,
    /// One bit is set for each lane that holds a shape.
    lanes: u32,
}

/// Relative error of the rejection test in f32, about thirty roundings. The margin covers this error.
const MARGIN: f32 = 4e-6;

impl Packet {
    /// Returns a mask with one bit set for each shape that the ray's line may meet in front of its origin.
    #[inline]
    fn candidates(&self, ray: &Ray, length2: f32) -> u32 {
        let x = self.x - Vec4::splat(ray.origin.x);
        let y = self.y - Vec4::splat(ray.origin.y);
        let z = self.z - Vec4::splat(ray.origin.z);
        let distance2 = x * x + y * y + z * z;
        let along = x * ray.direction.x + y * ray.direction.y + z * ray.direction.z;
        let reach2 = self.radius2 + distance2 * MARGIN;
        // The comparison uses the squared distance of the line from the centre, multiplied by |d|^2 to avoid a
        // division.
        // The comparisons are negated, so that where a scene is so large that squares overflow, NaN leaves the decision
        // to the exact test.
        let is_near = !(distance2 * length2 - along * along).cmpgt(reach2 * length2);
        let is_ahead = !along.cmple(Vec4::ZERO) | !distance2.cmpgt(reach2);
        (is_near & is_ahead).bitmask() & self.lanes
    }
}

/// A list of analytic shapes that are tested one after another.
#[derive(Debug, Default)]
pub(super) struct AnalyticList {
    packets: Vec<Packet>,
    shapes: Vec<Analytic>,
}

impl AnalyticList {
    pub(super) fn new(shapes: Vec<Analytic>) -> Self {
        let packets = shapes
            .chunks(4)
            .map(|chunk| {
                let mut packet = Packet { lanes: (1 << chunk.len()) - 1, ..Packet::default() };
                for (lane, shape) in chunk.iter().enumerate() {
                    let Bounds { min, max } = shape.bounds();
                    let centre = shape.bounds().centre();
                    let radius = match shape {
                        Analytic::Sphere(sphere) => sphere.radius,
                        _ => 0.5 * (max - min).length(),
                    };
                    // The centre is rounded to f32, so the radius is padded by that rounding error.
                    let padded = radius + centre.abs().max_element() * f64::from(MARGIN);
                    packet.x[lane] = centre.x as f32;
                    packet.y[lane] = centre.y as f32;
                    packet.z[lane] = centre.z as f32;
                    packet.radius2[lane] = (padded * padded * (1.0 + f64::from(MARGIN))) as f32;
                }
                packet
            })
            .collect();
        Self { packets, shapes }
    }

    #[inline]
    pub(super) fn is_empty(&self) -> bool {
        self.shapes.is_empty()
    }

    pub(super) fn shapes(&self) -> &[Analytic] {
        &self.shapes
    }

    /// Returns the nearest hit inside the ray's segment as its t and the number of the shape.
    #[inline]
    pub(super) fn intersect(&self, ray: &Ray) -> Option<(f32, u32)> {
        let mut tfar = f64::from(ray.tfar);
        let mut nearest = None;
        self.for_candidates(ray, |index| {
            if let Some(t) = self.exact(index, ray, tfar) {
                tfar = t;
                nearest = Some((t as f32, index as u32));
            }
            false
        });
        nearest
    }

    /// Returns whether any shape is hit inside the ray's segment.
    #[inline]
    pub(super) fn occluded(&self, ray: &Ray) -> bool {
        self.for_candidates(ray, |index| self.exact(index, ray, f64::from(ray.tfar)).is_some())
    }

    /// Tests one shape in double precision. The function is not inlined, because most rays have no candidate and should
    /// not pay for its code. As in Embree, a segment that begins behind the ray's origin has no hit.
    #[inline(never)]
    fn exact(&self, index: usize, ray: &Ray, tfar: f64) -> Option<f64> {
        if ray.tnear < 0.0 {
            return None;
        }
        self.shapes[index].intersect(&DRay { tfar, ..DRay::from(ray) })
    }

    /// Calls `visit` with each candidate until `visit` returns true. Returns whether `visit` returned true.
    #[inline]
    fn for_candidates(&self, ray: &Ray, mut visit: impl FnMut(usize) -> bool) -> bool {
        let length2 = ray.direction.length_squared();
        for (number, packet) in self.packets.iter().enumerate() {
            let mut mask = packet.candidates(ray, length2);
            while mask != 0 {
                let lane = mask.trailing_zeros() as usize;
                mask &= mask - 1;
                if visit(4 * number + lane) {
                    return true;
                }
            }
        }
        false
    }
}

/// Analytic shapes as Embree user geometry, for scenes that have too many of them for a list.
#[derive(Debug)]
pub(super) struct AnalyticGeometry {
    /// The shapes, or what they are at time 0.
    pub(super) start: Vec<Analytic>,
    /// The same shapes, where they move; all of them have the same number of moments. Empty where they rest.
    pub(super) moving: Vec<MovingShape>,
}

impl UserGeometry for AnalyticGeometry {
    fn len(&self) -> usize {
        self.start.len()
    }

    fn bounds(&self, index: usize) -> ([f32; 3], [f32; 3]) {
        rounded_outwards(self.start[index].bounds())
    }

    fn intersect(&self, index: usize, ray: &Ray) -> Option<UserHit> {
        let t = self.start[index].intersect(&DRay::from(ray))?;
        Some(UserHit { t: t as f32, u: 0.0, v: 0.0, ng: crate::math::Vec3::Z })
    }
}

/// The shapes of [`AnalyticGeometry`] that move, as Embree user geometry. It is a type of its own, so that shapes that rest have no
/// choice at every ray.
#[derive(Debug)]
pub(super) struct MovingGeometry(pub(super) Arc<AnalyticGeometry>);

impl UserGeometry for MovingGeometry {
    fn len(&self) -> usize {
        self.0.moving.len()
    }

    fn bounds(&self, index: usize) -> ([f32; 3], [f32; 3]) {
        self.bounds_at(index, 0)
    }

    fn time_steps(&self) -> usize {
        self.0.moving.first().map_or(1, MovingShape::time_steps)
    }

    fn bounds_at(&self, index: usize, step: usize) -> ([f32; 3], [f32; 3]) {
        rounded_outwards(self.0.moving[index].bounds_at(step))
    }

    fn intersect(&self, index: usize, ray: &Ray) -> Option<UserHit> {
        let t = self.0.moving[index].intersect(ray)?;
        Some(UserHit { t: t as f32, u: 0.0, v: 0.0, ng: crate::math::Vec3::Z })
    }
}

/// A box in single precision. It is rounded outwards, because a box that cuts a single ULP off the shape would open a gap.
fn rounded_outwards(Bounds { min, max }: Bounds) -> ([f32; 3], [f32; 3]) {
    let down = |x: f64| (x as f32).next_down();
    let up = |x: f64| (x as f32).next_up();
    ([down(min.x), down(min.y), down(min.z)], [up(max.x), up(max.y), up(max.z)])
}
