//! What is not built again: seen by the memory that Embree takes.

use std::sync::Arc;

use etendue::desc::{SceneDesc, ShapeDesc};
use etendue::embree::{Device, DeviceOptions, MemoryBudget};
use etendue::math::DAffine3;
use etendue::scene::{BuildOptions, Scene};

use crate::scenes::{Edit, Random, hosted, sheet, studio, surface};
use crate::{compare, is_dynamic, options};

#[test]
fn edits_of_looks_leave_embree_alone() {
    for dynamic in [false, true] {
        let mut desc = studio(&mut Random(1));
        desc.meshes.push(sheet(100, 0.0, false).into());
        let mesh = surface(&desc, ShapeDesc::Mesh { mesh: 0, smooth: false }, DAffine3::IDENTITY, None);
        desc.surfaces.push(mesh);
        let options = options(dynamic);
        let scene = Scene::build(&desc, &options).unwrap();
        let (bytes, peak) = (scene.device().memory_bytes(), scene.device().peak_memory_bytes());
        for edit in [
            Edit::MaterialParameters,
            Edit::MaterialIndex,
            Edit::EmissionColour,
            Edit::Light,
            Edit::LightAdded,
            Edit::CameraTurned,
            Edit::CameraMoved,
        ] {
            edit.apply(&mut desc, &mut Random(3));
            let edited = scene.rebuild(&desc, &options).unwrap();
            assert_eq!(scene.device().memory_bytes(), bytes, "{edit:?}");
            assert_eq!(scene.device().peak_memory_bytes(), peak, "{edit:?}");
            assert_eq!(is_dynamic(&edited), dynamic, "{edit:?} is no edit of geometry");
        }
        // A lamp emits on both sides: an emitter more for each of its triangles, but no geometry.
        let count = |desc: &SceneDesc| scene.rebuild(desc, &options).unwrap().emitters().emitters().len();
        let before = count(&desc);
        desc.surfaces[0].emits_both = true;
        assert_eq!(count(&desc), before + 2);
        assert_eq!(scene.device().peak_memory_bytes(), peak);
        // A lamp is switched off: no geometry either.
        desc.surfaces[0].emission = None;
        scene.rebuild(&desc, &options).unwrap();
        assert_eq!(scene.device().peak_memory_bytes(), peak);
    }
}

#[test]
fn edits_of_geometry_take_large_meshes_over() {
    let mut desc = studio(&mut Random(1));
    desc.meshes.push(sheet(200, 0.0, false).into());
    desc.meshes.push(sheet(20, 0.0, false).into());
    for mesh in 0..2 {
        let mesh = surface(&desc, ShapeDesc::Mesh { mesh, smooth: false }, DAffine3::IDENTITY, None);
        desc.surfaces.push(mesh);
    }
    let options = options(false);
    let scene = Scene::build(&desc, &options).unwrap();
    let full = scene.device().memory_bytes();
    assert!(!is_dynamic(&scene));
    desc.surfaces[3].transform = Random(4).placement();
    let first = scene.rebuild(&desc, &options).unwrap();
    assert!(is_dynamic(&first), "the first edit gives hierarchies");
    let before = first.device().memory_bytes();
    assert!(before > full + full / 2, "static and dynamic scene side by side: {before} for {full}");
    desc.surfaces[2].transform = Random(5).placement();
    desc.surfaces[3].hidden = true;
    let second = first.rebuild(&desc, &options).unwrap();
    let grown = second.device().memory_bytes() - before;
    assert!(grown < full / 20, "{grown} bytes more, of {full}");
    // What is hidden comes back as it was.
    desc.surfaces[3].hidden = false;
    let third = second.rebuild(&desc, &options).unwrap();
    assert!(third.device().memory_bytes() - before < full / 10);
    compare("third", &third, &Scene::build(&desc, &BuildOptions { dynamic: true, ..options }).unwrap());
}

/// Single triangles and shapes stay as they are while none of their kind is edited.
#[test]
fn edits_of_geometry_take_single_surfaces_over() {
    let scenes = crate::scenes::scenes();
    let (_, original) = scenes.into_iter().find(|(name, _)| *name == "singles").expect("it is there");
    let options = options(true);
    let scene = Scene::build(&original, &options).unwrap();
    let device = scene.device().clone();
    let full = device.memory_bytes();
    let of_kind = |is_one: fn(&ShapeDesc) -> bool| original.surfaces.iter().rposition(|it| is_one(&it.shape)).unwrap();
    let mesh = of_kind(|shape| matches!(shape, ShapeDesc::Mesh { .. }));
    let triangle = of_kind(|shape| matches!(shape, ShapeDesc::Triangle(_)));
    let sphere = of_kind(|shape| matches!(shape, ShapeDesc::Sphere { .. }));
    // What is built again is a part of the whole: nothing, the triangles, the spheres.
    let grown = |number: usize| {
        let mut desc = original.clone();
        desc.surfaces[number].transform = Random(4).similarity();
        let edited = scene.rebuild(&desc, &options).unwrap();
        let grown = (device.memory_bytes() - full) as f64 / full as f64;
        compare("singles", &edited, &Scene::build(&desc, &options).unwrap());
        grown
    };
    let [of_mesh, of_triangle, of_sphere] = [mesh, triangle, sphere].map(grown);
    assert!(of_mesh < 0.1, "{of_mesh}");
    assert!(of_triangle > 0.2 && of_sphere > 0.2, "{of_triangle}, {of_sphere}");
    assert!(of_triangle + of_sphere < 1.1, "{of_triangle} and {of_sphere}");
    // The list of surfaces grows, and a single surface is removed: its kind alone is built again.
    let mut desc = original.clone();
    let added = surface(&desc, ShapeDesc::Mesh { mesh: 0, smooth: true }, Random(8).placement(), None);
    desc.surfaces.push(added);
    let edited = scene.rebuild(&desc, &options).unwrap();
    assert!(((device.memory_bytes() - full) as f64) < 0.1 * full as f64);
    desc.surfaces[sphere].hidden = true;
    let edited = edited.rebuild(&desc, &options).unwrap();
    compare("removed", &edited, &Scene::build(&desc, &options).unwrap());
    assert!(edited.info().to_string().contains("hierarchy of their own"), "{}", edited.info());
}

