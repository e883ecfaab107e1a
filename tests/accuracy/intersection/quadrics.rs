//! Quadrics: nearest and farthest crossings, apexes, axes, tangents and edges of their boxes.

use etendue::desc::ShapeDesc;
use etendue::math::{Bounds, DAffine3, DMat3, DQuat, DVec3, Ray};
use etendue::sampling::Rng;
use etendue::scene::Scene;

use super::{PLACES, build, in_cube, is_near, on_sphere, range, ray, shapes, tally, worst};
use crate::record::{Case, Entry, Within, ulp};

pub fn cases() -> Vec<Entry> {
    vec![
        Entry { id: "I19", title: "quadrics", run: table },
        Entry { id: "I19a", title: "random quadrics in random places", run: random },
        Entry { id: "I19b", title: "tangents of quadrics", run: tangents },
        Entry { id: "I19c", title: "apex of a cone", run: apex },
        Entry { id: "I19d", title: "small quadrics, far", run: small_and_far },
    ]
}

const CYLINDER: [f64; 10] = [1.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, -1.0];
const PARABOLOID: [f64; 10] = [1.0, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, -0.5, 0.0];
const HYPERBOLOID: [f64; 10] = [1.0, 1.0, -1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, -1.0];
const CONE: [f64; 10] = [1.0, 1.0, -1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0];
const ELLIPSOID: [f64; 10] = [1.0 / 9.0, 1.0, 1e4, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, -1.0];

/// A quadric from -20 to 20 around the frame's origin, in the list and in the tree.
fn both(coefficients: [f64; 10]) -> [Scene; 2] {
    let clip = Bounds { min: DVec3::splat(-20.0), max: DVec3::splat(20.0) };
    PLACES.map(|(listed, _)| {
        let scene = build(&shapes(DVec3::ZERO, vec![ShapeDesc::Quadric { coefficients, clip }]), listed);
        assert_eq!(scene.centre(), DVec3::ZERO);
        scene
    })
}

fn gradient([a, b, c, d, e, f, g, h, i, _]: [f64; 10], p: DVec3) -> DVec3 {
    DVec3::new(a * p.x + d * p.y + f * p.z + g, d * p.x + b * p.y + e * p.z + h, f * p.x + e * p.y + c * p.z + i)
}

/// Name, coefficients, origin, direction, and what is met first, and second where that has a short form.
type Row = (&'static str, [f64; 10], DVec3, DVec3, &'static [f64]);

fn table(case: &mut Case) {
    let up = DVec3::Z;
    let rows: [Row; 7] = [
        ("cylinder", CYLINDER, DVec3::new(10.0, 0.0, 0.6), DVec3::new(-1.0, 0.001, 0.0), &[9.2, 10.8]),
        (
            "paraboloid, nearly along its axis",
            PARABOLOID,
            DVec3::new(1e-4, 0.0, 5.0),
            DVec3::new(1e-3, 0.0, -1.0),
            &[4.999_973_990_265_3],
        ),
        (
            "hyperboloid",
            HYPERBOLOID,
            DVec3::new(0.0, -4.0, 2.0),
            DVec3::new(0.1, 1.0, 0.25),
            &[1.440_755_284_555_7, 8.057_925_454_230_6],
        ),
        ("ellipsoid 3, 1, 0.01", ELLIPSOID, DVec3::new(1.2, 0.3, 5.0), -up, &[4.991_339_745_962_156]),
        // From near by, so that t shows all digits of the height.
        ("ellipsoid 3, 1, 0.01, its height", ELLIPSOID, DVec3::new(1.2, 0.3, 0.0), up, &[0.008_660_254_037_844_4]),
        ("cone", CONE, DVec3::new(0.25, 0.0, -3.0), up, &[2.75, 3.25]),
        ("cone, along its side", CONE, DVec3::new(0.5, 0.0, -3.0), DVec3::new(1.0, 0.0, 1.0), &[1.25]),
    ];
    for (name, coefficients, origin, direction, expected) in rows {
        let scenes = both(coefficients);
        let mut from = ray(origin, direction);
        for (number, &expected) in expected.iter().enumerate() {
            let found = worst(
                scenes.iter().map(|scene| scene.intersect(&from).map_or(f64::NAN, |hit| f64::from(hit.t))),
                expected,
            );
            case.exact(format!("{name}: t{}", number + 1), found, expected, Within::Ulps(4.0));
            let off = scenes.iter().map(|scene| {
                let Some(hit) = scene.intersect(&from) else { return f64::NAN };
                let exact = from.origin.as_dvec3() + expected * from.direction.as_dvec3();
                (scene.interaction(&from, &hit).ng.as_dvec3() - gradient(coefficients, exact).normalize()).length()
            });
            let off = worst(off, 0.0);
            case.exact(format!("{name}: normal {}", number + 1), off, 0.0, Within::Absolute(1e-6));
            from.tnear = (expected * (1.0 + 1e-4)) as f32;
        }
    }
    let along = both(CYLINDER).map(|scene| {
        let hit = |x: f64| scene.intersect(&ray(DVec3::new(x, -30.0, 0.0), DVec3::Y)).is_some();
        u64::from(hit(0.0)) + u64::from(hit(0.5)) + u64::from(hit(1.5))
    });
    case.never("cylinder, along its axis: side met", along.iter().sum(), 6);
}

