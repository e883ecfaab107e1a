//! Sums over the pixels of a film, from which the film's error follows.

use super::error::ErrorEstimate;

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

/// The mean over the channels of a value of theirs.
pub(super) fn mean_of_channels(value: impl Fn(usize) -> f64) -> f64 {
    (value(0) + value(1) + value(2)) / 3.0
}
