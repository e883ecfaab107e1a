//! What the robust mechanisms cost, one by one.
//!
//! Records every ray that path tracing a scene asks for, then times in turn, in one process, with and without:
//!
//! - Embree's robust mode, against its fast mode on the same triangles;
//! - hit points rebuilt from the primitive in double precision with a bound on their error, and rays that start that far
//!   off the surface, against origin + t * direction with a fixed epsilon along the kernel's normal;
//! - spheres intersected in double precision, set up from the nearest point of the ray, against the textbook's quadratic
//!   in single precision.
//!
//! Nanoseconds per ray of each, and what share of the integrator's time a ray they make. The shift of the scene to the
//! camera is done once at build and costs no ray anything.
//!
//! `cargo bench --bench robust -- [SCENE.json ...]`

#[path = "recorded/polygons.rs"]
mod polygons;
mod recorded;

use std::hint::black_box;
use std::path::Path as FilePath;

use etendue::camera::Camera;
use etendue::desc::{self, SceneDesc, ShapeDesc};
use etendue::integrator::SceneTracer;
use etendue::math::{DVec3, Ray, Vec3};
use etendue::scene::{BuildOptions, Scene};
use polygons::{kernel, triangles};
use recorded::{ROUNDS, Rays, record, render_in_waves, rows, time};

const THREADS: usize = 2;

/// Spheres in single precision, by the textbook.
fn spheres(desc: &SceneDesc, centre: DVec3) -> Vec<(Vec3, f32)> {
    let sphere = |shape: &ShapeDesc| match *shape {
        ShapeDesc::Sphere { centre: c, radius } => Some(((c - centre).as_vec3a(), radius as f32)),
        _ => None,
    };
    desc.surfaces.iter().filter_map(|surface| sphere(&surface.shape)).collect()
}

/// The nearest hit of `spheres` in front of the ray.
#[inline]
fn textbook(spheres: &[(Vec3, f32)], ray: &Ray) -> f32 {
    let mut nearest = ray.tfar;
    let a = ray.direction.length_squared();
    for (centre, radius) in spheres {
        let oc = ray.origin - *centre;
        let b = oc.dot(ray.direction);
        let discriminant = b * b - a * (oc.length_squared() - radius * radius);
        if discriminant >= 0.0 {
            let root = discriminant.sqrt();
            let (near, far) = ((-b - root) / a, (-b + root) / a);
            let t = if near > 1e-4 { near } else { far };
            if t > 1e-4 && t < nearest {
                nearest = t;
            }
        }
    }
    nearest
}

/// Times every piece of work in turn, round by round; the best nanoseconds of each per `count`.
fn best<const N: usize>(count: usize, work: [&(dyn Fn(usize) + Sync); N]) -> [f64; N] {
    let mut best = [f64::INFINITY; N];
    for _ in 0..ROUNDS {
        for (best, work) in best.iter_mut().zip(work) {
            *best = best.min(time(THREADS, work));
        }
    }
    best.map(|seconds| 1e9 * seconds * THREADS as f64 / count as f64)
}

