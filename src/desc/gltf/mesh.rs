//! Primitives of meshes as triangles: their attributes, their indices and the shapes of their morph targets.

use std::collections::BTreeMap;

use super::super::json::elided;
use super::accessor::{Accessors, Allowed, unsupported};
use super::document::{Primitive, missing};
use crate::math::DVec3;
use crate::room::check_room;
use crate::{Error, Result};

/// Most vertices and most triangles of all meshes of a document, each mesh counted as often as it is deformed.
const VERTEX_LIMIT: usize = 1 << 26;
const TRIANGLE_LIMIT: usize = 1 << 27;

/// The attribute of the colours of vertices.
pub(super) const COLOR: &str = "COLOR_0";

/// The attribute of the tangents of normal maps.
const TANGENT: &str = "TANGENT";

/// Memory of a vertex of a primitive with all attributes: as the file has them, and as they are kept.
const BYTES_A_VERTEX: usize = 160;
/// Memory of a triangle, with its indices as the file has them.
const BYTES_A_TRIANGLE: usize = 6 * size_of::<u32>();

/// The triangles of a primitive in the frame of its mesh.
#[derive(Clone, Debug)]
pub(super) struct Geometry {
    pub positions: Vec<DVec3>,
    /// Empty, or one per vertex.
    pub normals: Vec<DVec3>,
    /// Empty, or one per vertex.
    pub uvs: Vec<[f32; 2]>,
    /// The further sets of texture coordinates that textures of the material use, each empty or one per vertex.
    pub further_uvs: Vec<Vec<[f32; 2]>>,
    /// Empty, or one per vertex.
    pub colors: Vec<[f32; 4]>,
    /// Empty, or one per vertex.
    pub tangents: Vec<DVec3>,
    pub triangles: Vec<[u32; 3]>,
}

/// What the textures of a primitive's material read at its vertices.
#[derive(Clone, Copy, Debug)]
pub(super) struct VertexReads<'a> {
    /// Sets of texture coordinates, in the order in which textures number them.
    pub uv_sets: &'a [u64],
    /// Whether there is a normal map.
    pub tangents: bool,
}

/// What was left out of the meshes of a document, and how much more of them may be made.
pub(super) struct Meshes<'a> {
    pub accessors: &'a Accessors<'a>,
    vertices_left: usize,
    triangles_left: usize,
    /// Places of what is left out, by the reason.
    left_out: BTreeMap<String, Vec<String>>,
}

impl<'a> Meshes<'a> {
    pub fn new(accessors: &'a Accessors<'a>) -> Self {
        Self { accessors, vertices_left: VERTEX_LIMIT, triangles_left: TRIANGLE_LIMIT, left_out: BTreeMap::new() }
    }

    /// Notes that something is left out.
    pub fn leave_out(&mut self, why: &str, path: &str) {
        let places = self.left_out.entry(why.to_owned()).or_default();
        // A mesh that is used twice is named once.
        if !places.iter().any(|known| known == path) && places.len() < 100 {
            places.push(path.to_owned());
        }
    }

    /// One warning for each reason why something was left out.
    pub fn warn(self, warnings: &mut Vec<String>) {
        for (why, places) in self.left_out {
            super::warn(warnings, format!("{why}: {}", super::listed(places)));
        }
    }

    /// Counts vertices and triangles before they are made.
    pub fn spend(&mut self, path: &str, vertices: usize, triangles: usize) -> Result<()> {
        let left = self.vertices_left.checked_sub(vertices).zip(self.triangles_left.checked_sub(triangles));
        let Some((vertices, triangles)) = left else {
            let message = format!(
                "the meshes of the file are too large, expected {VERTEX_LIMIT} vertices and {TRIANGLE_LIMIT} triangles at most"
            );
            return Err(Error::invalid(path, message));
        };
        (self.vertices_left, self.triangles_left) = (vertices, triangles);
        Ok(())
    }

    /// Reads a primitive with the weights of its morph targets; `None` where it has no triangles.
    pub fn read(
        &mut self,
        path: &str,
        primitive: &Primitive<'_>,
        weights: &[f64],
        reads: VertexReads<'_>,
    ) -> Result<Option<Geometry>> {
        let what = match primitive.mode.unwrap_or(4) {
            0 => "points",
            1..=3 => "lines",
            mode @ 4..=6 => return self.triangles_of(path, primitive, mode, weights, reads),
            other => {
                let message = format!("{other} is no mode, expected a whole number from 0 to 6");
                return Err(Error::invalid(format!("{path}.mode"), message));
            }
        };
        self.leave_out(&format!("{what} are not drawn"), path);
        Ok(None)
    }

