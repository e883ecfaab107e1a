//! How far a build is, and whether to go on.

use std::sync::{Mutex, PoisonError};

use super::BuildOptions;
use crate::Cancel;
use crate::error::Result;

/// Items between two looks at the token: at most some hundred microseconds of any of the loops here.
const BLOCK: usize = 1 << 12;

/// Reports are this far apart, so that they cost nothing.
const STEP: f64 = 1.0 / 512.0;

/// Units of work for one item, about a nanosecond each.
pub(super) mod cost {
    /// Looking at a vertex for its box.
    pub const BOUND: f64 = 4.0;
    /// Transforming and rounding a vertex.
    pub const PLACE: f64 = 10.0;
    /// Testing a triangle for having an area.
    pub const TEST: f64 = 20.0;
    /// A triangle's share in vertex normals.
    pub const NORMAL: f64 = 120.0;
    /// A triangle as an emitter.
    pub const EMITTER: f64 = 80.0;
    /// A triangle in Embree's hierarchy, which takes all threads of the device.
    pub const HIERARCHY: f64 = 150.0;
}

/// A build under way: its token and its progress.
pub(super) struct BuildProgress<'a> {
    pub cancel: &'a Cancel,
    report: Option<&'a (dyn Fn(f64) + Send + Sync)>,
    state: Mutex<State>,
}

#[derive(Default)]
struct State {
    total: f64,
    done: f64,
    told: f64,
}

impl<'a> BuildProgress<'a> {
    pub(super) fn new(options: &'a BuildOptions) -> Self {
        Self { cancel: &options.cancel, report: options.progress.as_deref(), state: Mutex::default() }
    }

    /// Announces work to come, before any of it is done.
    pub(super) fn expect(&self, units: f64) {
        self.with(|state| state.total += units);
    }

    /// What is left of it, now that it is known better.
    pub(super) fn settle(&self, units: f64) {
        self.with(|state| state.total = state.done + units);
    }

    /// Counts work as done.
    pub(super) fn spend(&self, units: f64) {
        self.with(|state| state.done += units);
    }

    /// Runs `item` for every number below `count`, each for `cost` units, and asks for permission in between.
    pub(super) fn each(&self, count: usize, cost: f64, mut item: impl FnMut(usize)) -> Result<()> {
        for start in (0..count).step_by(BLOCK) {
            self.cancel.check()?;
            let end = count.min(start + BLOCK);
            (start..end).for_each(&mut item);
            self.spend(cost * (end - start) as f64);
        }
        self.cancel.check()
    }

    /// Runs `build` with a function to be told a fraction, which counts as that part of `units`.
    pub(super) fn share<R>(
        &self,
        units: f64,
        build: impl FnOnce(&(dyn Fn(f64) -> bool + Sync)) -> Result<R>,
    ) -> Result<R> {
        let before = self.with(|state| state.done);
        let result = build(&|fraction| {
            self.with(|state| state.done = state.done.max(before + fraction * units));
            !self.cancel.is_cancelled()
        })?;
        self.with(|state| state.done = before + units);
        Ok(result)
    }

    /// All is done.
    pub(super) fn finish(&self) {
        self.with(|state| {
            state.total = 1.0;
            state.done = 1.0;
        });
    }

    /// Changes the state, then tells how far it is, where that is news. Under the lock: from one thread at a time.
    fn with<R>(&self, change: impl FnOnce(&mut State) -> R) -> R {
        let mut state = self.state.lock().unwrap_or_else(PoisonError::into_inner);
        let result = change(&mut state);
        if let Some(report) = self.report {
            let fraction = if state.total > 0.0 { (state.done / state.total).min(1.0) } else { 0.0 };
            if fraction >= state.told + STEP || (fraction == 1.0 && state.told < 1.0) {
                state.told = fraction;
                report(fraction);
            }
        }
        result
    }
}
