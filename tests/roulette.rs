//! Russian roulette: renders use the library's own unless they ask for the survival probabilities that the scene's materials
//! state. The choice changes noise only, and the library's own has less of it.

mod common;

use std::f64::consts::FRAC_1_PI;
use std::path::{Path, PathBuf};

use common::scenes::render_scene;
use etendue::desc::{self, Dialect, IntegratorDesc, RenderDesc, RouletteDesc, SceneDesc};
use etendue::film::Image;
use etendue::scene::{BuildOptions, Scene};

fn parse(json: &str) -> SceneDesc {
    desc::parse(json, Path::new("."), None).unwrap_or_else(|error| panic!("{error}"))
}

fn build(desc: &SceneDesc) -> Scene {
    Scene::build(desc, &BuildOptions::default()).expect("a scene of the test")
}

/// A closed ball of albedo 0.97 around the camera and a point light, as a file of the report's renderer.
fn ball() -> SceneDesc {
    let scene = parse(
        r#"{
          "camera": {"origin": [0, 0, 0], "lookAt": [1, 0, 0], "up": [0, 0.1, 0], "fieldOfView": 90},
          "lights": [{"type": "point", "origin": [0, 0, 0], "color": [1, 1, 1], "intensity": 1}],
          "materials": [{"name": "white", "type": "diffuse", "color": [0.97, 0.97, 0.97], "reflectionRate": 0.75}],
          "surfaces": [{"geometry": "sphere", "origin": [0, 0, 0], "radius": 1, "material": "white"}]
        }"#,
    );
    assert_eq!((scene.dialect, scene.materials[0].survival), (Dialect::Mcrt, Some(0.75)));
    scene
}

/// Radiance in the ball: the light's irradiance 1, reflected any number of times.
const BALL_RADIANCE: f64 = 0.97 * FRAC_1_PI / (1.0 - 0.97);

/// Samples of each picture of the ball, of 4 x 4 pixels.
const BALL_SAMPLES: u32 = 1024;

fn ball_settings(roulette: RouletteDesc, seed: u64) -> RenderDesc {
    let samples = BALL_SAMPLES / 16;
    RenderDesc { resolution: [4, 4], samples, seed, roulette, ..RenderDesc::default() }
}

/// Mean of some numbers and its standard error.
fn mean_and_error(values: &[f64]) -> (f64, f64) {
    let count = values.len() as f64;
    let mean = values.iter().sum::<f64>() / count;
    let squares = values.iter().map(|value| (value - mean).powi(2)).sum::<f64>();
    (mean, (squares / (count - 1.0) / count).sqrt())
}

#[test]
fn a_bright_closed_ball_has_finite_variance_unless_the_files_roulette_is_asked_for() {
    let scene = build(&ball());
    // Of one picture of 1024 samples: the standard error is the standard deviation over pictures.
    let measure = |roulette| {
        let picture = |seed| render_scene(&scene, ball_settings(roulette, seed)).0.mean()[0];
        let means: Vec<f64> = (0..32).map(picture).collect();
        let (mean, error) = mean_and_error(&means);
        (means, mean, error)
    };
    let (means, own, own_error) = measure(RouletteDesc::Own);
    let (_, file, file_error) = measure(RouletteDesc::File);
    let deviation = own_error * (means.len() as f64).sqrt();
    println!(
        "own {own:.4} ± {own_error:.4}, {deviation:.4} for one picture; file {file:.4} ± {file_error:.4}; exact {BALL_RADIANCE:.4}"
    );
    assert!((own - BALL_RADIANCE).abs() < 3.0 * own_error, "{own} ± {own_error}, expected {BALL_RADIANCE}");
    for (seed, mean) in means.iter().enumerate().take(4) {
        assert!((mean - BALL_RADIANCE).abs() < 3.0 * deviation, "seed {seed}: {mean} ± {deviation}");
    }
    assert!(deviation < 0.02 * BALL_RADIANCE, "{deviation} of {BALL_RADIANCE}");
    // Heavy tails: whatever the sample variance of the file's roulette is, the true one is larger.
    assert!(file_error > 5.0 * own_error, "file {file_error}, own {own_error}");
}

#[test]
fn a_file_of_the_report_renders_as_its_native_form_does() {
    let report = ball();
    let native = parse(
        r#"{
          "etendue": 1,
          "camera": {"type": "view-plane", "origin": [0, 0, 0], "lookAt": [1, 0, 0], "up": [0, 0.1, 0], "fieldOfView": 90},
          "lights": [{"type": "point", "origin": [0, 0, 0], "color": [1, 1, 1]}],
          "materials": [{"name": "white", "type": "diffuse", "color": [0.97, 0.97, 0.97]}],
          "surfaces": [{"geometry": "sphere", "origin": [0, 0, 0], "radius": 1, "material": "white"}]
        }"#,
    );
    let mut stating = native.clone();
    stating.materials[0].survival = Some(0.75);
    for integrator in [IntegratorDesc::Path, IntegratorDesc::Photon, IntegratorDesc::IrradianceCache] {
        let image = |desc: &SceneDesc, roulette| {
            let mut settings = ball_settings(roulette, 7);
            settings.integrator = integrator;
            settings.photons.count = Some(1000);
            render_scene(&build(desc), settings).0.rgb
        };
        let expected = image(&native, RouletteDesc::Own);
        assert_eq!(
            image(&report, RouletteDesc::Own),
            expected,
            "{integrator:?}: the own roulette is the default of every file"
        );
        assert_eq!(image(&stating, RouletteDesc::Own), expected, "{integrator:?}: of native ones too");
        assert_eq!(image(&native, RouletteDesc::File), expected, "{integrator:?}: there is nothing to honour");
        let file = image(&report, RouletteDesc::File);
        assert_ne!(file, expected, "{integrator:?}: the switch is honoured");
        assert_eq!(image(&stating, RouletteDesc::File), file, "{integrator:?}: in native files too");
    }
}

