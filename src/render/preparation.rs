//! What a render makes before it takes samples: photon maps, a radiosity solution, a pilot, light paths. It is made by the workers of the
//! render, and time or the caller may end the render meanwhile.

use std::ops::ControlFlow;
use std::sync::Arc;
use std::time::Instant;

use super::Render;
use super::method::Method;
use super::pass::{Light, PassInput};
use super::pilot::{CacheToTry, pilot};
use super::report::{Ended, Progress};
use super::schedule::Schedule;
use super::ways::LIGHT_SEED;
use super::worker_pool::WorkerPool;
use crate::desc::Preparation;
use crate::error::{ErrorKind, Result};
use crate::integrator::light_tracing::LightPictures;
use crate::integrator::radiosity::{Extent, Radiosity, RadiosityPicture, Steps};

/// Part of a time limit that a radiosity solution may take, so that there is time for samples too, also for a render that goes on and makes
/// the same solution once more.
const SOLUTION_TIME: f64 = 0.75;

impl Render {
    /// Whether a radiosity solution has to be made before the first sample.
    pub(super) fn wants_solution(&self) -> bool {
        self.integrator().info().preparation == Preparation::RadiositySolution && self.radiosity.is_none()
    }

    /// How far the radiosity solution goes that the render begins with. Time ends none of a share, since those of the others might end
    /// elsewhere, and none of light at given places, of which there is to be the best.
    fn extent(&self, start: Instant) -> Extent {
        let is_whole = self.settings.share.is_some() || self.method.is_of_places();
        let limit = self.settings.time_limit.filter(|_| !is_whole).map(|limit| limit.mul_f64(SOLUTION_TIME));
        match (self.solution, limit.and_then(|limit| start.checked_add(limit))) {
            (Some(steps), _) => Extent::Steps(steps),
            (None, Some(end)) => Extent::Until(end),
            (None, None) => Extent::Steps(Steps::WHOLE),
        }
    }

    /// Whether time may end a radiosity solution that is still to be made.
    pub(super) fn has_open_solution(&self) -> bool {
        self.wants_solution() && matches!(self.extent(Instant::now()), Extent::Until(_))
    }

    /// Makes the photon maps, the radiosity solution or the pilot that the next samples need. Returns the reason if the render
    /// ended meanwhile.
    pub(super) fn prepare(
        &mut self,
        schedule: &Schedule,
        start: Instant,
        progress: &mut dyn FnMut(&Progress) -> ControlFlow<()>,
    ) -> Result<Option<Ended>> {
        let wants_solution = self.wants_solution();
        if self.plan.is_none() && !wants_solution && self.undecided.is_none() {
            return Ok(None);
        }
        let undecided = self.undecided.clone().map(|open| {
            // Squares are rendered beside light paths that were asked for.
            let light = self.light_paths.clone().map(|paths| Light { paths, pictures: LightPictures::default() });
            (PassInput { light, ..self.pass_input() }, open)
        });
        let (samples, rays) = (self.samples, self.rays);
        let mut callback = |fraction| {
            if wants_solution {
                schedule.prepared.set(fraction);
            }
            let report = schedule.progress(samples, f64::from(samples), rays, start.elapsed(), None);
            progress(&report).is_break()
        };
        let deadline = self.deadline(start);
        let extent = self.extent(start);
        let mut pool = WorkerPool::new(&self.workers, &self.settings.cancel, deadline, &mut callback);
        let time_left = self.settings.time_limit.map(|limit| limit.saturating_sub(start.elapsed()));
        let made = match (&mut self.plan, undecided) {
            (_, Some((input, open))) => {
                let cache = self.cache.as_mut().filter(|_| open.cache).map(|plan| CacheToTry { plan, time_left });
                let found = pilot(&input, &open, cache, &mut pool);
                found.map(|found| {
                    self.rays += found.rays;
                    if let Some(paths) = open.light.filter(|_| found.traces_light()) {
                        self.light_paths = Some(paths.with_count(found.count));
                    }
                    if open.first_shadow_rays {
                        self.first_shadow_rays = self.desc.shadow_rays * found.first_shadow_rays;
                    }
                    let sharing = open.sharing.filter(|_| found.shares());
                    self.found = Some(found);
                    sharing.map_or_else(|| self.method.clone(), Method::Reuse)
                })
            }
            (Some(plan), None) => {
                let before = plan.rays();
                let gather = plan.gather(samples, &mut pool);
                self.rays += plan.rays() - before;
                gather
            }
            (None, None) => Radiosity::solve_to(&self.scene, &self.desc.radiosity, extent, &mut pool).map(|solution| {
                let solution = Arc::new(solution);
                self.radiosity = Some(Arc::clone(&solution));
                schedule.prepared.set(1.0);
                let (is_gather, shadow_rays) = (self.desc.radiosity.final_gather, self.desc.shadow_rays);
                let picture = RadiosityPicture::new(&self.scene, solution, is_gather, shadow_rays);
                match &self.method {
                    Method::Probes(probes) => Method::Probes(probes.by_radiosity(picture)),
                    _ => Method::Radiosity(picture),
                }
            }),
        };
        let is_cancelled = pool.is_stopped_by_callback || self.settings.cancel.is_cancelled();
        match unless_ended(made, is_cancelled)? {
            Err(ended) => return Ok(Some(ended)),
            Ok(method) => self.method = method,
        }
        match self.undecided.take() {
            Some(_) => self.settle_choice(schedule, start, progress),
            None => Ok(None),
        }
    }

