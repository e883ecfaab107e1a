//! The built scene, which is immutable and answers ray queries.
//!
//! [`Scene::build`] takes a description and decides once which structures this scene needs: which shapes Embree holds
//! and which are tested in a list before it, which meshes are instanced, and whether there are emitters at all. None of
//! these decisions is made per ray.
//!
//! The scene frame is the world frame shifted by [`Scene::centre`]. The shift is applied in double precision when the
//! scene is built, so that a scene far from the world's origin loses no precision.

mod analytic;
mod analytic_uv;
mod assemble;
mod assemble_moving;
mod backplate;
mod bindings;
mod build;
mod cache;
mod cost;
mod curvature;
mod cutout;
mod describe;
mod detail;
mod emission_webs;
mod emissive;
mod faces;
mod facets;
mod flat_mirrors;
mod frame;
mod geometry;
mod groups;
mod hit;
mod info;
mod instance_transform;
mod interaction;
mod lower;
mod lower_moving;
mod material;
mod media;
mod mesh;
#[cfg(test)]
pub(crate) mod motion;
mod movement;
mod moving_shape;
mod options;
mod prepared_textures;
mod projection;
mod record;
mod relief;
mod roulette;
mod singles;
mod sky;
mod specular;
mod steps;
mod tangents;
mod textured;
mod textured_emission;
#[cfg(test)]
pub(crate) mod varying;

pub(crate) use backplate::Backplate;
pub use describe::HitDescription;
pub use detail::SurfaceDetail;
pub(crate) use faces::{Body, Face, FaceNumbers};
pub use facets::{Facet, SurfaceMesh};
pub(crate) use flat_mirrors::FlatMirrors;
pub use hit::Hit;
pub use info::{SceneInfo, WebInfo};
pub use interaction::SurfaceInteraction;
pub use material::{Material, VaryingMaterial};
pub(crate) use media::PathMedia;
pub use options::BuildOptions;
pub use specular::{Ball, SpecularPart};

use std::sync::{Arc, OnceLock};

use crate::desc::CameraDesc;
use crate::embree::{self, Device, PACKET};
use crate::emitter::EmitterSet;
use crate::math::{DVec3, HitPoint, Ray, Vec3};
use crate::shape::Analytic;
use analytic::AnalyticList;
use bindings::SurfaceBindings;
use geometry::Geometry;
use hit::IN_LIST;
use material::MaterialNeeds;
use media::Media;
use record::{AppearanceKey, GeometryRecord};

/// A scene that can be rendered: immutable, shared by any number of threads. Cloning one is cheap and shares everything.
#[derive(Clone)]
pub struct Scene {
    embree: Option<embree::Scene>,
    list: Arc<AnalyticList>,
    geometries: Arc<[Geometry]>,
    /// The result of [`geometry::are_large`] for the scene's geometries.
    is_large: bool,
    bindings: SurfaceBindings,
    materials: Arc<[Material]>,
    /// Tangents of the surfaces that have a normal map.
    tangents: Arc<tangents::SurfaceTangents>,
    /// Whether a texture reads colours of vertices or a further set of texture coordinates.
    reads_mesh_points: bool,
    /// The textures of the materials, for [`Scene::rebuild`].
    textures: Arc<prepared_textures::PreparedTextures>,
    /// What any of the materials needs to know of a hit.
    needs: MaterialNeeds,
    /// The media inside surfaces, where a medium absorbs or has a priority.
    media: Option<Arc<Media>>,
    camera: CameraDesc,
    /// What the camera sees behind everything, where the description has a picture for it.
    backplate: Option<Arc<backplate::Backplate>>,
    /// The shutter and the motion of the camera, where anything moves.
    movement: Option<Arc<movement::Movement>>,
    centre: DVec3,
    info: Arc<SceneInfo>,
    warnings: Arc<[String]>,
    device: Device,
    /// The descriptions from which the geometry and the other parts were built, for [`Scene::rebuild`].
    record: Arc<GeometryRecord>,
    appearance: Arc<AppearanceKey>,
    /// The survival probability that the description states for each material; `None` where no material states one.
    stated_survival: Option<Arc<[Option<f32>]>>,
    /// What [`Scene::flat_mirrors`] found, once it was asked for.
    flat_mirrors: Arc<OnceLock<FlatMirrors>>,
}

impl std::fmt::Debug for Scene {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Scene").field("info", &self.info).finish_non_exhaustive()
    }
}

