//! Calls that give things of a scene spectra of their own.

use std::ptr;

use super::boundary::{items, on, read_sized, write_sized};
use super::describe::{find, find_surface};
use super::read::enumeration;
use super::scene::etd_scene;
use super::status::{Failure, Result, etd_status};
use super::types::{
    Enumeration, EtdSpectrumTarget, etd_illuminant, etd_spectrum, etd_spectrum_kind, etd_spectrum_target,
};
use crate::desc::{SceneDesc, SpectrumDesc, SpectrumKey, SpectrumTarget, StandardIlluminant};

/// Gives a light, an emission or a parameter of a material a spectrum of its own, or takes it away where `spectrum` is NULL, which leaves
/// the colour that the spectrum had. Renders in wavelengths use it, and others its colour. A light keeps its luminance; a surface or a
/// material without an emission gets the radiance that the spectrum says, and 1 of an illuminant.
///
/// `number`: of the surface, light or material; 0 for the environment. `etd_scene_set_material` takes the spectra of a material away.
///
/// Errors: `ETD_INVALID_SCENE` for samples that are no spectrum, for light that no one sees, for values out of the range of the parameter,
/// and for a parameter that the material does not have; `ETD_UNSUPPORTED` for a sky by a formula and for a shape that cannot emit.
/// Thread-safe.
///
/// # Safety
/// `spectrum` must be NULL or point to a value of its type, and its samples to twice `sample_count` numbers.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn etd_scene_set_spectrum(
    scene: *mut etd_scene,
    target: EtdSpectrumTarget,
    number: u32,
    spectrum: *const etd_spectrum,
) -> etd_status {
    // SAFETY: the caller keeps this function's contract.
    unsafe {
        on(scene, |scene| {
            let of = found(&scene.desc(), target, number)?;
            let value = if spectrum.is_null() { None } else { Some(described(&read_sized(spectrum, "spectrum")?)?) };
            scene.edit(|desc| desc.set_spectrum(of, value))
        })
    }
}

/// Returns the spectrum that a light, an emission or a parameter of a material has, without its samples, of which `sample_count` is the
/// number. Errors: `ETD_INVALID_ARGUMENT` for one that has none of its own. Thread-safe.
///
/// # Safety
/// Each pointer must be NULL or point to a value of its type.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn etd_scene_get_spectrum(
    scene: *const etd_scene,
    target: EtdSpectrumTarget,
    number: u32,
    out_spectrum: *mut etd_spectrum,
) -> etd_status {
    // SAFETY: the caller keeps this function's contract.
    unsafe {
        on(scene, |scene| {
            let of = found(&scene.desc(), target, number)?;
            let desc = scene.desc();
            let Some(spectrum) = desc.spectrum(of) else {
                return Err(Failure::argument(format!(
                    "target {target} of number {number} has no spectrum of its own"
                )));
            };
            write_sized(out_spectrum, "out_spectrum", plain(spectrum))
        })
    }
}

/// The target of these numbers, which exists.
fn found(desc: &SceneDesc, target: u32, number: u32) -> Result<SpectrumTarget> {
    use etd_spectrum_target::*;
    let target: etd_spectrum_target = enumeration("target", target)?;
    let index = number as usize;
    let key = match target {
        ETD_SPECTRUM_OF_SURFACE => {
            let surface = find_surface(&desc.surfaces, number)?;
            if surface.hidden {
                return Err(Failure::argument(format!("surface {number} was removed")));
            }
            return Ok(SpectrumTarget::Surface(index));
        }
        ETD_SPECTRUM_OF_POINT_LIGHT => {
            find(&desc.lights, number, "point light")?;
            return Ok(SpectrumTarget::PointLight(index));
        }
        ETD_SPECTRUM_OF_DISTANT_LIGHT => {
            find(&desc.distant_lights, number, "distant light")?;
            return Ok(SpectrumTarget::DistantLight(index));
        }
        ETD_SPECTRUM_OF_ENVIRONMENT => {
            if number != 0 || desc.environment.is_none() {
                let message = format!("there is no environment of number {number}, expected 0 in a scene that has one");
                return Err(Failure::argument(message));
            }
            return Ok(SpectrumTarget::Environment);
        }
        ETD_SPECTRUM_OF_COLOR => SpectrumKey::Color,
        ETD_SPECTRUM_OF_TRANSMITTANCE => SpectrumKey::Transmittance,
        ETD_SPECTRUM_OF_REFLECTANCE => SpectrumKey::Reflectance,
        ETD_SPECTRUM_OF_ETA => SpectrumKey::Eta,
        ETD_SPECTRUM_OF_K => SpectrumKey::K,
        ETD_SPECTRUM_OF_ABSORPTION => SpectrumKey::Absorption,
        ETD_SPECTRUM_OF_EMISSION => SpectrumKey::Emission,
    };
    find(&desc.materials, number, "material")?;
    Ok(SpectrumTarget::Material(index, key))
}

/// The description of a spectrum.
///
/// # Safety
/// `samples` must be NULL or point to twice `sample_count` numbers.
unsafe fn described(it: &etd_spectrum) -> Result<SpectrumDesc> {
    use etd_spectrum_kind::*;
    Ok(match enumeration("spectrum.kind", it.kind)? {
        ETD_SPECTRUM_SAMPLES => {
            // SAFETY: the caller keeps this function's contract.
            let samples = unsafe { items(it.samples.cast::<[f64; 2]>(), it.sample_count, "spectrum.samples") }?;
            if samples.len() > crate::desc::MOST_SPECTRUM_SAMPLES {
                let message = format!(
                    "spectrum.sample_count is {}, expected {} at most",
                    samples.len(),
                    crate::desc::MOST_SPECTRUM_SAMPLES
                );
                return Err(Failure::argument(message));
            }
            SpectrumDesc::Samples(samples.into())
        }
        ETD_SPECTRUM_ILLUMINANT => {
            let illuminant: etd_illuminant = enumeration("spectrum.illuminant", it.illuminant)?;
            SpectrumDesc::Standard(StandardIlluminant::ALL[illuminant.number() as usize].1)
        }
        ETD_SPECTRUM_DAYLIGHT => SpectrumDesc::Daylight(it.temperature),
        ETD_SPECTRUM_BLACK_BODY => SpectrumDesc::BlackBody(it.temperature),
    })
}

/// A spectrum without its samples.
fn plain(spectrum: &SpectrumDesc) -> etd_spectrum {
    let empty = etd_spectrum {
        struct_size: size_of::<etd_spectrum>(),
        kind: etd_spectrum_kind::ETD_SPECTRUM_SAMPLES.number(),
        illuminant: 0,
        temperature: 0.0,
        samples: ptr::null(),
        sample_count: 0,
    };
    match spectrum {
        SpectrumDesc::Standard(known) => {
            let place = StandardIlluminant::ALL.iter().position(|(_, it)| it == known).unwrap_or(0);
            etd_spectrum {
                kind: etd_spectrum_kind::ETD_SPECTRUM_ILLUMINANT.number(),
                illuminant: place as u32,
                ..empty
            }
        }
        SpectrumDesc::Daylight(temperature) => {
            etd_spectrum { kind: etd_spectrum_kind::ETD_SPECTRUM_DAYLIGHT.number(), temperature: *temperature, ..empty }
        }
        SpectrumDesc::BlackBody(temperature) => etd_spectrum {
            kind: etd_spectrum_kind::ETD_SPECTRUM_BLACK_BODY.number(),
            temperature: *temperature,
            ..empty
        },
        SpectrumDesc::Samples(samples) => etd_spectrum { sample_count: samples.len(), ..empty },
    }
}
