//! The pixels of a tile as bytes, little-endian, for files that keep a film with all that further samples need.

use super::{Film, FilmOptions, REPLICATES, TILE, Tile};

/// Bytes of a pixel, of its first hits, of the parts of its light, of a radius that shrinks and of its photon state.
const PIXEL: usize = REPLICATES * 24 + 16;
const AUXILIARY: usize = 60;
const LIGHT: usize = 48;
const RADIUS: usize = 20;
const PHOTONS: usize = 2 * RADIUS + 56;

/// Takes numbers from the front of bytes, of which there are enough.
pub(super) struct Bytes<'b>(&'b [u8]);

impl Bytes<'_> {
    fn take<const N: usize>(&mut self) -> [u8; N] {
        let (first, rest) = self.0.split_first_chunk().expect("there are as many bytes as the film has");
        self.0 = rest;
        *first
    }

    pub fn u32(&mut self) -> u32 {
        u32::from_le_bytes(self.take())
    }

    pub fn f32(&mut self) -> f32 {
        f32::from_le_bytes(self.take())
    }

    pub fn f64(&mut self) -> f64 {
        f64::from_le_bytes(self.take())
    }

    pub fn three(&mut self) -> [f64; 3] {
        std::array::from_fn(|_| self.f64())
    }
}

/// What pixels are made of, as bytes.
pub(super) trait AsBytes: Sized {
    fn put(&self, out: &mut Vec<u8>);

    /// `None` for numbers that no render comes to.
    fn get(bytes: &mut Bytes<'_>) -> Option<Self>;
}

impl FilmOptions {
    /// Number of bytes of a pixel with all that the film keeps for it.
    pub(crate) fn bytes_of_a_pixel(&self) -> usize {
        PIXEL + self.sum_of_kept([AUXILIARY, LIGHT, PHOTONS])
    }
}

impl Film {
    /// Width and height of the part of a tile that lies in the image.
    fn tile_size(&self, tile: usize) -> [u32; 2] {
        let origin = self.tile_origin(tile);
        [0, 1].map(|axis| (self.options.resolution[axis] - origin[axis]).min(TILE))
    }

    /// Number of bytes of a tile.
    pub(crate) fn tile_bytes(&self, tile: usize) -> usize {
        let [width, height] = self.tile_size(tile);
        width as usize * height as usize * self.options.bytes_of_a_pixel()
    }

    /// Indices in the film, row by row, of the pixels of a tile that lie in the image.
    pub(crate) fn pixels_of_tile(&self, tile: usize) -> impl Iterator<Item = usize> + use<> {
        let [width, height] = self.tile_size(tile);
        let [left, top] = self.tile_origin(tile);
        let columns = self.options.resolution[0];
        (0..height).flat_map(move |y| (0..width).map(move |x| ((top + y) * columns + left + x) as usize))
    }

    /// Gives the memory of a tile back. It has no samples afterwards.
    pub(crate) fn forget_tile(&self, tile: usize) {
        *super::lock(&self.tiles[tile]) = Tile::default();
    }

    /// Indices in the tile of the pixels that lie in the image, row by row.
    fn tile_pixels(&self, tile: usize) -> impl Iterator<Item = usize> + use<> {
        let [width, height] = self.tile_size(tile);
        (0..height).flat_map(move |y| (0..width).map(move |x| (y * TILE + x) as usize))
    }

    /// Appends the pixels of a tile to `out`, as they are between two additions of samples. `false` for a tile without samples, of
    /// which nothing is written.
    pub(crate) fn put_tile(&self, tile: usize, out: &mut Vec<u8>) -> bool {
        let pixels = self.tile_pixels(tile);
        let tile = super::lock(&self.tiles[tile]);
        if tile.pixels.is_empty() {
            return false;
        }
        for index in pixels {
            tile.pixels[index].put(out);
            if let Some(auxiliary) = tile.auxiliary.get(index) {
                auxiliary.put(out);
            }
            if let Some(sums) = tile.light_sums.get(index) {
                sums.put(out);
            }
            if let Some(gathering) = tile.gathering.get(index) {
                gathering.put(out);
            }
        }
        true
    }

