//! Tests of scenes in which something moves during the shutter interval, by steps that no description gives: they move the
//! instances and deform the meshes of scenes that were built at rest.

use std::ops::ControlFlow;
use std::sync::Arc;

use serde_json::{Value, json};

use super::geometry::Geometry;
use super::hit::Hit;
use super::instance_transform::InstancePath;
use super::{BuildOptions, Scene};
use crate::camera::Camera;
use crate::desc::{self, IntegratorDesc, RenderDesc};
use crate::embree::{SceneBuilder, SceneOptions, TriangleMesh, VertexBuffer};
use crate::emitter::{Emitter, EmitterSet, EnvironmentEmitter, InfiniteBall};
use crate::integrator::{Direct, Integrator, Path, SceneTracer, Whitted};
use crate::math::{DAffine3, DVec3, Frame, Ray, Vec3};
use crate::render::{Render, RenderSettings};
use crate::sampling::{Rng, Sampler as _, SobolSampler, warps};
use crate::spectrum::Rgb;
use crate::{Cancel, ErrorKind};

/// How the geometry of a surface moves.
enum Motion {
    /// It stays where it is.
    Rest,
    /// An instance is moved by these transforms of the scene frame, beyond its own placement.
    Moved(Vec<DAffine3>),
    /// The vertices of a mesh are moved by these transforms of their frame.
    Deformed(Vec<DAffine3>),
}

impl Scene {
    /// The same scene with the geometry of each surface in motion.
    fn in_motion(&self, motion: impl Fn(u32) -> Motion) -> Self {
        let mut builder = SceneBuilder::new(&self.device, SceneOptions::default()).unwrap();
        let geometries = self.geometries.iter().map(|geometry| match geometry {
            Geometry::Instance { triangles, surface, instance_path } => {
                let mut triangles = triangles.clone();
                let own = instance_path.start().to_scene;
                let steps = match motion(*surface) {
                    Motion::Rest => vec![own],
                    Motion::Moved(steps) => steps.into_iter().map(|step| step * own).collect(),
                    Motion::Deformed(steps) => {
                        triangles.mesh = deformed(&triangles.mesh, &steps);
                        vec![own]
                    }
                };
                let mut object = SceneBuilder::new(&self.device, SceneOptions::default()).unwrap();
                object.add_triangles(triangles.mesh.clone()).unwrap();
                builder.add_moving_instance(&object.commit(None).unwrap(), &steps).unwrap();
                Geometry::Instance { triangles, surface: *surface, instance_path: Arc::new(InstancePath::new(&steps)) }
            }
            Geometry::Flat { triangles, surface, .. } => {
                let mut triangles = triangles.clone();
                match motion(*surface) {
                    Motion::Rest => {}
                    Motion::Moved(_) => unreachable!("no instance"),
                    Motion::Deformed(steps) => triangles.mesh = deformed(&triangles.mesh, &steps),
                }
                builder.add_triangles(triangles.mesh.clone()).unwrap();
                let mut geometry = Geometry::Flat { triangles, surface: *surface, cache: None, moved: None };
                geometry.cache_triangles(&mut 1000, &self.device);
                geometry
            }
            Geometry::Loose { triangles, parts, .. } => {
                builder.add_triangles(triangles.mesh.clone()).unwrap();
                Geometry::Loose { triangles: triangles.clone(), parts: parts.clone(), cache: None }
            }
            Geometry::Analytic { .. } => unreachable!("no shapes"),
        });
        let geometries = geometries.collect();
        Self { embree: Some(builder.commit(None).unwrap()), geometries, ..self.clone() }
    }
}

fn deformed(mesh: &TriangleMesh, steps: &[DAffine3]) -> TriangleMesh {
    let steps: Vec<_> = steps
        .iter()
        .map(|step| {
            let moved = |p: [f32; 3]| step.transform_point3(DVec3::from(p.map(f64::from))).as_vec3a().to_array();
            Arc::new(VertexBuffer::from_vec(mesh.vertices().iter().map(moved).collect(), &Cancel::new()).unwrap())
        })
        .collect();
    TriangleMesh::deforming(&steps, mesh.indices().clone()).unwrap()
}

