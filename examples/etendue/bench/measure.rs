//! Renders the planned cases in turns, and measures them.

use std::cell::Cell;
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};

use etendue::desc::{IntegratorDesc, RenderDesc, RouletteDesc};
use etendue::film::Image;
use etendue::integrator::photon::choose;
use etendue::render::{MOST_SAMPLES, Progress, Render, RenderSettings};
use etendue::scene::{BuildOptions, Scene};

use super::error::{RelMseScale, Scatter};
use super::plan::{BenchJob, Case};
use super::reference::{self, Reference};
use super::results::{self, Pictures, Point, Results, Run, Series, Spread};
use super::suite::{Budget, Suite};
use super::{machine, pictures};
use crate::console::{self, Bar};
use crate::{Failure, interrupt};

/// Letters of a picture's name that its file name contains: file systems limit names to 255 bytes.
const MAX_NAME: usize = 60;

/// Output folder, progress and settings of the measurement.
pub struct Measure<'a> {
    pub suite: &'a Suite,
    pub runs: u32,
    pub reference_samples: u32,
    pub references: PathBuf,
    pub output: PathBuf,
    pub bar: Bar,
    /// Pictures that were written.
    pub pictures: Cell<usize>,
    /// Number of finished renders, and of all.
    pub done: usize,
    pub total: usize,
}

/// The runs of one case with one budget.
struct BudgetRuns {
    case: usize,
    budget: Budget,
    /// Whether the report shows pictures of these runs.
    is_shown: bool,
    runs: Vec<Run>,
    sums: Vec<f64>,
    scatter: Scatter,
    peak_memory: Option<u64>,
}

/// A reference and the weights of its error.
struct MeasuredReference {
    reference: Reference,
    scale: RelMseScale,
}

