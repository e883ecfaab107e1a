//! Image files: what is written is what is read, brightness follows the published curves, damaged files are refused, an
//! interrupted write leaves the old file, and the metrics agree with values computed by hand.

use std::fs;
use std::path::{Path, PathBuf};

use etendue::ErrorKind;
use etendue::film::{Image, Layer};
use etendue::output::{self, Format, ToneMap, WriteOptions};
use etendue::spectrum::srgb_encode;
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
    Image { width, height, rgb, layers: names.iter().map(layer).collect() }
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
    Image { width: values.len() as u32, height: 1, rgb, layers: Vec::new() }
}

/// The display codes of grey pixels of these values.
fn codes(tone_map: ToneMap, exposure: f32, values: &[f32]) -> Vec<u8> {
    let bytes = output::to_srgb8(&grey(values), tone_map, exposure).expect("a valid exposure");
    bytes.chunks_exact(3).map(|pixel| pixel[0]).collect()
}

#[test]
fn exr_keeps_every_bit_of_every_layer() {
    let folder = folder();
    // 16 rows make a block of the compression: below, at, and beyond it.
    for (width, height) in [(1, 1), (7, 16), (33, 37), (1, 50), (50, 1)] {
        for with_layers in [false, true] {
            let image = arbitrary_image(width, height, with_layers, 1);
            let path = folder.path().join("image.exr");
            output::write(&image, &path, &WriteOptions::default()).unwrap();
            assert_same_bits(&output::read(&path).unwrap(), &image);
        }
    }
}

#[test]
fn exr_names_channels_and_states_its_origin() {
    let folder = folder();
    let path = folder.path().join("image.EXR");
    let image = arbitrary_image(3, 2, true, 2);
    let options = WriteOptions { comments: "Étendue: seed 7".to_owned(), ..WriteOptions::default() };
    output::write(&image, &path, &options).unwrap();

    let meta = exr::meta::MetaData::read_from_file(&path, true).unwrap();
    let [header] = meta.headers.as_slice() else { panic!("one part, not {}", meta.headers.len()) };
    let names: Vec<_> = header.channels.list.iter().map(|channel| channel.name.to_string()).collect();
    let expected = "B G R albedo.B albedo.G albedo.R depth.Z normal.X normal.Y normal.Z samples.Y \
                    variance.B variance.G variance.R";
    assert_eq!(names.join(" "), expected);
    assert!(header.channels.list.iter().all(|channel| channel.sample_type == exr::meta::attribute::SampleType::F32));
    assert_eq!(header.compression, exr::compression::Compression::ZIP16);
    let software = header.own_attributes.software_name.as_ref().unwrap().to_string();
    assert_eq!(software, format!("etendue {}", env!("CARGO_PKG_VERSION")));
    let comments = header.own_attributes.comments.as_ref().unwrap();
    assert_eq!(comments.as_slice(), "Étendue: seed 7".as_bytes());
    assert_eq!(header.shared_attributes.chromaticities.unwrap().red, exr::math::Vec2(0.64, 0.33));
}

#[test]
fn exr_of_other_programs_is_read() {
    use exr::prelude::*;
    let folder = folder();
    let path = folder.path().join("image.exr");
    let size = Vec2(2, 1);
    let half = |values: [f32; 2]| FlatSamples::F16(values.map(f16::from_f32).to_vec());
    let part = |name: &str, channels: Vec<(&str, FlatSamples)>| {
        let channels = channels.into_iter().map(|(name, samples)| AnyChannel::new(name, samples)).collect();
        Layer::new(size, LayerAttributes::named(name), Encoding::FAST_LOSSLESS, AnyChannels::sort(channels))
    };

    // Half floats with alpha in one part, a layer in another.
    let colour = ["A", "B", "G", "R"].into_iter().zip([[1.0, 1.0], [3.0, 6.0], [2.0, 5.0], [1.0, 4.0]]);
    let colour = part("rgba", colour.map(|(name, values)| (name, half(values))).collect());
    let depth = part("depth", vec![("Z", FlatSamples::F32(vec![0.25, 0.5]))]);
    let layers: Layers<_> = [colour, depth].into_iter().collect();
    let display_window = IntegerBounds::from_dimensions(size);
    exr::image::Image::from_layers(ImageAttributes::new(display_window), layers).write().to_file(&path).unwrap();
    let image = output::read(&path).unwrap();
    assert_eq!(image.rgb, [1.0, 2.0, 3.0, 4.0, 5.0, 6.0]);
    assert_eq!(image.layer("depth").unwrap().data, [0.25, 0.5]);
    assert_eq!(image.layers.len(), 1);

    // Grey only.
    let grey = part("grey", vec![("Y", half([0.5, 2.0]))]);
    exr::image::Image::from_layer(grey).write().to_file(&path).unwrap();
    assert_eq!(output::read(&path).unwrap().rgb, [0.5, 0.5, 0.5, 2.0, 2.0, 2.0]);

    // Nothing to show.
    let other = part("other", vec![("temperature", half([0.5, 2.0]))]);
    exr::image::Image::from_layer(other).write().to_file(&path).unwrap();
    let error = output::read(&path).unwrap_err();
    assert_eq!(error.kind(), ErrorKind::Unsupported);
    assert!(error.to_string().contains("temperature"), "{error}");
}

