//! What a film shows: its image, the values of its layers, and which of its tiles are newer than what was read before.

use std::sync::{Mutex, PoisonError};

use super::{
    Auxiliary, Film, FilmOptions, Image, Layer, LayerKind, LightSums, Pixel, PixelExtras, PixelPhotonState, TILE, Tile,
    lock,
};
use crate::Cancel;
use crate::error::{Error, ErrorKind, Result};
use crate::room::check_room;
use crate::rows::rows;

/// How much of a film [`Film::read_into`] has developed: for each tile, how often it had changed.
#[derive(Clone, Debug, Default)]
pub struct Shown(Vec<u64>);

impl Film {
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

    fn write<const N: usize>(&self, out: &mut [f32], value: impl Fn(&Pixel, PixelExtras) -> [f32; N]) {
        let (out, _) = out.as_chunks_mut::<N>();
        self.for_each(|place, pixel, extras| {
            if let Some(out) = out.get_mut(place) {
                *out = value(pixel, extras);
            }
        });
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

#[cfg(test)]
mod tests {
    use super::super::{PIXELS_PER_TILE, PixelSample};
    use super::*;
    use crate::math::Vec3;
    use crate::spectrum::Rgb;

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
