//! Edges that pass the camera: the light behind them is seen for as long as they are elsewhere.

use etendue::desc::{KeyPlace, MotionDesc, MotionKey};
use etendue::math::{DQuat, DVec3};
use serde_json::{Value, json};

use super::{INTEGRATORS, layers, measure, moved, scene, window};
use crate::common::scenes::Job;
use crate::record::{Case, Entry};

pub fn cases() -> Vec<Entry> {
    vec![
        Entry { id: "V1", title: "an edge that moves", run: edge },
        Entry { id: "V2", title: "a shutter that opens slowly", run: curve },
        Entry { id: "V3", title: "a bar that turns", run: bar },
        Entry { id: "V4", title: "layers of what moves", run: auxiliary },
    ]
}

const SKY: f64 = 2.0;

fn sky() -> Value {
    json!([{"type": "environment", "color": [SKY, SKY, SKY]}])
}

/// From x = -1 at the time 3 to x = 1 at the time 5.
fn passing() -> Value {
    json!([{"time": 3, "translate": [-1, 0, 0]}, {"time": 5, "translate": [1, 0, 0]}])
}

/// A sheet that covers everything left of x = 0, as a quad or as a mesh of this many strips.
fn sheet(strips: u32, motion: &Value) -> Value {
    if strips == 0 {
        return json!({"geometry": "quad", "material": "black", "motion": motion,
            "vertex-1": [-40, -20, 0], "vertex-2": [0, -20, 0], "vertex-3": [0, 20, 0], "vertex-4": [-40, 20, 0]});
    }
    let (mut positions, mut triangles) = (Vec::new(), Vec::new());
    for i in 0..=strips {
        let y = 40.0 * f64::from(i) / f64::from(strips) - 20.0;
        positions.extend([[-40.0, y, 0.0], [0.0, y, 0.0]]);
        if i > 0 {
            let p = 2 * i - 2;
            triangles.extend([[p, p + 1, p + 3], [p, p + 3, p + 2]]);
        }
    }
    json!({"geometry": "mesh", "material": "black", "motion": motion, "positions": positions, "triangles": triangles})
}

fn edge(case: &mut Case) {
    let samples = case.count(256, 4096) as u32;
    let tolerance = if case.is_full() { 4e-3 } else { 2e-2 };
    let still = json!([{"time": 0}]);
    for (what, surface, camera_motion) in [
        ("a quad", sheet(0, &passing()), still.clone()),
        // Few triangles are copied, many are an instance.
        ("a mesh", sheet(4, &passing()), still.clone()),
        ("an instance", sheet(9000, &passing()), still.clone()),
        // A camera that goes the other way sees the same.
        (
            "the camera",
            sheet(0, &still),
            json!([{"time": 3, "translate": [1, 0, 0]}, {"time": 5, "translate": [-1, 0, 0]}]),
        ),
    ] {
        for x in [-0.9, -0.3, 0.2, 0.7] {
            for (name, integrator) in INTEGRATORS {
                if name != "path" && (what != "a mesh" || x != 0.2) {
                    continue;
                }
                let mut camera = window(x, 0.0, 1e-3, json!({"open": 3, "close": 5}));
                camera["motion"] = camera_motion.clone();
                let desc = scene(camera, sky(), json!([surface]));
                let job = Job { resolution: [8, 8], samples, integrator, ..Job::default() };
                // The sky is seen until the edge comes, for the share (x + 1) / 2 of the time.
                let exact = SKY * (x + 1.0) / 2.0;
                case.mean(format!("{what} at {x}, {name}"), measure(&desc, &job), exact, tolerance);
            }
        }
    }
    // Three keys: to the middle in a tenth of the time, and on in the rest.
    let uneven = json!([{"time": 3, "translate": [-1, 0, 0]}, {"time": 3.2, "translate": [0, 0, 0]}, {"time": 5, "translate": [1, 0, 0]}]);
    for (x, open) in [(-0.5, 0.05), (0.5, 0.1 + 0.9 * 0.5)] {
        let desc = scene(window(x, 0.0, 1e-3, json!({"open": 3, "close": 5})), sky(), json!([sheet(0, &uneven)]));
        let job = Job { resolution: [8, 8], samples, ..Job::default() };
        case.mean(format!("uneven keys at {x}"), measure(&desc, &job), SKY * open, 2.0 * tolerance);
    }
    // Keys outside of the interval count as much as those within: half of the way.
    let desc = scene(window(-0.25, 0.0, 1e-3, json!({"open": 3, "close": 4})), sky(), json!([sheet(0, &passing())]));
    let job = Job { resolution: [8, 8], samples, ..Job::default() };
    case.mean("half of the interval", measure(&desc, &job), SKY * 0.75, tolerance);
    // A mesh that deforms: the corners of the edge move by themselves.
    let corners = |x: f64| json!([[-40, -20, 0], [x, -20, 0], [x, 20, 0], [-40, 20, 0]]);
    let mesh = json!({"geometry": "mesh", "material": "black", "positions": corners(0.0), "triangles": [[0, 1, 2], [0, 2, 3]],
        "steps": [{"time": 3, "positions": corners(-1.0)}, {"time": 4.5, "positions": corners(0.5)}, {"time": 5, "positions": corners(1.0)}]});
    for x in [-0.6, 0.75] {
        let desc = scene(window(x, 0.0, 1e-3, json!({"open": 3, "close": 5})), sky(), json!([mesh]));
        let exact = SKY * (x + 1.0) / 2.0;
        case.mean(format!("a mesh that deforms at {x}"), measure(&desc, &job), exact, 1.5 * tolerance);
    }
}

/// A name, the curve of a shutter, and the share of the light that has come in up to a share of the time.
type Curve<'a> = (&'a str, Value, &'a dyn Fn(f64) -> f64);

