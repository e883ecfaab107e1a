//! Reading scenes: every key of the format, the report's files, parameter files, meshes.

mod common;

use std::path::{Path, PathBuf};

use etendue::ErrorKind;
use etendue::desc::{
    self, BsdfDesc, CacheDesc, CacheSource, CameraDesc, CropDesc, Dialect, Dispersion, FilmDesc, FilterDesc, FocusDesc,
    FovAxis, IntegratorDesc, KernelDesc, LensDesc, MaterialDesc, MediumDesc, Panorama, PanoramaDesc, PhotonDesc,
    PhotonSharing, RenderDesc, RouletteDesc, SamplerDesc, SceneDesc, ShapeDesc, SpectrumDesc, StandardIlluminant,
    ThinFilmDesc,
};
use etendue::math::{DAffine3, DVec3};
use etendue::spectrum::Rgb;

fn parse(text: &str) -> SceneDesc {
    desc::parse(text, &common::snippets::data_dir(), None).unwrap_or_else(|error| panic!("{error}\n{text}"))
}

/// A native scene with `more` at its top.
fn native(more: &str) -> SceneDesc {
    let white = r#"{"name": "white", "type": "diffuse", "color": [0.5, 0.5, 0.5]}"#;
    let materials = if more.contains("\"materials\"") { String::new() } else { format!("\"materials\": [{white}],") };
    parse(&format!("{{\"etendue\": 1, \"camera\": {{}}, {materials} {more}}}"))
}

fn surface(text: &str) -> desc::SurfaceDesc {
    native(&format!("\"surfaces\": [{text}]")).surfaces.remove(0)
}

fn near(a: DVec3, b: DVec3) -> bool {
    (a - b).length() < 1e-12
}

#[test]
fn every_example_in_the_documentation_is_read() {
    let snippets = common::snippets::snippets();
    for (kind, snippet, text) in &snippets {
        if kind == "params" {
            desc::apply_params(text, None, &mut SceneDesc::default())
                .unwrap_or_else(|error| panic!("{error}\n{snippet}"));
        } else {
            let scene = parse(text);
            assert!(scene.warnings.is_empty(), "{:?}\n{snippet}", scene.warnings);
        }
    }
    assert!(snippets.len() >= 30, "{} examples found", snippets.len());
}

#[test]
fn what_is_left_out_has_the_documented_default() {
    let scene = native("\"surfaces\": null");
    assert_eq!(scene.dialect, Dialect::Native);
    assert_eq!(scene.camera, CameraDesc::default());
    assert_eq!(scene.render, RenderDesc::default());
    assert!(scene.surfaces.is_empty() && scene.lights.is_empty() && scene.meshes.is_empty());
    assert_eq!(scene.materials[0].bsdf, BsdfDesc::Lambert { albedo: Rgb::splat(0.5) });
    assert_eq!(scene.materials[0].survival, None);
    assert_eq!(parse("\u{feff}{\"etendue\": 1.0, \"camera\": {}}").dialect, Dialect::Native, "with byte order mark");
}

