//! Cancelling, progress reports, and the interface to threads that share work.

use std::cmp::Ordering as Order;
use std::ops::{ControlFlow, Range};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

use crate::{Error, ErrorKind, Result};

/// A token that asks work to stop, from any thread. All clones of a token share one state. A cancelled token stays
/// cancelled.
#[derive(Clone, Debug, Default)]
pub struct Cancel {
    own: Arc<AtomicBool>,
    /// The token of which this one is a part.
    whole: Option<Arc<AtomicBool>>,
}

impl Cancel {
    /// Makes a token that is not cancelled.
    pub fn new() -> Self {
        Self::default()
    }

    /// Asks all work that holds this token to stop soon.
    pub fn cancel(&self) {
        self.own.store(true, Ordering::Relaxed);
    }

    /// A token for a part of the work: it is cancelled with this one, and may be cancelled alone.
    pub(crate) fn part(&self) -> Self {
        debug_assert!(self.whole.is_none(), "a token knows one other");
        Self { own: Arc::default(), whole: Some(Arc::clone(&self.own)) }
    }

    /// Whether the token was cancelled.
    #[inline]
    pub fn is_cancelled(&self) -> bool {
        self.own.load(Ordering::Relaxed) || self.whole.as_ref().is_some_and(|whole| whole.load(Ordering::Relaxed))
    }

    /// Returns [`ErrorKind::Cancelled`] once the token was cancelled.
    #[inline]
    pub fn check(&self) -> Result<()> {
        if self.is_cancelled() { Err(Error::new(ErrorKind::Cancelled, "cancelled")) } else { Ok(()) }
    }
}

/// Time between two calls of a progress callback.
pub(crate) const PROGRESS_INTERVAL: Duration = Duration::from_millis(100);

/// Number of items of a loop between two checks of the token or the clock. They take at most some hundred microseconds in
/// any loop.
const BLOCK: usize = 1 << 12;

/// Greatest number of items that are sorted without a check of the clock.
const MAX_SORTED: usize = 1 << 18;

/// A report by steps is made when the fraction that is done has grown by this much, so that reports cost nothing.
const STEP: f64 = 1.0 / 512.0;

/// A progress callback. Its argument is the fraction of the work that is done; its answer `Break` stops the work.
pub(crate) type ProgressCallback<'a> = &'a mut (dyn FnMut(f64) -> ControlFlow<()> + Send);

/// A callback that receives the fraction of the work that is done, which only grows, from one thread at a time.
pub(crate) type StepsCallback = Arc<dyn Fn(f64) + Send + Sync>;

/// Progress and cancelling of work that one thread does.
///
/// The work is a sequence of stages. Each stage is a fraction of the whole work and has a number of units of work.
pub(crate) struct WorkProgress<'a> {
    /// The token that stops the work.
    pub cancel: Cancel,
    /// Whether [`WorkProgress::check`] reads the clock.
    is_timed: bool,
    /// Whether progress is reported at all.
    is_reported: bool,
    state: Mutex<ProgressState<'a>>,
}

/// The callback that progress is reported to.
enum Report<'a> {
    /// The callback is called every [`PROGRESS_INTERVAL`] and where a stage begins.
    ByTime(ProgressCallback<'a>),
    /// The callback is called when the fraction that is done has grown by [`STEP`].
    BySteps(StepsCallback),
}

struct ProgressState<'a> {
    report: Option<Report<'a>>,
    /// Begin and end of the stage, as fractions of the whole work.
    stage: [f64; 2],
    /// Number of units of the stage that are done.
    done: f64,
    /// Number of units of the stage.
    total: f64,
    /// Whether all work is done.
    is_finished: bool,
    /// The largest fraction that was reported by steps.
    reported: f64,
    /// The fraction at the last report by steps, or a smaller one since, where there was more work than expected.
    seen: f64,
    /// Time of the last report by time.
    last: Instant,
}

