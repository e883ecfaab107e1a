//! What a checkpoint says about its render: whatever must be the same where the render goes on.

use serde::{Deserialize, Serialize};
use serde_json::Value;

use super::super::share::{MAX_SHARES, Share};
use super::super::ways::Ways;
use super::damaged;
use crate::desc::{MAX_PIXELS, MAX_SHADOW_RAYS, RenderDesc, SamplerDesc, elided};
use crate::embree::instruction_set;
use crate::error::{Error, ErrorKind, Result};
use crate::film::{ErrorMeasure, FilmOptions, Placement};
use crate::integrator::photon::PlanState;
use crate::integrator::photon::coverage::DiskCoverage;
use crate::integrator::radiosity::Steps;
use crate::spectrum::Sensor;

/// The header of a checkpoint.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, rename_all = "camelCase")]
pub(in super::super) struct Header {
    /// The library, by name and version.
    pub made_by: String,
    /// What the last bits of results depend on besides the library's version.
    pub arithmetic: String,
    /// The scene's fingerprint in hexadecimal; null where none was given.
    pub scene: Option<String>,
    /// The render settings, as a scene file has them.
    pub render: Value,
    /// The range of the sensor's bands, where it has some.
    pub sensor_bands: Option<[f64; 2]>,
    pub film: FilmHeader,
    /// The measure by which pixels get different numbers of samples, where they do.
    pub adaptive: Option<Measure>,
    /// Whether pixels share hits; null as long as a pilot is to say.
    pub reuse: Option<bool>,
    /// Number of light paths for each sample of all pixels; `None` as long as a pilot is to say.
    pub light_paths: Option<u32>,
    /// Number of light samples at the hits that the camera sees; `None` as long as a pilot is to say.
    pub first_shadow_rays: Option<u32>,
    /// Whether `auto` has taken the irradiance cache in place of paths; `None` as long as a pilot is to say.
    pub cache: Option<bool>,
    /// Where the radiosity solution ended; `None` where there is none.
    pub solution: Option<Steps>,
    /// Number of complete samples per pixel.
    pub samples: u32,
    /// Number of samples per pixel at which the next decision is made.
    pub decision: u32,
    /// Numbers of samples at the beginning and at the end of the present stage of an adaptive render.
    pub stage: Option<[u32; 2]>,
    /// What is known from earlier passes of photon maps; its cells are in the file's blocks.
    pub photons: Option<PhotonHeader>,
    /// Number of rays traced so far.
    pub rays: u64,
    /// The part of the picture that this is, and of how many; null for all of it.
    pub share: Option<[u32; 2]>,
}

/// [`FilmOptions`] in a header.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, rename_all = "camelCase")]
pub(in super::super) struct FilmHeader {
    resolution: [u32; 2],
    origin: [u32; 2],
    picture: [u32; 2],
    pixel_aspect: f32,
    /// Whether the film is the whole picture, with square pixels.
    is_picture: bool,
    auxiliary: bool,
    /// Files of before there were parts of the light do not say.
    #[serde(default)]
    light_parts: bool,
    share: u32,
    weighted: bool,
    gathering: bool,
}

/// [`PlanState`] in a header, without its cells. Numbers of single precision are bit patterns, so that they come back as they are.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, rename_all = "camelCase")]
pub(in super::super) struct PhotonHeader {
    pass: u32,
    radius: u32,
    time: u32,
    levels: Vec<u32>,
}

/// Most levels of cells: their radii halve, and single precision has fewer than so many halves.
const MOST_LEVELS: usize = 300;

impl From<&PlanState> for PhotonHeader {
    fn from(PlanState { pass, radius, coverage }: &PlanState) -> Self {
        let (time, levels) = coverage.parts();
        let levels = levels.map(|(radius, _)| radius.to_bits()).collect();
        Self { pass: *pass, radius: radius.to_bits(), time: time.to_bits(), levels }
    }
}

impl PhotonHeader {
    /// The state, to which the cells are still to be added.
    pub fn state(&self) -> Result<PlanState> {
        let is_length = |bits: &u32| f32::from_bits(*bits).is_finite() && f32::from_bits(*bits) > 0.0;
        let is_possible = self.levels.len() <= MOST_LEVELS
            && self.levels.iter().all(is_length)
            && is_length(&self.radius)
            && f32::from_bits(self.time).is_finite();
        if !is_possible {
            return Err(damaged(&format!("its header is of no photon maps: {self:?}")));
        }
        let radii = self.levels.iter().map(|bits| f32::from_bits(*bits));
        let coverage = DiskCoverage::with_levels(f32::from_bits(self.time), radii);
        Ok(PlanState { pass: self.pass, radius: f32::from_bits(self.radius), coverage })
    }
}

