//! A picture behind everything: it stands in its pixels as it is, and it lights nothing.

use std::ops::ControlFlow;
use std::path::Path;

use etendue::desc::{
    self, BackplateDesc, BsdfDesc, CropDesc, EnvironmentDesc, IntegratorDesc, RenderDesc, SamplerDesc, SceneDesc,
    ShapeDesc, TextureDesc, TextureMapping, TextureSource,
};
use etendue::film::Image;
use etendue::math::DVec3;
use etendue::render::{Render, RenderSettings};
use etendue::scene::{BuildOptions, Scene};
use etendue::spectrum::Rgb;
use etendue::texture::{ColorSpace, Pattern, Procedural, TextureFilter};

use crate::common::scenes::{add, camera, mean_and_error, scene};
use crate::record::{Case, Entry, Within};
use crate::textures::{described, image};

pub fn cases() -> Vec<Entry> {
    vec![
        Entry { id: "L92", title: "a backplate, whole pictures", run: pictures },
        Entry { id: "L93", title: "a backplate, where it lies and what is before it", run: places },
    ]
}

/// Columns and rows of the pictures: powers of two, so that film positions are divided without rounding.
const SIZE: [u32; 2] = [32, 16];
const CROP: CropDesc = CropDesc { left: 5, top: 3, width: 21, height: 9 };
/// Radiance of the environment.
const SKY: f64 = 0.5;
/// What the image is multiplied by.
const FACTOR: [f32; 3] = [2.0, 1.0, 0.5];

fn rendered(desc: &SceneDesc, settings: RenderDesc) -> Image {
    let scene = Scene::build(desc, &BuildOptions::default()).expect("a scene of the test");
    let settings = RenderSettings { desc: settings, threads: 2, auxiliary: true, ..RenderSettings::default() };
    let mut render = Render::new(&scene, settings).expect("settings of the test");
    render.run(&mut |_| ControlFlow::Continue(())).expect("no worker panics");
    render.image()
}

/// A texel of the image: no two of a row or column are alike.
fn texel(x: u32, y: u32, channel: u32) -> f32 {
    (x * 7 + y * 11 + channel * 5) as f32 / 64.0
}

/// A mirror and a white floor under an even sky.
fn mirror_and_floor() -> SceneDesc {
    let eye = DVec3::new(0.0, 1.2, 6.0);
    let ball = ShapeDesc::Sphere { centre: DVec3::new(0.4, 1.0, 0.0), radius: 1.0 };
    let mirror = BsdfDesc::Mirror { reflectance: Rgb::splat(0.9) };
    let mut desc = scene(camera(eye, DVec3::new(0.0, 1.2, 0.0), 50.0), vec![(ball, mirror, None)]);
    let corner = |x: f64, z: f64| DVec3::new(x, 0.0, z);
    let floor = ShapeDesc::Quad([corner(-2.0, 2.0), corner(2.0, 2.0), corner(2.0, -2.0), corner(-2.0, -2.0)]);
    add(&mut desc, 1, floor, BsdfDesc::Lambert { albedo: Rgb::splat(0.8) }, None);
    desc.set_environment_desc(Some(EnvironmentDesc::even(Rgb::splat(SKY as f32)))).expect("a sky of the test");
    desc
}

/// Puts an image of a texel for each pixel behind a scene.
fn with_image(mut desc: SceneDesc) -> SceneDesc {
    let shown = image(SIZE[0], SIZE[1], 3, texel);
    let texture = described("behind", &shown, ColorSpace::Linear, TextureFilter::Nearest, 1.0);
    let texture = desc.add_texture(texture).expect("a texture of the test");
    let backplate = BackplateDesc { radiance: Rgb::from_array(FACTOR), texture: Some(texture) };
    desc.set_backplate(Some(backplate)).expect("a backplate of the test");
    desc
}

fn bits(values: &[f32]) -> impl Iterator<Item = u32> {
    values.iter().map(|value| value.to_bits())
}

