//! Reads Wavefront OBJ files with `tobj`, behind a reader that checks every line first.
//!
//! The check adds line numbers to errors, keeps indices and counts in a range in which nothing overflows, joins
//! continued lines, and passes on geometry only (`v`, `vt`, `vn`, `f`). Groups and objects are merged into one mesh, and names
//! and comments may have any encoding. Materials are ignored, or the mesh is divided by them (`obj_parts.rs`).

use std::io::{self, BufRead, Read};

use super::obj_parts::MaterialUses;
use super::{CORNER_LIMIT, LINE_LIMIT, Place, Source, finite, is_number, shortened, vertex_color};
use crate::control::WorkProgress;
use crate::desc::MeshDesc;
use crate::math::DVec3;
use crate::room::{add_room, check_room};
use crate::{Error, Result};

/// U+FEFF in UTF-8, with which some programs begin a file.
const BYTE_ORDER_MARK: &[u8] = b"\xef\xbb\xbf";

/// Reads a file, and which material each triangle has if `uses` is given.
pub(super) fn read(
    source: Source<'_, '_>,
    uses: Option<MaterialUses>,
    warnings: &mut Vec<String>,
    work: &WorkProgress<'_>,
) -> Result<(MeshDesc, Option<MaterialUses>)> {
    let place = source.place();
    let mut lines = Lines::new(source.reader);
    lines.uses = uses;
    let options = tobj::LoadOptions { single_index: true, triangulate: true, ignore_points: true, ignore_lines: true };
    let loaded = tobj::load_obj_buf(&mut lines, &options, |_| Err(tobj::LoadError::OpenFileFailed));
    if let Some(error) = lines.lacking.take() {
        return Err(place.lacking(error));
    }
    if let Some(broken) = lines.broken.take() {
        return Err(place.fail(lines.line, broken));
    }
    if let Some(error) = lines.failed.take() {
        return Err(place.unreadable(error));
    }
    if lines.inner.get_ref().limit() == 0 {
        return Err(place.too_large());
    }
    // Indices may refer to later elements, so they can be checked only at the end.
    for (what, limit, (index, line)) in [
        ("vertex", lines.counts[0], lines.greatest[0]),
        ("texture coordinate", lines.counts[1], lines.greatest[1]),
        ("normal", lines.counts[2], lines.greatest[2]),
    ] {
        if index > limit {
            return Err(place.fail(line, format!("the face refers to {what} {index}, but there are {limit}")));
        }
    }
    if lines.corners == 0 {
        return Err(place.fail(0, "the file holds no faces; is it a Wavefront OBJ file?".to_owned()));
    }
    let (models, _) = loaded.map_err(|error| place.fail(lines.line, format!("not a Wavefront OBJ file: {error}")))?;
    let mut mesh = merge(models, place, work)?;
    if lines.small_faces > 0 {
        place.warn(warnings, 0, &format!("{} faces with fewer than 3 corners left out", lines.small_faces));
    }
    if lines.mixed_colors {
        let taken = if mesh.colors.is_empty() { "none is used" } else { "the others are white" };
        place.warn(warnings, 0, &format!("only some vertices have colours; {taken}"));
    }
    // The reader below stores no entry for a vertex without a normal (or uv), so it cannot recognise a mixture.
    for (what, with, complete) in [
        ("normals", lines.corners_with[2], mesh.normals.len() == mesh.positions.len()),
        ("texture coordinates", lines.corners_with[1], mesh.uvs.len() == mesh.positions.len()),
    ] {
        if with == 0 || (with == lines.corners && complete) {
            continue;
        }
        place.warn(warnings, 0, &format!("only some corners have {what}; all are left out"));
        if what == "normals" {
            mesh.normals = Vec::new();
        } else {
            mesh.uvs = Vec::new();
        }
    }
    Ok((mesh, lines.uses))
}

/// Number of items of the mesh between two checks whether the reading was stopped.
const BLOCK: usize = 1 << 14;

