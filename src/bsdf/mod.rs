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
mod coat;
mod conductor;
mod dielectric;
mod diffuse_transmission;
mod dispersive;
mod eon;
mod filmed_dielectric;
mod fresnel;
mod lambert;
mod layered;
#[cfg(test)]
mod lobe_mixture;
mod lobes;
mod local;
mod measured;
mod memo;
mod metal_facet;
mod metal_spectrum;
mod microfacet;
mod mirror;
mod mix;
mod model;
mod oren_nayar;
mod oren_nayar_qualitative;
mod parts;
mod principled;
mod rough_conductor;
mod rough_dielectric;
mod rough_thin_dielectric;
mod sheen;
mod thin_dielectric;
mod thin_film;
mod tinted;

pub use black::Black;
pub use coat::Coat;
pub use conductor::Conductor;
pub use dielectric::Dielectric;
pub use diffuse_transmission::DiffuseTransmission;
pub use dispersive::{Dispersive, Index};
pub use eon::Eon;
pub use filmed_dielectric::FilmedDielectric;
pub use fresnel::{fresnel_conductor, fresnel_conductors, fresnel_dielectric, fresnel_polarised, refracted_cosine};
pub use lambert::Lambert;
pub use layered::{Layer, Layered, LayeredParts};
#[cfg(test)]
pub(crate) use lobe_mixture::LobeMixture;
pub use lobes::{Lobes, TransportMode};
pub(crate) use measured::ByWavelength;
pub use measured::Measured;
pub use metal_facet::MetalFacet;
pub use metal_spectrum::{MetalCurves, MetalSpectrum};
pub use microfacet::Microfacets;
pub use mirror::Mirror;
pub use mix::{Mix, TwoSided};
pub use model::{BsdfSample, Model, SpecularLobes};
pub use oren_nayar::OrenNayar;
pub use oren_nayar_qualitative::OrenNayarQualitative;
pub use parts::Parts;
pub use rough_conductor::RoughConductor;
pub use rough_dielectric::RoughDielectric;
pub use rough_thin_dielectric::RoughThinDielectric;
pub use sheen::Sheen;
pub use thin_dielectric::{Sheet, ThinDielectric};
pub(crate) use thin_film::FilmRange;
pub use thin_film::FilmedMetal;
pub use tinted::TintedTransmission;

use crate::desc::{BsdfDesc, Masking, MaterialDesc};
use crate::math::Vec3;
use crate::spectrum::{Rgb, Spectrum};

