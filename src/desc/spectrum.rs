//! Descriptions of spectra: of lights, and of what materials reflect and absorb.

use std::fmt;
use std::sync::Arc;

use super::validate;
use crate::math::DVec3;
use crate::photometry::of_luminance_one;
use crate::spectrum::{
    BLACK_BODY_TEMPERATURES, Beyond, DAYLIGHT_TEMPERATURES, Illuminant, LUMINANCE_WEIGHTS, Rgb, SpectralCurve, VISIBLE,
    black_body,
};
use crate::{Error, Result};

/// Most samples of a spectrum.
pub const MOST_SPECTRUM_SAMPLES: usize = 100_000;

/// A spectrum.
///
/// Illuminants have no unit: as light they are of luminance 1, which is 683 cd m^-2 for a radiance of 1. Black bodies and samples as light
/// are absolute, for a radiance in W m^-2 sr^-1 nm^-1.
#[derive(Clone, PartialEq)]
pub enum SpectrumDesc {
    /// One of the CIE's illuminants.
    Standard(StandardIlluminant),
    /// A phase of daylight by its correlated colour temperature \[K\], from 4000 to 25000 (CIE 015:2018).
    Daylight(f64),
    /// A black body of this temperature \[K\], from 500 to 1000000, by Planck's law.
    BlackBody(f64),
    /// Wavelengths \[nm\] in strictly growing order, and values >= 0. Between them the spectrum is linear; light is 0 outside, and
    /// everything else as at the nearest sample.
    Samples(Arc<[[f64; 2]]>),
}

impl fmt::Debug for SpectrumDesc {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Standard(illuminant) => write!(f, "{illuminant:?}"),
            Self::Daylight(temperature) => write!(f, "Daylight({temperature} K)"),
            Self::BlackBody(temperature) => write!(f, "BlackBody({temperature} K)"),
            Self::Samples(samples) => write!(f, "Samples({})", samples.len()),
        }
    }
}

/// Illuminants of CIE 015:2018 and, of fluorescent lamps, CIE 15:2004.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum StandardIlluminant {
    /// Tungsten.
    A,
    /// Daylight of about 5003 K.
    D50,
    /// Daylight of about 5503 K.
    D55,
    /// Daylight of about 6504 K, the white of Rec. 709.
    D65,
    /// Daylight of about 7504 K.
    D75,
    /// The same power at all wavelengths.
    E,
    /// A fluorescent lamp of about 6430 K, of a broad band.
    FL1,
    /// A fluorescent lamp of about 4230 K, of a broad band.
    FL2,
    /// A fluorescent lamp of about 3450 K, of a broad band.
    FL3,
    /// A fluorescent lamp of about 2940 K, of a broad band.
    FL4,
    /// A fluorescent lamp of about 6350 K, of a broad band.
    FL5,
    /// A fluorescent lamp of about 4150 K, of a broad band.
    FL6,
    /// A fluorescent lamp of about 6500 K, of several bands.
    FL7,
    /// A fluorescent lamp of about 5000 K, of several bands.
    FL8,
    /// A fluorescent lamp of about 4150 K, of several bands.
    FL9,
    /// A fluorescent lamp of about 5000 K, of three narrow bands.
    FL10,
    /// A fluorescent lamp of about 4000 K, of three narrow bands.
    FL11,
    /// A fluorescent lamp of about 3000 K, of three narrow bands.
    FL12,
}