impl Scene {
    /// Returns the nearest hit along the ray, which is in the scene frame. Where a surface is not opaque, its opacity is the
    /// probability with which the ray meets it. A ray with a NaN or an infinity in it hits
    /// nothing.
    // The function is always inlined: passing the ray and the hit in memory costs as much as a tenth of a simple
    // scene's traversal.
    #[inline(always)]
    pub fn intersect(&self, ray: &Ray) -> Option<Hit> {
        let hit = self.nearest(ray)?;
        if self.needs.opacity { self.first_opaque(ray, hit) } else { Some(hit) }
    }

    /// Returns the nearest surface along the ray, whatever its opacity.
    #[inline(always)]
    fn nearest(&self, ray: &Ray) -> Option<Hit> {
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

    /// Intersects many rays as [`Scene::intersect`] does and writes the results to `hits`. This is faster than
    /// intersecting one ray after another.
    ///
    /// # Panics
    /// The function panics if `hits` and `rays` differ in length.
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
        if self.needs.opacity {
            for (ray, hit) in rays.iter().zip(hits) {
                *hit = hit.and_then(|hit| self.first_opaque(ray, hit));
            }
        }
    }

    /// Returns whether no surface lies in the ray's segment.
    #[inline]
    pub fn unoccluded(&self, ray: &Ray) -> bool {
        if self.needs.opacity {
            return self.intersect(ray).is_none();
        }
        if !self.list.is_empty() && self.list.occluded(ray) {
            return false;
        }
        self.embree.as_ref().is_none_or(|embree| !embree.occluded(ray))
    }

