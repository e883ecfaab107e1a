//! Films: images that are mapped without a copy, copied in the host's layout, or written to files.

use std::alloc::{Layout, alloc_zeroed};
use std::collections::HashMap;
use std::ffi::c_char;
use std::path::Path;
use std::sync::{Arc, Mutex};

use super::boundary::{
    Header, Object, give, lock, need, object, on, optional_text, read_sized, release, retain, take_status, text,
    write_sized,
};
use super::device::etd_device;
use super::read;
use super::status::{ETD_OUT_OF_MEMORY, Failure, Result, etd_status};
use super::types::*;
use crate::Cancel;
use crate::desc::MAX_PIXELS;
use crate::embree::Charge;
use crate::film::{Film, Image, LayerKind, TILE};
use crate::output::{self, Attribute, ToneMap, WriteOptions};

/// Layers that are images of their own, after the colour.
const LAYERS: [(etd_layer, LayerKind); 7] = [
    (ETD_LAYER_ALBEDO, LayerKind::Albedo),
    (ETD_LAYER_NORMAL, LayerKind::Normal),
    (ETD_LAYER_DEPTH, LayerKind::Depth),
    (ETD_LAYER_SAMPLES, LayerKind::Samples),
    (ETD_LAYER_VARIANCE, LayerKind::Variance),
    (ETD_LAYER_STANDARD_ERROR, LayerKind::StandardError),
    (ETD_LAYER_BIAS, LayerKind::Bias),
];

/// All bits that mean something.
const ALL_LAYERS: u32 = 511;

/// Layers that need the first hit of each sample.
const FIRST_HIT: u32 =
    ETD_LAYER_ALBEDO as u32 | ETD_LAYER_NORMAL as u32 | ETD_LAYER_DEPTH as u32 | ETD_LAYER_ALPHA as u32;

/// What the sums of a pixel take, with and without those of its first hit.
const BYTES_PER_PIXEL: [u64; 2] = [104, 168];

/// An image of a pass: the colour with alpha, and the layers that the film keeps.
struct Frame {
    rgba: Vec<f32>,
    layers: Vec<(LayerKind, Vec<f32>)>,
    samples: u32,
}

/// A film: its resolution and layers, and the image that was made last.
pub struct etd_film {
    header: Header,
    pub(super) resolution: [u32; 2],
    layers: u32,
    state: Mutex<State>,
    /// What it takes of the device's memory.
    _charge: Charge,
    device: Arc<etd_device>,
}
object!(etd_film, b"EtFi", "film");

struct State {
    /// Whether a render fills it.
    busy: bool,
    /// The image that the next map gives.
    front: Arc<Frame>,
    /// Memory of an image that nobody has mapped any more.
    spare: Option<Frame>,
    images: u32,
    /// Sums that are newer than `front`, and how many samples they have: the next who asks makes the image.
    later: Option<(Arc<Film>, u32)>,
    pins: HashMap<u64, Arc<Frame>>,
    next_pin: u64,
    /// The sums of the last render.
    sums: Option<Arc<Film>>,
    summary: Option<etd_summary>,
    /// The same for the header of an EXR.
    attributes: Vec<(String, Attribute)>,
}

impl etd_film {
    /// Whether renders have to keep the first hits.
    pub(super) fn keeps_first_hits(&self) -> bool {
        self.layers & FIRST_HIT != 0
    }

    /// Takes the film for a render; an error while another has it.
    pub(super) fn begin(&self) -> Result {
        let mut state = lock(&self.state);
        if state.busy {
            return Err(Failure::operation("the film is being rendered to: wait for its task, or use another film"));
        }
        state.busy = true;
        Ok(())
    }

    /// Gives it back.
    pub(super) fn end(&self, summary: Option<etd_summary>) {
        let mut state = lock(&self.state);
        state.busy = false;
        if summary.is_some() {
            state.summary = summary;
        }
    }

    /// The sums of the last render, whose memory the next one may use again.
    pub(super) fn set_sums(&self, sums: &Arc<Film>) {
        let mut state = lock(&self.state);
        state.sums = Some(Arc::clone(sums));
        // What is known is of other sums.
        state.attributes.clear();
    }

