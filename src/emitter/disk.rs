//! Disks that emit on the side of their normal.

use std::f64::consts::{PI, TAU};

use super::{Departure, EmitterSample};
use crate::math::{Bounds, DVec3, Vec3};
use crate::sampling::warps;
use crate::shape::Disk;
use crate::spectrum::Rgb;

/// A disk, or an ellipse that a transform made of one, with the same radiance from every point in every direction of its normal's side.
///
/// From afar, points are sampled uniformly by area. From nearby, a half-plane through the normal is chosen uniformly by angle among those
/// in which the receiver sees some of the disk, then a direction in it, uniformly by the solid angle of the slice, so that no sample
/// counts more than a hemisphere.
#[derive(Clone, Copy, Debug)]
pub struct DiskEmitter {
    /// Its geometry.
    pub disk: Disk,
    /// Emitted radiance [W m^-2 sr^-1].
    pub radiance: Rgb,
    area: f64,
    /// Two unit vectors in its plane, across each other.
    axes: [DVec3; 2],
    /// Up to this squared distance from the centre a receiver is near.
    near2: f64,
}

/// What a point near a disk sees of it.
struct Around {
    /// The point's projection on the plane of the disk, in the scene and in coordinates of the unit disk.
    foot: DVec3,
    own: [f64; 2],
    /// Height of the point over the plane.
    height: f64,
    /// The first angle around the foot, and how many there are in which rays of the plane meet the disk.
    first: f64,
    width: f64,
}

/// A receiver is near up to this many squares of the disk's longest radius: what remains beyond varies little over the disk.
const NEAR: f64 = 4.0;

impl DiskEmitter {
    /// An emitter of this shape.
    pub fn new(disk: Disk, radiance: Rgb) -> Self {
        let (x, y) = disk.normal().any_orthonormal_pair();
        let reach = 0.5 * (disk.bounds().max - disk.bounds().min).length();
        Self { disk, radiance, area: disk.area(), axes: [x, y], near2: NEAR * reach * reach }
    }

    /// The emitter on the other side of the disk.
    pub fn flipped(&self) -> Self {
        Self { disk: self.disk.flipped(), ..*self }
    }

    /// Its area [length^2].
    pub fn area(&self) -> f64 {
        self.area
    }

    /// Emitted power \[W\].
    pub(super) fn power(&self) -> DVec3 {
        PI * self.area * self.radiance.to_f64()
    }

    /// How far `p` lies in front of the disk's plane.
    #[inline]
    fn height(&self, p: DVec3) -> f64 {
        (p - self.disk.centre()).dot(self.disk.normal())
    }

    /// What `p` sees of the disk where points are sampled around the foot of its height; `None` far away, where they are sampled by area.
    #[inline]
    fn around(&self, p: DVec3, height: f64) -> Option<Around> {
        if p.distance_squared(self.disk.centre()) > self.near2 {
            return None;
        }
        let foot = p - height * self.disk.normal();
        let [x, y] = self.disk.coordinates(foot);
        let distance = x.hypot(y);
        let (first, width) = if distance <= 1.0 {
            (0.0, TAU)
        } else {
            // Between the two tangents, less than half a turn apart.
            let (middle, half) = (y.atan2(x), ((distance - 1.0) * (distance + 1.0)).sqrt().atan());
            let [a, b] = [middle - half, middle + half].map(|angle| {
                let way = self.disk.at([angle.cos(), angle.sin()]) - foot;
                way.dot(self.axes[1]).atan2(way.dot(self.axes[0]))
            });
            let turn = (b - a).rem_euclid(TAU);
            if turn > PI { (b, TAU - turn) } else { (a, turn) }
        };
        Some(Around { foot, own: [x, y], height, first, width })
    }

    /// The cosines of the angles at `p` under which a ray of the plane from the foot of its height enters and leaves the disk.
    #[inline]
    fn slice(&self, around: &Around, direction: DVec3) -> [f64; 2] {
        // |own + t d| = 1.
        let [x, y] = around.own;
        let [dx, dy] = self.disk.coordinates_of(direction);
        let (a, b, c) = (dx * dx + dy * dy, x * dx + y * dy, (x * x - 1.0) + y * y);
        let root = (b * b - a * c).max(0.0).sqrt();
        // The larger root by magnitude first, the other by the product of both, so that nothing cancels.
        let large = if b > 0.0 { -b - root } else { root - b };
        let (one, other) = (large / a, if large == 0.0 { 0.0 } else { c / large });
        [one.min(other), one.max(other)].map(|t| around.height / around.height.hypot(t.max(0.0)))
    }

    /// 1 / A per area as a density per solid angle at this distance from a point this high over the plane.
    #[inline]
    fn pdf_by_area(&self, distance: f64, height: f64) -> f32 {
        (distance * distance * distance / (height * self.area)) as f32
    }

    /// A point of the disk, uniformly by area.
    #[inline]
    fn point(&self, u: [f32; 2]) -> DVec3 {
        self.disk.at(warps::uniform_disk(u).map(f64::from))
    }

    /// Samples a direction from `p`; `None` where `p` is behind the disk or in its plane.
    pub(super) fn sample(&self, p: Vec3, u: [f32; 2]) -> Option<EmitterSample> {
        let from = p.as_dvec3();
        let height = self.height(from);
        if height <= 0.0 {
            return None;
        }
        let (point, pdf) = match self.around(from, height) {
            Some(around) => {
                let (sin, cos) = (around.first + f64::from(u[0]) * around.width).sin_cos();
                let direction = cos * self.axes[0] + sin * self.axes[1];
                let [near, far] = self.slice(&around, direction);
                let cosine = near + f64::from(u[1]) * (far - near);
                let reach = height * ((1.0 - cosine) * (1.0 + cosine)).max(0.0).sqrt() / cosine;
                (around.foot + reach * direction, (1.0 / (around.width * (near - far))) as f32)
            }
            None => {
                let point = self.point(u);
                (point, self.pdf_by_area(point.distance(from), height))
            }
        };
        Some(EmitterSample::of_surface(from, point, self.disk.normal(), self.radiance, pdf))
    }

    /// Samples a point uniformly by area.
    pub(super) fn sample_departure(&self, u: [f32; 2]) -> Departure {
        Departure::of_surface(self.point(u), self.disk.normal())
    }

    /// Density per solid angle at `p` of the direction that meets the disk in `hit`; 0 where `p` is not in front.
    pub(super) fn pdf(&self, p: Vec3, hit: Vec3) -> f32 {
        let from = p.as_dvec3();
        let height = self.height(from);
        if height <= 0.0 {
            return 0.0;
        }
        match self.around(from, height) {
            Some(around) => {
                let way = hit.as_dvec3() - around.foot;
                let flat = way - way.dot(self.disk.normal()) * self.disk.normal();
                let direction = flat.try_normalize().unwrap_or(self.axes[0]);
                let [near, far] = self.slice(&around, direction);
                (1.0 / (around.width * (near - far))) as f32
            }
            None => self.pdf_by_area(from.distance(hit.as_dvec3()), height),
        }
    }

    /// A bounding box.
    pub(super) fn bounds(&self) -> Bounds {
        self.disk.bounds()
    }
}
