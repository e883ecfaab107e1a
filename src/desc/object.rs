//! Descriptions of surfaces: shapes, meshes, transforms and emission.

use std::sync::Arc;

use super::{AreaWebDesc, SpectrumDesc};
use crate::buffer::Buffer;
use crate::math::{Bounds, DAffine3, DVec3};
use crate::spectrum::Rgb;

/// An indexed triangle mesh in its own frame. Indices are below the number of vertices and numbers are finite, both of
/// which are checked on reading. Degenerate triangles may be present.
#[derive(Clone, Debug, Default)]
pub struct MeshDesc {
    /// The mesh's name, or its file.
    pub name: String,
    /// JSON path, for messages.
    pub path: String,
    /// One position per vertex.
    pub positions: Vec<DVec3>,
    /// Empty, or one normal per vertex, of any length. A zero vector means that the vertex has no normal.
    pub normals: Vec<[f32; 3]>,
    /// Empty, or one uv per vertex.
    pub uvs: Vec<[f32; 2]>,
    /// Three vertex indices per triangle, counter-clockwise seen from outside.
    pub triangles: Vec<[u32; 3]>,
    /// The sets 1, 2, ... of texture coordinates for textures that name them ([`TextureMapping::Uv`](super::TextureMapping::Uv)), each
    /// empty (the mesh lacks it) or with one uv per vertex; seven at most. Set 0 is [`Self::uvs`].
    pub further_uvs: Vec<Vec<[f32; 2]>>,
    /// Empty, or one colour per vertex for textures that ask for it
    /// ([`TextureDesc::vertex_colors`](super::TextureDesc::vertex_colors)): red, green and blue in linear light, each >= 0, and
    /// opacity in [0, 1].
    pub colors: Vec<[f32; 4]>,
    /// Empty, or one tangent per vertex for normal maps on smooth surfaces, of any length: the direction in which the first texture
    /// coordinate grows; an image that is turned on the surface is turned from there. Where there are none, normal maps have those of MikkTSpace.
    pub tangents: Vec<[f32; 3]>,
    /// Arrays of the host program, read in place; where they are given, the vectors above are empty, but for the colours, the tangents
    /// and the further sets.
    pub host: Option<HostMesh>,
}

/// A triangle mesh in the memory of the host program, in the layout that the ray kernel reads.
///
/// Sixteen bytes must be readable from the last position on. The mesh's coordinates should be near its own origin,
/// because they are not shifted.
#[derive(Clone, Debug)]
pub struct HostMesh {
    /// One position per vertex.
    pub positions: Buffer<[f32; 3]>,
    /// Three vertex indices per triangle.
    pub triangles: Buffer<[u32; 3]>,
    /// One normal per vertex, where the mesh has normals.
    pub normals: Option<Buffer<[f32; 3]>>,
    /// One uv per vertex, where the mesh has texture coordinates.
    pub uvs: Option<Buffer<[f32; 2]>>,
}

impl MeshDesc {
    /// Number of vertices.
    pub fn vertex_count(&self) -> usize {
        self.host.as_ref().map_or(self.positions.len(), |host| host.positions.len())
    }

    /// Number of triangles.
    pub fn triangle_count(&self) -> usize {
        self.host.as_ref().map_or(self.triangles.len(), |host| host.triangles.len())
    }

    /// Position of a vertex. Like the accessors that follow, this function panics for an index out of range.
    pub fn position(&self, vertex: usize) -> DVec3 {
        match &self.host {
            None => self.positions[vertex],
            Some(host) => DVec3::from_array(host.positions.get(vertex).map(f64::from)),
        }
    }

    /// The vertex indices of a triangle.
    pub fn triangle(&self, index: usize) -> [u32; 3] {
        self.host.as_ref().map_or_else(|| self.triangles[index], |host| host.triangles.get(index))
    }

    /// Normal of a vertex, where the mesh has normals.
    pub fn normal(&self, vertex: usize) -> Option<[f32; 3]> {
        match &self.host {
            None => (!self.normals.is_empty()).then(|| self.normals[vertex]),
            Some(host) => host.normals.as_ref().map(|normals| normals.get(vertex)),
        }
    }

    /// Texture coordinates of a vertex, where the mesh has them.
    pub fn uv(&self, vertex: usize) -> Option<[f32; 2]> {
        match &self.host {
            None => (!self.uvs.is_empty()).then(|| self.uvs[vertex]),
            Some(host) => host.uvs.as_ref().map(|uvs| uvs.get(vertex)),
        }
    }

    /// Most sets of texture coordinates, with the first.
    pub const MOST_UV_SETS: usize = 8;

