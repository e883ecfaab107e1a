//! What adaptive samples gain, and whether the estimated error is the true one: relMSE at equal samples and at equal rays.
//!
//! `cargo bench --bench errors [-- SAMPLES ... SCENE ...]`. The truth is what renders of different seeds differ by, so no reference is
//! needed: the mean over pixels of the variance over seeds, relative to the squared mean over all of them.
#![allow(clippy::unwrap_used, reason = "a bench has nobody to tell")]

use std::ops::ControlFlow;

use etendue::desc::RenderDesc;
use etendue::film::Image;
use etendue::render::{Render, RenderSettings, Summary};
use etendue::scene::{BuildOptions, Scene};

const SEEDS: u64 = 4;
const SCENES: [&str; 6] = ["room", "cornell", "caustic", "many-lights", "mirrors", "colour-bleeding"];

fn render(scene: &Scene, desc: RenderDesc, adaptive: bool) -> (Image, Summary) {
    let settings = RenderSettings { desc, adaptive: Some(adaptive), threads: 2, ..RenderSettings::default() };
    let mut render = Render::new(scene, settings).unwrap();
    let summary = render.run(&mut |_| ControlFlow::Continue(())).unwrap();
    (render.image(), summary)
}

/// What renders are off the mean over all (of both kinds), relative to its square, as `Film::rel_mse` means it.
fn rel_mse(images: &[Image], mean: &[f64]) -> f64 {
    let n = images.len() as f64;
    let level = mean.iter().sum::<f64>() / mean.len() as f64;
    let mut sum = 0.0;
    for (i, mean) in mean.iter().enumerate() {
        let values: Vec<f64> = images.iter().map(|image| f64::from(image.rgb[i])).collect();
        let own = values.iter().sum::<f64>() / n;
        let variance = values.iter().map(|v| (v - own) * (v - own)).sum::<f64>() / (n - 1.0);
        sum += variance / (mean * mean + 0.01 * level * level);
    }
    sum / mean.len() as f64
}

fn main() {
    let (mut asked, mut counts) = (Vec::new(), Vec::new());
    for word in std::env::args().skip(1).filter(|word| !word.starts_with('-')) {
        match word.parse::<u32>() {
            Ok(samples) => counts.push(samples),
            Err(_) => asked.push(word),
        }
    }
    if asked.is_empty() {
        asked = SCENES.map(String::from).to_vec();
    }
    if counts.is_empty() {
        counts = vec![64, 256];
    }
    println!("| | samples | uniform | estimated | adaptive | estimated | gain | rays | at equal rays | fewest, most |");
    println!("|---|---|---|---|---|---|---|---|---|---|");
    for name in asked {
        let desc = etendue::desc::load(format!("scenes/{name}.json").as_ref(), None).unwrap();
        let scene = Scene::build(&desc, &BuildOptions::default()).unwrap();
        for &samples in &counts {
            let run = |adaptive: bool| -> Vec<(Image, Summary)> {
                let alone = RenderDesc { reuse: Some(false), light_paths: Some(false), ..desc.render.clone() };
                let desc = |seed| RenderDesc { resolution: [128, 128], samples, seed, ..alone.clone() };
                (0..SEEDS).map(|seed| render(&scene, desc(seed + 100 * u64::from(adaptive)), adaptive)).collect()
            };
            let (uniform, adaptive) = (run(false), run(true));
            let values = uniform[0].0.rgb.len();
            let all = || uniform.iter().chain(&adaptive);
            let mean: Vec<f64> = (0..values)
                .map(|i| all().map(|(image, _)| f64::from(image.rgb[i])).sum::<f64>() / (2 * SEEDS) as f64)
                .collect();
            let error = |runs: &[(Image, Summary)]| {
                rel_mse(&runs.iter().map(|(image, _)| image.clone()).collect::<Vec<_>>(), &mean)
            };
            let estimate = |runs: &[(Image, Summary)]| {
                runs.iter().filter_map(|(_, summary)| Some(summary.rel_mse?.value)).sum::<f64>() / runs.len() as f64
            };
            let rays = |runs: &[(Image, Summary)]| runs.iter().map(|(_, summary)| summary.rays as f64).sum::<f64>();
            let (before, after) = (error(&uniform), error(&adaptive));
            let cost = rays(&adaptive) / rays(&uniform);
            let range = adaptive[0].1.sample_counts.unwrap_or_default();
            println!(
                "| {name} | {samples} | {before:.3e} | {:.3e} | {after:.3e} | {:.3e} | {:.2} | {cost:.2} | {:.2} | {}, {} |",
                estimate(&uniform),
                estimate(&adaptive),
                before / after,
                before / after / cost,
                range.min,
                range.max
            );
        }
    }
}
