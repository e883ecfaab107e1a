//! Calls that make, read and build scenes, and calls that return information about them. Calls that describe a scene are in
//! `describe`, `surface` and `mesh`.

use std::collections::HashMap;
use std::ffi::{c_char, c_void};
use std::path::Path;
use std::sync::{Arc, Mutex, TryLockError, Weak};
use std::time::Duration;

use arc_swap::ArcSwapOption;

use super::boundary::{
    ActiveWork, Header, Object, UserData, boundary, copy_text, give, is_active, items, lock, need, object, on,
    optional_text, read_sized, release, retain, share, take_status, text, write_sized,
};
use super::device::etd_device;
use super::progress::{BuildReport, HostProgress};
use super::read;
use super::status::{ETD_INVALID_SCENE, Failure, Result, etd_status};
use super::types::{
    ETD_LOG_INFO, ETD_LOG_WARNING, ETD_TEXT_INFO, ETD_TEXT_WARNINGS, ETD_USAGE_DYNAMIC, ETD_USAGE_STATIC, EtdText,
    etd_progress_fn, etd_render_options, etd_scene_info, etd_scene_options,
};
use crate::Cancel;
use crate::desc::{self, LoadOptions, SceneDesc};
use crate::embree::{Device, DeviceOptions};
use crate::scene::{BuildOptions, Scene};

/// Time between two checks for a cancel in a call that waits for another call to finish building.
const WAIT_INTERVAL: Duration = Duration::from_millis(1);

/// A scene: its description by the host, and the scene that was last built from it.
pub struct etd_scene {
    header: Header,
    pub(super) device: Arc<etd_device>,
    /// An Embree device for this scene alone, so that several scenes of one device can be built at the same time. They share the
    /// device's memory limit.
    kernel: Device,
    state: Mutex<SceneState>,
    surface_paths: Mutex<SurfacePaths>,
    /// The scene that rays are traced in. Edits do not change it before the next build.
    built: ArcSwapOption<Scene>,
    /// Held by the thread that builds.
    building: Mutex<()>,
    /// The description whose fingerprint was asked for last, and the fingerprint.
    fingerprint: Mutex<(Weak<SceneDesc>, u64)>,
}
object!(etd_scene, b"EtSc", "scene");

impl Drop for etd_scene {
    fn drop(&mut self) {
        // No thread of the library may run after the last release, because the host may end the process or unload the
        // library.
        self.kernel.wait_idle();
    }
}

/// The numbers of surfaces by their JSON paths. Surfaces keep path and number, so the table only grows, when it is asked.
#[derive(Default)]
struct SurfacePaths {
    /// All parts of a divided file have the path of the whole.
    numbers: HashMap<Box<str>, Vec<usize>>,
    /// The number of surfaces that the table has.
    seen: usize,
}

struct SceneState {
    desc: Arc<SceneDesc>,
    /// Number of edits so far.
    version: u64,
    /// The version that `built` was built from.
    built_version: Option<u64>,
    dynamic: bool,
}

impl etd_scene {
    fn new(device: &Arc<etd_device>, desc: SceneDesc, dynamic: bool) -> Result<Self> {
        let options = DeviceOptions {
            threads: device.build_threads,
            budget: Some(device.budget.clone()),
            ..DeviceOptions::default()
        };
        for warning in &desc.warnings {
            device.callbacks().log(ETD_LOG_WARNING, warning);
        }
        Ok(Self {
            header: Header::new::<Self>(device.callbacks()),
            device: Arc::clone(device),
            kernel: Device::new(&options)?,
            state: Mutex::new(SceneState { desc: Arc::new(desc), version: 0, built_version: None, dynamic }),
            surface_paths: Mutex::default(),
            built: ArcSwapOption::empty(),
            building: Mutex::new(()),
            fingerprint: Mutex::default(),
        })
    }

    /// The current description.
    pub(super) fn desc(&self) -> Arc<SceneDesc> {
        Arc::clone(&lock(&self.state).desc)
    }

