//! Triangle meshes in Embree's form, checked once when they are created.

use std::sync::Arc;

use super::sys;
use crate::buffer::Buffer;
use crate::math::{DVec3, time_segment};
use crate::{Cancel, Error, ErrorKind, Result};

/// Coordinates must be smaller than this in absolute value: Embree silently drops larger ones.
pub const MAX_COORDINATE: f32 = 1.844e18;

/// Items between two checks of a [`Cancel`], which take some ten microseconds.
const ITEMS_PER_CHECK: usize = 1 << 14;

/// The largest number of moments at which moving geometry can be given.
pub const MAX_TIME_STEPS: usize = sys::RTC_MAX_TIME_STEP_COUNT as usize;

/// Checks a number of moments at which geometry is given.
pub(super) fn check_time_steps(count: usize) -> Result<()> {
    if (1..=MAX_TIME_STEPS).contains(&count) {
        return Ok(());
    }
    Err(Error::new(ErrorKind::InvalidScene, format!("{count} time steps: needs 1 to {MAX_TIME_STEPS}")))
}

/// Whether Embree accepts the coordinate. False for NaN.
pub(super) fn in_range(x: f32) -> bool {
    x.abs() < MAX_COORDINATE
}

/// The first of `count` items that is not `good`.
fn first_bad(count: usize, cancel: &Cancel, good: impl Fn(usize) -> bool) -> Result<Option<usize>> {
    for start in (0..count).step_by(ITEMS_PER_CHECK) {
        cancel.check()?;
        if let Some(bad) = (start..count.min(start + ITEMS_PER_CHECK)).find(|&index| !good(index)) {
            return Ok(Some(bad));
        }
    }
    Ok(None)
}

/// Immutable vertex positions that meshes of several scenes may share.
///
/// Every coordinate is finite and smaller than [`MAX_COORDINATE`]. At least four more bytes are readable behind the
/// last vertex, since Embree reads each of them with a load of 16 bytes.
#[derive(Debug)]
pub struct VertexBuffer {
    /// The vertices, followed by one vertex of padding where this library owns the memory.
    buffer: Buffer<[f32; 3]>,
    /// Number of vertices.
    len: usize,
}

impl VertexBuffer {
    /// Takes ownership of the vertices; copies them only if the vector has no capacity for one more.
    ///
    /// # Errors
    /// [`ErrorKind::InvalidScene`] for a coordinate that is not finite or too large, and for more than 2^32 - 1
    /// vertices; [`ErrorKind::OutOfMemory`].
    pub fn new(vertices: Vec<[f32; 3]>) -> Result<Self> {
        Self::from_vec(vertices, &Cancel::new())
    }

    /// As [`VertexBuffer::new`], cancellable by `cancel`.
    pub(crate) fn from_vec(mut vertices: Vec<[f32; 3]>, cancel: &Cancel) -> Result<Self> {
        let len = vertices.len();
        vertices.try_reserve_exact(1).map_err(|error| {
            Error::new(ErrorKind::OutOfMemory, format!("no room for {len} vertices")).because(error)
        })?;
        vertices.push([0.0; 3]);
        Self { buffer: vertices.into(), len }.checked(cancel)
    }

    /// Vertices that are not moved. The host's memory is read in place, as [`Buffer::foreign`] guarantees that it can
    /// be; memory of this library, which has no padding, is copied.
    ///
    /// # Errors
    /// As [`VertexBuffer::new`]; [`ErrorKind::Cancelled`].
    pub fn from_buffer(buffer: Buffer<[f32; 3]>, cancel: &Cancel) -> Result<Self> {
        if buffer.is_foreign() {
            let len = buffer.len();
            return Self { buffer, len }.checked(cancel);
        }
        let mut vertices = Vec::new();
        let needed = buffer.len() + 1;
        vertices.try_reserve_exact(needed).map_err(|error| {
            Error::new(ErrorKind::OutOfMemory, format!("no room for {needed} vertices")).because(error)
        })?;
        vertices.extend(buffer.iter());
        Self::from_vec(vertices, cancel)
    }

    fn checked(self, cancel: &Cancel) -> Result<Self> {
        if u32::try_from(self.len).is_err() {
            return Err(Error::new(ErrorKind::InvalidScene, format!("{} vertices are too many", self.len)));
        }
        if let Some(index) = first_bad(self.len, cancel, |index| self.buffer.get(index).into_iter().all(in_range))? {
            let vertex = self.buffer.get(index);
            return Err(Error::new(
                ErrorKind::InvalidScene,
                format!("vertex {index} is {vertex:?}: coordinates must be finite and below {MAX_COORDINATE:e}"),
            ));
        }
        Ok(self)
    }

