//! Photons, put in order so that those near a point are found.

use super::Photon;
use crate::math::Vec3;
use crate::{Cancel, Result};

/// Photons that can be asked for by place. Any number of them, 0 too, and anywhere: all in one plane, all in one point.
#[derive(Debug, Default)]
pub struct PhotonMap {
    photons: Vec<Photon>,
}

/// The photons nearest to a point, by index in [`PhotonMap::photons`], with their squared distances. Keeps its memory
/// between uses.
#[derive(Clone, Debug, Default)]
pub struct Nearest {
    found: Vec<(f32, u32)>,
}

impl Nearest {
    /// Squared distance and index, nearest first.
    pub fn found(&self) -> &[(f32, u32)] {
        &self.found
    }
}

impl PhotonMap {
    /// Puts photons in order. The order, and so every sum over them, depends on nothing but the photons and their order.
    ///
    /// # Errors
    /// [`crate::ErrorKind::Cancelled`].
    pub fn build(photons: Vec<Photon>, cancel: &Cancel) -> Result<Self> {
        cancel.check()?;
        Ok(Self { photons })
    }

    /// All photons, in the map's order.
    pub fn photons(&self) -> &[Photon] {
        &self.photons
    }

    /// Number of photons.
    pub fn len(&self) -> usize {
        self.photons.len()
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.photons.is_empty()
    }

    /// Bytes that it takes.
    pub fn bytes(&self) -> usize {
        self.photons.capacity() * size_of::<Photon>()
    }

    /// Visits every photon within `radius` (> 0) of `p`, with the square of its distance, always in the same order.
    #[inline]
    pub fn within(&self, p: Vec3, radius: f32, mut visit: impl FnMut(&Photon, f32)) {
        for photon in &self.photons {
            let distance2 = photon.position().distance_squared(p);
            if distance2 < radius * radius {
                visit(photon, distance2);
            }
        }
    }

    /// Finds the `count` photons nearest to `p` among those within `radius` (may be infinite), fewer if there are no more;
    /// of several at the same distance those of the lowest index.
    pub fn nearest(&self, p: Vec3, count: usize, radius: f32, nearest: &mut Nearest) {
        nearest.found.clear();
        let near = |(index, photon): (usize, &Photon)| (photon.position().distance_squared(p), index as u32);
        nearest.found.extend(self.photons.iter().enumerate().map(near).filter(|(d2, _)| *d2 < radius * radius));
        nearest.found.sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        nearest.found.truncate(count);
    }
}
