//! What light is sampled for.

use crate::math::Vec3;

/// A place that light is sampled for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Receiver {
    /// Where it is.
    pub p: Vec3,
    /// Unit normal on the side from which light counts; 0 where it counts from all sides.
    pub(super) normal: Vec3,
}

impl Receiver {
    /// A surface at `p` to which light counts only where its direction has a positive cosine with the unit `normal`. No more
    /// than a hint for the choice: samples from behind may still come.
    #[inline]
    pub fn facing(p: Vec3, normal: Vec3) -> Self {
        Self { p, normal }
    }

    /// The unit normal on the side from which light counts; `None` where it counts from all sides.
    #[inline]
    pub fn normal(&self) -> Option<Vec3> {
        (self.normal != Vec3::ZERO).then_some(self.normal)
    }
}

/// A place to which light counts from all sides.
impl From<Vec3> for Receiver {
    #[inline]
    fn from(p: Vec3) -> Self {
        Self { p, normal: Vec3::ZERO }
    }
}
