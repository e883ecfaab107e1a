//! What light transport carries along a path.

use std::fmt::Debug;
use std::ops::{Add, AddAssign, Div, DivAssign, Mul, MulAssign, Sub};

use super::{Rgb, Sensor};
use crate::math::DVec3;

/// A radiance, a path weight or a photon's power in a fixed number of channels.
///
/// Integrators are written once over this trait. For [`Rgb`] all conversions are the identity and cost nothing. A type of
/// four sampled wavelengths says with [`Spectrum::Wavelengths`] which ones a path carries and with which densities they were
/// drawn; all channels of a path share its random decisions.
pub trait Spectrum:
    Copy
    + Debug
    + Default
    + PartialEq
    + Send
    + Sync
    + Add<Output = Self>
    + AddAssign
    + Sub<Output = Self>
    + Mul<Output = Self>
    + MulAssign
    + Mul<f32, Output = Self>
    + MulAssign<f32>
    + Div<f32, Output = Self>
    + DivAssign<f32>
    + 'static
{
    /// What the channels of one path stand for: nothing for RGB, wavelengths and their densities for a sampled spectrum.
    type Wavelengths: Copy + Debug + Default + PartialEq + Send + Sync + 'static;

    /// A value as photons store it, without alignment.
    type Packed: Copy + Debug + Default + PartialEq + Send + Sync + 'static;

    /// A value in double precision, for sums of many.
    type Wide: Copy + Debug + Default + Add<Output = Self::Wide> + AddAssign + Send + Sync + 'static;

    /// Whether a path goes on with its first wavelength alone; nothing for RGB.
    type Alone: Copy + Debug + Default + PartialEq + Send + Sync + 'static;

    /// Whether the channels are wavelengths, so that surfaces may refract each into a direction of its own.
    const HAS_WAVELENGTHS: bool;

    /// 0 in every channel.
    const ZERO: Self;
    /// 1 in every channel.
    const ONE: Self;

    /// The same value in every channel.
    fn splat(value: f32) -> Self;

    /// The largest channel.
    fn max_element(self) -> f32;

    /// 1 over each channel.
    #[must_use]
    fn recip(self) -> Self;

    /// Whether no channel is infinite or NaN.
    fn is_finite(self) -> bool;

    /// A function of each channel.
    #[must_use]
    fn map(self, f: impl Fn(f32) -> f32) -> Self;

    /// A function of each channel of two values.
    #[must_use]
    fn zip(self, other: Self, f: impl Fn(f32, f32) -> f32) -> Self;

    /// Chooses the wavelengths of a path. `u` gives a number uniform in [0, 1); RGB does not ask for one.
    fn sample_wavelengths(u: impl FnOnce() -> f32) -> Self::Wavelengths;

    /// As [`Spectrum::sample_wavelengths`], for a sensor; RGB has one sensor.
    #[inline(always)]
    fn sample_wavelengths_for(_sensor: Sensor, u: impl FnOnce() -> f32) -> Self::Wavelengths {
        Self::sample_wavelengths(u)
    }

    /// A reflectance in [0, 1] that has this colour.
    fn from_reflectance(color: Rgb, wavelengths: &Self::Wavelengths) -> Self;

    /// An emitted quantity of this colour: a radiance, an intensity or a power.
    fn from_emission(color: Rgb, wavelengths: &Self::Wavelengths) -> Self;

    /// An estimate of the colour that a sensor gets, which divides by the densities of the wavelengths.
    fn to_rgb(self, wavelengths: &Self::Wavelengths) -> Rgb;

    /// An estimate of the three channels of a film, as [`Spectrum::to_rgb`] for any sensor. The wavelengths were drawn for it.
    #[inline(always)]
    fn to_film(self, wavelengths: &Self::Wavelengths, _sensor: Sensor) -> Rgb {
        self.to_rgb(wavelengths)
    }

    /// As photons store it, whose path has its first wavelength alone if `alone` says so.
    fn pack(self, alone: Self::Alone) -> Self::Packed;

    /// What [`Spectrum::pack`] stored, as a factor on the weight of a path that has its first wavelength alone if `alone` says so:
    /// where both are alone, the wavelength stands for all of them once.
    fn unpack(packed: Self::Packed, alone: Self::Alone) -> Self;

    /// What [`Spectrum::pack`] stored times a factor >= 0.
    fn scale_packed(packed: Self::Packed, factor: f64) -> Self::Packed;

    /// In double precision.
    fn widen(self) -> Self::Wide;

    /// Rounded from double precision.
    fn narrow(wide: Self::Wide) -> Self;

    /// The values of a function of the wavelength \[nm\]; of `None` where channels have no wavelength.
    fn at_wavelengths(wavelengths: &Self::Wavelengths, f: impl Fn(Option<f32>) -> f32) -> Self;

    /// The wavelength \[nm\] that a path goes on with where surfaces tell wavelengths apart; `None` for RGB.
    fn first_wavelength(wavelengths: &Self::Wavelengths) -> Option<f32>;

    /// A path's weight where the path goes on with its first wavelength alone, which from then on stands for all of them: the others
    /// become 0. What `alone` says becomes true; a path that was alone before has the same weight.
    #[must_use]
    fn keep_first(self, alone: &mut Self::Alone) -> Self;
}

