//! User geometry with intersection tests of its own, and the functions through which Embree calls them.

use std::any::Any;
use std::ffi::c_void;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::{Arc, OnceLock};

use super::mesh::{check_time_steps, in_range};
use super::{ray, sys};
use crate::math::{Ray, RayCone, Vec3};
use crate::{Cancel, Error, ErrorKind, Result};

/// The intersection of a ray with a primitive of user geometry.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct UserHit {
    /// Distance along the ray, in lengths of its direction. A value outside the ray's interval, or NaN, counts as a
    /// miss.
    pub t: f32,
    /// First surface parameter, returned in the hit unchanged.
    pub u: f32,
    /// Second surface parameter, returned in the hit unchanged.
    pub v: f32,
    /// Geometric normal of any length, in the frame of the given ray; returned in the hit unchanged.
    pub ng: Vec3,
}

/// Primitives with an intersection test of their own, found through Embree's hierarchy over their bounding boxes.
///
/// All tracing threads call the tests concurrently. A panic in a test is caught: the ray misses that primitive, and
/// [`super::Scene::check`] reports the panic from then on.
pub trait UserGeometry: Send + Sync + 'static {
    /// Number of primitives; called once.
    fn len(&self) -> usize;

    /// Whether there is no primitive.
    fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Smallest and largest corner of a bounding box of primitive `index`; called once. The box must hold the whole
    /// primitive: parts outside of it are not found.
    fn bounds(&self, index: usize) -> ([f32; 3], [f32; 3]);

    /// Number of moments, evenly spaced from time 0 to time 1, at which the primitives have boxes: 1 where nothing moves,
    /// at most 129; called once.
    fn time_steps(&self) -> usize {
        1
    }

    /// A bounding box as [`UserGeometry::bounds`] gives it, at the moment `step` of [`UserGeometry::time_steps`]; called
    /// once each. Between two moments the primitive must lie within the box that is interpolated linearly, component by
    /// component, between the boxes of both.
    fn bounds_at(&self, index: usize, _step: usize) -> ([f32; 3], [f32; 3]) {
        self.bounds(index)
    }

    /// The first intersection of `ray` with primitive `index` within `[tnear, tfar]`. In an instance, `ray` is in the
    /// instance's frame and its direction is not of unit length, so that `t` is the same in both frames. Where anything in
    /// the scene moves, the ray has its time; elsewhere its time is 0.
    fn intersect(&self, index: usize, ray: &Ray) -> Option<UserHit>;

    /// Whether `ray` intersects primitive `index` at all within `[tnear, tfar]`.
    fn occluded(&self, index: usize, ray: &Ray) -> bool {
        self.intersect(index, ray).is_some_and(|hit| ray.tnear <= hit.t && hit.t <= ray.tfar)
    }
}

/// The data to which Embree's pointer for a user geometry points. All threads share it.
pub(super) struct UserGeometryData<G> {
    geometry: Arc<G>,
    /// Boxes that were computed once and checked: a hierarchy's input must not change during the build. Those of one
    /// primitive at all times stand together.
    bounds: Vec<sys::RTCBounds>,
    time_steps: usize,
    /// The message of the first panic.
    panic: OnceLock<String>,
}

/// User geometry data of any type.
pub(super) trait ErasedUserData: Send + Sync {
    fn panic_message(&self) -> Option<&str>;
    fn len(&self) -> usize;
    fn time_steps(&self) -> usize;
    fn memory_bytes(&self) -> usize;
}

impl<G: UserGeometry> ErasedUserData for UserGeometryData<G> {
    fn panic_message(&self) -> Option<&str> {
        self.panic.get().map(String::as_str)
    }

    fn len(&self) -> usize {
        self.bounds.len() / self.time_steps
    }

    fn time_steps(&self) -> usize {
        self.time_steps
    }

    fn memory_bytes(&self) -> usize {
        size_of_val(&self.bounds[..])
    }
}

