//! Smaller and smaller images of an image, each half the size of the one before: its mean is the same at every level.

use super::texels::{ColorSpace, TexelFormat, TexelImage};
use super::{Texel, Wrap};
use crate::rows::rows;

/// The levels above an image, in linear light. Those of integer images have 16 bits a channel, the others single precision.
#[derive(Clone, Debug)]
pub(super) struct Pyramid {
    levels: Vec<Level>,
}

#[derive(Clone, Debug)]
struct Level {
    width: u32,
    height: u32,
    channels: usize,
    values: Values,
}

#[derive(Clone, Debug)]
enum Values {
    U16(Box<[u16]>),
    F32(Box<[f32]>),
}

impl Pyramid {
    /// Bytes of the pyramid over an image.
    pub fn bytes_over(image: &TexelImage) -> usize {
        let each = if matches!(image.texels().format(), TexelFormat::U8 | TexelFormat::U16) { 2 } else { 4 };
        Self::texels_over(image) * image.channels() as usize * each
    }

    /// Bytes of the pyramid over values of four channels at the texels of an image.
    pub fn bytes_over_values(image: &TexelImage) -> usize {
        Self::texels_over(image) * size_of::<Texel>()
    }

    fn texels_over(image: &TexelImage) -> usize {
        let (mut size, mut texels) = ([image.width() as usize, image.height() as usize], 0);
        while size != [1, 1] {
            size = size.map(|n| n.div_ceil(2));
            texels += size[0] * size[1];
        }
        texels
    }

    /// The pyramid over an image, made by so many threads.
    pub fn new(image: &TexelImage, space: ColorSpace, threads: usize) -> Self {
        let is_integer = matches!(image.texels().format(), TexelFormat::U8 | TexelFormat::U16);
        let channels = image.channels() as usize;
        Self::over(image, channels, threads, |x, y| image.texel(x, y, space), |_| true, is_integer)
    }

    /// The pyramid over values of four channels at the texels of an image.
    pub fn of_values(image: &TexelImage, threads: usize, value: impl Fn(u32, u32) -> Texel + Sync) -> Self {
        Self::over(image, 4, threads, value, |_| true, false)
    }

    /// The pyramid over the light of an image: negative values count as 0, means are 0 only where all of their texels are, and levels
    /// of more than `most` columns or rows are left empty.
    pub fn of_light(image: &TexelImage, space: ColorSpace, threads: usize, most: u32) -> Self {
        let light = |x, y| image.texel(x, y, space).map(|value| value.max(0.0));
        let channels = image.channels() as usize;
        Self::over(image, channels, threads, light, |size| size[0].max(size[1]) <= most, false)
    }

    fn over(
        image: &TexelImage,
        channels: usize,
        threads: usize,
        texel: impl Fn(u32, u32) -> Texel + Sync,
        is_kept: impl Fn([u32; 2]) -> bool,
        as_integers: bool,
    ) -> Self {
        // The means are taken from unrounded ones: rounding errors do not add up over the levels.
        let mut size = [image.width(), image.height()];
        let stored = |texel: Texel, channel: usize| match (channels, channel) {
            (2, 1) => texel[3],
            _ => texel[channel],
        };
        let mut below: Vec<f32> = Vec::new();
        let mut levels = Vec::new();
        while size != [1, 1] {
            let [width, height] = size.map(|n| n.div_ceil(2));
            let [whole_width, _] = size;
            let shares = size.map(halves);
            let row = |y: u32| {
                let mut row = Vec::with_capacity(width as usize * channels);
                for x in 0..width {
                    for channel in 0..channels {
                        let mut sum = 0.0_f64;
                        for (sy, wy) in shares[1](y) {
                            for (sx, wx) in shares[0](x) {
                                let value = if levels.is_empty() {
                                    stored(texel(sx, sy), channel)
                                } else {
                                    below[(sy as usize * whole_width as usize + sx as usize) * channels + channel]
                                };
                                sum += f64::from(wx * wy * value);
                            }
                        }
                        row.push(sum as f32);
                    }
                }
                row
            };
            let values: Vec<f32> = rows(height, threads, row).into_iter().flatten().collect();
            levels.push(Level {
                width,
                height,
                channels,
                values: if !is_kept([width, height]) {
                    Values::F32(Box::default())
                } else if as_integers {
                    Values::U16(values.iter().map(|v| (v * 65535.0).round() as u16).collect())
                } else {
                    Values::F32(values.clone().into())
                },
            });
            (below, size) = (values, [width, height]);
        }
        Self { levels }
    }

    /// Number of levels above the image.
    pub fn len(&self) -> usize {
        self.levels.len()
    }

    /// Columns and rows of level `level`, counted from 1.
    pub fn size(&self, level: usize) -> [u32; 2] {
        let level = &self.levels[level - 1];
        [level.width, level.height]
    }

    /// A texel of a level that is counted from 1.
    #[inline]
    pub fn texel(&self, level: usize, x: u32, y: u32) -> Texel {
        let level = &self.levels[level - 1];
        let first = (y as usize * level.width as usize + x as usize) * level.channels;
        let at = |channel: usize| match &level.values {
            Values::U16(values) => f32::from(values[first + channel]) / 65535.0,
            Values::F32(values) => values[first + channel],
        };
        match level.channels {
            1 => [at(0), at(0), at(0), 1.0],
            2 => [at(0), at(0), at(0), at(1)],
            3 => [at(0), at(1), at(2), 1.0],
            _ => [at(0), at(1), at(2), at(3)],
        }
    }

    /// Bytes of memory.
    pub fn bytes(&self) -> usize {
        let bytes = |level: &Level| match &level.values {
            Values::U16(values) => 2 * values.len(),
            Values::F32(values) => 4 * values.len(),
        };
        self.levels.iter().map(bytes).sum()
    }
}

/// The texels of `n` of which the texels of half as many, rounded up, are the means, with their weights. Where `n` is odd, a texel
/// may count in part for each of two, so that every texel counts the same in the whole (Guthe and Heckbert 2005).
fn halves(n: u32) -> impl Fn(u32) -> Vec<(u32, f32)> {
    let half = n.div_ceil(2);
    move |i: u32| {
        // A texel of the level covers n / half texels below, from i n / half on.
        let (from, to) = (u64::from(i) * u64::from(n), u64::from(i + 1) * u64::from(n));
        let half = u64::from(half);
        let first = from / half;
        let last = (to - 1) / half;
        (first..=last)
            .map(|j| {
                let covered = to.min((j + 1) * half) - from.max(j * half);
                (j as u32, (covered as f64 / f64::from(n)) as f32)
            })
            .collect()
    }
}

/// The place of a texel of a level, for lookups with a wrap.
#[inline]
pub(super) fn wrapped(wrap: [Wrap; 2], size: [u32; 2], [x, y]: [i64; 2]) -> Option<[u32; 2]> {
    Some([wrap[0].place(x, size[0])?, wrap[1].place(y, size[1])?])
}
