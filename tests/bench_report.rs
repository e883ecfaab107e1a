//! `etendue bench`: what it writes, what it refuses, and the report as a browser shows it.
//!
//! The browser is Chromium without a window, told what to do through its DevTools protocol. Where it is missing, the tests
//! of the page are skipped and say so; `scripts/setup.sh test` installs it. `ETENDUE_SCREENSHOTS=FOLDER` keeps pictures of
//! the page.

#[path = "bench_report/browser.rs"]
mod browser;
#[path = "common/program.rs"]
mod program;

use std::fs;
use std::path::Path;
use std::process::{Command, Output, Stdio};
use std::sync::OnceLock;
use std::thread;
use std::time::{Duration, Instant};

use browser::Browser;
use program::program;
use serde_json::{Value, json};
use tempfile::TempDir;

fn bench<S: AsRef<std::ffi::OsStr>>(folder: &Path, args: impl IntoIterator<Item = S>) -> Output {
    let mut command = Command::new(program());
    command.current_dir(folder).arg("bench").args(args).stdin(Stdio::null());
    command.output().expect("the program runs")
}

/// Runs it, and asserts that it went well.
fn done<S: AsRef<std::ffi::OsStr>>(folder: &Path, args: impl IntoIterator<Item = S>) {
    let output = bench(folder, args);
    assert_eq!(output.status.code(), Some(0), "{}", String::from_utf8_lossy(&output.stderr));
}

fn scene(name: &str) -> String {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes").join(name).to_str().expect("a UTF-8 path").to_owned()
}

fn results(path: &Path) -> Value {
    serde_json::from_str(&fs::read_to_string(path).expect("results")).expect("JSON")
}

/// Two scenes, two integrators, two budgets and numbers of threads, and another renderer's results: its name tries to
/// leave the script that the page holds it in.
fn measured() -> &'static Path {
    static FOLDER: OnceLock<TempDir> = OnceLock::new();
    let folder = FOLDER.get_or_init(|| {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let other = json!({
            "etendueBench": 1,
            "series": [{
                "renderer": "other</script><script>document.title = 'broken'</script>",
                "scene": "cornell",
                "name": "<img src=x onerror=alert(1)>",
                "picture": "other.png",
                "points": [{"samples": 4, "seconds": 0.5, "relMse": 0.2}, {"samples": 16, "seconds": 2, "relMse": 0.05}],
            }],
        });
        fs::write(folder.path().join("other.json"), other.to_string()).unwrap();
        image::RgbImage::from_pixel(32, 32, image::Rgb([90, 60, 30])).save(folder.path().join("other.png")).unwrap();
        let (cornell, mirrors) = (scene("cornell.json"), scene("mirrors.json"));
        let fixed = ["--resolution", "32x32", "--spp", "2,8", "--integrators", "path,direct", "--threads", "1,2"];
        let more = ["--runs", "3", "--reference-spp", "64", "--output", "out", "--include", "other.json", "--quiet"];
        done(folder.path(), [cornell.as_str(), mirrors.as_str()].into_iter().chain(fixed).chain(more));
        folder
    });
    folder.path()
}

