//! Types that say what surfaces and meshes of a scene are.

pub use etd_shape_kind::*;

use super::numbers::EtdShapeKind;

/// What a surface is.
#[repr(u32)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum etd_shape_kind {
    /// Nothing: the surface was removed.
    ETD_SHAPE_NONE = 0,
    /// A triangle.
    ETD_SHAPE_TRIANGLE = 1,
    /// A flat convex quadrilateral.
    ETD_SHAPE_QUAD = 2,
    /// A mesh.
    ETD_SHAPE_MESH = 3,
    /// A sphere, or an ellipsoid by its transform.
    ETD_SHAPE_SPHERE = 4,
    /// A flat round disk.
    ETD_SHAPE_DISK = 5,
    /// A part of a quadric: also a cylinder, a cone and a paraboloid.
    ETD_SHAPE_QUADRIC = 6,
}

/// The shape of a surface, in its own frame. Fields that the kind does not have are 0.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct etd_shape {
    /// `sizeof(etd_shape)`, set by the caller (`ETD_SHAPE_INIT`).
    pub struct_size: usize,
    /// An `etd_shape_kind`.
    pub kind: EtdShapeKind,
    /// Number of the mesh; `ETD_NONE` for other kinds.
    pub mesh: u32,
    /// Of a mesh: 1 where the normals of its vertices are interpolated.
    pub smooth: u32,
    /// 0.
    pub reserved: u32,
    /// Three rows of four: from the shape's own frame to the one from which `etd_surface.transform` leads to the world. It is the
    /// identity but for shapes that stand along an axis, such as cylinders.
    pub frame: [f64; 12],
    /// Three or four vertices of a triangle or quad.
    pub vertices: [f64; 12],
    /// Centre of a sphere or disk.
    pub centre: [f64; 3],
    /// Normal of a disk, unit length.
    pub normal: [f64; 3],
    /// Radius of a sphere or disk.
    pub radius: f64,
    /// The coefficients a to j of a quadric, as `etd_scene_add_quadric` takes them.
    pub coefficients: [f64; 10],
    /// Smallest corner of the box that clips a quadric; may be infinite.
    pub clip_min: [f64; 3],
    /// Largest corner.
    pub clip_max: [f64; 3],
}

/// What a mesh has.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct etd_mesh_info {
    /// `sizeof(etd_mesh_info)`, set by the caller (`ETD_MESH_INFO_INIT`).
    pub struct_size: usize,
    /// Number of vertices.
    pub vertex_count: usize,
    /// Number of triangles.
    pub triangle_count: usize,
    /// 1 where its vertices have normals.
    pub has_normals: u32,
    /// 1 where its vertices have texture coordinates.
    pub has_uvs: u32,
}

enumerations! {
    etd_shape_kind: ETD_SHAPE_NONE, ETD_SHAPE_TRIANGLE, ETD_SHAPE_QUAD, ETD_SHAPE_MESH, ETD_SHAPE_SPHERE, ETD_SHAPE_DISK,
        ETD_SHAPE_QUADRIC;
}

versioned! {
    etd_shape, clip_max;
    etd_mesh_info, has_uvs;
}
