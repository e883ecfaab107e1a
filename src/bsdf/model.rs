//! What every scattering model answers.

use super::lobes::{Lobes, TransportMode};
use crate::math::Vec3;
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

/// The delta lobes of a Bsdf for one direction: reflection, refraction, and straight transmission. Each sample's weight is the
/// whole share of its lobe, as if it alone were always taken.
pub type SpecularLobes<C> = [Option<BsdfSample<C>>; 3];

/// A scattering model with its constants worked out. Directions are as the module says.
pub trait Model<C: Spectrum> {
    /// The lobes that it has.
    fn lobes(&self) -> Lobes;

    /// Reflectance colour in [0, 1]: of the facets for rough models, 1 for a dielectric. 0 means that nothing is scattered.
    fn albedo(&self) -> C;

    /// The part of [`Model::albedo`] that belongs to diffuse reflection; 0 where there is none. Models that have other lobes
    /// beside it override the default.
    #[inline]
    fn diffuse_albedo(&self) -> C {
        if self.lobes().contains(Lobes::DIFFUSE_REFLECTION) { self.albedo() } else { C::ZERO }
    }

    /// Width of the narrowest lobe, as the width parameter alpha of a microfacet distribution: 0 for a delta lobe, 1 for a
    /// diffuse one. Cones of rays are widened by it.
    fn narrowest(&self) -> f32 {
        if self.lobes().have_specular() { 0.0 } else { 1.0 }
    }

    /// Whether it looks different when the surface is turned about its normal; it then follows the surface's tangent.
    fn is_anisotropic(&self) -> bool {
        false
    }

    /// Estimate of the share of light from `wo` that is scattered, in its largest channel, by which a sum of models chooses
    /// among its parts. Above 0 wherever something is scattered.
    fn share(&self, wo: Vec3) -> f32 {
        let _ = wo;
        self.albedo().max_element()
    }

    /// Whether each wavelength is refracted into a direction of its own. What is transmitted then is that of the first wavelength
    /// of a path alone.
    fn disperses(&self) -> bool {
        false
    }

    /// The scattering function (sr^-1), without a cosine; 0 for delta lobes and between sides that no lobe connects.
    #[inline]
    fn f(&self, wo: Vec3, wi: Vec3, mode: TransportMode) -> C {
        let _ = (wo, wi, mode);
        C::ZERO
    }

    /// Density with which [`Model::sample`] draws `wi` (sr^-1); 0 for delta lobes.
    #[inline]
    fn pdf(&self, wo: Vec3, wi: Vec3) -> f32 {
        let _ = (wo, wi);
        0.0
    }

    /// [`Model::f`] and [`Model::pdf`] together, which share most of their work where facets scatter.
    #[inline(always)]
    fn f_pdf(&self, wo: Vec3, wi: Vec3, mode: TransportMode) -> (C, f32) {
        (self.f(wo, wi, mode), self.pdf(wo, wi))
    }

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

    /// Whether light from all directions counts alike for the diffuse lobes, but for what a coat over them lets through: then
    /// [`Model::mean_f`] times the irradiance is what they reflect, wherever the light comes from.
    fn is_even(&self) -> bool {
        true
    }

    /// All delta lobes at once.
    fn specular_lobes(&self, wo: Vec3, mode: TransportMode) -> SpecularLobes<C> {
        let _ = (wo, mode);
        [None; 3]
    }
}
