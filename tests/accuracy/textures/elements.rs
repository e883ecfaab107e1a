//! Radiosity of surfaces whose albedo a texture varies.

use etendue::desc::{BsdfDesc, IntegratorDesc, RadiosityDesc, RenderDesc, SceneDesc, TextureKey};
use etendue::math::DVec3;
use etendue::scene::{BuildOptions, Scene};
use etendue::spectrum::Rgb;
use etendue::texture::{ColorSpace, TextureFilter};

use super::scenes::{quad, vary};
use super::{described, image};
use crate::common::scenes::{Job, camera, mean_and_error, render_scene, scene};
use crate::lights::polygon_factor;
use crate::record::{Case, Entry, Within};

pub fn cases() -> Vec<Entry> {
    vec![Entry { id: "X17", title: "radiosity of textured surfaces", run: floor }]
}

/// The albedos of 4 x 4 squares, columns to the right and rows from the top.
fn albedo(x: u32, y: u32) -> f64 {
    if x >= 3 { 0.9 } else { 0.1 * f64::from((x + 2 * y) % 5) }
}

/// Reflected fraction of the ceiling: so little that what the floor receives of it does not count.
const CEILING: f64 = 1e-4;

/// Half the side of the lamp, and its radiance.
const LAMP: (f64, f64) = (0.3, 10.0);

/// A lamp in a ceiling, whose light reaches the ceiling from the floor alone, which a texture varies. The camera sees the part
/// [1.5, 2.5] x [-0.5, 0.5] of the ceiling.
fn room() -> SceneDesc {
    let floor = quad([[-1.0, 0.0, 1.0], [1.0, 0.0, 1.0], [1.0, 0.0, -1.0], [-1.0, 0.0, -1.0]]);
    let above = |y: f64, s: f64| quad([[-s, y, -s], [s, y, -s], [s, y, s], [-s, y, s]]);
    let lambert = |albedo: f64| BsdfDesc::Lambert { albedo: Rgb::splat(albedo as f32) };
    let angle = 2.0 * 0.5_f64.atan().to_degrees();
    let at = DVec3::new(2.0, 0.0, 0.0);
    let mut desc = scene(
        camera(at, at + DVec3::Y, angle),
        vec![
            (floor, lambert(1.0), None),
            (above(1.0, 3.0), lambert(CEILING), None),
            (above(1.0 - 1e-4, LAMP.0), BsdfDesc::Black, Some(Rgb::splat(LAMP.1 as f32))),
        ],
    );
    let texels = image(4, 4, 3, |x, y, _| albedo(x, y) as f32);
    vary(&mut desc, 0, TextureKey::Color, described("floor", &texels, ColorSpace::Linear, TextureFilter::Nearest, 1.0));
    desc
}

/// The mean radiance of the part of the ceiling that the camera sees.
fn exact() -> f64 {
    const N: u32 = 64;
    let s = LAMP.0;
    let lamp = [[-s, -s], [s, -s], [s, s], [-s, s]].map(|[x, z]| DVec3::new(x, 1.0, z));
    let place = |i: u32, n: u32| 2.0 * (f64::from(i) + 0.5) / f64::from(n) - 1.0;
    // Radiosities over pi times areas, by the rule of the middle.
    let floor: Vec<(DVec3, f64)> = (0..N * N)
        .map(|i| {
            let (column, row) = (i % N, i / N);
            let p = DVec3::new(place(column, N), 0.0, place(row, N));
            let received = std::f64::consts::PI * LAMP.1 * polygon_factor(p, DVec3::Y, &lamp);
            let share = albedo(column * 4 / N, row * 4 / N) * received / std::f64::consts::PI;
            (p, share * 4.0 / f64::from(N * N))
        })
        .collect();
    const M: u32 = 16;
    let sum: f64 = (0..M * M)
        .map(|i| {
            let p = DVec3::new(2.0 + 0.5 * place(i % M, M), 1.0, 0.5 * place(i / M, M));
            floor.iter().map(|(q, light)| light / p.distance_squared(*q).powi(2)).sum::<f64>()
        })
        .sum();
    CEILING / std::f64::consts::PI * sum / f64::from(M * M)
}

/// The ceiling by elements, seen directly and by a final gather, and by paths.
fn floor(case: &mut Case) {
    let built = Scene::build(&room(), &BuildOptions::default()).expect("a scene of the test");
    let exact = exact();
    let samples = case.count(256, 4096) as u32;
    let radiosity = |final_gather: bool, error: f64| RenderDesc {
        radiosity: RadiosityDesc { final_gather, error, ..RadiosityDesc::default() },
        ..Job { integrator: IntegratorDesc::Radiosity, samples, ..Job::default() }.desc()
    };
    for (name, settings, within) in [
        ("elements", radiosity(false, 0.02), 8e-3),
        ("elements, after a final gather", radiosity(true, 0.02), 8e-3),
        ("paths", Job { samples: 4 * samples, ..Job::default() }.desc(), 8e-3),
    ] {
        let (image, _) = render_scene(&built, settings);
        let (mean, error) = mean_and_error(&image);
        case.exact(name, mean, exact, Within::Relative(within + 3.0 * error / exact));
    }
}
