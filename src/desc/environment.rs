//! Light from infinity.

use crate::spectrum::Rgb;

/// Light from infinity, all around the scene. One scene has one at most.
#[derive(Clone, Debug, PartialEq)]
pub struct EnvironmentDesc {
    /// JSON path, for messages.
    pub path: String,
    /// Radiance from every direction [W m^-2 sr^-1], each channel >= 0.
    pub radiance: Rgb,
}
