//! Maps of material libraries: what they vary, their options, and what is left out.

use etendue::desc::{self, SceneDesc, TextureChannel, TextureKey, TextureMapping, TextureSource};
use etendue::scene::{BuildOptions, Scene};
use etendue::texture::Wrap;
use serde_json::json;

use super::{folder, from_file, native, principled, scene_of};

/// A triangle with texture coordinates, its library, and images of 2 x 1 texels beside them.
fn mapped(mtl: &str) -> SceneDesc {
    let obj = "mtllib m.mtl\nv 0 0 0\nv 1 0 0\nv 0 3 4\nvt 0 0\nvt 1 0\nvt 0 1\nusemtl m\nf 1/1 2/2 3/3\n";
    let folder = folder(obj.as_bytes(), format!("newmtl m\n{mtl}").as_bytes());
    std::fs::create_dir(folder.path().join("maps")).expect("a folder");
    let texels: [(&str, [[u8; 4]; 2]); 6] = [
        ("red.png", [[255, 0, 0, 255], [51, 0, 0, 255]]),
        ("maps/two words.png", [[255, 255, 255, 255], [0, 0, 0, 255]]),
        ("leaf.png", [[0, 255, 0, 255], [0, 255, 0, 0]]),
        ("normals.png", [[128, 128, 255, 255], [140, 120, 240, 255]]),
        ("-dash.png", [[0, 0, 255, 255], [0, 0, 255, 255]]),
        ("broken.png", [[0; 4]; 2]),
    ];
    for (name, texels) in texels {
        let image = image::RgbaImage::from_fn(2, 1, |x, _| image::Rgba(texels[x as usize]));
        image.save(folder.path().join(name)).expect("an image");
    }
    std::fs::write(folder.path().join("broken.png"), b"no image").expect("a file");
    desc::parse(&scene_of(&json!([from_file("m.obj")])), folder.path(), None).expect("a scene")
}

/// What each map of the last material varies: parameter, file, channel, strength.
fn bound(scene: &SceneDesc) -> Vec<(TextureKey, String, TextureChannel, f32)> {
    let name = |texture: usize| match &scene.textures[texture].source {
        TextureSource::Image(image) => {
            let file = image.file.as_deref().expect("an image of a file");
            file.file_name().expect("a name").to_string_lossy().into_owned()
        }
        TextureSource::Procedural(_) | TextureSource::White => unreachable!("libraries have no patterns"),
    };
    let all = scene.materials.iter().flat_map(|material| &material.textures);
    all.map(|it| (it.key, name(it.texture), it.channel, it.strength)).collect()
}

