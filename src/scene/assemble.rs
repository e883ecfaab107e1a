//! Assembles the geometry of a scene: the objects that Embree holds, and the list of shapes that rays test before
//! Embree.

use std::collections::{HashMap, HashSet};
use std::sync::Arc;

use super::analytic::{AnalyticGeometry, AnalyticList};
use super::bindings::UnboundGeometry;
use super::cache::MAX_CACHED_TRIANGLES;
use super::cost;
use super::geometry::{Geometry, Part};
use super::groups::{self, GroupObject, WholePlacement, group_address};
use super::instance_transform::InstancePath;
use super::interaction::Triangles;
use super::lower::{self, Lowered, MeshUse};
use super::mesh;
use super::record::{BuildFacts, GeometryRecord, ObjectKey, Objects, address};
use super::singles::{self, OWN_HIERARCHY, Singles};
use super::{BuildOptions, assemble_moving, bindings, frame};
use crate::camera::Camera;
use crate::control::WorkProgress;
use crate::desc::{MeshDesc, SceneDesc, ShapeDesc};
use crate::embree::{self, Device, SceneBuilder, SceneOptions, TriangleMesh, VertexBuffer};
use crate::error::Result;
use crate::math::{Bounds, DAffine3, DVec3};
use crate::room::with_room;
use crate::shape::Triangle;

/// Up to this number of analytic shapes, a list in front of Embree is faster than user geometry inside Embree. The
/// number was measured with `cargo bench --bench spheres`.
const LISTED_SHAPES: usize = 16;

/// The geometry of a scene.
pub(super) struct Assembly {
    pub embree: Option<embree::Scene>,
    pub list: Arc<AnalyticList>,
    pub geometries: Arc<[Geometry]>,
    pub centre: DVec3,
    pub record: Arc<GeometryRecord>,
}

impl Assembly {
    pub(super) fn unbound(&self) -> UnboundGeometry<'_> {
        UnboundGeometry {
            geometries: &self.geometries,
            record: &self.record,
            list: &self.list,
            list_surfaces: &self.record.list_surfaces,
            centre: self.centre,
            bounds: self.record.facts.bounds,
        }
    }
}

/// Builds the geometry of `desc`. Meshes that have hierarchies of their own in `old` are reused from there.
pub(super) fn assemble(
    desc: &SceneDesc,
    options: &BuildOptions,
    is_dynamic: bool,
    device: &Device,
    old: Option<&GeometryRecord>,
    progress: &WorkProgress,
) -> Result<Assembly> {
    progress.expect(first_guess(desc, old));
    // All surfaces are lowered to the world frame, in double precision.
    let mut mesh_bounds = old.map(GeometryRecord::mesh_bounds).unwrap_or_default();
    let lowered = lower::lower(desc, is_dynamic, old, &progress.cancel, |mesh: &Arc<MeshDesc>| {
        match mesh_bounds.get(&address(mesh)) {
            Some(bounds) => Ok(*bounds),
            None => {
                let bounds = mesh::bounds(mesh, progress)?;
                mesh_bounds.insert(address(mesh), bounds);
                Ok(bounds)
            }
        }
    })?;

    // The origin of the scene frame is the camera, or the point of the scene nearest to the camera, so that single
    // precision is finest where its errors are most visible. A huge ground sphere therefore costs no precision in the
    // objects that stand on it.
    let centre = frame::origin(&desc.camera, &lowered.bounds);
    Camera::new(&desc.camera, desc.render.resolution, centre)?;

    let embree = SceneBuilder::cancellable(device, SceneOptions::default(), &progress.cancel)?;
    let copied = lowered.copied.first().map(|&first| (lowered.copied.len(), desc.surfaces[first].path.clone()));
    let facts = BuildFacts { bounds: lowered.bounds, copied, ..BuildFacts::default() };
    let known = old.map_or_else(Objects::default, |old| old.objects.clone());
    let old_singles = old.map_or_else(Singles::default, |old| singles::still_serving(old, desc, centre));
    let mut assembler = Assembler {
        desc,
        device,
        progress,
        centre,
        embree,
        known,
        old_singles,
        singles: Singles { centre, ..Singles::default() },
        is_dynamic,
        mesh_bounds,
        geometries: Vec::new(),
        facts,
    };
    progress.settle(assembler.exact_cost(&lowered));
    assembler.loose_triangles(&lowered)?;
    for mesh_use in &lowered.meshes {
        assembler.flat_mesh(mesh_use)?;
    }
    assembler.instances(&lowered.instances)?;
    assembler.wholes(&lowered.wholes)?;
    assembler.moving(&lowered.moving)?;
    let (list, list_surfaces) = assembler.shapes(&lowered, options.listed_shapes.unwrap_or(LISTED_SHAPES))?;
    assembler.finish(list, list_surfaces, lowered.block_bounds)
}

