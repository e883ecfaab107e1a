//! Writes a description as a scene file of the native format, with its meshes, images and photometric webs in a folder beside
//! it.
//!
//! The keys are those of the structures that read them: each of these has a function that makes it from the description. Numbers
//! are written such that the same bits are read. The scene file is put in its place at last and in one step; the files in the
//! folder have names by their contents, so a scene file that was there before keeps its own until then.

mod files;
mod fingerprint;
mod text;

use std::collections::{BTreeMap, HashSet};
use std::io::{self, Write};
use std::path::{Path, PathBuf};

use serde_json::value::RawValue;

use self::files::{Files, WebFiles};
use self::text::laid_out;
use super::file::SIZE_LIMIT;
use super::mesh_files::ply_write;
use super::{
    DistantLightDesc, MaterialDesc, MotionDesc, PlacementDesc, SceneDesc, ShapeDesc, SurfaceDesc, backplate_keys,
    camera_check, camera_keys, group_keys, light_keys, material_check, material_keys, render_write, sky_keys, surface,
    texture_check, texture_keys, validate,
};
use crate::replace::{self, Target};
use crate::{Error, ErrorKind, Result};

pub(super) use text::raw;

/// Names of elements by their numbers, each once.
pub(super) struct Names {
    pub textures: Vec<String>,
    pub materials: Vec<String>,
    pub meshes: Vec<String>,
    pub groups: Vec<String>,
}

impl SceneDesc {
    /// Writes the description as a scene file of the native format. Meshes, images and photometric webs go into
    /// [`Self::files_folder`], which is made where there is none. A scene that is read from the file gives the same images, bit for bit.
    ///
    /// An existing file is replaced in one step, after all other files have been written, and files in the folder that an earlier
    /// scene file had there are then removed. On an error everything is as it was.
    ///
    /// Warnings, removed surfaces and removed meshes are not written, and messages about the new scene have paths of the new file.
    /// A frame of a shape that the keys of the format cannot give becomes a part of [`super::SurfaceDesc::transform`]. Placements of groups
    /// that were edited in part are written surface by surface, and images of theirs may differ by rounding. Meshes in the
    /// memory of a host become meshes of the description, which are shifted to the scene frame before they are rounded to single
    /// precision.
    ///
    /// # Errors
    /// [`ErrorKind::Unsupported`] for a name that does not end in `.json`, and for a mesh or a scene that is larger than what is read;
    /// [`ErrorKind::InvalidScene`], with the path of the element, for a description that the format cannot have, such as a number out
    /// of range or a disk whose normal is not of unit length; [`ErrorKind::Io`] for anything that the file system refuses, such as a
    /// folder that does not exist; [`ErrorKind::OutOfMemory`].
    pub fn save(&self, path: &Path) -> Result<()> {
        save(self, path).map_err(|error| match error.location().file {
            Some(_) => error,
            None => error.in_file(Some(path), 0),
        })
    }

    /// The folder into which [`Self::save`] puts the meshes and images of a scene file: `room.files` for `room.json`.
    pub fn files_folder(path: &Path) -> PathBuf {
        path.with_extension("files")
    }
}

fn save(scene: &SceneDesc, path: &Path) -> Result<()> {
    // In small letters: `room.JSON` beside `room.json` would have the same folder.
    if path.extension().is_none_or(|extension| extension != "json") {
        let message = "the name of a native scene file ends in .json, expected such a name";
        return Err(Error::new(ErrorKind::Unsupported, message));
    }
    check(scene)?;
    replace::check(path, "the scene")?;
    let names = Names::of(scene);
    let mut files = Files::new(path)?;
    let images = files.images(scene)?;
    let meshes = files.meshes(scene)?;
    let webs = files.webs(scene)?;
    replace::replace(path, "the scene", |file| {
        let mut out = Out { file, written: 0 };
        document(scene, &names, [&images, &meshes], &webs, &mut out)
    })?;
    files.keep();
    Ok(())
}

