//! Balls of extreme sizes and distances, from inside and outside, and where they meet meshes.

use etendue::desc::{MeshDesc, ShapeDesc};
use etendue::math::{DAffine3, DMat3, DQuat, DVec3, Frame, Ray};
use etendue::sampling::warps;
use etendue::scene::Scene;

use super::{
    BALL, EVERYWHERE, PLACES, ball, build, in_cube, is_near, on_sphere, range, ray, shapes, tally, unit, worst,
};
use crate::record::{Case, Entry, Within, ulp};

pub fn cases() -> Vec<Entry> {
    vec![
        Entry { id: "I7", title: "small ball, far", run: small_and_far },
        Entry { id: "I7a", title: "radius against distance", run: ratios },
        Entry { id: "I8", title: "huge ball as ground", run: huge_ground },
        Entry { id: "I9", title: "from inside and from the surface", run: inside_and_on },
        Entry { id: "I10", title: "tangents of a ball", run: tangents },
        Entry { id: "I14", title: "ball meets mesh", run: ball_meets_mesh },
    ]
}

/// A ball as a sphere and as a quadric, in the list and in the tree. A speck aside keeps the frame's origin at 0.
fn balls(centre: DVec3, radius: f64) -> Vec<Scene> {
    let aside = DVec3::new(-5.0, 5.0, -5.0);
    let speck = ShapeDesc::Triangle([aside, aside - 0.1 * DVec3::X, aside + 0.1 * DVec3::Y]);
    let mut found = Vec::new();
    for (listed, _) in PLACES {
        found.push(build(&shapes(DVec3::ZERO, vec![speck, ShapeDesc::Sphere { centre, radius }]), listed));
        let quadric = ShapeDesc::Quadric { coefficients: BALL, clip: EVERYWHERE };
        let mut desc = shapes(DVec3::ZERO, vec![speck, quadric]);
        desc.surfaces[1].transform =
            DAffine3::from_scale_rotation_translation(DVec3::splat(radius), DQuat::IDENTITY, centre);
        found.push(build(&desc, listed));
    }
    assert!(found.iter().all(|scene| scene.centre() == DVec3::ZERO));
    found
}

fn t(scene: &Scene, ray: &Ray) -> f64 {
    scene.intersect(ray).map_or(f64::NAN, |hit| f64::from(hit.t))
}

/// Length of the difference between the normal where the ray hits and `expected`.
fn normal_off(scene: &Scene, ray: &Ray, expected: DVec3) -> f64 {
    let hit = scene.intersect(ray);
    hit.map_or(f64::NAN, |hit| (scene.interaction(ray, &hit).ng.as_dvec3() - expected).length())
}

fn small_and_far(case: &mut Case) {
    for (distance, expected) in
        [(1e2, 99.751_960_814_587_69), (1e4, 9_999.751_960_814_588), (1e6, 999_999.751_960_814_6)]
    {
        let scenes = balls(DVec3::Z * distance, 1.0);
        let at = ray(DVec3::X * 0.96875, DVec3::Z);
        let found = worst(scenes.iter().map(|scene| t(scene, &at)), expected);
        case.exact(format!("{distance:e} away: t"), found, expected, Within::Ulps(1.0));
        let normal = DVec3::new(0.96875, 0.0, -0.248_039_185_412_31);
        let off = worst(scenes.iter().map(|scene| normal_off(scene, &at, normal)), 0.0);
        case.exact(format!("{distance:e} away: normal"), off, 0.0, Within::Absolute(1e-6));
        let tries = case.count(10_000, 1_000_000);
        let [beside, at_rim] = tally(tries, 70, |rng| {
            let axis = [DVec3::X, DVec3::NEG_X, DVec3::Y, DVec3::NEG_Y][(rng.next_u64() & 3) as usize];
            let scene = &scenes[(rng.next_u64() & 3) as usize];
            // The rim of the radius 1, in units of its last place.
            let rim = 1.0 + f64::from(f32::EPSILON) * range(rng, 1.0, 40.0).floor() * (1.0 - 2.0 * unit(rng).round());
            let beside = 1.0 + 0.01 * (1.0 - 2.0 * unit(rng).round());
            [beside, rim].map(|x| {
                let ray = ray(axis * x, DVec3::Z);
                scene.intersect(&ray).is_some() != (x < 1.0) || scene.unoccluded(&ray) == (x < 1.0)
            })
        });
        case.never(format!("{distance:e} away: hit or miss wrong 1 % beside the rim"), beside, tries);
        case.never(format!("{distance:e} away: hit or miss wrong 1 to 40 ulp beside it"), at_rim, tries);
    }
}

