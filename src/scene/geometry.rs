//! From a hit of the ray kernel to a point on a surface: position, normals, material, emitter.
//!
//! Positions are rebuilt from the primitive in double precision and rounded once, never taken as origin + t * direction,
//! whose error grows with the distance of the ray's origin.

use std::sync::Arc;

use super::analytic::AnalyticGeometry;
use glam::Vec3Swizzles as _;

use crate::buffer::Buffer;
use crate::embree::{Charge, Device, TriangleMesh};
use crate::math::{DAffine3, DMat3, DVec3, HitPoint, ROUNDING, Vec3};
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

/// Bound on the error of a coordinate on its way into an instance's frame, in units of its parts: half a unit in the last place
/// of each.
const PLACEMENT_ERROR: f64 = 0.5 * ROUNDING as f64;

/// A matrix whose determinant is smaller than the sum of its products by this is no longer inverted well in single precision.
///
/// Turns, and stretches along the axes before or after a turn, stay below 2 whatever they stretch by.
const CANCELLED: f64 = 16.0;

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

/// Triangles with what shading needs of them: the same memory that Embree reads, and what may be kept ready beside it. Clones
/// share it.
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
    /// See [`Triangles::prepare`].
    pub ready: Option<Arc<Ready>>,
}

/// Triangles for which what a hit is made of is kept ready.
#[derive(Debug)]
pub(super) struct Ready {
    triangles: Vec<ReadyTriangle>,
    _charge: Option<Charge>,
}

/// What a hit of a flat triangle is made of, in one line of the cache.
#[derive(Clone, Copy, Debug)]
#[repr(align(64))]
struct ReadyTriangle {
    corners: [[f32; 3]; 3],
    ng: [f32; 3],
    kernel_error: f32,
}

/// Up to this many triangles of a scene are kept ready, 64 bytes each: about as much as stays in a processor's second cache.
pub(super) const MOST_READY: usize = 4096;

/// A point of a triangle in its own frame, not yet rounded.
struct TrianglePoint {
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
    fn normal_and_error(&self) -> (Vec3, f32) {
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

    /// Keeps ready what hits are made of, for flat triangles of the scene frame: normals and errors need not be found anew at
    /// every hit, and three arrays not be looked up. The same bits. Returns how many are ready: all, or none where they are more
    /// than `room`, have normals of their own, or the device's allowance has nothing left for them.
    fn prepare(&mut self, room: usize, device: &Device) -> usize {
        let count = self.mesh.indices().len();
        if self.normals.is_some() || count > room {
            return 0;
        }
        let Ok(charge) = device.charge(count * size_of::<ReadyTriangle>()) else { return 0 };
        let ready = |primitive: usize| {
            let corners = self.mesh.indices().get(primitive).map(|corner| self.mesh.vertices().get(corner as usize));
            let (ng, kernel_error) = self.point(primitive as u32, 0.0, 0.0).normal_and_error();
            ReadyTriangle { corners, ng: ng.to_array(), kernel_error }
        };
        let triangles = (0..count).map(ready).collect();
        self.ready = Some(Arc::new(Ready { triangles, _charge: charge }));
        count
    }

    /// The vertices of a triangle.
    pub(super) fn corners(&self, primitive: u32) -> [DVec3; 3] {
        let vertices = self.mesh.vertices();
        self.mesh.indices().get(primitive as usize).map(|i| DVec3::from(vertices.get(i as usize).map(f64::from)))
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

    #[inline(always)]
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
        TrianglePoint { p: at(v0, [e1, e2], u, v), ng: e1.cross(e2), ns, sides: [e1, e2] }
    }
}

/// The point of a triangle with these weights of the second and third vertex.
#[inline(always)]
fn at(v0: DVec3, [e1, e2]: [DVec3; 2], u: f32, v: f32) -> DVec3 {
    v0 + f64::from(u) * e1 + f64::from(v) * e2
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
    Instance { triangles: Triangles, surface: u32, placement: Box<Placement> },
    /// Analytic shapes as user geometry, with the surface of each.
    Analytic { shapes: Arc<AnalyticGeometry>, surfaces: Vec<u32> },
}

impl Geometry {
    /// [`Triangles::prepare`], for those of the scene frame. Returns how many bytes that took.
    pub(super) fn prepare(&mut self, room: &mut usize, device: &Device) -> usize {
        match self {
            Self::Loose { triangles, .. } | Self::Flat { triangles, .. } => {
                let count = triangles.prepare(*room, device);
                *room -= count;
                count * size_of::<ReadyTriangle>()
            }
            Self::Instance { .. } | Self::Analytic { .. } => 0,
        }
    }

    /// What of its triangles is kept ready, if it is.
    #[inline]
    pub(super) fn ready(&self) -> Option<&Ready> {
        match self {
            Self::Loose { triangles, .. } | Self::Flat { triangles, .. } => triangles.ready.as_deref(),
            Self::Instance { .. } | Self::Analytic { .. } => None,
        }
    }

