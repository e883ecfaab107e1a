//! Blocks that are compressed with DWAA or DWAB, OpenEXR's lossy compressions by cosine transforms of 8 x 8 pixels.
//!
//! The library decodes them. Before it does, what a block says of its own sizes has to be checked here: the library
//! takes as much memory as the block asks for, and memory that the system does not have ends the program.

use ::exr::block::chunk::{Chunk, CompressedBlock};
use ::exr::compression::Compression;
use ::exr::error::{Error, UnitResult};
use ::exr::math::Vec2;
use ::exr::meta::header::Header;

/// Counters at the start of a block, of 64 bits each, the lowest byte first: version; bytes of the channels that are
/// stored without loss, before and after compression; compressed bytes of AC coefficients, of DC coefficients, and of
/// run lengths; bytes of run lengths, and of what they stand for; numbers of AC and of DC coefficients; compression of
/// the AC coefficients.
const COUNTERS: usize = 11;

/// Refuses a block with more values than its pixels can have, or with too few for a channel. Other compressions have no such counters.
pub(super) fn check_counters(headers: &[Header], chunk: &Chunk) -> UnitResult {
    let Some(header) = headers.get(chunk.layer_index) else { return Ok(()) };
    let (Compression::DWAA(_) | Compression::DWAB(_)) = header.compression else { return Ok(()) };
    let data = match &chunk.compressed_block {
        CompressedBlock::ScanLine(block) => &block.compressed_pixels_le,
        CompressedBlock::Tile(block) => &block.compressed_pixels_le,
        CompressedBlock::DeepScanLine(_) | CompressedBlock::DeepTile(_) => return Ok(()),
    };
    let block = header.get_block_data_indices(&chunk.compressed_block)?;
    let Vec2(width, height) = header.get_absolute_block_pixel_coordinates(block)?.size;
    let (width, height) = (width as u64, height as u64);
    let bytes = (width * height).saturating_mul(header.channels.bytes_per_pixel as u64);
    let squares = width.div_ceil(8) * height.div_ceil(8);
    let transforms = squares.saturating_mul(header.channels.list.len() as u64);
    // A block that would have become larger is stored as it is. One that is too short for its counters is found so by
    // the decoder.
    let (counters, _) = data.as_chunks::<8>();
    let Some(counters) = counters.first_chunk::<COUNTERS>().filter(|_| data.len() as u64 != bytes) else {
        return Ok(());
    };
    let [_, lossless, _, _, _, _, runs, unpacked, ac, dc, _] = counters.map(u64::from_le_bytes);
    let limits = [
        ("bytes without loss", lossless, bytes),
        // A run of a single byte takes two.
        ("bytes of run lengths", runs, bytes.saturating_mul(2)),
        ("bytes from run lengths", unpacked, bytes),
        ("AC coefficients", ac, transforms.saturating_mul(63)),
        ("DC coefficients", dc, transforms),
    ];
    if let Some((what, count, most)) = limits.into_iter().find(|(_, count, most)| count > most) {
        return Err(Error::Invalid(format!("a block claims {count} {what}, and can have {most}").into()));
    }
    // The decoder takes memory for all squares of a channel before it misses the first of them.
    if !dc.is_multiple_of(squares) {
        let message = format!("a block has {dc} DC coefficients for channels of {squares} squares");
        return Err(Error::Invalid(message.into()));
    }
    Ok(())
}