impl Spectrum for Rgb {
    type Wavelengths = ();
    type Packed = [f32; 3];
    type Wide = DVec3;
    type Alone = ();

    const HAS_WAVELENGTHS: bool = false;
    const ZERO: Self = Self::ZERO;
    const ONE: Self = Self::ONE;

    #[inline(always)]
    fn splat(value: f32) -> Self {
        Self::splat(value)
    }

    #[inline(always)]
    fn max_element(self) -> f32 {
        self.max_element()
    }

    #[inline(always)]
    fn recip(self) -> Self {
        Self::ONE / self
    }

    #[inline(always)]
    fn is_finite(self) -> bool {
        self.is_finite()
    }

    #[inline(always)]
    fn map(self, f: impl Fn(f32) -> f32) -> Self {
        Self::from_array(self.to_array().map(f))
    }

    #[inline(always)]
    fn zip(self, other: Self, f: impl Fn(f32, f32) -> f32) -> Self {
        let (a, b) = (self.to_array(), other.to_array());
        Self::from_array(std::array::from_fn(|i| f(a[i], b[i])))
    }

    #[inline(always)]
    fn sample_wavelengths(_u: impl FnOnce() -> f32) {}

    #[inline(always)]
    fn from_reflectance(color: Rgb, (): &()) -> Self {
        color
    }

    #[inline(always)]
    fn from_emission(color: Rgb, (): &()) -> Self {
        color
    }

    #[inline(always)]
    fn to_rgb(self, (): &()) -> Rgb {
        self
    }

    #[inline(always)]
    fn pack(self, (): ()) -> [f32; 3] {
        self.to_array()
    }

    #[inline(always)]
    fn unpack(packed: [f32; 3], (): ()) -> Self {
        Self::from_array(packed)
    }

    #[inline(always)]
    fn scale_packed(packed: [f32; 3], factor: f64) -> [f32; 3] {
        packed.map(|value| (f64::from(value) * factor) as f32)
    }

    #[inline(always)]
    fn widen(self) -> DVec3 {
        self.to_f64()
    }

    #[inline(always)]
    fn narrow(wide: DVec3) -> Self {
        Self::from_f64(wide)
    }

    #[inline(always)]
    fn at_wavelengths((): &(), f: impl Fn(Option<f32>) -> f32) -> Self {
        Self::splat(f(None))
    }

    #[inline(always)]
    fn first_wavelength((): &()) -> Option<f32> {
        None
    }

    #[inline(always)]
    fn keep_first(self, (): &mut ()) -> Self {
        self
    }
}