fn pictures(case: &mut Case) {
    let base = mirror_and_floor();
    let behind = with_image(base.clone());
    let hidden = EnvironmentDesc { visible: false, ..EnvironmentDesc::even(Rgb::splat(SKY as f32)) };
    let mut under_hidden = behind.clone();
    under_hidden.set_environment_desc(Some(hidden)).expect("a sky of the test");
    for integrator in IntegratorDesc::ALL {
        let mut settings =
            RenderDesc { resolution: SIZE, samples: case.count(16, 256) as u32, integrator, ..RenderDesc::default() };
        settings.photons.count = Some(case.count(1 << 12, 1 << 16) as u32);
        let name = integrator.name();
        let (without, with) = (rendered(&base, settings.clone()), rendered(&behind, settings.clone()));
        // Of all pixels: those that show nothing else, those that show none of it, and those that are mixed.
        let (mut texels, mut other_texels, mut mixed, mut unmixed, mut off) = (0, 0, 0, 0, 0.0_f64);
        let depth = |image: &Image, place: usize| image.layer("depth").expect("asked for").data[place];
        for place in 0..(SIZE[0] * SIZE[1]) as usize {
            let [x, y] = [place as u32 % SIZE[0], place as u32 / SIZE[0]];
            let pixel = |image: &Image| image.pixel(x, y);
            let behind: [f32; 3] = std::array::from_fn(|c| FACTOR[c] * texel(x, y, c as u32));
            let [seen, before] = [pixel(&with), pixel(&without)];
            if depth(&with, place).is_infinite() {
                texels += 1;
                other_texels += u64::from(!bits(&seen).eq(bits(&behind)));
            } else if !bits(&seen).eq(bits(&before)) {
                // What a mixed pixel has gained of the image, it has lost of the sky. The share is that of least squares.
                let gained = [0, 1, 2].map(|c| f64::from(seen[c]) - f64::from(before[c]));
                let change = [0, 1, 2].map(|c| f64::from(behind[c]) - SKY);
                let product = |a: [f64; 3], b: [f64; 3]| (0..3).map(|c| a[c] * b[c]).sum::<f64>();
                let share = product(gained, change) / product(change, change);
                mixed += 1;
                unmixed += u64::from(!(share > 0.0 && share < 1.0));
                off = (0..3).fold(off, |off, c| off.max((gained[c] - share * change[c]).abs()));
            }
        }
        case.never(format!("{name}: pixels other than their texels"), other_texels, texels);
        case.exact(format!("{name}: mixed pixels, largest error"), off, 0.0, Within::Absolute(1e-5));
        case.never(format!("{name}: mixed pixels without a share of both"), unmixed, mixed);
        let layers = |image: &Image| {
            let layer = |layer: &str| bits(&image.layer(layer).expect("asked for").data).collect::<Vec<_>>();
            ["albedo", "normal", "depth"].map(layer)
        };
        case.holds(
            format!("{name}: layers of first hits"),
            "the same bits as without",
            if layers(&with) == layers(&without) { "the same" } else { "others" },
            layers(&with) == layers(&without),
        );
        let seen = rendered(&under_hidden, settings.clone());
        let other = bits(&seen.rgb).zip(bits(&with.rgb)).filter(|(a, b)| a != b).count();
        case.never(format!("{name}: values that a hidden sky changes"), other as u64, seen.rgb.len() as u64);
        let part = rendered(&behind, RenderDesc { crop: Some(CROP), ..settings });
        let mut other = 0;
        for (y, row) in part.rgb.chunks(3 * CROP.width as usize).enumerate() {
            let start = 3 * ((CROP.top as usize + y) * SIZE[0] as usize + CROP.left as usize);
            other += bits(row).zip(bits(&with.rgb[start..start + row.len()])).filter(|(a, b)| a != b).count();
        }
        case.never(format!("{name}: values of a part with other bits"), other as u64, part.rgb.len() as u64);
    }
}

/// A ramp along the first coordinate of the texture.
fn ramp(mapping: TextureMapping) -> TextureDesc {
    TextureDesc {
        name: "ramp".to_owned(),
        path: String::new(),
        source: TextureSource::Procedural(Procedural {
            pattern: Pattern::Gradient,
            colors: [Rgb::ZERO, Rgb::ONE],
            in_space: matches!(mapping, TextureMapping::Space { .. }),
        }),
        mapping,
        vertex_colors: false,
    }
}

fn uv(rotation_deg: f64, scale: f64) -> TextureMapping {
    TextureMapping::Uv { set: 0, scale: [scale; 2], rotation: f64::to_radians(rotation_deg), offset: [0.0; 2] }
}

/// What is seen of a texture behind an empty scene.
fn seen(mut desc: SceneDesc, texture: TextureDesc, settings: RenderDesc) -> Image {
    let texture = desc.add_texture(texture).expect("a texture of the test");
    desc.set_backplate(Some(BackplateDesc::of_texture(texture))).expect("a backplate of the test");
    rendered(&desc, settings)
}

