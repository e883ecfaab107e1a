//! OpenEXR. Files are written with one part and all layers. Files of other programs can be read too, within limits.

use std::collections::BTreeMap;
use std::fs::File;
use std::io::{self, BufRead as _, BufReader, BufWriter, Read, Seek, SeekFrom, Write as _};
use std::panic::{AssertUnwindSafe, catch_unwind, resume_unwind};
use std::thread;

use ::exr::block::chunk::Chunk;
use ::exr::block::reader::{ChunksReader as _, Reader};
use ::exr::block::writer::ChunksWriter as _;
use ::exr::block::{BlockIndex, UncompressedBlock};
use ::exr::compression::Compression;
use ::exr::image::read::image::{LayersReader as _, ReadLayers as _};
use ::exr::image::read::layers::ReadChannels as _;
use ::exr::image::write::WritableImage as _;
use ::exr::image::write::layers::{LayersWriter as _, WritableLayers as _};
use ::exr::image::{
    AnyChannel, AnyChannels, Blocks, Encoding, FlatImage, FlatSamples, Image as ExrImage, Layer as ExrLayer,
};
use ::exr::meta::attribute::{AttributeValue, Chromaticities, IntegerBounds, LineOrder, Text};
use ::exr::meta::header::{Header, LayerAttributes};
use ::exr::prelude::Vec2;

use super::check::{MAX_PIXELS, check_size, damaged};
use super::dwa;
use super::pixels::{Image, Layer, Placement};
use crate::room::check_room;
use crate::spectrum::Primaries;
use crate::{Error, ErrorKind, Result};

/// Most values of all channels of all parts of a file together: 4 GiB.
const MAX_VALUES: u64 = 4 * MAX_PIXELS;

/// Order of the layers that this library writes; others follow by name.
const LAYER_ORDER: [&str; 8] = ["albedo", "normal", "depth", "emission", "direct", "indirect", "samples", "variance"];

/// Channel suffixes of a layer, as readers expect them.
fn suffixes(layer: &Layer) -> &'static [&'static str] {
    match (layer.name.as_str(), layer.channels) {
        ("normal", 3) => &["X", "Y", "Z"],
        (_, 3) => &["R", "G", "B"],
        (_, 4) => &["R", "G", "B", "A"],
        ("depth", _) => &["Z"],
        _ => &["Y"],
    }
}

/// What begins the name of a layer that holds one band of a spectrum, and the layer that other programs see all of them in.
const SPECTRUM: &str = "S0.";

/// The name of a channel of a layer: bands of a spectrum are channels by themselves.
fn channel_name(layer: &Layer, suffix: &str) -> String {
    if layer.channels == 1 && layer.name.starts_with(SPECTRUM) {
        return layer.name.clone();
    }
    format!("{}.{suffix}", layer.name)
}

/// A value of an image's header.
#[derive(Clone, Debug, PartialEq)]
pub enum Attribute {
    /// An EXR `double`.
    Number(f64),
    /// An EXR `string`, UTF-8.
    Text(String),
}

/// What a header says beside what the image says.
#[derive(Clone, Copy)]
pub(crate) struct Heading<'a> {
    /// Free text; empty for none.
    pub comments: &'a str,
    /// Further attributes; those that are not finite are left out.
    pub attributes: &'a [(String, Attribute)],
    /// The primaries of the image's colours.
    pub primaries: Primaries,
}

