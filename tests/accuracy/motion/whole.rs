//! Whole scenes: a picture through an open shutter is the mean of pictures at its moments.

use etendue::desc::{SceneDesc, ShutterDesc};
use etendue::scene::{BuildOptions, Scene};
use serde_json::json;

use super::{INTEGRATORS, measure, scene, still};
use crate::common::scenes::{Job, render, render_scene};
use crate::record::{Case, Entry};

pub fn cases() -> Vec<Entry> {
    vec![
        Entry { id: "V11", title: "mean of stills", run: stills },
        Entry { id: "V12", title: "what does not move", run: resting },
    ]
}

/// A bit of everything in motion: the camera with a lens, a ball, a mirror that turns, a mesh, lamps of three kinds.
pub fn busy() -> SceneDesc {
    let camera = json!({"origin": [0, 1.2, 5], "lookAt": [0, 0.8, 0], "fieldOfView": 45, "lensRadius": 0.05,
        "shutter": {"open": 0.25, "close": 1, "curve": "trapezoid"},
        "motion": [{"time": 0}, {"time": 1, "translate": [0.3, 0.1, 0], "rotate": [0, 3, 0]}]});
    let lights = json!([
        {"type": "point", "origin": [0, 3, 2], "color": [8, 8, 8],
            "motion": [{"time": 0, "translate": [-1, 0, 0]}, {"time": 1, "translate": [1, 0, 0]}]},
        {"type": "environment", "color": [0.2, 0.2, 0.2]},
    ]);
    scene(
        camera,
        lights,
        json!([
            {"geometry": "quad", "material": "grey", "vertex-1": [-6, 0, 6], "vertex-2": [6, 0, 6], "vertex-3": [6, 0, -6], "vertex-4": [-6, 0, -6]},
            {"geometry": "sphere", "material": "white", "origin": [0, 0.5, 0], "radius": 0.5,
                "motion": [{"time": 0, "translate": [-1.5, 0, 0]}, {"time": 0.5, "translate": [-1, 0.6, 0]}, {"time": 1, "translate": [-0.5, 0, 0]}]},
            {"geometry": "cylinder", "material": "grey", "base": [0, 0, -0.6], "axis": [0, 0, 1], "radius": 0.15, "height": 1.2,
                "motion": [{"time": 0, "translate": [1.2, 0.8, 0]}, {"time": 1, "translate": [1.2, 0.8, 0], "axis": [0, 1, 0], "angle": 120}]},
            {"geometry": "quad", "emission": [6, 6, 6], "vertex-1": [-0.3, 0, 0.1], "vertex-2": [0.3, 0, 0.1], "vertex-3": [0.3, 0.4, 0.1], "vertex-4": [-0.3, 0.4, 0.1],
                "motion": [{"time": 0, "translate": [0.1, 1.4, -0.5]}, {"time": 1, "translate": [0.5, 1.4, -0.5], "rotate": [0, 40, 0]}]},
            {"geometry": "sphere", "emission": [9, 9, 9], "origin": [0.5, 0.2, 1], "radius": 0.1,
                "motion": [{"time": 0}, {"time": 1, "translate": [0.5, 0, 0]}]},
        ]),
    )
}

fn stills(case: &mut Case) {
    let desc = busy();
    let count = case.count(64, 256) as u32;
    for (name, integrator) in INTEGRATORS {
        let samples = if case.is_full() { 4096 } else { 512 };
        let job = Job { resolution: [24, 16], samples, integrator, ..Job::default() };
        let blurred = measure(&desc, &job);
        // Moments in the middles of parts that are as likely.
        let [open, close] = desc.motion.shutter.interval();
        let (mut sum, mut squares) = (0.0, 0.0);
        for i in 0..count {
            let u = (f64::from(i) + 0.5) / f64::from(count);
            // Where the integral of the trapezoid has this share.
            let t = if u < 1.0 / 6.0 {
                (0.375 * u).sqrt()
            } else if u > 5.0 / 6.0 {
                1.0 - (0.375 * (1.0 - u)).sqrt()
            } else {
                0.125 + 0.75 * u
            };
            let job = Job { samples: samples / 16, seed: u64::from(i) + 7, ..job.clone() };
            let (mean, error) = measure(&still(&desc, open + t * (close - open)), &job);
            sum += mean;
            squares += error * error;
        }
        let mean = (sum / f64::from(count), squares.sqrt() / f64::from(count));
        let tolerance = if case.is_full() { 1e-3 } else { 5e-3 };
        case.equal_means(format!("mean of stills, {name}"), blurred, mean, tolerance);
    }
}

fn resting(case: &mut Case) {
    let job = Job { resolution: [24, 16], samples: 16, ..Job::default() };
    let bits = |desc: &SceneDesc| render(desc, &job).0.rgb.iter().map(|value| value.to_bits()).collect::<Vec<_>>();
    let differing = |a: &[u32], b: &[u32]| a.iter().zip(b).filter(|(a, b)| a != b).count() as u64;
    // A scene in which nothing moves has the same bits whatever the shutter does.
    let mut plain = still(&busy(), 0.5);
    plain.motion.camera = None;
    plain.motion.surfaces.clear();
    plain.motion.lights.clear();
    let before = bits(&plain);
    plain.set_shutter(ShutterDesc { open: -3.0, close: 7.0, curve: vec![0.0, 1.0] }).expect("a shutter");
    case.never("values that an open shutter changes", differing(&before, &bits(&plain)), before.len() as u64);
    // Keys that are all in the past are a scene at rest, with the elements where the last key has them.
    let past = still(&busy(), 1.0);
    let mut open = busy();
    open.set_shutter(ShutterDesc { open: 1.0, close: 2.0, curve: vec![] }).expect("a shutter");
    let built = Scene::build(&open, &BuildOptions::default()).expect("a scene of the test");
    case.holds("keys in the past: anything moves", "no", format!("{}", built.has_motion()), !built.has_motion());
    let (a, b) = (bits(&past), bits(&open));
    case.never("values that differ from the last moment", differing(&a, &b), a.len() as u64);
    // The same bits for any number of threads, and for a scene that was rebuilt from another moment.
    let moving = Scene::build(&busy(), &BuildOptions::default()).expect("a scene of the test");
    let image = |scene: &Scene| render_scene(scene, job.desc()).0.rgb.iter().map(|v| v.to_bits()).collect::<Vec<_>>();
    let first = image(&moving);
    let other = Scene::build(&past, &BuildOptions::default()).expect("a scene of the test");
    let again = other.rebuild(&busy(), &BuildOptions::default()).expect("a scene of the test");
    case.never("values that differ after a rebuild", differing(&first, &image(&again)), first.len() as u64);
}
