//! Scenes under construction.

use std::ffi::c_void;
use std::sync::Arc;

use super::commit::commit;
use super::device::Device;
use super::mesh::{MAX_COORDINATE, TriangleMesh, check_time_steps, in_range};
use super::scene::{Features, GeometryData, Scene, SceneInner};
use super::user::{self, UserGeometry, UserGeometryData};
use super::width::PacketWidth;
use super::{ray, sys};
use crate::math::{Bounds, DAffine3, flattens_between};
use crate::{Cancel, Error, ErrorKind, Result};

/// Effort that is spent on the hierarchy.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum BuildQuality {
    /// Fastest to build, slowest to trace: for scenes that change often.
    Low,
    /// Binned surface area heuristic.
    #[default]
    Medium,
    /// Spatial splits too: slowest to build, most memory, fastest to trace where triangles are long or overlap.
    High,
}

/// How a scene is built and traced.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SceneOptions {
    /// Rays cannot pass between triangles that share an edge, and box tests never lose a hit. A little slower.
    ///
    /// What remains are points: of rays aimed exactly at the vertices of a fine mesh about 1 in 100 passes through
    /// (measured on a sphere of 100 by 200), and none a millionth beside them. Random rays do not find these points.
    pub robust: bool,
    /// Effort that is spent on the hierarchy.
    pub quality: BuildQuality,
    /// Less memory, a little slower.
    pub compact: bool,
}

impl Default for SceneOptions {
    fn default() -> Self {
        Self { robust: true, quality: BuildQuality::Medium, compact: false }
    }
}

/// Identifier of a geometry in a scene; counts from 0 in the order of adding.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct GeometryId(
    /// The same value as in [`super::Hit::geom`], or in [`super::Hit::inst`] for an instance.
    pub u32,
);

/// A scene to which geometry is added; it cannot be queried yet.
pub struct SceneBuilder {
    inner: SceneInner,
    cancel: Cancel,
}

/// A reference to an Embree geometry, released when dropped.
struct Geometry(sys::RTCGeometry);

impl Drop for Geometry {
    fn drop(&mut self) {
        if !self.0.is_null() {
            // SAFETY: `rtcNewGeometry` gave this reference, and it is given back once.
            unsafe { sys::rtcReleaseGeometry(self.0) }
        }
    }
}

impl SceneBuilder {
    /// An empty scene.
    ///
    /// # Errors
    /// [`ErrorKind::Device`] or [`ErrorKind::OutOfMemory`].
    pub fn new(device: &Device, options: SceneOptions) -> Result<Self> {
        Self::cancellable(device, options, &Cancel::new())
    }

    /// An empty scene whose builder stops with [`ErrorKind::Cancelled`] once `cancel` was cancelled: while it builds,
    /// and while it waits for another build on the same device.
    ///
    /// # Errors
    /// [`ErrorKind::Device`], [`ErrorKind::OutOfMemory`] or [`ErrorKind::Cancelled`].
    pub fn cancellable(device: &Device, options: SceneOptions, cancel: &Cancel) -> Result<Self> {
        let mut flags = sys::RTC_SCENE_FLAG_NONE;
        if options.robust {
            flags |= sys::RTC_SCENE_FLAG_ROBUST;
        }
        if options.compact {
            flags |= sys::RTC_SCENE_FLAG_COMPACT;
        }
        let quality = match options.quality {
            BuildQuality::Low => sys::RTC_BUILD_QUALITY_LOW,
            BuildQuality::Medium => sys::RTC_BUILD_QUALITY_MEDIUM,
            BuildQuality::High => sys::RTC_BUILD_QUALITY_HIGH,
        };
        let raw = device.inner.guarded(cancel, || {
            // SAFETY: the device is alive, the scene new; both settings are of the enumerations asked for.
            unsafe {
                let raw = sys::rtcNewScene(device.inner.raw);
                if !raw.is_null() {
                    sys::rtcSetSceneFlags(raw, flags);
                    sys::rtcSetSceneBuildQuality(raw, quality);
                }
                raw
            }
        })?;
        if raw.is_null() {
            return Err(Error::new(ErrorKind::Device, "Embree gave no scene"));
        }
        let inner = SceneInner {
            raw,
            data: Vec::new(),
            features: Features::default(),
            mask: sys::RTC_FEATURE_FLAG_NONE,
            width: PacketWidth::One,
            bvh_bytes: 0,
            device: Arc::clone(&device.inner),
        };
        Ok(Self { inner, cancel: cancel.clone() })
    }