    /// Texture coordinates of a vertex in a set, of which 0 is that of [`Self::uv`]; `None` where the mesh lacks it.
    pub fn uv_of_set(&self, set: u32, vertex: usize) -> Option<[f32; 2]> {
        match set.checked_sub(1) {
            None => self.uv(vertex),
            Some(further) => self.further_uvs.get(further as usize).and_then(|uvs| uvs.get(vertex)).copied(),
        }
    }

    /// Whether the mesh has normals of its own.
    pub fn has_normals(&self) -> bool {
        self.host.as_ref().map_or(!self.normals.is_empty(), |host| host.normals.is_some())
    }

    /// Whether the mesh has texture coordinates.
    pub fn has_uvs(&self) -> bool {
        self.host.as_ref().map_or(!self.uvs.is_empty(), |host| host.uvs.is_some())
    }

    /// Box around all vertices, in the mesh's own frame.
    pub fn bounds(&self) -> Bounds {
        Bounds::around((0..self.vertex_count()).map(|vertex| self.position(vertex)))
    }
}

/// A surface that rays can hit: a shape with a transform, a material and perhaps an emission.
#[derive(Clone, Debug)]
pub struct SurfaceDesc {
    /// JSON path, for messages and `info`.
    pub path: String,
    /// The name of the object that the surface is, or is a part of: several surfaces may have one name. Empty where it has none.
    pub name: String,
    /// The surface's geometry.
    pub shape: ShapeDesc,
    /// Transform from the shape's frame to the object's frame. It contains the position of a cylinder and the size of
    /// an ellipsoid, for example. It is invertible and finite.
    pub local: DAffine3,
    /// Transform from the object's frame to the world frame; the identity where none was given. It is invertible and
    /// finite.
    pub transform: DAffine3,
    /// Index into [`SceneDesc::materials`](super::SceneDesc::materials); `None` for a surface that reflects nothing.
    pub material: Option<usize>,
    /// Emitted radiance [W m^-2 sr^-1] on the normal's side, or with a `web` the factor on it; `None` for a surface that does not emit. Of
    /// the quadrics, only cylinders emit.
    pub emission: Option<Rgb>,
    /// Whether the surface emits on its other side too, with the same radiance. It has no effect on a surface that does not emit;
    /// spheres, which are closed, emit outwards only.
    pub emits_both: bool,
    /// How a flat surface with an emission of its own shines by direction; `None` for one that shines evenly.
    pub web: Option<Arc<AreaWebDesc>>,
    /// The shape of the spectrum of an emission of its own, of which renders in wavelengths get the luminance of `emission`; `None` for
    /// the smooth spectrum of the colour times that of D65.
    pub spectrum: Option<SpectrumDesc>,
    /// Whether the surface was removed, so that no ray hits it. The other surfaces keep their numbers.
    pub hidden: bool,
}

impl SurfaceDesc {
    /// Transform from the shape's frame to the world frame.
    pub fn to_world(&self) -> DAffine3 {
        self.transform * self.local
    }

    /// What the object of the surface is called: its name, or its path where it has none.
    pub fn object(&self) -> &str {
        if self.name.is_empty() { &self.path } else { &self.name }
    }
}

/// A shape in its own frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ShapeDesc {
    /// A sphere with its normals outwards. A non-uniform transform makes the sphere an ellipsoid.
    Sphere {
        /// Centre.
        centre: DVec3,
        /// Radius > 0.
        radius: f64,
    },
    /// A triangle with normal (v1 - v0) x (v2 - v0).
    Triangle([DVec3; 3]),
    /// A convex planar quadrilateral. Its vertices are in order around its edge, and its normal is that of its first
    /// three vertices.
    Quad([DVec3; 4]),
    /// A mesh.
    Mesh {
        /// Index into [`SceneDesc::meshes`](super::SceneDesc::meshes).
        mesh: usize,
        /// Whether the vertex normals are interpolated, instead of flat shading. They are computed from the faces where
        /// the mesh has none.
        smooth: bool,
    },
    /// The part of a x^2 + b y^2 + c z^2 + 2d xy + 2e yz + 2f xz + 2g x + 2h y + 2i z + j = 0 inside `clip`.
    Quadric {
        /// The ten coefficients a to j. The normal is the gradient.
        coefficients: [f64; 10],
        /// The box that clips the quadric. It may be infinite where the quadric itself is bounded.
        clip: Bounds,
    },
    /// A flat round disk, which a quadric cannot represent because a clip box cannot cut a plane round.
    Disk {
        /// Centre.
        centre: DVec3,
        /// Normal, unit length.
        normal: DVec3,
        /// Radius > 0.
        radius: f64,
    },
}
