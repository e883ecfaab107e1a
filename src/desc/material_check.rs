//! Checks of materials whose numbers are already in single precision.

use super::json::{elided, join};
use super::material_spectra;
use super::validate::{absorption, emission, positive, reflectance, survival_rate, within};
use super::{
    BsdfDesc, ConductorDesc, Masking, MaterialDesc, MediumDesc, MicrofacetsDesc, PrincipledDesc, TextureBinding,
    TextureKey, ThinFilmDesc,
};
use crate::spectrum::Rgb;
use crate::{Error, Result};

/// Most models in one material, with those of the materials that it names.
const MOST_PARTS: usize = 64;

/// Most materials of which one names the next.
const MOST_LEVELS: usize = 16;

/// Checks a material. It may name `materials`, which come before it. An emission without any light and a film
/// without thickness become `None`.
pub(super) fn check(material: &mut MaterialDesc, materials: &[MaterialDesc]) -> Result<()> {
    if !material.spectra.is_empty() {
        material_spectra::apply(material)?;
    }
    let MaterialDesc { path, bsdf, survival, medium: inside, .. } = &*material;
    let at = |key: &str| join(path, key);
    model(path, bsdf, materials)?;
    if let Some(rate) = *survival {
        let is_diffuse = matches!(
            bsdf,
            BsdfDesc::Lambert { .. }
                | BsdfDesc::OrenNayarQualitative { .. }
                | BsdfDesc::OrenNayar { .. }
                | BsdfDesc::Eon { .. }
        );
        if !is_diffuse {
            let message = "only a diffuse material has a survival probability";
            return Err(Error::invalid(at("reflectionRate"), message));
        }
        survival_rate(&at("reflectionRate"), rate.into())?;
    }
    if let Some(inside) = *inside {
        medium(path, bsdf, inside)?;
    }
    if let Some(dispersion) = material.dispersion {
        let (BsdfDesc::Dielectric { ior, .. } | BsdfDesc::RoughDielectric { ior, .. }) = *bsdf else {
            let message = "only a refractive material has a dispersion";
            return Err(Error::invalid(at("dispersion"), message));
        };
        dispersion.check(&at("dispersion"), ior.into())?;
    }
    if let Some(thin_film) = material.film {
        film(material, thin_film)?;
    }
    within(&at("opacity"), material.opacity.into(), 0.0, 1.0)?;
    check_body(material, materials)?;
    if let Some(radiance) = material.emission {
        emission(&at("emission"), radiance.to_f64(), 1.0)?;
        if radiance == Rgb::ZERO {
            material.emission = None;
        } else if !material.is_opaque() {
            let opacity = material.opacity;
            let message = format!("a material that emits light has an opacity of {opacity}, expected 1");
            return Err(Error::invalid(at("opacity"), message));
        }
    }
    material.film = material.film.filter(|film| film.thickness > 0.0);
    Ok(())
}

/// Refuses bodies of which some rays pass the surface unrefracted: refracted on their way out, they would bring more or less light
/// than entered. A body of opacity 0 is not there.
fn check_body(material: &MaterialDesc, materials: &[MaterialDesc]) -> Result<()> {
    if material.is_opaque() || material.opacity == 0.0 || material.body(materials).is_none() {
        return Ok(());
    }
    let message = format!(
        "a body that refracts light has an opacity of {}, expected 1 or 0; thin sheets of glass may have any opacity",
        material.opacity
    );
    Err(Error::invalid(join(&material.path, "opacity"), message))
}

/// Checks the film of a material.
fn film(material: &MaterialDesc, film: ThinFilmDesc) -> Result<()> {
    let at = |key: &str| join(&material.path, key);
    let has_film = matches!(
        material.bsdf,
        BsdfDesc::Dielectric { .. } | BsdfDesc::RoughDielectric { .. } | BsdfDesc::Conductor { .. }
    );
    if !has_film {
        return Err(Error::invalid(at("film"), "only a refractive material or a conductor has a thin film"));
    }
    // What a film does to a colour takes an integral over the spectrum for each colour.
    let varies = |binding: &&TextureBinding| matches!(binding.key, TextureKey::Reflectance | TextureKey::EdgeTint);
    if let Some(binding) = material.textures.iter().find(varies) {
        let message = "a metal with a thin film has the same reflectance everywhere, expected no texture";
        return Err(Error::invalid(join(&at("textures"), binding.key.name()), message));
    }
    film.check(&at("film"))
}

