//! The standard observer: from a spectrum to the colour that a sensor gets.
//!
//! Sources: CIE 018:2019; IEC 61966-2-1 (primaries of Rec. 709). `scripts/cie_tables.py` makes the table.

use std::sync::LazyLock;

use super::illuminant::Illuminant;
use crate::math::{DMat3, DVec3};

/// The wavelengths \[nm\] between which the standard observer sees anything.
pub const VISIBLE: [f64; 2] = [360.0, 830.0];

/// The colour matching functions by 1 nm, from 360 nm on: x, y and z.
const OBSERVER: &[[u8; 12]] = include_bytes!("tables/observer.f32").as_chunks().0;

/// The chromaticities of the primaries of Rec. 709 (CIE 1931 x and y): red, green, blue.
const PRIMARIES: [[f64; 2]; 3] = [[0.64, 0.33], [0.30, 0.60], [0.15, 0.06]];

/// Three little-endian numbers of a table.
pub(super) fn row(bytes: &[u8; 12]) -> DVec3 {
    let number = |i: usize| f64::from(f32::from_le_bytes([bytes[i], bytes[i + 1], bytes[i + 2], bytes[i + 3]]));
    DVec3::new(number(0), number(4), number(8))
}

/// The row of a table of regular steps at this place between its first row, 0, and its last, with what is between two rows linear;
/// 0 outside.
pub(super) fn between_rows(rows: &[[u8; 12]], place: f64) -> DVec3 {
    let last = rows.len() - 1;
    if !(0.0..=last as f64).contains(&place) {
        return DVec3::ZERO;
    }
    let lower = (place as usize).min(last - 1);
    row(&rows[lower]).lerp(row(&rows[lower + 1]), place - lower as f64)
}

/// The colour matching functions of CIE 1931 for 2 degrees at a wavelength \[nm\]: x, y and z; 0 outside of [`VISIBLE`].
///
/// The values are those of the CIE by 1 nm (DOI 10.25039/CIE.DS.xvudnb9b), linear in between.
pub fn color_matching(nanometres: f64) -> DVec3 {
    between_rows(OBSERVER, nanometres - VISIBLE[0])
}

/// The tristimulus values of a spectrum, which `spectrum` gives by the wavelength \[nm\]: the integral of the spectrum times the
/// [`color_matching`] functions over the wavelength, in the spectrum's unit times nm. 683 lm/W times the second is the
/// luminous quantity.
///
/// The integral is the sum by 1 nm, as the CIE defines it.
pub fn tristimulus(spectrum: impl Fn(f64) -> f64) -> DVec3 {
    let at = |(i, bytes): (usize, &[u8; 12])| row(bytes) * spectrum(VISIBLE[0] + i as f64);
    OBSERVER.iter().enumerate().map(at).sum()
}

/// The matrix from linear Rec. 709 to tristimulus values, whose white is illuminant D65 with Y = 1.
///
/// The white is that of the spectrum of D65 by the colour matching functions here, so that a white surface under D65 is (1, 1, 1)
/// without error. Its chromaticity (0.3127, 0.3290) is that of IEC 61966-2-1, and the luminance of a colour differs by
/// less than 2e-4 of it from [`super::luminance`], whose weights have four digits.
pub static XYZ_FROM_REC_709: LazyLock<DMat3> = LazyLock::new(|| {
    let white = tristimulus(|nanometres| Illuminant::D65.power(nanometres));
    let primaries = DMat3::from_cols_array_2d(&PRIMARIES.map(|[x, y]| [x / y, 1.0, (1.0 - x - y) / y]));
    primaries * DMat3::from_diagonal(primaries.inverse() * (white / white.y))
});

/// The inverse of [`XYZ_FROM_REC_709`].
pub static REC_709_FROM_XYZ: LazyLock<DMat3> = LazyLock::new(|| XYZ_FROM_REC_709.inverse());

/// The matrix of colours in linear Rec. 709 under light of this chromaticity (CIE 1931 x and y), to what they are under D65: a white surface
/// under that light becomes grey of the same luminance. `None` for what is no chromaticity of light.
///
/// Source: Lam 1985 (the Bradford transform), as von Kries 1902 scales the responses of the cones.
pub fn white_balance([x, y]: [f64; 2]) -> Option<DMat3> {
    // Columns of the matrix from tristimulus values to responses.
    let bradford =
        DMat3::from_cols_array_2d(&[[0.8951, -0.7502, 0.0389], [0.2664, 1.7135, -0.0685], [-0.1614, 0.0367, 1.0296]]);
    let is_chromaticity = x >= 0.0 && y > 1e-3 && x + y <= 1.0;
    let seen = bradford * DVec3::new(x / y, 1.0, (1.0 - x - y) / y);
    let wanted = bradford * (*XYZ_FROM_REC_709 * DVec3::ONE);
    (is_chromaticity && seen.min_element() > 1e-3).then(|| {
        let adapted = bradford.inverse() * DMat3::from_diagonal(wanted / seen) * bradford;
        *REC_709_FROM_XYZ * adapted * *XYZ_FROM_REC_709
    })
}

