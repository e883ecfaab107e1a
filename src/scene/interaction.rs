//! Builds the interaction at a hit of the ray kernel: position, normals, material and emitter.
//!
//! Positions are computed from the primitive in double precision and rounded once. They are never computed as origin +
//! t * direction, because the error of that grows with the distance of the ray's origin.

use std::sync::Arc;

use super::hit::Hit;
use super::instance_transform::InstanceTransform;
use crate::buffer::Buffer;
use crate::embree::{Charge, TriangleMesh};
use crate::math::{DVec3, HitPoint, ROUNDING, Vec3, shutter_time, time_segment};
use crate::shape::{Analytic, Triangle};

/// The number that stands for "no emitter".
pub(super) const NO_EMITTER: u32 = u32::MAX;

/// Bound on the kernel's error in the distance of a triangle's plane, in units of the triangle's extent. The error
/// comes from differences of vertices that were rounded, and from products with these differences.
const KERNEL_ERROR: f32 = 4.0 * ROUNDING;

/// Bound on the error of the products from which the kernel computes the normal, in units of the products.
const NORMAL_ERROR: f32 = ROUNDING;

/// Bound on the error of a coordinate that the kernel interpolates in time, in units of [`HitPoint::rounding_error`].
const INTERPOLATION_ERROR: f32 = 2.0;

/// A triangle whose width is below this share of its own extent is so narrow that the kernel cannot tell its inside
/// from its outside.
const NARROW: f32 = 256.0 * ROUNDING;

/// Greatest distance by which a ray's origin is moved off a triangle, as a share of the triangle's extent. A ray that
/// leaves a triangle narrower than that may hit the same triangle again, but a larger distance would exceed the
/// distance of the surfaces that may stand beside the triangle.
const FARTHEST: f32 = 0.0625;

/// The surface, material and emitter to which a primitive belongs.
#[derive(Clone, Copy, Debug)]
pub(super) struct Owner {
    /// Number of the surface in the scene.
    pub surface: u32,
    /// Number of its material.
    pub material: u32,
    /// Number of the emitter that the primitive represents, or [`NO_EMITTER`].
    pub emitter: u32,
}

/// The owners of the primitives of a geometry.
#[derive(Debug)]
pub(super) enum Owners {
    /// One surface owns all primitives. The emitters of an emitting mesh are numbered consecutively, starting at the
    /// owner's emitter.
    One(Owner),
    /// Loose triangles or shapes, each of which has its own owner.
    Each(Arc<[Owner]>),
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

/// A point on a surface with the properties that shading needs.
#[derive(Clone, Copy, Debug)]
pub struct SurfaceInteraction {
    /// The point, with the error bound by which rays leave the surface.
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

/// Triangles with the data that shading needs. The arrays are the memory that Embree reads, and clones share them.
#[derive(Clone, Debug)]
pub(super) struct Triangles {
    pub mesh: TriangleMesh,
    /// One normal per vertex for smooth shading. A zero vector means that the vertex has no normal.
    pub normals: Option<Buffer<[f32; 3]>>,
    /// The normals at the later time steps of the mesh, where it deforms and has normals.
    pub later_normals: Option<Arc<[Buffer<[f32; 3]>]>>,
    /// Whether the normals are stored as a host gave them and are not of unit length.
    pub any_length: bool,
    /// The number of each triangle in the mesh as it was given, where some triangles were left out.
    pub original: Option<Arc<[u32]>>,
    /// Whether a mirroring transform reversed the winding, so that the second and third vertex are the third and second
    /// that were given.
    pub swapped: bool,
    /// The memory that the triangles take from the device's shared allowance.
    pub _charge: Option<Arc<Charge>>,
}

/// A point of a triangle in the triangle's own frame, before rounding.
pub(super) struct TrianglePoint {
    p: DVec3,
    /// Geometric normal, not normalised.
    ng: DVec3,
    /// Shading normal, not normalised, where the triangle has one.
    ns: Option<Vec3>,
    /// The two sides that start at the first vertex.
    sides: [DVec3; 2],
}

impl TrianglePoint {
    /// Returns the unit normal, and the bound on the distance of the kernel's plane from the true one.
    ///
    /// Both are computed in single precision, unless squares would leave the range of single precision.
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
    /// Bytes of this library's memory that the triangles take.
    pub(super) fn memory_bytes(&self) -> usize {
        let original = self.original.as_ref().map_or(0, |original| size_of_val(&original[..]));
        let later = self.later_normals.iter().flat_map(|later| later.iter());
        let normals = self.normals.iter().chain(later).map(Buffer::memory_bytes).sum::<usize>();
        self.mesh.memory_bytes() + normals + original
    }

    /// The positions of a triangle's vertices at a time in [0, 1].
    #[inline(always)]
    pub(super) fn corners(&self, primitive: u32, time: f32) -> [DVec3; 3] {
        self.mesh.corners_at(primitive as usize, time)
    }

