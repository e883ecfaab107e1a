//! Conversion between the plain structures of the host and the types of descriptions, with checks of enumerations.

use super::boundary::read_sized;
use super::material::{conductor, conductor_out, facets, facets_out, principled, sheet, sheet_out};
use super::status::{Failure, Result};
use super::types::*;
use crate::Error;
use crate::desc::{
    BsdfDesc, CacheDesc, CacheSource, CropDesc, Dispersion, FilterDesc, IntegratorDesc, KernelDesc, MaterialDesc,
    MediumDesc, PhotonDesc, PhotonSharing, RadiosityDesc, RadiositySolver, RenderDesc, RouletteDesc, SamplerDesc,
    ThinFilmDesc,
};
use crate::film::ErrorMeasure;
use crate::math::{DAffine3, DMat3, DVec3};
use crate::output::ToneMap;
use crate::render::MOST_SAMPLES;
use crate::spectrum::{Rgb, Sensor};

/// Converts a number of the host to a value of an enumeration. `name` is the name of the field or argument, for messages.
pub(super) fn enumeration<T: Enumeration>(name: &str, number: u32) -> Result<T> {
    let value = T::ALL.iter().copied().find(|value| value.number() == number);
    value.ok_or_else(|| {
        let last = T::ALL.last().map_or(0, |last| last.number());
        Failure::argument(format!("{name} is {number}, expected 0 to {last}"))
    })
}

/// Reads a number that says no (0) or yes (1). `name` is as for [`enumeration`].
pub(super) fn flag(name: &str, number: u32) -> Result<bool> {
    match number {
        0 => Ok(false),
        1 => Ok(true),
        _ => Err(Failure::argument(format!("{name} is {number}, expected 0 or 1"))),
    }
}

/// # Safety
/// The contract of [`read_sized`], for the structure and for the principled parameters that it points to.
pub(super) unsafe fn material(pointer: *const etd_material) -> Result<MaterialDesc> {
    // SAFETY: the caller keeps this function's contract.
    let it = unsafe { read_sized(pointer, "material") }?;
    for (name, reserved) in [("reserved", it.reserved), ("reserved_1", it.reserved_1)] {
        if reserved != 0 {
            return Err(Failure::argument(format!("material.{name} is not 0")));
        }
    }
    let color = Rgb::from_array(it.color);
    let dispersion = dispersion(&it)?;
    let stated = dispersion.and_then(|dispersion| dispersion.own_index());
    let it = etd_material { ior: stated.map_or(it.ior, |ior| ior as f32), ..it };
    let outside = given(it.exterior_ior).unwrap_or(1.0);
    let bsdf = match enumeration("material.bsdf", it.bsdf)? {
        ETD_BSDF_BLACK => BsdfDesc::Black,
        ETD_BSDF_LAMBERT => BsdfDesc::Lambert { albedo: color },
        ETD_BSDF_OREN_NAYAR => BsdfDesc::OrenNayar { albedo: color, roughness: it.roughness },
        ETD_BSDF_OREN_NAYAR_QUALITATIVE => {
            BsdfDesc::OrenNayarQualitative { albedo: color, sigma: it.sigma_deg.to_radians() }
        }
        ETD_BSDF_MIRROR => BsdfDesc::Mirror { reflectance: color },
        ETD_BSDF_DIELECTRIC => BsdfDesc::Dielectric { ior: it.ior, exterior_ior: outside },
        ETD_BSDF_EON => BsdfDesc::Eon { albedo: color, roughness: it.roughness },
        ETD_BSDF_DIFFUSE_TRANSMISSION => {
            BsdfDesc::DiffuseTransmission { reflectance: color, transmittance: Rgb::from_array(it.transmittance) }
        }
        ETD_BSDF_SHEEN => BsdfDesc::Sheen { color, roughness: given(it.roughness).unwrap_or(0.5) },
        ETD_BSDF_CONDUCTOR => BsdfDesc::Conductor { conductor: conductor(&it), microfacets: facets(&it)? },
        ETD_BSDF_ROUGH_DIELECTRIC => {
            BsdfDesc::RoughDielectric { ior: it.ior, exterior_ior: outside, microfacets: facets(&it)? }
        }
        ETD_BSDF_THIN_DIELECTRIC => {
            let (transmittance, microfacets) = (sheet(it.transmittance), facets(&it)?);
            BsdfDesc::ThinDielectric { ior: it.ior, exterior_ior: outside, transmittance, microfacets }
        }
        ETD_BSDF_COATED_DIFFUSE => {
            // The coat's facets scatter light once, in files too.
            let microfacets = facets(&etd_material { single_scattering: 1, ..it })?;
            BsdfDesc::CoatedDiffuse { albedo: color, ior: it.ior, exterior_ior: outside, microfacets }
        }
        // SAFETY: the caller keeps this function's contract.
        ETD_BSDF_PRINCIPLED => BsdfDesc::Principled(unsafe { principled(it.principled) }?),
        ETD_BSDF_MIX => {
            BsdfDesc::Mix { materials: [it.first as usize, it.second as usize], weight: it.weight } //
        }
        ETD_BSDF_TWO_SIDED => BsdfDesc::TwoSided { front: it.first as usize, back: it.second as usize },
    };
    // What a principled body absorbs is said by its parameters.
    let stated = if matches!(bsdf, BsdfDesc::Principled(_)) { [0.0; 3] } else { it.absorption };
    let medium = MediumDesc { absorption: Rgb::from_array(stated), priority: it.priority };
    let has_medium = bsdf.interior().is_some() && medium != MediumDesc::default();
    Ok(MaterialDesc {
        bsdf,
        survival: given(it.survival),
        medium: has_medium.then_some(medium),
        dispersion,
        // NaN is a thickness that is refused.
        film: (it.film_thickness != 0.0).then_some(ThinFilmDesc { thickness: it.film_thickness, ior: it.film_ior }),
        opacity: if it.opacity == -1.0 { 0.0 } else { given(it.opacity).unwrap_or(1.0) },
        emission: emission(it.emission),
        ..MaterialDesc::default()
    })
}