/// Writes all channels as 32-bit floats, compressed by so many threads. `image` has been checked.
pub(crate) fn encode(
    image: &Image,
    heading: &Heading<'_>,
    threads: usize,
    file: &mut BufWriter<&mut File>,
) -> Result<()> {
    let &Heading { comments, attributes, primaries } = heading;
    let plane = |data: &[f32], channels: usize, channel: usize| {
        FlatSamples::F32(data.iter().skip(channel).step_by(channels).copied().collect())
    };
    let mut channels = Vec::new();
    for (channel, name) in ["R", "G", "B"].into_iter().enumerate() {
        channels.push(AnyChannel::new(name, plane(&image.rgb, 3, channel)));
    }
    for layer in &image.layers {
        for (channel, suffix) in suffixes(layer).iter().enumerate() {
            let name = text(&channel_name(layer, suffix));
            channels.push(AnyChannel::new(name, plane(&layer.data, layer.channels, channel)));
        }
    }

    let attributes = LayerAttributes {
        software_name: Some(text(concat!("etendue ", env!("CARGO_PKG_VERSION")))),
        comments: Some(comments).filter(|comments| !comments.is_empty()).map(text),
        other: attributes.iter().filter_map(attribute).collect(),
        ..LayerAttributes::default()
    };
    let size = [image.width, image.height];
    encode_layer(channels, (size, image.placement), (attributes, primaries), threads, file)
}

/// Writes channels as they are, compressed without loss by so many threads.
pub(crate) fn encode_channels(
    channels: Vec<AnyChannel<FlatSamples>>,
    size: [u32; 2],
    threads: usize,
    file: &mut BufWriter<&mut File>,
) -> Result<()> {
    encode_layer(channels, (size, None), (LayerAttributes::default(), Primaries::Rec709), threads, file)
}

fn encode_layer(
    channels: Vec<AnyChannel<FlatSamples>>,
    ([width, height], placement): ([u32; 2], Option<Placement>),
    (mut attributes, primaries): (LayerAttributes, Primaries),
    threads: usize,
    file: &mut BufWriter<&mut File>,
) -> Result<()> {
    let size = Vec2(width as usize, height as usize);
    if let Some(Placement { origin: [left, top], .. }) = placement {
        attributes.layer_position = Vec2(left as i32, top as i32);
    }
    let channels = AnyChannels::sort(channels.into_iter().collect());
    let encoding =
        Encoding { compression: Compression::ZIP16, blocks: Blocks::ScanLines, line_order: LineOrder::Increasing };
    let mut file_image = ExrImage::from_layer(ExrLayer::new(size, attributes, encoding, channels));
    if let Some(Placement { picture: [width, height], pixel_aspect, .. }) = placement {
        // The display window is the picture, and the data window is the part of it that the file has.
        file_image.attributes.display_window =
            IntegerBounds { position: Vec2(0, 0), size: Vec2(width as usize, height as usize) };
        file_image.attributes.pixel_aspect = pixel_aspect;
    }
    let [red, green, blue, white] = primaries.chromaticities().map(|[x, y]| Vec2(x, y));
    file_image.attributes.chromaticities = Some(Chromaticities { red, green, blue, white });
    let headers = file_image.write().infer_meta_data();
    let layers = file_image.layer_data.create_writer(&headers);
    ::exr::block::write(&mut *file, headers, true, |meta, chunks| {
        let block = |index| UncompressedBlock { index, data: layers.extract_uncompressed_block(&meta.headers, index) };
        let compress = |index| block(index).compress_to_chunk(&meta.headers);
        let mut blocks = ::exr::block::enumerate_ordered_header_block_indices(&meta.headers);
        loop {
            let batch: Vec<_> = blocks.by_ref().take(threads).collect();
            if batch.is_empty() {
                return Ok(());
            }
            for (number, chunk) in in_parallel(&batch, &compress) {
                chunks.write_chunk(number, chunk?)?;
            }
        }
    })
    .map_err(|error| match error {
        ::exr::error::Error::Io(error) => {
            Error::new(ErrorKind::Io, format!("cannot write the image: {error}")).because(error)
        }
        error => Error::new(ErrorKind::Internal, format!("cannot write the image: {error}")).because(error),
    })?;
    sort_attributes(file)
        .map_err(|error| Error::new(ErrorKind::Io, format!("cannot write the image: {error}")).because(error))
}

