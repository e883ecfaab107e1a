//! Reads meshes from files that other programs made.
//!
//! Wavefront OBJ, PLY and STL are told apart by the name's extension, or by the content where the extension says nothing. All readers
//! have the same limits, check every number before it is used, and allocate only for data that the file has.

mod mtl;
mod mtl_maps;
mod obj;
mod obj_parts;
mod ply;
mod ply_header;
mod ply_values;
pub(super) mod ply_write;
mod stl;
mod stl_text;
mod watched;

use std::collections::HashSet;
use std::io::{self, BufRead as _, Read, Take};
use std::path::Path;

use super::MeshDesc;
use super::file::open;
use super::warnings::warn;
use crate::control::WorkProgress;
use crate::spectrum::srgb_decode;
use crate::{Error, Result};
use watched::WatchedFile;

pub(super) use obj_parts::{Part, Parts};

/// Size of the largest file that is read, 2 GiB.
const SIZE_LIMIT: u64 = 2 << 30;
/// Greatest number of face corners in one file. A corner takes about 30 bytes while reading.
const CORNER_LIMIT: usize = 1 << 27;
/// Length of the longest line. A face of this length has more than a million corners.
const LINE_LIMIT: usize = 16 << 20;

/// What readers of mesh files expect, for messages.
const EXPECTED: &str = "a Wavefront OBJ, PLY or STL file";

/// A file format of meshes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum MeshFormat {
    /// Wavefront OBJ.
    Obj,
    /// The Stanford polygon format, as text or in either byte order.
    Ply,
    /// Stereolithography, as text or binary.
    Stl,
}

impl MeshFormat {
    /// The format that the extension of a name says, in upper or lower case.
    pub fn of_name(file: &Path) -> Option<Self> {
        let extension = file.extension()?.to_str()?.to_ascii_lowercase();
        match extension.as_str() {
            "obj" => Some(Self::Obj),
            "ply" => Some(Self::Ply),
            "stl" => Some(Self::Stl),
            _ => None,
        }
    }

    /// The format of a file whose name says nothing, by its beginning and its size. What is nothing else is taken for
    /// Wavefront OBJ, which has no beginning of its own.
    fn of_content(beginning: &[u8], size: u64) -> Self {
        if beginning.starts_with(b"ply\n") || beginning.starts_with(b"ply\r") {
            Self::Ply
        } else if stl::is_text(beginning) || stl::is_binary_of_size(beginning, size) {
            Self::Stl
        } else {
            Self::Obj
        }
    }
}

/// Checks that a file name is possible.
pub(super) fn check_name(json_path: &str, file: &Path) -> Result<()> {
    let name = file.as_os_str();
    if name.is_empty() {
        return Err(Error::invalid(json_path, format!("the file name is empty, expected {EXPECTED}")));
    }
    if name.as_encoded_bytes().contains(&0) {
        return Err(Error::invalid(json_path, "the file name holds a zero byte"));
    }
    Ok(())
}

/// Reads the mesh in the file at `path`; `json_path` says where the scene names it. `keep_degenerate`: with triangles that name a vertex
/// twice, which is for PLY files alone. Adds warnings only where no error occurs. The bytes of the file are units of `work`.
pub(super) fn load(
    path: &Path,
    json_path: &str,
    keep_degenerate: bool,
    warnings: &mut Vec<String>,
    work: &WorkProgress<'_>,
) -> Result<MeshDesc> {
    let (source, format) = opened(path, json_path, work)?;
    match format {
        MeshFormat::Ply => ply::read(source, keep_degenerate, warnings),
        MeshFormat::Obj | MeshFormat::Stl if keep_degenerate => {
            let message = "degenerate triangles are kept of PLY files alone (`keepDegenerate`), expected such a file";
            Err(Error::invalid(json_path, message).in_file(Some(path), 0))
        }
        MeshFormat::Obj => obj::read(source, None, warnings, work).map(|(mesh, _)| mesh),
        MeshFormat::Stl => stl::read(source, warnings),
    }
}

/// Announces the meshes that a text of JSON names to the work, by the sizes of their files. The text is not understood: what looks like the
/// name of a file that is there counts, once. Without a report of progress nothing is looked at.
pub(super) fn announce(json: &str, base_dir: &Path, work: &WorkProgress<'_>) {
    if !work.is_reported() {
        return;
    }
    let mut seen = HashSet::new();
    for (key, _) in json.match_indices("\"file\"") {
        let value = json[key + "\"file\"".len()..].trim_start().strip_prefix(':');
        let name = value.and_then(|value| serde_json::Deserializer::from_str(value).into_iter::<String>().next());
        if let Some(Ok(name)) = name
            && MeshFormat::of_name(Path::new(&name)).is_some()
            && seen.insert(name.clone())
        {
            announce_file(&base_dir.join(name), work);
        }
    }
}

/// Announces a file to the work by its size. A file that is not there is no matter here.
pub(super) fn announce_file(path: &Path, work: &WorkProgress<'_>) {
    work.expect(path.metadata().map_or(0.0, |it| it.len() as f64));
}

/// Opens a file, and says which format it has.
fn opened<'a, 'p>(
    path: &'a Path,
    json_path: &'a str,
    work: &'a WorkProgress<'p>,
) -> Result<(Source<'a, 'p>, MeshFormat)> {
    let mut source = Source::open(path, json_path, work)?;
    let format = match MeshFormat::of_name(path) {
        Some(format) => format,
        None => source.format()?,
    };
    Ok((source, format))
}

