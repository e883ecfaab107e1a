//! Photons of point lights that do not shine the same in all directions.

use super::{RUNS, build, many_runs, runs, seeded, shot, stored, unseen};
use crate::common::scenes::point_light;
use crate::lights::spots::{factor, integrals, spot_light};
use crate::record::{Case, Entry, Within};
use crate::transport::{ball, glass, grey, mirror, parallelogram, pick};
use etendue::desc::{PhotonDesc, PointLightDesc, RenderDesc, SceneDesc};
use etendue::integrator::photon::MapKind;
use etendue::math::DVec3;

pub fn cases() -> Vec<Entry> {
    vec![
        Entry { id: "M73", title: "photons of spot lights", run: spots },
        Entry { id: "M73b", title: "photons of spot lights, aimed at glass and mirrors", run: aimed },
    ]
}

const SPOTS: [(f64, f64); 4] = [(45.0, 0.0), (30.0, 20.0), (90.0, 60.0), (25.0, 25.0)];
const PLACE: DVec3 = DVec3::new(0.3, 0.9, -0.2);

/// A patch of a floor around the origin.
fn floor(half: f64) -> SceneDesc {
    let shape = parallelogram(DVec3::new(-half, 0.0, half), DVec3::X * (2.0 * half), DVec3::Z * (-2.0 * half));
    unseen(vec![(shape, grey(1.0), None)])
}

/// What falls on the parallelogram of a corner and two sides, by midpoints.
fn onto(corner: DVec3, u: DVec3, v: DVec3, light: &PointLightDesc, by_angle: impl Fn(f64) -> f64, axis: DVec3) -> f64 {
    let steps = 1000;
    let area = u.cross(v);
    let one = |i: i32| {
        let at = |k: i32| (f64::from(k) + 0.5) / f64::from(steps);
        let way = corner + at(i % steps) * u + at(i / steps) * v - light.position;
        by_angle(way.angle_between(axis).to_degrees()) * way.dot(area).abs() / way.length().powi(3)
    };
    (0..steps * steps).map(one).sum::<f64>() / f64::from(steps * steps)
}

fn spots(case: &mut Case) {
    let paths = case.count(1 << 14, 1 << 17) as u32;
    let axis = DVec3::new(-0.3, -1.0, 0.1);
    for (outer, inner) in SPOTS {
        let name = format!("{outer} and {inner} degrees");
        let light = spot_light(PLACE, axis, (outer, inner));
        let half = 0.4;
        let exact = onto(
            DVec3::new(-half, 0.0, half),
            DVec3::X * (2.0 * half),
            DVec3::Z * (-2.0 * half),
            &light,
            |angle| factor(outer, inner, angle),
            axis,
        );
        let mut desc = floor(half);
        desc.lights.push(light);
        let scene = build(&desc);
        let tally = shot(&scene, &seeded(1), MapKind::Global, paths).tally;
        case.exact(format!("{name}: sent out"), tally.emitted.x, integrals(outer, inner)[0], Within::Relative(1e-5));
        let found = runs(|seed| stored(&shot(&scene, &seeded(seed), MapKind::Direct, paths)));
        case.mean(format!("{name}: on a patch of floor"), found, exact, pick(case, 5e-3, 2e-3));
    }
}

fn aimed(case: &mut Case) {
    let paths = case.count(1 << 13, 1 << 16) as u32;
    let (corner, u, v) = (DVec3::new(-1.2, 0.2, -0.5), DVec3::Y, DVec3::Z);
    for (outer, inner) in SPOTS {
        let name = format!("{outer} and {inner} degrees");
        // Towards the mirror, but not its middle.
        let axis = DVec3::new(-1.0, -0.1, 0.5);
        let light = spot_light(PLACE, axis, (outer, inner));
        let even = point_light(DVec3::new(0.5, 1.0, 0.3), 0.1);
        let by_spot = onto(corner, u, v, &light, |angle| factor(outer, inner, angle), axis);
        let by_point = 0.1 * onto(corner, u, v, &even, |_| 1.0, axis);
        // All that is mirrored comes to the floor or to one of four walls.
        let mut surfaces = vec![(parallelogram(corner, u, v), mirror(0.9), None)];
        let far = 50.0;
        for side in [DVec3::X, DVec3::Y, DVec3::NEG_Y, DVec3::Z, DVec3::NEG_Z] {
            let (s, t) = (side.any_orthonormal_vector(), side.cross(side.any_orthonormal_vector()));
            surfaces.push((parallelogram(far * (side - s - t), 2.0 * far * s, 2.0 * far * t), grey(0.5), None));
        }
        let mut desc = unseen(surfaces);
        desc.lights = vec![light, even];
        let scene = build(&desc);
        let found = runs(|seed| stored(&shot(&scene, &seeded(seed), MapKind::Caustic, paths)));
        case.mean(format!("{name}: mirrored"), found, 0.9 * (by_spot + by_point), pick(case, 5e-3, 2e-3));
    }
    // By glass there is no closed form: photons that are aimed, and others.
    for (outer, inner) in SPOTS {
        let mut desc = floor(3.0);
        desc.surfaces.extend(unseen(vec![(ball(DVec3::new(0.0, 0.5, 0.0), 0.2), glass(1.5, 1.0), None)]).surfaces);
        let glass = unseen(vec![(ball(DVec3::ZERO, 1.0), glass(1.5, 1.0), None)]).materials[0].clone();
        desc.materials.push(glass);
        desc.surfaces[1].material = Some(1);
        desc.lights.push(spot_light(PLACE, DVec3::new(-0.3, -0.2, 0.1), (outer, inner)));
        let scene = build(&desc);
        let [plain, guided] = [false, true].map(|guided| {
            let [found] = many_runs(|seed| {
                let desc = RenderDesc { photons: PhotonDesc { guided, ..PhotonDesc::default() }, ..seeded(seed) };
                [stored(&shot(&scene, &desc, MapKind::Caustic, paths))]
            });
            found
        });
        let name = format!("{outer} and {inner} degrees, by glass, {RUNS} runs");
        case.equal_means(name, guided, plain, pick(case, 1e-2, 4e-3));
    }
}