/// Sorts the attributes of the header by name. The crate writes them in the order of a hash map, which differs every
/// time, and the same image must give the same file.
fn sort_attributes(file: &mut BufWriter<&mut File>) -> io::Result<()> {
    /// Magic number and version.
    const BEFORE: u64 = 8;
    file.flush()?;
    let file = file.get_mut();
    file.seek(SeekFrom::Start(BEFORE))?;
    let mut reader = BufReader::new(&mut **file);
    let mut attributes = Vec::new();
    loop {
        let mut attribute = Vec::new();
        reader.read_until(0, &mut attribute)?;
        // An empty name is the end.
        if attribute.len() <= 1 {
            break;
        }
        reader.read_until(0, &mut attribute)?;
        let mut size = [0; 4];
        reader.read_exact(&mut size)?;
        attribute.extend(size);
        reader.by_ref().take(u32::from_le_bytes(size).into()).read_to_end(&mut attribute)?;
        attributes.push(attribute);
    }
    attributes.sort();
    file.seek(SeekFrom::Start(BEFORE))?;
    file.write_all(&attributes.concat())?;
    file.seek(SeekFrom::End(0)).map(drop)
}

/// The attribute in the format's form; `None` for a number that is not finite.
fn attribute((name, value): &(String, Attribute)) -> Option<(Text, AttributeValue)> {
    let value = match value {
        Attribute::Number(number) => AttributeValue::F64(Some(*number).filter(|number| number.is_finite())?),
        Attribute::Text(string) => AttributeValue::Text(text(string)),
    };
    Some((text(name), value))
}

/// Compresses these blocks in parallel: the first on this thread, the others on one thread each. All have ended on
/// return.
///
/// The crate's own way creates a pool of threads for each image, which outlives it for a moment, and one panic in the
/// pool ends the program.
fn in_parallel(
    batch: &[(usize, BlockIndex)],
    compress: &(impl Fn(BlockIndex) -> ::exr::error::Result<Chunk> + Sync),
) -> Vec<(usize, ::exr::error::Result<Chunk>)> {
    thread::scope(|scope| {
        let helpers: Vec<_> = batch
            .iter()
            .skip(1)
            .map(|&(_, index)| thread::Builder::new().spawn_scoped(scope, move || compress(index)))
            .collect();
        let mut chunks: Vec<_> = batch.iter().take(1).map(|&(number, index)| (number, compress(index))).collect();
        for (&(number, index), helper) in batch.iter().skip(1).zip(helpers) {
            let chunk = match helper {
                Ok(helper) => helper.join().unwrap_or_else(|payload| resume_unwind(payload)),
                // The thread could not be started.
                Err(_) => compress(index),
            };
            chunks.push((number, chunk));
        }
        chunks
    })
}

/// EXR strings are bytes; other programs write UTF-8.
fn text(string: &str) -> Text {
    Text::from_slice_unchecked(string.as_bytes())
}

/// Reads the image and its layers. `file_size` in bytes limits the sizes that a header may claim.
pub(super) fn decode(reader: impl Read + Seek, file_size: u64) -> Result<Image> {
    collect(decode_parts(reader, file_size)?)
}

/// Reads all parts with their channels as they are stored, within the limits of [`decode`].
pub(crate) fn decode_parts(reader: impl Read + Seek, file_size: u64) -> Result<FlatImage> {
    // The decoder checks what it reads, and still indexes and unwraps in places: a damaged file must not end the
    // program. It runs on this thread for the same reason, since a panic in a thread pool aborts.
    catch_unwind(AssertUnwindSafe(|| {
        let reader = ::exr::block::read(reader, false).map_err(unreadable)?;
        check_headers(reader.headers(), file_size)?;
        read_blocks(reader).map_err(unreadable)
    }))
    .unwrap_or_else(|_| Err(damaged("its decoder failed")))
}