/// Merges all objects and groups into one mesh.
fn merge(models: Vec<tobj::Model>, place: Place<'_>, work: &WorkProgress<'_>) -> Result<MeshDesc> {
    let beyond = |what: &str, value: &[f64]| place.fail(0, format!("the {what} {value:?} is beyond single precision"));
    let lacking = |error| place.lacking(error);
    let mut mesh = place.mesh();
    for model in models.into_iter().map(|model| model.mesh) {
        let first = u32::try_from(mesh.positions.len()).map_err(|_| place.fail(0, "the mesh has too many vertices"))?;
        let (positions, normals) = (model.positions.as_chunks::<3>().0, model.normals.as_chunks::<3>().0);
        let (uvs, colors) = (model.texcoords.as_chunks::<2>().0, model.vertex_color.as_chunks::<3>().0);
        let triangles = model.indices.as_chunks::<3>().0;
        add_room(&mut mesh.positions, positions.len()).map_err(lacking)?;
        add_room(&mut mesh.normals, normals.len()).map_err(lacking)?;
        add_room(&mut mesh.uvs, uvs.len()).map_err(lacking)?;
        add_room(&mut mesh.colors, colors.len()).map_err(lacking)?;
        add_room(&mut mesh.triangles, triangles.len()).map_err(lacking)?;
        for block in positions.chunks(BLOCK) {
            work.check()?;
            for p in block {
                finite(*p).ok_or_else(|| beyond("position", p))?;
                mesh.positions.push(DVec3::from_array(*p));
            }
        }
        for block in normals.chunks(BLOCK) {
            work.check()?;
            for n in block {
                mesh.normals.push(finite(*n).ok_or_else(|| beyond("normal", n))?);
            }
        }
        for block in uvs.chunks(BLOCK) {
            work.check()?;
            for uv in block {
                mesh.uvs.push(finite(*uv).ok_or_else(|| beyond("texture coordinate", uv))?);
            }
        }
        for block in colors.chunks(BLOCK) {
            work.check()?;
            for color in block {
                let [r, g, b] = finite(*color).ok_or_else(|| beyond("colour", color))?;
                mesh.colors.push(vertex_color([r, g, b, 1.0], true));
            }
        }
        for block in triangles.chunks(BLOCK) {
            work.check()?;
            mesh.triangles.extend(block.iter().map(|t| t.map(|index| index + first)));
        }
    }
    Ok(mesh)
}

/// Refuses a line, with its end, of a file that is no text or whose lines end in another way.
fn check_text(line: &[u8]) -> Result<(), String> {
    // A comment may have any encoding, unless it is all that is left of the file.
    if line.trim_ascii_start().starts_with(b"#") && line.ends_with(b"\n") {
        return Ok(());
    }
    if line.contains(&0) {
        return Err("the line holds a NUL byte, expected text in UTF-8; is the file binary or in UTF-16?".to_owned());
    }
    if line.trim_ascii_end().contains(&b'\r') {
        return Err("the line holds a carriage return (CR), expected lines that end with LF or CR LF".to_owned());
    }
    Ok(())
}

/// A line-wise reader that passes on only checked geometry.
struct Lines<R> {
    inner: R,
    /// The line to be passed on, with its end.
    ready: Vec<u8>,
    taken: usize,
    /// One-based number of the last line read.
    line: usize,
    /// The numbers of `v`, `vt` and `vn` elements so far.
    counts: [usize; 3],
    /// Greatest index of each kind, and the line that used it.
    greatest: [(usize, usize); 3],
    corners: usize,
    /// The numbers of corners that have a position, a texture coordinate and a normal.
    corners_with: [usize; 3],
    small_faces: usize,
    /// Whether vertices have colours, once there was one.
    is_colored: Option<bool>,
    /// Whether only some vertices have colours.
    mixed_colors: bool,
    /// The materials of faces, if they are asked for.
    uses: Option<MaterialUses>,
    /// Number of faces that were passed on.
    faces: usize,
    /// Whether all corners have a position, texture coordinate and normal of one index, so that a vertex never has two of them.
    shares_indices: bool,
    /// Bytes that the parser holds, and how many it may come to hold before room is asked for again.
    held: usize,
    expected: usize,
    /// The error in the current line.
    broken: Option<String>,
    failed: Option<io::Error>,
    /// The error where there is no room for what the parser needs next.
    lacking: Option<Error>,
}