#[test]
fn cameras_are_read_with_every_key() {
    let keys = r#""origin": [1, 2, 3], "lookAt": [4, 5, 6.5], "up": [0, 0, 2], "fieldOfView": 35"#;
    let camera = |more: &str| parse(&format!("{{\"etendue\": 1, \"camera\": {{{keys}{more}}}}}")).camera;
    let (origin, look_at, up, fov_deg) =
        (DVec3::new(1.0, 2.0, 3.0), DVec3::new(4.0, 5.0, 6.5), DVec3::new(0.0, 0.0, 2.0), 35.0);
    for (more, fov_axis) in [
        ("", FovAxis::Horizontal),
        (r#", "fieldOfViewAxis": "vertical", "type": "perspective""#, FovAxis::Vertical),
        (r#", "fieldOfViewAxis": "horizontal""#, FovAxis::Horizontal),
    ] {
        assert_eq!(
            camera(more),
            CameraDesc::Perspective { eye: origin, look_at, up, fov_deg, fov_axis, film: FilmDesc::default() }
        );
    }
    let film = FilmDesc { shift: [0.25, -1.5], pixel_aspect: 0.75 };
    let seen = CameraDesc::Perspective { eye: origin, look_at, up, fov_deg, fov_axis: FovAxis::Horizontal, film };
    assert_eq!(camera(r#", "shift": [0.25, -1.5], "pixelAspect": 0.75"#), seen);
    let fisheye = PanoramaDesc { fov_deg, pixel_aspect: 2.0, ..PanoramaDesc::new(Panorama::Fisheye) };
    let fisheye = CameraDesc::Panoramic { eye: origin, look_at, up, panorama: fisheye };
    assert_eq!(camera(r#", "type": "fisheye", "pixelAspect": 2"#), fisheye);
    let plane = CameraDesc::ViewPlane { centre: origin, look_at, up, fov_deg };
    assert_eq!(camera(r#", "type": "view-plane""#), plane);
    assert_eq!(parse(&format!("{{\"camera\": {{{keys}}}}}")).camera, plane, "the report's dialect");
}

#[test]
fn lenses_and_parallel_rays_are_read_with_every_key() {
    let keys = r#""origin": [1, 2, 3], "lookAt": [4, 5, 6.5], "up": [0, 0, 2]"#;
    let camera = |more: &str| parse(&format!("{{\"etendue\": 1, \"camera\": {{{keys}, {more}}}}}")).camera;
    let (eye, look_at, up) = (DVec3::new(1.0, 2.0, 3.0), DVec3::new(4.0, 5.0, 6.5), DVec3::new(0.0, 0.0, 2.0));
    for (more, lens) in [
        (r#""lensRadius": 0.25"#, LensDesc::new(0.25)),
        (r#""lensRadius": 0"#, LensDesc::new(0.0)),
        (r#""fStop": 2.5, "focalLength": 0.05, "focusAt": null"#, LensDesc::new(0.01)),
        (
            r#""lensRadius": 0.25, "focusDistance": 3.5, "blades": 6.0, "squeeze": 2"#,
            LensDesc { focus: FocusDesc::Distance(3.5), blades: 6, squeeze: 2.0, ..LensDesc::new(0.25) },
        ),
        (
            r#""lensRadius": 0.25, "focusAt": [4, 4, 4], "blades": 32, "bladeRotation": -30"#,
            LensDesc {
                focus: FocusDesc::Point(DVec3::splat(4.0)),
                blades: 32,
                blade_rotation_deg: -30.0,
                ..LensDesc::new(0.25)
            },
        ),
    ] {
        let fov_axis = FovAxis::Vertical;
        let expected =
            CameraDesc::ThinLens { eye, look_at, up, fov_deg: 35.0, fov_axis, lens, film: FilmDesc::default() };
        assert_eq!(camera(&format!(r#"{more}, "fieldOfView": 35, "fieldOfViewAxis": "vertical""#)), expected);
    }
    for (more, axis) in [(r#""width": 4.5"#, FovAxis::Horizontal), (r#""height": 4.5"#, FovAxis::Vertical)] {
        let expected = CameraDesc::Orthographic { eye, look_at, up, size: 4.5, axis, film: FilmDesc::default() };
        assert_eq!(camera(&format!(r#""type": "orthographic", {more}"#)), expected);
    }
    for (more, kind, fov_deg, fov_axis) in [
        (r#""type": "spherical""#, Panorama::Spherical, 360.0, FovAxis::Horizontal),
        (r#""type": "cylindrical""#, Panorama::Cylindrical, 360.0, FovAxis::Horizontal),
        (r#""type": "cylindrical", "fieldOfView": 120"#, Panorama::Cylindrical, 120.0, FovAxis::Horizontal),
        (r#""type": "fisheye""#, Panorama::Fisheye, 180.0, FovAxis::Vertical),
        (
            r#""type": "fisheye", "fieldOfView": 360, "fieldOfViewAxis": "horizontal""#,
            Panorama::Fisheye,
            360.0,
            FovAxis::Horizontal,
        ),
    ] {
        let panorama = PanoramaDesc { kind, fov_deg, fov_axis, pixel_aspect: 1.0 };
        assert_eq!(camera(more), CameraDesc::Panoramic { eye, look_at, up, panorama });
    }
}

#[test]
fn render_blocks_are_read_with_every_key() {
    let render = |block: &str| native(&format!("\"render\": {{{block}}}")).render;
    let all = render(
        r#""resolution": [640, 480.0], "crop": [100, 0, 540, 480], "samples": 256, "sampler": "jittered", "filter": {"type": "gaussian",
          "sigma": 0.25},
           "maxDepth": 9, "shadowRays": 2, "roulette": "file", "integrator": {"type": "whitted"}, "seed": 18446744073709551615"#,
    );
    let expected = RenderDesc {
        resolution: [640, 480],
        crop: Some(CropDesc { left: 100, top: 0, width: 540, height: 480 }),
        samples: 256,
        sampler: SamplerDesc::Jittered,
        filter: FilterDesc::Gaussian { sigma: 0.25 },
        integrator: IntegratorDesc::Whitted,
        max_depth: Some(9),
        shadow_rays: 2,
        roulette: RouletteDesc::File,
        seed: u64::MAX,
        ..RenderDesc::default()
    };
    assert_eq!(all, expected);
    for (name, sampler) in [
        ("sobol", SamplerDesc::Sobol),
        ("random", SamplerDesc::Random),
        ("grid", SamplerDesc::Grid),
        ("gaussian", SamplerDesc::Gaussian),
    ] {
        assert_eq!(render(&format!("\"sampler\": \"{name}\"")).sampler, sampler);
    }
    let third = 1.0 / 3.0;
    for (text, filter) in [
        (r#""box""#, FilterDesc::Box),
        (r#"{"type": "box"}"#, FilterDesc::Box),
        (r#""tent""#, FilterDesc::Tent),
        (r#""gaussian""#, FilterDesc::Gaussian { sigma: 0.5 }),
        (r#"{"type": "blackman-harris"}"#, FilterDesc::BlackmanHarris),
        (r#""mitchell""#, FilterDesc::Mitchell { b: third, c: third }),
        (r#"{"type": "mitchell", "b": 0, "c": 0.5}"#, FilterDesc::Mitchell { b: 0.0, c: 0.5 }),
    ] {
        assert_eq!(render(&format!("\"filter\": {text}")).filter, filter);
    }
    for (name, integrator) in [
        ("path", IntegratorDesc::Path),
        ("whitted", IntegratorDesc::Whitted),
        ("direct", IntegratorDesc::Direct),
        ("photon_direct", IntegratorDesc::PhotonDirect),
        ("caustic", IntegratorDesc::Caustic),
        ("photon", IntegratorDesc::Photon),
        ("irradiance_cache", IntegratorDesc::IrradianceCache),
        ("radiosity", IntegratorDesc::Radiosity),
        ("ppm", IntegratorDesc::Ppm),
        ("sppm", IntegratorDesc::Sppm),
        ("auto", IntegratorDesc::Auto),
    ] {
        assert_eq!(render(&format!("\"integrator\": \"{name}\"")).integrator, integrator);
        assert_eq!(render(&format!("\"integrator\": {{\"type\": \"{name}\"}}")).integrator, integrator);
    }
    for (text, reuse) in [
        (r#"{"type": "path", "reuse": true}"#, Some(true)),
        (r#"{"type": "path", "reuse": false}"#, Some(false)),
        (r#"{"type": "path"}"#, None),
        (r#""path""#, None),
    ] {
        assert_eq!(render(&format!("\"integrator\": {text}")), RenderDesc { reuse, ..RenderDesc::default() });
        let light_paths = RenderDesc { light_paths: reuse, ..RenderDesc::default() };
        assert_eq!(render(&format!("\"integrator\": {}", text.replace("reuse", "lightPaths"))), light_paths);
    }
    let first = RenderDesc { first_shadow_rays: Some(4), ..RenderDesc::default() };
    assert_eq!(render(r#""integrator": {"type": "path", "firstShadowRays": 4}"#), first);
    for (text, allow_bias) in [("\"allowed\"", true), ("\"refused\"", false), ("null", false)] {
        let expected = RenderDesc { integrator: IntegratorDesc::Auto, allow_bias, ..RenderDesc::default() };
        assert_eq!(render(&format!("\"integrator\": {{\"type\": \"auto\", \"bias\": {text}}}")), expected);
    }
}

#[test]
fn settings_of_photon_maps_and_caches_are_read_with_every_key() {
    let render = |block: &str| native(&format!("\"render\": {{{block}}}")).render;
    let all = render(
        r#""photonCount": 1e6, "photonRadius": 0.25, "minPhotons": 20, "causticCount": 3, "causticRadius": 1e-3,
           "photonNeighbours": 65536, "photonKernel": {"type": "cone", "k": 1.25}, "photonAlpha": 0.75,
           "photonSharing": "area", "photonsGuided": false, "photonsProgressive": false, "gatherRays": 16,
           "photonMemory": 1048576, "cacheError": 0.3, "cacheRays": 16, "cacheMinSpacing": 1.5, "cacheMaxSpacing": 1,
           "cacheSource": "photons""#,
    );
    let photons = PhotonDesc {
        count: Some(1_000_000),
        radius: Some(0.25),
        min_photons: 20,
        caustic_count: Some(3),
        caustic_radius: Some(1e-3),
        neighbours: Some(65536),
        kernel: Some(KernelDesc::Cone { k: 1.25 }),
        alpha: 0.75,
        sharing: PhotonSharing::Area,
        guided: false,
        progressive: false,
        gather_rays: 16,
        memory: 1 << 20,
    };
    let cache = CacheDesc {
        error: 0.3, //
        rays: 16,
        min_spacing: 1.5,
        max_spacing: 1.0,
        source: CacheSource::Photons,
    };
    assert_eq!(all, RenderDesc { photons, cache, ..RenderDesc::default() });
    let aliased = render(r#""photon_count": 7, "photon_radius": 2, "min_photons": 1"#);
    let photons = PhotonDesc { count: Some(7), radius: Some(2.0), min_photons: 1, ..PhotonDesc::default() };
    assert_eq!(aliased, RenderDesc { photons, ..RenderDesc::default() });
    let nothing = [
        "photonCount",
        "photonRadius",
        "minPhotons",
        "photon_count",
        "photon_radius",
        "min_photons",
        "causticCount",
        "causticRadius",
        "photonNeighbours",
        "photonKernel",
        "photonAlpha",
        "photonSharing",
        "photonsGuided",
        "photonsProgressive",
        "gatherRays",
        "photonMemory",
        "cacheError",
        "cacheRays",
        "cacheMinSpacing",
        "cacheMaxSpacing",
        "cacheSource",
    ]
    .map(|key| format!("\"{key}\": null"))
    .join(", ");
    assert_eq!(render(&nothing), RenderDesc::default());
    for (text, kernel) in [
        (r#""flat""#, KernelDesc::Flat),
        (r#"{"type": "flat"}"#, KernelDesc::Flat),
        (r#""cone""#, KernelDesc::Cone { k: 1.0 }),
        (r#"{"type": "cone"}"#, KernelDesc::Cone { k: 1.0 }),
        (r#"{"type": "cone", "k": null}"#, KernelDesc::Cone { k: 1.0 }),
        (r#""epanechnikov""#, KernelDesc::Epanechnikov),
        (r#"{"type": "epanechnikov"}"#, KernelDesc::Epanechnikov),
    ] {
        assert_eq!(render(&format!("\"photonKernel\": {text}")).photons.kernel, Some(kernel));
    }
    let defaults =
        r#""photonSharing": "power", "photonsGuided": true, "photonsProgressive": true, "cacheSource": "paths""#;
    assert_eq!(render(defaults), RenderDesc::default());
}

#[test]
fn materials_are_read_with_every_key() {
    let albedo = Rgb::new(0.25, 0.5, 1.0);
    for (text, bsdf, survival) in [
        (r#""type": "diffuse", "color": [0.25, 0.5, 1]"#, BsdfDesc::Lambert { albedo }, None),
        (
            r#""type": "diffuse", "color": [0.25, 0.5, 1], "brdf": "lambertian", "reflectionRate": 0.75"#,
            BsdfDesc::Lambert { albedo },
            Some(0.75),
        ),
        (
            r#""type": "diffuse", "color": [0.25, 0.5, 1], "brdf": "oren-nayar", "roughness": 0.5"#,
            BsdfDesc::OrenNayar { albedo, roughness: 0.5 },
            None,
        ),
        (
            r#""type": "diffuse", "color": [0.25, 0.5, 1], "brdf": "oren-nayar-qualitative", "sigmaDeg": 45"#,
            BsdfDesc::OrenNayarQualitative { albedo, sigma: std::f32::consts::FRAC_PI_4 },
            None,
        ),
        (r#""type": "reflective""#, BsdfDesc::Mirror { reflectance: Rgb::ONE }, None),
        (r#""type": "reflective", "color": [0.25, 0.5, 1]"#, BsdfDesc::Mirror { reflectance: albedo }, None),
        (r#""type": "refractive", "refractionIndex": 1.5"#, BsdfDesc::Dielectric { ior: 1.5, exterior_ior: 1.0 }, None),
        (
            r#""type": "refractive", "refractionIndex": 1, "exteriorIndex": 1.25"#,
            BsdfDesc::Dielectric { ior: 1.0, exterior_ior: 1.25 },
            None,
        ),
        (r#""type": "black""#, BsdfDesc::Black, None),
    ] {
        let scene = native(&format!("\"materials\": [{{\"name\": \"m\", {text}}}]"));
        let material = &scene.materials[0];
        assert_eq!((material.name.as_str(), material.path.as_str()), ("m", "materials[0]"));
        assert_eq!((material.bsdf, material.survival), (bsdf, survival));
    }
}

#[test]
fn spectra_are_read_in_all_forms() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("lamp.csv"), "nm,value\n400,0.5\n700,1\n").unwrap();
    std::fs::write(folder.path().join("bad.spd"), "400 0.5\n700\n").unwrap();
    std::fs::write(folder.path().join("falling.spd"), "700 0.5\n400 1\n").unwrap();
    let read = |surface: &str| {
        let text = format!(
            "{{\"etendue\": 1, \"camera\": {{}}, \"surfaces\": [{{\"geometry\": \"sphere\", \"origin\": [0, 0, 0], \"radius\": 1{surface}}}]}}"
        );
        desc::parse(&text, folder.path(), None)
    };
    let samples = |pairs: &[[f64; 2]]| SpectrumDesc::samples("", pairs).unwrap();
    for (text, expected) in [
        (r#""D50""#, SpectrumDesc::Standard(StandardIlluminant::D50)),
        (r#""FL11""#, SpectrumDesc::Standard(StandardIlluminant::FL11)),
        (r#"{"blackBody": 2700}"#, SpectrumDesc::BlackBody(2700.0)),
        (r#"{"daylight": 5003}"#, SpectrumDesc::Daylight(5003.0)),
        ("[[400, 0.5], [700, 1]]", samples(&[[400.0, 0.5], [700.0, 1.0]])),
        (r#"{"from": 400, "step": 150, "values": [1, 0, 2]}"#, samples(&[[400.0, 1.0], [550.0, 0.0], [700.0, 2.0]])),
        (r#"{"file": "lamp.csv"}"#, samples(&[[400.0, 0.5], [700.0, 1.0]])),
    ] {
        let scene = read(&format!(", \"spectrum\": {text}")).unwrap();
        assert_eq!(scene.surfaces[0].spectrum.as_ref(), Some(&expected), "{text}");
        // In photometric units, and of an emission, the spectrum says the colour alone.
        for (level, luminance) in [(r#""luminance": 1366"#, 2.0), (r#""emission": [2, 2, 2]"#, 2.0)] {
            let scene = read(&format!(", \"spectrum\": {text}, {level}")).unwrap();
            let emission = scene.surfaces[0].emission.unwrap();
            assert!((etendue::spectrum::luminance(emission) - luminance).abs() < 1e-5, "{text}: {emission:?}");
        }
    }
    let d65 = read(r#", "spectrum": "D65""#).unwrap().surfaces[0].emission.unwrap();
    assert!((d65.to_array().map(|it| (it - 1.0).abs())).iter().all(|it| *it < 1e-5), "{d65:?}");
    let path = "surfaces[0].spectrum";
    for (text, path, message) in [
        (r#", "spectrum": "D56""#, path, "did you mean 'D5"),
        (r#", "spectrum": {"blackBody": 100}"#, "surfaces[0].spectrum.blackBody", "100 is out of range"),
        (r#", "spectrum": {"daylight": 3000}"#, "surfaces[0].spectrum.daylight", "3000 is out of range"),
        (r#", "spectrum": {}"#, path, "expected one of: `blackBody`"),
        (r#", "spectrum": {"blackBody": 3000, "daylight": 5000}"#, path, "expected one of: `blackBody`"),
        (r#", "spectrum": {"values": [1, 2], "from": 400}"#, path, "expected one of: `blackBody`"),
        (
            r#", "spectrum": {"values": [1, 2], "from": 400, "step": 0}"#,
            "surfaces[0].spectrum[1][0]",
            "comes after 400 nm",
        ),
        (r#", "spectrum": {"file": "none.csv"}"#, "surfaces[0].spectrum.file", "none.csv"),
        (r#", "spectrum": {"file": ""}"#, "surfaces[0].spectrum.file", "not a file name"),
        (r#", "spectrum": {"file": "bad.spd"}"#, "surfaces[0].spectrum.file", "the line is '700'"),
        (r#", "spectrum": {"file": "falling.spd"}"#, "surfaces[0].spectrum.file[1][0]", "comes after 700 nm"),
        (r#", "spectrum": [[400, 1], [400, 2]]"#, "surfaces[0].spectrum[1][0]", "comes after 400 nm"),
        (r#", "spectrum": [[400, -1]]"#, "surfaces[0].spectrum[0][1]", "-1 is out of range"),
        (r#", "spectrum": [[400, 1, 2]]"#, "surfaces[0].spectrum", "too many elements"),
        (r#", "spectrum": [[1000, 1], [2000, 1]]"#, path, "no light that is seen"),
        (r#", "spectrum": 5"#, path, "expected"),
        (
            r#", "spectrum": "A", "luminance": 5, "temperature": 3000"#,
            "surfaces[0].temperature",
            "says the colour already",
        ),
    ] {
        let error = read(text).unwrap_err();
        assert!(error.to_string().contains(path), "{text}: {error}");
        assert!(error.to_string().contains(message), "{text}: {error}");
    }
}

/// In three channels, an absorption is that of the colour that it leaves, in any unit of length.
#[test]
fn absorption_has_its_colour_in_any_unit() {
    let of = |spectrum: &str| {
        let keys = format!(
            r#""name": "m", "type": "refractive", "refractionIndex": 1.5, "spectra": {{"absorption": {spectrum}}}"#
        );
        native(&format!("\"materials\": [{{{keys}}}]")).materials[0].medium.unwrap().absorption.to_array()
    };
    for value in [1e-9_f32, 1e-4, 0.3, 1.0, 200.0, 1e6] {
        for channel in of(&format!("[[500, {value:e}]]")) {
            assert!((channel / value - 1.0).abs() < 1e-4, "{value}: {channel}");
        }
        let ramp = |scale: f32| of(&format!("[[400, {:e}], [700, {:e}]]", scale, 3.0 * scale));
        let (unit, scaled) = (ramp(1.0), ramp(value));
        for (unit, scaled) in unit.into_iter().zip(scaled) {
            assert!((scaled / value / unit - 1.0).abs() < 1e-4, "{value}: {scaled} for {unit}");
        }
        assert!(unit[0] > unit[1] && unit[1] > unit[2] && unit[2] > 0.9, "{unit:?}");
    }
    assert_eq!(of("[[500, 0]]"), [0.0; 3]);
}

/// A light outside of Rec. 709 is warned of where three channels are rendered.
#[test]
fn light_out_of_gamut_is_said() {
    let of = |spectral: bool, kelvin: u32| {
        native(&format!(
            r#""render": {{"spectral": {spectral}}}, "lights": [{{"type": "point", "origin": [0, 0, 0], "spectrum": {{"blackBody": {kelvin}}}}}]"#
        ))
        .warnings
    };
    assert!(of(false, 1000)[0].contains("lights[0].spectrum: the colour lies outside of Rec. 709"));
    assert!(of(true, 1000).is_empty() && of(false, 6500).is_empty());
}

#[test]
fn a_picture_has_a_white() {
    let of = |text: &str| {
        let text = format!("{{\"etendue\": 1, \"camera\": {{}}, \"render\": {{\"whiteBalance\": {text}}}}}");
        desc::parse(&text, "".as_ref(), None)
    };
    for (text, [x, y]) in [
        (r#""D50""#, [0.345_67, 0.358_51]),
        (r#""E""#, [0.333_31, 0.333_29]),
        (r#""FL2""#, [0.3721, 0.3751]),
        ("2000", [0.5267, 0.4133]),
        ("[0.25, 0.5]", [0.25, 0.5]),
    ] {
        let white = of(text).unwrap().render.white_balance.unwrap();
        assert!((white[0] - x).abs() < 3e-4 && (white[1] - y).abs() < 3e-4, "{text}: {white:?}");
    }
    for (text, message) in [
        (r#""D56""#, "no illuminant `D56`"),
        ("500", "500 is out of range"),
        ("[0.9, 0.5]", "no light that could be white"),
        ("[0.3, 0]", "no light that could be white"),
        ("[0.3]", "expected"),
        (r#"{"blackBody": 3000}"#, "expected"),
    ] {
        let error = of(text).unwrap_err().to_string();
        assert!(error.contains("render.whiteBalance") && error.contains(message), "{text}: {error}");
    }
}

#[test]
fn parameters_of_materials_may_have_spectra() {
    let material = |keys: &str| format!("\"materials\": [{{\"name\": \"m\", {keys}}}]");
    let ramp = r#"[[400, 0.25], [700, 0.75]]"#;
    let scene = native(&material(&format!(r#""type": "diffuse", "spectra": {{"color": {ramp}}}"#)));
    let BsdfDesc::Lambert { albedo } = scene.materials[0].bsdf else { panic!("a Lambertian surface") };
    assert!(albedo.r() > albedo.g() && albedo.g() > albedo.b() && albedo.b() > 0.25, "{albedo:?}");
    // Both shares of a sheet sum to less than 1 at each wavelength, though not in channels.
    let sheet = native(&material(
        r#""type": "diffuse-transmission", "color": [0.1, 0.1, 0.1], "spectra": {"transmittance": [[500, 0.5], [600, 0.9]]}"#,
    ));
    assert!(!sheet.materials[0].spectra.is_empty());
    for keys in [
        format!(r#""type": "reflective", "spectra": {{"color": {ramp}}}"#),
        format!(r#""type": "sheen", "spectra": {{"color": {ramp}}}"#),
        format!(r#""type": "diffuse-transmission", "spectra": {{"transmittance": {ramp}}}"#),
        format!(r#""type": "conductor", "spectra": {{"reflectance": {ramp}}}"#),
        format!(r#""type": "conductor", "spectra": {{"eta": {ramp}, "k": [[400, 2], [700, 4]]}}"#),
        format!(r#""type": "conductor", "eta": [1, 2, 3], "spectra": {{"k": {ramp}}}"#),
        format!(r#""type": "conductor", "metal": "Au", "roughness": 0.3, "spectra": {{"k": {ramp}}}"#),
        format!(
            r#""type": "refractive", "refractionIndex": 1.5, "roughness": 0.2, "spectra": {{"absorption": {ramp}}}"#
        ),
        r#""type": "black", "spectra": {"emission": {"blackBody": 2700}}"#.to_owned(),
    ] {
        let scene = native(&material(&keys));
        assert!(!scene.materials[0].spectra.is_empty(), "{keys}");
    }
    for (keys, path, message) in [
        (r#""type": "diffuse""#, "materials[0]", "missing key `color`"),
        (r#""type": "diffuse", "spectra": {"transmittance": RAMP}"#, "materials[0]", "missing key `color`"),
        (
            r#""type": "diffuse", "color": [1, 1, 1], "spectra": {"eta": RAMP}"#,
            "materials[0].spectra.eta",
            "only a conductor",
        ),
        (r#""type": "diffuse", "spectra": {"color": [[400, 2]]}"#, "materials[0].spectra.color", "2 is out of range"),
        (r#""type": "diffuse", "spectra": {"color": "D65"}"#, "materials[0].spectra.color", "a spectrum of light"),
        (
            r#""type": "diffuse", "color": [1, 1, 1], "spectra": {"colour": RAMP}"#,
            "materials[0].spectra.colour",
            "did you mean 'color'?",
        ),
        (
            r#""type": "conductor", "spectra": {"reflectance": RAMP, "eta": RAMP}"#,
            "materials[0]",
            "expected one of: `metal`",
        ),
        (
            r#""type": "conductor", "metal": "Au", "spectra": {"eta": [[400, 0]]}"#,
            "materials[0].spectra.eta",
            "0 is out of range",
        ),
        (
            r#""type": "black", "luminance": 3, "temperature": 3000, "spectra": {"emission": {"blackBody": 3000}}"#,
            "materials[0].temperature",
            "says the colour already",
        ),
        (r#""type": "principled", "spectra": {"color": RAMP}"#, "materials[0].spectra.color", "only a diffuse"),
        (
            r#""type": "coated-diffuse", "color": [1, 1, 1], "refractionIndex": 1.5, "spectra": {"color": RAMP}"#,
            "materials[0].spectra.color",
            "only a diffuse",
        ),
        (
            r#""type": "thin-refractive", "refractionIndex": 1.5, "spectra": {"transmittance": RAMP}"#,
            "materials[0].spectra.transmittance",
            "only a sheet",
        ),
        (
            r#""type": "diffuse-transmission", "color": [0.5, 0.5, 0.5], "spectra": {"transmittance": RAMP}"#,
            "materials[0]",
            "sum to 1.25",
        ),
    ] {
        let keys = keys.replace("RAMP", ramp);
        let text = format!("{{\"etendue\": 1, \"camera\": {{}}, {}}}", material(&keys));
        let error = desc::parse(&text, "".as_ref(), None).unwrap_err();
        assert!(error.to_string().contains(path), "{keys}: {error}");
        assert!(error.to_string().contains(message), "{keys}: {error}");
    }
}

#[test]
fn a_refractive_material_may_disperse_light() {
    let material = |keys: &str| format!(r#"{{"name": "m", "type": "refractive"{keys}}}"#);
    let diamond = Dispersion::by_name("diamond");
    let numbers = r#"{"strengths": [0.3306, 4.3356], "resonances": [0.030625, 0.011236]}"#;
    let cases = [
        (r#", "refractionIndex": 1.5"#.to_owned(), 1.5, None),
        (r#", "refractionIndex": 1.5, "dispersion": 64.2"#.to_owned(), 1.5, Some(Dispersion::Abbe(64.2))),
        (r#", "dispersion": "diamond""#.to_owned(), 2.417_5, diamond),
        (r#", "dispersion": "diamond", "refractionIndex": 2.4175"#.to_owned(), 2.417_5, diamond),
        (format!(r#", "dispersion": {numbers}, "roughness": 0.5"#), 2.417_5, diamond),
    ];
    for (keys, index, expected) in cases {
        let scene = native(&format!("\"materials\": [{}]", material(&keys)));
        let (BsdfDesc::Dielectric { ior, .. } | BsdfDesc::RoughDielectric { ior, .. }) = scene.materials[0].bsdf else {
            panic!("{keys}");
        };
        assert!((ior - index).abs() < 5e-5, "{keys}: {ior}");
        assert_eq!(scene.materials[0].dispersion, expected, "{keys}");
    }
    for (keys, path, message) in [
        (r#", "dispersion": 64.2"#, "materials[0]", "missing key `refractionIndex`"),
        (r#", "refractionIndex": 1.5, "dispersion": 0"#, "materials[0].dispersion", "the Abbe number is 0"),
        (r#", "refractionIndex": 1.5, "dispersion": -3"#, "materials[0].dispersion", "the Abbe number is -3"),
        (r#", "refractionIndex": 1.5, "dispersion": 0.05"#, "materials[0].dispersion", "the index of refraction at"),
        (
            r#", "refractionIndex": 1.5, "dispersion": "diamond""#,
            "materials[0].dispersion",
            "the formula has the index 2.4174",
        ),
        (r#", "dispersion": "daimond""#, "materials[0].dispersion", "did you mean 'diamond'?"),
        (r#", "dispersion": [1]"#, "materials[0].dispersion", "expected"),
        (r#", "dispersion": {"strengths": [1]}"#, "materials[0].dispersion", "missing"),
        (r#", "dispersion": {"strengths": [1], "resonances": []}"#, "materials[0].dispersion.resonances", "0 numbers"),
        (
            r#", "dispersion": {"strengths": [1, 1, 1, 1, 1], "resonances": [0, 0, 0, 0, 0]}"#,
            "materials[0].dispersion.strengths",
            "5 numbers",
        ),
        (
            r#", "dispersion": {"strengths": [1], "resonances": [0.25]}"#,
            "materials[0].dispersion",
            "the resonance 0.25 is that of visible light",
        ),
        (
            r#", "dispersion": {"strengths": [1e39], "resonances": [0]}"#,
            "materials[0].dispersion",
            "the index of refraction at 360 nm is inf",
        ),
        (
            r#", "dispersion": {"strengths": [-2], "resonances": [0]}"#,
            "materials[0].dispersion",
            "the index of refraction at 360 nm is NaN",
        ),
    ] {
        let text = format!(r#"{{"etendue": 1, "camera": {{}}, "materials": [{}]}}"#, material(keys));
        let error = etendue::desc::parse(&text, "".as_ref(), None).expect_err(keys).to_string();
        assert!(error.contains(&format!("{path}: ")) && error.contains(message), "{keys}: {error}");
    }
}

#[test]
fn glass_and_metals_may_have_a_thin_film() {
    let film = |keys: &str| format!(r#"{{"name": "m", {keys}}}"#);
    let soap = Some(ThinFilmDesc { thickness: 312.5, ior: 1.25 });
    for (keys, expected) in [
        (r#""type": "refractive", "refractionIndex": 1, "film": {"thickness": 312.5, "refractionIndex": 1.25}"#, soap),
        (
            r#""type": "refractive", "refractionIndex": 1.5, "roughness": 0.2, "dispersion": 60,
               "film": {"thickness": 312.5, "refractionIndex": 1.25}"#,
            soap,
        ),
        (r#""type": "conductor", "metal": "Al", "film": {"thickness": 312.5, "refractionIndex": 1.25}"#, soap),
        (r#""type": "cook-torrance", "metal": "Al", "film": {"thickness": 312.5, "refractionIndex": 1.25}"#, soap),
        (r#""type": "conductor", "metal": "Al", "film": {"thickness": 0, "refractionIndex": 1.25}"#, None),
        (r#""type": "conductor", "metal": "Al""#, None),
    ] {
        let scene = native(&format!("\"materials\": [{}]", film(keys)));
        assert_eq!(scene.materials[0].film, expected, "{keys}");
    }
    let glass = r#""type": "refractive", "refractionIndex": 1.5, "film": "#;
    let textured = r#""type": "conductor", "reflectance": [1, 1, 1], "textures": {"reflectance": "t"}, "film": "#;
    for (of, keys, path, message) in [
        (glass, r#"{"thickness": -1, "refractionIndex": 1.3}"#, "materials[0].film.thickness", "-1 is out of range"),
        (
            glass,
            r#"{"thickness": 10001, "refractionIndex": 1.3}"#,
            "materials[0].film.thickness",
            "10001 is out of range",
        ),
        (glass, r#"{"thickness": 1e39, "refractionIndex": 1.3}"#, "materials[0].film.thickness", "inf is out of range"),
        (
            glass,
            r#"{"thickness": 100, "refractionIndex": 0}"#,
            "materials[0].film.refractionIndex",
            "0 is out of range",
        ),
        (
            glass,
            r#"{"thickness": 0, "refractionIndex": -2}"#,
            "materials[0].film.refractionIndex",
            "-2 is out of range",
        ),
        (
            glass,
            r#"{"thickness": 100, "refractionIndex": 101}"#,
            "materials[0].film.refractionIndex",
            "101 is out of range",
        ),
        (glass, r#"{"thickness": 100}"#, "materials[0].film", "missing key `refractionIndex`"),
        (glass, r#"{"thickness": "thin", "refractionIndex": 1.3}"#, "materials[0].film", "expected"),
        (glass, r#"{"thickness": NaN, "refractionIndex": 1.3}"#, "", "expected value"),
        (
            glass,
            r#"{"thickness": 100, "refractionIndex": 1.3, "color": 1}"#,
            "materials[0].film",
            "unknown key `color`",
        ),
        (glass, "300", "materials[0].film", "expected"),
        (
            textured,
            r#"{"thickness": 100, "refractionIndex": 1.3}"#,
            "materials[0].textures.reflectance",
            "a metal with a thin film has the same reflectance everywhere",
        ),
        (
            r#""type": "diffuse", "color": [1, 1, 1], "film": "#,
            r#"{"thickness": 100, "refractionIndex": 1.3}"#,
            "materials[0]",
            "unknown key `film`",
        ),
        (
            r#""type": "principled", "film": "#,
            r#"{"thickness": 100, "refractionIndex": 1.3}"#,
            "materials[0]",
            "unknown key `film`",
        ),
        (
            r#""type": "thin-refractive", "refractionIndex": 1.5, "film": "#,
            r#"{"thickness": 100, "refractionIndex": 1.3}"#,
            "materials[0]",
            "unknown key `film`",
        ),
    ] {
        let textures = r#""textures": [{"name": "t", "type": "checker"}]"#;
        let text =
            format!(r#"{{"etendue": 1, "camera": {{}}, {textures}, "materials": [{}]}}"#, film(&format!("{of}{keys}")));
        let error = etendue::desc::parse(&text, "".as_ref(), None).expect_err(keys).to_string();
        assert!(error.contains(path) && error.contains(message), "{of}{keys}: {error}");
    }
    // In calls, numbers may be what no file holds.
    let mut scene = native("\"materials\": []");
    for thickness in [f32::NAN, f32::INFINITY] {
        let film = Some(ThinFilmDesc { thickness, ior: 1.3 });
        let bsdf = BsdfDesc::Dielectric { ior: 1.5, exterior_ior: 1.0 };
        let error = scene.add_material_desc(MaterialDesc { bsdf, film, ..MaterialDesc::default() }).unwrap_err();
        assert!(error.to_string().contains("is out of range, expected a number in [0, 10000]"), "{error}");
    }
    let film = Some(ThinFilmDesc { thickness: 100.0, ior: 1.3 });
    let bsdf = BsdfDesc::Mirror { reflectance: Rgb::ONE };
    let error = scene.add_material_desc(MaterialDesc { bsdf, film, ..MaterialDesc::default() }).unwrap_err();
    assert!(error.to_string().contains("only a refractive material or a conductor has a thin film"), "{error}");
}

#[test]
fn the_inside_of_a_refractive_material_is_a_medium() {
    let medium = |absorption, priority| Some(MediumDesc { absorption, priority });
    let cases = [
        ("", None),
        (r#", "priority": 0"#, medium(Rgb::ZERO, 0)),
        (r#", "priority": 7.0"#, medium(Rgb::ZERO, 7)),
        (r#", "absorption": [0, 0.5, 2], "priority": 4294967295"#, medium(Rgb::new(0.0, 0.5, 2.0), u32::MAX)),
        (
            r#", "transmittance": [1, 0.5, 0.25], "transmittanceDistance": 2"#,
            medium(Rgb::new(0.0, 0.5 * std::f32::consts::LN_2, std::f32::consts::LN_2), 0),
        ),
    ];
    let material = |keys: &str| format!(r#"{{"name": "m", "type": "refractive", "refractionIndex": 1.5{keys}}}"#);
    for (keys, expected) in cases {
        let scene = native(&format!("\"materials\": [{}]", material(keys)));
        assert_eq!(scene.materials[0].medium, expected, "{keys}");
    }
    let refused = [
        (r#", "absorption": [0, -1, 0]"#, "materials[0].absorption[1]", "-1 is negative"),
        (r#", "absorption": [0, 0, 1e39]"#, "materials[0].absorption[2]", "beyond single precision"),
        (r#", "priority": 4294967296"#, "materials[0].priority", "out of range"),
        (r#", "transmittance": [1, 1, 1]"#, "materials[0]", "missing key `transmittanceDistance`"),
        (
            r#", "transmittanceDistance": 1"#,
            "materials[0].transmittanceDistance",
            "only a material with `transmittance`",
        ),
        (
            r#", "transmittance": [1, 0, 1], "transmittanceDistance": 1"#,
            "materials[0].transmittance[1]",
            "0 is out of range",
        ),
        (
            r#", "transmittance": [1, 1, 1.5], "transmittanceDistance": 1"#,
            "materials[0].transmittance[2]",
            "1.5 is out of",
        ),
        (
            r#", "transmittance": [1, 1, 1], "transmittanceDistance": 0"#,
            "materials[0].transmittanceDistance",
            "not above 0",
        ),
        (
            r#", "transmittance": [0.5, 1, 1], "transmittanceDistance": 1e-38, "absorption": [0, 0, 0]"#,
            "materials[0].transmittance",
            "given twice",
        ),
        (
            r#", "transmittance": [1e-30, 1, 1], "transmittanceDistance": 1e-37"#,
            "materials[0].transmittanceDistance",
            "too short",
        ),
    ];
    for (keys, path, why) in refused {
        let text = format!(r#"{{"etendue": 1, "camera": {{}}, "materials": [{}]}}"#, material(keys));
        let error = etendue::desc::parse(&text, "".as_ref(), None).expect_err(keys);
        let message = error.to_string();
        assert!(message.contains(&format!("{path}: ")) && message.contains(why), "{keys}: {message}");
    }
    // No other model has an inside.
    let text = r#"{"etendue": 1, "camera": {}, "materials": [{"name": "m", "type": "reflective", "priority": 1}]}"#;
    let message = etendue::desc::parse(text, "".as_ref(), None).expect_err("a mirror").to_string();
    assert!(message.contains("priority"), "{message}");
}

#[test]
fn lights_are_point_lights_or_black_surfaces_that_emit() {
    let scene = native(
        r#""lights": [
            {"type": "point", "origin": [1, 2, 3], "color": [1, 0.5, 0], "intensity": 4},
            {"type": "point", "origin": [1, 2, 3], "color": [1, 0.5, 0]},
            {"type": "area", "vertex-1": [0, 0, 0], "vertex-2": [1, 0, 0], "vertex-3": [0, 1, 0], "color": [3, 2, 1],
             "intensity": 2},
            {"type": "area", "vertex-1": [0, 0, 0], "vertex-2": [1, 0, 0], "vertex-3": [0, 1, 0], "color": [0, 0, 0]}
        ]"#,
    );
    assert_eq!(scene.lights.len(), 2);
    assert_eq!(scene.lights[0].position, DVec3::new(1.0, 2.0, 3.0));
    assert_eq!(
        (scene.lights[0].intensity, scene.lights[1].intensity),
        (Rgb::new(4.0, 2.0, 0.0), Rgb::new(1.0, 0.5, 0.0))
    );
    let [area, dark] = [0, 1].map(|number| &scene.surfaces[number]);
    assert_eq!(scene.surfaces.len(), 2);
    assert_eq!((area.path.as_str(), area.emission, dark.emission), ("lights[2]", Some(Rgb::new(6.0, 4.0, 2.0)), None));
    assert_eq!(area.shape, ShapeDesc::Triangle([DVec3::ZERO, DVec3::X, DVec3::Y]));
    assert_eq!((area.material, dark.material), (None, None));
    assert_eq!(scene.materials.len(), 1, "none but that of the file");
}

#[test]
fn simple_shapes_are_read() {
    let sphere = surface(r#"{"geometry": "sphere", "origin": [1, 2, 3], "radius": 0.5, "material": "white"}"#);
    assert_eq!(sphere.shape, ShapeDesc::Sphere { centre: DVec3::new(1.0, 2.0, 3.0), radius: 0.5 });
    assert_eq!((sphere.path.as_str(), sphere.material, sphere.emission), ("surfaces[0]", Some(0), None));
    assert_eq!(sphere.transform, DAffine3::IDENTITY);
    let triangle = surface(
        r#"{"geometry": "triangle", "vertex-1": [0, 0, 0], "vertex-2": [1, 0, 0], "vertex-3": [0, 1, 0],
            "material": "white", "emission": [1, 2, 3]}"#,
    );
    assert_eq!(triangle.shape, ShapeDesc::Triangle([DVec3::ZERO, DVec3::X, DVec3::Y]));
    assert_eq!(triangle.emission, Some(Rgb::new(1.0, 2.0, 3.0)));
    let quad = surface(
        r#"{"geometry": "quad", "vertex-1": [0, 0, 0], "vertex-2": [1, 0, 0], "vertex-3": [1, 1, 0],
          "vertex-4": [0, 1, 0],
            "material": "white"}"#,
    );
    assert_eq!(quad.shape, ShapeDesc::Quad([DVec3::ZERO, DVec3::X, DVec3::new(1.0, 1.0, 0.0), DVec3::Y]));
    let disk =
        surface(r#"{"geometry": "disk", "origin": [1, 0, 0], "normal": [0, 0, -5], "radius": 2, "material": "white"}"#);
    assert_eq!(disk.shape, ShapeDesc::Disk { centre: DVec3::X, normal: DVec3::NEG_Z, radius: 2.0 });
}

#[test]
fn surfaces_have_names_or_none() {
    let ball = |name: &str| {
        format!(r#"{{"geometry": "sphere", "origin": [0, 0, 0], "radius": 1, "material": "white"{name}}}"#)
    };
    let texts = [r#", "name": "ball""#, "", r#", "name": null"#, r#", "name": "ball""#].map(ball);
    let mut scene = native(&format!("\"surfaces\": [{}]", texts.join(", ")));
    let names = |scene: &desc::SceneDesc| scene.surfaces.iter().map(|it| it.name.clone()).collect::<Vec<_>>();
    assert_eq!(names(&scene), ["ball", "", "", "ball"], "one object may have several surfaces");
    let called: Vec<_> = scene.surfaces.iter().map(desc::SurfaceDesc::object).collect();
    assert_eq!(called, ["ball", "surfaces[1]", "surfaces[2]", "ball"]);
    let before = scene.fingerprint().unwrap();
    scene.set_surface_name(0, "").unwrap();
    scene.set_surface_name(1, "other").unwrap();
    assert_eq!(names(&scene), ["", "other", "", "ball"]);
    assert_eq!(
        scene.fingerprint().unwrap(),
        before,
        "a checkpoint of the scene goes on whatever its surfaces are called"
    );
    let text = format!("{{\"etendue\": 1, \"camera\": {{}}, \"surfaces\": [{}]}}", ball(r#", "name": """#));
    let error = desc::parse(&text, Path::new("."), None).unwrap_err();
    assert_eq!(error.location().json_path, "surfaces[0].name");
}

#[test]
fn groups_are_placed_as_surfaces_of_their_own() {
    let ball = |x: i32| format!(r#"{{"geometry": "sphere", "origin": [{x}, 0, 0], "radius": 1, "material": "white"}}"#);
    let place = |group: &str, more: &str| format!(r#"{{"geometry": "group", "group": "{group}"{more}}}"#);
    let [one, two] = [ball(0), ball(3)];
    let pair = format!(
        r#"{{"name": "pair", "surfaces": [{one}, {{"name": "disk", "geometry": "disk",
        "origin": [0, 0, 0], "normal": [0, 0, 1], "radius": 2, "material": "white", "transform": {{"translate": [0, 1, 0]}}}}]}}"#
    );
    let nested =
        format!(r#"{{"name": "more", "surfaces": [{}, {two}]}}"#, place("pair", r#", "transform": {"scale": 2}"#));
    let scene = native(&format!(
        r#""groups": [{pair}, {nested}], "surfaces": [{one}, {}, {}, {}]"#,
        place("pair", r#", "transform": {"translate": [10, 0, 0]}, "name": "both""#),
        place("more", r#", "transform": {"rotate": [0, 0, 90]}"#),
        place("pair", r#", "motion": [{"time": 0}, {"time": 1, "translate": [1, 0, 0]}]"#),
    ));
    let paths: Vec<&str> = scene.surfaces.iter().map(|it| it.path.as_str()).collect();
    let expected = [
        "[0]",
        "[1].surfaces[0]",
        "[1].surfaces[1]",
        "[2].surfaces[0]",
        "[2].surfaces[1]",
        "[2].surfaces[2]",
        "[3].surfaces[0]",
        "[3].surfaces[1]",
    ];
    assert_eq!(paths, expected.map(|path| format!("surfaces{path}")));
    assert_eq!(scene.find_surface("surfaces[2].surfaces[1]"), Some(4));
    let names: Vec<&str> = scene.surfaces.iter().map(|it| it.name.as_str()).collect();
    assert_eq!(names, ["", "both", "both", "", "disk", "", "", "disk"]);
    let at = |number: usize| scene.surfaces[number].to_world().transform_point3(DVec3::ZERO);
    for (number, point) in [(1, [10.0, 0.0]), (2, [10.0, 1.0]), (3, [0.0, 0.0]), (4, [-2.0, 0.0]), (5, [0.0, 0.0])] {
        assert!(near(at(number), DVec3::new(point[0], point[1], 0.0)), "{number}: {}", at(number));
    }
    assert_eq!(scene.motion.surfaces.keys().copied().collect::<Vec<_>>(), [6, 7]);
    let groups: Vec<_> = scene.placements.iter().map(|it| (it.group, it.surfaces.clone(), it.path.as_str())).collect();
    assert_eq!(groups, [(0, 1..3, "surfaces[1]"), (1, 3..6, "surfaces[2]"), (0, 6..8, "surfaces[3]")]);
    assert_eq!(scene.find_group("more"), Some(1));
    assert_eq!(scene.groups[1].members.len(), 3);
}

/// Surfaces that were taken into a group leave no trace among the users of meshes.
#[test]
fn meshes_that_are_used_beside_groups_stay() {
    let sheet = |mesh: &str| format!(r#"{{"geometry": "mesh", "mesh": "{mesh}", "material": "white"}}"#);
    let mesh = |name: &str| {
        format!(r#"{{"name": "{name}", "positions": [[0, 0, 0], [1, 0, 0], [0, 1, 0]], "triangles": [[0, 1, 2]]}}"#)
    };
    let mut scene = native(&format!(
        r#""meshes": [{}, {}, {}], "groups": [{{"name": "g", "surfaces": [{}]}}], "surfaces": [{}]"#,
        mesh("a"),
        mesh("b"),
        mesh("c"),
        sheet("a"),
        sheet("b"),
    ));
    for (mesh, user) in [(0, "groups[0]"), (1, "surfaces[0]")] {
        let error = scene.remove_mesh(mesh).unwrap_err();
        assert!(error.message().starts_with(user), "{error}");
    }
    scene.remove_mesh(2).unwrap();
    scene.remove_group(0).unwrap();
    scene.remove_mesh(0).unwrap();
}

/// A line per level doubles the number of surfaces.
#[test]
fn groups_of_groups_are_bounded() {
    let level = |i: usize| {
        let place = format!(r#"{{"geometry": "group", "group": "{}"}}"#, i - 1);
        format!(r#"{{"name": "{i}", "surfaces": [{place}, {place}]}}"#)
    };
    let first =
        r#"{"name": "0", "surfaces": [{"geometry": "sphere", "origin": [0, 0, 0], "radius": 1, "material": "white"}]}"#;
    let levels: Vec<String> = (1..64).map(level).collect();
    let text = format!(
        r#"{{"etendue": 1, "camera": {{}}, "materials": [{{"name": "white", "type": "black"}}], "groups": [{first}, {}]}}"#,
        levels.join(", ")
    );
    let error = desc::parse(&text, Path::new("."), None).unwrap_err();
    assert_eq!(error.kind(), etendue::ErrorKind::Unsupported);
    assert_eq!(error.location().json_path, "groups[22].surfaces[0]");
}

#[test]
fn a_surface_that_only_emits_needs_no_material() {
    let scene = native(
        r#""surfaces": [{"geometry": "sphere", "origin": [0, 0, 0], "radius": 1, "emission": [1, 2, 3]},
                        {"geometry": "sphere", "origin": [0, 0, 0], "radius": 1, "material": "white",
                        "emission": [0, 0, 0]}]"#,
    );
    assert_eq!((scene.surfaces[0].material, scene.surfaces[1].material), (None, Some(0)));
    assert_eq!(scene.surfaces[0].emission, Some(Rgb::new(1.0, 2.0, 3.0)));
    assert_eq!(scene.surfaces[1].emission, None, "no light is no emission");
}

#[test]
fn lamps_emit_on_one_side_or_both() {
    let disk = r#"{"geometry": "disk", "origin": [0, 0, 0], "normal": [0, 1, 0], "radius": 1, "emission": [1, 1, 1]"#;
    assert!(surface(&format!(r#"{disk}, "emits": "both"}}"#)).emits_both);
    assert!(!surface(&format!(r#"{disk}, "emits": "front"}}"#)).emits_both);
    assert!(!surface(&format!("{disk}}}")).emits_both);
    // Also by its material.
    let lit = r#""materials": [{"name": "lit", "type": "black", "emission": [1, 1, 1]}], "surfaces":
        [{"geometry": "cylinder", "base": [0, 0, 0], "axis": [0, 1, 0], "radius": 1, "height": 1, "material": "lit", "emits": "both"}]"#;
    assert!(native(lit).surfaces[0].emits_both);
    for (surface, expected) in [
        (
            r#"{"geometry": "disk", "origin": [0, 0, 0], "normal": [0, 1, 0], "radius": 1, "material": "white", "emits": "both"}"#,
            "surfaces[0].emits: 'both' of a surface that emits no light, expected one with an emission",
        ),
        (
            r#"{"geometry": "sphere", "origin": [0, 0, 0], "radius": 1, "emission": [1, 1, 1], "emits": "both"}"#,
            "surfaces[0].emits: 'both' of a sphere, which is closed: no light would leave its inside; expected 'front', or another shape",
        ),
        (&format!(r#"{disk}, "emits": "back"}}"#), "surfaces[0].emits: "),
        (&format!(r#"{disk}, "emits": 2}}"#), "surfaces[0].emits: "),
    ] {
        let text = format!(
            r#"{{"etendue": 1, "camera": {{}}, "materials": [{{"name": "white", "type": "diffuse", "color": [1, 1, 1]}}],
                "surfaces": [{surface}]}}"#
        );
        let said = desc::parse(&text, std::path::Path::new("."), None).unwrap_err().to_string();
        assert!(said.contains(expected), "{said}\nexpected {expected}");
    }
}

#[test]
fn flatness_of_quads_does_not_depend_on_their_size_or_place() {
    for (size, shift) in [(1e-20, 0.0), (1.0, 0.0), (1.0, 1e6), (1e15, 0.0)] {
        for (off, flat) in [(1e-5, true), (1e-3, false)] {
            let v = |x: f64, y: f64, z: f64| format!("[{}, {}, {}]", shift + size * x, shift + size * y, size * z);
            let text = format!(
                "{{\"etendue\": 1, \"camera\": {{}}, \"surfaces\": [{{\"geometry\": \"quad\", \"emission\": [1, 1, 1],
                 \"vertex-1\": {}, \"vertex-2\": {}, \"vertex-3\": {}, \"vertex-4\": {}}}]}}",
                v(0.0, 0.0, 0.0),
                v(1.0, 0.0, 0.0),
                v(1.0, 1.0, 0.0),
                v(0.0, 1.0, off)
            );
            assert_eq!(desc::parse(&text, Path::new(""), None).is_ok(), flat, "size {size}, off by {off}");
        }
    }
}

#[test]
fn transforms_apply_in_their_documented_order() {
    let place = |text: &str| {
        surface(&format!(
            "{{\"geometry\": \"sphere\", \"origin\": [0, 0, 0], \"radius\": 1, \"material\": \"white\", \
             \"transform\": {text}}}"
        ))
        .transform
    };
    // Scale, then a quarter turn about z, then the translation.
    let one = place(r#"{"translate": [10, 0, 0], "rotate": [0, 0, 90], "scale": [2, 3, 4]}"#);
    assert!(near(one.transform_point3(DVec3::ONE), DVec3::new(10.0 - 3.0, 2.0, 4.0)));
    // About x first, then y, then z: z goes to -y, stays, and goes to x.
    let turned = place(r#"{"rotate": [90, 0, 90]}"#);
    assert!(near(turned.transform_point3(DVec3::Z), DVec3::X));
    // Row by row, translation in the last column.
    let matrix = place(r#"{"matrix": [0, -1, 0, 5, 1, 0, 0, 6, 0, 0, 1, 7, 0, 0, 0, 1]}"#);
    assert!(near(matrix.transform_point3(DVec3::X), DVec3::new(5.0, 7.0, 7.0)));
    // The first of an array is applied first.
    let moved_then_scaled = place(r#"[{"translate": [1, 0, 0]}, {"scale": 2}]"#);
    assert!(near(moved_then_scaled.transform_point3(DVec3::ZERO), 2.0 * DVec3::X));
    assert_eq!(place("[]"), DAffine3::IDENTITY);
    // A mirror image and a very flat object are no errors.
    place(r#"{"scale": [-1, 1, 1]}"#);
    place(r#"{"scale": [1e-9, 1, 1e9]}"#);
}

#[test]
fn named_quadrics_lie_where_their_keys_say() {
    let at = |shape: &ShapeDesc, p: DVec3| -> f64 {
        let ShapeDesc::Quadric { coefficients: [a, b, c, d, e, f, g, h, i, j], clip } = shape else {
            panic!("{shape:?} is no quadric")
        };
        assert!(p.cmpge(clip.min - 1e-9).all() && p.cmple(clip.max + 1e-9).all(), "{p} is cut from {shape:?}");
        let DVec3 { x, y, z } = p;
        a * x * x + b * y * y + c * z * z + 2.0 * (d * x * y + e * y * z + f * x * z + g * x + h * y + i * z) + j
    };
    let s = std::f64::consts::FRAC_1_SQRT_2;
    // Each lies along (1, 1, 0) from (1, 0, 0), and `p` is a point on it in the world.
    for (text, p) in [
        (r#""cylinder", "base": [1, 0, 0], "axis": [3, 3, 0]"#, DVec3::new(1.0 + s, s, 2.0)),
        (r#""cone", "base": [1, 0, 0], "axis": [3, 3, 0]"#, DVec3::new(1.0, 0.0, 2.0)),
        (r#""cone", "base": [1, 0, 0], "axis": [3, 3, 0]"#, DVec3::new(1.0 + 2.0 * s, 2.0 * s, 1.0)),
        (r#""cone", "base": [1, 0, 0], "axis": [3, 3, 0]"#, DVec3::new(1.0 + 4.0 * s, 4.0 * s, 0.0)),
        (r#""paraboloid", "apex": [1, 0, 0], "axis": [3, 3, 0]"#, DVec3::new(1.0 + 4.0 * s, 4.0 * s, -2.0)),
        (r#""paraboloid", "apex": [1, 0, 0], "axis": [3, 3, 0]"#, DVec3::new(1.0 + s, s, 1.0)),
    ] {
        let it = surface(&format!("{{\"geometry\": {text}, \"radius\": 2, \"height\": 4, \"material\": \"white\"}}"));
        let value = at(&it.shape, it.to_world().inverse().transform_point3(p));
        assert!(value.abs() < 1e-9, "{text}: {value} at {p}");
    }
    let egg = surface(r#"{"geometry": "ellipsoid", "origin": [1, 2, 3], "radii": [1, 2, 4], "material": "white"}"#);
    for p in [DVec3::new(2.0, 2.0, 3.0), DVec3::new(1.0, 0.0, 3.0), DVec3::new(1.0, 2.0, 7.0)] {
        assert!(at(&egg.shape, egg.to_world().inverse().transform_point3(p)).abs() < 1e-9);
    }
    let open = surface(
        r#"{"geometry": "quadric", "coefficients": [1, 2, 3, 4, 5, 6, 7, 8, 9, 10],
            "clip": {"min": [-1, -2, -3], "max": [1, 2, 3]}, "material": "white", "transform": {"translate": [1, 0,
            0]}}"#,
    );
    let ShapeDesc::Quadric { coefficients, clip } = open.shape else { panic!("a quadric") };
    assert_eq!(coefficients, [1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0, 9.0, 10.0]);
    assert_eq!((clip.min, clip.max), (DVec3::new(-1.0, -2.0, -3.0), DVec3::new(1.0, 2.0, 3.0)));
    assert_eq!(open.to_world(), DAffine3::from_translation(DVec3::X));
    // Without a box, an ellipsoid brings its own.
    let ball =
        surface(r#"{"geometry": "quadric", "coefficients": [1, 1, 1, 0, 0, 0, -1, 0, 0, -3], "material": "white"}"#);
    let ShapeDesc::Quadric { clip, .. } = ball.shape else { panic!("a quadric") };
    assert!((clip.min - DVec3::new(-1.0, -2.0, -2.0)).abs().max_element() < 0.01);
    assert!((clip.max - DVec3::new(3.0, 2.0, 2.0)).abs().max_element() < 0.01);
}

#[test]
fn meshes_come_from_files_by_name_and_in_place() {
    let scene = native(
        r#""meshes": [{"name": "p", "file": "pyramid.obj"},
                      {"name": "t", "positions": [[0, 0, 0], [1, 0, 0], [0, 1, 0]], "triangles": [[0, 1, 2], [2, 1,
                      0]]}],
           "surfaces": [
            {"geometry": "mesh", "mesh": "p", "material": "white"},
            {"geometry": "mesh", "file": "./pyramid.obj", "material": "white", "shading": "smooth"},
            {"geometry": "mesh", "mesh": "t", "material": "white", "shading": "flat"},
            {"geometry": "mesh", "positions": [[0, 0, 0]], "triangles": [[0, 0, 0]], "normals": [[0, 0, 1]],
            "uvs": [[0.5, 1]],
             "emission": [1, 1, 1], "origin": [1, 0, 0], "scale": 2, "rotate": [0, 0, 1.5707963267948966],
             "transform": {"scale": 10}}]"#,
    );
    let used: Vec<_> = scene.surfaces.iter().map(|surface| surface.shape).collect();
    let mesh = |mesh, smooth| ShapeDesc::Mesh { mesh, smooth };
    assert_eq!(used, [mesh(0, false), mesh(0, true), mesh(1, false), mesh(2, false)], "a file is read once");
    assert_eq!(scene.meshes.len(), 3);
    assert_eq!(scene.meshes[1].triangles, [[0, 1, 2], [2, 1, 0]]);
    assert_eq!((scene.meshes[1].name.as_str(), scene.meshes[1].path.as_str()), ("t", "meshes[1]"));
    assert_eq!((&scene.meshes[2].normals, &scene.meshes[2].uvs), (&vec![[0.0, 0.0, 1.0]], &vec![[0.5, 1.0]]));
    // Scaled, turned about z, moved; then ten times as large.
    assert!(near(scene.surfaces[3].to_world().transform_point3(DVec3::X), DVec3::new(10.0, 20.0, 0.0)));
}

#[test]
fn colours_of_vertices_are_one_for_each_and_in_range() {
    let scene = |colors: &str| {
        format!(
            r#"{{"etendue": 1, "camera": {{}}, "surfaces": [{{"geometry": "mesh", "emission": [1, 1, 1],
            "positions": [[0, 0, 0], [1, 0, 0], [0, 1, 0]], "triangles": [[0, 1, 2]], "colors": {colors}}}]}}"#
        )
    };
    let read = |colors: &str| desc::parse(&scene(colors), Path::new(""), None);
    let mesh = &read("[[0, 0.5, 3], [1, 1, 1, 0.25], [0, 0, 0]]").unwrap().meshes[0];
    assert_eq!(mesh.colors, [[0.0, 0.5, 3.0, 1.0], [1.0, 1.0, 1.0, 0.25], [0.0, 0.0, 0.0, 1.0]]);
    for (colors, expected) in [
        ("[[1, 1, 1]]", "surfaces[0].colors: 1 colors for 3 positions, expected one each"),
        ("[[1, 1, 1], [0, 0], [0, 0, 0]]", "not a colour of a vertex, expected three or four numbers"),
        ("[[1, 1, 1], [0, 0, -1], [0, 0, 0]]", "surfaces[0].colors[1][2]: -1 is out of range, expected 0 or more"),
        ("[[1, 1, 1], [0, 0, 0, 1.5], [0, 0, 0]]", "colors[1][3]: 1.5 is out of range, expected an opacity in [0, 1]"),
        ("[[1, 1, 1], [0, 0, 1e39], [0, 0, 0]]", "surfaces[0].colors[1][2]: 1e39 is beyond single precision"),
    ] {
        let error = read(colors).unwrap_err().to_string();
        assert!(error.contains(expected), "{error}, not {expected}");
    }
    // What reads them is refused where it cannot.
    let material = |key: &str, texture: &str| {
        let scene = format!(
            r#"{{"etendue": 1, "camera": {{}}, "textures": [{texture}], "materials": [{{"name": "m", "type": "diffuse",
            "color": [1, 1, 1], "emission": [1, 1, 1], "textures": {{"{key}": "t"}}}}]}}"#
        );
        desc::parse(&scene, Path::new(""), None).map(|_| ()).map_err(|error| error.to_string())
    };
    let (white, times) =
        (r#"{"name": "t", "type": "vertex-colors"}"#, r#"{"name": "t", "type": "grid", "vertexColors": true}"#);
    for texture in [white, times] {
        assert_eq!(material("color", texture), Ok(()));
        for key in ["emission", "normal", "bump"] {
            let error = material(key, texture).unwrap_err();
            assert!(
                error.contains(&format!("textures.{key}: `{key}` cannot be multiplied by colours of vertices")),
                "{error}"
            );
        }
    }
}

/// Temperatures and films that textures vary need something to vary, and of temperatures an image.
#[test]
fn textures_of_temperatures_and_films_need_them() {
    let read = |texture: &str, material: &str| {
        let scene = format!(
            r#"{{"etendue": 1, "camera": {{}}, "textures": [{texture}], "materials": [{{"name": "m", {material}}}]}}"#
        );
        desc::parse(&scene, &Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes"), None)
            .map(|_| ())
            .map_err(|error| error.to_string())
    };
    let image = r#"{"name": "t", "type": "image", "file": "textures/heat.png"}"#;
    let (pattern, colours) = (r#"{"name": "t", "type": "grid"}"#, r#"{"name": "t", "type": "vertex-colors"}"#);
    let glows = |emission: &str, textures: &str| {
        format!(r#""type": "diffuse", "color": [0, 0, 0], {emission} "textures": {{{textures}}}"#)
    };
    let black_body = r#""spectra": {"emission": {"blackBody": 2000}},"#;
    let soap = r#""type": "refractive", "refractionIndex": 1, "film": {"thickness": 300, "refractionIndex": 1.33},
        "textures": {"filmThickness": "t"}"#;
    let bare = r#""type": "refractive", "refractionIndex": 1.5, "textures": {"filmThickness": "t"}"#;
    let temperature = r#""temperature": "t""#;
    assert_eq!(read(image, &glows(black_body, temperature)), Ok(()));
    assert_eq!(read(pattern, soap), Ok(()));
    let no_body = "materials[0].textures.temperature: the material does not emit as a black body";
    for (texture, material, expected) in [
        (image, glows("", temperature), no_body),
        (image, glows(r#""emission": [1, 1, 1],"#, temperature), no_body),
        (image, glows(r#""spectra": {"emission": "A"},"#, temperature), no_body),
        (
            image,
            glows(black_body, r#""emission": "t", "temperature": "t""#),
            "materials[0].textures.temperature: a texture varies the emission already, expected one of both",
        ),
        (pattern, glows(black_body, temperature), "materials[0].textures.temperature: the texture is no image"),
        (colours, glows(black_body, temperature), "materials[0].textures.temperature: the texture is no image"),
        (pattern, bare.to_owned(), "materials[0].textures.filmThickness: the material has no film"),
    ] {
        let error = read(texture, &material).unwrap_err();
        assert!(error.contains(expected), "{error}, not {expected}");
    }
}

#[test]
fn tangents_are_one_for_each_vertex() {
    let read = |tangents: &str| {
        let scene = format!(
            r#"{{"etendue": 1, "camera": {{}}, "surfaces": [{{"geometry": "mesh", "emission": [1, 1, 1],
            "positions": [[0, 0, 0], [1, 0, 0], [0, 1, 0]], "triangles": [[0, 1, 2]], "tangents": {tangents}}}]}}"#
        );
        desc::parse(&scene, Path::new(""), None)
    };
    let mesh = &read("[[0, 0.5, 3], [1, 1, 1], [0, 0, 0]]").unwrap().meshes[0];
    assert_eq!(mesh.tangents, [[0.0, 0.5, 3.0], [1.0; 3], [0.0; 3]]);
    for (tangents, expected) in [
        ("[[1, 1, 1]]", "surfaces[0].tangents: 1 tangents for 3 positions, expected one each"),
        ("[[1, 1, 1], [0, 0, 1e39], [0, 0, 0]]", "surfaces[0].tangents[1][2]: 1e39 is beyond single precision"),
    ] {
        let error = read(tangents).unwrap_err().to_string();
        assert!(error.contains(expected), "{error}, not {expected}");
    }
}

#[test]
fn sets_of_texture_coordinates_are_counted_and_checked() {
    let scene = |mesh: &str, texture: &str| {
        format!(
            r#"{{"etendue": 1, "camera": {{}}, "textures": [{{"name": "t", {texture}}}], "surfaces": [{{"geometry": "mesh",
            "emission": [1, 1, 1], "positions": [[0, 0, 0], [1, 0, 0], [0, 1, 0]], "triangles": [[0, 1, 2]], {mesh}}}]}}"#
        )
    };
    let read = |mesh: &str, texture: &str| desc::parse(&scene(mesh, texture), Path::new(""), None);
    let checker = r#""type": "checker""#;
    let it = read(r#""furtherUvs": [[], [[0, 1], [2, 3], [4, 5]]]"#, r#""type": "checker", "uvSet": 2"#).unwrap();
    assert_eq!(it.meshes[0].further_uvs, [vec![], vec![[0.0, 1.0], [2.0, 3.0], [4.0, 5.0]]]);
    assert_eq!(it.textures[0].mapping.uv_set(), 2);
    for (mesh, texture, expected) in [
        (r#""furtherUvs": [[[0, 1]]]"#, checker, "surfaces[0].furtherUvs[0]: 1 uvs for 3 positions, expected one each"),
        (
            r#""furtherUvs": [[], [], [], [], [], [], [], []]"#,
            checker,
            "furtherUvs: 8 further sets, expected 7 at most",
        ),
        (r#""furtherUvs": [[[0, 1], [0, 1e39], [0, 0]]]"#, checker, "surfaces[0].furtherUvs[0][1][1]: 1e39 is beyond"),
        (r#""uvs": []"#, r#""type": "checker", "uvSet": 8"#, "textures[0].uvSet: 8 is out of range"),
        (r#""uvs": []"#, r#""type": "checker", "uvSet": 1.5"#, "textures[0].uvSet"),
        (
            r#""uvs": []"#,
            r#""type": "checker", "coordinates": "space", "uvSet": 0"#,
            "only the coordinates 'uv' have sets",
        ),
        (
            r#""uvs": []"#,
            r#""type": "checker", "coordinates": "box", "uvSet": 1"#,
            "only the coordinates 'uv' have sets",
        ),
    ] {
        let error = read(mesh, texture).unwrap_err().to_string();
        assert!(error.contains(expected), "{error}, not {expected}");
    }
}

#[test]
fn polygons_groups_negative_indices_and_continued_lines_of_an_obj_are_read() {
    let scene = native(r#""surfaces": [{"geometry": "mesh", "file": "pyramid.obj", "material": "white"}]"#);
    let mesh = &scene.meshes[0];
    assert!(mesh.name.ends_with("pyramid.obj"));
    assert_eq!((mesh.triangles.len(), mesh.normals.len(), mesh.uvs.len()), (6, 0, mesh.positions.len()));
    // A closed surface with its normals outwards: its volume by the divergence theorem is that of the pyramid.
    let volume: f64 = mesh
        .triangles
        .iter()
        .map(|triangle| triangle.map(|index| mesh.positions[index as usize]))
        .map(|[a, b, c]| a.dot(b.cross(c)) / 6.0)
        .sum();
    assert!((volume - 4.0 * 2.0 / 3.0).abs() < 1e-12, "{volume}");
    assert!(scene.warnings.is_empty(), "{:?}", scene.warnings);
}

#[test]
fn parameter_files_override_the_render_block() {
    let mut scene = native(r#""render": {"seed": 5, "samples": 3, "sampler": "sobol", "maxDepth": 4}"#);
    desc::apply_params("{}", None, &mut scene).unwrap();
    assert_eq!((scene.render.samples, scene.render.max_depth, scene.warnings.len()), (3, Some(4), 0), "nothing given");
    let text = r#"{"resolution": [512, 256], "supersamples": [7, "grid"], "maxRayDepth": 9, "shadowRays": 3, "roulette": "file",
        "scalingFactor": [2, 2], "interpolation": "nearest", "recordStatistics": 1, "nonsense": {"a": []}}"#;
    desc::apply_params(text, None, &mut scene).unwrap();
    let expected = RenderDesc {
        resolution: [512, 256],
        samples: 49,
        sampler: SamplerDesc::Grid,
        max_depth: Some(9),
        shadow_rays: 3,
        roulette: RouletteDesc::File,
        seed: 5,
        ..RenderDesc::default()
    };
    assert_eq!(scene.render, expected);
    let warnings = scene.warnings.join("\n");
    for word in ["scalingFactor: not done", "here: interpolation, recordStatistics", "nonsense: unknown"] {
        assert!(warnings.contains(word), "{word} in:\n{warnings}");
    }
    for (pattern, sampler) in [("rand", SamplerDesc::Random), ("norm", SamplerDesc::Gaussian)] {
        desc::apply_params(&format!("{{\"supersamples\": [2.0, \"{pattern}\"]}}"), None, &mut scene).unwrap();
        assert_eq!((scene.render.samples, scene.render.sampler), (4, sampler));
    }
    desc::apply_params(r#"{"photonMap": 0, "scalingFactor": [1, 1]}"#, None, &mut scene).unwrap();
    assert_eq!(scene.warnings.join("\n"), warnings, "what changes nothing needs no word");
    for (text, expected) in [
        ("{\n\"resolution\": [0, 1]}", "line 2: resolution[0]: 0 is out of range"),
        ("{\n\"supersamples\": 7}", "line 2: supersamples: invalid type: integer `7`"),
        ("{\"supersamples\": [0,\n \"grid\"]}", "line 1: supersamples[0]: 0 is out of range"),
        ("{\"supersamples\": [46341, \"grid\"]}", "line 1: supersamples[0]: 46341 is out of range"),
        ("{\"supersamples\": [7,\n\"gird\"]}", "line 2: supersamples[1]: unknown pattern 'gird'"),
        ("{\"supersamples\": [7, \"grid\", 1]}", "line 1: supersamples: too many elements"),
        ("{\"maxRayDepth\": 0}", "line 1: maxRayDepth: 0 is out of range"),
        ("{\"shadowRays\": -1}", "line 1: shadowRays: invalid value: integer `-1`"),
        ("{\n\"roulette\": \"mine\"}", "line 2: roulette: unknown name `mine`"),
        ("{\"roulette\": 1}", "line 1: roulette: invalid type: integer `1`"),
        ("{\"photonMap\": true}", "line 1: photonMap: invalid type: boolean `true`, expected a number"),
        (
            "{\n\"photonAmount\": 0}",
            "line 2: photonAmount: 0 is out of range, expected a whole number from 1 to 536870912",
        ),
        ("{\"photonAmount\": -5}", "line 1: photonAmount: invalid value: integer `-5`"),
        ("{\"photonAmount\": 536870913}", "line 1: photonAmount: 536870913 is out of range"),
        ("{\"photonAmount\": 1e30}", "line 1: photonAmount: invalid value: floating point `1e+30`"),
        ("{\"photonAmount\": 0.5}", "line 1: photonAmount: invalid value: floating point `0.5`"),
        ("{\n\"photonEstimationRadius\": 0}", "line 2: photonEstimationRadius: 0 is not above 0"),
        ("{\"photonEstimationRadius\": -0.1}", "line 1: photonEstimationRadius: -0.1 is not above 0"),
        (
            "{\"photonEstimationRadius\": 1e30}",
            "line 1: photonEstimationRadius: 1e30 is out of range, expected a radius",
        ),
        ("{\"photonEstimationRadius\": 1e-30}", "line 1: photonEstimationRadius: 1e-30 is out of range"),
        ("{\"photonEstimationRadius\": 1e39}", "line 1: photonEstimationRadius: 1e39 is beyond single precision"),
        ("{\"photonEstimationRadius\": 1e999}", "line 1: "),
        ("{\"photonEstimationRadius\": NaN}", "line 1: "),
        ("[]", "line 1: expected an object, found an array"),
        ("{", "line 1: the text ends inside an object"),
    ] {
        let error = desc::apply_params(text, None, &mut scene).expect_err(text).to_string();
        assert!(error.starts_with(expected), "{error}");
    }
}

#[test]
fn the_reports_dialect_warns_where_it_departs_from_the_letter() {
    let scene = parse(
        r#"{"camera": {"lookAt": [0, 0, -2], "zoom": 3}, "author": "me",
            "materials": [
              {"name": "a", "type": "diffuse", "brdf": "lambertian", "color": [1, 1, 1], "reflectionRate": 0.5},
              {"name": "a", "type": "reflective", "color": [0.5, 0.5, 0.5], "reflectionRate": 1},
              {"name": "b", "type": "diffuse", "brdf": "oren-nayar", "roughness": 0.25, "color": [1, 0, 1],
              "reflectionRate": 1.5},
              {"name": "c", "type": "refractive", "color": [1, 0, 0], "refractionIndex": 1.5, "reflectionRate": 1},
              {"name": "d", "type": "diffuse", "color": [0, 0, 0], "reflectionRate": 0},
              {"name": "e", "type": "diffuse", "color": [0, 0, 0], "reflectionRate": 1e-60}],
            "lights": [{"type": "point", "origin": [0, 1, 0], "color": [1, 2, 3], "intensity": 2, "radius": 1}],
            "surfaces": [{"geometry": "sphere", "origin": [0, 0, 0], "radius": 1, "material": "a", "emission": [1,
            1, 1]}]}"#,
    );
    assert_eq!(scene.dialect, Dialect::Mcrt);
    let names: Vec<_> = scene.materials.iter().map(|material| material.name.as_str()).collect();
    assert_eq!(names, ["a", "b", "c", "d", "e"]);
    assert_eq!(scene.materials[0].bsdf, BsdfDesc::Lambert { albedo: Rgb::ONE }, "the first definition wins");
    assert_eq!(scene.materials[1].bsdf, BsdfDesc::OrenNayar { albedo: Rgb::new(1.0, 0.0, 1.0), roughness: 0.25 });
    let survival: Vec<_> = scene.materials.iter().map(|material| material.survival).collect();
    assert_eq!(survival, [Some(0.5), None, None, None, None]);
    assert_eq!(scene.lights[0].intensity, Rgb::new(2.0, 4.0, 6.0));
    assert_eq!(scene.surfaces[0].emission, None);
    let warnings = scene.warnings.join("\n");
    for word in [
        "author: unknown key",
        "camera.zoom: unknown key",
        "materials[1].name: a second material named 'a'",
        "materials[2].reflectionRate: 1.5",
        "materials[3].color: glass is clear",
        "materials[4].reflectionRate: 0",
        "materials[5].reflectionRate: 0.000",
        "lights[0].radius: unknown key",
        "surfaces[0].emission: unknown key",
    ] {
        assert!(warnings.contains(word), "{word} in:\n{warnings}");
    }
    assert_eq!(scene.warnings.len(), 9, "{warnings}");
}

/// The folder with the report's files, if it is there.
fn report_dir() -> Option<PathBuf> {
    let dir = std::env::var_os("ETENDUE_MCRT_DATA")
        .map_or_else(|| Path::new(env!("CARGO_MANIFEST_DIR")).join("../shared/data/mcrt"), PathBuf::from);
    if dir.join("scene.json").is_file() {
        return Some(dir);
    }
    eprintln!("SKIPPED: no scene.json of the report in {}; set ETENDUE_MCRT_DATA to its folder", dir.display());
    None
}

#[test]
fn the_reports_room_is_read_whole() {
    let Some(dir) = report_dir() else { return };
    let scene = desc::load(&dir.join("scene.json"), None).unwrap();
    assert_eq!(scene.dialect, Dialect::Mcrt);
    assert_eq!(scene.render, RenderDesc::default(), "nothing is cut without a parameter file");
    let emitting: Vec<_> = scene.surfaces.iter().filter(|surface| surface.emission.is_some()).collect();
    assert_eq!(emitting.len(), 4);
    for light in emitting {
        assert_eq!(light.emission, Some(Rgb::ONE));
        assert_eq!(light.material, None);
        let ShapeDesc::Triangle([a, b, c]) = light.shape else { panic!("{light:?}") };
        assert!((b - a).cross(c - a).y < 0.0, "the panel at the ceiling shines downwards: {}", light.path);
    }
    let named: Vec<_> = scene.materials.iter().filter(|material| material.path.starts_with("materials")).collect();
    assert_eq!(named.len(), 11);
    let white = scene.materials.iter().find(|material| material.name == "white").unwrap();
    assert_eq!((white.bsdf, white.survival), (BsdfDesc::Lambert { albedo: Rgb::ONE }, Some(0.75)));
    let concrete = scene.materials.iter().find(|material| material.name == "concrete").unwrap();
    assert_eq!(concrete.bsdf, BsdfDesc::OrenNayar { albedo: Rgb::ONE, roughness: 0.2 });
    let glass = scene.materials.iter().find(|material| material.name == "glass").unwrap();
    assert_eq!((glass.bsdf, glass.survival), (BsdfDesc::Dielectric { ior: 1.5, exterior_ior: 1.0 }, None));
    let mirror = scene.materials.iter().find(|material| material.name == "mirror").unwrap();
    assert_eq!((mirror.bsdf, mirror.survival), (BsdfDesc::Mirror { reflectance: Rgb::ONE }, None));
    let spheres = scene.surfaces.iter().filter(|surface| matches!(surface.shape, ShapeDesc::Sphere { .. })).count();
    let triangles = scene.surfaces.iter().filter(|surface| matches!(surface.shape, ShapeDesc::Triangle(_))).count();
    assert_eq!((spheres, triangles, scene.surfaces.len()), (3, 24 + 4, 32));
    assert!(scene.warnings.is_empty(), "{:?}", scene.warnings);

    let [teapot] = scene.meshes.as_slice() else { panic!("one mesh") };
    assert_eq!(teapot.triangles.len(), 240);
    let distinct: std::collections::HashSet<_> =
        teapot.positions.iter().map(|p| p.to_array().map(f64::to_bits)).collect();
    assert_eq!(distinct.len(), 137);
    let placed = scene.surfaces.iter().find(|surface| matches!(surface.shape, ShapeDesc::Mesh { .. })).unwrap();
    assert_eq!(placed.shape, ShapeDesc::Mesh { mesh: 0, smooth: false });
    // A turn by -0.9 rad about y, then the translation.
    let (sin, cos) = (-0.9_f64).sin_cos();
    assert!(near(placed.to_world().transform_point3(DVec3::X), DVec3::new(4.0 + cos, -5.15, -sin)));
}

#[test]
fn the_reports_photon_map_is_asked_for_by_parameter_files() {
    let with = |scene: &str, text: &str| {
        let mut scene = native(scene);
        desc::apply_params(text, None, &mut scene).unwrap();
        (scene.render, scene.warnings)
    };
    let cone = Some(KernelDesc::Cone { k: 1.0 });
    let report = PhotonDesc {
        count: Some(1_000_000),
        radius: Some(0.1),
        min_photons: 10,
        kernel: cone,
        sharing: PhotonSharing::Area,
        ..PhotonDesc::default()
    };
    let on = |photons| RenderDesc { integrator: IntegratorDesc::PhotonDirect, photons, ..RenderDesc::default() };
    let nothing = r#""surfaces": []"#;
    assert_eq!(with(nothing, r#"{"photonMap": 1}"#), (on(report.clone()), vec![]));
    assert_eq!(with(nothing, r#"{"photonMap": -0.5, "photonAmount": null}"#).0, on(report.clone()));
    let given = PhotonDesc { count: Some(5000), radius: Some(0.7), ..report.clone() };
    let text = r#"{"photonMap": 1, "photonAmount": 5e3, "photonEstimationRadius": 0.7, "photonMapVisualize": 0}"#;
    assert_eq!(with(nothing, text), (on(given), vec![]));
    // What the scene says of the map is replaced, what the report does not know stays.
    let scene = r#""render": {"photonCount": 9, "photonRadius": 9, "minPhotons": 9, "photonKernel": "flat",
        "photonNeighbours": 9, "photonMemory": 9}"#;
    assert_eq!(with(scene, r#"{"photonMap": 1}"#).0, on(PhotonDesc { memory: 9, ..report.clone() }));
    // Points have no area to share by.
    let point = r#""lights": [{"type": "point", "origin": [0, 1, 0], "color": [1, 1, 1]}]"#;
    let shared = PhotonDesc { sharing: PhotonSharing::Power, ..report };
    assert_eq!(with(point, r#"{"photonMap": 1}"#).0, on(shared));
    // Off, amount and radius only wait for an integrator that uses them.
    let waiting = PhotonDesc { count: Some(1), radius: Some(1e18), ..PhotonDesc::default() };
    let text = r#"{"photonMap": 0, "photonAmount": 1, "photonEstimationRadius": 1e18}"#;
    assert_eq!(with(nothing, text), (RenderDesc { photons: waiting, ..RenderDesc::default() }, vec![]));
    let off = |integrator: &str, text: &str| {
        with(&format!("\"render\": {{\"integrator\": \"{integrator}\"}}"), text).0.integrator
    };
    assert_eq!(off("photon_direct", r#"{"photonMap": 0}"#), IntegratorDesc::Path);
    assert_eq!(off("photon_direct", "{}"), IntegratorDesc::PhotonDirect);
    assert_eq!(off("sppm", r#"{"photonMap": 0}"#), IntegratorDesc::Sppm);
    let (render, warnings) = with(nothing, r#"{"photonMapVisualize": 1}"#);
    assert_eq!(render, RenderDesc::default());
    assert!(warnings.len() == 1 && warnings[0].contains("photonMapVisualize"), "{warnings:?}");
    assert!(warnings[0].contains("etendue photons"), "{warnings:?}");
}

#[test]
fn the_reports_boxes_and_parameters_are_read_whole() {
    let Some(dir) = report_dir() else { return };
    let scene = desc::load(&dir.join("cornell.json"), Some(&dir.join("param.json"))).unwrap();
    let lights: Vec<_> = scene.surfaces.iter().filter_map(|surface| surface.emission).collect();
    assert_eq!(lights, [Rgb::ONE; 2]);
    assert_eq!(scene.surfaces.len(), 30 + 2);
    assert_eq!(scene.materials.len(), 3);
    let expected = CameraDesc::ViewPlane {
        centre: DVec3::new(11120.0, 10920.0, -32000.0),
        look_at: DVec3::new(11120.0, 10920.0, -31999.0),
        up: DVec3::Y,
        fov_deg: 39.31,
    };
    assert_eq!(scene.camera, expected);
    let photons = PhotonDesc { count: Some(1_000_000), radius: Some(0.7), ..PhotonDesc::default() };
    let render =
        RenderDesc { samples: 49, sampler: SamplerDesc::Grid, max_depth: Some(7), photons, ..RenderDesc::default() };
    assert_eq!(scene.render, render);
    assert_eq!(scene.warnings.len(), 1, "{:?}", scene.warnings);
}

#[test]
fn a_report_scene_becomes_native_by_its_version_where_its_materials_allow() {
    let text = r#"{"etendue": 1, "camera": {"type": "view-plane", "origin": [-1, 0, 0], "lookAt": [1, 0, 0]},
        "lights": [{"type": "area", "vertex-1": [1, 4, 4], "vertex-2": [1, 4, -4], "vertex-3": [9, 4, -4],
                    "color": [1, 1, 1], "intensity": 1}],
        "materials": [{"name": "w", "type": "diffuse", "brdf": "lambertian", "color": [1, 1, 1],
        "reflectionRate": 0.75}],
        "surfaces": [{"geometry": "mesh", "file": "pyramid.obj", "origin": [4, -5, 0], "rotate": [0, -0.9, 0],
        "scale": 1,
                      "material": "w"}]}"#;
    let (native, report) =
        (parse(text), parse(&text.replace("\"etendue\": 1,", "").replace("\"type\": \"view-plane\",", "")));
    assert_eq!(native.camera, report.camera);
    assert_eq!(native.surfaces[1].to_world(), report.surfaces[1].to_world());
    assert_eq!(native.materials[0], report.materials[0]);
    assert_eq!((native.dialect, report.dialect), (Dialect::Native, Dialect::Mcrt));
}

#[test]
fn a_scene_is_loaded_from_its_file_with_its_meshes_beside_it() {
    let dir = tempfile::tempdir().unwrap();
    std::fs::create_dir(dir.path().join("meshes")).unwrap();
    std::fs::copy(common::snippets::data_dir().join("pyramid.obj"), dir.path().join("meshes/p.obj")).unwrap();
    let text = r#"{"etendue": 1, "camera": {}, "surfaces": [{"geometry": "mesh", "file": "meshes/p.obj",
      "emission": [1, 1, 1]}]}"#;
    let path = dir.path().join("scene.json");
    std::fs::write(&path, text).unwrap();
    let scene = desc::load(&path, None).unwrap();
    assert_eq!((scene.file.as_deref(), scene.meshes[0].triangles.len()), (Some(path.as_path()), 6));
    let missing = desc::load(&dir.path().join("other.json"), None).unwrap_err();
    assert_eq!(missing.kind(), ErrorKind::Io);
    assert!(missing.to_string().contains("other.json"), "{missing}");
    let params = dir.path().join("param.json");
    std::fs::write(&params, "{\n\"shadowRays\": 0}").unwrap();
    let error = desc::load(&path, Some(&params)).unwrap_err();
    assert!(error.to_string().contains("param.json:2: shadowRays: 0"), "{error}");
}

/// The schema in `docs/` is the one of the structures that read scenes. `ETENDUE_WRITE_SCHEMA=1` writes it anew.
#[cfg(feature = "schema")]
#[test]
fn the_schema_in_the_documentation_is_current() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("docs/scene.schema.json");
    let mut current = serde_json::to_string_pretty(&desc::schema()).unwrap();
    current.push('\n');
    if std::env::var_os("ETENDUE_WRITE_SCHEMA").is_some() {
        std::fs::write(&path, &current).unwrap();
    }
    let committed = std::fs::read_to_string(&path).unwrap();
    assert!(committed == current, "docs/scene.schema.json is out of date: run this test with ETENDUE_WRITE_SCHEMA=1");
}

#[test]
fn a_render_block_lies_over_settings_that_stay() {
    let text = r#"{"groups": [{"render": {
        "samples": 7, "maxDepth": null, "photonRadius": 0.5}}, {"render": {"shadowRays": 0}}]}"#;
    let mut base = RenderDesc { max_depth: Some(3), shadow_rays: 4, seed: 9, ..Default::default() };
    base.photons.count = Some(1000);
    base.photons.radius = Some(0.1);
    base.cache.rays = 99;
    let over = desc::apply_render(text, "groups[0].render", None, &base).unwrap();
    let mut expected = RenderDesc { samples: 7, max_depth: None, ..base.clone() };
    expected.photons.radius = Some(0.5);
    assert_eq!(over, expected);
    assert_eq!(desc::apply_render("{}", "", None, &base).unwrap(), base);
    // An integrator takes the place of another one together with its settings.
    let shared = RenderDesc {
        reuse: Some(true),
        light_paths: Some(false),
        first_shadow_rays: Some(2),
        allow_bias: true,
        ..base.clone()
    };
    assert_eq!(desc::apply_render("{}", "", None, &shared).unwrap(), shared);
    assert_eq!(desc::apply_render(r#"{"integrator": "path"}"#, "", None, &shared).unwrap(), base);
    for (path, complaint) in [
        ("groups[1].render", "suite.json:2: groups[1].render.shadowRays: 0 is out of range"),
        ("groups[2].render", "suite.json:1: groups[2].render: there is nothing to read here"),
        ("groups", "suite.json:1: groups: expected an object, found an array"),
    ] {
        let error = desc::apply_render(text, path, Some(Path::new("suite.json")), &base).unwrap_err().to_string();
        assert!(error.starts_with(complaint), "{error}");
    }
}
