//! The description of a whole scene.

use std::path::PathBuf;
use std::sync::Arc;

use super::backplate::BackplateDesc;
use super::camera::CameraDesc;
use super::distant::DistantLightDesc;
use super::environment::EnvironmentDesc;
use super::group::{GroupDesc, PlacementDesc};
use super::index::SceneIndex;
use super::light::PointLightDesc;
use super::material::{Body, MaterialDesc};
use super::motion::SceneMotion;
use super::object::{MeshDesc, SurfaceDesc};
use super::render::RenderDesc;
use super::surfaces::Surfaces;
use super::texture::TextureDesc;

/// A whole scene and its render settings.
#[derive(Clone, Debug, Default)]
pub struct SceneDesc {
    /// The file from which the scene was read, for messages.
    pub file: Option<PathBuf>,
    /// The mesh files that were read.
    pub files: Vec<PathBuf>,
    /// The dialect by whose rules the scene was read.
    pub dialect: Dialect,
    /// The camera.
    pub camera: CameraDesc,
    /// Lights without a surface. Area lights are surfaces with an emission.
    pub lights: Vec<PointLightDesc>,
    /// Textures, named by index from materials.
    pub textures: Vec<Arc<TextureDesc>>,
    /// Light that comes from single directions of infinity.
    pub distant_lights: Vec<DistantLightDesc>,
    /// Light from infinity all around, where there is any.
    pub environment: Option<EnvironmentDesc>,
    /// The picture that the camera sees behind everything, where there is one.
    pub backplate: Option<BackplateDesc>,
    /// Materials, named by index from surfaces.
    pub materials: Vec<MaterialDesc>,
    /// Meshes, named by index from surfaces. One mesh may be used many times. A mesh that is the same `Arc` in the
    /// description of an edited scene is not built again.
    pub meshes: Vec<Arc<MeshDesc>>,
    /// Surfaces that rays can hit. Those that an edited description shares with the one before it are not looked at again.
    pub surfaces: Surfaces,
    /// Groups of surfaces, named by index from placements. A group that is the same `Arc` in the description of an edited scene is not
    /// built again.
    pub groups: Vec<Arc<GroupDesc>>,
    /// Where groups are. The surfaces of each are in `surfaces`.
    pub placements: Vec<PlacementDesc>,
    /// What moves, and when the shutter is open.
    pub motion: SceneMotion,
    /// Render settings, such as resolution, samples and integrator.
    pub render: RenderDesc,
    /// Warnings about the text that was read, such as unknown keys of a report scene or a second definition of a name.
    pub warnings: Vec<String>,
    /// The index by which the calls find elements. A description that is put together by hand has the default index.
    pub index: SceneIndex,
}

impl SceneDesc {
    /// The material of a surface, where it has one that exists.
    pub(crate) fn material_of(&self, surface: &SurfaceDesc) -> Option<&MaterialDesc> {
        self.materials.get(surface.material?)
    }

    /// The number of a surface's material in scenes, in which surfaces without a material have the number after the last.
    pub(crate) fn material_number(&self, surface: &SurfaceDesc) -> usize {
        surface.material.unwrap_or(self.materials.len())
    }

    /// For each material, whether a surface has it. A scene is made for these materials alone; parts of others count as theirs.
    pub(crate) fn used_materials(&self) -> Vec<bool> {
        let mut used = vec![false; self.materials.len()];
        for it in self.surfaces.blocks().flat_map(|block| &block.facts().materials) {
            if let Some(used) = it.material.and_then(|material| used.get_mut(material)) {
                *used = true;
            }
        }
        used
    }

    /// For each material, what fills bodies of it; `None` where it has no inside, or where no surface has it.
    pub(crate) fn bodies(&self) -> Vec<Option<Body>> {
        let used = self.used_materials().into_iter();
        let materials = self.materials.iter().enumerate();
        materials
            .zip(used)
            .map(|((i, material), used)| used.then(|| material.body(&self.materials[..i])).flatten())
            .collect()
    }
}

/// The rules by which a scene file was read.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Dialect {
    /// A native scene, with `"etendue": 1`.
    #[default]
    Native,
    /// A file of the 2017 report's renderer, `mcrt`.
    Mcrt,
}
