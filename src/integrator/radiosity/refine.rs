//! Refinement: creates links where their error is allowed, and elements where it is not.
//!
//! Refinement works in rounds, so that the number of threads changes nothing. The pairs of a round are evaluated in
//! parallel. Then nodes are subdivided in the order of the pairs, and their children form the pairs of the next round.

use std::sync::{Arc, PoisonError, RwLock};

use super::course::Course;
use super::elements::{Elements, Node};
use super::light::{DirectionalPolynomial, NodeRadiosity};
use super::links::{Link, POINT, PointLight};
use super::oracle::{PairDecision, RefinementOracle};
use super::rows::Rows;
use super::sampled::SampledLight;
use crate::control::Parallel;
use crate::emitter::Emitter;
use crate::error::Result;
use crate::math::DVec3;
use crate::room::{check_room, check_room_of_threads};
use crate::scene::Scene;
use crate::spectrum::Rgb;

/// Pairs that one task of the thread pool evaluates.
const PAIRS_PER_TASK: usize = 64;

/// Most pairs of one round.
const PAIRS_PER_ROUND: usize = 1 << 17;

/// Pairs whose nodes are divided and linked before the memory is looked at again.
const PAIRS_PER_CHECK: usize = 1 << 8;

/// Memory that so many pairs may add, each two nodes that are divided into four and sixteen pairs.
const GROWTH_BYTES: usize =
    PAIRS_PER_CHECK * (8 * (size_of::<Node>() + NODE_BYTES + 64) + 16 * size_of::<(u32, u32)>());

/// Memory of the decisions about a round of pairs: as tasks make them, with what belongs to each task.
const DECISION_BYTES: usize = size_of::<PairDecision>() + 8;

/// Memory of a node beside that of its element: radiosity, linear variation, spread, maximum, first link and scale. A vertex's irradiance
/// is counted with the nodes.
const NODE_BYTES: usize = 24 + 32 + 4 + 4 + 4 + 16 + 24;

/// Memory of a cluster.
const CLUSTER_BYTES: usize = size_of::<DirectionalPolynomial>();

/// Links that one task of the thread pool checks.
const LINKS_PER_TASK: usize = 1 << 12;

/// The elements and clusters, the links between them, and the data of a solution.
#[derive(Debug)]
pub(super) struct LinkHierarchy {
    pub oracle: RefinementOracle,
    /// Links in the order of their receivers, after [`sort`].
    pub links: Vec<Link>,
    /// Index of the first link of each node.
    pub first: Vec<u32>,
    /// Indices of all clusters' nodes, parents first.
    pub clusters: Vec<u32>,
    /// Factors on the irradiance that leaves gather over links; empty before the first balance.
    pub scale: Vec<Rgb>,
    /// Direct light that no link carries, where the scene has any.
    pub sampled: Option<Box<SampledLight>>,
    /// Sums of rows, where parts of the scene are closed.
    pub rows: Option<Box<Rows>>,
}

/// The hierarchy as the threads of a solution share it.
pub(super) type SharedHierarchy = Arc<RwLock<LinkHierarchy>>;

impl LinkHierarchy {
    /// A hierarchy without links, in which each element's radiosity is its emission.
    ///
    /// # Errors
    /// [`crate::ErrorKind::OutOfMemory`].
    pub fn new(scene: &Scene, elements: Elements) -> Result<Self> {
        check_room(NODE_BYTES * elements.nodes.len() + (CLUSTER_BYTES + 8) * elements.clusters as usize)?;
        let light = |emitter: &Emitter| match emitter {
            Emitter::Point { position, intensity } => {
                Some(PointLight { position: position.as_dvec3(), intensity: intensity.to_f64() })
            }
            _ => None,
        };
        let lights = scene.emitters().emitters().iter().filter_map(light).collect();
        let clusters = (0..elements.nodes.len() as u32).filter(|&i| elements.nodes[i as usize].is_cluster()).collect();
        let oracle = RefinementOracle {
            scene: scene.clone(),
            elements,
            radiosity: NodeRadiosity::default(),
            lights,
            threshold: 0.0,
            allowed: 0.0,
            at_vertices: Vec::new(),
        };
        let sampled = SampledLight::new(scene);
        let mut hierarchy =
            Self { oracle, links: Vec::new(), first: Vec::new(), clusters, scale: Vec::new(), sampled, rows: None };
        hierarchy.emit();
        Ok(hierarchy)
    }

