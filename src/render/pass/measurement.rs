//! What a sample of a pixel measures: the radiance along a camera ray, the irradiance of a site of a light map, or the light at a point. Samples
//! are taken in batches, by a tracer that counts their rays.

use std::marker::PhantomData;

use super::Pass;
use crate::camera::MovingCamera;
use crate::film::PixelPhotonState;
use crate::integrator::reuse::GROUP;
use crate::integrator::{Context, Irradiance, Probes, Sample, Tracer, Transport};
use crate::math::Ray;
use crate::sampling::Sampler;
use crate::scene::{Backplate, Hit, Scene};
use crate::spectrum::{Rgb, Spectrum};

/// Number of samples that are taken in one wave: enough to fill ray packets when most paths have ended, and few enough for the
/// data to stay in the first caches.
const WAVE: usize = 128;

/// Number of samples that are taken one after another between two checks of the clock and two additions to the film, by
/// integrators without waves.
const SAMPLES_PER_BATCH: usize = 16;

/// A tracer that counts rays. Once the pass is stopped, rays hit nothing, so that even long paths end soon.
pub(super) struct PassTracer<'p> {
    scene: &'p Scene,
    pass: &'p Pass,
    pub rays: u64,
    /// Number of the last ray that is traced in a replay; `u64::MAX` in other passes.
    limit: u64,
}

impl<'p> PassTracer<'p> {
    pub fn new(pass: &'p Pass) -> Self {
        let limit = pass.replay.as_ref().map_or(u64::MAX, |replay| replay.limit);
        Self { scene: &pass.input.scene, pass, rays: 0, limit }
    }
}

/// The hit of a ray at the limit of a replay. After the limit, and in a pass that was stopped, rays hit nothing.
///
/// The arguments are copies. With references to the tracer or the ray, the compiler would keep both in memory, which costs
/// 5 % of all rays per second.
#[cold]
#[inline(never)]
fn intersect_at_end(pass: &Pass, ray: Ray, number: u64) -> Option<Hit> {
    let replay = pass.replay.as_ref().filter(|_| !pass.is_stopped())?;
    replay.intersect(&pass.input.scene, ray, number)
}

impl Tracer for PassTracer<'_> {
    #[inline(always)]
    fn intersect(&mut self, ray: &Ray) -> Option<Hit> {
        self.rays += 1;
        if self.pass.is_stopped() | (self.rays >= self.limit) {
            return intersect_at_end(self.pass, *ray, self.rays);
        }
        self.scene.intersect(ray)
    }

    #[inline]
    fn unoccluded(&mut self, ray: &Ray) -> bool {
        self.rays += 1;
        !self.pass.is_stopped() && self.scene.unoccluded(ray)
    }

    #[inline]
    fn intersect_many(&mut self, rays: &[Ray], hits: &mut [Option<Hit>]) {
        let before = self.rays;
        self.rays += rays.len() as u64;
        if self.pass.is_stopped() | (self.rays >= self.limit) {
            for (number, (ray, hit)) in (before + 1..).zip(rays.iter().zip(hits)) {
                *hit = intersect_at_end(self.pass, *ray, number);
            }
        } else {
            self.scene.intersect_many(rays, hits);
        }
    }

    #[inline]
    fn unoccluded_many(&mut self, rays: &[Ray], clear: &mut [bool]) {
        self.rays += rays.len() as u64;
        if self.pass.is_stopped() {
            clear.fill(false);
        } else {
            self.scene.unoccluded_many(rays, clear);
        }
    }
}

/// A sample of a pixel that is to be taken.
pub(super) struct SampleJob {
    /// Column and row in the picture, of which the film may be a part.
    pub pixel: [u32; 2],
    /// Index of the pixel in its tile; `None` for a sample that only belongs to the group of others.
    pub index: Option<usize>,
    pub sample: u32,
    /// Offset of the film position from the pixel's middle in pixels, drawn from the filter.
    pub offset: [f32; 2],
    /// Weight of the sample by the filter.
    pub weight: f32,
    /// The moment that the sample sees, where the camera moves.
    pub time: f32,
    /// A copy of the pixel's photon state, since the sample may be stopped in the middle. Samples with a photon state are
    /// taken one at a time.
    pub gathering: Option<PixelPhotonState>,
}

impl SampleJob {
    /// The number of the pixel where the film is the picture, row by row.
    fn number(&self, pass: &Pass) -> usize {
        let [x, y] = self.pixel;
        (y * pass.input.film.options().resolution[0] + x) as usize
    }

