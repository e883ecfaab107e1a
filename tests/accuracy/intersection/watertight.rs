//! No ray slips through a closed mesh.

use etendue::desc::MeshDesc;
use etendue::embree::{self, SceneOptions};
use etendue::math::{DVec3, Ray, Vec3};
use etendue::sampling::Rng;
use etendue::scene::Scene;

use super::{ball, below, build, cube, kernel, mesh_scene, on_sphere, range, ray, tally};
use crate::record::{Case, Entry};

pub fn cases() -> Vec<Entry> {
    vec![
        Entry { id: "I1", title: "random rays in a closed mesh", run: random_rays },
        Entry { id: "I2", title: "rays at edges and vertices", run: edges_and_vertices },
        Entry { id: "I2a", title: "edges and vertices from outside", run: from_outside },
        Entry { id: "I3", title: "parity along a line", run: parity },
    ]
}

/// Where single precision is coarse: vertices are multiples of 1/64 there.
const FAR: DVec3 = DVec3::new(148_376.0, 1234.0, -223_423.0);

/// A closed mesh as the kernel or the scene holds it, and its corners as they are there.
struct Closed {
    name: &'static str,
    kind: Kind,
    corners: Vec<DVec3>,
    triangles: Vec<[u32; 3]>,
    /// The middle of the mesh, where rays see the corners.
    middle: DVec3,
}

enum Kind {
    Kernel(embree::Scene),
    Scene(Box<Scene>),
}

impl Closed {
    fn in_kernel(name: &'static str, mesh: &MeshDesc, middle: DVec3, options: SceneOptions) -> Self {
        let corners = mesh.positions.iter().map(|p| p.as_vec3a().as_dvec3()).collect();
        let kind = Kind::Kernel(kernel(mesh, options));
        Self { name, kind, corners, triangles: mesh.triangles.clone(), middle }
    }

    fn in_scene(name: &'static str, mesh: &MeshDesc, middle: DVec3) -> Self {
        let scene = build(&mesh_scene(mesh.clone(), middle), 16);
        let corners = mesh.positions.iter().map(|p| scene.to_scene(*p).as_dvec3()).collect();
        let middle = scene.to_scene(middle).as_dvec3();
        Self { name, kind: Kind::Scene(Box::new(scene)), corners, triangles: mesh.triangles.clone(), middle }
    }

    /// Where the ray ends; `None` unless both kinds of query are stopped.
    fn stop(&self, ray: &Ray) -> Option<f32> {
        match &self.kind {
            Kind::Kernel(scene) => scene.intersect(ray).filter(|_| scene.occluded(ray)).map(|hit| hit.t),
            Kind::Scene(scene) => scene.intersect(ray).filter(|_| !scene.unoccluded(ray)).map(|hit| hit.t),
        }
    }

    fn is_leak(&self, ray: &Ray) -> bool {
        self.stop(ray).is_none()
    }

    /// A point well inside; now and then on the axis, where long thin triangles meet.
    fn inside(&self, rng: &mut Rng) -> DVec3 {
        let from_middle = match below(rng, 4) {
            0 => DVec3::Z * range(rng, -0.9, 0.9),
            _ => on_sphere(rng) * range(rng, 0.0, 0.9),
        };
        (self.middle + from_middle).as_vec3a().as_dvec3()
    }

    /// Whether rays slip through at vertices, and within few ulp of them: in fine meshes they do. Where differences of
    /// coordinates are few multiples of 1/64, as far away, all arithmetic is exact but for the direction.
    fn holes(&self) -> [bool; 2] {
        let is_fine = self.triangles.len() > 12;
        [is_fine && !self.is_crumpled(), is_fine]
    }

    /// Whether rounding of its coordinates has made another mesh of it.
    fn is_crumpled(&self) -> bool {
        self.triangles.len() > 12 && matches!(self.kind, Kind::Kernel(_)) && self.middle != DVec3::ZERO
    }

    fn triangle(&self, rng: &mut Rng) -> [DVec3; 3] {
        self.triangles[below(rng, self.triangles.len())].map(|corner| self.corners[corner as usize])
    }
}

