//! A description with every model, texture, shape and setting, and with numbers of many digits.

use std::f32::consts::PI;
use std::sync::Arc;

use etendue::desc::{
    AreaWebDesc, BackplateDesc, BsdfDesc, CacheDesc, CacheSource, CameraDesc, ConductorDesc, CropDesc, Dispersion,
    DistantLightDesc, Distribution, EnvironmentDesc, EnvironmentMapDesc, FilmDesc, FilterDesc, FocusDesc,
    FormulaSkyDesc, FovAxis, HosekWilkieDesc, HostMesh, ImageTextureDesc, IntegratorDesc, KernelDesc, KeyPlace,
    LensDesc, LightDistribution, METALS, Masking, MaterialDesc, MediumDesc, MeshDesc, MeshStep, MicrofacetsDesc,
    MotionDesc, MotionKey, Panorama, PanoramaDesc, PhotonDesc, PhotonSharing, PointLightDesc, PortalDesc,
    PrincipledDesc, Projection, RadiosityDesc, RadiositySolver, RenderDesc, RouletteDesc, SamplerDesc, SceneDesc,
    ShapeDesc, ShutterDesc, SkyDesc, SpectrumDesc, SpectrumKey, SpectrumTarget, SpotDesc, SurfaceLook, TextureBinding,
    TextureChannel, TextureDesc, TextureKey, TextureMapping, TextureSource, ThinFilmDesc,
};
use etendue::emitter::SkyFormula;
use etendue::math::{Bounds, DAffine3, DQuat, DVec3};
use etendue::photometry::Web;
use etendue::spectrum::Rgb;
use etendue::texture::{ColorSpace, Pattern, Procedural, TexelImage, Texels, TextureFilter, Wrap};
use half::f16;

/// A third of a number, which has as many digits as its type.
fn third(x: f32) -> f32 {
    x / 3.0
}

fn rgb(r: f32, g: f32, b: f32) -> Rgb {
    Rgb::from_array([r, g, b].map(third))
}

fn facets() -> [MicrofacetsDesc; 3] {
    let first = MicrofacetsDesc {
        roughness: third(1.0),
        anisotropy: 0.99,
        rotation: -third(PI),
        distribution: Distribution::Beckmann,
        masking: Masking::SmithSeparable,
        multiple_scattering: false,
    };
    let second = MicrofacetsDesc { masking: Masking::VCavity, multiple_scattering: false, ..first };
    [first, second, MicrofacetsDesc { rotation: 2.0 * PI, ..MicrofacetsDesc::rough(0.123_456_79) }]
}

fn principled() -> PrincipledDesc {
    // All fields, so that a new one has to be given here.
    PrincipledDesc {
        base_weight: third(2.0),
        base_color: rgb(1.0, 2.0, 3.0),
        base_diffuse_roughness: third(0.5),
        base_metalness: third(1.0),
        specular_weight: third(2.5),
        specular_color: rgb(2.0, 1.0, 0.5),
        specular_roughness: third(0.7),
        specular_roughness_anisotropy: third(1.1),
        specular_rotation: third(0.4),
        specular_ior: third(4.0),
        transmission_weight: third(0.9),
        transmission_color: rgb(2.9, 2.0, 1.0),
        transmission_depth: third(5.0),
        coat_weight: third(0.3),
        coat_color: rgb(2.0, 3.0, 1.0),
        coat_roughness: third(0.2),
        coat_roughness_anisotropy: third(0.6),
        coat_ior: third(4.7),
        coat_darkening: third(0.8),
        fuzz_weight: third(0.1),
        fuzz_color: rgb(0.1, 0.2, 0.3),
        fuzz_roughness: third(1.9),
        thin_walled: false,
        multiple_scattering: false,
    }
}

/// Adds a material with this model; returns its number.
fn add(scene: &mut SceneDesc, name: &str, bsdf: BsdfDesc) -> usize {
    scene.add_material(name, bsdf, None).unwrap()
}

fn glass_of(ior: f32) -> BsdfDesc {
    BsdfDesc::Dielectric { ior, exterior_ior: 1.0 }
}

fn metal_of(conductor: ConductorDesc) -> BsdfDesc {
    BsdfDesc::Conductor { conductor, microfacets: MicrofacetsDesc::default() }
}

