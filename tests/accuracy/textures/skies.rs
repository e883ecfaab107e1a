//! Light from infinity that an image varies.

use std::f64::consts::{PI, TAU};

use etendue::desc::{
    BsdfDesc, EnvironmentDesc, EnvironmentMapDesc, IntegratorDesc, SceneDesc, ShapeDesc, SkyDesc, SkyProjection,
    TextureDesc, TextureMapping, TextureSource,
};
use etendue::emitter::{Emitter, EnvironmentMapEmitter, Receiver};
use etendue::math::{DMat3, DQuat, DVec3};
use etendue::sampling::Rng;
use etendue::scene::{BuildOptions, Scene};
use etendue::spectrum::Rgb;
use etendue::texture::{ColorSpace, Pattern, Procedural, TextureFilter};

use super::emission::METHODS;
use super::scenes::quad;
use super::{Mean, described, image};
use crate::common::scenes::{Job, add, camera, mean_and_error, render, scene};
use crate::lights::drawn;
use crate::record::{Case, Entry, Within};

pub fn cases() -> Vec<Entry> {
    vec![
        Entry { id: "X22", title: "skies by images, by points", run: points },
        Entry { id: "X23", title: "skies by images, whole pictures", run: pictures },
        Entry { id: "X24", title: "skies by images, light to and fro", run: valley },
    ]
}

/// Columns and rows of the images.
const SIZE: [u32; 2] = [16, 8];
/// What the light of an image is multiplied by.
const FACTOR: f64 = 1.5;
/// The image's upper edge, and degrees of a turn about it.
const UP: DVec3 = DVec3::new(1.0, 3.0, -2.0);
const TURN: f64 = 40.0;
/// Columns and rows of a face. Between their texels, the glow is linear to some 10^-4 of its mean.
const FACE: u32 = 320;

/// Radiance that grows around a direction of the image.
fn glow(d: DVec3) -> f64 {
    0.2 + 20.0 * (30.0 * (d.dot(DVec3::new(0.6, -0.48, 0.64)) - 1.0)).exp()
}

/// Images of a sky.
#[derive(Clone, Copy)]
enum Sky {
    /// The same everywhere.
    Even,
    /// A texel ten thousand times as bright as the others, in this column and row.
    Hot(u32, u32),
    /// Only this texel shines.
    Lone(u32, u32),
    /// No two texels alike.
    Uneven,
    /// A ramp by the height over the horizon of the world.
    Ramp,
    /// A glow around a direction of the image, in the faces of a cube.
    Cube,
    /// The same on an octahedron.
    Octahedron,
}

const SKIES: [(Sky, &str); 9] = [
    (Sky::Even, "even"),
    (Sky::Hot(5, 2), "a hot texel"),
    (Sky::Hot(15, 3), "a hot texel at the seam"),
    (Sky::Hot(9, 0), "a hot texel at the pole"),
    (Sky::Lone(3, 2), "a lone texel"),
    (Sky::Uneven, "uneven"),
    (Sky::Ramp, "a ramp"),
    (Sky::Cube, "a cube"),
    (Sky::Octahedron, "an octahedron"),
];

impl Sky {
    fn texel(self, x: u32, y: u32) -> f64 {
        match self {
            Self::Even => 1.0,
            Self::Hot(column, row) => {
                if [x, y] == [column, row] {
                    1e3
                } else {
                    0.1
                }
            }
            Self::Lone(column, row) => {
                if [x, y] == [column, row] {
                    100.0
                } else {
                    0.0
                }
            }
            Self::Uneven => f64::from((x * 7 + y * 13) % 11) / 5.0 + 0.05,
            Self::Ramp => unreachable!("no image"),
            Self::Cube | Self::Octahedron => glow(self.direction(x, y)),
        }
    }

    /// Columns and rows.
    fn size(self) -> [u32; 2] {
        match self {
            Self::Cube => [FACE, 6 * FACE],
            Self::Octahedron => [FACE; 2],
            _ => SIZE,
        }
    }

