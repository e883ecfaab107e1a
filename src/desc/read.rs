//! Reads a description from text: chooses between the two dialects, and finds the line of an error in the text.

use std::fmt;
use std::path::Path;
use std::sync::Arc;

use serde::Deserialize;
use serde_json::value::RawValue;

use super::file::read_text;
use super::json::{self, line_of};
use super::scene_file::scene_from_file;
use super::{RenderDesc, SceneDesc, gltf, mcrt, mesh_files, native, params, render_keys};
use crate::control::WorkProgress;
use crate::room::check_room;
use crate::{Cancel, Error, ErrorKind, Result};

/// Reads a scene file, and the parameter file if there is one.
///
/// A file whose name ends in `.gltf` or `.glb` is read as glTF 2.0 (`docs/gltf.md`). A native scene contains `"etendue": 1`; any other
/// text is read as one of the report's renderer. Values of the
/// parameter file override those of the scene's `render` block. Paths of mesh files are relative to the scene file's
/// folder.
///
/// A file whose name ends in `.obj`, `.ply` or `.stl` is a scene by itself: its surfaces, seen as a whole by a camera that is
/// made for them, under an even sky where nothing in them emits a radiance above 1.
///
/// # Errors
///
/// [`ErrorKind::Io`] if a file cannot be read or is not a regular file, [`ErrorKind::Unsupported`] for features that
/// this version does not have, otherwise [`ErrorKind::InvalidScene`]; with file, line and JSON path.
pub fn load(path: &Path, params: Option<&Path>) -> Result<SceneDesc> {
    load_with(path, params, &LoadOptions::default())
}

/// How a scene is read: what is taken from a file that describes more than one picture, which only glTF files do, and how the reading
/// is watched.
#[derive(Clone, Default)]
pub struct LoadOptions {
    /// The time at which an animation is seen, in seconds. `None` leaves everything where the file has it without an animation.
    pub time: Option<f64>,
    /// Name or number of the animation; `None` for the first one. It is read where there is a `time`.
    pub animation: Option<String>,
    /// Name or number of the camera; `None` for the first one of the scene.
    pub camera: Option<String>,
    /// Stops the reading with [`ErrorKind::Cancelled`]: within a mesh file or an image, and between the meshes of a glTF file.
    pub cancel: Cancel,
    /// Called with the fraction of the bytes of mesh files and images that are read, which only grows, from one thread at a time; with 1
    /// at the end. The sizes of a glTF file's images are known once its meshes are read.
    pub progress: Option<Arc<dyn Fn(f64) + Send + Sync>>,
}

impl LoadOptions {
    /// Whether something is chosen that only glTF files have.
    pub(super) fn is_choice(&self) -> bool {
        self.time.is_some() || self.animation.is_some() || self.camera.is_some()
    }

    /// Calls `read` with the work of reading, which is done when it returns.
    pub(super) fn watch<R>(&self, read: impl FnOnce(&WorkProgress<'static>) -> Result<R>) -> Result<R> {
        let work = WorkProgress::by_steps(&self.cancel, self.progress.clone());
        work.check()?;
        // One unit is left when the last image of a batch is decoded: the end is reported once.
        work.expect(1.0);
        let outcome = read(&work)?;
        work.finish();
        work.check()?;
        Ok(outcome)
    }
}

impl fmt::Debug for LoadOptions {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { time, animation, camera, cancel, progress: _ } = self;
        let mut it = f.debug_struct("LoadOptions");
        it.field("time", time).field("animation", animation).field("camera", camera).field("cancel", cancel);
        it.finish_non_exhaustive()
    }
}

/// Reads a scene file as [`load`] does, with a choice of what is taken from it, and with progress.
///
/// # Errors
///
/// Those of [`load`]; [`ErrorKind::InvalidScene`] for a camera or an animation that the file does not have,
/// [`ErrorKind::Unsupported`] for choices in a file that is no glTF file, and [`ErrorKind::Cancelled`].
pub fn load_with(path: &Path, params: Option<&Path>, options: &LoadOptions) -> Result<SceneDesc> {
    options.watch(|work| {
        let mut scene = scene_from_file(path, options, work)?;
        if let Some(params) = params {
            load_params(params, &mut scene)?;
        }
        Ok(scene)
    })
}

/// Reads a parameter file of the report's renderer into `scene.render`.
///
/// # Errors
///
/// [`ErrorKind::Io`] if the file cannot be read, otherwise the errors of [`apply_params`].
pub fn load_params(params: &Path, scene: &mut SceneDesc) -> Result<()> {
    let text = read_text(params)?;
    apply_params(&text, Some(params), scene)
}

/// Reads a glTF file from its bytes, text or binary.
///
/// Files that it names are relative to `base_dir`. `file` is used in messages.
///
/// # Errors
///
/// The errors are those of [`load_with`], with the path of the element (`meshes[2].primitives[0].attributes.POSITION`).
pub fn parse_gltf(bytes: &[u8], base_dir: &Path, file: Option<&Path>, options: &LoadOptions) -> Result<SceneDesc> {
    options.watch(|work| gltf::parse(bytes, base_dir, file, options, work))
}

