//! What scenes are described by.

use std::ffi::{c_char, c_void};

use super::device::etd_release_fn;
use super::numbers::{EtdBsdf, EtdCameraType, EtdFovAxis, EtdPositionFormat, EtdSharing, EtdUsage};
pub use {etd_bsdf::*, etd_camera_type::*, etd_fov_axis::*, etd_position_format::*, etd_sharing::*, etd_usage::*};

/// How a scene's geometry is kept.
#[repr(u32)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum etd_usage {
    /// As one piece where possible: fastest to trace. At the first change of geometry after it was built it becomes
    /// dynamic by itself.
    ETD_USAGE_STATIC = 0,
    /// Every larger mesh has a hierarchy of its own, so that adding, moving or removing something touches nothing else.
    ETD_USAGE_DYNAMIC = 1,
}

/// How a scene is made.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct etd_scene_options {
    /// `sizeof(etd_scene_options)`.
    pub struct_size: usize,
    /// An `etd_usage`.
    pub usage: EtdUsage,
    /// Must be 0.
    pub reserved: u32,
    /// The folder in which a scene from text looks for mesh files; NULL: the current one.
    pub base_dir: *const c_char,
    /// A parameter file of the report's renderer that overrides the scene's own settings; NULL: none.
    pub params_file: *const c_char,
}

/// How a camera projects.
#[repr(u32)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum etd_camera_type {
    /// A pinhole at `origin`.
    ETD_CAMERA_PERSPECTIVE = 0,
    /// The report's camera: `origin` is the centre of a view plane, the eye lies behind it, and the length of `up` scales
    /// the plane.
    ETD_CAMERA_VIEW_PLANE = 1,
}

/// The side of the image that a camera's field of view spans.
#[repr(u32)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum etd_fov_axis {
    /// The width.
    ETD_FOV_HORIZONTAL = 0,
    /// The height; perspective cameras only.
    ETD_FOV_VERTICAL = 1,
}

/// Where a scene is seen from: world frame, right-handed, lengths in scene units.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct etd_camera {
    /// `sizeof(etd_camera)`.
    pub struct_size: usize,
    /// An `etd_camera_type`.
    pub projection: EtdCameraType,
    /// An `etd_fov_axis`.
    pub fov_axis: EtdFovAxis,
    /// The eye, or the centre of the view plane.
    pub origin: [f64; 3],
    /// A point in the middle of the image, other than `origin`.
    pub look_at: [f64; 3],
    /// Upwards in the image, not parallel to the view; any length.
    pub up: [f64; 3],
    /// Full angle of view, degrees, between 0 and 180.
    pub fov_deg: f64,
}

/// How a surface scatters light.
#[repr(u32)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum etd_bsdf {
    /// Absorbs everything.
    ETD_BSDF_BLACK = 0,
    /// Lambert, by `color`.
    ETD_BSDF_LAMBERT = 1,
    /// Fujii's improved Oren-Nayar, by `color` and `roughness`.
    ETD_BSDF_OREN_NAYAR = 2,
    /// Oren and Nayar's qualitative model, by `color` and `sigma_deg`.
    ETD_BSDF_OREN_NAYAR_QUALITATIVE = 3,
    /// A perfect mirror, by `color`.
    ETD_BSDF_MIRROR = 4,
    /// Smooth clear glass, by `ior` and `exterior_ior`.
    ETD_BSDF_DIELECTRIC = 5,
}

/// A material. Fields that its model does not use are not looked at.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct etd_material {
    /// `sizeof(etd_material)`.
    pub struct_size: usize,
    /// An `etd_bsdf`.
    pub bsdf: EtdBsdf,
    /// Albedo or reflectance, linear, [0, 1] per channel.
    pub color: [f32; 3],
    /// Fujii's sigma', in [0, 1].
    pub roughness: f32,
    /// Standard deviation of the facets' slope angle, degrees, in [0, 90].
    pub sigma_deg: f32,
    /// Index of refraction on the side opposite to the normal, > 0.
    pub ior: f32,
    /// Index of refraction on the normal's side, > 0; 0 means 1.
    pub exterior_ior: f32,
    /// Survival probability of Russian roulette at this material, in (0, 1], for renders with `ETD_ROULETTE_FILE`; 0: the
    /// library chooses in these too. It changes noise and time, never the image.
    pub survival: f32,
    /// Must be 0.
    pub reserved: u32,
}

