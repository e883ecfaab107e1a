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
    for (name, text) in [("ended", summary.ended.name()), ("integrator", summary.integrator.name())] {
        attributes.push((name.to_owned(), Attribute::Text(text.to_owned())));
    }
    attributes
}

/// The name of a layer of one channel that holds mean spectral radiance, by the middle of its band \[nm\], in the layout of Fichet,
/// Pacanowski and Wilkie: `S0.412,5nm` for 412.5 nm. An EXR has a channel of this name.
///
/// Source: Fichet, Pacanowski and Wilkie 2021, "An OpenEXR Layout for Spectral Images".
pub fn spectral_layer(nanometres: f64) -> String {
    let number = format!("{nanometres:.4}");
    format!("S0.{}nm", number.trim_end_matches('0').trim_end_matches('.').replace('.', ","))
}

/// The attributes of an image that has layers named by [`spectral_layer`]: `spectralLayoutVersion`, and `emissiveUnits`, which the layout
/// states without the nanometre that radiance is meant for.
pub fn spectral_attributes() -> [(String, Attribute); 2] {
    [("spectralLayoutVersion", "1.0"), ("emissiveUnits", "W.m^-2.sr^-1")]
        .map(|(name, value)| (name.to_owned(), Attribute::Text(value.to_owned())))
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn layers_have_a_decimal_comma() {
        for (nanometres, name) in [
            (412.5, "S0.412,5nm"),
            (500.0, "S0.500nm"),
            (393.333_333_3, "S0.393,3333nm"),
            (386.25, "S0.386,25nm"),
            (399.999_99, "S0.400nm"),
        ] {
            assert_eq!(spectral_layer(nanometres), name);
        }
    }
}
