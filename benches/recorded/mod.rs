//! Path tracing a scene by hand, and writing down every ray that it asks for.

use std::time::Instant;

use etendue::camera::Camera;
use etendue::integrator::{Integrator, Path, Sample, Tracer, Wave};
use etendue::math::Ray;
use etendue::sampling::{Sampler, SobolSampler};
use etendue::scene::{Hit, Scene};

/// Side of the image.
pub const RESOLUTION: u32 = 256;
/// Samples per pixel.
pub const SAMPLES: u32 = 8;
/// Rounds of which the best counts.
pub const ROUNDS: usize = 5;

/// Rays of one thread, each kind in its order.
#[derive(Default)]
pub struct Rays {
    /// Those that look for the nearest hit.
    pub closest: Vec<Ray>,
    /// Those that look for any.
    pub shadow: Vec<Ray>,
}

impl Rays {
    /// How many.
    pub fn count(&self) -> usize {
        self.closest.len() + self.shadow.len()
    }
}

/// Traces, and writes down what it was asked.
struct Recorder<'s> {
    scene: &'s Scene,
    rays: Rays,
}

impl Tracer for Recorder<'_> {
    fn intersect(&mut self, ray: &Ray) -> Option<Hit> {
        self.rays.closest.push(*ray);
        self.scene.intersect(ray)
    }

    fn unoccluded(&mut self, ray: &Ray) -> bool {
        self.rays.shadow.push(*ray);
        self.scene.unoccluded(ray)
    }
}

/// The integrator.
const PATH: Path = Path::new(None, 1);

/// Every ray that so many threads ask for, each taking every n-th row: all see the same mixture. Path by path, or in the order
/// of waves.
pub fn record(scene: &Scene, camera: &Camera, threads: usize, in_waves: bool) -> Vec<Rays> {
    (0..threads)
        .map(|thread| {
            let mut recorder = Recorder { scene, rays: Rays::default() };
            let rows = rows(thread, threads);
            std::hint::black_box(if in_waves {
                render_in_waves(scene, camera, rows, &mut recorder)
            } else {
                render(scene, camera, rows, &mut recorder)
            });
            recorder.rays
        })
        .collect()
}

/// The rows of a thread.
pub fn rows(thread: usize, threads: usize) -> impl Iterator<Item = u32> {
    (thread as u32..RESOLUTION).step_by(threads)
}

/// Path traces rows of pixels, path by path.
fn render<T: Tracer>(scene: &Scene, camera: &Camera, rows: impl Iterator<Item = u32>, tracer: &mut T) -> f32 {
    let mut sampler = SobolSampler::new(7, SAMPLES);
    let mut sum = 0.0;
    for y in rows {
        for x in 0..RESOLUTION {
            for sample in 0..SAMPLES {
                sampler.start(y * RESOLUTION + x, sample);
                let [dx, dy] = sampler.pixel_2d();
                let ray = camera.ray(x as f32 + dx, y as f32 + dy);
                sum += PATH.radiance(scene, ray, &mut sampler, tracer, &mut |_| ()).element_sum();
            }
        }
    }
    sum
}

/// The same in waves, as renders do it; in tiles' order it would be the same work.
pub fn render_in_waves<T: Tracer>(
    scene: &Scene,
    camera: &Camera,
    rows: impl Iterator<Item = u32>,
    tracer: &mut T,
) -> f32 {
    const PIXELS: usize = 128 / SAMPLES as usize;
    let mut wave = Wave::default();
    let mut samples = vec![Sample::new(SobolSampler::new(7, SAMPLES)); PIXELS * SAMPLES as usize];
    let mut sum = 0.0;
    for y in rows {
        for left in (0..RESOLUTION).step_by(PIXELS) {
            for (number, sample) in (0..).zip(&mut samples) {
                let x = left + number / SAMPLES;
                sample.sampler.start(y * RESOLUTION + x, number % SAMPLES);
                let [dx, dy] = sample.sampler.pixel_2d();
                sample.ray = camera.ray(x as f32 + dx, y as f32 + dy);
            }
            PATH.radiance_of_many(scene, &mut samples, &[], &mut wave, tracer);
            sum += samples.iter().map(|sample| sample.radiance.element_sum()).sum::<f32>();
        }
    }
    sum
}

/// Seconds of `work`, which is given the number of a thread, on so many threads at once.
pub fn time(threads: usize, work: impl Fn(usize) + Sync) -> f64 {
    let start = Instant::now();
    std::thread::scope(|scope| {
        for thread in 0..threads {
            let work = &work;
            scope.spawn(move || work(thread));
        }
    });
    start.elapsed().as_secs_f64()
}
