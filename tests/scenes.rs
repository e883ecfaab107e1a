//! The scenes of the repository, and the report's own files: they load, build, render, and are as bright as an independent
//! renderer says.

mod common;

use std::path::{Path, PathBuf};

use common::scenes::render_scene;
use etendue::desc::{self, BsdfDesc, RenderDesc, SceneDesc};
use etendue::scene::{BuildOptions, Scene};
use etendue::spectrum::Rgb;

fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes")
}

/// Mean of each channel and its relative standard error.
fn means(desc: &SceneDesc, resolution: u32, samples: u32) -> ([f64; 3], [f64; 3]) {
    let scene = Scene::build(desc, &BuildOptions::default()).expect("a scene that builds");
    let render = RenderDesc { resolution: [resolution; 2], samples, ..desc.render.clone() };
    let (image, _) = render_scene(&scene, render);
    let mean = image.mean();
    let mut variance = [0.0; 3];
    for pixel in image.layer("variance").expect("always there").data.chunks_exact(3) {
        variance.iter_mut().zip(pixel).for_each(|(sum, &value)| *sum += f64::from(value));
    }
    let pixels = f64::from(resolution * resolution);
    (mean, std::array::from_fn(|c| variance[c].sqrt() / pixels / mean[c]))
}

/// Every channel within 0.3 % of the reference, with a standard error that proves it.
fn check(what: &str, desc: &SceneDesc, reference: [f64; 3]) {
    let (mean, error) = means(desc, 256, 48);
    println!("{what}: {mean:.6?}, relative standard error {error:.6?}, reference {reference:?}");
    for channel in 0..3 {
        assert!(error[channel] < 0.75e-3, "{what}: {error:?} proves nothing");
        let off = mean[channel] / reference[channel] - 1.0;
        assert!(off.abs() < 3e-3, "{what}: channel {channel} is off by {off}");
    }
}

#[test]
fn every_scene_renders() {
    let mut count = 0;
    for entry in folder().read_dir().expect("the folder of scenes") {
        let path = entry.expect("an entry").path();
        if path.extension().is_none_or(|extension| extension != "json") {
            continue;
        }
        let desc = match desc::load(&path, None) {
            Ok(desc) => desc,
            Err(error) if path.ends_with("million.json") => {
                eprintln!("SKIPPED: {error} (`make meshes` makes it)");
                continue;
            }
            Err(error) => panic!("{error}"),
        };
        assert!(desc.warnings.is_empty(), "{}: {:?}", path.display(), desc.warnings);
        let (mean, _) = means(&desc, 24, 4);
        assert!(mean.iter().all(|mean| (1e-3..10.0).contains(mean)), "{}: {mean:?}", path.display());
        count += 1;
    }
    assert!(count >= 9, "{count} scenes");
}

#[test]
fn room_and_cornell_box_are_as_bright_as_in_mitsuba() {
    // Mitsuba 3.9.1, path integrator, 16384 and 13120 samples per pixel, standard errors below 2e-5
    // (peers/mitsuba/reference.py).
    for (name, reference) in
        [("room.json", [0.369_649, 0.350_598, 0.273_881]), ("cornell.json", [0.245_401, 0.142_464, 0.060_474])]
    {
        check(name, &desc::load(&folder().join(name), None).expect(name), reference);
    }
}

#[test]
fn the_reports_file_is_as_bright_as_its_own_renderer_repaired() {
    let data = std::env::var_os("ETENDUE_MCRT_DATA")
        .map_or_else(|| Path::new(env!("CARGO_MANIFEST_DIR")).join("../shared/data/mcrt"), PathBuf::from);
    let file = data.join("scene.json");
    if !file.is_file() {
        eprintln!("SKIPPED: {} is not there (set ETENDUE_MCRT_DATA)", file.display());
        return;
    }
    // That renderer's mirrors reflect 0.9, whatever their colour.
    let mut desc = desc::load(&file, None).expect("the report's scene");
    for material in &mut desc.materials {
        if let BsdfDesc::Mirror { reflectance } = &mut material.bsdf {
            *reflectance = Rgb::splat(0.9);
        }
    }
    check("the report's scene", &desc, [0.359_15, 0.340_43, 0.268_02]);
}