#[test]
fn results_hold_what_was_asked_for() {
    let out = measured().join("out");
    let results = results(&out.join("results.json"));
    assert_eq!(
        (&results["etendueBench"], &results["complete"], &results["runs"]),
        (&json!(1), &json!(true), &json!(3))
    );
    for key in ["cpu", "os", "renderer", "embree", "build"] {
        assert!(results["machine"][key].as_str().is_some_and(|text| !text.is_empty()), "{key}");
    }
    let series = results["series"].as_array().unwrap();
    assert_eq!(series.len(), 2 * 2 * 2, "scenes x integrators x threads");
    for one in series {
        let points = one["points"].as_array().unwrap();
        let samples: Vec<_> = points.iter().map(|point| point["samples"].as_u64().unwrap()).collect();
        assert_eq!(samples, [2, 8]);
        for point in points {
            let number = |key: &str| point[key]["median"].as_f64().unwrap();
            assert!(number("seconds") > 0.0 && number("relMse") > 0.0 && number("raysPerSecond") > 0.0, "{point}");
            assert_eq!(point["runs"].as_array().unwrap().len(), 3);
            // One image is all noise and bias, and nothing else.
            let errors = point["runs"].as_array().unwrap().iter().map(|run| run["relMse"].as_f64().unwrap());
            let mean = errors.sum::<f64>() / 3.0;
            let parts = point["noise"].as_f64().unwrap() + point["bias"].as_f64().unwrap();
            assert!((mean / parts - 1.0).abs() < 1e-9, "{point}");
        }
        for key in ["picture", "errorMap", "linear"] {
            assert!(out.join(one[key].as_str().unwrap()).is_file(), "{key} of {one}");
        }
    }
    // The same seeds give the same images whatever the threads; direct light alone is too dark in a box.
    let find = |name: &str, threads: u64| {
        let is_it = |one: &&Value| one["scene"] == "cornell" && one["name"] == name && one["threads"] == threads;
        series.iter().find(is_it).unwrap()["points"][1].clone()
    };
    assert_eq!(find("path", 1)["relMse"], find("path", 2)["relMse"]);
    let (path, direct) = (find("path", 1), find("direct", 1));
    assert!((path["meanRatio"].as_f64().unwrap() - 1.0).abs() < 0.1, "{path}");
    assert!(direct["meanRatio"].as_f64().unwrap() < 0.8, "{direct}");
    assert!(direct["bias"].as_f64().unwrap() > 10.0 * direct["biasResolution"].as_f64().unwrap(), "{direct}");
    let markdown = fs::read_to_string(out.join("results.md")).unwrap();
    assert!(markdown.contains("| etendue 0.") && markdown.contains("direct, 2 threads | 8 |"), "{markdown}");
    assert!(markdown.contains("Reference: cornell-32x32, 64 samples per pixel, own noise "), "{markdown}");
    assert!(!markdown.contains("<img"), "a name is markup");
}

#[test]
fn a_report_is_made_again_without_rendering() {
    let folder = measured();
    let tables = folder.join("tables.md");
    fs::write(&tables, "a\n<!-- bench scenes -->\nold\n<!-- /bench -->\nb\n").unwrap();
    let args =
        ["--report-only", "out/results.json", "--include", "other.json", "--output", "again", "--tables", "tables.md"];
    done(folder, args);
    let page = |name: &str| fs::read_to_string(folder.join(name).join("report.html")).unwrap();
    assert_eq!(page("out"), page("again"));
    let filled = fs::read_to_string(&tables).unwrap();
    assert!(
        filled.starts_with("a\n<!-- bench scenes -->\n\n### cornell") && filled.ends_with("<!-- /bench -->\nb\n"),
        "{filled}"
    );
}

#[test]
fn references_that_are_there_are_used() {
    let folder = tempfile::tempdir().unwrap();
    let cornell = scene("cornell.json");
    let args = |name| {
        let fixed = ["--resolution", "16x16", "--spp", "1", "--runs", "1", "--reference-spp", "16", "--quiet"];
        [vec![cornell.as_str(), "--references", "references", "--output", name], fixed.to_vec()].concat()
    };
    done(folder.path(), args("first"));
    let file = folder.path().join("references/cornell-16x16.exr");
    let made = fs::read(&file).unwrap();
    done(folder.path(), args("second"));
    assert_eq!(fs::read(&file).unwrap(), made);
    let error = |name: &str| {
        results(&folder.path().join(name).join("results.json"))["series"][0]["points"][0]["relMse"].clone()
    };
    assert_eq!(error("first"), error("second"));
    // Standard errors beside it count instead of its own variance: those of 0.1 take off more.
    let image = etendue::output::read(&file).unwrap();
    let flat = etendue::film::Image { rgb: vec![0.1; 3 * 256], layers: Vec::new(), ..image };
    etendue::output::write(&flat, &file.with_file_name("cornell-16x16.se.exr"), &Default::default()).unwrap();
    done(folder.path(), args("third"));
    let number = |name| error(name)["median"].as_f64().unwrap();
    assert!(number("third") < number("first"), "{} is not below {}", number("third"), number("first"));
}

