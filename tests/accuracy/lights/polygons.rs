//! Polygonal lights against Lambert's formula, from almost touching to far away.

use std::f64::consts::{PI, TAU};

use etendue::desc::ShapeDesc;
use etendue::emitter::EmitterSet;
use etendue::math::{DQuat, DVec3, Vec3};
use etendue::sampling::{Sampler, SobolSampler, warps};

use super::{aim, ceiling, convergence, fan, irradiance, lit, point, polygon_factor, quad, rendered};
use crate::record::{Case, Entry, Within};
use crate::stats;

pub fn cases() -> Vec<Entry> {
    vec![
        Entry { id: "L42", title: "polygons, known factors", run: known_factors },
        Entry { id: "L42b", title: "polygons, 1e-8 to 1e4 sizes away", run: distances },
        Entry { id: "L42c", title: "needle light, 1e6 : 1", run: needle },
        Entry { id: "L42d", title: "receiver in a light's plane", run: in_the_plane },
        Entry { id: "L42e", title: "edge-on lights", run: edge_on },
        Entry { id: "L42f", title: "density of a polygonal light", run: densities },
        Entry { id: "L42g", title: "polygons in renders", run: renders },
        Entry { id: "L42h", title: "lights far from the frame's origin", run: far_from_the_origin },
        Entry { id: "L44", title: "disc light of triangles", run: disc },
    ]
}

/// A horizontal rectangle, counter-clockwise from below.
fn overhead(x: [f32; 2], y: [f32; 2], z: f32) -> Vec<Vec3> {
    vec![Vec3::new(x[0], y[0], z), Vec3::new(x[0], y[1], z), Vec3::new(x[1], y[1], z), Vec3::new(x[1], y[0], z)]
}

/// A regular polygon of radius 1 around the z axis, counter-clockwise from below.
fn regular(corners: usize, z: f32) -> Vec<Vec3> {
    let corner = |k: usize| {
        let (sin, cos) = (2.0 * PI * k as f64 / corners as f64).sin_cos();
        Vec3::new(cos as f32, -sin as f32, z)
    };
    (0..corners).map(corner).collect()
}

fn in_double(polygon: &[Vec3]) -> Vec<DVec3> {
    polygon.iter().map(|v| v.as_dvec3()).collect()
}

fn known_factors(case: &mut Case) {
    let v = Vec3::new;
    let upright = vec![v(1.0, -1.0, -1.0), v(1.0, -1.0, 1.0), v(1.0, 1.0, 1.0), v(1.0, 1.0, -1.0)];
    let triangle = vec![v(0.0, 0.0, 2.0), v(0.0, 1.0, 2.0), v(3.0, 0.0, 2.0)];
    for (what, polygon, exact) in [
        ("under the centre of 2 x 2", overhead([-1.0, 1.0], [-1.0, 1.0], 1.0), 0.554126423980),
        ("under a corner of 1 x 1", overhead([0.0, 1.0], [0.0, 1.0], 1.0), 0.138531605995),
        ("triangle", triangle, 0.0717322841703),
        ("regular pentagon", regular(5, 1.0), 0.429069708217),
        ("upright, half under the horizon", upright, 0.111468394005),
        ("10 x 10 at 1e-4, its centre", overhead([-5.0, 5.0], [-5.0, 5.0], 1e-4), 1.0 - 3.27323954363e-10),
        ("10 x 10 at 1e-4, 1e-3 outside", overhead([1e-3, 10.001], [-5.0, 5.0], 1e-4), 0.00248140478533),
        ("1e-3 x 1e-3 at 100", overhead([-5e-4, 5e-4], [-5e-4, 5e-4], 100.0), 3.18309886173e-11),
    ] {
        // Rounded to single precision the near light's height is off by 3e-9 relative, which its edge shows.
        let formula = polygon_factor(DVec3::ZERO, DVec3::Z, &in_double(&polygon));
        case.exact(format!("{what}: formula"), formula, exact, Within::Relative(1e-6));
        let set = EmitterSet::new(fan(&polygon));
        case.mean(what, irradiance(case, &set, Vec3::ZERO, DVec3::Z), formula, 1e-3);
    }
    let near = EmitterSet::new(fan(&overhead([-5.0, 5.0], [-5.0, 5.0], 1e-4)));
    convergence(case, "10 x 10 at 1e-4", &near, Vec3::new(1.0, 2.0, 0.0), DVec3::Z, 1.0);
    let wide = EmitterSet::new(fan(&overhead([-1.0, 1.0], [-1.0, 1.0], 1.0)));
    convergence(case, "2 x 2 at 1", &wide, Vec3::ZERO, DVec3::Z, 0.554126423980);
}

