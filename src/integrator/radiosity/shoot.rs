//! Shooting: the patch that has most light left distributes it, and so on.
//!
//! Source: Cohen, Chen, Wallace, Greenberg 1988, "A Progressive Refinement Approach to Fast Radiosity Image Generation".

use std::f64::consts::{FRAC_1_PI, PI};
use std::sync::PoisonError;

use super::elements::{Elements, NONE};
use super::judge::Judge;
use super::light::Moments;
use super::links::{Kind, Link, POINT, faces};
use super::refine::{Network, Shared};
use super::solve::{Course, largest_albedo};
use crate::control::Parallel;
use crate::error::Result;
use crate::math::DVec3;

/// Light that waits to be shot.
struct Shooting<'n> {
    network: &'n Network,
    /// The links of each source: their numbers, and where those of a node begin; those of point lights come last.
    outgoing: Vec<u32>,
    first: Vec<u32>,
    /// Of each node: radiosity, of leaves only.
    b: Vec<DVec3>,
    /// Part of it that was not shot yet.
    unshot: Vec<DVec3>,
    /// The same as power, of each patch, all channels; behind them of each point light.
    power: Vec<f64>,
    /// Of each node: what was taken from it last.
    taken: Vec<DVec3>,
}

/// Shoots so many times, or until no more than `tolerance` is left; leaves behind what was shot as what is sent. And the
/// irradiance that would light all surfaces evenly if what is left was spread over them.
pub(super) fn shoot(
    shared: &Shared,
    iterations: Option<u32>,
    tolerance: f64,
    parallel: &mut impl Parallel,
) -> Result<(Course, DVec3)> {
    let mut network = shared.write().unwrap_or_else(PoisonError::into_inner);
    network.emit();
    let mut shooting = Shooting::new(&network);
    let mut course = Course { residual: 1.0, bound: f64::INFINITY, ..Course::default() };
    let albedo = largest_albedo(&network.judge.elements);
    loop {
        let elements = &network.judge.elements;
        let left: f64 = shooting.power.iter().sum();
        let all: f64 = shooting.total(elements) + shooting.power[elements.patches.len()..].iter().sum::<f64>();
        course.residual = if all > 0.0 { left / all } else { 0.0 };
        // What is left is sent at least once; what comes of it, and of that, is a geometric series at worst.
        course.bound = if albedo < 1.0 { course.residual * albedo / (1.0 - albedo) } else { f64::INFINITY };
        let is_over = iterations.map_or(course.residual < tolerance, |count| course.iterations >= count);
        if is_over || left <= 0.0 {
            break;
        }
        parallel.check()?;
        parallel.progress(match iterations {
            Some(count) => f64::from(course.iterations) / f64::from(count),
            // What is left shrinks by about the same factor each time.
            None => course.residual.ln() / tolerance.ln(),
        });
        let brightest = shooting
            .power
            .iter()
            .enumerate()
            .fold((0, 0.0), |best, (i, &power)| if power > best.1 { (i, power) } else { best });
        shooting.shoot(brightest.0);
        course.iterations += 1;
    }
    let ambient = shooting.ambient();
    let Shooting { b, unshot, .. } = shooting;
    let sent = b.into_iter().zip(unshot).map(|(b, unshot)| b - unshot).collect();
    let Judge { elements, sent: now, .. } = &mut network.judge;
    now.b = sent;
    now.pull(elements);
    Ok((course, ambient))
}

impl<'n> Shooting<'n> {
    fn new(network: &'n Network) -> Self {
        let Judge { elements, lights, sent, .. } = &network.judge;
        let nodes = elements.nodes.len();
        let slot = |link: &Link| match link.source {
            point @ POINT.. => nodes + (point - POINT) as usize,
            node => node as usize,
        };
        let mut outgoing: Vec<u32> = (0..network.links.len() as u32).collect();
        outgoing.sort_by_key(|&link| slot(&network.links[link as usize]));
        let mut first = vec![0; nodes + lights.len() + 1];
        for link in &network.links {
            first[slot(link) + 1] += 1;
        }
        for i in 1..first.len() {
            first[i] += first[i - 1];
        }
        let leaf = |(i, b): (usize, &DVec3)| if elements.nodes[i].is_leaf() { *b } else { DVec3::ZERO };
        let b: Vec<DVec3> = sent.b.iter().enumerate().map(leaf).collect();
        let patch =
            |patch: &super::elements::Patch| elements.nodes[patch.node as usize].area * patch.emitted.element_sum();
        let mut power: Vec<f64> = elements.patches.iter().map(patch).collect();
        power.extend(lights.iter().map(|light| 4.0 * PI * light.intensity.element_sum()));
        Self { network, outgoing, first, unshot: b.clone(), taken: vec![DVec3::ZERO; nodes], b, power }
    }

