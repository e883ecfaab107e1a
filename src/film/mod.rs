//! The film: sums of radiance for each pixel, and the image that is developed from them. It has no access to files.
//!
//! A sample belongs to one pixel only: pixel filters are importance sampled instead of splatted. Pixels are therefore
//! independent of each other, and a film is the same to the last bit for any number of threads and any order of tiles.
//! Source: Ernst et al. 2006, "Filter Importance Sampling".
//!
//! Sums are f64: 2^25 samples of 1 have the mean 1, not 2^24 / 2^25.

mod error;
mod photon_state;
mod pixel;
mod reference;
mod sums;
mod tile_bytes;

pub use error::{ErrorEstimate, ErrorMeasure, SampleCounts};
pub(crate) use error::{Estimates, FEW_PIXELS};
pub use photon_state::{PixelPhotonState, ShrinkingRadius};
pub use pixel::{Auxiliary, LightSums, Pixel, REPLICATES};

pub use crate::image::{Image, Layer, Placement};

use std::ops::Range;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use crate::Cancel;
use crate::desc::MAX_PIXELS;
use crate::error::{Error, ErrorKind, Result};
use crate::math::Vec3;
use crate::room::{check_room, with_room};
use crate::rows::rows;
use crate::spectrum::Rgb;

/// Side of the square tiles that a film is divided into.
pub const TILE: u32 = 16;

/// Options of a film.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FilmOptions {
    /// Width and height, pixels.
    pub resolution: [u32; 2],
    /// Where the film lies in the picture; `None` where it is the picture, with square pixels.
    pub placement: Option<Placement>,
    /// Whether albedo, normal and depth of the first hit are stored.
    pub auxiliary: bool,
    /// Whether light is kept apart by how often it was scattered.
    pub light_parts: bool,
    /// Number of consecutive samples of a pixel with correlated errors, because they read the same photon maps; else 1.
    /// They belong to one of the [`REPLICATES`], from whose scatter the error is estimated.
    pub share: u32,
    /// Whether the filter's weights vary, so that sums must be divided by the total weight.
    pub weighted: bool,
    /// Whether pixels have photon state.
    pub gathering: bool,
}

/// A film in tiles of [`TILE`] x [`TILE`] pixels, shared by the threads that fill it and those that read it.
///
/// Each tile has a lock, so that any thread may develop the film while others fill it: it sees every pixel as it was
/// between two additions of samples. A tile allocates memory when it is filled for the first time.
#[derive(Debug)]
pub struct Film {
    options: FilmOptions,
    /// Shared with threads that read the film, whose work may end later than the borrow of the film that began it.
    tiles: Arc<Box<[Mutex<Tile>]>>,
}

/// How much of a film [`Film::read_into`] has developed: for each tile, how often it had changed.
#[derive(Clone, Debug, Default)]
pub struct Shown(Vec<u64>);

impl FilmOptions {
    /// Bytes of memory that a pixel takes.
    pub(crate) fn bytes_in_memory(&self) -> usize {
        let kept = [size_of::<Auxiliary>(), size_of::<LightSums>(), size_of::<PixelPhotonState>()];
        size_of::<Pixel>() + self.sum_of_kept(kept)
    }

    /// Bytes of what the film keeps for a pixel beside its sums, of first hits, parts of the light and photon state.
    fn sum_of_kept(&self, bytes: [usize; 3]) -> usize {
        let is_kept = [self.auxiliary, self.light_parts, self.gathering];
        bytes.into_iter().zip(is_kept).map(|(bytes, is_kept)| if is_kept { bytes } else { 0 }).sum()
    }
}

/// The pixels of a tile, row by row with [`TILE`] in a row, including those outside the image; empty until the tile is
/// filled.
#[derive(Debug, Default)]
pub(crate) struct Tile {
    pub pixels: Vec<Pixel>,
    /// One for each pixel; empty where the film has no auxiliary layers.
    pub auxiliary: Vec<Auxiliary>,
    /// One for each pixel; empty where the film keeps no parts of the light.
    pub light_sums: Vec<LightSums>,
    /// One for each pixel; empty where pixels have no photon state.
    pub gathering: Vec<PixelPhotonState>,
    /// Number of times that samples were added.
    changes: u64,
}

