//! Links: the pairs of nodes that exchange light as wholes, and how much light.

use std::f64::consts::FRAC_PI_2;

use super::elements::Node;
use super::light::{DirectionalPolynomial, NodeRadiosity};
use crate::math::DVec3;

/// Indices from this one on are point lights.
pub(super) const POINT: u32 = 1 << 31;

/// Limits of the doubt in links of clusters.
const CLUSTER_DOUBTS: [f64; 2] = [0.02, 0.5];

/// Doubt in a link of elements, and what it is more where half of the source is visible: by 16 rays, the least that measure it, a fraction
/// is known to a quarter of the root of its variance.
const ELEMENT_DOUBT: f64 = 2e-3;
const VISIBILITY_DOUBT: f64 = 0.25;

/// A point light, scene frame.
#[derive(Clone, Copy, Debug)]
pub(super) struct PointLight {
    pub position: DVec3,
    /// [W sr^-1]
    pub intensity: DVec3,
}

/// The transport of light from one node to another.
#[derive(Clone, Copy, Debug)]
pub(super) struct Link {
    pub receiver: u32,
    /// A node, or a point light from [`POINT`] on.
    pub source: u32,
    /// Unoccluded irradiance at the receiver for each unit of the source's strength: per radiosity of an element [1],
    /// per radiant intensity of a cluster or point light [length^-2]. Where the receiver is a cluster, irradiance is
    /// that of a plane perpendicular to the direction of the source.
    pub factor: f32,
    /// Visible fraction of the source's light.
    pub visible: f32,
    /// The same by other rays, which decide whether to subdivide. A fraction that had to pass that test would be
    /// biased: links with a measured visibility below one half would be subdivided, and lost, more often than links
    /// above it.
    pub seen: f32,
    /// Error of `factor` times `visible`; 0 where no subdivision can reduce it.
    pub error: f32,
    pub quarter_weights: QuarterWeights,
    pub kind: LinkKind,
}

impl Link {
    /// By which fraction of itself the link may be wrong where it is evaluated at a leaf. Between elements form factors are closed forms, and
    /// the visible fraction is in doubt; `has_cluster`: the receiver or the source is a cluster.
    pub fn doubt(&self, has_cluster: bool) -> f64 {
        if has_cluster {
            // The error is not kept where no subdivision could reduce it.
            let error = if self.error == 0.0 { self.factor } else { self.error };
            let fraction = f64::from(error / self.factor.max(f32::MIN_POSITIVE));
            return fraction.clamp(CLUSTER_DOUBTS[0], CLUSTER_DOUBTS[1]);
        }
        let visible = f64::from(self.visible);
        ELEMENT_DOUBT + VISIBILITY_DOUBT * (visible * (1.0 - visible)).max(0.0).sqrt()
    }
}

/// The fraction of a link's form factor that belongs to each quarter of its source. A quarter that is near usually is
/// bright as well, so that a mean by area would underestimate the irradiance.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct QuarterWeights([u16; 3]);

impl QuarterWeights {
    /// Weights by area.
    pub const EVEN: Self = Self([u16::MAX; 3]);

    /// Weights by form factors of the quarters; by area where these are all 0.
    pub fn new(factors: [f64; 4]) -> Self {
        let sum: f64 = factors.iter().sum();
        if sum > 0.0 {
            Self([0, 1, 2].map(|k| (factors[k] / sum * f64::from(u16::MAX - 1)) as u16))
        } else {
            Self::EVEN
        }
    }

    /// The weighted mean of a quantity over a node's quarters. `whole`: its mean by area.
    #[inline]
    pub fn mean<T>(self, source: &Node, of: &[T], whole: T) -> T
    where
        T: Copy + std::ops::Add<Output = T> + std::ops::Mul<f64, Output = T>,
    {
        if self == Self::EVEN || source.children != 4 {
            return whole;
        }
        let parts = &of[source.first as usize..source.first as usize + 4];
        let [a, b, c] = self.0.map(|weight| f64::from(weight) / f64::from(u16::MAX - 1));
        parts[0] * a + parts[1] * b + parts[2] * c + parts[3] * (1.0 - a - b - c)
    }
}

/// How a link's irradiance depends on the orientation of the receiving surfaces.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum LinkKind {
    /// The receiver is an element.
    Element,
    /// All surfaces of the receiving cluster face the source.
    Facing,
    /// Some surfaces of the receiving cluster do not face the source.
    Mixed,
    /// The nodes overlap or nearly so, and the source is too dark to matter. The strength is the largest radiosity.
    Negligible,
}

/// Whether all surfaces of a cluster face the unit direction `d`.
pub(super) fn faces(cluster: &Node, d: DVec3) -> bool {
    d.dot(cluster.normal).clamp(-1.0, 1.0).acos() + cluster.cone < FRAC_PI_2
}

/// Radiant intensity of a cluster in the unit direction `d`.
#[inline]
pub(super) fn intensity(cluster: &Node, radiosity: &NodeRadiosity, d: DVec3) -> DVec3 {
    intensity_by(cluster, &radiosity.intensity, d)
}

/// The same by the intensities of all clusters.
#[inline]
pub(super) fn intensity_by(cluster: &Node, intensities: &[DirectionalPolynomial], d: DVec3) -> DVec3 {
    let moments = &intensities[cluster.corners[2] as usize];
    if faces(cluster, d) { moments.at_facing(d) } else { moments.at(d) }
}

/// Irradiance by a point light of intensity 1.
pub(super) fn point_factor(way: DVec3, n: DVec3) -> f64 {
    let distance2 = way.length_squared();
    let cosine = way.dot(n).max(0.0);
    if cosine > 0.0 { cosine / (distance2 * distance2.sqrt()) } else { 0.0 }
}
