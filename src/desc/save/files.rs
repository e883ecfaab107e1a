//! The files of meshes and images beside a scene file.

use std::collections::{HashMap, HashSet};
use std::ffi::OsStr;
use std::fs;
use std::io::Write as _;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use super::super::{LightDistribution, PointLightDesc, SceneDesc, SurfaceDesc, TextureSource, WebDesc};
use super::ply_write;
use crate::photometry::Web;
use crate::replace::{self, Target};
use crate::texture::{extension, write_image};
use crate::{Error, ErrorKind, Result};

/// The names of the files of photometric webs, as the scene file has them.
#[derive(Default)]
pub(super) struct WebFiles {
    names: HashMap<*const Web, String>,
}

impl WebFiles {
    /// Names the webs of all lights and surfaces, each once. `name` gets the number of the web among them.
    pub fn named(scene: &SceneDesc, mut name: impl FnMut(usize, &Web) -> Result<String>) -> Result<Self> {
        let mut known = Self::default();
        let of_lights = scene.lights.iter().filter_map(|light| Some((web_of_light(light)?, &light.path)));
        let surfaces = scene.surfaces.iter().chain(scene.members());
        let of_surfaces = surfaces.filter_map(|surface| Some((web_of_surface(surface)?, &surface.path)));
        for (web, path) in of_lights.chain(of_surfaces) {
            if !known.names.contains_key(&Arc::as_ptr(web)) {
                let name = name(known.names.len(), web).map_err(|error| error.at(path))?;
                known.names.insert(Arc::as_ptr(web), name);
            }
        }
        Ok(known)
    }

    /// The name of the file of a light; empty for one without a web.
    pub fn of_light(&self, light: &PointLightDesc) -> &str {
        web_of_light(light).and_then(|web| self.names.get(&Arc::as_ptr(web))).map_or("", String::as_str)
    }

    /// The name of the file of a surface, where it shines by a web.
    pub fn of_surface(&self, surface: &SurfaceDesc) -> Option<&str> {
        web_of_surface(surface).and_then(|web| self.names.get(&Arc::as_ptr(web))).map(String::as_str)
    }
}

fn web_of_light(light: &PointLightDesc) -> Option<&Arc<Web>> {
    match &light.distribution {
        LightDistribution::Web(WebDesc { web, .. }) => Some(web),
        _ => None,
    }
}

/// A web without an emission has no effect, and is not written.
fn web_of_surface(surface: &SurfaceDesc) -> Option<&Arc<Web>> {
    let is_lit = surface.emission.is_some() && !surface.hidden;
    surface.web.as_ref().filter(|_| is_lit).map(|it| &it.web)
}

/// A folder of files. What it has made disappears with it, unless it is told to keep that.
pub(super) struct Files {
    folder: PathBuf,
    /// The name of the folder, as the scene file has it.
    name: String,
    /// Whether the folder was there.
    is_old: bool,
    /// Files that were not there before.
    new: Vec<PathBuf>,
    /// Names of all files of the scene.
    used: HashSet<String>,
    is_kept: bool,
}

impl Files {
    /// The folder of a scene file. It is made with its first file.
    pub fn new(scene: &Path) -> Result<Self> {
        let folder = SceneDesc::files_folder(scene);
        let name = folder.file_name().and_then(OsStr::to_str).ok_or_else(|| {
            let message =
                "the name is not UTF-8, in which a scene file names the files beside it; expected another name";
            Error::new(ErrorKind::Unsupported, message)
        })?;
        let name = name.to_owned();
        let is_old = folder.exists();
        if is_old && !folder.is_dir() {
            let message = "cannot make a folder for the files of the scene: the name is taken by something else";
            return Err(Error::new(ErrorKind::Io, message).in_file(Some(&folder), 0));
        }
        // Files that other scenes have in the folder that it leads to would be removed as old ones of this scene.
        if folder.is_symlink() {
            let message = "the folder for the files of the scene is a symbolic link, expected a folder or nothing";
            return Err(Error::new(ErrorKind::Io, message).in_file(Some(&folder), 0));
        }
        Ok(Self { folder, name, is_old, new: Vec::new(), used: HashSet::new(), is_kept: false })
    }