impl ProgressState<'_> {
    /// Fraction of the whole work that is done. A stage never counts for more than its own fraction.
    fn fraction(&self) -> f64 {
        let [from, to] = self.stage;
        let part = if self.total > 0.0 { (self.done / self.total).min(1.0) } else { 0.0 };
        from + (to - from) * part
    }

    fn report_steps(&mut self) {
        if let Some(Report::BySteps(report)) = &self.report {
            // Where there is more work than was expected, the fraction falls. The last one is reported again as the work goes on, so that
            // the callback can always stop it. What was not expected may still be to come, so only the end is told as 1.
            let fraction = if self.is_finished { 1.0 } else { self.fraction().min(1.0 - STEP) };
            self.seen = self.seen.min(fraction);
            if fraction >= self.seen + STEP || (fraction == 1.0 && self.reported < 1.0) {
                (self.seen, self.reported) = (fraction, self.reported.max(fraction));
                report(self.reported);
            }
        }
    }
}

impl<'a> WorkProgress<'a> {
    /// For work that `cancel` stops and whose progress is not reported.
    pub fn new(cancel: &Cancel) -> Self {
        Self::with(cancel.clone(), None, [0.0; 2])
    }

    /// For work that `callback` stops. The callback is called about ten times a second and where a stage begins.
    pub fn by_time(callback: ProgressCallback<'a>) -> Self {
        Self::with(Cancel::new(), Some(Report::ByTime(callback)), [0.0; 2])
    }

    /// For work that `cancel` stops. `report` is called, from one thread at a time, when the fraction that is done has
    /// grown. The work has one stage, whose units [`WorkProgress::expect`] announces.
    pub fn by_steps(cancel: &Cancel, report: Option<StepsCallback>) -> Self {
        Self::with(cancel.clone(), report.map(Report::BySteps), [0.0, 1.0])
    }

    fn with(cancel: Cancel, report: Option<Report<'a>>, stage: [f64; 2]) -> Self {
        let (is_timed, is_reported) = (matches!(report, Some(Report::ByTime(_))), report.is_some());
        let state = ProgressState {
            report,
            stage,
            done: 0.0,
            total: 0.0,
            is_finished: false,
            reported: 0.0,
            seen: 0.0,
            last: Instant::now(),
        };
        Self { cancel, is_timed, is_reported, state: Mutex::new(state) }
    }

    fn state(&self) -> MutexGuard<'_, ProgressState<'a>> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Changes the state, and makes the report by steps if one is due. The lock is held, so reports come from one thread
    /// at a time.
    fn change(&self, change: impl FnOnce(&mut ProgressState)) {
        if self.is_reported {
            let mut state = self.state();
            change(&mut state);
            state.report_steps();
        }
    }

    /// Whether anybody is told of the progress.
    pub fn is_reported(&self) -> bool {
        self.is_reported
    }

    /// Begins the next stage, which ends at the fraction `end` of the whole work and has `units` units.
    ///
    /// # Errors
    /// [`ErrorKind::Cancelled`] if the work was stopped.
    pub fn stage(&self, end: f64, units: usize) -> Result<()> {
        self.change(|state| {
            state.stage = [state.stage[1], end];
            (state.done, state.total) = (0.0, units.max(1) as f64);
        });
        self.report_time()
    }

    /// Adds units to the stage, before any of them is done.
    pub fn expect(&self, units: f64) {
        self.change(|state| state.total += units);
    }

    /// Sets the number of units of the stage that are still to be done.
    pub fn settle(&self, units: f64) {
        self.change(|state| state.total = state.done + units);
    }

    /// Counts units of the stage as done.
    pub fn spend(&self, units: usize) {
        self.change(|state| state.done += units as f64);
    }

    /// Marks all work as done.
    pub fn finish(&self) {
        self.change(|state| (state.done, state.total, state.is_finished) = (1.0, 1.0, true));
    }