    /// Divides the lamps whose radiance a texture varies: refinement looks at what lies below an element, but divides none for it.
    ///
    /// # Errors
    /// [`crate::ErrorKind::OutOfMemory`] where they need more elements than memory allows, and those of `check`, which is called for
    /// each of them.
    pub fn divide_lamps(&mut self, mut check: impl FnMut() -> Result<()>) -> Result<()> {
        let patches = self.oracle.elements.patches.iter();
        let mut waiting: Vec<u32> = patches.map(|patch| patch.node).collect();
        let first = self.oracle.elements.nodes.len();
        while let Some(number) = waiting.pop() {
            if self.oracle.elements.is_uneven_lamp(number) {
                check()?;
                waiting.extend(self.divide(number));
                self.check_growth(size_of_val(&*waiting))?;
            }
        }
        if self.oracle.elements.nodes.len() > first {
            self.emit();
        }
        Ok(())
    }

    /// Sets each element's radiosity to its emission.
    pub fn emit(&mut self) {
        let RefinementOracle { elements, radiosity, .. } = &mut self.oracle;
        let emitted = |(node, number): (&Node, u32)| {
            if node.is_cluster() { DVec3::ZERO } else { elements.emitted(number) }
        };
        radiosity.b = elements.nodes.iter().zip(0..).map(emitted).collect();
        radiosity.pull(elements);
    }

    /// Memory of the hierarchy, bytes.
    pub fn bytes(&self) -> usize {
        self.oracle.elements.bytes()
            + NODE_BYTES * self.oracle.elements.nodes.len()
            + size_of::<Link>() * self.links.len()
            + CLUSTER_BYTES * self.clusters.len()
            + self.sampled.as_ref().map_or(0, |sampled| sampled.bytes())
            + self.rows.as_ref().map_or(0, |rows| rows.bytes())
    }

    /// Fails where the hierarchy, with so many bytes beside it, is past the limit or has no room to grow.
    ///
    /// # Errors
    /// [`crate::ErrorKind::OutOfMemory`].
    pub fn check_growth(&self, beside: usize) -> Result<()> {
        let bytes = self.bytes() + beside;
        self.oracle.elements.check(bytes)?;
        // What grows next may be all there is, and then needs twice its room beside itself.
        self.check_room((bytes + GROWTH_BYTES).saturating_mul(2))
    }

    /// Fails where there is no room for a step of the solution and for so many bytes beside it. What steps find of nodes, vertices,
    /// clusters and links takes no more than these themselves.
    ///
    /// # Errors
    /// [`crate::ErrorKind::OutOfMemory`].
    pub fn check_step(&self, beside: usize) -> Result<()> {
        self.check_room(self.bytes().saturating_add(beside))
    }

    fn check_room(&self, bytes: usize) -> Result<()> {
        check_room_of_threads(bytes, self.oracle.scene.device().threads())
    }

    /// Sorts the links by their receivers.
    ///
    /// # Errors
    /// [`crate::ErrorKind::OutOfMemory`].
    pub fn sort(&mut self) -> Result<()> {
        self.check_step(0)?;
        self.links.sort_by_key(|link| (link.receiver, link.source));
        let nodes = self.oracle.elements.nodes.len();
        self.first = Vec::with_capacity(nodes + 1);
        let mut next = 0;
        for node in 0..=nodes as u32 {
            while next < self.links.len() && self.links[next].receiver < node {
                next += 1;
            }
            self.first.push(next as u32);
        }
        Ok(())
    }

    pub fn scale_of(&self, leaf: u32) -> DVec3 {
        self.scale.get(leaf as usize).map_or(DVec3::ONE, |scale| scale.to_f64())
    }

    /// Mean over a leaf of the irradiance that no link brings.
    pub fn sampled_over(&self, leaf: u32) -> DVec3 {
        self.sampled.as_ref().map_or(DVec3::ZERO, |sampled| sampled.of(leaf).mean.to_f64())
    }

