//! Light at a surface: what it emits, and what reaches it directly.

use super::{FirstHit, Tracer};
use crate::emitter::Receiver;
use crate::math::{Frame, Ray, Vec3};
use crate::sampling::mis::power_heuristic;
use crate::scene::{Hit, Material, Scene, SurfaceInteraction};
use crate::spectrum::Rgb;

/// A point of a path, ready for shading.
pub(super) struct Vertex<'s> {
    pub surface: SurfaceInteraction,
    pub material: &'s Material,
    frame: Frame,
    /// Back along the path, local frame.
    pub wo: Vec3,
    /// Back along the path, scene frame.
    wo_scene: Vec3,
}

/// A bounce out of a vertex.
pub(super) struct Bounce {
    pub ray: Ray,
    /// f |cos| / pdf.
    pub weight: Rgb,
    /// `None` after a delta lobe, which no light sample can imitate.
    pub pdf: Option<f32>,
    /// Index of refraction entered over the one left.
    pub eta: f32,
}

impl<'s> Vertex<'s> {
    #[inline]
    pub fn new(scene: &'s Scene, ray: &Ray, hit: &Hit) -> Self {
        // Field by field: a copy as a whole would be read in larger pieces than it was just written in, for which the processor
        // waits.
        let SurfaceInteraction { point, ng, mut ns, surface, material, emitter } = scene.interaction(ray, hit);
        let wo_scene = -ray.direction;
        // An interpolated normal may look away from a viewer who does see the face: shade flat there.
        if ns.dot(wo_scene) * ng.dot(wo_scene) <= 0.0 {
            ns = ng;
        }
        let frame = Frame::from_normal(ns);
        let wo = frame.to_local(wo_scene);
        let surface = SurfaceInteraction { point, ng, ns, surface, material, emitter };
        Self { material: scene.material(material), frame, wo, wo_scene, surface }
    }

    /// A point of a surface as if it were of this diffuse material, looked at along its shading normal from the side of it
    /// (`front`) or the other.
    #[inline]
    pub fn seen_along_normal(surface: SurfaceInteraction, material: &'s Material, front: bool) -> Self {
        let side = if front { 1.0 } else { -1.0 };
        let frame = Frame::from_normal(surface.ns);
        Self { material, frame, wo: Vec3::new(0.0, 0.0, side), wo_scene: side * surface.ns, surface }
    }

    /// Back along the path, scene frame.
    #[inline]
    pub fn wo_scene(&self) -> Vec3 {
        self.wo_scene
    }

    /// A direction of the scene in the local frame.
    #[inline]
    pub fn to_local(&self, v: Vec3) -> Vec3 {
        self.frame.to_local(v)
    }

    /// As lights see it: all that scatters light samples does so on the side from which it is looked at.
    #[inline]
    pub fn receiver(&self) -> Receiver {
        Receiver::facing(self.surface.point.p, self.facing_shading())
    }

    /// What the auxiliary layers want to know.
    pub fn first_hit(&self) -> FirstHit {
        let normal = if self.wo.z < 0.0 { -self.surface.ns } else { self.surface.ns };
        FirstHit { albedo: self.material.bsdf.albedo(), normal, p: self.surface.point.p }
    }

    /// Radiance emitted back along the path, with the weight of having come here by chance rather than by a light sample.
    ///
    /// `from`: the receiver and density [sr^-1] of the bounce that led here, `None` when no light sample could have.
    /// `light_samples`: how many were taken there.
    #[inline]
    pub fn emitted(&self, scene: &Scene, from: Option<(Receiver, f32)>, light_samples: u32) -> Rgb {
        let Some(emitter) = self.surface.emitter else { return Rgb::ZERO };
        let le = scene.emitters().le(emitter, self.surface.ng, self.wo_scene);
        match from {
            Some((receiver, pdf)) if le != Rgb::ZERO => {
                let light_pdf = scene.emitters().pdf(emitter, receiver, self.surface.point.p);
                le * power_heuristic(pdf, light_samples as f32 * light_pdf)
            }
            _ => le,
        }
    }

    /// One sample of the light that comes straight from an emitter and is scattered back along the path.
    ///
    /// One of `light_samples`, as [`Vertex::light_sample`] says.
    #[inline]
    pub fn sample_light<T: Tracer>(&self, scene: &Scene, u: [f32; 4], light_samples: u32, tracer: &mut T) -> Rgb {
        self.sample_light_as(scene, u, light_samples, false, tracer)
    }

