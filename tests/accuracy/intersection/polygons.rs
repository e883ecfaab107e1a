//! Triangles of awkward shapes, and meshes under transforms.

use etendue::desc::{MeshDesc, ShapeDesc};
use etendue::math::{DAffine3, DQuat, DVec3, Ray};
use etendue::scene::Scene;

use super::{PLACES, ball, below, build, cube, in_cube, mesh_scene, on_sphere, range, ray, shapes, tally, unit, worst};
use crate::record::{Case, Entry, Within, ulp};

pub fn cases() -> Vec<Entry> {
    vec![
        Entry { id: "I4", title: "needles", run: needles },
        Entry { id: "I5", title: "grazing plane", run: grazing },
        Entry { id: "I20", title: "normals under transforms", run: transforms },
        Entry { id: "I20a", title: "mixed scales", run: mixed_scales },
        Entry { id: "I20b", title: "scaling by powers of two", run: powers_of_two },
        Entry { id: "I20c", title: "scenes as large as single precision", run: largest },
    ]
}

/// A disc of needles around (0, 0, 7), of radius 5.
fn fan(count: u32) -> MeshDesc {
    let centre = DVec3::Z * 7.0;
    let mut mesh = MeshDesc { name: "fan".into(), path: "meshes[0]".into(), ..MeshDesc::default() };
    mesh.positions.push(centre);
    for i in 0..count {
        let (y, x) = (std::f64::consts::TAU * f64::from(i) / f64::from(count)).sin_cos();
        mesh.positions.push(centre + 5.0 * DVec3::new(x, y, 0.0));
        mesh.triangles.push([0, 1 + i, 1 + (i + 1) % count]);
    }
    mesh
}

fn needles(case: &mut Case) {
    let scene = build(&mesh_scene(fan(100_000), DVec3::ZERO), 16);
    // The frame's origin is in the disc; seen from seven below it.
    let eye = scene.to_scene(DVec3::ZERO).as_dvec3();
    let slanted = ray(eye, DVec3::new(0.3, 0.4, 0.75_f64.sqrt()));
    let t = scene.intersect(&slanted).map_or(f64::NAN, |hit| f64::from(hit.t));
    case.exact("fan of 1e5: t", t, 8.082_903_768_65, Within::Ulps(4.0));
    let tries = case.count(10_000, 1_000_000);
    let [missed, off] = tally(tries, 400, |rng| {
        // The rim is a polygon, inside the circle by 2e-9 of it.
        let (r, angle) = (4.999 * unit(rng).sqrt().max(0.01), range(rng, 0.0, std::f64::consts::TAU));
        let target = DVec3::new(r * angle.cos(), r * angle.sin(), 7.0);
        let ray = ray(eye, target.normalize());
        let exact = 7.0 / f64::from(ray.direction.z);
        let found = scene.intersect(&ray).map(|hit| f64::from(hit.t));
        let is_off = found.is_some_and(|t| (t - exact).abs() > 4.0 * ulp(exact));
        // The boxes of needles overlap, and rays are slow: shadow rays are tried now and then.
        [found.is_none() || (rng.next_u64().is_multiple_of(16) && scene.unoccluded(&ray)), is_off]
    });
    case.never("fan of 1e5, off its centre: misses", missed, tries);
    case.never("fan of 1e5, off its centre: t off by > 4 ulp", off, tries);

    let tries = case.count(2000, 100_000);
    let mut rng = etendue::sampling::Rng::new(401, 0);
    let (mut hits, mut tilted) = (0, 0);
    for _ in 0..20 {
        let (along, aside) = (in_cube(&mut rng, 1.0).normalize(), in_cube(&mut rng, 1.0));
        let width = along.cross(aside).normalize() * 1e-6;
        let corners = [DVec3::ZERO, along, along * 0.5 + width].map(|p| p.as_vec3a().as_dvec3());
        let normal = (corners[1] - corners[0]).cross(corners[2] - corners[0]).normalize();
        let scene = build(&shapes(DVec3::ZERO, vec![ShapeDesc::Triangle(corners)]), 16);
        let corners = corners.map(|p| scene.to_scene(p).as_dvec3());
        for _ in 0..tries / 20 {
            let (u, v) = (unit(&mut rng), unit(&mut rng));
            let (u, v) = if u + v > 1.0 { (1.0 - u, 1.0 - v) } else { (u, v) };
            let target = corners[0] + u * (corners[1] - corners[0]) + v * (corners[2] - corners[0]);
            let origin = target + 2.0 * on_sphere(&mut rng);
            let ray = ray(origin, target - origin);
            let Some(hit) = scene.intersect(&ray) else { continue };
            hits += 1;
            let ng = scene.interaction(&ray, &hit).ng.as_dvec3();
            tilted += u64::from(ng.cross(normal).length() > 1e-3);
        }
    }
    case.never("a million to one: normal off by > 1e-3", tilted, hits);
}

