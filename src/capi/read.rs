//! From plain numbers of the host to the description's types: enumerations checked, structures read.

use super::boundary::read_sized;
use super::status::{Failure, Result};
use super::types::*;
use crate::Error;
use crate::desc::{
    BsdfDesc, CacheDesc, CacheSource, CameraDesc, FilterDesc, FovAxis, IntegratorDesc, KernelDesc, PhotonDesc,
    PhotonSharing, RadiosityDesc, RadiositySolver, RenderDesc, SamplerDesc,
};
use crate::film::ErrorMeasure;
use crate::math::{DAffine3, DMat3, DVec3};
use crate::output::ToneMap;
use crate::render::MOST_SAMPLES;
use crate::spectrum::Rgb;

/// A number that stands for no value of its enumeration.
pub(super) fn unknown<T>(name: &str, value: u32, last: u32) -> Result<T> {
    Err(Failure::argument(format!("{name} is {value}, expected 0 to {last}")))
}

/// # Safety
/// As for [`read_sized`].
pub(super) unsafe fn camera(pointer: *const etd_camera) -> Result<CameraDesc> {
    // SAFETY: passed on.
    let it = unsafe { read_sized(pointer, "camera") }?;
    let [origin, look_at, up] = [it.origin, it.look_at, it.up].map(DVec3::from_array);
    let fov_axis = match it.fov_axis {
        0 => FovAxis::Horizontal,
        1 => FovAxis::Vertical,
        other => return unknown("camera.fov_axis", other, 1),
    };
    match it.projection {
        0 => Ok(CameraDesc::Perspective { eye: origin, look_at, up, fov_deg: it.fov_deg, fov_axis }),
        1 if fov_axis == FovAxis::Vertical => {
            Err(Failure::argument("camera.fov_axis: a view-plane camera's field of view is horizontal"))
        }
        1 => Ok(CameraDesc::ViewPlane { centre: origin, look_at, up, fov_deg: it.fov_deg }),
        other => unknown("camera.projection", other, 1),
    }
}

/// The other way round.
pub(super) fn camera_out(camera: &CameraDesc) -> etd_camera {
    let (projection, origin, look_at, up, fov_deg, axis) = match *camera {
        CameraDesc::Perspective { eye, look_at, up, fov_deg, fov_axis } => (0, eye, look_at, up, fov_deg, fov_axis),
        CameraDesc::ViewPlane { centre, look_at, up, fov_deg } => {
            (1, centre, look_at, up, fov_deg, FovAxis::Horizontal)
        }
    };
    etd_camera {
        struct_size: size_of::<etd_camera>(),
        projection,
        fov_axis: u32::from(axis == FovAxis::Vertical),
        origin: origin.to_array(),
        look_at: look_at.to_array(),
        up: up.to_array(),
        fov_deg,
    }
}

/// # Safety
/// As for [`read_sized`].
pub(super) unsafe fn material(pointer: *const etd_material) -> Result<(BsdfDesc, Option<f32>)> {
    // SAFETY: passed on.
    let it = unsafe { read_sized(pointer, "material") }?;
    if it.reserved != 0 {
        return Err(Failure::argument("material.reserved is not 0"));
    }
    let color = Rgb::from_array(it.color);
    let bsdf = match it.bsdf {
        0 => BsdfDesc::Black,
        1 => BsdfDesc::Lambert { albedo: color },
        2 => BsdfDesc::OrenNayar { albedo: color, roughness: it.roughness },
        3 => BsdfDesc::OrenNayarQualitative { albedo: color, sigma: it.sigma_deg.to_radians() },
        4 => BsdfDesc::Mirror { reflectance: color },
        5 => {
            let exterior_ior = if it.exterior_ior == 0.0 { 1.0 } else { it.exterior_ior };
            BsdfDesc::Dielectric { ior: it.ior, exterior_ior }
        }
        other => return unknown("material.bsdf", other, 5),
    };
    Ok((bsdf, (it.survival != 0.0).then_some(it.survival)))
}

/// The other way round.
pub(super) fn material_out(bsdf: &BsdfDesc, survival: Option<f32>) -> etd_material {
    let mut it = etd_material {
        struct_size: size_of::<etd_material>(),
        bsdf: 0,
        color: [0.0; 3],
        roughness: 0.0,
        sigma_deg: 0.0,
        ior: 0.0,
        exterior_ior: 0.0,
        survival: survival.unwrap_or(0.0),
        reserved: 0,
    };
    match *bsdf {
        BsdfDesc::Black => {}
        BsdfDesc::Lambert { albedo } => (it.bsdf, it.color) = (1, albedo.to_array()),
        BsdfDesc::OrenNayar { albedo, roughness } => {
            (it.bsdf, it.color, it.roughness) = (2, albedo.to_array(), roughness);
        }
        BsdfDesc::OrenNayarQualitative { albedo, sigma } => {
            (it.bsdf, it.color, it.sigma_deg) = (3, albedo.to_array(), sigma.to_degrees());
        }
        BsdfDesc::Mirror { reflectance } => (it.bsdf, it.color) = (4, reflectance.to_array()),
        BsdfDesc::Dielectric { ior, exterior_ior } => {
            (it.bsdf, it.ior, it.exterior_ior) = (5, ior, exterior_ior);
        }
    }
    it
}

