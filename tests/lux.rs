//! `etendue lux`: tables, files and false-colour pictures of illuminance and luminance, and what is refused.

use std::fs;
use std::path::Path;
use std::process::{Command, Output, Stdio};

#[path = "common/program.rs"]
mod program;

use program::program;
use serde_json::Value;
use tempfile::TempDir;

/// A lamp of 2 W/sr in all channels, 2 above a black floor.
const LAMP: &str = r#"{
    "etendue": 1,
    "camera": {"origin": [0, 1, 5]},
    "materials": [{"name": "soot", "type": "diffuse", "color": [0, 0, 0]}],
    "lights": [{"type": "point", "origin": [0, 2, 0], "color": [2, 2, 2]}],
    "surfaces": [
        {"geometry": "quad", "material": "soot", "vertex-1": [-5, 0, -5], "vertex-2": [-5, 0, 5],
            "vertex-3": [5, 0, 5], "vertex-4": [5, 0, -5]}
    ]
}"#;

const GRIDS: &str = r#"{"grids": [
    {"name": "floor, left", "type": "plane", "origin": [-4, 0, 1], "u": [4, 0, 0], "v": [0, 0, -2], "counts": [2, 1]},
    {"name": "eye", "type": "points", "points": [[1, 2, 0], [0, 1, 0]], "normals": [[-1, 0, 0], [0, 1, 0]]},
    {"name": "square", "type": "luminance", "points": [[0, -1, 0], [0, 3, 0]], "directions": [[0, 2, 0], [0, 2, 0]]}
]}"#;

/// A square that shines downwards.
const SQUARE: &str = r#"{
    "etendue": 1,
    "camera": {"origin": [0, 1, 5]},
    "surfaces": [{"geometry": "quad", "vertex-1": [-1, 2, -1], "vertex-2": [1, 2, -1], "vertex-3": [1, 2, 1],
        "vertex-4": [-1, 2, 1], "emission": [3, 3, 3]}]
}"#;

/// A roof under an even sky of radiance 1, and a lamp that daylight factors do not count.
const ROOF: &str = r#"{
    "etendue": 1,
    "camera": {"origin": [0, 1, 5]},
    "materials": [{"name": "soot", "type": "diffuse", "color": [0, 0, 0]}],
    "lights": [
        {"type": "sky", "cie": 5, "color": [1, 1, 1]},
        {"type": "point", "origin": [0, 2, 0], "color": [900, 900, 900]},
        {"type": "distant", "sun": [0, 1, 1], "color": [50, 50, 50]}
    ],
    "surfaces": [{"geometry": "disk", "origin": [0, 3, 0], "normal": [0, -1, 0], "radius": 3, "material": "soot"}]
}"#;

struct Run {
    code: Option<i32>,
    stdout: String,
    stderr: String,
}

fn folder() -> TempDir {
    let folder = tempfile::tempdir().expect("a temporary folder");
    for (name, text) in [("lamp.json", LAMP), ("grids.json", GRIDS), ("roof.json", ROOF)] {
        fs::write(folder.path().join(name), text).expect("a file of the test");
    }
    folder
}

fn lux(folder: &Path, args: &[&str]) -> Run {
    let mut command = Command::new(program());
    command.current_dir(folder).arg("lux").args(args).stdin(Stdio::null());
    let Output { status, stdout, stderr } = command.output().expect("the program runs");
    let text = |bytes| String::from_utf8(bytes).expect("UTF-8");
    Run { code: status.code(), stdout: text(stdout), stderr: text(stderr) }
}

fn close(found: f64, expected: f64, relative: f64) -> bool {
    (found / expected - 1.0).abs() <= relative
}

