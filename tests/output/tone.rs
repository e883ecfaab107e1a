//! Brightness follows the published curves, never decreases, and is a number whatever the radiance.

use std::fs;

use etendue::ErrorKind;
use etendue::output::{self, ToneMap, WriteOptions};
use etendue::spectrum::srgb_encode;

use super::{codes, folder, grey};

#[test]
fn png_never_holds_what_is_not_a_number() {
    let values = [f32::NAN, -f32::NAN, f32::NEG_INFINITY, -1.0, -0.0, f32::INFINITY, f32::MAX];
    let expected = [0, 0, 0, 0, 0, 255, 255];
    for tone_map in [ToneMap::Maximum, ToneMap::Clamp, ToneMap::Reinhard, ToneMap::Aces] {
        assert_eq!(codes(tone_map, 0.0, &values), expected, "{tone_map:?}");
        for exposure in [-64.0, 64.0] {
            assert_eq!(codes(tone_map, exposure, &[f32::NAN, f32::INFINITY]), [0, 255], "{tone_map:?}");
        }
    }
    // An image without any light has no maximum to divide by.
    assert_eq!(codes(ToneMap::Maximum, 0.0, &[0.0, -1.0, f32::NAN]), [0, 0, 0]);
}

#[test]
fn srgb_curve_has_the_published_values() {
    // 1.055 x^(1/2.4) - 0.055, evaluated with 12 digits. Two units in the last place of single precision near 0.5.
    for (linear, encoded) in [(0.18, 0.461_356_129_500), (0.5, 0.735_356_983_052)] {
        assert!((f64::from(srgb_encode(linear)) - encoded).abs() < 1.2e-7, "{linear}");
    }
    assert_eq!(codes(ToneMap::Clamp, 0.0, &[0.0, 0.18, 0.5, 1.0, 1.5]), [0, 118, 188, 255, 255]);
    // One stop doubles.
    assert_eq!(codes(ToneMap::Clamp, 1.0, &[0.09, 0.25, 0.5]), [118, 188, 255]);
    assert_eq!(codes(ToneMap::Clamp, -1.0, &[0.36, 1.0, 2.0]), [118, 188, 255]);
}

#[test]
fn tone_curves_have_their_published_values() {
    assert_eq!(ToneMap::Reinhard.curve(1.0), 0.5);
    assert_eq!(ToneMap::Reinhard.curve(3.0), 0.75);
    assert_eq!(codes(ToneMap::Reinhard, 0.0, &[1.0, 1e30]), [188, 255]);
    // (2.51 + 0.03) / (2.43 + 0.59 + 0.14), and 0.18 (0.4518 + 0.03) / (0.18 (0.4374 + 0.59) + 0.14).
    assert!((ToneMap::Aces.curve(1.0) - 2.54 / 3.16).abs() < 1e-15);
    assert!((ToneMap::Aces.curve(0.18) - 0.086_724 / 0.324_932).abs() < 1e-15);
    assert_eq!(ToneMap::Aces.curve(100.0), 1.0);
    for tone_map in [ToneMap::Clamp, ToneMap::Maximum] {
        assert_eq!(tone_map.curve(0.25), 0.25);
        assert_eq!(tone_map.curve(1.25), 1.0);
    }
    // The largest finite value is white, half of it is linear 0.5; exposure acts after the division.
    assert_eq!(codes(ToneMap::Maximum, 0.0, &[40.0, 20.0, 7.2, f32::INFINITY]), [255, 188, 118, 255]);
    assert_eq!(codes(ToneMap::Maximum, -1.0, &[40.0, 14.4]), [188, 118]);
    assert_eq!(codes(ToneMap::Maximum, 0.0, &[1e-45, 0.0]), [255, 0]);
}

#[test]
fn brightness_never_decreases() {
    // All non-negative floats in steps that are coprime to their spacing, and every float around each change of code.
    for tone_map in [ToneMap::Maximum, ToneMap::Clamp, ToneMap::Reinhard, ToneMap::Aces] {
        for exposure in [0.0, -3.3] {
            let infinity = f32::INFINITY.to_bits();
            let sparse: Vec<f32> = (0..=infinity).step_by(4093).chain([infinity]).map(f32::from_bits).collect();
            let found = codes(tone_map, exposure, &sparse);
            assert!(found.is_sorted(), "{tone_map:?}");
            assert_eq!((found[0], found[found.len() - 1]), (0, 255));
            if tone_map == ToneMap::Maximum {
                continue; // its scale is that of the largest value in each image: the same curve as Clamp
            }
            let changes = found.windows(2).zip(&sparse).filter(|(pair, _)| pair[0] != pair[1]);
            for (_, from) in changes {
                let around = from.to_bits()..from.to_bits() + 4093;
                let dense: Vec<f32> = around.map(f32::from_bits).collect();
                assert!(codes(tone_map, exposure, &dense).is_sorted(), "{tone_map:?} near {from}");
            }
        }
    }
}

#[test]
fn exposure_is_checked() {
    let folder = folder();
    for exposure in [f32::NAN, f32::INFINITY, 65.0, -65.0] {
        let options = WriteOptions { exposure, ..WriteOptions::default() };
        let error = output::write(&grey(&[1.0]), &folder.path().join("image.png"), &options).unwrap_err();
        assert_eq!(error.kind(), ErrorKind::InvalidScene, "{exposure}");
    }
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 0);
}
