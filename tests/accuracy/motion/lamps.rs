//! Lamps that move: the light of a place is the mean over the moments of the lamp's.

use etendue::math::DVec3;
use serde_json::{Value, json};

use super::{INTEGRATORS, measure, scene};
use crate::common::scenes::Job;
use crate::lights::polygon_factor;
use crate::record::{Case, Entry};

pub fn cases() -> Vec<Entry> {
    vec![
        Entry { id: "V8", title: "lamps that move", run: lamps },
        Entry { id: "V9", title: "a spot light that turns", run: spot },
        Entry { id: "V10", title: "many lamps that move", run: many },
    ]
}

const ALBEDO: f64 = 0.5;
const HEIGHT: f64 = 2.0;
const HALF_WAY: f64 = 3.0;

/// A floor of albedo 1/2 of which the camera sees a tiny part around the origin, from the side, so that it is in no lamp's way.
fn floor(lights: Value, mut lamps: Vec<Value>, shutter: Value) -> etendue::desc::SceneDesc {
    lamps.push(json!({"geometry": "quad", "material": "grey",
        "vertex-1": [-0.1, 0, 0.1], "vertex-2": [0.1, 0, 0.1], "vertex-3": [0.1, 0, -0.1], "vertex-4": [-0.1, 0, -0.1]}));
    let camera =
        json!({"origin": [0, 0.2, 1], "lookAt": [0, 0, 0], "up": [0, 1, 0], "fieldOfView": 0.05, "shutter": shutter});
    scene(camera, lights, lamps.into())
}

fn shutter() -> Value {
    json!({"open": 0, "close": 1})
}

fn there_and_on() -> Value {
    json!([{"time": 0, "translate": [-HALF_WAY, 0, 0]}, {"time": 1, "translate": [HALF_WAY, 0, 0]}])
}

/// The mean over [0, 1] by Simpson's rule.
fn mean_over(of: impl Fn(f64) -> f64) -> f64 {
    const STEPS: u32 = 4096;
    let weight = |i: u32| if i == 0 || i == STEPS { 1.0 } else { 2.0 + 2.0 * f64::from(i % 2) };
    (0..=STEPS).map(|i| weight(i) * of(f64::from(i) / f64::from(STEPS))).sum::<f64>() / (3.0 * f64::from(STEPS))
}

fn lamps(case: &mut Case) {
    let samples = case.count(256, 4096) as u32;
    let tolerance = if case.is_full() { 1e-3 } else { 5e-3 };
    // The mean of h / (h^2 + x^2)^(3/2) over the way.
    let mean_of_way = 1.0 / (HEIGHT * HEIGHT.hypot(HALF_WAY));
    let point = json!([{"type": "point", "origin": [0, HEIGHT, 0], "color": [3, 3, 3], "motion": there_and_on()}]);
    let point = floor(point, vec![], shutter());
    let point_exact = ALBEDO / std::f64::consts::PI * 3.0 * mean_of_way;
    // A ball above the horizon lights as a point of intensity pi r^2 L does.
    let radius = 0.25;
    let ball = json!({"geometry": "sphere", "origin": [0, HEIGHT, 0], "radius": radius, "emission": [5, 5, 5], "motion": there_and_on()});
    let ball = floor(json!([]), vec![ball], shutter());
    let ball_exact = ALBEDO * 5.0 * radius * radius * mean_of_way;
    // A square that shines down and turns on its way.
    let corner = |x: f64, z: f64| [x, HEIGHT, z];
    let square = [corner(-0.5, -0.5), corner(0.5, -0.5), corner(0.5, 0.5), corner(-0.5, 0.5)];
    let turn = json!([{"time": 0, "translate": [-1, 0, 0]}, {"time": 1, "translate": [1, 0, 0], "rotate": [0, 0, 30]}]);
    let exact = ALBEDO
        * 4.0
        * mean_over(|t| {
            let (sin, cos) = (30.0 * t).to_radians().sin_cos();
            let moved = square.map(|[x, y, z]| DVec3::new(x * cos - y * sin + 2.0 * t - 1.0, x * sin + y * cos, z));
            polygon_factor(DVec3::ZERO, DVec3::Y, &moved)
        });
    let [a, b, c, d] = square;
    let quad = json!({"geometry": "quad", "emission": [4, 4, 4], "motion": turn, "vertex-1": a, "vertex-2": b, "vertex-3": c, "vertex-4": d});
    let mesh = json!({"geometry": "mesh", "emission": [4, 4, 4], "motion": turn, "positions": square, "triangles": [[0, 1, 2], [0, 2, 3]]});
    let (quad, mesh) = (floor(json!([]), vec![quad], shutter()), floor(json!([]), vec![mesh], shutter()));
    // A square that grows by its vertices.
    let grown = |half: f64| [corner(-half, -half), corner(half, -half), corner(half, half), corner(-half, half)];
    let steps = json!([{"time": 0, "positions": grown(0.2)}, {"time": 1, "positions": grown(1.2)}]);
    let growing = json!({"geometry": "mesh", "emission": [4, 4, 4], "positions": square, "triangles": [[0, 1, 2], [0, 2, 3]], "steps": steps});
    let growing = floor(json!([]), vec![growing], shutter());
    let growing_exact =
        ALBEDO * 4.0 * mean_over(|t| polygon_factor(DVec3::ZERO, DVec3::Y, &grown(0.2 + t).map(DVec3::from_array)));
    for (what, desc, exact, bias) in [
        ("point", point, point_exact, 0.0),
        ("ball", ball, ball_exact, 0.0),
        // Chords of a turn are off by a thousandth of the size, which is less of its light.
        ("quad that turns", quad, exact, 3e-4),
        ("mesh that turns", mesh, exact, 3e-4),
        ("mesh that deforms", growing, growing_exact, 0.0),
    ] {
        for (name, integrator) in INTEGRATORS {
            let job = Job { resolution: [8, 8], samples, integrator, ..Job::default() };
            let what = format!("{what}, {name}");
            // The part of the floor that is seen is 0.001 wide.
            case.biased_mean(what, measure(&desc, &job), exact, (bias + 1e-5, tolerance));
        }
    }
}

