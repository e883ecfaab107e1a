//! A vertex of a path: the light that its surface emits, the direct light that reaches it, and the path's next direction.

use std::any::Any;

use super::tracer::{Context, FirstHit, Tracer};
use crate::bsdf::{Bsdf, BsdfSample, Lobes, Model, SpecularLobes, TransportMode};
use crate::emitter::{EmitterSet, Receiver};
use crate::math::{Frame, HitPoint, Ray, RayCone, Vec3};
use crate::sampling::Sampler;
use crate::sampling::mis::power_heuristic;
use crate::scene::{Hit, PathMedia, Scene, SurfaceInteraction};
use crate::spectrum::{Rgb, Spectrum};

/// A vertex of a path, ready for shading. Spectra have the channels of the path.
pub(super) struct Vertex<'v, C: Spectrum = Rgb> {
    pub surface: SurfaceInteraction,
    /// How the surface scatters here.
    pub bsdf: &'v Bsdf<C>,
    /// The lobes of the Bsdf that scatter any light.
    pub lobes: Lobes,
    /// The hit; `None` where the vertex was not met by a ray.
    hit: Option<&'v Hit>,
    /// Probability with which a path survives a bounce at this vertex, where the scene sets one.
    pub survival: Option<f32>,
    mode: TransportMode,
    pub(super) wavelengths: C::Wavelengths,
    /// Whether the path has its first wavelength alone, where photons are asked for.
    pub(super) alone: C::Alone,
    /// The media in which the path arrived; `None` in a scene that has no media.
    pub(super) media: Option<PathMedia>,
    frame: Frame,
    /// Direction back along the path, local frame.
    pub wo: Vec3,
    /// Direction back along the path, scene frame.
    wo_scene: Vec3,
    /// Whether a normal that was interpolated or came from a texture is replaced because it faces away.
    turned: bool,
}

/// A scattered ray that leaves a vertex.
pub(super) struct Bounce<C: Spectrum = Rgb> {
    pub ray: Ray,
    /// f |cos| / pdf.
    pub weight: C,
    /// Density of the direction [sr^-1]; `None` after a delta lobe, which light samples cannot sample.
    pub pdf: Option<f32>,
    /// Index of refraction of the medium entered over that of the medium left.
    pub eta: f32,
    /// Whether other wavelengths would have another direction.
    pub disperses: bool,
    /// Probability with which the path goes on after the bounce, by which its throughput was divided.
    pub survival: f32,
}

/// A sample of the light that arrives at a vertex from an emitter.
pub(super) struct LightSample<C: Spectrum> {
    /// From the vertex to the emitter.
    pub shadow: Ray,
    /// The direction that the light comes from, local frame.
    pub wi: Vec3,
    /// The scattering function back along the path (sr^-1).
    pub f: C,
    /// Radiance of the emitter.
    pub radiance: C,
    /// Density of the sample times the number of samples (sr^-1).
    pub pdf: f32,
    /// Density of the same direction as a Bsdf sample (sr^-1).
    pub bsdf_pdf: f32,
    /// Whether no Bsdf sample finds the light.
    pub alone: bool,
}

impl<C: Spectrum> LightSample<C> {
    /// |cos| over the density, times the weight of the sample against a Bsdf sample by the power heuristic (Veach 1997, Sec. 9.2.4).
    #[inline(always)]
    pub fn scale(&self) -> f32 {
        let weight = if self.alone { 1.0 } else { power_heuristic(self.pdf, self.bsdf_pdf) };
        self.wi.z.abs() * weight / self.pdf
    }
}

/// The receiver that a ray leaves and the density (sr^-1) of the ray's direction over the number of light samples taken there; `None` where
/// a light sample could not have sampled the direction as well.
pub(super) type PreviousBounce = Option<(Receiver, f32)>;

/// Radiance from infinity along a ray that misses the scene, with the multiple importance sampling weight of Bsdf sampling
/// against light sampling. The arguments are those of [`Vertex::emitted`], and whether the ray comes from the camera.
///
/// All integrators that take light from infinity call this function for every ray that misses the scene.
#[inline(always)]
pub(super) fn escaped<C: Spectrum>(
    scene: &Scene,
    ray: &Ray,
    previous: PreviousBounce,
    from_camera: bool,
    wavelengths: &C::Wavelengths,
) -> C {
    if !scene.emitters().has_infinite() {
        return C::ZERO;
    }
    let mut radiance = C::ZERO;
    scene.emitters().each_infinite(ray.direction, |le, emitter| {
        if from_camera && !scene.emitters().camera_sees(emitter) {
            return;
        }
        let weight = match previous {
            Some((receiver, pdf)) => {
                let light_pdf = scene.emitters().pdf_infinite(emitter, receiver, ray.direction);
                power_heuristic(pdf, light_pdf)
            }
            None => 1.0,
        };
        radiance += scene.emitters().in_spectrum::<C>(emitter, le, wavelengths) * weight;
    });
    radiance
}

