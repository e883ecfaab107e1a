//! Plans which maps a method needs, with which radii, and when they are made.

mod maps;

use std::sync::Arc;

use maps::{BuiltMap, ShotMap, WantedMap, build_maps, thinned};

use super::super::aim::Aims;
use super::super::irradiance_cache::{FillReport, fill_within};
use super::super::{check_still, check_support};
use super::choose::aimed_paths_find_caustics;
use super::coverage::DiskCoverage;
use super::division::{Division, narrow_below};
use super::estimate::{Kernel, MapQuery};
use super::gather::{Gather, PathEnd, Shrinking};
use super::radius::{Lengths, measure, middle_radius, shrunk};
use super::trace::PHOTONS_A_PATH;
use super::{MapKind, PhotonJob, PhotonMap, shoot_in};
use crate::camera::Camera;
use crate::control::{Cancel, Parallel};
use crate::desc::{CacheSource, IntegratorDesc, KernelDesc, MapRenewal, PhotonMethod, Preparation, RenderDesc};
use crate::error::{Error, ErrorKind, Result};
use crate::sampling::Rng;
use crate::scene::Scene;
use crate::spectrum::{Rgb, Sensor, Spectrum};

/// Number of light paths of a map that is made once.
const ONCE: u32 = 1_000_000;

/// Number of light paths of a pass.
const EACH_PASS: u32 = 1 << 17;

/// Before the first map, additional light paths, one for this many light paths of the map, show where the surface covers
/// kernels' disks.
const SCOUTS: u32 = 4;

/// The report's radius.
const REPORT_RADIUS: f32 = 0.1;

/// First radii, in pixels of the median size that the camera sees.
const CAUSTIC_PIXELS: f32 = 2.0;
const INDIRECT_PIXELS: f32 = 8.0;

/// Number of photons that the first radius of a pixel with its own radius holds.
const FIRST_PHOTONS: u32 = 32;

/// The same number for a map that is made once.
const ONLY_PHOTONS: u32 = 100;

/// Bytes a photon takes while its map is being built.
const BYTES_A_PHOTON: usize = 96;

/// Samples of each pixel per pass of photons: fewer where an image has many pixels.
fn samples_a_pass(pixels: u64) -> u32 {
    if pixels <= 1 << 18 { 4 } else { 1 }
}

/// What the maps of later passes depend on besides the settings: what the maps of earlier passes have shown.
#[derive(Clone, Debug)]
pub struct PlanState {
    /// The pass whose maps were made last.
    pub pass: u32,
    /// The radius that was found for indirect light.
    pub radius: f32,
    pub(crate) coverage: DiskCoverage,
}

/// The photon maps of a method: the settings, and the maps made so far.
#[derive(Debug)]
pub struct Plan<C: Spectrum = Rgb> {
    scene: Scene,
    /// Whether more than the camera moves, so that each pass has a moment of its own.
    moves: bool,
    camera: Camera,
    desc: Arc<RenderDesc>,
    /// What the film's channels are.
    sensor: Sensor,
    method: PhotonMethod,
    renewal: MapRenewal,
    /// First radii.
    caustic_radius: f32,
    radius: f32,
    /// Width below which glossy lobes count as delta lobes.
    narrow_below: f32,
    coverage: DiskCoverage,
    /// Maps that have been gathered from already, so that `coverage` may now learn from their photons.
    unlearnt: Vec<Arc<PhotonMap<C>>>,
    /// The pass after which `coverage` and `unlearnt` are as they are; `None` before the first one.
    known: Option<u32>,
    made: Option<(u32, Gather<C>)>,
    /// The state to go on from, until the maps of its pass are made again.
    resumed: Option<PlanState>,
    notes: Vec<String>,
    /// Number of rays traced for the maps.
    pub rays: u64,
}

