//! Descriptions of motion: the shutter, keyframes of transforms, and steps of meshes that deform.
//!
//! Everything here is apart from the elements that move, in [`SceneDesc::motion`](super::SceneDesc::motion), so that a scene in
//! which nothing moves has nothing of it.

use std::collections::BTreeMap;
use std::sync::Arc;

use super::edit::none_such;
use super::json::join;
use super::{CameraDesc, FocusDesc, SceneDesc, validate};
use crate::math::{DAffine3, DMat3, DQuat, DVec3, KeyedPath, Pose, flattens_between, similarity_scale};
use crate::{Error, ErrorKind, Result};

/// Most keyframes of one motion, and most steps of a mesh.
pub const MAX_MOTION_KEYS: usize = 10_000;

/// Most numbers of a shutter's curve.
pub const MAX_SHUTTER_CURVE: usize = 1024;

/// Greatest difference between a camera's transform and one that keeps lengths.
const RIGID: f64 = 1e-6;

/// When the shutter is open, in seconds. Everything is seen at one moment where it closes as it opens.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ShutterDesc {
    /// When it opens.
    pub open: f64,
    /// When it closes, not before it opens.
    pub close: f64,
    /// How open it is, at moments evenly spaced from `open` to `close`, in any unit: numbers of 0 or more, between which it changes
    /// linearly. Empty: it is as open all the time.
    pub curve: Vec<f64>,
}

/// What moves in a scene, and the shutter through which it is seen. Numbers are indices of the lists of the description; the element
/// itself says where it is before it is moved.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SceneMotion {
    /// When the shutter is open.
    pub shutter: ShutterDesc,
    /// The motion of the camera, which keeps lengths.
    pub camera: Option<Arc<MotionDesc>>,
    /// Motions of surfaces.
    pub surfaces: BTreeMap<usize, Arc<MotionDesc>>,
    /// Motions of point lights.
    pub lights: BTreeMap<usize, Arc<MotionDesc>>,
    /// Steps of meshes that deform, in the order of their times.
    pub meshes: BTreeMap<usize, Arc<[MeshStep]>>,
}

/// A motion: what is done to a thing where it is without it, at some moments.
#[derive(Clone, Debug, PartialEq)]
pub struct MotionDesc {
    /// Keyframes in the order of their times, at least one. Before the first and after the last, nothing moves.
    pub keys: Vec<MotionKey>,
}

/// A keyframe.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MotionKey {
    /// Its time \[s\].
    pub time: f64,
    /// The transform at this time.
    pub place: KeyPlace,
}

/// The transform of a keyframe.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum KeyPlace {
    /// A scale along the axes, then a rotation, then a translation. Between two keys, translation and scale change linearly and the
    /// rotation goes the shorter way at constant speed.
    Parts {
        /// Translation.
        translation: DVec3,
        /// Rotation, a quaternion of any length but 0.
        rotation: DQuat,
        /// Factors, none of them 0.
        scale: DVec3,
    },
    /// An invertible transform, which is taken apart ([`Pose::of`]); between keys as above, with a stretch for the scale.
    Matrix(DAffine3),
}

/// The vertices of a mesh at one moment. Between two moments, vertices move along straight lines, and before the first and after the
/// last they rest.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct MeshStep {
    /// The time \[s\].
    pub time: f64,
    /// One position for each vertex of the mesh.
    pub positions: Vec<DVec3>,
    /// Empty, or one normal for each vertex, of any length. A zero vector means that the vertex has no normal.
    pub normals: Vec<[f32; 3]>,
}

impl KeyPlace {
    /// A key at which nothing is moved.
    pub const REST: Self = Self::Parts { translation: DVec3::ZERO, rotation: DQuat::IDENTITY, scale: DVec3::ONE };

    /// The parts of the transform.
    pub fn pose(&self) -> Pose {
        match *self {
            Self::Parts { translation, rotation, scale } => {
                Pose { translation, rotation: rotation.normalize(), stretch: DMat3::from_diagonal(scale) }
            }
            Self::Matrix(transform) => Pose::of(&transform),
        }
    }

