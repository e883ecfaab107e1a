//! Opacity and emission of materials: what has to agree with surfaces, and which surfaces emit because of their material.

use std::borrow::Cow;

use crate::desc::{MaterialDesc, SceneDesc, SpectrumKey};
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
    for surface in &mut lit.surfaces {
        if surface.emission.is_none() {
            // A web is of the surface's own emission.
            surface.web = None;
            let material = surface.material.map(|material| &desc.materials[material]);
            surface.emission = material.and_then(|material| material.emission);
            surface.spectrum = material.and_then(|material| material.spectrum(SpectrumKey::Emission)).cloned();
        }
    }
    Ok(Cow::Owned(lit))
}
