//! Irradiance against closed forms.

use std::f64::consts::PI;

use etendue::bake::{Bake, Baked, VertexOptions, Vertices, by_radiosity};
use etendue::desc::{BsdfDesc, LightDistribution, MaterialDesc, PointLightDesc, SceneDesc, ShapeDesc, SpotDesc};
use etendue::integrator::Sites;
use etendue::math::{DVec3, Vec3};
use etendue::render::Ended;
use etendue::scene::{BuildOptions, Scene};
use etendue::spectrum::Rgb;

use super::*;
use crate::stats::{SIGNIFICANCE, sidak, t_test};

/// Holds values of one channel against exact ones: each by its own standard error, and all together more closely.
///
/// `closely`: the largest relative error of the mean that is allowed whatever its standard error says.
fn assert_agrees(baked: &Baked, exact: impl Fn(usize) -> f64, closely: f64) {
    let count = baked.irradiance.len();
    let significance = sidak(SIGNIFICANCE, count);
    let (mut sum, mut expected, mut variance) = (0.0, 0.0, 0.0);
    for site in 0..count {
        let (value, error) = (f64::from(baked.irradiance[site][0]), f64::from(baked.standard_error[site][0]));
        let exact = exact(site);
        // What is exact in every sample has no error but rounding.
        let error = error.max(1e-5 * exact);
        let p = t_test((value, error), exact, 8);
        assert!(p > significance, "site {site} of {count}: {value} +- {error} and not {exact}");
        (sum, expected, variance) = (sum + value, expected + exact, variance + error * error);
    }
    let off = (sum - expected) / expected;
    let error = variance.sqrt() / expected;
    assert!(off.abs() < 4.0 * error.max(1e-6), "{off} +- {error}");
    assert!(error < closely && off.abs() < closely, "{off} +- {error}");
}

/// The mean of a function over a site, from `n` x `n` points of each piece, by area.
fn mean_over(scene: &Scene, sites: &Sites, site: usize, n: usize, f: &impl Fn(DVec3) -> f64) -> f64 {
    let mut sum = 0.0;
    let mut begin = 0.0;
    for piece in sites.pieces(site) {
        let share = f64::from(piece.until - begin);
        begin = piece.until;
        for i in 0..n * n {
            let u = [i / n, i % n].map(|k| (k as f32 + 0.5) / n as f32);
            let [b1, b2] = piece.point(u);
            let point = scene.facet_point(&sites.facets()[piece.facet as usize], b1, b2);
            sum += share * f(point.point.p.as_dvec3() + scene.centre()) / (n * n) as f64;
        }
    }
    sum
}

const GREY: BsdfDesc = BsdfDesc::Lambert { albedo: Rgb::splat(0.5) };

#[test]
fn furnace() {
    let room = scenes::box_inside(DVec3::new(-1.0, -2.0, -3.0), DVec3::new(1.0, 1.0, 2.0));
    let scene = build(&one_mesh(room, Some(Rgb::splat(2.0))));
    let atlas = atlas(&scene, 48);
    let (baked, _) = bake(&scene, atlas.sites(), settings(256, None));
    let exact = PI * 2.0 / (1.0 - 0.5);
    assert_agrees(&baked, |_| exact, 2e-3);
    // Direct light alone is the first term of the series, and two bounces are two.
    for (depth, factor) in [(1, 1.0), (2, 1.5)] {
        let (baked, _) = bake(&scene, atlas.sites(), settings(64, Some(depth)));
        assert_agrees(&baked, |_| PI * 2.0 * factor, 2e-3);
    }
}

