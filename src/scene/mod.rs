//! The built scene: immutable, asked by rays.
//!
//! [`Scene::build`] takes a description and decides once what this scene needs: which shapes go to Embree and which are
//! tested in a list before it, which meshes are instanced, whether there are emitters at all. Nothing of that is
//! decided per ray.
//!
//! The scene frame is the world shifted by [`Scene::centre`], in double precision at build, so that a scene far from the
//! world's origin loses nothing.

mod analytic;
mod assemble;
mod bindings;
mod build;
mod cache;
mod cost;
mod describe;
mod faces;
mod facets;
mod frame;
mod geometry;
mod info;
mod instance_transform;
mod interaction;
mod lower;
mod material;
mod mesh;
mod options;
mod record;
mod roulette;
mod specular;

pub use describe::HitDescription;
pub(crate) use faces::{Body, FaceNumbers};
pub use facets::{Facet, SurfaceMesh};
pub use info::SceneInfo;
pub use interaction::SurfaceInteraction;
pub use material::Material;
pub use options::BuildOptions;
pub use specular::{Ball, SpecularPart};

use std::sync::Arc;

use crate::desc::CameraDesc;
use crate::embree::{self, Device, PACKET};
use crate::emitter::EmitterSet;
use crate::math::{DVec3, Ray, Vec3};
use crate::shape::Analytic;
use analytic::AnalyticList;
use bindings::SurfaceBindings;
use geometry::Geometry;
use record::{AppearanceKey, GeometryRecord};

/// What a ray met, as little as is needed to find out more with [`Scene::interaction`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hit {
    /// Distance in units of the ray's direction.
    pub t: f32,
    u: f32,
    v: f32,
    primitive: u32,
    /// Number of the geometry or instance in the Embree scene, or [`IN_LIST`].
    geometry: u32,
}

impl From<embree::Hit> for Hit {
    #[inline]
    fn from(hit: embree::Hit) -> Self {
        // An instance is known by its own number, its only geometry being number 0.
        let geometry = if hit.inst == embree::Hit::NO_INSTANCE { hit.geom } else { hit.inst };
        Self { t: hit.t, u: hit.u, v: hit.v, primitive: hit.prim, geometry }
    }
}

/// The geometry number of shapes outside Embree.
const IN_LIST: u32 = u32::MAX - 1;

/// A scene that can be rendered: immutable, shared by any number of threads. Cloning one is cheap and shares everything.
#[derive(Clone)]
pub struct Scene {
    embree: Option<embree::Scene>,
    list: Arc<AnalyticList>,
    geometries: Arc<[Geometry]>,
    /// What [`geometry::are_large`] says of them.
    is_large: bool,
    bindings: SurfaceBindings,
    materials: Arc<[Material]>,
    camera: CameraDesc,
    centre: DVec3,
    info: Arc<SceneInfo>,
    warnings: Arc<[String]>,
    device: Device,
    /// What geometry was made of, and the rest: for [`Scene::rebuild`].
    record: Arc<GeometryRecord>,
    appearance: Arc<AppearanceKey>,
    /// The survival probability that the description states for each material; `None` where it states none at all.
    stated_survival: Option<Arc<[Option<f32>]>>,
}

impl std::fmt::Debug for Scene {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Scene").field("info", &self.info).finish_non_exhaustive()
    }
}

impl Scene {
    /// The nearest surface along the ray, scene frame. A ray with a NaN or an infinity in it meets nothing.
    // Always inlined: handed over in memory, the ray and the hit cost as much as a tenth of a simple scene's traversal.
    #[inline(always)]
    pub fn intersect(&self, ray: &Ray) -> Option<Hit> {
        let mut ray = *ray;
        let mut nearest = None;
        if !self.list.is_empty()
            && let Some((t, shape)) = self.list.intersect(&ray)
        {
            ray.tfar = t;
            nearest = Some(Hit { t, u: 0.0, v: 0.0, primitive: shape, geometry: IN_LIST });
        }
        if let Some(embree) = &self.embree
            && let Some(hit) = embree.intersect(&ray)
        {
            nearest = Some(hit.into());
        }
        nearest
    }

    /// [`Scene::intersect`] of many rays, of which `hits` takes the answers; faster than one after another.
    ///
    /// # Panics
    /// If there are not as many `hits` as rays.
    #[inline]
    pub fn intersect_many(&self, rays: &[Ray], hits: &mut [Option<Hit>]) {
        assert_eq!(rays.len(), hits.len(), "rays and hits");
        for (rays, hits) in rays.chunks(PACKET).zip(hits.chunks_mut(PACKET)) {
            hits.fill(None);
            let mut ends = [0.0; PACKET];
            for ((ray, end), hit) in rays.iter().zip(&mut ends).zip(hits.iter_mut()) {
                *end = ray.tfar;
                if !self.list.is_empty()
                    && let Some((t, shape)) = self.list.intersect(ray)
                {
                    *end = t;
                    *hit = Some(Hit { t, u: 0.0, v: 0.0, primitive: shape, geometry: IN_LIST });
                }
            }
            if let Some(embree) = &self.embree {
                embree.intersect_many(rays, |number| ends[number], |number, hit| hits[number] = Some(hit.into()));
            }
        }
    }