    /// Returns [`ErrorKind::Cancelled`] once the work was stopped.
    #[inline]
    pub fn check(&self) -> Result<()> {
        if self.is_timed { self.check_time() } else { self.cancel.check() }
    }

    fn check_time(&self) -> Result<()> {
        let is_due = self.state().last.elapsed() >= PROGRESS_INTERVAL;
        if is_due { self.report_time() } else { self.cancel.check() }
    }

    /// Calls the callback of reports by time, which may stop the work.
    fn report_time(&self) -> Result<()> {
        if self.is_timed {
            let mut state = self.state();
            let fraction = state.fraction();
            if let Some(Report::ByTime(callback)) = &mut state.report
                && callback(fraction).is_break()
            {
                self.cancel.cancel();
            }
            state.last = Instant::now();
        }
        self.cancel.check()
    }

    /// Runs `item` for every number below `count` and checks in between whether the work was stopped. Each item counts for
    /// `cost` units.
    pub fn each(&self, count: usize, cost: f64, mut item: impl FnMut(usize)) -> Result<()> {
        for start in (0..count).step_by(BLOCK) {
            self.check()?;
            let end = count.min(start + BLOCK);
            (start..end).for_each(&mut item);
            self.change(|state| state.done += cost * (end - start) as f64);
        }
        self.cancel.check()
    }

    /// Runs `build`, which counts for `units` units as a whole. The argument of `build` is a function that any thread may
    /// call with the fraction of `build` that is done; that function returns whether `build` is to go on.
    pub fn within<R>(&self, units: f64, build: impl FnOnce(&(dyn Fn(f64) -> bool + Sync)) -> Result<R>) -> Result<R> {
        let before = self.state().done;
        let result = build(&|fraction| {
            self.change(|state| state.done = state.done.max(before + fraction * units));
            !self.cancel.is_cancelled()
        })?;
        self.change(|state| state.done = before + units);
        Ok(result)
    }

    /// Sorts items. Items that compare as equal in this order must be equal altogether, because the sort is not stable.
    pub fn sort<T>(&self, items: &mut [T], order: &impl Fn(&T, &T) -> Order) -> Result<()> {
        self.check()?;
        if items.len() <= MAX_SORTED {
            items.sort_unstable_by(order);
            return Ok(());
        }
        // The halves are sorted one after the other, because one sort of all items could not be stopped.
        let middle = items.len() / 2;
        let (low, _, high) = items.select_nth_unstable_by(middle, order);
        self.sort(low, order)?;
        self.sort(high, order)
    }
}

/// Threads that share work.
pub trait Parallel {
    /// Checks whether the work is to go on.
    ///
    /// # Errors
    /// [`ErrorKind::Cancelled`] once the work was stopped.
    fn check(&mut self) -> Result<()>;

    /// Receives the fraction of the work that is done, in [0, 1]. The default implementation ignores it.
    fn progress(&mut self, fraction: f64) {
        let _ = fraction;
    }

    /// A token that is cancelled when the work is stopped, for pieces that take long. The default implementation returns a
    /// token that is never cancelled.
    fn token(&self) -> Cancel {
        Cancel::new()
    }

    /// Calls `piece` for every number below `count`, on all threads, and returns the values in the order of the numbers.
    ///
    /// # Errors
    /// [`ErrorKind::Cancelled`] if the work was stopped before all values were computed, [`ErrorKind::Internal`] if a piece
    /// panicked.
    fn map<R, F>(&mut self, count: usize, piece: F) -> Result<Vec<R>>
    where
        R: Send + 'static,
        F: Fn(usize) -> R + Send + Sync + 'static;
}

/// A part of some work. Progress of the part is passed on as progress of the whole work.
pub(crate) struct Part<'a, P> {
    whole: &'a mut P,
    from: f64,
    to: f64,
}

impl<'a, P: Parallel> Part<'a, P> {
    /// The part between two fractions of the whole work.
    pub fn new(whole: &'a mut P, fractions: Range<f64>) -> Self {
        Self { whole, from: fractions.start, to: fractions.end }
    }
}

