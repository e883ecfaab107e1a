//! What a film has: its image in the host's memory or in a file, and the summary of its render.

use std::ffi::c_char;
use std::path::Path;

use super::boundary::{need, on, optional_text, read_sized, text, write_sized};
use super::film::etd_film;
use super::read;
use super::status::{Failure, Result, etd_status};
use super::types::*;
use crate::film::Image;
use crate::output::{self, ToneMap, WriteOptions};
use crate::spectrum::Primaries;

/// Copies a layer of the newest image to the host's memory.
///
/// `layer`: one `etd_layer` that the film keeps. `options`: format, tone map, exposure and order of rows; NULL for floats with
/// the top row first. `pixels`: receives the image, `size` bytes. `row_stride`: bytes from one row to the next; 0 for rows
/// without gaps. Errors: `ETD_INVALID_ARGUMENT` for a stride smaller than a row, a size smaller than the image, floats that are
/// not aligned, or a format that the layer does not have. Thread-safe.
///
/// # Safety
/// `size` bytes must be writable at `pixels`; other pointers must be NULL or point to values of their types.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn etd_film_copy(
    film: *const etd_film,
    layer: EtdLayer,
    options: *const etd_image_options,
    pixels: *mut std::ffi::c_void,
    size: usize,
    row_stride: usize,
) -> etd_status {
    // SAFETY: the caller keeps this function's contract.
    unsafe {
        on(film, |film| {
            need(pixels.cast::<u8>(), "pixels")?;
            let it = read_image_options(options)?;
            let frame = film.newest()?;
            let (data, channels) = film.layer(&frame, layer)?;
            let is_color = layer == ETD_LAYER_COLOR as u32;
            let [width, height] = frame.resolution().map(|n| n as usize);
            let (values, value_size) = match read::enumeration("options.format", it.format)? {
                ETD_FORMAT_FLOAT => (channels, 4),
                _ if !is_color => {
                    return Err(Failure::argument("options.format: layers other than the colour are copied as floats"));
                }
                ETD_FORMAT_RGB_FLOAT => (3, 4),
                ETD_FORMAT_RGB8 => (3, 1),
                ETD_FORMAT_RGBA8 => (4, 1),
            };
            let row = width * values * value_size;
            let stride = if row_stride == 0 { row } else { row_stride };
            if !pixels.addr().is_multiple_of(value_size) {
                return Err(Failure::argument(format!("pixels is not aligned to {value_size} bytes")));
            }
            if stride < row || stride % value_size != 0 {
                let message = format!("row_stride is {stride}, expected a multiple of {value_size} of at least {row}");
                return Err(Failure::argument(message));
            }
            if (height - 1).checked_mul(stride).and_then(|rest| rest.checked_add(row)).is_none_or(|all| all > size) {
                let message = format!("size is {size}: {height} rows of {row} bytes, {stride} apart, do not fit");
                return Err(Failure::argument(message));
            }
            let display = if value_size == 1 { Some(to_display(frame.rgba(), frame.resolution(), &it)?) } else { None };
            for y in 0..height {
                let target = pixels.cast::<u8>().add(if it.bottom_up != 0 { height - 1 - y } else { y } * stride);
                let source = &data[y * width * channels..(y + 1) * width * channels];
                match &display {
                    None if values == channels => {
                        std::ptr::copy_nonoverlapping(source.as_ptr().cast::<u8>(), target, row);
                    }
                    None => {
                        for (x, pixel) in source.chunks_exact(channels).enumerate() {
                            let rgb = [pixel[0], pixel[1], pixel[2]];
                            target.cast::<[f32; 3]>().add(x).write_unaligned(rgb);
                        }
                    }
                    Some(rgb8) => {
                        let rgb8 = &rgb8[3 * y * width..3 * (y + 1) * width];
                        for (x, rgb) in rgb8.chunks_exact(3).enumerate() {
                            let target = target.add(x * values);
                            std::ptr::copy_nonoverlapping(rgb.as_ptr(), target, 3);
                            if values == 4 {
                                let alpha = source[x * channels + 3];
                                target.add(3).write((255.0 * alpha.clamp(0.0, 1.0)).round() as u8);
                            }
                        }
                    }
                }
            }
            Ok(())
        })
    }
}