    /// Tests many rays as [`Scene::unoccluded`] does and writes the results to `clear`. This is faster than testing one
    /// ray after another.
    ///
    /// # Panics
    /// The function panics if `clear` and `rays` differ in length.
    #[inline]
    pub fn unoccluded_many(&self, rays: &[Ray], clear: &mut [bool]) {
        assert_eq!(rays.len(), clear.len(), "rays and answers");
        if self.needs.opacity {
            rays.iter().zip(clear).for_each(|(ray, clear)| *clear = self.intersect(ray).is_none());
        } else if let Some(embree) = &self.embree {
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

    /// Prefetches the data that [`Scene::interaction`] will read for these hits. The data are scattered over the arrays
    /// of a large mesh, and without prefetching every hit would wait for its own memory access.
    #[inline]
    pub fn prefetch(&self, hits: &[Option<Hit>]) {
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

    /// Returns the position, normals, material and emitter of the surface that `ray` hit. The hit must come from the
    /// same ray and scene.
    #[inline(always)]
    pub fn interaction(&self, ray: &Ray, hit: &Hit) -> SurfaceInteraction {
        let mut interaction = self.point_of(hit, ray.time, |shape| shape.point(ray, hit.t));
        if self.needs.footprints {
            let HitPoint { p, time, .. } = interaction.point;
            (interaction.point.cone, interaction.point.curvature) = self.cone_at(ray, hit, p, time);
        }
        interaction
    }

    /// Whether the time of a ray counts: for motion, or for the decision whether it meets a surface that is not opaque.
    #[inline]
    pub fn uses_time(&self) -> bool {
        self.has_motion() || !self.is_opaque()
    }

    /// Whether every ray meets the first surface in its way. In other scenes a ray passes through some surfaces with a
    /// probability.
    #[inline]
    pub fn is_opaque(&self) -> bool {
        !self.needs.opacity
    }

    /// Whether a material asks for the footprint of rays, so that rays have to carry cones.
    #[inline]
    pub fn asks_footprints(&self) -> bool {
        self.needs.footprints
    }

    /// Returns the interaction at any point of a primitive. On an analytic shape, `on_shape` gives a position near the
    /// point.
    #[inline(always)]
    fn point_of(&self, hit: &Hit, time: f32, on_shape: impl FnOnce(&Analytic) -> DVec3) -> SurfaceInteraction {
        if let Some(cache) = self.geometries.get(hit.geometry as usize).and_then(Geometry::cache) {
            let owners = &self.bindings.owners[hit.geometry as usize];
            return cache.point_of(owners, hit, time);
        }
        self.point_elsewhere(hit, time, on_shape)
    }

    /// The surface, material and emitter of the primitive that was hit.
    #[inline]
    fn owner(&self, hit: &Hit) -> interaction::Owner {
        match hit.geometry {
            IN_LIST => self.bindings.list_owners[hit.primitive as usize],
            geometry => self.bindings.owners[geometry as usize].of(hit.primitive),
        }
    }

    /// Does the work of [`Scene::point_of`] for primitives that are not in a triangle cache.
    fn point_elsewhere(&self, hit: &Hit, time: f32, on_shape: impl FnOnce(&Analytic) -> DVec3) -> SurfaceInteraction {
        if hit.geometry == IN_LIST {
            let index = hit.primitive as usize;
            let shape = &self.list.shapes()[index];
            return interaction::on_analytic(shape, self.bindings.list_owners[index], on_shape(shape), time);
        }
        let owners = &self.bindings.owners[hit.geometry as usize];
        match &self.geometries[hit.geometry as usize] {
            Geometry::Loose { triangles, .. } | Geometry::Flat { triangles, .. } => {
                interaction::on_triangle(triangles, owners, hit, time)
            }
            Geometry::Instance { triangles, instance_path, .. } => instance_path
                .with_transform(time, |transform| interaction::on_instance(triangles, owners, transform, hit, time)),
            Geometry::Analytic { shapes, .. } if !shapes.moving.is_empty() => {
                let shape = shapes.moving[hit.primitive as usize].at(time);
                interaction::on_analytic(&shape, owners.of(hit.primitive), on_shape(&shape), time)
            }
            Geometry::Analytic { shapes, .. } => {
                let shape = &shapes.start[hit.primitive as usize];
                interaction::on_analytic(shape, owners.of(hit.primitive), on_shape(shape), time)
            }
        }
    }

    /// The Embree scene, where there is one, for queries that need only the kernel.
    pub fn kernel(&self) -> Option<&embree::Scene> {
        self.embree.as_ref()
    }

    /// Whether anything moves during the shutter interval, so that rays of different times see different scenes.
    #[inline]
    pub fn has_motion(&self) -> bool {
        self.movement.is_some() || self.embree.as_ref().is_some_and(|embree| embree.features().motion)
    }

    /// Whether anything but the camera moves during the shutter interval.
    pub fn has_moving_world(&self) -> bool {
        self.emitters().has_moving() || self.embree.as_ref().is_some_and(|embree| embree.features().motion)
    }

    /// Returns a material by the number that an interaction gives.
    #[inline]
    pub fn material(&self, index: u32) -> &Material {
        &self.materials[index as usize]
    }

    /// All materials, in their order; the last is that of surfaces without a material.
    pub(crate) fn materials(&self) -> &[Material] {
        &self.materials
    }

    /// Replaces a material by one that varies.
    #[cfg(test)]
    pub(crate) fn set_varying(&mut self, index: usize, varying: Arc<dyn VaryingMaterial>) {
        let mut materials = self.materials.to_vec();
        materials[index] = Material::varying(varying);
        self.needs = MaterialNeeds::of(&materials);
        self.materials = materials.into();
        self.flat_mirrors = Arc::default();
    }

    /// Replaces the emitters and keeps the surfaces.
    #[cfg(test)]
    pub(crate) fn set_emitters(&mut self, emitters: EmitterSet) {
        self.bindings.emitters = Arc::new(emitters);
    }

    /// Replaces the Bsdf of a material, by its number in the description.
    #[cfg(test)]
    pub(crate) fn set_bsdf(&mut self, material: usize, bsdf: crate::bsdf::Bsdf) {
        let mut materials = self.materials.to_vec();
        materials[material] = Material::uniform(bsdf);
        self.materials = materials.into();
        self.flat_mirrors = Arc::default();
    }

    /// All emitters of the scene.
    #[inline]
    pub fn emitters(&self) -> &EmitterSet {
        &self.bindings.emitters
    }

    /// The camera as described, or where it is as the shutter opens.
    pub fn camera(&self) -> &CameraDesc {
        &self.camera
    }

    /// The picture behind everything; `None` where the camera sees what comes from infinity.
    pub(crate) fn backplate(&self) -> Option<&Backplate> {
        self.backplate.as_deref()
    }

    /// The device with which the scene was built.
    pub fn device(&self) -> &Device {
        &self.device
    }

    /// World position of the scene frame's origin: the camera at the time of the build, or the point of the scene's box
    /// nearest to the camera. The origin stays when the camera moves later, unless a surface is nearer to the camera
    /// than a 2048th of the camera's distance from the origin.
    pub fn centre(&self) -> DVec3 {
        self.centre
    }

    /// Converts a world position to the scene frame.
    pub fn to_scene(&self, world: DVec3) -> Vec3 {
        (world - self.centre).as_vec3a()
    }

    /// The contents of the scene, the structures that were built for it, and the reasons for them.
    pub fn info(&self) -> &SceneInfo {
        &self.info
    }

    /// Warnings about parts of the description that were left out or deserve attention.
    pub fn warnings(&self) -> &[String] {
        &self.warnings
    }
}