    /// Adds a triangle mesh. Clones of one mesh share memory between scenes.
    ///
    /// # Errors
    /// [`ErrorKind::Device`] or [`ErrorKind::OutOfMemory`].
    pub fn add_triangles(&mut self, mesh: TriangleMesh) -> Result<GeometryId> {
        let (indices, index_stride, index_count) =
            (mesh.indices().as_ptr(), mesh.indices().stride(), mesh.indices().len());
        let time_steps = mesh.time_steps();
        // A copy of the handles of the buffers, which `data` takes.
        let owner = mesh.clone();
        let fill = |geometry| {
            // SAFETY: all buffers hold as many items as said, of the format and at the distance said; they are
            // immutable and stay where they are for as long as their owners, behind an `Arc` each that `data` holds
            // until after the scene is released. Indices are below the vertex count, which is the same at all time
            // steps (`TriangleMesh`), and 16 bytes can be read from the last vertex (`VertexBuffer`). There are at most
            // `MAX_TIME_STEPS` time steps.
            unsafe {
                sys::rtcSetGeometryTimeStepCount(geometry, time_steps as u32);
                for step in 0..time_steps {
                    let vertices = owner.vertices_at_step(step);
                    sys::rtcSetSharedGeometryBuffer(
                        geometry,
                        sys::RTC_BUFFER_TYPE_VERTEX,
                        step as u32,
                        sys::RTC_FORMAT_FLOAT3,
                        vertices.as_ptr().cast(),
                        0,
                        vertices.stride(),
                        vertices.len(),
                    );
                }
                sys::rtcSetSharedGeometryBuffer(
                    geometry,
                    sys::RTC_BUFFER_TYPE_INDEX,
                    0,
                    sys::RTC_FORMAT_UINT3,
                    indices.cast(),
                    0,
                    index_stride,
                    index_count,
                );
            }
        };
        let features = Features { triangles: true, motion: time_steps > 1, ..Features::default() };
        self.attach(sys::RTC_GEOMETRY_TYPE_TRIANGLE, features, GeometryData::Triangles(mesh), fill)
    }

    /// Adds Embree's own spheres, each as x, y, z and radius. Embree intersects them in single precision.
    ///
    /// # Errors
    /// [`ErrorKind::InvalidScene`] for no sphere, or one that is not finite, reaches past [`MAX_COORDINATE`], or whose
    /// radius is not positive; [`ErrorKind::Device`] or [`ErrorKind::OutOfMemory`].
    pub fn add_spheres(&mut self, spheres: Vec<[f32; 4]>) -> Result<GeometryId> {
        let is_valid = |s: &[f32; 4]| s[3] > 0.0 && s[..3].iter().all(|&x| in_range(x.abs() + s[3]));
        if let Some((index, sphere)) = spheres.iter().enumerate().find(|(_, s)| !is_valid(s)) {
            let message =
                format!("sphere {index} is {sphere:?}: needs a positive radius and to lie below {MAX_COORDINATE:e}");
            return Err(Error::new(ErrorKind::InvalidScene, message));
        }
        if spheres.is_empty() || u32::try_from(spheres.len()).is_err() {
            let message = format!("{} spheres: needs 1 to 2^32 - 1", spheres.len());
            return Err(Error::new(ErrorKind::InvalidScene, message));
        }
        let (data, count) = (spheres.as_ptr(), spheres.len());
        let fill = |geometry| {
            // SAFETY: the buffer holds `count` items of four floats (the last is readable as 16 bytes), is never
            // changed, and stays where it is on the heap: moving the vector into `data` does not move it.
            unsafe {
                sys::rtcSetSharedGeometryBuffer(
                    geometry,
                    sys::RTC_BUFFER_TYPE_VERTEX,
                    0,
                    sys::RTC_FORMAT_FLOAT4,
                    data.cast(),
                    0,
                    size_of::<[f32; 4]>(),
                    count,
                );
            }
        };
        let features = Features { spheres: true, ..Features::default() };
        self.attach(sys::RTC_GEOMETRY_TYPE_SPHERE_POINT, features, GeometryData::Spheres(spheres), fill)
    }