/// Reads the pixels of all parts. The crate's own loop over the blocks leaves no place to check them.
fn read_blocks(reader: Reader<impl Read + Seek>) -> ::exr::error::Result<FlatImage> {
    let all = ::exr::image::read::read().no_deep_data().largest_resolution_level().all_channels().all_layers();
    let mut layers = all.create_layers_reader(reader.headers())?;
    let attributes = reader.headers().first().map(|header| header.shared_attributes.clone());
    let mut chunks = reader.filter_chunks(false, |meta, tile, block| layers.filter_block(meta, tile, block))?;
    while let Some(chunk) = chunks.read_next_chunk() {
        let chunk = chunk?;
        let meta = chunks.meta_data();
        dwa::check_counters(&meta.headers, &chunk)?;
        layers.read_block(&meta.headers, UncompressedBlock::decompress_chunk(chunk, meta, false)?)?;
    }
    let attributes = attributes.ok_or_else(|| ::exr::error::Error::Invalid("no header".into()))?;
    Ok(FlatImage { attributes, layer_data: layers.into_layers() })
}

fn unreadable(error: ::exr::error::Error) -> Error {
    match error {
        ::exr::error::Error::NotSupported(what) => {
            Error::new(ErrorKind::Unsupported, format!("cannot read the image: {what}"))
        }
        error => damaged(&error).because(error),
    }
}

/// Limits memory before any is allocated.
fn check_headers(headers: &[Header], file_size: u64) -> Result<()> {
    let (mut values, mut most_pixels) = (0_u64, 0);
    for header in headers {
        let Vec2(width, height) = header.layer_size;
        let (width, height) = check_size(width as u64, height as u64)?;
        most_pixels = most_pixels.max(u64::from(width) * u64::from(height));
        // Each chunk has an offset of eight bytes in a table near the start of the file.
        if header.chunk_count as u64 > file_size / 8 {
            return Err(damaged(format!(
                "{file_size} bytes cannot hold the {} chunks of its header",
                header.chunk_count
            )));
        }
        let channels = header.channels.list.len() as u64;
        values = values.saturating_add((u64::from(width) * u64::from(height)).saturating_mul(channels));
        if header.channels.list.iter().any(|channel| channel.sampling != Vec2(1, 1)) {
            return Err(Error::new(ErrorKind::Unsupported, "cannot read the image: it has subsampled channels"));
        }
    }
    if values > MAX_VALUES {
        let message = format!("its channels have {values} values, more than the {MAX_VALUES} that are read");
        return Err(Error::new(ErrorKind::Unsupported, message));
    }
    // The crate ends the process where there is no room. Beside all channels, those of one image are put together.
    check_room((values * size_of::<f32>() as u64 + most_pixels * size_of::<[f32; 4]>() as u64) as usize)
}

/// Channels of one layer, by suffix.
type Group = BTreeMap<String, Vec<f32>>;

