//! A surface that absorbs everything.

use super::{BsdfSample, Lobes, Model, TransportMode};
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
    fn f(&self, _: Vec3, _: Vec3, _: TransportMode) -> C {
        C::ZERO
    }

    #[inline]
    fn pdf(&self, _: Vec3, _: Vec3) -> f32 {
        0.0
    }

    #[inline]
    fn sample(&self, _: Vec3, _: [f32; 3], _: TransportMode) -> Option<BsdfSample<C>> {
        None
    }
}
