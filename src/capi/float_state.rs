//! The floating-point state of the thread: how results are rounded, which exceptions trap, and whether subnormal numbers are
//! flushed to zero.
//!
//! Rust and Embree compute in the default state, and only so is an image the same everywhere. A host may have another one. The
//! library therefore computes in the default state, the host's functions are called in the host's, and a call leaves the
//! state as it was, with its exception flags.

#[cfg(target_arch = "x86_64")]
use std::arch::asm;
use std::cell::Cell;

/// The registers of the state.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct FloatState {
    /// MXCSR, by which vector instructions compute. The lowest six bits are flags of exceptions that have occurred.
    mxcsr: u32,
    /// The control word of the x87 unit, in which C and C++ compute `long double`.
    x87: u16,
}

impl FloatState {
    /// Rounding to nearest, no traps, subnormal numbers as they are, no flags: the state in which a process begins.
    const DEFAULT: Self = Self { mxcsr: 0x1f80, x87: 0x037f };

    /// The bits of MXCSR that say how to compute.
    const CONTROL: u32 = 0xffc0;

    /// The state of this thread.
    #[inline]
    fn read() -> Self {
        Self { mxcsr: read_mxcsr(), x87: read_x87() }
    }

    /// Makes this the state of this thread.
    fn write(self) {
        write_mxcsr(self.mxcsr);
        // This takes longer, and hardly any program changes the word.
        if read_x87() != self.x87 {
            write_x87(self.x87);
        }
    }

    /// Whether computing in this state is as in the other one, whatever exceptions have occurred.
    #[inline]
    fn computes_as(self, other: Self) -> bool {
        (self.mxcsr ^ other.mxcsr) & Self::CONTROL == 0 && self.x87 == other.x87
    }
}

#[cfg(target_arch = "x86_64")]
#[inline]
fn read_mxcsr() -> u32 {
    let mut value = 0_u32;
    // SAFETY: the instruction writes the register to a place of its size.
    unsafe { asm!("stmxcsr [{}]", in(reg) &raw mut value, options(nostack, preserves_flags)) }
    value
}

#[cfg(target_arch = "x86_64")]
#[inline]
fn read_x87() -> u16 {
    let mut value = 0_u16;
    // SAFETY: as above.
    unsafe { asm!("fnstcw [{}]", in(reg) &raw mut value, options(nostack, preserves_flags)) }
    value
}

#[cfg(target_arch = "x86_64")]
#[inline]
fn write_mxcsr(value: u32) {
    // SAFETY: the value was read from the register, or is the default. In another state than the default one runs no code that the
    // compiler knows, but for what is between two calls that it cannot look into.
    unsafe { asm!("ldmxcsr [{}]", in(reg) &raw const value, options(nostack, preserves_flags)) }
}

#[cfg(target_arch = "x86_64")]
fn write_x87(value: u16) {
    // SAFETY: as above.
    unsafe { asm!("fldcw [{}]", in(reg) &raw const value, options(nostack, preserves_flags)) }
}

/// Other processors have other registers, which are left as they are.
#[cfg(not(target_arch = "x86_64"))]
mod elsewhere {
    use super::FloatState;

    pub fn read_mxcsr() -> u32 {
        FloatState::DEFAULT.mxcsr
    }

    pub fn read_x87() -> u16 {
        FloatState::DEFAULT.x87
    }

    pub fn write_mxcsr(_value: u32) {}

    pub fn write_x87(_value: u16) {}
}
#[cfg(not(target_arch = "x86_64"))]
use elsewhere::{read_mxcsr, read_x87, write_mxcsr, write_x87};

thread_local! {
    /// The state that functions of the host expect on this thread, where it is not the default one.
    static OF_HOST: Cell<Option<FloatState>> = const { Cell::new(None) };
}

/// Runs a call of the host in the default state, and leaves the state as it was. `body` must not unwind.
#[inline]
pub(super) fn in_default_state<R>(body: impl FnOnce() -> R) -> R {
    let host = FloatState::read();
    if host.computes_as(FloatState::DEFAULT) {
        // The compiler believes the same of the state, so that it may look into `body`.
        let result = body();
        // What the library computes raises flags, such as that of an inexact result.
        if read_mxcsr() != host.mxcsr {
            write_mxcsr(host.mxcsr);
        }
        return result;
    }
    from_other_state(host, body)
}

#[cold]
#[inline(never)]
fn from_other_state<R>(host: FloatState, body: impl FnOnce() -> R) -> R {
    let outer = OF_HOST.replace(Some(host));
    FloatState::DEFAULT.write();
    let result = opaque(body);
    OF_HOST.set(outer);
    host.write();
    result
}

/// Calls a function of the host in the state that it expects: that of the call which this thread is in, or the default one on a
/// thread of the library, for which Embree may have chosen another. What the function does to the state is undone.
pub(super) fn in_host_state<R>(function: impl FnOnce() -> R) -> R {
    let library = FloatState::read();
    // Calls that the function makes are calls from its state, and are noted as such.
    let host = OF_HOST.take();
    let state = host.unwrap_or(FloatState::DEFAULT);
    if !library.computes_as(state) {
        state.write();
    }
    let result = opaque(function);
    OF_HOST.set(host);
    if FloatState::read() != library {
        library.write();
    }
    result
}

/// Calls a function into which the compiler cannot look, so that it moves no computation to where the state is another.
#[inline(never)]
fn opaque<R>(function: impl FnOnce() -> R) -> R {
    function()
}
