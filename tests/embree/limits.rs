//! Inputs that are refused, memory that is bounded, and the order in which things go away.

use std::sync::Arc;

use etendue::ErrorKind;
use etendue::embree::{
    BuildQuality, Device, DeviceOptions, MAX_COORDINATE, SceneBuilder, SceneOptions, TriangleMesh, UserGeometry,
    UserHit, VertexBuffer,
};
use etendue::math::{DAffine3, DVec3, Ray, Vec3};

use crate::build::terrain;
use crate::{device, mesh_scene, rounded};

fn one_triangle() -> TriangleMesh {
    TriangleMesh::new(vec![[0.0, 0.0, 1.0], [1.0, 0.0, 1.0], [0.0, 1.0, 1.0]], vec![[0, 1, 2]]).unwrap()
}

fn refused<T>(what: &str, result: etendue::Result<T>) {
    match result {
        Ok(_) => panic!("{what} was accepted"),
        Err(error) => {
            assert_eq!(error.kind(), ErrorKind::InvalidScene, "{what}: {error}");
            println!("{what}: {error}");
        }
    }
}

#[test]
fn meshes_that_make_no_sense_are_refused() {
    let corners = vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
    refused("an index past the end", TriangleMesh::new(corners.clone(), vec![[0, 1, 3]]));
    refused("the largest index", TriangleMesh::new(corners.clone(), vec![[0, 1, u32::MAX]]));
    refused("no triangle", TriangleMesh::new(corners, vec![]));
    refused("no vertex", TriangleMesh::new(vec![], vec![[0, 0, 0]]));
    for x in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY, MAX_COORDINATE, -2e18] {
        refused("a coordinate", VertexBuffer::new(vec![[0.0, x, 0.0]]));
    }
    assert!(VertexBuffer::new(vec![[1.8e18, -1.8e18, 0.0]]).is_ok());
    // The padding is not part of the mesh.
    let buffer = Arc::new(VertexBuffer::new(vec![[1.0; 3]; 3]).unwrap());
    refused("the padding vertex", TriangleMesh::shared(buffer, vec![[0, 1, 3]]));
}

#[test]
fn spheres_that_make_no_sense_are_refused() {
    let device = device();
    let mut builder = SceneBuilder::new(&device, SceneOptions::default()).unwrap();
    refused("no sphere", builder.add_spheres(vec![]));
    for bad in [
        [0.0, 0.0, 0.0, 0.0],
        [0.0, 0.0, 0.0, -1.0],
        [0.0, 0.0, 0.0, f32::NAN],
        [f32::NAN, 0.0, 0.0, 1.0],
        [0.0, f32::INFINITY, 0.0, 1.0],
        [0.0, 0.0, 1.8e18, 1.8e18],
    ] {
        refused("a sphere", builder.add_spheres(vec![[0.0, 0.0, 0.0, 1.0], bad]));
    }
    // A refusal leaves the builder as it was.
    builder.add_spheres(vec![[0.0, 0.0, 3.0, 1.0]]).unwrap();
    let scene = builder.commit(None).unwrap();
    assert_eq!(scene.intersect(&Ray::new(Vec3::ZERO, Vec3::Z)).map(|h| h.geom), Some(0));
}

struct Boxes(usize, [f32; 3], [f32; 3]);

impl UserGeometry for Boxes {
    fn len(&self) -> usize {
        self.0
    }

    fn bounds(&self, _: usize) -> ([f32; 3], [f32; 3]) {
        (self.1, self.2)
    }

    fn intersect(&self, _: usize, _: &Ray) -> Option<UserHit> {
        None
    }
}

#[test]
fn boxes_that_make_no_sense_are_refused() {
    let device = device();
    let mut builder = SceneBuilder::new(&device, SceneOptions::default()).unwrap();
    let (low, high) = ([0.0; 3], [1.0; 3]);
    refused("no primitive", builder.add_user(Arc::new(Boxes(0, low, high))));
    refused("too many", builder.add_user(Arc::new(Boxes(usize::MAX, low, high))));
    refused("inside out", builder.add_user(Arc::new(Boxes(1, high, low))));
    refused("NaN", builder.add_user(Arc::new(Boxes(1, low, [1.0, f32::NAN, 1.0]))));
    refused("infinite", builder.add_user(Arc::new(Boxes(1, low, [1.0, f32::INFINITY, 1.0]))));
    assert!(builder.add_user(Arc::new(Boxes(1, low, low))).is_ok());
}

