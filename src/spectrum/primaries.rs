//! Colour spaces of images other than linear Rec. 709.

use super::observer::{REC_709_FROM_XYZ, XYZ_FROM_REC_709, white_balance};
use crate::math::{DMat3, DVec3};

/// The primaries of linear colours in a file.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Primaries {
    /// Rec. 709 (IEC 61966-2-1), white D65: what all else in the library has.
    #[default]
    Rec709,
    /// Rec. 2020 (ITU-R BT.2020), white D65.
    Rec2020,
    /// ACEScg, the primaries AP1 (S-2014-004), to whose white colours are adapted from D65 by the Bradford transform.
    AcesCg,
    /// Tristimulus values of CIE 1931, not adapted: Y is the luminance.
    Xyz,
}

impl Primaries {
    /// All of them, with their names.
    pub const ALL: [(&'static str, Self); 4] =
        [("rec709", Self::Rec709), ("rec2020", Self::Rec2020), ("acescg", Self::AcesCg), ("xyz", Self::Xyz)];

    /// The chromaticities (CIE 1931 x and y) of red, green, blue and white, as files state them.
    pub fn chromaticities(self) -> [[f32; 2]; 4] {
        const D65: [f32; 2] = [0.3127, 0.3290];
        match self {
            Self::Rec709 => [[0.64, 0.33], [0.30, 0.60], [0.15, 0.06], D65],
            Self::Rec2020 => [[0.708, 0.292], [0.170, 0.797], [0.131, 0.046], D65],
            Self::AcesCg => [[0.713, 0.293], [0.165, 0.830], [0.128, 0.044], [0.321_68, 0.337_67]],
            Self::Xyz => [[1.0, 0.0], [0.0, 1.0], [0.0, 0.0], [1.0 / 3.0, 1.0 / 3.0]],
        }
    }

    /// The matrix from linear Rec. 709. White stays (1, 1, 1), but for tristimulus values.
    pub fn from_rec_709(self) -> DMat3 {
        let [red, green, blue, white] = self.chromaticities().map(|pair| pair.map(f64::from));
        let tristimulus = |[x, y]: [f64; 2]| DVec3::new(x, y, 1.0 - x - y);
        match self {
            Self::Rec709 => DMat3::IDENTITY,
            Self::Xyz => *XYZ_FROM_REC_709,
            Self::Rec2020 | Self::AcesCg => {
                // Rec. 709's white is D65 itself, of which the stated chromaticity is rounded.
                let (adapted, white) = if self == Self::AcesCg {
                    let back = white_balance(white).map_or(DMat3::IDENTITY, |to_d65| to_d65.inverse());
                    (back, tristimulus(white) / white[1])
                } else {
                    (DMat3::IDENTITY, *XYZ_FROM_REC_709 * DVec3::ONE)
                };
                let primaries = DMat3::from_cols(tristimulus(red), tristimulus(green), tristimulus(blue));
                let to_xyz = primaries * DMat3::from_diagonal(primaries.inverse() * white);
                to_xyz.inverse() * (*XYZ_FROM_REC_709 * adapted * *REC_709_FROM_XYZ) * *XYZ_FROM_REC_709
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The matrices of ITU-R BT.2087 and of ACES (Rec. 709 to AP1 by Bradford).
    #[test]
    fn matrices_are_those_that_are_published() {
        let known = [
            (Primaries::Rec2020, [[0.6274, 0.3293, 0.0433], [0.0691, 0.9195, 0.0114], [0.0164, 0.0880, 0.8956]]),
            (Primaries::AcesCg, [[0.6131, 0.3395, 0.0474], [0.0702, 0.9164, 0.0134], [0.0206, 0.1096, 0.8698]]),
        ];
        for (primaries, rows) in known {
            let difference = primaries.from_rec_709() - DMat3::from_cols_array_2d(&rows).transpose();
            assert!(difference.to_cols_array().iter().all(|it| it.abs() < 3e-4), "{primaries:?}: {difference}");
            let white = primaries.from_rec_709() * DVec3::ONE;
            assert!((white - DVec3::ONE).abs().max_element() < 1e-6, "{primaries:?}: {white}");
        }
        let xyz = Primaries::Xyz.from_rec_709() * DVec3::ONE;
        assert!((xyz - DVec3::new(0.9505, 1.0, 1.0890)).abs().max_element() < 5e-4, "{xyz}");
    }
}
