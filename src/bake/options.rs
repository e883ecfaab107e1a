//! Options of a light map's layout.

/// Most texels along a side of a light map.
pub const MAX_SIDE: u32 = 1 << 13;

/// Texels along a side where neither resolution nor density is given.
pub const DEFAULT_SIDE: u32 = 512;

/// Largest gutter: texels around a chart that belong to the chart alone.
pub const MAX_GUTTER: u32 = 64;

/// The source of a mesh's layout.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Layout {
    /// The mesh's own texture coordinates where they are suitable, else charts. Where a mesh has unsuitable
    /// coordinates, a warning says so.
    #[default]
    Auto,
    /// Charts, whether or not a mesh has texture coordinates.
    Charts,
    /// The mesh's own texture coordinates; an error where they are unsuitable. Surfaces that are not meshes have
    /// charts.
    Own,
}

/// Options of a light map's layout.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AtlasOptions {
    /// Texels along the sides of the square, up to [`MAX_SIDE`]. `None`: as many as `texels_per_unit` needs, or
    /// [`DEFAULT_SIDE`] where that is not given either.
    pub resolution: Option<u32>,
    /// Texels for a unit of length, > 0. `None`: as many as fit.
    pub texels_per_unit: Option<f64>,
    /// Texels around each chart that belong to the chart alone, up to [`MAX_GUTTER`]. Bilinear lookups need one;
    /// smaller levels of a map need more.
    pub gutter: u32,
    /// The source of layouts.
    pub layout: Layout,
    /// Greatest angle between the normals of a chart's triangles and that of its first triangle, degrees, above 0 and
    /// below 90.
    pub max_angle_deg: f64,
    /// Most memory that atlas and bake may take together, MiB.
    pub memory: u32,
}

impl Default for AtlasOptions {
    fn default() -> Self {
        Self {
            resolution: None,
            texels_per_unit: None,
            gutter: 2,
            layout: Layout::Auto,
            max_angle_deg: 45.0,
            memory: 4096,
        }
    }
}
