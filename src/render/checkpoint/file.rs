//! The file of a checkpoint: a header in JSON and blocks of bytes, each with a checksum.
//!
//! | bytes | what |
//! |---|---|
//! | 8 | [`MAGIC`] |
//! | 4 | version of the format |
//! | 4 | length of the header |
//! | | the header, JSON in UTF-8 |
//! | 4 | CRC-32 of all of the above |
//! | | blocks: 4 bytes of the number, the contents, 4 bytes of the CRC-32 of both |
//!
//! Blocks are tiles with samples, in the order of their numbers; for an adaptive render the rows of what each pixel had and is to get,
//! numbered from [`ROWS`] on; for progressive photon maps blocks of what is known of the surface, numbered from [`CELLS`] on; and last a
//! block [`END`] with the number of blocks before it. Numbers are little-endian. Nothing follows.

use std::io::{Read, Write};

use super::super::adaptive::Stage;
use super::header::{Header, PhotonHeader};
use super::{Checkpoint, damaged, no_memory};
use crate::desc::elided;
use crate::error::{Error, ErrorKind, Result};
use crate::film::{Film, FilmOptions};
use crate::integrator::photon::PlanState;

/// The first bytes of a checkpoint. The first is no ASCII, and the last ones show when line ends were changed on the way.
const MAGIC: [u8; 8] = *b"\x89ETD\r\n\x1a\n";

/// Version of the format that is written and read.
const VERSION: u32 = 1;

/// Longest header that is read.
const MOST_HEADER: u32 = 1 << 20;

/// Numbers of the first block of an adaptive render's rows, of the first one of cells, and of the last block. The level of cells is the
/// number of their block over [`BLOCKS_A_LEVEL`].
const ROWS: u32 = 1 << 30;
const CELLS: u32 = 1 << 31;
const END: u32 = u32::MAX;
const BLOCKS_A_LEVEL: u32 = 1 << 16;

/// Most cells in a block, each of 9 bytes.
const CELLS_A_BLOCK: usize = 1 << 12;

/// Writes a checkpoint.
pub(super) fn write(checkpoint: &Checkpoint, out: &mut dyn Write) -> Result<()> {
    let Checkpoint { header, film, stage, photons } = checkpoint;
    let header = Header { photons: photons.as_ref().map(PhotonHeader::from), ..header.clone() };
    let failed = |error| Error::new(ErrorKind::Io, format!("cannot write the checkpoint: {error}")).because(error);
    let text = serde_json::to_vec(&header)
        .map_err(|error| Error::new(ErrorKind::Internal, format!("the header is no JSON: {error}")))?;
    let mut bytes = Vec::from(MAGIC);
    bytes.extend(VERSION.to_le_bytes());
    bytes.extend((text.len() as u32).to_le_bytes());
    bytes.extend(text);
    let mut blocks = 0_u64;
    let mut put = |bytes: &mut Vec<u8>| {
        bytes.extend(crc32fast::hash(bytes).to_le_bytes());
        let written = out.write_all(bytes);
        bytes.clear();
        written.map_err(failed)
    };
    put(&mut bytes)?;
    for tile in 0..film.tile_count() {
        bytes.extend((tile as u32).to_le_bytes());
        if film.put_tile(tile, &mut bytes) {
            put(&mut bytes)?;
            blocks += 1;
        }
        bytes.clear();
    }
    if let Some(stage) = stage {
        let width = film.options().resolution[0] as usize;
        for (row, counts) in (ROWS..).zip(stage.rows(width)) {
            bytes.extend(row.to_le_bytes());
            counts.into_iter().flatten().for_each(|count| bytes.extend(count.to_le_bytes()));
            put(&mut bytes)?;
            blocks += 1;
        }
    }
    if let Some(PlanState { coverage, .. }) = photons {
        for (level, (_, cells)) in (0..).zip(coverage.parts().1) {
            for (number, cells) in (CELLS + level * BLOCKS_A_LEVEL..).zip(cells.chunks(CELLS_A_BLOCK)) {
                bytes.extend(number.to_le_bytes());
                bytes.extend((cells.len() as u32).to_le_bytes());
                for (key, is_covered) in cells {
                    bytes.extend(key.to_le_bytes());
                    bytes.push((*is_covered).into());
                }
                put(&mut bytes)?;
                blocks += 1;
            }
        }
    }
    bytes.extend(END.to_le_bytes());
    bytes.extend(blocks.to_le_bytes());
    put(&mut bytes)
}

/// What is read, piece by piece with its checksum.
struct Source<'r> {
    input: &'r mut dyn Read,
    bytes: Vec<u8>,
}