    fn check(&self, path: &str) -> Result<()> {
        let at = |key: &str| join(path, key);
        match *self {
            Self::Parts { translation, rotation, scale } => {
                validate::vector(&at("translate"), translation)?;
                if !rotation.is_finite() || rotation.length() < 1e-6 || rotation.length() > 1e6 {
                    let message = format!("{:?} is no rotation, expected a unit quaternion", rotation.to_array());
                    return Err(Error::invalid(at("quaternion"), message));
                }
                validate::vector(&at("scale"), scale)?;
                if scale.cmpeq(DVec3::ZERO).any() {
                    let message = "a scale of 0 flattens the object, expected another number";
                    return Err(Error::invalid(at("scale"), message));
                }
                Ok(())
            }
            Self::Matrix(transform) => {
                validate::vector(&at("matrix"), transform.translation)?;
                validate::invertible(&at("matrix"), &transform)
            }
        }
    }
}

/// Checks the times of keys or steps.
fn check_times(path: &str, times: impl ExactSizeIterator<Item = f64>) -> Result<()> {
    let count = times.len();
    if !(1..=MAX_MOTION_KEYS).contains(&count) {
        return Err(Error::invalid(path, format!("{count} keys, expected 1 to {MAX_MOTION_KEYS}")));
    }
    let mut before = f64::NEG_INFINITY;
    for (i, time) in times.enumerate() {
        let at = format!("{path}[{i}].time");
        validate::number(&at, time)?;
        if time <= before {
            let message =
                format!("{time} is not later than the key before, which is at {before}; expected keys in order");
            return Err(Error::invalid(at, message));
        }
        before = time;
    }
    Ok(())
}

impl MotionDesc {
    /// The path through the keys; a single key is a transform that stays.
    pub fn path(&self) -> KeyedPath {
        let rest = || [(0.0, KeyPlace::REST.pose())];
        KeyedPath::new(self.keys.iter().map(|key| (key.time, key.place.pose())))
            .or_else(|| KeyedPath::new(rest()))
            .unwrap_or_else(|| unreachable!("a path of one key"))
    }

    /// Checks keys; `path` is that of their list.
    ///
    /// # Errors
    /// [`ErrorKind::InvalidScene`] for keys out of order, for numbers out of range, and for a thing that is flattened at a key or
    /// between two of them.
    pub(super) fn check(&self, path: &str) -> Result<()> {
        check_times(path, self.keys.iter().map(|key| key.time))?;
        for (i, key) in self.keys.iter().enumerate() {
            key.place.check(&format!("{path}[{i}]"))?;
        }
        let stretches: Vec<_> = self.keys.iter().map(|key| key.place.pose().stretch).collect();
        match stretches.windows(2).position(|pair| flattens_between(pair[0], pair[1])) {
            None => Ok(()),
            Some(i) => {
                let message = format!(
                    "the object is flattened between the keys {i} and {}: one mirrors it and the other does not",
                    i + 1
                );
                Err(Error::invalid(format!("{path}[{}]", i + 1), message))
            }
        }
    }

    /// [`Self::check`], for a camera: it may move and turn only.
    fn check_rigid(&self, path: &str) -> Result<()> {
        self.check(path)?;
        let rigid = |key: &MotionKey| {
            let transform = key.place.pose().transform();
            similarity_scale(&transform).is_some_and(|scale| (scale - 1.0).abs() < RIGID)
                && transform.matrix3.determinant() > 0.0
        };
        match self.keys.iter().position(|key| !rigid(key)) {
            None => Ok(()),
            Some(i) => {
                let message = "a camera is not stretched or mirrored, expected a key that moves and turns it only";
                Err(Error::invalid(format!("{path}[{i}]"), message))
            }
        }
    }
}

impl ShutterDesc {
    /// A shutter that shows one moment \[s\].
    pub fn at(time: f64) -> Self {
        Self { open: time, close: time, curve: Vec::new() }
    }

    /// The first and the last moment that it shows.
    pub fn interval(&self) -> [f64; 2] {
        [self.open, self.close]
    }

