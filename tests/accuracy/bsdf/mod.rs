//! Scattering models against closed forms and quadratures of them.

mod albedo;
mod fresnel;
mod glass;
mod samplers;
mod values;

use etendue::bsdf::Bsdf;
use etendue::desc::BsdfDesc;
use etendue::math::Vec3;
use etendue::sampling::Rng;
use etendue::spectrum::Rgb;

use crate::record::{Case, Entry, Within};

pub fn cases() -> Vec<Entry> {
    let topics = [values::cases(), albedo::cases(), fresnel::cases(), samplers::cases(), glass::cases()];
    topics.into_iter().flatten().collect()
}

fn direction(theta_deg: f64, phi_deg: f64) -> Vec3 {
    let (sin, cos) = theta_deg.to_radians().sin_cos();
    let (sin_phi, cos_phi) = phi_deg.to_radians().sin_cos();
    Vec3::new((sin * cos_phi) as f32, (sin * sin_phi) as f32, cos as f32)
}

fn lambert(albedo: f32) -> Bsdf {
    Bsdf::new(&BsdfDesc::Lambert { albedo: Rgb::splat(albedo) })
}

fn oren_nayar(sigma: f32) -> Bsdf {
    Bsdf::new(&BsdfDesc::OrenNayar { albedo: Rgb::ONE, sigma })
}

fn fujii(roughness: f32) -> Bsdf {
    Bsdf::new(&BsdfDesc::Fujii { albedo: Rgb::ONE, roughness })
}

fn diffuse_models() -> Vec<(&'static str, Bsdf)> {
    vec![
        ("Lambert", lambert(0.8)),
        ("qualitative 0.1", oren_nayar(0.1)),
        ("qualitative 0.5", oren_nayar(0.5)),
        ("qualitative 1", oren_nayar(1.0)),
        ("Fujii 0.1", fujii(0.1)),
        ("Fujii 0.5", fujii(0.5)),
        ("Fujii 1", fujii(1.0)),
    ]
}

fn uniform_3d(rng: &mut Rng) -> [f32; 3] {
    let [a, b, c, _] = rng.next_4d();
    [a, b, c]
}

/// The worst of several comparisons, relative to what was expected.
#[derive(Clone, Copy, Debug, Default)]
struct Worst {
    /// (got, expected, relative error)
    worst: Option<(f64, f64, f64)>,
}

impl Worst {
    fn add(&mut self, got: f64, expected: f64) {
        let off = (got - expected).abs() / expected.abs();
        // What is not a number is worse than anything.
        if self.worst.is_none_or(|(.., worst)| off > worst || off.is_nan()) {
            self.worst = Some((got, expected, off));
        }
    }

    fn row(self, case: &mut Case, what: impl Into<String>, relative: f64) {
        let (got, expected, _) = self.worst.expect("something was compared");
        case.exact(what, got, expected, Within::Relative(relative));
    }
}
