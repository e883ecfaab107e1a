//! Types that describe textures.

use std::ffi::{c_char, c_void};

use super::device::etd_release_fn;
use super::numbers::{
    EtdColorSpace, EtdCoordinates, EtdSharing, EtdSkyProjection, EtdTexelFormat, EtdTextureChannel, EtdTextureFilter,
    EtdTextureKind, EtdWrap,
};
pub use {
    etd_color_space::*, etd_coordinates::*, etd_sky_projection::*, etd_texel_format::*, etd_texture_channel::*,
    etd_texture_filter::*, etd_texture_kind::*, etd_wrap::*,
};

/// What a texture shows.
#[repr(u32)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum etd_texture_kind {
    /// An image, from a file or from memory.
    ETD_TEXTURE_IMAGE = 0,
    /// Squares (cubes in space) of side 1, in turns.
    ETD_TEXTURE_CHECKER = 1,
    /// Lines of the second colour along the edges of squares of side 1.
    ETD_TEXTURE_GRID = 2,
    /// From the first colour at 0 to the second at 1 along the first coordinate.
    ETD_TEXTURE_GRADIENT = 3,
    /// Perlin's noise, summed over octaves.
    ETD_TEXTURE_NOISE = 4,
    /// Its magnitude, summed over octaves.
    ETD_TEXTURE_TURBULENCE = 5,
    /// Veins across the first coordinate.
    ETD_TEXTURE_MARBLE = 6,
    /// Rings around the second axis of space.
    ETD_TEXTURE_WOOD = 7,
    /// White and opaque, times the colours of the vertices of meshes (`etd_mesh.colors`).
    ETD_TEXTURE_VERTEX_COLORS = 8,
}

/// The number format of texels.
#[repr(u32)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum etd_texel_format {
    /// `uint8_t`; 255 is 1.
    ETD_TEXEL_UINT8 = 0,
    /// `uint16_t`; 65535 is 1.
    ETD_TEXEL_UINT16 = 1,
    /// Half precision (IEEE 754 binary16), 2 bytes.
    ETD_TEXEL_HALF = 2,
    /// `float`.
    ETD_TEXEL_FLOAT = 3,
}

/// What the numbers of an image mean.
#[repr(u32)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum etd_color_space {
    /// For colours, sRGB where texels are integers and linear light where they are floating-point numbers; for all else,
    /// numbers as they are.
    ETD_COLOR_SPACE_BY_USE = 0,
    /// Colours with the curve of sRGB. Opacity is linear.
    ETD_COLOR_SPACE_SRGB = 1,
    /// Colours in linear light.
    ETD_COLOR_SPACE_LINEAR = 2,
    /// No colours, but numbers as they are.
    ETD_COLOR_SPACE_RAW = 3,
}

/// What lies beyond the edges of an image.
#[repr(u32)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum etd_wrap {
    /// The image again.
    ETD_WRAP_REPEAT = 0,
    /// The image in a mirror.
    ETD_WRAP_MIRROR = 1,
    /// The texels of the edge.
    ETD_WRAP_CLAMP = 2,
    /// Black, without opacity.
    ETD_WRAP_BLACK = 3,
}

/// How an image is filtered.
#[repr(u32)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum etd_texture_filter {
    /// Linear between the four nearest texels: no bias.
    ETD_TEXTURE_FILTER_BILINEAR = 0,
    /// The nearest texel.
    ETD_TEXTURE_FILTER_NEAREST = 1,
    /// Smaller images for smaller pixels; blurs.
    ETD_TEXTURE_FILTER_MIP = 2,
    /// A Gaussian over the ellipse that a pixel covers.
    ETD_TEXTURE_FILTER_EWA = 3,
    /// One texel drawn from that Gaussian.
    ETD_TEXTURE_FILTER_STOCHASTIC = 4,
}

/// Where a texture lies.
#[repr(u32)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum etd_coordinates {
    /// On the surface, by its texture coordinates.
    ETD_COORDINATES_UV = 0,
    /// In world space; patterns only.
    ETD_COORDINATES_SPACE = 1,
    /// On the surface, by the world's coordinates from the side of a box that the face looks to, in scene units.
    ETD_COORDINATES_BOX = 2,
    /// On the surface, by the world's coordinates along the x axis: u is -z, v is y.
    ETD_COORDINATES_PLANAR_X = 3,
    /// On the surface, by the world's coordinates from above: u is x, v is -z.
    ETD_COORDINATES_PLANAR_Y = 4,
    /// On the surface, by the world's coordinates along the z axis: u is x, v is y.
    ETD_COORDINATES_PLANAR_Z = 5,
}