/// Two triangles, 2000 by 2000, one below the eye.
fn grazing(case: &mut Case) {
    let corner = |x: f64, z: f64| DVec3::new(1000.0 * x, 0.0, 1000.0 * z);
    let plane = ShapeDesc::Quad([corner(-1.0, -1.0), corner(-1.0, 1.0), corner(1.0, 1.0), corner(1.0, -1.0)]);
    let scene = build(&shapes(DVec3::Y, vec![plane]), 16);
    let eye = scene.to_scene(DVec3::Y).as_dvec3();
    for (degrees, expected) in [(1.0_f64, 57.298_688_498_6), (0.1, 572.958_086_019), (0.06, 954.929_833_084)] {
        let (sin, cos) = degrees.to_radians().sin_cos();
        let t = |azimuth: f64| {
            let ray = ray(eye, DVec3::new(cos * azimuth.cos(), -sin, cos * azimuth.sin()));
            scene.intersect(&ray).map_or(f64::NAN, |hit| f64::from(hit.t))
        };
        let found = worst((0..1000).map(|i| t(0.0062831 * f64::from(i))), expected);
        case.exact(format!("{degrees} degrees down: t"), found, expected, Within::Relative(4e-7 * expected));
    }
    let tries = case.count(20_000, 10_000_000);
    let [missed, missed_diagonal] = tally(tries, 500, |rng| {
        let anywhere = DVec3::new(range(rng, -999.0, 999.0), -1.0, range(rng, -999.0, 999.0));
        let along = range(rng, -999.0, 999.0);
        // The plane's diagonal, and the one that crosses it.
        let on_diagonal = DVec3::new(along, -1.0, if below(rng, 2) == 0 { along } else { -along });
        [anywhere, on_diagonal].map(|way| {
            let ray = Ray::new(eye.as_vec3a(), way.as_vec3a());
            scene.intersect(&ray).is_none() || scene.unoccluded(&ray)
        })
    });
    case.never("random points of the plane: misses", missed, tries);
    case.never("points of its diagonals: misses", missed_diagonal, tries);
}

/// How far the normals that rays find are from right angles with the edges, and how many look inwards.
fn off_normals(scene: &Scene, place: &DAffine3, mesh: &MeshDesc, is_copied: bool, tries: u64) -> (f64, u64, u64) {
    let mut rng = etendue::sampling::Rng::new(200, 0);
    let (mut worst, mut inwards, mut hits) = (0.0_f64, 0, 0);
    // A copied mesh is what its corners are after rounding.
    let corner = |i: u32| {
        let exact = place.transform_point3(mesh.positions[i as usize]) - scene.centre();
        if is_copied { exact.as_vec3a().as_dvec3() } else { exact }
    };
    for _ in 0..tries {
        let triangle = mesh.triangles[below(&mut rng, mesh.triangles.len())];
        let own = triangle.iter().map(|&i| mesh.positions[i as usize]).sum::<DVec3>() / 3.0;
        let (from, to) = (place.transform_point3(own * range(&mut rng, 2.0, 4.0)), place.transform_point3(own));
        let (origin, to) = (scene.to_scene(from), scene.to_scene(to));
        let ray = Ray::new(origin, (to - origin).normalize());
        let Some(hit) = scene.intersect(&ray) else { continue };
        hits += 1;
        let surface = scene.interaction(&ray, &hit);
        let met = scene.describe_hit(&ray, &hit).primitive;
        let [a, b, c] = mesh.triangles[met as usize].map(corner);
        let outwards = mesh.triangles[met as usize].iter().map(|&i| mesh.positions[i as usize]).sum::<DVec3>();
        for edge in [b - a, c - b, a - c] {
            worst = worst.max(surface.ng.as_dvec3().dot(edge.normalize()).abs());
        }
        inwards += u64::from(surface.ng.as_dvec3().dot(place.transform_vector3(outwards)) <= 0.0);
    }
    (worst, inwards, hits)
}

