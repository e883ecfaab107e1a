//! Types of light maps and bakes.

use std::ffi::c_void;

use super::numbers::{EtdAtlasLayout, EtdSide};
use super::render::etd_progress_fn;
pub use {etd_atlas_layout::*, etd_side::*};

/// The source of a mesh's layout in a light map.
#[repr(u32)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum etd_atlas_layout {
    /// The mesh's own texture coordinates where they can be a layout: in [0, 1], without overlaps, and with an area for every
    /// triangle. Other meshes get charts, and the log callback receives a warning for each mesh with unsuitable coordinates.
    ETD_ATLAS_LAYOUT_AUTO = 0,
    /// Charts for all meshes; texture coordinates are ignored.
    ETD_ATLAS_LAYOUT_CHARTS = 1,
    /// The mesh's own texture coordinates. It is an error if they cannot be a layout.
    ETD_ATLAS_LAYOUT_OWN = 2,
}

/// A side of a surface.
#[repr(u32)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum etd_side {
    /// The side of the normal.
    ETD_SIDE_FRONT = 0,
    /// The side opposite to the normal.
    ETD_SIDE_BACK = 1,
}

/// Options for the layout of a light map. 0 in a field always stands for the default.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct etd_atlas_options {
    /// `sizeof(etd_atlas_options)`.
    pub struct_size: usize,
    /// Number of texels along each side of the square, 8192 at most; 0: as many as `texels_per_unit` needs, or 512 if that is 0
    /// too.
    pub resolution: u32,
    /// Width of the gutter around each chart in texels, 64 at most; 0 means 2, and `UINT32_MAX` means none. Bilinear lookups
    /// need a gutter of one texel.
    pub gutter: u32,
    /// Number of texels per scene unit; 0: as many as fit.
    pub texels_per_unit: f64,
    /// Greatest angle between the normals of a chart's triangles and that of its first triangle, degrees, below 90; 0 means 45.
    pub max_angle_deg: f64,
    /// An `etd_atlas_layout`.
    pub layout: EtdAtlasLayout,
    /// Memory limit of the atlas and its bakes, MiB; 0 means 4096. The device's limit also applies.
    pub memory: u32,
    /// Must be 0.
    pub reserved: u64,
    /// Progress callback; may be NULL.
    pub progress: etd_progress_fn,
    /// Passed to `progress`.
    pub user_data: *mut c_void,
}

/// Size of an atlas, and the numbers of its parts.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct etd_atlas_info {
    /// `sizeof(etd_atlas_info)`.
    pub struct_size: usize,
    /// Number of texels in a row.
    pub width: u32,
    /// Number of rows.
    pub height: u32,
    /// Number of vertices of all surfaces.
    pub vertex_count: usize,
    /// Number of triangles of all surfaces.
    pub triangle_count: usize,
    /// Number of surfaces in the atlas.
    pub surface_count: usize,
    /// Number of charts.
    pub chart_count: usize,
    /// Number of texels that triangles cover.
    pub covered_texels: usize,
    /// Number of texels per scene unit in the plane of a chart; the mean for meshes with their own layout.
    pub texels_per_unit: f64,
}

/// A corner of a light-mapped triangle.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct etd_atlas_vertex {
    /// Position in the world frame.
    pub position: [f64; 3],
    /// Unit normal: the shading normal of a smooth surface, and otherwise the mean of the normals of the chart's triangles at
    /// the vertex.
    pub normal: [f32; 3],
    /// Position in the light map, in [0, 1]; (0, 0) is the outer corner of the first texel of row 0.
    pub uv: [f32; 2],
    /// Number of the vertex on its surface: in the mesh as it was added, or of the corner of a triangle or a quad; consecutive
    /// numbers on other shapes.
    pub source: u32,
}

/// A surface in a light map.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct etd_atlas_surface {
    /// Number of the surface in the scene.
    pub surface: u32,
    /// Number of the surface's first vertex in the atlas.
    pub first_vertex: u32,
    /// Number of the surface's vertices.
    pub vertex_count: u32,
    /// Number of the surface's first triangle in the atlas.
    pub first_triangle: u32,
    /// Number of the surface's triangles.
    pub triangle_count: u32,
    /// 1 if the mesh's own texture coordinates are the layout, else 0.
    pub has_own_layout: u32,
    /// If `has_own_layout` is 1: scale and offset from the mesh's (u, v) to the position in the light map, which is (u, v) times
    /// the first two numbers, plus the last two. Otherwise 0.
    pub scale_offset: [f32; 4],
}

/// The arrays of the host that receive a bake.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct etd_bake_target {
    /// `sizeof(etd_bake_target)`.
    pub struct_size: usize,
    /// Three floats for each texel or vertex: irradiance [W m^-2], linear Rec. 709.
    pub irradiance: *mut f32,
    /// Standard error of the irradiance [W m^-2], in the same layout as `irradiance`; NaN where there are too few samples for an
    /// estimate. NULL if standard errors are not wanted.
    pub standard_error: *mut f32,
    /// Number of writable bytes at each of the two pointers.
    pub size: usize,
    /// Bytes from one texel or vertex to the next; 0 means 12, without gaps.
    pub stride: usize,
    /// Bytes from one row of texels to the next; 0 means rows without gaps.
    pub row_stride: usize,
    /// An `etd_side`.
    pub side: EtdSide,
    /// Must be 0.
    pub reserved: u32,
}

enumerations! {
    etd_atlas_layout: ETD_ATLAS_LAYOUT_AUTO, ETD_ATLAS_LAYOUT_CHARTS, ETD_ATLAS_LAYOUT_OWN;
    etd_side: ETD_SIDE_FRONT, ETD_SIDE_BACK;
}

versioned! {
    etd_atlas_options, reserved;
    etd_atlas_info, texels_per_unit;
    etd_bake_target, reserved;
}
