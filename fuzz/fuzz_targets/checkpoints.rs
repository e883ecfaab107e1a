//! Any bytes as a checkpoint of a render: they are refused with a message, or have a film that can be developed, judged, merged, written
//! and read again.
//!
//! An even first byte: the rest is the file. An odd one: the rest are pieces, each of two bytes of its length and its contents, of which a
//! file with right checksums is made, as a forger would. The first piece is the header, the others are blocks.

#![no_main]

use etendue::render::Checkpoint;
use libfuzzer_sys::fuzz_target;

/// Most pixels of a film that is looked at: a header may name a picture of 2^26 in a few bytes.
const MOST_PIXELS: u64 = 1 << 16;

/// The file of these pieces.
fn sealed(mut pieces: &[u8]) -> Vec<u8> {
    let mut next = || {
        let (length, rest) = pieces.split_first_chunk::<2>()?;
        let (piece, rest) = rest.split_at(usize::from(u16::from_le_bytes(*length)).min(rest.len()));
        pieces = rest;
        Some(piece)
    };
    let header = next().unwrap_or_default();
    let mut file = b"\x89ETD\r\n\x1a\n\x01\0\0\0".to_vec();
    let mut seal = |from: usize, file: &mut Vec<u8>| file.extend(crc32fast::hash(&file[from..]).to_le_bytes());
    file.extend((header.len() as u32).to_le_bytes());
    file.extend(header);
    seal(0, &mut file);
    let mut blocks = 0_u64;
    while let Some(block) = next() {
        let from = file.len();
        file.extend(block);
        seal(from, &mut file);
        blocks += 1;
    }
    let from = file.len();
    file.extend(u32::MAX.to_le_bytes());
    file.extend(blocks.to_le_bytes());
    seal(from, &mut file);
    file
}

fn written(checkpoint: &Checkpoint) -> Vec<u8> {
    let mut bytes = Vec::new();
    checkpoint.write_to(&mut bytes).expect("memory takes all");
    bytes
}

fuzz_target!(|data: &[u8]| {
    let Some((kind, rest)) = data.split_first() else { return };
    let read = if kind % 2 == 0 { Checkpoint::read_from(rest) } else { Checkpoint::read_from(&sealed(rest)[..]) };
    match read {
        Ok(checkpoint) => {
            let film = checkpoint.film();
            if film.options().resolution.map(u64::from).iter().product::<u64>() > MOST_PIXELS {
                return;
            }
            let image = film.develop();
            assert_eq!(image.rgb.len() as u64, 3 * u64::from(image.width) * u64::from(image.height));
            let _ = (film.rel_mse(), film.display_error(), film.counts());
            let bytes = written(&checkpoint);
            let again = Checkpoint::read_from(&bytes[..]).expect("what was read can be written and read");
            assert!(written(&again) == bytes);
            let twice = Checkpoint::merge(vec![checkpoint.clone(), again]);
            assert!(twice.is_err(), "a part is no two parts");
            match Checkpoint::merge(vec![checkpoint.clone()]) {
                Ok(merged) => {
                    assert!(checkpoint.share().is_some_and(|share| share.count() == 1) && merged.share().is_none());
                    let merged = merged.film().develop();
                    let bits = |values: &[f32]| values.iter().map(|value| value.to_bits()).collect::<Vec<_>>();
                    assert!(bits(&merged.rgb) == bits(&image.rgb));
                }
                Err(error) => assert!(error.kind() != etendue::ErrorKind::Internal, "{error}"),
            }
        }
        Err(error) => {
            assert!(error.kind() != etendue::ErrorKind::Internal, "{error}");
            assert!(!error.message().is_empty() && error.message().len() < 2000, "{error}");
        }
    }
});
