//! The metrics agree with values computed by hand, and say what they leave out.

use etendue::ErrorKind;
use etendue::film::Image;
use etendue::output;

use super::grey;

#[test]
fn metrics_agree_with_values_computed_by_hand() {
    let image = |rgb: [f32; 6]| Image { width: 1, height: 2, rgb: rgb.to_vec(), ..Image::default() };
    let a = image([1.0, 2.0, 3.0, 4.0, 5.0, 6.0]);
    let b = image([1.0, 1.0, 3.0, 4.0, 2.0, 8.0]);
    let metrics = output::compare(&a, &b).unwrap();
    // Squares of the differences 0, 1, 0, 0, 3, -2.
    assert!((metrics.mse - 14.0 / 6.0).abs() < 1e-15);
    assert!((metrics.rel_mse - (1.0 / 1.01 + 9.0 / 4.01 + 4.0 / 64.01) / 6.0).abs() < 1e-15);
    assert!((metrics.psnr - 10.0 * (64.0_f64 * 6.0 / 14.0).log10()).abs() < 1e-13);
    assert_eq!((metrics.max_abs_difference, metrics.max_at), (3.0, [0, 1]));
    assert_eq!(metrics.mean_a, [2.5, 3.5, 4.5]);
    assert_eq!(metrics.mean_b, [2.5, 1.5, 5.5]);
    assert_eq!(metrics.ratio, [1.0, 3.5 / 1.5, 4.5 / 5.5]);
    assert_eq!(metrics.non_finite, 0);

    // The reference is the second.
    let swapped = output::compare(&b, &a).unwrap();
    assert_eq!(swapped.mse, metrics.mse);
    assert!((swapped.rel_mse - (1.0 / 4.01 + 9.0 / 25.01 + 4.0 / 36.01) / 6.0).abs() < 1e-15);
}

#[test]
fn metrics_of_equal_and_of_broken_images() {
    let a = grey(&[0.5, 1.0]);
    let same = output::compare(&a, &a).unwrap();
    assert_eq!((same.mse, same.rel_mse, same.max_abs_difference, same.max_at), (0.0, 0.0, 0.0, [0, 0]));
    assert_eq!((same.psnr, same.ratio), (f64::INFINITY, [1.0; 3]));

    // A pixel that is broken in either image counts in neither.
    let metrics = output::compare(&grey(&[0.5, f32::NAN, 2.0]), &grey(&[1.0, 1.0, f32::INFINITY])).unwrap();
    assert_eq!((metrics.non_finite, metrics.mse, metrics.mean_b), (2, 0.25, [1.0; 3]));
    let nothing = output::compare(&grey(&[f32::NAN]), &grey(&[1.0])).unwrap();
    assert!(nothing.mse.is_nan() && nothing.psnr.is_nan() && nothing.max_abs_difference.is_nan());

    let error = output::compare(&grey(&[1.0; 3]), &grey(&[1.0; 2])).unwrap_err();
    assert_eq!(error.kind(), ErrorKind::InvalidScene);
    assert!(error.to_string().contains("3 x 1 and 2 x 1"), "{error}");
}