#[test]
fn grids_of_a_file_are_written_as_tables_and_pictures() {
    let folder = folder();
    let outputs = ["-o", "out.csv", "out.json", "out.png", "--spp", "64", "--threads", "2"];
    let run = lux(folder.path(), &[&["lamp.json", "--grid", "grids.json"][..], &outputs].concat());
    assert_eq!(run.code, Some(0), "{}", run.stderr);
    for words in ["floor, left: illuminance", "eye: illuminance, 2 points", "square: luminance", "U0", "cd/m²"] {
        assert!(run.stdout.contains(words), "'{words}' is not in: {}", run.stdout);
    }
    let json: Value = serde_json::from_str(&fs::read_to_string(folder.path().join("out.json")).unwrap()).unwrap();
    let value = |grid: usize, point: usize| json["grids"][grid]["values"][point].as_f64().unwrap();
    // I cos / d^2 = 2 h / d^3 at (-3, 0, 0) and (-1, 0, 0); beside the lamp, and 1 below it.
    let below = |x: f64| 683.0 * 2.0 * 2.0 / (4.0 + x * x).powf(1.5);
    for (found, expected) in
        [(value(0, 0), below(3.0)), (value(0, 1), below(1.0)), (value(1, 0), 1366.0), (value(1, 1), 1366.0)]
    {
        assert!(close(found, expected, 1e-5), "{found}, expected {expected}");
    }
    assert_eq!([value(2, 0), value(2, 1)], [0.0; 2], "the lamp is a point, and the floor is black");
    let figures = &json["grids"][0]["figures"];
    let mean = 0.5 * (below(3.0) + below(1.0));
    assert!(close(figures["mean"].as_f64().unwrap(), mean, 1e-5));
    assert!(close(figures["uniformity"].as_f64().unwrap(), below(3.0) / mean, 1e-5));
    let csv = fs::read_to_string(folder.path().join("out.csv")).unwrap();
    let lines: Vec<&str> = csv.lines().collect();
    assert_eq!((lines.len(), csv.matches("\r\n").count()), (7, 7), "{csv}");
    assert!(lines[1].starts_with("\"floor, left\",illuminance,lx,0,-3,0,0,0,1,0,"), "{csv}");
    let picture = etendue::output::read(&folder.path().join("out.png")).unwrap();
    assert!(picture.width > 480 && picture.height > 240, "{} x {}", picture.width, picture.height);
    // The brighter cell, on the right, has another colour than the darker one.
    assert_ne!(picture.pixel(30, 40), picture.pixel(480, 40));
}

#[test]
fn luminance_is_what_a_view_meets() {
    let folder = folder();
    fs::write(folder.path().join("square.json"), SQUARE).unwrap();
    let run = lux(folder.path(), &["square.json", "--grid", "grids.json", "-o", "out.json", "--spp", "16"]);
    assert_eq!(run.code, Some(0), "{}", run.stderr);
    let json: Value = serde_json::from_str(&fs::read_to_string(folder.path().join("out.json")).unwrap()).unwrap();
    let grid = &json["grids"][2];
    assert_eq!((&grid["quantity"], &grid["unit"]), (&Value::from("luminance"), &Value::from("cd/m²")));
    let [below, above] = [0, 1].map(|point| grid["values"][point].as_f64().unwrap());
    assert!(close(below, 3.0 * 683.0, 1e-5) && above == 0.0, "{below}, {above}");
}

#[test]
fn results_are_the_same_for_any_number_of_threads() {
    let folder = folder();
    let mut texts = Vec::new();
    for threads in ["1", "2"] {
        let file = format!("{threads}.csv");
        let plane = ["--plane", "-4,0,4", "8,0,0", "0,0,-8", "30x20", "--error", "0.02"];
        let run = lux(
            folder.path(),
            &[&["roof.json", "--seed", "7", "--threads", threads, "-o", &file][..], &plane].concat(),
        );
        assert_eq!(run.code, Some(0), "{}", run.stderr);
        texts.push(fs::read(folder.path().join(file)).unwrap());
    }
    assert!(texts[0].len() > 600 * 40 && texts[0] == texts[1]);
}