/// [`ErrorMeasure`] in a header.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "camelCase")]
pub(in super::super) enum Measure {
    RelMse,
    Display,
}

impl From<ErrorMeasure> for Measure {
    fn from(measure: ErrorMeasure) -> Self {
        match measure {
            ErrorMeasure::RelMse => Self::RelMse,
            ErrorMeasure::Display => Self::Display,
        }
    }
}

impl From<&FilmOptions> for FilmHeader {
    fn from(options: &FilmOptions) -> Self {
        let FilmOptions { resolution, placement, auxiliary, light_parts, share, weighted, gathering } = *options;
        let Placement { origin, picture, pixel_aspect } =
            placement.unwrap_or(Placement { origin: [0; 2], picture: resolution, pixel_aspect: 1.0 });
        let is_picture = placement.is_none();
        Self {
            resolution,
            origin,
            picture,
            pixel_aspect,
            is_picture,
            auxiliary,
            light_parts,
            share,
            weighted,
            gathering,
        }
    }
}

/// The library's name and version.
pub(super) fn library() -> String {
    format!("etendue {}", env!("CARGO_PKG_VERSION"))
}

/// What the last bits of results depend on: the processor, and the instructions that Embree uses on it.
pub(super) fn arithmetic(embree: Option<[u32; 3]>) -> String {
    let processor = std::env::consts::ARCH;
    match embree {
        Some([major, minor, patch]) => {
            format!("Embree {major}.{minor}.{patch} with {} on {processor}", instruction_set().to_string_lossy())
        }
        // A scene without surfaces.
        None => format!("no Embree on {processor}"),
    }
}

/// What a header keeps of the range of a sensor's bands.
pub(super) fn bands(sensor: Sensor) -> Option<[f64; 2]> {
    match sensor {
        Sensor::Observer => None,
        Sensor::Bands { range } => Some(range),
    }
}

impl Header {
    /// The options of the film, of which not all are possible in a file that was changed.
    pub fn film_options(&self) -> Result<FilmOptions> {
        let FilmHeader { resolution, origin, picture, pixel_aspect, is_picture, .. } = self.film;
        let FilmHeader { auxiliary, light_parts, share, weighted, gathering, .. } = self.film;
        let pixels = |[width, height]: [u32; 2]| u64::from(width) * u64::from(height);
        let is_inside = (0..2).all(|axis| origin[axis].saturating_add(resolution[axis]) <= picture[axis]);
        let is_possible = (1..=MAX_PIXELS).contains(&pixels(resolution)) && pixels(picture) <= MAX_PIXELS && is_inside;
        let has_aspect = pixel_aspect > 0.0 && pixel_aspect.is_finite();
        let has_stage = self.stage.is_none_or(|[begin, end]| begin <= end);
        let has_part = self.share.is_none_or(|[number, count]| Share::new(number, count).is_ok());
        // A file is not to ask for more work than a pilot does.
        let has_paths = self.light_paths.is_none_or(|count| u64::from(count) <= pixels(picture).max(8));
        let has_samples = self.first_shadow_rays.is_none_or(|count| (1..=MAX_SHADOW_RAYS).contains(&count));
        // Parts of the light are those of paths by themselves.
        let shares_light = self.reuse == Some(true) || self.light_paths.is_some_and(|count| count > 0);
        let has_parts = !light_parts || !(shares_light || self.cache == Some(true) || gathering);
        let is_possible = is_possible && has_aspect && share > 0;
        if !(is_possible && has_stage && has_part && has_paths && has_samples && has_parts) {
            return Err(damaged(&format!("its header is of no render: {:?}, {MAX_SHARES} parts at most", self.film)));
        }
        let placement = (!is_picture).then_some(Placement { origin, picture, pixel_aspect });
        Ok(FilmOptions { resolution, placement, auxiliary, light_parts, share, weighted, gathering })
    }

    /// What pixels have in common.
    pub fn ways(&self) -> Ways {
        let Self { reuse, light_paths, first_shadow_rays, cache, solution, .. } = *self;
        Ways { reuse, light_paths, first_shadow_rays, cache, solution }
    }

