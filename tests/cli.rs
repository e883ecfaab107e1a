//! The command line program: exit codes, messages, and the images it leaves.

use std::fs;
use std::path::Path;
use std::process::{Command, Output, Stdio};
use std::time::{Duration, Instant};

#[path = "common/malformed.rs"]
mod malformed;
#[path = "common/program.rs"]
mod program;

use etendue::film::{Image, Placement};
use etendue::output::{self, WriteOptions};
use program::program;
use tempfile::TempDir;

/// What a run gave.
struct Run {
    code: Option<i32>,
    stdout: String,
    stderr: String,
}

impl From<Output> for Run {
    fn from(output: Output) -> Self {
        let text = |bytes| String::from_utf8(bytes).expect("UTF-8");
        Self { code: output.status.code(), stdout: text(output.stdout), stderr: text(output.stderr) }
    }
}

impl Run {
    /// Asserts exit code 2, nothing on standard output, and one line of error that holds `what`.
    fn assert_refused(&self, what: &str) {
        assert_eq!((self.code, self.stdout.as_str()), (Some(2), ""), "{}", self.stderr);
        assert!(self.stderr.starts_with("error: "), "{}", self.stderr);
        assert_eq!(self.stderr.lines().count(), 1, "{}", self.stderr);
        assert!(self.stderr.contains(what), "'{what}' is not in: {}", self.stderr);
    }

    /// Asserts exit code 2 and a message of the grammar that holds `what`.
    fn assert_refused_by_grammar(&self, what: &str) {
        assert_eq!((self.code, self.stdout.as_str()), (Some(2), ""), "{}", self.stderr);
        assert!(self.stderr.contains(what), "'{what}' is not in: {}", self.stderr);
    }

    /// Asserts exit code 0.
    fn assert_done(&self) {
        assert_eq!(self.code, Some(0), "{}", self.stderr);
    }
}

/// Runs the program in `folder`.
fn etendue<S: AsRef<std::ffi::OsStr>>(folder: &Path, args: impl IntoIterator<Item = S>) -> Run {
    command(folder, args).output().expect("the program runs").into()
}

fn command<S: AsRef<std::ffi::OsStr>>(folder: &Path, args: impl IntoIterator<Item = S>) -> Command {
    let mut command = Command::new(program());
    command.current_dir(folder).args(args).stdin(Stdio::null()).stdout(Stdio::piped()).stderr(Stdio::piped());
    command
}

fn folder() -> TempDir {
    tempfile::tempdir().expect("a temporary folder")
}

/// A scene of the repository.
fn scene(name: &str) -> String {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes").join(name);
    path.to_str().expect("a UTF-8 path").to_owned()
}

