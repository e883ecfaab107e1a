//! `merge`, and what the options of `render` about checkpoints and shares mean.

use std::path::{Path, PathBuf};

use etendue::output::{self, Attribute, WriteOptions};
use etendue::render::{Checkpoint, CheckpointPlan, RenderSettings, Summary};

use crate::args::{CheckpointArgs, MergeArgs};
use crate::{Failure, console};

impl CheckpointArgs {
    /// The settings with what these options say. Reads the checkpoint to go on from.
    pub fn apply(&self, settings: RenderSettings) -> Result<(RenderSettings, Option<Checkpoint>), Failure> {
        let plan = |path: &PathBuf| CheckpointPlan { path: path.clone(), every: self.checkpoint_every };
        let settings = RenderSettings { checkpoint: self.checkpoint.as_ref().map(plan), ..settings };
        let checkpoint = self.resume.as_deref().map(Checkpoint::read).transpose()?;
        Ok((settings, checkpoint))
    }

    /// Puts the name of the checkpoint before an error about it.
    pub fn named(&self, error: etendue::Error) -> etendue::Error {
        match error.kind() {
            etendue::ErrorKind::Unsupported => error.in_file(self.resume.as_deref(), 0),
            _ => error,
        }
    }
}

/// Fails where the last checkpoint of a render could not be written.
pub fn check(summary: &Summary) -> Result<(), Failure> {
    summary.checkpoint_failure.as_ref().map_or(Ok(()), |why| Err(Failure::running(why)))
}

/// Merges the parts of a picture, and writes it.
pub fn merge(args: &MergeArgs) -> Result<u8, Failure> {
    for path in &args.output {
        output::check_target(path)?;
    }
    args.checkpoint.as_deref().map_or(Ok(()), output::check_text_target)?;
    let mut parts = args.parts.iter().map(|path| Checkpoint::read(path)).collect::<etendue::Result<Vec<_>>>()?;
    let count = parts.len();
    let is_whole = count == 1 && parts[0].share().is_none();
    let whole = if is_whole { parts.remove(0) } else { Checkpoint::merge(parts)? };
    if let Some(path) = &args.checkpoint {
        whole.write(path).map_err(Failure::running)?;
    }
    let film = whole.film();
    let (image, error) = (film.try_develop(1)?, film.rel_mse());
    let numbers = [
        ("relMSE", error.map(|error| error.value)),
        ("relMSEStandardError", error.map(|error| error.standard_error)),
        ("displayError", film.display_error().map(|error| error.value)),
        ("samplesPerPixel", Some(film.counts().mean)),
        ("rays", Some(whole.rays() as f64)),
    ];
    let attribute = |(name, number): (&str, Option<f64>)| Some((name.to_owned(), Attribute::Number(number?)));
    let options = WriteOptions {
        tone_map: args.tone_map.into(),
        exposure: args.exposure,
        primaries: args.primaries.into(),
        comments: format!("merged from {count} checkpoints; samples per pixel {}", whole.samples()),
        attributes: numbers.into_iter().filter_map(attribute).collect(),
        threads: 0,
    };
    let write = |path: &PathBuf| output::write(&image, path as &Path, &options);
    args.output.iter().try_for_each(write).map_err(Failure::running)?;
    if !args.quiet {
        let error = error.map_or(String::new(), |it| format!(", relMSE {:.2e} ± {:.0e}", it.value, it.standard_error));
        console::say(&format!("merged {count} checkpoints: {} samples per pixel{error}", whole.samples()));
    }
    Ok(0)
}
