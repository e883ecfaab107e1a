//! Keys of the facets of rough surfaces.

use serde::{Deserialize, Serialize};

use super::super::json::join;
use super::super::numbers::{degrees, single, unless};
use super::super::{Distribution, Masking, MicrofacetsDesc, validate};
use crate::Result;

/// The distribution of facets.
#[derive(Clone, Copy, Deserialize, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub(in crate::desc) enum FacetDistribution {
    /// Trowbridge and Reitz's, which has long tails.
    Ggx,
    /// Beckmann's: normally distributed slopes.
    Beckmann,
}

/// Which facets hide others.
#[derive(Clone, Copy, Deserialize, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub(in crate::desc) enum FacetMasking {
    /// Smith's, correlated by height.
    Smith,
    /// Smith's, for the two directions apart.
    SmithSeparable,
    /// Torrance and Sparrow's grooves.
    VCavity,
}

/// The keys of facets.
pub(super) struct FacetKeys {
    /// Roughness, anisotropy and rotation (degrees).
    pub numbers: [Option<f64>; 3],
    pub distribution: Option<FacetDistribution>,
    pub masking: Option<FacetMasking>,
    pub multiple_scattering: Option<bool>,
}

impl FacetKeys {
    /// The keys that describe these facets.
    pub fn of(facets: &MicrofacetsDesc) -> Self {
        let multiple_scattering = facets.multiple_scattering;
        Self {
            numbers: [single(facets.roughness), single(facets.anisotropy), degrees(facets.rotation)]
                .map(|number| unless(number, 0.0)),
            distribution: match facets.distribution {
                Distribution::Ggx => None,
                Distribution::Beckmann => Some(FacetDistribution::Beckmann),
            },
            masking: match facets.masking {
                Masking::Smith => None,
                Masking::SmithSeparable => Some(FacetMasking::SmithSeparable),
                Masking::VCavity => Some(FacetMasking::VCavity),
            },
            multiple_scattering: (multiple_scattering == (facets.masking == Masking::VCavity))
                .then_some(multiple_scattering),
        }
    }

    /// The facets that the keys describe.
    pub fn read(self, path: &str) -> Result<MicrofacetsDesc> {
        let number = |key: &str, value: Option<f64>| validate::number(&join(path, key), value.unwrap_or(0.0));
        let [roughness, anisotropy, rotation] = self.numbers;
        let masking = match self.masking {
            None | Some(FacetMasking::Smith) => Masking::Smith,
            Some(FacetMasking::SmithSeparable) => Masking::SmithSeparable,
            Some(FacetMasking::VCavity) => Masking::VCavity,
        };
        Ok(MicrofacetsDesc {
            roughness: validate::within(&join(path, "roughness"), roughness.unwrap_or(0.0), 0.0, 1.0)?,
            anisotropy: number("anisotropy", anisotropy)? as f32,
            rotation: number("rotation", rotation)?.to_radians() as f32,
            distribution: match self.distribution {
                None | Some(FacetDistribution::Ggx) => Distribution::Ggx,
                Some(FacetDistribution::Beckmann) => Distribution::Beckmann,
            },
            masking,
            multiple_scattering: self.multiple_scattering.unwrap_or(masking != Masking::VCavity),
        })
    }
}