#[test]
fn a_point_light_over_a_square() {
    let place = DVec3::new(0.3, 0.8, -0.4);
    let mut desc = scenes::scene(scenes::camera(DVec3::Y, DVec3::ZERO, 60.0), vec![(square(0.0, true), GREY, None)]);
    desc.lights = vec![scenes::point_light(place, 3.0)];
    let scene = build(&desc);
    let atlas = atlas(&scene, 36);
    let (baked, _) = bake(&scene, atlas.sites(), settings(64, None));
    let exact = |p: DVec3| {
        let to_light = place - p;
        3.0 * to_light.y / to_light.length().powi(3)
    };
    let sites = atlas.sites();
    assert_agrees(&baked, |site| mean_over(&scene, sites, site, 8, &exact), 1e-3);
    // The other side sees nothing of it.
    let mut behind = Bake::new(&scene, sites, settings(8, None), false).unwrap();
    behind.run(&mut |_| ControlFlow::Continue(())).unwrap();
    assert!(behind.irradiance().irradiance.iter().flatten().all(|&value| value == 0.0));
}

#[test]
fn a_spot_light_over_a_square() {
    let (place, axis) = (DVec3::new(0.3, 0.8, -0.4), DVec3::new(-0.3, -1.0, 0.2).normalize());
    let mut desc = scenes::scene(scenes::camera(DVec3::Y, DVec3::ZERO, 60.0), vec![(square(0.0, true), GREY, None)]);
    let spot = SpotDesc { outer_deg: 90.0, ..SpotDesc::new(2.0 * axis) };
    desc.lights =
        vec![PointLightDesc { distribution: LightDistribution::Spot(spot), ..scenes::point_light(place, 3.0) }];
    let scene = build(&desc);
    let atlas = atlas(&scene, 36);
    let (baked, _) = bake(&scene, atlas.sites(), settings(64, None));
    let exact = |p: DVec3| {
        let way = p - place;
        // The square of the cosine, whose edge is at a right angle.
        3.0 * way.normalize().dot(axis).powi(2) * -way.y / way.length().powi(3)
    };
    let sites = atlas.sites();
    assert_agrees(&baked, |site| mean_over(&scene, sites, site, 8, &exact), 1e-3);
}

/// What was baked of the first surface, and the numbers of those sites.
fn of_first_surface(atlas: &Atlas, baked: &Baked) -> (Baked, Vec<usize>) {
    let end = atlas.surfaces()[0].triangles.end;
    let numbers: Vec<usize> = (0..atlas.sites().len()).filter(|&i| atlas.sites().pieces(i)[0].facet < end).collect();
    let irradiance = numbers.iter().map(|&i| baked.irradiance[i]).collect();
    let standard_error = numbers.iter().map(|&i| baked.standard_error[i]).collect();
    (Baked { irradiance, standard_error }, numbers)
}

/// Irradiance of a polygon of radiance 1 at a point with a normal, all of the polygon above its horizon.
///
/// Source: Lambert 1760, *Photometria*; Arvo 1995, "Applications of Irradiance Tensors", Eq. 2.
fn lambert(corners: &[DVec3], p: DVec3, n: DVec3) -> f64 {
    let directions: Vec<DVec3> = corners.iter().map(|corner| (*corner - p).normalize()).collect();
    let sum: f64 = (0..directions.len())
        .map(|i| {
            let (a, b) = (directions[i], directions[(i + 1) % directions.len()]);
            a.angle_between(b) * a.cross(b).normalize().dot(n)
        })
        .sum();
    0.5 * sum.abs()
}

#[test]
fn a_lamp_over_a_square() {
    let lamp = [(-0.5, -0.3), (0.4, -0.3), (0.4, 0.5), (-0.5, 0.5)].map(|(x, z)| DVec3::new(x, 0.7, z));
    let black = BsdfDesc::Black;
    // In that order its normal points downwards.
    let surfaces = vec![(square(0.0, true), GREY, None), (ShapeDesc::Quad(lamp), black, Some(Rgb::splat(5.0)))];
    let scene = build(&scenes::scene(scenes::camera(DVec3::Y * 0.5, DVec3::ZERO, 60.0), surfaces));
    let atlas = atlas(&scene, 36);
    let (baked, _) = bake(&scene, atlas.sites(), settings(256, None));
    let (floor, numbers) = of_first_surface(&atlas, &baked);
    let at = |p: DVec3| 5.0 * lambert(&lamp, p, DVec3::Y);
    assert_agrees(&floor, |i| mean_over(&scene, atlas.sites(), numbers[i], 4, &at), 2e-3);
}

