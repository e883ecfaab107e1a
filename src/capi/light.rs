//! Calls that describe point lights which do not shine the same in all directions.
//!
//! They are numbered among the point lights. `etd_scene_set_point_light` moves and dims any of them, and
//! `etd_scene_get_point_light` says where it is.

use std::ffi::{c_char, c_void};
use std::path::Path;
use std::ptr;
use std::sync::Arc;

use super::boundary::{items, need, on, read_sized, text, write_sized};
use super::describe::find;
use super::scene::etd_scene;
use super::status::{Failure, Result, etd_status};
use super::types::{etd_spot_light, etd_web_light};
use crate::desc::{LightDistribution, PointLightDesc, SpotDesc, WebDesc};
use crate::math::DVec3;
use crate::photometry::Web;
use crate::spectrum::Rgb;

/// Adds a spot light. `*out_light` receives the light's number among point lights.
///
/// Errors: `ETD_INVALID_SCENE` for a direction of length 0 and for angles out of their range. Thread-safe.
///
/// # Safety
/// Each pointer must be NULL or point to a value of its type.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn etd_scene_add_spot_light(
    scene: *mut etd_scene,
    spot: *const etd_spot_light,
    out_light: *mut u32,
) -> etd_status {
    // SAFETY: the caller keeps this function's contract.
    unsafe {
        on(scene, |scene| {
            need(out_light, "out_light")?;
            let light = spot_light(&read_sized(spot, "spot")?);
            let number = scene.edit(|desc| desc.add_light_desc(light))?;
            out_light.write(number as u32);
            Ok(())
        })
    }
}

/// Makes a point light of any kind a spot light. The errors are those of `etd_scene_add_spot_light`. Thread-safe.
///
/// # Safety
/// Each pointer must be NULL or point to a value of its type.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn etd_scene_set_spot_light(
    scene: *mut etd_scene,
    light: u32,
    spot: *const etd_spot_light,
) -> etd_status {
    // SAFETY: the caller keeps this function's contract.
    unsafe {
        on(scene, |scene| {
            let spectrum = find(&scene.desc().lights, light, "point light")?.spectrum.clone();
            let value = PointLightDesc { spectrum, ..spot_light(&read_sized(spot, "spot")?) };
            scene.edit(|desc| desc.set_light_desc(light as usize, value))
        })
    }
}

/// Returns a spot light as described now. Errors: `ETD_INVALID_ARGUMENT` for a point light that is none. Thread-safe.
///
/// # Safety
/// Each pointer must be NULL or point to a value of its type.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn etd_scene_get_spot_light(
    scene: *const etd_scene,
    light: u32,
    out_spot: *mut etd_spot_light,
) -> etd_status {
    // SAFETY: the caller keeps this function's contract.
    unsafe {
        on(scene, |scene| {
            let desc = scene.desc();
            let it = find(&desc.lights, light, "point light")?;
            let LightDistribution::Spot(spot) = &it.distribution else {
                return Err(Failure::argument(format!("point light {light} is not a spot light")));
            };
            let value = etd_spot_light {
                struct_size: size_of::<etd_spot_light>(),
                position: it.position.to_array(),
                direction: spot.direction.to_array(),
                intensity: it.intensity.to_array(),
                outer_cone_deg: spot.outer_deg,
                inner_cone_deg: spot.inner_deg,
            };
            write_sized(out_spot, "out_spot", value)
        })
    }
}

/// Adds a measured lamp. `*out_light` receives the light's number among point lights.
///
/// Errors: `ETD_INVALID_ARGUMENT` for neither a file nor a text, or both; `ETD_IO` for a file that cannot be read; `ETD_INVALID_SCENE` for
/// contents that are of neither format or wrong, with the line, and for a direction of length 0. Thread-safe.
///
/// # Safety
/// Each pointer must be NULL or point to a value of its type, `file` to a text with a NUL at its end and `text` to `text_bytes` bytes.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn etd_scene_add_web_light(
    scene: *mut etd_scene,
    web: *const etd_web_light,
    out_light: *mut u32,
) -> etd_status {
    // SAFETY: the caller keeps this function's contract.
    unsafe {
        on(scene, |scene| {
            need(out_light, "out_light")?;
            let it = read_sized(web, "web")?;
            let path = format!("lights[{}]", scene.desc().lights.len());
            let web = contents(it.file, it.text, it.text_bytes, &path)?
                .ok_or_else(|| Failure::argument("web.file and web.text are NULL, expected one of them".to_owned()))?;
            let number = scene.edit(|desc| desc.add_light_desc(web_light(&it, web)))?;
            out_light.write(number as u32);
            Ok(())
        })
    }
}

