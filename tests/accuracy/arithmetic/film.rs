//! Films that are moved against the view axis, and pixels that are not square: which rays leave, and what a picture shows.

use etendue::camera::Camera;
use etendue::desc::{
    BsdfDesc, CameraDesc, FilmDesc, FocusDesc, FovAxis, KeyPlace, LensDesc, MotionDesc, MotionKey, Panorama,
    PanoramaDesc, RenderDesc, SceneDesc, ShapeDesc, ShutterDesc,
};
use etendue::math::{DQuat, DVec3};
use etendue::spectrum::Rgb;

use super::layers;
use crate::common::scenes::scene;
use crate::record::{Case, Entry, Within};

pub fn cases() -> Vec<Entry> {
    vec![
        Entry { id: "C78", title: "shifted films and pixel aspects, rays", run: rays },
        Entry { id: "C79", title: "shifted films and pixel aspects, pictures", run: pictures },
    ]
}

/// Columns and rows.
const SIZE: [u32; 2] = [40, 30];
const EYE: DVec3 = DVec3::new(3.0, -1.0, 2.0);
/// A right angle between axes that are none of the world's.
const FORWARD: DVec3 = DVec3::new(0.6, 0.0, -0.8);
const RIGHT: DVec3 = DVec3::new(0.8, 0.0, 0.6);
const UP: DVec3 = DVec3::Y;
/// Distance of the plane in focus, and of the plane whose points are compared.
const DEPTH: f64 = 4.0;

/// What a camera sees of the plane at [`DEPTH`]: the middle of the film from the view axis, and the sides of a pixel, all to the
/// right and upwards. Worked out from the words of the documents.
struct Window {
    middle: [f64; 2],
    pixel: [f64; 2],
}

impl Window {
    /// By the film, and by half of what the plane at `DEPTH` spans across `axis`.
    fn new(film: FilmDesc, half: f64, axis: FovAxis) -> Self {
        let [width, height] = SIZE.map(f64::from);
        let aspect = width * film.pixel_aspect / height;
        let [w, h] = match axis {
            FovAxis::Horizontal => [2.0 * half, 2.0 * half / aspect],
            FovAxis::Vertical => [2.0 * half * aspect, 2.0 * half],
        };
        Self { middle: [film.shift[0] * w, film.shift[1] * h], pixel: [w / width, h / height] }
    }

    /// Where the plane is met at a film position.
    fn at(&self, x: f64, y: f64) -> [f64; 2] {
        let [columns, rows] = SIZE.map(f64::from);
        [self.middle[0] + (x - 0.5 * columns) * self.pixel[0], self.middle[1] + (0.5 * rows - y) * self.pixel[1]]
    }

    /// The film position at which a point of the plane is seen.
    fn seen(&self, [right, up]: [f64; 2]) -> [f64; 2] {
        let [columns, rows] = SIZE.map(f64::from);
        [0.5 * columns + (right - self.middle[0]) / self.pixel[0], 0.5 * rows - (up - self.middle[1]) / self.pixel[1]]
    }
}

/// The cameras of a film: their names, descriptions, and windows.
fn cameras(film: FilmDesc) -> Vec<(&'static str, CameraDesc, Window)> {
    let (eye, look_at, up, fov_deg) = (EYE, EYE + 5.0 * FORWARD, UP, 50.0);
    let half = DEPTH * 25_f64.to_radians().tan();
    let lens = LensDesc { focus: FocusDesc::Distance(DEPTH), ..LensDesc::new(0.3) };
    let (wide, high) = (FovAxis::Horizontal, FovAxis::Vertical);
    vec![
        (
            "angle across the width",
            CameraDesc::Perspective { eye, look_at, up, fov_deg, fov_axis: wide, film },
            Window::new(film, half, wide),
        ),
        (
            "angle across the height",
            CameraDesc::Perspective { eye, look_at, up, fov_deg, fov_axis: high, film },
            Window::new(film, half, high),
        ),
        (
            "lens",
            CameraDesc::ThinLens { eye, look_at, up, fov_deg, fov_axis: wide, lens, film },
            Window::new(film, half, wide),
        ),
        (
            "parallel rays",
            CameraDesc::Orthographic { eye, look_at, up, size: 3.0, axis: high, film },
            Window::new(film, 1.5, high),
        ),
    ]
}

const FILMS: [(&str, FilmDesc); 4] = [
    ("shift of a third and -0.5", FilmDesc { shift: [1.0 / 3.0, -0.5], pixel_aspect: 1.0 }),
    ("aspect of 1.6", FilmDesc { shift: [0.0, 0.0], pixel_aspect: 1.6 }),
    ("aspect of 0.5, shift of -1 and 0.25", FilmDesc { shift: [-1.0, 0.25], pixel_aspect: 0.5 }),
    ("shift of 20", FilmDesc { shift: [0.0, 20.0], pixel_aspect: 1.0 }),
];

