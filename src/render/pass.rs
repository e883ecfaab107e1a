//! One pass: some samples for every pixel, tile by tile, in parallel.

use std::sync::atomic::{AtomicBool, AtomicU64, AtomicUsize, Ordering};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Instant;

use super::Render;
use super::non_finite::{Replay, Suspects};
use super::workers::Work;
use crate::Cancel;
use crate::camera::Camera;
use crate::desc::{IntegratorDesc, RenderDesc, SamplerDesc};
use crate::film::{Film, TILE};
use crate::integrator::{Direct, Integrator, Path, Tracer, Whitted};
use crate::math::Ray;
use crate::sampling::{Filter, Pattern, PatternSampler, Sampler, SobolSampler};
use crate::scene::{Hit, Scene};

/// Everything the workers of a pass share.
pub(super) struct Pass {
    scene: Scene,
    camera: Camera,
    filter: Filter,
    desc: Arc<RenderDesc>,
    /// Samples that each pixel is to have afterwards. It goes on from those it has, so that a render that was stopped in
    /// the middle of a pass can be resumed.
    samples: u32,
    film: Arc<Film>,
    deadline: Option<Instant>,
    cancel: Cancel,
    pub stop: AtomicBool,
    pub rays: AtomicU64,
    /// Samples that were NaN or infinite.
    pub non_finite: Mutex<Suspects>,
    /// The tile that is taken next.
    next: AtomicUsize,
    tiles_done: AtomicUsize,
}

/// Traces, counts, and once the pass is stopped finds nothing more, so that the longest path soon ends.
struct PassTracer<'p> {
    scene: &'p Scene,
    pass: &'p Pass,
    rays: u64,
}

impl Tracer for PassTracer<'_> {
    #[inline]
    fn intersect(&mut self, ray: &Ray) -> Option<Hit> {
        self.rays += 1;
        if self.pass.is_stopped() {
            return None;
        }
        self.scene.intersect(ray)
    }

    #[inline]
    fn unoccluded(&mut self, ray: &Ray) -> bool {
        self.rays += 1;
        !self.pass.is_stopped() && self.scene.unoccluded(ray)
    }
}

impl Work for Pass {
    fn take(&self, pause: &mut dyn FnMut() -> bool) -> bool {
        self.dispatch(AllTiles { pause })
    }

    fn is_done(&self) -> bool {
        self.is_complete() || self.is_stopped()
    }

    fn abandon(&self) {
        self.stop.store(true, Ordering::Relaxed);
    }

    fn shares(&self) -> usize {
        self.film.tile_count()
    }
}

impl Pass {
    /// A pass of `render` up to so many samples of each pixel, cut short at `deadline`.
    pub(super) fn new(render: &Render, samples: u32, deadline: Option<Instant>) -> Self {
        Self {
            scene: render.scene.clone(),
            camera: render.camera,
            filter: render.filter.clone(),
            desc: Arc::clone(&render.desc),
            samples,
            film: Arc::clone(&render.film),
            deadline,
            cancel: render.settings.cancel.clone(),
            stop: AtomicBool::new(false),
            rays: AtomicU64::new(0),
            non_finite: Mutex::default(),
            next: AtomicUsize::new(0),
            tiles_done: AtomicUsize::new(0),
        }
    }

    /// Whether every pixel has its samples.
    pub(super) fn is_complete(&self) -> bool {
        self.tiles_done.load(Ordering::Acquire) == self.film.tile_count()
    }

    /// Share of the tiles that are done.
    pub(super) fn share(&self) -> f64 {
        self.tiles_done.load(Ordering::Relaxed) as f64 / self.film.tile_count().max(1) as f64
    }

    #[inline]
    fn is_stopped(&self) -> bool {
        self.stop.load(Ordering::Relaxed) || self.cancel.is_cancelled()
    }

    /// The sample again, for who wants to know why it is not finite.
    pub(super) fn replay(&self, pixel: [u32; 2], sample: u32) -> Replay {
        self.dispatch(Again { pixel, sample })
    }

    /// Chooses integrator and sampler once; from here on nothing is dispatched.
    fn dispatch<J: Job>(&self, job: J) -> J::Result {
        let shadow_rays = self.desc.shadow_rays;
        let max_depth = self.desc.max_depth;
        match self.desc.integrator {
            IntegratorDesc::Path => self.with_integrator(&Path { max_depth, shadow_rays }, job),
            IntegratorDesc::Whitted => self.with_integrator(&Whitted { max_depth, shadow_rays }, job),
            IntegratorDesc::Direct => self.with_integrator(&Direct { shadow_rays }, job),
        }
    }

