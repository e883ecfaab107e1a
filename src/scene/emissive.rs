//! Opacity and emission of materials: what has to agree with surfaces, and which surfaces emit because of their material.

use std::borrow::Cow;

use crate::desc::{BlockFacts, MaterialDesc, SceneDesc, SpectrumKey};
use crate::error::Result;

/// Returns the description in which every surface of a material that emits light has the material's emission, unless the surface
/// has one of its own. A description without such materials is returned as it is.
pub(super) fn with_emission_of_materials(desc: &SceneDesc) -> Result<Cow<'_, SceneDesc>> {
    let emits = desc.materials.iter().any(|material| material.emission.is_some());
    if !emits && desc.materials.iter().all(MaterialDesc::is_opaque) {
        return Ok(Cow::Borrowed(desc));
    }
    desc.check_looks()?;
    if !emits {
        return Ok(Cow::Borrowed(desc));
    }
    let mut lit = desc.clone();
    let emissive = |number: Option<usize>| desc.materials.get(number?).filter(|it| it.emission.is_some());
    let concerns = |facts: &BlockFacts| facts.shines_unevenly || facts.has(|it| emissive(it).is_some());
    let surfaces = desc.surfaces.of_blocks(concerns);
    for (number, surface) in surfaces.filter(|(_, surface)| surface.emission.is_none()) {
        let material = emissive(surface.material);
        // A web is of the surface's own emission.
        if material.is_some() || surface.web.is_some() || surface.spectrum.is_some() {
            let surface = &mut lit.surfaces[number];
            surface.web = None;
            surface.emission = material.and_then(|material| material.emission);
            surface.spectrum = material.and_then(|material| material.spectrum(SpectrumKey::Emission)).cloned();
        }
    }
    Ok(Cow::Owned(lit))
}
