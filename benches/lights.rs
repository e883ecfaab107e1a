//! How the time to a certain error grows with the number of lights.
//!
//! A hall with pillars and a wall across it, in which the same power comes from one light, ten, a hundred, and so on: spheres
//! and triangles at random places, their areas together the same, their powers over nearly two decades. Some
//! are behind the wall or a pillar. Path tracing it, for each number of lights: relMSE against a long
//! render (its own noise taken off), the processor's seconds (less disturbed by other programs than a clock), their product,
//! and the exponent with which that grows. That is of pixels that see nothing but walls and pillars: how many samples of a
//! pixel meet a lamp of a hundredth of its size has nothing to do with how lights are chosen. The whole picture's relMSE
//! stands beside it.
//!
//! `cargo bench --bench lights [-- REFERENCE-SAMPLES]`

use std::ops::ControlFlow;

use etendue::desc::{
    BsdfDesc, CameraDesc, FilmDesc, FovAxis, MaterialDesc, RenderDesc, SceneDesc, ShapeDesc, SurfaceDesc,
};
use etendue::film::Image;
use etendue::math::{DAffine3, DVec3};
use etendue::output;
use etendue::render::{Render, RenderSettings};
use etendue::sampling::{Rng, warps};
use etendue::scene::{BuildOptions, Scene};
use etendue::spectrum::Rgb;
use rustix::time::{ClockId, clock_gettime};

const COUNTS: [u32; 5] = [1, 10, 100, 1000, 10_000];

/// Samples per pixel of a measured render, and how many renders with different seeds.
const SAMPLES: u32 = 16;
const RENDERS: u64 = 8;

const SIZE: DVec3 = DVec3::new(20.0, 6.0, 30.0);
const POWER: f64 = 900.0;
/// Squared length that one light would have.
const EXTENT2: f64 = 0.36;

/// Of the walls and of all that stands between them.
const ALBEDOS: [[f32; 3]; 2] = [[0.8, 0.8, 0.78], [0.62, 0.6, 0.58]];

fn add(desc: &mut SceneDesc, shape: ShapeDesc, material: usize, emission: Option<Rgb>) {
    desc.surfaces.push(SurfaceDesc {
        path: format!("surfaces[{}]", desc.surfaces.len()),
        name: String::new(),
        shape,
        local: DAffine3::IDENTITY,
        transform: DAffine3::IDENTITY,
        material: Some(material),
        emission,
        emits_both: false,
        web: None,
        spectrum: None,
        hidden: false,
    });
}

/// The six sides of a box, normals outwards.
fn add_box(desc: &mut SceneDesc, min: DVec3, max: DVec3, material: usize) {
    let corner = |i: usize| {
        let pick = |bit: usize, axis: usize| if i >> bit & 1 == 0 { min[axis] } else { max[axis] };
        DVec3::new(pick(0, 0), pick(1, 1), pick(2, 2))
    };
    for side in [[0, 4, 6, 2], [1, 3, 7, 5], [0, 1, 5, 4], [2, 6, 7, 3], [0, 2, 3, 1], [4, 5, 7, 6]] {
        add(desc, ShapeDesc::Quad(side.map(corner)), material, None);
    }
}

fn hall(lights: u32) -> SceneDesc {
    let (eye, look_at) = (DVec3::new(8.2, 2.6, 1.2), DVec3::new(10.6, 1.9, 14.0));
    let camera = CameraDesc::Perspective {
        eye,
        look_at,
        up: DVec3::Y,
        fov_deg: 62.0,
        fov_axis: FovAxis::Horizontal,
        film: FilmDesc::default(),
    };
    let mut desc = SceneDesc { camera, ..SceneDesc::default() };
    let [wall, stone] = ALBEDOS;
    for (name, albedo) in [("wall", wall), ("stone", stone), ("black", [0.0; 3])] {
        desc.materials.push(MaterialDesc {
            name: name.into(),
            path: format!("materials.{name}"),
            bsdf: BsdfDesc::Lambert { albedo: Rgb::from(albedo) },
            ..MaterialDesc::default()
        });
    }
    add_box(&mut desc, DVec3::ZERO, SIZE, 0);
    let mut boxes = vec![(DVec3::new(0.0, 0.0, 17.5), DVec3::new(8.0, 4.2, 18.0))];
    boxes.push((DVec3::new(12.0, 0.0, 17.5), DVec3::new(SIZE.x, 4.2, 18.0)));
    for row in 0..5 {
        for x in [5.0, 14.0] {
            let foot = DVec3::new(x, 0.0, 4.0 + 5.5 * f64::from(row));
            boxes.push((foot, foot + DVec3::new(1.0, SIZE.y, 1.0)));
        }
    }
    for &(min, max) in &boxes {
        add_box(&mut desc, min, max, 1);
    }
    let mut rng = Rng::new(1, 0);
    let extent = (EXTENT2 / f64::from(lights)).sqrt();
    let is_free =
        |p: DVec3| !boxes.iter().any(|&(min, max)| (min - extent).cmplt(p).all() && p.cmplt(max + extent).all());
    let powers: Vec<f64> = (0..lights).map(|_| 70_f64.powf(f64::from(rng.next_f32()))).collect();
    let total: f64 = powers.iter().sum();
    for (number, power) in (0_u32..).zip(powers) {
        let mut random = || f64::from(rng.next_f32());
        let middle = loop {
            let p = 0.7 + (SIZE - 1.4) * DVec3::new(random(), random(), random());
            if is_free(p) {
                break p;
            }
        };
        let power = POWER * power / total;
        // The power of an area is pi times that and its radiance.
        let (shape, area) = if number % 2 == 0 {
            let radius = 0.5 * extent;
            (ShapeDesc::Sphere { centre: middle, radius }, 4.0 * std::f64::consts::PI * radius * radius)
        } else {
            let axis = warps::uniform_sphere([rng.next_f32(), rng.next_f32()]).as_dvec3().normalize();
            let (a, b) = axis.any_orthonormal_pair();
            (ShapeDesc::Triangle([middle, middle + extent * a, middle + extent * b]), 0.5 * extent * extent)
        };
        let radiance = (power / (std::f64::consts::PI * area)) as f32;
        add(&mut desc, shape, 2, Some(Rgb::splat(radiance)));
    }
    desc
}

