//! Scenes with textures against closed forms.

use std::ops::ControlFlow;

use etendue::desc::{
    BsdfDesc, ConductorDesc, MicrofacetsDesc, PrincipledDesc, SceneDesc, ShapeDesc, TextureBinding, TextureChannel,
    TextureDesc, TextureKey, TextureMapping, TextureSource,
};
use etendue::math::DVec3;
use etendue::render::{Render, RenderSettings};
use etendue::sampling::Rng;
use etendue::scene::{BuildOptions, Scene};
use etendue::spectrum::Rgb;
use etendue::texture::{ColorSpace, Pattern, Procedural, TextureFilter};

use super::{FILTERS, described, image};
use crate::common::scenes::{Job, box_inside, camera, mean_and_error, point_light, render, scene};
use crate::record::{Case, Entry, Within};

pub fn cases() -> Vec<Entry> {
    vec![
        Entry { id: "X6", title: "light that passes a leaf", run: leaf },
        Entry { id: "X7", title: "tilted normals", run: tilted },
        Entry { id: "X8", title: "textures of one value", run: constant },
        Entry { id: "X9", title: "furnace of varying roughness", run: furnace },
        Entry { id: "X10", title: "any number of threads", run: threads },
    ]
}

const PI: f64 = std::f64::consts::PI;

fn bind(key: TextureKey, texture: usize) -> TextureBinding {
    TextureBinding { key, texture, channel: TextureChannel::Default, strength: 1.0, cutoff: 0.0 }
}

pub(super) fn quad(corners: [[f64; 3]; 4]) -> ShapeDesc {
    ShapeDesc::Quad(corners.map(DVec3::from_array))
}

/// Adds a texture and binds it to a parameter of a material.
pub fn vary(desc: &mut SceneDesc, material: usize, key: TextureKey, texture: TextureDesc) {
    let texture = desc.add_texture(texture).expect("a texture of the test");
    let mut textures = desc.materials[material].textures.clone();
    textures.push(bind(key, texture));
    desc.set_material_textures(material, textures).expect("a binding of the test");
}

/// The mean over a square [-1, 1]^2 by the rule of the middle.
fn mean_over_square(f: impl Fn(f64, f64) -> f64) -> f64 {
    const N: u32 = 512;
    let place = |i: u32| 2.0 * (f64::from(i) + 0.5) / f64::from(N) - 1.0;
    let sum: f64 = (0..N).flat_map(|i| (0..N).map(move |j| (i, j))).map(|(i, j)| f(place(i), place(j))).sum();
    sum / f64::from(N * N)
}

/// A leaf of 4 x 4 opacities before a lamp, and its shadow under a point light.
fn leaf(case: &mut Case) {
    let mut rng = Rng::new(7, 0);
    let opacities: Vec<f32> = (0..16).map(|i| if i % 3 == 0 { 1.0 } else { rng.next_f32() }).collect();
    let of = |x: u32, y: u32| opacities[(4 * y + x) as usize];
    let leaf = image(4, 4, 2, |x, y, c| if c == 1 { of(x, y) } else { 0.3 });
    let opacity = || described("leaf", &leaf, ColorSpace::Raw, TextureFilter::Nearest, 1.0);
    let samples = case.count(256, 16_384) as u32;

    let lamp = quad([[-9.0, -9.0, -1.0], [9.0, -9.0, -1.0], [9.0, 9.0, -1.0], [-9.0, 9.0, -1.0]]);
    let square = quad([[-1.0, -1.0, 0.0], [1.0, -1.0, 0.0], [1.0, 1.0, 0.0], [-1.0, 1.0, 0.0]]);
    let mut desc = scene(
        camera(DVec3::Z, DVec3::ZERO, 90.0),
        vec![(square, BsdfDesc::Black, None), (lamp, BsdfDesc::Black, Some(Rgb::ONE))],
    );
    vary(&mut desc, 0, TextureKey::Opacity, opacity());
    let covered = opacities.iter().map(|v| f64::from(*v)).sum::<f64>() / 16.0;
    let (image, _) = render(&desc, &Job { samples, ..Job::default() });
    case.mean("seen through the leaf", mean_and_error(&image), 1.0 - covered, 5e-3);
    let mut mask = desc.clone();
    let bindings = mask.materials[0].textures.iter().map(|binding| TextureBinding { cutoff: 0.6, ..*binding });
    let bindings = bindings.collect();
    mask.set_material_textures(0, bindings).expect("a binding of the test");
    let there = opacities.iter().filter(|opacity| **opacity >= 0.6).count() as f64 / 16.0;
    let (image, _) = render(&mask, &Job { samples, ..Job::default() });
    case.mean("seen through a mask", mean_and_error(&image), 1.0 - there, 5e-3);

    // The leaf lies half way between the light and the floor, and its shadow fills the picture.
    let side = 0.45;
    let leaf = quad([[-side, 1.0, -side], [side, 1.0, -side], [side, 1.0, side], [-side, 1.0, side]]);
    let floor = quad([[-9.0, 0.0, 9.0], [9.0, 0.0, 9.0], [9.0, 0.0, -9.0], [-9.0, 0.0, -9.0]]);
    let white = BsdfDesc::Lambert { albedo: Rgb::splat(0.5) };
    let mut desc =
        scene(camera(0.9 * DVec3::Y, DVec3::ZERO, 90.0), vec![(leaf, BsdfDesc::Black, None), (floor, white, None)]);
    desc.lights.push(point_light(2.0 * DVec3::Y, 10.0));
    vary(&mut desc, 0, TextureKey::Opacity, opacity());
    let (image, _) = render(&desc, &Job { samples, ..Job::default() });
    let texel = |x: f64| ((0.5 * (x + 1.0) * 4.0) as u32).min(3);
    let exact = mean_over_square(|x, z| {
        let d2 = 0.81 * (x * x + z * z) + 4.0;
        // v grows along z, rows of the image grow down.
        let passes = 1.0 - f64::from(of(texel(x), 3 - texel(z)));
        0.5 / PI * 10.0 * 2.0 / d2.powf(1.5) * passes
    });
    case.mean("its shadow", mean_and_error(&image), exact, 5e-3);
}

