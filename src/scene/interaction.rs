//! From a hit of the ray kernel to a point on a surface: position, normals, material, emitter.
//!
//! Positions are rebuilt from the primitive in double precision and rounded once, never taken as origin + t * direction,
//! whose error grows with the distance of the ray's origin.

use std::sync::Arc;

use super::instance_transform::InstanceTransform;
use crate::buffer::Buffer;
use crate::embree::{Charge, TriangleMesh};
use crate::math::{DVec3, HitPoint, ROUNDING, Vec3};
use crate::shape::{Analytic, Triangle};

/// Stands for "no emitter".
pub(super) const NO_EMITTER: u32 = u32::MAX;

/// Bound on the kernel's error in the distance of a triangle's plane, in units of its extent: differences of vertices that were
/// rounded, and products with them.
const KERNEL_ERROR: f32 = 4.0 * ROUNDING;

/// Bound on the error of the products that make the kernel's normal, in units of the products.
const NORMAL_ERROR: f32 = ROUNDING;

/// The share of its own extent below which a triangle is so narrow that the kernel cannot tell its inside from its outside.
const NARROW: f32 = 256.0 * ROUNDING;

/// No triangle is left by more than this share of its extent. A narrower one may be met again; but what it would have to be left
/// by is more than what may stand beside it.
const FARTHEST: f32 = 0.0625;

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
pub(super) struct TrianglePoint {
    p: DVec3,
    /// Not normalised.
    ng: DVec3,
    /// Shading normal, not normalised, where there is one.
    ns: Option<Vec3>,
    /// The two sides that leave the first vertex.
    sides: [DVec3; 2],
}

impl TrianglePoint {
    /// Unit normal, and the bound on the distance of the kernel's plane from the true one.
    ///
    /// In single precision, unless squares would leave the range of that.
    #[inline]
    pub(super) fn normal_and_error(&self) -> (Vec3, f32) {
        let single = self.ng.as_vec3a();
        let length2 = single.length_squared();
        if (1e-30..1e30).contains(&length2) {
            let length = length2.sqrt();
            (single / length, kernel_error(self.sides.map(DVec3::as_vec3a), length))
        } else {
            self.scaled_normal_and_error()
        }
    }

    #[cold]
    #[inline(never)]
    fn scaled_normal_and_error(&self) -> (Vec3, f32) {
        let length = self.ng.length();
        ((self.ng / length).as_vec3a(), scaled_kernel_error(self.sides, length))
    }
}

impl Triangles {
    /// Bytes of this library's memory behind it.
    pub(super) fn memory_bytes(&self) -> usize {
        let original = self.original.as_ref().map_or(0, |original| size_of_val(&original[..]));
        self.mesh.memory_bytes() + self.normals.as_ref().map_or(0, Buffer::memory_bytes) + original
    }

    /// The vertices of a triangle.
    #[inline(always)]
    pub(super) fn corners(&self, primitive: u32) -> [DVec3; 3] {
        self.mesh.corners(primitive as usize).map(|corner| DVec3::from(corner.map(f64::from)))
    }

    /// Has the processor fetch what says where a triangle's vertices are.
    #[inline]
    pub(super) fn prefetch_corners(&self, primitive: u32) {
        self.mesh.indices().prefetch(primitive as usize);
    }

    /// Has the processor fetch a triangle's vertices.
    #[inline]
    pub(super) fn prefetch_vertices(&self, primitive: u32) {
        for corner in self.mesh.indices().get(primitive as usize) {
            self.mesh.vertices().prefetch(corner as usize);
            if let Some(normals) = &self.normals {
                normals.prefetch(corner as usize);
            }
        }
    }

    /// The point of a triangle with these weights of the second and third vertex.
    #[inline(always)]
    pub(super) fn point(&self, primitive: u32, u: f32, v: f32) -> TrianglePoint {
        let [v0, v1, v2] = self.corners(primitive);
        let (e1, e2) = (v1 - v0, v2 - v0);
        let ns = self.normals.as_ref().map(|normals| {
            let [n0, n1, n2] = self.mesh.indices().get(primitive as usize).map(|corner| {
                let normal = Vec3::from(normals.get(corner as usize));
                if self.any_length { normal.normalize_or_zero() } else { normal }
            });
            (1.0 - u - v) * n0 + u * n1 + v * n2
        });
        TrianglePoint { p: at(v0, [e1, e2], u, v), ng: e1.cross(e2), ns, sides: [e1, e2] }
    }
}