#[test]
fn the_settings_of_a_render_decide_and_a_rebuild_follows_its_description() {
    let own = ball();
    let mut file = ball();
    file.render.roulette = RouletteDesc::File;
    let survival = |scene: &Scene| scene.material(0).survival;
    let (with_own, with_file) = (build(&own), build(&file));
    assert_eq!((survival(&with_own), survival(&with_file)), (None, Some(0.75)));

    let image = |scene: &Scene, roulette| render_scene(scene, ball_settings(roulette, 3)).0.rgb;
    for roulette in [RouletteDesc::Own, RouletteDesc::File] {
        assert_eq!(
            image(&with_own, roulette),
            image(&with_file, roulette),
            "{roulette:?}: whatever the scene was built with"
        );
    }
    let rebuilt = with_own.rebuild(&file, &BuildOptions::default()).unwrap();
    assert_eq!(survival(&rebuilt), Some(0.75));
    assert_eq!(survival(&rebuilt.rebuild(&own, &BuildOptions::default()).unwrap()), None);
    assert_eq!(survival(&with_own.with_roulette(RouletteDesc::File)), Some(0.75));

    let words = |scene: &Scene| scene.info().decisions.join("\n");
    assert!(
        words(&with_own).contains("the survival probabilities of 1 materials are not used"),
        "{}",
        words(&with_own)
    );
    assert!(words(&with_file).contains("Russian roulette uses the survival probabilities of 1 materials"));
}

/// relMSE of one picture, by the difference of two with different seeds: its mean over pairs and that mean's standard error.
fn rel_mse(scene: &Scene, settings: &RenderDesc, pairs: u64) -> (f64, f64) {
    let images: Vec<Image> =
        (0..2 * pairs).map(|seed| render_scene(scene, RenderDesc { seed: 100 + seed, ..settings.clone() }).0).collect();
    let values = images[0].rgb.len();
    let mean_of = |i| images.iter().map(|image| f64::from(image.rgb[i])).sum::<f64>() / images.len() as f64;
    let means: Vec<f64> = (0..values).map(mean_of).collect();
    let whole = means.iter().sum::<f64>() / values as f64;
    let of_pair = |pair: &[Image]| {
        let square = |i: usize| 0.5 * (f64::from(pair[0].rgb[i]) - f64::from(pair[1].rgb[i])).powi(2);
        let terms = means.iter().enumerate().map(|(i, mean)| square(i) / (mean.powi(2) + 0.01 * whole.powi(2)));
        terms.sum::<f64>() / values as f64
    };
    mean_and_error(&images.chunks(2).map(of_pair).collect::<Vec<_>>())
}

#[test]
fn the_reports_room_from_its_own_file_has_the_noise_of_the_native_one() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let folder = std::env::var_os("ETENDUE_MCRT_DATA").map_or_else(|| root.join("../shared/data/mcrt"), PathBuf::from);
    let file = folder.join("scene.json");
    if !file.is_file() {
        eprintln!("SKIPPED: no scene.json of the report in {}; set ETENDUE_MCRT_DATA to its folder", folder.display());
        return;
    }
    let report = build(&desc::load(&file, None).unwrap());
    let native = build(&desc::load(&root.join("scenes/room.json"), None).unwrap());
    let with = |roulette| RenderDesc { resolution: [48, 48], samples: 32, roulette, ..RenderDesc::default() };
    let (native, native_error) = rel_mse(&native, &with(RouletteDesc::Own), 8);
    let (own, own_error) = rel_mse(&report, &with(RouletteDesc::Own), 8);
    let (stated, stated_error) = rel_mse(&report, &with(RouletteDesc::File), 8);
    println!(
        "relMSE: native {native:.5} ± {native_error:.5}, report's file {own:.5} ± {own_error:.5}, with its roulette \
         {stated:.5} ± {stated_error:.5}"
    );
    let error = native_error.hypot(own_error);
    assert!((own - native).abs() < 3.0 * error, "{own} and {native} differ by more than three times {error}");
    assert!(error < 0.15 * native, "too much noise to tell: {error} of {native}");
    assert!(stated > 1.5 * own, "with the file's roulette {stated}, with the library's {own}");
}
