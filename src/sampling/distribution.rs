//! Choice among finitely many indices in proportion to weights.

use crate::{Cancel, Result};

/// Indices between two checks of a [`Cancel`].
const ITEMS_PER_CHECK: usize = 1 << 14;

/// A discrete distribution over indices, sampled in constant expected time.
///
/// The cumulative distribution is kept in double precision. A guide table with one entry per index says where in it to
/// start looking, so that a search takes less than two steps on average. Source: Chen and Asau 1974, "On Generating
/// Random Variates from an Empirical Distribution".
///
/// A single-precision number in [0, 1) has 24 bits: indices of probability below 2^-24 are drawn with a granular
/// probability unless the number is given with more bits.
#[derive(Clone, Debug)]
pub struct Distribution1D {
    /// cdf[i] is the probability of an index below i; one entry more than indices.
    cdf: Vec<f64>,
    /// guide[k] is the last index whose cdf is <= k / len.
    guide: Vec<u32>,
    total: f64,
}

/// Up to this many indices, the search is linear.
const LINEAR_SEARCH_LIMIT: usize = 8;

impl Distribution1D {
    /// The distribution with probabilities in proportion to `weights` (any unit). `None` for no weight above 0, for a
    /// negative weight, one that is not finite, or a sum that overflows.
    pub fn new(weights: &[f64]) -> Option<Self> {
        Self::cancellable(weights, &Cancel::new()).unwrap_or_default()
    }

    /// As [`Distribution1D::new`], cancellable by `cancel`.
    ///
    /// # Errors
    /// [`crate::ErrorKind::Cancelled`].
    pub fn cancellable(weights: &[f64], cancel: &Cancel) -> Result<Option<Self>> {
        if weights.len() >= u32::MAX as usize || weights.iter().any(|w| !w.is_finite() || *w < 0.0) {
            return Ok(None);
        }
        let total: f64 = weights.iter().sum();
        if total == 0.0 || !total.is_finite() {
            return Ok(None);
        }
        let mut cdf = Vec::with_capacity(weights.len() + 1);
        let mut sum = 0.0;
        cdf.push(0.0);
        for block in weights.chunks(ITEMS_PER_CHECK) {
            cancel.check()?;
            for w in block {
                sum += w;
                // The sum is divided instead of adding quotients, so that the last positive entry ends at exactly 1.
                cdf.push(sum / total);
            }
        }
        let len = weights.len();
        let mut guide = Vec::with_capacity(len);
        let mut index = 0;
        for k in 0..len {
            if k % ITEMS_PER_CHECK == 0 {
                cancel.check()?;
            }
            let u = k as f64 / len as f64;
            while index + 1 < len && cdf[index + 1] <= u {
                index += 1;
            }
            guide.push(index as u32);
        }
        Ok(Some(Self { cdf, guide, total }))
    }

    /// Number of indices.
    pub fn len(&self) -> usize {
        self.guide.len()
    }

    /// Whether there is no index; never true.
    pub fn is_empty(&self) -> bool {
        self.guide.is_empty()
    }

    /// Sum of the weights.
    pub fn total(&self) -> f64 {
        self.total
    }

    /// Probability of `index`; 0 beyond the end.
    #[inline]
    pub fn pmf(&self, index: usize) -> f32 {
        match self.cdf.get(index..=index + 1) {
            Some(&[low, high]) => (high - low) as f32,
            _ => 0.0,
        }
    }

    /// The index whose interval holds `u` in [0, 1), its probability, and the position of `u` in that interval, again
    /// in [0, 1): uniform and independent of the index, so that it can be reused. An index of weight 0 is never
    /// returned.
    // Always inlined: a caller without a use for the remapped number does not pay for its division.
    #[inline(always)]
    pub fn sample(&self, u: impl Into<f64>) -> (usize, f32, f32) {
        let u = u.into().clamp(0.0, 1.0 - f64::EPSILON);
        let index = self.find(u);
        let (low, high) = (self.cdf[index], self.cdf[index + 1]);
        let remapped = ((u - low) / (high - low)) as f32;
        (index, (high - low) as f32, remapped.clamp(0.0, 1.0_f32.next_down()))
    }

    /// The entry whose interval of [0, 1) holds `u`.
    #[inline]
    fn find(&self, u: f64) -> usize {
        let len = self.guide.len();
        if len <= LINEAR_SEARCH_LIMIT {
            // A linear count without branches, because the entry cannot be predicted.
            return self.cdf[1..len].iter().map(|&end| usize::from(end <= u)).sum();
        }
        let mut index = self.guide[((u * len as f64) as usize).min(len - 1)] as usize;
        // Entries of weight 0 have equal ends and are skipped.
        while self.cdf[index + 1] <= u {
            index += 1;
        }
        // The product above may have been rounded up into the next cell of the guide.
        while self.cdf[index] > u {
            index -= 1;
        }
        index
    }
}
