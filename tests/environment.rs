//! An even sky: what files and calls say of it, and that every integrator which takes it gives the known answer.

mod common;

use std::path::Path;
use std::sync::Arc;

use common::scenes::{Job, render_scene};
use etendue::ErrorKind;
use etendue::desc::{
    self, BackplateDesc, BsdfDesc, EnvironmentDesc, EnvironmentMapDesc, HosekWilkieDesc, ImageTextureDesc,
    IntegratorDesc, PortalDesc, RenderDesc, SceneDesc, ShapeDesc, SkyDesc, SurfaceLook, TextureDesc, TextureMapping,
    TextureSource,
};
use etendue::math::{DAffine3, DVec3};
use etendue::scene::{BuildOptions, Scene};
use etendue::spectrum::Rgb;
use etendue::texture::{ColorSpace, Pattern, Procedural, TexelImage, Texels, TextureFilter, Wrap};
use serde_json::{Value, json};

fn parse(lights: &Value) -> Result<SceneDesc, etendue::Error> {
    let scene = json!({"etendue": 1, "camera": {"origin": [0, 0, 4], "fieldOfView": 40}, "lights": lights,
        "materials": [{"name": "white", "type": "diffuse", "color": [1, 1, 1]}],
        "surfaces": [{"geometry": "sphere", "origin": [0, 0, 0], "radius": 1, "material": "white"}]});
    desc::parse(&scene.to_string(), Path::new(""), None)
}

#[test]
fn a_file_has_one_environment_at_most() {
    let scene = parse(&json!([{"type": "environment", "color": [0.5, 1, 2], "intensity": 3}])).unwrap();
    let environment = scene.environment.expect("an environment");
    assert_eq!((environment.path.as_str(), environment.radiance), ("lights[0]", Rgb::new(1.5, 3.0, 6.0)));
    assert_eq!(
        parse(&json!([{"type": "environment", "color": [0.5, 1, 2]}])).unwrap().environment.unwrap().radiance.b(),
        2.0
    );
    assert!(parse(&json!([])).unwrap().environment.is_none());
    for (lights, place, message) in [
        (json!([{"type": "environment"}]), "lights[0]", "missing key `color`"),
        (json!([{"type": "environment", "color": [1, -1, 1]}]), "lights[0].color[1]", "-1 is negative"),
        (
            json!([{"type": "environment", "color": [1, 1, 1], "intensity": -1}]),
            "lights[0].intensity",
            "-1 is negative",
        ),
        (json!([{"type": "environment", "color": [1e30, 1, 1], "intensity": 1e30}]), "lights[0].color[0]", "precision"),
        (
            json!([{"type": "environment", "color": [1, 1, 1], "origin": [0, 0, 0]}]),
            "lights[0]",
            "unknown key `origin`",
        ),
        (
            json!([{"type": "environment", "color": [1, 1, 1]}, {"type": "environment", "color": [1, 1, 1]}]),
            "lights[1]",
            "lights[0] is an environment already, expected one at most",
        ),
        (json!([{"type": "enviroment", "color": [1, 1, 1]}]), "lights[0].type", "did you mean 'environment'?"),
    ] {
        let error = parse(&lights).unwrap_err();
        assert_eq!(error.kind(), ErrorKind::InvalidScene);
        assert!(error.location().json_path.starts_with(place) && error.message().contains(message), "{error}");
    }
}

/// A scene with a pattern and an image as its textures.
fn with_textures(light: &Value) -> Result<SceneDesc, etendue::Error> {
    let folder = tempfile::tempdir().unwrap();
    let mut pixels = image::RgbImage::new(4, 2);
    pixels.put_pixel(1, 0, image::Rgb([255, 128, 0]));
    pixels.save(folder.path().join("sky.png")).unwrap();
    pixels.put_pixel(1, 0, image::Rgb([0; 3]));
    pixels.save(folder.path().join("black.png")).unwrap();
    let scene = json!({"etendue": 1, "camera": {"origin": [0, 0, 4], "fieldOfView": 40}, "lights": [light],
    "textures": [
        {"name": "sky", "type": "image", "file": "sky.png"},
        {"name": "black", "type": "image", "file": "black.png"},
        {"name": "squares", "type": "checker", "scale": [8, 4]},
        {"name": "turned", "type": "image", "file": "sky.png", "rotation": 10},
        {"name": "boxed", "type": "checker", "coordinates": "box"},
        {"name": "colored", "type": "image", "file": "sky.png", "vertexColors": true}]});
    desc::parse(&scene.to_string(), folder.path(), None)
}

