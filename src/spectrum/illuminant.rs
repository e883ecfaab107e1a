//! Illuminants of the CIE, and black bodies.
//!
//! Sources: CIE 015:2018 (daylight, illuminants A and E); CIE 15:2004, table T.6.1 (fluorescent lamps); Planck 1900; CODATA 2018.

use super::observer::between_rows;

/// Planck's first radiation constant for radiance, 2 h c^2 [W m^2 sr^-1], and the second, h c / k \[m K\] (CODATA 2018, exact).
const FIRST_RADIATION: f64 = 2.0 * 6.626_070_15e-34 * 299_792_458.0 * 299_792_458.0;
const SECOND_RADIATION: f64 = 6.626_070_15e-34 * 299_792_458.0 / 1.380_649e-23;

/// The components of daylight by 10 nm, from 300 nm on: S0, S1 and S2.
const DAYLIGHT: &[[u8; 12]] = include_bytes!("tables/daylight.f32").as_chunks().0;

/// Wavelengths \[nm\] of fluorescent lamps: the first, the distance of two, and how many there are.
const FLUORESCENT_FROM: f64 = 380.0;
const FLUORESCENT_STEP: f64 = 5.0;
const FLUORESCENT_COUNT: usize = 81;

/// Fluorescent lamps: relative power by wavelength, of FL1 to FL12.
const FLUORESCENT: &[[u8; 4 * FLUORESCENT_COUNT]] = include_bytes!("tables/fluorescent.f32").as_chunks().0;

/// The correlated colour temperatures \[K\] for which the formula of daylight is stated.
pub const DAYLIGHT_TEMPERATURES: [f64; 2] = [4000.0, 25_000.0];

/// The spectral radiance of a black body of this temperature \[K\] at this wavelength \[nm\], W m^-2 sr^-1 nm^-1.
///
/// Both must be > 0 and finite. Where the exponential would overflow, the radiance is 0.
pub fn black_body(temperature: f64, nanometres: f64) -> f64 {
    let metres = nanometres * 1e-9;
    let exponent = SECOND_RADIATION / (metres * temperature);
    // Per metre of wavelength, and then per nanometre.
    FIRST_RADIATION / metres.powi(5) / exponent.exp_m1() * 1e-9
}

/// The relative spectrum of a light source.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Illuminant {
    /// The same power at all wavelengths.
    E,
    /// Tungsten: a black body of 2856 K by the CIE's formula, with the radiation constant of 1931's temperature scale.
    A,
    /// A phase of daylight; see [`Illuminant::daylight`].
    Daylight {
        /// Weights of S1 and S2.
        weights: [f64; 2],
    },
    /// A fluorescent lamp; see [`Illuminant::fluorescent`].
    Fluorescent {
        /// 1 to 12, of FL1 to FL12.
        number: u8,
    },
    /// A black body.
    BlackBody {
        /// Temperature \[K\], > 0.
        temperature: f64,
    },
}

impl Illuminant {
    /// Daylight of a correlated colour temperature of about 6504 K.
    pub const D65: Self = Self::Daylight { weights: [-0.295, -0.689] };

    /// Daylight of a correlated colour temperature of about 5003 K.
    pub const D50: Self = Self::Daylight { weights: [-1.039, 0.363] };

    /// A phase of daylight by its correlated colour temperature \[K\]; `None` outside of [`DAYLIGHT_TEMPERATURES`].
    ///
    /// D50, D55, D65 and D75 have the temperatures 5000, 5500, 6500 and 7500 K times 1.4388 / 1.4380, since the temperature scale has
    /// changed after they were defined.
    ///
    /// Source: CIE 015:2018, Eq. 4.3 to 4.9, where the weights are rounded to three digits.
    pub fn daylight(temperature: f64) -> Option<Self> {
        let [low, high] = DAYLIGHT_TEMPERATURES;
        if !(low..=high).contains(&temperature) {
            return None;
        }
        let t = 1e3 / temperature;
        let x = if temperature <= 7000.0 {
            0.244_063 + t * (0.099_11 + t * (2.967_8 - t * 4.607_0))
        } else {
            0.237_040 + t * (0.247_48 + t * (1.901_8 - t * 2.006_4))
        };
        let y = -0.275 + x * (2.870 - x * 3.000);
        let below = 0.0241 + 0.2562 * x - 0.7341 * y;
        let rounded = |weight: f64| (weight * 1e3).round() / 1e3;
        let weights = [(-1.3515 - 1.7703 * x + 5.9114 * y) / below, (0.0300 - 31.4424 * x + 30.0717 * y) / below];
        Some(Self::Daylight { weights: weights.map(rounded) })
    }