#[test]
fn instances_that_make_no_sense_are_refused() {
    let device = device();
    let child = mesh_scene(&device, SceneOptions::default(), &one_triangle());
    let mut builder = SceneBuilder::new(&device, SceneOptions::default()).unwrap();
    for (what, transform) in [
        ("flat", DAffine3::from_scale(DVec3::new(1.0, 1.0, 0.0))),
        ("NaN", DAffine3::from_translation(DVec3::new(f64::NAN, 0.0, 0.0))),
        ("infinite", DAffine3::from_scale(DVec3::splat(f64::INFINITY))),
        ("too small", DAffine3::from_scale(DVec3::splat(1e-15))),
        ("too far", DAffine3::from_translation(DVec3::splat(1e20))),
        ("too large", DAffine3::from_scale(DVec3::splat(1e30))),
    ] {
        refused(what, builder.add_instance(&child, &transform));
    }
    builder.add_instance(&child, &DAffine3::from_translation(DVec3::Z)).unwrap();
    let parent = builder.commit(None).unwrap();
    assert!(parent.features().instances && parent.features().triangles && !parent.features().user);
    let ray = Ray::new(Vec3::new(0.25, 0.25, 0.0), Vec3::Z);
    assert_eq!(parent.intersect(&ray).map(|h| (rounded(h.t), h.geom, h.inst)), Some((2.0, 0, 0)));

    let mut builder = SceneBuilder::new(&device, SceneOptions::default()).unwrap();
    let nested = builder.add_instance(&parent, &DAffine3::IDENTITY).unwrap_err();
    assert_eq!(nested.kind(), ErrorKind::Unsupported);
    let other = crate::device();
    let mut builder = SceneBuilder::new(&other, SceneOptions::default()).unwrap();
    let foreign = builder.add_instance(&child, &DAffine3::IDENTITY).unwrap_err();
    assert_eq!(foreign.kind(), ErrorKind::Unsupported);
}

#[test]
fn a_build_past_the_memory_limit_fails_and_gives_all_back() {
    for quality in [BuildQuality::Low, BuildQuality::Medium, BuildQuality::High] {
        for threads in [1, 2] {
            // Some fail on the first allocation, some in the middle of the build.
            for limit in [0, 100_000, 2_000_000, 5_000_000] {
                let options = DeviceOptions { threads, memory_limit: Some(limit), ..DeviceOptions::default() };
                let device = Device::new(&options).unwrap();
                let build = |mesh| {
                    let mut builder = SceneBuilder::new(&device, SceneOptions { quality, ..Default::default() })?;
                    builder.add_triangles(mesh)?;
                    builder.commit(None)
                };
                let error = build(terrain(200)).err().expect("more than the limit");
                assert_eq!(error.kind(), ErrorKind::OutOfMemory, "{error}");
                assert!(device.peak_memory_bytes() <= limit, "{} of {limit}", device.peak_memory_bytes());
                assert_eq!(device.memory_bytes(), 0, "limit {limit}, {quality:?}");
                // The device is as good as new.
                if limit >= 2_000_000 {
                    let scene = build(one_triangle()).expect("enough for one triangle");
                    assert!(scene.intersect(&Ray::new(Vec3::new(0.2, 0.2, 0.0), Vec3::Z)).is_some());
                }
            }
        }
    }
}

#[test]
fn memory_is_counted_and_given_back() {
    let device = device();
    assert_eq!(device.memory_bytes(), 0);
    let mesh = terrain(200);
    let scene = mesh_scene(&device, SceneOptions::default(), &mesh);
    let held = device.memory_bytes();
    assert!(held > 1_000_000, "{held}");
    assert!(device.peak_memory_bytes() >= held);
    assert_eq!(scene.memory_bytes(), held + mesh.memory_bytes());
    drop(scene);
    assert_eq!(device.memory_bytes(), 0);
}

#[test]
fn scenes_outlive_all_they_were_made_from() {
    let scene = {
        let device = device();
        let mesh = one_triangle();
        let child = mesh_scene(&device, SceneOptions::default(), &mesh);
        let mut builder = SceneBuilder::new(&device, SceneOptions::default()).unwrap();
        builder.add_instance(&child, &DAffine3::IDENTITY).unwrap();
        builder.add_user(Arc::new(Boxes(3, [5.0; 3], [6.0; 3]))).unwrap();
        builder.add_spheres(vec![[9.0, 9.0, 9.0, 1.0]]).unwrap();
        drop(device);
        let scene = builder.commit(None).unwrap();
        drop((child, mesh));
        scene
    };
    let clone = scene.clone();
    drop(scene);
    let ray = Ray::new(Vec3::new(0.25, 0.25, 0.0), Vec3::Z);
    let from_thread = std::thread::spawn(move || clone.intersect(&ray).map(|h| h.t)).join().unwrap();
    assert_eq!(from_thread.map(rounded), Some(1.0));
}

#[test]
fn an_unfinished_scene_can_be_dropped() {
    let device = device();
    let mut builder = SceneBuilder::new(&device, SceneOptions::default()).unwrap();
    builder.add_triangles(one_triangle()).unwrap();
    builder.add_user(Arc::new(Boxes(3, [5.0; 3], [6.0; 3]))).unwrap();
    drop(builder);
    assert_eq!(device.memory_bytes(), 0);
}

#[test]
fn two_scenes_share_one_buffer() {
    let device = device();
    let mesh = terrain(50);
    let first = mesh_scene(&device, SceneOptions::default(), &mesh);
    let half = mesh.indices().iter().take(100).collect::<Vec<_>>();
    let part = TriangleMesh::shared(Arc::clone(mesh.vertices()), half).unwrap();
    let second = mesh_scene(&device, SceneOptions::default(), &part);
    assert_eq!(Arc::strong_count(mesh.vertices()), 4);
    drop((first, part));
    assert_eq!(Arc::strong_count(mesh.vertices()), 2);
    drop(mesh);
    let bounds = second.bounds();
    let middle = bounds.centre().as_vec3a() + Vec3::new(0.0, 0.0, 10.0);
    assert!(second.intersect(&Ray::new(middle, -Vec3::Z)).is_some());
}
