//! `bake SCENE`: light maps, their coordinates, and irradiance at vertices, in files.

use std::ffi::OsString;
use std::ops::ControlFlow;
use std::path::PathBuf;
use std::sync::Arc;
use std::time::Instant;

use etendue::bake::{Atlas, AtlasOptions, Bake, Baked, Layout, VertexOptions, Vertices, by_radiosity};
use etendue::desc::{RenderDesc, SceneDesc};
use etendue::film::ErrorEstimate;
use etendue::integrator::Sites;
use etendue::output::{self, VertexValues, WriteOptions};
use etendue::render::{MOST_SAMPLES, RenderSettings, Summary, Workers};
use etendue::scene::Scene;
use serde_json::{Value, json};

use crate::args::{BakeArgs, BakeLayout, BakeMethod, BakeTarget};
use crate::console::{self, Bar};
use crate::{Failure, interrupt, render};

/// Bakes and writes; [`interrupt::EXIT_CODE`] after a run that was stopped.
pub fn bake(args: &BakeArgs) -> Result<u8, Failure> {
    let files = Files::new(args)?;
    interrupt::install()?;
    let (description, scene) = render::load(&args.scene, args.params.as_deref(), args.threads)?;
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
    let baker = Baker { args, scene: &scene, settings };
    let map = (args.only != Some(BakeTarget::Vertices)).then(|| baker.map(&files)).transpose()?;
    let vertices = match &map {
        // One Ctrl-C stops all.
        Some(map) if map.stopped => None,
        _ => (args.only != Some(BakeTarget::Map)).then(|| baker.vertices(&files)).transpose()?,
    };
    write_summary(&files, args, &description, map.as_ref(), vertices.as_ref())?;
    let stopped = map.iter().chain(&vertices).any(|part| part.stopped);
    Ok(if stopped && interrupt::requested() { interrupt::EXIT_CODE } else { 0 })
}

/// The files to write.
struct Files {
    map: PathBuf,
    atlas: PathBuf,
    vertices: PathBuf,
    summary: PathBuf,
}

impl Files {
    /// Names them, and checks what will be written.
    fn new(args: &BakeArgs) -> Result<Self, Failure> {
        let stem = args.scene.file_stem().unwrap_or_else(|| "light-map".as_ref());
        let prefix = if args.output.is_dir() { args.output.join(stem) } else { args.output.clone() };
        if prefix.file_name().is_none() {
            return Err(Failure::usage(format!("{}: is no beginning of a file's name", args.output.display())));
        }
        let with = |extension: &str| {
            let mut name = OsString::from(&prefix);
            name.push(extension);
            PathBuf::from(name)
        };
        let files = Self { map: with(".exr"), atlas: with(".obj"), vertices: with(".ply"), summary: with(".json") };
        let mut wanted = vec![&files.summary];
        if args.only != Some(BakeTarget::Vertices) {
            output::check_target(&files.map)?;
            wanted.push(&files.atlas);
        }
        if args.only != Some(BakeTarget::Map) {
            wanted.push(&files.vertices);
        }
        let inputs: Vec<PathBuf> = [Some(&args.scene), args.params.as_ref()]
            .into_iter()
            .flatten()
            .filter_map(|path| path.canonicalize().ok())
            .collect();
        for path in wanted {
            output::check_text_target(path)?;
            if path.canonicalize().is_ok_and(|path| inputs.contains(&path)) {
                let message = "is read as the scene and cannot be written; give --output another name";
                return Err(Failure::usage(format!("{}: {message}", path.display())));
            }
        }
        Ok(files)
    }
}

/// What one of the bakes came to.
struct Part {
    json: Value,
    stopped: bool,
}

struct Baker<'a> {
    args: &'a BakeArgs,
    scene: &'a Scene,
    settings: RenderSettings,
}

