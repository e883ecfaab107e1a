//! Films, whose images are mapped without a copy.

use std::alloc::{Layout, alloc_zeroed};
use std::collections::HashMap;
use std::ffi::c_char;
use std::sync::{Arc, Mutex, Weak};
use std::time::Duration;

use super::boundary::{
    Header, Object, give, lock, need, object, on, read_sized, release, retain, take_status, write_sized,
};
use super::device::etd_device;
use super::film_size::{bytes_when_new, check_size};
use super::status::{ETD_OUT_OF_MEMORY, Failure, Result, etd_status};
use super::types::*;
use super::work::summary_out;
use crate::desc::SceneDesc;
use crate::embree::Charge;
use crate::film::{ErrorMeasure, Film, LayerKind, Shown};
use crate::output::{Attribute, summary_attributes};
use crate::render::{Checkpoint, Share, Summary};
use crate::{Alone, Cancel};

/// The layers besides the colour that are images.
pub(super) const LAYERS: [(etd_layer, LayerKind); 10] = [
    (ETD_LAYER_ALBEDO, LayerKind::Albedo),
    (ETD_LAYER_NORMAL, LayerKind::Normal),
    (ETD_LAYER_DEPTH, LayerKind::Depth),
    (ETD_LAYER_SAMPLES, LayerKind::Samples),
    (ETD_LAYER_VARIANCE, LayerKind::Variance),
    (ETD_LAYER_STANDARD_ERROR, LayerKind::StandardError),
    (ETD_LAYER_BIAS, LayerKind::Bias),
    (ETD_LAYER_EMISSION, LayerKind::Emission),
    (ETD_LAYER_DIRECT, LayerKind::Direct),
    (ETD_LAYER_INDIRECT, LayerKind::Indirect),
];

/// All bits that layers use.
const ALL_LAYERS: u32 = 4095;

/// Layers that need the first hit of each sample.
pub(super) const FIRST_HIT: u32 =
    ETD_LAYER_ALBEDO as u32 | ETD_LAYER_NORMAL as u32 | ETD_LAYER_DEPTH as u32 | ETD_LAYER_ALPHA as u32;

/// Layers that need light to be kept apart by how often it was scattered.
pub(super) const LIGHT_PARTS: u32 = ETD_LAYER_EMISSION as u32 | ETD_LAYER_DIRECT as u32 | ETD_LAYER_INDIRECT as u32;

/// A developed image: the colour with alpha, and the layers that the film keeps.
#[derive(Default)]
pub(super) struct DevelopedImage {
    rgba: Vec<f32>,
    layers: Vec<(LayerKind, Vec<f32>)>,
    resolution: [u32; 2],
    samples: u32,
    /// The sums that the image shows, and how much of them.
    sums: Weak<Film>,
    shown: Shown,
}

impl DevelopedImage {
    /// The colour with alpha.
    pub fn rgba(&self) -> &[f32] {
        &self.rgba
    }

    pub fn resolution(&self) -> [u32; 2] {
        self.resolution
    }

    fn is_of(&self, sums: &Arc<Film>) -> bool {
        std::ptr::eq(self.sums.as_ptr(), Arc::as_ptr(sums))
    }
}

/// A film: its resolution, its layers and its newest image.
pub struct etd_film {
    header: Header,
    layers: u32,
    state: Mutex<FilmState>,
    device: Arc<etd_device>,
}
object!(etd_film, b"EtFi", "film");

/// A summary as attributes of a file, by their names.
type Attributes = Vec<(String, Attribute)>;

struct FilmState {
    resolution: [u32; 2],
    /// How often the film was resized, which tells images of before apart.
    resizes: u64,
    /// The film's part of the device's memory limit.
    charge: Charge,
    /// Whether a render uses the film.
    busy: bool,
    /// Number of those who read the state of the last render, which no render may change meanwhile.
    readers: usize,
    /// The newest image, which the next map shows.
    front: Arc<DevelopedImage>,
    /// An image that is not mapped any more, whose memory the next image uses.
    spare: Option<DevelopedImage>,
    /// Number of images so far.
    images: u32,
    /// Sums that are newer than `front`, and their number of samples. The next call that needs an image develops them.
    undeveloped: Option<(Arc<Film>, u32)>,
    /// The mapped images by the number of their map.
    maps: HashMap<u64, Arc<DevelopedImage>>,
    next_map: u64,
    /// The sums of the last render.
    sums: Option<Arc<Film>>,
    /// The state of the last render, once it has ended.
    kept: Option<Kept>,
    summary: Option<etd_summary>,
    /// The summary as attributes of an EXR's header.
    attributes: Attributes,
}