/// The point with these weights of the sides that leave `v0`.
#[inline(always)]
pub(super) fn at(v0: DVec3, [e1, e2]: [DVec3; 2], u: f32, v: f32) -> DVec3 {
    v0 + f64::from(u) * e1 + f64::from(v) * e2
}

/// The point `hit` by a ray, given everything the tables say.
#[inline]
pub(super) fn interaction(p: Vec3, error: f32, ng: Vec3, ns: Option<Vec3>, owner: Owner) -> SurfaceInteraction {
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
    let (ng, kernel_error) = point.normal_and_error();
    interaction(p, HitPoint::rounding_error(p, ng) + kernel_error, ng, point.ns, owners.of(primitive))
}

/// A point on an instanced triangle.
#[inline]
pub(super) fn on_instance(
    triangles: &Triangles,
    owners: &Owners,
    instance_transform: &InstanceTransform,
    primitive: u32,
    u: f32,
    v: f32,
) -> SurfaceInteraction {
    let point = triangles.point(primitive, u, v);
    let exact = instance_transform.to_scene.transform_point3(point.p);
    let p = exact.as_vec3a();
    let normal = instance_transform.normals * point.ng;
    let length = normal.length();
    let ng = (normal / length).as_vec3a();
    let ns = point.ns.map(|ns| (instance_transform.normals * ns.as_dvec3()).as_vec3a());
    // Along the object's normal, which becomes as much shorter or longer on its way to the scene as the error does.
    let kernel_error = f64::from(point.normal_and_error().1) * point.ng.length()
        + instance_transform.error(exact, point.ng, point.sides);
    let error = HitPoint::rounding_error(p, ng) + (kernel_error / length) as f32;
    interaction(p, error, ng, ns, owners.of(primitive))
}

/// A point on an analytic shape, from the point that the ray's t gives.
#[inline]
pub(super) fn on_analytic(shape: &Analytic, owner: Owner, near: DVec3) -> SurfaceInteraction {
    let (p, ng) = shape.project(near);
    let (p, ng) = (p.as_vec3a(), ng.as_vec3a());
    interaction(p, HitPoint::rounding_error(p, ng), ng, None, owner)
}

/// How far from its plane a triangle may seem to the kernel: of two of its sides and twice its area.
///
/// With the vertices `v` seen from the ray's origin, the kernel divides v0 . n by d . n, where n is the cross product of two
/// edges in single precision, in each component of that pair that loses less, of those that share the edge `e1`. The vertices
/// and edges are off by roundings in proportion to the extent, whatever the triangle's shape, since what a short edge is
/// off by turns the normal around the long one. But the products are off in proportion to themselves, and in a triangle whose
/// three edges are long and nearly parallel they cancel: with them the normal turns anywhere, and a vertex at the other
/// end of the triangle seems as far from the plane as the products are larger than the area.
///
/// A triangle as narrow as the roundings of its length is seen from a near horizon as turned by any angle around its long
/// axis, and met by rays that pass beside it: it is given more room, many times its own width.
#[inline]
fn kernel_error([e1, e2]: [Vec3; 2], double_area: f32) -> f32 {
    let extent = e1.abs().max(e2.abs()).max_element();
    let products = e1.length() * e2.length_squared().min(e1.distance_squared(e2)).sqrt();
    let narrow = (KERNEL_ERROR * NARROW * extent * extent + NORMAL_ERROR * products) / double_area;
    extent * (KERNEL_ERROR + narrow).min(FARTHEST)
}

/// [`kernel_error`] of a triangle of any size.
fn scaled_kernel_error(sides: [DVec3; 2], double_area: f64) -> f32 {
    let extent = sides[0].abs().max(sides[1].abs()).max_element();
    let sides = sides.map(|side| (side / extent).as_vec3a());
    extent as f32 * kernel_error(sides, (double_area / extent / extent) as f32)
}

/// The bound of [`HitPoint`] for all points of a triangle of the scene frame.
pub(super) fn triangle_error(triangle: &Triangle) -> f32 {
    let [v0, v1, v2] = triangle.vertices;
    let sides = triangle.sides().map(|side| side.as_dvec3());
    let reach = v0.abs().max(v1.abs()).max(v2.abs());
    HitPoint::rounding_error(reach, triangle.normal) + scaled_kernel_error(sides, 2.0 * f64::from(triangle.area))
}