/// The same room by a radiosity solution, which has no noise; and what stops it.
#[test]
fn furnace_by_radiosity() {
    let room = scenes::box_inside(DVec3::new(-1.0, -2.0, -3.0), DVec3::new(1.0, 1.0, 2.0));
    let scene = build(&one_mesh(room, Some(Rgb::splat(2.0))));
    let atlas = atlas(&scene, 48);
    let by = |settings: &RenderSettings, front| {
        by_radiosity(&scene, atlas.sites(), settings, Some(0.5), front, &mut |_| ControlFlow::Continue(()))
    };
    let (baked, solution) = by(&settings(1, None), true).unwrap();
    assert!(solution.summary().elements > 100, "{:?}", solution.summary());
    assert_eq!(baked.irradiance.len(), atlas.sites().len());
    assert!(baked.standard_error.iter().flatten().all(|error| error.is_nan()));
    let exact = PI * 2.0 / (1.0 - 0.5);
    let count = baked.irradiance.len() as f64;
    let mean = baked.irradiance.iter().map(|value| f64::from(value[0])).sum::<f64>() / count;
    assert!((mean / exact - 1.0).abs() < 2e-3, "{mean} and not {exact}");
    for value in &baked.irradiance {
        assert!((f64::from(value[0]) / exact - 1.0).abs() < 1e-2, "{value:?} and not {exact}");
    }
    let one = RenderSettings { threads: 1, ..settings(1, None) };
    assert_eq!(by(&one, true).unwrap().0.irradiance, baked.irradiance);
    // The outside of the room is dark.
    assert!(by(&one, false).unwrap().0.irradiance.iter().flatten().all(|&value| value == 0.0));
    one.cancel.cancel();
    assert_eq!(by(&one, true).unwrap_err().kind(), etendue::ErrorKind::Cancelled);
    let none =
        by_radiosity(&scene, &Arc::default(), &settings(1, None), None, true, &mut |_| ControlFlow::Continue(()));
    assert_eq!(none.unwrap_err().kind(), etendue::ErrorKind::InvalidScene);
}

/// A closed box with a point light inside whose walls are darker outside: the irradiance of either side by radiosity, and what
/// its vertices reflect.
#[test]
fn two_sided_walls_by_radiosity() {
    for (front, albedos) in [(true, [0.8, 0.1]), (false, [0.1, 0.8])] {
        let mut room = scenes::box_inside(DVec3::splat(-1.0), DVec3::splat(1.0));
        if !front {
            room.triangles.iter_mut().for_each(|triangle| triangle.swap(1, 2));
        }
        let mut desc = one_mesh(room, None);
        desc.lights = vec![scenes::point_light(DVec3::new(0.3, 0.2, 0.4), 2.0)];
        for (number, albedo) in albedos.into_iter().enumerate() {
            let bsdf = BsdfDesc::Lambert { albedo: Rgb::splat(albedo) };
            desc.materials.insert(number, MaterialDesc { bsdf, ..desc.materials[0].clone() });
        }
        desc.materials[2].bsdf = BsdfDesc::TwoSided { front: 0, back: 1 };
        desc.surfaces[0].material = Some(2);
        let scene = build(&desc);
        let options = VertexOptions { spacing: Some(0.25), ..VertexOptions::default() };
        let vertices = Vertices::new(&scene, &options, &Cancel::new()).unwrap();
        let go = &mut |_| ControlFlow::Continue(());
        let (baked, _) = by_radiosity(&scene, vertices.sites(), &settings(1, None), None, front, go).unwrap();
        let received: f64 =
            vertices.areas().iter().zip(&baked.irradiance).map(|(area, e)| area * f64::from(e[0])).sum();
        // All that is absorbed is all that is sent.
        let (sent, absorbed) = (4.0 * PI * 2.0, 0.2 * received);
        println!("front {front}: {absorbed} of {sent}");
        assert!((absorbed / sent - 1.0).abs() < 0.01, "front {front}: {absorbed} W of {sent} W");
        let irradiance = vertices.spread(&baked.irradiance);
        for (side, albedo) in [true, false].into_iter().zip(albedos) {
            let reflected = vertices.radiosity(&irradiance, side);
            assert!(reflected.iter().zip(&irradiance).all(|(b, e)| *b == e.map(|e| albedo * e)), "front {side}");
        }
    }
}

