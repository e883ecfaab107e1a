//! Light paths: traces photons from the emitters through the scene and stores them.
//!
//! Russian roulette continues a path with the probability that keeps the photon's power unchanged except for its colour. All
//! photons of a map therefore have about the same power, and none wastes memory or time. A photon that leaves the scene is
//! counted and not replaced. Power, unlike radiance, is not scaled by refraction.
//!
//! Each path is a pure function of (seed, map, pass, index of the path). Paths are traced in blocks that are joined in their
//! order, so that any number of threads gives the same map.

use std::sync::Arc;

use super::super::media::{arrive, left_after};
use super::super::vertex::Vertex;
use super::super::walk::roulette;
use super::super::{SceneTracer, Tracer as _};
use super::Photon;
use super::division::{Division, PARTS, choose_part};
use super::emit::{Aim, Emission};
use crate::bsdf::Parts;
use crate::control::Parallel;
use crate::desc::RenderDesc;
use crate::error::Result;
use crate::math::{DVec3, Ray, Vec3};
use crate::room::{check_room, check_room_of_threads, grow};
use crate::sampling::{Sampler as _, SobolSampler};
use crate::scene::Scene;
use crate::spectrum::{Rgb, Spectrum};

/// The light paths whose photons a map holds.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum MapKind {
    /// Light straight from the emitters, and shadow photons on the surfaces behind the first hit.
    Direct,
    /// Light that came by mirrors and glass only (LS+D), or by lobes that count as mirrors.
    Caustic,
    /// Light that was scattered diffusely before it arrived.
    Indirect,
    /// All light.
    Global,
}

impl MapKind {
    /// The map's name in messages and on the command line.
    pub fn name(self) -> &'static str {
        match self {
            Self::Direct => "direct",
            Self::Caustic => "caustic",
            Self::Indirect => "indirect",
            Self::Global => "global",
        }
    }
}

/// Balance of the light that was emitted, power (W).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Tally {
    /// Number of light paths, including those that carry no power.
    pub paths: u64,
    /// Number of photons stored, without shadow photons.
    pub stored: u64,
    /// Number of shadow photons stored.
    pub shadows: u64,
    /// Number of rays traced.
    pub rays: u64,
    /// Emitted power.
    pub emitted: DVec3,
    /// Power that left the scene.
    pub escaped: DVec3,
    /// Power absorbed by media, and by surfaces: the incident power less the power that continues, which includes the effect of Russian
    /// roulette.
    pub absorbed: DVec3,
    /// Power that paths still carried when the depth limit cut them, or when they could store no more photons in this map.
    pub left: DVec3,
}

impl Tally {
    fn add(&mut self, other: &Self) {
        self.paths += other.paths;
        self.stored += other.stored;
        self.shadows += other.shadows;
        self.rays += other.rays;
        self.emitted += other.emitted;
        self.escaped += other.escaped;
        self.absorbed += other.absorbed;
        self.left += other.left;
    }

    fn scale(&mut self, factor: f64) {
        for power in [&mut self.emitted, &mut self.escaped, &mut self.absorbed, &mut self.left] {
            *power *= factor;
        }
    }
}

/// Stored photons, and the balance of all light.
#[derive(Clone, Debug, Default)]
pub struct PhotonBatch<C: Spectrum = Rgb> {
    /// Photons in the order of their paths; the power of all paths together is the power of the emitters.
    pub photons: Vec<Photon<C>>,
    /// See [`Tally`].
    pub tally: Tally,
    /// Number of paths that were asked for, where the memory limit ended the batch earlier.
    pub cut_from: Option<u64>,
}

/// Light paths in a block, the unit of work of a thread.
const BLOCK: u32 = 1 << 10;

/// Most blocks between two checks of the memory limit.
const ROUND: usize = 64;

/// Greatest number of photons that a light path is assumed to store, for planning block sizes.
pub(super) const PHOTONS_A_PATH: usize = 64;

