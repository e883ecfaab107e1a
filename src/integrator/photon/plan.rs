//! Which maps a method wants, with which radii, and when they are made.

use std::sync::Arc;

use super::super::irradiance_cache::IrradianceCache;
use super::super::light::Vertex;
use super::super::{SceneTracer, Tracer as _};
use super::aim::Aims;
use super::choose::aimed_paths_find_caustics;
use super::coverage::DiskCoverage;
use super::estimate::{Kernel, MapQuery};
use super::gather::{Gather, MapLayer, PathEnd, Shrinking};
use super::trace::PHOTONS_A_PATH;
use super::{MapKind, Nearest, Photon, PhotonJob, PhotonMap, Tally, shoot};
use crate::camera::Camera;
use crate::control::{Cancel, Parallel};
use crate::desc::{CacheSource, IntegratorDesc, KernelDesc, RenderDesc};
use crate::error::{Error, ErrorKind, Result};
use crate::scene::Scene;

/// Light paths of a map that is made once.
const ONCE: u32 = 1_000_000;

/// Light paths of a pass.
const EACH_PASS: u32 = 1 << 17;

/// One in so many light paths more is followed before the first map, to learn where disks are whole.
const SCOUTS: u32 = 4;

/// The report's radius.
const REPORT_RADIUS: f32 = 0.1;

/// First radii, in pixels as the middle one sees them.
const CAUSTIC_PIXELS: f32 = 2.0;
const INDIRECT_PIXELS: f32 = 8.0;

/// Photons that the first radius of a pixel of its own holds.
const FIRST_PHOTONS: u32 = 32;

/// Photons that the first radius of a map of indirect light holds in the middle, where none is given.
const INDIRECT_PHOTONS: usize = 150;

/// Photons at which that is measured.
const MEASURED: usize = 257;

/// The same in a map that is made once.
const ONLY_PHOTONS: u32 = 100;

/// Photons of caustics that eye paths meet beyond their first diffuse hit, and by what the radius is wider there.
const LATER_PHOTONS: usize = 1 << 14;
const LATER_WIDTH: f32 = 4.0;

/// Bytes a photon takes while its map is being built.
const BYTES_A_PHOTON: usize = 96;

/// Samples of a pixel for each pass of photons: few where an image has many pixels.
fn samples_a_pass(pixels: u64) -> u32 {
    if pixels <= 1 << 18 { 4 } else { 1 }
}

/// What a method needs to know of photons, and has made of them so far.
#[derive(Debug)]
pub struct Plan {
    scene: Scene,
    camera: Camera,
    desc: Arc<RenderDesc>,
    method: IntegratorDesc,
    /// First radii.
    caustic_radius: f32,
    radius: f32,
    coverage: DiskCoverage,
    /// Maps that were gathered from, of whose photons `coverage` may know from now on.
    unlearnt: Vec<Arc<PhotonMap>>,
    made: Option<(u32, Gather)>,
    notes: Vec<String>,
    /// Rays that went into maps.
    pub rays: u64,
}

impl Plan {
    /// Prepares a method: checks it against the scene, finds radii where none are given.
    ///
    /// # Errors
    /// [`ErrorKind::InvalidScene`] for settings that a file could not have given.
    pub fn new(scene: &Scene, camera: &Camera, desc: &Arc<RenderDesc>, method: IntegratorDesc) -> Result<Self> {
        let photons = &desc.photons;
        // A host may have set numbers that no file could.
        desc.check()?;
        let pixel = pixel_size(scene, camera, desc.resolution);
        let otherwise = match method {
            IntegratorDesc::PhotonDirect => REPORT_RADIUS,
            _ => INDIRECT_PIXELS * pixel,
        };
        // Squares of radii fit single precision, by the limits of `desc::RADII`.
        let radius = |given: Option<f64>, otherwise: f32| given.map_or(otherwise, |radius| radius as f32);
        let caustic_radius = radius(photons.caustic_radius, CAUSTIC_PIXELS * pixel);
        Ok(Self {
            scene: scene.clone(),
            camera: *camera,
            desc: Arc::clone(desc),
            method,
            caustic_radius,
            radius: radius(photons.radius, otherwise),
            coverage: DiskCoverage::default(),
            unlearnt: Vec::new(),
            made: None,
            notes: Vec::new(),
            rays: 0,
        })
    }

