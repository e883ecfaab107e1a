//! Places where indirect light is asked for: the first diffuse hits of camera rays, and the light gathered there.

use super::super::photon::Gather;
use super::super::vertex::Vertex;
use super::super::{SceneTracer, Tracer as _};
use super::hemisphere::{Incident, Strata};
use super::record::WALLS;
use crate::bsdf::Model as _;
use crate::camera::Camera;
use crate::math::{Frame, Ray, Vec3};
use crate::sampling::{Sampler as _, SobolSampler};
use crate::scene::Scene;
use crate::spectrum::Rgb;

/// Share of a pixel's light below which a branch at glass is not followed.
const LEAST_SHARE: f32 = 0.05;

/// Mirrors and glass in a row.
const MOST_SPECULAR: u32 = 16;

/// A point on a diffuse surface.
#[derive(Clone, Copy, Debug)]
pub(super) struct Site {
    pub p: Vec3,
    /// Shading normal on the side that it is seen from.
    pub n: Vec3,
    /// Geometric normal on that side.
    facing: Vec3,
    /// Where rays leave it.
    origin: Vec3,
    /// Size of a pixel there: the way of the light to the eye times the pixel's angle.
    pub pixel: f32,
    /// Share of the pixel's light that comes from here, by what mirrors and glass on the way let pass.
    pub share: f32,
}

/// Hands over the first diffuse hits behind the film position (x, y), both ways where a surface reflects and refracts.
pub(super) fn seen(scene: &Scene, camera: &Camera, [x, y]: [f32; 2], tracer: &mut SceneTracer, found: &mut Vec<Site>) {
    let first = camera.ray(x, y);
    let angle = first.direction.distance(camera.ray(x + 1.0, y).direction);
    let mut ways = vec![(first, 1.0, 0.0, 0)];
    while let Some((ray, share, way, bounces)) = ways.pop() {
        let Some(hit) = tracer.intersect(&ray) else { continue };
        let way = way + hit.t;
        // What part of the light passes is what part of power does, so refraction is that of importance.
        let vertex = Vertex::<Rgb>::of_light_path(scene, &ray, &hit, ());
        if vertex.bsdf.lobes().have_diffuse() && !vertex.bsdf.is_black() {
            let facing = vertex.facing();
            let (point, n) = (vertex.surface.point, vertex.facing_shading());
            let origin = point.offset(facing);
            found.push(Site { p: point.p, n, facing, origin, pixel: way * angle, share });
        }
        for lobe in vertex.specular_lobes().into_iter().flatten() {
            let share = share * lobe.weight.max_element();
            if share >= LEAST_SHARE
                && bounces < MOST_SPECULAR
                && let Some(ray) = vertex.leave_local(lobe.wi)
            {
                ways.push((ray, share, way, bounces + 1));
            }
        }
    }
}

/// Directions along the surface in which walls are looked for.
const DIRECTIONS: usize = 16;

/// Height over the surface at which they are, in radii: a surface that bends is not a wall.
const HEIGHT: f32 = 0.02;

/// What is met with a normal that is nearer to the record's than this is the surface itself, rising.
const SAME_SURFACE: f32 = 0.7;

impl Site {
    /// What each ray of the strata brings back; random numbers by the sampler's seed and `number`.
    pub fn gather(
        &self,
        source: &Gather,
        strata: Strata,
        number: u32,
        sampler: &mut SobolSampler,
        tracer: &mut SceneTracer,
    ) -> Vec<Incident> {
        let frame = Frame::from_normal(self.n);
        let scene = tracer.scene;
        let one = |stratum| {
            sampler.start(number, stratum);
            let wi = frame.to_world(strata.direction(stratum, sampler.pixel_2d())).normalize();
            // A direction through the face, which an interpolated normal may have, brings nothing.
            if wi.dot(self.facing) <= 0.0 {
                return Incident { radiance: Rgb::ZERO, distance: f32::INFINITY };
            }
            let (radiance, distance) = source.incident(scene, Ray::new(self.origin, wi), sampler, tracer);
            // As in an image: what is not finite counts as black.
            Incident { radiance: if radiance.is_finite() { radiance } else { Rgb::ZERO }, distance }
        };
        (0..strata.count()).map(one).collect()
    }

    /// Walls that stand on the surface within `radius`, as planes: the unit normal towards the site and the distance from it.
    /// Where there are more than are kept, the radius that stays this side of the others.
    pub fn walls(&self, radius: f32, tracer: &mut SceneTracer) -> ([([f32; 3], f32); WALLS], f32) {
        let scene = tracer.scene;
        let frame = Frame::from_normal(self.facing);
        let origin = self.origin + self.facing * (HEIGHT * radius);
        let mut met: Vec<(Vec3, Vec3)> = Vec::new();
        for i in 0..DIRECTIONS {
            let (sin, cos) = (std::f32::consts::TAU * (i as f32 + 0.5) / DIRECTIONS as f32).sin_cos();
            let direction = (frame.s * cos + frame.t * sin).normalize();
            let ray = Ray { origin, direction, tnear: 0.0, tfar: radius };
            let Some(hit) = tracer.intersect(&ray) else { continue };
            let surface = scene.interaction(&ray, &hit);
            let normal = if surface.ng.dot(direction) > 0.0 { -surface.ng } else { surface.ng };
            if normal.dot(self.facing) < SAME_SURFACE {
                met.push((surface.point.p - self.p, normal));
            }
        }
        met.sort_by(|a, b| a.0.length_squared().total_cmp(&b.0.length_squared()));
        let mut walls = [([0.0; 3], 0.0); WALLS];
        let (mut kept, mut reach) = (0, radius);
        for (at, normal) in met {
            // What a wall hides needs no other; what lies in it neither.
            let slack = 1e-3 * radius;
            let is_hidden = |&(n, distance): &([f32; 3], f32)| at.dot(Vec3::from_array(n)) < slack - distance;
            if walls[..kept].iter().any(is_hidden) {
                continue;
            }
            if kept == WALLS {
                reach = at.length();
                break;
            }
            walls[kept] = (normal.to_array(), -at.dot(normal));
            kept += 1;
        }
        (walls, reach)
    }
}
