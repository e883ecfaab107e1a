//! Files of IES LM-63 and EULUMDAT: what is refused and where, how scenes name them, and how they are kept.

use std::fs;
use std::path::Path;
use std::sync::Arc;

use etendue::ErrorKind;
use etendue::desc::{
    self, AreaWebDesc, IntegratorDesc, LightDistribution, PointLightDesc, RenderDesc, SceneDesc, ShapeDesc, SpotDesc,
    SurfaceLook, WebDesc,
};
use etendue::math::{DAffine3, DVec3};
use etendue::photometry::{LampPosition, Planes, Web, WebFormat};
use etendue::render::{Render, RenderSettings};
use etendue::scene::{BuildOptions, Scene};
use etendue::spectrum::Rgb;

/// A lamp of 100 cd below and none above.
const IES: &str = "IESNA:LM-63-2002\n[TEST] \u{fc}\nTILT=NONE\n1 1000 2 3 1 1 2 0 0 0\n1 1 50\n0 45 90\n0\n50 50 0\n";

/// The same, of 500 lm.
fn ldt() -> String {
    let rooms = "0.5\n".repeat(10);
    format!(
        "name\n1\n1\n1\n0\n3\n45\nreport\nlamp\n1\nfile\nday\n100\n100\n50\n90\n90\n0\n0\n0\n0\n80\n100\n1\n0\n1\n1\nlamp\n500\n\
         white\n80\n60\n{rooms}0\n0\n45\n90\n200\n200\n0\n"
    )
}

fn parse(text: &str) -> Web {
    Web::parse(text.as_bytes()).unwrap_or_else(|error| panic!("{error}"))
}

#[test]
fn both_formats_are_told_apart_and_say_the_same() {
    let (ies, other) = (parse(IES), parse(&ldt()));
    assert_eq!([ies.format(), other.format()], [WebFormat::Ies, WebFormat::Eulumdat]);
    assert_eq!([ies.planes(), other.planes()], [Planes::C; 2]);
    for direction in [DVec3::Z, DVec3::new(1.0, 2.0, 3.0), DVec3::new(1.0, -2.0, 0.1), -DVec3::Z] {
        assert_eq!(ies.candela(direction), other.candela(direction), "{direction}");
    }
    assert_eq!(ies.candela(DVec3::Z), 100.0);
    assert_eq!(ies.candela(DVec3::NEG_Z), 0.0);
    assert_eq!([ies.stated_flux(), other.stated_flux()], [Some(1000.0), Some(500.0)]);
    assert!((ies.flux() / other.flux() - 1.0).abs() < 1e-12);
    assert_eq!(ies.peak(), 100.0);
    // Absolute intensities state no flux.
    assert_eq!(parse(&IES.replace("1 1000 2", "1 -1 2")).stated_flux(), None);
    assert_eq!(parse(&ldt().replace("1\n1\nlamp\n500", "1\n-1\nlamp\n500")).stated_flux(), Some(500.0));
    // Ends of lines, numbers of a country, lists over several lines, and texts of other encodings.
    for text in [
        IES.replace('\n', "\r\n"),
        IES.replace('\n', "\r"),
        IES.replace("0 45 90\n0\n50 50 0", "0,45,\n 90 0 50\n\n50\t0 \u{1a}"),
        IES.replace("IESNA:LM-63-2002\n[TEST] \u{fc}\n", ""),
    ] {
        assert_eq!(parse(&text).candela(DVec3::new(1.0, 2.0, 3.0)), ies.candela(DVec3::new(1.0, 2.0, 3.0)), "{text}");
    }
    let mut latin = IES.replace('\u{fc}', "?").into_bytes();
    let place = latin.iter().position(|&byte| byte == b'?').unwrap();
    latin[place] = 0xfc;
    assert_eq!(Web::parse(&latin).unwrap().peak(), 100.0);
}

