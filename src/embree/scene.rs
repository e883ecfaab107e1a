//! Built scenes and their queries.

use std::sync::Arc;

use super::device::DeviceInner;
use super::mesh::TriangleMesh;
use super::ray::{Hit, from_embree, is_traceable, no_hit, to_embree};
use super::user::ErasedUserData;
use super::width::PacketWidth;
use super::{Device, sys};
use crate::math::{Bounds, DVec3, Ray, shutter_time};
use crate::{Error, ErrorKind, Result};

/// The kinds of geometry in a scene, including those inside its instances.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Features {
    /// Triangle meshes.
    pub triangles: bool,
    /// Embree's own spheres.
    pub spheres: bool,
    /// User geometry.
    pub user: bool,
    /// Instances of other scenes.
    pub instances: bool,
    /// Geometry that moves during the shutter interval, so that a ray's time counts.
    pub motion: bool,
}

impl Features {
    pub(super) fn union(self, other: Self) -> Self {
        Self {
            triangles: self.triangles | other.triangles,
            spheres: self.spheres | other.spheres,
            user: self.user | other.user,
            instances: self.instances | other.instances,
            motion: self.motion | other.motion,
        }
    }

    pub(super) fn mask(self) -> sys::RTCFeatureFlags {
        let flag = |on: bool, bits: sys::RTCFeatureFlags| if on { bits } else { sys::RTC_FEATURE_FLAG_NONE };
        flag(self.triangles, sys::RTC_FEATURE_FLAG_TRIANGLE)
            | flag(self.spheres, sys::RTC_FEATURE_FLAG_SPHERE_POINT)
            | flag(self.user, sys::RTC_FEATURE_FLAG_USER_GEOMETRY_CALLBACK_IN_GEOMETRY)
            | flag(self.instances, sys::RTC_FEATURE_FLAG_INSTANCE)
            | flag(self.motion, sys::RTC_FEATURE_FLAG_MOTION_BLUR)
    }
}

/// The memory to which a scene's Embree geometry points; it lives as long as the scene.
pub(super) enum GeometryData {
    Triangles(TriangleMesh),
    Spheres(Vec<[f32; 4]>),
    User(Arc<dyn ErasedUserData>),
    Instance(Scene),
    /// No geometry has the number.
    None,
}

impl GeometryData {
    /// Number of primitives in the hierarchy.
    pub(super) fn primitives(&self) -> usize {
        match self {
            Self::Triangles(mesh) => mesh.indices().len(),
            Self::Spheres(spheres) => spheres.len(),
            Self::User(user) => user.len(),
            Self::Instance(_) => 1,
            Self::None => 0,
        }
    }
}

/// An Embree scene with all memory to which it refers. Fields are dropped after `drop` has released the scene.
pub(super) struct SceneInner {
    pub(super) raw: sys::RTCScene,
    pub(super) data: Vec<GeometryData>,
    pub(super) features: Features,
    pub(super) mask: sys::RTCFeatureFlags,
    /// User geometry, Embree's spheres and instances in scenes with motion are queried with single rays.
    pub(super) width: PacketWidth,
    pub(super) bvh_bytes: usize,
    pub(super) device: Arc<DeviceInner>,
}

// SAFETY: the raw scene may be moved to, and released on, any thread; all else in it is `Send`.
unsafe impl Send for SceneInner {}
// SAFETY: a shared `SceneInner` exists only inside `Scene`, that is, after a successful commit; Embree allows any
// number of threads to query a committed scene at once, and nothing changes it any more.
unsafe impl Sync for SceneInner {}

impl Drop for SceneInner {
    fn drop(&mut self) {
        // SAFETY: `raw` came from `rtcNewScene` and is used for the last time. An instance of it elsewhere holds a
        // `Scene`, so there is none; the device lives, since its `Arc` is dropped after this.
        unsafe { sys::rtcReleaseScene(self.raw) }
    }
}

/// A built scene: immutable, cheap to clone, and safe to query from any number of threads.
#[derive(Clone)]
pub struct Scene {
    pub(super) inner: Arc<SceneInner>,
}

