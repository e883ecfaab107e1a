//! How work is stopped from outside, and shared by threads.

use std::cmp::Ordering as Order;
use std::ops::{ControlFlow, Range};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

use crate::{Error, ErrorKind, Result};

/// Asks work to stop, from any thread. Clones are one and the same; once cancelled, it stays so.
#[derive(Clone, Debug, Default)]
pub struct Cancel(Arc<AtomicBool>);

impl Cancel {
    /// One that has not been cancelled.
    pub fn new() -> Self {
        Self::default()
    }

    /// Asks everything that holds it to stop soon.
    pub fn cancel(&self) {
        self.0.store(true, Ordering::Relaxed);
    }

    /// Whether it was cancelled.
    #[inline]
    pub fn is_cancelled(&self) -> bool {
        self.0.load(Ordering::Relaxed)
    }

    /// [`ErrorKind::Cancelled`] once it was cancelled.
    #[inline]
    pub fn check(&self) -> Result<()> {
        if self.is_cancelled() { Err(Error::new(ErrorKind::Cancelled, "cancelled")) } else { Ok(()) }
    }
}

/// How often work looks up: tells how far it is, and asks whether to go on.
pub(crate) const LOOK_UP: Duration = Duration::from_millis(100);

/// Items of a loop between two looks at the token or the clock: at most some hundred microseconds of any loop.
const BLOCK: usize = 1 << 12;

/// Most items that are sorted without a look at the clock.
const MOST_SORTED: usize = 1 << 18;

/// Growth of the share at which a report by steps is made, so that reports cost nothing.
const STEP: f64 = 1.0 / 512.0;

/// Told the share of the work that is done; `Break` stops the work.
pub(crate) type LookUp<'a> = &'a mut (dyn FnMut(f64) -> ControlFlow<()> + Send);

/// Work that one thread does: the token that stops it, and how far it is.
///
/// The work is a row of stages. Each stage is a share of the whole, and has a number of units of work.
pub(crate) struct WorkProgress<'a> {
    /// Stops the work.
    pub cancel: Cancel,
    /// Whether [`WorkProgress::check`] has to look at the clock.
    is_timed: bool,
    /// Whether there is anybody to report to.
    is_told: bool,
    state: Mutex<State<'a>>,
}

/// Whom work tells how far it is.
enum Report<'a> {
    /// Called every [`LOOK_UP`] and where a stage begins.
    ByTime(LookUp<'a>),
    /// Called when the share has grown by [`STEP`].
    BySteps(&'a (dyn Fn(f64) + Send + Sync)),
}

struct State<'a> {
    report: Option<Report<'a>>,
    /// Where the stage begins and ends, as shares of the whole.
    stage: [f64; 2],
    /// Units of the stage that are done.
    done: f64,
    /// All units of the stage.
    total: f64,
    /// The largest share that was reported by steps.
    told: f64,
    /// When it was reported by time.
    last: Instant,
}

impl State<'_> {
    /// Share of the whole that is done. A stage never counts for more than it has.
    fn share(&self) -> f64 {
        let [from, to] = self.stage;
        let part = if self.total > 0.0 { (self.done / self.total).min(1.0) } else { 0.0 };
        from + (to - from) * part
    }

    fn report_steps(&mut self) {
        if let Some(Report::BySteps(report)) = self.report {
            let share = self.share();
            if share >= self.told + STEP || (share == 1.0 && self.told < 1.0) {
                self.told = share;
                report(share);
            }
        }
    }
}

impl<'a> WorkProgress<'a> {
    /// Of work that `cancel` stops and that reports to nobody.
    pub fn new(cancel: &Cancel) -> Self {
        Self::with(cancel.clone(), None, [0.0; 2])
    }

    /// Of work that `look_up` stops; called about ten times a second and where a stage begins.
    pub fn by_time(look_up: LookUp<'a>) -> Self {
        Self::with(Cancel::new(), Some(Report::ByTime(look_up)), [0.0; 2])
    }

    /// Of work that `cancel` stops; `report` is called from one thread at a time when the share has grown. The work has one
    /// stage, whose units are told by [`WorkProgress::expect`].
    pub fn by_steps(cancel: &Cancel, report: Option<&'a (dyn Fn(f64) + Send + Sync)>) -> Self {
        Self::with(cancel.clone(), report.map(Report::BySteps), [0.0, 1.0])
    }