/// The state of a render, to be saved or gone on from.
#[derive(Clone)]
struct Kept {
    checkpoint: Checkpoint,
    /// What was rendered, as long as it was not edited or released; `None` where the state was loaded. Of it the fingerprint is made when
    /// the state is asked for, so that no other render takes the time. It keeps no arrays of the host.
    desc: Option<Weak<SceneDesc>>,
}

impl etd_film {
    /// A black film, or one with the state of a render.
    fn make(
        device: &Arc<etd_device>,
        resolution: [u32; 2],
        layers: u32,
        charge: Charge,
        state: Option<Checkpoint>,
    ) -> Result<Arc<Self>> {
        let sums = state.as_ref().map(|state| Arc::clone(state.film()));
        let samples = state.as_ref().map_or(0, Checkpoint::samples);
        let film = Self {
            header: Header::new::<Self>(device.callbacks()),
            layers,
            state: Mutex::new(FilmState {
                resolution,
                resizes: 0,
                charge,
                busy: false,
                readers: 0,
                front: Arc::default(),
                spare: None,
                images: 0,
                undeveloped: sums.clone().map(|sums| (sums, samples)),
                maps: HashMap::new(),
                next_map: 1,
                sums,
                kept: state.map(|checkpoint| Kept { checkpoint, desc: None }),
                summary: None,
                attributes: Vec::new(),
            }),
            device: Arc::clone(device),
        };
        let black = film.frame(resolution)?;
        lock(&film.state).front = Arc::new(black);
        Ok(Arc::new(film))
    }

    /// A film with the state of a render.
    pub(super) fn of_state(
        device: &Arc<etd_device>,
        layers: u32,
        charge: Charge,
        state: Checkpoint,
    ) -> Result<Arc<Self>> {
        let resolution = state.film().options().resolution;
        Self::make(device, resolution, layers, charge, Some(state))
    }

    /// Number of pixels in a row and number of rows.
    pub(super) fn resolution(&self) -> [u32; 2] {
        lock(&self.state).resolution
    }

    /// Makes this a black film of another resolution, which takes so many bytes of the device's memory limit. Maps stay as they are. It is
    /// an error while the film is in use.
    pub(super) fn resize(&self, resolution: [u32; 2], bytes: usize) -> Result {
        // Before the image takes memory that the limit does not leave.
        let room = {
            let state = lock(&self.state);
            state.check_free()?;
            self.device.budget.try_charge(bytes.saturating_sub(state.charge.bytes()))?
        };
        let black = Arc::new(self.frame(resolution)?);
        drop(room);
        let mut state = lock(&self.state);
        state.check_free()?;
        state.charge.resize(bytes)?;
        state.resolution = resolution;
        state.resizes += 1;
        // What there was is dropped once the lock is free.
        let old = (
            std::mem::replace(&mut state.front, black),
            state.spare.take(),
            state.undeveloped.take(),
            state.sums.take(),
            state.kept.take(),
        );
        state.summary = None;
        state.attributes.clear();
        // The number of images goes on, so that a host that waits for another number notices the next image.
        drop(state);
        drop(old);
        Ok(())
    }

    /// Bits of the layers that the film keeps.
    pub(super) fn layers(&self) -> u32 {
        self.layers
    }

    /// Reserves the state of the last render, so that no render changes it. It is an error while a render uses the film.
    pub(super) fn begin_reading(&self) -> Result {
        let mut state = lock(&self.state);
        if state.busy {
            return Err(Failure::operation("the film is being rendered to: wait for its task"));
        }
        state.readers += 1;
        Ok(())
    }

    /// Ends what [`etd_film::begin_reading`] has begun.
    pub(super) fn end_reading(&self) {
        lock(&self.state).readers -= 1;
    }

