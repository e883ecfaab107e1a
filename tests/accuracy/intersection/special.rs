//! Rays of odd numbers: zeros of both signs, denormals, directions of any length, and rays that are none.

use std::time::Instant;

use etendue::desc::{SceneDesc, ShapeDesc};
use etendue::math::{Bounds, DVec3, Ray, Vec3};
use etendue::scene::Scene;

use super::{PLACES, build, cube, in_cube, on_sphere, range, ray, shapes, tally};
use crate::record::{Case, Entry, ulp};

pub fn cases() -> Vec<Entry> {
    vec![
        Entry { id: "I15", title: "special directions", run: special_directions },
        Entry { id: "I16", title: "rays that are none", run: no_rays },
        Entry { id: "I17", title: "directions of any length", run: lengths },
    ]
}

/// A cube from -1 to 1 and, inside it, a ball, a tube, a cone and a disk.
fn cabinet() -> SceneDesc {
    let clip = Bounds { min: DVec3::splat(-0.25), max: DVec3::splat(0.25) };
    let tube = [1.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, -0.04];
    let cone = [1.0, 1.0, -1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0];
    let mut desc = shapes(
        DVec3::ZERO,
        vec![
            ShapeDesc::Mesh { mesh: 0, smooth: false },
            ShapeDesc::Sphere { centre: DVec3::splat(0.5), radius: 0.25 },
            ShapeDesc::Quadric { coefficients: tube, clip },
            ShapeDesc::Quadric { coefficients: cone, clip },
            ShapeDesc::Disk { centre: DVec3::splat(-0.5), normal: DVec3::Y, radius: 0.25 },
        ],
    );
    desc.surfaces[2].transform.translation = DVec3::new(0.5, -0.5, 0.5);
    desc.surfaces[3].transform.translation = DVec3::new(-0.5, 0.5, 0.5);
    desc.meshes.push(cube(DVec3::ZERO).into());
    desc
}

/// All that a ray finds out.
fn answer(scene: &Scene, ray: &Ray) -> Option<(u32, u32, bool)> {
    let hit = scene.intersect(ray)?;
    Some((hit.t.to_bits(), scene.interaction(ray, &hit).surface, scene.unoccluded(ray)))
}

/// What stands for zero in a direction.
const ZEROS: [f32; 8] = [0.0, -0.0, 1e-38, -1e-38, 1e-40, -1e-40, 1e-45, -1e-45];

fn special_directions(case: &mut Case) {
    for (listed, place) in PLACES {
        let scene = build(&cabinet(), listed);
        let tries = case.count(20_000, 4_000_000);
        let [signs, plane, flushed] = tally(tries, 150, |rng| {
            let axis = (rng.next_u64() % 3) as usize;
            let zero = |rng: &mut etendue::sampling::Rng| ZEROS[(rng.next_u64() % 8) as usize];
            let mut direction = [zero(rng), zero(rng), zero(rng)];
            direction[axis] = if rng.next_u64() & 1 == 0 { 1.0 } else { -1.0 };
            let mut rounded = [0.0; 3];
            rounded[axis] = direction[axis];
            let odd = Ray::new(in_cube(rng, 1.5).as_vec3a(), Vec3::from(direction));
            let plain = Ray { direction: Vec3::from(rounded), ..odd };
            let signs = answer(&scene, &odd) != answer(&scene, &plain);
            // The origin on a plane of the cube, the scene's box: 0 times infinity in a slab test. The face in that plane is
            // met where the ray starts or not at all, so the segment begins a little later.
            let mut origin = odd.origin.to_array();
            origin[(axis + 1) % 3] = if rng.next_u64() & 1 == 0 { 1.0 } else { -1.0 };
            if rng.next_u64() & 1 == 0 {
                origin[axis] = -direction[axis];
            }
            let [odd_plane, plain_plane] =
                [odd, plain].map(|ray| Ray { origin: Vec3::from(origin), tnear: 1e-6, ..ray });
            let plane = answer(&scene, &odd_plane) != answer(&scene, &plain_plane);
            let flushed = [odd, odd_plane].iter().any(|ray| with_denormals_flushed(&scene, ray) != answer(&scene, ray));
            [signs, plane, flushed]
        });
        case.never(format!("shapes in the {place}: another answer than with zeros"), signs, tries);
        case.never(format!("shapes in the {place}: another answer from a plane of the box"), plane, tries);
        case.never(format!("shapes in the {place}: another answer with denormals flushed"), flushed, tries);
    }
}

/// The answer while the processor treats denormal numbers as zero, as some hosts have it.
#[cfg(target_arch = "x86_64")]
fn with_denormals_flushed(scene: &Scene, ray: &Ray) -> Option<(u32, u32, bool)> {
    struct Job<'a> {
        scene: &'a Scene,
        ray: &'a Ray,
        answer: Option<(u32, u32, bool)>,
    }
    extern "C" fn run(job: &mut Job) {
        job.answer = answer(job.scene, job.ray);
    }
    let mut job = Job { scene, ray, answer: None };
    let mut before = 0_u32;
    let mut flushing = 0_u32;
    // SAFETY: `run` is a C function of one argument, which is called as such with the stack aligned (no `nostack`) and all
    // that it may overwrite declared; it does not unwind. Bits 6 and 15 of the control register, which it is called with,
    // change the results of arithmetic on denormals and nothing else, and the register is as it was when the block ends.
    #[allow(unsafe_code)]
    unsafe {
        std::arch::asm!(
            "stmxcsr [r12]",
            "mov eax, dword ptr [r12]",
            "or eax, 0x8040",
            "mov dword ptr [r13], eax",
            "ldmxcsr [r13]",
            "call {run}",
            "ldmxcsr [r12]",
            run = sym run,
            // Registers that a C function leaves as they are.
            in("r12") &raw mut before,
            in("r13") &raw mut flushing,
            in("rdi") &raw mut job,
            clobber_abi("C"),
        );
    }
    job.answer
}