    /// Triangles whose arrays are looked up at every hit.
    #[inline]
    pub(super) fn far_triangles(&self) -> Option<&Triangles> {
        match self {
            Self::Loose { triangles, .. } | Self::Flat { triangles, .. } | Self::Instance { triangles, .. } => {
                triangles.ready.is_none().then_some(triangles)
            }
            Self::Analytic { .. } => None,
        }
    }
}

/// Whether the arrays that are looked up may be too large for the processor's caches.
pub(super) fn are_large(geometries: &[Geometry]) -> bool {
    let far = geometries.iter().filter_map(Geometry::far_triangles);
    far.map(|triangles| triangles.mesh.indices().len()).sum::<usize>() > MOST_READY
}

/// Where an instance stands, and how exactly the kernel moves rays there.
///
/// The kernel inverts the matrix in single precision and adds the inverse's translation, rounded, to every ray's origin. Both
/// move the ray in the object's frame by an error that need not be along the normal, nor small in the scene: where the
/// transform stretches, the same step in the object's frame is many lengths in the scene's.
#[derive(Clone, Copy, Debug)]
pub(super) struct Placement {
    to_scene: DAffine3,
    /// Inverse transpose, for normals.
    normals: DMat3,
    /// Magnitudes of the matrix.
    stretch: DMat3,
    /// Bound on the error in the object's frame that comes of rounding, for each unit of a coordinate in the scene's frame.
    rounding: DMat3,
    /// The same, and with it the error of the inverse.
    inverting: DMat3,
}

/// What an inversion in single precision is made of.
struct Cofactors {
    /// The cofactors with the magnitudes of their products added, transposed.
    sums: DMat3,
    /// Magnitude of the determinant.
    determinant: f64,
    /// The sum of the magnitudes of its products over the determinant: by this much its relative error grows.
    cancelled: f64,
}

impl Cofactors {
    fn new(m: &DMat3) -> Self {
        let DMat3 { x_axis: a, y_axis: b, z_axis: c } = magnitudes(m);
        let cross = |a: DVec3, b: DVec3| a.yzx() * b.zxy() + a.zxy() * b.yzx();
        let determinant = m.determinant().abs();
        let sums = DMat3::from_cols(cross(b, c), cross(c, a), cross(a, b)).transpose();
        Self { sums, determinant, cancelled: a.dot(cross(b, c)) / determinant }
    }
}

/// Whether the kernel, which inverts an instance's transform in single precision, sees the instance where it is. One that it
/// does not is better copied into the scene's frame.
pub(super) fn inverts_well(transform: &DAffine3) -> bool {
    let Cofactors { determinant, cancelled, .. } = Cofactors::new(&transform.matrix3);
    (determinant as f32).is_normal() && cancelled < CANCELLED
}

fn magnitudes(m: &DMat3) -> DMat3 {
    DMat3::from_cols(m.x_axis.abs(), m.y_axis.abs(), m.z_axis.abs())
}

impl Placement {
    /// The transform as the kernel is given it: rounded to single precision.
    pub(super) fn new(to_scene: DAffine3) -> Self {
        let to_scene = DAffine3::from_cols_array(&to_scene.to_cols_array().map(|x| f64::from(x as f32)));
        let m = to_scene.matrix3;
        let inverse = m.inverse();
        let rounding = magnitudes(&inverse) * PLACEMENT_ERROR;
        let Cofactors { sums, determinant, cancelled } = Cofactors::new(&m);
        // Cofactors over the determinant: what cancels in them was rounded before.
        let inverting =
            sums * (PLACEMENT_ERROR / determinant) + magnitudes(&inverse) * (PLACEMENT_ERROR * cancelled) + rounding;
        let stretch = magnitudes(&m);
        Self { to_scene, normals: inverse.transpose(), stretch, rounding, inverting }
    }

    /// The transform.
    pub(super) fn transform(&self) -> &DAffine3 {
        &self.to_scene
    }

