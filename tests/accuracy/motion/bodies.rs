//! Bodies of all kinds that move: at each moment they are where the keys have them then.

use etendue::math::{DVec3, Ray};
use etendue::sampling::{Rng, warps};
use etendue::scene::{BuildOptions, Scene};
use serde_json::{Value, json};

use super::{scene, still, window};
use crate::record::{Case, Entry};

pub fn cases() -> Vec<Entry> {
    vec![
        Entry { id: "V5", title: "bodies at each moment", run: bodies },
        Entry { id: "V6", title: "normals of a mesh that deforms", run: normals },
        Entry { id: "V7", title: "lengths of what turns", run: lengths },
    ]
}

/// A ball of triangles around the origin, of radius 1.
fn ball(rings: u32, around: u32) -> (Vec<[f64; 3]>, Vec<[u32; 3]>) {
    let (mut positions, mut triangles) = (Vec::new(), Vec::new());
    for ring in 0..=rings {
        for i in 0..around {
            let theta = std::f64::consts::PI * f64::from(ring) / f64::from(rings);
            let phi = std::f64::consts::TAU * f64::from(i) / f64::from(around);
            positions.push([theta.sin() * phi.cos(), theta.cos(), theta.sin() * phi.sin()]);
            let [p, q] = [i, (i + 1) % around].map(|i| ring * around + i);
            if ring < rings {
                triangles.extend([[p, q, q + around], [p, q + around, p + around]]);
            }
        }
    }
    (positions, triangles)
}

fn built(surface: &Value) -> (Scene, etendue::desc::SceneDesc) {
    let camera = window(0.0, 0.0, 4.0, json!({"open": 2, "close": 4}));
    let desc = scene(camera, json!([]), json!([surface]));
    let scene = Scene::build(&desc, &BuildOptions::default()).expect("a scene of the test");
    assert!(scene.has_motion());
    (scene, desc)
}

fn bodies(case: &mut Case) {
    let moments = case.count(8, 40);
    let rays = case.count(2_000, 20_000);
    let straight = json!([{"time": 2, "translate": [-0.7, 0.1, 0]}, {"time": 4, "translate": [0.6, -0.3, 0.4], "scale": [1, 1, 1]}]);
    let turning = json!([{"time": 1, "translate": [-0.5, 0, 0], "axis": [1, 2, 0.5], "angle": -20},
        {"time": 3.1, "axis": [1, 2, 0.5], "angle": 70}, {"time": 5, "translate": [0.5, 0.2, 0], "axis": [1, 2, 0.5], "angle": 150}]);
    let growing = json!([{"time": 2, "scale": 0.8}, {"time": 4, "scale": 1.3, "translate": [0.2, 0, 0]}]);
    let sheared = json!([{"time": 2, "matrix": [1, 0.3, 0, 0,  0, 1, 0, 0,  0, 0, 1, 0,  0, 0, 0, 1]},
        {"time": 4, "matrix": [0.8, 0, 0, 0.2,  0.1, 1.1, 0, 0,  0, 0, 1, 0,  0, 0, 0, 1]}]);
    let (positions, triangles) = ball(12, 16);
    let (fine, many) = ball(70, 80);
    let kinds = [
        ("sphere", json!({"geometry": "sphere", "origin": [0.2, 0, 0], "radius": 0.9})),
        ("ellipsoid", json!({"geometry": "ellipsoid", "origin": [0, 0, 0], "radii": [0.9, 0.5, 0.3]})),
        (
            "cylinder",
            json!({"geometry": "cylinder", "base": [0, -0.8, 0], "axis": [0, 1, 0], "radius": 0.4, "height": 1.6}),
        ),
        ("disk", json!({"geometry": "disk", "origin": [0, 0, 0], "normal": [0.2, 0.1, 1], "radius": 0.9})),
        (
            "triangle",
            json!({"geometry": "triangle", "vertex-1": [-1, -0.8, 0.2], "vertex-2": [1, -0.6, 0], "vertex-3": [0, 1, -0.1]}),
        ),
        ("mesh", json!({"geometry": "mesh", "shading": "smooth", "positions": positions, "triangles": triangles})),
        ("instance", json!({"geometry": "mesh", "shading": "smooth", "positions": fine, "triangles": many})),
    ];
    for (path, motion, off) in [
        ("straight", straight, 1e-6),
        ("turning", turning, 4e-3),
        ("growing", growing, 1e-6),
        ("sheared", sheared, 4e-3),
    ] {
        for (kind, surface) in &kinds {
            let mut surface = surface.clone();
            surface["material"] = json!("grey");
            surface["motion"] = motion.clone();
            let (scene, desc) = built(&surface);
            let mut rng = Rng::new(75, 0);
            let (mut differ, mut hits, mut tries, mut again, mut left) = (0, 0, 0, 0, 0);
            for moment in 0..moments {
                let time = (moment as f32 + rng.next_f32()) / moments as f32;
                let rest = still(&desc, 2.0 + 2.0 * f64::from(time));
                let rest = Scene::build(&rest, &BuildOptions::default()).expect("a scene of the test");
                for _ in 0..rays / moments {
                    tries += 1;
                    let towards = warps::uniform_sphere(rng.next_2d()).as_dvec3();
                    let aside = 1.2 * warps::uniform_sphere(rng.next_2d()).as_dvec3();
                    let origin = aside - 5.0 * towards;
                    let of = |scene: &Scene, time: f32| {
                        let ray = Ray::new(scene.to_scene(origin), towards.as_vec3a()).at_time(time);
                        let hit = scene.intersect(&ray)?;
                        let at = scene.interaction(&ray, &hit);
                        Some((at, f64::from(hit.t)))
                    };
                    let (moving, exact) = (of(&scene, time), of(&rest, 0.0));
                    let same = match (&moving, &exact) {
                        (None, None) => true,
                        (Some((a, t)), Some((b, exact))) => {
                            hits += 1;
                            // A ray that grazes meets another place for the same distance across it.
                            let cos = f64::from(b.ng.dot(towards.as_vec3a()).abs()).max(0.05);
                            (t - exact).abs() < (off + 2e-6) * 2.0 / cos
                                && a.ns.dot(b.ns) > 1.0 - (40.0 * off + 1e-4) as f32
                        }
                        _ => false,
                    };
                    differ += u64::from(!same);
                    if let Some((at, _)) = moving {
                        let n = if at.ng.dot(towards.as_vec3a()) < 0.0 { at.ng } else { -at.ng };
                        // Bodies are convex: from outside, a ray that leaves does not come back.
                        if n == at.ng {
                            left += 1;
                            let leaving = at.point.leave(n, n);
                            again += u64::from(scene.intersect(&leaving).is_some());
                        }
                    }
                }
            }
            assert!(hits > tries / 20, "{kind}, {path}: {hits} of {tries}");
            // Rays within the chords' error of an edge differ.
            case.rarely(
                format!("{kind}, {path}: elsewhere than at rest"),
                differ,
                tries,
                if off > 1e-5 { 2e-2 } else { 2e-3 },
            );
            case.never(format!("{kind}, {path}: met again by a ray that leaves"), again, left.max(1));
        }
    }
}

