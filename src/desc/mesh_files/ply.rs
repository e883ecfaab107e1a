//! Reads PLY files (Turk 1994, the Stanford polygon format): vertices with normals, texture coordinates and colours, polygons and
//! triangle strips.
//!
//! The crates for PLY do not say which element of a file is wrong, refuse numbers such as `1.`, and trust counts; the format is
//! small enough to be read here. Polygons become fans of triangles, as those of OBJ files do.

use super::ply_header::{Element, Header, Scalar};
use super::ply_values::{Trouble, Values};
use super::{CORNER_LIMIT, Place, Source, finite, vertex_color};
use crate::desc::MeshDesc;
use crate::desc::json::elided;
use crate::math::DVec3;
use crate::room::{add_room, push};
use crate::{Error, Result};

/// Names of the list of a polygon's corners.
const CORNERS: [&str; 2] = ["vertex_indices", "vertex_index"];
/// Names of the colours of vertices.
const COLORS: [&str; 3] = ["red", "green", "blue"];
/// Names of texture coordinates.
const UVS: [[&str; 2]; 4] = [["u", "v"], ["s", "t"], ["texture_u", "texture_v"], ["texture_s", "texture_t"]];

/// Reads a file. `keep_degenerate` says whether triangles that name a vertex twice are kept.
pub(super) fn read(source: Source<'_, '_>, keep_degenerate: bool, warnings: &mut Vec<String>) -> Result<MeshDesc> {
    let (place, size) = (source.place(), source.size);
    let mut input = source.reader;
    let header = Header::read(&mut input).map_err(|error| place.unreadable(error))?;
    let header = header.map_err(|(line, message)| place.fail(line, message))?;
    check_sizes(&header, size.saturating_sub(header.bytes)).map_err(|message| place.fail(0, message))?;
    let notes =
        Vec::from_iter(header.unknown.map(|line| format!("line {line} of the header means nothing; it is left out")));
    let values = Values::new(input, header.encoding, header.lines);
    let mut reader =
        Reader { place, values, mesh: place.mesh(), keep_degenerate, greatest: None, corners: 0, small: 0, notes };
    for element in &header.elements {
        match element.name.as_str() {
            "vertex" => reader.vertices(element)?,
            "face" => reader.faces(element)?,
            "tristrips" => reader.strips(element)?,
            _ => reader.others(element)?,
        }
    }
    reader.finish(warnings)
}

/// Checks that the file is large enough for what its header says, before memory is taken for it.
fn check_sizes(header: &Header, rest: u64) -> Result<(), String> {
    let mut needed = 0;
    for element in header.elements.iter().filter(|element| element.count > 0) {
        let Element { name, count, properties } = element;
        let name = elided(name);
        if properties.is_empty() {
            return Err(format!("the header has {count} elements '{name}' without any property"));
        }
        if *count > CORNER_LIMIT as u64 {
            return Err(format!("the header has {count} elements '{name}', expected {CORNER_LIMIT} at most"));
        }
        needed += element.least_bytes(header.encoding);
        // The last line of a text need not end.
        if needed > u128::from(rest) + 1 {
            return Err(format!(
                "the header has {count} elements '{name}', for which the file is too short: {rest} bytes after the header, \
                 {needed} at least are needed"
            ));
        }
    }
    Ok(())
}

/// The index of a vertex that a face names, and where.
struct Named {
    index: u32,
    at: String,
    line: usize,
}

/// What a number of a vertex is.
#[derive(Clone, Copy, PartialEq)]
enum Use {
    Position(usize),
    Normal(usize),
    Tangent(usize),
    /// A set of texture coordinates, and which of them.
    Uv(usize, usize),
    /// One of red, green, blue and opacity, and its greatest value: that of an integer type, or 1.
    Color(usize, f64),
    Nothing,
}

/// The number that stands for 1.
fn greatest(kind: Scalar) -> f64 {
    kind.range().map_or(1.0, |[_, greatest]| greatest)
}

struct Reader<'a, R> {
    place: Place<'a>,
    values: Values<R>,
    mesh: MeshDesc,
    keep_degenerate: bool,
    /// The greatest index of a vertex.
    greatest: Option<Named>,
    corners: usize,
    /// The number of polygons with fewer than three different corners.
    small: usize,
    /// Warnings so far.
    notes: Vec<String>,
}

