//! Scenes made and changed by calls are what the format would have given, and are refused in its words.

#[path = "../common/mod.rs"]
mod common;
mod random;
mod refused;

use std::path::Path;
use std::sync::Arc;
use std::time::{Duration, Instant};

use etendue::Result;
use etendue::desc::{
    self, BsdfDesc, CacheDesc, CropDesc, FilterDesc, HostMesh, KernelDesc, LightDistribution, LoadOptions,
    MAX_NEIGHBOURS, MAX_PHOTONS, MaterialDesc, MeshDesc, MeshStep, PhotonDesc, PointLightDesc, RenderDesc, SceneDesc,
    SceneIndex, ShapeDesc, SpectrumTarget, SpotDesc, SurfaceLook,
};
use etendue::math::{Bounds, DAffine3, DVec3};
use etendue::scene::{BuildOptions, Scene};
use etendue::spectrum::Rgb;

/// All of a description but paths and what is kept for looking up.
fn content(desc: &SceneDesc) -> String {
    let mut desc = SceneDesc { file: None, files: Vec::new(), index: SceneIndex::default(), ..desc.clone() };
    desc.lights.iter_mut().for_each(|light| light.path.clear());
    desc.distant_lights.iter_mut().for_each(|light| light.path.clear());
    desc.environment.iter_mut().for_each(|sky| sky.path.clear());
    desc.materials.iter_mut().for_each(|material| material.path.clear());
    desc.textures.iter_mut().for_each(|texture| Arc::make_mut(texture).path.clear());
    desc.meshes.iter_mut().for_each(|mesh| Arc::make_mut(mesh).path.clear());
    desc.surfaces.iter_mut().for_each(|surface| surface.path.clear());
    format!("{desc:?}")
}

/// The same scene, said by calls.
fn rebuilt(from: &SceneDesc) -> Result<SceneDesc> {
    let mut desc = SceneDesc { render: from.render.clone(), ..SceneDesc::default() };
    desc.render.check()?;
    desc.set_camera(from.camera)?;
    for (number, texture) in from.textures.iter().enumerate() {
        assert_eq!(desc.add_texture(texture.as_ref().clone())?, number);
    }
    for (number, material) in from.materials.iter().enumerate() {
        assert_eq!(desc.add_material_desc(material.clone())?, number);
    }
    for mesh in &from.meshes {
        desc.add_mesh(mesh.as_ref().clone())?;
    }
    for light in &from.lights {
        desc.add_light_desc(light.clone())?;
    }
    for light in &from.distant_lights {
        desc.add_distant_light(light.clone())?;
    }
    desc.set_environment_desc(from.environment.clone())?;
    desc.set_backplate(from.backplate)?;
    for (number, surface) in from.surfaces.iter().enumerate() {
        let look = SurfaceLook {
            material: surface.material,
            emission: surface.emission,
            emits_both: surface.emits_both,
            transform: surface.transform,
        };
        assert_eq!(desc.add_surface(surface.shape, surface.local, look)?, number);
        if surface.spectrum.is_some() {
            desc.set_spectrum(SpectrumTarget::Surface(number), surface.spectrum.clone())?;
        }
    }
    desc.set_shutter(from.motion.shutter.clone())?;
    desc.set_camera_motion(from.motion.camera.as_deref().cloned())?;
    for (number, motion) in &from.motion.surfaces {
        desc.set_surface_motion(*number, Some(motion.as_ref().clone()))?;
    }
    for (number, motion) in &from.motion.lights {
        desc.set_light_motion(*number, Some(motion.as_ref().clone()))?;
    }
    for (number, steps) in &from.motion.meshes {
        desc.set_mesh_steps(*number, steps.to_vec())?;
    }
    Ok(desc)
}

fn pixels(desc: &SceneDesc) -> Vec<u32> {
    let scene = Scene::build(desc, &BuildOptions::default()).expect("a scene that builds");
    let render = RenderDesc { resolution: [24, 18], samples: 8, ..desc.render.clone() };
    let (image, _) = common::scenes::render_scene(&scene, render);
    let layers = image.layers.iter().flat_map(|layer| &layer.data);
    image.rgb.iter().chain(layers).map(|value| value.to_bits()).collect()
}

