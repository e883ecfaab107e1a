//! What a render knows of its own error: intervals that hold the truth, an estimate that is the error, renders that end where
//! they were told to, and adaptive samples without bias. With ETENDUE_ACCURACY=full over more renders.

mod common;

use std::ops::ControlFlow;
use std::time::Duration;

use common::scenes::{add, box_inside, camera, point_light, scene};
use common::stats::{SIGNIFICANCE, mean_and_error, sidak, z_test};
use common::stops::run_with_stops;
use etendue::desc::{BsdfDesc, IntegratorDesc, RenderDesc, SamplerDesc, SceneDesc, ShapeDesc};
use etendue::film::{ErrorMeasure, Image};
use etendue::math::DVec3;
use etendue::render::{Ended, MOST_SAMPLES, Render, RenderSettings, Summary, Workers};
use etendue::scene::{BuildOptions, Scene};
use etendue::spectrum::Rgb;

/// Student's t for 7 degrees of freedom leaves out 5 % beyond.
const T95: f64 = 2.364_624;

/// So many, or in `make accuracy` so many.
fn count(quick: u64, full: u64) -> u64 {
    if std::env::var("ETENDUE_ACCURACY").is_ok_and(|value| value == "full") { full } else { quick }
}

/// The second half of the scenes takes part in `make accuracy` only, in what is no different there.
fn is_left_out(scene: usize, is_more_of_the_same: bool) -> bool {
    scene >= 3 && is_more_of_the_same && count(0, 1) == 0
}

fn build(desc: &SceneDesc) -> Scene {
    Scene::build(desc, &BuildOptions::default()).unwrap()
}

/// A closed box of these walls, seen from one side.
fn walls(bsdf: BsdfDesc) -> SceneDesc {
    let mesh = ShapeDesc::Mesh { mesh: 0, smooth: false };
    let mut desc = scene(camera(DVec3::new(0.0, 0.0, 0.95), DVec3::NEG_Z, 80.0), vec![(mesh, bsdf, None)]);
    desc.meshes.push(box_inside(DVec3::splat(-1.0), DVec3::ONE).into());
    desc
}

fn lambert(r: f32, g: f32, b: f32) -> BsdfDesc {
    BsdfDesc::Lambert { albedo: Rgb::new(r, g, b) }
}

fn sphere(x: f64, y: f64, z: f64, radius: f64) -> ShapeDesc {
    ShapeDesc::Sphere { centre: DVec3::new(x, y, z), radius }
}

/// A spherical lamp at this height.
fn lamp(desc: &mut SceneDesc, y: f64, radius: f64, radiance: f32) {
    let number = desc.surfaces.len();
    add(desc, number, sphere(-0.4, y, -0.3, radius), BsdfDesc::Black, Some(Rgb::splat(radiance)));
}

fn ball(desc: &mut SceneDesc, bsdf: BsdfDesc) {
    let number = desc.surfaces.len();
    add(desc, number, sphere(0.3, -0.4, -0.3, 0.4), bsdf, None);
}

const GLASS: BsdfDesc = BsdfDesc::Dielectric { ior: 1.5, exterior_ior: 1.0 };

/// A point light at this height over the middle of the room, whose ceiling is at 1.
fn point(y: f64, bsdf: BsdfDesc) -> SceneDesc {
    let mut desc = walls(lambert(0.7, 0.5, 0.3));
    ball(&mut desc, bsdf);
    desc.lights.push(point_light(DVec3::new(-0.3, y, 0.0), 0.5));
    desc
}

/// Six small scenes: what paths meet in rooms, without light that only chance finds.
fn scenes() -> Vec<(&'static str, Scene)> {
    let mut area = walls(lambert(0.6, 0.6, 0.7));
    ball(&mut area, lambert(0.2, 0.6, 0.3));
    lamp(&mut area, 0.3, 0.25, 4.0);
    let mut penumbra = walls(lambert(0.1, 0.1, 0.1));
    ball(&mut penumbra, lambert(0.5, 0.5, 0.5));
    lamp(&mut penumbra, 0.4, 0.3, 4.0);
    let mut mirrors = walls(BsdfDesc::OrenNayarQualitative { albedo: Rgb::splat(0.6), sigma: 0.35 });
    ball(&mut mirrors, BsdfDesc::Mirror { reflectance: Rgb::splat(0.9) });
    mirrors.lights.push(point_light(DVec3::new(0.2, 0.2, 0.2), 0.5));
    let mut glow = walls(lambert(0.8, 0.8, 0.8));
    glow.surfaces[0].emission = Some(Rgb::new(0.1, 0.05, 0.02));
    ball(&mut glow, lambert(0.1, 0.2, 0.3));
    [
        ("point", point(0.2, lambert(0.6, 0.6, 0.6))),
        ("glass", point(0.2, GLASS)),
        ("area", area),
        ("penumbra", penumbra),
        ("mirror", mirrors),
        ("glow", glow),
    ]
    .into_iter()
    .map(|(name, desc)| (name, build(&desc)))
    .collect()
}