/// Which number of a texture a parameter takes.
#[repr(u32)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum etd_texture_channel {
    /// Colours take red, green and blue; an opacity takes the texture's opacity if it has one; other numbers take red.
    ETD_CHANNEL_DEFAULT = 0,
    /// Red.
    ETD_CHANNEL_RED = 1,
    /// Green.
    ETD_CHANNEL_GREEN = 2,
    /// Blue.
    ETD_CHANNEL_BLUE = 3,
    /// Opacity.
    ETD_CHANNEL_ALPHA = 4,
}

/// A texture: an image or a pattern of two colours, and where it lies.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct etd_texture {
    /// `sizeof(etd_texture)`.
    pub struct_size: usize,
    /// An `etd_texture_kind`.
    pub kind: EtdTextureKind,
    /// Of an image: an `etd_color_space`.
    pub color_space: EtdColorSpace,
    /// Of an image: PNG, JPEG, TGA, BMP, WebP, TIFF, Radiance HDR or OpenEXR file, UTF-8, relative to the current folder; NULL:
    /// the image is at `texels`.
    pub file: *const c_char,
    /// Of an image without a file: the numbers, row after row from the top, channels beside each other. The lower left corner
    /// of the image is at the texture coordinates (0, 0), the upper right one at (1, 1).
    pub texels: *const c_void,
    /// Bytes from one row to the next; 0: rows without gaps.
    pub row_stride: usize,
    /// Number of columns, at least 1; the image has at most 2^28 texels.
    pub width: u32,
    /// Number of rows, at least 1.
    pub height: u32,
    /// 1: grey; 2: grey and opacity; 3: red, green and blue; 4: these and opacity.
    pub channels: u32,
    /// An `etd_texel_format`.
    pub texel_format: EtdTexelFormat,
    /// An `etd_sharing`. Shared texels are read in place. They must not be freed until `release` is called, and may be written
    /// to only while no build and no render of the scene runs, with `etd_scene_update_texture` afterwards.
    pub sharing: EtdSharing,
    /// Of an image: an `etd_texture_filter`.
    pub filter: EtdTextureFilter,
    /// With `ETD_SHARE`: called once the texels are no longer read; may be NULL. It is not called if the call fails.
    pub release: etd_release_fn,
    /// Passed to `release`.
    pub user_data: *mut c_void,
    /// Of an image: an `etd_wrap`, to the sides.
    pub wrap_u: EtdWrap,
    /// Of an image: an `etd_wrap`, up and down.
    pub wrap_v: EtdWrap,
    /// Of a pattern: the two colours, [0, 1] per channel.
    pub colors: [[f32; 3]; 2],
    /// `ETD_TEXTURE_GRID`: width of the lines, in [0, 1] of a square.
    pub line_width: f32,
    /// `ETD_TEXTURE_MARBLE`, `ETD_TEXTURE_WOOD`: how far veins are turned, in periods, or rings, in rings.
    pub turbulence: f32,
    /// Of noise, turbulence, marble and wood: number of octaves, 1 to 16; 0: 4.
    pub octaves: u32,
    /// An `etd_coordinates`.
    pub coordinates: EtdCoordinates,
    /// Factors on the coordinates, applied first; the third is used in space only. Three zeros: 1.
    pub scale: [f64; 3],
    /// Angle by which texture coordinates are then turned about (0, 0), degrees, counter-clockwise; 0 in space.
    pub rotation_deg: f64,
    /// Added to the coordinates at last; the third is used in space only.
    pub offset: [f64; 3],
    /// 1: the texture is multiplied by the colours of vertices, and its opacity by theirs. 0: it is not. Always 1 of
    /// `ETD_TEXTURE_VERTEX_COLORS`, whatever is given. Refused for the parameters "emission", "temperature", "normal" and "bump".
    pub vertex_colors: u32,
    /// Of `ETD_COORDINATES_UV`: the set of texture coordinates, 0 to 7. Surfaces that lack it have the first, which is 0.
    pub uv_set: u32,
}

/// A texture of a parameter of a material. The parameter is that of the material times the texture.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct etd_texture_binding {
    /// `sizeof(etd_texture_binding)`.
    pub struct_size: usize,
    /// Number of the texture; `ETD_NONE`: none.
    pub texture: u32,
    /// An `etd_texture_channel`.
    pub channel: EtdTextureChannel,
    /// For the parameter "normal": factor on the slopes. For "bump": height of a 1 in the texture [scene unit]. Not used by
    /// others.
    pub strength: f32,
    /// For the parameter "opacity", in [0, 1]: above 0, the opacity is 1 where the texture has this value or more, and 0
    /// elsewhere (a mask). 0: the opacity is the texture's. 0 for others.
    pub cutoff: f32,
}

