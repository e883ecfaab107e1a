//! Scene-linear colour: three channels with Rec. 709 primaries, and their luminance; spectra, and the colours that they have.

mod curve;
mod illuminant;
mod observer;
mod planckian;
mod primaries;
mod rgb;
mod sampled;
mod sensor;
mod transported;
mod upsample;

pub use curve::{Beyond, SpectralCurve};
pub use illuminant::{DAYLIGHT_TEMPERATURES, Illuminant, black_body};
pub use observer::{REC_709_FROM_XYZ, VISIBLE, XYZ_FROM_REC_709, color_matching, rec_709, tristimulus, white_balance};
pub use planckian::{BLACK_BODY_TEMPERATURES, black_body_color, black_body_luminance, black_body_temperature};
pub use primaries::Primaries;
pub use rgb::Rgb;
pub use sampled::{SampledSpectrum, SampledWavelengths};
pub use sensor::Sensor;
pub use transported::Spectrum;
pub use upsample::SmoothSpectrum;

/// Weights of the Rec. 709 channels in the CIE luminance (IEC 61966-2-1).
pub const LUMINANCE_WEIGHTS: Rgb = Rgb::new(0.2126, 0.7152, 0.0722);

/// Luminance of a linear colour, in the colour's own unit.
#[inline]
pub fn luminance(color: Rgb) -> f32 {
    color.dot(LUMINANCE_WEIGHTS)
}

/// The sRGB transfer curve (IEC 61966-2-1): linear value in [0, 1] to encoded value in [0, 1].
///
/// Values outside are clamped, NaN becomes 0.
pub fn srgb_encode(linear: f32) -> f32 {
    let linear = unit(linear);
    if linear <= 0.003_130_8 { 12.92 * linear } else { 1.055 * linear.powf(1.0 / 2.4) - 0.055 }
}

/// The inverse of [`srgb_encode`]; values outside [0, 1] are clamped.
pub fn srgb_decode(encoded: f32) -> f32 {
    let encoded = unit(encoded);
    if encoded <= 0.040_449_936 { encoded / 12.92 } else { ((encoded + 0.055) / 1.055).powf(2.4) }
}

/// Clamps to [0, 1]; NaN becomes 0.
#[expect(clippy::manual_clamp, reason = "clamp would keep NaN, which loses every comparison here")]
fn unit(x: f32) -> f32 {
    x.max(0.0).min(1.0)
}
