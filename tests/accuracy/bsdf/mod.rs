//! Scattering models against closed forms and quadratures of them.

mod albedo;
mod fresnel;
mod glass;
pub mod inverses;
mod rough;
mod samplers;
mod values;

use crate::common::bsdfs::{diffuse_models, direction, lambert, oren_nayar, oren_nayar_qualitative, uniform_3d};
use crate::record::{Case, Entry, Within};

pub fn cases() -> Vec<Entry> {
    let topics =
        [values::cases(), albedo::cases(), fresnel::cases(), samplers::cases(), glass::cases(), rough::cases()];
    topics.into_iter().flatten().collect()
}

/// The worst of several comparisons, relative to what was expected.
#[derive(Clone, Copy, Debug, Default)]
struct Worst {
    /// (got, expected, relative error)
    worst: Option<(f64, f64, f64)>,
}

impl Worst {
    fn add(&mut self, got: f64, expected: f64) {
        let off = (got - expected).abs() / expected.abs();
        // What is not a number is worse than anything.
        if self.worst.is_none_or(|(.., worst)| off > worst || off.is_nan()) {
            self.worst = Some((got, expected, off));
        }
    }

    fn row(self, case: &mut Case, what: impl Into<String>, relative: f64) {
        let (got, expected, _) = self.worst.expect("something was compared");
        case.exact(what, got, expected, Within::Relative(relative));
    }
}