fn seconds() -> f64 {
    let time = clock_gettime(ClockId::ProcessCPUTime);
    time.tv_sec as f64 + 1e-9 * time.tv_nsec as f64
}

fn render(scene: &Scene, samples: u32, seed: u64) -> etendue::Result<Image> {
    let desc = RenderDesc { resolution: [64, 48], samples, seed, ..RenderDesc::default() };
    let mut render =
        Render::new(scene, RenderSettings { desc, threads: 2, auxiliary: true, ..RenderSettings::default() })?;
    render.run(&mut |_| ControlFlow::Continue(()))?;
    Ok(render.image())
}

/// relMSE of all pixels that see one material only, and no lamp, in either image.
fn rel_mse_of_surfaces(image: &Image, reference: &Image) -> f64 {
    let mean = reference.mean().iter().sum::<f64>() / 3.0;
    let albedo = |image: &Image, i: usize| image.layer("albedo").map_or(0.0, |layer| layer.data[i]);
    let is_surface = |i: usize| {
        ALBEDOS
            .iter()
            .any(|known| [image, reference].iter().all(|image| (albedo(image, 3 * i) - known[0]).abs() < 1e-5))
    };
    let (mut sum, mut count) = (0.0, 0.0);
    for i in (0..image.rgb.len() / 3).filter(|i| is_surface(*i)) {
        for c in 3 * i..3 * i + 3 {
            let (a, b) = (f64::from(image.rgb[c]), f64::from(reference.rgb[c]));
            sum += (a - b).powi(2) / (b * b + 0.01 * mean * mean);
            count += 1.0;
        }
    }
    sum / count
}

fn main() -> etendue::Result<()> {
    let reference_samples = std::env::args().filter_map(|argument| argument.parse().ok()).next().unwrap_or(2048);
    println!("| lights | build, s | relMSE with lamps | relMSE | s | relMSE × s |");
    println!("|---|---|---|---|---|---|");
    let mut points = Vec::new();
    for lights in COUNTS {
        let desc = hall(lights);
        let started = seconds();
        let scene = Scene::build(&desc, &BuildOptions::default())?;
        let build = seconds() - started;
        let reference = render(&scene, reference_samples, 1000)?;
        let started = seconds();
        let images = (1..=RENDERS).map(|seed| render(&scene, SAMPLES, seed)).collect::<etendue::Result<Vec<_>>>()?;
        let time = (seconds() - started) / RENDERS as f64;
        // The reference has noise as well: squared errors add up, and fall with the samples.
        let share = f64::from(reference_samples) / f64::from(reference_samples + SAMPLES) / RENDERS as f64;
        let (mut whole, mut error) = (0.0, 0.0);
        for image in &images {
            whole += share * output::compare(image, &reference)?.rel_mse;
            error += share * rel_mse_of_surfaces(image, &reference);
        }
        println!("| {lights} | {build:.4} | {whole:.3e} | {error:.3e} | {time:.3} | {:.3e} |", error * time);
        points.push((f64::from(lights).ln(), (error * time).ln()));
    }
    let mean = |of: fn(&(f64, f64)) -> f64| points.iter().map(of).sum::<f64>() / points.len() as f64;
    let (x, y) = (mean(|point| point.0), mean(|point| point.1));
    let covariance: f64 = points.iter().map(|point| (point.0 - x) * (point.1 - y)).sum();
    let variance: f64 = points.iter().map(|point| (point.0 - x).powi(2)).sum();
    println!("\nTime to equal error grows with the number of lights to the power of {:.3}", covariance / variance);
    Ok(())
}