fn materials(scene: &mut SceneDesc) {
    let albedo = rgb(1.0, 2.0, 0.1);
    add(scene, "Lambert \"of\" Étendue\\n", BsdfDesc::Lambert { albedo });
    // Not by the order of the names, and one of a name that others are given.
    add(scene, "", BsdfDesc::Lambert { albedo: Rgb::ZERO });
    add(scene, "material 1", BsdfDesc::Black);
    for sigma in [0.0, third(1.0), PI / 2.0, 30.0_f32.to_radians()] {
        scene.add_material("", BsdfDesc::OrenNayarQualitative { albedo, sigma }, Some(third(2.0))).unwrap();
    }
    add(scene, "Fujii", BsdfDesc::OrenNayar { albedo, roughness: third(1.0) });
    add(scene, "EON", BsdfDesc::Eon { albedo, roughness: third(1.0) });
    add(scene, "mirror", BsdfDesc::Mirror { reflectance: rgb(2.0, 2.5, 3.0) });
    let glass = add(scene, "glass", BsdfDesc::Dielectric { ior: third(4.5), exterior_ior: 1.0 });
    scene.set_medium(glass, Some(MediumDesc { absorption: rgb(0.0, 1e-3, 7.0), priority: u32::MAX })).unwrap();
    let abbe = BsdfDesc::Dielectric { ior: third(4.5), exterior_ior: third(4.0) };
    let prism = MaterialDesc {
        name: "prism".into(),
        bsdf: abbe,
        dispersion: Some(Dispersion::Abbe(third(90.0))),
        ..MaterialDesc::default()
    };
    scene.add_material_desc(prism).unwrap();
    for (name, strengths) in [("diamond", [0.3306, 4.3356, 0.0, 0.0]), ("formula", [third(1.0), 1.0, 0.0, 0.0])] {
        let dispersion = Dispersion::Sellmeier { strengths, resonances: [0.030_625, 0.011_236, 0.0, 0.0] };
        let bsdf = BsdfDesc::Dielectric { ior: dispersion.own_index().unwrap() as f32, exterior_ior: 1.0 };
        let material =
            MaterialDesc { name: name.into(), bsdf, dispersion: Some(dispersion), ..MaterialDesc::default() };
        scene.add_material_desc(material).unwrap();
    }
    let ramp: SpectrumDesc = SpectrumDesc::samples("", [[0.1, 1.0 / 3.0], [500.0, 0.1], [1e4, 1.0]]).unwrap();
    let with_spectra = |name: &str, bsdf, keys: &[SpectrumKey]| MaterialDesc {
        name: name.into(),
        bsdf,
        spectra: keys.iter().map(|key| (*key, ramp.clone())).collect(),
        ..MaterialDesc::default()
    };
    let chips = [
        with_spectra("chip", BsdfDesc::Eon { albedo, roughness: third(1.0) }, &[SpectrumKey::Color]),
        with_spectra("shaded glass", glass_of(1.5), &[SpectrumKey::Absorption]),
        with_spectra("alloy", metal_of(METALS[2].conductor()), &[SpectrumKey::Eta, SpectrumKey::K]),
        with_spectra("half an alloy", metal_of(METALS[2].conductor()), &[SpectrumKey::K]),
        with_spectra(
            "foil",
            metal_of(ConductorDesc::Reflectance { normal: albedo, edge: albedo }),
            &[SpectrumKey::Reflectance],
        ),
        MaterialDesc {
            spectra: vec![(SpectrumKey::Emission, SpectrumDesc::BlackBody(8000.0 / 3.0))],
            ..with_spectra("glow", BsdfDesc::Black, &[])
        },
    ];
    for chip in chips {
        scene.add_material_desc(chip).unwrap();
    }
    let conductor = ConductorDesc::Index { eta: rgb(0.3, 2.0, 3.0), k: rgb(3.0, 2.0, 1.0) };
    let microfacets = MicrofacetsDesc { roughness: third(0.4), ..MicrofacetsDesc::default() };
    for (name, bsdf) in [
        ("soap", BsdfDesc::Dielectric { ior: 1.0, exterior_ior: 1.0 }),
        ("coated lens", BsdfDesc::RoughDielectric { ior: third(4.5), exterior_ior: 1.0, microfacets }),
        ("oxide", BsdfDesc::Conductor { conductor, microfacets }),
    ] {
        let film = Some(ThinFilmDesc { thickness: third(1000.0), ior: third(4.0) });
        scene.add_material_desc(MaterialDesc { name: name.into(), bsdf, film, ..MaterialDesc::default() }).unwrap();
    }
    let leaf = BsdfDesc::DiffuseTransmission { reflectance: rgb(0.3, 0.2, 0.1), transmittance: rgb(1.0, 2.0, 0.4) };
    add(scene, "leaf", leaf);
    add(scene, "velvet", BsdfDesc::Sheen { color: albedo, roughness: third(0.1) });
    for microfacets in facets() {
        let (ior, exterior_ior) = (third(4.0), third(3.5));
        for metal in METALS {
            add(scene, "", BsdfDesc::Conductor { conductor: metal.conductor(), microfacets });
        }
        let index = ConductorDesc::Index { eta: rgb(1.0, 5.0, 9.0), k: rgb(0.0, 4.0, 10.0) };
        add(scene, "", BsdfDesc::Conductor { conductor: index, microfacets });
        let colours = ConductorDesc::Reflectance { normal: rgb(2.0, 1.0, 3.0), edge: rgb(3.0, 2.9, 0.0) };
        add(scene, "", BsdfDesc::Conductor { conductor: colours, microfacets });
        add(scene, "", BsdfDesc::RoughDielectric { ior, exterior_ior, microfacets });
        let transmittance = rgb(2.0, 3.0, 1.0);
        add(scene, "", BsdfDesc::ThinDielectric { ior, exterior_ior, transmittance, microfacets });
        add(scene, "", BsdfDesc::CoatedDiffuse { albedo, ior, exterior_ior, microfacets });
    }
    add(scene, "smooth", BsdfDesc::RoughDielectric { ior: 1.5, exterior_ior: 1.0, microfacets: facets()[0] });
    let whole = add(scene, "principled", BsdfDesc::Principled(principled()));
    scene.set_medium(whole, Some(MediumDesc { absorption: rgb(1.0, 0.0, 2.0), priority: 3 })).unwrap();
    add(scene, "defaults", BsdfDesc::Principled(PrincipledDesc::default()));
    add(scene, "sheet", BsdfDesc::Principled(PrincipledDesc { thin_walled: true, ..principled() }));
    let velvet = scene.find_material("velvet").unwrap();
    let mix = add(scene, "mix", BsdfDesc::Mix { materials: [1, velvet], weight: third(1.0) });
    add(scene, "two sides", BsdfDesc::TwoSided { front: mix, back: 0 });
    let described = |name: &str, opacity, emission| MaterialDesc {
        name: name.to_owned(),
        bsdf: BsdfDesc::Lambert { albedo },
        opacity,
        emission,
        ..MaterialDesc::default()
    };
    scene.add_material_desc(described("veil", third(1.0), None)).unwrap();
    scene.add_material_desc(described("lamp", 1.0, Some(rgb(10.0, 1e-9, 1e9)))).unwrap();
}

