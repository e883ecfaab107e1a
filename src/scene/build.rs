//! From a description to a scene, step by step.

use std::collections::HashMap;
use std::collections::hash_map::Entry;
use std::sync::Arc;
use std::time::Instant;

use super::analytic::{AnalyticGeometry, AnalyticList};
use super::geometry::{self, Geometry, NO_EMITTER, Owner, Owners, Placement, Triangles};
use super::lower::{self, Lowered, MeshUse};
use super::{Material, Scene, SceneInfo};
use crate::Cancel;
use crate::bsdf::Bsdf;
use crate::camera::Camera;
use crate::desc::{CameraDesc, MeshDesc, SceneDesc};
use crate::embree::{Device, DeviceOptions, SceneBuilder, SceneOptions, TriangleMesh};
use crate::emitter::{Emitter, EmitterSet, SphereEmitter, TriangleEmitter};
use crate::error::{Error, Result};
use crate::math::{DAffine3, DVec3, Vec3};
use crate::shape::{Analytic, Triangle};
use crate::spectrum::Rgb;

/// How to build a scene; nothing here changes an image.
#[derive(Clone, Default)]
pub struct BuildOptions {
    /// Threads for Embree's builds; 0 means one per core. Not used where a device is given.
    pub threads: usize,
    /// Embree's device; `None` opens one for the scene.
    pub device: Option<Device>,
    /// Whether geometry will be changed, added or removed later: larger meshes then get hierarchies of their own, so that
    /// [`Scene::rebuild`] touches only what changed, at some cost for each ray.
    pub dynamic: bool,
    /// Stops the build with [`crate::ErrorKind::Cancelled`].
    pub cancel: Cancel,
    /// Told the finished fraction, which only grows, from one thread at a time; must not use the device.
    pub progress: Option<Arc<dyn Fn(f64) + Send + Sync>>,
    /// Fixes how many analytic shapes may be tested in a list before Embree; more become user geometry. `None` lets the
    /// library choose. For measurements.
    pub listed_shapes: Option<usize>,
}

/// Up to this many analytic shapes a list in front of Embree is faster than user geometry inside it.
/// Measured with `cargo bench --bench spheres`.
const LISTED_SHAPES: usize = 16;

/// Extents of a scene for which products of three lengths, and the kernel's tests with them, stay in range.
const SAFE_SIZES: std::ops::RangeInclusive<f64> = 1e-8..=1e9;

impl Scene {
    /// Builds the scene of a description.
    ///
    /// Afterwards the following cannot occur: an unresolved name, a vertex that is not finite, an index out of range, a
    /// degenerate triangle, an emitter without area, a shape without bounds.
    ///
    /// # Errors
    /// [`crate::ErrorKind::InvalidScene`] or `Unsupported` with the JSON path for what cannot be rendered; `Device` or
    /// `OutOfMemory` from Embree.
    pub fn build(desc: &SceneDesc, options: &BuildOptions) -> Result<Self> {
        let file = desc.file.as_deref();
        Builder::new(desc, options).build().map_err(|error| error.in_file(file, 0))
    }
}

struct Builder<'a> {
    desc: &'a SceneDesc,
    options: &'a BuildOptions,
    emitters: Vec<Emitter>,
    geometries: Vec<Geometry>,
    info: SceneInfo,
    /// Degenerate triangles: how many of which surface.
    dropped: Vec<(usize, String)>,
    dark: usize,
}

impl<'a> Builder<'a> {
    fn new(desc: &'a SceneDesc, options: &'a BuildOptions) -> Self {
        Self {
            desc,
            options,
            emitters: Vec::new(),
            geometries: Vec::new(),
            info: SceneInfo::default(),
            dropped: Vec::new(),
            dark: 0,
        }
    }

