//! What light leaves behind: sums per pixel, and the image developed from them. Knows no files.
//!
//! A sample belongs to one pixel only: pixel filters are importance sampled instead of splatted, so pixels are independent
//! of each other and a film is the same to the last bit for any number of threads and any order of tiles. Source: Ernst
//! et al. 2006, "Filter Importance Sampling".
//!
//! Sums are f64: 2^25 samples of 1 have the mean 1, not 2^24 / 2^25.

mod image;
mod pixel;

pub use image::{Image, Layer};
pub use pixel::{Auxiliary, Pixel};

use crate::desc::MAX_PIXELS;
use crate::error::{Error, ErrorKind, Result};

/// Side of the square tiles that a film is divided into.
pub const TILE: u32 = 16;

/// How the samples of a film are taken.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct FilmOptions {
    /// Width and height, pixels.
    pub resolution: [u32; 2],
    /// Whether albedo, normal and depth of the first hit are kept.
    pub auxiliary: bool,
    /// Samples per pixel that share one scramble; the error is estimated from the spread of their means.
    pub replicate_size: u32,
    /// Whether the filter's weights vary, so that sums have to be divided by their total.
    pub weighted: bool,
}

/// A film in tiles of [`TILE`] x [`TILE`] pixels, each tile a block of memory of its own.
#[derive(Clone, Debug)]
pub struct Film {
    options: FilmOptions,
    pixels: Vec<Pixel>,
    auxiliary: Vec<Auxiliary>,
}

/// The part of a film that one worker fills.
#[derive(Debug)]
pub struct TileMut<'a> {
    /// Left and top pixel.
    pub origin: [u32; 2],
    /// Pixels, row by row, [`TILE`] to a row, those outside the image included.
    pub pixels: &'a mut [Pixel],
    /// As `pixels`, or empty where no auxiliary layer is wanted.
    pub auxiliary: &'a mut [Auxiliary],
}

impl Film {
    /// An empty film.
    ///
    /// # Errors
    /// [`ErrorKind::OutOfMemory`] where there is no room for it.
    pub fn new(options: FilmOptions) -> Result<Self> {
        let [width, height] = options.resolution.map(|n| n.div_ceil(TILE) as usize);
        let count = width * height * (TILE * TILE) as usize;
        if count as u64 > 2 * MAX_PIXELS {
            let message =
                format!("{} x {} pixels in whole tiles are too many", options.resolution[0], options.resolution[1]);
            return Err(Error::new(ErrorKind::OutOfMemory, message));
        }
        Ok(Self { options, pixels: zeroed(count)?, auxiliary: zeroed(if options.auxiliary { count } else { 0 })? })
    }

    /// Its options.
    pub fn options(&self) -> &FilmOptions {
        &self.options
    }

    /// All tiles, row by row, to be filled in parallel.
    pub fn tiles_mut(&mut self) -> Vec<TileMut<'_>> {
        let per_tile = (TILE * TILE) as usize;
        let across = self.options.resolution[0].div_ceil(TILE);
        let mut auxiliary = self.auxiliary.chunks_mut(per_tile);
        self.pixels
            .chunks_mut(per_tile)
            .zip(0..)
            .map(|(pixels, number)| TileMut {
                origin: [number % across * TILE, number / across * TILE],
                pixels,
                auxiliary: auxiliary.next().unwrap_or_default(),
            })
            .collect()
    }

    /// Where pixel (x, y) lies in memory.
    fn index(&self, x: u32, y: u32) -> usize {
        let across = self.options.resolution[0].div_ceil(TILE);
        let tile = (y / TILE * across + x / TILE) as usize;
        tile * (TILE * TILE) as usize + (y % TILE * TILE + x % TILE) as usize
    }

    /// The pixels of the image with their numbers in memory, row by row.
    fn in_rows(&self) -> impl Iterator<Item = usize> + '_ {
        let [width, height] = self.options.resolution;
        (0..height).flat_map(move |y| (0..width).map(move |x| self.index(x, y)))
    }

    /// The image as it stands: means of what was sampled, black where nothing was.
    ///
    /// Layers: `samples`, `variance` (of the pixel's mean; NaN where too few replicates are complete), and with
    /// auxiliary data `albedo`, `normal` and `depth`.
    pub fn develop(&self) -> Image {
        let [width, height] = self.options.resolution;
        let mut image = Image { width, height, ..Image::default() };
        image.rgb = self.in_rows().flat_map(|i| self.pixels[i].mean(self.options.weighted)).collect();
        let mut layer = |name: &str, channels, data| {
            image.layers.push(Layer { name: name.to_owned(), channels, data });
        };
        if self.options.auxiliary {
            let mean = |value: fn(&Auxiliary) -> [f64; 3]| -> Vec<f32> {
                let of = |i: usize| value(&self.auxiliary[i]).map(|sum| sum / f64::from(self.pixels[i].count().max(1)));
                self.in_rows().flat_map(of).map(|mean| mean as f32).collect()
            };
            layer("albedo", 3, mean(|a| a.albedo));
            layer("normal", 3, mean(|a| a.normal));
            let depth = self.in_rows().map(|i| self.auxiliary[i].mean_depth()).collect();
            layer("depth", 1, depth);
        }
        layer("samples", 1, self.in_rows().map(|i| self.pixels[i].count() as f32).collect());
        let variance = self.in_rows().flat_map(|i| self.pixels[i].variance().map(|v| v as f32)).collect();
        layer("variance", 3, variance);
        image
    }

    /// Estimated relative error of the image: the root of the mean over pixels and channels of variance / (mean^2 + e),
    /// with e = 1 % of the squared mean of the whole image so that black pixels do not rule it.
    ///
    /// `None` until every pixel has two complete replicates.
    pub fn relative_error(&self) -> Option<f64> {
        let means: Vec<[f32; 3]> = self.in_rows().map(|i| self.pixels[i].mean(self.options.weighted)).collect();
        let values = (3 * means.len()).max(1) as f64;
        let mean = means.iter().flatten().map(|&value| f64::from(value)).sum::<f64>() / values;
        let floor = 1e-2 * mean * mean;
        let mut sum = 0.0;
        for (i, mean) in self.in_rows().zip(&means) {
            for (variance, &mean) in self.pixels[i].variance().into_iter().zip(mean) {
                sum += variance / (f64::from(mean) * f64::from(mean) + floor);
            }
        }
        // NaN, from a pixel without an estimate or an image without light, is no estimate.
        (sum / values).is_finite().then(|| (sum / values).sqrt())
    }

    /// Samples that were NaN or infinite, and were left out.
    pub fn non_finite(&self) -> u64 {
        self.pixels.iter().map(|pixel| u64::from(pixel.non_finite())).sum()
    }
}

/// So many default values, or an error instead of an abort.
fn zeroed<T: Clone + Default>(count: usize) -> Result<Vec<T>> {
    let mut values = Vec::new();
    values.try_reserve_exact(count).map_err(|error| {
        Error::new(ErrorKind::OutOfMemory, format!("no room for a film of {count} pixels")).because(error)
    })?;
    values.resize(count, T::default());
    Ok(values)
}
