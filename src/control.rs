//! How work is stopped from outside, and shared by threads.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

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

/// Threads that share work.
pub trait Parallel {
    /// Whether the work is still wanted; [`ErrorKind::Cancelled`] if not.
    ///
    /// # Errors
    /// See above.
    fn check(&self) -> Result<()>;

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

/// The calling thread alone.
#[derive(Clone, Debug, Default)]
pub struct Alone(pub Cancel);

impl Parallel for Alone {
    fn check(&self) -> Result<()> {
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
