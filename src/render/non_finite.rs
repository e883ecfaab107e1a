//! Samples that are NaN or infinite: how many, which, and where on their path they became so.
//!
//! They count as black, so the image stays an image; but a scene or a model is at fault, and whoever is to mend it has to
//! know where. A pass only notes pixel and sample. As any sample can be taken again alone, the few that are reported are
//! traced once more afterwards, so that knowing costs the others nothing.

use std::collections::BTreeSet;

use crate::integrator::Tracer;
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
    /// How many surfaces the path had met, the first one counted, when it became so.
    pub depth: u32,
    /// The last one of them: surface, material and primitive.
    pub hit: Option<HitDescription>,
}

impl std::fmt::Display for NonFiniteSample {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let [x, y] = self.pixel;
        write!(f, "pixel ({x}, {y}), sample {}", self.sample)?;
        if let Some(HitDescription { surface, material, primitive, .. }) = self.hit {
            write!(f, ", at hit {}: surface {surface}, material {material}, primitive {primitive}", self.depth)?;
        }
        Ok(())
    }
}

/// Samples of a pass that were not finite.
#[derive(Debug, Default)]
pub(super) struct Suspects {
    /// All of them.
    pub count: u64,
    /// The first ones by row, column and index, whichever thread met them.
    first: BTreeSet<(u32, u32, u32)>,
}

impl Suspects {
    pub(super) fn add(&mut self, [x, y]: [u32; 2], sample: u32) {
        self.count += 1;
        self.first.insert((y, x, sample));
        if self.first.len() > REPORTED {
            self.first.pop_last();
        }
    }

    /// The first ones, with what `replay` finds out, added to those of earlier passes.
    pub(super) fn report(&self, found: &mut Vec<NonFiniteSample>, replay: impl Fn([u32; 2], u32) -> Replay) {
        for &(y, x, sample) in self.first.iter().take(REPORTED - found.len().min(REPORTED)) {
            let Replay { radiance, depth, hit } = replay([x, y], sample);
            found.push(NonFiniteSample { pixel: [x, y], sample, radiance, depth, hit });
        }
    }
}

/// What taking a sample again showed.
pub(super) struct Replay {
    radiance: Rgb,
    depth: u32,
    hit: Option<HitDescription>,
}

impl Replay {
    /// `radiance` takes the sample with the given tracer.
    ///
    /// The path is cut after ever fewer surfaces: what they add is summed up, so from some length on the sum is not finite,
    /// and the surface that makes it this long is the one to name.
    pub(super) fn new(scene: &Scene, radiance: impl Fn(&mut Cut) -> Rgb) -> Self {
        let take = |most: u32| {
            let mut tracer = Cut { scene, most, met: 0, last: None };
            (radiance(&mut tracer), tracer)
        };
        let (value, whole) = take(u32::MAX);
        // Finite up to `low`, not from `high` on.
        let (mut low, mut high) = (0, whole.met);
        while high > low + 1 {
            let middle = low + (high - low) / 2;
            if take(middle).0.is_finite() {
                low = middle;
            } else {
                high = middle;
            }
        }
        let hit = take(high).1.last.map(|(ray, hit)| scene.describe_hit(&ray, &hit));
        Self { radiance: value, depth: high, hit }
    }
}

/// Traces until so many surfaces were met, and remembers the last.
pub(super) struct Cut<'s> {
    scene: &'s Scene,
    most: u32,
    met: u32,
    last: Option<(Ray, Hit)>,
}

impl Tracer for Cut<'_> {
    fn intersect(&mut self, ray: &Ray) -> Option<Hit> {
        if self.met == self.most {
            return None;
        }
        let hit = self.scene.intersect(ray)?;
        self.met += 1;
        self.last = Some((*ray, hit));
        Some(hit)
    }

    fn unoccluded(&mut self, ray: &Ray) -> bool {
        self.scene.unoccluded(ray)
    }
}