    fn projection(self) -> SkyProjection {
        match self {
            Self::Cube => SkyProjection::Cube,
            Self::Octahedron => SkyProjection::Octahedral,
            _ => SkyProjection::LatLong,
        }
    }

    /// The direction of the middle of a texel, in the frame of the image, where faces are unfolded.
    fn direction(self, x: u32, y: u32) -> DVec3 {
        let centre = |n: u32| (f64::from(n % FACE) + 0.5) / f64::from(FACE) * 2.0 - 1.0;
        let [right, down] = [centre(x), centre(y)];
        let of = if let Self::Cube = self {
            // What lies to the right, below and before one who looks at each face.
            let [a, b, c] = [
                [-DVec3::Z, -DVec3::Y, DVec3::X],
                [DVec3::Z, -DVec3::Y, -DVec3::X],
                [DVec3::X, DVec3::Z, DVec3::Y],
                [DVec3::X, -DVec3::Z, -DVec3::Y],
                [DVec3::X, -DVec3::Y, DVec3::Z],
                [-DVec3::X, -DVec3::Y, -DVec3::Z],
            ][(y / FACE) as usize];
            right * a + down * b + c
        } else {
            let height = 1.0 - right.abs() - down.abs();
            let outside = (-height).max(0.0);
            DVec3::new(right - outside.copysign(right), height, down - outside.copysign(down))
        };
        of.normalize()
    }

    fn texture(self) -> TextureDesc {
        let Self::Ramp = self else {
            let [width, height] = self.size();
            let shown = image(width, height, 3, |x, y, c| self.texel(x, y) as f32 * [1.0, 0.5, 0.25][c as usize]);
            return described("sky", &shown, ColorSpace::Linear, TextureFilter::Bilinear, 1.0);
        };
        let colors = [Rgb::ZERO, Rgb::new(1.0, 0.5, 0.25)];
        // The ramp grows along the first coordinate, which is the direction's x: with the world's x up, brightest from above.
        TextureDesc {
            name: "sky".to_owned(),
            path: String::new(),
            source: TextureSource::Procedural(Procedural { pattern: Pattern::Gradient, colors, in_space: true }),
            mapping: TextureMapping::Space { scale: DVec3::splat(0.5), offset: DVec3::splat(0.5) },
            vertex_colors: false,
        }
    }

    /// Radiance in red from a direction of the world.
    fn radiance(self, direction: DVec3) -> f64 {
        if let Self::Ramp = self {
            return FACTOR * (0.5 * direction.x + 0.5).clamp(0.0, 1.0);
        }
        let d = to_world().transpose() * direction;
        if self.projection() != SkyProjection::LatLong {
            return FACTOR * glow(d);
        }
        let [width, height] = SIZE.map(f64::from);
        let x = (0.5 + d.x.atan2(-d.z) / TAU) * width - 0.5;
        let y = d.y.clamp(-1.0, 1.0).acos() / PI * height - 0.5;
        let (s, t) = (x - x.floor(), y - y.floor());
        let texel = |i: f64, j: f64| {
            let column = (x.floor() + i).rem_euclid(width) as u32;
            self.texel(column, (y.floor() + j).clamp(0.0, height - 1.0) as u32)
        };
        let row = |j: f64| (1.0 - s) * texel(0.0, j) + s * texel(1.0, j);
        FACTOR * ((1.0 - t) * row(0.0) + t * row(1.0))
    }

    /// The integral of the radiance in red times a weight over all directions, by midpoints in the image.
    fn integral(self, weight: impl Fn(DVec3) -> f64) -> f64 {
        const STEPS: [u32; 2] = [2048, 1024];
        let mut sum = 0.0;
        for j in 0..STEPS[1] {
            let angle = PI * (f64::from(j) + 0.5) / f64::from(STEPS[1]);
            for i in 0..STEPS[0] {
                let around = TAU * ((f64::from(i) + 0.5) / f64::from(STEPS[0]) - 0.5);
                let own = DVec3::new(angle.sin() * around.sin(), angle.cos(), -angle.sin() * around.cos());
                let direction = to_world() * own;
                let weight = weight(direction);
                if weight != 0.0 {
                    sum += angle.sin() * weight * self.radiance(direction);
                }
            }
        }
        sum * 2.0 * PI * PI / (f64::from(STEPS[0]) * f64::from(STEPS[1]))
    }