#[test]
fn a_reference_follows_its_scene_and_its_samples() {
    let folder = tempfile::tempdir().unwrap();
    let text = fs::read_to_string(scene("cornell.json")).unwrap();
    let scene = folder.path().join("box.json");
    fs::write(&scene, &text).unwrap();
    let file = folder.path().join("out/references/box-8x8.exr");
    let render = |samples: &str| {
        let args = ["box.json", "--resolution", "8x8", "--spp", "1,1", "--runs", "1", "--output", "out", "--quiet"];
        done(folder.path(), args.into_iter().chain(["--threads", "1,1", "--reference-spp", samples]));
        fs::read(&file).unwrap()
    };
    let first = render("32");
    let results = results(&folder.path().join("out/results.json"));
    let series = results["series"].as_array().unwrap();
    assert_eq!((series.len(), series[0]["points"].as_array().unwrap().len()), (1, 1), "something is measured twice");
    let origin = self::results(&file.with_extension("json"));
    assert_eq!(origin["samples"], 32);
    assert_eq!(render("16"), first, "fewer samples are no reason");
    let more = render("64");
    assert_ne!(more, first);
    fs::write(&scene, text + "\n").unwrap();
    render("64");
    assert_ne!(self::results(&file.with_extension("json"))["sceneHash"], origin["sceneHash"]);
    // One that nothing is known of is somebody's, and stays.
    fs::write(&file, &first).unwrap();
    fs::remove_file(file.with_extension("json")).unwrap();
    assert_eq!(render("256"), first);
    assert!(!file.with_extension("json").exists());
}

#[test]
fn what_cannot_go_well_is_refused_before_the_first_ray() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    fs::create_dir_all(at("a")).unwrap();
    fs::create_dir_all(at("taken/report.html")).unwrap();
    fs::copy(scene("mirrors.json"), at("a/cornell.json")).unwrap();
    fs::write(at("text.png"), "no picture").unwrap();
    let other = |picture: &str, seconds: f64| {
        let points = json!([{"seconds": seconds, "relMse": 0.1}]);
        let series = json!([{"renderer": "other", "scene": "none", "picture": picture, "points": points}]);
        json!({"etendueBench": 1, "series": series}).to_string()
    };
    fs::write(at("above.json"), other("../text.png", 1.0)).unwrap();
    fs::write(at("text.json"), other("text.png", 1.0)).unwrap();
    fs::write(at("folder.json"), other("a", 1.0)).unwrap();
    fs::write(at("time.json"), other("text.png", 0.0)).unwrap();
    let cornell = scene("cornell.json");
    for (args, expected) in [
        (vec!["a/cornell.json"], vec!["cornell.json and a/cornell.json are both called 'cornell'"]),
        (vec!["--output", "taken"], vec!["taken/report.html", "not a regular file"]),
        (vec!["--include", "above.json"], vec!["above.json", "series[0].picture", "does not lead"]),
        (vec!["--include", "text.json"], vec!["text.json", "series[0].picture", "not a PNG file"]),
        (vec!["--include", "folder.json"], vec!["folder.json", "series[0].picture", "not a regular file"]),
        (vec!["--include", "time.json"], vec!["time.json", "series[0].points[0].seconds", "0 is out of range"]),
        (vec!["--include", "a"], vec!["not a regular file"]),
    ] {
        let output = bench(folder.path(), [cornell.as_str()].into_iter().chain(args.iter().copied()));
        let stderr = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(2), "{args:?}: {stderr}");
        expected.iter().for_each(|expected| assert!(stderr.contains(expected), "'{expected}' is not in: {stderr}"));
        assert!(!at("taken/results.json").exists() && !at("out").exists(), "{args:?}: something was rendered");
    }
}