impl Measure<'_> {
    /// Measures all cases of a job, in rounds in which each case is rendered once, so that a drift of the machine's
    /// speed affects all of them. The measurements before a Ctrl-C or an error are stored.
    pub fn job(&mut self, job: &BenchJob, results: &mut Results) -> Result<(), Failure> {
        let scene = Scene::build(&job.description, &BuildOptions::default())?;
        scene.warnings().iter().for_each(console::warn);
        results.machine.get_or_insert_with(|| machine::describe(&scene));
        let cases = resolve(job, &scene, &mut results.notes);
        let mut standards = Vec::new();
        for case in &cases {
            let Some(standard) = self.standard(job, &scene, &case.desc, &mut standards)? else {
                return Ok(());
            };
            debug_assert!(standard < standards.len());
        }
        let mut entries: Vec<_> = cases.iter().enumerate().flat_map(|(index, case)| entries(index, case)).collect();
        let mut shown: Vec<Pictures> = cases.iter().map(|_| Pictures::default()).collect();
        let ended = self.rounds(job, &scene, &cases, &standards, &mut entries, &mut shown);
        for (index, (case, pictures)) in cases.iter().zip(shown).enumerate() {
            let of_case = entries.iter().filter(|entry| entry.case == index);
            let name = reference::name(&job.scene, &case.desc);
            let Some(standard) = standards.iter().find(|standard| standard.reference.name == name) else { continue };
            let points: Vec<_> = of_case.filter_map(|entry| entry.point(standard)).collect();
            if !points.is_empty() {
                self.note(standard, results)?;
                results.series.push(self.series(job, case, points, pictures));
            }
        }
        ended
    }

    /// Renders the runs of all entries, until Ctrl-C.
    fn rounds(
        &mut self,
        job: &BenchJob,
        scene: &Scene,
        cases: &[Case],
        standards: &[MeasuredReference],
        entries: &mut [BudgetRuns],
        shown: &mut [Pictures],
    ) -> Result<(), Failure> {
        for round in 0..self.runs {
            for turn in 0..entries.len() {
                // The order differs each time, so that no case always follows the same neighbour.
                let number = (turn + round as usize) % entries.len();
                let entry = &mut entries[number];
                let case = &cases[entry.case];
                let name = reference::name(&job.scene, &case.desc);
                let Some(standard) =
                    standards.iter().find(|standard: &&MeasuredReference| standard.reference.name == name)
                else {
                    continue;
                };
                let what =
                    format!("{}: {}, {}, run {} of {}", job.scene, case.name, entry.budget, round + 1, self.runs);
                let Some(image) = self.run(scene, case, entry, round, standard, &what)? else {
                    return Ok(());
                };
                if entry.is_shown && round == 0 {
                    shown[entry.case] = self.pictures(job, case, &image, standard)?;
                }
            }
        }
        Ok(())
    }

    /// Index of this case's reference in the list; the reference is read or rendered where it is missing. `None` after
    /// Ctrl-C.
    fn standard(
        &mut self,
        job: &BenchJob,
        scene: &Scene,
        case: &RenderDesc,
        standards: &mut Vec<MeasuredReference>,
    ) -> Result<Option<usize>, Failure> {
        let name = reference::name(&job.scene, case);
        if let Some(known) = standards.iter().position(|standard| standard.reference.name == name) {
            return Ok(Some(known));
        }
        let is_current = reference::is_current(&self.references, &name, &job.hash, self.reference_samples)?;
        let known = if is_current { Reference::load(&self.references, &name, case.resolution)? } else { None };
        let reference = match known {
            Some(reference) => reference,
            None => {
                let (samples, folder) = (self.reference_samples, self.references.clone());
                let what = format!("{}: reference of {samples} samples", job.scene);
                let show = &mut |progress: &Progress| self.show(progress, &what);
                let made = Reference::make(&folder, &name, (scene, &job.hash), case, samples, show);
                let Some(made) = made.map_err(Failure::running)? else { return Ok(None) };
                made
            }
        };
        let scale = RelMseScale::new(&reference);
        standards.push(MeasuredReference { reference, scale });
        Ok(Some(standards.len() - 1))
    }

    /// Adds a reference that was used to the results, with its pictures. This happens only after a measurement, so that
    /// the output of an earlier benchmark stays until there is something to replace it.
    fn note(&self, standard: &MeasuredReference, results: &mut Results) -> Result<(), Failure> {
        let MeasuredReference { reference, scale } = standard;
        let name = reference.name.clone();
        if results.references.iter().any(|known| known.name == name) {
            return Ok(());
        }
        let pictures = Pictures {
            picture: Some(self.keep(&name, "", |path| pictures::write_picture(&reference.image, path))?),
            linear: Some(self.keep(&name, "-linear", |path| pictures::write_linear(&reference.image, path))?),
            error_map: None,
        };
        let noise = reference.variance.as_ref().map(|_| scale.noise);
        if noise.is_none() {
            let file = reference.file.display();
            results.notes.push(format!("the noise of {file} is not known and was not taken off"));
        }
        let (size, samples) = ([reference.image.width, reference.image.height], reference.samples);
        results.references.push(results::Reference { name, size, samples, noise, pictures });
        Ok(())
    }

    /// Renders once and adds the measurement to the entry; `None` after Ctrl-C.
    fn run(
        &mut self,
        scene: &Scene,
        case: &Case,
        entry: &mut BudgetRuns,
        round: u32,
        standard: &MeasuredReference,
        what: &str,
    ) -> Result<Option<Image>, Failure> {
        let (samples, time_limit) = match entry.budget {
            Budget::Samples(samples) => (samples, None),
            Budget::Time(time) => (MOST_SAMPLES, Some(time)),
        };
        let seed = u64::from(round) + 1;
        let desc = RenderDesc { samples, seed, ..case.desc.clone() };
        let settings = RenderSettings { desc, threads: case.threads, time_limit, ..RenderSettings::default() };
        let mut render = Render::new(scene, settings).map_err(Failure::running)?;
        let can_reset = machine::reset_peak_memory();
        let summary = render.run(&mut |progress| self.show(progress, what)).map_err(Failure::running)?;
        if summary.stopped {
            return Ok(None);
        }
        if can_reset {
            entry.peak_memory = entry.peak_memory.max(console::peak_memory());
        }
        let image = render.image();
        let rel_mse = standard.scale.rel_mse(&image, &standard.reference);
        let (seconds, rays) = (summary.elapsed.as_secs_f64(), summary.rays);
        entry.runs.push(Run { seed, samples: summary.samples, seconds, rays, rel_mse });
        entry.sums.push(image.mean().iter().sum());
        entry.scatter.add(&image);
        self.done += 1;
        Ok(Some(image))
    }

    fn show(&self, progress: &Progress, what: &str) -> ControlFlow<()> {
        self.bar.show((self.done as f64 + progress.fraction) / self.total.max(1) as f64, what.to_owned());
        if interrupt::requested() { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    }

    fn series(&self, job: &BenchJob, case: &Case, points: Vec<Point>, pictures: Pictures) -> Series {
        let desc = &case.desc;
        let depth = desc.max_depth.map_or("none".to_owned(), |depth| depth.to_string());
        let roulette = if desc.roulette == RouletteDesc::File { ", roulette file" } else { "" };
        Series {
            renderer: machine::renderer(),
            group: Some(self.suite.groups[job.group].name.clone()),
            scene: job.scene.clone(),
            name: case.name.clone(),
            integrator: desc.integrator.name().to_owned(),
            settings: format!(
                "sampler {:?}, filter {:?}, maximum depth {depth}, shadow rays {}{roulette}",
                desc.sampler, desc.filter, desc.shadow_rays
            ),
            threads: Some(case.threads),
            reference: Some(reference::name(&job.scene, desc)),
            points,
            pictures,
        }
    }

    fn pictures(
        &self,
        job: &BenchJob,
        case: &Case,
        image: &Image,
        standard: &MeasuredReference,
    ) -> Result<Pictures, Failure> {
        let errors = standard.scale.map(image, &standard.reference);
        let group = &self.suite.groups[job.group].name;
        let name = format!("{group}-{}-{}-{}", job.scene, case.name, case.threads);
        let write_errors = |path: &Path| pictures::write_error_map(&errors, [image.width, image.height], path);
        Ok(Pictures {
            picture: Some(self.keep(&name, "", |path| pictures::write_picture(image, path))?),
            error_map: Some(self.keep(&name, "-error", write_errors)?),
            linear: Some(self.keep(&name, "-linear", |path| pictures::write_linear(image, path))?),
        })
    }

    /// Writes a picture into the output folder and returns its path relative to the folder.
    fn keep(
        &self,
        name: &str,
        kind: &str,
        write: impl FnOnce(&Path) -> etendue::Result<()>,
    ) -> Result<String, Failure> {
        // The number distinguishes pictures whose names have the same letters, or differ only beyond the limit.
        let plain = name.chars().map(|letter| if letter.is_ascii_alphanumeric() { letter } else { '-' });
        let plain: String = plain.take(MAX_NAME).collect();
        self.pictures.set(self.pictures.get() + 1);
        let path = format!("images/{:04}-{plain}{kind}.png", self.pictures.get());
        write(&self.output.join(&path)).map_err(Failure::running)?;
        Ok(path)
    }
}

