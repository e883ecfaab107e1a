//! What light leaves behind: sums per pixel, and the image developed from them. Knows no files.
//!
//! A sample belongs to one pixel only: pixel filters are importance sampled instead of splatted, so pixels are independent
//! of each other and a film is the same to the last bit for any number of threads and any order of tiles. Source: Ernst
//! et al. 2006, "Filter Importance Sampling".
//!
//! Sums are f64: 2^25 samples of 1 have the mean 1, not 2^24 / 2^25.

mod error;
mod gathering;
mod image;
mod pixel;

pub(crate) use error::FEW_PIXELS;
pub use error::{ErrorEstimate, ErrorMeasure, SampleCounts};
pub use gathering::{Gathering, ShrinkingRadius};
pub use image::{Image, Layer};
pub use pixel::{Auxiliary, Pixel, REPLICATES};

use std::sync::{Mutex, MutexGuard, PoisonError};

use crate::Cancel;
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
    /// How many consecutive samples of a pixel have one error, as they read the same photon maps; else 1. They belong to one
    /// of the [`REPLICATES`], from the spread of whose means the error is estimated.
    pub share: u32,
    /// Whether the filter's weights vary, so that sums have to be divided by their total.
    pub weighted: bool,
    /// Whether pixels remember photons.
    pub gathering: bool,
}

/// A film in tiles of [`TILE`] x [`TILE`] pixels, shared by those who fill it and those who look at it.
///
/// Each tile has a lock, so that any thread may develop the film while others fill it: it sees every pixel as it was
/// between two additions of samples. A tile takes memory when it is filled for the first time.
#[derive(Debug)]
pub struct Film {
    options: FilmOptions,
    tiles: Box<[Mutex<Tile>]>,
}

/// The pixels of a tile, row by row, [`TILE`] to a row, those outside the image included; empty until the tile is filled.
#[derive(Debug, Default)]
pub(crate) struct Tile {
    pub pixels: Vec<Pixel>,
    /// As `pixels`, or empty where no auxiliary layer is wanted.
    pub auxiliary: Vec<Auxiliary>,
    /// As `pixels`, or empty where no photons are to be remembered.
    pub gathering: Vec<Gathering>,
}

impl Tile {
    /// Samples of each pixel, once the tile takes memory.
    pub(crate) fn counts(&self) -> [u32; PER_TILE] {
        std::array::from_fn(|index| self.pixels[index].count())
    }
}

/// What is kept of a pixel beside its sums.
#[derive(Clone, Copy)]
struct Beside<'a> {
    auxiliary: Option<&'a Auxiliary>,
    gathering: Option<&'a Gathering>,
}

/// Pixels of a tile.
const PER_TILE: usize = (TILE * TILE) as usize;

/// A layer that a film can develop beside its colour.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum LayerKind {
    /// Mean albedo of the first hits.
    Albedo,
    /// Mean shading normal of the first hits, facing the camera.
    Normal,
    /// Mean depth of the first hits along the view direction; infinite where nothing was hit.
    Depth,
    /// Number of samples.
    Samples,
    /// Variance of the pixel's mean; NaN where there are fewer than four replicates.
    Variance,
    /// Root of the variance.
    StandardError,
    /// Estimated bias of the pixel's mean by photon maps: what is there is too large by so much. Of maps that are made once
    /// only that of caustics; 0 without maps.
    Bias,
}

impl LayerKind {
    /// Values per pixel.
    pub fn channels(self) -> usize {
        match self {
            Self::Depth | Self::Samples => 1,
            Self::Albedo | Self::Normal | Self::Variance | Self::StandardError | Self::Bias => 3,
        }
    }

    /// Whether it comes from the first hits, which a film keeps only if it is asked to.
    fn is_auxiliary(self) -> bool {
        matches!(self, Self::Albedo | Self::Normal | Self::Depth)
    }
}

