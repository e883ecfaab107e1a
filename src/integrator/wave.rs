//! Many paths traced side by side, hit by hit.
//!
//! Independent paths are traced together, since Embree answers their rays in packets in less time than one by one
//! (`docs/performance.md`). Each path gives the same result as if it were traced alone, to the last bit.
//!
//! Source: Laine, Karras, Aila 2013, "Megakernels Considered Harmful: Wavefront Path Tracing on GPUs".

use super::media::{light_through, seen};
use super::mirrored::{Folded, Way, unoccluded_by_mirrors};
use super::tracer::{FirstHit, Tracer};
use super::vertex::Vertex;
use super::walk::{Limits, Walk};
use crate::math::{Ray, Vec3};
use crate::sampling::Sampler;
use crate::scene::{Hit, PathMedia, Scene};
use crate::spectrum::{Rgb, Spectrum};

/// One of several samples that are estimated together.
#[derive(Clone, Debug)]
pub struct Sample<S, C: Spectrum = Rgb> {
    /// The camera ray.
    pub ray: Ray,
    /// Random numbers of the path, at the first dimensions after those of the ray.
    pub sampler: S,
    /// The estimated radiance.
    pub radiance: C,
    /// The wavelengths that the path carries.
    pub wavelengths: C::Wavelengths,
    /// The first hit of the ray, once it is known.
    pub first: Option<FirstHit>,
    /// What of the radiance was emitted towards the camera, and what was scattered once, where [`LightParts`](super::LightParts) keeps
    /// them apart.
    pub parts: [C; 2],
}

impl<S, C: Spectrum> Sample<S, C> {
    /// Creates a sample whose ray is still to be set.
    pub fn new(sampler: S) -> Self {
        Self {
            ray: Ray::new(Vec3::ZERO, Vec3::Z),
            sampler,
            radiance: C::ZERO,
            wavelengths: C::Wavelengths::default(),
            first: None,
            parts: [C::ZERO; 2],
        }
    }
}

/// The paths of a wave between two hits. The memory is kept from wave to wave, so that later waves do not allocate.
#[derive(Default)]
pub struct Wave<C: Spectrum = Rgb> {
    walks: Vec<Walk<C>>,
    /// Indices of the active paths, and their rays.
    active: Vec<u32>,
    rays: Vec<Ray>,
    hits: Vec<Option<Hit>>,
    /// Shadow rays, and for each the index of its path and the radiance that it contributes if it is unoccluded.
    shadows: Vec<Ray>,
    lights: Vec<(u32, C)>,
    clear: Vec<bool>,
    /// Ways to lamps by flat mirrors, with the same, and what each path has found by them; empty where no light sample looks for lamps
    /// there.
    ways: Vec<(Folded, (u32, C))>,
    mirrored: Vec<C>,
    /// The media of each path, and those at the origin of each shadow ray; empty in scenes without media.
    media: Vec<PathMedia>,
    shadow_media: Vec<PathMedia>,
}

impl<C: Spectrum> std::fmt::Debug for Wave<C> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Wave").field("paths", &self.walks.len()).finish_non_exhaustive()
    }
}

impl<C: Spectrum> Wave<C> {
    /// Traces the paths of all samples to their ends.
    #[inline(always)]
    pub(super) fn trace<S: Sampler, T: Tracer>(
        &mut self,
        scene: &Scene,
        samples: &mut [Sample<S, C>],
        tracer: &mut T,
        limits: &Limits,
    ) {
        if scene.has_media() {
            self.trace_in_media(scene, samples, tracer, limits);
        } else {
            self.trace_in::<false, false, S, T>(scene, samples, tracer, limits);
        }
    }

    /// The same, and keeps apart what was emitted towards the camera and what was scattered once.
    #[inline(never)]
    pub(super) fn trace_in_parts<S: Sampler, T: Tracer>(
        &mut self,
        scene: &Scene,
        samples: &mut [Sample<S, C>],
        tracer: &mut T,
        limits: &Limits,
    ) {
        if scene.has_media() {
            self.trace_in::<true, true, S, T>(scene, samples, tracer, limits);
        } else {
            self.trace_in::<false, true, S, T>(scene, samples, tracer, limits);
        }
    }