/// Reads how the index of a material depends on the wavelength.
fn dispersion(it: &etd_material) -> Result<Option<Dispersion>> {
    let (strengths, resonances) = (it.sellmeier_strengths, it.sellmeier_resonances);
    if strengths == [0.0; 4] && resonances == [0.0; 4] {
        return Ok((it.abbe != 0.0).then_some(Dispersion::Abbe(it.abbe)));
    }
    if it.abbe != 0.0 {
        let message = format!("material.abbe is {}, expected 0 beside sellmeier_strengths", it.abbe);
        return Err(Failure::argument(message));
    }
    Ok(Some(Dispersion::Sellmeier { strengths, resonances }))
}

/// Converts a material to the host's structure.
pub(super) fn material_out(material: &MaterialDesc) -> etd_material {
    let medium = material.medium.unwrap_or_default();
    let (abbe, sellmeier_strengths, sellmeier_resonances) = match material.dispersion {
        None => (0.0, [0.0; 4], [0.0; 4]),
        Some(Dispersion::Abbe(number)) => (number, [0.0; 4], [0.0; 4]),
        Some(Dispersion::Sellmeier { strengths, resonances }) => (0.0, strengths, resonances),
    };
    let mut it = etd_material {
        struct_size: size_of::<etd_material>(),
        bsdf: ETD_BSDF_BLACK.number(),
        color: [0.0; 3],
        roughness: 0.0,
        sigma_deg: 0.0,
        ior: 0.0,
        exterior_ior: 0.0,
        survival: material.survival.unwrap_or(0.0),
        reserved: 0,
        absorption: medium.absorption.to_array(),
        priority: medium.priority,
        anisotropy: 0.0,
        rotation_deg: 0.0,
        distribution: ETD_DISTRIBUTION_GGX.number(),
        masking: ETD_MASKING_SMITH.number(),
        single_scattering: 0,
        transmittance: [0.0; 3],
        eta: [0.0; 3],
        k: [0.0; 3],
        edge_tint: [0.0; 3],
        first: 0,
        second: 0,
        weight: 0.0,
        principled: std::ptr::null(),
        opacity: if material.opacity == 0.0 { -1.0 } else { material.opacity },
        emission: emission_out(material.emission),
        abbe,
        sellmeier_strengths,
        sellmeier_resonances,
        reserved_1: 0,
        film_thickness: material.film.map_or(0.0, |film| film.thickness),
        film_ior: material.film.map_or(0.0, |film| film.ior),
    };
    let model = match material.bsdf {
        BsdfDesc::Black => ETD_BSDF_BLACK,
        BsdfDesc::Lambert { albedo } => {
            it.color = albedo.to_array();
            ETD_BSDF_LAMBERT
        }
        BsdfDesc::OrenNayar { albedo, roughness } => {
            (it.color, it.roughness) = (albedo.to_array(), roughness);
            ETD_BSDF_OREN_NAYAR
        }
        BsdfDesc::OrenNayarQualitative { albedo, sigma } => {
            (it.color, it.sigma_deg) = (albedo.to_array(), sigma.to_degrees());
            ETD_BSDF_OREN_NAYAR_QUALITATIVE
        }
        BsdfDesc::Mirror { reflectance } => {
            it.color = reflectance.to_array();
            ETD_BSDF_MIRROR
        }
        BsdfDesc::Dielectric { ior, exterior_ior } => {
            (it.ior, it.exterior_ior) = (ior, exterior_ior);
            ETD_BSDF_DIELECTRIC
        }
        BsdfDesc::Eon { albedo, roughness } => {
            (it.color, it.roughness) = (albedo.to_array(), roughness);
            ETD_BSDF_EON
        }
        BsdfDesc::DiffuseTransmission { reflectance, transmittance } => {
            (it.color, it.transmittance) = (reflectance.to_array(), transmittance.to_array());
            ETD_BSDF_DIFFUSE_TRANSMISSION
        }
        BsdfDesc::Sheen { color, roughness } => {
            (it.color, it.roughness) = (color.to_array(), roughness);
            ETD_BSDF_SHEEN
        }
        BsdfDesc::Conductor { ref conductor, ref microfacets } => {
            conductor_out(conductor, &mut it);
            facets_out(microfacets, &mut it);
            ETD_BSDF_CONDUCTOR
        }
        BsdfDesc::RoughDielectric { ior, exterior_ior, ref microfacets } => {
            (it.ior, it.exterior_ior) = (ior, exterior_ior);
            facets_out(microfacets, &mut it);
            ETD_BSDF_ROUGH_DIELECTRIC
        }
        BsdfDesc::ThinDielectric { ior, exterior_ior, transmittance, ref microfacets } => {
            (it.ior, it.exterior_ior, it.transmittance) = (ior, exterior_ior, sheet_out(transmittance));
            facets_out(microfacets, &mut it);
            ETD_BSDF_THIN_DIELECTRIC
        }
        BsdfDesc::CoatedDiffuse { albedo, ior, exterior_ior, ref microfacets } => {
            (it.color, it.ior, it.exterior_ior) = (albedo.to_array(), ior, exterior_ior);
            facets_out(microfacets, &mut it);
            ETD_BSDF_COATED_DIFFUSE
        }
        BsdfDesc::Principled(_) => ETD_BSDF_PRINCIPLED,
        BsdfDesc::Mix { materials: [first, second], weight } => {
            (it.first, it.second, it.weight) = (first as u32, second as u32, weight);
            ETD_BSDF_MIX
        }
        BsdfDesc::TwoSided { front, back } => {
            (it.first, it.second) = (front as u32, back as u32);
            ETD_BSDF_TWO_SIDED
        }
    };
    it.bsdf = model.number();
    it
}