impl Tile {
    /// A tile without samples that has memory.
    fn new(options: &FilmOptions) -> Self {
        let count = |is_kept: bool| if is_kept { PIXELS_PER_TILE } else { 0 };
        Self {
            pixels: vec![Pixel::default(); PIXELS_PER_TILE],
            auxiliary: vec![Auxiliary::default(); count(options.auxiliary)],
            light_sums: vec![LightSums::default(); count(options.light_parts)],
            gathering: vec![PixelPhotonState::default(); count(options.gathering)],
            changes: 0,
        }
    }

    /// Number of samples of each pixel; the tile must have allocated memory.
    pub(crate) fn counts(&self) -> [u32; PIXELS_PER_TILE] {
        std::array::from_fn(|index| self.pixels[index].count())
    }

    /// Adds a sample to the pixel with this number in the tile, and to the layers that the film keeps. `share`: see
    /// [`FilmOptions::share`].
    #[inline]
    pub(crate) fn add_sample(&mut self, index: usize, sample: PixelSample, share: u32) {
        self.changes += 1;
        self.pixels[index].add(sample.radiance, sample.weight, share);
        if let (Some(kept), Some(gathering)) = (self.gathering.get_mut(index), sample.gathering) {
            *kept = gathering;
        }
        if let (Some(auxiliary), Some((albedo, normal, depth))) = (self.auxiliary.get_mut(index), sample.first) {
            auxiliary.add(albedo, normal, depth);
        }
        // A sample that is not finite counts as black in its parts, too.
        if let (Some(sums), true) = (self.light_sums.get_mut(index), sample.radiance.is_finite()) {
            sums.add(sample.parts, sample.weight);
        }
    }
}

/// A sample of a pixel, as a tile takes it.
pub(crate) struct PixelSample {
    /// Radiance, or irradiance; counts as black if it is not finite.
    pub radiance: Rgb,
    /// The weight that the pixel's filter gives it.
    pub weight: f32,
    /// What the pixel remembers after it, where pixels remember photons.
    pub gathering: Option<PixelPhotonState>,
    /// Albedo, shading normal and depth of the first hit, where there is one and the film keeps them.
    pub first: Option<(Rgb, Vec3, f32)>,
    /// What of the radiance was emitted towards the camera and what was scattered once, where the film keeps them apart.
    pub parts: [Rgb; 2],
}

/// Optional data of a pixel besides its sums.
#[derive(Clone, Copy)]
struct PixelExtras<'a> {
    auxiliary: Option<&'a Auxiliary>,
    light_sums: Option<&'a LightSums>,
    gathering: Option<&'a PixelPhotonState>,
}

/// Number of pixels in a tile.
const PIXELS_PER_TILE: usize = (TILE * TILE) as usize;

/// A layer that a film can develop besides its colour.
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
    /// Square root of the variance.
    StandardError,
    /// Estimated bias of the pixel's mean by photon maps: the mean is too large by this value. With maps that are shot
    /// only once, the bias of caustics alone; 0 without maps.
    Bias,
    /// Light that emitters send to the camera without being scattered on its way. Its sum with the next two is the colour.
    Emission,
    /// Light that was scattered once: that of emitters on the surfaces that the camera sees.
    Direct,
    /// Light that was scattered twice or more often.
    Indirect,
}

impl LayerKind {
    /// Values per pixel.
    pub fn channels(self) -> usize {
        match self {
            Self::Depth | Self::Samples => 1,
            Self::Albedo | Self::Normal | Self::Variance | Self::StandardError | Self::Bias => 3,
            Self::Emission | Self::Direct | Self::Indirect => 3,
        }
    }

    /// Whether the layer comes from the first hits, which a film stores only on request.
    fn is_auxiliary(self) -> bool {
        matches!(self, Self::Albedo | Self::Normal | Self::Depth)
    }