#[test]
fn pfm_keeps_every_bit_and_has_the_documented_layout() {
    let folder = folder();
    let path = folder.path().join("image.pfm");
    for (width, height) in [(1, 1), (7, 16), (33, 37)] {
        let image = arbitrary_image(width, height, false, 3);
        output::write(&image, &path, &WriteOptions::default()).unwrap();
        assert_same_bits(&output::read(&path).unwrap(), &image);
    }

    let image = Image { width: 1, height: 2, rgb: vec![1.0, 2.0, 3.0, 4.0, 5.0, 6.0], layers: Vec::new() };
    output::write(&image, &path, &WriteOptions::default()).unwrap();
    let mut expected = b"PF\n1 2\n-1.0\n".to_vec();
    expected.extend([4.0_f32, 5.0, 6.0, 1.0, 2.0, 3.0].iter().flat_map(|value| value.to_le_bytes()));
    assert_eq!(fs::read(&path).unwrap(), expected);
}

#[test]
fn pfm_may_be_grey_big_endian_and_scaled() {
    let folder = folder();
    let path = folder.path().join("image.pfm");
    let mut file = b"Pf 2 1\n2.0\n".to_vec();
    file.extend([0.5_f32, 3.0].iter().flat_map(|value| value.to_be_bytes()));
    fs::write(&path, file).unwrap();
    assert_eq!(output::read(&path).unwrap().rgb, [1.0, 1.0, 1.0, 6.0, 6.0, 6.0]);
}

#[test]
fn png_is_within_half_a_step() {
    let folder = folder();
    let path = folder.path().join("image.png");
    let mut words = Words(4);
    let rgb = (0..3 * 61 * 43).map(|_| words.unit()).collect();
    let image = Image { width: 61, height: 43, rgb, layers: Vec::new() };
    output::write(&image, &path, &WriteOptions::default()).unwrap();
    let found = output::read(&path).unwrap();
    assert_eq!((found.width, found.height), (61, 43));
    for (&found, &expected) in found.rgb.iter().zip(&image.rgb) {
        let steps = 255.0 * (f64::from(srgb_encode(found)) - f64::from(srgb_encode(expected))).abs();
        // Half a step, and the rounding of single precision at 255 steps.
        assert!(steps <= 0.5 + 255.0 * 2.0 * f64::from(f32::EPSILON), "{expected} came back as {found}");
    }
}

#[test]
fn png_of_all_codes_is_read_and_written_back_the_same() {
    let folder = folder();
    let path = folder.path().join("codes.png");
    let all: Vec<u8> = (0..=255).collect();
    image::save_buffer(&path, &all, 16, 16, image::ExtendedColorType::L8).unwrap();
    let image = output::read(&path).unwrap();
    let found = output::to_srgb8(&image, ToneMap::Clamp, 0.0).unwrap();
    let expected: Vec<u8> = all.iter().flat_map(|&code| [code; 3]).collect();
    assert_eq!(found, expected);

    // 16 bits keep more than 8; alpha is left out.
    let deep: Vec<u8> = [65535_u16, 32896, 257, 7].iter().flat_map(|value| value.to_ne_bytes()).collect();
    image::save_buffer(&path, &deep, 1, 1, image::ExtendedColorType::Rgba16).unwrap();
    let pixel = output::read(&path).unwrap().pixel(0, 0);
    for (value, encoded) in pixel.into_iter().zip([65535.0_f64, 32896.0, 257.0].map(|code| code / 65535.0)) {
        assert!((f64::from(srgb_encode(value)) - encoded).abs() < 1e-6, "{value} for {encoded}");
    }
}

