//! How many samples, and in which passes. No result depends on it.

use std::time::Duration;

use super::{Ended, Progress, RenderSettings};
use crate::desc::SamplerDesc;
use crate::film::Image;
use crate::sampling::square_side;

/// Samples per pixel that a render may reach, as many as a description may ask for: their indices stay far from wrapping
/// round.
pub const MOST_SAMPLES: u32 = 1 << 31;

/// A pass should not keep a viewer waiting longer than this.
const LONGEST_PASS: Duration = Duration::from_millis(500);

/// Samples of a replicate where no end is in sight: a render that only time limits must not wait for ever for an estimate
/// of its error.
const OPEN_REPLICATE: u32 = 16;

/// From so many samples on, a render counts as one without an end.
const OPEN_END: u32 = 1 << 20;

/// Samples per pixel that share one scramble.
///
/// More replicates make the estimated error more certain, larger ones are better stratified: of 256 samples in the
/// report's room, eight replicates have 21 % more squared error than a single one, four have 12 % more, and a single one
/// cannot tell.
///
/// Samples that share photon maps (`pass_samples`) are in the same replicate, as their errors are one.
pub(super) fn replicate_size(settings: &RenderSettings, pass_samples: Option<u32>) -> u32 {
    let size = match total(settings) {
        // Whoever aims at an error must hear of it early.
        samples if settings.target_error.is_some() => samples.div_ceil(4).min(OPEN_REPLICATE),
        OPEN_END.. => OPEN_REPLICATE,
        samples @ 16.. => samples / 4,
        samples @ 4.. => samples / 2,
        samples => samples,
    };
    pass_samples.map_or(size, |shared| size.max(1).next_multiple_of(shared))
}

/// Samples per pixel of a render that nothing cuts short.
fn total(settings: &RenderSettings) -> u32 {
    let samples = settings.desc.samples;
    match settings.desc.sampler {
        // A full pattern, or the pixel would not be covered evenly.
        SamplerDesc::Grid | SamplerDesc::Jittered => {
            let side = square_side(samples);
            side.saturating_mul(side).min(MOST_SAMPLES)
        }
        _ => samples.min(MOST_SAMPLES),
    }
}

/// The passes of a render.
#[derive(Clone, Debug)]
pub(super) struct Schedule {
    samples: u32,
    time_limit: Option<Duration>,
    target_error: Option<f64>,
}

impl Schedule {
    pub(super) fn new(settings: &RenderSettings) -> Self {
        let (time_limit, target_error) = (settings.time_limit, settings.target_error);
        Self { samples: total(settings), time_limit, target_error }
    }

    /// What ends the render now, if anything does; `error`: the estimated relative error, where one is aimed at.
    pub(super) fn ended(&self, done: u32, elapsed: Duration, error: Option<f64>) -> Option<Ended> {
        if done >= self.samples {
            return Some(Ended::Samples);
        }
        if self.time_limit.is_some_and(|limit| elapsed >= limit && done > 0) {
            return Some(Ended::Time);
        }
        error.zip(self.target_error).and_then(|(error, target)| (error <= target).then_some(Ended::Error))
    }

    /// Samples of the next pass.
    ///
    /// Passes double, so that a first image is there soon, until one takes as long as a viewer should wait. Where an error
    /// is aimed at, a pass goes no further than it is expected to be reached: it falls as 1 / sqrt(n).
    pub(super) fn next_pass(&self, done: u32, elapsed: Duration, error: Option<f64>) -> u32 {
        let affordable = if done == 0 || elapsed.is_zero() {
            1.0
        } else {
            f64::from(done) * LONGEST_PASS.as_secs_f64() / elapsed.as_secs_f64()
        };
        let mut most = done.max(1);
        if let (Some(target), Some(error)) = (self.target_error, error) {
            let missing = f64::from(done) * ((error / target).powi(2) - 1.0);
            most = most.min(missing.ceil() as u32).max(1);
        }
        (affordable as u32).clamp(1, most).min(self.samples - done)
    }

    /// The report on `complete` samples per pixel, `done` with those of an unfinished pass.
    pub(super) fn progress<'a>(
        &self,
        complete: u32,
        done: f64,
        rays: u64,
        elapsed: Duration,
        image: Option<&'a dyn Fn() -> Image>,
    ) -> Progress<'a> {
        Progress {
            fraction: self.fraction(done, elapsed),
            samples_done: complete,
            samples_total: self.samples,
            rays,
            elapsed,
            image,
        }
    }

    /// Share of the work that is done, by whichever limit is nearer.
    fn fraction(&self, samples: f64, elapsed: Duration) -> f64 {
        let by_samples = samples / f64::from(self.samples);
        let by_time = self.time_limit.map_or(0.0, |limit| elapsed.as_secs_f64() / limit.as_secs_f64().max(1e-9));
        by_samples.max(by_time).min(1.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::desc::RenderDesc;

    fn settings(samples: u32, sampler: SamplerDesc) -> RenderSettings {
        RenderSettings { desc: RenderDesc { samples, sampler, ..RenderDesc::default() }, ..RenderSettings::default() }
    }

    #[test]
    fn passes_add_up() {
        for samples in [1, 2, 3, 100, 4097] {
            let schedule = Schedule::new(&settings(samples, SamplerDesc::Sobol));
            let (mut done, mut passes) = (0, 0);
            while schedule.ended(done, Duration::ZERO, None).is_none() {
                done += schedule.next_pass(done, Duration::from_millis(u64::from(done) + 1), None);
                passes += 1;
            }
            assert_eq!(done, samples);
            assert!(passes < 30, "{samples} samples in {passes} passes");
        }
    }

    #[test]
    fn late_passes_end_at_the_last_sample() {
        for samples in [1 << 24, 1_000_000_007, MOST_SAMPLES] {
            let schedule = Schedule::new(&settings(samples, SamplerDesc::Sobol));
            assert_eq!(schedule.samples, samples);
            for (done, elapsed) in
                [(samples / 2 + 1, 0), (samples / 2 + 1, 1), (samples - 3, 1), (samples - 1, 1 << 40)]
            {
                let count = schedule.next_pass(done, Duration::from_millis(elapsed), None);
                assert!(count >= 1 && count <= samples - done, "{count} after {done} of {samples}");
                assert!(schedule.ended(done, Duration::ZERO, None).is_none());
            }
            assert_eq!(schedule.next_pass(samples - 3, Duration::from_millis(1), None), 3);
            assert_eq!(schedule.ended(samples, Duration::ZERO, None), Some(Ended::Samples));
        }
    }

    #[test]
    fn patterns_are_filled() {
        assert_eq!(total(&settings(50, SamplerDesc::Grid)), 64);
        assert_eq!(total(&settings(49, SamplerDesc::Jittered)), 49);
        assert_eq!(total(&settings(u32::MAX, SamplerDesc::Grid)), MOST_SAMPLES);
        assert_eq!(total(&settings(50, SamplerDesc::Sobol)), 50);
    }
}
