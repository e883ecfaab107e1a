//! How much light the parts of an emitting texture give: what lamps are chosen by.

use std::sync::Arc;

use super::image::ImageTexture;
use super::{Texel, Texture, TexturePoint};

/// Most columns and rows of the means that are kept.
const MOST_ACROSS: u32 = 2048;

/// Most texels along a side of a box that is searched for light.
const MOST_SEARCHED: f32 = 16.0;

/// A texture with the means of its light over squares of texels. Only the building of emitters needs it.
#[derive(Clone, Debug)]
pub struct TextureLight {
    texture: Arc<Texture>,
    /// The image, and the means as its levels; `None` for patterns.
    image: Option<ImageTexture>,
    /// The first level of means that is kept.
    first: usize,
}

impl TextureLight {
    /// Takes the means, by at most so many threads.
    pub fn new(texture: Arc<Texture>, threads: usize) -> Self {
        let (image, first) = match &*texture {
            Texture::Image(image) => {
                let (image, levels) = image.with_light(threads, MOST_ACROSS);
                let is_kept = |level: &usize| image.size(*level).iter().all(|n| *n <= MOST_ACROSS);
                let first = (1..=levels).find(is_kept).unwrap_or(0);
                (Some(image), first)
            }
            Texture::Procedural(..) | Texture::White => (None, 0),
        };
        Self { texture, image, first }
    }

    /// The texture.
    pub fn texture(&self) -> &Arc<Texture> {
        &self.texture
    }

    /// Memory of the means, bytes.
    pub fn bytes(&self) -> usize {
        self.image.as_ref().map_or(0, ImageTexture::pyramid_bytes)
    }

    /// Whether there are means of an image; a pattern is known at points alone.
    pub fn has_means(&self) -> bool {
        self.image.is_some()
    }

    /// The level at which texels are `width` or more texels of the image wide; 0 is the image.
    pub fn level_of(&self, width: f32) -> usize {
        let Some(image) = &self.image else { return 0 };
        let level = width.max(1.0).log2().ceil() as usize;
        if level == 0 { 0 } else { level.max(self.first).min(image.last_level()) }
    }

    /// The light near a point: the mean over the square of that level that it lies in.
    pub fn near(&self, at: &TexturePoint, level: usize) -> Texel {
        match &self.image {
            Some(image) if level > 0 && at.uv.iter().all(|x| x.is_finite()) => image.nearest(level, at.uv),
            _ => self.texture.at(at),
        }
    }

    /// The largest value of each channel within a box of texture coordinates: of texels where it is small, else of means over squares
    /// of texels. A channel is 0 (or less) only where all of the box is. Of patterns, the largest at all.
    pub fn most_within(&self, low: [f32; 2], high: [f32; 2]) -> Texel {
        let whole = self.texture.range()[1];
        let Some(image) = &self.image else { return whole };
        let size = image.size(0).map(|n| n as f32);
        let width = ((high[0] - low[0]) * size[0]).max((high[1] - low[1]) * size[1]);
        let is_within = low.iter().chain(&high).all(|x| x.abs() < 1e6);
        // Some of the texels of either level lie around the box.
        let level = self.level_of(width / MOST_SEARCHED);
        let is_part = (0..2).all(|i| high[i] - low[i] < 1.0);
        if !is_within || !is_part || level == image.last_level() && level > 0 {
            return whole;
        }
        let ranges = image.places_within(level, low, high);
        let mut most = [f32::NEG_INFINITY; 4];
        for y in ranges[1].clone() {
            for x in ranges[0].clone() {
                let texel = image.texel(level, [x, y]);
                most = std::array::from_fn(|c| most[c].max(texel[c]));
            }
        }
        most
    }
}