    /// Returns the number of the first surface of a JSON path that was not removed.
    pub(super) fn find_surface(&self, json_path: &str) -> Option<usize> {
        let desc = self.desc();
        let mut paths = lock(&self.surface_paths);
        for (number, surface) in desc.surfaces.iter().enumerate().skip(paths.seen) {
            match paths.numbers.get_mut(surface.path.as_str()) {
                Some(numbers) => numbers.push(number),
                None => drop(paths.numbers.insert(surface.path.as_str().into(), vec![number])),
            }
        }
        paths.seen = paths.seen.max(desc.surfaces.len());
        // Another thread may have added surfaces since, which are in the table and not yet in this description.
        let is_there = |number: &usize| desc.surfaces.get(*number).is_some_and(|surface| !surface.hidden);
        paths.numbers.get(json_path)?.iter().copied().find(is_there)
    }

    /// Changes the description. A change that fails must leave the description as it was.
    pub(super) fn edit<R>(&self, change: impl FnOnce(&mut SceneDesc) -> crate::Result<R>) -> Result<R> {
        let mut state = lock(&self.state);
        let warnings_before = state.desc.warnings.len();
        // A build in progress keeps the description that it began with.
        let outcome = change(Arc::make_mut(&mut state.desc))?;
        state.version += 1;
        let warnings: Vec<String> = state.desc.warnings.iter().skip(warnings_before).cloned().collect();
        drop(state);
        for warning in warnings {
            self.header.callbacks.log(ETD_LOG_WARNING, &warning);
        }
        Ok(outcome)
    }

    /// Changes names that no part of a built scene has: the scene that was built last stays that of the description.
    pub(super) fn rename<R>(&self, change: impl FnOnce(&mut SceneDesc) -> crate::Result<R>) -> Result<R> {
        Ok(change(Arc::make_mut(&mut lock(&self.state).desc))?)
    }

    /// Calls `ask` with the scene that was built last. It is an error before the first build.
    #[inline]
    pub(super) fn with_built<R>(&self, ask: impl FnOnce(&Scene) -> R) -> Result<R> {
        match &*self.built.load() {
            Some(scene) => Ok(ask(scene)),
            None => Err(Failure::operation("the scene was not built: call etd_scene_commit first")),
        }
    }

    /// The fingerprint of a description of this scene, which takes as long as to read all of its meshes and images; the last one is kept.
    pub(super) fn fingerprint(&self, desc: &Arc<SceneDesc>) -> Result<u64> {
        let mut known = lock(&self.fingerprint);
        if !std::ptr::eq(known.0.as_ptr(), Arc::as_ptr(desc)) {
            *known = (Arc::downgrade(desc), desc.fingerprint()?);
        }
        Ok(known.1)
    }

    /// Returns the scene as described now, which is built if it has changed, and the time of the build.
    pub(super) fn build(&self, cancel: &Cancel, progress: BuildReport) -> Result<(Scene, Duration)> {
        self.build_described(cancel, progress).map(|(scene, time, _)| (scene, time))
    }

    /// The same as [`etd_scene::build`], with the description that was built. An edit makes another one.
    pub(super) fn build_described(
        &self,
        cancel: &Cancel,
        progress: BuildReport,
    ) -> Result<(Scene, Duration, Arc<SceneDesc>)> {
        let own = std::ptr::from_ref(self).addr();
        if is_active(own) {
            return Err(Failure::operation("a function that a build of this scene calls cannot wait for the build"));
        }
        // Any of the building threads may report progress.
        let progress = progress.map(|report| {
            Arc::new(move |fraction| {
                let _active = ActiveWork::enter(own);
                report(fraction);
            }) as Arc<dyn Fn(f64) + Send + Sync>
        });
        // These are dropped after `turn` is released, because their drops may call the host.
        let (desc, old): (Arc<SceneDesc>, _);
        let turn = loop {
            match self.building.try_lock() {
                Ok(turn) => break turn,
                Err(TryLockError::Poisoned(turn)) => break turn.into_inner(),
                Err(TryLockError::WouldBlock) => {
                    cancel.check()?;
                    std::thread::sleep(WAIT_INTERVAL);
                }
            }
        };
        cancel.check()?;
        let (version, dynamic, is_current) = {
            let state = lock(&self.state);
            desc = Arc::clone(&state.desc);
            (state.version, state.dynamic, state.built_version == Some(state.version))
        };
        old = self.built.load_full();
        if let (Some(built), true) = (&old, is_current) {
            return Ok((Scene::clone(built), Duration::ZERO, Arc::clone(&desc)));
        }
        let options = BuildOptions {
            threads: self.device.build_threads,
            device: Some(self.kernel.clone()),
            dynamic,
            cancel: cancel.clone(),
            progress,
            ..BuildOptions::default()
        };
        let scene = match &old {
            Some(old) => old.rebuild(&desc, &options)?,
            None => Scene::build(&desc, &options)?,
        };
        let built = Arc::new(scene.clone());
        self.built.store(Some(built));
        lock(&self.state).built_version = Some(version);
        drop(turn);
        let callbacks = &self.header.callbacks;
        let had = |warning: &String| old.as_ref().is_some_and(|old| old.warnings().contains(warning));
        for warning in scene.warnings().iter().filter(|warning| !had(warning)) {
            callbacks.log(ETD_LOG_WARNING, warning);
        }
        let time = scene.info().build_time;
        callbacks.log(ETD_LOG_INFO, &format!("scene built in {:.1} ms", 1e3 * time.as_secs_f64()));
        Ok((scene, time, desc))
    }
}

