//! Scattering models: sides, delta lobes, Snell's law. Their values, densities and energy are in `accuracy/bsdf`.

mod common {
    // Each test program uses its own part.
    #[allow(dead_code)]
    pub mod bsdfs;
    #[allow(dead_code)]
    pub mod stats;
}

use common::bsdfs::{diffuse_models, direction, oren_nayar_qualitative, uniform_3d};
use common::stats::{SIGNIFICANCE, check_directions};
use etendue::bsdf::{Bsdf, BsdfSample, Dielectric, Model as _, TransportMode};
use etendue::desc::BsdfDesc;
use etendue::math::Vec3;
use etendue::sampling::{Rng, warps};
use etendue::spectrum::Rgb;

fn mirror() -> Bsdf {
    Bsdf::new(&BsdfDesc::Mirror { reflectance: Rgb::new(0.9, 0.8, 0.7) })
}

fn glass(ior: f32) -> Bsdf {
    Bsdf::new(&BsdfDesc::Dielectric { ior, exterior_ior: 1.0 })
}

#[test]
fn nothing_depends_on_which_side_is_lit() {
    let mut rng = Rng::new(4, 0);
    let flip = |w: Vec3| Vec3::new(w.x, w.y, -w.z);
    for bsdf in diffuse_models().into_iter().map(|(_, bsdf)| bsdf).chain([mirror()]) {
        for _ in 0..1000 {
            let (wo, wi) = (warps::uniform_hemisphere(rng.next_2d()), warps::uniform_hemisphere(rng.next_2d()));
            let u = uniform_3d(&mut rng);
            assert_eq!(
                bsdf.f_pdf(wo, wi, TransportMode::Radiance),
                bsdf.f_pdf(flip(wo), flip(wi), TransportMode::Radiance)
            );
            let (up, down) = (
                bsdf.sample(wo, u, TransportMode::Radiance).unwrap(),
                bsdf.sample(flip(wo), u, TransportMode::Radiance).unwrap(),
            );
            assert_eq!((up.wi, up.weight, up.pdf), (flip(down.wi), down.weight, down.pdf));
        }
    }
}

#[test]
fn the_density_check_finds_wrong_densities() {
    let bsdf = oren_nayar_qualitative(0.5);
    let wo = direction(30.0, 0.0);
    let check = |density: &dyn Fn([f32; 3]) -> f32| {
        let mut rng = Rng::new(8, 0);
        check_directions(
            500_000,
            || {
                let wi = bsdf.sample(wo, uniform_3d(&mut rng), TransportMode::Radiance).unwrap().wi.to_array();
                (wi, density(wi))
            },
            density,
        )
    };
    let pdf = |wi| bsdf.pdf(wo, Vec3::from_array(wi));
    assert!(check(&pdf).passes(SIGNIFICANCE));
    // Too large or too small by 2 %.
    assert!(!check(&|wi| 1.02 * pdf(wi)).passes(1e-6));
    assert!(!check(&|wi| 0.98 * pdf(wi)).passes(1e-6));
    // The cosine dropped: normalised, of the right support, and wrong.
    let no_cosine = check(&|wi| if wi[2] > 0.0 { warps::uniform_hemisphere_pdf() } else { 0.0 });
    assert!((no_cosine.integral - 1.0).abs() < 1e-3 && no_cosine.p_value < 1e-6, "{no_cosine:?}");
    // A tilt of 10 % that leaves the integral alone.
    let tilted = check(&|wi| pdf(wi) * (1.0 + 0.1 * wi[0]));
    assert!((tilted.integral - 1.0).abs() < 1e-3 && tilted.p_value < 1e-6, "{tilted:?}");
}

#[test]
fn delta_models_have_neither_value_nor_density() {
    let mut rng = Rng::new(10, 0);
    for bsdf in [mirror(), glass(1.5), glass(1.0)] {
        assert!(bsdf.lobes().have_specular() && !bsdf.is_black());
        for _ in 0..1000 {
            let wo = warps::uniform_sphere(rng.next_2d());
            let sample = bsdf.sample(wo, uniform_3d(&mut rng), TransportMode::Radiance).unwrap();
            assert!(sample.is_specular() && sample.pdf == 0.0);
            assert_eq!(bsdf.f_pdf(wo, sample.wi, TransportMode::Radiance), (Rgb::ZERO, 0.0));
        }
    }
    let black = Bsdf::new(&BsdfDesc::Black);
    assert!(black.lobes().is_empty() && black.is_black() && black.albedo() == Rgb::ZERO);
    assert!(black.sample(Vec3::Z, [0.5; 3], TransportMode::Radiance).is_none());
    assert_eq!(black.f_pdf(Vec3::Z, Vec3::Z, TransportMode::Radiance), (Rgb::ZERO, 0.0));
}

