//! Many paths side by side, hit by hit.
//!
//! Paths that have nothing to do with each other are worth taking together, since Embree answers their rays in packets in less
//! time than one by one (`docs/performance.md`). Each path is what it would be alone, to the last bit.
//!
//! Source: Laine, Karras, Aila 2013, "Megakernels Considered Harmful: Wavefront Path Tracing on GPUs".

use super::tracer::{FirstHit, Tracer};
use super::vertex::Vertex;
use super::walk::{Limits, Walk};
use crate::desc::MAX_SHADOW_RAYS;
use crate::math::{Ray, Vec3};
use crate::sampling::Sampler;
use crate::scene::{Hit, Scene};
use crate::spectrum::{Rgb, Spectrum};

/// One of several samples that are taken together.
#[derive(Clone, Debug)]
pub struct Sample<S, C: Spectrum = Rgb> {
    /// From the camera.
    pub ray: Ray,
    /// At the first dimensions after those of the ray.
    pub sampler: S,
    /// What is estimated.
    pub radiance: C,
    /// The wavelengths that the path carries.
    pub wavelengths: C::Wavelengths,
    /// What the ray met first, once it is known.
    pub first: Option<FirstHit>,
}

impl<S, C: Spectrum> Sample<S, C> {
    /// Before it is known whose it is.
    pub fn new(sampler: S) -> Self {
        Self {
            ray: Ray::new(Vec3::ZERO, Vec3::Z),
            sampler,
            radiance: C::ZERO,
            wavelengths: C::Wavelengths::default(),
            first: None,
        }
    }
}

/// The paths of a wave, between two hits. Kept from wave to wave, so that none allocates.
#[derive(Default)]
pub struct Wave<C: Spectrum = Rgb> {
    walks: Vec<Walk<C>>,
    /// The numbers of the paths that go on, and their rays.
    active: Vec<u32>,
    rays: Vec<Ray>,
    hits: Vec<Option<Hit>>,
    /// Shadow rays, whose they are, and the light that they bring if nothing is in their way.
    shadows: Vec<Ray>,
    lights: Vec<(u32, C)>,
    clear: Vec<bool>,
}

impl<C: Spectrum> std::fmt::Debug for Wave<C> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Wave").field("paths", &self.walks.len()).finish_non_exhaustive()
    }
}

