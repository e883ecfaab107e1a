//! Illuminance and luminance at points that the host gives.

use super::bake::BakeJob;
use super::boundary::{array, boundary, items, need, on};
use super::progress::initial_progress;
use super::read;
use super::scene::etd_scene;
use super::status::{Failure, etd_status};
use super::types::*;
use super::work::settings_of;
use crate::desc::{GridDesc, GridPoints};
use crate::lighting::{Calculation, exterior_illuminance};
use crate::math::DVec3;
use crate::photometry::{LUMENS_PER_WATT, TEMPERATURES, of_luminance_one, planckian};
use crate::room::collected;
use crate::spectrum::Rgb;

/// Measures light at points, and returns when the values are there: illuminance, lx, of small planes, or luminance [cd m^-2] of
/// views. A scene that has changed is built first.
///
/// `quantity`: an `etd_quantity`. `points`: `count` points, 1 to 1,048,576, each with the normal of its plane or with the direction
/// that is looked into. Points need no surface; a point on a surface is lit as the side of its normal is. `options`: NULL for the
/// scene's own settings. With `ETD_INTEGRATOR_RADIOSITY` the light is that of a radiosity solution, gathered at each point; all
/// other integrators mean path tracing. The filter and `finished` are ignored, the depth counts a point of illuminance as the first
/// hit, and "pixels" in the documentation of options means points. `target_error` is a relMSE: the square of the relative standard
/// error that is wanted. `out_values`: receives `count` numbers. `out_standard_errors`: receives their standard errors, NaN where
/// there are too few samples, unless it is NULL. `out_summary`: receives the summary, unless it is NULL.
///
/// One watt is 683 lumens: docs/photometry.md. The result depends only on the scene, the points and the options, and not on
/// threads. Errors: `ETD_CANCELLED` if the progress callback stopped it; the arrays then contain the result of the samples so far;
/// `ETD_INVALID_ARGUMENT` for another quantity; `ETD_INVALID_SCENE` for numbers of points out of range, points beyond single precision, and directions of
/// length 0; `ETD_UNSUPPORTED` for a scene that radiosity does not take; the errors of `etd_scene_commit`. Thread-safe.
///
/// # Safety
/// Each pointer must be NULL or point to a value of its type; `points` and the two arrays must hold `count` items.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn etd_scene_measure(
    scene: *mut etd_scene,
    quantity: EtdQuantity,
    points: *const etd_measuring_point,
    count: usize,
    options: *const etd_render_options,
    out_values: *mut f64,
    out_standard_errors: *mut f64,
    out_summary: *mut etd_summary,
) -> etd_status {
    // SAFETY: the caller keeps this function's contract.
    unsafe {
        on(scene, |scene| {
            let job = BakeJob::new(scene, options, out_summary)?;
            need(points, "points")?;
            need(out_values, "out_values")?;
            if !out_standard_errors.is_null() {
                need(out_standard_errors, "out_standard_errors")?;
            }
            let points = items(points, count, "points")?;
            let position = collected(points.iter().map(|point| DVec3::from(point.position)), points.len())?;
            let directions = collected(points.iter().map(|point| DVec3::from(point.direction)), points.len())?;
            let points = match read::enumeration("quantity", quantity)? {
                ETD_QUANTITY_ILLUMINANCE => GridPoints::Points { points: position, normals: directions },
                ETD_QUANTITY_LUMINANCE => GridPoints::Views { points: position, directions },
            };
            let grid = GridDesc { name: "points".to_owned(), points };
            // Bad points are refused before anything is built.
            grid.check("")?;
            let (built, rest) = super::bake::build(scene, &job.progress)?;
            let settings = settings_of(&job.options, [1, 1], &scene.device, job.progress.cancel())?;
            let mut calculation = Calculation::new(&built, &grid, settings)?;
            let summary = calculation.run(&mut |progress| {
                let report = etd_progress {
                    rays: progress.rays,
                    samples_done: progress.samples_done,
                    samples_total: progress.samples_total,
                    ..initial_progress(ETD_PHASE_RENDER)
                };
                rest.report(progress.fraction, report)
            })?;
            job.log(&summary);
            let measured = calculation.try_measured()?;
            // Both lists have `count` numbers.
            out_values.copy_from_nonoverlapping(measured.values.as_ptr(), count);
            if !out_standard_errors.is_null() {
                out_standard_errors.copy_from_nonoverlapping(measured.standard_errors.as_ptr(), count);
            }
            job.finish(&summary, out_summary)
        })
    }
}