    /// What the last render came to, for the files that are written of it.
    pub(super) fn set_attributes(&self, attributes: Vec<(String, Attribute)>) {
        lock(&self.state).attributes = attributes;
    }

    /// How many images there were.
    pub(super) fn images(&self) -> u32 {
        lock(&self.state).images
    }

    /// Makes the image of the sums as they are, to be mapped from now on; whether it was made before it was cancelled.
    pub(super) fn publish(&self, sums: &Film, samples: u32, cancel: &Cancel) -> Result<bool> {
        let spare = lock(&self.state).spare.take();
        let mut frame = match spare {
            Some(frame) => frame,
            None => self.frame()?,
        };
        frame.samples = samples;
        let with_alpha = self.layers & ETD_LAYER_ALPHA as u32 != 0;
        let is_whole = sums.read_into(&mut frame.rgba, with_alpha, &mut frame.layers, cancel)?;
        let mut state = lock(&self.state);
        if is_whole {
            let old = std::mem::replace(&mut state.front, Arc::new(frame));
            state.images = state.images.wrapping_add(1);
            state.later = None;
            state.keep(old);
        } else {
            state.spare.get_or_insert(frame);
        }
        Ok(is_whole)
    }

    /// Has the image of these sums made when somebody asks for it.
    pub(super) fn publish_later(&self, sums: &Arc<Film>, samples: u32) {
        lock(&self.state).later = Some((Arc::clone(sums), samples));
    }

    /// The newest image.
    fn newest(&self) -> Result<Arc<Frame>> {
        let later = lock(&self.state).later.take();
        if let Some((sums, samples)) = later {
            self.publish(&sums, samples, &Cancel::new())?;
        }
        Ok(Arc::clone(&lock(&self.state).front))
    }

    pub(super) fn device(&self) -> &Arc<etd_device> {
        &self.device
    }

    fn frame(&self) -> Result<Frame> {
        let pixels = self.resolution[0] as usize * self.resolution[1] as usize;
        let kept = LAYERS.iter().filter(|(layer, _)| self.layers & *layer as u32 != 0);
        let layers = kept.map(|(_, kind)| Ok((*kind, zeros(pixels * kind.channels())?)));
        Ok(Frame { rgba: zeros(4 * pixels)?, layers: layers.collect::<Result<_>>()?, samples: 0 })
    }

