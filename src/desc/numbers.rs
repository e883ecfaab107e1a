//! Numbers of a description as a scene file has them: with few digits, which are read back as the same bits.

use crate::spectrum::Rgb;

/// A number of single precision, with the fewest digits that are read back as it.
pub(super) fn single(value: f32) -> f64 {
    let exact = f64::from(value);
    let short = value.to_string().parse().unwrap_or(exact);
    // The shortest digits of the largest numbers are beyond them, which readers refuse.
    let fits = short.abs() <= f64::from(f32::MAX) && (short as f32).to_bits() == value.to_bits();
    if fits { short } else { exact }
}

/// The channels of a colour.
pub(super) fn color(value: Rgb) -> [f64; 3] {
    value.to_array().map(single)
}

/// The value of a key that may be left out; `None` for its default.
pub(super) fn unless(value: f64, default: f64) -> Option<f64> {
    (value.to_bits() != default.to_bits()).then_some(value)
}

/// The same for a colour.
pub(super) fn unless_color(value: Rgb, default: Rgb) -> Option<[f64; 3]> {
    let bits = |color: Rgb| color.to_array().map(f32::to_bits);
    (bits(value) != bits(default)).then(|| color(value))
}

/// The degrees that are read as an angle in radians of single precision.
pub(super) fn degrees(radians: f32) -> f64 {
    let exact = f64::from(radians).to_degrees();
    // Double precision is so much finer that there always are some.
    shortest(exact, |degrees| (degrees.to_radians() as f32).to_bits() == radians.to_bits()).unwrap_or(exact)
}

/// The number of the fewest digits near `exact` that is accepted.
pub(super) fn shortest(exact: f64, accepts: impl Fn(f64) -> bool) -> Option<f64> {
    let rounded = (0..17).filter_map(|digits| format!("{exact:.digits$e}").parse().ok());
    let neighbours = [exact, exact.next_up(), exact.next_down()];
    rounded.chain(neighbours).find(|number| accepts(*number))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_of_single_precision_come_back() {
        assert_eq!(single(0.8).to_string(), "0.8");
        assert_eq!(single(1e-3).to_string(), "0.001");
        let mut bits = 1_u32;
        for _ in 0..100_000 {
            bits = bits.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            let value = f32::from_bits(bits);
            if value.is_finite() {
                let text = serde_json::to_string(&single(value)).unwrap();
                let read: f64 = serde_json::from_str(&text).unwrap();
                assert_eq!((read as f32).to_bits(), bits, "{value:e} is written as {text}");
            }
        }
        for value in [f32::MAX, f32::MIN, f32::MIN_POSITIVE, f32::from_bits(1), 0.0, -0.0] {
            let read: f64 = serde_json::from_str(&serde_json::to_string(&single(value)).unwrap()).unwrap();
            assert_eq!((read as f32).to_bits(), value.to_bits(), "{value:e}");
            assert!(read.abs() <= f64::from(f32::MAX), "{value:e}");
        }
    }

    #[test]
    fn angles_come_back() {
        use std::f32::consts::{FRAC_PI_2, TAU};
        assert_eq!([degrees(TAU), degrees(FRAC_PI_2), degrees(30.0_f64.to_radians() as f32)], [360.0, 90.0, 30.0]);
        let mut bits = 1_u32;
        for _ in 0..100_000 {
            bits = bits.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            let radians = (f64::from(bits) / f64::from(u32::MAX) * 12.0 - 6.0) as f32;
            assert_eq!((degrees(radians).to_radians() as f32).to_bits(), radians.to_bits(), "{radians}");
        }
    }
}
