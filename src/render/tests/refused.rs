//! Scenes that an integrator refuses, and the one that `auto` chooses for them.

use std::sync::Arc;

use super::*;
use crate::Alone;
use crate::camera::Camera;
use crate::desc::{Preparation, RadiosityDesc};
use crate::error::{ErrorKind, Result};
use crate::integrator::photon::{Plan, choose};
use crate::integrator::radiosity::Radiosity;

/// A floor of this Bsdf below a diffuse sheet and a lamp.
fn floor(bsdf: Bsdf) -> Stage {
    let mut stage = Stage::default();
    let white = stage.material(mixture(&[(DIFFUSE, 0.5)]));
    let floor = stage.material(bsdf);
    stage.quad([[-1.0, 0.0, 1.0], [1.0, 0.0, 1.0], [1.0, 0.0, -1.0], [-1.0, 0.0, -1.0]], white, None);
    stage.quad([[-1.0, -1.0, 1.0], [1.0, -1.0, 1.0], [1.0, -1.0, -1.0], [-1.0, -1.0, -1.0]], floor, None);
    stage.desc.add_point_light(DVec3::new(0.0, 1.0, 0.0), RADIANCE).unwrap();
    stage
}

/// What each way to make an integrator says of a scene.
fn tried(scene: &Scene, integrator: IntegratorDesc) -> Vec<Result<()>> {
    let desc = RenderDesc { integrator, resolution: [4; 2], ..RenderDesc::default() };
    let settings = RenderSettings { desc: desc.clone(), threads: 1, ..RenderSettings::default() };
    let mut answers = vec![Render::new(scene, settings).map(drop)];
    match integrator.info().preparation {
        Preparation::PhotonMaps(..) => {
            let camera = Camera::new(scene.camera(), desc.resolution, scene.centre()).unwrap();
            answers.push(Plan::new(scene, &camera, &Arc::new(desc), integrator).map(drop));
        }
        Preparation::RadiositySolution => {
            answers.push(Radiosity::solve(scene, &RadiosityDesc::default(), &mut Alone::default()).map(drop));
        }
        Preparation::Nothing | Preparation::Choice => {}
    }
    answers
}

#[test]
fn what_the_table_refuses_is_refused_by_name() {
    let diffuse_through = mixture(&[(DIFFUSE, 0.25), (THROUGH, 0.25)]);
    let glossy = mixture(&[(DIFFUSE, 0.25), (GLOSSY, 0.25)]);
    let haze = mixture(&[(HAZE, 0.5)]);
    for integrator in IntegratorDesc::ALL {
        let name = integrator.name();
        let is_radiosity = integrator == IntegratorDesc::Radiosity;
        let stores = is_radiosity || matches!(integrator.info().preparation, Preparation::PhotonMaps(..));
        let takes_no = |what: &str| format!("surfaces[1]: {name} takes no {what} surfaces");
        let cases = [
            (floor(diffuse_through.clone()), stores, takes_no("diffusely transmitting")),
            (floor(glossy.clone()), is_radiosity, takes_no("glossy")),
            (floor(haze.clone()), is_radiosity, takes_no("glossy")),
        ];
        for (stage, is_refused, message) in cases {
            for answer in tried(&stage.build(), integrator) {
                match answer {
                    Ok(()) => assert!(!is_refused, "{name} took it; expected: {message}"),
                    Err(error) => {
                        assert!(is_refused, "{error}");
                        assert_eq!(error.kind(), ErrorKind::Unsupported, "{error}");
                        assert!(error.to_string().contains(&message), "{error}; expected: {message}");
                    }
                }
            }
        }
    }
}

/// What is chosen must take the scene.
#[test]
fn no_integrator_is_chosen_that_refuses_the_scene() {
    let caustics = |bsdf: Bsdf| {
        let mut stage = floor(bsdf);
        let mirror = stage.material(mixture(&[(MIRROR, 0.9)]));
        stage.sphere([0.0, 0.4, 0.0], 0.2, mirror);
        stage.build()
    };
    let diffuse = choose(&caustics(mixture(&[(DIFFUSE, 0.5)])));
    assert_eq!(diffuse.integrator, IntegratorDesc::Caustic, "{}", diffuse.why);
    let scene = caustics(mixture(&[(DIFFUSE, 0.25), (THROUGH, 0.25)]));
    let through = choose(&scene);
    assert_eq!(through.integrator, IntegratorDesc::Path, "{}", through.why);
    assert!(through.why.contains("cannot hold the light"), "{}", through.why);
    for answer in tried(&scene, IntegratorDesc::Auto) {
        answer.unwrap();
    }
}