impl Scene {
    /// Version of the Embree library found at run time: major, minor, patch.
    pub fn version(&self) -> [u32; 3] {
        self.inner.device.version()
    }

    /// The first hit of `ray`. A ray that is not traceable (NaN, infinity, no direction, an empty or negative interval)
    /// hits nothing.
    ///
    /// A component of the direction below 1e-18 in absolute value is treated as that small by the hierarchy, so the
    /// direction as a whole should be far longer; near unit length is best.
    #[inline]
    pub fn intersect(&self, ray: &Ray) -> Option<Hit> {
        if !is_traceable(ray) {
            return None;
        }
        let hit = self.query(ray)?;
        Some(self.complete_hit(ray, hit))
    }

    /// Completes a hit whose barycentric weights the kernel does not compute, as in tiny triangles.
    #[inline(always)]
    pub(super) fn complete_hit(&self, ray: &Ray, hit: Hit) -> Hit {
        if hit.u == 0.0 && hit.v == 0.0 {
            // The hit itself is not passed on: it would have to be in memory for that, written field by field and read
            // as a whole, for which the processor waits.
            if let Some([u, v]) = self.recompute_barycentrics(ray, hit.t, [hit.prim, hit.geom, hit.inst]) {
                return Hit { u, v, ..hit };
            }
        }
        hit
    }

    /// The true barycentric weights of a hit at `t` whose weights are those of a triangle's first vertex; `None` where
    /// these cannot be improved.
    ///
    /// Embree divides by twice the area of the triangle times the length of the direction, and where that is below
    /// 1e-18 it leaves the weights at zero. A longer direction brings the divisor back into the range; the factor is a
    /// power of two, so that everything else is unchanged.
    #[cold]
    #[inline(never)]
    fn recompute_barycentrics(&self, ray: &Ray, t: f32, [prim, geom, inst]: [u32; 3]) -> Option<[f32; 2]> {
        const LONGER: f32 = (1_u64 << 60) as f32;
        let own = |number: u32| &self.inner.data[number as usize];
        let hit = match inst {
            Hit::NO_INSTANCE => own(geom),
            _ => match own(inst) {
                GeometryData::Instance(child) => &child.inner.data[geom as usize],
                other => other,
            },
        };
        if !matches!(hit, GeometryData::Triangles(_)) {
            return None;
        }
        let t = t / LONGER;
        let longer = Ray {
            direction: ray.direction * LONGER,
            tnear: t * (1.0 - 8.0 * f32::EPSILON),
            tfar: t * (1.0 + 8.0 * f32::EPSILON),
            ..*ray
        };
        if !is_traceable(&longer) {
            return None;
        }
        let again = self.query(&longer)?;
        ([again.prim, again.geom, again.inst] == [prim, geom, inst]).then_some([again.u, again.v])
    }

    /// Embree's result for a ray that is traceable.
    #[inline(always)]
    fn query(&self, ray: &Ray) -> Option<Hit> {
        let mut found = sys::RTCRayHit { ray: to_embree(ray, self.time_of(ray)), hit: no_hit() };
        let mut arguments = self.intersect_arguments(sys::RTC_RAY_QUERY_FLAG_INCOHERENT);
        // SAFETY: the scene is committed (a `Scene` is made by `SceneBuilder::commit` alone); both structures are
        // local, of the layout the build script checked, and aligned by their types.
        unsafe { sys::rtcIntersect1(self.inner.raw, &raw mut found, &raw mut arguments) };
        from_embree(&found)
    }

    /// The time that Embree reads with the ray: 0 where nothing moves.
    #[inline(always)]
    pub(super) fn time_of(&self, ray: &Ray) -> f32 {
        if self.inner.features.motion { shutter_time(ray.time) } else { 0.0 }
    }