/// Reads the file at `path` and the material libraries that it names, with a part for each material that a face has.
pub(super) fn load_parts(
    path: &Path,
    json_path: &str,
    warnings: &mut Vec<String>,
    work: &WorkProgress<'_>,
) -> Result<Parts> {
    let (source, format) = opened(path, json_path, work)?;
    let other = match format {
        MeshFormat::Obj => return obj_parts::load(source, warnings, work),
        MeshFormat::Ply => "PLY",
        MeshFormat::Stl => "STL",
    };
    let message = format!("a {other} file names no materials, expected a Wavefront OBJ file");
    Err(Error::invalid(json_path, message).in_file(Some(path), 0))
}

/// An open file, and where messages about it come from.
struct Source<'a, 'p> {
    path: &'a Path,
    json_path: &'a str,
    /// Size of the file when it was opened.
    size: u64,
    reader: io::BufReader<Take<WatchedFile<'a, 'p>>>,
}

impl<'a, 'p> Source<'a, 'p> {
    fn open(path: &'a Path, json_path: &'a str, work: &'a WorkProgress<'p>) -> Result<Self> {
        let file = open(path, SIZE_LIMIT).map_err(|error| error.at(json_path))?;
        let size = file.metadata().map_err(|error| Error::io(path, "cannot open the file", error).at(json_path))?.len();
        // The limit is one byte more than allowed, so that a file that grows during reading is distinguished from a file
        // that ends here.
        let reader = io::BufReader::with_capacity(1 << 16, WatchedFile::new(file, work).take(SIZE_LIMIT + 1));
        Ok(Self { path, json_path, size, reader })
    }

    /// The format by the content.
    fn format(&mut self) -> Result<MeshFormat> {
        let (place, size) = (self.place(), self.size);
        let beginning = self.reader.fill_buf().map_err(|error| place.unreadable(error))?;
        Ok(MeshFormat::of_content(beginning, size))
    }

    fn place(&self) -> Place<'a> {
        Place { path: self.path, json_path: self.json_path }
    }
}

/// Where messages come from.
#[derive(Clone, Copy)]
struct Place<'a> {
    path: &'a Path,
    json_path: &'a str,
}

impl Place<'_> {
    /// An error in the file; line 0 where there are no lines.
    fn fail(&self, line: usize, message: impl Into<String>) -> Error {
        Error::invalid(self.json_path, message).in_file(Some(self.path), line)
    }

    fn unreadable(&self, error: io::Error) -> Error {
        watched::stopped(error)
            .unwrap_or_else(|error| Error::io(self.path, "cannot read the mesh", error).at(self.json_path))
    }

    /// The error of a list for which there is no room.
    fn lacking(&self, error: Error) -> Error {
        error.at(self.json_path).in_file(Some(self.path), 0)
    }

    fn too_large(&self) -> Error {
        self.fail(0, format!("the file is larger than {SIZE_LIMIT} bytes"))
    }

    /// Adds a warning about the file.
    fn warn(&self, warnings: &mut Vec<String>, line: usize, message: &str) {
        let mut place = self.path.display().to_string();
        if line > 0 {
            place = format!("{place}:{line}");
        }
        if !self.json_path.is_empty() {
            place = format!("{}: {place}", self.json_path);
        }
        warn(warnings, format!("{place}: {message}"));
    }

    /// A mesh without content, named after the file.
    fn mesh(&self) -> MeshDesc {
        MeshDesc { name: self.path.display().to_string(), path: self.json_path.to_owned(), ..MeshDesc::default() }
    }
}

/// Rounds values to single precision. Returns `None` where a value does not fit.
fn finite<const N: usize>(values: [f64; N]) -> Option<[f32; N]> {
    let rounded = values.map(|value| value as f32);
    rounded.iter().all(|value| value.is_finite()).then_some(rounded)
}

/// The colour of a vertex in linear light from that of a file, which may have sRGB's curve. Numbers out of range become the nearest ones.
fn vertex_color([r, g, b, opacity]: [f32; 4], is_encoded: bool) -> [f32; 4] {
    let channel = |value: f32| if is_encoded { srgb_decode(value) } else { value.max(0.0) };
    [channel(r), channel(g), channel(b), opacity.clamp(0.0, 1.0)]
}

/// Returns whether the text is a decimal number: a text that Rust parses, without Rust's words for infinity and NaN.
fn is_number(text: &str) -> bool {
    !text.bytes().any(|byte| matches!(byte, b'n' | b'N' | b'i' | b'I')) && text.parse::<f64>().is_ok_and(f64::is_finite)
}

/// Returns the beginning of an invalid word, which is long enough to find the word in the file.
fn shortened(text: &str) -> &str {
    text.char_indices().nth(40).map_or(text, |(end, _)| &text[..end])
}

/// Reads the next line, with its end, into `line`; an empty one at the end of the file. `Ok(false)` for a line that is too long.
fn read_line(reader: &mut impl io::BufRead, line: &mut Vec<u8>) -> io::Result<bool> {
    line.clear();
    reader.by_ref().take(LINE_LIMIT as u64 + 1).read_until(b'\n', line)?;
    Ok(line.len() <= LINE_LIMIT)
}