    fn build(mut self) -> Result<Scene> {
        let start = Instant::now();
        let desc = self.desc;

        // Everything in the world frame, in double precision.
        let lowered = lower::lower(desc)?;

        // The frame in which single precision is spent where it shows most: around the camera, or the point of the scene
        // nearest to it. A huge ground sphere thus costs no digits of what stands on it.
        let centre = frame_origin(desc, &lowered);
        Camera::new(&desc.camera, desc.render.resolution, centre)?;

        let materials = desc
            .materials
            .iter()
            .map(|material| Material { bsdf: Bsdf::new(&material.bsdf), survival: material.survival })
            .collect();

        let threads = match self.options.threads {
            0 => std::thread::available_parallelism().map_or(1, usize::from),
            threads => threads,
        };
        let device = Device::new(&DeviceOptions { threads, ..DeviceOptions::default() })?;
        let mut embree = SceneBuilder::new(&device, SceneOptions::default())?;

        self.point_lights(centre)?;
        self.loose_triangles(&lowered, centre, &mut embree)?;
        for mesh_use in &lowered.meshes {
            self.flat_mesh(mesh_use, centre, &mut embree)?;
        }
        self.instances(&lowered.instances, centre, &device, &mut embree)?;
        let (list, list_owners) = self.shapes(&lowered, centre, &mut embree)?;

        let embree = if self.geometries.is_empty() { None } else { Some(embree.commit(None)?) };
        self.info.embree_bytes = device.memory_bytes();

        let emitters = EmitterSet::new(std::mem::take(&mut self.emitters));
        self.finish_info(&lowered, &emitters);
        let warnings = self.warnings(&emitters);
        self.info.build_time = start.elapsed();
        Ok(Scene {
            embree,
            list: Arc::new(list),
            list_owners: list_owners.into(),
            geometries: self.geometries.into(),
            materials,
            emitters: Arc::new(emitters),
            camera: desc.camera,
            centre,
            info: Arc::new(self.info),
            warnings: warnings.into(),
        })
    }

    fn owner(&self, surface: usize, emitter: u32) -> Owner {
        Owner { surface: surface as u32, material: self.desc.surfaces[surface].material as u32, emitter }
    }

    /// The emission of a surface, where there is light in it.
    fn emission(&self, surface: usize) -> Option<Rgb> {
        self.desc.surfaces[surface].emission.filter(|emission| *emission != Rgb::ZERO)
    }

    fn point_lights(&mut self, centre: DVec3) -> Result<()> {
        for light in &self.desc.lights {
            let position = (light.position - centre).as_vec3a();
            if !position.is_finite() {
                return Err(Error::invalid(format!("{}.origin", light.path), "is too far from the scene"));
            }
            if light.intensity != Rgb::ZERO {
                self.emitters.push(Emitter::Point { position, intensity: light.intensity });
            } else {
                self.dark += 1;
            }
        }
        Ok(())
    }

    /// All triangles and quads as one geometry.
    fn loose_triangles(&mut self, lowered: &Lowered, centre: DVec3, embree: &mut SceneBuilder) -> Result<()> {
        let mut vertices = Vec::new();
        let mut owners = Vec::new();
        let mut dropped: HashMap<usize, usize> = HashMap::new();
        for (corners, surface) in &lowered.triangles {
            let corners = corners.map(|corner| (corner - centre).as_vec3a());
            let Some(triangle) = Triangle::new(corners) else {
                *dropped.entry(*surface).or_default() += 1;
                continue;
            };
            let emitter = self.emission(*surface).map_or(NO_EMITTER, |radiance| self.emit(triangle, radiance));
            owners.push(self.owner(*surface, emitter));
            vertices.extend(corners.map(|corner| corner.to_array()));
        }
        for (surface, count) in dropped {
            self.dropped.push((count, self.desc.surfaces[surface].path.clone()));
        }
        if owners.is_empty() {
            return Ok(());
        }
        let indices = (0..owners.len() as u32).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
        self.add_triangles(vertices, indices, Vec::new(), Owners::Each(owners), embree)
    }

    fn emit(&mut self, triangle: Triangle, radiance: Rgb) -> u32 {
        let [v0, v1, v2] = triangle.vertices();
        let extent = triangle.e1.abs().max(triangle.e2.abs()).max_element();
        let reach = v0.abs().max(v1.abs()).max(v2.abs());
        let error = geometry::triangle_error(reach, triangle.normal, extent);
        self.emitters.push(Emitter::Triangle(TriangleEmitter::new(triangle, radiance, error)));
        (self.emitters.len() - 1) as u32
    }

