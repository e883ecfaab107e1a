//! Radiance at four wavelengths.
//!
//! A path carries four wavelengths that are a quarter of the distribution apart, so that together they are stratified. They are drawn
//! nearly in proportion to what the standard observer sees of D65, or evenly from the bands of a sensor. All four share the path's
//! random decisions, none of which depends on one wavelength alone, so that their mean is an estimate without further weights. Surfaces
//! that refract each wavelength into another direction are the exception: there the first one decides, what is reflected has its share
//! of each, and what is refracted goes on with the first one alone ([`Spectrum::keep_first`]).
//!
//! Sources: Wilkie et al. 2014, "Hero Wavelength Spectral Sampling"; Pharr, Jakob and Humphreys 2023, "Physically Based Rendering",
//! Sec. 4.5.4 (secondary wavelengths that end).

use std::ops::{Add, AddAssign, Div, DivAssign, Mul, MulAssign, Sub, SubAssign};
use std::sync::LazyLock;

use super::illuminant::Illuminant;
use super::observer::{REC_709_FROM_XYZ, VISIBLE, color_matching, tristimulus};
use super::transported::Spectrum;
use super::upsample::normalised;
use super::{Rgb, Sensor, SmoothSpectrum};
use crate::math::{DVec4, Vec4};

/// Number of wavelengths that a path carries.
pub const WAVELENGTHS: usize = 4;

/// Number of bands of [`Sensor::Bands`], as many as a film has channels.
const BANDS: usize = 3;

/// A radiance [W m^-2 sr^-1 nm^-1], a path weight or a photon's power per nm at the [`SampledWavelengths`] of a path.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[repr(transparent)]
pub struct SampledSpectrum(Vec4);

/// The wavelengths of a path.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SampledWavelengths {
    /// Wavelengths \[nm\].
    pub nanometres: Vec4,
    /// Their densities [nm^-1].
    pub pdf: Vec4,
    /// The spectrum of D65 of luminance 1 [W m^-2 sr^-1 nm^-1], see [`SampledSpectrum::from_emission`].
    white: Vec4,
}

impl SampledSpectrum {
    /// The values at the four wavelengths.
    pub const fn from_array(values: [f32; WAVELENGTHS]) -> Self {
        Self(Vec4::from_array(values))
    }

    /// The values at the four wavelengths.
    pub const fn to_array(self) -> [f32; WAVELENGTHS] {
        self.0.to_array()
    }
}

/// Number of parts of equal probability between [`Observer::quantiles`].
const QUANTILES: usize = 512;

/// What the standard observer gets from each wavelength, and how wavelengths are drawn for it.
struct Observer {
    /// By 1 nm from 360 nm on: linear Rec. 709 of a radiance of 1 W m^-2 sr^-1 nm^-1, per nm, and the spectrum of white.
    response: Vec<[f32; 4]>,
    /// The wavelengths \[nm\] below which the parts of equal probability lie. Within a part, all wavelengths are as probable.
    quantiles: [f32; QUANTILES + 1],
}

static OBSERVER: LazyLock<Observer> = LazyLock::new(Observer::new);

