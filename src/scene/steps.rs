//! How many moments the kernel is given of a motion.
//!
//! Between two moments the kernel moves every point along a straight line. The number of moments is the least with which no point is
//! farther from its true place than a share of the thing's own size.

use super::movement::{step_times, vertex_at};
use crate::control::Cancel;
use crate::desc::MeshStep;
use crate::embree::MAX_TIME_STEPS;
use crate::error::Result;
use crate::math::{Bounds, DAffine3, DVec3, KeyedPath};

/// Greatest distance between a point and its true place, as a share of the diagonal of the thing's box.
pub(super) const MOST_OFF: f64 = 1e-3;

/// A motion as the kernel is given it.
#[derive(Clone, Debug)]
pub(super) struct Steps {
    /// Transforms at moments evenly spaced from the opening of the shutter to its closing; one for what rests.
    pub transforms: Vec<DAffine3>,
    /// How far a point is from its true place at most, as a share of the diagonal of the thing's box. Above [`MOST_OFF`] where even
    /// the most moments are too few.
    pub off: f64,
}

/// The moment number `step` of `segments` + 1, in seconds.
pub(super) fn moment([open, close]: [f64; 2], step: usize, segments: usize) -> f64 {
    open + (close - open) * (step as f64 / segments as f64)
}

/// A thing that moves: by its path, by its vertices, or by both.
pub(super) struct Mover<'a> {
    /// When the shutter opens and closes \[s\].
    pub interval: [f64; 2],
    /// The path of the thing's own transform; `None` for one that only deforms.
    pub path: Option<&'a KeyedPath>,
    /// The transform before the path.
    pub own: DAffine3,
    /// The box around the thing before `own`.
    pub bounds: Bounds,
    /// The steps of its mesh.
    pub deforming: Option<&'a [MeshStep]>,
}