    /// The data of a layer with its channels.
    fn layer<'f>(&self, frame: &'f Frame, layer: u32) -> Result<(&'f [f32], usize)> {
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

impl State {
    /// Keeps the memory of an image if nobody else has it.
    fn keep(&mut self, frame: Arc<Frame>) {
        if let (None, Some(frame)) = (&self.spare, Arc::into_inner(frame)) {
            self.spare = Some(frame);
        }
    }
}

/// So many zeros, or an error instead of an abort. From memory that the system hands out zeroed: what is not touched yet
/// costs nothing.
fn zeros(count: usize) -> Result<Vec<f32>> {
    let no_room = || Failure::new(ETD_OUT_OF_MEMORY, format!("no room for an image of {count} values"));
    let layout = Layout::array::<f32>(count).map_err(|_| no_room())?;
    if layout.size() == 0 {
        return Ok(Vec::new());
    }
    // SAFETY: the layout is that of an array of `count` floats, and not empty; zero bytes are floats.
    unsafe {
        let start = alloc_zeroed(layout).cast::<f32>();
        if start.is_null() {
            return Err(no_room());
        }
        Ok(Vec::from_raw_parts(start, count, count))
    }
}

/// Makes a film, black and of no sample.
///
/// `options` must say its resolution. Renders may fill it again and again, one at a time. On `ETD_OK` `*out_film` is one
/// reference. Errors: `ETD_INVALID_ARGUMENT` for a resolution or layers that do not exist, `ETD_OUT_OF_MEMORY` past the
/// device's limit (a film takes about 150 bytes a pixel, in whole tiles of 16 x 16; images that are mapped
/// beyond two are not counted). Thread-safe.
///
/// # Safety
/// Pointers must be NULL or point to what they say.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn etd_film_new(
    device: *mut etd_device,
    options: *const etd_film_options,
    out_film: *mut *mut etd_film,
) -> etd_status {
    // SAFETY: passed on.
    unsafe {
        on(device, |device| {
            need(out_film, "out_film")?;
            let it = read_sized(options, "options")?;
            let pixels = u64::from(it.width) * u64::from(it.height);
            let [columns, rows] = [it.width, it.height].map(|length| u64::from(length.div_ceil(TILE)));
            let in_tiles = (columns * rows).saturating_mul((TILE * TILE).into());
            if pixels == 0 || pixels > MAX_PIXELS || in_tiles > 2 * MAX_PIXELS {
                let message = format!(
                    "options: {} x {} pixels; a film has 1 to {MAX_PIXELS}, and less if it is very narrow",
                    it.width, it.height
                );
                return Err(Failure::argument(message));
            }
            if it.layers & !ALL_LAYERS != 0 || it.reserved != 0 {
                return Err(Failure::argument("options: unknown layers, or reserved is not 0"));
            }
            let first_hits = it.layers & FIRST_HIT != 0;
            let channels: usize = LAYERS
                .iter()
                .filter(|(layer, _)| it.layers & *layer as u32 != 0)
                .map(|(_, kind)| kind.channels())
                .sum();
            // The sums, and two images: one that is shown, one that is made.
            let bytes = in_tiles * BYTES_PER_PIXEL[usize::from(first_hits)] + pixels * 2 * 4 * (4 + channels as u64);
            let charge = device.budget.try_charge(usize::try_from(bytes).unwrap_or(usize::MAX))?;
            let empty = Arc::new(Frame { rgba: Vec::new(), layers: Vec::new(), samples: 0 });
            let film = etd_film {
                header: Header::new::<etd_film>(device.callbacks()),
                resolution: [it.width, it.height],
                layers: it.layers,
                state: Mutex::new(State {
                    busy: false,
                    front: empty,
                    spare: None,
                    images: 0,
                    later: None,
                    pins: HashMap::new(),
                    next_pin: 1,
                    sums: None,
                    summary: None,
                    attributes: Vec::new(),
                }),
                _charge: charge,
                device: Arc::clone(device),
            };
            let black = film.frame()?;
            lock(&film.state).front = Arc::new(black);
            give(Arc::new(film), out_film);
            Ok(())
        })
    }
}

/// One more reference to a film. Thread-safe.
///
/// # Safety
/// `film` must be NULL or a film.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn etd_film_retain(film: *mut etd_film) -> etd_status {
    // SAFETY: passed on.
    unsafe { retain(film) }
}

/// Gives back one reference to a film; NULL is fine. Tasks that fill it keep it alive; what is still mapped goes away with
/// the last reference. Thread-safe.
///
/// # Safety
/// `film` must be NULL or a film of which the caller has a reference.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn etd_film_release(film: *mut etd_film) {
    // SAFETY: passed on.
    unsafe { release(film) }
}

/// The first failure of a call on this film since this was last asked, and forgets it; `ETD_OK` if there was none.
/// `message`: where its message goes (at most `capacity` bytes with the zero byte), or NULL. Thread-safe.
///
/// # Safety
/// `film` must be NULL or a film, and `capacity` bytes writable at `message` unless it is NULL.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn etd_film_status(film: *mut etd_film, message: *mut c_char, capacity: usize) -> etd_status {
    // SAFETY: passed on.
    unsafe { take_status(film, message, capacity) }
}

/// Maps a layer of the newest image: `*out_map` points to it.
///
/// It may be called while the film is being rendered to; the image is then that of the last complete pass (or, in the
/// middle of a long one, of a moment in it), and does not change while it is mapped. After a render was cancelled the first
/// call makes its image; at any other time nothing is copied. Each map is ended by one
/// `etd_film_unmap`. `layer`: one `etd_layer` that the film keeps. Thread-safe.
///
/// # Safety
/// Pointers must be NULL or point to what they say.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn etd_film_map(film: *mut etd_film, layer: EtdLayer, out_map: *mut etd_map) -> etd_status {
    // SAFETY: passed on.
    unsafe {
        on(film, |film| {
            let frame = film.newest()?;
            let (data, channels) = film.layer(&frame, layer)?;
            let mut state = lock(&film.state);
            let id = state.next_pin;
            let map = etd_map {
                struct_size: size_of::<etd_map>(),
                data: data.as_ptr(),
                width: film.resolution[0],
                height: film.resolution[1],
                channels: channels as u32,
                samples: frame.samples,
                id,
            };
            write_sized(out_map, "out_map", map)?;
            state.next_pin += 1;
            state.pins.insert(id, frame);
            Ok(())
        })
    }
}