impl Observer {
    fn new() -> Self {
        let [low, high] = VISIBLE;
        let count = (high - low) as usize + 1;
        let d65 = |nanometres: f64| Illuminant::D65.power(nanometres);
        let luminance = tristimulus(d65).y;
        let response = (0..count).map(|i| {
            let nanometres = low + i as f64;
            let rgb = *REC_709_FROM_XYZ * color_matching(nanometres);
            rgb.extend(d65(nanometres) / luminance).as_vec4().to_array()
        });
        // What the sensor gets of white in all three channels, smoothed: wavelengths a quarter apart integrate smooth weights well, so
        // that this has a quarter of the noise in luminance that the weights themselves would leave. A share for all wavelengths
        // bounds the weights of spectra that are nothing like white.
        const WIDTH: f64 = 20.0;
        const EVEN: f64 = 0.005;
        let seen: Vec<f64> = (0..count)
            .map(|i| {
                let nanometres = low + i as f64;
                (*REC_709_FROM_XYZ * color_matching(nanometres)).length() * d65(nanometres)
            })
            .collect();
        let smoothed = |i: usize| -> f64 {
            let near = |(other, seen): (usize, &f64)| {
                let distance = (other as f64 - i as f64) / WIDTH;
                seen * (-0.5 * distance * distance).exp()
            };
            seen.iter().enumerate().map(near).sum()
        };
        let sum: f64 = (0..count).map(smoothed).sum();
        let density = |i: usize| (1.0 - EVEN) * smoothed(i) / sum + EVEN / (high - low);
        let mut cumulative = vec![0.0];
        for i in 1..count {
            cumulative.push(cumulative[i - 1] + 0.5 * (density(i - 1) + density(i)));
        }
        let total = cumulative[count - 1];
        let quantile = |number: usize| {
            let wanted = total * number as f64 / QUANTILES as f64;
            let above = cumulative.partition_point(|sum| *sum <= wanted).clamp(1, count - 1);
            let (before, after) = (cumulative[above - 1], cumulative[above]);
            (low + (above - 1) as f64 + (wanted - before) / (after - before)) as f32
        };
        Self { response: response.collect(), quantiles: std::array::from_fn(quantile) }
    }

    /// The response at a wavelength \[nm\], linear between those of whole nanometres.
    #[inline]
    fn at(&self, nanometres: f32) -> Vec4 {
        let place = (nanometres - VISIBLE[0] as f32).max(0.0);
        let lower = (place as usize).min(self.response.len() - 2);
        let [before, after] = [lower, lower + 1].map(|i| Vec4::from_array(self.response[i]));
        before.lerp(after, place - lower as f32)
    }

    /// The wavelength \[nm\] of a number in [0, 1), and its density [nm^-1].
    #[inline]
    fn sample(&self, u: f32) -> (f32, f32) {
        let place = u * QUANTILES as f32;
        let part = (place as usize).min(QUANTILES - 1);
        let (from, to) = (self.quantiles[part], self.quantiles[part + 1]);
        (from + (place - part as f32) * (to - from), 1.0 / (QUANTILES as f32 * (to - from)))
    }
}

macro_rules! operators {
    ($($op:ident $f:ident $assign:ident $g:ident;)*) => {$(
        impl $op for SampledSpectrum {
            type Output = Self;
            #[inline(always)]
            fn $f(self, right: Self) -> Self {
                Self($op::$f(self.0, right.0))
            }
        }

        impl $op<f32> for SampledSpectrum {
            type Output = Self;
            #[inline(always)]
            fn $f(self, right: f32) -> Self {
                Self($op::$f(self.0, right))
            }
        }

        impl $assign for SampledSpectrum {
            #[inline(always)]
            fn $g(&mut self, right: Self) {
                self.0.$g(right.0);
            }
        }

        impl $assign<f32> for SampledSpectrum {
            #[inline(always)]
            fn $g(&mut self, right: f32) {
                self.0.$g(right);
            }
        }
    )*};
}

operators! {
    Add add AddAssign add_assign;
    Sub sub SubAssign sub_assign;
    Mul mul MulAssign mul_assign;
    Div div DivAssign div_assign;
}

impl Spectrum for SampledSpectrum {
    type Wavelengths = SampledWavelengths;
    type Packed = [f32; 4];
    type Wide = DVec4;
    type Alone = bool;

    const ZERO: Self = Self(Vec4::ZERO);
    const ONE: Self = Self(Vec4::ONE);
    const HAS_WAVELENGTHS: bool = true;

    #[inline(always)]
    fn splat(value: f32) -> Self {
        Self(Vec4::splat(value))
    }

    #[inline(always)]
    fn max_element(self) -> f32 {
        self.0.max_element()
    }

    #[inline(always)]
    fn recip(self) -> Self {
        Self(self.0.recip())
    }

    #[inline(always)]
    fn is_finite(self) -> bool {
        self.0.is_finite()
    }

    #[inline]
    fn map(self, f: impl Fn(f32) -> f32) -> Self {
        Self::from_array(self.to_array().map(f))
    }

