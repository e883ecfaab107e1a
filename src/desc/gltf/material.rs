//! Materials: glTF's parameters as those of the principled material. `docs/gltf.md` has the table.

use std::collections::HashMap;

use super::super::json::elided;
use super::super::{
    BsdfDesc, MaterialDesc, MediumDesc, PrincipledDesc, SceneDesc, TextureBinding, TextureChannel, TextureDesc,
    TextureKey, material_check, texture_check,
};
use super::buffers::Buffers;
use super::document::{Document, Material, TextureInfo, element};
use super::material_extensions::{
    self, Anisotropy, Clearcoat, DiffuseTransmission, EmissiveStrength, Extension, Ior, Sheen, Specular,
    SpecularGlossiness, Transmission, Volume,
};
use super::mesh::COLOR;
use super::texture::{self, Slot, Textures};
use crate::control::WorkProgress;
use crate::spectrum::Rgb;
use crate::{Error, Result};

/// The reflectance of a dielectric of index 1.5 at normal incidence, by which glTF tells metals.
const DIELECTRIC: f64 = 0.04;

/// The materials of a document in a scene.
#[derive(Debug)]
pub(super) struct Materials {
    numbers: Vec<usize>,
    /// The material of primitives without one, once there is such a primitive.
    default: Option<usize>,
    /// Whether some of them have colours of vertices.
    default_has_colors: bool,
    /// Sets of texture coordinates, of materials with textures.
    uv_sets: HashMap<usize, Vec<u64>>,
    left_out: Vec<String>,
    notes: Notes,
}

impl Materials {
    /// The number of a primitive's material.
    pub fn of(&mut self, path: &str, index: Option<u64>, scene: &mut SceneDesc) -> Result<usize> {
        if let Some(index) = index {
            return Ok(*element(&self.numbers, "materials", &format!("{path}.material"), index)?.1);
        }
        if let Some(number) = self.default {
            return Ok(number);
        }
        // By the specification, a material without any key: a white rough metal.
        let bsdf = BsdfDesc::Principled(PrincipledDesc {
            base_color: Rgb::ONE,
            base_metalness: 1.0,
            specular_roughness: 1.0,
            ..PrincipledDesc::default()
        });
        let path = format!("{path}.material");
        let mut textures = Vec::new();
        if self.default_has_colors {
            let texture = scene.put_texture(TextureDesc::of_vertex_colors(String::new(), path.clone()))?;
            textures.push(TextureBinding::whole(TextureKey::BaseColor, texture));
        }
        let number = put(scene, MaterialDesc { path, bsdf, textures, ..MaterialDesc::default() })?;
        self.default = Some(number);
        Ok(number)
    }

    /// Which sets of texture coordinates the textures of a material use, in the order of their numbers in the scene.
    pub fn uv_sets(&self, material: usize) -> &[u64] {
        self.uv_sets.get(&material).map_or(&[0], Vec::as_slice)
    }

    /// Warns of what was left out of materials.
    pub fn warn(self, warnings: &mut Vec<String>) {
        self.left_out.into_iter().for_each(|warning| super::warn(warnings, warning));
        self.notes.warn(warnings);
    }
}

/// What is left out of materials: places, by the reason.
#[derive(Debug, Default)]
struct Notes {
    places: Vec<(&'static str, Vec<String>)>,
    numbers: HashMap<&'static str, usize>,
}

impl Notes {
    fn note(&mut self, why: &'static str, path: &str) {
        let number = *self.numbers.entry(why).or_insert(self.places.len());
        if number == self.places.len() {
            self.places.push((why, Vec::new()));
        }
        self.places[number].1.push(path.to_owned());
    }

    fn warn(self, warnings: &mut Vec<String>) {
        for (why, places) in self.places {
            super::warn(warnings, format!("{why}: {}", super::listed(places)));
        }
    }

    /// A number in a range; the nearest one in it, with a warning, where it is not.
    fn number(&mut self, path: &str, key: &str, value: Option<f64>, default: f64, [low, high]: [f64; 2]) -> f64 {
        let Some(value) = value else { return default };
        if !(low..=high).contains(&value) {
            const WHY: &str = "numbers of materials are out of range; the nearest ones in range are used";
            self.note(WHY, &format!("{path}.{key} ({value})"));
        }
        value.clamp(low, high)
    }

