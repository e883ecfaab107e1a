//! `render SCENE` and `info SCENE`: the commands that load and render scenes.

use std::collections::HashSet;
use std::ffi::OsStr;
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::{Duration, Instant};

use etendue::desc::{
    self, CropDesc, IntegratorDesc, LoadOptions, MeshDesc, RenderDesc, RouletteDesc, SceneDesc, ShutterDesc,
};
use etendue::film::Image;
use etendue::integrator::photon::{Choice, choose};
use etendue::output::{self, Attribute, Format, WriteOptions};
use etendue::render::{MOST_SAMPLES, NonFiniteSample, Progress, Render, RenderSettings, Summary, Workers};
use etendue::scene::{BuildOptions, Scene};

use crate::args::{InfoArgs, RenderArgs, Switch};
use crate::checkpoint;
use crate::console::{self, Bar};
use crate::failure::check_room;
use crate::layers::{self, Bands};
use crate::stats::Stats;
use crate::{Failure, interrupt};

/// How a picture comes to be rendered: by this process alone, or with others.
pub trait Runner {
    /// Whether other processes help, which must render the same scene.
    const HAS_OTHERS: bool;

    /// Tells the others that the scene has been read.
    fn has_read(&mut self, description: &SceneDesc) -> Result<(), Failure>;

    /// Renders.
    fn run(
        &mut self,
        render: &mut Render,
        progress: &mut dyn FnMut(&Progress) -> ControlFlow<()>,
    ) -> etendue::Result<Summary>;

    /// Tells the others that a frame is done, and whether it is the last one.
    fn end_frame(&mut self, is_last: bool);
}

/// This process alone.
pub struct Alone;

impl Runner for Alone {
    const HAS_OTHERS: bool = false;

    fn has_read(&mut self, _description: &SceneDesc) -> Result<(), Failure> {
        Ok(())
    }

    fn run(
        &mut self,
        render: &mut Render,
        progress: &mut dyn FnMut(&Progress) -> ControlFlow<()>,
    ) -> etendue::Result<Summary> {
        render.run(progress)
    }

    fn end_frame(&mut self, _is_last: bool) {}
}

/// Prints properties of the built scene.
pub fn info(args: &InfoArgs) -> Result<u8, Failure> {
    let (description, scene) = load(&args.scene, args.params.as_deref(), args.threads)?;
    let asked = description.render.integrator;
    let Choice { integrator, why } = choose(&scene);
    let is_auto = asked == IntegratorDesc::Auto;
    let would = if is_auto { "auto chooses" } else { "auto would choose" };
    let own = if is_auto { String::new() } else { format!("{}; ", asked.name()) };
    let files = files(&description);
    let line = format!("integrator      {own}{would} {}: {why}", integrator.name());
    let film = film(&description);
    console::print(&format!("{files}{film}{}\n{line}", scene.info().to_string().trim_end()))?;
    Ok(0)
}

/// What is unusual about the film, in a line of its own; nothing for a whole picture of square pixels before the view axis.
fn film(scene: &SceneDesc) -> String {
    let mut parts = Vec::new();
    if let Some([x, y]) = scene.camera.film().map(|film| film.shift).filter(|shift| *shift != [0.0; 2]) {
        parts.push(format!("shifted by {x} widths to the right and {y} heights upwards"));
    }
    if scene.camera.pixel_aspect() != 1.0 {
        parts.push(format!("pixel aspect {}", scene.camera.pixel_aspect()));
    }
    if let Some(CropDesc { left, top, width, height }) = scene.render.crop {
        let [columns, rows] = scene.render.resolution;
        parts.push(format!("{width} x {height} pixels from ({left}, {top}) of {columns} x {rows}"));
    }
    if parts.is_empty() { String::new() } else { format!("film            {}\n", parts.join("; ")) }
}

/// The greatest number of meshes that `info` names.
const NAMED_MESHES: usize = 20;

/// Memory of a pixel of an image with all layers that there can be.
const IMAGE_BYTES: usize = 30 * size_of::<f32>();

