//! Work in pieces, done by the workers of a render, with a deadline and a progress callback.

use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::{Mutex, PoisonError};
use std::time::Instant;

use super::workers::{SharedWork, Workers};
use crate::control::{Cancel, PROGRESS_INTERVAL, Parallel};
use crate::error::{Error, ErrorKind, Result};

/// The workers of a render with one piece of work, which a cancel, a deadline or the progress callback may stop.
pub(crate) struct WorkerPool<'a> {
    pub workers: &'a Workers,
    pub cancel: &'a Cancel,
    /// The time at which the work is stopped.
    pub deadline: Option<Instant>,
    /// The progress callback. It is called on the calling thread with the fraction of the work that is done, and returns
    /// whether the work is to stop.
    pub callback: &'a mut dyn FnMut(f64) -> bool,
    /// Whether `callback` has stopped the work.
    pub is_stopped_by_callback: bool,
    /// The token for pieces that take long. It is cancelled as soon as the work is stopped for any reason.
    pub token: Cancel,
    /// Fraction of the work that is done.
    fraction: f64,
    /// The fraction at the last call of `callback`.
    reported: f64,
    /// Time of the last call of `callback`.
    last: Instant,
}

impl Workers {
    /// Calls `piece` with each number below `count` on at most `most` of the threads, and returns the results in the order of the
    /// numbers. Between two pieces the threads take turns with other work that they have.
    ///
    /// # Errors
    /// [`ErrorKind::Internal`] if `piece` panicked, [`ErrorKind::Unsupported`] for a pool of the process that this one was forked
    /// from.
    pub fn map<R, F>(&self, count: usize, most: usize, piece: F) -> Result<Vec<R>>
    where
        R: Send + 'static,
        F: Fn(usize) -> R + Send + Sync + 'static,
    {
        self.without_limit(&Cancel::new(), |pool| pool.map_on(most, count, piece))
    }

    /// Does work that no time limit ends and that reports no progress. `cancel` stops it.
    pub(crate) fn without_limit<R>(&self, cancel: &Cancel, work: impl FnOnce(&mut WorkerPool) -> R) -> R {
        work(&mut WorkerPool::new(self, cancel, None, &mut |_| false))
    }
}

/// The progress callback is called at once when the fraction that is done has grown by this much.
const STEP: f64 = 1.0 / 64.0;

impl<'a> WorkerPool<'a> {
    pub fn new(
        workers: &'a Workers,
        cancel: &'a Cancel,
        deadline: Option<Instant>,
        callback: &'a mut dyn FnMut(f64) -> bool,
    ) -> Self {
        let (token, last) = (cancel.part(), Instant::now());
        Self {
            workers,
            cancel,
            deadline,
            callback,
            is_stopped_by_callback: false,
            token,
            fraction: 0.0,
            reported: 0.0,
            last,
        }
    }

    /// Calls the progress callback, unless the callback has already stopped the work.
    fn report(&mut self) {
        if self.is_stopped_by_callback {
            return;
        }
        self.is_stopped_by_callback = (self.callback)(self.fraction);
        self.reported = self.fraction;
        self.last = Instant::now();
    }

    fn is_late(&self) -> bool {
        self.deadline.is_some_and(|deadline| Instant::now() >= deadline)
    }
}

impl Parallel for WorkerPool<'_> {
    fn check(&mut self) -> Result<()> {
        self.cancel.check()?;
        if self.last.elapsed() >= PROGRESS_INTERVAL {
            self.report();
        }
        if self.is_stopped_by_callback || self.is_late() { Err(stopped()) } else { Ok(()) }
    }

    fn token(&self) -> Cancel {
        self.token.clone()
    }

    fn progress(&mut self, fraction: f64) {
        self.fraction = fraction.clamp(self.fraction, 1.0);
        if self.fraction >= self.reported + STEP {
            self.report();
        }
    }

    fn map<R, F>(&mut self, count: usize, piece: F) -> Result<Vec<R>>
    where
        R: Send + 'static,
        F: Fn(usize) -> R + Send + Sync + 'static,
    {
        self.map_on(usize::MAX, count, piece)
    }
}