/// A render command that takes little time, with more arguments.
fn small_render<'a>(scene: &'a str, more: &[&'a str]) -> Vec<&'a str> {
    let mut args = vec!["render", scene, "--resolution", "16x12", "--spp", "4", "--threads", "2"];
    args.extend(more);
    args
}

/// A file of one row of grey pixels.
fn write_grey(path: &Path, values: &[f32]) {
    let rgb = values.iter().flat_map(|&value| [value; 3]).collect();
    let image = Image { width: values.len() as u32, height: 1, rgb, ..Image::default() };
    output::write(&image, path, &WriteOptions::default()).unwrap();
}

fn names(folder: &Path) -> Vec<String> {
    let entries = fs::read_dir(folder).unwrap();
    let mut names: Vec<_> = entries.map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect();
    names.sort();
    names
}

#[test]
fn help_and_version_go_to_standard_output() {
    let folder = folder();
    for (args, expected) in [
        (vec!["--help"], vec!["render", "convert", "info", "photons", "bake", "compare", "bench", "Exit codes"]),
        (vec!["render", "--help"], vec!["--output", "--spp", "--max-depth", "--tone-map", "--progressive", "--time"]),
        (vec!["compare", "--help"], vec!["--json", "reference"]),
        (vec!["--version"], vec![env!("CARGO_PKG_VERSION")]),
    ] {
        let run = etendue(folder.path(), &args);
        run.assert_done();
        assert_eq!(run.stderr, "");
        for word in expected {
            assert!(run.stdout.contains(word), "'{word}' is not in: {}", run.stdout);
        }
    }
}

#[test]
fn a_crop_is_a_part_of_the_picture() {
    let folder = folder();
    let cornell = scene("cornell.json");
    etendue(folder.path(), small_render(&cornell, &["-o", "whole.exr"])).assert_done();
    etendue(folder.path(), small_render(&cornell, &["--crop", "3,2,9x7", "-o", "part.exr"])).assert_done();
    let [whole, part] = ["whole.exr", "part.exr"].map(|name| output::read(&folder.path().join(name)).unwrap());
    let expected: Vec<_> = (2..9).flat_map(|y| (3..12).map(move |x| (x, y))).map(|(x, y)| whole.pixel(x, y)).collect();
    assert_eq!(part.rgb.as_chunks::<3>().0, expected);
    assert_eq!(whole.placement, None);
    assert_eq!(part.placement, Some(Placement { origin: [3, 2], picture: [16, 12], pixel_aspect: 1.0 }));
    let run = etendue(folder.path(), small_render(&cornell, &["--crop", "3,2,14x7", "-o", "part.exr"]));
    run.assert_refused("render.crop[2]: 14 is out of range, expected a whole number from 1 to 13");
}

#[test]
fn info_tells_an_unusual_film() {
    let folder = folder();
    let film = |camera: &str, render: &str| {
        let text = format!("{{\"etendue\": 1, \"camera\": {{{camera}}}, \"render\": {{{render}}}}}");
        fs::write(folder.path().join("s.json"), text).unwrap();
        let run = etendue(folder.path(), ["info", "s.json"]);
        run.assert_done();
        run.stdout.lines().find(|line| line.starts_with("film")).map(str::to_owned)
    };
    assert_eq!(film("", ""), None);
    assert_eq!(
        film("\"shift\": [0, -0.25], \"pixelAspect\": 2", "\"crop\": [3, 4, 5, 6]").as_deref(),
        Some(
            "film            shifted by 0 widths to the right and -0.25 heights upwards; pixel aspect 2; 5 x 6 pixels from \
             (3, 4) of 256 x 256"
        )
    );
}

#[test]
fn bad_usage_has_exit_code_2() {
    let folder = folder();
    let with = |option: &'static str, value: &'static str| vec!["render", "s.json", "-o", "a.png", option, value];
    for args in [
        vec![],
        vec!["paint"],
        vec!["render"],
        vec!["render", "s.json"],
        vec!["info"],
        vec!["convert", "s.json"],
        vec!["convert", "s.glb", "t.json", "--animation", "Walk"],
        vec!["compare", "a.pfm"],
        vec!["render", "s.json", "-o", "a.png", "--fast"],
        with("--spp", "0"),
        with("--spp", "many"),
        with("--threads", "-1"),
        with("--time", "0"),
        with("--time", "nan"),
        with("--time", "1e300"),
        with("--seed", "-1"),
        with("--resolution", "640"),
        with("--resolution", "0x480"),
        with("--resolution", "65536x65536"),
        with("--crop", "0,0"),
        with("--crop", "0,0,4x0"),
        with("--crop", "-1,0,4x4"),
        with("--crop", "0,0,4,4"),
        with("--integrator", "radiosity"),
        with("--filter", "gaussian:0"),
        with("--filter", "mitchell:1"),
        with("--filter", "sinc"),
        with("--sampler", "halton"),
        with("--shadow-rays", "0"),
        with("--roulette", "mine"),
        with("--photons", "0"),
        with("--photons", "536870913"),
        with("--photon-radius", "0"),
        with("--photon-radius", "-1"),
        with("--photon-radius", "nan"),
        with("--photon-radius", "1e30"),
        with("--caustic-photons", "1.5"),
        with("--caustic-radius", "inf"),
        with("--max-depth", "0"),
        with("--tone-map", "pretty"),
        with("--exposure", "65"),
        with("--exposure", "nan"),
    ] {
        let run = etendue(folder.path(), &args);
        assert_eq!((run.code, run.stdout.as_str()), (Some(2), ""), "{args:?}: {}", run.stderr);
        assert!(run.stderr.contains("error: ") || run.stderr.contains("Usage: "), "{args:?}: {}", run.stderr);
        assert!(!run.stderr.contains("panicked"), "{args:?}: {}", run.stderr);
    }
    assert_eq!(names(folder.path()), [""; 0]);
}

#[test]
fn outputs_are_checked_before_anything_else() {
    let folder = folder();
    fs::create_dir(folder.path().join("taken.png")).unwrap();
    // The scene is missing too, and would be the next thing to be said.
    for (path, what) in [
        ("image.jpg", "image.jpg: no image format is known by the extension '.jpg'"),
        ("image", "image: the name has no extension"),
        ("no/where/image.exr", "no/where/image.exr: cannot write the image into its folder"),
        ("taken.png", "taken.png: cannot write the image: the name is taken"),
    ] {
        etendue(folder.path(), ["render", "missing.json", "-o", "good.exr", path]).assert_refused(what);
    }
    etendue(folder.path(), ["render", "missing.json", "-o", "a.png", "-o", "a.png"]).assert_refused("given twice");
    assert_eq!(names(folder.path()), ["taken.png"]);
}

#[test]
fn a_scene_that_cannot_be_used_has_exit_code_2() {
    let folder = folder();
    fs::write(folder.path().join("broken.json"), "{\n  \"etendue\": 1,\n  \"camera\": [\n").unwrap();
    fs::write(folder.path().join("empty.json"), "").unwrap();
    for verb in [&["render", "-o", "a.png", "--"][..], &["info"]] {
        for (scene, what) in [
            ("missing.json", "missing.json: "),
            ("broken.json", "broken.json:"),
            ("empty.json", "empty.json:"),
            (".", "."),
        ] {
            etendue(folder.path(), verb.iter().chain(&[scene])).assert_refused(what);
        }
    }
    assert_eq!(names(folder.path()), ["broken.json", "empty.json"]);
}

#[test]
fn every_malformed_scene_has_exit_code_2_and_leaves_nothing() {
    let folder = folder();
    let list = malformed::malformed();
    assert!(list.len() >= 200, "{} cases", list.len());
    for (name, text, expected) in list {
        let file = folder.path().join("scene.json");
        fs::write(&file, &text).unwrap();
        let run = etendue(folder.path(), ["render", "scene.json", "-o", "a.png"]);
        assert!(!run.stderr.contains("panicked"), "{name}: {}", run.stderr);
        assert_eq!((run.code, run.stdout.as_str()), (Some(2), ""), "{name}: {}", run.stderr);
        // The line of a warning may come first; the error is the last, with file, line and path.
        let error = run.stderr.lines().find(|line| line.starts_with("error: ")).unwrap_or_default();
        let expected = expected.lines().next().unwrap_or_default();
        assert!(error.contains(&format!("scene.json:{expected}")), "{name}: {error} instead of {expected}");
        assert_eq!(names(folder.path()), ["scene.json"], "{name}");
    }
}

#[test]
fn compare_prints_a_table() {
    let folder = folder();
    write_grey(&folder.path().join("a.pfm"), &[0.5, 1.0]);
    write_grey(&folder.path().join("b.pfm"), &[0.5, 0.5]);
    let run = etendue(folder.path(), ["compare", "a.pfm", "b.pfm"]);
    run.assert_done();
    assert_eq!(run.stderr, "");
    for line in [
        "mse             1.250000e-1",
        // 0.25 / (0.25 + 0.01) in one pixel of two.
        "relative mse    4.807692e-1  (epsilon 0.01)",
        // 10 log10(0.25 / 0.125)
        "psnr            3.01 dB",
        "max difference  5.000000e-1  at column 1, row 0",
        "mean of A       0.750000 0.750000 0.750000",
        "mean of B       0.500000 0.500000 0.500000",
        "ratio A / B     1.500000 1.500000 1.500000",
    ] {
        assert!(run.stdout.lines().any(|found| found == line), "'{line}' is not in: {}", run.stdout);
    }
    assert!(run.stdout.contains("\nflip  "), "{}", run.stdout);
    let run = etendue(folder.path(), ["compare", "--no-flip", "a.pfm", "b.pfm"]);
    assert!(!run.stdout.contains("\nflip  "), "{}", run.stdout);
}

#[test]
fn compare_prints_json() {
    let folder = folder();
    write_grey(&folder.path().join("black.pfm"), &[0.0; 64]);
    write_grey(&folder.path().join("white.exr"), &[1.0; 64]);
    write_grey(&folder.path().join("white.png"), &[1.0; 64]);
    let json = |args: &[&str]| -> serde_json::Value {
        let run = etendue(folder.path(), ["compare", "--json"].iter().chain(args));
        run.assert_done();
        serde_json::from_str(&run.stdout).expect("JSON")
    };

    let different = json(&["black.pfm", "white.exr"]);
    assert_eq!(different["mse"], 1.0);
    assert_eq!(different["psnr"], 0.0);
    assert_eq!(different["max_at"], serde_json::json!([0, 0]));
    assert_eq!(different["ratio"], serde_json::json!([0.0, 0.0, 0.0]));
    // FLIP of black and white is the greatest there is.
    assert!(different["flip"].as_f64().unwrap() > 0.9, "{different}");
    // Far below one step of an 8-bit display both are black.
    assert_eq!(json(&["black.pfm", "white.exr", "--exposure", "-20"])["flip"], 0.0);

    let same = json(&["white.png", "white.exr"]);
    assert_eq!((&same["mse"], &same["flip"], &same["psnr"]), (&0.0.into(), &0.0.into(), &serde_json::Value::Null));
    assert_eq!(json(&["white.png", "white.exr", "--no-flip"])["flip"], serde_json::Value::Null);
}

/// Runs the program with so much address space.
#[cfg(target_os = "linux")]
fn etendue_within(kibibytes: u32, folder: &Path, args: &[&str]) -> Run {
    let script = format!("ulimit -v {kibibytes} && exec \"$0\" \"$@\"");
    let mut command = Command::new("sh");
    command.current_dir(folder).args(["-c", &script]).arg(program()).args(args);
    command.stdin(Stdio::null()).output().expect("the program runs").into()
}

#[cfg(target_os = "linux")]
#[test]
fn files_for_which_there_is_no_memory_are_an_error() {
    let folder = folder();
    image::GrayImage::new(8000, 8000).save(folder.path().join("large.png")).unwrap();
    let mesh = "v 0 0 0\nv 1 0 0\nv 0 1 0\n".to_owned() + &"f 1 2 3\n".repeat(400_000);
    fs::write(folder.path().join("large.obj"), mesh).unwrap();
    for (kibibytes, args) in [
        (130_000, &["compare", "--no-flip", "large.png", "large.png"][..]),
        (400_000, &["compare", "--no-flip", "large.png", "large.png"]),
        (130_000, &["info", "large.obj"]),
        (180_000, &["info", "large.obj"]),
    ] {
        let run = etendue_within(kibibytes, folder.path(), args);
        assert_eq!(run.code, Some(1), "{args:?} within {kibibytes} KiB: {}", run.stderr);
        assert!(run.stderr.starts_with(&format!("error: {}: no room for", args.last().unwrap())), "{}", run.stderr);
    }
}

#[test]
fn compare_refuses_what_it_cannot_compare() {
    let folder = folder();
    write_grey(&folder.path().join("two.pfm"), &[0.5, 1.0]);
    write_grey(&folder.path().join("three.pfm"), &[0.5, 1.0, 2.0]);
    fs::write(folder.path().join("noise.exr"), [7; 100]).unwrap();
    let refused = |a: &str, what: &str| etendue(folder.path(), ["compare", a, "two.pfm"]).assert_refused(what);
    refused("three.pfm", "different size cannot be compared: 3 x 1 and 2 x 1");
    refused("missing.pfm", "missing.pfm: cannot read the image");
    refused("noise.exr", "noise.exr: not a readable image");
    refused("two.txt", "two.txt: no image format");
}

#[test]
fn render_writes_every_image_and_a_summary() {
    let folder = folder();
    let cornell = scene("cornell.json");
    let run = etendue(folder.path(), small_render(&cornell, &["-o", "a.exr", "b.pfm", "--output", "c.png"]));
    run.assert_done();
    assert_eq!(run.stdout, "");
    assert_eq!(names(folder.path()), ["a.exr", "b.pfm", "c.png"]);
    let image = |name: &str| output::read(&folder.path().join(name)).unwrap();
    let exr = image("a.exr");
    assert_eq!((exr.width, exr.height), (16, 12));
    assert_eq!(exr.rgb, image("b.pfm").rgb);
    assert!(exr.mean().iter().all(|mean| mean.is_finite() && *mean > 0.0), "{:?}", exr.mean());
    for layer in ["albedo", "normal", "depth"] {
        assert!(exr.layer(layer).is_some(), "{layer}");
    }
    assert_eq!((image("c.png").width, image("c.png").height), (16, 12));

    // Standard error is not a terminal here: a summary, and nothing drawn.
    let summary = run.stderr.lines().last().unwrap();
    for word in ["done in ", "4 samples per pixel", "Mrays/s"] {
        assert!(summary.contains(word), "{}", run.stderr);
    }
    assert!(!run.stderr.contains(['\r', '\u{1b}']), "{:?}", run.stderr);
    if cfg!(target_os = "linux") {
        assert!(summary.contains("peak memory "), "{summary}");
    }

    let metadata = exr::meta::MetaData::read_from_file(folder.path().join("a.exr"), true).unwrap();
    let comments = metadata.headers[0].own_attributes.comments.as_ref().unwrap().to_string();
    assert!(comments.contains("cornell.json") && comments.contains("samples per pixel 4"), "{comments}");
}

#[test]
fn statistics_and_the_images_header_say_what_it_came_to() {
    let folder = folder();
    let scene = scene("cornell.json");
    let args = ["-o", "x.exr", "--adaptive", "--stats", "stats.json", "--spp", "64"];
    let run = etendue(folder.path(), small_render(&scene, &args));
    assert_eq!(run.code, Some(0), "{}", run.stderr);
    let text = fs::read_to_string(folder.path().join("stats.json")).expect("statistics");
    let stats: serde_json::Value = serde_json::from_str(&text).expect("JSON");
    assert_eq!((&stats["settings"]["adaptive"], &stats["settings"]["spp"]), (&true.into(), &64.into()), "{text}");
    let [fewest, mean, most] = ["min", "mean", "max"].map(|key| stats["samples"][key].as_f64().expect(key));
    assert!(fewest < mean && mean <= 64.0 && mean > 63.0 && most > 64.0, "{text}");
    let [rel_mse, error] = ["value", "standardError"].map(|key| stats["relMSE"][key].as_f64().expect(key));
    assert!(rel_mse > 0.0 && error > 0.0 && error < rel_mse, "{text}");
    assert!(stats["rays"].as_u64() > Some(1000) && stats["seconds"]["render"].as_f64() > Some(0.0), "{text}");
    assert_eq!((&stats["ended"], &stats["target"]), (&"samples".into(), &serde_json::Value::Null));
    // The same in the image's header, by another reader than the one that wrote it would use.
    let meta = exr::meta::MetaData::read_from_file(folder.path().join("x.exr"), false).expect("an EXR header");
    let number = |name: &str| match meta.headers[0].own_attributes.other.get(&exr::meta::attribute::Text::from(name)) {
        Some(exr::meta::attribute::AttributeValue::F64(number)) => *number,
        other => panic!("{name}: {other:?}"),
    };
    assert_eq!((number("relMSE"), number("relMSEStandardError")), (rel_mse, error));
    assert_eq!(number("rays"), stats["rays"].as_f64().unwrap());
    // A target that is reached at once, after the least number of samples.
    let run = etendue(
        folder.path(),
        small_render(&scene, &["-o", "y.exr", "--stats", "stats.json", "--target-display", "200", "--spp", "64", "-q"]),
    );
    assert_eq!((run.code, run.stdout.as_str()), (Some(0), ""), "{}", run.stderr);
    let text = fs::read_to_string(folder.path().join("stats.json")).expect("statistics");
    let stats: serde_json::Value = serde_json::from_str(&text).expect("JSON");
    assert_eq!((&stats["ended"], stats["samples"]["mean"].as_f64()), (&"error".into(), Some(32.0)), "{text}");
}

#[test]
fn pixels_share_hits_where_that_is_asked_for() {
    let folder = folder();
    let box_of_paper = fs::read_to_string(scene("cornell.json")).unwrap();
    let mut described: serde_json::Value = serde_json::from_str(&box_of_paper).unwrap();
    described["render"]["integrator"] = serde_json::json!({"type": "path", "reuse": true});
    fs::write(folder.path().join("shared.json"), described.to_string()).unwrap();
    let render = |scene: &str, more: &[&str]| etendue(folder.path(), small_render(scene, more));
    let shares = |scene: &str, more: &[&str]| {
        render(scene, &[more, &["-q", "-o", "x.pfm", "--stats", "stats.json"]].concat()).assert_done();
        let text = fs::read_to_string(folder.path().join("stats.json")).unwrap();
        let stats: serde_json::Value = serde_json::from_str(&text).unwrap();
        stats["settings"]["reuse"].as_bool().unwrap()
    };
    described["render"]["integrator"] = serde_json::json!({"type": "path", "reuse": false});
    fs::write(folder.path().join("alone.json"), described.to_string()).unwrap();
    let plain = scene("cornell.json");
    // A pilot for so few samples would not pay.
    assert!(!shares(&plain, &[]) && !shares(&plain, &["--reuse=off"]));
    assert!(shares(&plain, &["--reuse"]) && shares(&plain, &["--reuse=on"]));
    assert!(!shares("alone.json", &[]) && shares("alone.json", &["--reuse"]));
    assert!(shares("shared.json", &[]) && !shares("shared.json", &["--reuse=off"]));
    // Another integrator takes the place of the scene's together with its settings.
    assert!(!shares("shared.json", &["--integrator", "direct"]) && !shares("shared.json", &["--integrator", "path"]));
    assert!(shares("shared.json", &["--integrator", "path", "--reuse"]));

    let refused = |more: &[&str], why: &str| {
        let run = render("shared.json", &[more, &["-o", "y.pfm"]].concat());
        run.assert_refused(&format!("render.integrator.reuse is true, and {why}"));
    };
    for integrator in ["whitted", "auto", "sppm", "radiosity"] {
        let why = format!("{integrator} shares no hits among pixels; expected false, or the integrator path");
        refused(&["--integrator", integrator, "--reuse"], &why);
    }
    refused(&["--spectral"], "render.spectral gives each path wavelengths of its own");
    refused(&["--adaptive"], "adaptive sampling gives neighbouring pixels different numbers of samples");
    render("shared.json", &["--reuse=yes", "-o", "y.pfm"]).assert_refused_by_grammar("--reuse[=<on|off>]");
    render(&scene("motion-blur.json"), &["--reuse", "-o", "y.pfm"]).assert_refused("something moves while");
    let bake = etendue(folder.path(), ["bake", "shared.json", "-o", "light", "--spp", "1", "--resolution", "64"]);
    bake.assert_refused("render.integrator.reuse is true, and a light map has no neighbouring pixels");
    assert!(!folder.path().join("y.pfm").exists());
}

#[test]
fn light_paths_are_traced_where_that_is_asked_for() {
    let folder = folder();
    let caustic = fs::read_to_string(scene("caustic.json")).unwrap();
    let mut described: serde_json::Value = serde_json::from_str(&caustic).unwrap();
    described["render"]["integrator"] = serde_json::json!({"type": "path", "lightPaths": true});
    fs::write(folder.path().join("lit.json"), described.to_string()).unwrap();
    let render = |scene: &str, more: &[&str]| etendue(folder.path(), small_render(scene, more));
    let traces = |scene: &str, more: &[&str]| {
        render(scene, &[more, &["-q", "-o", "x.pfm", "--stats", "stats.json"]].concat()).assert_done();
        let text = fs::read_to_string(folder.path().join("stats.json")).unwrap();
        let stats: serde_json::Value = serde_json::from_str(&text).unwrap();
        stats["settings"]["lightPaths"].as_bool().unwrap()
    };
    let plain = scene("caustic.json");
    assert!(
        !traces(&plain, &[]) && traces(&plain, &["--light-paths"]) && traces(&plain, &["--light-paths=on", "--reuse"])
    );
    assert!(traces("lit.json", &[]) && !traces("lit.json", &["--light-paths=off"]));
    // Another integrator takes the place of the scene's together with its settings.
    assert!(!traces("lit.json", &["--integrator", "direct"]) && !traces("lit.json", &["--integrator", "path"]));
    // In a scene without mirrors and glass there is nothing that they would find.
    assert!(!traces(&scene("cornell.json"), &["--light-paths"]));
    let run = render("lit.json", &["--integrator", "sppm", "--light-paths", "-o", "y.pfm"]);
    run.assert_refused("render.integrator.lightPaths is true, and sppm traces none to the camera; expected false, or the integrator path");
    render("lit.json", &["--light-paths=yes", "-o", "y.pfm"]).assert_refused_by_grammar("--light-paths[=<on|off>]");
    let bake = etendue(folder.path(), ["bake", "lit.json", "-o", "light", "--spp", "1", "--resolution", "64"]);
    bake.assert_refused("render.integrator.lightPaths is true, and a light map has no camera");
    assert!(!folder.path().join("y.pfm").exists());
}

#[test]
fn light_samples_of_first_hits_are_those_that_are_asked_for() {
    let folder = folder();
    let mut described: serde_json::Value =
        serde_json::from_str(&fs::read_to_string(scene("soft-shadows.json")).unwrap()).unwrap();
    described["render"]["integrator"] = serde_json::json!({"type": "path", "firstShadowRays": 3});
    fs::write(folder.path().join("three.json"), described.to_string()).unwrap();
    let render = |scene: &str, more: &[&str]| etendue(folder.path(), small_render(scene, more));
    let taken = |more: &[&str]| {
        render("three.json", &[more, &["-q", "-o", "x.pfm", "--stats", "stats.json"]].concat()).assert_done();
        let text = fs::read_to_string(folder.path().join("stats.json")).unwrap();
        let stats: serde_json::Value = serde_json::from_str(&text).unwrap();
        let settings = &stats["settings"];
        (settings["firstShadowRays"].as_u64().unwrap(), settings["shadowRays"].as_u64().unwrap())
    };
    assert_eq!(taken(&[]), (3, 1));
    assert_eq!(taken(&["--first-shadow-rays", "5", "--shadow-rays", "2", "--adaptive"]), (5, 2));
    // Another integrator takes the place of the scene's together with its settings.
    assert_eq!(taken(&["--integrator", "path", "--shadow-rays", "2"]), (2, 2));
    let run = render("three.json", &["--integrator", "sppm", "--first-shadow-rays", "2", "-o", "y.pfm"]);
    run.assert_refused("render.integrator.firstShadowRays is given, and sppm has no number of its own");
    render("three.json", &["--first-shadow-rays", "0", "-o", "y.pfm"]).assert_refused_by_grammar("1..=1024");
    let bake = etendue(folder.path(), ["bake", "three.json", "-o", "light", "--spp", "1", "--resolution", "64"]);
    bake.assert_refused("render.integrator.firstShadowRays is given, and a light map has no number of its own");
    assert!(!folder.path().join("y.pfm").exists());
}

#[test]
fn a_bias_is_allowed_to_auto_alone_and_the_chosen_integrator_is_told() {
    let folder = folder();
    let mut described: serde_json::Value =
        serde_json::from_str(&fs::read_to_string(scene("cornell.json")).unwrap()).unwrap();
    described["render"]["integrator"] = serde_json::json!({"type": "auto", "bias": "allowed"});
    fs::write(folder.path().join("allowed.json"), described.to_string()).unwrap();
    let render = |scene: &str, more: &[&str]| etendue(folder.path(), small_render(scene, more));
    let told = |more: &[&str]| {
        render("allowed.json", &[more, &["-q", "-o", "x.pfm", "--stats", "stats.json"]].concat()).assert_done();
        let text = fs::read_to_string(folder.path().join("stats.json")).unwrap();
        let stats: serde_json::Value = serde_json::from_str(&text).unwrap();
        [&stats["settings"]["integrator"], &stats["settings"]["bias"], &stats["integrator"]]
            .map(|it| it.as_str().unwrap().to_owned())
    };
    assert_eq!(told(&[]), ["auto", "allowed", "path"]);
    assert_eq!(told(&["--bias", "refused"]), ["auto", "refused", "path"]);
    // Another integrator takes the place of the scene's together with its settings.
    assert_eq!(told(&["--integrator", "whitted"]), ["whitted", "refused", "whitted"]);
    let run = render("allowed.json", &["--integrator", "sppm", "--bias", "allowed", "-o", "y.pfm"]);
    run.assert_refused("render.integrator.bias is allowed, and sppm chooses no other integrator");
    let bake = etendue(folder.path(), ["bake", "allowed.json", "-o", "light", "--spp", "1", "--resolution", "64"]);
    bake.assert_refused("render.integrator.bias is allowed, and a light map has no pilot");
    assert!(!folder.path().join("y.pfm").exists());
}

#[test]
fn light_layers_add_up_to_the_picture() {
    let folder = folder();
    let cornell = scene("cornell.json");
    let render = |more: &[&str]| etendue(folder.path(), small_render(&cornell, &[more, &["-q"]].concat()));
    render(&["--light-layers", "-o", "parts.exr", "b.png"]).assert_done();
    render(&["-o", "plain.exr"]).assert_done();
    let [parts, plain] = ["parts.exr", "plain.exr"].map(|name| output::read(&folder.path().join(name)).unwrap());
    assert_eq!(parts.rgb, plain.rgb, "the picture is the usual one");
    let [emission, direct, indirect] = ["emission", "direct", "indirect"].map(|name| &parts.layer(name).unwrap().data);
    assert!(plain.layer("direct").is_none());
    for layer in [emission, direct, indirect] {
        assert!(layer.iter().any(|value| *value > 0.0));
    }
    let adds_up = |image: &Image| {
        let of = |name: &str, i: usize| image.layer(name).unwrap().data[i];
        let sum = |i| ["emission", "direct", "indirect"].into_iter().map(|name| of(name, i)).sum::<f32>();
        image.rgb.iter().enumerate().all(|(i, whole)| (sum(i) - whole).abs() <= 1e-5 * whole.max(1.0))
    };
    assert!(adds_up(&parts));
    // In other primaries, under another white, and with weights below 0.
    let other = ["--primaries", "xyz", "--white-balance", "A", "--filter", "mitchell"];
    render(&[&["--light-layers", "-o", "other.exr"], &other[..]].concat()).assert_done();
    let other = output::read(&folder.path().join("other.exr")).unwrap();
    assert!(other.rgb != parts.rgb && adds_up(&other));
    // Of a checkpoint, which has them without being asked for.
    render(&["--light-layers", "--checkpoint", "a.etd"]).assert_done();
    etendue(folder.path(), ["merge", "a.etd", "-o", "merged.exr"]).assert_done();
    assert_eq!(
        output::read(&folder.path().join("merged.exr")).unwrap().layer("direct").map(|it| &it.data),
        Some(direct)
    );

    render(&["--light-layers", "-o", "x.png"]).assert_refused("--light-layers: no output has room for layers");
    let sppm = render(&["--light-layers", "--integrator", "sppm", "-o", "x.exr"]);
    sppm.assert_refused("sppm does not count how often light was scattered; expected the integrator path");
    render(&["--light-layers", "--reuse", "-o", "x.exr"])
        .assert_refused("render.integrator.reuse is true, and light is kept apart");
    assert!(!folder.path().join("x.exr").exists());
}

#[test]
fn mattes_are_layers_of_an_exr() {
    use etendue::output::cryptomatte::id;
    let folder = folder();
    let text = r#"{"etendue": 1, "camera": {"type": "orthographic", "origin": [0, 0, 5], "lookAt": [0, 0, 0], "width": 4},
        "render": {"resolution": [16, 16], "samples": 16, "integrator": "direct"},
        "materials": [{"name": "grey \"one\"", "type": "diffuse", "color": [0.5, 0.5, 0.5]}],
        "surfaces": [
            {"geometry": "sphere", "origin": [0, 0, 0], "radius": 1, "emission": [1, 1, 1], "name": "lamp"},
            {"geometry": "disk", "origin": [0.5, 0, -2], "normal": [0, 0, 1], "radius": 1.5, "material": "grey \"one\""}]}"#;
    fs::write(folder.path().join("scene.json"), text).unwrap();
    let render = |more: &[&str]| etendue(folder.path(), [&["render", "scene.json", "-q"], more].concat());
    render(&["--cryptomatte", "-o", "two.exr", "two.png", "--threads", "2"]).assert_done();
    render(&["--cryptomatte", "-o", "one.exr", "--threads", "1"]).assert_done();
    render(&["-o", "plain.exr", "plain.png"]).assert_done();
    let bytes = |name: &str| fs::read(folder.path().join(name)).unwrap();
    assert!(bytes("one.exr") == bytes("two.exr"), "the same bytes for any number of threads");
    assert!(bytes("two.png") == bytes("plain.png"));
    let [image, plain] = ["two.exr", "plain.exr"].map(|name| output::read(&folder.path().join(name)).unwrap());
    assert_eq!(image.rgb, plain.rgb, "the picture is the usual one");
    let sum = |layers: [&str; 3], id: f32| {
        let pairs = layers.into_iter().flat_map(|layer| image.layer(layer).expect(layer).data.chunks_exact(2));
        pairs.filter(|pair| pair[0] == id).map(|pair| f64::from(pair[1])).sum::<f64>() / 16.0
    };
    let objects = ["CryptoObject00", "CryptoObject01", "CryptoObject02"];
    let materials = ["CryptoMaterial00", "CryptoMaterial01", "CryptoMaterial02"];
    let ball = sum(objects, id("lamp"));
    assert!((ball / std::f64::consts::PI - 1.0).abs() < 0.01, "{ball}");
    let disk = sum(objects, id("surfaces[1]"));
    assert!(disk > 1.0 && sum(materials, id("grey \"one\"")) == disk, "the lamp has no material");
    assert!(image.layer("CryptoObject").is_some() && image.layer("CryptoObject03").is_none());

    let meta = exr::meta::MetaData::read_from_file(folder.path().join("two.exr"), false).expect("an EXR header");
    let attribute = |name: &str| match meta.headers[0].own_attributes.other.get(&exr::meta::attribute::Text::from(name))
    {
        Some(exr::meta::attribute::AttributeValue::Text(found)) => found.to_string(),
        other => panic!("{name}: {other:?}"),
    };
    for (key, name, expected) in
        [("3ae39a5", "CryptoObject", vec!["lamp", "surfaces[1]"]), ("be359d6", "CryptoMaterial", vec!["grey \"one\""])]
    {
        assert_eq!(attribute(&format!("cryptomatte/{key}/name")), name);
        assert_eq!(attribute(&format!("cryptomatte/{key}/hash")), "MurmurHash3_32");
        assert_eq!(attribute(&format!("cryptomatte/{key}/conversion")), "uint32_to_float32");
        let manifest: serde_json::Value =
            serde_json::from_str(&attribute(&format!("cryptomatte/{key}/manifest"))).unwrap();
        assert_eq!(manifest.as_object().unwrap().len(), expected.len());
        for name in expected {
            assert_eq!(manifest[name], format!("{:08x}", id(name).to_bits()));
        }
    }
    render(&["--cryptomatte", "--cryptomatte-levels", "2", "-o", "few.exr"]).assert_done();
    let few = output::read(&folder.path().join("few.exr")).unwrap();
    assert!(few.layer("CryptoObject00") == image.layer("CryptoObject00") && few.layer("CryptoObject01").is_none());

    render(&["--cryptomatte", "-o", "x.png"]).assert_refused("--cryptomatte: no output has room for layers");
    render(&["--cryptomatte", "--checkpoint", "x.etd"]).assert_refused("--cryptomatte: no output has room for layers");
    for levels in ["0", "3", "66", "x"] {
        let run = render(&["--cryptomatte", "--cryptomatte-levels", levels, "-o", "x.exr"]);
        run.assert_refused_by_grammar("expected an even number from 2 to 64");
    }
    render(&["--cryptomatte-levels", "4", "-o", "x.exr"]).assert_refused_by_grammar("--cryptomatte");
    let share = render(&["--cryptomatte", "--share", "1/2", "--checkpoint", "x.etd", "-o", "x.exr"]);
    share.assert_refused_by_grammar("cannot be used with");
}