impl Source<'_> {
    /// Reads `count` more bytes of the present piece. Memory grows with what is there, whatever number a file names.
    fn more(&mut self, count: usize) -> Result<&[u8]> {
        let before = self.bytes.len();
        self.bytes.try_reserve(count.min(1 << 20)).map_err(no_memory)?;
        let read = self.input.take(count as u64).read_to_end(&mut self.bytes);
        match read {
            Ok(read) if read == count => Ok(&self.bytes[before..]),
            Ok(_) => Err(damaged("it ends early")),
            Err(error) => Err(Error::new(ErrorKind::Io, format!("cannot read the checkpoint: {error}")).because(error)),
        }
    }

    fn u32(&mut self) -> Result<u32> {
        let bytes = self.more(4)?;
        Ok(bytes.try_into().map_or(0, u32::from_le_bytes))
    }

    /// Reads the checksum of the piece, and begins the next one. Returns the bytes of the piece.
    fn end(&mut self) -> Result<Vec<u8>> {
        let sum = crc32fast::hash(&self.bytes);
        if self.u32()? != sum {
            return Err(damaged("a checksum does not match"));
        }
        self.bytes.truncate(self.bytes.len() - 4);
        Ok(std::mem::take(&mut self.bytes))
    }
}

/// Reads a checkpoint. `admit` hears of the film before there is room for it, and may refuse it.
pub(super) fn read(input: &mut dyn Read, admit: &mut dyn FnMut(&FilmOptions) -> Result<()>) -> Result<Checkpoint> {
    let mut source = Source { input, bytes: Vec::new() };
    if source.more(MAGIC.len()).is_ok_and(|bytes| bytes != MAGIC) {
        return Err(Error::new(ErrorKind::InvalidScene, "this is no checkpoint of a render"));
    }
    let version = source.u32()?;
    if version != VERSION {
        let message = format!("the checkpoint has version {version} of the format; expected {VERSION}");
        return Err(Error::new(ErrorKind::Unsupported, message));
    }
    let length = source.u32()?;
    if length > MOST_HEADER {
        return Err(damaged(&format!("a header of {length} bytes")));
    }
    source.more(length as usize)?;
    let bytes = source.end()?;
    let header: Header = serde_json::from_slice(&bytes[MAGIC.len() + 8..])
        .map_err(|error| damaged(&format!("its header is not as expected: {}", elided(&error.to_string()))))?;
    let options = header.film_options()?;
    admit(&options)?;
    let film = Film::new(options)?;
    let [width, height] = film.options().resolution;
    let (mut blocks, mut least) = (0_u64, 0);
    let mut stage = header.stage.map(Stage::empty);
    let mut photons = header.photons.as_ref().map(PhotonHeader::state).transpose()?;
    loop {
        let number = source.u32()?;
        if number == END {
            let told = source.more(8)?.try_into().map_or(0, u64::from_le_bytes);
            if told != blocks {
                return Err(damaged("blocks are missing"));
            }
            break;
        }
        if number < least {
            return Err(damaged("its blocks are not in their order"));
        }
        match (&mut stage, number.checked_sub(ROWS)) {
            (_, None) if (number as usize) < film.tile_count() => {
                source.more(film.tile_bytes(number as usize))?;
                let bytes = source.end()?;
                if film.get_tile(number as usize, &bytes[4..]).is_none() {
                    return Err(damaged(&format!("tile {number} has numbers that no render comes to")));
                }
            }
            (Some(stage), Some(row)) if row < height && stage.pixel_count() == row as usize * width as usize => {
                source.more(8 * width as usize)?;
                let bytes = source.end()?;
                let (counts, _) = bytes[4..].as_chunks::<4>();
                let counts: Vec<u32> = counts.iter().map(|count| u32::from_le_bytes(*count)).collect();
                let (from, to) = counts.split_at(width as usize);
                if !stage.push_row([from, to]) {
                    return Err(damaged(&format!("row {row} has numbers that no render comes to")));
                }
            }
            _ if number >= CELLS => {
                let count = source.u32()? as usize;
                if count > CELLS_A_BLOCK {
                    return Err(damaged(&format!("a block of {count} cells")));
                }
                source.more(9 * count)?;
                let bytes = source.end()?;
                let (cells, _) = bytes[8..].as_chunks::<9>();
                let cell = |&[key @ .., is_covered]: &[u8; 9]| (u64::from_le_bytes(key), is_covered != 0);
                let level = ((number - CELLS) / BLOCKS_A_LEVEL) as usize;
                let is_known = photons
                    .as_mut()
                    .is_some_and(|PlanState { coverage, .. }| coverage.add_cells(level, cells.iter().map(cell)));
                if !is_known {
                    return Err(damaged(&format!("it has a block {number}")));
                }
            }
            _ => return Err(damaged(&format!("it has a block {number}"))),
        }
        blocks += 1;
        least = number + 1;
    }
    source.end()?;
    if stage.as_ref().is_some_and(|stage| stage.pixel_count() != width as usize * height as usize) {
        return Err(damaged("rows are missing"));
    }
    if source.input.read(&mut [0]).unwrap_or(1) != 0 {
        return Err(damaged("something follows its end"));
    }
    Ok(Checkpoint { header, film: film.into(), stage: stage.map(Into::into), photons })
}
