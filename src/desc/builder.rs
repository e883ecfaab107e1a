//! A scene being put together: names to indices, meshes read once, surfaces checked as they come.

use std::collections::HashMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use super::{BsdfDesc, Dialect, MaterialDesc, MeshDesc, SceneDesc, ShapeDesc, SurfaceDesc, json, obj, validate};
use crate::math::{Bounds, DAffine3, DVec3};
use crate::spectrum::Rgb;
use crate::{Error, ErrorKind, Result};

/// Name of the material of surfaces that only emit.
const BLACK: &str = "(black)";

/// Most warnings that are kept.
const WARNING_LIMIT: usize = 1000;

/// Keeps a warning, unless there are very many already.
pub(super) fn warn(warnings: &mut Vec<String>, message: String) {
    if warnings.len() < WARNING_LIMIT {
        warnings.push(message);
    } else if warnings.len() == WARNING_LIMIT {
        warnings.push("more warnings are left out".to_owned());
    }
}

pub(super) struct Builder<'a> {
    pub scene: SceneDesc,
    base_dir: &'a Path,
    materials: HashMap<String, usize>,
    meshes: HashMap<String, usize>,
    files: HashMap<PathBuf, usize>,
    /// World-independent extent of each mesh, by index.
    extents: Vec<Bounds>,
    black: Option<usize>,
}

impl<'a> Builder<'a> {
    pub fn new(dialect: Dialect, base_dir: &'a Path, file: Option<&Path>) -> Self {
        Self {
            scene: SceneDesc { dialect, file: file.map(Path::to_owned), ..SceneDesc::default() },
            base_dir,
            materials: HashMap::new(),
            meshes: HashMap::new(),
            files: HashMap::new(),
            extents: Vec::new(),
            black: None,
        }
    }

    pub fn warn(&mut self, path: &str, message: &str) {
        warn(&mut self.scene.warnings, format!("{path}: {message}"));
    }

    /// Adds a material, or says false if the name is taken already.
    pub fn add_material(&mut self, material: MaterialDesc) -> bool {
        if self.materials.contains_key(&material.name) {
            return false;
        }
        self.materials.insert(material.name.clone(), self.scene.materials.len());
        self.scene.materials.push(material);
        true
    }

    /// The material of this name.
    pub fn material(&self, path: &str, name: &str) -> Result<usize> {
        self.materials.get(name).copied().ok_or_else(|| {
            let known = self.materials.keys().map(String::as_str);
            Error::invalid(
                path,
                format!("no material named '{}'{}", json::elided(name), json::did_you_mean(name, known)),
            )
        })
    }

    /// What absorbs everything, made when first needed.
    pub fn black(&mut self, path: &str) -> usize {
        *self.black.get_or_insert_with(|| {
            self.scene.materials.push(MaterialDesc {
                name: BLACK.to_owned(),
                path: path.to_owned(),
                bsdf: BsdfDesc::Black,
                survival: None,
            });
            self.scene.materials.len() - 1
        })
    }

    /// Adds a mesh that surfaces can name.
    pub fn name_mesh(&mut self, path: &str, name: &str, mesh: usize) -> Result<()> {
        if self.meshes.insert(name.to_owned(), mesh).is_some() {
            return Err(Error::invalid(path, format!("the mesh name '{}' is given twice", json::elided(name))));
        }
        Ok(())
    }

    /// The mesh of this name.
    pub fn mesh_named(&self, path: &str, name: &str) -> Result<usize> {
        self.meshes.get(name).copied().ok_or_else(|| {
            let known = self.meshes.keys().map(String::as_str);
            Error::invalid(path, format!("no mesh named '{}'{}", json::elided(name), json::did_you_mean(name, known)))
        })
    }

    /// Adds a mesh; its numbers must be checked already.
    pub fn add_mesh(&mut self, mesh: MeshDesc) -> usize {
        self.extents.push(mesh.bounds());
        self.scene.meshes.push(Arc::new(mesh));
        self.scene.meshes.len() - 1
    }

    /// The mesh in an OBJ file, read at its first use.
    pub fn mesh_file(&mut self, path: &str, file: &str) -> Result<usize> {
        if file.is_empty() {
            return Err(Error::invalid(path, "the file name is empty, expected a Wavefront OBJ file"));
        }
        if file.contains('\0') {
            return Err(Error::invalid(path, "the file name holds a zero byte"));
        }
        let file = self.base_dir.join(file);
        let identity = file.canonicalize().unwrap_or_else(|_| file.clone());
        if let Some(mesh) = self.files.get(&identity) {
            return Ok(*mesh);
        }
        if self.scene.file.as_deref().and_then(|scene| scene.canonicalize().ok()).is_some_and(|own| own == identity) {
            return Err(Error::invalid(path, "the mesh file is the scene file itself, expected a Wavefront OBJ file"));
        }
        let mesh = obj::load(&file, path, &mut self.scene.warnings)?;
        let mesh = self.add_mesh(mesh);
        self.files.insert(identity, mesh);
        Ok(mesh)
    }

    /// Adds a surface whose transform has been checked, if it stays where single precision can follow.
    pub fn add_surface(&mut self, surface: SurfaceDesc) -> Result<()> {
        let around = |points: &[DVec3]| points.iter().fold(Bounds::EMPTY, |bounds, p| bounds.include(*p));
        let bounds = match &surface.shape {
            ShapeDesc::Sphere { centre, radius } | ShapeDesc::Disk { centre, radius, .. } => {
                around(&[centre - DVec3::splat(*radius), centre + DVec3::splat(*radius)])
            }
            ShapeDesc::Triangle(vertices) => around(vertices),
            ShapeDesc::Quad(vertices) => around(vertices),
            ShapeDesc::Mesh { mesh, .. } => self.extents.get(*mesh).copied().unwrap_or(Bounds::EMPTY),
            ShapeDesc::Quadric { clip, .. } => *clip,
        };
        validate::extent(&surface.path, &bounds, &surface.to_world())?;
        let quadric = matches!(surface.shape, ShapeDesc::Quadric { .. } | ShapeDesc::Disk { .. });
        if quadric && surface.emission.is_some() {
            let message = "quadrics and disks cannot emit light; use a sphere, triangle, quad or mesh";
            return Err(Error::new(ErrorKind::Unsupported, message).at(json::join(&surface.path, "emission")));
        }
        self.scene.surfaces.push(surface);
        Ok(())
    }

    /// Adds a triangle that emits `radiance` on the side of its normal and reflects nothing.
    pub fn add_area_light(&mut self, path: &str, vertices: [DVec3; 3], radiance: Rgb) -> Result<()> {
        let material = self.black(path);
        self.add_surface(SurfaceDesc {
            path: path.to_owned(),
            shape: ShapeDesc::Triangle(vertices),
            local: DAffine3::IDENTITY,
            transform: DAffine3::IDENTITY,
            material,
            emission: lit(radiance),
            hidden: false,
        })
    }
}

/// No light at all is no emission.
pub(super) fn lit(radiance: Rgb) -> Option<Rgb> {
    (radiance != Rgb::ZERO).then_some(radiance)
}
