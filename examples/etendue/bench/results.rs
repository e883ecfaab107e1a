//! `results.json`: what was measured, in a form that other renderers' results can have too. docs/benchmarks.md describes
//! every key.

use std::collections::BTreeMap;
use std::fs::{self, File};
use std::io::Read;
use std::path::{Component, Path};
use std::rc::Rc;

use etendue::{Error, ErrorKind, Result};
use serde::{Deserialize, Serialize};

/// Size limit of a results file [bytes].
const MAX_RESULTS_BYTES: u64 = 256 << 20;
/// Size limit of a picture [bytes].
const MAX_PICTURE_BYTES: u64 = 64 << 20;
/// Signature of every PNG file.
const PNG: &[u8] = b"\x89PNG\r\n\x1a\n";

/// All results of a benchmark.
#[derive(Clone, Debug, Default, Deserialize, Serialize)]
#[serde(rename_all = "camelCase")]
pub struct Results {
    /// Version of this format: 1.
    pub etendue_bench: u32,
    /// Title of the report.
    #[serde(default)]
    pub title: String,
    /// Text below the title.
    #[serde(default)]
    pub description: String,
    /// End of the benchmark, RFC 3339 in UTC.
    #[serde(default)]
    pub when: String,
    /// The command, word by word.
    #[serde(default)]
    pub command: Vec<String>,
    /// Requested runs of each case.
    #[serde(default)]
    pub runs: u32,
    /// False where the benchmark was stopped before its end.
    #[serde(default)]
    pub complete: bool,
    /// The machine.
    pub machine: Option<Machine>,
    /// Titles of the groups.
    #[serde(default)]
    pub groups: Vec<Group>,
    /// The references.
    #[serde(default)]
    pub references: Vec<Reference>,
    /// The curves.
    #[serde(default)]
    pub series: Vec<Series>,
    /// Notes for the reader.
    #[serde(default)]
    pub notes: Vec<String>,
    /// The files of the pictures, by their paths relative to the working directory.
    #[serde(skip)]
    pub contents: BTreeMap<String, Rc<Vec<u8>>>,
}

/// The machine on which a benchmark ran.
#[derive(Clone, Debug, Deserialize, Serialize)]
#[serde(rename_all = "camelCase")]
pub struct Machine {
    /// Model of the processor.
    pub cpu: String,
    /// Logical cores that this process may use.
    pub logical_cores: usize,
    /// Operating system and processor family.
    pub os: String,
    /// Name and version of the renderer.
    pub renderer: String,
    /// Version of the ray kernel.
    pub embree: String,
    /// How the program was compiled: profile and instruction sets.
    pub build: String,
}

/// Cases that are compared with each other.
#[derive(Clone, Debug, Deserialize, Serialize)]
#[serde(rename_all = "camelCase")]
pub struct Group {
    /// Its name, which series refer to.
    pub name: String,
    /// Title for readers.
    #[serde(default)]
    pub title: String,
    /// Description in a sentence.
    #[serde(default)]
    pub description: String,
}

/// A reference image.
#[derive(Clone, Debug, Deserialize, Serialize)]
#[serde(rename_all = "camelCase")]
pub struct Reference {
    /// Its name, which series refer to.
    pub name: String,
    /// Width and height, pixels.
    pub size: [u32; 2],
    /// Samples per pixel, where they are known.
    pub samples: Option<u32>,
    /// Its own noise as relMSE, which was subtracted; null where it is unknown and nothing was subtracted.
    pub noise: Option<f64>,
    /// Pictures, by paths relative to the file's folder.
    #[serde(flatten)]
    pub pictures: Pictures,
}