    /// Samples of each pixel that share the maps of one pass; `None` where maps are made once.
    pub fn samples_a_pass(&self) -> Option<u32> {
        let pixels = self.desc.resolution.map(u64::from).into_iter().product();
        self.is_progressive().then(|| samples_a_pass(pixels))
    }

    /// Whether pixels remember anything between samples.
    pub fn remembers(&self) -> bool {
        self.is_by_pixel() || self.is_progressive()
    }

    /// Whether each pixel has radii of its own: unless the user says how many photons make an estimate, or the method has
    /// one radius by its nature.
    pub fn is_by_pixel(&self) -> bool {
        self.method != IntegratorDesc::Ppm && self.desc.photons.neighbours.is_none()
    }

    fn is_progressive(&self) -> bool {
        match self.method {
            IntegratorDesc::Ppm | IntegratorDesc::Sppm => true,
            IntegratorDesc::Caustic => self.desc.photons.progressive,
            _ => false,
        }
    }

    /// What a user should know about the maps.
    pub fn notes(&self) -> &[String] {
        &self.notes
    }

    /// The integrator for the samples from `sample` on, with maps that are made now unless they are there.
    ///
    /// # Errors
    /// [`ErrorKind::Cancelled`]; `OutOfMemory` where not even a small map fits; `InvalidScene` for settings that do not fit
    /// the scene.
    pub fn gather(&mut self, sample: u32, parallel: &mut impl Parallel) -> Result<Gather> {
        let pass = self.samples_a_pass().map_or(0, |samples| sample / samples);
        if let Some((made, gather)) = &self.made
            && *made == pass
        {
            return Ok(gather.clone());
        }
        self.made = None;
        let gather = self.make(pass, parallel)?;
        self.made = Some((pass, gather.clone()));
        Ok(gather)
    }

