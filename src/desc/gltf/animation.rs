//! The pose of a document at a time: what an animation makes of the placement of nodes and of the weights of morph targets.

use std::collections::HashMap;

use super::super::json::elided;
use super::accessor::{Accessors, Allowed};
use super::document::{AnimationSampler, Document, called, element, missing};
use crate::math::{DQuat, DVec3};
use crate::{Error, Result};

/// What an animation changes of a node.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Placement {
    pub translation: Option<DVec3>,
    pub rotation: Option<DQuat>,
    pub scale: Option<DVec3>,
}

/// What differs from the nodes as they are in the file.
#[derive(Debug, Default)]
pub(super) struct Pose {
    placements: HashMap<usize, Placement>,
    /// Weights of the morph targets of a node's mesh.
    pub weights: HashMap<usize, Vec<f64>>,
}

impl Pose {
    /// What is changed of a node.
    pub fn of(&self, node: usize) -> Option<&Placement> {
        self.placements.get(&node)
    }
}

/// How values between two keyframes are found.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Interpolation {
    Step,
    Linear,
    CubicSpline,
}

/// The place of a time among keyframes.
struct Place {
    /// The keyframe before, or the nearest one.
    frame: usize,
    /// The share of the way to the next keyframe, in [0, 1]; 0 beyond the ends.
    share: f64,
    /// The time between both [s].
    span: f64,
}

/// The pose at a time [s]: that of the animation of this name or number, or of the first one.
pub(super) fn pose(
    document: &Document<'_>,
    accessors: &Accessors<'_>,
    time: f64,
    chosen: Option<&str>,
    warnings: &mut Vec<String>,
) -> Result<Pose> {
    let mut pose = Pose::default();
    let names = || document.animations.iter().map(|it| it.name.as_deref());
    let number = match chosen {
        Some(chosen) => super::choose("animations", chosen, names())?,
        None if document.animations.is_empty() => {
            super::warn(warnings, "the file has no animation; it is drawn as it is at every time".to_owned());
            return Ok(pose);
        }
        None => 0,
    };
    let animation = &document.animations[number];
    let at = format!("animations[{number}]");
    if chosen.is_none() && document.animations.len() > 1 {
        let others = names().enumerate().skip(1).map(|(i, name)| called(&format!("animations[{i}]"), name));
        let text = format!("{at} is drawn; others are left out: {}", super::listed(others));
        super::warn(warnings, text);
    }
    for (i, channel) in animation.channels.iter().enumerate() {
        let at_channel = format!("{at}.channels[{i}]");
        let target = channel.target.as_ref().ok_or_else(|| missing(&at_channel, "target"))?;
        if target.extensions.contains_key("KHR_animation_pointer") {
            let text = format!("{at_channel}: an animation of other properties (KHR_animation_pointer) is left out");
            super::warn(warnings, text);
            continue;
        }
        // A channel without a node is to be ignored.
        let Some(node) = target.node else { continue };
        let (node, element_of) = element(&document.nodes, "nodes", &format!("{at_channel}.target.node"), node)?;
        let index = channel.sampler.ok_or_else(|| missing(&at_channel, "sampler"))?;
        let (index, sampler) = element(&animation.samplers, "samplers", &format!("{at_channel}.sampler"), index)?;
        let sampler = SamplerAt { path: format!("{at}.samplers[{index}]"), sampler, accessors, time };
        let placement = pose.placements.entry(node).or_default();
        match target.path.as_str() {
            "translation" => placement.translation = Some(DVec3::from_array(sampler.values::<3>(1)?[0])),
            "scale" => placement.scale = Some(DVec3::from_array(sampler.values::<3>(1)?[0])),
            "rotation" => placement.rotation = Some(sampler.rotation()?),
            "weights" => {
                let mesh = element_of.mesh.and_then(|mesh| document.meshes.get(usize::try_from(mesh).ok()?));
                let targets = mesh.and_then(|mesh| mesh.primitives.first()).map_or(0, |it| it.targets.len());
                if targets > 0 {
                    let weights = sampler.values::<1>(targets)?.into_iter().map(|[weight]| weight).collect();
                    pose.weights.insert(node, weights);
                }
            }
            other => {
                let message =
                    format!("unknown name '{}', expected translation, rotation, scale or weights", elided(other));
                return Err(Error::invalid(format!("{at_channel}.target.path"), message));
            }
        }
    }
    Ok(pose)
}

struct SamplerAt<'a> {
    path: String,
    sampler: &'a AnimationSampler,
    accessors: &'a Accessors<'a>,
    time: f64,
}