/// Pictures, by their names relative to the file's folder.
#[derive(Clone, Debug, Default, Deserialize, Serialize)]
#[serde(rename_all = "camelCase")]
pub struct Pictures {
    /// PNG, sRGB, values above 1 white.
    pub picture: Option<String>,
    /// Grey PNG of the relative squared error, on a logarithmic scale (`pictures::LOWEST`, `pictures::DECADES`).
    pub error_map: Option<String>,
    /// PNG of linear values: mantissas of red, green and blue above, their exponent below.
    pub linear: Option<String>,
}

/// One way to render one scene: a curve of error against time.
#[derive(Clone, Debug, Default, Deserialize, Serialize)]
#[serde(rename_all = "camelCase")]
pub struct Series {
    /// The renderer.
    pub renderer: String,
    /// The group; a series without one belongs to every group that has the scene.
    pub group: Option<String>,
    /// The scene, by the name of its file without extension.
    pub scene: String,
    /// The label of the curve.
    #[serde(default)]
    pub name: String,
    /// Integrator: the one that `auto` chose, where that was requested.
    #[serde(default)]
    pub integrator: String,
    /// All settings, in readable form.
    #[serde(default)]
    pub settings: String,
    /// Number of threads that rendered.
    pub threads: Option<usize>,
    /// The reference.
    pub reference: Option<String>,
    /// One point for each budget.
    pub points: Vec<Point>,
    /// Pictures of the last point's first run.
    #[serde(flatten)]
    pub pictures: Pictures,
}

/// Measurements for one budget.
#[derive(Clone, Debug, Deserialize, Serialize)]
#[serde(rename_all = "camelCase")]
pub struct Point {
    /// Samples per pixel, the median where time was the budget.
    pub samples: Option<u32>,
    /// The budget, where it was time (s).
    pub budget_seconds: Option<f64>,
    /// Render time (s), without reading and building the scene.
    pub seconds: Spread,
    /// Relative mean squared error, minus the noise of the reference.
    pub rel_mse: Spread,
    /// Rays per second.
    pub rays_per_second: Option<Spread>,
    /// 1 / (relMSE x s).
    pub efficiency: Option<Spread>,
    /// The part of relMSE that differs from run to run.
    pub noise: Option<f64>,
    /// The part that all runs have in common; below zero by chance where there is none.
    pub bias: Option<f64>,
    /// Below this value `bias` is not significant.
    pub bias_resolution: Option<f64>,
    /// Mean of all values of the image over the mean of the reference.
    pub mean_ratio: Option<f64>,
    /// The peak memory of the process while it rendered (bytes).
    pub peak_memory: Option<u64>,
    /// Each run.
    #[serde(default)]
    pub runs: Vec<Run>,
}

/// One image that was rendered.
#[derive(Clone, Debug, Deserialize, Serialize)]
#[serde(rename_all = "camelCase")]
pub struct Run {
    /// Seed of its randomness.
    pub seed: u64,
    /// Samples per pixel.
    pub samples: u32,
    /// Render time (s).
    pub seconds: f64,
    /// Rays, closest-hit and shadow rays together.
    pub rays: u64,
    /// Relative mean squared error.
    pub rel_mse: f64,
}

/// Median and range of several runs. It is written as an object; a plain number is read as all three values.
#[derive(Clone, Copy, Debug, Deserialize, PartialEq, Serialize)]
#[serde(from = "Form")]
pub struct Spread {
    /// Median.
    pub median: f64,
    /// Smallest.
    pub min: f64,
    /// Largest.
    pub max: f64,
}

#[derive(Deserialize)]
#[serde(untagged)]
enum Form {
    Number(f64),
    Spread { median: f64, min: f64, max: f64 },
}

impl From<Form> for Spread {
    fn from(form: Form) -> Self {
        match form {
            Form::Number(value) => Self { median: value, min: value, max: value },
            Form::Spread { median, min, max } => Self { median, min, max },
        }
    }
}

