//! Films and their images.

use std::ffi::c_char;

use super::numbers::{EtdFormat, EtdToneMap};
pub use {etd_format::*, etd_layer::*, etd_tone_map::*};

/// An image of a film. Layers are bits: together they say which ones a film keeps.
#[repr(u32)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum etd_layer {
    /// Radiance, linear Rec. 709 [W m^-2 sr^-1], with alpha: 4 channels. Always kept.
    ETD_LAYER_COLOR = 1,
    /// Albedo at the first hit: 3 channels.
    ETD_LAYER_ALBEDO = 2,
    /// Shading normal at the first hit, facing the camera, world axes: 3 channels, a mean, so not of unit length at edges.
    ETD_LAYER_NORMAL = 4,
    /// Distance of the first hit from the eye along the view direction: 1 channel; infinite where nothing was hit.
    ETD_LAYER_DEPTH = 8,
    /// Samples of the pixel: 1 channel.
    ETD_LAYER_SAMPLES = 16,
    /// Variance of the pixel's mean: 3 channels; NaN while there are too few samples to tell.
    ETD_LAYER_VARIANCE = 32,
    /// Standard error of the pixel's mean, the root of the variance: 3 channels.
    ETD_LAYER_STANDARD_ERROR = 64,
    /// Not an image of its own: alpha of the colour is the share of samples that met a surface. Without it, alpha is 1.
    ETD_LAYER_ALPHA = 128,
    /// Estimated bias of the pixel's mean by photon maps, 3 channels: what is there is too large by so much. With maps that
    /// are made once (photon, photon_direct, irradiance_cache) only that of caustics; 0 without maps.
    ETD_LAYER_BIAS = 256,
}

/// What a film is.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct etd_film_options {
    /// `sizeof(etd_film_options)`.
    pub struct_size: usize,
    /// Pixels in a row, >= 1.
    pub width: u32,
    /// Rows, >= 1; the film has 2^26 pixels at most.
    pub height: u32,
    /// `etd_layer` bits of what is kept besides the colour.
    pub layers: u32,
    /// Must be 0.
    pub reserved: u32,
}

/// An image in the library's memory, there to be read until `etd_film_unmap`.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct etd_map {
    /// `sizeof(etd_map)`.
    pub struct_size: usize,
    /// `[height][width][channels]`, row 0 on top, without gaps. Does not change while it is mapped.
    pub data: *const f32,
    /// Pixels in a row.
    pub width: u32,
    /// Rows.
    pub height: u32,
    /// Values for each pixel.
    pub channels: u32,
    /// Complete samples for each pixel when this image was made; 0 for the black one before the first pass.
    pub samples: u32,
    /// What `etd_film_unmap` knows it by.
    pub id: u64,
}

/// How pixels are laid out in the host's memory.
#[repr(u32)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum etd_format {
    /// Floats, as many as the layer has channels.
    ETD_FORMAT_FLOAT = 0,
    /// Three floats; of the colour only.
    ETD_FORMAT_RGB_FLOAT = 1,
    /// Three bytes, sRGB; of the colour only.
    ETD_FORMAT_RGB8 = 2,
    /// Four bytes, sRGB with linear alpha; of the colour only.
    ETD_FORMAT_RGBA8 = 3,
}

/// How radiance becomes brightness.
#[repr(u32)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum etd_tone_map {
    /// Radiance 1 is white, and so is everything above.
    ETD_TONE_MAP_CLAMP = 0,
    /// Divides by the largest value of the image.
    ETD_TONE_MAP_MAXIMUM = 1,
    /// x / (1 + x).
    ETD_TONE_MAP_REINHARD = 2,
    /// A curve with a toe and a shoulder (Narkowicz's fit to ACES).
    ETD_TONE_MAP_ACES = 3,
}

/// How pixels are copied or written.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct etd_image_options {
    /// `sizeof(etd_image_options)`.
    pub struct_size: usize,
    /// An `etd_format`; not looked at by `etd_film_write`.
    pub format: EtdFormat,
    /// An `etd_tone_map`, for 8-bit formats and PNG.
    pub tone_map: EtdToneMap,
    /// Stops, in [-64, 64]: a factor of 2^exposure before the tone map, for 8-bit formats and PNG.
    pub exposure: f32,
    /// Not 0: the bottom row comes first, as OpenGL wants it; not looked at by `etd_film_write`.
    pub bottom_up: u32,
    /// Free text for the `comments` attribute of an EXR, UTF-8; NULL: none. Only `etd_film_write` looks at it.
    pub comments: *const c_char,
}

enumerations! {
    etd_format: ETD_FORMAT_FLOAT, ETD_FORMAT_RGB_FLOAT, ETD_FORMAT_RGB8, ETD_FORMAT_RGBA8;
    etd_tone_map: ETD_TONE_MAP_CLAMP, ETD_TONE_MAP_MAXIMUM, ETD_TONE_MAP_REINHARD, ETD_TONE_MAP_ACES;
}

versioned! {
    etd_film_options, reserved;
    etd_map, id;
    etd_image_options, comments;
}
