//! Where a camera's rays go.

use std::f64::consts::PI;

use etendue::camera::Camera;
use etendue::desc::{CameraDesc, FilmDesc, FovAxis};
use etendue::math::{DVec3, Vec3};
use etendue::sampling::triangle_solid_angle;

use crate::record::{Case, Entry, Within};

pub fn cases() -> Vec<Entry> {
    vec![Entry { id: "C66", title: "Camera", run: camera }]
}

/// Looks along -z from the origin.
fn desc(fov_deg: f64, fov_axis: FovAxis) -> CameraDesc {
    CameraDesc::Perspective {
        eye: DVec3::ZERO,
        look_at: DVec3::NEG_Z,
        up: DVec3::Y,
        fov_deg,
        fov_axis,
        film: FilmDesc::default(),
    }
}

fn make(fov_deg: f64, fov_axis: FovAxis, resolution: [u32; 2]) -> Camera {
    Camera::new(&desc(fov_deg, fov_axis), resolution, DVec3::ZERO).expect("a camera")
}

fn direction(camera: &Camera, x: f64, y: f64) -> DVec3 {
    camera.ray(x as f32, y as f32).direction.as_dvec3()
}

/// Column and row under which a direction is seen, by bisection.
fn seen_at(camera: &Camera, wanted: DVec3, [width, height]: [u32; 2]) -> [f64; 2] {
    let find = |size: u32, is_before: &dyn Fn(f64) -> bool| {
        let (mut low, mut high) = (0.0, f64::from(size));
        for _ in 0..50 {
            let middle = 0.5 * (low + high);
            if is_before(middle) { low = middle } else { high = middle }
        }
        0.5 * (low + high)
    };
    let middle = 0.5 * f64::from(height);
    let x = find(width, &|x| {
        let d = direction(camera, x, middle);
        d.x / -d.z < wanted.x / -wanted.z
    });
    let y = find(height, &|y| {
        let d = direction(camera, x, y);
        d.y / -d.z > wanted.y / -wanted.z
    });
    [x, y]
}

/// Solid angle (sr) of the film's rectangle between two corners.
fn solid_angle(camera: &Camera, [x0, y0]: [f64; 2], [x1, y1]: [f64; 2]) -> f64 {
    let v = |x: f64, y: f64| camera.ray(x as f32, y as f32).direction;
    triangle_solid_angle([v(x0, y0), v(x1, y0), v(x1, y1)]) + triangle_solid_angle([v(x0, y0), v(x1, y1), v(x0, y1)])
}

/// That of the rectangle between two points of the plane at distance 1.
fn exact_solid_angle([x0, y0]: [f64; 2], [x1, y1]: [f64; 2]) -> f64 {
    let corner = |x: f64, y: f64| (x * y / (1.0 + x * x + y * y).sqrt()).atan();
    (corner(x1, y1) - corner(x0, y1) - corner(x1, y0) + corner(x0, y0)).abs()
}