    fn irradiance(self, normal: DVec3) -> f64 {
        self.integral(|direction| direction.dot(normal).max(0.0))
    }

    fn light(self, desc: &mut SceneDesc) {
        let texture = desc.add_texture(self.texture()).expect("a texture of the test");
        let map = EnvironmentMapDesc {
            projection: self.projection(),
            up: UP,
            rotation_deg: TURN,
            ..EnvironmentMapDesc::new(texture)
        };
        let environment =
            EnvironmentDesc { sky: SkyDesc::Map(map), ..EnvironmentDesc::even(Rgb::splat(FACTOR as f32)) };
        desc.set_environment_desc(Some(environment)).expect("a sky of the test");
    }
}

/// The turn by its definition, with axis and angle.
fn to_world() -> DMat3 {
    let up = UP.normalize();
    let (axis, angle) = (DVec3::Y.cross(up).normalize(), up.y.acos());
    DMat3::from_quat(DQuat::from_axis_angle(up, TURN.to_radians()) * DQuat::from_axis_angle(axis, angle))
}

/// The sky over a floor of this albedo, seen from near.
fn floor(sky: Sky, albedo: f32) -> SceneDesc {
    let bsdf = BsdfDesc::Lambert { albedo: Rgb::splat(albedo) };
    let corners = [[-2.0, 0.0, 2.0], [2.0, 0.0, 2.0], [2.0, 0.0, -2.0], [-2.0, 0.0, -2.0]];
    let mut desc = scene(camera(DVec3::new(0.0, 1.0, 0.01), DVec3::ZERO, 20.0), vec![(quad(corners), bsdf, None)]);
    sky.light(&mut desc);
    desc
}

fn sky_of(scene: &Scene) -> &EnvironmentMapEmitter {
    let sky = scene.emitters().emitters().iter().find_map(|emitter| match emitter {
        Emitter::EnvironmentMap(sky) => Some(sky),
        _ => None,
    });
    sky.expect("the sky")
}

/// Irradiance by light samples, and the power of photons, against quadrature.
fn points(case: &mut Case) {
    let count = case.count(100_000, 4_000_000) as u32;
    for (sky, name) in SKIES {
        let scene = Scene::build(&floor(sky, 0.5), &BuildOptions::default()).expect("a scene of the test");
        let mut rng = Rng::new(7, 3);
        for normal in [DVec3::Y, DVec3::new(1.0, -0.2, 0.4).normalize(), -UP.normalize()] {
            let mut mean = Mean::default();
            let n = normal.as_vec3a();
            let receiver = Receiver::facing(scene.to_scene(DVec3::ZERO), n);
            for _ in 0..count {
                mean.add(scene.emitters().sample(receiver, rng.next_4d()).map_or(0.0, |sample| {
                    f64::from(sample.radiance.r()) * f64::from(sample.wi.dot(n).max(0.0)) / f64::from(sample.pdf)
                }));
            }
            let what = format!("{name}: irradiance on ({:.2}, {:.2}, {:.2})", normal.x, normal.y, normal.z);
            case.mean(what, mean.of(count), sky.irradiance(normal), 0.08);
        }
        // Of samples beside those of a Bsdf: what they find, and what the Bsdf's have to find.
        let map = &sky_of(&scene).map;
        let (mut above, mut rest) = (Mean::default(), Mean::default());
        for _ in 0..count {
            let (_, pdf, radiance) = map.sample(rng.next_2d(), true);
            let light = f64::from(pdf);
            let even = 0.25 / PI;
            above.add(f64::from(radiance.r()) / (light + even));
            let wi = etendue::sampling::warps::uniform_sphere(rng.next_2d());
            rest.add(f64::from(map.radiance(wi).r()) / (f64::from(map.pdf(wi, true)) + even));
        }
        let [(a, da), (b, db)] = [above.of(count), rest.of(count)];
        let both = (a + b, da.hypot(db));
        case.mean(
            format!("{name}: all light, by samples above the mean and even ones"),
            both,
            sky.integral(|_| 1.0),
            0.02,
        );
        let middle = map.mean().x / (0.25 / PI * sky.integral(|_| 1.0));
        case.exact(format!("{name}: mean of the texels"), middle, 1.0, Within::Relative(1e-4));
    }
}