impl<C: Spectrum> Wave<C> {
    /// The paths of all samples.
    #[inline(always)]
    pub(super) fn trace<S: Sampler, T: Tracer>(
        &mut self,
        scene: &Scene,
        samples: &mut [Sample<S, C>],
        tracer: &mut T,
        limits: &Limits,
    ) {
        let Self { walks, active, rays, hits, shadows, lights, clear } = self;
        walks.clear();
        walks.resize(samples.len(), Walk::new(limits.previous));
        active.clear();
        active.extend(0..samples.len() as u32);
        rays.clear();
        rays.extend(samples.iter().map(|sample| sample.ray));
        samples.iter_mut().for_each(|sample| sample.first = None);
        hits.resize(samples.len().max(hits.len()), None);
        // What vertices send at most, or all that a description may ask for: so no later wave takes more memory.
        let most_shadows = samples.len() * limits.shadow_rays.min(MAX_SHADOW_RAYS) as usize;
        shadows.clear();
        shadows.reserve(most_shadows);
        lights.clear();
        lights.reserve(most_shadows);
        clear.reserve(most_shadows.saturating_sub(clear.len()));

        while !active.is_empty() {
            let hits = &mut hits[..active.len()];
            tracer.intersect_many(rays, hits);
            scene.prefetch(hits);
            shadows.clear();
            lights.clear();
            let mut kept = 0;
            for (i, hit) in hits.iter().enumerate() {
                let number = active[i];
                let Sample { sampler, first, wavelengths, .. } = &mut samples[number as usize];
                let Some(hit) = hit else {
                    walks[number as usize].escape(scene, &rays[i], limits, wavelengths);
                    continue;
                };
                let next = walks[number as usize].meet(
                    scene,
                    &Vertex::new(scene, &rays[i], hit, *wavelengths),
                    sampler,
                    limits,
                    &mut |hit| *first = Some(hit),
                    |_, shadow, light| {
                        shadows.push(shadow);
                        lights.push((number, light));
                    },
                );
                if let Some(next) = next {
                    (active[kept], rays[kept]) = (number, next);
                    kept += 1;
                }
            }
            active.truncate(kept);
            rays.truncate(kept);

            clear.resize(shadows.len(), false);
            tracer.unoccluded_many(shadows, clear);
            for ((number, light), clear) in lights.iter().zip(&*clear) {
                if *clear {
                    walks[*number as usize].radiance += *light;
                }
            }
        }
        for (sample, walk) in samples.iter_mut().zip(walks) {
            sample.radiance = walk.radiance;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::camera::Camera;
    use crate::desc;
    use crate::integrator::{Direct, Integrator, Path, SceneTracer};
    use crate::sampling::{Pattern, PatternSampler, SobolSampler};
    use crate::scene::BuildOptions;

    /// Waves of all sizes against paths one by one: the same radiance, the same first hits, the same number of rays.
    fn compare<I: Integrator, S: Sampler + Clone>(scene: &Scene, integrator: &I, sampler: &S) {
        const SIDE: u32 = 24;
        let camera = Camera::new(scene.camera(), [SIDE; 2], scene.centre()).unwrap();
        let (mut wave, mut lit, mut next) = (Wave::default(), 0, 0);
        for size in [1, 2, 15, 16, 17, 100, 300, 3, 122] {
            let mut samples = vec![Sample::new(sampler.clone()); size];
            for sample in &mut samples {
                let (pixel, index) = (next % (SIDE * SIDE), next / (SIDE * SIDE));
                next += 1;
                sample.sampler.start(pixel, index);
                let [x, y] = sample.sampler.pixel_2d();
                sample.ray = camera.ray((pixel % SIDE) as f32 + x, (pixel / SIDE) as f32 + y);
            }
            let (mut together, mut alone) = (SceneTracer::new(scene), SceneTracer::new(scene));
            let before = samples.clone();
            integrator.radiance_of_many(scene, &mut samples, &mut wave, &mut together);
            for (mut sample, after) in before.into_iter().zip(samples) {
                let mut first = None;
                let sampler = &mut sample.sampler;
                let expected =
                    integrator.radiance(scene, sample.ray, sampler, &mut alone, &mut |hit| first = Some(hit));
                assert_eq!((after.radiance, after.first), (expected, first));
                lit += usize::from(expected != Rgb::ZERO);
            }
            assert_eq!(together.rays, alone.rays);
        }
        assert!(lit > 100, "{lit} samples have light");
    }

    #[test]
    fn a_path_in_a_wave_is_what_it_is_alone() {
        let scenes = concat!(env!("CARGO_MANIFEST_DIR"), "/scenes");
        for name in ["room", "mirrors-and-glass", "quadrics", "many-lights", "smooth-mesh"] {
            let desc = desc::load(format!("{scenes}/{name}.json").as_ref(), None).unwrap();
            let scene = Scene::build(&desc, &BuildOptions::default()).unwrap();
            let (sobol, pattern) = (SobolSampler::new(3, 64).in_turn(8), PatternSampler::new(Pattern::Jittered, 3, 16));
            compare(&scene, &Path { max_depth: None, shadow_rays: 1 }, &sobol);
            compare(&scene, &Path { max_depth: Some(4), shadow_rays: 3 }, &pattern);
            compare(&scene, &Direct { shadow_rays: 2 }, &sobol);
            // Shapes in Embree's tree are user geometry.
            let all = BuildOptions { listed_shapes: Some(0), ..BuildOptions::default() };
            compare(&Scene::build(&desc, &all).unwrap(), &Path { max_depth: None, shadow_rays: 1 }, &sobol);
            // Larger meshes are instances.
            let dynamic = BuildOptions { dynamic: true, ..BuildOptions::default() };
            compare(&Scene::build(&desc, &dynamic).unwrap(), &Path { max_depth: None, shadow_rays: 1 }, &sobol);
        }
    }
}
