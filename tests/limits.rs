//! Samples, time and error each end a render when they should, and the report on the way only goes forward.

mod common;

use std::ops::ControlFlow;
use std::path::Path;
use std::time::Duration;

use common::scenes::{box_inside, camera, point_light, scene};
use etendue::desc::{
    self, BsdfDesc, CropDesc, FilterDesc, IntegratorDesc, RenderDesc, SamplerDesc, SceneDesc, ShapeDesc, ShutterDesc,
};
use etendue::film::Image;
use etendue::integrator::{Probe, ProbeQuantity};
use etendue::math::DVec3;
use etendue::render::{Ended, MOST_SAMPLES, Progress, Render, RenderSettings, Summary, Workers};
use etendue::scene::{BuildOptions, Scene};
use etendue::spectrum::Rgb;
use etendue::{Cancel, ErrorKind};
use proptest::prelude::*;

/// A diffuse room with a lamp in it, and a ball of this kind.
fn room(ball: BsdfDesc) -> Scene {
    let mut desc: SceneDesc = scene(
        camera(DVec3::new(0.0, 0.0, 0.9), DVec3::NEG_Z, 80.0),
        vec![
            (
                ShapeDesc::Mesh { mesh: 0, smooth: false },
                BsdfDesc::Lambert { albedo: Rgb::new(0.7, 0.5, 0.3) },
                Some(Rgb::splat(0.02)),
            ),
            (ShapeDesc::Sphere { centre: DVec3::new(0.3, -0.4, -0.3), radius: 0.4 }, ball, None),
        ],
    );
    desc.meshes.push(box_inside(DVec3::splat(-1.0), DVec3::ONE).into());
    desc.lights.push(point_light(DVec3::new(-0.3, 0.8, 0.0), 0.5));
    Scene::build(&desc, &BuildOptions::default()).unwrap()
}

fn diffuse() -> Scene {
    room(BsdfDesc::Lambert { albedo: Rgb::splat(0.6) })
}

fn run(scene: &Scene, settings: RenderSettings) -> (Image, Summary) {
    let mut render = Render::new(scene, settings).unwrap();
    let summary = render.run(&mut |_| ControlFlow::Continue(())).unwrap();
    assert_eq!(summary.stopped, summary.ended == Ended::Cancelled);
    (render.image(), summary)
}

/// The distance from a reference, measured as [`Film::rel_mse`](etendue::film::Film::rel_mse) estimates it.
fn rel_mse(image: &Image, reference: &Image) -> f64 {
    let mean = reference.mean().iter().sum::<f64>() / 3.0;
    let floor = 0.01 * mean * mean;
    let pairs = image.rgb.iter().zip(&reference.rgb).map(|(&a, &b)| (f64::from(a), f64::from(b)));
    let sum: f64 = pairs.map(|(a, b)| (a - b) * (a - b) / (b * b + floor)).sum();
    sum / image.rgb.len() as f64
}

#[test]
fn the_error_is_what_was_asked_for() {
    let glass = BsdfDesc::Dielectric { ior: 1.5, exterior_ior: 1.0 };
    for (name, scene) in [("diffuse", diffuse()), ("glass", room(glass))] {
        let desc = RenderDesc { resolution: [24, 24], ..RenderDesc::default() };
        // Independent of the renders below, and with an error far below theirs.
        let long = RenderDesc { samples: 1 << 10, seed: 99, reuse: Some(true), ..desc.clone() };
        let (reference, known) = run(&scene, RenderSettings { desc: long, threads: 2, ..RenderSettings::default() });
        for target in [0.01, 0.0025, 0.000625] {
            let desc = RenderDesc { samples: MOST_SAMPLES, ..desc.clone() };
            let target_error = Some(target);
            let (image, summary) =
                run(&scene, RenderSettings { desc, threads: 2, target_error, ..RenderSettings::default() });
            assert_eq!(summary.ended, Ended::Error);
            let estimate = summary.rel_mse.unwrap().value;
            let truth = rel_mse(&image, &reference);
            println!(
                "{name}, target {target}: estimate {estimate:.2e}, truth {truth:.2e}, {} samples, reference {:.2e}",
                summary.samples,
                known.rel_mse.unwrap().value
            );
            // 32 samples are the least.
            assert!(estimate <= target && (estimate > 0.6 * target || summary.samples == 32), "{name}: {estimate}");
            assert!(truth < 1.5 * target && truth > 0.5 * estimate, "{name}: {truth} where {target} was asked for");
        }
    }
}

