//! Types of mattes.

pub use etd_matte_kind::*;

/// What the names of mattes are of.
#[repr(u32)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum etd_matte_kind {
    /// Objects: surfaces by their names, or by their JSON paths, such as `surfaces[3]`, where they have none.
    ETD_MATTE_OBJECT = 0,
    /// Materials: by their names, or by their JSON paths. A surface without a material is not seen.
    ETD_MATTE_MATERIAL = 1,
}

enumerations! {
    etd_matte_kind: ETD_MATTE_OBJECT, ETD_MATTE_MATERIAL;
}
