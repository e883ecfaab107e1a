//! Photons of the sun and of skies: power on a floor, and on it by way of a mirror.

use etendue::desc::{
    DistantLightDesc, EnvironmentDesc, FormulaSkyDesc, PhotonDesc, RenderDesc, SceneDesc, ShapeDesc, SkyDesc,
};
use etendue::emitter::SkyFormula;
use etendue::integrator::photon::MapKind;
use etendue::math::DVec3;
use etendue::scene::Scene;
use etendue::spectrum::Rgb;

use super::{build, runs, seeded, shot, stored, unseen};
use crate::lights::received;
use crate::record::{Case, Entry};
use crate::transport::{ball, grey, mirror, parallelogram, pick};

pub fn cases() -> Vec<Entry> {
    vec![
        Entry { id: "M75", title: "photons of the sun and of skies", run: directly },
        Entry { id: "M75b", title: "photons of the sun, mirrored", run: mirrored },
    ]
}

/// Towards the sun.
const SUN: DVec3 = DVec3::new(0.6, 0.8, 0.0);

/// A floor of this half side, which faces up.
fn floor(half: f64) -> ShapeDesc {
    parallelogram(DVec3::new(-half, 0.0, half), DVec3::X * (2.0 * half), DVec3::Z * (-2.0 * half))
}

/// Power of the photons that come to upper sides.
fn facing_up(scene: &Scene, seed: u64, paths: u32) -> f64 {
    let photons = shot(scene, &seeded(seed), MapKind::Direct, paths).photons;
    photons.iter().filter(|photon| photon.normal.get().y > 0.5).map(|photon| f64::from(photon.power[0])).sum()
}

fn directly(case: &mut Case) {
    let paths = case.count(1 << 15, 1 << 18) as u32;
    let half = 0.7;
    let mut lit: Vec<(String, SceneDesc, f64)> = Vec::new();
    let dark = || unseen(vec![(floor(half), grey(0.5), None)]);
    for degrees in [0.0, 0.533, 40.0] {
        let mut desc = dark();
        let light = DistantLightDesc { angle_deg: degrees, ..DistantLightDesc::parallel(SUN * 3.0, Rgb::splat(2.0)) };
        desc.add_distant_light(light).expect("a light of the test");
        lit.push((format!("a sun {degrees} degrees wide"), desc, 0.8 * 2.0));
    }
    for number in [1, 8, 12] {
        let mut desc = dark();
        let formula = SkyFormula::cie(number as u32).expect("a type");
        let sky = SkyDesc::Formula(FormulaSkyDesc::new(formula, SUN));
        let environment = EnvironmentDesc { sky, ..EnvironmentDesc::even(Rgb::ONE) };
        desc.set_environment_desc(Some(environment)).expect("a sky of the test");
        // That is a sky with z up.
        lit.push((format!("sky of type {number}"), desc, received(number, DVec3::new(0.6, 0.0, 0.8), DVec3::Z, 0.0)));
    }
    for (name, desc, irradiance) in lit {
        let scene = build(&desc);
        let found = runs(|seed| facing_up(&scene, seed, paths) / (4.0 * half * half));
        case.mean(name, found, irradiance, pick(case, 4e-3, 2e-3));
    }
}

fn mirrored(case: &mut Case) {
    let paths = case.count(1 << 14, 1 << 18) as u32;
    for degrees in [0.0, 0.533, 40.0] {
        // An upright mirror that sends the sun's light down to a floor that is large enough for all of it, and a ball beside it
        // that photons are aimed at in vain.
        let mut desc = unseen(vec![
            (floor(6.0), grey(0.5), None),
            (parallelogram(DVec3::new(0.0, 0.5, 0.5), DVec3::NEG_Z, DVec3::Y), mirror(0.9), None),
            (ball(DVec3::new(-3.0, 0.5, 2.0), 0.4), mirror(0.0), None),
        ]);
        let light = DistantLightDesc { angle_deg: degrees, ..DistantLightDesc::parallel(SUN, Rgb::splat(2.0)) };
        desc.add_distant_light(light).expect("a light of the test");
        let scene = build(&desc);
        for guided in [false, true] {
            let found = runs(|seed| {
                let desc = RenderDesc { photons: PhotonDesc { guided, ..PhotonDesc::default() }, ..seeded(seed) };
                stored(&shot(&scene, &desc, MapKind::Caustic, paths))
            });
            let what = if guided { "aimed" } else { "everywhere" };
            case.mean(
                format!("{degrees} degrees wide, photons {what}"),
                found,
                0.9 * 2.0 * 0.6,
                pick(case, 2e-2, 6e-3),
            );
        }
    }
}