/// Three rows of four; all zero means none.
pub(super) fn transform(rows: &[f64; 12]) -> DAffine3 {
    if *rows == [0.0; 12] {
        return DAffine3::IDENTITY;
    }
    let column = |i: usize| DVec3::new(rows[i], rows[i + 4], rows[i + 8]);
    DAffine3::from_mat3_translation(DMat3::from_cols(column(0), column(1), column(2)), column(3))
}

/// The other way round.
pub(super) fn transform_out(transform: &DAffine3) -> [f64; 12] {
    let (m, t) = (transform.matrix3, transform.translation);
    let row = |i: usize| [m.x_axis[i], m.y_axis[i], m.z_axis[i], t[i]];
    let rows = [row(0), row(1), row(2)];
    std::array::from_fn(|i| rows[i / 4][i % 4])
}

/// Emission, where there is any.
pub(super) fn emission(radiance: [f32; 3]) -> Option<Rgb> {
    (radiance != [0.0; 3]).then(|| Rgb::from_array(radiance))
}

/// What a render block becomes; time, error and functions are looked at elsewhere.
pub(super) fn render(it: &etd_render_options, resolution: [u32; 2]) -> Result<RenderDesc> {
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
        samples: if it.samples == 0 { MOST_SAMPLES } else { it.samples },
        sampler: match it.sampler {
            0 => SamplerDesc::Sobol,
            1 => SamplerDesc::Random,
            2 => SamplerDesc::Jittered,
            3 => SamplerDesc::Grid,
            4 => SamplerDesc::Gaussian,
            other => return unknown("options.sampler", other, 4),
        },
        filter: match it.filter {
            0 => FilterDesc::Box,
            1 => FilterDesc::Tent,
            2 => FilterDesc::Gaussian { sigma: if a == 0.0 { 0.5 } else { a } },
            3 => FilterDesc::BlackmanHarris,
            4 => FilterDesc::Mitchell { b: a, c: b },
            other => return unknown("options.filter", other, 4),
        },
        integrator: match IntegratorDesc::from_c_value(it.integrator) {
            Some(integrator) => integrator,
            None => return unknown("options.integrator", it.integrator, IntegratorDesc::ALL.len() as u32 - 1),
        },
        max_depth: (it.max_depth != 0).then_some(it.max_depth),
        shadow_rays: it.shadow_rays.max(1),
        photons: photons(it)?,
        cache: cache(it)?,
        radiosity: radiosity(it)?,
        seed: it.seed,
    };
    desc.check_at("").map_err(in_options)?;
    Ok(desc)
}

/// What 0 leaves to the library.
fn given<T: PartialEq + Default>(value: T) -> Option<T> {
    (value != T::default()).then_some(value)
}

/// An `etd_switch`.
fn switch(name: &str, value: u32, default: bool) -> Result<bool> {
    match value {
        0 => Ok(default),
        1 => Ok(true),
        2 => Ok(false),
        other => unknown(name, other, 2),
    }
}

/// What is said of adaptive sampling, if anything is.
pub(super) fn adaptive(it: &etd_render_options) -> Result<Option<bool>> {
    match it.adaptive {
        0 => Ok(None),
        value => switch("options.adaptive", value, false).map(Some),
    }
}

pub(super) fn error_measure(it: &etd_render_options) -> Result<ErrorMeasure> {
    match it.error_measure {
        0 => Ok(ErrorMeasure::RelMse),
        1 => Ok(ErrorMeasure::Display),
        other => unknown("options.error_measure", other, 1),
    }
}

/// The other way round.
fn switch_out(on: bool) -> u32 {
    if on { 1 } else { 2 }
}

/// A field's complaint in the words of the interface: what a file calls `photonKernel.k` is `photon_kernel_k` here.
fn in_options(error: Error) -> Failure {
    let mut field = String::new();
    for c in error.location().json_path.chars() {
        match c {
            '.' => field.push('_'),
            c if c.is_ascii_uppercase() => field.extend(['_', c.to_ascii_lowercase()]),
            c => field.push(c),
        }
    }
    Failure::argument(format!("options.{field}: {}", error.message()))
}

/// Settings of photon maps.
fn photons(it: &etd_render_options) -> Result<PhotonDesc> {
    let default = PhotonDesc::default();
    if it.reserved != 0 || it.reserved_2 != 0 {
        return Err(Failure::argument("options.reserved is not 0"));
    }
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
        kernel: match it.photon_kernel {
            0 => None,
            1 => Some(KernelDesc::Flat),
            2 => Some(KernelDesc::Cone { k: given(it.photon_kernel_k).unwrap_or(1.0) }),
            3 => Some(KernelDesc::Epanechnikov),
            other => return unknown("options.photon_kernel", other, 3),
        },
        alpha: given(it.photon_alpha).unwrap_or(default.alpha),
        sharing: match it.photon_sharing {
            0 => PhotonSharing::Power,
            1 => PhotonSharing::Area,
            other => return unknown("options.photon_sharing", other, 1),
        },
        guided: switch("options.photons_guided", it.photons_guided, default.guided)?,
        progressive: switch("options.photons_progressive", it.photons_progressive, default.progressive)?,
        gather_rays: given(it.gather_rays).unwrap_or(default.gather_rays),
        memory: given(it.photon_memory).unwrap_or(default.memory),
    })
}

