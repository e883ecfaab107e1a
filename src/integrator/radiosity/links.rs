//! Links: which nodes exchange light as wholes, and how much of it.

use std::f64::consts::FRAC_PI_2;

use super::elements::Node;
use super::light::Sent;
use crate::math::DVec3;

/// Numbers from here on are point lights.
pub(super) const POINT: u32 = 1 << 31;

/// A point light, scene frame.
#[derive(Clone, Copy, Debug)]
pub(super) struct PointLight {
    pub position: DVec3,
    /// [W sr^-1]
    pub intensity: DVec3,
}

/// One node's light at another.
#[derive(Clone, Copy, Debug)]
pub(super) struct Link {
    pub receiver: u32,
    /// A node, or a point light from [`POINT`] on.
    pub source: u32,
    /// Irradiance at the receiver (at a cluster: across the way to the source) per strength of the source, nothing being in
    /// between: per radiosity of an element [1], per radiant intensity of a cluster or point [length^-2].
    pub factor: f32,
    /// Share that is not blocked.
    pub visible: f32,
    /// The same by other rays: by these it is decided whether to divide. A share that had to pass that test would be a biased
    /// one: links seen less than half would be divided, and lost, more often than those seen more.
    pub seen: f32,
    /// What `factor` times `visible` may be wrong by; 0 where nothing can be done about it.
    pub error: f32,
    pub shares: Shares,
    pub kind: Kind,
}

/// What share of a link's form factor each quarter of its source has: what is near is bright, usually, so that a mean by area
/// would lack some.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Shares([u16; 3]);

impl Shares {
    /// By area.
    pub const EVEN: Self = Self([u16::MAX; 3]);

    /// By form factors of the quarters; by area where they are all 0.
    pub fn new(factors: [f64; 4]) -> Self {
        let sum: f64 = factors.iter().sum();
        if sum > 0.0 {
            Self([0, 1, 2].map(|k| (factors[k] / sum * f64::from(u16::MAX - 1)) as u16))
        } else {
            Self::EVEN
        }
    }

    /// The mean by these of what a node's parts have; `whole`: its mean by area.
    #[inline]
    pub fn mean<T>(self, source: &Node, of: &[T], whole: T) -> T
    where
        T: Copy + std::ops::Add<Output = T> + std::ops::Mul<f64, Output = T>,
    {
        if self == Self::EVEN || source.children != 4 {
            return whole;
        }
        let parts = &of[source.first as usize..source.first as usize + 4];
        let [a, b, c] = self.0.map(|share| f64::from(share) / f64::from(u16::MAX - 1));
        parts[0] * a + parts[1] * b + parts[2] * c + parts[3] * (1.0 - a - b - c)
    }
}

/// How a link's irradiance depends on the receiving surfaces.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Kind {
    /// The receiver is an element.
    Element,
    /// All surfaces of the receiving cluster face the source.
    Facing,
    /// Some do not.
    Mixed,
    /// Nodes that are in each other's way, of which one is too dark to matter. Its strength is the largest radiosity.
    Dim,
}

/// Whether all surfaces of a cluster face the unit direction `d`.
pub(super) fn faces(cluster: &Node, d: DVec3) -> bool {
    d.dot(cluster.normal).clamp(-1.0, 1.0).acos() + cluster.cone < FRAC_PI_2
}

/// Radiant intensity of a cluster in the unit direction `d`.
#[inline]
pub(super) fn intensity(cluster: &Node, sent: &Sent, d: DVec3) -> DVec3 {
    let moments = &sent.intensity[cluster.corners[2] as usize];
    if faces(cluster, d) { moments.at_facing(d) } else { moments.at(d) }
}

/// Irradiance by a point of intensity 1.
pub(super) fn point_factor(way: DVec3, n: DVec3) -> f64 {
    let distance2 = way.length_squared();
    let cosine = way.dot(n).max(0.0);
    if cosine > 0.0 { cosine / (distance2 * distance2.sqrt()) } else { 0.0 }
}
