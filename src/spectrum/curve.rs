//! A function of the wavelength by a table.

use super::observer::{VISIBLE, rec_709, tristimulus};
use crate::math::DVec3;
use crate::spectrum::Illuminant;

/// Number of values: one for each nanometre of [`VISIBLE`].
const COUNT: usize = (VISIBLE[1] - VISIBLE[0]) as usize + 1;

/// What a function is beyond its first and its last sample.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Beyond {
    /// 0, as of light.
    Zero,
    /// What it is at the nearest sample, as of reflectances and indices of refraction.
    Ends,
}

/// A function of the wavelength over [`VISIBLE`], by whole nanometres and linear in between.
#[derive(Clone, Debug, PartialEq)]
pub struct SpectralCurve {
    values: Box<[f32]>,
}

impl SpectralCurve {
    /// The values of a function of the wavelength \[nm\].
    pub fn of(function: impl Fn(f64) -> f64) -> Self {
        Self { values: (0..COUNT).map(|i| function(VISIBLE[0] + i as f64) as f32).collect() }
    }

    /// The function that is linear between samples of wavelength \[nm\] and value, which are in order of strictly growing wavelengths;
    /// 0 without samples.
    ///
    /// Where samples are closer than a nanometre, each value is the mean over the nanometre around it, so that the integral of narrow
    /// lines is kept.
    pub fn of_samples(samples: &[[f64; 2]], beyond: Beyond) -> Self {
        let Some((first, last)) = samples.first().zip(samples.last()) else { return Self::of(|_| 0.0) };
        let above =
            |nanometres: f64| samples.partition_point(|[at, _]| *at <= nanometres).clamp(1, (samples.len() - 1).max(1));
        if samples.windows(2).all(|pair| pair[1][0] - pair[0][0] >= 1.0) {
            let edge = |value: f64| if beyond == Beyond::Ends { value } else { 0.0 };
            return Self::of(|nanometres| match nanometres {
                _ if nanometres < first[0] => edge(first[1]),
                _ if nanometres > last[0] => edge(last[1]),
                _ if samples.len() == 1 => first[1],
                _ => {
                    let above = above(nanometres);
                    let ([from, before], [to, after]) = (samples[above - 1], samples[above]);
                    before + (after - before) * (nanometres - from) / (to - from)
                }
            });
        }
        // The integral from the first sample up to each of them.
        let mut sums = Vec::with_capacity(samples.len());
        let mut sum = 0.0;
        sums.push(sum);
        for pair in samples.windows(2) {
            sum += 0.5 * (pair[0][1] + pair[1][1]) * (pair[1][0] - pair[0][0]);
            sums.push(sum);
        }
        let outside = |distance: f64, value: f64| if beyond == Beyond::Ends { distance * value } else { 0.0 };
        let integral = |nanometres: f64| {
            if nanometres <= first[0] {
                return outside(nanometres - first[0], first[1]);
            }
            if nanometres >= last[0] {
                return sum + outside(nanometres - last[0], last[1]);
            }
            let above = above(nanometres);
            let ([from, before], [to, after]) = (samples[above - 1], samples[above]);
            let way = nanometres - from;
            sums[above - 1] + way * (before + 0.5 * (after - before) * way / (to - from))
        };
        Self::of(|nanometres| (integral(nanometres + 0.5) - integral(nanometres - 0.5)).max(0.0))
    }

    /// The value at a wavelength \[nm\]; outside of [`VISIBLE`] that of the nearest end.
    #[inline]
    pub fn at(&self, nanometres: f32) -> f32 {
        const LAST: f32 = (COUNT - 1) as f32;
        let place = (nanometres - VISIBLE[0] as f32).clamp(0.0, LAST);
        let lower = (place as usize).min(COUNT - 2);
        let (before, after) = (self.values[lower], self.values[lower + 1]);
        before + (after - before) * (place - lower as f32)
    }

    /// The values by whole nanometres.
    pub fn values(&self) -> &[f32] {
        &self.values
    }

    /// The same function times a factor.
    #[must_use]
    pub fn times(&self, factor: f64) -> Self {
        Self { values: self.values.iter().map(|value| (f64::from(*value) * factor) as f32).collect() }
    }

    /// The linear Rec. 709 of light of this spectrum; channels are negative outside of the triangle of the primaries.
    pub fn light_color(&self) -> DVec3 {
        rec_709(|nanometres| f64::from(self.at(nanometres as f32)))
    }

    /// The luminous integral of light of this spectrum, in the spectrum's unit times nm: its luminance over 683 lm/W.
    pub fn luminance(&self) -> f64 {
        tristimulus(|nanometres| f64::from(self.at(nanometres as f32))).y
    }

    /// The linear Rec. 709 of a surface with this reflectance under illuminant D65, where white is (1, 1, 1).
    pub fn reflected_color(&self) -> DVec3 {
        let d65 = |nanometres: f64| Illuminant::D65.power(nanometres);
        rec_709(|nanometres| d65(nanometres) * f64::from(self.at(nanometres as f32))) / tristimulus(d65).y
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn samples_keep_their_integral_and_their_values() {
        let straight = SpectralCurve::of_samples(&[[300.0, 0.1], [900.0, 0.7]], Beyond::Zero);
        for nanometres in [360.0_f32, 412.3, 829.9] {
            let expected = 0.1 + (nanometres - 300.0) / 1000.0;
            assert!((straight.at(nanometres) - expected).abs() < 1e-6, "{nanometres}");
        }
        // A line of 0.02 nm that falls between two whole nanometres, and one right on the edge of their halves.
        for centre in [543.37, 543.5, 543.0] {
            let line = [[centre - 0.01, 0.0], [centre, 100.0], [centre + 0.01, 0.0]];
            let sum: f32 = SpectralCurve::of_samples(&line, Beyond::Zero).values().iter().sum();
            assert!((sum - 1.0).abs() < 1e-6, "{centre}: {sum}");
        }
        for (beyond, expected) in [(Beyond::Zero, [0.0, 0.0]), (Beyond::Ends, [0.2, 0.6])] {
            let part = SpectralCurve::of_samples(&[[500.0, 0.2], [600.0, 0.6]], beyond);
            assert!((part.at(550.0) - 0.4).abs() < 1e-6);
            assert_eq!([part.at(400.0), part.at(700.0)].map(|it| (it * 1e5).round() / 1e5), expected, "{beyond:?}");
        }
        assert!(SpectralCurve::of_samples(&[], Beyond::Ends).values().iter().all(|value| *value == 0.0));
        let one = SpectralCurve::of_samples(&[[500.0, 0.3]], Beyond::Ends);
        assert!(one.values().iter().all(|value| (value - 0.3).abs() < 1e-6));
        assert!(straight.at(f32::NAN).is_nan());
    }

    #[test]
    fn colours_are_those_of_light_and_of_reflectances() {
        let white = SpectralCurve::of(|nanometres| Illuminant::D65.power(nanometres));
        let luminance = white.luminance();
        assert!((white.times(1.0 / luminance).light_color() - DVec3::ONE).abs().max_element() < 1e-5);
        let grey = SpectralCurve::of(|_| 0.25);
        assert!((grey.reflected_color() - DVec3::splat(0.25)).abs().max_element() < 1e-7);
    }
}