#[test]
fn a_texture_varies_a_sky() {
    let read = |light: Value| with_textures(&light).unwrap().environment.unwrap();
    let plain = read(json!({"type": "environment", "texture": "sky"}));
    assert_eq!(
        (plain.radiance, plain.map().copied(), plain.visible),
        (Rgb::ONE, Some(EnvironmentMapDesc::new(0)), true)
    );
    let turned = read(json!({"type": "environment", "texture": "squares", "color": [1, 2, 3], "intensity": 2,
        "up": [0, 0, 2], "rotation": -30, "visible": false}));
    let map = EnvironmentMapDesc { up: DVec3::Z * 2.0, rotation_deg: -30.0, ..EnvironmentMapDesc::new(2) };
    assert_eq!((turned.radiance, turned.map().copied(), turned.visible), (Rgb::new(2.0, 4.0, 6.0), Some(map), false));
    // With z up, the middle of the image is towards +y, and by -30 degrees to the right of it.
    let middle = map.to_world() * -DVec3::Z;
    assert!(middle.distance(DVec3::new(0.5, 0.75_f64.sqrt(), 0.0)) < 1e-12, "{middle}");
    for (light, place, message) in [
        (json!({"texture": "skye"}), "lights[0].texture", "no texture named 'skye'; did you mean 'sky'?"),
        (json!({"texture": "sky", "up": [0, 0, 0]}), "lights[0].up", "the vector is zero"),
        (json!({"texture": "sky", "up": [0, 0, 1e300]}), "lights[0].up[2]", "beyond single precision"),
        (json!({"color": [1, 1, 1], "up": [0, 0, 1]}), "lights[0].up", "an even sky looks the same from all sides"),
        (json!({"color": [1, 1, 1], "rotation": 3}), "lights[0].rotation", "an even sky looks the same from all sides"),
        (json!({"texture": "turned"}), "lights[0].texture", "'turned' is scaled, turned or moved"),
        (json!({"texture": "boxed"}), "lights[0].texture", "'boxed' is projected on surfaces"),
        (json!({"texture": "colored"}), "lights[0].texture", "'colored' is multiplied by the colours of vertices"),
        (json!({"texture": "sky", "color": [1, -1, 1]}), "lights[0].color[1]", "-1 is negative"),
        (
            json!({"texture": "sky", "projection": "cube"}),
            "lights[0].texture",
            "'sky' is 4 x 2 texels large, expected six",
        ),
        (json!({"texture": "sky", "projection": "octahedral"}), "lights[0].texture", "expected a square"),
        (json!({"texture": "squares", "projection": "cube"}), "lights[0].texture", "'squares' is no image"),
        (json!({"texture": "sky", "projection": "dome"}), "lights[0].projection", "dome"),
        (json!({}), "lights[0]", "missing key `color`, or `texture`"),
    ] {
        let mut light = light;
        light["type"] = json!("environment");
        let error = with_textures(&light).unwrap_err();
        assert_eq!(error.location().json_path, place, "{error}");
        assert!(error.message().contains(message), "{error}");
    }
}