/// Rooms with shadows, by both methods at their defaults: channel means, and the root of the mean square of what texels differ
/// by without the paths' noise. Texels hold means, elements' corners do not: most of it is at the edges of shadows.
#[test]
fn radiosity_and_paths_bake_the_same() {
    let cornell = etendue::desc::load("scenes/cornell.json".as_ref(), None).expect("the scene is there");
    for (name, desc, bounces) in
        [("room", room(), None), ("room's first bounce", room(), Some(1)), ("cornell", cornell, None)]
    {
        let scene = build(&desc);
        let atlas = atlas(&scene, 64);
        let (paths, _) = bake(&scene, atlas.sites(), settings(512, bounces));
        let mut settings = settings(1, None);
        settings.desc.radiosity.iterations = bounces;
        let (solved, _) =
            by_radiosity(&scene, atlas.sites(), &settings, None, true, &mut |_| ControlFlow::Continue(())).unwrap();
        let count = paths.irradiance.len() as f64;
        for channel in 0..3 {
            let (mut sums, mut square, mut noise) = ([0.0; 2], 0.0, 0.0);
            for site in 0..paths.irradiance.len() {
                let [a, b] = [&paths, &solved].map(|baked| f64::from(baked.irradiance[site][channel]));
                sums = [sums[0] + a, sums[1] + b];
                square += (b - a).powi(2);
                noise += f64::from(paths.standard_error[site][channel]).powi(2);
            }
            let mean = sums[0] / count;
            let (off, differ) = (sums[1] / sums[0] - 1.0, ((square - noise).max(0.0) / count).sqrt() / mean);
            println!(
                "{name}, channel {channel}: mean off by {off:.5} +- {:.5}, texels by {differ:.4}",
                noise.sqrt() / sums[0]
            );
            assert!(off.abs() < 0.01, "{name}, channel {channel}: {off}");
            assert!(differ < 0.05, "{name}, channel {channel}: {differ}");
        }
    }
}

/// Surfaces that are no triangles, inside a room that is as bright everywhere: rays leave them cleanly all around.
#[test]
fn round_things_in_a_bright_room() {
    let room = scenes::box_inside(DVec3::splat(-4.0), DVec3::splat(4.0));
    let (cylinder, place) =
        ShapeDesc::cylinder(DVec3::new(2.0, -1.0, 0.0), DVec3::new(1.0, 2.0, 0.5), 0.4, 1.5).unwrap();
    let (ellipsoid, stretch) = ShapeDesc::ellipsoid(DVec3::new(-2.0, 1.0, 0.0), DVec3::new(0.5, 1.0, 0.2)).unwrap();
    let disk = ShapeDesc::Disk { centre: DVec3::new(0.0, -2.0, 1.0), normal: DVec3::Y, radius: 0.7 };
    let sphere = ShapeDesc::Sphere { centre: DVec3::new(0.0, 1.0, -2.0), radius: 1.0 };
    let black = BsdfDesc::Black;
    let room_shape = ShapeDesc::Mesh { mesh: 0, smooth: false };
    let surfaces = vec![
        (room_shape, black, Some(Rgb::ONE)),
        (sphere, black, None),
        (disk, black, None),
        (cylinder, black, None),
        (ellipsoid, black, None),
    ];
    let mut desc = scenes::scene(scenes::camera(DVec3::ZERO, DVec3::X, 60.0), surfaces);
    desc.meshes = vec![Arc::new(room)];
    desc.surfaces[3].local = place;
    desc.surfaces[4].local = stretch;
    let scene = build(&desc);
    let atlas = atlas(&scene, 128);
    assert_eq!(atlas.surfaces().len(), 5);
    let (baked, _) = bake(&scene, atlas.sites(), settings(64, None));
    let first = atlas.surfaces()[1].triangles.start;
    let mut found = [0; 5];
    for site in 0..atlas.sites().len() {
        let facet = atlas.sites().pieces(site)[0].facet;
        if facet < first {
            continue;
        }
        // Some of these see others of these, which are black; none of them sees itself.
        let surface = atlas.surfaces().iter().position(|surface| surface.triangles.contains(&facet)).unwrap();
        found[surface] += 1;
        let value = f64::from(baked.irradiance[site][0]);
        let error = f64::from(baked.standard_error[site][0]).max(1e-4);
        assert!(value < PI + 6.0 * error, "{value} +- {error} of surface {surface}");
        assert!(value > 0.6 * PI - 6.0 * error, "{value} +- {error} of surface {surface}");
    }
    assert!(found[1..].iter().all(|&texels| texels > 30), "{found:?}");
}

