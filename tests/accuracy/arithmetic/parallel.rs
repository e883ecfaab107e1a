//! Orthographic cameras: what a pixel sees.

use etendue::camera::Camera;
use etendue::desc::{BsdfDesc, CameraDesc, FilmDesc, FovAxis, RenderDesc, SceneDesc, ShapeDesc};
use etendue::film::Image;
use etendue::math::DVec3;
use etendue::spectrum::Rgb;

use super::layers;
use crate::common::scenes::scene;
use crate::record::{Case, Entry, Within};

pub fn cases() -> Vec<Entry> {
    vec![Entry { id: "C74", title: "orthographic camera", run: parallel }]
}

/// Columns and rows.
const SIZE: [u32; 2] = [32, 20];

/// A right angle between axes that are none of the world's.
const FORWARD: DVec3 = DVec3::new(0.6, 0.0, -0.8);
const RIGHT: DVec3 = DVec3::new(0.8, 0.0, 0.6);
const EYE: DVec3 = DVec3::new(3.0, -1.0, 2.0);

fn desc(size: f64, axis: FovAxis) -> CameraDesc {
    CameraDesc::Orthographic {
        eye: EYE,
        look_at: EYE + 5.0 * FORWARD,
        up: DVec3::new(0.1, 2.0, 0.1),
        size,
        axis,
        film: FilmDesc::default(),
    }
}

/// A light of `half` to each side around the point that is `right` and `up` of the middle at distance `depth`.
fn lit(camera: CameraDesc, depth: f64, [right, up]: [f64; 2], half: f64) -> SceneDesc {
    let above = RIGHT.cross(FORWARD);
    let at = |x: f64, y: f64| EYE + depth * FORWARD + (right + half * x) * RIGHT + (up + half * y) * above;
    let corners = [at(-1.0, -1.0), at(1.0, -1.0), at(1.0, 1.0), at(-1.0, 1.0)];
    let half = |i: usize, j: usize| ShapeDesc::Triangle([corners[0], corners[i], corners[j]]);
    let light = Some(Rgb::ONE);
    scene(camera, vec![(half(1, 2), BsdfDesc::Black, light), (half(2, 3), BsdfDesc::Black, light)])
}

fn picture(desc: &SceneDesc, samples: u64) -> Image {
    layers(desc, RenderDesc { resolution: SIZE, samples: samples as u32, ..RenderDesc::default() })
}

fn parallel(case: &mut Case) {
    let up = DVec3::new(0.1, 2.0, 0.1);
    let right = FORWARD.cross(up).normalize();
    let above = right.cross(FORWARD);
    for (name, size, axis, pixel) in [
        ("width of 8", 8.0, FovAxis::Horizontal, 0.25),
        ("height of 5", 5.0, FovAxis::Vertical, 0.25),
        ("width of 0.002", 2e-3, FovAxis::Horizontal, 6.25e-5),
    ] {
        let camera = Camera::new(&desc(size, axis), SIZE, EYE).expect("a camera of the test");
        let (mut off, mut turned) = (0.0_f64, 0.0_f64);
        for (x, y) in (0..=32).flat_map(|x| (0..=20).map(move |y| (f64::from(x), f64::from(y)))) {
            let ray = camera.ray(x as f32, y as f32);
            let exact = pixel * ((x - 16.0) * right + (10.0 - y) * above);
            off = off.max((ray.origin.as_dvec3() - exact).length() / pixel);
            turned = turned.max((ray.direction.as_dvec3() - FORWARD).length());
        }
        case.at_most(format!("{name}: start of a ray, pixels off"), off, 1e-5);
        case.at_most(format!("{name}: direction of a ray, off"), turned, 1e-7);
        let cone = camera.cone(3.0, 7.0);
        let width = f64::from(cone.after(100.0).width());
        // Cones keep eight bits.
        case.exact(format!("{name}: footprint at distance 100"), width, pixel, Within::Relative(4e-3));
        let wide = f64::from(camera.pixel_width(5.0, 1.0).at(1e3));
        case.exact(format!("{name}: width of a pixel at distance 1000"), wide, pixel, Within::Relative(1e-6));
    }
    // A light at any distance covers the same pixels.
    let straight = CameraDesc::Orthographic {
        eye: EYE,
        look_at: EYE + 5.0 * FORWARD,
        up: DVec3::Y,
        size: 8.0,
        axis: FovAxis::Horizontal,
        film: FilmDesc::default(),
    };
    let samples = case.count(256, 4096);
    for depth in [0.5, 40.0, 3000.0] {
        let image = picture(&lit(straight, depth, [0.3, -0.55], 1.1), samples);
        let sum: f64 = image.rgb.iter().step_by(3).map(|value| f64::from(*value)).sum();
        let covered = 2.2 * 2.2 / (0.25 * 0.25);
        case.exact(format!("light at {depth}: pixels that it covers"), sum, covered, Within::Relative(1e-3));
        // By the middles of pixels: of the columns from 12 to 21, the first is covered to 0.2 and the last to 0.6.
        let column = |place: f64| {
            let values = image.rgb.iter().step_by(3).enumerate();
            let moment: f64 =
                values.map(|(i, value)| f64::from(*value) * ((i as u32 % SIZE[0]) as f64 + 0.5 - place)).sum();
            place + moment / sum
        };
        case.exact(
            format!("light at {depth}: column of its middle"),
            column(17.2),
            151.4 / 8.8,
            Within::Absolute(4e-3),
        );
        let depths = &image.layer("depth").expect("an auxiliary layer").data;
        // The middle of the light.
        let seen = f64::from(depths[(12 * SIZE[0] + 17) as usize]);
        case.exact(format!("light at {depth}: its depth"), seen, depth, Within::Relative(1e-6));
    }
    let behind = picture(&lit(straight, -0.5, [0.0; 2], 1.0), 16);
    case.exact(
        "light behind the plane",
        f64::from(behind.rgb.iter().copied().fold(0.0, f32::max)),
        0.0,
        Within::Absolute(0.0),
    );
}
