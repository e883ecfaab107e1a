//! `bench SCENE...` and `bench --suite FILE`: time and error of many cases, and a report about them.

mod error;
mod html;
mod machine;
mod markdown;
mod measure;
mod pictures;
mod plan;
mod reference;
mod results;
mod suite;

use std::cell::Cell;
use std::fs;
use std::path::{Path, PathBuf};
use std::time::SystemTime;

use etendue::{Error, output};

use self::measure::Measure;
use self::results::{Group, Results};
use self::suite::Suite;
use crate::args::BenchArgs;
use crate::console::{self, Bar};
use crate::{Failure, interrupt};

/// Runs of each case by default.
const RUNS: u32 = 5;

/// Measures, or reads earlier results, and writes the report; returns [`interrupt::EXIT_CODE`] after a run that was
/// stopped.
pub fn bench(args: &BenchArgs) -> Result<u8, Failure> {
    // An hour of rendering must not end at a typing error: everything that can be checked in advance is checked now.
    let included = args.include.iter().map(|path| Results::load(path)).collect::<Result<Vec<_>, _>>()?;
    if let Some(tables) = &args.tables {
        markdown::blocks(&read(tables)?).map_err(|reason| Failure::usage(format!("{}: {reason}", tables.display())))?;
    }
    let folder = folder(args);
    let mut results = match &args.report_only {
        Some(path) => {
            let results = Results::load(path)?;
            check_targets(&folder, args)?;
            results
        }
        None => {
            let mut measured = measure(args, &folder)?;
            if interrupt::requested() && measured.series.is_empty() {
                console::warn("nothing was measured, and nothing written");
                return Ok(interrupt::EXIT_CODE);
            }
            let file = save(&mut measured, &folder)?;
            measured.read_pictures(&file).map_err(Failure::running)?;
            measured
        }
    };
    let is_complete = results.complete;
    included.into_iter().for_each(|other| include(&mut results, other));
    for series in results.unseen() {
        let (renderer, name, scene) = (&series.renderer, &series.name, &series.scene);
        console::warn(format!("'{renderer}, {name}' on '{scene}' is in no plot: nothing else was measured there"));
    }
    write(&folder.join("results.md"), &markdown::document(&results))?;
    let report = folder.join("report.html");
    write(&report, &html::page(results.clone())?)?;
    if let Some(tables) = &args.tables {
        let (text, missing) = markdown::fill(&read(tables)?, &results).map_err(Failure::running)?;
        for name in missing {
            console::warn(format!("{}: nothing was measured for the block '{name}'", tables.display()));
        }
        write(tables, &text)?;
    }
    if !args.quiet {
        console::say(&format!("{} {}", if is_complete { "done:" } else { "not complete:" }, report.display()));
    }
    Ok(if interrupt::requested() { interrupt::EXIT_CODE } else { 0 })
}

/// Renders and measures all cases, or those before Ctrl-C.
fn measure(args: &BenchArgs, folder: &Path) -> Result<Results, Failure> {
    let suite = match &args.suite {
        Some(path) => Suite::load(path)?,
        None => Suite::from_args(args)?,
    };
    interrupt::install()?;
    let jobs = plan::plan(&suite, args)?;
    let runs = args.runs.or(suite.runs).unwrap_or(RUNS);
    let references = args.references.clone().unwrap_or_else(|| folder.join("references"));
    check_targets(folder, args)?;
    let reference_samples = plan::reference_samples(&suite, &jobs, args);
    fs::create_dir_all(&references).map_err(|error| cannot_write(&references, error))?;
    for (job, case) in jobs.iter().flat_map(|job| job.cases.iter().map(move |case| (job, case))) {
        let name = reference::name(&job.scene, &case.desc);
        if !reference::is_current(&references, &name, &job.hash, reference_samples)? {
            reference::check_target(&references, &name)?;
        }
    }
    let points: usize = jobs.iter().flat_map(|job| &job.cases).map(|case| case.budgets.len()).sum();
    let mut measure = Measure {
        suite: &suite,
        runs,
        reference_samples,
        references,
        output: folder.to_owned(),
        bar: Bar::new(args.quiet),
        pictures: Cell::new(0),
        done: 0,
        total: points * runs as usize,
    };
    let group = |group: &suite::Group| Group {
        name: group.name.clone(),
        title: if group.title.is_empty() { group.name.clone() } else { group.title.clone() },
        description: group.description.clone(),
    };
    let mut results = Results {
        etendue_bench: 1,
        title: if suite.title.is_empty() { "Étendue benchmark".to_owned() } else { suite.title.clone() },
        description: suite.description.clone(),
        // The program's folder is private, so it is removed from the command.
        command: std::iter::once("etendue".to_owned()).chain(std::env::args().skip(1)).collect(),
        runs,
        groups: suite.groups.iter().map(group).collect(),
        ..Results::default()
    };
    interrupt::begin();
    for job in &jobs {
        let ended = measure.job(job, &mut results);
        // The measurements so far are written, whatever happens next.
        if !results.series.is_empty() {
            save(&mut results, folder)?;
        }
        ended?;
        if interrupt::requested() {
            break;
        }
    }
    results.complete = !interrupt::requested();
    results.when = now();
    Ok(results)
}

