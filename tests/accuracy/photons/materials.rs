//! A closed room that holds one of each material, by the methods that read photon maps and by path tracing.

use super::{METHODS, build, images, load, photons};
use crate::record::{Case, Entry};
use crate::stats;
use crate::transport::pick;
use etendue::desc::{IntegratorDesc, RenderDesc};
use etendue::film::Image;

pub fn cases() -> Vec<Entry> {
    vec![Entry { id: "M71", title: "room of all materials, photon methods and paths", run: room }]
}

/// Regions of the image along each side.
const SIDE: usize = 4;

/// Means over the regions of an image, all channels together.
fn regions(image: &Image) -> Vec<f64> {
    let (width, height) = (image.width as usize, image.height as usize);
    let mut found = [0.0; SIDE * SIDE];
    for (pixel, rgb) in image.rgb.chunks_exact(3).enumerate() {
        let region = |at: usize, size: usize| at * SIDE / size;
        let (x, y) = (region(pixel % width, width), region(pixel / width, height));
        found[y * SIDE + x] += rgb.iter().map(|&v| f64::from(v)).sum::<f64>();
    }
    found.iter().map(|sum| sum * (SIDE * SIDE) as f64 / image.rgb.len() as f64).collect()
}

fn room(case: &mut Case) {
    let scene = build(&load("materials.json"));
    let runs = 16;
    let all = |desc: &RenderDesc| images(&scene, desc, runs).iter().map(regions).collect::<Vec<_>>();
    let settings = |integrator, samples: u64, paths: u64| RenderDesc {
        resolution: [32, 20],
        samples: samples as u32,
        integrator,
        photons: photons(paths as u32, 0.05),
        ..RenderDesc::default()
    };
    let expected = all(&settings(IntegratorDesc::Path, case.count(256, 4096), 1));
    let of = |images: &[Vec<f64>], region: usize| {
        stats::mean_and_error(&images.iter().map(|image| image[region]).collect::<Vec<_>>())
    };
    for integrator in METHODS.into_iter().chain([IntegratorDesc::IrradianceCache]) {
        let name = integrator.name();
        let mut desc = settings(integrator, case.count(32, 512), case.count(1 << 14, 1 << 17));
        if integrator == IntegratorDesc::PhotonDirect {
            // Estimates of few photons are not used, and so the others are too large in the mean. Its paths are not combined with
            // light samples.
            let count = case.count(1 << 19, 1 << 20) as u32;
            (desc.photons.count, desc.samples) = (Some(count), 2 * desc.samples);
        }
        let found = all(&desc);
        let (mut smallest, mut largest, mut error_of_region) = (1.0_f64, 0.0_f64, 0.0_f64);
        for region in 0..SIDE * SIDE {
            let (a, b) = (of(&found, region), of(&expected, region));
            let error = a.1.hypot(b.1);
            // Estimates with a radius and interpolated records are smoother than the light.
            let beyond = ((a.0 - b.0).abs() - 5e-3 * b.0).max(0.0);
            smallest = smallest.min(stats::t_test((beyond, error), 0.0, runs));
            largest = largest.max((a.0 / b.0 - 1.0).abs());
            error_of_region = error_of_region.max(error / b.0);
        }
        case.p_value(format!("{name}: regions, beyond 0.005"), smallest, (METHODS.len() + 1) * SIDE * SIDE);
        case.at_most(format!("{name}: largest difference of a region"), largest, pick(case, 0.05, 0.01));
        // A region that is 2 % off is then 1.5 % beyond the allowance, four of these errors.
        case.at_most(format!("{name}: largest error of a region"), error_of_region, pick(case, 0.015, 3.75e-3));
    }
}
