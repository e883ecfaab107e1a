//! Units of work for one item of a build, about a nanosecond each.

/// Looking at a vertex for its box.
pub(super) const BOUND: f64 = 4.0;
/// Transforming and rounding a vertex.
pub(super) const PLACE: f64 = 10.0;
/// Testing a triangle for having an area.
pub(super) const TEST: f64 = 20.0;
/// A triangle's share in vertex normals.
pub(super) const NORMAL: f64 = 120.0;
/// A triangle as an emitter.
pub(super) const EMITTER: f64 = 80.0;
/// A triangle in Embree's hierarchy, which takes all threads of the device.
pub(super) const HIERARCHY: f64 = 150.0;