/// Checks the medium of a material with this model.
pub(super) fn medium(path: &str, bsdf: &BsdfDesc, medium: MediumDesc) -> Result<()> {
    if bsdf.interior().is_none() {
        let message = "only a refractive material, or a principled one that transmits and is not thin, has a medium inside; \
             expected no absorption and no priority";
        return Err(Error::invalid(join(path, "medium"), message));
    }
    absorption(&join(path, "absorption"), medium.absorption.to_f64()).map(|_| ())
}

/// Checks that the numbers of a scattering model are in range, and which of `materials` it names.
pub(super) fn model(path: &str, bsdf: &BsdfDesc, materials: &[MaterialDesc]) -> Result<()> {
    let at = |key: &str| join(path, key);
    let color = |key: &str, value: Rgb| reflectance(&at(key), value.to_f64()).map(|_| ());
    let share = |key: &str, value: f32| within(&at(key), value.into(), 0.0, 1.0).map(|_| ());
    let index = |key: &str, value: f32| positive(&at(key), value.into()).map(|_| ());
    match *bsdf {
        BsdfDesc::Black => Ok(()),
        BsdfDesc::Lambert { albedo } => color("color", albedo),
        BsdfDesc::Mirror { reflectance } => color("color", reflectance),
        BsdfDesc::OrenNayar { albedo, roughness } | BsdfDesc::Eon { albedo, roughness } => {
            color("color", albedo)?;
            share("roughness", roughness)
        }
        BsdfDesc::OrenNayarQualitative { albedo, sigma } => {
            color("color", albedo)?;
            // A right angle is excepted, because its value rounded to single precision is slightly more than one.
            if sigma == std::f32::consts::FRAC_PI_2 {
                return Ok(());
            }
            within(&at("sigmaDeg"), f64::from(sigma).to_degrees(), 0.0, 90.0).map(|_| ())
        }
        BsdfDesc::Dielectric { ior, exterior_ior } => {
            index("refractionIndex", ior)?;
            index("exteriorIndex", exterior_ior)
        }
        BsdfDesc::DiffuseTransmission { reflectance, transmittance } => {
            color("color", reflectance)?;
            color("transmittance", transmittance)?;
            let sum = reflectance + transmittance;
            match sum.to_array().iter().position(|sum| *sum > 1.0 + f32::EPSILON) {
                None => Ok(()),
                Some(i) => {
                    let sum = sum.to_array()[i];
                    let message = format!("color and transmittance sum to {sum}, expected 1 at most per channel");
                    Err(Error::invalid(at(&format!("transmittance[{i}]")), message))
                }
            }
        }
        BsdfDesc::Sheen { color: fibres, roughness } => {
            color("color", fibres)?;
            positive(&at("roughness"), roughness.into())?;
            share("roughness", roughness)
        }
        BsdfDesc::Conductor { conductor, microfacets } => {
            check_conductor(path, &conductor)?;
            check_microfacets(path, &microfacets)
        }
        BsdfDesc::RoughDielectric { ior, exterior_ior, microfacets } => {
            index("refractionIndex", ior)?;
            index("exteriorIndex", exterior_ior)?;
            check_microfacets(path, &microfacets)
        }
        BsdfDesc::ThinDielectric { ior, exterior_ior, transmittance, microfacets } => {
            index("refractionIndex", ior)?;
            index("exteriorIndex", exterior_ior)?;
            color("transmittance", transmittance)?;
            check_microfacets(path, &microfacets)
        }
        BsdfDesc::CoatedDiffuse { albedo, ior, exterior_ior, microfacets } => {
            color("color", albedo)?;
            index("refractionIndex", ior)?;
            index("exteriorIndex", exterior_ior)?;
            check_microfacets(path, &microfacets)
        }
        BsdfDesc::Principled(ref desc) => check_principled(path, desc),
        BsdfDesc::Mix { materials: parts, weight } => {
            share("weight", weight)?;
            check_parts(path, bsdf, &[("materials[0]", parts[0]), ("materials[1]", parts[1])], materials)
        }
        BsdfDesc::TwoSided { front, back } => {
            check_parts(path, bsdf, &[("front", front), ("back", back)], materials)?;
            for (key, part) in [("front", front), ("back", back)] {
                if transmits(&materials[part].bsdf, materials) {
                    let message = "a material that transmits light has both sides, expected one that does not";
                    return Err(Error::invalid(at(key), message));
                }
            }
            Ok(())
        }
    }
}