#[test]
fn a_backplate_is_read_changed_and_told_of() {
    let read = |backplate: Value| {
        let scene = json!({"etendue": 1, "camera": {"origin": [0, 0, 4]}, "backplate": backplate,
            "textures": [{"name": "ramp", "type": "gradient"}]});
        desc::parse(&scene.to_string(), Path::new(""), None).unwrap()
    };
    let plain = read(json!({"texture": "ramp"}));
    assert_eq!(plain.backplate, Some(BackplateDesc::of_texture(0)));
    let scaled = read(json!({"texture": "ramp", "color": [1, 2, 3], "intensity": 2})).backplate.unwrap();
    assert_eq!((scaled.radiance, scaled.texture), (Rgb::new(2.0, 4.0, 6.0), Some(0)));
    let bright = read(json!({"intensity": 683, "unit": "cd/m2"})).backplate.unwrap();
    assert!((bright.radiance.g() - 1.0).abs() < 1e-6 && bright.texture.is_none(), "{bright:?}");
    assert_eq!(read(Value::Null).backplate, None);

    // What is refused leaves all as it was.
    let mut desc = plain;
    for wrong in [BackplateDesc::of_texture(1), BackplateDesc::even(Rgb::new(0.0, f32::NAN, 0.0))] {
        assert_eq!(desc.set_backplate(Some(wrong)).unwrap_err().kind(), ErrorKind::InvalidScene);
        assert_eq!(desc.backplate, Some(BackplateDesc::of_texture(0)));
    }
    let mut coloured = TextureDesc::clone(&desc.textures[0]);
    coloured.vertex_colors = true;
    let error = desc.set_texture(0, coloured.clone()).unwrap_err();
    assert_eq!(error.location().json_path, "backplate.texture", "{error}");
    // A description that is put together by hand is checked when it is built.
    let by_hand = SceneDesc { textures: vec![Arc::new(coloured)], ..desc.clone() };
    let error = Scene::build(&by_hand, &BuildOptions::default()).unwrap_err();
    assert_eq!(error.location().json_path, "backplate.texture", "{error}");

    let scene = Scene::build(&desc, &BuildOptions::default()).unwrap();
    let info = scene.info().to_string();
    assert!(info.contains("that meet nothing show the backplate") && info.contains("1 patterns"), "{info}");
    assert!(scene.warnings().is_empty(), "nothing but a backplate is a picture: {:?}", scene.warnings());
    let mean = |scene: &Scene| render_scene(scene, Job::default().desc()).0.mean()[1];
    assert!((mean(&scene) - 0.5).abs() < 1e-3, "{}", mean(&scene));
    desc.set_backplate(Some(BackplateDesc::even(Rgb::splat(3.0)))).unwrap();
    let again = scene.rebuild(&desc, &BuildOptions::default()).unwrap();
    assert_eq!((mean(&again), mean(&scene) < 1.0), (3.0, true));
    desc.set_backplate(None).unwrap();
    let none = again.rebuild(&desc, &BuildOptions::default()).unwrap();
    assert_eq!(mean(&none), 0.0);
    assert!(none.warnings()[0].contains("no surface"), "{:?}", none.warnings());

    // A ball that nothing lights is black before it.
    let mut dark = parse(&json!([])).unwrap();
    dark.set_backplate(Some(BackplateDesc::even(Rgb::ONE))).unwrap();
    let dark = Scene::build(&dark, &BuildOptions::default()).unwrap();
    assert!(dark.warnings()[0].contains("all of the image but its backplate"), "{:?}", dark.warnings());

    // A product beyond single precision.
    let image = TexelImage::new(1, 1, 1, Texels::F32(vec![1e30].into())).unwrap();
    let source = ImageTextureDesc {
        image: Arc::new(image),
        file: None,
        color_space: None,
        suggested_space: ColorSpace::Linear,
        wrap: [Wrap::Repeat; 2],
        filter: TextureFilter::Bilinear,
    };
    let bright = TextureDesc { source: TextureSource::Image(source), ..TextureDesc::clone(&desc.textures[0]) };
    desc.set_texture(0, bright).unwrap();
    desc.set_backplate(Some(BackplateDesc { radiance: Rgb::splat(1e30), texture: Some(0) })).unwrap();
    let error = Scene::build(&desc, &BuildOptions::default()).unwrap_err();
    assert_eq!((error.location().json_path.as_str(), error.kind()), ("backplate.color", ErrorKind::InvalidScene));
}

#[test]
fn what_a_textured_sky_says_of_itself() {
    let build = |light: Value| {
        let scene = with_textures(&light).unwrap();
        Scene::build(&scene, &BuildOptions::default())
    };
    let scene = build(json!({"type": "environment", "texture": "sky"})).unwrap();
    let info = scene.info().to_string();
    assert!(
        info.contains("sampled by its luminance at 4 x 2 points") && !info.contains("0 materials are asked"),
        "{info}"
    );
    assert!(scene.warnings().is_empty(), "{:?}", scene.warnings());
    let black = build(json!({"type": "environment", "texture": "black"})).unwrap();
    assert!(black.warnings()[0].contains("dropped an environment without radiance"), "{:?}", black.warnings());
}

