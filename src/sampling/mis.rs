//! Weights for combining two sampling techniques.
//!
//! Both heuristics take the density of the technique that drew the sample and that of the other one for the same
//! sample, times the numbers of samples if those differ. They are robust at the ends: a technique with density 0 weighs
//! nothing, an infinite (or delta-like) density outweighs any finite one, and the weights of a pair sum to 1.
//!
//! Source: Veach 1997, *Robust Monte Carlo Methods for Light Transport Simulation*, Sec. 9.2.

/// The other density over this one, with a defined value for indeterminate quotients; `None` where this one is 0.
#[inline]
fn ratio(pdf: f32, other_pdf: f32) -> Option<f32> {
    if pdf > 0.0 {
        // Equal also means infinity over infinity.
        Some(if pdf == other_pdf { 1.0 } else { other_pdf / pdf })
    } else {
        None
    }
}

/// Balance heuristic: pdf / (pdf + other_pdf), in [0, 1].
#[inline]
pub fn balance_heuristic(pdf: f32, other_pdf: f32) -> f32 {
    ratio(pdf, other_pdf).map_or(0.0, |r| 1.0 / (1.0 + r))
}

/// Power heuristic with exponent 2: pdf^2 / (pdf^2 + other_pdf^2), in [0, 1]. Squares the ratio, not the densities,
/// which would overflow for small lights.
#[inline]
pub fn power_heuristic(pdf: f32, other_pdf: f32) -> f32 {
    ratio(pdf, other_pdf).map_or(0.0, |r| 1.0 / (1.0 + r * r))
}