    fn make(&mut self, pass: u32, parallel: &mut impl Parallel) -> Result<Gather> {
        let photons = &self.desc.photons;
        let shrunk = if self.is_progressive() { shrunk(pass, photons.alpha) } else { 1.0 };
        let by_pixel = self.is_by_pixel();
        // Where each pixel has a radius of its own, the others keep within the common one.
        let (radius, caustic_radius) = (self.radius * shrunk, self.caustic_radius * shrunk);
        let kernel = |otherwise| Kernel::new(photons.kernel.unwrap_or(otherwise));
        let (epanechnikov, cone) = (kernel(KernelDesc::Epanechnikov), kernel(KernelDesc::Cone { k: 1.0 }));
        let default_count = if self.is_progressive() { EACH_PASS } else { ONCE };
        let count = photons.count.unwrap_or(default_count);
        let caustic_count = photons.caustic_count.unwrap_or(default_count);
        // 0 is the same as none, but where each pixel would have a radius of its own.
        let neighbours = photons.neighbours.filter(|count| *count > 0);
        let kinds = self.scene.kinds();

        // Changed when all is done: a pass that is stopped is made again, from what was known before.
        let mut coverage = self.coverage.clone();
        let is_once = !self.is_progressive();
        for map in &self.unlearnt {
            self.rays += coverage.learn(&self.scene, map.photons(), radius.min(caustic_radius), is_once, parallel)?;
        }

        // What is shot, how much of it, and how it is asked.
        let mut wanted = Vec::new();
        let query = |kernel, radius, neighbours| MapQuery { kernel, radius, neighbours };
        let caustics =
            |kernel, neighbours| (MapKind::Caustic, caustic_count, query(kernel, caustic_radius, neighbours));
        let ends = match self.method {
            IntegratorDesc::PhotonDirect => {
                wanted.push((MapKind::Direct, count, query(cone, radius, None)));
                wanted.push(caustics(cone, None));
                PathEnd::Never
            }
            IntegratorDesc::Photon => {
                wanted.push(caustics(epanechnikov, neighbours));
                wanted.push((MapKind::Global, count, query(epanechnikov, radius, neighbours)));
                PathEnd::AfterGather
            }
            IntegratorDesc::Ppm | IntegratorDesc::Sppm => {
                wanted.push(caustics(epanechnikov, neighbours));
                wanted.push((MapKind::Indirect, count, query(epanechnikov, radius, neighbours)));
                PathEnd::AtOnce
            }
            IntegratorDesc::IrradianceCache => {
                wanted.push(caustics(epanechnikov, neighbours));
                if self.desc.cache.source == CacheSource::Photons {
                    wanted.push((MapKind::Global, count, query(epanechnikov, radius, neighbours)));
                }
                PathEnd::Never
            }
            _ => {
                wanted.push(caustics(epanechnikov, neighbours));
                PathEnd::Never
            }
        };
        // Mirrors and glass are not there to be met, nor surfaces to be lit by them.
        wanted.retain(|(kind, ..)| kinds.diffuse && (*kind != MapKind::Caustic || kinds.specular));
        // Of large lamps they are found by rays, with no bias and no mottle.
        let is_asked_for = photons.caustic_count.is_some() || photons.caustic_radius.is_some();
        let aims = if self.method == IntegratorDesc::IrradianceCache
            && kinds.specular
            && !is_asked_for
            && aimed_paths_find_caustics(&self.scene)?
        {
            wanted.retain(|(kind, ..)| *kind != MapKind::Caustic);
            Some(Aims::new(&self.scene))
        } else {
            None
        };
        let budget = (photons.memory as usize).saturating_mul(1 << 20) / BYTES_A_PHOTON;
        let mut shots: Vec<(MapKind, MapQuery, Vec<Photon>)> = Vec::new();
        let (mut told, mut shot_as, mut notes) = (Vec::new(), Vec::new(), Vec::new());
        let maps = wanted.len();
        for (kind, paths, query) in wanted {
            let used: usize = shots.iter().map(|(_, _, photons)| photons.len()).sum();
            // What is left, the second map's share apart.
            let most = (budget - used.min(budget)) / (maps - shots.len());
            if most < PHOTONS_A_PATH {
                let message = format!("{} MiB hold no photon map", photons.memory);
                return Err(Error::new(ErrorKind::OutOfMemory, message));
            }
            let shot = shoot(&self.scene, &self.desc, PhotonJob { kind, paths, pass, most }, parallel)?;
            self.rays += shot.tally.rays;
            if let Some(planned) = shot.cut_from
                && pass == 0
            {
                notes.push(format!(
                    "the {} photon map was ended after {} of {planned} light paths: photonMemory allows {} MiB",
                    kind.name(),
                    shot.tally.paths,
                    photons.memory
                ));
            }
            told.push(shot.tally);
            shot_as.push((paths, most));
            shots.push((kind, query, shot.photons));
        }
        let (kinds, shots): (Vec<_>, Vec<_>) =
            shots.into_iter().map(|(kind, query, photons)| ((kind, query), std::sync::Mutex::new(photons))).unzip();
        // Side by side, each on one thread.
        let token = parallel.token();
        let built = parallel.map(shots.len(), move |index| {
            let photons = std::mem::take(&mut *shots[index].lock().unwrap_or_else(std::sync::PoisonError::into_inner));
            PhotonMap::build(photons, &token)
        })?;
        let mut layers = Vec::new();
        for ((kind, query), map) in kinds.into_iter().zip(built) {
            let widest = query.radius / shrunk;
            layers.push((kind, MapLayer { map: Arc::new(map?), query, widest }));
        }
        let is_diffuse = |kind: MapKind| matches!(kind, MapKind::Indirect | MapKind::Global);
        if pass == 0 && photons.radius.is_none() && neighbours.is_none() {
            for (_, layer) in layers.iter_mut().filter(|(kind, layer)| is_diffuse(*kind) && !layer.map.is_empty()) {
                self.radius = middle_radius(&layer.map, self.radius);
                (layer.query.radius, layer.widest) = (self.radius, self.radius);
            }
        }
        if pass == 0 {
            let widest = layers.iter().map(|(_, layer)| layer.widest).fold(f32::MIN_POSITIVE, f32::max);
            coverage = DiskCoverage::new(widest);
        }
        for ((kind, layer), (paths, most)) in layers.iter().zip(shot_as) {
            let radius = layer.query.radius;
            if *kind == MapKind::Caustic {
                // Its estimates are made anywhere, on whole disks or cut ones.
                self.rays += coverage.learn(&self.scene, layer.map.photons(), radius, is_once, parallel)?;
            } else if pass == 0 {
                // Photons of no pass, as no others are known yet.
                let job = PhotonJob { kind: *kind, paths: paths.div_ceil(SCOUTS), pass: u32::MAX, most };
                let scouts = shoot(&self.scene, &self.desc, job, parallel)?;
                self.rays += scouts.tally.rays;
                self.rays += coverage.learn(&self.scene, &scouts.photons, radius, is_once, parallel)?;
            }
        }
        if pass == 0 {
            let one = |((kind, layer), tally): (&(MapKind, MapLayer), &Tally)| note(*kind, layer, tally, by_pixel);
            notes.extend(layers.iter().zip(&told).map(one));
        }
        // What is gathered from now teaches nothing before the next pass.
        let unlearnt = layers.iter().filter(|(kind, _)| !is_once && *kind != MapKind::Caustic);
        let unlearnt: Vec<_> = unlearnt.map(|(_, layer)| Arc::clone(&layer.map)).collect();
        let mut take = |wanted: &[MapKind]| {
            let place = layers.iter().position(|(kind, layer)| wanted.contains(kind) && !layer.map.is_empty())?;
            Some(layers.swap_remove(place).1)
        };
        let shrinking = if by_pixel {
            let (alpha, first) =
                if self.is_progressive() { (photons.alpha as f32, FIRST_PHOTONS) } else { (1.0, ONLY_PHOTONS) };
            Shrinking::ByPixel { alpha, first }
        } else {
            Shrinking::Together
        };
        let direct = take(&[MapKind::Direct]);
        let caustic = take(&[MapKind::Caustic]);
        let later = caustic.as_ref().map(|layer| thinned(layer, &parallel.token())).transpose()?;
        let mut gather = Gather {
            cache: None,
            caustic,
            diffuse: take(&[MapKind::Indirect, MapKind::Global]),
            direct,
            later_caustic: later,
            coverage: coverage.clone(),
            ends,
            shrinking,
            pass,
            max_depth: self.desc.max_depth.unwrap_or(u32::MAX),
            shadow_rays: self.desc.shadow_rays,
            min_photons: photons.min_photons,
            gather_rays: photons.gather_rays,
            aims,
        };
        if self.method == IntegratorDesc::IrradianceCache {
            // Gather rays have bounced once when they begin, so the global map may end them at once.
            let ends = if gather.diffuse.is_some() { PathEnd::AfterGather } else { PathEnd::Never };
            let source = Gather { ends, ..gather.clone() };
            let (cache, report) = IrradianceCache::fill(&self.scene, &self.camera, &self.desc, &source, parallel)?;
            self.rays += report.rays;
            notes.extend(report.notes);
            (gather.cache, gather.diffuse, gather.ends) = (Some(Arc::new(cache)), None, PathEnd::AtCache);
        }
        (self.coverage, self.unlearnt) = (coverage, unlearnt);
        self.notes.extend(notes);
        Ok(gather)
    }
}

