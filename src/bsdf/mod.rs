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
#[cfg(test)]
mod lobe_mixture;
mod lobes;
mod local;
mod mirror;
mod model;
mod oren_nayar;
mod oren_nayar_qualitative;

pub use black::Black;
pub use dielectric::Dielectric;
pub use fresnel::{fresnel_dielectric, refracted_cosine};
pub use lambert::Lambert;
#[cfg(test)]
pub(crate) use lobe_mixture::LobeMixture;
pub use lobes::{Lobes, TransportMode};
pub use mirror::Mirror;
pub use model::{BsdfSample, Model, SpecularLobes};
pub use oren_nayar::OrenNayar;
pub use oren_nayar_qualitative::OrenNayarQualitative;

use crate::desc::BsdfDesc;
use crate::math::Vec3;
use crate::spectrum::{Rgb, Spectrum};

/// Makes the enumeration of models and hands each question on to the model. A `cfg` of a model follows its documentation.
macro_rules! models {
    ($($(#[doc = $doc:literal])* $(#[cfg($cfg:meta)])? $name:ident($model:ty),)*) => {
        /// A scattering model with its constants worked out, in the channels that a path carries.
        #[derive(Clone, Copy, Debug, PartialEq)]
        pub enum Bsdf<C: Spectrum = Rgb> {
            $($(#[doc = $doc])* $(#[cfg($cfg)])? $name($model),)*
        }

        impl Bsdf<Rgb> {
            /// The same model in the channels of a path: itself for RGB.
            #[inline(always)]
            pub fn in_spectrum<C: Spectrum>(&self, wavelengths: &C::Wavelengths) -> Bsdf<C> {
                match self {
                    $($(#[cfg($cfg)])? Self::$name(model) => Bsdf::$name(model.in_spectrum::<C>(wavelengths)),)*
                }
            }
        }

        impl<C: Spectrum> Model<C> for Bsdf<C> {
            #[inline]
            fn lobes(&self) -> Lobes {
                match self { $($(#[cfg($cfg)])? Self::$name(model) => Model::<C>::lobes(model),)* }
            }

            #[inline]
            fn albedo(&self) -> C {
                match self { $($(#[cfg($cfg)])? Self::$name(model) => Model::<C>::albedo(model),)* }
            }

            #[inline]
            fn diffuse_albedo(&self) -> C {
                match self { $($(#[cfg($cfg)])? Self::$name(model) => Model::<C>::diffuse_albedo(model),)* }
            }

            fn narrowest(&self) -> f32 {
                match self { $($(#[cfg($cfg)])? Self::$name(model) => Model::<C>::narrowest(model),)* }
            }

            #[inline]
            fn f(&self, wo: Vec3, wi: Vec3, mode: TransportMode) -> C {
                match self { $($(#[cfg($cfg)])? Self::$name(model) => Model::<C>::f(model, wo, wi, mode),)* }
            }

            #[inline]
            fn pdf(&self, wo: Vec3, wi: Vec3) -> f32 {
                match self { $($(#[cfg($cfg)])? Self::$name(model) => Model::<C>::pdf(model, wo, wi),)* }
            }

            #[inline]
            fn sample(&self, wo: Vec3, u: [f32; 3], mode: TransportMode) -> Option<BsdfSample<C>> {
                if wo.z == 0.0 || wo.z.is_nan() {
                    return None;
                }
                match self { $($(#[cfg($cfg)])? Self::$name(model) => model.sample(wo, u, mode),)* }
            }

            #[inline]
            fn constant_f(&self) -> Option<C> {
                match self { $($(#[cfg($cfg)])? Self::$name(model) => Model::<C>::constant_f(model),)* }
            }

            #[inline]
            fn mean_f(&self, wo: Vec3) -> Option<C> {
                match self { $($(#[cfg($cfg)])? Self::$name(model) => model.mean_f(wo),)* }
            }

            #[inline]
            fn specular_lobes(&self, wo: Vec3, mode: TransportMode) -> SpecularLobes<C> {
                match self { $($(#[cfg($cfg)])? Self::$name(model) => model.specular_lobes(wo, mode),)* }
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
    /// Any lobes, for tests of integrators.
    #[cfg(test)]
    LobeMixture(LobeMixture<C>),
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sampling::warps;

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
