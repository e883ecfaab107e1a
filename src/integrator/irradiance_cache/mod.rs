//! Irradiance caching: indirect light on diffuse surfaces, interpolated between few careful samples of it.
//!
//! Indirect light changes slowly over a diffuse surface. So it is gathered over the whole hemisphere at some points, with
//! as many rays as it takes, and between them interpolated along its gradients: the farther from other surfaces, the fewer
//! records are needed. Direct light, whose shadows have edges, comes from shadow rays as ever, and what mirrors and glass focus
//! from the caustic map.
//!
//! # What it does and how
//!
//! - A record's hemisphere is stratified; irradiance, both gradients and the mean distance come from it
//!   ([`hemisphere`]).
//! - Its radius is the error that is allowed times the harmonic mean of the distances, or less where the gradient says so;
//!   not less than a few pixels, not more than a share of the scene. Neighbours clamp each other.
//! - A record says nothing behind a wall that stands on its surface, on a step before it, or on a surface that is turned from
//!   its own. Its weight falls to 0 where its error reaches what is allowed, so that no edge of a record is seen.
//! - Gather rays are paths that end where a first, coarse cache answers, which itself is gathered by whole paths: what it is
//!   wrong by is averaged over a hemisphere. Half the time to equal error in the report's room.
//! - Where no record speaks, the path goes on without bias: in what only mirrors of mirrors show, and in hair-thin places.
//! - After filling, places seen by the camera are gathered anew without the cache. The note that results tells bias and
//!   error of interpolation.
//!
//! # When it is a poor choice
//!
//! Where surfaces are small against a pixel (foliage), where the scene is mostly glossy or rough in other ways than
//! Lambert's, and where an image has no bias to spare: the error of the records does not fall with the number of samples.
//!
//! ```json
//! {"integrator": "irradiance_cache", "cacheError": 0.25, "cacheRays": 512, "cacheMinSpacing": 3, "cacheMaxSpacing": 0.1,
//!  "cacheSource": "paths"}
//! ```
//!
//! Sources: Ward, Rubinstein, Clear 1988, "A Ray Tracing Solution for Diffuse Interreflection"; Ward and Heckbert 1992,
//! "Irradiance Gradients"; Tabellion and Lamorlette 2004, "An Approximate Global Illumination System for Computer Generated
//! Films"; Křivánek et al. 2006, "Making Radiance and Irradiance Caching Practical: Adaptive Caching and Neighbor Clamping".

mod fill;
pub mod hemisphere;
mod probe;
mod record;
mod site;
mod tree;

use std::sync::Arc;

use self::fill::Filling;
use self::record::Record;
use self::tree::Tree;
use super::photon::Gather;
use crate::camera::Camera;
use crate::control::Parallel;
use crate::desc::{CacheSource, RenderDesc};
use crate::error::Result;
use crate::math::{DVec3, Vec3};
use crate::scene::Scene;
use crate::spectrum::Rgb;

/// Records of irradiance, and where they are.
#[derive(Clone, Debug, Default)]
pub struct IrradianceCache {
    tree: Tree,
    records: Vec<Record>,
    ask: Ask,
}

/// What every query needs.
#[derive(Clone, Copy, Debug, Default)]
struct Ask {
    error: f32,
    inverse_error: f32,
}

impl Ask {
    fn new(error: f32) -> Self {
        Self { error, inverse_error: 1.0 / error }
    }
}

/// What filling the cache came to.
#[derive(Clone, Debug, Default)]
pub struct Report {
    /// Rays traced.
    pub rays: u64,
    /// What a user should know.
    pub notes: Vec<String>,
}

/// Most looks of the finest grid.
const MOST_LOOKS: f64 = 4_194_304.0;

/// Pixels between the looks of the finest grid of the coarse cache.
const COARSE_LOOKS: f64 = 16.0;

impl IrradianceCache {
    /// Fills a cache for what the camera sees. `source`: what brings back the light of gather rays.
    ///
    /// The same for any number of threads.
    ///
    /// # Errors
    /// [`crate::ErrorKind::Cancelled`].
    pub fn fill(
        scene: &Scene,
        camera: &Camera,
        desc: &Arc<RenderDesc>,
        source: &Gather,
        parallel: &mut impl Parallel,
    ) -> Result<(Self, Report)> {
        parallel.check()?;
        let bounds = &scene.info().bounds;
        // Black in, black out: paths know it sooner.
        if bounds.is_empty() || scene.emitters().is_dark() {
            return Ok(Default::default());
        }
        // A cube around the scene, with room for rounding.
        let size = bounds.max - bounds.min;
        let side = 1.001 * size.max_element().max(f64::MIN_POSITIVE);
        let min = scene.to_scene(bounds.centre() - DVec3::splat(0.5 * side));
        let side = side as f32;
        if !(side > 0.0 && side.is_finite() && min.is_finite()) {
            return Ok(Default::default());
        }
        // Half the smallest distance between records finds all places that need one.
        let pixels: f64 = desc.resolution.iter().map(|&n| f64::from(n)).product();
        let finest = (0.5 * desc.cache.min_spacing).clamp(1.0, 16.0).max((pixels / MOST_LOOKS).sqrt());
        let filling = Filling::new(scene, camera, desc, source, side);
        let mut rays = 0;
        let mut ending = filling.clone();
        if desc.cache.source == CacheSource::Paths {
            let (coarse, spent) = filling.coarse().fill(min, finest.max(COARSE_LOOKS), parallel)?;
            rays += spent.rays;
            ending.source = source.ending_at(Arc::new(coarse));
        }
        let (cache, spent) = ending.fill(min, finest, parallel)?;
        rays += spent.rays;
        let mut report = Report { rays, notes: Vec::new() };
        if spent.is_cut {
            report.notes.push(format!(
                "the irradiance cache was ended at {} records: paths go on where it says nothing",
                cache.len()
            ));
        }
        let cache = Arc::new(cache);
        let found = probe::probe(&cache, &filling, parallel)?;
        report.rays += found.rays;
        report.notes.push(format!(
            "irradiance cache: {} records, {:.3e} rays, {:.1} MiB; {found}",
            cache.len(),
            rays as f64,
            cache.bytes() as f64 / f64::from(1 << 20),
        ));
        Ok((Arc::unwrap_or_clone(cache), report))
    }

    /// Indirect irradiance [W m^-2] at `p` on the side of the unit normal `n`; `None` where no record speaks for it.
    #[inline]
    pub fn irradiance(&self, p: Vec3, n: Vec3) -> Option<Rgb> {
        let (mut sum, mut total) = (Rgb::ZERO, 0.0);
        for ball in self.tree.around(p) {
            let weight = ball.weight(p, n, self.ask.inverse_error);
            if weight > 0.0
                && let Some(irradiance) = self.records[ball.record as usize].at(ball, p, n)
            {
                sum += weight * irradiance;
                total += weight;
            }
        }
        (total > 0.0).then(|| sum / total)
    }

    /// How many records there are.
    pub fn len(&self) -> usize {
        self.records.len()
    }

    /// Whether there is none.
    pub fn is_empty(&self) -> bool {
        self.records.is_empty()
    }

    /// Memory it takes, bytes.
    pub fn bytes(&self) -> usize {
        self.tree.bytes() + size_of_val(&*self.records)
    }
}