/// The linear Rec. 709 of a spectrum: [`tristimulus`] by [`REC_709_FROM_XYZ`]. Colours outside of the triangle of the primaries have
/// negative channels.
pub fn rec_709(spectrum: impl Fn(f64) -> f64) -> DVec3 {
    *REC_709_FROM_XYZ * tristimulus(spectrum)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::spectrum::LUMINANCE_WEIGHTS;

    /// The integrals of the functions by 1 nm that the CIE states: equal to each other, as an equal-energy spectrum is white.
    #[test]
    fn an_equal_energy_spectrum_is_its_own_white() {
        let sum = tristimulus(|_| 1.0);
        for (value, expected) in sum.to_array().into_iter().zip([106.865_5, 106.856_9, 106.892_1]) {
            assert!((value - expected).abs() < 2e-3, "{sum}");
        }
        assert_eq!(color_matching(359.9), DVec3::ZERO);
        assert_eq!(color_matching(830.1), DVec3::ZERO);
        assert_eq!(color_matching(f64::NAN), DVec3::ZERO);
        assert!((color_matching(555.0).y - 1.0).abs() < 1e-6);
        assert!((color_matching(445.5) - (color_matching(445.0) + color_matching(446.0)) / 2.0).length() < 1e-12);
    }

    #[test]
    fn balanced_white_is_grey_of_the_same_luminance() {
        for illuminant in [Illuminant::E, Illuminant::A, Illuminant::D50, Illuminant::D65] {
            let xyz = tristimulus(|nanometres| illuminant.power(nanometres));
            let sum = xyz.element_sum();
            let matrix = white_balance([xyz.x / sum, xyz.y / sum]).unwrap();
            let white = matrix * (*REC_709_FROM_XYZ * xyz / xyz.y);
            assert!((white - DVec3::ONE).abs().max_element() < 1e-12, "{illuminant:?}: {white}");
        }
        let unchanged = white_balance([0.312_72, 0.329_03]).unwrap() - DMat3::IDENTITY;
        assert!(unchanged.to_cols_array().iter().all(|it| it.abs() < 1e-4), "{unchanged}");
        // From A to D65 by the matrix that is published (Lindbloom, Bradford), in tristimulus values.
        let known = DMat3::from_cols_array_2d(&[
            [0.844_696_5, -0.136_630_3, 0.079_848_9],
            [-0.117_922_5, 1.104_122_6, -0.134_899_9],
            [0.394_810_8, 0.129_171_8, 3.192_358_0],
        ]);
        let xyz = DVec3::new(1.0985, 1.0, 0.355_85);
        let sum = xyz.element_sum();
        let matrix = white_balance([xyz.x / sum, xyz.y / sum]).unwrap();
        let found = *XYZ_FROM_REC_709 * matrix * *REC_709_FROM_XYZ - known;
        assert!(found.to_cols_array().iter().all(|it| it.abs() < 2e-3), "{found}");
        for none in [[0.3, 0.0], [-0.1, 0.3], [0.6, 0.5], [f64::NAN, 0.3], [0.3, f64::INFINITY]] {
            assert!(white_balance(none).is_none(), "{none:?}");
        }
    }

    #[test]
    fn white_is_d65_and_luminance_is_y() {
        let white = rec_709(|nanometres| Illuminant::D65.power(nanometres));
        assert!((white / white.y - DVec3::ONE).abs().max_element() < 1e-12, "{white}");
        let y = XYZ_FROM_REC_709.row(1);
        assert!((y - LUMINANCE_WEIGHTS.to_f64()).abs().max_element() < 2e-4, "{y}");
        // The matrix of IEC 61966-2-1, which is rounded to four digits.
        let standard =
            DMat3::from_cols_array_2d(&[[0.4124, 0.2126, 0.0193], [0.3576, 0.7152, 0.1192], [0.1805, 0.0722, 0.9505]]);
        let difference = *XYZ_FROM_REC_709 - standard;
        assert!(difference.to_cols_array().iter().all(|difference| difference.abs() < 4e-4), "{difference}");
    }
}