    fn with(cancel: Cancel, report: Option<Report<'a>>, stage: [f64; 2]) -> Self {
        let (is_timed, is_told) = (matches!(report, Some(Report::ByTime(_))), report.is_some());
        let state = State { report, stage, done: 0.0, total: 0.0, told: 0.0, last: Instant::now() };
        Self { cancel, is_timed, is_told, state: Mutex::new(state) }
    }

    fn state(&self) -> MutexGuard<'_, State<'a>> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Changes the state, then reports where that is a step. Under the lock: from one thread at a time.
    fn change(&self, change: impl FnOnce(&mut State)) {
        if self.is_told {
            let mut state = self.state();
            change(&mut state);
            state.report_steps();
        }
    }

    /// Begins the stage that follows: all up to `end` of the whole, in so many units.
    pub fn stage(&self, end: f64, units: usize) -> Result<()> {
        self.change(|state| {
            state.stage = [state.stage[1], end];
            (state.done, state.total) = (0.0, units.max(1) as f64);
        });
        self.look()
    }

    /// Announces units of the stage before any of them is done.
    pub fn expect(&self, units: f64) {
        self.change(|state| state.total += units);
    }

    /// Corrects what is left of the stage, now that it is known better.
    pub fn settle(&self, units: f64) {
        self.change(|state| state.total = state.done + units);
    }

    /// Counts units of the stage as done.
    pub fn spend(&self, units: usize) {
        self.change(|state| state.done += units as f64);
    }

    /// All is done.
    pub fn finish(&self) {
        self.change(|state| (state.done, state.total) = (1.0, 1.0));
    }

    /// [`ErrorKind::Cancelled`] once the work is not wanted any more.
    #[inline]
    pub fn check(&self) -> Result<()> {
        if self.is_timed { self.check_time() } else { self.cancel.check() }
    }

    fn check_time(&self) -> Result<()> {
        let is_due = self.state().last.elapsed() >= LOOK_UP;
        if is_due { self.look() } else { self.cancel.check() }
    }

    /// Reports by time, and asks whether to go on.
    fn look(&self) -> Result<()> {
        if self.is_timed {
            let mut state = self.state();
            let share = state.share();
            if let Some(Report::ByTime(look_up)) = &mut state.report
                && look_up(share).is_break()
            {
                self.cancel.cancel();
            }
            state.last = Instant::now();
        }
        self.cancel.check()
    }

    /// Runs `item` for every number below `count`, each for `cost` units, and checks in between.
    pub fn each(&self, count: usize, cost: f64, mut item: impl FnMut(usize)) -> Result<()> {
        for start in (0..count).step_by(BLOCK) {
            self.check()?;
            let end = count.min(start + BLOCK);
            (start..end).for_each(&mut item);
            self.change(|state| state.done += cost * (end - start) as f64);
        }
        self.cancel.check()
    }

    /// Runs `build` with a function that takes the fraction of it that is done, from any thread, and returns whether to go on.
    /// All of it counts for so many units.
    pub fn within<R>(&self, units: f64, build: impl FnOnce(&(dyn Fn(f64) -> bool + Sync)) -> Result<R>) -> Result<R> {
        let before = self.state().done;
        let result = build(&|fraction| {
            self.change(|state| state.done = state.done.max(before + fraction * units));
            !self.cancel.is_cancelled()
        })?;
        self.change(|state| state.done = before + units);
        Ok(result)
    }

    /// Sorts items of which no two are alike in this order, or are so in all else too.
    pub fn sort<T>(&self, items: &mut [T], order: &impl Fn(&T, &T) -> Order) -> Result<()> {
        self.check()?;
        if items.len() <= MOST_SORTED {
            items.sort_unstable_by(order);
            return Ok(());
        }
        // The lower half, then the upper one: a sort of all would not stop before it is done.
        let middle = items.len() / 2;
        let (low, _, high) = items.select_nth_unstable_by(middle, order);
        self.sort(low, order)?;
        self.sort(high, order)
    }
}