#[test]
fn mirror_reflects_on_both_sides() {
    for wo in [direction(50.0, 20.0), direction(130.0, 20.0)] {
        let sample = mirror().sample(wo, [0.3; 3], TransportMode::Radiance).unwrap();
        assert_eq!(sample.wi, Vec3::new(-wo.x, -wo.y, wo.z));
        assert_eq!((sample.weight, sample.eta), (Rgb::new(0.9, 0.8, 0.7), 1.0));
    }
}

#[test]
fn refraction_obeys_snell_and_carries_the_radiance_factor() {
    let mut rng = Rng::new(13, 0);
    for (ior, exterior) in [(1.5_f32, 1.0_f32), (1.333, 1.0), (2.417, 1.0), (1.0, 1.5), (1.0, 1.333), (1.000001, 1.0)] {
        let dielectric = Dielectric::new(ior, exterior);
        for _ in 0..100_000 {
            let wo = warps::uniform_sphere(rng.next_2d());
            let (n_o, n_i) = if wo.z > 0.0 { (exterior, ior) } else { (ior, exterior) };
            let (reflectance, mirrored, refracted) = dielectric.branches(wo);
            assert_eq!(mirrored, Vec3::new(-wo.x, -wo.y, wo.z));
            assert!((0.0..=1.0).contains(&reflectance));
            let Some((wi, eta)) = refracted else {
                let sin = f64::from(wo.x).hypot(f64::from(wo.y));
                assert!(reflectance == 1.0 && sin * f64::from(n_o) > f64::from(n_i) * (1.0 - 1e-6));
                let sample: BsdfSample =
                    dielectric.sample(wo, [0.0, 0.0, 1.0_f32.next_down()], TransportMode::Radiance).unwrap();
                assert_eq!((sample.wi, sample.weight, sample.eta), (mirrored, Rgb::ONE, 1.0));
                continue;
            };
            assert!(wi.z * wo.z <= 0.0 && (wi.length() - 1.0).abs() < 4e-7, "{wo} {wi}");
            let residual =
                f64::from(n_o) * f64::from(wo.truncate().length()) - f64::from(n_i) * f64::from(wi.truncate().length());
            assert!(residual.abs() < 1e-6, "{wo} {wi}: {residual}");
            assert!((eta - n_i / n_o).abs() <= 2e-7 * eta);
            // In the plane of incidence, onwards.
            assert!(wi.x * wo.x <= 0.0 && wi.y * wo.y <= 0.0);

            let reflection: BsdfSample = dielectric.sample(wo, [0.0, 0.0, 0.0], TransportMode::Radiance).unwrap();
            let refraction: BsdfSample =
                dielectric.sample(wo, [0.0, 0.0, 1.0_f32.next_down()], TransportMode::Radiance).unwrap();
            if reflectance > 0.0 {
                assert_eq!((reflection.wi, reflection.weight, reflection.eta), (mirrored, Rgb::ONE, 1.0));
            }
            if reflectance < 1.0_f32.next_down() {
                assert_eq!((refraction.wi, refraction.eta), (wi, eta));
                let factor = f64::from(n_o / n_i).powi(2);
                assert!((f64::from(refraction.weight.r()) / factor - 1.0).abs() < 1e-6);
            }
        }
    }
}

#[test]
fn directions_that_are_not_numbers_scatter_nothing() {
    let nan = Vec3::splat(f32::NAN);
    for bsdf in diffuse_models().into_iter().map(|(_, bsdf)| bsdf).chain([mirror(), glass(1.5)]) {
        assert!(bsdf.sample(nan, [0.5; 3], TransportMode::Radiance).is_none());
        assert_eq!(bsdf.f_pdf(nan, Vec3::Z, TransportMode::Radiance), (Rgb::ZERO, 0.0));
        assert!(bsdf.sample(Vec3::X, [0.5; 3], TransportMode::Radiance).is_none());
    }
}