    /// Whether the layer is a part of the light, which a film keeps apart only on request.
    fn is_part_of_light(self) -> bool {
        matches!(self, Self::Emission | Self::Direct | Self::Indirect)
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
        if (count * PIXELS_PER_TILE) as u64 > 2 * MAX_PIXELS {
            let message =
                format!("{} x {} pixels in whole tiles are too many", options.resolution[0], options.resolution[1]);
            return Err(Error::new(ErrorKind::OutOfMemory, message));
        }
        let mut tiles = with_room(count)?;
        tiles.resize_with(count, Mutex::default);
        // The memory of all tiles is reserved once and released, so that a film that cannot fit is refused now.
        check_room(count * PIXELS_PER_TILE * options.bytes_in_memory())?;
        Ok(Self { options, tiles: Arc::new(tiles.into()) })
    }

    /// A film with the same samples.
    ///
    /// # Errors
    /// [`ErrorKind::OutOfMemory`].
    pub(crate) fn copy_of(film: &Self) -> Result<Self> {
        let copy = Self::new(film.options)?;
        for (from, to) in film.tiles.iter().zip(copy.tiles.iter()) {
            let Tile { pixels, auxiliary, light_sums, gathering, changes } = &*lock(from);
            let (pixels, auxiliary, light_sums) = (copied(pixels)?, copied(auxiliary)?, copied(light_sums)?);
            *lock(to) = Tile { pixels, auxiliary, light_sums, gathering: copied(gathering)?, changes: *changes };
        }
        Ok(copy)
    }

    /// The same film, not a copy: samples that are added to one are added to the other.
    fn handle(&self) -> Self {
        Self { options: self.options, tiles: Arc::clone(&self.tiles) }
    }

    /// Options of the film.
    pub fn options(&self) -> &FilmOptions {
        &self.options
    }

    /// Column and row of the picture that are the film's first.
    #[inline]
    pub(crate) fn origin(&self) -> [u32; 2] {
        self.options.placement.map_or([0; 2], |placement| placement.origin)
    }

    /// Whether a pixel of the picture is one of the film.
    pub(crate) fn has_pixel(&self, pixel: [u32; 2]) -> bool {
        let origin = self.origin();
        (0..2).all(|axis| pixel[axis].checked_sub(origin[axis]).is_some_and(|at| at < self.options.resolution[axis]))
    }

    /// Width of the picture that the film is, or is a part of.
    #[inline]
    pub(crate) fn picture_width(&self) -> u32 {
        self.options.placement.map_or(self.options.resolution, |placement| placement.picture)[0]
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

    /// Locks a tile for filling and allocates its pixels. The lock must be held briefly, because other threads may wait
    /// to read the tile.
    pub(crate) fn tile(&self, tile: usize) -> MutexGuard<'_, Tile> {
        let mut tile = lock(&self.tiles[tile]);
        if tile.pixels.is_empty() {
            *tile = Tile::new(&self.options);
        }
        tile
    }

    /// Calls `visit` for each pixel of the image with its index in row order: tile by tile, and row by row within a
    /// tile.
    fn for_each(&self, visit: impl FnMut(usize, &Pixel, PixelExtras)) {
        self.for_each_unless(&Cancel::new(), visit);
    }

    /// The same; false if it was cancelled before the end.
    fn for_each_unless(&self, cancel: &Cancel, visit: impl FnMut(usize, &Pixel, PixelExtras)) -> bool {
        self.for_each_where(cancel, |_, _| true, visit)
    }

    /// The same for the pixels of the tiles that `wants` accepts. It is asked once for each tile, by its number.
    fn for_each_where(
        &self,
        cancel: &Cancel,
        wants: impl FnMut(usize, &Tile) -> bool,
        visit: impl FnMut(usize, &Pixel, PixelExtras),
    ) -> bool {
        self.for_each_of(0..self.tiles.len(), cancel, wants, visit).is_ok()
    }

    /// Number of rows of tiles.
    fn tile_rows(&self) -> usize {
        self.options.resolution[1].div_ceil(TILE) as usize
    }

