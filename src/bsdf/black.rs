//! A surface that absorbs everything.

use super::lobes::{Lobes, TransportMode};
use super::model::{BsdfSample, Model};
use crate::math::Vec3;
use crate::spectrum::Spectrum;

/// Absorbs all light.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Black;

impl Black {
    #[inline(always)]
    pub(super) fn in_spectrum<C: Spectrum>(&self, _: &C::Wavelengths) -> Self {
        Self
    }
}

impl<C: Spectrum> Model<C> for Black {
    fn lobes(&self) -> Lobes {
        Lobes::empty()
    }

    #[inline]
    fn albedo(&self) -> C {
        C::ZERO
    }

    #[inline]
    fn sample(&self, _: Vec3, _: [f32; 3], _: TransportMode) -> Option<BsdfSample<C>> {
        None
    }
}
