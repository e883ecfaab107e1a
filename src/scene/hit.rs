//! Hits of rays, before anything is computed from them.

use crate::embree;

/// A hit of a ray, with only the data that [`Scene::interaction`](super::Scene::interaction) needs to compute the rest.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hit {
    /// Distance in units of the ray's direction.
    pub t: f32,
    pub(super) u: f32,
    pub(super) v: f32,
    pub(super) primitive: u32,
    /// Number of the geometry in the Embree scene, or that of the instance plus the number in it, or [`IN_LIST`].
    pub(super) geometry: u32,
}

impl Hit {
    /// The same place of the same surface, as a ray meets it at this distance.
    #[inline]
    #[must_use]
    pub(crate) fn at_distance(self, t: f32) -> Self {
        Self { t, ..self }
    }

    /// The weights of a triangle's corners at the hit, in the order in which the kernel has them.
    #[inline]
    pub(super) fn weights(&self) -> [f32; 3] {
        [1.0 - self.u - self.v, self.u, self.v]
    }
}

impl From<embree::Hit> for Hit {
    #[inline]
    fn from(hit: embree::Hit) -> Self {
        // The geometries of an instance have the numbers from that of the instance on. Most instances have one.
        let geometry = if hit.inst == embree::Hit::NO_INSTANCE { hit.geom } else { hit.inst + hit.geom };
        Self { t: hit.t, u: hit.u, v: hit.v, primitive: hit.prim, geometry }
    }
}

/// The geometry number of shapes in the list, which Embree does not hold.
pub(super) const IN_LIST: u32 = u32::MAX - 1;