    /// Number of vertices.
    #[inline]
    pub fn len(&self) -> usize {
        self.len
    }

    /// Whether there is no vertex.
    pub fn is_empty(&self) -> bool {
        self.len == 0
    }

    /// The vertex `index`.
    ///
    /// # Panics
    /// If there is none.
    #[inline]
    pub fn get(&self, index: usize) -> [f32; 3] {
        // The padding behind the library's own vertices is zero, and no index of a mesh refers to it.
        self.buffer.get(index)
    }

    /// Prefetches the vertex `index` into the processor's cache.
    #[inline]
    pub(crate) fn prefetch(&self, index: usize) {
        self.buffer.prefetch(index);
    }

    /// All vertices in order.
    pub fn iter(&self) -> impl ExactSizeIterator<Item = [f32; 3]> + '_ {
        (0..self.len).map(|index| self.get(index))
    }

    /// Address of the first vertex.
    pub fn as_ptr(&self) -> *const [f32; 3] {
        self.buffer.as_ptr()
    }

    /// Bytes from one vertex to the next.
    pub fn stride(&self) -> usize {
        self.buffer.stride()
    }
}

/// A triangle mesh whose indices are valid. Cloning it shares the buffers.
#[derive(Clone, Debug)]
pub struct TriangleMesh {
    vertices: Arc<VertexBuffer>,
    indices: Buffer<[u32; 3]>,
    /// The vertices at the later time steps, where the mesh deforms.
    later: Option<Arc<[Arc<VertexBuffer>]>>,
}

impl TriangleMesh {
    /// A mesh that owns its buffers: positions in the scene's frame, and three indices into them for each triangle.
    ///
    /// # Errors
    /// As for [`VertexBuffer::new`] and [`TriangleMesh::shared`].
    pub fn new(vertices: Vec<[f32; 3]>, indices: Vec<[u32; 3]>) -> Result<Self> {
        Self::shared(Arc::new(VertexBuffer::new(vertices)?), indices)
    }

    /// A mesh whose vertices other meshes may use too.
    ///
    /// # Errors
    /// [`ErrorKind::InvalidScene`] for an index that is not below the number of vertices, for no triangle at all, and
    /// for more than 2^32 - 1 triangles.
    pub fn shared(vertices: Arc<VertexBuffer>, indices: impl Into<Buffer<[u32; 3]>>) -> Result<Self> {
        Self::checked(vertices, indices.into(), &Cancel::new())
    }

    /// As [`TriangleMesh::shared`], cancellable by `cancel`.
    pub(crate) fn checked(vertices: Arc<VertexBuffer>, indices: Buffer<[u32; 3]>, cancel: &Cancel) -> Result<Self> {
        let count = vertices.len();
        if indices.is_empty() {
            return Err(Error::new(ErrorKind::InvalidScene, "a mesh needs at least one triangle"));
        }
        if u32::try_from(indices.len()).is_err() {
            return Err(Error::new(ErrorKind::InvalidScene, format!("{} triangles are too many", indices.len())));
        }
        let good = |index| indices.get(index).into_iter().all(|corner| (corner as usize) < count);
        if let Some(index) = first_bad(indices.len(), cancel, good)? {
            let triangle = indices.get(index);
            return Err(Error::new(
                ErrorKind::InvalidScene,
                format!("triangle {index} is {triangle:?}: there are only {count} vertices"),
            ));
        }
        Ok(Self { vertices, indices, later: None })
    }

    /// A mesh that deforms during the shutter interval. `steps` are its vertices at moments evenly spaced from time 0 to
    /// time 1, between which every vertex moves along a straight line at constant speed. One step is a mesh at rest.
    ///
    /// # Errors
    /// As for [`TriangleMesh::shared`]; [`ErrorKind::InvalidScene`] for no step or more than [`MAX_TIME_STEPS`], and for
    /// steps with different numbers of vertices.
    pub fn deforming(steps: &[Arc<VertexBuffer>], indices: impl Into<Buffer<[u32; 3]>>) -> Result<Self> {
        check_time_steps(steps.len())?;
        let count = steps[0].len();
        if let Some(step) = steps.iter().position(|step| step.len() != count) {
            let message = format!("time step {step} has {} vertices, but the first has {count}", steps[step].len());
            return Err(Error::new(ErrorKind::InvalidScene, message));
        }
        let mesh = Self::shared(Arc::clone(&steps[0]), indices)?;
        Ok(Self { later: (steps.len() > 1).then(|| steps[1..].into()), ..mesh })
    }