    /// A fluorescent lamp by its number: FL1 to FL6 have a broad band, FL7 to FL9 several, and FL10 to FL12 three narrow ones; `None`
    /// for numbers that are not 1 to 12.
    ///
    /// Source: CIE 15:2004, table T.6.1, by 5 nm.
    pub fn fluorescent(number: u8) -> Option<Self> {
        (1..=FLUORESCENT.len()).contains(&usize::from(number)).then_some(Self::Fluorescent { number })
    }

    /// The spectrum at a wavelength \[nm\], relative to 100 at 560 nm, or as the CIE tabulates fluorescent lamps. Daylight is 0 outside
    /// of 300 to 830 nm and a fluorescent lamp outside of 380 to 780 nm, where they are not stated; other spectra are for any
    /// wavelength > 0.
    pub fn power(self, nanometres: f64) -> f64 {
        match self {
            Self::E => 100.0,
            Self::A => {
                let ratio = |nm: f64| (1.435e7 / (2848.0 * nm)).exp_m1();
                100.0 * (560.0 / nanometres).powi(5) * ratio(560.0) / ratio(nanometres)
            }
            Self::Daylight { weights: [first, second] } => {
                let s = between_rows(DAYLIGHT, (nanometres - 300.0) / 10.0);
                s.x + first * s.y + second * s.z
            }
            Self::Fluorescent { number } => {
                let row = usize::from(number).checked_sub(1).and_then(|lamp| FLUORESCENT.get(lamp));
                let last = (FLUORESCENT_COUNT - 1) as f64;
                let place = (nanometres - FLUORESCENT_FROM) / FLUORESCENT_STEP;
                let Some(row) = row.filter(|_| (0.0..=last).contains(&place)) else { return 0.0 };
                let powers = row.as_chunks::<4>().0;
                let lower = (place as usize).min(powers.len() - 2);
                let [before, after] = [lower, lower + 1].map(|i| f64::from(f32::from_le_bytes(powers[i])));
                before + (after - before) * (place - lower as f64)
            }
            Self::BlackBody { temperature } => {
                100.0 * black_body(temperature, nanometres) / black_body(temperature, 560.0)
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::tristimulus;
    use super::*;
    use std::f64::consts::PI;

    fn chromaticity(illuminant: Illuminant) -> [f64; 2] {
        let xyz = tristimulus(|nanometres| illuminant.power(nanometres));
        let sum = xyz.element_sum();
        [xyz.x / sum, xyz.y / sum]
    }

    /// CODATA 2018, computed to twelve digits.
    #[test]
    fn black_bodies_have_plancks_radiance() {
        let known = [
            (483.0, 6000.0, 3.184_796_580_34e13),
            (600.0, 6000.0, 2.867_639_137_77e13),
            (500.0, 3700.0, 1.598_366_918_97e12),
            (500.0, 5000.0, 1.210_719_059_04e13),
            (550.0, 2856.0, 2.490_187_998_88e11),
            (400.0, 1000.0, 2.781_672_580_2),
        ];
        for (nanometres, temperature, per_metre) in known {
            let radiance = black_body(temperature, nanometres) * 1e9;
            assert!((radiance / per_metre - 1.0).abs() < 1e-10, "{nanometres} {temperature}: {radiance}");
        }
        assert_eq!(black_body(10.0, 400.0), 0.0);
    }

    /// The integral over all wavelengths is sigma T^4 / pi, and the maximum lies at b / T.
    #[test]
    fn black_bodies_obey_stefan_boltzmann_and_wien() {
        for temperature in [300.0, 1000.0, 2856.0, 6504.0, 20_000.0] {
            // By the logarithm of the wavelength, in which the integrand is smooth and falls off at both ends.
            let steps = 4000;
            let log = |i: i32| (1e-2_f64.ln() + f64::from(i) / f64::from(steps) * (1e9_f64 / 1e-2).ln()).exp();
            let width = (1e9_f64 / 1e-2).ln() / f64::from(steps);
            let peak = 2.897_771_955_19e6 / temperature;
            let sum: f64 = (0..=steps).map(|i| black_body(temperature, peak * log(i)) * peak * log(i) * width).sum();
            let expected = 5.670_374_419_18e-8 * temperature.powi(4) / PI;
            assert!((sum / expected - 1.0).abs() < 1e-9, "{temperature}: {sum} for {expected}");
            let at = |factor: f64| black_body(temperature, peak * factor);
            assert!(at(1.0) > at(1.0 - 1e-5) && at(1.0) > at(1.0 + 1e-5), "{temperature}");
        }
    }

    /// Daylight by the temperature that it is named after.
    fn nominal(temperature: f64) -> Option<Illuminant> {
        Illuminant::daylight(temperature * 1.4388 / 1.4380)
    }

    /// CIE 015:2018, table 8.1.
    #[test]
    fn illuminants_have_their_chromaticities() {
        let known = [
            (Illuminant::A, [0.447_58, 0.407_45]),
            (Illuminant::D65, [0.312_72, 0.329_03]),
            (Illuminant::D50, [0.345_67, 0.358_51]),
            (nominal(5500.0).unwrap(), [0.332_43, 0.347_44]),
            (nominal(7500.0).unwrap(), [0.299_03, 0.314_88]),
            (Illuminant::E, [0.333_31, 0.333_29]),
        ];
        for (illuminant, expected) in known {
            let [x, y] = chromaticity(illuminant);
            assert!((x - expected[0]).abs() < 2e-5 && (y - expected[1]).abs() < 2e-5, "{illuminant:?}: {x} {y}");
        }
        assert_eq!(nominal(6500.0), Some(Illuminant::D65));
        assert_eq!(nominal(5000.0), Some(Illuminant::D50));
        for outside in [3999.0, 25_001.0, f64::NAN] {
            assert_eq!(Illuminant::daylight(outside), None);
        }
        // Values of D65 and A that the CIE tabulates.
        for (nanometres, d65, a) in [(380.0, 49.975_5, 9.795), (450.0, 117.008, 33.086), (700.0, 71.6091, 198.261)] {
            assert!((Illuminant::D65.power(nanometres) - d65).abs() < 2e-3, "{nanometres}");
            assert!((Illuminant::A.power(nanometres) - a).abs() < 1e-3, "{nanometres}");
        }
    }

    /// CIE 15:2004, table T.8.1, of sums by 5 nm. The table gives all lamps the same luminance.
    #[test]
    fn fluorescent_lamps_have_their_chromaticities() {
        let known = [
            [0.3131, 0.3371],
            [0.3721, 0.3751],
            [0.4091, 0.3941],
            [0.4402, 0.4031],
            [0.3138, 0.3452],
            [0.3779, 0.3882],
            [0.3129, 0.3292],
            [0.3458, 0.3586],
            [0.3741, 0.3727],
            [0.3458, 0.3588],
            [0.3805, 0.3769],
            [0.4370, 0.4042],
        ];
        for (number, expected) in (1..).zip(known) {
            let lamp = Illuminant::fluorescent(number).unwrap();
            let xyz = tristimulus(|nanometres| if nanometres % 5.0 == 0.0 { lamp.power(nanometres) } else { 0.0 });
            let [x, y] = [xyz.x, xyz.y].map(|value| value / xyz.element_sum());
            assert!((x - expected[0]).abs() < 6e-5 && (y - expected[1]).abs() < 6e-5, "FL{number}: {x} {y}");
            assert!((xyz.y / 292.83 - 1.0).abs() < 2e-4, "FL{number}: {}", xyz.y);
            // What is linear between them is wider than the lines of mercury are.
            let [x, y] = chromaticity(lamp);
            assert!((x - expected[0]).abs() < 3e-4 && (y - expected[1]).abs() < 3e-4, "FL{number}: {x} {y}");
            assert_eq!([379.9, 780.1, f64::NAN].map(|nanometres| lamp.power(nanometres)), [0.0; 3]);
        }
        assert_eq!([0, 13].map(Illuminant::fluorescent), [None; 2]);
        // Values that the CIE tabulates, and between them.
        for (number, nanometres, power) in [
            (2, 380.0, 1.18),
            (2, 435.0, 34.98),
            (7, 545.0, 29.52),
            (11, 610.0, 55.27),
            (11, 780.0, 0.09),
            (2, 436.0, 30.346),
        ] {
            let found = Illuminant::fluorescent(number).unwrap().power(nanometres);
            assert!((found - power).abs() < 1e-2, "FL{number} at {nanometres}: {found}");
        }
    }
}
