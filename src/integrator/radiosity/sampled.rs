//! Direct light that no link carries, by sampling: light from infinity, and the light of points that shine unevenly.
//!
//! A link has one strength and one visible fraction for all of its receiver. A sky whose visible part differs in brightness and colour
//! from the rest, and a beam that ends within an element, have neither. Each leaf therefore has the mean of this light over the leaf, and
//! its value at the corners. They are found once; solving adds them to what links bring, and balances links alone.
//!
//! # Method
//!
//! - All estimates are of one kind: the mean over the unit square of what is sampled there. The square stands for directions where the
//!   light is wide, and for places of the leaf where it is narrow. A *trial* takes one sample in each cell of a grid. Cells that differ
//!   from a neighbour have an edge, of a shadow or a beam.
//! - By trials, leaves are divided until what the corners do not tell is an allowed error, as for links.
//! - In the end samples that decided nothing *measure* each leaf: one in each cell, and many in those with an edge. Where a sample falls
//!   never depends on its own result, so the estimate is unbiased.
//! - Points that send most of their light to less than the leaf are sampled by their beam instead of by the leaf's area.
//!
//! Sources: Kajiya 1986, "The Rendering Equation" (strata that follow the integrand); Mitchell 1996, "Consequences of Stratified Sampling
//! in Graphics"; Hanrahan, Salzman, Aupperle 1991, "A Rapid Hierarchical Radiosity Algorithm".

use std::sync::{Arc, PoisonError};

use super::DISCONTINUITY_THRESHOLD;
use super::elements::Elements;
use super::oracle::{RefinementOracle, SHADOW_ERROR, SPREAD_ERROR};
use super::refine::SharedHierarchy;
use super::vertices::{leaves, means_at_vertices};
use crate::control::Parallel;
use crate::emitter::{DirectedPoint, Emitter, Receiver};
use crate::error::Result;
use crate::math::{DVec3, HitPoint, Ray, Vec3};
use crate::room::collected;
use crate::sampling::{hash, solid_angle};
use crate::scene::Scene;
use crate::spectrum::Rgb;

/// Cells along a side of the square, at least and at most, and where the light is below the allowed error.
const CELLS: [usize; 2] = [8, 32];
const FEW_CELLS: usize = 4;

/// The light matters from this multiple of the allowed error on. Beyond that, there is a cell along a side for each multiple of
/// `ALLOWED_IN_CELLS`: what is missed between the cells is a larger error in a larger leaf.
const MATTERS: f64 = 0.5;
const ALLOWED_IN_CELLS: f64 = 16.0;

/// A cell differs from its neighbour where their light differs by more than this fraction of the mean.
const EDGE: f64 = 0.25;

/// Samples for all cells with an edge together, of each of the two estimates of a leaf's mean and of a corner, where the light matters.
const MEAN_SAMPLES: usize = 128;
const CORNER_SAMPLES: usize = 128;
/// The same where it does not.
const FEW_SAMPLES: usize = 16;

/// Samples along a side of a cell with an edge.
const FINEST: usize = 8;

/// Disks at infinity with a smaller 1 - cos of their angular radius are narrow: about 5 degrees.
const NARROW: f32 = 4e-3;

/// Salts of the random numbers: of trials, of the two estimates of a leaf's mean, and of those of its corners.
const TRIAL_SALT: u64 = 11;
const MEAN_SALTS: [u64; 2] = [12, 13];
const CORNER_SALT: u64 = 14;

/// Places keep this fraction of the distance to the centre from an element's sides, as those of links do.
const INWARDS: f64 = 1e-3;

/// Leaves that one task of the thread pool samples.
const LEAVES_PER_TASK: usize = 16;

/// How the light of an emitter spreads.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Spread {
    /// From many directions: an environment, a sky, a wide disk.
    Wide,
    /// From almost one direction: the sun.
    Narrow,
    /// From one direction.
    Parallel,
    /// From one point.
    Point,
}