    fn with_integrator<I: Integrator, J: Job>(&self, integrator: &I, job: J) -> J::Result {
        let seed = self.desc.seed;
        let pattern = match self.desc.sampler {
            SamplerDesc::Sobol => {
                let sampler = SobolSampler::new(seed, self.film.options().replicate_size);
                return job.run(self, integrator, &sampler);
            }
            SamplerDesc::Random => Pattern::Random,
            SamplerDesc::Jittered => Pattern::Jittered,
            SamplerDesc::Grid => Pattern::Grid,
            SamplerDesc::Gaussian => Pattern::Gaussian,
        };
        job.run(self, integrator, &PatternSampler::new(pattern, seed, self.desc.samples))
    }

    /// Starts a sample: the camera's ray and its filter weight.
    #[inline]
    fn camera_ray(&self, sampler: &mut impl Sampler, [x, y]: [u32; 2], sample: u32) -> (Ray, f32) {
        sampler.start(y * self.film.options().resolution[0] + x, sample);
        let (offset, weight) = self.filter.sample(sampler.pixel_2d());
        (self.camera.ray(x as f32 + 0.5 + offset[0], y as f32 + 0.5 + offset[1]), weight)
    }

    /// Takes tiles until there are none; false if it paused before that.
    fn all_tiles<I: Integrator, S: Sampler + Clone>(
        &self,
        integrator: &I,
        sampler: &S,
        pause: &mut dyn FnMut() -> bool,
    ) -> bool {
        loop {
            if self.is_stopped() {
                return true;
            }
            if pause() {
                return false;
            }
            let number = self.next.fetch_add(1, Ordering::Relaxed);
            if number >= self.film.tile_count() {
                return true;
            }
            let mut tracer = PassTracer { scene: &self.scene, pass: self, rays: 0 };
            let is_complete = self.tile(integrator, &mut sampler.clone(), number, &mut tracer, pause);
            self.rays.fetch_add(tracer.rays, Ordering::Relaxed);
            if is_complete {
                self.tiles_done.fetch_add(1, Ordering::Release);
            }
        }
    }

    /// All samples of one tile, unless the pass is stopped; whether they are complete. Allocates nothing but the tile.
    fn tile<I: Integrator, S: Sampler>(
        &self,
        integrator: &I,
        sampler: &mut S,
        number: usize,
        tracer: &mut PassTracer,
        pause: &mut dyn FnMut() -> bool,
    ) -> bool {
        let [width, height] = self.film.options().resolution;
        let replicate_size = self.film.options().replicate_size;
        let [left, top] = self.film.tile_origin(number);
        for y in top..(top + TILE).min(height) {
            if self.deadline.is_some_and(|deadline| Instant::now() >= deadline) {
                self.abandon();
            }
            // A tile is finished before its worker gives way; but who works for itself may want to look up.
            pause();
            let mut tile = self.film.tile(number);
            let tile = &mut *tile;
            for x in left..(left + TILE).min(width) {
                let index = ((y - top) * TILE + (x - left)) as usize;
                let pixel = &mut tile.pixels[index];
                for sample in pixel.count()..self.samples {
                    let (ray, weight) = self.camera_ray(sampler, [x, y], sample);
                    let mut first = None;
                    let radiance = integrator.radiance(&self.scene, ray, sampler, tracer, &mut |hit| first = Some(hit));
                    // Pixels go on from where they are, so stopping between any two samples is safe; one during which it
                    // was stopped may have missed something, and is taken again.
                    if self.is_stopped() {
                        return false;
                    }
                    if !radiance.is_finite() {
                        self.note_non_finite([x, y], sample);
                    }
                    pixel.add(radiance, weight, replicate_size);
                    if let (Some(auxiliary), Some(hit)) = (tile.auxiliary.get_mut(index), first) {
                        auxiliary.add(hit.albedo, hit.normal, self.camera.depth(hit.p));
                    }
                }
            }
        }
        true
    }

    #[cold]
    fn note_non_finite(&self, pixel: [u32; 2], sample: u32) {
        self.non_finite.lock().unwrap_or_else(PoisonError::into_inner).add(pixel, sample);
    }
}

/// Something to do with the integrator and the sampler of a pass.
trait Job {
    type Result;

    fn run<I: Integrator, S: Sampler + Clone>(self, pass: &Pass, integrator: &I, sampler: &S) -> Self::Result;
}

struct AllTiles<'a> {
    pause: &'a mut dyn FnMut() -> bool,
}

impl Job for AllTiles<'_> {
    type Result = bool;

    fn run<I: Integrator, S: Sampler + Clone>(self, pass: &Pass, integrator: &I, sampler: &S) -> bool {
        pass.all_tiles(integrator, sampler, self.pause)
    }
}

struct Again {
    pixel: [u32; 2],
    sample: u32,
}

impl Job for Again {
    type Result = Replay;

    fn run<I: Integrator, S: Sampler + Clone>(self, pass: &Pass, integrator: &I, sampler: &S) -> Replay {
        Replay::new(&pass.scene, |tracer| {
            let mut sampler = sampler.clone();
            let (ray, _) = pass.camera_ray(&mut sampler, self.pixel, self.sample);
            integrator.radiance(&pass.scene, ray, &mut sampler, tracer, &mut |_| {})
        })
    }
}