/// Textures of all formats and patterns.
fn textures(scene: &mut SceneDesc) {
    let (width, height) = (3, 2);
    let mut number = 0;
    let mut image = |channels: u32, texels| {
        number += 1;
        let image = Arc::new(TexelImage::new(width, height, channels, texels).unwrap());
        let (color_space, suggested_space) = match number % 5 {
            0 => (None, ColorSpace::Linear),
            1 => (Some(ColorSpace::Srgb), ColorSpace::Linear),
            2 => (Some(ColorSpace::Linear), ColorSpace::Srgb),
            _ => (Some(ColorSpace::Raw), ColorSpace::Srgb),
        };
        let wraps = [Wrap::Repeat, Wrap::Mirror, Wrap::Clamp, Wrap::Black];
        let filters = [
            TextureFilter::Nearest,
            TextureFilter::Bilinear,
            TextureFilter::Mip,
            TextureFilter::Ewa,
            TextureFilter::Stochastic,
        ];
        let source = TextureSource::Image(ImageTextureDesc {
            image,
            file: None,
            color_space,
            suggested_space,
            wrap: [wraps[number % 4], wraps[number / 4 % 4]],
            filter: filters[number % 5],
        });
        let x = number as f64 / 7.0;
        let set = number as u32 % 8;
        let mapping = TextureMapping::Uv { set, scale: [x, -x], rotation: x - 1.0, offset: [1.0 / x, -0.0] };
        scene
            .add_texture(TextureDesc {
                name: format!("image {number}"),
                path: String::new(),
                source,
                mapping,
                vertex_colors: false,
            })
            .unwrap();
    };
    for channels in 1..=4 {
        let count = (width * height * channels) as usize;
        let numbers = || (0..count).map(|i| third(i as f32) - 0.1);
        image(channels, Texels::U8((0..count).map(|i| (255 - 10 * i) as u8).collect()));
        image(channels, Texels::U16((0..count).map(|i| (65535 - 2001 * i) as u16).collect()));
        image(channels, Texels::F16(numbers().map(f16::from_f32).collect()));
        image(channels, Texels::F32(numbers().collect()));
    }
    // Another texture of the same image, with the colour space that its file suggests.
    let mut again = (*scene.textures[0]).clone();
    again.name = "again".to_owned();
    if let TextureSource::Image(it) = &mut again.source {
        it.color_space = None;
        it.suggested_space = ColorSpace::Srgb;
    }
    scene.add_texture(again).unwrap();
    for in_space in [false, true] {
        for pattern in [
            Pattern::Checker,
            Pattern::Grid { width: third(0.2) },
            Pattern::Gradient,
            Pattern::Noise { octaves: 3, turbulent: false },
            Pattern::Noise { octaves: 16, turbulent: true },
            Pattern::Marble { octaves: 1, turbulence: third(7.0) },
            Pattern::Wood { octaves: 4, turbulence: third(0.6) },
        ] {
            let colors = [rgb(0.0, 1.0, 3.0), rgb(0.3, 0.2, 0.1)];
            let source = TextureSource::Procedural(Procedural { pattern, colors, in_space });
            let mapping = match in_space {
                false => TextureMapping::Uv {
                    set: 0,
                    scale: [1.0, 2.0 / 3.0],
                    rotation: 0.5_f64.to_radians(),
                    offset: [0.0; 2],
                },
                true => TextureMapping::Space { scale: DVec3::new(1.0, 1e-7, -3.0), offset: DVec3::splat(1.0 / 3.0) },
            };
            let name = format!("pattern {}", scene.textures.len());
            scene
                .add_texture(TextureDesc { name, path: String::new(), source, mapping, vertex_colors: false })
                .unwrap();
        }
    }
    // Images and patterns by projections of the world.
    let patterned = scene.textures.len() - 14;
    for (i, (projection, _)) in Projection::ALL.into_iter().enumerate() {
        for known in [i, patterned + i] {
            let mapping =
                TextureMapping::Projected { projection, scale: [0.5, 3.0], rotation: 0.0, offset: [0.25, 1.0] };
            let mut texture = (*scene.textures[known]).clone();
            (texture.name, texture.mapping) = (format!("projection {}", scene.textures.len()), mapping);
            scene.add_texture(texture).unwrap();
        }
    }
}