/// A sphere alone in a bright room: exact all around.
#[test]
fn a_sphere_in_a_bright_room() {
    for shape in [
        ShapeDesc::sphere(DVec3::new(0.5, 0.0, -1.0), 1.0).unwrap(),
        ShapeDesc::ellipsoid(DVec3::new(0.5, 0.0, -1.0), DVec3::new(0.5, 1.0, 0.3)).unwrap(),
    ] {
        let room = scenes::box_inside(DVec3::splat(-4.0), DVec3::splat(4.0));
        let black = BsdfDesc::Black;
        let surfaces =
            vec![(shape.0, black, None), (ShapeDesc::Mesh { mesh: 0, smooth: false }, black, Some(Rgb::splat(1.5)))];
        let mut desc = scenes::scene(scenes::camera(DVec3::splat(3.0), DVec3::ZERO, 60.0), surfaces);
        desc.meshes = vec![Arc::new(room)];
        desc.surfaces[0].local = shape.1;
        let scene = build(&desc);
        let atlas = atlas(&scene, 96);
        let (baked, _) = bake(&scene, atlas.sites(), settings(128, Some(1)));
        let (ball, numbers) = of_first_surface(&atlas, &baked);
        assert!(numbers.len() > 100);
        assert_agrees(&ball, |_| 1.5 * PI, 4e-3);
    }
}

/// A room lit by a lamp, a ball in it.
fn room() -> SceneDesc {
    let lamp = [(-0.5, -0.5), (0.5, -0.5), (0.5, 0.5), (-0.5, 0.5)].map(|(x, z)| DVec3::new(x, 1.9, z));
    let inside = scenes::box_inside(DVec3::new(-1.5, 0.0, -1.5), DVec3::new(1.5, 2.0, 1.5));
    let sphere = ShapeDesc::Sphere { centre: DVec3::new(0.6, 0.4, 0.5), radius: 0.4 };
    let surfaces = vec![
        (ShapeDesc::Mesh { mesh: 0, smooth: false }, BsdfDesc::Lambert { albedo: Rgb::new(0.7, 0.5, 0.3) }, None),
        (ShapeDesc::Quad(lamp), BsdfDesc::Black, Some(Rgb::new(6.0, 5.0, 4.0))),
        (sphere, BsdfDesc::Lambert { albedo: Rgb::splat(0.6) }, None),
    ];
    let mut desc =
        scenes::scene(scenes::camera(DVec3::new(-1.0, 1.0, -1.2), DVec3::new(0.4, 0.4, 0.6), 70.0), surfaces);
    desc.meshes = vec![Arc::new(inside)];
    desc
}