/// Estimates the units of work when only the sizes of the meshes are known.
fn first_guess(desc: &SceneDesc, old: Option<&GeometryRecord>) -> f64 {
    let mut seen = HashSet::new();
    let mut units = 0.0;
    for (_, surface) in desc.surfaces.meshes() {
        if let ShapeDesc::Mesh { mesh, smooth } = surface.shape
            && let Some(mesh) = desc.meshes.get(mesh)
            && !surface.hidden
            && seen.insert((address(mesh), smooth))
            && !old.is_some_and(|old| old.objects.meshes.contains_key(&(address(mesh), smooth)))
        {
            let triangles = mesh.triangle_count() as f64;
            units += mesh::bounds_cost(mesh) + mesh::place_cost(mesh, smooth) + cost::HIERARCHY * triangles;
        }
    }
    units
}

pub(super) struct Assembler<'a, 'p> {
    pub(super) desc: &'a SceneDesc,
    pub(super) device: &'a Device,
    pub(super) progress: &'a WorkProgress<'p>,
    pub(super) centre: DVec3,
    pub(super) embree: SceneBuilder,
    /// Meshes and groups that already have a hierarchy. The maps grow during assembly.
    known: Objects,
    /// Hierarchies of single surfaces that are still those of the description.
    pub(super) old_singles: Singles,
    /// Hierarchies of single surfaces in this scene.
    pub(super) singles: Singles,
    is_dynamic: bool,
    mesh_bounds: HashMap<usize, Bounds>,
    pub(super) geometries: Vec<Geometry>,
    pub(super) facts: BuildFacts,
}

impl Assembler<'_, '_> {
    fn mesh(&self, mesh_use: &MeshUse) -> &Arc<MeshDesc> {
        &self.desc.meshes[mesh_use.mesh]
    }

    fn key(&self, mesh_use: &MeshUse) -> ObjectKey {
        (address(self.mesh(mesh_use)), mesh_use.smooth)
    }

    /// Returns the units of work that remain.
    fn exact_cost(&self, lowered: &Lowered) -> f64 {
        let of_singles =
            |count: usize, is_there| if is_there { 0.0 } else { (cost::TEST + cost::HIERARCHY) * count as f64 };
        let mut units = of_singles(lowered.shapes, self.old_singles.shapes.is_some());
        units += of_singles(lowered.triangles, self.old_singles.triangles.is_some());
        if self.old_singles.triangles.is_none() {
            units += bindings::triangles_cost(lowered.triangles);
        }
        for mesh_use in &lowered.meshes {
            let mesh = self.mesh(mesh_use);
            let triangles = mesh.triangle_count();
            units += mesh::place_cost(mesh, mesh_use.smooth) + cost::HIERARCHY * triangles as f64;
            if self.desc.surfaces[mesh_use.surface].emission.is_some() {
                units += bindings::triangles_cost(triangles);
            }
        }
        for moving in &lowered.moving {
            units += assemble_moving::cost(self.desc, moving);
        }
        let mut seen = HashSet::new();
        for mesh_use in &lowered.instances {
            if !self.known.meshes.contains_key(&self.key(mesh_use)) && seen.insert(self.key(mesh_use)) {
                let mesh = self.mesh(mesh_use);
                units += mesh::place_cost(mesh, mesh_use.smooth) + cost::HIERARCHY * mesh.triangle_count() as f64;
            }
        }
        units + groups::cost(self.desc, &lowered.wholes, &self.known.groups)
    }