/// Materials of which every parameter that can have one has a texture.
fn textured(scene: &mut SceneDesc) {
    let count = scene.textures.len();
    let is_stochastic = |number: usize| match &scene.textures[number].source {
        TextureSource::Image(it) => it.filter == TextureFilter::Stochastic,
        TextureSource::Procedural(_) | TextureSource::White => false,
    };
    let channels = [TextureChannel::Default, TextureChannel::Red, TextureChannel::Green, TextureChannel::Blue];
    let channels = [&channels[..], &[TextureChannel::Alpha]].concat();
    let usable: Vec<usize> = (0..count).filter(|number| !is_stochastic(*number)).collect();
    let bind = |keys: &[TextureKey]| -> Vec<TextureBinding> {
        let of = |(i, key): (usize, &TextureKey)| TextureBinding {
            key: *key,
            texture: usable[(7 * i + keys.len()) % usable.len()],
            channel: channels[i % channels.len()],
            strength: if i % 3 == 0 { 1.0 } else { third(i as f32) },
            cutoff: if *key == TextureKey::Opacity { third(1.0) } else { 0.0 },
        };
        keys.iter().enumerate().map(of).collect()
    };
    use TextureKey as K;
    let conductor = ConductorDesc::Reflectance { normal: rgb(2.0, 2.0, 2.0), edge: Rgb::ONE };
    let microfacets = MicrofacetsDesc::rough(0.5);
    let clear = PrincipledDesc { transmission_depth: 0.0, thin_walled: true, ..principled() };
    let all: Vec<K> = K::ALL.to_vec();
    let of_principled: Vec<K> = all.iter().copied().filter(|key| key.name().contains('_')).chain([K::Bump]).collect();
    let of_facets = [K::Roughness, K::Anisotropy, K::Rotation];
    for (bsdf, keys) in [
        (BsdfDesc::Principled(clear), of_principled),
        (BsdfDesc::Lambert { albedo: Rgb::ONE }, vec![K::Color, K::Opacity, K::Normal]),
        (BsdfDesc::Conductor { conductor, microfacets }, [&[K::Reflectance, K::EdgeTint], &of_facets[..]].concat()),
        (
            BsdfDesc::ThinDielectric { ior: 1.5, exterior_ior: 1.0, transmittance: Rgb::ONE, microfacets },
            vec![K::Transmittance, K::Opacity],
        ),
        // Facets that are smooth wherever the texture is.
        (
            BsdfDesc::RoughDielectric { ior: 1.5, exterior_ior: 1.0, microfacets: MicrofacetsDesc::rough(0.0) },
            vec![K::Roughness],
        ),
        (BsdfDesc::Mix { materials: [0, 1], weight: 1.0 }, vec![K::Weight]),
    ] {
        let textures = bind(&keys);
        scene.add_material_desc(MaterialDesc { bsdf, textures, ..MaterialDesc::default() }).unwrap();
    }
    let shining =
        MaterialDesc { emission: Some(rgb(2.0, 1.0, 3.0)), textures: bind(&[K::Emission]), ..MaterialDesc::default() };
    scene.add_material_desc(shining).unwrap();
    let film = Some(ThinFilmDesc { thickness: third(1000.0), ior: third(4.0) });
    let anodised = BsdfDesc::Conductor { conductor, microfacets };
    let textures = bind(&[K::FilmThickness]);
    scene.add_material_desc(MaterialDesc { bsdf: anodised, film, textures, ..MaterialDesc::default() }).unwrap();
    let is_image = |number: &&usize| matches!(scene.textures[**number].source, TextureSource::Image(_));
    let texture = *usable.iter().find(is_image).unwrap();
    let heated = MaterialDesc {
        spectra: vec![(SpectrumKey::Emission, SpectrumDesc::BlackBody(8000.0 / 3.0))],
        textures: vec![TextureBinding { texture, ..bind(&[K::Temperature])[0] }],
        ..MaterialDesc::default()
    };
    scene.add_material_desc(heated).unwrap();
    // Colours of vertices, alone and on an image and a pattern.
    let white = TextureDesc::of_vertex_colors("vertex colors".into(), String::new());
    let times = |number: usize| TextureDesc {
        name: format!("{number} times colors"),
        vertex_colors: true,
        ..(*scene.textures[number]).clone()
    };
    for texture in [white, times(usable[0]), times(usable[usable.len() - 1])] {
        let texture = scene.add_texture(texture).unwrap();
        let (bsdf, textures) =
            (BsdfDesc::Lambert { albedo: Rgb::ONE }, vec![TextureBinding::whole(TextureKey::Color, texture)]);
        scene.add_material_desc(MaterialDesc { bsdf, textures, ..MaterialDesc::default() }).unwrap();
    }
}

fn meshes(scene: &mut SceneDesc) {
    let positions = vec![DVec3::new(1.0 / 3.0, -0.0, 1e-300), DVec3::X * 1e9, DVec3::Y, DVec3::new(0.1, 0.2, 0.3)];
    let mesh = MeshDesc {
        name: "with all".into(),
        normals: vec![[0.0, -0.0, third(1.0)], [0.0; 3], [1e-30, 5.0, -1.0], [0.0, 0.0, 1.0]],
        uvs: vec![[third(1.0), -7.0], [0.0, 1.0], [1e20, -0.0], [0.5, 0.5]],
        further_uvs: vec![
            vec![[third(2.0), -7.0]; 4],
            vec![],
            vec![[0.0, third(5.0)], [1.0; 2], [-0.0, 1e-30], [0.5; 2]],
        ],
        colors: vec![[third(1.0), 0.0, 1e20, 1.0], [0.0; 4], [1e-30, third(0.7), 1.0, third(0.5)], [1.0; 4]],
        tangents: vec![[third(1.0), -0.0, 7.0], [0.0; 3], [1e-30, 1.0, third(2.0)], [1.0, 0.0, 0.0]],
        triangles: vec![[2, 1, 0], [0, 2, 3], [2, 1, 0]],
        positions: positions.clone(),
        ..MeshDesc::default()
    };
    scene.add_mesh(mesh.clone()).unwrap();
    // Triangles that a file of another format would leave out.
    let degenerate = vec![[0, 0, 1], [0, 1, 2], [3, 3, 3]];
    scene.add_mesh(MeshDesc { name: "degenerate".into(), triangles: degenerate, ..mesh.clone() }).unwrap();
    let removed = scene.add_mesh(MeshDesc { name: "removed".into(), ..mesh.clone() }).unwrap();
    scene.remove_mesh(removed).unwrap();
    // In single precision, without a name.
    let positions = vec![DVec3::ZERO, DVec3::X, DVec3::new(0.5, 0.75, 0.125)];
    scene.add_mesh(MeshDesc { positions, triangles: vec![[0, 1, 2]], ..MeshDesc::default() }).unwrap();
    let host = HostMesh {
        positions: vec![[0.1, 0.2, 0.3], [1.0, 0.0, 0.0], [0.0, 1.0, third(1.0)]].into(),
        triangles: vec![[0, 1, 2]].into(),
        normals: Some(vec![[0.0, 0.0, 1.0]; 3].into()),
        uvs: None,
    };
    scene.add_mesh(MeshDesc { name: "of a host".into(), host: Some(host), ..MeshDesc::default() }).unwrap();
}

