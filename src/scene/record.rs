//! The parts of a description that a scene records, so that a later rebuild can tell what changed.

use std::collections::{BTreeMap, HashMap, HashSet};
use std::sync::{Arc, Weak};

use super::groups::GroupObjects;
use super::mesh::MeshObject;
use super::singles::Singles;
use super::textured_emission::{binding_of, texture_of_light};
use crate::desc::{
    DistantLightDesc, EnvironmentDesc, EnvironmentMapDesc, LightDistribution, MeshDesc, MeshStep, MotionDesc,
    PointLightDesc, PortalDesc, SceneDesc, ShapeDesc, SkyDesc, SpectrumDesc, SurfaceBlock, SurfaceDesc, Surfaces,
    TextureChannel, TextureDesc, TextureKey,
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

/// The description from which the geometry of a scene was built. Its parts stay the same as long as the geometry is
/// unchanged.
#[derive(Clone)]
pub(super) struct GeometryRecord {
    /// As they are as the shutter opens, in the last description that had this geometry.
    surfaces: Surfaces,
    movements: Movements,
    meshes: Vec<KnownMesh>,
    /// Boxes of the blocks of surfaces, as [`Lowered::block_bounds`](super::lower::Lowered).
    pub block_bounds: Vec<Option<Bounds>>,
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

/// How a surface moves while the shutter is open.
#[derive(Clone, Default, PartialEq)]
struct SurfaceMovement {
    motion: Option<Arc<MotionDesc>>,
    steps: Option<Arc<[MeshStep]>>,
}

/// How surfaces move.
#[derive(Clone, PartialEq)]
struct Movements {
    /// When the shutter opens and closes, where anything moves.
    interval: Option<[f64; 2]>,
    /// Those that move or deform, by their numbers.
    surfaces: BTreeMap<usize, SurfaceMovement>,
}

impl Movements {
    fn new(desc: &SceneDesc) -> Self {
        let motions = desc.motion.surfaces.iter();
        let moving = |(number, motion): (&usize, &Arc<MotionDesc>)| {
            (*number, SurfaceMovement { motion: Some(Arc::clone(motion)), steps: None })
        };
        let mut surfaces: BTreeMap<usize, SurfaceMovement> = motions.map(moving).collect();
        if !desc.motion.meshes.is_empty() {
            for (number, surface) in desc.surfaces.meshes() {
                if let ShapeDesc::Mesh { mesh, .. } = surface.shape
                    && let Some(steps) = desc.motion.meshes.get(&mesh)
                {
                    surfaces.entry(number).or_default().steps = Some(Arc::clone(steps));
                }
            }
        }
        Self { interval: (!surfaces.is_empty()).then(|| desc.motion.shutter.interval()), surfaces }
    }

    /// Those of the surfaces that a description shows and that are of a kind.
    fn of_kind<'a>(
        &'a self,
        surfaces: &'a Surfaces,
        is_one: impl Fn(&ShapeDesc) -> bool + 'a,
    ) -> impl Iterator<Item = (&'a usize, &'a SurfaceMovement)> {
        let is_such = move |number: usize| surfaces.get(number).is_some_and(|it| !it.hidden && is_one(&it.shape));
        self.surfaces.iter().filter(move |(number, _)| is_such(**number))
    }
}

/// A mesh of the description. The description itself may be dropped; the reference that is stored here keeps the mesh's
/// address from being reused.
#[derive(Clone)]
struct KnownMesh {
    identity: Weak<MeshDesc>,
    bounds: Option<Bounds>,
    /// The whole mesh, where it has texture coordinates or colours.
    whole: Option<Arc<MeshDesc>>,
}

impl KnownMesh {
    /// Those of a description, with the boxes that are known by their addresses.
    fn of_all(desc: &SceneDesc, bounds: &HashMap<usize, Bounds>) -> Vec<Self> {
        let of = |mesh: &Arc<MeshDesc>| Self {
            identity: Arc::downgrade(mesh),
            bounds: bounds.get(&address(mesh)).copied(),
            whole: (mesh.has_uvs() || !mesh.further_uvs.is_empty() || !mesh.colors.is_empty())
                .then(|| Arc::clone(mesh)),
        };
        desc.meshes.iter().map(of).collect()
    }
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
        let (surfaces, movements) = (desc.surfaces.clone(), Movements::new(desc));
        let (meshes, block_bounds) = (KnownMesh::of_all(desc, bounds), Vec::new());
        Self { surfaces, movements, meshes, block_bounds, objects, list_surfaces, facts, is_dynamic, singles }
    }

    /// The record with the surfaces of a description that has its geometry, so that the next one is compared with these.
    pub(super) fn seen_again(self: &Arc<Self>, desc: &SceneDesc) -> Arc<Self> {
        if self.surfaces.unshared(&desc.surfaces).next().is_none() {
            return Arc::clone(self);
        }
        let meshes = KnownMesh::of_all(desc, &self.mesh_bounds());
        let mut again = Self { surfaces: desc.surfaces.clone(), meshes, ..Self::clone(self) };
        // A mesh that is no longer known may leave its address to another one.
        let known: HashSet<usize> = desc.meshes.iter().map(address).collect();
        again.objects.meshes.retain(|(address, _), _| known.contains(address));
        Arc::new(again)
    }

    /// Returns whether `desc` has the recorded geometry: the same shapes in the same places, and the same meshes.
    pub(super) fn is_geometry_of(&self, desc: &SceneDesc) -> bool {
        let is_other = |mesh: usize| !self.is_same_mesh(mesh, mesh, desc);
        let has_others = (0..self.meshes.len()).any(is_other);
        // Those of other blocks are compared in pairs, and may have other numbers.
        let shared = || self.surfaces.blocks().filter(|block| self.surfaces.shares(&desc.surfaces, block.place));
        let is_one = |surface: &SurfaceDesc| {
            !surface.hidden && matches!(surface.shape, ShapeDesc::Mesh { mesh, .. } if is_other(mesh))
        };
        self.surfaces.len() == desc.surfaces.len()
            && self.surfaces.unshared(&desc.surfaces).all(|(_, old, new)| self.is_same(old, new, desc))
            && !(has_others && shared().flat_map(SurfaceBlock::meshes).any(|(_, surface)| is_one(surface)))
            && self.movements == Movements::new(desc)
    }

    /// Returns whether the surfaces of a kind other than meshes are the recorded ones: the same shapes in the same places, with the same
    /// numbers.
    pub(super) fn has_same(&self, desc: &SceneDesc, is_one: fn(&ShapeDesc) -> bool) -> bool {
        let is_there = |surface: &SurfaceDesc| is_one(&surface.shape) && !surface.hidden;
        let is_kept = |(_, old, new): (usize, &SurfaceDesc, &SurfaceDesc)| {
            is_there(old) == is_there(new) && (!is_there(old) || self.is_same(old, new, desc))
        };
        let count = self.surfaces.len();
        let movements = Movements::new(desc);
        count <= desc.surfaces.len()
            && self.surfaces.unshared(&desc.surfaces).all(is_kept)
            && !desc.surfaces.iter().skip(count).any(is_there)
            && self.movements.of_kind(&self.surfaces, is_one).eq(movements.of_kind(&desc.surfaces, is_one))
            && (self.movements.interval == movements.interval
                || movements.of_kind(&desc.surfaces, is_one).next().is_none())
    }

    /// Returns whether a mesh of the record is one of a description.
    fn is_same_mesh(&self, old: usize, new: usize, desc: &SceneDesc) -> bool {
        let (old, new) = (self.meshes.get(old), desc.meshes.get(new));
        old.zip(new).is_some_and(|(a, b)| std::ptr::eq(a.identity.as_ptr(), Arc::as_ptr(b)))
    }

    fn is_same(&self, old: &SurfaceDesc, new: &SurfaceDesc, desc: &SceneDesc) -> bool {
        if old.hidden && new.hidden {
            return true;
        }
        let same_shape = match (old.shape, new.shape) {
            (ShapeDesc::Mesh { mesh: a, smooth: was_smooth }, ShapeDesc::Mesh { mesh: b, smooth }) => {
                // A mesh that emits is copied into the scene frame. Other shapes have the same geometry whether they
                // emit or not.
                self.is_same_mesh(a, b, desc)
                    && was_smooth == smooth
                    && old.emission.is_some() == new.emission.is_some()
            }
            (old, new) => old == new,
        };
        same_shape && old.hidden == new.hidden && old.transform == new.transform && old.local == new.local
    }

    /// The box around the surfaces of a block but its meshes, if a description has this block too and nothing in it moved.
    pub(super) fn block_bounds(&self, surfaces: &Surfaces, place: usize) -> Option<Bounds> {
        self.block_bounds.get(place).copied().flatten().filter(|_| self.surfaces.shares(surfaces, place))
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
        let own = placed.to_world();
        let motion = self.movements.surfaces.get(&(surface as usize)).and_then(|it| it.motion.as_ref());
        let moved = motion.zip(self.movements.interval);
        Some((&placed.shape, moved.map_or(own, |(motion, [open, _])| motion.path().at(open) * own)))
    }

    /// Whether a surface is a quad.
    pub(super) fn is_quad(&self, surface: u32) -> bool {
        self.surfaces.get(surface as usize).is_some_and(|placed| matches!(placed.shape, ShapeDesc::Quad(_)))
    }
}