/// A flat floor with the normals of another plane, by a map of normals and by a height.
fn tilted(case: &mut Case) {
    let floor = || quad([[-1.0, 0.0, 1.0], [1.0, 0.0, 1.0], [1.0, 0.0, -1.0], [-1.0, 0.0, -1.0]]);
    let white = BsdfDesc::Lambert { albedo: Rgb::splat(0.5) };
    let light = DVec3::new(1.5, 2.0, 1.0);
    let samples = case.count(64, 1024) as u32;
    let mut shown = |what: &str, normal: DVec3, key: TextureKey, texture: TextureDesc, strength: f32| {
        let mut desc = scene(camera(DVec3::Y, DVec3::ZERO, 90.0), vec![(floor(), white, None)]);
        desc.lights.push(point_light(light, 10.0));
        let texture = desc.add_texture(texture).expect("a texture of the test");
        let binding = TextureBinding { strength, ..bind(key, texture) };
        desc.set_material_textures(0, vec![binding]).expect("a binding of the test");
        let (image, _) = render(&desc, &Job { samples, ..Job::default() });
        let exact = mean_over_square(|x, z| {
            let way = light - DVec3::new(x, 0.0, z);
            0.5 / PI * 10.0 * normal.dot(way.normalize()).max(0.0) / way.length_squared()
        });
        let (mean, error) = mean_and_error(&image);
        case.mean(what, (mean, error.max(1e-6 * exact)), exact, 2e-3);
    };
    // x along u, which is x here; y along v, which is -z.
    for (x, y) in [(0.0, 0.0), (0.5, 0.0), (0.0, 0.5), (-0.3, 0.4)] {
        let map = DVec3::new(x, y, (1.0_f64 - x * x - y * y).sqrt());
        let encoded = (0.5 * map + DVec3::splat(0.5)).to_array();
        let map_image = image(1, 1, 3, |_, _, c| encoded[c as usize] as f32);
        let texture = described("normals", &map_image, ColorSpace::Raw, TextureFilter::Bilinear, 1.0);
        shown(&format!("map of ({x}, {y})"), DVec3::new(x, map.z, -y), TextureKey::Normal, texture, 1.0);
    }
    // An image that is mirrored on the surface shows the normals in the mirror, one that is turned by a right angle turned ones.
    let map = DVec3::new(0.5, 0.2, (1.0_f64 - 0.29).sqrt());
    let encoded = (0.5 * map + DVec3::splat(0.5)).to_array();
    let map_image = image(1, 1, 3, |_, _, c| encoded[c as usize] as f32);
    let texture = described("normals", &map_image, ColorSpace::Raw, TextureFilter::Bilinear, 1.0);
    let mirrored = TextureMapping::Uv { set: 0, scale: [-1.0, 1.0], rotation: 0.0, offset: [0.0; 2] };
    let mirrored = TextureDesc { mapping: mirrored, ..texture.clone() };
    shown("mirrored map", DVec3::new(-map.x, map.z, -map.y), TextureKey::Normal, mirrored, 1.0);
    // Coordinates that are turned counter-clockwise show the image turned clockwise: its x is -v here and its y is u.
    let turned = TextureMapping::Uv { set: 0, scale: [1.0; 2], rotation: 0.5 * PI, offset: [0.0; 2] };
    let turned = TextureDesc { mapping: turned, ..texture };
    shown("turned map", DVec3::new(map.y, map.z, map.x), TextureKey::Normal, turned, 1.0);
    // From end to end the ramp is four long.
    for strength in [0.8_f32, -1.5] {
        let ramp = TextureDesc {
            name: "ramp".into(),
            path: String::new(),
            source: TextureSource::Procedural(Procedural {
                pattern: Pattern::Gradient,
                colors: [Rgb::ZERO, Rgb::ONE],
                in_space: false,
            }),
            // The ramp goes on beyond the floor.
            vertex_colors: false,
            mapping: TextureMapping::Uv { set: 0, scale: [0.5; 2], rotation: 0.0, offset: [0.25; 2] },
        };
        let normal = DVec3::new(-0.25 * f64::from(strength), 1.0, 0.0).normalize();
        shown(&format!("height that grows by {strength}"), normal, TextureKey::Bump, ramp, strength);
    }
}

