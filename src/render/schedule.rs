//! The number of samples of each pass, and the decisions between passes. The image does not depend on the passes.

use std::cell::Cell;
use std::time::Duration;

use super::adaptive::PILOT;
use super::report::{Ended, Progress};
use super::settings::RenderSettings;
use crate::desc::SamplerDesc;
use crate::film::{ErrorEstimate, ErrorMeasure, FEW_PIXELS, FilmOptions, Image, REPLICATES};
use crate::sampling::square_side;

/// Greatest number of samples per pixel of a render, which is also the greatest number in a description. Indices of samples
/// stay far from overflow.
pub const MOST_SAMPLES: u32 = 1 << 31;

/// Longest time that a pass is planned to take, so that viewers see new images often.
const LONGEST_PASS: Duration = Duration::from_millis(500);

/// Bytes that a network carries in a second (10 Gbit), and how many times as long as all pixels travel a pass is planned to take.
const BYTES_A_SECOND: f64 = 1.25e9;
const SENDING: f64 = 20.0;

/// Smallest number of samples per pixel with which an error estimate may end a render: four for each replicate.
const MIN_SAMPLES_FOR_ERROR: u32 = 32;

/// The estimated error must be below the target error by this many standard errors of the estimate. The estimate is compared
/// with the target again and again, and without a margin the render would end at the first estimate that is low by chance.
/// With twice this margin, renders in which few pixels have most of the error would end at four fifths of the target error.
const MARGIN: f64 = 0.25;

/// Greatest number of samples per pixel that a render with these settings takes.
fn total(settings: &RenderSettings) -> u32 {
    let samples = settings.desc.samples;
    match settings.desc.sampler {
        // Only a complete pattern covers the pixel evenly.
        SamplerDesc::Grid | SamplerDesc::Jittered => {
            let side = square_side(samples);
            side.saturating_mul(side).min(MOST_SAMPLES)
        }
        _ => samples.min(MOST_SAMPLES),
    }
}

/// The schedule of a render's passes.
#[derive(Clone, Debug)]
pub(super) struct Schedule {
    samples: u32,
    time_limit: Option<Duration>,
    target: Option<(ErrorMeasure, f64)>,
    /// Numbers of samples at decisions are multiples of this.
    step: u32,
    is_adaptive: bool,
    /// Number of samples at which the error is expected to reach the target error, once there is an estimate.
    expected: Option<f64>,
    /// Fraction of the render that preparation before the first sample counts for.
    pub(super) preparation: f64,
    /// Fraction of that preparation that is done.
    pub(super) prepared: Cell<f64>,
    /// Longest time that a pass is planned to take, and the greatest number of its samples over that of all before.
    longest_pass: Duration,
    growth: u32,
    /// The largest fraction that was reported. Reported fractions never fall, although the expected number of samples may
    /// rise.
    reported: Cell<f64>,
}

impl Schedule {
    /// Makes the schedule of a render. `share` is the number of consecutive samples whose errors are not independent, such
    /// as those with the same photon map.
    pub(super) fn new(settings: &RenderSettings, share: u32, is_adaptive: bool) -> Self {
        let target = settings.target_error.map(|target| (settings.error_measure, target));
        // Error estimates are best where all replicates have equally many samples. In adaptive renders, the goals of the
        // pixels provide for that.
        let step = if is_adaptive { 1 } else { share.saturating_mul(REPLICATES as u32) };
        Self {
            samples: total(settings),
            time_limit: settings.time_limit,
            target,
            step,
            is_adaptive,
            expected: None,
            preparation: 0.0,
            prepared: Cell::new(0.0),
            longest_pass: LONGEST_PASS,
            growth: 1,
            reported: Cell::new(0.0),
        }
    }

    /// Plans few passes, which are long beside the time that all pixels take to other processes and back.
    pub(super) fn send_pixels(&mut self, film: &FilmOptions) {
        let pixels: f64 = film.resolution.map(f64::from).iter().product();
        let there_and_back = 2.0 * pixels * film.bytes_of_a_pixel() as f64 / BYTES_A_SECOND;
        self.longest_pass += Duration::from_secs_f64(SENDING * there_and_back);
        self.growth = 7;
    }

