//! The keys of motion in a scene file: the shutter, keyframes, and steps of meshes.

use serde::{Deserialize, Serialize};

use super::json::{Scale, join};
use super::transform::unless_zero;
use super::{KeyPlace, MeshStep, MotionDesc, MotionKey, ShutterDesc, numbers, transform, validate};
use crate::math::{DMat3, DQuat, DVec3, EulerRot};
use crate::{Error, Result};

/// When the shutter is open.
#[derive(Deserialize, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub(super) struct Shutter {
    /// When it opens, seconds. Default 0.
    open: Option<f64>,
    /// When it closes, seconds, not before `open`. Where it is `open`, everything is seen at that moment. Default: `open`.
    close: Option<f64>,
    /// How open it is: `box` (default, all the time), `trapezoid` (it opens and closes within a quarter of the time each), or two or
    /// more numbers at moments evenly spaced from `open` to `close`, between which it changes linearly.
    curve: Option<Curve>,
}

/// How open the shutter is.
#[derive(Deserialize, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(untagged, expecting = "no curve of a shutter, expected box, trapezoid or an array of numbers")]
enum Curve {
    /// By its name.
    Named(CurveName),
    /// At moments evenly spaced.
    Numbers(Vec<f64>),
}

#[derive(Clone, Copy, Deserialize, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
enum CurveName {
    /// As open all the time.
    Box,
    /// A quarter to open and a quarter to close.
    Trapezoid,
}

/// A keyframe: `matrix`, or any of `scale`, a rotation and `translate`, applied in this order after the thing's own placement. The
/// rotation is one of `rotate`, `quaternion`, and `axis` with `angle`.
#[derive(Default, Deserialize, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub(super) struct Key {
    /// Its time, seconds, later than that of the key before.
    time: f64,
    /// Translation, scene units.
    translate: Option<[f64; 3]>,
    /// Rotation about the x, then the y, then the z axis, degrees, right-handed.
    rotate: Option<[f64; 3]>,
    /// Rotation as a quaternion: x, y, z and w.
    quaternion: Option<[f64; 4]>,
    /// Axis of the rotation by `angle`, of any length.
    axis: Option<[f64; 3]>,
    /// Degrees of the rotation about `axis`, right-handed.
    angle: Option<f64>,
    /// One factor, or one per axis.
    scale: Option<Scale>,
    /// 4 x 4 matrix in row-major order, acting on column vectors; its last row is [0, 0, 0, 1].
    matrix: Option<[f64; 16]>,
}

/// The vertices of a mesh at one moment.
#[derive(Deserialize, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub(super) struct Step {
    /// The time, seconds, later than that of the step before.
    time: f64,
    /// One position for each vertex of the mesh.
    positions: Vec<[f64; 3]>,
    /// One normal for each vertex, in all steps or in none.
    normals: Option<Vec<[f64; 3]>>,
}

/// Reads a shutter. It is checked by the call that sets it.
pub(super) fn shutter(keys: Option<Shutter>) -> ShutterDesc {
    let Some(Shutter { open, close, curve }) = keys else { return ShutterDesc::default() };
    let open = open.unwrap_or(0.0);
    let curve = match curve {
        None | Some(Curve::Named(CurveName::Box)) => Vec::new(),
        Some(Curve::Named(CurveName::Trapezoid)) => vec![0.0, 1.0, 1.0, 1.0, 0.0],
        // An empty array is no curve: one number stands for it in the check.
        Some(Curve::Numbers(numbers)) if numbers.is_empty() => vec![0.0],
        Some(Curve::Numbers(numbers)) => numbers,
    };
    ShutterDesc { open, close: close.unwrap_or(open), curve }
}

/// Writes a shutter; `None` for the default.
pub(super) fn write_shutter(shutter: &ShutterDesc) -> Option<Shutter> {
    if *shutter == ShutterDesc::default() {
        return None;
    }
    let curve = (!shutter.curve.is_empty()).then(|| Curve::Numbers(shutter.curve.clone()));
    Some(Shutter { open: Some(shutter.open), close: Some(shutter.close), curve })
}

/// Reads keyframes; `path` is that of their list. What they have in common is checked by the call that sets them.
pub(super) fn motion(keys: Vec<Key>, path: &str) -> Result<MotionDesc> {
    check_turns(&keys, path)?;
    let key = |(i, key): (usize, Key)| {
        let path = format!("{path}[{i}]");
        Ok(MotionKey { time: key.time, place: place(&key, &path)? })
    };
    Ok(MotionDesc { keys: keys.into_iter().enumerate().map(key).collect::<Result<_>>()? })
}

/// Refuses a turn by half a circle or more between two keys that have the same axis: it would go the other way.
fn check_turns(keys: &[Key], path: &str) -> Result<()> {
    for (i, pair) in keys.windows(2).enumerate() {
        if let ([Some(axis), Some(to)], [Some(from), Some(by)]) =
            ([pair[0].axis, pair[1].axis], [pair[0].angle, pair[1].angle])
            && axis == to
            && (by - from).abs() >= 180.0
        {
            let message = format!(
                "{by} degrees after {from} are half a turn or more, and rotations go the shorter way; expected keys less than \
                 180 degrees apart"
            );
            return Err(Error::invalid(format!("{path}[{}].angle", i + 1), message));
        }
    }
    Ok(())
}

