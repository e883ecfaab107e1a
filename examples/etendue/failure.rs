//! Why the program ends early.

use std::fmt::Display;

use etendue::{Error, ErrorKind};

use crate::console;

/// Reason for an early end of the program: message and exit code.
#[derive(Debug)]
pub struct Failure {
    code: u8,
    message: String,
}

impl Failure {
    /// Work began and failed: exit code 1.
    pub fn running(reason: impl Display) -> Self {
        Self { code: 1, message: reason.to_string() }
    }

    /// Says what it is on standard error, and returns the exit code.
    pub fn say(&self) -> u8 {
        console::say(&format!("error: {self}"));
        self.code
    }

    /// The command cannot be carried out as given: exit code 2.
    pub fn usage(reason: impl Display) -> Self {
        Self { code: 2, message: reason.to_string() }
    }
}

/// Fails where this many bytes cannot be had at once. They are given back, for allocations that would end the process.
pub fn check_room(bytes: usize) -> Result<(), Failure> {
    let mut list = Vec::<u8>::new();
    list.try_reserve_exact(bytes).map_err(|_| Failure::running(format!("no room for {bytes} bytes")))?;
    // The compiler may leave out an allocation that nobody uses.
    drop(std::hint::black_box(list));
    Ok(())
}

impl Display for Failure {
    /// The message in one line.
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(&self.message.replace('\n', " "))
    }
}

impl From<Error> for Failure {
    /// For errors before the work begins: the input is at fault, unless the machine is.
    fn from(error: Error) -> Self {
        match error.kind() {
            ErrorKind::Device | ErrorKind::OutOfMemory | ErrorKind::Internal => Self::running(error),
            _ => Self::usage(error),
        }
    }
}
