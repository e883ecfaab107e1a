//! What light leaves behind: sums per pixel, and the image developed from them. Knows no files.

mod image;

pub use image::{Image, Layer};
