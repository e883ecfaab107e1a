//! Light maps: their layouts, and bakes of irradiance to arrays of the host.

use std::ffi::c_char;
use std::ptr;
use std::sync::Arc;
use std::time::{Duration, Instant};

use super::boundary::{
    Header, Object, UserData, give, need, object, on, read_sized, release, retain, take_status, write_sized,
};
use super::checkpoint::Parts;
use super::device::etd_device;
use super::progress::{BUILD_FRACTION, HostProgress, initial_progress};
use super::read;
use super::scene::etd_scene;
use super::status::{ETD_CANCELLED, Failure, Result, etd_status};
use super::types::*;
use super::work::{settings_of, summary_out};
use crate::bake::{Atlas, AtlasOptions, Bake, Baked, Layout, VertexOptions, Vertices, by_radiosity};
use crate::desc::{IntegratorDesc, SceneDesc};
use crate::integrator::Sites;
use crate::render::Summary;
use crate::scene::Scene;

/// Fraction of the progress after the build that the choice of sites for vertices counts for.
const VERTICES_FRACTION: f64 = 0.1;

/// The layout of a light map, and the scene for which it was made.
pub struct etd_atlas {
    header: Header,
    atlas: Box<Atlas>,
    built: Box<Scene>,
    scene: Arc<etd_scene>,
}
object!(etd_atlas, b"EtAt", "atlas");

// The tag is read from any object that the host passes, so its offset must lie inside the smallest kind of object.
const _: () = assert!(size_of::<etd_atlas>() <= size_of::<etd_device>());

/// Makes an atlas: lays out all surfaces of a scene in one square light map. A scene that has changed is built first.
///
/// `options`: NULL for the defaults of `ETD_ATLAS_OPTIONS_INIT`. On `ETD_OK`, `*out_atlas` is one reference. The atlas keeps the
/// scene as it is now, and later bakes use that scene. The same scene gives the same layout. The log callback receives a
/// warning for each mesh whose own texture coordinates could not be used. Errors: `ETD_CANCELLED` if the progress callback
/// stopped the call; `ETD_INVALID_ARGUMENT` for options out of their range; `ETD_INVALID_SCENE` for a scene without a surface,
/// for charts that do not fit, and for texture coordinates that cannot be a layout although the options require them;
/// `ETD_OUT_OF_MEMORY`; the errors of `etd_scene_commit`. Thread-safe.
///
/// # Safety
/// Each pointer must be NULL or point to a value of its type.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn etd_atlas_new(
    scene: *mut etd_scene,
    options: *const etd_atlas_options,
    out_atlas: *mut *mut etd_atlas,
) -> etd_status {
    // SAFETY: the caller keeps this function's contract.
    unsafe {
        on(scene, |scene| {
            need(out_atlas, "out_atlas")?;
            let (options, progress) = if options.is_null() {
                (AtlasOptions::default(), HostProgress::new(None, UserData(ptr::null_mut())))
            } else {
                atlas_options(options)?
            };
            let (built, layout) = build(scene, &progress)?;
            let mut progress = |fraction| layout.report(fraction, initial_progress(ETD_PHASE_BUILD));
            let atlas = Atlas::watched(&built, &options, &mut progress)?;
            let header = Header::new::<etd_atlas>(scene.device.callbacks());
            for warning in atlas.warnings() {
                header.callbacks.log(ETD_LOG_WARNING, warning);
            }
            let (atlas, built) = (Box::new(atlas), Box::new(built));
            give(Arc::new(etd_atlas { header, atlas, built, scene: Arc::clone(scene) }), out_atlas);
            Ok(())
        })
    }
}

/// Builds the scene as described now. Returns it with the progress of the work that follows.
pub(super) fn build(scene: &etd_scene, progress: &HostProgress) -> Result<(Scene, HostProgress)> {
    build_described(scene, progress).map(|(built, _, rest)| (built, rest))
}

/// The same, with the description that was built.
pub(super) fn build_described(
    scene: &etd_scene,
    progress: &HostProgress,
) -> Result<(Scene, Arc<SceneDesc>, HostProgress)> {
    let (built, time, desc) = scene.build_described(progress.cancel(), progress.part(0.0, BUILD_FRACTION).build())?;
    // The last report of a build comes when there is nothing left of it to stop.
    progress.cancel().check()?;
    let share = if time.is_zero() { 0.0 } else { BUILD_FRACTION };
    Ok((built, desc, progress.part(share, 1.0)))
}

