//! The complex index of a metal by the wavelength.

use super::complex::Complex;
use crate::math::Vec3;

/// The wavelengths \[nm\] that stand for red, green and blue.
const CHANNELS: [f64; 3] = [650.0, 550.0, 450.0];

/// The complex index n + ik at a wavelength \[nm\] of a metal whose index is known per channel: linear between the wavelengths that
/// stand for the channels, and constant beyond them. An infinite k makes it infinite up to the next channel.
pub fn complex_index_at(eta: Vec3, k: Vec3, nanometres: f64) -> Complex {
    let at = |channel: usize| Complex::new(eta[channel].into(), k[channel].into());
    let [red, green, blue] = CHANNELS;
    let (from, to) = if nanometres >= green { (1, 0) } else { (2, 1) };
    let share = match (nanometres - CHANNELS[from]) / (CHANNELS[to] - CHANNELS[from]) {
        _ if nanometres >= red => 1.0,
        _ if nanometres <= blue => 0.0,
        share => share,
    };
    if share == 0.0 {
        at(from)
    } else if share == 1.0 {
        at(to)
    } else {
        at(from) * (1.0 - share) + at(to) * share
    }
}