/// How a scene is made.
struct SceneOptions<'a> {
    dynamic: bool,
    base_dir: &'a Path,
    params: Option<&'a Path>,
    /// How it is read.
    load: LoadOptions,
}

/// # Safety
/// The contract of [`read_sized`], and for the strings in the structure that of [`optional_text`].
unsafe fn read_options<'a>(options: *const etd_scene_options) -> Result<SceneOptions<'a>> {
    if options.is_null() {
        let load = LoadOptions::default();
        return Ok(SceneOptions { dynamic: false, base_dir: Path::new("."), params: None, load });
    }
    // SAFETY: the caller keeps this function's contract.
    let (it, base_dir, params) = unsafe {
        let it = read_sized(options, "options")?;
        (it, optional_text(it.base_dir, "options.base_dir")?, optional_text(it.params_file, "options.params_file")?)
    };
    if it.reserved != 0 {
        return Err(Failure::argument("options.reserved is not 0"));
    }
    let dynamic = match read::enumeration("options.usage", it.usage)? {
        ETD_USAGE_STATIC => false,
        ETD_USAGE_DYNAMIC => true,
    };
    let base_dir = Path::new(if base_dir.is_empty() { "." } else { base_dir });
    let progress = HostProgress::new(it.progress, UserData(it.user_data));
    let load = LoadOptions { cancel: progress.cancel().clone(), progress: progress.build(), ..LoadOptions::default() };
    Ok(SceneOptions { dynamic, base_dir, params: (!params.is_empty()).then_some(Path::new(params)), load })
}

/// Makes an empty scene with the default camera, which calls then describe.
///
/// `options`: NULL for the defaults. On `ETD_OK`, `*out_scene` is one reference. The scene keeps its device alive. Thread-safe.
///
/// # Safety
/// Each pointer must be NULL or point to a value of its type.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn etd_scene_new(
    device: *mut etd_device,
    options: *const etd_scene_options,
    out_scene: *mut *mut etd_scene,
) -> etd_status {
    // SAFETY: the caller keeps this function's contract.
    unsafe {
        make(device, options, out_scene, |options| {
            if options.params.is_some() {
                return Err(Failure::argument("options.params_file is for scenes that are read"));
            }
            Ok(SceneDesc::default())
        })
    }
}

/// Reads a scene from text in this library's JSON format or in that of the report's renderer.
///
/// `json`: `json_length` bytes of UTF-8, which need not end with a zero byte. Paths of mesh files are relative to
/// `options->base_dir`. On `ETD_OK`, `*out_scene` is one reference. On an error, `*out_scene` is not changed, and the message
/// contains line and JSON path. The scene is built by `etd_scene_commit` or by the first render. Thread-safe.
///
/// # Safety
/// Each pointer must be NULL or point to a value of its type.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn etd_scene_from_json(
    device: *mut etd_device,
    json: *const c_char,
    json_length: usize,
    options: *const etd_scene_options,
    out_scene: *mut *mut etd_scene,
) -> etd_status {
    // SAFETY: the caller keeps this function's contract.
    unsafe {
        make(device, options, out_scene, |options| {
            need(json, "json")?;
            let bytes = items(json.cast::<u8>(), json_length, "json")?;
            let json = std::str::from_utf8(bytes)
                .map_err(|error| Failure::new(ETD_INVALID_SCENE, format!("the scene is not UTF-8: {error}")))?;
            let mut scene = desc::parse_with(json, options.base_dir, None, &options.load)?;
            if let Some(file) = options.params {
                desc::load_params(file, &mut scene)?;
            }
            Ok(scene)
        })
    }
}