#[test]
fn spectral_layers_are_channels_of_an_exr() {
    let folder = folder();
    let scene = scene("cornell.json");
    let layers = |name: &str, more: &[&str]| {
        let mut args = small_render(&scene, &["--spectral", "--spectral-layers", "4", "-q", "-o", name]);
        args.extend(more);
        etendue(folder.path(), args).assert_done();
        fs::read(folder.path().join(name)).unwrap()
    };
    let range = ["--spectral-range", "400-700"];
    let bytes = layers("two.exr", &range);
    let [first, second] = [range[0], range[1]];
    assert!(bytes == layers("one.exr", &[first, second, "--threads", "1"]), "the same bytes for any number of threads");

    let image = output::read(&folder.path().join("two.exr")).unwrap();
    let names = ["S0.437,5nm", "S0.512,5nm", "S0.587,5nm", "S0.662,5nm"];
    for name in names {
        let layer = image.layer(name).expect(name);
        assert!(layer.channels == 1 && layer.data.iter().any(|value| *value > 0.0), "{name}");
    }
    assert!(image.layer("albedo").is_some() && image.layer("S0.400nm").is_none());
    etendue(folder.path(), small_render(&scene, &["--spectral", "-q", "-o", "plain.exr"])).assert_done();
    assert_eq!(output::read(&folder.path().join("plain.exr")).unwrap().rgb, image.rgb, "the picture is the usual one");

    let meta = exr::meta::MetaData::read_from_file(folder.path().join("two.exr"), false).expect("an EXR header");
    let header = &meta.headers[0];
    let channels: Vec<String> = header.channels.list.iter().map(|channel| channel.name.to_string()).collect();
    for name in names.into_iter().chain(["R", "G", "B", "albedo.R"]) {
        assert!(channels.iter().any(|channel| channel == name), "{name}: {channels:?}");
    }
    for (name, text) in [("spectralLayoutVersion", "1.0"), ("emissiveUnits", "W.m^-2.sr^-1")] {
        match header.own_attributes.other.get(&exr::meta::attribute::Text::from(name)) {
            Some(exr::meta::attribute::AttributeValue::Text(found)) => assert_eq!(found.to_string(), text),
            other => panic!("{name}: {other:?}"),
        }
    }
    let default = layers("default.exr", &[]);
    assert!(default != bytes && output::read(&folder.path().join("default.exr")).unwrap().layer("S0.430nm").is_some());

    let refused = |more: &[&str]| etendue(folder.path(), small_render(&scene, more));
    let of_four = ["--spectral-layers", "4", "-o", "x.exr"];
    refused(&of_four).assert_refused("--spectral-layers: paths in three channels have no bands");
    let with = |more: &[&'static str]| [&["--spectral"], &of_four[..], more].concat();
    refused(&with(&["y.png"])).assert_refused("y.png: has no room for spectral layers");
    refused(&with(&["--integrator", "radiosity"])).assert_refused("radiosity carries three channels");
    refused(&with(&["--spectral-range", "400-401", "--spectral-layers", "12"])).assert_refused("are too narrow");
    for range in ["300-700", "400-900", "700-400", "500-500", "400", "a-b", "400-700-800"] {
        let run = refused(&with(&["--spectral-range", range]));
        run.assert_refused_by_grammar("expected two wavelengths from 360 to 830 nm");
    }
    for count in ["0", "2", "513", "x"] {
        let run = refused(&["--spectral", "--spectral-layers", count, "-o", "x.exr"]);
        run.assert_refused_by_grammar("--spectral-layers <N>");
    }
    let run = refused(&["--spectral", "--spectral-range", "400-700", "-o", "x.exr"]);
    run.assert_refused_by_grammar("--spectral-layers <N>");
}

#[test]
fn quiet_says_nothing_and_options_reach_the_renderer() {
    let folder = folder();
    let cornell = scene("cornell.json");
    let render = |name: &str, more: &[&str]| {
        let mut args = small_render(&cornell, &["--quiet"]);
        args.extend(more);
        args.extend(["--output", name]);
        let run = etendue(folder.path(), &args);
        run.assert_done();
        assert_eq!((run.stdout.as_str(), run.stderr.as_str()), ("", ""), "{args:?}");
        output::read(&folder.path().join(name)).unwrap()
    };
    let plain = render("plain.exr", &[]);
    assert_eq!(render("again.exr", &["--threads", "1"]), plain, "the same bits for any number of threads");
    for (index, options) in [
        &["--seed", "12345"][..],
        &["--integrator", "direct"],
        &["--sampler", "random"],
        &["--filter", "gaussian:0.7"],
        &["--shadow-rays", "3"],
        &["--max-depth", "1"],
    ]
    .into_iter()
    .enumerate()
    {
        let image = render(&format!("{index}.exr"), options);
        assert_ne!(image.rgb, plain.rgb, "{options:?}");
    }
    for integrator in etendue::desc::IntegratorDesc::ALL {
        let name = integrator.name();
        let few = [
            "--integrator",
            name,
            "--photons",
            "2000",
            "--photon-radius",
            "40",
            "--caustic-photons",
            "500",
            "--caustic-radius",
            "20.5",
        ];
        let image = render(&format!("{name}.exr"), &few);
        let comments = fs::read(folder.path().join(format!("{name}.exr"))).unwrap();
        assert!(String::from_utf8_lossy(&comments).contains(&format!("integrator {integrator:?};")), "{name}");
        assert!(image.rgb.iter().any(|value| *value > 0.0), "{name}");
    }
    // A stop more of exposure is a brighter picture.
    let dark = render("dark.png", &["--exposure", "-2"]);
    let bright = render("bright.png", &["--exposure", "1"]);
    assert!((0..3).all(|channel| dark.mean()[channel] < bright.mean()[channel]), "{dark:?} {bright:?}");
}

#[test]
fn photons_are_written_and_drawn() {
    let folder = folder();
    let cornell = scene("cornell.json");
    let run = |more: &[&str]| {
        let mut args = vec!["photons", &cornell, "--photons", "3000", "--resolution", "24x18"];
        args.extend(more);
        etendue(folder.path(), &args)
    };
    let read = |name: &str| fs::read(folder.path().join(name)).unwrap();
    let done = run(&["-o", "a.png", "a.csv", "--threads", "2", "-o", "a.ply"]);
    done.assert_done();
    assert!(done.stderr.contains("photons and") && done.stderr.contains("of 3000 light paths"), "{}", done.stderr);
    assert_eq!(names(folder.path()), ["a.csv", "a.ply", "a.png"]);
    let table = String::from_utf8(read("a.csv")).unwrap();
    assert!(table.starts_with("x,y,z,nx,ny,nz,wx,wy,wz,r,g,b,shadow\n"), "{}", &table[..60]);
    assert!(table.lines().any(|line| line.ends_with(",1")) && table.lines().any(|line| line.ends_with(",0")));
    let count = format!("element vertex {}\n", table.lines().count() - 1);
    assert!(String::from_utf8_lossy(&read("a.ply")).contains(&count), "{count}");
    // In the box of the scene, in its own coordinates.
    for line in table.lines().skip(1) {
        let place: Vec<f64> = line.split(',').take(3).map(|word| word.parse().unwrap()).collect();
        assert!(place.iter().all(|x| (-1.0..561.0).contains(x)), "{line}");
    }
    run(&["-o", "again.csv", "--threads", "1"]).assert_done();
    assert_eq!(read("again.csv"), read("a.csv"), "the same bytes for any number of threads");
    let seeded = run(&["-o", "seeded.csv", "--seed", "99", "--quiet"]);
    seeded.assert_done();
    assert_eq!(seeded.stderr, "");
    assert_ne!(read("seeded.csv"), read("a.csv"));
    for map in ["indirect", "global"] {
        run(&["-o", "map.csv", "--map", map]).assert_done();
        let other = String::from_utf8(read("map.csv")).unwrap();
        assert!(
            other != table && other.lines().count() > 1000 && !other.lines().any(|line| line.ends_with(",1")),
            "{map}"
        );
    }
    // No glass, no mirror: nothing of this kind, which is said, and is no failure.
    let none = run(&["-o", "none.csv", "--map", "caustic"]);
    none.assert_done();
    assert!(none.stderr.contains("warning: there is no such photon"), "{}", none.stderr);
    assert_eq!(String::from_utf8(read("none.csv")).unwrap().lines().count(), 1);
    // Pictures: in colour, from elsewhere.
    let picture = |more: &[&str]| {
        let mut args = vec!["-o", "picture.pfm"];
        args.extend(more);
        run(&args).assert_done();
        let image = output::read(&folder.path().join("picture.pfm")).unwrap();
        assert_eq!((image.width, image.height), (24, 18));
        image
    };
    let plain = picture(&[]);
    assert!(plain.rgb.contains(&1.0) && plain.rgb.contains(&0.0) && plain.rgb.iter().all(|v| (0.0..=1.0).contains(v)));
    assert!(plain.rgb.chunks(3).all(|pixel| pixel[0] == pixel[1] && pixel[1] == pixel[2]));
    assert!(picture(&["--color"]).rgb.chunks(3).any(|pixel| pixel[0] != pixel[2]));
    for camera in [["--origin", "278,273,100"], ["--look-at", "-1e2,0,0"], ["--up", "1,1,0"], ["--field-of-view", "70"]]
    {
        assert!(picture(&camera) != plain, "{camera:?}");
    }
}

#[test]
fn photons_that_cannot_be_had_are_refused() {
    let folder = folder();
    let cornell = scene("cornell.json");
    let run = |more: &[&str]| {
        let mut args = vec!["photons", &cornell, "--photons", "100"];
        args.extend(more);
        etendue(folder.path(), &args)
    };
    run(&["-o", "a.obj"]).assert_refused("a.obj: nothing is known by this name's extension: use .csv or .ply");
    run(&["-o", "a.csv", "a.csv"]).assert_refused("a.csv: given twice");
    run(&["-o", "no/a.ply"]).assert_refused("no/a.ply: cannot write the photons into its folder");
    run(&["-o", "no/a.png"]).assert_refused("no/a.png: cannot write the image into its folder");
    run(&["-o", "a.png", "--origin", "0,0,0", "--look-at", "0,0,0"]).assert_refused("camera.lookAt");
    run(&["-o", "a.png", "--up", "0,0,0"]).assert_refused("camera.up");
    for wrong in [
        ["--map", "shadow"],
        ["--photons", "0"],
        ["--origin", "1,2"],
        ["--origin", "1,2,3,4"],
        ["--look-at", "1,2,nan"],
        ["--up", "a,b,c"],
        ["--field-of-view", "180"],
        ["--field-of-view", "0"],
    ] {
        let run = run(&["-o", "a.png", wrong[0], wrong[1]]);
        assert_eq!(run.code, Some(2), "{wrong:?}: {}", run.stderr);
    }
    assert_eq!(names(folder.path()), [""; 0]);
}

#[test]
fn info_says_what_a_scene_holds() {
    let folder = folder();
    let run = etendue(folder.path(), ["info", &scene("cornell.json")]);
    run.assert_done();
    assert!(run.stdout.lines().count() >= 3, "{}", run.stdout);
    assert_eq!(names(folder.path()), [""; 0]);
}

/// A scene and its converted form give the same file, and a scene file is replaced as an image is.
#[test]
fn a_converted_scene_gives_the_same_image() {
    let folder = folder();
    let data = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/parts.obj");
    let data = data.to_str().unwrap();
    let params = folder.path().join("params.json");
    fs::write(&params, r#"{"maxRayDepth": 3}"#).unwrap();
    let textures = scene("textures.json");
    for (scene, options) in [(data, &[][..]), (textures.as_str(), &["--params", "params.json"])] {
        let mut args = vec!["convert", scene, "c.json"];
        args.extend(options);
        let run = etendue(folder.path(), &args);
        run.assert_done();
        assert!(run.stderr.contains("c.json written: ") && run.stdout.is_empty(), "{}", run.stderr);
        let mut before = vec!["render", scene];
        before.extend(options.last());
        before.extend(["--resolution", "16x12", "--spp", "4", "-o", "before.pfm"]);
        etendue(folder.path(), before).assert_done();
        etendue(folder.path(), small_render("c.json", &["-o", "after.pfm"])).assert_done();
        let bytes = |name: &str| fs::read(folder.path().join(name)).unwrap();
        assert!(bytes("before.pfm") == bytes("after.pfm"), "{scene}: the images differ");
    }
    // A scene of GLTF at a time, quietly.
    let gltf = r#"{"asset": {"version": "2.0"}, "scenes": [{"nodes": [0, 1]}], "cameras": [{"name": "Near", "type": "perspective",
        "perspective": {"yfov": 0.5, "znear": 0.1}}], "nodes": [{"mesh": 0}, {"camera": 0, "translation": [0, 0, 3]}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}}]}],
        "accessors": [{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3"}],
        "bufferViews": [{"buffer": 0, "byteLength": 36}], "buffers": [{"byteLength": 36,
        "uri": "data:;base64,AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAA"}]}"#;
    fs::write(folder.path().join("t.gltf"), gltf).unwrap();
    let run = etendue(folder.path(), ["convert", "t.gltf", "c.json", "--camera", "Near", "-q"]);
    run.assert_done();
    assert_eq!(run.stderr, "");
    assert!(fs::read_to_string(folder.path().join("c.json")).unwrap().contains(r#""origin": [0, 0, 3]"#));
    // Of the images of the scene before, nothing is left.
    let files = names(&folder.path().join("c.files"));
    assert!(matches!(&files[..], [mesh] if mesh.starts_with("mesh-0-") && mesh.ends_with(".ply")), "{files:?}");
    let before = names(folder.path());
    let refused =
        |args: &[&str], what: &str| etendue(folder.path(), [&["convert"], args].concat()).assert_refused(what);
    refused(&["c.json", "./c.json"], "./c.json: this file is read as a part of the scene and cannot be written");
    refused(&[data, "params.json", "--params", "params.json"], "params.json: this file is read");
    refused(
        &[&format!("c.files/{}", files[0]), "c.json"],
        "c.json: a file in the folder of its meshes and images is read",
    );
    refused(&[data, "no/c.json"], "no/c.json: cannot write the file into its folder");
    refused(&[data, "c.glb"], "c.glb: the name of a native scene file ends in .json");
    refused(&[data, "c.json", "--at", "1"], "which only glTF files have");
    refused(&["t.gltf", "c.json", "--camera", "Far"], "Far");
    assert_eq!(names(folder.path()), before);
}

#[test]
fn a_mesh_is_a_scene_by_itself() {
    let folder = folder();
    let ply = "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n\
        property uchar red\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n\
        0 0 0 1\n1 0 0 1\n0 1 0 1\n3 0 1 2\n";
    fs::write(folder.path().join("a.ply"), ply).unwrap();
    let run = etendue(folder.path(), ["info", "a.ply"]);
    run.assert_done();
    assert!(run.stdout.starts_with("read            a.ply: 3 vertices, 1 triangles\n"), "{}", run.stdout);
    assert!(run.stdout.contains("emitters        1 (0 points, 1 at infinity)"), "{}", run.stdout);
    assert!(run.stderr.contains("a.ply: properties of each vertex that are not used: red"), "{}", run.stderr);
    etendue(folder.path(), small_render("a.ply", &["-o", "a.png"])).assert_done();
    assert_eq!(names(folder.path()), ["a.ply", "a.png"]);
    fs::write(folder.path().join("b.ply"), &ply[..ply.len() - 3]).unwrap();
    let run = etendue(folder.path(), ["render", "b.ply", "-o", "b.png"]);
    run.assert_refused("b.ply:14: face 0, vertex_indices: the line has no more values");
    etendue(folder.path(), small_render("a.ply", &["-o", "b.png", "--integrator", "radiosity"])).assert_done();
    assert_eq!(names(folder.path()), ["a.ply", "a.png", "b.ply", "b.png"]);
}

#[test]
fn an_unknown_material_is_named_with_its_place() {
    let folder = folder();
    let cornell: serde_json::Value = serde_json::from_str(&fs::read_to_string(scene("cornell.json")).unwrap()).unwrap();
    let mut broken = cornell;
    broken["surfaces"][0]["material"] = "no such material".into();
    fs::write(folder.path().join("broken.json"), serde_json::to_string_pretty(&broken).unwrap()).unwrap();
    let run = etendue(folder.path(), ["render", "broken.json", "-o", "a.png"]);
    run.assert_refused("surfaces[0].material");
    assert!(run.stderr.starts_with("error: broken.json:"), "{}", run.stderr);
    assert_eq!(names(folder.path()), ["broken.json"]);
}

/// A glTF file whose triangle leaves the picture within a second.
#[test]
fn a_gltf_file_is_seen_at_a_time_by_a_camera() {
    let folder = folder();
    let numbers =
        [[0.0_f32, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0].as_slice(), &[0.0, 1.0], &[0.0, 0.0, 0.0, 100.0, 0.0, 0.0]];
    let bytes: Vec<u8> = numbers.concat().into_iter().flat_map(f32::to_le_bytes).collect();
    let data = base64::Engine::encode(&base64::engine::general_purpose::STANDARD, &bytes);
    let accessor = |offset: u32, count: u32, kind: &str| serde_json::json!({"bufferView": 0, "byteOffset": offset, "componentType": 5126, "count": count, "type": kind});
    let camera = |name: &str| serde_json::json!({"name": name, "type": "perspective", "perspective": {"yfov": 0.5}});
    let file = serde_json::json!({
        "asset": {"version": "2.0"},
        "buffers": [{"uri": format!("data:;base64,{data}"), "byteLength": bytes.len()}],
        "bufferViews": [{"buffer": 0, "byteLength": bytes.len()}],
        "accessors": [accessor(0, 3, "VEC3"), accessor(36, 2, "SCALAR"), accessor(44, 2, "VEC3")],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}}]}],
        "cameras": [camera("front"), camera("away")],
        "extensions": {"KHR_lights_punctual": {"lights": [{"type": "point", "intensity": 7000}]}},
        "animations": [{"name": "leave", "samplers": [{"input": 1, "output": 2}],
            "channels": [{"sampler": 0, "target": {"node": 0, "path": "translation"}}]}],
        "nodes": [{"mesh": 0}, {"camera": 0, "translation": [0.3, 0.3, 3]},
            {"camera": 1, "translation": [0.3, 0.3, -9], "rotation": [0, 0, 0, 1]},
            {"translation": [0.3, 0.3, 2], "extensions": {"KHR_lights_punctual": {"light": 0}}}],
    });
    fs::write(folder.path().join("m.gltf"), file.to_string()).expect("a file");
    let mean = |more: &[&str]| {
        let run = etendue(folder.path(), small_render("m.gltf", &[["-o", "m.pfm"].as_slice(), more].concat()));
        run.assert_done();
        output::read(&folder.path().join("m.pfm")).expect("an image").mean()[0]
    };
    assert!(mean(&[]) > 0.01);
    assert!(mean(&["--at", "0", "--animation", "leave"]) > 0.01);
    assert_eq!(mean(&["--at", "0.5"]), 0.0);
    assert_eq!(mean(&["--camera", "away"]), 0.0);
    let refused = |scene: &str, more: &[&str], what: &str| {
        let all = [["-o", "n.pfm"].as_slice(), more].concat();
        etendue(folder.path(), small_render(scene, &all)).assert_refused(what);
    };
    refused("m.gltf", &["--camera", "awy"], "none of cameras is named 'awy'; did you mean 'away'?");
    refused(&scene("cornell.json"), &["--at", "0"], "which only glTF files have");
}