/// A texture that is the same everywhere gives the picture of its value as a parameter.
fn constant(case: &mut Case) {
    let rough = |roughness: f32| MicrofacetsDesc { roughness, ..MicrofacetsDesc::default() };
    let principled = PrincipledDesc { base_color: Rgb::splat(0.5), coat_weight: 0.75, ..PrincipledDesc::default() };
    let models: [(&str, BsdfDesc, BsdfDesc, TextureKey, f32); 6] = [
        (
            "colour",
            BsdfDesc::Lambert { albedo: Rgb::splat(0.8) },
            BsdfDesc::Lambert { albedo: Rgb::splat(0.8 * 0.5) },
            TextureKey::Color,
            0.5,
        ),
        (
            "roughness of glass",
            BsdfDesc::RoughDielectric { ior: 1.5, exterior_ior: 1.0, microfacets: rough(1.0) },
            BsdfDesc::RoughDielectric { ior: 1.5, exterior_ior: 1.0, microfacets: rough(0.5) },
            TextureKey::Roughness,
            0.5,
        ),
        (
            "roughness of glass, down to a smooth surface",
            BsdfDesc::RoughDielectric { ior: 1.5, exterior_ior: 1.0, microfacets: rough(1.0) },
            BsdfDesc::Dielectric { ior: 1.5, exterior_ior: 1.0 },
            TextureKey::Roughness,
            0.0,
        ),
        (
            "colour under a coat",
            BsdfDesc::CoatedDiffuse { albedo: Rgb::ONE, ior: 1.5, exterior_ior: 1.0, microfacets: rough(0.3) },
            BsdfDesc::CoatedDiffuse { albedo: Rgb::splat(0.25), ior: 1.5, exterior_ior: 1.0, microfacets: rough(0.3) },
            TextureKey::Color,
            0.25,
        ),
        (
            "metalness of a coated principled surface",
            BsdfDesc::Principled(PrincipledDesc { base_metalness: 1.0, ..principled }),
            BsdfDesc::Principled(PrincipledDesc { base_metalness: 0.5, ..principled }),
            TextureKey::BaseMetalness,
            0.5,
        ),
        (
            "roughness of a coated principled surface",
            BsdfDesc::Principled(PrincipledDesc { specular_roughness: 1.0, ..principled }),
            BsdfDesc::Principled(PrincipledDesc { specular_roughness: 0.25, ..principled }),
            TextureKey::SpecularRoughness,
            0.25,
        ),
    ];
    let samples = case.count(16, 64) as u32;
    for (what, textured, plain, key, value) in models {
        let of = |bsdf: BsdfDesc| {
            let ball = ShapeDesc::Sphere { centre: DVec3::new(0.0, 0.8, 0.0), radius: 0.8 };
            let floor = quad([[-4.0, 0.0, 4.0], [4.0, 0.0, 4.0], [4.0, 0.0, -4.0], [-4.0, 0.0, -4.0]]);
            let lamp = quad([[-1.0, 3.0, 1.0], [-1.0, 3.0, -1.0], [1.0, 3.0, -1.0], [1.0, 3.0, 1.0]]);
            let grey = BsdfDesc::Lambert { albedo: Rgb::splat(0.5) };
            let view = camera(DVec3::new(0.0, 1.5, 4.0), DVec3::new(0.0, 0.7, 0.0), 45.0);
            let lamp = (lamp, BsdfDesc::Black, Some(Rgb::splat(8.0)));
            scene(view, vec![(ball, bsdf, None), (floor, grey, None), lamp])
        };
        let mut varied = of(textured);
        let one = image(2, 2, 1, |_, _, _| value);
        vary(&mut varied, 0, key, described("one", &one, ColorSpace::Raw, TextureFilter::Bilinear, 1.0));
        let job = Job { samples, ..Job::default() };
        let (a, b) = (render(&varied, &job).0, render(&of(plain), &job).0);
        let largest = a.rgb.iter().zip(&b.rgb).map(|(a, b)| f64::from((a - b).abs())).fold(0.0, f64::max);
        let mean = b.mean().iter().sum::<f64>() / 3.0;
        case.at_most(format!("{what}: largest difference of a pixel, of the mean"), largest / mean, 1e-4);
    }
}

