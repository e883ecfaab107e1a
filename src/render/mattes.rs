//! Mattes: which objects and which materials the camera sees in each pixel, and in how many of its samples.
//!
//! They are a calculation of their own, beside a render: one ray for each camera sample, and no light. The samples are those of the
//! render, with the same film positions, points on the lens and times, so that edges match those of its picture. What a sample sees is
//! the first surface that its ray meets: rays pass where a surface is not there ([`crate::desc::MaterialDesc::opacity`]), and mirrors
//! and glass are what is seen. Samples that meet nothing belong to no object.
//!
//! ```
//! use std::ops::ControlFlow;
//! use etendue::render::{MatteKind, MatteSettings, Mattes};
//! use etendue::scene::{BuildOptions, Scene};
//!
//! let mut desc = etendue::desc::load("scenes/cornell.json".as_ref(), None)?;
//! desc.set_surface_name(0, "lamp")?;
//! desc.render.resolution = [32, 32];
//! let scene = Scene::build(&desc, &BuildOptions::default())?;
//! let settings = MatteSettings { desc: desc.render.clone(), samples: Some(4), ..MatteSettings::default() };
//! let mattes = Mattes::trace(&scene, &desc, &settings, &mut |_| ControlFlow::Continue(()))?;
//! let most = mattes.pixel(MatteKind::Object, 16, 16).first();
//! println!("{:?}", most.map(|share| (&mattes.names(MatteKind::Object)[share.name as usize], share.samples)));
//! # Ok::<(), etendue::Error>(())
//! ```
//!
//! [`crate::output::cryptomatte`] writes them for compositing programs.
//!
//! Source: Friedman and Jones 2015, "Fully automatic ID mattes with support for motion blur and transparency".

use std::collections::HashMap;
use std::ops::ControlFlow;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::{Mutex, PoisonError};

use super::workers::{SharedWork, Workers};
use super::{pixel_filter, pixel_sampler, placement};
use crate::Cancel;
use crate::camera::{Camera, MovingCamera};
use crate::desc::{RenderDesc, SceneDesc};
use crate::error::{Error, ErrorKind, Result};
use crate::film::{Placement, TILE};
use crate::image::MAX_PIXELS;
use crate::math::Ray;
use crate::room::{add_entries, add_room, filled, grow, push, with_room};
use crate::sampling::{AnySampler, Filter, Sampler};
use crate::scene::{Hit, Scene};

/// Greatest number of names that a pixel keeps.
pub const MAX_MATTE_LEVELS: u32 = 64;

/// Number of rays that are traced together.
const WAVE: usize = 128;

/// Number of pixels of a tile.
const PIXELS: usize = (TILE * TILE) as usize;

/// The name of what no sample can see.
const NONE: u32 = u32::MAX;

/// What names are of.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MatteKind {
    /// Objects: surfaces by their names, or by their paths where they have none.
    Object,
    /// Materials: by their names, or by their paths where they have none. Surfaces without a material have no part in it.
    Material,
}

impl MatteKind {
    /// All kinds.
    pub const ALL: [Self; 2] = [Self::Object, Self::Material];
}

/// How mattes are traced.
#[derive(Clone, Debug)]
pub struct MatteSettings {
    /// Resolution, crop, pixel filter, sampler, number of samples and seed of the render whose picture they are for. All else is not
    /// read.
    pub desc: RenderDesc,
    /// Number of samples of each pixel, where it is not that of `desc`: the first so many of the render's own. Above 0.
    pub samples: Option<u32>,
    /// Number of names that a pixel keeps: those that most samples see. From 1 to [`MAX_MATTE_LEVELS`].
    pub levels: u32,
    /// Number of threads; 0 means one per core. The result does not depend on it. It is ignored where `workers` are given.
    pub threads: usize,
    /// The workers. With `None`, a pool is started and ended.
    pub workers: Option<Workers>,
    /// The token that stops it, from any thread.
    pub cancel: Cancel,
}

