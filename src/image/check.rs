//! What is refused: images that no format can hold, and files that promise too much.

use std::collections::HashSet;

use super::pixels::{Image, Placement};
use crate::{Error, ErrorKind, Result};

/// Greatest number of pixels that [`read`](super::read) accepts: 2^28, which is 16384 x 16384.
///
/// A header is a promise of a few bytes about memory of gigabytes; this bounds what is believed.
pub const MAX_PIXELS: u64 = 1 << 28;

/// Refuses what no format can hold, so that the encoders may index freely.
pub(crate) fn check_image(image: &Image) -> Result<()> {
    let pixels = u64::from(image.width) * u64::from(image.height);
    if pixels == 0 {
        let message = format!("an image of {} x {} pixels cannot be written", image.width, image.height);
        return Err(Error::new(ErrorKind::Unsupported, message));
    }
    let broken = |what: &str, found: usize, expected: u64| {
        Error::new(ErrorKind::Internal, format!("{what} has {found} values where the image's size asks for {expected}"))
    };
    if image.rgb.len() as u64 != 3 * pixels {
        return Err(broken("the image", image.rgb.len(), 3 * pixels));
    }
    if let Some(Placement { origin, picture, pixel_aspect }) = image.placement {
        let size = [image.width, image.height];
        let is_inside = (0..2).all(|i| {
            picture[i] <= i32::MAX as u32 && u64::from(origin[i]) + u64::from(size[i]) <= u64::from(picture[i])
        });
        if !(is_inside && pixel_aspect > 0.0 && pixel_aspect.is_finite()) {
            let message = format!(
                "an image of {size:?} pixels at {origin:?}, whose pixels have the aspect {pixel_aspect}, is not inside a \
                 picture of {picture:?}"
            );
            return Err(Error::new(ErrorKind::Internal, message));
        }
    }
    let mut names = HashSet::new();
    for layer in &image.layers {
        if !matches!(layer.channels, 1 | 3 | 4) || layer.name.is_empty() || layer.name.len() > 200 {
            let message =
                format!("layer '{}' needs a short name and 1, 3 or 4 channels, not {}", layer.name, layer.channels);
            return Err(Error::new(ErrorKind::Internal, message));
        }
        if !names.insert(&layer.name) {
            return Err(Error::new(ErrorKind::Internal, format!("two layers are named '{}'", layer.name)));
        }
        let expected = layer.channels as u64 * pixels;
        if layer.data.len() as u64 != expected {
            return Err(broken(&format!("layer '{}'", layer.name), layer.data.len(), expected));
        }
    }
    Ok(())
}

/// Refuses sizes read from a file that are empty or beyond [`MAX_PIXELS`].
pub(crate) fn check_size(width: u64, height: u64) -> Result<(u32, u32)> {
    let too_large = || {
        let message = format!("{width} x {height} pixels are more than the {MAX_PIXELS} that are read");
        Error::new(ErrorKind::Unsupported, message)
    };
    if width == 0 || height == 0 {
        return Err(damaged(format!("its size is {width} x {height} pixels")));
    }
    if width.checked_mul(height).is_none_or(|pixels| pixels > MAX_PIXELS) {
        return Err(too_large());
    }
    let convert = |length: u64| u32::try_from(length).map_err(|_| too_large());
    Ok((convert(width)?, convert(height)?))
}

/// A file that is not what its extension says, or not all of it.
pub(super) fn damaged(reason: impl std::fmt::Display) -> Error {
    Error::new(ErrorKind::Io, format!("not a readable image: {reason}"))
}
