//! Dispersion: the index of refraction by the wavelength.

use crate::{Error, Result};

/// The wavelengths \[nm\] of the lines d, F and C, by which glasses are named.
pub const LINE_D: f64 = 587.561_8;
const LINE_F: f64 = 486.132_7;
const LINE_C: f64 = 656.272_5;

/// The wavelengths \[nm\] for which an index must exist.
const CHECKED: [f64; 2] = [360.0, 830.0];

/// Number of wavelengths at which an index is checked.
const CHECKS: u32 = 48;

/// Number of terms of Sellmeier's formula.
pub const SELLMEIER_TERMS: usize = 4;

/// Greatest index of refraction that a formula may give.
const MOST: f64 = 100.0;

/// How the index of refraction of a medium depends on the wavelength. Only renders in wavelengths
/// ([`RenderDesc::spectral`](super::RenderDesc::spectral)) show it; others use the index of the line d, 587.56 nm.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Dispersion {
    /// Cauchy's formula n = A + B / lambda^2 with the material's own index at the line d and this Abbe number
    /// (n_d - 1) / (n_F - n_C), > 0: the smaller, the more it disperses.
    Abbe(f32),
    /// Sellmeier's formula n^2 = 1 + sum of strength lambda^2 / (lambda^2 - resonance), lambda in micrometres. The material's own index
    /// is that of the formula at the line d. Terms of strength 0 are unused.
    Sellmeier {
        /// The strengths.
        strengths: [f32; SELLMEIER_TERMS],
        /// The squares of the resonant wavelengths, micrometre^2.
        resonances: [f32; SELLMEIER_TERMS],
    },
}

/// A medium of which the formula is known by its name.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Glass {
    /// Its name in files.
    pub name: &'static str,
    /// Where the numbers come from.
    pub source: &'static str,
    /// The formula.
    pub dispersion: Dispersion,
}

/// The media that are known by name.
#[expect(clippy::excessive_precision, reason = "the numbers are those of the sources")]
pub const GLASSES: [Glass; 5] = [
    Glass {
        name: "N-BK7",
        source: "SCHOTT, data sheet of N-BK7 517642.251 (borosilicate crown, n_d 1.51680, Abbe number 64.17)",
        dispersion: Dispersion::Sellmeier {
            strengths: [1.039_612_1, 0.231_792_34, 1.010_469_4, 0.0],
            resonances: [0.006_000_698_7, 0.020_017_914, 103.560_65, 0.0],
        },
    },
    Glass {
        name: "N-SF11",
        source: "SCHOTT, data sheet of N-SF11 785257.322 (dense flint, n_d 1.78472, Abbe number 25.68)",
        dispersion: Dispersion::Sellmeier {
            strengths: [1.737_596_95, 0.313_747_35, 1.898_781_01, 0.0],
            resonances: [0.013_188_707, 0.062_306_814, 155.236_29, 0.0],
        },
    },
    Glass {
        name: "fused-silica",
        source: "Malitson 1965, Interspecimen Comparison of the Refractive Index of Fused Silica (n_d 1.45846, Abbe number 67.82)",
        dispersion: Dispersion::Sellmeier {
            strengths: [0.696_166_3, 0.407_942_6, 0.897_479_4, 0.0],
            resonances: [0.004_679_148_3, 0.013_512_063, 97.934_002, 0.0],
        },
    },
    Glass {
        name: "water",
        source: "Daimon and Masumura 2007, Measurement of the refractive index of distilled water, 20.0 degrees Celsius \
                 (n_d 1.33336, Abbe number 55.8)",
        dispersion: Dispersion::Sellmeier {
            strengths: [0.568_402_76, 0.172_617_74, 0.020_861_896, 0.113_074_87],
            resonances: [0.005_101_829_7, 0.018_211_539, 0.026_207_223, 10.697_927],
        },
    },
    Glass {
        name: "diamond",
        source: "Peter 1923, Ueber Brechungsindizes und Absorptionskonstanten des Diamanten (n_d 2.4175, Abbe number 55.3)",
        dispersion: Dispersion::Sellmeier {
            strengths: [0.3306, 4.3356, 0.0, 0.0],
            resonances: [0.030_625, 0.011_236, 0.0, 0.0],
        },
    },
];

impl Dispersion {
    /// The index of refraction at a wavelength \[nm\] of a medium whose index at the line d is `ior`.
    pub fn index(&self, ior: f64, nanometres: f64) -> f64 {
        match *self {
            Self::Abbe(number) => {
                let inverse = |nanometres: f64| 1.0 / (nanometres * nanometres);
                let slope = (ior - 1.0) / (f64::from(number) * (inverse(LINE_F) - inverse(LINE_C)));
                ior + slope * (inverse(nanometres) - inverse(LINE_D))
            }
            Self::Sellmeier { strengths, resonances } => {
                let squared = (nanometres * 1e-3).powi(2);
                let term = |(strength, resonance): (f32, f32)| {
                    if strength == 0.0 {
                        return 0.0;
                    }
                    f64::from(strength) * squared / (squared - f64::from(resonance))
                };
                (1.0 + strengths.into_iter().zip(resonances).map(term).sum::<f64>()).sqrt()
            }
        }
    }