    /// Adds all triangles and quads as one geometry.
    fn loose_triangles(&mut self, lowered: &Lowered) -> Result<()> {
        if self.reuse_triangles()? {
            return Ok(());
        }
        let lowered = lower::triangles(self.desc, lowered, &self.progress.cancel)?;
        let count = lowered.len();
        let charge = self.device.charge(12 * (4 * count + 1))?.map(Arc::new);
        let mut vertices = with_room(3 * count + 1)?;
        let mut parts: Vec<Part> = with_room(count)?;
        let mut dropped: HashMap<u32, usize> = HashMap::new();
        let centre = self.centre;
        self.progress.each(count, cost::TEST, |i| {
            let (corners, part) = &lowered[i];
            let corners = corners.map(|corner| (corner - centre).as_vec3a());
            if Triangle::new(corners).is_some() {
                parts.push(*part);
                vertices.extend(corners.map(|corner| corner.to_array()));
            } else {
                *dropped.entry(part.surface).or_default() += 1;
            }
        })?;
        let dropped: Vec<_> = dropped
            .into_iter()
            .map(|(surface, count)| (count, self.desc.surfaces[surface as usize].path.clone()))
            .collect();
        if parts.is_empty() {
            self.facts.dropped.extend(dropped);
            return Ok(());
        }
        let mut indices = with_room(parts.len())?;
        self.progress.each(parts.len(), 0.0, |i| {
            let i = i as u32;
            indices.push([3 * i, 3 * i + 1, 3 * i + 2]);
        })?;
        let vertices = VertexBuffer::from_vec(vertices, &self.progress.cancel)?;
        let mesh = TriangleMesh::checked(Arc::new(vertices), indices.into(), &self.progress.cancel)?;
        let (normals, original) = (None, None);
        let triangles = Triangles {
            mesh,
            normals,
            later_normals: None,
            any_length: false,
            original,
            swapped: false,
            _charge: charge,
        };
        let parts: Arc<[Part]> = parts.into();
        if self.is_dynamic && parts.len() > OWN_HIERARCHY {
            return self.own_triangles(triangles, parts, dropped);
        }
        self.facts.dropped.extend(dropped);
        self.add_triangles(&triangles)?;
        self.geometries.push(Geometry::Loose { triangles, parts, cache: None });
        Ok(())
    }

    pub(super) fn add_triangles(&mut self, triangles: &Triangles) -> Result<()> {
        self.facts.triangles += triangles.mesh.indices().len();
        self.facts.geometry_bytes += triangles.memory_bytes();
        self.embree.add_triangles(triangles.mesh.clone())?;
        Ok(())
    }

    /// Adds a mesh that is copied into the scene frame.
    fn flat_mesh(&mut self, mesh_use: &MeshUse) -> Result<()> {
        let surface = &self.desc.surfaces[mesh_use.surface];
        let to_scene = DAffine3::from_translation(-self.centre) * surface.to_world();
        let mesh = self.mesh(mesh_use);
        let made = mesh::placed(mesh, mesh_use.smooth, &to_scene, self.device, self.progress)?;
        self.note_dropped(made.dropped, mesh_use);
        let Some(triangles) = made.triangles else { return Ok(()) };
        self.facts.smooth_meshes += usize::from(mesh_use.smooth);
        self.add_triangles(&triangles)?;
        let surface = mesh_use.surface as u32;
        self.geometries.push(Geometry::Flat { triangles, surface, cache: None, moved: None });
        Ok(())
    }

    pub(super) fn note_dropped(&mut self, count: usize, mesh_use: &MeshUse) {
        if count > 0 {
            let path = &self.desc.surfaces[mesh_use.surface].path;
            self.facts.dropped.push((count, format!("{path} ({})", self.mesh(mesh_use).name)));
        }
    }

    /// Adds the meshes with hierarchies of their own. Each hierarchy is built once.
    fn instances(&mut self, uses: &[MeshUse]) -> Result<()> {
        let mut counted = HashSet::new();
        for mesh_use in uses {
            let to_world = self.desc.surfaces[mesh_use.surface].to_world();
            self.instance(mesh_use, &[to_world], &mut counted)?;
        }
        Ok(())
    }