fn distances(case: &mut Case) {
    // Turned so that no coordinate is simple, and placed so that the receiver is near the origin, as in front of a camera:
    // there single precision rounds the lights' coordinates but not the receiver's.
    let turned = DQuat::from_rotation_z(0.7) * DQuat::from_rotation_x(1.1) * DQuat::from_rotation_y(-0.4);
    let near = [-8, -6].map(|exponent| (exponent, DQuat::IDENTITY));
    let rest = [-4, -3, -2, 0, 2, 4].map(|exponent| (exponent, turned));
    for (exponent, turn) in near.into_iter().chain(rest) {
        // Closer than a millionth a turned square would not be plane in single precision.
        let h = 10.0_f64.powi(exponent);
        let away = turn * DVec3::Z;
        let corner = |x: f64, y: f64| turn * DVec3::new(x, y, 0.0);
        for (name, outline) in [
            ("triangle", vec![corner(0.0, 0.0), corner(0.3, 0.9), corner(1.0, 0.0)]),
            ("square", vec![corner(0.0, 0.0), corner(0.0, 1.0), corner(1.0, 1.0), corner(1.0, 0.0)]),
        ] {
            let middle = outline.iter().sum::<DVec3>() / outline.len() as f64;
            let out = (outline[0] + outline[1] - 2.0 * middle).normalize();
            let edge = 0.5 * (outline[0] + outline[1]);
            for (place, foot, tilt) in [
                ("under its middle", middle, 0.0),
                ("under a vertex", outline[2], 0.5),
                ("as far beside its edge", edge + h * out, 0.3),
            ] {
                // The light shines against z of its own frame; the receiver's normal is tilted off its axis.
                let normal = (away - tilt * out).normalize();
                let polygon: Vec<Vec3> = outline.iter().map(|v| (*v - foot + h * away).as_vec3a()).collect();
                let p = (0.3 * h * DVec3::new(0.3, -0.2, 0.1)).as_vec3a();
                let exact = polygon_factor(p.as_dvec3(), normal, &in_double(&polygon));
                let found = irradiance(case, &EmitterSet::new(fan(&polygon)), p, normal);
                case.mean(format!("{name}, {place}, 1e{exponent}"), found, exact, 1e-3);
            }
        }
    }
}

fn needle(case: &mut Case) {
    // A strip of 1 x 1e-6 along x, as far away as given, above its middle, its end, and beside it.
    for distance in [1e-6, 1e-4, 1e-2, 1.0, 100.0] {
        for (place, x) in [("middle", 0.0), ("end", 0.5), ("beyond", 0.5 + distance)] {
            let z = distance as f32;
            let polygon = overhead([-0.5, 0.5], [-5e-7, 5e-7], z);
            let p = Vec3::new(x as f32, 0.0, 0.0);
            let exact = polygon_factor(p.as_dvec3(), DVec3::Z, &in_double(&polygon));
            let set = EmitterSet::new(fan(&polygon));
            let what = format!("strip at {distance:e}, {place}");
            case.mean(what, irradiance(case, &set, p, DVec3::Z), exact, 1e-3);
        }
    }
    // A tube's worth of it, as a lamp is: 100 : 1, at a distance of a twentieth of its length.
    let polygon = overhead([-0.5, 0.5], [-5e-3, 5e-3], 0.05);
    let exact = polygon_factor(DVec3::ZERO, DVec3::Z, &in_double(&polygon));
    let set = EmitterSet::new(fan(&polygon));
    case.mean("strip of 100 : 1 at 1/20 of its length", irradiance(case, &set, Vec3::ZERO, DVec3::Z), exact, 1e-3);
    convergence(case, "strip at 1/20", &set, Vec3::ZERO, DVec3::Z, exact);
}

