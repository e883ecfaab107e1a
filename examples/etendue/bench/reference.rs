//! Reference images for the measurement of errors.

use std::ops::ControlFlow;
use std::path::{Path, PathBuf};

use etendue::desc::{FilterDesc, IntegratorDesc, RenderDesc, SamplerDesc};
use etendue::film::Image;
use etendue::output::{self, WriteOptions};
use etendue::render::{Progress, Render, RenderSettings};
use etendue::scene::Scene;
use etendue::{Error, ErrorKind, Result};
use serde::{Deserialize, Serialize};

use super::results;

/// No measured run has this seed, or its samples would be those of the reference.
const SEED: u64 = 0x7265_6665_7265_6e63;

/// An image that stands for the truth, with known noise.
#[derive(Default)]
pub struct Reference {
    /// Its name, `SCENE-WxH`, with the filter where that is not the box.
    pub name: String,
    /// The file's path.
    pub file: PathBuf,
    /// The image.
    pub image: Image,
    /// Variance of each value, where it is known.
    pub variance: Option<Vec<f32>>,
    /// Samples per pixel, where they are known.
    pub samples: Option<u32>,
}

/// Settings of the reference for a case: path tracing of the same pixels without approximation.
fn settings(case: &RenderDesc, samples: u32) -> RenderDesc {
    // The normally distributed pattern is a filter by itself, and is available only with its own sampler.
    let sampler = if case.sampler == SamplerDesc::Gaussian { SamplerDesc::Gaussian } else { SamplerDesc::Sobol };
    let (resolution, filter) = (case.resolution, case.filter);
    let integrator = IntegratorDesc::Path;
    RenderDesc { resolution, filter, sampler, samples, integrator, seed: SEED, ..RenderDesc::default() }
}

/// Name of this case's reference.
pub fn name(scene: &str, case: &RenderDesc) -> String {
    let [width, height] = case.resolution;
    let filter = match (case.sampler, case.filter) {
        (SamplerDesc::Gaussian, _) => "-gaussian-pattern".to_owned(),
        (_, FilterDesc::Box) => String::new(),
        (_, FilterDesc::Tent) => "-tent".to_owned(),
        (_, FilterDesc::BlackmanHarris) => "-blackman-harris".to_owned(),
        (_, FilterDesc::Gaussian { sigma }) => format!("-gaussian-{sigma}"),
        (_, FilterDesc::Mitchell { b, c }) => format!("-mitchell-{b}-{c}"),
    };
    format!("{scene}-{width}x{height}{filter}")
}

/// The origin of a reference that this program rendered, in `NAME.json` beside it. Other references have no such file.
#[derive(Deserialize, Serialize)]
#[serde(rename_all = "camelCase")]
struct ReferenceOrigin {
    /// [`hash`] of the scene file.
    scene_hash: String,
    /// Samples per pixel.
    samples: u32,
}

impl ReferenceOrigin {
    /// `None` where there is no such file.
    fn load(path: &Path) -> Result<Option<Self>> {
        if !path.exists() {
            return Ok(None);
        }
        let text = results::read_text(path, "the file")?;
        let read = serde_json::from_str(&text);
        read.map(Some).map_err(|error| Error::invalid("", error.to_string()).in_file(Some(path), error.line()))
    }

    fn write(&self, path: &Path) -> Result<()> {
        let text = serde_json::to_string(self).map_err(|error| Error::new(ErrorKind::Internal, error.to_string()))?;
        output::write_text(&(text + "\n"), path)
    }
}

/// FNV-1a of 64 bits, which is the same in every version of every program. It detects changes and does not prevent
/// forgery.
pub fn hash(bytes: &[u8]) -> String {
    let step = |hash: u64, byte: &u8| (hash ^ u64::from(*byte)).wrapping_mul(0x0000_0100_0000_01b3);
    format!("{:016x}", bytes.iter().fold(0xcbf2_9ce4_8422_2325, step))
}