/// The illuminance, lx, of a horizontal plane under the unobstructed sky of a scene, to which daylight factors refer. Surfaces, lamps
/// and distant light such as the sun's disk do not count.
///
/// `out_illuminance`: receives the illuminance. `out_standard_error`: receives its standard error, unless it is NULL. Errors:
/// `ETD_INVALID_SCENE` for a scene without an environment or with a black one. Thread-safe.
///
/// # Safety
/// Each pointer must be NULL or point to a value of its type.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn etd_scene_exterior_illuminance(
    scene: *mut etd_scene,
    out_illuminance: *mut f64,
    out_standard_error: *mut f64,
) -> etd_status {
    // SAFETY: the caller keeps this function's contract.
    unsafe {
        on(scene, |scene| {
            need(out_illuminance, "out_illuminance")?;
            if !out_standard_error.is_null() {
                need(out_standard_error, "out_standard_error")?;
            }
            let desc = scene.desc().clone();
            let options = read::render_out(&desc.render);
            let settings = settings_of(&options, [1, 1], &scene.device, &crate::Cancel::new())?;
            let (value, error) = exterior_illuminance(&desc, &settings).map_err(Failure::from)?;
            out_illuminance.write(value);
            if !out_standard_error.is_null() {
                out_standard_error.write(error);
            }
            Ok(())
        })
    }
}

/// Returns light that is given in photometric units as the radiometric channels that lights and surfaces take: luminous intensity, cd,
/// as radiant intensity [W sr^-1], illuminance, lx, as irradiance [W m^-2], luminance [cd m^-2] as radiance [W m^-2 sr^-1].
///
/// `value`: the luminous quantity, > 0. With a `solid_angle` > 0, `value` is a luminous flux, lm, that is spread over it, and the
/// result is radiant intensity: 4 pi for a point light, 2 pi ((1 - cos inner) + (cos inner - cos outer) / 3) for a spot light, and
/// pi times the area for the radiance of a surface; 0 otherwise. `temperature`: colour temperature of a Planckian radiator in kelvin,
/// in [1000, 15000]; 0: the colour is `color`, three numbers >= 0 that are scaled to the luminance; NULL: white. `out_color` receives
/// three numbers, whose luminance is `value` over 683 lm/W. Errors: `ETD_INVALID_ARGUMENT` for numbers out of their range, for a colour
/// without luminance, for both a colour and a temperature, and for light beyond single precision. Thread-safe.
///
/// # Safety
/// `color` and `out_color` must be NULL or point to three numbers.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn etd_photometric_color(
    value: f64,
    solid_angle: f64,
    temperature: f64,
    color: *const f32,
    out_color: *mut f32,
) -> etd_status {
    boundary(None, || {
        need(out_color, "out_color")?;
        if !(value > 0.0 && value.is_finite()) {
            return Err(Failure::argument(format!("value is {value}, expected a number > 0")));
        }
        if !(solid_angle >= 0.0 && solid_angle.is_finite()) {
            return Err(Failure::argument(format!("solid_angle is {solid_angle}, expected 0 or more")));
        }
        let hue = if temperature != 0.0 {
            if !color.is_null() {
                return Err(Failure::argument("color and temperature are given, expected one of both"));
            }
            let [low, high] = TEMPERATURES;
            planckian(temperature).ok_or_else(|| {
                Failure::argument(format!("temperature is {temperature}, expected 0, or {low} to {high} kelvin"))
            })?
        } else if color.is_null() {
            DVec3::ONE
        } else {
            // SAFETY: three numbers are readable by the caller's contract.
            let given = DVec3::from(unsafe { array::<f32, 3>(color, "color") }?.map(f64::from));
            let is_light = given.is_finite() && given.min_element() >= 0.0;
            of_luminance_one(given).filter(|_| is_light).ok_or_else(|| {
                Failure::argument(format!("color is {:?}, expected numbers >= 0 and a luminance > 0", given.to_array()))
            })?
        };
        let spread = if solid_angle > 0.0 { solid_angle } else { 1.0 };
        let light = Rgb::from_f64(hue * (value / (spread * LUMENS_PER_WATT)));
        if !light.is_finite() {
            return Err(Failure::argument(format!("value is {value}: the light is beyond single precision")));
        }
        // SAFETY: it was checked, and three numbers are writable by the caller's contract.
        unsafe { out_color.cast::<[f32; 3]>().write(light.to_array()) };
        Ok(())
    })
}
