//! Caustics: how much light a glass ball gathers and where, and a floor under water from both ends.

use std::f64::consts::PI;

use super::{METHODS, RUNS, add_mesh, build, grey_mean, images, many_runs, method, over, seeded, shot, stored, unseen};
use crate::common::scenes::{box_inside, camera, point_light, scene};
use crate::record::{Case, Entry};
use crate::transport::{ball, glass, grey, parallelogram, pick, plane};
use etendue::bsdf::fresnel_dielectric;
use etendue::desc::{BsdfDesc, IntegratorDesc, RenderDesc};
use etendue::integrator::photon::MapKind;
use etendue::math::DVec3;
use etendue::spectrum::Rgb;

pub fn cases() -> Vec<Entry> {
    vec![
        Entry { id: "M62", title: "caustic of a glass ball", run: glass_ball },
        Entry { id: "M40", title: "floor under water, from the eye and from the light", run: water },
    ]
}

/// How far off the light is, in radii of the ball.
const FAR: f64 = 100.0;

fn glass_ball(case: &mut Case) {
    let paths = case.count(1 << 13, 1 << 16) as u32;
    for (ior, refracted, reflected) in
        [(1.5_f32, 0.835_544_400_144, 0.091_777_959_342_4), (1.333, 0.881_437_392_471, 0.066_405_764_783_1)]
    {
        // A point so far off that its light on the ball is a parallel beam, but for 1 / (2 FAR)².
        let mut desc = unseen(vec![(ball(DVec3::ZERO, 1.0), glass(ior, 1.0), None)]);
        add_mesh(&mut desc, box_inside(DVec3::splat(-1.5 * FAR), DVec3::splat(1.5 * FAR)), grey(0.5), None);
        desc.lights.push(point_light(DVec3::NEG_Z * FAR, 1.0));
        let scene = build(&desc);
        let cos = (1.0 - 1.0 / (FAR * FAR)).sqrt();
        let beam = 2.0 * PI / (FAR * FAR) / (1.0 + cos);
        // Cut after two hits, what is reflected at once is there; after three, what is refracted twice too.
        let [once, twice] = many_runs(|seed| {
            let cut = |depth| {
                let desc = RenderDesc { max_depth: Some(depth), ..seeded(seed) };
                stored(&shot(&scene, &desc, MapKind::Caustic, paths)) / beam
            };
            let once = cut(2);
            [once, cut(3) - once]
        });
        let name = format!("index {ior}");
        case.mean(format!("{name}: share reflected at once"), once, reflected, pick(case, 2e-2, 8e-3));
        case.mean(format!("{name}: share refracted twice"), twice, refracted, pick(case, 4e-3, 2e-3));
    }
    // On a screen through the paraxial focus, within a circle: which heights of the beam go there, and what passes.
    let mut desc = unseen(vec![
        (ball(DVec3::ZERO, 1.0), glass(1.5, 1.0), None),
        (plane(DVec3::Z * 1.5, DVec3::NEG_Z, 4.0), grey(0.5), None),
    ]);
    desc.lights.push(point_light(DVec3::NEG_Z * FAR, 1.0));
    let scene = build(&desc);
    let share = |circle: f64| {
        let steps = 100_000;
        let one = |i: i32| {
            let h = ((f64::from(i) + 0.5) / f64::from(steps)).sqrt();
            // The light is not at infinity: the ray at the incidence asin h comes at a slope of h / FAR.
            let slope = (h / FAR).asin();
            let (incidence, refraction) = (h.asin(), (h / 1.5).asin());
            let deviation = 2.0 * (incidence - refraction) - slope;
            // Every ray of the ball keeps its distance h from the centre.
            let at_screen = (h - 1.5 * deviation.sin()) / deviation.cos();
            let f = fresnel_dielectric(incidence.cos(), 1.5);
            if at_screen.abs() < circle && deviation.cos() > 0.0 { (1.0 - f) * (1.0 - f) } else { 0.0 }
        };
        (0..steps).map(one).sum::<f64>() / f64::from(steps)
    };
    let circles = [0.02, 0.1, 0.4];
    let cos = (1.0 - 1.0 / (FAR * FAR)).sqrt();
    let beam = 2.0 * PI / (FAR * FAR) / (1.0 + cos);
    let found = many_runs(|seed| {
        let desc = RenderDesc { max_depth: Some(3), ..seeded(seed) };
        let shot = shot(&scene, &desc, MapKind::Caustic, paths);
        let focus = scene.to_scene(DVec3::Z * 1.5);
        circles.map(|circle| {
            let near =
                |photon: &&etendue::integrator::photon::Photon| f64::from(photon.position().distance(focus)) < circle;
            shot.photons.iter().filter(near).map(|photon| f64::from(photon.power[0])).sum::<f64>() / beam
        })
    });
    for (circle, found) in circles.into_iter().zip(found) {
        let what = format!("within {circle} of the paraxial focus");
        case.mean(what, found, share(circle), pick(case, 1e-2, 4e-3));
    }
}

fn water(case: &mut Case) {
    // A floor under water, under a lamp as wide as chance needs to find it.
    let samples = case.count(8, 32) as u32;
    let desc = |eye: DVec3| {
        let lamp = parallelogram(DVec3::new(-1.0, 1.5, -1.0), DVec3::X * 2.0, DVec3::Z * 2.0);
        let surface = plane(DVec3::ZERO, DVec3::Y, 4.0);
        let floor = plane(DVec3::Y * -1.0, DVec3::Y, 4.0);
        let surfaces =
            vec![(floor, grey(0.6), None), (surface, glass(1.333, 1.0), None), (lamp, BsdfDesc::Black, Some(Rgb::ONE))];
        scene(camera(eye, DVec3::new(0.3, -1.0, 0.1), 20.0), surfaces)
    };
    for (what, eye) in [("from above", DVec3::new(1.8, 1.0, 0.4)), ("from within", DVec3::new(0.9, -0.2, 0.4))] {
        let scene = build(&desc(eye));
        let path = over(&images(&scene, &method(IntegratorDesc::Path, 16, 8 * samples, (1, 0.1)), RUNS / 2), grey_mean);
        for integrator in METHODS {
            let paths = case.count(1 << 13, 1 << 15) as u32;
            let found = over(&images(&scene, &method(integrator, 16, samples, (paths, 0.1)), RUNS / 2), grey_mean);
            let error = found.1.hypot(path.1);
            let what = format!("{what}, {}", integrator.name());
            case.biased_mean(what, (found.0, error), path.0, (2e-3, pick(case, 4e-2, 2e-2)));
        }
    }
}