    /// Keeps the state of a render that has ended. `desc` is what was rendered.
    pub(super) fn keep(&self, checkpoint: Checkpoint, desc: Weak<SceneDesc>) {
        lock(&self.state).kept = Some(Kept { checkpoint, desc: Some(desc) });
    }

    /// The state of the last render, which knows its scene. The film must be reserved.
    pub(super) fn kept(&self) -> Result<Checkpoint> {
        let kept = lock(&self.state).kept.clone();
        let Some(Kept { mut checkpoint, desc }) = kept else {
            return Err(Failure::operation("nothing was rendered to the film yet, or its last render has failed"));
        };
        if let (Some(desc), false) = (desc, checkpoint.knows_scene()) {
            let desc = desc.upgrade().ok_or_else(|| {
                Failure::operation(
                    "the scene was edited or released since it was rendered, so its fingerprint is not known: save the film \
                     before that, or render with checkpoint_file or share_count",
                )
            })?;
            let fingerprint = desc.fingerprint()?;
            checkpoint.set_scene(fingerprint);
            if let Some(kept) = &mut lock(&self.state).kept {
                kept.checkpoint.set_scene(fingerprint);
            }
        }
        Ok(checkpoint)
    }

    /// The part of the picture that the last render was of.
    pub(super) fn share(&self) -> Result<Option<Share>> {
        let state = lock(&self.state);
        match &state.kept {
            Some(kept) => Ok(kept.checkpoint.share()),
            None if state.busy => Err(Failure::operation("the film is being rendered to: wait for its task")),
            None => Err(Failure::operation("nothing was rendered to the film yet, or its last render has failed")),
        }
    }

    /// Makes the summary of a film that was loaded or merged, of which no render has said one.
    fn summarise(&self) {
        let checkpoint = {
            let state = lock(&self.state);
            match &state.kept {
                Some(kept) if state.summary.is_none() => kept.checkpoint.clone(),
                _ => return,
            }
        };
        let film = checkpoint.film();
        let estimates = film.estimates(&ErrorMeasure::ALL, &mut Alone::default()).unwrap_or_default();
        let summary = Summary {
            samples: checkpoint.samples(),
            sample_counts: estimates.counts.or_else(|| Some(film.counts())),
            rays: checkpoint.rays(),
            rel_mse: estimates.rel_mse,
            display_error: estimates.display,
            non_finite: film.non_finite(),
            ..Summary::default()
        };
        let mut attributes = summary_attributes(&summary);
        // How the renders ended is not known, nor what was chosen.
        attributes.retain(|(name, _)| name != "ended" && name != "integrator");
        let mut state = lock(&self.state);
        // Another thread may have been faster, or a render may have begun.
        if state.summary.is_none() && state.sums.as_ref().is_some_and(|sums| Arc::ptr_eq(sums, film)) {
            state.summary = Some(summary_out(&summary, Duration::ZERO, false));
            state.attributes = attributes;
        }
    }

    /// The summary of the last render.
    pub(super) fn summary(&self) -> Result<etd_summary> {
        self.summarise();
        let summary = lock(&self.state).summary;
        summary.ok_or_else(|| Failure::operation("no render has ended on this film yet"))
    }

    /// The sums of the last render, and its summary as attributes of a file.
    pub(super) fn newest_sums(&self) -> Result<(Arc<Film>, Attributes)> {
        self.summarise();
        let state = lock(&self.state);
        let sums = state.sums.clone().ok_or_else(|| Failure::operation("nothing was rendered to the film yet"))?;
        Ok((sums, state.attributes.clone()))
    }

    /// Whether renders have to keep first hits for the film's layers.
    pub(super) fn keeps_first_hits(&self) -> bool {
        self.layers & FIRST_HIT != 0
    }

    /// Whether renders have to keep parts of the light apart for the film's layers.
    pub(super) fn keeps_light_parts(&self) -> bool {
        self.layers & LIGHT_PARTS != 0
    }