    /// [`Film::for_each_unless`] for the pixels of a row of tiles. Those of all rows of tiles are consecutive in row order.
    fn for_each_of_row(
        &self,
        row: usize,
        cancel: &Cancel,
        visit: impl FnMut(usize, &Pixel, PixelExtras),
    ) -> Result<()> {
        let across = self.options.resolution[0].div_ceil(TILE) as usize;
        self.for_each_of(row * across..(row + 1) * across, cancel, |_, _| true, visit)
    }

    /// Indices in row order of the pixels of a row of tiles.
    fn places_of_row(&self, row: usize) -> Range<usize> {
        let [width, height] = self.options.resolution.map(|length| length as usize);
        let [from, to] = [row, row + 1].map(|row| (row * TILE as usize).min(height) * width);
        from..to
    }

    /// [`Film::for_each_where`] for these tiles.
    ///
    /// # Errors
    /// [`ErrorKind::Cancelled`].
    fn for_each_of(
        &self,
        tiles: Range<usize>,
        cancel: &Cancel,
        mut wants: impl FnMut(usize, &Tile) -> bool,
        mut visit: impl FnMut(usize, &Pixel, PixelExtras),
    ) -> Result<()> {
        let [width, height] = self.options.resolution;
        let unsampled = Pixel::default();
        for number in tiles {
            cancel.check()?;
            let [left, top] = self.tile_origin(number);
            let tile = lock(&self.tiles[number]);
            if !wants(number, &tile) {
                continue;
            }
            for y in top..(top + TILE).min(height) {
                for x in left..(left + TILE).min(width) {
                    let index = ((y - top) * TILE + (x - left)) as usize;
                    let place = y as usize * width as usize + x as usize;
                    let extras = PixelExtras {
                        auxiliary: tile.auxiliary.get(index),
                        light_sums: tile.light_sums.get(index),
                        gathering: tile.gathering.get(index),
                    };
                    visit(place, tile.pixels.get(index).unwrap_or(&unsampled), extras);
                }
            }
        }
        Ok(())
    }

    fn write<const N: usize>(&self, out: &mut [f32], value: impl Fn(&Pixel, PixelExtras) -> [f32; N]) {
        let (out, _) = out.as_chunks_mut::<N>();
        self.for_each(|place, pixel, extras| {
            if let Some(out) = out.get_mut(place) {
                *out = value(pixel, extras);
            }
        });
    }

    fn pixel_count(&self) -> usize {
        self.options.resolution[0] as usize * self.options.resolution[1] as usize
    }

    /// The same as [`Film::develop`], by at most so many threads that end with it, and with an error where there is no memory for the
    /// image.
    ///
    /// # Errors
    /// [`ErrorKind::OutOfMemory`].
    pub fn try_develop(&self, threads: usize) -> Result<Image> {
        // All layers that there can be have less than 30 channels. Zeros that are not written take no memory.
        check_room(30 * size_of::<f32>() * self.pixel_count())?;
        Ok(self.develop_by(threads))
    }

    /// The current image: means of the samples, black where there are none.
    ///
    /// Layers: `samples`, `variance` (of the pixel's mean; NaN where there are fewer than four replicates), and with
    /// auxiliary data `albedo`, `normal` and `depth`. With parts of the light `emission`, `direct` and `indirect`.
    pub fn develop(&self) -> Image {
        self.develop_by(1)
    }

