//! Cryptomatte: layers and attributes of an EXR in which compositing programs pick objects and materials by their names.
//!
//! For each kind of name ([`layer_name`]) there are layers `CryptoObject00`, `CryptoObject01`, ... of four channels, which hold two
//! pairs of an identifier and its coverage each, those of the largest coverage first, and a layer `CryptoObject` that is a picture
//! for people. An identifier is a 32-bit hash of a name, whose bits are those of a float.
//!
//! ```
//! use etendue::output::cryptomatte::id;
//!
//! assert_eq!(id("bunny").to_bits(), 0x1385_1a76);
//! ```
//!
//! Sources: Friedman and Jones 2015, "Fully automatic ID mattes with support for motion blur and transparency", and the Cryptomatte
//! specification, version 1.2; the hash is MurmurHash3_x86_32 by Appleby.

use std::fmt::Write as _;

use crate::image::{Attribute, Layer};
use crate::render::{MatteKind, MatteShare, Mattes};
use crate::room::{collected, filled, with_room};
use crate::{Error, ErrorKind, Result};

/// Number of names in one layer.
const IN_A_LAYER: usize = 2;

/// The name of the layers of a kind, before their number.
pub fn layer_name(kind: MatteKind) -> &'static str {
    match kind {
        MatteKind::Object => "CryptoObject",
        MatteKind::Material => "CryptoMaterial",
    }
}

/// The identifier of a name. Its bits are those of the hash, but for exponents of 0 and 255, which are 1 and 254 instead: it is a
/// normal number, never 0, and no program changes it. 0 stands for no name.
pub fn id(name: &str) -> f32 {
    let hash = murmur3(name.as_bytes());
    let exponent = (hash >> 23 & 0xff).clamp(1, 254);
    f32::from_bits(hash & 0x807f_ffff | exponent << 23)
}

/// Layers of an image for mattes of the same size: of each kind a picture for people, and all levels.
///
/// # Errors
/// [`ErrorKind::OutOfMemory`].
pub fn layers(mattes: &Mattes) -> Result<Vec<Layer>> {
    let mut layers = Vec::new();
    let [width, height] = mattes.resolution();
    let pixels = width as usize * height as usize;
    for kind in MatteKind::ALL {
        let name = layer_name(kind);
        let ids = ids(mattes.names(kind))?;
        let coverage = |share: &MatteShare| share.samples as f32 / mattes.samples() as f32;
        let each = || (0..height).flat_map(|y| (0..width).map(move |x| mattes.pixel(kind, x, y)));
        let mut preview = with_room(3 * pixels)?;
        for shares in each() {
            let mut sum = [0.0_f32; 3];
            for share in shares {
                let color = color(ids[share.name as usize]);
                sum = std::array::from_fn(|i| sum[i] + coverage(share) * color[i]);
            }
            preview.extend(sum);
        }
        layers.push(Layer { name: name.to_owned(), channels: 3, data: preview });
        let mut first = 0;
        while first < mattes.levels() as usize {
            let mut data = filled(0.0, 2 * IN_A_LAYER * pixels)?;
            for (shares, pairs) in each().zip(data.chunks_exact_mut(2 * IN_A_LAYER)) {
                for (share, pair) in shares.iter().skip(first).zip(pairs.chunks_exact_mut(2)) {
                    pair.copy_from_slice(&[ids[share.name as usize], coverage(share)]);
                }
            }
            layers.push(Layer { name: format!("{name}{:02}", first / IN_A_LAYER), channels: 4, data });
            first += IN_A_LAYER;
        }
    }
    Ok(layers)
}

/// The attributes of an image that has these layers: of each kind `cryptomatte/KEY/name`, `hash`, `conversion` and `manifest`, a JSON
/// object of all names of the scene with the bits of their identifiers in hexadecimal digits.
///
/// # Errors
/// [`ErrorKind::OutOfMemory`].
pub fn attributes(mattes: &Mattes) -> Result<Vec<(String, Attribute)>> {
    let mut attributes = Vec::new();
    for kind in MatteKind::ALL {
        let name = layer_name(kind);
        let key = format!("{:08x}", id(name).to_bits());
        for (what, value) in [
            ("name", name.to_owned()),
            ("hash", "MurmurHash3_32".to_owned()),
            ("conversion", "uint32_to_float32".to_owned()),
            ("manifest", manifest(mattes.names(kind))?),
        ] {
            attributes.push((format!("cryptomatte/{}/{what}", &key[..7]), Attribute::Text(value)));
        }
    }
    Ok(attributes)
}

/// The identifiers of names, in their order.
pub(crate) fn ids(names: &[String]) -> Result<Vec<f32>> {
    collected(names.iter().map(|name| id(name)), names.len())
}

fn manifest(names: &[String]) -> Result<String> {
    // Names in quotes may be longer, by up to six times where they have nothing but control characters.
    let length = names.iter().map(|name| 6 * name.len() + 14).sum::<usize>() + 2;
    let mut text = String::new();
    let no_room = |error| Error::new(ErrorKind::OutOfMemory, "no room for the manifest of mattes").because(error);
    text.try_reserve(length).map_err(no_room)?;
    text.push('{');
    for (number, name) in names.iter().enumerate() {
        let quoted = serde_json::Value::from(name.as_str());
        // A string takes what is written.
        let _ = write!(text, "{}{quoted}:\"{:08x}\"", if number > 0 { "," } else { "" }, id(name).to_bits());
    }
    text.push('}');
    Ok(text)
}

