//! Reads glTF 2.0 files (`.gltf` and `.glb`) as scenes.
//!
//! [`load`] goes through these steps: the container, the JSON, the extensions, then materials, the hierarchy of nodes in its pose,
//! the meshes of the nodes, lights and the camera. What is wrong in a file is an error at the path of the element
//! (`meshes[2].primitives[0].attributes.POSITION`); what is left out is named in [`SceneDesc::warnings`], elements of one kind in
//! one sentence. `docs/gltf.md` lists both.

mod accessor;
mod animation;
mod buffers;
mod camera;
mod container;
mod deform;
mod document;
mod extensions;
mod instances;
mod light;
mod material;
mod material_extensions;
mod mesh;
mod nodes;
mod skin;
mod surfaces;
mod texture;

use std::io::Read;
use std::path::Path;

use super::json::{did_you_mean, elided, line_of};
use super::{LoadOptions, SceneDesc, framing};
use crate::control::WorkProgress;
use crate::{Error, ErrorKind, Result};

use accessor::Accessors;
use buffers::Buffers;

/// Largest file that is read, 2 GiB.
const SIZE_LIMIT: u64 = 2 << 30;

/// Whether a file's name is that of a glTF file.
pub(super) fn is_named(path: &Path) -> bool {
    let extension = path.extension().and_then(|it| it.to_str()).unwrap_or_default();
    ["gltf", "glb"].iter().any(|known| extension.eq_ignore_ascii_case(known))
}

/// Reads a file.
pub(super) fn load(path: &Path, options: &LoadOptions, work: &WorkProgress<'_>) -> Result<SceneDesc> {
    let mut bytes = Vec::new();
    super::file::open(path, SIZE_LIMIT)?
        .take(SIZE_LIMIT)
        .read_to_end(&mut bytes)
        .map_err(|error| Error::io(path, "cannot read the file", error))?;
    parse(&bytes, path.parent().unwrap_or(Path::new("")), Some(path), options, work)
}

/// Reads the bytes of a file. Files that it names are beside it in `base_dir`; `file` is for messages.
pub(super) fn parse(
    bytes: &[u8],
    base_dir: &Path,
    file: Option<&Path>,
    options: &LoadOptions,
    work: &WorkProgress<'_>,
) -> Result<SceneDesc> {
    let container = container::open(bytes).map_err(|error| error.in_file(file, 0))?;
    scene(&container, base_dir, file, options, work).map_err(|error| {
        let path = elided(&error.location().json_path);
        let line = match error.location().line {
            0 if container.is_text => line_of(container.text, &path),
            known => known,
        };
        error.in_file(file, line).at(path)
    })
}

fn scene(
    container: &container::Container<'_>,
    base_dir: &Path,
    file: Option<&Path>,
    options: &LoadOptions,
    work: &WorkProgress<'_>,
) -> Result<SceneDesc> {
    let document = &document::read(container.text)?;
    let mut scene = SceneDesc { file: file.map(Path::to_owned), ..SceneDesc::default() };
    extensions::check(document, &mut scene.warnings)?;
    let buffers = Buffers::new(document, container.binary, base_dir);
    {
        let accessors = Accessors::new(document, &buffers);
        let pose = match options.time {
            Some(time) if !time.is_finite() => {
                return Err(Error::new(ErrorKind::InvalidScene, format!("a time of {time}, expected a finite number")));
            }
            Some(time) => {
                animation::pose(document, &accessors, time, options.animation.as_deref(), &mut scene.warnings)?
            }
            None => animation::Pose::default(),
        };
        let nodes = nodes::place(document, &pose, &mut scene.warnings)?;
        let materials = material::add(document, &buffers, &mut scene, work)?;
        surfaces::add(document, &accessors, &nodes, &pose, materials, &mut scene)?;
        light::add(document, &nodes, &mut scene)?;
        if scene.surfaces.is_empty() {
            let why = scene.warnings.first().map_or_else(String::new, |warning| format!(" ({warning})"));
            return Err(Error::invalid("", format!("the file has no surface that can be drawn{why}")));
        }
        framing::light(&mut scene);
        camera::set(document, &nodes, options.camera.as_deref(), &mut scene)?;
    }
    scene.files = buffers.into_files();
    Ok(scene)
}

/// Finds an element of a list by its name or its number.
fn choose<'a>(list: &str, chosen: &str, names: impl Iterator<Item = Option<&'a str>> + Clone) -> Result<usize> {
    if let Some(found) = names.clone().position(|name| name == Some(chosen)) {
        return Ok(found);
    }
    let count = names.clone().count();
    match chosen.parse::<usize>() {
        Ok(number) if number < count => Ok(number),
        Ok(number) => Err(Error::invalid(list, format!("there is no {list}[{number}], the file has {count}"))),
        Err(_) => {
            let hint = did_you_mean(chosen, names.flatten());
            Err(Error::invalid(list, format!("none of {list} is named '{}'{hint}", elided(chosen))))
        }
    }
}

/// The first of several elements, and how many more there are.
fn listed(elements: impl IntoIterator<Item = String>) -> String {
    const MOST: usize = 8;
    let mut elements = elements.into_iter();
    let mut text = elements.by_ref().take(MOST).collect::<Vec<_>>().join(", ");
    match elements.count() {
        0 => {}
        more => text.push_str(&format!(" and {more} more")),
    }
    text
}

/// Adds a warning.
fn warn(warnings: &mut Vec<String>, message: String) {
    super::warnings::warn(warnings, message);
}