impl Film {
    /// An empty film.
    ///
    /// # Errors
    /// [`ErrorKind::OutOfMemory`] where there is no room for it.
    pub fn new(options: FilmOptions) -> Result<Self> {
        let [width, height] = options.resolution.map(|n| n.div_ceil(TILE) as usize);
        let count = width * height;
        if (count * PER_TILE) as u64 > 2 * MAX_PIXELS {
            let message =
                format!("{} x {} pixels in whole tiles are too many", options.resolution[0], options.resolution[1]);
            return Err(Error::new(ErrorKind::OutOfMemory, message));
        }
        let mut tiles = Vec::new();
        tiles.try_reserve_exact(count).map_err(|error| no_room().because(error))?;
        tiles.resize_with(count, Mutex::default);
        // What the tiles will take is asked for once and given back, so that a film that cannot fit is refused now.
        let bytes = size_of::<Pixel>() + if options.auxiliary { size_of::<Auxiliary>() } else { 0 };
        let bytes = bytes + if options.gathering { size_of::<Gathering>() } else { 0 };
        Vec::<u8>::new().try_reserve_exact(count * PER_TILE * bytes).map_err(|error| no_room().because(error))?;
        Ok(Self { options, tiles: tiles.into() })
    }

    /// Its options.
    pub fn options(&self) -> &FilmOptions {
        &self.options
    }

    /// Number of tiles, counted row by row.
    pub(crate) fn tile_count(&self) -> usize {
        self.tiles.len()
    }

    /// Left and top pixel of a tile.
    pub(crate) fn tile_origin(&self, tile: usize) -> [u32; 2] {
        let across = self.options.resolution[0].div_ceil(TILE);
        let tile = tile as u32;
        [tile % across * TILE, tile / across * TILE]
    }