#[test]
fn what_is_wrong_is_named_with_its_line() {
    let ies = |from: &str, to: &str| {
        assert!(IES.contains(from), "{from}");
        IES.replacen(from, to, 1)
    };
    let ldt_text = ldt();
    let ldt = |line: usize, to: &str| {
        let mut lines: Vec<&str> = ldt_text.lines().collect();
        lines[line - 1] = to;
        lines.join("\n")
    };
    let many = (0..1000).map(|i| format!("{} ", f64::from(i) / 10.0)).collect::<String>();
    for (text, line, expected) in [
        (String::new(), 0, "the file is empty"),
        (" \r\n\t".to_owned(), 0, "the file is empty"),
        ("IES\n\0\u{1}".to_owned(), 2, "not a text"),
        (ies("TILT=NONE\n", ""), 7, "no line that begins with TILT="),
        (ies("TILT=NONE", "TILT=lamp.tlt"), 3, "TILT=lamp.tlt: the factors of tilted lamps are in a file of their own"),
        (ies("TILT=NONE", "TILT=INCLUDE\n1 2000"), 4, "2000 is no number of tilts"),
        (ies("TILT=NONE", "TILT=INCLUDE\n4 1\n0 1"), 4, "4 is no position of the lamp in the luminaire"),
        (ies("TILT=NONE", "TILT=INCLUDE\n1 2\n0 0\n1 1"), 5, "the angle of a tilt 0 comes after 0"),
        (ies("TILT=NONE", "TILT=INCLUDE\n1 2\n0 200\n1 1"), 5, "200 degrees are no angle of a tilt"),
        (
            ies("TILT=NONE", "TILT=INCLUDE\n1 2\n0 90\n1\n-0.5"),
            7,
            "-0.5 is no factor of a tilt, expected a number in [0, 1e6]",
        ),
        (ies("1 1000 2", "0 1000 2"), 4, "0 is no number of lamps"),
        (ies("1 1000 2", "1 -7 2"), 4, "-7 lumens for each lamp, expected a flux, or -1"),
        (ies("1 1000 2", "1 1000 -2"), 4, "-2 is no factor on the intensities, expected a number above 0"),
        (ies("1 1000 2", "1 lots 2"), 4, "'lots' is no luminous flux of a lamp, expected a number"),
        (ies("1 1000 2", "1 NaN 2"), 4, "'NaN' is no luminous flux of a lamp"),
        (ies("1 1000 2", "1 inf 2"), 4, "'inf' is no luminous flux of a lamp"),
        (ies("3 1 1 2", "1 1 1 2"), 4, "1 is no number of vertical angles, expected a whole number in [2, 1000000]"),
        (ies("3 1 1 2", "1e7 1 1 2"), 4, "10000000 is no number of vertical angles"),
        (ies("3 1 1 2", "900000 900000 1 2"), 4, "900000 planes of 900000 angles are more than the 1000000"),
        (ies("3 1 1 2", "3 1.5 1 2"), 4, "1.5 is no number of horizontal angles"),
        (ies("3 1 1 2", "3 1 4 2"), 4, "4 is no photometric type"),
        (ies("3 1 1 2", "3 1 1 3"), 4, "3 is no type of units"),
        (ies("1 1 50", "-1 1 50"), 5, "-1 is no factor of the ballast"),
        (ies("0 45 90", "0 45 45"), 6, "the vertical angle 45 comes after 45, expected ascending angles"),
        (ies("0 45 90", "0 45 181"), 6, "181 degrees are no vertical angle, expected an angle in [0, 180]"),
        (ies("50 50 0", "50 -50 0"), 8, "an intensity of -50 is negative"),
        (ies("50 50 0", "50 1e20 0"), 8, "an intensity of 2e20 cd is out of range"),
        (ies("50 50 0", "50 50"), 8, "the file ends before intensity"),
        (
            ies("3 1 1 2 0 0 0\n1 1 50\n0 45 90\n0\n50 50 0", "2 2 1 2 0 0 0\n1 1 50\n0 90\n0 45\n1 1 1 1"),
            7,
            "from 0 to 45 degrees",
        ),
        (
            ies("3 1 1 2 0 0 0\n1 1 50\n0 45 90\n0\n50 50 0", "2 2 2 2 0 0 0\n1 1 50\n0 90\n10 45\n1 1 1 1"),
            7,
            "from 10 to 45 degrees",
        ),
        (ies("TILT=NONE", &format!("TILT=INCLUDE\n1 1000 {many}")), 9, "the file ends before"),
        ("nonsense".to_owned(), 1, "the file ends before kind of luminaire in line 2"),
        (ldt(2, "7"), 2, "7 is no kind of luminaire"),
        (ldt(3, "5"), 3, "5 is no symmetry, expected a whole number in [0, 4]"),
        (ldt(3, "2"), 3, "the symmetry 2 with 1 planes leaves those from 0 to 0 degrees, expected from 0 to 180"),
        (ldt(3, "3"), 3, "the symmetry 3 with 1 planes"),
        (ldt(3, "4"), 3, "the symmetry 4 with 1 planes"),
        (ldt(4, "1000001"), 4, "1000001 is no number of planes"),
        (ldt(6, "2000"), 47, "200 degrees are no angle in a plane, expected an angle in [0, 180]"),
        (ldt(22, "-1"), 22, "-1 % is no downward share of the flux"),
        (ldt(24, "0"), 24, "0 is no factor on the intensities"),
        (ldt(26, "21"), 26, "21 is no number of sets of lamps"),
        (ldt(29, "0"), 29, "0 is no luminous flux of the lamps"),
        (ldt(44, "45"), 45, "the angle in a plane 45 comes after 45"),
        (ldt(47, "-200"), 47, "an intensity of -200 is negative"),
        (ldt(48, "x"), 48, "'x' is no intensity"),
    ] {
        let error = Web::parse(text.as_bytes()).expect_err(expected);
        assert_eq!(error.kind(), ErrorKind::InvalidScene, "{error}");
        let said = error.to_string();
        assert!(said.contains(expected), "{said}\nexpected {expected}");
        assert_eq!(error.location().line, line, "{said}");
    }
    // Nothing that is cut short or has a byte changed brings the reader down.
    for text in [IES.to_owned(), ldt_text.clone()] {
        for end in 0..text.len() {
            let _ = Web::parse(&text.as_bytes()[..end]);
            for byte in [b'0', b'9', b'-', b'.', b'e', b'\n', 0xff] {
                let mut changed = text.clone().into_bytes();
                changed[end] = byte;
                if let Ok(web) = Web::parse(&changed) {
                    assert!(web.flux().is_finite() && web.flux() >= 0.0);
                    assert!(web.candela(DVec3::ONE) >= 0.0);
                    assert!(web.flux() == 0.0 || web.sample([0.3, 0.7]).is_finite());
                }
            }
        }
    }
}

