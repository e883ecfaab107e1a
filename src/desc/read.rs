//! From text to a description: the choice between the two dialects, and where in a text an error is.

use std::path::Path;

use serde::Deserialize;
use serde_json::value::RawValue;

use super::file::read_text;
use super::json::{self, line_of};
use super::{RenderDesc, SceneDesc, mcrt, native, params, render};
use crate::{Error, ErrorKind, Result};

/// Reads a scene file, and the parameter file if there is one.
///
/// A native scene says `"etendue": 1`; any other is read as one of the report's renderer. Values of the parameter file
/// override those of the scene's `render` block. Meshes are looked up from the scene file's folder.
///
/// # Errors
///
/// [`ErrorKind::Io`] if a file cannot be read or is not a regular file, [`ErrorKind::Unsupported`] for what this
/// version does not do, otherwise [`ErrorKind::InvalidScene`]; with file, line and JSON path.
pub fn load(path: &Path, params: Option<&Path>) -> Result<SceneDesc> {
    let text = read_text(path)?;
    let base_dir = path.parent().unwrap_or(Path::new(""));
    let mut scene = parse(&text, base_dir, Some(path))?;
    if let Some(params) = params {
        load_params(params, &mut scene)?;
    }
    Ok(scene)
}

/// Reads a parameter file of the report's renderer into `scene.render`.
///
/// # Errors
///
/// [`ErrorKind::Io`] if it cannot be read, else as [`apply_params`].
pub fn load_params(params: &Path, scene: &mut SceneDesc) -> Result<()> {
    let text = read_text(params)?;
    apply_params(&text, Some(params), scene)
}

/// Reads a scene from a string.
///
/// Meshes are looked up from `base_dir`; `file` is for messages, and to notice a scene that names itself as a mesh.
///
/// # Errors
///
/// As [`load`].
pub fn parse(json: &str, base_dir: &Path, file: Option<&Path>) -> Result<SceneDesc> {
    let json = json.strip_prefix('\u{feff}').unwrap_or(json);
    scene(json, base_dir, file).map_err(|error| located(error, json, file))
}

/// Reads a parameter file of the report's renderer from a string into `scene.render`.
///
/// `file` is for messages. What is not done (resizing, statistics) is said in `scene.warnings`.
///
/// # Errors
///
/// [`ErrorKind::InvalidScene`], with line and JSON path in the parameter file; `scene` is then as before.
pub fn apply_params(json: &str, file: Option<&Path>, scene: &mut SceneDesc) -> Result<()> {
    let json = json.strip_prefix('\u{feff}').unwrap_or(json);
    let (mut render, mut warnings) = (scene.render.clone(), scene.warnings.clone());
    let points = !scene.lights.is_empty();
    params::apply(json, points, &mut render, &mut warnings).map_err(|error| located(error, json, file))?;
    (scene.render, scene.warnings) = (render, warnings);
    Ok(())
}

/// Reads the object at `path` of a JSON text (such as `groups[0].render`; empty: all of it) as a `render` block of the
/// native format, over `base`: what it does not say stays, and a `maxDepth` of `null` takes a cut away.
///
/// `file` is for messages.
///
/// # Errors
///
/// [`ErrorKind::InvalidScene`], with line and JSON path in the whole text; also where `path` leads nowhere.
pub fn apply_render(json: &str, path: &str, file: Option<&Path>, base: &RenderDesc) -> Result<RenderDesc> {
    let json = json.strip_prefix('\u{feff}').unwrap_or(json);
    let read = || {
        json::document(json)?;
        let missing = || Error::invalid(path, "there is nothing to read here, expected an object");
        let block = json::value_at(json, path).ok_or_else(missing)?;
        let raw = serde_json::from_str(block).map_err(|error| missing().because(error))?;
        render::read(raw, path, base)
    };
    read().map_err(|error| located(error, json, file))
}

fn scene(json: &str, base_dir: &Path, file: Option<&Path>) -> Result<SceneDesc> {
    #[derive(Deserialize)]
    struct Probe<'a> {
        #[serde(borrow, default, deserialize_with = "json::even_null")]
        etendue: Option<&'a RawValue>,
    }
    let document = json::document(json)?;
    let Some(version) = json::object::<Probe>(document, "")?.etendue else {
        return mcrt::read(document, base_dir, file).map_err(hint_at_version);
    };
    match version.get() {
        number if number.parse() == Ok(1.0) => native::read(document, base_dir, file),
        other if json::kind(other) == "a number" => {
            let message = format!("the scene is of format version {other}, this library reads version 1");
            Err(Error::new(ErrorKind::Unsupported, message).at("etendue"))
        }
        other => Err(Error::invalid("etendue", format!("expected the number 1, found {}", json::kind(other)))),
    }
}

/// A word the report's dialect does not know may be one of a native scene that lacks its version.
fn hint_at_version(error: Error) -> Error {
    if error.location().file.is_some() || !error.message().starts_with("unknown ") {
        return error;
    }
    let message = format!("{} (a file without \"etendue\": 1 is read as a scene of mcrt)", error.message());
    Error::new(error.kind(), message).at(error.location().json_path.clone())
}

/// Adds file and line to an error that has only a JSON path so far.
fn located(error: Error, json: &str, file: Option<&Path>) -> Error {
    let line = match error.location().line {
        0 => line_of(json, &error.location().json_path),
        known => known,
    };
    let path = json::elided(&error.location().json_path);
    error.in_file(file, line).at(path)
}
