//! Benchmark suites: groups of cases, from a suite file or from the command line, in one form.

use std::collections::HashSet;
use std::fmt;
use std::path::{Path, PathBuf};
use std::thread;
use std::time::Duration;

use clap::ValueEnum;
use etendue::desc::{self, RenderDesc};
use etendue::render::MAX_THREADS;
use etendue::{Error, ErrorKind, Result};
use serde::Deserialize;
use serde::de::IgnoredAny;
use serde_json::{Value, json};

use super::results;
use crate::args::BenchArgs;

/// Default samples per pixel.
const SAMPLES: [u32; 3] = [16, 64, 256];

/// A suite file: `{"etendueSuite": 1, "groups": [...]}`; docs/benchmarks.md describes every key.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields, rename_all = "camelCase")]
pub struct Suite {
    etendue_suite: u32,
    /// Title of the report.
    #[serde(default)]
    pub title: String,
    /// Text below the title.
    #[serde(default)]
    pub description: String,
    /// Runs of each case.
    pub runs: Option<u32>,
    /// Samples per pixel of references that are rendered.
    pub reference_samples: Option<u32>,
    /// Groups, each of which has a plot and a table.
    pub groups: Vec<Group>,
    /// The text of the file, in which the `render` blocks are looked up.
    #[serde(skip)]
    text: String,
    /// Path of the file, for messages.
    #[serde(skip)]
    file: Option<PathBuf>,
}

/// Cases that are compared with each other, on one scene or several.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields, rename_all = "camelCase")]
pub struct Group {
    /// Name of its tables and pictures.
    pub name: String,
    /// Title for readers; the name where it is empty.
    #[serde(default)]
    pub title: String,
    /// A sentence below the title.
    #[serde(default)]
    pub description: String,
    /// Scene files, relative to the folder of the suite.
    pub scenes: Vec<PathBuf>,
    /// Settings for all cases, which override the scene's `render` block.
    render: Option<IgnoredAny>,
    /// Samples per pixel of the runs; those of the settings where neither these nor seconds are given.
    #[serde(default)]
    samples: Vec<u32>,
    /// Times of the runs (s).
    #[serde(default)]
    seconds: Vec<f64>,
    /// Numbers of threads; 0 stands for all cores.
    #[serde(default)]
    threads: Vec<usize>,
    /// The cases that are compared.
    pub cases: Vec<Case>,
}

/// One way to render.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Case {
    /// Name of its curve.
    pub name: String,
    /// Settings that override those of the group.
    render: Option<IgnoredAny>,
}

/// The budget that ends a run.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Budget {
    /// Samples per pixel.
    Samples(u32),
    /// Time.
    Time(Duration),
}

impl Suite {
    /// Reads a suite file.
    pub fn load(path: &Path) -> Result<Self> {
        let text = results::read_text(path, "the suite")?;
        let mut suite = Self::parse(text, Some(path))?;
        // Paths of scenes are relative to the suite.
        let folder = path.parent().unwrap_or(Path::new(""));
        for scene in suite.groups.iter_mut().flat_map(|group| &mut group.scenes) {
            *scene = folder.join(&*scene);
        }
        Ok(suite)
    }

    /// The suite for a command's options: every integrator with every sampler.
    pub fn from_args(args: &BenchArgs) -> Result<Self> {
        let integrators = args.integrators.iter().map(|&integrator| ("integrator", name(integrator)));
        let samplers = args.samplers.iter().map(|&sampler| ("sampler", name(sampler)));
        let or_scene = |list: Vec<_>| if list.is_empty() { vec![None] } else { list.into_iter().map(Some).collect() };
        let (integrators, samplers) = (or_scene(integrators.collect()), or_scene(samplers.collect()));
        let mut cases = Vec::new();
        for integrator in &integrators {
            for sampler in &samplers {
                let keys: Vec<_> = integrator.iter().chain(sampler).collect();
                let words: Vec<_> = keys.iter().map(|(_, name)| name.as_str()).collect();
                let name = if words.is_empty() { "the scene's settings".to_owned() } else { words.join(", ") };
                let render: serde_json::Map<_, _> =
                    keys.iter().map(|(key, name)| ((*key).to_owned(), Value::from(name.as_str()))).collect();
                cases.push(json!({"name": name, "render": render}));
            }
        }
        let samples = if args.spp.is_empty() && args.time.is_empty() { &SAMPLES[..] } else { &args.spp };
        let document = json!({
            "etendueSuite": 1,
            "groups": [{"name": "scenes", "title": "Scenes", "scenes": args.scenes, "cases": cases, "samples": samples}],
        });
        Self::parse(document.to_string(), None)
    }

