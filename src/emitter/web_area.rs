//! Flat surfaces that shine as a photometric web says.
//!
//! A file tells the intensity I(w) of a whole luminaire from afar. A flat surface of area A whose points all shine alike has that
//! intensity where its radiance is L(w) = I(w) / (A cos theta), theta being the angle to its normal. Near the plane of the surface the
//! radiance grows without bound where I does not vanish there, but what arrives does not: a piece dA gives I dA / (A d^2) across its
//! light, whatever the angle, and the surface looks as much thinner as it looks brighter. So nothing is cut off, and flux and far
//! field are those of the file.

use std::f32::consts::PI;
use std::sync::Arc;

use super::directed::most_into;
use super::web::TurnedWeb;
use super::{Departure, DiskEmitter, EmitterSample, TriangleEmitter};
use crate::math::{Bounds, DVec3, Vec3};
use crate::shape::Triangle;
use crate::spectrum::Rgb;

/// The shape of a flat emitter, with the radiance that an even one of the same power has.
#[derive(Clone, Copy, Debug)]
pub enum FlatEmitter {
    /// A triangle.
    Triangle(TriangleEmitter),
    /// A disk.
    Disk(DiskEmitter),
}

/// A flat emitter with a photometric web, or one of the triangles of such a surface.
///
/// Light samples are those of an even emitter: uniform by area from afar, and by solid angle from nearby. What integrators call of it
/// for each path is not inlined, so that other emitters cost what they did.
#[derive(Clone, Debug)]
pub struct WebArea {
    even: FlatEmitter,
    normal: Vec3,
    /// The web of the side of the normal, which the triangles of a surface share.
    web: Arc<TurnedWeb>,
}

impl WebArea {
    /// The cosine to the normal counts as no less than this in the radiance, so that it stays finite. What this takes away is half of it
    /// at most, as a share of the flux of a lamp that is as bright along its plane as elsewhere: beyond the digits of single precision.
    pub const LEAST_COSINE: f32 = 1e-6;

    /// An emitter of the shape and the power of `even`, with the distribution of `web`, whose light is all on the side of the normal.
    pub fn new(even: FlatEmitter, web: Arc<TurnedWeb>) -> Self {
        let normal = match &even {
            FlatEmitter::Triangle(emitter) => emitter.triangle.normal,
            FlatEmitter::Disk(emitter) => emitter.disk.normal().as_vec3a(),
        };
        Self { even, normal, web }
    }

    /// Emitted power \[W\].
    pub(super) fn power(&self) -> DVec3 {
        match &self.even {
            FlatEmitter::Triangle(emitter) => emitter.power(),
            FlatEmitter::Disk(emitter) => emitter.power(),
        }
    }

    /// Its area [length^2].
    pub(super) fn area(&self) -> f64 {
        match &self.even {
            FlatEmitter::Triangle(emitter) => f64::from(emitter.triangle.area),
            FlatEmitter::Disk(emitter) => emitter.area(),
        }
    }

    /// The radiance that an even emitter of the same power has [W m^-2 sr^-1].
    pub(super) fn mean_radiance(&self) -> Rgb {
        match &self.even {
            FlatEmitter::Triangle(emitter) => emitter.radiance,
            FlatEmitter::Disk(emitter) => emitter.radiance,
        }
    }

    /// Its shape, where it is a triangle.
    pub(super) fn triangle(&self) -> Option<&Triangle> {
        match &self.even {
            FlatEmitter::Triangle(emitter) => Some(&emitter.triangle),
            FlatEmitter::Disk(_) => None,
        }
    }

    /// Its unit normal.
    pub(super) fn normal(&self) -> Vec3 {
        self.normal
    }

    /// Its centre.
    pub(super) fn centre(&self) -> Vec3 {
        match &self.even {
            FlatEmitter::Triangle(emitter) => emitter.triangle.at(1.0 / 3.0, 1.0 / 3.0),
            FlatEmitter::Disk(emitter) => emitter.disk.centre().as_vec3a(),
        }
    }

    /// A bounding box.
    pub(super) fn bounds(&self) -> Bounds {
        match &self.even {
            FlatEmitter::Triangle(emitter) => Bounds::around(emitter.triangle.vertices.map(Vec3::as_dvec3)),
            FlatEmitter::Disk(emitter) => emitter.bounds(),
        }
    }

    /// The radiance along a unit direction that leaves it on the side of its normal. An even emitter has pi times its area and radiance
    /// for its power, and this one that power times the share of the web for its intensity.
    #[inline(never)]
    pub(super) fn radiance(&self, wo: Vec3) -> Rgb {
        let cosine = self.normal.dot(wo).max(Self::LEAST_COSINE);
        self.mean_radiance() * (PI * self.pdf_of_direction(wo) as f32 / cosine)
    }

    /// Samples a direction from `p`; `None` where `p` is behind it, in its plane or in the dark.
    #[inline(never)]
    pub(super) fn sample(&self, p: Vec3, u: [f32; 2]) -> Option<EmitterSample> {
        let even = match &self.even {
            FlatEmitter::Triangle(emitter) => emitter.sample(p, u),
            FlatEmitter::Disk(emitter) => emitter.sample(p, u),
        }?;
        let radiance = self.radiance(-even.wi);
        (radiance != Rgb::ZERO).then_some(EmitterSample { radiance, ..even })
    }

    /// Density per solid angle at `p` of the direction that meets the emitter in `hit`; 0 where `p` is not in front.
    #[inline(never)]
    pub(super) fn pdf(&self, p: Vec3, hit: Vec3) -> f32 {
        match &self.even {
            FlatEmitter::Triangle(emitter) => emitter.pdf(p, hit),
            FlatEmitter::Disk(emitter) => emitter.pdf(p, hit),
        }
    }

    /// Samples a point uniformly by area.
    pub(super) fn sample_departure(&self, u: [f32; 2]) -> Departure {
        match &self.even {
            FlatEmitter::Triangle(emitter) => emitter.sample_departure(u),
            FlatEmitter::Disk(emitter) => emitter.sample_departure(u),
        }
    }

    /// A unit direction of light that leaves any of its points, in proportion to the intensity; the arguments are those of
    /// [`super::Distribution::sample`].
    #[inline]
    pub fn sample_direction(&self, u: [f32; 2], more: [f32; 2]) -> Vec3 {
        let digits = |k: usize| f64::from(u[k]) + f64::from(more[k]) * (-24_f64).exp2();
        self.web.sample([digits(0), digits(1)])
    }

    /// The density of [`Self::sample_direction`] [sr^-1]: the intensity over the flux.
    #[inline]
    pub fn pdf_of_direction(&self, direction: Vec3) -> f64 {
        f64::from(self.web.factor(direction)) / self.web.flux()
    }

    /// The largest intensity over the flux [sr^-1].
    pub fn peak_share(&self) -> f64 {
        self.web.peak() / self.web.flux()
    }

    /// A cone that holds all of the light: its unit axis and its half angle.
    pub(super) fn cone(&self) -> (DVec3, f64) {
        self.web.cone_about(self.normal.as_dvec3())
    }

    /// A bound of the share of the light that goes into a cone around the unit `axis` with this 1 - cos at its edge.
    pub fn most_into(&self, axis: Vec3, one_minus_cos: f64) -> f64 {
        most_into(self.cone(), self.peak_share(), axis, one_minus_cos)
    }
}
