//! Rooms with windows: portals change the noise of the light from outside, and nothing else.

use std::f64::consts::PI;
use std::path::Path;

use etendue::desc::{self, PortalDesc, RenderDesc, SceneDesc};
use etendue::integrator::photon::{MapKind, NARROW, PhotonJob, shoot};
use etendue::math::DVec3;
use etendue::scene::{BuildOptions, Scene};

use super::polygon_factor;
use super::sky::{METHODS, drawn};
use crate::common::scenes::mean_and_error;
use crate::record::{Case, Entry};

pub fn cases() -> Vec<Entry> {
    vec![
        Entry { id: "L90", title: "windows of a room, with and without portals", run: windows },
        Entry { id: "L91", title: "photons through a window", run: photons },
    ]
}

/// The window, in the wall z = 0 of a room of 4 x 3 x 3 whose other walls are black.
const WINDOW: [DVec3; 4] =
    [DVec3::new(-0.5, 1.0, 0.0), DVec3::new(0.5, 1.0, 0.0), DVec3::new(0.5, 2.0, 0.0), DVec3::new(-0.5, 2.0, 0.0)];

/// The room, of which the camera sees a small piece of the white floor, or all of it from above in a room without a floor.
fn room(light: &str) -> SceneDesc {
    let quad = |material: &str, corners: [[f64; 3]; 4]| {
        let [a, b, c, d] = corners.map(|corner| format!("{corner:?}"));
        format!(
            r#"{{"geometry": "quad", "material": "{material}", "vertex-1": {a}, "vertex-2": {b}, "vertex-3": {c}, "vertex-4": {d}}}"#
        )
    };
    let wall = |x: [f64; 2], y: [f64; 2]| {
        quad("black", [[x[0], y[0], 0.0], [x[1], y[0], 0.0], [x[1], y[1], 0.0], [x[0], y[1], 0.0]])
    };
    let surfaces = [
        quad("white", [[-2.0, 0.0, 0.0], [-2.0, 0.0, 3.0], [2.0, 0.0, 3.0], [2.0, 0.0, 0.0]]),
        quad("black", [[-2.0, 3.0, 0.0], [2.0, 3.0, 0.0], [2.0, 3.0, 3.0], [-2.0, 3.0, 3.0]]),
        quad("black", [[-2.0, 0.0, 3.0], [-2.0, 3.0, 3.0], [2.0, 3.0, 3.0], [2.0, 0.0, 3.0]]),
        quad("black", [[-2.0, 0.0, 0.0], [-2.0, 3.0, 0.0], [-2.0, 3.0, 3.0], [-2.0, 0.0, 3.0]]),
        quad("black", [[2.0, 0.0, 0.0], [2.0, 0.0, 3.0], [2.0, 3.0, 3.0], [2.0, 3.0, 0.0]]),
        wall([-2.0, 2.0], [0.0, 1.0]),
        wall([-2.0, 2.0], [2.0, 3.0]),
        wall([-2.0, -0.5], [1.0, 2.0]),
        wall([0.5, 2.0], [1.0, 2.0]),
    ]
    .join(",");
    let text = format!(
        r#"{{
            "etendue": 1,
            "camera": {{"origin": [0.3, 1, 2.9], "lookAt": [0.3, 0, 1.2], "fieldOfView": 0.05}},
            "materials": [{{"name": "white", "type": "diffuse", "color": [1, 1, 1]}}, {{"name": "black", "type": "black"}}],
            "lights": [{light}],
            "surfaces": [{surfaces}]
        }}"#
    );
    desc::parse(&text, Path::new("."), None).expect("a scene of the test")
}

const EVEN: &str = r#"{"type": "environment", "color": [1, 1, 1]}"#;
const OVERCAST: &str = r#"{"type": "sky", "cie": 1, "color": [1, 1, 1]}"#;

/// The irradiance at a point of the floor: that of the window under an even sky, and under the overcast one by midpoints.
fn irradiance(light: &str, p: DVec3, steps: u32) -> f64 {
    if light == EVEN {
        return PI * polygon_factor(p, DVec3::Y, &WINDOW);
    }
    let mut sum = 0.0;
    let area = 1.0 / f64::from(steps * steps);
    for k in 0..steps * steps {
        let [s, t] = [k % steps, k / steps].map(|i| (f64::from(i) + 0.5) / f64::from(steps));
        let way = WINDOW[0] + s * DVec3::X + t * DVec3::Y - p;
        let wi = way.normalize();
        // ISO 15469, type 1: gradation (4, -0.7), no indicatrix; all of the window is above the horizon.
        let gradation = |cosine: f64| 1.0 + 4.0 * (-0.7 / cosine).exp();
        let radiance = gradation(wi.y) / gradation(1.0);
        sum += radiance * wi.y * wi.z.abs() / way.length_squared() * area;
    }
    sum
}

