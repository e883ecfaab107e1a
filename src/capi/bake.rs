//! Light maps: layouts, and irradiance into arrays of the host.

use std::ffi::c_char;
use std::ptr;
use std::sync::Arc;
use std::time::{Duration, Instant};

use super::boundary::{
    Header, Object, UserData, give, need, object, on, read_sized, release, retain, take_status, write_sized,
};
use super::device::etd_device;
use super::progress::{BUILD_SHARE, HostProgress, none_yet};
use super::read;
use super::scene::etd_scene;
use super::status::{ETD_CANCELLED, Failure, Result, etd_status};
use super::types::*;
use super::work::{settings_of, summary_out};
use crate::bake::{Atlas, AtlasOptions, Bake, Baked, Layout, VertexOptions, Vertices, by_radiosity};
use crate::desc::IntegratorDesc;
use crate::integrator::Sites;
use crate::render::Summary;
use crate::scene::Scene;

/// Share of the progress that choosing vertices takes, of what follows the build.
const VERTICES_SHARE: f64 = 0.1;

/// The layout of a light map, and the scene that it is of, as it was built then.
pub struct etd_atlas {
    header: Header,
    atlas: Box<Atlas>,
    built: Box<Scene>,
    scene: Arc<etd_scene>,
}
object!(etd_atlas, b"EtAt", "atlas");

// The tag is looked for in whatever object the host passes: it must lie inside the smallest one.
const _: () = assert!(size_of::<etd_atlas>() <= size_of::<etd_device>());

/// Lays out all surfaces of a scene in one square light map; builds the scene first where it has changed.
///
/// `options`: NULL for the defaults of `ETD_ATLAS_OPTIONS_INIT`. On `ETD_OK` `*out_atlas` is one reference; it keeps the scene as
/// it is now, and what is baked later is of that. The same scene gives the same layout. The log callback is told of meshes whose
/// own texture coordinates could not be used. Errors: `ETD_CANCELLED` if the progress callback stopped it; `ETD_INVALID_SCENE` for
/// a scene without a surface, options out of their range, charts that do not fit, and texture coordinates that are no layout where
/// these are asked for; `ETD_OUT_OF_MEMORY`; all that `etd_scene_commit` has. Thread-safe.
///
/// # Safety
/// Pointers must be NULL or point to what they say.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn etd_atlas_new(
    scene: *mut etd_scene,
    options: *const etd_atlas_options,
    out_atlas: *mut *mut etd_atlas,
) -> etd_status {
    // SAFETY: passed on.
    unsafe {
        on(scene, |scene| {
            need(out_atlas, "out_atlas")?;
            let (options, progress) = if options.is_null() {
                (AtlasOptions::default(), HostProgress::new(None, UserData(ptr::null_mut())))
            } else {
                atlas_options(options)?
            };
            let (built, layout) = build(scene, &progress)?;
            let mut look_up = |fraction| layout.tell(fraction, none_yet(ETD_PHASE_BUILD));
            let atlas = Atlas::watched(&built, &options, &mut look_up)?;
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

/// The scene as it is described now, and who tells of what follows.
fn build(scene: &etd_scene, progress: &HostProgress) -> Result<(Scene, HostProgress)> {
    let (built, time) = scene.build(progress.cancel(), progress.part(0.0, BUILD_SHARE).build())?;
    let share = if time.is_zero() { 0.0 } else { BUILD_SHARE };
    Ok((built, progress.part(share, 1.0)))
}

/// # Safety
/// As for [`read_sized`].
unsafe fn atlas_options(options: *const etd_atlas_options) -> Result<(AtlasOptions, HostProgress)> {
    // SAFETY: passed on.
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
    Ok((made, HostProgress::new(it.progress, UserData(it.user_data))))
}

/// One more reference to an atlas. Thread-safe.
///
/// # Safety
/// `atlas` must be NULL or an atlas.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn etd_atlas_retain(atlas: *mut etd_atlas) -> etd_status {
    // SAFETY: passed on.
    unsafe { retain(atlas) }
}

/// Gives back one reference to an atlas; NULL is fine. Thread-safe.
///
/// # Safety
/// `atlas` must be NULL or an atlas of which the caller has a reference.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn etd_atlas_release(atlas: *mut etd_atlas) {
    // SAFETY: passed on.
    unsafe { release(atlas) }
}

/// The first failure of a call on this atlas since this was last asked, and forgets it; `ETD_OK` if there was none.
/// `message`: where its message goes (at most `capacity` bytes with the zero byte), or NULL. Thread-safe.
///
/// # Safety
/// `atlas` must be NULL or an atlas, and `capacity` bytes writable at `message` unless it is NULL.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn etd_atlas_status(atlas: *mut etd_atlas, message: *mut c_char, capacity: usize) -> etd_status {
    // SAFETY: passed on.
    unsafe { take_status(atlas, message, capacity) }
}

/// How large an atlas is, and how many of everything it has. Thread-safe.
///
/// # Safety
/// Pointers must be NULL or point to what they say.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn etd_atlas_get_info(atlas: *const etd_atlas, out_info: *mut etd_atlas_info) -> etd_status {
    // SAFETY: passed on.
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

/// Copies the vertices of an atlas, those of a surface together; one on the seam of two charts is there for each.
///
/// `*out_needed`, unless NULL, is their number; `vertices` may be NULL to ask for that alone. `ETD_INVALID_ARGUMENT` for a capacity
/// below it. Thread-safe.
///
/// # Safety
/// `capacity` vertices must be writable at `vertices` unless it is NULL; other pointers must be NULL or point to what they say.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn etd_atlas_copy_vertices(
    atlas: *const etd_atlas,
    vertices: *mut etd_atlas_vertex,
    capacity: usize,
    out_needed: *mut usize,
) -> etd_status {
    // SAFETY: passed on.
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

/// Copies three vertex numbers for each triangle of an atlas, counter-clockwise seen from outside, those of a surface together and
/// in the order in which they were given. Triangles without an area are left out: `etd_atlas_copy_primitives` says which are there.
///
/// `capacity` and `*out_needed` count numbers, three times the triangles. All else as for `etd_atlas_copy_vertices`. Thread-safe.
///
/// # Safety
/// `capacity` numbers must be writable at `indices` unless it is NULL; other pointers must be NULL or point to what they say.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn etd_atlas_copy_indices(
    atlas: *const etd_atlas,
    indices: *mut u32,
    capacity: usize,
    out_needed: *mut usize,
) -> etd_status {
    // SAFETY: passed on.
    unsafe {
        on(atlas, |atlas| {
            let indices_of = atlas.atlas.triangles().as_flattened();
            copy(indices_of.iter().copied(), indices, capacity, out_needed, "indices")
        })
    }
}