/// [`Vertex::emitted`] of a surface that emits on one side or both, from its outer normal, the direction back along the path, the point and the time. The
/// arguments are values, since a reference to the vertex would keep all of it in memory.
fn emission<C: Spectrum>(
    emitters: &EmitterSet,
    emitter: u32,
    ([ng, wo, p], time): ([Vec3; 3], f32),
    previous: PreviousBounce,
    wavelengths: &C::Wavelengths,
) -> C {
    let Some(emitter) = emitters.on_side(emitter, ng, wo) else { return C::ZERO };
    let le = emitters.in_spectrum::<C>(emitter, emitters.radiance(emitter, wo, p), wavelengths);
    match previous {
        Some((receiver, pdf)) if le != C::ZERO => {
            let light_pdf = emitters.pdf_at(emitter, receiver, p, time);
            le * power_heuristic(pdf, light_pdf)
        }
        _ => le,
    }
}

/// The shading normal, whether that of a texture was put aside because it faces away, the Bsdf and its lit lobes at a hit where the
/// scene has no Bsdf that serves as it is. `ns` is the normal that the shape has there. The arguments are values, since a reference to them would keep them in memory at every vertex.
#[inline(never)]
#[expect(clippy::too_many_arguments, reason = "they are values that a vertex has in registers")]
fn asked<'v, C: Spectrum>(
    scene: &'v Scene,
    hit: &'v Hit,
    index: u32,
    [ng, mut ns, p, wo]: [Vec3; 4],
    (time, cone): (f32, RayCone),
    wavelengths: C::Wavelengths,
    media: Option<PathMedia>,
    slot: &'v mut Option<Bsdf<C>>,
) -> (Vec3, bool, &'v Bsdf<C>, Lobes) {
    let material = scene.material(index);
    let detail_of = |ns: Vec3, with_tangents| scene.detail_at(hit, [ng, ns, p, wo], time, cone, with_tangents);
    let mut turned = false;
    if let Some(own) = material.normal(|with_tangents| detail_of(ns, with_tangents)) {
        // As with interpolated normals, one that faces away from the viewer does not count.
        turned = own.dot(wo) * ng.dot(wo) <= 0.0;
        ns = if turned { ns } else { own };
    }
    let detail = |with_tangents| detail_of(ns, with_tangents);
    let (bsdf, lobes) = match media {
        Some(media) if scene.bounds_medium(index) => {
            let front = ng.dot(wo) > 0.0;
            let bsdf = &*slot.insert(scene.interface(media, index, front, &wavelengths, detail));
            (bsdf, bsdf.lit_lobes())
        }
        _ => material.at::<C>(detail, &wavelengths, slot),
    };
    (ns, turned, bsdf, lobes)
}

impl<'v, C: Spectrum> Vertex<'v, C> {
    /// The vertex at the hit of a ray of a camera path. `slot` holds the vertex's Bsdf where the scene has none for it.
    #[inline(always)]
    pub fn new(
        scene: &'v Scene,
        ray: &Ray,
        hit: &'v Hit,
        wavelengths: C::Wavelengths,
        media: Option<PathMedia>,
        slot: &'v mut Option<Bsdf<C>>,
    ) -> Self {
        Self::of_path(scene, ray, hit, wavelengths, media, slot, TransportMode::Radiance)
    }

    /// The vertex at the hit of a ray of a light path.
    #[inline(always)]
    pub fn of_light_path(
        scene: &'v Scene,
        ray: &Ray,
        hit: &'v Hit,
        wavelengths: C::Wavelengths,
        media: Option<PathMedia>,
        slot: &'v mut Option<Bsdf<C>>,
    ) -> Self {
        Self::of_path(scene, ray, hit, wavelengths, media, slot, TransportMode::Importance)
    }