/// What numbers an array of positions holds.
#[repr(u32)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum etd_position_format {
    /// Three `float`.
    ETD_POSITION_FLOAT3 = 0,
    /// Three `double`; always copied.
    ETD_POSITION_DOUBLE3 = 1,
}

/// Who keeps the arrays of a mesh.
#[repr(u32)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum etd_sharing {
    /// They are copied during the call.
    ETD_COPY = 0,
    /// They are read in place, and must neither change nor go away until `release` is called. Positions must be `float`,
    /// and 16 bytes readable from the last one on. A mesh that emits light is copied nevertheless when it is built.
    ETD_SHARE = 1,
}

/// A triangle mesh in arrays of the host.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct etd_mesh {
    /// `sizeof(etd_mesh)`.
    pub struct_size: usize,
    /// One position for each vertex, the mesh's own frame.
    pub positions: *const c_void,
    /// Bytes from one position to the next; 0: they lie close together.
    pub position_stride: usize,
    /// Bytes that can be read from `positions` on; 0: up to the end of the last stride. Only looked at with `ETD_SHARE`.
    pub position_bytes: usize,
    /// Number of vertices, at least 1 and below 2^32 - 1.
    pub vertex_count: usize,
    /// Three vertex numbers for each triangle, counter-clockwise seen from outside.
    pub indices: *const u32,
    /// Bytes from one triangle's numbers to the next; 0: they lie close together.
    pub index_stride: usize,
    /// Number of triangles, at least 1 and below 2^32 - 1.
    pub triangle_count: usize,
    /// One normal for each vertex, any length; NULL: none.
    pub normals: *const f32,
    /// Bytes from one normal to the next; 0: they lie close together.
    pub normal_stride: usize,
    /// One texture coordinate for each vertex; NULL: none.
    pub uvs: *const f32,
    /// Bytes from one texture coordinate to the next; 0: they lie close together.
    pub uv_stride: usize,
    /// An `etd_position_format`.
    pub position_format: EtdPositionFormat,
    /// An `etd_sharing`.
    pub sharing: EtdSharing,
    /// With `ETD_SHARE`: told once that the arrays are no longer read; may be NULL. Not called if the call fails.
    pub release: etd_release_fn,
    /// Given to `release`.
    pub user_data: *mut c_void,
    /// A name to find it by, unique among meshes; NULL: none.
    pub name: *const c_char,
}

/// Everything about a surface but its shape.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct etd_surface {
    /// `sizeof(etd_surface)`.
    pub struct_size: usize,
    /// Number of its material; `ETD_NONE` for a surface that emits light and reflects none.
    pub material: u32,
    /// Emitted radiance on the normal's side [W m^-2 sr^-1]; all zero: it does not emit. Quadrics and disks cannot.
    pub emission: [f32; 3],
    /// Object to world, three rows of four (the last column translates); all zero: none.
    pub transform: [f64; 12],
}

enumerations! {
    etd_usage: ETD_USAGE_STATIC, ETD_USAGE_DYNAMIC;
    etd_camera_type: ETD_CAMERA_PERSPECTIVE, ETD_CAMERA_VIEW_PLANE;
    etd_fov_axis: ETD_FOV_HORIZONTAL, ETD_FOV_VERTICAL;
    etd_bsdf:
        ETD_BSDF_BLACK, ETD_BSDF_LAMBERT, ETD_BSDF_OREN_NAYAR, ETD_BSDF_OREN_NAYAR_QUALITATIVE, ETD_BSDF_MIRROR,
        ETD_BSDF_DIELECTRIC;
    etd_position_format: ETD_POSITION_FLOAT3, ETD_POSITION_DOUBLE3;
    etd_sharing: ETD_COPY, ETD_SHARE;
}

versioned! {
    etd_scene_options, params_file;
    etd_camera, fov_deg;
    etd_material, reserved;
    etd_mesh, name;
    etd_surface, transform;
}