/// Writes the current image of a film to a file: `.png` (8-bit sRGB), `.exr` (float, with layers) or `.pfm` (float).
///
/// An EXR contains the layers `samples` and `variance`, and, if the film keeps any of them, albedo,
/// normal and depth, or emission, direct and indirect light; by progressive photon methods also `bias`. Its header
/// contains the summary of the render (`relMSE`, `relMSEStandardError`, `displayError`, `samplesPerPixel`, `rays`, `ended`). A
/// file at `path` is replaced in one step, so that no incomplete file ever appears there. `path`: UTF-8. `options`: NULL for a
/// clamped sRGB picture without comments. Errors: `ETD_IO`, `ETD_UNSUPPORTED` for another extension, `ETD_INVALID_OPERATION`
/// before the first render. Thread-safe.
///
/// # Safety
/// Each pointer must be NULL or point to a value of its type.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn etd_film_write(
    film: *const etd_film,
    path: *const c_char,
    options: *const etd_image_options,
) -> etd_status {
    // SAFETY: the caller keeps this function's contract.
    unsafe {
        on(film, |film| {
            let path = text(path, "path")?;
            let it = read_image_options(options)?;
            let comments = optional_text(it.comments, "options.comments")?;
            let (sums, attributes) = film.newest_sums()?;
            let options = WriteOptions {
                tone_map: read::tone_map(it.tone_map)?,
                exposure: it.exposure,
                primaries: primaries(it.primaries)?,
                comments: comments.to_owned(),
                attributes,
                threads: film.device().build_threads,
            };
            Ok(output::write(&sums.try_develop(options.threads)?, Path::new(path), &options)?)
        })
    }
}

/// Returns the summary of the last render to this film that has ended, or of a film that was loaded or merged. Error:
/// `ETD_INVALID_OPERATION` before the first one. Thread-safe.
///
/// # Safety
/// Each pointer must be NULL or point to a value of its type.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn etd_film_get_summary(film: *const etd_film, out_summary: *mut etd_summary) -> etd_status {
    // SAFETY: the caller keeps this function's contract.
    unsafe { on(film, |film| write_sized(out_summary, "out_summary", film.summary()?)) }
}

/// # Safety
/// The contract of [`read_sized`].
unsafe fn read_image_options(options: *const etd_image_options) -> Result<etd_image_options> {
    let defaults = etd_image_options {
        struct_size: size_of::<etd_image_options>(),
        format: 0,
        tone_map: 0,
        exposure: 0.0,
        bottom_up: 0,
        comments: std::ptr::null(),
        primaries: 0,
        reserved: 0,
    };
    // SAFETY: the caller keeps this function's contract.
    let it = if options.is_null() { defaults } else { unsafe { read_sized(options, "options") }? };
    if !(-64.0..=64.0).contains(&it.exposure) {
        let message = format!("options.exposure is {}, expected -64 to 64 stops", it.exposure);
        return Err(Failure::argument(message));
    }
    Ok(it)
}

/// The primaries of this number.
fn primaries(number: u32) -> Result<Primaries> {
    use etd_primaries::*;
    Ok(match read::enumeration("options.primaries", number)? {
        ETD_PRIMARIES_REC709 => Primaries::Rec709,
        ETD_PRIMARIES_REC2020 => Primaries::Rec2020,
        ETD_PRIMARIES_ACESCG => Primaries::AcesCg,
        ETD_PRIMARIES_XYZ => Primaries::Xyz,
    })
}

/// Converts the colour to sRGB bytes.
fn to_display(rgba: &[f32], [width, height]: [u32; 2], options: &etd_image_options) -> Result<Vec<u8>> {
    let tone_map: ToneMap = read::tone_map(options.tone_map)?;
    let rgb = rgba.chunks_exact(4).flat_map(|pixel| [pixel[0], pixel[1], pixel[2]]).collect();
    let image = Image { width, height, rgb, ..Image::default() };
    Ok(output::to_srgb8(&image, tone_map, options.exposure)?)
}
