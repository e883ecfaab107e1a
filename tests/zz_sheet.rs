//! Contact sheet of what is read.
mod common;
use common::scenes::render_scene;
use etendue::desc::{self, CameraDesc};
use etendue::math::DVec3;
use etendue::scene::{BuildOptions, Scene};
use etendue::spectrum::Rgb;
use std::path::{Path, PathBuf};
fn files_below(folder: &Path) -> Vec<PathBuf> {
    let (mut found, mut open) = (Vec::new(), vec![folder.to_owned()]);
    while let Some(folder) = open.pop() {
        for entry in folder.read_dir().unwrap() {
            let path = entry.unwrap().path();
            if path.is_dir() {
                open.push(path);
            } else if path.extension().is_some_and(|it| it == "gltf" || it == "glb") {
                found.push(path);
            }
        }
    }
    found.sort();
    found
}
#[test]
fn sheet() {
    let mut pictures = Vec::new();
    for path in files_below(Path::new("/usr/share/assimp/models/glTF2")) {
        let Ok(mut scene) = desc::load(&path, None) else { continue };
        let CameraDesc::Perspective { eye, look_at, .. } = scene.camera else { panic!() };
        let d = (eye - look_at).length();
        if scene.lights.is_empty() {
            scene.add_point_light(eye + DVec3::new(0.3, 0.5, 0.0) * d, Rgb::splat((6.0 * d * d) as f32)).unwrap();
            scene.add_point_light(look_at + DVec3::new(-1.5, 0.5, 0.5) * d, Rgb::splat((3.0 * d * d) as f32)).unwrap();
        }
        scene.render.resolution = [64, 64];
        scene.render.samples = 16;
        let built = Scene::build(&scene, &BuildOptions::default()).unwrap();
        let (image, _) = render_scene(&built, scene.render.clone());
        eprintln!("{} {} {:?} eye {eye} at {look_at}", pictures.len(), path.display(), image.mean());
        pictures.push(image);
    }
    let columns = 6;
    let rows = pictures.len().div_ceil(columns);
    let mut ppm = format!("P6\n{} {}\n255\n", columns * 64, rows * 64).into_bytes();
    for y in 0..rows * 64 {
        for x in 0..columns * 64 {
            let i = y / 64 * columns + x / 64;
            let p = pictures.get(i).map_or([0.2; 3], |it| it.pixel(x as u32 % 64, y as u32 % 64));
            ppm.extend(p.map(|v| (255.0 * v.clamp(0.0, 1.0).powf(1.0 / 2.2)) as u8));
        }
    }
    std::fs::write("/tmp/wt/scratch-h3/sheet.ppm", ppm).unwrap();
}