/// Refuses what no file can have. Descriptions that were read or made by calls have passed these checks.
fn check(scene: &SceneDesc) -> Result<()> {
    camera_check::camera("camera", scene.camera)?;
    scene.motion.check(scene)?;
    scene.render.check()?;
    for light in &scene.lights {
        validate::light(light.clone())?;
    }
    scene.distant_lights.iter().try_for_each(DistantLightDesc::check)?;
    if let Some(environment) = &scene.environment {
        texture_check::environment(environment, &scene.textures)?;
    }
    if let Some(backplate) = &scene.backplate {
        backplate.check(&scene.textures)?;
    }
    scene.textures.iter().try_for_each(|texture| texture_check::texture(texture))?;
    for (number, material) in scene.materials.iter().enumerate() {
        let before = &scene.materials[..number];
        material_check::check(&mut material.clone(), before)?;
        texture_check::bindings(material, &scene.textures, before)?;
    }
    for mesh in scene.meshes.iter().filter(|mesh| mesh.triangle_count() > 0) {
        validate::mesh(&mesh.path, mesh)?;
    }
    for surface in scene.surfaces.iter().filter(|surface| !surface.hidden).chain(scene.members()) {
        let path = &surface.path;
        surface.shape.check(path)?;
        validate::invertible(path, &surface.to_world())?;
        if let ShapeDesc::Mesh { mesh, .. } = surface.shape
            && scene.meshes.get(mesh).is_none_or(|mesh| mesh.triangle_count() == 0)
        {
            return Err(Error::invalid(path, format!("there is no mesh {mesh}")));
        }
        match (surface.material, scene.material_of(surface)) {
            (_, Some(it)) => validate::look(path, surface.emission, it, &surface.shape, &surface.to_world())?,
            (Some(number), None) => return Err(Error::invalid(path, format!("there is no material {number}"))),
            (None, None) if surface.emission.is_some() => validate::emitter(path, &surface.shape, &surface.to_world())?,
            (None, None) => {}
        }
        if let Some(radiance) = surface.emission {
            validate::emission(&format!("{path}.emission"), radiance.to_f64(), 1.0)?;
        }
        if emits_both(scene, surface) {
            validate::emits_both(path, &surface.shape, true)?;
        }
        if let (Some(web), Some(factor)) = (&surface.web, surface.emission) {
            web.check(path, &surface.shape, factor, surface.emits_both)?;
        }
    }
    Ok(())
}

/// Whether a surface emits light on both of its sides.
fn emits_both(scene: &SceneDesc, surface: &SurfaceDesc) -> bool {
    let emission = surface.emission.or(scene.material_of(surface).and_then(|it| it.emission));
    surface.emits_both && emission.is_some()
}

impl Names {
    /// The names that elements have, and others for those that have none, or one that is taken.
    fn of(scene: &SceneDesc) -> Self {
        let mut meshes: Vec<&str> = vec![""; scene.meshes.len()];
        for (name, number) in &scene.index.meshes {
            if let Some(own) = meshes.get_mut(*number).filter(|own| own.is_empty()) {
                *own = name;
            }
        }
        let material = |material: &MaterialDesc| material.name.clone();
        Self {
            textures: unique("texture", scene.textures.iter().map(|texture| texture.name.clone())),
            materials: unique("material", scene.materials.iter().map(material)),
            meshes: unique("mesh", meshes.into_iter().map(str::to_owned)),
            groups: unique("group", scene.groups.iter().map(|group| group.name.clone())),
        }
    }
}

/// Makes every name the only one. The first that has a name keeps it.
fn unique(kind: &str, names: impl Iterator<Item = String>) -> Vec<String> {
    let mut names: Vec<String> = names.collect();
    let mut taken: HashSet<String> = HashSet::new();
    let is_first: Vec<bool> = names.iter().map(|name| !name.is_empty() && taken.insert(name.clone())).collect();
    for (number, name) in names.iter_mut().enumerate().filter(|(number, _)| !is_first[*number]) {
        let base = if name.is_empty() { kind } else { name.as_str() };
        let free = (number..).map(|number| format!("{base} {number}")).find(|name| !taken.contains(name));
        *name = free.unwrap_or_default();
        taken.insert(name.clone());
    }
    names
}

/// The scene file, up to the size that is read.
struct Out<'a, 'b> {
    file: &'a mut Target<'b>,
    written: u64,
}

impl Write for Out<'_, '_> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        if self.written + bytes.len() as u64 > SIZE_LIMIT {
            let message = format!("the scene file would be larger than the {SIZE_LIMIT} bytes that are read");
            return Err(io::Error::new(io::ErrorKind::FileTooLarge, message));
        }
        let count = self.file.write(bytes)?;
        self.written += count as u64;
        Ok(count)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.file.flush()
    }
}

/// The error of a scene file that cannot be written.
fn failed(error: io::Error) -> Error {
    match error.kind() {
        io::ErrorKind::FileTooLarge => Error::new(ErrorKind::Unsupported, error.to_string()),
        _ => Error::new(ErrorKind::Io, format!("cannot write the scene: {error}")),
    }
    .because(error)
}

