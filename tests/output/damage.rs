//! Files and folders that are missing, cut short, damaged or lying give errors that name them, and no harm.

use std::fs;
use std::path::Path;

use etendue::ErrorKind;
use etendue::output::{self, Format, WriteOptions};

use super::{Words, arbitrary_image, folder, grey};

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