/// A colour by which people tell identifiers apart. Green and blue are those of the specification.
fn color(id: f32) -> [f32; 3] {
    [0, 8, 16].map(|shift| (id.to_bits() << shift) as f32 / u32::MAX as f32)
}

/// The 32-bit MurmurHash3 for processors of 32 bits, with the seed 0.
fn murmur3(bytes: &[u8]) -> u32 {
    let mixed = |block: u32| block.wrapping_mul(0xcc9e_2d51).rotate_left(15).wrapping_mul(0x1b87_3593);
    let (blocks, rest) = bytes.as_chunks::<4>();
    let mut hash = blocks.iter().fold(0_u32, |hash, block| {
        let hash = (hash ^ mixed(u32::from_le_bytes(*block))).rotate_left(13);
        hash.wrapping_mul(5).wrapping_add(0xe654_6b64)
    });
    let rest = rest.iter().rev().fold(0, |block, byte| block << 8 | u32::from(*byte));
    hash ^= mixed(rest);
    hash ^= bytes.len() as u32;
    hash = (hash ^ hash >> 16).wrapping_mul(0x85eb_ca6b);
    hash = (hash ^ hash >> 13).wrapping_mul(0xc2b2_ae35);
    hash ^ hash >> 16
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn hashes_are_those_of_the_reference() {
        // Verification vectors of MurmurHash3_x86_32 with the seed 0.
        for (text, hash) in [
            ("", 0),
            ("test", 0xba6b_d213),
            ("Hello, world!", 0xc036_3e43),
            ("The quick brown fox jumps over the lazy dog", 0x2e4f_f723),
        ] {
            assert_eq!(murmur3(text.as_bytes()), hash, "{text}");
        }
        assert_eq!(murmur3(&[0xff; 4]), 0x7629_3b50);
        assert_eq!(murmur3(&[0x21, 0x43, 0x65, 0x87]), 0xf55b_516b);
        assert_eq!(murmur3(&[0x21, 0x43, 0x65]), 0x7e4a_8634);
        assert_eq!(murmur3(&[0x21]), 0x7266_1cf4);
    }

    #[test]
    fn identifiers_are_those_of_the_specification() {
        // Those in the specification's example of a header, and in its sample images.
        for (name, bits) in [
            ("bunny", 0x1385_1a76),
            ("default", 0x42c9_679f),
            ("bunny_porcelain_mat", 0xb24b_26d4),
            ("bush", 0xf763_d090),
            ("flowerA.flowerA_petal1.:1015", 0x9147_54e4),
            ("flowerA.flowerA_petal1.:2261", 0x00af_91ae),
        ] {
            assert_eq!(id(name).to_bits(), bits, "{name}");
        }
        // Keys in the headers of these files, by the names of their layers.
        for (kind, key) in [("uCryptoAsset", "d593dd7"), ("uCryptoObject", "ae93ba3"), ("crypto_object", "f834d0a")] {
            assert_eq!(format!("{:08x}", id(kind).to_bits())[..7], *key);
        }
        // Those of the tests of its decoder for Nuke.
        for (name, value) in [
            ("hello", 6.070_562_710_24e-17),
            ("cube", -4.084_619_125_19e15),
            ("sphere", 2.790_186_043_83e15),
            ("plane", 3.665_576_175_93e-11),
            ("\u{440}\u{430}\u{432}\u{43d}\u{438}\u{43d}\u{430}", -1.319_263_121_24e-25),
            ("m\u{e4}dchen", 6.236_129_821_16e25),
        ] {
            assert_eq!(id(name), value as f32, "{name}");
        }
    }

    #[test]
    fn identifiers_are_normal_numbers() {
        // The empty name has the hash 0. Among so many hashes, some have each of the exponents that are none of normal numbers.
        let names: Vec<String> = (0..4096).map(|number| format!("surfaces[{number}]")).collect();
        let exponents =
            |exponent: u32| names.iter().filter(|name| murmur3(name.as_bytes()) >> 23 & 0xff == exponent).count();
        assert!(exponents(0) > 0 && exponents(255) > 0);
        assert!(names.iter().map(|name| id(name)).chain([id("")]).all(f32::is_normal));
        assert_eq!(id("").to_bits(), 1 << 23);
        assert!(names.iter().all(|name| (id(name).to_bits() ^ murmur3(name.as_bytes())) & 0x807f_ffff == 0));
    }

    #[test]
    fn manifests_are_json() {
        let names = ["plain", "with \"quotes\", \\ and\nlines", "m\u{e4}dchen", "\u{1}"].map(str::to_owned);
        let text = manifest(&names).unwrap();
        let read: serde_json::Map<String, serde_json::Value> = serde_json::from_str(&text).unwrap();
        assert_eq!(read.len(), 4);
        for name in &names {
            assert_eq!(read[name], format!("{:08x}", id(name).to_bits()));
        }
        assert_eq!(manifest(&[]).unwrap(), "{}");
    }
}
