//! The scene of an edited description is the one that a fresh build gives, at a fraction of its cost.

#[path = "../common/mod.rs"]
mod common;
mod description;
mod frames;
mod scenes;
mod taken_over;

use std::sync::Arc;

use etendue::desc::{KeyPlace, MotionDesc, MotionKey, RenderDesc, SceneDesc, ShapeDesc, Surfaces};
use etendue::embree::{Device, DeviceOptions};
use etendue::math::{DAffine3, DVec3, Ray, Vec3};
use etendue::scene::{BuildOptions, Scene};
use etendue::spectrum::Rgb;
use scenes::{EDITS, Edit, Random, scenes, surface};

/// Rays of a comparison.
const RAYS: usize = 10_000;

/// How many of them may meet another triangle by rounding, at an edge: where two frames differ, their single precision does.
const STRAY: usize = 5;

/// One thread, so that two builds of the same are the same.
pub fn options(dynamic: bool) -> BuildOptions {
    let device = Device::new(&DeviceOptions { threads: 1, ..DeviceOptions::default() }).unwrap();
    BuildOptions { device: Some(device), dynamic, ..BuildOptions::default() }
}

/// Whether larger meshes have hierarchies of their own, as the scene itself says.
pub fn is_dynamic(scene: &Scene) -> bool {
    scene.info().decisions.iter().any(|decision| decision.starts_with("geometry is edited"))
}

/// World position and direction of rays through the scene, from everywhere.
fn rays(scene: &Scene, random: &mut Random, count: usize) -> Vec<(etendue::math::DVec3, etendue::math::DVec3)> {
    let bounds = scene.info().bounds;
    let (middle, half) = (bounds.centre(), 0.5 * (bounds.max - bounds.min));
    let mut point = || middle + 1.1 * half * random.cube();
    (0..count)
        .map(|_| {
            let (from, to) = (point(), point());
            (from, (to - from).normalize())
        })
        .collect()
}

/// Every answer that differs: to closest-hit and shadow rays, in what was met, where, and how it shades.
pub fn compare(what: &str, edited: &Scene, fresh: &Scene) {
    assert_eq!(is_dynamic(edited), is_dynamic(fresh), "{what}");
    let same_frame = edited.centre() == fresh.centre();
    let bounds = fresh.info().bounds;
    assert_eq!(edited.info().bounds, bounds, "{what}");
    let counts = |scene: &Scene| {
        let info = scene.info();
        (info.surfaces, info.triangles, info.instances, info.listed_shapes, info.embree_shapes, info.emitters)
    };
    assert_eq!(counts(edited), counts(fresh), "{what}");
    assert_eq!(edited.warnings(), fresh.warnings(), "{what}");
    if bounds.is_empty() {
        return;
    }
    let size = (bounds.max - bounds.min).length();
    let mut stray = 0;
    for (number, (from, direction)) in rays(fresh, &mut Random(5), RAYS).into_iter().enumerate() {
        // At moments from when the shutter opens to when it closes.
        let time = number as f32 / RAYS as f32;
        let ray_in = |scene: &Scene| Ray { time, ..Ray::new(scene.to_scene(from), direction.as_vec3a()) };
        let (ray, fresh_ray) = (ray_in(edited), ray_in(fresh));
        let (hit, fresh_hit) = (edited.intersect(&ray), fresh.intersect(&fresh_ray));
        let segment = |ray: Ray| Ray { tfar: 0.3 * size as f32, ..ray };
        let free = edited.unoccluded(&segment(ray)) == fresh.unoccluded(&segment(fresh_ray));
        let same = match (hit, fresh_hit) {
            (None, None) => free,
            (Some(hit), Some(fresh_hit)) => {
                let (a, b) = (edited.describe_hit(&ray, &hit), fresh.describe_hit(&fresh_ray, &fresh_hit));
                let (p, q) = (edited.interaction(&ray, &hit), fresh.interaction(&fresh_ray, &fresh_hit));
                let world = |scene: &Scene, p: Vec3| scene.centre() + p.as_dvec3();
                let near = |x: f32, y: f32, tolerance: f32| (x - y).abs() <= tolerance;
                let (ulps, shade) = if same_frame { (4.0 * f32::EPSILON, 0.0) } else { (1e-4, 2e-3) };
                free && (a.surface, a.material, a.primitive) == (b.surface, b.material, b.primitive)
                    && p.emitter == q.emitter
                    && near(a.t, b.t, ulps * b.t.abs().max(size as f32))
                    && world(edited, p.point.p).distance(world(fresh, q.point.p)) <= f64::from(ulps) * size
                    && a.ng.distance(b.ng) <= shade
                    && a.ns.distance(b.ns) <= 2.0 * shade
                    && (0..2).all(|i| near(a.barycentric[i], b.barycentric[i], 5.0 * shade))
            }
            _ => false,
        };
        if !same {
            stray += 1;
            let allowed = if same_frame { 0 } else { STRAY };
            assert!(stray <= allowed, "{what}: ray {number} from {from} to {direction}: {hit:?}, {fresh_hit:?}");
        }
    }
    let (emitters, expected) = (edited.emitters().emitters(), fresh.emitters().emitters());
    assert_eq!(emitters.len(), expected.len(), "{what}");
    assert_eq!(edited.emitters().is_dark(), fresh.emitters().is_dark(), "{what}");
    for (emitter, expected) in emitters.iter().zip(expected) {
        assert_eq!(emitter.moving().is_some(), expected.moving().is_some(), "{what}: a lamp moves in one of both");
        let (a, b) = (emitter.power(), expected.power());
        assert!((a - b).abs().max_element() <= 1e-4 * b.max_element(), "{what}: power {a} for {b}");
    }
}