    /// Number of moments at which the vertices are given; 1 for a mesh at rest.
    pub fn time_steps(&self) -> usize {
        1 + self.later.as_ref().map_or(0, |later| later.len())
    }

    /// Whether the vertices move.
    #[inline]
    pub fn is_deforming(&self) -> bool {
        self.later.is_some()
    }

    /// The vertices at one of the moments, of which the first is number 0.
    ///
    /// # Panics
    /// If there is no such moment.
    #[inline]
    pub fn vertices_at_step(&self, step: usize) -> &Arc<VertexBuffer> {
        match (step, &self.later) {
            (0, _) => &self.vertices,
            (step, later) => &later.as_ref().expect("a mesh at rest has one time step")[step - 1],
        }
    }

    /// The shared vertices.
    #[inline]
    pub fn vertices(&self) -> &Arc<VertexBuffer> {
        &self.vertices
    }

    /// The indices of each triangle's vertices.
    #[inline]
    pub fn indices(&self) -> &Buffer<[u32; 3]> {
        &self.indices
    }

    /// The vertices of a triangle.
    ///
    /// # Panics
    ///
    /// If there is no such triangle.
    #[inline(always)]
    pub fn corners(&self, triangle: usize) -> [[f32; 3]; 3] {
        self.indices.get(triangle).map(|corner| self.vertices.get(corner as usize))
    }

    /// The vertices of a triangle at a time in [0, 1], in double precision.
    ///
    /// # Panics
    ///
    /// If there is no such triangle.
    #[inline(always)]
    pub(crate) fn corners_at(&self, triangle: usize, time: f32) -> [DVec3; 3] {
        let exact = |corners: [[f32; 3]; 3]| corners.map(|corner| DVec3::from(corner.map(f64::from)));
        if self.later.is_some() { self.moving_corners(triangle, time) } else { exact(self.corners(triangle)) }
    }

    #[cold]
    #[inline(never)]
    fn moving_corners(&self, triangle: usize, time: f32) -> [DVec3; 3] {
        let (step, weight) = time_segment(self.time_steps(), time);
        self.indices.get(triangle).map(|corner| {
            let at = |step| DVec3::from(self.vertices_at_step(step).get(corner as usize).map(f64::from));
            at(step).lerp(at(step + 1), f64::from(weight))
        })
    }

    /// Bytes of all buffers, without the host's memory.
    pub fn memory_bytes(&self) -> usize {
        let vertices = |step| self.vertices_at_step(step).buffer.memory_bytes();
        (0..self.time_steps()).map(vertices).sum::<usize>() + self.indices.memory_bytes()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn vertices_are_padded_and_not_copied_if_there_is_room() {
        let mut vertices = Vec::with_capacity(4);
        vertices.extend([[1.0, 2.0, 3.0]; 3]);
        let address = vertices.as_ptr();
        let buffer = VertexBuffer::new(vertices).unwrap();
        assert_eq!(buffer.as_ptr(), address);
        assert_eq!((buffer.len(), buffer.iter().len()), (3, 3));
        // 16 bytes from the start of the last vertex lie within the allocation.
        assert!(buffer.buffer.len() * 12 >= 2 * 12 + 16);
    }

    #[test]
    fn a_buffer_without_padding_is_copied() {
        let own = Buffer::from(vec![[1.0, 2.0, 3.0]; 3]);
        let address = own.as_ptr();
        let buffer = VertexBuffer::from_buffer(own, &Cancel::new()).unwrap();
        assert_ne!(buffer.as_ptr(), address);
        assert_eq!((buffer.len(), buffer.buffer.len()), (3, 4));
    }

    #[test]
    fn checking_can_be_cancelled() {
        let cancel = Cancel::new();
        cancel.cancel();
        let error = VertexBuffer::from_vec(vec![[0.0; 3]], &cancel).unwrap_err();
        assert_eq!(error.kind(), ErrorKind::Cancelled);
    }
}