/// Elsewhere there is nothing to compare with.
#[cfg(not(target_arch = "x86_64"))]
fn with_denormals_flushed(scene: &Scene, ray: &Ray) -> Option<(u32, u32, bool)> {
    answer(scene, ray)
}

fn no_rays(case: &mut Case) {
    let good = Ray::new(Vec3::new(0.1, 0.2, 0.3), Vec3::new(0.5, 0.6, 0.7));
    let odd = [f32::NAN, f32::INFINITY, f32::NEG_INFINITY];
    let mut bad = Vec::new();
    for x in odd {
        for y in odd.into_iter().chain([0.0, 1.0]) {
            for axis in 0..3 {
                let mut ray = good;
                ray.origin[axis] = x;
                ray.origin[(axis + 1) % 3] = y;
                bad.push(ray);
                let mut ray = good;
                ray.direction[axis] = x;
                ray.direction[(axis + 1) % 3] = y;
                bad.push(ray);
                ray.origin[axis] = x;
                bad.push(ray);
            }
        }
    }
    bad.extend([Vec3::ZERO, -Vec3::ZERO].map(|direction| Ray { direction, ..good }));
    bad.extend([f32::NAN, -1.0, f32::NEG_INFINITY].map(|tnear| Ray { tnear, ..good }));
    bad.extend([f32::NAN, -1.0, f32::NEG_INFINITY].map(|tfar| Ray { tfar, ..good }));
    for (listed, place) in PLACES {
        let scene = build(&cabinet(), listed);
        assert!(scene.intersect(&good).is_some());
        let met = bad.iter().filter(|ray| scene.intersect(ray).is_some() || !scene.unoccluded(ray)).count();
        case.never(format!("shapes in the {place}: something met"), met as u64, bad.len() as u64);
        if case.is_full() {
            let mut rng = etendue::sampling::Rng::new(160, 0);
            let rays: Vec<Ray> = (0..bad.len()).map(|_| ray(in_cube(&mut rng, 0.9), on_sphere(&mut rng))).collect();
            // The least of many, which no other program on the machine can lengthen.
            let time = |rays: &[Ray]| {
                let once = || {
                    let start = Instant::now();
                    for _ in 0..100 {
                        for ray in rays {
                            std::hint::black_box(scene.intersect(ray));
                        }
                    }
                    start.elapsed().as_secs_f64()
                };
                (0..50).map(|_| once()).fold(f64::INFINITY, f64::min)
            };
            case.at_most(format!("shapes in the {place}: time against a ray's"), time(&bad) / time(&rays), 2.5);
        }
    }
}

/// t times the length of the direction is the same for all lengths; and the point that is met.
fn lengths(case: &mut Case) {
    let corner = |x: f64, y: f64| DVec3::new(x, y, 3.0);
    let quad = ShapeDesc::Quad([corner(-2.0, -2.0), corner(2.0, -2.0), corner(2.0, 2.0), corner(-2.0, 2.0)]);
    let sphere = ShapeDesc::Sphere { centre: DVec3::new(0.0, 0.0, 4.0), radius: 1.0 };
    let quadric = ShapeDesc::Quadric { coefficients: super::BALL, clip: super::EVERYWHERE };
    let disk = ShapeDesc::Disk { centre: DVec3::new(0.0, 0.0, 3.0), normal: DVec3::NEG_Z, radius: 2.0 };
    for (name, shape, listed) in [
        ("triangles", quad, 16),
        ("sphere in the list", sphere, 16),
        ("sphere in the tree", sphere, 0),
        ("quadric in the list", quadric, 16),
        ("quadric in the tree", quadric, 0),
        ("disk", disk, 16),
    ] {
        let mut desc = shapes(DVec3::ZERO, vec![shape]);
        let is_ball = name.starts_with("sphere") || name.starts_with("quadric");
        if name.starts_with("quadric") {
            desc.surfaces[0].transform.translation = DVec3::Z * 4.0;
        }
        let scene = build(&desc, listed);
        let tries = case.count(20_000, 4_000_000);
        let [missed, off, off_point] = tally(tries, 170, |rng| {
            let target = DVec3::new(range(rng, -0.6, 0.6), range(rng, -0.4, 0.4), 3.5);
            let length = 10_f64.powf(range(rng, -10.0, 10.0));
            let ray = Ray::new(scene.to_scene(DVec3::ZERO), (target * length).as_vec3a());
            // The exact t of the ray as it was rounded.
            let d = ray.direction.as_dvec3();
            let (origin, length2) = (ray.origin.as_dvec3() + scene.centre(), d.length_squared());
            let exact = if is_ball {
                let to_origin = origin - DVec3::Z * 4.0;
                let foot = -to_origin.dot(d) / length2;
                let nearest = (to_origin + foot * d).length();
                foot - ((1.0 - nearest) * (1.0 + nearest) / length2).sqrt()
            } else {
                (3.0 - origin.z) / d.z
            };
            let Some(hit) = scene.intersect(&ray) else { return [true, false, false] };
            let p = scene.interaction(&ray, &hit).point.p.as_dvec3() + scene.centre();
            let off_point = p.distance(origin + exact * d) > 4e-6;
            [scene.unoccluded(&ray), (f64::from(hit.t) - exact).abs() > 4.0 * ulp(exact), off_point]
        });
        case.never(format!("{name}, lengths of 1e-10 to 1e10: missed"), missed, tries);
        case.never(format!("{name}: t off by > 4 ulp"), off, tries);
        case.never(format!("{name}: point off by > 4e-6"), off_point, tries);
    }
}