/// A small image.
pub fn image(scene: &Scene, desc: &SceneDesc) -> Vec<u32> {
    let render = RenderDesc { resolution: [24, 24], samples: 4, ..desc.render.clone() };
    let (image, _) = common::scenes::render_scene(scene, render);
    image.rgb.iter().map(|value| value.to_bits()).collect()
}

/// Every edit of every scene, from a scene that was built for edits and from one that was not.
#[test]
fn every_edit_gives_what_a_fresh_build_gives() {
    for (name, original) in scenes() {
        for dynamic in [false, true] {
            let options = options(dynamic);
            let scene = Scene::build(&original, &options).unwrap();
            for (number, edit) in EDITS.into_iter().enumerate() {
                let mut desc = original.clone();
                edit.apply(&mut desc, &mut Random(100 + number as u64));
                let edited = scene.rebuild(&desc, &options).unwrap();
                let fresh = Scene::build(&desc, &BuildOptions { dynamic: is_dynamic(&edited), ..options.clone() });
                compare(&format!("{name}, dynamic {dynamic}, {edit:?}"), &edited, &fresh.unwrap());
            }
        }
    }
}

/// Thirty edits in a row, each of the scene before.
#[test]
fn edits_in_a_row_do_not_add_up() {
    for (name, original) in scenes() {
        for seed in 0..2 {
            let mut random = Random(seed);
            let options = options(seed == 0);
            let mut desc = original.clone();
            let mut scene = Scene::build(&desc, &options).unwrap();
            let mut images = 0;
            for step in 0..30 {
                let edit = EDITS[random.below(EDITS.len())];
                edit.apply(&mut desc, &mut random);
                // What goes away is the description, not what the scene needs of it.
                desc = desc.clone();
                scene = scene.rebuild(&desc, &options).unwrap();
                if step % 10 == 9 {
                    let fresh = BuildOptions { dynamic: is_dynamic(&scene), ..options.clone() };
                    let fresh = Scene::build(&desc, &fresh).unwrap();
                    let what = format!("{name}, seed {seed}, step {step}, {edit:?}");
                    compare(&what, &scene, &fresh);
                    if scene.centre() == fresh.centre() {
                        assert!(image(&scene, &desc) == image(&fresh, &desc), "{what}: another image");
                        images += 1;
                    }
                }
            }
            println!("{name}, seed {seed}: {images} images compared");
        }
    }
}

