//! A cache of the flat triangles of the scene frame. It stores the corners, the normal and the error bound of each
//! triangle, so that a hit neither recomputes normals and errors nor reads three separate arrays.

use crate::embree::{Charge, Device};
use crate::math::{DVec3, HitPoint, Vec3};

use super::hit::Hit;
use super::interaction::{Owners, SurfaceInteraction, Triangles, at, interaction};

/// Up to this number of triangles of a scene are cached, with 64 bytes each: about as much as fits a processor's
/// second-level cache.
pub(super) const MAX_CACHED_TRIANGLES: usize = 4096;

/// The cached triangles of one geometry.
#[derive(Debug)]
pub(super) struct TriangleCache {
    triangles: Vec<CachedTriangle>,
    _charge: Option<Charge>,
}

/// The data from which a hit of a flat triangle is built, in one cache line.
#[derive(Clone, Copy, Debug)]
#[repr(align(64))]
struct CachedTriangle {
    corners: [[f32; 3]; 3],
    ng: [f32; 3],
    kernel_error: f32,
}

impl TriangleCache {
    /// Caches all of the triangles and subtracts their number from `room`. Returns `None` where there are more
    /// triangles than `room`, where the triangles have vertex normals or move, or where the device's memory allowance is used
    /// up.
    pub(super) fn new(triangles: &Triangles, room: &mut usize, device: &Device) -> Option<Self> {
        let count = triangles.mesh.indices().len();
        if triangles.normals.is_some() || triangles.mesh.time_steps() > 1 || count > *room {
            return None;
        }
        let charge = device.charge(count * size_of::<CachedTriangle>()).ok()?;
        *room -= count;
        let cache = |primitive: usize| {
            let (ng, kernel_error) = triangles.point(primitive as u32, 0.0, 0.0, 0.0).normal_and_error();
            CachedTriangle { corners: triangles.mesh.corners(primitive), ng: ng.to_array(), kernel_error }
        };
        Some(Self { triangles: (0..count).map(cache).collect(), _charge: charge })
    }

    /// Bytes of memory that the cache takes.
    pub(super) fn memory_bytes(&self) -> usize {
        size_of_val(&self.triangles[..])
    }

    /// Builds the same interaction as [`on_triangle`](super::interaction::on_triangle), to the last bit.
    #[inline(always)]
    pub(super) fn point_of(&self, owners: &Owners, hit: &Hit, time: f32) -> SurfaceInteraction {
        let &Hit { primitive, u, v, .. } = hit;
        let CachedTriangle { corners, ng, kernel_error } = &self.triangles[primitive as usize];
        let [v0, v1, v2] = corners.map(|corner| DVec3::from(corner.map(f64::from)));
        let (p, ng) = (at(v0, [v1 - v0, v2 - v0], u, v).as_vec3a(), Vec3::from(*ng));
        let error = HitPoint::rounding_error(p, ng) + kernel_error;
        interaction(HitPoint { time, ..HitPoint::new(p, error) }, ng, None, owners.of(primitive))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::embree::{DeviceOptions, MemoryBudget, TriangleMesh};
    use crate::sampling::Rng;
    use crate::scene::geometry::{Geometry, are_large};
    use crate::scene::interaction::{NO_EMITTER, Owner, on_triangle};

    /// Makes triangles of all sizes and shapes, far from the origin and near it.
    #[test]
    fn cached_triangles_give_the_same_interactions() {
        let mut rng = Rng::new(21, 0);
        let mut random = || Vec3::new(rng.next_f32(), rng.next_f32(), rng.next_f32()) * 2.0 - Vec3::ONE;
        let mut vertices = Vec::new();
        for i in 0..1000 {
            let (size, far) = (10.0_f32.powi(i % 21 - 12), 10.0_f32.powi(i % 5 - 2));
            let (first, side, other) = (far * random(), size * random(), size * random());
            // Every third triangle is narrow.
            let other = if i % 3 == 0 { 0.5 * side + 1e-5 * other } else { other };
            vertices.extend([first, first + side, first + other].map(|corner| corner.to_array()));
        }
        let indices = (0..1000).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
        let mesh = TriangleMesh::new(vertices, indices).unwrap();
        let (normals, original) = (None, None);
        let triangles = Triangles {
            mesh,
            normals,
            later_normals: None,
            any_length: false,
            original,
            swapped: false,
            _charge: None,
        };
        let device = Device::new(&DeviceOptions::default()).unwrap();
        let cache = TriangleCache::new(&triangles, &mut 1000, &device).unwrap();
        let owners = Owners::One(Owner { surface: 1, material: 2, emitter: NO_EMITTER });
        let bits = |on: SurfaceInteraction| {
            let SurfaceInteraction { point: HitPoint { p, error, .. }, ng, ns, .. } = on;
            [p, ng, ns, Vec3::splat(error)].map(|v| v.to_array().map(f32::to_bits))
        };
        let mut compared = 0;
        for primitive in 0..1000 {
            let [u, v, _] = random().to_array().map(|x| 0.5 * x.abs());
            let hit = Hit { t: 0.0, geometry: 0, primitive, u, v };
            let found = on_triangle(&triangles, &owners, &hit, 0.0);
            // Triangles without area are skipped, because no scene contains them.
            if found.ng.is_finite() {
                assert_eq!(bits(cache.point_of(&owners, &hit, 0.0)), bits(found), "{primitive}");
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
        let triangles =
            Triangles { mesh, normals, later_normals: None, any_length, original: None, swapped, _charge: None };
        Geometry::Flat { triangles, surface: 0, cache: None, moved: None }
    }

    #[test]
    fn triangles_are_cached_while_there_is_room() {
        let budget = MemoryBudget::new(64 * 1500);
        let device = Device::new(&DeviceOptions { budget: Some(budget.clone()), ..DeviceOptions::default() }).unwrap();
        let before = budget.used();
        let mut room = 2000;
        // The geometries are, in this order: too many triangles for the room, smooth, cached, too many for the
        // remaining room, cached, too many for the allowance.
        let counts = [(2001, false), (1, true), (1000, false), (1001, false), (400, false), (200, false)];
        let mut geometries = counts.map(|(count, smooth)| one_triangle(count, smooth));
        let bytes = geometries.each_mut().map(|geometry| geometry.cache_triangles(&mut room, &device));
        assert_eq!((bytes, room), ([0, 0, 64_000, 0, 25_600, 0], 600));
        assert_eq!(budget.used() - before, 89_600);
        assert_eq!(geometries.each_ref().map(|g| g.cache().is_some()), bytes.map(|bytes| bytes > 0));
        drop(geometries);
        assert_eq!(budget.used(), before);
    }

    #[test]
    fn few_triangles_that_are_looked_up_are_not_large() {
        assert!(!are_large(&[one_triangle(MAX_CACHED_TRIANGLES - 1, false), one_triangle(1, true)]));
        assert!(are_large(&[one_triangle(MAX_CACHED_TRIANGLES, false), one_triangle(1, true)]));
    }
}