#[test]
fn the_summary_says_what_ended_it() {
    let scene = diffuse();
    let desc = RenderDesc { resolution: [32, 32], samples: 48, ..RenderDesc::default() };
    let endless = RenderDesc { samples: MOST_SAMPLES, ..desc.clone() };
    let soon = Some(Duration::from_millis(80));
    let settings = |desc: &RenderDesc, time_limit, target_error| RenderSettings {
        desc: desc.clone(),
        threads: 2,
        time_limit,
        target_error,
        ..RenderSettings::default()
    };

    let (_, summary) = run(&scene, settings(&desc, None, None));
    assert_eq!((summary.ended, summary.samples), (Ended::Samples, 48));
    let (_, summary) = run(&scene, settings(&desc, None, Some(1e-9)));
    assert_eq!((summary.ended, summary.samples), (Ended::Samples, 48));
    let (_, summary) = run(&scene, settings(&endless, soon, None));
    assert!(summary.ended == Ended::Time && summary.samples >= 1);
    // A quarter at most is left to the estimates of errors.
    assert!(summary.elapsed >= Duration::from_millis(60), "{:?}", summary.elapsed);
    let (_, summary) = run(&scene, settings(&endless, soon, Some(1e-9)));
    assert_eq!(summary.ended, Ended::Time);
    let (_, summary) = run(&scene, settings(&endless, Some(Duration::from_secs(3600)), Some(0.5)));
    assert_eq!(summary.ended, Ended::Error);
    // However short the time, an image has a sample everywhere.
    let (image, summary) = run(&scene, settings(&endless, Some(Duration::ZERO), None));
    assert_eq!((summary.ended, summary.samples), (Ended::Time, 1));
    assert!(image.layer("samples").unwrap().data.iter().all(|&count| count >= 1.0));
    assert!(summary.notes.iter().any(|note| note.contains("first sample")), "{:?}", summary.notes);

    let mut render = Render::new(&scene, settings(&endless, None, None)).unwrap();
    let summary = render.run(&mut |_| ControlFlow::Break(())).unwrap();
    assert!(summary.ended == Ended::Cancelled && summary.stopped);
    // One that has ended ends at once, and for the same reason.
    let mut render = Render::new(&scene, settings(&endless, None, Some(0.2))).unwrap();
    for _ in 0..2 {
        let summary = render.run(&mut |_| ControlFlow::Continue(())).unwrap();
        assert_eq!(summary.ended, Ended::Error);
    }
}

#[test]
fn an_image_without_light_is_not_waited_for() {
    let mut desc = scene(camera(DVec3::ZERO, DVec3::NEG_Z, 80.0), Vec::new());
    desc.lights.clear();
    let scene = Scene::build(&desc, &BuildOptions::default()).unwrap();
    let desc = RenderDesc { resolution: [8, 8], samples: 100, ..RenderDesc::default() };
    let (_, summary) = run(&scene, RenderSettings { desc, target_error: Some(0.5), ..RenderSettings::default() });
    // There is none to estimate, and none to wait for.
    assert_eq!((summary.ended, summary.rel_mse, summary.samples), (Ended::Error, None, 32));
}

#[test]
fn targets_that_are_none_are_refused() {
    let scene = diffuse();
    for target in [0.0, -0.1, f64::NAN, f64::INFINITY] {
        let settings = RenderSettings { target_error: Some(target), ..RenderSettings::default() };
        let error = Render::new(&scene, settings).err().expect("no target");
        assert_eq!((error.kind(), error.location().json_path.as_str()), (ErrorKind::InvalidScene, "targetError"));
    }
}

/// A lamp and a ball with these keys, of a diffuse material with these keys, seen by a camera with these keys.
fn ball(camera: &str, material: &str, surface: &str) -> SceneDesc {
    let text = format!(
        r#"{{"etendue": 1, "camera": {{"origin": [0, 0, 5], "shutter": {{"open": 0, "close": 1}}{camera}}},
            "lights": [{{"type": "point", "origin": [0, 3, 3], "color": [9, 9, 9]}}],
            "materials": [{{"name": "m", {material}}}],
            "surfaces": [{{"geometry": "sphere", "material": "m", "origin": [0, 0, 0], "radius": 1{surface}}}]}}"#
    );
    desc::parse(&text, Path::new(""), None).unwrap()
}

const WHITE: &str = r#""type": "diffuse", "color": [0.8, 0.8, 0.8]"#;

fn shared() -> RenderDesc {
    RenderDesc { resolution: [16, 16], samples: 4, reuse: Some(true), ..RenderDesc::default() }
}

