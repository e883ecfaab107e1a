//! Writing files in one step: write beside, flush to the disk, rename.

use std::fs::{self, File};
use std::io::{BufRead, BufReader, BufWriter, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};

use tempfile::NamedTempFile;

use crate::{Error, ErrorKind, Result};

/// The file to which an encoder writes; it may seek.
pub(crate) type Target<'a> = BufWriter<&'a mut File>;

/// Runs `encode` on a new file and, only if it succeeded, renames that file to `path`. `what` names the contents in
/// messages.
pub(crate) fn replace(path: &Path, what: &str, encode: impl FnOnce(&mut Target) -> Result<()>) -> Result<()> {
    let failed = |error| Error::io(path, &format!("cannot write {what}"), error);
    let target = resolve(path);
    let file = written(path, what, folder_of(&target), encode)?;
    file.persist(&target).map_err(|error| failed(error.error))?;
    sync_folder(folder_of(&target));
    Ok(())
}

/// Runs `encode` on a new file in `folder` and, only if it succeeded, gives the file the name that `name` makes of its
/// contents. Returns the path, and whether there was no file of this name.
pub(crate) fn add(
    folder: &Path,
    what: &str,
    encode: impl FnOnce(&mut Target) -> Result<()>,
    name: impl FnOnce(u64) -> String,
) -> Result<(PathBuf, bool)> {
    let failed = |error| Error::io(folder, &format!("cannot write {what}"), error);
    let mut file = written(folder, what, folder, encode)?;
    let path = folder.join(name(hash(file.as_file_mut()).map_err(failed)?));
    let is_new = !path.exists();
    file.persist(&path).map_err(|error| failed(error.error))?;
    sync_folder(folder);
    Ok((path, is_new))
}

/// A new file in `folder` with all that `encode` writes, which has reached the disk. `path` is named in messages.
fn written(
    path: &Path,
    what: &str,
    folder: &Path,
    encode: impl FnOnce(&mut Target) -> Result<()>,
) -> Result<NamedTempFile> {
    let failed = |error| Error::io(path, &format!("cannot write {what}"), error);
    let mut file = create_in(folder).map_err(failed)?;
    let mut writer = BufWriter::with_capacity(1 << 16, file.as_file_mut());
    encode(&mut writer).map_err(|error| error.in_file(Some(path), 0))?;
    writer.flush().map_err(failed)?;
    drop(writer);
    // The rename may reach the disk before the data does: without this, a power failure could leave an empty file.
    file.as_file().sync_all().map_err(failed)?;
    Ok(file)
}

/// The hash FNV-1a (Fowler, Noll and Vo), with 64 bits.
pub(crate) mod fnv {
    /// The hash of nothing.
    pub(crate) const BEGIN: u64 = 0xcbf2_9ce4_8422_2325;

    /// The hash of what has the hash `before`, followed by `bytes`.
    pub(crate) fn continued(before: u64, bytes: &[u8]) -> u64 {
        bytes.iter().fold(before, |hash, byte| (hash ^ u64::from(*byte)).wrapping_mul(0x0100_0000_01b3))
    }
}

/// A number for the contents of a file.
fn hash(file: &mut File) -> std::io::Result<u64> {
    file.seek(SeekFrom::Start(0))?;
    let mut reader = BufReader::with_capacity(1 << 16, file);
    let mut hash = fnv::BEGIN;
    loop {
        let bytes = reader.fill_buf()?;
        if bytes.is_empty() {
            return Ok(hash);
        }
        hash = fnv::continued(hash, bytes);
        let count = bytes.len();
        reader.consume(count);
    }
}

/// Whether [`replace`] is likely to succeed, tested by creating a file and removing it again.
pub(crate) fn check(path: &Path, what: &str) -> Result<()> {
    let into_folder = |error| Error::io(path, &format!("cannot write {what} into its folder"), error);
    let refuse = |message: String| Err(Error::new(ErrorKind::Io, message).in_file(Some(path), 0));
    let target = resolve(path);
    if target.exists() && !target.is_file() {
        return refuse(format!("cannot write {what}: the name is taken by something that is not a regular file"));
    }
    let folder = folder_of(&target);
    match fs::metadata(folder) {
        Ok(metadata) if metadata.is_dir() => {}
        Ok(_) => return refuse(format!("cannot write {what}: '{}' is not a folder", folder.display())),
        Err(error) => return Err(into_folder(error)),
    }
    create_in(folder).map(drop).map_err(into_folder)
}

/// A symbolic link is written through, not replaced.
fn resolve(path: &Path) -> PathBuf {
    fs::canonicalize(path).unwrap_or_else(|_| path.to_owned())
}

/// A new file in the folder of the one that it becomes, where a rename stays within one file system.
fn create_in(folder: &Path) -> std::io::Result<NamedTempFile> {
    let mut builder = tempfile::Builder::new();
    builder.prefix(".etendue-").suffix(".tmp");
    // The crate's default keeps temporary files private; this one becomes an ordinary file, narrowed by the umask.
    #[cfg(unix)]
    builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o666));
    builder.tempfile_in(folder)
}

/// `.` for a bare file name, whose parent is the empty path.
fn folder_of(target: &Path) -> &Path {
    target.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."))
}

/// Makes the rename itself durable. The file is in place already, and some file systems refuse this: no error.
fn sync_folder(folder: &Path) {
    #[cfg(unix)]
    if let Ok(folder) = File::open(folder) {
        let _ = folder.sync_all();
    }
    #[cfg(not(unix))]
    let _ = folder;
}
