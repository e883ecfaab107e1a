//! Images as plain floats, and the codecs of their files: OpenEXR, PFM, PNG.
//!
//! The codecs know pixels, layers and header values only. What a render writes beside its pixels, tone maps, and replacing a
//! file in one step are in [`crate::output`].

mod check;
mod dwa;
pub(crate) mod exr;
mod file;
pub(crate) mod pfm;
mod pixels;
pub(crate) mod png;

pub use check::MAX_PIXELS;
pub(crate) use check::check_image;
pub use exr::Attribute;
pub(crate) use exr::{decode_parts as decode_exr_parts, encode_channels as encode_exr_channels};
pub use file::{Format, read};
pub use pixels::{Image, Layer, Placement};
pub(crate) use png::encode_texels as encode_png;