/// # Safety
/// The contract of [`read_sized`].
unsafe fn atlas_options(options: *const etd_atlas_options) -> Result<(AtlasOptions, HostProgress)> {
    // SAFETY: the caller keeps this function's contract.
    let it = unsafe { read_sized(options, "options") }?;
    let default = AtlasOptions::default();
    let layout = match read::enumeration("options.layout", it.layout)? {
        ETD_ATLAS_LAYOUT_AUTO => Layout::Auto,
        ETD_ATLAS_LAYOUT_CHARTS => Layout::Charts,
        ETD_ATLAS_LAYOUT_OWN => Layout::Own,
    };
    if it.reserved != 0 {
        return Err(Failure::argument("options.reserved is not 0"));
    }
    let made = AtlasOptions {
        resolution: (it.resolution != 0).then_some(it.resolution),
        texels_per_unit: (it.texels_per_unit != 0.0).then_some(it.texels_per_unit),
        gutter: match it.gutter {
            0 => default.gutter,
            ETD_NONE => 0,
            gutter => gutter,
        },
        layout,
        max_angle_deg: if it.max_angle_deg == 0.0 { default.max_angle_deg } else { it.max_angle_deg },
        memory: if it.memory == 0 { default.memory } else { it.memory },
    };
    made.check().map_err(read::in_options)?;
    Ok((made, HostProgress::new(it.progress, UserData(it.user_data))))
}

/// Adds a reference to an atlas. Thread-safe.
///
/// # Safety
/// `atlas` must be NULL or an atlas.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn etd_atlas_retain(atlas: *mut etd_atlas) -> etd_status {
    // SAFETY: the caller keeps this function's contract.
    unsafe { retain(atlas) }
}

/// Releases a reference to an atlas; NULL is allowed. Thread-safe.
///
/// # Safety
/// `atlas` must be NULL or an atlas of which the caller has a reference.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn etd_atlas_release(atlas: *mut etd_atlas) {
    // SAFETY: the caller keeps this function's contract.
    unsafe { release(atlas) }
}

/// Takes the first failure of a call on this atlas since the last time that it was taken: returns its status, or `ETD_OK` if
/// there was none, and forgets the failure.
/// `message`: receives the message, at most `capacity` bytes including the zero byte, unless it is NULL. Thread-safe.
///
/// # Safety
/// `atlas` must be NULL or an atlas, and `capacity` bytes writable at `message` unless it is NULL.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn etd_atlas_status(atlas: *mut etd_atlas, message: *mut c_char, capacity: usize) -> etd_status {
    // SAFETY: the caller keeps this function's contract.
    unsafe { take_status(atlas, message, capacity) }
}

/// Returns the size of an atlas and its numbers of vertices, triangles, surfaces and charts. Thread-safe.
///
/// # Safety
/// Each pointer must be NULL or point to a value of its type.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn etd_atlas_get_info(atlas: *const etd_atlas, out_info: *mut etd_atlas_info) -> etd_status {
    // SAFETY: the caller keeps this function's contract.
    unsafe {
        on(atlas, |atlas| {
            let it = &atlas.atlas;
            let info = etd_atlas_info {
                struct_size: size_of::<etd_atlas_info>(),
                width: it.side(),
                height: it.side(),
                vertex_count: it.vertices().len(),
                triangle_count: it.triangles().len(),
                surface_count: it.surfaces().len(),
                chart_count: it.charts().len(),
                covered_texels: it.texels().len(),
                texels_per_unit: it.texels_per_unit(),
            };
            write_sized(out_info, "out_info", info)
        })
    }
}

/// Copies the vertices of an atlas, surface by surface. A vertex on a seam is there once for each chart.
///
/// `*out_needed` receives the number of vertices, unless `out_needed` is NULL. `vertices` may be NULL to get the number only.
/// Error: `ETD_INVALID_ARGUMENT` for a capacity below the number. Thread-safe.
///
/// # Safety
/// `capacity` vertices must be writable at `vertices` unless it is NULL; other pointers must be NULL or point to values of their types.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn etd_atlas_copy_vertices(
    atlas: *const etd_atlas,
    vertices: *mut etd_atlas_vertex,
    capacity: usize,
    out_needed: *mut usize,
) -> etd_status {
    // SAFETY: the caller keeps this function's contract.
    unsafe {
        on(atlas, |atlas| {
            let vertex = |vertex: &crate::bake::AtlasVertex| etd_atlas_vertex {
                position: vertex.position.to_array(),
                normal: vertex.normal.to_array(),
                uv: vertex.uv,
                source: vertex.source,
            };
            copy(atlas.atlas.vertices().iter().map(vertex), vertices, capacity, out_needed, "vertices")
        })
    }
}