impl Default for MatteSettings {
    fn default() -> Self {
        let (desc, cancel) = (RenderDesc::default(), Cancel::new());
        Self { desc, samples: None, levels: 6, threads: 0, workers: None, cancel }
    }
}

/// The samples of a pixel that see what has one name.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct MatteShare {
    /// Index in [`Mattes::names`].
    pub name: u32,
    /// Their number, above 0.
    pub samples: u32,
}

/// Mattes of a picture, or of the crop of it.
#[derive(Clone, Debug, PartialEq)]
pub struct Mattes {
    resolution: [u32; 2],
    placement: Option<Placement>,
    samples: u32,
    levels: u32,
    /// Names by kind.
    names: [Vec<String>; 2],
    tiles: Vec<Tile>,
}

/// What a tile has of both kinds.
#[derive(Clone, Debug, Default, PartialEq)]
struct Tile([Shares; 2]);

/// The shares of a tile's pixels, one pixel after another.
#[derive(Clone, Debug, Default, PartialEq)]
struct Shares {
    all: Vec<MatteShare>,
    /// Where the shares of each pixel end, row by row with [`TILE`] in a row.
    ends: Vec<u16>,
}

impl Mattes {
    /// Traces the camera samples of a scene that was built from this description.
    ///
    /// Each sample counts once. A filter with weights of both signs, such as that of Mitchell and Netravali, has samples where its weight
    /// is negative too; they count like all others, so that no share is negative. `progress` is called on the calling thread about ten
    /// times a second with the fraction that is done; its answer `Break` stops the work.
    ///
    /// Memory: 20 bytes per pixel where it sees one object, and at most 16 bytes per pixel and level more; and the names.
    ///
    /// # Errors
    /// [`ErrorKind::InvalidScene`] at `levels`, at `samples` for none of them, and those of [`RenderDesc::check`];
    /// [`ErrorKind::Unsupported`] for more than [`MAX_PIXELS`](crate::output::MAX_PIXELS) pixels; [`ErrorKind::Cancelled`];
    /// [`ErrorKind::OutOfMemory`]; [`ErrorKind::Internal`] if a worker panicked.
    pub fn trace(
        scene: &Scene,
        desc: &SceneDesc,
        settings: &MatteSettings,
        progress: &mut dyn FnMut(f64) -> ControlFlow<()>,
    ) -> Result<Self> {
        let render = &settings.desc;
        render.check()?;
        let levels = settings.levels;
        if !(1..=MAX_MATTE_LEVELS).contains(&levels) {
            return Err(Error::invalid("levels", format!("{levels} levels, expected 1 to {MAX_MATTE_LEVELS}")));
        }
        let samples = settings.samples.unwrap_or(render.samples);
        if samples == 0 {
            return Err(Error::invalid("samples", "no samples, expected 1 at least"));
        }
        let resolution = render.film_size();
        if resolution.map(u64::from).into_iter().product::<u64>() > MAX_PIXELS {
            let message = format!("{resolution:?} pixels are more than the {MAX_PIXELS} that an image can have");
            return Err(Error::new(ErrorKind::Unsupported, message));
        }
        let labels = Labels::of(desc)?;
        let count = resolution.map(|length| length.div_ceil(TILE) as usize).into_iter().product();
        let camera = Camera::new(scene.camera(), render.resolution, scene.centre())?;
        let trace = Trace {
            moving_camera: scene.moving_camera(render.resolution)?,
            filter: pixel_filter(render),
            sampler: pixel_sampler(render, 1),
            resolution,
            origin: render.crop.map_or([0; 2], |crop| [crop.left, crop.top]),
            picture_width: render.resolution[0],
            has_rim: camera.has_rim(),
            camera,
            scene: scene.clone(),
            samples,
            levels: levels as usize,
            of_surface: labels.of_surface,
            of_material: labels.of_material,
            tiles: Mutex::new(filled(Tile::default(), count)?),
            count,
            next: AtomicUsize::new(0),
            done: AtomicUsize::new(0),
            stop: AtomicBool::new(false),
            cancel: settings.cancel.clone(),
            failure: Mutex::new(None),
        };
        let workers = settings.workers.clone().map_or_else(|| Workers::pool(settings.threads), Ok)?;
        let trace = workers.run(trace, &mut |trace| {
            if progress(trace.done.load(Ordering::Relaxed) as f64 / count.max(1) as f64).is_break() {
                trace.abandon();
            }
        })?;
        if let Some(failure) = trace.failure.lock().unwrap_or_else(PoisonError::into_inner).take() {
            return Err(failure);
        }
        if trace.done.load(Ordering::Acquire) < count {
            return Err(Error::new(ErrorKind::Cancelled, "cancelled"));
        }
        let tiles = std::mem::take(&mut *trace.tiles.lock().unwrap_or_else(PoisonError::into_inner));
        let placement = placement(render, scene.camera().pixel_aspect());
        Ok(Self { resolution, placement, samples, levels, names: labels.names, tiles })
    }

