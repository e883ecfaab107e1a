//! Units of work that each item of a build takes. One unit is about a nanosecond.

/// Reading a vertex to extend the bounding box.
pub(super) const BOUND: f64 = 4.0;
/// Transforming and rounding a vertex.
pub(super) const PLACE: f64 = 10.0;
/// Testing whether a triangle has an area.
pub(super) const TEST: f64 = 20.0;
/// Adding the contribution of a triangle to the vertex normals.
pub(super) const NORMAL: f64 = 120.0;
/// Making an emitter of a triangle.
pub(super) const EMITTER: f64 = 80.0;
/// Adding a triangle to Embree's hierarchy, whose build takes all threads of the device.
pub(super) const HIERARCHY: f64 = 150.0;