    /// Fills a tile with pixels from [`Film::put_tile`] of a film with the same options. `None` for numbers that no render comes to, of
    /// which none are taken. `bytes`: [`Film::tile_bytes`] of them.
    pub(crate) fn get_tile(&self, number: usize, bytes: &[u8]) -> Option<()> {
        let mut bytes = Bytes(bytes);
        let mut tile = Tile::new(&self.options);
        for index in self.tile_pixels(number) {
            tile.pixels[index] = AsBytes::get(&mut bytes)?;
            if let Some(auxiliary) = tile.auxiliary.get_mut(index) {
                *auxiliary = AsBytes::get(&mut bytes)?;
            }
            if let Some(sums) = tile.light_sums.get_mut(index) {
                *sums = AsBytes::get(&mut bytes)?;
            }
            if let Some(gathering) = tile.gathering.get_mut(index) {
                *gathering = AsBytes::get(&mut bytes)?;
            }
        }
        let mut place = super::lock(&self.tiles[number]);
        tile.changes = place.changes + 1;
        *place = tile;
        Some(())
    }
}

/// Appends numbers of double precision.
pub(super) fn put_all<'n>(numbers: impl IntoIterator<Item = &'n f64>, out: &mut Vec<u8>) {
    numbers.into_iter().for_each(|number| out.extend(number.to_le_bytes()));
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::film::{PixelPhotonState, PixelSample, ShrinkingRadius};
    use crate::math::Vec3;
    use crate::spectrum::Rgb;

    fn film(options: FilmOptions) -> Film {
        Film::new(FilmOptions { resolution: [19, 17], ..options }).unwrap()
    }

    fn options(auxiliary: bool, gathering: bool) -> FilmOptions {
        let resolution = [1, 1];
        let light_parts = auxiliary;
        FilmOptions { resolution, placement: None, auxiliary, light_parts, share: 1, weighted: false, gathering }
    }

    #[test]
    fn tiles_come_back_bit_by_bit() {
        for options in [options(false, false), options(true, false), options(true, true)] {
            let (from, to) = (film(options), film(options));
            let mut radius = ShrinkingRadius::default();
            radius.begin(0, 0.7, || 0.3);
            radius.add_estimate(5);
            let mut state = PixelPhotonState::default();
            state.caustic = radius;
            state.add_bias(1, Rgb::new(0.25, -0.5, 1.0 / 3.0));
            for (tile, index) in [(0, 0), (0, 17), (1, 1), (3, 2)] {
                for count in 1..12 {
                    let value = Rgb::new(0.1, 0.2, 1e-3) * count as f32;
                    let first = (count % 3 > 0).then_some((value, Vec3::new(0.6, 0.0, -0.8), 1.7));
                    let radiance = if count == 7 { Rgb::splat(f32::NAN) } else { value };
                    let gathering = options.gathering.then_some(state);
                    let parts = [0.2, 0.3].map(|part| radiance * part);
                    let sample = PixelSample { radiance, weight: 0.9, gathering, first, parts };
                    from.tile(tile).add_sample(index, sample, 1);
                }
            }
            for tile in 0..from.tile_count() {
                let mut bytes = Vec::new();
                assert_eq!(from.put_tile(tile, &mut bytes), tile != 2);
                if tile != 2 {
                    assert_eq!(bytes.len(), from.tile_bytes(tile));
                    to.get_tile(tile, &bytes).unwrap();
                    let mut again = Vec::new();
                    assert!(to.put_tile(tile, &mut again));
                    assert_eq!(bytes, again);
                }
            }
            let bits = |film: &Film| film.develop().rgb.iter().map(|value| value.to_bits()).collect::<Vec<_>>();
            assert_eq!(bits(&from), bits(&to));
            assert_eq!(to.non_finite(), 4);
        }
    }

    #[test]
    fn numbers_that_no_render_comes_to_are_refused() {
        let film = film(options(false, true));
        let mut bytes = Vec::new();
        drop(film.tile(0));
        film.put_tile(0, &mut bytes);
        assert!(film.get_tile(0, &bytes).is_some());
        for (place, value) in [
            (0, f64::NAN.to_le_bytes()),
            (184, f64::INFINITY.to_le_bytes()),
            (192, f64::NAN.to_le_bytes()),
            // More samples that are not finite than samples.
            (200, [0, 0, 0, 0, 1, 0, 0, 0]),
            (208, [0, 0, 0x80, 0x7f, 0, 0, 0, 0]),
        ] {
            let mut changed = bytes.clone();
            changed[place..place + 8].copy_from_slice(&value);
            assert!(film.get_tile(0, &changed).is_none(), "at {place}");
            let mut kept = Vec::new();
            film.put_tile(0, &mut kept);
            assert!(kept == bytes, "at {place}");
        }
    }
}
