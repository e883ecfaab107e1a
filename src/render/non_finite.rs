//! Samples that are NaN or infinite: how many, which, and where on their path they became so.
//!
//! They count as black, so the image stays an image; but a scene or a model is at fault, and whoever is to mend it has to
//! know where. A pass only notes pixel and sample. As any sample can be taken again alone, the few that are reported are
//! traced once more afterwards, so that knowing costs the others nothing.

use std::collections::BTreeSet;

use super::Render;
use super::pass::{Pass, Replayed};
use crate::scene::HitDescription;
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

    /// The first ones, with what replaying them shows; so many as were not told of earlier passes.
    pub(super) fn explain(&self, render: &Render) -> Vec<NonFiniteSample> {
        let left = REPORTED.saturating_sub(render.non_finite_samples.len());
        self.first.iter().take(left).map(|&(sample, y, x)| explain(render, [x, y], sample)).collect()
    }
}

/// Where a sample became what it is.
///
/// It is cut after ever fewer rays: what they add is summed up, so from some number on the sum is not finite, and the surface
/// that was met last by then is the one to name.
fn explain(render: &Render, pixel: [u32; 2], sample: u32) -> NonFiniteSample {
    let take = |limit| Pass::replay(render, pixel, sample, limit);
    let Replayed { radiance, rays, .. } = take(u64::MAX);
    // Finite up to `low`, not from `high` on.
    let (mut low, mut high) = (0, rays);
    while high > low + 1 {
        let middle = low + (high - low) / 2;
        if take(middle).radiance.is_finite() {
            low = middle;
        } else {
            high = middle;
        }
    }
    // Back over the shadow rays that were sent from there.
    let last = (1..=high).rev().find_map(|limit| take(limit).last);
    let hit = last.map(|(ray, hit)| render.scene.describe_hit(&ray, &hit));
    NonFiniteSample { pixel, sample, radiance, rays: high, hit }
}