    /// Checks it.
    ///
    /// # Errors
    /// [`ErrorKind::InvalidScene`] for numbers out of range, and for one that closes before it opens.
    pub(super) fn check(&self, path: &str) -> Result<()> {
        let at = |key: &str| join(path, key);
        validate::number(&at("open"), self.open)?;
        validate::number(&at("close"), self.close)?;
        if self.close < self.open {
            let message = format!("{} is before the shutter opens, which is at {}", self.close, self.open);
            return Err(Error::invalid(at("close"), message));
        }
        if self.curve.len() == 1 || self.curve.len() > MAX_SHUTTER_CURVE {
            let message = format!("{} numbers, expected 2 to {MAX_SHUTTER_CURVE}", self.curve.len());
            return Err(Error::invalid(at("curve"), message));
        }
        for (i, open) in self.curve.iter().enumerate() {
            validate::intensity(&format!("{}[{i}]", at("curve")), *open)?;
        }
        if !self.curve.is_empty() && self.curve.iter().all(|open| *open == 0.0) {
            return Err(Error::invalid(at("curve"), "the shutter is never open, expected a number above 0"));
        }
        Ok(())
    }
}

impl SceneMotion {
    /// Whether nothing moves, whatever the shutter does.
    pub fn is_empty(&self) -> bool {
        self.camera.is_none() && self.surfaces.is_empty() && self.lights.is_empty() && self.meshes.is_empty()
    }

    /// Checks everything, for a description that is put together by hand.
    pub(crate) fn check(&self, scene: &SceneDesc) -> Result<()> {
        self.shutter.check("camera.shutter")?;
        if let Some(motion) = &self.camera {
            motion.check_rigid("camera.motion")?;
        }
        for (&number, motion) in &self.surfaces {
            let surface = scene.surfaces.get(number);
            let surface = surface.ok_or_else(|| none_such("motion", "surface", number, scene.surfaces.len()))?;
            motion.check(&join(&surface.path, "motion"))?;
        }
        for (&number, motion) in &self.lights {
            let light = scene.lights.get(number);
            let light = light.ok_or_else(|| none_such("motion", "point light", number, scene.lights.len()))?;
            motion.check(&join(&light.path, "motion"))?;
        }
        for (&number, steps) in &self.meshes {
            let mesh = scene.meshes.get(number);
            let mesh = mesh.ok_or_else(|| none_such("motion", "mesh", number, scene.meshes.len()))?;
            check_steps(&join(&mesh.path, "steps"), steps, mesh.vertex_count(), mesh.host.is_some())?;
        }
        Ok(())
    }
}

/// Checks the steps of a mesh of this many vertices.
fn check_steps(path: &str, steps: &[MeshStep], vertices: usize, is_hosted: bool) -> Result<()> {
    if is_hosted {
        let message = "a mesh in the memory of the host has no steps, expected one whose arrays are copied";
        return Err(Error::new(ErrorKind::Unsupported, message).at(path));
    }
    check_times(path, steps.iter().map(|step| step.time))?;
    for (i, step) in steps.iter().enumerate() {
        let at = |key: &str| format!("{path}[{i}].{key}");
        if step.positions.len() != vertices {
            let message = format!("{} positions for {vertices} vertices, expected one each", step.positions.len());
            return Err(Error::invalid(at("positions"), message));
        }
        for (k, position) in step.positions.iter().enumerate() {
            validate::vector(&format!("{}[{k}]", at("positions")), *position)?;
        }
        if !step.normals.is_empty() && step.normals.len() != vertices {
            let message = format!("{} normals for {vertices} vertices, expected one each", step.normals.len());
            return Err(Error::invalid(at("normals"), message));
        }
        if let Some((k, normal)) = step.normals.iter().enumerate().find(|(_, n)| !n.iter().all(|x| x.is_finite())) {
            let message = format!("{normal:?} is not finite, expected three numbers");
            return Err(Error::invalid(format!("{}[{k}]", at("normals")), message));
        }
        if step.normals.is_empty() != steps[0].normals.is_empty() {
            let message = "some steps have normals and others have none, expected normals in all of them or in none";
            return Err(Error::invalid(at("normals"), message));
        }
    }
    Ok(())
}

