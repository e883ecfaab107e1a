//! Surfaces that emit on both sides: which emitter a hit sees.
//!
//! A hit knows the emitter on the side of the surface's normal. That of the other side is looked up only by what leaves on that side,
//! so that scenes in which no surface emits on both sides pay nothing.

use super::EmitterSet;
use crate::math::Vec3;

/// The number of the other side's emitter where that side emits nothing.
pub(super) const NO_BACK: u32 = u32::MAX;

impl EmitterSet {
    /// The set in which surfaces emit on both sides: pairs of the number of the emitter on the side of a surface's normal, which hits on
    /// the surface have, and of that on its other side. Panics for numbers of no emitter.
    pub fn with_backs(mut self, pairs: &[[u32; 2]]) -> Self {
        if !pairs.is_empty() {
            self.backs = vec![NO_BACK; self.emitters.len()];
        }
        for &[front, back] in pairs {
            assert!((back as usize) < self.emitters.len(), "emitter {back} of {} does not exist", self.emitters.len());
            self.backs[front as usize] = back;
        }
        self
    }

    /// Whether some of them are inner sides of cylinders.
    pub fn has_inner_tubes(&self) -> bool {
        self.emitters.iter().any(|emitter| matches!(emitter, super::Emitter::InnerTube(_)))
    }

    /// The number of the emitter on the other side of the surface of emitter `index`, where that side emits too.
    pub fn back_of(&self, index: u32) -> Option<u32> {
        self.backs.get(index as usize).copied().filter(|back| *back != NO_BACK)
    }

    /// The number of the emitter that shines along `wo` (unit, leaving the surface) from a hit on a surface that has emitter `index` on
    /// the side of its normal `ng`: that of the side of `wo`.
    #[inline(always)]
    pub fn on_side(&self, index: u32, ng: Vec3, wo: Vec3) -> Option<u32> {
        let height = ng.dot(wo);
        if height > 0.0 { Some(index) } else { self.on_back(index, height) }
    }

    /// [`Self::on_side`] of a direction that does not leave on the side of the normal.
    #[cold]
    #[inline(never)]
    fn on_back(&self, index: u32, height: f32) -> Option<u32> {
        if height < 0.0 { self.back_of(index) } else { None }
    }
}