    /// The same irradiance at the corners of a leaf.
    pub fn sampled_at_corners(&self, leaf: u32) -> [DVec3; 3] {
        self.sampled.as_ref().map_or([DVec3::ZERO; 3], |sampled| sampled.of(leaf).corners.map(|e| e.to_f64()))
    }

    /// How many links all leaves gather over, together: their own and those of the nodes above them.
    pub fn gathered_links(&self) -> usize {
        let nodes = &self.oracle.elements.nodes;
        let parent = |number: &usize| Some(nodes[*number].parent as usize).filter(|parent| *parent < nodes.len());
        let of = |leaf: usize| {
            let own_and_above = std::iter::successors(Some(leaf), parent);
            own_and_above.map(|number| (self.first[number + 1] - self.first[number]) as usize).sum::<usize>()
        };
        let leaves = nodes.iter().enumerate().filter(|(_, node)| !node.is_cluster() && node.is_leaf());
        leaves.map(|(leaf, _)| of(leaf)).sum()
    }

    pub fn links_of(&self, node: u32) -> &[Link] {
        &self.links[self.first[node as usize] as usize..self.first[node as usize + 1] as usize]
    }

    /// The children of a node, which is subdivided where it has none. New children start with its radiosity.
    pub fn divide(&mut self, number: u32) -> std::ops::Range<u32> {
        let is_new = self.oracle.elements.nodes[number as usize].is_leaf();
        let parts = self.oracle.elements.children_of(number);
        if is_new {
            for part in parts.clone() {
                self.oracle.elements.nodes[part as usize].is_discontinuous = self.oracle.has_contact(part);
            }
        }
        let RefinementOracle { elements, radiosity, .. } = &mut self.oracle;
        if radiosity.b.len() < elements.nodes.len() {
            let b = radiosity.b[number as usize];
            radiosity.b.resize(elements.nodes.len(), b);
            radiosity.largest.resize(elements.nodes.len(), b.max_element() as f32);
            radiosity.spread.resize(elements.nodes.len(), 0.0);
            radiosity.tilt.resize(elements.nodes.len(), Default::default());
        }
        parts
    }

    /// Carries out the decisions on pairs: adds links, and appends the pairs of children to `next`.
    ///
    /// # Errors
    /// [`crate::ErrorKind::OutOfMemory`].
    fn apply(
        &mut self,
        pairs: &[(u32, u32)],
        decisions: impl Iterator<Item = PairDecision>,
        next: &mut Vec<(u32, u32)>,
    ) -> Result<()> {
        for (number, (&(receiver, source), decision)) in pairs.iter().zip(decisions).enumerate() {
            if number % PAIRS_PER_CHECK == 0 {
                self.check_growth(2 * size_of_val(&**next))?;
            }
            match decision {
                PairDecision::NoTransport => {}
                PairDecision::Link(link) => self.links.push(link),
                PairDecision::SubdivideReceiver => next.extend(self.divide(receiver).map(|part| (part, source))),
                PairDecision::SubdivideSource => next.extend(self.divide(source).map(|part| (receiver, part))),
                PairDecision::SubdivideBoth => {
                    let parts = self.divide(receiver);
                    next.extend(parts.clone().flat_map(|a| parts.clone().map(move |b| (a, b))));
                }
            }
        }
        Ok(())
    }
}

/// The pairs with which refinement starts.
pub(super) fn first_pairs(hierarchy: &LinkHierarchy) -> Vec<(u32, u32)> {
    let top = hierarchy.oracle.elements.top;
    let lights = (0..hierarchy.oracle.lights.len() as u32).map(|light| (top, POINT + light));
    std::iter::once((top, top)).chain(lights).collect()
}

/// Factor on the allowed error once refinement ends early: that of the refinement before, whose links are among the pairs.
const COARSER: f64 = 4.0;