#[test]
fn png_never_holds_what_is_not_a_number() {
    let values = [f32::NAN, -f32::NAN, f32::NEG_INFINITY, -1.0, -0.0, f32::INFINITY, f32::MAX];
    let expected = [0, 0, 0, 0, 0, 255, 255];
    for tone_map in [ToneMap::Maximum, ToneMap::Clamp, ToneMap::Reinhard, ToneMap::Aces] {
        assert_eq!(codes(tone_map, 0.0, &values), expected, "{tone_map:?}");
        for exposure in [-64.0, 64.0] {
            assert_eq!(codes(tone_map, exposure, &[f32::NAN, f32::INFINITY]), [0, 255], "{tone_map:?}");
        }
    }
    // An image without any light has no maximum to divide by.
    assert_eq!(codes(ToneMap::Maximum, 0.0, &[0.0, -1.0, f32::NAN]), [0, 0, 0]);
}

#[test]
fn srgb_curve_has_the_published_values() {
    // 1.055 x^(1/2.4) - 0.055, evaluated with 12 digits. Two units in the last place of single precision near 0.5.
    for (linear, encoded) in [(0.18, 0.461_356_129_500), (0.5, 0.735_356_983_052)] {
        assert!((f64::from(srgb_encode(linear)) - encoded).abs() < 1.2e-7, "{linear}");
    }
    assert_eq!(codes(ToneMap::Clamp, 0.0, &[0.0, 0.18, 0.5, 1.0, 1.5]), [0, 118, 188, 255, 255]);
    // One stop doubles.
    assert_eq!(codes(ToneMap::Clamp, 1.0, &[0.09, 0.25, 0.5]), [118, 188, 255]);
    assert_eq!(codes(ToneMap::Clamp, -1.0, &[0.36, 1.0, 2.0]), [118, 188, 255]);
}

#[test]
fn tone_curves_have_their_published_values() {
    assert_eq!(ToneMap::Reinhard.curve(1.0), 0.5);
    assert_eq!(ToneMap::Reinhard.curve(3.0), 0.75);
    assert_eq!(codes(ToneMap::Reinhard, 0.0, &[1.0, 1e30]), [188, 255]);
    // (2.51 + 0.03) / (2.43 + 0.59 + 0.14), and 0.18 (0.4518 + 0.03) / (0.18 (0.4374 + 0.59) + 0.14).
    assert!((ToneMap::Aces.curve(1.0) - 2.54 / 3.16).abs() < 1e-15);
    assert!((ToneMap::Aces.curve(0.18) - 0.086_724 / 0.324_932).abs() < 1e-15);
    assert_eq!(ToneMap::Aces.curve(100.0), 1.0);
    for tone_map in [ToneMap::Clamp, ToneMap::Maximum] {
        assert_eq!(tone_map.curve(0.25), 0.25);
        assert_eq!(tone_map.curve(1.25), 1.0);
    }
    // The largest finite value is white, half of it is linear 0.5; exposure acts after the division.
    assert_eq!(codes(ToneMap::Maximum, 0.0, &[40.0, 20.0, 7.2, f32::INFINITY]), [255, 188, 118, 255]);
    assert_eq!(codes(ToneMap::Maximum, -1.0, &[40.0, 14.4]), [188, 118]);
    assert_eq!(codes(ToneMap::Maximum, 0.0, &[1e-45, 0.0]), [255, 0]);
}

#[test]
fn brightness_never_decreases() {
    // All non-negative floats in steps that are coprime to their spacing, and every float around each change of code.
    for tone_map in [ToneMap::Maximum, ToneMap::Clamp, ToneMap::Reinhard, ToneMap::Aces] {
        for exposure in [0.0, -3.3] {
            let infinity = f32::INFINITY.to_bits();
            let sparse: Vec<f32> = (0..=infinity).step_by(4093).chain([infinity]).map(f32::from_bits).collect();
            let found = codes(tone_map, exposure, &sparse);
            assert!(found.is_sorted(), "{tone_map:?}");
            assert_eq!((found[0], found[found.len() - 1]), (0, 255));
            if tone_map == ToneMap::Maximum {
                continue; // its scale is that of the largest value in each image: the same curve as Clamp
            }
            let changes = found.windows(2).zip(&sparse).filter(|(pair, _)| pair[0] != pair[1]);
            for (_, from) in changes {
                let around = from.to_bits()..from.to_bits() + 4093;
                let dense: Vec<f32> = around.map(f32::from_bits).collect();
                assert!(codes(tone_map, exposure, &dense).is_sorted(), "{tone_map:?} near {from}");
            }
        }
    }
}

