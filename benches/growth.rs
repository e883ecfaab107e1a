//! How time and memory grow with triangles, with the resolution and with threads.
//!
//! A room whose floor is a landscape of fractal noise, finer with every step, under one small lamp. For each number of
//! triangles: seconds of the build, bytes that Embree and the arrays take per triangle, and the rays per second of path
//! tracing and of Embree alone with the same rays, closest-hit and shadow rays apart: one by one in its robust mode, in full packets
//! in the order of waves of paths, and one by one in its fast mode.
//!
//! `cargo bench --bench growth [-- MOST-TRIANGLES]` (10^7 takes 5 GiB and some minutes)

#[path = "recorded/polygons.rs"]
mod polygons;
mod recorded;
#[path = "recorded/replay.rs"]
mod replay;

use std::hint::black_box;
use std::ops::ControlFlow;

use etendue::camera::Camera;
use etendue::desc::{
    BsdfDesc, CameraDesc, FilmDesc, FovAxis, MaterialDesc, MeshDesc, RenderDesc, SceneDesc, ShapeDesc, SurfaceDesc,
};
use etendue::embree;
use etendue::integrator::SceneTracer;
use etendue::math::{DAffine3, DVec3};
use etendue::render::{Render, RenderSettings};
use etendue::sampling::Rng;
use etendue::scene::{BuildOptions, Scene};
use etendue::spectrum::Rgb;
use recorded::{ROUNDS, Rays, record, render_in_waves, rows, time};
use replay::{keep_best, replay, replay_in_packets};

const COUNTS: [usize; 5] = [1_000, 10_000, 100_000, 1_000_000, 10_000_000];
const THREADS: usize = 2;

/// Value noise over the unit square, `OCTAVES` of it, in lattices whose numbers depend on nothing but their place.
const OCTAVES: u64 = 11;

fn height(x: f64, y: f64) -> f64 {
    let lattice = |octave: u64, i: f64, j: f64| {
        let place = (octave << 48) ^ ((i as u64) << 24) ^ j as u64;
        f64::from(Rng::new(place, 0).next_f32()) - 0.5
    };
    let of_octave = |octave: u64| {
        let scale = 4.0 * 2_f64.powi(octave as i32);
        let (x, y) = (x * scale, y * scale);
        let (i, j) = (x.floor(), y.floor());
        let ease = |t: f64| t * t * (3.0 - 2.0 * t);
        let (u, v) = (ease(x - i), ease(y - j));
        let row = |j: f64| lattice(octave, i, j) * (1.0 - u) + lattice(octave, i + 1.0, j) * u;
        (row(j) * (1.0 - v) + row(j + 1.0) * v) * 2_f64.powf(-0.9 * octave as f64)
    };
    (0..OCTAVES).map(of_octave).sum()
}

/// A square of 4 x 4 with about so many triangles.
fn landscape(triangles: usize) -> MeshDesc {
    let side = (triangles as f64 / 2.0).sqrt().round() as u32;
    let at = |i: u32| f64::from(i) / f64::from(side);
    let point = |i: u32, j: u32| DVec3::new(4.0 * at(i) - 2.0, 0.5 * height(at(i), at(j)), 4.0 * at(j) - 2.0);
    let vertex = |i: u32, j: u32| i * (side + 1) + j;
    MeshDesc {
        positions: (0..=side).flat_map(|i| (0..=side).map(move |j| point(i, j))).collect(),
        triangles: (0..side)
            .flat_map(|i| {
                (0..side).map(move |j| [vertex(i, j), vertex(i, j + 1), vertex(i + 1, j + 1), vertex(i + 1, j)])
            })
            .flat_map(|[a, b, c, d]| [[a, b, c], [a, c, d]])
            .collect(),
        ..MeshDesc::default()
    }
}

fn room(triangles: usize) -> SceneDesc {
    let camera = CameraDesc::Perspective {
        eye: DVec3::new(0.0, 1.3, 1.9),
        look_at: DVec3::new(0.0, 0.2, 0.0),
        up: DVec3::Y,
        fov_deg: 70.0,
        fov_axis: FovAxis::Horizontal,
        film: FilmDesc::default(),
    };
    let mut desc = SceneDesc { camera, ..SceneDesc::default() };
    desc.materials.push(MaterialDesc {
        name: "wall".into(),
        path: "materials.wall".into(),
        bsdf: BsdfDesc::Lambert { albedo: Rgb::splat(0.6) },
        ..MaterialDesc::default()
    });
    desc.meshes.push(landscape(triangles).into());
    let mut add = |shape, emission| {
        desc.surfaces.push(SurfaceDesc {
            path: format!("surfaces[{}]", desc.surfaces.len()),
            name: String::new(),
            shape,
            local: DAffine3::IDENTITY,
            transform: DAffine3::IDENTITY,
            material: Some(0),
            emission,
            emits_both: false,
            web: None,
            spectrum: None,
            hidden: false,
        });
    };
    add(ShapeDesc::Mesh { mesh: 0, smooth: false }, None);
    let corner = |x, y, z| DVec3::new(x, y, z);
    let (low, high, r) = (-1.0, 2.0, 2.0);
    for wall in [
        [corner(-r, low, -r), corner(r, low, -r), corner(r, high, -r), corner(-r, high, -r)],
        [corner(-r, low, r), corner(-r, high, r), corner(r, high, r), corner(r, low, r)],
        [corner(-r, low, -r), corner(-r, high, -r), corner(-r, high, r), corner(-r, low, r)],
        [corner(r, low, -r), corner(r, low, r), corner(r, high, r), corner(r, high, -r)],
        [corner(-r, high, -r), corner(r, high, -r), corner(r, high, r), corner(-r, high, r)],
    ] {
        add(ShapeDesc::Quad(wall), None);
    }
    let (s, y) = (0.15, 1.9);
    let lamp = [corner(-s, y, -s), corner(s, y, -s), corner(s, y, s), corner(-s, y, s)];
    add(ShapeDesc::Quad(lamp), Some(Rgb::splat(40.0)));
    desc
}