/// A batch of light paths: their number, the photons to store and the random numbers.
#[derive(Clone, Copy, Debug)]
pub struct PhotonJob {
    /// The photons that are stored.
    pub kind: MapKind,
    /// Number of light paths.
    pub paths: u32,
    /// Index of the pass; each pass has its own random numbers.
    pub pass: u32,
    /// Most photons that are kept, whatever the number of paths.
    pub most: usize,
    /// Width below which glossy lobes count as delta lobes, as that of [`crate::bsdf::Model::narrowest`]; above 0.
    pub narrow_below: f32,
    /// The moment at which the light paths see the scene ([`Ray::time`]); it counts where something moves while the shutter is open.
    pub time: f32,
}

/// Traces light paths and stores photons. The batch is empty where nothing emits light or no photon could be of this kind.
///
/// # Errors
/// [`crate::ErrorKind::Cancelled`]; `InvalidScene` for point lights that share photons by area.
pub fn shoot(scene: &Scene, desc: &RenderDesc, job: PhotonJob, parallel: &mut impl Parallel) -> Result<PhotonBatch> {
    shoot_in(scene, desc, job, (), parallel)
}

/// As [`shoot`], for photons of these wavelengths.
///
/// # Errors
/// As [`shoot`].
pub fn shoot_in<C: Spectrum>(
    scene: &Scene,
    desc: &RenderDesc,
    job: PhotonJob,
    wavelengths: C::Wavelengths,
    parallel: &mut impl Parallel,
) -> Result<PhotonBatch<C>> {
    let aims = match job.kind {
        MapKind::Caustic if desc.photons.guided => Aim::AtSpecular { narrow_below: job.narrow_below },
        _ => Aim::Everywhere,
    };
    let Some(emission) = Emission::at(scene, desc.photons.sharing, aims, job.time)? else {
        return Ok(PhotonBatch::default());
    };
    let kind = job.kind as u64;
    let photon_tracer = Arc::new(PhotonTracer::<C> {
        wavelengths,
        scene: scene.clone(),
        emission,
        division: Division::new(scene, job.narrow_below, &wavelengths),
        kind: job.kind,
        // Each kind of map has its own family of random numbers, apart from those of the pixels.
        sampler: SobolSampler::new(desc.seed ^ (0x0070_686f_746f_6e00 + kind), u32::MAX),
        pass: job.pass,
        share: 1.0 / f64::from(job.paths.max(1)),
        max_depth: desc.max_depth.unwrap_or(u32::MAX),
    });
    // Where few photons may be kept, a single block must not exceed the limit by itself.
    let size = BLOCK.min((job.most / PHOTONS_A_PATH).max(1) as u32);
    let blocks = job.paths.div_ceil(size) as usize;
    let mut shot = PhotonBatch::default();
    let (mut start, mut count) = (0, 1_usize);
    // The photons that a block is expected to store at most.
    let mut each = size as usize * PHOTONS_A_PATH;
    while start < blocks {
        // The blocks' own lists have grown to twice their room, beside what they were.
        let bytes = count.saturating_mul(each).saturating_mul(2 * size_of::<Photon<C>>());
        check_room_of_threads(bytes, scene.device().threads())?;
        let photon_tracer = Arc::clone(&photon_tracer);
        let shots = parallel.map(count, move |block| {
            let first = (start + block) as u32 * size;
            photon_tracer.block(first, first.saturating_add(size).min(job.paths))
        })?;
        let shots = shots.into_iter().collect::<Result<Vec<_>>>()?;
        start += count;
        // A vector that grows to twice its room has its old items beside the new ones.
        let photons = shot.photons.len() + shots.iter().map(|block| block.photons.len()).sum::<usize>();
        check_room(photons.saturating_mul(2 * size_of::<Photon<C>>()))?;
        for block in shots {
            shot.photons.extend_from_slice(&block.photons);
            shot.tally.add(&block.tally);
        }
        // As many blocks follow as fit even if each stores twice as many photons as the blocks so far.
        each = 2 * shot.photons.len().div_ceil(start).max(1);
        let fits = job.most.saturating_sub(shot.photons.len()) / each;
        if fits == 0 && start < blocks {
            shot.cut_from = Some(job.paths.into());
            break;
        }
        count = ROUND.min(fits).min(blocks - start);
    }
    if shot.cut_from.is_some() {
        let factor = f64::from(job.paths) / shot.tally.paths.max(1) as f64;
        for photon in &mut shot.photons {
            photon.scale(factor);
        }
        shot.tally.scale(factor);
    }
    Ok(shot)
}