#[test]
fn frames_and_moments_of_what_moves() {
    let folder = folder();
    let path = |name: &str| folder.path().join(name);
    let moving = r#"{"etendue": 1, "camera": {"origin": [0, 0, 5], "shutter": {"close": 0.25}},
        "lights": [{"type": "environment", "color": [1, 1, 1]}],
        "materials": [{"name": "black", "type": "black"}],
        "surfaces": [{"geometry": "sphere", "material": "black", "origin": [0, 0, 0], "radius": 1,
            "motion": [{"time": 0, "translate": [-2, 0, 0]}, {"time": 2, "translate": [2, 0, 0]}]}]}"#;
    fs::write(path("moving.json"), moving).unwrap();
    let run = |more: &[&str]| etendue(folder.path(), small_render("moving.json", more));
    // Frame 2 of 4 a second begins at half a second; its shutter is open as long as the scene says.
    run(&["--frames", "1-3", "--frame-rate", "4", "-o", "out-###.png", "x#y.pfm", "--stats", "s##.json"]).assert_done();
    let expected = [
        "moving.json",
        "out-001.png",
        "out-002.png",
        "out-003.png",
        "s01.json",
        "s02.json",
        "s03.json",
        "x1y.pfm",
        "x2y.pfm",
        "x3y.pfm",
    ];
    assert_eq!(names(folder.path()), expected);
    let later = moving.replace(r#"{"close": 0.25}"#, r#"{"open": 0.5, "close": 0.75}"#);
    fs::write(path("later.json"), later).unwrap();
    etendue(folder.path(), small_render("later.json", &["--seed", "2", "-o", "later.pfm"])).assert_done();
    let read = |name: &str| fs::read(path(name)).unwrap();
    assert_eq!(read("later.pfm"), read("x2y.pfm"));
    assert_ne!(read("x1y.pfm"), read("x2y.pfm"));
    // In the middle of the way the ball is in the middle of the image.
    run(&["--time-at", "1", "-o", "still.pfm"]).assert_done();
    let resting = r#"{"etendue": 1, "camera": {"origin": [0, 0, 5]}, "lights": [{"type": "environment", "color": [1, 1, 1]}],
        "materials": [{"name": "black", "type": "black"}],
        "surfaces": [{"geometry": "sphere", "material": "black", "origin": [0, 0, 0], "radius": 1}]}"#;
    fs::write(path("resting.json"), resting).unwrap();
    etendue(folder.path(), small_render("resting.json", &["-o", "resting.pfm"])).assert_done();
    assert_eq!(read("still.pfm"), read("resting.pfm"));

    run(&["--frames", "1-3", "-o", "same.png"]).assert_refused("same.png: the frames would have the same name");
    run(&["--frames", "3-1", "-o", "a#.png"]).assert_refused_by_grammar("FIRST-LAST");
    run(&["--frames", "1", "--time-at", "1", "-o", "a#.png"]).assert_refused_by_grammar("cannot be used with");
    run(&["--frame-rate", "25", "-o", "a.png"]).assert_refused_by_grammar("--frames");
    run(&["--time-at", "NaN", "-o", "a.png"]).assert_refused_by_grammar("expected seconds");
    run(&["--integrator", "photon", "-o", "a.png"]).assert_refused("photon shows no motion");
    run(&["--integrator", "photon", "--time-at", "1", "--photons", "1000", "-o", "a.png"]).assert_done();
    run(&["--integrator", "sppm", "--photons", "1000", "-o", "a.png"]).assert_done();
    let still = |more: &[&str]| etendue(folder.path(), small_render("resting.json", more));
    still(&["--time-at", "1", "-o", "a.png"]).assert_refused("--time-at: nothing in the scene moves");
    still(&["--frames", "1", "-o", "a.png"]).assert_refused("--frames: nothing in the scene moves");
}

