//! Textures: values that vary over surfaces, from images or from formulas.
//!
//! A [`Texture`] gives four numbers (red, green, blue, opacity) at a point of a surface. Images stay in memory as they were stored
//! ([`TexelImage`]); colours are decoded to linear light where a texel is read. What a texture reads (texture coordinates, the point,
//! the size of a pixel on the surface) is in a [`TexturePoint`].
//!
//! The default filter interpolates between the four nearest texels, so that the mean over a pixel's samples is the mean of the texture
//! over the pixel, without bias. The other filters average over the footprint of a pixel first: fewer texels are read and there is less
//! noise, at the price of a blur that `docs/design/textures.md` measures.

mod image;
mod light;
mod lookup;
mod noise;
mod procedural;
mod pyramid;
mod read;
mod slopes;
mod texels;
mod write;

pub use image::ImageTexture;
pub use light::TextureLight;
pub use lookup::{TextureFilter, Wrap};
pub use procedural::{Pattern, Procedural};
pub(crate) use read::{ImageSource, ReadImage, ReadingTogether, read_images};
pub use read::{read_image, read_image_bytes};
pub(crate) use slopes::{SlopesOf, variances};
pub use texels::{ColorSpace, TexelFormat, TexelImage, Texels};
pub(crate) use write::{extension, put_texels, write_image};

use crate::math::Vec3;

/// Four numbers of a texture: red, green, blue in linear light, and opacity.
pub type Texel = [f32; 4];

/// A point of a surface, as a texture sees it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct TexturePoint {
    /// Texture coordinates; u to the right and v up in the image.
    pub uv: [f32; 2],
    /// The two axes of the ellipse that a pixel covers, in texture coordinates: the changes of `uv` from one pixel to the next along
    /// either. 0 where it is not known.
    pub axes: [[f32; 2]; 2],
    /// The point in space, for patterns in space.
    pub p: Vec3,
    /// Diameter of what a pixel covers, in the units of `p`.
    pub width: f32,
}

/// A texture that is ready to be read.
#[derive(Clone, Debug)]
pub enum Texture {
    /// An image.
    Image(ImageTexture),
    /// A formula, and its mean.
    Procedural(Procedural, Texel),
    /// White and opaque.
    White,
}

/// White, and opaque.
pub(crate) const WHITE: Texel = [1.0; 4];

impl Texture {
    /// A texture by a formula.
    pub fn procedural(pattern: Procedural) -> Self {
        Self::Procedural(pattern, pattern.mean())
    }

    /// The value at a point.
    pub fn at(&self, at: &TexturePoint) -> Texel {
        match self {
            Self::Image(image) => image.at(at),
            Self::Procedural(pattern, _) => pattern.at(at),
            Self::White => WHITE,
        }
    }

    /// Calls `each` with the texels between which [`Self::at`] interpolates, and their weights, which sum to 1; once with the value itself
    /// where nothing is interpolated.
    pub fn each_texel(&self, at: &TexturePoint, each: &mut dyn FnMut(f32, Texel)) {
        match self {
            Self::Image(image) => image.each_texel(at, each),
            Self::Procedural(..) | Self::White => each(1.0, self.at(at)),
        }
    }

    /// The mean over the texture, where each part of it counts alike.
    pub fn mean(&self) -> Texel {
        match self {
            Self::Image(image) => image.mean(),
            Self::Procedural(_, mean) => *mean,
            Self::White => WHITE,
        }
    }

    /// The smallest and the largest value of each channel.
    pub fn range(&self) -> [Texel; 2] {
        match self {
            Self::Image(image) => image.range(),
            Self::Procedural(pattern, _) => pattern.range(),
            Self::White => [WHITE; 2],
        }
    }

    /// The numbers of columns and rows; of a pattern, numbers that resolve its squares.
    pub fn texels(&self) -> [u32; 2] {
        match self {
            Self::Image(image) => image.size(0),
            Self::Procedural(..) => [32; 2],
            Self::White => [1; 2],
        }
    }

    /// The larger of the numbers of columns and rows, as [`Texture::texels`] gives them.
    pub fn texels_across(&self) -> u32 {
        let [columns, rows] = self.texels();
        columns.max(rows)
    }

    /// Whether the texture reads [`TexturePoint::axes`] or [`TexturePoint::width`].
    pub fn asks_footprint(&self) -> bool {
        match self {
            Self::Image(image) => image.filter().asks_footprint(),
            Self::Procedural(..) | Self::White => false,
        }
    }

    /// Bytes of memory that this texture holds beyond its image.
    pub fn bytes(&self) -> usize {
        match self {
            Self::Image(image) => image.pyramid_bytes(),
            Self::Procedural(..) | Self::White => 0,
        }
    }
}