    // Made for each query and not kept in the scene: it is five words, and Embree takes it by a pointer it may write
    // to.
    #[inline(always)]
    pub(super) fn intersect_arguments(&self, flags: sys::RTCRayQueryFlags) -> sys::RTCIntersectArguments {
        sys::RTCIntersectArguments {
            flags,
            feature_mask: self.inner.mask,
            context: std::ptr::null_mut(),
            filter: None,
            intersect: None,
        }
    }

    #[inline(always)]
    pub(super) fn occluded_arguments(&self) -> sys::RTCOccludedArguments {
        sys::RTCOccludedArguments {
            flags: sys::RTC_RAY_QUERY_FLAG_INCOHERENT,
            feature_mask: self.inner.mask,
            context: std::ptr::null_mut(),
            filter: None,
            occluded: None,
        }
    }

    /// Whether `ray` hits anything. A ray that is not traceable hits nothing.
    #[inline]
    pub fn occluded(&self, ray: &Ray) -> bool {
        if !is_traceable(ray) {
            return false;
        }
        let mut segment = to_embree(ray, self.time_of(ray));
        let mut arguments = self.occluded_arguments();
        // SAFETY: as in `query`.
        unsafe { sys::rtcOccluded1(self.inner.raw, &raw mut segment, &raw mut arguments) };
        segment.tfar == f32::NEG_INFINITY
    }

    /// The bounding box of everything in the scene; empty for an empty scene.
    pub fn bounds(&self) -> Bounds {
        let mut b = sys::RTCBounds {
            lower_x: f32::INFINITY,
            lower_y: f32::INFINITY,
            lower_z: f32::INFINITY,
            align0: 0.0,
            upper_x: f32::NEG_INFINITY,
            upper_y: f32::NEG_INFINITY,
            upper_z: f32::NEG_INFINITY,
            align1: 0.0,
        };
        // SAFETY: the scene is committed, and `b` is local and of the right layout.
        unsafe { sys::rtcGetSceneBounds(self.inner.raw, &raw mut b) };
        let point = |x: f32, y: f32, z: f32| DVec3::new(x.into(), y.into(), z.into());
        Bounds { min: point(b.lower_x, b.lower_y, b.lower_z), max: point(b.upper_x, b.upper_y, b.upper_z) }
    }

    /// Bytes of the hierarchy and of the buffers to which it refers. Shared buffers count in full, and scenes inside
    /// instances do not count. The hierarchy's part is the growth of the device's memory during the build, and
    /// therefore too small if another scene of the device was dropped meanwhile.
    pub fn memory_bytes(&self) -> usize {
        let buffers = self.inner.data.iter().map(|data| match data {
            GeometryData::Triangles(mesh) => mesh.memory_bytes(),
            GeometryData::Spheres(spheres) => size_of_val(&spheres[..]),
            GeometryData::User(user) => user.memory_bytes(),
            GeometryData::Instance(_) | GeometryData::None => 0,
        });
        self.inner.bvh_bytes + buffers.sum::<usize>()
    }

    /// Bytes of the hierarchy alone, with the same inaccuracy as [`Scene::memory_bytes`].
    pub fn hierarchy_bytes(&self) -> usize {
        self.inner.bvh_bytes
    }

    /// The kinds of geometry in the scene.
    pub fn features(&self) -> Features {
        self.inner.features
    }

    /// The device with which the scene was built.
    pub fn device(&self) -> Device {
        Device { inner: Arc::clone(&self.inner.device) }
    }

