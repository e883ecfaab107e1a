//! Images of a radiosity solution.

use std::f32::consts::FRAC_1_PI;
use std::sync::Arc;

use super::Radiosity;
use super::elements::mean_albedo;
use crate::integrator::light::Vertex;
use crate::integrator::{FirstHit, Integrator, Tracer};
use crate::math::Ray;
use crate::sampling::Sampler;
use crate::scene::{Hit, Scene, SurfaceInteraction};
use crate::spectrum::Rgb;

/// An integrator that shows a solution to the camera.
#[derive(Clone, Debug)]
pub(crate) struct RadiosityPicture {
    solution: Arc<Radiosity>,
    /// Mean albedo over pi of each material.
    reflected: Arc<[Rgb]>,
    final_gather: bool,
    shadow_rays: u32,
}

impl RadiosityPicture {
    pub fn new(scene: &Scene, solution: Arc<Radiosity>, final_gather: bool, shadow_rays: u32) -> Self {
        let one = |i: usize| Rgb::from_f64(mean_albedo(&scene.material(i as u32).bsdf)) * FRAC_1_PI;
        let reflected = (0..scene.info().materials).map(one).collect();
        Self { solution, reflected, final_gather, shadow_rays }
    }

    /// Light that the surface reflects, according to the solution.
    fn reflected(&self, ray: &Ray, hit: &Hit, surface: &SurfaceInteraction) -> Rgb {
        let albedo = self.reflected[surface.material as usize];
        if albedo == Rgb::ZERO {
            return Rgb::ZERO;
        }
        let front = ray.direction.dot(surface.ng) < 0.0;
        albedo * self.solution.irradiance(hit, surface.point.p, front)
    }
}

impl Integrator for RadiosityPicture {
    fn radiance<S: Sampler, T: Tracer>(
        &self,
        scene: &Scene,
        ray: Ray,
        sampler: &mut S,
        tracer: &mut T,
        first: &mut impl FnMut(FirstHit),
    ) -> Rgb {
        let Some(hit) = tracer.intersect(&ray) else { return Rgb::ZERO };
        let vertex = Vertex::new(scene, &ray, &hit);
        first(vertex.first_hit());
        let mut radiance = vertex.emitted(scene, None, 1);
        if !self.final_gather {
            return radiance + self.reflected(&ray, &hit, &vertex.surface);
        }
        if vertex.material.bsdf.is_delta() || vertex.material.bsdf.is_black() {
            return radiance;
        }
        // Direct light, by light samples and by the ray that follows, with multiple importance sampling.
        if !scene.emitters().is_dark() {
            for _ in 0..self.shadow_rays {
                radiance += vertex.sample_light(scene, sampler.next_4d(), self.shadow_rays, tracer);
            }
        }
        // All other light, by a ray to a surface whose reflected light the solution gives.
        let Some(bounce) = vertex.sample_bounce(sampler.next_4d()) else { return radiance };
        let Some(hit) = tracer.intersect(&bounce.ray) else { return radiance };
        let from = bounce.pdf.map(|pdf| (vertex.receiver(), pdf));
        let next = Vertex::new(scene, &bounce.ray, &hit);
        let seen = next.emitted(scene, from, self.shadow_rays) + self.reflected(&bounce.ray, &hit, &next.surface);
        radiance + bounce.weight * seen
    }
}
