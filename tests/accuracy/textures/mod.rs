//! Textures: what a lookup returns, and what a scene with textures shows.

mod balls;
mod elements;
mod elements_of_lamps;
pub mod emission;
mod lookups;
mod projections;
mod relief;
pub mod scenes;
mod skies;

use std::sync::Arc;

use etendue::desc::{ImageTextureDesc, TextureDesc, TextureMapping, TextureSource};
use etendue::texture::{ColorSpace, ImageTexture, TexelImage, Texels, Texture, TextureFilter, Wrap};

use crate::record::Entry;

pub fn cases() -> Vec<Entry> {
    let scenes = scenes::cases().into_iter().chain(emission::cases()).chain(projections::cases());
    let lamps = balls::cases().into_iter().chain(elements_of_lamps::cases());
    lookups::cases()
        .into_iter()
        .chain(scenes)
        .chain(elements::cases())
        .chain(lamps)
        .chain(relief::cases())
        .chain(skies::cases())
        .collect()
}

/// A running mean and its standard error.
#[derive(Default)]
struct Mean {
    sum: f64,
    squares: f64,
}

impl Mean {
    fn add(&mut self, value: f64) {
        self.sum += value;
        self.squares += value * value;
    }

    fn of(&self, count: u32) -> (f64, f64) {
        let n = f64::from(count);
        (self.sum / n, ((self.squares / n - (self.sum / n).powi(2)) / n).sqrt())
    }
}

const FILTERS: [TextureFilter; 5] = [
    TextureFilter::Nearest,
    TextureFilter::Bilinear,
    TextureFilter::Mip,
    TextureFilter::Ewa,
    TextureFilter::Stochastic,
];

/// An image of single-precision numbers, rows from the top.
pub fn image(width: u32, height: u32, channels: u32, value: impl Fn(u32, u32, u32) -> f32) -> Arc<TexelImage> {
    let mut values = Vec::new();
    for y in 0..height {
        for x in 0..width {
            values.extend((0..channels).map(|c| value(x, y, c)));
        }
    }
    Arc::new(TexelImage::new(width, height, channels, Texels::F32(values.into())).expect("an image of the test"))
}

/// A texture of numbers from left to right, without interpolation.
pub fn row_texture(values: &[f32]) -> TextureDesc {
    let image = image(values.len() as u32, 1, 1, |x, _, _| values[x as usize]);
    described("row", &image, ColorSpace::Raw, TextureFilter::Nearest, 1.0)
}

fn texture(image: &Arc<TexelImage>, space: ColorSpace, wrap: Wrap, filter: TextureFilter) -> Texture {
    Texture::Image(ImageTexture::new(Arc::clone(image), space, [wrap; 2], filter))
}

/// A texture of a scene.
pub fn described(
    name: &str,
    image: &Arc<TexelImage>,
    space: ColorSpace,
    filter: TextureFilter,
    scale: f64,
) -> TextureDesc {
    TextureDesc {
        name: name.to_owned(),
        path: String::new(),
        source: TextureSource::Image(ImageTextureDesc {
            image: Arc::clone(image),
            file: None,
            color_space: Some(space),
            suggested_space: space,
            wrap: [Wrap::Repeat; 2],
            filter,
        }),
        mapping: TextureMapping::Uv { set: 0, scale: [scale; 2], rotation: 0.0, offset: [0.0; 2] },
        vertex_colors: false,
    }
}
