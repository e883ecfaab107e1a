//! Scattering at a surface.
//!
//! Conventions, the same for every model: all directions are unit vectors in the local frame whose z axis is the shading
//! normal on the surface's outer side; `wo` points back along the path, `wi` is the sampled direction, both leave the
//! surface. `f(wo, wi)` (sr^-1) carries no cosine; `pdf` is per solid angle. Perfectly specular models are delta
//! distributions: `f` and `pdf` are 0 for them and only `sample` answers.
//!
//! A Bsdf says by its [`Lobes`] what it scatters and to which side; each model decides for itself which pairs of directions
//! it connects. The diffuse models are two-sided: they reflect on the side `wo` is on and transmit nothing. A mirror reflects
//! on both sides. A dielectric tells its side by the sign of `wo.z`. A direction that lies in the surface (`z` exactly 0) is
//! on no side: nothing is scattered from or into it.
//!
//! A new model is a file that implements [`Model`], a line in the list of models below, and an arm in [`Bsdf::new`].

mod black;
mod dielectric;
mod fresnel;
mod lambert;
mod lobes;
mod mirror;
mod oren_nayar;
mod oren_nayar_qualitative;

pub use black::Black;
pub use dielectric::Dielectric;
pub use fresnel::{fresnel_dielectric, refracted_cosine};
pub use lambert::Lambert;
pub use lobes::{Lobes, TransportMode};
pub use mirror::Mirror;
pub use oren_nayar::OrenNayar;
pub use oren_nayar_qualitative::OrenNayarQualitative;

use crate::desc::BsdfDesc;
use crate::math::Vec3;
use crate::sampling::warps;
use crate::spectrum::{Rgb, Spectrum};

/// A direction drawn from a scattering model.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BsdfSample<C: Spectrum = Rgb> {
    /// The direction, unit, local frame.
    pub wi: Vec3,
    /// f |cos theta_i| / pdf, for what [`TransportMode`] says. Refraction of radiance carries (n_o / n_i)^2, which cancels once
    /// the path is back in the medium it started in; refraction of importance does not.
    pub weight: C,
    /// Density of `wi` (sr^-1); 0 for a delta lobe, which has none.
    pub pdf: f32,
    /// The lobe that `wi` was drawn from.
    pub lobe: Lobes,
    /// Index of refraction on `wi`'s side over that on `wo`'s side: 1 for a reflection.
    pub eta: f32,
}

impl<C: Spectrum> BsdfSample<C> {
    /// Whether `wi` came from a delta lobe, which no light sample can imitate.
    #[inline(always)]
    pub fn is_specular(&self) -> bool {
        self.lobe.have_specular()
    }
}

/// The delta lobes of a Bsdf for one direction: reflection, refraction. Each sample's weight is the whole share of its lobe,
/// as if it alone were always taken.
pub type SpecularLobes<C> = [Option<BsdfSample<C>>; 2];

/// A scattering model with its constants worked out. Directions are as the module says.
pub trait Model<C: Spectrum> {
    /// The lobes that it has.
    fn lobes(&self) -> Lobes;

    /// Reflectance colour in [0, 1]: of the facets for rough models, 1 for a dielectric. 0 means that nothing is scattered.
    fn albedo(&self) -> C;

    /// Width of the narrowest lobe, as the width parameter alpha of a microfacet distribution: 0 for a delta lobe, 1 for a
    /// diffuse one.
    fn narrowest(&self) -> f32 {
        if self.lobes().have_specular() { 0.0 } else { 1.0 }
    }

    /// The scattering function (sr^-1), without a cosine; 0 for delta lobes and between sides that no lobe connects.
    fn f(&self, wo: Vec3, wi: Vec3, mode: TransportMode) -> C;

    /// Density with which [`Model::sample`] draws `wi` (sr^-1); 0 for delta lobes.
    fn pdf(&self, wo: Vec3, wi: Vec3) -> f32;

    /// Draws a direction. `wo.z` is neither 0 nor NaN; `u` is uniform in [0, 1)^3: the first two choose the direction, the
    /// third the lobe. `None` where nothing is scattered.
    fn sample(&self, wo: Vec3, u: [f32; 3], mode: TransportMode) -> Option<BsdfSample<C>>;

    /// f where it is the same for all pairs of directions on one side (sr^-1).
    fn constant_f(&self) -> Option<C> {
        None
    }

    /// The radiance that the diffuse lobes send along `wo` per irradiance (sr^-1) where the same radiance comes from all
    /// directions; `None` where there are no diffuse lobes.
    fn mean_f(&self, wo: Vec3) -> Option<C> {
        let _ = wo;
        None
    }

    /// All delta lobes at once.
    fn specular_lobes(&self, wo: Vec3, mode: TransportMode) -> SpecularLobes<C> {
        let _ = (wo, mode);
        [None; 2]
    }
}