/// The data that all blocks share.
struct PhotonTracer<C: Spectrum> {
    wavelengths: C::Wavelengths,
    scene: Scene,
    emission: Emission,
    division: Division<C>,
    kind: MapKind,
    sampler: SobolSampler,
    pass: u32,
    share: f64,
    max_depth: u32,
}

impl<C: Spectrum> PhotonTracer<C> {
    fn block(&self, from: u32, to: u32) -> Result<PhotonBatch<C>> {
        let mut sampler = self.sampler.clone();
        let mut tracer = SceneTracer::new(&self.scene);
        let mut shot = PhotonBatch::default();
        for path in from..to {
            // Hardly any path stores more, and the list grows to twice its room.
            grow(&mut shot.photons, PHOTONS_A_PATH)?;
            sampler.start(self.pass, path);
            shot.tally.paths += 1;
            let (u, d) = (sampler.next_4d(), sampler.next_4d());
            if let Some((ray, power)) = self.emission.begin(&self.scene, u, d, self.share) {
                let emitters = self.scene.emitters();
                let emitter = if emitters.asks_index::<C>() { self.emission.chosen(u, d) as u32 } else { 0 };
                let power = emitters.in_spectrum::<C>(emitter, power, &self.wavelengths);
                shot.tally.emitted += self.tallied(power);
                self.path(ray, power, &mut sampler, &mut tracer, &mut shot);
            }
        }
        shot.tally.rays = tracer.rays;
        Ok(shot)
    }

    /// A power as it is tallied: as RGB.
    fn tallied(&self, power: C) -> DVec3 {
        power.to_rgb(&self.wavelengths).to_f64()
    }

    fn path(
        &self,
        mut ray: Ray,
        mut power: C,
        sampler: &mut SobolSampler,
        tracer: &mut SceneTracer,
        shot: &mut PhotonBatch<C>,
    ) {
        let mut alone = C::Alone::default();
        let mut was_diffuse = false;
        let mut was_specular = false;
        let mut media = self.scene.media_at(&ray);
        for depth in 1_u32.. {
            let hit = arrive(&self.scene, tracer, &ray, &mut media);
            if media.is_some() {
                let left = power * left_after::<C>(&self.scene, &ray, hit.as_ref(), media, &self.wavelengths);
                shot.tally.absorbed += self.tallied(power) - self.tallied(left);
                power = left;
            }
            let Some(hit) = hit else {
                shot.tally.escaped += self.tallied(power);
                return;
            };
            let mut slot = None;
            let vertex = Vertex::of_light_path(&self.scene, &ray, &hit, self.wavelengths, media, &mut slot);
            let mut apart = None;
            let divided = self.division.at(&vertex, &mut apart);
            let mut slots = [None, None, None];
            let [diffuse, glossy, narrow] = divided.parts(&vertex, &mut slots);
            if depth == 1 && self.kind == MapKind::Direct {
                self.shadows(&ray, &vertex, tracer, shot);
            }
            if let Some(vertex) = diffuse {
                let is_wanted = match self.kind {
                    MapKind::Direct => !was_diffuse && !was_specular,
                    MapKind::Caustic => !was_diffuse && was_specular,
                    MapKind::Indirect => was_diffuse,
                    MapKind::Global => true,
                };
                if is_wanted {
                    shot.photons.push(vertex.photon(power, alone));
                    shot.tally.stored += 1;
                }
            }
            // Neither caustic photons beyond the first diffuse hit nor photons of direct light beyond any hit can be stored
            // any more.
            let is_over = match self.kind {
                MapKind::Direct => true,
                MapKind::Caustic => was_diffuse || (narrow.is_none() && !vertex.lobes.is_empty()),
                MapKind::Indirect | MapKind::Global => false,
            };
            if is_over || depth >= self.max_depth {
                shot.tally.left += self.tallied(power);
                return;
            }
            let parts = [diffuse, glossy, narrow];
            let chosen = match parts.iter().flatten().count() {
                0 | 1 => parts.iter().position(Option::is_some).map(|part| (part, 1.0)),
                _ => choose_part(parts, sampler.next_4d()[0]),
            };
            let u = sampler.next_4d();
            let bounce = chosen.and_then(|(part, probability)| {
                let vertex = parts[part]?;
                Some((vertex, PARTS[part], probability, vertex.sample_bounce(u)?))
            });
            let Some((vertex, part, probability, bounce)) = bounce else {
                shot.tally.absorbed += self.tallied(power);
                return;
            };
            was_specular |= part == Parts::NARROW;
            was_diffuse |= part != Parts::NARROW;
            let weight = if probability < 1.0 { bounce.weight / probability } else { bounce.weight };
            let mut scattered = power * weight * vertex.shading_adjoint(bounce.ray.direction);
            if C::HAS_WAVELENGTHS && bounce.disperses {
                scattered = scattered.keep_first(&mut alone);
            }
            // Scattered power may exceed the incident power where the Bsdf does not conserve energy for one direction; the
            // path then survives with certainty.
            let survival = roulette(scattered.max_element() / power.max_element(), depth);
            if survival.is_nan() || u[3] >= survival {
                shot.tally.absorbed += self.tallied(power);
                return;
            }
            let next = if survival < 1.0 { scattered / survival } else { scattered };
            shot.tally.absorbed += self.tallied(power) - self.tallied(next);
            power = next;
            ray = bounce.ray;
            media = vertex.media_beyond(&self.scene, &ray);
        }
    }

