//! DWA-compressed OpenEXR. The pictures of `tests/data/dwa` were written by OpenEXR 3.5; `NAME-plain.exr` has what
//! OpenEXR decodes from `NAME.exr`, without loss. They are such that all of the transform's implementations, which sum
//! in different orders, agree on them.

use std::fs;
use std::path::{Path, PathBuf};

use etendue::ErrorKind;
use etendue::output;
use etendue::texture::{TexelFormat, read_image, read_image_bytes};

use super::{Words, assert_same_bits, folder};

/// Name, channels and format as a texture.
const PICTURES: [(&str, u32, TexelFormat); 5] = [
    // Two blocks of DWAA, the second of one row. Alpha is compressed by run lengths.
    ("rgba-half", 4, TexelFormat::F16),
    ("rgb-float", 3, TexelFormat::F32),
    // Two layers of colour, a depth of 32 bits and a layer of integers.
    ("layers", 3, TexelFormat::F16),
    ("grey", 1, TexelFormat::F16),
    // AC coefficients are deflated instead of Huffman coded.
    ("tiles", 3, TexelFormat::F16),
];

fn file(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/dwa").join(format!("{name}.exr"))
}

#[test]
fn dwa_pictures_are_what_openexr_decodes() {
    for (name, channels, format) in PICTURES {
        let (compressed, plain) = (file(name), file(&format!("{name}-plain")));
        assert_same_bits(&output::read(&compressed).unwrap(), &output::read(&plain).unwrap());
        let (found, _) = read_image(&compressed).unwrap();
        let (expected, _) = read_image(&plain).unwrap();
        assert_eq!((found.channels(), found.texels().format()), (channels, format), "{name}");
        assert!(found == expected, "{name} differs as a texture");
    }
}

#[test]
fn dwa_layers_are_read() {
    let image = output::read(&file("layers")).unwrap();
    let layers: Vec<_> = image.layers.iter().map(|layer| (layer.name.as_str(), layer.channels)).collect();
    assert_eq!(layers, [("depth", 1), ("a", 3), ("id", 1)]);
}

#[test]
fn truncated_dwa_is_refused() {
    let folder = folder();
    let path = folder.path().join("image.exr");
    for (name, ..) in PICTURES {
        let whole = fs::read(file(name)).unwrap();
        for length in (0..whole.len()).step_by(5).chain([whole.len() - 1]) {
            fs::write(&path, &whole[..length]).unwrap();
            let error = output::read(&path).expect_err(&format!("{name} cut to {length} bytes"));
            assert!(matches!(error.kind(), ErrorKind::Io | ErrorKind::Unsupported), "{error}");
        }
    }
}

#[test]
fn damaged_dwa_gives_an_image_or_an_error() {
    let mut words = Words(11);
    for (name, ..) in PICTURES {
        let whole = fs::read(file(name)).unwrap();
        let (mut images, mut errors) = (0, 0);
        for round in 0..1500 {
            let mut bytes = whole.clone();
            // Most rounds leave the header of the file whole, so that the blocks are reached.
            let start = if round % 8 == 0 { 0 } else { blocks(&whole)[0] };
            for _ in 0..=words.next() % 3 {
                let at = start + words.next() as usize % (bytes.len() - start);
                bytes[at] = [0, 0xff, 0x7f, 0x80, words.next() as u8][words.next() as usize % 5];
            }
            match read_image_bytes(&bytes, None) {
                Ok(_) => images += 1,
                Err(error) => {
                    assert!(matches!(error.kind(), ErrorKind::Io | ErrorKind::Unsupported), "{error}");
                    errors += 1;
                }
            }
        }
        assert!(images > 0 && errors > 0, "{name}: {images} images, {errors} errors");
    }
}

/// The library takes memory by these counters: memory that is not there would end the program.
#[test]
fn dwa_counters_that_promise_too_much_are_refused() {
    for (name, ..) in PICTURES {
        let whole = fs::read(file(name)).unwrap();
        for block in blocks(&whole) {
            // Bytes without loss, of run lengths and from them; AC and DC coefficients.
            for counter in [1, 6, 7, 8, 9] {
                for value in [1 << 24, 1 << 46, u64::MAX >> 1, u64::MAX] {
                    let mut bytes = whole.clone();
                    let at = block + 8 * counter;
                    bytes[at..at + 8].copy_from_slice(&u64::to_le_bytes(value));
                    let error = read_image_bytes(&bytes, None).expect_err("a counter of too much");
                    assert_eq!(error.kind(), ErrorKind::Io);
                    assert!(error.to_string().contains(&format!("claims {value} ")), "{name}, {counter}: {error}");
                }
            }
            // One DC coefficient less than the channels need.
            let mut bytes = whole.clone();
            bytes[block + 72] -= 1;
            let error = read_image_bytes(&bytes, None).expect_err("a coefficient is missing");
            assert!(error.to_string().contains("DC coefficients for channels of"), "{name}: {error}");
        }
    }
}

/// Where the compressed blocks of a file begin: with a version of 2, and small counters of which the last is 0 or 1.
fn blocks(file: &[u8]) -> Vec<usize> {
    let counter = |at: usize| u64::from_le_bytes(file[at..at + 8].try_into().unwrap());
    let is_block = |&at: &usize| {
        let counters: Vec<_> = (0..11).map(|index| counter(at + 8 * index)).collect();
        counters[0] == 2 && counters[1..10].iter().all(|&size| size < 1 << 20) && counters[3] > 0 && counters[10] < 2
    };
    let found: Vec<_> = (0..file.len() - 88).filter(is_block).collect();
    assert!(!found.is_empty(), "no block is compressed");
    found
}
