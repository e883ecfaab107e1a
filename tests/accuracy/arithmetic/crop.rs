//! A part of a picture: the same bytes as in the whole picture, at the cost of the part.

use std::ops::ControlFlow;

use etendue::desc::{
    CameraDesc, CropDesc, FilmDesc, FilterDesc, FovAxis, IntegratorDesc, LensDesc, PhotonDesc, RadiosityDesc,
    RenderDesc, SamplerDesc, SceneDesc,
};
use etendue::film::Image;
use etendue::math::DVec3;
use etendue::render::{Render, RenderSettings, Summary};
use etendue::scene::{BuildOptions, Scene};

use super::repeat::load;
use crate::record::{Case, Entry, Within};

pub fn cases() -> Vec<Entry> {
    vec![Entry { id: "C80", title: "part of a picture", run: crop }]
}

/// Sides that are no multiples of a tile's.
const SIZE: [u32; 2] = [45, 37];

/// A part that begins in the middle of a tile, a row of pixels, and the last pixel.
const PARTS: [CropDesc; 3] = [
    CropDesc { left: 13, top: 6, width: 21, height: 18 },
    CropDesc { left: 0, top: 36, width: 45, height: 1 },
    CropDesc { left: 44, top: 36, width: 1, height: 1 },
];

fn build(desc: &SceneDesc) -> Scene {
    Scene::build(desc, &BuildOptions::default()).expect("a scene of the project")
}

fn render(scene: &Scene, desc: RenderDesc) -> (Image, Summary) {
    let settings = RenderSettings { desc, threads: 2, auxiliary: true, ..RenderSettings::default() };
    let mut render = Render::new(scene, settings).expect("settings of the test");
    let summary = render.run(&mut |_| ControlFlow::Continue(())).expect("no worker panics");
    (render.image(), summary)
}

/// Values with other bits than the whole picture has there, and all values that were compared.
fn other_bits(whole: &Image, part: &Image, crop: CropDesc) -> [u64; 2] {
    let layers = |image: &Image| {
        let colour = std::iter::once((3, image.rgb.clone()));
        colour.chain(image.layers.iter().map(|layer| (layer.channels, layer.data.clone()))).collect::<Vec<_>>()
    };
    let (mut bad, mut tried) = (0, 0);
    for ((channels, whole_data), (_, data)) in layers(whole).into_iter().zip(layers(part)) {
        let row = crop.width as usize * channels;
        for (y, found) in data.chunks(row).enumerate() {
            let start = ((crop.top as usize + y) * whole.width as usize + crop.left as usize) * channels;
            let bits = found.iter().zip(&whole_data[start..start + row]);
            bad += bits.filter(|(a, b)| a.to_bits() != b.to_bits()).count() as u64;
            tried += row as u64;
        }
    }
    assert_eq!([part.width, part.height], [crop.width, crop.height]);
    [bad, tried]
}

fn crop(case: &mut Case) {
    let samples = case.count(8, 64) as u32;
    let base = RenderDesc {
        resolution: SIZE,
        samples,
        photons: PhotonDesc {
            count: Some(case.count(2000, 20_000) as u32),
            caustic_count: Some(case.count(1000, 20_000) as u32),
            ..PhotonDesc::default()
        },
        radiosity: RadiosityDesc { element_size: Some(0.5), error: 20.0, ..RadiosityDesc::default() },
        reuse: Some(false),
        light_paths: Some(false),
        ..RenderDesc::default()
    };
    let mut compare = |what: String, scene: &Scene, desc: &RenderDesc| {
        let (whole, _) = render(scene, desc.clone());
        let mut sums = [0; 2];
        for part in PARTS {
            let (image, _) = render(scene, RenderDesc { crop: Some(part), ..desc.clone() });
            let found = other_bits(&whole, &image, part);
            sums = [sums[0] + found[0], sums[1] + found[1]];
        }
        case.never(format!("{what}: values with other bits"), sums[0], sums[1]);
    };
    let cornell = build(&load("cornell.json"));
    for integrator in IntegratorDesc::ALL {
        compare(integrator.name().to_owned(), &cornell, &RenderDesc { integrator, ..base.clone() });
    }
    let room = load("room.json");
    let scene = build(&room);
    compare("path, reuse".to_owned(), &scene, &RenderDesc { reuse: Some(true), ..base.clone() });
    let lit = RenderDesc { light_paths: Some(true), filter: FilterDesc::Gaussian { sigma: 0.5 }, ..base.clone() };
    compare("path, light paths".to_owned(), &scene, &lit);
    for (name, sampler, filter) in [
        ("random, mitchell", SamplerDesc::Random, FilterDesc::Mitchell { b: 1.0 / 3.0, c: 1.0 / 3.0 }),
        ("jittered, gaussian", SamplerDesc::Jittered, FilterDesc::Gaussian { sigma: 0.5 }),
        ("grid, tent", SamplerDesc::Grid, FilterDesc::Tent),
        ("gaussian, box", SamplerDesc::Gaussian, FilterDesc::Box),
    ] {
        compare(name.to_owned(), &scene, &RenderDesc { sampler, filter, ..base.clone() });
    }
    let [eye, look_at, up] = room.camera.view();
    let film = FilmDesc { shift: [0.2, -0.3], pixel_aspect: 1.4 };
    let lens = LensDesc::new(0.05);
    let camera = CameraDesc::ThinLens { eye, look_at, up, fov_deg: 50.0, fov_axis: FovAxis::Horizontal, lens, film };
    compare("lens, shifted film".to_owned(), &build(&SceneDesc { camera, ..room }), &base);

    // Rays into the dark: as many as samples are asked for.
    let camera = CameraDesc::Perspective {
        eye: DVec3::ZERO,
        look_at: DVec3::NEG_Z,
        up: DVec3::Y,
        fov_deg: 60.0,
        fov_axis: FovAxis::Horizontal,
        film: FilmDesc::default(),
    };
    let mut dark = load("cornell.json");
    dark.camera = camera;
    dark.surfaces.clear();
    (dark.meshes, dark.lights) = (Vec::new(), Vec::new());
    dark.motion = Default::default();
    let scene = build(&dark);
    for part in PARTS {
        let (image, summary) = render(&scene, RenderDesc { crop: Some(part), ..base.clone() });
        let pixels = f64::from(part.width * part.height);
        let what = format!("{} x {} pixels of {} x {}", part.width, part.height, SIZE[0], SIZE[1]);
        case.exact(format!("{what}: rays"), summary.rays as f64, pixels * f64::from(samples), Within::Absolute(0.0));
        case.exact(format!("{what}: values"), image.rgb.len() as f64, 3.0 * pixels, Within::Absolute(0.0));
    }
}
