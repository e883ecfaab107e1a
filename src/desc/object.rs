//! Surfaces as described: shapes, meshes, where they stand and what they emit.

use crate::buffer::Buffer;
use crate::math::{Bounds, DAffine3, DVec3};
use crate::spectrum::Rgb;

/// An indexed triangle mesh in its own frame. Indices are below the number of vertices, numbers finite (checked on
/// reading); degenerate triangles may be present.
#[derive(Clone, Debug, Default)]
pub struct MeshDesc {
    /// Its name, or its file.
    pub name: String,
    /// JSON path, for messages.
    pub path: String,
    /// One position per vertex.
    pub positions: Vec<DVec3>,
    /// Empty, or one normal per vertex (any length; zero means none there).
    pub normals: Vec<[f32; 3]>,
    /// Empty, or one uv per vertex.
    pub uvs: Vec<[f32; 2]>,
    /// Three vertex indices per triangle, counter-clockwise seen from outside.
    pub triangles: Vec<[u32; 3]>,
    /// Arrays of the host program, read in place; where they are given, the vectors above are empty.
    pub host: Option<HostMesh>,
}

/// A triangle mesh in memory of the host program, in the form that the ray kernel reads.
///
/// Sixteen bytes must be readable from the last position on. Coordinates should be near the mesh's own origin: they are
/// not shifted.
#[derive(Clone, Debug)]
pub struct HostMesh {
    /// One position per vertex.
    pub positions: Buffer<[f32; 3]>,
    /// Three vertex indices per triangle.
    pub triangles: Buffer<[u32; 3]>,
    /// One normal per vertex, where there are any.
    pub normals: Option<Buffer<[f32; 3]>>,
    /// One uv per vertex, where there are any.
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

    /// Position of a vertex; panics for an index out of range, as all that follow do.
    pub fn position(&self, vertex: usize) -> DVec3 {
        match &self.host {
            None => self.positions[vertex],
            Some(host) => DVec3::from_array(host.positions.get(vertex).map(f64::from)),
        }
    }

    /// The vertices of a triangle.
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

    /// Whether it has normals of its own.
    pub fn has_normals(&self) -> bool {
        self.host.as_ref().map_or(!self.normals.is_empty(), |host| host.normals.is_some())
    }

    /// Whether it has texture coordinates.
    pub fn has_uvs(&self) -> bool {
        self.host.as_ref().map_or(!self.uvs.is_empty(), |host| host.uvs.is_some())
    }

    /// Box around all vertices, in the mesh's own frame.
    pub fn bounds(&self) -> Bounds {
        Bounds::around((0..self.vertex_count()).map(|vertex| self.position(vertex)))
    }
}

/// Something to hit: a shape at a place, of a material, perhaps emitting.
#[derive(Clone, Debug)]
pub struct SurfaceDesc {
    /// JSON path, for messages and `info`.
    pub path: String,
    /// Its geometry.
    pub shape: ShapeDesc,
    /// The shape's frame to the object's: where a cylinder stands, how large an ellipsoid is. Invertible and finite.
    pub local: DAffine3,
    /// Object to world; identity where none was given. Invertible and finite.
    pub transform: DAffine3,
    /// Index into [`SceneDesc::materials`](super::SceneDesc::materials).
    pub material: usize,
    /// Emitted radiance [W m^-2 sr^-1] on the normal's side; `None` for a surface that does not emit. Quadrics and
    /// disks never do.
    pub emission: Option<Rgb>,
    /// Removed: not there for any ray. Surfaces keep their numbers when others are removed.
    pub hidden: bool,
}

impl SurfaceDesc {
    /// The shape's frame to the world's.
    pub fn to_world(&self) -> DAffine3 {
        self.transform * self.local
    }
}

/// A shape in its own frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ShapeDesc {
    /// A sphere, normals outwards. A non-uniform transform makes it an ellipsoid.
    Sphere {
        /// Centre.
        centre: DVec3,
        /// Radius > 0.
        radius: f64,
    },
    /// A triangle with normal (v1 - v0) x (v2 - v0).
    Triangle([DVec3; 3]),
    /// A convex planar quadrilateral in order around its edge, with the normal of its first three vertices.
    Quad([DVec3; 4]),
    /// A mesh.
    Mesh {
        /// Index into [`SceneDesc::meshes`](super::SceneDesc::meshes).
        mesh: usize,
        /// Interpolate the vertex normals (made from the faces where the mesh has none) instead of flat shading.
        smooth: bool,
    },
    /// a x^2 + b y^2 + c z^2 + 2d xy + 2e yz + 2f xz + 2g x + 2h y + 2i z + j = 0 inside `clip`.
    Quadric {
        /// The ten coefficients a to j. The normal is the gradient.
        coefficients: [f64; 10],
        /// Only what lies inside is there. May be infinite where the quadric itself is bounded.
        clip: Bounds,
    },
    /// A flat round disk; a clip box cannot cut a plane round. Never emits.
    Disk {
        /// Centre.
        centre: DVec3,
        /// Normal, unit length.
        normal: DVec3,
        /// Radius > 0.
        radius: f64,
    },
}
