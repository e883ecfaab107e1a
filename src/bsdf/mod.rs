//! Scattering at a surface.
//!
//! Conventions, the same for every model: all directions are unit vectors in the local frame whose z axis is the shading
//! normal on the surface's outer side; `wo` points back along the path, `wi` is the sampled direction, both leave the
//! surface. `f(wo, wi)` (sr^-1) carries no cosine; `pdf` is per solid angle. Perfectly specular models are delta
//! distributions: `f` and `pdf` are 0 for them and only `sample` answers.
//!
//! The diffuse models are two-sided: they reflect on the side `wo` is on and transmit nothing. A mirror reflects on both
//! sides. A dielectric tells its side by the sign of `wo.z`.
//!
//! A direction that lies in the surface (`z` exactly 0) is on no side: nothing is scattered from or into it.

mod dielectric;
mod fresnel;
mod lambert;
mod mirror;
mod oren_nayar;
mod oren_nayar_qualitative;

pub use dielectric::Dielectric;
pub use fresnel::{fresnel_dielectric, refracted_cosine};
pub use lambert::Lambert;
pub use mirror::Mirror;
pub use oren_nayar::OrenNayar;
pub use oren_nayar_qualitative::OrenNayarQualitative;

use std::f32::consts::FRAC_1_PI;

use crate::desc::BsdfDesc;
use crate::math::Vec3;
use crate::sampling::warps;
use crate::spectrum::Rgb;

/// A direction drawn from a scattering model.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BsdfSample {
    /// The direction, unit, local frame.
    pub wi: Vec3,
    /// f |cos theta_i| / pdf, for the transport of radiance: refraction carries (n_o / n_i)^2, which cancels once the path
    /// is back in the medium it started in. Transport of power (photons) leaves that factor out.
    pub weight: Rgb,
    /// Density of `wi` (sr^-1); 0 for a delta lobe, which has none.
    pub pdf: f32,
    /// Whether `wi` came from a delta lobe.
    pub is_delta: bool,
    /// Index of refraction on `wi`'s side over that on `wo`'s side: 1 for a reflection.
    pub eta: f32,
}

/// A scattering model with its constants worked out.
#[derive(Clone, Copy, Debug)]
pub enum Bsdf {
    /// Absorbs everything.
    Black,
    /// Ideal diffuse reflection.
    Lambert(Lambert),
    /// Oren and Nayar's qualitative model.
    OrenNayarQualitative(OrenNayarQualitative),
    /// Fujii's improved Oren-Nayar.
    OrenNayar(OrenNayar),
    /// Perfect mirror.
    Mirror(Mirror),
    /// Smooth dielectric interface.
    Dielectric(Dielectric),
}

impl Bsdf {
    /// The model of a checked description (numbers finite and in the ranges [`BsdfDesc`] states).
    ///
    /// The rough diffuse models with no roughness become [`Lambert`], to the last bit.
    pub fn new(desc: &BsdfDesc) -> Self {
        match *desc {
            BsdfDesc::Black => Self::Black,
            BsdfDesc::Lambert { albedo } => Self::Lambert(Lambert::new(albedo)),
            BsdfDesc::OrenNayarQualitative { albedo, sigma: 0.0 } => Self::Lambert(Lambert::new(albedo)),
            BsdfDesc::OrenNayarQualitative { albedo, sigma } => {
                Self::OrenNayarQualitative(OrenNayarQualitative::new(albedo, sigma))
            }
            BsdfDesc::OrenNayar { albedo, roughness: 0.0 } => Self::Lambert(Lambert::new(albedo)),
            BsdfDesc::OrenNayar { albedo, roughness } => Self::OrenNayar(OrenNayar::new(albedo, roughness)),
            BsdfDesc::Mirror { reflectance } => Self::Mirror(Mirror::new(reflectance)),
            BsdfDesc::Dielectric { ior, exterior_ior } => Self::Dielectric(Dielectric::new(ior, exterior_ior)),
        }
    }