/// How the directions of a sky lie in an image, whose own frame has y up.
#[repr(u32)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum etd_sky_projection {
    /// By longitude and latitude: seen from within, the middle of the image is towards -z, its right half towards +x and its upper
    /// edge around +y.
    ETD_SKY_LATLONG = 0,
    /// The faces of an octahedron in a square image: +y in the middle, -y at the four corners, +x in the middle of the right edge
    /// and -z in that of the upper edge.
    ETD_SKY_OCTAHEDRAL = 1,
    /// Six squares one under another: the faces +x, -x, +y, -y, +z and -z of a cube, each as OpenGL, Vulkan and Direct3D have it.
    ETD_SKY_CUBE = 2,
}

/// Light from infinity by a texture, or the same from all directions.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct etd_environment_map {
    /// `sizeof(etd_environment_map)`.
    pub struct_size: usize,
    /// Number of the texture; `ETD_NONE`: none.
    pub texture: u32,
    /// An `etd_sky_projection`.
    pub projection: EtdSkyProjection,
    /// Radiance [W m^-2 sr^-1], each channel >= 0; a factor on the texture's where there is one.
    pub radiance: [f32; 3],
    /// 1: camera rays do not see it, only mirrors, glass and other light do; 0: they do.
    pub hidden: u32,
    /// The direction that is up in the image, of any length but 0. With +z up, what is towards -z with +y up is towards +y.
    pub up: [f64; 3],
    /// Degrees by which the image is turned about `up`, counter-clockwise as seen from above.
    pub rotation_deg: f64,
}

/// A picture that the camera sees behind everything, in place of what comes from infinity. It lights nothing.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct etd_backplate {
    /// `sizeof(etd_backplate)`.
    pub struct_size: usize,
    /// Number of the texture that is spread over the whole picture; `ETD_NONE`: none.
    pub texture: u32,
    /// Radiance [W m^-2 sr^-1], each channel >= 0; a factor on the texture's where there is one.
    pub radiance: [f32; 3],
}

enumerations! {
    etd_texture_kind:
        ETD_TEXTURE_IMAGE, ETD_TEXTURE_CHECKER, ETD_TEXTURE_GRID, ETD_TEXTURE_GRADIENT, ETD_TEXTURE_NOISE,
        ETD_TEXTURE_TURBULENCE, ETD_TEXTURE_MARBLE, ETD_TEXTURE_WOOD, ETD_TEXTURE_VERTEX_COLORS;
    etd_texel_format: ETD_TEXEL_UINT8, ETD_TEXEL_UINT16, ETD_TEXEL_HALF, ETD_TEXEL_FLOAT;
    etd_color_space:
        ETD_COLOR_SPACE_BY_USE, ETD_COLOR_SPACE_SRGB, ETD_COLOR_SPACE_LINEAR, ETD_COLOR_SPACE_RAW;
    etd_wrap: ETD_WRAP_REPEAT, ETD_WRAP_MIRROR, ETD_WRAP_CLAMP, ETD_WRAP_BLACK;
    etd_texture_filter:
        ETD_TEXTURE_FILTER_BILINEAR, ETD_TEXTURE_FILTER_NEAREST, ETD_TEXTURE_FILTER_MIP, ETD_TEXTURE_FILTER_EWA,
        ETD_TEXTURE_FILTER_STOCHASTIC;
    etd_coordinates:
        ETD_COORDINATES_UV, ETD_COORDINATES_SPACE, ETD_COORDINATES_BOX, ETD_COORDINATES_PLANAR_X,
        ETD_COORDINATES_PLANAR_Y, ETD_COORDINATES_PLANAR_Z;
    etd_texture_channel:
        ETD_CHANNEL_DEFAULT, ETD_CHANNEL_RED, ETD_CHANNEL_GREEN, ETD_CHANNEL_BLUE, ETD_CHANNEL_ALPHA;
    etd_sky_projection: ETD_SKY_LATLONG, ETD_SKY_OCTAHEDRAL, ETD_SKY_CUBE;
}

versioned! {
    etd_texture, offset;
    etd_texture_binding, cutoff;
    etd_environment_map, rotation_deg;
    etd_backplate, radiance;
}