fn transforms(case: &mut Case) {
    // Normals outwards.
    let mut mesh = cube(DVec3::ZERO);
    for triangle in &mut mesh.triangles {
        triangle.swap(1, 2);
    }
    let rotation = |angle: f64| DAffine3::from_quat(DQuat::from_scaled_axis(angle * DVec3::new(0.3, 0.8, -0.5)));
    let scale = |x: f64, y: f64, z: f64| DAffine3::from_scale(DVec3::new(x, y, z));
    let squash = rotation(1.1) * scale(1.0, 1e3, 1e-3) * rotation(0.4);
    let mirror = rotation(0.7) * scale(-1.0, 1e3, 1e-3) * rotation(2.0);
    let inside_out = scale(-2.0, -2.0, -2.0) * rotation(0.2);
    // What the kernel would invert badly is copied, however many triangles there are.
    for (name, place, inverts_well) in [
        ("scaled by 1, 1e3, 1e-3", squash, false),
        ("mirrored and scaled", mirror, false),
        ("inverted", inside_out, true),
        ("turned and scaled", rotation(0.9) * scale(1.0, 1e3, -1e-3), true),
    ] {
        for (kind, dynamic) in [("12 triangles", false), ("192 triangles", true)] {
            // An instance needs some triangles.
            let mut mesh = mesh.clone();
            if dynamic {
                mesh = subdivided(&subdivided(&mesh));
            }
            let mut desc = mesh_scene(mesh.clone(), DVec3::ZERO);
            desc.surfaces[0].transform = place;
            let options = etendue::scene::BuildOptions { dynamic, ..Default::default() };
            let scene = Scene::build(&desc, &options).expect("a scene of the test");
            assert_eq!(scene.info().instances, usize::from(dynamic && inverts_well));
            let tries = case.count(500, 100_000);
            let (off, inwards, hits) = off_normals(&scene, &place, &mesh, !dynamic, tries);
            case.exact(format!("{name}, {kind}: normal times edge"), off, 0.0, Within::Absolute(1e-5));
            case.never(format!("{name}, {kind}: normals inwards"), inwards, hits);
        }
        // A ball under the same transform is an ellipsoid.
        for (listed, kind) in PLACES {
            let mut desc = shapes(DVec3::ZERO, vec![ShapeDesc::Sphere { centre: DVec3::ZERO, radius: 1.0 }]);
            desc.surfaces[0].transform = place;
            let scene = build(&desc, listed);
            let tries = case.count(1000, 1_000_000);
            let [off] = tally(tries, 201, |rng| {
                let own = on_sphere(rng);
                let (from, to) = (place.transform_point3(3.0 * own), place.transform_point3(0.5 * own));
                let (origin, to) = (scene.to_scene(from), scene.to_scene(to));
                let ray = Ray::new(origin, (to - origin).normalize());
                let Some(hit) = scene.intersect(&ray) else { return [true] };
                let surface = scene.interaction(&ray, &hit);
                // Two tangents at the point where the exact ray meets the surface.
                let inverse = place.inverse();
                let o = inverse.transform_point3(ray.origin.as_dvec3() + scene.centre());
                let d = inverse.transform_vector3(ray.direction.as_dvec3());
                let foot = -o.dot(d) / d.length_squared();
                let nearest = o + foot * d;
                let half = ((1.0 - nearest.length()) * (1.0 + nearest.length()) / d.length_squared()).sqrt();
                let (s, t) = (nearest - half * d).any_orthonormal_pair();
                let tangents = [s, t].map(|tangent| place.transform_vector3(tangent).normalize());
                let ng = surface.ng.as_dvec3();
                [tangents.iter().any(|tangent| ng.dot(*tangent).abs() > 1e-5) || surface.ng.dot(ray.direction) >= 0.0]
            });
            case.never(format!("{name}, ball in the {kind}: normal off by > 1e-5"), off, tries);
        }
    }
}

