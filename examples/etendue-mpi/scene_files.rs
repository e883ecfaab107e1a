//! A scene that one process has read, for all others: the files of a native scene, packed one after another.

use std::fs;
use std::path::{Component, Path};

use etendue::desc::{self, LoadOptions, SceneDesc};
use mpi::topology::SimpleCommunicator;
use mpi::traits::*;
use tempfile::TempDir;

use crate::failure::Failure;

/// The scene file in its folder.
const SCENE: &str = "scene.json";

/// Bytes that are sent at a time: MPI counts them in 31 bits.
const AT_ONCE: usize = 1 << 28;

fn temporary() -> Result<TempDir, Failure> {
    tempfile::tempdir().map_err(|error| Failure::running(format!("cannot make a temporary folder: {error}")))
}

/// The files of a scene: of each the length of its name, the name, the length of its contents and the contents.
pub fn pack(description: &SceneDesc) -> Result<Vec<u8>, Failure> {
    let folder = temporary()?;
    let scene = folder.path().join(SCENE);
    description.save(&scene)?;
    let mut packed = Vec::new();
    let mut put = |path: &Path| {
        let name = path.strip_prefix(folder.path()).unwrap_or(path).to_string_lossy().into_owned();
        let contents = fs::read(path).map_err(|error| Failure::running(format!("{}: {error}", path.display())))?;
        for part in [name.as_bytes(), &contents] {
            packed.extend((part.len() as u64).to_le_bytes());
            packed.extend(part);
        }
        Ok::<_, Failure>(())
    };
    put(&scene)?;
    let files = SceneDesc::files_folder(&scene);
    if files.exists() {
        let entries =
            fs::read_dir(&files).map_err(|error| Failure::running(format!("{}: {error}", files.display())))?;
        for entry in entries.flatten() {
            put(&entry.path())?;
        }
    }
    Ok(packed)
}

/// Sends packed files to all other processes.
pub fn send(world: &SimpleCommunicator, packed: &[u8]) {
    let first = world.process_at_rank(0);
    first.broadcast_into(&mut (packed.len() as u64));
    for part in packed.chunks(AT_ONCE) {
        first.broadcast_into(&mut part.to_vec()[..]);
    }
}

/// Receives files from the first process, and reads the scene.
pub fn receive(world: &SimpleCommunicator) -> Result<SceneDesc, Failure> {
    let first = world.process_at_rank(0);
    let mut length = 0_u64;
    first.broadcast_into(&mut length);
    let length = length as usize;
    let mut packed = Vec::new();
    let no_memory = |error| Failure::running(format!("no room for the {length} bytes of the scene: {error}"));
    packed.try_reserve_exact(length).map_err(no_memory)?;
    packed.resize(length, 0);
    packed.chunks_mut(AT_ONCE).for_each(|part| first.broadcast_into(part));
    let folder = temporary()?;
    unpack(&packed, folder.path())?;
    drop(packed);
    Ok(desc::load_with(&folder.path().join(SCENE), None, &LoadOptions::default())?)
}

/// Writes packed files into a folder.
fn unpack(mut packed: &[u8], folder: &Path) -> Result<(), Failure> {
    let damaged = || Failure::running("the scene did not arrive whole");
    let mut take = || {
        let (length, rest) = packed.split_first_chunk()?;
        let (part, rest) = rest.split_at_checked(u64::from_le_bytes(*length) as usize)?;
        packed = rest;
        Some(part)
    };
    while let Some(name) = take() {
        let contents = take().ok_or_else(damaged)?;
        let name = Path::new(std::str::from_utf8(name).map_err(|_| damaged())?);
        if !name.components().all(|part| matches!(part, Component::Normal(_))) {
            return Err(damaged());
        }
        let path = folder.join(name);
        let failed = |error| Failure::running(format!("{}: {error}", path.display()));
        path.parent().map_or(Ok(()), fs::create_dir_all).map_err(failed)?;
        fs::write(&path, contents).map_err(failed)?;
    }
    if packed.is_empty() { Ok(()) } else { Err(damaged()) }
}
