//! Lights: irradiance of each kind against its closed form, by the samplers alone and in renders.
//!
//! A light of radiance 1 that fills the configuration factor F of a receiver's hemisphere makes the irradiance pi F there,
//! and the radiance F of a white Lambert receiver.

mod backplates;
mod backs;
mod clear_sky;
mod hierarchy;
mod many;
mod points;
mod polygons;
mod portals;
mod round;
mod sides;
pub mod sky;
mod solid_angles;
mod spheres;
pub mod spots;
mod web_areas;
pub mod webs;
mod weights;

pub use sky::{drawn, received, relative};

use std::f64::consts::PI;

use etendue::desc::{BsdfDesc, IntegratorDesc, SceneDesc, ShapeDesc};
use etendue::emitter::{Emitter, EmitterSet, SphereEmitter, TriangleEmitter};
use etendue::math::{DVec3, Vec3};
use etendue::sampling::{Sampler, SobolSampler};
use etendue::shape::{Sphere, Triangle};
use etendue::spectrum::Rgb;

use crate::common::scenes::{Job, camera, mean_and_error, render, scene};
use crate::record::{Case, Effort, Entry};
use crate::stats;

pub fn cases() -> Vec<Entry> {
    let topics = [
        solid_angles::cases(),
        polygons::cases(),
        spheres::cases(),
        points::cases(),
        spots::cases(),
        webs::cases(),
        many::cases(),
        weights::cases(),
        hierarchy::cases(),
        sky::cases(),
        clear_sky::cases(),
        round::cases(),
        backs::cases(),
        portals::cases(),
        backplates::cases(),
        sides::cases(),
        web_areas::cases(),
    ];
    topics.into_iter().flatten().collect()
}

const INTEGRATORS: [(&str, IntegratorDesc); 3] =
    [("path", IntegratorDesc::Path), ("Whitted", IntegratorDesc::Whitted), ("direct", IntegratorDesc::Direct)];

// ---- closed forms ----

/// Configuration factor of a polygon for a receiver at `p` with unit normal `n`, cut off at its horizon.
///
/// Source: Lambert 1760, *Photometria*: the sum over the edges of angle times cosine of the normal of the edge's plane.
pub fn polygon_factor(p: DVec3, n: DVec3, polygon: &[DVec3]) -> f64 {
    let mut seen = Vec::with_capacity(polygon.len() + 1);
    for (place, &a) in polygon.iter().enumerate() {
        let (a, b) = (a - p, polygon[(place + 1) % polygon.len()] - p);
        let (above_a, above_b) = (a.dot(n), b.dot(n));
        if above_a >= 0.0 {
            seen.push(a);
        }
        if above_a * above_b < 0.0 {
            seen.push(a + (b - a) * (above_a / (above_a - above_b)));
        }
    }
    let edge = |place: usize| {
        let (a, b) = (seen[place], seen[(place + 1) % seen.len()]);
        // As a difference: the edge of a small and far polygon keeps its digits.
        let normal = a.cross(b - a);
        let length = normal.length();
        if length == 0.0 { 0.0 } else { length.atan2(a.dot(b)) * normal.dot(n) / length }
    };
    ((0..seen.len()).map(edge).sum::<f64>() / (2.0 * PI)).abs()
}

/// Configuration factor of a sphere of radius `sin` at distance 1 whose centre is `tilt` off the receiver's normal.
///
/// Source: Howell, *A Catalog of Radiation Heat Transfer Configuration Factors*, B-43.
pub fn sphere_factor(sin: f64, tilt: f64) -> f64 {
    let angle = sin.asin();
    if tilt <= 0.5 * PI - angle {
        return sin * sin * tilt.cos();
    }
    if tilt >= 0.5 * PI + angle {
        return 0.0;
    }
    let x = ((1.0 - sin) * (1.0 + sin)).sqrt() / sin;
    let y = -x / tilt.tan();
    let w = ((sin - tilt.cos()) * (sin + tilt.cos())).max(0.0).sqrt() / sin;
    (sin * sin * (tilt.cos() * y.acos() - x * w) + (w / x).atan()) / PI
}

// ---- samplers alone ----

/// A normal this far off a direction.
fn tilted(towards: DVec3, degrees: f64) -> DVec3 {
    let (sin, cos) = degrees.to_radians().sin_cos();
    cos * towards + sin * towards.any_orthonormal_vector()
}

/// One-sided triangles of radiance 1, a fan over the polygon, which is seen counter-clockwise from its bright side.
fn fan(polygon: &[Vec3]) -> Vec<Emitter> {
    let triangle = |k: usize| triangle_light([polygon[0], polygon[k], polygon[k + 1]], Rgb::ONE);
    (1..polygon.len() - 1).map(triangle).collect()
}