impl Spread {
    /// The spread of these values; `None` where there is none, or one is not finite.
    pub fn of(values: impl IntoIterator<Item = f64>) -> Option<Self> {
        let mut values: Vec<_> = values.into_iter().collect();
        if values.iter().any(|value| !value.is_finite()) {
            return None;
        }
        values.sort_by(f64::total_cmp);
        let (&min, &max) = (values.first()?, values.last()?);
        let middle = values.len() / 2;
        let median = if values.len() % 2 == 1 { values[middle] } else { (values[middle - 1] + values[middle]) / 2.0 };
        Some(Self { median, min, max })
    }
}

impl Results {
    /// Reads a file and its pictures, whose paths then are relative to the working directory.
    pub fn load(path: &Path) -> Result<Self> {
        let bytes = read(path, MAX_RESULTS_BYTES, "the results")?;
        let text = String::from_utf8(bytes)
            .map_err(|_| Error::invalid("", "the results are not UTF-8 text").in_file(Some(path), 0))?;
        let mut reader = serde_json::Deserializer::from_str(&text);
        let mut results: Self = serde_path_to_error::deserialize(&mut reader).map_err(|error| {
            let (at, error) = (error.path().to_string(), error.into_inner());
            Error::invalid(at, error.to_string()).in_file(Some(path), error.line())
        })?;
        if results.etendue_bench != 1 {
            let message = format!("the results are of version {}, this program reads 1", results.etendue_bench);
            return Err(Error::invalid("etendueBench", message).in_file(Some(path), 0));
        }
        for (index, series) in results.series.iter().enumerate() {
            if series.points.is_empty() {
                let at = format!("series[{index}].points");
                return Err(Error::invalid(at, "expected at least one point").in_file(Some(path), 0));
            }
            for (number, point) in series.points.iter().enumerate() {
                let at = |key: &str| format!("series[{index}].points[{number}].{key}");
                let is_bad = |spread: Spread, is_good: fn(f64) -> bool| {
                    [spread.median, spread.min, spread.max].into_iter().find(|value| !is_good(*value))
                };
                if let Some(value) = is_bad(point.seconds, |value| value > 0.0 && value.is_finite()) {
                    let message = format!("{value} is out of range, expected above 0");
                    return Err(Error::invalid(at("seconds"), message).in_file(Some(path), 0));
                }
                if let Some(value) = is_bad(point.rel_mse, f64::is_finite) {
                    let message = format!("{value} is not a finite number");
                    return Err(Error::invalid(at("relMse"), message).in_file(Some(path), 0));
                }
            }
        }
        results.read_pictures(path)?;
        Ok(results)
    }

    /// Reads the pictures, and makes their paths relative to the working directory instead of the folder of `file`.
    /// They become part of a report that may be sent to others: only pictures below that folder are accepted.
    pub fn read_pictures(&mut self, file: &Path) -> Result<()> {
        let folder = file.parent().unwrap_or(Path::new(""));
        let mut contents = BTreeMap::new();
        let of_references = self.references.iter_mut().map(|reference| &mut reference.pictures).enumerate();
        let of_series = self.series.iter_mut().map(|series| &mut series.pictures).enumerate();
        let all = of_references.map(|it| ("references", it)).chain(of_series.map(|it| ("series", it)));
        for (list, (index, it)) in all {
            let keys = [("picture", &mut it.picture), ("errorMap", &mut it.error_map), ("linear", &mut it.linear)];
            for (key, path) in keys {
                let Some(path) = path else { continue };
                let fail =
                    |reason: String| Error::invalid(format!("{list}[{index}].{key}"), reason).in_file(Some(file), 0);
                let mut parts = Path::new(path.as_str()).components();
                if !parts.all(|part| matches!(part, Component::Normal(_) | Component::CurDir)) {
                    return Err(fail(format!("'{path}' does not lead from the folder of the file to one below it")));
                }
                let name = folder.join(&*path).to_string_lossy().into_owned();
                if !contents.contains_key(&name) {
                    let bytes =
                        read(Path::new(&name), MAX_PICTURE_BYTES, "the picture").map_err(|e| fail(e.to_string()))?;
                    if !bytes.starts_with(PNG) {
                        return Err(fail(format!("{name}: not a PNG file")));
                    }
                    contents.insert(name.clone(), Rc::new(bytes));
                }
                *path = name;
            }
        }
        self.contents = contents;
        Ok(())
    }