fn of_triangles(most: usize) -> etendue::Result<()> {
    println!(
        "| triangles | build, s | Embree, bytes a triangle | arrays | path, Mrays/s | ns a ray | Embree (closest-hit, shadow) | \
         share | in packets | share | fast | share |"
    );
    println!("|---|---|---|---|---|---|---|---|---|---|---|---|");
    for count in COUNTS.into_iter().filter(|count| *count <= most) {
        let desc = room(count);
        let scene = Scene::build(&desc, &BuildOptions::default())?;
        let info = scene.info();
        let per_triangle = |bytes: usize| bytes as f64 / info.triangles as f64;
        let camera = Camera::new(scene.camera(), [recorded::RESOLUTION; 2], scene.centre())?;
        let fast = polygons::kernel(&scene, &polygons::triangles(&desc, scene.centre())?, false)?;
        drop(desc);
        let [recorded, waves] = [false, true].map(|in_waves| record(&scene, &camera, THREADS, in_waves));
        let all: usize = recorded.iter().map(Rays::count).sum();
        let closest: usize = recorded.iter().map(|rays| rays.closest.len()).sum();
        let robust = scene.kernel().expect("the landscape is Embree's");
        let (mut path, mut best) = (f64::INFINITY, [[f64::INFINITY; 2]; 3]);
        for _ in 0..ROUNDS {
            path = path.min(time(THREADS, |thread| {
                black_box(render_in_waves(&scene, &camera, rows(thread, THREADS), &mut SceneTracer::new(&scene)));
            }));
            let one_by_one = |kernel: &embree::Scene| {
                replay(&recorded, |ray| kernel.intersect(ray).is_some(), |ray| kernel.occluded(ray))
            };
            keep_best(&mut best[0], one_by_one(robust));
            keep_best(&mut best[1], replay_in_packets(&waves, robust));
            keep_best(&mut best[2], one_by_one(&fast));
        }
        let rate = |rays: usize, seconds: f64| rays as f64 / seconds / 1e6;
        print!(
            "| {} | {:.3} | {:.1} | {:.1} | {:.2} | {:.0} |",
            info.triangles,
            info.build_time.as_secs_f64(),
            per_triangle(info.embree_bytes),
            per_triangle(info.geometry_bytes),
            rate(all, path),
            1e9 * path * THREADS as f64 / all as f64,
        );
        for [closest_time, shadow_time] in best {
            print!(
                " {:.2} ({:.2}, {:.2}) | {:.3} |",
                rate(all, closest_time + shadow_time),
                rate(closest, closest_time),
                rate(all - closest, shadow_time),
                (closest_time + shadow_time) / path,
            );
        }
        println!();
    }
    Ok(())
}

fn seconds(scene: &Scene, side: u32, samples: u32, threads: usize) -> etendue::Result<f64> {
    // What a pilot takes does not grow with the picture.
    let (reuse, light_paths) = (Some(false), Some(false));
    let desc = RenderDesc { resolution: [side; 2], samples, reuse, light_paths, ..RenderDesc::default() };
    let mut best = f64::INFINITY;
    for _ in 0..ROUNDS {
        let mut render =
            Render::new(scene, RenderSettings { desc: desc.clone(), threads, ..RenderSettings::default() })?;
        let summary = render.run(&mut |_| ControlFlow::Continue(()))?;
        best = best.min(summary.elapsed.as_secs_f64());
    }
    Ok(best)
}

fn main() -> etendue::Result<()> {
    let most = std::env::args().filter_map(|argument| argument.parse().ok()).next().unwrap_or(10_000_000);
    of_triangles(most)?;
    let scene = Scene::build(&room(100_000), &BuildOptions::default())?;
    println!("\n| pixels | s for 16 samples | ns a sample |");
    println!("|---|---|---|");
    for side in [64, 128, 256, 512, 1024] {
        let time = seconds(&scene, side, 16, THREADS)?;
        println!("| {side} x {side} | {time:.3} | {:.0} |", 1e9 * time * THREADS as f64 / f64::from(16 * side * side));
    }
    let times = [1, 2].map(|threads| seconds(&scene, 256, 64, threads));
    let [one, two] = times;
    let (one, two) = (one?, two?);
    println!("\n1 thread {one:.3} s, 2 threads {two:.3} s: {:.3} times as fast", one / two);
    Ok(())
}
