//! Radiosity of lamps whose radiance a texture varies.

use etendue::Alone;
use etendue::desc::{IntegratorDesc, RadiosityDesc, RadiositySolver, SceneDesc};
use etendue::integrator::radiosity::Radiosity;
use etendue::math::DVec3;
use etendue::scene::{BuildOptions, Scene};

use super::{balls, emission};
use crate::common::scenes::{Job, camera, render_scene};
use crate::record::{Case, Entry, Within};

pub fn cases() -> Vec<Entry> {
    vec![Entry { id: "X20", title: "radiosity of textured lamps", run: lamps }]
}

/// Irradiance in red at a point of the floor of the lamps' scenes, which is a quad over [-4, 4]^2 and their second surface.
fn floor_at(solution: &Radiosity, p: DVec3) -> f64 {
    let (right, back) = ((p.x + 4.0) / 8.0, (4.0 - p.z) / 8.0);
    let (half, weights) = if right >= back { (0, [right - back, back]) } else { (1, [right, back - right]) };
    let found = solution.irradiance_on(1, half, weights.map(|w| w as f32), p, true);
    f64::from(found.expect("the floor is diffuse").r())
}

/// What the elements of the first surface emit in red together, W.
fn emitted(solution: &Radiosity) -> f64 {
    let mesh = solution.mesh(Some(0), true);
    let of = |triangle: &[u32; 3]| {
        let [a, b, c] = triangle.map(|vertex| mesh.positions[vertex as usize]);
        let sum: f64 = triangle.iter().map(|vertex| f64::from(mesh.radiosity[*vertex as usize].r())).sum();
        0.5 * (b - a).cross(c - a).length() * sum / 3.0
    };
    mesh.triangles.iter().map(of).sum()
}

/// Elements of lamps emit the lamps' power and light the floor as the lamps do; what is seen of a lamp is its texture.
fn lamps(case: &mut Case) {
    let desc = RadiosityDesc { error: 0.1, element_size: Some(0.12), ..RadiosityDesc::default() };
    let points = [(0.7, -0.4), (-1.5, -1.2), (2.0, 1.0)].map(|(x, z)| DVec3::new(x, 0.0, z));
    type Lamp<'a> = (&'a str, SceneDesc, &'a dyn Fn(DVec3) -> f64, f64);
    let all: [Lamp<'_>; 2] = [
        ("a square", emission::lamp(None), &|p| emission::exact(p, DVec3::Y), 1e-4),
        // Inscribed triangles have a smaller area than the ball.
        ("a ball", balls::lamp(balls::Way::Own), &balls::Way::irradiance, 1e-2),
    ];
    for (name, scene, exact, within) in all {
        let built = Scene::build(&scene, &BuildOptions::default()).expect("a scene of the test");
        let power: f64 = built.emitters().emitters().iter().map(|emitter| emitter.power().x).sum();
        for solver in [RadiositySolver::Gather, RadiositySolver::Shoot] {
            // The way of a lamp's light to its elements is the same for both lamps.
            if solver == RadiositySolver::Shoot && name == "a ball" && !case.is_full() {
                continue;
            }
            let solution = Radiosity::solve(&built, &RadiosityDesc { solver, ..desc.clone() }, &mut Alone::default())
                .expect("a scene that radiosity takes");
            case.exact(format!("power of {name}, {solver:?}"), emitted(&solution), power, Within::Relative(within));
            for p in points {
                let what = format!("the floor at ({}, {}) below {name}, {solver:?}", p.x, p.z);
                case.exact(what, floor_at(&solution, p), exact(p), Within::Relative(1e-2));
            }
        }
    }
    // In a closed room all of it is absorbed.
    let built = Scene::build(&balls::room(0.5), &BuildOptions::default()).expect("a scene of the test");
    let solution = Radiosity::solve(&built, &RadiosityDesc::default(), &mut Alone::default());
    let summary = *solution.expect("a scene that radiosity takes").summary();
    let [emitted, absorbed] = [summary.emitted, summary.absorbed].map(|power| f64::from(power.r()));
    case.exact("absorbed in a room with a ball", absorbed, emitted, Within::Relative(1e-2));
    // From half way up, so that the lamp fills the picture; and from below the ball.
    let angle = 2.0 * 2.0_f64.atan().to_degrees();
    for (name, mut scene, eye, angle) in [
        ("a square", emission::lamp(None), DVec3::new(0.0, 0.5, 0.0), angle),
        ("a ball", balls::lamp(balls::Way::Own), DVec3::new(0.1, 0.3, 0.0), 30.0),
    ] {
        scene.set_camera(camera(eye, eye + DVec3::Y, angle)).expect("a camera of the test");
        let built = Scene::build(&scene, &BuildOptions::default()).expect("a scene of the test");
        let [path, radiosity] = [IntegratorDesc::Path, IntegratorDesc::Radiosity]
            .map(|integrator| render_scene(&built, Job { samples: 256, integrator, ..Job::default() }.desc()).0);
        let difference: f64 = path.rgb.iter().zip(&radiosity.rgb).map(|(a, b)| f64::from((a - b).abs())).sum();
        let sum: f64 = path.rgb.iter().map(|value| f64::from(*value)).sum();
        case.at_most(format!("what is seen of {name}: difference from paths, of the mean"), difference / sum, 1e-2);
    }
}