/// Reads a transform, three rows of four numbers. Twelve zeros stand for the identity.
pub(super) fn transform(rows: &[f64; 12]) -> DAffine3 {
    if *rows == [0.0; 12] {
        return DAffine3::IDENTITY;
    }
    let column = |i: usize| DVec3::new(rows[i], rows[i + 4], rows[i + 8]);
    DAffine3::from_mat3_translation(DMat3::from_cols(column(0), column(1), column(2)), column(3))
}

/// Converts a transform to three rows of four numbers.
pub(super) fn transform_out(transform: &DAffine3) -> [f64; 12] {
    let (m, t) = (transform.matrix3, transform.translation);
    let row = |i: usize| [m.x_axis[i], m.y_axis[i], m.z_axis[i], t[i]];
    let rows = [row(0), row(1), row(2)];
    std::array::from_fn(|i| rows[i / 4][i % 4])
}

/// Reads an emission; three zeros stand for none.
pub(super) fn emission(radiance: [f32; 3]) -> Option<Rgb> {
    (radiance != [0.0; 3]).then(|| Rgb::from_array(radiance))
}

/// Converts an emission to the host's field.
pub(super) fn emission_out(emission: Option<Rgb>) -> [f32; 3] {
    emission.map_or([0.0; 3], |radiance| radiance.to_array())
}