    /// Reserves the film for a render of this resolution. It is an error while another render uses the film, and where the film has
    /// another resolution by now.
    pub(super) fn begin(&self, resolution: [u32; 2]) -> Result {
        let mut state = lock(&self.state);
        state.check_free()?;
        if state.resolution != resolution {
            let [[width, height], [new_width, new_height]] = [resolution, state.resolution];
            let message = format!(
                "the film was resized to {new_width} x {new_height} pixels since the render to {width} x {height} was begun: \
                 begin another one"
            );
            return Err(Failure::operation(message));
        }
        state.busy = true;
        Ok(())
    }

    /// Ends the use of the film by a render.
    pub(super) fn end(&self, summary: Option<etd_summary>) {
        let mut state = lock(&self.state);
        state.busy = false;
        if summary.is_some() {
            state.summary = summary;
        }
    }

    /// Sets the sums of the current render.
    pub(super) fn set_sums(&self, sums: &Arc<Film>) {
        let mut state = lock(&self.state);
        state.sums = Some(Arc::clone(sums));
        state.kept = None;
        // The attributes belong to the previous sums.
        state.attributes.clear();
    }

    /// Sets the summary of the last render, as attributes of files.
    pub(super) fn set_attributes(&self, attributes: Attributes) {
        lock(&self.state).attributes = attributes;
    }

    /// Number of images so far.
    pub(super) fn images(&self) -> u32 {
        lock(&self.state).images
    }

    /// Whether the newest image lacks samples of these sums.
    pub(super) fn has_news(&self, sums: &Arc<Film>) -> bool {
        let front = Arc::clone(&lock(&self.state).front);
        if front.is_of(sums) { sums.has_changed(&front.shown) } else { sums.has_changed(&Shown::default()) }
    }

    /// Develops the current sums to the film's newest image. Returns `false` if that was cancelled. The film must be reserved.
    pub(super) fn publish(&self, sums: &Arc<Film>, samples: u32, cancel: &Cancel) -> Result<bool> {
        let resizes = lock(&self.state).resizes;
        self.develop(sums, samples, cancel, resizes)
    }

    /// Develops sums to the film's newest image, unless the film was resized since it had them. Returns `false` if that was cancelled.
    ///
    /// `resizes`: how often the film had been resized when it had the sums.
    fn develop(&self, sums: &Arc<Film>, samples: u32, cancel: &Cancel, resizes: u64) -> Result<bool> {
        let resolution = sums.options().resolution;
        let spare = lock(&self.state).spare.take().filter(|frame| frame.resolution == resolution);
        let mut frame = match spare {
            Some(frame) => frame,
            None => self.frame(resolution)?,
        };
        frame.samples = samples;
        let with_alpha = self.layers & ETD_LAYER_ALPHA as u32 != 0;
        if !frame.is_of(sums) {
            (frame.sums, frame.shown) = (Arc::downgrade(sums), Shown::default());
        }
        let is_whole = sums.read_into(&mut frame.rgba, with_alpha, &mut frame.layers, &mut frame.shown, cancel)?;
        let mut state = lock(&self.state);
        if state.resizes != resizes {
            return Ok(is_whole);
        }
        if is_whole {
            let old = std::mem::replace(&mut state.front, Arc::new(frame));
            state.images = state.images.wrapping_add(1);
            state.undeveloped = None;
            state.recycle(old);
        } else {
            state.spare.get_or_insert(frame);
        }
        Ok(is_whole)
    }

    /// Stores sums that are developed when a call needs an image.
    pub(super) fn publish_later(&self, sums: &Arc<Film>, samples: u32) {
        lock(&self.state).undeveloped = Some((Arc::clone(sums), samples));
    }

    /// Returns the newest image.
    pub(super) fn newest(&self) -> Result<Arc<DevelopedImage>> {
        let (undeveloped, resizes) = {
            let mut state = lock(&self.state);
            (state.undeveloped.take(), state.resizes)
        };
        if let Some((sums, samples)) = undeveloped {
            self.develop(&sums, samples, &Cancel::new(), resizes)?;
        }
        Ok(Arc::clone(&lock(&self.state).front))
    }

    pub(super) fn device(&self) -> &Arc<etd_device> {
        &self.device
    }

