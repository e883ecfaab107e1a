//! `bake SCENE`: light maps, their coordinates, and irradiance at vertices, in files.

use std::collections::HashSet;
use std::ffi::OsString;
use std::ops::ControlFlow;
use std::path::{Path, PathBuf, is_separator};
use std::sync::Arc;
use std::time::Instant;

use etendue::ErrorKind;
use etendue::bake::{Atlas, AtlasOptions, Bake, Baked, Layout, VertexOptions, Vertices, by_radiosity};
use etendue::desc::{IntegratorDesc, RenderDesc, SceneDesc};
use etendue::film::ErrorEstimate;
use etendue::integrator::Sites;
use etendue::integrator::radiosity::Radiosity;
use etendue::output::{self, VertexValues, WriteOptions};
use etendue::render::{MOST_SAMPLES, RenderSettings, Summary, Workers};
use etendue::scene::Scene;
use serde_json::{Value, json};

use crate::args::{BakeArgs, BakeLayout, BakeMethod, BakeTarget};
use crate::console::{self, Bar};
use crate::render::place;
use crate::{Failure, interrupt, render};

/// Bakes and writes; returns [`interrupt::EXIT_CODE`] after a run that was stopped.
pub fn bake(args: &BakeArgs) -> Result<u8, Failure> {
    let files = Files::new(args)?;
    interrupt::install()?;
    let (description, scene) = render::load(&args.scene, args.params.as_deref(), args.threads)?;
    files.spare(&description.files)?;
    if args.method == BakeMethod::Radiosity {
        // Warnings about the scene's own integrator were printed with those of the scene.
        let own = description.render.integrator == IntegratorDesc::Radiosity;
        let not_diffuse = scene.info().not_diffuse.iter().filter(|_| !own);
        not_diffuse.chain(&scene.info().not_in_radiosity).for_each(console::warn);
    }
    let is_limited = args.time.is_some() || args.target_error.is_some();
    let settings = RenderSettings {
        desc: RenderDesc {
            samples: args.spp.unwrap_or(if is_limited { MOST_SAMPLES } else { description.render.samples }),
            max_depth: args.max_depth.map_or(description.render.max_depth, |depth| depth.0),
            shadow_rays: args.shadow_rays.unwrap_or(description.render.shadow_rays),
            seed: args.seed.unwrap_or(description.render.seed),
            ..description.render.clone()
        },
        workers: Some(Workers::pool(args.threads)?),
        time_limit: args.time,
        target_error: args.target_error,
        ..RenderSettings::default()
    };
    let baker = BakeRun { args, scene: &scene, settings };
    let (mut map, mut vertices) = (BakeOutcome::NotAsked, BakeOutcome::NotAsked);
    if args.only != Some(BakeTarget::Vertices) {
        map = baker.map(&files)?;
    }
    // One Ctrl-C stops all bakes.
    if args.only != Some(BakeTarget::Map) && !map.is_stopped() {
        vertices = baker.vertices(&files)?;
    }
    if map.json().or(vertices.json()).is_some() {
        write_summary(&files, args, &description, &map, &vertices)?;
    }
    Ok(if map.is_stopped() || vertices.is_stopped() { interrupt::EXIT_CODE } else { 0 })
}

/// The files to write.
struct Files {
    map: PathBuf,
    atlas: PathBuf,
    vertices: PathBuf,
    summary: PathBuf,
    only: Option<BakeTarget>,
}

