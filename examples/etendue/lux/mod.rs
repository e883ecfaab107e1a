//! `lux SCENE`: illuminance and luminance at points, as tables, files and false-colour pictures.

mod picture;
mod table;

use std::collections::HashSet;
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};

use etendue::desc::{self, GridDesc, GridPoints, IntegratorDesc, RenderDesc, SceneDesc};
use etendue::lighting::{Calculation, Measured, daylight_only, exterior_illuminance, target_of};
use etendue::output::{self, WriteOptions};
use etendue::render::{MOST_SAMPLES, RenderSettings, Summary, Workers};
use etendue::scene::{BuildOptions, Scene};

use crate::args::{LuxArgs, LuxMethod};
use crate::console::{self, Bar};
use crate::failure::check_room;
use crate::render::{load, place};
use crate::{Failure, interrupt};

/// The relative error that is aimed at where nothing limits the work.
const DEFAULT_ERROR: f64 = 0.01;

/// Most samples per point where only the error or nothing limits the work: points in the dark never reach an error.
const MOST_BY_ERROR: u32 = 1 << 20;

/// The name of the grid that options describe.
const PLANE: &str = "plane";

/// Memory of a point's results, and of what a file says of it until it is written: JSON takes the most.
const RESULT_BYTES: usize = 128;
const OUTPUT_BYTES: usize = 1600;

/// A grid with its results.
struct GridResult {
    grid: GridDesc,
    places: Vec<[etendue::math::DVec3; 2]>,
    measured: Measured,
    /// Shares of the illuminance outside, where these were asked for.
    factors: Option<Measured>,
    summary: Summary,
}

impl GridResult {
    /// The unit of the measured values.
    fn unit(&self) -> &'static str {
        if self.grid.is_luminance() { "cd/m²" } else { "lx" }
    }

    /// What the values are.
    fn quantity(&self) -> &'static str {
        if self.grid.is_luminance() { "luminance" } else { "illuminance" }
    }
}

/// All results.
struct LuxResult {
    grids: Vec<GridResult>,
    /// Illuminance outside \[lx\] with its standard error, where daylight factors were asked for.
    exterior: Option<(f64, f64)>,
    /// The relative error that was aimed at.
    target: Option<f64>,
}

