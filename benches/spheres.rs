//! Four ways to meet spheres beside a room of triangles, timed against each other.
//!
//! primitive   Embree's own sphere, single precision, in the same scene
//! user        user geometry with a test in double precision, in the same scene
//! list        a list tested before Embree: rejection in single precision, then the same test in double precision; what
//!             is found shortens the ray Embree gets
//! triangles   480 triangles for each sphere
//!
//! `cargo bench --bench spheres`. Each round times every way once on the same rays, so that the machine's mood hits all
//! alike; the median over the rounds is printed, in millions of rays a second.
//!
//! On two cores of an AMD EPYC the list is the fastest way up to 32 spheres (by a quarter for one, even at 32), and user
//! geometry from there on; Embree's own sphere and triangles are slower than the better of these two at every number.

use std::hint::black_box;
use std::sync::Arc;
use std::time::Instant;

use etendue::Result;
use etendue::embree::{Device, DeviceOptions, Scene, SceneBuilder, SceneOptions, TriangleMesh, UserGeometry, UserHit};
use etendue::math::{DVec3, Ray};

const RAYS: usize = 1 << 16;
const ROUNDS: usize = 15;
const COUNTS: [usize; 9] = [0, 1, 3, 8, 16, 32, 64, 200, 1000];

struct Random(u64);

impl Random {
    fn unit(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let z = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) >> 11) as f64 * 0.5_f64.powi(53)
    }

    fn in_cube(&mut self, half: f64) -> DVec3 {
        DVec3::new(self.unit(), self.unit(), self.unit()) * (2.0 * half) - half
    }

    fn on_sphere(&mut self) -> DVec3 {
        let z = 2.0 * self.unit() - 1.0;
        let (sin, cos) = (std::f64::consts::TAU * self.unit()).sin_cos();
        let r = (1.0 - z * z).sqrt();
        DVec3::new(r * cos, r * sin, z)
    }
}

#[derive(Clone, Copy)]
struct Sphere {
    centre: DVec3,
    radius: f64,
}

impl Sphere {
    /// The first meeting in [tnear, tfar], in double precision.
    #[inline]
    fn intersect(&self, ray: &Ray) -> Option<f64> {
        let (o, d) = (ray.origin.as_dvec3() - self.centre, ray.direction.as_dvec3());
        let dd = d.length_squared();
        let nearest = -o.dot(d) / dd;
        let rest = self.radius * self.radius - (o + d * nearest).length_squared();
        if rest < 0.0 {
            return None;
        }
        let half = (rest / dd).sqrt();
        let inside = |t: f64| f64::from(ray.tnear) <= t && t <= f64::from(ray.tfar);
        let (first, second) = (nearest - half, nearest + half);
        if inside(first) { Some(first) } else { Some(second).filter(|&t| inside(t)) }
    }
}

struct UserSpheres(Vec<Sphere>);

impl UserGeometry for UserSpheres {
    fn len(&self) -> usize {
        self.0.len()
    }

    fn bounds(&self, index: usize) -> ([f32; 3], [f32; 3]) {
        let Sphere { centre, radius } = self.0[index];
        let corner = |x: DVec3| x.to_array().map(|x| x as f32);
        (corner(centre - radius).map(f32::next_down), corner(centre + radius).map(f32::next_up))
    }

    fn intersect(&self, index: usize, ray: &Ray) -> Option<UserHit> {
        let sphere = &self.0[index];
        let t = sphere.intersect(ray)?;
        let ng = ray.origin.as_dvec3() + ray.direction.as_dvec3() * t - sphere.centre;
        Some(UserHit { t: t as f32, u: 0.0, v: 0.0, ng: ng.as_vec3a() })
    }

    fn occluded(&self, index: usize, ray: &Ray) -> bool {
        self.0[index].intersect(ray).is_some()
    }
}

/// Four spheres side by side, for the rejection test.
#[derive(Clone, Copy, Default)]
struct Four {
    x: [f32; 4],
    y: [f32; 4],
    z: [f32; 4],
    /// Square of the radius; negative where there is no sphere.
    r2: [f32; 4],
}

struct List {
    spheres: Vec<Sphere>,
    fours: Vec<Four>,
}

impl List {
    fn new(spheres: Vec<Sphere>) -> Self {
        let fours = spheres.chunks(4).map(|chunk| {
            let mut four = Four { r2: [f32::NEG_INFINITY; 4], ..Four::default() };
            for (i, s) in chunk.iter().enumerate() {
                (four.x[i], four.y[i], four.z[i]) = (s.centre.x as f32, s.centre.y as f32, s.centre.z as f32);
                four.r2[i] = ((s.radius * s.radius) as f32).next_up();
            }
            four
        });
        Self { fours: fours.collect(), spheres }
    }