/// Random rays' crossings, against a reference in the quadric's own frame with Newton's steps.
fn random(case: &mut Case) {
    for (name, coefficients) in [
        ("ellipsoid", ELLIPSOID),
        ("cylinder", CYLINDER),
        ("cone", CONE),
        ("paraboloid", PARABOLOID),
        ("hyperboloid", HYPERBOLOID),
    ] {
        let (mut bad, mut total) = ([0; 3], 0);
        for round in 0..case.count(10, 200) {
            let mut rng = Rng::new(300, round);
            let size = 10_f64.powf(range(&mut rng, -6.0, 6.0));
            let rotation = DQuat::from_scaled_axis(on_sphere(&mut rng) * range(&mut rng, 0.0, 3.0));
            let stretch = DVec3::new(1.0, range(&mut rng, 0.2, 2.0), range(&mut rng, 0.2, 2.0));
            let place = DAffine3::from_mat3_translation(
                size * DMat3::from_quat(rotation) * DMat3::from_diagonal(stretch),
                size * 3.0 * in_cube(&mut rng, 1.0),
            );
            let clip = Bounds { min: DVec3::splat(-2.0), max: DVec3::splat(2.0) };
            let mut desc = shapes(place.translation, vec![ShapeDesc::Quadric { coefficients, clip }]);
            desc.surfaces[0].transform = place;
            let scene = build(&desc, PLACES[(round % 2) as usize].0);
            let tries = case.count(200, 20_000);
            total += tries;
            let inverse = place.inverse();
            let found: [u64; 3] = tally(tries, 301 + round, |rng| {
                let target = scene.to_scene(place.transform_point3(in_cube(rng, 1.5)));
                let origin = scene.to_scene(place.transform_point3(in_cube(rng, 8.0)));
                let ray = Ray::new(origin, (target - origin) / size as f32);
                let world = |t: f64| ray.origin.as_dvec3() + scene.centre() + t * ray.direction.as_dvec3();
                // The exact crossings, where they are told apart from a miss and from the box's faces.
                let (o, d) =
                    (inverse.transform_point3(world(0.0)), inverse.transform_vector3(ray.direction.as_dvec3()));
                let value = |p: DVec3| p.dot(gradient(coefficients, p)) + rest(coefficients, p);
                let slope = |p: DVec3| 2.0 * d.dot(gradient(coefficients, p));
                let (a, b, c) = (0.25 * (slope(d) - slope(-d)), 0.5 * slope(o), value(o));
                let discriminant = b * b - a * c;
                let size2 = b * b + (a * c).abs();
                if a.abs() < 1e-6 * d.length_squared() || discriminant.abs() < 1e-6 * size2 {
                    return [false; 3];
                }
                let mut sure = None;
                if discriminant > 0.0 {
                    let q = -(b + discriminant.sqrt().copysign(b));
                    let mut roots = [q / a, c / q];
                    roots.sort_by(f64::total_cmp);
                    // Newton's steps take away what c loses where the origin is far.
                    for _ in 0..3 {
                        roots = roots.map(|t| t - value(o + t * d) / slope(o + t * d));
                    }
                    for t in roots.into_iter().filter(|t| *t > 0.0) {
                        let reach = (o + t * d).abs().max_element();
                        if (reach - 2.0).abs() < 1e-5 {
                            return [false; 3];
                        }
                        if reach < 2.0 && sure.is_none() {
                            sure = Some(t);
                        }
                    }
                }
                let hit = scene.intersect(&ray);
                let Some((t, hit)) = sure.zip(hit) else {
                    return [sure.is_some() || hit.is_some(), false, false];
                };
                let surface = scene.interaction(&ray, &hit);
                let normal = (inverse.matrix3.transpose() * gradient(coefficients, o + t * d)).normalize();
                let off = (surface.ng.as_dvec3() - normal).length();
                // A normal turns with the point, by its rounding times the curvature; at a cone's apex without bound.
                let is_flat = (o + t * d).length() > 0.1 || coefficients[9] != 0.0;
                let limit =
                    1e-6 * stretch.max_element() / stretch.min_element() * gradient_turn(coefficients, o + t * d);
                [scene.unoccluded(&ray), (f64::from(hit.t) - t).abs() > 4.0 * ulp(t), is_flat && off > limit.max(1e-6)]
            });
            for (sum, found) in bad.iter_mut().zip(found) {
                *sum += found;
            }
        }
        case.never(format!("{name}, 1e-6 to 1e6 in size: hit or miss wrong"), bad[0], total);
        case.never(format!("{name}: t off by > 4 ulp"), bad[1], total);
        case.never(format!("{name}: normal off by > 1e-6, times its turn"), bad[2], total);
    }
}