/// Asserts that hits are not shared among pixels, for this reason.
fn assert_shares_nothing<T>(made: etendue::Result<T>, why: &str) {
    let error = made.err().unwrap_or_else(|| panic!("it was taken; expected: {why}"));
    assert_eq!(error.kind(), ErrorKind::Unsupported, "{error}");
    let expected = format!("render.integrator.reuse is true, and {why}");
    assert!(error.message().starts_with(&expected), "'{expected}' is not the beginning of: {error}");
}

#[test]
fn settings_and_places_that_share_no_hits_are_refused_by_name() {
    let scene = diffuse();
    let made = |settings: RenderSettings| Render::new(&scene, RenderSettings { threads: 1, ..settings });
    let with = |desc: RenderDesc| RenderSettings { desc, ..RenderSettings::default() };
    for integrator in IntegratorDesc::ALL {
        let made = made(with(RenderDesc { integrator, ..shared() }));
        if integrator == IntegratorDesc::Path {
            assert!(made.is_ok());
        } else {
            assert_shares_nothing(made, &format!("{} shares no hits among pixels", integrator.name()));
        }
    }
    let spectral = RenderDesc { spectral: true, ..shared() };
    assert_shares_nothing(made(with(spectral)), "render.spectral gives each path wavelengths of its own");
    let adaptive = RenderSettings { adaptive: Some(true), ..with(shared()) };
    assert_shares_nothing(made(adaptive), "adaptive sampling gives neighbouring pixels different numbers of samples");

    let probe = Probe { position: DVec3::ZERO, direction: DVec3::Y };
    let lux = Render::probes(&scene, with(shared()), &[probe], ProbeQuantity::Irradiance);
    assert_shares_nothing(lux, "light at given points has no neighbouring pixels");
}

/// Where nobody asked for adaptive samples, a target error does without them.
#[test]
fn pixels_that_share_hits_have_the_same_number_of_samples_for_a_target() {
    let settings = RenderSettings {
        desc: RenderDesc { samples: 1024, ..shared() },
        target_error: Some(0.5),
        threads: 1,
        ..RenderSettings::default()
    };
    let (image, summary) = run(&diffuse(), settings.clone());
    assert!(summary.ended == Ended::Error && summary.reuse && !summary.adaptive, "{:?}", summary.notes);
    let counts = &image.layer("samples").unwrap().data;
    assert!(counts.iter().all(|count| *count == counts[0]));
    let alone = RenderDesc { reuse: Some(false), ..settings.desc.clone() };
    let (_, summary) = run(&diffuse(), RenderSettings { desc: alone, ..settings });
    assert!(summary.adaptive && !summary.reuse);
}

/// Whether pixels share hits, if a render is stopped after its first pass.
fn shares_hits(scene: &Scene, settings: RenderSettings) -> bool {
    let is_asked_for = settings.desc.reuse.is_some();
    let mut render = Render::new(scene, settings).unwrap();
    let mut stop = |report: &Progress| match report.samples_done {
        0 => ControlFlow::Continue(()),
        _ => ControlFlow::Break(()),
    };
    let summary = render.run(&mut stop).unwrap();
    let note =
        summary.notes.iter().any(|note| note.starts_with("pixels shared hits: a pilot expected the same error in "));
    assert!(note == (summary.reuse && !is_asked_for), "{:?}", summary.notes);
    summary.reuse
}