    /// Calls `test` with each sphere the line may meet, until it returns true.
    #[inline]
    fn candidates(&self, ray: &Ray, mut test: impl FnMut(usize) -> bool) -> bool {
        let (o, d) = (ray.origin, ray.direction);
        let dd = d.length_squared();
        for (block, four) in self.fours.iter().enumerate() {
            let mut near = [false; 4];
            for (i, near) in near.iter_mut().enumerate() {
                let (x, y, z) = (four.x[i] - o.x, four.y[i] - o.y, four.z[i] - o.z);
                let along = x * d.x + y * d.y + z * d.z;
                let distance2 = x * x + y * y + z * z;
                // |oc|^2 - (oc . d)^2 / |d|^2 <= r^2, with room for the rounding of all terms.
                let outside = distance2 * dd - along * along - four.r2[i] * dd;
                let ahead = (along >= 0.0) | (distance2 <= four.r2[i] * 1.000_01);
                *near = (outside <= 1e-5 * (distance2 * dd)) & ahead;
            }
            if near == [false; 4] {
                continue;
            }
            for (i, near) in near.into_iter().enumerate() {
                if near && test(4 * block + i) {
                    return true;
                }
            }
        }
        false
    }

    #[inline]
    fn intersect(&self, ray: &mut Ray) -> Option<usize> {
        let mut found = None;
        let mut rest = *ray;
        self.candidates(ray, |i| {
            if let Some(t) = self.spheres[i].intersect(&rest) {
                rest.tfar = t as f32;
                found = Some(i);
            }
            false
        });
        *ray = rest;
        found
    }

    #[inline]
    fn occluded(&self, ray: &Ray) -> bool {
        self.candidates(ray, |i| self.spheres[i].intersect(ray).is_some())
    }
}

/// The unit sphere in `2 * sectors * (rings - 1)` triangles.
fn unit_sphere(rings: usize, sectors: usize) -> (Vec<DVec3>, Vec<[u32; 3]>) {
    let point = |ring: usize, sector: usize| {
        let theta = std::f64::consts::PI * ring as f64 / rings as f64;
        let phi = std::f64::consts::TAU * sector as f64 / sectors as f64;
        DVec3::new(theta.sin() * phi.cos(), theta.sin() * phi.sin(), theta.cos())
    };
    let mut vertices = vec![DVec3::Z, -DVec3::Z];
    vertices
        .extend((1..rings).flat_map(|ring| (0..sectors).map(move |sector| (ring, sector))).map(|(r, s)| point(r, s)));
    let at = |ring: usize, sector: usize| (2 + (ring - 1) * sectors + sector % sectors) as u32;
    let mut indices = Vec::new();
    for s in 0..sectors {
        indices.push([0, at(1, s), at(1, s + 1)]);
        indices.push([1, at(rings - 1, s + 1), at(rings - 1, s)]);
        for r in 1..rings - 1 {
            indices.push([at(r, s), at(r + 1, s), at(r + 1, s + 1)]);
            indices.push([at(r, s), at(r + 1, s + 1), at(r, s + 1)]);
        }
    }
    (vertices, indices)
}

fn placed(vertices: &[DVec3], scale: f64, to: DVec3) -> Vec<[f32; 3]> {
    vertices.iter().map(|&v| (v * scale + to).as_vec3a().to_array()).collect()
}

fn boxed(low: DVec3, high: DVec3, out: &mut (Vec<[f32; 3]>, Vec<[u32; 3]>)) {
    let first = out.0.len() as u32;
    let pick = |i: usize, axis: usize| if i >> axis & 1 == 0 { low[axis] } else { high[axis] } as f32;
    out.0.extend((0..8).map(|i| [pick(i, 0), pick(i, 1), pick(i, 2)]));
    for [a, b, c, d] in [[0, 4, 6, 2], [1, 3, 7, 5], [0, 1, 5, 4], [2, 6, 7, 3], [0, 2, 3, 1], [4, 5, 7, 6]] {
        out.1.extend([[a, b, c], [a, c, d]].map(|t: [u32; 3]| t.map(|i| i + first)));
    }
}

/// A room of 36 large triangles, furniture included, and an object of 240.
fn room() -> Result<[TriangleMesh; 2]> {
    let mut walls = (Vec::new(), Vec::new());
    boxed(DVec3::splat(-1.0), DVec3::splat(1.0), &mut walls);
    boxed(DVec3::new(-0.7, -0.6, -1.0), DVec3::new(-0.2, -0.1, 0.0), &mut walls);
    boxed(DVec3::new(0.2, 0.1, -1.0), DVec3::new(0.7, 0.6, -0.4), &mut walls);
    let (vertices, indices) = unit_sphere(9, 15);
    let object = TriangleMesh::new(placed(&vertices, 0.3, DVec3::new(0.45, 0.35, -0.1)), indices)?;
    Ok([TriangleMesh::new(walls.0, walls.1)?, object])
}

fn build(device: &Device, add: impl FnOnce(&mut SceneBuilder) -> Result<()>) -> Result<Scene> {
    let mut builder = SceneBuilder::new(device, SceneOptions::default())?;
    for mesh in room()? {
        builder.add_triangles(mesh)?;
    }
    add(&mut builder)?;
    builder.commit(None)
}

/// One way: a name, and how many of the rays it finds to hit a thing nearer than the room's size.
type Way<'a> = (&'static str, Box<dyn Fn(&[Ray]) -> usize + Sync + 'a>);