    /// The names of all pictures.
    pub fn pictures_mut(&mut self) -> impl Iterator<Item = &mut String> {
        let of_series = self.series.iter_mut().map(|series| &mut series.pictures);
        let of_references = self.references.iter_mut().map(|reference| &mut reference.pictures);
        let all = of_series.chain(of_references);
        all.flat_map(|it| [&mut it.picture, &mut it.error_map, &mut it.linear]).flatten()
    }

    /// Every (group, scene) that has measurements, in order; series without a group belong to all groups of a scene.
    pub fn plots(&self) -> Vec<(&Group, &str)> {
        let mut plots = Vec::new();
        for group in &self.groups {
            for series in self.series.iter().filter(|series| series.group.as_ref() == Some(&group.name)) {
                if !plots
                    .iter()
                    .any(|(known, scene): &(&Group, &str)| known.name == group.name && *scene == series.scene)
                {
                    plots.push((group, &series.scene));
                }
            }
        }
        plots
    }

    /// Series that are in no plot: their scene is in no group, or their group is unknown.
    pub fn unseen(&self) -> Vec<&Series> {
        let plots = self.plots();
        let is_of = |one: &Series, (group, scene): &(&Group, &str)| {
            one.scene == *scene && one.group.as_deref().is_none_or(|name| name == group.name)
        };
        self.series.iter().filter(|one| !plots.iter().any(|plot| is_of(one, plot))).collect()
    }

    /// The series of a plot.
    pub fn series_of<'a>(&'a self, group: &'a str, scene: &'a str) -> impl Iterator<Item = &'a Series> {
        self.series
            .iter()
            .filter(move |series| series.scene == scene && series.group.as_deref().is_none_or(|name| name == group))
    }
}

/// Most bytes of a file that people write.
const MOST_TEXT: u64 = 64 << 20;

/// The text of such a file.
pub fn read_text(path: &Path, what: &str) -> Result<String> {
    let not_text = |error: std::string::FromUtf8Error| {
        Error::new(ErrorKind::Io, format!("cannot read {what}: {}", error.utf8_error())).in_file(Some(path), 0)
    };
    String::from_utf8(read(path, MOST_TEXT, what)?).map_err(not_text)
}

/// The contents of a regular file with at most `most` bytes; a pipe could be endless.
fn read(path: &Path, most: u64, what: &str) -> Result<Vec<u8>> {
    let failed = |error| Error::io(path, &format!("cannot read {what}"), error);
    let refuse = |reason: String| Err(Error::new(ErrorKind::Io, reason).in_file(Some(path), 0));
    if !fs::metadata(path).map_err(failed)?.is_file() {
        return refuse(format!("cannot read {what}: it is not a regular file"));
    }
    let mut bytes = Vec::new();
    File::open(path).and_then(|file| file.take(most + 1).read_to_end(&mut bytes)).map_err(failed)?;
    if bytes.len() as u64 > most {
        return refuse(format!("cannot read {what}: it has more than {} MiB", most >> 20));
    }
    Ok(bytes)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_spread_is_a_median_between_its_ends() {
        let spread = |median, min, max| Some(Spread { median, min, max });
        assert_eq!(Spread::of([3.0, 1.0, 2.0]), spread(2.0, 1.0, 3.0));
        assert_eq!(Spread::of([4.0, 1.0]), spread(2.5, 1.0, 4.0));
        assert_eq!(Spread::of([]), None);
        assert_eq!(Spread::of([f64::NAN]), None);
        assert_eq!(serde_json::from_str::<Spread>("2").ok(), spread(2.0, 2.0, 2.0));
    }
}
