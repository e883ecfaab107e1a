//! Which extensions are read. What a file requires and this library does not read refuses the file; what it only uses is named.

use super::super::json::elided;
use super::accessor::unsupported;
use super::document::Document;
use crate::Result;

/// The extensions that are read.
const KNOWN: [&str; 16] = [
    "EXT_mesh_gpu_instancing",
    "EXT_texture_webp",
    "KHR_lights_punctual",
    "KHR_materials_anisotropy",
    "KHR_materials_clearcoat",
    "KHR_materials_diffuse_transmission",
    "KHR_materials_emissive_strength",
    "KHR_materials_ior",
    "KHR_materials_pbrSpecularGlossiness",
    "KHR_materials_sheen",
    "KHR_materials_specular",
    "KHR_materials_transmission",
    "KHR_materials_unlit",
    "KHR_materials_volume",
    "KHR_mesh_quantization",
    "KHR_texture_transform",
];

/// Refuses a document that requires an extension which is not read, and warns of those that it only uses.
pub(super) fn check(document: &Document<'_>, warnings: &mut Vec<String>) -> Result<()> {
    let is_known = |name: &String| KNOWN.contains(&name.as_str());
    if let Some(i) = document.extensions_required.iter().position(|name| !is_known(name)) {
        let name = elided(&document.extensions_required[i]);
        let message = format!("the file requires the extension {name}, which this library does not read");
        return Err(unsupported(&format!("extensionsRequired[{i}]"), message));
    }
    let left_out: Vec<_> =
        document.extensions_used.iter().filter(|name| !is_known(name)).map(|it| elided(it)).collect();
    if !left_out.is_empty() {
        super::warn(warnings, format!("extensions that are not read: {}", super::listed(left_out)));
    }
    Ok(())
}