    fn add_triangles(
        &mut self,
        vertices: Vec<[f32; 3]>,
        indices: Vec<[u32; 3]>,
        normals: Vec<Vec3>,
        owners: Owners,
        embree: &mut SceneBuilder,
    ) -> Result<()> {
        self.info.triangles += indices.len();
        let triangles = self.keep(vertices, indices, normals)?;
        embree.add_triangles(triangles.mesh.clone())?;
        self.geometries.push(Geometry::Triangles { triangles, owners });
        Ok(())
    }

    fn keep(&mut self, vertices: Vec<[f32; 3]>, indices: Vec<[u32; 3]>, normals: Vec<Vec3>) -> Result<Triangles> {
        let mesh = TriangleMesh::new(vertices, indices)?;
        self.info.geometry_bytes += mesh.memory_bytes() + size_of_val(&normals[..]);
        Ok(Triangles { mesh, normals })
    }

    /// A mesh copied into the scene frame.
    fn flat_mesh(&mut self, mesh_use: &MeshUse, centre: DVec3, embree: &mut SceneBuilder) -> Result<()> {
        let surface = &self.desc.surfaces[mesh_use.surface];
        let to_scene = DAffine3::from_translation(-centre) * surface.to_world();
        let Some((vertices, indices, normals)) = self.placed(mesh_use, &to_scene) else { return Ok(()) };
        let first_emitter = match self.emission(mesh_use.surface) {
            None => NO_EMITTER,
            Some(radiance) => {
                let first = self.emitters.len() as u32;
                for corners in &indices {
                    let corners = corners.map(|corner| Vec3::from(vertices[corner as usize]));
                    // Degenerate ones are gone already; what is left has an area.
                    if let Some(triangle) = Triangle::new(corners) {
                        self.emit(triangle, radiance);
                    }
                }
                first
            }
        };
        let owners = Owners::One(self.owner(mesh_use.surface, first_emitter));
        self.add_triangles(vertices, indices, normals, owners, embree)
    }

    /// A mesh's arrays under a transform, outside kept outside, degenerate triangles dropped and counted. `None` where
    /// nothing is left.
    #[expect(clippy::type_complexity, reason = "three arrays that part right after")]
    fn placed(
        &mut self,
        mesh_use: &MeshUse,
        transform: &DAffine3,
    ) -> Option<(Vec<[f32; 3]>, Vec<[u32; 3]>, Vec<Vec3>)> {
        let mesh = &self.desc.meshes[mesh_use.mesh];
        let vertices: Vec<[f32; 3]> = (0..mesh.vertex_count())
            .map(|i| transform.transform_point3(mesh.position(i)).as_vec3a().to_array())
            .collect();
        let mirrored = lower::is_mirrored(transform);
        let mut indices = Vec::with_capacity(mesh.triangle_count());
        for [a, b, c] in (0..mesh.triangle_count()).map(|i| mesh.triangle(i)) {
            let corners = if mirrored { [a, c, b] } else { [a, b, c] };
            if Triangle::new(corners.map(|corner| Vec3::from(vertices[corner as usize]))).is_some() {
                indices.push(corners);
            }
        }
        let dropped = mesh.triangle_count() - indices.len();
        if dropped > 0 {
            self.dropped.push((dropped, format!("{} ({})", self.desc.surfaces[mesh_use.surface].path, mesh.name)));
        }
        if indices.is_empty() {
            return None;
        }
        let normals = if mesh_use.smooth {
            self.info.smooth_meshes += 1;
            let matrix = transform.matrix3.inverse().transpose();
            vertex_normals(mesh)
                .into_iter()
                .map(|normal| (matrix * normal).try_normalize().unwrap_or(DVec3::ZERO).as_vec3a())
                .collect()
        } else {
            Vec::new()
        };
        Some((vertices, indices, normals))
    }

