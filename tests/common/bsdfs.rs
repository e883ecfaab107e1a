//! Scattering models that several test programs use.

use etendue::bsdf::Bsdf;
use etendue::desc::BsdfDesc;
use etendue::math::Vec3;
use etendue::sampling::Rng;
use etendue::spectrum::Rgb;

/// The unit direction with these polar angles, in degrees.
pub fn direction(theta_deg: f64, phi_deg: f64) -> Vec3 {
    let (sin, cos) = theta_deg.to_radians().sin_cos();
    let (sin_phi, cos_phi) = phi_deg.to_radians().sin_cos();
    Vec3::new((sin * cos_phi) as f32, (sin * sin_phi) as f32, cos as f32)
}

pub fn lambert(albedo: f32) -> Bsdf {
    Bsdf::new(&BsdfDesc::Lambert { albedo: Rgb::splat(albedo) })
}

pub fn oren_nayar_qualitative(sigma: f32) -> Bsdf {
    Bsdf::new(&BsdfDesc::OrenNayarQualitative { albedo: Rgb::ONE, sigma })
}

pub fn oren_nayar(roughness: f32) -> Bsdf {
    Bsdf::new(&BsdfDesc::OrenNayar { albedo: Rgb::ONE, roughness })
}

/// Every diffuse model, with its name.
pub fn diffuse_models() -> Vec<(&'static str, Bsdf)> {
    vec![
        ("Lambert", lambert(0.8)),
        ("qualitative 0.1", oren_nayar_qualitative(0.1)),
        ("qualitative 0.5", oren_nayar_qualitative(0.5)),
        ("qualitative 1", oren_nayar_qualitative(1.0)),
        ("Fujii 0.1", oren_nayar(0.1)),
        ("Fujii 0.5", oren_nayar(0.5)),
        ("Fujii 1", oren_nayar(1.0)),
    ]
}

pub fn uniform_3d(rng: &mut Rng) -> [f32; 3] {
    let [a, b, c, _] = rng.next_4d();
    [a, b, c]
}