    /// Sets the time limit of the samples, which leaves some of the render's to what follows them.
    pub(super) fn set_time_limit(&mut self, limit: Option<Duration>) {
        self.time_limit = limit;
    }

    /// Greatest number of samples per pixel.
    pub(super) fn total(&self) -> u32 {
        self.samples
    }

    /// The measure of the target error, if there is a target and there are enough samples for an estimate.
    pub(super) fn measure_to_estimate(&self, done: u32) -> Option<ErrorMeasure> {
        self.target.filter(|_| done >= MIN_SAMPLES_FOR_ERROR).map(|(measure, _)| measure)
    }

    /// The reason why the render ends now, or `None` if it continues. `error` is the current estimate, where there is a target
    /// error.
    pub(super) fn ended(&self, done: u32, elapsed: Duration, error: Option<ErrorEstimate>) -> Option<Ended> {
        if done >= self.samples {
            return Some(Ended::Samples);
        }
        if self.time_limit.is_some_and(|limit| elapsed >= limit && done > 0) {
            return Some(Ended::Time);
        }
        let (error, (measure, target)) = error.zip(self.target)?;
        // A standard error above this fraction of the target means that the estimate rests on few pixels, as where rare bright
        // paths have reached some pixels. Other pixels are then still to be reached, and the render continues. With a smaller
        // fraction, pixels at the edge of a lamp would prolong renders beyond need. The display error is a root, whose relative
        // error is half as large.
        let few = if measure == ErrorMeasure::Display { 0.5 * FEW_PIXELS } else { FEW_PIXELS };
        let is_reached = error.value + MARGIN * error.standard_error <= target && error.standard_error <= few * target;
        is_reached.then_some(Ended::Error)
    }

    /// The number of samples at which the next decision is made: whether the error is small enough, and which pixels get how
    /// many samples. The number depends on samples and never on time, so the image of a render without a time limit does not
    /// depend on time either.
    ///
    /// The number is at most twice the current one. With a target error, it is at most the number at which the target is
    /// expected to be reached. That expectation is stored, and later progress reports use it.
    pub(super) fn next_decision(&mut self, done: u32, error: Option<ErrorEstimate>) -> u32 {
        if self.target.is_none() && !self.is_adaptive {
            return self.samples;
        }
        let first = if self.is_adaptive { PILOT } else { MIN_SAMPLES_FOR_ERROR };
        let mut next = done.saturating_mul(2).max(first);
        if let Some(((measure, target), error)) = self.target.zip(error) {
            // The margin falls in proportion to the error.
            let ratio = (error.value + MARGIN * error.standard_error) / target;
            let ratio = if measure == ErrorMeasure::Display { ratio * ratio } else { ratio };
            self.expected = Some(f64::from(done) * ratio);
            // The smallest step limits the number of decisions where the error falls more slowly than expected.
            let expected = (f64::from(done) * ratio.max(1.0 + 1.0 / 16.0)).ceil() as u32;
            next = next.min(expected);
        }
        let steps = next.max(done.saturating_add(1)).div_ceil(self.step);
        steps.saturating_mul(self.step).min(self.samples)
    }

    /// Number of samples per pixel of the next pass, which ends at `decision` at the latest.
    ///
    /// The total doubles with each pass, or is eight times as large where pixels are sent to other processes, so that a first image is
    /// complete early, until a pass takes its longest time.
    pub(super) fn next_pass(&self, done: u32, elapsed: Duration, decision: u32) -> u32 {
        let affordable = if done == 0 || elapsed.is_zero() {
            1.0
        } else {
            // A pass that the time limit would cut leaves pixels with different numbers of samples.
            let left = self.time_limit.map_or(Duration::MAX, |limit| limit.saturating_sub(elapsed) / 2);
            let longest = self.longest_pass.min(left.max(LONGEST_PASS));
            f64::from(done) * longest.as_secs_f64() / elapsed.as_secs_f64()
        };
        (affordable as u32).clamp(1, done.max(1).saturating_mul(self.growth)).min(decision - done)
    }