impl Files {
    /// Chooses the names, and checks the files that will be written.
    fn new(args: &BakeArgs) -> Result<Self, Failure> {
        let stem = args.scene.file_stem().unwrap_or_else(|| "light-map".as_ref());
        let prefix = if args.output.is_dir() { args.output.join(stem) } else { args.output.clone() };
        // "new/" is a folder that does not exist, and "-" would be standard output, which cannot hold four files.
        let ends_in_folder =
            args.output.as_os_str().as_encoded_bytes().last().is_some_and(|&end| is_separator(end.into()));
        if prefix.file_name().is_none_or(|name| name == "-") || ends_in_folder && !args.output.is_dir() {
            let message = "is no beginning of a file's name, nor a folder that is there";
            return Err(Failure::usage(format!("{}: {message}", args.output.display())));
        }
        let with = |extension: &str| {
            let mut name = OsString::from(&prefix);
            name.push(extension);
            PathBuf::from(name)
        };
        let files = Self {
            map: with(".exr"),
            atlas: with(".obj"),
            vertices: with(".ply"),
            summary: with(".json"),
            only: args.only,
        };
        if args.only != Some(BakeTarget::Vertices) {
            output::check_target(&files.map)?;
        }
        let wanted = files.wanted();
        let mut seen = HashSet::new();
        for path in &wanted {
            output::check_text_target(path)?;
            if !seen.insert(place(path)) {
                return Err(Failure::usage(format!("{}: is one file with another output", path.display())));
            }
        }
        let inputs: Vec<PathBuf> = [Some(&args.scene), args.params.as_ref()].into_iter().flatten().cloned().collect();
        files.spare(&inputs)?;
        Ok(files)
    }

    /// The files of the requested bakes.
    fn wanted(&self) -> Vec<&Path> {
        let mut wanted = vec![self.summary.as_path()];
        if self.only != Some(BakeTarget::Vertices) {
            wanted.extend([self.map.as_path(), &self.atlas]);
        }
        if self.only != Some(BakeTarget::Map) {
            wanted.push(&self.vertices);
        }
        wanted
    }

    /// Refuses to write over a file that is read.
    fn spare(&self, inputs: &[PathBuf]) -> Result<(), Failure> {
        let inputs: HashSet<PathBuf> = inputs.iter().map(|path| place(path)).collect();
        match self.wanted().into_iter().find(|path| inputs.contains(&place(path))) {
            Some(path) => {
                let message = "is read as the scene and cannot be written; give --output another name";
                Err(Failure::usage(format!("{}: {message}", path.display())))
            }
            None => Ok(()),
        }
    }
}

/// Outcome of one of the bakes.
enum BakeOutcome {
    NotAsked,
    /// Stopped by Ctrl-C before there was anything to write.
    Nothing,
    /// Written, with its entry in the summary.
    Written {
        json: Value,
        stopped: bool,
    },
}

impl BakeOutcome {
    fn json(&self) -> Option<&Value> {
        if let Self::Written { json, .. } = self { Some(json) } else { None }
    }

    fn is_stopped(&self) -> bool {
        matches!(self, Self::Nothing | Self::Written { stopped: true, .. })
    }
}

/// Irradiance of sites.
struct BakedSites {
    baked: Baked,
    summary: Summary,
    solution: Option<Arc<Radiosity>>,
}

struct BakeRun<'a> {
    args: &'a BakeArgs,
    scene: &'a Scene,
    settings: RenderSettings,
}