    /// Adds primitives with an intersection test of their own.
    ///
    /// # Errors
    /// [`ErrorKind::InvalidScene`] for no primitive or a box that is not finite and ordered; [`ErrorKind::Device`] or
    /// [`ErrorKind::OutOfMemory`].
    pub fn add_user<G: UserGeometry>(&mut self, geometry: Arc<G>) -> Result<GeometryId> {
        let data = Arc::new(UserGeometryData::new(geometry, &self.cancel)?);
        let pointer = user::user_pointer(&data);
        let data: Arc<dyn user::ErasedUserData> = data;
        let (count, time_steps) = (data.len(), data.time_steps());
        let fill = |geometry| {
            // SAFETY: `pointer` is the `UserGeometryData<G>` that `data` holds until after the scene is released, and
            // the three functions are those for the same `G`. `count` fits in 32 bits, and there are no more time steps
            // than Embree takes (`UserGeometryData::new`).
            unsafe {
                sys::rtcSetGeometryTimeStepCount(geometry, time_steps as u32);
                sys::rtcSetGeometryUserPrimitiveCount(geometry, count as u32);
                sys::rtcSetGeometryUserData(geometry, pointer);
                sys::rtcSetGeometryBoundsFunction(geometry, Some(user::on_bounds::<G>), std::ptr::null_mut());
                sys::rtcSetGeometryIntersectFunction(geometry, Some(user::on_intersect::<G>));
                sys::rtcSetGeometryOccludedFunction(geometry, Some(user::on_occluded::<G>));
            }
        };
        let features = Features { user: true, motion: time_steps > 1, ..Features::default() };
        self.attach(sys::RTC_GEOMETRY_TYPE_USER, features, GeometryData::User(data), fill)
    }

    /// Adds another scene, moved by `transform` (its frame to this scene's), which is rounded to single precision.
    ///
    /// # Errors
    /// [`ErrorKind::InvalidScene`] if the transform is not finite or cannot be inverted in single precision, or moves
    /// the scene past [`MAX_COORDINATE`]; [`ErrorKind::Unsupported`] if `scene` has instances itself or belongs to
    /// another device; [`ErrorKind::Device`] or [`ErrorKind::OutOfMemory`].
    pub fn add_instance(&mut self, scene: &Scene, transform: &DAffine3) -> Result<GeometryId> {
        self.add_moving_instance(scene, std::slice::from_ref(transform))
    }

    /// Adds another scene, moved by a transform that changes during the shutter interval. `steps` are the transforms at
    /// moments evenly spaced from time 0 to time 1; between two of them, the elements of the matrix change linearly, so
    /// that every point moves along a straight line at constant speed. One step is an instance at rest. A rotation
    /// therefore needs steps so close that the chord serves for the arc.
    ///
    /// # Errors
    /// As for [`SceneBuilder::add_instance`], at each step and in between; [`ErrorKind::InvalidScene`] for no step or
    /// more than [`super::MAX_TIME_STEPS`].
    pub fn add_moving_instance(&mut self, scene: &Scene, steps: &[DAffine3]) -> Result<GeometryId> {
        check_time_steps(steps.len())?;
        if scene.features().instances {
            return Err(Error::new(ErrorKind::Unsupported, "an instance of a scene that has instances itself"));
        }
        if !Arc::ptr_eq(&scene.inner.device, &self.inner.device) {
            return Err(Error::new(
                ErrorKind::Unsupported,
                "an instance of a scene that was built with another device",
            ));
        }
        let bounds = scene.bounds();
        let columns =
            steps.iter().map(|transform| instance_columns(&bounds, transform)).collect::<Result<Vec<[f32; 12]>>>()?;
        for (step, pair) in columns.windows(2).enumerate() {
            let [from, to] = [pair[0], pair[1]].map(|columns| DAffine3::from_cols_array(&columns.map(f64::from)));
            if flattens_between(from.matrix3, to.matrix3) {
                let message = format!(
                    "the instance collapses between time steps {step} and {}: more steps are needed where it turns",
                    step + 1
                );
                return Err(Error::new(ErrorKind::InvalidScene, message));
            }
        }
        let instanced = scene.inner.raw;
        let fill = |geometry| {
            // SAFETY: the instanced scene is committed, of the same device, and kept alive by `data`; the format is
            // that of twelve floats, column by column, which are read during the call. There are at most
            // `MAX_TIME_STEPS` steps.
            unsafe {
                sys::rtcSetGeometryInstancedScene(geometry, instanced);
                sys::rtcSetGeometryTimeStepCount(geometry, columns.len() as u32);
                for (step, columns) in columns.iter().enumerate() {
                    let data = columns.as_ptr().cast::<c_void>();
                    sys::rtcSetGeometryTransform(geometry, step as u32, sys::RTC_FORMAT_FLOAT3X4_COLUMN_MAJOR, data);
                }
            }
        };
        let moves = steps.len() > 1;
        let features = Features { instances: true, motion: moves | scene.features().motion, ..scene.features() };
        self.attach(sys::RTC_GEOMETRY_TYPE_INSTANCE, features, GeometryData::Instance(scene.clone()), fill)
    }

