//! Calls about measured metals and principled materials, and conversion of facets, metals and principled parameters between the
//! host's structures and descriptions.

use std::ffi::c_char;

use super::boundary::{boundary, need, on, read_sized, text, write_sized};
use super::describe::find;
use super::read::{enumeration, flag};
use super::scene::etd_scene;
use super::status::{Failure, Result, etd_status};
use super::types::*;
use crate::desc::{
    BsdfDesc,
    ConductorDesc,
    Distribution,
    METALS,
    Masking,
    Metal,
    MicrofacetsDesc,
    PrincipledDesc, //
};
use crate::spectrum::Rgb;

/// Returns the parameters of a principled material as described now.
///
/// Errors: `ETD_INVALID_ARGUMENT` for a material of another model. Thread-safe.
///
/// # Safety
/// Each pointer must be NULL or point to a value of its type.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn etd_scene_get_principled(
    scene: *const etd_scene,
    material: u32,
    out_principled: *mut etd_principled,
) -> etd_status {
    // SAFETY: the caller keeps this function's contract.
    unsafe {
        on(scene, |scene| {
            let desc = scene.desc();
            match &find(&desc.materials, material, "material")?.bsdf {
                BsdfDesc::Principled(it) => write_sized(out_principled, "out_principled", principled_out(it)),
                _ => Err(Failure::argument(format!("material {material} is not principled"))),
            }
        })
    }
}

/// Returns the complex index of refraction of a measured metal, for `eta` and `k` of an `ETD_BSDF_CONDUCTOR`.
///
/// `symbol`: Ag, Al, Au, Cr, Cu, Fe, Hg, Ir, Ni, Rh, TiN or W. `*out_eta` and `*out_k` each receive three numbers, at 650, 550
/// and 450 nm. Errors: `ETD_INVALID_ARGUMENT` for another symbol. Thread-safe.
///
/// # Safety
/// Each pointer must be NULL or point to a value of its type, and `out_eta` and `out_k` to three.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn etd_metal(symbol: *const c_char, out_eta: *mut f32, out_k: *mut f32) -> etd_status {
    boundary(None, || {
        need(out_eta, "out_eta")?;
        need(out_k, "out_k")?;
        // SAFETY: the caller keeps this function's contract.
        let symbol = unsafe { text(symbol, "symbol") }?;
        let metal = Metal::by_symbol(symbol).ok_or_else(|| {
            let known: Vec<&str> = METALS.iter().map(|metal| metal.symbol).collect();
            let given: String = symbol.chars().take(16).collect();
            Failure::argument(format!("symbol is '{given}', expected one of {}", known.join(", ")))
        })?;
        // SAFETY: both were checked, and are writable by the caller's contract.
        unsafe {
            out_eta.cast::<[f32; 3]>().write(metal.eta);
            out_k.cast::<[f32; 3]>().write(metal.k);
        }
        Ok(())
    })
}

/// Reads an angle. It is converted in double precision, as angles in files are.
fn radians(degrees: f32) -> f32 {
    f64::from(degrees).to_radians() as f32
}

fn degrees(radians: f32) -> f32 {
    f64::from(radians).to_degrees() as f32
}

/// Reads the facets of a material.
pub(super) fn facets(it: &etd_material) -> Result<MicrofacetsDesc> {
    let masking = match enumeration("material.masking", it.masking)? {
        ETD_MASKING_SMITH => Masking::Smith,
        ETD_MASKING_SMITH_SEPARABLE => Masking::SmithSeparable,
        ETD_MASKING_V_CAVITY => Masking::VCavity,
    };
    let is_single = flag("material.single_scattering", it.single_scattering)?;
    Ok(MicrofacetsDesc {
        roughness: it.roughness,
        anisotropy: it.anisotropy,
        rotation: radians(it.rotation_deg),
        distribution: match enumeration("material.distribution", it.distribution)? {
            ETD_DISTRIBUTION_GGX => Distribution::Ggx,
            ETD_DISTRIBUTION_BECKMANN => Distribution::Beckmann,
        },
        masking,
        multiple_scattering: !is_single && masking != Masking::VCavity,
    })
}

/// Converts facets to fields of the host's structure.
pub(super) fn facets_out(facets: &MicrofacetsDesc, it: &mut etd_material) {
    it.roughness = facets.roughness;
    it.anisotropy = facets.anisotropy;
    it.rotation_deg = degrees(facets.rotation);
    it.distribution = match facets.distribution {
        Distribution::Ggx => ETD_DISTRIBUTION_GGX,
        Distribution::Beckmann => ETD_DISTRIBUTION_BECKMANN,
    }
    .number();
    it.masking = match facets.masking {
        Masking::Smith => ETD_MASKING_SMITH,
        Masking::SmithSeparable => ETD_MASKING_SMITH_SEPARABLE,
        Masking::VCavity => ETD_MASKING_V_CAVITY,
    }
    .number();
    it.single_scattering = u32::from(!facets.multiple_scattering);
}

