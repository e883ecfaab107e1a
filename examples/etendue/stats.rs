//! Results of a render in machine-readable form: `render --stats FILE.json`.

use std::path::Path;
use std::time::Duration;

use etendue::Result;
use etendue::desc::RenderDesc;
use etendue::film::ErrorMeasure;
use etendue::output;
use etendue::render::{MOST_SAMPLES, Summary};
use serde::Serialize;

use crate::args::RenderArgs;
use crate::console;

/// The JSON object. Numbers that are unknown or not finite are null.
#[derive(Serialize)]
#[serde(rename_all = "camelCase")]
pub struct Stats {
    version: &'static str,
    scene: String,
    /// Width and height of the picture, pixels.
    resolution: [u32; 2],
    /// First column and row, width and height of what was rendered of it; null for all of it.
    crop: Option<[u32; 4]>,
    settings: Settings,
    samples: Samples,
    seconds: Seconds,
    rays: u64,
    rays_per_second: f64,
    #[serde(rename = "relMSE")]
    rel_mse: Estimate,
    /// Levels of 255.
    display_error: Estimate,
    /// The integrator that took the samples.
    integrator: &'static str,
    /// `samples`, `time`, `error` or `cancelled`.
    ended: &'static str,
    target: Option<Target>,
    non_finite: u64,
    notes: Vec<String>,
    /// Bytes.
    peak_memory: Option<u64>,
}

#[derive(Serialize)]
#[serde(rename_all = "camelCase")]
struct Settings {
    integrator: &'static str,
    sampler: String,
    filter: String,
    /// The requested number; null where only time and error end the render.
    spp: Option<u32>,
    /// `allowed` or `refused`.
    bias: &'static str,
    reuse: bool,
    light_paths: bool,
    spectral: bool,
    white_balance: Option<[f64; 2]>,
    max_depth: Option<u32>,
    shadow_rays: u32,
    first_shadow_rays: u32,
    roulette: &'static str,
    seed: u64,
    threads: usize,
    adaptive: bool,
}

#[derive(Serialize)]
struct Samples {
    mean: Option<f64>,
    min: Option<u32>,
    max: Option<u32>,
}

#[derive(Serialize)]
struct Seconds {
    /// Time for reading and building the scene.
    build: f64,
    render: f64,
}

#[derive(Serialize)]
#[serde(rename_all = "camelCase")]
struct Estimate {
    value: Option<f64>,
    standard_error: Option<f64>,
}

#[derive(Serialize)]
struct Target {
    /// `relMSE` or `display`.
    measure: &'static str,
    value: f64,
}

impl Stats {
    pub fn new(args: &RenderArgs, desc: &RenderDesc, summary: &Summary, threads: usize, build: Duration) -> Self {
        let estimate = |error: Option<etendue::film::ErrorEstimate>| Estimate {
            value: error.map(|error| error.value),
            standard_error: error.map(|error| error.standard_error),
        };
        Self {
            version: env!("CARGO_PKG_VERSION"),
            scene: args.scene.display().to_string(),
            resolution: desc.resolution,
            crop: desc.crop.map(|it| [it.left, it.top, it.width, it.height]),
            settings: Settings {
                integrator: desc.integrator.name(),
                sampler: format!("{:?}", desc.sampler).to_lowercase(),
                filter: format!("{:?}", desc.filter),
                spp: (desc.samples < MOST_SAMPLES).then_some(desc.samples),
                bias: if desc.allow_bias { "allowed" } else { "refused" },
                reuse: summary.reuse,
                light_paths: summary.light_paths,
                spectral: desc.spectral,
                white_balance: desc.white_balance,
                max_depth: desc.max_depth,
                shadow_rays: desc.shadow_rays,
                first_shadow_rays: summary.first_shadow_rays,
                roulette: desc.roulette.name(),
                seed: desc.seed,
                threads,
                adaptive: summary.adaptive,
            },
            samples: Samples {
                mean: summary.sample_counts.map(|counts| counts.mean),
                min: summary.sample_counts.map(|counts| counts.min),
                max: summary.sample_counts.map(|counts| counts.max),
            },
            seconds: Seconds { build: build.as_secs_f64(), render: summary.elapsed.as_secs_f64() },
            rays: summary.rays,
            rays_per_second: summary.rays as f64 / summary.elapsed.as_secs_f64(),
            rel_mse: estimate(summary.rel_mse),
            display_error: estimate(summary.display_error),
            integrator: summary.integrator.name(),
            ended: summary.ended.name(),
            target: args.target().map(|(measure, value)| Target {
                measure: match measure {
                    ErrorMeasure::RelMse => "relMSE",
                    ErrorMeasure::Display => "display",
                },
                value,
            }),
            non_finite: summary.non_finite,
            notes: summary.notes.clone(),
            peak_memory: console::peak_memory(),
        }
    }

    /// Writes the file in one step.
    pub fn write(&self, path: &Path) -> Result<()> {
        // No number here fails to serialise: values that are not finite become null.
        let text = serde_json::to_string_pretty(self).unwrap_or_default();
        output::write_text(&(text + "\n"), path)
    }
}