impl Plan {
    /// Prepares the maps of an integrator: checks the settings, and finds radii where none are given.
    ///
    /// # Errors
    /// [`ErrorKind::InvalidScene`] for settings that a file could not contain, and for an integrator without photon maps;
    /// [`ErrorKind::Unsupported`] for a scene that the integrator does not take.
    pub fn new(scene: &Scene, camera: &Camera, desc: &Arc<RenderDesc>, integrator: IntegratorDesc) -> Result<Self> {
        Self::in_spectrum(scene, camera, desc, integrator)
    }

    /// The integrator for the samples from `sample` on. Its maps are made by this call unless they exist already.
    ///
    /// # Errors
    /// [`ErrorKind::Cancelled`]; `OutOfMemory` where not even a small map fits; `InvalidScene` for settings that do not fit
    /// the scene.
    pub fn gather(&mut self, sample: u32, parallel: &mut impl Parallel) -> Result<Gather> {
        self.gather_with(sample, parallel, |plan, gather, notes, parallel| match plan.method {
            PhotonMethod::IrradianceCache => plan.fill_cache(gather, u64::MAX, notes, parallel).map(|_| ()),
            _ => Ok(()),
        })
    }

    /// Whether an irradiance cache needs no photon map: no light comes to diffuse surfaces by mirrors and glass, or rays that are aimed at
    /// these find it.
    ///
    /// # Errors
    /// As [`Plan::gather`].
    pub fn is_cache_alone(&self) -> Result<bool> {
        let is_aimed = self.aims()?.is_some();
        Ok(self.method == PhotonMethod::IrradianceCache && self.wanted_maps(1.0, is_aimed).is_empty())
    }

    /// The integrator that reads the irradiance cache, and the root mean square of the relative error of indirect light that the cache has
    /// found in itself, where it knows. `None` where filling the cache takes more than so many rays.
    ///
    /// # Errors
    /// As [`Plan::gather`].
    pub fn cache_within(
        &mut self,
        most_rays: u64,
        parallel: &mut impl Parallel,
    ) -> Result<Option<(Gather, Option<f64>)>> {
        let mut filled = None;
        // An earlier call may have been cancelled.
        (self.made, self.notes) = (None, Vec::new());
        let gather = self.gather_with(0, parallel, |plan, gather, notes, parallel| {
            filled = plan.fill_cache(gather, most_rays, notes, parallel)?;
            Ok(())
        })?;
        if filled.is_none() {
            self.made = None;
        }
        Ok(filled.map(|report| (gather, report.rms_error)))
    }

    /// Fills the irradiance cache, in which the integrator's paths end; the global map is used only for filling. Returns `None`, and makes no
    /// cache, where filling takes more than so many rays.
    fn fill_cache(
        &mut self,
        gather: &mut Gather,
        most_rays: u64,
        notes: &mut Vec<String>,
        parallel: &mut impl Parallel,
    ) -> Result<Option<FillReport>> {
        // Gather rays begin after one bounce, so the global map may end them at the first diffuse hit.
        let ends = if gather.diffuse.is_some() { PathEnd::AfterGather } else { PathEnd::Never };
        let source = Gather { ends, ..gather.clone() };
        let (cache, report) = fill_within(&self.scene, &self.camera, &self.desc, &source, most_rays, parallel)?;
        self.rays += report.rays;
        let Some(cache) = cache else { return Ok(None) };
        notes.extend(report.notes.iter().cloned());
        *gather = gather.ending_at(Arc::new(cache));
        Ok(Some(report))
    }
}

