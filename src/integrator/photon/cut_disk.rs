//! A kernel's disk that an edge, a corner or a wall cuts off: the share that is left, and the photons that lie in it.

use std::f32::consts::{PI, TAU};

use super::super::Tracer;
use super::super::vertex::Vertex;
use super::estimate::{Kernel, THICKNESS};
use crate::math::{Frame, HitPoint, Ray, Vec3};
use crate::spectrum::Spectrum;

/// Sectors of the disk.
const SECTORS: usize = 8;

/// Steps from the centre to the rim at which the surface is tested.
const STEPS: usize = 8;

/// How far the surface extends from a point in each sector.
pub(super) struct CutDisk {
    p: Vec3,
    frame: Frame,
    /// Distances, at most the disk's radius.
    reach: [f32; SECTORS],
}

impl CutDisk {
    /// Measures the surface around a vertex by rays, up to `radius`.
    pub fn new<C: Spectrum, T: Tracer>(tracer: &mut T, vertex: &Vertex<'_, C>, radius: f32) -> Self {
        let normal = vertex.facing();
        let frame = Frame::from_normal(normal);
        let p = vertex.surface.point.p;
        let height = THICKNESS * radius;
        let time = vertex.surface.point.time;
        let error = vertex.surface.point.error.max(HitPoint::rounding_error(p, normal));
        let above = p + normal * (0.5 * height + error);
        // Extent along the lines between sectors, as shares of the radius.
        let ways: [f32; SECTORS] = std::array::from_fn(|line| {
            let (sin, cos) = (TAU * line as f32 / SECTORS as f32).sin_cos();
            let along = frame.s * cos + frame.t * sin;
            let level = Ray::segment(above, along * radius, 1.0).at_time(time);
            let wall = tracer.intersect(&level).map_or(1.0, |hit| hit.t);
            // The surface must lie below the line.
            let is_there = |share: f32, tracer: &mut T| {
                let origin = above + along * (radius * share);
                let down = Ray::segment(origin, normal * (-1.5 * height - 2.0 * error), 1.0).at_time(time);
                !tracer.unoccluded(&down)
            };
            let step = |i: usize| wall * (i as f32 + 0.5) / STEPS as f32;
            // Where the surface lies below the far end, it is taken to lie below all of the line.
            if is_there(wall * 0.99, tracer) {
                return wall;
            }
            let steps = (0..STEPS).take_while(|i| is_there(step(*i), tracer)).count();
            wall * steps as f32 / STEPS as f32
        });
        // No point of a sector may lie behind a straight wall that both of its lines meet. The foot of the perpendicular on
        // the wall is nearer than the nearer of the two hits, by the factor of the cosine of half a sector at most.
        let foot = (PI / SECTORS as f32).cos();
        let reach = std::array::from_fn(|sector| {
            let nearer = ways[sector].min(ways[(sector + 1) % SECTORS]);
            radius * if nearer < 1.0 { nearer * foot } else { 1.0 }
        });
        Self { p, frame, reach }
    }

    /// Whether a point of the surface belongs to the part of the disk that is left.
    #[inline]
    pub fn holds(&self, p: Vec3) -> bool {
        let local = self.frame.to_local(p - self.p);
        let turn = local.y.atan2(local.x) / TAU;
        let sector = ((turn - turn.floor()) * SECTORS as f32) as usize;
        local.x.hypot(local.y) <= self.reach[sector.min(SECTORS - 1)]
    }

    /// The share of a kernel's integral over the part that is left, at least that of one sector.
    #[inline]
    pub fn share(&self, kernel: Kernel, radius: f32) -> f32 {
        let sum: f32 = self.reach.iter().map(|reach| kernel.mass(reach / radius)).sum();
        (sum / SECTORS as f32).max(1.0 / SECTORS as f32)
    }
}
