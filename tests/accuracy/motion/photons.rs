//! Photons in scenes that move: each pass sees one moment, and the mean over the passes is the picture.

use std::f64::consts::PI;

use etendue::desc::{IntegratorDesc, SceneDesc};
use etendue::film::Image;
use etendue::scene::{BuildOptions, Scene};
use serde_json::json;

use super::whole::busy;
use super::{measure, scene};
use crate::common::scenes::{Job, mean_and_error, render_scene};
use crate::record::{Case, Entry};

pub fn cases() -> Vec<Entry> {
    vec![
        Entry { id: "V13", title: "photons of a mirror that moves", run: mirror },
        Entry { id: "V14", title: "photons of all that moves", run: whole },
    ]
}

const METHODS: [(&str, IntegratorDesc); 3] =
    [("caustic", IntegratorDesc::Caustic), ("ppm", IntegratorDesc::Ppm), ("sppm", IntegratorDesc::Sppm)];

/// A picture by passes of `photons` light paths a map, with four samples a pass.
fn drawn(desc: &SceneDesc, job: &Job, photons: u32, caustic_radius: Option<f64>) -> Image {
    let scene = Scene::build(desc, &BuildOptions::default()).expect("a scene of the test");
    let mut settings = job.desc();
    settings.photons.count = Some(photons);
    settings.photons.caustic_count = Some(photons);
    settings.photons.caustic_radius = caustic_radius;
    render_scene(&scene, settings).0
}

/// A lamp under a mirror that rises: the mirror lights a floor as a lamp twice as far above it would.
fn mirror(case: &mut Case) {
    const LAMP: f64 = 0.6;
    const LOW: f64 = 1.5;
    const HIGH: f64 = 2.0;
    let camera = json!({"origin": [0, 0.2, 1], "lookAt": [0, 0, 0], "up": [0, 1, 0], "fieldOfView": 0.05,
        "shutter": {"open": 0, "close": 1}});
    let lights = json!([{"type": "point", "origin": [0, LAMP, 0], "color": [3, 3, 3]}]);
    let rise = json!([{"time": 0, "translate": [0, LOW, 0]}, {"time": 1, "translate": [0, HIGH, 0]}]);
    let square = |half: f64, up: f64| {
        [[-half, 0.0, -half * up], [half, 0.0, -half * up], [half, 0.0, half * up], [-half, 0.0, half * up]]
    };
    let [a, b, c, d] = square(0.5, -1.0);
    let floor =
        json!({"geometry": "quad", "material": "grey", "vertex-1": a, "vertex-2": b, "vertex-3": c, "vertex-4": d});
    let [a, b, c, d] = square(0.4, 1.0);
    let quad = json!({"geometry": "quad", "material": "mirror", "vertex-1": a, "vertex-2": b, "vertex-3": c, "vertex-4": d, "motion": rise});
    let disk = json!({"geometry": "disk", "material": "mirror", "origin": [0, 0, 0], "normal": [0, -1, 0], "radius": 0.4, "motion": rise});
    let steps = json!([{"time": 0, "positions": square(0.4, 1.0).map(|[x, _, z]| [x, LOW, z])},
        {"time": 1, "positions": square(0.4, 1.0).map(|[x, _, z]| [x, HIGH, z])}]);
    let mesh = json!({"geometry": "mesh", "material": "mirror", "positions": [a, b, c, d], "triangles": [[0, 1, 2], [0, 2, 3]], "steps": steps});
    // The mean of 1 / (2 h - LAMP)^2 over the heights h.
    let mean = (1.0 / (2.0 * LOW - LAMP) - 1.0 / (2.0 * HIGH - LAMP)) / (2.0 * (HIGH - LOW));
    let exact = 0.5 / PI * 3.0 * (1.0 / (LAMP * LAMP) + mean);
    for (what, mirror) in [("quad", quad), ("disk", disk), ("mesh that deforms", mesh)] {
        let desc = scene(camera.clone(), lights.clone(), json!([floor, mirror]));
        for (name, integrator) in METHODS {
            let samples = case.count(128, 4096) as u32;
            let job = Job { resolution: [4, 4], samples, integrator, max_depth: Some(2), ..Job::default() };
            // All pixels see the same photons, and a kernel of this radius blurs light that falls off.
            let found = mean_and_error(&drawn(&desc, &job, 1 << 15, Some(0.1)));
            let bias = if case.is_full() { 1.5e-3 } else { 4e-3 };
            case.biased_mean(format!("{what}, {name}"), found, exact, (bias, 5e-3));
        }
    }
}

/// A scene with a bit of everything in motion, against paths.
fn whole(case: &mut Case) {
    let desc = busy();
    let samples = case.count(1024, 8192) as u32;
    let job = Job { resolution: [24, 16], samples, ..Job::default() };
    let (exact, error) = measure(&desc, &job);
    for (name, integrator) in METHODS {
        let job = Job { integrator, ..job.clone() };
        let found = mean_and_error(&drawn(&desc, &job, 1 << 14, None));
        let bias = if case.is_full() { 2e-3 } else { 6e-3 };
        case.biased_mean(name, (found.0, found.1.hypot(error)), exact, (bias, 5e-3));
    }
}