    /// Adds a mesh with a hierarchy of its own, whose transforms to the world at moments evenly spaced are `steps`; one for what
    /// rests. `counted` has the hierarchies that are in the facts.
    pub(super) fn instance(
        &mut self,
        mesh_use: &MeshUse,
        steps: &[DAffine3],
        counted: &mut HashSet<ObjectKey>,
    ) -> Result<()> {
        self.progress.cancel.check()?;
        let key = self.key(mesh_use);
        let object = match self.known.meshes.get(&key) {
            Some(object) => Arc::clone(object),
            None => {
                let mesh = self.mesh(mesh_use);
                let bounds = self.mesh_bounds.get(&key.0).copied().unwrap_or_default();
                let object = Arc::new(mesh::object(mesh, bounds, mesh_use.smooth, self.device, self.progress)?);
                self.known.meshes.insert(key, Arc::clone(&object));
                object
            }
        };
        let is_new = counted.insert(key);
        if is_new {
            self.note_dropped(object.dropped, mesh_use);
        }
        let Some((scene, triangles)) = &object.content else { return Ok(()) };
        let to_scene = |to_world: &DAffine3| {
            DAffine3::from_translation(-self.centre) * *to_world * DAffine3::from_translation(object.middle)
        };
        let steps: Vec<DAffine3> = steps.iter().map(to_scene).collect();
        self.embree
            .add_moving_instance(scene, &steps)
            .map_err(|error| error.at(&self.desc.surfaces[mesh_use.surface].path))?;
        let facts = &mut self.facts;
        facts.instances += 1;
        facts.host_instances += usize::from(self.desc.meshes[mesh_use.mesh].host.is_some());
        if is_new {
            facts.shared_triangles += triangles.mesh.indices().len();
            facts.geometry_bytes += triangles.memory_bytes();
            facts.embree_bytes += scene.hierarchy_bytes();
            facts.smooth_meshes += usize::from(mesh_use.smooth);
        }
        self.geometries.push(Geometry::Instance {
            triangles: triangles.clone(),
            surface: mesh_use.surface as u32,
            instance_path: Arc::new(InstancePath::new(&steps)),
        });
        Ok(())
    }

    /// Adds the placements of groups that are instances as wholes. The hierarchy of each group is built once.
    fn wholes(&mut self, wholes: &[WholePlacement]) -> Result<()> {
        let mut counted = HashSet::new();
        for whole in wholes {
            self.progress.cancel.check()?;
            let placement = whole.desc(self.desc);
            let address = group_address(whole.group(self.desc));
            let object = match self.known.groups.get(&address).filter(|known| known.serves(self.desc, whole)) {
                Some(object) => Arc::clone(object),
                None => {
                    let object = GroupObject::new(self.desc, whole, &self.mesh_bounds, self.device, self.progress)?;
                    let object = Arc::new(object);
                    self.known.groups.insert(address, Arc::clone(&object));
                    object
                }
            };
            let is_new = counted.insert(address);
            let first = placement.surfaces.start;
            if is_new {
                let path = |member: &usize| self.desc.surfaces[first + member].path.clone();
                self.facts.dropped.extend(object.dropped.iter().map(|(member, count)| (*count, path(member))));
            }
            let Some((scene, parts)) = &object.content else { continue };
            let to_scene = DAffine3::from_translation(-self.centre) * placement.transform * object.to_group;
            self.embree.add_instance(scene, &to_scene).map_err(|error| error.at(&placement.path))?;
            // The kernel numbers the parts of an instance from that of the instance on.
            self.embree.skip(parts.len() - 1);
            self.facts.instances += 1;
            self.facts.whole_placements += 1;
            if is_new {
                let count: usize = parts.iter().map(|(_, triangles)| triangles.mesh.indices().len()).sum();
                self.facts.shared_triangles += count;
                self.facts.geometry_bytes += parts.iter().map(|(_, it)| it.memory_bytes()).sum::<usize>();
                self.facts.embree_bytes += scene.hierarchy_bytes();
                self.facts.smooth_meshes += parts.iter().filter(|(_, it)| it.normals.is_some()).count();
            }
            let instance_path = Arc::new(InstancePath::of_group(to_scene));
            for (member, triangles) in parts {
                let (triangles, surface) = (triangles.clone(), (first + member) as u32);
                let instance_path = Arc::clone(&instance_path);
                self.geometries.push(Geometry::Instance { triangles, surface, instance_path });
            }
        }
        if self.facts.whole_placements > 0 {
            self.facts.decisions.push(format!(
                "{} placements are instances of whole groups: the meshes of each group are in one hierarchy",
                self.facts.whole_placements
            ));
        }
        Ok(())
    }