    /// Width and height in pixels.
    pub fn resolution(&self) -> [u32; 2] {
        self.resolution
    }

    /// Where they lie in the picture; `None` for a whole picture of square pixels.
    pub fn placement(&self) -> Option<Placement> {
        self.placement
    }

    /// Number of samples of each pixel.
    pub fn samples(&self) -> u32 {
        self.samples
    }

    /// Number of names that a pixel keeps at most.
    pub fn levels(&self) -> u32 {
        self.levels
    }

    /// The names of all objects or materials of the scene, each once, in the order of the description, also those that no pixel sees.
    pub fn names(&self, kind: MatteKind) -> &[String] {
        &self.names[kind as usize]
    }

    /// What a pixel sees, by falling number of samples, and by the order of names where numbers are equal. Empty outside the picture.
    pub fn pixel(&self, kind: MatteKind, x: u32, y: u32) -> &[MatteShare] {
        let [width, height] = self.resolution;
        if x >= width || y >= height {
            return &[];
        }
        let tile = y / TILE * width.div_ceil(TILE) + x / TILE;
        let Some(Tile(kinds)) = self.tiles.get(tile as usize) else { return &[] };
        let Shares { all, ends } = &kinds[kind as usize];
        let index = (y % TILE * TILE + x % TILE) as usize;
        let end = |index: usize| ends.get(index).map_or(0, |end| usize::from(*end));
        all.get(index.checked_sub(1).map_or(0, end)..end(index)).unwrap_or_default()
    }
}

/// Names, and which of them each element has.
struct Labels {
    names: [Vec<String>; 2],
    of_surface: Vec<u32>,
    of_material: Vec<u32>,
}

impl Labels {
    fn of(desc: &SceneDesc) -> Result<Self> {
        let objects = desc.surfaces.iter().map(|surface| (!surface.hidden).then(|| surface.object()));
        let materials = desc.materials.iter().map(|it| Some(if it.name.is_empty() { &*it.path } else { &*it.name }));
        let (object_names, of_surface) = numbered(objects)?;
        let (material_names, of_material) = numbered(materials)?;
        Ok(Self { names: [object_names, material_names], of_surface, of_material })
    }
}

/// The different names, and the number of the name of each element; [`NONE`] for an element without one.
fn numbered<'a>(elements: impl ExactSizeIterator<Item = Option<&'a str>>) -> Result<(Vec<String>, Vec<u32>)> {
    let (mut known, mut names, mut numbers) = (HashMap::new(), Vec::new(), with_room(elements.len())?);
    for name in elements {
        let Some(name) = name else {
            numbers.push(NONE);
            continue;
        };
        add_entries(&mut known, 1)?;
        let next = names.len() as u32;
        let number = *known.entry(name).or_insert(next);
        if number == next {
            let mut own = String::new();
            own.try_reserve_exact(name.len())
                .map_err(|error| Error::new(ErrorKind::OutOfMemory, "no room for a name").because(error))?;
            own.push_str(name);
            push(&mut names, own)?;
        }
        numbers.push(number);
    }
    Ok((names, numbers))
}