/// Makes the enumeration of models and hands each question on to the model.
macro_rules! models {
    ($($(#[$doc:meta])* $name:ident($model:ty),)*) => {
        /// A scattering model with its constants worked out, in the channels that a path carries.
        #[derive(Clone, Copy, Debug, PartialEq)]
        pub enum Bsdf<C: Spectrum = Rgb> {
            $($(#[$doc])* $name($model),)*
        }

        impl Bsdf<Rgb> {
            /// The same model in the channels of a path: itself for RGB.
            #[inline(always)]
            pub fn in_spectrum<C: Spectrum>(&self, wavelengths: &C::Wavelengths) -> Bsdf<C> {
                match self {
                    $(Self::$name(model) => Bsdf::$name(model.in_spectrum::<C>(wavelengths)),)*
                }
            }
        }

        impl<C: Spectrum> Model<C> for Bsdf<C> {
            #[inline]
            fn lobes(&self) -> Lobes {
                match self { $(Self::$name(model) => Model::<C>::lobes(model),)* }
            }

            #[inline]
            fn albedo(&self) -> C {
                match self { $(Self::$name(model) => Model::<C>::albedo(model),)* }
            }

            fn narrowest(&self) -> f32 {
                match self { $(Self::$name(model) => Model::<C>::narrowest(model),)* }
            }

            #[inline]
            fn f(&self, wo: Vec3, wi: Vec3, mode: TransportMode) -> C {
                match self { $(Self::$name(model) => model.f(wo, wi, mode),)* }
            }

            #[inline]
            fn pdf(&self, wo: Vec3, wi: Vec3) -> f32 {
                match self { $(Self::$name(model) => Model::<C>::pdf(model, wo, wi),)* }
            }

            #[inline]
            fn sample(&self, wo: Vec3, u: [f32; 3], mode: TransportMode) -> Option<BsdfSample<C>> {
                if wo.z == 0.0 || wo.z.is_nan() {
                    return None;
                }
                match self { $(Self::$name(model) => model.sample(wo, u, mode),)* }
            }

            #[inline]
            fn constant_f(&self) -> Option<C> {
                match self { $(Self::$name(model) => Model::<C>::constant_f(model),)* }
            }

            #[inline]
            fn mean_f(&self, wo: Vec3) -> Option<C> {
                match self { $(Self::$name(model) => model.mean_f(wo),)* }
            }

            #[inline]
            fn specular_lobes(&self, wo: Vec3, mode: TransportMode) -> SpecularLobes<C> {
                match self { $(Self::$name(model) => model.specular_lobes(wo, mode),)* }
            }
        }
    };
}

models! {
    /// Absorbs everything.
    Black(Black),
    /// Ideal diffuse reflection.
    Lambert(Lambert<C>),
    /// Fujii's improved Oren-Nayar model.
    OrenNayar(OrenNayar<C>),
    /// Oren and Nayar's qualitative model.
    OrenNayarQualitative(OrenNayarQualitative<C>),
    /// Perfect mirror.
    Mirror(Mirror<C>),
    /// Smooth dielectric interface.
    Dielectric(Dielectric),
}

impl Bsdf {
    /// The model of a checked description (numbers finite and in the ranges [`BsdfDesc`] states).
    ///
    /// The rough diffuse models with no roughness become [`Lambert`], to the last bit.
    pub fn new(desc: &BsdfDesc) -> Self {
        match *desc {
            BsdfDesc::Black => Self::Black(Black),
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
}

impl<C: Spectrum> Bsdf<C> {
    /// Whether it scatters nothing, whatever the directions.
    #[inline]
    pub fn is_black(&self) -> bool {
        self.albedo() == C::ZERO
    }

    /// [`Model::f`] and [`Model::pdf`] together.
    #[inline]
    pub fn f_pdf(&self, wo: Vec3, wi: Vec3, mode: TransportMode) -> (C, f32) {
        (self.f(wo, wi, mode), self.pdf(wo, wi))
    }
}

/// A cosine-distributed direction on `wo`'s side with the weight pi f that `weight` gives it.
#[inline]
fn sample_diffuse<C: Spectrum>(wo: Vec3, u: [f32; 3], weight: impl FnOnce(Vec3) -> C) -> BsdfSample<C> {
    let up = warps::cosine_hemisphere([u[0], u[1]]);
    let wi = Vec3::new(up.x, up.y, up.z.copysign(wo.z));
    let pdf = warps::cosine_hemisphere_pdf(up.z);
    BsdfSample { wi, weight: weight(wi), pdf, lobe: Lobes::DIFFUSE_REFLECTION, eta: 1.0 }
}

/// Density of [`sample_diffuse`].
#[inline]
fn diffuse_pdf(wo: Vec3, wi: Vec3) -> f32 {
    if same_side(wo, wi) { warps::cosine_hemisphere_pdf(wi.z.abs()) } else { 0.0 }
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
                    sum += bsdf.f(wo, wi, TransportMode::Radiance).to_f64();
                }
                let expected = sum / f64::from(N * N);
                let mean = bsdf.mean_f(wo).unwrap().to_f64();
                let error = ((mean - expected) / expected).abs().max_element();
                assert!(error < 1e-3, "{desc:?} at {degrees} degrees: {mean} and not {expected}");
            }
        }
    }
}
