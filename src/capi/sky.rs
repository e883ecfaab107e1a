//! Calls that describe the sun, and skies by formula.

use super::boundary::{boundary, need, on, read_sized, write_sized};
use super::describe::find;
use super::read::flag;
use super::scene::etd_scene;
use super::status::{Failure, Result, etd_status};
use super::types::{etd_distant_light, etd_sky};
use crate::desc::{DistantLightDesc, EnvironmentDesc, FormulaSkyDesc, HosekWilkieDesc, SkyDesc, sun_direction};
use crate::emitter::{SUN_DIAMETER_DEG, SkyFormula};
use crate::math::DVec3;
use crate::spectrum::Rgb;

/// Adds light that comes from one direction of infinity, such as that of the sun.
///
/// `*out_light` receives its number among such lights. Errors: `ETD_INVALID_SCENE` for a direction of 0, an irradiance below 0 or
/// an angle beyond its range. Thread-safe.
///
/// # Safety
/// Each pointer must be NULL or point to a value of its type.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn etd_scene_add_distant_light(
    scene: *mut etd_scene,
    value: *const etd_distant_light,
    out_light: *mut u32,
) -> etd_status {
    // SAFETY: the caller keeps this function's contract.
    unsafe {
        on(scene, |scene| {
            need(out_light, "out_light")?;
            let light = distant(&read_sized(value, "value")?)?;
            let number = scene.edit(|desc| desc.add_distant_light(light))?;
            out_light.write(number as u32);
            Ok(())
        })
    }
}

/// Changes light that comes from one direction. An irradiance of 0 switches it off. Thread-safe.
///
/// # Safety
/// Each pointer must be NULL or point to a value of its type.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn etd_scene_set_distant_light(
    scene: *mut etd_scene,
    light: u32,
    value: *const etd_distant_light,
) -> etd_status {
    // SAFETY: the caller keeps this function's contract.
    unsafe {
        on(scene, |scene| {
            let spectrum = find(&scene.desc().distant_lights, light, "distant light")?.spectrum.clone();
            let value = DistantLightDesc { spectrum, ..distant(&read_sized(value, "value")?)? };
            scene.edit(|desc| desc.set_distant_light(light as usize, value))
        })
    }
}

/// Returns light that comes from one direction as described now. Thread-safe.
///
/// # Safety
/// Each pointer must be NULL or point to a value of its type.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn etd_scene_get_distant_light(
    scene: *const etd_scene,
    light: u32,
    out_value: *mut etd_distant_light,
) -> etd_status {
    // SAFETY: the caller keeps this function's contract.
    unsafe {
        on(scene, |scene| {
            let desc = scene.desc();
            let it = find(&desc.distant_lights, light, "distant light")?;
            let value = etd_distant_light {
                struct_size: size_of::<etd_distant_light>(),
                towards: it.towards.to_array(),
                irradiance: it.irradiance.to_array(),
                hidden: u32::from(!it.visible),
                angle_deg: it.angle_deg,
            };
            write_sized(out_value, "out_value", value)
        })
    }
}

/// Sets the light that comes from infinity all around to a sky by a formula. It takes the place of that of
/// `etd_scene_set_environment` and `etd_scene_set_environment_map`.
///
/// Errors: `ETD_INVALID_SCENE` for numbers beyond their range, a sun below the horizon and a
/// formula that gives no light; `ETD_INVALID_ARGUMENT` for a type that the CIE does not have, and for a `turbidity` beside `cie` or
/// `horizontal`. Thread-safe.
///
/// # Safety
/// Each pointer must be NULL or point to a value of its type.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn etd_scene_set_sky(scene: *mut etd_scene, sky: *const etd_sky) -> etd_status {
    // SAFETY: the caller keeps this function's contract.
    unsafe {
        on(scene, |scene| {
            let environment = environment(&read_sized(sky, "sky")?)?;
            scene.edit(|desc| desc.set_environment_desc(Some(environment)))
        })
    }
}

/// Returns the sky by a formula as described now. Where there is none, its radiance is 0. Thread-safe.
///
/// # Safety
/// Each pointer must be NULL or point to a value of its type.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn etd_scene_get_sky(scene: *const etd_scene, out_sky: *mut etd_sky) -> etd_status {
    // SAFETY: the caller keeps this function's contract.
    unsafe {
        on(scene, |scene| {
            let value = match &scene.desc().environment {
                Some(it @ EnvironmentDesc { sky: SkyDesc::Formula(sky), .. }) => formula_value(it, sky),
                Some(it @ EnvironmentDesc { sky: SkyDesc::HosekWilkie(sky), .. }) => hosek_wilkie_value(it, sky),
                _ => {
                    let even = SkyFormula { numbers: [0.0; 5], is_cie: false };
                    formula_value(&EnvironmentDesc::even(Rgb::ZERO), &FormulaSkyDesc::new(even, DVec3::Y))
                }
            };
            write_sized(out_sky, "out_sky", value)
        })
    }
}

