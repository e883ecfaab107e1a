//! Sums of Perlin's noise.

use std::sync::LazyLock;

use noise::{NoiseFn as _, Perlin};

use crate::math::DVec3;

/// One table of gradients for all scenes: a pattern is the same in every render.
static PERLIN: LazyLock<Perlin> = LazyLock::new(|| Perlin::new(0));

/// Perlin's gradient noise (2002), about -1 to 1, mean 0.
pub(super) fn perlin(p: DVec3) -> f64 {
    // The noise repeats itself after 256 units. Within them, places are whole numbers of a machine and a fraction, however large p was.
    let within = DVec3::from_array(p.to_array().map(|x| x.rem_euclid(256.0)));
    PERLIN.get(within.to_array())
}

/// Sum of octaves, each of twice the frequency and half the amplitude of the one before, divided by the sum of amplitudes.
pub(super) fn octaves(p: DVec3, count: u32, of: impl Fn(f64) -> f64) -> f64 {
    let (mut sum, mut amplitudes) = (0.0, 0.0);
    let (mut scale, mut amplitude) = (1.0, 1.0);
    for octave in 0..count {
        // Shifted, since the noise is 0 at all integers, in every octave.
        let shift = DVec3::splat(0.37 * f64::from(octave));
        sum += amplitude * of(perlin(p * scale + shift));
        amplitudes += amplitude;
        (scale, amplitude) = (2.0 * scale, 0.5 * amplitude);
    }
    sum / amplitudes
}