impl SamplerAt<'_> {
    fn interpolation(&self) -> Result<Interpolation> {
        match self.sampler.interpolation.as_deref() {
            None | Some("LINEAR") => Ok(Interpolation::Linear),
            Some("STEP") => Ok(Interpolation::Step),
            Some("CUBICSPLINE") => Ok(Interpolation::CubicSpline),
            Some(other) => {
                let message = format!("unknown name '{}', expected LINEAR, STEP or CUBICSPLINE", elided(other));
                Err(Error::invalid(format!("{}.interpolation", self.path), message))
            }
        }
    }

    /// Where the time is among the keyframes, and the number of keyframes.
    fn place(&self) -> Result<(Place, usize)> {
        let path = format!("{}.input", self.path);
        let index = self.sampler.input.ok_or_else(|| missing(&self.path, "input"))?;
        let times = self.accessors.floats::<1>(&path, index, Allowed::Floats)?;
        if let Some(i) = times.windows(2).position(|pair| pair[0] >= pair[1]) {
            return Err(Error::invalid(path, format!("element {} is not later than the one before", i + 1)));
        }
        let (Some(first), Some(last)) = (times.first(), times.last()) else {
            return Err(Error::invalid(path, "there is no keyframe, expected one or more"));
        };
        let place = if self.time <= first[0].into() {
            Place { frame: 0, share: 0.0, span: 0.0 }
        } else if self.time >= last[0].into() {
            Place { frame: times.len() - 1, share: 0.0, span: 0.0 }
        } else {
            let frame = times.partition_point(|time| f64::from(time[0]) <= self.time) - 1;
            let [from, to] = [times[frame][0], times[frame + 1][0]].map(f64::from);
            Place { frame, share: (self.time - from) / (to - from), span: to - from }
        };
        Ok((place, times.len()))
    }

    /// The values at the time, `per_frame` elements of them.
    fn values<const N: usize>(&self, per_frame: usize) -> Result<Vec<[f64; N]>> {
        let Frames { place: Place { share, span, .. }, interpolation, from, to, leaving, arriving } =
            self.frames::<N>(per_frame)?;
        let at = |i: usize, k: usize| match interpolation {
            Interpolation::Step => from[i][k],
            Interpolation::Linear => from[i][k] + share * (to[i][k] - from[i][k]),
            Interpolation::CubicSpline => {
                let (t, t2, t3) = (share, share * share, share * share * share);
                (2.0 * t3 - 3.0 * t2 + 1.0) * from[i][k]
                    + span * (t3 - 2.0 * t2 + t) * leaving[i][k]
                    + (3.0 * t2 - 2.0 * t3) * to[i][k]
                    + span * (t3 - t2) * arriving[i][k]
            }
        };
        Ok((0..per_frame).map(|i| std::array::from_fn(|k| at(i, k))).collect())
    }

    /// The rotation at the time.
    fn rotation(&self) -> Result<DQuat> {
        let Frames { place, interpolation, from, to, .. } = self.frames::<4>(1)?;
        if interpolation != Interpolation::Linear || place.share == 0.0 {
            return Ok(DQuat::from_array(self.values::<4>(1)?[0]));
        }
        let unit = |rotation: [f64; 4]| {
            let rotation = DQuat::from_array(rotation);
            let length = rotation.length();
            let message = || format!("{rotation} is no rotation, expected a unit quaternion");
            let is_unit = length > 1e-6;
            is_unit.then(|| rotation / length).ok_or_else(|| Error::invalid(format!("{}.output", self.path), message()))
        };
        Ok(unit(from[0])?.slerp(unit(to[0])?, place.share))
    }

    fn frames<const N: usize>(&self, per_frame: usize) -> Result<Frames<N>> {
        let (place, count) = self.place()?;
        let interpolation = self.interpolation()?;
        let path = format!("{}.output", self.path);
        let index = self.sampler.output.ok_or_else(|| missing(&self.path, "output"))?;
        let values = self.accessors.floats::<N>(&path, index, Allowed::Animated)?;
        // Keyframes of splines are a tangent that arrives, the value, and a tangent that leaves.
        let parts = if interpolation == Interpolation::CubicSpline { 3 } else { 1 };
        if Some(values.len()) != count.checked_mul(parts).and_then(|all| all.checked_mul(per_frame)) {
            let message =
                format!("{} elements for {count} keyframes, expected {} for each", values.len(), parts * per_frame);
            return Err(Error::invalid(path, message));
        }
        let part = |frame: usize, part: usize| -> Vec<[f64; N]> {
            let first = (frame * parts + part.min(parts - 1)) * per_frame;
            values[first..first + per_frame].iter().map(|value| value.map(f64::from)).collect()
        };
        let next = (place.frame + 1).min(count - 1);
        let (from, leaving) = (part(place.frame, parts / 2), part(place.frame, 2));
        Ok(Frames { from, leaving, to: part(next, parts / 2), arriving: part(next, 0), place, interpolation })
    }
}

/// The keyframes around a time.
struct Frames<const N: usize> {
    place: Place,
    interpolation: Interpolation,
    from: Vec<[f64; N]>,
    to: Vec<[f64; N]>,
    /// Slopes of splines, per second.
    leaving: Vec<[f64; N]>,
    arriving: Vec<[f64; N]>,
}
