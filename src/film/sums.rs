//! Sums over the pixels of a film, from which the film's error follows.

use super::error::{ErrorEstimate, SampleCounts};

/// What a pixel adds to the error of an image.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct PixelError {
    /// The pixel's squared error, the mean over channels.
    pub value: f64,
    /// The same if a bright path that one sample has met was a stray path. Standard errors are computed from it.
    pub bound: f64,
}

/// Sums over the pixels' terms of a mean, from which the mean and its standard error follow.
#[derive(Clone, Copy, Default)]
pub(super) struct Terms {
    count: f64,
    sum: f64,
    squares: f64,
}

impl Terms {
    /// Adds a pixel.
    pub fn add(&mut self, error: PixelError) {
        self.count += 1.0;
        self.sum += error.value;
        self.squares += error.bound * error.bound;
    }

    /// Adds the sums over other pixels.
    pub fn join(&mut self, other: Self) {
        self.count += other.count;
        self.sum += other.sum;
        self.squares += other.squares;
    }

    /// The mean and its standard error; `None` if a pixel has no estimate or the image is black.
    pub fn mean(&self) -> Option<ErrorEstimate> {
        // Products of noisy bias estimates may be negative.
        let value = if self.sum < 0.0 { 0.0 } else { self.sum / self.count };
        let scatter = (self.squares - self.sum * self.sum / self.count).max(0.0);
        // One pixel has no scatter. The standard error is then that of an exponential distribution.
        let standard_error =
            if self.count > 1.0 { (scatter / (self.count * (self.count - 1.0))).sqrt() } else { value };
        value.is_finite().then_some(ErrorEstimate { value, standard_error })
    }
}

/// Numbers of samples over pixels.
#[derive(Clone, Copy)]
pub(super) struct CountSums {
    min: u32,
    max: u32,
    sum: u64,
    pixels: u64,
}

impl Default for CountSums {
    fn default() -> Self {
        Self { min: u32::MAX, max: 0, sum: 0, pixels: 0 }
    }
}

impl CountSums {
    /// Adds a pixel with its number of samples.
    #[inline]
    pub fn add(&mut self, count: u32) {
        (self.min, self.max) = (self.min.min(count), self.max.max(count));
        self.sum += u64::from(count);
        self.pixels += 1;
    }

    /// Adds the numbers of other pixels.
    pub fn join(&mut self, other: Self) {
        (self.min, self.max) = (self.min.min(other.min), self.max.max(other.max));
        self.sum += other.sum;
        self.pixels += other.pixels;
    }

    /// Smallest and greatest number, and the mean.
    pub fn counts(&self) -> SampleCounts {
        SampleCounts { min: self.min, mean: self.sum as f64 / self.pixels.max(1) as f64, max: self.max }
    }
}

/// The mean over the channels of a value of theirs.
pub(super) fn mean_of_channels(value: impl Fn(usize) -> f64) -> f64 {
    (value(0) + value(1) + value(2)) / 3.0
}