/// The floor below a sky by all methods that draw it.
fn pictures(case: &mut Case) {
    let samples = case.count(64, 4096) as u32;
    for (sky, name) in [SKIES[1], SKIES[5]] {
        let exact = 0.5 / PI * sky.irradiance(DVec3::Y) * (1.0 + 0.5 + 0.25) / 3.0;
        for (integrator, within) in METHODS.into_iter().chain([(IntegratorDesc::PhotonDirect, 2e-2)]) {
            let image = drawn(case, &floor(sky, 0.5), integrator, samples);
            let what = format!("{name}: the floor by {integrator:?}");
            if integrator == IntegratorDesc::PhotonDirect {
                // All pixels see the same photons, so that their errors are not those of independent pixels.
                case.biased_mean(what, mean_and_error(&image), exact, (1e-2, within));
            } else {
                case.mean(what, mean_and_error(&image), exact, within);
            }
        }
        // The sky itself.
        let mut seen = floor(sky, 0.5);
        seen.set_camera(camera(DVec3::Y, DVec3::new(0.3, 2.0, 0.2), 120.0)).expect("a camera of the test");
        let (image, _) = render(&seen, &Job { samples, ..Job::default() });
        let mut other = seen.clone();
        if let Some(environment) = &mut other.environment {
            environment.visible = false;
        }
        let (without, _) = render(&other, &Job { samples, ..Job::default() });
        let dark = without.rgb.iter().filter(|value| **value == 0.0).count() as f64 / without.rgb.len() as f64;
        case.exact(
            format!("{name}: share of a picture of the sky that is black where cameras do not see it"),
            dark,
            1.0,
            Within::Absolute(0.0),
        );
        case.at_most(
            format!("{name}: darkest value of the sky"),
            -f64::from(image.rgb.iter().copied().fold(f32::MAX, f32::min)),
            -0.01,
        );
    }
}

/// In a valley, light goes to and fro: photons and paths agree.
fn valley(case: &mut Case) {
    let of = |case: &Case, integrator, samples| {
        let mut desc = floor(Sky::Hot(5, 2), 0.7);
        let wall = [[-2.0, 0.0, -1.0], [2.0, 0.0, -1.0], [2.0, 2.0, -1.5], [-2.0, 2.0, -1.5]];
        add(&mut desc, 1, quad(wall), BsdfDesc::Lambert { albedo: Rgb::splat(0.7) }, None);
        let ball = ShapeDesc::Sphere { centre: DVec3::new(0.4, 0.2, 0.0), radius: 0.2 };
        add(&mut desc, 2, ball, BsdfDesc::Mirror { reflectance: Rgb::splat(0.8) }, None);
        mean_and_error(&drawn(case, &desc, integrator, samples))
    };
    let (exact, error) = of(case, IntegratorDesc::Path, case.count(256, 16384) as u32);
    for integrator in [
        IntegratorDesc::Photon,
        IntegratorDesc::Caustic,
        IntegratorDesc::Sppm,
        IntegratorDesc::Ppm,
        IntegratorDesc::IrradianceCache,
    ] {
        let (mean, own) = of(case, integrator, case.count(32, 1024) as u32);
        let both = own.hypot(error);
        case.biased_mean(format!("a valley by {integrator:?}"), (mean, both), exact, (1e-2, 1e-2));
    }
}