#[test]
fn time_limits_a_run() {
    let folder = folder();
    let cornell = scene("cornell.json");
    let start = Instant::now();
    let args = ["render", &cornell, "--resolution", "16x12", "--spp", "100000000", "--time", "0.3", "-o", "a.pfm"];
    let run = etendue(folder.path(), args);
    run.assert_done();
    // Ten times the limit and more, for a machine that is busy; without a limit it would take hours.
    assert!(start.elapsed() < Duration::from_secs(60), "{:?}", start.elapsed());
    assert!(output::read(&folder.path().join("a.pfm")).unwrap().mean()[0] > 0.0);
}

#[cfg(unix)]
#[test]
fn an_interrupt_writes_what_there_is() {
    let folder = folder();
    let cornell = scene("cornell.json");
    let args =
        ["render", &cornell, "--resolution", "16x12", "--spp", "100000000", "--progressive", "--output", "a.exr"];
    let mut child = command(folder.path(), args).spawn().unwrap();
    let path = folder.path().join("a.exr");
    let start = Instant::now();
    // With --progressive the file appears after the first pass: the run is under way.
    while !path.exists() && start.elapsed() < Duration::from_secs(60) && child.try_wait().unwrap().is_none() {
        std::thread::sleep(Duration::from_millis(10));
    }
    let run = interrupt(child, start);
    assert_eq!(run.code, Some(130), "{}", run.stderr);
    assert!(run.stderr.contains("stopped after "), "{}", run.stderr);
    assert!(output::read(&path).unwrap().mean()[0] > 0.0);
    assert_eq!(names(folder.path()), ["a.exr"]);
}