/// Memory of the parser, which ends the process where there is no room. It is asked for here before the parser needs it, line by line,
/// because the size of a file does not tell: the parser holds 3.5 times the size of a mesh of a million triangles, and 13 times that of
/// the shortest lines that there are. These numbers are those of the types in tobj 4.0.
mod parser_bytes {
    /// A number of an element.
    pub const NUMBER: usize = size_of::<f64>();
    /// The three indices of a corner.
    pub const CORNER: usize = 3 * size_of::<usize>();
    /// A face, whatever it is.
    pub const FACE: usize = 4 * CORNER + size_of::<usize>();
    /// The entry of a vertex of the mesh in a table that was just enlarged, of which the old one is still there.
    pub const ENTRY: usize = 120;
    /// How often an item of the mesh is there while its list grows: in the old list, and twice in the room of the new one.
    pub const GROWING: usize = 3;
    /// Vertices of the mesh that one element of the file becomes at most, in the mean, where corners combine elements.
    pub const VERTICES_OF_ONE: usize = 3;
    /// How much more is held at least before room is asked for again.
    pub const LEAST: usize = 1 << 16;
}

impl<R: BufRead> Lines<R> {
    fn new(inner: R) -> Self {
        Self {
            inner,
            ready: Vec::new(),
            taken: 0,
            line: 0,
            counts: [0; 3],
            greatest: [(0, 0); 3],
            corners: 0,
            corners_with: [0; 3],
            small_faces: 0,
            is_colored: None,
            mixed_colors: false,
            uses: None,
            faces: 0,
            shares_indices: true,
            held: 0,
            expected: 0,
            broken: None,
            failed: None,
            lacking: None,
        }
    }

    /// Asks for room for what the parser makes of the next lines: lists that grow have their old items beside twice their room.
    fn ask_for_lines(&mut self) -> Result<(), String> {
        if self.held < self.expected {
            return Ok(());
        }
        self.expected = self.held + self.held / 8 + parser_bytes::LEAST;
        self.ask_for(2 * self.expected)
    }

    /// Asks for room for the mesh that the parser makes at the end of the file.
    fn ask_for_mesh(&mut self) -> Result<(), String> {
        let greatest = self.counts.into_iter().max().unwrap_or(0);
        let each = if self.shares_indices { 1 } else { parser_bytes::VERTICES_OF_ONE };
        let vertices = (each * greatest).min(self.corners);
        let triangles = self.corners - 2 * self.faces;
        let [_, uvs, normals] = self.counts.map(|count| count > 0);
        let has_colors = self.is_colored == Some(true);
        let numbers = 3 + 2 * usize::from(uvs) + 3 * usize::from(normals) + 3 * usize::from(has_colors);
        let vertex = parser_bytes::ENTRY + parser_bytes::GROWING * numbers * parser_bytes::NUMBER;
        let triangle = parser_bytes::GROWING * size_of::<[u32; 3]>();
        self.ask_for(vertices * vertex + triangles * triangle)
    }

    fn ask_for(&mut self, bytes: usize) -> Result<(), String> {
        check_room(bytes).map_err(|error| {
            self.lacking = Some(error);
            String::new()
        })
    }