#[test]
fn exposure_is_checked() {
    let folder = folder();
    for exposure in [f32::NAN, f32::INFINITY, 65.0, -65.0] {
        let options = WriteOptions { exposure, ..WriteOptions::default() };
        let error = output::write(&grey(&[1.0]), &folder.path().join("image.png"), &options).unwrap_err();
        assert_eq!(error.kind(), ErrorKind::InvalidScene, "{exposure}");
    }
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 0);
}

#[test]
fn extension_chooses_the_format() {
    for (name, format) in [("a.exr", Format::Exr), ("b/a.PFM", Format::Pfm), ("a.tiff.png", Format::Png)] {
        assert_eq!(Format::from_path(Path::new(name)).unwrap(), format);
    }
    for name in ["image.jpg", "image", ".png", "image."] {
        let error = Format::from_path(Path::new(name)).unwrap_err();
        assert_eq!(error.kind(), ErrorKind::Unsupported, "{name}");
        assert!(error.to_string().starts_with(name), "{error}");
    }
}

#[test]
fn images_that_do_not_fit_are_refused() {
    let folder = folder();
    let good = arbitrary_image(2, 2, true, 5);
    let mut broken = vec![Image::default(), good.clone(), good.clone(), good.clone(), good.clone()];
    broken[1].rgb.pop();
    broken[2].layers[0].data.pop();
    broken[3].layers[1].name = "albedo".to_owned();
    broken[4].layers[0].channels = 2;
    for (index, image) in broken.iter().enumerate() {
        for name in ["image.exr", "image.pfm", "image.png"] {
            let error = output::write(image, &folder.path().join(name), &WriteOptions::default()).unwrap_err();
            assert!(matches!(error.kind(), ErrorKind::Internal | ErrorKind::Unsupported), "{index}: {error}");
        }
    }
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 0);
}

/// A file of each format, as bytes.
fn samples(folder: &Path) -> Vec<(&'static str, Vec<u8>)> {
    let mut image = arbitrary_image(9, 20, true, 6);
    image.rgb.iter_mut().enumerate().for_each(|(index, value)| *value = index as f32 / 540.0);
    ["image.exr", "image.pfm", "image.png"]
        .into_iter()
        .map(|name| {
            output::write(&image, &folder.join(name), &WriteOptions::default()).unwrap();
            (name, fs::read(folder.join(name)).unwrap())
        })
        .collect()
}

#[test]
fn truncated_files_are_refused() {
    let folder = folder();
    for (name, whole) in samples(folder.path()) {
        let path = folder.path().join(name);
        // The last bytes of a PNG are the end marker after all of the pixels, which a decoder need not look at.
        let needed = if name.ends_with("png") { whole.len() - 16 } else { whole.len() - 1 };
        for length in (0..needed).step_by(7).chain([needed]) {
            fs::write(&path, &whole[..length]).unwrap();
            let error = output::read(&path).expect_err(&format!("{name} cut to {length} bytes"));
            assert!(matches!(error.kind(), ErrorKind::Io | ErrorKind::Unsupported), "{error}");
            assert!(error.to_string().contains(name), "{error}");
        }
    }
}

#[test]
fn damaged_files_give_an_image_or_an_error() {
    let folder = folder();
    let mut words = Words(7);
    for (name, whole) in samples(folder.path()) {
        let path = folder.path().join(name);
        let mut errors = 0;
        for round in 0..800 {
            let mut bytes = whole.clone();
            // Half of the rounds damage the header, where sizes are.
            let range = if round % 2 == 0 { bytes.len().min(700) } else { bytes.len() };
            for _ in 0..=words.next() % 3 {
                let at = words.next() as usize % range;
                bytes[at] = [0, 0xff, 0x7f, 0x80, words.next() as u8][words.next() as usize % 5];
            }
            fs::write(&path, &bytes).unwrap();
            match output::read(&path) {
                Ok(image) => assert_eq!(image.rgb.len(), 3 * image.width as usize * image.height as usize),
                Err(error) => {
                    assert!(matches!(error.kind(), ErrorKind::Io | ErrorKind::Unsupported), "{error}");
                    errors += 1;
                }
            }
        }
        assert!(errors > 0, "no damage to {name} was noticed");
    }
}