/// The cases with the integrator that `auto` chose. Cases that are the same after that are removed, with a note.
fn resolve(job: &BenchJob, scene: &Scene, notes: &mut Vec<String>) -> Vec<Case> {
    let mut cases = Vec::<Case>::new();
    for case in &job.cases {
        let (mut name, mut desc) = (case.name.clone(), case.desc.clone());
        // Where a bias is allowed, the render chooses once more.
        if desc.integrator == IntegratorDesc::Auto && !desc.allow_bias {
            desc.integrator = choose(scene).integrator;
            name = format!("{name} = {}", desc.integrator.name());
        }
        let twin = cases
            .iter()
            .find(|known| known.desc == desc && known.threads == case.threads && known.budgets == case.budgets);
        match twin {
            Some(twin) => notes.push(format!("{}: '{name}' is the same as '{}'", job.scene, twin.name)),
            None => cases.push(Case { name, desc, threads: case.threads, budgets: case.budgets.clone() }),
        }
    }
    cases
}

fn entries(index: usize, case: &Case) -> impl Iterator<Item = BudgetRuns> {
    let last = case.budgets.len() - 1;
    case.budgets.iter().enumerate().map(move |(number, &budget)| BudgetRuns {
        case: index,
        budget,
        is_shown: number == last,
        runs: Vec::new(),
        sums: Vec::new(),
        scatter: Scatter::default(),
        peak_memory: None,
    })
}

impl BudgetRuns {
    /// The measurements of the runs; `None` where there are none.
    fn point(&self, standard: &MeasuredReference) -> Option<Point> {
        let all = |value: fn(&Run) -> f64| Spread::of(self.runs.iter().map(value));
        let samples = all(|run| f64::from(run.samples))?.median as u32;
        let rel_mse = all(|run| run.rel_mse)?;
        let noise = self.scatter.noise(&standard.scale);
        let mean_error = self.runs.iter().map(|run| run.rel_mse).sum::<f64>() / self.runs.len() as f64;
        let mean = self.sums.iter().sum::<f64>() / self.sums.len() as f64;
        let efficiency = if rel_mse.min > 0.0 { all(|run| 1.0 / (run.rel_mse * run.seconds)) } else { None };
        Some(Point {
            samples: Some(samples),
            budget_seconds: match self.budget {
                Budget::Time(time) => Some(time.as_secs_f64()),
                Budget::Samples(_) => None,
            },
            seconds: all(|run| run.seconds)?,
            rel_mse,
            rays_per_second: all(|run| run.rays as f64 / run.seconds),
            efficiency,
            noise,
            bias: noise.map(|noise| mean_error - noise),
            bias_resolution: noise.map(|noise| self.scatter.bias_resolution(noise, &standard.scale)),
            mean_ratio: Some(mean / standard.reference.image.mean().iter().sum::<f64>()),
            peak_memory: self.peak_memory,
            runs: self.runs.clone(),
        })
    }
}