    /// A number in [0, 1].
    fn share(&mut self, path: &str, key: &str, value: Option<f64>, default: f64) -> f64 {
        self.number(path, key, value, default, [0.0, 1.0])
    }

    /// Numbers in [0, `high`].
    fn color<const N: usize>(
        &mut self,
        path: &str,
        key: &str,
        value: Option<[f64; N]>,
        default: [f64; N],
        high: f64,
    ) -> [f64; N] {
        let value = value.unwrap_or(default);
        std::array::from_fn(|i| self.number(path, &format!("{key}[{i}]"), Some(value[i]), 0.0, [0.0, high]))
    }
}

/// Adds all materials of a document.
pub(super) fn add(
    document: &Document<'_>,
    buffers: &Buffers<'_>,
    scene: &mut SceneDesc,
    work: &WorkProgress<'_>,
) -> Result<Materials> {
    let colored = colored_materials(document);
    let read = |textures, scene: &mut SceneDesc| {
        let mut reader = Reader { document, textures, notes: Notes::default() };
        let (mut numbers, mut uv_sets) = (Vec::with_capacity(document.materials.len()), HashMap::new());
        for (i, material) in document.materials.iter().enumerate() {
            let colors = colored.get(&Some(i as u64));
            reader.textures.vertex_colors = colors.is_some();
            reader.textures.vertex_opacity = colors == Some(&Alpha(true));
            let number = reader.add(&format!("materials[{i}]"), material, scene)?;
            numbers.push(number);
            let sets = std::mem::take(&mut reader.textures.uv_sets);
            uv_sets.extend(Some((number, sets)).filter(|(_, sets)| !sets.is_empty()));
        }
        Ok((reader, numbers, uv_sets))
    };
    let mut textures = Textures::new(document, buffers);
    if !document.images.is_empty() {
        // The materials are read twice: which images they use must be known, so that these are decoded together.
        let (reader, ..) = read(textures, &mut SceneDesc::default())?;
        textures = reader.textures.with_images(work)?;
    }
    let (Reader { textures, notes, .. }, numbers, uv_sets) = read(textures, scene)?;
    let default_has_colors = colored.contains_key(&None);
    Ok(Materials { numbers, default: None, default_has_colors, uv_sets, left_out: textures.warnings(), notes })
}

/// Whether colours of vertices have an opacity.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Alpha(bool);

/// The materials of primitives with colours of vertices; `None` is that of primitives without a material. A material may be of such
/// primitives and of others: these are white.
fn colored_materials(document: &Document<'_>) -> HashMap<Option<u64>, Alpha> {
    let mut colored = HashMap::new();
    for primitive in document.meshes.iter().flat_map(|mesh| &mesh.primitives) {
        let index = primitive.attributes.get(COLOR).and_then(|index| usize::try_from(*index).ok());
        let kind = index.and_then(|index| document.accessors.get(index)).map(|it| it.kind.as_str());
        if let Some(kind @ ("VEC3" | "VEC4")) = kind {
            colored.entry(primitive.material).or_insert(Alpha(false)).0 |= kind == "VEC4";
        }
    }
    colored
}

/// Checks a material and adds it. One whose name is taken has none.
fn put(scene: &mut SceneDesc, mut material: MaterialDesc) -> Result<usize> {
    material_check::check(&mut material, &scene.materials)?;
    texture_check::bindings(&material, &scene.textures, &scene.materials)?;
    if !material.name.is_empty() && scene.find_material(&material.name).is_none() {
        return scene.put_material(material);
    }
    material.name.clear();
    scene.materials.push(material);
    Ok(scene.materials.len() - 1)
}

struct Reader<'a> {
    document: &'a Document<'a>,
    textures: Textures<'a>,
    notes: Notes,
}