    #[inline]
    fn zip(self, other: Self, f: impl Fn(f32, f32) -> f32) -> Self {
        let (a, b) = (self.to_array(), other.to_array());
        Self::from_array(std::array::from_fn(|i| f(a[i], b[i])))
    }

    #[inline]
    fn sample_wavelengths(u: impl FnOnce() -> f32) -> SampledWavelengths {
        let observer = &*OBSERVER;
        SampledWavelengths::draw(observer, u(), |u| observer.sample(u))
    }

    #[inline]
    fn sample_wavelengths_for(sensor: Sensor, u: impl FnOnce() -> f32) -> SampledWavelengths {
        match sensor {
            Sensor::Observer => Self::sample_wavelengths(u),
            Sensor::Bands { range } => SampledWavelengths::of_bands(range, u()),
        }
    }

    /// A smooth spectrum ([`SmoothSpectrum`]), which is constant for greys.
    #[inline]
    fn from_reflectance(color: Rgb, wavelengths: &SampledWavelengths) -> Self {
        let [r, g, b] = color.to_array();
        if r == g && g == b {
            return Self::splat(r);
        }
        if !color.is_finite() {
            return Self::splat(color.element_sum());
        }
        // Weights of more than 1 are those of a smooth spectrum too.
        let most = color.max_element();
        if most > 1.0 {
            return Self::smooth(color * (1.0 / most), wavelengths) * most;
        }
        Self::smooth(color, wavelengths)
    }

    /// A smooth spectrum times that of D65, so that a light of the colour (1, 1, 1) is D65 of luminance 1.
    #[inline]
    fn from_emission(color: Rgb, wavelengths: &SampledWavelengths) -> Self {
        let [r, g, b] = color.to_array();
        if r == g && g == b {
            return Self(wavelengths.white * r);
        }
        // Half of the largest reflectance leaves the most freedom for a smooth spectrum.
        let scale = 2.0 * color.max_element();
        if scale <= 0.0 || !scale.is_finite() {
            return Self(wavelengths.white * scale);
        }
        Self(Self::smooth(color * (1.0 / scale), wavelengths).0 * wavelengths.white * scale)
    }

    #[inline]
    fn to_rgb(self, wavelengths: &SampledWavelengths) -> Rgb {
        let observer = &*OBSERVER;
        let mut sum = Vec4::ZERO;
        let weights = self.0 / (wavelengths.pdf * WAVELENGTHS as f32);
        for i in 0..WAVELENGTHS {
            sum += observer.at(wavelengths.nanometres[i]) * weights[i];
        }
        Rgb::new(sum.x, sum.y, sum.z)
    }

    #[inline]
    fn to_film(self, wavelengths: &SampledWavelengths, sensor: Sensor) -> Rgb {
        match sensor {
            Sensor::Observer => self.to_rgb(wavelengths),
            Sensor::Bands { range } => self.to_bands(wavelengths, range),
        }
    }

    /// Powers are not negative: the sign of the second value says that the first wavelength is alone.
    #[inline]
    fn pack(self, alone: bool) -> [f32; 4] {
        let mut packed = self.to_array();
        if alone {
            packed[1] = -1.0;
        }
        packed
    }

    #[inline]
    fn unpack(packed: [f32; 4], alone: bool) -> Self {
        if packed[1] >= 0.0 {
            return Self::from_array(packed);
        }
        let factor = if alone { 1.0 / WAVELENGTHS as f32 } else { 1.0 };
        Self::from_array([packed[0] * factor, 0.0, 0.0, 0.0])
    }

    #[inline]
    fn scale_packed(packed: [f32; 4], factor: f64) -> [f32; 4] {
        let scaled = packed.map(|value| (f64::from(value) * factor) as f32);
        [scaled[0], if packed[1] < 0.0 { packed[1] } else { scaled[1] }, scaled[2], scaled[3]]
    }

    #[inline(always)]
    fn widen(self) -> DVec4 {
        self.0.as_dvec4()
    }

    #[inline(always)]
    fn narrow(wide: DVec4) -> Self {
        Self(wide.as_vec4())
    }