impl StandardIlluminant {
    /// All of them, with their names.
    pub const ALL: [(&'static str, Self); 18] = [
        ("A", Self::A),
        ("D50", Self::D50),
        ("D55", Self::D55),
        ("D65", Self::D65),
        ("D75", Self::D75),
        ("E", Self::E),
        ("FL1", Self::FL1),
        ("FL2", Self::FL2),
        ("FL3", Self::FL3),
        ("FL4", Self::FL4),
        ("FL5", Self::FL5),
        ("FL6", Self::FL6),
        ("FL7", Self::FL7),
        ("FL8", Self::FL8),
        ("FL9", Self::FL9),
        ("FL10", Self::FL10),
        ("FL11", Self::FL11),
        ("FL12", Self::FL12),
    ];

    /// The relative spectrum.
    pub fn illuminant(self) -> Illuminant {
        // The temperature scale has changed since these were defined.
        let daylight = |nominal: f64| Illuminant::daylight(nominal * 1.4388 / 1.4380).unwrap_or(Illuminant::D65);
        let fluorescent = |number| Illuminant::Fluorescent { number };
        match self {
            Self::A => Illuminant::A,
            Self::D50 => Illuminant::D50,
            Self::D55 => daylight(5500.0),
            Self::D65 => Illuminant::D65,
            Self::D75 => daylight(7500.0),
            Self::E => Illuminant::E,
            Self::FL1 => fluorescent(1),
            Self::FL2 => fluorescent(2),
            Self::FL3 => fluorescent(3),
            Self::FL4 => fluorescent(4),
            Self::FL5 => fluorescent(5),
            Self::FL6 => fluorescent(6),
            Self::FL7 => fluorescent(7),
            Self::FL8 => fluorescent(8),
            Self::FL9 => fluorescent(9),
            Self::FL10 => fluorescent(10),
            Self::FL11 => fluorescent(11),
            Self::FL12 => fluorescent(12),
        }
    }
}

/// A parameter of a material that can have a spectrum of its own.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum SpectrumKey {
    /// `color`: what a diffuse or reflective material, fibres or a sheet that transmits diffusely reflect, in [0, 1].
    Color,
    /// `transmittance`: what a sheet that transmits diffusely lets through, in [0, 1].
    Transmittance,
    /// `reflectance`: what a conductor reflects at normal incidence, in [0, 1].
    Reflectance,
    /// `eta`: index of refraction of a conductor, > 0.
    Eta,
    /// `k`: extinction coefficient of a conductor.
    K,
    /// `absorption`: absorption coefficient of the medium in refractive bodies [1 / scene unit].
    Absorption,
    /// `emission`: emitted radiance [W m^-2 sr^-1 nm^-1].
    Emission,
}

impl SpectrumKey {
    /// All of them, with their names in files.
    pub const ALL: [(&'static str, Self); 7] = [
        ("color", Self::Color),
        ("transmittance", Self::Transmittance),
        ("reflectance", Self::Reflectance),
        ("eta", Self::Eta),
        ("k", Self::K),
        ("absorption", Self::Absorption),
        ("emission", Self::Emission),
    ];

    /// The name in files.
    pub fn name(self) -> &'static str {
        Self::ALL.iter().find(|(_, key)| *key == self).map_or("", |(name, _)| name)
    }
}

/// The spectrum of light in the form that descriptions and renders need.
#[derive(Clone, Debug, PartialEq)]
pub struct LightSpectrum {
    /// The spectrum of luminance 1 in the sense of [`crate::spectrum::luminance`].
    pub curve: SpectralCurve,
    /// Its colour of luminance 1, without negative channels.
    pub color: Rgb,
    /// The factor by which the described spectrum has more.
    pub level: f64,
    /// Whether the colour lies outside of Rec. 709, so that `color` is less saturated.
    pub is_out_of_gamut: bool,
}

impl SpectrumDesc {
    /// A spectrum by samples of wavelength \[nm\] and value.
    ///
    /// # Errors
    /// [`crate::ErrorKind::InvalidScene`] at `path` for what is no spectrum.
    pub fn samples(path: &str, samples: impl Into<Arc<[[f64; 2]]>>) -> Result<Self> {
        let spectrum = Self::Samples(samples.into());
        spectrum.check(path)?;
        Ok(spectrum)
    }

    /// The illuminant of this name.
    pub fn by_name(name: &str) -> Option<Self> {
        let known = StandardIlluminant::ALL.iter().find(|(known, _)| *known == name);
        known.map(|(_, illuminant)| Self::Standard(*illuminant))
    }

