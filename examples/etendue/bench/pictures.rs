//! Pictures of a report: the image, its error map, and the linear values.

use std::fs;
use std::io::Cursor;
use std::path::Path;

use etendue::film::Image;
use etendue::output::{self, WriteOptions};
use etendue::{Error, ErrorKind, Result};
use image::{ImageBuffer, Luma, Rgb};

/// The error that is black in an error map; `report.js` has the same numbers.
const LOWEST: f64 = 1e-6;
/// Decades from black to white.
const DECADES: f64 = 8.0;

/// Writes values in [0, 1] as sRGB; larger values are white.
pub fn write_picture(image: &Image, path: &Path) -> Result<()> {
    output::write(image, path, &WriteOptions::default())
}

/// Writes relative squared errors as grey, 1e-6 black and 1e2 white on a logarithmic scale.
pub fn write_error_map(errors: &[f32], [width, height]: [u32; 2], path: &Path) -> Result<()> {
    let grey = |&error: &f32| {
        let share = (f64::from(error) / LOWEST).log10() / DECADES;
        (255.0 * share.clamp(0.0, 1.0)).round() as u8
    };
    let picture = ImageBuffer::<Luma<u8>, _>::from_raw(width, height, errors.iter().map(grey).collect::<Vec<_>>());
    save(picture, path)
}

/// Writes linear values that a page can read back: mantissas of red, green and blue with a common exponent, and below
/// them, in red, that exponent + 128. To half a percent of the largest of the three; negative ones become zero.
pub fn write_linear(image: &Image, path: &Path) -> Result<()> {
    let mut mantissas = Vec::with_capacity(2 * image.rgb.len());
    let mut exponents = Vec::with_capacity(image.rgb.len());
    for pixel in image.rgb.chunks_exact(3) {
        let largest = pixel.iter().copied().fold(0.0_f32, f32::max).min(1e30);
        // The power of two above the largest value, so that mantissas are below 1.
        let exponent = if largest > 1e-30 { largest.log2().floor() as i32 + 1 } else { -127 };
        let scale = 256.0 * (-exponent as f32).exp2();
        mantissas.extend(pixel.iter().map(|value| (value * scale) as u8));
        exponents.extend([(exponent + 128) as u8, 0, 0]);
    }
    mantissas.append(&mut exponents);
    save(ImageBuffer::<Rgb<u8>, _>::from_raw(image.width, 2 * image.height, mantissas), path)
}

fn save<P>(picture: Option<ImageBuffer<P, Vec<u8>>>, path: &Path) -> Result<()>
where
    P: image::Pixel<Subpixel = u8> + image::PixelWithColorType,
{
    let fail = |reason: String| Error::new(ErrorKind::Io, reason).in_file(Some(path), 0);
    let picture = picture.ok_or_else(|| fail("the picture's values do not fit its size".to_owned()))?;
    let mut bytes = Cursor::new(Vec::new());
    let encoded = picture.write_to(&mut bytes, image::ImageFormat::Png);
    encoded.map_err(|error| fail(format!("cannot write the picture: {error}")))?;
    // A report that is read at the same time finds the old picture or the new one, never a part of one.
    let beside = path.with_extension("png.tmp");
    let written = fs::write(&beside, bytes.into_inner()).and_then(|()| fs::rename(&beside, path));
    written.map_err(|error| {
        let _ = fs::remove_file(&beside);
        Error::io(path, "cannot write the picture", error)
    })
}
