//! `photons SCENE`: the photons of a map, in a file or as a picture.

use std::collections::HashSet;
use std::path::{Path, PathBuf};
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::thread;

use etendue::desc::{CameraDesc, RenderDesc};
use etendue::film::Image;
use etendue::integrator::check_still;
use etendue::integrator::photon::{self, DrawSettings, MapKind, NARROW, Photon, PhotonBatch, PhotonJob};
use etendue::output::{self, PhotonFormat, WriteOptions};
use etendue::scene::Scene;
use etendue::{Error, ErrorKind, Parallel};

use crate::args::{Map, PhotonsArgs};
use crate::{Failure, console, interrupt, render};

/// Default number of light paths: as many dots as a picture can show.
const PATHS: u32 = 100_000;

/// Shoots photons and writes them; returns [`interrupt::EXIT_CODE`], without writing anything, after a run that was
/// stopped.
pub fn photons(args: &PhotonsArgs) -> Result<u8, Failure> {
    check_outputs(&args.output)?;
    interrupt::install()?;
    let (description, scene) = render::load(&args.scene, args.params.as_deref(), args.threads)?;
    let desc = RenderDesc {
        resolution: args.resolution.unwrap_or(description.render.resolution),
        crop: None,
        max_depth: args.max_depth.map_or(description.render.max_depth, |depth| depth.0),
        seed: args.seed.unwrap_or(description.render.seed),
        ..description.render
    };
    check_still(&scene, "a photon map")?;
    let camera = camera(args, *scene.camera())?;
    let size = size_of::<Photon>();
    let job = PhotonJob {
        kind: match args.map {
            Map::Direct => MapKind::Direct,
            Map::Caustic => MapKind::Caustic,
            Map::Indirect => MapKind::Indirect,
            Map::Global => MapKind::Global,
        },
        paths: args.photons.or(desc.photons.count).unwrap_or(PATHS),
        pass: 0,
        most: (desc.photons.memory as usize).saturating_mul(1 << 20) / size,
        narrow_below: NARROW,
        time: 0.0,
    };
    // Errors of the camera are reported before the work begins.
    let is_drawn = args.output.iter().any(|path| PhotonFormat::from_path(path).is_none());
    if is_drawn {
        etendue::camera::Camera::new(&camera, desc.resolution, scene.centre())?;
    }

    interrupt::begin();
    let mut threads = ScopedThreads(match args.threads {
        0 => thread::available_parallelism().map_or(1, usize::from),
        threads => threads,
    });
    let settings = DrawSettings { coloured: args.color };
    let made = photon::shoot(&scene, &desc, job, &mut threads).and_then(|shot| {
        let draw = || photon::draw(&scene, &camera, desc.resolution, &shot.photons, settings);
        let image = is_drawn.then(draw).transpose()?;
        threads.check().map(|()| (shot, image))
    });
    let (shot, image) = match made {
        Err(error) if error.kind() == ErrorKind::Cancelled => {
            console::warn("stopped: nothing is written");
            return Ok(interrupt::EXIT_CODE);
        }
        made => made?,
    };
    for path in &args.output {
        write(path, &shot, image.as_ref(), &scene, args).map_err(Failure::running)?;
    }
    report(&shot, &job, args.quiet);
    Ok(0)
}

/// Checks that all files can be written.
fn check_outputs(paths: &[PathBuf]) -> Result<(), Failure> {
    let mut seen = HashSet::new();
    for path in paths {
        if PhotonFormat::from_path(path).is_some() {
            output::check_photon_target(path)?;
        } else if let Err(error) = output::check_target(path) {
            if error.kind() == ErrorKind::Unsupported {
                let extensions = "use .csv or .ply for photons, .png, .exr or .pfm for a picture of them";
                return Err(Failure::usage(format!(
                    "{}: nothing is known by this name's extension: {extensions}",
                    path.display()
                )));
            }
            return Err(error.into());
        }
        if !seen.insert(path) {
            return Err(Failure::usage(format!("{}: given twice as an output", path.display())));
        }
    }
    Ok(())
}