fn check_conductor(path: &str, conductor: &ConductorDesc) -> Result<()> {
    match conductor {
        ConductorDesc::Index { eta, k } => {
            for (i, (eta, k)) in eta.to_array().into_iter().zip(k.to_array()).enumerate() {
                positive(&join(path, &format!("eta[{i}]")), eta.into())?;
                within(&join(path, &format!("eta[{i}]")), eta.into(), 0.0, 1e6)?;
                within(&join(path, &format!("k[{i}]")), k.into(), 0.0, 1e6)?;
            }
            Ok(())
        }
        ConductorDesc::Reflectance { normal, edge } => {
            reflectance(&join(path, "reflectance"), normal.to_f64())?;
            reflectance(&join(path, "edgeTint"), edge.to_f64()).map(|_| ())
        }
    }
}

fn check_microfacets(path: &str, microfacets: &MicrofacetsDesc) -> Result<()> {
    let at = |key: &str| join(path, key);
    within(&at("roughness"), microfacets.roughness.into(), 0.0, 1.0)?;
    anisotropy(&at("anisotropy"), microfacets.anisotropy)?;
    rotation(&at("rotation"), microfacets.rotation)?;
    if microfacets.masking == Masking::VCavity && microfacets.multiple_scattering {
        let message = "light that is reflected more than once is known for Smith's masking only, expected false";
        return Err(Error::invalid(at("multipleScattering"), message));
    }
    Ok(())
}

/// Checks an angle of up to a whole turn, radians. A whole turn rounded to single precision may be slightly more than one.
fn rotation(path: &str, value: f32) -> Result<()> {
    let turn = f64::from(std::f32::consts::TAU);
    if f64::from(value).abs() <= turn {
        return Ok(());
    }
    // In single precision, as it was stored: the digits of a product with pi beyond these say nothing.
    within(path, f64::from(value.to_degrees()), -360.0, 360.0).map(|_| ())
}

fn anisotropy(path: &str, value: f32) -> Result<()> {
    if (0.0..=0.99).contains(&value) {
        return Ok(());
    }
    Err(Error::invalid(path, format!("{value} is out of range, expected a number in [0, 0.99]")))
}

fn check_principled(path: &str, desc: &PrincipledDesc) -> Result<()> {
    let at = |key: &str| join(path, key);
    for (key, value) in [
        ("base_weight", desc.base_weight),
        ("base_diffuse_roughness", desc.base_diffuse_roughness),
        ("base_metalness", desc.base_metalness),
        ("specular_weight", desc.specular_weight),
        ("specular_roughness", desc.specular_roughness),
        ("transmission_weight", desc.transmission_weight),
        ("coat_weight", desc.coat_weight),
        ("coat_roughness", desc.coat_roughness),
        ("coat_darkening", desc.coat_darkening),
        ("fuzz_weight", desc.fuzz_weight),
        ("fuzz_roughness", desc.fuzz_roughness),
    ] {
        within(&at(key), value.into(), 0.0, 1.0)?;
    }
    for (key, value) in [
        ("base_color", desc.base_color),
        ("specular_color", desc.specular_color),
        ("transmission_color", desc.transmission_color),
        ("coat_color", desc.coat_color),
        ("fuzz_color", desc.fuzz_color),
    ] {
        reflectance(&at(key), value.to_f64())?;
    }
    if desc.transmission_depth != 0.0 {
        positive(&at("transmission_depth"), desc.transmission_depth.into())?;
        if desc.absorption().is_some() {
            let paths = [at("transmission_color"), at("transmission_depth")];
            super::validate::transmittance(
                [&paths[0], &paths[1]],
                desc.transmission_color.to_f64().to_array(),
                desc.transmission_depth.into(),
            )?;
        }
    }
    positive(&at("fuzz_roughness"), desc.fuzz_roughness.into())?;
    positive(&at("specular_ior"), desc.specular_ior.into())?;
    if desc.specular_ior > 100.0 {
        let message = format!("{} is out of range, expected a number above 0 and up to 100", desc.specular_ior);
        return Err(Error::invalid(at("specular_ior"), message));
    }
    // Under a coat thinner than air, most light from within would be reflected where the model takes it for lost.
    within(&at("coat_ior"), desc.coat_ior.into(), 1.0, 100.0)?;
    anisotropy(&at("specular_roughness_anisotropy"), desc.specular_roughness_anisotropy)?;
    anisotropy(&at("coat_roughness_anisotropy"), desc.coat_roughness_anisotropy)?;
    rotation(&at("specular_rotation"), desc.specular_rotation)
}