/// An emitter whose light is sampled.
#[derive(Clone, Copy, Debug)]
struct Source {
    emitter: u32,
    spread: Spread,
}

/// The sampled light of a leaf.
#[derive(Clone, Copy, Debug)]
pub(super) struct LeafLight {
    /// Mean irradiance over the leaf [W m^-2].
    pub mean: Rgb,
    /// Irradiance at the corners [W m^-2].
    pub corners: [Rgb; 3],
    /// Error of the interpolation between the corners, as irradiance; NaN where there was no trial.
    error: f32,
}

const UNKNOWN: LeafLight = LeafLight { mean: Rgb::ZERO, corners: [Rgb::ZERO; 3], error: f32::NAN };

/// The sampled light of all leaves.
#[derive(Debug)]
pub(super) struct SampledLight {
    sources: Vec<Source>,
    /// Of each node; those that are no leaves are not read.
    leaves: Vec<LeafLight>,
    /// Power that arrives from infinity \[W\].
    pub from_infinity: DVec3,
    /// Standard error of the leaves' means, as root mean square by area, over the root mean square of the means.
    pub relative_error: f64,
}

impl SampledLight {
    /// `None` for a scene without such light.
    pub fn new(scene: &Scene) -> Option<Box<Self>> {
        let emitters = scene.emitters();
        if emitters.is_dark() || !(emitters.has_infinite() || emitters.has_directed()) {
            return None;
        }
        let spread = |emitter: &Emitter| match emitter {
            Emitter::Environment(_) | Emitter::EnvironmentMap(_) => Some(Spread::Wide),
            Emitter::Distant(distant) if !distant.is_disk() => Some(Spread::Parallel),
            Emitter::Distant(distant) if distant.one_minus_cos() < NARROW => Some(Spread::Narrow),
            Emitter::Distant(_) => Some(Spread::Wide),
            Emitter::Directed(_) => Some(Spread::Point),
            Emitter::Point { .. }
            | Emitter::Triangle(_)
            | Emitter::Textured(_)
            | Emitter::Sphere(_)
            | Emitter::TexturedSphere(_)
            | Emitter::Disk(_)
            | Emitter::Tube(_)
            | Emitter::InnerTube(_)
            | Emitter::Moving(_)
            | Emitter::Web(_) => None,
        };
        let lit = emitters.emitters().iter().zip(0..).filter(|(emitter, _)| emitter.power() != DVec3::ZERO);
        let sources = lit.filter_map(|(emitter, number)| Some(Source { emitter: number, spread: spread(emitter)? }));
        let sources: Vec<Source> = sources.collect();
        let light = Self { sources, leaves: Vec::new(), from_infinity: DVec3::ZERO, relative_error: 0.0 };
        (!light.sources.is_empty()).then(|| Box::new(light))
    }

    /// The light of a leaf; 0 before there is any estimate.
    pub fn of(&self, leaf: u32) -> &LeafLight {
        self.leaves.get(leaf as usize).unwrap_or(&UNKNOWN)
    }

    /// Memory, bytes.
    pub fn bytes(&self) -> usize {
        size_of_val(&*self.leaves)
    }
}

/// Divides the leaves whose corners do not tell the sampled light between them, by the oracle's threshold, and estimates that of all.
pub(super) fn divide(shared: &SharedHierarchy, parallel: &mut impl Parallel) -> Result<()> {
    loop {
        estimate(shared, parallel)?;
        let mut hierarchy = shared.write().unwrap_or_else(PoisonError::into_inner);
        let Some(sampled) = &hierarchy.sampled else { return Ok(()) };
        let oracle = &hierarchy.oracle;
        let found = leaves(&oracle.elements).map(|leaf| (leaf, hierarchy.sampled_at_corners(leaf)));
        let at_vertices = means_at_vertices(&oracle.elements, found);
        let is_wrong = |leaf: &u32| {
            let node = oracle.node(*leaf);
            let allowed = oracle.threshold / node.area.sqrt();
            // Vertices have the light of neighbours as well, which a large leaf in a shadow must not spread.
            let [a, b, c] = node.corners.map(|vertex| at_vertices[vertex as usize]);
            let spread = (hierarchy.sampled_over(*leaf) - (a + b + c) / 3.0).abs().max_element();
            let is_wrong = f64::from(sampled.of(*leaf).error) > allowed || spread > DISCONTINUITY_THRESHOLD * allowed;
            is_wrong && oracle.elements.is_divisible(*leaf)
        };
        let wrong: Vec<u32> = leaves(&oracle.elements).filter(is_wrong).collect();
        if wrong.is_empty() {
            return Ok(());
        }
        for leaf in wrong {
            hierarchy.divide(leaf);
            hierarchy.check_growth(0)?;
        }
    }
}