/// A texture of which a value times the factor is beyond single precision.
#[test]
fn light_beyond_single_precision_is_refused() {
    let mut scene = SceneDesc::default();
    let texels = Texels::F32(vec![1e10_f32; 8].into());
    let source = TextureSource::Image(ImageTextureDesc {
        image: Arc::new(TexelImage::new(4, 2, 1, texels).unwrap()),
        file: None,
        color_space: None,
        suggested_space: ColorSpace::Linear,
        wrap: [Wrap::Repeat; 2],
        filter: TextureFilter::Bilinear,
    });
    let mapping = TextureMapping::default();
    scene
        .add_texture(TextureDesc { name: "sky".into(), path: String::new(), source, mapping, vertex_colors: false })
        .unwrap();
    let map = EnvironmentMapDesc::new(0);
    scene
        .set_environment_desc(Some(EnvironmentDesc {
            sky: SkyDesc::Map(map),
            ..EnvironmentDesc::even(Rgb::splat(1e30))
        }))
        .unwrap();
    let error = Scene::build(&scene, &BuildOptions::default()).unwrap_err();
    assert_eq!((error.kind(), error.location().json_path.as_str()), (ErrorKind::InvalidScene, "environment.color"));
    let missing = EnvironmentDesc { sky: SkyDesc::Map(EnvironmentMapDesc::new(1)), ..EnvironmentDesc::even(Rgb::ONE) };
    let error = scene.set_environment_desc(Some(missing)).unwrap_err();
    assert!(
        error.to_string().contains("environment.texture") && error.to_string().contains("texture 1 of 1"),
        "{error}"
    );
    // A texture that a sky shows cannot become one that it cannot show.
    let mut turned = TextureDesc::clone(&scene.textures[0]);
    turned.vertex_colors = true;
    assert!(scene.set_texture(0, turned).is_err() && !scene.textures[0].vertex_colors);
}

#[test]
fn portals_that_are_none_are_refused_where_they_stand() {
    let square = json!([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]]);
    let refused = |portals: Value, place: &str, message: &str| {
        for mut light in
            [json!({"type": "environment", "color": [1, 1, 1]}), json!({"type": "sky", "cie": 1, "color": [1, 1, 1]})]
        {
            light["portals"] = portals.clone();
            let error = parse(&json!([light])).unwrap_err();
            assert_eq!(
                (error.kind(), error.location().json_path.as_str()),
                (ErrorKind::InvalidScene, place),
                "{error}"
            );
            assert!(error.to_string().contains(message), "{error}");
        }
    };
    refused(json!([square, [[0, 0, 0], [1, 0, 0]]]), "lights[0].portals[1]", "2 corners; expected 3 or 4");
    refused(json!([[[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0, 0.5, 0]]]), "lights[0].portals[0]", "5 corners");
    refused(json!([[[0, 0, 0], [1, 0, 0], [2, 0, 0]]]), "lights[0].portals[0]", "no area");
    refused(json!([square, [[0, 0, 0], [1e300, 0, 0], [0, 1, 0]]]), "lights[0].portals[1][1][0]", "1e300");
    refused(json!(vec![square.clone(); 257]), "lights[0].portals", "257 portals; expected 256 at most");

    // By calls.
    let window = |x: f64| PortalDesc { corners: vec![DVec3::ZERO, DVec3::X * x, DVec3::Y] };
    let mut scene = SceneDesc::default();
    let error = scene.set_portals(vec![window(1.0)]).unwrap_err();
    assert!(error.to_string().contains("there is no environment"), "{error}");
    scene.set_environment(Some(Rgb::ONE)).unwrap();
    scene.set_portals(vec![window(1.0)]).unwrap();
    assert!(scene.set_portals(vec![window(0.0)]).is_err());
    assert_eq!(scene.environment.as_ref().unwrap().portals, [window(1.0)]);
    scene.set_environment(Some(Rgb::ONE)).unwrap();
    assert!(scene.environment.unwrap().portals.is_empty());
}

/// A Lambert ball of this albedo in a sky of radiance 1, filling the picture. A floor far below is for photons to land on.
fn furnace(albedo: f32, integrator: IntegratorDesc) -> SceneDesc {
    let mut scene = parse(&json!([{"type": "environment", "color": [1, 1, 1]}])).unwrap();
    scene.set_material(0, BsdfDesc::Lambert { albedo: Rgb::splat(albedo) }, None).unwrap();
    scene.render = RenderDesc { integrator, ..job(16) };
    scene
}

fn job(samples: u32) -> RenderDesc {
    Job { resolution: [8, 8], samples, ..Job::default() }.desc()
}

fn picture(scene: &SceneDesc) -> Vec<f32> {
    let built = Scene::build(scene, &BuildOptions::default()).unwrap();
    render_scene(&built, scene.render.clone()).0.rgb
}