    /// Takes what the pilot has found of the irradiance cache. Makes what the integrator needs that is chosen then, as [`Render::prepare`].
    fn settle_choice(
        &mut self,
        schedule: &Schedule,
        start: Instant,
        progress: &mut dyn FnMut(&Progress) -> ControlFlow<()>,
    ) -> Result<Option<Ended>> {
        let Some(cached) = self.found.as_ref().and_then(|found| found.cached.clone()) else { return Ok(None) };
        let why = cached.why();
        if cached.is_taken() {
            // What it found of other ways to trace paths is of no use.
            self.found = None;
            self.settle_cache(Some(&why));
            return self.prepare(schedule, start, progress);
        }
        self.settle_cache(None);
        if let Some(choice) = &mut self.choice {
            choice.why = format!("{}; {why}", choice.why);
        }
        Ok(None)
    }

    /// Traces the light paths of the next samples, where the render has light paths. Returns the reason if the render ended meanwhile.
    pub(super) fn trace_light(
        &mut self,
        count: u32,
        schedule: &Schedule,
        start: Instant,
        progress: &mut dyn FnMut(&Progress) -> ControlFlow<()>,
    ) -> Result<Option<Ended>> {
        let Some(paths) = self.light_paths.clone() else { return Ok(None) };
        let paths = match &self.method {
            Method::Reuse(reuse) => paths.beside_aims(reuse.aims()),
            _ => paths,
        };
        self.light_pictures = None;
        let deadline = self.deadline(start);
        let (samples, rays) = (self.samples, self.rays);
        let mut callback = |_| {
            let report = schedule.progress(samples, f64::from(samples), rays, start.elapsed(), None);
            progress(&report).is_break()
        };
        let mut pool = WorkerPool::new(&self.workers, &self.settings.cancel, deadline, &mut callback);
        let which = (samples, samples + count, self.desc.seed ^ LIGHT_SEED);
        let made = LightPictures::trace(&self.scene, &paths, &self.film, &self.filter, which, &mut pool);
        let is_cancelled = pool.is_stopped_by_callback || self.settings.cancel.is_cancelled();
        let (pictures, rays) = match unless_ended(made, is_cancelled)? {
            Err(ended) => return Ok(Some(ended)),
            Ok(made) => made,
        };
        self.light_pictures = Some(pictures);
        self.rays += rays;
        Ok(None)
    }
}

/// What was made, or how the render ended meanwhile: the caller stopped it, or else time did.
fn unless_ended<R>(made: Result<R>, is_cancelled: bool) -> Result<Result<R, Ended>> {
    match made {
        Err(error) if error.kind() == ErrorKind::Cancelled => {
            Ok(Err(if is_cancelled { Ended::Cancelled } else { Ended::Time }))
        }
        made => made.map(Ok),
    }
}