/// Reads what the facets of a metal reflect: an index, unless all of its numbers are zero.
pub(super) fn conductor(it: &etd_material) -> ConductorDesc {
    if it.eta == [0.0; 3] {
        return ConductorDesc::Reflectance { normal: Rgb::from_array(it.color), edge: Rgb::from_array(it.edge_tint) };
    }
    ConductorDesc::Index { eta: Rgb::from_array(it.eta), k: Rgb::from_array(it.k) }
}

/// Converts what the facets of a metal reflect to fields of the host's structure.
pub(super) fn conductor_out(conductor: &ConductorDesc, it: &mut etd_material) {
    match conductor {
        ConductorDesc::Index { eta, k } => (it.eta, it.k) = (eta.to_array(), k.to_array()),
        ConductorDesc::Reflectance { normal, edge } => {
            (it.color, it.edge_tint) = (normal.to_array(), edge.to_array());
        }
    }
}

/// Reads the transmittance of a thin sheet of glass: three zeros stand for clear glass, three times -1 for black.
pub(super) fn sheet(transmittance: [f32; 3]) -> Rgb {
    if transmittance == [0.0; 3] {
        Rgb::ONE
    } else if transmittance == [-1.0; 3] {
        Rgb::ZERO
    } else {
        Rgb::from_array(transmittance)
    }
}

/// Converts the transmittance of a thin sheet of glass to the host's field.
pub(super) fn sheet_out(transmittance: Rgb) -> [f32; 3] {
    if transmittance == Rgb::ZERO { [-1.0; 3] } else { transmittance.to_array() }
}

/// Reads the parameters of a principled material.
///
/// # Safety
/// The contract of [`read_sized`].
pub(super) unsafe fn principled(pointer: *const etd_principled) -> Result<PrincipledDesc> {
    // SAFETY: the caller keeps this function's contract.
    let it = unsafe { read_sized(pointer, "material.principled") }?;
    Ok(PrincipledDesc {
        base_weight: it.base_weight,
        base_color: Rgb::from_array(it.base_color),
        base_diffuse_roughness: it.base_diffuse_roughness,
        base_metalness: it.base_metalness,
        specular_weight: it.specular_weight,
        specular_color: Rgb::from_array(it.specular_color),
        specular_roughness: it.specular_roughness,
        specular_roughness_anisotropy: it.specular_roughness_anisotropy,
        specular_rotation: radians(it.specular_rotation_deg),
        specular_ior: it.specular_ior,
        transmission_weight: it.transmission_weight,
        transmission_color: Rgb::from_array(it.transmission_color),
        transmission_depth: it.transmission_depth,
        coat_weight: it.coat_weight,
        coat_color: Rgb::from_array(it.coat_color),
        coat_roughness: it.coat_roughness,
        coat_roughness_anisotropy: it.coat_roughness_anisotropy,
        coat_ior: it.coat_ior,
        coat_darkening: it.coat_darkening,
        fuzz_weight: it.fuzz_weight,
        fuzz_color: Rgb::from_array(it.fuzz_color),
        fuzz_roughness: it.fuzz_roughness,
        thin_walled: flag("material.principled.thin_walled", it.thin_walled)?,
        multiple_scattering: !flag("material.principled.single_scattering", it.single_scattering)?,
    })
}