/// Makes a point light of any kind a measured lamp, or changes one: without a file and a text, it keeps its intensities. The errors
/// are those of `etd_scene_add_web_light`, and `ETD_INVALID_ARGUMENT` for a light that has no intensities to keep. Thread-safe.
///
/// # Safety
/// As for `etd_scene_add_web_light`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn etd_scene_set_web_light(
    scene: *mut etd_scene,
    light: u32,
    web: *const etd_web_light,
) -> etd_status {
    // SAFETY: the caller keeps this function's contract.
    unsafe {
        on(scene, |scene| {
            let desc = scene.desc();
            let known = find(&desc.lights, light, "point light")?;
            let it = read_sized(web, "web")?;
            let web = match contents(it.file, it.text, it.text_bytes, &known.path)? {
                Some(web) => web,
                None => Arc::clone(&measured(known, light)?.web),
            };
            let value = PointLightDesc { spectrum: known.spectrum.clone(), ..web_light(&it, web) };
            // An edit copies a description that is held elsewhere.
            drop(desc);
            scene.edit(|desc| desc.set_light_desc(light as usize, value))
        })
    }
}

/// Returns how a measured lamp is turned now, without its intensities. Errors: `ETD_INVALID_ARGUMENT` for a point light that is none.
/// Thread-safe.
///
/// # Safety
/// Each pointer must be NULL or point to a value of its type.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn etd_scene_get_web_light(
    scene: *const etd_scene,
    light: u32,
    out_web: *mut etd_web_light,
) -> etd_status {
    // SAFETY: the caller keeps this function's contract.
    unsafe {
        on(scene, |scene| {
            let desc = scene.desc();
            let it = find(&desc.lights, light, "point light")?;
            let web = measured(it, light)?;
            let value = etd_web_light {
                struct_size: size_of::<etd_web_light>(),
                file: ptr::null(),
                text: ptr::null(),
                text_bytes: 0,
                position: it.position.to_array(),
                direction: web.direction.to_array(),
                c0: web.c0.to_array(),
                factor: it.intensity.to_array(),
                tilt_deg: web.tilt_deg,
            };
            write_sized(out_web, "out_web", value)
        })
    }
}

/// The intensities that are given, where there are any, for the thing with this JSON path.
///
/// # Safety
/// `file` must be NULL or a text with a NUL at its end, and `text_bytes` bytes must be readable at `bytes` unless it is NULL.
pub(super) unsafe fn contents(
    file: *const c_char,
    bytes: *const c_void,
    text_bytes: usize,
    path: &str,
) -> Result<Option<Arc<Web>>> {
    if !file.is_null() && !bytes.is_null() {
        return Err(Failure::argument("web.file and web.text are both given, expected one of them".to_owned()));
    }
    let web = if !bytes.is_null() {
        // SAFETY: the caller keeps this function's contract.
        Web::parse(unsafe { items(bytes.cast::<u8>(), text_bytes, "web.text") }?)
    } else if !file.is_null() {
        // SAFETY: the caller keeps this function's contract.
        Web::read(Path::new(unsafe { text(file, "web.file") }?))
    } else {
        return Ok(None);
    };
    Ok(Some(Arc::new(web.map_err(|error| error.at(format!("{path}.file")))?)))
}

fn measured(it: &PointLightDesc, light: u32) -> Result<&WebDesc> {
    match &it.distribution {
        LightDistribution::Web(web) => Ok(web),
        _ => Err(Failure::argument(format!("point light {light} is not a measured lamp"))),
    }
}

fn web_light(it: &etd_web_light, web: Arc<Web>) -> PointLightDesc {
    let web = WebDesc {
        web,
        direction: DVec3::from_array(it.direction),
        c0: DVec3::from_array(it.c0),
        tilt_deg: it.tilt_deg,
    };
    let even = PointLightDesc::even(DVec3::from_array(it.position), Rgb::from_array(it.factor));
    PointLightDesc { distribution: LightDistribution::Web(web), ..even }
}

fn spot_light(it: &etd_spot_light) -> PointLightDesc {
    let spot = SpotDesc {
        direction: DVec3::from_array(it.direction),
        outer_deg: it.outer_cone_deg,
        inner_deg: it.inner_cone_deg,
    };
    let even = PointLightDesc::even(DVec3::from_array(it.position), Rgb::from_array(it.intensity));
    PointLightDesc { distribution: LightDistribution::Spot(spot), ..even }
}