/// Copies for each triangle of an atlas its number in its mesh as it was given; 0 or 1 for the half of a quad; running on other
/// shapes. All else as for `etd_atlas_copy_vertices`. Thread-safe.
///
/// # Safety
/// `capacity` numbers must be writable at `primitives` unless it is NULL; other pointers must be NULL or point to what they say.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn etd_atlas_copy_primitives(
    atlas: *const etd_atlas,
    primitives: *mut u32,
    capacity: usize,
    out_needed: *mut usize,
) -> etd_status {
    // SAFETY: passed on.
    unsafe {
        on(atlas, |atlas| {
            copy(atlas.atlas.primitives().iter().copied(), primitives, capacity, out_needed, "primitives")
        })
    }
}

/// Copies what an atlas has of each surface, in the order of their numbers; removed surfaces and those without an area are missing.
/// All else as for `etd_atlas_copy_vertices`. Thread-safe.
///
/// # Safety
/// `capacity` surfaces must be writable at `surfaces` unless it is NULL; other pointers must be NULL or point to what they say.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn etd_atlas_copy_surfaces(
    atlas: *const etd_atlas,
    surfaces: *mut etd_atlas_surface,
    capacity: usize,
    out_needed: *mut usize,
) -> etd_status {
    // SAFETY: passed on.
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

/// Copies for each texel of an atlas the share that triangles cover, `[height][width]`, row 0 at v = 0; 0 for padding and for what
/// belongs to no chart. All else as for `etd_atlas_copy_vertices`. Thread-safe.
///
/// # Safety
/// `capacity` floats must be writable at `coverage` unless it is NULL; other pointers must be NULL or point to what they say.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn etd_atlas_copy_coverage(
    atlas: *const etd_atlas,
    coverage: *mut f32,
    capacity: usize,
    out_needed: *mut usize,
) -> etd_status {
    // SAFETY: passed on.
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

/// Copies items into the caller's array.
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
        // SAFETY: by the contract.
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

/// Bakes the light map of an atlas into the host's array: irradiance [W m^-2], seams padded.
///
/// `options`: NULL for the scene's own settings. `ETD_INTEGRATOR_RADIOSITY` takes it from a radiosity solution (elements as small as
/// texels unless a size is given; no samples, NaN for standard errors), any other integrator means path tracing. Filter and
/// `finished` are not looked at, depth counts the texel as the first hit, and "pixels" are texels here. `target`: three floats for
/// each texel, `[height][width]`, row 0 at v = 0; with the standard error likewise, if it is asked for. `out_summary`: NULL, or
/// filled. Texels that no triangle covers have the values of the nearest one of their chart, and are 0 beyond the gutter.
///
/// Returns when it is done. What is baked is the scene as it was when the atlas was made, and depends on atlas and options alone, not
/// on threads. Errors: `ETD_CANCELLED` if the progress callback stopped it: the arrays then hold what was done by paths, and what they
/// held before by radiosity; `ETD_INVALID_ARGUMENT` for a target that cannot hold the map; `ETD_OUT_OF_MEMORY` for a radiosity
/// solution beyond `radiosity_memory`. Thread-safe.
///
/// # Safety
/// Pointers must be NULL or point to what they say; `target->size` bytes must be writable.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn etd_atlas_bake(
    atlas: *mut etd_atlas,
    options: *const etd_render_options,
    target: *const etd_bake_target,
    out_summary: *mut etd_summary,
) -> etd_status {
    // SAFETY: passed on.
    unsafe {
        on(atlas, |atlas| {
            let side = atlas.atlas.side() as usize;
            let target = Target::new(target, [side, side])?;
            let job = Job::new(&atlas.scene, options, out_summary)?;
            let texel = 1.0 / atlas.atlas.texels_per_unit();
            let (baked, summary) = job.run(&atlas.built, atlas.atlas.sites(), Some(texel), target.front)?;
            let map = atlas.atlas.light_map(&baked);
            target.write(&map.irradiance, &map.standard_error);
            job.finish(&summary, out_summary)
        })
    }
}

