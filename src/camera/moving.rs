//! Cameras that move while the shutter is open.

use super::Camera;
use crate::desc::CameraDesc;
use crate::error::Result;
use crate::math::{DVec3, KeyedPath, shutter_time};

/// Moments at which a camera is examined before it is used.
const EXAMINED: u32 = 64;

/// A camera that moves. At each moment it is a camera of its own, set up in double precision.
#[derive(Clone, Debug)]
pub struct MovingCamera {
    base: CameraDesc,
    path: KeyedPath,
    interval: [f64; 2],
    resolution: [u32; 2],
    centre: DVec3,
    start: Camera,
}

impl MovingCamera {
    /// A camera that a path of transforms, which keep lengths, moves from where `base` has it. `interval`: when the shutter opens and
    /// closes, in the seconds of the path. The other arguments are those of [`Camera::new`].
    ///
    /// # Errors
    /// Those of [`Camera::new`], at any of the moments that are examined.
    pub fn new(
        base: CameraDesc,
        path: KeyedPath,
        interval: [f64; 2],
        resolution: [u32; 2],
        centre: DVec3,
    ) -> Result<Self> {
        let [open, _] = interval;
        let start = Camera::new(&base.moved(&path.at(open)), resolution, centre)?;
        let camera = Self { base, path, interval, resolution, centre, start };
        for i in 1..=EXAMINED {
            camera.try_at(i as f32 / EXAMINED as f32)?;
        }
        Ok(camera)
    }

    fn try_at(&self, time: f32) -> Result<Camera> {
        let [open, close] = self.interval;
        let seconds = open + (close - open) * f64::from(shutter_time(time));
        Camera::new(&self.base.moved(&self.path.at(seconds)), self.resolution, self.centre)
    }

    /// The camera at a time ([`crate::math::Ray::time`]).
    pub fn at(&self, time: f32) -> Camera {
        // Moving and turning makes no camera of one that is none, but for rounding at the end of the range of numbers.
        self.try_at(time).unwrap_or(self.start)
    }
}
