//! The geometries of a scene, in the order of their numbers in Embree.

use std::sync::Arc;

use super::analytic::AnalyticGeometry;
use super::cache::{MAX_CACHED_TRIANGLES, TriangleCache};
use super::instance_transform::InstancePath;
use super::interaction::Triangles;
use crate::embree::Device;

/// A loose triangle, which belongs to a surface directly and not to a mesh.
#[derive(Clone, Copy, Debug)]
pub(super) struct Part {
    pub surface: u32,
    /// The half of a quad, 0 or 1; 0 for a triangle.
    pub half: u32,
    /// Whether the transform of the surface mirrors it, so that the second and third vertex are the third and second that were given.
    pub is_mirrored: bool,
}

/// A geometry of the Embree scene. The owners of its primitives are stored separately ([`Owners`]), because they can
/// change while the geometry stays the same.
#[derive(Debug)]
pub(super) enum Geometry {
    /// Triangles and quads of all surfaces, in the scene frame.
    Loose { triangles: Triangles, parts: Arc<[Part]>, cache: Option<TriangleCache> },
    /// A mesh in the scene frame. Where it is moved there by a transform that changes with time, `moved` is that transform.
    Flat { triangles: Triangles, surface: u32, cache: Option<TriangleCache>, moved: Option<Box<InstancePath>> },
    /// A mesh in its own frame or in that of its group, placed by an instance transform, which may change with time.
    Instance { triangles: Triangles, surface: u32, instance_path: Arc<InstancePath> },
    /// Analytic shapes as user geometry, with the number of the surface of each.
    Analytic { shapes: Arc<AnalyticGeometry>, surfaces: Arc<[u32]> },
}

impl Geometry {
    /// Caches the geometry's triangles ([`TriangleCache::new`]). Returns how many bytes the cache takes.
    pub(super) fn cache_triangles(&mut self, room: &mut usize, device: &Device) -> usize {
        match self {
            Self::Loose { triangles, cache, .. } | Self::Flat { triangles, cache, .. } => {
                *cache = TriangleCache::new(triangles, room, device);
                cache.as_ref().map_or(0, TriangleCache::memory_bytes)
            }
            Self::Instance { .. } | Self::Analytic { .. } => 0,
        }
    }

    /// The cache of the geometry's triangles, if there is one.
    #[inline]
    pub(super) fn cache(&self) -> Option<&TriangleCache> {
        match self {
            Self::Loose { cache, .. } | Self::Flat { cache, .. } => cache.as_ref(),
            Self::Instance { .. } | Self::Analytic { .. } => None,
        }
    }

    /// Triangles that are not cached, so that every hit reads their arrays.
    #[inline]
    pub(super) fn far_triangles(&self) -> Option<&Triangles> {
        match self {
            Self::Loose { cache: Some(_), .. } | Self::Flat { cache: Some(_), .. } | Self::Analytic { .. } => None,
            Self::Loose { triangles, .. } | Self::Flat { triangles, .. } | Self::Instance { triangles, .. } => {
                Some(triangles)
            }
        }
    }
}

/// Returns whether the arrays of uncached triangles may be too large for the processor's caches.
pub(super) fn are_large(geometries: &[Geometry]) -> bool {
    let far = geometries.iter().filter_map(Geometry::far_triangles);
    far.map(|triangles| triangles.mesh.indices().len()).sum::<usize>() > MAX_CACHED_TRIANGLES
}
