//! Mattes: which objects and materials the pixels of a picture see.

use std::ffi::c_char;
use std::ptr;

use super::bake::{BakeJob, build_described};
use super::boundary::{boundary, need, on, text};
use super::progress::initial_progress;
use super::read;
use super::scene::etd_scene;
use super::status::{Failure, etd_status};
use super::types::*;
use super::work::settings_of;
use crate::output::cryptomatte;
use crate::render::{MAX_MATTE_LEVELS, MatteKind, MatteSettings, Mattes};

/// Most pixels, as of a film.
const MAX_PIXELS: u64 = 1 << 26;

/// Traces mattes: which objects or materials each pixel of a picture sees, and in which share of its samples. A scene that has changed
/// is built first.
///
/// They cost one ray for each camera sample. The samples are those of a render with the same options to a film of `width` x `height`
/// pixels, so that edges match those of its picture; light, time limit, target error and `finished` are ignored, and `samples` must not
/// be 0. What is seen is the first surface that a ray meets: rays pass where an opacity lets them, and mirrors and glass are what is seen.
/// Samples that meet nothing belong to no name, and the coverages of a pixel then sum to less than 1. Each sample counts once, also
/// where `filter` has weights below 0.
///
/// `options`: NULL for the scene's own settings. `kind`: an `etd_matte_kind`. `levels`: number of names that a pixel keeps, those of the
/// largest coverage, 1 to 64. `out_ids`: receives `[height][width][levels]` identifiers by falling coverage, row 0 on top, 0 where there
/// is no further name: `etd_matte_id` of the names, as the pixels and the manifest of a Cryptomatte have them. `out_coverages`: receives
/// the same number of coverages, in [0, 1].
///
/// The result depends only on the scene, the options and the size, and not on threads. Errors: `ETD_CANCELLED` if the progress callback
/// stopped it; `ETD_INVALID_ARGUMENT` for a kind, levels, samples or a size out of range and for options about parts of a picture and
/// checkpoints; the errors of `etd_scene_commit`; the arrays are then unchanged. Thread-safe.
///
/// # Safety
/// Each pointer must be NULL or point to a value of its type; the two arrays must hold `width` x `height` x `levels` items.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn etd_scene_trace_mattes(
    scene: *mut etd_scene,
    width: u32,
    height: u32,
    options: *const etd_render_options,
    kind: EtdMatteKind,
    levels: u32,
    out_ids: *mut u32,
    out_coverages: *mut f32,
) -> etd_status {
    // SAFETY: the caller keeps this function's contract.
    unsafe {
        on(scene, |scene| {
            need(out_ids, "out_ids")?;
            need(out_coverages, "out_coverages")?;
            let kind = match read::enumeration("kind", kind)? {
                ETD_MATTE_OBJECT => MatteKind::Object,
                ETD_MATTE_MATERIAL => MatteKind::Material,
            };
            if width == 0 || height == 0 || u64::from(width) * u64::from(height) > MAX_PIXELS {
                let message = format!("{width} x {height} pixels, expected 1 to {MAX_PIXELS} of them");
                return Err(Failure::argument(message));
            }
            if !(1..=MAX_MATTE_LEVELS).contains(&levels) {
                return Err(Failure::argument(format!("levels is {levels}, expected 1 to {MAX_MATTE_LEVELS}")));
            }
            let job = BakeJob::new(scene, options, ptr::null_mut())?;
            if job.options.samples == 0 {
                return Err(Failure::argument("options.samples is 0, expected the samples of the mattes"));
            }
            let settings = settings_of(&job.options, [width, height], &scene.device, job.progress.cancel())?;
            settings.desc.check().map_err(read::in_options)?;
            let settings = MatteSettings {
                desc: settings.desc,
                workers: settings.workers,
                cancel: settings.cancel,
                levels,
                ..MatteSettings::default()
            };
            let (built, desc, rest) = build_described(scene, &job.progress)?;
            let report = |fraction| rest.report(fraction, initial_progress(ETD_PHASE_RENDER));
            let mattes = Mattes::trace(&built, &desc, &settings, &mut |fraction| report(fraction))?;
            let ids = cryptomatte::ids(mattes.names(kind))?;
            let levels = levels as usize;
            for (y, x) in (0..height).flat_map(|y| (0..width).map(move |x| (y, x))) {
                let shares = mattes.pixel(kind, x, y);
                let first = (y as usize * width as usize + x as usize) * levels;
                for level in 0..levels {
                    let (id, coverage) = shares.get(level).map_or((0, 0.0), |share| {
                        (ids[share.name as usize].to_bits(), share.samples as f32 / mattes.samples() as f32)
                    });
                    out_ids.add(first + level).write(id);
                    out_coverages.add(first + level).write(coverage);
                }
            }
            // All work is done, so that the answer stops nothing.
            let _ = report(1.0);
            Ok(())
        })
    }
}

/// Returns the identifier of a name in mattes: the bits of the float that a Cryptomatte has for it, never 0. `name`: UTF-8. Thread-safe.
///
/// # Safety
/// Each pointer must be NULL or point to a value of its type, `name` to a text with a NUL at its end.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn etd_matte_id(name: *const c_char, out_id: *mut u32) -> etd_status {
    boundary(None, || {
        need(out_id, "out_id")?;
        // SAFETY: the caller keeps this function's contract.
        unsafe { out_id.write(cryptomatte::id(text(name, "name")?).to_bits()) };
        Ok(())
    })
}