    fn develop_by(&self, threads: usize) -> Image {
        let [width, height] = self.options.resolution;
        let mut kinds = vec![("samples", LayerKind::Samples), ("variance", LayerKind::Variance)];
        if self.options.auxiliary {
            let first = [("albedo", LayerKind::Albedo), ("normal", LayerKind::Normal), ("depth", LayerKind::Depth)];
            kinds.splice(0..0, first);
        }
        if self.options.gathering {
            kinds.push(("bias", LayerKind::Bias));
        }
        if self.options.light_parts {
            let parts = [LayerKind::Emission, LayerKind::Direct, LayerKind::Indirect];
            kinds.extend(["emission", "direct", "indirect"].into_iter().zip(parts));
        }
        let room = |channels: usize| vec![0.0; channels * self.pixel_count()];
        let empty = |&(name, kind): &(&str, LayerKind)| {
            let channels = kind.channels();
            Layer { name: name.to_owned(), channels, data: room(channels) }
        };
        let (mut rgb, mut layers) = (room(3), kinds.iter().map(empty).collect::<Vec<_>>());
        {
            // What a row of tiles shows: its colours, and its values of each layer.
            let row = |channels: usize| (channels * TILE as usize * width as usize).max(1);
            let mut parts: Vec<_> = rgb.chunks_mut(row(3)).map(|rgb| (rgb, Vec::new())).collect();
            for Layer { channels, data, .. } in &mut layers {
                parts.iter_mut().zip(data.chunks_mut(row(*channels))).for_each(|((_, all), part)| all.push(part));
            }
            let parts: Vec<_> = parts.into_iter().map(Mutex::new).collect();
            rows(parts.len() as u32, threads, |number| {
                let (rgb, layers) = &mut *parts[number as usize].lock().unwrap_or_else(PoisonError::into_inner);
                let first = self.places_of_row(number as usize).start;
                self.for_each_of_row(number as usize, &Cancel::new(), |place, pixel, extras| {
                    let place = place - first;
                    if let Some(out) = rgb.get_mut(3 * place..3 * place + 3) {
                        out.copy_from_slice(&pixel.mean(self.options.weighted));
                    }
                    for ((_, kind), layer) in kinds.iter().zip(layers.iter_mut()) {
                        write_pixel(*kind, &self.options, place, pixel, extras, layer);
                    }
                })
                // It is not cancelled.
                .is_ok()
            });
        }
        Image { width, height, rgb, layers, placement: self.options.placement }
    }

    /// Writes the current image as `[height][width][4]`, row 0 on top. The fourth value is the fraction of samples that
    /// hit a surface if `alpha` is true and auxiliary data is stored, else 1.
    ///
    /// # Errors
    /// [`ErrorKind::Internal`] for a slice of another length.
    pub fn rgba_into(&self, out: &mut [f32], alpha: bool) -> Result<()> {
        self.check_length(out, 4)?;
        self.write(out, |pixel, extras| self.rgba(pixel, extras.auxiliary, alpha));
        Ok(())
    }

    /// Writes the current values of a layer as `[height][width][channels]`, row 0 on top.
    ///
    /// # Errors
    /// [`ErrorKind::Internal`] for a slice of another length, and for a layer of first hits or a part of the light if the film does not
    /// keep them.
    pub fn layer_into(&self, layer: LayerKind, out: &mut [f32]) -> Result<()> {
        self.check_layer(layer, out)?;
        self.write_layer(layer, out);
        Ok(())
    }

    /// Luminance of each pixel and the variance of that luminance, row by row; see [`Pixel::luminance`].
    pub fn luminances(&self) -> Vec<[f64; 2]> {
        let mut luminances = vec![[0.0; 2]; self.pixel_count()];
        self.for_each(|place, pixel, _| {
            if let Some(luminance) = luminances.get_mut(place) {
                *luminance = pixel.luminance(self.options.share);
            }
        });
        luminances
    }

    fn write_layer(&self, layer: LayerKind, out: &mut [f32]) {
        self.for_each(|place, pixel, extras| write_pixel(layer, &self.options, place, pixel, extras, out));
    }