/// A sphere of triangles about the origin, at least `OBJECT_TRIANGLES`.
fn ball(material: &str, radius: f64) -> Value {
    let (mut positions, mut triangles) = (Vec::new(), Vec::new());
    let (rings, around) = (12_u32, 16_u32);
    for ring in 0..=rings {
        for i in 0..around {
            let (theta, phi) = (f64::from(ring) / 12.0, f64::from(i) / 8.0);
            let [(s, c), (sin, cos)] = [theta, phi].map(|angle| (angle * std::f64::consts::PI).sin_cos());
            positions.push([radius * s * cos, radius * c, radius * s * sin]);
            let [p, q] = [i, (i + 1) % around].map(|i| ring * around + i);
            if ring < rings {
                triangles.extend([[p, q, q + around], [p, q + around, p + around]]);
            }
        }
    }
    json!({"geometry": "mesh", "material": material, "positions": positions, "triangles": triangles})
}

fn quad(material: &str, corners: [[f64; 3]; 4], emission: f64) -> Value {
    let [a, b, c, d] = corners;
    json!({"geometry": "quad", "material": material, "vertex-1": a, "vertex-2": b, "vertex-3": c, "vertex-4": d,
        "emission": [emission, emission, emission]})
}

fn build(surfaces: &[Value]) -> Scene {
    let scene = json!({
        "etendue": 1,
        "camera": {"origin": [0, 0, 4], "lookAt": [0, 0, 0], "up": [0, 1, 0], "fieldOfView": 60},
        "materials": [
            {"name": "white", "type": "diffuse", "color": [0.8, 0.7, 0.6]},
            {"name": "mirror", "type": "reflective", "color": [0.9, 0.9, 0.9]},
            {"name": "black", "type": "diffuse", "color": [0, 0, 0]},
        ],
        "surfaces": surfaces,
    });
    let desc = desc::parse(&scene.to_string(), "".as_ref(), None).unwrap();
    Scene::build(&desc, &BuildOptions { dynamic: true, ..BuildOptions::default() }).unwrap()
}

/// A floor, a lamp above it, and in between a white and a mirroring ball of triangles, number 2 and 3.
fn balls() -> Scene {
    let floor = [[-3.0, -1.0, 3.0], [3.0, -1.0, 3.0], [3.0, -1.0, -3.0], [-3.0, -1.0, -3.0]];
    let lamp = [[-1.0, 2.0, -1.0], [1.0, 2.0, -1.0], [1.0, 2.0, 1.0], [-1.0, 2.0, 1.0]];
    build(&[quad("white", floor, 0.0), quad("white", lamp, 5.0), ball("white", 0.6), ball("mirror", 0.5)])
}

/// The balls cross each other and turn, one of them as an instance and the other by its vertices.
fn crossing(surface: u32) -> Motion {
    let shift = |x: f64, y: f64| DAffine3::from_translation(DVec3::new(x, y, 0.0));
    match surface {
        2 => Motion::Moved(vec![shift(-1.2, 0.0), shift(0.0, 0.7) * DAffine3::from_rotation_z(0.6), shift(1.2, 0.2)]),
        3 => Motion::Deformed(vec![shift(1.0, 0.3) * DAffine3::from_rotation_x(0.4), shift(-1.0, 0.5)]),
        _ => Motion::Rest,
    }
}

/// Balls that cross each other, one as an instance and one by its vertices; `resting` leaves out the instance's motion.
pub(crate) fn crossing_balls(resting: bool) -> Scene {
    balls().in_motion(|surface| match crossing(surface) {
        Motion::Moved(_) if resting => Motion::Rest,
        motion => motion,
    })
}

/// The same balls at rest where they are at one moment.
fn frozen(surface: u32, time: f64) -> Motion {
    match crossing(surface) {
        Motion::Rest => Motion::Rest,
        Motion::Moved(steps) => Motion::Moved(vec![between(&steps, time)]),
        Motion::Deformed(steps) => Motion::Deformed(vec![between(&steps, time)]),
    }
}

fn between(steps: &[DAffine3], time: f64) -> DAffine3 {
    let scaled = time * (steps.len() - 1) as f64;
    let step = (scaled as usize).min(steps.len() - 2);
    let (from, to, weight) = (steps[step], steps[step + 1], scaled - step as f64);
    DAffine3 {
        matrix3: from.matrix3 * (1.0 - weight) + to.matrix3 * weight,
        translation: from.translation.lerp(to.translation, weight),
    }
}

