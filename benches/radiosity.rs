//! What radiosity costs, and what it saves.
//!
//! First its growth: time and memory of a solution for more and more elements, in the Cornell box, whose few walls are divided
//! finer and finer, and in a room with balls of more and more triangles, which clusters have to keep from costing their
//! square; with the exponents. Then pictures of the Cornell box: time and relMSE of the solution and of the path tracer, for
//! one view and for 64 along an orbit, which need one solution.
//!
//! `cargo bench --bench radiosity [-- growth|pictures]`

use std::f64::consts::TAU;
use std::ops::ControlFlow;
use std::sync::Arc;
use std::time::Instant;

use etendue::desc::{
    BsdfDesc, CameraDesc, FilmDesc, IntegratorDesc, MaterialDesc, MeshDesc, RadiosityDesc, RenderDesc, SceneDesc,
    ShapeDesc, SurfaceDesc,
};
use etendue::integrator::radiosity::{Radiosity, RadiositySummary};
use etendue::math::{DAffine3, DVec3};
use etendue::output;
use etendue::render::{Render, RenderSettings, Workers};
use etendue::scene::{BuildOptions, Scene};
use etendue::spectrum::Rgb;
use etendue::{Alone, Result};

/// Images of this side.
const RESOLUTION: u32 = 128;
const VIEWS: u32 = 64;

fn cornell() -> Result<SceneDesc> {
    etendue::desc::load("scenes/cornell.json".as_ref(), None)
}

fn add(desc: &mut SceneDesc, shape: ShapeDesc, albedo: f32, emission: Option<Rgb>, transform: DAffine3) {
    let material = desc.materials.len();
    desc.materials.push(MaterialDesc {
        name: String::new(),
        path: String::new(),
        bsdf: BsdfDesc::Lambert { albedo: Rgb::splat(albedo) },
        ..MaterialDesc::default()
    });
    let local = DAffine3::IDENTITY;
    let path = String::new();
    desc.surfaces.push(SurfaceDesc {
        path,
        name: String::new(),
        shape,
        local,
        transform,
        material: Some(material),
        emission,
        emits_both: false,
        web: None,
        spectrum: None,
        hidden: false,
    });
}

/// A closed room with a lamp and four balls of about so many triangles together.
fn balls(triangles: f64) -> SceneDesc {
    let rings = ((triangles / 16.0).sqrt().round() as u32).max(3);
    let columns = 2 * rings;
    let mut positions = Vec::new();
    for i in 0..=rings {
        for j in 0..columns {
            let (sin, cos) = (0.5 * TAU * f64::from(i) / f64::from(rings)).sin_cos();
            let (y, x) = (TAU * f64::from(j) / f64::from(columns)).sin_cos();
            positions.push(DVec3::new(sin * x, sin * y, cos));
        }
    }
    let mut mesh = Vec::new();
    for i in 0..rings {
        for j in 0..columns {
            let at = |i: u32, j: u32| i * columns + j % columns;
            mesh.extend([[at(i, j), at(i + 1, j), at(i + 1, j + 1)], [at(i, j), at(i + 1, j + 1), at(i, j + 1)]]);
        }
    }
    let mut desc = SceneDesc::default();
    desc.meshes.push(Arc::new(MeshDesc { positions, triangles: mesh, ..MeshDesc::default() }));
    for i in 0..4 {
        let angle = TAU * f64::from(i) / 4.0;
        let place = DVec3::new(0.55 * angle.cos(), -0.6, 0.55 * angle.sin());
        let transform = DAffine3::from_translation(place) * DAffine3::from_scale(DVec3::splat(0.3));
        add(&mut desc, ShapeDesc::Mesh { mesh: 0, smooth: true }, 0.5, None, transform);
    }
    let corner = |i: usize| DVec3::new([-1.0, 1.0][i & 1], [-1.0, 1.0][i >> 1 & 1], [-1.0, 1.0][i >> 2]);
    for wall in [[0, 2, 6, 4], [1, 5, 7, 3], [0, 4, 5, 1], [2, 3, 7, 6], [0, 1, 3, 2], [4, 6, 7, 5]] {
        add(&mut desc, ShapeDesc::Quad(wall.map(corner)), 0.6, None, DAffine3::IDENTITY);
    }
    let lamp = [[-0.3, -0.3], [0.3, -0.3], [0.3, 0.3], [-0.3, 0.3]].map(|[x, z]| DVec3::new(x, 0.99, z));
    add(&mut desc, ShapeDesc::Quad(lamp), 0.0, Some(Rgb::splat(5.0)), DAffine3::IDENTITY);
    desc
}

fn solve(desc: &SceneDesc, radiosity: &RadiosityDesc) -> Result<RadiositySummary> {
    let scene = Scene::build(desc, &BuildOptions::default())?;
    Ok(*Radiosity::solve(&scene, radiosity, &mut Alone::default())?.summary())
}