/// t of rays parallel to the line of centres, whose exact value has a short form.
fn ratios(case: &mut Case) {
    for (radius, distance) in
        [(1e-6, 1.0), (1e-3, 1e3), (1e3, 1e9), (1e6, 1e12), (1e6, 1e6 + 1.0), (1.0, 1.0 + 1e-6), (1e-3, 1e-3 + 1e-9)]
    {
        let scenes = balls(DVec3::Z * distance, radius);
        let tries = case.count(2000, 1_000_000);
        // Half a place is the rounding of t itself.
        let [off] = tally(tries, 71, |rng| {
            let x = f64::from((radius * range(rng, 0.0, 0.999)) as f32);
            let exact = distance - ((radius - x) * (radius + x)).sqrt();
            let found = t(&scenes[(rng.next_u64() & 3) as usize], &ray(DVec3::Y * x, DVec3::Z));
            [!is_near(found, exact, ulp(exact))]
        });
        case.never(format!("radius {radius:e}, {distance} to the centre: t off by > 1 ulp"), off, tries);
    }
}

fn huge_ground(case: &mut Case) {
    // The eye at the origin, one above the ball.
    let (radius, centre) = (1e6, DVec3::NEG_Y * 1_000_001.0);
    let scenes = balls(centre, radius);
    let down = |angle: f64| ray(DVec3::ZERO, DVec3::new(angle.cos(), -angle.sin(), 0.0));
    for (degrees, expected) in [(45.0_f64, 1.414_214_269_48), (10.0, 5.758_863_097_05), (1.0, 57.393_029_544_3)] {
        let ray = down(degrees.to_radians());
        let found = worst(scenes.iter().map(|scene| t(scene, &ray)), expected);
        case.exact(format!("{degrees} degrees down: t"), found, expected, Within::Relative(1e-5));
        let off = |scene: &Scene| {
            let Some(hit) = scene.intersect(&ray) else { return f64::NAN };
            scene.interaction(&ray, &hit).point.p.as_dvec3().distance(centre) - radius
        };
        let off = worst(scenes.iter().map(off), 0.0);
        case.exact(format!("{degrees} degrees down: hit point off the ball"), off, 0.0, Within::Absolute(1e-6));
    }
    let horizons = scenes.iter().map(|scene| {
        let (mut sky, mut ground) = (0.0, 0.1);
        while ground - sky > 1e-12 {
            let middle = 0.5 * (sky + ground);
            *(if scene.intersect(&down(middle)).is_some() { &mut ground } else { &mut sky }) = middle;
        }
        ground
    });
    let dip = 1.414_212_973_12e-3;
    let horizons: Vec<f64> = horizons.collect();
    case.exact("dip of the horizon", worst(horizons.iter().copied(), dip), dip, Within::Relative(1e-6));
    // A direction is rounded to 6e-8 of its slope, so the last ray that hits is up to 1e-10 below the tangent, and meets
    // the ball up to (2 R^2 1e-10 dip)^(1/2) = 0.5 before it, over the distance of 1414.
    let distances = scenes.iter().zip(&horizons).map(|(scene, horizon)| t(scene, &down(*horizon)));
    case.exact("distance of the horizon", worst(distances, 1_414.213_915_93), 1_414.213_915_93, Within::Relative(1e-3));
}

/// A scene of one unit ball under a transform.
fn transformed_ball(transform: DAffine3, listed: usize) -> Scene {
    let mut desc = shapes(DVec3::ZERO, vec![ShapeDesc::Sphere { centre: DVec3::ZERO, radius: 1.0 }]);
    desc.surfaces[0].transform = transform;
    build(&desc, listed)
}