/// Each triangle in four.
fn subdivided(mesh: &MeshDesc) -> MeshDesc {
    let mut fine = MeshDesc { positions: Vec::new(), triangles: Vec::new(), ..mesh.clone() };
    for triangle in &mesh.triangles {
        let [a, b, c] = triangle.map(|i| mesh.positions[i as usize]);
        let [ab, bc, ca] = [0.5 * (a + b), 0.5 * (b + c), 0.5 * (c + a)];
        for corners in [[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]] {
            let first = fine.positions.len() as u32;
            fine.positions.extend(corners);
            fine.triangles.push([first, first + 1, first + 2]);
        }
    }
    fine
}

/// A thing of a millionth on a ground of a million: neither is lost, wherever the ray starts.
fn mixed_scales(case: &mut Case) {
    let corner = |x: f64, z: f64| DVec3::new(1e6 * x, 0.0, 1e6 * z);
    let ground = ShapeDesc::Quad([corner(-1.0, -1.0), corner(-1.0, 1.0), corner(1.0, 1.0), corner(1.0, -1.0)]);
    let speck = ShapeDesc::Sphere { centre: DVec3::new(0.0, 1e-6, 0.0), radius: 1e-6 };
    let grain = ShapeDesc::Mesh { mesh: 0, smooth: false };
    let mut mesh = ball(20, 40, DVec3::ZERO);
    for p in &mut mesh.positions {
        *p = 1e-6 * (*p + DVec3::new(4.0, 1.0, 0.0));
    }
    for (listed, place) in PLACES {
        let mut desc = shapes(DVec3::new(0.0, 1e-5, 0.0), vec![ground, speck, grain]);
        desc.meshes.push(mesh.clone().into());
        let scene = build(&desc, listed);
        let tries = case.count(10_000, 2_000_000);
        let [lost_ball, lost_mesh, lost_ground] = tally(tries, 202, |rng| {
            let distance = 10_f64.powf(range(rng, -4.5, 0.0));
            let up = |rng: &mut etendue::sampling::Rng| {
                let p = on_sphere(rng);
                DVec3::new(p.x, p.y.abs() + 0.05, p.z)
            };
            let origin = scene.to_scene(distance * up(rng));
            let aim = |target: DVec3| {
                let ray = Ray::new(origin, scene.to_scene(target) - origin);
                let hit = scene.intersect(&ray);
                hit.map(|hit| scene.interaction(&ray, &hit).surface)
            };
            // What is rounded is the target, relative to where the ray starts.
            let shrink = if distance > 0.1 { 0.5 } else { 0.9 };
            let at_ball = aim(DVec3::new(0.0, 1e-6, 0.0) + shrink * 1e-6 * up(rng).normalize() * unit(rng));
            let at_mesh = aim(1e-6 * DVec3::new(4.0, 1.0, 0.0) + shrink * 1e-6 * unit(rng) * up(rng).normalize());
            let beside = aim(DVec3::new(range(rng, -1e6, 1e6), 0.0, range(rng, 1.0, 1e6)));
            // Each may stand before the other, or between.
            let is_thing = |surface: Option<u32>| matches!(surface, Some(1 | 2));
            [!is_thing(at_ball), !is_thing(at_mesh), beside.is_none()]
        });
        case.never(format!("ball of 1e-6 on a ground of 1e6, {place}: missed"), lost_ball, tries);
        // From a distance of 1, rounding is as large as its triangles.
        case.rarely(format!("mesh of 1e-6 beside it, ball in the {place}: missed"), lost_mesh, tries, 2e-5);
        case.never(format!("the ground, ball in the {place}: missed"), lost_ground, tries);
    }
}