    /// Places the analytic shapes in a list in front of Embree while they are few, and in user geometry when they are
    /// many.
    fn shapes(&mut self, lowered: &Lowered, limit: usize) -> Result<(AnalyticList, Vec<u32>)> {
        let count = lowered.shapes;
        if count > limit {
            self.facts.embree_shapes += count;
            self.facts.decisions.push(format!(
                "{count} analytic shapes are more than {limit}: they go into Embree's tree as user geometry"
            ));
            if self.reuse_shapes()? {
                return Ok((AnalyticList::default(), Vec::new()));
            }
        }
        let lowered = lower::shapes(self.desc, lowered, &self.progress.cancel)?;
        let mut shapes = with_room(count)?;
        self.progress.each(count, cost::TEST, |i| shapes.push(lowered[i].0.in_scene(self.centre)))?;
        let surfaces: Vec<u32> = lowered.iter().map(|(_, surface)| *surface as u32).collect();
        if shapes.len() <= limit {
            self.facts.listed_shapes = shapes.len();
            return Ok((AnalyticList::new(shapes), surfaces));
        }
        let shapes = Arc::new(AnalyticGeometry { start: shapes, moving: Vec::new() });
        if self.is_dynamic && count > OWN_HIERARCHY {
            self.own_shapes(shapes, surfaces.into())?;
        } else {
            self.embree.add_user(shapes.clone())?;
            self.geometries.push(Geometry::Analytic { shapes, surfaces: surfaces.into() });
        }
        Ok((AnalyticList::default(), Vec::new()))
    }

    fn finish(
        mut self,
        list: AnalyticList,
        list_surfaces: Vec<u32>,
        block_bounds: Vec<Option<Bounds>>,
    ) -> Result<Assembly> {
        let embree = if self.geometries.is_empty() {
            None
        } else {
            let primitives = self.facts.triangles + self.facts.embree_shapes;
            let units = cost::HIERARCHY * primitives.saturating_sub(self.singles.count()) as f64;
            let embree = self.embree;
            let embree = self.progress.within(units, |report| embree.commit(Some(report)))?;
            self.facts.embree_bytes += embree.hierarchy_bytes();
            Some(embree)
        };
        // The triangle cache is filled last, so that it takes no memory that the other parts need.
        let mut room = MAX_CACHED_TRIANGLES;
        for geometry in &mut self.geometries {
            self.facts.geometry_bytes += geometry.cache_triangles(&mut room, self.device);
        }
        // Of the meshes with hierarchies, those are kept that any surface names, even a hidden surface.
        let named = |surface: &crate::desc::SurfaceDesc| match surface.shape {
            ShapeDesc::Mesh { mesh, smooth } => Some((address(self.desc.meshes.get(mesh)?), smooth)),
            _ => None,
        };
        let named: HashSet<ObjectKey> = self.desc.surfaces.meshes().filter_map(|(_, surface)| named(surface)).collect();
        self.known.meshes.retain(|key, _| named.contains(key));
        let groups: HashSet<usize> = self.desc.groups.iter().map(group_address).collect();
        self.known.groups.retain(|address, _| groups.contains(address));
        let mut record = GeometryRecord::new(
            self.desc,
            &self.mesh_bounds,
            self.known,
            list_surfaces,
            self.facts,
            self.is_dynamic,
            self.singles,
        );
        record.block_bounds = block_bounds;
        Ok(Assembly {
            embree,
            list: Arc::new(list),
            geometries: self.geometries.into(),
            centre: self.centre,
            record: Arc::new(record),
        })
    }
}