impl WorkerPool<'_> {
    /// [`Parallel::map`] on at most `most` threads.
    fn map_on<R, F>(&mut self, most: usize, count: usize, piece: F) -> Result<Vec<R>>
    where
        R: Send + 'static,
        F: Fn(usize) -> R + Send + Sync + 'static,
    {
        self.check()?;
        let pieces = Pieces {
            most,
            results: (0..count).map(|_| Mutex::new(None)).collect(),
            piece,
            next: AtomicUsize::new(0),
            done: AtomicUsize::new(0),
            stop: AtomicBool::new(false),
            cancel: self.cancel.clone(),
        };
        let workers = self.workers;
        let pieces = workers.run(pieces, &mut |pieces| {
            self.report();
            if self.is_stopped_by_callback || self.is_late() || self.cancel.is_cancelled() {
                self.token.cancel();
                pieces.abandon();
            }
        })?;
        let take = |result: &Mutex<Option<R>>| {
            let result = result.lock().unwrap_or_else(PoisonError::into_inner).take();
            result.ok_or_else(stopped)
        };
        pieces.results.iter().map(take).collect()
    }
}

fn stopped() -> Error {
    Error::new(ErrorKind::Cancelled, "stopped")
}

/// The pieces of one [`Parallel::map`] and their results.
struct Pieces<R, F> {
    /// Greatest number of threads.
    most: usize,
    results: Vec<Mutex<Option<R>>>,
    piece: F,
    next: AtomicUsize,
    done: AtomicUsize,
    stop: AtomicBool,
    cancel: Cancel,
}

impl<R, F> Pieces<R, F> {
    fn is_stopped(&self) -> bool {
        self.stop.load(Ordering::Relaxed) || self.cancel.is_cancelled()
    }
}

impl<R, F> SharedWork for Pieces<R, F>
where
    R: Send + 'static,
    F: Fn(usize) -> R + Send + Sync + 'static,
{
    fn take(&self, pause: &mut dyn FnMut() -> bool) -> bool {
        loop {
            if self.is_stopped() {
                return true;
            }
            if pause() {
                return false;
            }
            let number = self.next.fetch_add(1, Ordering::Relaxed);
            let Some(result) = self.results.get(number) else { return true };
            let value = (self.piece)(number);
            *result.lock().unwrap_or_else(PoisonError::into_inner) = Some(value);
            self.done.fetch_add(1, Ordering::Release);
        }
    }

    fn is_done(&self) -> bool {
        self.done.load(Ordering::Acquire) == self.results.len() || self.is_stopped()
    }

    fn abandon(&self) {
        self.stop.store(true, Ordering::Relaxed);
    }

    fn shares(&self) -> usize {
        self.results.len().min(self.most)
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;
    use std::time::Duration;

    use super::*;

    #[test]
    fn a_deadline_ends_work_between_its_pieces() {
        let (workers, cancel) = (Workers::calling_thread(), Cancel::new());
        let deadline = Instant::now().checked_add(Duration::from_millis(1));
        let mut callback = |_| false;
        let mut pool = WorkerPool::new(&workers, &cancel, deadline, &mut callback);
        let done = Arc::new(AtomicUsize::new(0));
        let pieces = Arc::clone(&done);
        let outcome = pool.map(1000, move |_| {
            pieces.fetch_add(1, Ordering::Relaxed);
            std::thread::sleep(PROGRESS_INTERVAL / 4);
        });
        assert_eq!(outcome.unwrap_err().kind(), ErrorKind::Cancelled);
        assert!(pool.token.is_cancelled(), "pieces under way hear of it");
        assert!(done.load(Ordering::Relaxed) < 10, "{done:?} pieces were done");
        assert_eq!(pool.check().unwrap_err().kind(), ErrorKind::Cancelled);
    }
}