/// Estimates the sampled light of new leaves by trials.
pub(super) fn estimate(shared: &SharedHierarchy, parallel: &mut impl Parallel) -> Result<()> {
    let new: Arc<[u32]> = {
        let hierarchy = shared.read().unwrap_or_else(PoisonError::into_inner);
        let Some(sampled) = &hierarchy.sampled else { return Ok(()) };
        // The list of all leaves' light grows beside what is found.
        hierarchy.check_step(2 * size_of::<LeafLight>() * hierarchy.oracle.elements.nodes.len())?;
        leaves(&hierarchy.oracle.elements).filter(|&leaf| sampled.of(leaf).error.is_nan()).collect()
    };
    let of = |light: &SampledLight, oracle: &RefinementOracle, leaf| light.tried(oracle, leaf);
    let found = for_leaves(shared, &new, of, parallel)?;
    let mut hierarchy = shared.write().unwrap_or_else(PoisonError::into_inner);
    let nodes = hierarchy.oracle.elements.nodes.len();
    let Some(sampled) = &mut hierarchy.sampled else { return Ok(()) };
    sampled.leaves.resize(nodes, UNKNOWN);
    for (leaf, light) in new.iter().zip(found) {
        sampled.leaves[*leaf as usize] = light;
    }
    hierarchy.oracle.elements.check(hierarchy.bytes())
}

/// Measures the sampled light of all leaves, by samples that did not decide about any of them.
pub(super) fn measure(shared: &SharedHierarchy, parallel: &mut impl Parallel) -> Result<()> {
    let all: Arc<[u32]> = {
        let hierarchy = shared.read().unwrap_or_else(PoisonError::into_inner);
        if hierarchy.sampled.is_none() {
            return Ok(());
        }
        hierarchy.check_step(0)?;
        leaves(&hierarchy.oracle.elements).collect()
    };
    let of = |light: &SampledLight, oracle: &RefinementOracle, leaf| light.measured(oracle, leaf);
    let found = for_leaves(shared, &all, of, parallel)?;
    let mut hierarchy = shared.write().unwrap_or_else(PoisonError::into_inner);
    let hierarchy = &mut *hierarchy;
    let (Some(sampled), nodes) = (&mut hierarchy.sampled, &hierarchy.oracle.elements.nodes) else { return Ok(()) };
    sampled.from_infinity = DVec3::ZERO;
    let (mut variance, mut square) = (0.0, 0.0);
    for (&leaf, Measured { light, from_infinity, variance: of_leaf }) in all.iter().zip(found) {
        let area = nodes[leaf as usize].area;
        sampled.from_infinity += area * from_infinity;
        variance += area * of_leaf.element_sum();
        square += area * light.mean.to_f64().length_squared();
        sampled.leaves[leaf as usize] = light;
    }
    sampled.relative_error = if square > 0.0 { (variance / square).sqrt() } else { 0.0 };
    Ok(())
}