/// The description from which the tables of owners and emitters were built, apart from the geometry.
#[derive(Debug)]
pub(super) struct AppearanceKey {
    /// With their materials, emissions, photometric webs and spectra.
    surfaces: Surfaces,
    /// Number of materials.
    materials: usize,
    /// The textures that vary emissions, with the numbers of their surfaces; `None` where no material has one.
    emission_textures: Option<Vec<(usize, TextureOfEmission)>>,
    lights: Vec<(DVec3, Rgb, LightDistribution, Option<SpectrumDesc>)>,
    /// Motions of lights, and the shutter's interval where there are any.
    light_motions: (BTreeMap<usize, Arc<MotionDesc>>, Option<[f64; 2]>),
    environment: Option<EnvironmentKey>,
    distant: Vec<DistantLightDesc>,
}

/// A texture that varies an emission, the parameter that it varies, and by which channel.
type TextureOfEmission = (Arc<TextureDesc>, TextureKey, TextureChannel);

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
        let light = |light: &PointLightDesc| {
            (light.position, light.intensity, light.distribution.clone(), light.spectrum.clone())
        };
        Self {
            emission_textures: is_textured.then(|| {
                let lamps = desc.surfaces.of_blocks(|facts| facts.emits);
                lamps.filter_map(|(number, surface)| Some((number, texture_of(surface)?))).collect()
            }),
            surfaces: desc.surfaces.clone(),
            materials: desc.materials.len(),
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
        self.surfaces.len() == other.surfaces.len()
            && self.surfaces.unshared(&other.surfaces).all(|(_, own, other)| shine_alike(own, other))
            && self.emission_textures == other.emission_textures
            && self.lights == other.lights
            && self.light_motions == other.light_motions
            && self.environment == other.environment
            && self.distant == other.distant
    }

    /// The blocks whose surfaces may have other materials than they had in `old`, each said by its number; `None` where all have the same.
    pub(super) fn reclad(&self, old: &Self) -> Option<Vec<bool>> {
        let edited = self.surfaces.unshared(&old.surfaces).filter(|(_, own, old)| own.material != old.material);
        let edited = edited.map(|(number, ..)| Surfaces::place_of(number));
        // Surfaces without a material have the number after the last.
        let is_other =
            |block: &SurfaceBlock<'_>| self.materials != old.materials && block.facts().has(|it| it.is_none());
        let mut reclad = None;
        for place in edited.chain(self.surfaces.blocks().filter(is_other).map(|block| block.place)) {
            reclad.get_or_insert_with(|| vec![false; self.surfaces.blocks().count()])[place] = true;
        }
        reclad
    }

    /// The number of a surface's material.
    pub(super) fn material(&self, surface: u32) -> u32 {
        self.surfaces[surface as usize].material.unwrap_or(self.materials) as u32
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

/// Whether the emissions of two surfaces are the same.
fn shine_alike(one: &SurfaceDesc, other: &SurfaceDesc) -> bool {
    one.emission == other.emission
        && one.emits_both == other.emits_both
        && one.web == other.web
        && one.spectrum == other.spectrum
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::desc::SurfaceLook;
    use crate::scene::{BuildOptions, Scene};

    /// An edit of how surfaces look leaves the geometry as it is; the next one is compared with the surfaces of that edit, of which it shares
    /// all blocks.
    #[test]
    fn what_was_seen_is_not_looked_at_again() {
        let mut desc = SceneDesc::default();
        let look = SurfaceLook { emission: Some(Rgb::ONE), ..SurfaceLook::default() };
        for number in 0..600 {
            let centre = DVec3::new(2.0 * f64::from(number), 0.0, -9.0);
            desc.add_surface(ShapeDesc::Sphere { centre, radius: 0.5 }, DAffine3::IDENTITY, look).unwrap();
        }
        let options = BuildOptions { dynamic: true, ..BuildOptions::default() };
        let first = Scene::build(&desc, &options).unwrap();
        desc.surfaces.iter_mut().for_each(|surface| surface.emission = Some(Rgb::splat(2.0)));
        let unseen = |scene: &Scene, desc: &SceneDesc| scene.record.surfaces.unshared(&desc.surfaces).count();
        assert_eq!(unseen(&first, &desc), 600);
        let second = first.rebuild(&desc, &options).unwrap();
        assert_eq!(unseen(&second, &desc), 0);
        assert!(!Arc::ptr_eq(&first.record, &second.record));
        let third = second.rebuild(&desc, &options).unwrap();
        assert!(Arc::ptr_eq(&second.record, &third.record));
        assert_eq!(third.record.block_bounds, first.record.block_bounds);
    }

    /// A mesh that hidden surfaces alone name is replaced, and then something else is edited: its hierarchy is forgotten with it, for another
    /// mesh may come to have its address.
    #[test]
    fn hierarchies_are_forgotten_with_their_meshes() {
        let sheet = |height: f64| {
            let side = 0..10_u32;
            let corner = |x: u32, y: u32| DVec3::new(f64::from(x), height * f64::from(x * y % 3), -30.0 - f64::from(y));
            let positions = side.clone().flat_map(|y| side.clone().map(move |x| corner(x, y))).collect();
            let cells = (0..9).flat_map(|y| (0..9).map(move |x| 10 * y + x));
            let triangles = cells.flat_map(|i| [[i, i + 1, i + 11], [i, i + 11, i + 10]]).collect();
            Arc::new(MeshDesc { path: "meshes".into(), positions, triangles, ..MeshDesc::default() })
        };
        let mut desc = SceneDesc { meshes: vec![sheet(0.1), sheet(0.2)], ..SceneDesc::default() };
        let look = SurfaceLook { emission: Some(Rgb::ONE), ..SurfaceLook::default() };
        let ball = ShapeDesc::Sphere { centre: DVec3::NEG_Z, radius: 0.5 };
        desc.add_surface(ball, DAffine3::IDENTITY, look).unwrap();
        for mesh in 0..2 {
            let shape = ShapeDesc::Mesh { mesh, smooth: false };
            desc.add_surface(shape, DAffine3::IDENTITY, look).unwrap();
            desc.surfaces[1 + mesh].emission = None;
        }
        let options = BuildOptions { dynamic: true, ..BuildOptions::default() };
        let mut scene = Scene::build(&desc, &options).unwrap();
        let objects = |scene: &Scene| scene.record.objects.meshes.len();
        assert_eq!(objects(&scene), 2);
        desc.surfaces[1].hidden = true;
        scene = scene.rebuild(&desc, &options).unwrap();
        assert_eq!(objects(&scene), 2, "what is hidden may come back");
        desc.meshes[0] = sheet(0.3);
        desc.surfaces[0].emission = Some(Rgb::splat(2.0));
        scene = scene.rebuild(&desc, &options).unwrap();
        let known = |key: &ObjectKey| desc.meshes.iter().any(|mesh| address(mesh) == key.0);
        assert!(scene.record.objects.meshes.keys().all(known));
        assert_eq!(objects(&scene), 1);
    }
}
