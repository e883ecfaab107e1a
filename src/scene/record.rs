//! The parts of a description that a scene records, so that a later rebuild can tell what changed.

use std::collections::{BTreeMap, HashMap};
use std::sync::{Arc, Weak};

use super::groups::GroupObjects;
use super::mesh::MeshObject;
use super::singles::Singles;
use super::textured_emission::{binding_of, texture_of_light};
use crate::desc::{
    AreaWebDesc, DistantLightDesc, EnvironmentDesc, EnvironmentMapDesc, LightDistribution, MeshDesc, MeshStep,
    MotionDesc, PointLightDesc, PortalDesc, SceneDesc, ShapeDesc, SkyDesc, SpectrumDesc, SurfaceDesc, TextureChannel,
    TextureDesc, TextureKey,
};
use crate::math::{Bounds, DAffine3, DVec3};
use crate::spectrum::Rgb;

/// A mesh, identified by its address, and whether it is smooth. While a record refers to the mesh, no other mesh can
/// have that address.
pub(super) type ObjectKey = (usize, bool);

/// Returns the address that distinguishes the mesh from all others.
pub(super) fn address(mesh: &Arc<MeshDesc>) -> usize {
    Arc::as_ptr(mesh).addr()
}

/// What has a hierarchy of its own.
#[derive(Clone, Default)]
pub(super) struct Objects {
    /// Meshes: those in use, and those of hidden surfaces that were in use before.
    pub meshes: HashMap<ObjectKey, Arc<MeshObject>>,
    /// Groups that are placed as wholes, and those that were before.
    pub groups: GroupObjects,
}

/// The description from which the geometry of a scene was built. The record stays the same object as long as the
/// geometry is unchanged.
pub(super) struct GeometryRecord {
    surfaces: Vec<SurfaceKey>,
    meshes: Vec<KnownMesh>,
    pub objects: Objects,
    /// The number of the surface of each shape in the list.
    pub list_surfaces: Vec<u32>,
    pub facts: BuildFacts,
    pub is_dynamic: bool,
    /// Hierarchies of single triangles and shapes.
    pub singles: Singles,
}

/// The figures of the geometry; see [`super::SceneInfo`].
#[derive(Clone, Debug, Default)]
pub(super) struct BuildFacts {
    pub triangles: usize,
    pub instances: usize,
    pub host_instances: usize,
    pub whole_placements: usize,
    pub shared_triangles: usize,
    pub listed_shapes: usize,
    pub embree_shapes: usize,
    pub smooth_meshes: usize,
    pub bounds: Bounds,
    pub geometry_bytes: usize,
    pub embree_bytes: usize,
    pub decisions: Vec<String>,
    /// The number of uses of meshes that are copies because of their transforms, and the path of the first one.
    pub copied: Option<(usize, String)>,
    /// The numbers of degenerate triangles, each with the path of its surface.
    pub dropped: Vec<(usize, String)>,
    /// The number of surfaces that move or deform while the shutter is open.
    pub moving: usize,
    /// Surfaces that the kernel's moments show farther from their places than they should be, each with by how much of its size.
    pub coarse: Vec<(f64, String)>,
}

/// The properties of a surface on which the geometry depends.
struct SurfaceKey {
    shape: ShapeDesc,
    local: DAffine3,
    transform: DAffine3,
    hidden: bool,
    emits: bool,
    movement: Option<SurfaceMovement>,
}

/// How a surface moves while the shutter is open.
#[derive(PartialEq)]
struct SurfaceMovement {
    interval: [f64; 2],
    motion: Option<Arc<MotionDesc>>,
    steps: Option<Arc<[MeshStep]>>,
}

impl SurfaceMovement {
    fn new(desc: &SceneDesc, number: usize) -> Option<Self> {
        let motion = desc.motion.surfaces.get(&number).cloned();
        let steps = match desc.surfaces[number].shape {
            ShapeDesc::Mesh { mesh, .. } => desc.motion.meshes.get(&mesh).cloned(),
            _ => None,
        };
        (motion.is_some() || steps.is_some()).then(|| {
            let interval = desc.motion.shutter.interval();
            Self { interval, motion, steps }
        })
    }
}

/// A mesh of the description. The description itself may be dropped; the reference that is stored here keeps the mesh's
/// address from being reused.
struct KnownMesh {
    identity: Weak<MeshDesc>,
    bounds: Option<Bounds>,
    /// The whole mesh, where it has texture coordinates or colours.
    whole: Option<Arc<MeshDesc>>,
}

