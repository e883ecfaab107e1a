//! Opacity and emission of materials: what has to agree with surfaces, and which surfaces emit because of their material.

use std::borrow::Cow;

use crate::desc::{MaterialDesc, SceneDesc};
use crate::error::{Error, Result};

/// Returns the description in which every surface of a material that emits light has the material's emission, unless the surface
/// has one of its own. A description without such materials is returned as it is.
pub(super) fn with_emission_of_materials(desc: &SceneDesc) -> Result<Cow<'_, SceneDesc>> {
    let emits = desc.materials.iter().any(|material| material.emission.is_some());
    if !emits && desc.materials.iter().all(MaterialDesc::is_opaque) {
        return Ok(Cow::Borrowed(desc));
    }
    desc.check_looks()?;
    check_bodies(desc)?;
    if !emits {
        return Ok(Cow::Borrowed(desc));
    }
    let mut lit = desc.clone();
    for surface in &mut lit.surfaces {
        surface.emission = surface.emission.or(desc.materials[surface.material].emission);
    }
    Ok(Cow::Owned(lit))
}

/// Refuses bodies that are not opaque in a scene whose rays know the media that they are in: a ray that passes their surface would
/// not know that it is inside.
fn check_bodies(desc: &SceneDesc) -> Result<()> {
    if !desc.materials.iter().any(MaterialDesc::uses_medium) {
        return Ok(());
    }
    match desc.materials.iter().find(|material| !material.is_opaque() && material.bsdf.interior().is_some()) {
        None => Ok(()),
        Some(material) => {
            let message = format!(
                "a body has an opacity of {}, expected 1 in a scene whose media absorb or have priorities",
                material.opacity
            );
            Err(Error::invalid(format!("{}.opacity", material.path), message))
        }
    }
}
