//! Rays that leave a surface do not meet it again, at any scale, in any shape and under any transform; nor do they pass
//! through what is near.

mod analytic;
mod instances;
mod near;
mod scale;
mod shading;
mod spawn;
mod triangles;

pub use instances::ball_mesh;

use crate::record::Entry;

pub fn cases() -> Vec<Entry> {
    [scale::cases(), triangles::cases(), instances::cases(), analytic::cases(), near::cases(), shading::cases()]
        .into_iter()
        .flatten()
        .collect()
}
