//! Light at given points of space: the irradiance of a small plane with a given normal, or the radiance that arrives from a
//! given direction.
//!
//! These are the points of a lighting calculation ([`crate::lighting`]). They need no surface: a point on a working plane in
//! the air is as good as one on a floor. The irradiance [W m^-2] is pi times the radiance that a white Lambert surface at the
//! point would send along its normal, as for light maps ([`super::Irradiance`]); the radiance [W m^-2 sr^-1] is that of a
//! camera ray. The estimates are those of [`Path`], unbiased, or of a radiosity solution whose light is gathered at the point.

use std::f32::consts::PI;
use std::sync::Arc;

use super::radiosity::RadiosityPicture;
use super::vertex::Vertex;
use super::walk::scattered_light;
use super::{Context, Path, Tracer, Transport};
use crate::bsdf::{Bsdf, Lambert};
use crate::math::{DVec3, HitPoint, ROUNDING, Ray, Vec3};
use crate::sampling::Sampler;
use crate::scene::{Scene, SurfaceInteraction};
use crate::spectrum::Rgb;

/// What is measured at a point.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ProbeQuantity {
    /// Irradiance [W m^-2] of a small plane at the point, whose normal is the direction.
    Irradiance,
    /// Radiance [W m^-2 sr^-1] that arrives at the point against the direction, which is the one that is looked into.
    Radiance,
}

/// A point where light is measured, in the world frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Probe {
    /// The point.
    pub position: DVec3,
    /// Unit normal of the plane, or unit direction that is looked into.
    pub direction: DVec3,
}

/// Points of a built scene where one quantity is measured.
#[derive(Clone, Debug)]
pub struct Probes {
    quantity: ProbeQuantity,
    /// Each point with its direction, scene frame.
    points: Arc<[(HitPoint, Vec3)]>,
    transport: ProbeTransport,
}

/// Where the light at a point comes from.
#[derive(Clone, Debug)]
enum ProbeTransport {
    Path(Path),
    Radiosity(RadiosityPicture),
}

impl Probes {
    /// Memory of a point.
    pub(crate) const BYTES_A_POINT: usize = size_of::<(HitPoint, Vec3)>();

    /// Probes at these points (at least one) of a scene, by path tracing. `path.max_depth` counts the point itself as the
    /// first hit, so 1 gives direct light alone.
    pub fn new(scene: &Scene, probes: &[Probe], quantity: ProbeQuantity, path: Path) -> Self {
        let points = probes.iter().map(|probe| placed(scene, probe, quantity)).collect();
        Self { quantity, points, transport: ProbeTransport::Path(path) }
    }

    /// The same points, with the light of a radiosity solution.
    pub(crate) fn by_radiosity(&self, picture: RadiosityPicture) -> Self {
        Self { transport: ProbeTransport::Radiosity(picture), ..self.clone() }
    }

    /// One sample at a point. Numbers past the last point wrap around to the first.
    #[inline]
    pub fn estimate<S: Sampler, T: Tracer>(
        &self,
        scene: &Scene,
        number: usize,
        sampler: &mut S,
        tracer: &mut T,
    ) -> Rgb {
        let (mut point, direction) = self.points[number % self.points.len()];
        if scene.uses_time() {
            [point.time, _] = sampler.next_2d();
        }
        let mut context = Context { scene, sampler, tracer, wavelengths: () };
        match self.quantity {
            ProbeQuantity::Radiance => {
                let origin = if point.error > 0.0 { point.offset(direction) } else { point.p };
                let ray = Ray { time: point.time, ..Ray::new(origin, direction) };
                match &self.transport {
                    ProbeTransport::Path(path) => path.li(ray, &mut context, &mut |_| {}),
                    ProbeTransport::Radiosity(picture) => picture.li(ray, &mut context, &mut |_| {}),
                }
            }
            ProbeQuantity::Irradiance => {
                // The point belongs to no surface. Light that arrives at it never asks for the numbers of surface and
                // material, because a Lambert surface sends nothing through itself.
                let surface =
                    SurfaceInteraction { point, ng: direction, ns: direction, surface: 0, material: 0, emitter: None };
                let white = Bsdf::Lambert(Lambert::new(Rgb::ONE));
                let vertex = Vertex::seen_along_normal(scene, surface, &white, true);
                let radiance = match &self.transport {
                    ProbeTransport::Path(Path { max_depth, shadow_rays, .. }) => {
                        let max_depth = max_depth.map_or(u32::MAX, |depth| depth.saturating_sub(1));
                        scattered_light(&vertex, &mut context, max_depth, *shadow_rays, ())
                    }
                    ProbeTransport::Radiosity(picture) => picture.gathered(&vertex, &mut context),
                };
                PI * radiance
            }
        }
    }
}

/// Cosine at a surface below which a view along it may meet it.
const MIN_COSINE: f32 = 1e-2;

/// A probe in the scene frame, with the distance by which its rays have to leave a surface that it may lie on.
fn placed(scene: &Scene, probe: &Probe, quantity: ProbeQuantity) -> (HitPoint, Vec3) {
    let (p, n) = (scene.to_scene(probe.position), probe.direction.as_vec3a());
    // A point on a surface, such as one of a grid on the floor, must not be shadowed by this surface. Its own rounding says
    // nothing of the surface's, which depends on the primitive: a short ray against the normal asks the surface itself.
    let rounding = HitPoint::rounding_error(p, n) + ROUNDING * p.abs().max_element();
    let bounds = scene.info().bounds;
    let size = if bounds.is_empty() { 0.0 } else { (bounds.max - bounds.min).max_element() as f32 };
    let reach = rounding + 8.0 * ROUNDING * size;
    let ray = Ray::segment(p + reach * n, -2.0 * reach * n, 1.0);
    let surface = scene.intersect(&ray).map(|hit| scene.interaction(&ray, &hit));
    // A view from the air begins where it is said to.
    let in_the_air = if quantity == ProbeQuantity::Radiance { 0.0 } else { rounding };
    let error = match surface {
        Some(SurfaceInteraction { point: on, ng, .. }) => {
            // Along `n` a surface is farther away than across it.
            let bound = on.error / ng.dot(n).abs().max(MIN_COSINE);
            let off = (on.p - p).dot(n).abs();
            // A surface that is farther away than it can be wrong by is not the one that the point lies on.
            if off <= 2.0 * (bound + rounding) { rounding.max(bound + off) } else { in_the_air }
        }
        None => in_the_air,
    };
    (HitPoint::new(p, error), n)
}
