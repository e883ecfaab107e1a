//! Warps, distributions and filters: that samples follow the densities they claim. Tests of the samplers are in
//! `sequences.rs`; more about both, with large numbers, in `accuracy/sampling`.

mod common {
    // Each test program uses its own part.
    #[allow(dead_code)]
    pub mod stats;
}

use std::f64::consts::{FRAC_PI_2, PI};

use common::stats::{SIGNIFICANCE, check_density, check_directions, chi_square, mean_and_error, sidak, z_test};
use etendue::desc::FilterDesc;
use etendue::math::{DVec3, Vec3};
use etendue::sampling::{Distribution1D, Filter, Rng, SphericalTriangle, mis, triangle_solid_angle, warps};

/// Numbers at which warps have seams, corners and poles.
fn corner_numbers() -> Vec<[f32; 2]> {
    let values = [0.0, f32::MIN_POSITIVE, 0.25, 0.5_f32.next_down(), 0.5, 0.75, 1.0_f32.next_down()];
    values.iter().flat_map(|&a| values.map(|b| [a, b])).collect()
}

// ---- warps ----

/// A warp to directions, its density and its inverse.
type DirectionWarp =
    (&'static str, Box<dyn Fn([f32; 2]) -> Vec3>, Box<dyn Fn(Vec3) -> f32>, Box<dyn Fn(Vec3) -> [f32; 2]>);

fn direction_warps() -> Vec<DirectionWarp> {
    let cone = |omc: f32| -> DirectionWarp {
        (
            "cone",
            Box::new(move |u| warps::uniform_cone(u, omc)),
            Box::new(move |w| if 1.0 - w.z <= omc { warps::uniform_cone_pdf(omc) } else { 0.0 }),
            Box::new(move |w| warps::uniform_cone_inverse(w, omc)),
        )
    };
    vec![
        (
            "cosine hemisphere",
            Box::new(warps::cosine_hemisphere),
            Box::new(|w| warps::cosine_hemisphere_pdf(w.z)),
            Box::new(warps::cosine_hemisphere_inverse),
        ),
        (
            "hemisphere",
            Box::new(warps::uniform_hemisphere),
            Box::new(|w| if w.z >= 0.0 { warps::uniform_hemisphere_pdf() } else { 0.0 }),
            Box::new(warps::uniform_hemisphere_inverse),
        ),
        (
            "sphere",
            Box::new(warps::uniform_sphere),
            Box::new(|_| warps::uniform_sphere_pdf()),
            Box::new(warps::uniform_sphere_inverse),
        ),
        cone(0.2),
        cone(0.7),
        cone(1.6),
    ]
}

#[test]
fn directions_follow_their_densities() {
    let warps = direction_warps();
    for (i, (name, warp, pdf, _)) in warps.iter().enumerate() {
        let mut rng = Rng::new(1, i as u64);
        let draw = || {
            let w = warp(rng.next_2d());
            (w.to_array(), pdf(w))
        };
        let check = check_directions(500_000, draw, |w| pdf(Vec3::from_array(w)));
        assert!(check.passes(sidak(SIGNIFICANCE, warps.len())), "{name}: {check:?}");
    }
}

#[test]
fn directions_are_unit_and_their_warps_invertible() {
    let mut rng = Rng::new(2, 0);
    for (name, warp, _, inverse) in direction_warps() {
        for u in corner_numbers().into_iter().chain((0..10_000).map(|_| rng.next_2d())) {
            let w = warp(u);
            assert!((w.length() - 1.0).abs() < 3e-7, "{name} {u:?}: {w}");
            // The square's edges fold onto one another where the angle wraps or the pole is.
            let inner = u.iter().all(|x| (1e-3..0.999).contains(x));
            let back = inverse(w);
            if inner {
                assert!((back[0] - u[0]).abs() < 3e-5 && (back[1] - u[1]).abs() < 3e-5, "{name} {u:?}: {back:?}");
            }
        }
    }
    for u in corner_numbers() {
        assert!(warps::cosine_hemisphere(u).z > 0.0 && warps::uniform_hemisphere(u).z > 0.0);
    }
}

#[test]
fn narrow_cones_keep_their_digits() {
    // A ball of radius 1 at distance 1e5.
    let omc = warps::one_minus_cos_from_sin2(1e-10);
    assert!((f64::from(omc) * 2.0 * PI / 3.14159265367e-10 - 1.0).abs() < 1e-6);
    let mut rng = Rng::new(3, 0);
    for _ in 0..1000 {
        let u = rng.next_2d();
        let w = warps::uniform_cone(u, omc);
        let sin = f64::from(w.x).hypot(f64::from(w.y));
        assert!(sin <= 1.000001e-5 && (sin * sin / 1e-10 - f64::from(u[0])).abs() < 1e-5);
        assert!((warps::uniform_cone_inverse(w, omc)[0] - u[0]).abs() < 1e-5);
    }
    assert_eq!(warps::one_minus_cos_from_sin2(1.0), 1.0);
}

#[test]
fn disc_and_triangle_are_uniform_and_invertible() {
    let mut rng = Rng::new(4, 0);
    let draw = || {
        let [x, y] = warps::uniform_disk(rng.next_2d());
        (f64::from(x), f64::from(y), f64::from(warps::uniform_disk_pdf()))
    };
    let inside = |x: f64, y: f64| if x * x + y * y <= 1.0 { 1.0 / PI } else { 0.0 };
    let check = check_density((50, 50), ((-1.0, 1.0), (-1.0, 1.0)), 500_000, draw, inside);
    assert!(check.passes(sidak(SIGNIFICANCE, 2)), "{check:?}");

    let mut rng = Rng::new(5, 0);
    let draw = || {
        let [b0, b1, _] = warps::uniform_triangle(rng.next_2d());
        (f64::from(b0), f64::from(b1), 2.0)
    };
    let check =
        check_density((50, 50), ((0.0, 1.0), (0.0, 1.0)), 500_000, draw, |x, y| if x + y <= 1.0 { 2.0 } else { 0.0 });
    assert!(check.passes(sidak(SIGNIFICANCE, 2)), "{check:?}");

    let mut rng = Rng::new(6, 0);
    for u in corner_numbers().into_iter().chain((0..10_000).map(|_| rng.next_2d())) {
        let p = warps::uniform_disk(u);
        assert!(p[0].hypot(p[1]) <= 1.0);
        let b = warps::uniform_triangle(u);
        assert!(b.iter().all(|x| (0.0..=1.0).contains(x)) && (b.iter().sum::<f32>() - 1.0).abs() < 2e-7, "{b:?}");
        for back in [warps::uniform_disk_inverse(p), warps::uniform_triangle_inverse(b)] {
            assert!((back[0] - u[0]).abs() < 1e-6 && (back[1] - u[1]).abs() < 1e-6, "{u:?}: {back:?}");
        }
    }
}

// ---- triangles seen from a point ----

fn triangles() -> Vec<[Vec3; 3]> {
    let v = Vec3::new;
    vec![
        // An octant, a small one, one around most of a hemisphere, a needle, one mostly behind, and one edge near.
        [Vec3::X, Vec3::Y, Vec3::Z],
        [v(0.0, 0.0, 2.0), v(3.0, 0.0, 2.0), v(0.0, 1.0, 2.0)],
        [v(-100.0, -90.0, 0.5), v(110.0, -80.0, 0.5), v(5.0, 120.0, 0.5)],
        [v(-1.0, 2.0, 0.3), v(1.5, 2.0, 0.3), v(0.2, 2.0, 0.5)],
        [v(1.0, 0.2, -2.0), v(-1.0, 3.0, 0.5), v(0.3, -2.0, -0.7)],
        [v(0.3, 0.0, 0.1), v(3.0, 1.0, 0.2), v(3.0, -1.0, 0.3)],
    ]
}

#[test]
fn solid_angles_match_the_closed_forms() {
    let v = Vec3::new;
    let square = [v(-1.0, -1.0, 1.0), v(1.0, -1.0, 1.0), v(1.0, 1.0, 1.0), v(-1.0, 1.0, 1.0)];
    let cases = [
        (triangle_solid_angle([Vec3::X, Vec3::Y, Vec3::Z]), FRAC_PI_2),
        (
            triangle_solid_angle([square[0], square[1], square[2]])
                + triangle_solid_angle([square[0], square[2], square[3]]),
            2.0 * PI / 3.0,
        ),
        (triangle_solid_angle([v(0.0, 0.0, 1.0), v(1.0, 0.0, 1.0), v(0.0, 1.0, 1.0)]), 0.339836909454),
        (triangle_solid_angle([v(0.0, 0.0, 10.0), v(1e-4, 0.0, 10.0), v(0.0, 1e-4, 10.0)]), 4.99999999975e-11),
        (triangle_solid_angle([v(-1.0, -1.0, 0.0), v(1.0, -1.0, 0.0), v(0.0, 1.0, 0.0)]), 2.0 * PI),
    ];
    for (found, exact) in cases {
        assert!((found / exact - 1.0).abs() < 2e-7, "{found} for {exact}");
    }
    for [a, b, c] in triangles() {
        let found = triangle_solid_angle([a, b, c]);
        assert!((triangle_solid_angle([b, a, c]) / found - 1.0).abs() < 1e-12);
        let triangle = SphericalTriangle::new([a, b, c]).unwrap();
        assert_eq!(triangle.solid_angle(), found as f32);
        assert!((triangle.pdf() * triangle.solid_angle() - 1.0).abs() < 2e-7);
    }
}

#[test]
fn degenerate_triangles_are_refused() {
    let v = Vec3::new;
    for bad in [
        [v(1.0, 0.0, 1.0); 3],
        [v(0.0, 0.0, 1.0), v(1.0, 0.0, 1.0), v(2.0, 0.0, 1.0)],
        [v(1.0, 0.0, 0.0), v(2.0, 0.0, 0.0), v(2.0, 1.0, 0.0)],
        [v(-1.0, -1.0, 0.0), v(1.0, -1.0, 0.0), v(0.0, 1.0, 0.0)],
        [Vec3::ZERO, v(1.0, 0.0, 1.0), v(0.0, 1.0, 1.0)],
        [v(0.0, 0.0, 1e5), v(1e-3, 0.0, 1e5), v(0.0, 1e-3, 1e5)],
        [v(f32::NAN, 0.0, 1.0), v(1.0, 0.0, 1.0), v(0.0, 1.0, 1.0)],
        [v(f32::INFINITY, 0.0, 1.0), v(1.0, 0.0, 1.0), v(0.0, 1.0, 1.0)],
    ] {
        assert!(SphericalTriangle::new(bad).is_none(), "{bad:?}");
    }
}

#[test]
fn spherical_triangles_are_uniform() {
    let tests = 2 * triangles().len();
    for (i, v) in triangles().into_iter().enumerate() {
        let triangle = SphericalTriangle::new(v).unwrap();
        let mut rng = Rng::new(17, i as u64);
        // Over the triangle itself, mapped to the unit square without change of area, the density is smooth, but for
        // lights that come very close.
        let d = v.map(Vec3::as_dvec3);
        let normal = (d[1] - d[0]).cross(d[2] - d[0]);
        let density = |x: f64, y: f64| {
            let b = warps::uniform_triangle([x as f32, y as f32]);
            let p = (0..3).map(|k| f64::from(b[k]) * d[k]).sum::<DVec3>();
            0.5 * normal.dot(p).abs() / (p.length().powi(3) * f64::from(triangle.solid_angle()))
        };
        let draw = || {
            let [x, y] = warps::uniform_triangle_inverse(triangle.sample_barycentric(rng.next_2d()).1);
            (f64::from(x), f64::from(y), density(f64::from(x), f64::from(y)))
        };
        if triangle.solid_angle() < 2.0 {
            let check = check_density((40, 40), ((0.0, 1.0), (0.0, 1.0)), 300_000, draw, density);
            assert!(check.passes(sidak(SIGNIFICANCE, tests)), "{v:?}: {check:?}");
        }

        // Over the sphere it is constant inside the three planes. Too coarse for needles.
        if triangle.solid_angle() < 0.2 {
            continue;
        }
        let planes = [d[0].cross(d[1]), d[1].cross(d[2]), d[2].cross(d[0])].map(|n| n.normalize());
        let sign = 1.0_f64.copysign(d[0].dot(d[1].cross(d[2])));
        let pdf = |w: [f32; 3]| {
            let w = Vec3::from_array(w).as_dvec3();
            if planes.iter().all(|n| sign * n.dot(w) >= 0.0) { triangle.pdf() } else { 0.0 }
        };
        let mut rng = Rng::new(7, i as u64);
        let draw = || (triangle.sample(rng.next_2d()).to_array(), triangle.pdf());
        let check = check_directions(300_000, draw, pdf);
        assert!(check.passes(sidak(SIGNIFICANCE, tests)), "{v:?}: {check:?}");
    }
}

#[test]
fn spherical_triangle_samples_lie_where_they_say() {
    let mut rng = Rng::new(8, 0);
    for v in triangles() {
        let triangle = SphericalTriangle::new(v).unwrap();
        for u in corner_numbers().into_iter().chain((0..20_000).map(|_| rng.next_2d())) {
            let (w, b) = triangle.sample_barycentric(u);
            assert_eq!(w, triangle.sample(u));
            assert!((w.length() - 1.0).abs() < 2e-7, "{v:?} {u:?}: {w}");
            assert!(b.iter().all(|x| (0.0..=1.0).contains(x)) && (b.iter().sum::<f32>() - 1.0).abs() < 2e-7, "{b:?}");
            let point = (0..3).map(|k| f64::from(b[k]) * v[k].as_dvec3()).sum::<DVec3>();
            let largest = v.iter().map(|p| p.length()).fold(0.0, f32::max);
            let off = point.cross(w.as_dvec3()).length();
            assert!(off <= 1e-6 * f64::from(largest), "{v:?} {u:?}: {point} is off {w}");
            let inner = u.iter().all(|x| (0.01..0.99).contains(x));
            let back = triangle.inverse(w);
            if inner {
                assert!((back[0] - u[0]).abs() < 1e-3 && (back[1] - u[1]).abs() < 1e-3, "{v:?} {u:?}: {back:?}");
            }
        }
    }
}

#[test]
fn tiny_triangles_are_still_uniform() {
    let v = Vec3::new;
    for (i, tiny) in [
        [v(0.0, 0.0, 10.0), v(1e-4, 0.0, 10.0), v(0.0, 1e-4, 10.0)],
        [v(3.0, 1.0, 2.0), v(3.00002, 1.0, 2.0), v(3.00001, 1.00002, 1.99999)],
    ]
    .into_iter()
    .enumerate()
    {
        let triangle = SphericalTriangle::new(tiny).unwrap();
        assert!(triangle.solid_angle() < 1e-10);
        // So small a triangle is uniform in direction where it is uniform in area.
        let mut rng = Rng::new(9, i as u64);
        let draw = || {
            let (_, b) = triangle.sample_barycentric(rng.next_2d());
            let [x, y] = warps::uniform_triangle_inverse(b);
            (f64::from(x), f64::from(y), 1.0)
        };
        let check = check_density((40, 40), ((0.0, 1.0), (0.0, 1.0)), 200_000, draw, |_, _| 1.0);
        assert!(check.passes(sidak(SIGNIFICANCE, 2)), "{tiny:?}: {check:?}");
    }
}

#[test]
fn a_triangular_light_has_the_form_factor_of_lamberts_formula() {
    let triangle = SphericalTriangle::new(triangles()[1]).unwrap();
    let mut rng = Rng::new(10, 0);
    let values: Vec<f64> =
        (0..200_000).map(|_| f64::from(triangle.sample(rng.next_2d()).z / triangle.pdf()) / PI).collect();
    let (mean, error) = mean_and_error(&values);
    assert!(error < 1e-3 * mean && z_test(mean, error, 0.0717322841703) > SIGNIFICANCE, "{mean} +- {error}");
}

// ---- discrete choice ----

#[test]
fn indices_are_chosen_in_proportion_to_weights() {
    let many: Vec<f64> = (0..1000).map(|i| if i % 7 == 0 { 0.0 } else { f64::from(i).sqrt() }).collect();
    let cases: Vec<Vec<f64>> = vec![
        vec![1.0],
        vec![0.0, 3.0, 0.0, 0.0, 1.0, 0.0],
        vec![1e-30, 2e-30, 1e-30],
        vec![1e300, 1.0, 1e300],
        vec![1.0; 333],
        many,
    ];
    for (i, weights) in cases.iter().enumerate() {
        let distribution = Distribution1D::new(weights).unwrap();
        let total: f64 = weights.iter().sum();
        assert_eq!((distribution.len(), distribution.total()), (weights.len(), total));
        let mut rng = Rng::new(11, i as u64);
        let (mut counts, mut remapped_counts) = (vec![0_u64; weights.len()], vec![0_u64; 16]);
        let draws = 200_000;
        for _ in 0..draws {
            let (index, pmf, remapped) = distribution.sample(rng.next_f32());
            counts[index] += 1;
            remapped_counts[(remapped * 16.0) as usize] += 1;
            assert!((0.0..1.0).contains(&remapped));
            assert_eq!(pmf, distribution.pmf(index));
            assert!((f64::from(pmf) / (weights[index] / total) - 1.0).abs() < 1e-6);
        }
        for u in [0.0, 0.25, 0.5, 0.75, 1.0_f32.next_down(), 1.0, -1.0] {
            assert!(weights[distribution.sample(u).0] > 0.0, "{weights:?} at {u}");
        }
        let expected: Vec<f64> = weights.iter().map(|w| w / total * f64::from(draws)).collect();
        let significance = sidak(SIGNIFICANCE, 2 * cases.len());
        assert!(weights.len() == 1 || chi_square(&counts, &expected) > significance, "{i}");
        assert!(chi_square(&remapped_counts, &[f64::from(draws) / 16.0; 16]) > significance, "{i}");
        assert_eq!(distribution.pmf(weights.len()), 0.0);
    }
}

#[test]
fn weights_without_a_distribution_are_refused() {
    for bad in [&[][..], &[0.0, 0.0], &[1.0, -1.0], &[f64::NAN], &[f64::INFINITY], &[f64::MAX, f64::MAX]] {
        assert!(Distribution1D::new(bad).is_none(), "{bad:?}");
    }
}

#[test]
fn combination_weights_sum_to_one_and_survive_extremes() {
    let values = [0.0, 1e-45, 1e-30, 0.3, 1.0, 7.0, 1e20, 3e38, f32::INFINITY];
    for a in values {
        for b in values {
            for heuristic in [mis::balance_heuristic, mis::power_heuristic] {
                let (wa, wb) = (heuristic(a, b), heuristic(b, a));
                assert!((0.0..=1.0).contains(&wa));
                assert_eq!(wa == 0.0 && a == 0.0, a == 0.0);
                if a > 0.0 || b > 0.0 {
                    assert!((wa + wb - 1.0).abs() < 1e-6, "{a}, {b}: {wa} + {wb}");
                }
            }
        }
    }
    assert_eq!((mis::balance_heuristic(3.0, 1.0), mis::power_heuristic(3.0, 1.0)), (0.75, 0.9));
}

// ---- filters ----

fn filters() -> Vec<(FilterDesc, f64)> {
    // With the largest value of the filter along one axis, for the tolerance of the tabulated density.
    let mitchell = |b, c| FilterDesc::Mitchell { b, c };
    vec![
        (FilterDesc::Box, 1.0),
        (FilterDesc::Tent, 1.0),
        (FilterDesc::Gaussian { sigma: 0.5 }, 0.8),
        (FilterDesc::Gaussian { sigma: 0.2 }, 2.0),
        (FilterDesc::BlackmanHarris, 0.7),
        (mitchell(1.0 / 3.0, 1.0 / 3.0), 0.9),
        (mitchell(0.0, 0.5), 1.0),
        (mitchell(1.0, 0.0), 0.7),
    ]
}

#[test]
fn tabulated_filters_are_as_exact_as_stated() {
    for (desc, peak) in filters() {
        let filter = Filter::new(&desc);
        let centre = f64::from(filter.evaluate(0.0, 0.0)).sqrt();
        let magnitude = f64::from(filter.sample([0.5, 0.5]).1.abs()).sqrt();
        // du / dx of the inverse is the density that is really drawn from.
        let h = 2.0_f32.powi(-12);
        for k in 1..1000 {
            let u = k as f32 / 1000.0;
            let (a, b) = (filter.sample([u - h, 0.5]).0[0], filter.sample([u + h, 0.5]).0[0]);
            let drawn = 2.0 * f64::from(h) / (f64::from(b) - f64::from(a)) * magnitude;
            let exact = f64::from(filter.evaluate(filter.sample([u, 0.5]).0[0], 0.0)).abs() / centre;
            if exact > 0.2 * peak {
                // What remains is the difference quotient's own error: rounding of x and curvature.
                assert!((drawn - exact).abs() < 2e-3 * peak, "{desc:?} at {u}: {drawn} for {exact}");
            }
        }
        // The cumulative distribution at fixed points tells the density's error without differences.
        let n = 200_000;
        let (r, mut cumulative) = (f64::from(filter.radius()), 0.0);
        let dx = 2.0 * r / f64::from(n);
        let mut k = 1;
        for i in 0..n {
            let x = (f64::from(i) + 0.5) * dx - r;
            cumulative += f64::from(filter.evaluate(x as f32, 0.0)).abs() / centre * dx / magnitude;
            if cumulative >= f64::from(k) / 64.0 && k < 64 {
                let drawn = f64::from(filter.sample([k as f32 / 64.0, 0.5]).0[0]);
                let density = f64::from(filter.evaluate(x as f32, 0.0)).abs() / centre / magnitude;
                let off = (drawn - x).abs() * density;
                assert!(off < 1e-5 + dx * density, "{desc:?}: quantile {k} at {drawn} for {x}");
                k += 1;
            }
        }
        assert_eq!(k, 64, "{desc:?}");
    }
}

#[test]
fn filter_samples_stay_inside_for_any_number() {
    for (desc, _) in filters() {
        let filter = Filter::new(&desc);
        for u in corner_numbers() {
            let ([x, y], weight) = filter.sample(u);
            assert!(x.abs() <= filter.radius() && y.abs() <= filter.radius() && weight.is_finite(), "{desc:?} {u:?}");
        }
        // A position outside the pixel is kept by the box and clamped by the others.
        let ([x, _], _) = filter.sample([1.7, 0.5]);
        assert!(if desc == FilterDesc::Box { (x - 1.2).abs() < 1e-6 } else { x.abs() <= filter.radius() });
    }
}