    /// A tile to be filled, with room for its pixels. To be held briefly: others may be waiting to look at it.
    pub(crate) fn tile(&self, tile: usize) -> MutexGuard<'_, Tile> {
        let mut tile = lock(&self.tiles[tile]);
        if tile.pixels.is_empty() {
            tile.pixels = vec![Pixel::default(); PER_TILE];
            if self.options.auxiliary {
                tile.auxiliary = vec![Auxiliary::default(); PER_TILE];
            }
            if self.options.gathering {
                tile.gathering = vec![Gathering::default(); PER_TILE];
            }
        }
        tile
    }

    /// Calls `visit` for each pixel of the image with its number in rows: tile by tile, or row by row within one.
    fn for_each(&self, visit: impl FnMut(usize, &Pixel, Beside)) {
        self.for_each_unless(&Cancel::new(), visit);
    }

    /// The same; false if it was cancelled in the middle.
    fn for_each_unless(&self, cancel: &Cancel, mut visit: impl FnMut(usize, &Pixel, Beside)) -> bool {
        let [width, height] = self.options.resolution;
        let none = Pixel::default();
        for (number, tile) in self.tiles.iter().enumerate() {
            if cancel.is_cancelled() {
                return false;
            }
            let [left, top] = self.tile_origin(number);
            let tile = lock(tile);
            for y in top..(top + TILE).min(height) {
                for x in left..(left + TILE).min(width) {
                    let index = ((y - top) * TILE + (x - left)) as usize;
                    let place = y as usize * width as usize + x as usize;
                    let beside = Beside { auxiliary: tile.auxiliary.get(index), gathering: tile.gathering.get(index) };
                    visit(place, tile.pixels.get(index).unwrap_or(&none), beside);
                }
            }
        }
        true
    }

    fn write<const N: usize>(&self, out: &mut [f32], value: impl Fn(&Pixel, Beside) -> [f32; N]) {
        let (out, _) = out.as_chunks_mut::<N>();
        self.for_each(|place, pixel, beside| {
            if let Some(out) = out.get_mut(place) {
                *out = value(pixel, beside);
            }
        });
    }

    fn pixel_count(&self) -> usize {
        self.options.resolution[0] as usize * self.options.resolution[1] as usize
    }

    /// The image as it stands: means of what was sampled, black where nothing was.
    ///
    /// Layers: `samples`, `variance` (of the pixel's mean; NaN where there are fewer than four replicates), and with
    /// auxiliary data `albedo`, `normal` and `depth`.
    pub fn develop(&self) -> Image {
        let [width, height] = self.options.resolution;
        let mut kinds = vec![("samples", LayerKind::Samples), ("variance", LayerKind::Variance)];
        if self.options.auxiliary {
            let first = [("albedo", LayerKind::Albedo), ("normal", LayerKind::Normal), ("depth", LayerKind::Depth)];
            kinds.splice(0..0, first);
        }
        if self.options.gathering {
            kinds.push(("bias", LayerKind::Bias));
        }
        let room = |channels: usize| vec![0.0; channels * self.pixel_count()];
        let empty = |&(name, kind): &(&str, LayerKind)| {
            let channels = kind.channels();
            Layer { name: name.to_owned(), channels, data: room(channels) }
        };
        let (mut rgb, mut layers) = (room(3), kinds.iter().map(empty).collect::<Vec<_>>());
        self.for_each(|place, pixel, beside| {
            if let Some(out) = rgb.get_mut(3 * place..3 * place + 3) {
                out.copy_from_slice(&pixel.mean(self.options.weighted));
            }
            for ((_, kind), layer) in kinds.iter().zip(&mut layers) {
                put(*kind, self.options.share, place, pixel, beside, &mut layer.data);
            }
        });
        Image { width, height, rgb, layers }
    }

    /// Writes the image as it stands as `[height][width][4]`, row 0 on top. The fourth value is the share of samples that
    /// hit a surface if `alpha` asks for it and auxiliary data is kept, else 1.
    ///
    /// # Errors
    /// [`ErrorKind::Internal`] for a slice of another length.
    pub fn rgba_into(&self, out: &mut [f32], alpha: bool) -> Result<()> {
        self.check_length(out, 4)?;
        self.write(out, |pixel, beside| self.rgba(pixel, beside.auxiliary, alpha));
        Ok(())
    }

    /// Writes a layer as it stands as `[height][width][channels]`, row 0 on top.
    ///
    /// # Errors
    /// [`ErrorKind::Internal`] for a slice of another length, and for a layer of first hits if the film keeps none.
    pub fn layer_into(&self, layer: LayerKind, out: &mut [f32]) -> Result<()> {
        self.check_layer(layer, out)?;
        self.write_layer(layer, out);
        Ok(())
    }

    fn write_layer(&self, layer: LayerKind, out: &mut [f32]) {
        self.for_each(|place, pixel, beside| put(layer, self.options.share, place, pixel, beside, out));
    }

    /// What [`Film::rgba_into`] and [`Film::layer_into`] do for several layers, in one walk over the film; false if it was
    /// cancelled in the middle, and then some of it is older.
    ///
    /// # Errors
    /// As for these two.
    pub fn read_into(
        &self,
        rgba: &mut [f32],
        alpha: bool,
        layers: &mut [(LayerKind, Vec<f32>)],
        cancel: &Cancel,
    ) -> Result<bool> {
        self.check_length(rgba, 4)?;
        for (layer, out) in &*layers {
            self.check_layer(*layer, out)?;
        }
        Ok(self.for_each_unless(cancel, |place, pixel, beside| {
            if let Some(out) = rgba.get_mut(4 * place..4 * place + 4) {
                out.copy_from_slice(&self.rgba(pixel, beside.auxiliary, alpha));
            }
            for (layer, out) in &mut *layers {
                put(*layer, self.options.share, place, pixel, beside, out);
            }
        }))
    }

    fn rgba(&self, pixel: &Pixel, auxiliary: Option<&Auxiliary>, alpha: bool) -> [f32; 4] {
        let [r, g, b] = pixel.mean(self.options.weighted);
        let coverage = auxiliary.filter(|_| alpha).map_or(1.0, |auxiliary| auxiliary.coverage(pixel.count()));
        [r, g, b, coverage]
    }

    fn check_layer(&self, layer: LayerKind, out: &[f32]) -> Result<()> {
        self.check_length(out, layer.channels())?;
        if layer.is_auxiliary() && !self.options.auxiliary {
            return Err(Error::new(ErrorKind::Internal, format!("the film keeps no first hits for {layer:?}")));
        }
        Ok(())
    }

    fn check_length(&self, out: &[f32], channels: usize) -> Result<()> {
        let expected = channels * self.pixel_count();
        if out.len() == expected {
            return Ok(());
        }
        Err(Error::new(ErrorKind::Internal, format!("room for {} values where there are {expected}", out.len())))
    }

    /// Samples that were NaN or infinite, and were left out.
    pub fn non_finite(&self) -> u64 {
        let mut count = 0;
        self.for_each(|_, pixel, _| count += u64::from(pixel.non_finite()));
        count
    }
}

