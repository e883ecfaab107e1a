//! Scenes far from the origin, and of every size.

use etendue::desc::{BsdfDesc, SceneDesc, ShapeDesc};
use etendue::math::{DAffine3, DQuat, DVec3, Ray};
use etendue::sampling::Rng;
use etendue::scene::{BuildOptions, Scene};
use etendue::spectrum::Rgb;

use super::{
    BALL, EVERYWHERE, GREY, PLACES, ball, below, build, camera, in_cube, mesh_scene, on_sphere, range, shapes, tally,
};
use crate::common::scenes::{Job, box_inside, point_light, render_scene, scene};
use crate::record::{Case, Entry};

pub fn cases() -> Vec<Entry> {
    vec![
        Entry { id: "I6", title: "far from the origin", run: far_from_the_origin },
        Entry { id: "I6a", title: "every size against double precision", run: sizes },
        Entry { id: "I6b", title: "start on an edge", run: start_on_an_edge },
    ]
}

/// A room with a sphere, an ellipsoid, a fine ball and two lamps, all coordinates multiples of 1/16, moved by `shift`.
fn room(shift: DVec3) -> SceneDesc {
    let lamp = [(-0.25, -0.25), (0.25, -0.25), (0.25, 0.25), (-0.25, 0.25)];
    let lamp = ShapeDesc::Quad(lamp.map(|(x, z)| shift + DVec3::new(x, 0.9375, z)));
    let mut desc = scene(
        camera(shift + DVec3::new(0.0, 0.0, 0.875), shift + DVec3::NEG_Z),
        vec![
            (ShapeDesc::Mesh { mesh: 0, smooth: false }, BsdfDesc::Lambert { albedo: Rgb::new(0.7, 0.5, 0.3) }, None),
            (lamp, GREY, Some(Rgb::splat(3.0))),
            (ShapeDesc::Sphere { centre: shift + DVec3::new(0.5, -0.5, 0.0), radius: 0.25 }, GREY, None),
            (ShapeDesc::Quadric { coefficients: BALL, clip: EVERYWHERE }, GREY, None),
            (ShapeDesc::Mesh { mesh: 1, smooth: true }, BsdfDesc::Dielectric { ior: 1.5, exterior_ior: 1.0 }, None),
        ],
    );
    desc.surfaces[3].transform = DAffine3::from_scale_rotation_translation(
        DVec3::new(0.25, 0.5, 0.125),
        DQuat::from_rotation_z(0.5),
        shift + DVec3::new(-0.5, -0.25, -0.5),
    );
    desc.surfaces[4].transform = DAffine3::from_scale_rotation_translation(
        DVec3::splat(0.25),
        DQuat::IDENTITY,
        shift + DVec3::new(0.0, 0.25, -0.5),
    );
    desc.meshes = vec![
        box_inside(shift - DVec3::ONE, shift + DVec3::ONE).into(),
        // In its own frame; its vertices are placed in double precision.
        ball(20, 40, DVec3::ZERO).into(),
    ];
    desc.lights.push(point_light(shift + DVec3::new(-0.5, 0.5, 0.25), 0.25));
    desc
}

fn bits(desc: &SceneDesc, dynamic: bool) -> Vec<u32> {
    let options = BuildOptions { dynamic, ..BuildOptions::default() };
    let scene = Scene::build(desc, &options).expect("a room");
    let job = Job { resolution: [24, 24], samples: 4, ..Job::default() };
    render_scene(&scene, job.desc()).0.rgb.iter().map(|value| value.to_bits()).collect()
}

fn far_from_the_origin(case: &mut Case) {
    for (name, dynamic) in [("copied", false), ("instances", true)] {
        let reference = bits(&room(DVec3::ZERO), dynamic);
        for far in [1e4, 1e5, 1e6, 1e9] {
            let image = bits(&room(DVec3::new(far, 0.0, -0.5 * far)), dynamic);
            let different = image.iter().zip(&reference).filter(|(a, b)| a != b).count();
            let what = format!("meshes {name}, moved by {far:e}: values that differ in a bit");
            case.never(what, different as u64, reference.len() as u64);
        }
    }
    // Edited there: what the edit built anew is where it was.
    let far = Scene::build(&room(DVec3::X * 1e6), &BuildOptions { dynamic: true, ..BuildOptions::default() });
    let edited = far.and_then(|far| far.rebuild(&room(DVec3::X * 1e6), &BuildOptions::default()));
    let job = Job { resolution: [24, 24], samples: 4, ..Job::default() };
    let image = render_scene(&edited.expect("an edited room"), job.desc()).0;
    let reference = bits(&room(DVec3::ZERO), true);
    let different = image.rgb.iter().zip(&reference).filter(|(a, b)| a.to_bits() != **b).count();
    case.never("edited at 1e6: values that differ in a bit", different as u64, reference.len() as u64);
}

/// Triangle against ray, in double precision (Möller, Trumbore 1997): t and how near to an edge; `None` off its plane.
fn exact_triangle([a, b, c]: [DVec3; 3], o: DVec3, d: DVec3) -> (f64, f64) {
    let (e1, e2) = (b - a, c - a);
    let p = d.cross(e2);
    let det = e1.dot(p);
    let s = o - a;
    let q = s.cross(e1);
    let (u, v) = (s.dot(p) / det, d.dot(q) / det);
    let inside = u.min(v).min(1.0 - u - v);
    // Seen too much from the side, nothing can be said.
    let is_steep = det.abs() > 0.02 * e1.cross(e2).length() * d.length();
    (e2.dot(q) / det, if is_steep { inside } else { 0.0 })
}