    /// Shared meshes, each built once around its own middle.
    fn instances(&mut self, uses: &[MeshUse], centre: DVec3, device: &Device, embree: &mut SceneBuilder) -> Result<()> {
        let mut built: HashMap<(usize, bool), Option<SharedMesh>> = HashMap::new();
        for mesh_use in uses {
            let shared = match built.entry((mesh_use.mesh, mesh_use.smooth)) {
                Entry::Occupied(entry) => entry.into_mut(),
                Entry::Vacant(entry) => entry.insert(self.shared_mesh(mesh_use, device)?),
            };
            let Some(shared) = shared else { continue };
            let to_scene = DAffine3::from_translation(-centre)
                * self.desc.surfaces[mesh_use.surface].to_world()
                * DAffine3::from_translation(shared.middle);
            embree.add_instance(&shared.object, &to_scene)?;
            self.info.instances += 1;
            self.geometries.push(Geometry::Instance {
                triangles: shared.triangles.clone(),
                owner: self.owner(mesh_use.surface, NO_EMITTER),
                placement: Placement::new(to_scene),
            });
        }
        Ok(())
    }

    /// A mesh around its own middle, in a scene of its own; `None` where all its triangles are degenerate.
    fn shared_mesh(&mut self, mesh_use: &MeshUse, device: &Device) -> Result<Option<SharedMesh>> {
        let mesh = &self.desc.meshes[mesh_use.mesh];
        let middle = mesh.bounds().centre();
        let Some((vertices, indices, normals)) = self.placed(mesh_use, &DAffine3::from_translation(-middle)) else {
            return Ok(None);
        };
        self.info.shared_triangles += indices.len();
        let triangles = Arc::new(self.keep(vertices, indices, normals)?);
        let mut object = SceneBuilder::new(device, SceneOptions::default())?;
        object.add_triangles(triangles.mesh.clone())?;
        Ok(Some(SharedMesh { object: object.commit(None)?, triangles, middle }))
    }

    /// Analytic shapes: a list in front of Embree while they are few, user geometry when they are many.
    fn shapes(
        &mut self,
        lowered: &Lowered,
        centre: DVec3,
        embree: &mut SceneBuilder,
    ) -> Result<(AnalyticList, Vec<Owner>)> {
        let mut shapes = Vec::with_capacity(lowered.shapes.len());
        let mut owners = Vec::with_capacity(lowered.shapes.len());
        for (shape, surface) in &lowered.shapes {
            let shape = shape.in_scene(centre);
            let mut emitter = NO_EMITTER;
            if let (Some(radiance), Analytic::Sphere(sphere)) = (self.emission(*surface), &shape) {
                emitter = self.emitters.len() as u32;
                self.emitters.push(Emitter::Sphere(SphereEmitter { sphere: *sphere, radiance }));
            }
            owners.push(self.owner(*surface, emitter));
            shapes.push(shape);
        }
        let limit = self.options.listed_shapes.unwrap_or(LISTED_SHAPES);
        if shapes.len() <= limit {
            self.info.listed_shapes = shapes.len();
            return Ok((AnalyticList::new(shapes), owners));
        }
        self.info.embree_shapes = shapes.len();
        self.info.decisions.push(format!(
            "{} analytic shapes are more than {limit}: they go into Embree's tree as user geometry",
            shapes.len()
        ));
        let shapes = Arc::new(AnalyticGeometry(shapes));
        embree.add_user(shapes.clone())?;
        self.geometries.push(Geometry::Analytic { shapes, owners });
        Ok((AnalyticList::default(), Vec::new()))
    }

