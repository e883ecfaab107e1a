//! What relative errors of pixels are relative to: their own means or, where those are not known yet, the means of their
//! surroundings (docs/error-estimates.md).

use std::sync::{Arc, Mutex, PoisonError};

use super::sums::{PixelError, mean_of_channels};
use super::{Film, TILE};
use crate::Cancel;
use crate::control::{Parallel, WorkProgress};
use crate::error::Result;
use crate::room::{push, with_room};
use crate::spectrum::luminance;

/// A pixel's mean is known if its variance is at most this fraction of its square. The error of such a pixel is relative to its
/// own mean alone.
const KNOWN_VARIANCE: f64 = 0.1;

/// Logarithms of the likelihood ratio that a pixel is brighter than its surroundings. Up to the first, the pixel's error is
/// relative to its surroundings, and from the second on, it is relative to its own mean. They are odds of 20 and of 150 to one.
const EVIDENCE: [f64; 2] = [3.0, 5.0];

/// Reach of a pixel's surroundings in pixels: they are 5 x 5 pixels without the one in the middle. With 3 x 3 pixels, of which
/// each has met a bright path with a probability of one in ten, most surroundings would contain no bright path.
const REACH: usize = 2;

/// Number of pixels between two checks for a cancel.
const CANCEL_INTERVAL: usize = 1 << 12;

/// A pixel whose own mean is not known yet. An image may consist of such pixels, so the structure is small: 24 bytes.
struct UnknownMean {
    place: u32,
    /// Mean of the surroundings, without the share of what stray paths carry.
    surroundings: [f32; 3],
    /// Weight of the error relative to the surroundings, in [0, 1]: the exponent of a geometric mean. Before the pixel is
    /// compared with its surroundings, it is the variance of the pixel's mean, summed over the channels.
    weight: f64,
}

impl UnknownMean {
    /// The pixel at `place`, unless its mean is known.
    fn new(place: usize, mean: [f32; 3], variances: [f64; 3]) -> Option<Self> {
        let variance = variances.iter().sum();
        let square: f64 = mean.iter().map(|&mean| f64::from(mean) * f64::from(mean)).sum();
        // A variance that is NaN is not known either.
        if variance <= KNOWN_VARIANCE * square {
            return None;
        }
        Some(Self { place: place as u32, surroundings: [0.0; 3], weight: variance })
    }
}

/// What the errors of a film's pixels are relative to.
///
/// relMSE is squared error over the squared *true* mean. If the error were relative to the pixel's own mean, a bright path
/// that one sample has met would have a large error only in proportion to itself, and no pixel could have a relative error
/// above 1. If the error were always relative to the surroundings, a pixel that shows a small bright reflection would have a
/// relative error of millions. The number of bright samples distinguishes the two cases.
///
/// A pixel's mean m with variance v is as uncertain as if it rested on n = m^2 / v bright samples. If its true mean were the
/// mean s < m of its surroundings, each of these samples would be less likely by a factor s / m. The first sample is no
/// evidence, since some pixel must meet bright paths that are rare. The logarithm of the likelihood ratio is therefore
/// (n - 1) ln(m / s).
pub(super) struct Reference {
    /// The value e that relMSE adds to squared means.
    floor: f64,
    /// For each row of tiles, the pixels whose own mean does not count alone, sorted by place.
    unknown: Vec<Vec<UnknownMean>>,
    /// Light of these pixels beyond that of their surroundings, as a multiple of the surroundings' light, summed over the
    /// image. Divided by the number of pixels, it is the share of light that rare bright paths carry, which surroundings that
    /// have met none of them lack. If the same radiance were added everywhere, it would be too much in dark pixels, which have
    /// most of relMSE.
    strays: [f64; 3],
    /// Number of pixels beside any one.
    others: f64,
    /// How far a pixel counts as brighter than its surroundings where one sample has met a bright path, from 0 to 1.
    repeats: f32,
}

/// The means of a film's pixels.
struct Means {
    /// Width of the image in pixels.
    width: usize,
    /// For each row of tiles, those of its pixels in row order: three channels and their luminance.
    rows: Vec<Vec<[f32; 4]>>,
    /// Number of pixels.
    count: usize,
    floor: f64,
    /// For each row of tiles, the pixels whose own mean is not known, sorted by place.
    unknown: Vec<Mutex<Vec<UnknownMean>>>,
}

