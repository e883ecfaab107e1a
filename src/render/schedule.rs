//! How many samples, in which passes, and when to decide. No result depends on passes.

use std::cell::Cell;
use std::time::Duration;

use super::adaptive::PILOT;
use super::report::{Ended, Progress};
use super::settings::RenderSettings;
use crate::desc::SamplerDesc;
use crate::film::{ErrorEstimate, ErrorMeasure, FEW_PIXELS, Image, REPLICATES};
use crate::sampling::square_side;

/// Samples per pixel that a render may reach, as many as a description may ask for: their indices stay far from wrapping
/// round.
pub const MOST_SAMPLES: u32 = 1 << 31;

/// A pass should not keep a viewer waiting longer than this.
const LONGEST_PASS: Duration = Duration::from_millis(500);

/// Samples per pixel before an error is believed: four for each replicate.
const LEAST_FOR_ERROR: u32 = 32;

/// The error has to be below what is aimed at by so many of its standard errors, or a render would end when its estimate
/// happens to be low: it is asked again and again, and the first yes counts. With twice as many, renders of which a few pixels
/// have most of the error would end at four fifths of what was aimed at.
const MARGIN: f64 = 0.25;

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
    target: Option<(ErrorMeasure, f64)>,
    /// Samples that steps between decisions are a multiple of.
    step: u32,
    is_adaptive: bool,
    /// At how many samples the error is expected to be what is aimed at, once there is an estimate.
    expected: Option<f64>,
    /// What share of the work comes before the first sample, and what part of that is done.
    pub(super) lead: f64,
    pub(super) prepared: Cell<f64>,
    /// The largest fraction reported: the expectation may change, and a report only goes forward.
    shown: Cell<f64>,
}

impl Schedule {
    /// `share`: samples that have one error.
    pub(super) fn new(settings: &RenderSettings, share: u32, is_adaptive: bool) -> Self {
        let target = settings.target_error.map(|target| (settings.error_measure, target));
        // Complete replicates tell most; where pixels differ in their samples, they care for that themselves.
        let step = if is_adaptive { 1 } else { share.saturating_mul(REPLICATES as u32) };
        Self {
            samples: total(settings),
            time_limit: settings.time_limit,
            target,
            step,
            is_adaptive,
            expected: None,
            lead: 0.0,
            prepared: Cell::new(0.0),
            shown: Cell::new(0.0),
        }
    }

    /// By what the error is measured that is aimed at, if any is, once there are enough samples to ask for it.
    pub(super) fn asks(&self, done: u32) -> Option<ErrorMeasure> {
        self.target.filter(|_| done >= LEAST_FOR_ERROR).map(|(measure, _)| measure)
    }

    /// What ends the render now, if anything does; `error`: the estimated one, where one is asked for.
    pub(super) fn ended(&self, done: u32, elapsed: Duration, error: Option<ErrorEstimate>) -> Option<Ended> {
        if done >= self.samples {
            return Some(Ended::Samples);
        }
        if self.time_limit.is_some_and(|limit| elapsed >= limit && done > 0) {
            return Some(Ended::Time);
        }
        let (error, (measure, target)) = error.zip(self.target)?;
        // An estimate that may be off by a larger share of what is aimed at rests on few pixels, as where rare bright paths have
        // met some: then others are still to be met, and the render goes on. With less, pixels at the edge of a lamp would keep
        // a render going for longer than its error asks for. A root is off by half as much of itself.
        let few = if measure == ErrorMeasure::Display { 0.5 * FEW_PIXELS } else { FEW_PIXELS };
        let is_reached = error.value + MARGIN * error.standard_error <= target && error.standard_error <= few * target;
        is_reached.then_some(Ended::Error)
    }

    /// At how many samples to decide next: whether the error is small enough, and where samples go. It depends on samples
    /// alone and never on time, so neither does the image of a render that no time limit cuts short.
    ///
    /// No more than twice as many as now; and where an error is aimed at, no further than it is expected to be reached, which
    /// reports go by from then on.
    pub(super) fn next_decision(&mut self, done: u32, error: Option<ErrorEstimate>) -> u32 {
        if self.target.is_none() && !self.is_adaptive {
            return self.samples;
        }
        let first = if self.is_adaptive { PILOT } else { LEAST_FOR_ERROR };
        let mut next = done.saturating_mul(2).max(first);
        if let Some(((measure, target), error)) = self.target.zip(error) {
            // Its margin falls with it.
            let ratio = (error.value + MARGIN * error.standard_error) / target;
            let ratio = if measure == ErrorMeasure::Display { ratio * ratio } else { ratio };
            self.expected = Some(f64::from(done) * ratio);
            // Not too many decisions where it falls more slowly.
            let expected = (f64::from(done) * ratio.max(1.0 + 1.0 / 16.0)).ceil() as u32;
            next = next.min(expected);
        }
        let steps = next.max(done.saturating_add(1)).div_ceil(self.step);
        steps.saturating_mul(self.step).min(self.samples)
    }

    /// Samples of the next pass, at most up to `decision`.
    ///
    /// Passes double, so that a first image is there soon, until one takes as long as a viewer should wait.
    pub(super) fn next_pass(&self, done: u32, elapsed: Duration, decision: u32) -> u32 {
        let affordable = if done == 0 || elapsed.is_zero() {
            1.0
        } else {
            f64::from(done) * LONGEST_PASS.as_secs_f64() / elapsed.as_secs_f64()
        };
        (affordable as u32).clamp(1, done.max(1)).min(decision - done)
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
        let by_error = self.expected.map_or(0.0, |expected| samples / expected.max(1.0));
        let sampled = (1.0 - self.lead) * by_samples.max(by_error);
        self.shown.set(by_time.max(self.lead * self.prepared.get() + sampled).clamp(self.shown.get(), 1.0));
        self.shown.get()
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
        assert_eq!(schedule.fraction(65.0, Duration::ZERO), 0.5, "forward only");
        assert_eq!(schedule.next_decision(960, error(0.0101, 0.0)), 1000);
        aimed.error_measure = ErrorMeasure::Display;
        assert_eq!(Schedule::new(&aimed, 1, true).next_decision(100, error(0.012, 0.0)), 144);

        assert_eq!((schedule.asks(31), schedule.asks(32)), (None, Some(ErrorMeasure::RelMse)));
        let ended = |value, standard_error| schedule.ended(64, Duration::ZERO, error(value, standard_error));
        assert_eq!(ended(0.009, 0.0005), Some(Ended::Error));
        assert_eq!(ended(0.0095, 0.0025), None, "it may be more");
        assert_eq!(ended(0.006, 0.0036), None, "few pixels have it all");
    }

    #[test]
    fn what_comes_before_the_first_sample_counts() {
        let mut schedule = Schedule::new(&settings(100, SamplerDesc::Sobol), 1, false);
        schedule.lead = 0.5;
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
