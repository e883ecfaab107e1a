//! Beckmann's facets: Smith's function, and visible normals by inverting their distribution numerically.

use std::f64::consts::FRAC_2_SQRT_PI;

use crate::math::Vec3;

/// Smith's function Lambda from alpha^2 tan^2. Heitz 2014, Eq. 68.
#[inline]
pub(super) fn lambda(slope2: f32) -> f32 {
    // Below this slope the function is less than 1e-9.
    if slope2 < 0.07 {
        return 0.0;
    }
    let a = 1.0 / f64::from(slope2).sqrt();
    let tail = 0.5 * FRAC_2_SQRT_PI * (-a * a).exp() / a;
    (0.5 * (tail - libm::erfc(a))) as f32
}

/// Draws a visible normal. `wo` is in the facets' frame.
///
/// In the stretched frame both widths are 1, and the slope along `wo` has the distribution function
/// P(s) = (1 + erf(s) + tan exp(-s^2) / sqrt(pi)) / N up to s = 1 / tan, which has no inverse in closed form.
///
/// Source: Jakob 2014, "An Improved Visible Normal Sampling Routine for the Beckmann Distribution".
pub(super) fn visible_normal([ax, ay]: [f32; 2], wo: Vec3, u: [f32; 2]) -> Vec3 {
    let stretched = Vec3::new(ax * wo.x, ay * wo.y, wo.z).normalize();
    let tangential = f64::from(stretched.x).hypot(f64::from(stretched.y));
    let along = slope_along(f64::from(stretched.z), tangential, f64::from(u[0]));
    let across = erf_inv(2.0 * f64::from(u[1]).max(1e-9) - 1.0);
    let (cos, sin) = if tangential > 0.0 {
        (f64::from(stretched.x) / tangential, f64::from(stretched.y) / tangential)
    } else {
        (1.0, 0.0)
    };
    let slope = [cos * along - sin * across, sin * along + cos * across];
    Vec3::new(-ax * slope[0] as f32, -ay * slope[1] as f32, 1.0).normalize()
}

/// The slope at which the share `u` of the visible facets is less steep, for facets of width 1 seen at an angle with this
/// cosine and sine. Facets of negative slope lean towards the viewer.
fn slope_along(cos: f64, sin: f64, u: f64) -> f64 {
    // Seen from above, slopes have a normal distribution.
    if sin < 1e-6 {
        return erf_inv(2.0 * u.max(1e-12) - 1.0);
    }
    let (tan, cot) = (sin / cos, cos / sin);
    let root = 0.5 * FRAC_2_SQRT_PI;
    let weight = |erf: f64, slope: f64| 1.0 + erf + root * tan * (-slope * slope).exp();
    let end = libm::erf(cot);
    let whole = weight(end, cot);
    // The search is over erf(slope), of which the function is nearly linear: Newton's steps, kept inside an interval.
    let (mut low, mut high) = (-1.0, end);
    let mut erf = low + (high - low) * u;
    for _ in 0..24 {
        let slope = erf_inv(erf);
        let off = weight(erf, slope) - u * whole;
        if off.abs() < 1e-10 * whole {
            break;
        }
        if off > 0.0 {
            high = erf
        } else {
            low = erf
        }
        let step = erf - off / (1.0 - slope * tan);
        erf = if step > low && step < high { step } else { 0.5 * (low + high) };
    }
    erf_inv(erf)
}

/// The inverse of the error function for |x| < 1; beyond that, its value next to the end.
///
/// Source: Giles 2010, "Approximating the erfinv Function", in single precision; a Newton step makes it double.
fn erf_inv(x: f64) -> f64 {
    let x = x.clamp(-1.0 + 1e-15, 1.0 - 1e-15);
    let w = -((1.0 - x) * (1.0 + x)).ln();
    let polynomial = |coefficients: [f64; 9], w: f64| coefficients.into_iter().fold(0.0, |sum, c| sum * w + c);
    let guess = x * if w < 5.0 {
        let central = [
            2.810_226_36e-8,
            3.432_739_39e-7,
            -3.523_387_7e-6,
            -4.391_506_54e-6,
            0.000_218_580_87,
            -0.001_253_725_03,
            -0.004_177_681_64,
            0.246_640_727,
            1.501_409_41,
        ];
        polynomial(central, w - 2.5)
    } else {
        let tail = [
            -0.000_200_214_257,
            0.000_100_950_558,
            0.001_349_343_22,
            -0.003_673_428_44,
            0.005_739_507_73,
            -0.007_622_461_3,
            0.009_438_870_47,
            1.001_674_06,
            2.832_976_82,
        ];
        polynomial(tail, w.sqrt() - 3.0)
    };
    // Beyond what single precision can hold, the fit is a first guess only.
    let steps = if w < 14.0 { 1 } else { 4 };
    (0..steps).fold(guess, |guess, _| {
        // In the tails erf is 1 to all digits; erfc keeps the difference.
        let off =
            if x.abs() < 0.5 { libm::erf(guess) - x } else { x.signum() * ((1.0 - x.abs()) - libm::erfc(guess.abs())) };
        guess - off / (FRAC_2_SQRT_PI * (-guess * guess).exp())
    })
}

#[cfg(test)]
mod tests {
    use std::f64::consts::PI;

    use super::*;

    #[test]
    fn the_inverse_of_the_error_function_is_one() {
        for i in -999..1000 {
            let x = f64::from(i) / 1000.0;
            assert!((libm::erf(erf_inv(x)) - x).abs() < 1e-12, "{x}");
        }
        for tail in [1e-4, 1e-8, 1e-12] {
            assert!((libm::erfc(erf_inv(1.0 - tail)) / tail - 1.0).abs() < 1e-3, "{tail}");
        }
    }

    #[test]
    fn slopes_have_the_distribution_of_visible_facets() {
        for degrees in [0.0_f64, 1e-5, 10.0, 45.0, 80.0, 89.0, 89.99] {
            let (sin, cos) = degrees.to_radians().sin_cos();
            for i in 0..200 {
                let u = (f64::from(i) + 0.5) / 200.0;
                let slope = slope_along(cos, sin, u);
                let (tan, cot) = (sin / cos, cos / sin);
                let up_to = |s: f64| 1.0 + libm::erf(s) + tan * (-s * s).exp() / PI.sqrt();
                let found = up_to(slope) / up_to(cot);
                assert!((found - u).abs() < 1e-6, "{degrees} degrees: {found} and not {u}");
            }
        }
    }
}