    /// The part of the picture.
    pub fn share(&self) -> Option<Share> {
        self.share.and_then(|[number, count]| Share::new(number, count).ok())
    }

    /// Checks that a render with the header `self` can go on with a checkpoint that has the header `there`.
    ///
    /// # Errors
    /// [`ErrorKind::Unsupported`] with what differs.
    pub fn check(&self, there: &Self) -> Result<()> {
        let refuse = |what: &str, there: &dyn std::fmt::Display, here: &dyn std::fmt::Display| {
            let message = format!("the checkpoint was made {what} {there}, and this render {here}; expected the same");
            // A file may have words of any length.
            Err(Error::new(ErrorKind::Unsupported, elided(&message)))
        };
        if self.made_by != there.made_by {
            return refuse("by", &there.made_by, &format!("is by {}", self.made_by));
        }
        if self.arithmetic != there.arithmetic {
            return refuse("by", &there.arithmetic, &format!("is by {}", self.arithmetic));
        }
        if self.scene != there.scene {
            let message = "the checkpoint was made of another scene, or of this one before something in it was changed";
            return Err(Error::new(ErrorKind::Unsupported, message));
        }
        self.check_settings(there)?;
        if self.sensor_bands != there.sensor_bands {
            let say = |bands| format!("{bands:?}");
            return refuse("with the bands", &say(there.sensor_bands), &format!("has {}", say(self.sensor_bands)));
        }
        if self.adaptive != there.adaptive {
            let say = |measure: Option<Measure>| measure.map_or("none".to_owned(), |it| format!("{it:?}"));
            return refuse(
                "with the measure of adaptive sampling",
                &say(there.adaptive),
                &format!("has {}", say(self.adaptive)),
            );
        }
        if let (Some(here), Some(there)) = (self.reuse, there.reuse)
            && here != there
        {
            let say = |reuse| if reuse { "sharing hits" } else { "keeping to themselves" };
            return refuse("with pixels", &say(there), &format!("has pixels {}", say(here)));
        }
        if let (Some(here), Some(there)) = (self.light_paths, there.light_paths)
            && (here == 0) != (there == 0)
        {
            let say = |count| if count == 0 { "without" } else { "with" };
            return refuse(say(there), &"light paths", &format!("is {} them", say(here)));
        }
        if let (Some(here), Some(there)) = (self.first_shadow_rays, there.first_shadow_rays)
            && here != there
        {
            return refuse("with `firstShadowRays`", &there, &format!("has {here}"));
        }
        if self.film != there.film {
            let message = "the checkpoint keeps other layers, or another part of the picture, than this render";
            return Err(Error::new(ErrorKind::Unsupported, message));
        }
        if self.share != there.share {
            let say = |share: Option<[u32; 2]>| {
                share.map_or("all of the picture".to_owned(), |[number, count]| format!("share {number}/{count}"))
            };
            return refuse("of", &say(there.share), &format!("is of {}", say(self.share)));
        }
        Ok(())
    }

    /// Checks that the settings are the same, apart from what may change: how many samples there are to be.
    fn check_settings(&self, there: &Self) -> Result<()> {
        let (Value::Object(here), Value::Object(there)) = (&self.render, &there.render) else {
            return Err(damaged("its header has no settings"));
        };
        let mut keys: Vec<_> = here.keys().chain(there.keys()).collect();
        keys.sort();
        for key in keys {
            let [own, other] = [here, there].map(|block| block.get(key).unwrap_or(&Value::Null));
            if own != other {
                let message = format!(
                    "the checkpoint was made with `{key}` {other}, and this render has {own}; expected the same"
                );
                return Err(Error::new(ErrorKind::Unsupported, elided(&message)));
            }
        }
        Ok(())
    }
}

/// The settings as a scene file has them, without those that may change from one part of a render to the next: whether pixels share
/// hits and the like, which have places of their own, and the number of samples where no pattern is planned for it.
pub(super) fn settings(desc: &RenderDesc) -> Result<Value> {
    let open = RenderDesc { reuse: None, light_paths: None, first_shadow_rays: None, ..desc.clone() };
    let mut block = open.to_value()?;
    if let (SamplerDesc::Sobol | SamplerDesc::Random, Some(block)) = (desc.sampler, block.as_object_mut()) {
        block.remove("samples");
    }
    Ok(block)
}