    /// Whether nothing lies in the ray's segment.
    #[inline]
    pub fn unoccluded(&self, ray: &Ray) -> bool {
        if !self.list.is_empty() && self.list.occluded(ray) {
            return false;
        }
        self.embree.as_ref().is_none_or(|embree| !embree.occluded(ray))
    }

    /// [`Scene::unoccluded`] of many rays, of which `clear` takes the answers; faster than one after another.
    ///
    /// # Panics
    /// If there is not as much room in `clear` as there are rays.
    #[inline]
    pub fn unoccluded_many(&self, rays: &[Ray], clear: &mut [bool]) {
        assert_eq!(rays.len(), clear.len(), "rays and answers");
        if let Some(embree) = &self.embree {
            clear.fill(true);
            embree.occluded_many(rays, |number| clear[number] = false);
            if !self.list.is_empty() {
                for (ray, clear) in rays.iter().zip(clear) {
                    *clear = *clear && !self.list.occluded(ray);
                }
            }
        } else {
            rays.iter().zip(clear).for_each(|(ray, clear)| *clear = !self.list.occluded(ray));
        }
    }

    /// Has the processor fetch what [`Scene::interaction`] will read for these hits. They are all over the arrays of a large mesh,
    /// and one by one each would be waited for.
    #[inline]
    pub(crate) fn prefetch(&self, hits: &[Option<Hit>]) {
        if !self.is_large || cfg!(not(target_arch = "x86_64")) {
            return;
        }
        let far = |hit: &Hit| self.geometries.get(hit.geometry as usize)?.far_triangles();
        for hit in hits.iter().flatten() {
            if let Some(triangles) = far(hit) {
                triangles.prefetch_corners(hit.primitive);
            }
        }
        for hit in hits.iter().flatten() {
            if let Some(triangles) = far(hit) {
                triangles.prefetch_vertices(hit.primitive);
            }
        }
    }

    /// Position, normals, material and emitter of what `ray` met; `hit` must come from the same ray and scene.
    #[inline]
    pub fn interaction(&self, ray: &Ray, hit: &Hit) -> SurfaceInteraction {
        self.point_of(hit, |shape| shape.point(ray, hit.t))
    }

    /// The same for any place of a primitive; `on_shape`: near which point of an analytic one.
    #[inline(always)]
    fn point_of(&self, hit: &Hit, on_shape: impl FnOnce(&Analytic) -> DVec3) -> SurfaceInteraction {
        if let Some(cache) = self.geometries.get(hit.geometry as usize).and_then(Geometry::cache) {
            let owners = &self.bindings.owners[hit.geometry as usize];
            return cache.point_of(owners, hit.primitive, hit.u, hit.v);
        }
        self.point_elsewhere(hit, on_shape)
    }

    /// [`Scene::point_of`] on what is not kept ready.
    fn point_elsewhere(&self, hit: &Hit, on_shape: impl FnOnce(&Analytic) -> DVec3) -> SurfaceInteraction {
        if hit.geometry == IN_LIST {
            let index = hit.primitive as usize;
            let shape = &self.list.shapes()[index];
            return interaction::on_analytic(shape, self.bindings.list_owners[index], on_shape(shape));
        }
        let owners = &self.bindings.owners[hit.geometry as usize];
        match &self.geometries[hit.geometry as usize] {
            Geometry::Loose { triangles, .. } | Geometry::Flat { triangles, .. } => {
                interaction::on_triangle(triangles, owners, hit.primitive, hit.u, hit.v)
            }
            Geometry::Instance { triangles, instance_transform, .. } => {
                interaction::on_instance(triangles, owners, instance_transform, hit.primitive, hit.u, hit.v)
            }
            Geometry::Analytic { shapes, .. } => {
                let shape = &shapes.0[hit.primitive as usize];
                interaction::on_analytic(shape, owners.of(hit.primitive), on_shape(shape))
            }
        }
    }

    /// The Embree scene behind it, where there is one: for queries that want nothing but the kernel.
    pub fn kernel(&self) -> Option<&embree::Scene> {
        self.embree.as_ref()
    }

    /// A material by the number that an interaction gives.
    #[inline]
    pub fn material(&self, index: u32) -> &Material {
        &self.materials[index as usize]
    }

    /// The same surfaces in the light of other emitters.
    #[cfg(test)]
    pub(crate) fn set_emitters(&mut self, emitters: EmitterSet) {
        self.bindings.emitters = Arc::new(emitters);
    }

    /// All emitters.
    #[inline]
    pub fn emitters(&self) -> &EmitterSet {
        &self.bindings.emitters
    }

    /// The camera as described.
    pub fn camera(&self) -> &CameraDesc {
        &self.camera
    }

    /// The device it was built with.
    pub fn device(&self) -> &Device {
        &self.device
    }

    /// World position of the scene frame's origin: the camera at the time of the build, or the point of the scene's box nearest
    /// to it. A camera that moves later keeps it, unless something is nearer to it than a 2048th of its way from there.
    pub fn centre(&self) -> DVec3 {
        self.centre
    }

    /// A world position in the scene frame.
    pub fn to_scene(&self, world: DVec3) -> Vec3 {
        (world - self.centre).as_vec3a()
    }

    /// What the scene holds, what was built for it and why.
    pub fn info(&self) -> &SceneInfo {
        &self.info
    }

    /// What was left out or is worth a word.
    pub fn warnings(&self) -> &[String] {
        &self.warnings
    }
}
