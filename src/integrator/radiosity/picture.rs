//! Images of a radiosity solution.

use std::f32::consts::FRAC_1_PI;
use std::sync::Arc;

use super::Radiosity;
use super::elements::mean_albedos;
use crate::integrator::vertex::Vertex;
use crate::integrator::{Context, FirstHit, Tracer, Transport};
use crate::math::Ray;
use crate::sampling::Sampler;
use crate::scene::{Hit, Scene, SurfaceInteraction};
use crate::spectrum::Rgb;

/// An integrator that shows a solution to the camera.
#[derive(Clone, Debug)]
pub(crate) struct RadiosityPicture {
    solution: Arc<Radiosity>,
    /// Mean albedo over pi of each material, on its outer and on its inner side.
    reflected: Arc<[[Rgb; 2]]>,
    final_gather: bool,
    shadow_rays: u32,
}

impl RadiosityPicture {
    pub fn new(scene: &Scene, solution: Arc<Radiosity>, final_gather: bool, shadow_rays: u32) -> Self {
        let of =
            |i: usize| mean_albedos(scene.material(i as u32).mean()).map(|albedo| Rgb::from_f64(albedo) * FRAC_1_PI);
        let reflected = (0..scene.info().materials).map(of).collect();
        Self { solution, reflected, final_gather, shadow_rays }
    }

    /// Light that the surface reflects, according to the solution.
    fn reflected(&self, ray: &Ray, hit: &Hit, surface: &SurfaceInteraction) -> Rgb {
        let front = ray.direction.dot(surface.ng) < 0.0;
        let albedo = self.reflected[surface.material as usize][usize::from(!front)];
        if albedo == Rgb::ZERO {
            return Rgb::ZERO;
        }
        albedo * self.solution.irradiance(hit, surface.point.p, front)
    }
}

impl Transport<Rgb> for RadiosityPicture {
    fn li<S: Sampler, T: Tracer>(
        &self,
        ray: Ray,
        context: &mut Context<'_, S, T>,
        first: &mut impl FnMut(FirstHit),
    ) -> Rgb {
        let scene = context.scene;
        let Some(hit) = context.tracer.intersect(&ray) else { return Rgb::ZERO };
        let mut slot = None;
        let vertex = Vertex::new(scene, &ray, &hit, (), None, &mut slot);
        first(vertex.first_hit(scene));
        let mut radiance: Rgb = vertex.emitted(scene, None, 1);
        if !self.final_gather {
            return radiance + self.reflected(&ray, &hit, &vertex.surface);
        }
        if !vertex.lobes.have_diffuse() {
            return radiance;
        }
        // Direct light, by light samples and by the ray that follows, with multiple importance sampling.
        vertex.add_light_samples(&mut radiance, context, self.shadow_rays, false);
        // All other light, by a ray to a surface whose reflected light the solution gives.
        let Some(bounce) = vertex.sample_bounce(context.sampler.next_4d()) else { return radiance };
        // The solution knows nothing of delta lobes beside the diffuse one: their light is left out here as well.
        let Some(pdf) = bounce.pdf else { return radiance };
        let previous = Some((vertex.receiver(), pdf));
        let Some(hit) = context.tracer.intersect(&bounce.ray) else { return radiance };
        let mut slot = None;
        let next = Vertex::<Rgb>::new(scene, &bounce.ray, &hit, (), None, &mut slot);
        let seen = next.emitted(scene, previous, self.shadow_rays) + self.reflected(&bounce.ray, &hit, &next.surface);
        radiance + bounce.weight * seen
    }
}
