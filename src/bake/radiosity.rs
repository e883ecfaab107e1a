//! Irradiance of sites from a radiosity solution: without noise, for diffuse scenes.

use std::ops::ControlFlow;
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};

use super::Baked;
use crate::control::Parallel;
use crate::desc::{RADII, RadiosityDesc};
use crate::error::{Error, ErrorKind, Result};
use crate::integrator::radiosity::Radiosity;
use crate::integrator::{Sites, no_reuse, no_wavelengths};
use crate::render::{RenderSettings, with_workers};
use crate::scene::Scene;
use crate::spectrum::Rgb;

/// Quadrature points of a site, whose mean is its irradiance: those of a (0, 2)-net.
const POINTS: u32 = 16;

/// Fraction of a bake's progress that the solution counts as; the rest is its evaluation at the sites.
const SOLUTION_FRACTION: f64 = 0.9;

/// Sites that one task of the thread pool evaluates.
const SITES_PER_TASK: usize = 1 << 12;

/// The irradiance [W m^-2] of each of these sites, on the outer side of the surface (`front`) or the inner one, from a
/// radiosity solution of the scene, which is returned too. The result is the same for any number of threads. Its
/// standard error is not known: NaN.
///
/// `element_size`: replaces the description's where that is not given, for example by the length of a texel. Of the
/// settings only `desc.radiosity`, workers, time limit and cancel are used. `progress` is called about ten times a
/// second and after each step on the calling thread, with the fraction of the work that is done, which only grows;
/// `Break` stops the work. Surfaces that neither reflect diffusely nor emit have irradiance 0.
///
/// # Errors
/// As for [`Radiosity::solve`]; [`ErrorKind::InvalidScene`] where there is no site; `Cancelled` if it was stopped, also
/// by the time limit, because half a solution is useless.
pub fn by_radiosity(
    scene: &Scene,
    sites: &Arc<Sites>,
    settings: &RenderSettings,
    element_size: Option<f64>,
    front: bool,
    progress: &mut dyn FnMut(f64) -> ControlFlow<()>,
) -> Result<(Baked, Arc<Radiosity>)> {
    if sites.is_empty() {
        return Err(Error::new(ErrorKind::InvalidScene, "there is no surface whose irradiance could be asked for"));
    }
    settings.check_sensor()?;
    if settings.desc.spectral {
        no_wavelengths("a light map")?;
    }
    if settings.desc.reuse == Some(true) {
        no_reuse("a light map has no neighbouring pixels", "false")?;
    }
    let own = &settings.desc.radiosity;
    // The value was not requested by the user, so it must not be refused as one that was.
    let element_size = element_size.map(|size| size.clamp(RADII[0], RADII[1]));
    let desc = RadiosityDesc { element_size: own.element_size.or(element_size), ..own.clone() };
    let count = sites.len().div_ceil(SITES_PER_TASK);
    let looked_up = Arc::new(AtomicUsize::new(0));
    let done = Arc::clone(&looked_up);
    let progress = &mut |solved: f64| {
        let sites = done.load(Ordering::Relaxed) as f64 / count as f64;
        progress(SOLUTION_FRACTION * solved + (1.0 - SOLUTION_FRACTION) * sites)
    };
    with_workers(settings, progress, |workers| {
        let solution = Arc::new(Radiosity::solve(scene, &desc, workers)?);
        workers.progress(1.0);
        let (scene, shared, read) = (scene.clone(), Arc::clone(sites), Arc::clone(&solution));
        let pieces = workers.map(count, move |piece| {
            let range = piece * SITES_PER_TASK..((piece + 1) * SITES_PER_TASK).min(shared.len());
            let irradiance = range.map(|site| mean(&scene, &read, &shared, site, front)).collect::<Vec<_>>();
            looked_up.fetch_add(1, Ordering::Relaxed);
            irradiance
        })?;
        let irradiance: Vec<[f32; 3]> = pieces.into_iter().flatten().collect();
        Ok((Baked { standard_error: vec![[f32::NAN; 3]; irradiance.len()], irradiance }, solution))
    })
}

fn mean(scene: &Scene, solution: &Radiosity, sites: &Sites, site: usize, front: bool) -> [f32; 3] {
    let mut sum = Rgb::ZERO;
    for i in 0..POINTS {
        let u = [(i as f32 + 0.5) / POINTS as f32, (i.reverse_bits() >> 8) as f32 / 16_777_216.0 + 0.5 / POINTS as f32];
        let (facet, [b1, b2]) = sites.point(site, u);
        let p = scene.facet_point(facet, b1, b2).point.p;
        sum += solution.irradiance(&facet.hit(b1, b2), p, front);
    }
    (sum / POINTS as f32).to_array()
}