    /// Whether all it scatters leaves through delta lobes, so that no light sample can ever contribute.
    ///
    /// False for [`Bsdf::Black`], which scatters nothing; see [`Bsdf::is_black`].
    #[inline]
    pub fn is_delta(&self) -> bool {
        matches!(self, Self::Mirror(_) | Self::Dielectric(_))
    }

    /// Whether it scatters nothing, whatever the directions.
    pub fn is_black(&self) -> bool {
        match self {
            Self::Black => true,
            Self::Dielectric(_) => false,
            _ => self.albedo() == Rgb::ZERO,
        }
    }

    /// The radiance that a diffuse surface sends along the unit direction `wo` (local frame) per irradiance (sr^-1) where the same
    /// radiance comes from all directions; `None` for other surfaces.
    #[inline]
    pub fn mean_f(&self, wo: Vec3) -> Option<Rgb> {
        match self {
            Self::Lambert(lambert) => Some(lambert.f()),
            Self::OrenNayarQualitative(oren_nayar_qualitative) => {
                Some(oren_nayar_qualitative.directional_albedo(wo) * FRAC_1_PI)
            }
            Self::OrenNayar(oren_nayar) => Some(oren_nayar.directional_albedo(wo) * FRAC_1_PI),
            Self::Black | Self::Mirror(_) | Self::Dielectric(_) => None,
        }
    }

    /// Reflectance colour, for an albedo image: of the facets for the rough models, 1 for a dielectric.
    pub fn albedo(&self) -> Rgb {
        match self {
            Self::Black => Rgb::ZERO,
            Self::Lambert(lambert) => lambert.albedo(),
            Self::OrenNayarQualitative(oren_nayar_qualitative) => oren_nayar_qualitative.albedo(),
            Self::OrenNayar(oren_nayar) => oren_nayar.albedo(),
            Self::Mirror(mirror) => mirror.reflectance(),
            Self::Dielectric(_) => Rgb::ONE,
        }
    }

    /// The scattering function (sr^-1), without a cosine; 0 for delta models and for two directions on different sides.
    #[inline]
    pub fn f(&self, wo: Vec3, wi: Vec3) -> Rgb {
        if !same_side(wo, wi) {
            return Rgb::ZERO;
        }
        match self {
            Self::Lambert(lambert) => lambert.f(),
            Self::OrenNayarQualitative(oren_nayar_qualitative) => oren_nayar_qualitative.f(wo, wi),
            Self::OrenNayar(oren_nayar) => oren_nayar.f(wo, wi),
            Self::Black | Self::Mirror(_) | Self::Dielectric(_) => Rgb::ZERO,
        }
    }

    /// Density with which [`Bsdf::sample`] draws `wi` (sr^-1); 0 for delta models.
    #[inline]
    pub fn pdf(&self, wo: Vec3, wi: Vec3) -> f32 {
        match self {
            Self::Lambert(_) | Self::OrenNayarQualitative(_) | Self::OrenNayar(_) if same_side(wo, wi) => {
                warps::cosine_hemisphere_pdf(wi.z.abs())
            }
            _ => 0.0,
        }
    }

    /// [`Bsdf::f`] and [`Bsdf::pdf`] together.
    #[inline]
    pub fn f_pdf(&self, wo: Vec3, wi: Vec3) -> (Rgb, f32) {
        (self.f(wo, wi), self.pdf(wo, wi))
    }

    /// Draws a direction. `u` is uniform in [0, 1)^3: the first two choose the direction, the third between reflection and
    /// refraction. `None` where nothing is scattered.
    #[inline]
    pub fn sample(&self, wo: Vec3, u: [f32; 3]) -> Option<BsdfSample> {
        if wo.z == 0.0 || wo.z.is_nan() {
            return None;
        }
        match self {
            Self::Black => None,
            Self::Lambert(lambert) => Some(sample_diffuse(wo, u, |_| lambert.albedo())),
            Self::OrenNayarQualitative(oren_nayar_qualitative) => {
                Some(sample_diffuse(wo, u, |wi| oren_nayar_qualitative.weight(wo, wi)))
            }
            Self::OrenNayar(oren_nayar) => Some(sample_diffuse(wo, u, |wi| oren_nayar.weight(wo, wi))),
            Self::Mirror(mirror) => Some(mirror.sample(wo)),
            Self::Dielectric(dielectric) => Some(dielectric.sample(wo, u[2])),
        }
    }
}