/// What a camera sees of the room is albedo / pi times what the map says at the same place.
#[test]
fn a_picture_by_the_light_map_is_the_path_traced_one() {
    let desc = room();
    let scene = build(&desc);
    let atlas = atlas(&scene, 160);
    let (baked, _) = bake(&scene, atlas.sites(), settings(64, None));
    let map = atlas.light_map(&baked);
    let job = scenes::Job { resolution: [24, 24], samples: 1024, ..scenes::Job::default() };
    let (image, _) = scenes::render_scene(&scene, job.desc());
    let camera = etendue::camera::Camera::new(&desc.camera, job.resolution, scene.centre()).unwrap();
    let walls = &atlas.surfaces()[0];
    let variance = &image.layer("variance").unwrap().data;
    let (mut seen, mut looked_up, mut error2, mut count) = (0.0, 0.0, 0.0, 0);
    for pixel in 0..24 * 24_u32 {
        // Many points of each pixel; pixels that show anything else than walls are left out.
        let mut mean = Some(Rgb::ZERO);
        for i in 0..64_u32 {
            let [dx, dy] = [i % 8, i / 8].map(|k| (k as f32 + 0.5) / 8.0);
            let ray = camera.ray((pixel % 24) as f32 + dx, (pixel / 24) as f32 + dy);
            let hit = scene.intersect(&ray).expect("a closed room");
            let hit = scene.describe_hit(&ray, &hit);
            let facing = hit.ng.dot(ray.direction) < 0.0;
            let triangle = (walls.triangles.clone()).find(|&t| atlas.primitives()[t as usize] == hit.primitive);
            mean = match (mean, triangle) {
                (Some(mean), Some(triangle)) if hit.surface == 0 && facing => {
                    Some(mean + map.at(atlas.uv(triangle as usize, hit.barycentric)) / 64.0)
                }
                _ => None,
            };
        }
        let Some(irradiance) = mean else { continue };
        let radiance = Rgb::new(0.7, 0.5, 0.3) * irradiance / std::f32::consts::PI;
        seen += f64::from(Vec3::from(image.pixel(pixel % 24, pixel / 24)).element_sum());
        looked_up += f64::from(radiance.element_sum());
        let errors = &variance[3 * pixel as usize..3 * pixel as usize + 3];
        // Channels go together.
        error2 += errors.iter().map(|v| f64::from(v.sqrt())).sum::<f64>().powi(2);
        count += 1;
    }
    assert!(count > 200, "{count} pixels");
    let (off, error) = (looked_up / seen - 1.0, error2.sqrt() / seen);
    assert!(error < 1e-3, "{error}");
    // The map's own noise and its texels: a half of a percent where shadows' edges and corners are interpolated.
    assert!(off.abs() < 5e-3, "{off} +- {error} over {count} pixels");
}

