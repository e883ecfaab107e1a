//! Emitters whose light has a spectrum of its own.
//!
//! Emitters hold colours. A path in wavelengths asks for the spectrum of the emitter that its light is of; sets in which no emitter has
//! one, and paths that carry colours, pay nothing.

use super::EmitterSet;
use crate::desc::LightSpectrum;
use crate::spectrum::{Rgb, Spectrum, black_body, black_body_luminance, black_body_temperature, luminance};

/// The number of the spectrum of an emitter that has none of its own.
const NONE: u32 = u32::MAX;

/// The number that stands for spectra of black bodies whose temperatures vary over an emitter: of light, the spectrum of the one that has
/// its colour.
pub const PLANCKIAN: u32 = u32::MAX - 1;

/// The spectra of a set's emitters.
#[derive(Debug)]
pub(super) struct EmissionSpectra {
    /// By the numbers of emitters; those from the end on have none.
    of: Vec<u32>,
    /// Each of luminance 1.
    spectra: Vec<LightSpectrum>,
}

impl EmitterSet {
    /// The set in which emitters have spectra: pairs of the number of an emitter and that of one of `spectra`, or [`PLANCKIAN`].
    pub fn with_spectra(mut self, pairs: &[[u32; 2]], spectra: Vec<LightSpectrum>) -> Self {
        if pairs.is_empty() {
            return self;
        }
        let mut of = vec![NONE; self.emitters().len()];
        for &[emitter, spectrum] in pairs {
            let exists = spectrum == PLANCKIAN || (spectrum as usize) < spectra.len();
            assert!(exists, "spectrum {spectrum} of {} does not exist", spectra.len());
            of[emitter as usize] = spectrum;
            // Both sides of a surface shine alike.
            if let Some(back) = self.back_of(emitter) {
                of[back as usize] = spectrum;
            }
        }
        self.spectra = Some(Box::new(EmissionSpectra { of, spectra }));
        self
    }

    /// Number of emitters whose light has a spectrum of its own.
    pub fn with_own_spectrum(&self) -> usize {
        self.spectra.as_ref().map_or(0, |all| all.of.iter().filter(|number| **number != NONE).count())
    }

    /// Light of emitter `index` that is this colour, in the channels of a path: a spectrum with its luminance.
    #[inline(always)]
    pub fn in_spectrum<C: Spectrum>(&self, index: u32, light: Rgb, wavelengths: &C::Wavelengths) -> C {
        if C::HAS_WAVELENGTHS
            && let Some(all) = &self.spectra
        {
            return all.light(index, light, wavelengths);
        }
        C::from_emission(light, wavelengths)
    }

    /// Whether [`Self::in_spectrum`] reads the number of the emitter.
    #[inline(always)]
    pub(crate) fn asks_index<C: Spectrum>(&self) -> bool {
        C::HAS_WAVELENGTHS && self.spectra.is_some()
    }
}

impl EmissionSpectra {
    fn light<C: Spectrum>(&self, index: u32, light: Rgb, wavelengths: &C::Wavelengths) -> C {
        let number = self.of.get(index as usize).copied().unwrap_or(NONE);
        match self.spectra.get(number as usize) {
            None if number == PLANCKIAN => planckian(light, wavelengths),
            None => C::from_emission(light, wavelengths),
            Some(spectrum) => {
                let at = |nanometres: Option<f32>| nanometres.map_or(1.0, |nanometres| spectrum.curve.at(nanometres));
                C::at_wavelengths(wavelengths, at) * luminance(light)
            }
        }
    }
}

/// Light of the colour of a black body, in the channels of a path.
fn planckian<C: Spectrum>(light: Rgb, wavelengths: &C::Wavelengths) -> C {
    let level = f64::from(luminance(light));
    // Not for darkness, and not for NaN.
    if level.is_nan() || level <= 0.0 {
        return C::from_emission(light, wavelengths);
    }
    let kelvin = black_body_temperature(light);
    let level = level / black_body_luminance(kelvin);
    C::at_wavelengths(wavelengths, |nanometres| {
        nanometres.map_or(1.0, |nanometres| (level * black_body(kelvin, nanometres.into())) as f32)
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::desc::SpectrumDesc;
    use crate::emitter::Emitter;
    use crate::math::Vec3;
    use crate::spectrum::{SampledSpectrum, black_body};

    #[test]
    fn light_of_an_emitter_is_its_spectrum() {
        let spectrum = SpectrumDesc::BlackBody(2700.0).light("").unwrap();
        let (color, level) = (spectrum.color, spectrum.level as f32);
        let point = |intensity| Emitter::Point { position: Vec3::ZERO, intensity };
        let emitters =
            EmitterSet::new(vec![point(Rgb::ONE), point(color * level)]).with_spectra(&[[1, 0]], vec![spectrum]);
        assert_eq!(emitters.with_own_spectrum(), 1);
        let wavelengths = SampledSpectrum::sample_wavelengths(|| 0.2);
        let found = emitters.in_spectrum::<SampledSpectrum>(1, color * (0.5 * level), &wavelengths).to_array();
        for (value, nanometres) in found.into_iter().zip(wavelengths.nanometres.to_array()) {
            let expected = 0.5 * black_body(2700.0, f64::from(nanometres));
            assert!((f64::from(value) / expected - 1.0).abs() < 1e-4, "{value} for {expected}");
        }
        let plain = emitters.in_spectrum::<SampledSpectrum>(0, Rgb::ONE, &wavelengths);
        assert_eq!(plain, SampledSpectrum::from_emission(Rgb::ONE, &wavelengths));
        assert_eq!(emitters.in_spectrum::<Rgb>(1, color, &()), color);
    }
}
