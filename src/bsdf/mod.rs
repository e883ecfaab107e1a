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
mod fujii;
mod lambert;
mod mirror;
mod oren_nayar;

pub use dielectric::Dielectric;
pub use fresnel::{fresnel_dielectric, refracted_cosine};
pub use fujii::Fujii;
pub use lambert::Lambert;
pub use mirror::Mirror;
pub use oren_nayar::OrenNayar;

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
    OrenNayar(OrenNayar),
    /// Fujii's improved Oren-Nayar.
    Fujii(Fujii),
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
            BsdfDesc::OrenNayar { albedo, sigma: 0.0 } => Self::Lambert(Lambert::new(albedo)),
            BsdfDesc::OrenNayar { albedo, sigma } => Self::OrenNayar(OrenNayar::new(albedo, sigma)),
            BsdfDesc::Fujii { albedo, roughness: 0.0 } => Self::Lambert(Lambert::new(albedo)),
            BsdfDesc::Fujii { albedo, roughness } => Self::Fujii(Fujii::new(albedo, roughness)),
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

    /// Reflectance colour, for an albedo image: of the facets for the rough models, 1 for a dielectric.
    pub fn albedo(&self) -> Rgb {
        match self {
            Self::Black => Rgb::ZERO,
            Self::Lambert(lambert) => lambert.albedo(),
            Self::OrenNayar(oren_nayar) => oren_nayar.albedo(),
            Self::Fujii(fujii) => fujii.albedo(),
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
            Self::OrenNayar(oren_nayar) => oren_nayar.f(wo, wi),
            Self::Fujii(fujii) => fujii.f(wo, wi),
            Self::Black | Self::Mirror(_) | Self::Dielectric(_) => Rgb::ZERO,
        }
    }

    /// Density with which [`Bsdf::sample`] draws `wi` (sr^-1); 0 for delta models.
    #[inline]
    pub fn pdf(&self, wo: Vec3, wi: Vec3) -> f32 {
        match self {
            Self::Lambert(_) | Self::OrenNayar(_) | Self::Fujii(_) if same_side(wo, wi) => {
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
            Self::OrenNayar(oren_nayar) => Some(sample_diffuse(wo, u, |wi| oren_nayar.weight(wo, wi))),
            Self::Fujii(fujii) => Some(sample_diffuse(wo, u, |wi| fujii.weight(wo, wi))),
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

/// Product of the two directions' tangential parts, sin theta_o sin theta_i cos(phi_o - phi_i), free of cancellation
/// against the cosines and of any trouble at the pole.
#[inline]
fn tangential_dot(wo: Vec3, wi: Vec3) -> f32 {
    wo.x * wi.x + wo.y * wi.y
}