/// Finds something for each of these leaves, in parallel.
fn for_leaves<R: Send + 'static>(
    shared: &SharedHierarchy,
    leaves: &Arc<[u32]>,
    of: impl Fn(&SampledLight, &RefinementOracle, u32) -> R + Send + Sync + 'static,
    parallel: &mut impl Parallel,
) -> Result<Vec<R>> {
    let (hierarchy, leaves, count) = (Arc::clone(shared), Arc::clone(leaves), leaves.len());
    let found = parallel.map(leaves.len().div_ceil(LEAVES_PER_TASK), move |block| {
        let hierarchy = hierarchy.read().unwrap_or_else(PoisonError::into_inner);
        let Some(light) = &hierarchy.sampled else { return Vec::new() };
        let leaves = leaves[block * LEAVES_PER_TASK..].iter().take(LEAVES_PER_TASK);
        leaves.map(|&leaf| of(light, &hierarchy.oracle, leaf)).collect()
    })?;
    collected(found.into_iter().flatten(), count)
}

/// What was measured at a leaf.
struct Measured {
    light: LeafLight,
    /// The part of the mean that comes from infinity.
    from_infinity: DVec3,
    /// Of the mean.
    variance: DVec3,
}

impl SampledLight {
    /// The light of a leaf by trials.
    fn tried(&self, oracle: &RefinementOracle, leaf: u32) -> LeafLight {
        let key = hash(u64::from(leaf), TRIAL_SALT);
        let (mut mean, mut corners, mut error) = (DVec3::ZERO, [DVec3::ZERO; 3], 0.0);
        for (source, number) in self.sources.iter().zip(0..) {
            let sampling = Sampling::new(oracle, source, leaf);
            // The same numbers everywhere, so that differences between places are hardly noise.
            let key = hash(key, number);
            let over = sampling.trial_over(key);
            if sampling.beam.is_some() {
                // Corners tell nothing of it.
                mean += over.seen;
                corners = corners.map(|corner| corner + over.seen);
                error += over.seen.max_element();
                continue;
            }
            let at = sampling.trials_at_corners(key);
            error += sampling.error(&over, &at);
            mean += over.seen;
            corners = std::array::from_fn(|k| corners[k] + at[k].seen);
        }
        LeafLight { mean: Rgb::from_f64(mean), corners: corners.map(Rgb::from_f64), error: error as f32 }
    }

    fn measured(&self, oracle: &RefinementOracle, leaf: u32) -> Measured {
        let own = |salt: u64| hash(u64::from(leaf), salt);
        let (mut mean, mut corners) = (DVec3::ZERO, [DVec3::ZERO; 3]);
        let (mut from_infinity, mut variance) = (DVec3::ZERO, DVec3::ZERO);
        for (source, number) in self.sources.iter().zip(0..) {
            let sampling = Sampling::new(oracle, source, leaf);
            let trial_key = hash(own(TRIAL_SALT), number);
            let over = sampling.trial_over(trial_key);
            let [a, b] = MEAN_SALTS.map(|salt| sampling.measure_over(&over, hash(own(salt), number)));
            let here = 0.5 * (a + b);
            mean += here;
            variance += 0.25 * (a - b) * (a - b);
            if source.spread != Spread::Point {
                from_infinity += here;
            }
            if sampling.beam.is_some() {
                corners = corners.map(|corner| corner + here);
                continue;
            }
            let at = sampling.trials_at_corners(trial_key);
            for (k, corner) in corners.iter_mut().enumerate() {
                *corner += sampling.measure_at(&at[k], k, hash(hash(own(CORNER_SALT), k as u64), number));
            }
        }
        let light =
            LeafLight { mean: Rgb::from_f64(mean), corners: corners.map(Rgb::from_f64), error: self.of(leaf).error };
        Measured { light, from_infinity, variance }
    }
}

/// A place that light is sampled for: a point, and the normal there.
type Place = (HitPoint, Vec3);

/// Light that a sample found, times its weight [W m^-2]: without what is in the way, and whether anything is.
#[derive(Clone, Copy)]
struct Sample {
    light: DVec3,
    is_visible: bool,
}

const UNLIT: Sample = Sample { light: DVec3::ZERO, is_visible: true };

