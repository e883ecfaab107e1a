//! Sites of records: the first diffuse hits of camera rays, and the light gathered there.

use super::super::media::{arrive, left_after};
use super::super::photon::Gather;
use super::super::vertex::Vertex;
use super::super::{SceneTracer, Tracer as _};
use super::hemisphere::{Incident, Strata};
use super::record::MAX_WALLS;
use crate::bsdf::Model as _;
use crate::camera::Camera;
use crate::math::{Frame, Ray, Vec3};
use crate::sampling::{Sampler as _, SobolSampler};
use crate::scene::{PathMedia, Scene};
use crate::spectrum::Rgb;

/// Throughput below which a branch at glass is not followed.
const MIN_THROUGHPUT: f32 = 0.05;

/// Most mirrors and glass surfaces in a row.
const MAX_SPECULAR_BOUNCES: u32 = 16;

/// A point on a diffuse surface.
#[derive(Clone, Copy, Debug)]
pub(super) struct Site {
    pub p: Vec3,
    /// Shading normal on the side that is seen.
    pub n: Vec3,
    /// Geometric normal on that side.
    facing: Vec3,
    /// Origin of rays that leave the surface.
    origin: Vec3,
    /// Size of a pixel at the site: the length of the path to the camera times the pixel's angle.
    pub pixel_size: f32,
    /// Fraction of the pixel's light that comes from here, by what mirrors and glass on the path transmit.
    pub throughput: f32,
    /// The media in which the site is seen, and in which rays leave it.
    media: Option<PathMedia>,
}

/// Appends the first diffuse hits that read the cache behind the film position (x, y), as seen from the point `u` of the lens where
/// there is one. Where a surface reflects and refracts, both branches are followed.
pub(super) fn first_diffuse_hits(
    scene: &Scene,
    camera: &Camera,
    [x, y]: [f32; 2],
    u: [f32; 2],
    tracer: &mut SceneTracer,
    sites: &mut Vec<Site>,
) {
    let first = camera.ray_through_lens(x, y, u);
    let pixel = camera.pixel_width(x, y);
    let mut branches = vec![(first, scene.media_at(&first), 1.0, 0.0, 0)];
    while let Some((ray, mut media, mut throughput, distance, bounces)) = branches.pop() {
        let Some(hit) = arrive(scene, tracer, &ray, &mut media) else { continue };
        if media.is_some() {
            throughput *= left_after::<Rgb>(scene, &ray, Some(&hit), media, &()).max_element();
        }
        let distance = distance + hit.t;
        // The fraction of the light that passes is that of power, so refraction is that of importance.
        let mut slot = None;
        let vertex = Vertex::<Rgb>::of_light_path(scene, &ray, &hit, (), media, &mut slot);
        if vertex.lobes.have_diffuse() && vertex.bsdf.is_even() {
            let facing = vertex.facing();
            let (point, n) = (vertex.surface.point, vertex.facing_shading());
            let origin = point.offset(facing);
            sites.push(Site { p: point.p, n, facing, origin, pixel_size: pixel.at(distance), throughput, media });
        }
        for lobe in vertex.specular_lobes().into_iter().flatten() {
            let throughput = throughput * lobe.weight.max_element();
            if throughput >= MIN_THROUGHPUT
                && bounces < MAX_SPECULAR_BOUNCES
                && let Some(ray) = vertex.leave_specular(&lobe)
            {
                let media = vertex.media_beyond(scene, &ray);
                branches.push((ray, media, throughput, distance, bounces + 1));
            }
        }
    }
}

/// Number of directions along the surface in which walls are searched for.
const WALL_DIRECTIONS: usize = 16;

/// Height over the surface at which walls are searched for, in radii. It is above 0 so that a surface that bends is no
/// wall.
const WALL_HEIGHT: f32 = 0.02;

/// A surface whose normal has a larger cosine with the record's is the same surface, rising, and no wall.
const SAME_SURFACE_COSINE: f32 = 0.7;

impl Site {
    /// The light that each ray of the strata finds; its random numbers follow from the sampler's seed and `number`.
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
            // An interpolated normal may give directions that pass through the face. They contribute nothing.
            if wi.dot(self.facing) <= 0.0 {
                return Incident { radiance: Rgb::ZERO, distance: f32::INFINITY };
            }
            let (radiance, distance) = source.incident(scene, Ray::new(self.origin, wi), self.media, sampler, tracer);
            // As in an image, radiance that is not finite counts as black.
            Incident { radiance: if radiance.is_finite() { radiance } else { Rgb::ZERO }, distance }
        };
        (0..strata.count()).map(one).collect()
    }

    /// Walls that stand on the surface within `radius`, as planes: the unit normal towards the site and the distance
    /// from it. With them comes the radius that stays on this side of any further walls, beyond the number that a
    /// record holds.
    pub fn walls(&self, radius: f32, tracer: &mut SceneTracer) -> ([([f32; 3], f32); MAX_WALLS], f32) {
        let scene = tracer.scene;
        let frame = Frame::from_normal(self.facing);
        let origin = self.origin + self.facing * (WALL_HEIGHT * radius);
        let mut met: Vec<(Vec3, Vec3)> = Vec::new();
        for i in 0..WALL_DIRECTIONS {
            let (sin, cos) = (std::f32::consts::TAU * (i as f32 + 0.5) / WALL_DIRECTIONS as f32).sin_cos();
            let direction = (frame.s * cos + frame.t * sin).normalize();
            let ray = Ray::segment(origin, direction, radius);
            let Some(hit) = tracer.intersect(&ray) else { continue };
            let surface = scene.interaction(&ray, &hit);
            let normal = if surface.ng.dot(direction) > 0.0 { -surface.ng } else { surface.ng };
            if normal.dot(self.facing) < SAME_SURFACE_COSINE {
                met.push((surface.point.p - self.p, normal));
            }
        }
        met.sort_by(|a, b| a.0.length_squared().total_cmp(&b.0.length_squared()));
        let mut walls = [([0.0; 3], 0.0); MAX_WALLS];
        let (mut kept, mut reach) = (0, radius);
        for (at, normal) in met {
            // A point behind a wall that is already listed needs no wall of its own, and neither does a point in that
            // wall.
            let slack = 1e-3 * radius;
            let is_hidden = |&(n, distance): &([f32; 3], f32)| at.dot(Vec3::from_array(n)) < slack - distance;
            if walls[..kept].iter().any(is_hidden) {
                continue;
            }
            if kept == MAX_WALLS {
                reach = at.length();
                break;
            }
            walls[kept] = (normal.to_array(), -at.dot(normal));
            kept += 1;
        }
        (walls, reach)
    }
}
