//! What edits of a scene cost against building it, and what a scene made for edits costs its rays.
//!
//! A million triangles (a wavy sheet), a lamp and a floor. Each edit is timed several times and the best is told, in
//! milliseconds and as a share of the full build. Rays are the same random ones in both scenes, in turns.
//!
//! `cargo bench --bench editing`

use std::hint::black_box;
use std::sync::Arc;
use std::time::Instant;

use etendue::desc::{
    BsdfDesc, CameraDesc, FilmDesc, FovAxis, MaterialDesc, MeshDesc, SceneDesc, ShapeDesc, SurfaceDesc, Surfaces,
};
use etendue::embree::{Device, DeviceOptions};
use etendue::math::{DAffine3, DVec3, Ray, Vec3};
use etendue::scene::{BuildOptions, Scene};
use etendue::spectrum::Rgb;

const ROUNDS: usize = 7;

/// A wavy sheet of 2 n^2 triangles.
fn sheet(n: usize) -> MeshDesc {
    let at = |i: usize| 2.0 * i as f64 / n as f64 - 1.0;
    let corner = |x: usize, y: usize| (y * (n + 1) + x) as u32;
    MeshDesc {
        positions: (0..=n)
            .flat_map(|y| (0..=n).map(move |x| (x, y)))
            .map(|(x, y)| DVec3::new(at(x), at(y), 0.2 * (9.0 * at(x)).sin() * (7.0 * at(y)).cos()))
            .collect(),
        triangles: (0..n)
            .flat_map(|y| (0..n).map(move |x| (x, y)))
            .flat_map(|(x, y)| {
                let [a, b, c, d] = [corner(x, y), corner(x + 1, y), corner(x + 1, y + 1), corner(x, y + 1)];
                [[a, b, c], [a, c, d]]
            })
            .collect(),
        ..MeshDesc::default()
    }
}

fn surface(shape: ShapeDesc, transform: DAffine3, emission: Option<Rgb>) -> SurfaceDesc {
    let path = String::new();
    SurfaceDesc {
        path,
        name: String::new(),
        shape,
        local: DAffine3::IDENTITY,
        transform,
        material: Some(0),
        emission,
        emits_both: false,
        web: None,
        spectrum: None,
        hidden: false,
    }
}

fn scene(mesh: MeshDesc) -> SceneDesc {
    let quad = |z: f64| [[-2.0, -2.0, z], [2.0, -2.0, z], [2.0, 2.0, z], [-2.0, 2.0, z]].map(DVec3::from_array);
    let material = |name: &str| MaterialDesc {
        name: name.to_owned(),
        path: String::new(),
        bsdf: BsdfDesc::Lambert { albedo: Rgb::splat(0.5) },
        ..MaterialDesc::default()
    };
    SceneDesc {
        camera: CameraDesc::Perspective {
            eye: DVec3::new(0.0, 0.0, 4.0),
            look_at: DVec3::ZERO,
            up: DVec3::Y,
            fov_deg: 60.0,
            fov_axis: FovAxis::Horizontal,
            film: FilmDesc::default(),
        },
        materials: vec![material("a"), material("b")],
        meshes: vec![Arc::new(mesh)],
        surfaces: Surfaces::from_iter([
            surface(ShapeDesc::Mesh { mesh: 0, smooth: false }, DAffine3::IDENTITY, None),
            surface(ShapeDesc::Quad(quad(-1.0)), DAffine3::IDENTITY, None),
            surface(ShapeDesc::Quad(quad(3.0)), DAffine3::IDENTITY, Some(Rgb::ONE)),
        ]),
        ..SceneDesc::default()
    }
}

/// The best of several times, in milliseconds.
fn best(work: impl Fn() -> etendue::Result<Scene>) -> etendue::Result<f64> {
    let mut best = f64::INFINITY;
    for _ in 0..ROUNDS {
        let start = Instant::now();
        let scene = work()?;
        best = best.min(start.elapsed().as_secs_f64() * 1e3);
        drop(scene);
    }
    Ok(best)
}

type Change = fn(&mut SceneDesc);

