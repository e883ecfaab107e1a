//! Samples that are NaN or infinite: how many, which, and where on their path they became so.
//!
//! They count as black, so the image stays an image; but a scene or a model is at fault, and whoever is to mend it has to
//! know where. A pass notes only their pixel and index. Any sample can be taken again alone, so the few that are reported are
//! replayed after the pass, and all others pay nothing for the report.

use std::collections::BTreeSet;
use std::sync::{Mutex, PoisonError};

use crate::math::Ray;
use crate::scene::{Hit, HitDescription, Scene};
use crate::spectrum::Rgb;

/// How many are told apart; of the rest only the number is known.
const REPORTED: usize = 8;

/// A sample that was NaN or infinite, and where its path became so.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NonFiniteSample {
    /// Column and row of its pixel.
    pub pixel: [u32; 2],
    /// Its index in the pixel.
    pub sample: u32,
    /// Its value.
    pub radiance: Rgb,
    /// How many rays it had asked for, shadow rays too, when it became so.
    pub rays: u64,
    /// The last surface that it had met: surface, material and primitive.
    pub hit: Option<HitDescription>,
}

impl std::fmt::Display for NonFiniteSample {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let [x, y] = self.pixel;
        write!(f, "pixel ({x}, {y}), sample {}", self.sample)?;
        if let Some(HitDescription { surface, material, primitive, .. }) = self.hit {
            write!(f, ", ray {}: surface {surface}, material {material}, primitive {primitive}", self.rays)?;
        }
        Ok(())
    }
}

/// Samples of a pass that were not finite.
#[derive(Debug, Default)]
pub(super) struct Suspects {
    /// All of them.
    pub count: u64,
    /// The first ones by index, row and column: the same whichever thread met them and however a render is divided into
    /// passes.
    first: BTreeSet<(u32, u32, u32)>,
}

impl Suspects {
    pub(super) fn add(&mut self, [x, y]: [u32; 2], sample: u32) {
        self.count += 1;
        self.first.insert((sample, y, x));
        if self.first.len() > REPORTED {
            self.first.pop_last();
        }
    }

    /// The first ones, with what replaying them shows: as many as may be reported beside the `known` ones of earlier passes.
    /// `replay` takes a sample of a pixel once more, up to the ray of this number.
    pub(super) fn explain(
        &self,
        scene: &Scene,
        known: usize,
        replay: impl Fn([u32; 2], u32, u64) -> Replayed,
    ) -> Vec<NonFiniteSample> {
        let left = REPORTED.saturating_sub(known);
        let first = self.first.iter().take(left);
        first.map(|&(sample, y, x)| explain(scene, [x, y], sample, |limit| replay([x, y], sample, limit))).collect()
    }
}

/// Where a sample became what it is.
///
/// It is replayed with ever fewer rays. A path's radiance is a sum over its rays, so from some number of rays on the sum is not
/// finite; the surface that was met last by then is at fault.
fn explain(scene: &Scene, pixel: [u32; 2], sample: u32, replay: impl Fn(u64) -> Replayed) -> NonFiniteSample {
    let Replayed { radiance, rays, .. } = replay(u64::MAX);
    // Finite up to `low`, not from `high` on.
    let (mut low, mut high) = (0, rays);
    while high > low + 1 {
        let middle = low + (high - low) / 2;
        if replay(middle).radiance.is_finite() {
            low = middle;
        } else {
            high = middle;
        }
    }
    // Back over the shadow rays that were sent from there.
    let last = (1..=high).rev().find_map(|limit| replay(limit).last);
    let hit = last.map(|(ray, hit)| scene.describe_hit(&ray, &hit));
    NonFiniteSample { pixel, sample, radiance, rays: high, hit }
}

/// A sample that is taken once more, cut after some of its rays.
pub(super) struct Replay {
    pub pixel: [u32; 2],
    pub sample: u32,
    /// The number of the last ray that is answered.
    pub limit: u64,
    replayed: Mutex<Replayed>,
}

/// What taking a sample once more showed.
#[derive(Default)]
pub(super) struct Replayed {
    radiance: Rgb,
    /// Rays that it asked for.
    rays: u64,
    /// The last ray that was answered and what it met; `None` if that was a shadow ray.
    last: Option<(Ray, Hit)>,
}

impl Replay {
    /// Of this sample of a pixel, with rays beyond number `limit` finding nothing.
    pub(super) fn new(pixel: [u32; 2], sample: u32, limit: u64) -> Self {
        Self { pixel, sample, limit, replayed: Mutex::default() }
    }

    /// What the ray of this number meets: nothing if it lies beyond the limit. Called from the limit on.
    pub(super) fn intersect(&self, scene: &Scene, ray: Ray, number: u64) -> Option<Hit> {
        if number > self.limit {
            return None;
        }
        let hit = scene.intersect(&ray)?;
        self.with(|replayed| replayed.last = Some((ray, hit)));
        Some(hit)
    }

    /// Notes what the sample came to, and how many rays it asked for.
    pub(super) fn note(&self, radiance: Rgb, rays: u64) {
        self.with(|replayed| (replayed.radiance, replayed.rays) = (radiance, rays));
    }

    /// What was noted.
    pub(super) fn into_replayed(self) -> Replayed {
        self.replayed.into_inner().unwrap_or_else(PoisonError::into_inner)
    }

    fn with(&self, change: impl FnOnce(&mut Replayed)) {
        change(&mut self.replayed.lock().unwrap_or_else(PoisonError::into_inner));
    }
}
