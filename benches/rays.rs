//! The integrator's ray rate against the kernel's for the same rays.
//!
//! Records every ray that path tracing a scene asks for, then times in turn, in one process: the whole integrator; the
//! recorded rays through the scene (Embree and the list of analytic shapes); through Embree with the analytic shapes in its
//! tree as user geometry; and through Embree without them, where rays go on to what is behind. Reports rays per second
//! and ratios, best of several rounds each.
//!
//! `cargo bench --bench rays -- [SCENE.json ...]`

mod recorded;

use std::hint::black_box;
use std::path::Path as FilePath;

use etendue::camera::Camera;
use etendue::desc;
use etendue::integrator::SceneTracer;
use etendue::math::Ray;
use etendue::scene::{BuildOptions, Scene};
use recorded::{RESOLUTION, ROUNDS, SAMPLES, record, render, rows, time};

/// A scene that Embree has no part in has no ray rate to compare with.
fn no_kernel() -> etendue::Error {
    etendue::Error::new(etendue::ErrorKind::Unsupported, "Embree holds nothing of this scene")
}

fn measure(path: &FilePath, threads: usize) -> etendue::Result<()> {
    let desc = desc::load(path, None)?;
    let scene = Scene::build(&desc, &BuildOptions::default())?;
    let camera = Camera::new(scene.camera(), [RESOLUTION; 2], scene.centre())?;
    let all_in_embree = BuildOptions { listed_shapes: Some(0), ..BuildOptions::default() };
    let all_in_embree = Scene::build(&desc, &all_in_embree)?;

    let recorded = record(&scene, &camera, threads);
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
            black_box(render(&scene, &camera, rows(thread, threads), &mut tracer));
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
