//! Image files: what is written is what is read, brightness follows the published curves, damaged files are refused, an
//! interrupted write leaves the old file, and the metrics agree with values computed by hand.

#[cfg(unix)]
mod atomic;
mod damage;
mod dwa;
mod formats;
mod metrics;
mod tone;

use etendue::film::{Image, Layer};
use etendue::output::{self, ToneMap};
use tempfile::TempDir;

/// A reproducible stream of 32-bit words (splitmix64, upper half).
struct Words(u64);

impl Words {
    fn next(&mut self) -> u32 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut word = self.0;
        word = (word ^ (word >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        word = (word ^ (word >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((word ^ (word >> 31)) >> 32) as u32
    }

    fn unit(&mut self) -> f32 {
        (self.next() >> 8) as f32 / (1 << 24) as f32
    }
}

fn folder() -> TempDir {
    tempfile::tempdir().expect("a temporary folder")
}

/// Every bit pattern may occur: NaN with a payload, infinities, denormals, negative zero.
fn arbitrary_image(width: u32, height: u32, with_layers: bool, seed: u64) -> Image {
    let mut words = Words(seed);
    let pixels = width as usize * height as usize;
    let mut values = |count: usize| -> Vec<f32> { (0..count).map(|_| f32::from_bits(words.next())).collect() };
    let mut rgb = values(3 * pixels);
    for (value, special) in rgb.iter_mut().zip([f32::NAN, f32::INFINITY, f32::NEG_INFINITY, -0.0, 1e-45]) {
        *value = special;
    }
    let names: &[(&str, usize)] =
        if with_layers { &[("albedo", 3), ("normal", 3), ("depth", 1), ("samples", 1), ("variance", 3)] } else { &[] };
    let layer = |&(name, channels): &(&str, usize)| {
        let data = values(channels * pixels);
        Layer { name: name.to_owned(), channels, data }
    };
    Image { width, height, rgb, layers: names.iter().map(layer).collect(), ..Image::default() }
}

/// Equality of bits, which unlike `==` also tells NaN from NaN and zero from negative zero.
fn assert_same_bits(found: &Image, expected: &Image) {
    let bits = |data: &[f32]| data.iter().map(|value| value.to_bits()).collect::<Vec<_>>();
    assert_eq!((found.width, found.height), (expected.width, expected.height));
    assert!(bits(&found.rgb) == bits(&expected.rgb), "pixels differ");
    let names =
        |image: &Image| image.layers.iter().map(|layer| (layer.name.clone(), layer.channels)).collect::<Vec<_>>();
    assert_eq!(names(found), names(expected));
    for (found, expected) in found.layers.iter().zip(&expected.layers) {
        assert!(bits(&found.data) == bits(&expected.data), "layer '{}' differs", expected.name);
    }
}

fn grey(values: &[f32]) -> Image {
    let rgb = values.iter().flat_map(|&value| [value; 3]).collect();
    Image { width: values.len() as u32, height: 1, rgb, ..Image::default() }
}

/// The display codes of grey pixels of these values.
fn codes(tone_map: ToneMap, exposure: f32, values: &[f32]) -> Vec<u8> {
    let bytes = output::to_srgb8(&grey(values), tone_map, exposure).expect("a valid exposure");
    bytes.chunks_exact(3).map(|pixel| pixel[0]).collect()
}