fn place(key: &Key, path: &str) -> Result<KeyPlace> {
    let at = |name: &str| join(path, name);
    let rotations = [
        ("rotate", key.rotate.is_some()),
        ("quaternion", key.quaternion.is_some()),
        ("axis", key.axis.is_some() || key.angle.is_some()),
    ];
    let mut given = rotations.into_iter().filter(|(_, given)| *given).map(|(name, _)| name);
    let (first, second) = (given.next(), given.next());
    if let Some(matrix) = key.matrix {
        let others = [("translate", key.translate.is_some()), ("scale", key.scale.is_some())];
        if let Some(other) = others.into_iter().find(|(_, given)| *given).map(|(name, _)| name).or(first) {
            return Err(Error::invalid(at(other), "`matrix` stands alone, expected a key without this"));
        }
        return Ok(KeyPlace::Matrix(transform::matrix(matrix, &at("matrix"))?));
    }
    if let (Some(first), Some(second)) = (first, second) {
        return Err(Error::invalid(at(second), format!("the rotation is given by `{first}` already")));
    }
    let rotation = match (key.rotate, key.quaternion, key.axis, key.angle) {
        (Some(degrees), ..) => {
            let DVec3 { x, y, z } = validate::vector(&at("rotate"), degrees)? * (std::f64::consts::PI / 180.0);
            DQuat::from_euler(EulerRot::ZYX, z, y, x)
        }
        // It is made a unit quaternion where the key is used, so that the same numbers can be written again.
        (_, Some(quaternion), ..) => DQuat::from_array(quaternion),
        (.., Some(axis), Some(angle)) => {
            let axis = validate::direction(&at("axis"), axis)?;
            DQuat::from_axis_angle(axis, validate::number(&at("angle"), angle)?.to_radians())
        }
        (.., Some(_), None) => return Err(Error::invalid(path, "missing key `angle`, by which `axis` turns")),
        (.., None, Some(_)) => return Err(Error::invalid(path, "missing key `axis`, about which `angle` turns")),
        _ => DQuat::IDENTITY,
    };
    let translation = validate::vector(&at("translate"), key.translate.unwrap_or_default())?;
    let scale = transform::factors(&at("scale"), key.scale)?;
    Ok(KeyPlace::Parts { translation, rotation, scale })
}

/// Writes keyframes that have been checked.
pub(super) fn write_motion(motion: &MotionDesc) -> Vec<Key> {
    let key = |key: &MotionKey| match key.place {
        KeyPlace::Parts { translation, rotation, scale } => Key {
            time: key.time,
            translate: unless_zero(translation),
            quaternion: (rotation != DQuat::IDENTITY).then(|| rotation.to_array()),
            scale: if scale == DVec3::splat(scale.x) {
                numbers::unless(scale.x, 1.0).map(Scale::Uniform)
            } else {
                Some(Scale::PerAxis(scale.to_array()))
            },
            ..Key::default()
        },
        KeyPlace::Matrix(it) => {
            let DMat3 { x_axis, y_axis, z_axis } = it.matrix3;
            let row = |i: usize| [x_axis[i], y_axis[i], z_axis[i], it.translation[i]];
            let [[a, b, c, d], [e, f, g, h], [i, j, k, l]] = [0, 1, 2].map(row);
            let matrix = Some([a, b, c, d, e, f, g, h, i, j, k, l, 0.0, 0.0, 0.0, 1.0]);
            Key { time: key.time, matrix, ..Key::default() }
        }
    };
    motion.keys.iter().map(key).collect()
}

/// Reads the steps of a mesh; `path` is that of their list. They are checked by the call that sets them.
pub(super) fn steps(steps: Vec<Step>, path: &str) -> Result<Vec<MeshStep>> {
    let step = |(i, step): (usize, Step)| {
        let normals = step.normals.unwrap_or_default();
        let at = format!("{path}[{i}]");
        normals.iter().enumerate().try_for_each(|(k, it)| validate::numbers(&at, "normals", k, *it))?;
        Ok(MeshStep {
            time: step.time,
            positions: step.positions.into_iter().map(DVec3::from_array).collect(),
            normals: normals.into_iter().map(|it| it.map(|x| x as f32)).collect(),
        })
    };
    steps.into_iter().enumerate().map(step).collect()
}

/// Writes the steps of a mesh that have been checked.
pub(super) fn write_steps(steps: &[MeshStep]) -> Vec<Step> {
    let step = |step: &MeshStep| Step {
        time: step.time,
        positions: step.positions.iter().map(DVec3::to_array).collect(),
        normals: (!step.normals.is_empty())
            .then(|| step.normals.iter().map(|normal| normal.map(numbers::single)).collect()),
    };
    steps.iter().map(step).collect()
}