    /// The same as [`Film::rgba_into`] and [`Film::layer_into`] for several layers, in one pass over the film; false if
    /// it was cancelled before the end, in which case some values are older than others.
    ///
    /// `shown`: what the values are of; [`Shown::default`] where they are of nothing. Only tiles that have changed since are
    /// developed, so that a film of which little has changed takes little time.
    ///
    /// # Errors
    /// As for these two.
    pub fn read_into(
        &self,
        rgba: &mut [f32],
        alpha: bool,
        layers: &mut [(LayerKind, Vec<f32>)],
        shown: &mut Shown,
        cancel: &Cancel,
    ) -> Result<bool> {
        self.check_length(rgba, 4)?;
        for (layer, out) in &*layers {
            self.check_layer(*layer, out)?;
        }
        let shown = &mut shown.0;
        shown.resize(self.tiles.len(), u64::MAX);
        let has_changed =
            |number: usize, tile: &Tile| std::mem::replace(&mut shown[number], tile.changes) != tile.changes;
        Ok(self.for_each_where(cancel, has_changed, |place, pixel, extras| {
            if let Some(out) = rgba.get_mut(4 * place..4 * place + 4) {
                out.copy_from_slice(&self.rgba(pixel, extras.auxiliary, alpha));
            }
            for (layer, out) in &mut *layers {
                write_pixel(*layer, &self.options, place, pixel, extras, out);
            }
        }))
    }

