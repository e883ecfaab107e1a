//! From a hit of the ray kernel to a point on a surface: position, normals, material, emitter.
//!
//! Positions are rebuilt from the primitive in double precision and rounded once, never taken as origin + t * direction,
//! whose error grows with the distance of the ray's origin.

use std::sync::Arc;

use super::analytic::AnalyticGeometry;
use crate::buffer::Buffer;
use crate::embree::{Charge, TriangleMesh};
use crate::math::{DAffine3, DVec3, HitPoint, ROUNDING, Vec3};
use crate::shape::Analytic;

/// Stands for "no emitter".
pub(super) const NO_EMITTER: u32 = u32::MAX;

/// Half-units by which the kernel's single-precision plane distance may be off, per extent of the triangle. Measured with
/// random triangles (`tests/leaving.rs`) at less than half of this.
const KERNEL_ERROR: f32 = 4.0 * ROUNDING;

/// What a primitive belongs to.
#[derive(Clone, Copy, Debug)]
pub(super) struct Owner {
    /// Number of the surface in the scene.
    pub surface: u32,
    /// Number of its material.
    pub material: u32,
    /// Number of the emitter that the primitive is, or [`NO_EMITTER`].
    pub emitter: u32,
}

/// Who owns the primitives of a geometry.
#[derive(Debug)]
pub(super) enum Owners {
    /// One surface owns all; an emitting mesh's emitters are numbered from `first_emitter` on.
    One(Owner),
    /// Loose triangles, each with its own.
    Each(Vec<Owner>),
}

impl Owners {
    #[inline]
    pub(super) fn of(&self, primitive: u32) -> Owner {
        match self {
            Self::One(owner) if owner.emitter == NO_EMITTER => *owner,
            Self::One(owner) => Owner { emitter: owner.emitter + primitive, ..*owner },
            Self::Each(owners) => owners[primitive as usize],
        }
    }
}

/// A point on a surface, as shading wants it.
#[derive(Clone, Copy, Debug)]
pub struct SurfaceInteraction {
    /// The point, and how to leave it.
    pub point: HitPoint,
    /// Geometric unit normal on the outer side.
    pub ng: Vec3,
    /// Shading unit normal on the outer side; equals `ng` where shading is flat.
    pub ns: Vec3,
    /// Number of the surface in the scene.
    pub surface: u32,
    /// Number of its material.
    pub material: u32,
    /// Number of the emitter, where the surface emits.
    pub emitter: Option<u32>,
}

/// Triangles with what shading needs of them: the same memory that Embree reads. Clones share it.
#[derive(Clone, Debug)]
pub(super) struct Triangles {
    pub mesh: TriangleMesh,
    /// One per vertex for smooth shading; zero means none there.
    pub normals: Option<Buffer<[f32; 3]>>,
    /// Whether the normals are as a host gave them: not of unit length.
    pub any_length: bool,
    /// The number of each triangle in the mesh as it was given, where some were left out.
    pub original: Option<Arc<[u32]>>,
    /// Whether a mirroring transform turned the winding round: second and third vertex are those given as third and second.
    pub swapped: bool,
    /// What it takes from the device's shared allowance.
    pub _charge: Option<Arc<Charge>>,
}

/// A point of a triangle in its own frame, not yet rounded.
struct TrianglePoint {
    p: DVec3,
    /// Not normalised.
    ng: DVec3,
    /// Shading normal, not normalised, where there is one.
    ns: Option<Vec3>,
    /// Largest coordinate difference within the triangle.
    extent: f32,
}

impl Triangles {
    /// Bytes of this library's memory behind it.
    pub(super) fn memory_bytes(&self) -> usize {
        let original = self.original.as_ref().map_or(0, |original| size_of_val(&original[..]));
        self.mesh.memory_bytes() + self.normals.as_ref().map_or(0, Buffer::memory_bytes) + original
    }

    #[inline]
    fn point(&self, primitive: u32, u: f32, v: f32) -> TrianglePoint {
        let corners = self.mesh.indices().get(primitive as usize);
        let vertices = self.mesh.vertices();
        let [v0, v1, v2] = corners.map(|corner| DVec3::from(vertices.get(corner as usize).map(f64::from)));
        let (e1, e2) = (v1 - v0, v2 - v0);
        let ns = self.normals.as_ref().map(|normals| {
            let [n0, n1, n2] = corners.map(|corner| {
                let normal = Vec3::from(normals.get(corner as usize));
                if self.any_length { normal.normalize_or_zero() } else { normal }
            });
            (1.0 - u - v) * n0 + u * n1 + v * n2
        });
        TrianglePoint {
            p: v0 + f64::from(u) * e1 + f64::from(v) * e2,
            ng: e1.cross(e2),
            ns,
            extent: e1.abs().max(e2.abs()).max_element() as f32,
        }
    }
}