/// Reads the size of the picture for a film of this size, and the part of it that the film is, where it is not all of it.
fn picture(it: &etd_render_options, film: [u32; 2]) -> Result<([u32; 2], Option<CropDesc>)> {
    let picture = [it.picture_width, it.picture_height];
    if picture == [0; 2] {
        for (name, value) in [("crop_left", it.crop_left), ("crop_top", it.crop_top)] {
            if value != 0 {
                let message = format!("options.{name} is {value}, expected 0 without picture_width and picture_height");
                return Err(Failure::argument(message));
            }
        }
        return Ok((film, None));
    }
    let [width, height] = film;
    for (name, first, length, whole) in
        [("width", it.crop_left, width, it.picture_width), ("height", it.crop_top, height, it.picture_height)]
    {
        if u64::from(first) + u64::from(length) > u64::from(whole) {
            let message = format!(
                "options.picture_{name} is {whole}, expected a picture that holds the film's {length} pixels from {first} on"
            );
            return Err(Failure::argument(message));
        }
    }
    let crop = CropDesc { left: it.crop_left, top: it.crop_top, width, height };
    Ok((picture, (picture != film).then_some(crop)))
}

/// Reads the render settings of a description from options, for a film of this size. Time limit, target error and callbacks are no
/// part of them.
pub(super) fn render(it: &etd_render_options, film: [u32; 2]) -> Result<RenderDesc> {
    let (resolution, crop) = picture(it, film)?;
    let [a, b] = it.filter_parameters;
    let is_limited = it.time_limit > 0.0 || it.target_error > 0.0;
    if it.samples == 0 && !is_limited {
        return Err(Failure::argument("options.samples is 0, and neither time_limit nor target_error ends the render"));
    }
    for (name, limit) in [("time_limit", it.time_limit), ("target_error", it.target_error)] {
        if !(limit >= 0.0 && limit.is_finite()) {
            let message = format!("options.{name} is {limit}, expected 0 or a finite number above it");
            return Err(Failure::argument(message));
        }
    }
    let desc = RenderDesc {
        resolution,
        crop,
        samples: if it.samples == 0 { MOST_SAMPLES } else { it.samples },
        sampler: match enumeration("options.sampler", it.sampler)? {
            ETD_SAMPLER_SOBOL => SamplerDesc::Sobol,
            ETD_SAMPLER_RANDOM => SamplerDesc::Random,
            ETD_SAMPLER_JITTERED => SamplerDesc::Jittered,
            ETD_SAMPLER_GRID => SamplerDesc::Grid,
            ETD_SAMPLER_GAUSSIAN => SamplerDesc::Gaussian,
        },
        filter: match enumeration("options.filter", it.filter)? {
            ETD_FILTER_BOX => FilterDesc::Box,
            ETD_FILTER_TENT => FilterDesc::Tent,
            ETD_FILTER_GAUSSIAN => FilterDesc::Gaussian { sigma: if a == 0.0 { 0.5 } else { a } },
            ETD_FILTER_BLACKMAN_HARRIS => FilterDesc::BlackmanHarris,
            ETD_FILTER_MITCHELL => FilterDesc::Mitchell { b: a, c: b },
        },
        integrator: match IntegratorDesc::from_c_value(it.integrator) {
            Some(integrator) => integrator,
            None => {
                let last = IntegratorDesc::ALL.iter().map(|integrator| integrator.c_value()).max().unwrap_or(0);
                let message = format!("options.integrator is {}, expected 0 to {last}", it.integrator);
                return Err(Failure::argument(message));
            }
        },
        reuse: switch("options.reuse", it.reuse)?,
        light_paths: switch("options.light_paths", it.light_paths)?,
        allow_bias: switch("options.allow_bias", it.allow_bias)?.unwrap_or(false),
        spectral: switch("options.spectral", it.spectral)?.unwrap_or(false),
        white_balance: (it.white_balance != [0.0; 2]).then_some(it.white_balance),
        max_depth: (it.max_depth != 0).then_some(it.max_depth),
        shadow_rays: it.shadow_rays.max(1),
        first_shadow_rays: given(it.first_shadow_rays),
        roulette: match enumeration("options.roulette", it.roulette)? {
            ETD_ROULETTE_OWN => RouletteDesc::Own,
            ETD_ROULETTE_FILE => RouletteDesc::File,
        },
        photons: photons(it)?,
        cache: cache(it)?,
        radiosity: radiosity(it)?,
        seed: it.seed,
    };
    desc.check_at("").map_err(in_options)?;
    Ok(desc)
}

