//! Convergence of the progressive methods over their passes, towards the path tracer's image.
//!
//! With a radius r_i that shrinks by (i + alpha) / (i + 1) in square, the variance of the mean over N passes falls as N^-alpha and
//! its bias as N^(alpha - 1) (Knaus and Zwicker 2011): for alpha 2/3 the mean squared error falls between N^-1, where noise of the
//! pixels rules, and N^-(2/3), where that of the maps or their bias does. It must never level out.

use super::{build, load, method};
use crate::common::scenes::{camera, render_scene, scene};
use crate::record::{Case, Entry};
use crate::stats;
use crate::transport::{ball, glass, grey, mirror, parallelogram, pick, plane};
use etendue::desc::{BsdfDesc, IntegratorDesc, RenderDesc, SceneDesc};
use etendue::film::Image;
use etendue::math::DVec3;
use etendue::scene::Scene;

pub fn cases() -> Vec<Entry> {
    vec![Entry { id: "M70", title: "error over passes", run: over_passes }]
}

/// Progressive methods.
const PROGRESSIVE: [IntegratorDesc; 3] = [IntegratorDesc::Caustic, IntegratorDesc::Ppm, IntegratorDesc::Sppm];

/// A glass ball and a mirror over a floor, a lamp of this size, and a looking glass in which the caustic is seen.
fn caustics(lamp: f64, seen_in_mirror: bool) -> SceneDesc {
    let shape = parallelogram(DVec3::new(-0.5 * lamp - 0.8, 2.5, -0.5 * lamp), DVec3::X * lamp, DVec3::Z * lamp);
    let light = etendue::spectrum::Rgb::splat((4.0 / (lamp * lamp)) as f32);
    let mut surfaces = vec![
        (plane(DVec3::ZERO, DVec3::Y, 3.0), grey(0.6), None),
        (ball(DVec3::new(0.0, 0.7, 0.0), 0.5), glass(1.5, 1.0), None),
        (shape, BsdfDesc::Black, Some(light)),
    ];
    let (mut eye, mut target) = (DVec3::new(0.6, 2.0, 2.2), DVec3::new(0.2, 0.0, 0.0));
    if seen_in_mirror {
        // Straight ahead is the looking glass, the caustic in it.
        surfaces.push((plane(DVec3::new(0.0, 1.0, -2.0), DVec3::Z, 1.5), mirror(0.9), None));
        (eye, target) = (DVec3::new(0.4, 1.4, 0.9), DVec3::new(0.3, 0.9, -2.0));
    }
    scene(camera(eye, target, 40.0), surfaces)
}

/// Mean squared error, each value relative to the exact one and a third of its mean (in a shadow, chance finds light too rarely for a
/// reference), which two independent references give
/// without adding an error of their own: E (x - a)(x - b) is that of x.
fn relative_mse(image: &Image, [a, b]: [&Image; 2]) -> f64 {
    let values = |image: &Image| image.rgb.iter().map(|value| f64::from(*value)).collect::<Vec<_>>();
    let (x, a, b) = (values(image), values(a), values(b));
    let n = x.len() as f64;
    let floor = a.iter().sum::<f64>() / (3.0 * n);
    let one = |i: usize| {
        let exact = 0.5 * (a[i] + b[i]);
        (x[i] - a[i]) * (x[i] - b[i]) / (exact * exact + floor * floor)
    };
    (0..x.len()).map(one).sum::<f64>() / n
}

fn render(scene: &Scene, desc: RenderDesc, seed: u64) -> Image {
    render_scene(scene, RenderDesc { seed, ..desc }).0
}

fn over_passes(case: &mut Case) {
    let side = pick(case, 16, 24);
    // With the first radii of both maps.
    let scenes = vec![
        ("room.json", load("room.json"), [0.1, 0.3]),
        ("cornell.json", load("cornell.json"), [10.0, 30.0]),
        ("glass ball under a small lamp", caustics(0.6, false), [0.04, 0.1]),
        ("its caustic in a mirror", caustics(0.6, true), [0.04, 0.1]),
    ];
    for (name, desc, radii) in scenes {
        // All diffuse, as most of the other room is.
        if name == "cornell.json" && !case.is_full() {
            continue;
        }
        let scene = build(&desc);
        let samples = case.count(1024, 4096) as u32;
        let references = [7, 8].map(|seed| render(&scene, method(IntegratorDesc::Path, side, samples, (1, 1.0)), seed));
        for integrator in PROGRESSIVE {
            let seeds = 2;
            let points: Vec<(f64, f64)> = [4_u32, 16, 64, 256][..pick(case, 3, 4)]
                .iter()
                .map(|&passes| {
                    let mut desc = RenderDesc {
                        resolution: [side, side],
                        // Four samples to a pass.
                        samples: 4 * passes,
                        integrator,
                        ..RenderDesc::default()
                    };
                    let paths = 1 << 12;
                    desc.photons.count = Some(paths);
                    desc.photons.caustic_count = Some(paths);
                    [desc.photons.caustic_radius, desc.photons.radius] = radii.map(Some);
                    let sum: f64 = (1..=seeds)
                        .map(|seed| relative_mse(&render(&scene, desc.clone(), seed), [&references[0], &references[1]]))
                        .sum();
                    (f64::from(passes), sum / seeds as f64)
                })
                .collect();
            // A single bright sample may lift one of those before; it is a fourth of itself in the next.
            let (last, before) = points.split_last().expect("some");
            let falls = before.iter().all(|(_, mse)| last.1 < *mse);
            let what = format!("{name}, {}", integrator.name());
            let list: Vec<String> = points.iter().map(|(_, mse)| crate::record::short(*mse)).collect();
            case.holds(format!("{what}: error over passes"), "least after the most", list.join(", "), falls);
            // Twice two thirds, in a quarter of the passes: -2/3, with room for noise.
            let slope = stats::log_log_slope(&points);
            case.at_most(
                format!("{what}: N^-(2/3) over slope of log error over log passes"),
                (2.0 / 3.0) / -slope,
                1.15,
            );
        }
    }
}