/// Sums over the pixels of a row of tiles whose own mean does not count alone.
struct RareSums {
    strays: [f64; 3],
    rare: RarePixels,
}

impl Reference {
    /// Compares the pixels of unknown mean with their surroundings.
    ///
    /// # Errors
    /// [`ErrorKind::Cancelled`], and [`ErrorKind::OutOfMemory`].
    pub fn new(film: &Film, parallel: &mut impl Parallel) -> Result<Self> {
        let means = Arc::new(Means::new(film, false, parallel)?);
        let (own, cancel) = (Arc::clone(&means), parallel.token());
        let sums = parallel.map(means.unknown.len(), move |row| own.compare_row(row, &cancel))?;
        let mut strays = [0.0; 3];
        let mut rare = RarePixels { once: 0.0, often: 0.0 };
        for sums in sums {
            let RareSums { strays: row, rare: RarePixels { once, often } } = sums?;
            strays.iter_mut().zip(row).for_each(|(all, row)| *all += row);
            rare = RarePixels { once: rare.once + once, often: rare.often + often };
        }
        let take = |row: &Mutex<Vec<_>>| std::mem::take(&mut *row.lock().unwrap_or_else(PoisonError::into_inner));
        Ok(Self {
            floor: means.floor,
            unknown: means.unknown.iter().map(take).collect(),
            strays,
            others: means.count.saturating_sub(1).max(1) as f64,
            // Where paths find the light that walls scatter, stray paths are so many that the numbers tell nothing of
            // reflections.
            repeats: if film.options().gathering { rare.repeats() as f32 } else { 0.0 },
        })
    }

    /// Own means for all pixels. Errors relative to them are too small where samples are rare and bright, so that these samples
    /// do not dominate. A pixel's error then depends on other pixels' samples only by the mean of the whole image.
    ///
    /// # Errors
    /// As [`Reference::new`].
    pub fn own_means(film: &Film, parallel: &mut impl Parallel) -> Result<Self> {
        let Means { floor, .. } = Means::new(film, true, parallel)?;
        Ok(Self { floor, unknown: Vec::new(), strays: [0.0; 3], others: 1.0, repeats: 0.0 })
    }

    /// The relative error of a pixel with this mean and these squared errors. `row`: the row of tiles in which it lies.
    pub fn error(&self, row: usize, place: usize, own: [f32; 3], squared: [f64; 3]) -> PixelError {
        let relative_to =
            |mean: [f32; 3]| mean_of_channels(|i| squared[i] / (f64::from(mean[i]) * f64::from(mean[i]) + self.floor));
        let by_own = relative_to(own);
        let Some(unknown) = self.unknown(row, place) else { return PixelError { value: by_own, bound: by_own } };
        let [value, bound] = self.expected(unknown, own).map(|mean| {
            let by_others = relative_to(mean);
            // Products of noisy bias estimates may be negative. They have no geometric mean.
            if by_own > 0.0 && by_others > 0.0 { by_own * (by_others / by_own).powf(unknown.weight) } else { by_others }
        });
        PixelError { value, bound }
    }

    /// The pixel, if its own mean does not count alone.
    fn unknown(&self, row: usize, place: usize) -> Option<&UnknownMean> {
        let row = self.unknown.get(row)?;
        row.binary_search_by_key(&place, |pixel| pixel.place as usize).ok().map(|found| &row[found])
    }

    /// The mean that a pixel is expected to have, which is brighter than its surroundings where a bright path that one sample
    /// has met is more than chance, and the mean of the surroundings.
    fn expected(&self, unknown: &UnknownMean, own: [f32; 3]) -> [[f32; 3]; 2] {
        let own_excess = excess(unknown.weight, own, unknown.surroundings, self.floor);
        let surroundings: [f32; 3] = std::array::from_fn(|i| {
            let around = unknown.surroundings[i];
            // The pixel's own excess is left out, because the pixel is to be compared with the others. In an image without
            // light the difference is NaN, and nothing is added.
            around + (lift(around, self.floor) * (self.strays[i] - own_excess[i]) / self.others).max(0.0) as f32
        });
        let expected = std::array::from_fn(|i| surroundings[i] + self.repeats * (own[i] - surroundings[i]).max(0.0));
        [expected, surroundings]
    }
}

