//! The ball that holds a scene, as light from infinity sees it.

use std::f64::consts::PI;

use crate::math::{Frame, Vec3};
use crate::sampling::warps;

/// A ball that holds everything that light can meet, in the scene frame.
#[derive(Clone, Copy, Debug)]
pub struct InfiniteBall {
    centre: Vec3,
    radius: f32,
}

impl InfiniteBall {
    /// The ball of this centre and radius (> 0).
    pub fn new(centre: Vec3, radius: f32) -> Self {
        Self { centre, radius }
    }

    /// Its centre.
    pub fn centre(&self) -> Vec3 {
        self.centre
    }

    /// Its radius.
    pub fn radius(&self) -> f32 {
        self.radius
    }

    /// Its surface [length^2].
    pub(super) fn area(&self) -> f64 {
        4.0 * self.cross_section()
    }

    /// The area of its shadow [length^2].
    pub(super) fn cross_section(&self) -> f64 {
        PI * f64::from(self.radius) * f64::from(self.radius)
    }

    /// A point in the unit direction `wi` of `p` that lies beyond the ball, wherever `p` is.
    #[inline]
    pub(super) fn beyond(&self, p: Vec3, wi: Vec3) -> Vec3 {
        p + wi * (2.0 * self.radius + self.centre.distance(p))
    }

    /// Where a photon starts that comes from the unit direction `from` through the point `offset` \[length\] of the disk across it whose
    /// centre is that of the ball: on the ball's tangent plane.
    #[inline]
    pub fn photon_start(&self, from: Vec3, offset: [f32; 2]) -> Vec3 {
        let frame = Frame::from_normal(from);
        self.centre + frame.to_world(Vec3::new(offset[0], offset[1], self.radius))
    }

    /// The place of a point on that disk: the inverse of [`Self::photon_start`] but for the height.
    #[inline]
    pub fn offset_of(&self, from: Vec3, p: Vec3) -> [f32; 2] {
        let local = Frame::from_normal(from).to_local(p - self.centre);
        [local.x, local.y]
    }

    /// A uniform point of the disk of the ball's radius.
    #[inline]
    pub fn disk(&self, u: [f32; 2]) -> [f32; 2] {
        warps::uniform_disk(u).map(|x| x * self.radius)
    }
}