fn surfaces(scene: &mut SceneDesc) {
    let v = DVec3::new;
    let turned = DAffine3::from_scale_rotation_translation(
        v(1.0 / 3.0, -2.0, 0.7),
        DQuat::from_axis_angle(v(1.0, 2.0, 3.0).normalize(), 0.7),
        v(0.1, -0.2, 1e-9),
    );
    let frame = DAffine3::from_rotation_x(0.3) * DAffine3::from_scale(DVec3::splat(1.1));
    let clip = Bounds { min: v(-2.0, -1.0 / 3.0, -1.0), max: v(2.0, 2.0, 1.0) };
    let mut shapes = vec![
        ShapeDesc::sphere(v(1.0 / 3.0, 0.0, -0.0), 1e-3 / 3.0).unwrap(),
        ShapeDesc::triangle([v(0.1, 0.2, 0.3), DVec3::X, DVec3::Y]).unwrap(),
        ShapeDesc::quad([DVec3::ZERO, DVec3::X / 3.0, v(1.0 / 3.0, 0.7, 0.0), DVec3::Y * 0.7]).unwrap(),
        ShapeDesc::disk(v(1.0, 2.0, 3.0) / 7.0, v(0.3, 0.5, -0.7), 0.3).unwrap(),
        ShapeDesc::quadric([1.0, 1.0 / 3.0, -1.0, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6, -1.0], Some(clip)).unwrap(),
        ShapeDesc::quadric([1.0, 2.0, 3.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, -4.0], None).unwrap(),
        ShapeDesc::ellipsoid(v(0.1, 0.2, 0.3), v(1.0 / 3.0, 2.0, 0.1)).unwrap(),
    ];
    for axis in [DVec3::Y, DVec3::NEG_Z, v(1.0, 1.0, 0.0), v(0.3, -0.5, 0.7)] {
        shapes.push(ShapeDesc::cylinder(v(0.1, 0.0, 1.0 / 3.0), axis, 0.3, 0.7).unwrap());
        shapes.push(ShapeDesc::cone(v(0.1, 0.0, 1.0 / 3.0), axis, 1.0 / 3.0, 0.7).unwrap());
        shapes.push(ShapeDesc::paraboloid(v(0.1, 0.0, 1.0 / 3.0), axis, 0.3, 2.0 / 3.0).unwrap());
    }
    for mesh in [0, 1, 3] {
        for smooth in [false, true] {
            shapes.push((ShapeDesc::Mesh { mesh, smooth }, DAffine3::IDENTITY));
        }
    }
    // Two surfaces of one mesh in frames that have keys, and one that has none.
    let moved = DAffine3::from_translation(v(0.1, 0.2, 0.3)) * DAffine3::from_scale(DVec3::splat(-0.3));
    shapes.extend([moved, frame].map(|local| (ShapeDesc::Mesh { mesh: 3, smooth: false }, local)));
    let mut material = 0;
    for (shape, local) in shapes {
        for (frame, transform) in
            [(DAffine3::IDENTITY, DAffine3::IDENTITY), (DAffine3::IDENTITY, turned), (frame, turned.inverse())]
        {
            // Materials by turns, except those of glass that must be closed and of lamps that some shapes cannot be.
            let is_taken = |it: &MaterialDesc| it.emission.is_none() && it.medium.is_none();
            material =
                (material + 1..).map(|i| i % scene.materials.len()).find(|i| is_taken(&scene.materials[*i])).unwrap();
            let look = SurfaceLook { material: Some(material), transform, ..SurfaceLook::default() };
            let surface = scene.add_surface(shape, local * frame, look).unwrap();
            // Two of three have a name, which every shape then has, and some share it.
            if !surface.is_multiple_of(3) {
                scene.set_surface_name(surface, &format!("part \"{}\" \u{e9}", surface / 6)).unwrap();
            }
        }
    }
    let removed = scene.surfaces.len() / 2;
    scene.remove_surface(removed).unwrap();
    let moved = DAffine3::from_translation(v(0.0, 5.0, 0.0));
    let shines = SurfaceLook { emission: Some(rgb(10.0, 1.0, 1e-9)), transform: moved, ..SurfaceLook::default() };
    let (sphere, local) = ShapeDesc::sphere(DVec3::ZERO, 0.5).unwrap();
    scene.add_surface(sphere, local, shines).unwrap();
    let lamp = scene.find_material("lamp");
    let (triangle, local) = ShapeDesc::triangle([DVec3::ZERO, DVec3::X, DVec3::Y]).unwrap();
    // Webs of surfaces, also in a frame that goes into the transform.
    let text = b"TILT=INCLUDE\n1\n2\n0 90\n1 0.5\n1 -1 1 3 1 1 2 0 0 0\n1 1 1\n0 90 180\n0\n7 5 3\n";
    let web = Arc::new(Web::parse(text).unwrap());
    let flat = [(triangle, local), ShapeDesc::disk(DVec3::X, DVec3::Z, 0.25).unwrap()];
    for ((shape, local), (c0, tilt_deg)) in flat.into_iter().zip([(DVec3::X, 0.0), (v(1.0 / 3.0, 0.2, -0.7), 30.0)]) {
        for frame in [DAffine3::IDENTITY, frame] {
            let emission = Some(rgb(1.0, 1.0 / 3.0, 0.0));
            let look = SurfaceLook { material: None, emission, emits_both: true, transform: turned };
            let surface = scene.add_surface(shape, local * frame, look).unwrap();
            let it = AreaWebDesc { web: Arc::clone(&web), c0, tilt_deg };
            scene.set_surface_web(surface, Some(it)).unwrap();
        }
    }
    for emission in [None, Some(rgb(1.0, 0.0, 0.0))] {
        for emits_both in [false, true] {
            let look = SurfaceLook { material: lamp, emission, emits_both, transform: moved };
            scene.add_surface(triangle, local, look).unwrap();
        }
    }
}