fn in_the_plane(case: &mut Case) {
    // In the light's plane, on its edge, at its vertex, and in its middle: nothing arrives, and nothing is not a number.
    let polygon = overhead([-1.0, 1.0], [-1.0, 1.0], 0.0);
    let set = EmitterSet::new(fan(&polygon));
    let tries = case.count(2_000, 1_000_000);
    let mut sampler = SobolSampler::new(42, u32::MAX);
    let (mut bad, mut lit) = (0, 0);
    let places = [[2.0, 0.0], [1.0, 0.3], [1.0, 1.0], [-1.0, 1.0], [0.0, 0.0], [0.3, 0.2]];
    for [x, y] in places {
        let p = Vec3::new(x, y, 0.0);
        for i in 0..tries {
            sampler.start(0, i as u32);
            let u = sampler.next_4d();
            if let Some(sample) = set.sample(p, u) {
                lit += 1;
                bad += u64::from(!(sample.pdf > 0.0 && sample.pdf.is_finite() && sample.wi.is_finite()));
            }
            let wi = warps::uniform_sphere([u[0], u[1]]);
            for index in 0..2 {
                let density = set.pdf(index, p, p + wi);
                bad += u64::from(density.is_nan() || density < 0.0);
            }
        }
    }
    let tried = tries * places.len() as u64;
    case.never("light from within the light's own plane", lit, tried);
    case.never("samples and densities that are no numbers", bad, 3 * tried);
    // A floor against a shining wall.
    let v = Vec3::new;
    for distance in [1e-2_f32, 1e-4, 1e-6, 1e-8] {
        let wall = vec![v(distance, -1.0, 0.0), v(distance, -1.0, 2.0), v(distance, 1.0, 2.0), v(distance, 1.0, 0.0)];
        let exact = polygon_factor(DVec3::ZERO, DVec3::Z, &in_double(&wall));
        let found = irradiance(case, &EmitterSet::new(fan(&wall)), Vec3::ZERO, DVec3::Z);
        case.mean(format!("floor {distance:e} from a shining wall"), found, exact, 1e-3);
    }
}

fn edge_on(case: &mut Case) {
    // A unit square seen from this far away and as little above its plane: the receiver faces its middle.
    let turn = DQuat::from_rotation_z(0.7) * DQuat::from_rotation_x(1.1) * DQuat::from_rotation_y(-0.4);
    for (distance, height) in [(3.0, 1e-2), (3.0, 1e-4), (3.0, 1e-5), (100.0, 1e-1), (100.0, 1e-2), (0.6, 1e-4)] {
        let corner = |x: f64, y: f64| (turn * DVec3::new(x + distance, y, height)).as_vec3a();
        let polygon = vec![corner(-0.5, -0.5), corner(-0.5, 0.5), corner(0.5, 0.5), corner(0.5, -0.5)];
        let normal = (turn * DVec3::new(distance, 0.0, height)).normalize();
        let exact = polygon_factor(DVec3::ZERO, normal, &in_double(&polygon));
        let found = irradiance(case, &EmitterSet::new(fan(&polygon)), Vec3::ZERO, normal);
        case.mean(format!("at {distance}, {height:e} in front of its plane"), found, exact, 1e-3);
        // From as far behind, not a ray.
        let behind = (turn * DVec3::new(0.0, 0.0, 2.0 * height)).as_vec3a();
        let (mean, _) = irradiance(case, &EmitterSet::new(fan(&polygon)), behind, normal);
        case.exact(format!("at {distance}, {height:e} behind its plane"), mean, 0.0, Within::Absolute(0.0));
    }
}