impl<R: std::io::BufRead> Reader<'_, R> {
    fn fail(&self, message: String) -> Error {
        self.place.fail(self.values.line, message)
    }

    /// The error for a value of an element that cannot be had.
    fn wrong(&self, element: &Element, number: u64, property: &str, trouble: Trouble) -> Error {
        let Element { name, count, .. } = element;
        let name = elided(name);
        match trouble {
            Trouble::Io(error) => self.place.unreadable(error),
            Trouble::End => self.fail(format!("the file ends in {name} {number}, expected {count} of them")),
            Trouble::Bad(message) if property.is_empty() => self.fail(format!("{name} {number}: {message}")),
            Trouble::Bad(message) => self.fail(format!("{name} {number}, {}: {message}", elided(property))),
        }
    }

    /// Notes properties that are left out.
    fn unused(&mut self, element: &Element, names: &[&str]) {
        if element.count > 0 && !names.is_empty() {
            let shown: Vec<&str> = names.iter().take(16).copied().collect();
            let more = if names.len() > shown.len() { " and others" } else { "" };
            let (list, name) = (elided(&shown.join(", ")), &element.name);
            self.notes.push(format!("properties of each {name} that are not used: {list}{more}"));
        }
    }

    fn vertices(&mut self, element: &Element) -> Result<()> {
        let has = |name: &str| element.properties.iter().any(|property| property.name == name);
        if let Some(missing) = ["x", "y", "z"].into_iter().find(|name| !has(name)) {
            return Err(self.fail(format!("the header has no property {missing} of vertices")));
        }
        let has_normals = ["nx", "ny", "nz"].into_iter().all(has);
        let has_tangents = ["tx", "ty", "tz"].into_iter().all(has);
        let uv = UVS.into_iter().find(|names| names.iter().all(|name| has(name)));
        // Further sets have a number.
        let has_set = |set: usize| has(&format!("u{set}")) && has(&format!("v{set}"));
        let sets: Vec<usize> = (1..MeshDesc::MOST_UV_SETS).filter(|set| has_set(*set)).collect();
        let of_set = |name: &str| {
            let (axis, set) = name.split_at_checked(1)?;
            let set = sets.iter().copied().find(|known| known.to_string() == set)?;
            Some(Use::Uv(set, ["u", "v"].iter().position(|it| *it == axis)?))
        };
        let has_colors = COLORS.into_iter().all(has);
        let of = |name: &str, kind: Scalar| match name {
            "x" => Use::Position(0),
            "y" => Use::Position(1),
            "z" => Use::Position(2),
            "nx" if has_normals => Use::Normal(0),
            "ny" if has_normals => Use::Normal(1),
            "nz" if has_normals => Use::Normal(2),
            "tx" if has_tangents => Use::Tangent(0),
            "ty" if has_tangents => Use::Tangent(1),
            "tz" if has_tangents => Use::Tangent(2),
            "red" if has_colors => Use::Color(0, greatest(kind)),
            "green" if has_colors => Use::Color(1, greatest(kind)),
            "blue" if has_colors => Use::Color(2, greatest(kind)),
            "alpha" if has_colors => Use::Color(3, greatest(kind)),
            name => match uv.and_then(|uv| uv.into_iter().position(|it| it == name)) {
                Some(axis) => Use::Uv(0, axis),
                None => of_set(name).unwrap_or(Use::Nothing),
            },
        };
        let uses: Vec<Use> = element.properties.iter().map(|property| of(&property.name, property.kind)).collect();
        let with_uses = || element.properties.iter().zip(&uses);
        if let Some((list, _)) = with_uses().find(|(property, used)| **used != Use::Nothing && property.count.is_some())
        {
            return Err(self.fail(format!("the property {} of vertices is a list, expected a number", list.name)));
        }
        let unused: Vec<&str> = with_uses()
            .filter(|(_, used)| **used == Use::Nothing)
            .map(|(property, _)| property.name.as_str())
            .collect();
        self.unused(element, &unused);
        // The count is one that the file has room for.
        let count = element.count as usize;
        let lacking = |error| self.place.lacking(error);
        add_room(&mut self.mesh.positions, count).map_err(lacking)?;
        add_room(&mut self.mesh.normals, if has_normals { count } else { 0 }).map_err(lacking)?;
        add_room(&mut self.mesh.tangents, if has_tangents { count } else { 0 }).map_err(lacking)?;
        add_room(&mut self.mesh.uvs, if uv.is_some() { count } else { 0 }).map_err(lacking)?;
        self.mesh.further_uvs = vec![Vec::new(); sets.last().copied().unwrap_or(0)];
        for set in &sets {
            add_room(&mut self.mesh.further_uvs[set - 1], count).map_err(lacking)?;
        }
        add_room(&mut self.mesh.colors, if has_colors { count } else { 0 }).map_err(lacking)?;
        let is_integer = |name: &str| element.properties.iter().any(|it| it.name == name && it.kind.range().is_some());
        let is_encoded = COLORS.into_iter().all(is_integer);
        for number in 0..element.count {
            self.values.begin().map_err(|trouble| self.wrong(element, number, "", trouble))?;
            let (mut position, mut normal, mut tangent, mut color) = ([0.0; 3], [0.0; 3], [0.0; 3], [1.0; 4]);
            let mut coordinates = [[0.0; 2]; MeshDesc::MOST_UV_SETS];
            for (property, used) in with_uses() {
                let slot = match used {
                    Use::Position(axis) => &mut position[*axis],
                    Use::Normal(axis) => &mut normal[*axis],
                    Use::Tangent(axis) => &mut tangent[*axis],
                    Use::Uv(set, axis) => &mut coordinates[*set][*axis],
                    Use::Color(channel, _) => &mut color[*channel],
                    Use::Nothing => {
                        let skipped = self.values.skip(property);
                        skipped.map_err(|trouble| self.wrong(element, number, &property.name, trouble))?;
                        continue;
                    }
                };
                let value = self.values.number(property.kind);
                *slot = value.map_err(|trouble| self.wrong(element, number, &property.name, trouble))?;
                if let Use::Color(_, greatest) = used {
                    *slot /= greatest;
                }
            }
            self.values.end();
            let (place, line) = (self.place, self.values.line);
            let beyond = |what: &str, value: &[f64]| {
                place.fail(line, format!("vertex {number}: the {what} {value:?} is beyond single precision"))
            };
            finite(position).ok_or_else(|| beyond("position", &position))?;
            self.mesh.positions.push(DVec3::from_array(position));
            if has_normals {
                self.mesh.normals.push(finite(normal).ok_or_else(|| beyond("normal", &normal))?);
            }
            if has_tangents {
                self.mesh.tangents.push(finite(tangent).ok_or_else(|| beyond("tangent", &tangent))?);
            }
            let uv_of =
                |set: usize| finite(coordinates[set]).ok_or_else(|| beyond("texture coordinate", &coordinates[set]));
            if uv.is_some() {
                self.mesh.uvs.push(uv_of(0)?);
            }
            for set in &sets {
                self.mesh.further_uvs[set - 1].push(uv_of(*set)?);
            }
            if has_colors {
                let read = finite(color).ok_or_else(|| beyond("colour", &color))?;
                self.mesh.colors.push(vertex_color(read, is_encoded));
            }
        }
        Ok(())
    }

    /// Reads elements whose one list of vertices is handed over; -1 is allowed where it ends a strip.
    fn lists(
        &mut self,
        element: &Element,
        ends: bool,
        mut take: impl FnMut(&mut Self, &[Option<u32>]) -> Result<()>,
    ) -> Result<()> {
        if element.count == 0 {
            return Ok(());
        }
        let name = &element.name;
        let is_corners = |name: &str| CORNERS.contains(&name);
        let Some(list) = element.properties.iter().find(|property| is_corners(&property.name)) else {
            return Err(self.fail(format!("the header has no list {} of each {name}", CORNERS.join(" or "))));
        };
        let Some(count_kind) = list.count.filter(|_| list.kind.range().is_some()) else {
            return Err(self.fail(format!("the property {} of each {name} is not a list of integers", list.name)));
        };
        let others = element.properties.iter().map(|property| property.name.as_str());
        let others: Vec<&str> = others.filter(|name| *name != list.name).collect();
        self.unused(element, &others);
        let mut corners = Vec::new();
        for number in 0..element.count {
            self.values.begin().map_err(|trouble| self.wrong(element, number, "", trouble))?;
            for property in &element.properties {
                let wrong = |it: &Self, trouble| it.wrong(element, number, &property.name, trouble);
                if property.name != list.name {
                    self.values.skip(property).map_err(|trouble| wrong(self, trouble))?;
                    continue;
                }
                corners.clear();
                let count = self.values.count(count_kind).map_err(|trouble| wrong(self, trouble))?;
                if count > (CORNER_LIMIT - self.corners) as u64 {
                    return Err(self.fail(format!("the file has more than {CORNER_LIMIT} corners")));
                }
                self.corners += count as usize;
                for _ in 0..count {
                    let value = self.values.number(property.kind).map_err(|trouble| wrong(self, trouble))?;
                    if value == -1.0 && ends {
                        push(&mut corners, None).map_err(|error| self.place.lacking(error))?;
                        continue;
                    }
                    if value < 0.0 {
                        let message = format!("{value} is not the index of a vertex");
                        return Err(wrong(self, Trouble::Bad(message)));
                    }
                    let index = value as u32;
                    push(&mut corners, Some(index)).map_err(|error| self.place.lacking(error))?;
                    if self.greatest.as_ref().is_none_or(|known| index > known.index) {
                        self.greatest = Some(Named { index, at: format!("{name} {number}"), line: self.values.line });
                    }
                }
            }
            self.values.end();
            take(self, &corners)?;
        }
        Ok(())
    }

    fn faces(&mut self, element: &Element) -> Result<()> {
        self.lists(element, false, |reader, corners| {
            let before = reader.mesh.triangles.len();
            let corners = corners.iter().flatten();
            let mut rest = corners.clone().skip(1);
            if let (Some(first), Some(mut second)) = (corners.clone().next(), rest.next()) {
                for third in rest {
                    reader.triangle([*first, *second, *third])?;
                    second = third;
                }
            }
            reader.small += usize::from(reader.mesh.triangles.len() == before);
            Ok(())
        })
    }

    fn strips(&mut self, element: &Element) -> Result<()> {
        self.lists(element, true, |reader, corners| {
            for strip in corners.split(Option::is_none) {
                for (i, corners) in strip.windows(3).enumerate() {
                    if let [Some(a), Some(b), Some(c)] = *corners {
                        // Every other triangle of a strip runs the other way.
                        reader.triangle(if i % 2 == 0 { [a, b, c] } else { [b, a, c] })?;
                    }
                }
            }
            Ok(())
        })
    }

    /// Adds a triangle with three different corners, or any triangle where all are kept.
    fn triangle(&mut self, [a, b, c]: [u32; 3]) -> Result<()> {
        if self.keep_degenerate || a != b && b != c && c != a {
            push(&mut self.mesh.triangles, [a, b, c]).map_err(|error| self.place.lacking(error))?;
        }
        Ok(())
    }

    /// Leaves out elements that are not part of a mesh.
    fn others(&mut self, element: &Element) -> Result<()> {
        for number in 0..element.count {
            self.values.begin().map_err(|trouble| self.wrong(element, number, "", trouble))?;
            for property in &element.properties {
                let skipped = self.values.skip(property);
                skipped.map_err(|trouble| self.wrong(element, number, &property.name, trouble))?;
            }
            self.values.end();
        }
        if element.count > 0 {
            self.notes.push(format!("{} elements that are not used: {}", element.count, elided(&element.name)));
        }
        Ok(())
    }

    fn finish(mut self, warnings: &mut Vec<String>) -> Result<MeshDesc> {
        let vertices = self.mesh.positions.len();
        if let Some(Named { index, at, line }) = self.greatest.take().filter(|named| named.index as usize >= vertices) {
            return Err(self.place.fail(line, format!("{at} refers to vertex {index}, but there are {vertices}")));
        }
        if self.mesh.triangles.is_empty() {
            let message = if self.corners > 0 {
                format!("none of the faces has three different corners ({} corners)", self.corners)
            } else {
                format!("the file holds no faces, only {vertices} vertices")
            };
            return Err(self.place.fail(0, message));
        }
        if self.small > 0 {
            self.notes.push(format!("{} faces with fewer than 3 different corners left out", self.small));
        }
        if self.values.longer_lines > 0 {
            let count = self.values.longer_lines;
            self.notes.push(format!("{count} lines have more values than the header says; these are left out"));
        }
        if self.values.has_more().map_err(|error| self.place.unreadable(error))? {
            self.notes.push("there is more after the last element; it is left out".to_owned());
        }
        self.notes.iter().for_each(|note| self.place.warn(warnings, 0, note));
        Ok(self.mesh)
    }
}