/// Exponent of y ~ x^p, by least squares.
fn exponent(points: &[(f64, f64)]) -> f64 {
    let n = points.len() as f64;
    let mean = |f: &dyn Fn(&(f64, f64)) -> f64| points.iter().map(f).sum::<f64>() / n;
    let (x, y) = (mean(&|p| p.0.ln()), mean(&|p| p.1.ln()));
    let covariance = mean(&|p| (p.0.ln() - x) * (p.1.ln() - y));
    covariance / mean(&|p| (p.0.ln() - x).powi(2))
}

fn growth(name: &str, cases: Vec<(SceneDesc, RadiosityDesc)>) -> Result<()> {
    println!("{name}\n| elements | links | seconds | MiB | iterations |\n|---|---|---|---|---|");
    let (mut times, mut bytes) = (Vec::new(), Vec::new());
    for (desc, radiosity) in cases {
        let it = solve(&desc, &radiosity)?;
        let (seconds, mebibytes) = (it.elapsed.as_secs_f64(), it.memory as f64 / f64::from(1 << 20));
        println!("| {} | {} | {seconds:.2} | {mebibytes:.1} | {} |", it.elements, it.links, it.iterations);
        times.push((it.elements as f64, seconds));
        bytes.push((it.elements as f64, it.memory as f64));
    }
    println!("exponents: time {:.2}, memory {:.2}\n", exponent(&times), exponent(&bytes));
    Ok(())
}

fn all_growth() -> Result<()> {
    let fine = |size: f64, error: f64| RadiosityDesc {
        element_size: Some(size),
        error,
        memory: 4096,
        ..RadiosityDesc::default()
    };
    let room = cornell()?;
    // The error falls as the square root of an element's share: all links are judged alike.
    let sizes = [(100.0, 20.0), (33.0, 5.0), (11.0, 1.2), (4.0, 0.3)];
    growth("Cornell box", sizes.map(|(size, error)| (room.clone(), fine(size, error))).into())?;
    let counts = [1e3, 1e4, 1e5];
    growth("four balls", counts.map(|count| (balls(count), fine(0.2, 10.0))).into())
}

/// The camera of a view, on an arc before the open side of the box.
fn view(number: u32) -> CameraDesc {
    let angle = (f64::from(number) / f64::from(VIEWS) - 0.5) * 0.6;
    let middle = DVec3::new(278.0, 273.0, 280.0);
    let eye = middle + 1080.0 * DVec3::new(angle.sin(), 0.0, -angle.cos());
    CameraDesc::Perspective {
        eye,
        look_at: middle,
        up: DVec3::Y,
        fov_deg: 39.3,
        fov_axis: Default::default(),
        film: FilmDesc::default(),
    }
}

fn pictures() -> Result<()> {
    let mut desc = cornell()?;
    desc.camera = view(20);
    let scene = Scene::build(&desc, &BuildOptions::default())?;
    let workers = Workers::pool(0)?;
    let base = RenderDesc { resolution: [RESOLUTION; 2], ..RenderDesc::default() };
    let picture = |desc: RenderDesc| -> Result<_> {
        let workers = Some(workers.clone());
        let start = Instant::now();
        let mut render = Render::new(&scene, RenderSettings { desc, workers, ..RenderSettings::default() })?;
        render.run(&mut |_| ControlFlow::Continue(()))?;
        Ok((render.image(), start.elapsed().as_secs_f64()))
    };
    let (reference, seconds) = picture(RenderDesc { samples: 8192, seed: 99, ..base.clone() })?;
    println!(
        "reference: 8192 samples, {seconds:.0} s\n\n| method | seconds | relMSE | one view x relMSE |\n|---|---|---|---|"
    );
    let tell = |name: String, desc: RenderDesc| -> Result<f64> {
        let (image, seconds) = picture(desc)?;
        let error = output::compare(&image, &reference)?.rel_mse;
        println!("| {name} | {seconds:.2} | {error:.2e} | {:.2e} |", seconds * error);
        Ok(seconds)
    };
    for samples in [16, 64, 256] {
        tell(format!("path, {samples} samples"), RenderDesc { samples, ..base.clone() })?;
    }
    for (size, error) in [(50.0, 5.0), (15.0, 1.0), (6.0, 0.4)] {
        let with = |final_gather, samples| RenderDesc {
            samples,
            integrator: IntegratorDesc::Radiosity,
            radiosity: RadiosityDesc { element_size: Some(size), error, final_gather, ..RadiosityDesc::default() },
            ..base.clone()
        };
        let first = tell(format!("radiosity, elements of {size}, 16 samples"), with(false, 16))?;
        let solution = solve(&desc, &with(false, 16).radiosity)?.elapsed.as_secs_f64();
        let all = solution + f64::from(VIEWS) * (first - solution).max(0.0);
        println!("| the same, {VIEWS} views: {:.3} s each | {all:.2} | | |", all / f64::from(VIEWS));
        tell(format!("radiosity, elements of {size}, final gather, 64 samples"), with(true, 64))?;
    }
    Ok(())
}

fn main() -> Result<()> {
    let what = std::env::args().skip(1).find(|argument| !argument.starts_with('-'));
    if what.as_deref() != Some("pictures") {
        all_growth()?;
    }
    if what.as_deref() != Some("growth") {
        pictures()?;
    }
    Ok(())
}
