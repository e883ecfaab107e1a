//! Checkpoints: all that a render needs to go on later, elsewhere, or in parts.

mod file;
mod header;
mod resume;

use std::collections::BTreeMap;
use std::io::{BufReader, Read, Write};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::{Duration, Instant};

use super::adaptive::Stage;
use super::settings::RenderSettings;
use super::share::{Share, Tiles};
use crate::desc::RenderDesc;
use crate::error::{Error, ErrorKind, Result};
use crate::film::{Film, FilmOptions};
use crate::integrator::photon::PlanState;
use crate::replace;
use crate::scene::Scene;

pub(super) use header::Header;

/// Where and how often a render writes its checkpoint.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct CheckpointPlan {
    /// The file, which is replaced in one step each time.
    pub path: PathBuf,
    /// The time from one checkpoint to the next. One more is written when the render ends, for whatever reason.
    pub every: Duration,
}

/// The state of a render: the film with all sums, and what further samples depend on.
///
/// A render that goes on from a checkpoint ([`Render::resume`](super::Render::resume)) comes to the same film as one that was never
/// interrupted, to the last bit, and may take more samples than it was begun with.
#[derive(Clone, Debug)]
pub struct Checkpoint {
    pub(super) header: Header,
    pub(super) film: Arc<Film>,
    pub(super) stage: Option<Arc<Stage>>,
    /// What is known from earlier passes of photon maps.
    pub(super) photons: Option<PlanState>,
}

fn damaged(what: &str) -> Error {
    Error::new(ErrorKind::InvalidScene, format!("the checkpoint is damaged: {what}"))
}

fn no_memory(error: std::collections::TryReserveError) -> Error {
    Error::new(ErrorKind::OutOfMemory, "no room for the checkpoint").because(error)
}

/// A scene's fingerprint as a header has it.
fn written(fingerprint: u64) -> String {
    format!("{fingerprint:016x}")
}

/// The header of a render that has not begun.
pub(super) fn begin(
    film: &FilmOptions,
    desc: &RenderDesc,
    settings: &RenderSettings,
    is_adaptive: bool,
    scene: &Scene,
) -> Result<Header> {
    Ok(Header {
        made_by: header::library(),
        arithmetic: header::arithmetic(scene.kernel().map(|kernel| kernel.version())),
        scene: settings.fingerprint.map(written),
        render: header::settings(desc)?,
        sensor_bands: header::bands(settings.sensor),
        film: film.into(),
        adaptive: is_adaptive.then(|| settings.error_measure.into()),
        reuse: None,
        light_paths: None,
        first_shadow_rays: None,
        cache: None,
        solution: None,
        samples: 0,
        decision: 0,
        stage: None,
        photons: None,
        rays: 0,
        share: settings.share.map(|share| [share.number(), share.count()]),
    })
}

impl Checkpoint {
    /// Reads a checkpoint.
    ///
    /// # Errors
    /// [`ErrorKind::Io`] for a file that cannot be read, [`ErrorKind::InvalidScene`] for one that is no checkpoint or was changed,
    /// [`ErrorKind::Unsupported`] for another version of the format, [`ErrorKind::OutOfMemory`]. All name the file.
    pub fn read(path: &Path) -> Result<Self> {
        Self::read_admitted(path, &mut |_| Ok(()))
    }

    /// Reads a checkpoint unless `admit` refuses its film, of which it hears before there is room for it.
    pub(crate) fn read_admitted(path: &Path, admit: &mut dyn FnMut(&FilmOptions) -> Result<()>) -> Result<Self> {
        let mut file = BufReader::with_capacity(1 << 16, crate::desc::open_file(path, u64::MAX)?);
        file::read(&mut file, admit).map_err(|error| error.in_file(Some(path), 0))
    }

    /// Reads a checkpoint from anything that has the bytes of one and no others.
    ///
    /// # Errors
    /// As for [`Checkpoint::read`], without the name of a file.
    pub fn read_from(mut input: impl Read) -> Result<Self> {
        file::read(&mut input, &mut |_| Ok(()))
    }

    /// Reads a checkpoint in memory, as [`Checkpoint::read_admitted`] does a file.
    #[cfg(feature = "capi")]
    pub(crate) fn of_bytes(mut bytes: &[u8], admit: &mut dyn FnMut(&FilmOptions) -> Result<()>) -> Result<Self> {
        file::read(&mut bytes, admit)
    }

    /// Writes the checkpoint. An existing file is replaced in one step, and stays as it is on an error.
    ///
    /// # Errors
    /// [`ErrorKind::Io`], with the name of the file.
    pub fn write(&self, path: &Path) -> Result<()> {
        replace::replace(path, "the checkpoint", |file| self.write_to(file))
    }

    /// Writes the bytes of the checkpoint.
    ///
    /// # Errors
    /// [`ErrorKind::Io`].
    pub fn write_to(&self, out: &mut impl Write) -> Result<()> {
        file::write(self, out)
    }

    /// The same state, after so many rays.
    pub(super) fn with_rays(&self, rays: u64) -> Self {
        Self { header: Header { rays, ..self.header.clone() }, ..self.clone() }
    }