impl<G: UserGeometry> UserGeometryData<G> {
    /// Computes and checks the geometry's boxes.
    ///
    /// Errors: no primitives, too many, or a box that is inverted or not finite.
    pub(super) fn new(geometry: Arc<G>, cancel: &Cancel) -> Result<Self> {
        let count = geometry.len();
        if count == 0 || u32::try_from(count).is_err() {
            let message = format!("user geometry with {count} primitives: needs 1 to 2^32 - 1");
            return Err(Error::new(ErrorKind::InvalidScene, message));
        }
        let time_steps = geometry.time_steps();
        check_time_steps(time_steps)?;
        let total = count.saturating_mul(time_steps);
        let mut bounds = Vec::new();
        bounds
            .try_reserve_exact(total)
            .map_err(|error| Error::new(ErrorKind::OutOfMemory, format!("no room for {total} boxes")).because(error))?;
        for number in 0..total {
            if number % 4096 == 0 {
                cancel.check()?;
            }
            let (index, step) = (number / time_steps, number % time_steps);
            let (lower, upper) = geometry.bounds_at(index, step);
            if !(0..3).all(|i| in_range(lower[i]) && in_range(upper[i]) && lower[i] <= upper[i]) {
                let message =
                    format!("primitive {index} has the box {lower:?} to {upper:?}: needs finite, ordered corners");
                return Err(Error::new(ErrorKind::InvalidScene, message));
            }
            bounds.push(sys::RTCBounds {
                lower_x: lower[0],
                lower_y: lower[1],
                lower_z: lower[2],
                align0: 0.0,
                upper_x: upper[0],
                upper_y: upper[1],
                upper_z: upper[2],
                align1: 0.0,
            });
        }
        Ok(Self { geometry, bounds, time_steps, panic: OnceLock::new() })
    }

    /// Runs a test of the geometry; a panic ends here and counts as `missed`.
    fn catch_panic<R>(&self, missed: R, test: impl FnOnce(&G) -> R) -> R {
        match catch_unwind(AssertUnwindSafe(|| test(&self.geometry))) {
            Ok(result) => result,
            Err(payload) => {
                self.panic.get_or_init(|| panic_text(&*payload));
                // Dropping a payload may panic in turn; leaking it cannot.
                std::mem::forget(payload);
                missed
            }
        }
    }
}

/// The message of a panic.
pub(super) fn panic_text(payload: &(dyn Any + Send)) -> String {
    let text = payload.downcast_ref::<&str>().map(|s| (*s).to_owned());
    text.or_else(|| payload.downcast_ref::<String>().cloned()).unwrap_or_else(|| "no message".to_owned())
}

/// Reads the box of a primitive from the table made when the geometry was added.
///
/// # Safety
/// To be called by Embree for a geometry whose user pointer is a live `UserGeometryData<G>`.
pub(super) unsafe extern "C" fn on_bounds<G: UserGeometry>(args: *const sys::RTCBoundsFunctionArguments) {
    // SAFETY: Embree passes a valid structure; the user pointer was set in `SceneBuilder::add_user` to a
    // `UserGeometryData<G>` of this very `G`, kept alive by the scene; `bounds_o` is Embree's to be written.
    unsafe {
        let args = &*args;
        let data = &*args.geometryUserPtr.cast_const().cast::<UserGeometryData<G>>();
        if let Some(bounds) = data.bounds.get(args.primID as usize * data.time_steps + args.timeStep as usize) {
            args.bounds_o.write(*bounds);
        }
    }
}

/// Index of the single-ray fields in Embree's packet of size 1, in floats: the ray, then the hit.
mod field {
    pub const TNEAR: usize = 3;
    pub const DIRECTION: usize = 4;
    pub const TIME: usize = 7;
    pub const TFAR: usize = 8;
    pub const NG: usize = 12;
    pub const U: usize = 15;
    pub const V: usize = 16;
    pub const PRIM: usize = 17;
    pub const GEOM: usize = 18;
    pub const INST: usize = 19;
}

/// The packet layout is used for one ray only, where it is that of `RTCRayHit`.
const _: () = {
    use std::mem::offset_of;
    assert!(offset_of!(sys::RTCRay, org_x) == 0);
    assert!(offset_of!(sys::RTCRay, tnear) == 4 * field::TNEAR);
    assert!(offset_of!(sys::RTCRay, dir_x) == 4 * field::DIRECTION);
    assert!(offset_of!(sys::RTCRay, time) == 4 * field::TIME);
    assert!(offset_of!(sys::RTCRay, tfar) == 4 * field::TFAR);
    let hit = offset_of!(sys::RTCRayHit, hit);
    assert!(hit + offset_of!(sys::RTCHit, Ng_x) == 4 * field::NG);
    assert!(hit + offset_of!(sys::RTCHit, u) == 4 * field::U);
    assert!(hit + offset_of!(sys::RTCHit, v) == 4 * field::V);
    assert!(hit + offset_of!(sys::RTCHit, primID) == 4 * field::PRIM);
    assert!(hit + offset_of!(sys::RTCHit, geomID) == 4 * field::GEOM);
    assert!(hit + offset_of!(sys::RTCHit, instID) == 4 * field::INST);
};