    /// [`TrianglePoint::normal_and_error`] of a point of this triangle at this time, with the error of interpolation in time
    /// where the mesh deforms.
    #[inline(always)]
    fn normal_and_error(&self, point: &TrianglePoint, primitive: u32, time: f32) -> (Vec3, f32) {
        let (ng, mut error) = point.normal_and_error();
        if self.mesh.is_deforming() {
            error += self.interpolation_error(primitive, time, ng);
        }
        (ng, error)
    }

    /// Bound on the error, along the unit normal, of the places to which the kernel interpolates the vertices of a triangle
    /// of a deforming mesh at this time.
    #[cold]
    fn interpolation_error(&self, primitive: u32, time: f32, n: Vec3) -> f32 {
        let (step, _) = time_segment(self.mesh.time_steps(), shutter_time(time));
        let mut reach = Vec3::ZERO;
        for corner in self.mesh.indices().get(primitive as usize) {
            for step in [step, step + 1] {
                reach = reach.max(Vec3::from(self.mesh.vertices_at_step(step).get(corner as usize)).abs());
            }
        }
        INTERPOLATION_ERROR * HitPoint::rounding_error(reach, n)
    }

    /// The normals of a triangle's vertices at a time in [0, 1], between those of two time steps. They are of unit length at the
    /// steps and shorter in between.
    #[cold]
    #[inline(never)]
    fn moving_normals(
        &self,
        first: &Buffer<[f32; 3]>,
        later: &[Buffer<[f32; 3]>],
        primitive: u32,
        time: f32,
    ) -> [Vec3; 3] {
        let (step, weight) = time_segment(later.len() + 1, time);
        let from = if step == 0 { first } else { &later[step - 1] };
        let to = &later[step];
        self.mesh.indices().get(primitive as usize).map(|corner| {
            let [from, to] = [from, to].map(|normals| Vec3::from(normals.get(corner as usize)));
            from.lerp(to, weight)
        })
    }

    /// The normals of a triangle's vertices at a time ([`crate::math::Ray::time`]), where it has any.
    pub(super) fn normals_at(&self, primitive: u32, time: f32) -> Option<[Vec3; 3]> {
        let normals = self.normals.as_ref()?;
        Some(match &self.later_normals {
            None => self.mesh.indices().get(primitive as usize).map(|corner| Vec3::from(normals.get(corner as usize))),
            Some(later) => self.moving_normals(normals, later, primitive, shutter_time(time)),
        })
    }

    /// Prefetches the indices of a triangle's vertices.
    #[inline]
    pub(super) fn prefetch_corners(&self, primitive: u32) {
        self.mesh.indices().prefetch(primitive as usize);
    }

    /// Prefetches a triangle's vertices and their normals.
    #[inline]
    pub(super) fn prefetch_vertices(&self, primitive: u32) {
        for corner in self.mesh.indices().get(primitive as usize) {
            self.mesh.vertices().prefetch(corner as usize);
            if let Some(normals) = &self.normals {
                normals.prefetch(corner as usize);
            }
        }
    }