fn motions(scene: &mut SceneDesc) {
    let v = DVec3::new;
    let parts = |time: f64, translation, angle: f64, scale| MotionKey {
        time,
        place: KeyPlace::Parts {
            translation,
            rotation: DQuat::from_axis_angle(v(1.0, 2.0, 3.0).normalize(), angle),
            scale,
        },
    };
    let matrix = KeyPlace::Matrix(DAffine3::from_cols_array(&[
        1.0,
        0.1,
        0.0,
        1.0 / 3.0,
        1.0,
        0.0,
        0.0,
        -0.2,
        1.0,
        0.1,
        1e-9,
        7.0,
    ]));
    let stretched = MotionDesc {
        keys: vec![
            parts(-1.0 / 3.0, v(0.1, 0.0, 1e-30), 0.7, v(1.0, 2.0 / 3.0, 1.0)),
            parts(0.0, DVec3::ZERO, 0.0, DVec3::splat(1.0 / 3.0)),
            MotionKey { time: 0.1, place: matrix },
        ],
    };
    let rigid = MotionDesc {
        keys: vec![parts(0.0, DVec3::ZERO, 0.0, DVec3::ONE), parts(2.0, v(0.1, 0.2, 0.3), 1.1, DVec3::ONE)],
    };
    scene.set_shutter(ShutterDesc { open: 0.1, close: 1.0 / 3.0, curve: vec![0.0, 0.1, 1.0 / 3.0] }).unwrap();
    scene.set_camera_motion(Some(rigid.clone())).unwrap();
    // Before and after the surface that was removed.
    for surface in [0, scene.surfaces.len() - 1, scene.surfaces.len() / 2 + 1] {
        scene.set_surface_motion(surface, Some(stretched.clone())).unwrap();
    }
    for light in [0, scene.lights.len() - 1] {
        scene.set_light_motion(light, Some(rigid.clone())).unwrap();
    }
    let step = |time: f64| MeshStep {
        time,
        positions: vec![v(time, 0.1, -0.0), DVec3::X / 3.0, DVec3::Y, DVec3::Z],
        normals: vec![[third(time as f32), 0.0, 1.0]; 4],
    };
    scene.set_mesh_steps(0, vec![step(0.1), step(1.0 / 3.0)]).unwrap();
    let bare = MeshStep { time: 0.0, positions: vec![DVec3::ZERO, DVec3::X, DVec3::Y], normals: Vec::new() };
    scene.set_mesh_steps(3, vec![bare]).unwrap();
}

/// The description.
pub fn scene() -> SceneDesc {
    let mut scene = SceneDesc { camera: cameras()[0], render: settings()[0].clone(), ..SceneDesc::default() };
    textures(&mut scene);
    materials(&mut scene);
    textured(&mut scene);
    meshes(&mut scene);
    surfaces(&mut scene);
    scene.add_point_light(DVec3::new(0.1, 3.0, 1.0 / 3.0), rgb(5.0, 1e-20, 7e7)).unwrap();
    scene.add_point_light(DVec3::ZERO, Rgb::ZERO).unwrap();
    for (outer_deg, inner_deg) in [(45.0, 0.0), (1.0 / 3.0, 0.1), (180.0, 180.0)] {
        let spot = SpotDesc { outer_deg, inner_deg, ..SpotDesc::new(DVec3::new(1e-30, -0.7, 1.0 / 3.0)) };
        let distribution = LightDistribution::Spot(spot);
        let even = PointLightDesc::even(DVec3::X, rgb(1.0, 0.1, 3.0));
        scene.add_light_desc(PointLightDesc { distribution, ..even }).unwrap();
    }
    motions(&mut scene);
    let spectra =
        [SpectrumDesc::Daylight(17_000.0 / 3.0), SpectrumDesc::by_name("E").unwrap(), SpectrumDesc::BlackBody(1e6)];
    for (number, spectrum) in spectra.into_iter().enumerate() {
        scene.set_spectrum(SpectrumTarget::PointLight(number), Some(spectrum)).unwrap();
    }
    for (angle_deg, visible) in [(0.0, true), (0.1 + 0.2, false)] {
        let towards = DVec3::new(1e-30, 0.7, -1.0 / 3.0);
        let light = DistantLightDesc { angle_deg, visible, ..DistantLightDesc::parallel(towards, rgb(0.1, 0.0, 3e7)) };
        scene.add_distant_light(light).unwrap();
    }
    let image = TextureDesc {
        name: "sky".into(),
        mapping: TextureMapping::default(),
        ..TextureDesc::clone(&scene.textures[0])
    };
    let sky = scene.add_texture(image).unwrap();
    let map = EnvironmentMapDesc {
        up: DVec3::new(0.1, -2.0, 1.0 / 3.0),
        rotation_deg: 100.0 / 3.0,
        ..EnvironmentMapDesc::new(sky)
    };
    let sky = EnvironmentDesc { sky: SkyDesc::Map(map), visible: false, ..EnvironmentDesc::even(rgb(1.0, 2.0, 3.0)) };
    scene.set_environment_desc(Some(sky)).unwrap();
    let shining = scene.surfaces.iter().position(|surface| surface.emission.is_some()).unwrap();
    for of in [SpectrumTarget::Environment, SpectrumTarget::DistantLight(1), SpectrumTarget::Surface(shining)] {
        let lines = SpectrumDesc::samples("", [[450.0, 0.4], [551.0 + 1.0 / 3.0, 7e-1], [653.0, 0.5]]).unwrap();
        scene.set_spectrum(of, Some(lines)).unwrap();
    }
    scene.set_backplate(Some(BackplateDesc { radiance: rgb(0.1, 7.0, 1.0), texture: Some(1) })).unwrap();
    scene
}