    /// Checks the numbers.
    pub(crate) fn check(&self, path: &str) -> Result<()> {
        let temperature = |kelvin: f64, [low, high]: [f64; 2]| {
            if (low..=high).contains(&kelvin) {
                return Ok(());
            }
            let message = format!("{kelvin} is out of range, expected a temperature from {low} to {high} kelvin");
            Err(Error::invalid(path, message))
        };
        match self {
            Self::Standard(_) => Ok(()),
            Self::Daylight(kelvin) => temperature(*kelvin, DAYLIGHT_TEMPERATURES),
            Self::BlackBody(kelvin) => temperature(*kelvin, BLACK_BODY_TEMPERATURES),
            Self::Samples(samples) => {
                if samples.is_empty() || samples.len() > MOST_SPECTRUM_SAMPLES {
                    let message = format!("there are {} samples, expected 1 to {MOST_SPECTRUM_SAMPLES}", samples.len());
                    return Err(Error::invalid(path, message));
                }
                let mut before = 0.0;
                for (i, &[nanometres, value]) in samples.iter().enumerate() {
                    let at = |part: usize| format!("{path}[{i}][{part}]");
                    validate::number(&at(0), nanometres)?;
                    if nanometres <= before {
                        let message = format!(
                            "the wavelength {nanometres} nm comes after {before} nm, expected growing ones above 0"
                        );
                        return Err(Error::invalid(at(0), message));
                    }
                    validate::within(&at(1), value, 0.0, f64::from(f32::MAX))?;
                    before = nanometres;
                }
                Ok(())
            }
        }
    }

    /// The values of light by the wavelength, absolute or of luminance 1.
    fn light_curve(&self) -> SpectralCurve {
        let relative = |illuminant: Illuminant| {
            let curve = SpectralCurve::of(|nanometres| illuminant.power(nanometres));
            curve.times(1.0 / curve.luminance())
        };
        match self {
            Self::Standard(standard) => relative(standard.illuminant()),
            Self::Daylight(kelvin) => relative(Illuminant::daylight(*kelvin).unwrap_or(Illuminant::D65)),
            Self::BlackBody(kelvin) => SpectralCurve::of(|nanometres| black_body(*kelvin, nanometres)),
            Self::Samples(samples) => SpectralCurve::of_samples(samples, Beyond::Zero),
        }
    }

    /// The values of its samples; none of a spectrum that has no samples.
    pub(super) fn values(&self) -> impl Iterator<Item = f64> {
        let samples = match self {
            Self::Samples(samples) => &samples[..],
            _ => &[],
        };
        samples.iter().map(|[_, value]| *value)
    }

    /// The linear Rec. 709 of light of this spectrum, with negative channels outside of the triangle of the primaries.
    pub(super) fn seen_color(&self) -> DVec3 {
        self.light_curve().light_color()
    }

    /// What tells spectra apart: those of one file, and copies of one description, have the same.
    pub(crate) fn identity(&self) -> (u8, u64) {
        match self {
            Self::Standard(illuminant) => (0, *illuminant as u64),
            Self::Daylight(kelvin) => (1, kelvin.to_bits()),
            Self::BlackBody(kelvin) => (2, kelvin.to_bits()),
            Self::Samples(samples) => (3, samples.as_ptr().addr() as u64),
        }
    }

    /// The spectrum as light.
    ///
    /// # Errors
    /// [`crate::ErrorKind::InvalidScene`] at `path` for light that no one sees.
    pub(crate) fn light(&self, path: &str) -> Result<LightSpectrum> {
        let curve = self.light_curve();
        let seen = curve.light_color();
        // A colour outside of the triangle of the primaries gets the nearest channels and the luminance that it has.
        let luminance = curve.luminance();
        let color = of_luminance_one(seen.max(DVec3::ZERO)).filter(|_| luminance > 0.0 && luminance.is_finite());
        let Some(color) = color else {
            let [low, high] = VISIBLE;
            let message = format!("there is no light that is seen, expected some between {low} and {high} nm");
            return Err(Error::invalid(path, message));
        };
        let color = Rgb::from_f64(color);
        Ok(LightSpectrum {
            is_out_of_gamut: seen.min_element() < -1e-4 * seen.max_element(),
            curve: curve.times(1.0 / luminance),
            level: luminance,
            color: color * (1.0 / crate::spectrum::luminance(color)),
        })
    }

    /// The spectrum as a function that has no unit of light: a reflectance, an index, an absorption.
    pub(crate) fn curve(&self, path: &str) -> Result<SpectralCurve> {
        match self {
            Self::Samples(samples) => Ok(SpectralCurve::of_samples(samples, Beyond::Ends)),
            _ => Err(Error::invalid(path, "a spectrum of light, expected samples of wavelength and value")),
        }
    }
}