    fn frame(&self, resolution: [u32; 2]) -> Result<DevelopedImage> {
        let pixels = resolution[0] as usize * resolution[1] as usize;
        let kept = LAYERS.iter().filter(|(layer, _)| self.layers & *layer as u32 != 0);
        let layers = kept.map(|(_, kind)| Ok((*kind, zeros(pixels * kind.channels())?)));
        let (rgba, layers) = (zeros(4 * pixels)?, layers.collect::<Result<_>>()?);
        Ok(DevelopedImage { rgba, layers, resolution, ..DevelopedImage::default() })
    }

    /// Returns the data of a layer and its number of channels.
    pub(super) fn layer<'f>(&self, frame: &'f DevelopedImage, layer: u32) -> Result<(&'f [f32], usize)> {
        if layer == ETD_LAYER_COLOR as u32 {
            return Ok((&frame.rgba, 4));
        }
        let Some((_, wanted)) = LAYERS.iter().find(|(known, _)| *known as u32 == layer) else {
            return Err(Failure::argument(format!(
                "layer is {layer}, expected one etd_layer with an image of its own"
            )));
        };
        match frame.layers.iter().find(|(kind, _)| kind == wanted) {
            Some((kind, data)) => Ok((data, kind.channels())),
            None => Err(Failure::operation(format!("the film does not keep {wanted:?}: ask for it in its options"))),
        }
    }
}

impl FilmState {
    /// Fails while a render uses the film, or somebody reads the state of its last render.
    fn check_free(&self) -> Result {
        if self.busy {
            return Err(Failure::operation("the film is being rendered to: wait for its task, or use another film"));
        }
        if self.readers > 0 {
            return Err(Failure::operation(
                "the film is being saved, merged or gone on from: wait, or use another film",
            ));
        }
        Ok(())
    }

    /// Keeps the memory of an image that is not mapped any more, if the film still has its resolution.
    fn recycle(&mut self, frame: Arc<DevelopedImage>) {
        if frame.resolution != self.resolution {
            return;
        }
        if let (None, Some(frame)) = (&self.spare, Arc::into_inner(frame)) {
            self.spare = Some(frame);
        }
    }
}

/// Allocates `count` zeros, with an error where there is no memory. The system provides zeroed memory, whose pages take no
/// room before they are written.
fn zeros(count: usize) -> Result<Vec<f32>> {
    let no_room = || Failure::new(ETD_OUT_OF_MEMORY, format!("no room for an image of {count} values"));
    let layout = Layout::array::<f32>(count).map_err(|_| no_room())?;
    if layout.size() == 0 {
        return Ok(Vec::new());
    }
    // SAFETY: the layout is that of an array of `count` floats and not empty, and zero bytes are valid floats.
    unsafe {
        let start = alloc_zeroed(layout).cast::<f32>();
        if start.is_null() {
            return Err(no_room());
        }
        Ok(Vec::from_raw_parts(start, count, count))
    }
}

/// Makes a film. The film is black and has no samples.
///
/// `options` must contain the resolution. Any number of renders may use the film, one at a time. On `ETD_OK`, `*out_film` is
/// one reference. Errors: `ETD_INVALID_ARGUMENT` for a resolution out of range or a layer that does not exist,
/// `ETD_OUT_OF_MEMORY` if the film exceeds the device's memory limit. A film takes 240 to 560 bytes for each pixel of its tiles
/// of 16 x 16 pixels, which count as a whole. Mapped images beyond the second do not count. Thread-safe.
///
/// # Safety
/// Each pointer must be NULL or point to a value of its type.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn etd_film_new(
    device: *mut etd_device,
    options: *const etd_film_options,
    out_film: *mut *mut etd_film,
) -> etd_status {
    // SAFETY: the caller keeps this function's contract.
    unsafe {
        on(device, |device| {
            need(out_film, "out_film")?;
            let it = read_sized(options, "options")?;
            let resolution = [it.width, it.height];
            check_size(resolution, "options.")?;
            check_layers(&it)?;
            let charge = device.budget.try_charge(bytes_when_new(resolution, it.layers))?;
            let film = etd_film::make(device, resolution, it.layers, charge, None)?;
            give(film, out_film);
            Ok(())
        })
    }
}

