//! `compare A B`.

use etendue::film::Image;
use etendue::output::{self, Metrics, REL_MSE_EPSILON, ToneMap};
use serde::Serialize;

use crate::args::CompareArgs;
use crate::failure::check_room;
use crate::{Failure, console};

/// FLIP holds about 130 bytes per pixel (measured on 2000 x 2000): larger images are not given to it.
const MAX_FLIP_PIXELS: u64 = 1 << 24;

/// Address space that FLIP is given for each pixel, with its images and its result, and besides: 76 bytes are enough (measured on 9 and 16
/// million pixels). A lack of memory in its C++ ends the program.
const FLIP_BYTES: usize = 96;
const FLIP_BYTES_BESIDES: usize = 1 << 20;

/// All differences that are measured.
#[derive(Serialize)]
struct Report {
    #[serde(flatten)]
    metrics: Metrics,
    /// Mean FLIP error in [0, 1]; `None` where it was not computed.
    flip: Option<f64>,
}

/// Reads both images, measures, prints.
pub fn compare(args: &CompareArgs) -> Result<u8, Failure> {
    let a = output::read(&args.a)?;
    let b = output::read(&args.b)?;
    let metrics = output::compare(&a, &b)?;
    let too_large = u64::from(a.width) * u64::from(a.height) > MAX_FLIP_PIXELS;
    if too_large && !args.no_flip {
        console::warn(format!("FLIP is left out: the images have more than {MAX_FLIP_PIXELS} pixels"));
    }
    let flip = if args.no_flip || too_large { None } else { Some(mean_flip(&a, &b, args.exposure)?) };
    let report = Report { metrics, flip };
    let text = if args.json {
        serde_json::to_string(&report).map_err(|error| Failure::running(format!("cannot write JSON: {error}")))?
    } else {
        describe(&report)
    };
    console::print(&text)?;
    Ok(0)
}

/// Mean over the pixels of FLIP for low dynamic range (Andersson et al. 2020, "FLIP: A Difference Evaluator for
/// Alternating Images") between the images as 8-bit sRGB, seen at the default distance of 67 pixels per degree.
fn mean_flip(a: &Image, b: &Image, exposure: f32) -> Result<f64, Failure> {
    let pixels = a.width as usize * a.height as usize;
    check_room(FLIP_BYTES * pixels + FLIP_BYTES_BESIDES)
        .map_err(|failure| Failure::running(format!("FLIP: {failure} (--no-flip leaves it out)")))?;
    let picture = |image: &Image| -> Result<_, Failure> {
        let pixels = output::to_srgb8(image, ToneMap::Clamp, exposure)?;
        Ok(nv_flip::FlipImageRgb8::with_data(image.width, image.height, &pixels))
    };
    let map = nv_flip::flip(picture(b)?, picture(a)?, nv_flip::DEFAULT_PIXELS_PER_DEGREE).to_vec();
    Ok(map.iter().map(|&error| f64::from(error)).sum::<f64>() / map.len() as f64)
}

/// A table in readable form.
fn describe(report: &Report) -> String {
    let metrics = &report.metrics;
    let rgb = |[r, g, b]: [f64; 3]| format!("{r:.6} {g:.6} {b:.6}");
    let [x, y] = metrics.max_at;
    let mut lines = vec![
        format!("mse             {:.6e}", metrics.mse),
        format!("relative mse    {:.6e}  (epsilon {REL_MSE_EPSILON})", metrics.rel_mse),
        format!("relMSE          {:.6e}  (epsilon 1 % of the squared mean)", metrics.rel_mse_to_mean),
        format!("psnr            {:.2} dB", metrics.psnr),
        format!("max difference  {:.6e}  at column {x}, row {y}", metrics.max_abs_difference),
        format!("mean of A       {}", rgb(metrics.mean_a)),
        format!("mean of B       {}", rgb(metrics.mean_b)),
        format!("ratio A / B     {}", rgb(metrics.ratio)),
    ];
    if let Some(flip) = report.flip {
        lines.push(format!("flip            {flip:.6}"));
    }
    if metrics.non_finite > 0 {
        lines.push(format!("not finite      {} pixels, left out of all but flip", metrics.non_finite));
    }
    lines.join("\n")
}