fn edits(original: &SceneDesc, device: &Device) -> etendue::Result<()> {
    let with = |dynamic| BuildOptions { device: Some(device.clone()), dynamic, ..BuildOptions::default() };
    let changes: [(&str, bool, Change); 6] = [
        ("material", false, |desc| desc.materials[0].bsdf = BsdfDesc::Black),
        ("material index", false, |desc| desc.surfaces[0].material = Some(1)),
        ("emission", false, |desc| desc.surfaces[2].emission = Some(Rgb::new(2.0, 1.0, 1.0))),
        ("camera", false, |desc| {
            if let CameraDesc::Perspective { eye, .. } = &mut desc.camera {
                *eye = DVec3::new(-4.0, 1.0, 0.5);
            }
        }),
        ("transform of the mesh", true, |desc| {
            desc.surfaces[0].transform = DAffine3::from_rotation_z(0.4);
        }),
        ("a mesh of 1000 triangles more", true, |desc| {
            desc.meshes.push(Arc::new(sheet(22)));
            let mesh = desc.meshes.len() - 1;
            let place = DAffine3::from_translation(DVec3::Z);
            desc.surfaces.push(surface(ShapeDesc::Mesh { mesh, smooth: false }, place, None));
        }),
    ];
    // Warm, so that the first is not slower.
    drop(Scene::build(original, &with(false))?);
    let mut full = [0.0; 2];
    for dynamic in [false, true] {
        let time = best(|| Scene::build(original, &with(dynamic)))?;
        println!("full build, dynamic {dynamic}: {time:.1} ms");
        full[usize::from(dynamic)] = time;
    }
    for (what, dynamic, change) in changes {
        let options = with(dynamic);
        let scene = Scene::build(original, &options)?;
        let mut desc = original.clone();
        change(&mut desc);
        let time = best(|| scene.rebuild(&desc, &options))?;
        let full = full[usize::from(dynamic)];
        println!("  {what}: {time:.4} ms, {:.4} % of the full build", 100.0 * time / full);
    }
    Ok(())
}

/// Rays per second of one thread, in millions, of two scenes in turns.
fn rates(scenes: [&Scene; 2]) -> [f64; 2] {
    const COUNT: usize = 400_000;
    let mut state = 1_u64;
    let mut number = || {
        state = state.wrapping_mul(0x5851_f42d_4c95_7f2d).wrapping_add(0x1405_7b7e_f767_814f);
        (state >> 40) as f32 / (1 << 24) as f32 * 2.0 - 1.0
    };
    let segments: Vec<(DVec3, Vec3)> = (0..COUNT)
        .map(|_| {
            let from = Vec3::new(1.5 * number(), 1.5 * number(), 0.5 + number().abs());
            let to = Vec3::new(number(), number(), 0.0);
            (from.as_dvec3(), (to - from).normalize())
        })
        .collect();
    let mut best = [f64::INFINITY; 2];
    for _ in 0..ROUNDS {
        for (scene, best) in scenes.iter().zip(&mut best) {
            let start = Instant::now();
            let hits = segments
                .iter()
                .filter(|(from, direction)| scene.intersect(&Ray::new(scene.to_scene(*from), *direction)).is_some());
            black_box(hits.count());
            *best = best.min(start.elapsed().as_secs_f64());
        }
    }
    best.map(|seconds| COUNT as f64 / seconds / 1e6)
}

fn main() -> etendue::Result<()> {
    let device = Device::new(&DeviceOptions::default())?;
    edits(&scene(sheet(708)), &device)?;
    println!("rays of one thread, flat and with hierarchies of their own:");
    for n in [4, 6, 8, 12, 16, 32, 100, 708] {
        let desc = scene(sheet(n));
        let with = |dynamic| BuildOptions { device: Some(device.clone()), dynamic, ..BuildOptions::default() };
        let (flat, own) = (Scene::build(&desc, &with(false))?, Scene::build(&desc, &with(true))?);
        let [flat_rate, own_rate] = rates([&flat, &own]);
        let what = if own.info().instances > 0 { "own hierarchy" } else { "copied too" };
        println!(
            "  {:7} triangles: {flat_rate:.2} and {own_rate:.2} Mrays/s, ratio {:.3} ({what})",
            2 * n * n,
            own_rate / flat_rate
        );
    }
    Ok(())
}