impl Reader<'_> {
    fn texture(&mut self, path: &str, key: &str, info: Option<&TextureInfo<'_>>, slot: Slot) -> Result<()> {
        if let Some(it) = texture::read(self.document, format!("{path}.{key}"), info, slot)? {
            self.textures.bind(it)?;
        }
        Ok(())
    }

    /// Reads a material and adds it to the scene, after the materials that it consists of.
    fn add(&mut self, path: &str, material: &Material<'_>, scene: &mut SceneDesc) -> Result<usize> {
        let mut desc = PrincipledDesc { coat_ior: 1.5, coat_darkening: 0.0, ..PrincipledDesc::default() };
        let base = self.base(path, material, &mut desc)?;
        self.textures.bind_vertex_colors(path)?;
        self.reflection(path, material, &mut desc)?;
        self.coat_and_sheen(path, material, &mut desc)?;
        let medium = self.transmission(path, material, base, &mut desc)?;
        let emission = self.emission(path, material)?;
        let opacity = self.opacity(path, material, base[3])?;
        self.texture(path, "normalTexture", material.normal_texture.as_ref(), Slot::Normal)?;
        self.texture(path, "occlusionTexture", material.occlusion_texture.as_ref(), Slot::NotDrawn)?;
        for (name, why) in [
            ("KHR_materials_iridescence", "iridescence is not drawn"),
            ("KHR_materials_dispersion", "dispersion is not drawn"),
        ] {
            if material.extensions.contains_key(name) {
                self.notes.note(why, path);
            }
        }
        self.textures.put(scene)?;
        let mut textures = std::mem::take(&mut self.textures.bindings);
        let of_base = textures.iter().find(|it| it.key == TextureKey::BaseColor).copied();
        if let Some(binding) = of_base.filter(|_| desc.transmission_weight > 0.0) {
            textures.push(TextureBinding { key: TextureKey::TransmissionColor, ..binding });
        }
        let name = material.name.clone().unwrap_or_default();
        let whole = MaterialDesc { name, path: path.to_owned(), medium, opacity, emission, ..MaterialDesc::default() };
        let mut whole = if material.extensions.contains_key("KHR_materials_unlit") {
            let has_alpha = of_base.is_some_and(|it| self.textures.has_opacity(it.texture));
            let is_opaque = whole.opacity >= 1.0 && (!has_alpha || ignores_alpha(material));
            self.unlit(path, base, of_base, is_opaque && !self.textures.vertex_colors, whole)
        } else {
            MaterialDesc { bsdf: BsdfDesc::Principled(desc), textures, ..whole }
        };
        // The alpha of a texture is an opacity where the surface may have one.
        let alpha = of_base.filter(|it| self.textures.has_opacity(it.texture));
        if let Some(binding) = alpha.filter(|_| !ignores_alpha(material)) {
            if whole.emission.is_some() || whole.body(&scene.materials).is_some() {
                self.notes.note("the opacity of textures is left out where light is emitted or refracted", path);
            } else {
                let (key, channel) = (TextureKey::Opacity, TextureChannel::Alpha);
                let mut mask = TextureBinding { key, channel, ..binding };
                let of_texture = match material.alpha_mode.as_deref() {
                    // The mask is of the product of factor and texture.
                    Some("MASK") => {
                        Some(material.alpha_cutoff.unwrap_or(0.5).max(0.0) / base[3].max(f64::MIN_POSITIVE))
                    }
                    _ => None,
                };
                whole.opacity = match of_texture {
                    None => base[3] as f32,
                    Some(cutoff) if cutoff > 1.0 => 0.0,
                    Some(_) => 1.0,
                };
                mask.cutoff = of_texture.filter(|cutoff| *cutoff <= 1.0).unwrap_or(0.0) as f32;
                if of_texture.is_none_or(|cutoff| cutoff > 0.0 && cutoff <= 1.0) {
                    whole.textures.push(mask);
                }
            }
        }
        if whole.opacity < 1.0 && whole.emission.is_some() {
            self.notes.note("materials that emit light are opaque", path);
            whole.opacity = 1.0;
        }
        if whole.opacity < 1.0 && whole.opacity > 0.0 && whole.body(&scene.materials).is_some() {
            self.notes.note("bodies that refract light are opaque", path);
            whole.opacity = 1.0;
        }
        if whole.emission.is_some() && material.double_sided {
            self.notes.note("light is emitted on the front alone of double-sided materials", path);
        }
        if !matches!(whole.bsdf, BsdfDesc::Principled(_)) {
            return put(scene, whole);
        }
        self.with_diffuse_transmission(path, material, whole, scene)
    }

    /// The base colour with its alpha, metalness and roughness, by either set of parameters.
    fn base(&mut self, path: &str, material: &Material<'_>, desc: &mut PrincipledDesc) -> Result<[f64; 4]> {
        if let Some((path, it)) = material_extensions::read::<SpecularGlossiness<'_>>(path, &material.extensions)? {
            return self.specular_glossiness(&path, &it, desc);
        }
        let path = format!("{path}.pbrMetallicRoughness");
        let it = material.pbr_metallic_roughness.as_ref();
        let color = self.notes.color(&path, "baseColorFactor", it.and_then(|it| it.base_color_factor), [1.0; 4], 1.0);
        desc.base_color = rgb(color);
        desc.base_metalness =
            self.notes.share(&path, "metallicFactor", it.and_then(|it| it.metallic_factor), 1.0) as f32;
        desc.specular_roughness =
            self.notes.share(&path, "roughnessFactor", it.and_then(|it| it.roughness_factor), 1.0) as f32;
        if let Some(it) = it {
            self.texture(&path, "baseColorTexture", it.base_color_texture.as_ref(), Slot::BaseColor)?;
            let of_both = it.metallic_roughness_texture.as_ref();
            self.texture(&path, "metallicRoughnessTexture", of_both, Slot::MetallicRoughness)?;
        }
        Ok(color)
    }

    /// Parameters of diffuse and specular reflection as those of a metal and a dielectric, by the formulas of the extension's
    /// authors: the metalness is the one for which both give the same brightness of both reflections.
    fn specular_glossiness(
        &mut self,
        path: &str,
        it: &SpecularGlossiness<'_>,
        desc: &mut PrincipledDesc,
    ) -> Result<[f64; 4]> {
        let diffuse = self.notes.color(path, "diffuseFactor", it.diffuse_factor, [1.0; 4], 1.0);
        let specular = self.notes.color(path, "specularFactor", it.specular_factor, [1.0; 3], 1.0);
        let glossiness = self.notes.share(path, "glossinessFactor", it.glossiness_factor, 1.0);
        self.texture(path, "diffuseTexture", it.diffuse_texture.as_ref(), Slot::BaseColor)?;
        self.texture(path, "specularGlossinessTexture", it.specular_glossiness_texture.as_ref(), Slot::NotDrawn)?;
        let brightness = |c: [f64; 3]| (0.299 * c[0] * c[0] + 0.587 * c[1] * c[1] + 0.114 * c[2] * c[2]).sqrt();
        let not_specular = 1.0 - specular.into_iter().fold(0.0, f64::max);
        let [of_diffuse, of_specular] = [brightness([diffuse[0], diffuse[1], diffuse[2]]), brightness(specular)];
        let metalness = if of_specular < DIELECTRIC {
            0.0
        } else {
            let b = of_diffuse * not_specular / (1.0 - DIELECTRIC) + of_specular - 2.0 * DIELECTRIC;
            let c = DIELECTRIC - of_specular;
            let root = (b * b - 4.0 * DIELECTRIC * c).max(0.0).sqrt();
            ((root - b) / (2.0 * DIELECTRIC)).clamp(0.0, 1.0)
        };
        let color = |i: usize| {
            let as_dielectric = diffuse[i] * not_specular / (1.0 - DIELECTRIC) / (1.0 - metalness).max(1e-6);
            let as_metal = (specular[i] - DIELECTRIC * (1.0 - metalness)) / metalness.max(1e-6);
            let share = metalness * metalness;
            (as_dielectric + share * (as_metal - as_dielectric)).clamp(0.0, 1.0)
        };
        let base = [color(0), color(1), color(2), diffuse[3]];
        desc.base_color = rgb(base);
        desc.base_metalness = metalness as f32;
        desc.specular_roughness = (1.0 - glossiness) as f32;
        Ok(base)
    }

    /// Index of refraction, strength and colour of reflection, anisotropy.
    fn reflection(&mut self, path: &str, material: &Material<'_>, desc: &mut PrincipledDesc) -> Result<()> {
        let mut ior = 1.5;
        if let Some((path, it)) = material_extensions::read::<Ior<'_>>(path, &material.extensions)? {
            // An index of 0 stands for an infinite one, which reflects everything.
            ior = match it.ior {
                Some(0.0) => 100.0,
                given => self.notes.number(&path, "ior", given, 1.5, [1.0, 100.0]),
            };
        }
        if let Some((path, it)) = material_extensions::read::<Specular<'_>>(path, &material.extensions)? {
            let factor = self.notes.share(&path, "specularFactor", it.specular_factor, 1.0);
            let color =
                self.notes.color(&path, "specularColorFactor", it.specular_color_factor, [1.0; 3], f64::from(f32::MAX));
            self.texture(&path, "specularTexture", it.specular_texture.as_ref(), Slot::SpecularWeight)?;
            self.texture(&path, "specularColorTexture", it.specular_color_texture.as_ref(), Slot::NotDrawn)?;
            if color[0] != color[1] || color[1] != color[2] {
                self.notes
                    .note("the colour of reflection is taken for its mean", &format!("{path}.specularColorFactor"));
            }
            let strength = color.iter().map(|channel| channel / 3.0).sum::<f64>();
            if strength <= 1.0 {
                desc.specular_weight = (factor * strength) as f32;
            } else {
                // A weight cannot exceed 1, so that the index of refraction takes the rest.
                desc.specular_weight = factor as f32;
                let reflected = ((ior - 1.0) / (ior + 1.0) * strength.sqrt()).min(0.98);
                ior = (1.0 + reflected) / (1.0 - reflected);
            }
        }
        desc.specular_ior = ior as f32;
        if let Some((path, it)) = material_extensions::read::<Anisotropy<'_>>(path, &material.extensions)? {
            let strength = self.notes.share(&path, "anisotropyStrength", it.anisotropy_strength, 0.0);
            self.texture(&path, "anisotropyTexture", it.anisotropy_texture.as_ref(), Slot::NotDrawn)?;
            // Both widths as glTF has them give the roughness and the anisotropy that have these widths.
            let alpha = f64::from(desc.specular_roughness).powi(2);
            let along = alpha + (1.0 - alpha) * strength * strength;
            if strength > 0.0 && along > 0.0 {
                let anisotropy = (1.0 - alpha / along).clamp(0.0, 0.99);
                let share = 1.0 - anisotropy;
                desc.specular_roughness_anisotropy = anisotropy as f32;
                desc.specular_roughness = (along / (2.0 / (1.0 + share * share)).sqrt()).sqrt().min(1.0) as f32;
                desc.specular_rotation = (it.anisotropy_rotation.unwrap_or(0.0) % std::f64::consts::TAU) as f32;
            }
        }
        Ok(())
    }

    fn coat_and_sheen(&mut self, path: &str, material: &Material<'_>, desc: &mut PrincipledDesc) -> Result<()> {
        if let Some((path, it)) = material_extensions::read::<Clearcoat<'_>>(path, &material.extensions)? {
            desc.coat_weight = self.notes.share(&path, "clearcoatFactor", it.clearcoat_factor, 0.0) as f32;
            desc.coat_roughness =
                self.notes.share(&path, "clearcoatRoughnessFactor", it.clearcoat_roughness_factor, 0.0) as f32;
            self.texture(&path, "clearcoatTexture", it.clearcoat_texture.as_ref(), Slot::Coat)?;
            self.texture(
                &path,
                "clearcoatRoughnessTexture",
                it.clearcoat_roughness_texture.as_ref(),
                Slot::CoatRoughness,
            )?;
            self.texture(&path, "clearcoatNormalTexture", it.clearcoat_normal_texture.as_ref(), Slot::NotDrawn)?;
        }
        if let Some((path, it)) = material_extensions::read::<Sheen<'_>>(path, &material.extensions)? {
            let color = self.notes.color(&path, "sheenColorFactor", it.sheen_color_factor, [0.0; 3], 1.0);
            let roughness = self.notes.share(&path, "sheenRoughnessFactor", it.sheen_roughness_factor, 0.0);
            self.texture(&path, "sheenColorTexture", it.sheen_color_texture.as_ref(), Slot::SheenColor)?;
            self.texture(&path, "sheenRoughnessTexture", it.sheen_roughness_texture.as_ref(), Slot::SheenRoughness)?;
            // glTF's fibres take light from what is below by the largest channel of their colour.
            let weight = color.into_iter().fold(0.0, f64::max);
            if weight > 0.0 {
                desc.fuzz_weight = weight as f32;
                desc.fuzz_color = rgb(color.map(|channel| channel / weight));
                // Smooth fibres have no limit; this is as smooth as they can be told from it.
                desc.fuzz_roughness = roughness.max(0.01) as f32;
            }
        }
        Ok(())
    }

    /// Light that passes the surface, and the medium behind it.
    fn transmission(
        &mut self,
        path: &str,
        material: &Material<'_>,
        base: [f64; 4],
        desc: &mut PrincipledDesc,
    ) -> Result<Option<MediumDesc>> {
        let Some((at, it)) = material_extensions::read::<Transmission<'_>>(path, &material.extensions)? else {
            if material.extensions.contains_key(Volume::NAME) {
                self.notes.note("a volume behind a surface that light does not pass clearly is left out", path);
            }
            return Ok(None);
        };
        desc.transmission_weight = self.notes.share(&at, "transmissionFactor", it.transmission_factor, 0.0) as f32;
        self.texture(&at, "transmissionTexture", it.transmission_texture.as_ref(), Slot::Transmission)?;
        desc.transmission_color = rgb(base);
        desc.thin_walled = true;
        let Some((at, it)) = material_extensions::read::<Volume<'_>>(path, &material.extensions)? else {
            return Ok(None);
        };
        let most = f64::from(f32::MAX);
        let thickness = self.notes.number(&at, "thicknessFactor", it.thickness_factor, 0.0, [0.0, most]);
        self.texture(&at, "thicknessTexture", it.thickness_texture.as_ref(), Slot::NotDrawn)?;
        // A thickness of 0 is a thin sheet. Of any other, rays find how thick a body is.
        desc.thin_walled = thickness == 0.0;
        let color = self.notes.color(&at, "attenuationColor", it.attenuation_color, [1.0; 3], 1.0);
        let Some(distance) = it.attenuation_distance.filter(|_| desc.has_inside()) else { return Ok(None) };
        let distance = self.notes.number(&at, "attenuationDistance", Some(distance), 0.0, [1e-6, most]);
        // Black would absorb without any limit.
        let absorption = color.map(|left| (-left.max(1e-6).ln() / distance).min(1e30) as f32 + 0.0);
        let medium = MediumDesc { absorption: Rgb::from_array(absorption), priority: 0 };
        Ok((medium != MediumDesc::default()).then_some(medium))
    }

    fn emission(&mut self, path: &str, material: &Material<'_>) -> Result<Option<Rgb>> {
        let factor = self.notes.color(path, "emissiveFactor", material.emissive_factor, [0.0; 3], 1.0);
        let mut strength = 1.0;
        if let Some((path, it)) = material_extensions::read::<EmissiveStrength<'_>>(path, &material.extensions)? {
            strength =
                self.notes.number(&path, "emissiveStrength", it.emissive_strength, 1.0, [0.0, f64::from(f32::MAX)]);
        }
        let radiance = rgb(factor.map(|channel| channel * strength));
        if radiance == Rgb::ZERO {
            return Ok(None);
        }
        if let Some(texture) = &material.emissive_texture {
            self.texture(path, "emissiveTexture", Some(texture), Slot::Emission)?;
            if self.textures.bindings.iter().all(|binding| binding.key != TextureKey::Emission) {
                // Without its texture, which is dark in most places, all of the surface would shine.
                return Ok(None);
            }
        }
        Ok(Some(radiance))
    }

    fn opacity(&mut self, path: &str, material: &Material<'_>, alpha: f64) -> Result<f32> {
        match material.alpha_mode.as_deref() {
            None | Some("OPAQUE") => Ok(1.0),
            Some("BLEND") => Ok(alpha as f32),
            Some("MASK") => {
                let cutoff =
                    self.notes.number(path, "alphaCutoff", material.alpha_cutoff, 0.5, [0.0, f64::from(f32::MAX)]);
                Ok(if alpha >= cutoff { 1.0 } else { 0.0 })
            }
            Some(other) => {
                let message = format!("unknown name '{}', expected OPAQUE, MASK or BLEND", elided(other));
                Err(Error::invalid(format!("{path}.alphaMode"), message))
            }
        }
    }

    /// A surface that shows its colour whatever the light: it emits this colour and reflects nothing. Where that cannot be, because
    /// what emits has to be opaque and takes no colours of vertices, it is a diffuse surface.
    fn unlit(
        &mut self,
        path: &str,
        base: [f64; 4],
        of_base: Option<TextureBinding>,
        can_emit: bool,
        whole: MaterialDesc,
    ) -> MaterialDesc {
        let whole = MaterialDesc { medium: None, ..whole };
        if !can_emit {
            self.notes.note("unlit materials that are not opaque, or have colours of vertices, are diffuse", path);
            let textures = of_base.into_iter().map(|it| TextureBinding { key: TextureKey::Color, ..it }).collect();
            return MaterialDesc { bsdf: BsdfDesc::Lambert { albedo: rgb(base) }, emission: None, textures, ..whole };
        }
        let textures = of_base.into_iter().map(|it| TextureBinding { key: TextureKey::Emission, ..it }).collect();
        MaterialDesc { bsdf: BsdfDesc::Black, emission: Some(rgb(base)), textures, ..whole }
    }

    /// Adds a material. A part of its diffuse light passes, where it has the extension for that: it is then mixed with a sheet that
    /// only transmits.
    fn with_diffuse_transmission(
        &mut self,
        path: &str,
        material: &Material<'_>,
        whole: MaterialDesc,
        scene: &mut SceneDesc,
    ) -> Result<usize> {
        let read = material_extensions::read::<DiffuseTransmission<'_>>(path, &material.extensions)?;
        let Some((at, it)) = read else { return put(scene, whole) };
        let factor = self.notes.share(&at, "diffuseTransmissionFactor", it.diffuse_transmission_factor, 0.0);
        let given = it.diffuse_transmission_color_factor;
        let color = self.notes.color(&at, "diffuseTransmissionColorFactor", given, [1.0; 3], 1.0);
        self.texture(&at, "diffuseTransmissionTexture", it.diffuse_transmission_texture.as_ref(), Slot::NotDrawn)?;
        let of_color = it.diffuse_transmission_color_texture.as_ref();
        self.texture(&at, "diffuseTransmissionColorTexture", of_color, Slot::NotDrawn)?;
        if factor == 0.0 {
            return put(scene, whole);
        }
        let part = |bsdf| MaterialDesc { path: path.to_owned(), bsdf, ..MaterialDesc::default() };
        let mut whole = whole;
        // Normals and opacity are those of the mixture.
        let (of_surface, of_model) = whole.textures.drain(..).partition(|it| it.key.is_of_surface());
        whole.textures = of_surface;
        let first = put(scene, MaterialDesc { medium: whole.medium, textures: of_model, ..part(whole.bsdf) })?;
        let transmittance = rgb(color);
        let second = put(scene, part(BsdfDesc::DiffuseTransmission { reflectance: Rgb::ZERO, transmittance }))?;
        let bsdf = BsdfDesc::Mix { materials: [first, second], weight: factor as f32 };
        put(scene, MaterialDesc { bsdf, medium: None, ..whole })
    }
}

/// The colour of the first three channels.
fn rgb<const N: usize>(channels: [f64; N]) -> Rgb {
    Rgb::from_array(std::array::from_fn(|i| channels[i].min(f64::from(f32::MAX)) as f32))
}

/// Whether the alpha of a material means nothing.
fn ignores_alpha(material: &Material<'_>) -> bool {
    matches!(material.alpha_mode.as_deref(), None | Some("OPAQUE"))
}
