//! Irradiance caching: indirect light on diffuse surfaces, interpolated between a few accurate samples.
//!
//! Indirect light changes slowly over a diffuse surface. It is therefore gathered over the whole hemisphere at a few
//! points, with many rays each, and interpolated between them along its gradients. The farther a point is from other
//! surfaces, the fewer records its surroundings need. Direct light, whose shadows have edges, comes from shadow rays,
//! and light that mirrors and glass focus comes from the caustic map.
//!
//! # Method
//!
//! - A record's hemisphere is stratified. Irradiance, both gradients and the mean distance come from the strata
//!   ([`hemisphere`]).
//! - A record's radius is the allowed error times the harmonic mean of the distances, or less where the gradient
//!   demands it. The radius is at least a few pixels and at most a fraction of the scene. Neighbours clamp each other's
//!   radius.
//! - A record is invalid behind a wall that stands on its surface, on a step before that surface, and on a surface
//!   whose normal is far from its own. Its weight falls to 0 where its error reaches the allowed error, so that no edge
//!   of a record is visible.
//! - Gather rays are paths that end where a first, coarse cache gives their irradiance. That coarse cache is gathered
//!   by whole paths, and its error is averaged over a hemisphere. This halves the time to equal error in the report's
//!   room.
//! - Where no record is valid, the path continues without bias. This happens in surfaces that only several mirrors in a
//!   row show, and in very thin places.
//! - After filling, light is gathered anew, without the cache, at places that the camera sees. The resulting note
//!   reports bias and error of the interpolation.
//!
//! # When it is a poor choice
//!
//! Where surfaces are small against a pixel (foliage), where the scene is mostly glossy or rough in other ways than
//! Lambert's, and where an image must have no bias: the error of the records does not fall with the number of samples.
//!
//! ```json
//! {"integrator": "irradiance_cache", "cacheError": 0.25, "cacheRays": 512, "cacheMinSpacing": 3, "cacheMaxSpacing":
//! 0.1,
//!  "cacheSource": "paths"}
//! ```
//!
//! Sources: Ward, Rubinstein, Clear 1988, "A Ray Tracing Solution for Diffuse Interreflection"; Ward and Heckbert 1992,
//! "Irradiance Gradients"; Tabellion and Lamorlette 2004, "An Approximate Global Illumination System for Computer
//! Generated Films"; Křivánek et al. 2006, "Making Radiance and Irradiance Caching Practical: Adaptive Caching and
//! Neighbor Clamping".

mod cache;
mod fill;
pub mod hemisphere;
mod octree;
mod probe;
mod record;
mod site;

use std::sync::Arc;

pub use self::cache::IrradianceCache;
use self::fill::CacheFiller;
use super::photon::Gather;
use crate::camera::Camera;
use crate::control::Parallel;
use crate::desc::{CacheSource, RenderDesc};
use crate::error::Result;
use crate::math::DVec3;
use crate::scene::Scene;

/// Cost of filling the cache, and notes about its accuracy.
#[derive(Clone, Debug, Default)]
pub struct FillReport {
    /// Rays traced.
    pub rays: u64,
    /// Root mean square of the relative error of indirect light at places that the camera sees; `None` where it is not known.
    pub rms_error: Option<f64>,
    /// Notes for the user.
    pub notes: Vec<String>,
}

/// Most points of the finest grid.
const MAX_GRID_POINTS: f64 = 4_194_304.0;

/// Spacing of the finest grid of the coarse cache [pixels].
const COARSE_SPACING: f64 = 16.0;

/// Fills a cache for the surfaces that the camera sees. `source` finds the radiance of gather rays.
///
/// The cache is the same for any number of threads.
///
/// # Errors
/// [`crate::ErrorKind::Cancelled`].
pub fn fill_cache(
    scene: &Scene,
    camera: &Camera,
    desc: &Arc<RenderDesc>,
    source: &Gather,
    parallel: &mut impl Parallel,
) -> Result<(IrradianceCache, FillReport)> {
    let (cache, report) = fill_within(scene, camera, desc, source, u64::MAX, parallel)?;
    Ok((cache.unwrap_or_default(), report))
}

/// [`fill_cache`], unless that takes more than so many rays; there is no cache then.
///
/// # Errors
/// As [`fill_cache`].
pub(crate) fn fill_within(
    scene: &Scene,
    camera: &Camera,
    desc: &Arc<RenderDesc>,
    source: &Gather,
    most_rays: u64,
    parallel: &mut impl Parallel,
) -> Result<(Option<IrradianceCache>, FillReport)> {
    parallel.check()?;
    let bounds = &scene.info().bounds;
    // A scene without light is black, and paths find that out sooner.
    let empty = || Ok((Some(IrradianceCache::default()), FillReport::default()));
    if bounds.is_empty() || scene.emitters().is_dark() {
        return empty();
    }
    // A cube around the scene, enlarged for rounding.
    let size = bounds.max - bounds.min;
    let side = 1.001 * size.max_element().max(f64::MIN_POSITIVE);
    let min = scene.to_scene(bounds.centre() - DVec3::splat(0.5 * side));
    let side = side as f32;
    if !(side > 0.0 && side.is_finite() && min.is_finite()) {
        return empty();
    }
    // Grid points at half the smallest distance between records find all sites that need one.
    let pixels: f64 = desc.resolution.iter().map(|&n| f64::from(n)).product();
    let finest = (0.5 * desc.cache.min_spacing).clamp(1.0, 16.0).max((pixels / MAX_GRID_POINTS).sqrt());
    let filler = CacheFiller { most_rays, ..CacheFiller::new(scene, camera, desc, source, side) };
    let mut rays = 0;
    let mut final_filler = filler.clone();
    let given_up = |rays| Ok((None, FillReport { rays, ..FillReport::default() }));
    if desc.cache.source == CacheSource::Paths {
        let (coarse, stats) = filler.coarse().fill(min, finest.max(COARSE_SPACING), parallel)?;
        rays += stats.rays;
        if stats.hit_ray_limit {
            return given_up(rays);
        }
        final_filler.source = source.ending_at(Arc::new(coarse));
        final_filler.most_rays = most_rays.saturating_sub(rays);
    }
    let (cache, stats) = final_filler.fill(min, finest, parallel)?;
    rays += stats.rays;
    if stats.hit_ray_limit {
        return given_up(rays);
    }
    let mut report = FillReport { rays, ..FillReport::default() };
    if stats.hit_record_limit {
        report.notes.push(format!(
            "the irradiance cache was ended at {} records: paths go on where it says nothing",
            cache.len()
        ));
    }
    let cache = Arc::new(cache);
    let accuracy = probe::measure_accuracy(&cache, &filler, parallel)?;
    report.rays += accuracy.rays;
    report.rms_error = accuracy.rms_error();
    report.notes.push(format!(
        "irradiance cache: {} records, {:.3e} rays, {:.1} MiB; {accuracy}",
        cache.len(),
        rays as f64,
        cache.bytes() as f64 / f64::from(1 << 20),
    ));
    Ok((Some(Arc::unwrap_or_clone(cache)), report))
}
