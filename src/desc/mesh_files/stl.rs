//! Reads STL files (stereolithography): loose triangles, binary or as text (`stl_text.rs`).
//!
//! Equal vertices are joined, so that smooth shading and shared vertices work as for other files. Normals of facets are not used:
//! they are those of the vertices' order, where they are right. The crates for STL take binary files that begin with "solid" for
//! text and end at the first of several solids, so the format is read here.

use std::collections::HashMap;
use std::io::{BufRead, ErrorKind, Read as _};

use super::{CORNER_LIMIT, Place, Source, stl_text};
use crate::desc::MeshDesc;
use crate::math::DVec3;
use crate::room::{add_entries, push};
use crate::{Error, Result};

/// Bytes before the first triangle of a binary file: any text, and the number of triangles.
const HEADER: usize = 84;
/// Bytes of a triangle: normal, three vertices, and an attribute of two bytes.
const TRIANGLE: usize = 50;

/// Whether a file begins as one of text: with the word `solid`, and without zero bytes, which binary files have.
pub(super) fn is_text(beginning: &[u8]) -> bool {
    let text = beginning.trim_ascii_start();
    let text = text.strip_prefix(b"\xef\xbb\xbf").unwrap_or(text);
    let is_solid = text.get(..5).is_some_and(|word| word.eq_ignore_ascii_case(b"solid"))
        && text.get(5).is_none_or(u8::is_ascii_whitespace);
    is_solid && !beginning.contains(&0)
}

/// Whether the size of a file is the one of a binary file that begins like this.
pub(super) fn is_binary_of_size(beginning: &[u8], size: u64) -> bool {
    count(beginning).is_some_and(|count| size == HEADER as u64 + TRIANGLE as u64 * u64::from(count))
}

/// The number of triangles in the header of a binary file.
fn count(beginning: &[u8]) -> Option<u32> {
    beginning.get(80..84)?.try_into().ok().map(u32::from_le_bytes)
}

/// Reads a file.
pub(super) fn read(mut source: Source<'_, '_>, warnings: &mut Vec<String>) -> Result<MeshDesc> {
    let (place, size) = (source.place(), source.size);
    let beginning = source.reader.fill_buf().map_err(|error| place.unreadable(error))?;
    let is_binary = is_binary_of_size(beginning, size) || !is_text(beginning);
    let mut triangles = Triangles::new(place);
    let outcome = if is_binary {
        let Some(count) = count(beginning) else {
            let message = format!("the file of {size} bytes is too short for a binary STL file, and no text of one");
            return Err(place.fail(0, message));
        };
        binary(&mut source, count, &mut triangles)
    } else {
        stl_text::read(&mut source, &mut triangles)
    };
    if let Some(error) = triangles.lacking.take() {
        return Err(place.lacking(error));
    }
    outcome?;
    triangles.finish(warnings)
}

fn binary(source: &mut Source<'_, '_>, count: u32, triangles: &mut Triangles<'_>) -> Result<()> {
    let (place, size) = (source.place(), source.size);
    let room = size.saturating_sub(HEADER as u64) / TRIANGLE as u64;
    if u64::from(count) > room {
        let message = format!("the file says that it has {count} triangles, but ends after {room}; is it an STL file?");
        return Err(place.fail(0, message));
    }
    let (mut header, mut facet) = ([0; HEADER], [0; TRIANGLE]);
    source.reader.read_exact(&mut header).map_err(|error| place.unreadable(error))?;
    let mut coloured = 0;
    for number in 0..count {
        source.reader.read_exact(&mut facet).map_err(|error| match error.kind() {
            ErrorKind::UnexpectedEof => place.fail(0, format!("the file ends in triangle {number} of {count}")),
            _ => place.unreadable(error),
        })?;
        let (words, attribute) = facet.as_chunks::<4>();
        let numbers: Vec<f32> = words[3..12].iter().map(|word| f32::from_le_bytes(*word)).collect();
        let corners = [0, 3, 6].map(|at| [numbers[at], numbers[at + 1], numbers[at + 2]]);
        triangles.add(corners).map_err(|message| place.fail(0, format!("triangle {number}: {message}")))?;
        coloured += usize::from(attribute != [0, 0]);
    }
    if coloured > 0 {
        triangles.notes.push(format!("{coloured} triangles have attributes (colours), which are not used"));
    }
    let after = size.saturating_sub(HEADER as u64 + TRIANGLE as u64 * u64::from(count));
    if after > 0 {
        triangles.notes.push(format!("{after} bytes after the last triangle left out"));
    }
    Ok(())
}

/// Triangles whose equal vertices are joined.
pub(super) struct Triangles<'a> {
    place: Place<'a>,
    mesh: MeshDesc,
    vertices: HashMap<[u32; 3], u32>,
    count: usize,
    small: usize,
    /// The error where there was no room for a triangle.
    lacking: Option<Error>,
    pub notes: Vec<String>,
}

impl<'a> Triangles<'a> {
    fn new(place: Place<'a>) -> Self {
        let (mesh, vertices) = (place.mesh(), HashMap::new());
        Self { place, mesh, vertices, count: 0, small: 0, lacking: None, notes: Vec::new() }
    }

    /// The number of triangles so far.
    pub fn count(&self) -> usize {
        self.count
    }

    /// Adds a triangle. Where there is no room for it, the sentence of the error is empty, and [`read`] returns the error itself.
    pub fn add(&mut self, corners: [[f32; 3]; 3]) -> Result<(), String> {
        self.count += 1;
        if self.count > CORNER_LIMIT / 3 {
            return Err(format!("the file has more than {} triangles", CORNER_LIMIT / 3));
        }
        for corner in corners {
            if let Some(bad) = corner.iter().find(|value| !value.is_finite()) {
                return Err(format!("the vertex {corner:?} has the number {bad}, which is not finite"));
            }
        }
        self.insert(corners).map_err(|error| {
            self.lacking = Some(error);
            String::new()
        })
    }

    /// Adds a triangle of finite corners.
    fn insert(&mut self, corners: [[f32; 3]; 3]) -> Result<()> {
        add_entries(&mut self.vertices, 3)?;
        let mut triangle = [0; 3];
        for (index, corner) in triangle.iter_mut().zip(corners) {
            // Both zeros are equal.
            let key = corner.map(|value| (value + 0.0).to_bits());
            let next = self.mesh.positions.len() as u32;
            *index = *self.vertices.entry(key).or_insert(next);
            if *index == next {
                push(&mut self.mesh.positions, DVec3::from_array(corner.map(f64::from)))?;
            }
        }
        let [a, b, c] = triangle;
        if a == b || b == c || c == a {
            self.small += 1;
            return Ok(());
        }
        push(&mut self.mesh.triangles, triangle)
    }

    fn finish(mut self, warnings: &mut Vec<String>) -> Result<MeshDesc> {
        if self.mesh.triangles.is_empty() {
            let message = match self.count {
                0 => "the file holds no triangles; is it an STL file?".to_owned(),
                count => format!("none of the {count} triangles has three different corners"),
            };
            return Err(self.place.fail(0, message));
        }
        if self.small > 0 {
            self.notes.push(format!("{} triangles with fewer than 3 different corners left out", self.small));
        }
        self.notes.iter().for_each(|note| self.place.warn(warnings, 0, note));
        Ok(self.mesh)
    }
}
