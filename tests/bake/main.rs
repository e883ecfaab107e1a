//! Light maps: layouts without overlaps, and irradiance against closed forms.

#[path = "../common/mod.rs"]
mod common;

mod atlas;
mod light;
mod refused;
mod stopped;
mod vertices;

use std::ops::ControlFlow;
use std::sync::Arc;

use common::{scenes, stats};
use etendue::Cancel;
use etendue::bake::{Atlas, AtlasOptions, Bake, Baked};
use etendue::desc::{BsdfDesc, MeshDesc, RenderDesc, SceneDesc, ShapeDesc};
use etendue::integrator::Sites;
use etendue::math::{DVec3, Vec3};
use etendue::render::{RenderSettings, Summary};
use etendue::scene::{BuildOptions, Scene};
use etendue::spectrum::Rgb;

fn build(desc: &SceneDesc) -> Scene {
    Scene::build(desc, &BuildOptions::default()).expect("a scene of the test")
}

/// An atlas of so many texels a side.
fn atlas(scene: &Scene, side: u32) -> Atlas {
    let options = AtlasOptions { resolution: Some(side), ..AtlasOptions::default() };
    Atlas::new(scene, &options, &Cancel::new()).expect("an atlas of the test")
}

fn settings(samples: u32, max_depth: Option<u32>) -> RenderSettings {
    let desc = RenderDesc { samples, max_depth, seed: 5, ..RenderDesc::default() };
    RenderSettings { desc, threads: 2, ..RenderSettings::default() }
}

fn bake(scene: &Scene, sites: &Arc<Sites>, settings: RenderSettings) -> (Baked, Summary) {
    let mut bake = Bake::new(scene, sites, settings, true).expect("settings of the test");
    let summary = bake.run(&mut |_| ControlFlow::Continue(())).expect("no worker panics");
    assert_eq!(summary.non_finite, 0);
    (bake.irradiance(), summary)
}

/// A scene of one mesh, flat and grey.
fn one_mesh(mesh: MeshDesc, emission: Option<Rgb>) -> SceneDesc {
    let shape = ShapeDesc::Mesh { mesh: 0, smooth: false };
    let grey = BsdfDesc::Lambert { albedo: Rgb::splat(0.5) };
    let mut desc = scenes::scene(scenes::camera(DVec3::Z, DVec3::ZERO, 60.0), vec![(shape, grey, emission)]);
    desc.meshes = vec![Arc::new(mesh)];
    desc
}

/// A square of side 2 around the origin in the plane y = `height`; the normal points upwards, or downwards.
fn square(height: f64, upwards: bool) -> ShapeDesc {
    let corners = [(-1.0, -1.0), (-1.0, 1.0), (1.0, 1.0), (1.0, -1.0)].map(|(x, z)| DVec3::new(x, height, z));
    let [a, b, c, d] = corners;
    ShapeDesc::Quad(if upwards { [a, b, c, d] } else { [d, c, b, a] })
}
