//! Replacing a file in one step: write beside it, flush to the disk, rename.

use std::fs::{self, File};
use std::io::{BufWriter, Write};
use std::path::{Path, PathBuf};

use tempfile::NamedTempFile;

use crate::{Error, ErrorKind, Result};

/// The file to which an encoder writes; it may seek.
pub(super) type Target<'a> = BufWriter<&'a mut File>;

/// Runs `encode` on a new file and, only if it succeeded, renames that file to `path`. `what` names the contents in
/// messages.
pub(super) fn replace(path: &Path, what: &str, encode: impl FnOnce(&mut Target) -> Result<()>) -> Result<()> {
    let failed = |error| Error::io(path, &format!("cannot write {what}"), error);
    let target = resolve(path);
    let mut file = create_beside(&target).map_err(failed)?;
    let mut writer = BufWriter::with_capacity(1 << 16, file.as_file_mut());
    encode(&mut writer).map_err(|error| error.in_file(Some(path), 0))?;
    writer.flush().map_err(failed)?;
    drop(writer);
    // The rename may reach the disk before the data does: without this, a power failure could leave an empty file.
    file.as_file().sync_all().map_err(failed)?;
    file.persist(&target).map_err(|error| failed(error.error))?;
    sync_folder(folder_of(&target));
    Ok(())
}

/// Whether [`replace`] is likely to succeed, tested by creating a file and removing it again.
pub(super) fn check(path: &Path, what: &str) -> Result<()> {
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
    create_beside(&target).map(drop).map_err(into_folder)
}

/// A symbolic link is written through, not replaced.
fn resolve(path: &Path) -> PathBuf {
    fs::canonicalize(path).unwrap_or_else(|_| path.to_owned())
}

/// A new file in the folder of `target`, where a rename stays within one file system.
fn create_beside(target: &Path) -> std::io::Result<NamedTempFile> {
    let mut builder = tempfile::Builder::new();
    builder.prefix(".etendue-").suffix(".tmp");
    // The crate's default keeps temporary files private; this one becomes an ordinary file, narrowed by the umask.
    #[cfg(unix)]
    builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o666));
    builder.tempfile_in(folder_of(target))
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