/// Writes what a layer has of one pixel.
#[inline]
fn put(
    layer: LayerKind,
    share: u32,
    place: usize,
    pixel: &Pixel,
    Beside { auxiliary, gathering }: Beside,
    out: &mut [f32],
) {
    let mean =
        |sum: Option<[f64; 3]>| sum.unwrap_or_default().map(|sum| (sum / f64::from(pixel.count().max(1))) as f32);
    let three = match layer {
        LayerKind::Albedo => mean(auxiliary.map(|auxiliary| auxiliary.albedo)),
        LayerKind::Normal => mean(auxiliary.map(|auxiliary| auxiliary.normal)),
        LayerKind::Variance => pixel.variance(share).map(|variance| variance as f32),
        LayerKind::StandardError => pixel.variance(share).map(|variance| variance.sqrt() as f32),
        LayerKind::Bias => gathering.and_then(Gathering::bias).unwrap_or_default().map(|bias| bias as f32),
        LayerKind::Depth | LayerKind::Samples => {
            if let Some(out) = out.get_mut(place) {
                *out = match layer {
                    LayerKind::Depth => auxiliary.map_or(f32::INFINITY, Auxiliary::mean_depth),
                    _ => pixel.count() as f32,
                };
            }
            return;
        }
    };
    if let Some(out) = out.get_mut(3 * place..3 * place + 3) {
        out.copy_from_slice(&three);
    }
}

fn no_room() -> Error {
    Error::new(ErrorKind::OutOfMemory, "no room for the film")
}

/// A tile whose last holder may have panicked: its pixels are whole all the same, as each is changed at once.
fn lock(tile: &Mutex<Tile>) -> MutexGuard<'_, Tile> {
    tile.lock().unwrap_or_else(PoisonError::into_inner)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::Vec3;

    fn film(auxiliary: bool) -> Film {
        Film::new(FilmOptions { resolution: [19, 17], auxiliary, share: 1, weighted: false, gathering: false }).unwrap()
    }

    #[test]
    fn readers_agree_with_the_developed_image() {
        let film = film(true);
        for tile in 0..film.tile_count() {
            let [left, top] = film.tile_origin(tile);
            let mut tile = film.tile(tile);
            for index in 0..PER_TILE {
                let value = (left as usize + index % 16 + 100 * (top as usize + index / 16)) as f32;
                for _ in 0..4 {
                    tile.pixels[index].add(Vec3::splat(value), 1.0, 1);
                    tile.pixels[index].add(Vec3::splat(3.0 * value), 1.0, 1);
                    tile.auxiliary[index].add(Vec3::splat(0.5), Vec3::Z, value);
                }
            }
        }
        let image = film.develop();
        assert_eq!(image.pixel(18, 16), [2.0 * 1618.0; 3]);
        let mut rgba = vec![0.0; 4 * 19 * 17];
        film.rgba_into(&mut rgba, true).unwrap();
        for (rgba, rgb) in rgba.chunks_exact(4).zip(image.rgb.chunks_exact(3)) {
            assert_eq!((&rgba[..3], rgba[3]), (rgb, 0.5), "every other sample hit something");
        }
        for (kind, name) in
            [(LayerKind::Depth, "depth"), (LayerKind::Variance, "variance"), (LayerKind::Normal, "normal")]
        {
            let mut data = vec![0.0; kind.channels() * 19 * 17];
            film.layer_into(kind, &mut data).unwrap();
            assert_eq!(Some(&data), image.layer(name).map(|layer| &layer.data));
        }
        let mut errors = vec![0.0; 3 * 19 * 17];
        film.layer_into(LayerKind::StandardError, &mut errors).unwrap();
        // Of eight replicates at 2 -+ 1, the variance of the mean is 1/7.
        assert_eq!(errors[0..3], [0.0; 3]);
        assert!(errors[3..6].iter().all(|error| (error - 7.0_f32.sqrt().recip()).abs() < 1e-6), "{errors:?}");
    }

    #[test]
    fn what_is_not_kept_or_does_not_fit_is_refused() {
        let film = film(false);
        assert!(film.layer_into(LayerKind::Albedo, &mut vec![0.0; 3 * 19 * 17]).is_err());
        assert!(film.layer_into(LayerKind::Samples, &mut [0.0; 3]).is_err());
        let mut rgba = vec![5.0; 4 * 19 * 17];
        assert!(film.rgba_into(&mut rgba[1..], false).is_err());
        film.rgba_into(&mut rgba, true).unwrap();
        assert_eq!(rgba[..4], [0.0, 0.0, 0.0, 1.0], "black and opaque before the first sample");
    }
}