impl CameraDesc {
    /// The same camera after a transform that keeps lengths. Where it looks and is in focus goes along.
    #[must_use]
    pub fn moved(&self, transform: &DAffine3) -> Self {
        let mut camera = *self;
        let [origin, look_at, up] = camera.view_mut();
        *origin = transform.transform_point3(*origin);
        *look_at = transform.transform_point3(*look_at);
        *up = transform.transform_vector3(*up);
        if let Self::ThinLens { lens, .. } = &mut camera
            && let FocusDesc::Point(point) = &mut lens.focus
        {
            *point = transform.transform_point3(*point);
        }
        camera
    }
}

/// Calls that make things move.
impl SceneDesc {
    /// Sets when the shutter is open.
    ///
    /// # Errors
    /// [`ErrorKind::InvalidScene`] at `camera.shutter.open`, `.close` or `.curve`.
    pub fn set_shutter(&mut self, shutter: ShutterDesc) -> Result<()> {
        shutter.check("camera.shutter")?;
        self.motion.shutter = shutter;
        Ok(())
    }

    /// Sets the motion of the camera, or removes it. It keeps lengths.
    ///
    /// # Errors
    /// [`ErrorKind::InvalidScene`] at `camera.motion[..]` for keys out of order, numbers out of range, and a camera that is stretched.
    pub fn set_camera_motion(&mut self, motion: Option<MotionDesc>) -> Result<()> {
        if let Some(motion) = &motion {
            motion.check_rigid("camera.motion")?;
        }
        self.motion.camera = motion.map(Arc::new);
        Ok(())
    }

    /// Sets the motion of a surface, or removes it. It is done to the surface after its transform.
    ///
    /// # Errors
    /// [`ErrorKind::InvalidScene`] at `surfaces[..].motion[..]` for keys out of order, numbers out of range, and a surface that is
    /// flattened; and for a number that no surface has or that belongs to a removed surface.
    pub fn set_surface_motion(&mut self, surface: usize, motion: Option<MotionDesc>) -> Result<()> {
        let path = self.live_surface(surface)?.path.clone();
        if let Some(motion) = &motion {
            motion.check(&join(&path, "motion"))?;
        }
        put(&mut self.motion.surfaces, surface, motion.map(Arc::new));
        Ok(())
    }

    /// Sets the motion of a point light, or removes it. It moves the light and turns the direction in which it shines.
    ///
    /// # Errors
    /// [`ErrorKind::InvalidScene`] at `lights[..].motion[..]` for keys out of order and numbers out of range, and for a number that no
    /// point light has.
    pub fn set_light_motion(&mut self, light: usize, motion: Option<MotionDesc>) -> Result<()> {
        let count = self.lights.len();
        let Some(known) = self.lights.get(light) else {
            return Err(none_such(&format!("lights[{light}]"), "point light", light, count));
        };
        if let Some(motion) = &motion {
            motion.check(&join(&known.path, "motion"))?;
        }
        put(&mut self.motion.lights, light, motion.map(Arc::new));
        Ok(())
    }

    /// Sets the vertices of a mesh at some moments. No steps make it a mesh that does not deform.
    ///
    /// # Errors
    /// [`ErrorKind::InvalidScene`] at `meshes[..].steps[..]` for steps out of order, and for arrays of a wrong length or numbers out of
    /// range; [`ErrorKind::Unsupported`] for a mesh in the memory of the host; and for a number that no mesh has.
    pub fn set_mesh_steps(&mut self, mesh: usize, steps: Vec<MeshStep>) -> Result<()> {
        let path = format!("meshes[{mesh}]");
        let known = self.usable_mesh(&path, mesh)?;
        if !steps.is_empty() {
            check_steps(&join(&known.path, "steps"), &steps, known.vertex_count(), known.host.is_some())?;
        }
        put(&mut self.motion.meshes, mesh, (!steps.is_empty()).then(|| steps.into()));
        Ok(())
    }
}

fn put<T>(map: &mut BTreeMap<usize, T>, number: usize, value: Option<T>) {
    match value {
        Some(value) => map.insert(number, value),
        None => map.remove(&number),
    };
}