/// The scene's camera with the changes of the command line.
fn camera(args: &PhotonsArgs, camera: CameraDesc) -> Result<CameraDesc, Failure> {
    let mut camera = camera;
    let [origin, look_at, up] = camera.view_mut();
    *origin = args.origin.unwrap_or(*origin);
    *look_at = args.look_at.unwrap_or(*look_at);
    *up = args.up.unwrap_or(*up);
    if let Some(wanted) = args.field_of_view {
        match &mut camera {
            CameraDesc::Perspective { fov_deg, .. }
            | CameraDesc::ThinLens { fov_deg, .. }
            | CameraDesc::ViewPlane { fov_deg, .. } => *fov_deg = wanted,
            CameraDesc::Panoramic { panorama, .. } => panorama.fov_deg = wanted,
            CameraDesc::Orthographic { .. } => {
                return Err(Failure::usage(
                    "--field-of-view: the rays of the scene's orthographic camera are parallel",
                ));
            }
        }
    }
    Ok(camera)
}

fn write(
    path: &Path,
    shot: &PhotonBatch,
    image: Option<&Image>,
    scene: &Scene,
    args: &PhotonsArgs,
) -> etendue::Result<()> {
    if PhotonFormat::from_path(path).is_some() {
        return output::write_photons(&shot.photons, scene.centre(), path);
    }
    let Some(image) = image else { return Ok(()) };
    let comments =
        format!("scene {}; {:?} photons of {} light paths", args.scene.display(), args.map, shot.tally.paths);
    output::write(image, path, &WriteOptions { comments, threads: args.threads, ..WriteOptions::default() })
}

fn report(shot: &PhotonBatch, job: &PhotonJob, quiet: bool) {
    if shot.photons.is_empty() {
        console::warn("there is no such photon: nothing shines, or no light comes this way");
    }
    if shot.cut_from.is_some() {
        let message = "photonMemory allows no more photons: light paths";
        console::warn(format!("{message} were cut to {} of {}", shot.tally.paths, job.paths));
    }
    if !quiet {
        let tally = &shot.tally;
        let shadows = if tally.shadows > 0 { format!(" and {} shadow photons", tally.shadows) } else { String::new() };
        console::say(&format!("{} photons{shadows} of {} light paths", tally.stored, tally.paths));
    }
}

/// A number of threads that process tasks one after the other.
struct ScopedThreads(usize);

impl Parallel for ScopedThreads {
    fn check(&mut self) -> etendue::Result<()> {
        if interrupt::requested() { Err(Error::new(ErrorKind::Cancelled, "interrupted")) } else { Ok(()) }
    }

    fn map<R, F>(&mut self, count: usize, piece: F) -> etendue::Result<Vec<R>>
    where
        R: Send + 'static,
        F: Fn(usize) -> R + Send + Sync + 'static,
    {
        let next = AtomicUsize::new(0);
        let results: Vec<Mutex<Option<R>>> = (0..count).map(|_| Mutex::new(None)).collect();
        let work = || {
            while !interrupt::requested() {
                let number = next.fetch_add(1, Ordering::Relaxed);
                let Some(result) = results.get(number) else { break };
                let value = piece(number);
                if let Ok(mut result) = result.lock() {
                    *result = Some(value);
                }
            }
        };
        thread::scope(|scope| {
            for _ in 1..self.0.min(count) {
                // Tasks of threads that could not be started are done by the others.
                let _ = thread::Builder::new().spawn_scoped(scope, work);
            }
            work();
        });
        self.check()?;
        let missing = || Error::new(ErrorKind::Internal, "a piece of work has no result");
        results.into_iter().map(|result| result.into_inner().ok().flatten().ok_or_else(missing)).collect()
    }
}