/// Of one triangle: the density's integral over it, by points uniform in area, and the mean of one over the density of
/// samples, which is the solid angle.
fn densities(case: &mut Case) {
    let v = Vec3::new;
    let near = [v(-5.0, -5.0, 1e-2), v(0.0, 5.0, 1e-2), v(5.0, -5.0, 1e-2)];
    let middling = [v(-1.0, -1.0, 0.7), v(0.0, 1.0, 1.2), v(1.0, -1.0, 1.5)];
    let far = [v(-1.0, -1.0, 30.0), v(0.0, 1.0, 30.5), v(1.0, -1.0, 30.7)];
    let needle = [v(-0.5, 0.0, 0.05), v(-0.5, 1e-3, 0.05), v(0.5, 0.0, 0.05)];
    let draws = case.count(4096, 65_536) as u32;
    for (name, vertices) in [("near", near), ("middling", middling), ("far", far), ("needle", needle)] {
        let lights = fan(&vertices);
        let set = EmitterSet::new(lights);
        let solid_angle = etendue::sampling::triangle_solid_angle(vertices);
        let d = vertices.map(Vec3::as_dvec3);
        let cross = (d[1] - d[0]).cross(d[2] - d[0]);
        let (area, normal) = (0.5 * cross.length(), cross.normalize());
        let mut sampler = SobolSampler::new(44, draws);
        let (mut integral, mut inverse) = (Vec::new(), Vec::new());
        let (mut worst, mut furthest) = (0.0_f64, 0.0_f64);
        for replicate in 0..super::REPLICATES {
            let (mut sum, mut inverse_sum) = (0.0, 0.0);
            for i in replicate * draws..(replicate + 1) * draws {
                sampler.start(0, i);
                let u = sampler.next_4d();
                // Points uniform in area are a poor way to integrate over what almost touches: directions are there.
                let (hit, measure) = if name == "near" {
                    let wi = warps::uniform_hemisphere([u[1], u[2]]).as_dvec3();
                    let hit = wi * (d[0].dot(normal) / wi.dot(normal));
                    let inside = |k: usize| (d[(k + 1) % 3] - d[k]).cross(hit - d[k]).dot(normal) >= 0.0;
                    (hit, if (0..3).all(inside) { TAU } else { 0.0 })
                } else {
                    let b = warps::uniform_triangle([u[1], u[2]]);
                    let hit = d[0] + f64::from(b[1]) * (d[1] - d[0]) + f64::from(b[2]) * (d[2] - d[0]);
                    (hit, -hit.dot(normal) / hit.length().powi(3) * area)
                };
                sum += f64::from(set.pdf(0, Vec3::ZERO, hit.as_vec3a())) * measure;
                if let Some(sample) = set.sample(Vec3::ZERO, u) {
                    inverse_sum += 1.0 / f64::from(sample.pdf);
                    let again = set.pdf(0, Vec3::ZERO, sample.target);
                    worst = worst.max((f64::from(again) / f64::from(sample.pdf) - 1.0).abs());
                    furthest = furthest.max(aim(Vec3::ZERO, sample.wi, sample.target));
                }
            }
            integral.push(sum / f64::from(draws));
            inverse.push(inverse_sum / f64::from(draws));
        }
        case.mean(format!("{name}: integral of the density"), stats::mean_and_error(&integral), 1.0, 1e-3);
        let what = format!("{name}: mean of 1 / density, the solid angle");
        case.mean(what, stats::mean_and_error(&inverse), solid_angle, 1e-3);
        case.at_most(format!("{name}: density asked for, off the sample's"), worst, 1e-5);
        // Its end is moved off the light by the light's bound, which counts for more the nearer it is.
        let height = d[0].dot(normal).abs();
        case.at_most(format!("{name}: shadow ray off the direction, rad"), furthest, 1e-5 + 2e-6 / height);
    }
}