#[test]
fn every_scene_of_the_repository_can_be_said_by_calls() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes");
    let (mut count, mut rendered) = (0, 0);
    for entry in folder.read_dir().unwrap() {
        let path = entry.unwrap().path();
        if path.extension().is_none_or(|extension| extension != "json") {
            continue;
        }
        let read = match desc::load(&path, None) {
            Ok(read) => read,
            Err(error) if path.ends_with("million.json") => {
                eprintln!("SKIPPED: {error} (`make meshes` makes it)");
                continue;
            }
            Err(error) => panic!("{error}"),
        };
        let made = rebuilt(&read).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
        assert!(content(&made) == content(&read), "{} is another scene by calls", path.display());
        count += 1;
        if path.ends_with("room.json") || path.ends_with("quadrics.json") || path.ends_with("cornell.json") {
            assert!(pixels(&made) == pixels(&read), "{} looks different by calls", path.display());
            rendered += 1;
        }
    }
    assert!(count >= 9 && rendered == 3, "{count} scenes, {rendered} rendered");
}

fn parse(text: &str) -> Result<SceneDesc> {
    desc::parse(text, &common::snippets::data_dir(), None)
}

/// A scene file of one surface and two materials, `more` coming before the surfaces.
fn file(more: &str, surface: &str) -> String {
    format!(
        r#"{{"etendue": 1, "camera": {{"origin": [0, 0, 9]}}, {more}
            "materials": [{{"name": "white", "type": "diffuse", "color": [1, 1, 1]}},
                          {{"name": "glass", "type": "refractive", "refractionIndex": 1.5}}],
            "surfaces": [{{"material": "white", {surface}}}]}}"#
    )
}

const A: DVec3 = DVec3::new(0.3, -2.0, 7.1);
const B: DVec3 = DVec3::new(-1.0, 0.25, 3.0);