/// The light of one source at one leaf.
struct Sampling<'s> {
    oracle: &'s RefinementOracle,
    source: &'s Source,
    leaf: u32,
    corners: [Place; 3],
    /// Cells along a side of the square.
    cells: usize,
    /// A point whose beam is narrower than the leaf.
    beam: Option<&'s DirectedPoint>,
}

impl<'s> Sampling<'s> {
    fn new(oracle: &'s RefinementOracle, source: &'s Source, leaf: u32) -> Self {
        let emitter = &oracle.scene.emitters().emitters()[source.emitter as usize];
        let node = oracle.node(leaf);
        let corners = [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]].map(|at| place(&oracle.elements, leaf, at));
        let (most, beam) = match emitter {
            Emitter::Directed(point) => {
                let position = point.position.as_dvec3();
                let gap = (position.distance(node.centre) - node.radius).max(0.0);
                let peak = point.distribution.peak();
                let most = (peak / (gap * gap)).min(point.distribution.flux() / node.area);
                let triangle = oracle.elements.triangle(node);
                let is_flat = oracle.elements.shape(node.patch).is_none();
                let seen = solid_angle(triangle.map(|p| p - position));
                let is_beam = is_flat && seen * peak > point.distribution.flux();
                (most * point.intensity.to_f64().max_element(), is_beam.then_some(&**point))
            }
            // Across parallel light, or facing an even sky.
            emitter => (emitter.power().max_element() / emitter.area(), None),
        };
        let share = most * node.area.sqrt() / oracle.allowed;
        let cells = if share > MATTERS {
            ((share / ALLOWED_IN_CELLS).min(CELLS[1] as f64) as usize).max(CELLS[0])
        } else {
            FEW_CELLS
        };
        Self { oracle, source, leaf, corners, cells, beam }
    }

    /// Cells at a corner, where only directions differ.
    fn corner_cells(&self) -> usize {
        match self.source.spread {
            Spread::Wide => self.cells,
            Spread::Narrow => FEW_CELLS,
            Spread::Parallel | Spread::Point => 1,
        }
    }

    fn trial_over(&self, key: u64) -> Trial {
        Trial::new(self.cells, key, |a, b| self.over(a, b))
    }

    fn trials_at_corners(&self, key: u64) -> [Trial; 3] {
        self.corners.map(|place| Trial::new(self.corner_cells(), key, |a, _| self.at(place, a)))
    }

    fn measure_over(&self, trial: &Trial, key: u64) -> DVec3 {
        trial.measure(if self.cells > FEW_CELLS { MEAN_SAMPLES } else { FEW_SAMPLES }, key, |a, b| self.over(a, b))
    }

    fn measure_at(&self, trial: &Trial, corner: usize, key: u64) -> DVec3 {
        // One sample is all that there is of one direction.
        if trial.cells == 1 {
            return trial.seen;
        }
        let place = self.corners[corner];
        trial.measure(if self.cells > FEW_CELLS { CORNER_SAMPLES } else { FEW_SAMPLES }, key, |a, _| self.at(place, a))
    }

    /// A sample of the mean over the leaf: `a` is what is stratified, and `b` the rest.
    fn over(&self, a: [f64; 2], b: [f64; 2]) -> Sample {
        let of_leaf = |u| place(&self.oracle.elements, self.leaf, uniform(u));
        match (self.source.spread, self.beam) {
            (Spread::Wide, _) => self.at(of_leaf(b), a),
            (_, Some(point)) => self.in_beam(point, a),
            _ => self.at(of_leaf(a), b),
        }
    }

    /// A sample at a place.
    fn at(&self, (at, n): Place, u: [f64; 2]) -> Sample {
        let scene = &self.oracle.scene;
        let below_one = |u: f64| (u as f32).min(1.0 - 0.5 * f32::EPSILON);
        let receiver = Receiver::facing(at.p, n);
        let Some(found) =
            scene.emitters().sample_of((self.source.emitter, 1.0), receiver, at.time, u.map(below_one), false)
        else {
            return UNLIT;
        };
        let cosine = f64::from(n.dot(found.wi));
        let light = found.radiance.to_f64() * (cosine / f64::from(found.pdf));
        if cosine <= 0.0 || light == DVec3::ZERO || !light.is_finite() {
            return UNLIT;
        }
        let origin = at.offset(n);
        Sample { light, is_visible: scene.unoccluded(&Ray::segment(origin, found.target - origin, 1.0)) }
    }

    /// A sample of the mean over a flat leaf by a direction in which a point shines: what arrives within the leaf is flux over area.
    fn in_beam(&self, point: &DirectedPoint, u: [f64; 2]) -> Sample {
        let Self { oracle, leaf, .. } = *self;
        let node = oracle.node(leaf);
        // Single precision, and what it leaves.
        let coarse = u.map(|u| (u as f32).min(1.0 - 0.5 * f32::EPSILON));
        let rest = [0, 1].map(|k| ((u[k] - f64::from(coarse[k])) * 24_f64.exp2()).clamp(0.0, 1.0) as f32);
        let d = point.distribution.sample(coarse, rest).as_dvec3();
        let position = point.position.as_dvec3();
        let [a, b, c] = oracle.elements.triangle(node);
        let (along, height) = (d.dot(node.normal), (position - a).dot(node.normal));
        if along >= 0.0 || height <= 0.0 {
            return UNLIT;
        }
        let p = position - height / along * d;
        let (side, other, to) = (b - a, c - a, p - a);
        let cross = side.cross(other);
        let scale = cross.length_squared();
        let weights = [to.cross(other).dot(cross) / scale, side.cross(to).dot(cross) / scale];
        if !(weights[0] >= 0.0 && weights[1] >= 0.0 && weights[0] + weights[1] <= 1.0) {
            return UNLIT;
        }
        let light = point.power() / node.area;
        let (at, n) = place(&oracle.elements, leaf, weights);
        let origin = at.offset(n);
        let way = (point.position - origin) * (1.0 - 16.0 * f32::EPSILON);
        Sample { light, is_visible: oracle.scene.unoccluded(&Ray::segment(origin, way, 1.0)) }
    }

    /// Error of an interpolation between the corners, as irradiance. Noise counts as error, since it stays: it is the less the smaller
    /// the leaf is.
    fn error(&self, over: &Trial, at: &[Trial; 3]) -> f64 {
        let is_flat = self.oracle.elements.shape(self.oracle.node(self.leaf).patch).is_none();
        let is_even = self.source.spread != Spread::Point && is_flat;
        if is_even && over.is_clear() && at.iter().all(Trial::is_clear) {
            return 0.0;
        }
        let [a, b, c] = at.each_ref().map(|trial| trial.seen);
        let bend = (over.seen - (a + b + c) / 3.0).abs().max_element();
        let spread = (a.max(b).max(c) - a.min(b).min(c)).max_element();
        let error = bend + SPREAD_ERROR * spread;
        if self.source.spread == Spread::Wide {
            return error;
        }
        // The edge of a shadow is sharp, as for links.
        let (seen, all) = at
            .iter()
            .fold((3.0 * over.seen, 3.0 * over.light), |(seen, all), trial| (seen + trial.seen, all + trial.light));
        let visible = if all.element_sum() > 0.0 { seen.element_sum() / all.element_sum() } else { 1.0 };
        error + 2.0 * visible * (1.0 - visible) * over.light.max_element() / SHADOW_ERROR
    }
}