impl GeometryRecord {
    pub(super) fn new(
        desc: &SceneDesc,
        bounds: &HashMap<usize, Bounds>,
        objects: Objects,
        list_surfaces: Vec<u32>,
        facts: BuildFacts,
        is_dynamic: bool,
        singles: Singles,
    ) -> Self {
        let surfaces = (0..desc.surfaces.len()).map(|number| SurfaceKey::new(desc, number)).collect();
        let meshes = desc
            .meshes
            .iter()
            .map(|mesh| KnownMesh {
                identity: Arc::downgrade(mesh),
                bounds: bounds.get(&address(mesh)).copied(),
                whole: (mesh.has_uvs() || !mesh.further_uvs.is_empty() || !mesh.colors.is_empty())
                    .then(|| Arc::clone(mesh)),
            })
            .collect();
        Self { surfaces, meshes, objects, list_surfaces, facts, is_dynamic, singles }
    }

    /// Returns whether `desc` has the recorded geometry: the same shapes in the same places, and the same meshes.
    pub(super) fn is_geometry_of(&self, desc: &SceneDesc) -> bool {
        self.surfaces.len() == desc.surfaces.len()
            && self.surfaces.iter().zip(&desc.surfaces).all(|(old, new)| self.is_same(old, new, desc))
            && self.surfaces.iter().enumerate().all(|(number, old)| old.movement == SurfaceMovement::new(desc, number))
    }

    /// Returns whether the surfaces of a kind are the recorded ones: the same shapes in the same places, with the same numbers.
    pub(super) fn has_same(&self, desc: &SceneDesc, is_one: impl Fn(&ShapeDesc) -> bool) -> bool {
        let is_there = |surface: &SurfaceDesc| is_one(&surface.shape) && !surface.hidden;
        let (new, added) = desc.surfaces.split_at(self.surfaces.len().min(desc.surfaces.len()));
        let is_kept = |(number, (old, new)): (usize, (&SurfaceKey, &SurfaceDesc))| {
            let was_there = is_one(&old.shape) && !old.hidden;
            was_there == is_there(new)
                && (!was_there || self.is_same(old, new, desc) && old.movement == SurfaceMovement::new(desc, number))
        };
        self.surfaces.len() <= desc.surfaces.len()
            && self.surfaces.iter().zip(new).enumerate().all(is_kept)
            && !added.iter().any(is_there)
    }

    fn is_same(&self, old: &SurfaceKey, new: &SurfaceDesc, desc: &SceneDesc) -> bool {
        if old.hidden && new.hidden {
            return true;
        }
        let same_shape = match (old.shape, new.shape) {
            (ShapeDesc::Mesh { mesh: a, smooth: was_smooth }, ShapeDesc::Mesh { mesh: b, smooth }) => {
                let (old_mesh, new_mesh) = (self.meshes.get(a), desc.meshes.get(b));
                let same_mesh =
                    old_mesh.zip(new_mesh).is_some_and(|(a, b)| std::ptr::eq(a.identity.as_ptr(), Arc::as_ptr(b)));
                // A mesh that emits is copied into the scene frame. Other shapes have the same geometry whether they
                // emit or not.
                same_mesh && was_smooth == smooth && old.emits == new.emission.is_some()
            }
            (old, new) => old == new,
        };
        same_shape && old.hidden == new.hidden && old.transform == new.transform && old.local == new.local
    }

    /// The boxes of all meshes that were examined, by address.
    pub(super) fn mesh_bounds(&self) -> HashMap<usize, Bounds> {
        let known = |mesh: &KnownMesh| Some((mesh.identity.as_ptr().addr(), mesh.bounds?));
        self.meshes.iter().filter_map(known).collect()
    }

    /// The mesh of a surface, where the mesh has texture coordinates.
    pub(super) fn uv_mesh(&self, surface: u32) -> Option<&MeshDesc> {
        self.whole_mesh(surface).filter(|mesh| mesh.has_uvs())
    }

    /// The mesh of a surface, where the mesh has texture coordinates or colours.
    pub(super) fn whole_mesh(&self, surface: u32) -> Option<&MeshDesc> {
        match self.surfaces.get(surface as usize)?.shape {
            ShapeDesc::Mesh { mesh, .. } => self.meshes.get(mesh)?.whole.as_deref(),
            _ => None,
        }
    }

    /// The shape of a surface in its own frame, and the transform of that frame to the world as the shutter opens.
    pub(super) fn placed(&self, surface: u32) -> Option<(&ShapeDesc, DAffine3)> {
        let placed = self.surfaces.get(surface as usize)?;
        Some((&placed.shape, placed.to_world()))
    }

    /// Whether a surface is a quad.
    pub(super) fn is_quad(&self, surface: u32) -> bool {
        self.surfaces.get(surface as usize).is_some_and(|placed| matches!(placed.shape, ShapeDesc::Quad(_)))
    }
}

impl SurfaceKey {
    fn new(desc: &SceneDesc, number: usize) -> Self {
        let surface = &desc.surfaces[number];
        Self {
            shape: surface.shape,
            local: surface.local,
            transform: surface.transform,
            hidden: surface.hidden,
            emits: surface.emission.is_some(),
            movement: SurfaceMovement::new(desc, number),
        }
    }