fn spot(case: &mut Case) {
    let samples = case.count(1024, 8192) as u32;
    // A cone from above that swings past the floor.
    let swing = json!([{"time": 0, "rotate": [0, 0, -60]}, {"time": 1, "rotate": [0, 0, 60]}]);
    let light = json!([{"type": "spot", "origin": [0, 0, 0], "direction": [0, -1, 0], "color": [3, 3, 3], "outerConeAngle": 40,
        "innerConeAngle": 10, "motion": swing}]);
    let mut desc = floor(light, vec![], shutter());
    // The turn is about the light itself: the floor is moved below it instead.
    for surface in &mut desc.surfaces {
        surface.transform = etendue::math::DAffine3::from_translation(DVec3::NEG_Y * HEIGHT);
    }
    desc.camera = desc.camera.moved(&etendue::math::DAffine3::from_translation(DVec3::NEG_Y * HEIGHT));
    let [outer, inner] = [40.0_f64, 10.0].map(|degrees| degrees.to_radians().cos());
    let factor = |t: f64| {
        let cos = (120.0 * t - 60.0).to_radians().cos();
        ((cos - outer) / (inner - outer)).clamp(0.0, 1.0).powi(2)
    };
    let exact = ALBEDO / std::f64::consts::PI * 3.0 / (HEIGHT * HEIGHT) * mean_over(factor);
    for (name, integrator) in INTEGRATORS {
        let job = Job { resolution: [8, 8], samples, integrator, ..Job::default() };
        let tolerance = if case.is_full() { 2e-3 } else { 8e-3 };
        case.mean(name, measure(&desc, &job), exact, tolerance);
    }
}

fn many(case: &mut Case) {
    // More lamps than are chosen by power alone, of which some move and one rests.
    let radius = 0.2;
    let mut lamps = Vec::new();
    let mut exact = 0.0;
    for i in 0..7 {
        let (z, height) = (0.5 * f64::from(i) - 1.5, HEIGHT + 0.2 * f64::from(i));
        let away = height.hypot(z);
        let light = 2.0 + f64::from(i);
        let mut lamp = json!({"geometry": "sphere", "origin": [0, height, z], "radius": radius, "emission": [light, light, light]});
        // The mean of h / (away^2 + x^2)^(3/2) over the way.
        let mean = if i == 3 {
            height / away.powi(3)
        } else {
            lamp["motion"] = there_and_on();
            height / (away * away * away.hypot(HALF_WAY))
        };
        exact += ALBEDO * light * radius * radius * mean;
        lamps.push(lamp);
    }
    // All move in planes of their own, so that none is in the way of another's light.
    for lamp in &mut lamps {
        let z = lamp["origin"][2].as_f64().expect("a number");
        lamp["origin"][2] = json!(z);
    }
    let desc = floor(json!([]), lamps, shutter());
    let samples = case.count(1024, 8192) as u32;
    for (name, integrator) in INTEGRATORS {
        let job = Job { resolution: [8, 8], samples, integrator, ..Job::default() };
        let tolerance = if case.is_full() { 2e-3 } else { 8e-3 };
        case.biased_mean(name, measure(&desc, &job), exact, (1e-5, tolerance));
    }
}
