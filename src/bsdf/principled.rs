//! One model with the parameters of OpenPBR, put together from the others.

use super::coat::Coat;
use super::conductor::Conductor;
use super::layered::{Layer, Layered, LayeredParts};
use super::metal_facet::MetalFacet;
use super::microfacet::Microfacets;
use super::sheen::Sheen;
use super::{
    Bsdf, Dielectric, Eon, Lambert, Mix, RoughConductor, RoughDielectric, RoughThinDielectric, Sheet, ThinDielectric,
    TintedTransmission,
};
use crate::desc::{MicrofacetsDesc, PrincipledDesc, weighted_eta};
use crate::spectrum::Rgb;

/// The model of a checked description: fuzz over a coat over a mixture of metal, clear dielectric and dielectric with a
/// diffuse base. `outside`: index of refraction of what is around it. `varies`: whether textures vary it.
pub(super) fn principled(desc: &PrincipledDesc, outside: f32, varies: bool) -> Bsdf {
    let facets = roughened(desc);
    let metalness = desc.base_metalness;
    let dielectric = || {
        let opaque = || opaque_dielectric(desc, outside, &facets, varies);
        let clear = || clear_dielectric(desc, outside, &facets);
        mixed(opaque, clear, desc.transmission_weight)
    };
    let metal = || {
        let colour = desc.base_color * desc.base_weight;
        let facet = MetalFacet::tinted(colour, desc.specular_color, desc.specular_weight);
        match Microfacets::new(&facets) {
            Some(microfacets) => {
                Bsdf::RoughConductor(RoughConductor::new(facet, microfacets, desc.multiple_scattering))
            }
            None => Bsdf::Conductor(Conductor::new(facet)),
        }
    };
    let base = mixed(dielectric, metal, metalness);
    let coated = if desc.coat_weight > 0.0 {
        Layered::cover(LayeredParts {
            layer: Layer::Coat(Coat::new(
                f64::from(desc.coat_ior) / f64::from(outside),
                Microfacets::new(&desc.coat_facets()),
            )),
            base,
            coverage: desc.coat_weight,
            // The colour is what is left after the way down and up.
            tint: root(desc.coat_color),
            darkening: desc.coat_darkening,
            varies,
            is_thin: desc.thin_walled,
        })
    } else {
        base
    };
    if desc.fuzz_weight > 0.0 {
        Layered::cover(LayeredParts {
            layer: Layer::Sheen(Sheen::new(desc.fuzz_color, desc.fuzz_roughness)),
            base: coated,
            coverage: desc.fuzz_weight,
            tint: Rgb::ONE,
            darkening: 1.0,
            varies,
            is_thin: desc.thin_walled,
        })
    } else {
        coated
    }
}

/// A diffuse surface under a smooth or rough coat whose index over the one outside is `eta`.
pub(super) fn coated_diffuse(base: Bsdf, eta: f64, facets: &MicrofacetsDesc, varies: bool) -> Bsdf {
    Layered::cover(LayeredParts {
        layer: Layer::Coat(Coat::new(eta, Microfacets::new(facets))),
        base,
        coverage: 1.0,
        tint: Rgb::ONE,
        darkening: 1.0,
        varies,
        is_thin: false,
    })
}

/// A sum, without parts of weight 0.
fn mixed(first: impl FnOnce() -> Bsdf, second: impl FnOnce() -> Bsdf, weight: f32) -> Bsdf {
    if weight <= 0.0 {
        first()
    } else if weight >= 1.0 {
        second()
    } else {
        Bsdf::Mix(Mix::new([first(), second()], weight))
    }
}

fn root(colour: Rgb) -> Rgb {
    Rgb::from_array(colour.to_array().map(f32::sqrt))
}

/// The facets of the base. A rough coat scatters what they reflect (OpenPBR Surface 1.1, "Roughening").
fn roughened(desc: &PrincipledDesc) -> MicrofacetsDesc {
    let facets = desc.specular_facets();
    let wider = (facets.roughness.powi(4) + 2.0 * desc.coat_roughness.powi(4)).min(1.0).powf(0.25);
    MicrofacetsDesc { roughness: facets.roughness + desc.coat_weight * (wider - facets.roughness), ..facets }
}

fn opaque_dielectric(desc: &PrincipledDesc, outside: f32, facets: &MicrofacetsDesc, varies: bool) -> Bsdf {
    let colour = desc.base_color * desc.base_weight;
    let base = if desc.base_diffuse_roughness > 0.0 {
        Bsdf::Eon(Eon::new(colour, desc.base_diffuse_roughness))
    } else {
        Bsdf::Lambert(Lambert::new(colour))
    };
    // Under a coat the dielectric meets the index of the coat. An index below it would reflect everything at some angle, which
    // no light that came through the coat does, so its inverse is taken, as OpenPBR does.
    let around = outside + desc.coat_weight * (desc.coat_ior - outside);
    let eta = desc.specular_ior / around;
    let eta = weighted_eta(eta.max(1.0 / eta), desc.specular_weight);
    if eta == 1.0 { base } else { coated_diffuse(base, eta.into(), facets, varies) }
}

fn clear_dielectric(desc: &PrincipledDesc, outside: f32, facets: &MicrofacetsDesc) -> Bsdf {
    let eta = desc.clear_eta(outside);
    if desc.thin_walled {
        return thin_dielectric(eta, 1.0, desc.transmission_color, facets);
    }
    let base = rough_dielectric(eta, 1.0, facets);
    // With a depth, the colour is that of the medium inside.
    if desc.transmission_color == Rgb::ONE || desc.transmission_depth > 0.0 {
        return base;
    }
    // Half of the colour at each of the two interfaces that light crosses on its way through a body.
    Bsdf::TintedTransmission(TintedTransmission::new(base, root(desc.transmission_color)))
}

/// A smooth or rough thin sheet.
pub(super) fn thin_dielectric(ior: f32, exterior_ior: f32, transmittance: Rgb, facets: &MicrofacetsDesc) -> Bsdf {
    let sheet = Sheet::new(ior, exterior_ior, transmittance);
    match Microfacets::new(facets).filter(|_| ior != exterior_ior) {
        Some(microfacets) => {
            let is_compensated = facets.multiple_scattering;
            Bsdf::RoughThinDielectric(RoughThinDielectric::new(sheet, microfacets, is_compensated))
        }
        None => Bsdf::ThinDielectric(ThinDielectric::new(sheet)),
    }
}

/// A smooth or rough interface.
pub(super) fn rough_dielectric(ior: f32, exterior_ior: f32, facets: &MicrofacetsDesc) -> Bsdf {
    match Microfacets::new(facets).filter(|_| ior != exterior_ior) {
        Some(microfacets) => {
            let is_compensated = facets.multiple_scattering;
            Bsdf::RoughDielectric(RoughDielectric::new(ior, exterior_ior, microfacets, is_compensated))
        }
        None => Bsdf::Dielectric(Dielectric::new(ior, exterior_ior)),
    }
}
