//! Solid angles of triangles and spheres, and directions uniform over them.

use std::f64::consts::{FRAC_PI_2, PI};

use etendue::emitter::EmitterSet;
use etendue::math::{DVec3, Vec3};
use etendue::sampling::{Rng, SphericalTriangle, triangle_solid_angle, warps};

use super::sphere_light;
use crate::bsdf::inverses;
use crate::record::{Case, Entry, Within};
use crate::stats::{check_density, check_directions};

pub fn cases() -> Vec<Entry> {
    vec![
        Entry { id: "L41", title: "solid angles", run: solid_angles },
        Entry { id: "L41b", title: "spherical triangles, chi-square", run: uniform },
        Entry { id: "L41c", title: "spherical triangles, where samples lie", run: places },
    ]
}

const fn v(x: f32, y: f32, z: f32) -> Vec3 {
    Vec3::new(x, y, z)
}

/// Triangles around the origin.
const TRIANGLES: [(&str, [Vec3; 3]); 9] = [
    ("octant", [Vec3::X, Vec3::Y, Vec3::Z]),
    ("one metre or two away", [v(0.0, 0.0, 2.0), v(3.0, 0.0, 2.0), v(0.0, 1.0, 2.0)]),
    ("nearly a hemisphere", [v(-100.0, -90.0, 0.5), v(110.0, -80.0, 0.5), v(5.0, 120.0, 0.5)]),
    ("needle", [v(-1.0, 2.0, 0.3), v(1.5, 2.0, 0.3), v(0.2, 2.0, 0.5)]),
    ("mostly behind", [v(1.0, 0.2, -2.0), v(-1.0, 3.0, 0.5), v(0.3, -2.0, -0.7)]),
    ("with one near vertex", [v(0.3, 0.0, 0.1), v(3.0, 1.0, 0.2), v(3.0, -1.0, 0.3)]),
    ("needle of 1e6 : 1", [v(-0.5, 0.0, 0.7), v(0.5, 0.0, 0.7), v(0.1, 1e-6, 0.7)]),
    ("5e-11 sr", [v(0.0, 0.0, 10.0), v(1e-4, 0.0, 10.0), v(0.0, 1e-4, 10.0)]),
    ("3e-11 sr, oblique", [v(3.0, 1.0, 2.0), v(3.000_02, 1.0, 2.0), v(3.000_01, 1.000_02, 1.999_99)]),
];

fn solid_angles(case: &mut Case) {
    let square = [v(-1.0, -1.0, 1.0), v(1.0, -1.0, 1.0), v(1.0, 1.0, 1.0), v(-1.0, 1.0, 1.0)];
    let halves = triangle_solid_angle([square[0], square[1], square[2]])
        + triangle_solid_angle([square[0], square[2], square[3]]);
    // Legs of 1e-4 in single precision, at a distance that leaves area over squared distance.
    let legs = f64::from(1e-4_f32).powi(2) / 2.0;
    for (what, found, exact) in [
        ("octant", triangle_solid_angle(TRIANGLES[0].1), FRAC_PI_2),
        ("2 x 2 square at 1", halves, 2.0 * PI / 3.0),
        (
            "unit legs at 1",
            triangle_solid_angle([v(0.0, 0.0, 1.0), v(1.0, 0.0, 1.0), v(0.0, 1.0, 1.0)]),
            0.339836909454,
        ),
        ("legs of 1e-4 at 10", triangle_solid_angle(TRIANGLES[7].1), 4.99999999975e-11),
        (
            "legs of 1e-4 at 1e4",
            triangle_solid_angle([v(0.0, 0.0, 1e4), v(1e-4, 0.0, 1e4), v(0.0, 1e-4, 1e4)]),
            legs / 1e8,
        ),
        (
            "point within the triangle",
            triangle_solid_angle([v(-1.0, -1.0, 0.0), v(1.0, -1.0, 0.0), v(0.0, 1.0, 0.0)]),
            2.0 * PI,
        ),
    ] {
        case.exact(what, found, exact, Within::Relative(2e-7));
    }
    let (mut order, mut density) = (0.0_f64, 0.0_f64);
    for (_, [a, b, c]) in TRIANGLES {
        let found = triangle_solid_angle([a, b, c]);
        for other in [[b, a, c], [b, c, a], [c, b, a]] {
            order = order.max((triangle_solid_angle(other) / found - 1.0).abs());
        }
        density = density.max(
            SphericalTriangle::new([a, b, c])
                .map_or(f64::INFINITY, |triangle| (f64::from(triangle.pdf()) * found - 1.0).abs()),
        );
    }
    case.at_most("order of the vertices, relative", order, 1e-9);
    case.at_most("density times solid angle, off 1", density, 2e-7);

    // One over the density of a ball's directions, from ball's sines of 1e-5 up to nearly a right angle.
    for (what, radius, exact) in [
        ("ball of sine 1e-5", 1e-5_f64, 3.14159265367e-10),
        ("ball of sine 1/2", 0.5, 2.0 * PI * (1.0 - 0.75_f64.sqrt())),
        // 1 - cos for sin = 1 - 2^-20.
        ("ball of sine 1 - 2^-20", 1.0 - 2.0_f64.powi(-20), 2.0 * PI * (1.0 - 1.381_067_262_386_763e-3)),
    ] {
        let set = EmitterSet::new(vec![sphere_light(DVec3::Z, radius)]);
        let density = set.pdf(0, Vec3::ZERO, Vec3::Z);
        case.exact(what, 1.0 / f64::from(density), exact, Within::Relative(2e-7));
    }

    // Where sampling by solid angle makes no sense.
    let bad = [
        [v(1.0, 0.0, 1.0); 3],
        [v(0.0, 0.0, 1.0), v(1.0, 0.0, 1.0), v(2.0, 0.0, 1.0)],
        [v(1.0, 0.0, 0.0), v(2.0, 0.0, 0.0), v(2.0, 1.0, 0.0)],
        [v(-1.0, -1.0, 0.0), v(1.0, -1.0, 0.0), v(0.0, 1.0, 0.0)],
        [Vec3::ZERO, v(1.0, 0.0, 1.0), v(0.0, 1.0, 1.0)],
        [v(0.0, 0.0, 1e5), v(1e-3, 0.0, 1e5), v(0.0, 1e-3, 1e5)],
        [v(f32::NAN, 0.0, 1.0), v(1.0, 0.0, 1.0), v(0.0, 1.0, 1.0)],
        [v(f32::INFINITY, 0.0, 1.0), v(1.0, 0.0, 1.0), v(0.0, 1.0, 1.0)],
    ];
    let taken = bad.into_iter().filter(|&triangle| SphericalTriangle::new(triangle).is_some()).count();
    case.never("degenerate, edge-on or not a number: taken", taken as u64, bad.len() as u64);
}