/// Every ray of a path that begins at a moment, its shadow rays too, sees the scene of that moment.
#[test]
fn a_path_sees_one_moment() {
    const SIDE: u32 = 24;
    let scene = balls();
    let moving = scene.in_motion(crossing);
    assert!(moving.has_motion() && !scene.has_motion());
    let camera = Camera::new(scene.camera(), [SIDE; 2], scene.centre()).unwrap();
    fn see(scene: &Scene, integrator: &impl Integrator, camera: &Camera, pixel: u32, time: f32) -> Rgb {
        let mut sampler = SobolSampler::new(9, 1);
        let mut tracer = SceneTracer::new(scene);
        sampler.start(pixel, 0);
        let ray = camera.ray((pixel % SIDE) as f32 + 0.5, (pixel / SIDE) as f32 + 0.5).at_time(time);
        integrator.radiance(scene, ray, &mut sampler, &mut tracer, &mut |_| {})
    }
    let (path, whitted) = (Path::new(None, 1), Whitted { max_depth: None, shadow_rays: 1 });
    let (mut same, mut of_other_moment, mut count) = (0, 0, 0);
    for time in [0.0, 0.3, 0.5, 0.9, 1.0] {
        let still = scene.in_motion(|surface| frozen(surface, time));
        assert!(!still.has_motion());
        let time = time as f32;
        for pixel in 0..SIDE * SIDE {
            let pairs = [
                (see(&moving, &path, &camera, pixel, time), see(&still, &path, &camera, pixel, 0.0)),
                (see(&moving, &whitted, &camera, pixel, time), see(&still, &whitted, &camera, pixel, 0.0)),
                (
                    see(&moving, &Direct { shadow_rays: 1 }, &camera, pixel, time),
                    see(&still, &Direct { shadow_rays: 1 }, &camera, pixel, 0.0),
                ),
            ];
            let close = |a: Rgb, b: Rgb| (a - b).abs().max_element() < 1e-3 * (1.0 + b.max_element());
            count += pairs.len();
            same += pairs.iter().filter(|(moving, still)| close(*moving, *still)).count();
            let other = see(&moving, &path, &camera, pixel, 1.0 - time);
            of_other_moment += usize::from(close(other, pairs[0].1));
        }
    }
    // A path whose ray passes an edge closely may go another way by rounding.
    assert!(same as f64 > 0.99 * count as f64, "{same} of {count}");
    // At most moments an eighth of the pixels see something else than at another moment.
    assert!(of_other_moment + 200 < count / 3, "{of_other_moment} of {}", count / 3);
}

/// The picture of what moves is the mean of pictures of all moments: a black edge that passes a white sky is a linear ramp.
#[test]
fn a_moving_edge_is_a_linear_ramp() {
    // The sheet covers everything left of its edge, which moves from x = -1 to x = 1 in the plane z = 0.
    let (mut positions, mut triangles) = (Vec::new(), Vec::new());
    for i in 0..=65_u32 {
        let y = 40.0 * f64::from(i) / 65.0 - 20.0;
        positions.extend([[-40.0, y, 0.0], [0.0, y, 0.0]]);
        if i > 0 {
            let p = 2 * i - 2;
            triangles.extend([[p, p + 1, p + 3], [p, p + 3, p + 2]]);
        }
    }
    let sheet = json!({"geometry": "mesh", "material": "black", "positions": positions, "triangles": triangles});
    let shift = |x: f64| DAffine3::from_translation(DVec3::new(x, 0.0, 0.0));
    let still = build(&[sheet]);
    for steps in [vec![shift(-1.0), shift(1.0)], vec![shift(-1.0), shift(-0.5), shift(0.0), shift(0.5), shift(1.0)]] {
        let mut scene = still.in_motion(|_| Motion::Moved(steps.clone()));
        let environment = EnvironmentEmitter::new(Rgb::splat(2.0), InfiniteBall::new(Vec3::ZERO, 100.0));
        scene.set_emitters(EmitterSet::new(vec![Emitter::Environment(environment)]));
        for integrator in [IntegratorDesc::Path, IntegratorDesc::Whitted, IntegratorDesc::Direct, IntegratorDesc::Auto]
        {
            let desc = RenderDesc { resolution: [64, 4], samples: 1024, integrator, ..RenderDesc::default() };
            let filter = crate::desc::FilterDesc::Box;
            let desc = RenderDesc { filter, ..desc };
            let camera = Camera::new(scene.camera(), desc.resolution, scene.centre()).unwrap();
            let mut render = Render::new(&scene, RenderSettings { desc, threads: 1, ..Default::default() }).unwrap();
            render.run(&mut |_| ControlFlow::Continue(())).unwrap();
            let image = render.image();
            let mut between = 0;
            for pixel in 0..64 {
                let ray = camera.ray(pixel as f32 + 0.5, 2.0);
                let x = f64::from((ray.at(-ray.origin.z / ray.direction.z) - scene.to_scene(DVec3::ZERO)).x);
                let open = ((x + 1.0) / 2.0).clamp(0.0, 1.0);
                let seen = f64::from(image.rgb[3 * (2 * 64 + pixel)]) / 2.0;
                // Stratified times leave less than the binomial error of 1024 samples, which is 0.016 at most.
                let binomial = (open * (1.0 - open) / 1024.0).sqrt();
                assert!((seen - open).abs() < 3.0 * binomial + 1e-5, "{integrator:?}, x = {x}: {seen}, not {open}");
                between += usize::from(open > 0.0 && open < 1.0);
            }
            assert!(between > 10, "{between}");
        }
    }
}