#[test]
fn maps_vary_parameters() {
    let all = TextureChannel::Default;
    // The diagonal of the box around the triangle is sqrt(26).
    let height = (0.01 * 26.0_f64.sqrt()) as f32;
    for (mtl, expected) in [
        ("map_Kd red.png", vec![(TextureKey::Color, "red.png", all, 1.0)]),
        ("MAP_KD  .\\red.png", vec![(TextureKey::Color, "red.png", all, 1.0)]),
        ("map_Kd C:\\Users\\me\\red.png", vec![(TextureKey::Color, "red.png", all, 1.0)]),
        ("Ks 1 1 1\nmap_Kd red.png", vec![(TextureKey::BaseColor, "red.png", all, 1.0)]),
        ("Kd 1 1 1\nmap_Ks red.png", vec![(TextureKey::SpecularWeight, "red.png", all, 1.0)]),
        ("Kd 0 0 0\nmap_Ks red.png", vec![(TextureKey::Reflectance, "red.png", all, 1.0)]),
        (
            "illum 3\nKd 0.5 0.5 0.5\nKs 0.5 0.5 0.5\nmap_Kd red.png\nmap_Ks leaf.png",
            vec![(TextureKey::Color, "red.png", all, 1.0), (TextureKey::Reflectance, "leaf.png", all, 1.0)],
        ),
        (
            "map_Pr -imfchan g red.png\nmap_Pm -imfchan b red.png",
            vec![
                (TextureKey::SpecularRoughness, "red.png", TextureChannel::Green, 1.0),
                (TextureKey::BaseMetalness, "red.png", TextureChannel::Blue, 1.0),
            ],
        ),
        (
            "map_Ps red.png\nmap_Pc red.png\nmap_Pcr red.png",
            vec![
                (TextureKey::FuzzWeight, "red.png", all, 1.0),
                (TextureKey::CoatWeight, "red.png", all, 1.0),
                (TextureKey::CoatRoughness, "red.png", all, 1.0),
            ],
        ),
        ("Ke 2 2 2\nmap_Ke red.png", vec![(TextureKey::Emission, "red.png", all, 1.0)]),
        ("map_Ke red.png", vec![(TextureKey::Emission, "red.png", all, 1.0)]),
        // An image that is opaque everywhere holds the opacity in its colour.
        ("map_d leaf.png", vec![(TextureKey::Opacity, "leaf.png", all, 1.0)]),
        ("map_d maps/two words.png", vec![(TextureKey::Opacity, "two words.png", TextureChannel::Red, 1.0)]),
        ("map_d -imfchan m red.png", vec![(TextureKey::Opacity, "red.png", TextureChannel::Alpha, 1.0)]),
        ("bump -bm 2 maps/two words.png", vec![(TextureKey::Bump, "two words.png", all, 2.0 * height)]),
        ("map_Bump -bm 0.5 normals.png", vec![(TextureKey::Normal, "normals.png", all, 0.5)]),
        ("norm normals.png", vec![(TextureKey::Normal, "normals.png", all, 1.0)]),
        ("map_Kd \"maps/two words.png\"", vec![(TextureKey::Color, "two words.png", all, 1.0)]),
        ("map_Kd Textures/RED.PNG", vec![(TextureKey::Color, "red.png", all, 1.0)]),
        ("map_Kd -dash.png", vec![(TextureKey::Color, "-dash.png", all, 1.0)]),
        ("bump red.png -bm 2", vec![(TextureKey::Bump, "red.png", all, 2.0 * height)]),
        ("map_Kd maps/two words.png\nmap_Kd red.png", vec![(TextureKey::Color, "red.png", all, 1.0)]),
    ] {
        let scene = mapped(mtl);
        assert_eq!(scene.warnings, Vec::<String>::new(), "{mtl}");
        let expected: Vec<_> =
            expected.into_iter().map(|(key, file, channel, s)| (key, file.to_owned(), channel, s)).collect();
        assert_eq!(bound(&scene), expected, "{mtl}");
        Scene::build(&scene, &BuildOptions::default()).expect("a scene that builds");
    }
    // Where a map takes the place of a value, the value is 1; what is stated is a factor.
    let of = |mtl: &str| mapped(mtl).materials[0].bsdf;
    assert_eq!(of("map_Kd red.png"), native(&[json!({"type": "diffuse", "color": [1, 1, 1]})])[0].bsdf);
    assert_eq!(
        of("Kd 0.5 0.5 0.5\nmap_Kd red.png"),
        native(&[json!({"type": "diffuse", "color": [0.5, 0.5, 0.5]})])[0].bsdf
    );
    let physical = principled(&json!({"specular_roughness": 1, "base_metalness": 1}));
    assert_eq!(of("map_Pr red.png\nmap_Pm red.png"), native(&[physical])[0].bsdf);
}

#[test]
fn maps_have_options() {
    let scene = mapped(
        "map_Kd -blendu off -s 2 3 1 -o 0.5 -0.25 0 -clamp on -mm 0 1 -t 0 0 0 -texres 512 -cc on red.png\nmap_d -s 2 leaf.png",
    );
    assert_eq!(scene.warnings, Vec::<String>::new());
    let [first, second] = [0, 1].map(|i| &scene.textures[i]);
    assert_eq!(first.mapping, TextureMapping::Uv { set: 0, scale: [2.0, 3.0], rotation: 0.0, offset: [0.5, -0.25] });
    assert_eq!(second.mapping, TextureMapping::Uv { set: 0, scale: [2.0, 1.0], rotation: 0.0, offset: [0.0, 0.0] });
    let TextureSource::Image(image) = &first.source else { unreachable!("an image") };
    assert_eq!(image.wrap, [Wrap::Clamp; 2]);
    assert!(scene.files.iter().any(|file| file.ends_with("red.png")));
    // One image of two maps is one texture.
    assert_eq!(mapped("map_Pr red.png\nmap_Pm red.png").textures.len(), 1);
}

