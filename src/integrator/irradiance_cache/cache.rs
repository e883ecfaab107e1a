//! The records of a filled cache, and their interpolation.

use super::octree::PackedOctree;
use super::record::IrradianceRecord;
use crate::math::Vec3;
use crate::spectrum::Rgb;

/// Records of irradiance in an octree of their regions.
#[derive(Clone, Debug, Default)]
pub struct IrradianceCache {
    pub(super) octree: PackedOctree,
    pub(super) records: Vec<IrradianceRecord>,
    pub(super) query: CacheQuery,
}

/// The allowed error of a record, as queries use it.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct CacheQuery {
    pub error: f32,
    pub inverse_error: f32,
}

impl CacheQuery {
    pub fn new(error: f32) -> Self {
        Self { error, inverse_error: 1.0 / error }
    }
}

impl IrradianceCache {
    /// Indirect irradiance [W m^-2] at `p` on the side of the unit normal `n`; `None` where no record is valid.
    #[inline]
    pub fn irradiance(&self, p: Vec3, n: Vec3) -> Option<Rgb> {
        let (mut sum, mut total) = (Rgb::ZERO, 0.0);
        for sphere in self.octree.candidates(p) {
            let weight = sphere.weight(p, n, self.query.inverse_error);
            if weight > 0.0
                && let Some(irradiance) = self.records[sphere.record as usize].extrapolate(sphere, p, n)
            {
                sum += weight * irradiance;
                total += weight;
            }
        }
        (total > 0.0).then(|| sum / total)
    }

    /// Number of records.
    pub fn len(&self) -> usize {
        self.records.len()
    }

    /// Whether there is no record.
    pub fn is_empty(&self) -> bool {
        self.records.is_empty()
    }

    /// Memory of the cache, bytes.
    pub fn bytes(&self) -> usize {
        self.octree.bytes() + size_of_val(&*self.records)
    }
}