    /// The film position, in pixels.
    pub fn place(&self) -> [f32; 2] {
        let [column, row] = self.pixel.map(|index| index as f32 + 0.5);
        [column + self.offset[0], row + self.offset[1]]
    }
}

/// The samples that a worker takes at the same time.
pub(super) struct Batch<S, M: Measurement> {
    pub jobs: Vec<SampleJob>,
    /// Samples for the jobs; there may be more samples than jobs.
    pub samples: Vec<Sample<S, M::Carried>>,
    /// Index after the last job of each group.
    pub ends: Vec<usize>,
    memory: M::Memory,
    /// Greatest number of jobs in a group: 1 where samples are independent.
    pub group: usize,
    /// Greatest number of jobs at present. It begins at one group and doubles, so that even passes that are stopped soon make
    /// progress.
    pub limit: usize,
}

impl<S: Clone, M: Measurement> Batch<S, M> {
    /// Makes an empty batch for up to `capacity` jobs in groups of up to `group`.
    pub fn new(sampler: &S, capacity: usize, group: usize) -> Self {
        let capacity = capacity.max(group);
        Self {
            jobs: Vec::with_capacity(capacity),
            samples: vec![Sample::new(sampler.clone()); capacity],
            ends: Vec::with_capacity(capacity),
            memory: M::Memory::default(),
            group,
            limit: group,
        }
    }
}

/// The quantity that a pixel measures.
pub(super) trait Measurement: Sync {
    /// What the samples carry: three channels, or several wavelengths, of which the film gets the colour.
    type Carried: Spectrum;
    /// What is kept from batch to batch.
    type Memory: Default;

    /// Number of samples in a batch. It is 1 where a sample needs the state that the pixel's previous sample left.
    fn batch_size(&self, _pass: &Pass) -> usize {
        SAMPLES_PER_BATCH
    }

    /// Greatest number of samples in a group, whose estimates depend on each other.
    fn group_size(&self) -> usize {
        1
    }

    /// Takes the samples of all jobs.
    fn take<S: Sampler, T: Tracer>(&self, pass: &Pass, batch: &mut Batch<S, Self>, tracer: &mut T)
    where
        Self: Sized;
}

/// Radiance along camera rays.
pub(super) struct CameraRadiance<'i, I, C = Rgb>(&'i I, PhantomData<C>);

impl<'i, I, C> CameraRadiance<'i, I, C> {
    pub fn new(integrator: &'i I) -> Self {
        Self(integrator, PhantomData)
    }
}

impl<I: Transport<C>, C: Spectrum> Measurement for CameraRadiance<'_, I, C> {
    type Carried = C;
    type Memory = I::Memory;

    /// A wave, or with several shadow rays per hit the number of paths whose shadow rays make a wave. Those of first hits are a part of all.
    fn batch_size(&self, pass: &Pass) -> usize {
        match (I::IN_WAVES, pass.input.film.options().gathering) {
            (true, _) => {
                (WAVE / pass.input.desc.shadow_rays.max(pass.input.first_shadow_rays / 8).max(1) as usize).max(1)
            }
            (false, true) => 1,
            (false, false) => SAMPLES_PER_BATCH,
        }
    }

    fn group_size(&self) -> usize {
        if I::IN_GROUPS { GROUP } else { 1 }
    }

    #[inline(always)]
    fn take<S: Sampler, T: Tracer>(&self, pass: &Pass, batch: &mut Batch<S, Self>, tracer: &mut T) {
        let Batch { jobs, ends, samples, memory, .. } = batch;
        let samples = &mut samples[..jobs.len()];
        for (job, sample) in jobs.iter().zip(samples.iter_mut()) {
            let [x, y] = job.pixel;
            sample.ray = pass.input.camera.ray(x as f32 + 0.5 + job.offset[0], y as f32 + 0.5 + job.offset[1]);
        }
        if pass.input.camera.has_lens() && pass.input.moving_camera.is_none() {
            // The point on the lens is the next two dimensions after the film position, so that both are stratified together.
            for (job, sample) in jobs.iter().zip(samples.iter_mut()) {
                let [x, y] = [0, 1].map(|axis| job.pixel[axis] as f32 + 0.5 + job.offset[axis]);
                sample.ray = pass.input.camera.ray_through_lens(x, y, sample.sampler.next_2d());
            }
        }
        if pass.input.scene.asks_footprints() {
            for (job, sample) in jobs.iter().zip(samples.iter_mut()) {
                let [x, y] = job.pixel;
                sample.ray.cone = pass.input.camera.cone(x as f32 + 0.5, y as f32 + 0.5);
            }
        }
        if pass.input.scene.uses_time() {
            // Each sample sees the scene at a moment of its own, spread over the shutter interval, or at that of its photons.
            let common = self.0.moment();
            for sample in samples.iter_mut() {
                let [time, _] = sample.sampler.next_2d();
                sample.ray.time = common.unwrap_or_else(|| pass.input.scene.moment(time));
            }
        }
        if let Some(moving) = &pass.input.moving_camera {
            leave_moving_camera(pass, moving, jobs, samples);
        }
        if C::HAS_WAVELENGTHS {
            for sample in samples.iter_mut() {
                sample.wavelengths = self.0.wavelengths(&mut sample.sampler, pass.input.sensor);
            }
        }
        if I::IN_WAVES {
            self.0.li_of_many(&pass.input.scene, samples, ends, memory, tracer);
        } else {
            for (job, Sample { ray, sampler, radiance, first, wavelengths, .. }) in
                jobs.iter_mut().zip(samples.iter_mut())
            {
                *first = None;
                let first = &mut |hit| *first = Some(hit);
                let gathering = job.gathering.as_mut();
                let wavelengths = *wavelengths;
                let mut context = Context { scene: &pass.input.scene, sampler, tracer, wavelengths };
                *radiance = self.0.li_of_pixel(*ray, &mut context, first, gathering);
            }
        }
        if let Some(backplate) = pass.input.scene.backplate() {
            show_backplate(pass, backplate, jobs, samples);
        }
    }
}