    #[inline]
    fn at_wavelengths(wavelengths: &SampledWavelengths, f: impl Fn(Option<f32>) -> f32) -> Self {
        Self(Vec4::from_array(wavelengths.nanometres.to_array().map(|nanometres| f(Some(nanometres)))))
    }

    #[inline]
    fn first_wavelength(wavelengths: &SampledWavelengths) -> Option<f32> {
        Some(wavelengths.nanometres.x)
    }

    #[inline]
    fn keep_first(self, alone: &mut bool) -> Self {
        let factor = if *alone { 1.0 } else { WAVELENGTHS as f32 };
        *alone = true;
        Self(Vec4::new(self.0.x * factor, 0.0, 0.0, 0.0))
    }
}

impl SampledWavelengths {
    /// Wavelengths a quarter of the distribution apart: `sample` makes a number in [0, 1) a wavelength \[nm\] and its density [nm^-1].
    #[inline(always)]
    fn draw(observer: &Observer, u: f32, sample: impl Fn(f32) -> (f32, f32)) -> Self {
        let mut wavelengths = Self::default();
        for i in 0..WAVELENGTHS {
            let turned = u + i as f32 / WAVELENGTHS as f32;
            let (nanometres, pdf) = sample(if turned < 1.0 { turned } else { turned - 1.0 });
            wavelengths.nanometres[i] = nanometres;
            wavelengths.pdf[i] = pdf;
            wavelengths.white[i] = observer.at(nanometres).w;
        }
        wavelengths
    }

    /// Wavelengths of a path for a sensor of bands: all are as probable.
    #[inline(never)]
    fn of_bands(range: [f64; 2], u: f32) -> Self {
        let [first, last] = range.map(|nanometres| nanometres as f32);
        let width = last - first;
        Self::draw(&OBSERVER, u, |u| (first + u * width, 1.0 / width))
    }
}

impl SampledSpectrum {
    /// An estimate of the means over bands.
    ///
    /// This and what draws the wavelengths are calls, so that the code of the usual sensor stays as it is.
    #[inline(never)]
    fn to_bands(self, wavelengths: &SampledWavelengths, range: [f64; 2]) -> Rgb {
        let [first, last] = range.map(|nanometres| nanometres as f32);
        let per_width = BANDS as f32 / (last - first);
        let means = self.0 * (per_width / WAVELENGTHS as f32) / wavelengths.pdf;
        let mut sums = [0.0; BANDS];
        for i in 0..WAVELENGTHS {
            let band = ((wavelengths.nanometres[i] - first) * per_width) as usize;
            sums[band.min(BANDS - 1)] += means[i];
        }
        Rgb::from_array(sums)
    }

