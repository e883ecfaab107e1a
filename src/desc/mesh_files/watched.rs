//! Reads a file as a part of some work, which may be stopped.

use std::collections::HashSet;
use std::fs::File;
use std::io::{self, Read};
use std::path::Path;

use super::MeshFormat;
use crate::control::WorkProgress;
use crate::desc::file::open;
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

/// How much of a file is looked at for the names of images.
const BEGINNING: u64 = 1 << 18;

/// Bytes of the images that an OBJ file's materials name, as far as the beginnings of the file and of its material libraries tell. It is
/// what the progress of reading counts until the images are opened, and nothing depends on it. 0 without a report of progress.
pub(super) fn image_bytes(path: &Path, work: &WorkProgress<'_>) -> f64 {
    if !work.is_reported() || MeshFormat::of_name(path) != Some(MeshFormat::Obj) {
        return 0.0;
    }
    let mut images = HashSet::new();
    for library in names(path, "mtllib").into_iter().take(16) {
        images.extend(names(&path.with_file_name(library), "map_"));
    }
    let size = |name: &String| path.with_file_name(name).metadata().map_or(0, |it| it.len());
    images.iter().map(size).sum::<u64>() as f64
}

/// The last words of the lines in the beginning of a file that begin with a key.
fn names(path: &Path, key: &str) -> Vec<String> {
    let mut bytes = Vec::new();
    let read = open(path, u64::MAX).map(|file| file.take(BEGINNING).read_to_end(&mut bytes));
    if !matches!(read, Ok(Ok(_))) {
        return Vec::new();
    }
    let text = String::from_utf8_lossy(&bytes);
    let lines =
        text.lines().map(str::trim).filter(|line| line.get(..key.len()).is_some_and(|it| it.eq_ignore_ascii_case(key)));
    lines.filter_map(|line| line.split_whitespace().next_back().map(str::to_owned)).collect()
}

/// The error that stopped the work, or the error of the file.
pub(super) fn stopped(error: io::Error) -> Result<Error, io::Error> {
    error.downcast()
}