/// Reads what the channels of a film of wavelengths are.
pub(super) fn sensor(it: &etd_render_options) -> Sensor {
    if it.sensor_bands == [0.0; 2] { Sensor::Observer } else { Sensor::Bands { range: it.sensor_bands } }
}

/// Returns `None` for 0, which stands for the default.
fn given<T: PartialEq + Default>(value: T) -> Option<T> {
    (value != T::default()).then_some(value)
}

/// Reads an `etd_switch`; `None` stands for the field's default.
fn switch(name: &str, number: u32) -> Result<Option<bool>> {
    Ok(match enumeration(name, number)? {
        ETD_SWITCH_DEFAULT => None,
        ETD_SWITCH_ON => Some(true),
        ETD_SWITCH_OFF => Some(false),
    })
}

/// Converts a setting to an `etd_switch`.
fn switch_out(on: bool) -> u32 {
    let switch = if on { ETD_SWITCH_ON } else { ETD_SWITCH_OFF };
    switch.number()
}

/// Reads whether sampling is adaptive; `None` stands for the default.
pub(super) fn adaptive(it: &etd_render_options) -> Result<Option<bool>> {
    switch("options.adaptive", it.adaptive)
}

pub(super) fn error_measure(it: &etd_render_options) -> Result<ErrorMeasure> {
    Ok(match enumeration("options.error_measure", it.error_measure)? {
        ETD_ERROR_RELMSE => ErrorMeasure::RelMse,
        ETD_ERROR_DISPLAY => ErrorMeasure::Display,
    })
}

/// Converts an error about a key of a file to one about a field of the options: `photonKernel.k` becomes `photon_kernel_k`.
pub(super) fn in_options(error: Error) -> Failure {
    let mut field = String::new();
    for c in error.location().json_path.chars() {
        match c {
            '.' => field.push('_'),
            c if c.is_ascii_uppercase() => field.extend(['_', c.to_ascii_lowercase()]),
            c => field.push(c),
        }
    }
    // All filters have their parameters in one array.
    let field = match field.as_str() {
        "filter_sigma" | "filter_b" => "filter_parameters[0]",
        "filter_c" => "filter_parameters[1]",
        "max_angle" => "max_angle_deg",
        "integrator_first_shadow_rays" => "first_shadow_rays",
        field => field,
    };
    Failure::argument(format!("options.{field}: {}", error.message()))
}

/// Reads the settings of photon maps.
fn photons(it: &etd_render_options) -> Result<PhotonDesc> {
    let default = PhotonDesc::default();
    Ok(PhotonDesc {
        count: given(it.photon_count),
        radius: given(it.photon_radius),
        min_photons: given(it.min_photons).unwrap_or(default.min_photons),
        caustic_count: given(it.caustic_count),
        caustic_radius: given(it.caustic_radius),
        neighbours: match it.photon_neighbours {
            u32::MAX => Some(0),
            given_count => given(given_count),
        },
        kernel: match enumeration("options.photon_kernel", it.photon_kernel)? {
            ETD_PHOTON_KERNEL_DEFAULT => None,
            ETD_PHOTON_KERNEL_FLAT => Some(KernelDesc::Flat),
            ETD_PHOTON_KERNEL_CONE => Some(KernelDesc::Cone { k: given(it.photon_kernel_k).unwrap_or(1.0) }),
            ETD_PHOTON_KERNEL_EPANECHNIKOV => Some(KernelDesc::Epanechnikov),
        },
        alpha: given(it.photon_alpha).unwrap_or(default.alpha),
        sharing: match enumeration("options.photon_sharing", it.photon_sharing)? {
            ETD_PHOTON_SHARING_POWER => PhotonSharing::Power,
            ETD_PHOTON_SHARING_AREA => PhotonSharing::Area,
        },
        guided: switch("options.photons_guided", it.photons_guided)?.unwrap_or(default.guided),
        progressive: switch("options.photons_progressive", it.photons_progressive)?.unwrap_or(default.progressive),
        gather_rays: given(it.gather_rays).unwrap_or(default.gather_rays),
        memory: given(it.photon_memory).unwrap_or(default.memory),
    })
}