fn measure(path: &FilePath) -> etendue::Result<()> {
    let desc = desc::load(path, None)?;
    let scene = Scene::build(&desc, &BuildOptions::default())?;
    let camera = Camera::new(scene.camera(), [recorded::RESOLUTION; 2], scene.centre())?;
    let mesh = triangles(&desc, scene.centre())?;
    let (robust, fast) = (kernel(&scene, &mesh, true)?, kernel(&scene, &mesh, false)?);
    let spheres = spheres(&desc, scene.centre());
    let recorded = record(&scene, &camera, THREADS, false);
    let count: usize = recorded.iter().map(Rays::count).sum();
    let hits: usize = recorded.iter().map(|rays| rays.closest.len()).sum();

    let replay = |thread: usize, intersect: &dyn Fn(&Ray) -> bool, occluded: &dyn Fn(&Ray) -> bool| {
        let rays = &recorded[thread];
        black_box(rays.closest.iter().filter(|ray| intersect(ray)).count());
        black_box(rays.shadow.iter().filter(|ray| occluded(ray)).count());
    };
    let [integrator, robust_ns, fast_ns, listed, single] = best(
        count,
        [
            &|thread| {
                black_box(render_in_waves(&scene, &camera, rows(thread, THREADS), &mut SceneTracer::new(&scene)));
            },
            &|thread| replay(thread, &|ray| robust.intersect(ray).is_some(), &|ray| robust.occluded(ray)),
            &|thread| replay(thread, &|ray| fast.intersect(ray).is_some(), &|ray| fast.occluded(ray)),
            &|thread| replay(thread, &|ray| scene.intersect(ray).is_some(), &|ray| !scene.unoccluded(ray)),
            &|thread| {
                let cut = |ray: &Ray| Ray { tfar: textbook(&spheres, ray), ..*ray };
                let intersect = |ray: &Ray| {
                    let cut = cut(ray);
                    robust.intersect(&cut).is_some() || cut.tfar < ray.tfar
                };
                let occluded = |ray: &Ray| {
                    let cut = cut(ray);
                    cut.tfar < ray.tfar || robust.occluded(&cut)
                };
                replay(thread, &intersect, &occluded);
            },
        ],
    );
    // Where closest-hit rays arrive, the same way twice. Shadow rays arrive nowhere.
    let arrive = |thread: usize, point: &dyn Fn(&Ray) -> Option<Vec3>| {
        let rays = recorded[thread].closest.iter();
        black_box(rays.filter_map(point).fold(Vec3::ZERO, |sum, p| sum + p));
    };
    let [scene_alone, rebuilt, kernel_alone, naive] = best(
        hits,
        [
            &|thread| arrive(thread, &|ray| Some(Vec3::splat(scene.intersect(ray)?.t))),
            &|thread| {
                arrive(thread, &|ray| {
                    let hit = scene.intersect(ray)?;
                    let surface = scene.interaction(ray, &hit);
                    Some(surface.point.offset(surface.ng) + surface.ng)
                });
            },
            &|thread| arrive(thread, &|ray| Some(Vec3::splat(robust.intersect(ray)?.t))),
            &|thread| {
                arrive(thread, &|ray| {
                    let hit = robust.intersect(ray)?;
                    let ng = hit.ng.normalize();
                    Some(ray.at(hit.t) + 1e-4 * ng + ng)
                });
            },
        ],
    );

    let share = hits as f64 / count as f64;
    let costs = [
        ("Embree's robust mode", robust_ns - fast_ns),
        ("rebuilt hit points and their offset", (rebuilt - scene_alone - (naive - kernel_alone)) * share),
        ("spheres in double precision", if spheres.is_empty() { 0.0 } else { listed - single }),
    ];
    let without = integrator - costs.iter().map(|(_, cost)| cost).sum::<f64>();
    let rate = |ns: f64| 1e3 * THREADS as f64 / ns;
    println!("{}, {THREADS} threads, {count} rays:", path.display());
    println!("  integrator {:.2} Mrays/s; without what follows about {:.2}", rate(integrator), rate(without));
    println!("  Embree robust {:.2} Mrays/s, fast {:.2}: {:.3}", rate(robust_ns), rate(fast_ns), fast_ns / robust_ns);
    for (what, cost) in costs {
        println!("  {what}: {cost:.1} ns a ray, {:.1} % of the integrator's", 100.0 * cost / integrator);
    }
    Ok(())
}

fn main() {
    // cargo passes --bench; what is left are scenes.
    let mut scenes: Vec<String> = std::env::args().skip(1).filter(|argument| !argument.starts_with('-')).collect();
    if scenes.is_empty() {
        scenes = ["room", "cornell", "million"].map(|name| format!("scenes/{name}.json")).into();
    }
    for scene in scenes {
        if let Err(error) = measure(scene.as_ref()) {
            eprintln!("{scene}: {error}");
        }
    }
}