/// Bakes the vertices of one surface into the host's array: irradiance [W m^-2]; builds the scene first where it has
/// changed.
///
/// `surface`: number of the surface. `target`: three floats for each vertex; of a mesh for all its vertices in their order, of a
/// triangle or a quad for the corners. A vertex has the mean irradiance of the part of the surface that is nearest to it (of each
/// triangle around it a third); one of no triangle has 0. `target->row_stride` is not looked at. All else as for
/// `etd_atlas_bake`. Errors: `ETD_INVALID_ARGUMENT` for a number of no surface with vertices of its own, be it removed, and for a
/// target that cannot hold them. Thread-safe.
///
/// # Safety
/// Pointers must be NULL or point to what they say; `target->size` bytes must be writable.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn etd_scene_bake_vertices(
    scene: *mut etd_scene,
    surface: u32,
    options: *const etd_render_options,
    target: *const etd_bake_target,
    out_summary: *mut etd_summary,
) -> etd_status {
    // SAFETY: passed on.
    unsafe {
        on(scene, |scene| {
            let job = Job::new(scene, options, out_summary)?;
            // What is wrong with the target is known before anything is built.
            Target::new(target, [1, 1])?;
            let (built, rest) = build(scene, &job.progress)?;
            let (making, baking) = (rest.part(0.0, VERTICES_SHARE), rest.part(VERTICES_SHARE, 1.0));
            let mut look_up = |fraction| making.tell(fraction, none_yet(ETD_PHASE_BUILD));
            let vertices = Vertices::watched(&built, &VertexOptions::default(), Some(surface), &mut look_up);
            let vertices = match vertices {
                Err(error) if error.kind() == crate::ErrorKind::InvalidScene => {
                    return Err(Failure::argument(format!("surface {surface} does not exist or has no vertices")));
                }
                vertices => vertices?,
            };
            let target = Target::new(target, [vertices.vertices().len(), 1])?;
            let job = Job { progress: baking, ..job };
            let (baked, summary) = job.run(&built, vertices.sites(), None, target.front)?;
            target.write(&vertices.spread(&baked.irradiance), &vertices.spread(&baked.standard_error));
            job.finish(&summary, out_summary)
        })
    }
}