impl<C: Spectrum> Plan<C> {
    /// [`Plan::new`] for photons and eye paths that carry `C`.
    ///
    /// # Errors
    /// As [`Plan::new`].
    pub fn in_spectrum(
        scene: &Scene,
        camera: &Camera,
        desc: &Arc<RenderDesc>,
        integrator: IntegratorDesc,
    ) -> Result<Self> {
        let Preparation::PhotonMaps(method, renewal) = integrator.info().preparation else {
            return Err(Error::invalid("render.integrator", format!("{} reads no photon maps", integrator.name())));
        };
        let photons = &desc.photons;
        // A host may have set numbers that no file could contain.
        desc.check()?;
        check_support(scene, integrator)?;
        let moves = scene.has_moving_world();
        if moves && !is_progressive(renewal, desc) {
            check_still(scene, &format!("{} with maps that are made once", integrator.name()))?;
        }
        let Lengths { pixel, distance } = measure(scene, camera, desc.resolution);
        let otherwise = match method {
            PhotonMethod::Direct => REPORT_RADIUS,
            PhotonMethod::Caustic
            | PhotonMethod::FinalGather
            | PhotonMethod::IrradianceCache
            | PhotonMethod::CommonRadius
            | PhotonMethod::PixelRadii => INDIRECT_PIXELS * pixel,
        };
        // The limits of `desc::RADII` keep squares of radii within single precision.
        let radius = |given: Option<f64>, otherwise: f32| given.map_or(otherwise, |radius| radius as f32);
        let caustic_radius = radius(photons.caustic_radius, CAUSTIC_PIXELS * pixel);
        let radius = radius(photons.radius, otherwise);
        Ok(Self {
            scene: scene.clone(),
            moves,
            camera: *camera,
            desc: Arc::clone(desc),
            sensor: Sensor::Observer,
            method,
            renewal,
            caustic_radius,
            radius,
            narrow_below: narrow_below(radius, distance),
            coverage: DiskCoverage::default(),
            unlearnt: Vec::new(),
            known: None,
            made: None,
            resumed: None,
            notes: Vec::new(),
            rays: 0,
        })
    }

    /// The same plan for films whose channels are those of another sensor than the standard observer.
    #[must_use]
    pub fn for_sensor(mut self, sensor: Sensor) -> Self {
        self.sensor = sensor;
        self
    }

    /// Samples of each pixel that share the maps of one pass; `None` where maps are made once.
    pub fn samples_a_pass(&self) -> Option<u32> {
        let pixels = self.desc.resolution.map(u64::from).into_iter().product();
        self.is_progressive().then(|| samples_a_pass(pixels))
    }

    /// Whether pixels keep state between samples.
    pub fn remembers(&self) -> bool {
        self.is_by_pixel() || self.is_progressive()
    }

    /// Whether each pixel has radii of its own. This is not so where the user sets the number of photons of an estimate, or
    /// where the method has one common radius.
    pub fn is_by_pixel(&self) -> bool {
        self.method != PhotonMethod::CommonRadius && self.desc.photons.neighbours.is_none()
    }

    fn is_progressive(&self) -> bool {
        is_progressive(self.renewal, &self.desc)
    }

    /// The state from which another plan goes on; `None` before the first maps, and where maps are made only once.
    pub fn state(&self) -> Option<PlanState> {
        // While the maps of a pass are made, or after that was cancelled, what is known is that of the pass before.
        let known = |pass| PlanState { pass, radius: self.radius, coverage: self.coverage.clone() };
        self.known.filter(|_| self.is_progressive()).map(known).or_else(|| self.resumed.clone())
    }

    /// Goes on from a state of a plan with the same settings.
    pub fn resume(&mut self, state: PlanState) {
        self.resumed = Some(state);
    }

    /// Messages about the maps for the user.
    pub fn notes(&self) -> &[String] {
        &self.notes
    }

    /// [`Plan::gather`] for photons and eye paths that carry `C`.
    ///
    /// # Errors
    /// As [`Plan::gather`]; `Unsupported` for the irradiance cache, which stores RGB only, and for maps that are made once,
    /// which would give the whole image one set of wavelengths.
    pub fn gather_in_spectrum(&mut self, sample: u32, parallel: &mut impl Parallel) -> Result<Gather<C>> {
        if self.method == PhotonMethod::IrradianceCache {
            let message = "the irradiance cache holds three channels, expected another integrator for wavelengths";
            return Err(Error::new(ErrorKind::Unsupported, message));
        }
        if size_of::<C::Wavelengths>() != 0 && !self.is_progressive() {
            let message = "maps that are made once have one set of wavelengths, expected a progressive method";
            return Err(Error::new(ErrorKind::Unsupported, message));
        }
        self.gather_with(sample, parallel, |_, _, _, _| Ok(()))
    }

