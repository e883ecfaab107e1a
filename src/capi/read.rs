//! From plain numbers of the host to the description's types: enumerations checked, structures read.

use super::boundary::read_sized;
use super::status::{Failure, Result};
use super::types::*;
use crate::desc::{
    BsdfDesc, CacheDesc, CameraDesc, FilterDesc, FovAxis, IntegratorDesc, MAX_SHADOW_RAYS, PhotonDesc, RenderDesc,
    SamplerDesc,
};
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
        2 => BsdfDesc::Fujii { albedo: color, roughness: it.roughness },
        3 => {
            if !(0.0..=90.0).contains(&it.sigma_deg) {
                let message = format!("material.sigma_deg is {}, expected a number in [0, 90]", it.sigma_deg);
                return Err(Failure::argument(message));
            }
            BsdfDesc::OrenNayar { albedo: color, sigma: it.sigma_deg.to_radians() }
        }
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
        BsdfDesc::Fujii { albedo, roughness } => {
            (it.bsdf, it.color, it.roughness) = (2, albedo.to_array(), roughness);
        }
        BsdfDesc::OrenNayar { albedo, sigma } => {
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
    if it.shadow_rays > MAX_SHADOW_RAYS {
        let message = format!("options.shadow_rays is {}, expected at most {MAX_SHADOW_RAYS}", it.shadow_rays);
        return Err(Failure::argument(message));
    }
    for (name, limit) in [("time_limit", it.time_limit), ("target_error", it.target_error)] {
        if !(limit >= 0.0 && limit.is_finite()) {
            let message = format!("options.{name} is {limit}, expected 0 or a finite number above it");
            return Err(Failure::argument(message));
        }
    }
    Ok(RenderDesc {
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
        integrator: match it.integrator {
            0 => IntegratorDesc::Path,
            1 => IntegratorDesc::Whitted,
            2 => IntegratorDesc::Direct,
            3 => IntegratorDesc::PhotonDirect,
            4 => IntegratorDesc::Caustic,
            5 => IntegratorDesc::Photon,
            6 => IntegratorDesc::IrradianceCache,
            7 => IntegratorDesc::Ppm,
            8 => IntegratorDesc::Sppm,
            9 => IntegratorDesc::Auto,
            other => return unknown("options.integrator", other, 9),
        },
        max_depth: (it.max_depth != 0).then_some(it.max_depth),
        shadow_rays: it.shadow_rays.max(1),
        photons: PhotonDesc::default(),
        cache: CacheDesc::default(),
        seed: it.seed,
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
    etd_render_options {
        struct_size: size_of::<etd_render_options>(),
        integrator: match desc.integrator {
            IntegratorDesc::Path => 0,
            IntegratorDesc::Whitted => 1,
            IntegratorDesc::Direct => 2,
            IntegratorDesc::PhotonDirect => 3,
            IntegratorDesc::Caustic => 4,
            IntegratorDesc::Photon => 5,
            IntegratorDesc::IrradianceCache => 6,
            IntegratorDesc::Ppm => 7,
            IntegratorDesc::Sppm => 8,
            IntegratorDesc::Auto => 9,
        },
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