#[test]
fn daylight_factors_count_the_sky_alone() {
    let folder = folder();
    // Nor do what shines by its material and lamps that move.
    let glowing = ROOF.replace("\"color\": [0, 0, 0]", "\"color\": [0, 0, 0], \"emission\": [70, 70, 70]").replace(
        "[900, 900, 900]",
        "[900, 900, 900], \"motion\": [{\"time\": 0}, {\"time\": 1, \"translate\": [1, 0, 0]}]",
    );
    fs::write(folder.path().join("glowing.json"), glowing).unwrap();
    for scene in ["roof.json", "glowing.json"] {
        let args = [scene, "--daylight", "--plane", "-0.01,0,0.01", "0.02,0,0", "0,0,-0.02", "1x1"];
        let run = lux(folder.path(), &[&args[..], &["-o", "out.json", "--error", "0.002", "--threads", "2"]].concat());
        assert_eq!(run.code, Some(0), "{}", run.stderr);
        let json: Value = serde_json::from_str(&fs::read_to_string(folder.path().join("out.json")).unwrap()).unwrap();
        let outside = json["exterior"]["illuminance"].as_f64().unwrap();
        assert!(close(outside, 683.0 * std::f64::consts::PI, 1e-3), "{outside}");
        // A disk as wide as it is high hides sin^2 45 degrees of the light.
        let factors = &json["grids"][0]["daylightFactors"];
        let [factor, error] = ["values", "standardErrors"].map(|key| factors[key][0].as_f64().unwrap());
        assert!(error < 0.004 * factor && (factor - 0.5).abs() < 5.0 * error, "{factor} ± {error}");
        assert!(run.stdout.contains("% of outside"), "{}", run.stdout);
    }
}

#[test]
fn views_from_a_surface_do_not_meet_it() {
    let folder = folder();
    // A slope under an even sky of radiance 1.
    let slope = r#"{
        "etendue": 1,
        "camera": {"origin": [0, 1, 5]},
        "lights": [{"type": "environment", "color": [1, 1, 1]}],
        "materials": [{"name": "soot", "type": "diffuse", "color": [0, 0, 0]}],
        "surfaces": [{"geometry": "quad", "material": "soot", "vertex-1": [-3, -1, 1.7], "vertex-2": [3, 1.3, 1.7],
            "vertex-3": [3, 1.3, -1.7], "vertex-4": [-3, -1, -1.7]}]
    }"#;
    fs::write(folder.path().join("slope.json"), slope).unwrap();
    let points: Vec<String> =
        (0..100).map(|i| f64::from(i) / 40.0 - 1.2).map(|x| format!("[{x}, {}, 0.3]", 0.15 + 2.3 / 6.0 * x)).collect();
    let points = points.join(", ");
    let grids = format!(
        "{{\"grids\": [{{\"name\": \"up\", \"type\": \"luminance\", \"points\": [{points}], \"directions\": [[-2.3, 6, 0]]}}]}}"
    );
    fs::write(folder.path().join("views.json"), grids).unwrap();
    let run = lux(folder.path(), &["slope.json", "--grid", "views.json", "--spp", "16", "-o", "out.json"]);
    assert_eq!(run.code, Some(0), "{}", run.stderr);
    let json: Value = serde_json::from_str(&fs::read_to_string(folder.path().join("out.json")).unwrap()).unwrap();
    let values = json["grids"][0]["values"].as_array().unwrap();
    assert!(values.iter().all(|value| close(value.as_f64().unwrap(), 683.0, 1e-5)), "{values:?}");
}

#[test]
fn radiosity_takes_diffuse_scenes() {
    let folder = folder();
    let args = ["lamp.json", "--plane", "0,0,0", "1,0,0", "0,0,-1", "1x1", "--spp", "64", "--threads", "2"];
    let mut found = Vec::new();
    for method in ["path", "radiosity"] {
        let file = format!("{method}.json");
        let run = lux(folder.path(), &[&args[..], &["--method", method, "-o", &file]].concat());
        assert_eq!(run.code, Some(0), "{}", run.stderr);
        let json: Value = serde_json::from_str(&fs::read_to_string(folder.path().join(file)).unwrap()).unwrap();
        assert_eq!(json["method"], method);
        found.push(json["grids"][0]["values"][0].as_f64().unwrap());
    }
    assert!(close(found[0], found[1], 1e-3), "{found:?}");
    // Half of an even sky, past a roof.
    let args = ["roof.json", "--plane", "0,0,0", "1,0,0", "0,0,-1", "1x1", "--spp", "4096"];
    let mut found = Vec::new();
    for method in ["path", "radiosity"] {
        let file = format!("{method}.json");
        let run = lux(folder.path(), &[&args[..], &["--method", method, "-o", &file]].concat());
        assert_eq!(run.code, Some(0), "{}", run.stderr);
        let json: Value = serde_json::from_str(&fs::read_to_string(folder.path().join(file)).unwrap()).unwrap();
        found.push(json["grids"][0]["values"][0].as_f64().unwrap());
    }
    assert!(found[0] > 0.0 && close(found[0], found[1], 0.03), "{found:?}");
}