/// Ends a map: `map->data` may not be read any more, and is set to NULL. `ETD_INVALID_OPERATION` if it was ended before.
/// Thread-safe.
///
/// # Safety
/// Pointers must be NULL or point to what they say.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn etd_film_unmap(film: *mut etd_film, map: *mut etd_map) -> etd_status {
    // SAFETY: passed on.
    unsafe {
        on(film, |film| {
            let it = read_sized(map.cast_const(), "map")?;
            let mut state = lock(&film.state);
            // Numbers are the film's own; the address tells its maps from another film's.
            let is_of_this = |frame: &Arc<Frame>| {
                let data = it.data;
                data == frame.rgba.as_ptr() || frame.layers.iter().any(|(_, layer)| data == layer.as_ptr())
            };
            if !state.pins.get(&it.id).is_some_and(is_of_this) {
                return Err(Failure::operation("the film has no such map: it was ended before, or is another film's"));
            }
            let Some(frame) = state.pins.remove(&it.id) else { return Ok(()) };
            // The memory serves the next image.
            state.keep(frame);
            drop(state);
            write_sized(map, "map", etd_map { data: std::ptr::null(), id: 0, ..it })
        })
    }
}

/// Copies a layer of the newest image into the host's memory.
///
/// `layer`: one `etd_layer` that the film keeps. `options`: NULL for floats, top row first; format, tone map and exposure
/// otherwise. `pixels`: `size` bytes. `row_stride`: bytes from one row to the next, 0 for rows close together. Errors:
/// `ETD_INVALID_ARGUMENT` for a stride below a row, a size below the image, floats that are not aligned, or a format that
/// the layer does not have. Thread-safe.
///
/// # Safety
/// `size` bytes must be writable at `pixels`; other pointers must be NULL or point to what they say.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn etd_film_copy(
    film: *const etd_film,
    layer: EtdLayer,
    options: *const etd_image_options,
    pixels: *mut std::ffi::c_void,
    size: usize,
    row_stride: usize,
) -> etd_status {
    // SAFETY: passed on.
    unsafe {
        on(film, |film| {
            need(pixels.cast::<u8>(), "pixels")?;
            let it = read_image_options(options)?;
            let frame = film.newest()?;
            let (data, channels) = film.layer(&frame, layer)?;
            let is_color = layer == ETD_LAYER_COLOR as u32;
            let [width, height] = film.resolution.map(|n| n as usize);
            let (values, value_size) = match read::enumeration("options.format", it.format)? {
                ETD_FORMAT_FLOAT => (channels, 4),
                _ if !is_color => {
                    return Err(Failure::argument("options.format: layers other than the colour are copied as floats"));
                }
                ETD_FORMAT_RGB_FLOAT => (3, 4),
                ETD_FORMAT_RGB8 => (3, 1),
                ETD_FORMAT_RGBA8 => (4, 1),
            };
            let row = width * values * value_size;
            let stride = if row_stride == 0 { row } else { row_stride };
            if stride < row || stride % value_size != 0 || !pixels.addr().is_multiple_of(value_size) {
                let message = format!("row_stride is {stride}, expected a multiple of {value_size} of at least {row}");
                return Err(Failure::argument(message));
            }
            if (height - 1).checked_mul(stride).and_then(|rest| rest.checked_add(row)).is_none_or(|all| all > size) {
                let message = format!("size is {size}: {height} rows of {row} bytes, {stride} apart, do not fit");
                return Err(Failure::argument(message));
            }
            let display = if value_size == 1 { Some(to_display(&frame.rgba, film.resolution, &it)?) } else { None };
            for y in 0..height {
                let target = pixels.cast::<u8>().add(if it.bottom_up != 0 { height - 1 - y } else { y } * stride);
                let source = &data[y * width * channels..(y + 1) * width * channels];
                match &display {
                    None if values == channels => {
                        std::ptr::copy_nonoverlapping(source.as_ptr().cast::<u8>(), target, row);
                    }
                    None => {
                        for (x, pixel) in source.chunks_exact(channels).enumerate() {
                            let rgb = [pixel[0], pixel[1], pixel[2]];
                            target.cast::<[f32; 3]>().add(x).write_unaligned(rgb);
                        }
                    }
                    Some(rgb8) => {
                        let rgb8 = &rgb8[3 * y * width..3 * (y + 1) * width];
                        for (x, rgb) in rgb8.chunks_exact(3).enumerate() {
                            let target = target.add(x * values);
                            std::ptr::copy_nonoverlapping(rgb.as_ptr(), target, 3);
                            if values == 4 {
                                let alpha = source[x * channels + 3];
                                target.add(3).write((255.0 * alpha.clamp(0.0, 1.0)).round() as u8);
                            }
                        }
                    }
                }
            }
            Ok(())
        })
    }
}

