//! What cannot be baked is an error that says why.

use etendue::ErrorKind;
use etendue::bake::{AtlasOptions, Bake, VertexOptions, Vertices, by_radiosity};
use etendue::embree::{Device, DeviceOptions, MemoryBudget};

use super::*;

fn quad_scene() -> SceneDesc {
    scenes::scene(scenes::camera(DVec3::Y, DVec3::ZERO, 60.0), vec![(square(0.0, true), BsdfDesc::Black, None)])
}

#[test]
fn scenes_without_a_surface() {
    let mut points = quad_scene();
    points.surfaces.clear();
    points.lights = vec![scenes::point_light(DVec3::Y, 1.0)];
    let flat = MeshDesc {
        positions: vec![DVec3::ZERO, DVec3::X, DVec3::X * 2.0],
        triangles: vec![[0, 1, 2], [0, 0, 1]],
        ..MeshDesc::default()
    };
    let mut hidden = quad_scene();
    hidden.surfaces[0].hidden = true;
    for desc in [SceneDesc::default(), points, one_mesh(flat, None), hidden] {
        let scene = build(&desc);
        let error = Atlas::new(&scene, &AtlasOptions::default(), &Cancel::new()).unwrap_err();
        assert_eq!(error.kind(), ErrorKind::InvalidScene, "{error}");
        assert!(error.message().contains("no surface"), "{error}");
        let error = Vertices::new(&scene, &VertexOptions::default(), &Cancel::new()).unwrap_err();
        assert!(error.message().contains("no surface"), "{error}");
        assert!(Bake::new(&scene, &Arc::default(), settings(1, None), true).is_err());
    }
}

#[test]
fn options_out_of_their_range() {
    let scene = build(&quad_scene());
    let good = AtlasOptions::default();
    for (options, path) in [
        (AtlasOptions { resolution: Some(0), ..good }, "resolution"),
        (AtlasOptions { resolution: Some(8193), ..good }, "resolution"),
        (AtlasOptions { resolution: Some(4), ..good }, "resolution"),
        (AtlasOptions { resolution: Some(16), texels_per_unit: Some(64.0), ..good }, "resolution"),
        (AtlasOptions { texels_per_unit: Some(0.0), ..good }, "texelsPerUnit"),
        (AtlasOptions { texels_per_unit: Some(-1.0), ..good }, "texelsPerUnit"),
        (AtlasOptions { texels_per_unit: Some(f64::NAN), ..good }, "texelsPerUnit"),
        (AtlasOptions { texels_per_unit: Some(1e9), ..good }, "texelsPerUnit"),
        (AtlasOptions { texels_per_unit: Some(1e300), ..good }, "texelsPerUnit"),
        (AtlasOptions { gutter: 65, ..good }, "gutter"),
        (AtlasOptions { max_angle_deg: 90.0, ..good }, "maxAngle"),
        (AtlasOptions { max_angle_deg: f64::NAN, ..good }, "maxAngle"),
    ] {
        let error = Atlas::new(&scene, &options, &Cancel::new()).unwrap_err();
        assert_eq!((error.kind(), error.location().json_path.as_str()), (ErrorKind::InvalidScene, path), "{error}");
    }
    for spacing in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        let options = VertexOptions { spacing: Some(spacing), ..VertexOptions::default() };
        assert_eq!(Vertices::new(&scene, &options, &Cancel::new()).unwrap_err().location().json_path, "spacing");
    }
    let none = RenderSettings { desc: RenderDesc { samples: 0, ..RenderDesc::default() }, ..RenderSettings::default() };
    assert!(Bake::new(&scene, atlas(&scene, 16).sites(), none, true).is_err());
}

#[test]
fn more_than_there_is_memory_for() {
    let scene = build(&quad_scene());
    let options = AtlasOptions { resolution: Some(8192), memory: 64, ..AtlasOptions::default() };
    let error = Atlas::new(&scene, &options, &Cancel::new()).unwrap_err();
    assert_eq!(error.kind(), ErrorKind::OutOfMemory, "{error}");
    assert!(error.message().contains("8192 x 8192") && error.message().contains("64"), "{error}");
    let options = VertexOptions { spacing: Some(1e-5), memory: 64 };
    assert_eq!(Vertices::new(&scene, &options, &Cancel::new()).unwrap_err().kind(), ErrorKind::OutOfMemory);
    let options = VertexOptions { spacing: Some(1e-300), ..options };
    assert_eq!(Vertices::new(&scene, &options, &Cancel::new()).unwrap_err().kind(), ErrorKind::OutOfMemory);

    // The device's own limit counts too, and gets everything back.
    let budget = MemoryBudget::new(32 << 20);
    let device = Device::new(&DeviceOptions { budget: Some(budget.clone()), ..DeviceOptions::default() }).unwrap();
    let limited = BuildOptions { device: Some(device), ..BuildOptions::default() };
    let scene = Scene::build(&quad_scene(), &limited).unwrap();
    let before = budget.used();
    let options = AtlasOptions { resolution: Some(2048), ..AtlasOptions::default() };
    assert_eq!(Atlas::new(&scene, &options, &Cancel::new()).unwrap_err().kind(), ErrorKind::OutOfMemory);
    assert_eq!(budget.used(), before);
    let small = atlas(&scene, 64);
    assert!(budget.used() > before);
    drop(small);
    assert_eq!(budget.used(), before);
}

#[test]
fn texels_smaller_than_any_element_are_no_error() {
    let scene = build(&quad_scene());
    let sites = Arc::clone(atlas(&scene, 16).sites());
    let mut look_up = |_| ControlFlow::Continue(());
    let found = by_radiosity(&scene, &sites, &settings(1, None), Some(1e-22), true, &mut look_up);
    assert_eq!(found.expect("a dark solution").0.irradiance, vec![[0.0; 3]; sites.len()]);
}

#[test]
fn degenerate_triangles_are_left_out() {
    let mut mesh = scenes::box_inside(DVec3::splat(-1.0), DVec3::splat(1.0));
    mesh.triangles.insert(3, [0, 0, 5]);
    mesh.triangles.push([7, 2, 7]);
    let scene = build(&one_mesh(mesh, None));
    let atlas = atlas(&scene, 64);
    assert_eq!(atlas.primitives(), [0, 1, 2, 4, 5, 6, 7, 8, 9, 10, 11, 12]);
    assert_eq!(atlas.charts().len(), 6);
}

#[test]
fn hits_that_pixels_share() {
    let scene = build(&quad_scene());
    let mut shared = settings(1, None);
    shared.desc.reuse = Some(true);
    let sites = atlas(&scene, 16);
    let by_paths = Bake::new(&scene, sites.sites(), shared.clone(), true).err().expect("a light map");
    let mut go_on = |_: f64| ControlFlow::Continue(());
    let solved = by_radiosity(&scene, sites.sites(), &shared, None, true, &mut go_on).expect_err("a light map");
    for error in [by_paths, solved] {
        assert_eq!(error.kind(), ErrorKind::Unsupported, "{error}");
        assert!(error.message().contains("integrator.reuse is true, and a light map has no"), "{error}");
    }
}
