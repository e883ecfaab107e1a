//! Reads a file as a part of some work, which may be stopped.

use std::fs::File;
use std::io::{self, Read};

use crate::control::WorkProgress;
use crate::{Error, Result};

/// A file whose bytes are units of work. Once the work is stopped, reading it is an error that [`stopped`] knows.
pub(super) struct WatchedFile<'a, 'p> {
    file: File,
    work: &'a WorkProgress<'p>,
}

impl<'a, 'p> WatchedFile<'a, 'p> {
    pub fn new(file: File, work: &'a WorkProgress<'p>) -> Self {
        Self { file, work }
    }
}

impl Read for WatchedFile<'_, '_> {
    fn read(&mut self, bytes: &mut [u8]) -> io::Result<usize> {
        self.work.check().map_err(io::Error::other)?;
        let count = self.file.read(bytes)?;
        self.work.spend(count);
        Ok(count)
    }
}

/// The error that stopped the work, or the error of the file.
pub(super) fn stopped(error: io::Error) -> Result<Error, io::Error> {
    error.downcast()
}