    fn gather_with<P: Parallel>(
        &mut self,
        sample: u32,
        parallel: &mut P,
        complete: impl FnOnce(&mut Self, &mut Gather<C>, &mut Vec<String>, &mut P) -> Result<()>,
    ) -> Result<Gather<C>> {
        let pass = self.samples_a_pass().map_or(0, |samples| sample / samples);
        if let Some((made, gather)) = &self.made
            && *made == pass
        {
            return Ok(gather.clone());
        }
        self.made = None;
        if let Some(state) = self.resumed.clone() {
            let of = state.pass;
            let gather = self.make_again(state, parallel)?;
            self.resumed = None;
            if of == pass {
                self.made = Some((pass, gather.clone()));
                return Ok(gather);
            }
        }
        if self.is_progressive() {
            // What is known of the surface is learnt pass by pass. A helper may have left passes out that others were faster with.
            for missed in self.known.map_or(0, |known| known + 1)..pass {
                self.make(missed, parallel, |_, _, _, _| Ok(()))?;
            }
        }
        let gather = self.make(pass, parallel, complete)?;
        self.made = Some((pass, gather.clone()));
        Ok(gather)
    }

    /// The wavelengths of a pass, which its photons and the eye paths that query them share. Wavelengths are spread evenly
    /// over passes.
    fn wavelengths(&self, pass: u32) -> C::Wavelengths {
        C::sample_wavelengths_for(self.sensor, || self.spread(0, pass))
    }

    /// The moment of a pass ([`crate::math::Ray::time`]), which its photons and the eye paths that query them share; `None` where
    /// nothing but the camera moves. Moments are spread over passes as the shutter is open.
    fn moment(&self, pass: u32) -> Option<f32> {
        self.moves.then(|| self.scene.moment(self.spread(1, pass)))
    }

    /// A number in [0, 1) for a pass; those of successive passes are spread evenly. Each `stream` begins elsewhere.
    fn spread(&self, stream: u64, pass: u32) -> f32 {
        /// Fraction of the golden ratio, whose multiples are spread evenly over [0, 1).
        const STEP: f64 = 0.618_033_988_749_894_9;
        let first = f64::from(Rng::new(self.desc.seed, stream).next_f32());
        ((first + f64::from(pass) * STEP).fract() as f32).min(1.0_f32.next_down())
    }

    /// Makes the maps of a pass, and the integrator that gathers from them.
    fn make<P: Parallel>(
        &mut self,
        pass: u32,
        parallel: &mut P,
        complete: impl FnOnce(&mut Self, &mut Gather<C>, &mut Vec<String>, &mut P) -> Result<()>,
    ) -> Result<Gather<C>> {
        let shrunk = if self.is_progressive() { shrunk(pass, self.desc.photons.alpha) } else { 1.0 };
        // The plan is changed at the end only: a cancelled pass is made again from the same state.
        let mut coverage = self.coverage_so_far(shrunk, parallel)?;
        let aims = self.aims()?;
        let wanted = self.wanted_maps(shrunk, aims.is_some());
        let mut notes = Vec::new();
        let shot = self.shoot_maps(wanted, pass, &mut notes, parallel)?;
        let mut maps = build_maps(shot, shrunk, parallel)?;
        if pass == 0 {
            self.measure_radius(&mut maps);
        }
        if self.is_uncovered(pass) {
            let widest = maps.iter().map(|map| map.layer.widest).fold(f32::MIN_POSITIVE, f32::max);
            coverage = DiskCoverage::new(widest, self.moment(pass).unwrap_or_default());
        }
        self.learn_coverage(&mut coverage, &maps, pass, parallel)?;
        if pass == 0 {
            notes.extend(maps.iter().map(|map| map.note(self.is_by_pixel())));
        }
        let unlearnt = self.unlearnt(&maps, pass);
        let mut gather = self.gatherer(maps, aims, coverage.clone(), pass, &parallel.token())?;
        complete(self, &mut gather, &mut notes, parallel)?;
        (self.coverage, self.unlearnt, self.known) = (coverage, unlearnt, Some(pass));
        self.notes.extend(notes);
        Ok(gather)
    }

