//! Types of lighting calculations.

pub use etd_quantity::*;

/// What is measured at a point.
#[repr(u32)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum etd_quantity {
    /// Illuminance, lx, of a small plane, whose normal is the direction.
    ETD_QUANTITY_ILLUMINANCE = 0,
    /// Luminance [cd m^-2] of what is seen from the point in the direction.
    ETD_QUANTITY_LUMINANCE = 1,
}

/// A point at which light is measured, world frame.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct etd_measuring_point {
    /// The point.
    pub position: [f64; 3],
    /// Normal of the plane, or direction that is looked into; any length except 0.
    pub direction: [f64; 3],
}

enumerations! {
    etd_quantity: ETD_QUANTITY_ILLUMINANCE, ETD_QUANTITY_LUMINANCE;
}