#[test]
fn promises_of_too_many_pixels_are_refused() {
    let folder = folder();
    let refused = |name: &str, bytes: &[u8]| {
        let path = folder.path().join(name);
        fs::write(&path, bytes).unwrap();
        output::read(&path).unwrap_err()
    };
    for header in ["PF 16385 16384 -1 ", "PF 4294967296 4294967296 -1 ", "PF 18446744073709551615 2 -1 "] {
        assert_eq!(refused("a.pfm", header.as_bytes()).kind(), ErrorKind::Unsupported, "{header}");
    }
    for header in
        ["PF 0 1 -1 ", "PF -1 1 -1 ", "PF 1 1 0 ", "PF 1 1 nan ", "P6 1 1 255 ", "PF 99999999999999999999 1 -1 "]
    {
        assert_eq!(refused("a.pfm", header.as_bytes()).kind(), ErrorKind::Io, "{header}");
    }
    // The largest size that is believed, with nothing behind it.
    assert_eq!(refused("a.pfm", b"PF 16384 16384 -1 ").kind(), ErrorKind::Io);

    // A PNG of one pixel whose header is made to say 2^31 - 1 each way, with the checksum to go with it.
    let path = folder.path().join("a.png");
    output::write(&grey(&[1.0]), &path, &WriteOptions::default()).unwrap();
    let mut bytes = fs::read(&path).unwrap();
    bytes[16..24].copy_from_slice(&[0x7f, 0xff, 0xff, 0xff, 0x7f, 0xff, 0xff, 0xff]);
    let checksum = crc32(&bytes[12..29]);
    bytes[29..33].copy_from_slice(&checksum.to_be_bytes());
    assert_eq!(refused("a.png", &bytes).kind(), ErrorKind::Unsupported);

    // An EXR whose header is made to say another size, with the number of chunks to go with it.
    let path = folder.path().join("a.exr");
    output::write(&grey(&[1.0]), &path, &WriteOptions::default()).unwrap();
    let original = fs::read(&path).unwrap();
    let resized = |width: u32, height: u32| {
        let mut bytes = original.clone();
        let mut set = |attribute: &[u8], offset: usize, value: u32| {
            let at = bytes.windows(attribute.len()).position(|window| window == attribute).expect("the attribute");
            // The value follows the name, the type, and its own length in four bytes.
            let at = at + attribute.len() + 4 + offset;
            bytes[at..at + 4].copy_from_slice(&value.to_le_bytes());
        };
        for window in [b"dataWindow\0box2i\0".as_slice(), b"displayWindow\0box2i\0"] {
            set(window, 8, width - 1);
            set(window, 12, height - 1);
        }
        set(b"chunkCount\0int\0", 0, height.div_ceil(16));
        bytes
    };
    assert_eq!(refused("a.exr", &resized(1 << 20, 1 << 20)).kind(), ErrorKind::Unsupported);
    let error = refused("a.exr", &resized(1, 1 << 24));
    assert_eq!(error.kind(), ErrorKind::Io);
    assert!(error.to_string().contains("cannot hold the 1048576 chunks"), "{error}");
}

/// CRC-32 of PNG chunks (ISO 3309), bit by bit.
fn crc32(bytes: &[u8]) -> u32 {
    !bytes.iter().fold(!0_u32, |crc, &byte| {
        (0..8).fold(crc ^ u32::from(byte), |crc, _| if crc & 1 == 1 { crc >> 1 ^ 0xedb8_8320 } else { crc >> 1 })
    })
}

