//! Reads STL files of text.

use super::stl::Triangles;
use super::{LINE_LIMIT, Source, is_number, read_line, shortened};
use crate::Result;

/// Reads all solids of a file. Words may be in upper or lower case, and several of them on one line.
pub(super) fn read(source: &mut Source<'_, '_>, triangles: &mut Triangles<'_>) -> Result<()> {
    let place = source.place();
    let mut facets = Facets { triangles, vertices: None, solids: 0, is_open: false };
    let mut text = Vec::new();
    for line in 1.. {
        let fits = read_line(&mut source.reader, &mut text).map_err(|error| place.unreadable(error))?;
        if text.is_empty() {
            break;
        }
        if !fits {
            return Err(place.fail(line, format!("the line is longer than {LINE_LIMIT} bytes; is it an STL file?")));
        }
        facets.line(&String::from_utf8_lossy(&text)).map_err(|message| place.fail(line, message))?;
    }
    if source.reader.get_ref().limit() == 0 {
        return Err(place.too_large());
    }
    if facets.vertices.is_some() {
        return Err(place.fail(0, format!("the file ends in facet {}", facets.triangles.count())));
    }
    let (solids, is_open) = (facets.solids, facets.is_open);
    if solids > 1 {
        triangles.notes.push(format!("{solids} solids become one mesh"));
    }
    if is_open {
        triangles.notes.push("the file ends without endsolid; it may not be complete".to_owned());
    }
    Ok(())
}

struct Facets<'a, 'b> {
    triangles: &'a mut Triangles<'b>,
    /// The vertices of the facet that is being read.
    vertices: Option<Vec<[f32; 3]>>,
    solids: usize,
    /// Whether a solid has begun and not ended.
    is_open: bool,
}

impl Facets<'_, '_> {
    fn line(&mut self, text: &str) -> Result<(), String> {
        let text = text.strip_prefix('\u{feff}').unwrap_or(text);
        let mut words = text.split_ascii_whitespace();
        while let Some(word) = words.next() {
            match word.to_ascii_lowercase().as_str() {
                // The rest of the line is a name.
                "solid" => {
                    self.solids += 1;
                    self.is_open = true;
                    return Ok(());
                }
                "endsolid" if self.vertices.is_none() => {
                    self.is_open = false;
                    return Ok(());
                }
                "facet" if self.vertices.is_none() => {
                    // The normal, which may be anything.
                    if words.by_ref().take(4).count() != 4 {
                        return Err(format!("facet {} has no normal of three numbers", self.triangles.count()));
                    }
                    self.vertices = Some(Vec::with_capacity(3));
                }
                "outer" | "loop" | "endloop" if self.vertices.is_some() => {}
                "vertex" if self.vertices.is_some() => {
                    let vertex = self.vertex(&mut words)?;
                    self.vertices.get_or_insert_default().push(vertex);
                }
                "endfacet" if self.vertices.is_some() => {
                    let vertices = self.vertices.take().unwrap_or_default();
                    let number = self.triangles.count();
                    let Ok(corners) = <[[f32; 3]; 3]>::try_from(vertices.as_slice()) else {
                        return Err(format!("facet {number} has {} vertices, expected 3", vertices.len()));
                    };
                    self.triangles.add(corners).map_err(|message| format!("facet {number}: {message}"))?;
                }
                _ => {
                    let expected = match self.vertices {
                        Some(_) => "outer loop, vertex, endloop or endfacet",
                        None => "solid, facet or endsolid",
                    };
                    return Err(format!("'{}' is not expected here, expected {expected}", shortened(word)));
                }
            }
        }
        Ok(())
    }

    fn vertex<'w>(&self, words: &mut impl Iterator<Item = &'w str>) -> Result<[f32; 3], String> {
        let number = self.triangles.count();
        if self.vertices.as_ref().is_some_and(|vertices| vertices.len() == 3) {
            return Err(format!("facet {number} has more than 3 vertices"));
        }
        let mut vertex = [0.0; 3];
        for (value, axis) in vertex.iter_mut().zip(["x", "y", "z"]) {
            let word = words.next().ok_or_else(|| format!("a vertex of facet {number} has no {axis}"))?;
            if !is_number(word) {
                return Err(format!("facet {number}: '{}' is not a finite number", shortened(word)));
            }
            *value = word.parse().unwrap_or(f32::INFINITY);
        }
        Ok(vertex)
    }
}