    /// How far from its plane, along the normal, a triangle may seem to the kernel because of its place; times the length of the
    /// normal after the transform. `p` is the point in the scene.
    #[inline]
    fn error(&self, p: DVec3, point: &TrianglePoint) -> f64 {
        let translation = self.to_scene.translation;
        let [e1, e2] = point.sides;
        let around = (p - translation).abs() + self.stretch * e1.abs().max(e2.abs());
        let moved = self.rounding * (p.abs() + translation.abs()) + self.inverting * around;
        point.ng.abs().dot(moved)
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

/// A point on one of the triangles that are kept ready.
#[inline(always)]
pub(super) fn on_ready(ready: &Ready, owners: &Owners, primitive: u32, u: f32, v: f32) -> SurfaceInteraction {
    let ReadyTriangle { corners, ng, kernel_error } = &ready.triangles[primitive as usize];
    let [v0, v1, v2] = corners.map(|corner| DVec3::from(corner.map(f64::from)));
    let (p, ng) = (at(v0, [v1 - v0, v2 - v0], u, v).as_vec3a(), Vec3::from(*ng));
    interaction(p, HitPoint::rounding_error(p, ng) + kernel_error, ng, None, owners.of(primitive))
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
    placement: &Placement,
    primitive: u32,
    u: f32,
    v: f32,
) -> SurfaceInteraction {
    let point = triangles.point(primitive, u, v);
    let exact = placement.to_scene.transform_point3(point.p);
    let p = exact.as_vec3a();
    let normal = placement.normals * point.ng;
    let length = normal.length();
    let ng = (normal / length).as_vec3a();
    let ns = point.ns.map(|ns| (placement.normals * ns.as_dvec3()).as_vec3a());
    // Along the object's normal, which becomes as much shorter or longer on its way to the scene as the error does.
    let kernel_error = f64::from(point.normal_and_error().1) * point.ng.length() + placement.error(exact, &point);
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::embree::{DeviceOptions, MemoryBudget};
    use crate::sampling::Rng;

    /// Triangles of all sizes and shapes, far from the origin and near it.
    #[test]
    fn what_is_kept_ready_is_what_would_be_found() {
        let mut rng = Rng::new(21, 0);
        let mut random = || Vec3::new(rng.next_f32(), rng.next_f32(), rng.next_f32()) * 2.0 - Vec3::ONE;
        let mut vertices = Vec::new();
        for i in 0..1000 {
            let (size, far) = (10.0_f32.powi(i % 21 - 12), 10.0_f32.powi(i % 5 - 2));
            let (first, side, other) = (far * random(), size * random(), size * random());
            // Every third is narrow.
            let other = if i % 3 == 0 { 0.5 * side + 1e-5 * other } else { other };
            vertices.extend([first, first + side, first + other].map(|corner| corner.to_array()));
        }
        let indices = (0..1000).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
        let mesh = TriangleMesh::new(vertices, indices).unwrap();
        let (normals, original) = (None, None);
        let triangles =
            Triangles { mesh, normals, any_length: false, original, swapped: false, _charge: None, ready: None };
        let mut prepared = triangles.clone();
        assert_eq!(prepared.prepare(1000, &Device::new(&DeviceOptions::default()).unwrap()), 1000);
        let ready = prepared.ready.unwrap();
        let owners = Owners::One(Owner { surface: 1, material: 2, emitter: NO_EMITTER });
        let bits = |on: SurfaceInteraction| {
            let SurfaceInteraction { point: HitPoint { p, error }, ng, ns, .. } = on;
            [p, ng, ns, Vec3::splat(error)].map(|v| v.to_array().map(f32::to_bits))
        };
        let mut compared = 0;
        for primitive in 0..1000 {
            let [u, v, _] = random().to_array().map(|x| 0.5 * x.abs());
            let found = on_triangle(&triangles, &owners, primitive, u, v);
            // Those without any area are in no scene.
            if found.ng.is_finite() {
                assert_eq!(bits(on_ready(&ready, &owners, primitive, u, v)), bits(found), "{primitive}");
                compared += 1;
            }
        }
        assert!(compared > 700, "{compared}");
    }

    fn one_triangle(count: usize, smooth: bool) -> Geometry {
        let corner = [0.0, 1.0, 0.0];
        let mesh = TriangleMesh::new(vec![[0.0; 3], [1.0, 0.0, 0.0], corner], vec![[0, 1, 2]; count]).unwrap();
        let normals = smooth.then(|| vec![corner; 3].into());
        let (any_length, swapped) = (false, false);
        let triangles = Triangles { mesh, normals, any_length, original: None, swapped, _charge: None, ready: None };
        Geometry::Flat { triangles, surface: 0 }
    }

    #[test]
    fn as_many_are_kept_ready_as_there_is_room_for() {
        let budget = MemoryBudget::new(64 * 1500);
        let device = Device::new(&DeviceOptions { budget: Some(budget.clone()), ..DeviceOptions::default() }).unwrap();
        let before = budget.used();
        let mut room = 2000;
        // Too many for the room, smooth, ready, too many for what is left, ready, too many for the allowance.
        let counts = [(2001, false), (1, true), (1000, false), (1001, false), (400, false), (200, false)];
        let mut geometries = counts.map(|(count, smooth)| one_triangle(count, smooth));
        let bytes = geometries.each_mut().map(|geometry| geometry.prepare(&mut room, &device));
        assert_eq!((bytes, room), ([0, 0, 64_000, 0, 25_600, 0], 600));
        assert_eq!(budget.used() - before, 89_600);
        assert_eq!(geometries.each_ref().map(|g| g.ready().is_some()), bytes.map(|bytes| bytes > 0));
        drop(geometries);
        assert_eq!(budget.used(), before);
    }

    #[test]
    fn few_triangles_that_are_looked_up_are_not_large() {
        assert!(!are_large(&[one_triangle(MOST_READY - 1, false), one_triangle(1, true)]));
        assert!(are_large(&[one_triangle(MOST_READY, false), one_triangle(1, true)]));
    }
}