/// Puts the backplate in place of what comes from infinity, in the samples whose camera rays met nothing.
#[cold]
#[inline(never)]
fn show_backplate<S, C: Spectrum>(
    pass: &Pass,
    backplate: &Backplate,
    jobs: &[SampleJob],
    samples: &mut [Sample<S, C>],
) {
    let scene = &pass.input.scene;
    for (job, sample) in jobs.iter().zip(samples).filter(|(_, sample)| sample.first.is_none()) {
        // No surface was met where the medium around the camera could end: on an endless way, it absorbs every channel that it
        // absorbs at all.
        let left = match scene.media_at(&sample.ray).filter(|media| !media.is_empty()) {
            Some(media) => scene.transmittance::<C>(media, f32::INFINITY, &sample.wavelengths),
            None => C::ONE,
        };
        let color = backplate.radiance_at(job.place(), pass.input.desc.resolution);
        sample.radiance = left * C::from_emission(color, &sample.wavelengths);
        sample.parts = [sample.radiance, C::ZERO];
    }
}

/// Makes the rays of samples that have their times, from where the camera is then.
#[cold]
#[inline(never)]
fn leave_moving_camera<S: Sampler, C: Spectrum>(
    pass: &Pass,
    moving: &MovingCamera,
    jobs: &mut [SampleJob],
    samples: &mut [Sample<S, C>],
) {
    let has_cones = pass.input.scene.asks_footprints();
    for (job, sample) in jobs.iter_mut().zip(samples) {
        let time = sample.ray.time;
        let camera = moving.at(time);
        let [x, y] = job.place();
        let ray =
            if camera.has_lens() { camera.ray_through_lens(x, y, sample.sampler.next_2d()) } else { camera.ray(x, y) };
        sample.ray = ray.at_time(time);
        if has_cones {
            let [column, row] = job.pixel.map(|index| index as f32 + 0.5);
            sample.ray.cone = camera.cone(column, row);
        }
        job.time = time;
    }
}

/// Irradiance of sites. A site has the number of its pixel.
impl Measurement for Irradiance {
    type Carried = Rgb;
    type Memory = ();

    #[inline(always)]
    fn take<S: Sampler, T: Tracer>(&self, pass: &Pass, batch: &mut Batch<S, Self>, tracer: &mut T) {
        for (job, sample) in batch.jobs.iter().zip(&mut batch.samples) {
            let site = job.number(pass);
            let place = job.offset.map(|offset| offset + 0.5);
            sample.radiance = self.estimate(&pass.input.scene, site, place, &mut sample.sampler, tracer);
        }
    }
}

/// Light at points of space. A point has the number of its pixel.
impl Measurement for Probes {
    type Carried = Rgb;
    type Memory = ();

    #[inline(always)]
    fn take<S: Sampler, T: Tracer>(&self, pass: &Pass, batch: &mut Batch<S, Self>, tracer: &mut T) {
        for (job, sample) in batch.jobs.iter().zip(&mut batch.samples) {
            let number = job.number(pass);
            sample.radiance = self.estimate(&pass.input.scene, number, &mut sample.sampler, tracer);
        }
    }
}