/// By themselves, pixels share hits where a pilot says so, in long renders in which they can.
#[test]
fn a_pilot_says_whether_pixels_share_hits() {
    let with = |desc: RenderDesc| RenderSettings { desc, threads: 1, ..RenderSettings::default() };
    let long = RenderDesc { resolution: [64, 64], samples: 1000, ..RenderDesc::default() };
    let diffuse = diffuse();
    let shares = |desc: RenderDesc| shares_hits(&diffuse, with(desc));
    assert!(shares(long.clone()));
    // The seed of the render, its threads and a part of the picture change nothing.
    let crop = Some(CropDesc { left: 7, top: 9, width: 3, height: 5 });
    assert!(shares(RenderDesc { crop, seed: 5, ..long.clone() }));
    assert!(shares_hits(&diffuse, RenderSettings { threads: 2, ..with(long.clone()) }));
    assert!(shares(RenderDesc { integrator: IntegratorDesc::Auto, ..long.clone() }));

    // Where the noise is that of the lens and of direct light, sharing brings nothing.
    let desc = desc::load(&Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes/depth-of-field.json"), None).unwrap();
    let lens = Scene::build(&desc, &BuildOptions::default()).unwrap();
    assert!(!shares_hits(&lens, with(long.clone())));

    assert!(!shares(RenderDesc { reuse: Some(false), ..long.clone() }));
    // A small pilot says so of shorter renders.
    let short = RenderDesc { samples: 190, ..long.clone() };
    assert!(shares(short.clone()) && !shares_hits(&lens, with(short)));
    assert!(!shares(RenderDesc { samples: 170, ..long.clone() }));
    assert!(!shares(RenderDesc { resolution: [20, 200], ..long.clone() }));
    for integrator in [IntegratorDesc::Whitted, IntegratorDesc::Direct, IntegratorDesc::Sppm] {
        assert!(!shares(RenderDesc { integrator, ..long.clone() }), "{}", integrator.name());
    }
    assert!(!shares(RenderDesc { spectral: true, ..long.clone() }));
    let others = |settings: RenderSettings| shares_hits(&diffuse, settings);
    assert!(!others(RenderSettings { adaptive: Some(true), ..with(long.clone()) }));
    assert!(!others(RenderSettings { target_error: Some(0.1), ..with(long.clone()) }));
    assert!(others(RenderSettings { target_error: Some(0.1), adaptive: Some(false), ..with(long.clone()) }));
    let limited = |seconds| RenderSettings { time_limit: Some(Duration::from_secs(seconds)), ..with(long.clone()) };
    assert!(!others(limited(2)) && others(limited(4)) && others(limited(60)));
}

/// A render that is stopped in its pilot makes the pilot again, and comes to the same picture.
#[test]
fn a_pilot_that_was_stopped_is_made_again() {
    let scene = diffuse();
    // Long enough for a report before it is done, also of a small one whose squares are all begun at once.
    for (samples, shadow_rays, threads) in [(MOST_SAMPLES, 8, 1), (130, 64, 12)] {
        stopped_and_made_again(&scene, samples, shadow_rays, threads);
    }
}

fn stopped_and_made_again(scene: &Scene, samples: u32, shadow_rays: u32, threads: usize) {
    let desc = RenderDesc { resolution: [80, 80], samples, shadow_rays, ..RenderDesc::default() };
    let settings = RenderSettings { desc, threads, ..RenderSettings::default() };
    let one_pass = |render: &mut Render| {
        let mut stop = |report: &Progress| match report.samples_done {
            0 => ControlFlow::Continue(()),
            _ => ControlFlow::Break(()),
        };
        assert!(render.run(&mut stop).unwrap().reuse);
        render.image().rgb
    };
    let mut stopped = Render::new(scene, settings.clone()).unwrap();
    let summary = stopped.run(&mut |_| ControlFlow::Break(())).unwrap();
    assert!(summary.ended == Ended::Cancelled && !summary.reuse && summary.samples == 0, "{summary:?}");
    assert_eq!(one_pass(&mut stopped), one_pass(&mut Render::new(scene, settings).unwrap()));
}

#[test]
fn scenes_whose_paths_share_no_hits_are_refused_by_name() {
    let made = |desc: &SceneDesc| {
        let scene = Scene::build(desc, &BuildOptions::default()).unwrap();
        Render::new(&scene, RenderSettings { desc: shared(), threads: 1, ..RenderSettings::default() })
    };
    let way = r#", "motion": [{"time": 0}, {"time": 1, "translate": [0.5, 0, 0]}]"#;
    for moving in [ball("", WHITE, way), ball(way, WHITE, "")] {
        assert_shares_nothing(made(&moving), "something moves while the shutter is open");
        let mut still = moving;
        still.set_shutter(ShutterDesc::at(0.25)).unwrap();
        assert!(made(&still).is_ok());
    }
    let veil = ball("", &format!("{WHITE}, \"opacity\": 0.5"), "");
    assert_shares_nothing(made(&veil), "surfaces of the scene are not opaque");
    let glass = r#""type": "refractive", "refractionIndex": 1.5"#;
    for media in [r#""absorption": [1, 1, 1]"#, r#""priority": 1"#] {
        let made = made(&ball("", &format!("{glass}, {media}"), ""));
        assert_shares_nothing(made, "media of the scene absorb light or have priorities");
    }
    for plain in [WHITE, glass] {
        assert!(made(&ball("", plain, "")).is_ok());
    }
}

fn lit() -> RenderDesc {
    RenderDesc { reuse: None, light_paths: Some(true), ..shared() }
}

/// Asserts that no light paths are traced, for this reason.
fn assert_traces_none<T>(made: etendue::Result<T>, why: &str) {
    let error = made.err().unwrap_or_else(|| panic!("it was taken; expected: {why}"));
    assert_eq!(error.kind(), ErrorKind::Unsupported, "{error}");
    let expected = format!("render.integrator.lightPaths is true, and {why}");
    assert!(error.message().starts_with(&expected), "'{expected}' is not the beginning of: {error}");
}

#[test]
fn what_has_no_light_paths_is_refused_by_name() {
    let scene = diffuse();
    let made = |scene: &Scene, settings: RenderSettings| Render::new(scene, RenderSettings { threads: 1, ..settings });
    let with = |desc: RenderDesc| RenderSettings { desc, ..RenderSettings::default() };
    for integrator in IntegratorDesc::ALL {
        let made = made(&scene, with(RenderDesc { integrator, ..lit() }));
        if integrator == IntegratorDesc::Path {
            assert!(made.is_ok());
        } else {
            assert_traces_none(made, &format!("{} traces none to the camera", integrator.name()));
        }
    }
    let mitchell = FilterDesc::Mitchell { b: 0.3, c: 0.3 };
    for (desc, why) in [
        (RenderDesc { spectral: true, ..lit() }, "render.spectral gives each path wavelengths of its own"),
        (RenderDesc { max_depth: Some(9), ..lit() }, "render.maxDepth cuts paths"),
        (RenderDesc { filter: mitchell, ..lit() }, "the filter mitchell divides by the weights"),
        (
            RenderDesc { filter: FilterDesc::Gaussian { sigma: 1.5 }, ..lit() },
            "the filter reaches farther than 4 pixels",
        ),
        (RenderDesc { sampler: SamplerDesc::Gaussian, ..lit() }, "the sampler gaussian is a pixel filter"),
    ] {
        assert_traces_none(made(&scene, with(desc)), why);
    }
    let adaptive = RenderSettings { adaptive: Some(true), ..with(lit()) };
    assert_traces_none(made(&scene, adaptive), "adaptive sampling gives pixels different numbers of samples");
    let probe = Probe { position: DVec3::ZERO, direction: DVec3::Y };
    let lux = Render::probes(&scene, with(lit()), &[probe], ProbeQuantity::Irradiance);
    assert_traces_none(lux, "light at given points has no camera");
    let of = |desc: &SceneDesc| made(&Scene::build(desc, &BuildOptions::default()).unwrap(), with(lit()));
    let way = r#", "motion": [{"time": 0}, {"time": 1, "translate": [0.5, 0, 0]}]"#;
    let glass = r#""type": "refractive", "refractionIndex": 1.5"#;
    assert_traces_none(of(&ball("", WHITE, way)), "something moves while the shutter is open");
    assert_traces_none(
        of(&ball("", &format!("{WHITE}, \"opacity\": 0.5"), "")),
        "surfaces of the scene are not opaque",
    );
    assert_traces_none(of(&ball("", &format!("{glass}, \"priority\": 1"), "")), "media of the scene absorb light");
    let text = r#"{"etendue": 1, "camera": {"origin": [0, 0, 5]},
        "textures": [{"name": "bricks", "type": "image", "file": "textures/bricks.png", "filter": "mip"}],
        "materials": [{"name": "wall", "type": "diffuse", "color": [1, 1, 1], "textures": {"color": "bricks"}}],
        "surfaces": [{"geometry": "sphere", "material": "wall", "origin": [0, 0, 0], "radius": 1}]}"#;
    let filtered = desc::parse(text, &Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes"), None).unwrap();
    assert_traces_none(of(&filtered), "textures are filtered by what a path's own rays see");
    let lens = desc::load(&Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes/depth-of-field.json"), None).unwrap();
    assert_traces_none(of(&lens), "the camera does not see in perspective through a pinhole");
    assert!(of(&ball("", glass, "")).is_ok());
}

#[test]
fn light_samples_of_first_hits_are_those_of_paths() {
    let scene = diffuse();
    let asked = RenderDesc { first_shadow_rays: Some(4), ..RenderDesc::default() };
    let refused = "render.integrator.firstShadowRays is given, and ";
    let made = |desc: RenderDesc| {
        Render::new(&scene, RenderSettings { desc, threads: 1, adaptive: Some(true), ..RenderSettings::default() })
    };
    for integrator in IntegratorDesc::ALL {
        let made = made(RenderDesc { integrator, ..asked.clone() });
        if integrator == IntegratorDesc::Path {
            assert!(made.is_ok());
        } else {
            let error = made.err().expect("it has none");
            assert_eq!(error.kind(), ErrorKind::Unsupported);
            assert!(error.message().starts_with(&format!("{refused}{} has no", integrator.name())), "{error}");
        }
    }
    for count in [0, 1025] {
        let error = made(RenderDesc { first_shadow_rays: Some(count), ..asked.clone() }).err().expect("out of range");
        assert_eq!(
            (error.kind(), error.location().json_path.as_str()),
            (ErrorKind::InvalidScene, "render.integrator.firstShadowRays")
        );
    }
    let probe = Probe { position: DVec3::ZERO, direction: DVec3::Y };
    let settings = RenderSettings { desc: asked, threads: 1, ..RenderSettings::default() };
    let error = Render::probes(&scene, settings, &[probe], ProbeQuantity::Irradiance).err().expect("no picture");
    assert!(error.message().starts_with(&format!("{refused}light at given points has no")), "{error}");
}

/// By themselves, more light samples are taken where a pilot says so that is made for shared hits or light paths, and as many for each part
/// of a picture.
#[test]
fn a_pilot_says_how_many_light_samples_first_hits_have() {
    let long = RenderDesc { resolution: [64, 64], samples: 1000, ..RenderDesc::default() };
    let taken = |name: &str, desc: RenderDesc| {
        let scene = desc::load(&Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes").join(name), None).unwrap();
        let scene = Scene::build(&scene, &BuildOptions::default()).unwrap();
        let mut stop = |report: &Progress| match report.samples_done {
            0 => ControlFlow::Continue(()),
            _ => ControlFlow::Break(()),
        };
        let is_open = desc.first_shadow_rays.is_none();
        let settings = RenderSettings { desc, threads: 2, ..RenderSettings::default() };
        let mut render = Render::new(&scene, settings.clone()).unwrap();
        let summary = render.run(&mut stop).unwrap();
        // A render that goes on asks no pilot again.
        let mut more = Render::resume(&scene, settings, render.checkpoint().unwrap()).unwrap();
        let continued = more.run(&mut |_| ControlFlow::Break(())).unwrap();
        assert_eq!(continued.first_shadow_rays, summary.first_shadow_rays);
        assert!(!continued.notes.iter().any(|it| it.contains("pilot")), "{:?}", continued.notes);
        let note = format!("what the camera sees had {} light samples for each path", summary.first_shadow_rays);
        let is_noted = summary.notes.iter().any(|it| it.starts_with(&note));
        assert_eq!(is_noted, is_open && summary.first_shadow_rays > 1, "{:?}", summary.notes);
        summary.first_shadow_rays
    };
    let lamps = taken("smooth-mesh.json", long.clone());
    assert!(lamps > 1, "{lamps}");
    let crop = Some(CropDesc { left: 7, top: 9, width: 3, height: 5 });
    assert_eq!(taken("smooth-mesh.json", RenderDesc { crop, seed: 5, ..long.clone() }), lamps);
    assert!(taken("smooth-mesh.json", RenderDesc { reuse: Some(true), ..long.clone() }) > 1);
    assert!(taken("smooth-mesh.json", RenderDesc { samples: 190, ..long.clone() }) > 1);
    for other in [
        RenderDesc { first_shadow_rays: Some(1), ..long.clone() },
        RenderDesc { samples: 170, ..long.clone() },
        RenderDesc { spectral: true, ..long.clone() },
        RenderDesc { reuse: Some(false), light_paths: Some(false), ..long.clone() },
        RenderDesc { integrator: IntegratorDesc::Direct, ..long.clone() },
    ] {
        assert_eq!(taken("smooth-mesh.json", other), 1);
    }
    assert_eq!(taken("smooth-mesh.json", RenderDesc { first_shadow_rays: Some(7), ..long.clone() }), 7);
    assert_eq!(taken("depth-of-field.json", long), 1);
}

/// By themselves, light paths are traced where a pilot says so, in long renders in which they can be.
#[test]
fn a_pilot_says_whether_light_paths_are_traced() {
    let scene = |name: &str| {
        let desc = desc::load(&Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes").join(name), None).unwrap();
        Scene::build(&desc, &BuildOptions::default()).unwrap()
    };
    let long = RenderDesc { resolution: [64, 64], samples: 1000, ..RenderDesc::default() };
    let traces = |scene: &Scene, desc: RenderDesc| {
        let mut stop = |report: &Progress| match report.samples_done {
            0 => ControlFlow::Continue(()),
            _ => ControlFlow::Break(()),
        };
        let settings = RenderSettings { desc: desc.clone(), threads: 1, ..RenderSettings::default() };
        let summary = Render::new(scene, settings).unwrap().run(&mut stop).unwrap();
        let note = summary.notes.iter().any(|note| note.starts_with("light paths found caustics: a pilot expected"));
        assert!(note == (summary.light_paths && desc.light_paths.is_none()), "{:?}", summary.notes);
        summary.light_paths
    };
    let caustic = scene("caustic.json");
    assert!(traces(&caustic, long.clone()));
    // The seed of the render and a part of the picture change nothing.
    let crop = Some(CropDesc { left: 7, top: 9, width: 3, height: 5 });
    assert!(traces(&caustic, RenderDesc { crop, seed: 5, reuse: Some(true), ..long.clone() }));
    assert!(traces(&caustic, RenderDesc { samples: 190, ..long.clone() }));
    for other in [
        RenderDesc { light_paths: Some(false), ..long.clone() },
        RenderDesc { samples: 170, ..long.clone() },
        RenderDesc { spectral: true, ..long.clone() },
        RenderDesc { integrator: IntegratorDesc::Sppm, ..long.clone() },
    ] {
        assert!(!traces(&caustic, other));
    }
    // No caustics, and no lamp that light paths start from.
    assert!(!traces(&scene("cornell.json"), long.clone()) && !traces(&scene("room.json"), long));
}

/// Where a bias is allowed, the picture is that of the irradiance cache where its whole error is least for the time: of few samples, but not of
/// many, and not where there is little indirect light.
#[test]
fn a_pilot_says_whether_the_irradiance_cache_is_taken() {
    let scene = |name: &str| {
        let desc = desc::load(&Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes").join(name), None).unwrap();
        Scene::build(&desc, &BuildOptions::default()).unwrap()
    };
    let auto = RenderDesc {
        integrator: IntegratorDesc::Auto,
        allow_bias: true,
        resolution: [256, 256],
        samples: 64,
        ..RenderDesc::default()
    };
    let mut stop = |report: &Progress| match report.samples_done {
        0 => ControlFlow::Continue(()),
        _ => ControlFlow::Break(()),
    };
    let settings = |desc: &RenderDesc| RenderSettings { desc: desc.clone(), threads: 2, ..RenderSettings::default() };
    let mut begun = |scene: &Scene, settings: RenderSettings| {
        let mut render = Render::new(scene, settings).unwrap();
        let notes = render.run(&mut stop).unwrap().notes;
        (render, notes.join("\n"))
    };
    let bits = |render: &Render| render.image().rgb.iter().map(|it| it.to_bits()).collect::<Vec<_>>();
    let box_of_walls = scene("cornell.json");
    let (render, notes) = begun(&box_of_walls, settings(&auto));
    assert!(notes.contains("auto chose irradiance_cache: a pilot expected the same error in"), "{notes}");
    assert!(!notes.contains("pixels shared hits") && notes.contains("irradiance cache: "), "{notes}");
    let cache = RenderDesc { integrator: IntegratorDesc::IrradianceCache, allow_bias: false, ..auto.clone() };
    assert!(bits(&render) == bits(&begun(&box_of_walls, settings(&cache)).0));
    // A render that goes on asks no pilot again, also where none would be made, and takes the same samples.
    let hurried = RenderSettings { time_limit: Some(Duration::from_secs(2)), ..settings(&auto) };
    let mut more = Render::resume(&box_of_walls, hurried, render.checkpoint().unwrap()).unwrap();
    let notes = more.run(&mut |_| ControlFlow::Break(())).unwrap().notes.join("\n");
    assert!(notes.contains("auto chose irradiance_cache: the part of the render before chose so, and"), "{notes}");
    let refused = Render::resume(
        &box_of_walls,
        settings(&RenderDesc { allow_bias: false, ..auto.clone() }),
        render.checkpoint().unwrap(),
    );
    assert_eq!(refused.err().map(|error| error.kind()), Some(ErrorKind::Unsupported));
    // Of 1000 samples the bias would be most of the error.
    let long = RenderDesc { resolution: [64, 64], samples: 1000, ..auto.clone() };
    let (render, notes) = begun(&box_of_walls, settings(&long));
    let is_worse = notes.contains("times the error that paths have after so many samples");
    assert!(notes.contains("auto chose path: ") && is_worse, "{notes}");
    let unbiased = begun(&box_of_walls, settings(&RenderDesc { allow_bias: false, ..long.clone() }));
    assert!(bits(&render) == bits(&unbiased.0));
    assert!(
        unbiased.1.contains("no pilot compared the irradiance cache with paths: auto allows no bias"),
        "{}",
        unbiased.1
    );
    let error = RenderSettings { target_error: Some(1e-3), adaptive: Some(false), ..settings(&auto) };
    let (_, notes) = begun(&box_of_walls, error);
    assert!(notes.contains("no pilot compared the irradiance cache with paths: an error ends the render"), "{notes}");
    // A small pilot compares no cache, and there is nothing to allow.
    let short = RenderDesc { samples: 190, allow_bias: false, ..long.clone() };
    let (_, notes) = begun(&box_of_walls, settings(&short));
    assert!(notes.contains("pixels shared hits") && !notes.contains("no pilot compared"), "{notes}");
    let (_, notes) = begun(&scene("soft-shadows.json"), settings(&long));
    assert!(notes.contains("the irradiance cache would gain too little"), "{notes}");
}

#[test]
fn only_auto_has_a_bias_to_allow() {
    let scene = diffuse();
    let refused = "render.integrator.bias is allowed, and ";
    for integrator in IntegratorDesc::ALL {
        let desc = RenderDesc { integrator, allow_bias: true, ..RenderDesc::default() };
        match Render::new(&scene, RenderSettings { desc, threads: 1, ..RenderSettings::default() }) {
            Ok(_) => assert_eq!(integrator, IntegratorDesc::Auto),
            Err(error) => {
                assert_eq!(error.kind(), ErrorKind::Unsupported);
                let why = format!("{refused}{} chooses no other integrator; expected refused", integrator.name());
                assert!(error.message().starts_with(&why), "{error}");
            }
        }
    }
    let desc = RenderDesc { integrator: IntegratorDesc::Auto, allow_bias: true, ..RenderDesc::default() };
    let probe = Probe { position: DVec3::ZERO, direction: DVec3::Y };
    let settings = RenderSettings { desc, threads: 1, ..RenderSettings::default() };
    let error = Render::probes(&scene, settings, &[probe], ProbeQuantity::Irradiance).err().expect("no picture");
    assert!(error.message().starts_with(&format!("{refused}light at given points has no pilot")), "{error}");
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::with_cases(24) })]

    /// Over any limits, any workers and any number of stops, on a small image and a large one.
    #[test]
    fn the_report_only_goes_forward(
        side in prop::sample::select(vec![1_u32, 5, 40]),
        samples in 1_u32..400,
        milliseconds in prop::option::of(1_u64..60),
        target in prop::option::of(0.02_f64..0.5),
        here in any::<bool>(),
        stops in prop::collection::vec(1_u32..6, 0..4),
    ) {
        let scene = diffuse();
        let workers = Some(if here { Workers::calling_thread() } else { Workers::pool(2).unwrap() });
        let settings = RenderSettings {
            desc: RenderDesc { resolution: [side, side], samples, shadow_rays: 4, ..RenderDesc::default() },
            time_limit: milliseconds.map(Duration::from_millis),
            target_error: target,
            workers,
            ..RenderSettings::default()
        };
        let mut render = Render::new(&scene, settings).unwrap();
        for stop_at in stops.into_iter().map(Some).chain([None]) {
            let mut last = (0.0, 0, 0, Duration::ZERO);
            let mut reports = 0;
            // A cancel in the middle of a pass leaves it unfinished for the next run.
            let cancel = Cancel::new();
            render.set_cancel(cancel.clone());
            let summary = render.run(&mut |progress| {
                let now = (progress.fraction, progress.samples_done, progress.rays, progress.elapsed);
                assert!((0.0..=1.0).contains(&now.0), "{now:?}");
                assert!(now.0 >= last.0 && now.1 >= last.1 && now.2 >= last.2 && now.3 >= last.3, "{last:?}, {now:?}");
                assert!(progress.samples_total == samples && now.1 <= samples);
                last = now;
                reports += 1;
                match stop_at {
                    Some(report) if reports >= report => {
                        cancel.cancel();
                        ControlFlow::Break(())
                    }
                    _ => ControlFlow::Continue(()),
                }
            }).unwrap();
            prop_assert!(summary.samples >= last.1);
            if summary.ended == Ended::Samples && reports > 0 {
                prop_assert_eq!((summary.samples, last.0), (samples, 1.0));
            }
        }
    }
}