/// Checks the materials that another one names: they come before it, and are not too many.
fn check_parts(path: &str, whole: &BsdfDesc, parts: &[(&str, usize)], materials: &[MaterialDesc]) -> Result<()> {
    for (key, part) in parts {
        if *part >= materials.len() {
            let message = format!("material {part} is not one of the {} that come before this one", materials.len());
            return Err(Error::invalid(join(path, key), message));
        }
    }
    for (key, part) in parts {
        let part = &materials[*part];
        let has = if part.is_opaque() { "an emission" } else { "an opacity" };
        if !part.is_opaque() || part.emission.is_some() {
            let message = format!(
                "the material '{}' has {has}, expected a part without: the whole material has one",
                elided(&part.name)
            );
            return Err(Error::invalid(join(path, key), message));
        }
    }
    let mut tally = Tally { parts: 0, counts: true, is_deep: false, smooth: Vec::new() };
    tally.add(whole, materials, 0);
    if tally.is_deep {
        let message = format!("materials name one another over more than {MOST_LEVELS} levels");
        return Err(Error::invalid(path, message));
    }
    if tally.parts > MOST_PARTS {
        let message = format!("the material consists of more than {MOST_PARTS} models");
        return Err(Error::invalid(path, message));
    }
    let mut indices = tally.smooth;
    indices.dedup();
    if let [first, second, ..] = indices[..] {
        let message = format!(
            "smooth dielectrics of the relative indices {first} and {second} refract into different directions; expected one index, \
             or rough ones"
        );
        return Err(Error::invalid(path, message));
    }
    Ok(())
}

/// What a material consists of.
struct Tally {
    parts: usize,
    /// Whether the part that is being added has any weight.
    counts: bool,
    is_deep: bool,
    /// Relative indices of smooth refracting parts.
    smooth: Vec<f32>,
}

impl Tally {
    /// Adds a part; `counts` says whether it has any weight.
    fn add_part(&mut self, part: usize, materials: &[MaterialDesc], level: usize, counts: bool) {
        let Some(material) = materials.get(part) else { return };
        let counted = self.counts;
        self.counts &= counts;
        self.add(&material.bsdf, &materials[..part], level + 1);
        self.counts = counted;
    }

    /// Notes a smooth refracting part, unless light passes it straight.
    fn refracts(&mut self, eta: f32) {
        if self.counts {
            self.smooth.push(eta);
        }
    }

    fn add(&mut self, bsdf: &BsdfDesc, materials: &[MaterialDesc], level: usize) {
        self.is_deep |= level > MOST_LEVELS;
        // Beyond these limits nothing more needs to be known.
        if self.is_deep || self.parts > MOST_PARTS {
            return;
        }
        self.parts += 1;
        match *bsdf {
            BsdfDesc::Mix { materials: [first, second], weight } => {
                self.add_part(first, materials, level, weight < 1.0);
                self.add_part(second, materials, level, weight > 0.0);
            }
            BsdfDesc::TwoSided { front, back } => {
                self.add_part(front, materials, level, true);
                self.add_part(back, materials, level, true);
            }
            BsdfDesc::Dielectric { ior, exterior_ior } => self.refracts(ior / exterior_ior),
            BsdfDesc::RoughDielectric { ior, exterior_ior, ref microfacets } if microfacets.are_smooth() => {
                self.refracts(ior / exterior_ior);
            }
            BsdfDesc::Principled(ref desc) if desc.has_inside() && desc.specular_facets().are_smooth() => {
                self.refracts(desc.clear_eta(1.0));
            }
            _ => {}
        }
    }
}

/// Whether light passes a material.
fn transmits(bsdf: &BsdfDesc, materials: &[MaterialDesc]) -> bool {
    match *bsdf {
        BsdfDesc::Dielectric { .. }
        | BsdfDesc::RoughDielectric { .. }
        | BsdfDesc::ThinDielectric { .. }
        | BsdfDesc::DiffuseTransmission { .. } => true,
        BsdfDesc::Principled(ref desc) => desc.transmission_weight > 0.0 && desc.base_metalness < 1.0,
        BsdfDesc::Mix { materials: [first, second], weight } => {
            let of = |part: usize| materials.get(part).is_some_and(|it| transmits(&it.bsdf, &materials[..part]));
            weight < 1.0 && of(first) || weight > 0.0 && of(second)
        }
        _ => false,
    }
}