fn curve(case: &mut Case) {
    let samples = case.count(256, 4096) as u32;
    let tolerance = if case.is_full() { 4e-3 } else { 2e-2 };
    // The share of the time up to t in [0, 1], by integrals of the curves.
    let trapezoid = |t: f64| {
        let opening = |t: f64| 2.0 * t * t;
        let area = if t < 0.25 { opening(t) } else { 0.125 + (t - 0.25) };
        if t > 0.75 { 1.0 - opening(1.0 - t) / 0.75 } else { area / 0.75 }
    };
    let triangle = |t: f64| if t < 0.5 { 2.0 * t * t } else { 1.0 - 2.0 * (1.0 - t) * (1.0 - t) };
    let closing = |t: f64| 1.0 - (1.0 - t) * (1.0 - t);
    let curves: [Curve; 4] = [
        ("box", json!("box"), &|t| t),
        ("trapezoid", json!("trapezoid"), &trapezoid),
        ("triangle", json!([0, 5, 0]), &triangle),
        ("closing", json!([3, 2, 1, 0]), &closing),
    ];
    for (name, curve, share) in curves {
        for x in [-0.7, -0.1, 0.4, 0.8] {
            let shutter = json!({"open": 3, "close": 5, "curve": curve});
            let desc = scene(window(x, 0.0, 1e-3, shutter), sky(), json!([sheet(0, &passing())]));
            let job = Job { resolution: [8, 8], samples, ..Job::default() };
            let exact = SKY * share((x + 1.0) / 2.0);
            case.mean(format!("{name} at {x}"), measure(&desc, &job), exact, 2.0 * tolerance);
        }
    }
}

fn bar(case: &mut Case) {
    const HALF_WIDTH: f64 = 0.1;
    let samples = case.count(512, 4096) as u32;
    for (what, degrees) in [("a third of a circle", 120.0_f64), ("nearly a half", 170.0)] {
        let turn = |time: f64, degrees: f64| MotionKey {
            time,
            place: KeyPlace::Parts {
                translation: DVec3::ZERO,
                rotation: DQuat::from_rotation_z(degrees.to_radians()),
                scale: DVec3::ONE,
            },
        };
        let motion = MotionDesc { keys: vec![turn(0.0, -0.5 * degrees), turn(1.0, 0.5 * degrees)] };
        for r in [0.5, 0.9] {
            let arm = json!({"geometry": "quad", "material": "black",
                "vertex-1": [0, -HALF_WIDTH, 0], "vertex-2": [1, -HALF_WIDTH, 0], "vertex-3": [1, HALF_WIDTH, 0], "vertex-4": [0, HALF_WIDTH, 0]});
            let desc = scene(window(r, 0.0, 1e-4, json!({"open": 0, "close": 1})), sky(), json!([arm]));
            let job = Job { resolution: [8, 8], samples, ..Job::default() };
            // The arm covers the point while its angle is within asin(half width / r) on either side.
            let covered = 2.0 * (HALF_WIDTH / r).asin() / degrees.to_radians();
            let exact = SKY * (1.0 - covered);
            // Chords that are off by a thousandth of the size bend the even turn by as much.
            let bounds = (1e-3, if case.is_full() { 1e-3 } else { 4e-3 });
            case.biased_mean(format!("{what} at {r}"), measure(&moved(desc, motion.clone()), &job), exact, bounds);
        }
    }
}

fn auxiliary(case: &mut Case) {
    let samples = case.count(256, 4096) as u32;
    let job = Job { resolution: [8, 8], samples, ..Job::default() };
    let wall = |motion: Value| {
        json!({"geometry": "quad", "material": "grey", "motion": motion,
            "vertex-1": [-9, -9, 0], "vertex-2": [9, -9, 0], "vertex-3": [9, 9, 0], "vertex-4": [-9, 9, 0]})
    };
    let mean_of = |desc: &_, layer: &str| {
        let image = layers(desc, &job);
        let data = &image.layer(layer).expect("an auxiliary layer").data;
        data.iter().map(|value| f64::from(*value)).sum::<f64>() / data.len() as f64
    };
    let to = |z: f64| json!([{"time": 0, "translate": [0, 0, 0]}, {"time": 1, "translate": [0, 0, z]}]);
    // Stratified times leave less than a sample's share of the way.
    let within = crate::record::Within::Relative(2e-3);
    let camera = || window(0.0, 0.0, 0.1, json!({"open": 0, "close": 1}));
    let desc = scene(camera(), sky(), json!([wall(to(8.0))]));
    case.exact("mean depth of a wall that comes nearer", mean_of(&desc, "depth"), 46.0, within);
    let mut moving = camera();
    moving["motion"] = to(-8.0);
    let desc = scene(moving, sky(), json!([wall(json!([{"time": 0}]))]));
    case.exact("mean depth for a camera that comes nearer", mean_of(&desc, "depth"), 46.0, within);
    // A white sheet before a grey wall, over half of the time.
    let white = json!({"geometry": "quad", "material": "white", "motion": [{"time": 0, "translate": [-1, 0, 1]}, {"time": 1, "translate": [1, 0, 1]}],
        "vertex-1": [-9, -9, 0], "vertex-2": [0, -9, 0], "vertex-3": [0, 9, 0], "vertex-4": [-9, 9, 0]});
    let desc = scene(
        window(0.5, 0.0, 1e-3, json!({"open": 0, "close": 1})),
        sky(),
        json!([wall(json!([{"time": 0}])), white]),
    );
    let within = crate::record::Within::Absolute(if case.is_full() { 2e-3 } else { 1e-2 });
    case.exact("mean albedo behind a sheet", mean_of(&desc, "albedo"), 0.25 + 0.75 * 0.5, within);
}
