//! The binary tree of clusters above the patches.

use super::{Elements, NONE, Node, empty};
use crate::math::{Bounds, DVec3};

impl Elements {
    /// Builds the binary tree above the roots, in which the two sides of surfaces are separate.
    pub(super) fn cluster(&mut self, roots: Vec<Node>) {
        if roots.is_empty() {
            return;
        }
        let (mut fronts, mut backs): (Vec<u32>, Vec<u32>) =
            (0..roots.len() as u32).partition(|&patch| self.patches[patch as usize].is_front);
        self.nodes.reserve(2 * roots.len());
        self.nodes.push(empty());
        self.top = 0;
        if fronts.is_empty() || backs.is_empty() {
            fronts.append(&mut backs);
            self.group(0, NONE, &mut fronts, &roots);
        } else {
            self.nodes.extend([empty(), empty()]);
            self.group(1, 0, &mut fronts, &roots);
            self.group(2, 0, &mut backs, &roots);
            self.finish_cluster(0, NONE, 1, 0..self.order.len() as u32);
        }
    }

    fn group(&mut self, slot: u32, parent: u32, patches: &mut [u32], roots: &[Node]) {
        let start = self.order.len() as u32;
        if let [patch] = *patches {
            self.order.push(patch);
            self.nodes[slot as usize] = Node { parent, ..roots[patch as usize].clone() };
            self.patches[patch as usize].node = slot;
            return;
        }
        let centres = Bounds::around(patches.iter().map(|&patch| roots[patch as usize].centre));
        let spread = (centres.max - centres.min).to_array();
        let axis = (0..3).max_by(|&i, &j| spread[i].total_cmp(&spread[j])).unwrap_or(0);
        let half = patches.len() / 2;
        let key = |&patch: &u32| (roots[patch as usize].centre[axis], patch);
        patches.select_nth_unstable_by(half, |a, b| {
            let (a, b) = (key(a), key(b));
            a.0.total_cmp(&b.0).then(a.1.cmp(&b.1))
        });
        let (low, high) = patches.split_at_mut(half);
        let first = self.nodes.len() as u32;
        self.nodes.extend([empty(), empty()]);
        self.group(first, slot, low, roots);
        self.group(first + 1, slot, high, roots);
        self.finish_cluster(slot, parent, first, start..self.order.len() as u32);
    }

    fn finish_cluster(&mut self, slot: u32, parent: u32, first: u32, range: std::ops::Range<u32>) {
        let [a, b] = [0, 1].map(|i| &self.nodes[(first + i) as usize]);
        // The centre is the mean by area, where light comes from in first order.
        let area = a.area + b.area;
        let centre = if area > 0.0 { (a.area * a.centre + b.area * b.centre) / area } else { a.centre };
        let reach = |child: &Node| centre.distance(child.centre) + child.radius;
        let radius = reach(a).max(reach(b));
        let normal = (a.area * a.normal + b.area * b.normal).normalize_or_zero();
        let angle = |child: &Node| child.cone + normal.dot(child.normal).clamp(-1.0, 1.0).acos();
        let cone = if normal == DVec3::ZERO { std::f64::consts::PI } else { angle(a).max(angle(b)) };
        let cluster = Node {
            centre,
            normal,
            area,
            radius,
            parent,
            first,
            children: 2,
            corners: [range.start, range.end, self.clusters],
            cone: cone.min(std::f64::consts::PI),
            ..empty()
        };
        self.clusters += 1;
        self.nodes[slot as usize] = cluster;
    }
}