/// A cosine-distributed direction on `wo`'s side with the weight pi f that `weight` gives it.
#[inline]
fn sample_diffuse(wo: Vec3, u: [f32; 3], weight: impl FnOnce(Vec3) -> Rgb) -> BsdfSample {
    let up = warps::cosine_hemisphere([u[0], u[1]]);
    let wi = Vec3::new(up.x, up.y, up.z.copysign(wo.z));
    BsdfSample { wi, weight: weight(wi), pdf: warps::cosine_hemisphere_pdf(up.z), is_delta: false, eta: 1.0 }
}

/// Whether both directions are strictly on one side of the surface. The product of two tiny cosines may underflow, which
/// counts as lying in the surface and keeps every quotient of cosines finite.
#[inline]
fn same_side(wo: Vec3, wi: Vec3) -> bool {
    wo.z * wi.z > 0.0
}

/// The mirror direction about the normal.
#[inline]
fn reflect(wo: Vec3) -> Vec3 {
    Vec3::new(-wo.x, -wo.y, wo.z)
}

/// pi times the directional albedo of max(0, sin sin cos(phi)) / (pi max(cos, cos)), which the rough diffuse models have in
/// common: s (theta - s c) + 2/3 s (1 - s^3) / c for sine s and cosine c of the direction's angle theta.
///
/// Source: Portsmouth, Kutz, Hill 2024, "EON: A Practical Energy-Preserving Rough Diffuse BRDF", Eq. 14, without its last term.
fn bright_side(w: Vec3) -> f32 {
    let (s, c) = (sine(w), w.z.abs());
    // (1 - s^3) / c without a difference of what is nearly the same.
    let rest = c * (1.0 + s + s * s) / (1.0 + s);
    s * (s.atan2(c) - s * c) + 2.0 / 3.0 * s * rest
}

/// Sine of a unit direction's angle to the normal.
fn sine(w: Vec3) -> f32 {
    w.x.hypot(w.y)
}

/// Product of the two directions' tangential parts, sin theta_o sin theta_i cos(phi_o - phi_i), free of cancellation
/// against the cosines and of any trouble at the pole.
#[inline]
fn tangential_dot(wo: Vec3, wi: Vec3) -> f32 {
    wo.x * wi.x + wo.y * wi.y
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_mean_of_f_is_that_of_all_directions() {
        let albedo = Rgb::new(1.0, 0.5, 0.25);
        let models = [
            BsdfDesc::Lambert { albedo },
            BsdfDesc::OrenNayarQualitative { albedo, sigma: 0.3 },
            BsdfDesc::OrenNayarQualitative { albedo, sigma: 1.2 },
            BsdfDesc::OrenNayar { albedo, roughness: 0.2 },
            BsdfDesc::OrenNayar { albedo, roughness: 1.0 },
        ];
        const N: u32 = 256;
        for desc in models {
            let bsdf = Bsdf::new(&desc);
            for degrees in [0.0_f32, 20.0, 45.0, 70.0, 80.0] {
                let (sin, cos) = degrees.to_radians().sin_cos();
                let wo = Vec3::new(0.6 * sin, -0.8 * sin, cos);
                let at = |i: u32| (i as f32 + 0.5) / N as f32;
                let mut sum = crate::math::DVec3::ZERO;
                for i in 0..N * N {
                    // Distributed by the cosine, so that f / N^2 sums up to the mean of f times pi over pi.
                    let wi = warps::cosine_hemisphere([at(i / N), at(i % N)]);
                    sum += bsdf.f(wo, wi).to_f64();
                }
                let expected = sum / f64::from(N * N);
                let mean = bsdf.mean_f(wo).unwrap().to_f64();
                let error = ((mean - expected) / expected).abs().max_element();
                assert!(error < 1e-3, "{desc:?} at {degrees} degrees: {mean} and not {expected}");
            }
        }
    }
}
