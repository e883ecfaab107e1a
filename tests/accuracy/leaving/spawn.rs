//! Rays away from a surface, and what they meet.

use etendue::desc::{BsdfDesc, SceneDesc, ShapeDesc};
use etendue::math::{DAffine3, DVec3, Frame, HitPoint, Ray, Vec3};
use etendue::sampling::{Rng, warps};
use etendue::scene::{BuildOptions, Scene, SurfaceInteraction};
use etendue::spectrum::Rgb;

use crate::common::scenes::{camera, scene};

pub const GREY: BsdfDesc = BsdfDesc::Lambert { albedo: Rgb::splat(0.5) };

/// Shapes tested in a list before Embree is asked, or all in Embree's tree.
pub const LIST: usize = 16;
pub const TREE: usize = 0;

/// A number in [-1, 1).
pub fn signed(rng: &mut Rng) -> f64 {
    2.0 * f64::from(rng.next_4d()[0]) - 1.0
}

/// A point in the cube [-1, 1)^3.
pub fn random_point(rng: &mut Rng) -> DVec3 {
    let [x, y, z, _] = rng.next_4d().map(|u| 2.0 * f64::from(u) - 1.0);
    DVec3::new(x, y, z)
}

pub fn random_direction(rng: &mut Rng) -> DVec3 {
    warps::uniform_sphere(rng.next_2d()).as_dvec3().normalize()
}

/// 10^x for x even in [low, high).
pub fn random_power(rng: &mut Rng, low: f64, high: f64) -> f64 {
    10_f64.powf(low + (high - low) * 0.5 * (signed(rng) + 1.0))
}

pub fn build(desc: &SceneDesc, listed: usize) -> Scene {
    Scene::build(desc, &BuildOptions { threads: 1, listed_shapes: Some(listed), ..BuildOptions::default() })
        .expect("a scene of the test")
}

/// One shape under a transform, seen from `eye`.
///
/// A speck stands in the eye, so that the scene's frame has its origin there and not in the corner of the shape's box
/// that is nearest to it.
pub fn single(shape: ShapeDesc, transform: DAffine3, eye: DVec3, look_at: DVec3) -> SceneDesc {
    let size = 1e-6 * (eye - look_at).length();
    let speck = ShapeDesc::Triangle([eye, eye + size * DVec3::X, eye + size * DVec3::Y]);
    let mut desc = scene(camera(eye, look_at, 60.0), vec![(shape, GREY, None), (speck, GREY, None)]);
    desc.surfaces[0].transform = transform;
    desc
}

/// A unit vector on the side of the unit normal `n`: all directions alike, or half of the time one near the horizon, at a
/// cosine down to 1e-6. Two digits below that single precision cannot tell above from below.
pub fn away(n: Vec3, rng: &mut Rng) -> Vec3 {
    let frame = Frame::from_normal(n);
    let [a, b, c, _] = rng.next_4d();
    if c < 0.5 {
        let up = warps::uniform_hemisphere([a, b]);
        return frame.to_world(up.with_z(up.z.max(1e-6))).normalize();
    }
    let cos = 10_f32.powf(-6.0 * a);
    let sin = (1.0 - cos * cos).sqrt();
    let (y, x) = (std::f32::consts::TAU * b).sin_cos();
    frame.to_world(Vec3::new(sin * x, sin * y, cos)).normalize()
}

/// The first hit of surface `surface` on the segment from `origin` towards `aim`.
pub fn shoot(scene: &Scene, origin: Vec3, aim: Vec3, surface: u32) -> Option<SurfaceInteraction> {
    let ray = Ray::new(origin, (aim - origin).normalize());
    let hit = scene.intersect(&ray)?;
    let interaction = scene.interaction(&ray, &hit);
    (interaction.surface == surface).then_some(interaction)
}

/// Rays sent away, and those that met what they had left.
#[derive(Clone, Copy, Debug)]
pub struct Tally {
    pub rays: u64,
    pub bad: u64,
    /// What the bound on the error is multiplied by.
    factor: f32,
}

impl Default for Tally {
    fn default() -> Self {
        Self::with_bound_times(1.0)
    }
}

impl Tally {
    /// For rays that start nearer to the surface than they should.
    pub fn with_bound_times(factor: f32) -> Self {
        Self { rays: 0, bad: 0, factor }
    }

    /// Both together.
    pub fn add(&mut self, other: Self) {
        self.rays += other.rays;
        self.bad += other.bad;
    }

    /// A ray away from `from` into the side of `n`.
    fn ray(&self, from: &SurfaceInteraction, n: Vec3, rng: &mut Rng) -> Ray {
        let point = HitPoint { error: self.factor * from.point.error, ..from.point };
        Ray::new(point.offset(n), away(n, rng))
    }

    /// Leaves `from` into the side of `n` with `rays` rays; bad are those that meet its surface within `reach`.
    pub fn leave(&mut self, scene: &Scene, from: &SurfaceInteraction, n: Vec3, reach: f32, rays: u64, rng: &mut Rng) {
        for _ in 0..rays {
            let ray = Ray { tfar: reach, ..self.ray(from, n, rng) };
            self.rays += 1;
            self.bad += u64::from(met(scene, &ray) == Some(from.surface));
        }
    }

    /// Enters a closed body through its surface at `from`; bad are the rays that do not find its other side.
    pub fn enter(&mut self, scene: &Scene, from: &SurfaceInteraction, rays: u64, rng: &mut Rng) {
        for _ in 0..rays {
            let ray = self.ray(from, -from.ng, rng);
            self.rays += 1;
            self.bad += u64::from(met(scene, &ray) != Some(from.surface));
        }
    }
}

/// The number of the surface that a ray meets first.
pub fn met(scene: &Scene, ray: &Ray) -> Option<u32> {
    scene.intersect(ray).map(|hit| scene.interaction(ray, &hit).surface)
}

/// How far a ray starts from the point it leaves.
pub fn offset(from: &SurfaceInteraction, n: Vec3) -> f64 {
    f64::from((from.point.offset(n) - from.point.p).length())
}

/// Walks by diffuse reflection from a ray's first hit on; bad is a ray that meets nothing, or something from a side that
/// `is_allowed` forbids: the surface's number, and whether its back was met. Such a walk ends there.
pub fn walk(scene: &Scene, start: Ray, bounces: u64, rng: &mut Rng, is_allowed: impl Fn(u32, bool) -> bool) -> Tally {
    let mut tally = Tally::default();
    let mut ray = start;
    for _ in 0..bounces {
        tally.rays += 1;
        let hit = scene.intersect(&ray).map(|hit| scene.interaction(&ray, &hit));
        let Some(hit) = hit.filter(|hit| is_allowed(hit.surface, hit.ng.dot(ray.direction) > 0.0)) else {
            tally.bad += 1;
            break;
        };
        let n = if hit.ng.dot(ray.direction) > 0.0 { -hit.ng } else { hit.ng };
        ray = tally.ray(&hit, n, rng);
    }
    tally
}
