//! Radiosity of nodes, and functions of direction for clusters.

use std::f64::consts::FRAC_1_PI;
use std::ops::AddAssign;

use super::elements::{Elements, NONE, Node};
use crate::error::Result;
use crate::math::DVec3;
use crate::room::filled;
use crate::spectrum::Rgb;

/// A smooth function of direction for each colour channel: a polynomial of second degree, which spans the same space as
/// spherical harmonics up to band 2.
///
/// Coefficients of 1, x, y, z, xx, yy, zz, xy, yz, zx.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct DirectionalPolynomial([DVec3; 10]);

impl DirectionalPolynomial {
    /// Adds `weight` max(0, n . d) as a function of n or d, projected to band 2: the error is within 3/32 of `weight`.
    ///
    /// Source: Ramamoorthi and Hanrahan 2001, "An Efficient Representation for Irradiance Environment Maps": 1/4, 1/2
    /// and 5/16 of the Legendre polynomials.
    #[inline]
    pub fn add_lobe(&mut self, d: DVec3, weight: DVec3) {
        self.0[0] += 3.0 / 32.0 * weight;
        self.add_linear(d, 0.5 * weight);
        let weight = 15.0 / 32.0 * weight;
        self.0[4] += d.x * d.x * weight;
        self.0[5] += d.y * d.y * weight;
        self.0[6] += d.z * d.z * weight;
        self.0[7] += 2.0 * d.x * d.y * weight;
        self.0[8] += 2.0 * d.y * d.z * weight;
        self.0[9] += 2.0 * d.z * d.x * weight;
    }

    /// Adds `weight` n . d.
    #[inline]
    pub fn add_linear(&mut self, d: DVec3, weight: DVec3) {
        self.0[1] += d.x * weight;
        self.0[2] += d.y * weight;
        self.0[3] += d.z * weight;
    }

    /// The value at the unit vector `n`, at least 0.
    #[inline]
    pub fn at(&self, n: DVec3) -> DVec3 {
        let m = &self.0;
        let linear = m[0] + n.x * m[1] + n.y * m[2] + n.z * m[3];
        let squares = n.x * n.x * m[4] + n.y * n.y * m[5] + n.z * n.z * m[6];
        (linear + squares + n.x * n.y * m[7] + n.y * n.z * m[8] + n.z * n.x * m[9]).max(DVec3::ZERO)
    }
}

impl DirectionalPolynomial {
    /// The sum of the lobes at the unit vector `n`, which is exact where `n` is on the positive side of all lobes.
    #[inline]
    pub fn at_facing(&self, n: DVec3) -> DVec3 {
        let m = &self.0;
        (2.0 * (n.x * m[1] + n.y * m[2] + n.z * m[3])).max(DVec3::ZERO)
    }
}

impl AddAssign<&Self> for DirectionalPolynomial {
    fn add_assign(&mut self, other: &Self) {
        for (mine, theirs) in self.0.iter_mut().zip(&other.0) {
            *mine += *theirs;
        }
    }
}

/// Radiosity of all nodes.
#[derive(Clone, Debug, Default)]
pub(super) struct NodeRadiosity {
    /// Radiosity of each node [W m^-2]; of a node with children, the mean by area.
    pub b: Vec<DVec3>,
    /// Largest difference of a radiosity below each node from that mean.
    pub spread: Vec<f32>,
    /// Largest radiosity below each node.
    pub largest: Vec<f32>,
    /// Linear variation over each node: the integral of the difference from `b`, times the barycentric weight of the
    /// first and of the second corner, over the area. The value of the third corner makes the sum 0.
    pub tilt: Vec<[Rgb; 2]>,
    /// Radiant intensity of each cluster by direction [W sr^-1].
    pub intensity: Vec<DirectionalPolynomial>,
}

impl NodeRadiosity {
    /// Computes all inner nodes from the radiosities of the leaves.
    pub fn pull(&mut self, elements: &Elements) {
        let nodes = &elements.nodes;
        self.b.resize(nodes.len(), DVec3::ZERO);
        self.spread.resize(nodes.len(), 0.0);
        self.largest.resize(nodes.len(), 0.0);
        self.tilt.resize(nodes.len(), [Rgb::ZERO; 2]);
        self.intensity.clear();
        self.intensity.resize(elements.clusters as usize, DirectionalPolynomial::default());
        // Children come after their parents.
        for (i, node) in nodes.iter().enumerate().rev() {
            if node.is_leaf() {
                self.largest[i] = self.b[i].max_element() as f32;
                self.spread[i] = 0.0;
                self.tilt[i] = [Rgb::ZERO; 2];
            } else {
                let (mut sum, mut area, mut largest) = (DVec3::ZERO, 0.0, 0.0);
                for child in node.range() {
                    sum += nodes[child].area * self.b[child];
                    area += nodes[child].area;
                    largest = f32::max(largest, self.largest[child]);
                }
                let mean = if area > 0.0 { sum / area } else { DVec3::ZERO };
                let spread = |child: usize| (self.b[child] - mean).abs().max_element() as f32 + self.spread[child];
                let spread = node.range().map(spread).fold(0.0, f32::max);
                (self.b[i], self.largest[i], self.spread[i]) = (mean, largest, spread);
                if !node.is_cluster() {
                    self.tilt[i] = self.tilt_of(nodes, node, mean);
                }
            }
            if node.parent == NONE {
                continue;
            }
            let parent = &nodes[node.parent as usize];
            if !parent.is_cluster() {
                continue;
            }
            let cluster = parent.corners[2] as usize;
            if node.is_cluster() {
                let own = self.intensity[node.corners[2] as usize];
                self.intensity[cluster] += &own;
            } else if self.b[i] != DVec3::ZERO {
                self.intensity[cluster].add_lobe(node.normal, FRAC_1_PI * node.window() * self.b[i]);
            }
        }
    }

    /// The linear variation of an element from its quarters: three at its corners and one in the middle, which is
    /// rotated by 180 degrees.
    fn tilt_of(&self, nodes: &[Node], node: &Node, mean: DVec3) -> [Rgb; 2] {
        [0, 1].map(|corner| {
            let mut sum = Rgb::ZERO;
            for (quarter, child) in node.range().enumerate() {
                let (weight, side) = match quarter {
                    3 => (1.0 / 3.0, -0.5),
                    quarter if quarter == corner => (2.0 / 3.0, 0.5),
                    _ => (1.0 / 6.0, 0.5),
                };
                let fraction = (nodes[child].area / node.area) as f32;
                sum += fraction * (weight * Rgb::from_f64(self.b[child] - mean) + side * self.tilt[child][corner]);
            }
            sum
        })
    }
}

/// Intensity of each cluster where patches have these radiosities.
pub(super) fn intensities(elements: &Elements, radiosity: impl Fn(u32) -> DVec3) -> Result<Vec<DirectionalPolynomial>> {
    let mut intensity = filled(DirectionalPolynomial::default(), elements.clusters as usize)?;
    // Children come after their parents.
    for node in elements.nodes.iter().rev().filter(|node| node.parent != NONE) {
        let parent = &elements.nodes[node.parent as usize];
        if !parent.is_cluster() {
            continue;
        }
        let cluster = parent.corners[2] as usize;
        if node.is_cluster() {
            let own = intensity[node.corners[2] as usize];
            intensity[cluster] += &own;
        } else {
            intensity[cluster].add_lobe(node.normal, FRAC_1_PI * node.window() * radiosity(node.patch));
        }
    }
    Ok(intensity)
}
