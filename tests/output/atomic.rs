//! A file is replaced in one step: neither a kill nor a full disk leaves anything but a whole image.

use std::fs;
use std::path::{Path, PathBuf};

use etendue::film::Image;
use etendue::output::{self, WriteOptions};

use super::{arbitrary_image, assert_same_bits, folder, grey};

#[test]
fn a_new_file_has_ordinary_permissions_and_links_are_followed() {
    use std::os::unix::fs::PermissionsExt;
    let folder = folder();
    let plain = folder.path().join("plain");
    fs::write(&plain, "").unwrap();
    let path = folder.path().join("image.pfm");
    let link = folder.path().join("link.pfm");
    std::os::unix::fs::symlink(&path, &link).unwrap();
    output::write(&grey(&[1.0]), &path, &WriteOptions::default()).unwrap();
    let mode = |path: &Path| fs::metadata(path).unwrap().permissions().mode();
    assert_eq!(mode(&path), mode(&plain));

    output::write(&grey(&[2.0]), &link, &WriteOptions::default()).unwrap();
    assert!(fs::symlink_metadata(&link).unwrap().is_symlink());
    assert_eq!(output::read(&path).unwrap().pixel(0, 0), [2.0; 3]);
}

/// Names the folder that [`write_forever`] writes to, in a process started for it.
const CHILD_FOLDER: &str = "ETENDUE_TEST_CHILD_FOLDER";

/// The two images that the child process writes in turns: 1.2 MB of noise each, so that writing takes a while.
fn child_images() -> [Image; 2] {
    [8, 9].map(|seed| arbitrary_image(160, 160, true, seed))
}

/// Not a test of its own but the child process of those below: writes until it is ended or fails.
#[test]
fn write_forever() {
    let Some(folder) = std::env::var_os(CHILD_FOLDER).map(PathBuf::from) else { return };
    let images = child_images();
    for image in images.iter().cycle() {
        for name in ["image.exr", "image.pfm"] {
            if let Err(error) = output::write(image, &folder.join(name), &WriteOptions::default()) {
                println!("child: {error}");
                std::process::exit(3);
            }
        }
    }
}

/// This test binary again, running [`write_forever`], after `setup` in its shell.
fn child(folder: &Path, setup: &str) -> std::process::Command {
    let mut command = std::process::Command::new("sh");
    command
        .arg("-c")
        .arg(format!("{setup} exec \"$0\" --exact atomic::write_forever --nocapture --test-threads 1"))
        .arg(std::env::current_exe().unwrap())
        .env(CHILD_FOLDER, folder)
        .stdout(std::process::Stdio::piped())
        .stderr(std::process::Stdio::null());
    command
}

#[test]
fn a_killed_writer_leaves_a_whole_file() {
    let images = child_images();
    let folder = folder();
    let paths = ["image.exr", "image.pfm"].map(|name| folder.path().join(name));
    for path in &paths {
        output::write(&images[0], path, &WriteOptions::default()).unwrap();
    }
    for round in 0..12 {
        let mut child = child(folder.path(), "").spawn().unwrap();
        std::thread::sleep(std::time::Duration::from_millis(40 + 17 * round));
        child.kill().unwrap();
        child.wait().unwrap();
        for path in &paths {
            let found = output::read(path).unwrap();
            let expected = if found.rgb[5] == images[0].rgb[5] { &images[0] } else { &images[1] };
            let layers = if path.extension().unwrap() == "exr" { expected.layers.clone() } else { Vec::new() };
            assert_same_bits(&found, &Image { layers, ..expected.clone() });
        }
    }
}

#[test]
fn a_full_disk_leaves_the_old_file() {
    use std::os::unix::process::ExitStatusExt;
    let folder = folder();
    let old = grey(&[0.25, 0.5]);
    let path = folder.path().join("image.exr");
    let names = || {
        let mut names: Vec<_> = fs::read_dir(folder.path()).unwrap().map(|entry| entry.unwrap().file_name()).collect();
        names.sort();
        names
    };

    // A limit of 64 blocks (32 KiB) per file stands for a disk that is full: the write fails in its middle.
    output::write(&old, &path, &WriteOptions::default()).unwrap();
    let outcome = child(folder.path(), "trap '' XFSZ; ulimit -f 64;").output().unwrap();
    let stdout = String::from_utf8_lossy(&outcome.stdout);
    assert_eq!(outcome.status.code(), Some(3), "{stdout}");
    assert!(stdout.contains("image.exr: cannot write the image"), "{stdout}");
    assert_eq!(output::read(&path).unwrap(), old);
    assert_eq!(names(), ["image.exr"], "the unfinished file is removed");

    // Without the trap the signal ends the process at that very write.
    let outcome = child(folder.path(), "ulimit -f 64;").output().unwrap();
    assert!(outcome.status.signal().is_some(), "{:?}", outcome.status);
    assert_eq!(output::read(&path).unwrap(), old);
    assert_eq!(names().len(), 2, "the old file, and the one that the killed process was writing");
}