    /// Stores shadow photons behind the first surface that the light hit, straight along the ray: at the first hit of each
    /// body behind it, but not on the inside of a body that the light has already entered.
    fn shadows(&self, ray: &Ray, first: &Vertex<'_, C>, tracer: &mut SceneTracer, shot: &mut PhotonBatch<C>) {
        let mut inside = Vec::new();
        let mut from = first.through(ray.direction);
        let mut entered = first.enters(ray.direction).then_some(first.surface.surface);
        for _ in 0..MOST_SHADOWS {
            inside.extend(entered.take());
            let ray = Ray::new(from, ray.direction);
            let Some(hit) = tracer.intersect(&ray) else { return };
            let mut slot = None;
            let vertex = Vertex::of_light_path(&self.scene, &ray, &hit, self.wavelengths, first.media, &mut slot);
            let surface = vertex.surface.surface;
            if vertex.enters(ray.direction) {
                entered = Some(surface);
            }
            let exits = match inside.iter().position(|other| *other == surface) {
                Some(place) if !vertex.enters(ray.direction) => {
                    inside.swap_remove(place);
                    true
                }
                _ => false,
            };
            if !exits && vertex.lobes.have_diffuse() {
                shot.photons.push(vertex.photon(C::ZERO, C::Alone::default()));
                shot.tally.shadows += 1;
            }
            from = vertex.through(ray.direction);
        }
    }
}

/// Most surfaces along a ray that are tested for shadow photons.
const MOST_SHADOWS: usize = 64;

impl<C: Spectrum> Vertex<'_, C> {
    /// The photon for light of this power that arrived at the vertex.
    #[inline]
    pub(super) fn photon(&self, power: C, alone: C::Alone) -> Photon<C> {
        Photon::of_path(self.surface.point.p, self.facing(), self.wo_scene(), power, alone)
    }

    /// Whether a ray along `direction` passes from a surface's outer side to its inner side.
    fn enters(&self, direction: Vec3) -> bool {
        self.surface.ng.dot(direction) < 0.0
    }

    /// The origin of a ray that passes through the surface.
    fn through(&self, direction: Vec3) -> Vec3 {
        let side = if self.enters(direction) { -self.surface.ng } else { self.surface.ng };
        self.surface.point.offset(side)
    }
}