/// Mattes that are traced, as the workers share them.
struct Trace {
    scene: Scene,
    camera: Camera,
    moving_camera: Option<MovingCamera>,
    has_rim: bool,
    filter: Filter,
    sampler: AnySampler,
    /// Width and height of what is traced.
    resolution: [u32; 2],
    /// Its first pixel in the picture.
    origin: [u32; 2],
    picture_width: u32,
    samples: u32,
    levels: usize,
    of_surface: Vec<u32>,
    of_material: Vec<u32>,
    tiles: Mutex<Vec<Tile>>,
    /// Number of tiles, of those that a worker has taken, and of those that are done.
    count: usize,
    next: AtomicUsize,
    done: AtomicUsize,
    stop: AtomicBool,
    cancel: Cancel,
    failure: Mutex<Option<Error>>,
}

/// What a worker keeps from tile to tile.
struct Memory {
    sampler: AnySampler,
    rays: Vec<Ray>,
    /// The pixel of each ray, in its tile.
    owners: Vec<u16>,
    hits: Vec<Option<Hit>>,
    /// For each pixel the samples of each name, by name, of both kinds.
    counts: [Vec<Vec<MatteShare>>; 2],
}

impl Memory {
    fn new(sampler: AnySampler) -> Result<Self> {
        let counts = || filled(Vec::new(), PIXELS);
        Ok(Self {
            sampler,
            rays: with_room(WAVE)?,
            owners: with_room(WAVE)?,
            hits: filled(None, WAVE)?,
            counts: [counts()?, counts()?],
        })
    }
}

impl SharedWork for Trace {
    fn take(&self, pause: &mut dyn FnMut() -> bool) -> bool {
        let outcome = self.take_tiles(pause);
        outcome.unwrap_or_else(|error| {
            self.failure.lock().unwrap_or_else(PoisonError::into_inner).get_or_insert(error);
            self.abandon();
            true
        })
    }

    fn is_done(&self) -> bool {
        self.is_stopped() || self.done.load(Ordering::Acquire) == self.count
    }

    fn abandon(&self) {
        self.stop.store(true, Ordering::Relaxed);
    }

    fn shares(&self) -> usize {
        self.count
    }
}

impl Trace {
    fn is_stopped(&self) -> bool {
        self.stop.load(Ordering::Relaxed) || self.cancel.is_cancelled()
    }

    /// Takes tiles until none is left or until `pause` returns `true`. Returns whether none is left.
    fn take_tiles(&self, pause: &mut dyn FnMut() -> bool) -> Result<bool> {
        let mut memory = Memory::new(self.sampler.clone())?;
        loop {
            if self.is_stopped() {
                return Ok(true);
            }
            if pause() {
                return Ok(false);
            }
            let number = self.next.fetch_add(1, Ordering::Relaxed);
            if number >= self.count {
                return Ok(true);
            }
            let Some(tile) = self.tile(number, &mut memory, pause)? else { return Ok(true) };
            if let Some(place) = self.tiles.lock().unwrap_or_else(PoisonError::into_inner).get_mut(number) {
                *place = tile;
            }
            self.done.fetch_add(1, Ordering::Release);
        }
    }

