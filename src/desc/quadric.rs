//! The named quadrics. Each has unit size in its own frame, and a transform places that frame.
//!
//! The transform contains the size, so the coefficients are near 1 whatever the scene's scale. A clip box is
//! axis-aligned in the quadric's own frame. Where the surface only touches a face of its box (the mantle of a cylinder,
//! the apex of a paraboloid), the box is slightly larger, so that rounding cuts no holes.

use super::ShapeDesc;
use crate::math::{Bounds, DAffine3, DMat3, DVec3};

/// The margin by which a clip box is larger than a surface that touches the box from inside.
const MARGIN: f64 = 1e-3;

/// Returns a frame at `origin` with its z axis along the unit vector `axis`. `radius` is the unit of x and y, and
/// `height` that of z.
pub(super) fn frame(origin: DVec3, axis: DVec3, radius: f64, height: f64) -> DAffine3 {
    let (x, y) = axis.any_orthonormal_pair();
    DAffine3::from_mat3_translation(DMat3::from_cols(radius * x, radius * y, height * axis), origin)
}

/// Returns a box around the z axis, from `low` to 1 in z, whose half width is 1 with some margin.
fn tube(low: f64) -> Bounds {
    let wide = 1.0 + MARGIN;
    Bounds { min: DVec3::new(-wide, -wide, low), max: DVec3::new(wide, wide, 1.0) }
}

/// The quadric x^2 + y^2 = 1 for z in [0, 1]: a tube without caps.
pub(super) fn cylinder() -> ShapeDesc {
    ShapeDesc::Quadric { coefficients: [1.0, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, -1.0], clip: tube(0.0) }
}

/// The quadric x^2 + y^2 = (1 - z)^2 for z in [0, 1]: a cone with its base at z = 0, without the base disk.
pub(super) fn cone() -> ShapeDesc {
    ShapeDesc::Quadric { coefficients: [1.0, 1.0, -1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0, -1.0], clip: tube(0.0) }
}

/// The quadric x^2 + y^2 = z for z up to 1: a paraboloid with its apex at the origin.
pub(super) fn paraboloid() -> ShapeDesc {
    ShapeDesc::Quadric { coefficients: [1.0, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, -0.5, 0.0], clip: tube(-MARGIN) }
}

/// The quadric x^2 + y^2 + z^2 = 1: the unit sphere.
pub(super) fn ball() -> ShapeDesc {
    let wide = DVec3::splat(1.0 + MARGIN);
    ShapeDesc::Quadric {
        coefficients: [1.0, 1.0, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, -1.0],
        clip: Bounds { min: -wide, max: wide },
    }
}