/// Reads a scene from a file: of glTF 2.0 where its name ends in `.gltf` or `.glb`, otherwise JSON. Paths of mesh files are relative
/// to the file's folder, and `options->base_dir` is ignored.
///
/// A file whose name ends in `.obj`, `.ply` or `.stl` is a scene by itself: its surfaces, seen as a whole by a camera that is
/// made for them, under an even sky where nothing in them emits a radiance above 1. All other files are read as JSON.
///
/// Images are decoded by several threads. `options->progress` is told how far the reading of mesh files and images is, and may cancel it
/// within a file: `ETD_CANCELLED`. A program that is not to wait calls this on a thread of its own.
///
/// `path`: UTF-8. All else is as for `etd_scene_from_json`. Thread-safe.
///
/// # Safety
/// Each pointer must be NULL or point to a value of its type.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn etd_scene_from_file(
    device: *mut etd_device,
    path: *const c_char,
    options: *const etd_scene_options,
    out_scene: *mut *mut etd_scene,
) -> etd_status {
    // SAFETY: the caller keeps this function's contract.
    unsafe {
        make(device, options, out_scene, |options| {
            let path = text(path, "path")?;
            Ok(desc::load_with(Path::new(path), options.params, &options.load)?)
        })
    }
}

/// # Safety
/// The contract of the three functions above.
unsafe fn make(
    device: *mut etd_device,
    options: *const etd_scene_options,
    out_scene: *mut *mut etd_scene,
    describe: impl FnOnce(&SceneOptions<'_>) -> Result<SceneDesc>,
) -> etd_status {
    // SAFETY: the caller keeps this function's contract.
    let owner = unsafe { share(device) };
    let header = owner.as_ref().ok().map(Arc::clone);
    boundary(header.as_ref().map(|device| device.header()), || {
        let device = owner?;
        need(out_scene, "out_scene")?;
        // SAFETY: the caller keeps this function's contract.
        let options = unsafe { read_options(options) }?;
        let desc = describe(&options)?;
        give(Arc::new(etd_scene::new(&device, desc, options.dynamic)?), out_scene);
        Ok(())
    })
}

/// Adds a reference to a scene. Thread-safe.
///
/// # Safety
/// `scene` must be NULL or a scene.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn etd_scene_retain(scene: *mut etd_scene) -> etd_status {
    // SAFETY: the caller keeps this function's contract.
    unsafe { retain(scene) }
}

/// Releases a reference to a scene; NULL is allowed. Tasks that render a scene keep it alive. Thread-safe.
///
/// # Safety
/// `scene` must be NULL or a scene of which the caller has a reference.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn etd_scene_release(scene: *mut etd_scene) {
    // SAFETY: the caller keeps this function's contract.
    unsafe { release(scene) }
}

/// Takes the first failure of a call on this scene since the last time that it was taken: returns its status, or `ETD_OK` if
/// there was none, and forgets the failure.
///
/// A host may thus describe a scene by many calls and check once. `message`: receives the message, at most `capacity` bytes
/// including the zero byte, unless it is NULL. Thread-safe.
///
/// # Safety
/// `scene` must be NULL or a scene, and `capacity` bytes writable at `message` unless it is NULL.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn etd_scene_status(scene: *mut etd_scene, message: *mut c_char, capacity: usize) -> etd_status {
    // SAFETY: the caller keeps this function's contract.
    unsafe { take_status(scene, message, capacity) }
}

/// Builds the parts of the scene that have changed since the last build. It returns at once if nothing has changed.
///
/// Renders build the scene themselves. Ray queries use the scene as last built. Renders in progress continue with the scene
/// that they began with. `progress` may be NULL; it is called on a building thread, and cancels the build if it returns
/// anything but 0. Errors: errors of the description that only a build can find, `ETD_CANCELLED`, `ETD_OUT_OF_MEMORY`; after an
/// error, the scene as last built stays in use. Thread-safe.
///
/// # Safety
/// `scene` must be NULL or a scene, and `progress` NULL or a function of its type.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn etd_scene_commit(
    scene: *mut etd_scene,
    progress: etd_progress_fn,
    user_data: *mut c_void,
) -> etd_status {
    // SAFETY: the caller keeps this function's contract.
    unsafe {
        on(scene, |scene| {
            let progress = HostProgress::new(progress, UserData(user_data));
            scene.build(progress.cancel(), progress.build())?;
            Ok(())
        })
    }
}