    /// The same; `only_light_samples`: no Bsdf sample will look for lights, so that this sample has all the weight.
    #[inline(always)]
    pub fn sample_light_as<T: Tracer>(
        &self,
        scene: &Scene,
        u: [f32; 4],
        light_samples: u32,
        only_light_samples: bool,
        tracer: &mut T,
    ) -> Rgb {
        match self.light_sample(scene, u, light_samples, only_light_samples) {
            Some((shadow, light)) if tracer.unoccluded(&shadow) => light,
            _ => Rgb::ZERO,
        }
    }

    /// A shadow ray towards an emitter, and what is scattered back along the path if nothing is in its way; `None` where that
    /// is nothing.
    ///
    /// Weighted against a Bsdf sample in the same direction by the power heuristic (Veach 1997, Sec. 9.2.4), this being
    /// one of `light_samples`. Glass blocks: light through it comes as a path that is refracted, and never twice.
    #[inline(always)]
    pub fn light_sample(
        &self,
        scene: &Scene,
        u: [f32; 4],
        light_samples: u32,
        only_light_samples: bool,
    ) -> Option<(Ray, Rgb)> {
        let point = &self.surface.point;
        let light = scene.emitters().sample(self.receiver(), u)?;
        let wi = self.frame.to_local(light.wi);
        if !self.is_consistent(light.wi, wi) {
            return None;
        }
        let (f, bsdf_pdf) = self.material.bsdf.f_pdf(self.wo, wi);
        if f == Rgb::ZERO {
            return None;
        }
        let weight = if light.is_delta || only_light_samples {
            1.0
        } else {
            power_heuristic(light_samples as f32 * light.pdf, bsdf_pdf)
        };
        let origin = point.offset(self.side(light.wi));
        // The target is off the light, by more the farther it is: the light is no obstacle itself.
        let shadow = Ray { origin, direction: light.target - origin, tnear: 0.0, tfar: 1.0 };
        Some((shadow, f * light.radiance * (wi.z.abs() * weight / (light.pdf * light_samples as f32))))
    }

    /// Samples the next direction of the path; `None` when it ends in absorption.
    #[inline(always)]
    pub fn sample_bounce(&self, u: [f32; 4]) -> Option<Bounce> {
        let sample = self.material.bsdf.sample(self.wo, [u[0], u[1], u[2]])?;
        let wi = self.frame.to_world(sample.wi);
        if !self.is_consistent(wi, sample.wi) {
            return None;
        }
        let pdf = (!sample.is_delta).then_some(sample.pdf);
        // Along a specular path the error of the frames would be multiplied; a diffuse direction is fresh.
        let wi = if sample.is_delta { wi.normalize() } else { wi };
        Some(Bounce { ray: self.leave(wi), weight: sample.weight, pdf, eta: sample.eta })
    }

    /// The ray that leaves into the local direction `wi`, unless an interpolated normal sends it through the face.
    #[inline]
    pub fn leave_local(&self, wi: Vec3) -> Option<Ray> {
        let scene_wi = self.frame.to_world(wi);
        self.is_consistent(scene_wi, wi).then(|| self.leave(scene_wi.normalize()))
    }

    /// The ray that leaves into the unit direction `wi` of the scene, and f |cos| along the path for light from there; `None`
    /// where no light from there is sent back.
    #[inline]
    pub fn leave_towards(&self, wi: Vec3) -> Option<(Ray, Rgb)> {
        let local = self.frame.to_local(wi);
        if !self.is_consistent(wi, local) {
            return None;
        }
        let f = self.material.bsdf.f(self.wo, local);
        (f != Rgb::ZERO).then(|| (self.leave(wi.normalize()), f * local.z.abs()))
    }

    #[inline]
    fn leave(&self, wi: Vec3) -> Ray {
        Ray::new(self.surface.point.offset(self.side(wi)), wi)
    }

    /// The geometric normal on the side that `wi` leaves to.
    #[inline]
    fn side(&self, wi: Vec3) -> Vec3 {
        if wi.dot(self.surface.ng) < 0.0 { -self.surface.ng } else { self.surface.ng }
    }

    /// Whether a direction is on the same side of the face as of the shading normal: light must not leak through a face
    /// whose normals are interpolated (Veach 1997, Sec. 5.3.2).
    #[inline]
    fn is_consistent(&self, wi: Vec3, local: Vec3) -> bool {
        wi.dot(self.surface.ng) * local.z > 0.0
    }
}