#[cfg(unix)]
#[test]
fn a_failing_write_has_exit_code_1_and_keeps_the_old_image() {
    let folder = folder();
    let cornell = scene("cornell.json");
    let path = folder.path().join("a.pfm");
    write_grey(&path, &[0.5]);
    let old = fs::read(&path).unwrap();
    // A limit of 1 block (512 bytes) per file stands for a full disk; the image needs 2304 bytes.
    let outcome = Command::new("sh")
        .arg("-c")
        .arg("trap '' XFSZ; ulimit -f 1; exec \"$0\" \"$@\"")
        .arg(program())
        .args(small_render(&cornell, &["--output", "a.pfm"]))
        .current_dir(folder.path())
        .output()
        .unwrap();
    let run = Run::from(outcome);
    assert_eq!(run.code, Some(1), "{}", run.stderr);
    assert!(run.stderr.contains("error: a.pfm: cannot write the image"), "{}", run.stderr);
    assert_eq!(fs::read(&path).unwrap(), old);
    assert_eq!(names(folder.path()), ["a.pfm"]);
}

#[cfg(unix)]
#[test]
fn a_reader_that_has_seen_enough_is_no_failure() {
    let folder = folder();
    write_grey(&folder.path().join("a.pfm"), &[0.5]);
    let script = "\"$0\" compare a.pfm a.pfm 2> errors; echo $? > code";
    let mut shell = Command::new("sh");
    shell.arg("-c").arg(script).arg(program()).current_dir(folder.path()).stdout(Stdio::piped());
    let mut child = shell.spawn().unwrap();
    // Nobody reads: the pipe is closed before anything is written to it.
    drop(child.stdout.take());
    assert!(child.wait().unwrap().success());
    assert_eq!(fs::read_to_string(folder.path().join("errors")).unwrap(), "");
    assert_eq!(fs::read_to_string(folder.path().join("code")).unwrap(), "0\n");
}