/// Calculates and writes; returns [`interrupt::EXIT_CODE`] after a run that was stopped.
pub fn lux(args: &LuxArgs) -> Result<u8, Failure> {
    let grids = grids(args)?;
    check_outputs(args, &grids)?;
    if args.method == LuxMethod::Radiosity && args.max_depth.is_some_and(|depth| depth.0.is_some()) {
        return Err(Failure::usage(
            "--max-depth: a radiosity solution has no paths that could be cut, expected --method path",
        ));
    }
    interrupt::install()?;
    let (description, scene) = load(&args.scene, args.params.as_deref(), args.threads)?;
    spare(args, &description)?;
    let scene = if args.daylight { daylit(args, &description)? } else { scene };
    let settings = settings(args, &description)?;
    if args.method == LuxMethod::Radiosity && description.render.integrator != IntegratorDesc::Radiosity {
        scene.info().not_diffuse.iter().for_each(console::warn);
    }
    let exterior = args.daylight.then(|| exterior_illuminance(&description, &settings)).transpose()?;
    let mut result = LuxResult { grids: Vec::new(), exterior, target: settings.target_error.map(f64::sqrt) };
    let mut stopped = false;
    for grid in grids {
        let mut calculation = Calculation::new(&scene, &grid, settings.clone())?;
        interrupt::begin();
        let bar = Bar::new(args.quiet);
        let summary = calculation
            .run(&mut |progress| {
                let rate = console::ray_rate(progress.rays, progress.elapsed);
                let left = console::time_left(progress.fraction, progress.elapsed);
                bar.show(progress.fraction, format!("{}: {} samples, {rate}{left}", grid.name, progress.samples_done));
                if interrupt::requested() { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
            })
            .map_err(Failure::running)?;
        drop(bar);
        stopped = summary.stopped;
        // Zeros are no results.
        if summary.stopped && summary.rays == 0 {
            break;
        }
        let bytes = if args.output.is_empty() { RESULT_BYTES } else { RESULT_BYTES + OUTPUT_BYTES };
        check_room(bytes * grid.count())?;
        let measured = calculation.measured();
        let factors = exterior.filter(|_| !grid.is_luminance()).map(|outside| measured.relative_to(outside));
        result.grids.push(GridResult { places: grid.places(), grid, measured, factors, summary });
        if stopped {
            break;
        }
    }
    if result.grids.is_empty() {
        console::warn("stopped before there was any result: nothing is written");
        return Ok(interrupt::EXIT_CODE);
    }
    if !args.quiet {
        notes(&result);
    }
    console::print(table::for_people(&result).trim_end())?;
    for path in &args.output {
        write(args, &result, path).map_err(Failure::running)?;
    }
    Ok(if stopped { interrupt::EXIT_CODE } else { 0 })
}

/// The grids of the file and of the options.
fn grids(args: &LuxArgs) -> Result<Vec<GridDesc>, Failure> {
    let mut grids = match &args.grid {
        Some(file) => desc::load_grids(file)?,
        None => Vec::new(),
    };
    if let Some(plane) = args.plane_grid().map_err(Failure::usage)? {
        let grid = GridDesc { name: PLANE.to_owned(), points: GridPoints::Plane(plane) };
        if grids.iter().any(|other| other.name == grid.name) {
            return Err(Failure::usage(format!("--plane: the file has a grid of the name '{PLANE}' already")));
        }
        grid.check("--plane")?;
        grids.push(grid);
    }
    Ok(grids)
}

/// The scene with its sky as its only light.
fn daylit(args: &LuxArgs, description: &SceneDesc) -> Result<Scene, Failure> {
    let sky = daylight_only(description)?;
    Ok(Scene::build(&sky, &BuildOptions { threads: args.threads, ..BuildOptions::default() })?)
}

fn settings(args: &LuxArgs, description: &SceneDesc) -> Result<RenderSettings, Failure> {
    let own = &description.render;
    let is_unlimited = args.error.is_none() && args.spp.is_none() && args.time.is_none();
    let most = if args.time.is_some() { MOST_SAMPLES } else { MOST_BY_ERROR };
    Ok(RenderSettings {
        desc: RenderDesc {
            samples: args.spp.unwrap_or(most),
            integrator: match args.method {
                LuxMethod::Path => IntegratorDesc::Path,
                LuxMethod::Radiosity => IntegratorDesc::Radiosity,
            },
            max_depth: args.max_depth.map_or(own.max_depth, |depth| depth.0),
            shadow_rays: args.shadow_rays.unwrap_or(own.shadow_rays),
            seed: args.seed.unwrap_or(own.seed),
            ..own.clone()
        },
        threads: args.threads,
        workers: Some(Workers::pool(args.threads)?),
        time_limit: args.time,
        target_error: args.error.or(is_unlimited.then_some(DEFAULT_ERROR)).map(target_of),
        ..RenderSettings::default()
    })
}

/// What a file of this name holds.
#[derive(Clone, Copy, PartialEq, Eq)]
enum FileKind {
    Csv,
    Json,
    Png,
}

fn kind(path: &Path) -> Result<FileKind, Failure> {
    match path.extension().and_then(|extension| extension.to_str()).map(str::to_ascii_lowercase).as_deref() {
        Some("csv") => Ok(FileKind::Csv),
        Some("json") => Ok(FileKind::Json),
        Some("png") => Ok(FileKind::Png),
        _ => Err(Failure::usage(format!("{}: expected a name that ends in .csv, .json or .png", path.display()))),
    }
}

/// Checks that all files can be written, and that none is read or given twice.
fn check_outputs(args: &LuxArgs, grids: &[GridDesc]) -> Result<(), Failure> {
    let read = [Some(&args.scene), args.params.as_ref(), args.grid.as_ref()];
    let read: Vec<PathBuf> = read.into_iter().flatten().map(|path| place(path)).collect();
    let mut seen = HashSet::new();
    for path in &args.output {
        if kind(path)? == FileKind::Png {
            picture::check(grids).map_err(|message| Failure::usage(format!("{}: {message}", path.display())))?;
        }
        output::check_text_target(path)?;
        if read.contains(&place(path)) {
            return Err(Failure::usage(format!("{}: is read and cannot be written", path.display())));
        }
        if !seen.insert(place(path)) {
            return Err(Failure::usage(format!("{}: given twice as an output", path.display())));
        }
    }
    Ok(())
}

/// Refuses to write over a file that the scene names.
fn spare(args: &LuxArgs, description: &SceneDesc) -> Result<(), Failure> {
    let inputs: HashSet<PathBuf> = description.files.iter().map(|path| place(path)).collect();
    match args.output.iter().find(|path| inputs.contains(&place(path))) {
        Some(path) => Err(Failure::usage(format!("{}: is read and cannot be written", path.display()))),
        None => Ok(()),
    }
}

/// Notes of all grids, each once.
fn notes(result: &LuxResult) {
    let mut seen = HashSet::new();
    for grid in &result.grids {
        for note in &grid.summary.notes {
            if seen.insert(note) {
                console::say(&format!("note: {note}"));
            }
        }
    }
}

fn write(args: &LuxArgs, result: &LuxResult, path: &Path) -> Result<(), String> {
    let said = |error: etendue::Error| error.to_string();
    match kind(path).map_err(|failure| failure.to_string())? {
        FileKind::Csv => output::write_text(&table::csv(result), path).map_err(said),
        FileKind::Json => output::write_text(&table::json(args, result), path).map_err(said),
        FileKind::Png => {
            let image = picture::draw(result, args.scale);
            output::write(&image, path, &WriteOptions::default()).map_err(said)
        }
    }
}