    fn triangles_of(
        &mut self,
        path: &str,
        primitive: &Primitive<'_>,
        mode: u32,
        weights: &[f64],
        reads: VertexReads<'_>,
    ) -> Result<Option<Geometry>> {
        let at = |key: &str| format!("{path}.attributes.{key}");
        let accessors = self.accessors;
        let Some(&positions) = primitive.attributes.get("POSITION") else {
            self.leave_out("primitives without POSITION are not drawn", path);
            return Ok(None);
        };
        if primitive.extensions.contains_key("KHR_draco_mesh_compression")
            && !accessors.has_bytes(&at("POSITION"), positions)?
        {
            let message = "the primitive is compressed (KHR_draco_mesh_compression), which this library does not read";
            return Err(unsupported(path, message));
        }
        let count = usize::try_from(accessors.count(&at("POSITION"), positions)?).unwrap_or(usize::MAX);
        let corners = match primitive.indices {
            Some(index) => usize::try_from(accessors.count(&format!("{path}.indices"), index)?).unwrap_or(usize::MAX),
            None => count,
        };
        let triangle_count = if mode == 4 { corners / 3 } else { corners.saturating_sub(2) };
        self.spend(path, count, triangle_count)?;
        let bytes =
            count.saturating_mul(BYTES_A_VERTEX).saturating_add(triangle_count.saturating_mul(BYTES_A_TRIANGLE));
        check_room(bytes).map_err(|error| error.at(path))?;
        let positions: Vec<_> =
            accessors.floats::<3>(&at("POSITION"), positions, Allowed::Floats)?.into_iter().map(double).collect();
        let per_vertex = |key: &str, index: u64| {
            let found = accessors.count(&at(key), index)?;
            if found == count as u64 {
                return Ok(());
            }
            Err(Error::invalid(at(key), format!("{found} elements for {count} positions, expected one each")))
        };
        let mut normals = Vec::new();
        if let Some(index) = primitive.attributes.get("NORMAL") {
            per_vertex("NORMAL", *index)?;
            let read = accessors.floats::<3>(&at("NORMAL"), *index, Allowed::Floats)?;
            normals = read.into_iter().map(double).collect();
        }
        let uv_keys: Vec<String> = reads.uv_sets.iter().map(|set| format!("TEXCOORD_{set}")).collect();
        let mut sets = Vec::with_capacity(uv_keys.len());
        for key in &uv_keys {
            let mut uvs = Vec::new();
            if let Some(index) = primitive.attributes.get(key.as_str()) {
                per_vertex(key, *index)?;
                uvs = accessors.floats::<2>(&at(key), *index, Allowed::Fractions)?;
                // glTF counts v from the upper edge of an image, and scenes from the lower one.
                uvs.iter_mut().for_each(|[_, v]| *v = 1.0 - *v);
            }
            sets.push(uvs);
        }
        let mut sets = sets.into_iter();
        let (uvs, further_uvs) = (sets.next().unwrap_or_default(), sets.collect());
        let mut colors = Vec::new();
        if let Some(index) = primitive.attributes.get(COLOR) {
            per_vertex(COLOR, *index)?;
            colors = self.colors(&at(COLOR), *index)?;
        }
        let mut tangents = Vec::new();
        if let Some(index) = primitive.attributes.get(TANGENT).filter(|_| reads.tangents && !normals.is_empty()) {
            per_vertex(TANGENT, *index)?;
            // The fourth number is the side to which v grows, which texture coordinates say.
            let read = accessors.floats::<4>(&at(TANGENT), *index, Allowed::Fractions)?;
            tangents = read.into_iter().map(|[x, y, z, _]| double([x, y, z])).collect();
        }
        for key in primitive.attributes.keys() {
            let is_read =
                ["POSITION", "NORMAL", COLOR, TANGENT].contains(&key.as_str()) || uv_keys.iter().any(|it| it == key);
            // Joints and weights are read with the skin, and names that begin with an underscore mean something to programs alone.
            let is_elsewhere = key.starts_with("JOINTS_") || key.starts_with("WEIGHTS_") || key.starts_with('_');
            if !is_read && !is_elsewhere {
                self.leave_out(&format!("the attribute {} is left out", elided(key)), path);
            }
        }
        let mut geometry = Geometry { positions, normals, uvs, further_uvs, colors, tangents, triangles: Vec::new() };
        self.morph(path, primitive, weights, &mut geometry)?;
        let indices = match primitive.indices {
            Some(index) => {
                let path = format!("{path}.indices");
                let indices = accessors.whole::<1>(&path, index, Allowed::Whole)?;
                if let Some(i) = indices.iter().position(|[index]| *index as usize >= count) {
                    let message = format!("element {i} is {}, expected an index below {count}", indices[i][0]);
                    return Err(Error::invalid(path, message));
                }
                Some(indices)
            }
            None => None,
        };
        let corner = |i: usize| indices.as_ref().map_or(i as u32, |indices| indices[i][0]);
        geometry.triangles = (0..triangle_count)
            .map(|i| match mode {
                4 => [corner(3 * i), corner(3 * i + 1), corner(3 * i + 2)],
                // Every other triangle of a strip begins with its second corner, so that all have the same side in front.
                5 if i % 2 == 1 => [corner(i + 1), corner(i), corner(i + 2)],
                5 => [corner(i), corner(i + 1), corner(i + 2)],
                _ => [corner(i + 1), corner(i + 2), corner(0)],
            })
            .collect();
        if mode == 4 && corners % 3 != 0 {
            self.leave_out("the corners after the last whole triangle are left out", path);
        }
        if geometry.triangles.is_empty() {
            self.leave_out("primitives without triangles are not drawn", path);
            return Ok(None);
        }
        Ok(Some(geometry))
    }