impl MapKind {
    /// Its name in messages and on the command line.
    pub fn name(self) -> &'static str {
        match self {
            Self::Direct => "direct",
            Self::Caustic => "caustic",
            Self::Indirect => "indirect",
            Self::Global => "global",
        }
    }
}

/// What a user should know about a map.
fn note(kind: MapKind, layer: &MapLayer, tally: &Tally, by_pixel: bool) -> String {
    let photons = layer.map.len();
    let shadows = if tally.shadows > 0 { format!(" and {} shadow photons", tally.shadows) } else { String::new() };
    let radius = if by_pixel && kind != MapKind::Direct { "radius, at most," } else { "radius" };
    let lost = if tally.emitted.max_element() > 0.0 {
        100.0 * tally.escaped.max_element() / tally.emitted.max_element()
    } else {
        0.0
    };
    format!(
        "{} photon map: {} photons{shadows} of {} light paths, {lost:.0} % of their light left the scene; {:.1} MiB, {:.0} bytes \
         a photon; {radius} {:.3e}",
        kind.name(),
        tally.stored,
        tally.paths,
        layer.map.bytes() as f64 / 1_048_576.0,
        layer.map.bytes() as f64 / photons.max(1) as f64,
        layer.query.radius
    )
}

/// By what a radius has shrunk after so many passes: the root of the product of (i + alpha) / (i + 1).
///
/// Source: Knaus and Zwicker 2011, "Progressive Photon Mapping: A Probabilistic Approach", Eq. 18 to 20.
pub fn shrunk(passes: u32, alpha: f64) -> f32 {
    // Where many, the product falls as n^(alpha - 1).
    let few = passes.min(4096);
    let product: f64 = (1..=few).map(|i| (f64::from(i) + alpha) / (f64::from(i) + 1.0)).product();
    let (n, m) = (f64::from(passes) + 1.0, f64::from(few) + 1.0);
    let rest = if passes > few { (n / m).powf(alpha - 1.0) } else { 1.0 };
    (product * rest).sqrt() as f32
}