/// A square of side 2 under a point light.
const SQUARE: &str = r#"{
    "etendue": 1,
    "camera": {"origin": [0, 1, 3], "lookAt": [0, 0, 0], "up": [0, 1, 0], "fieldOfView": 60},
    "materials": [{"name": "grey", "type": "diffuse", "color": [0.5, 0.5, 0.5]}],
    "lights": [{"type": "point", "origin": [0, 2, 0], "color": [8, 4, 2]}],
    "surfaces": [
        {"geometry": "quad", "vertex-1": [-1, 0, -1], "vertex-2": [-1, 0, 1], "vertex-3": [1, 0, 1],
         "vertex-4": [1, 0, -1], "material": "grey"}
    ]
}"#;

#[test]
fn bake_writes_map_atlas_vertices_and_summary() {
    let folder = folder();
    fs::write(folder.path().join("square.json"), SQUARE).unwrap();
    let args = ["bake", "square.json", "-o", "light", "--texels-per-unit", "8", "--spp", "64", "--spacing", "0.25"];
    let run = etendue(folder.path(), args.iter().chain(&["--threads", "2"]));
    run.assert_done();
    assert!(run.stderr.contains("20 x 20 texels, 1 charts"), "{}", run.stderr);
    assert_eq!(names(folder.path()), ["light.exr", "light.json", "light.obj", "light.ply", "square.json"]);
    // E = I cos / d^2, in the map's middle I / 4.
    let map = output::read(&folder.path().join("light.exr")).unwrap();
    assert_eq!((map.width, map.height), (20, 20));
    let middle = map.pixel(10, 10);
    for (found, intensity) in middle.iter().zip([8.0, 4.0, 2.0]) {
        assert!((found / (intensity / 4.0) - 1.0).abs() < 0.01, "{middle:?}");
    }
    let coverage = &map.layer("coverage").expect("the layer").data;
    assert_eq!(coverage.iter().filter(|&&share| share > 0.999).count(), 16 * 16);
    assert_eq!(map.layer("error").expect("the layer").channels, 3);
    // The OBJ reads as a mesh whose own coordinates are that layout: a bake of it is the same map.
    let obj = fs::read_to_string(folder.path().join("light.obj")).unwrap();
    assert_eq!(obj.lines().filter(|line| line.starts_with("f ")).count(), 2);
    assert!(obj.contains("\no surface_0\n"), "{obj}");
    let again = SQUARE.replace(
        r#"{"geometry": "quad", "vertex-1": [-1, 0, -1], "vertex-2": [-1, 0, 1], "vertex-3": [1, 0, 1],
         "vertex-4": [1, 0, -1], "#,
        r#"{"geometry": "mesh", "file": "light.obj", "#,
    );
    fs::write(folder.path().join("own.json"), again).unwrap();
    let args = ["bake", "own.json", "-o", "again", "--only", "map", "--layout", "own", "--resolution", "20"];
    etendue(folder.path(), args.iter().chain(&["--spp", "64"])).assert_done();
    let same = output::read(&folder.path().join("again.exr")).unwrap();
    let same_coverage = &same.layer("coverage").expect("the layer").data;
    for (i, share) in coverage.iter().enumerate() {
        assert!((share - same_coverage[i]).abs() < 1e-3, "texel {i}");
        if *share > 0.999 {
            assert!((map.rgb[3 * i] / same.rgb[3 * i] - 1.0).abs() < 0.02, "texel {i}");
        }
    }
    assert!(!folder.path().join("again.ply").exists());
    // Vertices: the header, then 13 x 13 of 24 + 12 + 3 + 36 + 4 bytes, and 288 triangles of 13.
    let ply = fs::read(folder.path().join("light.ply")).unwrap();
    let end = b"end_header\n";
    let header = ply.windows(end.len()).position(|bytes| bytes == end).expect("a header") + end.len();
    assert!(String::from_utf8_lossy(&ply[..header]).contains("element vertex 169\n"));
    assert_eq!(ply.len() - header, 169 * 79 + 288 * 13);
    let summary: serde_json::Value =
        serde_json::from_str(&fs::read_to_string(folder.path().join("light.json")).unwrap()).unwrap();
    assert_eq!(summary["map"]["side"], 20);
    assert_eq!(summary["map"]["coveredTexels"], 256);
    assert_eq!(summary["map"]["ended"], "samples");
    assert_eq!(summary["vertices"]["vertices"], 169);
    assert_eq!(summary["surfaces"][0], "surfaces[0]");
}