/// What was read from mesh files, a line for each mesh.
fn files(scene: &SceneDesc) -> String {
    let is_read =
        |mesh: &&Arc<MeshDesc>| scene.files.iter().any(|file| mesh.name.starts_with(&*file.to_string_lossy()));
    let of = |mesh: &Arc<MeshDesc>| {
        let normals = if mesh.has_normals() { ", normals" } else { "" };
        let uvs = if mesh.has_uvs() { ", texture coordinates" } else { "" };
        let (vertices, triangles) = (mesh.vertex_count(), mesh.triangle_count());
        format!("read            {}: {vertices} vertices, {triangles} triangles{normals}{uvs}\n", mesh.name)
    };
    let mut lines: String = scene.meshes.iter().filter(is_read).take(NAMED_MESHES).map(of).collect();
    let count = scene.meshes.iter().filter(is_read).count();
    if count > NAMED_MESHES {
        lines += &format!("read            {} more meshes\n", count - NAMED_MESHES);
    }
    lines
}

/// Renders and writes; returns [`interrupt::EXIT_CODE`] after a run that was stopped.
pub fn render(args: &RenderArgs, runner: &mut impl Runner) -> Result<u8, Failure> {
    // An hour of rendering must not end at a typing error: everything that can be checked in advance is checked now.
    let bands = Bands::of(args)?;
    let layers = check_outputs(args)?;
    args.mattes.check(&args.output)?;
    interrupt::install()?;
    let began = Instant::now();
    let options = LoadOptions { progress: Some(console::reading_images(args.quiet)), ..args.choices() };
    let description = desc::load_with(&args.scene, args.params.as_deref(), &options)?;
    description.warnings.iter().for_each(console::warn);
    check_times(args, &description)?;
    runner.has_read(&description)?;
    let workers = Workers::pool(args.threads)?;
    for_each_frame(args, description, began, true, |description, scene, number, build_time| {
        let frame = Frame { number, layers, bands, build_time };
        let outcome = render_frame(args, description, scene, &workers, &frame, runner);
        let is_last = !matches!(outcome, Ok(0)) || number == args.frames.map(|frames| frames.last);
        runner.end_frame(is_last);
        outcome
    })
}

/// Builds the scene as each frame sees it, or once, and does something with it, until that gives another exit code than 0. `began`: when
/// this began. `speaks`: whether this process is the one that speaks to the user.
pub fn for_each_frame(
    args: &RenderArgs,
    mut description: SceneDesc,
    mut began: Instant,
    speaks: bool,
    mut each: impl FnMut(&SceneDesc, &Scene, Option<u32>, Duration) -> Result<u8, Failure>,
) -> Result<u8, Failure> {
    if let Some(time) = args.time_at {
        description.set_shutter(ShutterDesc::at(time))?;
    }
    let Some(frames) = args.frames else {
        let scene = build(&description, args.threads, speaks)?;
        return each(&description, &scene, None, began.elapsed());
    };
    let relative = description.motion.shutter.clone();
    let seed = args.seed.unwrap_or(description.render.seed);
    let mut scene: Option<Scene> = None;
    for number in frames.first..=frames.last {
        let time = f64::from(number) / args.frame_rate;
        let shutter = ShutterDesc { open: relative.open + time, close: relative.close + time, ..relative.clone() };
        description.set_shutter(shutter)?;
        // Frames have noise of their own, or it would stand still over what moves.
        description.render.seed = seed.wrapping_add(number.into());
        // What does not move from frame to frame is shared with the frame before.
        let options = BuildOptions { threads: args.threads, ..BuildOptions::default() };
        let built = match &scene {
            None => build(&description, args.threads, speaks)?,
            Some(before) => {
                let built = before.rebuild(&description, &options)?;
                if speaks {
                    built.warnings().iter().for_each(console::warn);
                }
                built
            }
        };
        if speaks && !args.quiet {
            console::say(&format!("frame {number}"));
        }
        let code = each(&description, &built, Some(number), began.elapsed())?;
        if code != 0 {
            return Ok(code);
        }
        scene = Some(built);
        began = Instant::now();
    }
    Ok(0)
}

/// Refuses options about time for a scene in which nothing moves.
fn check_times(args: &RenderArgs, description: &SceneDesc) -> Result<(), Failure> {
    let given = [("--time-at", args.time_at.is_some()), ("--frames", args.frames.is_some())];
    let option = given.iter().find(|(_, is_given)| *is_given).map(|(option, _)| option);
    if let (Some(option), true) = (option, description.motion.is_empty()) {
        let message =
            format!("{option}: nothing in the scene moves, expected one with keyframes (`motion`) or `steps`");
        return Err(Failure::usage(message));
    }
    Ok(())
}

