//! The state of reading a scene file: it resolves names to numbers and reads every mesh file once.

use std::collections::{HashMap, HashSet};
use std::path::{Path, PathBuf};
use std::sync::Arc;

use super::warnings::warn;
use super::{
    Dialect, MeshDesc, SceneDesc, ShapeDesc, SpectrumDesc, SurfaceLook, json, mesh_files, spectrum_file, validate,
};
use crate::control::WorkProgress;
use crate::math::DVec3;
use crate::photometry::Web;
use crate::texture::{ColorSpace, ImageSource, ReadImage, ReadingTogether, TexelImage, read_image, read_images};
use crate::{Error, Result};

/// The texels of an image file, and the colour space that its format suggests.
type KnownImage = (Arc<TexelImage>, ColorSpace);

pub(super) struct Builder<'a> {
    pub scene: SceneDesc,
    base_dir: &'a Path,
    work: &'a WorkProgress<'static>,
    /// Meshes by their files, and by whether their degenerate triangles are kept.
    files: HashMap<(PathBuf, bool), usize>,
    images: HashMap<PathBuf, KnownImage>,
    webs: HashMap<PathBuf, Arc<Web>>,
    spectra: HashMap<PathBuf, SpectrumDesc>,
    /// The parts of the files whose own materials are used: pairs of a material and a mesh.
    divided_files: HashMap<PathBuf, Vec<[usize; 2]>>,
}

impl<'a> Builder<'a> {
    pub fn new(dialect: Dialect, base_dir: &'a Path, file: Option<&Path>, work: &'a WorkProgress<'static>) -> Self {
        let scene = SceneDesc { dialect, file: file.map(Path::to_owned), ..SceneDesc::default() };
        Self {
            scene,
            base_dir,
            work,
            files: HashMap::new(),
            images: HashMap::new(),
            webs: HashMap::new(),
            spectra: HashMap::new(),
            divided_files: HashMap::new(),
        }
    }

    pub fn warn(&mut self, path: &str, message: &str) {
        warn(&mut self.scene.warnings, format!("{path}: {message}"));
    }

    /// Returns the number of the material with this name.
    pub fn material(&self, path: &str, name: &str) -> Result<usize> {
        self.scene.find_material(name).ok_or_else(|| {
            let known = self.scene.index.materials.keys().map(String::as_str);
            let hint = json::did_you_mean(name, known);
            Error::invalid(path, format!("no material named '{}'{hint}", json::elided(name)))
        })
    }

    /// Returns the number of a material that another one consists of, which has to come before it.
    pub fn part(&self, path: &str, name: &str) -> Result<usize> {
        self.material(path, name).map_err(|error| {
            let message = format!("{} among the materials before this one", error.message());
            Error::invalid(path, message)
        })
    }

    /// Returns the number of the mesh with this name.
    pub fn mesh_named(&self, path: &str, name: &str) -> Result<usize> {
        self.scene.find_mesh(name).ok_or_else(|| {
            let known = self.scene.index.meshes.keys().map(String::as_str);
            let hint = json::did_you_mean(name, known);
            Error::invalid(path, format!("no mesh named '{}'{hint}", json::elided(name)))
        })
    }

    /// Returns the number of the group with this name.
    pub fn group(&self, path: &str, name: &str) -> Result<usize> {
        self.scene.find_group(name).ok_or_else(|| {
            let known = self.scene.index.groups.keys().map(String::as_str);
            let hint = json::did_you_mean(name, known);
            Error::invalid(path, format!("no group named '{}'{hint}", json::elided(name)))
        })
    }

    /// Returns the number of the texture with this name.
    pub fn texture(&self, path: &str, name: &str) -> Result<usize> {
        self.scene.find_texture(name).ok_or_else(|| {
            let known = self.scene.index.textures.keys().map(String::as_str);
            let hint = json::did_you_mean(name, known);
            Error::invalid(path, format!("no texture named '{}'{hint}", json::elided(name)))
        })
    }

    /// Reads these image files, several at a time, for [`Self::image_file`], which reads those again that cannot be read: its error
    /// has the name that the scene has.
    pub fn read_ahead(&mut self, names: &[String]) -> Result<()> {
        let mut known = HashSet::new();
        let (identities, files): (Vec<_>, Vec<_>) = names
            .iter()
            .filter(|name| is_file_name(name))
            .map(|name| self.base_dir.join(name))
            .map(|file| (identity(&file), file))
            .filter(|(identity, _)| known.insert(identity.clone()))
            .unzip();
        let sources: Vec<_> = files.iter().map(|file| ImageSource::File(file.into())).collect();
        let how = ReadingTogether { most_texels: u64::MAX, stops_at_error: true };
        let read = read_images(&sources, how, self.work)?;
        for ((file, identity), read) in files.into_iter().zip(identities).zip(read) {
            if let Some(Ok(read)) = read {
                self.keep_image(file, identity, read);
            }
        }
        Ok(())
    }

    fn keep_image(&mut self, file: PathBuf, identity: PathBuf, (image, space): ReadImage) -> KnownImage {
        let image = (Arc::new(image), space);
        self.scene.files.push(file);
        self.images.insert(identity, image.clone());
        image
    }

    /// Returns the path of an image, its texels, and the colour space that its format suggests. The file is read at its first use.
    pub fn image_file(&mut self, path: &str, file: &str) -> Result<(PathBuf, Arc<TexelImage>, ColorSpace)> {
        if !is_file_name(file) {
            return Err(Error::invalid(path, "not a file name, expected that of an image"));
        }
        let file = self.base_dir.join(file);
        let identity = identity(&file);
        let (image, space) = match self.images.get(&identity) {
            Some(known) => known.clone(),
            None => {
                let read = read_image(&file).map_err(|error| error.at(path))?;
                self.keep_image(file.clone(), identity, read)
            }
        };
        Ok((file, image, space))
    }