/// As much light in fewer photons, for a wider radius: every so many'th of the map's order, which keeps them well spread.
fn thinned(layer: &MapLayer, cancel: &Cancel) -> Result<MapLayer> {
    let stride = layer.map.len().div_ceil(LATER_PHOTONS).max(1);
    let mut photons: Vec<Photon> = layer.map.photons().iter().skip(stride / 2).step_by(stride).copied().collect();
    let factor = layer.map.len() as f32 / photons.len().max(1) as f32;
    for photon in &mut photons {
        photon.power = photon.power.map(|power| power * factor);
    }
    let map = Arc::new(PhotonMap::build(photons, cancel)?);
    let query = MapQuery { neighbours: None, ..layer.query };
    Ok(MapLayer { map, query, widest: LATER_WIDTH * layer.query.radius })
}

/// The middle one of the radii that hold [`INDIRECT_PHOTONS`] around photons of a map; `otherwise` where it has too few.
fn middle_radius(map: &PhotonMap, otherwise: f32) -> f32 {
    let mut nearest = Nearest::default();
    let stride = map.len().div_ceil(MEASURED).max(1);
    let mut radii = Vec::new();
    for photon in map.photons().iter().step_by(stride) {
        map.nearest(photon.position(), INDIRECT_PHOTONS, f32::INFINITY, &mut nearest);
        match nearest.found() {
            [.., (distance2, _)] if nearest.found().len() == INDIRECT_PHOTONS && *distance2 > 0.0 => {
                radii.push(distance2.sqrt());
            }
            _ => {}
        }
    }
    if radii.is_empty() {
        return otherwise;
    }
    let middle = radii.len() / 2;
    *radii.select_nth_unstable_by(middle, f32::total_cmp).1
}

/// Lines and columns of the grid of pixels that are looked at for their size.
const LOOKS: u32 = 32;

/// Mirrors and glass in a row through which a pixel is followed.
const MOST_SPECULAR: u32 = 16;

/// What the middle one of many pixels sees of a diffuse surface: its distance times the angle of a pixel. Where none is
/// seen, a thousandth of the scene.
fn pixel_size(scene: &Scene, camera: &Camera, resolution: [u32; 2]) -> f32 {
    let [width, height] = resolution.map(|n| n as f32);
    let mut tracer = SceneTracer::new(scene);
    let mut sizes = Vec::new();
    for i in 0..LOOKS * LOOKS {
        let at = |k: u32, size: f32| (k as f32 + 0.5) / LOOKS as f32 * size;
        let (x, y) = (at(i % LOOKS, width), at(i / LOOKS, height));
        let angle = camera.ray(x, y).direction.distance(camera.ray(x + 1.0, y).direction);
        let mut ray = camera.ray(x, y);
        let mut way = 0.0;
        for _ in 0..MOST_SPECULAR {
            let Some(hit) = tracer.intersect(&ray) else { break };
            way += hit.t;
            let vertex = Vertex::new(scene, &ray, &hit);
            if vertex.material.bsdf.is_delta() {
                // Glass is seen through.
                let Some(bounce) = vertex.sample_bounce([0.5, 0.5, 0.999, 0.0]) else { break };
                ray = bounce.ray;
                continue;
            }
            if !vertex.material.bsdf.is_black() {
                sizes.push(way * angle);
            }
            break;
        }
    }
    let middle = sizes.len() / 2;
    if sizes.is_empty() {
        let bounds = &scene.info().bounds;
        let extent = if bounds.is_empty() { 1.0 } else { (bounds.max - bounds.min).length() };
        return (1e-3 * extent) as f32;
    }
    *sizes.select_nth_unstable_by(middle, f32::total_cmp).1
}