/// Interrupts a benchmark of two images of each number of samples so long after its reference was made. The results, where there are any.
#[cfg(unix)]
fn interrupted(folder: &Path, wait: Duration) -> Option<serde_json::Value> {
    let cornell = scene("cornell.json");
    let mut command = Command::new(program());
    command.current_dir(folder).args(["bench", &cornell, "--resolution", "16x16", "--reference-spp", "16"]);
    command.args(["--spp", "1", "--time", "600", "--runs", "2", "--output", "out"]).stderr(Stdio::null());
    let mut child = command.spawn().expect("the program runs");
    let start = Instant::now();
    while !folder.join("out/references/cornell-16x16.json").exists() {
        assert!(start.elapsed() < Duration::from_secs(300), "no reference was made");
        thread::sleep(Duration::from_millis(20));
    }
    thread::sleep(wait);
    let signal = Command::new("kill").args(["-INT", &child.id().to_string()]).status().expect("kill");
    assert!(signal.success());
    assert_eq!(child.wait().expect("an end").code(), Some(130));
    let file = folder.join("out/results.json");
    file.exists().then(|| results(&file))
}

#[cfg(unix)]
#[test]
fn an_interrupted_benchmark_keeps_what_it_has() {
    // The first image, of one sample, is a matter of milliseconds, and the second of ten minutes. Other processes may hold up the first.
    for seconds in [2, 10, 60] {
        let folder = tempfile::tempdir().unwrap();
        let Some(results) = interrupted(folder.path(), Duration::from_secs(seconds)) else { continue };
        assert_eq!(results["complete"], false);
        let points = results["series"][0]["points"].as_array().expect("what was measured");
        assert_eq!((points.len(), points[0]["runs"].as_array().unwrap().len()), (1, 1), "{results}");
        let page = fs::read_to_string(folder.path().join("out/report.html")).unwrap();
        assert!(page.contains("\"complete\":false"));
        return;
    }
    panic!("nothing was measured within a minute");
}

#[test]
fn a_bad_suite_is_refused_with_its_line_and_path() {
    let folder = tempfile::tempdir().unwrap();
    let group = |more: &str| {
        let scene = scene("cornell.json");
        format!("{{\"etendueSuite\": 1, \"groups\": [\n {{\"name\": \"g\", \"scenes\": [{scene:?}],\n  {more}}}]}}")
    };
    for (text, expected) in [
        ("{}".to_owned(), "suite.json:1: missing field `etendueSuite`"),
        ("{\"etendueSuite\": 2, \"groups\": []}".to_owned(), "etendueSuite: the suite is of version 2"),
        ("{\"etendueSuite\": 1, \"groups\": []}".to_owned(), "groups: expected at least one"),
        (group("\"cases\": []"), "groups[0].cases: expected at least one"),
        (group("\"cases\": [{\"name\": \"a\"}, {\"name\": \"a\"}]"), "groups[0].cases[1].name: the name 'a' is given twice"),
        (group("\"cases\": [{\"name\": \"a\",\n \"spp\": 4}]"), "suite.json:4: groups[0].cases[0].spp: unknown field `spp`"),
        (group("\"samples\": [0], \"cases\": [{\"name\": \"a\"}]"), "groups[0].samples: 0 is out of range"),
        (
            group("\"cases\": [{\"name\": \"a\", \"render\": {\n \"shadowRays\": 0}}]"),
            "suite.json:4: groups[0].cases[0].render.shadowRays: 0 is out of range",
        ),
        (group("\"cases\": [{\"name\": \"a\", \"render\": 7}]"), "groups[0].cases[0].render: expected an object"),
        (
            "{\"etendueSuite\": 1, \"groups\": [{\"name\": \"g\", \"scenes\": [\"none.json\"], \"cases\": [{\"name\": \"a\"}]}]}".to_owned(),
            "none.json: cannot open the file",
        ),
    ] {
        fs::write(folder.path().join("suite.json"), &text).unwrap();
        let output = bench(folder.path(), ["--suite", "suite.json", "--output", "out"]);
        let stderr = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(2), "{text}: {stderr}");
        assert!(stderr.contains(expected), "'{expected}' is not in: {stderr}");
    }
    assert!(!folder.path().join("out").exists(), "a refused suite left something");
}

