//! What a facet of a metal reflects, by colour.

use std::sync::Arc;

use super::fresnel::fresnel_conductors;
use super::microfacet::average_of;
use super::thin_film::FilmedMetal;
use crate::desc::ConductorDesc;
use crate::math::Vec3;
use crate::spectrum::{Rgb, Spectrum};

/// The reflectance of a smooth metal by the angle of incidence.
#[derive(Clone, Debug, PartialEq)]
pub enum MetalFacet {
    /// Fresnel's equations with a complex index of refraction per channel; an infinite extinction reflects everything.
    Index {
        /// Index of refraction.
        eta: Vec3,
        /// Extinction coefficient.
        k: Vec3,
    },
    /// Schlick's fit to Fresnel's equations with a tint towards the edge, as OpenPBR has it.
    ///
    /// F = F0 + (1 - F0) (1 - mu)^5 - b mu (1 - mu)^6, where b is such that F at the cosine 1/7 is `tint` times that of the fit
    /// without b. Source: Kutz, Hasan, Edmondson 2021, "Novel Aspects of the Adobe Standard Material", Sec. 2.
    Tinted {
        /// Reflectance at normal incidence.
        f0: Rgb,
        /// The factor b.
        b: Rgb,
        /// Factor on the whole, in [0, 1].
        weight: f32,
    },
    /// Fresnel's equations with a thin film.
    Filmed(Arc<FilmedMetal>),
}

impl MetalFacet {
    /// The metal of a checked description, in front of which is air.
    pub fn new(desc: &ConductorDesc) -> Self {
        let index = [0, 1, 2].map(|channel| desc.index(channel).unwrap_or([1.0, f32::INFINITY]));
        Self::Index { eta: index.map(|[eta, _]| eta).into(), k: index.map(|[_, k]| k).into() }
    }

    /// A metal with this colour at normal incidence and this tint of the edge, both in [0, 1].
    pub fn tinted(f0: Rgb, tint: Rgb, weight: f32) -> Self {
        const EDGE: f32 = 1.0 / 7.0;
        let at_edge = schlick(f0, EDGE);
        let scale = EDGE * (1.0 - EDGE).powi(6);
        Self::Tinted { f0, b: at_edge * (Rgb::ONE - tint) / scale, weight }
    }

    /// The reflectance at this cosine of the angle of incidence, in [0, 1] per channel.
    #[inline]
    pub fn reflectance(&self, cos: f32) -> Rgb {
        match self {
            Self::Index { eta, k } => Rgb::from_array(fresnel_conductors(cos, *eta, *k).to_array()),
            Self::Tinted { f0, b, weight } => {
                let below = (1.0 - cos).clamp(0.0, 1.0);
                let power = below.powi(6);
                (schlick(*f0, cos) - *b * (cos * power)).max(Rgb::ZERO).min(Rgb::ONE) * *weight
            }
            Self::Filmed(metal) => metal.observed(cos),
        }
    }

    /// The reflectance at this cosine in the channels of a path: a smooth spectrum of its colour, or with a film that of each
    /// wavelength.
    #[inline]
    pub fn reflectance_in<C: Spectrum>(&self, cos: f32, wavelengths: &C::Wavelengths) -> C {
        match self {
            Self::Filmed(metal) => metal.reflectance(cos, wavelengths),
            plain => C::from_reflectance(plain.reflectance(cos), wavelengths),
        }
    }

    /// The mean reflectance for light from all sides: weighed by the cosine.
    pub fn mean_reflectance(&self) -> Rgb {
        if let Self::Filmed(metal) = self
            && let Some(mean) = metal.mean()
        {
            return mean;
        }
        Rgb::from_f64(average_of(|mu| self.reflectance(mu as f32).to_f64()))
    }
}

/// Source: Schlick 1994, "An Inexpensive BRDF Model for Physically-based Rendering".
fn schlick(f0: Rgb, cos: f32) -> Rgb {
    let below = (1.0 - cos).clamp(0.0, 1.0);
    f0 + (Rgb::ONE - f0) * below.powi(5)
}