#[test]
fn a_bake_spares_what_it_reads() {
    let folder = folder();
    let obj = "v -1 0 -1\nv -1 0 1\nv 1 0 1\nf 1 2 3\n";
    fs::create_dir(folder.path().join("sub")).unwrap();
    fs::write(folder.path().join("sub/floor.obj"), obj).unwrap();
    let quad = SQUARE.find(r#"{"geometry": "quad""#).expect("the quad");
    let end = SQUARE.rfind("\n    ]").expect("the end of the surfaces");
    let floor = r#"{"geometry": "mesh", "file": "sub/floor.obj", "material": "grey"}"#;
    let scene = format!("{}{floor}{}", &SQUARE[..quad], &SQUARE[end..]);
    fs::write(folder.path().join("room.json"), &scene).unwrap();
    let bake = |args: &[&str]| etendue(folder.path(), ["bake"].iter().chain(args).chain(&["--spp", "1"]));
    bake(&["room.json", "-o", "sub/../sub/floor"]).assert_refused("floor.obj: is read as the scene");
    assert_eq!(fs::read_to_string(folder.path().join("sub/floor.obj")).unwrap(), obj);
    assert_eq!(names(&folder.path().join("sub")), ["floor.obj"]);
    // Vertices alone leave it alone.
    bake(&["room.json", "-o", "sub/floor", "--only", "vertices"]).assert_done();
    assert_eq!(fs::read_to_string(folder.path().join("sub/floor.obj")).unwrap(), obj);
    let path = folder.path().join("odd.exr");
    fs::copy(folder.path().join("room.json"), &path).unwrap();
    bake(&["odd.exr", "-o", "odd"]).assert_refused("odd.exr: is read as the scene");
    assert_eq!(fs::read_to_string(&path).unwrap(), scene);
    // Names that are none, and two names of one file.
    bake(&["room.json", "-o", "-"]).assert_refused("is no beginning of a file's name");
    bake(&["room.json", "-o", "new/"]).assert_refused("new/: is no beginning of a file's name");
    #[cfg(unix)]
    {
        for name in ["two.obj", "two.ply"] {
            std::os::unix::fs::symlink("one", folder.path().join(name)).unwrap();
        }
        fs::write(folder.path().join("one"), "").unwrap();
        bake(&["room.json", "-o", "two"]).assert_refused("is one file with another output");
        assert_eq!(fs::read(folder.path().join("one")).unwrap(), b"");
    }
}

#[test]
fn a_bake_by_radiosity_says_what_it_is_worth() {
    let folder = folder();
    // A black wall and a mirror beside the square, which reflects all.
    let white = SQUARE.replace(
        "[0.5, 0.5, 0.5]}",
        r#"[1, 1, 1]}, {"name": "mirror", "type": "reflective"}, {"name": "soot", "type": "black"}"#,
    );
    let surface = |material: &str, x: i32| {
        let corners = [[x, 1, -1], [x, 1, 1], [x, 0, 1]];
        let [a, b, c] = corners.map(|corner| format!("{corner:?}"));
        format!(
            r#"{{"geometry": "triangle", "vertex-1": {a}, "vertex-2": {b}, "vertex-3": {c}, "material": "{material}"}}"#
        )
    };
    let end = white.rfind("\n    ]").expect("the end of the surfaces");
    let scene = format!("{}, {}, {}{}", &white[..end], surface("mirror", -1), surface("soot", -2), &white[end..]);
    fs::write(folder.path().join("scene.json"), &scene).unwrap();
    let bake = |args: &[&str]| {
        let fixed = ["bake", "scene.json", "-o", "light", "--resolution", "32", "--method", "radiosity"];
        etendue(folder.path(), fixed.iter().chain(args))
    };
    let run = bake(&["-q"]);
    run.assert_done();
    let lines: Vec<&str> = run.stderr.lines().collect();
    assert_eq!(lines.len(), 2, "{}", run.stderr);
    assert!(lines[0].contains("1 surfaces as black, being mirrors or glass: surfaces[1] (mirror)"), "{}", run.stderr);
    assert!(
        lines[1].contains("no irradiance for 2 surfaces") && lines[1].contains("surfaces[2] (soot)"),
        "{}",
        run.stderr
    );
    let summary: serde_json::Value =
        serde_json::from_str(&fs::read_to_string(folder.path().join("light.json")).unwrap()).unwrap();
    for part in ["map", "vertices"] {
        let part = &summary[part];
        assert_eq!((&part["ended"], &part["samples"]), (&serde_json::Value::Null, &0.into()));
        let solution = &part["radiosity"];
        assert!(solution["elements"].as_u64() > Some(0) && solution["residual"].as_f64() < Some(1e-3), "{solution}");
        // It reflects all, but onto nothing: there is nothing left.
        assert_eq!(solution["errorBound"].as_f64(), Some(0.0), "{solution}");
        assert!(solution["emitted"][0].as_f64() > Some(100.0), "{solution}");
    }
    // Time that is too short is said to be, and leaves what there was.
    let old = fs::read(folder.path().join("light.exr")).unwrap();
    let run = bake(&["--time", "1e-9"]);
    assert_eq!(run.code, Some(1), "{}", run.stderr);
    assert!(run.stderr.contains("error: --time was over before the radiosity solution was there"), "{}", run.stderr);
    assert_eq!(fs::read(folder.path().join("light.exr")).unwrap(), old);
    assert_eq!(names(folder.path()), ["light.exr", "light.json", "light.obj", "light.ply", "scene.json"]);
}

#[cfg(unix)]
#[test]
fn an_interrupted_bake_by_radiosity_writes_what_is_whole() {
    let folder = folder();
    fs::copy(scene("cornell.json"), folder.path().join("slow.json")).unwrap();
    // The map's elements are large, those of the vertices small.
    let args = ["bake", "slow.json", "-o", "l", "--method", "radiosity", "--resolution", "48", "--spacing", "4"];
    let mut child = command(folder.path(), args).spawn().unwrap();
    let start = Instant::now();
    // The coordinates are written last of the map.
    let is_under_way = || folder.path().join("l.obj").exists() || start.elapsed() > Duration::from_secs(60);
    while !is_under_way() && child.try_wait().unwrap().is_none() {
        std::thread::sleep(Duration::from_millis(10));
    }
    std::thread::sleep(Duration::from_millis(100));
    let run = interrupt(child, start);
    assert_eq!(run.code, Some(130), "{}", run.stderr);
    assert!(run.stderr.contains("warning: stopped before there was anything to write: no vertices"), "{}", run.stderr);
    assert_eq!(names(folder.path()), ["l.exr", "l.json", "l.obj", "slow.json"]);
    let summary: serde_json::Value =
        serde_json::from_str(&fs::read_to_string(folder.path().join("l.json")).unwrap()).unwrap();
    assert!(summary["map"].is_object() && summary["vertices"].is_null(), "{summary}");
}

#[test]
fn bakes_that_cannot_be_done_have_exit_code_2() {
    let folder = folder();
    fs::write(folder.path().join("square.json"), SQUARE).unwrap();
    let empty = r#"{"etendue": 1, "camera": {"origin": [0, 1, 3], "lookAt": [0, 0, 0]}, "surfaces": []}"#;
    fs::write(folder.path().join("empty.json"), empty).unwrap();
    let bake = |args: &[&str]| etendue(folder.path(), ["bake"].iter().chain(args));
    for args in [
        &["square.json"][..],
        &["square.json", "-o", "l", "--resolution", "0"],
        &["square.json", "-o", "l", "--resolution", "8193"],
        &["square.json", "-o", "l", "--texels-per-unit", "0"],
        &["square.json", "-o", "l", "--texels-per-unit", "-3"],
        &["square.json", "-o", "l", "--texels-per-unit", "nan"],
        &["square.json", "-o", "l", "--gutter", "65"],
        &["square.json", "-o", "l", "--spacing", "0"],
        &["square.json", "-o", "l", "--only", "light"],
        &["square.json", "-o", "l", "--layout", "best"],
        &["square.json", "-o", "l", "--spp", "0"],
        &["square.json", "-o", "l", "--memory", "0"],
    ] {
        let run = bake(args);
        assert_eq!((run.code, run.stdout.as_str()), (Some(2), ""), "{args:?}: {}", run.stderr);
        assert!(!run.stderr.contains("panicked"), "{args:?}: {}", run.stderr);
    }
    bake(&["missing.json", "-o", "no/where/l"]).assert_refused("no/where/l");
    bake(&["square.json", "-o", "square"]).assert_refused("is read as the scene");
    bake(&["square.json", "-o", "l", "--texels-per-unit", "1e6"]).assert_refused("at most 8192 x 8192");
    let run = bake(&["empty.json", "-o", "l"]);
    assert_eq!(run.code, Some(2));
    assert!(run.stderr.contains("no surface"), "{}", run.stderr);
    let run = bake(&["square.json", "-o", "l", "--resolution", "8192", "--memory", "100"]);
    assert_eq!(run.code, Some(1), "{}", run.stderr);
    assert!(run.stderr.contains("8192 x 8192"), "{}", run.stderr);
    assert_eq!(names(folder.path()), ["empty.json", "square.json"]);
}

/// A render with a checkpoint, for the tests of these.
fn kept_render<'a>(scene: &'a str, more: &[&'a str]) -> Vec<&'a str> {
    let mut args = vec!["render", scene, "--resolution", "40x36", "--checkpoint", "state"];
    args.extend(more);
    args
}

/// A run that is killed at any time leaves a checkpoint from which the next goes on to the same image.
#[test]
fn a_killed_render_goes_on_from_its_checkpoint() {
    let folder = folder();
    let room = scene("caustic-room.json");
    let state = folder.path().join("state");
    for (integrator, samples) in [("path", "512"), ("sppm", "48")] {
        let common =
            ["--integrator", integrator, "--spp", samples, "--photons", "20000", "--caustic-photons", "20000", "-q"];
        let whole = ["render", &room, "--resolution", "40x36", "-o", "whole.pfm"];
        etendue(folder.path(), whole.into_iter().chain(common)).assert_done();
        let run = |more: &[&str]| {
            let mut args = kept_render(&room, &common);
            args.extend(if state.exists() { ["--resume", "state"].as_slice() } else { &[] });
            args.extend(more);
            command(folder.path(), args)
        };
        let mut kills = 0;
        for milliseconds in [30, 0, 60, 10, 90].into_iter().cycle().take(25) {
            let before = fs::read(&state).unwrap_or_default();
            let mut child = run(&["--checkpoint-every", "0.01"]).spawn().unwrap();
            // Until the run has replaced the checkpoint at least once, or has ended.
            while fs::read(&state).unwrap_or_default() == before && child.try_wait().unwrap().is_none() {
                std::thread::sleep(Duration::from_millis(2));
            }
            std::thread::sleep(Duration::from_millis(milliseconds));
            if child.try_wait().unwrap().is_some() {
                if kills > 0 {
                    break;
                }
                // Other processes held this one up for as long as the render took.
                fs::remove_file(&state).unwrap();
                continue;
            }
            child.kill().unwrap();
            child.wait().unwrap();
            kills += 1;
            etendue::render::Checkpoint::read(&state).unwrap();
            if kills == 5 {
                break;
            }
        }
        assert!(kills > 0, "no run could be killed");
        Run::from(run(&["-o", "resumed.pfm"]).output().unwrap()).assert_done();
        let [whole, resumed] = ["whole.pfm", "resumed.pfm"].map(|name| fs::read(folder.path().join(name)).unwrap());
        assert!(whole == resumed, "{integrator}");
        fs::remove_file(&state).unwrap();
    }
}

#[test]
fn parts_of_a_picture_are_merged() {
    let folder = folder();
    let cornell = scene("cornell.json");
    let size = ["--resolution", "70x50", "--spp", "4", "--threads", "2", "-q"];
    for (part, share) in [("a", "1/3"), ("b", "2/3"), ("c", "3/3")] {
        let args = ["render", &cornell, "--checkpoint", part, "--share", share].into_iter().chain(size);
        etendue(folder.path(), args).assert_done();
    }
    etendue(folder.path(), ["render", &cornell, "-o", "whole.pfm"].into_iter().chain(size)).assert_done();
    let run = etendue(folder.path(), ["merge", "c", "a", "b", "-o", "merged.pfm", "merged.exr", "--checkpoint", "all"]);
    run.assert_done();
    assert!(run.stderr.contains("merged 3 checkpoints: 4 samples per pixel"), "{}", run.stderr);
    let [whole, merged] = ["whole.pfm", "merged.pfm"].map(|name| fs::read(folder.path().join(name)).unwrap());
    assert!(whole == merged);
    assert!(output::read(&folder.path().join("merged.exr")).unwrap().layer("albedo").is_some());
    // What was merged is a checkpoint of the whole.
    etendue(folder.path(), ["merge", "all", "-o", "again.pfm", "-q"]).assert_done();
    assert!(whole == fs::read(folder.path().join("again.pfm")).unwrap());

    let merge = |args: &[&str]| etendue(folder.path(), ["merge"].iter().chain(args).chain(&["-o", "x.pfm"]));
    merge(&["a", "c"]).assert_refused("of 3 shares, these are missing: 2");
    merge(&["a", "b", "c", "b"]).assert_refused("share 2 is given twice");
    merge(&["a", "whole.pfm", "c"]).assert_refused("whole.pfm: this is no checkpoint of a render");
    merge(&["a", "none"]).assert_refused("none: cannot open the file");
    let mut bytes = fs::read(folder.path().join("b")).unwrap();
    let middle = bytes.len() / 2;
    bytes[middle] ^= 4;
    fs::write(folder.path().join("b"), bytes).unwrap();
    merge(&["a", "b", "c"]).assert_refused("b: the checkpoint is damaged: a checksum does not match");
    assert!(!folder.path().join("x.pfm").exists());

    let resume =
        |args: &[&str]| etendue(folder.path(), ["render", "-o", "x.pfm", "--resume", "all"].iter().chain(args));
    let room = scene("room.json");
    resume(&[&room, "--resolution", "70x50", "--spp", "4"])
        .assert_refused("all: the checkpoint was made of another scene");
    let other = ["--resolution", "70x50", "--seed", "7"];
    resume(&[&[cornell.as_str()], other.as_slice()].concat())
        .assert_refused("all: the checkpoint was made with `seed`");
    for (args, what) in [
        (["--share", "4/3", "--checkpoint", "d"].as_slice(), "expected a number from 1 to that of the parts"),
        (&["--share", "1/3"], "--checkpoint"),
        (&["--share", "one", "--checkpoint", "d"], "expected part K of N"),
        (&["--checkpoint", "d", "--frames", "1-2"], "--frames"),
    ] {
        let run = etendue(folder.path(), ["render", &cornell, "-o", "x.pfm"].iter().chain(args));
        run.assert_refused_by_grammar(what);
    }
    let share = ["render", &cornell, "--checkpoint", "d", "--share", "1/2", "--target-error", "0.1"];
    etendue(folder.path(), share).assert_refused("a share");
}

/// A full disk leaves the checkpoint before, and the image is written all the same.
#[cfg(unix)]
#[test]
fn a_checkpoint_that_cannot_be_written_is_told() {
    let folder = folder();
    let cornell = scene("cornell.json");
    let state = folder.path().join("state");
    let small = ["render", &cornell, "--resolution", "16x12", "--checkpoint", "state", "-q"];
    etendue(folder.path(), small.into_iter().chain(["--spp", "1"])).assert_done();
    let old = fs::read(&state).unwrap();
    // One that is there is not replaced by a render that does not go on from it.
    etendue(folder.path(), small).assert_refused("state: is there already");
    let args = small.into_iter().chain(["--spp", "4", "--resume", "state", "-o", "a.png"]);
    // A limit of 16 blocks (8192 bytes) per file stands for a full disk; the checkpoint needs more.
    let outcome = Command::new("sh")
        .arg("-c")
        .arg("trap '' XFSZ; ulimit -f 16; exec \"$0\" \"$@\"")
        .arg(program())
        .args(args)
        .current_dir(folder.path())
        .output()
        .unwrap();
    let run = Run::from(outcome);
    assert_eq!(run.code, Some(1), "{}", run.stderr);
    assert!(run.stderr.contains("error: state: cannot write the checkpoint"), "{}", run.stderr);
    assert!(fs::read(&state).unwrap() == old);
    assert_eq!(names(folder.path()), ["a.png", "state"]);
}

/// Presses Ctrl-C on a run that began at `start`, and waits for its end.
fn interrupt(mut child: std::process::Child, start: Instant) -> Run {
    let signal = Command::new("sh").arg("-c").arg(format!("kill -INT {}", child.id())).status().unwrap();
    assert!(signal.success());
    while child.try_wait().unwrap().is_none() {
        if start.elapsed() > Duration::from_secs(120) {
            child.kill().unwrap();
            panic!("the run did not stop");
        }
        std::thread::sleep(Duration::from_millis(10));
    }
    Run::from(child.wait_with_output().unwrap())
}
