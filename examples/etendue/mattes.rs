//! Mattes of `render`: `--cryptomatte`.

use std::ops::ControlFlow;
use std::path::PathBuf;

use etendue::ErrorKind;
use etendue::desc::SceneDesc;
use etendue::film::Layer;
use etendue::output::{Attribute, cryptomatte};
use etendue::render::{MatteSettings, Mattes, RenderSettings, Summary};
use etendue::scene::Scene;

use crate::args::MatteArgs;
use crate::console::{self, Bar};
use crate::{Failure, interrupt};

impl MatteArgs {
    /// Refuses mattes where none of the files that are written could have them.
    pub fn check(&self, outputs: &[PathBuf]) -> Result<(), Failure> {
        let is_exr = |path: &PathBuf| path.extension().is_some_and(|it| it.eq_ignore_ascii_case("exr"));
        if self.cryptomatte && !outputs.iter().any(is_exr) {
            let message = "--cryptomatte: no output has room for layers, expected one with a name that ends in .exr";
            return Err(Failure::usage(message));
        }
        Ok(())
    }

    /// Traces what is asked for, for a picture that was rendered so. `None` where that was stopped, after a warning.
    pub fn trace(
        &self,
        description: &SceneDesc,
        scene: &Scene,
        settings: &RenderSettings,
        summary: &Summary,
        quiet: bool,
    ) -> Result<Option<Found>, Failure> {
        if !self.cryptomatte {
            return Ok(Some(Found::default()));
        }
        // As many samples as the picture has, of which an adaptive one has the mean.
        let mean = summary.sample_counts.map_or(0.0, |counts| counts.mean).ceil() as u32;
        let matte_settings = MatteSettings {
            desc: settings.desc.clone(),
            samples: Some(mean.max(summary.samples).max(1)),
            levels: self.cryptomatte_levels,
            workers: settings.workers.clone(),
            ..MatteSettings::default()
        };
        let bar = Bar::new(quiet);
        let outcome = Mattes::trace(scene, description, &matte_settings, &mut |fraction| {
            bar.show(fraction, "mattes".to_owned());
            if interrupt::requested() { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
        });
        drop(bar);
        let mattes = match outcome {
            Err(error) if error.kind() == ErrorKind::Cancelled => {
                console::warn("stopped: the image has no mattes");
                return Ok(None);
            }
            outcome => outcome.map_err(Failure::running)?,
        };
        let layers = cryptomatte::layers(&mattes).map_err(Failure::running)?;
        let attributes = cryptomatte::attributes(&mattes).map_err(Failure::running)?;
        Ok(Some(Found { layers, attributes }))
    }
}

/// What mattes add to an image.
#[derive(Default)]
pub struct Found {
    pub layers: Vec<Layer>,
    pub attributes: Vec<(String, Attribute)>,
}
