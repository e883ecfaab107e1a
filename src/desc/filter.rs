//! Reads and writes pixel filters of the native format.

use serde::{Deserialize, Serialize};
use serde_json::value::RawValue;

use super::json::{self, Plain, join};
use super::numbers::single;
use super::{FilterDesc, save, validate};
use crate::Result;

/// What `filter` accepts, for the schema.
#[cfg(feature = "schema")]
#[expect(dead_code, reason = "only the schema of these types is used")]
pub(super) mod schema {
    #[derive(schemars::JsonSchema)]
    #[schemars(untagged)]
    pub enum Filter {
        /// Its name, with default parameters.
        Name(FilterName),
        /// Name and parameters.
        Block(FilterBlock),
    }

    #[derive(schemars::JsonSchema)]
    #[schemars(tag = "type", rename_all = "kebab-case", deny_unknown_fields)]
    pub enum FilterBlock {
        /// One pixel wide.
        Box,
        /// Triangle, radius 1 pixel.
        Tent,
        /// Cut at three standard deviations.
        Gaussian {
            /// Standard deviation, pixels, above 0 and up to 16. Default 0.5.
            sigma: Option<f64>,
        },
        /// Blackman-Harris window, radius 2 pixels.
        BlackmanHarris,
        /// Mitchell-Netravali, radius 2 pixels.
        Mitchell {
            /// B, in [0, 1]. Default 1/3.
            b: Option<f64>,
            /// C, in [0, 1]. Default 1/3.
            c: Option<f64>,
        },
    }

    #[derive(schemars::JsonSchema)]
    #[schemars(rename_all = "kebab-case")]
    pub enum FilterName {
        Box,
        Tent,
        Gaussian,
        BlackmanHarris,
        Mitchell,
    }
}

const FILTERS: [&str; 5] = ["box", "tent", "gaussian", "blackman-harris", "mitchell"];

#[derive(Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
struct Gaussian {
    #[serde(rename = "type")]
    _type: String,
    sigma: Option<f64>,
}

#[derive(Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
struct Mitchell {
    #[serde(rename = "type")]
    _type: String,
    b: Option<f64>,
    c: Option<f64>,
}

fn gaussian(path: &str, sigma: f64) -> Result<FilterDesc> {
    let at = join(path, "sigma");
    validate::positive(&at, sigma)?;
    Ok(FilterDesc::Gaussian { sigma: validate::within(&at, sigma, 0.0, 16.0)? })
}

fn mitchell(path: &str, b: f64, c: f64) -> Result<FilterDesc> {
    let within = |key: &str, value: f64| validate::within(&join(path, key), value, 0.0, 1.0);
    Ok(FilterDesc::Mitchell { b: within("b", b)?, c: within("c", c)? })
}

/// Checks the parameters of a filter.
pub(super) fn check(path: &str, filter: FilterDesc) -> Result<()> {
    match filter {
        FilterDesc::Gaussian { sigma } => gaussian(path, sigma.into()).map(|_| ()),
        FilterDesc::Mitchell { b, c } => mitchell(path, b.into(), c.into()).map(|_| ()),
        FilterDesc::Box | FilterDesc::Tent | FilterDesc::BlackmanHarris => Ok(()),
    }
}

/// Reads a filter, which is written as its name or as an object.
pub(super) fn read(raw: &RawValue, path: &str) -> Result<FilterDesc> {
    let (name, block) = json::named(raw, path, &FILTERS)?;
    match name.as_str() {
        "gaussian" => {
            let sigma = if block { json::object::<Gaussian>(raw, path)?.sigma } else { None }.unwrap_or(0.5);
            gaussian(path, sigma)
        }
        "mitchell" => {
            let (b, c) = if block {
                let given: Mitchell = json::object(raw, path)?;
                (given.b, given.c)
            } else {
                (None, None)
            };
            mitchell(path, b.unwrap_or(1.0 / 3.0), c.unwrap_or(1.0 / 3.0))
        }
        name => {
            if block {
                json::object::<Plain>(raw, path)?;
            }
            Ok(match name {
                "tent" => FilterDesc::Tent,
                "blackman-harris" => FilterDesc::BlackmanHarris,
                _ => FilterDesc::Box,
            })
        }
    }
}

/// Writes a filter, whose numbers have been checked.
pub(super) fn write(filter: FilterDesc) -> Result<Box<RawValue>> {
    match filter {
        FilterDesc::Box => save::raw(&"box"),
        FilterDesc::Tent => save::raw(&"tent"),
        FilterDesc::BlackmanHarris => save::raw(&"blackman-harris"),
        FilterDesc::Gaussian { sigma } => {
            save::raw(&Gaussian { _type: "gaussian".to_owned(), sigma: Some(single(sigma)) })
        }
        FilterDesc::Mitchell { b, c } => {
            let [b, c] = [b, c].map(|number| Some(single(number)));
            save::raw(&Mitchell { _type: "mitchell".to_owned(), b, c })
        }
    }
}
