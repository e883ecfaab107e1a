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
    let target = resolve(path).map_err(failed)?;
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

/// Whether [`replace`] is likely to succeed, tested by creating a file and removing it again. Removes what writers that were killed have
/// left in the folder.
pub(crate) fn check(path: &Path, what: &str) -> Result<()> {
    let into_folder = |error| Error::io(path, &format!("cannot write {what} into its folder"), error);
    let refuse = |message: String| Err(Error::new(ErrorKind::Io, message).in_file(Some(path), 0));
    let target = resolve(path).map_err(into_folder)?;
    if target.exists() && !target.is_file() {
        return refuse(format!("cannot write {what}: the name is taken by something that is not a regular file"));
    }
    let folder = folder_of(&target);
    match fs::metadata(folder) {
        Ok(metadata) if metadata.is_dir() => {}
        Ok(_) => return refuse(format!("cannot write {what}: '{}' is not a folder", folder.display())),
        Err(error) => return Err(into_folder(error)),
    }
    // A name that the file system does not have.
    match fs::symlink_metadata(&target) {
        Err(error) if error.kind() != std::io::ErrorKind::NotFound => return Err(into_folder(error)),
        _ => {}
    }
    remove_leftovers(folder);
    create_in(folder).map(drop).map_err(into_folder)
}

/// Most links that lead from one to the next, as on Linux.
const MOST_LINKS: usize = 40;

/// A symbolic link is written through, not replaced, also where it leads to a file that is still to be made.
fn resolve(path: &Path) -> std::io::Result<PathBuf> {
    let mut target = path.to_owned();
    for _ in 0..MOST_LINKS {
        if let Ok(found) = fs::canonicalize(&target) {
            return Ok(found);
        }
        match fs::read_link(&target) {
            Ok(next) => target = folder_of(&target).join(next),
            Err(_) => return Ok(target),
        }
    }
    Err(std::io::Error::other("too many levels of symbolic links"))
}

/// The names of unfinished files begin and end so.
const PREFIX: &str = ".etendue-";
const SUFFIX: &str = ".tmp";

/// How often a new file is made anew where another process has taken it away.
const TRIES: usize = 8;

/// A new file in the folder of the one that it becomes, where a rename stays within one file system. It is locked as long as it is open,
/// so that others can tell it from one that was left.
fn create_in(folder: &Path) -> std::io::Result<NamedTempFile> {
    let mut builder = tempfile::Builder::new();
    builder.prefix(PREFIX).suffix(SUFFIX);
    // The crate's default keeps temporary files private; this one becomes an ordinary file, narrowed by the umask.
    #[cfg(unix)]
    builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o666));
    for _ in 0..TRIES {
        let file = builder.tempfile_in(folder)?;
        // Before it was locked, another process may have taken it for one that was left.
        if lock(file.as_file()) != Lock::Others && is_in_folder(file.as_file()) {
            return Ok(file);
        }
    }
    // A file system whose answers mean nothing.
    builder.tempfile_in(folder)
}

/// Whose a file is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Lock {
    Own,
    Others,
    /// The file system has no locks.
    Unknown,
}

#[cfg(unix)]
fn lock(file: &File) -> Lock {
    match rustix::fs::flock(file, rustix::fs::FlockOperation::NonBlockingLockExclusive) {
        Ok(()) => Lock::Own,
        Err(rustix::io::Errno::WOULDBLOCK) => Lock::Others,
        Err(_) => Lock::Unknown,
    }
}

#[cfg(not(unix))]
fn lock(_: &File) -> Lock {
    Lock::Unknown
}

#[cfg(unix)]
fn is_in_folder(file: &File) -> bool {
    file.metadata().is_ok_and(|it| std::os::unix::fs::MetadataExt::nlink(&it) > 0)
}

#[cfg(not(unix))]
fn is_in_folder(_: &File) -> bool {
    true
}

/// Removes unfinished files of processes that were killed: those that nobody has locked. What cannot be removed stays.
fn remove_leftovers(folder: &Path) {
    let is_unfinished =
        |name: &std::ffi::OsStr| name.to_str().is_some_and(|name| name.starts_with(PREFIX) && name.ends_with(SUFFIX));
    for entry in fs::read_dir(folder).into_iter().flatten().flatten() {
        let is_file = entry.file_type().is_ok_and(|it| it.is_file());
        if is_file
            && is_unfinished(&entry.file_name())
            && let Ok(file) = File::open(entry.path())
            && lock(&file) == Lock::Own
        {
            let _ = fs::remove_file(entry.path());
        }
    }
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

#[cfg(all(test, unix))]
mod tests {
    use super::*;

    fn names(folder: &Path) -> Vec<String> {
        let mut names: Vec<_> =
            fs::read_dir(folder).unwrap().map(|it| it.unwrap().file_name().into_string().unwrap()).collect();
        names.sort();
        names
    }

    #[test]
    fn what_killed_writers_left_is_removed_and_what_others_write_is_not() {
        let folder = tempfile::tempdir().unwrap();
        for name in [".etendue-left.tmp", ".etendue-kept", "own.tmp"] {
            fs::write(folder.path().join(name), "x").unwrap();
        }
        fs::create_dir(folder.path().join(".etendue-folder.tmp")).unwrap();
        let unfinished = create_in(folder.path()).unwrap();
        let own = unfinished.path().file_name().unwrap().to_str().unwrap().to_owned();
        check(&folder.path().join("a.exr"), "the image").unwrap();
        let mut expected = vec![own, ".etendue-folder.tmp".into(), ".etendue-kept".into(), "own.tmp".into()];
        expected.sort();
        assert_eq!(names(folder.path()), expected);
        drop(unfinished);
        replace(&folder.path().join("a.exr"), "the image", |file| {
            file.write_all(b"picture").unwrap();
            Ok(())
        })
        .unwrap();
        assert_eq!(fs::read(folder.path().join("a.exr")).unwrap(), b"picture");
        assert_eq!(names(folder.path()), [".etendue-folder.tmp", ".etendue-kept", "a.exr", "own.tmp"]);
    }

    #[test]
    fn links_are_written_through_also_to_files_that_are_still_to_be_made() {
        let folder = tempfile::tempdir().unwrap();
        let at = |name: &str| folder.path().join(name);
        fs::create_dir(at("far")).unwrap();
        std::os::unix::fs::symlink("far/new.png", at("link.png")).unwrap();
        std::os::unix::fs::symlink("link.png", at("first.png")).unwrap();
        std::os::unix::fs::symlink("round.png", at("round.png")).unwrap();
        let write = |name: &str| {
            check(&at(name), "the image")?;
            replace(&at(name), "the image", |file| {
                file.write_all(name.as_bytes()).unwrap();
                Ok(())
            })
        };
        for name in ["first.png", "link.png"] {
            write(name).unwrap();
            assert_eq!(fs::read_to_string(at("far/new.png")).unwrap(), name);
            assert!(at(name).is_symlink());
        }
        let error = write("round.png").unwrap_err().to_string();
        assert!(error.contains("too many levels of symbolic links") && at("round.png").is_symlink(), "{error}");
        let error = write(&"a".repeat(300)).unwrap_err().to_string();
        assert!(error.contains("cannot write the image into its folder: File name too long"), "{error}");
    }
}