#[test]
fn missing_files_and_folders_are_named() {
    let folder = folder();
    let missing = folder.path().join("missing.exr");
    let error = output::read(&missing).unwrap_err();
    assert_eq!(error.kind(), ErrorKind::Io);
    assert!(error.to_string().contains("missing.exr"), "{error}");

    let nowhere = folder.path().join("no/such/folder/image.png");
    let taken = folder.path().join("taken.png");
    fs::create_dir(&taken).unwrap();
    let file = folder.path().join("file");
    fs::write(&file, "").unwrap();
    for path in [nowhere, taken, file.join("image.pfm")] {
        for error in [
            output::check_target(&path).unwrap_err(),
            output::write(&grey(&[1.0]), &path, &WriteOptions::default()).unwrap_err(),
        ] {
            assert_eq!(error.kind(), ErrorKind::Io, "{error}");
            assert!(error.to_string().contains(path.to_str().unwrap()), "{error}");
        }
    }
    let good = folder.path().join("good.png");
    assert_eq!(output::check_target(&good).unwrap(), Format::Png);
    assert!(!good.exists());
    // The folder and the file made here, and nothing left behind.
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 2);
}

#[cfg(unix)]
#[test]
fn a_new_file_has_ordinary_permissions_and_links_are_followed() {
    use std::os::unix::fs::PermissionsExt;
    let folder = folder();
    let plain = folder.path().join("plain");
    fs::write(&plain, "").unwrap();
    let path = folder.path().join("image.pfm");
    let link = folder.path().join("link.pfm");
    std::os::unix::fs::symlink(&path, &link).unwrap();
    output::write(&grey(&[1.0]), &path, &WriteOptions::default()).unwrap();
    let mode = |path: &Path| fs::metadata(path).unwrap().permissions().mode();
    assert_eq!(mode(&path), mode(&plain));

    output::write(&grey(&[2.0]), &link, &WriteOptions::default()).unwrap();
    assert!(fs::symlink_metadata(&link).unwrap().is_symlink());
    assert_eq!(output::read(&path).unwrap().pixel(0, 0), [2.0; 3]);
}

/// Names the folder that [`write_forever`] writes to, in a process started for it.
const CHILD_FOLDER: &str = "ETENDUE_TEST_CHILD_FOLDER";

/// The two images that the child process writes in turns: 1.2 MB of noise each, so that writing takes a while.
fn child_images() -> [Image; 2] {
    [8, 9].map(|seed| arbitrary_image(160, 160, true, seed))
}

/// Not a test of its own but the child process of those below: writes until it is ended or fails.
#[cfg(unix)]
#[test]
fn write_forever() {
    let Some(folder) = std::env::var_os(CHILD_FOLDER).map(PathBuf::from) else { return };
    let images = child_images();
    for image in images.iter().cycle() {
        for name in ["image.exr", "image.pfm"] {
            if let Err(error) = output::write(image, &folder.join(name), &WriteOptions::default()) {
                println!("child: {error}");
                std::process::exit(3);
            }
        }
    }
}

/// This test binary again, running [`write_forever`], after `setup` in its shell.
#[cfg(unix)]
fn child(folder: &Path, setup: &str) -> std::process::Command {
    let mut command = std::process::Command::new("sh");
    command
        .arg("-c")
        .arg(format!("{setup} exec \"$0\" --exact write_forever --nocapture --test-threads 1"))
        .arg(std::env::current_exe().unwrap())
        .env(CHILD_FOLDER, folder)
        .stdout(std::process::Stdio::piped())
        .stderr(std::process::Stdio::null());
    command
}

#[cfg(unix)]
#[test]
fn a_killed_writer_leaves_a_whole_file() {
    let images = child_images();
    let folder = folder();
    let paths = ["image.exr", "image.pfm"].map(|name| folder.path().join(name));
    for path in &paths {
        output::write(&images[0], path, &WriteOptions::default()).unwrap();
    }
    for round in 0..12 {
        let mut child = child(folder.path(), "").spawn().unwrap();
        std::thread::sleep(std::time::Duration::from_millis(40 + 17 * round));
        child.kill().unwrap();
        child.wait().unwrap();
        for path in &paths {
            let found = output::read(path).unwrap();
            let expected = if found.rgb[5] == images[0].rgb[5] { &images[0] } else { &images[1] };
            let layers = if path.extension().unwrap() == "exr" { expected.layers.clone() } else { Vec::new() };
            assert_same_bits(&found, &Image { layers, ..expected.clone() });
        }
    }
}