/// Writes the film as it stands to a file: `.png` (8-bit sRGB), `.exr` (float, with layers) or `.pfm` (float).
///
/// An EXR holds the layers `samples` and `variance`, and albedo, normal and depth where the film keeps any of these, and in
/// its header what the render came to (`relMSE`, `relMSEStandardError`, `displayError`, `samplesPerPixel`, `rays`, `ended`). The
/// file appears whole or not at all. `path`: UTF-8. `options`: NULL for a clamped sRGB picture without comments. Errors:
/// `ETD_IO`, `ETD_UNSUPPORTED` for another extension, `ETD_INVALID_OPERATION` before the first render. Thread-safe.
///
/// # Safety
/// Pointers must be NULL or point to what they say.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn etd_film_write(
    film: *const etd_film,
    path: *const c_char,
    options: *const etd_image_options,
) -> etd_status {
    // SAFETY: passed on.
    unsafe {
        on(film, |film| {
            let path = text(path, "path")?;
            let it = read_image_options(options)?;
            let comments = optional_text(it.comments, "options.comments")?;
            let (sums, attributes) = {
                let state = lock(&film.state);
                (state.sums.clone(), state.attributes.clone())
            };
            let sums = sums.ok_or_else(|| Failure::operation("nothing was rendered to the film yet"))?;
            let options = WriteOptions {
                tone_map: read::tone_map(it.tone_map)?,
                exposure: it.exposure,
                comments: comments.to_owned(),
                attributes,
                threads: film.device.build_threads,
            };
            Ok(output::write(&sums.develop(), Path::new(path), &options)?)
        })
    }
}

/// What the last render that ended on this film came to; `ETD_INVALID_OPERATION` before the first. Thread-safe.
///
/// # Safety
/// Pointers must be NULL or point to what they say.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn etd_film_get_summary(film: *const etd_film, out_summary: *mut etd_summary) -> etd_status {
    // SAFETY: passed on.
    unsafe {
        on(film, |film| {
            let summary = lock(&film.state).summary;
            let summary = summary.ok_or_else(|| Failure::operation("no render has ended on this film yet"))?;
            write_sized(out_summary, "out_summary", summary)
        })
    }
}

/// # Safety
/// As for [`read_sized`].
unsafe fn read_image_options(options: *const etd_image_options) -> Result<etd_image_options> {
    let defaults = etd_image_options {
        struct_size: size_of::<etd_image_options>(),
        format: 0,
        tone_map: 0,
        exposure: 0.0,
        bottom_up: 0,
        comments: std::ptr::null(),
    };
    // SAFETY: passed on.
    let it = if options.is_null() { defaults } else { unsafe { read_sized(options, "options") }? };
    if !(-64.0..=64.0).contains(&it.exposure) {
        let message = format!("options.exposure is {}, expected -64 to 64 stops", it.exposure);
        return Err(Failure::argument(message));
    }
    Ok(it)
}

/// The colour as sRGB bytes.
fn to_display(rgba: &[f32], [width, height]: [u32; 2], options: &etd_image_options) -> Result<Vec<u8>> {
    let tone_map: ToneMap = read::tone_map(options.tone_map)?;
    let rgb = rgba.chunks_exact(4).flat_map(|pixel| [pixel[0], pixel[1], pixel[2]]).collect();
    let image = Image { width, height, rgb, layers: Vec::new() };
    Ok(output::to_srgb8(&image, tone_map, options.exposure)?)
}
