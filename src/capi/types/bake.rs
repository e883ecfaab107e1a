//! Light maps.

use std::ffi::c_void;

use super::numbers::{EtdAtlasLayout, EtdSide};
use super::render::etd_progress_fn;
pub use {etd_atlas_layout::*, etd_side::*};

/// Where the layout of a mesh in a light map comes from.
#[repr(u32)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum etd_atlas_layout {
    /// The mesh's own texture coordinates where they are fit for it (in [0, 1], without overlaps, every triangle with an area), else
    /// charts; the log callback is told of those that are not.
    ETD_ATLAS_LAYOUT_AUTO = 0,
    /// Charts, whatever coordinates a mesh has.
    ETD_ATLAS_LAYOUT_CHARTS = 1,
    /// The mesh's own texture coordinates; an error where they are not fit for it.
    ETD_ATLAS_LAYOUT_OWN = 2,
}

/// A side of a surface.
#[repr(u32)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum etd_side {
    /// The one that the normal is on.
    ETD_SIDE_FRONT = 0,
    /// The other one.
    ETD_SIDE_BACK = 1,
}

/// How a light map is laid out. 0 always stands for the default.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct etd_atlas_options {
    /// `sizeof(etd_atlas_options)`.
    pub struct_size: usize,
    /// Texels along the sides of the square, 8192 at most; 0: as many as `texels_per_unit` needs, or 512.
    pub resolution: u32,
    /// Texels around each chart that are its own, 64 at most; 0 means 2, `UINT32_MAX` none. One is what bilinear lookups need.
    pub gutter: u32,
    /// Texels for a unit of length; 0: as many as fit.
    pub texels_per_unit: f64,
    /// How far the normals of a chart's triangles may be from the first one's, degrees, below 90; 0 means 45.
    pub max_angle_deg: f64,
    /// An `etd_atlas_layout`.
    pub layout: EtdAtlasLayout,
    /// Most memory that the atlas and its bakes may take, MiB; 0 means 4096. The device's limit holds beside it.
    pub memory: u32,
    /// Must be 0.
    pub reserved: u64,
    /// Told how far it is; may be NULL.
    pub progress: etd_progress_fn,
    /// Given to `progress`.
    pub user_data: *mut c_void,
}

/// How large an atlas is.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct etd_atlas_info {
    /// `sizeof(etd_atlas_info)`.
    pub struct_size: usize,
    /// Texels in a row.
    pub width: u32,
    /// Rows.
    pub height: u32,
    /// Vertices of all surfaces.
    pub vertex_count: usize,
    /// Triangles of all surfaces.
    pub triangle_count: usize,
    /// Surfaces that are there.
    pub surface_count: usize,
    /// Charts.
    pub chart_count: usize,
    /// Texels that triangles cover.
    pub covered_texels: usize,
    /// Texels for a unit of length, along the plane of a chart; for meshes with their own layout, on the mean.
    pub texels_per_unit: f64,
}

/// A corner of a light-mapped triangle.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct etd_atlas_vertex {
    /// World frame.
    pub position: [f64; 3],
    /// Unit normal: the shading normal of a smooth surface, else the mean of the chart's triangles there.
    pub normal: [f32; 3],
    /// Its place in the light map, in [0, 1]: (0, 0) is the outer corner of the first texel of row 0.
    pub uv: [f32; 2],
    /// Its number in the mesh as it was given; of a triangle or a quad that of the corner; running on other shapes.
    pub source: u32,
}

/// A surface in a light map.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct etd_atlas_surface {
    /// Its number in the scene.
    pub surface: u32,
    /// Its first vertex.
    pub first_vertex: u32,
    /// How many it has.
    pub vertex_count: u32,
    /// Its first triangle.
    pub first_triangle: u32,
    /// How many it has.
    pub triangle_count: u32,
    /// 1 if the mesh's own texture coordinates are the layout, else 0.
    pub has_own_layout: u32,
    /// Then (u, v) of the mesh times the first two, plus the others, is the place in the light map; else 0.
    pub scale_offset: [f32; 4],
}

/// Where baked light goes.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct etd_bake_target {
    /// `sizeof(etd_bake_target)`.
    pub struct_size: usize,
    /// Three floats for each texel or vertex: irradiance [W m^-2], linear Rec. 709.
    pub irradiance: *mut f32,
    /// Three floats for each: its standard error [W m^-2], NaN where there are too few samples to tell; laid out as `irradiance`.
    /// NULL: not wanted.
    pub standard_error: *mut f32,
    /// Bytes that may be written from each of the two pointers on.
    pub size: usize,
    /// Bytes from one texel or vertex to the next; 0: they lie close together (12).
    pub stride: usize,
    /// Bytes from one row of texels to the next; 0: they lie close together.
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