#[cfg(unix)]
#[test]
fn a_full_disk_leaves_the_old_file() {
    use std::os::unix::process::ExitStatusExt;
    let folder = folder();
    let old = grey(&[0.25, 0.5]);
    let path = folder.path().join("image.exr");
    let names = || {
        let mut names: Vec<_> = fs::read_dir(folder.path()).unwrap().map(|entry| entry.unwrap().file_name()).collect();
        names.sort();
        names
    };

    // A limit of 64 blocks (32 KiB) per file stands for a disk that is full: the write fails in its middle.
    output::write(&old, &path, &WriteOptions::default()).unwrap();
    let outcome = child(folder.path(), "trap '' XFSZ; ulimit -f 64;").output().unwrap();
    let stdout = String::from_utf8_lossy(&outcome.stdout);
    assert_eq!(outcome.status.code(), Some(3), "{stdout}");
    assert!(stdout.contains("image.exr: cannot write the image"), "{stdout}");
    assert_eq!(output::read(&path).unwrap(), old);
    assert_eq!(names(), ["image.exr"], "the unfinished file is removed");

    // Without the trap the signal ends the process at that very write.
    let outcome = child(folder.path(), "ulimit -f 64;").output().unwrap();
    assert!(outcome.status.signal().is_some(), "{:?}", outcome.status);
    assert_eq!(output::read(&path).unwrap(), old);
    assert_eq!(names().len(), 2, "the old file, and the one that the killed process was writing");
}

#[test]
fn metrics_agree_with_values_computed_by_hand() {
    let image = |rgb: [f32; 6]| Image { width: 1, height: 2, rgb: rgb.to_vec(), layers: Vec::new() };
    let a = image([1.0, 2.0, 3.0, 4.0, 5.0, 6.0]);
    let b = image([1.0, 1.0, 3.0, 4.0, 2.0, 8.0]);
    let metrics = output::compare(&a, &b).unwrap();
    // Squares of the differences 0, 1, 0, 0, 3, -2.
    assert!((metrics.mse - 14.0 / 6.0).abs() < 1e-15);
    assert!((metrics.rel_mse - (1.0 / 1.01 + 9.0 / 4.01 + 4.0 / 64.01) / 6.0).abs() < 1e-15);
    assert!((metrics.psnr - 10.0 * (64.0_f64 * 6.0 / 14.0).log10()).abs() < 1e-13);
    assert_eq!((metrics.max_abs_difference, metrics.max_at), (3.0, [0, 1]));
    assert_eq!(metrics.mean_a, [2.5, 3.5, 4.5]);
    assert_eq!(metrics.mean_b, [2.5, 1.5, 5.5]);
    assert_eq!(metrics.ratio, [1.0, 3.5 / 1.5, 4.5 / 5.5]);
    assert_eq!(metrics.non_finite, 0);

    // The reference is the second.
    let swapped = output::compare(&b, &a).unwrap();
    assert_eq!(swapped.mse, metrics.mse);
    assert!((swapped.rel_mse - (1.0 / 4.01 + 9.0 / 25.01 + 4.0 / 36.01) / 6.0).abs() < 1e-15);
}

#[test]
fn metrics_of_equal_and_of_broken_images() {
    let a = grey(&[0.5, 1.0]);
    let same = output::compare(&a, &a).unwrap();
    assert_eq!((same.mse, same.rel_mse, same.max_abs_difference, same.max_at), (0.0, 0.0, 0.0, [0, 0]));
    assert_eq!((same.psnr, same.ratio), (f64::INFINITY, [1.0; 3]));

    // A pixel that is broken in either image counts in neither.
    let metrics = output::compare(&grey(&[0.5, f32::NAN, 2.0]), &grey(&[1.0, 1.0, f32::INFINITY])).unwrap();
    assert_eq!((metrics.non_finite, metrics.mse, metrics.mean_b), (2, 0.25, [1.0; 3]));
    let nothing = output::compare(&grey(&[f32::NAN]), &grey(&[1.0])).unwrap();
    assert!(nothing.mse.is_nan() && nothing.psnr.is_nan() && nothing.max_abs_difference.is_nan());

    let error = output::compare(&grey(&[1.0; 3]), &grey(&[1.0; 2])).unwrap_err();
    assert_eq!(error.kind(), ErrorKind::InvalidScene);
    assert!(error.to_string().contains("3 x 1 and 2 x 1"), "{error}");
}