/// A metal that reflects everything, of all roughness from 0.15 to 1, in a room that shines with radiance 1.
fn furnace(case: &mut Case) {
    let room = box_inside(DVec3::splat(-3.0), DVec3::splat(3.0));
    let square = quad([[-1.0, -1.0, 0.0], [1.0, -1.0, 0.0], [1.0, 1.0, 0.0], [-1.0, 1.0, 0.0]]);
    let white = ConductorDesc::Reflectance { normal: Rgb::ONE, edge: Rgb::ONE };
    let microfacets = MicrofacetsDesc { roughness: 1.0, ..MicrofacetsDesc::default() };
    let metal = BsdfDesc::Conductor { conductor: white, microfacets };
    let view = camera(DVec3::new(0.4, 0.3, 1.2), DVec3::ZERO, 60.0);
    let mut desc = scene(view, vec![(square, metal, None)]);
    desc.meshes.push(room.into());
    let shape = ShapeDesc::Mesh { mesh: 0, smooth: false };
    crate::common::scenes::add(&mut desc, 1, shape, BsdfDesc::Black, Some(Rgb::ONE));
    let mut rng = Rng::new(9, 0);
    let values: Vec<f32> = (0..64).map(|_| 0.15 + 0.85 * rng.next_f32()).collect();
    let map = image(8, 8, 1, |x, y, _| values[(8 * y + x) as usize]);
    vary(&mut desc, 0, TextureKey::Roughness, described("map", &map, ColorSpace::Raw, TextureFilter::Bilinear, 1.0));
    let samples = case.count(256, 16_384) as u32;
    let (image, _) = render(&desc, &Job { samples, ..Job::default() });
    case.biased_mean("mean", mean_and_error(&image), 1.0, (1e-3, 1e-3));
}

/// The same bits from one thread and from three, with every filter.
fn threads(case: &mut Case) {
    let mut rng = Rng::new(11, 0);
    let texels: Vec<f32> = (0..32 * 32 * 3).map(|_| rng.next_f32()).collect();
    let colours = image(32, 32, 3, |x, y, c| texels[((32 * y + x) * 3 + c) as usize]);
    for filter in FILTERS {
        let floor = quad([[-9.0, 0.0, 3.0], [9.0, 0.0, 3.0], [9.0, 0.0, -40.0], [-9.0, 0.0, -40.0]]);
        let mirror = ShapeDesc::Sphere { centre: DVec3::new(0.0, 1.0, 0.0), radius: 1.0 };
        let lamp = quad([[-1.0, 5.0, 1.0], [-1.0, 5.0, -1.0], [1.0, 5.0, -1.0], [1.0, 5.0, 1.0]]);
        let lambert = BsdfDesc::Lambert { albedo: Rgb::ONE };
        let surfaces = vec![
            (floor, lambert, None),
            (mirror, BsdfDesc::Mirror { reflectance: Rgb::splat(0.9) }, None),
            (lamp, BsdfDesc::Black, Some(Rgb::splat(8.0))),
        ];
        let mut desc = scene(camera(DVec3::new(0.0, 1.2, 5.0), DVec3::Y, 60.0), surfaces);
        vary(&mut desc, 0, TextureKey::Color, described("colours", &colours, ColorSpace::Linear, filter, 8.0));
        let built = Scene::build(&desc, &BuildOptions::default()).expect("a scene of the test");
        let job = Job { samples: case.count(8, 64) as u32, resolution: [40, 40], ..Job::default() };
        let images = [1, 3].map(|threads| {
            let settings = RenderSettings { desc: job.desc(), threads, ..RenderSettings::default() };
            let mut render = Render::new(&built, settings).expect("settings of the test");
            render.run(&mut |_| ControlFlow::Continue(())).expect("no worker panics");
            render.image()
        });
        let differing = images[0].rgb.iter().zip(&images[1].rgb).filter(|(a, b)| a.to_bits() != b.to_bits()).count();
        case.exact(format!("{filter:?}: values that differ"), differing as f64, 0.0, Within::Absolute(0.0));
    }
}