fn mean(rgb: &[f32]) -> f64 {
    rgb.iter().map(|value| f64::from(*value)).sum::<f64>() / rgb.len() as f64
}

/// What absorbs nothing cannot be seen in an even sky.
#[test]
fn a_white_ball_cannot_be_seen() {
    for integrator in IntegratorDesc::ALL {
        let mut scene = furnace(1.0, integrator);
        // Estimates from the density of photons lose what lies beyond the silhouette, so these look at its middle.
        if matches!(integrator, IntegratorDesc::PhotonDirect) {
            scene.render.photons.count = Some(1 << 18);
            let closer = json!({"etendue": 1, "camera": {"origin": [0, 0, 4], "fieldOfView": 10}});
            scene.camera = desc::parse(&closer.to_string(), Path::new(""), None).unwrap().camera;
        } else {
            scene.render.photons.count = Some(1 << 14);
        }
        let rgb = picture(&scene);
        let tolerance = if integrator == IntegratorDesc::PhotonDirect { 0.03 } else { 5e-3 };
        let mean = mean(&rgb);
        assert!((mean - 1.0).abs() < tolerance, "{}: {mean}", integrator.name());
    }
}

/// In a valley, light goes to and fro: the methods agree on how much of it.
#[test]
fn photons_agree_with_paths_under_a_sky() {
    let of = |integrator, samples| {
        let mut scene = furnace(0.7, integrator);
        let wall = |scene: &mut SceneDesc, corners: [[f64; 3]; 4]| {
            let (shape, local) = ShapeDesc::quad(corners.map(DVec3::from_array)).unwrap();
            let look = SurfaceLook { material: Some(0), ..SurfaceLook::default() };
            scene.add_surface(shape, local, look).unwrap();
        };
        wall(&mut scene, [[-3.0, -1.0, 3.0], [3.0, -1.0, 3.0], [3.0, -1.0, -2.0], [-3.0, -1.0, -2.0]]);
        wall(&mut scene, [[-3.0, -1.0, -2.0], [3.0, -1.0, -2.0], [3.0, 4.0, -2.0], [-3.0, 4.0, -2.0]]);
        scene.render.samples = samples;
        scene.render.photons.count = Some(1 << 17);
        mean(&picture(&scene))
    };
    let exact = of(IntegratorDesc::Path, 1024);
    assert!((0.3..0.9).contains(&exact), "{exact}");
    for integrator in
        [IntegratorDesc::Photon, IntegratorDesc::Caustic, IntegratorDesc::Sppm, IntegratorDesc::IrradianceCache]
    {
        let found = of(integrator, 64);
        assert!((found / exact - 1.0).abs() < 0.03, "{}: {found}, not {exact}", integrator.name());
    }
}