    /// The same state of a film without samples: what further samples depend on besides those before them in their pixel.
    pub(super) fn without_samples(&self) -> Result<Self> {
        let header = Header { stage: None, ..self.header.clone() };
        Ok(Self { header, film: Film::new(*self.film.options())?.into(), stage: None, photons: self.photons.clone() })
    }

    /// The film.
    pub fn film(&self) -> &Arc<Film> {
        &self.film
    }

    /// Number of complete samples per pixel.
    pub fn samples(&self) -> u32 {
        self.header.samples
    }

    /// Number of rays traced so far.
    pub fn rays(&self) -> u64 {
        self.header.rays
    }

    /// Whether the checkpoint knows its scene by the fingerprint.
    #[cfg(feature = "capi")]
    pub(crate) fn knows_scene(&self) -> bool {
        self.header.scene.is_some()
    }

    /// Says which scene the render was of.
    #[cfg(feature = "capi")]
    pub(crate) fn set_scene(&mut self, fingerprint: u64) {
        self.header.scene = Some(written(fingerprint));
    }

    /// The part of the picture that this is; `None` for all of it.
    pub fn share(&self) -> Option<Share> {
        self.header.share()
    }

    /// The whole picture from all of its parts, in any order: what one render would have come to, to the last bit.
    ///
    /// # Errors
    /// [`ErrorKind::InvalidScene`] where parts are missing, given twice, or no parts; [`ErrorKind::Unsupported`] for parts of different
    /// renders, with what differs.
    pub fn merge(parts: Vec<Self>) -> Result<Self> {
        let invalid = |message: String| Err(Error::new(ErrorKind::InvalidScene, message));
        let mut known = BTreeMap::new();
        let mut count = None;
        for part in parts {
            let Some(share) = part.share() else {
                return invalid("a checkpoint is of all of the picture; expected shares of it".to_owned());
            };
            if *count.get_or_insert(share.count()) != share.count() {
                let known = count.unwrap_or_default();
                return invalid(format!(
                    "share {} is one of {}; expected shares of {known}, as the first",
                    share.number(),
                    share.count()
                ));
            }
            if known.insert(share.number(), part).is_some() {
                return invalid(format!("share {} is given twice", share.number()));
            }
        }
        let count = count.unwrap_or(1);
        let missing: Vec<String> =
            (1..=count).filter(|number| !known.contains_key(number)).map(|number| number.to_string()).collect();
        if !missing.is_empty() {
            let more = if missing.len() > 10 { format!(" and {} more", missing.len() - 10) } else { String::new() };
            let some = missing[..missing.len().min(10)].join(", ");
            return invalid(format!("of {count} shares, these are missing: {some}{more}"));
        }
        let mut parts = known.into_values();
        let Some(Self { header: first, film, mut photons, .. }) = parts.next() else {
            return invalid("there is no share to merge".to_owned());
        };
        let film = Film::copy_of(&film)?;
        let mut whole = Header { share: None, ..first };
        let mut bytes = Vec::new();
        for Self { header: part, film: from, photons: own, .. } in parts {
            let share = part.share();
            let header = Header { share: None, ..part };
            whole.check(&header)?;
            if whole.ways() != header.ways() {
                let is_open = [whole.light_paths, header.light_paths].contains(&None);
                let is_open = is_open || [whole.reuse, header.reuse].contains(&None);
                let is_open = is_open || [whole.first_shadow_rays, header.first_shadow_rays].contains(&None);
                let is_open = is_open || [whole.cache, header.cache].contains(&None);
                let is_open = is_open || whole.solution.is_some() != header.solution.is_some();
                let what = "the shares were rendered in different ways: one with hits that pixels share or with an irradiance cache, other numbers of light paths or samples, or a radiosity solution that ended elsewhere";
                let what = if is_open { "some shares have no samples, others have" } else { what };
                return invalid(what.to_owned());
            }
            // A part that was stopped early has fewer samples; the whole goes on from there.
            if header.samples < whole.samples {
                (whole.samples, photons) = (header.samples, own);
            }
            whole.decision = whole.decision.min(header.decision);
            whole.rays += header.rays;
            let tiles = Tiles::of(&film, share);
            for tile in (0..tiles.count()).filter_map(|place| tiles.get(place)) {
                if from.put_tile(tile, &mut bytes) && film.get_tile(tile, &bytes).is_none() {
                    return Err(damaged(&format!("tile {tile}")));
                }
                bytes.clear();
            }
        }
        Ok(Self { header: whole, film: Arc::new(film), stage: None, photons })
    }
}

/// Writes the checkpoints of a run at their times.
pub(super) struct Keeper {
    plan: CheckpointPlan,
    last: Instant,
    /// Why the last one could not be written.
    pub failure: Option<Error>,
}

impl Keeper {
    /// The first checkpoint is due after the plan's time.
    pub fn new(plan: CheckpointPlan) -> Self {
        Self { plan, last: Instant::now(), failure: None }
    }

    /// Writes a checkpoint if it is time to, or if it is the last one.
    pub fn keep(&mut self, state: impl FnOnce() -> Checkpoint, is_last: bool) {
        if is_last || self.last.elapsed() >= self.plan.every {
            self.failure = state().write(&self.plan.path).err();
            self.last = Instant::now();
        }
    }
}