/// The same meshes at the origin and far away, in the kernel alone and in a scene, which shifts them.
fn meshes() -> Vec<Closed> {
    let robust = SceneOptions::default();
    let kernel = |name, mesh: &MeshDesc, middle| Closed::in_kernel(name, mesh, middle, robust);
    vec![
        kernel("ball, kernel", &ball(100, 200, DVec3::ZERO), DVec3::ZERO),
        kernel("ball at 2e5, kernel", &ball(100, 200, FAR), FAR),
        Closed::in_scene("ball at 2e5, scene", &ball(100, 200, FAR), FAR),
        kernel("cube, kernel", &cube(DVec3::ZERO), DVec3::ZERO),
        Closed::in_scene("cube at 2e5, scene", &cube(FAR), FAR),
    ]
}

fn random_rays(case: &mut Case) {
    for (number, closed) in meshes().iter().enumerate() {
        let tries = case.count(80_000, 15_000_000);
        let [leaks] = tally(tries, 10 + number as u64, |rng| {
            let (origin, direction) = (closed.inside(rng), on_sphere(rng));
            [closed.is_leak(&ray(origin, direction))]
        });
        case.never(format!("{}: leaks", closed.name), leaks, tries);
    }
    let fast = SceneOptions { robust: false, ..SceneOptions::default() };
    let closed = Closed::in_kernel("", &ball(100, 200, DVec3::ZERO), DVec3::ZERO, fast);
    let tries = case.count(80_000, 15_000_000);
    let [leaks] = tally(tries, 19, |rng| {
        let (origin, direction) = (closed.inside(rng), on_sphere(rng));
        [closed.is_leak(&ray(origin, direction))]
    });
    case.rarely("ball, kernel without its robust flag: leaks", leaks, tries, 2e-5);
}

/// `direction` with each component moved by up to `steps` units in the last place.
fn jittered(direction: Vec3, steps: usize, rng: &mut Rng) -> Vec3 {
    let mut moved = direction.to_array();
    for x in &mut moved {
        for _ in 0..below(rng, steps + 1) {
            *x = if rng.next_u64() & 1 == 0 { x.next_up() } else { x.next_down() };
        }
    }
    Vec3::from(moved)
}

/// Larger copies of a sixth of the triangles, which cover all vertices, let no ray through here; measured with this ball.
const VERTEX: &str = "within rounding of a vertex the signs of all its edges may be equal, and no triangle takes the ray; what \
                      would close it costs 6 % of the ray rate and 22 % of memory, and random rays from near by never find it";

fn edges_and_vertices(case: &mut Case) {
    for (number, closed) in meshes().iter().enumerate() {
        let name = closed.name;
        let tries = case.count(40_000, 2_000_000);
        let seed = 20 + number as u64;
        let [edges, midpoints, near_edges, vertices, near_vertices, beside] = tally(tries, seed, |rng| {
            let origin = closed.inside(rng);
            let [a, b, _] = closed.triangle(rng);
            let towards = |target: DVec3| Ray { direction: (target - origin).as_vec3a(), ..ray(origin, DVec3::X) };
            // The ends of an edge are vertices, and belong to their rows.
            let edge = towards(a.lerp(b, range(rng, 0.01, 0.99)));
            let (midpoint, vertex) = (towards(0.5 * (a + b)), towards(a));
            let near_edge = Ray { direction: jittered(edge.direction, 4, rng), ..edge };
            let near_vertex = Ray { direction: jittered(vertex.direction, 4, rng), ..vertex };
            let aside = on_sphere(rng).as_vec3a().cross(vertex.direction).normalize() * vertex.direction.length();
            let beside = Ray { direction: vertex.direction + 1e-6 * aside, ..vertex };
            [edge, midpoint, near_edge, vertex, near_vertex, beside].map(|ray| closed.is_leak(&ray))
        });
        // Rounded to multiples of 1/64, the fine ball consists of slivers and points.
        let share = if closed.is_crumpled() { 2e-5 } else { 0.0 };
        case.rarely(format!("{name}: at edges"), edges, tries, share);
        case.never(format!("{name}: at midpoints of edges"), midpoints, tries);
        case.rarely(format!("{name}: within 4 ulp of edges"), near_edges, tries, share);
        let [hole, near_hole] = closed.holes();
        with_known(case, hole).rarely(format!("{name}: at vertices"), vertices, tries, 1e-6);
        with_known(case, near_hole).rarely(format!("{name}: within 4 ulp of vertices"), near_vertices, tries, 1e-6);
        case.rarely(format!("{name}: 1e-6 beside vertices"), beside, tries, share);
    }
}