    /// Prepares the next line of geometry. Returns false at the end of the file.
    fn advance(&mut self) -> Result<bool, String> {
        loop {
            self.ready.clear();
            self.taken = 0;
            // A backslash before the end of a line continues it.
            loop {
                let before = self.ready.len();
                let room = (LINE_LIMIT - before) as u64 + 1;
                let read = self.inner.by_ref().take(room).read_until(b'\n', &mut self.ready);
                match read {
                    Ok(0) if before == 0 => {
                        self.ask_for_mesh()?;
                        return Ok(false);
                    }
                    Ok(0) => break,
                    Ok(_) => {}
                    Err(error) => {
                        self.failed = Some(error);
                        return Err(String::new());
                    }
                }
                self.line += 1;
                if self.line == 1 && self.ready.starts_with(BYTE_ORDER_MARK) {
                    self.ready.drain(..BYTE_ORDER_MARK.len());
                }
                check_text(&self.ready[before..])?;
                if self.ready.len() > LINE_LIMIT {
                    return Err(format!("the line is longer than {LINE_LIMIT} bytes; is it a Wavefront OBJ file?"));
                }
                let end = self.ready.trim_ascii_end().len();
                if self.ready.get(end.wrapping_sub(1)) != Some(&b'\\') {
                    break;
                }
                self.ready.truncate(end - 1);
                self.ready.push(b' ');
            }
            if let Some(line) = self.checked()? {
                self.ask_for_lines()?;
                self.ready = line;
                return Ok(true);
            }
        }
    }

    /// Returns the line in the form that the parser receives, or `None` if the line contains no geometry.
    fn checked(&mut self) -> Result<Option<Vec<u8>>, String> {
        let line = self.ready.trim_ascii();
        let keyword = line.split(u8::is_ascii_whitespace).next().unwrap_or_default();
        let kind = match keyword {
            b"v" => 0,
            b"vt" => 1,
            b"vn" => 2,
            b"f" => return self.face(),
            b"mtllib" | b"usemtl" => {
                if let Some(uses) = &mut self.uses {
                    uses.read(line, self.line)?;
                }
                return Ok(None);
            }
            _ => return Ok(None),
        };
        // A comment may follow on the same line.
        let line = line.split(|byte| *byte == b'#').next().unwrap_or_default();
        let text = str::from_utf8(line).map_err(|_| "the line is not text".to_owned())?;
        let numbers: Vec<&str> = text.split_ascii_whitespace().skip(1).collect();
        let name = ["position", "texture coordinate", "normal"][kind];
        if let Some(bad) = numbers.iter().find(|number| !is_number(number)) {
            return Err(format!("'{}' is not a finite number", shortened(bad)));
        }
        // A texture coordinate may lack v. A vertex may have a weight, or a colour, of which all vertices have one or none.
        let of_vertex = match numbers.len() {
            4 => 4,
            6.. if *self.is_colored.get_or_insert(true) => 6,
            _ => 3,
        };
        let (least, keep) = [(3, of_vertex), (1, 2), (3, 3)][kind];
        if numbers.len() < least {
            return Err(format!("a {name} needs {least} numbers, found {}", numbers.len()));
        }
        // The fourth number of a position is a weight that divides the others.
        if keep == 4 && numbers[3].parse() == Ok(0.0) {
            return Err("a position with weight 0 lies at infinity".to_owned());
        }
        self.counts[kind] += 1;
        self.held += keep.max(3) * parser_bytes::NUMBER;
        let mut checked = numbers[..keep.min(numbers.len())].join(" ");
        if kind == 0 {
            let is_colored = *self.is_colored.get_or_insert(false);
            if is_colored != (numbers.len() >= 6) {
                self.mixed_colors = true;
            }
            if is_colored && keep == 4 {
                let value = |i: usize| numbers[i].parse::<f64>().unwrap_or_default();
                checked = format!("{} {} {}", value(0) / value(3), value(1) / value(3), value(2) / value(3));
            }
            if is_colored && keep < 6 {
                checked.push_str(" 1 1 1");
            }
        }
        if kind == 1 && numbers.len() == 1 {
            checked.push_str(" 0");
        }
        Ok(Some(format!("{} {checked}\n", ["v", "vt", "vn"][kind]).into_bytes()))
    }