impl Mover<'_> {
    /// The transform at a time \[s\].
    fn at(&self, time: f64) -> DAffine3 {
        self.path.map_or(self.own, |path| path.at(time) * self.own)
    }

    /// Chooses the number of moments.
    pub(super) fn steps(&self, cancel: &Cancel) -> Result<Steps> {
        let most = MAX_TIME_STEPS - 1;
        let size = self.bounds.transformed(&self.at(self.interval[0]));
        let size = (size.max - size.min).length().max(f64::MIN_POSITIVE);
        let mut chosen = most;
        let mut off = f64::INFINITY;
        for segments in 1..=most {
            cancel.check()?;
            let found = self.off(segments, MOST_OFF * size).max(self.off_deforming(segments, MOST_OFF * size));
            if found <= MOST_OFF * size {
                (chosen, off) = (segments, found);
                break;
            }
        }
        if off == f64::INFINITY {
            off = self.off(most, f64::INFINITY).max(self.off_deforming(most, f64::INFINITY));
        }
        let transforms = (0..=chosen).map(|step| self.at(moment(self.interval, step, chosen))).collect();
        Ok(Steps { transforms, off: off / size })
    }

    /// How far a corner of the box is from its true place, with this number of segments. The function may return as soon as that is
    /// more than `most`. Every segment is examined at its quarters, and at the keys of the path.
    fn off(&self, segments: usize, most: f64) -> f64 {
        let Some(path) = self.path else { return 0.0 };
        let corners = self.bounds.corners();
        let keys: Vec<f64> = path.times_in(self.interval).collect();
        let mut off: f64 = 0.0;
        let mut from = self.at(self.interval[0]);
        let mut key = 0;
        for segment in 0..segments {
            let ends = [segment, segment + 1].map(|step| moment(self.interval, step, segments));
            let to = self.at(ends[1]);
            let mut examine = |share: f64| {
                let exact = self.at(ends[0] + share * (ends[1] - ends[0]));
                for corner in corners {
                    let straight = from.transform_point3(corner).lerp(to.transform_point3(corner), share);
                    off = off.max(straight.distance(exact.transform_point3(corner)));
                }
            };
            [0.5, 0.25, 0.75].into_iter().for_each(&mut examine);
            while let Some(time) = keys.get(key).filter(|time| **time <= ends[1]) {
                if *time > ends[0] {
                    examine((time - ends[0]) / (ends[1] - ends[0]));
                }
                key += 1;
            }
            if off > most {
                return off;
            }
            from = to;
        }
        off
    }

    /// The same of the vertices of the mesh, whose paths are straight but for the times of its steps.
    fn off_deforming(&self, segments: usize, most: f64) -> f64 {
        let Some(steps) = self.deforming else { return 0.0 };
        let [open, close] = self.interval;
        // A moment of the kernel at every step of the mesh leaves nothing to examine.
        let along = |time: f64| (time - open) / (close - open) * segments as f64;
        let is_between = |time: &f64| (along(*time) - along(*time).round()).abs() > 1e-9;
        let stretch = self.own.matrix3.to_cols_array().iter().map(|x| x * x).sum::<f64>().sqrt();
        let mut off: f64 = 0.0;
        for time in step_times(steps, self.interval).filter(is_between) {
            let segment = (along(time) as usize).min(segments - 1);
            let ends = [segment, segment + 1].map(|step| moment(self.interval, step, segments));
            let share = (time - ends[0]) / (ends[1] - ends[0]);
            for vertex in 0..steps[0].positions.len() {
                let [from, exact, to] = [ends[0], time, ends[1]].map(|time| vertex_at(steps, vertex, time));
                let straight: DVec3 = from.lerp(to, share);
                off = off.max(stretch * straight.distance(exact));
                if off > most {
                    return off;
                }
            }
        }
        off
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::{DMat3, DQuat, Pose};

    fn turning(degrees: f64) -> KeyedPath {
        let pose = |degrees: f64| Pose {
            translation: DVec3::ZERO,
            rotation: DQuat::from_rotation_z(degrees.to_radians()),
            stretch: DMat3::IDENTITY,
        };
        KeyedPath::new([(0.0, pose(0.0)), (1.0, pose(degrees))]).unwrap()
    }

    #[test]
    fn chords_are_as_far_from_their_arcs_as_the_sagitta() {
        let bounds = Bounds { min: DVec3::new(-1.0, -1e-9, -1e-9), max: DVec3::new(1.0, 1e-9, 1e-9) };
        for degrees in [10.0_f64, 90.0, 170.0] {
            let path = turning(degrees);
            let own = DAffine3::IDENTITY;
            let mover = Mover { interval: [0.0, 1.0], path: Some(&path), own, bounds, deforming: None };
            let steps = mover.steps(&Cancel::new()).unwrap();
            let sagitta = |segments: f64| 1.0 - (0.5 * degrees.to_radians() / segments).cos();
            let segments = (steps.transforms.len() - 1) as f64;
            assert!((steps.off - 0.5 * sagitta(segments)).abs() < 1e-9, "{steps:?}");
            // No number below does.
            assert!(
                sagitta(segments) <= 2.0 * MOST_OFF && (segments < 2.0 || sagitta(segments - 1.0) > 2.0 * MOST_OFF)
            );
        }
    }

    #[test]
    fn what_goes_straight_has_two_moments_and_corners_have_their_own() {
        let place = |x: f64, y: f64| Pose {
            translation: DVec3::new(x, y, 0.0),
            rotation: DQuat::IDENTITY,
            stretch: DMat3::IDENTITY,
        };
        let path = KeyedPath::new([(0.0, place(0.0, 0.0)), (1.0, place(9.0, 0.0)), (4.0, place(0.0, 9.0))]).unwrap();
        let bounds = Bounds { min: DVec3::ZERO, max: DVec3::ONE };
        for (interval, count) in [([0.0, 1.0], 2), ([1.0, 4.0], 2), ([0.0, 4.0], 5), ([0.5, 1.5], 3)] {
            let own = DAffine3::IDENTITY;
            let mover = Mover { interval, path: Some(&path), own, bounds, deforming: None };
            let steps = mover.steps(&Cancel::new()).unwrap();
            assert_eq!((steps.transforms.len(), steps.off < 1e-12), (count, true), "{steps:?}");
        }
    }
}