#[test]
fn an_edited_sky_is_that_of_a_new_scene() {
    let mut scene = furnace(0.5, IntegratorDesc::Path);
    let mut built = Scene::build(&scene, &BuildOptions::default()).unwrap();
    let check = |built: &mut Scene, scene: &SceneDesc| {
        *built = built.rebuild(scene, &BuildOptions::default()).unwrap();
        let bits = |rgb: Vec<f32>| rgb.into_iter().map(f32::to_bits).collect::<Vec<_>>();
        let rebuilt = bits(render_scene(built, scene.render.clone()).0.rgb);
        assert!(rebuilt == bits(picture(scene)));
        rebuilt
    };
    let mut seen = std::collections::HashSet::new();
    assert!(seen.insert(check(&mut built, &scene)));
    scene.set_environment(Some(Rgb::new(0.25, 0.5, 1.0))).unwrap();
    assert_eq!(scene.environment.as_ref().unwrap().path, "lights[0]");
    assert!(seen.insert(check(&mut built, &scene)));
    // The ball around the scene grows with it.
    let (shape, local) = ShapeDesc::sphere(DVec3::new(0.0, 30.0, 0.0), 20.0).unwrap();
    let look = SurfaceLook { material: Some(0), ..SurfaceLook::default() };
    let moon = scene.add_surface(shape, local, look).unwrap();
    assert!(seen.insert(check(&mut built, &scene)));
    scene.set_transform(moon, DAffine3::from_translation(DVec3::Y * 100.0)).unwrap();
    assert!(seen.insert(check(&mut built, &scene)));
    // A texture, which is then turned, and not seen.
    let colors = [Rgb::ZERO, Rgb::ONE];
    let source = TextureSource::Procedural(Procedural { pattern: Pattern::Checker, colors, in_space: false });
    let mapping = TextureMapping::Uv { set: 0, scale: [8.0, 4.0], rotation: 0.0, offset: [0.0; 2] };
    let texture = TextureDesc { name: String::new(), path: String::new(), source, mapping, vertex_colors: false };
    let texture = scene.add_texture(texture).unwrap();
    let mut sky =
        EnvironmentDesc { sky: SkyDesc::Map(EnvironmentMapDesc::new(texture)), ..EnvironmentDesc::even(Rgb::ONE) };
    for change in 0..4 {
        match (change, &mut sky) {
            (1, EnvironmentDesc { sky: SkyDesc::Map(map), .. }) => map.rotation_deg = 20.0,
            (2, sky) => sky.visible = false,
            (3, sky) => sky.radiance = Rgb::splat(2.0),
            _ => {}
        }
        scene.set_environment_desc(Some(sky.clone())).unwrap();
        assert!(seen.insert(check(&mut built, &scene)), "{change}");
    }
    scene.set_transform(moon, DAffine3::from_translation(DVec3::Y * 50.0)).unwrap();
    assert!(seen.insert(check(&mut built, &scene)));
    let brighter = Procedural { pattern: Pattern::Checker, colors: [Rgb::splat(0.5), Rgb::ONE], in_space: false };
    let brighter =
        TextureDesc { source: TextureSource::Procedural(brighter), ..TextureDesc::clone(&scene.textures[texture]) };
    scene.set_texture(texture, brighter).unwrap();
    assert!(seen.insert(check(&mut built, &scene)));
    // A clear sky, whose sun, ground and diameter change.
    let clear = HosekWilkieDesc::new(3.0, DVec3::new(1.0, 0.5, 1.0));
    let hazy = HosekWilkieDesc { turbidity: 6.5, ..clear };
    let late = HosekWilkieDesc { sun: DVec3::X, ..hazy };
    let bright = HosekWilkieDesc { ground: Rgb::splat(0.5), ..hazy };
    let wide = HosekWilkieDesc { disk_deg: Some(20.0), ..hazy };
    let alone = HosekWilkieDesc { disk_deg: None, ..hazy };
    for (change, sky) in [clear, hazy, late, bright, wide, alone].into_iter().enumerate() {
        let sky = EnvironmentDesc { sky: SkyDesc::HosekWilkie(sky), ..EnvironmentDesc::even(Rgb::splat(0.02)) };
        scene.set_environment_desc(Some(sky)).unwrap();
        assert!(seen.insert(check(&mut built, &scene)), "clear sky, {change}");
    }
    scene.set_environment(None).unwrap();
    let black = check(&mut built, &scene);
    assert!(black.iter().all(|value| *value == 0) && built.warnings()[0].contains("nothing in the scene emits light"));
    scene.set_environment(Some(Rgb::ZERO)).unwrap();
    assert!(check(&mut built, &scene) == black);
    assert!(built.warnings()[0].contains("dropped an environment without radiance"), "{:?}", built.warnings());
    // A call that fails changes nothing.
    for bad in [Rgb::splat(-1.0), Rgb::splat(f32::NAN), Rgb::splat(f32::INFINITY)] {
        let error = scene.set_environment(Some(bad)).unwrap_err();
        assert_eq!(
            error.location().json_path,
            "lights[0].color[0]".replace("lights[0]", &scene.environment.as_ref().unwrap().path)
        );
        assert_eq!(scene.environment.as_ref().unwrap().radiance, Rgb::ZERO);
    }
    assert!(
        SceneDesc::default()
            .set_environment(Some(Rgb::splat(-1.0)))
            .unwrap_err()
            .to_string()
            .contains("environment.color[0]")
    );
}

/// A sky without anything in it.
#[test]
fn an_empty_scene_shows_its_sky() {
    let mut scene = SceneDesc { render: job(1), ..SceneDesc::default() };
    scene.set_environment(Some(Rgb::new(0.5, 1.0, 2.0))).unwrap();
    let rgb = picture(&scene);
    assert!(rgb.as_chunks::<3>().0.iter().all(|pixel| *pixel == [0.5, 1.0, 2.0]), "{rgb:?}");
    assert!(Scene::build(&scene, &BuildOptions::default()).unwrap().warnings().is_empty());
}
