//! The colours of black bodies, by the temperature and back.

use std::sync::LazyLock;

use super::curve::SpectralCurve;
use super::illuminant::black_body;
use super::{LUMINANCE_WEIGHTS, Rgb};
use crate::math::DVec3;

/// The temperatures \[K\] of black bodies: below, nothing is seen of them, and above, the chromaticity does not change any more.
pub const BLACK_BODY_TEMPERATURES: [f64; 2] = [500.0, 1e6];

/// Number of temperatures of the table, at equal distances of the logarithm: between them the logarithm of the luminance is linear
/// but for 1e-4.
const COUNT: usize = 2048;

/// What is known of one temperature.
struct Known {
    /// Logarithm of the luminance over 683 lm/W.
    level: f64,
    /// Colour of luminance 1 without negative channels.
    color: DVec3,
}

static TABLE: LazyLock<Vec<Known>> = LazyLock::new(|| {
    let known = |i: usize| {
        let curve = SpectralCurve::of(|nanometres| black_body(temperature(i as f64), nanometres));
        let mut color = curve.light_color().max(DVec3::ZERO);
        // Below about 960 K black bodies lie outside of Rec. 709 and have no green. They get a hundred thousandth of their red, so that
        // green over red grows with the temperature there too.
        color.y = color.y.max(1e-8 * temperature(i as f64) * color.x);
        Known { level: curve.luminance().ln(), color: color / color.dot(LUMINANCE_WEIGHTS.to_f64()) }
    };
    (0..COUNT).map(known).collect()
});

/// The temperature \[K\] at a place of the table.
fn temperature(place: f64) -> f64 {
    let [low, high] = BLACK_BODY_TEMPERATURES;
    low * (place / (COUNT - 1) as f64 * (high / low).ln()).exp()
}

/// The entries below and above a temperature, and how far it is between them.
fn around(kelvin: f64) -> ([&'static Known; 2], f64) {
    let [low, high] = BLACK_BODY_TEMPERATURES;
    let place = (kelvin / low).ln() / (high / low).ln() * (COUNT - 1) as f64;
    let lower = (place.max(0.0) as usize).min(COUNT - 2);
    ([&TABLE[lower], &TABLE[lower + 1]], (place - lower as f64).clamp(0.0, 1.0))
}

/// The luminance of a black body over 683 lm/W \[W m^-2 sr^-1\]; that of the nearest temperature outside of
/// [`BLACK_BODY_TEMPERATURES`].
pub fn black_body_luminance(kelvin: f64) -> f64 {
    let ([before, after], way) = around(kelvin);
    (before.level + (after.level - before.level) * way).exp()
}

/// The radiance of a black body in linear Rec. 709, without negative channels, relative to that of luminance 1 over 683 lm/W; nothing
/// below the temperatures of [`BLACK_BODY_TEMPERATURES`].
pub fn black_body_color(kelvin: f64) -> DVec3 {
    if kelvin.is_nan() || kelvin < BLACK_BODY_TEMPERATURES[0] {
        return DVec3::ZERO;
    }
    let ([before, after], way) = around(kelvin);
    before.color.lerp(after.color, way) * black_body_luminance(kelvin)
}

/// The temperature \[K\] of the black body that has a colour, by its green over its red.
pub fn black_body_temperature(color: Rgb) -> f64 {
    let [red, green, _] = color.to_array().map(f64::from);
    let ratio = |known: &Known| known.color.y / known.color.x;
    let wanted = green / red;
    let above = TABLE.partition_point(|known| ratio(known) <= wanted).clamp(1, COUNT - 1);
    let [before, after] = [above - 1, above].map(|i| ratio(&TABLE[i]));
    let way = if after > before { ((wanted - before) / (after - before)).clamp(0.0, 1.0) } else { 0.0 };
    temperature((above - 1) as f64 + way)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn temperatures_are_found_by_their_colours() {
        for kelvin in [510.0, 602.0, 803.0, 1000.0, 1200.0, 1850.0, 2700.0, 4321.0, 6500.0, 12_000.0, 40_000.0] {
            let color = Rgb::from_f64(black_body_color(kelvin) / black_body_luminance(kelvin));
            let found = black_body_temperature(color * 3.0);
            assert!((found / kelvin - 1.0).abs() < 1e-4, "{kelvin}: {found}");
            let other = black_body_color(1.02 * kelvin) / black_body_luminance(1.02 * kelvin);
            assert!((black_body_temperature(Rgb::from_f64(other)) / kelvin - 1.0).abs() > 1e-2);
        }
        assert_eq!(black_body_color(499.0), DVec3::ZERO);
        assert_eq!(black_body_color(f64::NAN), DVec3::ZERO);
    }

    /// Between the temperatures of the table, colours are those of the spectra.
    #[test]
    fn colours_are_those_of_the_spectra() {
        for kelvin in [501.0, 777.0, 1501.0, 3003.0, 6100.0, 98_765.0, 1e6] {
            let curve = SpectralCurve::of(|nanometres| black_body(kelvin, nanometres));
            let exact = curve.luminance();
            assert!((black_body_luminance(kelvin) / exact - 1.0).abs() < 1.5e-4, "{kelvin}");
            let color = curve.light_color().max(DVec3::ZERO);
            let color = color * (exact / color.dot(LUMINANCE_WEIGHTS.to_f64()));
            let off = (black_body_color(kelvin) - color).abs().max_element() / color.max_element();
            assert!(off < 2e-4, "{kelvin}: {off}");
        }
    }
}
