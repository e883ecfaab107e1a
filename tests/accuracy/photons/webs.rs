//! Photons of measured lamps.

use super::{add_mesh, build, runs, seeded, shot, stored, unseen};
use crate::common::scenes::box_inside;
use crate::lights::webs::{EFFICACY, UNEVEN_FLUX, in_lamp, uneven, uneven_web, web_light};
use crate::record::{Case, Entry, Within};
use crate::transport::{grey, mirror, parallelogram, pick};
use etendue::integrator::photon::MapKind;
use etendue::math::DVec3;

pub fn cases() -> Vec<Entry> {
    vec![Entry { id: "M74", title: "photons of measured lamps", run: webs }]
}

fn webs(case: &mut Case) {
    let paths = case.count(1 << 13, 1 << 16) as u32;
    let (place, axis, c0) = (DVec3::new(0.3, 0.9, -0.2), DVec3::new(-0.5, -1.0, 0.1), DVec3::new(1.0, 0.5, 0.1));
    let lamp = || web_light(place, axis, c0, uneven_web());
    let power = UNEVEN_FLUX / EFFICACY;
    // What falls on a parallelogram, by midpoints.
    let onto = |corner: DVec3, u: DVec3, v: DVec3| {
        let steps = 500;
        let area = u.cross(v);
        let one = |i: i32| {
            let at = |k: i32| (f64::from(k) + 0.5) / f64::from(steps);
            let way = corner + at(i % steps) * u + at(i / steps) * v - place;
            uneven(in_lamp(axis, c0, way.normalize())) / EFFICACY * way.dot(area).abs() / way.length().powi(3)
        };
        (0..steps * steps).map(one).sum::<f64>() / f64::from(steps * steps)
    };
    let half = 0.5;
    let (corner, u, v) = (DVec3::new(-half, 0.0, half), DVec3::X * (2.0 * half), DVec3::Z * (-2.0 * half));
    let mut desc = unseen(vec![(parallelogram(corner, u, v), grey(1.0), None)]);
    desc.lights.push(lamp());
    let scene = build(&desc);
    let tally = shot(&scene, &seeded(1), MapKind::Global, paths).tally;
    case.exact("sent out", tally.emitted.x, power, Within::Relative(3e-4));
    let found = runs(|seed| stored(&shot(&scene, &seeded(seed), MapKind::Direct, paths)));
    case.biased_mean("on a patch of floor", found, onto(corner, u, v), (3e-4, pick(case, 5e-3, 2e-3)));

    let (corner, u, v) = (DVec3::new(-1.2, 0.2, -0.5), DVec3::Y, DVec3::Z);
    let mut surfaces = vec![(parallelogram(corner, u, v), mirror(0.9), None)];
    let far = 50.0;
    for side in [DVec3::X, DVec3::Y, DVec3::NEG_Y, DVec3::Z, DVec3::NEG_Z] {
        let (s, t) = (side.any_orthonormal_vector(), side.cross(side.any_orthonormal_vector()));
        surfaces.push((parallelogram(far * (side - s - t), 2.0 * far * s, 2.0 * far * t), grey(0.5), None));
    }
    let mut desc = unseen(surfaces);
    desc.lights.push(lamp());
    let scene = build(&desc);
    let found = runs(|seed| stored(&shot(&scene, &seeded(seed), MapKind::Caustic, paths)));
    case.biased_mean("mirrored", found, 0.9 * onto(corner, u, v), (5e-4, pick(case, 5e-3, 2e-3)));

    // In a closed room, surfaces get the power of the lamp over what they absorb.
    let mut desc = unseen(Vec::new());
    add_mesh(&mut desc, box_inside(DVec3::new(-1.0, -0.8, -1.5), DVec3::new(1.2, 1.0, 0.9)), grey(0.5), None);
    desc.lights.push(lamp());
    let scene = build(&desc);
    let found = runs(|seed| stored(&shot(&scene, &seeded(seed), MapKind::Global, paths / 4)));
    case.biased_mean("stored in a closed room", found, 2.0 * power, (3e-4, pick(case, 5e-3, 2e-3)));
}