/// Settings of the irradiance cache.
fn cache(it: &etd_render_options) -> Result<CacheDesc> {
    let default = CacheDesc::default();
    Ok(CacheDesc {
        error: given(it.cache_error).unwrap_or(default.error),
        rays: given(it.cache_rays).unwrap_or(default.rays),
        min_spacing: given(it.cache_min_spacing).unwrap_or(default.min_spacing),
        max_spacing: given(it.cache_max_spacing).unwrap_or(default.max_spacing),
        source: match it.cache_source {
            0 => CacheSource::Paths,
            1 => CacheSource::Photons,
            other => return unknown("options.cache_source", other, 1),
        },
    })
}

/// Settings of radiosity.
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
        solver: match it.radiosity_solver {
            0 => RadiositySolver::Gather,
            1 => RadiositySolver::Shoot,
            other => return unknown("options.radiosity_solver", other, 1),
        },
        ambient: switch("options.radiosity_ambient", it.radiosity_ambient, default.ambient)?,
        final_gather: switch("options.radiosity_final_gather", it.radiosity_final_gather, default.final_gather)?,
        memory: given(it.radiosity_memory).unwrap_or(default.memory),
    })
}

/// The other way round.
pub(super) fn render_out(desc: &RenderDesc) -> etd_render_options {
    let (filter, filter_parameters) = match desc.filter {
        FilterDesc::Box => (0, [0.0; 2]),
        FilterDesc::Tent => (1, [0.0; 2]),
        FilterDesc::Gaussian { sigma } => (2, [sigma, 0.0]),
        FilterDesc::BlackmanHarris => (3, [0.0; 2]),
        FilterDesc::Mitchell { b, c } => (4, [b, c]),
    };
    let (photons, cache, radiosity) = (&desc.photons, &desc.cache, &desc.radiosity);
    let (photon_kernel, photon_kernel_k) = match photons.kernel {
        None => (0, 0.0),
        Some(KernelDesc::Flat) => (1, 0.0),
        Some(KernelDesc::Cone { k }) => (2, k),
        Some(KernelDesc::Epanechnikov) => (3, 0.0),
    };
    etd_render_options {
        struct_size: size_of::<etd_render_options>(),
        integrator: desc.integrator.c_value(),
        sampler: match desc.sampler {
            SamplerDesc::Sobol => 0,
            SamplerDesc::Random => 1,
            SamplerDesc::Jittered => 2,
            SamplerDesc::Grid => 3,
            SamplerDesc::Gaussian => 4,
        },
        filter,
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
        photon_kernel,
        photon_kernel_k,
        photon_sharing: match photons.sharing {
            PhotonSharing::Power => 0,
            PhotonSharing::Area => 1,
        },
        photons_guided: switch_out(photons.guided),
        photons_progressive: switch_out(photons.progressive),
        gather_rays: photons.gather_rays,
        photon_memory: photons.memory,
        cache_rays: cache.rays,
        cache_source: match cache.source {
            CacheSource::Paths => 0,
            CacheSource::Photons => 1,
        },
        reserved: 0,
        error_measure: 0,
        adaptive: 0,
        radiosity_element_size: radiosity.element_size.unwrap_or(0.0),
        radiosity_error: radiosity.error,
        radiosity_tolerance: radiosity.tolerance,
        radiosity_iterations: match radiosity.iterations {
            Some(0) => u32::MAX,
            count => count.unwrap_or(0),
        },
        radiosity_solver: match radiosity.solver {
            RadiositySolver::Gather => 0,
            RadiositySolver::Shoot => 1,
        },
        radiosity_ambient: switch_out(radiosity.ambient),
        radiosity_final_gather: switch_out(radiosity.final_gather),
        radiosity_memory: radiosity.memory,
        reserved_2: 0,
    }
}

/// A tone map.
pub(super) fn tone_map(value: u32) -> Result<ToneMap> {
    match value {
        0 => Ok(ToneMap::Clamp),
        1 => Ok(ToneMap::Maximum),
        2 => Ok(ToneMap::Reinhard),
        3 => Ok(ToneMap::Aces),
        other => unknown("options.tone_map", other, 3),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Options as the header's initialiser has them.
    fn options() -> etd_render_options {
        render_out(&RenderDesc::default())
    }

    #[test]
    fn settings_survive_the_way_out_and_back() {
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
            assert_eq!(render(&render_out(&desc), desc.resolution).ok(), Some(desc));
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
        (it.photon_kernel, it.photon_kernel_k) = (2, 0.0);
        let kernel = render(&it, resolution).ok().and_then(|desc| desc.photons.kernel);
        assert_eq!(kernel, Some(KernelDesc::Cone { k: 1.0 }));
    }
}