/// Reads the settings of the irradiance cache.
fn cache(it: &etd_render_options) -> Result<CacheDesc> {
    let default = CacheDesc::default();
    Ok(CacheDesc {
        error: given(it.cache_error).unwrap_or(default.error),
        rays: given(it.cache_rays).unwrap_or(default.rays),
        min_spacing: given(it.cache_min_spacing).unwrap_or(default.min_spacing),
        max_spacing: given(it.cache_max_spacing).unwrap_or(default.max_spacing),
        source: match enumeration("options.cache_source", it.cache_source)? {
            ETD_CACHE_SOURCE_PATHS => CacheSource::Paths,
            ETD_CACHE_SOURCE_PHOTONS => CacheSource::Photons,
        },
    })
}

/// Reads the settings of radiosity.
fn radiosity(it: &etd_render_options) -> Result<RadiosityDesc> {
    let default = RadiosityDesc::default();
    Ok(RadiosityDesc {
        element_size: given(it.radiosity_element_size),
        error: given(it.radiosity_error).unwrap_or(default.error),
        iterations: match it.radiosity_iterations {
            u32::MAX => Some(0),
            count => given(count),
        },
        tolerance: given(it.radiosity_tolerance).unwrap_or(default.tolerance),
        solver: match enumeration("options.radiosity_solver", it.radiosity_solver)? {
            ETD_RADIOSITY_SOLVER_GATHER => RadiositySolver::Gather,
            ETD_RADIOSITY_SOLVER_SHOOT => RadiositySolver::Shoot,
        },
        ambient: switch("options.radiosity_ambient", it.radiosity_ambient)?.unwrap_or(default.ambient),
        final_gather: switch("options.radiosity_final_gather", it.radiosity_final_gather)?
            .unwrap_or(default.final_gather),
        memory: given(it.radiosity_memory).unwrap_or(default.memory),
    })
}