impl Means {
    /// `is_tame`: the mean of every pixel counts as known.
    fn new(film: &Film, is_tame: bool, parallel: &mut impl Parallel) -> Result<Self> {
        let (own, cancel) = (film.handle(), parallel.token());
        let (weighted, share) = (film.options().weighted, film.options().share);
        let rows = parallel.map(film.tile_rows(), move |row| {
            let places = own.places_of_row(row);
            let (mut means, mut unknown) = (with_room(places.len())?, Vec::new());
            means.resize(places.len(), [0.0; 4]);
            let (mut sum, mut room) = (0.0, Ok(()));
            own.for_each_of_row(row, &cancel, |place, pixel, _| {
                let mean = pixel.mean(weighted);
                sum += mean.map(f64::from).iter().sum::<f64>();
                let [r, g, b] = mean;
                means[place - places.start] = [r, g, b, luminance(mean.into())];
                let found = if is_tame { None } else { UnknownMean::new(place, mean, pixel.variance(share)) };
                if let (Some(found), Ok(())) = (found, &room) {
                    room = push(&mut unknown, found);
                }
            })?;
            room?;
            WorkProgress::new(&cancel).sort(&mut unknown, &|a, b| a.place.cmp(&b.place))?;
            Ok((means, sum, unknown))
        })?;
        let mut means = Self {
            width: film.options().resolution[0] as usize,
            rows: Vec::new(),
            count: film.pixel_count(),
            floor: 0.0,
            unknown: Vec::new(),
        };
        let mut sum = 0.0;
        for row in rows {
            let (row, sum_of_row, unknown) = row?;
            sum += sum_of_row;
            means.rows.push(row);
            means.unknown.push(Mutex::new(unknown));
        }
        let mean = sum / (3 * means.count).max(1) as f64;
        means.floor = 1e-2 * mean * mean;
        Ok(means)
    }

    /// The mean of a pixel, and its luminance.
    #[inline]
    fn of(&self, place: usize) -> ([f32; 3], f32) {
        let in_row = self.width * TILE as usize;
        let [r, g, b, luminance] = self.rows[place / in_row][place % in_row];
        ([r, g, b], luminance)
    }

    /// The mean of a pixel's neighbours without the pixel itself.
    ///
    /// Neighbours that are brighter than the pixel count as if they were as bright as the pixel. A lamp in the neighbourhood thus
    /// does not hide a bright path on the wall beside it, and the dim edge of a bright reflection is still compared with the
    /// reflection.
    fn of_surroundings(&self, place: usize) -> [f32; 3] {
        let (width, height) = (self.width, self.count / self.width);
        let (x, y) = (place % width, place / width);
        let (_, own) = self.of(place);
        let (mut sum, mut count) = ([0.0; 3], 0.0_f32);
        let columns = x.saturating_sub(REACH)..(x + REACH + 1).min(width);
        for row in y.saturating_sub(REACH)..(y + REACH + 1).min(height) {
            let start = row % TILE as usize * width;
            let means = &self.rows[row / TILE as usize][start..start + width][columns.clone()];
            for (column, &[r, g, b, brightness]) in columns.clone().zip(means) {
                if (row, column) == (y, x) {
                    continue;
                }
                // Filters with negative lobes may give a pixel zero or negative light.
                let scale = if own > 0.0 && brightness > own { own / brightness } else { 1.0 };
                for (sum, mean) in sum.iter_mut().zip([r, g, b]) {
                    *sum += scale * mean;
                }
                count += 1.0;
            }
        }
        sum.map(|sum| sum / count.max(1.0))
    }

    /// Compares the pixels of unknown mean in a row of tiles with their surroundings, and removes those whose own mean counts
    /// alone.
    fn compare_row(&self, row: usize, cancel: &Cancel) -> Result<RareSums> {
        let mut unknown = self.unknown[row].lock().unwrap_or_else(PoisonError::into_inner);
        let mut sums = RareSums { strays: [0.0; 3], rare: RarePixels { once: 0.0, often: 0.0 } };
        let mut kept = 0;
        for number in 0..unknown.len() {
            if number % CANCEL_INTERVAL == 0 {
                cancel.check()?;
            }
            let UnknownMean { place, weight: variance, .. } = unknown[number];
            let (own, brightness) = self.of(place as usize);
            let square: f64 = own.iter().map(|&mean| f64::from(mean) * f64::from(mean)).sum();
            let surroundings = self.of_surroundings(place as usize);
            let ratio = f64::from(brightness) / lift(luminance(surroundings.into()), self.floor);
            let evidence = (square / variance - 1.0).max(0.0) * ratio.max(1.0).ln();
            let [least, enough] = EVIDENCE;
            // Where there is no light at all, or no variance yet, the evidence is NaN.
            let weight = if evidence.is_nan() { 1.0 } else { ((enough - evidence) / (enough - least)).clamp(0.0, 1.0) };
            sums.rare.often += 1.0 - weight;
            if weight > 0.0 {
                sums.rare.once += weight * (1.0 - 1.0 / ratio.max(1.0));
                for (stray, excess) in sums.strays.iter_mut().zip(excess(weight, own, surroundings, self.floor)) {
                    *stray += excess;
                }
                unknown[kept] = UnknownMean { place, surroundings, weight };
                kept += 1;
            }
        }
        unknown.truncate(kept);
        Ok(sums)
    }
}

