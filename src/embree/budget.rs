//! A memory allowance that several devices and other users share.

use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};

use crate::{Error, ErrorKind, Result};

/// A shared allowance of bytes, for the devices that were created with it ([`super::DeviceOptions::budget`]), for the
/// geometry of the scenes built with them, and for anything else that charges it. Clones are the same allowance. It may
/// be used from any thread.
#[derive(Clone, Debug)]
pub struct MemoryBudget(Arc<BudgetCounter>);

#[derive(Debug)]
struct BudgetCounter {
    limit: usize,
    used: AtomicUsize,
    peak: AtomicUsize,
}

impl MemoryBudget {
    /// An allowance of `limit` bytes, none of them used; `usize::MAX` only counts.
    pub fn new(limit: usize) -> Self {
        Self(Arc::new(BudgetCounter { limit, used: AtomicUsize::new(0), peak: AtomicUsize::new(0) }))
    }

    /// The allowance, in bytes.
    pub fn limit(&self) -> usize {
        self.0.limit
    }

    /// Bytes in use now. They may exceed the limit for a moment, because Embree reports some memory only after it was
    /// allocated.
    pub fn used(&self) -> usize {
        self.0.used.load(Ordering::Relaxed)
    }

    /// The most bytes that were ever in use at the same time.
    pub fn peak(&self) -> usize {
        self.0.peak.load(Ordering::Relaxed)
    }

    /// Takes `bytes` until the charge is dropped.
    ///
    /// # Errors
    /// [`ErrorKind::OutOfMemory`] if fewer are left; nothing is taken then.
    pub fn try_charge(&self, bytes: usize) -> Result<Charge> {
        if self.try_take(bytes) {
            return Ok(Charge { budget: self.clone(), bytes });
        }
        Err(self.exceeded(bytes))
    }

    /// The error where `bytes` more are not left.
    fn exceeded(&self, bytes: usize) -> Error {
        let message = format!("{bytes} bytes more are past the limit of {}: {} are in use", self.limit(), self.used());
        Error::new(ErrorKind::OutOfMemory, message)
    }

    /// Takes `bytes` if that many are left.
    pub(super) fn try_take(&self, bytes: usize) -> bool {
        let within = |used: usize| used.checked_add(bytes).filter(|&sum| sum <= self.0.limit);
        let taken = self.0.used.fetch_update(Ordering::Relaxed, Ordering::Relaxed, within);
        match taken {
            Ok(before) => {
                self.0.peak.fetch_max(before + bytes, Ordering::Relaxed);
                true
            }
            Err(_) => false,
        }
    }

    /// Takes `bytes` that are already in use, whatever the limit is; returns whether the limit still holds.
    pub(super) fn force_take(&self, bytes: usize) -> bool {
        let now = self.0.used.fetch_add(bytes, Ordering::Relaxed).saturating_add(bytes);
        self.0.peak.fetch_max(now, Ordering::Relaxed);
        now <= self.0.limit
    }

    pub(super) fn release(&self, bytes: usize) {
        self.0.used.fetch_sub(bytes, Ordering::Relaxed);
    }
}

impl PartialEq for MemoryBudget {
    /// Whether both are the same allowance, not whether their values are equal.
    fn eq(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.0, &other.0)
    }
}

impl Eq for MemoryBudget {}

/// Bytes taken from a [`MemoryBudget`], given back when dropped.
#[derive(Debug)]
pub struct Charge {
    budget: MemoryBudget,
    bytes: usize,
}

impl Charge {
    /// Number of bytes.
    pub fn bytes(&self) -> usize {
        self.bytes
    }

    /// Makes this a charge of another number of bytes. More are taken beside those that it has, which are not counted twice.
    ///
    /// # Errors
    /// [`ErrorKind::OutOfMemory`] if fewer are left; the charge stays as it was then.
    pub fn resize(&mut self, bytes: usize) -> Result<()> {
        match bytes.checked_sub(self.bytes) {
            Some(more) if !self.budget.try_take(more) => return Err(self.budget.exceeded(more)),
            Some(_) => {}
            None => self.budget.release(self.bytes - bytes),
        }
        self.bytes = bytes;
        Ok(())
    }
}

impl Drop for Charge {
    fn drop(&mut self) {
        self.budget.release(self.bytes);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn charges_add_up_and_are_given_back() {
        let budget = MemoryBudget::new(100);
        let first = budget.try_charge(60).unwrap();
        assert_eq!(budget.try_charge(41).unwrap_err().kind(), ErrorKind::OutOfMemory);
        assert_eq!(budget.try_charge(usize::MAX).unwrap_err().kind(), ErrorKind::OutOfMemory);
        let mut second = budget.try_charge(40).unwrap();
        assert_eq!((budget.used(), budget.peak(), first.bytes()), (100, 100, 60));
        drop(first);
        assert_eq!((budget.used(), budget.peak()), (40, 100));
        assert_eq!(second.resize(101).unwrap_err().kind(), ErrorKind::OutOfMemory);
        assert_eq!((budget.used(), second.bytes()), (40, 40));
        second.resize(90).unwrap();
        assert_eq!((budget.used(), second.bytes()), (90, 90));
        second.resize(10).unwrap();
        assert_eq!((budget.used(), second.bytes()), (10, 10));
        drop(second);
        assert_eq!(budget.used(), 0);
        assert!(!budget.force_take(101));
        budget.release(101);
        assert_eq!((budget.used(), budget.peak()), (0, 101));
    }

    #[test]
    fn no_thread_takes_what_another_has() {
        let budget = MemoryBudget::new(1000);
        let taken = AtomicUsize::new(0);
        std::thread::scope(|scope| {
            for _ in 0..4 {
                scope.spawn(|| {
                    for _ in 0..1000 {
                        if let Ok(charge) = budget.try_charge(1) {
                            taken.fetch_add(1, Ordering::Relaxed);
                            std::mem::forget(charge);
                        }
                    }
                });
            }
        });
        assert_eq!((taken.into_inner(), budget.used()), (1000, 1000));
    }
}