fn inside_and_on(case: &mut Case) {
    let scenes = balls(DVec3::ZERO, 1.0);
    let tries = case.count(20_000, 4_000_000);
    let [from_centre, inwards, second] = tally(tries, 90, |rng| {
        let scene = &scenes[(rng.next_u64() & 3) as usize];
        let is_off = |ray: &Ray, exact: f64| !is_near(t(scene, ray), exact, 2.0 * ulp(exact));
        let from_centre = ray(DVec3::ZERO, on_sphere(rng));
        let length = |ray: &Ray| ray.direction.as_dvec3().length();
        // Entered as the library does it, a step off the surface.
        let (origin, target) = (3.0 * on_sphere(rng), 0.9 * on_sphere(rng));
        let through = ray(origin, target - origin);
        let surface = scene.intersect(&through).map(|hit| scene.interaction(&through, &hit));
        let Some(surface) = surface else { return [true; 3] };
        let aside = on_sphere(rng).as_vec3a();
        let inwards = if aside.dot(surface.ng) > 0.0 { -aside } else { aside };
        let inwards = Ray::new(surface.point.offset(-surface.ng), inwards);
        // Beyond the first crossing there is the second.
        let crossings = |ray: &Ray| {
            let (o, d) = (ray.origin.as_dvec3(), ray.direction.as_dvec3());
            let foot = -o.dot(d) / d.length_squared();
            let nearest = (o + foot * d).length();
            let half = ((1.0 - nearest) * (1.0 + nearest) / d.length_squared()).sqrt();
            [foot - half, foot, foot + half]
        };
        let [first, foot, last] = crossings(&through);
        let second = Ray { tnear: foot as f32, ..through };
        // At less than a tenth of a degree, a step off the surface may lead out again.
        let is_steep = inwards.direction.dot(surface.ng) < -2e-3;
        [
            is_off(&from_centre, 1.0 / length(&from_centre)),
            is_steep && is_off(&inwards, crossings(&inwards)[2]),
            is_off(&second, last) || is_off(&through, first),
        ]
    });
    case.never("from the centre: t = 1 off by > 2 ulp", from_centre, tries);
    case.never("from the surface: t = 2 cos off by > 2 ulp", inwards, tries);
    case.never("either crossing off by > 2 ulp", second, tries);

    let rounds = case.count(24, 400);
    let (mut again, mut wrong_side, mut total) = (0, 0, 0);
    for round in 0..rounds {
        let mut rng = etendue::sampling::Rng::new(91, round);
        let size = 10_f64.powf(range(&mut rng, -4.0, 4.0));
        let rotation = DQuat::from_scaled_axis(on_sphere(&mut rng) * range(&mut rng, 0.0, 3.0));
        // Every other ball stays round; the others are stretched and sheared.
        let shape = if round % 2 == 0 {
            DMat3::from_quat(rotation)
        } else {
            DMat3::from_cols(in_cube(&mut rng, 1.0), in_cube(&mut rng, 1.0), in_cube(&mut rng, 1.0))
                + DMat3::IDENTITY * 1.5
        };
        let place = DAffine3::from_mat3_translation(size * shape, 3.0 * size * in_cube(&mut rng, 1.0));
        let scene = transformed_ball(place, PLACES[(round / 2 % 2) as usize].0);
        let tries = case.count(500, 25_000);
        total += tries;
        let [re_hit, inwards] = tally(tries, 92 + round, |rng| {
            let in_scene = |p: DVec3| scene.to_scene(place.transform_point3(p));
            let (origin, target) = (in_scene(3.0 * on_sphere(rng)), in_scene(0.9 * on_sphere(rng)));
            let ray = Ray::new(origin, (target - origin).normalize());
            let Some(hit) = scene.intersect(&ray) else { return [true, true] };
            let surface = scene.interaction(&ray, &hit);
            let away = Frame::from_normal(surface.ng).to_world(warps::uniform_hemisphere(rng.next_2d()));
            let leaving = Ray::new(surface.point.offset(surface.ng), away);
            let entering = Ray::new(surface.point.offset(-surface.ng), -away);
            // Entering at less than half a degree, a step off the surface may lead out again.
            let is_steep = away.dot(surface.ng) > 0.01;
            [scene.intersect(&leaving).is_some(), is_steep && scene.intersect(&entering).is_none()]
        });
        again += re_hit;
        wrong_side += inwards;
    }
    case.never("left outwards under any transform: met again", again, total);
    case.never("entered under any transform: other side missed", wrong_side, total);
}