    #[inline(always)]
    fn of_path(
        scene: &'v Scene,
        ray: &Ray,
        hit: &'v Hit,
        wavelengths: C::Wavelengths,
        media: Option<PathMedia>,
        slot: &'v mut Option<Bsdf<C>>,
        mode: TransportMode,
    ) -> Self {
        // The fields are copied one by one: a copy of the whole would read them in larger pieces than they were just written
        // in, and the processor would stall.
        let SurfaceInteraction { point, ng, mut ns, surface, material, emitter } = scene.interaction(ray, hit);
        let wo_scene = -ray.direction;
        // An interpolated normal may face away from a viewer who does see the face; the face's own normal is used then.
        let mut turned = ns.dot(wo_scene) * ng.dot(wo_scene) <= 0.0;
        if turned {
            ns = ng;
        }
        let shaded = scene.material(material);
        // One test leads past all that few scenes have: materials that vary, media, paths that do not carry colours.
        let (bsdf, lobes) = match (shaded.constant::<C>(), &media) {
            (Some(constant), None) => constant,
            _ => {
                let HitPoint { p, time, cone, .. } = point;
                let vectors = [ng, ns, p, wo_scene];
                let (own, not_own, bsdf, lobes) =
                    asked(scene, hit, material, vectors, (time, cone), wavelengths, media, slot);
                (ns, turned) = (own, turned | not_own);
                (bsdf, lobes)
            }
        };
        let frame = Frame::from_normal(ns);
        let wo = frame.to_local(wo_scene);
        let surface = SurfaceInteraction { point, ng, ns, surface, material, emitter };
        Self {
            bsdf,
            lobes,
            hit: Some(hit),
            survival: shaded.survival,
            mode,
            wavelengths,
            alone: C::Alone::default(),
            media,
            frame,
            wo,
            wo_scene,
            turned,
            surface,
        }
    }

    /// A vertex at a point of a surface with the given Bsdf, seen along its shading normal from the outer side (`front`) or
    /// from the inner side.
    #[inline]
    pub fn seen_along_normal(scene: &Scene, surface: SurfaceInteraction, bsdf: &'v Bsdf<C>, front: bool) -> Self {
        let side = if front { 1.0 } else { -1.0 };
        let media = scene.media_at(&surface.point.leave(side * surface.ng, side * surface.ng));
        Self {
            bsdf,
            lobes: bsdf.lit_lobes(),
            hit: None,
            survival: None,
            mode: TransportMode::Radiance,
            wavelengths: C::Wavelengths::default(),
            alone: C::Alone::default(),
            media,
            frame: Frame::from_normal(surface.ns),
            wo: Vec3::new(0.0, 0.0, side),
            wo_scene: side * surface.ns,
            turned: false,
            surface,
        }
    }

