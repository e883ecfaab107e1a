//! The integrator's ray rate against the kernel's for the same rays.
//!
//! Records every ray that path tracing a scene asks for, then times in turn, in one process: the whole integrator; the
//! recorded rays through the scene (Embree and the list of analytic shapes); through Embree with the analytic shapes in its
//! tree as user geometry; and through Embree without them, where rays go on to what is behind, in its robust mode, in its
//! fast one, and in full packets, in the order of waves of paths. Closest-hit and shadow rays apart. Reports rays per second and the
//! integrator's share of what Embree alone would do, best of several rounds each.
//!
//! `cargo bench --bench rays -- [SCENE.json ...]`

#[path = "recorded/polygons.rs"]
mod polygons;
mod recorded;
#[path = "recorded/replay.rs"]
mod replay;

use std::hint::black_box;
use std::path::Path as FilePath;

use etendue::camera::Camera;
use etendue::desc;
use etendue::integrator::SceneTracer;
use etendue::math::Ray;
use etendue::scene::{BuildOptions, Scene};
use polygons::{kernel, triangles};
use recorded::{RESOLUTION, ROUNDS, Rays, SAMPLES, record, render_in_waves, rows, time};
use replay::{keep_best, replay, replay_in_packets};

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

    let mesh = triangles(&desc, scene.centre())?;
    let fast = kernel(&scene, &mesh, false)?;
    let (all, polygons) = (all_in_embree.kernel().ok_or_else(no_kernel)?, scene.kernel().ok_or_else(no_kernel)?);

    let recorded = record(&scene, &camera, threads, false);
    let count: usize = recorded.iter().map(Rays::count).sum();
    let closest: usize = recorded.iter().map(|rays| rays.closest.len()).sum();

    type Ask<'a> = &'a (dyn Fn(&Ray) -> bool + Sync);
    let through: [(&str, Ask<'_>, Ask<'_>); 4] = [
        ("scene", &|ray| scene.intersect(ray).is_some(), &|ray| !scene.unoccluded(ray)),
        ("Embree, all in it", &|ray| all.intersect(ray).is_some(), &|ray| all.occluded(ray)),
        ("Embree, polygons only", &|ray| polygons.intersect(ray).is_some(), &|ray| polygons.occluded(ray)),
        ("the same, robust off", &|ray| fast.intersect(ray).is_some(), &|ray| fast.occluded(ray)),
    ];
    let waves = record(&scene, &camera, threads, true);
    let mut in_packets = [f64::INFINITY; 2];
    let mut integrator = f64::INFINITY;
    let mut best = [[f64::INFINITY; 2]; 4];
    for _ in 0..ROUNDS {
        integrator = integrator.min(time(threads, |thread| {
            black_box(render_in_waves(&scene, &camera, rows(thread, threads), &mut SceneTracer::new(&scene)));
        }));
        for (best, (_, intersect, occluded)) in best.iter_mut().zip(through) {
            keep_best(best, replay(&recorded, intersect, occluded));
        }
        keep_best(&mut in_packets, replay_in_packets(&waves, polygons));
    }
    let rate = |count: usize, seconds: f64| count as f64 / seconds / 1e6;
    let samples = f64::from(RESOLUTION * RESOLUTION * SAMPLES);
    println!(
        "{}, {threads} threads: {count} rays ({:.2} closest-hit and {:.2} shadow rays a sample)",
        path.display(),
        closest as f64 / samples,
        (count - closest) as f64 / samples,
    );
    println!("  integrator               {:6.2} Mrays/s", rate(count, integrator));
    let through = through.map(|(what, ..)| what).into_iter().chain(["polygons, in packets"]);
    for (what, [closest_time, shadow_time]) in through.zip(best.into_iter().chain([in_packets])) {
        println!(
            "  {what:22}   {:6.2} Mrays/s (closest-hit {:.2}, shadow {:.2}), integrator / this {:.3}",
            rate(count, closest_time + shadow_time),
            rate(closest, closest_time),
            rate(count - closest, shadow_time),
            (closest_time + shadow_time) / integrator,
        );
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
