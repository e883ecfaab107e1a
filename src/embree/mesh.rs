//! Triangle meshes in the form Embree reads them, checked once on the way in.

use std::ops::Deref;
use std::sync::Arc;

use crate::{Error, ErrorKind, Result};

/// Coordinates must be smaller than this in absolute value: Embree silently drops what is not.
pub const MAX_COORDINATE: f32 = 1.844e18;

/// Whether Embree takes the coordinate. False for NaN.
pub(super) fn in_range(x: f32) -> bool {
    x.abs() < MAX_COORDINATE
}

/// Vertex positions that meshes of several scenes may share; read only from here on.
///
/// Every coordinate is finite and smaller than [`MAX_COORDINATE`]. One more vertex lies behind the last, since Embree
/// reads each of them with a load of 16 bytes.
#[derive(Debug)]
pub struct VertexBuffer {
    /// The vertices and one of padding.
    padded: Vec<[f32; 3]>,
}

impl VertexBuffer {
    /// Takes the vertices over; copies them only if the vector has no room for one more.
    ///
    /// # Errors
    /// [`ErrorKind::InvalidScene`] for a coordinate that is not finite or too large, and for more than 2^32 - 1
    /// vertices; [`ErrorKind::OutOfMemory`].
    pub fn new(mut vertices: Vec<[f32; 3]>) -> Result<Self> {
        if let Some((index, vertex)) = vertices.iter().enumerate().find(|(_, v)| !v.iter().all(|&x| in_range(x))) {
            return Err(Error::new(
                ErrorKind::InvalidScene,
                format!("vertex {index} is {vertex:?}: coordinates must be finite and below {MAX_COORDINATE:e}"),
            ));
        }
        if u32::try_from(vertices.len()).is_err() {
            return Err(Error::new(ErrorKind::InvalidScene, format!("{} vertices are too many", vertices.len())));
        }
        vertices.try_reserve_exact(1).map_err(|error| {
            Error::new(ErrorKind::OutOfMemory, format!("no room for {} vertices", vertices.len())).because(error)
        })?;
        vertices.push([0.0; 3]);
        Ok(Self { padded: vertices })
    }
}

impl Deref for VertexBuffer {
    type Target = [[f32; 3]];

    fn deref(&self) -> &[[f32; 3]] {
        &self.padded[..self.padded.len() - 1]
    }
}

/// A triangle mesh whose indices are known to be good. Cloning it shares the buffers.
#[derive(Clone, Debug)]
pub struct TriangleMesh {
    vertices: Arc<VertexBuffer>,
    indices: Arc<Vec<[u32; 3]>>,
}

impl TriangleMesh {
    /// A mesh that owns its buffers: positions in the scene's frame, and three indices into them for each triangle.
    ///
    /// # Errors
    /// As for [`VertexBuffer::new`] and [`TriangleMesh::shared`].
    pub fn new(vertices: Vec<[f32; 3]>, indices: Vec<[u32; 3]>) -> Result<Self> {
        Self::shared(Arc::new(VertexBuffer::new(vertices)?), indices)
    }

    /// A mesh over vertices that others use too.
    ///
    /// # Errors
    /// [`ErrorKind::InvalidScene`] for an index that names no vertex, for no triangle at all, and for more than
    /// 2^32 - 1 of them.
    pub fn shared(vertices: Arc<VertexBuffer>, indices: Vec<[u32; 3]>) -> Result<Self> {
        let count = vertices.len();
        if indices.is_empty() {
            return Err(Error::new(ErrorKind::InvalidScene, "a mesh needs at least one triangle"));
        }
        if u32::try_from(indices.len()).is_err() {
            return Err(Error::new(ErrorKind::InvalidScene, format!("{} triangles are too many", indices.len())));
        }
        if let Some((index, t)) = indices.iter().enumerate().find(|(_, t)| t.iter().any(|&i| i as usize >= count)) {
            return Err(Error::new(
                ErrorKind::InvalidScene,
                format!("triangle {index} is {t:?}: there are only {count} vertices"),
            ));
        }
        Ok(Self { vertices, indices: Arc::new(indices) })
    }

    /// The vertices, to be shared.
    pub fn vertices(&self) -> &Arc<VertexBuffer> {
        &self.vertices
    }

    /// The indices of each triangle's vertices.
    pub fn indices(&self) -> &[[u32; 3]] {
        &self.indices
    }

    /// Bytes of both buffers.
    pub fn memory_bytes(&self) -> usize {
        size_of_val(&self.vertices.padded[..]) + size_of_val(&self.indices[..])
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
        assert_eq!(buffer.len(), 3);
        // 16 bytes from the start of the last vertex lie within the allocation.
        assert!(buffer.padded.len() * 12 >= 2 * 12 + 16);
    }
}