#[test]
fn what_cannot_be_done_is_refused_before_the_work() {
    let folder = folder();
    fs::write(folder.path().join("bad.json"), GRIDS.replace("[2, 1]", "[2, 0]")).unwrap();
    fs::write(folder.path().join("views.json"), GRIDS.replace("\"plane\", \"origin\"", "\"points\", \"origin\""))
        .unwrap();
    let shared =
        LAMP.replace("\"camera\"", "\"render\": {\"integrator\": {\"type\": \"path\", \"reuse\": true}}, \"camera\"");
    fs::write(folder.path().join("shared.json"), shared).unwrap();
    let plane = ["--plane", "0,0,0", "1,0,0", "0,0,-1", "2x2"];
    let with = |more: &[&'static str]| [&["lamp.json"], &plane[..], more].concat();
    for (args, words) in [
        (vec!["lamp.json"], "--grid"),
        (vec!["lamp.json", "--grid", "none.json"], "none.json: cannot open the file"),
        (vec!["lamp.json", "--grid", "bad.json"], "bad.json:2: grids[0].counts[1]: 0 is out of range"),
        (vec!["lamp.json", "--grid", "views.json"], "views.json:2: grids[0].origin: unknown key"),
        (vec!["lamp.json", "--plane", "0,0", "1,0,0", "0,0,1", "2x2"], "--plane '0,0': expected three numbers"),
        (vec!["lamp.json", "--plane", "0,0,0", "1,0,0", "0,0,1", "2"], "--plane '2': expected NxM"),
        (vec!["lamp.json", "--plane", "0,0,0", "1,0,0", "0,0,1", "2x0"], "--plane.counts[1]: 0 is out of range"),
        (vec!["lamp.json", "--plane", "0,0,0", "1,0,0", "9,0,0", "2x2"], "--plane.v: [9.0, 0.0, 0.0] is parallel"),
        (vec!["lamp.json", "--plane", "0,0,0", "1,0,0", "0,0,1", "2000x2000"], "4000000 points are too many"),
        (with(&["--normal", "0,0,0"]), "--plane.normal"),
        (with(&["-o", "out.exr"]), "expected a name that ends in .csv, .json or .png"),
        (with(&["-o", "lamp.json"]), "is read and cannot be written"),
        (with(&["-o", "a.csv", "a.csv"]), "given twice as an output"),
        (with(&["-o", "none/a.csv"]), "none"),
        (with(&["--daylight"]), "there is no environment or sky"),
        (with(&["--max-depth", "1", "--method", "radiosity"]), "--max-depth: a radiosity solution has no paths"),
        (with(&["--error", "0"]), "expected an error above 0"),
        (
            vec!["shared.json", "--grid", "grids.json"],
            "render.integrator.reuse is true, and light at given points has no neighbouring pixels",
        ),
        (with(&["--scale", "-3"]), "expected a number above 0"),
        (vec!["lamp.json", "--grid", "grids.json", "-o", "grids.json"], "is read and cannot be written"),
    ] {
        let run = lux(folder.path(), &args);
        assert_eq!((run.code, run.stdout.as_str()), (Some(2), ""), "{args:?}: {}", run.stderr);
        assert!(run.stderr.contains(words), "'{words}' is not in: {}", run.stderr);
    }
    let left: Vec<_> = fs::read_dir(folder.path()).unwrap().map(|entry| entry.unwrap().file_name()).collect();
    assert_eq!(left.len(), 6, "{left:?}");
}
