//! Panoramic cameras: what share of the image each side of a cube around the eye has.

use std::f64::consts::{FRAC_PI_2, PI};

use etendue::camera::Camera;
use etendue::desc::{BsdfDesc, CameraDesc, FovAxis, IntegratorDesc, Panorama, PanoramaDesc, SceneDesc, ShapeDesc};
use etendue::math::{DVec3, Vec3};
use etendue::spectrum::Rgb;

use crate::common::scenes::{Job, render, scene};
use crate::record::{Case, Entry, Within};

pub fn cases() -> Vec<Entry> {
    vec![
        Entry { id: "C76", title: "panoramic cameras, directions", run: directions },
        Entry { id: "C77", title: "panoramic cameras, a cube around the eye", run: cube },
    ]
}

const SIZE: [u32; 2] = [64, 32];

fn look(kind: Panorama, fov_deg: f64, fov_axis: FovAxis) -> CameraDesc {
    let panorama = PanoramaDesc { kind, fov_deg, fov_axis, pixel_aspect: 1.0 };
    CameraDesc::Panoramic { eye: DVec3::ZERO, look_at: DVec3::NEG_Z, up: DVec3::Y, panorama }
}

/// The direction at a place of the image, right, up and forwards from its middle in halves of its sides, by the document's words.
fn direction(kind: Panorama, fov: f64, [right, up]: [f64; 2], aspect: f64) -> Option<DVec3> {
    let towards = |longitude: f64, y: f64, flat: f64| DVec3::new(flat * longitude.sin(), y, -flat * longitude.cos());
    match kind {
        Panorama::Spherical => Some(towards(PI * right, (FRAC_PI_2 * up).sin(), (FRAC_PI_2 * up).cos())),
        Panorama::Cylindrical => Some(towards(0.5 * fov * right, 0.5 * fov / aspect * up, 1.0).normalize()),
        Panorama::Fisheye => {
            let (x, y) = (right * aspect, up);
            let r = x.hypot(y);
            let angle = 2.0 * (r * (0.25 * fov).sin()).asin();
            (r <= 1.0).then(|| DVec3::new(angle.sin() * x / r, angle.sin() * y / r, -angle.cos()))
        }
    }
}

fn directions(case: &mut Case) {
    let aspect = f64::from(SIZE[0]) / f64::from(SIZE[1]);
    for (kind, degrees) in [
        (Panorama::Spherical, 360.0),
        (Panorama::Cylindrical, 360.0),
        (Panorama::Cylindrical, 100.0),
        (Panorama::Fisheye, 180.0),
        (Panorama::Fisheye, 360.0),
        (Panorama::Fisheye, 0.5),
    ] {
        let camera =
            Camera::new(&look(kind, degrees, FovAxis::Vertical), SIZE, DVec3::ZERO).expect("a camera of the test");
        let (mut off, mut back, mut wrong, mut seen) = (0.0_f64, 0.0_f64, 0, 0);
        for (x, y) in (0..128).flat_map(|x| (0..64).map(move |y| (0.5 * x as f32 + 0.26, 0.5 * y as f32 + 0.24))) {
            let place = [f64::from(x) / 32.0 - 1.0, 1.0 - f64::from(y) / 16.0];
            let exact = direction(kind, f64::to_radians(degrees), place, aspect);
            wrong += u64::from(camera.sees(x, y) != exact.is_some());
            let Some(exact) = exact else { continue };
            seen += 1;
            let ray = camera.ray(x, y);
            off = off.max((ray.direction.as_dvec3() - exact).length());
            let [u, v] = camera.film_position(ray.at(3.0)).unwrap_or([f32::NAN; 2]);
            back = back.max(f64::from((u - x).abs().max((v - y).abs())));
        }
        let what = format!("{kind:?}, {degrees} degrees");
        // At the rim of a whole turn, directions change without bound by the place.
        case.at_most(
            format!("{what}: direction off"),
            off,
            if degrees == 360.0 && kind == Panorama::Fisheye { 3e-5 } else { 5e-7 },
        );
        // Rounding of a direction is many pixels of a narrow image.
        case.at_most(
            format!("{what}: film position of what a ray meets, pixels off"),
            back,
            1e-6 + 2e-3 / degrees.min(90.0) * 90.0 / 10.0,
        );
        case.never(format!("{what}: seen or not seen"), wrong, 128 * 64);
        case.exact(
            format!("{what}: places seen"),
            f64::from(seen) / 8192.0,
            if kind == Panorama::Fisheye { PI / 8.0 } else { 1.0 },
            Within::Absolute(2e-3),
        );
        // A point before a fisheye with a narrow angle is not behind it.
        if degrees == 0.5 {
            case.exact(
                "a point behind: not seen",
                f64::from(u8::from(camera.film_position(Vec3::Z).is_some())),
                0.0,
                Within::Absolute(0.0),
            );
        }
    }
}

