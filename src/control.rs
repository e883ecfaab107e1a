//! How work is stopped from outside, and shared by threads.

use std::cell::{Cell, RefCell};
use std::cmp::Ordering as Order;
use std::ops::{ControlFlow, Range};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
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

/// How often whoever works looks up.
pub(crate) const LOOK_UP: Duration = Duration::from_millis(100);

/// Items of a loop between two looks at the clock.
const BLOCK: usize = 1 << 12;

/// Most items that are sorted without a look at the clock.
const MOST_SORTED: usize = 1 << 18;

/// Asked whether to go on, and told what share of the work is done.
pub(crate) type LookUp<'a> = &'a mut dyn FnMut(f64) -> ControlFlow<()>;

/// Work of one thread: whether it is still wanted, and how far it is.
///
/// It is a row of stages. Each is a share of the whole, and so many units of work.
pub(crate) struct Watch<'a> {
    cancel: Cancel,
    look_up: Option<RefCell<LookUp<'a>>>,
    last: Cell<Instant>,
    /// Where the stage begins and ends, as shares of the whole.
    stage: Cell<[f64; 2]>,
    /// Units of the stage, and how many of them are done.
    units: Cell<[f64; 2]>,
}

impl<'a> Watch<'a> {
    /// Of work that this stops, and that nobody is told of.
    pub fn new(cancel: &Cancel) -> Self {
        Self::with(cancel.clone(), None)
    }

    /// Of work that `look_up` stops; asked about ten times a second and where a stage begins.
    pub fn telling(look_up: LookUp<'a>) -> Self {
        Self::with(Cancel::new(), Some(RefCell::new(look_up)))
    }

    fn with(cancel: Cancel, look_up: Option<RefCell<LookUp<'a>>>) -> Self {
        Self {
            cancel,
            look_up,
            last: Cell::new(Instant::now()),
            stage: Cell::new([0.0; 2]),
            units: Cell::new([0.0, 1.0]),
        }
    }

    /// Begins the stage that follows: all up to `end` of the whole, in so many units.
    pub fn stage(&self, end: f64, units: usize) -> Result<()> {
        self.stage.set([self.stage.get()[1], end]);
        self.units.set([0.0, units.max(1) as f64]);
        self.look()
    }

    /// Counts units of the stage as done. Nobody is told of more than it has.
    #[inline]
    pub fn spend(&self, units: usize) {
        let [done, all] = self.units.get();
        self.units.set([(done + units as f64).min(all), all]);
    }

    /// [`ErrorKind::Cancelled`] once it is not wanted any more.
    #[inline]
    pub fn check(&self) -> Result<()> {
        if self.look_up.is_some() && self.last.get().elapsed() >= LOOK_UP { self.look() } else { self.cancel.check() }
    }

    fn look(&self) -> Result<()> {
        if let Some(look_up) = &self.look_up {
            let ([from, to], [done, all]) = (self.stage.get(), self.units.get());
            if (look_up.borrow_mut())(from + (to - from) * done / all).is_break() {
                self.cancel.cancel();
            }
            self.last.set(Instant::now());
        }
        self.cancel.check()
    }

    /// Runs `item` for every number below `count`, a unit each.
    pub fn each(&self, count: usize, mut item: impl FnMut(usize)) -> Result<()> {
        for start in (0..count).step_by(BLOCK) {
            self.check()?;
            let end = count.min(start + BLOCK);
            (start..end).for_each(&mut item);
            self.spend(end - start);
        }
        Ok(())
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
        let watch = Watch::telling(&mut look_up);
        watch.stage(0.5, 10).unwrap();
        watch.each(10, |_| {}).unwrap();
        watch.stage(0.75, 4).unwrap();
        watch.spend(1);
        watch.last.set(Instant::now().checked_sub(LOOK_UP).unwrap());
        assert_eq!(watch.check().unwrap_err().kind(), ErrorKind::Cancelled);
        assert_eq!(watch.each(1, |_| panic!("nobody wants it")).unwrap_err().kind(), ErrorKind::Cancelled);
        drop(watch);
        assert_eq!(told, [0.0, 0.5, 0.5625]);
    }

    #[test]
    fn large_lists_are_sorted_in_parts() {
        let mut items: Vec<u32> = (0..3 * MOST_SORTED as u32).map(|i| i.wrapping_mul(0x9e37_79b9) >> 12).collect();
        let mut sorted = items.clone();
        sorted.sort_unstable();
        Watch::new(&Cancel::new()).sort(&mut items, &u32::cmp).unwrap();
        assert!(items == sorted);
        let cancelled = Cancel::new();
        cancelled.cancel();
        assert!(Watch::new(&cancelled).sort(&mut items, &u32::cmp).is_err());
    }
}