    /// The maps from which coverage learns after this pass: only before the next one, so that what is gathered from them and what
    /// they teach are independent.
    fn unlearnt(&self, maps: &[BuiltMap<C>], pass: u32) -> Vec<Arc<PhotonMap<C>>> {
        let is_kept = self.is_progressive() && !self.is_uncovered(pass + 1);
        let teaches = |map: &&BuiltMap<C>| is_kept && map.kind != MapKind::Caustic;
        maps.iter().filter(teaches).map(|map| Arc::clone(&map.layer.map)).collect()
    }

    /// Makes the maps of a pass that another plan has made, when it was in this state.
    fn make_again(&mut self, state: PlanState, parallel: &mut impl Parallel) -> Result<Gather<C>> {
        let PlanState { pass, radius, coverage } = state;
        let shrunk = shrunk(pass, self.desc.photons.alpha);
        let aims = self.aims()?;
        self.radius = radius;
        let wanted = self.wanted_maps(shrunk, aims.is_some());
        let mut notes = Vec::new();
        let shot = self.shoot_maps(wanted, pass, &mut notes, parallel)?;
        let maps = build_maps(shot, shrunk, parallel)?;
        let unlearnt = self.unlearnt(&maps, pass);
        let gather = self.gatherer(maps, aims, coverage.clone(), pass, &parallel.token())?;
        (self.coverage, self.unlearnt, self.known) = (coverage, unlearnt, Some(pass));
        self.notes.extend(notes);
        Ok(gather)
    }

    /// Whether nothing is known before this pass of where the surface covers disks: it is the first, or something moves, so that the
    /// passes see the surface at different moments.
    fn is_uncovered(&self, pass: u32) -> bool {
        pass == 0 || self.moves
    }

    /// The known coverage of kernels' disks, updated by the photons of the last pass.
    fn coverage_so_far(&mut self, shrunk: f32, parallel: &mut impl Parallel) -> Result<DiskCoverage> {
        let mut coverage = self.coverage.clone();
        let radius = (self.radius * shrunk).min(self.caustic_radius * shrunk);
        let is_once = !self.is_progressive();
        for map in &self.unlearnt {
            self.rays += coverage.learn(&self.scene, map.photons(), radius, is_once, parallel)?;
        }
        Ok(coverage)
    }

    /// The specular parts at which rays are aimed where such rays find the caustics of large lamps, without the bias and
    /// low-frequency noise of a map, so that no caustic map is needed.
    fn aims(&self) -> Result<Option<Aims>> {
        let photons = &self.desc.photons;
        let is_asked_for = photons.caustic_count.is_some() || photons.caustic_radius.is_some();
        let finds_caustics = self.method == PhotonMethod::IrradianceCache
            && self.scene.lobes().have_specular()
            // Aimed rays follow delta lobes only.
            && !self.scene.has_narrow_glossy(self.narrow_below)
            && !is_asked_for
            && aimed_paths_find_caustics(&self.scene)?;
        Ok(finds_caustics.then(|| Aims::new(&self.scene, self.narrow_below)))
    }

    /// Number of photons in an estimate, where the user sets it: 0 means none, except that pixels then have no radii of
    /// their own.
    fn neighbours(&self) -> Option<u32> {
        self.desc.photons.neighbours.filter(|count| *count > 0)
    }

