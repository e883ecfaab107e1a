//! Calls that describe light from infinity.

use super::boundary::{array, need, on, read_sized, write_sized};
use super::read::{enumeration, flag};
use super::scene::etd_scene;
use super::status::{Failure, Result, etd_status};
use super::types::{ETD_NONE, Enumeration, etd_backplate, etd_environment_map, etd_sky_projection};
use crate::Error;
use crate::desc::{
    BackplateDesc, EnvironmentDesc, EnvironmentMapDesc, MAX_PORTALS, PortalDesc, SkyDesc, SkyProjection,
};
use crate::math::DVec3;
use crate::spectrum::Rgb;

/// Sets the light that comes from infinity, the same from all directions: a sky.
///
/// `radiance`: three numbers, radiance [W m^-2 sr^-1], each >= 0; NULL: none. Thread-safe.
///
/// # Safety
/// Each pointer must be NULL or point to a value of its type.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn etd_scene_set_environment(scene: *mut etd_scene, radiance: *const f32) -> etd_status {
    // SAFETY: the caller keeps this function's contract.
    unsafe {
        on(scene, |scene| {
            let radiance = if radiance.is_null() { None } else { Some(Rgb::from_array(array(radiance, "radiance")?)) };
            scene.edit(|desc| desc.set_environment(radiance))
        })
    }
}

/// Returns the radiance that comes from infinity as described now, three numbers: 0 where there is no environment.
/// Thread-safe.
///
/// # Safety
/// Each pointer must be NULL or point to a value of its type.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn etd_scene_get_environment(scene: *const etd_scene, out_radiance: *mut f32) -> etd_status {
    // SAFETY: the caller keeps this function's contract.
    unsafe {
        on(scene, |scene| {
            need(out_radiance, "out_radiance")?;
            let desc = scene.desc();
            let radiance = desc.environment.as_ref().map_or(Rgb::ZERO, |environment| environment.radiance);
            out_radiance.cast::<[f32; 3]>().write(radiance.to_array());
            Ok(())
        })
    }
}

/// Sets the openings through which light from infinity comes into rooms, such as windows. They make it found sooner there, and change
/// nothing else: light that comes in elsewhere counts all the same.
///
/// `corners`: four positions in order around the edge for each of the `count` openings, twelve numbers; for a triangle the last corner
/// is given twice. `count` 0: none. They belong to the environment: another one that is set has none. Errors: `ETD_INVALID_SCENE` for a
/// scene without an environment, for more than 256 openings or one without an area. Thread-safe.
///
/// # Safety
/// `corners` must be NULL with a `count` of 0, or point to `12 * count` numbers. Each other pointer must be NULL or point to a value of its
/// type.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn etd_scene_set_portals(scene: *mut etd_scene, corners: *const f64, count: usize) -> etd_status {
    // SAFETY: the caller keeps this function's contract.
    unsafe {
        on(scene, |scene| {
            if count > MAX_PORTALS {
                // As the description says it, without reading them.
                return Err(Failure::from(Error::invalid(
                    "environment.portals",
                    format!("{count} portals; expected {MAX_PORTALS} at most"),
                )));
            }
            if count > 0 {
                need(corners, "corners")?;
            }
            let portal = |place: usize| {
                let [a, b, c, d] = corners.cast::<[[f64; 3]; 4]>().add(place).read().map(DVec3::from_array);
                PortalDesc { corners: if c == d { vec![a, b, c] } else { vec![a, b, c, d] } }
            };
            let portals = (0..count).map(portal).collect();
            scene.edit(|desc| desc.set_portals(portals))
        })
    }
}

/// Returns the openings of the environment as `etd_scene_set_portals` takes them: `out_count` receives their number, and `out_corners`,
/// where it is not NULL, twelve numbers for each of the first `capacity`. Thread-safe.
///
/// # Safety
/// `out_corners` must be NULL or have room for `12 * capacity` numbers. Each other pointer must be NULL or point to a value of its type.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn etd_scene_get_portals(
    scene: *const etd_scene,
    out_corners: *mut f64,
    capacity: usize,
    out_count: *mut usize,
) -> etd_status {
    // SAFETY: the caller keeps this function's contract.
    unsafe {
        on(scene, |scene| {
            need(out_count, "out_count")?;
            let desc = scene.desc();
            let portals = desc.environment.as_ref().map_or(&[][..], |environment| &environment.portals);
            if !out_corners.is_null() {
                for (place, portal) in portals.iter().take(capacity).enumerate() {
                    let corner = |i: usize| portal.corners[i.min(portal.corners.len() - 1)].to_array();
                    out_corners.cast::<[[f64; 3]; 4]>().add(place).write(std::array::from_fn(corner));
                }
            }
            out_count.write(portals.len());
            Ok(())
        })
    }
}

