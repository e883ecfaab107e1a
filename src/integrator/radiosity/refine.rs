//! Refinement: links where they are good enough, elements where they are needed.
//!
//! In rounds, so that threads change nothing: all pairs of a round are judged side by side, then what is to be divided is
//! divided in their order, and its parts are the pairs of the next round.

use std::sync::{Arc, PoisonError, RwLock};

use super::elements::Elements;
use super::judge::{Judge, Verdict};
use super::light::Sent;
use super::links::{Link, POINT, PointLight};
use crate::control::Parallel;
use crate::emitter::Emitter;
use crate::error::Result;
use crate::math::DVec3;
use crate::scene::Scene;
use crate::spectrum::Rgb;

/// Pairs of one thread at a time.
const BLOCK: usize = 64;

/// Pairs that are judged before what they need is made.
const ROUND: usize = 1 << 17;

/// Links of one thread at a time, when they are only looked at.
const LOOKS: usize = 1 << 12;

/// Elements, links between them, and what they send.
#[derive(Debug)]
pub(super) struct Network {
    pub judge: Judge,
    /// In the order of their receivers, after [`sort`].
    pub links: Vec<Link>,
    /// Where the links of each node begin.
    pub first: Vec<u32>,
    /// Numbers of all clusters' nodes, parents first.
    pub clusters: Vec<u32>,
    /// What leaves gather is scaled by this; empty while that is not known.
    pub scale: Vec<Rgb>,
}

/// Shared by the threads that work on it.
pub(super) type Shared = Arc<RwLock<Network>>;

impl Network {
    /// Elements that send what they emit, and no link.
    pub fn new(scene: &Scene, elements: Elements) -> Self {
        let light = |emitter: &Emitter| match emitter {
            Emitter::Point { position, intensity } => {
                Some(PointLight { position: position.as_dvec3(), intensity: intensity.to_f64() })
            }
            _ => None,
        };
        let lights = scene.emitters().emitters().iter().filter_map(light).collect();
        let clusters = (0..elements.nodes.len() as u32).filter(|&i| elements.nodes[i as usize].is_cluster()).collect();
        let judge = Judge {
            scene: scene.clone(),
            elements,
            sent: Sent::default(),
            lights,
            threshold: 0.0,
            at_vertices: Vec::new(),
        };
        let mut network = Self { judge, links: Vec::new(), first: Vec::new(), clusters, scale: Vec::new() };
        network.emit();
        network
    }

    /// All elements send what they emit, and no more.
    pub fn emit(&mut self) {
        let Judge { elements, sent, .. } = &mut self.judge;
        let emitted = |node: &super::elements::Node| {
            if node.is_cluster() { DVec3::ZERO } else { elements.patches[node.patch as usize].emitted }
        };
        sent.b = elements.nodes.iter().map(emitted).collect();
        sent.pull(elements);
    }

    /// Memory of all of it, bytes.
    pub fn bytes(&self) -> usize {
        // Radiosity, its tilt, spread, largest, first link, scale; a vertex' irradiance is counted with the nodes.
        let node = 24 + 32 + 4 + 4 + 4 + 16 + 24;
        self.judge.elements.bytes()
            + node * self.judge.elements.nodes.len()
            + size_of::<Link>() * self.links.len()
            + 240 * self.clusters.len()
    }

    /// Puts the links in the order of their receivers.
    pub fn sort(&mut self) {
        self.links.sort_by_key(|link| (link.receiver, link.source));
        let nodes = self.judge.elements.nodes.len();
        self.first = Vec::with_capacity(nodes + 1);
        let mut next = 0;
        for node in 0..=nodes as u32 {
            while next < self.links.len() && self.links[next].receiver < node {
                next += 1;
            }
            self.first.push(next as u32);
        }
    }

    pub fn scale_of(&self, leaf: u32) -> DVec3 {
        self.scale.get(leaf as usize).map_or(DVec3::ONE, |scale| scale.to_f64())
    }

    pub fn links_of(&self, node: u32) -> &[Link] {
        &self.links[self.first[node as usize] as usize..self.first[node as usize + 1] as usize]
    }

    /// Makes the parts of nodes that have none; they send what the whole did.
    fn divide(&mut self, number: u32) -> std::ops::Range<u32> {
        let is_new = self.judge.elements.nodes[number as usize].is_leaf();
        let parts = self.judge.elements.parts(number);
        if is_new {
            for part in parts.clone() {
                self.judge.elements.nodes[part as usize].is_cut = self.judge.is_cut(part);
            }
        }
        let Judge { elements, sent, .. } = &mut self.judge;
        if sent.b.len() < elements.nodes.len() {
            let b = sent.b[number as usize];
            sent.b.resize(elements.nodes.len(), b);
            sent.most.resize(elements.nodes.len(), b.max_element() as f32);
            sent.spread.resize(elements.nodes.len(), 0.0);
            sent.tilt.resize(elements.nodes.len(), Default::default());
        }
        parts
    }