    /// The same vertex with another Bsdf.
    #[inline]
    pub fn with_bsdf<'b>(&self, bsdf: &'b Bsdf<C>) -> Vertex<'b, C>
    where
        'v: 'b,
    {
        let lobes = bsdf.lit_lobes();
        let Self { surface, hit, survival, mode, wavelengths, alone, media, frame, wo, wo_scene, turned, .. } = *self;
        Vertex { surface, bsdf, lobes, hit, survival, mode, wavelengths, alone, media, frame, wo, wo_scene, turned }
    }

    /// The hit; `None` where the vertex was not met by a ray.
    #[inline]
    pub fn hit(&self) -> Option<&Hit> {
        self.hit
    }

    /// Direction back along the path, scene frame.
    #[inline]
    pub fn wo_scene(&self) -> Vec3 {
        self.wo_scene
    }

    /// The vertex for light from other directions, once its path has gone on.
    #[inline]
    pub fn kept(&self) -> (HitPoint, Vec3, Frame, Vec3) {
        (self.surface.point, self.facing(), self.frame, self.wo)
    }

    /// A direction (scene frame) in the local frame; `None` where it is not on the same side of the face and of the shading normal.
    #[inline]
    pub fn consistent(&self, w: Vec3) -> Option<Vec3> {
        let local = self.frame.to_local(w);
        self.is_consistent(w, local).then_some(local)
    }

    /// [`Model::f_pdf`] of the Bsdf for light from the local direction `wi`.
    #[inline]
    pub fn f_pdf(&self, wi: Vec3) -> (C, f32) {
        self.bsdf.f_pdf(self.wo, wi, self.mode)
    }

    /// Whether another viewer on the same side of the face would see the surface along the same shading normal.
    #[inline]
    pub fn has_own_normal(&self) -> bool {
        !self.turned
    }

    /// Transforms a direction from the scene frame to the local frame.
    #[inline]
    pub fn to_local(&self, v: Vec3) -> Vec3 {
        self.frame.to_local(v)
    }

    /// The vertex as a receiver of light: light counts on the side from which the surface is seen, and on both sides where a
    /// lobe with a density transmits.
    #[inline]
    pub fn receiver(&self) -> Receiver {
        let p = self.surface.point.p;
        if self.lobes.have_smooth_transmission() { p.into() } else { Receiver::facing(p, self.facing_shading()) }
    }

    /// The geometric normal on the side that the ray came from.
    #[inline]
    pub fn facing(&self) -> Vec3 {
        if self.surface.ng.dot(self.wo_scene) < 0.0 { -self.surface.ng } else { self.surface.ng }
    }

    /// The shading normal on the side that the ray came from.
    #[inline]
    pub fn facing_shading(&self) -> Vec3 {
        if self.wo.z < 0.0 { -self.surface.ns } else { self.surface.ns }
    }

    /// The factor that multiplies the weight of a bounce into `wi` (scene frame) where the path carries power instead of
    /// radiance: 1 except where shading normals are interpolated. Veach 1997, Eq. 5.19.
    #[inline]
    pub fn shading_adjoint(&self, wi: Vec3) -> f32 {
        let (ng, ns) = (self.surface.ng, self.surface.ns);
        if ng == ns {
            return 1.0;
        }
        let wo = self.wo_scene;
        let ratio = (wo.dot(ns) * wi.dot(ng) / (wo.dot(ng) * wi.dot(ns))).abs();
        if ratio.is_finite() { ratio } else { 0.0 }
    }

    /// The albedo, normal and position for the auxiliary layers.
    #[inline(always)]
    pub fn first_hit(&self, scene: &Scene) -> FirstHit {
        // As a colour: what the path's wavelengths show of it has densities to be divided by, and an albedo has not.
        let SurfaceInteraction { ng, ns, material, point: HitPoint { p, time, cone, .. }, .. } = self.surface;
        let wo_scene = self.wo_scene;
        let material = scene.material(material);
        let mut slot = None;
        let bsdf = match (self.hit, (self.bsdf as &dyn Any).downcast_ref()) {
            // It has been asked already.
            (Some(_), Some(own)) if self.media.is_none() => own,
            (Some(hit), _) => {
                let vectors = [ng, ns, p, wo_scene];
                let detail = move |with_tangents| scene.detail_at(hit, vectors, time, cone, with_tangents);
                material.at::<Rgb>(detail, &(), &mut slot).0
            }
            (None, _) => material.mean(),
        };
        let albedo = bsdf.albedo();
        FirstHit { albedo, normal: self.facing_shading(), p: self.surface.point.p }
    }

    /// Radiance emitted back along the path, with the multiple importance sampling weight of Bsdf sampling against light
    /// sampling.
    ///
    /// `previous` is the bounce that led here, or `None` when no light sample could have led here.
    #[inline(always)]
    pub fn emitted(&self, scene: &Scene, previous: PreviousBounce) -> C {
        let SurfaceInteraction { emitter, ng, point: HitPoint { p, time, .. }, .. } = self.surface;
        match emitter {
            Some(emitter) => {
                let at = ([ng, self.wo_scene, p], time);
                emission(scene.emitters(), emitter, at, previous, &self.wavelengths)
            }
            None => C::ZERO,
        }
    }

    /// Density (sr^-1) with which a light sample at `receiver` would have chosen the direction to the point of this surface, which emits.
    #[inline]
    pub fn light_pdf(&self, scene: &Scene, receiver: Receiver) -> f32 {
        let SurfaceInteraction { emitter, ng, point: HitPoint { p, time, .. }, .. } = self.surface;
        let side = emitter.and_then(|emitter| scene.emitters().on_side(emitter, ng, self.wo_scene));
        side.map_or(0.0, |emitter| scene.emitters().pdf_at(emitter, receiver, p, time))
    }

    /// Adds the direct light from emitters that is scattered back along the path, estimated by this number of light samples,
    /// to `radiance`, one sample after another.
    ///
    /// `only_light_samples` says that no Bsdf sample will look for lights, so that light samples have weight 1.
    #[inline(always)]
    pub fn add_light_samples<S: Sampler, T: Tracer>(
        &self,
        radiance: &mut C,
        context: &mut Context<'_, S, T, C>,
        light_samples: u32,
        only_light_samples: bool,
        alone: C::Alone,
    ) {
        if context.scene.emitters().is_dark() {
            return;
        }
        for _ in 0..light_samples {
            let u = context.sampler.next_4d();
            *radiance += match self.light_sample(context.scene, u, light_samples, only_light_samples) {
                Some((shadow, light)) => {
                    let light = self.dispersed(&shadow, light, alone);
                    self.unoccluded(context.scene, context.tracer, &shadow, light).unwrap_or(C::ZERO)
                }
                None => C::ZERO,
            };
        }
    }

    /// A shadow ray towards an emitter, and the radiance that is scattered back along the path if the ray is unoccluded;
    /// `None` where this radiance is 0.
    ///
    /// The sample is weighted against a Bsdf sample in the same direction by the power heuristic (Veach 1997, Sec. 9.2.4),
    /// as one of `light_samples`. Glass occludes shadow rays: light through glass is found by refracted paths only, and so
    /// is counted once.
    #[inline(always)]
    pub fn light_sample(
        &self,
        scene: &Scene,
        u: [f32; 4],
        light_samples: u32,
        only_light_samples: bool,
    ) -> Option<(Ray, C)> {
        let sample = self.sample_light(scene, u, light_samples, only_light_samples, false)?;
        Some((sample.shadow, sample.f * sample.radiance * sample.scale()))
    }

    /// [`Self::light_sample`] with the scattering function apart. `even_unscattered`: also where nothing of the light is scattered back
    /// along the path.
    #[inline(always)]
    pub fn sample_light(
        &self,
        scene: &Scene,
        u: [f32; 4],
        light_samples: u32,
        only_light_samples: bool,
        even_unscattered: bool,
    ) -> Option<LightSample<C>> {
        let point = &self.surface.point;
        let light = scene.emitters().sample_for(self.receiver(), point.time, u, !only_light_samples)?;
        if self.surface.emitter.is_some() && self.holds(light.target) {
            return None;
        }
        let wi = self.frame.to_local(light.wi);
        if !self.is_consistent(light.wi, wi) {
            return None;
        }
        let (f, bsdf_pdf) = self.bsdf.f_pdf(self.wo, wi, self.mode);
        if !even_unscattered && f == C::ZERO {
            return None;
        }
        // The target is offset from the light, by more the farther away it is, so that the light does not occlude itself.
        let shadow = point.leave_to(self.side(light.wi), light.target);
        let radiance = scene.emitters().in_spectrum::<C>(light.emitter, light.radiance, &self.wavelengths);
        let pdf = light.pdf * light_samples as f32;
        Some(LightSample { shadow, wi, f, radiance, pdf, bsdf_pdf, alone: light.is_delta || only_light_samples })
    }

    /// Whether the surface sends what it transmits into a direction (local frame) elsewhere for each wavelength. The compiler knows that
    /// it does not for paths that carry colours.
    #[inline(always)]
    pub fn disperses(&self, wi: Vec3) -> bool {
        C::HAS_WAVELENGTHS && wi.z * self.wo.z < 0.0 && self.bsdf.disperses()
    }

    /// The light of a shadow ray of a path, which is that of the first wavelength alone where the surface refracts each wavelength into
    /// another direction: as what the path's own next ray brings, so that both are samples of the same light.
    #[inline(always)]
    pub fn dispersed(&self, shadow: &Ray, light: C, alone: C::Alone) -> C {
        if self.disperses_along(shadow) { light.keep_first(&mut { alone }) } else { light }
    }

    /// As [`Self::disperses`], for a ray that leaves the surface.
    #[inline(always)]
    pub fn disperses_along(&self, ray: &Ray) -> bool {
        C::HAS_WAVELENGTHS && self.disperses(self.frame.to_local(ray.direction))
    }

    /// Whether a point lies in the plane of this surface as far as rounding can tell. A lamp that reflects would otherwise light its own
    /// back: each of its points is rounded to one side of it or the other, and half of them would see it.
    #[cold]
    #[inline(never)]
    fn holds(&self, p: Vec3) -> bool {
        let point = &self.surface.point;
        (p - point.p).dot(self.surface.ng).abs() <= 2.0 * point.error
    }

    /// Samples the next direction of the path; `None` when the path ends in absorption.
    #[inline(always)]
    pub fn sample_bounce(&self, u: [f32; 4]) -> Option<Bounce<C>> {
        let sample = self.bsdf.sample(self.wo, [u[0], u[1], u[2]], self.mode)?;
        let wi = self.frame.to_world(sample.wi);
        if !self.is_consistent(wi, sample.wi) {
            return None;
        }
        let is_specular = sample.is_specular();
        let pdf = (!is_specular).then_some(sample.pdf);
        // Errors of the frames would accumulate along a specular path, whereas a diffuse direction is sampled anew.
        let wi = if is_specular { wi.normalize() } else { wi };
        let ray = self.leave_by(sample.lobe, wi, sample.eta);
        let disperses = self.disperses(sample.wi);
        Some(Bounce { ray, weight: sample.weight, pdf, eta: sample.eta, disperses, survival: 1.0 })
    }

    /// The ray that leaves by a delta lobe; `None` where an interpolated normal would send the ray through the face.
    #[inline]
    pub fn leave_specular(&self, lobe: &BsdfSample<C>) -> Option<Ray> {
        let wi = self.frame.to_world(lobe.wi);
        self.is_consistent(wi, lobe.wi).then(|| self.leave_by(lobe.lobe, wi.normalize(), lobe.eta))
    }

    /// Whether light samples can contribute at this vertex: whether the Bsdf has lobes that are not delta lobes.
    #[inline(always)]
    pub fn finds_light_samples(&self) -> bool {
        self.lobes.are_sampled_by_lights()
    }

    /// The scattering function for light from the local direction `wi` (sr^-1).
    #[inline]
    pub fn f(&self, wi: Vec3) -> C {
        self.bsdf.f(self.wo, wi, self.mode)
    }

    /// The delta lobes for the quantity that the path carries.
    #[inline]
    pub fn specular_lobes(&self) -> SpecularLobes<C> {
        self.bsdf.specular_lobes(self.wo, self.mode)
    }

    /// The ray that leaves into the unit direction `wi` of the scene, and f |cos| along the path for light from that
    /// direction; `None` where no light from that direction is scattered back.
    #[inline]
    pub fn leave_towards(&self, wi: Vec3) -> Option<(Ray, C)> {
        let local = self.frame.to_local(wi);
        if !self.is_consistent(wi, local) {
            return None;
        }
        let f = self.f(local);
        (f != C::ZERO).then(|| (self.leave_by(self.lobes, wi.normalize(), 1.0), f * local.z.abs()))
    }

    #[inline]
    fn leave(&self, wi: Vec3) -> Ray {
        self.surface.point.leave(self.side(wi), wi)
    }

    /// The ray that leaves into the unit direction `wi` of the scene by one of these lobes, with a cone as wide as the lobe. `eta` is
    /// the index of refraction on its side over that on the side of the path before.
    #[inline(always)]
    fn leave_by(&self, lobes: Lobes, wi: Vec3, eta: f32) -> Ray {
        let mut ray = self.leave(wi);
        if !ray.cone.is_none() {
            ray.cone = self.cone_of(ray.cone, lobes, wi, eta);
        }
        ray
    }

    #[inline(never)]
    fn cone_of(&self, cone: RayCone, lobes: Lobes, wi: Vec3, eta: f32) -> RayCone {
        let alpha = if lobes.have_diffuse() { 1.0 } else { self.bsdf.narrowest() };
        let SurfaceInteraction { ng, point: HitPoint { curvature, .. }, .. } = self.surface;
        let outside = ng.dot(self.wo_scene);
        let curvature = if outside > 0.0 { curvature } else { -curvature };
        let turned =
            if outside * ng.dot(wi) > 0.0 { cone.reflected(curvature) } else { cone.refracted(curvature, eta) };
        turned.scattered(alpha)
    }

    /// The geometric normal on the side into which `wi` leaves.
    #[inline]
    pub(super) fn side(&self, wi: Vec3) -> Vec3 {
        if wi.dot(self.surface.ng) < 0.0 { -self.surface.ng } else { self.surface.ng }
    }

    /// Whether a direction is on the same side of the face and of the shading normal. Otherwise light would leak through
    /// faces with interpolated normals (Veach 1997, Sec. 5.3.2).
    #[inline]
    fn is_consistent(&self, wi: Vec3, local: Vec3) -> bool {
        wi.dot(self.surface.ng) * local.z > 0.0
    }
}
