//! Rooms without a closed form: photon methods agree with path tracing.

use super::*;

/// Methods that find all light.
const ALL_LIGHT: [IntegratorDesc; 6] = [
    IntegratorDesc::PhotonDirect,
    IntegratorDesc::Caustic,
    IntegratorDesc::Photon,
    IntegratorDesc::IrradianceCache,
    IntegratorDesc::Ppm,
    IntegratorDesc::Sppm,
];

/// Share of the light that maps and caches which are made once may be off by.
const BIAS: f64 = 0.005;

/// Compares methods with path tracing: `paths` and `others` are how much is rendered.
fn agree(what: &str, stage: &Stage, paths: &Effort, others: &Effort) {
    let scene = stage.build();
    let expected = render(&scene, IntegratorDesc::Path, paths);
    let mut findings = Findings::default();
    for integrator in ALL_LIGHT {
        let mut effort = others.clone();
        if integrator == IntegratorDesc::PhotonDirect {
            // Estimates of few photons are not used, and so the others are too large in the mean.
            effort.desc.photons.count = Some(110_000);
        }
        let found = render(&scene, integrator, &effort);
        let bias = match integrator {
            IntegratorDesc::Photon | IntegratorDesc::IrradianceCache => BIAS,
            _ => 0.0,
        };
        findings.compare_biased(&format!("{what}, {}", integrator.name()), found, expected, bias);
    }
}

fn effort(seeds: u64, samples: u32, photons: u32) -> Effort {
    let mut effort = Effort::new(seeds, samples, photons);
    effort.desc.photons.radius = Some(0.1);
    effort.desc.photons.caustic_radius = Some(0.05);
    effort.desc.cache.rays = 128;
    effort
}

/// A closed room with a lamp, a shining ball that is partly a mirror, a glossy one, and a floor with gloss.
pub(super) fn among_mixtures() -> Stage {
    let mut stage = Stage::default();
    let wall = stage.material(mixture(&[(DIFFUSE, 0.6)]));
    let lacquer = stage.material(mixture(&[(MIRROR, 0.4), (DIFFUSE, 0.4)]));
    let glossy = stage.material(mixture(&[(GLOSSY, 0.5), (MIRROR, 0.2)]));
    let floor = stage.material(mixture(&[(GLOSSY, 0.3), (DIFFUSE, 0.3)]));
    stage.cube(wall, None);
    stage.quad([[-0.9, -0.9, 0.9], [0.9, -0.9, 0.9], [0.9, -0.9, -0.9], [-0.9, -0.9, -0.9]], floor, None);
    stage.sphere([-0.45, -0.55, -0.3], 0.33, lacquer);
    stage.sphere([0.45, -0.55, -0.1], 0.33, glossy);
    stage.quad([[-0.8, 0.95, -0.8], [0.8, 0.95, -0.8], [0.8, 0.95, 0.8], [-0.8, 0.95, 0.8]], wall, Some(RADIANCE));
    stage.camera([0.0, 0.1, 0.95], [0.0, -0.4, -0.5], 75.0);
    stage
}

#[test]
fn photons_agree_with_paths_among_mixtures() {
    agree("mixtures", &among_mixtures(), &effort(16, 384, 1), &effort(8, 48, 30_000));
}

/// Glass, a lacquered ball and a glossy floor in the light of an environment.
#[test]
fn photons_agree_with_paths_in_an_environment() {
    let mut stage = Stage::in_environment();
    let floor = stage.material(mixture(&[(DIFFUSE, 0.5), (GLOSSY, 0.2)]));
    let lacquer = stage.material(mixture(&[(MIRROR, 0.4), (DIFFUSE, 0.4)]));
    let glass = stage.material(Bsdf::new(&BsdfDesc::Dielectric { ior: 1.5, exterior_ior: 1.0 }));
    stage.quad([[-2.0, -1.0, 2.0], [2.0, -1.0, 2.0], [2.0, -1.0, -2.0], [-2.0, -1.0, -2.0]], floor, None);
    stage.quad([[-2.0, -1.0, -1.0], [2.0, -1.0, -1.0], [2.0, 1.0, -1.0], [-2.0, 1.0, -1.0]], floor, None);
    stage.sphere([-0.5, -0.6, 0.0], 0.39, lacquer);
    stage.sphere([0.5, -0.6, 0.3], 0.39, glass);
    stage.camera([0.0, 1.5, 2.5], [0.0, -0.7, 0.0], 45.0);
    agree("environment", &stage, &effort(16, 256, 1), &effort(12, 128, 30_000));
}
