//! Descriptions of lights without a surface.

use crate::math::DVec3;
use crate::spectrum::Rgb;

/// A point light.
#[derive(Clone, Debug, PartialEq)]
pub struct PointLightDesc {
    /// JSON path, for messages.
    pub path: String,
    /// Position of the light in the world frame.
    pub position: DVec3,
    /// Radiant intensity [W sr^-1], the same in all directions, >= 0.
    pub intensity: Rgb,
}