fn renders(case: &mut Case) {
    let upright = quad([[1.0, -1.0, -1.0], [1.0, -1.0, 1.0], [1.0, 1.0, 1.0], [1.0, 1.0, -1.0]]);
    let triangle = ShapeDesc::Triangle([[0.0, 0.0, 2.0], [0.0, 1.0, 2.0], [3.0, 0.0, 2.0]].map(point));
    for (what, light, exact) in [
        ("above the centre of 2 x 2", ceiling([-1.0, 1.0], [-1.0, 1.0], 1.0), 0.554126423980),
        ("triangle", triangle, 0.0717322841703),
        ("upright, half under the horizon", upright, 0.111468394005),
        ("1e-3 x 1e-3 at 100", ceiling([-5e-4, 5e-4], [-5e-4, 5e-4], 100.0), 3.18309886173e-11),
    ] {
        rendered(case, what, &lit(0.5, 1e-3, vec![light]), exact, 1e-3);
    }
    for h in [1e-4, 1e-6, 1e-9] {
        let above = lit(0.5 * h, 0.01 * h, vec![ceiling([-5.0, 5.0], [-5.0, 5.0], h)]);
        rendered(case, &format!("10 x 10 at {h:e}"), &above, 1.0 - 3.27323954363e-2 * h * h, 1e-3);
    }
    let beside = lit(5e-5, 1e-6, vec![ceiling([1e-3, 10.001], [-5.0, 5.0], 1e-4)]);
    rendered(case, "10 x 10 at 1e-4, 1e-3 outside", &beside, 0.00248140478533, 1e-3);
    let strip = lit(2.5e-2, 1e-3, vec![ceiling([-0.5, 0.5], [-5e-7, 5e-7], 5e-2)]);
    let polygon = [[-0.5, -5e-7], [-0.5, 5e-7], [0.5, 5e-7], [0.5, -5e-7]].map(|[x, y]| DVec3::new(x, y, 5e-2));
    let exact = polygon_factor(DVec3::ZERO, DVec3::Z, &polygon);
    rendered(case, "strip of 1e6 : 1 at 1/20 of its length", &strip, exact, 1e-3);
}

/// Light and receiver moved together, by multiples of what single precision holds there.
fn far_from_the_origin(case: &mut Case) {
    for away in [1e4_f32, 1e6] {
        let shift = Vec3::new(away, -0.5 * away, 0.25 * away);
        for height in [0.125, 1.0, 4.0, 64.0] {
            let polygon: Vec<Vec3> =
                overhead([-1.0, 0.5], [-0.5, 1.5], height).into_iter().map(|v| v + shift).collect();
            let exact = polygon_factor(shift.as_dvec3(), DVec3::Z, &in_double(&polygon));
            let found = irradiance(case, &EmitterSet::new(fan(&polygon)), shift, DVec3::Z);
            case.mean(format!("moved by {away:e}, light at {height}"), found, exact, 1e-3);
            let centre = shift.as_dvec3() + f64::from(height) * DVec3::Z;
            let ball = EmitterSet::new(vec![super::sphere_light(centre, 0.5 * f64::from(height))]);
            case.mean(
                format!("moved by {away:e}, ball at {height}"),
                irradiance(case, &ball, shift, DVec3::Z),
                0.25,
                1e-3,
            );
        }
    }
}

fn disc(case: &mut Case) {
    // A fan of triangles; the receiver sees a polygon, whose factor is off the disc's by its missing segments.
    let corners = case.count(1 << 10, 1 << 14) as usize;
    let missing = 2.0 * (PI / corners as f64).powi(2);
    for (what, h, offset, exact) in
        [("on the axis, at 2", 2.0, 0.0, 0.2), ("2 off the axis, at 1", 1.0, 2.0, 0.0527864045000)]
    {
        let polygon: Vec<Vec3> = regular(corners, h).into_iter().map(|v| v + Vec3::X * offset).collect();
        let formula = polygon_factor(DVec3::ZERO, DVec3::Z, &in_double(&polygon));
        case.exact(format!("{what}: formula"), formula, exact, Within::Relative(missing));
        // Around its middle, as a modelling program would.
        let middle = Vec3::new(offset, 0.0, h);
        let slices = (0..corners).flat_map(|k| fan(&[middle, polygon[k], polygon[(k + 1) % corners]]));
        case.mean(what, irradiance(case, &EmitterSet::new(slices.collect()), Vec3::ZERO, DVec3::Z), formula, 1e-3);
    }
}