    /// Whether there are samples that the values of [`Film::read_into`] do not show yet.
    pub fn has_changed(&self, shown: &Shown) -> bool {
        let seen = |number: usize| shown.0.get(number).copied().unwrap_or(0);
        self.tiles.iter().enumerate().any(|(number, tile)| lock(tile).changes != seen(number))
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
        if layer.is_part_of_light() && !self.options.light_parts {
            return Err(Error::new(ErrorKind::Internal, format!("the film keeps no parts of the light for {layer:?}")));
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

    /// Number of samples that were NaN or infinite and therefore left out.
    pub fn non_finite(&self) -> u64 {
        let mut count = 0;
        self.for_each(|_, pixel, _| count += u64::from(pixel.non_finite()));
        count
    }
}

/// Writes the value of a layer for one pixel.
#[inline]
fn write_pixel(
    layer: LayerKind,
    &FilmOptions { share, weighted, .. }: &FilmOptions,
    place: usize,
    pixel: &Pixel,
    PixelExtras { auxiliary, light_sums, gathering }: PixelExtras,
    out: &mut [f32],
) {
    let parts = || light_sums.copied().unwrap_or_default();
    let mean =
        |sum: Option<[f64; 3]>| sum.unwrap_or_default().map(|sum| (sum / f64::from(pixel.count().max(1))) as f32);
    let three = match layer {
        LayerKind::Albedo => mean(auxiliary.map(|auxiliary| auxiliary.albedo)),
        LayerKind::Normal => mean(auxiliary.map(|auxiliary| auxiliary.normal)),
        LayerKind::Variance => pixel.variance(share).map(|variance| variance as f32),
        LayerKind::StandardError => pixel.variance(share).map(|variance| variance.sqrt() as f32),
        LayerKind::Emission => pixel.mean_of(parts().emission, weighted),
        LayerKind::Direct => pixel.mean_of(parts().direct, weighted),
        LayerKind::Indirect => {
            let (sum, LightSums { emission, direct }) = (pixel.sum(), parts());
            let rest = std::array::from_fn(|channel| sum[channel] - emission[channel] - direct[channel]);
            pixel.mean_of(rest, weighted)
        }
        LayerKind::Bias => gathering.and_then(PixelPhotonState::bias).unwrap_or_default().map(|bias| bias as f32),
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

fn copied<T: Copy>(values: &[T]) -> Result<Vec<T>> {
    let mut copy = with_room(values.len())?;
    copy.extend_from_slice(values);
    Ok(copy)
}

/// Locks a tile, even if a thread panicked while it held the lock: pixels are consistent all the same, as each is
/// changed at once.
fn lock(tile: &Mutex<Tile>) -> MutexGuard<'_, Tile> {
    tile.lock().unwrap_or_else(PoisonError::into_inner)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn film(auxiliary: bool) -> Film {
        Film::new(FilmOptions {
            resolution: [19, 17],
            placement: None,
            auxiliary,
            light_parts: auxiliary,
            share: 1,
            weighted: false,
            gathering: false,
        })
        .unwrap()
    }

    fn sample(value: f32, first: Option<(Rgb, Vec3, f32)>) -> PixelSample {
        let parts = [0.25, 0.5].map(|part| Rgb::splat(part * value));
        PixelSample { radiance: Rgb::splat(value), weight: 1.0, gathering: None, first, parts }
    }

    #[test]
    fn readers_agree_with_the_developed_image() {
        let film = film(true);
        for tile in 0..film.tile_count() {
            let [left, top] = film.tile_origin(tile);
            let mut tile = film.tile(tile);
            for index in 0..PIXELS_PER_TILE {
                let value = (left as usize + index % 16 + 100 * (top as usize + index / 16)) as f32;
                for _ in 0..4 {
                    let first = Some((Rgb::splat(0.5), Vec3::Z, value));
                    tile.add_sample(index, sample(value, first), 1);
                    tile.add_sample(index, sample(3.0 * value, None), 1);
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
            [(LayerKind::Depth, "depth"), (LayerKind::Variance, "variance"), (LayerKind::Indirect, "indirect")]
        {
            let mut data = vec![0.0; kind.channels() * 19 * 17];
            film.layer_into(kind, &mut data).unwrap();
            assert_eq!(Some(&data), image.layer(name).map(|layer| &layer.data));
        }
        let mut errors = vec![0.0; 3 * 19 * 17];
        film.layer_into(LayerKind::StandardError, &mut errors).unwrap();
        // Of eight replicates at 2 -+ 1, the variance of the mean is 1/7.
        assert_eq!(errors[0..3], [0.0; 3]);
        // A quarter of each sample was emitted and a half was scattered once.
        let part = |kind| {
            let mut data = vec![0.0; 3 * 19 * 17];
            film.layer_into(kind, &mut data).unwrap();
            data[3]
        };
        assert_eq!([LayerKind::Emission, LayerKind::Direct, LayerKind::Indirect].map(part), [0.5, 1.0, 0.5]);
        assert!(errors[3..6].iter().all(|error| (error - 7.0_f32.sqrt().recip()).abs() < 1e-6), "{errors:?}");
    }

    #[test]
    fn tiles_that_have_not_changed_are_not_developed_again() {
        let film = film(false);
        let (mut rgba, mut shown) = (vec![f32::NAN; 4 * 19 * 17], Shown::default());
        let read = |rgba: &mut [f32], shown: &mut Shown| film.read_into(rgba, true, &mut [], shown, &Cancel::new());
        assert!(!film.has_changed(&shown), "a film without samples has nothing to show");
        assert!(read(&mut rgba, &mut shown).unwrap());
        assert!(rgba.chunks_exact(4).all(|pixel| pixel == [0.0, 0.0, 0.0, 1.0]), "but it is black");
        film.tile(1).add_sample(16, sample(2.0, None), 1);
        assert!(film.has_changed(&shown));
        rgba.fill(f32::NAN);
        assert!(read(&mut rgba, &mut shown).unwrap());
        assert!(!film.has_changed(&shown));
        // The second tile has the last three columns of the first 16 rows.
        let developed = rgba.chunks_exact(4).enumerate().filter(|(_, pixel)| !pixel[0].is_nan());
        let places: Vec<usize> = developed.map(|(place, _)| place).collect();
        let expected: Vec<usize> = (0..16).flat_map(|y| (16..19).map(move |x| 19 * y + x)).collect();
        assert_eq!(places, expected);
        assert_eq!(rgba[4 * (19 + 16)], 2.0);
    }

    #[test]
    fn what_is_not_kept_or_does_not_fit_is_refused() {
        let film = film(false);
        for layer in [LayerKind::Albedo, LayerKind::Direct] {
            assert!(film.layer_into(layer, &mut vec![0.0; 3 * 19 * 17]).is_err());
        }
        assert!(film.layer_into(LayerKind::Samples, &mut [0.0; 3]).is_err());
        let mut rgba = vec![5.0; 4 * 19 * 17];
        assert!(film.rgba_into(&mut rgba[1..], false).is_err());
        film.rgba_into(&mut rgba, true).unwrap();
        assert_eq!(rgba[..4], [0.0, 0.0, 0.0, 1.0], "black and opaque before the first sample");
    }
}