/// Converts the parameters of a principled material to the host's structure.
fn principled_out(it: &PrincipledDesc) -> etd_principled {
    etd_principled {
        struct_size: size_of::<etd_principled>(),
        base_weight: it.base_weight,
        base_color: it.base_color.to_array(),
        base_diffuse_roughness: it.base_diffuse_roughness,
        base_metalness: it.base_metalness,
        specular_weight: it.specular_weight,
        specular_color: it.specular_color.to_array(),
        specular_roughness: it.specular_roughness,
        specular_roughness_anisotropy: it.specular_roughness_anisotropy,
        specular_rotation_deg: degrees(it.specular_rotation),
        specular_ior: it.specular_ior,
        transmission_weight: it.transmission_weight,
        transmission_color: it.transmission_color.to_array(),
        transmission_depth: it.transmission_depth,
        coat_weight: it.coat_weight,
        coat_color: it.coat_color.to_array(),
        coat_roughness: it.coat_roughness,
        coat_roughness_anisotropy: it.coat_roughness_anisotropy,
        coat_ior: it.coat_ior,
        coat_darkening: it.coat_darkening,
        fuzz_weight: it.fuzz_weight,
        fuzz_color: it.fuzz_color.to_array(),
        fuzz_roughness: it.fuzz_roughness,
        thin_walled: u32::from(it.thin_walled),
        single_scattering: u32::from(!it.multiple_scattering),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::capi::read::{material, material_out};
    use crate::desc::MaterialDesc;

    /// The description after it went out to the host's structures and came back.
    fn back(bsdf: &BsdfDesc) -> BsdfDesc {
        let mut it = material_out(&MaterialDesc { bsdf: *bsdf, ..MaterialDesc::default() });
        assert!(it.principled.is_null());
        let parameters;
        if let BsdfDesc::Principled(desc) = bsdf {
            parameters = principled_out(desc);
            it.principled = &raw const parameters;
        }
        // SAFETY: both structures live and have their sizes.
        unsafe { material(&raw const it) }.unwrap().bsdf
    }

    #[test]
    fn every_model_is_the_same_after_a_round_trip() {
        let (a, b) = (Rgb::new(0.1, 0.2, 0.3), Rgb::new(0.6, 0.5, 0.4));
        let rough = MicrofacetsDesc {
            roughness: 0.4,
            anisotropy: 0.3,
            rotation: radians(25.0),
            distribution: Distribution::Beckmann,
            masking: Masking::SmithSeparable,
            multiple_scattering: false,
        };
        let grooves = MicrofacetsDesc { masking: Masking::VCavity, ..rough };
        let smooth = MicrofacetsDesc::default();
        let mut all = vec![
            BsdfDesc::Black,
            BsdfDesc::Lambert { albedo: a },
            BsdfDesc::OrenNayar { albedo: a, roughness: 0.25 },
            BsdfDesc::OrenNayarQualitative { albedo: a, sigma: 30.0_f32.to_radians() },
            BsdfDesc::Mirror { reflectance: a },
            BsdfDesc::Dielectric { ior: 1.4, exterior_ior: 1.3 },
            BsdfDesc::Eon { albedo: a, roughness: 0.0 },
            BsdfDesc::DiffuseTransmission { reflectance: a, transmittance: b },
            BsdfDesc::DiffuseTransmission { reflectance: Rgb::ZERO, transmittance: Rgb::ZERO },
            BsdfDesc::Sheen { color: a, roughness: 0.7 },
            BsdfDesc::Mix { materials: [2, 7], weight: 0.0 },
            BsdfDesc::TwoSided { front: 3, back: 1 },
            BsdfDesc::Principled(PrincipledDesc::default()),
            BsdfDesc::Principled(PrincipledDesc {
                base_weight: 0.01,
                base_color: a,
                base_diffuse_roughness: 0.02,
                base_metalness: 0.03,
                specular_weight: 0.04,
                specular_color: b,
                specular_roughness: 0.05,
                specular_roughness_anisotropy: 0.06,
                specular_rotation: radians(-70.0),
                specular_ior: 1.07,
                transmission_weight: 0.08,
                transmission_color: Rgb::new(0.7, 0.8, 0.9),
                transmission_depth: 0.085,
                coat_weight: 0.09,
                coat_color: Rgb::new(0.71, 0.81, 0.91),
                coat_roughness: 0.10,
                coat_roughness_anisotropy: 0.11,
                coat_ior: 1.12,
                coat_darkening: 0.13,
                fuzz_weight: 0.14,
                fuzz_color: Rgb::new(0.72, 0.82, 0.92),
                fuzz_roughness: 0.15,
                thin_walled: true,
                multiple_scattering: false,
            }),
        ];
        for transmittance in [a, Rgb::ONE, Rgb::ZERO, Rgb::new(0.0, 1.0, 0.0)] {
            for microfacets in [smooth, rough, grooves] {
                all.push(BsdfDesc::ThinDielectric { ior: 1.5, exterior_ior: 1.1, transmittance, microfacets });
            }
        }
        for microfacets in [smooth, rough, grooves] {
            all.push(BsdfDesc::RoughDielectric { ior: 1.5, exterior_ior: 1.0, microfacets });
            let coat = MicrofacetsDesc { multiple_scattering: false, ..microfacets };
            all.push(BsdfDesc::CoatedDiffuse { albedo: a, ior: 1.6, exterior_ior: 1.2, microfacets: coat });
            for conductor in [
                ConductorDesc::Index { eta: a, k: Rgb::ZERO },
                ConductorDesc::Reflectance { normal: a, edge: b },
                ConductorDesc::Reflectance { normal: Rgb::ZERO, edge: Rgb::ZERO },
                METALS[2].conductor(),
            ] {
                all.push(BsdfDesc::Conductor { conductor, microfacets });
            }
        }
        for bsdf in all {
            assert_eq!(back(&bsdf), bsdf);
        }
    }

    #[test]
    fn opacity_and_emission_are_the_same_after_a_round_trip() {
        for (opacity, emission) in [(1.0, None), (0.25, None), (0.0, None), (1.0, Some(Rgb::new(0.0, 2.0, 3.0)))] {
            let desc = MaterialDesc { opacity, emission, ..MaterialDesc::default() };
            let it = material_out(&desc);
            // SAFETY: the structure lives and has its size.
            assert_eq!(unsafe { material(&raw const it) }.unwrap(), desc);
        }
        // What a program sends that knows neither is opaque and dark.
        let old = etd_material { opacity: 0.0, ..material_out(&MaterialDesc::default()) };
        // SAFETY: as above.
        assert_eq!(unsafe { material(&raw const old) }.unwrap(), MaterialDesc::default());
    }

    #[test]
    fn grooves_always_scatter_once() {
        let mut it = material_out(&MaterialDesc::default());
        (it.masking, it.single_scattering) = (ETD_MASKING_V_CAVITY.number(), 0);
        assert!(!facets(&it).unwrap().multiple_scattering);
    }
}