/// Copies three vertex numbers for each triangle of an atlas, counter-clockwise seen from outside. Triangles come surface by
/// surface, in the order of the scene. Triangles without an area are left out; `etd_atlas_copy_primitives` says which triangles
/// are there.
///
/// `capacity` and `*out_needed` are numbers of indices, three for each triangle. All else is as for `etd_atlas_copy_vertices`.
/// Thread-safe.
///
/// # Safety
/// `capacity` numbers must be writable at `indices` unless it is NULL; other pointers must be NULL or point to values of their types.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn etd_atlas_copy_indices(
    atlas: *const etd_atlas,
    indices: *mut u32,
    capacity: usize,
    out_needed: *mut usize,
) -> etd_status {
    // SAFETY: the caller keeps this function's contract.
    unsafe {
        on(atlas, |atlas| {
            let indices_of = atlas.atlas.triangles().as_flattened();
            copy(indices_of.iter().copied(), indices, capacity, out_needed, "indices")
        })
    }
}

/// Copies for each triangle of an atlas its number on its surface: on a mesh the number of the triangle in the mesh, on a quad 0
/// or 1, on other shapes consecutive numbers. All else is as for `etd_atlas_copy_vertices`. Thread-safe.
///
/// # Safety
/// `capacity` numbers must be writable at `primitives` unless it is NULL; other pointers must be NULL or point to values of their types.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn etd_atlas_copy_primitives(
    atlas: *const etd_atlas,
    primitives: *mut u32,
    capacity: usize,
    out_needed: *mut usize,
) -> etd_status {
    // SAFETY: the caller keeps this function's contract.
    unsafe {
        on(atlas, |atlas| {
            copy(atlas.atlas.primitives().iter().copied(), primitives, capacity, out_needed, "primitives")
        })
    }
}

/// Copies the surfaces of an atlas, in the order of their numbers. Removed surfaces and surfaces without an area are left out.
/// All else is as for `etd_atlas_copy_vertices`. Thread-safe.
///
/// # Safety
/// `capacity` surfaces must be writable at `surfaces` unless it is NULL; other pointers must be NULL or point to values of their types.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn etd_atlas_copy_surfaces(
    atlas: *const etd_atlas,
    surfaces: *mut etd_atlas_surface,
    capacity: usize,
    out_needed: *mut usize,
) -> etd_status {
    // SAFETY: the caller keeps this function's contract.
    unsafe {
        on(atlas, |atlas| {
            let surface = |it: &crate::bake::AtlasSurface| etd_atlas_surface {
                surface: it.surface,
                first_vertex: it.vertices.start,
                vertex_count: it.vertices.end - it.vertices.start,
                first_triangle: it.triangles.start,
                triangle_count: it.triangles.end - it.triangles.start,
                has_own_layout: u32::from(it.scale_offset.is_some()),
                scale_offset: it.scale_offset.unwrap_or_default(),
            };
            copy(atlas.atlas.surfaces().iter().map(surface), surfaces, capacity, out_needed, "surfaces")
        })
    }
}

/// Copies for each texel of an atlas the fraction of its area that triangles cover, `[height][width]`, row 0 at v = 0. It is 0 in
/// gutters and outside of charts. All else is as for `etd_atlas_copy_vertices`. Thread-safe.
///
/// # Safety
/// `capacity` floats must be writable at `coverage` unless it is NULL; other pointers must be NULL or point to values of their types.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn etd_atlas_copy_coverage(
    atlas: *const etd_atlas,
    coverage: *mut f32,
    capacity: usize,
    out_needed: *mut usize,
) -> etd_status {
    // SAFETY: the caller keeps this function's contract.
    unsafe {
        on(atlas, |atlas| {
            let it = &atlas.atlas;
            let count = it.side() as usize * it.side() as usize;
            copy(std::iter::repeat_n(0.0, count), coverage, capacity, out_needed, "coverage")?;
            if !coverage.is_null() && capacity > 0 {
                for (texel, share) in it.texels().iter().zip(it.coverage()) {
                    coverage.add(*texel as usize).write(*share);
                }
            }
            Ok(())
        })
    }
}