    /// The index at the line d of a medium that is described by the formula alone; `None` where the formula needs one.
    pub fn own_index(&self) -> Option<f64> {
        match self {
            Self::Abbe(_) => None,
            Self::Sellmeier { .. } => Some(self.index(1.0, LINE_D)),
        }
    }

    /// The Abbe number (n_d - 1) / (n_F - n_C) of a medium whose index at the line d is `ior`.
    pub fn abbe(&self, ior: f64) -> f64 {
        (self.index(ior, LINE_D) - 1.0) / (self.index(ior, LINE_F) - self.index(ior, LINE_C))
    }

    /// The medium of this name.
    pub fn by_name(name: &str) -> Option<Self> {
        GLASSES.iter().find(|glass| glass.name == name).map(|glass| glass.dispersion)
    }

    /// Checks that the index of a medium whose index at the line d is `ior` exists for all visible wavelengths, and that it is the
    /// formula's.
    pub(super) fn check(&self, path: &str, ior: f64) -> Result<()> {
        let fail = |message: String| Err(Error::invalid(path, message));
        if let Self::Abbe(number) = *self
            && !(number > 0.0 && number.is_finite())
        {
            return fail(format!("the Abbe number is {number}, expected a finite number above 0"));
        }
        if let Self::Sellmeier { strengths, resonances } = *self {
            let [low, high] = CHECKED.map(|nanometres| (nanometres * 1e-3).powi(2));
            let is_seen =
                |(strength, resonance): (f32, f32)| strength != 0.0 && (low..=high).contains(&f64::from(resonance));
            if let Some(term) = strengths.into_iter().zip(resonances).position(is_seen) {
                return fail(format!(
                    "the resonance {} is that of visible light, expected one below {low:.4} or above {high:.4} square micrometres",
                    resonances[term]
                ));
            }
        }
        for i in 0..=CHECKS {
            let nanometres = CHECKED[0] + (CHECKED[1] - CHECKED[0]) * f64::from(i) / f64::from(CHECKS);
            let index = self.index(ior, nanometres);
            if !(index > 0.0 && index <= MOST) {
                return fail(format!(
                    "the index of refraction at {nanometres:.0} nm is {index}, expected one above 0 and up to {MOST} from 360 to 830 nm"
                ));
            }
        }
        if let Some(own) = self.own_index()
            && (own - ior).abs() > 1e-4 * own
        {
            return fail(format!(
                "the formula has the index {own:.5} at the line d, 587.56 nm, and the material {ior}; expected the same"
            ));
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn known_media_have_their_index_and_abbe_number() {
        let known =
            [1.516_80, 1.784_72, 1.458_46, 1.333_36, 2.417_5].into_iter().zip([64.17, 25.68, 67.82, 55.8, 55.3]);
        for (glass, (index, abbe)) in GLASSES.iter().zip(known) {
            let own = glass.dispersion.own_index().unwrap();
            assert!((own - index).abs() < 5e-5, "{}: {own}", glass.name);
            let found = glass.dispersion.abbe(own);
            assert!((found / abbe - 1.0).abs() < 2e-3, "{}: {found}", glass.name);
            assert_eq!(Dispersion::by_name(glass.name), Some(glass.dispersion));
            glass.dispersion.check("", own).unwrap();
            assert!(glass.dispersion.check("", own + 0.01).is_err());
        }
        assert_eq!(Dispersion::by_name("glass"), None);
    }

    #[test]
    fn an_abbe_number_is_that_of_the_formula() {
        for (ior, number) in [(1.5, 60.0), (1.8, 25.0), (0.7, 40.0)] {
            let dispersion = Dispersion::Abbe(number);
            assert!((dispersion.abbe(ior) / f64::from(number) - 1.0).abs() < 1e-9);
            assert!((dispersion.index(ior, LINE_D) - ior).abs() < 1e-15);
            dispersion.check("", ior).unwrap();
        }
        for (dispersion, ior) in [
            (Dispersion::Abbe(0.0), 1.5),
            (Dispersion::Abbe(f32::NAN), 1.5),
            (Dispersion::Abbe(-3.0), 1.5),
            (Dispersion::Abbe(0.02), 1.5),
            (Dispersion::Sellmeier { strengths: [1.0, 0.0, 0.0, 0.0], resonances: [0.25, 0.0, 0.0, 0.0] }, 1.5),
            (Dispersion::Sellmeier { strengths: [f32::NAN; 4], resonances: [0.01; 4] }, 1.5),
        ] {
            assert!(dispersion.check("a", ior).is_err(), "{dispersion:?}");
        }
    }
}
