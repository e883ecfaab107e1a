//! Types of lights without a surface.

use std::ffi::{c_char, c_void};

/// A point light that shines into a cone with a soft edge. The factor on its intensity is 1 up to the inner angle a from the axis, 0
/// from the outer angle on, and between them ((cos a - cos outer) / (cos inner - cos outer))^2, as in glTF.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct etd_spot_light {
    /// `sizeof(etd_spot_light)`.
    pub struct_size: usize,
    /// Where it is, world frame.
    pub position: [f64; 3],
    /// The axis of the cone, away from the light, of any length but 0.
    pub direction: [f64; 3],
    /// Radiant intensity along the axis [W sr^-1], each channel >= 0.
    pub intensity: [f32; 3],
    /// Degrees between the axis and the directions from which on there is no light, in [0.01, 180].
    pub outer_cone_deg: f64,
    /// Degrees between the axis and the directions up to which the light is full, in [0, `outer_cone_deg`].
    pub inner_cone_deg: f64,
}

/// A measured lamp: a point light whose intensities come from a file of IES LM-63 or EULUMDAT.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct etd_web_light {
    /// `sizeof(etd_web_light)`.
    pub struct_size: usize,
    /// Name of the file; NULL: `text` has its contents. `etd_scene_get_web_light` sets it to NULL.
    pub file: *const c_char,
    /// Contents of such a file, which are read during the call; NULL: `file`. `etd_scene_get_web_light` sets it to NULL.
    pub text: *const c_void,
    /// Size of `text` in bytes.
    pub text_bytes: usize,
    /// Where it is, world frame.
    pub position: [f64; 3],
    /// The lamp's axis, gamma = 0, of any length but 0.
    pub direction: [f64; 3],
    /// The direction of C = 0, of any length but 0, whose part across `direction` counts. C grows counter-clockwise as seen along
    /// `direction`.
    pub c0: [f64; 3],
    /// Factor on the intensities, each channel >= 0. At 1, the radiant intensity [W sr^-1] is the file's candela over 683 lm/W.
    pub factor: [f32; 3],
    /// Degrees by which the luminaire is tilted from straight down, in [-180, 180] and within the tilts of the file. It chooses the
    /// factor of files that have some for tilted lamps, and turns nothing.
    pub tilt_deg: f64,
}

/// The photometric web of a flat surface, from a file of IES LM-63 or EULUMDAT. The lamp's axis, gamma = 0, is the normal.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct etd_surface_web {
    /// `sizeof(etd_surface_web)`.
    pub struct_size: usize,
    /// Name of the file; NULL: `text` has its contents. `etd_scene_get_surface_web` sets it to NULL.
    pub file: *const c_char,
    /// Contents of such a file, which are read during the call; NULL: `file`. `etd_scene_get_surface_web` sets it to NULL.
    pub text: *const c_void,
    /// Size of `text` in bytes.
    pub text_bytes: usize,
    /// The direction of C = 0 in the object's frame, of any length but 0, whose part along the surface counts. C grows counter-clockwise
    /// as seen along the normal.
    pub c0: [f64; 3],
    /// As `tilt_deg` of `etd_web_light`.
    pub tilt_deg: f64,
}

versioned! {
    etd_surface_web, tilt_deg;
    etd_spot_light, inner_cone_deg;
    etd_web_light, factor;
}
