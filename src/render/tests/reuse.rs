//! Pixels that share the second hits of their paths.

use super::*;

fn sharing(seeds: u64, samples: u32) -> Effort {
    let mut effort = Effort::new(seeds, samples, 1);
    effort.desc.reuse = Some(true);
    effort
}

/// As without sharing: L = L0 + (w + a) L among walls that emit L0, with a mirror w and a Lambertian lobe a.
#[test]
fn a_furnace_of_mirrors_and_diffuse_walls_is_even() {
    let (w, a) = (0.25, 0.35);
    let mut stage = Stage::default();
    let material = stage.material(mixture(&[(MIRROR, w), (DIFFUSE, a)]));
    stage.cube(material, Some(RADIANCE));
    stage.camera([0.1, -0.2, 0.3], [0.3, 0.2, -1.0], 70.0);
    let exact = RADIANCE.to_f64() / (1.0 - f64::from(w) - f64::from(a));
    Findings::default().check(
        "mirrors and diffuse walls",
        render(&stage.build(), IntegratorDesc::Path, &sharing(12, 64)),
        exact,
    );
}

/// Compares a scene with paths by themselves.
fn agree(what: &str, stage: &Stage, seeds: u64, samples: u32) {
    let scene = stage.build();
    let mut alone = sharing(seeds, 2 * samples);
    alone.desc.reuse = Some(false);
    let expected = render(&scene, IntegratorDesc::Path, &alone);
    let mut findings = Findings::default();
    let mut together = sharing(seeds, samples);
    for (shadow_rays, what) in [(1, what.to_owned()), (2, format!("{what}, 2 light samples"))] {
        together.desc.shadow_rays = shadow_rays;
        let found = render(&scene, IntegratorDesc::Path, &together);
        findings.compare_biased(&what, found, expected, ROUNDING);
    }
}

#[test]
fn mixtures_that_reflect_agree_with_paths_by_themselves() {
    agree("mixtures", &rooms::among_mixtures(), 16, 192);
}

/// Surfaces that let light through, in the light of an environment, which the next rays of shared hits find too.
#[test]
fn mixtures_that_transmit_agree_with_paths_by_themselves() {
    let mut stage = Stage::in_environment();
    let floor = stage.material(mixture(&[(DIFFUSE, 0.5), (GLOSSY, 0.2)]));
    let all = [(DIFFUSE, 0.2), (GLOSSY, 0.15), (MIRROR, 0.1), (THROUGH, 0.25), (HAZE, 0.1), (HOLE, 0.05)];
    let screen = stage.material(mixture(&all));
    let glass = stage.material(Bsdf::new(&BsdfDesc::Dielectric { ior: 1.5, exterior_ior: 1.0 }));
    stage.quad([[-2.0, -1.0, 2.0], [2.0, -1.0, 2.0], [2.0, -1.0, -2.0], [-2.0, -1.0, -2.0]], floor, None);
    stage.quad([[-2.0, -1.0, -1.0], [2.0, -1.0, -1.0], [2.0, 1.0, -1.0], [-2.0, 1.0, -1.0]], floor, None);
    stage.quad([[-1.0, -1.0, 0.4], [0.2, -1.0, 0.0], [0.2, 0.5, 0.0], [-1.0, 0.5, 0.4]], screen, None);
    stage.sphere([0.7, -0.6, 0.3], 0.39, glass);
    stage.camera([0.0, 1.0, 2.5], [0.0, -0.5, 0.0], 45.0);
    agree("environment", &stage, 16, 128);
}
