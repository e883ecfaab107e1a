//! Edits that give things of a scene spectra of their own.

use super::edit::none_such;
use super::json::join;
use super::{SceneDesc, SpectrumDesc, SpectrumKey};
use crate::math::DVec3;
use crate::spectrum::Rgb;
use crate::{Error, Result};

/// What can have a spectrum of its own.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SpectrumTarget {
    /// The emission of the surface of this number.
    Surface(usize),
    /// The point light of this number, of any distribution.
    PointLight(usize),
    /// The distant light of this number.
    DistantLight(usize),
    /// The environment, unless it is a sky by a formula.
    Environment,
    /// A parameter of the material of this number.
    Material(usize, SpectrumKey),
}

impl SceneDesc {
    /// Gives a light, an emission or a parameter of a material a spectrum of its own, or takes it away, which leaves the colour that the
    /// spectrum had. A light keeps its luminance and gets the colour of the spectrum; surfaces and materials without an emission get the
    /// radiance that the spectrum says, and 1 of an illuminant.
    ///
    /// # Errors
    /// [`crate::ErrorKind::InvalidScene`] for a spectrum that does not serve, and for a number that nothing has; [`crate::ErrorKind::Unsupported`] for
    /// a sky by a formula, and those of [`Self::set_emission`] and [`Self::set_material_desc`]. The description is then as it was.
    pub fn set_spectrum(&mut self, of: SpectrumTarget, spectrum: Option<SpectrumDesc>) -> Result<()> {
        match of {
            SpectrumTarget::Surface(number) => self.set_surface_spectrum(number, spectrum),
            SpectrumTarget::PointLight(number) => {
                let count = self.lights.len();
                let Some(known) = self.lights.get(number) else {
                    return Err(none_such(&format!("lights[{number}]"), "point light", number, count));
                };
                let edited = super::PointLightDesc { spectrum, ..known.clone() };
                self.set_light_desc(number, edited)
            }
            SpectrumTarget::DistantLight(number) => {
                let count = self.distant_lights.len();
                let Some(known) = self.distant_lights.get(number) else {
                    return Err(none_such(&format!("distant[{number}]"), "distant light", number, count));
                };
                let edited = super::DistantLightDesc { spectrum, ..known.clone() };
                self.set_distant_light(number, edited)
            }
            SpectrumTarget::Environment => {
                let Some(known) = &self.environment else {
                    return Err(Error::invalid("environment", "there is no environment that could have a spectrum"));
                };
                let edited = super::EnvironmentDesc { spectrum, ..known.clone() };
                self.set_environment_desc(Some(edited))
            }
            SpectrumTarget::Material(number, key) => {
                let count = self.materials.len();
                let Some(known) = self.materials.get(number) else {
                    return Err(none_such(&format!("materials[{number}]"), "material", number, count));
                };
                let mut edited = known.clone();
                edited.spectra.retain(|(known, _)| *known != key);
                edited.spectra.extend(spectrum.map(|spectrum| (key, spectrum)));
                edited.spectra.sort_by_key(|(key, _)| *key);
                self.set_material_desc(number, edited)
            }
        }
    }

    /// Gives the emission of a surface a spectrum of its own, or the smooth one of its colour again. The emission keeps its luminance and gets
    /// the colour of the spectrum; a surface without an emission gets the radiance that the spectrum says, and 1 of an illuminant.
    ///
    /// # Errors
    /// At `surfaces[..].spectrum`, [`crate::ErrorKind::InvalidScene`] for light that no one sees; those of [`Self::set_emission`].
    pub(super) fn set_surface_spectrum(&mut self, surface: usize, spectrum: Option<SpectrumDesc>) -> Result<()> {
        let known = self.live_surface(surface)?;
        if let Some(spectrum) = &spectrum {
            spectrum.check(&join(&known.path, "spectrum"))?;
            let light = spectrum.light(&join(&known.path, "spectrum"))?;
            let emission = known.emission;
            let before = self.surfaces[surface].spectrum.take();
            let dressed = Rgb::from_f64(light.dress(emission.map(Rgb::to_f64)));
            if let Err(error) = self.set_emission(surface, Some(dressed)) {
                self.surfaces[surface].spectrum = before;
                return Err(error);
            }
        }
        self.surfaces[surface].spectrum = spectrum;
        Ok(())
    }

    /// The spectrum that something has; `None` where it has none of its own, and where there is no such thing.
    pub fn spectrum(&self, of: SpectrumTarget) -> Option<&SpectrumDesc> {
        match of {
            SpectrumTarget::Surface(number) => self.surfaces.get(number)?.spectrum.as_ref(),
            SpectrumTarget::PointLight(number) => self.lights.get(number)?.spectrum.as_ref(),
            SpectrumTarget::DistantLight(number) => self.distant_lights.get(number)?.spectrum.as_ref(),
            SpectrumTarget::Environment => self.environment.as_ref()?.spectrum.as_ref(),
            SpectrumTarget::Material(number, key) => self.materials.get(number)?.spectrum(key),
        }
    }
}

/// The colour of a spectrum with the luminance of this light.
pub(super) fn dressed(path: &str, spectrum: Option<&SpectrumDesc>, light: Rgb) -> Result<Rgb> {
    let Some(spectrum) = spectrum else { return Ok(light) };
    let path = join(path, "spectrum");
    spectrum.check(&path)?;
    let dressed: DVec3 = spectrum.light(&path)?.dress(Some(light.to_f64()));
    Ok(Rgb::from_f64(dressed))
}
