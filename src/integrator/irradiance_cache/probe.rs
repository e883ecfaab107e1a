//! How far off the cache is: places seen by the camera, gathered anew.

use std::fmt;
use std::sync::Arc;

use super::super::SceneTracer;
use super::IrradianceCache;
use super::fill::Filling;
use super::hemisphere::Strata;
use super::site::{Site, seen};
use crate::control::Parallel;
use crate::error::Result;
use crate::sampling::{Rng, SobolSampler};
use crate::spectrum::luminance;

/// Places: one for so many records, within these limits, so that looking takes a small part of what filling did.
const RECORDS_A_PROBE: usize = 12;
const PROBES: [usize; 2] = [192, 384];

/// Rays of a place at most, in two halves that are independent of each other.
const RAYS: u32 = 512;

/// Apart from the records' random numbers.
const FAMILY: u64 = 0x0070_726f_6265;

/// Luminances of one place.
#[derive(Clone, Copy, Debug)]
struct Probe {
    cached: f64,
    halves: [f64; 2],
}

/// What the probes say.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Verdict {
    /// Places that the camera sees.
    seen: usize,
    /// Those of them where the cache answers.
    answered: usize,
    /// Mean of the cache over the mean of the probes, less 1, and its standard error.
    bias: f64,
    bias_error: f64,
    /// Root of the mean square of the relative error, the probes' own noise subtracted.
    rms: f64,
    pub rays: u64,
}

/// Gathers light at random places and compares.
pub(super) fn probe(cache: &Arc<IrradianceCache>, filling: &Filling, parallel: &mut impl Parallel) -> Result<Verdict> {
    let [least, most] = PROBES;
    let count = (cache.len() / RECORDS_A_PROBE).clamp(least, most);
    let (cache, filling) = (Arc::clone(cache), Arc::new(filling.clone()));
    let source = filling.source.unaided();
    let probes = parallel.map(count, move |number| {
        let mut tracer = SceneTracer::new(&filling.scene);
        let mut rng = Rng::new(filling.seed ^ FAMILY, number as u64);
        let [x, y] = rng.next_2d();
        let [width, height] = filling.resolution.map(|n| n as f32);
        let mut sites = Vec::new();
        seen(&filling.scene, &filling.camera, [x * width, y * height], &mut tracer, &mut sites);
        let site = choose(&sites, rng.next_f32());
        let probe = site.map(|site| {
            let cached = cache.irradiance(site.p, site.n)?;
            let strata = Strata::new((filling.cache.rays / 2).min(RAYS / 2));
            let half = |half: u64| {
                let mut sampler = SobolSampler::new(filling.seed ^ FAMILY ^ half << 32, u32::MAX);
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
    Ok(Verdict { seen: seen.len(), rays, ..Verdict::of(&answered) })
}

/// One of the places behind a pixel, by their shares of its light.
fn choose(sites: &[Site], u: f32) -> Option<&Site> {
    let mut left = u * sites.iter().map(|site| site.share).sum::<f32>();
    sites.iter().find(|site| {
        left -= site.share;
        left < 0.0
    })
}

impl Verdict {
    fn of(probes: &[Probe]) -> Self {
        let count = probes.len() as f64;
        let of = |probe: &Probe| 0.5 * (probe.halves[0] + probe.halves[1]);
        let mean = probes.iter().map(of).sum::<f64>() / count;
        let verdict = Self { answered: probes.len(), ..Self::default() };
        if probes.len() < 2 || mean <= 0.0 {
            return verdict;
        }
        let bias = probes.iter().map(|probe| probe.cached - of(probe)).sum::<f64>() / count;
        let scatter = probes.iter().map(|probe| (probe.cached - of(probe) - bias).powi(2)).sum::<f64>();
        // Against the light of the place itself, but where that is next to nothing.
        let against = |probe: &Probe| of(probe).max(0.05 * mean).powi(2);
        let square = |probe: &Probe| {
            let noise = 0.25 * (probe.halves[0] - probe.halves[1]).powi(2);
            ((probe.cached - of(probe)).powi(2) - noise) / against(probe)
        };
        Self {
            bias: bias / mean,
            bias_error: (scatter / (count * (count - 1.0))).sqrt() / mean,
            rms: (probes.iter().map(square).sum::<f64>() / count).max(0.0).sqrt(),
            ..verdict
        }
    }
}

impl fmt::Display for Verdict {
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