/// A mean, where means below the floor count as equal to it.
fn lift(mean: f32, floor: f64) -> f64 {
    (f64::from(mean) * f64::from(mean) + floor).sqrt()
}

/// Light of a pixel beyond that of its surroundings, as a multiple of the surroundings' light.
fn excess(weight: f64, own: [f32; 3], around: [f32; 3], floor: f64) -> [f64; 3] {
    std::array::from_fn(|i| weight * f64::from(own[i] - around[i]) / lift(around[i], floor))
}

/// Numbers of bright pixels whose mean is not known. A pixel may count in part in both.
#[derive(Clone, Copy, Debug)]
struct RarePixels {
    /// Those that rest on one sample.
    once: f64,
    /// Those that rest on more.
    often: f64,
}

impl RarePixels {
    /// How many bright samples are to be expected of a pixel where one is found, at most 1.
    ///
    /// By Good and Turing, it is 2 N(2) / N(1), where N(k) pixels rest on k samples: if many are met once and none is met
    /// twice, they are stray paths. Reflections of all sizes are equally many, so N(k) falls as 1 / k. Eight replicates tell
    /// two to four samples from more and from fewer, which makes N(2) a little less than `often / 2`. One more pixel of that
    /// kind is added, since most images have but a few of either.
    ///
    /// Source: Good 1953, "The Population Frequencies of Species and the Estimation of Population Parameters".
    fn repeats(self) -> f64 {
        ((self.often + 1.0) / self.once.max(1.0)).min(1.0)
    }
}

#[cfg(test)]
mod tests {
    use super::super::error::tests::{grey, grey_but, hits};
    use super::*;
    use crate::Alone;

    #[test]
    fn what_photon_films_meet_once_may_be_met_again() {
        // In this order: there is no rare pixel, there is a single one, both kinds are equally many, and there are only stray
        // paths.
        let repeats = |once, often| RarePixels { once, often }.repeats();
        assert_eq!(
            (repeats(0.0, 0.0), repeats(1.0, 0.0), repeats(5.0, 4.0), repeats(100.0, 0.0)),
            (1.0, 1.0, 1.0, 0.01)
        );
        // The first pixel of unknown mean: what its surroundings have, what it is expected to have, and the weight of these.
        let of = |film: Film| {
            let reference = Reference::new(&film, &mut Alone::default()).unwrap();
            let unknown = reference.unknown[0].first().unwrap();
            let [expected, around] = reference.expected(unknown, [101.0; 3]);
            (around[0], expected[0], unknown.weight)
        };
        let one = |gathering| grey_but(&[([3, 3], hits(1, 801.0))], gathering);
        assert_eq!(of(one(false)), (1.0, 1.0, 1.0));
        assert_eq!(of(one(true)), (1.0, 101.0, 1.0));
        // Four that one sample has met and one that two have: half.
        let at = [[0, 0], [6, 0], [0, 6], [6, 6]].map(|at| (at, hits(1, 801.0)));
        let more = grey_but(&[&at[..], &[([3, 3], hits(2, 801.0))]].concat(), true);
        // The same in several rows of tiles.
        let at = [[0, 0], [6, 0], [0, 39], [6, 39]].map(|at| (at, hits(1, 801.0)));
        let tall = grey([7, 40], &[&at[..], &[([3, 20], hits(2, 801.0))]].concat(), true);
        for film in [more, tall] {
            let (around, expected, _) = of(film);
            assert!(((expected - around) / (101.0 - around) - 0.5).abs() < 0.01, "{around}, {expected}");
        }
    }
}
