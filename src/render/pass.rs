//! One pass: some samples for every pixel, tile by tile, in parallel.

use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::time::Instant;

use rayon::prelude::*;

use crate::camera::Camera;
use crate::desc::{IntegratorDesc, RenderDesc, SamplerDesc};
use crate::film::{FilmOptions, TILE, TileMut};
use crate::integrator::{Direct, Integrator, Path, SceneTracer, Whitted};
use crate::sampling::{Filter, Pattern, PatternSampler, Sampler, SobolSampler};
use crate::scene::Scene;

/// Everything the workers of a pass share.
#[derive(Clone, Copy)]
pub(super) struct Pass<'a> {
    pub scene: &'a Scene,
    pub camera: &'a Camera,
    pub filter: &'a Filter,
    pub desc: &'a RenderDesc,
    /// Samples that each pixel is to have afterwards. It goes on from those it has, so that a render that was stopped in
    /// the middle of a pass can be resumed.
    pub samples: u32,
    pub film: FilmOptions,
    pub deadline: Option<Instant>,
    pub stop: &'a AtomicBool,
    pub rays: &'a AtomicU64,
    pub tiles_done: &'a AtomicU64,
}

impl Pass<'_> {
    /// Chooses integrator and sampler once; from here on nothing is dispatched.
    pub(super) fn run(&self, tiles: &mut [TileMut]) {
        let shadow_rays = self.desc.shadow_rays;
        let max_depth = self.desc.max_depth;
        match self.desc.integrator {
            IntegratorDesc::Path => self.with_integrator(Path { max_depth, shadow_rays }, tiles),
            IntegratorDesc::Whitted => self.with_integrator(Whitted { max_depth, shadow_rays }, tiles),
            IntegratorDesc::Direct => self.with_integrator(Direct { shadow_rays }, tiles),
        }
    }

    fn with_integrator<I: Integrator>(&self, integrator: I, tiles: &mut [TileMut]) {
        let seed = self.desc.seed;
        let pattern = match self.desc.sampler {
            SamplerDesc::Sobol => {
                let sampler = SobolSampler::new(seed, self.film.replicate_size);
                return self.all_tiles(&integrator, &sampler, tiles);
            }
            SamplerDesc::Random => Pattern::Random,
            SamplerDesc::Jittered => Pattern::Jittered,
            SamplerDesc::Grid => Pattern::Grid,
            SamplerDesc::Gaussian => Pattern::Gaussian,
        };
        self.all_tiles(&integrator, &PatternSampler::new(pattern, seed, self.desc.samples), tiles);
    }

    fn all_tiles<I: Integrator, S: Sampler + Clone + Sync>(&self, integrator: &I, sampler: &S, tiles: &mut [TileMut]) {
        tiles.par_iter_mut().with_max_len(1).for_each(|tile| {
            if self.stop.load(Ordering::Relaxed) {
                return;
            }
            let rays = self.tile(integrator, &mut sampler.clone(), tile);
            self.rays.fetch_add(rays, Ordering::Relaxed);
            self.tiles_done.fetch_add(1, Ordering::Relaxed);
        });
    }

    /// All samples of one tile; returns the number of rays. Allocates nothing.
    fn tile<I: Integrator, S: Sampler>(&self, integrator: &I, sampler: &mut S, tile: &mut TileMut) -> u64 {
        let [width, height] = self.film.resolution;
        let [left, top] = tile.origin;
        let mut tracer = SceneTracer::new(self.scene);
        for y in top..(top + TILE).min(height) {
            if self.deadline.is_some_and(|deadline| Instant::now() >= deadline) {
                self.stop.store(true, Ordering::Relaxed);
            }
            for x in left..(left + TILE).min(width) {
                // Pixels go on from where they are, so stopping between any two of them is safe.
                if self.stop.load(Ordering::Relaxed) {
                    return tracer.rays;
                }
                let index = ((y - top) * TILE + (x - left)) as usize;
                let pixel = &mut tile.pixels[index];
                for sample in pixel.count()..self.samples {
                    sampler.start(y * width + x, sample);
                    let (offset, weight) = self.filter.sample(sampler.pixel_2d());
                    let ray = self.camera.ray(x as f32 + 0.5 + offset[0], y as f32 + 0.5 + offset[1]);
                    let auxiliary = tile.auxiliary.get_mut(index);
                    let mut first = None;
                    let radiance =
                        integrator.radiance(self.scene, ray, sampler, &mut tracer, &mut |hit| first = Some(hit));
                    pixel.add(radiance, weight, self.film.replicate_size);
                    if let (Some(auxiliary), Some(hit)) = (auxiliary, first) {
                        auxiliary.add(hit.albedo, hit.normal, self.camera.depth(hit.p));
                    }
                }
            }
        }
        tracer.rays
    }
}
