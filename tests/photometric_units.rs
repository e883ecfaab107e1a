//! Light that a file gives in photometric units or by temperature, as the description has it and as it is saved.

use std::f64::consts::PI;

use etendue::desc::{self, SceneDesc};
use etendue::math::DVec3;
use etendue::photometry::planckian;
use etendue::spectrum::{LUMINANCE_WEIGHTS, Rgb, luminance};

const LAMP: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/data");

fn read(lights: &str, surfaces: &str) -> SceneDesc {
    let text = format!(
        r#"{{"etendue": 1, "camera": {{"origin": [0, 0, 5]}}, "lights": [{lights}], "surfaces": [{surfaces}],
            "materials": [{{"name": "lit", "type": "black", "luminance": 1366, "temperature": 4000}}]}}"#
    );
    desc::parse(&text, LAMP.as_ref(), None).unwrap_or_else(|error| panic!("{lights}: {error}"))
}

/// Luminance of a colour times 683, and whether it has this hue.
fn lumens(color: Rgb, hue: DVec3) -> f64 {
    let scale = color.to_f64() / hue;
    assert!((scale.max_element() / scale.min_element() - 1.0).abs() < 1e-6, "{color:?} is not of {hue:?}");
    683.0 * f64::from(luminance(color))
}

fn near(found: f64, expected: f64) {
    assert!((found / expected - 1.0).abs() < 1e-6, "{found}, expected {expected}");
}