/// Where results go, checked.
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
    /// As for [`read_sized`].
    unsafe fn new(target: *const etd_bake_target, [columns, rows]: [usize; 2]) -> Result<Self> {
        const ITEM: usize = size_of::<[f32; 3]>();
        // SAFETY: passed on.
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

    /// Writes items row by row; missing ones are left out.
    ///
    /// # Safety
    /// What the target's structure said must be writable.
    unsafe fn write(&self, irradiance: &[[f32; 3]], standard_error: &[[f32; 3]]) {
        for (start, values) in [(self.irradiance, irradiance), (self.standard_error, standard_error)] {
            if start.is_null() {
                continue;
            }
            for (row, values) in values.chunks(self.size[0]).take(self.size[1]).enumerate() {
                for (column, value) in values.iter().enumerate() {
                    // SAFETY: inside the size that was checked; the addresses are multiples of a float's.
                    unsafe {
                        let at = start.add(row * self.row_stride + column * self.stride);
                        at.cast::<[f32; 3]>().write(*value);
                    }
                }
            }
        }
    }
}

/// A bake: what the host asked for.
struct Job<'a> {
    scene: &'a Arc<etd_scene>,
    options: etd_render_options,
    progress: HostProgress,
}

impl<'a> Job<'a> {
    /// # Safety
    /// As for [`read_sized`].
    unsafe fn new(
        scene: &'a Arc<etd_scene>,
        options: *const etd_render_options,
        out_summary: *mut etd_summary,
    ) -> Result<Self> {
        let options = if options.is_null() {
            read::render_out(&scene.desc().render)
        } else {
            // SAFETY: passed on.
            unsafe { read_sized(options, "options") }?
        };
        if !out_summary.is_null() {
            // SAFETY: passed on.
            unsafe { read_sized(out_summary.cast_const(), "out_summary") }?;
        }
        let progress = HostProgress::new(options.progress, UserData(options.user_data));
        // Options that no bake could have are refused here.
        settings_of(&options, [1, 1], &scene.device, progress.cancel())?;
        Ok(Self { scene, options, progress })
    }

    /// `texel`: the length of one, where there are any.
    fn run(&self, built: &Scene, sites: &Arc<Sites>, texel: Option<f64>, front: bool) -> Result<(Baked, Summary)> {
        let start = Instant::now();
        let settings = settings_of(&self.options, [1, 1], &self.scene.device, self.progress.cancel())?;
        if settings.desc.integrator == IntegratorDesc::Radiosity {
            // Of the scene's own integrator they were told with the scene.
            let is_own = self.scene.desc().render.integrator == IntegratorDesc::Radiosity;
            let warnings = built.info().not_diffuse.iter().filter(|_| !is_own);
            let callbacks = self.scene.device.callbacks();
            warnings.chain(&built.info().not_in_radiosity).for_each(|it| callbacks.log(ETD_LOG_WARNING, it));
            let mut look_up = |fraction| self.progress.tell(fraction, none_yet(ETD_PHASE_RENDER));
            let (baked, solution) = by_radiosity(built, sites, &settings, texel, front, &mut look_up)?;
            let notes = solution.notes().to_vec();
            let summary = Summary { elapsed: start.elapsed(), notes, ..Summary::default() };
            self.log(&summary);
            return Ok((baked, summary));
        }
        let mut bake = Bake::new(built, sites, settings, front)?;
        let summary = bake.run(&mut |progress| {
            let report = etd_progress {
                rays: progress.rays,
                samples_done: progress.samples_done,
                samples_total: progress.samples_total,
                ..none_yet(ETD_PHASE_RENDER)
            };
            self.progress.tell(progress.fraction, report)
        })?;
        self.log(&summary);
        Ok((bake.irradiance(), summary))
    }

    fn log(&self, summary: &Summary) {
        let callbacks = self.scene.device.callbacks();
        summary.notes.iter().for_each(|note| callbacks.log(ETD_LOG_WARNING, note));
    }

    /// # Safety
    /// As for [`write_sized`].
    unsafe fn finish(&self, summary: &Summary, out_summary: *mut etd_summary) -> Result {
        if !out_summary.is_null() {
            // SAFETY: passed on.
            unsafe { write_sized(out_summary, "out_summary", summary_out(summary, Duration::ZERO, summary.stopped)) }?;
        }
        if summary.stopped {
            return Err(Failure::new(ETD_CANCELLED, "the bake was cancelled; the arrays hold what was done"));
        }
        Ok(())
    }
}
