//! Work of equal pieces, done by whoever renders.

use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::{Mutex, PoisonError};
use std::time::Instant;

use super::workers::{Work, Workers};
use crate::control::{Cancel, Parallel};
use crate::error::{Error, ErrorKind, Result};

/// The workers of a render, until somebody stops them.
pub(crate) struct Crew<'a> {
    pub workers: &'a Workers,
    pub cancel: &'a Cancel,
    /// When time is up.
    pub deadline: Option<Instant>,
    /// Asked now and then on the calling thread: whether to stop.
    pub look_up: &'a mut dyn FnMut() -> bool,
    /// Whether it was answered so.
    pub is_broken_off: bool,
    /// For pieces that take long: cancelled with the first of all these.
    pub token: Cancel,
}

impl Crew<'_> {
    fn is_late(&self) -> bool {
        self.deadline.is_some_and(|deadline| Instant::now() >= deadline)
    }
}

impl Parallel for Crew<'_> {
    fn check(&self) -> Result<()> {
        self.cancel.check()?;
        if self.is_broken_off || self.is_late() { Err(stopped()) } else { Ok(()) }
    }

    fn token(&self) -> Cancel {
        self.token.clone()
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
        let (deadline, look_up, is_broken_off) = (self.deadline, &mut *self.look_up, &mut self.is_broken_off);
        let (cancel, token) = (self.cancel, &self.token);
        let pieces = self.workers.run(pieces, &mut |pieces| {
            *is_broken_off |= look_up();
            let is_late = deadline.is_some_and(|deadline| Instant::now() >= deadline);
            if *is_broken_off || is_late || cancel.is_cancelled() {
                token.cancel();
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

impl<R, F> Work for Pieces<R, F>
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