/// Threads that share work.
pub trait Parallel {
    /// Whether the work is still wanted; [`ErrorKind::Cancelled`] if not.
    ///
    /// # Errors
    /// See above.
    fn check(&mut self) -> Result<()>;

    /// Is told what share of the work is done, in [0, 1]; nobody else is, unless who implements this tells them.
    fn progress(&mut self, share: f64) {
        let _ = share;
    }

    /// What is cancelled when the work is no longer wanted, for pieces that take long; one that never is, unless who
    /// implements this has a better one.
    fn token(&self) -> Cancel {
        Cancel::new()
    }

    /// The values of `piece` for every number below `count`, in that order, from as many threads as there are.
    ///
    /// # Errors
    /// [`ErrorKind::Cancelled`] if it was stopped before all were there, [`ErrorKind::Internal`] if a piece panicked.
    fn map<R, F>(&mut self, count: usize, piece: F) -> Result<Vec<R>>
    where
        R: Send + 'static,
        F: Fn(usize) -> R + Send + Sync + 'static;
}

/// A part of some work: its shares are told as shares of the whole.
pub(crate) struct Part<'a, P> {
    whole: &'a mut P,
    from: f64,
    to: f64,
}

impl<'a, P: Parallel> Part<'a, P> {
    /// What lies between these shares of the whole.
    pub fn new(whole: &'a mut P, shares: Range<f64>) -> Self {
        Self { whole, from: shares.start, to: shares.end }
    }
}

impl<P: Parallel> Parallel for Part<'_, P> {
    fn check(&mut self) -> Result<()> {
        self.whole.check()
    }

    fn progress(&mut self, share: f64) {
        self.whole.progress(self.from + share.clamp(0.0, 1.0) * (self.to - self.from));
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

/// The calling thread alone.
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
    fn stages_make_a_share_of_the_whole() {
        let mut told = Vec::new();
        let mut look_up = |share| {
            told.push(share);
            if told.len() < 3 { ControlFlow::Continue(()) } else { ControlFlow::Break(()) }
        };
        let progress = WorkProgress::by_time(&mut look_up);
        progress.stage(0.5, 10).unwrap();
        progress.each(10, 1.0, |_| {}).unwrap();
        progress.stage(0.75, 4).unwrap();
        progress.spend(1);
        progress.state().last = Instant::now().checked_sub(LOOK_UP).unwrap();
        assert_eq!(progress.check().unwrap_err().kind(), ErrorKind::Cancelled);
        assert_eq!(progress.each(1, 1.0, |_| panic!("nobody wants it")).unwrap_err().kind(), ErrorKind::Cancelled);
        drop(progress);
        assert_eq!(told, [0.0, 0.5, 0.5625]);
    }

    #[test]
    fn steps_only_grow_and_end_with_all() {
        let told = Mutex::new(Vec::new());
        let report = |share| told.lock().unwrap().push(share);
        let cancel = Cancel::new();
        let progress = WorkProgress::by_steps(&cancel, Some(&report));
        progress.expect(100.0);
        progress.each(25, 1.0, |_| {}).unwrap();
        // More than was expected: the share falls, which is not told.
        progress.settle(275.0);
        let built = progress.within(200.0, |tell| {
            assert!(tell(0.5) && tell(0.25), "it goes on");
            cancel.cancel();
            assert!(!tell(1.0));
            Ok(7)
        });
        assert_eq!(built.unwrap(), 7);
        assert_eq!(progress.each(1, 1.0, |_| panic!("nobody wants it")).unwrap_err().kind(), ErrorKind::Cancelled);
        progress.finish();
        assert_eq!(*told.lock().unwrap(), [0.25, 125.0 / 300.0, 0.75, 1.0]);
    }

    #[test]
    fn large_lists_are_sorted_in_parts() {
        let mut items: Vec<u32> = (0..3 * MOST_SORTED as u32).map(|i| i.wrapping_mul(0x9e37_79b9) >> 12).collect();
        let mut sorted = items.clone();
        sorted.sort_unstable();
        WorkProgress::new(&Cancel::new()).sort(&mut items, &u32::cmp).unwrap();
        assert!(items == sorted);
        let cancelled = Cancel::new();
        cancelled.cancel();
        assert!(WorkProgress::new(&cancelled).sort(&mut items, &u32::cmp).is_err());
    }
}
