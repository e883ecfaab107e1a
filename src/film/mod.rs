//! The film: sums of radiance for each pixel, and the image that is developed from them. It has no access to files.
//!
//! A sample belongs to one pixel only: pixel filters are importance sampled instead of splatted. Pixels are therefore
//! independent of each other, and a film is the same to the last bit for any number of threads and any order of tiles.
//! Source: Ernst et al. 2006, "Filter Importance Sampling".
//!
//! Sums are f64: 2^25 samples of 1 have the mean 1, not 2^24 / 2^25.

mod develop;
mod error;
mod photon_state;
mod pixel;
mod reference;
mod sums;
mod tile_bytes;

pub use develop::Shown;
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

    fn pixel_count(&self) -> usize {
        self.options.resolution[0] as usize * self.options.resolution[1] as usize
    }

    /// Number of samples that were NaN or infinite and therefore left out.
    pub fn non_finite(&self) -> u64 {
        let mut count = 0;
        self.for_each(|_, pixel, _| count += u64::from(pixel.non_finite()));
        count
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