/// Skies by formulas: of the CIE, of Perez and others, of Hosek and Wilkie, and with nothing left out.
pub fn skies() -> [EnvironmentDesc; 6] {
    let sun = DVec3::new(0.1, 1.0 / 3.0, 7.0);
    let clear = FormulaSkyDesc::new(SkyFormula::cie(12).unwrap(), sun);
    let formula = SkyFormula { numbers: [0.1, -1.0 / 3.0, 7.0, -0.7, 0.1 + 0.2], is_cie: false };
    let all =
        FormulaSkyDesc { formula, sun, up: DVec3::new(0.1, 0.2, 3.0), is_horizontal: true, ground: rgb(0.1, 0.0, 0.7) };
    let corner = |x: f64, y: f64| DVec3::new(x, y, 1.0 / 3.0);
    let triangle = vec![corner(0.1, 0.2), corner(1.0 / 7.0, 3.0), corner(-5.0, 0.1)];
    let window = vec![corner(0.0, 0.0), corner(1.0, 0.0), corner(1.0, 1.0), corner(0.0, 1.0)];
    let portals = vec![PortalDesc { corners: triangle }, PortalDesc { corners: window }];
    let hazy = HosekWilkieDesc {
        turbidity: 28.0 / 3.0,
        sun,
        up: DVec3::new(0.1, 0.2, 3.0),
        ground: rgb(0.1, 0.0, 0.7),
        disk_deg: Some(1.0 / 3.0),
    };
    let cube = EnvironmentDesc { visible: false, portals, ..EnvironmentDesc::even(rgb(0.1, 2.0, 3.0)) };
    [
        EnvironmentDesc { sky: SkyDesc::Formula(clear), ..EnvironmentDesc::even(Rgb::ONE) },
        EnvironmentDesc { sky: SkyDesc::Formula(all), ..cube.clone() },
        EnvironmentDesc {
            sky: SkyDesc::HosekWilkie(HosekWilkieDesc::new(0.1 + 2.2, sun)),
            ..EnvironmentDesc::even(Rgb::ONE)
        },
        EnvironmentDesc { sky: SkyDesc::HosekWilkie(hazy), ..cube.clone() },
        EnvironmentDesc { sky: SkyDesc::HosekWilkie(HosekWilkieDesc { disk_deg: None, ..hazy }), ..cube.clone() },
        cube,
    ]
}

pub fn cameras() -> [CameraDesc; 16] {
    let (eye, look_at, up) = (DVec3::new(0.1, 1.0 / 3.0, 7.0), DVec3::new(0.2, 0.3, -0.0), DVec3::new(0.1, 2.0, 0.0));
    let fov_deg = 100.0 / 3.0;
    let through = |lens| CameraDesc::ThinLens {
        eye,
        look_at,
        up,
        fov_deg,
        fov_axis: FovAxis::Vertical,
        lens,
        film: FilmDesc::default(),
    };
    let film = FilmDesc { shift: [1.0 / 3.0, -0.1], pixel_aspect: 1.0 / 30.0 };
    let bent = |panorama| CameraDesc::Panoramic { eye, look_at, up, panorama };
    [
        CameraDesc::Perspective { eye, look_at, up, fov_deg, fov_axis: FovAxis::Vertical, film: FilmDesc::default() },
        CameraDesc::Perspective { eye, look_at, up, fov_deg, fov_axis: FovAxis::Horizontal, film: FilmDesc::default() },
        CameraDesc::ViewPlane { centre: eye, look_at, up, fov_deg },
        CameraDesc::Orthographic {
            eye,
            look_at,
            up,
            size: 7.0 / 3.0,
            axis: FovAxis::Horizontal,
            film: FilmDesc::default(),
        },
        CameraDesc::Orthographic {
            eye,
            look_at,
            up,
            size: 7.0 / 3.0,
            axis: FovAxis::Vertical,
            film: FilmDesc::default(),
        },
        CameraDesc::Perspective { eye, look_at, up, fov_deg, fov_axis: FovAxis::Horizontal, film },
        CameraDesc::Orthographic { eye, look_at, up, size: 7.0 / 3.0, axis: FovAxis::Vertical, film },
        CameraDesc::ThinLens {
            eye,
            look_at,
            up,
            fov_deg,
            fov_axis: FovAxis::Horizontal,
            lens: LensDesc::new(0.1),
            film: FilmDesc { shift: [-0.0, 100.0], ..film },
        },
        bent(PanoramaDesc { pixel_aspect: 100.0 / 3.0, ..PanoramaDesc::new(Panorama::Cylindrical) }),
        bent(PanoramaDesc::new(Panorama::Spherical)),
        bent(PanoramaDesc { fov_deg, ..PanoramaDesc::new(Panorama::Cylindrical) }),
        bent(PanoramaDesc { fov_deg, ..PanoramaDesc::new(Panorama::Fisheye) }),
        bent(PanoramaDesc { fov_axis: FovAxis::Horizontal, ..PanoramaDesc::new(Panorama::Fisheye) }),
        through(LensDesc::new(0.1 / 3.0)),
        through(LensDesc { focus: FocusDesc::Distance(5.0 / 3.0), squeeze: 4.0 / 3.0, ..LensDesc::new(0.0) }),
        through(LensDesc {
            focus: FocusDesc::Point(DVec3::new(1.0 / 3.0, -0.0, 1e-7)),
            blades: 7,
            blade_rotation_deg: -40.0 / 3.0,
            ..LensDesc::new(1e-3)
        }),
    ]
}