/// Returns the direction towards the sun from a place on the earth at a time, in a world whose x is east, y up and -z north.
///
/// `latitude_deg`: degrees north of the equator, in [-90, 90]. `longitude_deg`: degrees east of Greenwich, in [-360, 360].
/// `seconds`: since 1970-01-01 00:00 UTC; the direction is within 0.01 degrees from 1950 to 2050, without refraction. `out_direction`
/// receives three numbers, a unit vector. Errors: `ETD_INVALID_ARGUMENT` for numbers beyond their range. Thread-safe.
///
/// # Safety
/// `out_direction` must be NULL or point to three numbers.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn etd_sun_direction(
    latitude_deg: f64,
    longitude_deg: f64,
    seconds: f64,
    out_direction: *mut f64,
) -> etd_status {
    boundary(None, || {
        need(out_direction, "out_direction")?;
        for (name, value, most) in
            [("latitude_deg", latitude_deg, 90.0), ("longitude_deg", longitude_deg, 360.0), ("seconds", seconds, 1e11)]
        {
            if value.is_nan() || value.abs() > most {
                return Err(Failure::argument(format!("{name} is {value}, expected {} to {most}", -most)));
            }
        }
        let east_north_up = sun_direction(latitude_deg, longitude_deg, seconds);
        let direction = [east_north_up.x, east_north_up.z, -east_north_up.y];
        // SAFETY: it was checked, and is writable by the caller's contract.
        unsafe { out_direction.cast::<[f64; 3]>().write(direction) };
        Ok(())
    })
}

fn distant(it: &etd_distant_light) -> Result<DistantLightDesc> {
    Ok(DistantLightDesc {
        angle_deg: it.angle_deg,
        visible: !flag("value.hidden", it.hidden)?,
        ..DistantLightDesc::parallel(DVec3::from_array(it.towards), Rgb::from_array(it.irradiance))
    })
}

fn formula_value(it: &EnvironmentDesc, sky: &FormulaSkyDesc) -> etd_sky {
    etd_sky {
        struct_size: size_of::<etd_sky>(),
        cie: sky.formula.cie_number().unwrap_or(0),
        horizontal: u32::from(sky.is_horizontal),
        radiance: it.radiance.to_array(),
        ground: sky.ground.to_array(),
        hidden: u32::from(!it.visible),
        reserved: 0,
        sun: sky.sun.to_array(),
        up: sky.up.to_array(),
        perez: sky.formula.numbers,
        turbidity: 0.0,
        angle_deg: SUN_DIAMETER_DEG,
        no_disk: 0,
        reserved_1: 0,
    }
}

fn hosek_wilkie_value(it: &EnvironmentDesc, sky: &HosekWilkieDesc) -> etd_sky {
    etd_sky {
        struct_size: size_of::<etd_sky>(),
        cie: 0,
        horizontal: 0,
        radiance: it.radiance.to_array(),
        ground: sky.ground.to_array(),
        hidden: u32::from(!it.visible),
        reserved: 0,
        sun: sky.sun.to_array(),
        up: sky.up.to_array(),
        perez: [0.0; 5],
        turbidity: sky.turbidity,
        angle_deg: sky.disk_deg.unwrap_or(SUN_DIAMETER_DEG),
        no_disk: u32::from(sky.disk_deg.is_none()),
        reserved_1: 0,
    }
}

fn environment(it: &etd_sky) -> Result<EnvironmentDesc> {
    for (name, value) in [("reserved", it.reserved), ("reserved_1", it.reserved_1)] {
        if value != 0 {
            return Err(Failure::argument(format!("sky.{name} must be 0")));
        }
    }
    let sky =
        if it.turbidity == 0.0 { SkyDesc::Formula(formula(it)?) } else { SkyDesc::HosekWilkie(hosek_wilkie(it)?) };
    Ok(EnvironmentDesc {
        sky,
        visible: !flag("sky.hidden", it.hidden)?,
        ..EnvironmentDesc::even(Rgb::from_array(it.radiance))
    })
}

fn hosek_wilkie(it: &etd_sky) -> Result<HosekWilkieDesc> {
    for (name, value) in [("cie", it.cie), ("horizontal", it.horizontal)] {
        if value != 0 {
            return Err(Failure::argument(format!("sky.{name} is {value}, expected 0 with sky.turbidity")));
        }
    }
    let has_disk = !flag("sky.no_disk", it.no_disk)?;
    Ok(HosekWilkieDesc {
        turbidity: it.turbidity,
        sun: DVec3::from_array(it.sun),
        up: DVec3::from_array(it.up),
        ground: Rgb::from_array(it.ground),
        disk_deg: has_disk.then_some(it.angle_deg),
    })
}

fn formula(it: &etd_sky) -> Result<FormulaSkyDesc> {
    let formula = match it.cie {
        0 => SkyFormula { numbers: it.perez, is_cie: false },
        number => SkyFormula::cie(number)
            .ok_or_else(|| Failure::argument(format!("sky.cie is {number}, expected a type from 1 to 15, or 0")))?,
    };
    Ok(FormulaSkyDesc {
        formula,
        sun: DVec3::from_array(it.sun),
        up: DVec3::from_array(it.up),
        is_horizontal: flag("sky.horizontal", it.horizontal)?,
        ground: Rgb::from_array(it.ground),
    })
}