#[test]
fn a_mesh_is_forgotten_with_its_last_surface() {
    let mut desc = studio(&mut Random(1));
    desc.meshes.push(sheet(200, 0.0, false).into());
    let mesh = surface(&desc, ShapeDesc::Mesh { mesh: 0, smooth: false }, DAffine3::IDENTITY, None);
    desc.surfaces.push(mesh);
    let options = options(true);
    let scene = Scene::build(&desc, &options).unwrap();
    let device = scene.device().clone();
    let full = device.memory_bytes();
    desc.surfaces.pop();
    let without = scene.rebuild(&desc, &options).unwrap();
    drop(scene);
    assert!(device.memory_bytes() < full / 10, "{} of {full}", device.memory_bytes());
    drop(without);
    assert_eq!(device.memory_bytes(), 0);
}

#[test]
fn host_memory_is_read_in_place_and_let_go() {
    for dynamic in [false, true] {
        let (mesh, memory) = hosted(&sheet(60, 1.0, false), true);
        let mut desc = studio(&mut Random(1));
        desc.meshes.push(Arc::new(mesh));
        for _ in 0..2 {
            let mesh = surface(&desc, ShapeDesc::Mesh { mesh: 0, smooth: true }, Random(2).placement(), None);
            desc.surfaces.push(mesh);
        }
        let options = options(dynamic);
        let scene = Scene::build(&desc, &options).unwrap();
        assert_eq!(scene.info().instances, 2);
        // A handful of triangles besides; nothing of the host's 3721 vertices.
        assert!(scene.info().geometry_bytes < 1000, "{}", scene.info().geometry_bytes);
        drop(desc);
        assert!(Arc::strong_count(&memory) > 1, "the scene holds on to it");
        drop(scene);
        assert_eq!(Arc::strong_count(&memory), 1, "and lets go");
    }
}

#[test]
fn host_meshes_that_make_no_sense_are_refused() {
    let options = options(false);
    let mut broken = sheet(10, 0.0, false);
    broken.positions[17].y = f64::INFINITY;
    let mut torn = sheet(10, 0.0, false);
    torn.triangles[33][2] = 121;
    for (mesh, expected) in [(broken, "vertex 17"), (torn, "triangle 33")] {
        for emission in [None, Some(etendue::spectrum::Rgb::ONE)] {
            let mut desc = studio(&mut Random(1));
            desc.meshes.push(hosted(&mesh, false).0.into());
            let mesh = surface(&desc, ShapeDesc::Mesh { mesh: 0, smooth: false }, DAffine3::IDENTITY, emission);
            desc.surfaces.push(mesh);
            let error = Scene::build(&desc, &options).unwrap_err();
            assert!(error.message().contains(expected), "{error}");
            assert_eq!(error.location().json_path, "host");
        }
    }
}

#[test]
fn scenes_of_several_devices_share_a_budget() {
    let mut desc = studio(&mut Random(1));
    desc.meshes.push(sheet(100, 0.0, false).into());
    let mesh = surface(&desc, ShapeDesc::Mesh { mesh: 0, smooth: true }, DAffine3::IDENTITY, None);
    desc.surfaces.push(mesh);
    let with = |budget: &MemoryBudget| {
        let device = Device::new(&DeviceOptions { budget: Some(budget.clone()), ..DeviceOptions::default() }).unwrap();
        Scene::build(&desc, &BuildOptions { device: Some(device), ..BuildOptions::default() })
    };
    let counting = MemoryBudget::new(usize::MAX);
    let scene = with(&counting).unwrap();
    let one = counting.used();
    assert!(one >= scene.device().memory_bytes() + scene.info().geometry_bytes, "{one}");
    let peak = counting.peak();
    drop(scene);
    assert_eq!(counting.used(), 0);

    let budget = MemoryBudget::new(one + peak / 2);
    let first = with(&budget).unwrap();
    let error = with(&budget).unwrap_err();
    assert_eq!(error.kind(), etendue::ErrorKind::OutOfMemory);
    let used = budget.used();
    assert!(used < one + one / 10, "a build that failed keeps nothing: {used} of {one}");
    drop(first);
    assert_eq!(budget.used(), 0);
    with(&budget).expect("there is room again");
}