    fn face(&mut self) -> Result<Option<Vec<u8>>, String> {
        let line = self.ready.trim_ascii().split(|byte| *byte == b'#').next().unwrap_or_default();
        let text = str::from_utf8(line).map_err(|_| "the line is not text".to_owned())?;
        let mut checked = String::with_capacity(text.len() + 1);
        checked.push('f');
        let (mut corners, mut with) = (0, [0; 3]);
        for corner in text.split_ascii_whitespace().skip(1) {
            corners += 1;
            let mut own = None;
            checked.push(' ');
            for (kind, index) in corner.split('/').enumerate() {
                if kind > 0 {
                    checked.push('/');
                }
                if index.is_empty() && kind > 0 {
                    continue;
                }
                let bad =
                    || format!("'{}' is not a corner of a face, expected v, v/vt, v//vn or v/vt/vn", shortened(corner));
                let count = *self.counts.get(kind).ok_or_else(bad)?;
                let parsed: i64 = index.parse().map_err(|_| bad())?;
                // Negative indices count back from the last element so far.
                let absolute = match usize::try_from(parsed.unsigned_abs()).unwrap_or(usize::MAX) {
                    0 => return Err(format!("'{}' has the index 0, indices start at 1", shortened(corner))),
                    back if parsed < 0 && back > count => {
                        return Err(format!("'{}' counts back {back}, but there are {count}", shortened(corner)));
                    }
                    back if parsed < 0 => count + 1 - back,
                    forward => forward,
                };
                if absolute > self.greatest[kind].0 {
                    self.greatest[kind] = (absolute, self.line);
                }
                // An index that cannot exist is not passed on, because the parser multiplies indices by three.
                if absolute > CORNER_LIMIT {
                    return Err(format!("the index in '{}' is too large", shortened(corner)));
                }
                self.shares_indices &= *own.get_or_insert(absolute) == absolute;
                with[kind] += 1;
                checked.push_str(&absolute.to_string());
            }
        }
        if corners < 3 {
            self.small_faces += 1;
            return Ok(None);
        }
        self.faces += 1;
        self.corners += corners;
        // Those of a polygon are in a list of its own.
        self.held += parser_bytes::FACE + if corners > 4 { corners * parser_bytes::CORNER } else { 0 };
        for (total, with) in self.corners_with.iter_mut().zip(with) {
            *total += with;
        }
        if self.corners > CORNER_LIMIT {
            return Err(format!("the file has more than {CORNER_LIMIT} face corners"));
        }
        if let Some(uses) = &mut self.uses {
            uses.face(corners, self.line);
        }
        checked.push('\n');
        Ok(Some(checked.into_bytes()))
    }
}

impl<R: BufRead> Read for Lines<R> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        let ready = self.fill_buf()?;
        let count = ready.len().min(buffer.len());
        buffer[..count].copy_from_slice(&ready[..count]);
        self.consume(count);
        Ok(count)
    }
}

impl<R: BufRead> BufRead for Lines<R> {
    fn fill_buf(&mut self) -> io::Result<&[u8]> {
        if self.taken == self.ready.len() && self.broken.is_none() {
            match self.advance() {
                Ok(true) => {}
                Ok(false) => {
                    self.ready.clear();
                    self.taken = 0;
                }
                Err(message) => {
                    if self.failed.is_none() && self.lacking.is_none() {
                        self.broken = Some(message);
                    }
                    return Err(io::Error::from(io::ErrorKind::InvalidData));
                }
            }
        }
        Ok(&self.ready[self.taken..])
    }

    fn consume(&mut self, count: usize) {
        self.taken = (self.taken + count).min(self.ready.len());
    }
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::*;
    use crate::{Cancel, ErrorKind};

    #[test]
    fn putting_the_mesh_together_is_stopped() {
        let place = Place { path: Path::new("a.obj"), json_path: "" };
        let model = || {
            let mesh = tobj::Mesh { positions: vec![0.0; 9], indices: vec![0, 1, 2], ..tobj::Mesh::default() };
            vec![tobj::Model::new(mesh, String::new())]
        };
        let cancel = Cancel::new();
        let work = WorkProgress::new(&cancel);
        assert_eq!(merge(model(), place, &work).unwrap().triangles, [[0, 1, 2]]);
        cancel.cancel();
        assert_eq!(merge(model(), place, &work).unwrap_err().kind(), ErrorKind::Cancelled);
    }
}
