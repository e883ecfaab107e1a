//! A film on a metal.

use std::sync::Arc;

use super::complex::Complex;
use super::tables::{Key, table};
use super::{Observed, Stack, complex_index_at};
use crate::bsdf::MetalCurves;
use crate::desc::{ConductorDesc, LINE_D, ThinFilmDesc};
use crate::math::Vec3;
use crate::spectrum::{Rgb, Spectrum};

/// A film on a metal in air, and what it reflects.
#[derive(Clone, Debug, PartialEq)]
pub struct FilmedMetal {
    /// Index of refraction per channel.
    eta: Vec3,
    /// Extinction coefficient per channel; infinite for a perfect reflector.
    k: Vec3,
    /// The index by the wavelength, where it is known.
    curves: Option<MetalCurves>,
    film: ThinFilmDesc,
    observed: Arc<Observed>,
}

impl FilmedMetal {
    /// A film on the metal of a checked description, whose index is known by the wavelength where there are `curves`.
    pub(in crate::bsdf) fn of(conductor: &ConductorDesc, curves: Option<&MetalCurves>, film: ThinFilmDesc) -> Self {
        let index = [0, 1, 2].map(|channel| conductor.index(channel).unwrap_or([1.0, f32::INFINITY]));
        let (eta, k) = (index.map(|[eta, _]| eta).into(), index.map(|[_, k]| k).into());
        let Some(curves) = curves else { return Self::new(eta, k, film) };
        let [index, thickness] = film.numbers();
        let key = Key::MeasuredMetal(curves.bits().collect(), [index, thickness].map(f64::to_bits));
        let observed = table(key, index * thickness, |cos, nanometres| {
            Stack::new(1.0, [index, thickness], measured(curves, nanometres), nanometres).reflectance(cos)
        });
        Self { eta, k, curves: Some(curves.clone()), film, observed }
    }

    /// A film on a metal with this complex index of refraction per channel.
    pub fn new(eta: Vec3, k: Vec3, film: ThinFilmDesc) -> Self {
        let [index, thickness] = film.numbers();
        let bits = |numbers: Vec3| numbers.to_array().map(f32::to_bits);
        let key = Key::Metal(bits(eta), bits(k), [index, thickness].map(f64::to_bits));
        let observed = table(key, index * thickness, |cos, nanometres| {
            let metal = complex_index_at(eta, k, nanometres);
            Stack::new(1.0, [index, thickness], metal, nanometres).reflectance(cos)
        });
        Self { eta, k, curves: None, film, observed }
    }

    /// The reflectance at a cosine, as a sensor sees it under D65.
    pub fn observed(&self, cos: f32) -> Rgb {
        self.observed.at(cos)
    }

    /// The reflectance of each channel at a cosine.
    pub fn reflectance<C: Spectrum>(&self, cos: f32, wavelengths: &C::Wavelengths) -> C {
        if !C::HAS_WAVELENGTHS {
            return C::from_reflectance(self.observed(cos), wavelengths);
        }
        C::at_wavelengths(wavelengths, |nanometres| {
            let nanometres = nanometres.map_or(LINE_D, f64::from);
            let metal = match &self.curves {
                Some(curves) => measured(curves, nanometres),
                None => complex_index_at(self.eta, self.k, nanometres),
            };
            Stack::new(1.0, self.film.numbers(), metal, nanometres).reflectance(cos.into()) as f32
        })
    }
}

/// The complex index of a measured metal at a wavelength \[nm\].
fn measured(curves: &MetalCurves, nanometres: f64) -> Complex {
    let [eta, k] = curves.index(nanometres as f32);
    Complex::new(eta.into(), k.into())
}