fn portals(which: &str) -> Vec<PortalDesc> {
    let quad = |corners: [DVec3; 4]| PortalDesc { corners: corners.to_vec() };
    let part = |from: f64| PortalDesc { corners: [0, 1, 2].map(|i| WINDOW[i] + DVec3::X * from).to_vec() };
    match which {
        "no portal" => vec![],
        "the window" => vec![quad(WINDOW)],
        "a part of it, twice" => vec![part(0.0), part(0.1)],
        "a wall without a window" => vec![quad(WINDOW.map(|p| p + DVec3::Z * 3.0))],
        "far too large" => vec![quad(WINDOW.map(|p| (p - WINDOW[0]) * 7.0 - DVec3::new(4.0, 3.0, 0.1)))],
        _ => unreachable!("{which}"),
    }
}

fn windows(case: &mut Case) {
    let samples = case.count(256, 4096) as u32;
    for (what, light) in [("even sky", EVEN), ("overcast sky", OVERCAST)] {
        let exact = irradiance(light, DVec3::new(0.3, 0.0, 1.2), 512) / PI;
        let mut errors = Vec::new();
        for which in ["no portal", "the window", "a part of it, twice", "a wall without a window", "far too large"] {
            let mut desc = room(light);
            desc.set_portals(portals(which)).expect("portals of the test");
            let is_by_all = which == "the window" && (case.is_full() || light == EVEN);
            let methods = if is_by_all { &METHODS[..] } else { &METHODS[..1] };
            for &(integrator, bias) in methods {
                let found = mean_and_error(&drawn(case, &desc, integrator, samples));
                let tolerance = if case.is_full() { 3e-3 } else { 1e-2 };
                case.biased_mean(
                    format!("{what}, {which}, by {integrator:?}"),
                    found,
                    exact,
                    (bias.max(1e-4), tolerance),
                );
                if integrator == METHODS[0].0 {
                    errors.push(found.1);
                }
            }
        }
        case.at_most(format!("{what}: error with a portal over that without"), errors[1] / errors[0], 0.5);
    }
}

fn photons(case: &mut Case) {
    let paths = case.count(1 << 18, 1 << 22) as u32;
    for (what, light) in [("even sky", EVEN), ("overcast sky", OVERCAST)] {
        // All that reaches the floor, by midpoints.
        let (mut exact, steps) = (0.0, case.count(24, 64) as u32);
        for k in 0..steps * steps {
            let [s, t] = [k % steps, k / steps].map(|i| (f64::from(i) + 0.5) / f64::from(steps));
            exact += irradiance(light, DVec3::new(4.0 * s - 2.0, 0.0, 3.0 * t), 96) * 12.0 / f64::from(steps * steps);
        }
        let mut errors = Vec::new();
        for which in ["no portal", "the window", "a part of it, twice", "far too large"] {
            let mut desc = room(light);
            desc.set_portals(portals(which)).expect("portals of the test");
            let scene = Scene::build(&desc, &BuildOptions::default()).expect("a scene of the test");
            let settings = RenderDesc { max_depth: Some(1), ..RenderDesc::default() };
            let job =
                PhotonJob { kind: MapKind::Global, paths, pass: 0, most: usize::MAX, narrow_below: NARROW, time: 0.0 };
            let shot = shoot(&scene, &settings, job, &mut etendue::Alone::default()).expect("no limit");
            let (mut sum, mut squares) = (0.0, 0.0);
            for photon in &shot.photons {
                let power = f64::from(photon.power().g());
                // The underside of the floor is outside.
                if photon.normal.get().y > 0.0 {
                    sum += power;
                    squares += power * power;
                }
            }
            // The light paths are independent, and most bring nothing.
            let error = (squares - sum * sum / f64::from(paths)).max(0.0).sqrt();
            errors.push(error);
            let tolerance = if case.is_full() { 2e-2 } else { 8e-2 };
            case.biased_mean(format!("{what}, {which}"), (sum, error), exact, (1e-3, tolerance));
        }
        case.at_most(format!("{what}: error with a portal over that without"), errors[1] / errors[0], 0.5);
    }
}