impl BakeRun<'_> {
    /// The light map and its coordinates.
    fn map(&self, files: &Files) -> Result<BakeOutcome, Failure> {
        let began = Instant::now();
        let options = AtlasOptions {
            resolution: self.args.resolution,
            texels_per_unit: self.args.texels_per_unit,
            gutter: self.args.gutter,
            layout: match self.args.layout {
                BakeLayout::Auto => Layout::Auto,
                BakeLayout::Charts => Layout::Charts,
                BakeLayout::Own => Layout::Own,
            },
            memory: self.args.memory,
            ..AtlasOptions::default()
        };
        let bar = Bar::new(self.args.quiet);
        let atlas = Atlas::watched(self.scene, &options, &mut |fraction| {
            bar.show(fraction, "texels: layout".to_owned());
            ControlFlow::Continue(())
        })?;
        drop(bar);
        let laid_out = began.elapsed();
        atlas.warnings().iter().for_each(console::warn);
        let found = self.run(atlas.sites(), Some(1.0 / atlas.texels_per_unit()), "texels")?;
        let Some(BakedSites { baked, summary, solution }) = found else { return Ok(nothing("light map")) };
        let map = atlas.light_map(&baked);
        let mut attributes = output::summary_attributes(&summary);
        attributes.push(("texelsPerUnit".to_owned(), output::Attribute::Number(atlas.texels_per_unit())));
        let comments = format!(
            "light map of scene {}: irradiance [W m^-2], bottom row at v = 0; {:?}; side {}; samples per texel {}; seed {}",
            self.args.scene.display(),
            self.args.method,
            if self.args.back { "back" } else { "front" },
            summary.samples,
            self.settings.desc.seed
        );
        let write = WriteOptions { comments, attributes, threads: self.args.threads, ..WriteOptions::default() };
        output::write(&output::light_map_image(&map), &files.map, &write).map_err(Failure::running)?;
        output::write_atlas(&atlas, &files.atlas).map_err(Failure::running)?;
        self.report(&summary, &format!("{0} x {0} texels, {1} charts", atlas.side(), atlas.charts().len()));
        let mut json = facts(&summary, solution.as_deref());
        json["side"] = json!(atlas.side());
        json["texelsPerUnit"] = json!(atlas.texels_per_unit());
        json["charts"] = json!(atlas.charts().len());
        json["coveredTexels"] = json!(atlas.texels().len());
        json["layoutSeconds"] = json!(laid_out.as_secs_f64());
        json["surfaces"] = atlas
            .surfaces()
            .iter()
            .map(|surface| {
                json!({
                    "surface": surface.surface,
                    "vertices": surface.vertices.len(),
                    "triangles": surface.triangles.len(),
                    "scaleOffset": surface.scale_offset,
                })
            })
            .collect();
        Ok(BakeOutcome::Written { json, stopped: summary.stopped })
    }

    /// Irradiance and radiosity at vertices.
    fn vertices(&self, files: &Files) -> Result<BakeOutcome, Failure> {
        let options = VertexOptions { spacing: self.args.spacing, memory: self.args.memory };
        let bar = Bar::new(self.args.quiet);
        let vertices = Vertices::watched(self.scene, &options, None, &mut |fraction| {
            bar.show(fraction, "vertices: layout".to_owned());
            ControlFlow::Continue(())
        })?;
        drop(bar);
        let found = self.run(vertices.sites(), self.args.spacing, "vertices")?;
        let Some(BakedSites { baked, summary, solution }) = found else { return Ok(nothing("vertices")) };
        let irradiance = vertices.spread(&baked.irradiance);
        let values = VertexValues {
            radiosity: &vertices.radiosity(&irradiance, !self.args.back),
            irradiance: &irradiance,
            standard_error: &vertices.spread(&baked.standard_error),
        };
        output::write_vertices(&vertices, values, self.args.exposure, &files.vertices).map_err(Failure::running)?;
        let (points, triangles) = (vertices.vertices().len(), vertices.triangles().len());
        self.report(&summary, &format!("{points} vertices, {triangles} triangles"));
        let mut json = facts(&summary, solution.as_deref());
        json["vertices"] = json!(points);
        json["triangles"] = json!(triangles);
        Ok(BakeOutcome::Written { json, stopped: summary.stopped })
    }

    /// Bakes sites at a distance of about `spacing`. `None` if it was stopped before there was any result.
    fn run(&self, sites: &Arc<Sites>, spacing: Option<f64>, what: &str) -> Result<Option<BakedSites>, Failure> {
        if self.args.method == BakeMethod::Radiosity {
            return self.solve(sites, spacing, what);
        }
        let mut bake = Bake::new(self.scene, sites, self.settings.clone(), !self.args.back)?;
        interrupt::begin();
        let bar = Bar::new(self.args.quiet);
        let summary = bake
            .run(&mut |progress| {
                let rate = console::ray_rate(progress.rays, progress.elapsed);
                let left = console::time_left(progress.fraction, progress.elapsed);
                bar.show(progress.fraction, format!("{what}: {} samples, {rate}{left}", progress.samples_done));
                if interrupt::requested() { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
            })
            .map_err(Failure::running)?;
        // Zeros must not replace older files.
        let is_nothing = summary.stopped && summary.rays == 0;
        Ok((!is_nothing).then(|| BakedSites { baked: bake.irradiance(), summary, solution: None }))
    }

    fn solve(&self, sites: &Arc<Sites>, spacing: Option<f64>, what: &str) -> Result<Option<BakedSites>, Failure> {
        let began = Instant::now();
        interrupt::begin();
        let bar = Bar::new(self.args.quiet);
        let mut progress = |fraction| {
            let left = console::time_left(fraction, began.elapsed());
            bar.show(fraction, format!("{what}: radiosity{left}"));
            if interrupt::requested() { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
        };
        let made = by_radiosity(self.scene, sites, &self.settings, spacing, !self.args.back, &mut progress);
        drop(bar);
        let (baked, solution) = match made {
            Err(error) if error.kind() == ErrorKind::Cancelled && interrupt::requested() => return Ok(None),
            Err(error) if error.kind() == ErrorKind::Cancelled => {
                return Err(Failure::running("--time was over before the radiosity solution was there"));
            }
            made => made.map_err(Failure::running)?,
        };
        let summary = Summary {
            elapsed: began.elapsed(),
            integrator: IntegratorDesc::Radiosity,
            notes: solution.notes().to_vec(),
            ..Summary::default()
        };
        Ok(Some(BakedSites { baked, summary, solution: Some(solution) }))
    }

    fn report(&self, summary: &Summary, what: &str) {
        if self.args.quiet {
            return;
        }
        for note in &summary.notes {
            console::say(&format!("note: {note}"));
        }
        let ended = if summary.stopped { "stopped after" } else { "done in" };
        let time = console::duration(summary.elapsed.as_secs_f64());
        let rate = console::ray_rate(summary.rays, summary.elapsed);
        let mut line = format!("{what}: {ended} {time}");
        if summary.samples > 0 {
            line += &format!(", {} samples each, {rate}", summary.samples);
        }
        if let Some(error) = summary.rel_mse {
            line += &format!(", relMSE {:.2e} ± {:.0e}", error.value, error.standard_error);
        }
        console::say(&line);
    }
}

/// The outcome and message of a bake that was stopped before there was any result.
fn nothing(what: &str) -> BakeOutcome {
    console::warn(format!("stopped before there was anything to write: no {what}"));
    BakeOutcome::Nothing
}

/// Results of a bake; unknown numbers are null.
fn facts(summary: &Summary, solution: Option<&Radiosity>) -> Value {
    let number = |of: fn(ErrorEstimate) -> f64| summary.rel_mse.map(of);
    let mut facts = json!({
        "samples": summary.samples,
        "seconds": summary.elapsed.as_secs_f64(),
        "rays": summary.rays,
        "relMSE": number(|error| error.value),
        "relMSEStandardError": number(|error| error.standard_error),
        "ended": summary.ended.name(),
        "nonFinite": summary.non_finite,
        "notes": summary.notes,
    });
    if let Some(solution) = solution.map(Radiosity::summary) {
        facts["ended"] = Value::Null;
        facts["radiosity"] = json!({
            "elements": solution.elements,
            "links": solution.links,
            "iterations": solution.iterations,
            "residual": solution.residual,
            "errorBound": solution.error_bound,
            "samplingError": solution.sampling_error,
            "emitted": solution.emitted.to_array(),
            "absorbed": solution.absorbed.to_array(),
        });
    }
    facts
}

fn write_summary(
    files: &Files,
    args: &BakeArgs,
    description: &SceneDesc,
    map: &BakeOutcome,
    vertices: &BakeOutcome,
) -> Result<(), Failure> {
    let names: Vec<&str> = description.surfaces.iter().map(|surface| surface.path.as_str()).collect();
    let summary = json!({
        "version": env!("CARGO_PKG_VERSION"),
        "scene": args.scene.display().to_string(),
        "method": format!("{:?}", args.method).to_lowercase(),
        "side": if args.back { "back" } else { "front" },
        "surfaces": names,
        "map": map.json(),
        "vertices": vertices.json(),
    });
    let text = serde_json::to_string_pretty(&summary).unwrap_or_default();
    output::write_text(&(text + "\n"), &files.summary).map_err(Failure::running)
}