    /// Traces a tile; `None` where the work is stopped.
    fn tile(&self, number: usize, memory: &mut Memory, pause: &mut dyn FnMut() -> bool) -> Result<Option<Tile>> {
        let across = self.resolution[0].div_ceil(TILE) as usize;
        let [left, top] = [number % across, number / across].map(|place| place as u32 * TILE);
        let [columns, rows] = [self.resolution[0] - left, self.resolution[1] - top].map(|size| size.min(TILE));
        memory.counts.iter_mut().flatten().for_each(Vec::clear);
        // Samples since the last look at whether to stop: where the camera sees nothing they have no ray.
        let mut waiting = 0;
        for row in 0..rows {
            for column in 0..columns {
                let pixel = [left + column + self.origin[0], top + row + self.origin[1]];
                for sample in 0..self.samples {
                    if let Some(ray) = self.ray(pixel, sample, &mut memory.sampler) {
                        memory.rays.push(ray);
                        memory.owners.push((row * TILE + column) as u16);
                    }
                    waiting += 1;
                    if waiting == WAVE {
                        waiting = 0;
                        self.count_hits(memory)?;
                        // The calling thread reports progress in `pause`. A tile that was begun is completed.
                        pause();
                        if self.is_stopped() {
                            memory.rays.clear();
                            memory.owners.clear();
                            return Ok(None);
                        }
                    }
                }
            }
        }
        self.count_hits(memory)?;
        let mut tile = Tile::default();
        for (shares, counts) in tile.0.iter_mut().zip(&mut memory.counts) {
            add_room(&mut shares.ends, PIXELS)?;
            add_room(&mut shares.all, counts.iter().map(|counts| counts.len().min(self.levels)).sum())?;
            for counts in counts {
                counts.sort_unstable_by_key(|share| (u32::MAX - share.samples, share.name));
                shares.all.extend(counts.iter().take(self.levels));
                shares.ends.push(shares.all.len() as u16);
            }
        }
        Ok(Some(tile))
    }

    /// The ray of a sample of a pixel of the picture; `None` where the camera sees nothing. The numbers are drawn in the order of a
    /// render: film position, point on the lens, time; of a camera that moves, the time first.
    #[inline]
    fn ray(&self, pixel: [u32; 2], sample: u32, sampler: &mut AnySampler) -> Option<Ray> {
        sampler.start(pixel[1] * self.picture_width + pixel[0], sample);
        let (offset, _) = self.filter.sample(sampler.pixel_2d());
        let [column, row] = pixel.map(|index| index as f32 + 0.5);
        let [x, y] = [column + offset[0], row + offset[1]];
        if self.has_rim && !self.camera.sees(x, y) {
            return None;
        }
        let lensed = |camera: &Camera, sampler: &mut AnySampler| {
            if camera.has_lens() { camera.ray_through_lens(x, y, sampler.next_2d()) } else { camera.ray(x, y) }
        };
        let moment = |sampler: &mut AnySampler| {
            let [time, _] = sampler.next_2d();
            self.scene.moment(time)
        };
        let (camera, mut ray) = match &self.moving_camera {
            Some(moving) => {
                let time = moment(sampler);
                let camera = moving.at(time);
                let ray = lensed(&camera, sampler).at_time(time);
                (camera, ray)
            }
            None => {
                let mut ray = lensed(&self.camera, sampler);
                if self.scene.uses_time() {
                    ray.time = moment(sampler);
                }
                (self.camera, ray)
            }
        };
        if self.scene.asks_footprints() {
            ray.cone = camera.cone(column, row);
        }
        Some(ray)
    }

    /// Traces the rays and counts what they meet.
    fn count_hits(&self, memory: &mut Memory) -> Result<()> {
        let Memory { rays, owners, hits, counts: [objects, materials], .. } = memory;
        let hits = &mut hits[..rays.len()];
        self.scene.intersect_many(rays, hits);
        let name = |names: &[u32], number: u32| names.get(number as usize).copied().unwrap_or(NONE);
        for (hit, owner) in hits.iter().zip(owners.iter()) {
            let Some(hit) = hit else { continue };
            let (surface, material) = self.scene.hit_owner(hit);
            count(&mut objects[usize::from(*owner)], name(&self.of_surface, surface))?;
            count(&mut materials[usize::from(*owner)], material.map_or(NONE, |it| name(&self.of_material, it)))?;
        }
        rays.clear();
        owners.clear();
        Ok(())
    }
}

/// Counts a sample that sees a name.
#[inline]
fn count(counts: &mut Vec<MatteShare>, name: u32) -> Result<()> {
    if name == NONE {
        return Ok(());
    }
    match counts.binary_search_by_key(&name, |share| share.name) {
        Ok(place) => counts[place].samples += 1,
        Err(place) => {
            grow(counts, 1)?;
            counts.insert(place, MatteShare { name, samples: 1 });
        }
    }
    Ok(())
}
