//! Colours of glowing bodies: the chromaticity of a Planckian radiator, in Rec. 709.

use crate::math::DVec3;
use crate::spectrum::LUMINANCE_WEIGHTS;

/// The temperatures for which [`planckian`] knows the colour, kelvin.
pub const TEMPERATURES: [f64; 2] = [1000.0, 15_000.0];

/// The colour of a Planckian radiator of this temperature \[K\]: linear Rec. 709 of luminance 1; `None` outside of [`TEMPERATURES`].
///
/// The chromaticity is off by less than 2e-4 in u and in v of CIE 1960 from 2,000 K on, a fifth of what an eye tells apart. Below about
/// 1,900 K the chromaticity lies outside of Rec. 709: blue is 0 then, and the colour less saturated than it should be. Lamps that
/// are no Planckian radiators, such as fluorescent ones, have other chromaticities than one of their correlated temperature.
///
/// Source: Krystek 1985, "An algorithm to calculate correlated colour temperature".
pub fn planckian(temperature: f64) -> Option<DVec3> {
    let [low, high] = TEMPERATURES;
    if !(low..=high).contains(&temperature) {
        return None;
    }
    let t = temperature;
    let u = (0.860_117_757 + 1.541_182_54e-4 * t + 1.286_412_12e-7 * t * t)
        / (1.0 + 8.424_202_35e-4 * t + 7.081_451_63e-7 * t * t);
    let v = (0.317_398_726 + 4.228_062_45e-5 * t + 4.204_816_91e-8 * t * t)
        / (1.0 - 2.897_418_16e-5 * t + 1.614_560_53e-7 * t * t);
    let scale = 2.0 * u - 8.0 * v + 4.0;
    of_luminance_one(rec709(3.0 * u / scale, 2.0 * v / scale).max(DVec3::ZERO))
}

/// A colour scaled to luminance 1; `None` for one without luminance.
pub fn of_luminance_one(color: DVec3) -> Option<DVec3> {
    let luminance = color.dot(LUMINANCE_WEIGHTS.to_f64());
    (luminance > 0.0).then(|| color / luminance)
}

/// The linear Rec. 709 of a chromaticity of CIE 1931, at Y = 1 (IEC 61966-2-1).
fn rec709(x: f64, y: f64) -> DVec3 {
    let xyz = DVec3::new(x / y, 1.0, (1.0 - x - y) / y);
    DVec3::new(
        DVec3::new(3.240_454_2, -1.537_138_5, -0.498_531_4).dot(xyz),
        DVec3::new(-0.969_266_0, 1.876_010_8, 0.041_556_0).dot(xyz),
        DVec3::new(0.055_643_4, -0.204_025_9, 1.057_225_2).dot(xyz),
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn colours_have_luminance_one_and_grow_bluer() {
        let mut former = f64::INFINITY;
        for kelvin in (1000..=15_000).step_by(100) {
            let color = planckian(f64::from(kelvin)).unwrap();
            assert!((color.dot(LUMINANCE_WEIGHTS.to_f64()) - 1.0).abs() < 1e-12 && color.min_element() >= 0.0);
            let ratio = color.x / color.z;
            assert!(ratio < former || (ratio.is_infinite() && kelvin < 1950), "{kelvin}: {ratio}");
            former = ratio;
        }
        assert_eq!(planckian(6504.0).map(|color| (color - DVec3::ONE).abs().max_element() < 0.06), Some(true));
        for outside in [999.9, 15_000.1, -1.0, 0.0, f64::NAN, f64::INFINITY] {
            assert_eq!(planckian(outside), None);
        }
        assert_eq!(of_luminance_one(DVec3::ZERO), None);
    }
}