#[test]
fn suites_of_the_repository_can_be_read() {
    // A signal before the first ray would say nothing about the later groups, so one tiny run of each: the settings of all
    // cases are worked out before the first.
    let folder = tempfile::tempdir().unwrap();
    for suite in ["report.json", "default.json"] {
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("benches/suites").join(suite);
        let mut text: Value = results(&path);
        for group in text["groups"].as_array_mut().unwrap() {
            for scene in group["scenes"].as_array_mut().unwrap() {
                let from = path.parent().unwrap().join(scene.as_str().unwrap());
                *scene = json!(from);
            }
            // The million triangles are generated, and not always there.
            group["scenes"].as_array_mut().unwrap().retain(|scene| !scene.as_str().unwrap().contains("million"));
        }
        fs::write(folder.path().join(suite), text.to_string()).unwrap();
        let more =
            ["--resolution", "4x4", "--spp", "1", "--runs", "1", "--reference-spp", "16", "--output", "out", "--quiet"];
        done(folder.path(), ["--suite", suite].into_iter().chain(more));
    }
}

#[test]
fn a_browser_draws_the_report() {
    let Some(mut browser) = Browser::start() else { return };
    let page = measured().join("out/report.html");
    for width in [1400, 500] {
        browser.open(&page, width, 1000);
        // Curves: two points joined for each of five (four of ours, one of the other renderer) and four, and a guide each.
        let count =
            |browser: &mut Browser, what: &str| browser.value(&format!("document.querySelectorAll({what:?}).length"));
        assert_eq!(count(&mut browser, "#plot-0 path.curve"), 5);
        assert_eq!(count(&mut browser, "#plot-1 path.curve"), 4);
        assert_eq!(count(&mut browser, "#plot-0 circle.dot"), 10);
        assert_eq!(count(&mut browser, "#plot-0 path.spread"), 10);
        assert_eq!(count(&mut browser, "#plot-0 path.guide"), 1);
        assert_eq!(count(&mut browser, "#plot-0 tbody tr"), 10);
        assert_eq!(count(&mut browser, "#scaling path.curve"), 4);
        let bad = browser.value("[...document.querySelectorAll('svg *')].filter((e) => [...e.attributes].some((a) => /NaN|Infinity|undefined/.test(a.value))).length");
        assert_eq!(bad, 0, "a coordinate is not a number");
        // Time goes to the right and error upwards, on logarithmic axes.
        let place = browser.value("[...document.querySelectorAll('#plot-0 g[data-curve^=\"other\"] circle')].map((c) => [+c.getAttribute('cx'), +c.getAttribute('cy')])");
        let place: Vec<Vec<f64>> = serde_json::from_value(place).unwrap();
        assert!(place[0][0] < place[1][0] && place[0][1] < place[1][1], "{place:?}");
        // What is wider than the window can be scrolled in its own box.
        let overflow = browser.value("document.documentElement.scrollWidth - innerWidth");
        assert!(overflow.as_i64().unwrap() <= 0, "the page is {overflow} pixels too wide at {width}");
        // A name is text, whatever it looks like.
        assert_ne!(browser.value("document.title"), "broken");
        assert_eq!(count(&mut browser, "main img"), 0);
        browser.screenshot(&format!("page-{width}"));
        // Keys of the legend hide curves; a point says what it is.
        browser.value("document.querySelector('#plot-0 .key').click()");
        assert_eq!(browser.value("document.querySelector('#plot-0 g[data-curve]').style.display"), "none");
        browser.value("document.querySelector('#plot-0 .key').click()");
        browser.value("document.querySelectorAll('#plot-0 circle.dot')[1].focus()");
        let tip = browser.value("document.getElementById('tip').textContent");
        assert!(tip.as_str().unwrap().contains("8 samples per pixel"), "{tip}");
        // Ink on its page, light and dark: at least 7 : 1, as WCAG wants it for the best grade.
        for scheme in ["light", "dark"] {
            browser.prefer(scheme);
            let contrast = browser.value(CONTRAST).as_f64().expect("a ratio");
            assert!(contrast > 7.0, "{scheme}: {contrast}");
            browser.value("document.querySelector('#plot-0').scrollIntoView()");
            browser.screenshot(&format!("{scheme}-{width}"));
        }
        viewer(&mut browser, width);
        browser.assert_quiet(&page);
    }
}