#[test]
fn maps_that_mean_nothing_here_are_left_out_with_a_warning() {
    for (mtl, expected) in [
        ("map_Kd no.png", "m.mtl:2: map_Kd 'no.png' does not exist; it is left out"),
        ("map_Kd broken.png", "m.mtl:2: map_Kd 'broken.png' cannot be read: not a"),
        ("map_Kd", "m.mtl:2: map_Kd names no image; it is left out"),
        ("map_Kd maps", "m.mtl:2: map_Kd 'maps' is a folder, expected an image; it is left out"),
        ("map_Kd -mm 0.1 2 red.png", "m.mtl:2: map_Kd -mm 0.1 2 has no meaning here; it is left out"),
        ("map_Kd -t 1 1 1 red.png", "m.mtl:2: map_Kd -t 1 1 1 has no meaning here; it is left out"),
        ("map_Kd -s 1e300 red.png", "m.mtl:2: map_Kd -s 1e300 has no meaning here; it is left out"),
        ("map_Kd -o nan 1e400 red.png", "m.mtl:2: map_Kd -o nan 1e400 has no meaning here; it is left out"),
        ("bump -bm 1e300 red.png", "m.mtl:2: bump -bm 1e300 has no meaning here; it is left out"),
        ("map_Kd -halo 3 red.png", "m.mtl:2: map_Kd -halo 3 has no meaning here; it is left out"),
        ("map_Kd red.png -type sphere other", "m.mtl:2: map_Kd 'other' follows the name; it is left out"),
        ("illum 7\nmap_Kd red.png", "m.mtl:3: map_Kd 'red.png' varies nothing that the material has; it is left out"),
        ("Ke 1 1 1\nmap_d leaf.png", "map_d 'leaf.png' is the opacity of a material that emits or refracts light"),
        ("illum 7\nmap_d leaf.png", "map_d 'leaf.png' is the opacity of a material that emits or refracts light"),
        ("bump red.png\nnorm normals.png", "bump 'red.png' is a second map for the normal; it is left out"),
        ("norm normals.png\nbump red.png", "bump 'red.png' is a second map for the normal; it is left out"),
        ("Ke 0 0 0\nmap_Ke red.png", "map_Ke 'red.png' varies an emission (Ke) that is 0; it is left out"),
        ("map_Ke no.png", "map_Ke 'no.png' does not exist; it is left out"),
        ("map_Ns red.png", "m.mtl:2: map_Ns has no meaning here; it is left out"),
        ("disp red.png", "m.mtl:2: disp has no meaning here; it is left out"),
    ] {
        let scene = mapped(mtl);
        assert!(scene.warnings.len() == 1 && scene.warnings[0].contains(expected), "{mtl}: {:?}", scene.warnings);
        Scene::build(&scene, &BuildOptions::default()).expect("a scene that builds");
    }
}

/// Without the map of its emission a material is as if it had none, whatever the order of keys.
#[test]
fn a_missing_map_of_emission_leaves_the_opacity() {
    for (mtl, opacity, maps) in [
        ("d 0.5\nmap_Ke no.png", 0.5, 0),
        ("map_Ke no.png\nd 0.5\nKe 1 1 1", 0.5, 0),
        ("map_d leaf.png\nKe 1 1 1\nmap_Ke no.png", 1.0, 1),
        ("d 0.5\nmap_Ke red.png", 1.0, 1),
    ] {
        let scene = mapped(mtl);
        let [material] = &scene.materials[..] else { panic!("{mtl}: one material") };
        assert_eq!((material.opacity, material.textures.len()), (opacity, maps), "{mtl}: {:?}", scene.warnings);
        assert_eq!(scene.warnings.len(), 1, "{mtl}: {:?}", scene.warnings);
    }
}