/// Chi-square of samples over the triangle itself and over the sphere.
fn uniform(case: &mut Case) {
    let draws = case.count(60_000, 1_000_000) as usize;
    let tests = 2 * TRIANGLES.len();
    for (i, (name, vertices)) in TRIANGLES.into_iter().enumerate() {
        let triangle = SphericalTriangle::new(vertices).expect("a triangle that can be sampled");
        let solid_angle = triangle_solid_angle(vertices);
        let mut rng = Rng::new(41, i as u64);
        // Mapped to the unit square without change of area, the density is smooth, but for lights that come very close.
        let d = vertices.map(Vec3::as_dvec3);
        let normal = (d[1] - d[0]).cross(d[2] - d[0]);
        let density = |x: f64, y: f64| {
            let b = warps::uniform_triangle([x as f32, y as f32]);
            let p = d[0] + f64::from(b[1]) * (d[1] - d[0]) + f64::from(b[2]) * (d[2] - d[0]);
            0.5 * normal.dot(p).abs() / (p.length().powi(3) * solid_angle)
        };
        let draw = || {
            let [x, y] = inverses::uniform_triangle_inverse(triangle.sample_barycentric(rng.next_2d()).1);
            (f64::from(x), f64::from(y), 1.0)
        };
        if solid_angle < 2.0 {
            let check = check_density((40, 40), ((0.0, 1.0), (0.0, 1.0)), draws, draw, density);
            case.p_value(format!("{name}: over the triangle"), check.p_value, tests);
            case.exact(format!("{name}: integral over it"), check.integral, 1.0, Within::Absolute(1e-3));
        }

        // Over the sphere it is constant inside the three planes. Too coarse for needles.
        if solid_angle < 0.2 {
            continue;
        }
        let planes = [d[0].cross(d[1]), d[1].cross(d[2]), d[2].cross(d[0])].map(|n| n.normalize());
        let sign = 1.0_f64.copysign(d[0].dot(d[1].cross(d[2])));
        let pdf = |w: [f32; 3]| {
            let w = Vec3::from_array(w).as_dvec3();
            if planes.iter().all(|n| sign * n.dot(w) >= 0.0) { triangle.pdf() } else { 0.0 }
        };
        let mut rng = Rng::new(41, 100 + i as u64);
        let draw = || (triangle.sample(rng.next_2d()).to_array(), triangle.pdf());
        let check = check_directions(draws, draw, pdf);
        case.p_value(format!("{name}: over the sphere"), check.p_value, tests);
        case.exact(format!("{name}: integral over the sphere"), check.integral, 1.0, Within::Absolute(1e-3));
    }
}

/// Numbers at which a warp has corners.
fn corner_numbers() -> Vec<[f32; 2]> {
    let values = [0.0, f32::MIN_POSITIVE, 0.5, 1.0_f32.next_down()];
    values.iter().flat_map(|&a| values.map(|b| [a, b])).collect()
}

fn places(case: &mut Case) {
    let tries = case.count(5_000, 1_000_000);
    for (i, (name, vertices)) in TRIANGLES.into_iter().enumerate() {
        let triangle = SphericalTriangle::new(vertices).expect("a triangle that can be sampled");
        let mut rng = Rng::new(41, 200 + i as u64);
        let (mut bad, mut off, mut back) = (0, 0.0_f64, 0.0_f32);
        let is_small = triangle.solid_angle() < 1e-5;
        for u in corner_numbers().into_iter().chain((0..tries).map(|_| rng.next_2d())) {
            let (w, b) = triangle.sample_barycentric(u);
            let fine = w == triangle.sample(u)
                && (w.length() - 1.0).abs() < 2e-7
                && b.iter().all(|x| (0.0..=1.0).contains(x))
                && (b.iter().sum::<f32>() - 1.0).abs() < 2e-7;
            bad += u64::from(!fine);
            let point = (0..3).map(|k| f64::from(b[k]) * vertices[k].as_dvec3()).sum::<DVec3>();
            let largest = vertices.iter().map(|p| p.length()).fold(0.0, f32::max);
            off = off.max(point.cross(w.as_dvec3()).length() / f64::from(largest));
            // Directions in single precision do not resolve the smallest triangles.
            if !is_small && u.iter().all(|x| (0.01..0.99).contains(x)) {
                let found = triangle.inverse(w);
                back = back.max((found[0] - u[0]).abs()).max((found[1] - u[1]).abs());
            }
        }
        case.never(format!("{name}: not unit, not inside"), bad, tries + 16);
        case.at_most(format!("{name}: point off the direction, relative"), off, 1e-6);
        if !is_small {
            case.at_most(format!("{name}: there and back"), f64::from(back), 1e-3);
        }
    }
}