#[test]
fn threads_stops_and_resumptions_change_nothing() {
    let scene = build(&room());
    let atlas = atlas(&scene, 64);
    let with = |threads| bake(&scene, atlas.sites(), RenderSettings { threads, ..settings(16, None) }).0;
    let one = with(1);
    assert!(one.irradiance.iter().flatten().any(|&value| value > 0.0));
    assert_eq!(one.irradiance, with(2).irradiance);
    assert_eq!(one.irradiance, with(5).irradiance);
    // The same atlas, anew.
    let again = super::atlas(&scene, 64);
    assert_eq!(again.vertices(), atlas.vertices());
    assert_eq!(again.texels(), atlas.texels());

    let mut bake = Bake::new(&scene, atlas.sites(), settings(16, None), true).unwrap();
    let mut reports = 0;
    let summary = bake.run(&mut |_| {
        reports += 1;
        if reports == 2 { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    });
    assert_eq!(summary.unwrap().ended, Ended::Cancelled);
    let summary = bake.run(&mut |_| ControlFlow::Continue(())).unwrap();
    assert_eq!(summary.ended, Ended::Samples);
    assert_eq!(bake.irradiance().irradiance, one.irradiance);

    let cancelled = settings(16, None);
    cancelled.cancel.cancel();
    assert!(bake_is_cancelled(&scene, atlas.sites(), cancelled));
    let options = etendue::bake::AtlasOptions::default();
    let cancel = Cancel::new();
    cancel.cancel();
    assert_eq!(Atlas::new(&scene, &options, &cancel).unwrap_err().kind(), etendue::ErrorKind::Cancelled);
}

fn bake_is_cancelled(scene: &Scene, sites: &Arc<Sites>, settings: RenderSettings) -> bool {
    bake(scene, sites, settings).1.stopped
}

#[test]
fn an_error_that_is_aimed_at_ends_a_bake() {
    let scene = build(&room());
    let atlas = atlas(&scene, 48);
    let settings = RenderSettings { target_error: Some(0.02), ..settings(1 << 20, None) };
    let (baked, summary) = bake(&scene, atlas.sites(), settings);
    assert_eq!(summary.ended, Ended::Error);
    let error = summary.rel_mse.unwrap();
    assert!(error.value <= 0.02, "{error:?}");
    // The estimate is the mean over texels of their squared errors, relative.
    let mean =
        baked.irradiance.iter().flatten().map(|&v| f64::from(v)).sum::<f64>() / (3 * baked.irradiance.len()) as f64;
    let terms = baked.irradiance.iter().flatten().zip(baked.standard_error.iter().flatten()).map(|(&v, &e)| {
        let (v, e) = (f64::from(v), f64::from(e));
        e * e / (v * v + 1e-2 * mean * mean)
    });
    let own = terms.sum::<f64>() / (3 * baked.irradiance.len()) as f64;
    assert!((own / error.value - 1.0).abs() < 0.3, "{own} and {error:?}");
}

/// A mesh with a hierarchy of its own, turned and stretched, is lit as its copy in the scene's frame is.
#[test]
fn instances_are_lit_as_copies_are() {
    let mut mesh = scenes::box_inside(DVec3::splat(-1.0), DVec3::splat(1.0));
    // Outside out, and more than a dozen triangles: those of a grid on each face.
    mesh.triangles.iter_mut().for_each(|t| t.swap(1, 2));
    let split = |mesh: &mut etendue::desc::MeshDesc| {
        let old = std::mem::take(&mut mesh.triangles);
        for [a, b, c] in old {
            let mut middle = |i: u32, j: u32| {
                let p = 0.5 * (mesh.positions[i as usize] + mesh.positions[j as usize]);
                mesh.positions.push(p);
                mesh.positions.len() as u32 - 1
            };
            let (ab, bc, ca) = (middle(a, b), middle(b, c), middle(c, a));
            mesh.triangles.extend([[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]]);
        }
    };
    (0..2).for_each(|_| split(&mut mesh));
    let mut desc = one_mesh(mesh, None);
    let scale = etendue::math::DAffine3::from_scale(DVec3::new(2.0, 0.5, 1.0));
    let turn = etendue::math::DAffine3::from_rotation_y(0.7);
    desc.surfaces[0].transform = turn * scale;
    desc.lights = vec![scenes::point_light(DVec3::new(3.0, 4.0, 2.0), 10.0)];
    let dynamic = BuildOptions { dynamic: true, ..BuildOptions::default() };
    let (copied, instanced) = (build(&desc), Scene::build(&desc, &dynamic).unwrap());
    assert_eq!((copied.info().instances, instanced.info().instances), (0, 1));
    let sums = [copied, instanced].map(|scene| {
        let atlas = atlas(&scene, 64);
        let (baked, _) = bake(&scene, atlas.sites(), settings(32, Some(1)));
        let weighted = baked.irradiance.iter().zip(atlas.coverage()).map(|(v, share)| f64::from(v[0] * share));
        weighted.sum::<f64>()
    });
    // Texels that one covers by a hair's breadth, the other may not.
    assert!(sums[0] > 10.0 && (sums[1] / sums[0] - 1.0).abs() < 2e-3, "{sums:?}");
}