    /// Returns the point of a triangle that has these weights of the second and third vertex, at a time in [0, 1].
    #[inline(always)]
    pub(super) fn point(&self, primitive: u32, u: f32, v: f32, time: f32) -> TrianglePoint {
        let [v0, v1, v2] = self.corners(primitive, time);
        let (e1, e2) = (v1 - v0, v2 - v0);
        let ns = self.normals.as_ref().map(|normals| {
            let [n0, n1, n2] = match &self.later_normals {
                None => self.mesh.indices().get(primitive as usize).map(|corner| {
                    let normal = Vec3::from(normals.get(corner as usize));
                    if self.any_length { normal.normalize_or_zero() } else { normal }
                }),
                Some(later) => self.moving_normals(normals, later, primitive, time),
            };
            (1.0 - u - v) * n0 + u * n1 + v * n2
        });
        TrianglePoint { p: at(v0, [e1, e2], u, v), ng: e1.cross(e2), ns, sides: [e1, e2] }
    }
}

/// Returns the point that has these weights of the sides that start at `v0`.
#[inline(always)]
pub(super) fn at(v0: DVec3, [e1, e2]: [DVec3; 2], u: f32, v: f32) -> DVec3 {
    v0 + f64::from(u) * e1 + f64::from(v) * e2
}

/// Builds the interaction at a hit from its point, normals and owner.
#[inline]
pub(super) fn interaction(point: HitPoint, ng: Vec3, ns: Option<Vec3>, owner: Owner) -> SurfaceInteraction {
    // Where vertex normals cancel out, shading is flat.
    let ns = ns.and_then(Vec3::try_normalize).unwrap_or(ng);
    SurfaceInteraction {
        point,
        ng,
        ns,
        surface: owner.surface,
        material: owner.material,
        emitter: (owner.emitter != NO_EMITTER).then_some(owner.emitter),
    }
}

/// Builds the interaction at a point on a triangle of the scene frame.
#[inline]
pub(super) fn on_triangle(triangles: &Triangles, owners: &Owners, hit: &Hit, time: f32) -> SurfaceInteraction {
    let &Hit { primitive, u, v, .. } = hit;
    let point = triangles.point(primitive, u, v, shutter_time(time));
    let p = point.p.as_vec3a();
    let (ng, kernel_error) = triangles.normal_and_error(&point, primitive, time);
    let error = HitPoint::rounding_error(p, ng) + kernel_error;
    interaction(HitPoint { time, ..HitPoint::new(p, error) }, ng, point.ns, owners.of(primitive))
}

/// Builds the interaction at a point on an instanced triangle.
#[inline]
pub(super) fn on_instance(
    triangles: &Triangles,
    owners: &Owners,
    instance_transform: &InstanceTransform,
    hit: &Hit,
    time: f32,
) -> SurfaceInteraction {
    let &Hit { primitive, u, v, .. } = hit;
    let point = triangles.point(primitive, u, v, shutter_time(time));
    let exact = instance_transform.to_scene.transform_point3(point.p);
    let p = exact.as_vec3a();
    let normal = instance_transform.normals * point.ng;
    let length = normal.length();
    let ng = (normal / length).as_vec3a();
    let ns = point.ns.map(|ns| (instance_transform.normals * ns.as_dvec3()).as_vec3a());
    // The error is measured along the object's normal. The transform to the scene scales the normal's length and the
    // error by the same factor.
    let (_, own_error) = triangles.normal_and_error(&point, primitive, time);
    let kernel_error =
        f64::from(own_error) * point.ng.length() + instance_transform.error([point.p, exact], point.ng, point.sides);
    let error = HitPoint::rounding_error(p, ng) + (kernel_error / length) as f32;
    interaction(HitPoint { time, ..HitPoint::new(p, error) }, ng, ns, owners.of(primitive))
}

/// Builds the interaction at a point on an analytic shape, from the point that the ray's t gives.
#[inline]
pub(super) fn on_analytic(shape: &Analytic, owner: Owner, near: DVec3, time: f32) -> SurfaceInteraction {
    let (p, ng) = shape.project(near);
    let (p, ng) = (p.as_vec3a(), ng.as_vec3a());
    interaction(HitPoint { time, ..HitPoint::new(p, HitPoint::rounding_error(p, ng)) }, ng, None, owner)
}

/// Bounds how far from its plane a triangle may appear to the kernel, from two of the triangle's sides and twice its
/// area.
///
/// With the vertices `v` relative to the ray's origin, the kernel divides v0 . n by d . n. The normal n is the cross
/// product of two edges in single precision. Of the two pairs of edges that share the edge `e1`, each component uses
/// the pair that loses less. The vertices and edges have rounding errors in proportion to the triangle's extent,
/// whatever the triangle's shape, since the error of a short edge turns the normal around the long edge. The errors of
/// the products, however, are in proportion to the products themselves. In a triangle whose three edges are long and
/// nearly parallel, the products cancel and the normal can turn in any direction; a vertex at the other end of the
/// triangle then appears as far from the plane as the ratio of the products to the area.
///
/// A triangle whose width is as small as the rounding error of its length appears, seen from a near horizon, as turned
/// by any angle around its long axis, and rays that pass beside the triangle hit it. The bound of such a triangle is
/// therefore larger, many times its own width.
#[inline]
fn kernel_error([e1, e2]: [Vec3; 2], double_area: f32) -> f32 {
    let extent = e1.abs().max(e2.abs()).max_element();
    let products = e1.length() * e2.length_squared().min(e1.distance_squared(e2)).sqrt();
    let narrow = (KERNEL_ERROR * NARROW * extent * extent + NORMAL_ERROR * products) / double_area;
    extent * (KERNEL_ERROR + narrow).min(FARTHEST)
}

/// Computes [`kernel_error`] for a triangle of any size.
fn scaled_kernel_error(sides: [DVec3; 2], double_area: f64) -> f32 {
    let extent = sides[0].abs().max(sides[1].abs()).max_element();
    let sides = sides.map(|side| (side / extent).as_vec3a());
    extent as f32 * kernel_error(sides, (double_area / extent / extent) as f32)
}

/// Returns an error bound of [`HitPoint`] that holds for all points of a triangle of the scene frame at all times, from its corners
/// at the time steps.
pub(super) fn moving_triangle_error(steps: &[[Vec3; 3]]) -> f32 {
    let reach = steps.iter().flatten().fold(Vec3::ZERO, |reach, corner| reach.max(corner.abs()));
    let still = steps.iter().filter_map(|corners| Triangle::new(*corners));
    let own = still.map(|triangle| triangle_error(&triangle)).fold(0.0, f32::max);
    own + INTERPOLATION_ERROR * HitPoint::rounding_error(reach, Vec3::ONE)
}

/// Returns an error bound of [`HitPoint`] that holds for all points of a triangle of the scene frame.
pub(super) fn triangle_error(triangle: &Triangle) -> f32 {
    let [v0, v1, v2] = triangle.vertices;
    let sides = triangle.sides().map(|side| side.as_dvec3());
    let reach = v0.abs().max(v1.abs()).max(v2.abs());
    HitPoint::rounding_error(reach, triangle.normal) + scaled_kernel_error(sides, 2.0 * f64::from(triangle.area))
}