/// A small lamp whose light comes through a ball of glass: nothing but chance finds its caustic.
fn fireflies(radius: f64) -> Scene {
    let mut desc = walls(lambert(0.5, 0.5, 0.5));
    ball(&mut desc, GLASS);
    lamp(&mut desc, 0.7, radius, (0.6 / (radius * radius)) as f32);
    build(&desc)
}

fn settings(side: u32, samples: u32, seed: u64) -> RenderSettings {
    // Pixels are independent, but where a test says otherwise.
    let (reuse, light_paths) = (Some(false), Some(false));
    let desc = RenderDesc { resolution: [side; 2], samples, seed, reuse, light_paths, ..RenderDesc::default() };
    RenderSettings { desc, threads: 2, ..RenderSettings::default() }
}

fn run(scene: &Scene, settings: RenderSettings) -> (Image, Summary) {
    let mut render = Render::new(scene, settings).unwrap();
    let summary = render.run(&mut |_| ControlFlow::Continue(())).unwrap();
    (render.image(), summary)
}

/// Independent of all others, as are its pixels of each other.
fn reference(scene: &Scene, side: u32, samples: u32) -> Image {
    run(scene, settings(side, samples, 1 << 40)).0
}

/// Independent of all others, but its pixels share hits, which makes it as good with a few times fewer samples. A caustic is found by
/// light paths.
fn shared_reference(scene: &Scene, side: u32, samples: u32, has_caustic: bool) -> Image {
    let mut settings = settings(side, samples, 1 << 40);
    (settings.desc.reuse, settings.desc.light_paths) = (Some(true), Some(has_caustic));
    run(scene, settings).0
}

/// The reference's own noise is taken off.
fn true_rel_mse(image: &Image, reference: &Image) -> f64 {
    let level = reference.mean().iter().sum::<f64>() / 3.0;
    let noise = &reference.layer("variance").unwrap().data;
    let error = |i: usize| {
        let [a, b, noise] = [image.rgb[i], reference.rgb[i], noise[i]].map(f64::from);
        ((a - b) * (a - b) - noise) / (b * b + 0.01 * level * level)
    };
    (0..image.rgb.len()).map(error).sum::<f64>() / image.rgb.len() as f64
}

/// Root of the mean squared difference of what a screen shows, levels of 255.
fn true_display_error(image: &Image, reference: &Image) -> f64 {
    let level = |value: f32| 255.0 * f64::from(etendue::spectrum::srgb_encode(value));
    let pairs = image.rgb.iter().zip(&reference.rgb);
    (pairs.map(|(a, b)| (level(*a) - level(*b)).powi(2)).sum::<f64>() / image.rgb.len() as f64).sqrt()
}

