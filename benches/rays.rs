//! The integrator's ray rate against the kernel's for the same rays.
//!
//! Records every ray that path tracing a scene asks for, then times in turn, in one process: the whole integrator; the
//! recorded rays through the scene (Embree and the list of analytic shapes); through Embree with the analytic shapes in its
//! tree as user geometry; and through Embree without them, where rays go on to what is behind. Reports rays per second
//! and ratios, best of several rounds each.
//!
//! `cargo bench --bench rays -- [SCENE.json ...]`

use std::hint::black_box;
use std::path::Path as FilePath;
use std::time::Instant;

use etendue::camera::Camera;
use etendue::desc;
use etendue::integrator::{Integrator, Path, SceneTracer, Tracer};
use etendue::math::Ray;
use etendue::sampling::{Sampler, SobolSampler};
use etendue::scene::{BuildOptions, Hit, Scene};

const RESOLUTION: u32 = 256;
const SAMPLES: u32 = 8;
const ROUNDS: usize = 5;

/// Traces, and writes down what it was asked.
struct Recorder<'s> {
    scene: &'s Scene,
    /// Rays in order; true for shadow rays.
    rays: Vec<(Ray, bool)>,
}

impl Tracer for Recorder<'_> {
    fn intersect(&mut self, ray: &Ray) -> Option<Hit> {
        self.rays.push((*ray, false));
        self.scene.intersect(ray)
    }

    fn unoccluded(&mut self, ray: &Ray) -> bool {
        self.rays.push((*ray, true));
        self.scene.unoccluded(ray)
    }
}

const PATH: Path = Path { max_depth: None, shadow_rays: 1 };

/// Path traces rows of pixels; in tiles' order it would be the same work.
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

/// Seconds of `work`, which is given the number of a thread, on so many threads at once.
fn time(threads: usize, work: impl Fn(usize) + Sync) -> f64 {
    let start = Instant::now();
    std::thread::scope(|scope| {
        for thread in 0..threads {
            let work = &work;
            scope.spawn(move || work(thread));
        }
    });
    start.elapsed().as_secs_f64()
}

/// A scene that Embree has no part in has no ray rate to compare with.
fn no_kernel() -> etendue::Error {
    etendue::Error::new(etendue::ErrorKind::Unsupported, "Embree holds nothing of this scene")
}

fn measure(path: &FilePath, threads: usize) -> etendue::Result<()> {
    let desc = desc::load(path, None)?;
    let scene = Scene::build(&desc, &BuildOptions::default())?;
    let camera = Camera::new(scene.camera(), [RESOLUTION; 2], scene.centre())?;
    // Every n-th row: each thread sees the same mixture.
    let rows = |thread: usize| (thread as u32..RESOLUTION).step_by(threads);
    let all_in_embree = BuildOptions { listed_shapes: Some(0), ..BuildOptions::default() };
    let all_in_embree = Scene::build(&desc, &all_in_embree)?;

    let recorded: Vec<Vec<(Ray, bool)>> = (0..threads)
        .map(|thread| {
            let mut recorder = Recorder { scene: &scene, rays: Vec::new() };
            black_box(render(&scene, &camera, rows(thread), &mut recorder));
            recorder.rays
        })
        .collect();
    let count: usize = recorded.iter().map(Vec::len).sum();
    let shadow = recorded.iter().flatten().filter(|(_, shadow)| *shadow).count();

    let replay = |intersect: &(dyn Fn(&Ray) -> bool + Sync), occluded: &(dyn Fn(&Ray) -> bool + Sync)| {
        time(threads, |thread| {
            let hits =
                recorded[thread].iter().filter(|(ray, shadow)| if *shadow { occluded(ray) } else { intersect(ray) });
            black_box(hits.count());
        })
    };
    let mut best = [f64::INFINITY; 4];
    for _ in 0..ROUNDS {
        let integrator = time(threads, |thread| {
            let mut tracer = SceneTracer::new(&scene);
            black_box(render(&scene, &camera, rows(thread), &mut tracer));
        });
        let through_scene = replay(&|ray| scene.intersect(ray).is_some(), &|ray| !scene.unoccluded(ray));
        let kernel = all_in_embree.kernel().ok_or_else(no_kernel)?;
        let through_tree = replay(&|ray| kernel.intersect(ray).is_some(), &|ray| kernel.occluded(ray));
        let kernel = scene.kernel().ok_or_else(no_kernel)?;
        let through_kernel = replay(&|ray| kernel.intersect(ray).is_some(), &|ray| kernel.occluded(ray));
        for (best, seconds) in best.iter_mut().zip([integrator, through_scene, through_tree, through_kernel]) {
            *best = best.min(seconds);
        }
    }
    let [integrator, through_scene, through_tree, through_kernel] = best.map(|seconds| count as f64 / seconds / 1e6);
    let samples = f64::from(RESOLUTION * RESOLUTION * SAMPLES);
    println!(
        "{}, {threads} threads: {count} rays ({:.2} closest-hit and {:.2} shadow rays a sample)",
        path.display(),
        (count - shadow) as f64 / samples,
        shadow as f64 / samples,
    );
    println!("  integrator                {integrator:6.2} Mrays/s");
    for (what, rate) in [
        ("scene                ", through_scene),
        ("Embree, all in it    ", through_tree),
        ("Embree, polygons only", through_kernel),
    ] {
        println!("  {what}     {rate:6.2} Mrays/s, integrator / this {:.3}", integrator / rate);
    }
    Ok(())
}

fn main() {
    // cargo passes --bench; what is left are scenes.
    let mut scenes: Vec<String> = std::env::args().skip(1).filter(|argument| !argument.starts_with('-')).collect();
    if scenes.is_empty() {
        scenes = vec!["scenes/room.json".to_owned(), "scenes/million.json".to_owned()];
    }
    for scene in scenes {
        for threads in [1, 2] {
            if let Err(error) = measure(scene.as_ref(), threads) {
                eprintln!("{scene}: {error}");
                break;
            }
        }
    }
}