fn triangle_light(vertices: [Vec3; 3], radiance: Rgb) -> Emitter {
    let triangle = Triangle::new(vertices).expect("a triangle with an area");
    let reach = vertices.into_iter().map(|v| v.abs().max_element()).fold(0.0, f32::max);
    Emitter::Triangle(TriangleEmitter::new(triangle, radiance, 2.0 * f32::EPSILON * reach))
}

fn sphere_light(centre: DVec3, radius: f64) -> Emitter {
    Emitter::Sphere(SphereEmitter { sphere: Sphere { centre, radius }, radiance: Rgb::ONE })
}

/// How many independent parts an estimate is made of.
const REPLICATES: u32 = 32;

/// Irradiance over pi at `p`, on a receiver with unit normal `n`, from samples of the lights: of each replicate.
fn replicates(set: &EmitterSet, p: Vec3, n: DVec3, size: u32, seed: u64) -> Vec<f64> {
    let mut sampler = SobolSampler::new(seed, size);
    let mut value = |i| {
        sampler.start(0, i);
        let Some(sample) = set.sample(p, sampler.next_4d()) else { return 0.0 };
        // Never below 0, and a NaN is kept to be found.
        let cos = n.dot(sample.wi.as_dvec3());
        let value = f64::from(sample.radiance.r()) * cos / f64::from(sample.pdf) / PI;
        if cos <= 0.0 { 0.0 } else { value }
    };
    (0..REPLICATES).map(|r| (r * size..(r + 1) * size).map(&mut value).sum::<f64>() / f64::from(size)).collect()
}

/// [`replicates`] with the usual number of samples: mean and standard error.
fn irradiance(case: &Case, set: &EmitterSet, p: Vec3, n: DVec3) -> (f64, f64) {
    stats::mean_and_error(&replicates(set, p, n, case.count(4096, 65_536) as u32, 42))
}

/// How the error of samples at `p` falls with their number.
fn convergence(case: &mut Case, what: &str, set: &EmitterSet, p: Vec3, n: DVec3, exact: f64) {
    let effort = |samples: u32| {
        let started = std::time::Instant::now();
        let values = replicates(set, p, n, samples, 43);
        let seconds = started.elapsed().as_secs_f64() / f64::from(REPLICATES);
        let squares = values.iter().map(|value| (value / exact - 1.0).powi(2)).sum::<f64>();
        Effort { samples, seconds, rmse: (squares / f64::from(REPLICATES)).sqrt() }
    };
    let efforts: Vec<Effort> = [64, 512, 4096].into_iter().map(effort).collect();
    case.convergence(what, &efforts);
}

// ---- renders ----

const WHITE: BsdfDesc = BsdfDesc::Lambert { albedo: Rgb::ONE };

fn point([x, y, z]: [f64; 3]) -> DVec3 {
    DVec3::new(x, y, z)
}

/// A quad whose normal, by the order of its corners, points towards the receiver.
fn quad(corners: [[f64; 3]; 4]) -> ShapeDesc {
    ShapeDesc::Quad(corners.map(point))
}

/// A horizontal rectangle that shines down.
pub fn ceiling(x: [f64; 2], y: [f64; 2], z: f64) -> ShapeDesc {
    quad([[x[0], y[0], z], [x[0], y[1], z], [x[1], y[1], z], [x[1], y[0], z]])
}

/// A white receiver around the origin with normal z, seen from `eye` above it, and shapes that shine with radiance 1.
pub fn lit(eye: f64, size: f64, lights: Vec<ShapeDesc>) -> SceneDesc {
    let receiver = quad([[-size, -size, 0.0], [size, -size, 0.0], [size, size, 0.0], [-size, size, 0.0]]);
    let mut surfaces = vec![(receiver, WHITE, None)];
    surfaces.extend(lights.into_iter().map(|light| (light, BsdfDesc::Black, Some(Rgb::ONE))));
    scene(camera(DVec3::new(0.0, 0.0, eye), DVec3::ZERO, 0.02), surfaces)
}

/// The radiance of the receiver by every integrator, each in a row.
fn rendered(case: &mut Case, what: &str, desc: &SceneDesc, exact: f64, tolerance: f64) {
    let samples = case.count(2048, 8192) as u32;
    for (name, integrator) in INTEGRATORS {
        let (image, _) = render(desc, &Job { resolution: [8, 8], samples, integrator, ..Job::default() });
        case.mean(format!("{what}, {name}"), mean_and_error(&image), exact, tolerance);
    }
}

/// Where a shadow ray ends, off the way from `p` into the sampled direction, in radians.
fn aim(p: Vec3, wi: Vec3, target: Vec3) -> f64 {
    let way = target.as_dvec3() - p.as_dvec3();
    way.cross(wi.as_dvec3()).length() / way.length()
}