    fn parse(text: String, file: Option<&Path>) -> Result<Self> {
        let mut reader = serde_json::Deserializer::from_str(&text);
        let read = serde_path_to_error::deserialize::<_, Self>(&mut reader);
        let mut suite = read.map_err(|error| {
            let (path, error) = (error.path().to_string(), error.into_inner());
            let mut message = error.to_string();
            message.truncate(message.rfind(" at line ").unwrap_or(message.len()));
            let path = if path == "." { String::new() } else { path };
            Error::invalid(path, message).in_file(file, error.line())
        })?;
        reader.end().map_err(|error| Error::invalid("", error.to_string()).in_file(file, error.line()))?;
        suite.check().map_err(|error| error.in_file(file, 0))?;
        (suite.text, suite.file) = (text, file.map(Path::to_owned));
        Ok(suite)
    }

    fn check(&self) -> Result<()> {
        if self.etendue_suite != 1 {
            let message = format!("the suite is of version {}, this program reads version 1", self.etendue_suite);
            return Err(Error::new(ErrorKind::Unsupported, message).at("etendueSuite"));
        }
        positive("runs", self.runs.map(f64::from))?;
        positive("referenceSamples", self.reference_samples.map(f64::from))?;
        unique("groups", self.groups.iter().map(|group| &group.name))?;
        for (index, group) in self.groups.iter().enumerate() {
            let at = |key: &str| format!("groups[{index}].{key}");
            unique(&at("cases"), group.cases.iter().map(|case| &case.name))?;
            if group.scenes.is_empty() {
                return Err(Error::invalid(at("scenes"), "expected at least one scene"));
            }
            positive(&at("samples"), group.samples.iter().map(|&samples| f64::from(samples)))?;
            positive(&at("seconds"), group.seconds.iter().copied())?;
            if let Some(threads) = group.threads.iter().find(|threads| **threads > MAX_THREADS) {
                return Err(Error::invalid(at("threads"), format!("{threads} is above {MAX_THREADS}")));
            }
        }
        Ok(())
    }

    /// The settings of a case on a scene: those of the scene, overridden by those of the group, overridden by those of
    /// the case.
    pub fn settings(&self, group: usize, case: usize, scene: &RenderDesc) -> Result<RenderDesc> {
        let (group, mut settings) = ((group, &self.groups[group]), scene.clone());
        let file = self.file.as_deref();
        if group.1.render.is_some() {
            settings = desc::apply_render(&self.text, &format!("groups[{}].render", group.0), file, &settings)?;
        }
        if group.1.cases[case].render.is_some() {
            let path = format!("groups[{}].cases[{case}].render", group.0);
            settings = desc::apply_render(&self.text, &path, file, &settings)?;
        }
        Ok(settings)
    }
}

impl fmt::Display for Budget {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Samples(samples) => write!(f, "{samples} samples"),
            Self::Time(time) => write!(f, "{} s", time.as_secs_f64()),
        }
    }
}

impl Group {
    /// Budgets of each case, smallest first. The command line takes precedence over the suite.
    pub fn budgets(&self, args: &BenchArgs, settings: &RenderDesc) -> Vec<Budget> {
        let is_asked = !args.spp.is_empty() || !args.time.is_empty();
        let (mut samples, mut seconds) = if is_asked {
            (args.spp.clone(), args.time.clone())
        } else {
            (self.samples.clone(), self.seconds.iter().map(|&seconds| Duration::from_secs_f64(seconds)).collect())
        };
        if samples.is_empty() && seconds.is_empty() {
            samples.push(settings.samples);
        }
        samples.sort_unstable();
        seconds.sort_unstable();
        samples.dedup();
        seconds.dedup();
        samples.into_iter().map(Budget::Samples).chain(seconds.into_iter().map(Budget::Time)).collect()
    }

    /// Numbers of threads, each once and none of them 0. The command line takes precedence over the suite.
    pub fn threads(&self, args: &BenchArgs) -> Vec<usize> {
        let list = if args.threads.is_empty() { &self.threads } else { &args.threads };
        let all = thread::available_parallelism().map_or(1, usize::from);
        let mut threads = Vec::new();
        for &asked in if list.is_empty() { &[0][..] } else { list } {
            let count = if asked == 0 { all } else { asked };
            if !threads.contains(&count) {
                threads.push(count);
            }
        }
        threads
    }
}

fn name(value: impl ValueEnum) -> String {
    value.to_possible_value().map_or_else(String::new, |value| value.get_name().to_owned())
}

fn unique<'a>(path: &str, names: impl Iterator<Item = &'a String>) -> Result<()> {
    let mut seen = HashSet::new();
    for (index, name) in names.enumerate() {
        let at = format!("{path}[{index}].name");
        if name.trim().is_empty() {
            return Err(Error::invalid(at, "the name is empty"));
        }
        if !seen.insert(name) {
            return Err(Error::invalid(at, format!("the name '{name}' is given twice")));
        }
    }
    if seen.is_empty() { Err(Error::invalid(path, "expected at least one")) } else { Ok(()) }
}

/// A year of seconds, or as many samples, is more than any meaningful value.
fn positive(path: &str, values: impl IntoIterator<Item = f64>) -> Result<()> {
    match values.into_iter().find(|value| !(*value > 0.0 && *value <= 3e7)) {
        Some(value) => Err(Error::invalid(path, format!("{value} is out of range, expected above 0 and up to 3e7"))),
        None => Ok(()),
    }
}