    /// Whether all queries so far succeeded; to be called after a batch of them.
    ///
    /// # Errors
    /// [`ErrorKind::Internal`] with the message of the first panic in user geometry, of this scene or of one inside an
    /// instance. The error remains: such a scene has lost hits.
    pub fn check(&self) -> Result<()> {
        for data in &self.inner.data {
            match data {
                GeometryData::User(user) => {
                    if let Some(message) = user.panic_message() {
                        let message = format!("user geometry panicked while a ray was traced: {message}");
                        return Err(Error::new(ErrorKind::Internal, message));
                    }
                }
                GeometryData::Instance(scene) => scene.check()?,
                GeometryData::Triangles(_) | GeometryData::Spheres(_) | GeometryData::None => {}
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use std::mem::offset_of;

    use super::*;
    use crate::embree::{DeviceOptions, SceneBuilder, SceneOptions};
    use crate::math::{DAffine3, Vec3};

    const CANARY: u64 = 0x5afe_c0de_dead_beef;

    /// Embree's structure between words that must not be written.
    #[repr(C, align(64))]
    struct Guarded<T> {
        before: [u64; 8],
        inside: T,
        after: [u64; 32],
    }

    /// Embree writes within the structures that this crate declares, and to the fields it reads.
    #[test]
    fn queries_write_nothing_outside_their_structures() {
        let device = Device::new(&DeviceOptions::default()).unwrap();
        let mesh = TriangleMesh::new(vec![[0.0, 0.0, 1.0], [1.0, 0.0, 1.0], [0.0, 1.0, 1.0]], vec![[0, 1, 2]]).unwrap();
        let mut builder = SceneBuilder::new(&device, SceneOptions::default()).unwrap();
        builder.add_triangles(mesh).unwrap();
        let child = builder.commit(None).unwrap();
        let mut builder = SceneBuilder::new(&device, SceneOptions::default()).unwrap();
        builder.add_spheres(vec![[9.0, 9.0, 9.0, 1.0]]).unwrap();
        builder.add_instance(&child, &DAffine3::IDENTITY).unwrap();
        let parent = builder.commit(None).unwrap();

        let ray = Ray::new(Vec3::new(0.25, 0.5, 0.0), Vec3::Z);
        for scene in [&child, &parent] {
            let inside = sys::RTCRayHit { ray: to_embree(&ray, 0.0), hit: no_hit() };
            let mut query = Guarded { before: [CANARY; 8], inside, after: [CANARY; 32] };
            let arguments = scene.intersect_arguments(sys::RTC_RAY_QUERY_FLAG_INCOHERENT);
            let mut arguments = Guarded { before: [CANARY; 8], inside: arguments, after: [CANARY; 32] };
            // SAFETY: as in `query`.
            unsafe { sys::rtcIntersect1(scene.inner.raw, &raw mut query.inside, &raw mut arguments.inside) };
            assert_eq!((query.before, query.after), ([CANARY; 8], [CANARY; 32]));
            assert_eq!((arguments.before, arguments.after), ([CANARY; 8], [CANARY; 32]));
            let hit = from_embree(&query.inside).expect("a hit");
            assert_eq!(Some(hit), scene.intersect(&ray));
            // The last bits depend on the processor's reciprocals.
            let errors = [hit.t - 1.0, hit.u - 0.25, hit.v - 0.5];
            assert!(hit.prim == 0 && errors.iter().all(|error| error.abs() < 4.0 * f32::EPSILON), "{hit:?}");

            let mut segment = Guarded { before: [CANARY; 8], inside: to_embree(&ray, 0.0), after: [CANARY; 32] };
            // SAFETY: as in `occluded`.
            unsafe { sys::rtcOccluded1(scene.inner.raw, &raw mut segment.inside, std::ptr::null_mut()) };
            assert_eq!((segment.before, segment.after), ([CANARY; 8], [CANARY; 32]));
            assert_eq!(segment.inside.tfar, f32::NEG_INFINITY);
        }
        let inst = parent.intersect(&ray).map(|hit| (hit.geom, hit.inst));
        assert_eq!(inst, Some((0, 1)));
        assert_eq!(child.intersect(&ray).map(|hit| hit.inst), Some(Hit::NO_INSTANCE));
    }

    /// The structures end where their last fields do, padding aside, and start aligned.
    #[test]
    fn structures_have_the_size_of_their_fields() {
        assert_eq!(offset_of!(sys::RTCRayHit, hit), size_of::<sys::RTCRay>());
        assert_eq!(size_of::<sys::RTCRayHit>(), size_of::<sys::RTCRay>() + size_of::<sys::RTCHit>());
        assert_eq!((align_of::<sys::RTCRayHit>(), align_of::<sys::RTCRay>()), (16, 16));
    }
}