    /// The maps that are shot, with their numbers of light paths and the parameters of their queries.
    fn wanted_maps(&self, shrunk: f32, is_aimed: bool) -> Vec<WantedMap> {
        let photons = &self.desc.photons;
        let kernel = |otherwise| Kernel::new(photons.kernel.unwrap_or(otherwise));
        let (epanechnikov, cone) = (kernel(KernelDesc::Epanechnikov), kernel(KernelDesc::Cone { k: 1.0 }));
        let default_count = if self.is_progressive() { EACH_PASS } else { ONCE };
        let neighbours = self.neighbours();
        // Where pixels have radii of their own, the other queries take the common radius as a limit.
        let wanted = |kind, kernel, neighbours| {
            let (count, radius) = match kind {
                MapKind::Caustic => (photons.caustic_count, self.caustic_radius),
                MapKind::Direct | MapKind::Indirect | MapKind::Global => (photons.count, self.radius),
            };
            let query = MapQuery { kernel, radius: radius * shrunk, neighbours };
            WantedMap { kind, paths: count.unwrap_or(default_count), query }
        };
        let caustic = wanted(MapKind::Caustic, epanechnikov, neighbours);
        let mut maps = match self.method {
            PhotonMethod::Direct => {
                vec![wanted(MapKind::Direct, cone, None), wanted(MapKind::Caustic, cone, None)]
            }
            PhotonMethod::FinalGather => vec![caustic, wanted(MapKind::Global, epanechnikov, neighbours)],
            PhotonMethod::CommonRadius | PhotonMethod::PixelRadii => {
                vec![caustic, wanted(MapKind::Indirect, epanechnikov, neighbours)]
            }
            PhotonMethod::IrradianceCache => match self.desc.cache.source {
                CacheSource::Photons => vec![caustic, wanted(MapKind::Global, epanechnikov, neighbours)],
                CacheSource::Paths => vec![caustic],
            },
            PhotonMethod::Caustic => vec![caustic],
        };
        // Photons are stored only on diffuse surfaces, and caustics need mirrors or glass.
        let is_lit = self.scene.lobes().have_diffuse();
        let has_caustics = self.scene.has_narrow(self.narrow_below) && !is_aimed;
        maps.retain(|map| is_lit && (map.kind != MapKind::Caustic || has_caustics));
        maps
    }

    /// Shoots the photons of all maps of a pass within `photonMemory`. The notes of the first pass name the maps that this
    /// limit cuts.
    fn shoot_maps(
        &mut self,
        wanted: Vec<WantedMap>,
        pass: u32,
        notes: &mut Vec<String>,
        parallel: &mut impl Parallel,
    ) -> Result<Vec<ShotMap<C>>> {
        let memory = self.desc.photons.memory;
        let budget = (memory as usize).saturating_mul(1 << 20) / BYTES_A_PHOTON;
        let mut shot: Vec<ShotMap<C>> = Vec::new();
        let maps = wanted.len();
        for wanted in wanted {
            let used: usize = shot.iter().map(|map| map.batch.photons.len()).sum();
            // The remaining memory is shared evenly by the maps that are still to be shot.
            let most = (budget - used.min(budget)) / (maps - shot.len());
            if most < PHOTONS_A_PATH {
                return Err(Error::new(ErrorKind::OutOfMemory, format!("{memory} MiB hold no photon map")));
            }
            let WantedMap { kind, paths, .. } = wanted;
            let time = self.moment(pass).unwrap_or_default();
            let job = PhotonJob { kind, paths, pass, most, narrow_below: self.narrow_below, time };
            let batch = shoot_in::<C>(&self.scene, &self.desc, job, self.wavelengths(pass), parallel)?;
            self.rays += batch.tally.rays;
            if let Some(planned) = batch.cut_from
                && pass == 0
            {
                notes.push(format!(
                    "the {} photon map was ended after {} of {planned} light paths: photonMemory allows {memory} MiB",
                    kind.name(),
                    batch.tally.paths,
                ));
            }
            shot.push(ShotMap { wanted, most, batch });
        }
        Ok(shot)
    }

    /// Sets the radius of maps of indirect light by the density of their photons, where none is given.
    fn measure_radius(&mut self, maps: &mut [BuiltMap<C>]) {
        if self.desc.photons.radius.is_some() || self.neighbours().is_some() {
            return;
        }
        for BuiltMap { layer, .. } in maps.iter_mut().filter(|map| map.is_of_indirect_light()) {
            if !layer.map.is_empty() {
                self.radius = middle_radius(&layer.map, self.radius);
                (layer.query.radius, layer.widest) = (self.radius, self.radius);
            }
        }
    }

