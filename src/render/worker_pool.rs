//! Work of equal pieces, done by the workers of a render.

use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::{Mutex, PoisonError};
use std::time::Instant;

use super::workers::{SharedWork, Workers};
use crate::control::{Cancel, LOOK_UP, Parallel};
use crate::error::{Error, ErrorKind, Result};

/// The workers of a render at one piece of work, until it is stopped: by a cancel, by its deadline, or by who is told of its progress.
pub(crate) struct WorkerPool<'a> {
    pub workers: &'a Workers,
    pub cancel: &'a Cancel,
    /// When time is up.
    pub deadline: Option<Instant>,
    /// Called now and then on the calling thread with the share of the work that is done; returns whether to stop.
    pub look_up: &'a mut dyn FnMut(f64) -> bool,
    /// Whether `look_up` returned that the work is to stop.
    pub is_broken_off: bool,
    /// For pieces that take long: cancelled as soon as the work is to stop for any of these reasons.
    pub token: Cancel,
    /// What share of the work is done, and what it was when `look_up` was called last.
    share: f64,
    told: f64,
    /// When `look_up` was called last.
    last: Instant,
}

/// `look_up` is called at once when the share has grown by this much.
const NEWS: f64 = 1.0 / 64.0;

impl<'a> WorkerPool<'a> {
    pub fn new(
        workers: &'a Workers,
        cancel: &'a Cancel,
        deadline: Option<Instant>,
        look_up: &'a mut dyn FnMut(f64) -> bool,
    ) -> Self {
        let (token, last) = (Cancel::new(), Instant::now());
        Self { workers, cancel, deadline, look_up, is_broken_off: false, token, share: 0.0, told: 0.0, last }
    }

    fn look(&mut self) {
        // It is not called again once it has stopped the work.
        if self.is_broken_off {
            return;
        }
        self.is_broken_off = (self.look_up)(self.share);
        self.told = self.share;
        self.last = Instant::now();
    }

    fn is_late(&self) -> bool {
        self.deadline.is_some_and(|deadline| Instant::now() >= deadline)
    }
}

impl Parallel for WorkerPool<'_> {
    fn check(&mut self) -> Result<()> {
        self.cancel.check()?;
        if self.last.elapsed() >= LOOK_UP {
            self.look();
        }
        if self.is_broken_off || self.is_late() { Err(stopped()) } else { Ok(()) }
    }

    fn token(&self) -> Cancel {
        self.token.clone()
    }

    fn progress(&mut self, share: f64) {
        self.share = share.clamp(self.share, 1.0);
        if self.share >= self.told + NEWS {
            self.look();
        }
    }

    fn map<R, F>(&mut self, count: usize, piece: F) -> Result<Vec<R>>
    where
        R: Send + 'static,
        F: Fn(usize) -> R + Send + Sync + 'static,
    {
        self.check()?;
        let pieces = Pieces {
            results: (0..count).map(|_| Mutex::new(None)).collect(),
            piece,
            next: AtomicUsize::new(0),
            done: AtomicUsize::new(0),
            stop: AtomicBool::new(false),
            cancel: self.cancel.clone(),
        };
        let workers = self.workers;
        let pieces = workers.run(pieces, &mut |pieces| {
            self.look();
            if self.is_broken_off || self.is_late() || self.cancel.is_cancelled() {
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

struct Pieces<R, F> {
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
        self.results.len()
    }
}
