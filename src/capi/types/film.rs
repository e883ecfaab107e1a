//! Types of films and their images.

use std::ffi::c_char;

use super::numbers::{EtdFormat, EtdPrimaries, EtdToneMap};
pub use {etd_format::*, etd_layer::*, etd_primaries::*, etd_tone_map::*};

/// A layer of a film. The values are bits, whose combination names the layers that a film keeps.
#[repr(u32)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum etd_layer {
    /// Radiance, linear Rec. 709 [W m^-2 sr^-1], with alpha: 4 channels. Always kept.
    ETD_LAYER_COLOR = 1,
    /// Albedo at the first hit, in [0, 1]: 3 channels; 0 where rays hit nothing.
    ETD_LAYER_ALBEDO = 2,
    /// Shading normal at the first hit, towards the camera, in world axes: 3 channels. It is a mean over samples, and thus not of
    /// unit length at edges; 0 where rays hit nothing.
    ETD_LAYER_NORMAL = 4,
    /// Distance of the first hit from the eye along the view direction: 1 channel; infinite where rays hit nothing.
    ETD_LAYER_DEPTH = 8,
    /// Number of the pixel's samples: 1 channel.
    ETD_LAYER_SAMPLES = 16,
    /// Variance of the pixel's mean: 3 channels; NaN while there are too few samples for an estimate.
    ETD_LAYER_VARIANCE = 32,
    /// Standard error of the pixel's mean, which is the square root of the variance: 3 channels.
    ETD_LAYER_STANDARD_ERROR = 64,
    /// Alpha in the colour layer: the fraction of samples that hit a surface. Without this bit, alpha is 1. It is not an image of
    /// its own.
    ETD_LAYER_ALPHA = 128,
    /// Estimated bias of the pixel's mean by photon maps, the excess over the true value: 3 channels. With maps that are built
    /// once (photon, photon_direct, irradiance_cache), only the bias of caustics is included. It is 0 without maps.
    ETD_LAYER_BIAS = 256,
    /// Light that emitters send to the camera without being scattered on its way, [W m^-2 sr^-1]: 3 channels. The sum of this layer and
    /// the next two is the colour. Only the integrators path and direct, and auto, which is path for such a film, count how often light
    /// is scattered: a render by another one ends with `ETD_UNSUPPORTED`. Its pixels share no hits, and it has no light paths.
    ETD_LAYER_EMISSION = 512,
    /// Light that was scattered once, by the surface that the camera sees, [W m^-2 sr^-1]: 3 channels. Mirrors and glass scatter, too.
    ETD_LAYER_DIRECT = 1024,
    /// Light that was scattered more than once, [W m^-2 sr^-1]: 3 channels. Like the colour, parts may be below 0 with wavelengths and with
    /// filters that are; where there is no indirect light, rounding may leave some that is hardly any.
    ETD_LAYER_INDIRECT = 2048,
}

/// Options of a film.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct etd_film_options {
    /// `sizeof(etd_film_options)`.
    pub struct_size: usize,
    /// Number of pixels in a row, >= 1.
    pub width: u32,
    /// Number of rows, >= 1. A film has 2^26 pixels at most.
    pub height: u32,
    /// `etd_layer` bits of the layers that the film keeps besides the colour.
    pub layers: u32,
    /// Must be 0.
    pub reserved: u32,
}

/// An image in the library's memory, which may be read until `etd_film_unmap`.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct etd_map {
    /// `sizeof(etd_map)`.
    pub struct_size: usize,
    /// `[height][width][channels]`, row 0 on top, without gaps. The data do not change while they are mapped.
    pub data: *const f32,
    /// Number of pixels in a row.
    pub width: u32,
    /// Number of rows.
    pub height: u32,
    /// Number of values for each pixel.
    pub channels: u32,
    /// Number of complete samples per pixel in this image; 0 for the black image before the first pass.
    pub samples: u32,
    /// Number of the map, for `etd_film_unmap`.
    pub id: u64,
}

/// The format of pixels in the host's memory.
#[repr(u32)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum etd_format {
    /// One float for each channel of the layer.
    ETD_FORMAT_FLOAT = 0,
    /// Three floats; for the colour only.
    ETD_FORMAT_RGB_FLOAT = 1,
    /// Three bytes, sRGB; for the colour only.
    ETD_FORMAT_RGB8 = 2,
    /// Four bytes, sRGB with linear alpha; for the colour only.
    ETD_FORMAT_RGBA8 = 3,
}

/// The tone map, from radiance to displayed values.
#[repr(u32)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum etd_tone_map {
    /// Clamps to [0, 1]: radiance of 1 and more is white.
    ETD_TONE_MAP_CLAMP = 0,
    /// Divides by the largest value of the image.
    ETD_TONE_MAP_MAXIMUM = 1,
    /// x / (1 + x).
    ETD_TONE_MAP_REINHARD = 2,
    /// A curve with a toe and a shoulder (Narkowicz's fit to ACES).
    ETD_TONE_MAP_ACES = 3,
}

/// Options for copying and writing images.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct etd_image_options {
    /// `sizeof(etd_image_options)`.
    pub struct_size: usize,
    /// An `etd_format`; `etd_film_write` ignores it.
    pub format: EtdFormat,
    /// An `etd_tone_map`, for 8-bit formats and PNG.
    pub tone_map: EtdToneMap,
    /// Stops, in [-64, 64]: a factor of 2^exposure before the tone map, for 8-bit formats and PNG.
    pub exposure: f32,
    /// If not 0, the bottom row comes first, as in OpenGL; `etd_film_write` ignores it.
    pub bottom_up: u32,
    /// Text for the `comments` attribute of an EXR, UTF-8; NULL: none. Only `etd_film_write` uses it.
    pub comments: *const c_char,
    /// An `etd_primaries`: those of an EXR or PFM. Only `etd_film_write` uses it.
    pub primaries: EtdPrimaries,
    /// 0.
    pub reserved: u32,
}

/// The primaries of linear colours in a file.
#[repr(u32)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum etd_primaries {
    /// Rec. 709, white D65.
    ETD_PRIMARIES_REC709 = 0,
    /// Rec. 2020, white D65.
    ETD_PRIMARIES_REC2020 = 1,
    /// ACEScg, to whose white colours are adapted from D65.
    ETD_PRIMARIES_ACESCG = 2,
    /// Tristimulus values of CIE 1931; Y is the luminance.
    ETD_PRIMARIES_XYZ = 3,
}

enumerations! {
    etd_primaries: ETD_PRIMARIES_REC709, ETD_PRIMARIES_REC2020, ETD_PRIMARIES_ACESCG, ETD_PRIMARIES_XYZ;
    etd_format: ETD_FORMAT_FLOAT, ETD_FORMAT_RGB_FLOAT, ETD_FORMAT_RGB8, ETD_FORMAT_RGBA8;
    etd_tone_map: ETD_TONE_MAP_CLAMP, ETD_TONE_MAP_MAXIMUM, ETD_TONE_MAP_REINHARD, ETD_TONE_MAP_ACES;
}

versioned! {
    etd_film_options, reserved;
    etd_map, id;
    etd_image_options, comments;
}