    /// Learns where the surface covers kernels' disks: at the photons of the caustic map, and in the first pass at photons
    /// that are shot for this purpose only.
    fn learn_coverage(
        &mut self,
        coverage: &mut DiskCoverage,
        maps: &[BuiltMap<C>],
        pass: u32,
        parallel: &mut impl Parallel,
    ) -> Result<()> {
        let is_once = !self.is_progressive();
        for &BuiltMap { kind, paths, most, ref layer, .. } in maps {
            let radius = layer.query.radius;
            if kind == MapKind::Caustic {
                // Caustic estimates are made everywhere, on whole disks or clipped ones.
                self.rays += coverage.learn(&self.scene, layer.map.photons(), radius, is_once, parallel)?;
            } else if self.is_uncovered(pass) {
                // The photons belong to no pass: no earlier one knows this surface.
                let paths = paths.div_ceil(SCOUTS);
                let time = self.moment(pass).unwrap_or_default();
                let job = PhotonJob { kind, paths, pass: u32::MAX - pass, most, narrow_below: self.narrow_below, time };
                let scouts = shoot_in::<C>(&self.scene, &self.desc, job, self.wavelengths(pass), parallel)?;
                self.rays += scouts.tally.rays;
                self.rays += coverage.learn(&self.scene, &scouts.photons, radius, is_once, parallel)?;
            }
        }
        Ok(())
    }

    /// The integrator that gathers from these maps.
    fn gatherer(
        &self,
        mut maps: Vec<BuiltMap<C>>,
        aims: Option<Aims>,
        coverage: DiskCoverage,
        pass: u32,
        cancel: &Cancel,
    ) -> Result<Gather<C>> {
        let photons = &self.desc.photons;
        let mut take = |wanted: &[MapKind]| {
            let place = maps.iter().position(|map| wanted.contains(&map.kind) && !map.layer.map.is_empty())?;
            Some(maps.swap_remove(place).layer)
        };
        let (direct, caustic) = (take(&[MapKind::Direct]), take(&[MapKind::Caustic]));
        let diffuse = take(&[MapKind::Indirect, MapKind::Global]);
        let shrinking = match (self.is_by_pixel(), self.is_progressive()) {
            (true, true) => Shrinking::ByPixel { alpha: photons.alpha as f32, first: FIRST_PHOTONS },
            (true, false) => Shrinking::ByPixel { alpha: 1.0, first: ONLY_PHOTONS },
            (false, _) => Shrinking::Together,
        };
        let ends = match self.method {
            PhotonMethod::CommonRadius | PhotonMethod::PixelRadii => PathEnd::AtOnce,
            PhotonMethod::FinalGather => PathEnd::AfterGather,
            PhotonMethod::Direct | PhotonMethod::Caustic | PhotonMethod::IrradianceCache => PathEnd::Never,
        };
        let division = Arc::new(Division::new(&self.scene, self.narrow_below, &self.wavelengths(pass)));
        Ok(Gather {
            cache: None,
            division,
            later_caustic: caustic.as_ref().map(|layer| thinned(layer, cancel)).transpose()?,
            caustic,
            diffuse,
            direct,
            coverage,
            ends,
            shrinking,
            pass,
            moment: self.moment(pass),
            wavelengths: self.wavelengths(pass),
            sensor: self.sensor,
            max_depth: self.desc.max_depth.unwrap_or(u32::MAX),
            shadow_rays: self.desc.shadow_rays,
            min_photons: photons.min_photons,
            gather_rays: photons.gather_rays,
            aims,
        })
    }
}

/// Whether maps are made for every pass.
fn is_progressive(renewal: MapRenewal, desc: &RenderDesc) -> bool {
    match renewal {
        MapRenewal::EachPass => true,
        MapRenewal::EachPassByDefault => desc.photons.progressive,
        MapRenewal::Once => false,
    }
}