fn rays(case: &mut Case) {
    for (film_name, film) in FILMS {
        for (name, desc, window) in cameras(film) {
            let what = format!("{film_name}, {name}");
            let camera = Camera::new(&desc, SIZE, EYE).expect("a camera of the test");
            let (mut off, mut back) = (0.0_f64, 0.0_f64);
            // In pixels, however far off the axis the plane is met.
            let reach = (window.middle[0] / window.pixel[0]).hypot(window.middle[1] / window.pixel[1]).max(40.0);
            for (x, y) in (0..=20).flat_map(|x| (0..=20).map(move |y| (2.0 * f64::from(x), 1.5 * f64::from(y)))) {
                let exact = window.at(x, y);
                let lenses = [[0.5, 0.5], [0.1, 0.3], [0.95, 0.6]];
                for u in lenses {
                    let ray = camera.ray_through_lens(x as f32, y as f32, u);
                    let (origin, direction) = (ray.origin.as_dvec3(), ray.direction.as_dvec3());
                    let met = origin + direction * ((DEPTH - origin.dot(FORWARD)) / direction.dot(FORWARD));
                    let right = (met.dot(RIGHT) - exact[0]) / window.pixel[0];
                    let above = (met.dot(UP) - exact[1]) / window.pixel[1];
                    off = off.max(right.hypot(above));
                }
                let ray = camera.ray(x as f32, y as f32);
                let [u, v] = camera.film_position(ray.at(7.0)).unwrap_or([f32::NAN; 2]);
                back = back.max((f64::from(u) - x).hypot(f64::from(v) - y));
            }
            case.at_most(format!("{what}: plane in focus, pixels off"), off, 3e-6 * reach);
            case.at_most(format!("{what}: film position, pixels off"), back, 3e-6 * reach);
            let side = window.pixel[0].max(window.pixel[1]);
            let far = window.at(20.0, 15.0);
            let is_parallel = name == "parallel rays";
            // A pixel is as wide as its wider side where its ray meets the plane, across the ray.
            let slant = (far[0].hypot(far[1]) / DEPTH).hypot(1.0);
            let cone = f64::from(camera.cone(20.0, 15.0).after((DEPTH * slant) as f32).width());
            let at_plane = f64::from(camera.pixel_width(20.0, 15.0).at((DEPTH * slant) as f32));
            let [x, y] = if window.pixel[0] >= window.pixel[1] { [21.0, 15.0] } else { [20.0, 16.0] };
            let next = window.at(x, y);
            let directions = [far, next].map(|[right, up]| (right * RIGHT + up * UP + DEPTH * FORWARD).normalize());
            let exact = if is_parallel { side } else { DEPTH * slant * (directions[0] - directions[1]).length() };
            // Cones keep eight bits.
            case.exact(format!("{what}: footprint"), cone, side, Within::Relative(4e-3));
            case.exact(format!("{what}: width of a pixel"), at_plane, exact, Within::Relative(2e-6 * reach));
        }
    }
    for (kind, aspect) in [(Panorama::Cylindrical, 1.6), (Panorama::Fisheye, 1.6), (Panorama::Fisheye, 0.5)] {
        let panorama = PanoramaDesc { fov_deg: 120.0, pixel_aspect: aspect, ..PanoramaDesc::new(kind) };
        let (eye, look_at, up) = (EYE, EYE + FORWARD, UP);
        let camera = Camera::new(&CameraDesc::Panoramic { eye, look_at, up, panorama }, SIZE, EYE)
            .expect("a camera of the test");
        // Directly above the middle, and to the right of it, by a quarter of the height and of the width.
        let [above, right] = [camera.ray(20.0, 7.5), camera.ray(30.0, 15.0)].map(|ray| ray.direction.as_dvec3());
        let width = 4.0 / 3.0 * aspect;
        let towards = |sine: f64| 2.0 * (sine * 30_f64.to_radians().sin()).asin();
        let (elevation, longitude) = match kind {
            Panorama::Fisheye => (towards(0.5), towards(0.5 * width)),
            _ => ((0.5 * 60_f64.to_radians() / width).atan(), 30_f64.to_radians()),
        };
        let what = format!("{kind:?}, aspect of {aspect}");
        let degrees = |sine: f64, cosine: f64| sine.atan2(cosine).to_degrees();
        let within = Within::Relative(1e-6);
        let found = degrees(above.dot(UP), above.dot(FORWARD));
        case.exact(format!("{what}: elevation, degrees"), found, elevation.to_degrees(), within);
        // The image of a fisheye with such pixels may end before this place.
        if camera.sees(30.0, 15.0) {
            let found = degrees(right.dot(RIGHT), right.dot(FORWARD));
            case.exact(format!("{what}: longitude, degrees"), found, longitude.to_degrees(), within);
        }
    }
}

