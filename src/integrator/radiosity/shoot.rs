//! Shooting: in each step, the patch with the most unshot power distributes it.
//!
//! Source: Cohen, Chen, Wallace, Greenberg 1988, "A Progressive Refinement Approach to Fast Radiosity Image
//! Generation".

use std::f64::consts::{FRAC_1_PI, PI};
use std::sync::PoisonError;

use super::elements::{Elements, NONE};
use super::light::DirectionalPolynomial;
use super::links::{Link, LinkKind, POINT, faces};
use super::oracle::RefinementOracle;
use super::refine::{LinkHierarchy, SharedHierarchy};
use super::solve::{Convergence, largest_albedo};
use super::vertices::leaves;
use crate::control::Parallel;
use crate::error::Result;
use crate::math::DVec3;

/// Radiosities and the part of them that was not shot yet.
struct UnshotLight<'n> {
    hierarchy: &'n LinkHierarchy,
    /// The links in the order of their sources, and the position where those of each node begin; links of point lights
    /// come last.
    outgoing: Vec<u32>,
    first: Vec<u32>,
    /// Radiosity of each leaf; 0 for other nodes.
    b: Vec<DVec3>,
    /// Unshot radiosity of each leaf.
    unshot: Vec<DVec3>,
    /// Unshot power of each patch, followed by each point light and, where there is any, by what leaves get of sampled light; sum of
    /// the channels.
    power: Vec<f64>,
    /// Radiosity that each node shot last.
    taken: Vec<DVec3>,
}

/// Shoots `iterations` times, or until the rest is at most `tolerance`; the radiosities that were shot remain in the
/// hierarchy. Also returns the ambient irradiance, which would light all surfaces evenly if the unshot light was spread
/// over them.
pub(super) fn shoot(
    shared: &SharedHierarchy,
    iterations: Option<u32>,
    tolerance: f64,
    parallel: &mut impl Parallel,
) -> Result<(Convergence, DVec3)> {
    let mut hierarchy = shared.write().unwrap_or_else(PoisonError::into_inner);
    hierarchy.check_step(0)?;
    hierarchy.emit();
    let mut unshot_light = UnshotLight::new(&hierarchy);
    let mut convergence = Convergence { residual: 1.0, bound: f64::INFINITY, ..Convergence::default() };
    let albedo = largest_albedo(&hierarchy.oracle.elements);
    loop {
        let elements = &hierarchy.oracle.elements;
        let left: f64 = unshot_light.power.iter().sum();
        let all: f64 = unshot_light.total(elements) + unshot_light.power[elements.patches.len()..].iter().sum::<f64>();
        convergence.residual = if all > 0.0 { left / all } else { 0.0 };
        // Unshot light is sent at least once; its later bounces are a geometric series at worst.
        convergence.bound = if albedo < 1.0 { convergence.residual * albedo / (1.0 - albedo) } else { f64::INFINITY };
        let is_over = iterations.map_or(convergence.residual < tolerance, |count| convergence.iterations >= count);
        if is_over || left <= 0.0 {
            break;
        }
        parallel.check()?;
        parallel.progress(match iterations {
            Some(count) => f64::from(convergence.iterations) / f64::from(count),
            // Unshot light shrinks by about the same factor in each step.
            None => convergence.residual.ln() / tolerance.ln(),
        });
        let brightest = unshot_light
            .power
            .iter()
            .enumerate()
            .fold((0, 0.0), |best, (i, &power)| if power > best.1 { (i, power) } else { best });
        unshot_light.shoot(brightest.0);
        convergence.iterations += 1;
    }
    let ambient = unshot_light.ambient();
    let UnshotLight { b, unshot, .. } = unshot_light;
    let sent = b.into_iter().zip(unshot).map(|(b, unshot)| b - unshot).collect();
    let RefinementOracle { elements, radiosity: now, .. } = &mut hierarchy.oracle;
    now.b = sent;
    now.pull(elements);
    Ok((convergence, ambient))
}