#[test]
fn points_have_lumens_and_candela() {
    let white = DVec3::ONE;
    for (light, hue, candela) in [
        (r#""type": "point", "unit": "cd", "intensity": 120"#, white, 120.0),
        (r#""type": "point", "unit": "lm", "intensity": 800"#, white, 800.0 / (4.0 * PI)),
        (
            r#""type": "point", "unit": "lm", "intensity": 800, "color": [9, 4.5, 1.5]"#,
            DVec3::new(6.0, 3.0, 1.0),
            800.0 / (4.0 * PI),
        ),
        (r#""type": "point", "unit": "cd", "intensity": 5, "temperature": 2700"#, planckian(2700.0).unwrap(), 5.0),
        (r#""type": "point", "intensity": 2, "temperature": 6500"#, planckian(6500.0).unwrap(), 2.0 * 683.0),
        (r#""type": "point", "unit": "W", "intensity": 2, "color": [1, 1, 1]"#, white, 2.0 * 683.0),
        (r#""type": "spot", "direction": [0, -1, 0], "unit": "cd", "intensity": 9"#, white, 9.0),
        // A hard cone of 60 degrees has a solid angle of pi.
        (
            r#""type": "spot", "direction": [0, -1, 0], "unit": "lm", "intensity": 9, "outerConeAngle": 60, "innerConeAngle": 60"#,
            white,
            9.0 / PI,
        ),
        // A soft one to the horizon: of all in front of it a third.
        (
            r#""type": "spot", "direction": [0, -1, 0], "unit": "lm", "intensity": 9, "outerConeAngle": 90"#,
            white,
            9.0 / (2.0 * PI / 3.0),
        ),
    ] {
        let scene = read(&format!(r#"{{{light}, "origin": [0, 1, 0]}}"#), "");
        near(lumens(scene.lights[0].intensity, hue), candela);
    }
}

#[test]
fn a_measured_lamp_is_given_another_flux() {
    let scene =
        read(r#"{"type": "web", "file": "downlight.ies", "origin": [0, 1, 0], "unit": "lm", "intensity": 500}"#, "");
    let light = &scene.lights[0];
    let desc::LightDistribution::Web(web) = &light.distribution else { panic!("{light:?}") };
    near(f64::from(light.intensity.r()) * web.web.flux(), 500.0);
}

#[test]
fn light_from_infinity_has_lux_and_luminance() {
    let distant =
        read(r#"{"type": "distant", "sun": [0, 1, 0], "unit": "lx", "intensity": 100000, "temperature": 5800}"#, "");
    near(lumens(distant.distant_lights[0].irradiance, planckian(5800.0).unwrap()), 1e5);
    for (light, is_horizontal) in [
        (r#"{"type": "environment", "unit": "cd/m2", "intensity": 7000}"#, false),
        (r#"{"type": "sky", "cie": 1, "unit": "cd/m2", "intensity": 7000}"#, false),
        (r#"{"type": "sky", "cie": 1, "unit": "lx", "intensity": 7000}"#, true),
        (r#"{"type": "sky", "cie": 1, "unit": "lx", "scale": "horizontal", "intensity": 7000}"#, true),
    ] {
        let environment = read(light, "").environment.unwrap();
        near(lumens(environment.radiance, DVec3::ONE), 7000.0);
        if let desc::SkyDesc::Formula(sky) = environment.sky {
            assert_eq!(sky.is_horizontal, is_horizontal, "{light}");
        }
    }
}

#[test]
fn surfaces_have_luminance() {
    let area = |more: &str| {
        let light = format!(
            r#"{{"type": "area", "vertex-1": [0, 0, 0], "vertex-2": [2, 0, 0], "vertex-3": [0, 3, 0], {more}}}"#
        );
        read(&light, "").surfaces[0].emission.unwrap()
    };
    near(lumens(area(r#""unit": "cd/m2", "intensity": 250"#), DVec3::ONE), 250.0);
    // A Lambertian area of 3 m^2 sends pi times its luminance from each square metre.
    near(lumens(area(r#""unit": "lm", "intensity": 900"#), DVec3::ONE), 900.0 / (3.0 * PI));
    let ball = r#"{"geometry": "sphere", "origin": [0, 0, 0], "radius": 1"#;
    let own = read("", &format!(r#"{ball}, "luminance": 3000, "temperature": 3000}}"#));
    near(lumens(own.surfaces[0].emission.unwrap(), planckian(3000.0).unwrap()), 3000.0);
    let white = read("", &format!(r#"{ball}, "luminance": 683}}"#));
    near(lumens(white.surfaces[0].emission.unwrap(), DVec3::ONE), 683.0);
    let of_material = read("", &format!(r#"{ball}, "material": "lit"}}"#)).materials[0].emission.unwrap();
    near(lumens(of_material, planckian(4000.0).unwrap()), 1366.0);
    assert!((luminance(of_material) - 2.0).abs() < 1e-6);
    assert_eq!(LUMINANCE_WEIGHTS.element_sum(), 1.0);
}

#[test]
fn what_is_saved_is_read_back_as_the_same_bits() {
    let lights = [
        r#"{"type": "point", "origin": [0, 1, 0], "unit": "lm", "intensity": 806, "temperature": 2700}"#,
        r#"{"type": "spot", "origin": [0, 1, 0], "direction": [0, -1, 0], "unit": "lm", "intensity": 450, "color": [3, 2, 1]}"#,
        r#"{"type": "distant", "sun": [0, 1, 0], "unit": "lx", "intensity": 98765, "temperature": 5800}"#,
        r#"{"type": "sky", "cie": 12, "sun": [0, 1, 1], "unit": "lx", "intensity": 12345, "temperature": 14000}"#,
        r#"{"type": "area", "vertex-1": [0, 4, 0], "vertex-2": [1, 4, 0], "vertex-3": [0, 4, 1], "unit": "lm", "intensity": 99}"#,
    ]
    .join(",");
    let ball = r#"{"geometry": "sphere", "origin": [0, 0, 0], "radius": 1, "luminance": 3333, "temperature": 1900}"#;
    let scene = read(&lights, ball);
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("saved.json");
    scene.save(&file).unwrap();
    let again = desc::load(&file, None).unwrap();
    let bits = |color: Rgb| color.to_array().map(f32::to_bits);
    let all = |scene: &SceneDesc| {
        let emission = scene.surfaces.iter().filter_map(|surface| surface.emission).map(bits);
        let lights = scene.lights.iter().map(|light| bits(light.intensity));
        let materials = scene.materials.iter().filter_map(|material| material.emission).map(bits);
        let distant = scene.distant_lights.iter().map(|light| bits(light.irradiance));
        let sky = scene.environment.iter().map(|sky| bits(sky.radiance));
        emission.chain(lights).chain(materials).chain(distant).chain(sky).collect::<Vec<_>>()
    };
    assert_eq!(all(&scene), all(&again));
    assert!(all(&scene).len() >= 7);
    assert_eq!(scene.environment.unwrap().sky, again.environment.unwrap().sky);
}
