//! `render SCENE` and `info SCENE`: all of the program that touches scenes and rendering.

use std::collections::HashSet;
use std::ops::ControlFlow;
use std::path::Path;

use etendue::desc::IntegratorDesc;
use etendue::desc::{self, RenderDesc, SceneDesc};
use etendue::film::Image;
use etendue::integrator::photon::{Choice, choose};
use etendue::output::{self, Format, WriteOptions};
use etendue::render::{MOST_SAMPLES, NonFiniteSample, Progress, Render, RenderSettings, Summary};
use etendue::scene::{BuildOptions, Scene};

use crate::args::{InfoArgs, RenderArgs};
use crate::console::{self, Bar};
use crate::{Failure, interrupt};

/// Prints what the scene became.
pub fn info(args: &InfoArgs) -> Result<u8, Failure> {
    let (description, scene) = load(&args.scene, args.params.as_deref(), args.threads)?;
    let asked = description.render.integrator;
    let Choice { integrator, why } = choose(&scene);
    let is_auto = asked == IntegratorDesc::Auto;
    let would = if is_auto { "auto chooses" } else { "auto would choose" };
    let own = if is_auto { String::new() } else { format!("{}; ", asked.name()) };
    let line = format!("integrator      {own}{would} {}: {why}", integrator.name());
    console::print(&format!("{}\n{line}", scene.info().to_string().trim_end()))?;
    Ok(0)
}

/// Renders and writes; [`interrupt::EXIT_CODE`] after a run that was stopped.
pub fn render(args: &RenderArgs) -> Result<u8, Failure> {
    // An hour of rendering must not end at a typing error: everything that can be known now is asked now.
    let layers = check_outputs(args)?;
    interrupt::install()?;
    let (description, scene) = load(&args.scene, args.params.as_deref(), args.threads)?;
    let desc = args.settings(&description.render);
    let settings = RenderSettings {
        desc: desc.clone(),
        threads: args.threads,
        time_limit: args.time,
        target_error: args.target_error,
        auxiliary: layers,
        ..RenderSettings::default()
    };
    let mut render = Render::new(&scene, settings)?;

    interrupt::begin();
    let write = |image: &Image, samples: u32| write_all(args, image, &comments(&args.scene, &desc, samples));
    let mut failure = None;
    let summary = {
        let bar = Bar::new(args.quiet);
        render
            .run(&mut |progress| {
                bar.show(progress.fraction, status(progress));
                if let (true, Some(image)) = (args.progressive, progress.image) {
                    failure = write(&image(), progress.samples_done).err();
                }
                if failure.is_some() || interrupt::requested() {
                    ControlFlow::Break(())
                } else {
                    ControlFlow::Continue(())
                }
            })
            .map_err(Failure::running)?
    };
    if let Some(failure) = failure {
        return Err(failure);
    }
    // A run stopped before its first ray has nothing to put in the place of an older image.
    if summary.stopped && summary.rays == 0 {
        console::warn("stopped before the first ray: no image is written");
    } else {
        write(&render.image(), summary.samples)?;
    }
    report(&summary, &description, args.quiet);
    Ok(if summary.stopped && interrupt::requested() { interrupt::EXIT_CODE } else { 0 })
}

/// Reads and builds, passing on every warning.
pub fn load(scene: &Path, params: Option<&Path>, threads: usize) -> Result<(SceneDesc, Scene), Failure> {
    let description = desc::load(scene, params)?;
    description.warnings.iter().for_each(console::warn);
    let scene = Scene::build(&description, &BuildOptions { threads, ..BuildOptions::default() })?;
    scene.warnings().iter().for_each(console::warn);
    Ok((description, scene))
}

/// Whether all images can be written where they are wanted, and whether one of them holds layers.
fn check_outputs(args: &RenderArgs) -> Result<bool, Failure> {
    let mut seen = HashSet::new();
    let mut layers = false;
    for path in &args.output {
        layers |= output::check_target(path)? == Format::Exr;
        if !seen.insert(path) {
            return Err(Failure::usage(format!("{}: given twice as an output", path.display())));
        }
    }
    Ok(layers)
}

/// Writes every image that was asked for.
fn write_all(args: &RenderArgs, image: &Image, comments: &str) -> Result<(), Failure> {
    let options = WriteOptions {
        tone_map: args.tone_map.into(),
        exposure: args.exposure,
        comments: comments.to_owned(),
        threads: args.threads,
    };
    args.output.iter().try_for_each(|path| output::write(image, path, &options)).map_err(Failure::running)
}

/// How an image came about, for the file that holds it.
fn comments(scene: &Path, desc: &RenderDesc, samples: u32) -> String {
    let depth = desc.max_depth.map_or("none".to_owned(), |depth| depth.to_string());
    format!(
        "scene {}; integrator {:?}; samples per pixel {samples}; sampler {:?}; filter {:?}; maximum depth {depth}; \
         shadow rays {}; seed {}",
        scene.display(),
        desc.integrator,
        desc.sampler,
        desc.filter,
        desc.shadow_rays,
        desc.seed
    )
}

/// The words beside the progress bar.
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

/// The last words on standard error.
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
        "{} {}: {} samples per pixel, {}",
        if summary.stopped { "stopped after" } else { "done in" },
        console::duration(summary.elapsed.as_secs_f64()),
        summary.samples,
        console::ray_rate(summary.rays, summary.elapsed)
    );
    if let Some(error) = summary.relative_error {
        line += &format!(", relative error about {:.2} %", 100.0 * error);
    }
    if let Some(bytes) = console::peak_memory() {
        line += &format!(", peak memory {} MiB", bytes.div_ceil(1 << 20));
    }
    console::say(&line);
}

/// What the scene file calls the surface and the material that a sample met.
fn names(sample: &NonFiniteSample, scene: &SceneDesc) -> String {
    let Some(hit) = sample.hit else { return String::new() };
    let surface = scene.surfaces.get(hit.surface as usize).map_or("", |surface| &surface.path);
    let material = scene.materials.get(hit.material as usize).map_or("", |material| &material.name);
    format!(" ({surface}, \"{material}\")")
}