/// Settings that all differ from their defaults, and every name of a sampler, filter, kernel and integrator.
pub fn settings() -> Vec<RenderDesc> {
    let whole = RenderDesc {
        resolution: [33, 7],
        crop: Some(CropDesc { left: 2, top: 0, width: 31, height: 3 }),
        samples: 5,
        sampler: SamplerDesc::Jittered,
        filter: FilterDesc::Gaussian { sigma: third(1.0) },
        integrator: IntegratorDesc::Sppm,
        reuse: Some(true),
        light_paths: Some(true),
        allow_bias: true,
        spectral: true,
        white_balance: Some([1.0 / 3.0, 0.3]),
        max_depth: Some(u32::MAX),
        shadow_rays: 3,
        first_shadow_rays: Some(5),
        roulette: RouletteDesc::File,
        photons: PhotonDesc {
            count: Some(12_345),
            radius: Some(1.0 / 3.0),
            min_photons: 11,
            caustic_count: Some(7),
            caustic_radius: Some(1e-17 / 3.0),
            neighbours: Some(0),
            kernel: Some(KernelDesc::Cone { k: third(3.7) }),
            alpha: 1.0 / 7.0,
            sharing: PhotonSharing::Area,
            guided: false,
            progressive: false,
            gather_rays: 9,
            memory: 77,
        },
        cache: CacheDesc {
            error: 1.0 / 3.0,
            rays: 99,
            min_spacing: 10.0 / 3.0,
            max_spacing: 2.0 / 3.0,
            source: CacheSource::Photons,
        },
        radiosity: RadiosityDesc {
            element_size: Some(1.0 / 3.0),
            error: 10.0 / 3.0,
            iterations: Some(0),
            tolerance: 0.1 / 3.0,
            solver: RadiositySolver::Shoot,
            ambient: true,
            final_gather: true,
            memory: 5,
        },
        seed: u64::MAX,
    };
    let mut all = vec![whole.clone(), RenderDesc::default()];
    all.extend(IntegratorDesc::ALL.map(|integrator| RenderDesc { integrator, ..whole.clone() }));
    for sampler in [SamplerDesc::Sobol, SamplerDesc::Random, SamplerDesc::Grid, SamplerDesc::Gaussian] {
        all.push(RenderDesc { sampler, ..whole.clone() });
    }
    let mitchell = FilterDesc::Mitchell { b: third(1.0), c: third(2.0) };
    for filter in [FilterDesc::Box, FilterDesc::Tent, FilterDesc::BlackmanHarris, mitchell] {
        all.push(RenderDesc { filter, ..whole.clone() });
    }
    for kernel in [KernelDesc::Flat, KernelDesc::Epanechnikov] {
        let photons = PhotonDesc { kernel: Some(kernel), neighbours: Some(500), ..whole.photons.clone() };
        all.push(RenderDesc { photons, ..whole.clone() });
    }
    all
}

/// Asserts that nothing is missing. A new model or shape needs an arm here, and then an element above.
pub fn assert_complete(scene: &SceneDesc) {
    let model = |material: &MaterialDesc| match material.bsdf {
        BsdfDesc::Black => 0,
        BsdfDesc::Lambert { .. } => 1,
        BsdfDesc::OrenNayarQualitative { .. } => 2,
        BsdfDesc::OrenNayar { .. } => 3,
        BsdfDesc::Mirror { .. } => 4,
        BsdfDesc::Dielectric { .. } => 5,
        BsdfDesc::Eon { .. } => 6,
        BsdfDesc::DiffuseTransmission { .. } => 7,
        BsdfDesc::Sheen { .. } => 8,
        BsdfDesc::Conductor { .. } => 9,
        BsdfDesc::RoughDielectric { .. } => 10,
        BsdfDesc::ThinDielectric { .. } => 11,
        BsdfDesc::CoatedDiffuse { .. } => 12,
        BsdfDesc::Principled(_) => 13,
        BsdfDesc::Mix { .. } => 14,
        BsdfDesc::TwoSided { .. } => 15,
    };
    assert_all(scene.materials.iter().map(model), 16);
    let shape = |shape: &ShapeDesc| match shape {
        ShapeDesc::Sphere { .. } => 0,
        ShapeDesc::Triangle(_) => 1,
        ShapeDesc::Quad(_) => 2,
        ShapeDesc::Mesh { .. } => 3,
        ShapeDesc::Quadric { .. } => 4,
        ShapeDesc::Disk { .. } => 5,
    };
    assert_all(scene.surfaces.iter().map(|surface| shape(&surface.shape)), 6);
    let source = |texture: &Arc<TextureDesc>| match &texture.source {
        TextureSource::Image(it) => match it.image.texels() {
            Texels::U8(_) => 0,
            Texels::U16(_) => 1,
            Texels::F16(_) => 2,
            Texels::F32(_) => 3,
        },
        TextureSource::Procedural(it) => match it.pattern {
            Pattern::Checker => 4,
            Pattern::Grid { .. } => 5,
            Pattern::Gradient => 6,
            Pattern::Noise { .. } => 7,
            Pattern::Marble { .. } => 8,
            Pattern::Wood { .. } => 9,
        },
        TextureSource::White => 10,
    };
    assert_all(scene.textures.iter().map(source), 11);
    let keys = scene.materials.iter().flat_map(|material| &material.textures).map(|binding| binding.key);
    let number = |key: TextureKey| TextureKey::ALL.iter().position(|other| *other == key).unwrap();
    assert_all(keys.map(number), TextureKey::ALL.len());
}

fn assert_all(found: impl Iterator<Item = usize>, count: usize) {
    let mut found: Vec<usize> = found.collect();
    found.sort_unstable();
    found.dedup();
    assert_eq!(found, (0..count).collect::<Vec<_>>());
}
