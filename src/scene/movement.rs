//! What moves in a scene while the shutter is open: a description is posed as the shutter opens, and everything that rests until it
//! closes no longer moves.

use std::borrow::Cow;
use std::sync::Arc;

use super::Scene;
use crate::camera::MovingCamera;
use crate::desc::{CameraDesc, LightDistribution, MeshDesc, MeshStep, PointLightDesc, SceneDesc};
use crate::error::Result;
use crate::math::{DVec3, KeyedPath, Vec3};
use crate::sampling::PiecewiseLinear;

/// The shutter of a scene in which something moves, and the motion of the camera.
#[derive(Debug)]
pub(super) struct Movement {
    /// How likely the moments are; `None` where all are as likely.
    density: Option<PiecewiseLinear>,
    /// When the shutter opens and closes \[s\].
    interval: [f64; 2],
    /// The camera before it is moved, and its path, where it moves.
    camera: Option<(CameraDesc, KeyedPath)>,
}

impl Movement {
    /// The movement of a description that is posed. `base` is its camera before it is moved; `None` where nothing moves.
    pub(super) fn new(desc: &SceneDesc, base: CameraDesc) -> Option<Arc<Self>> {
        if desc.motion.is_empty() {
            return None;
        }
        let shutter = &desc.motion.shutter;
        Some(Arc::new(Self {
            density: PiecewiseLinear::new(&shutter.curve),
            interval: shutter.interval(),
            camera: desc.motion.camera.as_ref().map(|motion| (base, motion.path())),
        }))
    }
}

impl Scene {
    /// The moment ([`crate::math::Ray::time`]) at which a sample sees the scene, for `u` uniform in [0, 1): moments are as likely as
    /// the shutter is open.
    #[inline]
    pub(crate) fn moment(&self, u: f32) -> f32 {
        match self.movement.as_ref().and_then(|movement| movement.density.as_ref()) {
            None => u,
            Some(density) => density.sample(u),
        }
    }

    /// The camera of this scene for a film of this resolution, where it moves.
    ///
    /// # Errors
    /// Those of [`crate::camera::Camera::new`], at any moment.
    pub fn moving_camera(&self, resolution: [u32; 2]) -> Result<Option<MovingCamera>> {
        let Some(movement) = &self.movement else { return Ok(None) };
        let Some((base, path)) = &movement.camera else { return Ok(None) };
        MovingCamera::new(*base, path.clone(), movement.interval, resolution, self.centre).map(Some)
    }

    /// Whether the camera moves while the shutter is open.
    pub fn has_moving_camera(&self) -> bool {
        self.movement.as_ref().is_some_and(|movement| movement.camera.is_some())
    }
}

/// Returns the description as the shutter opens: what rests until it closes is put where it is then, and only what moves meanwhile
/// keeps its motion. A description in which nothing moves is returned as it is. The camera is where it is as the shutter opens.
pub(super) fn posed(desc: &SceneDesc) -> Result<Cow<'_, SceneDesc>> {
    if desc.motion.is_empty() {
        return Ok(Cow::Borrowed(desc));
    }
    desc.motion.check(desc)?;
    let mut posed = desc.clone();
    let interval = desc.motion.shutter.interval();
    let [open, _] = interval;
    if let Some(motion) = &desc.motion.camera {
        let path = motion.path();
        posed.camera = desc.camera.moved(&path.at(open));
        if path.rests_in(interval) {
            posed.motion.camera = None;
        }
    }
    for (&number, motion) in &desc.motion.surfaces {
        let path = motion.path();
        if desc.surfaces[number].hidden || path.rests_in(interval) {
            let surface = &mut posed.surfaces[number];
            surface.transform = path.at(open) * surface.transform;
            posed.motion.surfaces.remove(&number);
        }
    }
    pose_placements(desc, &mut posed, interval);
    for (&number, motion) in &desc.motion.lights {
        let path = motion.path();
        if path.rests_in(interval) {
            posed.lights[number] = moved_light(&posed.lights[number], &path, open);
            posed.motion.lights.remove(&number);
        }
    }
    for (&number, steps) in &desc.motion.meshes {
        if rests(steps, interval) {
            posed.meshes[number] = Arc::new(mesh_at(&desc.meshes[number], steps, open));
            posed.motion.meshes.remove(&number);
        }
    }
    Ok(Cow::Owned(posed))
}

