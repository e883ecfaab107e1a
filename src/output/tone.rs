//! From scene-linear radiance to 8-bit sRGB.

use crate::film::Image;
use crate::rows::rows;
use crate::spectrum::srgb_encode;
use crate::{Error, ErrorKind, Result};

/// How radiance becomes display brightness, before the sRGB curve. Every operator works on each channel by itself and
/// never decreases.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum ToneMap {
    /// Divides by the largest finite channel value of the image, so that nothing is cut off; exposure acts after that.
    /// The report does this. One bright light darkens everything else, and two images are not on the same scale.
    Maximum,
    /// Radiance 1 is white, and so is everything above. Images of one exposure can be compared.
    #[default]
    Clamp,
    /// x / (1 + x): keeps all highlights apart, and lowers contrast. Reinhard et al. 2002, "Photographic Tone
    /// Reproduction for Digital Images", Eq. 3, here per channel and without their key value, which is the exposure.
    Reinhard,
    /// A film-like curve with a toe and a shoulder: x (2.51 x + 0.03) / (x (2.43 x + 0.59) + 0.14), clamped.
    /// Narkowicz's fit (2015, "ACES Filmic Tone Mapping Curve") to the luminance response of the ACES reference
    /// rendering for an sRGB display. It is a curve only: it does not do the ACES colour transforms, and white is
    /// reached near x = 7.
    Aces,
}

impl ToneMap {
    /// Display brightness in [0, 1] of a value that exposure and, for [`ToneMap::Maximum`], the image's maximum have
    /// been applied to already. Negative values and NaN give 0, positive infinity 1.
    pub fn curve(self, value: f64) -> f64 {
        if value.is_nan() || value <= 0.0 {
            return 0.0;
        }
        if value.is_infinite() {
            return 1.0;
        }
        let mapped = match self {
            Self::Maximum | Self::Clamp => value,
            Self::Reinhard => value / (1.0 + value),
            Self::Aces => value * (2.51 * value + 0.03) / (value * (2.43 * value + 0.59) + 0.14),
        };
        mapped.min(1.0)
    }

    /// What [`ToneMap::curve`] expects its values to be multiplied by.
    fn scale(self, image: &Image, exposure: f32) -> f64 {
        let gain = f64::from(exposure).exp2();
        match self {
            Self::Maximum => {
                let largest = image.rgb.iter().copied().filter(|value| value.is_finite()).fold(0.0_f32, f32::max);
                if largest > 0.0 { gain / f64::from(largest) } else { gain }
            }
            Self::Clamp | Self::Reinhard | Self::Aces => gain,
        }
    }
}

/// The image as a display shows it: `[height][width][3]` sRGB bytes, row 0 on top.
///
/// `exposure`: stops, in [-64, 64], a factor of 2^exposure before the tone map. Each value goes through the tone map
/// and the sRGB curve (IEC 61966-2-1) and is rounded to the nearest of 256 steps: 0, anything negative and NaN become
/// 0; 1 after the tone map and positive infinity become 255. Never decreases with the value.
///
/// Errors: [`ErrorKind::InvalidScene`] for an exposure out of its domain.
pub fn to_srgb8(image: &Image, tone_map: ToneMap, exposure: f32) -> Result<Vec<u8>> {
    to_srgb8_by(1, image, tone_map, exposure)
}

/// [`to_srgb8`] by at most so many threads.
pub(super) fn to_srgb8_by(threads: usize, image: &Image, tone_map: ToneMap, exposure: f32) -> Result<Vec<u8>> {
    check_exposure(exposure)?;
    let scale = tone_map.scale(image, exposure);
    let quantise = |&value: &f32| {
        let display = tone_map.curve(f64::from(value) * scale);
        (255.0 * srgb_encode(display as f32)).round() as u8
    };
    let parts: Vec<_> = image.rgb.chunks((3 * image.width as usize).max(1)).collect();
    let row = |y: u32| parts[y as usize].iter().map(quantise).collect::<Vec<u8>>();
    Ok(rows(parts.len() as u32, threads, row).concat())
}

/// Refuses an exposure out of its domain.
pub(super) fn check_exposure(exposure: f32) -> Result<()> {
    if (-64.0..=64.0).contains(&exposure) {
        return Ok(());
    }
    let message = format!("exposure is {exposure}, and must be within -64 and 64 stops");
    Err(Error::new(ErrorKind::InvalidScene, message))
}