impl<P: Parallel> Parallel for Part<'_, P> {
    fn check(&mut self) -> Result<()> {
        self.whole.check()
    }

    fn progress(&mut self, fraction: f64) {
        self.whole.progress(self.from + fraction.clamp(0.0, 1.0) * (self.to - self.from));
    }

    fn token(&self) -> Cancel {
        self.whole.token()
    }

    fn map<R, F>(&mut self, count: usize, piece: F) -> Result<Vec<R>>
    where
        R: Send + 'static,
        F: Fn(usize) -> R + Send + Sync + 'static,
    {
        self.whole.map(count, piece)
    }
}

/// Work on the calling thread alone. The token stops the work.
#[derive(Clone, Debug, Default)]
pub struct Alone(pub Cancel);

impl Parallel for Alone {
    fn check(&mut self) -> Result<()> {
        self.0.check()
    }

    fn token(&self) -> Cancel {
        self.0.clone()
    }

    fn map<R, F>(&mut self, count: usize, piece: F) -> Result<Vec<R>>
    where
        R: Send + 'static,
        F: Fn(usize) -> R + Send + Sync + 'static,
    {
        let one = |number| self.0.check().map(|()| piece(number));
        (0..count).map(one).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn stages_make_a_fraction_of_the_whole() {
        let mut reported = Vec::new();
        let mut callback = |fraction| {
            reported.push(fraction);
            if reported.len() < 3 { ControlFlow::Continue(()) } else { ControlFlow::Break(()) }
        };
        let progress = WorkProgress::by_time(&mut callback);
        progress.stage(0.5, 10).unwrap();
        progress.each(10, 1.0, |_| {}).unwrap();
        progress.stage(0.75, 4).unwrap();
        progress.spend(1);
        progress.state().last = Instant::now().checked_sub(PROGRESS_INTERVAL).unwrap();
        assert_eq!(progress.check().unwrap_err().kind(), ErrorKind::Cancelled);
        assert_eq!(progress.each(1, 1.0, |_| panic!("the work was stopped")).unwrap_err().kind(), ErrorKind::Cancelled);
        drop(progress);
        assert_eq!(reported, [0.0, 0.5, 0.5625]);
    }

    #[test]
    fn steps_only_grow_and_end_with_all() {
        let reported = Arc::new(Mutex::new(Vec::new()));
        let list = Arc::clone(&reported);
        let cancel = Cancel::new();
        let progress =
            WorkProgress::by_steps(&cancel, Some(Arc::new(move |fraction| list.lock().unwrap().push(fraction))));
        progress.expect(100.0);
        progress.each(25, 1.0, |_| {}).unwrap();
        // There is more work than was expected: the fraction falls, and is not reported.
        progress.settle(275.0);
        let built = progress.within(200.0, |tell| {
            assert!(tell(0.5) && tell(0.25), "it goes on");
            cancel.cancel();
            assert!(!tell(1.0));
            Ok(7)
        });
        assert_eq!(built.unwrap(), 7);
        assert_eq!(progress.each(1, 1.0, |_| panic!("the work was stopped")).unwrap_err().kind(), ErrorKind::Cancelled);
        progress.finish();
        assert_eq!(*reported.lock().unwrap(), [0.25, 125.0 / 300.0, 0.75, 1.0]);
    }

    #[test]
    fn large_lists_are_sorted_in_parts() {
        let mut items: Vec<u32> = (0..3 * MAX_SORTED as u32).map(|i| i.wrapping_mul(0x9e37_79b9) >> 12).collect();
        let mut sorted = items.clone();
        sorted.sort_unstable();
        WorkProgress::new(&Cancel::new()).sort(&mut items, &u32::cmp).unwrap();
        assert!(items == sorted);
        let cancelled = Cancel::new();
        cancelled.cancel();
        assert!(WorkProgress::new(&cancelled).sort(&mut items, &u32::cmp).is_err());
    }
}