/// Weights of the second and third corner for a point of the unit square, uniform by area and continuous.
fn uniform([x, y]: [f64; 2]) -> [f64; 2] {
    let root = x.sqrt();
    [root * (1.0 - y), root * y]
}

fn place(elements: &Elements, leaf: u32, weights: [f64; 2]) -> Place {
    let weights = weights.map(|w| w + INWARDS * (1.0 / 3.0 - w));
    elements.point(&elements.nodes[leaf as usize], weights)
}

/// One sample in each cell of the unit square.
struct Trial {
    /// Cells along a side.
    cells: usize,
    /// Mean of the visible light.
    seen: DVec3,
    /// Mean of the light without what is in the way.
    light: DVec3,
    /// Which cells have an edge, row by row, and how many have.
    edges: Vec<bool>,
    count: usize,
}

impl Trial {
    fn new(cells: usize, key: u64, sample: impl Fn([f64; 2], [f64; 2]) -> Sample) -> Self {
        let (mut seen, mut light) = (DVec3::ZERO, DVec3::ZERO);
        let mut values = vec![0.0; cells * cells];
        let mut lit = 0;
        let mut others = Others::new(key);
        for (cell, value) in values.iter_mut().enumerate() {
            let found = sample(jittered(cell % cells, cell / cells, cells, hash(key, cell as u64)), others.next());
            light += found.light;
            lit += u32::from(found.light != DVec3::ZERO);
            if found.is_visible {
                seen += found.light;
                *value = found.light.max_element();
            }
        }
        let typical = if lit > 0 { light.max_element() / f64::from(lit) } else { 0.0 };
        let differs = |cell: usize| {
            let [x, y] = [cell % cells, cell / cells];
            let near = |x: usize| x.saturating_sub(1)..(x + 2).min(cells);
            near(y).any(|j| near(x).any(|i| (values[j * cells + i] - values[cell]).abs() > EDGE * typical))
        };
        let edges: Vec<bool> = (0..cells * cells).map(differs).collect();
        let (all, count) = ((cells * cells) as f64, edges.iter().filter(|&&edge| edge).count());
        Self { cells, seen: seen / all, light: light / all, edges, count }
    }