/// A light of half the sides `half` around the point of a plane across the view, at a distance.
fn lit(camera: CameraDesc, depth: f64, [right, up]: [f64; 2], half: [f64; 2]) -> SceneDesc {
    let at = |x: f64, y: f64| EYE + depth * FORWARD + (right + half[0] * x) * RIGHT + (up + half[1] * y) * UP;
    let corners = [at(-1.0, -1.0), at(1.0, -1.0), at(1.0, 1.0), at(-1.0, 1.0)];
    let half = |i: usize, j: usize| ShapeDesc::Triangle([corners[0], corners[i], corners[j]]);
    let light = Some(Rgb::ONE);
    scene(camera, vec![(half(1, 2), BsdfDesc::Black, light), (half(2, 3), BsdfDesc::Black, light)])
}

/// Pixels that a light covers in a picture, and column and row of its middle.
fn seen(desc: &SceneDesc, samples: u64) -> [f64; 3] {
    let image = layers(desc, RenderDesc { resolution: SIZE, samples: samples as u32, ..RenderDesc::default() });
    let (mut sum, mut x, mut y) = (0.0, 0.0, 0.0);
    for (i, value) in image.rgb.iter().step_by(3).map(|value| f64::from(*value)).enumerate() {
        let i = i as u32;
        sum += value;
        x += value * (f64::from(i % SIZE[0]) + 0.5);
        y += value * (f64::from(i / SIZE[0]) + 0.5);
    }
    [sum, x / sum, y / sum]
}

fn pictures(case: &mut Case) {
    let samples = case.count(256, 4096);
    for (film_name, film) in &FILMS[..3] {
        for (name, desc, window) in cameras(*film) {
            let what = format!("{film_name}, {name}");
            // A light that is five by four pixels, in front of a place of the film that is no middle of a pixel.
            let middle = window.at(15.3, 18.85);
            let half = [2.5 * window.pixel[0], 2.0 * window.pixel[1]];
            let [covered, x, y] = seen(&lit(desc, DEPTH, middle, half), samples);
            case.exact(format!("{what}: pixels that a light covers"), covered, 20.0, Within::Relative(1e-3));
            case.exact(format!("{what}: column of its middle"), x, 15.3, Within::Absolute(4e-3));
            case.exact(format!("{what}: row of its middle"), y, 18.85, Within::Absolute(4e-3));
        }
    }
    // A tower whose sides lean inwards where the camera is tilted. Its edges are upright in a picture of a level camera.
    let film = FilmDesc { shift: [0.0, 0.6], pixel_aspect: 1.0 };
    let [(_, level, window), ..] = &cameras(film)[..] else { unreachable!("there are several cameras") };
    let tall = lit(*level, DEPTH, [0.4, 5.0], [0.9, 50.0]);
    let image = layers(&tall, RenderDesc { resolution: SIZE, samples: samples as u32, ..RenderDesc::default() });
    let exact = 2.0 * 0.9 / window.pixel[0];
    for (name, row) in [("top", 0_u32), ("bottom", 29)] {
        let values = (0..SIZE[0]).map(|x| f64::from(image.pixel(x, row)[0]));
        let width: f64 = values.clone().sum();
        let middle = values.enumerate().map(|(x, value)| value * (x as f64 + 0.5)).sum::<f64>() / width;
        case.exact(format!("tower, {name} row: width, pixels"), width, exact, Within::Relative(3e-3));
        let [column, _] = window.seen([0.4, 0.0]);
        case.exact(format!("tower, {name} row: column of its middle"), middle, column, Within::Absolute(2e-2));
    }
    // A shutter that is open while the camera moves by 0.4 to the right: the light is where it is seen from the middle.
    let film = FilmDesc { shift: [0.25, -0.4], pixel_aspect: 0.8 };
    for (name, desc, window) in cameras(film) {
        let middle = window.at(19.0, 12.5);
        let half = [2.5 * window.pixel[0], 2.0 * window.pixel[1]];
        let mut moving = lit(desc, DEPTH, middle, half);
        let key = |time: f64, translation: DVec3| MotionKey {
            time,
            place: KeyPlace::Parts { translation, rotation: DQuat::IDENTITY, scale: DVec3::ONE },
        };
        let keys = vec![key(0.0, DVec3::ZERO), key(1.0, 0.4 * RIGHT)];
        moving.set_camera_motion(Some(MotionDesc { keys })).expect("a motion of the test");
        moving.set_shutter(ShutterDesc { open: 0.0, close: 1.0, curve: Vec::new() }).expect("a shutter of the test");
        let [covered, x, y] = seen(&moving, samples);
        let [column, row] = window.seen([middle[0] - 0.2, middle[1]]);
        case.exact(format!("moving camera, {name}: pixels that a light covers"), covered, 20.0, Within::Relative(3e-3));
        case.exact(format!("moving camera, {name}: column of its middle"), x, column, Within::Absolute(1e-2));
        case.exact(format!("moving camera, {name}: row of its middle"), y, row, Within::Absolute(1e-2));
    }
}
