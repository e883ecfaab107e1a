//! Films whose channels are the means over bands of wavelengths.

use std::ops::ControlFlow;

use super::own::{REFLECTANCES, between, relative, samples};
use super::{METHODS, build, channels, room, spectral};
use crate::common::scenes::Job;
use crate::record::Case;
use crate::transport::{grey, pick};
use etendue::desc::{IntegratorDesc, PhotonDesc, RenderDesc, SpectrumDesc, SpectrumKey, SpectrumTarget};
use etendue::film::Image;
use etendue::math::DVec3;
use etendue::render::{Render, RenderSettings};
use etendue::scene::Scene;
use etendue::spectrum::{Illuminant, REC_709_FROM_XYZ, Rgb, Sensor, VISIBLE, color_matching};

/// A picture of three bands.
fn picture(scene: &Scene, desc: RenderDesc, range: [f64; 2]) -> Image {
    let sensor = Sensor::Bands { range };
    let settings = RenderSettings { desc, sensor, threads: 2, ..RenderSettings::default() };
    let mut render = Render::new(scene, settings).expect("settings of the test");
    let summary = render.run(&mut |_| ControlFlow::Continue(())).expect("no worker panics");
    assert_eq!(summary.non_finite, 0, "NaN or infinite samples");
    render.image()
}

/// Edges of so many bands of equal width.
fn edges([first, last]: [f64; 2], count: usize) -> Vec<f64> {
    (0..=count).map(|i| first + (last - first) * i as f64 / count as f64).collect()
}

/// The integral over a band, by 50 steps for each nanometre.
fn integral(from: f64, to: f64, f: impl Fn(f64) -> DVec3) -> DVec3 {
    let count = ((to - from) * 50.0).ceil() as u32;
    let width = (to - from) / f64::from(count);
    (0..count).map(|i| f(from + (f64::from(i) + 0.5) * width) * width).sum()
}

/// In a closed room of albedo rho that glows evenly, the radiance is E / (1 - rho) at each wavelength, and E (1 + rho) where light is
/// reflected once.
pub fn means(case: &mut Case) {
    let light = relative(Illuminant::A);
    let reflectance = REFLECTANCES[1];
    let mut desc = room(grey(0.5), Rgb::ZERO);
    desc.set_emission(0, None).expect("a surface");
    desc.set_spectrum(SpectrumTarget::Surface(0), SpectrumDesc::by_name("A")).expect("a light");
    let of_walls = SpectrumTarget::Material(0, SpectrumKey::Color);
    desc.set_spectrum(of_walls, Some(samples(reflectance))).expect("a reflectance");
    let scene = build(&desc);
    let rho = |nanometres: f64| between(reflectance, nanometres, true);

    for integrator in METHODS {
        let is_in_passes =
            !matches!(integrator, IntegratorDesc::Path | IntegratorDesc::Whitted | IntegratorDesc::Direct);
        let once = matches!(integrator, IntegratorDesc::Whitted | IntegratorDesc::Direct);
        // The bands of the other methods are those in which the reflectance varies.
        let edges =
            if integrator == IntegratorDesc::Path { edges([380.0, 780.0], 12) } else { edges([500.0, 620.0], 3) };
        let samples = case.count(if is_in_passes { 1024 } else { 256 }, if is_in_passes { 8192 } else { 2048 }) as u32;
        let resolution = if is_in_passes { [4, 4] } else { [16, 16] };
        let photons = PhotonDesc { count: Some(1000), ..PhotonDesc::default() };
        let job = Job { resolution, samples, integrator, ..Job::default() };
        // Bands have no white.
        let white_balance = RenderDesc::white_of("A");
        let desc = RenderDesc { spectral: true, photons, white_balance, ..job.desc() };
        let bias = if is_in_passes { pick(case, 6e-3, 1.5e-3) } else { 2e-4 };
        for film in edges.windows(4).step_by(3) {
            let found = channels(&picture(&scene, desc.clone(), [film[0], film[3]]));
            for (band, (mean, error)) in film.windows(2).zip(found) {
                let [from, to] = [band[0], band[1]];
                let radiance = |nanometres: f64| {
                    let several = if once { 1.0 + rho(nanometres) } else { 1.0 / (1.0 - rho(nanometres)) };
                    DVec3::splat(light(nanometres) * several)
                };
                let exact = integral(from, to, radiance).x / (to - from);
                let what = format!("{}, {from:.1} to {to:.1} nm, over the exact mean", integrator.name());
                let found = (mean / exact, error / exact);
                case.biased_mean(what, found, 1.0, (bias, pick(case, 8e-3, 2e-3)));
            }
        }
    }

    // The bands of all that is seen, weighted by the colour matching functions, against the usual picture.
    let job = Job { resolution: [16, 16], samples: case.count(128, 1024) as u32, ..Job::default() };
    let desc = RenderDesc { spectral: true, ..job.desc() };
    let (mut colour, mut variance) = (DVec3::ZERO, DVec3::ZERO);
    for film in edges(VISIBLE, 90).windows(4).step_by(3) {
        let found = channels(&picture(&scene, desc.clone(), [film[0], film[3]]));
        for (band, (mean, error)) in film.windows(2).zip(found) {
            let weight = *REC_709_FROM_XYZ * integral(band[0], band[1], color_matching);
            colour += weight * mean;
            variance += (weight * error) * (weight * error);
        }
    }
    let usual = channels(&spectral(&scene, &Job { seed: 7, ..job }));
    let most = usual.iter().map(|channel| channel.0).fold(0.0, f64::max);
    for (channel, (mean, noise)) in usual.into_iter().enumerate() {
        let off = (colour[channel] - mean) / most;
        let error = variance[channel].sqrt().hypot(noise) / most;
        let what = format!("sum over 90 bands, channel {channel}: difference over the largest");
        // Within a band the reflectance is not constant.
        case.biased_mean(what, (1.0 + off, error), 1.0, (2e-3, pick(case, 8e-3, 2e-3)));
    }
}