/// Poses placements whose surfaces have one motion, which rests in the interval, as wholes.
fn pose_placements(desc: &SceneDesc, posed: &mut SceneDesc, interval: [f64; 2]) {
    for (number, placement) in desc.placements.iter().enumerate().filter(|(_, it)| !it.hidden) {
        let motion = |surface: usize| desc.motion.surfaces.get(&surface);
        let Some(first) = placement.surfaces.clone().next().and_then(motion) else { continue };
        let Some(group) = desc.groups.get(placement.group) else { continue };
        let path = first.path();
        let is_one = placement.surfaces.clone().all(|surface| motion(surface) == Some(first));
        if !is_one || !path.rests_in(interval) || placement.surfaces.end > posed.surfaces.len() {
            continue;
        }
        let transform = path.at(interval[0]) * placement.transform;
        posed.placements[number].transform = transform;
        for (surface, member) in placement.surfaces.clone().zip(&group.members) {
            if desc.surfaces[surface].transform == placement.transform * member.transform {
                posed.surfaces[surface].transform = transform * member.transform;
            }
        }
    }
}

/// A point light where its path has it at a time \[s\].
fn moved_light(light: &PointLightDesc, path: &KeyedPath, time: f64) -> PointLightDesc {
    let pose = path.pose(time);
    let mut moved = PointLightDesc { position: pose.transform().transform_point3(light.position), ..light.clone() };
    match &mut moved.distribution {
        LightDistribution::Even => {}
        LightDistribution::Spot(spot) => spot.direction = pose.rotation * spot.direction,
        LightDistribution::Web(web) => {
            web.direction = pose.rotation * web.direction;
            web.c0 = pose.rotation * web.c0;
        }
    }
    moved
}

/// The two steps of a mesh around a time \[s\], and the weight of the second.
fn steps_around(steps: &[MeshStep], time: f64) -> ([&MeshStep; 2], f64) {
    let after = steps.partition_point(|step| step.time <= time);
    match (after.checked_sub(1).map(|before| &steps[before]), steps.get(after)) {
        (Some(from), Some(to)) => ([from, to], (time - from.time) / (to.time - from.time)),
        (Some(one), None) => ([one, one], 0.0),
        (None, _) => ([&steps[0], &steps[0]], 0.0),
    }
}

/// Where a vertex of a mesh is at a time \[s\].
pub(super) fn vertex_at(steps: &[MeshStep], vertex: usize, time: f64) -> DVec3 {
    let ([from, to], share) = steps_around(steps, time);
    from.positions[vertex].lerp(to.positions[vertex], share)
}

/// The times of the steps within an interval.
pub(super) fn step_times(steps: &[MeshStep], [open, close]: [f64; 2]) -> impl Iterator<Item = f64> + Clone {
    steps.iter().map(|step| step.time).filter(move |time| open < *time && *time < close)
}

fn rests(steps: &[MeshStep], interval: [f64; 2]) -> bool {
    let [open, close] = interval;
    let same = |time: f64| {
        let ([from, to], share) = steps_around(steps, time);
        share == 0.0 || (&from.positions, &from.normals) == (&to.positions, &to.normals)
    };
    let (first, last) = (steps_around(steps, open).0[0], steps_around(steps, close).0[0]);
    open == close
        || same(open) && same(close) && {
            let between = steps.iter().filter(|step| open < step.time && step.time <= close);
            between.chain([last]).all(|step| (&step.positions, &step.normals) == (&first.positions, &first.normals))
        }
}

/// A mesh with the vertices that its steps have at a time \[s\].
pub(super) fn mesh_at(mesh: &MeshDesc, steps: &[MeshStep], time: f64) -> MeshDesc {
    let ([from, to], share) = steps_around(steps, time);
    let positions = from.positions.iter().zip(&to.positions).map(|(a, b)| a.lerp(*b, share)).collect();
    let unit = |normal: &[f32; 3]| Vec3::from(*normal).normalize_or_zero();
    let normals = from
        .normals
        .iter()
        .zip(&to.normals)
        .map(|(a, b)| if share == 0.0 { *a } else { unit(a).lerp(unit(b), share as f32).to_array() })
        .collect();
    MeshDesc { positions, normals, ..mesh.clone() }
}