/// The part of the quadric that is not the point times its gradient.
fn rest([.., g, h, i, j]: [f64; 10], p: DVec3) -> f64 {
    g * p.x + h * p.y + i * p.z + j
}

/// How fast the normal turns where the quadric is crossed: the largest coefficient over the gradient.
fn gradient_turn(coefficients: [f64; 10], p: DVec3) -> f64 {
    coefficients[..3].iter().fold(0.0_f64, |m, c| m.max(c.abs())) / gradient(coefficients, p).length()
}

/// Lines a millionth beside a tangent: on one side two crossings, on the other none.
fn tangents(case: &mut Case) {
    for (name, coefficients) in
        [("cylinder", CYLINDER), ("paraboloid", PARABOLOID), ("ellipsoid 3, 1, 0.01", ELLIPSOID)]
    {
        let scenes = both(coefficients);
        let tries = case.count(4000, 2_000_000);
        let [missed, met, bad] = tally(tries, 310, |rng| {
            let scene = &scenes[(rng.next_u64() & 1) as usize];
            let (y, x) = range(rng, 0.0, std::f64::consts::TAU).sin_cos();
            let h = range(rng, 0.5, 3.0);
            let p = match coefficients {
                CYLINDER => DVec3::new(x, h, y),
                PARABOLOID => DVec3::new(h.sqrt() * x, h.sqrt() * y, h),
                _ => DVec3::new(3.0, 1.0, 0.01) * on_sphere(rng),
            };
            let normal = gradient(coefficients, p).normalize();
            let along = normal.cross(on_sphere(rng)).normalize();
            // Along a cylinder's side, a line beside it is parallel.
            let curvature = along.dot(DVec3::new(coefficients[0], coefficients[1], coefficients[2]) * along);
            if curvature < 0.05 {
                return [false; 3];
            }
            let shift = 1e-6 * p.length();
            let trace = |p: DVec3| {
                let ray = ray(p - along, along);
                scene.intersect(&ray).map(|hit| scene.interaction(&ray, &hit))
            };
            let (inner, outer) = (trace(p - shift * normal), trace(p + shift * normal));
            let is_bad =
                inner.is_some_and(|hit| !is_near(hit.ng.length().into(), 1.0, 2e-7) || !hit.point.p.is_finite());
            [inner.is_none(), outer.is_some(), is_bad]
        });
        case.never(format!("{name}, 1e-6 inside a tangent: missed"), missed, tries);
        case.never(format!("{name}, 1e-6 outside it: met"), met, tries);
        case.never(format!("{name}: NaN, or a normal not of unit length"), bad, tries);
    }
}