impl<'n> UnshotLight<'n> {
    fn new(hierarchy: &'n LinkHierarchy) -> Self {
        let RefinementOracle { elements, lights, radiosity, .. } = &hierarchy.oracle;
        let nodes = elements.nodes.len();
        let slot = |link: &Link| match link.source {
            point @ POINT.. => nodes + (point - POINT) as usize,
            node => node as usize,
        };
        let mut outgoing: Vec<u32> = (0..hierarchy.links.len() as u32).collect();
        outgoing.sort_by_key(|&link| slot(&hierarchy.links[link as usize]));
        let mut first = vec![0; nodes + lights.len() + 1];
        for link in &hierarchy.links {
            first[slot(link) + 1] += 1;
        }
        for i in 1..first.len() {
            first[i] += first[i - 1];
        }
        let leaf = |(i, b): (usize, &DVec3)| if elements.nodes[i].is_leaf() { *b } else { DVec3::ZERO };
        let b: Vec<DVec3> = radiosity.b.iter().enumerate().map(leaf).collect();
        let of_patch = |patch: &super::elements::Patch| {
            // Where a texture varies it, the mean over the elements below, which are what shoots.
            let emitted = if elements.is_textured() { radiosity.b[patch.node as usize] } else { patch.emitted };
            elements.nodes[patch.node as usize].area * emitted.element_sum()
        };
        let mut power: Vec<f64> = elements.patches.iter().map(of_patch).collect();
        power.extend(lights.iter().map(|light| 4.0 * PI * light.intensity.element_sum()));
        if hierarchy.sampled.is_some() {
            let of_leaf = |leaf| elements.nodes[leaf as usize].area * hierarchy.sampled_over(leaf).element_sum();
            power.push(leaves(elements).map(of_leaf).sum());
        }
        Self { hierarchy, outgoing, first, unshot: b.clone(), taken: vec![DVec3::ZERO; nodes], b, power }
    }

    /// Sum of area times radiosity over all leaves and channels.
    fn total(&self, elements: &Elements) -> f64 {
        elements.nodes.iter().zip(&self.b).map(|(node, b)| node.area * b.element_sum()).sum()
    }

    fn shoot(&mut self, number: usize) {
        let elements = &self.hierarchy.oracle.elements;
        self.power[number] = 0.0;
        if number >= elements.patches.len() {
            let light = number - elements.patches.len();
            if light == self.hierarchy.oracle.lights.len() {
                leaves(elements).for_each(|leaf| {
                    self.reflect(leaf, elements.kept(leaf, DVec3::ZERO, self.hierarchy.sampled_over(leaf)));
                });
                return;
            }
            let intensity = self.hierarchy.oracle.lights[light].intensity;
            self.send(elements.nodes.len() + light, &|_, _| intensity);
            return;
        }
        let root = elements.patches[number].node;
        let mut sent = Vec::new();
        let b = self.take(root, &mut sent);
        let mut taken = std::mem::take(&mut self.taken);
        for &(node, b) in &sent {
            taken[node as usize] = b;
        }
        for (number, b) in sent {
            let node = &elements.nodes[number as usize];
            self.send(number as usize, &|link, _| link.quarter_weights.mean(node, &taken, b));
        }
        self.taken = taken;
        // The patch also shoots as part of the clusters above it.
        let node = &elements.nodes[root as usize];
        let mut above = node.parent;
        let mut moments = DirectionalPolynomial::default();
        moments.add_lobe(node.normal, FRAC_1_PI * node.window() * b);
        while above != NONE {
            let cluster = &elements.nodes[above as usize];
            // The choice is that of the cluster's own intensity, so that all patches of a cluster together send what
            // the cluster does.
            self.send(above as usize, &|_, receiver| {
                let d = (receiver - cluster.centre).normalize_or_zero();
                if faces(cluster, d) { moments.at_facing(d) } else { moments.at(d) }
            });
            above = cluster.parent;
        }
    }