/// Writes `results.json` into `folder` and returns its path.
fn save(results: &mut Results, folder: &Path) -> Result<PathBuf, Failure> {
    results.when = now();
    let path = folder.join("results.json");
    let text = serde_json::to_string_pretty(results).map_err(Failure::running)?;
    write(&path, &text)?;
    Ok(path)
}

fn now() -> String {
    humantime::format_rfc3339_seconds(SystemTime::now()).to_string()
}

/// Folder of the report: beside the given results, if no folder was given.
fn folder(args: &BenchArgs) -> PathBuf {
    args.output.clone().unwrap_or_else(|| match &args.report_only {
        Some(file) => file.parent().map_or_else(PathBuf::new, Path::to_owned),
        None => PathBuf::from("out/bench"),
    })
}

/// Creates the folders, and checks that everything can be written into them.
fn check_targets(folder: &Path, args: &BenchArgs) -> Result<(), Failure> {
    let make = |folder: &Path| fs::create_dir_all(folder).map_err(|error| cannot_write(folder, error));
    if !folder.as_os_str().is_empty() {
        make(folder)?;
    }
    ["results.md", "report.html"].iter().try_for_each(|name| output::check_text_target(&folder.join(name)))?;
    if let Some(tables) = &args.tables {
        output::check_text_target(tables)?;
    }
    if args.report_only.is_some() {
        return Ok(());
    }
    output::check_text_target(&folder.join("results.json"))?;
    let images = folder.join("images");
    make(&images)?;
    // Pictures are numbered, so no other file has such a name; only a folder with a picture's name is in the way.
    output::check_target(&images.join("0000.png"))?;
    for entry in fs::read_dir(&images).map_err(|error| cannot_write(&images, error))?.flatten() {
        let path = entry.path();
        if path.extension().is_some_and(|extension| extension == "png") {
            output::check_target(&path)?;
        }
    }
    Ok(())
}

/// Adds another renderer's results to these.
fn include(results: &mut Results, mut other: Results) {
    if let Some(machine) = &other.machine {
        let renderer = other.series.first().map_or("another renderer", |series| &series.renderer);
        results.notes.push(format!("{renderer} was measured on {}, {}", machine.cpu, machine.os));
    }
    results.notes.append(&mut other.notes);
    let is_new = |group: &Group| !results.groups.iter().any(|known| known.name == group.name);
    let groups: Vec<_> = other.groups.into_iter().filter(is_new).collect();
    results.groups.extend(groups);
    let is_new = |name: &str| !results.references.iter().any(|known| known.name == name);
    let references: Vec<_> = other.references.into_iter().filter(|reference| is_new(&reference.name)).collect();
    results.references.extend(references);
    results.series.append(&mut other.series);
    results.contents.append(&mut other.contents);
}

fn read(path: &Path) -> Result<String, Failure> {
    Ok(results::read_text(path, "the file")?)
}

fn write(path: &Path, text: &str) -> Result<(), Failure> {
    output::write_text(text, path).map_err(Failure::running)
}

fn cannot_write(path: &Path, error: std::io::Error) -> Failure {
    Failure::running(Error::io(path, "cannot write", error))
}
