//! Pixels whose own mean is not known yet, compared with their surroundings (docs/error-estimates.md).

use crate::Cancel;
use crate::control::WorkProgress;
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
pub(super) struct UnknownMean {
    pub place: u32,
    /// Mean of the pixel if it were no brighter than its surroundings.
    pub surroundings: [f32; 3],
    /// Weight of the error relative to the surroundings, in [0, 1]: the exponent of a geometric mean. Before
    /// [`compare_with_surroundings`], it is the variance of the pixel's mean, summed over the channels.
    pub weight: f64,
}

impl UnknownMean {
    /// The pixel at `place`, unless its mean is known.
    pub fn new(place: usize, mean: [f32; 3], variances: [f64; 3]) -> Option<Self> {
        let variance = variances.iter().sum();
        let square: f64 = mean.iter().map(|&mean| f64::from(mean) * f64::from(mean)).sum();
        // A variance that is NaN is not known either.
        if variance <= KNOWN_VARIANCE * square {
            return None;
        }
        Some(Self { place: place as u32, surroundings: [0.0; 3], weight: variance })
    }
}

/// Compares pixels of unknown mean with their surroundings, sorts them by place, and removes those whose own mean counts
/// alone. Returns the numbers of rare bright pixels; `None` if it was cancelled before the end.
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
///
/// `means`: the means of all pixels in row order. `width`: width of the image in pixels. `floor`: the value e that relMSE
/// adds to squared means.
pub(super) fn compare_with_surroundings(
    unknown: &mut Vec<UnknownMean>,
    means: &[[f32; 3]],
    width: usize,
    floor: f64,
    cancel: &Cancel,
) -> Option<RarePixels> {
    WorkProgress::new(cancel).sort(unknown, &|a, b| a.place.cmp(&b.place)).ok()?;
    // Means below the floor count as equal to it.
    let lift = |mean: f32| f64::from(mean).hypot(floor.sqrt());
    // Light of a pixel beyond that of its surroundings, as a multiple of the surroundings' light.
    let excess = |weight: f64, own: [f32; 3], around: [f32; 3]| -> [f64; 3] {
        std::array::from_fn(|i| weight * f64::from(own[i] - around[i]) / lift(around[i]))
    };
    // Sum over the image. Divided by the number of pixels, it is the share of light that rare bright paths carry, which
    // surroundings that have met none of them lack. If the same radiance were added everywhere, it would be too much in dark
    // pixels, which have most of relMSE.
    let mut strays = [0.0_f64; 3];
    let mut rare = RarePixels { once: 0.0, often: 0.0 };
    let mut kept = 0;
    for number in 0..unknown.len() {
        if number % CANCEL_INTERVAL == 0 && cancel.is_cancelled() {
            return None;
        }
        let UnknownMean { place, weight: variance, .. } = unknown[number];
        let own = means[place as usize];
        let square: f64 = own.iter().map(|&mean| f64::from(mean) * f64::from(mean)).sum();
        let surroundings = mean_of_surroundings(means, width, place as usize);
        let ratio = f64::from(luminance(own.into())) / lift(luminance(surroundings.into()));
        let evidence = (square / variance - 1.0).max(0.0) * ratio.max(1.0).ln();
        let [least, enough] = EVIDENCE;
        // Where there is no light at all, or no variance yet, the evidence is NaN.
        let weight = if evidence.is_nan() { 1.0 } else { ((enough - evidence) / (enough - least)).clamp(0.0, 1.0) };
        rare.often += 1.0 - weight;
        if weight > 0.0 {
            rare.once += weight * (1.0 - 1.0 / ratio.max(1.0));
            for (stray, excess) in strays.iter_mut().zip(excess(weight, own, surroundings)) {
                *stray += excess;
            }
            unknown[kept] = UnknownMean { place, surroundings, weight };
            kept += 1;
        }
    }
    unknown.truncate(kept);
    let others = means.len().saturating_sub(1).max(1) as f64;
    for UnknownMean { place, surroundings, weight } in unknown {
        let own_excess = excess(*weight, means[*place as usize], *surroundings);
        for (around, (stray, own_excess)) in surroundings.iter_mut().zip(strays.into_iter().zip(own_excess)) {
            // The pixel's own excess is left out, because the pixel is to be compared with the others. In an image without light
            // the difference is NaN, and nothing is added.
            *around += (lift(*around) * (stray - own_excess) / others).max(0.0) as f32;
        }
    }
    Some(rare)
}

/// Numbers of bright pixels whose mean is not known. A pixel may count in part in both.
#[derive(Clone, Copy, Debug)]
pub(super) struct RarePixels {
    /// Those that rest on one sample.
    pub once: f64,
    /// Those that rest on more.
    pub often: f64,
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
    pub fn repeats(self) -> f64 {
        ((self.often + 1.0) / self.once.max(1.0)).min(1.0)
    }
}

/// The mean of a pixel's neighbours without the pixel itself.
///
/// Neighbours that are brighter than the pixel count as if they were as bright as the pixel. A lamp in the neighbourhood thus
/// does not hide a bright path on the wall beside it, and the dim edge of a bright reflection is still compared with the
/// reflection.
fn mean_of_surroundings(means: &[[f32; 3]], width: usize, place: usize) -> [f32; 3] {
    let (x, y, height) = (place % width, place / width, means.len() / width);
    let own = luminance(means[place].into());
    let (mut sum, mut count) = ([0.0; 3], 0.0_f32);
    for row in y.saturating_sub(REACH)..(y + REACH + 1).min(height) {
        for column in x.saturating_sub(REACH)..(x + REACH + 1).min(width) {
            let neighbour = row * width + column;
            if neighbour == place {
                continue;
            }
            let brightness = luminance(means[neighbour].into());
            // Filters with negative lobes may give a pixel zero or negative light.
            let scale = if own > 0.0 && brightness > own { own / brightness } else { 1.0 };
            for (sum, mean) in sum.iter_mut().zip(means[neighbour]) {
                *sum += scale * mean;
            }
            count += 1.0;
        }
    }
    sum.map(|sum| sum / count.max(1.0))
}