    /// Sum of area times radiosity, all channels.
    fn total(&self, elements: &Elements) -> f64 {
        elements.nodes.iter().zip(&self.b).map(|(node, b)| node.area * b.element_sum()).sum()
    }

    fn shoot(&mut self, number: usize) {
        let elements = &self.network.judge.elements;
        self.power[number] = 0.0;
        if number >= elements.patches.len() {
            let light = number - elements.patches.len();
            let intensity = self.network.judge.lights[light].intensity;
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
            self.send(number as usize, &|link, _| link.shares.mean(node, &taken, b));
        }
        self.taken = taken;
        // As part of the clusters above.
        let node = &elements.nodes[root as usize];
        let mut above = node.parent;
        let mut moments = Moments::default();
        moments.add_lobe(node.normal, FRAC_1_PI * node.area * b);
        while above != NONE {
            let cluster = &elements.nodes[above as usize];
            // As the cluster's intensity is told, so that all its patches together send what it does.
            self.send(above as usize, &|_, receiver| {
                let d = (receiver - cluster.centre).normalize_or_zero();
                if faces(cluster, d) { moments.at_facing(d) } else { moments.at(d) }
            });
            above = cluster.parent;
        }
    }

    /// Takes what waits below a node; the mean by area of each node on the way.
    fn take(&mut self, number: u32, sent: &mut Vec<(u32, DVec3)>) -> DVec3 {
        let nodes = &self.network.judge.elements.nodes;
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

    /// Sends over all links of a source; `strength` by the link and where the receiver is.
    fn send(&mut self, slot: usize, strength: &dyn Fn(&Link, DVec3) -> DVec3) {
        let network = self.network;
        let Judge { elements, lights, .. } = &network.judge;
        for i in self.first[slot]..self.first[slot + 1] {
            let link = &network.links[self.outgoing[i as usize] as usize];
            if link.kind == Kind::Dim || link.visible == 0.0 {
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
            let mut moments = Moments::default();
            if link.kind == Kind::Facing {
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

    fn receive_from_all_around(&mut self, number: u32, moments: &Moments) {
        let node = &self.network.judge.elements.nodes[number as usize];
        if node.is_leaf() {
            self.receive(number, moments.at(node.normal));
        } else {
            node.range().for_each(|child| self.receive_from_all_around(child as u32, moments));
        }
    }

    fn receive(&mut self, number: u32, irradiance: DVec3) {
        let elements = &self.network.judge.elements;
        let node = &elements.nodes[number as usize];
        if !node.is_leaf() {
            node.range().for_each(|child| self.receive(child as u32, irradiance));
            return;
        }
        let scale = self.network.scale_of(number);
        let b = scale * elements.patches[node.patch as usize].albedo * irradiance;
        self.b[number as usize] += b;
        self.unshot[number as usize] += b;
        self.power[node.patch as usize] += node.area * b.element_sum();
    }

    /// What is left as irradiance: its mean over the surfaces that light reaches, times all its later bounces.
    fn ambient(&self) -> DVec3 {
        let elements = &self.network.judge.elements;
        let (mut left, mut reflected, mut area) = (DVec3::ZERO, DVec3::ZERO, 0.0);
        for (i, node) in elements.nodes.iter().enumerate() {
            if node.is_leaf() && !node.is_cluster() && self.b[i] != DVec3::ZERO {
                left += node.area * self.unshot[i];
                reflected += node.area * elements.patches[node.patch as usize].albedo;
                area += node.area;
            }
        }
        if area > 0.0 { left / area / (1.0 - reflected / area).max(DVec3::splat(0.01)) } else { DVec3::ZERO }
    }
}