    /// A progress report. `complete` is the number of complete samples per pixel, and `done` includes the samples of an
    /// unfinished pass.
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

    /// Fraction of the render that is done, by the limit that is nearest.
    fn fraction(&self, samples: f64, elapsed: Duration) -> f64 {
        let by_samples = samples / f64::from(self.samples);
        let by_time = self.time_limit.map_or(0.0, |limit| elapsed.as_secs_f64() / limit.as_secs_f64().max(1e-9));
        let by_error = self.expected.map_or(0.0, |expected| samples / expected.max(1.0));
        let sampled = (1.0 - self.preparation) * by_samples.max(by_error);
        let fraction = by_time.max(self.preparation * self.prepared.get() + sampled);
        self.reported.set(fraction.clamp(self.reported.get(), 1.0));
        self.reported.get()
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
            let schedule = Schedule::new(&settings(samples, SamplerDesc::Sobol), 1, false);
            let (mut done, mut passes) = (0, 0);
            while schedule.ended(done, Duration::ZERO, None).is_none() {
                done += schedule.next_pass(done, Duration::from_millis(u64::from(done) + 1), samples);
                passes += 1;
            }
            assert_eq!(done, samples);
            assert!(passes < 30, "{samples} samples in {passes} passes");
        }
    }

    #[test]
    fn pixels_that_are_sent_take_few_and_long_passes() {
        let film = FilmOptions {
            resolution: [3840, 2160],
            placement: None,
            auxiliary: true,
            light_parts: false,
            share: 1,
            weighted: false,
            gathering: false,
        };
        let mut sent = Schedule::new(&settings(1024, SamplerDesc::Sobol), 1, false);
        sent.send_pixels(&film);
        // 8.3 million pixels of 268 bytes, there and back, are 3.6 s at 1.25 GB/s.
        assert!((sent.longest_pass.as_secs_f64() - 0.5 - 20.0 * 3.556).abs() < 0.05, "{:?}", sent.longest_pass);
        let passes = |milliseconds_a_sample: u64| {
            let (mut done, mut passes) = (0, 0);
            while sent.ended(done, Duration::ZERO, None).is_none() {
                let elapsed = Duration::from_millis(u64::from(done) * milliseconds_a_sample);
                done += sent.next_pass(done, elapsed, 1024);
                passes += 1;
            }
            passes
        };
        // With many machines 1, 7, 56, 448 and 512 samples; with few as many as take 72 s.
        assert_eq!(passes(10), 5);
        assert_eq!(passes(10_000), 1 + 1024_u32.div_ceil(7));
        let timed =
            RenderSettings { time_limit: Some(Duration::from_secs(60)), ..settings(1 << 20, SamplerDesc::Sobol) };
        let mut timed = Schedule::new(&timed, 1, false);
        timed.send_pixels(&film);
        // At most half of the time that is left.
        assert_eq!(timed.next_pass(1000, Duration::from_secs(20), 1 << 20), 1000);
        assert_eq!(timed.next_pass(1000, Duration::from_secs(50), 1 << 20), 100);
        // What follows the samples has its part of the time.
        let ends_at = |timed: &Schedule, seconds| timed.ended(1000, Duration::from_secs(seconds), None).is_some();
        assert!(!ends_at(&timed, 59) && ends_at(&timed, 60));
        timed.set_time_limit(Some(Duration::from_secs(56)));
        assert!(!ends_at(&timed, 55) && ends_at(&timed, 56));
        assert_eq!(timed.next_pass(1000, Duration::from_secs(46), 1 << 20), 108);
    }

    #[test]
    fn late_passes_end_at_the_last_sample() {
        for samples in [1 << 24, 1_000_000_007, MOST_SAMPLES] {
            let schedule = Schedule::new(&settings(samples, SamplerDesc::Sobol), 1, false);
            assert_eq!(schedule.samples, samples);
            for (done, elapsed) in
                [(samples / 2 + 1, 0), (samples / 2 + 1, 1), (samples - 3, 1), (samples - 1, 1 << 40)]
            {
                let count = schedule.next_pass(done, Duration::from_millis(elapsed), samples);
                assert!(count >= 1 && count <= samples - done, "{count} after {done} of {samples}");
                assert!(schedule.ended(done, Duration::ZERO, None).is_none());
            }
            assert_eq!(schedule.next_pass(samples - 3, Duration::from_millis(1), samples), 3);
            assert_eq!(schedule.ended(samples, Duration::ZERO, None), Some(Ended::Samples));
        }
    }

    #[test]
    fn decisions_come_at_doublings_and_where_the_error_is_expected() {
        let mut aimed = settings(1000, SamplerDesc::Sobol);
        assert_eq!(Schedule::new(&aimed, 1, false).next_decision(0, None), 1000);
        let decisions = |mut schedule: Schedule| {
            let mut decisions = vec![schedule.next_decision(0, None)];
            while decisions[decisions.len() - 1] < 1000 {
                decisions.push(schedule.next_decision(decisions[decisions.len() - 1], None));
            }
            decisions
        };
        assert_eq!(decisions(Schedule::new(&aimed, 1, true)), [16, 32, 64, 128, 256, 512, 1000]);
        aimed.target_error = Some(0.01);
        assert_eq!(decisions(Schedule::new(&aimed, 4, false)), [32, 64, 128, 256, 512, 1000]);
        let mut schedule = Schedule::new(&aimed, 1, false);
        let error = |value, standard_error| Some(ErrorEstimate { value, standard_error });
        assert_eq!(schedule.next_decision(64, error(0.012, 0.002)), 80, "1.25 times as many, in whole steps");
        assert_eq!(schedule.fraction(40.0, Duration::ZERO), 40.0 / (64.0 * 1.25));
        assert_eq!(schedule.next_decision(64, error(0.5, 0.0)), 128);
        assert_eq!(schedule.fraction(65.0, Duration::ZERO), 0.5, "fractions never fall");
        assert_eq!(schedule.next_decision(960, error(0.0101, 0.0)), 1000);
        aimed.error_measure = ErrorMeasure::Display;
        assert_eq!(Schedule::new(&aimed, 1, true).next_decision(100, error(0.012, 0.0)), 144);

        let measures = [31, 32].map(|samples| schedule.measure_to_estimate(samples));
        assert_eq!(measures, [None, Some(ErrorMeasure::RelMse)]);
        let ended = |value, standard_error| schedule.ended(64, Duration::ZERO, error(value, standard_error));
        assert_eq!(ended(0.009, 0.0005), Some(Ended::Error));
        assert_eq!(ended(0.0095, 0.0025), None, "the margin is not kept");
        assert_eq!(ended(0.006, 0.0036), None, "few pixels have most of the error");
    }

    #[test]
    fn preparation_counts() {
        let mut schedule = Schedule::new(&settings(100, SamplerDesc::Sobol), 1, false);
        schedule.preparation = 0.5;
        assert_eq!(schedule.fraction(0.0, Duration::ZERO), 0.0);
        schedule.prepared.set(0.5);
        assert_eq!(schedule.fraction(0.0, Duration::ZERO), 0.25);
        schedule.prepared.set(1.0);
        assert_eq!(schedule.fraction(0.0, Duration::ZERO), 0.5);
        assert_eq!(schedule.fraction(50.0, Duration::ZERO), 0.75);
        assert_eq!(schedule.fraction(100.0, Duration::ZERO), 1.0);
    }

    #[test]
    fn patterns_are_filled() {
        assert_eq!(total(&settings(50, SamplerDesc::Grid)), 64);
        assert_eq!(total(&settings(49, SamplerDesc::Jittered)), 49);
        assert_eq!(total(&settings(u32::MAX, SamplerDesc::Grid)), MOST_SAMPLES);
        assert_eq!(total(&settings(50, SamplerDesc::Sobol)), 50);
    }
}