/// Reads a scene from a string.
///
/// Paths of mesh files are relative to `base_dir`. `file` is used in messages, and to detect a scene that names itself
/// as a mesh.
///
/// # Errors
///
/// The errors are those of [`load`].
pub fn parse(json: &str, base_dir: &Path, file: Option<&Path>) -> Result<SceneDesc> {
    parse_with(json, base_dir, file, &LoadOptions::default())
}

/// Reads a scene from a string as [`parse`] does, with progress.
///
/// # Errors
///
/// Those of [`parse`]; [`ErrorKind::Unsupported`] for choices that only glTF files have, and [`ErrorKind::Cancelled`].
pub fn parse_with(json: &str, base_dir: &Path, file: Option<&Path>, options: &LoadOptions) -> Result<SceneDesc> {
    if options.is_choice() {
        return Err(no_choices(file));
    }
    options.watch(|work| parse_watched(json, base_dir, file, work))
}

/// Memory that is asked for before text is read, for each of its bytes. Long lists of short numbers take the most.
const BYTES_A_CHARACTER: usize = 6;

/// [`parse`], as a part of some work.
pub(super) fn parse_watched(
    json: &str,
    base_dir: &Path,
    file: Option<&Path>,
    work: &WorkProgress<'static>,
) -> Result<SceneDesc> {
    let json = json.strip_prefix('\u{feff}').unwrap_or(json);
    check_room(BYTES_A_CHARACTER.saturating_mul(json.len()))?;
    scene(json, base_dir, file, work).map_err(|error| located(error, json, file))
}

/// The error for a choice in a file that is no glTF file.
pub(super) fn no_choices(file: Option<&Path>) -> Error {
    let message = "a time, an animation or a camera is chosen, which only glTF files have";
    Error::new(ErrorKind::Unsupported, message).in_file(file, 0)
}

/// Reads a parameter file of the report's renderer from a string into `scene.render`.
///
/// `file` is used in messages. Features that are not supported (resizing, statistics) are reported in `scene.warnings`.
///
/// # Errors
///
/// [`ErrorKind::InvalidScene`], with line and JSON path in the parameter file. On an error, `scene` is left unchanged.
pub fn apply_params(json: &str, file: Option<&Path>, scene: &mut SceneDesc) -> Result<()> {
    let json = json.strip_prefix('\u{feff}').unwrap_or(json);
    let (mut render, mut warnings) = (scene.render.clone(), scene.warnings.clone());
    let points = !scene.lights.is_empty();
    params::apply(json, points, &mut render, &mut warnings).map_err(|error| located(error, json, file))?;
    (scene.render, scene.warnings) = (render, warnings);
    Ok(())
}

/// Reads the object at `path` of a JSON text as a `render` block of the native format, over `base`. The path is one
/// such as `groups[0].render`, and an empty path means the whole text. Settings that the block does not contain keep
/// their values from `base`, and a `maxDepth` of `null` removes the limit.
///
/// `file` is used in messages.
///
/// # Errors
///
/// [`ErrorKind::InvalidScene`], with line and JSON path in the whole text; also where `path` does not exist.
pub fn apply_render(json: &str, path: &str, file: Option<&Path>, base: &RenderDesc) -> Result<RenderDesc> {
    let json = json.strip_prefix('\u{feff}').unwrap_or(json);
    let read = || {
        json::document(json)?;
        let missing = || Error::invalid(path, "there is nothing to read here, expected an object");
        let block = json::value_at(json, path).ok_or_else(missing)?;
        let raw = serde_json::from_str(block).map_err(|error| missing().because(error))?;
        render_keys::read(raw, path, base)
    };
    read().map_err(|error| located(error, json, file))
}

fn scene(json: &str, base_dir: &Path, file: Option<&Path>, work: &WorkProgress<'static>) -> Result<SceneDesc> {
    #[derive(Deserialize)]
    struct Probe<'a> {
        #[serde(borrow, default, deserialize_with = "json::even_null")]
        etendue: Option<&'a RawValue>,
    }
    let document = json::document(json)?;
    mesh_files::announce(json, base_dir, work);
    let Some(version) = json::object::<Probe>(document, "")?.etendue else {
        return mcrt::read(document, base_dir, file, work).map_err(hint_at_version);
    };
    match version.get() {
        number if number.parse() == Ok(1.0) => native::read(document, base_dir, file, work),
        other if json::kind(other) == "a number" => {
            let message = format!("the scene is of format version {other}, this library reads version 1");
            Err(Error::new(ErrorKind::Unsupported, message).at("etendue"))
        }
        other => Err(Error::invalid("etendue", format!("expected the number 1, found {}", json::kind(other)))),
    }
}

/// Adds a hint to an error about a key that the report's dialect does not know, since the file may be a native scene
/// without its version.
fn hint_at_version(error: Error) -> Error {
    if error.location().file.is_some() || !error.message().starts_with("unknown ") {
        return error;
    }
    let message = format!("{} (a file without \"etendue\": 1 is read as a scene of mcrt)", error.message());
    Error::new(error.kind(), message).at(error.location().json_path.clone())
}

/// Adds file and line to an error that has only a JSON path.
pub(super) fn located(error: Error, json: &str, file: Option<&Path>) -> Error {
    let line = match error.location().line {
        0 => line_of(json, &error.location().json_path),
        known => known,
    };
    let path = json::elided(&error.location().json_path);
    error.in_file(file, line).at(path)
}