#[test]
fn intervals_hold_the_truth_and_estimates_are_the_error() {
    let runs = count(10, 240);
    // Near a lamp, the ceiling is 25 times as bright as elsewhere, and few paths meet that: means of 64 samples are skewed
    // there, and seven degrees of freedom of what is skewed hold less.
    let near = ("near a lamp", build(&point(0.8, lambert(0.6, 0.6, 0.6))));
    // A caustic, by light paths. Without them few samples meet it.
    let mut glass = walls(lambert(0.5, 0.5, 0.5));
    ball(&mut glass, GLASS);
    lamp(&mut glass, 0.7, 0.3, 4.0);
    let caustic = ("caustic", build(&glass));
    for (number, (name, scene)) in scenes().into_iter().chain([near, caustic]).enumerate() {
        let (least, off) = if name == "near a lamp" { (0.85, 0.15) } else { (0.93, 0.1) };
        let side = count(12, 16) as u32;
        let exact = shared_reference(&scene, side, count(1 << 12, 1 << 16) as u32, name == "caustic");
        // Where pixels share hits, each one's error is still that of its own replicates.
        for (samples, adaptive, reuse, light_paths) in [
            (256, false, false, false),
            (256, true, false, false),
            (256, false, true, false),
            (256, false, false, true),
        ] {
            if light_paths != (name == "caustic") || is_left_out(number, adaptive || reuse) {
                continue;
            }
            let (mut covered, mut tried) = (0_u64, 0_u64);
            let (mut estimated, mut found, mut off_by) = (0.0, 0.0, 0.0);
            let mut differences = Vec::new();
            let (mut display, mut display_found) = (0.0, 0.0);
            let mut flagged = 0;
            for seed in 0..runs {
                let mut settings = RenderSettings { adaptive: Some(adaptive), ..settings(side, samples, seed) };
                (settings.desc.reuse, settings.desc.light_paths) = (Some(reuse), Some(light_paths));
                let (image, summary) = run(&scene, settings);
                // The reference has a few hundredths of the noise.
                let [variance, noise] = [&image, &exact].map(|image| &image.layer("variance").unwrap().data);
                for i in 0..image.rgb.len() {
                    tried += 1;
                    let off = f64::from((image.rgb[i] - exact.rgb[i]).abs());
                    covered += u64::from(off <= T95 * f64::from(variance[i] + noise[i]).sqrt());
                }
                let error = summary.rel_mse.unwrap();
                estimated += error.value;
                off_by += error.standard_error;
                flagged += u32::from(error.is_heavy_tailed());
                let truth = true_rel_mse(&image, &exact);
                found += truth;
                differences.push(error.value - truth);
                display += summary.display_error.unwrap().value;
                display_found += true_display_error(&image, &exact);
            }
            let share = covered as f64 / tried as f64;
            let (ratio, display) = (estimated / found, display / display_found);
            println!(
                "{name}, {samples} samples, adaptive {adaptive}, reuse {reuse}, light paths {light_paths}: 95 % intervals hold {:.2} %; relMSE {:.2e}, estimated over \
                 true {ratio:.3}, its standard error {:.0} %, said to rest on few pixels in {flagged} of {runs}; levels of \
                 255, estimated over true {display:.3}",
                100.0 * share,
                found / runs as f64,
                100.0 * off_by / estimated
            );
            assert!((least..=0.97).contains(&share), "{name}: {share}");
            // Where few pixels have most of the error, not even all renders together tell it to a tenth.
            let unsure = 3.0 * mean_and_error(&differences).1 * runs as f64 / found;
            assert!((ratio - 1.0).abs() < off + unsure, "{name}: estimated over true relMSE is {ratio}");
            assert!((display - 1.0).abs() < 0.1, "{name}: estimated over true display error is {display}");
        }
    }
}

#[test]
fn renders_end_at_the_error_that_was_asked_for() {
    let runs = count(6, 60);
    let side = count(24, 32) as u32;
    for (number, (name, scene)) in scenes().into_iter().enumerate() {
        let exact = shared_reference(&scene, side, count(1 << 10, 1 << 14) as u32, false);
        for (measure, adaptive) in
            [(ErrorMeasure::RelMse, false), (ErrorMeasure::RelMse, true), (ErrorMeasure::Display, true)]
        {
            if is_left_out(number, measure == ErrorMeasure::Display) {
                continue;
            }
            // As much as some 100 samples have, so that there is a way to go.
            let start = run(&scene, settings(side, 100, 7 << 40)).1;
            let target = match measure {
                ErrorMeasure::RelMse => start.rel_mse.unwrap().value,
                ErrorMeasure::Display => start.display_error.unwrap().value,
            };
            let (mut found, mut samples) = (Vec::new(), 0);
            for seed in 0..runs {
                let (image, summary) = run(
                    &scene,
                    RenderSettings {
                        target_error: Some(target),
                        error_measure: measure,
                        adaptive: Some(adaptive),
                        ..settings(side, MOST_SAMPLES, seed)
                    },
                );
                assert_eq!((summary.ended, summary.adaptive), (Ended::Error, adaptive), "{name}");
                samples += summary.samples;
                found.push(match measure {
                    ErrorMeasure::RelMse => true_rel_mse(&image, &exact),
                    // Squared, or half of 15 % would be asked for.
                    ErrorMeasure::Display => true_display_error(&image, &exact).powi(2) / target,
                });
            }
            let (mean, error) = mean_and_error(&found);
            println!(
                "{name}, {measure:?}, adaptive {adaptive}: true error over what was asked for {:.3} ± {:.3}, {} samples",
                mean / target,
                error / target,
                samples / runs as u32
            );
            assert!(
                (mean / target - 1.0).abs() < 0.15 + 3.0 * error / target,
                "{name}, {measure:?}: {}",
                mean / target
            );
        }
    }
}

