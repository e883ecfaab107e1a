//! Samples that are NaN or infinite: their number, their pixels, and the surfaces where they became so.
//!
//! Such samples count as black, so that the image stays finite. Their cause is a fault in the scene or in a model, and the
//! report names the place of the fault. A pass records only the pixel and the index of each such sample. Since any sample can
//! be taken again by itself, the few samples that are reported are replayed after the pass, and finite samples cost nothing
//! more.

use std::collections::BTreeSet;
use std::sync::{Mutex, PoisonError};

use crate::film::TILE;
use crate::math::Ray;
use crate::scene::{Hit, HitDescription, Scene};
use crate::spectrum::Rgb;

/// Greatest number of samples that are reported in detail. The other samples are only counted.
const REPORTED: usize = 8;

/// A sample that was NaN or infinite, and the place where its path became so.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NonFiniteSample {
    /// Column and row of the sample's pixel in the picture.
    pub pixel: [u32; 2],
    /// Index of the sample in the pixel.
    pub sample: u32,
    /// Radiance of the sample, which is not finite.
    pub radiance: Rgb,
    /// Number of rays, including shadow rays, that the sample had traced when its radiance became NaN or infinite.
    pub rays: u64,
    /// The last hit of the path by then: surface, material and primitive.
    pub hit: Option<HitDescription>,
}

impl std::fmt::Display for NonFiniteSample {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let [x, y] = self.pixel;
        write!(f, "pixel ({x}, {y}), sample {}", self.sample)?;
        if let Some(HitDescription { surface, material, primitive, .. }) = self.hit {
            let material = material.map_or("no material".to_owned(), |material| format!("material {material}"));
            write!(f, ", ray {}: surface {surface}, {material}, primitive {primitive}", self.rays)?;
        }
        Ok(())
    }
}

/// The samples of a pass that were NaN or infinite.
#[derive(Debug, Default)]
pub(super) struct NonFiniteSamples {
    /// Number of such samples.
    pub count: u64,
    /// The first few samples in the order of index, row and column. This order makes the list independent of threads and of
    /// the division into passes.
    first: BTreeSet<(u32, u32, u32)>,
}

impl NonFiniteSamples {
    /// Records a sample.
    pub(super) fn add(&mut self, [x, y]: [u32; 2], sample: u32) {
        self.count += 1;
        self.first.insert((sample, y, x));
        if self.first.len() > REPORTED {
            self.first.pop_last();
        }
    }

    /// The first few samples: index, row and column.
    pub(super) fn first(&self) -> Vec<(u32, u32, u32)> {
        self.first.iter().copied().collect()
    }

    /// Replays the first samples and describes them, as many as may be reported beside the `known` samples of earlier passes.
    /// `replay` takes a sample of a pixel once more, up to the ray with the given number.
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

/// Finds the place where a sample became NaN or infinite.
///
/// The radiance of a path is a sum over its rays, so from some number of rays on the sum is not finite. That number is found
/// by bisection, with replays that end after fewer rays. The last surface that the path had hit by then is at fault.
fn explain(scene: &Scene, pixel: [u32; 2], sample: u32, replay: impl Fn(u64) -> Replayed) -> NonFiniteSample {
    let Replayed { radiance, rays, .. } = replay(u64::MAX);
    // The sum is finite up to ray `low`, and not finite from ray `high` on.
    let (mut low, mut high) = (0, rays);
    while high > low + 1 {
        let middle = low + (high - low) / 2;
        if replay(middle).radiance.is_finite() {
            low = middle;
        } else {
            high = middle;
        }
    }
    // Rays before `high` may be shadow rays from the surface at fault, which are skipped.
    let last = (1..=high).rev().find_map(|limit| replay(limit).last);
    let hit = last.map(|(ray, hit)| scene.describe_hit(&ray, &hit));
    NonFiniteSample { pixel, sample, radiance, rays: high, hit }
}

/// A replay: one sample that is taken once more and ends after some of its rays. A sample that is a part of a group is taken with
/// its group, whose rays are counted together.
pub(super) struct Replay {
    /// Column and row on the film.
    pub pixel: [u32; 2],
    pub sample: u32,
    /// Number of the last ray that is traced.
    pub limit: u64,
    replayed: Mutex<Replayed>,
}

/// The result of a replay.
#[derive(Default)]
pub(super) struct Replayed {
    radiance: Rgb,
    /// Number of rays that the sample asked for.
    rays: u64,
    /// The last ray that was traced, and its hit; `None` if that ray was a shadow ray.
    last: Option<(Ray, Hit)>,
}

impl Replay {
    /// Makes a replay of a sample of a pixel. Rays after ray number `limit` find nothing.
    pub(super) fn new(pixel: [u32; 2], sample: u32, limit: u64) -> Self {
        Self { pixel, sample, limit, replayed: Mutex::default() }
    }

    /// Whether it is the pixel with this index in its tile.
    #[inline]
    pub(super) fn is_of(&self, index: usize) -> bool {
        let [x, y] = self.pixel.map(|place| place % TILE);
        index == (y * TILE + x) as usize
    }

    /// The hit of ray number `number`, or `None` for rays after the limit. It is called only for rays from the limit on.
    pub(super) fn intersect(&self, scene: &Scene, ray: Ray, number: u64) -> Option<Hit> {
        if number > self.limit {
            return None;
        }
        let hit = scene.intersect(&ray)?;
        self.with(|replayed| replayed.last = Some((ray, hit)));
        Some(hit)
    }

    /// Records the radiance of the sample and the number of rays that it asked for.
    pub(super) fn record(&self, radiance: Rgb, rays: u64) {
        self.with(|replayed| (replayed.radiance, replayed.rays) = (radiance, rays));
    }

    /// Returns the result.
    pub(super) fn into_replayed(self) -> Replayed {
        self.replayed.into_inner().unwrap_or_else(PoisonError::into_inner)
    }

    fn with(&self, change: impl FnOnce(&mut Replayed)) {
        change(&mut self.replayed.lock().unwrap_or_else(PoisonError::into_inner));
    }
}
