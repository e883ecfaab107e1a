//! Renders that go on from a checkpoint.

use std::sync::Arc;

use super::super::schedule::Schedule;
use super::super::ways::Ways;
use super::super::{Maps, Render, RenderSettings};
use super::{Checkpoint, Header, damaged};
use crate::desc::{IntegratorDesc, RenderDesc};
use crate::error::{Error, ErrorKind, Result};
use crate::film::Film;
use crate::integrator::radiosity::Steps;
use crate::integrator::{check_first_shadow_rays, check_light_paths};
use crate::scene::Scene;

impl Render {
    /// Prepares a render that goes on from a checkpoint. It comes to the same film as a render that was never interrupted, to the last
    /// bit.
    ///
    /// Scene and settings must be those of the checkpoint. These may differ: the number of samples with the samplers `Sobol` and
    /// `Random`, the time limit, the target error, threads, and the plan of further checkpoints. `adaptive`, `reuse`, `light_paths`,
    /// `first_shadow_rays`, `share` and the layers of first hits and of parts of the light are those of the checkpoint where the settings
    /// leave them open. With more samples than the render was begun with, an adaptive render chooses among pixels at other numbers of samples
    /// than one that was begun with as many, and what [`IntegratorDesc::Auto`] chose for fewer samples stays.
    ///
    /// [`Summary::rays`](crate::render::Summary::rays) counts those of this render alone, as its time does.
    ///
    /// # Errors
    /// The errors of [`Render::new`], and [`crate::ErrorKind::Unsupported`] for a checkpoint that does not fit, with what differs.
    pub fn resume(scene: &Scene, settings: RenderSettings, checkpoint: Checkpoint) -> Result<Self> {
        let Checkpoint { header, film, stage, photons } = checkpoint;
        let adaptive = settings.adaptive.or(Some(header.adaptive.is_some()));
        let share = settings.share.or(header.share());
        let auxiliary = settings.auxiliary || film.options().auxiliary;
        let light_parts = settings.light_parts || film.options().light_parts;
        let mut render = Self::new(scene, RenderSettings { adaptive, share, auxiliary, light_parts, ..settings })?;
        // Of light paths that were asked for, there are none in a scene without what they would meet.
        let light_paths = render.desc.light_paths.and(render.ways().light_paths);
        let RenderDesc { reuse, first_shadow_rays, .. } = *render.desc;
        Header { reuse, light_paths, first_shadow_rays, ..render.header.clone() }.check(&header)?;
        if header.light_paths.is_some_and(|count| count > 0) {
            check_light_paths(scene, render.integrator(), &render.desc)?;
        }
        let own = render.desc.shadow_rays;
        if header.first_shadow_rays.is_some_and(|count| count != own) {
            check_first_shadow_rays(render.integrator())?;
        }
        // A render that has begun without a number or a choice of its own goes on as it began.
        let has_begun = header.samples > 0;
        let first_shadow_rays = header.first_shadow_rays.or(has_begun.then_some(own));
        let cache = header.cache.or(has_begun.then_some(false));
        let solution = header.solution.or(has_begun.then_some(Steps::WHOLE));
        render.set_ways(Ways { first_shadow_rays, cache, solution, ..header.ways() });
        if cache == Some(true) && render.integrator() != IntegratorDesc::IrradianceCache {
            return Err(damaged("its render took an irradiance cache that these settings do not ask for"));
        }
        // Another render may still fill the film of a checkpoint that was not read from a file.
        render.film = Arc::new(Arc::try_unwrap(film).or_else(|film| Film::copy_of(&film))?);
        render.stage = stage;
        if let (Some(plan), Some(state)) = (&mut render.plan, photons) {
            plan.resume(state);
        }
        render.samples = header.samples;
        let total = Schedule::new(&render.settings, 1, false).total();
        render.decision = header.decision.min(total);
        render.earlier_rays = header.rays;
        render.non_finite = render.film.non_finite();
        Ok(render)
    }

    /// The state of the render at this moment. Its film is that of the render, which goes on filling it.
    ///
    /// # Errors
    /// [`crate::ErrorKind::Unsupported`] for light maps and for light at given points.
    pub fn checkpoint(&self) -> Result<Checkpoint> {
        if self.method.is_of_places() {
            let message = format!("{} has no checkpoints; expected a picture", self.method.place_name());
            return Err(Error::new(ErrorKind::Unsupported, message));
        }
        Ok(self.state())
    }

    pub(in super::super) fn state(&self) -> Checkpoint {
        let Ways { reuse, light_paths, first_shadow_rays, cache, solution } = self.ways();
        let header = Header {
            reuse,
            light_paths,
            first_shadow_rays,
            cache,
            solution,
            samples: self.samples,
            decision: self.decision,
            stage: self.stage.as_ref().map(|stage| stage.span()),
            rays: self.earlier_rays + self.rays,
            ..self.header.clone()
        };
        let photons = self.plan.as_ref().and_then(Maps::state);
        Checkpoint { header, film: Arc::clone(&self.film), stage: self.stage.clone(), photons }
    }
}
