//! A film on a metal.

use std::sync::Arc;

use super::complex::Complex;
use super::tables::{Key, Table, table};
use super::{FilmRange, Stack, complex_index_at};
use crate::bsdf::MetalCurves;
use crate::desc::{ConductorDesc, LINE_D};
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
    film: FilmRange,
    /// Thickness \[nm\] at the point in question.
    thickness: f32,
    observed: Arc<Table>,
}

impl FilmedMetal {
    /// A film on the metal of a checked description, whose index is known by the wavelength where there are `curves`; of its
    /// greatest thickness.
    pub(in crate::bsdf) fn of(conductor: &ConductorDesc, curves: Option<&MetalCurves>, film: FilmRange) -> Self {
        let index = [0, 1, 2].map(|channel| conductor.index(channel).unwrap_or([1.0, f32::INFINITY]));
        let (eta, k) = (index.map(|[eta, _]| eta).into(), index.map(|[_, k]| k).into());
        let Some(curves) = curves else { return Self::new(eta, k, film) };
        let key = Key::MeasuredMetal(curves.bits().collect(), film.bits());
        let observed = table(key, film, 1.0, |thickness, nanometres| {
            Stack::new(1.0, [film.ior.into(), thickness], measured(curves, nanometres), nanometres)
        });
        Self { eta, k, curves: Some(curves.clone()), film, thickness: film.thickness[1], observed }
    }

    /// A film on a metal with this complex index of refraction per channel, of its greatest thickness.
    pub fn new(eta: Vec3, k: Vec3, film: impl Into<FilmRange>) -> Self {
        let film = film.into();
        let bits = |numbers: Vec3| numbers.to_array().map(f32::to_bits);
        let observed = table(Key::Metal(bits(eta), bits(k), film.bits()), film, 1.0, |thickness, nanometres| {
            Stack::new(1.0, [film.ior.into(), thickness], complex_index_at(eta, k, nanometres), nanometres)
        });
        Self { eta, k, curves: None, film, thickness: film.thickness[1], observed }
    }

    /// The metal where the film has this thickness \[nm\], or the nearest one of its range.
    pub(in crate::bsdf) fn with_thickness(&self, thickness: f32) -> Self {
        let [least, most] = self.film.thickness;
        Self { thickness: thickness.max(least).min(most), ..self.clone() }
    }

    /// The mean of [`Self::observed`] for light from all sides, where it is known.
    pub(in crate::bsdf) fn mean(&self) -> Option<Rgb> {
        self.observed.mean(self.thickness)
    }

    /// The reflectance at a cosine, as a sensor sees it under D65.
    pub fn observed(&self, cos: f32) -> Rgb {
        self.observed.at(cos, self.thickness)
    }

    /// The reflectance of each channel at a cosine.
    pub fn reflectance<C: Spectrum>(&self, cos: f32, wavelengths: &C::Wavelengths) -> C {
        if !C::HAS_WAVELENGTHS {
            return C::from_reflectance(self.observed(cos), wavelengths);
        }
        let film = [self.film.ior, self.thickness].map(f64::from);
        C::at_wavelengths(wavelengths, |nanometres| {
            let nanometres = nanometres.map_or(LINE_D, f64::from);
            let metal = match &self.curves {
                Some(curves) => measured(curves, nanometres),
                None => complex_index_at(self.eta, self.k, nanometres),
            };
            Stack::new(1.0, film, metal, nanometres).reflectance(cos.into()) as f32
        })
    }
}

/// The complex index of a measured metal at a wavelength \[nm\].
fn measured(curves: &MetalCurves, nanometres: f64) -> Complex {
    let [eta, k] = curves.index(nanometres as f32);
    Complex::new(eta.into(), k.into())
}
