//! The integrators ray by ray: paths that are told where to go, and counts of what they meet.

use etendue::integrator::{Integrator, Path, Tracer};
use etendue::math::{DVec3, Ray, Vec3};
use etendue::sampling::{Rng, Sampler, warps};
use etendue::scene::{Hit, Scene};

/// A path tracer without a limit.
pub const PATH: Path = Path::new(None, 1);

/// At a smooth interface: refraction wherever there is any.
pub const REFRACT: f32 = 1.0 - f32::EPSILON;

/// At a smooth interface: reflection.
pub const REFLECT: f32 = 0.0;

/// A sampler whose every path survives and takes these choices between reflection and refraction in turn, the last one
/// for ever.
pub struct Choices<'c> {
    choices: &'c [f32],
    next: usize,
}

impl<'c> Choices<'c> {
    pub fn new(choices: &'c [f32]) -> Self {
        Self { choices, next: 0 }
    }
}

impl Sampler for Choices<'_> {
    fn start(&mut self, _: u32, _: u32) {
        self.next = 0;
    }

    fn pixel_2d(&mut self) -> [f32; 2] {
        [0.5; 2]
    }

    fn next_2d(&mut self) -> [f32; 2] {
        [0.5; 2]
    }

    fn next_4d(&mut self) -> [f32; 4] {
        let choice = self.choices[self.next.min(self.choices.len() - 1)];
        self.next += 1;
        [0.5, 0.5, choice, 0.0]
    }
}

/// Independent random numbers.
pub struct Random(pub Rng);

impl Sampler for Random {
    fn start(&mut self, _: u32, _: u32) {}

    fn pixel_2d(&mut self) -> [f32; 2] {
        [0.5; 2]
    }

    fn next_2d(&mut self) -> [f32; 2] {
        self.0.next_2d()
    }

    fn next_4d(&mut self) -> [f32; 4] {
        self.0.next_4d()
    }
}

/// Keeps every ray that looks for a surface, and counts those that find none.
pub struct Recorder<'s> {
    scene: &'s Scene,
    pub rays: Vec<Ray>,
    pub escaped: u64,
    most: usize,
}

impl<'s> Recorder<'s> {
    /// Ends the path after `most` rays, as a stopped render does: by finding nothing.
    pub fn new(scene: &'s Scene, most: usize) -> Self {
        Self { scene, rays: Vec::new(), escaped: 0, most }
    }
}

impl Tracer for Recorder<'_> {
    fn intersect(&mut self, ray: &Ray) -> Option<Hit> {
        if self.rays.len() == self.most {
            return None;
        }
        self.rays.push(*ray);
        let hit = self.scene.intersect(ray);
        self.escaped += u64::from(hit.is_none());
        hit
    }

    fn unoccluded(&mut self, ray: &Ray) -> bool {
        self.scene.unoccluded(ray)
    }
}

/// The rays of the path that starts here, world frame, and takes these choices; at most `most`.
pub fn follow(scene: &Scene, (origin, direction): (DVec3, DVec3), choices: &[f32], most: usize) -> Vec<Ray> {
    let mut tracer = Recorder::new(scene, most);
    let ray = Ray::new(scene.to_scene(origin), direction.normalize().as_vec3a());
    PATH.radiance(scene, ray, &mut Choices::new(choices), &mut tracer, &mut |_| {});
    tracer.rays
}

/// Origin, world frame, and unit direction of a ray in double precision.
pub fn line(scene: &Scene, ray: &Ray) -> (DVec3, DVec3) {
    (ray.origin.as_dvec3() + scene.centre(), ray.direction.as_dvec3().normalize())
}

/// Angle between two directions in radians, exact for small ones too.
pub fn angle(a: DVec3, b: DVec3) -> f64 {
    a.cross(b).length().atan2(a.dot(b))
}

/// (rays without a surface, rays) of so many random paths from the camera's place in a room that is closed.
pub fn escapes(scene: &Scene, rays: u64) -> (u64, u64) {
    let mut random = Random(Rng::new(7, 0));
    let (mut escaped, mut traced) = (0, 0);
    while traced < rays {
        let direction: Vec3 = warps::uniform_sphere(random.next_2d());
        let mut tracer = Recorder::new(scene, usize::MAX);
        PATH.radiance(scene, Ray::new(Vec3::ZERO, direction), &mut random, &mut tracer, &mut |_| {});
        escaped += tracer.escaped;
        traced += tracer.rays.len() as u64;
    }
    (escaped, traced)
}