/// Sets the light that comes from infinity by a texture of all directions, or the same from all directions where `map->texture` is
/// `ETD_NONE`.
///
/// `map`: NULL for no light from infinity. Errors: `ETD_INVALID_SCENE` if there is no such texture, if it does not have the shape of
/// the projection, is projected on surfaces or multiplied by the colours of vertices, or is an image that is scaled, turned or moved.
/// Thread-safe.
///
/// # Safety
/// Each pointer must be NULL or point to a value of its type.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn etd_scene_set_environment_map(
    scene: *mut etd_scene,
    map: *const etd_environment_map,
) -> etd_status {
    // SAFETY: the caller keeps this function's contract.
    unsafe {
        on(scene, |scene| {
            let environment = if map.is_null() { None } else { Some(environment(&read_sized(map, "map")?)?) };
            scene.edit(|desc| desc.set_environment_desc(environment))
        })
    }
}

/// Returns the light that comes from infinity as described now. Without any, the radiance is 0 and the texture `ETD_NONE`.
/// Thread-safe.
///
/// # Safety
/// Each pointer must be NULL or point to a value of its type.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn etd_scene_get_environment_map(
    scene: *const etd_scene,
    out_map: *mut etd_environment_map,
) -> etd_status {
    // SAFETY: the caller keeps this function's contract.
    unsafe {
        on(scene, |scene| {
            let none = EnvironmentDesc::even(Rgb::ZERO);
            let desc = scene.desc();
            let it = desc.environment.as_ref().unwrap_or(&none);
            let map = it.map().copied().unwrap_or(EnvironmentMapDesc::new(0));
            let projection = match map.projection {
                SkyProjection::LatLong => etd_sky_projection::ETD_SKY_LATLONG,
                SkyProjection::Octahedral => etd_sky_projection::ETD_SKY_OCTAHEDRAL,
                SkyProjection::Cube => etd_sky_projection::ETD_SKY_CUBE,
            };
            let value = etd_environment_map {
                struct_size: size_of::<etd_environment_map>(),
                texture: it.map().map_or(ETD_NONE, |map| map.texture as u32),
                projection: projection.number(),
                radiance: it.radiance.to_array(),
                hidden: u32::from(!it.visible),
                up: map.up.to_array(),
                rotation_deg: map.rotation_deg,
            };
            write_sized(out_map, "out_map", value)
        })
    }
}

/// Sets the picture that the camera sees behind everything, in place of what comes from infinity. It lights nothing: mirrors and glass
/// show what comes from infinity.
///
/// `backplate`: NULL for none. Errors: `ETD_INVALID_SCENE` for a radiance below 0, and if there is no such texture, or if it is projected
/// on surfaces or multiplied by the colours of vertices. Thread-safe.
///
/// # Safety
/// Each pointer must be NULL or point to a value of its type.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn etd_scene_set_backplate(scene: *mut etd_scene, backplate: *const etd_backplate) -> etd_status {
    // SAFETY: the caller keeps this function's contract.
    unsafe {
        on(scene, |scene| {
            let backplate = if backplate.is_null() {
                None
            } else {
                let it: etd_backplate = read_sized(backplate, "backplate")?;
                let texture = (it.texture != ETD_NONE).then_some(it.texture as usize);
                Some(BackplateDesc { radiance: Rgb::from_array(it.radiance), texture })
            };
            scene.edit(|desc| desc.set_backplate(backplate))
        })
    }
}

/// Returns the picture behind everything as described now. Without any, the radiance is 0 and the texture `ETD_NONE`. Thread-safe.
///
/// # Safety
/// Each pointer must be NULL or point to a value of its type.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn etd_scene_get_backplate(
    scene: *const etd_scene,
    out_backplate: *mut etd_backplate,
) -> etd_status {
    // SAFETY: the caller keeps this function's contract.
    unsafe {
        on(scene, |scene| {
            let it = scene.desc().backplate.unwrap_or(BackplateDesc::even(Rgb::ZERO));
            let value = etd_backplate {
                struct_size: size_of::<etd_backplate>(),
                texture: it.texture.map_or(ETD_NONE, |texture| texture as u32),
                radiance: it.radiance.to_array(),
            };
            write_sized(out_backplate, "out_backplate", value)
        })
    }
}

fn environment(it: &etd_environment_map) -> Result<EnvironmentDesc> {
    let projection = match enumeration("map.projection", it.projection)? {
        etd_sky_projection::ETD_SKY_LATLONG => SkyProjection::LatLong,
        etd_sky_projection::ETD_SKY_OCTAHEDRAL => SkyProjection::Octahedral,
        etd_sky_projection::ETD_SKY_CUBE => SkyProjection::Cube,
    };
    let map = EnvironmentMapDesc {
        texture: it.texture as usize,
        projection,
        up: DVec3::from_array(it.up),
        rotation_deg: it.rotation_deg,
    };
    Ok(EnvironmentDesc {
        sky: if it.texture == ETD_NONE { SkyDesc::Even } else { SkyDesc::Map(map) },
        visible: !flag("map.hidden", it.hidden)?,
        ..EnvironmentDesc::even(Rgb::from_array(it.radiance))
    })
}
