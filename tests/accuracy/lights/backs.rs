//! The sides of lamps that do not shine.

use std::path::Path;

use etendue::desc::{self, SceneDesc};
use etendue::math::{DAffine3, DMat3, DVec3};

use super::sky::{METHODS, drawn};
use crate::common::scenes::camera;
use crate::record::{Case, Entry};

pub fn cases() -> Vec<Entry> {
    vec![Entry { id: "L69", title: "backs of lamps that reflect", run: backs }]
}

/// Lamps that reflect, each with an eye that sees their backs alone.
const LAMPS: [(&str, &str, DVec3); 5] = [
    (
        "triangle",
        r#""geometry": "triangle", "vertex-1": [-3, -2, 0], "vertex-2": [4, -2, 0.3], "vertex-3": [0, 5, 0.1]"#,
        DVec3::new(0.3, 0.2, -4.0),
    ),
    (
        "quad",
        r#""geometry": "quad", "vertex-1": [-3, -2, 0.2], "vertex-2": [4, -2, 0.2], "vertex-3": [4, 5, 0.7], "vertex-4": [-3, 5, 0.7]"#,
        DVec3::new(0.3, 0.2, -4.0),
    ),
    (
        "disk",
        r#""geometry": "disk", "origin": [0.1, 0.2, 0.3], "normal": [0.3, 0.2, 1], "radius": 4"#,
        DVec3::new(0.0, 0.0, -4.0),
    ),
    ("sphere", r#""geometry": "sphere", "origin": [0.1, 0.2, 0.3], "radius": 4"#, DVec3::new(0.0, 0.0, -1.0)),
    (
        "tube",
        r#""geometry": "cylinder", "base": [0.1, 0.2, -4], "axis": [0.1, 0.3, 1], "radius": 1.5, "height": 9"#,
        DVec3::new(0.1, 0.2, -3.0),
    ),
];

fn scene(shape: &str, eye: DVec3, transform: DAffine3) -> SceneDesc {
    let text = format!(
        r#"{{
            "etendue": 1,
            "camera": {{}},
            "materials": [{{"name": "white", "type": "diffuse", "color": [0.8, 0.8, 0.8]}}],
            "surfaces": [{{{shape}, "material": "white", "emission": [1, 1, 1]}}]
        }}"#
    );
    let mut desc = desc::parse(&text, Path::new("."), None).expect("a scene of the test");
    desc.set_transform(0, transform).expect("a transform of the test");
    let place = |p| transform.transform_point3(p);
    desc.camera = camera(place(eye), place(eye + DVec3::new(0.1, 0.05, 1.0)), 60.0);
    desc
}

/// A lamp alone shines on nothing, so that its back is black: all light there would be the lamp's own.
fn backs(case: &mut Case) {
    let samples = case.count(4, 256) as u32;
    let turn = DMat3::from_axis_angle(DVec3::new(1.0, 2.0, 3.0).normalize(), 0.7);
    for (what, shape, eye) in LAMPS {
        for (place, matrix3, translation) in [
            ("", DMat3::IDENTITY, DVec3::ZERO),
            (", turned", turn, DVec3::ZERO),
            (", smaller", 0.37 * turn, DVec3::new(1.0, -2.0, 0.3)),
            (", far away", turn, DVec3::new(813.0, -391.0, 1207.0)),
        ] {
            let (mut lit, mut all) = (0, 0);
            for (integrator, _) in METHODS {
                let image = drawn(case, &scene(shape, eye, DAffine3 { matrix3, translation }), integrator, samples);
                lit += image.rgb.iter().filter(|&&value| value != 0.0).count();
                all += image.rgb.len();
            }
            case.never(format!("{what}{place}"), lit as u64, all as u64);
        }
    }
}