fn normals(case: &mut Case) {
    // A sheet that folds up around the x axis: smooth normals have to go along.
    let at = |degrees: f64| {
        let (sin, cos) = degrees.to_radians().sin_cos();
        json!([[-1, 0, 0], [1, 0, 0], [1, cos, sin], [-1, cos, sin]])
    };
    let steps: Vec<_> =
        (0..=8).map(|i| json!({"time": 2.0 + 0.25 * f64::from(i), "positions": at(10.0 * f64::from(i))})).collect();
    let with_normals: Vec<_> = (0..=8)
        .map(|i| {
            let (sin, cos) = (10.0 * f64::from(i)).to_radians().sin_cos();
            json!({"time": 2.0 + 0.25 * f64::from(i), "positions": at(10.0 * f64::from(i)), "normals": vec![[0.0, -sin, cos]; 4]})
        })
        .collect();
    for (what, steps) in [("made from the faces", steps), ("given at each step", with_normals)] {
        let surface = json!({"geometry": "mesh", "material": "grey", "shading": "smooth", "positions": at(0.0),
            "triangles": [[0, 1, 2], [0, 2, 3]], "steps": steps});
        let (scene, _) = built(&surface);
        let mut rng = Rng::new(76, 0);
        let (mut off, mut count) = (0.0_f64, 0);
        for _ in 0..case.count(2_000, 100_000) {
            let time = rng.next_f32();
            let [x, y] = rng.next_2d();
            let degrees = 80.0 * f64::from(time);
            let origin = DVec3::new(1.8 * f64::from(x) - 0.9, 0.1 * f64::from(y) + 0.02, 9.0);
            let ray = Ray::new(scene.to_scene(origin), DVec3::NEG_Z.as_vec3a()).at_time(time);
            let Some(hit) = scene.intersect(&ray) else { continue };
            let at = scene.interaction(&ray, &hit);
            let (sin, cos) = degrees.to_radians().sin_cos();
            off = off.max((at.ns.as_dvec3() - DVec3::new(0.0, -sin, cos)).length());
            count += 1;
        }
        assert!(count > 1000, "{count}");
        // Between two steps, ten degrees apart, the sheet turns unevenly by less than a thousandth.
        case.at_most(format!("normals {what}: off by"), off, 1e-3);
    }
}

fn lengths(case: &mut Case) {
    let arm = json!({"geometry": "quad", "material": "grey", "vertex-1": [0, -0.02, 0], "vertex-2": [1, -0.02, 0],
        "vertex-3": [1, 0.02, 0], "vertex-4": [0, 0.02, 0],
        "motion": [{"time": 2, "quaternion": [0, 0, 0, 1]}, {"time": 4, "rotate": [0, 0, 170]}]});
    let (scene, _) = built(&arm);
    let tries = case.count(5_000, 200_000);
    let mut rng = Rng::new(77, 0);
    let (mut missed, mut met) = (0, 0);
    for _ in 0..tries {
        let time = rng.next_f32();
        let angle = (170.0 * f64::from(time)).to_radians();
        let at = |r: f64| {
            let origin = DVec3::new(r * angle.cos(), r * angle.sin(), 5.0);
            let ray = Ray::new(scene.to_scene(origin), DVec3::NEG_Z.as_vec3a()).at_time(time);
            scene.intersect(&ray).is_some()
        };
        // Chords are off by a thousandth of the size.
        missed += u64::from(!at(0.9985));
        met += u64::from(at(1.0001));
    }
    case.never("inside of the tip of an arm missed", missed, tries);
    case.never("beyond the tip of an arm met", met, tries);
}