    /// Acts on the verdicts of some pairs.
    fn apply(&mut self, pairs: &[(u32, u32)], verdicts: impl Iterator<Item = Verdict>, next: &mut Vec<(u32, u32)>) {
        for (&(receiver, source), verdict) in pairs.iter().zip(verdicts) {
            match verdict {
                Verdict::Drop => {}
                Verdict::Keep(link) => self.links.push(link),
                Verdict::DivideReceiver => next.extend(self.divide(receiver).map(|part| (part, source))),
                Verdict::DivideSource => next.extend(self.divide(source).map(|part| (receiver, part))),
                Verdict::DivideBoth => {
                    let parts = self.divide(receiver);
                    next.extend(parts.clone().flat_map(|a| parts.clone().map(move |b| (a, b))));
                }
            }
        }
    }
}

/// The pairs from which all others come.
pub(super) fn first_pairs(network: &Network) -> Vec<(u32, u32)> {
    let top = network.judge.elements.top;
    let lights = (0..network.judge.lights.len() as u32).map(|light| (top, POINT + light));
    std::iter::once((top, top)).chain(lights).collect()
}

/// Judges `pairs` and what comes of them until all are linked; then the links are in order. How many pairs were judged.
pub(super) fn refine(shared: &Shared, pairs: Vec<(u32, u32)>, parallel: &mut impl Parallel) -> Result<u64> {
    // The last first, so that the list stays short.
    let mut waiting = pairs;
    let mut judged = 0;
    while !waiting.is_empty() {
        let round = Arc::new(waiting.split_off(waiting.len().saturating_sub(ROUND)));
        judged += round.len() as u64;
        let (network, pairs) = (Arc::clone(shared), Arc::clone(&round));
        let verdicts = parallel.map(round.len().div_ceil(BLOCK), move |block| {
            let network = network.read().unwrap_or_else(PoisonError::into_inner);
            let pairs = pairs[block * BLOCK..].iter().take(BLOCK);
            pairs.map(|&(receiver, source)| network.judge.judge(receiver, source)).collect::<Vec<_>>()
        })?;
        let mut network = shared.write().unwrap_or_else(PoisonError::into_inner);
        network.apply(&round, verdicts.into_iter().flatten(), &mut waiting);
        network.judge.elements.check(network.bytes() + 2 * 8 * waiting.len())?;
    }
    shared.write().unwrap_or_else(PoisonError::into_inner).sort();
    Ok(judged)
}

/// Takes out the links that are no longer good enough; their pairs.
pub(super) fn stale(shared: &Shared, parallel: &mut impl Parallel) -> Result<Vec<(u32, u32)>> {
    let count = shared.read().unwrap_or_else(PoisonError::into_inner).links.len();
    let network = Arc::clone(shared);
    let flags = parallel.map(count.div_ceil(LOOKS), move |block| {
        let network = network.read().unwrap_or_else(PoisonError::into_inner);
        let links = network.links[block * LOOKS..].iter().take(LOOKS);
        links.map(|link| network.judge.is_stale(link)).collect::<Vec<_>>()
    })?;
    let mut flags = flags.into_iter().flatten();
    let mut pairs = Vec::new();
    let mut network = shared.write().unwrap_or_else(PoisonError::into_inner);
    network.links.retain(|link| {
        let is_stale = flags.next().unwrap_or_default();
        if is_stale {
            pairs.push((link.receiver, link.source));
        }
        !is_stale
    });
    Ok(pairs)
}

/// Looks again at how much of each link is visible, by what is sent now.
pub(super) fn look_again(shared: &Shared, parallel: &mut impl Parallel) -> Result<()> {
    let count = shared.read().unwrap_or_else(PoisonError::into_inner).links.len();
    let network = Arc::clone(shared);
    let visible = parallel.map(count.div_ceil(LOOKS), move |block| {
        let network = network.read().unwrap_or_else(PoisonError::into_inner);
        let links = network.links[block * LOOKS..].iter().take(LOOKS);
        links.map(|link| network.judge.look_again(link)).collect::<Vec<_>>()
    })?;
    let mut network = shared.write().unwrap_or_else(PoisonError::into_inner);
    for (link, visible) in network.links.iter_mut().zip(visible.into_iter().flatten()) {
        link.visible = visible;
    }
    Ok(())
}