/// Everything times 2^k: every t times 2^k, to the bit.
fn powers_of_two(case: &mut Case) {
    let listed = [16, 0];
    let scenes = |exponent: i32| {
        let scale = f64::from(exponent).exp2();
        let mut rng = etendue::sampling::Rng::new(203, 0);
        let mut all = vec![ShapeDesc::Sphere { centre: scale * DVec3::new(0.25, 0.5, 0.125), radius: 0.3 * scale }];
        let disk = ShapeDesc::Disk { centre: scale * DVec3::NEG_Y, normal: DVec3::Y, radius: 0.75 * scale };
        all.push(disk);
        for _ in 0..60 {
            let centre = in_cube(&mut rng, 1.0);
            all.push(ShapeDesc::Triangle([(); 3].map(|()| scale * (centre + in_cube(&mut rng, 0.5)))));
        }
        all.push(ShapeDesc::Sphere { centre: DVec3::ZERO, radius: 1.0 });
        let mut desc = shapes(scale * DVec3::new(0.1, 0.2, -0.3), all);
        let ellipsoid = DAffine3::from_scale_rotation_translation(
            scale * DVec3::new(0.5, 0.25, 0.1),
            DQuat::from_scaled_axis(DVec3::new(0.1, 0.7, 0.3)),
            scale * DVec3::new(-0.5, 0.25, 0.5),
        );
        desc.surfaces.last_mut().expect("a ball").transform = ellipsoid;
        (scale, listed.map(|listed| build(&desc, listed)))
    };
    let (_, reference) = scenes(0);
    for exponent in [-40, -35, -20, 20, 40] {
        let (scale, scaled) = scenes(exponent);
        let tries = case.count(5000, 1_000_000);
        let [different] = tally(tries, 204, |rng| {
            let which = below(rng, 2);
            let (origin, direction) = ((2.0 * in_cube(rng, 1.0)).as_vec3a(), on_sphere(rng).as_vec3a());
            let one = Ray::new(origin, direction);
            let other = Ray::new(origin * scale as f32, direction);
            let met = |scene: &Scene, ray: &Ray| scene.intersect(ray).map(|hit| (hit.t, scene.interaction(ray, &hit)));
            let same = match (met(&reference[which], &one), met(&scaled[which], &other)) {
                (None, None) => true,
                (Some((t, a)), Some((scaled_t, b))) => {
                    t * scale as f32 == scaled_t && a.surface == b.surface && a.point.p * scale as f32 == b.point.p
                }
                _ => false,
            };
            [!same]
        });
        let case = match exponent {
            -40 => {
                case.known("the kernel multiplies three lengths, which leaves a triangle of 1e-13 with few digits of t")
            }
            _ => &mut *case,
        };
        case.never(format!("times 2^{exponent}: another hit"), different, tries);
    }
}

/// In scenes so large that the kernel's products overflow, triangles are met or refused, never lost.
fn largest(case: &mut Case) {
    let size = 1e15;
    let far = ShapeDesc::Triangle([DVec3::splat(size), DVec3::new(size, size + 1e9, size), DVec3::splat(size + 1e9)]);
    let large = [DVec3::ZERO, DVec3::X * size, DVec3::Y * size];
    let small = large.map(|p| p * 1e-5 - DVec3::Z * 1e10);
    let as_mesh = |corners: [DVec3; 3]| {
        let mesh = MeshDesc { positions: corners.to_vec(), triangles: vec![[0, 1, 2]], ..MeshDesc::default() };
        let mut desc = shapes(DVec3::ZERO, vec![far, ShapeDesc::Mesh { mesh: 0, smooth: false }]);
        desc.meshes.push(mesh.into());
        desc
    };
    let as_triangle = |corners: [DVec3; 3]| shapes(DVec3::ZERO, vec![far, ShapeDesc::Triangle(corners)]);
    for (name, desc) in [("a triangle", as_triangle(large)), ("a mesh", as_mesh(large))] {
        let message = Scene::build(&desc, &Default::default()).err().map(|error| error.to_string());
        let is_named = message.as_ref().is_some_and(|message| message.contains("surfaces[1]"));
        let got = if is_named { "error at surfaces[1]".to_owned() } else { message.unwrap_or("a scene".to_owned()) };
        case.holds(format!("{name} of 1e15 in a scene of 1e15"), "error at surfaces[1]", got, is_named);
    }
    for (name, desc) in [("a triangle", as_triangle(small)), ("a mesh", as_mesh(small))] {
        let scene = build(&desc, 16);
        let tries = case.count(2000, 1_000_000);
        let [lost] = tally(tries, 205, |rng| {
            // Farther inside than a direction is rounded.
            let (u, v) = (range(rng, 0.25, 0.4), range(rng, 0.25, 0.4));
            let target = scene.to_scene(small[0] + u * (small[1] - small[0]) + v * (small[2] - small[0]));
            let origin = scene.to_scene(in_cube(rng, size));
            let ray = Ray::new(origin, (target - origin).normalize());
            [scene.intersect(&ray).is_none() || scene.unoccluded(&ray)]
        });
        case.never(format!("{name} of 1e10 in a scene of 1e15: missed"), lost, tries);
    }
}
