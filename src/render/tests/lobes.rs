//! Surfaces whose radiance has a closed form.

use super::*;
use crate::bsdf::{Model as _, TransportMode};
use crate::math::Vec3;
use crate::sampling::warps;

/// Methods that take every surface whose lobes do not transmit with a density.
pub(super) const UNIFORM: [IntegratorDesc; 9] = [
    IntegratorDesc::Path,
    IntegratorDesc::Whitted,
    IntegratorDesc::Direct,
    IntegratorDesc::PhotonDirect,
    IntegratorDesc::Caustic,
    IntegratorDesc::Photon,
    IntegratorDesc::IrradianceCache,
    IntegratorDesc::Ppm,
    IntegratorDesc::Sppm,
];

/// Methods that store no light, and so take diffuse transmission.
const STORING_NOTHING: [IntegratorDesc; 3] = [IntegratorDesc::Path, IntegratorDesc::Whitted, IntegratorDesc::Direct];

/// Share of uniform light that a surface scatters to a direction at this angle to its normal: by quadrature of f, and the
/// specular lobes.
fn directional_albedo(bsdf: &Bsdf, degrees: f64) -> f64 {
    let (sin, cos) = degrees.to_radians().sin_cos();
    let wo = DVec3::new(sin, 0.0, cos).as_vec3a();
    const N: u32 = 1024;
    let at = |i: u32| (i as f32 + 0.5) / N as f32;
    let scattered = |i: u32| {
        let up = warps::cosine_hemisphere([at(i / N), at(i % N)]);
        let sides = [up, Vec3::new(up.x, up.y, -up.z)];
        sides.map(|wi| f64::from(bsdf.f(wo, wi, TransportMode::Radiance).g())).iter().sum::<f64>()
    };
    let smooth: f64 = (0..N * N).map(scattered).sum::<f64>() * std::f64::consts::PI / f64::from(N * N);
    let specular = bsdf.specular_lobes(wo, TransportMode::Radiance);
    smooth + specular.iter().flatten().map(|lobe| f64::from(lobe.weight.g())).sum::<f64>()
}

/// A name, the weights of lobes, and angles to the normal from which the plate is seen, in degrees.
type PlateCase<'a> = (&'a str, &'a [(Lobes, f32)], &'a [f64]);

/// A plate in uniform light sends its directional albedo, whatever finds that light: it cannot light itself.
#[test]
fn a_plate_in_an_environment_sends_its_directional_albedo() {
    let mut findings = Findings::default();
    // Where nothing is stored, methods with maps are path tracing: one of them stands for the others.
    let like_paths = [IntegratorDesc::Path, IntegratorDesc::Whitted, IntegratorDesc::Direct, IntegratorDesc::Sppm];
    let cases: [PlateCase; 7] = [
        ("glossy", &[(GLOSSY, 0.7)], &[0.0, 60.0]),
        ("mirror and diffuse", &[(MIRROR, 0.3), (DIFFUSE, 0.5)], &[30.0]),
        ("mirror and glossy", &[(MIRROR, 0.3), (GLOSSY, 0.5)], &[45.0]),
        ("glossy and diffuse", &[(GLOSSY, 0.4), (DIFFUSE, 0.4)], &[60.0]),
        ("haze", &[(HAZE, 0.6), (GLOSSY, 0.2)], &[60.0]),
        ("diffuse on both sides", &[(DIFFUSE, 0.3), (THROUGH, 0.5)], &[40.0]),
        (
            "all lobes",
            &[(DIFFUSE, 0.2), (GLOSSY, 0.15), (MIRROR, 0.1), (THROUGH, 0.25), (HAZE, 0.1), (HOLE, 0.05)],
            &[50.0],
        ),
    ];
    for (name, weights, angles) in cases {
        let bsdf = mixture(weights);
        let mut stage = Stage::in_environment();
        let material = stage.material(bsdf.clone());
        stage.quad([[-5.0, -5.0, 0.0], [5.0, -5.0, 0.0], [5.0, 5.0, 0.0], [-5.0, 5.0, 0.0]], material, None);
        for &degrees in angles {
            let (sin, cos) = degrees.to_radians().sin_cos();
            stage.camera([5.0 * sin, 0.0, 5.0 * cos], [0.0; 3], 4.0);
            let scene = stage.build();
            let exact = directional_albedo(&bsdf, degrees) * RADIANCE.to_f64();
            let integrators = match bsdf.lobes() {
                lobes if lobes.contains(THROUGH) => &STORING_NOTHING[..],
                lobes if lobes.contains(DIFFUSE) => &UNIFORM[..],
                _ => &like_paths[..],
            };
            for &integrator in integrators {
                let mut effort = Effort::new(12, 64, 1000);
                effort.desc.cache.rays = 64;
                if integrator == IntegratorDesc::PhotonDirect {
                    // A narrow lobe finds too few photons.
                    if bsdf.lobes().intersects(Lobes::GLOSSY) {
                        continue;
                    }
                    // The map of direct light needs many photons in the small part that is seen.
                    effort = Effort::new(12, 16, 140_000);
                    effort.desc.photons.radius = Some(2.4);
                }
                findings.check(
                    &format!("{name} at {degrees} degrees, {}", integrator.name()),
                    render(&scene, integrator, &effort),
                    exact,
                );
            }
        }
    }
}