    /// Returns a photometric web. The file is read at its first use.
    pub fn web_file(&mut self, path: &str, file: &str) -> Result<Arc<Web>> {
        self.work.check()?;
        if !is_file_name(file) {
            return Err(Error::invalid(path, "not a file name, expected that of a photometric web"));
        }
        let file = self.base_dir.join(file);
        let identity = identity(&file);
        if let Some(web) = self.webs.get(&identity) {
            return Ok(Arc::clone(web));
        }
        let web = Arc::new(Web::read(&file).map_err(|error| error.at(path))?);
        self.scene.files.push(file);
        self.webs.insert(identity, Arc::clone(&web));
        Ok(web)
    }

    /// Returns the samples of a spectrum in a file, which is read at its first use.
    pub fn spectrum_file(&mut self, path: &str, file: &str) -> Result<SpectrumDesc> {
        self.work.check()?;
        if !is_file_name(file) {
            return Err(Error::invalid(path, "not a file name, expected that of a spectrum"));
        }
        let file = self.base_dir.join(file);
        let identity = identity(&file);
        if let Some(known) = self.spectra.get(&identity) {
            return Ok(known.clone());
        }
        let spectrum = SpectrumDesc::samples(path, spectrum_file::read(&file, path)?)
            .map_err(|error| error.in_file(Some(&file), 0))?;
        self.scene.files.push(file);
        self.spectra.insert(identity, spectrum.clone());
        Ok(spectrum)
    }

    /// Adds a mesh that is given inside the scene file.
    pub fn add_mesh(&mut self, mesh: MeshDesc) -> Result<usize> {
        validate::mesh(&mesh.path, &mesh)?;
        Ok(self.scene.put_mesh(mesh))
    }

    /// Returns the number of the mesh in a file, with or without its degenerate triangles. The file is read at its first use.
    pub fn mesh_file(&mut self, path: &str, file: &str, keep_degenerate: bool) -> Result<usize> {
        self.work.check()?;
        let [file, identity] = self.identified(path, file)?;
        let identity = (identity, keep_degenerate);
        if let Some(mesh) = self.files.get(&identity) {
            return Ok(*mesh);
        }
        let mesh = mesh_files::load(&file, path, keep_degenerate, &mut self.scene.warnings, self.work)?;
        let mesh = self.scene.put_mesh(mesh);
        self.scene.files.push(file);
        self.files.insert(identity, mesh);
        Ok(mesh)
    }

    /// A mesh of its own with what is in this mesh, which was read from a file when there were `before` meshes: itself, if it is new,
    /// of which other uses of the file then know nothing.
    pub fn own_mesh(&mut self, mesh: usize, before: usize) -> usize {
        if mesh < before {
            return self.scene.put_mesh(MeshDesc::clone(&self.scene.meshes[mesh]));
        }
        self.files.retain(|_, known| *known != mesh);
        mesh
    }

    /// Returns the numbers of the materials and meshes of an OBJ file that is divided by its own materials. The file is read at
    /// its first use.
    pub fn divided_file(&mut self, path: &str, file: &str) -> Result<Vec<[usize; 2]>> {
        let [file, identity] = self.identified(path, file)?;
        if let Some(parts) = self.divided_files.get(&identity) {
            return Ok(parts.clone());
        }
        let parts = mesh_files::load_parts(&file, path, &mut self.scene.warnings, self.work)?;
        let parts = self.scene.put_parts(&file, parts)?;
        self.divided_files.insert(identity, parts.clone());
        Ok(parts)
    }

    /// Returns the path of a mesh file, and the path by which it is known again.
    fn identified(&self, path: &str, file: &str) -> Result<[PathBuf; 2]> {
        mesh_files::check_name(path, Path::new(file))?;
        let file = self.base_dir.join(file);
        let identity = identity(&file);
        if self.scene.file.as_deref().and_then(|scene| scene.canonicalize().ok()).is_some_and(|own| own == identity) {
            return Err(Error::invalid(path, "the mesh file is the scene file itself, expected another file"));
        }
        Ok([file, identity])
    }

    /// Adds a triangle that emits radiance `color` times `factor` on the side of its normal and reflects nothing.
    pub fn add_area_light(
        &mut self,
        path: &str,
        vertices: [DVec3; 3],
        (color, factor): ([f64; 3], f64),
        spectrum: Option<SpectrumDesc>,
    ) -> Result<()> {
        let at = |key: &str| json::join(path, key);
        let factor = validate::intensity(&at("intensity"), factor)?;
        let (shape, local) = ShapeDesc::triangle(vertices).map_err(json::below(path))?;
        let emission = Some(validate::emission(&at("color"), color, factor)?);
        let look = SurfaceLook { emission, ..SurfaceLook::default() };
        let surface = self.scene.put_surface(path, shape, local, look)?;
        self.scene.set_surface_spectrum(surface, spectrum)
    }
}

/// The path by which a file is known again, whatever it is called.
pub(super) fn identity(file: &Path) -> PathBuf {
    file.canonicalize().unwrap_or_else(|_| file.to_owned())
}

/// Whether a file can have this name.
fn is_file_name(file: &str) -> bool {
    !file.is_empty() && !file.contains('\0')
}