/// Scenes of triangles, spheres and ellipsoids from a millionth to 10^12.
fn sizes(case: &mut Case) {
    for size in [1e-6, 1e-3, 1.0, 1e6, 1e12] {
        let mut rng = Rng::new(60, 0);
        let triangles: Vec<[DVec3; 3]> = (0..40)
            .map(|_| {
                let centre = in_cube(&mut rng, 1.0);
                [(); 3].map(|()| size * (centre + in_cube(&mut rng, 0.6)))
            })
            .collect();
        let balls: Vec<(DVec3, f64)> =
            (0..6).map(|_| (size * in_cube(&mut rng, 1.0), size * range(&mut rng, 0.1, 0.3))).collect();
        let mut all: Vec<ShapeDesc> = triangles.iter().map(|corners| ShapeDesc::Triangle(*corners)).collect();
        all.extend(balls.iter().map(|&(centre, radius)| ShapeDesc::Sphere { centre, radius }));
        let scenes = PLACES.map(|(listed, _)| build(&shapes(DVec3::ZERO, all.clone()), listed));
        let centre = scenes[0].centre();
        let corners: Vec<[DVec3; 3]> = triangles.iter().map(|t| t.map(|p| scenes[0].to_scene(p).as_dvec3())).collect();
        let tries = case.count(6000, 1_000_000);
        let [wrong, off, decided] = tally(tries, 61, |rng| {
            let scene = &scenes[below(rng, 2)];
            let ray = Ray::new((size * in_cube(rng, 2.0)).as_vec3a(), on_sphere(rng).as_vec3a());
            let (o, d) = (ray.origin.as_dvec3(), ray.direction.as_dvec3());
            // Candidates for the nearest, and what might be one.
            let (mut nearest, mut doubtful) = (f64::INFINITY, f64::INFINITY);
            let mut note = |t: f64, inside: f64| {
                if t < 1e-4 * size || inside.abs() < 1e-3 || inside.is_nan() {
                    if t > -1e-4 * size && inside > -1e-3 {
                        doubtful = doubtful.min(t);
                    }
                } else if inside > 0.0 {
                    nearest = nearest.min(t);
                }
            };
            for corners in &corners {
                let (t, inside) = exact_triangle(*corners, o, d);
                note(t, inside);
            }
            for (ball, radius) in &balls {
                let to_origin = o - (*ball - centre);
                let foot = -to_origin.dot(d) / d.length_squared();
                let off = (to_origin + foot * d).length();
                let half = ((radius - off) * (radius + off)).max(0.0).sqrt() / d.length();
                let inside = if off < *radius { half / radius } else { (radius - off) / radius };
                note(foot - half, inside);
                note(foot + half, inside);
            }
            if doubtful <= nearest * (1.0 + 1e-3) && doubtful.is_finite() {
                return [false, false, false];
            }
            let found = scene.intersect(&ray).map(|hit| f64::from(hit.t));
            let is_wrong = found.is_some() != nearest.is_finite() || scene.unoccluded(&ray) == found.is_some();
            // Rounding of coordinates of this size, seen at 1 to 50 from the side.
            let is_off = found.is_some_and(|t| (t - nearest).abs() > 3e-5 * size);
            [is_wrong, !is_wrong && is_off, true]
        });
        assert!(decided > tries / 4, "{decided} of {tries} rays tell something");
        case.never(format!("size {size:e}: hit or miss wrong"), wrong, decided);
        case.never(format!("size {size:e}: t off by > 3e-5 of the size"), off, decided);
    }
}

/// Rays that leave from edges of a closed mesh, outwards for good, inwards to the other side.
fn start_on_an_edge(case: &mut Case) {
    let mesh = ball(50, 100, DVec3::ZERO);
    let scene = build(&mesh_scene(mesh.clone(), DVec3::ZERO), 16);
    let tries = case.count(40_000, 8_000_000);
    let [again, lost] = tally(tries, 62, |rng| {
        let [a, b, _] = mesh.triangles[below(rng, mesh.triangles.len())].map(|i| mesh.positions[i as usize]);
        let target = a.lerp(b, if below(rng, 2) == 0 { 0.5 } else { range(rng, 0.01, 0.99) });
        let origin = target * 2.0 + 0.5 * in_cube(rng, 1.0);
        let ray = Ray::new(scene.to_scene(origin), scene.to_scene(target) - scene.to_scene(origin));
        let Some(hit) = scene.intersect(&ray) else { return [false, true] };
        let surface = scene.interaction(&ray, &hit);
        // Steeper than the angle between two faces.
        let up = target.normalize();
        let away = loop {
            let w = on_sphere(rng);
            if w.dot(up).abs() > 0.1 {
                break (w * w.dot(up).signum()).as_vec3a();
            }
        };
        let outwards = Ray::new(surface.point.offset(surface.ng), away);
        let inwards = Ray::new(surface.point.offset(-surface.ng), -away);
        [scene.intersect(&outwards).is_some(), scene.intersect(&inwards).is_none_or(|hit| hit.t < 1e-3)]
    });
    case.never("outwards from an edge: met again", again, tries);
    case.never("inwards from an edge: other side lost", lost, tries);
}
