//! Numbers at the ends of their ranges: long sums, very bright and very dark light, very large and very small scenes; where
//! a camera's rays go; what a display is sent; and that nothing depends on who computes it. `scripts/arithmetic.sh` does
//! the same for builds and instruction sets.

mod camera;
mod display;
mod range;
mod repeat;
mod sums;

use etendue::film::Image;

use crate::record::Entry;

pub fn cases() -> Vec<Entry> {
    [sums::cases(), camera::cases(), display::cases(), repeat::cases(), range::cases()].into_iter().flatten().collect()
}

/// Bit patterns of all values and layers, so that NaN equals itself and -0 differs from 0.
fn bits(image: &Image) -> Vec<u32> {
    let layers = image.layers.iter().flat_map(|layer| &layer.data);
    image.rgb.iter().chain(layers).map(|value| value.to_bits()).collect()
}