    /// Whether nothing is in the way.
    fn is_clear(&self) -> bool {
        self.seen == self.light
    }

    /// The mean of the visible light by other samples, with about `budget` of them in the cells with an edge.
    fn measure(&self, budget: usize, key: u64, sample: impl Fn([f64; 2], [f64; 2]) -> Sample) -> DVec3 {
        let fine = ((budget / self.count.max(1)) as f64).sqrt() as usize;
        let fine = fine.clamp(2, FINEST);
        let mut sum = DVec3::ZERO;
        let mut others = Others::new(key);
        for cell in 0..self.cells * self.cells {
            let [x, y] = [cell % self.cells, cell / self.cells];
            let parts = if self.edges[cell] { fine } else { 1 };
            let key = hash(key, cell as u64);
            let mut own = DVec3::ZERO;
            for part in 0..parts * parts {
                let [i, j] = [x * parts + part % parts, y * parts + part / parts];
                let found = sample(jittered(i, j, self.cells * parts, hash(key, part as u64)), others.next());
                if found.is_visible {
                    own += found.light;
                }
            }
            sum += own / (parts * parts) as f64;
        }
        sum / (self.cells * self.cells) as f64
    }
}

/// A random point of a cell of the unit square.
fn jittered(x: usize, y: usize, cells: usize, random: u64) -> [f64; 2] {
    let half = |bits: u64| (bits & 0xffff_ffff) as f64 / (1_u64 << 32) as f64;
    [(x as f64 + half(random)) / cells as f64, (y as f64 + half(random >> 32)) / cells as f64]
}

/// Points that are spread evenly over the unit square, in an order of their own (Roberts 2018).
struct Others {
    start: [f64; 2],
    count: u32,
}

impl Others {
    fn new(key: u64) -> Self {
        Self { start: jittered(0, 0, 1, hash(key, u64::MAX)), count: 0 }
    }

    fn next(&mut self) -> [f64; 2] {
        const STEPS: [f64; 2] = [0.754_877_666_246_692_8, 0.569_840_290_998_053_3];
        self.count += 1;
        [0, 1].map(|k| (self.start[k] + f64::from(self.count) * STEPS[k]).fract())
    }
}