/// A render may use the old scene while the new one is built, and after.
#[test]
fn the_old_scene_stays_as_it_is() {
    for (name, original) in scenes() {
        let options = options(true);
        let scene = Scene::build(&original, &options).unwrap();
        let before = image(&scene, &original);
        let mut desc = original.clone();
        let mut edited = Vec::new();
        for (number, edit) in EDITS.into_iter().enumerate() {
            edit.apply(&mut desc, &mut Random(number as u64));
            edited.push(scene.rebuild(&desc, &options).unwrap());
        }
        assert!(image(&scene, &original) == before, "{name}");
        let last = edited.pop().unwrap();
        let expected = image(&last, &desc);
        // The new scene holds what it shares with the old ones, and with the description.
        drop((scene, edited));
        let copy = SceneDesc { meshes: Vec::new(), surfaces: Surfaces::default(), ..desc.clone() };
        drop(desc);
        assert!(image(&last, &copy) == expected, "{name}");
    }
}

/// Lamps that move go on moving where lights are edited, and what cannot shine while it moves is still refused.
#[test]
fn lamps_that_move_go_on_moving() {
    let (_, mut original) = scenes().into_iter().find(|(name, _)| *name == "singles").unwrap();
    original.motion.shutter.close = 1.0;
    let key = |time, x| MotionKey { time, place: KeyPlace::Matrix(DAffine3::from_translation(DVec3::X * x)) };
    let motion = Arc::new(MotionDesc { keys: vec![key(0.0, 0.0), key(1.0, 0.3)] });
    let disk = surface(&original, ShapeDesc::disk(DVec3::ZERO, DVec3::Y, 0.3).unwrap().0, DAffine3::IDENTITY, None);
    original.surfaces.push(disk);
    let disk = original.surfaces.len() - 1;
    let lamps: Vec<usize> = (0..disk).filter(|number| original.surfaces[*number].emission.is_some()).collect();
    for &number in lamps.iter().chain([&disk]) {
        original.motion.surfaces.insert(number, Arc::clone(&motion));
    }
    let options = options(true);
    let scene = Scene::build(&original, &options).unwrap();
    let mut desc = original.clone();
    Edit::Light.apply(&mut desc, &mut Random(1));
    let edited = scene.rebuild(&desc, &options).unwrap();
    compare("lights beside moving lamps", &edited, &Scene::build(&desc, &options).unwrap());
    assert!(edited.emitters().emitters().iter().filter(|it| it.moving().is_some()).count() >= lamps.len());
    desc.surfaces[disk].emission = Some(Rgb::ONE);
    let error = scene.rebuild(&desc, &options).unwrap_err();
    assert_eq!(error.to_string(), Scene::build(&desc, &options).unwrap_err().to_string());
    assert!(error.to_string().contains("cannot move"), "{error}");
}

#[test]
fn errors_are_those_of_a_fresh_build() {
    let (_, original) = scenes().swap_remove(1);
    let options = options(true);
    let scene = Scene::build(&original, &options).unwrap();
    type Change = fn(&mut SceneDesc);
    let edits: [(&str, Change); 5] = [
        ("no such material", |desc| desc.surfaces[2].material = Some(99)),
        ("no such mesh", |desc| desc.meshes.truncate(1)),
        ("a vertex that is not finite", |desc| Arc::make_mut(&mut desc.meshes[0]).positions[7].y = f64::NAN),
        ("an index past the end", |desc| Arc::make_mut(&mut desc.meshes[0]).triangles[7][1] = 1 << 20),
        ("too few uvs", |desc| Arc::make_mut(&mut desc.meshes[1]).uvs.truncate(3)),
    ];
    for (what, edit) in edits {
        let mut desc = original.clone();
        edit(&mut desc);
        let error = scene.rebuild(&desc, &options).expect_err(what);
        let fresh = Scene::build(&desc, &options).expect_err(what);
        assert_eq!(error.to_string(), fresh.to_string(), "{what}");
        assert_eq!(error.kind(), etendue::ErrorKind::InvalidScene);
        println!("{what}: {error}");
    }
    scene.rebuild(&original, &options).expect("the scene is as good as before");
}