fn scene(folder: &Path, lights: &str) -> etendue::Result<SceneDesc> {
    let text = format!(
        r#"{{"etendue": 1, "camera": {{}}, "lights": [{lights}],
            "surfaces": [{{"geometry": "sphere", "origin": [0, 0, -3], "radius": 1, "emission": [1, 1, 1]}}]}}"#
    );
    desc::parse(&text, folder, None)
}

#[test]
fn scenes_name_them_and_read_each_once() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("lamp.ies"), IES).unwrap();
    fs::write(folder.path().join("lamp.ldt"), ldt()).unwrap();
    fs::write(folder.path().join("bad.ies"), IES.replace("50 50 0", "50 -50 0")).unwrap();
    let desc = scene(
        folder.path(),
        r#"{"type": "web", "file": "lamp.ies", "origin": [0, 2, 0]},
           {"type": "web", "file": "./lamp.ies", "origin": [0, 3, 0], "direction": [0, 0, 2], "c0": [0, 1, 1], "color": [1, 2, 3],
            "intensity": 2},
           {"type": "web", "file": "lamp.ldt", "origin": [0, 3, 0]}"#,
    )
    .unwrap();
    let webs: Vec<&WebDesc> = desc
        .lights
        .iter()
        .map(|light| match &light.distribution {
            LightDistribution::Web(web) => web,
            _ => panic!("{light:?}"),
        })
        .collect();
    assert!(Arc::ptr_eq(&webs[0].web, &webs[1].web) && !Arc::ptr_eq(&webs[0].web, &webs[2].web));
    assert_eq!((webs[0].direction, webs[0].c0), (DVec3::NEG_Y, DVec3::X));
    assert_eq!((webs[1].direction, webs[1].c0), (DVec3::new(0.0, 0.0, 2.0), DVec3::new(0.0, 1.0, 1.0)));
    assert_eq!([desc.lights[0].intensity, desc.lights[1].intensity], [Rgb::ONE, Rgb::new(2.0, 4.0, 6.0)]);
    assert_eq!(desc.files.len(), 2);
    let built = Scene::build(&desc, &BuildOptions::default()).unwrap();
    let power: f64 = built.emitters().emitters()[0].power().x;
    assert!((power / (webs[0].web.flux() / 683.0) - 1.0).abs() < 1e-6);
    let said = built.info().to_string();
    assert!(said.contains("lights[0] (2 lights): ") && said.contains(" lm of the 1000.0 lm in its file"), "{said}");

    // Kept as they were, each once.
    let path = folder.path().join("kept.json");
    desc.save(&path).unwrap();
    let again = desc::load(&path, None).unwrap();
    let plain = |desc: &SceneDesc| -> Vec<PointLightDesc> {
        desc.lights.iter().map(|light| PointLightDesc { path: String::new(), ..light.clone() }).collect()
    };
    assert_eq!(plain(&desc), plain(&again));
    let files: Vec<_> = fs::read_dir(SceneDesc::files_folder(&path)).unwrap().collect();
    assert_eq!(files.len(), 2, "{files:?}");

    for (light, expected) in [
        (r#"{"type": "web", "origin": [0, 0, 0]}"#, "lights[0]: missing key `file`"),
        (r#"{"type": "web", "file": "", "origin": [0, 0, 0]}"#, "lights[0].file: not a file name"),
        (r#"{"type": "web", "file": "none.ies", "origin": [0, 0, 0]}"#, "cannot read the photometric web"),
        (
            r#"{"type": "web", "file": "bad.ies", "origin": [0, 0, 0]}"#,
            "bad.ies:8: lights[0].file: an intensity of -50",
        ),
        (
            r#"{"type": "web", "file": "lamp.ies", "origin": [0, 0, 0], "direction": [0, 0, 0]}"#,
            "lights[0].direction: [0.0, 0.0, 0.0] has no direction",
        ),
        (
            r#"{"type": "web", "file": "lamp.ies", "origin": [0, 0, 0], "c0": [0, 0, 0]}"#,
            "lights[0].c0: [0.0, 0.0, 0.0] has no direction",
        ),
        (
            r#"{"type": "web", "file": "lamp.ies", "origin": [0, 0, 0], "intensity": 1e37}"#,
            "e38 is beyond single precision",
        ),
    ] {
        let said = scene(folder.path(), light).unwrap_err().to_string();
        assert!(said.contains(expected), "{said}\nexpected {expected}");
    }
}

/// Factors of tilted lamps: in the file of the web and in one of their own, in all positions of lamps, and beyond the angles.
#[test]
fn lamps_are_tilted() {
    let with = |block: &str| parse(&IES.replace("TILT=NONE", &format!("TILT=INCLUDE\n{block}")));
    let upright = with("1 3\n0 45 90\n1 0.9 0.6");
    let signed = with("3\n3\n-90 0 90\n0.5 1 0.8");
    let late = with("1\n2\n30 60\n0.8 0.4");
    let level = with("2\n3\n0 45 90\n0.95 0.9 0.6");
    for (web, degrees, factor) in [
        (&upright, 0.0, Some(1.0)),
        (&upright, 22.5, Some(0.95)),
        (&upright, -45.0, Some(0.9)),
        (&upright, 90.0, Some(0.6)),
        (&upright, 90.5, None),
        (&signed, -45.0, Some(0.75)),
        (&signed, 45.0, Some(0.9)),
        (&signed, -91.0, None),
        (&late, 0.0, Some(1.0)),
        (&late, 15.0, Some(0.9)),
        (&late, 45.0, Some(0.6)),
        (&late, 61.0, None),
        (&level, 70.0, Some(0.95)),
        (&parse(IES), 70.0, Some(1.0)),
    ] {
        let found = web.tilt_factor(degrees);
        let same = found.is_some() == factor.is_some() && (found.unwrap_or(0.0) - factor.unwrap_or(0.0)).abs() < 1e-12;
        assert!(same, "{degrees}: {found:?} instead of {factor:?}");
    }
    assert_eq!(
        upright.tilt().map(|tilt| (tilt.position(), tilt.range())),
        Some((LampPosition::Vertical, [-90.0, 90.0]))
    );

    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("own.ies"), IES.replace("TILT=NONE", "TILT= hid.tlt ")).unwrap();
    fs::write(folder.path().join("hid.tlt"), "1\r\n3\r\n0 45 90\r\n1 0.9 0.6\r\n").unwrap();
    fs::write(folder.path().join("same.ies"), IES.replace("TILT=NONE", "TILT=INCLUDE\n1 3\n0 45 90\n1 0.9 0.6"))
        .unwrap();
    fs::write(folder.path().join("none.ies"), IES.replace("TILT=NONE", "TILT=missing.tlt")).unwrap();
    fs::write(folder.path().join("itself.ies"), IES.replace("TILT=NONE", "TILT=itself.ies")).unwrap();
    fs::write(folder.path().join("bad.ies"), IES.replace("TILT=NONE", "TILT=bad.tlt")).unwrap();
    fs::write(folder.path().join("bad.tlt"), "1\n2\n0 90\n1 x\n").unwrap();
    let lamp = |file: &str, rest: &str| {
        scene(folder.path(), &format!(r#"{{"type": "web", "file": "{file}", "origin": [0, 2, 0]{rest}}}"#))
    };
    let power = |desc: &SceneDesc| {
        let built = Scene::build(desc, &BuildOptions::default()).unwrap();
        built.emitters().emitters()[0].power().x
    };
    let full = power(&lamp("own.ies", "").unwrap());
    for file in ["own.ies", "same.ies"] {
        let desc = lamp(file, r#", "tilt": -67.5"#).unwrap();
        assert!((power(&desc) / full - 0.75).abs() < 1e-6);
        // The flux that a unit gives is that of the lamp as it is tilted.
        let lumens = lamp(file, r#", "tilt": 45, "unit": "lm", "intensity": 683"#).unwrap();
        assert!((power(&lumens) - 1.0).abs() < 1e-6);
        // The factors are kept with the web.
        let path = folder.path().join("kept.json");
        desc.save(&path).unwrap();
        let again = desc::load(&path, None).unwrap();
        assert_eq!(again.lights[0].distribution, desc.lights[0].distribution);
        assert!((power(&again) / full - 0.75).abs() < 1e-6);
        let said = Scene::build(&again, &BuildOptions::default()).unwrap().info().to_string();
        assert!(said.contains(", factors of tilts from -90 to 90 degrees"), "{said}");
    }
    for (file, rest, expected) in [
        (
            "own.ies",
            r#", "tilt": 91"#,
            "lights[0].tilt: 91 degrees are beyond the tilts of the file, expected an angle in [-90, 90]",
        ),
        (
            "own.ies",
            r#", "tilt": 181"#,
            "lights[0].tilt: 181 degrees are out of range, expected an angle in [-180, 180]",
        ),
        ("none.ies", "", "none.ies:3: lights[0].file: TILT=missing.tlt: cannot read the factors of tilted lamps"),
        ("itself.ies", "", "itself.ies:3: lights[0].file: TILT= names no file of factors"),
        ("bad.ies", "", "bad.tlt:4: lights[0].file: 'x' is no factor of a tilt"),
    ] {
        let said = lamp(file, rest).unwrap_err().to_string();
        assert!(said.contains(expected), "{said}\nexpected {expected}");
    }
}

/// What changes a lamp is seen by the next build, and what does not leaves the lamp as it was.
#[test]
fn edits_turn_and_change_them() {
    let mut desc = SceneDesc::default();
    let web = Arc::new(parse(IES));
    let lamp = |web: &Arc<Web>| PointLightDesc {
        distribution: LightDistribution::Web(WebDesc::new(Arc::clone(web))),
        ..PointLightDesc::even(DVec3::Y, Rgb::ONE)
    };
    desc.add_light_desc(lamp(&web)).unwrap();
    let power = |scene: &Scene| scene.emitters().emitters()[0].power().x;
    let scene = Scene::build(&desc, &BuildOptions::default()).unwrap();
    let brighter = Arc::new(parse(&IES.replace("1 1000 2", "1 1000 4")));
    desc.set_light_desc(0, lamp(&brighter)).unwrap();
    let again = scene.rebuild(&desc, &BuildOptions::default()).unwrap();
    assert!((power(&again) / power(&scene) - 2.0).abs() < 1e-12);
    desc.set_point_light(0, DVec3::Y, Rgb::splat(0.5)).unwrap();
    let dimmed = again.rebuild(&desc, &BuildOptions::default()).unwrap();
    assert!((power(&dimmed) / power(&scene) - 1.0).abs() < 1e-6);
    // A lamp without any light is none.
    desc.set_light_desc(0, lamp(&Arc::new(parse(&IES.replace("50 50 0", "0 0 0"))))).unwrap();
    assert!(Scene::build(&desc, &BuildOptions::default()).unwrap().emitters().emitters().is_empty());
}

#[test]
fn all_integrators_take_points_that_shine_unevenly() {
    for distribution in [
        LightDistribution::Spot(SpotDesc::new(DVec3::NEG_Y)),
        LightDistribution::Web(WebDesc::new(Arc::new(parse(IES)))),
    ] {
        let mut desc = SceneDesc::default();
        desc.add_light_desc(PointLightDesc { distribution, ..PointLightDesc::even(DVec3::Y, Rgb::ONE) }).unwrap();
        let scene = Scene::build(&desc, &BuildOptions::default()).unwrap();
        let of = |integrator| {
            let desc = RenderDesc { integrator, ..RenderDesc::default() };
            Render::new(&scene, RenderSettings { desc, ..RenderSettings::default() }).map(|_| ())
        };
        for integrator in IntegratorDesc::ALL {
            of(integrator).unwrap_or_else(|error| panic!("{integrator:?}: {error}"));
        }
    }
}

/// A scene of these surfaces, with a material that has a texture of its emission.
fn surfaces(folder: &Path, surfaces: &str) -> etendue::Result<SceneDesc> {
    let text = format!(
        r#"{{"etendue": 1, "camera": {{}}, "surfaces": [{surfaces}],
            "textures": [{{"name": "checks", "type": "checker"}}],
            "materials": [{{"name": "white", "type": "diffuse", "color": [1, 1, 1]}},
                {{"name": "lit", "type": "diffuse", "color": [1, 1, 1], "emission": [1, 1, 1], "textures": {{"emission": "checks"}}}}]}}"#
    );
    desc::parse(&text, folder, None)
}

const DISK: &str = r#"{"geometry": "disk", "origin": [0, 2, 0], "normal": [0, -1, 0], "radius": 0.5"#;

const TRIANGLE: &str =
    r#"{"geometry": "triangle", "vertex-1": [0, 2, 0], "vertex-2": [1, 2, 0], "vertex-3": [0, 2, 1]"#;

/// A file of both sides: 100 cd on the front and half of it on the back.
fn both_sides() -> String {
    IES.replace("2 3 1 1 2", "2 5 1 1 2").replace("0 45 90\n0\n50 50 0", "0 80 89 100 180\n0\n50 50 50 25 25")
}

#[test]
fn surfaces_shine_by_them() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("lamp.ies"), IES).unwrap();
    fs::write(folder.path().join("both.ies"), both_sides()).unwrap();
    let desc = surfaces(
        folder.path(),
        &format!(
            r#"{DISK}, "web": {{"file": "lamp.ies"}}}},
               {DISK}, "material": "white", "web": {{"file": "lamp.ies", "c0": [0, 1, 1], "color": [1, 2, 3], "intensity": 2}}}},
               {TRIANGLE}, "emits": "both", "web": {{"file": "both.ies", "unit": "lm", "intensity": 800, "temperature": 3000}}}},
               {TRIANGLE}, "web": {{"file": "lamp.ies", "intensity": 0}}}}"#
        ),
    )
    .unwrap();
    let webs: Vec<&AreaWebDesc> = desc.surfaces.iter().map(|surface| surface.web.as_deref().unwrap()).collect();
    assert!(Arc::ptr_eq(&webs[0].web, &webs[1].web) && !Arc::ptr_eq(&webs[0].web, &webs[2].web));
    assert_eq!([webs[0].c0, webs[1].c0], [DVec3::X, DVec3::new(0.0, 1.0, 1.0)]);
    let factors: Vec<_> = desc.surfaces.iter().map(|surface| surface.emission).collect();
    assert_eq!([factors[0], factors[1], factors[3]], [Some(Rgb::ONE), Some(Rgb::new(2.0, 4.0, 6.0)), None]);
    let built = Scene::build(&desc, &BuildOptions::default()).unwrap();
    let powers: Vec<DVec3> = built.emitters().emitters().iter().map(|emitter| emitter.power()).collect();
    // Two disks, and a triangle of both sides: those of its back come last.
    assert_eq!(powers.len(), 4);
    let close = |got: f64, expected: f64| assert!((got / expected - 1.0).abs() < 1e-6, "{got} {expected}");
    let flux = webs[0].web.flux() / 683.0;
    let all = powers.iter().map(|power| power.x).collect::<Vec<_>>();
    assert!(all.iter().any(|power| (power / flux - 1.0).abs() < 1e-6), "{all:?} {flux}");
    assert!(all.iter().any(|power| (power / flux - 2.0).abs() < 1e-6), "{all:?} {flux}");
    let weights = DVec3::new(0.2126, 0.7152, 0.0722);
    let whole: f64 = powers.iter().map(|power| power.dot(weights)).sum();
    close(whole - flux * (1.0 + 2.0 * weights.dot(DVec3::new(1.0, 2.0, 3.0))), 800.0 / 683.0);
    let sides = [true, false].map(|front| webs[2].web.side(front).unwrap().flux());
    close(sides[0] + sides[1], webs[2].web.flux());
    assert!(sides[0] > 1.85 * sides[1] && sides[0] < 1.86 * sides[1], "{sides:?}");
    let said = built.info().to_string();
    assert!(
        said.contains("surfaces[0] (2 lights): ") && said.contains("3 surfaces shine by a photometric web"),
        "{said}"
    );

    // Kept as they are, each file once; one that is switched off is not.
    let path = folder.path().join("kept.json");
    desc.save(&path).unwrap();
    let again = desc::load(&path, None).unwrap();
    for (kept, surface) in again.surfaces.iter().zip(&desc.surfaces).take(3) {
        assert_eq!((kept.emission, &kept.web, kept.emits_both), (surface.emission, &surface.web, surface.emits_both));
    }
    assert_eq!(again.surfaces[3].web, None);
    let files: Vec<_> = fs::read_dir(SceneDesc::files_folder(&path)).unwrap().collect();
    assert_eq!(files.len(), 2, "{files:?}");
}