fn places(case: &mut Case) {
    let read = |text: &str| desc::parse(text, Path::new("."), None).expect("a scene of the test");
    let grid = RenderDesc { resolution: SIZE, samples: 16, sampler: SamplerDesc::Grid, ..RenderDesc::default() };
    // Of any camera: the mean of a ramp over a pixel is its value in the middle.
    for (what, keys) in [
        ("pinhole", r#""fieldOfView": 40"#),
        ("shifted film, long pixels", r#""fieldOfView": 40, "shift": [0.4, -0.3], "pixelAspect": 2.5"#),
        ("lens", r#""fieldOfView": 40, "lensRadius": 0.5, "focusDistance": 3"#),
        ("orthographic", r#""type": "orthographic", "width": 3"#),
        ("spherical", r#""type": "spherical""#),
        (
            "moving",
            r#""fieldOfView": 40, "shutter": {"close": 1}, "motion": [{"time": 0}, {"time": 1, "translate": [1, 2, 3]}]"#,
        ),
    ] {
        let empty = read(&format!(r#"{{"etendue": 1, "camera": {{"origin": [0, 1, 5], {keys}}}}}"#));
        for (along, mapping) in [
            ("width", uv(0.0, 1.0)),
            ("height", uv(-90.0, 1.0)),
            ("half of the width", uv(0.0, 2.0)),
            ("width, in space", TextureMapping::Space { scale: DVec3::ONE, offset: DVec3::ZERO }),
        ] {
            let shown = seen(empty.clone(), ramp(mapping), grid.clone());
            let mut off = 0.0_f64;
            for y in 0..SIZE[1] {
                for x in 0..SIZE[0] {
                    let [u, v] = [(x, 0), (SIZE[1] - 1 - y, 1)].map(|(n, i)| (f64::from(n) + 0.5) / f64::from(SIZE[i]));
                    let exact = match along {
                        "height" => v,
                        "half of the width" => (2.0 * u).min(1.0),
                        _ => u,
                    };
                    off = shown.pixel(x, y).iter().fold(off, |off, got| off.max((f64::from(*got) - exact).abs()));
                }
            }
            case.exact(format!("{what}: ramp along the {along}, largest error"), off, 0.0, Within::Absolute(2e-6));
        }
    }
    // Levels for pixels as large as 4 x 4 texels; the image's edges do not show the opposite ones.
    let fine = image(4 * SIZE[0], 4 * SIZE[1], 1, |x, _, _| (x / 4) as f32);
    let texture = described("fine", &fine, ColorSpace::Linear, TextureFilter::Mip, 1.0);
    let shown = seen(SceneDesc::default(), texture, RenderDesc { samples: 64, ..grid.clone() });
    let [left, right] = [0, SIZE[0] - 1].map(|x| f64::from(shown.pixel(x, 7)[0]));
    // Over half a pixel towards the next one, interpolation gives a mean of 1/8 of the step.
    case.exact("levels of a fine image, at the left edge", left, 0.125, Within::Absolute(1e-3));
    case.exact("levels of a fine image, at the right edge", right, f64::from(SIZE[0]) - 1.125, Within::Absolute(1e-3));

    // What is before it.
    let even = |text: &str| {
        let mut desc = read(text);
        desc.set_backplate(Some(BackplateDesc::even(Rgb::new(3.0, 2.0, 1.0)))).expect("a backplate of the test");
        desc
    };
    let samples = case.count(64, 4096) as u32;
    let settings = RenderDesc { resolution: SIZE, samples, ..RenderDesc::default() };
    let sheet = even(
        r#"{"etendue": 1, "camera": {"origin": [0, 0, 5], "fieldOfView": 20},
            "lights": [{"type": "environment", "color": [9, 9, 9]}],
            "materials": [{"name": "veil", "type": "black", "opacity": 0.25}],
            "surfaces": [{"geometry": "quad", "material": "veil", "vertex-1": [-9, -9, 0], "vertex-2": [9, -9, 0],
                "vertex-3": [9, 9, 0], "vertex-4": [-9, 9, 0]}]}"#,
    );
    case.mean("a black veil of opacity 1/4", mean_and_error(&rendered(&sheet, settings.clone())), 0.75 * 2.0, 1e-2);
    let pond = even(
        r#"{"etendue": 1, "camera": {"origin": [0, -1, 0], "lookAt": [0, -5, 1], "fieldOfView": 20},
            "materials": [{"name": "water", "type": "refractive", "refractionIndex": 1.33, "absorption": [0.5, 0, 0]}],
            "surfaces": [{"geometry": "quad", "material": "water", "vertex-1": [-90, 0, 90], "vertex-2": [90, 0, 90],
                "vertex-3": [90, 0, -90], "vertex-4": [-90, 0, -90]}]}"#,
    );
    let under_water = rendered(&pond, settings.clone()).mean();
    for (channel, exact) in [0.0, 2.0, 1.0].into_iter().enumerate() {
        let what = format!("from within water that absorbs red, channel {channel}");
        case.exact(what, under_water[channel], exact, Within::Absolute(0.0));
    }
    // A pane and a mirror show the environment, which is black here.
    for (what, material) in [
        ("a mirror", r#""type": "reflective", "color": [1, 1, 1]"#),
        ("a thin pane", r#""type": "thin-refractive", "refractionIndex": 1.5"#),
    ] {
        let before = even(&format!(
            r#"{{"etendue": 1, "camera": {{"origin": [0, 0, 5], "fieldOfView": 20}},
                "materials": [{{"name": "m", {material}}}],
                "surfaces": [{{"geometry": "quad", "material": "m", "vertex-1": [-9, -9, 0], "vertex-2": [9, -9, 0],
                    "vertex-3": [9, 9, 0], "vertex-4": [-9, 9, 0]}}]}}"#
        ));
        let mean = rendered(&before, settings.clone()).mean().iter().sum::<f64>();
        case.exact(format!("{what} before it, under no sky"), mean, 0.0, Within::Absolute(0.0));
    }
    // Beyond the circle of a fisheye there is nothing.
    let round = even(r#"{"etendue": 1, "camera": {"type": "fisheye", "origin": [0, 0, 0]}}"#);
    let round = rendered(&round, settings);
    case.exact("fisheye, in the middle", round.pixel(16, 8)[0].into(), 3.0, Within::Absolute(0.0));
    case.exact("fisheye, at a corner", round.pixel(0, 0)[0].into(), 0.0, Within::Absolute(0.0));
}
