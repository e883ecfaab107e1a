//! A few analytic shapes, tested one after another before Embree is asked.
//!
//! Spheres as primitives of Embree make every ray walk a second tree, which costs a room with three spheres half of its ray
//! rate. A short list costs a few nanoseconds instead, and what it hits shortens the segment that Embree has to search.
//! Four bounding spheres at a time are rejected in single precision, with a margin that covers its rounding; what remains
//! is decided by the exact test in double precision.

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
    /// One bit for each lane that holds a shape.
    lanes: u32,
}

/// Relative error of the rejection test in f32, about thirty roundings, covered by the margin.
const MARGIN: f32 = 4e-6;

impl Packet {
    /// One bit for each shape that the ray's line may meet in front of its origin.
    #[inline]
    fn candidates(&self, ray: &Ray, length2: f32) -> u32 {
        let x = self.x - Vec4::splat(ray.origin.x);
        let y = self.y - Vec4::splat(ray.origin.y);
        let z = self.z - Vec4::splat(ray.origin.z);
        let distance2 = x * x + y * y + z * z;
        let along = x * ray.direction.x + y * ray.direction.y + z * ray.direction.z;
        let reach2 = self.radius2 + distance2 * MARGIN;
        // Squared distance of the line from the centre, times |d|^2 to save a division.
        // Negated comparisons: where a scene is so large that squares overflow, NaN leaves the decision to the exact test.
        let is_near = !(distance2 * length2 - along * along).cmpgt(reach2 * length2);
        let is_ahead = !along.cmple(Vec4::ZERO) | !distance2.cmpgt(reach2);
        (is_near & is_ahead).bitmask() & self.lanes
    }
}

/// Shapes tested in turn.
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
                    // The centre is rounded to f32: pad by that.
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

    /// The nearest hit inside the ray's segment: t and the shape's number.
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

    /// Whether anything is hit inside the ray's segment.
    #[inline]
    pub(super) fn occluded(&self, ray: &Ray) -> bool {
        self.for_candidates(ray, |index| self.exact(index, ray, f64::from(ray.tfar)).is_some())
    }

    /// The test in double precision, out of line: most rays have no candidate and should not carry it along. A segment that
    /// begins behind the origin is none, here as in Embree.
    #[inline(never)]
    fn exact(&self, index: usize, ray: &Ray, tfar: f64) -> Option<f64> {
        if ray.tnear < 0.0 {
            return None;
        }
        self.shapes[index].intersect(&DRay { tfar, ..DRay::from(ray) })
    }

    /// Calls `visit` with each candidate until it returns true; returns whether it did.
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

/// The same shapes as user geometry, for scenes with too many of them for a list.
#[derive(Debug)]
pub(super) struct AnalyticGeometry(pub(super) Vec<Analytic>);

impl UserGeometry for AnalyticGeometry {
    fn len(&self) -> usize {
        self.0.len()
    }

    fn bounds(&self, index: usize) -> ([f32; 3], [f32; 3]) {
        // Rounded outwards: a box that cuts off a ULP of the shape would open a gap.
        let Bounds { min, max } = self.0[index].bounds();
        let down = |x: f64| (x as f32).next_down();
        let up = |x: f64| (x as f32).next_up();
        ([down(min.x), down(min.y), down(min.z)], [up(max.x), up(max.y), up(max.z)])
    }

    fn intersect(&self, index: usize, ray: &Ray) -> Option<UserHit> {
        let t = self.0[index].intersect(&DRay::from(ray))?;
        Some(UserHit { t: t as f32, u: 0.0, v: 0.0, ng: crate::math::Vec3::Z })
    }
}