/// What differs from frame to frame.
struct Frame {
    /// The number of the frame, where there are several.
    number: Option<u32>,
    /// Whether one of the images has layers.
    layers: bool,
    /// The bands that the images have layers of.
    bands: Option<Bands>,
    build_time: Duration,
}

/// The name of a file of a frame: each # of it is a digit of the number, at least as many as there are.
fn frame_file(path: &Path, number: Option<u32>) -> PathBuf {
    let (Some(number), Some(name)) = (number, path.file_name().and_then(OsStr::to_str)) else {
        return path.to_owned();
    };
    let Some(start) = name.find('#') else { return path.to_owned() };
    let digits = name[start..].bytes().take_while(|byte| *byte == b'#').count();
    path.with_file_name(format!("{}{number:0digits$}{}", &name[..start], &name[start + digits..]))
}

/// The settings of a render, or of a frame of it.
pub fn settings(args: &RenderArgs, description: &SceneDesc, is_frame: bool, workers: &Workers) -> RenderSettings {
    let mut desc = args.settings(&description.render);
    if is_frame {
        desc.seed = description.render.seed;
    }
    RenderSettings {
        desc,
        workers: Some(workers.clone()),
        time_limit: args.time,
        target_error: args.target().map(|(_, target)| target),
        error_measure: args.target().map(|(measure, _)| measure).unwrap_or_default(),
        adaptive: args.adaptive.map(|switch| switch == Switch::On),
        share: args.state.share,
        ..RenderSettings::default()
    }
}