    /// Creates a geometry, sets its data by `fill`, and attaches it. `data` owns the memory to which the geometry
    /// points.
    fn attach(
        &mut self,
        kind: sys::RTCGeometryType,
        features: Features,
        data: GeometryData,
        fill: impl FnOnce(sys::RTCGeometry),
    ) -> Result<GeometryId> {
        let device = &self.inner.device;
        // SAFETY: the device is alive.
        let geometry = Geometry(device.guarded(&self.cancel, || unsafe { sys::rtcNewGeometry(device.raw, kind) })?);
        device.guarded(&self.cancel, || {
            fill(geometry.0);
            // SAFETY: the geometry is alive and no other thread has it.
            unsafe { sys::rtcCommitGeometry(geometry.0) }
        })?;
        // From here on the scene may refer to the data, so the data is stored whatever happens next.
        self.inner.data.push(data);
        self.inner.features = self.inner.features.union(features);
        // The number by which `data` has it.
        let id = u32::try_from(self.inner.data.len() - 1).ok().filter(|id| *id != ray::INVALID);
        let id = id.ok_or_else(|| Error::new(ErrorKind::Device, "Embree has no room for another geometry"))?;
        // SAFETY: scene and geometry are of the same device, `self` alone has the scene, and no geometry has this number.
        device.guarded(&self.cancel, || unsafe { sys::rtcAttachGeometryByID(self.inner.raw, geometry.0, id) })?;
        Ok(GeometryId(id))
    }

    /// Leaves out the next `count` numbers of geometries.
    pub(crate) fn skip(&mut self, count: usize) {
        self.inner.data.extend(std::iter::repeat_with(|| GeometryData::None).take(count));
    }

    /// Builds the hierarchy.
    ///
    /// `progress` receives the finished fraction, which never falls and ends with 1, and returns whether to continue.
    /// It is called from the threads that build, by one at a time, and must not use the device.
    ///
    /// # Errors
    /// [`ErrorKind::Cancelled`] if `progress` returned false, [`ErrorKind::OutOfMemory`], [`ErrorKind::Device`], and
    /// [`ErrorKind::Internal`] if `progress` panicked. A large build that is cancelled may continue for a moment on a
    /// thread of its own, since Embree does not check for cancellation at its beginning; see
    /// [`super::Device::wait_idle`].
    pub fn commit(self, progress: Option<&(dyn Fn(f64) -> bool + Sync)>) -> Result<Scene> {
        commit(self.inner, &self.cancel, progress)
    }
}

/// The transform of an instance as Embree takes it, column by column, checked for a scene with these bounds.
fn instance_columns(bounds: &Bounds, transform: &DAffine3) -> Result<[f32; 12]> {
    let columns = transform.to_cols_array().map(|x| x as f32);
    let rounded = DAffine3::from_cols_array(&columns.map(f64::from));
    let inverse = rounded.inverse().to_cols_array().map(|x| x as f32);
    // Embree inverts with products of two elements over the determinant, all in single precision.
    let determinant = rounded.matrix3.determinant() as f32;
    let invertible = determinant.is_normal() && inverse.iter().all(|x| x.is_finite());
    if !columns.iter().all(|&x| in_range(x)) || !invertible {
        let message = format!("the transform {columns:?} (columns) cannot be inverted in single precision");
        return Err(Error::new(ErrorKind::InvalidScene, message));
    }
    let bounds = bounds.transformed(&rounded);
    let within = |x: f64| in_range(x as f32);
    if !bounds.is_empty() && !bounds.corners().iter().all(|p| p.to_array().into_iter().all(within)) {
        let message = format!("the instance reaches from {} to {}, past {MAX_COORDINATE:e}", bounds.min, bounds.max);
        return Err(Error::new(ErrorKind::InvalidScene, message));
    }
    Ok(columns)
}