/// Converts render settings to the host's options.
pub(super) fn render_out(desc: &RenderDesc) -> etd_render_options {
    let (filter, filter_parameters) = match desc.filter {
        FilterDesc::Box => (ETD_FILTER_BOX, [0.0; 2]),
        FilterDesc::Tent => (ETD_FILTER_TENT, [0.0; 2]),
        FilterDesc::Gaussian { sigma } => (ETD_FILTER_GAUSSIAN, [sigma, 0.0]),
        FilterDesc::BlackmanHarris => (ETD_FILTER_BLACKMAN_HARRIS, [0.0; 2]),
        FilterDesc::Mitchell { b, c } => (ETD_FILTER_MITCHELL, [b, c]),
    };
    let ([picture_width, picture_height], [crop_left, crop_top]) =
        desc.crop.map_or(([0; 2], [0; 2]), |crop| (desc.resolution, [crop.left, crop.top]));
    let (photons, cache, radiosity) = (&desc.photons, &desc.cache, &desc.radiosity);
    let (photon_kernel, photon_kernel_k) = match photons.kernel {
        None => (ETD_PHOTON_KERNEL_DEFAULT, 0.0),
        Some(KernelDesc::Flat) => (ETD_PHOTON_KERNEL_FLAT, 0.0),
        Some(KernelDesc::Cone { k }) => (ETD_PHOTON_KERNEL_CONE, k),
        Some(KernelDesc::Epanechnikov) => (ETD_PHOTON_KERNEL_EPANECHNIKOV, 0.0),
    };
    etd_render_options {
        struct_size: size_of::<etd_render_options>(),
        picture_width,
        picture_height,
        crop_left,
        crop_top,
        integrator: desc.integrator.c_value(),
        sampler: match desc.sampler {
            SamplerDesc::Sobol => ETD_SAMPLER_SOBOL,
            SamplerDesc::Random => ETD_SAMPLER_RANDOM,
            SamplerDesc::Jittered => ETD_SAMPLER_JITTERED,
            SamplerDesc::Grid => ETD_SAMPLER_GRID,
            SamplerDesc::Gaussian => ETD_SAMPLER_GAUSSIAN,
        }
        .number(),
        filter: filter.number(),
        filter_parameters,
        samples: desc.samples,
        max_depth: desc.max_depth.unwrap_or(0),
        shadow_rays: desc.shadow_rays,
        seed: desc.seed,
        time_limit: 0.0,
        target_error: 0.0,
        progress: None,
        finished: None,
        user_data: std::ptr::null_mut(),
        photon_radius: photons.radius.unwrap_or(0.0),
        caustic_radius: photons.caustic_radius.unwrap_or(0.0),
        photon_alpha: photons.alpha,
        cache_error: cache.error,
        cache_min_spacing: cache.min_spacing,
        cache_max_spacing: cache.max_spacing,
        photon_count: photons.count.unwrap_or(0),
        caustic_count: photons.caustic_count.unwrap_or(0),
        min_photons: photons.min_photons,
        photon_neighbours: match photons.neighbours {
            Some(0) => u32::MAX,
            count => count.unwrap_or(0),
        },
        photon_kernel: photon_kernel.number(),
        photon_kernel_k,
        photon_sharing: match photons.sharing {
            PhotonSharing::Power => ETD_PHOTON_SHARING_POWER,
            PhotonSharing::Area => ETD_PHOTON_SHARING_AREA,
        }
        .number(),
        photons_guided: switch_out(photons.guided),
        photons_progressive: switch_out(photons.progressive),
        gather_rays: photons.gather_rays,
        photon_memory: photons.memory,
        cache_rays: cache.rays,
        cache_source: match cache.source {
            CacheSource::Paths => ETD_CACHE_SOURCE_PATHS,
            CacheSource::Photons => ETD_CACHE_SOURCE_PHOTONS,
        }
        .number(),
        spectral: switch_out(desc.spectral),
        white_balance: desc.white_balance.unwrap_or_default(),
        sensor_bands: [0.0; 2],
        reuse: desc.reuse.map_or(ETD_SWITCH_DEFAULT.number(), switch_out),
        light_paths: desc.light_paths.map_or(ETD_SWITCH_DEFAULT.number(), switch_out),
        share_number: 0,
        share_count: 0,
        checkpoint_file: std::ptr::null(),
        checkpoint_seconds: 0.0,
        resume: std::ptr::null(),
        first_shadow_rays: desc.first_shadow_rays.unwrap_or(0),
        allow_bias: if desc.allow_bias { ETD_SWITCH_ON } else { ETD_SWITCH_DEFAULT }.number(),
        error_measure: ETD_ERROR_RELMSE.number(),
        adaptive: ETD_SWITCH_DEFAULT.number(),
        radiosity_element_size: radiosity.element_size.unwrap_or(0.0),
        radiosity_error: radiosity.error,
        radiosity_tolerance: radiosity.tolerance,
        radiosity_iterations: match radiosity.iterations {
            Some(0) => u32::MAX,
            count => count.unwrap_or(0),
        },
        radiosity_solver: match radiosity.solver {
            RadiositySolver::Gather => ETD_RADIOSITY_SOLVER_GATHER,
            RadiositySolver::Shoot => ETD_RADIOSITY_SOLVER_SHOOT,
        }
        .number(),
        radiosity_ambient: switch_out(radiosity.ambient),
        radiosity_final_gather: switch_out(radiosity.final_gather),
        radiosity_memory: radiosity.memory,
        roulette: match desc.roulette {
            RouletteDesc::Own => ETD_ROULETTE_OWN,
            RouletteDesc::File => ETD_ROULETTE_FILE,
        }
        .number(),
    }
}