    /// Writes the images of all textures, each once. Returns the name of the file of each texture, which is empty for a formula.
    pub fn images(&mut self, scene: &SceneDesc) -> Result<Vec<String>> {
        let mut known = HashMap::new();
        let mut names = Vec::new();
        for texture in &scene.textures {
            let TextureSource::Image(it) = &texture.source else {
                names.push(String::new());
                continue;
            };
            let image = &it.image;
            let name = match known.get(&Arc::as_ptr(image)) {
                Some(name) => String::clone(name),
                None => {
                    let number = known.len();
                    let name = self
                        .add("an image", "image", number, extension(image), |file| write_image(image, file))
                        .map_err(|error| error.at(&texture.path))?;
                    known.insert(Arc::as_ptr(image), name.clone());
                    name
                }
            };
            names.push(name);
        }
        Ok(names)
    }

    /// Writes the photometric webs of all lights and surfaces, each once, as they were read.
    pub fn webs(&mut self, scene: &SceneDesc) -> Result<WebFiles> {
        WebFiles::named(scene, |number, web| {
            let failed =
                |error| Error::new(ErrorKind::Io, format!("cannot write a photometric web: {error}")).because(error);
            let encode = |file: &mut Target<'_>| file.write_all(web.text()).map_err(failed);
            self.add("a photometric web", "web", number, web.format().extension(), encode)
        })
    }

    /// Writes the meshes. Returns the name of the file of each, which is empty for one that was removed.
    pub fn meshes(&mut self, scene: &SceneDesc) -> Result<Vec<String>> {
        let mut names = Vec::new();
        for (number, mesh) in scene.meshes.iter().enumerate() {
            if mesh.triangle_count() == 0 {
                names.push(String::new());
                continue;
            }
            let refused = |message| Error::new(ErrorKind::Unsupported, message).at(&mesh.path);
            ply_write::check_size(mesh).map_err(refused)?;
            let failed = |error| Error::new(ErrorKind::Io, format!("cannot write a mesh: {error}")).because(error);
            let encode = |file: &mut Target<'_>| ply_write::write(mesh, file).map_err(failed);
            names.push(self.add("a mesh", "mesh", number, "ply", encode).map_err(|error| error.at(&mesh.path))?);
        }
        Ok(names)
    }

    /// Writes a file and returns its name as the scene file has it.
    fn add(
        &mut self,
        what: &str,
        kind: &str,
        number: usize,
        extension: &str,
        encode: impl FnOnce(&mut Target<'_>) -> Result<()>,
    ) -> Result<String> {
        if !self.folder.exists() {
            fs::create_dir(&self.folder)
                .map_err(|error| Error::io(&self.folder, "cannot make a folder for the files of the scene", error))?;
        }
        let mut name = String::new();
        let (path, is_new) = replace::add(&self.folder, what, encode, |hash| {
            name = format!("{kind}-{number}-{hash:016x}.{extension}");
            name.clone()
        })?;
        if is_new {
            self.new.push(path);
        }
        let in_scene = format!("{}/{name}", self.name);
        self.used.insert(name);
        Ok(in_scene)
    }

    /// Keeps the files, now that the scene file names them, and removes those of an earlier scene file of this name. One that cannot
    /// be removed does no harm.
    pub fn keep(mut self) {
        self.is_kept = true;
        let mut has_removed = false;
        for entry in fs::read_dir(&self.folder).into_iter().flatten().flatten() {
            let name = entry.file_name();
            if name.to_str().is_some_and(|name| is_own(name) && !self.used.contains(name)) {
                has_removed |= fs::remove_file(entry.path()).is_ok();
            }
        }
        if has_removed {
            // Only an empty folder can be removed.
            let _ = fs::remove_dir(&self.folder);
        }
    }
}

impl Drop for Files {
    fn drop(&mut self) {
        if self.is_kept {
            return;
        }
        for file in &self.new {
            let _ = fs::remove_file(file);
        }
        if !self.is_old {
            let _ = fs::remove_dir(&self.folder);
        }
    }
}

/// Whether a file has a name such as [`Files::add`] makes: a kind, a number and 16 digits of a hash.
fn is_own(name: &str) -> bool {
    let Some((stem, extension)) = name.rsplit_once('.') else { return false };
    let parts: Vec<&str> = stem.split('-').collect();
    let [kind, number, hash] = parts[..] else { return false };
    matches!((kind, extension), ("mesh", "ply") | ("image", "png" | "exr") | ("web", "ies" | "ldt"))
        && !number.is_empty()
        && number.bytes().all(|byte| byte.is_ascii_digit())
        && hash.len() == 16
        && hash.bytes().all(|byte| matches!(byte, b'0'..=b'9' | b'a'..=b'f'))
}
