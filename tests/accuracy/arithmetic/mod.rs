//! Numbers at the ends of their ranges: long sums, very bright and very dark light, very large and very small scenes; where
//! a camera's rays go; what a display is sent; and that nothing depends on who computes it. `scripts/arithmetic.sh` does
//! the same for builds and instruction sets.

mod camera;
mod crop;
mod display;
mod film;
mod lens;
mod panoramas;
mod parallel;
mod range;
pub mod repeat;
mod sums;

use std::ops::ControlFlow;

use etendue::desc::{RenderDesc, SceneDesc};
use etendue::film::Image;
use etendue::render::{Render, RenderSettings};
use etendue::scene::{BuildOptions, Scene};

use crate::record::Entry;

pub fn cases() -> Vec<Entry> {
    [
        sums::cases(),
        camera::cases(),
        film::cases(),
        crop::cases(),
        lens::cases(),
        panoramas::cases(),
        parallel::cases(),
        display::cases(),
        repeat::cases(),
        range::cases(),
    ]
    .into_iter()
    .flatten()
    .collect()
}

/// A picture with its layers of first hits.
fn layers(desc: &SceneDesc, render: RenderDesc) -> Image {
    let scene = Scene::build(desc, &BuildOptions::default()).expect("a scene of the test");
    let settings = RenderSettings { desc: render, threads: 2, auxiliary: true, ..RenderSettings::default() };
    let mut render = Render::new(&scene, settings).expect("settings of the test");
    render.run(&mut |_| ControlFlow::Continue(())).expect("no worker panics");
    render.image()
}

/// Bit patterns of all values and layers, so that NaN equals itself and -0 differs from 0.
fn bits(image: &Image) -> Vec<u32> {
    let layers = image.layers.iter().flat_map(|layer| &layer.data);
    image.rgb.iter().chain(layers).map(|value| value.to_bits()).collect()
}