    fn warnings(&mut self, emitters: &EmitterSet) -> Vec<String> {
        let mut warnings = Vec::new();
        if !self.dropped.is_empty() {
            self.dropped.sort_by(|a, b| a.1.cmp(&b.1));
            let total: usize = self.dropped.iter().map(|(count, _)| count).sum();
            let mut places: Vec<String> =
                self.dropped.iter().take(5).map(|(count, path)| format!("{count} in {path}")).collect();
            if self.dropped.len() > places.len() {
                places.push(format!("and more in {} other surfaces", self.dropped.len() - places.len()));
            }
            warnings.push(format!("dropped {total} triangles without area: {}", places.join(", ")));
        }
        let size = (self.info.bounds.max - self.info.bounds.min).max_element();
        if !self.desc.surfaces.is_empty() && !SAFE_SIZES.contains(&size) {
            warnings.push(format!(
                "the scene is {size:e} units across: products of lengths may leave single precision; scale it to between \
                 {:e} and {:e}",
                SAFE_SIZES.start(),
                SAFE_SIZES.end()
            ));
        }
        if self.dark > 0 {
            warnings.push(format!("dropped {} point lights without intensity", self.dark));
        }
        if self.desc.surfaces.is_empty() {
            warnings.push("the scene has no surface: the image will be black".to_owned());
        } else if emitters.is_dark() {
            warnings.push("nothing in the scene emits light: the image will be black".to_owned());
        }
        warnings
    }

    fn finish_info(&mut self, lowered: &Lowered, emitters: &EmitterSet) {
        let info = &mut self.info;
        info.surfaces = self.desc.surfaces.len();
        info.materials = self.desc.materials.len();
        info.bounds = lowered.bounds;
        info.emitters = emitters.emitters().len();
        info.point_lights = emitters.emitters().iter().filter(|e| matches!(e, Emitter::Point { .. })).count();
        if info.listed_shapes > 0 {
            info.decisions.push(format!("{} analytic shapes are tested in a list before Embree", info.listed_shapes));
        }
        if info.instances > 0 {
            info.decisions
                .push(format!("{} uses of large shared meshes are instances of one copy each", info.instances));
        }
        let off = [
            (info.listed_shapes == 0, "analytic shape list"),
            (info.embree_shapes == 0, "user geometry"),
            (info.instances == 0, "instances"),
            (info.smooth_meshes == 0, "smooth normals"),
            (self.geometries.is_empty(), "Embree"),
            (emitters.is_dark(), "emitter sampling"),
        ];
        info.switched_off = off.into_iter().filter_map(|(is_off, name)| is_off.then_some(name)).collect();
    }
}

/// What an instance needs of its object.
struct SharedMesh {
    object: crate::embree::Scene,
    triangles: Arc<Triangles>,
    /// The point of the mesh's own frame that became the object's origin.
    middle: DVec3,
}

/// The world position that becomes the scene frame's origin.
fn frame_origin(desc: &SceneDesc, lowered: &Lowered) -> DVec3 {
    let eye = match desc.camera {
        CameraDesc::Perspective { eye, .. } => eye,
        CameraDesc::ViewPlane { centre, .. } => centre,
    };
    if lowered.bounds.is_empty() { eye } else { eye.clamp(lowered.bounds.min, lowered.bounds.max) }
}

/// One normal per vertex, object frame: the mesh's own, or the angle-weighted mean of the faces around each vertex.
///
/// Source: Thürmer and Wüthrich 1998, "Computing Vertex Normals from Polygonal Facets".
fn vertex_normals(mesh: &MeshDesc) -> Vec<DVec3> {
    if mesh.has_normals() {
        let normals = (0..mesh.vertex_count()).filter_map(|vertex| mesh.normal(vertex));
        return normals.map(|normal| Vec3::from(normal).as_dvec3()).collect();
    }
    let mut normals = vec![DVec3::ZERO; mesh.vertex_count()];
    for triangle in (0..mesh.triangle_count()).map(|i| mesh.triangle(i)) {
        let corners = triangle.map(|corner| mesh.position(corner as usize));
        let Some(normal) = (corners[1] - corners[0]).cross(corners[2] - corners[0]).try_normalize() else { continue };
        for i in 0..3 {
            let (a, b) = (corners[(i + 1) % 3] - corners[i], corners[(i + 2) % 3] - corners[i]);
            normals[triangle[i] as usize] += a.angle_between(b) * normal;
        }
    }
    normals
}
