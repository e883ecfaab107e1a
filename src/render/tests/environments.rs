//! Light from infinity, where it has a closed form.

use std::f64::consts::PI;

use super::lobes::UNIFORM;
use super::*;
use crate::Cancel;
use crate::bake::{Atlas, AtlasOptions, Bake};
use crate::math::Bounds;

/// A diffuse sphere with a hole in uniform light: through the hole, whose cap is the share f of the sphere, comes the light of
/// an emitter in place of that cap, and light in a sphere is spread evenly. Radiance inside is X = a (f L + (1 - f) X).
///
/// Source: Goebel 1967, "Generalized Integrating-Sphere Theory".
#[test]
fn a_sphere_with_a_hole_is_evenly_lit() {
    let (a, top) = (0.6, 0.6);
    let mut stage = Stage::in_environment();
    let white = stage.material(mixture(&[(DIFFUSE, a as f32)]));
    let clip = Bounds { min: DVec3::splat(-1.5), max: DVec3::new(1.5, 1.5, top) };
    let coefficients = [1.0, 1.0, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, -1.0];
    stage.add(ShapeDesc::quadric(coefficients, Some(clip)).unwrap(), white, None);
    stage.camera([0.1, 0.0, 0.2], [0.0, 0.1, -1.0], 60.0);
    let scene = stage.build();
    let share = (1.0 - top) / 2.0;
    let all = a * share / (1.0 - a * (1.0 - share));
    let mut findings = Findings::default();
    for integrator in UNIFORM {
        let exact = match integrator {
            IntegratorDesc::Whitted | IntegratorDesc::Direct => a * share,
            _ => all,
        };
        let mut effort = Effort::new(8, 128, 20_000);
        // Disks so small that the sphere is flat in them, with enough photons.
        effort.desc.photons.radius = Some(0.06);
        effort.desc.photons.min_photons = 1;
        match integrator {
            IntegratorDesc::PhotonDirect | IntegratorDesc::Photon => effort.desc.photons.count = Some(150_000),
            IntegratorDesc::IrradianceCache => effort.desc.cache.rays = 256,
            _ => {}
        }
        findings.check(integrator.name(), render(&scene, integrator, &effort), exact * RADIANCE.to_f64());
    }
}

/// The light map of a box whose walls let light through: pi L outside, and pi X inside with X = (t + s) L + r X.
#[test]
fn light_maps_hold_the_light_of_an_environment() {
    let (r, t, s) = (0.3, 0.4, 0.2);
    let mut stage = Stage::in_environment();
    let material = stage.material(mixture(&[(DIFFUSE, r), (THROUGH, t), (HOLE, s)]));
    stage.cube(material, None);
    let scene = stage.build();
    let options = AtlasOptions { resolution: Some(32), ..AtlasOptions::default() };
    let atlas = Atlas::new(&scene, &options, &Cancel::new()).unwrap();
    let mut findings = Findings::default();
    let (r, t, s) = (f64::from(r), f64::from(t), f64::from(s));
    for (front, exact) in [(true, (t + s) / (1.0 - r)), (false, 1.0)] {
        let bake = |seed: u64| {
            let desc = RenderDesc { samples: 64, seed, ..RenderDesc::default() };
            let settings = RenderSettings { desc, threads: 1, ..RenderSettings::default() };
            let mut bake = Bake::new(&scene, atlas.sites(), settings, front).unwrap();
            bake.run(&mut |_| ControlFlow::Continue(())).unwrap();
            let irradiance = bake.irradiance().irradiance;
            let sum: DVec3 = irradiance.iter().map(|value| DVec3::from_array(value.map(f64::from))).sum();
            sum / irradiance.len() as f64
        };
        let found = Estimate::of((0..8).map(bake));
        findings.check(&format!("front {front}"), found, PI * exact * RADIANCE.to_f64());
    }
}