/// In a closed room whose walls emit L0 and scatter with a mirror w and a Lambertian lobe a, radiance is the same everywhere:
/// L = L0 + (w + a) L.
#[test]
fn a_furnace_of_mirrors_and_diffuse_walls_is_even() {
    let (w, a) = (0.25, 0.35);
    let mut stage = Stage::default();
    let material = stage.material(mixture(&[(MIRROR, w), (DIFFUSE, a)]));
    stage.cube(material, Some(RADIANCE));
    stage.camera([0.1, -0.2, 0.3], [0.3, 0.2, -1.0], 70.0);
    let scene = stage.build();
    let (w, a, light) = (f64::from(w), f64::from(a), RADIANCE.to_f64());
    let all = light / (1.0 - w - a);
    let mut findings = Findings::default();
    for integrator in UNIFORM {
        let exact = match integrator {
            // Light that is scattered once, seen in mirrors as well.
            IntegratorDesc::Whitted => light * (1.0 + a) / (1.0 - w),
            IntegratorDesc::Direct => light * (1.0 + w + a),
            _ => all,
        };
        let mut effort = Effort::new(12, 16, 20_000);
        effort.desc.cache.rays = 64;
        // The photons of a density estimate must lie on one wall.
        effort.desc.photons.radius = Some(0.3);
        effort.desc.photons.caustic_radius = Some(0.15);
        findings.check(integrator.name(), render(&scene, integrator, &effort), exact);
    }
    // Radiosity ignores mirrors, with and without a final gather.
    for final_gather in [false, true] {
        let mut effort = Effort::new(if final_gather { 12 } else { 2 }, 16, 1);
        effort.desc.radiosity.final_gather = final_gather;
        effort.desc.radiosity.element_size = Some(0.5);
        let what = format!("radiosity, final gather {final_gather}");
        findings.check(&what, render(&scene, IntegratorDesc::Radiosity, &effort), light / (1.0 - a));
    }
}

/// The walls of a closed box in uniform light L let t of it through diffusely and s of it straight: inside, X = (t + s) L + r X.
#[test]
fn light_comes_through_the_walls_of_a_box() {
    let (r, t, s) = (0.3, 0.4, 0.2);
    let mut stage = Stage::in_environment();
    let material = stage.material(mixture(&[(DIFFUSE, r), (THROUGH, t), (HOLE, s)]));
    stage.cube(material, None);
    stage.camera([0.1, -0.2, 0.3], [0.3, 0.2, -1.0], 70.0);
    let scene = stage.build();
    let (r, t, s, light) = (f64::from(r), f64::from(t), f64::from(s), RADIANCE.to_f64());
    let mut findings = Findings::default();
    let effort = Effort::new(12, 64, 1);
    for integrator in STORING_NOTHING {
        let exact = match integrator {
            // The box hides the light from its inside: a light sample reaches only the outside, and a ray that goes straight
            // through a wall finds light by itself.
            IntegratorDesc::Path => (t + s) / (1.0 - r),
            _ => t + s,
        };
        findings.check(integrator.name(), render(&scene, integrator, &effort), exact * light);
    }
}

/// A lamp behind a sheet: t / pi times the irradiance of the sheet's other side. Before it: r / pi.
#[test]
fn a_sheet_shows_the_lamp_behind_it() {
    let (r, t) = (0.25, 0.5);
    let mut findings = Findings::default();
    // The square lamp of side 2 at distance 1 and its irradiance at the middle of the sheet, at each of four corners of which
    // the sides are 1: E = L / 2 * sum of a / sqrt(1 + a^2) atan(b / sqrt(1 + a^2)).
    let corner = (1.0 / 2.0_f64.sqrt()) * (1.0 / 2.0_f64.sqrt()).atan();
    let irradiance = 4.0 * corner;
    for (side, share) in [(1.0, r), (-1.0, t)] {
        let mut stage = Stage::default();
        let sheet = stage.material(mixture(&[(DIFFUSE, r), (THROUGH, t)]));
        let black = stage.material(mixture(&[(DIFFUSE, 0.0)]));
        stage.quad([[-3.0, -3.0, 0.0], [3.0, -3.0, 0.0], [3.0, 3.0, 0.0], [-3.0, 3.0, 0.0]], sheet, None);
        // It shines downwards.
        stage.quad([[-1.0, -1.0, 1.0], [-1.0, 1.0, 1.0], [1.0, 1.0, 1.0], [1.0, -1.0, 1.0]], black, Some(RADIANCE));
        stage.camera([1.4 * side, 0.0, 0.7 * side], [0.0; 3], 0.5);
        let scene = stage.build();
        let exact = f64::from(share) / std::f64::consts::PI * irradiance * RADIANCE.to_f64();
        for integrator in STORING_NOTHING {
            let what = format!("side {side}, {}", integrator.name());
            findings.check(&what, render(&scene, integrator, &Effort::new(12, 64, 1)), exact);
        }
    }
    // A point light, seen through glossy transmission straight below it: f cos E.
    let mut stage = Stage::default();
    let sheet = stage.material(mixture(&[(HAZE, 0.5), (THROUGH, 0.25)]));
    stage.quad([[-3.0, -3.0, 0.0], [3.0, -3.0, 0.0], [3.0, 3.0, 0.0], [-3.0, 3.0, 0.0]], sheet, None);
    stage.desc.add_point_light(DVec3::new(0.0, 0.0, 2.0), RADIANCE).unwrap();
    stage.camera([0.0, 0.0, -1.0], [0.0; 3], 0.2);
    let scene = stage.build();
    let f = 0.5 * 22.0 / std::f64::consts::TAU + 0.25 / std::f64::consts::PI;
    for integrator in STORING_NOTHING {
        let found = render(&scene, integrator, &Effort::new(2, 4, 1));
        findings.check(&format!("point light, {}", integrator.name()), found, f / 4.0 * RADIANCE.to_f64());
    }
}