    /// The colours of vertices, which are in linear light.
    fn colors(&mut self, path: &str, index: u64) -> Result<Vec<[f32; 4]>> {
        let mut colors = if self.accessors.is_of_type(path, index, "VEC3")? {
            let read = self.accessors.floats::<3>(path, index, Allowed::Fractions)?;
            read.into_iter().map(|[r, g, b]| [r, g, b, 1.0]).collect()
        } else {
            self.accessors.floats::<4>(path, index, Allowed::Fractions)?
        };
        let mut is_clamped = false;
        for color in &mut colors {
            let fitting = color.map(|channel| channel.clamp(0.0, 1.0));
            is_clamped |= fitting != *color;
            *color = fitting;
        }
        if is_clamped {
            self.leave_out("colours of vertices are out of range; the nearest ones in range are used", path);
        }
        Ok(colors)
    }

    /// Adds the morph targets by their weights.
    fn morph(&mut self, path: &str, primitive: &Primitive<'_>, weights: &[f64], geometry: &mut Geometry) -> Result<()> {
        for (i, (target, weight)) in primitive.targets.iter().zip(weights).enumerate() {
            if *weight == 0.0 {
                continue;
            }
            for (key, index) in target {
                let path = format!("{path}.targets[{i}].{key}");
                let values = match key.as_str() {
                    "POSITION" => &mut geometry.positions,
                    "NORMAL" => &mut geometry.normals,
                    TANGENT => &mut geometry.tangents,
                    _ => {
                        self.leave_out(&format!("the morphed attribute {} is left out", elided(key)), &path);
                        continue;
                    }
                };
                // Normals and tangents that are only morphed, without any to start from, have no meaning.
                if values.is_empty() {
                    continue;
                }
                let found = self.accessors.count(&path, *index)?;
                if found != values.len() as u64 {
                    let message = format!("{found} elements for {} vertices, expected one each", values.len());
                    return Err(Error::invalid(path, message));
                }
                let offsets = self.accessors.floats::<3>(&path, *index, Allowed::Floats)?;
                values.iter_mut().zip(offsets).for_each(|(value, offset)| *value += *weight * double(offset));
            }
        }
        Ok(())
    }
}

/// The weights of a mesh's morph targets: those of an animation, of the node, or of the mesh.
pub(super) fn weights<'a>(
    animated: Option<&'a Vec<f64>>,
    node: Option<&'a Vec<f64>>,
    mesh: Option<&'a Vec<f64>>,
) -> &'a [f64] {
    animated.or(node).or(mesh).map_or(&[], Vec::as_slice)
}

/// The accessor of an attribute that another one needs.
pub(super) fn needed(path: &str, primitive: &Primitive<'_>, key: &str) -> Result<u64> {
    let found = primitive.attributes.get(key).copied();
    found.ok_or_else(|| missing(&format!("{path}.attributes"), key))
}

fn double(value: [f32; 3]) -> DVec3 {
    DVec3::from_array(value.map(f64::from))
}