#[test]
fn rare_bright_paths_do_not_end_a_render_early() {
    let runs = count(10, 100);
    const SIDE: u32 = 20;
    let scene = fireflies(0.02);
    let exact = shared_reference(&scene, SIDE, count(1 << 12, 1 << 17) as u32, true);
    for adaptive in [false, true] {
        let target = 0.3;
        let mut found = Vec::new();
        for seed in 0..runs {
            let adaptive = Some(adaptive);
            let settings = RenderSettings { target_error: Some(target), adaptive, ..settings(SIDE, 1 << 12, seed) };
            let (image, summary) = run(&scene, settings);
            assert!(summary.samples >= 32);
            found.push(true_rel_mse(&image, &exact));
        }
        let (mean, error) = mean_and_error(&found);
        let late = found.iter().filter(|error| **error > 2.0 * target).count();
        println!(
            "fireflies, adaptive {adaptive}: true error over what was asked for {:.3} ± {:.3}, twice as much in {late} of {runs}",
            mean / target,
            error / target
        );
        assert!(mean < 1.15 * target, "{mean}");
    }
}

/// How many standard errors the mean over renders is off the reference, over all pixels relative to their brightness.
fn bias(images: &[Vec<f32>], exact: &Image) -> (f64, f64) {
    let level = exact.mean().iter().sum::<f64>() / 3.0;
    let weight = |b: f64| 1.0 / (b * b + 0.01 * level * level).sqrt();
    let off = |rgb: &Vec<f32>| {
        let pairs = rgb.iter().zip(&exact.rgb).map(|(&a, &b)| (f64::from(a), f64::from(b)));
        pairs.map(|(a, b)| (a - b) * weight(b)).sum::<f64>() / rgb.len() as f64
    };
    let (mean, error) = mean_and_error(&images.iter().map(off).collect::<Vec<_>>());
    // That of the reference, pixels being independent and channels not.
    let variances = exact.rgb.chunks_exact(3).zip(exact.layer("variance").unwrap().data.chunks_exact(3));
    let of_exact = variances.map(|(b, v)| {
        (b.iter().zip(v)).map(|(&b, &v)| f64::from(v).sqrt() * weight(f64::from(b))).sum::<f64>().powi(2)
    });
    let of_exact = of_exact.sum::<f64>() / (exact.rgb.len() as f64).powi(2);
    (mean, (error * error + of_exact).sqrt())
}

#[test]
fn adaptive_samples_are_no_bias_and_the_naive_rule_is_one() {
    let runs = count(40, 400);
    const SIDE: u32 = 12;
    // Of skewed samples: where a pixel's own decide, those that missed the bright path stop.
    let all = scenes().into_iter().filter(|(name, _)| ["point", "area", "glass"].contains(name));
    for (name, scene) in all.chain([("fireflies", fireflies(0.1))]) {
        let exact = reference(&scene, SIDE, count(1 << 13, 1 << 16) as u32);
        let plain = |samples, seed| run(&scene, settings(SIDE, samples, seed)).0;
        let adaptive: Vec<_> = (0..runs)
            .map(|seed| run(&scene, RenderSettings { adaptive: Some(true), ..settings(SIDE, 64, seed) }).0.rgb)
            .collect();
        // Any sample is a function of seed, pixel and index, so renders of 16 and of 112 samples together make an image in
        // which each pixel has either, by its own variance: 64 on average as well.
        let naive: Vec<_> = (0..runs)
            .map(|seed| {
                let (few, many) = (plain(16, seed), plain(112, seed));
                let relative = |i: usize| {
                    let (mean, variance) = (f64::from(few.rgb[i]), &few.layer("variance").unwrap().data);
                    f64::from(variance[i]) / (mean * mean + 1e-9)
                };
                let errors: Vec<f64> = (0..few.rgb.len()).step_by(3).map(|i| (i..i + 3).map(relative).sum()).collect();
                let mut sorted = errors.clone();
                sorted.sort_by(f64::total_cmp);
                let median = sorted[sorted.len() / 2];
                let pick = |i: usize| if errors[i / 3] > median { many.rgb[i] } else { few.rgb[i] };
                (0..few.rgb.len()).map(pick).collect()
            })
            .collect();
        let (ours, error) = bias(&adaptive, &exact);
        let (theirs, their_error) = bias(&naive, &exact);
        println!(
            "{name}: adaptive off by {:.3} ± {:.3} %, by the naive rule {:.3} ± {:.3} %",
            100.0 * ours,
            100.0 * error,
            100.0 * theirs,
            100.0 * their_error
        );
        assert!(z_test(ours, error, 0.0) > sidak(SIGNIFICANCE, 4), "{name}: {ours} ± {error}");
        if name == "fireflies" {
            assert!(theirs < -5.0 * their_error, "the naive rule should be found out: {theirs} ± {their_error}");
        }
    }
}