    /// Takes the unshot radiosity below a node and returns its mean by area; appends the mean of each node on the way.
    fn take(&mut self, number: u32, sent: &mut Vec<(u32, DVec3)>) -> DVec3 {
        let nodes = &self.hierarchy.oracle.elements.nodes;
        let node = &nodes[number as usize];
        let mean = if node.is_leaf() {
            std::mem::take(&mut self.unshot[number as usize])
        } else {
            let (mut sum, mut area) = (DVec3::ZERO, 0.0);
            for child in node.range() {
                sum += nodes[child].area * self.take(child as u32, sent);
                area += nodes[child].area;
            }
            sum / area
        };
        sent.push((number, mean));
        mean
    }

    /// Sends light over all links of a source; `strength` is a function of the link and the receiver's centre.
    fn send(&mut self, slot: usize, strength: &dyn Fn(&Link, DVec3) -> DVec3) {
        let hierarchy = self.hierarchy;
        let RefinementOracle { elements, lights, .. } = &hierarchy.oracle;
        for i in self.first[slot]..self.first[slot + 1] {
            let link = &hierarchy.links[self.outgoing[i as usize] as usize];
            if link.kind == LinkKind::Negligible || link.visible == 0.0 {
                continue;
            }
            let receiver = &elements.nodes[link.receiver as usize];
            let weight = f64::from(link.factor) * f64::from(link.visible) * strength(link, receiver.centre);
            if !receiver.is_cluster() {
                self.receive(link.receiver, weight);
                continue;
            }
            let from = match slot.checked_sub(elements.nodes.len()) {
                Some(light) => lights[light].position,
                None => elements.nodes[slot].centre,
            };
            let d = (from - receiver.centre).normalize_or_zero();
            let mut moments = DirectionalPolynomial::default();
            if link.kind == LinkKind::Facing {
                moments.add_linear(d, weight)
            } else {
                moments.add_lobe(d, weight)
            }
            let [start, end, _] = receiver.corners;
            for &patch in &elements.order[start as usize..end as usize] {
                let node = elements.patches[patch as usize].node;
                self.receive_from_all_around(node, &moments);
            }
        }
    }

    fn receive_from_all_around(&mut self, number: u32, moments: &DirectionalPolynomial) {
        let node = &self.hierarchy.oracle.elements.nodes[number as usize];
        if node.is_leaf() {
            self.receive(number, moments.at(node.normal));
        } else {
            node.range().for_each(|child| self.receive_from_all_around(child as u32, moments));
        }
    }

    fn receive(&mut self, number: u32, irradiance: DVec3) {
        let elements = &self.hierarchy.oracle.elements;
        let node = &elements.nodes[number as usize];
        if !node.is_leaf() {
            node.range().for_each(|child| self.receive(child as u32, irradiance));
            return;
        }
        self.reflect(number, elements.kept(number, self.hierarchy.scale_of(number) * irradiance, DVec3::ZERO));
    }

    /// Adds the light that a leaf reflects of some irradiance to what it has to shoot.
    fn reflect(&mut self, leaf: u32, irradiance: DVec3) {
        let elements = &self.hierarchy.oracle.elements;
        let node = &elements.nodes[leaf as usize];
        let b = elements.albedo(leaf) * irradiance;
        self.b[leaf as usize] += b;
        self.unshot[leaf as usize] += b;
        self.power[node.patch as usize] += node.area * b.element_sum();
    }

    /// Unshot light as irradiance: its mean over the surfaces that light reaches, times all its later bounces.
    fn ambient(&self) -> DVec3 {
        let elements = &self.hierarchy.oracle.elements;
        let (mut left, mut reflected, mut area) = (DVec3::ZERO, DVec3::ZERO, 0.0);
        for (i, node) in elements.nodes.iter().enumerate() {
            if node.is_leaf() && !node.is_cluster() && self.b[i] != DVec3::ZERO {
                left += node.area * self.unshot[i];
                reflected += node.area * elements.albedo(i as u32);
                area += node.area;
            }
        }
        if area > 0.0 { left / area / (1.0 - reflected / area).max(DVec3::splat(0.01)) } else { DVec3::ZERO }
    }
}