/// One triangle of those that surfaces have by themselves.
#[derive(Clone, Copy, Debug)]
pub(super) struct Part {
    pub surface: u32,
    /// Which half of a quad; 0 for a triangle.
    pub half: u32,
}

/// A geometry of the Embree scene. Who owns its primitives is kept apart ([`Owners`]): that can change while this stays.
#[derive(Debug)]
pub(super) enum Geometry {
    /// Triangles and quads of all surfaces, in the scene frame.
    Loose { triangles: Triangles, parts: Vec<Part> },
    /// A mesh in the scene frame.
    Flat { triangles: Triangles, surface: u32 },
    /// A mesh in its own frame, somewhere.
    Instance { triangles: Triangles, surface: u32, placement: Placement },
    /// Analytic shapes as user geometry, with the surface of each.
    Analytic { shapes: Arc<AnalyticGeometry>, surfaces: Vec<u32> },
}

/// Where an instance stands.
#[derive(Clone, Copy, Debug)]
pub(super) struct Placement {
    to_scene: DAffine3,
    /// Inverse transpose, for normals.
    normals: crate::math::DMat3,
    /// Largest stretch, which scales errors from the object's frame.
    stretch: f32,
}

impl Placement {
    pub(super) fn new(to_scene: DAffine3) -> Self {
        let m = to_scene.matrix3;
        let stretch = [m.x_axis, m.y_axis, m.z_axis].iter().map(|axis| axis.length()).sum::<f64>() as f32;
        Self { to_scene, normals: m.inverse().transpose(), stretch }
    }
}

/// The point `hit` by a ray, given everything the tables say.
#[inline]
fn interaction(p: Vec3, error: f32, ng: Vec3, ns: Option<Vec3>, owner: Owner) -> SurfaceInteraction {
    // Vertex normals that cancel out say nothing: shade flat there.
    let ns = ns.and_then(Vec3::try_normalize).unwrap_or(ng);
    SurfaceInteraction {
        point: HitPoint { p, error },
        ng,
        ns,
        surface: owner.surface,
        material: owner.material,
        emitter: (owner.emitter != NO_EMITTER).then_some(owner.emitter),
    }
}

/// A unit normal, in single precision unless its square would leave the range of that.
#[inline]
fn unit(normal: DVec3) -> Vec3 {
    let single = normal.as_vec3a();
    let length2 = single.length_squared();
    if (1e-30..1e30).contains(&length2) { single / length2.sqrt() } else { normal.normalize().as_vec3a() }
}

/// A point on triangles of the scene frame.
#[inline]
pub(super) fn on_triangle(
    triangles: &Triangles,
    owners: &Owners,
    primitive: u32,
    u: f32,
    v: f32,
) -> SurfaceInteraction {
    let point = triangles.point(primitive, u, v);
    let p = point.p.as_vec3a();
    let ng = unit(point.ng);
    interaction(p, triangle_error(p, ng, point.extent), ng, point.ns, owners.of(primitive))
}

/// A point on an instanced triangle.
#[inline]
pub(super) fn on_instance(
    triangles: &Triangles,
    owners: &Owners,
    placement: &Placement,
    primitive: u32,
    u: f32,
    v: f32,
) -> SurfaceInteraction {
    let point = triangles.point(primitive, u, v);
    let p = placement.to_scene.transform_point3(point.p).as_vec3a();
    let ng = unit(placement.normals * point.ng);
    let ns = point.ns.map(|ns| (placement.normals * ns.as_dvec3()).as_vec3a());
    // The kernel moves the ray into the object's frame in single precision: its origin, and the translation that is
    // added to it, are rounded there.
    let moved = placement.to_scene.translation.abs().max_element() as f32 + p.abs().max_element();
    let own = point.p.abs().max_element() as f32 + point.extent;
    let error = triangle_error(p, ng, 0.0) + KERNEL_ERROR * (moved + placement.stretch * own);
    interaction(p, error, ng, ns, owners.of(primitive))
}

/// A point on an analytic shape, from the point that the ray's t gives.
#[inline]
pub(super) fn on_analytic(shape: &Analytic, owner: Owner, near: DVec3) -> SurfaceInteraction {
    let (p, ng) = shape.project(near);
    let (p, ng) = (p.as_vec3a(), ng.as_vec3a());
    interaction(p, HitPoint::rounding_error(p, ng), ng, None, owner)
}

/// How far off its plane a point on a triangle may seem to the kernel.
#[inline]
pub(super) fn triangle_error(p: Vec3, ng: Vec3, extent: f32) -> f32 {
    HitPoint::rounding_error(p, ng) + KERNEL_ERROR * extent
}