/// Whether a reference of this name exists and need not be rendered: one from elsewhere, or one that was rendered from
/// this very scene file with at least this many samples.
pub fn is_current(folder: &Path, name: &str, scene_hash: &str, samples: u32) -> Result<bool> {
    if !folder.join(format!("{name}.exr")).exists() {
        return Ok(false);
    }
    let origin = ReferenceOrigin::load(&folder.join(format!("{name}.json")))?;
    Ok(origin.is_none_or(|origin| origin.scene_hash == scene_hash && origin.samples >= samples))
}

/// Whether a reference of this name could be written now, without doing so.
pub fn check_target(folder: &Path, name: &str) -> Result<()> {
    let deviations = folder.join(format!("{name}.se.exr"));
    if deviations.exists() {
        let message = "these standard errors are of a reference that is missing, or of another scene or fewer samples \
                       than now: remove them";
        return Err(Error::new(ErrorKind::Io, message).in_file(Some(&deviations), 0));
    }
    output::check_target(&folder.join(format!("{name}.exr")))?;
    output::check_text_target(&folder.join(format!("{name}.json")))
}

impl Reference {
    /// Reads `NAME.exr` in `folder`, with its noise from `NAME.se.exr` (standard errors) or its own layer `variance`;
    /// `None` where there is no such file.
    pub fn load(folder: &Path, name: &str, resolution: [u32; 2]) -> Result<Option<Self>> {
        let file = folder.join(format!("{name}.exr"));
        if !file.exists() {
            return Ok(None);
        }
        let image = output::read(&file)?;
        let check = |image: &Image, file: &Path| {
            let found = [image.width, image.height];
            let ([w, h], [x, y]) = (resolution, found);
            let message = format!("the reference has {x} x {y} pixels, and {w} x {h} are measured");
            if found == resolution { Ok(()) } else { Err(Error::invalid("", message).in_file(Some(file), 0)) }
        };
        check(&image, &file)?;
        if let Some(at) = image.rgb.iter().position(|value| !value.is_finite()) {
            let message = format!("value {at} of the reference is not finite");
            return Err(Error::new(ErrorKind::InvalidScene, message).in_file(Some(&file), 0));
        }
        let deviations = folder.join(format!("{name}.se.exr"));
        let variance = if deviations.exists() {
            let image = output::read(&deviations)?;
            check(&image, &deviations)?;
            Some(image.rgb.iter().map(|error| error * error).collect())
        } else {
            image.layer("variance").filter(|layer| layer.channels == 3).map(|layer| layer.data.clone())
        };
        let variance = variance.filter(|variance: &Vec<f32>| variance.iter().all(|value| value.is_finite()));
        let samples = image.layer("samples").and_then(|layer| layer.data.first()).map(|&samples| samples as u32);
        Ok(Some(Self { name: name.to_owned(), file, image, variance, samples }))
    }

    /// Renders it by path tracing and writes it into `folder`; `None` where `progress` stopped it, in which case
    /// nothing is written.
    pub fn make(
        folder: &Path,
        name: &str,
        (scene, scene_hash): (&Scene, &str),
        case: &RenderDesc,
        samples: u32,
        progress: &mut dyn FnMut(&Progress) -> ControlFlow<()>,
    ) -> Result<Option<Self>> {
        let desc = settings(case, samples);
        let mut render = Render::new(scene, RenderSettings { desc, ..RenderSettings::default() })?;
        if render.run(progress)?.stopped {
            return Ok(None);
        }
        let comments = format!("reference {name}; path tracing without a cut; {samples} samples per pixel");
        let file = folder.join(format!("{name}.exr"));
        let origin = folder.join(format!("{name}.json"));
        // An interruption between the two files leaves an image without an origin, which is rendered anew.
        ReferenceOrigin { scene_hash: String::new(), samples: 0 }.write(&origin)?;
        output::write(&render.image(), &file, &WriteOptions { comments, ..WriteOptions::default() })?;
        ReferenceOrigin { scene_hash: scene_hash.to_owned(), samples }.write(&origin)?;
        // It is read back like any other reference, so that later runs measure the same.
        Self::load(folder, name, case.resolution)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_hash_is_that_of_its_authors() {
        assert_eq!(hash(b""), "cbf29ce484222325");
        assert_eq!(hash(b"foobar"), "85944171f73967e8");
    }
}