    /// The transform of the shape's frame to the world as the shutter opens.
    fn to_world(&self) -> DAffine3 {
        let own = self.transform * self.local;
        let moved = self.movement.as_ref().and_then(|it| Some((it.motion.as_ref()?, it.interval[0])));
        moved.map_or(own, |(motion, open)| motion.path().at(open) * own)
    }
}

/// The description from which the tables of owners and emitters were built, apart from the geometry.
#[derive(Debug)]
pub(super) struct AppearanceKey {
    /// Material of each surface.
    pub materials: Vec<u32>,
    /// Emission of each surface, and whether it is on both sides.
    emissions: Vec<(Option<Rgb>, bool)>,
    /// Photometric webs of surfaces, by their numbers.
    webs: Vec<(usize, Arc<AreaWebDesc>)>,
    /// The textures that vary emissions, of each surface; empty where there are none.
    emission_textures: Vec<Option<(Arc<TextureDesc>, TextureKey, TextureChannel)>>,
    /// Spectra of emissions, by the numbers of surfaces.
    spectra: Vec<(usize, SpectrumDesc)>,
    lights: Vec<(DVec3, Rgb, LightDistribution, Option<SpectrumDesc>)>,
    /// Motions of lights, and the shutter's interval where there are any.
    light_motions: (BTreeMap<usize, Arc<MotionDesc>>, Option<[f64; 2]>),
    environment: Option<EnvironmentKey>,
    distant: Vec<DistantLightDesc>,
}

/// The description of light from infinity, apart from its path.
#[derive(Debug, PartialEq)]
struct EnvironmentKey {
    radiance: Rgb,
    /// The texture itself, if it has one, and what else is said of it.
    texture: Option<Arc<TextureDesc>>,
    sky: SkyDesc,
    visible: bool,
    portals: Vec<PortalDesc>,
    spectrum: Option<SpectrumDesc>,
}

impl EnvironmentKey {
    fn new(desc: &SceneDesc, environment: &EnvironmentDesc) -> Self {
        let EnvironmentDesc { radiance, ref sky, visible, .. } = *environment;
        let texture = environment.map().and_then(|map| desc.textures.get(map.texture).cloned());
        let sky = match sky {
            SkyDesc::Map(map) => SkyDesc::Map(EnvironmentMapDesc { texture: 0, ..*map }),
            other => other.clone(),
        };
        Self {
            radiance,
            texture,
            sky,
            visible,
            portals: environment.portals.clone(),
            spectrum: environment.spectrum.clone(),
        }
    }
}

impl AppearanceKey {
    pub(super) fn new(desc: &SceneDesc) -> Self {
        let is_textured = desc.materials.iter().any(|material| texture_of_light(material).is_some());
        let texture_of = |surface: &SurfaceDesc| {
            let binding = binding_of(desc, surface)?;
            Some((Arc::clone(desc.textures.get(binding.texture)?), binding.key, binding.channel))
        };
        let web = |(number, surface): (usize, &SurfaceDesc)| Some((number, Arc::clone(surface.web.as_ref()?)));
        let light = |light: &PointLightDesc| {
            (light.position, light.intensity, light.distribution.clone(), light.spectrum.clone())
        };
        let spectrum = |(number, surface): (usize, &SurfaceDesc)| Some((number, surface.spectrum.clone()?));
        Self {
            emission_textures: if is_textured { desc.surfaces.iter().map(texture_of).collect() } else { Vec::new() },
            materials: desc.surfaces.iter().map(|surface| desc.material_number(surface) as u32).collect(),
            emissions: desc.surfaces.iter().map(|surface| (surface.emission, surface.emits_both)).collect(),
            webs: desc.surfaces.iter().enumerate().filter_map(web).collect(),
            spectra: desc.surfaces.iter().enumerate().filter_map(spectrum).collect(),
            lights: desc.lights.iter().map(light).collect(),
            light_motions: (
                desc.motion.lights.clone(),
                (!desc.motion.lights.is_empty()).then(|| desc.motion.shutter.interval()),
            ),
            environment: desc.environment.as_ref().map(|environment| EnvironmentKey::new(desc, environment)),
            distant: desc
                .distant_lights
                .iter()
                .map(|it| DistantLightDesc { path: String::new(), ..it.clone() })
                .collect(),
        }
    }

    /// Returns whether both descriptions have the same emitters with the same radiance or intensity.
    pub(super) fn has_same_emitters(&self, other: &Self) -> bool {
        self.emissions == other.emissions
            && self.webs == other.webs
            && self.spectra == other.spectra
            && self.emission_textures == other.emission_textures
            && self.lights == other.lights
            && self.light_motions == other.light_motions
            && self.environment == other.environment
            && self.distant == other.distant
    }

    /// Whether both descriptions have the same light from infinity.
    pub(super) fn has_same_environment(&self, other: &Self) -> bool {
        self.environment == other.environment
    }

    /// The number of point lights that give no light.
    pub(super) fn dark_lights(&self) -> usize {
        self.lights.iter().filter(|(_, intensity, ..)| *intensity == Rgb::ZERO).count()
    }
}
