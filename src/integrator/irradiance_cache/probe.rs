//! The accuracy of a cache: light is gathered anew at places that the camera sees, and compared.

use std::fmt;
use std::sync::Arc;

use super::super::SceneTracer;
use super::cache::IrradianceCache;
use super::fill::CacheFiller;
use super::hemisphere::Strata;
use super::site::{Site, first_diffuse_hits};
use crate::control::Parallel;
use crate::error::Result;
use crate::sampling::{Rng, SobolSampler};
use crate::spectrum::luminance;

/// One place is probed for this many records, within `PROBE_LIMITS`, so that probing costs a small part of filling.
const RECORDS_PER_PROBE: usize = 12;
const PROBE_LIMITS: [usize; 2] = [192, 384];

/// Most rays of a place, in two halves that are independent of each other.
const MAX_RAYS: u32 = 512;

/// Salt of the seed, which separates these random numbers from those of the records.
const SEED_SALT: u64 = 0x0070_726f_6265;

/// Luminances of the irradiance at one place.
#[derive(Clone, Copy, Debug)]
struct Probe {
    cached: f64,
    halves: [f64; 2],
}

/// Accuracy of the cache at the probed places.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct CacheAccuracy {
    /// Number of places that the camera sees.
    seen: usize,
    /// Number of those places where a record is valid.
    answered: usize,
    /// Mean of the cache over the mean of the probes, minus 1, and its standard error.
    bias: f64,
    bias_error: f64,
    /// Root mean square of the relative error, with the noise of the probes themselves subtracted.
    rms: f64,
    pub rays: u64,
}

/// Gathers light at random places and compares it with the cache.
pub(super) fn measure_accuracy(
    cache: &Arc<IrradianceCache>,
    filler: &CacheFiller,
    parallel: &mut impl Parallel,
) -> Result<CacheAccuracy> {
    let [least, most] = PROBE_LIMITS;
    let count = (cache.len() / RECORDS_PER_PROBE).clamp(least, most);
    let (cache, filler) = (Arc::clone(cache), Arc::new(filler.clone()));
    let source = filler.source.unaided();
    let probes = parallel.map(count, move |number| {
        let mut tracer = SceneTracer::new(&filler.scene);
        let mut rng = Rng::new(filler.seed ^ SEED_SALT, number as u64);
        let [x, y] = rng.next_2d();
        let [width, height] = filler.resolution.map(|n| n as f32);
        let lens = if filler.camera.has_lens() { rng.next_2d() } else { [0.5; 2] };
        let mut sites = Vec::new();
        first_diffuse_hits(&filler.scene, &filler.camera, [x * width, y * height], lens, &mut tracer, &mut sites);
        let site = choose_site(&sites, rng.next_f32());
        let probe = site.map(|site| {
            let cached = cache.irradiance(site.p, site.n)?;
            let strata = Strata::new((filler.cache.rays / 2).min(MAX_RAYS / 2));
            let half = |half: u64| {
                let mut sampler = SobolSampler::new(filler.seed ^ SEED_SALT ^ half << 32, u32::MAX);
                let rays = site.gather(&source, strata, number as u32, &mut sampler, &mut tracer);
                f64::from(luminance(strata.estimate(&rays).irradiance))
            };
            Some(Probe { cached: luminance(cached).into(), halves: [1, 2].map(half) })
        });
        (probe, tracer.rays)
    })?;
    let rays = probes.iter().map(|(_, rays)| rays).sum();
    let seen: Vec<Option<Probe>> = probes.into_iter().filter_map(|(probe, _)| probe).collect();
    let answered: Vec<Probe> = seen.iter().flatten().copied().collect();
    Ok(CacheAccuracy { seen: seen.len(), rays, ..CacheAccuracy::of(&answered) })
}

/// One of the sites behind a pixel, chosen in proportion to their throughputs.
fn choose_site(sites: &[Site], u: f32) -> Option<&Site> {
    let mut left = u * sites.iter().map(|site| site.throughput).sum::<f32>();
    sites.iter().find(|site| {
        left -= site.throughput;
        left < 0.0
    })
}

impl CacheAccuracy {
    fn of(probes: &[Probe]) -> Self {
        let count = probes.len() as f64;
        let of = |probe: &Probe| 0.5 * (probe.halves[0] + probe.halves[1]);
        let mean = probes.iter().map(of).sum::<f64>() / count;
        let accuracy = Self { answered: probes.len(), ..Self::default() };
        if probes.len() < 2 || mean <= 0.0 {
            return accuracy;
        }
        let bias = probes.iter().map(|probe| probe.cached - of(probe)).sum::<f64>() / count;
        let scatter = probes.iter().map(|probe| (probe.cached - of(probe) - bias).powi(2)).sum::<f64>();
        // The error is relative to the light of the place itself, except where that is close to 0.
        let against = |probe: &Probe| of(probe).max(0.05 * mean).powi(2);
        let square = |probe: &Probe| {
            let noise = 0.25 * (probe.halves[0] - probe.halves[1]).powi(2);
            ((probe.cached - of(probe)).powi(2) - noise) / against(probe)
        };
        Self {
            bias: bias / mean,
            bias_error: (scatter / (count * (count - 1.0))).sqrt() / mean,
            rms: (probes.iter().map(square).sum::<f64>() / count).max(0.0).sqrt(),
            ..accuracy
        }
    }

    /// Root mean square of the relative error; `None` where no places tell.
    pub fn rms_error(&self) -> Option<f64> {
        (self.answered >= 2 && self.bias_error > 0.0).then_some(self.rms)
    }
}

impl fmt::Display for CacheAccuracy {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { seen, answered, bias, bias_error, rms, .. } = self;
        if *answered < 2 {
            return write!(f, "answers at {answered} of {seen} probes");
        }
        write!(
            f,
            "bias {:+.2} +- {:.2} %, rms error {:.1} %, at {answered} of {seen} probes",
            100.0 * bias,
            100.0 * bias_error,
            100.0 * rms
        )
    }
}
