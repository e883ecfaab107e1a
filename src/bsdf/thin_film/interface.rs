//! A film between two dielectrics.

use std::sync::Arc;

use super::complex::Complex;
use super::tables::{Key, Table, table};
use super::{FilmRange, Stack};
use crate::bsdf::dispersive::{Index, Indices};
use crate::bsdf::fresnel::refracted_cosine;
use crate::desc::LINE_D;
use crate::spectrum::{Rgb, Spectrum, luminance};

/// A film on the outer side of a body, between two dielectrics, and what it reflects.
///
/// What is not reflected is transmitted, in the direction that it has without a film.
#[derive(Clone, Debug, PartialEq)]
pub struct FilmedInterface {
    indices: Indices,
    film: FilmRange,
    /// Thickness \[nm\] at the point in question.
    thickness: f32,
    /// The reflectance by the cosine in the medium of the lower index, where it has no critical angle. Light from the other side is
    /// reflected alike at the angle to which it is refracted.
    observed: Arc<Table>,
}

/// What becomes of light at one angle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Shares<C> {
    /// The share of each channel that is reflected.
    pub reflected: C,
    /// The share that is transmitted; where the media disperse light, that of the first wavelength in all channels.
    pub transmitted: C,
    /// The probability with which a path is reflected. It balances the largest shares, so that no weight exceeds 2.
    pub probability: f32,
}

impl<C: Spectrum> Shares<C> {
    /// The weight of a reflected path that was chosen by its probability.
    pub fn reflected_weight(&self) -> C {
        weight(self.reflected, self.probability)
    }

    /// The weight of a transmitted path that was chosen by its probability.
    pub fn transmitted_weight(&self) -> C {
        weight(self.transmitted, 1.0 - self.probability)
    }
}

fn weight<C: Spectrum>(share: C, probability: f32) -> C {
    if probability > 0.0 { share / probability } else { C::ZERO }
}

impl FilmedInterface {
    /// A film between media with these indices on the inner and on the outer side, of its greatest thickness.
    pub fn new(inner: Index, outer: Index, film: impl Into<FilmRange>) -> Self {
        let (indices, film) = (Indices::new(inner, outer), film.into());
        let [low, high] = sorted(indices.both(None));
        let observed =
            table(Key::Dielectric([low, high].map(f64::to_bits), film.bits()), film, low, |thickness, nanometres| {
                Stack::new(low, [film.ior.into(), thickness], Complex::real(high), nanometres)
            });
        Self { indices, film, thickness: film.thickness[1], observed }
    }

    /// The same film between media whose indices depend on the wavelength.
    pub fn dispersing(&self, inner: Index, outer: Index) -> Self {
        Self { thickness: self.thickness, ..Self::new(inner, outer, self.film) }
    }

    /// The film where it has this thickness \[nm\], or the nearest one of its range.
    pub fn with_thickness(&self, thickness: f32) -> Self {
        let [least, most] = self.film.thickness;
        Self { thickness: thickness.max(least).min(most), ..self.clone() }
    }

    /// The film of the nearest of some thicknesses, where the thickness varies: what is worked out by the thickness for surfaces as
    /// a whole is worked out for these.
    pub fn rounded(&self) -> Self {
        const STEPS: f32 = 16.0;
        let [least, most] = self.film.thickness;
        if !self.film.varies() {
            return self.clone();
        }
        let step = (most - least) / STEPS;
        self.with_thickness(least + step * ((self.thickness - least) / step).round())
    }

    /// The films of which it is one.
    pub fn range(&self) -> FilmRange {
        self.film
    }

    /// Whether each wavelength is refracted into a direction of its own.
    pub fn disperses(&self) -> bool {
        self.indices.disperse()
    }

    /// Index on the inner side over index on the outer side.
    pub fn eta(&self, nanometres: Option<f32>) -> f64 {
        self.indices.eta(nanometres)
    }

    /// What the film makes of the reflectance, beside the ratio of the indices: the numbers by which tables are told apart.
    pub fn layer(&self) -> [u64; 2] {
        let [_, outer] = self.indices.both(None);
        let [index, thickness] = [self.film.ior, self.thickness].map(f64::from);
        [(index / outer).to_bits(), (thickness * outer).to_bits()]
    }

    /// The reflectance at a wavelength \[nm\], at the cosine of the angle of incidence on the outer side (`front`) or on the inner
    /// side.
    fn reflectance_at(&self, cos: f32, front: bool, nanometres: Option<f32>) -> f32 {
        let [inner, outer] = self.indices.both(nanometres);
        let (here, beyond) = if front { (outer, inner) } else { (inner, outer) };
        let nanometres = nanometres.map_or(LINE_D, f64::from);
        let film = [self.film.ior, self.thickness].map(f64::from);
        Stack::new(here, film, Complex::real(beyond), nanometres).reflectance(cos.into()) as f32
    }

    /// The reflectance of each channel.
    pub fn reflectance<C: Spectrum>(&self, cos: f32, front: bool, wavelengths: &C::Wavelengths) -> C {
        if C::HAS_WAVELENGTHS {
            return C::at_wavelengths(wavelengths, |nanometres| self.reflectance_at(cos, front, nanometres));
        }
        let eta = self.indices.eta(None);
        let eta = if front { eta } else { 1.0 / eta };
        let outside = if eta >= 1.0 { Some(cos) } else { refracted_cosine(cos.into(), eta).map(|cos| cos as f32) };
        outside.map_or(C::ONE, |cos| C::from_reflectance(self.observed.at(cos.abs(), self.thickness), wavelengths))
    }

    /// What is reflected and transmitted at a cosine, on the outer side (`front`) or on the inner side.
    pub fn shares<C: Spectrum>(&self, cos: f32, front: bool, wavelengths: &C::Wavelengths) -> Shares<C> {
        let reflected = self.reflectance::<C>(cos, front, wavelengths);
        let transmitted = if C::HAS_WAVELENGTHS && self.disperses() {
            C::splat(1.0 - self.reflectance_at(cos, front, C::first_wavelength(wavelengths)))
        } else {
            C::ONE - reflected
        };
        let [most_reflected, most_transmitted] = [reflected, transmitted].map(C::max_element);
        Shares { reflected, transmitted, probability: most_reflected / (most_reflected + most_transmitted) }
    }

    /// The luminance of the reflectance for light on the outer side (0) or on the inner side (1), which stands for all channels
    /// where facets scatter light more than once.
    pub fn grey(&self, side: usize, cos: f64) -> f64 {
        let colour: Rgb = self.reflectance(cos as f32, side == 0, &());
        f64::from(luminance(colour)).clamp(0.0, 1.0)
    }
}

fn sorted([a, b]: [f64; 2]) -> [f64; 2] {
    if a <= b { [a, b] } else { [b, a] }
}