#[test]
fn every_named_shape_is_the_one_of_the_format() {
    let quad = [DVec3::ZERO, DVec3::X, DVec3::new(1.0, 0.7, 0.0), DVec3::Y];
    let ellipsoid = [1.0, 2.0, 3.0, 0.5, 0.0, 0.0, 0.0, 3.5, 0.0, 3.0];
    let open = [1.0, 1.0, -1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, -1.0];
    let clip = Bounds { min: DVec3::splat(-2.0), max: DVec3::new(2.0, 2.5, 1.0) };
    let cases = [
        (r#""sphere", "origin": [0.3, -2, 7.1], "radius": 0.7"#, ShapeDesc::sphere(A, 0.7)),
        (
            r#""triangle", "vertex-1": [0.3, -2, 7.1], "vertex-2": [0, 0, 0], "vertex-3": [-1, 0.25, 3]"#,
            ShapeDesc::triangle([A, DVec3::ZERO, B]),
        ),
        (
            r#""quad", "vertex-1": [0, 0, 0], "vertex-2": [1, 0, 0], "vertex-3": [1, 0.7, 0], "vertex-4": [0, 1, 0]"#,
            ShapeDesc::quad(quad),
        ),
        (r#""disk", "origin": [0.3, -2, 7.1], "normal": [-1, 0.25, 3], "radius": 0.7"#, ShapeDesc::disk(A, B, 0.7)),
        (
            r#""cylinder", "base": [0.3, -2, 7.1], "axis": [-1, 0.25, 3], "radius": 0.7, "height": 3"#,
            ShapeDesc::cylinder(A, B, 0.7, 3.0),
        ),
        (
            r#""cone", "base": [0.3, -2, 7.1], "axis": [-1, 0.25, 3], "radius": 0.7, "height": 3"#,
            ShapeDesc::cone(A, B, 0.7, 3.0),
        ),
        (
            r#""paraboloid", "apex": [0.3, -2, 7.1], "axis": [-1, 0.25, 3], "radius": 0.7, "height": 3"#,
            ShapeDesc::paraboloid(A, B, 0.7, 3.0),
        ),
        (
            r#""ellipsoid", "origin": [0.3, -2, 7.1], "radii": [1, 0.25, 3]"#,
            ShapeDesc::ellipsoid(A, DVec3::new(1.0, 0.25, 3.0)),
        ),
        (r#""quadric", "coefficients": [1, 2, 3, 0.5, 0, 0, 0, 3.5, 0, 3]"#, ShapeDesc::quadric(ellipsoid, None)),
        (
            r#""quadric", "coefficients": [1, 1, -1, 0, 0, 0, 0, 0, 0, -1],
               "clip": {"min": [-2, -2, -2], "max": [2, 2.5, 1]}"#,
            ShapeDesc::quadric(open, Some(clip)),
        ),
    ];
    for (text, made) in cases {
        let read = parse(&file("", &format!(r#""geometry": {text}"#))).unwrap();
        let (shape, local) = made.unwrap_or_else(|error| panic!("{text}: {error}"));
        assert_eq!((read.surfaces[0].shape, read.surfaces[0].local), (shape, local), "{text}");
        let mut desc = base();
        desc.add_surface(shape, local, lit(0)).unwrap_or_else(|error| panic!("{text}: {error}"));
    }
}

fn lit(material: usize) -> SurfaceLook {
    SurfaceLook { material: Some(material), ..SurfaceLook::default() }
}

fn corner() -> MeshDesc {
    MeshDesc {
        positions: vec![DVec3::ZERO, DVec3::X, DVec3::Y],
        triangles: vec![[0, 1, 2]],
        normals: vec![[0.0, 0.0, 1.0]; 3],
        uvs: vec![[0.5, 0.5]; 3],
        ..MeshDesc::default()
    }
}

fn hosted() -> MeshDesc {
    let host = HostMesh {
        positions: vec![[0.0_f32; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]].into(),
        triangles: vec![[0_u32, 1, 2]].into(),
        normals: None,
        uvs: None,
    };
    MeshDesc { host: Some(host), ..MeshDesc::default() }
}

/// Two materials, a light, three meshes, and of surfaces: 0 a mesh, 1 a lamp without a material, 2 a removed sphere,
/// 3 a bowl, 4 a lamp with a material. Mesh 1 was removed, mesh 2 is the host's.
fn base() -> SceneDesc {
    let mut desc = SceneDesc::default();
    desc.add_material("white", BsdfDesc::Lambert { albedo: Rgb::splat(0.5) }, None).unwrap();
    desc.add_material("glass", BsdfDesc::Dielectric { ior: 1.5, exterior_ior: 1.0 }, None).unwrap();
    desc.add_point_light(A, Rgb::ONE).unwrap();
    desc.add_mesh(MeshDesc { name: "corner".into(), ..corner() }).unwrap();
    desc.add_mesh(MeshDesc { name: "gone".into(), ..corner() }).unwrap();
    desc.add_mesh(hosted()).unwrap();
    let (sphere, local) = ShapeDesc::sphere(B, 0.5).unwrap();
    let (bowl, _) = ShapeDesc::paraboloid(A, B, 0.5, 1.0).unwrap();
    let light = SurfaceLook { emission: Some(Rgb::ONE), ..SurfaceLook::default() };
    desc.add_surface(ShapeDesc::Mesh { mesh: 0, smooth: true }, local, lit(0)).unwrap();
    desc.add_surface(sphere, local, light).unwrap();
    desc.add_surface(sphere, local, lit(0)).unwrap();
    desc.add_surface(bowl, local, lit(1)).unwrap();
    desc.add_surface(sphere, local, SurfaceLook { material: Some(0), ..light }).unwrap();
    desc.remove_surface(2).unwrap();
    desc.remove_mesh(1).unwrap();
    desc
}

#[test]
fn render_settings_are_checked_as_in_the_format() {
    let fine = RenderDesc::default();
    let crop = |left, top, width, height| Some(CropDesc { left, top, width, height });
    let bad = [
        ("render.resolution[1]", RenderDesc { resolution: [4, 0], ..fine.clone() }),
        ("render.resolution", RenderDesc { resolution: [1 << 14; 2], ..fine.clone() }),
        ("render.crop[0]", RenderDesc { crop: crop(fine.resolution[0], 0, 1, 1), ..fine.clone() }),
        ("render.crop[1]", RenderDesc { crop: crop(0, u32::MAX, 1, 1), ..fine.clone() }),
        ("render.crop[2]", RenderDesc { crop: crop(1, 0, fine.resolution[0], 1), ..fine.clone() }),
        ("render.crop[3]", RenderDesc { crop: crop(0, 0, 1, 0), ..fine.clone() }),
        ("render.samples", RenderDesc { samples: 0, ..fine.clone() }),
        ("render.samples", RenderDesc { samples: u32::MAX, ..fine.clone() }),
        ("render.maxDepth", RenderDesc { max_depth: Some(0), ..fine.clone() }),
        ("render.shadowRays", RenderDesc { shadow_rays: 1025, ..fine.clone() }),
        ("render.filter.sigma", RenderDesc { filter: FilterDesc::Gaussian { sigma: 16.5 }, ..fine.clone() }),
        ("render.filter.sigma", RenderDesc { filter: FilterDesc::Gaussian { sigma: f32::NAN }, ..fine.clone() }),
        ("render.filter.b", RenderDesc { filter: FilterDesc::Mitchell { b: -1.0, c: 0.0 }, ..fine.clone() }),
        ("render.filter.c", RenderDesc { filter: FilterDesc::Mitchell { b: 1.0, c: 2.0 }, ..fine.clone() }),
    ];
    assert!(fine.check().is_ok());
    for (path, render) in bad {
        let error = render.check().expect_err(path);
        assert_eq!(error.location().json_path, path);
    }
    let photons = |change: fn(&mut PhotonDesc)| {
        let mut render = fine.clone();
        change(&mut render.photons);
        render.check()
    };
    type Bad<T> = (&'static str, fn(&mut T));
    let bad_photons: [Bad<PhotonDesc>; 22] = [
        ("render.photonCount", |it| it.count = Some(0)),
        ("render.photonCount", |it| it.count = Some(MAX_PHOTONS + 1)),
        ("render.photonRadius", |it| it.radius = Some(f64::NAN)),
        ("render.photonRadius", |it| it.radius = Some(0.0)),
        ("render.photonRadius", |it| it.radius = Some(1e30)),
        ("render.minPhotons", |it| it.min_photons = 0),
        ("render.causticCount", |it| it.caustic_count = Some(u32::MAX)),
        ("render.causticRadius", |it| it.caustic_radius = Some(f64::INFINITY)),
        ("render.causticRadius", |it| it.caustic_radius = Some(-1.0)),
        ("render.photonNeighbours", |it| it.neighbours = Some(1)),
        ("render.photonNeighbours", |it| it.neighbours = Some(MAX_NEIGHBOURS + 1)),
        ("render.photonKernel.k", |it| it.kernel = Some(KernelDesc::Cone { k: 0.5 })),
        ("render.photonKernel.k", |it| it.kernel = Some(KernelDesc::Cone { k: f32::NAN })),
        ("render.photonKernel.k", |it| it.kernel = Some(KernelDesc::Cone { k: f32::INFINITY })),
        ("render.photonAlpha", |it| it.alpha = 0.0),
        ("render.photonAlpha", |it| it.alpha = 1.0),
        ("render.photonAlpha", |it| it.alpha = f64::NAN),
        ("render.gatherRays", |it| it.gather_rays = 0),
        ("render.gatherRays", |it| it.gather_rays = 1025),
        ("render.photonMemory", |it| it.memory = 0),
        ("render.photonMemory", |it| it.memory = (1 << 20) + 1),
        ("render.photonMemory", |it| it.memory = u32::MAX),
    ];
    for (path, change) in bad_photons {
        assert_eq!(photons(change).expect_err(path).location().json_path, path);
    }
    for change in [
        (|it| it.count = Some(MAX_PHOTONS)) as fn(&mut PhotonDesc),
        |it| it.radius = Some(1e-18),
        |it| it.radius = Some(1e18),
        |it| it.kernel = Some(KernelDesc::Cone { k: 1.0 }),
        |it| it.alpha = 0.999,
        |it| it.memory = 1 << 20,
    ] {
        photons(change).unwrap();
    }
    let bad_caches: [Bad<CacheDesc>; 11] = [
        ("render.cacheError", |it| it.error = 0.0),
        ("render.cacheError", |it| it.error = 10.1),
        ("render.cacheError", |it| it.error = f64::NAN),
        ("render.cacheRays", |it| it.rays = 15),
        ("render.cacheRays", |it| it.rays = (1 << 20) + 1),
        ("render.cacheMinSpacing", |it| it.min_spacing = 0.0),
        ("render.cacheMinSpacing", |it| it.min_spacing = f64::INFINITY),
        ("render.cacheMaxSpacing", |it| it.max_spacing = -0.1),
        ("render.cacheMaxSpacing", |it| it.max_spacing = 1.5),
        ("render.cacheMaxSpacing", |it| it.max_spacing = 1e-300),
        ("render.cacheMaxSpacing", |it| it.max_spacing = f64::NAN),
    ];
    for (path, change) in bad_caches {
        let mut render = fine.clone();
        change(&mut render.cache);
        assert_eq!(render.check().expect_err(path).location().json_path, path);
    }
    let wide = RenderDesc { filter: FilterDesc::Gaussian { sigma: 16.0 }, samples: 1 << 31, ..fine };
    assert!(wide.check().is_ok());
}

#[test]
fn names_and_paths_are_found_until_their_thing_is_removed() {
    let mut desc = base();
    assert_eq!((desc.find_material("glass"), desc.find_material("")), (Some(1), None));
    assert_eq!((desc.find_mesh("corner"), desc.find_mesh("gone"), desc.find_mesh("")), (Some(0), None, None));
    assert_eq!((desc.find_surface("surfaces[3]"), desc.find_surface("surfaces[2]")), (Some(3), None));
    // A removed mesh gives back its memory and its name, not its number.
    assert_eq!((desc.meshes[1].vertex_count(), desc.meshes.len()), (0, 3));
    assert_eq!(desc.add_mesh(MeshDesc { name: "gone".into(), ..corner() }).unwrap(), 3);
    assert_eq!(desc.find_mesh("gone"), Some(3));
    // A removed surface frees its mesh; no number comes again.
    desc.remove_surface(0).unwrap();
    desc.remove_mesh(0).unwrap();
    let (shape, local) = ShapeDesc::sphere(A, 1.0).unwrap();
    assert_eq!(desc.add_surface(shape, local, lit(1)).unwrap(), 5);
    // Without a name, any number of times; surfaces without a material have taken no number.
    for number in 2..5 {
        assert_eq!(desc.add_material("", BsdfDesc::Black, None).unwrap(), number);
    }
    assert!(Scene::build(&desc, &BuildOptions::default()).is_ok());

    // What a file named is found as well, an area light among it.
    let text = file(
        r#""meshes": [{"name": "p", "file": "pyramid.obj"}, {"name": "q", "file": "pyramid.obj"}],
           "lights": [{"type": "area", "vertex-1": [0, 4, 0], "vertex-2": [1, 4, 0], "vertex-3": [0, 4, 1],
                       "color": [1, 1, 1]}],"#,
        r#""geometry": "mesh", "mesh": "q""#,
    );
    let mut read = parse(&text).unwrap();
    assert_eq!((read.find_mesh("p"), read.find_mesh("q"), read.find_material("glass")), (Some(0), Some(0), Some(1)));
    assert_eq!((read.find_surface("lights[0]"), read.find_surface("surfaces[0]")), (Some(0), Some(1)));
    assert!(read.remove_mesh(0).is_err());
    read.remove_surface(1).unwrap();
    read.remove_mesh(0).unwrap();
    assert_eq!((read.find_mesh("p"), read.find_mesh("q")), (None, None));
}

#[test]
fn what_is_set_is_what_is_there() {
    let mut desc = base();
    let blue = BsdfDesc::OrenNayarQualitative { albedo: Rgb::new(0.0, 0.0, 1.0), sigma: std::f32::consts::FRAC_PI_2 };
    desc.set_material(0, blue, Some(0.5)).unwrap();
    assert_eq!((desc.materials[0].bsdf, desc.materials[0].survival), (blue, Some(0.5)));
    assert_eq!(desc.materials[0].name, "white");
    desc.set_point_light(0, B, Rgb::ZERO).unwrap();
    assert_eq!((desc.lights[0].position, desc.lights[0].intensity), (B, Rgb::ZERO));
    // A light that is moved keeps its cone, and one that is replaced its path.
    let cone = LightDistribution::Spot(SpotDesc::new(A));
    let spot = PointLightDesc { distribution: cone.clone(), ..PointLightDesc::even(A, Rgb::ONE) };
    desc.set_light_desc(0, spot).unwrap();
    desc.set_point_light(0, B, Rgb::ZERO).unwrap();
    assert_eq!((desc.lights[0].position, &desc.lights[0].distribution), (B, &cone));
    assert_eq!(desc.lights[0].path, "lights[0]");
    let turned = DAffine3::from_rotation_y(0.5);
    desc.set_transform(4, turned).unwrap();
    assert_eq!(desc.surfaces[4].to_world(), turned);
    // A lamp without a material that is switched off stays as black as it was.
    desc.set_surface_material(4, None).unwrap();
    assert_eq!((desc.surfaces[4].material, desc.surfaces[1].material), (None, None));
    desc.set_emission(1, Some(Rgb::ZERO)).unwrap();
    assert_eq!((desc.surfaces[1].emission, desc.surfaces[1].material), (None, None));
    desc.set_emission(0, Some(Rgb::ONE)).unwrap();
    assert_eq!(desc.surfaces[0].emission, Some(Rgb::ONE));
    // A mesh that is not replaced stays the same, one that is becomes another, with its own name and extent.
    let before = desc.meshes.clone();
    desc.set_mesh(0, MeshDesc { name: "other".into(), ..hosted() }).unwrap();
    assert!(!Arc::ptr_eq(&before[0], &desc.meshes[0]) && Arc::ptr_eq(&before[2], &desc.meshes[2]));
    assert_eq!(
        (desc.meshes[0].name.as_str(), desc.find_mesh("other"), desc.find_mesh("corner")),
        ("corner", None, Some(0))
    );
    desc.set_mesh(0, MeshDesc { positions: vec![DVec3::ZERO, DVec3::X * 1e30, DVec3::Y], ..corner() }).unwrap();
    assert!(desc.set_transform(0, DAffine3::from_scale(DVec3::splat(1e10))).is_err());
    // Data put in by hand is measured anew.
    desc.meshes[0] = corner().into();
    desc.set_transform(0, DAffine3::from_scale(DVec3::splat(1e10))).unwrap();
}

#[test]
fn mesh_files_are_read_with_their_warnings() {
    let mut desc = SceneDesc::default();
    let pyramid = common::snippets::data_dir().join("pyramid.obj");
    assert_eq!(desc.add_mesh_file("p", &pyramid).unwrap(), 0);
    assert_eq!((desc.find_mesh("p"), desc.meshes[0].triangle_count()), (Some(0), 6));
    assert!(desc.warnings.is_empty());
    let dir = tempfile::tempdir().unwrap();
    let odd = dir.path().join("odd.obj");
    std::fs::write(&odd, "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2\nf 1 2 3\n").unwrap();
    assert_eq!(desc.add_mesh_file("", &odd).unwrap(), 1);
    assert_eq!(desc.warnings.len(), 1);
    assert!(desc.warnings[0].starts_with("meshes[1].file: "), "{}", desc.warnings[0]);
    std::fs::write(&odd, "v 0 0 0\nf 1 2 3\n").unwrap();
    let error = desc.add_mesh_file("", &odd).unwrap_err();
    assert_eq!((error.location().json_path.as_str(), error.location().line), ("meshes[2].file", 2));
    assert_eq!((error.location().file.as_deref(), desc.meshes.len(), desc.warnings.len()), (Some(odd.as_path()), 2, 1));
}

#[test]
fn a_file_that_was_read_is_added_where_there_is_room_for_its_name() {
    let mut desc = SceneDesc::default();
    let dir = tempfile::tempdir().unwrap();
    let odd = dir.path().join("odd.obj");
    std::fs::write(&odd, "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2\nf 1 2 3\n").unwrap();
    let read = desc.mesh_file("odd", &odd).unwrap().read(&LoadOptions::default()).unwrap();
    desc.add_mesh(MeshDesc { name: "first".into(), ..corner() }).unwrap();
    assert_eq!(desc.add_read_mesh(read.clone()).unwrap(), 1);
    assert_eq!((desc.find_mesh("odd"), desc.meshes[1].path.as_str()), (Some(1), "meshes[1].file"));
    assert!(desc.warnings.len() == 1 && desc.warnings[0].starts_with("meshes[1].file: "), "{:?}", desc.warnings);
    let error = desc.add_read_mesh(read).unwrap_err();
    assert_eq!(error.location().json_path, "meshes[2].name");
    assert_eq!((desc.meshes.len(), desc.files.len(), desc.warnings.len()), (2, 1, 1));
}

#[test]
fn meshes_are_shared_by_descriptions() {
    let mut first = SceneDesc::default();
    first.add_mesh(MeshDesc { name: "unused".into(), ..corner() }).unwrap();
    let mesh = first.add_mesh(MeshDesc { name: "sail".into(), ..corner() }).unwrap();
    let step = |time, shift| MeshStep {
        time,
        positions: corner().positions.iter().map(|p| *p + DVec3::Z * shift).collect(),
        ..MeshStep::default()
    };
    first.set_mesh_steps(mesh, vec![step(0.0, 0.0), step(1.0, 2.0)]).unwrap();
    let mut second = SceneDesc::default();
    let shared = first.shared_mesh(mesh).unwrap();
    assert_eq!(second.add_shared_mesh("sail", &shared).unwrap(), 0);
    assert!(Arc::ptr_eq(&first.meshes[mesh], &second.meshes[0]) && Arc::ptr_eq(shared.mesh(), &second.meshes[0]));
    assert!(Arc::ptr_eq(&first.motion.meshes[&mesh], &second.motion.meshes[&0]));
    assert_eq!((second.find_mesh("sail"), second.find_mesh("unused")), (Some(0), None));
    // It is what a copy would be.
    let mut copy = SceneDesc::default();
    copy.add_mesh(MeshDesc { name: "sail".into(), ..corner() }).unwrap();
    copy.set_mesh_steps(0, vec![step(0.0, 0.0), step(1.0, 2.0)]).unwrap();
    for desc in [&mut second, &mut copy] {
        desc.add_surface(ShapeDesc::Mesh { mesh: 0, smooth: false }, DAffine3::IDENTITY, lamp_look()).unwrap();
    }
    assert_eq!(second.fingerprint().unwrap(), copy.fingerprint().unwrap());
    // Names are those of each description, and so are edits.
    let error = second.add_shared_mesh("sail", &shared).unwrap_err();
    assert_eq!((error.location().json_path.as_str(), second.meshes.len()), ("meshes[1].name", 1));
    assert_eq!(second.add_shared_mesh("", &shared).unwrap(), 1);
    let before = second.fingerprint().unwrap();
    first.set_mesh(mesh, MeshDesc { positions: vec![DVec3::ZERO; 3], ..corner() }).unwrap();
    assert!(!Arc::ptr_eq(&first.meshes[mesh], &second.meshes[0]) && !first.motion.meshes.contains_key(&mesh));
    assert_eq!(second.fingerprint().unwrap(), before);
    first.remove_mesh(mesh).unwrap();
    for (number, reason) in [(mesh, "was removed"), (7, "there is no mesh 7")] {
        let error = first.shared_mesh(number).unwrap_err();
        assert!(error.message().contains(reason), "{error}");
        assert_eq!(error.location().json_path, format!("meshes[{number}]"));
    }
    // The extent comes along: a transform that takes the mesh beyond single precision is refused.
    let far = SurfaceLook { transform: DAffine3::from_scale(DVec3::splat(1e39)), ..lamp_look() };
    let shape = ShapeDesc::Mesh { mesh: 1, smooth: false };
    assert!(second.add_surface(shape, DAffine3::IDENTITY, far).is_err());
}

#[test]
fn groups_are_made_placed_moved_and_removed() {
    let mut desc = base();
    let lamp = desc.surfaces.len();
    let (sphere, local) = ShapeDesc::sphere(DVec3::ZERO, 1.0).unwrap();
    let shift = |x: f64| DAffine3::from_translation(DVec3::new(x, 0.0, 0.0));
    for x in [1.0, 2.0] {
        desc.add_surface(sphere, local, SurfaceLook { transform: shift(x), ..lamp_look() }).unwrap();
    }
    desc.set_surface_name(lamp, "bulb").unwrap();
    let group = desc.add_group("lamps", &[lamp + 1, lamp]).unwrap();
    assert_eq!((group, desc.find_group("lamps"), desc.find_group("")), (0, Some(0), None));
    // The group has copies.
    desc.set_emission(lamp, Some(Rgb::splat(0.25))).unwrap();
    desc.remove_surface(lamp).unwrap();
    let placed = desc.place_group(group, shift(10.0)).unwrap();
    let surfaces = desc.placements[placed].surfaces.clone();
    assert_eq!(surfaces, lamp + 2..lamp + 4);
    let at = |desc: &SceneDesc, number: usize| desc.surfaces[number].to_world().translation.x;
    assert_eq!(surfaces.clone().map(|number| at(&desc, number)).collect::<Vec<_>>(), [12.0, 11.0]);
    let last = &desc.surfaces[lamp + 3];
    assert_eq!(
        (last.name.as_str(), last.emission, last.path.as_str()),
        ("bulb", lamp_look().emission, format!("surfaces[{}]", lamp + 3).as_str())
    );
    // As a whole and in part.
    desc.set_transform(lamp + 2, shift(-1.0)).unwrap();
    desc.remove_surface(lamp + 3).unwrap();
    desc.set_placement_transform(placed, shift(20.0)).unwrap();
    assert_eq!((at(&desc, lamp + 2), desc.surfaces[lamp + 3].hidden), (22.0, true));
    let before = content(&desc);
    let stretched = DAffine3::from_scale(DVec3::new(1.0, 2.0, 1.0));
    let flat = DAffine3::from_scale(DVec3::new(1.0, 0.0, 1.0));
    let far = shift(3.4e38) * DAffine3::from_scale(DVec3::splat(1e37));
    for (error, path, why) in [
        (desc.place_group(1, shift(0.0)).unwrap_err(), "placements[1]", "there is no group 1"),
        (desc.place_group(0, flat).unwrap_err(), "placements[1].transform", "flatten"),
        (desc.place_group(0, stretched).unwrap_err(), "surfaces[", "stretches"),
        (desc.place_group(0, far).unwrap_err(), "surfaces[", "beyond single precision"),
        (desc.set_placement_transform(0, stretched).unwrap_err(), "surfaces[", "stretches"),
        (desc.set_placement_transform(1, shift(0.0)).unwrap_err(), "placements[1]", "there is no placement 1"),
        (desc.add_group("lamps", &[lamp + 1]).unwrap_err(), "groups[1].name", "given twice"),
        (desc.add_group("", &[]).unwrap_err(), "groups[1].surfaces", "empty"),
        (desc.add_group("", &[lamp]).unwrap_err(), "surfaces[", "was removed"),
        (desc.add_group("", &[99]).unwrap_err(), "surfaces[99]", "there is no surface 99"),
        (desc.add_group("a\0", &[lamp + 1]).unwrap_err(), "groups[1].name", "NUL"),
    ] {
        let found = &error.location().json_path;
        assert!(found.starts_with(path) && error.message().contains(why), "{error}, expected {path}: {why}");
    }
    assert_eq!(content(&desc), before);
    desc.remove_placement(placed).unwrap();
    assert!(desc.surfaces.range(surfaces).unwrap().all(|surface| surface.hidden));
    for error in [
        desc.set_placement_transform(placed, shift(0.0)).unwrap_err(),
        desc.set_placement_motion(placed, None).unwrap_err(),
        desc.remove_placement(placed).unwrap_err(),
    ] {
        assert!(error.message().contains("placement 0 was removed"), "{error}");
    }
    // A mesh of a group cannot be removed.
    let mesh = desc.add_mesh(corner()).unwrap();
    let user = desc.add_surface(ShapeDesc::Mesh { mesh, smooth: false }, DAffine3::IDENTITY, lamp_look()).unwrap();
    let bunch = desc.add_group("bunch", &[user]).unwrap();
    desc.remove_surface(user).unwrap();
    let error = desc.remove_mesh(mesh).unwrap_err();
    assert!(error.message().contains("groups[1] uses the mesh"), "{error}");
    let placed = desc.place_group(bunch, shift(1.0)).unwrap();
    Scene::build(&desc, &BuildOptions::default()).unwrap();
    // Edits know of surfaces that groups keep.
    let white = desc.add_material("matt", BsdfDesc::Lambert { albedo: Rgb::ONE }, None).unwrap();
    let (cone, local) = ShapeDesc::cone(DVec3::ZERO, DVec3::Y, 1.0, 1.0).unwrap();
    let look = SurfaceLook { material: Some(white), ..SurfaceLook::default() };
    let cone = desc.add_surface(cone, local, look).unwrap();
    let cones = desc.add_group("cones", &[cone]).unwrap();
    desc.remove_surface(cone).unwrap();
    let shining = MaterialDesc { emission: Some(Rgb::ONE), ..desc.materials[white].clone() };
    let error = desc.set_material_desc(white, shining.clone()).unwrap_err();
    assert!(error.message().starts_with("groups[2].surfaces[0] cannot have this material"), "{error}");
    desc.remove_group(cones).unwrap();
    desc.set_material_desc(white, shining).unwrap();
    // Groups that are placed stay; those that are not go, with their names.
    let error = desc.remove_group(bunch).unwrap_err();
    assert!(error.message().contains("placements[1] places the group"), "{error}");
    desc.remove_placement(placed).unwrap();
    desc.remove_group(bunch).unwrap();
    for error in [desc.remove_group(bunch).unwrap_err(), desc.place_group(bunch, shift(0.0)).unwrap_err()] {
        assert!(error.message().contains("group 1 was removed"), "{error}");
    }
    assert_eq!(desc.find_group("bunch"), None);
    desc.remove_mesh(mesh).unwrap();
    Scene::build(&desc, &BuildOptions::default()).unwrap();
}

fn lamp_look() -> SurfaceLook {
    SurfaceLook { emission: Some(Rgb::ONE), ..SurfaceLook::default() }
}

/// Named materials and meshes, lamps and uses of one mesh, each moved once.
fn populated(count: usize) -> Duration {
    let start = Instant::now();
    let mut desc = SceneDesc::default();
    let shared = desc.add_mesh(corner()).unwrap();
    for i in 0..count {
        let material = desc.add_material(&format!("m{i}"), BsdfDesc::Lambert { albedo: Rgb::ONE }, None).unwrap();
        let own = desc.add_mesh(MeshDesc { name: format!("mesh {i}"), ..corner() }).unwrap();
        let (sphere, local) = ShapeDesc::sphere(DVec3::X * i as f64, 0.5).unwrap();
        let lamp = SurfaceLook { emission: Some(Rgb::ONE), ..SurfaceLook::default() };
        desc.add_surface(sphere, local, lamp).unwrap();
        for mesh in [shared, own] {
            let surface = desc.add_surface(ShapeDesc::Mesh { mesh, smooth: false }, local, lit(material)).unwrap();
            desc.set_transform(surface, DAffine3::from_translation(DVec3::Y * i as f64)).unwrap();
            if mesh == own && i % 2 == 0 {
                desc.set_mesh(own, corner()).unwrap();
                desc.remove_surface(surface).unwrap();
                desc.remove_mesh(own).unwrap();
            }
        }
    }
    assert_eq!(desc.surfaces.len(), 3 * count);
    start.elapsed()
}

#[test]
fn the_cost_of_a_call_does_not_grow_with_the_scene() {
    let rounds: Vec<[Duration; 2]> = (0..4).map(|_| [populated(10_000), populated(100_000)]).collect();
    let [small, large] = [0, 1].map(|size| rounds.iter().map(|round| round[size]).min().unwrap_or_default());
    println!("{small:?} for 3 * 10^4 surfaces, {large:?} for 3 * 10^5");
    // Ten times as much work; a search of all that is there would take a hundred times as long.
    assert!(large < 30 * small, "{rounds:?} for 10^4 and for 10^5");
}
