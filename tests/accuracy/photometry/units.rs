//! Light in photometric units, and colours by temperature.

use std::f64::consts::PI;

use etendue::desc::{self, IntegratorDesc};
use etendue::math::DVec3;
use etendue::photometry::planckian;

use serde_json::json;

use super::{build, illuminance, value};
use crate::lights::polygon_factor;
use crate::record::{Case, Entry, Within};

pub fn cases() -> Vec<Entry> {
    vec![
        Entry { id: "Y11", title: "lights in photometric units", run: lights },
        Entry { id: "Y12", title: "colours by temperature", run: temperatures },
    ]
}

fn lights(case: &mut Case) {
    let samples = case.count(16_384, 262_144) as u32;
    let at = |height: f64| (DVec3::new(0.0, 0.0, height), DVec3::Z);
    for (what, light, expected) in [
        (
            "800 lm of a point, 2 m below",
            r#"{"type": "point", "unit": "lm", "intensity": 800, "temperature": 2700}"#,
            800.0 / (4.0 * PI) / 4.0,
        ),
        (
            "90 cd of a point, 2 m below",
            r#"{"type": "point", "unit": "cd", "intensity": 90, "color": [3, 2, 1]}"#,
            22.5,
        ),
        (
            "300 lm of a cone of 60 degrees, 2 m below",
            r#"{"type": "spot", "direction": [0, 0, -1], "unit": "lm", "intensity": 300, "outerConeAngle": 60, "innerConeAngle": 60}"#,
            300.0 / PI / 4.0,
        ),
        (
            "300 lm of a soft cone of 90 degrees, 2 m below",
            r#"{"type": "spot", "direction": [0, 0, -1], "unit": "lm", "intensity": 300, "outerConeAngle": 90}"#,
            300.0 / (2.0 * PI / 3.0) / 4.0,
        ),
        (
            "50 klx of parallel light",
            r#"{"type": "distant", "sun": [0, 0, 1], "unit": "lx", "intensity": 50000, "temperature": 5800}"#,
            5e4,
        ),
        (
            "sky of 12 klx",
            r#"{"type": "sky", "cie": 12, "sun": [1, 0, 2], "up": [0, 0, 1], "unit": "lx", "intensity": 12000, "temperature": 12000}"#,
            12e3,
        ),
        ("even sky of 3000 cd/m2", r#"{"type": "environment", "unit": "cd/m2", "intensity": 3000}"#, 3e3 * PI),
    ] {
        let light = if light.contains("point") || light.contains("spot") {
            light.replacen('{', "{\"origin\": [0, 0, 2], ", 1)
        } else {
            light.to_owned()
        };
        let text =
            format!(r#"{{"etendue": 1, "camera": {{"origin": [0, 0, 9], "lookAt": [1, 0, 0]}}, "lights": [{light}]}}"#);
        let scene = build(&desc::parse(&text, "".as_ref(), None).expect("a scene of the test"));
        let found = illuminance(&scene, &[at(0.0)], samples, IntegratorDesc::Path);
        case.mean(format!("{what}, lx"), value(&found, 0), expected, 3e-3);
    }
    let triangle = [[-1.0, -1.0, 2.0], [-1.0, 2.0, 2.0], [1.0, 0.0, 2.0]];
    let area = json!({"type": "area", "vertex-1": triangle[0], "vertex-2": triangle[1], "vertex-3": triangle[2],
        "unit": "lm", "intensity": 900, "temperature": 4000});
    let ball =
        json!({"geometry": "sphere", "origin": [0, 0, 2], "radius": 0.5, "luminance": 3000, "temperature": 3000});
    let corners = triangle.map(DVec3::from_array);
    let of_area = 900.0 / (PI * 3.0) * PI * polygon_factor(DVec3::ZERO, DVec3::Z, &corners);
    for (what, key, element, expected) in [
        ("900 lm of a triangle, 2 m below", "lights", area, of_area),
        ("ball of 3000 cd/m2, 4 radii below", "surfaces", ball, 3000.0 * PI / 16.0),
    ] {
        let text = json!({"etendue": 1, "camera": {"origin": [0, 0, 9], "lookAt": [1, 0, 0]}, key: [element]});
        let scene = build(&desc::parse(&text.to_string(), "".as_ref(), None).expect("a scene of the test"));
        let found = illuminance(&scene, &[at(0.0)], samples, IntegratorDesc::Path);
        case.mean(format!("{what}, lx"), value(&found, 0), expected, 3e-3);
    }
}

/// The CIE 1931 standard observer from 380 to 780 nm in steps of 10 nm (CIE 15).
const OBSERVER: [[f64; 3]; 41] = [
    [0.001368, 0.000039, 0.006450],
    [0.004243, 0.000120, 0.020050],
    [0.014310, 0.000396, 0.067850],
    [0.043510, 0.001210, 0.207400],
    [0.134380, 0.004000, 0.645600],
    [0.283900, 0.011600, 1.385600],
    [0.348280, 0.023000, 1.747060],
    [0.336200, 0.038000, 1.772110],
    [0.290800, 0.060000, 1.669200],
    [0.195360, 0.090980, 1.287640],
    [0.095640, 0.139020, 0.812950],
    [0.032010, 0.208020, 0.465180],
    [0.004900, 0.323000, 0.272000],
    [0.009300, 0.503000, 0.158200],
    [0.063270, 0.710000, 0.078250],
    [0.165500, 0.862000, 0.042160],
    [0.290400, 0.954000, 0.020300],
    [0.433450, 0.994950, 0.008750],
    [0.594500, 0.995000, 0.003900],
    [0.762100, 0.952000, 0.002100],
    [0.916300, 0.870000, 0.001650],
    [1.026300, 0.757000, 0.001100],
    [1.062200, 0.631000, 0.000800],
    [1.002600, 0.503000, 0.000340],
    [0.854450, 0.381000, 0.000190],
    [0.642400, 0.265000, 0.000050],
    [0.447900, 0.175000, 0.000020],
    [0.283500, 0.107000, 0.0],
    [0.164900, 0.061000, 0.0],
    [0.087400, 0.032000, 0.0],
    [0.046770, 0.017000, 0.0],
    [0.022700, 0.008210, 0.0],
    [0.011359, 0.004102, 0.0],
    [0.005790, 0.002091, 0.0],
    [0.002899, 0.001047, 0.0],
    [0.001440, 0.000520, 0.0],
    [0.000690, 0.000249, 0.0],
    [0.000332, 0.000120, 0.0],
    [0.000166, 0.000060, 0.0],
    [0.000083, 0.000030, 0.0],
    [0.000042, 0.000015, 0.0],
];

/// u and v of CIE 1960 of a tristimulus value.
fn uv(xyz: DVec3) -> [f64; 2] {
    let sum = xyz.x + 15.0 * xyz.y + 3.0 * xyz.z;
    [4.0 * xyz.x / sum, 6.0 * xyz.y / sum]
}

fn temperatures(case: &mut Case) {
    let (mut sums, mut worst) = (DVec3::ZERO, 0.0_f64);
    OBSERVER.iter().for_each(|xyz| sums += DVec3::from_array(*xyz));
    case.exact(
        "table of the observer: x of the equal-energy spectrum",
        sums.x / sums.element_sum(),
        1.0 / 3.0,
        Within::Absolute(1e-4),
    );
    for step in 0..=130 {
        let kelvin = 2000.0 + 100.0 * f64::from(step);
        let planck = |i: usize| {
            let metres = (380.0 + 10.0 * i as f64) * 1e-9;
            metres.powi(-5) / (0.014_387_769 / (metres * kelvin)).exp_m1()
        };
        let mut xyz = DVec3::ZERO;
        OBSERVER.iter().enumerate().for_each(|(i, observed)| xyz += DVec3::from_array(*observed) * planck(i));
        let color = planckian(kelvin).expect("a temperature in range");
        // Back to tristimulus values: IEC 61966-2-1.
        let found = DVec3::new(
            DVec3::new(0.412_456_4, 0.357_576_1, 0.180_437_5).dot(color),
            DVec3::new(0.212_672_9, 0.715_152_2, 0.072_175_0).dot(color),
            DVec3::new(0.019_333_9, 0.119_192_0, 0.950_304_1).dot(color),
        );
        let off = [0, 1].map(|axis| (uv(found)[axis] - uv(xyz)[axis]).abs());
        worst = worst.max(off[0]).max(off[1]);
    }
    case.at_most("farthest chromaticity from 2000 to 15000 K, in u or v of CIE 1960", worst, 2e-4);
}