/// Checks the layers that are asked for.
pub(super) fn check_layers(options: &etd_film_options) -> Result {
    if options.layers & !ALL_LAYERS != 0 {
        let message = format!("options.layers is {:#x}, expected bits of {ALL_LAYERS:#x} alone", options.layers);
        return Err(Failure::argument(message));
    }
    if options.reserved != 0 {
        return Err(Failure::argument("options.reserved is not 0"));
    }
    Ok(())
}

/// Adds a reference to a film. Thread-safe.
///
/// # Safety
/// `film` must be NULL or a film.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn etd_film_retain(film: *mut etd_film) -> etd_status {
    // SAFETY: the caller keeps this function's contract.
    unsafe { retain(film) }
}

/// Releases a reference to a film; NULL is allowed. Tasks that render to a film keep it alive. The release of the last
/// reference ends all maps of the film. Thread-safe.
///
/// # Safety
/// `film` must be NULL or a film of which the caller has a reference.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn etd_film_release(film: *mut etd_film) {
    // SAFETY: the caller keeps this function's contract.
    unsafe { release(film) }
}

/// Takes the first failure of a call on this film since the last time that it was taken: returns its status, or `ETD_OK` if
/// there was none, and forgets the failure.
/// `message`: receives the message, at most `capacity` bytes including the zero byte, unless it is NULL. Thread-safe.
///
/// # Safety
/// `film` must be NULL or a film, and `capacity` bytes writable at `message` unless it is NULL.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn etd_film_status(film: *mut etd_film, message: *mut c_char, capacity: usize) -> etd_status {
    // SAFETY: the caller keeps this function's contract.
    unsafe { take_status(film, message, capacity) }
}

/// Maps a layer of the newest image for reading: `*out_map` receives a pointer to it.
///
/// The call is allowed while a render uses the film. The image is then that of the last complete pass, or, during a long pass,
/// that of a moment in it. A mapped image does not change. After a cancelled render, the first call develops the image; at any
/// other time nothing is copied. Each map must be ended by one call of `etd_film_unmap`. `layer`: one `etd_layer` that the film
/// keeps. Thread-safe.
///
/// # Safety
/// Each pointer must be NULL or point to a value of its type.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn etd_film_map(film: *mut etd_film, layer: EtdLayer, out_map: *mut etd_map) -> etd_status {
    // SAFETY: the caller keeps this function's contract.
    unsafe {
        on(film, |film| {
            let frame = film.newest()?;
            let (data, channels) = film.layer(&frame, layer)?;
            let mut state = lock(&film.state);
            let id = state.next_map;
            let map = etd_map {
                struct_size: size_of::<etd_map>(),
                data: data.as_ptr(),
                width: frame.resolution[0],
                height: frame.resolution[1],
                channels: channels as u32,
                samples: frame.samples,
                id,
            };
            write_sized(out_map, "out_map", map)?;
            state.next_map += 1;
            state.maps.insert(id, frame);
            Ok(())
        })
    }
}

/// Ends a map. The memory at `map->data` may not be read any more, and `map->data` becomes NULL. Error:
/// `ETD_INVALID_OPERATION` for a map that was ended before. Thread-safe.
///
/// # Safety
/// Each pointer must be NULL or point to a value of its type.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn etd_film_unmap(film: *mut etd_film, map: *mut etd_map) -> etd_status {
    // SAFETY: the caller keeps this function's contract.
    unsafe {
        on(film, |film| {
            let it = read_sized(map.cast_const(), "map")?;
            let mut state = lock(&film.state);
            // Another film may have a map of the same number, which the address excludes.
            let is_of_this = |frame: &Arc<DevelopedImage>| {
                let data = it.data;
                data == frame.rgba.as_ptr() || frame.layers.iter().any(|(_, layer)| data == layer.as_ptr())
            };
            if !state.maps.get(&it.id).is_some_and(is_of_this) {
                return Err(Failure::operation("the film has no such map: it was ended before, or is another film's"));
            }
            let Some(frame) = state.maps.remove(&it.id) else { return Ok(()) };
            // The next image uses the memory.
            state.recycle(frame);
            drop(state);
            write_sized(map, "map", etd_map { data: std::ptr::null(), id: 0, ..it })
        })
    }
}