/// Renders a scene and writes it; returns [`interrupt::EXIT_CODE`] after a run that was stopped.
fn render_frame<R: Runner>(
    args: &RenderArgs,
    description: &SceneDesc,
    scene: &Scene,
    workers: &Workers,
    frame: &Frame,
    runner: &mut R,
) -> Result<u8, Failure> {
    let Frame { number, layers, bands, build_time } = *frame;
    let settings = settings(args, description, number.is_some(), workers);
    let desc = settings.desc.clone();
    if bands.is_some() && !desc.spectral {
        let message =
            "--spectral-layers: paths in three channels have no bands of wavelengths, expected --spectral beside it";
        return Err(Failure::usage(message));
    }
    let wants_fingerprint = R::HAS_OTHERS || args.state.checkpoint.is_some() || args.state.resume.is_some();
    let fingerprint = wants_fingerprint.then(|| description.fingerprint()).transpose()?;
    let (settings, resumed) = args.state.apply(RenderSettings {
        auxiliary: layers,
        light_parts: args.light_layers,
        fingerprint,
        ..settings
    })?;
    let mut render = match resumed {
        None => Render::new(scene, settings.clone())?,
        Some(checkpoint) => {
            Render::resume(scene, settings.clone(), checkpoint).map_err(|error| args.state.named(error))?
        }
    };
    // Warnings about the scene's own integrator were printed with those of the scene.
    if desc.integrator == IntegratorDesc::Radiosity && description.render.integrator != IntegratorDesc::Radiosity {
        scene.info().not_diffuse.iter().for_each(console::warn);
    }

    interrupt::begin();
    let write = |image: &Image, samples: u32, attributes| {
        write_all(args, number, image, comments(&args.scene, &desc, samples), attributes)
    };
    let pixels = desc.resolution.into_iter().map(|length| length as usize).product::<usize>();
    let mut failure = None;
    let summary = {
        let bar = Bar::new(args.quiet);
        let mut report = |progress: &Progress| {
            bar.show(progress.fraction, status(progress));
            if let (true, Some(image)) = (args.progressive, progress.image) {
                let developed = check_room(pixels * IMAGE_BYTES);
                failure = developed.and_then(|()| write(&image(), progress.samples_done, Vec::new())).err();
            }
            if failure.is_some() || interrupt::requested() { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
        };
        runner.run(&mut render, &mut report).map_err(Failure::running)?
    };
    if let Some(failure) = failure {
        return Err(failure);
    }
    let mut is_stopped = summary.stopped;
    // A run that was stopped before its first ray must not replace an older image.
    if summary.stopped && summary.rays == 0 {
        console::warn("stopped before the first ray: no image is written");
    } else {
        let mut image = render.film().try_develop(workers.threads()).map_err(Failure::running)?;
        let mut attributes = output::summary_attributes(&summary);
        let mut without_mattes = None;
        if let Some(bands) = bands.filter(|_| !summary.stopped) {
            let spectral = layers::render(scene, &settings, bands, args.quiet)?;
            is_stopped = spectral.len() < bands.count;
            image.layers.extend(spectral);
            attributes.extend(output::spectral_attributes());
        }
        if !is_stopped {
            match args.mattes.trace(description, scene, &settings, &summary, args.quiet) {
                Ok(None) => is_stopped = true,
                Ok(Some(found)) => {
                    image.layers.extend(found.layers);
                    attributes.extend(found.attributes);
                }
                Err(failure) => without_mattes = Some(failure),
            }
        }
        write(&image, summary.samples, attributes)?;
        // The picture is not lost with its mattes.
        if let Some(failure) = without_mattes {
            return Err(failure);
        }
    }
    if let Some(path) = &args.stats {
        let stats = Stats::new(args, &desc, &summary, workers.threads(), build_time);
        stats.write(&frame_file(path, number)).map_err(Failure::running)?;
    }
    report(&summary, description, args.quiet);
    checkpoint::check(&summary)?;
    Ok(if is_stopped && interrupt::requested() { interrupt::EXIT_CODE } else { 0 })
}

/// Reads and builds the scene, and prints every warning.
pub fn load(scene: &Path, params: Option<&Path>, threads: usize) -> Result<(SceneDesc, Scene), Failure> {
    load_with(scene, params, &LoadOptions::default(), threads)
}

/// Reads and builds what is chosen of a scene, and prints every warning.
fn load_with(
    scene: &Path,
    params: Option<&Path>,
    options: &LoadOptions,
    threads: usize,
) -> Result<(SceneDesc, Scene), Failure> {
    let description = desc::load_with(scene, params, options)?;
    description.warnings.iter().for_each(console::warn);
    let scene = build(&description, threads, true)?;
    Ok((description, scene))
}

/// Builds a scene, and prints its warnings where this process speaks to the user.
fn build(description: &SceneDesc, threads: usize, speaks: bool) -> Result<Scene, Failure> {
    let scene = Scene::build(description, &BuildOptions { threads, ..BuildOptions::default() })?;
    if speaks {
        scene.warnings().iter().for_each(console::warn);
    }
    Ok(scene)
}

/// Checks that every output can be written, and that none is an input or another output. Returns whether one of the
/// images has layers.
fn check_outputs(args: &RenderArgs) -> Result<bool, Failure> {
    let inputs: Vec<PathBuf> = std::iter::once(&args.scene).chain(&args.params).map(|path| place(path)).collect();
    let mut seen = HashSet::new();
    let mut check = |path: &Path| {
        let place = place(path);
        if inputs.contains(&place) {
            return Err(Failure::usage(format!("{}: is read as the scene and cannot be written", path.display())));
        }
        if !seen.insert(place) {
            return Err(Failure::usage(format!("{}: given twice as an output", path.display())));
        }
        Ok(())
    };
    let mut layers = false;
    if let Some(path) = &args.state.checkpoint {
        // Hours of rendering must not be lost to a forgotten option.
        let is_resumed = args.state.resume.as_deref().is_some_and(|resumed| place(resumed) == place(path));
        if path.exists() && !is_resumed {
            let message = "is there already, expected another name for the checkpoint, or --resume to go on from it";
            return Err(Failure::usage(format!("{}: {message}", path.display())));
        }
        output::check_text_target(path)?;
        check(path)?;
        // The images are made of it later, and some have layers.
        layers = true;
    }
    let numbers = args.frames.map_or(vec![None], |frames| (frames.first..=frames.last).map(Some).collect());
    let has_several = numbers.len() > 1;
    let name = |path: &Path, number| {
        let own = frame_file(path, number);
        if has_several && own == *path {
            let message = "the frames would have the same name, expected one with # for the digits of their numbers";
            return Err(Failure::usage(format!("{}: {message}", path.display())));
        }
        Ok(own)
    };
    for number in numbers {
        if let Some(path) = &args.stats {
            let path = name(path, number)?;
            output::check_text_target(&path)?;
            check(&path)?;
        }
        for path in &args.output {
            let path = name(path, number)?;
            let format = output::check_target(&path)?;
            if args.spectral_layers.is_some() && format != Format::Exr {
                let message = "has no room for spectral layers, expected a file name that ends in .exr";
                return Err(Failure::usage(format!("{}: {message}", path.display())));
            }
            layers |= format == Format::Exr;
            check(&path)?;
        }
    }
    if args.light_layers && !layers {
        let message = "--light-layers: no output has room for layers, expected one with a name that ends in .exr, or --checkpoint";
        return Err(Failure::usage(message));
    }
    Ok(layers)
}

/// The same path for all spellings of it: links are resolved, and the folder has no `.` and `..`.
pub fn place(path: &Path) -> PathBuf {
    let parent = path.parent().filter(|parent| !parent.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let in_folder = || Some(parent.canonicalize().ok()?.join(path.file_name()?));
    path.canonicalize().ok().or_else(in_folder).unwrap_or_else(|| path.to_path_buf())
}

/// Writes all requested images, of a frame where it has a number.
fn write_all(
    args: &RenderArgs,
    number: Option<u32>,
    image: &Image,
    comments: String,
    attributes: Vec<(String, Attribute)>,
) -> Result<(), Failure> {
    let options = WriteOptions {
        tone_map: args.tone_map.into(),
        exposure: args.exposure,
        primaries: args.primaries.into(),
        comments,
        attributes,
        threads: args.threads,
    };
    let write = |path: &PathBuf| output::write(image, &frame_file(path, number), &options);
    args.output.iter().try_for_each(write).map_err(Failure::running)
}

/// Description of the render, for the image file.
fn comments(scene: &Path, desc: &RenderDesc, samples: u32) -> String {
    let depth = desc.max_depth.map_or("none".to_owned(), |depth| depth.to_string());
    let roulette = if desc.roulette == RouletteDesc::File { "; roulette file" } else { "" };
    format!(
        "scene {}; integrator {:?}; samples per pixel {samples}; sampler {:?}; filter {:?}; maximum depth {depth}; \
         shadow rays {}; seed {}{roulette}",
        scene.display(),
        desc.integrator,
        desc.sampler,
        desc.filter,
        desc.shadow_rays,
        desc.seed
    )
}

/// The text beside the progress bar.
fn status(progress: &Progress) -> String {
    if interrupt::requested() {
        return "stopping; Ctrl-C again to abort".to_owned();
    }
    format!(
        "{}{} samples, {}{}",
        progress.samples_done,
        if progress.samples_total < MOST_SAMPLES { format!("/{}", progress.samples_total) } else { String::new() },
        console::ray_rate(progress.rays, progress.elapsed),
        console::time_left(progress.fraction, progress.elapsed)
    )
}

/// The final message on standard error.
fn report(summary: &Summary, scene: &SceneDesc, quiet: bool) {
    if quiet {
        return;
    }
    for note in &summary.notes {
        console::say(&format!("note: {note}"));
    }
    for sample in &summary.non_finite_samples {
        console::say(&format!("  {sample}{}", names(sample, scene)));
    }
    let mut line = format!(
        "{} {}: {} samples per pixel{}, {}",
        if summary.stopped { "stopped after" } else { "done in" },
        console::duration(summary.elapsed.as_secs_f64()),
        summary.samples,
        // The sample counts differ by more than an interrupted pass explains.
        summary
            .sample_counts
            .filter(|_| summary.adaptive)
            .map_or(String::new(), |counts| format!(" ({} to {})", counts.min, counts.max)),
        console::ray_rate(summary.rays, summary.elapsed)
    );
    if let Some(error) = summary.rel_mse {
        line += &format!(", relMSE {:.2e} ± {:.0e}", error.value, error.standard_error);
    }
    if let Some(error) = summary.display_error {
        line += &format!(", {:.2} levels of 255", error.value);
    }
    if let Some(bytes) = console::peak_memory() {
        line += &format!(", peak memory {} MiB", bytes.div_ceil(1 << 20));
    }
    console::say(&line);
}

/// The names of the surface and the material that a sample hit, as in the scene file.
fn names(sample: &NonFiniteSample, scene: &SceneDesc) -> String {
    let Some(hit) = sample.hit else { return String::new() };
    let surface = scene.surfaces.get(hit.surface as usize).map_or("", |surface| &surface.path);
    let material =
        hit.material.and_then(|material| scene.materials.get(material as usize)).map_or("", |material| &material.name);
    format!(" ({surface}, \"{material}\")")
}