/// The contrast of the page's text as WCAG 2 defines it.
const CONTRAST: &str = "(() => {
    const style = getComputedStyle(document.body);
    const luminance = (colour) => {
        const linear = (x) => (x <= 0.04045 ? x / 12.92 : ((x + 0.055) / 1.055) ** 2.4);
        const [r, g, b] = colour.match(/[0-9.]+/g).map((x) => linear(x / 255));
        return 0.2126 * r + 0.7152 * g + 0.0722 * b;
    };
    const [dark, light] = [style.color, style.backgroundColor].map(luminance).sort((a, b) => a - b);
    return (light + 0.05) / (dark + 0.05);
})()";

/// The viewer shows, flips, wipes, zooms and reads, by keys and by the mouse.
fn viewer(browser: &mut Browser, width: u32) {
    browser.value("document.querySelector('.stage').scrollIntoView({block: 'center'})");
    browser.wait("document.querySelector('.stage').dataset.shown === 'a'");
    // What is on the canvas: its middle pixels.
    let seen = "(() => { const c = document.querySelector('canvas.view'); \
                return [...c.getContext('2d').getImageData(c.width / 4, c.height / 4, c.width / 2, c.height / 2).data].reduce((h, x) => (31 * h + x) % 1000003, 7); })()";
    let shown = |browser: &mut Browser| browser.value("document.querySelector('.stage').dataset.shown");
    browser.value("document.querySelector('.stage').focus()");
    let a = browser.value(seen);
    browser.screenshot(&format!("viewer-{width}"));
    browser.key(" ", "Space");
    assert_eq!(shown(browser), "b");
    let b = browser.value(seen);
    assert_ne!(a, b, "the reference looks like a render of 8 samples");
    browser.click_in(".stage", 0.5, 0.5);
    assert_eq!(shown(browser), "a");
    assert_eq!(browser.value(seen), a);
    browser.key("m", "KeyM");
    assert_eq!(shown(browser), "wipe");
    let wipe = browser.value(seen);
    assert!(wipe != a && wipe != b, "a wipe shows one image only");
    browser.screenshot(&format!("wipe-{width}"));
    browser.key("m", "KeyM");
    assert_eq!(shown(browser), "side");
    browser.key("m", "KeyM");
    let scale = |browser: &mut Browser| {
        let scale = browser.value("document.querySelector('.stage').dataset.scale");
        scale.as_str().and_then(|scale| scale.parse::<f64>().ok()).expect("a scale")
    };
    let before = scale(browser);
    browser.key("+", "Equal");
    assert!((scale(browser) / before - 1.5).abs() < 1e-3);
    browser.key("0", "Digit0");
    assert!((scale(browser) / before - 1.0).abs() < 1e-3);
    // Errors are in colours, and have values.
    browser.key("e", "KeyE");
    assert_ne!(browser.value(seen), a);
    browser.screenshot(&format!("error-{width}"));
    browser.key("e", "KeyE");
    browser.move_in(".stage", 0.5, 0.5);
    let read = browser.value("document.querySelector('.viewer .out').textContent");
    let read = read.as_str().unwrap();
    assert!(read.contains("column 16, row 16") && read.contains("squared relative error"), "{read}");
    // Linear values are those of the render: green of the middle pixel, to a percent.
    let linear = browser.value(
        "(async () => { const s = RESULTS.series[0]; const d = await decode(s); return [...d.linear].reduce((a, b) => a + b) / d.linear.length; })()",
    );
    let reference = browser.value(
        "(async () => { const d = await decode(RESULTS.references[0]); return [...d.linear].reduce((a, b) => a + b) / d.linear.length; })()",
    );
    let ratio = linear.as_f64().unwrap() / reference.as_f64().unwrap();
    let said = browser.value("RESULTS.series[0].points[1].runs.length && RESULTS.series[0].points[1].meanRatio");
    assert!((ratio / said.as_f64().unwrap() - 1.0).abs() < 0.05, "{ratio} and {said}");
}
