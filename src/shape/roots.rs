//! Real roots of a quadratic without cancellation.

use super::ray::DRay;

/// The real roots of a t^2 + 2 b t + c = 0 in ascending order, or `None` where there is none.
///
/// The root of larger magnitude comes from the sum that does not cancel, the other from the product of the roots. When
/// `a` is zero or nearly so (a ray along a cone's side, a paraboloid's axis) the far root runs off to infinity and the near
/// one stays exact. A single root is returned twice. Source: Press et al., *Numerical Recipes*, Sec. 5.6.
#[inline]
pub(super) fn quadratic(a: f64, b: f64, c: f64) -> Option<(f64, f64)> {
    let discriminant = b * b - a * c;
    if discriminant < 0.0 || discriminant.is_nan() {
        return None;
    }
    let q = -(b + discriminant.sqrt().copysign(b));
    if q == 0.0 {
        // b = 0 and a c = 0: the origin is a double root, unless nothing depends on t at all.
        return if a != 0.0 { Some((0.0, 0.0)) } else { None };
    }
    let near = c / q;
    let far = if a == 0.0 { near } else { q / a };
    Some(if near <= far { (near, far) } else { (far, near) })
}

/// The first of two ascending parameters that lies strictly inside the ray's segment.
#[inline]
pub(super) fn first_between(near: f64, far: f64, ray: &DRay) -> Option<f64> {
    let inside = |t: f64| t > ray.tnear && t < ray.tfar;
    if inside(near) {
        Some(near)
    } else if inside(far) {
        Some(far)
    } else {
        None
    }
}

#[cfg(test)]
mod tests {
    use super::quadratic;

    #[test]
    fn small_root_survives_a_large_one() {
        // Roots 1e-9 and 1e9; the textbook formula returns 0 for the first.
        let (near, far) = quadratic(1.0, -0.5 * (1e9 + 1e-9), 1.0).unwrap();
        assert!((near / 1e-9 - 1.0).abs() < 1e-15, "{near}");
        assert!((far / 1e9 - 1.0).abs() < 1e-15, "{far}");
    }

    #[test]
    fn degenerate_forms() {
        assert_eq!(quadratic(0.0, -0.5, 3.0), Some((3.0, 3.0)));
        assert_eq!(quadratic(1.0, 0.0, 0.0), Some((0.0, 0.0)));
        assert_eq!(quadratic(0.0, 0.0, 1.0), None);
        assert_eq!(quadratic(0.0, 0.0, 0.0), None);
        assert_eq!(quadratic(1.0, 0.0, 1.0), None);
        assert_eq!(quadratic(f64::NAN, 0.0, 1.0), None);
    }
}
