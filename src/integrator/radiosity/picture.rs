//! Images of a radiosity solution.

use std::f32::consts::FRAC_1_PI;
use std::sync::Arc;

use super::Radiosity;
use super::albedo::{mean_albedos, mean_albedos_by};
use super::textured::STEPS;
use crate::integrator::vertex::{Vertex, escaped};
use crate::integrator::{Context, FirstHit, Tracer, Transport};
use crate::math::Ray;
use crate::sampling::Sampler;
use crate::scene::{Hit, Material, Scene};
use crate::spectrum::Rgb;

/// An integrator that shows a solution to the camera.
#[derive(Clone, Debug)]
pub(crate) struct RadiosityPicture {
    solution: Arc<Radiosity>,
    /// Mean albedo over pi of each material, on its outer and on its inner side.
    reflected: Arc<[[Rgb; 2]]>,
    /// Whether textures vary diffuse surfaces.
    is_textured: bool,
    final_gather: bool,
    shadow_rays: u32,
}

impl RadiosityPicture {
    pub fn new(scene: &Scene, solution: Arc<Radiosity>, final_gather: bool, shadow_rays: u32) -> Self {
        let of = |material: &Material| mean_albedos(material.mean()).map(|albedo| Rgb::from_f64(albedo) * FRAC_1_PI);
        let reflected = scene.materials().iter().map(of).collect();
        let is_textured = scene.textured_diffuse_surface().is_some();
        Self { solution, reflected, is_textured, final_gather, shadow_rays }
    }

    /// Light that the surface reflects, according to the solution.
    fn reflected(&self, scene: &Scene, ray: &Ray, hit: &Hit, vertex: &Vertex<'_, Rgb>) -> Rgb {
        let surface = &vertex.surface;
        let front = ray.direction.dot(surface.ng) < 0.0;
        let side = usize::from(!front);
        let albedo = if self.is_textured && scene.material(surface.material).is_textured_diffuse() {
            // The vertex has the Bsdf of the side that the ray meets.
            Rgb::from_f64(mean_albedos_by(vertex.bsdf, STEPS)[side]) * FRAC_1_PI
        } else {
            self.reflected[surface.material as usize][side]
        };
        if albedo == Rgb::ZERO {
            return Rgb::ZERO;
        }
        albedo * self.solution.irradiance(hit, surface.point.p, front)
    }

    /// Light that a vertex scatters back along the path: direct light by light samples, all other light by a ray into the
    /// solution.
    pub(in crate::integrator) fn gathered<S: Sampler, T: Tracer>(
        &self,
        vertex: &Vertex<'_, Rgb>,
        context: &mut Context<'_, S, T>,
    ) -> Rgb {
        let scene = context.scene;
        let mut radiance = Rgb::ZERO;
        // Direct light, by light samples and by the ray that follows, with multiple importance sampling.
        vertex.add_light_samples(&mut radiance, context, self.shadow_rays, false, ());
        // All other light, by a ray to a surface whose reflected light the solution gives.
        let Some(bounce) = vertex.sample_bounce(context.sampler.next_4d()) else { return radiance };
        // The solution knows nothing of delta lobes beside the diffuse one: their light is left out here as well.
        let Some(pdf) = bounce.pdf else { return radiance };
        let previous = Some((vertex.receiver(), pdf / self.shadow_rays as f32));
        let Some(hit) = context.tracer.intersect(&bounce.ray) else {
            let sky: Rgb = escaped(scene, &bounce.ray, previous, false, &());
            return radiance + bounce.weight * sky;
        };
        let mut slot = None;
        let next = Vertex::<Rgb>::new(scene, &bounce.ray, &hit, (), None, &mut slot);
        let seen = next.emitted(scene, previous) + self.reflected(scene, &bounce.ray, &hit, &next);
        radiance + bounce.weight * seen
    }
}

impl Transport<Rgb> for RadiosityPicture {
    type Memory = ();

    fn li<S: Sampler, T: Tracer>(
        &self,
        ray: Ray,
        context: &mut Context<'_, S, T>,
        first: &mut impl FnMut(FirstHit),
    ) -> Rgb {
        let scene = context.scene;
        let Some(hit) = context.tracer.intersect(&ray) else { return escaped(scene, &ray, None, true, &()) };
        let mut slot = None;
        let vertex = Vertex::new(scene, &ray, &hit, (), None, &mut slot);
        first(vertex.first_hit(scene));
        let radiance: Rgb = vertex.emitted(scene, None);
        if !self.final_gather {
            return radiance + self.reflected(scene, &ray, &hit, &vertex);
        }
        if !vertex.lobes.have_diffuse() {
            return radiance;
        }
        radiance + self.gathered(&vertex, context)
    }
}
