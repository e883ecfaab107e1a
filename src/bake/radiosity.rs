//! Irradiance of sites from a radiosity solution: without noise, for diffuse scenes.

use std::ops::ControlFlow;
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};

use super::Baked;
use crate::control::Parallel;
use crate::desc::{RADII, RadiosityDesc};
use crate::error::{Error, ErrorKind, Result};
use crate::integrator::Sites;
use crate::integrator::radiosity::Radiosity;
use crate::render::{RenderSettings, with_workers};
use crate::scene::Scene;
use crate::spectrum::Rgb;

/// Points of a site whose mean is its irradiance: those of a (0, 2)-net.
const POINTS: u32 = 16;

/// What share of a bake the solution counts as; the rest is reading it at the sites.
const SOLUTION_SHARE: f64 = 0.9;

/// Sites that are one piece of work.
const PIECE: usize = 1 << 12;

/// The irradiance [W m^-2] of each of these sites, on the outer side of the surface (`front`) or the other, from a radiosity
/// solution of the scene, which comes with it; the same for any number of threads. Its standard error is not known: NaN.
///
/// `element_size`: what takes the place of the description's, where that has none: the length of a texel, say. Of the settings only
/// `desc.radiosity`, workers, time limit and cancel are looked at. `look_up` is called about ten times a second and after
/// each step on the calling thread, with the share of the work that is done, which only grows; `Break` stops the work. Surfaces that reflect nothing diffusely and do not emit have no irradiance here.
///
/// # Errors
/// As for [`Radiosity::solve`]; [`ErrorKind::InvalidScene`] where there is no site; `Cancelled` if it was stopped, by the time limit
/// too: half a solution is none.
pub fn by_radiosity(
    scene: &Scene,
    sites: &Arc<Sites>,
    settings: &RenderSettings,
    element_size: Option<f64>,
    front: bool,
    look_up: &mut dyn FnMut(f64) -> ControlFlow<()>,
) -> Result<(Baked, Arc<Radiosity>)> {
    if sites.is_empty() {
        return Err(Error::new(ErrorKind::InvalidScene, "there is no surface whose irradiance could be asked for"));
    }
    let own = &settings.desc.radiosity;
    // Nobody asked for it: it must not be refused as if somebody had.
    let element_size = element_size.map(|size| size.clamp(RADII[0], RADII[1]));
    let desc = RadiosityDesc { element_size: own.element_size.or(element_size), ..own.clone() };
    let count = sites.len().div_ceil(PIECE);
    let looked_up = Arc::new(AtomicUsize::new(0));
    let done = Arc::clone(&looked_up);
    let look_up = &mut |solved: f64| {
        let sites = done.load(Ordering::Relaxed) as f64 / count as f64;
        look_up(SOLUTION_SHARE * solved + (1.0 - SOLUTION_SHARE) * sites)
    };
    with_workers(settings, look_up, |workers| {
        let solution = Arc::new(Radiosity::solve(scene, &desc, workers)?);
        workers.progress(1.0);
        let (scene, shared, read) = (scene.clone(), Arc::clone(sites), Arc::clone(&solution));
        let pieces = workers.map(count, move |piece| {
            let range = piece * PIECE..((piece + 1) * PIECE).min(shared.len());
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