/// Rays that leave a convex body meet it no more, however fast it moves and however large its coordinates are.
#[test]
fn rays_leave_what_moves() {
    let scene = build(&[ball("white", 0.5)]);
    let shift = |x: f64| DAffine3::from_translation(DVec3::new(x, 0.3 * x, -0.1 * x));
    let stretch = |x: f64| DAffine3::from_scale(DVec3::new(x, 1.0, 1.0 / x));
    for far in [1.0, 30.0, 1000.0] {
        let steps = vec![shift(-far), shift(0.7 * far) * stretch(3.0), shift(far) * DAffine3::from_rotation_y(1.0)];
        let motions = [Motion::Moved(steps.clone()), Motion::Deformed(steps.clone())];
        for motion in motions {
            let scene = scene.in_motion(|_| match &motion {
                Motion::Moved(steps) => Motion::Moved(steps.clone()),
                Motion::Deformed(steps) => Motion::Deformed(steps.clone()),
                Motion::Rest => Motion::Rest,
            });
            let mut rng = Rng::new(5, 5);
            let (mut left, mut again) = (0, 0);
            for _ in 0..20_000 {
                let time = rng.next_f32();
                let centre = between(&steps, time.into()).translation + scene.to_scene(DVec3::ZERO).as_dvec3();
                let direction = warps::uniform_sphere(rng.next_2d());
                let origin = centre.as_vec3a() - 3.0 * direction;
                let aside = Frame::from_normal(direction).to_world(Vec3::new(rng.next_f32(), rng.next_f32(), 0.0));
                let ray = Ray::new(origin + 0.4 * aside, direction).at_time(time);
                let Some(hit) = scene.intersect(&ray) else { continue };
                let at = scene.interaction(&ray, &hit);
                assert_eq!(at.point.time, time);
                // The body is where the ray met it; along a ray that grazes it, the place of the hit is uncertain.
                let off = (at.point.p - ray.at(hit.t)).length() * at.ng.dot(direction).abs() / (1.0 + far as f32);
                assert!(off < 1e-6, "{off}");
                let n = if at.ng.dot(direction) < 0.0 { at.ng } else { continue };
                left += 1;
                let wi = Frame::from_normal(n).to_world(warps::cosine_hemisphere(rng.next_2d()));
                let leaving = at.point.leave(n, wi);
                assert_eq!(leaving.time, time);
                again += usize::from(scene.intersect(&leaving).is_some_and(|hit: Hit| hit.t < 2.0));
            }
            assert!(left > 10_000, "{left}");
            assert_eq!(again, 0, "of {left} rays, {far}");
        }
    }
}

#[test]
fn what_shows_one_moment_refuses_a_scene_that_moves() {
    let scene = balls().in_motion(crossing);
    for integrator in IntegratorDesc::ALL {
        let desc = RenderDesc { resolution: [4, 4], samples: 1, integrator, ..RenderDesc::default() };
        let made = Render::new(&scene, RenderSettings { desc, threads: 1, ..Default::default() });
        assert_eq!(made.is_ok(), integrator.info().shows_motion(), "{integrator:?}");
        if let Err(error) = made {
            assert_eq!(error.kind(), ErrorKind::Unsupported);
            assert!(error.to_string().contains(&format!("{} shows no motion", integrator.name())), "{error}");
        }
    }
}