/// Copies items to the caller's array.
///
/// # Safety
/// `capacity` items must be writable at `out`, unless it is NULL; one number at `out_needed`, unless it is NULL.
unsafe fn copy<T>(
    items: impl ExactSizeIterator<Item = T>,
    out: *mut T,
    capacity: usize,
    out_needed: *mut usize,
    name: &str,
) -> Result {
    let count = items.len();
    let asks = out.is_null() || capacity == 0;
    if asks && out_needed.is_null() {
        return Err(Failure::argument(format!("{name} is NULL or of no capacity, and so is out_needed")));
    }
    if !asks {
        need(out, name)?;
        if capacity < count {
            let message = format!("{name}: there are {count}, more than the capacity of {capacity}");
            return Err(Failure::argument(message));
        }
    }
    if !out_needed.is_null() {
        need(out_needed, "out_needed")?;
        // SAFETY: the caller keeps this function's contract.
        unsafe { out_needed.write(count) }
    }
    if !asks {
        for (at, item) in items.enumerate() {
            // SAFETY: `at < count <= capacity`.
            unsafe { out.add(at).write(item) }
        }
    }
    Ok(())
}

/// Bakes the light map of an atlas, irradiance [W m^-2], to the host's array, and returns when the bake has ended.
///
/// `options`: NULL for the scene's own settings. With `ETD_INTEGRATOR_RADIOSITY`, irradiance comes from a radiosity solution, whose
/// elements are as small as texels unless the options contain a size; it has no samples, and standard errors are NaN. All other
/// integrators mean path tracing. The filter and `finished` are ignored, the depth counts the texel as the first hit, and
/// "pixels" in the documentation of options means texels. `target`: receives three floats for each texel, `[height][width]`, row 0
/// at v = 0, and in the same layout the standard errors if `standard_error` is not NULL. `out_summary`: receives the summary,
/// unless it is NULL. Texels in the gutter of a chart get the values of the nearest covered texel of the chart, and texels beyond
/// gutters get 0.
///
/// The bake uses the scene for which the atlas was made. The result depends only on the atlas and the options, and not on
/// threads. Errors: `ETD_CANCELLED` if the progress callback stopped the bake; with path tracing, the arrays then contain the
/// result of the samples so far, and with radiosity, they are unchanged; `ETD_INVALID_ARGUMENT` for a target that cannot hold the
/// map; `ETD_OUT_OF_MEMORY` for a radiosity solution larger than `radiosity_memory`. Thread-safe.
///
/// # Safety
/// Each pointer must be NULL or point to a value of its type; `target->size` bytes must be writable.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn etd_atlas_bake(
    atlas: *mut etd_atlas,
    options: *const etd_render_options,
    target: *const etd_bake_target,
    out_summary: *mut etd_summary,
) -> etd_status {
    // SAFETY: the caller keeps this function's contract.
    unsafe {
        on(atlas, |atlas| {
            let side = atlas.atlas.side() as usize;
            let target = Target::new(target, [side, side])?;
            let job = BakeJob::new(&atlas.scene, options, out_summary)?;
            let texel = 1.0 / atlas.atlas.texels_per_unit();
            let (baked, summary) = job.run(&atlas.built, atlas.atlas.sites(), Some(texel), target.front)?;
            let map = atlas.atlas.light_map(&baked);
            target.write(&map.irradiance, &map.standard_error);
            job.finish(&summary, out_summary)
        })
    }
}

