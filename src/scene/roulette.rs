//! Selects the survival probability that Russian roulette uses at the materials of a scene.
//!
//! The choice is made once for a render, not for each ray. Integrators use [`Material::survival`] wherever it is given;
//! a scene whose paths end by the library's own roulette gives none.

use std::sync::Arc;

use super::{Material, Scene};
use crate::desc::{RouletteDesc, SceneDesc};

/// The survival probabilities that a description's materials state, if any of them states one. The last is that of surfaces
/// without a material, which end all paths.
pub(super) fn stated_survival(desc: &SceneDesc) -> Option<Arc<[Option<f32>]>> {
    let states_one = desc.materials.iter().any(|material| material.survival.is_some());
    states_one.then(|| desc.materials.iter().map(|material| material.survival).chain([None]).collect())
}

impl Scene {
    /// Returns the same scene with this roulette for its paths. Geometry and emitters are shared; if the scene's
    /// materials state no survival probability, the whole scene is shared.
    ///
    /// [`Scene::build`] and [`Scene::rebuild`] use the roulette of the description's render settings;
    /// [`crate::render::Render`] uses the roulette of its own settings.
    #[must_use]
    pub fn with_roulette(&self, roulette: RouletteDesc) -> Self {
        let mut scene = self.clone();
        if let Some(stated) = &self.stated_survival {
            let with = |(material, stated): (&Material, &Option<f32>)| {
                let survival = match roulette {
                    RouletteDesc::Own => None,
                    RouletteDesc::File => *stated,
                };
                material.clone().with_survival(survival)
            };
            scene.materials = self.materials.iter().zip(stated.iter()).map(with).collect();
        }
        scene
    }
}
