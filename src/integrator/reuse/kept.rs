//! A vertex that is kept after its path has gone on.

use std::f32::consts::FRAC_1_PI;

use crate::bsdf::{Bsdf, Lobes, Model, TransportMode};
use crate::integrator::vertex::Vertex;
use crate::math::{Frame, HitPoint, Ray, Vec3};
use crate::scene::Scene;
use crate::spectrum::Spectrum;

/// What is needed of a vertex to let it scatter light from or to other points than those of its path.
#[derive(Clone, Copy, Debug)]
pub(super) struct KeptVertex<C: Spectrum> {
    pub point: HitPoint,
    /// The geometric normal on the side that the path came from.
    pub facing: Vec3,
    frame: Frame,
    /// Direction back along the path, local frame.
    pub wo: Vec3,
    material: u32,
    bsdf: KeptBsdf<C>,
}

/// The scattering function of a kept vertex.
#[derive(Clone, Copy, Debug)]
enum KeptBsdf<C: Spectrum> {
    /// f is this for all pairs of directions on one side, and 0 for others; directions are drawn by the cosine.
    Constant(C),
    /// That of the material.
    Material,
    /// One that the material has at this point: the one with this number among those that are kept.
    Own(u32),
}

impl<C: Spectrum> KeptVertex<C> {
    /// Keeps a vertex. `own`: the number that its Bsdf has among those that are kept, if it is one that its material has at this point
    /// alone.
    #[inline]
    pub fn new(scene: &Scene, vertex: &Vertex<'_, C>, own: u32) -> Self {
        let (point, facing, frame, wo) = vertex.kept();
        let material = vertex.surface.material;
        let bsdf = match vertex.bsdf.constant_f() {
            // Other lobes take a part of the samples.
            Some(f) if vertex.lobes == Lobes::DIFFUSE_REFLECTION => KeptBsdf::Constant(f),
            _ if scene.material(material).constant::<C>().is_some() => KeptBsdf::Material,
            _ => KeptBsdf::Own(own),
        };
        Self { point, facing, frame, wo, material, bsdf }
    }

    /// Whether the Bsdf is one of those that are kept apart.
    #[inline]
    pub fn has_own_bsdf(&self) -> bool {
        matches!(self.bsdf, KeptBsdf::Own(_))
    }

    /// f where it is the same for all pairs of directions on one side (sr^-1).
    #[inline]
    pub fn constant_f(&self) -> Option<C> {
        match self.bsdf {
            KeptBsdf::Constant(f) => Some(f),
            _ => None,
        }
    }

    /// The scattering function for light from `wi` along `wo` (local frame), and the density of `wi` given `wo`; both are 0 where
    /// either is.
    #[inline]
    pub fn f_pdf(&self, scene: &Scene, kept: &[Bsdf<C>], wo: Vec3, wi: Vec3) -> (C, f32) {
        let bsdf = match self.bsdf {
            KeptBsdf::Constant(f) => {
                return if wo.z * wi.z > 0.0 { (f, wi.z.abs() * FRAC_1_PI) } else { (C::ZERO, 0.0) };
            }
            KeptBsdf::Own(own) => &kept[own as usize],
            KeptBsdf::Material => match scene.material(self.material).constant::<C>() {
                Some((bsdf, _)) => bsdf,
                None => return (C::ZERO, 0.0),
            },
        };
        let (f, pdf) = bsdf.f_pdf(wo, wi, TransportMode::Radiance);
        if f == C::ZERO || pdf == 0.0 { (C::ZERO, 0.0) } else { (f, pdf) }
    }

    /// A direction of the scene in the local frame; `None` where the face and the shading normal do not agree on its side, so that
    /// no light is scattered that way.
    #[inline]
    pub fn consistent(&self, w: Vec3) -> Option<Vec3> {
        let local = self.frame.to_local(w);
        (w.dot(self.facing) * local.z * self.wo.z > 0.0).then_some(local)
    }

    /// As [`Self::consistent`], on the side that the path came from.
    #[inline]
    pub fn seen_from(&self, w: Vec3) -> Option<Vec3> {
        let local = self.frame.to_local(w);
        (w.dot(self.facing) > 0.0 && local.z * self.wo.z > 0.0).then_some(local)
    }

    /// Area of the surface here by the solid angle in which it is seen, for the vector `d` from the vertex to the viewer: squared distance
    /// over cosine (length^2).
    #[inline]
    pub fn area_by_solid_angle(&self, d: Vec3) -> f32 {
        let squared = d.length_squared();
        squared * squared.sqrt() / d.dot(self.facing).abs()
    }

    /// The segment from this vertex, on the side that its path came from, to `other`, into direction `w`.
    #[inline]
    pub fn segment_to(&self, other: &Self, w: Vec3) -> Ray {
        let side = if w.dot(other.facing) < 0.0 { other.facing } else { -other.facing };
        self.point.leave_to(self.facing, other.point.offset(side))
    }
}