fn camera(case: &mut Case) {
    // Field of view: half the film's height is seen under half the angle.
    let wide = make(90.0, FovAxis::Horizontal, [1600, 900]);
    let top = direction(&wide, 800.0, 0.0);
    let vertical = 2.0 * (top.y / -top.z).atan().to_degrees();
    case.exact("horizontal 90° at 16:9: vertical, degrees", vertical, 58.7155070856, Within::Relative(2e-7));
    let tall = make(58.7155070856, FovAxis::Vertical, [1600, 900]);
    let right = direction(&tall, 1600.0, 450.0);
    let horizontal = 2.0 * (right.x / -right.z).atan().to_degrees();
    case.exact("vertical 58.7155° at 16:9: horizontal, degrees", horizontal, 90.0, Within::Relative(2e-7));

    // Pixels: edges at whole numbers, the first at the top left.
    let camera = make(60.0, FovAxis::Horizontal, [640, 480]);
    let [x, y] = seen_at(&camera, DVec3::new(1.0, 0.0, -3.0), [640, 480]);
    case.exact("(1, 0, -3) under 60°, 640 wide: column", x, 504.752086141, Within::Absolute(2e-4));
    case.exact("the same: row", y, 240.0, Within::Absolute(2e-4));
    let [_, y] = seen_at(&camera, DVec3::new(0.0, 1.0, -6.0), [640, 480]);
    // 640 / (2 tan 30°) pixels to the tangent.
    case.exact("(0, 1, -6): row", y, 240.0 - 320.0 / (30_f64.to_radians().tan() * 6.0), Within::Absolute(2e-4));
    let narrow = make(0.2, FovAxis::Horizontal, [64, 64]);
    let tangent = 0.1_f64.to_radians().tan();
    let [x, _] = seen_at(&narrow, DVec3::new(0.625 * tangent, 0.0, -1.0), [64, 64]);
    case.exact("field of view of 0.2°: column", x, 52.0, Within::Absolute(1e-2));
    let large = make(60.0, FovAxis::Horizontal, [16_384, 4096]);
    let [x, _] = seen_at(&large, DVec3::new(1.0, 0.0, -3.0), [16_384, 4096]);
    case.exact("16384 pixels wide: column", x, 504.752086141 * 25.6, Within::Absolute(1e-2));
    let worst = (0..1000).map(|i| {
        let length = camera.ray(0.641 * i as f32, 0.48 * i as f32).direction.length();
        (f64::from(length) - 1.0).abs()
    });
    case.at_most("length of a direction, off 1", worst.fold(0.0, f64::max), 2e-7);

    // Solid angles: of a pixel in the corner, one in the middle, and of all.
    let square = make(90.0, FovAxis::Horizontal, [64, 64]);
    let pixel = 2.0 / 64.0;
    let corner = solid_angle(&square, [0.0, 0.0], [1.0, 1.0]);
    let exact = exact_solid_angle([-1.0, 1.0 - pixel], [pixel - 1.0, 1.0]);
    case.exact("90° square, 64 pixels: solid angle of the first", corner, exact, Within::Relative(2e-5));
    let centre = solid_angle(&square, [32.0, 32.0], [33.0, 33.0]);
    case.exact(
        "the same: of one at the centre",
        centre,
        exact_solid_angle([0.0, -pixel], [pixel, 0.0]),
        Within::Relative(2e-5),
    );
    let all: f64 = (0..64 * 64)
        .map(|i| [f64::from(i % 64), f64::from(i / 64)])
        .map(|[x, y]| solid_angle(&square, [x, y], [x + 1.0, y + 1.0]))
        .sum();
    case.exact("the same: of all, a face of a cube", all, 4.0 * PI / 6.0, Within::Relative(1e-6));
    let fine = make(90.0, FovAxis::Horizontal, [1024, 1024]);
    // A pair of pixels about the very corner, so that the first order of their size cancels.
    let ratio = solid_angle(&fine, [-1.0, -1.0], [1.0, 1.0]) / solid_angle(&fine, [511.0, 511.0], [513.0, 513.0]);
    case.exact("corner over centre, small pixels", ratio, 3_f64.powf(-1.5), Within::Relative(2e-4));

    // Eye and target moved by the same vector, in the scene frame: nothing changes.
    let seen = |shift: DVec3| {
        let (eye, look_at) = (DVec3::new(0.5, 1.25, 3.0) + shift, DVec3::new(-0.75, 0.5, -1.0) + shift);
        let desc = CameraDesc::Perspective {
            eye,
            look_at,
            up: DVec3::new(0.1, 1.0, 0.0),
            fov_deg: 37.0,
            fov_axis: FovAxis::Vertical,
            film: FilmDesc::default(),
        };
        let camera = Camera::new(&desc, [160, 120], shift).expect("a camera");
        (0..100)
            .map(|i| camera.ray(1.6 * i as f32 + 0.3, 1.2 * i as f32 + 0.1))
            .map(|ray| (ray.origin.to_array().map(f32::to_bits), ray.direction.to_array().map(f32::to_bits)))
            .collect::<Vec<_>>()
    };
    let still = seen(DVec3::ZERO);
    // Shifts that are exact in double precision.
    let moved = [10, 20, 40, 45].map(|power| DVec3::new(1.0, -2.0, 0.5) * f64::from(power).exp2());
    let changed = moved.iter().filter(|shift| seen(**shift) != still).count();
    case.never("eye and target moved by up to 2^45: other rays", changed as u64, 4);

    let refused = |desc: &CameraDesc| Camera::new(desc, [4, 4], DVec3::ZERO).is_err();
    let with_up = |up: DVec3| CameraDesc::Perspective {
        eye: DVec3::ZERO,
        look_at: DVec3::Y,
        up,
        fov_deg: 90.0,
        fov_axis: FovAxis::Horizontal,
        film: FilmDesc::default(),
    };
    let bad = [
        with_up(DVec3::Y),
        with_up(DVec3::NEG_Y),
        with_up(1e-9 * DVec3::Y),
        with_up(DVec3::new(1e-14, 1.0, 0.0)),
        with_up(DVec3::ZERO),
        with_up(DVec3::NAN),
    ];
    let accepted = bad.iter().filter(|desc| !refused(desc)).count();
    case.never("up along the view, zero or NaN: no error", accepted as u64, bad.len() as u64);
    // Nearly so is unusual, and no error.
    let near = Camera::new(&with_up(DVec3::new(1e-6, 1.0, 0.0)), [4, 4], DVec3::ZERO).expect("a camera");
    let middle = near.ray(2.0, 2.0).direction;
    case.exact(
        "up 10^-6 off the view: off the axis",
        f64::from((middle - Vec3::Y).length()),
        0.0,
        Within::Absolute(1e-6),
    );
}
