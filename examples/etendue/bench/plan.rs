//! From a suite to a plan of renders. All errors of the suite are reported here, before the first ray.

use std::collections::{HashMap, HashSet};
use std::fs;
use std::path::{Path, PathBuf};
use std::rc::Rc;

use etendue::Error;
use etendue::desc::{self, RenderDesc, SceneDesc};

use super::reference;
use super::suite::{Budget, Suite};
use crate::args::BenchArgs;
use crate::{Failure, console};

/// Least samples per pixel of a reference by default.
const REFERENCE_SAMPLES: u32 = 1024;

/// All cases of a group on one scene, which are rendered in turns.
pub struct BenchJob {
    /// Index of the group in the suite.
    pub group: usize,
    /// The scene's file without folder and extension.
    pub scene: String,
    /// Hash of the file, which detects changes.
    pub hash: String,
    /// The scene.
    pub description: Rc<SceneDesc>,
    /// The cases that are compared.
    pub cases: Vec<Case>,
}

/// One curve.
pub struct Case {
    /// Its name.
    pub name: String,
    /// Settings of the case; samples and seed belong to each run.
    pub desc: RenderDesc,
    /// Threads, at least 1.
    pub threads: usize,
    /// Its points.
    pub budgets: Vec<Budget>,
}

/// A scene that was loaded.
struct LoadedScene {
    /// Its name at its first use.
    path: PathBuf,
    hash: String,
    description: Rc<SceneDesc>,
}

/// Reads every scene, and determines every case.
///
/// References and tables have the names of scene files without folder, so two files with the same name are refused.
pub fn plan(suite: &Suite, args: &BenchArgs) -> Result<Vec<BenchJob>, Failure> {
    let mut scenes = HashMap::<PathBuf, LoadedScene>::new();
    let mut names = HashMap::<String, PathBuf>::new();
    let mut jobs = Vec::new();
    for (number, group) in suite.groups.iter().enumerate() {
        let mut of_group = HashSet::new();
        for path in &group.scenes {
            // One file may have several names.
            let file = fs::canonicalize(path).unwrap_or_else(|_| path.clone());
            if !of_group.insert(file.clone()) {
                continue;
            }
            let name = stem(path);
            let first = names.entry(name.clone()).or_insert_with(|| file.clone());
            if *first != file {
                let other = scenes.get(first).map_or(first.as_path(), |known| &known.path);
                return Err(Failure::usage(format!(
                    "{} and {} are both called '{name}': their references and tables would be the same",
                    other.display(),
                    path.display()
                )));
            }
            if !scenes.contains_key(&file) {
                let read = desc::load(path, None)?;
                read.warnings.iter().for_each(console::warn);
                let text = fs::read(path).map_err(|error| Error::io(path, "cannot read the file", error))?;
                let (path, hash) = (path.clone(), reference::hash(&text));
                scenes.insert(file.clone(), LoadedScene { path, hash, description: Rc::new(read) });
            }
            let LoadedScene { hash, description, .. } = &scenes[&file];
            let mut cases = Vec::new();
            for (index, case) in group.cases.iter().enumerate() {
                let mut desc = suite.settings(number, index, &description.render)?;
                desc.resolution = args.resolution.unwrap_or(desc.resolution);
                desc.crop = None;
                for threads in group.threads(args) {
                    let (name, budgets) = (case.name.clone(), group.budgets(args, &desc));
                    cases.push(Case { name, desc: desc.clone(), threads, budgets });
                }
            }
            let (hash, description) = (hash.clone(), Rc::clone(description));
            jobs.push(BenchJob { group: number, scene: name, hash, description, cases });
        }
    }
    Ok(jobs)
}

/// Samples per pixel of references that have to be rendered.
pub fn reference_samples(suite: &Suite, jobs: &[BenchJob], args: &BenchArgs) -> u32 {
    let samples = jobs.iter().flat_map(|job| &job.cases).flat_map(|case| &case.budgets).map(|budget| match budget {
        Budget::Samples(samples) => *samples,
        Budget::Time(_) => 0,
    });
    let most = samples.max().unwrap_or(0).saturating_mul(4).max(REFERENCE_SAMPLES);
    args.reference_spp.or(suite.reference_samples).unwrap_or(most)
}

fn stem(path: &Path) -> String {
    path.file_stem().map_or_else(|| "scene".to_owned(), |name| name.to_string_lossy().into_owned())
}