    #[cold]
    #[inline(never)]
    fn trace_in_media<S: Sampler, T: Tracer>(
        &mut self,
        scene: &Scene,
        samples: &mut [Sample<S, C>],
        tracer: &mut T,
        limits: &Limits,
    ) {
        self.trace_in::<true, false, S, T>(scene, samples, tracer, limits);
    }

    /// [`Self::trace`] in a scene with media (`MEDIA`) or in one without, and with parts of the light kept apart (`PARTS`) or not. The
    /// compiler makes all of them, so that a render without media and parts pays nothing for them.
    #[inline(always)]
    fn trace_in<const MEDIA: bool, const PARTS: bool, S: Sampler, T: Tracer>(
        &mut self,
        scene: &Scene,
        samples: &mut [Sample<S, C>],
        tracer: &mut T,
        limits: &Limits,
    ) {
        let Self { walks, active, rays, hits, shadows, lights, clear, ways, mirrored, media, shadow_media } = self;
        walks.clear();
        walks.resize(samples.len(), Walk::new(limits.previous));
        active.clear();
        active.extend(0..samples.len() as u32);
        rays.clear();
        rays.extend(samples.iter().map(|sample| sample.ray));
        samples.iter_mut().for_each(|sample| sample.first = None);
        hits.resize(samples.len().max(hits.len()), None);
        // The largest number of shadow rays that the vertices can send, up to the largest number that a description may ask
        // for, is reserved here, so that no later wave allocates.
        let most_shadows = samples.len() * limits.most_shadow_rays();
        shadows.clear();
        shadows.reserve(most_shadows);
        lights.clear();
        lights.reserve(most_shadows);
        clear.reserve(most_shadows.saturating_sub(clear.len()));
        ways.clear();
        mirrored.clear();
        if limits.mirrors.is_some() {
            ways.reserve(most_shadows);
            mirrored.resize(samples.len(), C::ZERO);
        }
        media.clear();
        if MEDIA {
            media.extend(rays.iter().filter_map(|ray| scene.media_at(ray)));
            shadow_media.clear();
            shadow_media.reserve(most_shadows);
        }

        while !active.is_empty() {
            let hits = &mut hits[..active.len()];
            tracer.intersect_many(rays, hits);
            scene.prefetch(hits);
            shadows.clear();
            lights.clear();
            if MEDIA {
                shadow_media.clear();
                for ((number, ray), hit) in active.iter().zip(&*rays).zip(hits.iter_mut()) {
                    let number = *number as usize;
                    *hit = seen(scene, tracer, ray, *hit, &mut media[number]);
                    walks[number].pass_media(
                        scene,
                        ray,
                        hit.as_ref(),
                        Some(media[number]),
                        &samples[number].wavelengths,
                    );
                }
            }
            let mut kept = 0;
            for (i, hit) in hits.iter().enumerate() {
                let number = active[i];
                let Sample { sampler, first, wavelengths, parts, .. } = &mut samples[number as usize];
                let Some(hit) = hit else {
                    walks[number as usize].escape(scene, &rays[i], wavelengths);
                    continue;
                };
                let mut slot = None;
                let arrived_in = MEDIA.then(|| media[number as usize]);
                let vertex = Vertex::new(scene, &rays[i], hit, *wavelengths, arrived_in, &mut slot);
                let next = walks[number as usize].meet(
                    scene,
                    &vertex,
                    sampler,
                    limits,
                    &mut |hit| *first = Some(hit),
                    |_, way, light| match way {
                        Way::Straight(shadow) => {
                            if MEDIA {
                                shadow_media.extend(vertex.media_beyond(scene, &shadow));
                            }
                            shadows.push(shadow);
                            lights.push((number, light));
                        }
                        Way::ByMirrors(way) => ways.push((way, (number, light))),
                    },
                );
                if PARTS {
                    // Light samples of this hit come later, so that this is what hits up to here emit.
                    let Walk { radiance, depth, .. } = walks[number as usize];
                    if let Some(part) = (depth as usize).checked_sub(1).and_then(|part| parts.get_mut(part)) {
                        *part = radiance;
                    }
                }
                if let Some(next) = next {
                    if MEDIA && let Some(beyond) = vertex.media_beyond(scene, &next) {
                        media[number as usize] = beyond;
                    }
                    (active[kept], rays[kept]) = (number, next);
                    kept += 1;
                }
            }
            active.truncate(kept);
            rays.truncate(kept);

            clear.resize(shadows.len(), false);
            tracer.unoccluded_many(shadows, clear);
            if MEDIA {
                for (i, (number, light)) in lights.iter_mut().enumerate() {
                    let wavelengths = &samples[*number as usize].wavelengths;
                    let (shadow, media) = (&shadows[i], shadow_media[i]);
                    let arriving = light_through(scene, tracer, shadow, media, clear[i], *light, wavelengths);
                    clear[i] = arriving.is_some();
                    *light = arriving.unwrap_or(C::ZERO);
                }
            }
            for ((number, light), clear) in lights.iter().zip(&*clear) {
                if *clear {
                    walks[*number as usize].radiance += *light;
                }
            }
            if !ways.is_empty() {
                unoccluded_by_mirrors(tracer, ways, shadows, clear, |(number, light)| {
                    mirrored[*number as usize] += *light;
                });
            }
        }
        for (sample, walk) in samples.iter_mut().zip(walks) {
            sample.radiance = walk.radiance;
            if PARTS {
                // Where the path ended earlier, all that it brought came by as few bounces.
                let kept = (walk.depth as usize).min(2);
                sample.parts[kept..].fill(walk.radiance);
                let [emission, up_to_direct] = sample.parts;
                sample.parts[1] = up_to_direct - emission;
            }
        }
        // No part of what was scattered once.
        for (sample, mirrored) in samples.iter_mut().zip(mirrored) {
            sample.radiance += *mirrored;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bsdf::{Bsdf, LobeMixture, Lobes};
    use crate::camera::Camera;
    use crate::desc;
    use crate::emitter::{Emitter, EmitterSet, EnvironmentEmitter, InfiniteBall};
    use crate::integrator::{Direct, Integrator, LightParts, Path, SceneTracer};
    use crate::sampling::{Pattern, PatternSampler, SobolSampler};
    use crate::scene::BuildOptions;

    /// Compares waves of all sizes with paths traced one by one: radiance, first hits and number of rays must agree.
    fn compare<I: Integrator, S: Sampler + Clone>(scene: &Scene, integrator: &I, sampler: &S) {
        const SIDE: u32 = 24;
        let camera = Camera::new(scene.camera(), [SIDE; 2], scene.centre()).unwrap();
        let (mut wave, mut lit, mut next) = (I::Memory::default(), 0, 0);
        for size in [1, 2, 15, 16, 17, 100, 300, 3, 122] {
            let mut samples = vec![Sample::new(sampler.clone()); size];
            for sample in &mut samples {
                let (pixel, index) = (next % (SIDE * SIDE), next / (SIDE * SIDE));
                next += 1;
                sample.sampler.start(pixel, index);
                let [x, y] = sample.sampler.pixel_2d();
                let [x, y] = [(pixel % SIDE) as f32 + x, (pixel / SIDE) as f32 + y];
                sample.ray = camera.ray(x, y).at_time((next % 17) as f32 / 16.0);
                sample.ray.cone = camera.cone(x, y);
            }
            let (mut together, mut alone) = (SceneTracer::new(scene), SceneTracer::new(scene));
            let before = samples.clone();
            integrator.radiance_of_many(scene, &mut samples, &[], &mut wave, &mut together);
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
            compare(&scene, &Path::new(None, 1), &sobol);
            compare(&scene, &Path::new(Some(4), 3), &pattern);
            compare(&scene, &Path { first_shadow_rays: 4, ..Path::new(None, 1) }, &sobol);
            compare(&scene, &Direct { shadow_rays: 2 }, &sobol);
            compare(&scene, &LightParts::from(Path::new(None, 1)), &sobol);
            // Shapes are user geometry in Embree's tree.
            let all = BuildOptions { listed_shapes: Some(0), ..BuildOptions::default() };
            compare(&Scene::build(&desc, &all).unwrap(), &Path::new(None, 1), &sobol);
            // Larger meshes are instances.
            let dynamic = BuildOptions { dynamic: true, ..BuildOptions::default() };
            compare(&Scene::build(&desc, &dynamic).unwrap(), &Path::new(None, 1), &sobol);
        }
    }

    /// Paths that leave the scene, and those that scatter by chosen lobes on both sides.
    #[test]
    fn a_path_in_a_wave_finds_an_environment_and_all_lobes_as_it_does_alone() {
        let file = concat!(env!("CARGO_MANIFEST_DIR"), "/scenes/quadrics.json");
        let desc = desc::load(file.as_ref(), None).unwrap();
        let mut scene = Scene::build(&desc, &BuildOptions::default()).unwrap();
        let grey = |lobe: Lobes| (lobe, Rgb::splat(0.15));
        for material in 0..scene.materials().len() {
            scene.set_bsdf(
                material,
                Bsdf::LobeMixture(LobeMixture::new(&Lobes::all().iter().map(grey).collect::<Vec<_>>(), 20.0)),
            );
        }
        let bounds = scene.info().bounds;
        let (centre, radius) = (scene.to_scene(bounds.centre()), (bounds.max - bounds.min).length() as f32);
        let mut emitters = scene.emitters().emitters().to_vec();
        emitters.push(Emitter::Environment(EnvironmentEmitter::new(
            Rgb::new(0.5, 1.0, 2.0),
            InfiniteBall::new(centre, radius),
        )));
        scene.set_emitters(EmitterSet::new(emitters));
        let sobol = SobolSampler::new(3, 64).in_turn(8);
        compare(&scene, &Path::new(None, 2), &sobol);
        compare(&scene, &Direct { shadow_rays: 1 }, &sobol);
    }

    /// Rays that pass hidden surfaces, shadow rays inside of media, and a camera in a medium.
    #[test]
    fn a_path_in_a_wave_passes_media_as_it_does_alone() {
        use crate::integrator::media::tests::{aquarium, pond};
        let sobol = SobolSampler::new(3, 64).in_turn(8);
        let texts = [aquarium(2.6), aquarium(0.6), pond(-0.5)];
        for text in &texts {
            let desc = desc::parse(text, "".as_ref(), None).unwrap();
            let scene = Scene::build(&desc, &BuildOptions::default()).unwrap();
            assert!(scene.has_media());
            compare(&scene, &Path::new(None, 2), &sobol);
            compare(&scene, &LightParts::from(Path::new(None, 2)), &sobol);
            if std::ptr::eq(text, &texts[0]) {
                // Inside of the water, few samples find direct light.
                compare(&scene, &Direct { shadow_rays: 1 }, &sobol);
            }
        }
    }

    /// Rays of different times, rays that pass surfaces, and rays with cones.
    #[test]
    fn a_path_in_a_wave_sees_motion_opacity_and_footprints_as_it_does_alone() {
        use crate::scene::motion::crossing_balls;
        use crate::scene::varying::{footprints, veiled_floor};
        let sobol = SobolSampler::new(3, 64).in_turn(8);
        for scene in [crossing_balls(false), crossing_balls(true), veiled_floor(), footprints()] {
            compare(&scene, &Path::new(None, 2), &sobol);
            compare(&scene, &Direct { shadow_rays: 1 }, &sobol);
        }
    }
}