#[test]
fn surfaces_that_cannot_shine_by_them_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("lamp.ies"), IES).unwrap();
    fs::write(folder.path().join("both.ies"), both_sides()).unwrap();
    let web = r#""web": {"file": "lamp.ies"}"#;
    let moving = r#""motion": [{"time": 0}, {"time": 1, "translate": [1, 0, 0]}]"#;
    let mesh = |positions: &str, triangles: &str| {
        format!(r#"{{"geometry": "mesh", "positions": {positions}, "triangles": {triangles}, {web}}}"#)
    };
    let square = "[[0, 2, 0], [1, 2, 0], [1, 2, 1], [0, 2, 1]]";
    for (surface, expected) in [
        (format!(r#"{DISK}, "web": {{}}}}"#), "surfaces[0].web: missing"),
        (
            format!(r#"{DISK}, "web": {{"file": "none.ies"}}}}"#),
            "surfaces[0].web.file: cannot read the photometric web",
        ),
        (
            format!(r#"{DISK}, "web": {{"file": "lamp.ies", "direction": [0, 1, 0]}}}}"#),
            "surfaces[0].web.direction: unknown key",
        ),
        (format!(r#"{DISK}, "emission": [1, 1, 1], {web}}}"#), "surfaces[0].emission: `web` says the light already"),
        (format!(r#"{DISK}, "luminance": 10, {web}}}"#), "surfaces[0].luminance: `web` says the light already"),
        (format!(r#"{DISK}, "temperature": 3000, {web}}}"#), "surfaces[0].temperature: is used with `luminance` only"),
        (
            format!(r#"{DISK}, "web": {{"file": "lamp.ies", "c0": [0, 0, 0]}}}}"#),
            "surfaces[0].web.c0: [0.0, 0.0, 0.0] has no direction",
        ),
        (format!(r#"{DISK}, "web": {{"file": "lamp.ies", "tilt": 200}}}}"#), "surfaces[0].web.tilt: 200 degrees"),
        (format!(r#"{DISK}, "web": {{"file": "lamp.ies", "intensity": -1}}}}"#), "surfaces[0].web.intensity: -1"),
        (format!(r#"{DISK}, "web": {{"file": "lamp.ies", "intensity": 1e37}}}}"#), "e38 is beyond single precision"),
        (
            format!(r#"{DISK}, "web": {{"file": "lamp.ies", "unit": "cd", "intensity": 3}}}}"#),
            "surfaces[0].web.unit: 'cd' is no unit of this light, expected one of W, lm",
        ),
        (
            format!(r#"{DISK}, "web": {{"file": "both.ies"}}}}"#),
            "surfaces[0].web: the lamp sends 339.0193 of its 967.0886 lm behind the surface, expected a file without light beyond 90 degrees",
        ),
        (
            format!(r#"{{"geometry": "sphere", "origin": [0, 0, 0], "radius": 1, {web}}}"#),
            "surfaces[0].web: a photometric web needs a flat surface, and a sphere is none",
        ),
        (
            format!(
                r#"{{"geometry": "cylinder", "base": [0, 0, 0], "axis": [0, 1, 0], "radius": 1, "height": 1, {web}}}"#
            ),
            "surfaces[0].web: a photometric web needs a flat surface, and a quadric is none",
        ),
        (
            mesh("[[0, 2, 0], [1, 2, 0], [1, 2.01, 1], [0, 2, 1]]", "[[0, 1, 2], [0, 2, 3]]"),
            "surfaces[0].web: a photometric web needs a flat surface, and the corners of the mesh are not in a plane",
        ),
        (
            mesh("[[0, 2, 0], [1, 2, 0], [1, 2, 1], [0, 2, 4]]", "[[0, 1, 2], [0, 3, 2]]"),
            "surfaces[0].web: a photometric web needs a flat surface, and the triangles of the mesh face both sides",
        ),
        (mesh(square, "[[0, 1, 0]]"), "and the mesh has no area"),
        (
            format!(r#"{DISK}, "radius": 1e-22, {web}}}"#).replace(r#""radius": 0.5, "#, ""),
            "beyond single precision on an area",
        ),
        (
            format!(r#"{TRIANGLE}, "material": "lit", {web}}}"#),
            "surfaces[0].web: a texture varies the emission already",
        ),
        (format!("{TRIANGLE}, {moving}, {web}}}"), "surfaces[0].motion: a surface with a photometric web cannot move"),
        (
            mesh(square, "[[0, 1, 2], [0, 2, 3]]").replace(
                r#""positions""#,
                r#""steps": [{"time": 0, "positions": [[0, 2, 0], [1, 2, 0], [1, 2, 1], [0, 2, 1]]},
                    {"time": 1, "positions": [[0, 3, 0], [1, 3, 0], [1, 3, 1], [0, 3, 1]]}], "positions""#,
            ),
            "surfaces[0].motion: a surface with a photometric web cannot move",
        ),
    ] {
        let built = surfaces(folder.path(), &surface).and_then(|mut desc| {
            desc.motion.shutter.close = 1.0;
            Scene::build(&desc, &BuildOptions::default())
        });
        let said = built.map_or_else(|error| error.to_string(), |_| "taken".to_owned());
        assert!(said.contains(expected), "{surface}\n{said}\nexpected {expected}");
    }
    // What rests while the shutter is open is taken.
    let rests = surfaces(folder.path(), &format!("{TRIANGLE}, {moving}, {web}}}")).unwrap();
    assert!(Scene::build(&rests, &BuildOptions::default()).unwrap().emitters().has_web_areas());
}

/// What changes such a lamp is seen by the next build, and calls refuse what the surface cannot be.
#[test]
fn edits_change_webs_of_surfaces() {
    let mut desc = SceneDesc::default();
    let (triangle, local) =
        ShapeDesc::triangle([DVec3::ZERO, DVec3::new(1.0, 0.1, 0.7), DVec3::new(0.2, 1.0, -0.4)]).unwrap();
    let look = SurfaceLook { emission: Some(Rgb::ONE), ..SurfaceLook::default() };
    desc.add_surface(triangle, local, look).unwrap();
    let scene = Scene::build(&desc, &BuildOptions::default()).unwrap();
    assert!(!scene.emitters().has_web_areas());
    let power = |scene: &Scene| scene.emitters().emitters().iter().map(|emitter| emitter.power().x).sum::<f64>();
    let lamp = |text: &str| AreaWebDesc::new(Arc::new(parse(text)));
    desc.set_surface_web(0, Some(lamp(IES))).unwrap();
    let shaped = scene.rebuild(&desc, &BuildOptions::default()).unwrap();
    assert!(shaped.emitters().has_web_areas());
    let flux = lamp(IES).web.flux() / 683.0;
    assert!((power(&shaped) / flux - 1.0).abs() < 1e-6);
    // The whole flux whatever the size, and the light of the front where it is turned over.
    desc.set_transform(0, DAffine3::from_scale(DVec3::new(-3.0, 2.0, 1.0))).unwrap();
    let larger = shaped.rebuild(&desc, &BuildOptions::default()).unwrap();
    assert!((power(&larger) / flux - 1.0).abs() < 1e-6);
    desc.set_emission(0, Some(Rgb::splat(0.5))).unwrap();
    let dimmed = larger.rebuild(&desc, &BuildOptions::default()).unwrap();
    assert!((power(&dimmed) / flux - 0.5).abs() < 1e-6);

    let path = |error: etendue::Error| error.to_string();
    let behind = path(desc.set_surface_web(0, Some(lamp(&both_sides()))).unwrap_err());
    assert!(behind.contains("surfaces[0].web: the lamp sends"), "{behind}");
    desc.set_emits_both(0, true).unwrap();
    desc.set_surface_web(0, Some(lamp(&both_sides()))).unwrap();
    let behind = path(desc.set_emits_both(0, false).unwrap_err());
    assert!(behind.contains("surfaces[0].web: the lamp sends"), "{behind}");
    let bright = path(desc.set_emission(0, Some(Rgb::splat(1e37))).unwrap_err());
    assert!(bright.contains("surfaces[0].web.color[0]"), "{bright}");
    let both = dimmed.rebuild(&desc, &BuildOptions::default()).unwrap();
    assert!((power(&both) / (0.5 * lamp(&both_sides()).web.flux() / 683.0) - 1.0).abs() < 1e-6);
    // Without an emission of its own the web has no effect, and the surface keeps it.
    desc.set_emission(0, None).unwrap();
    assert!(both.rebuild(&desc, &BuildOptions::default()).unwrap().emitters().is_dark());
    desc.set_emission(0, Some(Rgb::ONE)).unwrap();
    desc.set_surface_web(0, None).unwrap();
    let even = both.rebuild(&desc, &BuildOptions::default()).unwrap();
    assert!(!even.emitters().has_web_areas() && power(&even) > 0.0);
    assert_eq!(desc.set_surface_web(7, None).unwrap_err().kind(), ErrorKind::InvalidScene);
}

/// All light of a lamp behind its plane: the front is dark and the back has all of it; and the other way round.
#[test]
fn integrators_take_surfaces_with_webs_but_for_radiosity() {
    let (quad, local) = ShapeDesc::quad([DVec3::ZERO, DVec3::X, DVec3::new(1.0, 1.0, 0.0), DVec3::Y]).unwrap();
    let upwards = IES.replace("0 45 90\n", "90 135 180\n").replace("50 50 0", "0 50 50");
    for (text, lit) in [(IES, [true, false]), (&upwards, [false, true])] {
        let mut desc = SceneDesc::default();
        let look = SurfaceLook { emission: Some(Rgb::ONE), emits_both: true, ..SurfaceLook::default() };
        desc.add_surface(quad, local, look).unwrap();
        desc.set_surface_web(0, Some(AreaWebDesc::new(Arc::new(parse(text))))).unwrap();
        let scene = Scene::build(&desc, &BuildOptions::default()).unwrap();
        let emitters = scene.emitters();
        for (side, is_lit) in [DVec3::Z, DVec3::NEG_Z].into_iter().zip(lit) {
            let wo = (side + 0.1 * DVec3::X).normalize().as_vec3a();
            let seen = emitters.le(0, DVec3::Z.as_vec3a(), wo, DVec3::new(0.2, 0.1, 0.0).as_vec3a());
            assert_eq!(seen.r() > 0.0, is_lit, "{side} {seen:?}");
            // What light maps have of the lamp itself: its power over its area, of whatever direction.
            let at = DVec3::new(0.2, 0.1, 0.0).as_vec3a();
            let emitted = emitters.emitted_radiosity(0, DVec3::Z.as_vec3a(), side.as_vec3a(), at).r();
            let exact = if is_lit { parse(text).flux() / 683.0 } else { 0.0 };
            assert!((f64::from(emitted) - exact).abs() <= 1e-6 * exact, "{side} {emitted} {exact}");
        }
        for integrator in IntegratorDesc::ALL {
            let desc = RenderDesc { integrator, ..RenderDesc::default() };
            let made = Render::new(&scene, RenderSettings { desc, ..RenderSettings::default() }).map(|_| ());
            match (made, integrator) {
                (Err(error), IntegratorDesc::Radiosity) => {
                    assert!(error.to_string().contains("surfaces that shine by a photometric web"), "{error}");
                }
                (made, _) => made.unwrap_or_else(|error| panic!("{integrator:?}: {error}")),
            }
        }
    }
}
