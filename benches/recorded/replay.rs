//! Recorded rays once more, with nothing around them.

use std::hint::black_box;

use etendue::embree;
use etendue::math::Ray;

use super::recorded::{Rays, time};

/// Seconds for closest-hit rays, and for shadow rays, each by itself.
pub fn replay(
    rays: &[Rays],
    intersect: impl Fn(&Ray) -> bool + Sync,
    occluded: impl Fn(&Ray) -> bool + Sync,
) -> [f64; 2] {
    let closest = time(rays.len(), |thread| {
        black_box(rays[thread].closest.iter().filter(|ray| intersect(ray)).count());
    });
    let shadow = time(rays.len(), |thread| {
        black_box(rays[thread].shadow.iter().filter(|ray| occluded(ray)).count());
    });
    [closest, shadow]
}

/// The same in full packets.
pub fn replay_in_packets(rays: &[Rays], kernel: &embree::Scene) -> [f64; 2] {
    let closest = time(rays.len(), |thread| {
        let (rays, mut met) = (&rays[thread].closest, 0);
        kernel.intersect_many(rays, |number| rays[number].tfar, |_, _| met += 1);
        black_box(met);
    });
    let shadow = time(rays.len(), |thread| {
        let mut blocked = 0;
        kernel.occluded_many(&rays[thread].shadow, |_| blocked += 1);
        black_box(blocked);
    });
    [closest, shadow]
}

/// Keeps the lesser of each.
pub fn keep_best(best: &mut [f64; 2], seconds: [f64; 2]) {
    *best = [best[0].min(seconds[0]), best[1].min(seconds[1])];
}