/// A cube around the eye, of which one side shines: left, right, below, above, ahead or behind.
fn lit(camera: CameraDesc, side: usize) -> SceneDesc {
    let (axis, sign) = (side / 2, if side.is_multiple_of(2) { -1.0 } else { 1.0 });
    let at = |a: f64, b: f64| {
        let mut p = DVec3::ZERO;
        p[axis] = sign;
        p[(axis + 1) % 3] = a;
        p[(axis + 2) % 3] = b;
        p
    };
    let corners = [at(-1.0, -1.0), at(1.0, -1.0), at(1.0, 1.0), at(-1.0, 1.0)];
    // The normal is towards the eye.
    let corners = if sign > 0.0 { [corners[0], corners[3], corners[2], corners[1]] } else { corners };
    scene(camera, vec![(ShapeDesc::Quad(corners), BsdfDesc::Black, Some(Rgb::ONE))])
}

/// The mean of a function over the circle.
fn around(f: impl Fn(f64) -> f64) -> f64 {
    const N: u32 = 100_000;
    (0..N).map(|i| f(2.0 * PI * (f64::from(i) + 0.5) / f64::from(N))).sum::<f64>() / f64::from(N)
}

fn cube(case: &mut Case) {
    let aspect = f64::from(SIZE[0]) / f64::from(SIZE[1]);
    // What of a longitude the upper side covers: all that is higher than this.
    let edge = |t: f64| t.sin().abs().max(t.cos().abs());
    let above = around(|t| FRAC_PI_2 - edge(t).atan()) / PI;
    let high = PI / aspect;
    let upper = around(|t| (high - edge(t)).max(0.0)) / (2.0 * high);
    let circle = PI / 4.0 / aspect;
    let beside = |above: f64| (1.0 - 2.0 * above) / 4.0;
    for (kind, degrees, axis, shares) in [
        (
            Panorama::Spherical,
            360.0,
            FovAxis::Horizontal,
            [beside(above), beside(above), above, above, beside(above), beside(above)],
        ),
        (
            Panorama::Cylindrical,
            360.0,
            FovAxis::Horizontal,
            [beside(upper), beside(upper), upper, upper, beside(upper), beside(upper)],
        ),
        // Equal solid angles are equal shares of the circle.
        (Panorama::Fisheye, 360.0, FovAxis::Vertical, [circle / 6.0; 6]),
        (
            Panorama::Fisheye,
            180.0,
            FovAxis::Vertical,
            [1.0 / 6.0, 1.0 / 6.0, 1.0 / 6.0, 1.0 / 6.0, 1.0 / 3.0, 0.0].map(|share| circle * share),
        ),
    ] {
        for (side, share) in shares.into_iter().enumerate() {
            let desc = lit(look(kind, degrees, axis), side);
            for integrator in [IntegratorDesc::Path, IntegratorDesc::Whitted] {
                let job = Job { resolution: SIZE, samples: case.count(64, 1024) as u32, integrator, ..Job::default() };
                let found = crate::common::scenes::mean_and_error(&render(&desc, &job).0);
                let side = ["left", "right", "below", "above", "ahead", "behind"][side];
                let what = format!("{kind:?}, {degrees} degrees, {}: {side}", integrator.name());
                if share == 0.0 {
                    case.at_most(what, found.0, 0.0);
                } else {
                    case.mean(what, found, share, 6e-3);
                }
            }
        }
    }
}
