//! Photon mapping: the power that light paths carry, the density estimates made of it, and the methods that read them.
//!
//! All pixels of a render read the same maps, so their errors are not independent: a standard error here is that of the mean
//! over renders with seeds of their own.

mod density;
mod edges;
mod flux;
mod lamps;
mod materials;
mod odd;
mod passes;
mod rooms;
mod shadows;
mod skies;
mod spots;
mod water;
mod webs;

use std::sync::Arc;

use crate::common::scenes::{add, camera, render_scene, scene};
use crate::record::Entry;
use crate::stats;
use etendue::Alone;
use etendue::Cancel;
use etendue::desc::{BsdfDesc, IntegratorDesc, KernelDesc, PhotonDesc, RenderDesc, SceneDesc, ShapeDesc};
use etendue::film::Image;
use etendue::integrator::photon::{
    Kernel, MapKind, MapQuery, NARROW, Nearest, PhotonBatch, PhotonJob, PhotonMap, irradiance, shoot,
};
use etendue::math::{DVec3, Vec3};
use etendue::scene::{BuildOptions, Scene};
use etendue::spectrum::Rgb;

pub fn cases() -> Vec<Entry> {
    let topics = [
        flux::cases(),
        density::cases(),
        edges::cases(),
        shadows::cases(),
        lamps::cases(),
        skies::cases(),
        spots::cases(),
        webs::cases(),
        rooms::cases(),
        materials::cases(),
        water::cases(),
        odd::cases(),
        passes::cases(),
    ];
    topics.into_iter().flatten().collect()
}

/// The methods that read photon maps.
const METHODS: [IntegratorDesc; 5] = [
    IntegratorDesc::PhotonDirect,
    IntegratorDesc::Caustic,
    IntegratorDesc::Photon,
    IntegratorDesc::Ppm,
    IntegratorDesc::Sppm,
];

/// Independent runs whose scatter is the error of their mean.
const RUNS: u32 = 32;

/// A shape with its material, and what it emits.
pub type Surface = (ShapeDesc, BsdfDesc, Option<Rgb>);

pub fn build(desc: &SceneDesc) -> Scene {
    Scene::build(desc, &BuildOptions::default()).expect("a scene of the test")
}

fn load(name: &str) -> SceneDesc {
    let path = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes").join(name);
    etendue::desc::load(&path, None).expect("a scene of the repository")
}

/// Light paths of a kind, on the calling thread.
pub fn shot(scene: &Scene, desc: &RenderDesc, kind: MapKind, paths: u32) -> PhotonBatch {
    let job = PhotonJob { kind, paths, pass: 0, most: usize::MAX, narrow_below: NARROW, time: 0.0 };
    shoot(scene, desc, job, &mut Alone::default()).expect("nothing stops it")
}

pub fn seeded(seed: u64) -> RenderDesc {
    RenderDesc { seed, ..RenderDesc::default() }
}

/// Power of a shot's photons, red.
pub fn stored(shot: &PhotonBatch) -> f64 {
    shot.photons.iter().map(|photon| f64::from(photon.power[0])).sum()
}

/// Mean over [`RUNS`] runs with seeds of their own, and its standard error; two runs at a time.
pub fn runs(one: impl Fn(u64) -> f64 + Sync) -> (f64, f64) {
    let [found] = many_runs(|seed| [one(seed)]);
    found
}

/// The same of several numbers.
fn many_runs<const N: usize>(one: impl Fn(u64) -> [f64; N] + Sync) -> [(f64, f64); N] {
    let half = |first: u64| (first..=u64::from(RUNS)).step_by(2).map(&one).collect::<Vec<_>>();
    let values = std::thread::scope(|scope| {
        let other = scope.spawn(|| half(2));
        let mut values = half(1);
        values.extend(other.join().expect("no run panics"));
        values
    });
    std::array::from_fn(|i| stats::mean_and_error(&values.iter().map(|value| value[i]).collect::<Vec<_>>()))
}

fn map(shot: PhotonBatch) -> PhotonMap {
    PhotonMap::build(shot.photons, &Cancel::new()).expect("nothing stops it")
}

/// Irradiance by all photons within a radius, red.
fn fixed(map: &PhotonMap, p: Vec3, normal: Vec3, kernel: KernelDesc, radius: f32) -> f64 {
    asked(map, p, normal, MapQuery { kernel: Kernel::new(kernel), radius, neighbours: None })
}

fn asked(map: &PhotonMap, p: Vec3, normal: Vec3, asked: MapQuery) -> f64 {
    f64::from(irradiance(map, p, normal, asked, &mut Nearest::default()).r())
}

/// Images with seeds of their own, one after the other on two threads each.
fn images(scene: &Scene, desc: &RenderDesc, runs: u32) -> Vec<Image> {
    let one = |seed: u32| render_scene(scene, RenderDesc { seed: u64::from(seed), ..desc.clone() }).0;
    (1..=runs).map(one).collect()
}

/// Mean over images of what a part of each comes to, and its standard error.
fn over(images: &[Image], part: impl Fn(&Image) -> f64) -> (f64, f64) {
    stats::mean_and_error(&images.iter().map(part).collect::<Vec<_>>())
}

/// Mean of all pixels and channels.
fn grey_mean(image: &Image) -> f64 {
    image.mean().iter().sum::<f64>() / 3.0
}

/// A method with so many light paths of each map and this radius.
fn method(integrator: IntegratorDesc, side: u32, samples: u32, (paths, radius): (u32, f64)) -> RenderDesc {
    RenderDesc {
        resolution: [side, side],
        samples,
        integrator,
        photons: photons(paths, radius),
        ..RenderDesc::default()
    }
}

fn photons(paths: u32, radius: f64) -> PhotonDesc {
    PhotonDesc {
        count: Some(paths),
        caustic_count: Some(paths),
        radius: Some(radius),
        caustic_radius: Some(radius),
        // Estimates of so few photons, too, so that none is chosen for having found many (M65c shows what that does).
        min_photons: 1,
        ..PhotonDesc::default()
    }
}

/// A scene looked at by a camera that does not matter.
pub fn unseen(surfaces: Vec<Surface>) -> SceneDesc {
    scene(camera(DVec3::new(0.1, 0.2, 0.3), DVec3::new(0.3, -1.0, 0.1), 40.0), surfaces)
}

/// Adds a mesh with a material.
fn add_mesh(desc: &mut SceneDesc, mesh: etendue::desc::MeshDesc, bsdf: BsdfDesc, emission: Option<Rgb>) {
    let number = desc.surfaces.len();
    add(desc, number, ShapeDesc::Mesh { mesh: desc.meshes.len(), smooth: false }, bsdf, emission);
    desc.meshes.push(Arc::new(mesh));
}