/// Millions of rays a second for each way, the median of interleaved rounds.
fn time(ways: &[Way], rays: &[Ray], threads: usize) -> Vec<f64> {
    let mut seconds = vec![Vec::new(); ways.len()];
    for round in 0..=ROUNDS {
        for (way, seconds) in ways.iter().zip(&mut seconds) {
            let start = Instant::now();
            if threads == 1 {
                black_box(way.1(rays));
            } else {
                std::thread::scope(|scope| {
                    for part in rays.chunks(rays.len().div_ceil(threads)) {
                        scope.spawn(move || black_box(way.1(part)));
                    }
                });
            }
            // The first round only warms up.
            if round > 0 {
                seconds.push(start.elapsed().as_secs_f64());
            }
        }
    }
    seconds
        .into_iter()
        .map(|mut all| {
            all.sort_by(f64::total_cmp);
            rays.len() as f64 / all[all.len() / 2] * 1e-6
        })
        .collect()
}

fn main() -> Result<()> {
    let device = Device::new(&DeviceOptions::default())?;
    let mut random = Random(1);
    let closest: Vec<Ray> =
        (0..RAYS).map(|_| Ray::new(random.in_cube(0.99).as_vec3a(), random.on_sphere().as_vec3a())).collect();
    let shadow: Vec<Ray> = (0..RAYS)
        .map(|_| {
            let (from, to) = (random.in_cube(0.99), random.in_cube(0.99));
            Ray { tfar: 0.999, ..Ray::new(from.as_vec3a(), (to - from).as_vec3a()) }
        })
        .collect();
    println!(
        "{:>7} {:>8} {:>8} {:>10} {:>10} {:>10} {:>10}",
        "spheres", "rays", "threads", "primitive", "user", "list", "triangles"
    );
    for count in COUNTS {
        // The same share of the room whatever the number.
        let radius = 0.25 / (count.max(1) as f64).cbrt();
        let spheres: Vec<Sphere> =
            (0..count).map(|_| Sphere { centre: random.in_cube(1.0 - radius), radius }).collect();
        let single = |s: &Sphere| [s.centre.x as f32, s.centre.y as f32, s.centre.z as f32, s.radius as f32];
        let bare = build(&device, |_| Ok(()))?;
        let primitive = build(&device, |builder| match count {
            0 => Ok(()),
            _ => builder.add_spheres(spheres.iter().map(single).collect()).map(|_| ()),
        })?;
        let user = build(&device, |builder| match count {
            0 => Ok(()),
            _ => builder.add_user(Arc::new(UserSpheres(spheres.clone()))).map(|_| ()),
        })?;
        let (vertices, indices) = unit_sphere(16, 16);
        let triangles = build(&device, |builder| {
            for sphere in &spheres {
                let mesh = TriangleMesh::new(placed(&vertices, sphere.radius, sphere.centre), indices.clone())?;
                builder.add_triangles(mesh)?;
            }
            Ok(())
        })?;
        let list = List::new(spheres);

        let sum = |scene: &Scene, rays: &[Ray]| {
            rays.iter().filter(|ray| scene.intersect(ray).is_some_and(|hit| hit.geom > 1)).count()
        };
        let any = |scene: &Scene, rays: &[Ray]| rays.iter().filter(|ray| scene.occluded(ray)).count();
        let (bare, list) = (&bare, &list);
        let listed = |rays: &[Ray]| {
            let met = |ray: &Ray| {
                let mut ray = *ray;
                let sphere = list.intersect(&mut ray);
                bare.intersect(&ray).is_none() && sphere.is_some()
            };
            rays.iter().filter(|ray| met(ray)).count()
        };
        let listed_any = |rays: &[Ray]| rays.iter().filter(|ray| list.occluded(ray) || bare.occluded(ray)).count();
        let intersect: [Way; 4] = [
            ("primitive", Box::new(|rays| sum(&primitive, rays))),
            ("user", Box::new(|rays| sum(&user, rays))),
            ("list", Box::new(listed)),
            ("triangles", Box::new(|rays| sum(&triangles, rays))),
        ];
        let occluded: [Way; 4] = [
            ("primitive", Box::new(|rays| any(&primitive, rays))),
            ("user", Box::new(|rays| any(&user, rays))),
            ("list", Box::new(listed_any)),
            ("triangles", Box::new(|rays| any(&triangles, rays))),
        ];
        for (kind, ways, rays) in [("closest", &intersect, &closest), ("shadow", &occluded, &shadow)] {
            // The exact ways must find the same; the others nearly.
            let found: Vec<usize> = ways.iter().map(|way| way.1(rays)).collect();
            assert_eq!(found[1], found[2], "{kind}: user geometry and list disagree");
            for threads in [1, 2] {
                let speed = time(ways, rays, threads);
                println!(
                    "{count:>7} {kind:>8} {threads:>8} {:>10.2} {:>10.2} {:>10.2} {:>10.2}",
                    speed[0], speed[1], speed[2], speed[3]
                );
            }
        }
    }
    Ok(())
}