/// Reads a tone map.
pub(super) fn tone_map(number: u32) -> Result<ToneMap> {
    Ok(match enumeration("options.tone_map", number)? {
        ETD_TONE_MAP_CLAMP => ToneMap::Clamp,
        ETD_TONE_MAP_MAXIMUM => ToneMap::Maximum,
        ETD_TONE_MAP_REINHARD => ToneMap::Reinhard,
        ETD_TONE_MAP_ACES => ToneMap::Aces,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Options as the header's initialiser has them.
    fn options() -> etd_render_options {
        render_out(&RenderDesc::default())
    }

    #[test]
    fn settings_are_the_same_after_a_round_trip() {
        let bare = RenderDesc { resolution: [3, 2], ..RenderDesc::default() };
        let (photons, cache) = (PhotonDesc::default(), CacheDesc::default());
        let all = PhotonDesc {
            count: Some(crate::desc::MAX_PHOTONS),
            radius: Some(0.1),
            min_photons: 1,
            caustic_count: Some(3),
            caustic_radius: Some(1e-18),
            neighbours: Some(60),
            kernel: Some(KernelDesc::Cone { k: 1.1 }),
            alpha: 0.7,
            sharing: PhotonSharing::Area,
            guided: false,
            progressive: false,
            gather_rays: 1024,
            memory: 1,
        };
        let cached = CacheDesc {
            error: 0.3, //
            rays: 16,
            min_spacing: 0.7,
            max_spacing: 1.0,
            source: CacheSource::Photons,
        };
        let solved = RadiosityDesc {
            element_size: Some(0.2),
            error: 0.5,
            iterations: Some(0),
            tolerance: 1e-3,
            solver: RadiositySolver::Shoot,
            ambient: true,
            final_gather: true,
            memory: 7,
        };
        let mut all_kinds = vec![RenderDesc { photons: all, cache: cached, radiosity: solved, ..bare.clone() }];
        all_kinds.push(RenderDesc { roulette: RouletteDesc::File, ..bare.clone() });
        let crop = Some(CropDesc { left: 1, top: 0, width: 2, height: 1 });
        all_kinds.push(RenderDesc { crop, ..bare.clone() });
        let iterations = RadiosityDesc { iterations: Some(3), ..RadiosityDesc::default() };
        all_kinds.push(RenderDesc { radiosity: iterations, ..bare.clone() });
        for integrator in IntegratorDesc::ALL {
            all_kinds.push(RenderDesc { integrator, photons: photons.clone(), cache: cache.clone(), ..bare.clone() });
        }
        for kernel in [None, Some(KernelDesc::Flat), Some(KernelDesc::Cone { k: 1.0 }), Some(KernelDesc::Epanechnikov)]
        {
            all_kinds.push(RenderDesc { photons: PhotonDesc { kernel, ..photons.clone() }, ..bare.clone() });
        }
        for desc in all_kinds {
            assert_eq!(render(&render_out(&desc), desc.film_size()).ok(), Some(desc));
        }
    }

    #[test]
    fn zeros_are_defaults() {
        let mut it = options();
        it.photon_alpha = 0.0;
        (it.cache_error, it.cache_min_spacing, it.cache_max_spacing) = (0.0, 0.0, 0.0);
        (it.min_photons, it.gather_rays, it.photon_memory, it.cache_rays) = (0, 0, 0, 0);
        (it.photons_guided, it.photons_progressive) = (0, 0);
        (it.radiosity_error, it.radiosity_tolerance, it.radiosity_memory) = (0.0, 0.0, 0);
        (it.radiosity_ambient, it.radiosity_final_gather) = (0, 0);
        let resolution = RenderDesc::default().resolution;
        assert_eq!(render(&it, resolution).ok(), Some(RenderDesc::default()));
        (it.photon_kernel, it.photon_kernel_k) = (ETD_PHOTON_KERNEL_CONE.number(), 0.0);
        let kernel = render(&it, resolution).ok().and_then(|desc| desc.photons.kernel);
        assert_eq!(kernel, Some(KernelDesc::Cone { k: 1.0 }));
    }

    #[test]
    fn numbers_without_a_value_are_refused_by_name() {
        for bsdf in etd_bsdf::ALL {
            assert_eq!(enumeration::<etd_bsdf>("material.bsdf", bsdf.number()).ok(), Some(*bsdf));
        }
        let refused = enumeration::<etd_bsdf>("material.bsdf", 16).unwrap_err();
        assert_eq!(refused.message, "material.bsdf is 16, expected 0 to 15");
        let refused = render(&etd_render_options { roulette: 2, ..options() }, [1, 1]).unwrap_err();
        assert_eq!(refused.message, "options.roulette is 2, expected 0 to 1");
    }
}