#[test]
fn budgets_combine() {
    let scene = fireflies(0.1);
    let adaptive = |samples, time_limit, target_error| RenderSettings {
        adaptive: Some(true),
        time_limit,
        target_error,
        ..settings(24, samples, 3)
    };
    let soon = Some(Duration::from_millis(80));
    let (_, summary) = run(&scene, adaptive(100, None, None));
    assert_eq!((summary.ended, summary.samples, summary.adaptive), (Ended::Samples, 100, true));
    let counts = summary.sample_counts.unwrap();
    // All of the 576 x 100 samples but less than eight, and each pixel its share.
    assert!(counts.mean <= 100.0 && counts.mean > 100.0 - 8.0 / 576.0, "{counts:?}");
    assert!(counts.min >= 16 && counts.max > 150, "{counts:?}");
    let (_, summary) = run(&scene, adaptive(MOST_SAMPLES, soon, None));
    assert!(summary.ended == Ended::Time && summary.elapsed >= Duration::from_millis(60));
    let (_, summary) = run(&scene, adaptive(MOST_SAMPLES, soon, Some(1e-9)));
    assert_eq!(summary.ended, Ended::Time);
    let (_, summary) = run(&scene, adaptive(40, Some(Duration::from_secs(3600)), Some(1e-9)));
    assert_eq!((summary.ended, summary.samples), (Ended::Samples, 40));
    let (_, summary) = run(&scene, adaptive(MOST_SAMPLES, Some(Duration::from_secs(3600)), Some(5.0)));
    assert_eq!(summary.ended, Ended::Error);
    // Below the pilot, all alike.
    let (_, summary) = run(&scene, adaptive(11, None, None));
    let counts = summary.sample_counts.unwrap();
    assert_eq!((counts.min, counts.max, summary.adaptive), (11, 11, false));
    assert!(summary.notes.iter().any(|note| note.contains("too few to choose by")), "{:?}", summary.notes);
}

#[test]
fn where_pixels_must_be_alike_they_are() {
    let scene = fireflies(0.1);
    let with = |sampler, integrator| {
        let mut settings = RenderSettings { adaptive: Some(true), ..settings(16, 64, 3) };
        (settings.desc.sampler, settings.desc.integrator) = (sampler, integrator);
        settings.desc.photons.count = Some(1000);
        settings.desc.photons.caustic_count = Some(1000);
        let summary = run(&scene, settings).1;
        let counts = summary.sample_counts.unwrap();
        let is_noted = summary.notes.iter().any(|note| note.contains("same number of samples"));
        assert_eq!((counts.min == counts.max, is_noted), (!summary.adaptive, !summary.adaptive));
        summary.adaptive
    };
    assert!(with(SamplerDesc::Sobol, IntegratorDesc::Path));
    assert!(with(SamplerDesc::Random, IntegratorDesc::Path));
    for sampler in [SamplerDesc::Jittered, SamplerDesc::Grid, SamplerDesc::Gaussian] {
        assert!(!with(sampler, IntegratorDesc::Path), "{sampler:?}");
    }
    assert!(!with(SamplerDesc::Sobol, IntegratorDesc::Sppm));
}

/// Threads, passes and stops in the middle of them change nothing.
#[test]
fn an_adaptive_render_in_many_goes_is_the_same() {
    let scene = fireflies(0.1);
    for target_error in [None, Some(0.02)] {
        let settings = || RenderSettings { adaptive: Some(true), target_error, ..settings(40, 300, 11) };
        let (whole, expected) = run(&scene, RenderSettings { threads: 3, ..settings() });
        let workers = Some(Workers::calling_thread());
        let mut parts = Render::new(&scene, RenderSettings { workers, ..settings() }).unwrap();
        let (stops, summary) = run_with_stops(&mut parts, Duration::from_millis(2));
        assert!(stops > 0, "it was over before it could be stopped");
        let image = parts.image();
        assert_eq!((image.rgb, summary.ended), (whole.rgb, expected.ended), "after {stops} stops");
        assert_eq!(image.layers[0], whole.layers[0]);
        assert!(expected.sample_counts.unwrap().max > expected.samples);
    }
}
