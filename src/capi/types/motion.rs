//! Types of motion.

/// When the shutter is open, in seconds. Everything is seen at one moment where it closes as it opens.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct etd_shutter {
    /// `sizeof(etd_shutter)`.
    pub struct_size: usize,
    /// When it opens.
    pub open: f64,
    /// When it closes, not before `open`.
    pub close: f64,
    /// How open it is at moments evenly spaced from `open` to `close`, in any unit: numbers >= 0, between which it changes linearly;
    /// they are read during the call. NULL: as open all the time. `etd_scene_get_shutter` sets it to NULL.
    pub curve: *const f64,
    /// Number of them, 2 to 1024; 0 with NULL.
    pub curve_count: usize,
}

/// A keyframe: a transform at a time, which is done to a thing after its own placement. Between two keyframes, translation and scale
/// change linearly and the rotation goes the shorter way at constant speed; before the first and after the last, nothing moves.
/// Arrays of keyframes follow one another without gaps, so this structure does not grow.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct etd_motion_key {
    /// The time in seconds, later than that of the keyframe before.
    pub time: f64,
    /// Translation, applied last.
    pub translation: [f64; 3],
    /// Rotation: a quaternion x, y, z, w of any length but 0.
    pub rotation: [f64; 4],
    /// Factors along the axes, applied first, none of them 0.
    pub scale: [f64; 3],
    /// Not 0: the transform is `matrix`, and the fields above are not read.
    pub use_matrix: u32,
    /// Must be 0.
    pub reserved: u32,
    /// Three rows of four numbers, invertible. The transform is taken apart into a stretch, a rotation and a translation.
    pub matrix: [f64; 12],
}

versioned! {
    etd_shutter, curve;
}