impl LightSpectrum {
    /// The colour and level of light of this spectrum, W m^-2 sr^-1 or what else the light is stated in: the spectrum's own without
    /// `stated`, or as much luminance as `stated` has.
    pub(super) fn dress(&self, stated: Option<DVec3>) -> DVec3 {
        let own = self.color.to_f64();
        let Some(stated) = stated else { return own * self.level };
        let level = stated.dot(LUMINANCE_WEIGHTS.to_f64());
        // What was written with this colour is read back as the same bits.
        let is_own = (stated - own * level).abs().max_element() <= 1e-5 * stated.abs().max_element();
        if is_own { stated } else { own * level }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn chromaticity(spectrum: &SpectrumDesc) -> [f64; 2] {
        let xyz = *crate::spectrum::XYZ_FROM_REC_709 * spectrum.light_curve().light_color();
        let sum = xyz.element_sum();
        [xyz.x / sum, xyz.y / sum]
    }

    /// Wyszecki and Stiles 1982, *Color Science*, table 1(3.3.4), for the second radiation constant of today by scaling temperatures.
    #[test]
    fn black_bodies_have_their_chromaticities() {
        let known = [
            (1000.0, [0.6528, 0.3444]),
            (1500.0, [0.5857, 0.3931]),
            (2000.0, [0.5267, 0.4133]),
            (2500.0, [0.4770, 0.4137]),
            (3000.0, [0.4369, 0.4041]),
            (4000.0, [0.3805, 0.3768]),
            (5000.0, [0.3451, 0.3516]),
            (6500.0, [0.3135, 0.3237]),
            (10_000.0, [0.2807, 0.2884]),
            (20_000.0, [0.2565, 0.2577]),
        ];
        for (kelvin, [x, y]) in known {
            let found = chromaticity(&SpectrumDesc::BlackBody(kelvin));
            assert!((found[0] - x).abs() < 2e-4 && (found[1] - y).abs() < 2e-4, "{kelvin} K: {found:?}");
        }
    }

    #[test]
    fn light_keeps_its_luminance_and_colours_are_never_negative() {
        for spectrum in [
            SpectrumDesc::BlackBody(1000.0),
            SpectrumDesc::BlackBody(6500.0),
            SpectrumDesc::Daylight(20_000.0),
            SpectrumDesc::samples("", [[531.0, 0.0], [532.0, 7.0], [533.0, 0.0]]).unwrap(),
        ] {
            let light = spectrum.light("").unwrap();
            assert!((light.curve.luminance() - 1.0).abs() < 1e-6);
            assert!(
                (crate::spectrum::luminance(light.color) - 1.0).abs() < 1e-6
                    && light.color.to_array().iter().all(|it| *it >= 0.0)
            );
            let exact = spectrum.light_curve().luminance();
            assert!((light.dress(None).dot(LUMINANCE_WEIGHTS.to_f64()) / exact - 1.0).abs() < 1e-6);
            let stated = light.dress(Some(DVec3::splat(3.0)));
            assert!((stated.dot(LUMINANCE_WEIGHTS.to_f64()) - 3.0).abs() < 1e-5);
            assert_eq!(light.dress(Some(stated)), stated);
        }
        let d65 = SpectrumDesc::by_name("D65").unwrap().light("").unwrap();
        assert!((d65.dress(None) - DVec3::ONE).abs().max_element() < 1e-5 && !d65.is_out_of_gamut);
        assert!(SpectrumDesc::BlackBody(1000.0).light("").unwrap().is_out_of_gamut);
        let unseen = SpectrumDesc::samples("", [[1000.0, 1.0], [2000.0, 1.0]]).unwrap();
        assert!(unseen.light("a").unwrap_err().to_string().contains("no light that is seen"));
    }

    #[test]
    fn what_is_no_spectrum_is_refused() {
        let nan = f64::NAN;
        for samples in [
            vec![],
            vec![[500.0, 1.0], [500.0, 1.0]],
            vec![[500.0, 1.0], [400.0, 1.0]],
            vec![[0.0, 1.0]],
            vec![[nan, 1.0]],
            vec![[500.0, nan]],
            vec![[500.0, -1.0]],
            vec![[500.0, f64::INFINITY]],
            vec![[500.0, 1e300]],
        ] {
            assert!(SpectrumDesc::samples("a", samples.clone()).is_err(), "{samples:?}");
        }
        for wrong in [SpectrumDesc::BlackBody(0.0), SpectrumDesc::BlackBody(nan), SpectrumDesc::Daylight(3999.0)] {
            assert!(wrong.check("a").is_err(), "{wrong:?}");
        }
    }
}