/// Rays through, at and beside the apex of a cone.
fn apex(case: &mut Case) {
    let scenes = both(CONE);
    let tries = case.count(4000, 2_000_000);
    let [off, bad] = tally(tries, 320, |rng| {
        let scene = &scenes[(rng.next_u64() & 1) as usize];
        // From between the halves, at the apex or beside it by 1e-9 to 1e-2.
        let from = on_sphere(rng);
        let origin = 3.0 * DVec3::new(from.x, from.y, 0.3 * from.z).normalize();
        let target = if rng.next_u64() & 1 == 0 { 0.0 } else { 10_f64.powf(range(rng, -9.0, -2.0)) } * on_sphere(rng);
        let aimed = ray(origin, target - origin);
        let Some(hit) = scene.intersect(&aimed) else { return [false; 2] };
        let surface = scene.interaction(&aimed, &hit);
        let p = surface.point.p.as_dvec3();
        [
            (p.truncate().length() - p.z.abs()).abs() > 1e-6,
            !surface.point.p.is_finite() || !is_near(surface.ng.length().into(), 1.0, 2e-7),
        ]
    });
    case.never("hit point off the cone by > 1e-6", off, tries);
    case.never("NaN, or a normal not of unit length", bad, tries);
    let through = worst(
        scenes.iter().map(|scene| {
            let axis = ray(DVec3::NEG_Z * 3.0, DVec3::Z);
            scene.intersect(&axis).map_or(f64::NAN, |hit| f64::from(hit.t))
        }),
        3.0,
    );
    case.exact("along the axis: t", through, 3.0, Within::Ulps(4.0));
    let [missed] = tally(tries, 321, |rng| {
        let scene = &scenes[(rng.next_u64() & 1) as usize];
        // Within the cone: any ray from there to the apex meets it there at last.
        let (y, x) = range(rng, 0.0, std::f64::consts::TAU).sin_cos();
        let r = range(rng, 0.0, 2.9);
        let origin = DVec3::new(r * x, r * y, -3.0).as_vec3a().as_dvec3();
        let aimed = ray(origin, -origin);
        [scene.intersect(&aimed).is_none_or(|hit| (hit.t - 1.0).abs() > 1e-3)]
    });
    case.never("from within the cone at its apex: missed", missed, tries);
}

/// A tube as far away as a hundred to a million of its radii.
fn small_and_far(case: &mut Case) {
    for distance in [1e2, 1e4, 1e6] {
        let clip = Bounds { min: DVec3::splat(-2.0), max: DVec3::splat(2.0) };
        // Off to the side, so that the frame's origin stays where the rays start.
        let speck =
            ShapeDesc::Triangle([DVec3::NEG_ONE * 5.0, DVec3::new(-5.0, -4.0, -5.0), DVec3::new(-4.0, -5.0, -5.0)]);
        let scenes = PLACES.map(|(listed, _)| {
            let quadric = ShapeDesc::Quadric { coefficients: CYLINDER, clip };
            let mut desc = shapes(DVec3::ZERO, vec![speck, quadric]);
            desc.surfaces[1].transform = DAffine3::from_translation(DVec3::Z * distance);
            let scene = build(&desc, listed);
            assert_eq!(scene.centre(), DVec3::ZERO);
            scene
        });
        let at = ray(DVec3::new(0.96875, 0.5, 0.0), DVec3::Z);
        let expected = distance - 0.248_039_185_412_31;
        let found = scenes.iter().map(|scene| scene.intersect(&at).map_or(f64::NAN, |hit| f64::from(hit.t)));
        case.exact(format!("cylinder, {distance:e} away: t"), worst(found, expected), expected, Within::Ulps(1.0));
        let off = scenes.iter().map(|scene| {
            let Some(hit) = scene.intersect(&at) else { return f64::NAN };
            let normal = DVec3::new(0.96875, 0.0, -0.248_039_185_412_31);
            (scene.interaction(&at, &hit).ng.as_dvec3() - normal).length()
        });
        case.exact(format!("cylinder, {distance:e} away: normal"), worst(off, 0.0), 0.0, Within::Absolute(1e-6));
    }
}
