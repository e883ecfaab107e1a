//! Results of a render, for the header of its image.

use crate::image::Attribute;
use crate::render::{Ended, Summary};

/// Attributes for the results of a render: `relMSE`, `relMSEStandardError` and `displayError` where they are known (see
/// [`Film::rel_mse`](crate::film::Film::rel_mse)), `samplesPerPixel` (the mean), `rays`, and `ended`: `samples`,
/// `time`, `error` or `cancelled`.
///
/// The render time is not among them, so that the same render gives the same file.
pub fn summary_attributes(summary: &Summary) -> Vec<(String, Attribute)> {
    let numbers = [
        ("relMSE", summary.rel_mse.map(|error| error.value)),
        ("relMSEStandardError", summary.rel_mse.map(|error| error.standard_error)),
        ("displayError", summary.display_error.map(|error| error.value)),
        ("samplesPerPixel", summary.sample_counts.map(|counts| counts.mean)),
        ("rays", Some(summary.rays as f64)),
    ];
    let mut attributes: Vec<_> =
        numbers.into_iter().filter_map(|(name, number)| Some((name.to_owned(), Attribute::Number(number?)))).collect();
    attributes.push(("ended".to_owned(), Attribute::Text(summary.ended.name().to_owned())));
    attributes
}

impl Ended {
    /// The name: `samples`, `time`, `error` or `cancelled`.
    pub fn name(self) -> &'static str {
        match self {
            Self::Samples => "samples",
            Self::Time => "time",
            Self::Error => "error",
            Self::Cancelled => "cancelled",
        }
    }
}
