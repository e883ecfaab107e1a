//! Reads text from a path. Only regular files of bounded size that contain UTF-8 are accepted.

use std::fs::File;
use std::io::Read;
use std::path::Path;

use super::json::line_at;
use crate::{Error, ErrorKind, Result};

/// Largest scene or parameter file that is read, 512 MiB. Large meshes belong in mesh files.
pub(super) const SIZE_LIMIT: u64 = 512 << 20;

/// Fails where a path leads to something else than a regular file: a pipe could block, and a device could be endless.
pub(crate) fn check_regular(path: &Path) -> std::io::Result<()> {
    match irregular(&std::fs::metadata(path)?) {
        Some(what) => Err(std::io::Error::other(format!("it is {what}"))),
        None => Ok(()),
    }
}

/// What something is that is no regular file.
fn irregular(metadata: &std::fs::Metadata) -> Option<&'static str> {
    let what = if metadata.is_dir() { "a folder" } else { "not a regular file" };
    (!metadata.is_file()).then_some(what)
}

/// Opens a regular file of at most `limit` bytes. Pipes, devices and folders are refused before they can block.
pub(crate) fn open(path: &Path, limit: u64) -> Result<File> {
    let fail = |error| Error::io(path, "cannot open the file", error);
    let refuse = |message: String| Error::new(ErrorKind::Io, message).in_file(Some(path), 0);
    let check = |metadata: std::fs::Metadata| {
        if let Some(what) = irregular(&metadata) {
            return Err(refuse(format!("cannot open the file: it is {what}")));
        }
        if metadata.len() > limit {
            let size = metadata.len();
            return Err(refuse(format!("the file is too large: {size} bytes, expected {limit} at most")));
        }
        Ok(())
    };
    check(std::fs::metadata(path).map_err(fail)?)?;
    let file = File::open(path).map_err(fail)?;
    // The file is checked again after opening, because it may have been replaced in between.
    check(file.metadata().map_err(fail)?)?;
    Ok(file)
}

/// Reads the text of a scene or parameter file.
pub(super) fn read_text(path: &Path) -> Result<String> {
    let mut bytes = Vec::new();
    open(path, SIZE_LIMIT)?
        .take(SIZE_LIMIT + 1)
        .read_to_end(&mut bytes)
        .map_err(|error| Error::io(path, "cannot read the file", error))?;
    if bytes.len() as u64 > SIZE_LIMIT {
        let message = format!("the file is too large, expected {SIZE_LIMIT} bytes at most");
        return Err(Error::new(ErrorKind::Io, message).in_file(Some(path), 0));
    }
    if bytes.starts_with(&[0xff, 0xfe]) || bytes.starts_with(&[0xfe, 0xff]) {
        let message = "the file is UTF-16, expected UTF-8";
        return Err(Error::new(ErrorKind::InvalidScene, message).in_file(Some(path), 1));
    }
    String::from_utf8(bytes).map_err(|error| {
        let valid = error.utf8_error().valid_up_to();
        let message = format!("byte {} is not UTF-8; save the file as UTF-8", valid + 1);
        let line = line_at(error.as_bytes(), valid);
        Error::new(ErrorKind::InvalidScene, message).in_file(Some(path), line).because(error)
    })
}
