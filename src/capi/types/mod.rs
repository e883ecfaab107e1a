//! The plain types of the C interface: enumerations, options and results.
//!
//! Structures that may grow begin with their own size. Zero bytes in a field mean the field's default, so that a structure of
//! an older header stays valid. Enumerations are passed as numbers and checked, because a Rust enumeration with a value that
//! it does not have would be undefined behaviour.

use super::status::etd_error;

/// Declares structures that may grow. The field after the name of a structure is where the smallest allowed size ends: the
/// field after the last one of the first version, or that last one itself.
macro_rules! versioned {
    ($($type:ty, $last:ident;)*) => {$(
        // SAFETY: the structure is `repr(C)`, begins with `struct_size: usize`, and consists of numbers, pointers and
        // `Option`s of functions, for which zero bytes are a value. Enumerations in it have a variant of value 0.
        unsafe impl $crate::capi::boundary::Versioned for $type {
            const SMALLEST: usize = std::mem::offset_of!($type, $last);
        }
    )*};
}

/// An enumeration that C passes as a number.
pub(in crate::capi) trait Enumeration: Copy + 'static {
    /// All values, in the order of their numbers, which count from 0.
    const ALL: &'static [Self];

    /// The number of this value in C.
    fn number(self) -> u32;
}

/// Implements [`Enumeration`] for enumerations of this module. A list without one of the values does not compile.
macro_rules! enumerations {
    ($($type:ident: $($value:ident),+;)*) => {$(
        impl $crate::capi::types::Enumeration for $type {
            const ALL: &'static [Self] = &[$($type::$value),+];

            fn number(self) -> u32 {
                match self {
                    $($type::$value => $type::$value as u32),+
                }
            }
        }
    )*};
}

mod bake;
mod device;
mod film;
mod light;
mod lighting;
mod material;
mod mattes;
mod motion;
mod query;
mod render;
mod scene;
mod shape;
mod sky;
mod spectrum;
mod texture;

pub use bake::*;
pub use device::*;
pub use film::*;
pub use light::*;
pub use lighting::*;
pub use material::*;
pub use mattes::*;
pub use motion::*;
pub use query::*;
pub use render::*;
pub use scene::*;
pub use shape::*;
pub use sky::*;
pub use spectrum::*;
pub use texture::*;

/// Types of numbers that C passes for enumerations. In the header, they have the names of the enumerations.
mod numbers {
    /// The enumeration of this name, as a number.
    pub type EtdUsage = u32;
    /// The enumeration of this name, as a number.
    pub type EtdCameraType = u32;
    /// The enumeration of this name, as a number.
    pub type EtdFovAxis = u32;
    /// The enumeration of this name, as a number.
    pub type EtdFocus = u32;
    /// The enumeration of this name, as a number.
    pub type EtdBsdf = u32;
    /// The enumeration of this name, as a number.
    pub type EtdDistribution = u32;
    /// The enumeration of this name, as a number.
    pub type EtdMasking = u32;
    /// The enumeration of this name, as a number.
    pub type EtdPositionFormat = u32;
    /// The enumeration of this name, as a number.
    pub type EtdSharing = u32;
    /// The enumeration of this name, as a number.
    pub type EtdSampler = u32;
    /// The enumeration of this name, as a number.
    pub type EtdFilter = u32;
    /// The enumeration of this name, as a number.
    pub type EtdIntegrator = u32;
    /// The enumeration of this name, as a number.
    pub type EtdPhotonKernel = u32;
    /// The enumeration of this name, as a number.
    pub type EtdPhotonSharing = u32;
    /// The enumeration of this name, as a number.
    pub type EtdCacheSource = u32;
    /// The enumeration of this name, as a number.
    pub type EtdSwitch = u32;
    /// The enumeration of this name, as a number.
    pub type EtdRadiositySolver = u32;
    /// The enumeration of this name, as a number.
    pub type EtdRoulette = u32;
    /// The enumeration of this name, as a number.
    pub type EtdErrorMeasure = u32;
    /// The enumeration of this name, as a number.
    pub type EtdLogChoice = u32;
    /// The enumeration of this name, as a number.
    pub type EtdLayer = u32;
    /// The enumeration of this name, as a number.
    pub type EtdFormat = u32;
    /// The enumeration of this name, as a number.
    pub type EtdToneMap = u32;
    /// The enumeration of this name, as a number.
    pub type EtdText = u32;
    /// The enumeration of this name, as a number.
    pub type EtdAtlasLayout = u32;
    /// The enumeration of this name, as a number.
    pub type EtdSide = u32;
    /// The enumeration of this name, as a number.
    pub type EtdShapeKind = u32;
    /// The enumeration of this name, as a number.
    pub type EtdTextureKind = u32;
    /// The enumeration of this name, as a number.
    pub type EtdTexelFormat = u32;
    /// The enumeration of this name, as a number.
    pub type EtdColorSpace = u32;
    /// The enumeration of this name, as a number.
    pub type EtdWrap = u32;
    /// The enumeration of this name, as a number.
    pub type EtdCoordinates = u32;
    /// The enumeration of this name, as a number.
    pub type EtdTextureFilter = u32;
    /// The enumeration of this name, as a number.
    pub type EtdTextureChannel = u32;
    /// The enumeration of this name, as a number.
    pub type EtdSkyProjection = u32;
    /// The enumeration of this name, as a number.
    pub type EtdQuantity = u32;
    /// The enumeration of this name, as a number.
    pub type EtdMatteKind = u32;
    /// The enumeration of this name, as a number.
    pub type EtdSpectrumKind = u32;
    /// The enumeration of this name, as a number.
    pub type EtdIlluminant = u32;
    /// The enumeration of this name, as a number.
    pub type EtdSpectrumTarget = u32;
    /// The enumeration of this name, as a number.
    pub type EtdPrimaries = u32;
}
pub use numbers::*;

/// Stands for "no material", "no surface", "no mesh".
pub const ETD_NONE: u32 = 0xffff_ffff;

versioned! {
    etd_error, json_path;
}