/// A case whose next row is known to fail if `fails`.
fn with_known(case: &mut Case, fails: bool) -> &mut Case {
    if fails { case.known(VERTEX) } else { case }
}

/// Rays from far away at a fine ball: what slips through a vertex in front meets the far side.
fn from_outside(case: &mut Case) {
    let robust = SceneOptions::default();
    for (number, distance) in [3.0, 100.0, 1e4].into_iter().enumerate() {
        let closed = Closed::in_kernel("", &ball(100, 200, DVec3::ZERO), DVec3::ZERO, robust);
        let tries = case.count(40_000, 2_000_000);
        let [random, edges] = tally(tries, 30 + number as u64, |rng| {
            let origin = distance * on_sphere(rng);
            let [a, b, _] = closed.triangle(rng);
            // Points of the near side, seen under 60 degrees at most.
            let flip = |p: DVec3| if p.dot(origin) < 0.0 { -p } else { p };
            // Clear of the vertices by what a ray from so far is off; the short edges at the poles have no such part.
            let edge = if a.distance(b) > 0.02 { a.lerp(b, range(rng, 0.1, 0.9)) } else { DVec3::ZERO };
            let [random, edge] = [flip(on_sphere(rng) * 0.5), edge].map(|target| {
                let ray = ray(origin, target - origin);
                // The target is at t = 1; the far side is half a radius behind it at least.
                let is_through = closed.stop(&ray).is_none_or(|t| f64::from(t) > 1.0 + 0.5 / distance);
                is_through && target.dot(origin) > 0.5 * target.length() * origin.length()
            });
            [random, edge]
        });
        // From 10^4, the surroundings of a vertex in which rounding decides are a tenth of a triangle.
        let share = if distance <= 100.0 { 0.0 } else { 2e-5 };
        case.rarely(format!("random, from {distance} radii: leaks"), random, tries, share);
        // From still farther, all of an edge is that near to a vertex.
        if distance <= 100.0 {
            case.never(format!("at edges, from {distance} radii: leaks"), edges, tries);
        }
    }
}

/// Along a line from outside, a closed surface is met an even number of times.
fn parity(case: &mut Case) {
    let tries = case.count(20_000, 2_000_000);
    let mesh = ball(100, 200, DVec3::ZERO);
    let scene = build(&mesh_scene(mesh.clone(), DVec3::ZERO), 16);
    let [random, edges] = tally(tries, 40, |rng| {
        let origin = 5.0 * on_sphere(rng);
        let [a, b, _] = mesh.triangles[below(rng, mesh.triangles.len())].map(|i| mesh.positions[i as usize]);
        let edge = a.lerp(b, range(rng, 0.01, 0.99));
        // In a silhouette, where one of the two faces looks away, both are met in one point.
        let is_silhouette = edge.dot(origin - edge).abs() < 0.05 * (origin - edge).length();
        let edge = if is_silhouette { DVec3::ZERO } else { edge };
        [0.99 * on_sphere(rng), edge].map(|target| {
            let mut ray = ray(origin, (target - origin).normalize());
            let mut hits = 0;
            while let Some(hit) = scene.intersect(&ray) {
                hits += 1;
                let surface = scene.interaction(&ray, &hit);
                let side = if surface.ng.dot(ray.direction) < 0.0 { -surface.ng } else { surface.ng };
                ray.origin = surface.point.offset(side);
            }
            hits % 2 == 1
        })
    });
    case.rarely("random lines that meet a ball an odd number of times", random, tries, 1e-4);
    case.rarely("lines at edges that do", edges, tries, 1e-4);
}