/// Sorts the channels of all parts into the image and its layers.
fn collect(file: FlatImage) -> Result<Image> {
    let several = file.layer_data.len() > 1;
    let (display, pixel_aspect) = (file.attributes.display_window, file.attributes.pixel_aspect);
    let mut position = Vec2(0, 0);
    let mut size = None;
    let mut rgb = None;
    let mut groups = BTreeMap::<String, (Vec2<usize>, Group)>::new();
    let mut names = Vec::new();
    for part in file.layer_data {
        let part_name = part.attributes.layer_name.as_ref().filter(|_| several).map(utf8);
        let mut plain = Group::new();
        for channel in part.channel_data.list {
            let name = utf8(&channel.name);
            names.push(name.clone());
            let data = to_f32(channel.sample_data);
            // Each band of a spectrum is a layer.
            let split = if name.starts_with(SPECTRUM) { Some((&*name, "Y")) } else { name.rsplit_once('.') };
            match split {
                Some((layer, suffix)) => {
                    let (_, group) = groups.entry(layer.to_owned()).or_insert_with(|| (part.size, Group::new()));
                    group.insert(suffix.to_owned(), data);
                }
                None => {
                    plain.insert(name, data);
                }
            }
        }
        // The first part with colour and no layer's name in its channels is the image.
        if rgb.is_none() {
            rgb = interleave(&mut plain, &["R", "G", "B"])
                .or_else(|| plain.remove("Y").map(|grey| grey.into_iter().flat_map(|value| [value; 3]).collect()));
            size = rgb.as_ref().map(|_| part.size);
            position = part.attributes.layer_position;
        } else if let Some(name) = part_name {
            groups.entry(name).or_insert((part.size, plain));
        }
    }

    let (Some(Vec2(width, height)), Some(rgb)) = (size, rgb) else {
        names.truncate(8);
        let message = format!("it has no channels R, G, B of its own, but {}", names.join(", "));
        return Err(Error::new(ErrorKind::Unsupported, message));
    };
    let mut layers = Vec::new();
    for (name, (group_size, mut group)) in groups {
        if Some(group_size) != size {
            continue;
        }
        let layer = |channels, data| Layer { name, channels, data };
        if let Some(data) = interleave(&mut group, &["R", "G", "B", "A"]) {
            layers.push(layer(4, data));
        } else if let Some(data) =
            interleave(&mut group, &["R", "G", "B"]).or_else(|| interleave(&mut group, &["X", "Y", "Z"]))
        {
            layers.push(layer(3, data));
        } else if let (1, Some((_, data))) = (group.len(), group.pop_first()) {
            layers.push(layer(1, data));
        }
    }
    let rank = |layer: &Layer| LAYER_ORDER.iter().position(|name| *name == layer.name).unwrap_or(LAYER_ORDER.len());
    layers.sort_by_key(rank);
    let (width, height) = check_size(width as u64, height as u64)?;
    let placement = placement(display, pixel_aspect, position, [width, height]);
    Ok(Image { width, height, rgb, layers, placement })
}

/// Where an image lies in its picture, the display window. An image that is not inside of it, as one with more around the picture
/// is, counts as a picture of its own.
fn placement(
    display: IntegerBounds,
    pixel_aspect: f32,
    position: Vec2<i32>,
    [width, height]: [u32; 2],
) -> Option<Placement> {
    let pixel_aspect = if pixel_aspect > 0.0 && pixel_aspect.is_finite() { pixel_aspect } else { 1.0 };
    let inside = |from: i32, start: i32, length: u32, whole: usize| {
        let offset = i64::from(from) - i64::from(start);
        let is_inside = offset >= 0 && offset + i64::from(length) <= i64::try_from(whole).unwrap_or(i64::MAX);
        Some((u32::try_from(offset).ok()?, u32::try_from(whole).ok()?)).filter(|_| is_inside)
    };
    let across = inside(position.0, display.position.0, width, display.size.0);
    let down = inside(position.1, display.position.1, height, display.size.1);
    let (origin, picture) = match (across, down) {
        (Some((left, columns)), Some((top, rows))) => ([left, top], [columns, rows]),
        _ => ([0; 2], [width, height]),
    };
    let placement = Placement { origin, picture, pixel_aspect };
    (pixel_aspect != 1.0 || picture != [width, height]).then_some(placement)
}

/// Takes channels out of a group, with their values of a pixel one after another; `None`, and the group as it was, where one is missing.
fn interleave<const N: usize>(group: &mut Group, suffixes: &[&str; N]) -> Option<Vec<f32>> {
    if !suffixes.iter().all(|suffix| group.contains_key(*suffix)) {
        return None;
    }
    let planes = suffixes.map(|suffix| group.remove(suffix).unwrap_or_default());
    let count = planes.iter().map(Vec::len).min().unwrap_or(0);
    Some((0..count).flat_map(|i| std::array::from_fn::<f32, N, _>(|channel| planes[channel][i])).collect())
}

fn utf8(text: &Text) -> String {
    String::from_utf8_lossy(text.as_slice()).into_owned()
}

fn to_f32(samples: FlatSamples) -> Vec<f32> {
    match samples {
        FlatSamples::F32(data) => data,
        FlatSamples::F16(data) => data.into_iter().map(|value| value.to_f32()).collect(),
        FlatSamples::U32(data) => data.into_iter().map(|value| value as f32).collect(),
    }
}
