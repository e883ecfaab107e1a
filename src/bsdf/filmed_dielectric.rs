//! Smooth interface between two dielectrics with a thin film.

use std::sync::Arc;

use super::dielectric::{reflection, refract, refraction};
use super::dispersive::Index;
use super::lobes::{Lobes, TransportMode};
use super::model::{BsdfSample, Model, SpecularLobes};
use super::thin_film::{FilmedInterface, Shares};
use crate::desc::ThinFilmDesc;
use crate::math::Vec3;
use crate::spectrum::{Rgb, Spectrum};

/// A smooth interface with a film, which reflects what interference in the film leaves and refracts the rest by Snell's law, straight
/// on where the media on both sides have the same index, as a soap film does.
///
/// All channels have one direction, unless the media disperse light: then what is refracted is the first wavelength alone, as at
/// a [`super::Dispersive`] interface.
#[derive(Clone, Debug, PartialEq)]
pub struct FilmedDielectric<C: Spectrum = Rgb> {
    interface: Arc<FilmedInterface>,
    wavelengths: C::Wavelengths,
}

impl FilmedDielectric {
    /// A film between media with these indices on the inner side (z < 0) and on the outer side.
    pub fn new(inner: Index, outer: Index, film: ThinFilmDesc) -> Self {
        Self { interface: Arc::new(FilmedInterface::new(inner, outer, film)), wavelengths: () }
    }

    /// As [`super::Bsdf::dispersing`].
    pub(super) fn dispersing(&self, inner: Index, outer: Index) -> Self {
        Self { interface: Arc::new(self.interface.dispersing(inner, outer)), wavelengths: () }
    }

    pub(super) fn in_spectrum<C: Spectrum>(&self, wavelengths: &C::Wavelengths) -> FilmedDielectric<C> {
        FilmedDielectric { interface: self.interface.clone(), wavelengths: *wavelengths }
    }
}

impl<C: Spectrum> FilmedDielectric<C> {
    /// The shares of both ways, and the refracted direction with the index on the far side over that on `wo`'s side.
    fn branches(&self, wo: Vec3) -> (Shares<C>, Option<Vec3>, f64) {
        let front = wo.z > 0.0;
        let eta = self.interface.eta(C::first_wavelength(&self.wavelengths));
        let eta = if front { eta } else { 1.0 / eta };
        (self.interface.shares(wo.z, front, &self.wavelengths), refract(wo, eta), eta)
    }
}

/// Factor on what is refracted, for what [`TransportMode`] says.
fn scale(eta: f64, mode: TransportMode) -> f32 {
    match mode {
        TransportMode::Radiance => (1.0 / (eta * eta)) as f32,
        TransportMode::Importance => 1.0,
    }
}

impl<C: Spectrum> Model<C> for FilmedDielectric<C> {
    fn lobes(&self) -> Lobes {
        Lobes::SPECULAR
    }

    fn albedo(&self) -> C {
        C::ONE
    }

    fn disperses(&self) -> bool {
        self.interface.disperses()
    }

    /// Chooses a lobe with `u[2]`, by one probability for all channels.
    fn sample(&self, wo: Vec3, u: [f32; 3], mode: TransportMode) -> Option<BsdfSample<C>> {
        let (shares, refracted, eta) = self.branches(wo);
        let Some(wi) = refracted else { return Some(reflection(wo, shares.reflected)) };
        if u[2] >= shares.probability {
            return Some(refraction(wi, shares.transmitted_weight() * scale(eta, mode), eta as f32));
        }
        Some(reflection(wo, shares.reflected_weight()))
    }

    fn specular_lobes(&self, wo: Vec3, mode: TransportMode) -> SpecularLobes<C> {
        let (shares, refracted, eta) = self.branches(wo);
        let refraction = refracted.map(|wi| refraction(wi, shares.transmitted * scale(eta, mode), eta as f32));
        [Some(reflection(wo, shares.reflected)), refraction, None]
    }
}
