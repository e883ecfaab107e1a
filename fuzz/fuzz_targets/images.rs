//! Any bytes as an image, of a format that the first byte names: they are refused with a message, or are an image whose texels are
//! finite.

#![no_main]

use etendue::texture::{ColorSpace, read_image_bytes};
use libfuzzer_sys::fuzz_target;

fuzz_target!(|data: &[u8]| {
    let Some((kind, content)) = data.split_first() else { return };
    let extension = [None, Some("tga"), Some("png"), Some("hdr")][usize::from(kind % 4)];
    match read_image_bytes(content, extension) {
        Ok((image, _)) => {
            assert!((1..=4).contains(&image.channels()));
            for y in [0, image.height() - 1] {
                for x in 0..image.width() {
                    assert!(image.texel(x, y, ColorSpace::Srgb).iter().all(|value| value.is_finite()));
                }
            }
        }
        Err(error) => {
            assert!(error.kind() != etendue::ErrorKind::Internal, "{error}");
            assert!(!error.message().is_empty() && error.message().len() < 2000, "{error}");
        }
    }
});