/// Bakes the vertices of one surface, irradiance [W m^-2], to the host's array. A scene that has changed is built first.
///
/// `surface`: number of the surface. `target`: receives three floats for each vertex: all vertices of a mesh in their order, or
/// the corners of a triangle or a quad. The value of a vertex is the mean irradiance over the part of the surface that is nearest
/// to the vertex, a third of each triangle around it; it is 0 for a vertex of no triangle. `target->row_stride` is ignored. All
/// else is as for `etd_atlas_bake`. Errors: `ETD_INVALID_ARGUMENT` for a number of a removed surface, of a surface without
/// vertices or of no surface, and for a target that cannot hold the vertices. Thread-safe.
///
/// # Safety
/// Each pointer must be NULL or point to a value of its type; `target->size` bytes must be writable.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn etd_scene_bake_vertices(
    scene: *mut etd_scene,
    surface: u32,
    options: *const etd_render_options,
    target: *const etd_bake_target,
    out_summary: *mut etd_summary,
) -> etd_status {
    // SAFETY: the caller keeps this function's contract.
    unsafe {
        on(scene, |scene| {
            let job = BakeJob::new(scene, options, out_summary)?;
            // The target is checked before anything is built.
            Target::new(target, [1, 1])?;
            let (built, rest) = build(scene, &job.progress)?;
            let (making, baking) = (rest.part(0.0, VERTICES_FRACTION), rest.part(VERTICES_FRACTION, 1.0));
            let mut progress = |fraction| making.report(fraction, initial_progress(ETD_PHASE_BUILD));
            let vertices = Vertices::watched(&built, &VertexOptions::default(), Some(surface), &mut progress);
            let vertices = match vertices {
                Err(error) if error.kind() == crate::ErrorKind::InvalidScene => {
                    return Err(Failure::argument(format!("surface {surface} does not exist or has no vertices")));
                }
                vertices => vertices?,
            };
            let target = Target::new(target, [vertices.vertices().len(), 1])?;
            let job = BakeJob { progress: baking, ..job };
            let (baked, summary) = job.run(&built, vertices.sites(), None, target.front)?;
            target.write(&vertices.spread(&baked.irradiance), &vertices.spread(&baked.standard_error));
            job.finish(&summary, out_summary)
        })
    }
}

/// The checked target of a bake.
struct Target {
    irradiance: *mut u8,
    standard_error: *mut u8,
    stride: usize,
    row_stride: usize,
    size: [usize; 2],
    front: bool,
}

impl Target {
    /// # Safety
    /// The contract of [`read_sized`].
    unsafe fn new(target: *const etd_bake_target, [columns, rows]: [usize; 2]) -> Result<Self> {
        const ITEM: usize = size_of::<[f32; 3]>();
        // SAFETY: the caller keeps this function's contract.
        let it = unsafe { read_sized(target, "target") }?;
        if it.reserved != 0 {
            return Err(Failure::argument("target.reserved is not 0"));
        }
        need(it.irradiance, "target.irradiance")?;
        if !it.standard_error.is_null() {
            need(it.standard_error, "target.standard_error")?;
        }
        let stride = if it.stride == 0 { ITEM } else { it.stride };
        if stride < ITEM || !stride.is_multiple_of(align_of::<f32>()) {
            let message = format!("target.stride is {stride}, expected a multiple of 4 of at least {ITEM}");
            return Err(Failure::argument(message));
        }
        let too_large =
            || Failure::argument(format!("target: {columns} x {rows} items {stride} bytes apart do not exist"));
        let row = (columns - 1).checked_mul(stride).and_then(|row| row.checked_add(ITEM)).ok_or_else(too_large)?;
        let row_stride = match it.row_stride {
            _ if rows == 1 => row,
            0 => columns.checked_mul(stride).ok_or_else(too_large)?,
            other => other,
        };
        if row_stride < row || !row_stride.is_multiple_of(align_of::<f32>()) {
            let message = format!("target.row_stride is {row_stride}, expected a multiple of 4 of at least {row}");
            return Err(Failure::argument(message));
        }
        let all = (rows - 1).checked_mul(row_stride).and_then(|rest| rest.checked_add(row));
        if all.is_none_or(|all| all > it.size) {
            let message =
                format!("target.size is {}: {rows} rows of {row} bytes, {row_stride} apart, do not fit", it.size);
            return Err(Failure::argument(message));
        }
        let front = match read::enumeration("target.side", it.side)? {
            ETD_SIDE_FRONT => true,
            ETD_SIDE_BACK => false,
        };
        Ok(Self {
            irradiance: it.irradiance.cast(),
            standard_error: it.standard_error.cast(),
            stride,
            row_stride,
            size: [columns, rows],
            front,
        })
    }

