//! Each format gives back what was put in, has the documented layout, and reads the variants of other programs.

use std::fs;
use std::path::Path;

use etendue::ErrorKind;
use etendue::film::{Image, Placement};
use etendue::math::DVec3;
use etendue::output::{self, Attribute, Format, ToneMap, WriteOptions};
use etendue::spectrum::{Primaries, srgb_encode};

use super::{Words, arbitrary_image, assert_same_bits, folder};

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
fn exr_is_the_same_for_any_number_of_threads() {
    let folder = folder();
    let path = folder.path().join("image.exr");
    for height in [1, 16, 200] {
        let image = arbitrary_image(33, height, true, 3);
        // The crate keeps them in a hash map, of another order each time.
        let number = |i: u32| (format!("number{i}"), Attribute::Number(f64::from(i)));
        let attributes: Vec<_> = (0..6).map(number).collect();
        let write = |threads| {
            let options = WriteOptions { threads, attributes: attributes.clone(), ..WriteOptions::default() };
            output::write(&image, &path, &options).unwrap();
            fs::read(&path).unwrap()
        };
        let reference = write(1);
        for threads in [0, 2, 5, usize::MAX] {
            assert!(write(threads) == reference, "{threads} threads");
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

/// Colours of files in other primaries are those of the image by the matrix, and the header states the primaries.
#[test]
fn colours_are_written_in_other_primaries() {
    let folder = folder();
    let image = arbitrary_image(3, 2, true, 2);
    for (name, primaries) in Primaries::ALL {
        let options = WriteOptions { primaries, ..WriteOptions::default() };
        let matrix = primaries.from_rec_709();
        for extension in ["exr", "pfm", "png"] {
            let path = folder.path().join(format!("{name}.{extension}"));
            output::write(&image, &path, &options).unwrap();
            let found = output::read(&path).unwrap();
            if extension == "png" {
                let plain = folder.path().join("plain.png");
                output::write(&image, &plain, &WriteOptions::default()).unwrap();
                assert_eq!(found, output::read(&plain).unwrap());
                continue;
            }
            for (found, original) in found.rgb.chunks_exact(3).zip(image.rgb.chunks_exact(3)) {
                let expected = matrix * DVec3::new(original[0].into(), original[1].into(), original[2].into());
                for (found, expected) in found.iter().zip(expected.to_array()) {
                    let close = (f64::from(*found) - expected).abs() <= 1e-6 * expected.abs().max(1e-30);
                    assert!(close || !expected.is_finite() || primaries == Primaries::Rec709, "{name}: {found}");
                }
            }
        }
        let meta = exr::meta::MetaData::read_from_file(folder.path().join(format!("{name}.exr")), true).unwrap();
        let [red, ..] = primaries.chromaticities();
        assert_eq!(meta.headers[0].shared_attributes.chromaticities.unwrap().red, exr::math::Vec2(red[0], red[1]));
    }
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

    let image = Image { width: 1, height: 2, rgb: vec![1.0, 2.0, 3.0, 4.0, 5.0, 6.0], ..Image::default() };
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
    let image = Image { width: 61, height: 43, rgb, ..Image::default() };
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
fn exr_says_where_an_image_lies_in_its_picture() {
    let folder = folder();
    let path = folder.path().join("part.exr");
    let plain = arbitrary_image(5, 20, true, 9);
    for placement in [
        None,
        Some(Placement { origin: [7, 3], picture: [12, 23], pixel_aspect: 1.0 }),
        Some(Placement { origin: [0, 0], picture: [5, 20], pixel_aspect: 1.0667 }),
        Some(Placement { origin: [0, 100], picture: [1000, 600], pixel_aspect: 0.5 }),
    ] {
        let image = Image { placement, ..plain.clone() };
        output::write(&image, &path, &WriteOptions::default()).unwrap();
        assert_same_bits(&output::read(&path).unwrap(), &image);
        assert_eq!(output::read(&path).unwrap().placement, placement);
        let meta = exr::meta::MetaData::read_from_file(&path, false).unwrap();
        let (header, shown) =
            (&meta.headers[0], placement.unwrap_or(Placement { origin: [0; 2], picture: [5, 20], pixel_aspect: 1.0 }));
        let window = header.shared_attributes.display_window;
        assert_eq!([window.position.0, window.position.1], [0, 0]);
        assert_eq!([window.size.0, window.size.1], shown.picture.map(|n| n as usize));
        let position = header.own_attributes.layer_position;
        assert_eq!([position.0, position.1], shown.origin.map(|n| n as i32));
        assert_eq!(header.shared_attributes.pixel_aspect, shown.pixel_aspect);
    }
    let outside = [
        Placement { origin: [8, 3], picture: [12, 23], pixel_aspect: 1.0 },
        Placement { origin: [7, u32::MAX], picture: [12, 23], pixel_aspect: 1.0 },
        Placement { origin: [0, 0], picture: [5, 1 << 31], pixel_aspect: 1.0 },
        Placement { origin: [0, 0], picture: [5, 20], pixel_aspect: 0.0 },
        Placement { origin: [0, 0], picture: [5, 20], pixel_aspect: f32::NAN },
    ];
    for placement in outside.map(Some) {
        let error = output::write(&Image { placement, ..plain.clone() }, &path, &WriteOptions::default()).unwrap_err();
        assert_eq!(error.kind(), ErrorKind::Internal, "{placement:?}");
    }
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
    let mut broken = [Image::default(), good.clone(), good.clone(), good.clone(), good];
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