/// Makes the enumeration of models and hands each question on to the model. A `cfg` of a model follows its documentation.
///
/// The models of the first list answer in line. Those of the second are elaborate: they are called out of line, behind one arm of
/// the match, so that the code of paths that only meet the first ones is what it would be without them.
macro_rules! models {
    (
        in_line { $($(#[doc = $doc:literal])* $name:ident($model:ty),)* }
        out_of_line { $($(#[doc = $far_doc:literal])* $(#[cfg($cfg:meta)])? $far:ident($far_model:ty),)* }
    ) => {
        /// A scattering model with its constants worked out, in the channels that a path carries.
        #[derive(Clone, Debug, PartialEq)]
        pub enum Bsdf<C: Spectrum = Rgb> {
            $($(#[doc = $doc])* $name($model),)*
            $($(#[doc = $far_doc])* $(#[cfg($cfg)])? $far($far_model),)*
        }

        impl Bsdf<Rgb> {
            /// The same model in the channels of a path: itself for RGB.
            #[inline(always)]
            pub fn in_spectrum<C: Spectrum>(&self, wavelengths: &C::Wavelengths) -> Bsdf<C> {
                match self {
                    $(Self::$name(model) => Bsdf::$name(model.in_spectrum::<C>(wavelengths)),)*
                    _ => self.far_in_spectrum::<C>(wavelengths),
                }
            }

            #[cold]
            #[inline(never)]
            fn far_in_spectrum<C: Spectrum>(&self, wavelengths: &C::Wavelengths) -> Bsdf<C> {
                match self {
                    $($(#[cfg($cfg)])? Self::$far(model) => Bsdf::$far(model.in_spectrum::<C>(wavelengths)),)*
                    _ => unreachable!("a model that answers in line"),
                }
            }
        }

        impl<C: Spectrum> Bsdf<C> {
            /// The model as a trait object, where it is called out of line.
            #[cold]
            #[inline(never)]
            fn far(&self) -> &dyn Model<C> {
                match self {
                    $($(#[cfg($cfg)])? Self::$far(model) => model,)*
                    _ => unreachable!("a model that answers in line"),
                }
            }
        }

        impl<C: Spectrum> Model<C> for Bsdf<C> {
            #[inline(always)]
            fn lobes(&self) -> Lobes {
                match self {
                    $(Self::$name(model) => Model::<C>::lobes(model),)*
                    _ => self.far().lobes(),
                }
            }

            #[inline(always)]
            fn albedo(&self) -> C {
                match self {
                    $(Self::$name(model) => Model::<C>::albedo(model),)*
                    _ => self.far().albedo(),
                }
            }

            #[inline]
            fn diffuse_albedo(&self) -> C {
                match self {
                    $(Self::$name(model) => Model::<C>::diffuse_albedo(model),)*
                    _ => self.far().diffuse_albedo(),
                }
            }

            fn narrowest(&self) -> f32 {
                match self {
                    $(Self::$name(model) => Model::<C>::narrowest(model),)*
                    _ => self.far().narrowest(),
                }
            }

            fn is_anisotropic(&self) -> bool {
                match self {
                    $(Self::$name(model) => Model::<C>::is_anisotropic(model),)*
                    _ => self.far().is_anisotropic(),
                }
            }

            #[inline(always)]
            fn disperses(&self) -> bool {
                match self {
                    $(Self::$name(model) => Model::<C>::disperses(model),)*
                    _ => self.far().disperses(),
                }
            }

            fn share(&self, wo: Vec3) -> f32 {
                match self {
                    $(Self::$name(model) => Model::<C>::share(model, wo),)*
                    _ => self.far().share(wo),
                }
            }

            #[inline(always)]
            fn f(&self, wo: Vec3, wi: Vec3, mode: TransportMode) -> C {
                match self {
                    $(Self::$name(model) => Model::<C>::f(model, wo, wi, mode),)*
                    _ => self.far().f(wo, wi, mode),
                }
            }

            #[inline(always)]
            fn pdf(&self, wo: Vec3, wi: Vec3) -> f32 {
                match self {
                    $(Self::$name(model) => Model::<C>::pdf(model, wo, wi),)*
                    _ => self.far().pdf(wo, wi),
                }
            }

            #[inline(always)]
            fn f_pdf(&self, wo: Vec3, wi: Vec3, mode: TransportMode) -> (C, f32) {
                match self {
                    $(Self::$name(model) => Model::<C>::f_pdf(model, wo, wi, mode),)*
                    _ => self.far().f_pdf(wo, wi, mode),
                }
            }

            #[inline]
            fn sample(&self, wo: Vec3, u: [f32; 3], mode: TransportMode) -> Option<BsdfSample<C>> {
                if wo.z == 0.0 || wo.z.is_nan() {
                    return None;
                }
                match self {
                    $(Self::$name(model) => Model::<C>::sample(model, wo, u, mode),)*
                    _ => self.far().sample(wo, u, mode),
                }
            }

            #[inline]
            fn constant_f(&self) -> Option<C> {
                match self {
                    $(Self::$name(model) => Model::<C>::constant_f(model),)*
                    _ => self.far().constant_f(),
                }
            }

            #[inline]
            fn mean_f(&self, wo: Vec3) -> Option<C> {
                match self {
                    $(Self::$name(model) => Model::<C>::mean_f(model, wo),)*
                    _ => self.far().mean_f(wo),
                }
            }

            #[inline]
            fn is_even(&self) -> bool {
                match self {
                    $(Self::$name(model) => Model::<C>::is_even(model),)*
                    _ => self.far().is_even(),
                }
            }

            #[inline]
            fn specular_lobes(&self, wo: Vec3, mode: TransportMode) -> SpecularLobes<C> {
                match self {
                    $(Self::$name(model) => Model::<C>::specular_lobes(model, wo, mode),)*
                    _ => self.far().specular_lobes(wo, mode),
                }
            }
        }
    };
}

models! {
    in_line {
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
    out_of_line {
    /// Energy-preserving rough diffuse reflection.
    Eon(Eon<C>),
    /// Thin diffuse sheet.
    DiffuseTransmission(DiffuseTransmission<C>),
    /// Fibres.
    Sheen(Sheen<C>),
    /// Smooth metal.
    Conductor(Conductor<C>),
    /// Smooth dielectric interface that refracts each wavelength into another direction.
    Dispersive(Dispersive<C>),
    /// Smooth dielectric interface with a thin film.
    FilmedDielectric(FilmedDielectric<C>),
    /// Rough metal.
    RoughConductor(RoughConductor<C>),
    /// Rough dielectric interface.
    RoughDielectric(RoughDielectric<C>),
    /// Thin sheet of glass.
    ThinDielectric(ThinDielectric<C>),
    /// Thin sheet of frosted glass.
    RoughThinDielectric(RoughThinDielectric<C>),
    /// A surface under a coat or fibres.
    Layered(Layered<C>),
    /// A sum of two models.
    Mix(Mix<C>),
    /// Different models on two sides.
    TwoSided(TwoSided<C>),
    /// A factor on what is transmitted.
    TintedTransmission(TintedTransmission<C>),
    /// A model whose colours have spectra of their own.
    Measured(Measured<C>),
    /// Any lobes, for tests of integrators.
    #[cfg(test)]
    LobeMixture(LobeMixture<C>),
    }
}

impl Bsdf {
    /// The model of a checked description that names no other material (numbers finite and in the ranges [`BsdfDesc`]
    /// states).
    ///
    /// Models with no roughness become the smooth ones; the rough diffuse models become [`Lambert`], to the last bit.
    pub fn new(desc: &BsdfDesc) -> Self {
        Self::of_materials(desc, &[])
    }

    /// As [`Self::new`], for a description that may name others of these materials. A material that is not there is black.
    pub fn of_materials(desc: &BsdfDesc, materials: &[MaterialDesc]) -> Self {
        Self::within(desc, materials, None)
    }

    /// As [`Self::of_materials`], for the surface of a body in a medium of this index of refraction instead of the one that its
    /// description states. Surfaces without an inside are what they are anywhere.
    pub(crate) fn within(desc: &BsdfDesc, materials: &[MaterialDesc], around: Option<f32>) -> Self {
        // Named materials come before the ones that name them, so that the recursion ends.
        let named = |index: usize| match materials.get(index) {
            Some(material) => {
                let bsdf = Self::within(&material.bsdf, &materials[..index], around);
                bsdf.by_wavelength(&material.bsdf, &ByWavelength::new(material), around, None)
            }
            None => Self::Black(Black),
        };
        Self::of_parts(desc, &named, around, false)
    }

    /// The same interface between media whose indices depend on the wavelength, if one of them does; other models as they are.
    pub(crate) fn dispersing(self, inner: Index, outer: Index) -> Self {
        if inner.dispersion.is_none() && outer.dispersion.is_none() {
            return self;
        }
        let differs = inner != outer;
        match self {
            Self::Dielectric(_) | Self::Dispersive(_) if differs => Self::Dispersive(Dispersive::new(inner, outer)),
            Self::Dispersive(_) => Self::Dielectric(Dielectric::new(inner.ior, outer.ior)),
            Self::FilmedDielectric(filmed) => Self::FilmedDielectric(filmed.dispersing(inner, outer)),
            Self::RoughDielectric(rough) if differs => Self::RoughDielectric(rough.dispersing(inner, outer)),
            // The parts of a mixture that are bodies have one medium.
            Self::Mix(mix) => Self::Mix(mix.dispersing(inner, outer)),
            other => other,
        }
    }

    /// As [`Self::new`], for a description that textures have changed at a point and that names no other material: what its tables
    /// need is remembered by its numbers, and does not depend on its colours. `around`: the index of refraction of the medium
    /// around the body that the surface bounds, which it keeps where a texture makes it opaque.
    pub(crate) fn at_point(desc: &BsdfDesc, around: Option<f32>) -> Self {
        Self::of_parts(desc, &|_| Self::Black(Black), around, true)
    }

    /// The model of a description whose other materials are `named`. `varies`: whether textures vary it.
    fn of_parts(desc: &BsdfDesc, named: &dyn Fn(usize) -> Self, around: Option<f32>, varies: bool) -> Self {
        match *desc {
            BsdfDesc::Black => Self::Black(Black),
            BsdfDesc::Lambert { albedo } => Self::Lambert(Lambert::new(albedo)),
            BsdfDesc::OrenNayarQualitative { albedo, sigma: 0.0 } => Self::Lambert(Lambert::new(albedo)),
            BsdfDesc::OrenNayarQualitative { albedo, sigma } => {
                Self::OrenNayarQualitative(OrenNayarQualitative::new(albedo, sigma))
            }
            BsdfDesc::OrenNayar { albedo, roughness: 0.0 } | BsdfDesc::Eon { albedo, roughness: 0.0 } => {
                Self::Lambert(Lambert::new(albedo))
            }
            BsdfDesc::OrenNayar { albedo, roughness } => Self::OrenNayar(OrenNayar::new(albedo, roughness)),
            BsdfDesc::Eon { albedo, roughness } => Self::Eon(Eon::new(albedo, roughness)),
            BsdfDesc::Mirror { reflectance } => Self::Mirror(Mirror::new(reflectance)),
            BsdfDesc::Dielectric { ior, exterior_ior } => {
                Self::Dielectric(Dielectric::new(ior, around.unwrap_or(exterior_ior)))
            }
            BsdfDesc::DiffuseTransmission { reflectance, transmittance } => {
                if reflectance == Rgb::ZERO && transmittance == Rgb::ZERO {
                    return Self::Black(Black);
                }
                Self::DiffuseTransmission(DiffuseTransmission::new(reflectance, transmittance))
            }
            BsdfDesc::Sheen { color, roughness } => Self::Sheen(Sheen::new(color, roughness)),
            BsdfDesc::Conductor { conductor, microfacets } => {
                let facet = MetalFacet::new(&conductor);
                match Microfacets::new(&microfacets) {
                    Some(facets) => {
                        let is_compensated = microfacets.multiple_scattering && microfacets.masking != Masking::VCavity;
                        Self::RoughConductor(RoughConductor::new(facet, facets, is_compensated))
                    }
                    None => Self::Conductor(Conductor::new(facet)),
                }
            }
            BsdfDesc::RoughDielectric { ior, exterior_ior, microfacets } => {
                principled::rough_dielectric(ior, around.unwrap_or(exterior_ior), &microfacets)
            }
            BsdfDesc::ThinDielectric { ior, exterior_ior, transmittance, ref microfacets } => {
                principled::thin_dielectric(ior, exterior_ior, transmittance, microfacets)
            }
            BsdfDesc::CoatedDiffuse { albedo, ior, exterior_ior, microfacets } => {
                let eta = f64::from(ior) / f64::from(exterior_ior);
                principled::coated_diffuse(Self::Lambert(Lambert::new(albedo)), eta, &microfacets, varies)
            }
            BsdfDesc::Principled(ref desc) => {
                let outside = around.filter(|_| varies || desc.has_inside()).unwrap_or(1.0);
                principled::principled(desc, outside, varies)
            }
            // A part of no weight would be worked out for nothing.
            BsdfDesc::Mix { materials: [first, _], weight: 0.0 } => named(first),
            BsdfDesc::Mix { materials: [_, second], weight: 1.0 } => named(second),
            BsdfDesc::Mix { materials: parts, weight } => Self::Mix(Mix::new(parts.map(named), weight)),
            BsdfDesc::TwoSided { front, back } => Self::TwoSided(TwoSided::new([front, back].map(named))),
        }
    }
}

impl<C: Spectrum> Bsdf<C> {
    /// Whether it scatters nothing, whatever the directions.
    #[inline]
    pub fn is_black(&self) -> bool {
        self.albedo() == C::ZERO
    }

    /// The lobes that scatter any light: none where the Bsdf is black.
    #[inline]
    pub fn lit_lobes(&self) -> Lobes {
        if self.is_black() { Lobes::empty() } else { self.lobes() }
    }

    /// The model that scatters on the outer side of a surface (`front`) or on the inner one. It answers for directions on this
    /// side as the whole does; a two-sided material gives way to that of its two models which is on this side.
    pub fn on_side(&self, front: bool) -> Self {
        match self {
            Self::TwoSided(two_sided) => two_sided.face(front).on_side(front),
            Self::Mix(mix) => Self::Mix(mix.on_side(front)),
            same => same.clone(),
        }
    }

    /// The same model, turned about the normal counter-clockwise by the angle with this cosine and sine.
    pub fn turned(&self, turn: [f32; 2]) -> Self {
        match self {
            Self::RoughConductor(metal) => Self::RoughConductor(metal.turned(turn)),
            Self::RoughDielectric(glass) => Self::RoughDielectric(glass.turned(turn)),
            Self::RoughThinDielectric(sheet) => Self::RoughThinDielectric(sheet.turned(turn)),
            Self::Layered(layered) => Self::Layered(layered.turned(turn)),
            Self::Mix(mix) => Self::Mix(mix.turned(turn)),
            Self::TwoSided(two_sided) => Self::TwoSided(two_sided.turned(turn)),
            Self::TintedTransmission(tinted) => Self::TintedTransmission(tinted.turned(turn)),
            round => round.clone(),
        }
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