/// The ray at the start of a packet of size 1.
///
/// # Safety
/// `packet` points to such a packet.
#[inline]
unsafe fn read_ray(packet: *const f32) -> Ray {
    // SAFETY: the fields lie within `RTCRay`, as the constants above are checked against it.
    unsafe {
        let at = |i: usize| packet.add(i).read();
        Ray {
            origin: Vec3::new(at(0), at(1), at(2)),
            direction: Vec3::new(at(field::DIRECTION), at(field::DIRECTION + 1), at(field::DIRECTION + 2)),
            tnear: at(field::TNEAR),
            tfar: at(field::TFAR),
            time: at(field::TIME),
            cone: RayCone::default(),
        }
    }
}

/// Intersects one ray with one primitive.
///
/// # Safety
/// To be called by Embree, within `rtcIntersect1`, for a geometry whose user pointer is a live `UserGeometryData<G>`.
pub(super) unsafe extern "C" fn on_intersect<G: UserGeometry>(args: *const sys::RTCIntersectFunctionNArguments) {
    // SAFETY: as in `on_bounds`; with N = 1, `valid` is one integer and `rayhit` has the layout of `RTCRayHit`.
    unsafe {
        let args = &*args;
        // Scenes with user geometry are queried with single rays only.
        if args.N != 1 || *args.valid == 0 {
            return;
        }
        *args.valid = 0;
        let data = &*args.geometryUserPtr.cast_const().cast::<UserGeometryData<G>>();
        let packet = args.rayhit.cast::<f32>();
        let ray = read_ray(packet);
        let Some(hit) = data.catch_panic(None, |geometry| geometry.intersect(args.primID as usize, &ray)) else {
            return;
        };
        if !(ray.tnear <= hit.t && hit.t <= ray.tfar) {
            return;
        }
        packet.add(field::TFAR).write(hit.t);
        packet.add(field::NG).write(hit.ng.x);
        packet.add(field::NG + 1).write(hit.ng.y);
        packet.add(field::NG + 2).write(hit.ng.z);
        packet.add(field::U).write(hit.u);
        packet.add(field::V).write(hit.v);
        packet.add(field::PRIM).cast::<u32>().write(args.primID);
        packet.add(field::GEOM).cast::<u32>().write(args.geomID);
        let instance = if args.context.is_null() { ray::INVALID } else { (*args.context).instID[0] };
        packet.add(field::INST).cast::<u32>().write(instance);
        *args.valid = -1;
    }
}

/// Tests whether one primitive blocks one ray.
///
/// # Safety
/// To be called by Embree, within `rtcOccluded1`, for a geometry whose user pointer is a live `UserGeometryData<G>`.
pub(super) unsafe extern "C" fn on_occluded<G: UserGeometry>(args: *const sys::RTCOccludedFunctionNArguments) {
    // SAFETY: as in `on_intersect`; `ray` has the layout of `RTCRay`.
    unsafe {
        let args = &*args;
        if args.N != 1 || *args.valid == 0 {
            return;
        }
        *args.valid = 0;
        let data = &*args.geometryUserPtr.cast_const().cast::<UserGeometryData<G>>();
        let packet = args.ray.cast::<f32>();
        let ray = read_ray(packet);
        if data.catch_panic(false, |geometry| geometry.occluded(args.primID as usize, &ray)) {
            packet.add(field::TFAR).write(f32::NEG_INFINITY);
            *args.valid = -1;
        }
    }
}

/// The pointer Embree is given for a user geometry.
pub(super) fn user_pointer<G>(data: &Arc<UserGeometryData<G>>) -> *mut c_void {
    Arc::as_ptr(data).cast_mut().cast()
}