/// Returns counts, memory and extent of the scene as last built. It is an error before the first build. Thread-safe.
///
/// # Safety
/// `scene` must be NULL or a scene, `out_info` NULL or a structure of the size in its `struct_size`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn etd_scene_get_info(scene: *const etd_scene, out_info: *mut etd_scene_info) -> etd_status {
    // SAFETY: the caller keeps this function's contract.
    unsafe {
        on(scene, |scene| {
            let desc = scene.desc();
            let info = scene.with_built(|built| {
                let info = built.info();
                let (min, max) = (info.bounds.min, info.bounds.max);
                etd_scene_info {
                    struct_size: size_of::<etd_scene_info>(),
                    surfaces: desc.surfaces.len() as u64,
                    materials: desc.materials.len() as u64,
                    meshes: desc.meshes.len() as u64,
                    point_lights: desc.lights.len() as u64,
                    triangles: info.triangles as u64,
                    instances: info.instances as u64,
                    shared_triangles: info.shared_triangles as u64,
                    analytic_shapes: (info.listed_shapes + info.embree_shapes) as u64,
                    emitters: info.emitters as u64,
                    geometry_bytes: info.geometry_bytes as u64,
                    hierarchy_bytes: info.embree_bytes as u64,
                    bounds_min: min.to_array(),
                    bounds_max: max.to_array(),
                    build_time: info.build_time.as_secs_f64(),
                    textures: info.textures as u64,
                    texture_bytes: info.texture_bytes as u64,
                }
            })?;
            write_sized(out_info, "out_info", info)
        })
    }
}

/// Copies a text about the scene to the caller's buffer. `text`: an `etd_text`.
///
/// At most `capacity` bytes, including the zero byte, are written. `*out_needed` receives the size of the whole text with its
/// zero byte, unless `out_needed` is NULL. `buffer` may be NULL to get the size only. `ETD_TEXT_INFO` is an error before the
/// first build. Thread-safe.
///
/// # Safety
/// Each pointer must be NULL or point to a value of its type.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn etd_scene_copy_text(
    scene: *const etd_scene,
    which: EtdText,
    buffer: *mut c_char,
    capacity: usize,
    out_needed: *mut usize,
) -> etd_status {
    // SAFETY: the caller keeps this function's contract.
    unsafe {
        on(scene, |scene| {
            let text = match read::enumeration("which", which)? {
                ETD_TEXT_INFO => scene.with_built(|built| built.info().to_string())?,
                ETD_TEXT_WARNINGS => {
                    let mut lines = scene.desc().warnings.clone();
                    if let Some(built) = &*scene.built.load() {
                        lines.extend(built.warnings().iter().cloned());
                    }
                    lines.join("\n")
                }
            };
            copy_text(&text, buffer, capacity, out_needed)
        })
    }
}

/// Returns the settings of the scene's own `render` block, or the defaults where it has none. A host may change them and pass
/// them to a render. Thread-safe.
///
/// # Safety
/// `scene` must be NULL or a scene, `out_options` NULL or a structure of the size in its `struct_size`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn etd_scene_get_render_options(
    scene: *const etd_scene,
    out_options: *mut etd_render_options,
) -> etd_status {
    // SAFETY: the caller keeps this function's contract.
    unsafe { on(scene, |scene| write_sized(out_options, "out_options", read::render_out(&scene.desc().render))) }
}

/// Returns the size of the film that the scene's own `render` block asks for: its `crop`, or its `resolution`, or 256 x 256 where it
/// has neither. Thread-safe.
///
/// # Safety
/// Each pointer must be NULL or point to a value of its type.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn etd_scene_get_resolution(
    scene: *const etd_scene,
    out_width: *mut u32,
    out_height: *mut u32,
) -> etd_status {
    // SAFETY: the caller keeps this function's contract.
    unsafe {
        on(scene, |scene| {
            need(out_width, "out_width")?;
            need(out_height, "out_height")?;
            let [width, height] = scene.desc().render.film_size();
            out_width.write(width);
            out_height.write(height);
            Ok(())
        })
    }
}