/// Evaluates `pairs` and the pairs of their children until all are linked, and sorts the links. What is left when the course ends is
/// linked with larger errors.
pub(super) fn refine(
    shared: &SharedHierarchy,
    pairs: Vec<(u32, u32)>,
    course: &mut Course,
    parallel: &mut impl Parallel,
) -> Result<()> {
    // The last pairs come first, so that the list stays short.
    let mut waiting = pairs;
    let mut is_over = false;
    while !waiting.is_empty() {
        if !is_over {
            let mut hierarchy = shared.write().unwrap_or_else(PoisonError::into_inner);
            is_over = course.refines_no_more(
                hierarchy.links.len() + waiting.len(),
                waiting.len() + PAIRS_PER_ROUND.min(waiting.len()),
            );
            if is_over {
                hierarchy.oracle.threshold *= COARSER;
            }
        }
        check_room(PAIRS_PER_ROUND.min(waiting.len()) * (size_of::<(u32, u32)>() + DECISION_BYTES))?;
        let round = Arc::new(waiting.split_off(waiting.len().saturating_sub(PAIRS_PER_ROUND)));
        let count = round.len() as u64;
        let (hierarchy, pairs) = (Arc::clone(shared), Arc::clone(&round));
        let decisions = parallel.map(round.len().div_ceil(PAIRS_PER_TASK), move |block| {
            let hierarchy = hierarchy.read().unwrap_or_else(PoisonError::into_inner);
            let pairs = pairs[block * PAIRS_PER_TASK..].iter().take(PAIRS_PER_TASK);
            pairs.map(|&(receiver, source)| hierarchy.oracle.decide(receiver, source)).collect::<Vec<_>>()
        })?;
        course.evaluated(count);
        let mut hierarchy = shared.write().unwrap_or_else(PoisonError::into_inner);
        hierarchy.apply(&round, decisions.into_iter().flatten(), &mut waiting)?;
        hierarchy.check_growth(2 * size_of_val(&*waiting))?;
    }
    let mut hierarchy = shared.write().unwrap_or_else(PoisonError::into_inner);
    hierarchy.sort()?;
    course.linked(hierarchy.links.len(), || hierarchy.gathered_links());
    Ok(())
}

/// Number of links, for a step that visits them all, and for which there is room.
fn links_to_check(shared: &SharedHierarchy) -> Result<usize> {
    let hierarchy = shared.read().unwrap_or_else(PoisonError::into_inner);
    hierarchy.check_step(0)?;
    Ok(hierarchy.links.len())
}

/// Removes the links whose error exceeds the allowed error, and returns their pairs.
pub(super) fn take_inaccurate(shared: &SharedHierarchy, parallel: &mut impl Parallel) -> Result<Vec<(u32, u32)>> {
    let count = links_to_check(shared)?;
    let hierarchy = Arc::clone(shared);
    let flags = parallel.map(count.div_ceil(LINKS_PER_TASK), move |block| {
        let hierarchy = hierarchy.read().unwrap_or_else(PoisonError::into_inner);
        let links = hierarchy.links[block * LINKS_PER_TASK..].iter().take(LINKS_PER_TASK);
        links.map(|link| hierarchy.oracle.exceeds_error(link)).collect::<Vec<_>>()
    })?;
    let mut flags = flags.into_iter().flatten();
    let mut pairs = Vec::new();
    let mut hierarchy = shared.write().unwrap_or_else(PoisonError::into_inner);
    hierarchy.links.retain(|link| {
        let exceeds_error = flags.next().unwrap_or_default();
        if exceeds_error {
            pairs.push((link.receiver, link.source));
        }
        !exceeds_error
    });
    Ok(pairs)
}

/// Measures the visible fraction of each link anew, by the current radiosities.
pub(super) fn measure_visibility(shared: &SharedHierarchy, parallel: &mut impl Parallel) -> Result<()> {
    let count = links_to_check(shared)?;
    let hierarchy = Arc::clone(shared);
    let visible = parallel.map(count.div_ceil(LINKS_PER_TASK), move |block| {
        let hierarchy = hierarchy.read().unwrap_or_else(PoisonError::into_inner);
        let links = hierarchy.links[block * LINKS_PER_TASK..].iter().take(LINKS_PER_TASK);
        links.map(|link| hierarchy.oracle.measure_visibility(link)).collect::<Vec<_>>()
    })?;
    let mut hierarchy = shared.write().unwrap_or_else(PoisonError::into_inner);
    for (link, visible) in hierarchy.links.iter_mut().zip(visible.into_iter().flatten()) {
        link.visible = visible;
    }
    Ok(())
}