/// Writes the text of a scene file, whose images, meshes and webs have these files.
fn document(
    scene: &SceneDesc,
    names: &Names,
    [images, meshes]: [&[String]; 2],
    webs: &WebFiles,
    out: &mut impl Write,
) -> Result<()> {
    out.write_all(b"{\n  \"etendue\": 1").map_err(failed)?;
    member(out, "camera", &camera_keys::write(&scene.camera, &scene.motion)?)?;
    member(out, "render", &render_write::write(&scene.render)?)?;
    let mut lights = List::new("lights");
    for (number, light) in scene.lights.iter().enumerate() {
        let motion = scene.motion.lights.get(&number).map(|motion| &**motion);
        lights.put(out, &light_keys::write(light, webs.of_light(light), motion)?)?;
    }
    for light in &scene.distant_lights {
        lights.put(out, &sky_keys::write_distant(light)?)?;
    }
    if let Some(environment) = &scene.environment {
        lights.put(out, &sky_keys::write_environment(environment, names)?)?;
    }
    lights.end(out)?;
    if let Some(backplate) = &scene.backplate {
        member(out, "backplate", &backplate_keys::write(backplate, names)?)?;
    }
    let mut textures = List::new("textures");
    for (number, texture) in scene.textures.iter().enumerate() {
        textures.put(out, &texture_keys::write(texture, &names.textures[number], &images[number])?)?;
    }
    textures.end(out)?;
    let mut materials = List::new("materials");
    for (number, material) in scene.materials.iter().enumerate() {
        materials.put(out, &material_keys::write(number, material, names)?)?;
    }
    materials.end(out)?;
    let mut list = List::new("meshes");
    for (number, file) in meshes.iter().enumerate().filter(|(_, file)| !file.is_empty()) {
        let keep_degenerate = ply_write::is_degenerate(&scene.meshes[number]);
        let steps = scene.motion.meshes.get(&number).map(|steps| &**steps);
        list.put(out, &surface::write_mesh(&names.meshes[number], file, keep_degenerate, steps)?)?;
    }
    list.end(out)?;
    let text = |surface: &SurfaceDesc, motion: Option<&MotionDesc>| {
        surface::write(surface, emits_both(scene, surface), webs.of_surface(surface), motion, names)
    };
    let mut groups = List::new("groups");
    // Groups that were removed are empty.
    for (number, group) in scene.groups.iter().enumerate().filter(|(_, group)| !group.members.is_empty()) {
        let members: Vec<_> = group.members.iter().map(|member| text(member, None)).collect::<Result<_>>()?;
        groups.put(out, &group_keys::write(&names.groups[number], &members)?)?;
    }
    groups.end(out)?;
    let placements: BTreeMap<usize, &PlacementDesc> =
        scene.placements.iter().map(|placement| (placement.surfaces.start, placement)).collect();
    let mut surfaces = List::new("surfaces");
    let mut written = 0;
    for (number, surface) in scene.surfaces.iter().enumerate() {
        if number < written || surface.hidden {
            continue;
        }
        let placement = placements.get(&number).and_then(|it| Some((it, scene.groups.get(it.group)?)));
        let placed = placement.and_then(|(it, group)| Some((it, group_keys::as_placed(scene, it, group)?)));
        if let Some((placement, (name, motion))) = placed {
            let group = &names.groups[placement.group];
            surfaces.put(out, &group_keys::write_placement(placement, group, name, motion)?)?;
            written = placement.surfaces.end;
            continue;
        }
        let motion = scene.motion.surfaces.get(&number).map(|motion| &**motion);
        surfaces.put(out, &text(surface, motion)?)?;
    }
    surfaces.end(out)?;
    out.write_all(b"\n}\n").map_err(failed)
}

/// Writes a member of the whole.
fn member(out: &mut impl Write, key: &str, value: &RawValue) -> Result<()> {
    write!(out, ",\n  \"{key}\": {}", laid_out(value.get(), 2)).map_err(failed)
}

/// A member of the whole that is a list, and is left out where it is empty.
struct List {
    key: &'static str,
    is_empty: bool,
}

impl List {
    fn new(key: &'static str) -> Self {
        Self { key, is_empty: true }
    }

    /// Writes an element.
    fn put(&mut self, out: &mut impl Write, element: &RawValue) -> Result<()> {
        let key = self.key;
        if self.is_empty { write!(out, ",\n  \"{key}\": [\n    ") } else { write!(out, ",\n    ") }.map_err(failed)?;
        self.is_empty = false;
        out.write_all(laid_out(element.get(), 4).as_bytes()).map_err(failed)
    }

    fn end(&mut self, out: &mut impl Write) -> Result<()> {
        if self.is_empty { Ok(()) } else { out.write_all(b"\n  ]").map_err(failed) }
    }
}
