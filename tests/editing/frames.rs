//! When a camera that moves takes the scene frame with it.

use etendue::desc::{CameraDesc, FilmDesc, FovAxis, SceneDesc, ShapeDesc};
use etendue::math::{DAffine3, DVec3};
use etendue::scene::Scene;
use etendue::spectrum::Rgb;

use crate::scenes::{Random, sheet, studio, surface};
use crate::{compare, options};

fn look(desc: &mut SceneDesc, from: DVec3, to: DVec3) {
    if let CameraDesc::Perspective { eye, look_at, .. } = &mut desc.camera {
        (*eye, *look_at) = (from, to);
    }
}

#[test]
fn an_orbit_and_a_walk_keep_the_frame() {
    let mut desc = studio(&mut Random(1));
    desc.meshes.push(sheet(30, 0.0, false).into());
    let mesh = surface(&desc, ShapeDesc::Mesh { mesh: 0, smooth: false }, DAffine3::IDENTITY, None);
    desc.surfaces.push(mesh);
    // Walls around it.
    for axis in 0..3 {
        for side in [-8.0, 8.0] {
            let corner = |x: f64, y: f64| {
                let mut p = DVec3::splat(side);
                p[(axis + 1) % 3] = x;
                p[(axis + 2) % 3] = y;
                p
            };
            let quad = [corner(-8.0, -8.0), corner(8.0, -8.0), corner(8.0, 8.0), corner(-8.0, 8.0)];
            let wall = surface(&desc, ShapeDesc::Quad(quad), DAffine3::IDENTITY, None);
            desc.surfaces.push(wall);
        }
    }
    let options = options(false);
    let scene = Scene::build(&desc, &options).unwrap();
    let bytes = scene.device().memory_bytes();
    for step in 0..200 {
        let angle = 0.1 * f64::from(step);
        let radius = 2.0 + 0.025 * f64::from(step);
        look(&mut desc, radius * DVec3::new(angle.cos(), 0.5 * (0.7 * angle).sin(), angle.sin()), DVec3::ZERO);
        let moved = scene.rebuild(&desc, &options).unwrap();
        assert_eq!(moved.centre(), scene.centre(), "step {step}");
        assert_eq!(moved.device().memory_bytes(), bytes);
    }
}

#[test]
fn far_along_a_wide_ground_the_frame_follows() {
    let mut desc = studio(&mut Random(1));
    let ground = [[-1e6, 0.0, -1e6], [-1e6, 0.0, 1e6], [1e6, 0.0, 1e6], [1e6, 0.0, -1e6]].map(DVec3::from_array);
    desc.surfaces.clear();
    let ground = surface(&desc, ShapeDesc::Quad(ground), DAffine3::IDENTITY, Some(Rgb::ONE));
    desc.surfaces.push(ground);
    let start = DVec3::new(0.3, 1.7, 0.1);
    look(&mut desc, start, start + DVec3::new(1.0, -0.1, 0.0));
    for dynamic in [false, true] {
        let options = options(dynamic);
        let scene = Scene::build(&desc, &options).unwrap();
        for (way, follows) in [(10.0, false), (1000.0, false), (1e4, true), (1e5, true), (9e5, true)] {
            let mut desc = desc.clone();
            let eye = start + DVec3::new(way, 0.0, 0.3 * way);
            look(&mut desc, eye, eye + DVec3::new(1.0, -0.1, 0.0));
            let moved = scene.rebuild(&desc, &options).unwrap();
            assert_eq!(moved.centre() != scene.centre(), follows, "{way} away");
            let fresh = Scene::build(&desc, &options).unwrap();
            if follows {
                assert_eq!(moved.centre(), fresh.centre());
                compare(&format!("{way} away"), &moved, &fresh);
            }
        }
    }
}

#[test]
fn parallel_rays_keep_the_frame_while_it_is_finer_than_their_pixels() {
    let mut desc = studio(&mut Random(1));
    let ground = [[-1e6, 0.0, -1e6], [-1e6, 0.0, 1e6], [1e6, 0.0, 1e6], [1e6, 0.0, -1e6]].map(DVec3::from_array);
    desc.surfaces.clear();
    let ground = surface(&desc, ShapeDesc::Quad(ground), DAffine3::IDENTITY, Some(Rgb::ONE));
    desc.surfaces.push(ground);
    let above = |at: f64, size| {
        let eye = DVec3::new(at, 500.0, 0.0);
        let look_at = eye - DVec3::new(1.0, 3.0, 0.0);
        CameraDesc::Orthographic {
            eye,
            look_at,
            up: DVec3::Y,
            size,
            axis: FovAxis::Horizontal,
            film: FilmDesc::default(),
        }
    };
    let options = options(false);
    for size in [0.5, 10.0, 400.0] {
        desc.camera = above(0.0, size);
        let scene = Scene::build(&desc, &options).unwrap();
        for (widths, follows) in [(1.0, false), (2000.0, false), (2100.0, true)] {
            desc.camera = above(widths * size, size);
            let moved = scene.rebuild(&desc, &options).unwrap();
            assert_eq!(moved.centre() != scene.centre(), follows, "{widths} widths of {size} away");
            compare(&format!("{widths} widths of {size} away"), &moved, &Scene::build(&desc, &options).unwrap());
        }
    }
}