/// Returns the box around a closed quadric (an ellipsoid in any position).
///
/// With the symmetric matrix A of the quadratic part and the linear part 2 v, the centre is m = -A^-1 v, and with s =
/// m.(A m) - j the surface (p - m).(A (p - m)) = s reaches sqrt(s (A^-1)_kk) from m along axis k. The result is `None`
/// for a quadric that is unbounded or has no real point.
pub(super) fn closed_bounds(coefficients: &[f64; 10]) -> Option<Bounds> {
    let [a, b, c, d, e, f, g, h, i, j] = *coefficients;
    let matrix = DMat3::from_cols_array(&[a, d, f, d, b, e, f, e, c]);
    // An ellipsoid has a definite matrix, by Sylvester's criterion: the leading minors of +A or of -A are positive.
    let sign = a.signum();
    let definite = a != 0.0 && a * b - d * d > 0.0 && sign * matrix.determinant() > 0.0;
    if !definite {
        return None;
    }
    let inverse = matrix.inverse();
    let v = DVec3::new(g, h, i);
    let centre = -(inverse * v);
    let s = centre.dot(matrix * centre) - j;
    let squares = s * DVec3::new(inverse.x_axis.x, inverse.y_axis.y, inverse.z_axis.z);
    let reach = DVec3::new(squares.x.sqrt(), squares.y.sqrt(), squares.z.sqrt()) * (1.0 + MARGIN);
    // The root of a negative number is NaN and fails this test: the quadric has no real point.
    (reach.cmpgt(DVec3::ZERO).all() && (centre.abs() + reach).is_finite())
        .then_some(Bounds { min: centre - reach, max: centre + reach })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn quadric(shape: ShapeDesc) -> ([f64; 10], Bounds) {
        match shape {
            ShapeDesc::Quadric { coefficients, clip } => (coefficients, clip),
            other => panic!("{other:?} is no quadric"),
        }
    }

    fn at([a, b, c, d, e, f, g, h, i, j]: [f64; 10], p: DVec3) -> f64 {
        let DVec3 { x, y, z } = p;
        a * x * x + b * y * y + c * z * z + 2.0 * (d * x * y + e * y * z + f * x * z + g * x + h * y + i * z) + j
    }

    /// Central differences are exact for a polynomial of degree two, except for rounding.
    fn gradient(coefficients: [f64; 10], p: DVec3) -> DVec3 {
        let slope = |axis: DVec3| (at(coefficients, p + axis) - at(coefficients, p - axis)) / 2.0;
        DVec3::new(slope(DVec3::X), slope(DVec3::Y), slope(DVec3::Z))
    }

    #[test]
    fn named_forms_pass_through_their_points_with_normals_outwards() {
        for angle in [0.0, 0.7, 2.0, 4.4] {
            let out = DVec3::new(f64::cos(angle), f64::sin(angle), 0.0);
            for t in [0.1, 0.5, 0.9] {
                for (shape, radius) in [(cylinder(), 1.0), (cone(), 1.0 - t), (paraboloid(), f64::sqrt(t))] {
                    let (coefficients, clip) = quadric(shape);
                    let p = radius * out + DVec3::Z * t;
                    assert!(at(coefficients, p).abs() < 1e-12, "{shape:?} misses {p}");
                    assert!(gradient(coefficients, p).dot(out) > 0.1, "{shape:?} points inwards at {p}");
                    assert!(p.cmpgt(clip.min).all() && p.cmplt(clip.max).all(), "{shape:?} is cut at {p}");
                }
            }
        }
        let (coefficients, _) = quadric(ball());
        for p in [DVec3::X, DVec3::Y, DVec3::NEG_Z] {
            assert!(at(coefficients, p).abs() < 1e-12 && gradient(coefficients, p).dot(p) > 0.0);
        }
    }

    #[test]
    fn bounds_of_a_shifted_and_turned_ellipsoid_hold_it_tightly() {
        // The ellipsoid is (x - 1)^2 + 2 (y + 2)^2 + 3 z^2 + (x - 1)(y + 2) = 4, and its bounds are compared with
        // points on it.
        let coefficients = [1.0, 2.0, 3.0, 0.5, 0.0, 0.0, 0.0, 3.5, 0.0, 3.0];
        let bounds = closed_bounds(&coefficients).expect("an ellipsoid");
        let centre = DVec3::new(1.0, -2.0, 0.0);
        let mut seen = Bounds::EMPTY;
        for i in 0..400 {
            for j in 0..200 {
                let (phi, theta) = (f64::from(i) * 0.015_708, f64::from(j) * 0.015_708);
                let d = DVec3::new(theta.sin() * phi.cos(), theta.sin() * phi.sin(), theta.cos());
                let scale = (4.0 / (d.x * d.x + 2.0 * d.y * d.y + 3.0 * d.z * d.z + d.x * d.y)).sqrt();
                let p = centre + scale * d;
                assert!(at(coefficients, p).abs() < 1e-9);
                seen = seen.include(p);
            }
        }
        assert!(seen.min.cmpge(bounds.min).all() && seen.max.cmple(bounds.max).all());
        assert!((seen.min - bounds.min).max_element() < 0.005 && (bounds.max - seen.max).max_element() < 0.005);
    }

    #[test]
    fn open_and_empty_quadrics_have_no_bounds() {
        for open in [
            [1.0, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, -1.0],
            [1.0, 1.0, -1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, -1.0],
            [1.0, 1.0, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0],
            [0.0; 10],
        ] {
            assert_eq!(closed_bounds(&open), None);
        }
        assert!(closed_bounds(&[-1.0, -1.0, -1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 4.0]).is_some());
    }
}