    /// Writes irradiance, and standard errors where the host asks for them, row by row.
    ///
    /// # Safety
    /// The arrays that the target's structure describes must be writable.
    unsafe fn write(&self, irradiance: &[[f32; 3]], standard_error: &[[f32; 3]]) {
        for (start, values) in [(self.irradiance, irradiance), (self.standard_error, standard_error)] {
            if start.is_null() {
                continue;
            }
            for (row, values) in values.chunks(self.size[0]).take(self.size[1]).enumerate() {
                for (column, value) in values.iter().enumerate() {
                    // SAFETY: the writes stay inside the size that was checked, and the addresses are aligned to floats.
                    unsafe {
                        let at = start.add(row * self.row_stride + column * self.stride);
                        at.cast::<[f32; 3]>().write(*value);
                    }
                }
            }
        }
    }
}

/// A bake with the host's options.
pub(super) struct BakeJob<'a> {
    scene: &'a Arc<etd_scene>,
    pub options: etd_render_options,
    pub progress: HostProgress,
}

impl<'a> BakeJob<'a> {
    /// # Safety
    /// The contract of [`read_sized`].
    pub unsafe fn new(
        scene: &'a Arc<etd_scene>,
        options: *const etd_render_options,
        out_summary: *mut etd_summary,
    ) -> Result<Self> {
        let options = if options.is_null() {
            read::render_out(&scene.desc().render)
        } else {
            // SAFETY: the caller keeps this function's contract.
            unsafe { read_sized(options, "options") }?
        };
        if !out_summary.is_null() {
            // SAFETY: the caller keeps this function's contract.
            unsafe { read_sized(out_summary.cast_const(), "out_summary") }?;
        }
        let progress = HostProgress::new(options.progress, UserData(options.user_data));
        // Invalid options are refused here.
        Parts::refuse(&options)?;
        settings_of(&options, [1, 1], &scene.device, progress.cancel())?;
        Ok(Self { scene, options, progress })
    }

    /// Runs the bake. `texel` is the length of a texel, for bakes of atlases.
    fn run(&self, built: &Scene, sites: &Arc<Sites>, texel: Option<f64>, front: bool) -> Result<(Baked, Summary)> {
        let start = Instant::now();
        let settings = settings_of(&self.options, [1, 1], &self.scene.device, self.progress.cancel())?;
        if settings.desc.integrator == IntegratorDesc::Radiosity {
            // If the scene's own integrator is radiosity, the build of the scene has already logged these warnings.
            let is_own = self.scene.desc().render.integrator == IntegratorDesc::Radiosity;
            let warnings = built.info().not_diffuse.iter().filter(|_| !is_own);
            let callbacks = self.scene.device.callbacks();
            warnings.chain(&built.info().not_in_radiosity).for_each(|it| callbacks.log(ETD_LOG_WARNING, it));
            let mut progress = |fraction| self.progress.report(fraction, initial_progress(ETD_PHASE_RENDER));
            let (baked, solution) = by_radiosity(built, sites, &settings, texel, front, &mut progress)?;
            let notes = solution.notes().to_vec();
            let summary = Summary {
                elapsed: start.elapsed(),
                integrator: IntegratorDesc::Radiosity,
                notes,
                ..Summary::default()
            };
            self.log(&summary);
            return Ok((baked, summary));
        }
        let mut bake = Bake::new(built, sites, settings, front)?;
        let summary = bake.run(&mut |progress| {
            let report = etd_progress {
                rays: progress.rays,
                samples_done: progress.samples_done,
                samples_total: progress.samples_total,
                ..initial_progress(ETD_PHASE_RENDER)
            };
            self.progress.report(progress.fraction, report)
        })?;
        self.log(&summary);
        Ok((bake.irradiance(), summary))
    }

    pub fn log(&self, summary: &Summary) {
        let callbacks = self.scene.device.callbacks();
        summary.notes.iter().for_each(|note| callbacks.log(ETD_LOG_WARNING, note));
    }

    /// # Safety
    /// The contract of [`write_sized`].
    pub unsafe fn finish(&self, summary: &Summary, out_summary: *mut etd_summary) -> Result {
        if !out_summary.is_null() {
            // SAFETY: the caller keeps this function's contract.
            unsafe { write_sized(out_summary, "out_summary", summary_out(summary, Duration::ZERO, summary.stopped)) }?;
        }
        if summary.stopped {
            return Err(Failure::new(ETD_CANCELLED, "the bake was cancelled; the arrays hold what was done"));
        }
        Ok(())
    }
}