    #[inline]
    fn smooth(color: Rgb, wavelengths: &SampledWavelengths) -> Self {
        Self(SmoothSpectrum::of_color(color).at_normalised(normalised(wavelengths.nanometres)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::DVec3;
    use crate::spectrum::rec_709;

    /// Each wavelength is as probable as its density says, and the mean over a grid of numbers is the integral.
    #[test]
    fn the_mean_over_wavelengths_is_the_colour_of_a_spectrum() {
        const N: u32 = 1 << 14;
        let draws = || (0..N).map(|i| SampledSpectrum::sample_wavelengths(|| (i as f32 + 0.5) / N as f32));
        let mean = |spectrum: &dyn Fn(f64) -> f64| {
            let color = |wavelengths: SampledWavelengths| {
                let at = |nanometres: Option<f32>| spectrum(f64::from(nanometres.unwrap_or(0.0))) as f32;
                SampledSpectrum::at_wavelengths(&wavelengths, at).to_rgb(&wavelengths).to_f64()
            };
            draws().map(color).sum::<DVec3>() / f64::from(N)
        };
        let spectra: [&dyn Fn(f64) -> f64; 4] = [
            &|_| 1.0,
            &|nanometres| Illuminant::A.power(nanometres),
            &|nanometres| (-((nanometres - 610.0) / 10.0).powi(2)).exp(),
            &|nanometres| (-((nanometres - 440.0) / 30.0).powi(2)).exp(),
        ];
        for (number, spectrum) in spectra.into_iter().enumerate() {
            let (mean, expected) = (mean(spectrum), rec_709(spectrum));
            let error = (mean - expected).abs().max_element() / expected.max_element();
            assert!(error < 1e-4, "{number}: {mean} for {expected}");
        }
        let lengths: f64 = draws().map(|draw| f64::from((1.0 / draw.pdf).element_sum())).sum();
        let length = lengths / f64::from(N * WAVELENGTHS as u32);
        assert!((length / (VISIBLE[1] - VISIBLE[0]) - 1.0).abs() < 1e-4, "{length}");
    }

    /// Colours of reflectances under white, and of lights, are those that they were made from.
    #[test]
    fn colours_come_back() {
        const N: u32 = 1 << 12;
        let colors = [[1.0; 3], [0.3; 3], [0.7, 0.2, 0.1], [0.05, 0.3, 0.4], [0.2, 0.25, 0.02], [0.6, 0.5, 0.55]];
        for color in colors.map(Rgb::from_array) {
            let (mut reflected, mut emitted) = (DVec3::ZERO, DVec3::ZERO);
            for i in 0..N {
                let wavelengths = SampledSpectrum::sample_wavelengths(|| (i as f32 + 0.5) / N as f32);
                let white = SampledSpectrum::from_emission(Rgb::ONE, &wavelengths);
                let reflectance = SampledSpectrum::from_reflectance(color, &wavelengths);
                reflected += (reflectance * white).to_rgb(&wavelengths).to_f64() / f64::from(N);
                let light = SampledSpectrum::from_emission(color * 20.0, &wavelengths);
                emitted += light.to_rgb(&wavelengths).to_f64() / f64::from(20 * N);
            }
            for (name, found) in [("reflected", reflected), ("emitted", emitted)] {
                let error = (found - color.to_f64()).abs().max_element();
                assert!(error < 1e-3, "{name}: {found} for {color:?}");
            }
        }
        let wavelengths = SampledSpectrum::sample_wavelengths(|| 0.3);
        let light = |color| SampledSpectrum::from_emission(color, &wavelengths);
        assert_eq!(light(Rgb::ZERO), SampledSpectrum::ZERO);
        assert!(!light(Rgb::new(f32::INFINITY, 1.0, 0.0)).is_finite());
    }

    /// The mean over each band, of wavelengths that are all inside of the bands.
    #[test]
    fn bands_have_the_mean_of_a_spectrum() {
        const N: u32 = 3 << 12;
        let range = [412.5, 487.5];
        let sensor = Sensor::Bands { range };
        let spectrum = |nanometres: f64| 2.0 + ((nanometres - 400.0) / 20.0).sin();
        let mut sum = DVec3::ZERO;
        for i in 0..N {
            let wavelengths = SampledSpectrum::sample_wavelengths_for(sensor, || (i as f32 + 0.5) / N as f32);
            assert!(wavelengths.nanometres.to_array().iter().all(|nm| (range[0]..=range[1]).contains(&f64::from(*nm))));
            let at = |nanometres: Option<f32>| spectrum(f64::from(nanometres.unwrap_or(0.0))) as f32;
            let light = SampledSpectrum::at_wavelengths(&wavelengths, at);
            sum += light.to_film(&wavelengths, sensor).to_f64();
            assert!(light.to_film(&wavelengths, Sensor::Observer) == light.to_rgb(&wavelengths));
        }
        for band in 0..BANDS {
            let from = range[0] + 25.0 * band as f64;
            let expected: f64 = (0..1000).map(|i| spectrum(from + (f64::from(i) + 0.5) / 40.0) / 1000.0).sum();
            let found = sum[band] / f64::from(N);
            assert!((found / expected - 1.0).abs() < 1e-3, "{band}: {found} for {expected}");
        }
    }

    #[test]
    fn the_first_wavelength_stands_for_all_of_them_once() {
        let mut alone = false;
        let four = SampledSpectrum::from_array([1.0, 2.0, 3.0, 4.0]);
        let one = four.keep_first(&mut alone);
        assert_eq!((one.to_array(), alone), ([4.0, 0.0, 0.0, 0.0], true));
        assert_eq!(one.keep_first(&mut alone), one);
    }
}