fn tangents(case: &mut Case) {
    let scenes = balls(DVec3::ZERO, 1.0);
    let below_one = 1.0 - 0.5 * f64::from(f32::EPSILON);
    for (name, b) in [("0.999999", f64::from(0.999_999_f32)), ("1 - 2^-24", below_one)] {
        let half = ((1.0 - b) * (1.0 + b)).sqrt();
        // From the middle of the chord, so that t is its half and keeps all digits.
        let ray = ray(DVec3::Y * b, DVec3::X);
        let found = worst(scenes.iter().map(|scene| t(scene, &ray)), half);
        case.exact(format!("b = {name}: half chord"), found, half, Within::Ulps(1.0));
        let normal = DVec3::new(half, b, 0.0);
        let off = worst(scenes.iter().map(|scene| normal_off(scene, &ray, normal)), 0.0);
        case.exact(format!("b = {name}: normal"), off, 0.0, Within::Absolute(1e-6));
        let entering = Ray::new((DVec3::Y * b - 2.0 * DVec3::X).as_vec3a(), ray.direction);
        let faces = |scene: &Scene| {
            let hit = scene.intersect(&entering);
            hit.is_some_and(|hit| scene.interaction(&entering, &hit).ng.dot(entering.direction) <= 0.0)
        };
        let away = scenes.iter().filter(|scene| !faces(scene)).count() as u64;
        case.never(format!("b = {name}, from outside: normal looks away"), away, scenes.len() as u64);
    }
    let above_one = ray(DVec3::new(-1.0, 1.0 + f64::from(f32::EPSILON), 0.0), DVec3::X);
    let hits = scenes.iter().filter(|scene| scene.intersect(&above_one).is_some()).count() as u64;
    case.never("b = 1 + 2^-23: hits", hits, scenes.len() as u64);

    let tries = case.count(20_000, 4_000_000);
    let [not_finite, not_unit, not_facing] = tally(tries, 100, |rng| {
        let scene = &scenes[(rng.next_u64() & 3) as usize];
        let normal = on_sphere(rng);
        let along = normal.cross(on_sphere(rng)).normalize();
        let touching = normal * (1.0 - 10_f64.powf(range(rng, -16.0, -2.0)));
        // The speck is farther away.
        let ray = Ray { tfar: 4.0, ..ray(touching - along * range(rng, 0.0, 3.0), along) };
        let Some(hit) = scene.intersect(&ray) else { return [false; 3] };
        let surface = scene.interaction(&ray, &hit);
        let was_outside = ray.origin.as_dvec3().length() > 1.0 + 1e-6;
        [
            !surface.point.p.is_finite() || !hit.t.is_finite(),
            !is_near(surface.ng.length().into(), 1.0, 2e-7),
            was_outside && surface.ng.dot(ray.direction) > 2e-7,
        ]
    });
    case.never("nearly tangent: NaN or infinity", not_finite, tries);
    case.never("nearly tangent: normal not of unit length, 2e-7", not_unit, tries);
    case.never("nearly tangent from outside: normal looks away, 2e-7", not_facing, tries);
}

/// A floor y = 0 out to 10 with a round hole of radius 0.9.
fn floor_with_hole() -> MeshDesc {
    let mut mesh = MeshDesc { name: "floor".into(), path: "meshes[0]".into(), ..MeshDesc::default() };
    let sectors = 64_u32;
    for sector in 0..sectors {
        let (z, x) = (std::f64::consts::TAU * f64::from(sector) / f64::from(sectors)).sin_cos();
        mesh.positions.extend([0.9, 10.0].map(|r| DVec3::new(r * x, 0.0, r * z)));
    }
    for sector in 0..sectors {
        let [a, b] = [2 * sector, 2 * ((sector + 1) % sectors)];
        mesh.triangles.extend([[a, b, a + 1], [a + 1, b, b + 1]]);
    }
    mesh
}

/// A unit ball plugs the hole in a floor: seen from above, nothing below is seen.
fn ball_meets_mesh(case: &mut Case) {
    let sphere = ShapeDesc::Sphere { centre: DVec3::ZERO, radius: 1.0 };
    let quadric = ShapeDesc::Quadric { coefficients: BALL, clip: EVERYWHERE };
    let mesh = ShapeDesc::Mesh { mesh: 1, smooth: false };
    for (name, shape, listed) in [
        ("sphere in the list", sphere, 16),
        ("sphere in the tree", sphere, 0),
        ("quadric", quadric, 16),
        ("mesh", mesh, 16),
    ] {
        let mut desc = shapes(DVec3::new(0.0, 2.0, 0.0), vec![ShapeDesc::Mesh { mesh: 0, smooth: false }, shape]);
        desc.meshes = vec![floor_with_hole().into(), ball(100, 200, DVec3::ZERO).into()];
        let scene = build(&desc, listed);
        let tries = case.count(40_000, 10_000_000);
        let [leaks] = tally(tries, 140, |rng| {
            let origin = loop {
                let p = DVec3::new(range(rng, -3.0, 3.0), range(rng, 0.0, 3.0), range(rng, -3.0, 3.0));
                if p.y > 0.01 && p.length() > 1.01 {
                    break p;
                }
            };
            let (z, x) = range(rng, 0.0, std::f64::consts::TAU).sin_cos();
            // Upon the circle of contact, and to both sides of it by a millionth to a tenth.
            let r = 1.0 + [0.0, 1.0, -1.0][(rng.next_u64() % 3) as usize] * 10_f64.powf(range(rng, -7.0, -1.0));
            let (origin, target) = (scene.to_scene(origin), scene.to_scene(r * DVec3::new(x, 0.0, z)));
            let ray = Ray::new(origin, target - origin);
            // Past the floor by a thousandth it is behind it.
            let behind = Ray { tfar: 1.0 + 1e-3 / ray.direction.length().min(1.0), ..ray };
            [scene.intersect(&behind).is_none() || scene.unoccluded(&behind)]
        });
        case.never(format!("{name}: leaks at the circle of contact"), leaks, tries);
    }
}