impl Baker<'_> {
    /// The light map and its coordinates.
    fn map(&self, files: &Files) -> Result<Part, Failure> {
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
        let (baked, summary) = self.run(atlas.sites(), Some(1.0 / atlas.texels_per_unit()), "texels")?;
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
        let mut json = facts(&summary);
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
        Ok(Part { json, stopped: summary.stopped })
    }

    /// Irradiance and radiosity at vertices.
    fn vertices(&self, files: &Files) -> Result<Part, Failure> {
        let options = VertexOptions { spacing: self.args.spacing, memory: self.args.memory };
        let bar = Bar::new(self.args.quiet);
        let vertices = Vertices::watched(self.scene, &options, None, &mut |fraction| {
            bar.show(fraction, "vertices: layout".to_owned());
            ControlFlow::Continue(())
        })?;
        drop(bar);
        let (baked, summary) = self.run(vertices.sites(), self.args.spacing, "vertices")?;
        let irradiance = vertices.spread(&baked.irradiance);
        let values = VertexValues {
            radiosity: &vertices.radiosity(&irradiance),
            irradiance: &irradiance,
            standard_error: &vertices.spread(&baked.standard_error),
        };
        output::write_vertices(&vertices, values, self.args.exposure, &files.vertices).map_err(Failure::running)?;
        let (points, triangles) = (vertices.vertices().len(), vertices.triangles().len());
        self.report(&summary, &format!("{points} vertices, {triangles} triangles"));
        let mut json = facts(&summary);
        json["vertices"] = json!(points);
        json["triangles"] = json!(triangles);
        Ok(Part { json, stopped: summary.stopped })
    }

    /// `spacing`: how far apart sites are, about.
    fn run(&self, sites: &Arc<Sites>, spacing: Option<f64>, what: &str) -> Result<(Baked, Summary), Failure> {
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
        Ok((bake.irradiance(), summary))
    }

    fn solve(&self, sites: &Arc<Sites>, spacing: Option<f64>, what: &str) -> Result<(Baked, Summary), Failure> {
        let began = Instant::now();
        interrupt::begin();
        let bar = Bar::new(self.args.quiet);
        let mut look_up = |fraction| {
            let left = console::time_left(fraction, began.elapsed());
            bar.show(fraction, format!("{what}: radiosity{left}"));
            if interrupt::requested() { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
        };
        let made = by_radiosity(self.scene, sites, &self.settings, spacing, !self.args.back, &mut look_up);
        drop(bar);
        let (baked, solution) = made.map_err(Failure::running)?;
        let summary = Summary { elapsed: began.elapsed(), notes: solution.notes().to_vec(), ..Summary::default() };
        Ok((baked, summary))
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

/// What a bake came to; numbers that are not known are null.
fn facts(summary: &Summary) -> Value {
    let number = |of: fn(ErrorEstimate) -> f64| summary.rel_mse.map(of);
    json!({
        "samples": summary.samples,
        "seconds": summary.elapsed.as_secs_f64(),
        "rays": summary.rays,
        "relMSE": number(|error| error.value),
        "relMSEStandardError": number(|error| error.standard_error),
        "ended": summary.ended.name(),
        "nonFinite": summary.non_finite,
        "notes": summary.notes,
    })
}

fn write_summary(
    files: &Files,
    args: &BakeArgs,
    description: &SceneDesc,
    map: Option<&Part>,
    vertices: Option<&Part>,
) -> Result<(), Failure> {
    let names: Vec<&str> = description.surfaces.iter().map(|surface| surface.path.as_str()).collect();
    let summary = json!({
        "version": env!("CARGO_PKG_VERSION"),
        "scene": args.scene.display().to_string(),
        "method": format!("{:?}", args.method).to_lowercase(),
        "side": if args.back { "back" } else { "front" },
        "surfaces": names,
        "map": map.map(|part| &part.json),
        "vertices": vertices.map(|part| &part.json),
    });
    let text = serde_json::to_string_pretty(&summary).unwrap_or_default();
    output::write_text(&(text + "\n"), &files.summary).map_err(Failure::running)
}
