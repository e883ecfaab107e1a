//! What the C interface costs: calls through it against the Rust they wrap, edits, cancelling.
//!
//! Calls the exported functions themselves. Reports, for the report's room and a mesh of a million triangles
//! (`make meshes`):
//!
//! - rays/s of `etd_scene_intersect` for many rays and for one ray a call, against the same queries in Rust and against
//!   the bare search without normals, and against Embree's own call; the same of `etd_scene_query` by what is wanted and threads;
//! - what it takes to map a film of 4K pixels;
//! - time from an edit to the end of the first pass of the next render, against the time of a whole build;
//! - time from `etd_task_cancel` to the end of the task, over all integrators, phases and random moments.
//!
//! `cargo bench --features capi --bench hosts`

use std::ffi::{CStr, CString, c_void};
use std::hint::black_box;
use std::ptr::{null, null_mut};
use std::time::{Duration, Instant};

use etendue::capi::*;
use etendue::math::{Ray, Vec3};
use etendue::sampling::Rng;
use etendue::scene::{BuildOptions, Scene};

/// Tries of cancelling.
const TRIES: usize = 200;

const ROUNDS: usize = 9;

fn check(status: etd_status) {
    // SAFETY: the message is a C string of this thread.
    let message = unsafe { CStr::from_ptr(etd_last_error_message()) };
    assert_eq!(status, ETD_OK, "{}", message.to_string_lossy());
}

/// A structure of zeros that says its size.
fn sized<T>() -> T {
    // SAFETY: the structures of the interface are valid when zero, and begin with their size.
    unsafe {
        let mut value: T = std::mem::zeroed();
        (&raw mut value).cast::<usize>().write(size_of::<T>());
        value
    }
}

/// Handles, given back at the end.
struct Host {
    device: *mut etd_device,
    scene: *mut etd_scene,
}

impl Host {
    fn new(path: &str, threads: u32) -> Self {
        let path = CString::new(path).expect("no zero byte");
        let mut host = Self { device: null_mut(), scene: null_mut() };
        let options = etd_device_options { threads, ..sized() };
        // SAFETY: all pointers are to what they say.
        unsafe {
            check(etd_device_new(&raw const options, &raw mut host.device));
            check(etd_scene_from_file(host.device, path.as_ptr(), null(), &raw mut host.scene));
        }
        host
    }

    fn commit(&self) {
        // SAFETY: the handle is alive.
        check(unsafe { etd_scene_commit(self.scene, None, null_mut()) });
    }

    fn film(&self, width: u32, height: u32) -> *mut etd_film {
        let mut film = null_mut();
        let options = etd_film_options { width, height, ..sized() };
        // SAFETY: all pointers are to what they say.
        check(unsafe { etd_film_new(self.device, &raw const options, &raw mut film) });
        film
    }
}

impl Drop for Host {
    fn drop(&mut self) {
        // SAFETY: both are given back once.
        unsafe {
            etd_scene_release(self.scene);
            etd_device_release(self.device);
        }
    }
}

fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    values[values.len() / 2]
}

/// Seconds of the fastest of several rounds.
fn fastest(mut work: impl FnMut()) -> f64 {
    (0..ROUNDS)
        .map(|_| {
            let start = Instant::now();
            work();
            start.elapsed().as_secs_f64()
        })
        .fold(f64::INFINITY, f64::min)
}

/// Rays from around the scene's box into it.
fn rays(scene: &Scene, count: usize) -> Vec<etd_ray> {
    let bounds = scene.info().bounds;
    let mut rng = Rng::new(5, 0);
    let mut point = || {
        let u = etendue::math::DVec3::new(rng.next_f32().into(), rng.next_f32().into(), rng.next_f32().into());
        bounds.min + u * (bounds.max - bounds.min)
    };
    (0..count)
        .map(|_| {
            let (from, to) = (point(), point());
            let direction = (to - from).normalize().as_vec3();
            etd_ray {
                origin: from.as_vec3().to_array(),
                tnear: 0.0,
                direction: direction.to_array(),
                tfar: f32::INFINITY,
            }
        })
        .collect()
}

fn queries(path: &str) {
    let host = Host::new(path, 1);
    host.commit();
    let desc = etendue::desc::load(path.as_ref(), None).expect("a scene");
    let scene = Scene::build(&desc, &BuildOptions { threads: 1, ..BuildOptions::default() }).expect("a scene");
    let rays = rays(&scene, 200_000);
    let centre = scene.centre();
    let in_scene: Vec<Ray> = rays
        .iter()
        .map(|ray| {
            let origin = etendue::math::DVec3::from_array(ray.origin.map(f64::from)) - centre;
            Ray::new(origin.as_vec3a(), Vec3::from_array(ray.direction))
        })
        .collect();
    // SAFETY: zero is a value of a hit.
    let mut hits = vec![unsafe { std::mem::zeroed::<etd_hit>() }; rays.len()];
    let batch = fastest(|| {
        // SAFETY: as many hits as rays.
        check(unsafe { etd_scene_intersect(host.scene, rays.as_ptr(), rays.len(), hits.as_mut_ptr()) });
    });
    let single = fastest(|| {
        for (ray, hit) in rays.iter().zip(&mut hits) {
            // SAFETY: one ray and one hit.
            check(unsafe { etd_scene_intersect(host.scene, ray, 1, hit) });
        }
    });
    let mut described = Vec::with_capacity(rays.len());
    let rust = fastest(|| {
        described.clear();
        described.extend(in_scene.iter().map(|ray| scene.intersect(ray).map(|hit| scene.describe_hit(ray, &hit))));
        black_box(&described);
    });
    let bare = fastest(|| {
        for ray in &in_scene {
            black_box(scene.intersect(ray));
        }
    });
    let kernel = scene.kernel().expect("a scene with triangles");
    let raw = fastest(|| {
        for ray in &in_scene {
            black_box(kernel.intersect(ray));
        }
    });
    let raw_occluded = fastest(|| {
        for ray in &in_scene {
            black_box(kernel.occluded(ray));
        }
    });
    let mut blocked = vec![0_u8; rays.len()];
    let occluded = fastest(|| {
        // SAFETY: as many answers as rays.
        check(unsafe { etd_scene_occluded(host.scene, rays.as_ptr(), rays.len(), blocked.as_mut_ptr()) });
    });
    let query = |threads: u32, host: &Host, want: &dyn Fn(&mut etd_ray_query)| {
        let mut query = etd_ray_query {
            count: rays.len(),
            threads,
            origins: rays[0].origin.as_ptr(),
            origins_stride: size_of::<etd_ray>(),
            directions: rays[0].direction.as_ptr(),
            directions_stride: size_of::<etd_ray>(),
            ..sized()
        };
        want(&mut query);
        // SAFETY: the columns have as many values as there are rays.
        fastest(|| check(unsafe { etd_scene_query(host.scene, &raw const query) }))
    };
    let (mut t, mut surfaces, mut primitives) = (vec![0.0; rays.len()], vec![0; rays.len()], vec![0; rays.len()]);
    let mut normals = vec![[0.0; 3]; rays.len()];
    let (t, surfaces, primitives) = (t.as_mut_ptr(), surfaces.as_mut_ptr(), primitives.as_mut_ptr());
    let normals = normals.as_mut_ptr().cast();
    type Want<'a> = &'a dyn Fn(&mut etd_ray_query);
    let wants: [(&str, Want<'_>); 3] = [
        ("t", &|query| query.t = t),
        ("t, surface, primitive", &|query| (query.t, query.surfaces, query.primitives) = (t, surfaces, primitives)),
        ("t, ng", &|query| (query.t, query.ng) = (t, normals)),
    ];
    let two = Host::new(path, 2);
    two.commit();
    let rate = |seconds: f64| rays.len() as f64 / seconds / 1e6;
    println!("{path}: {} rays, one thread", rays.len());
    println!(
        "  rtcIntersect1 of the scene's kernel   {:6.2} Mrays/s; rtcOccluded1 {:.2}",
        rate(raw),
        rate(raw_occluded)
    );
    println!(
        "  etd_scene_occluded                    {:6.2} Mrays/s = {:.3} of it",
        rate(occluded),
        raw_occluded / occluded
    );
    println!("  etd_scene_intersect, all in one call  {:6.2} Mrays/s = {:.3} of it", rate(batch), raw / batch);
    println!("  etd_scene_intersect, one ray a call   {:6.2} Mrays/s = {:.3} of it", rate(single), raw / single);
    for (name, want) in wants {
        let (one, both) = (query(1, &host, want), query(2, &two, want));
        println!(
            "  etd_scene_query, {name:22} {:6.2} Mrays/s = {:.3} of it; two threads {:6.2} = {:.2} times",
            rate(one),
            raw / one,
            rate(both),
            one / both
        );
    }
    println!("  etd_scene_intersect, all in one call  {:6.2} Mrays/s = {:.3} of Rust", rate(batch), rust / batch);
    println!("  etd_scene_intersect, one ray a call   {:6.2} Mrays/s = {:.3} of Rust", rate(single), rust / single);
    println!("  Scene::intersect and describe_hit     {:6.2} Mrays/s", rate(rust));
    println!("  Scene::intersect alone                {:6.2} Mrays/s = {:.3} of it reached", rate(bare), bare / batch);
}

fn mapping() {
    let host = Host::new("scenes/cornell.json", 0);
    let film = host.film(3840, 2160);
    let options = etd_render_options { samples: 1, integrator: 2, ..sized() };
    // SAFETY: all pointers are to what they say.
    unsafe {
        check(etd_render(host.scene, film, &raw const options));
        let mut map: etd_map = sized();
        let seconds = fastest(|| {
            check(etd_film_map(film, ETD_LAYER_COLOR as u32, &raw mut map));
            check(etd_film_unmap(film, &raw mut map));
        });
        check(etd_film_map(film, ETD_LAYER_COLOR as u32, &raw mut map));
        let mut again: etd_map = sized();
        check(etd_film_map(film, ETD_LAYER_COLOR as u32, &raw mut again));
        println!(
            "mapping {} x {}: {:.2} us; two maps give the same address: {}",
            map.width,
            map.height,
            1e6 * seconds,
            map.data == again.data
        );
        etd_film_release(film);
    }
}

/// When the first pass was complete, after the start.
struct FirstPass {
    start: Instant,
    complete: Option<Duration>,
}

unsafe extern "C" fn on_progress(data: *mut c_void, progress: *const etd_progress) -> i32 {
    // SAFETY: `data` is the `FirstPass` of the call below, on whose thread this is called.
    let (first, progress) = unsafe { (&mut *data.cast::<FirstPass>(), &*progress) };
    if progress.phase == ETD_PHASE_RENDER && progress.samples_done > 0 {
        first.complete.get_or_insert(first.start.elapsed());
        return 1;
    }
    0
}

fn edits(path: &str) {
    let host = Host::new(path, 0);
    let film = host.film(16, 16);
    let first_pass = || {
        let mut first = FirstPass { start: Instant::now(), complete: None };
        let options = etd_render_options {
            samples: 1024,
            progress: Some(on_progress),
            user_data: (&raw mut first).cast(),
            ..sized()
        };
        let mut summary: etd_summary = sized();
        // SAFETY: all pointers are to what they say.
        unsafe {
            assert_eq!(etd_render(host.scene, film, &raw const options), ETD_CANCELLED);
            check(etd_film_get_summary(film, &raw mut summary));
        }
        (first.complete.map_or(f64::NAN, |time| time.as_secs_f64()), summary.build_time)
    };
    let (_, whole) = first_pass();
    println!("{path}: whole build {:.1} ms; 16 x 16 pixels, from the edit to", 1e3 * whole);
    // SAFETY: all pointers are to what they say.
    let edit = |name: &str, change: &dyn Fn(usize)| {
        let mut built = Vec::new();
        let mut complete = Vec::new();
        for round in 0..ROUNDS {
            change(round);
            let (time, build) = first_pass();
            built.push(build);
            complete.push(time);
        }
        let (built, complete) = (median(built), median(complete));
        println!(
            "  {name:<22} built {:8.3} ms = {:7.4} % of the whole; first pass complete {:8.3} ms = {:6.3} %",
            1e3 * built,
            100.0 * built / whole,
            1e3 * complete,
            100.0 * complete / whole
        );
    };
    edit("nothing", &|_| ());
    edit("a material", &|round| {
        let color = [0.1 + 0.05 * round as f32; 3];
        let material = etd_material { bsdf: ETD_BSDF_LAMBERT as u32, color, ..sized() };
        // SAFETY: all pointers are to what they say.
        check(unsafe { etd_scene_set_material(host.scene, 0, &raw const material) });
    });
    edit("the camera", &|round| {
        let mut camera: etd_camera = sized();
        // SAFETY: all pointers are to what they say.
        unsafe {
            check(etd_scene_get_camera(host.scene, &raw mut camera));
            camera.origin[0] += 0.01 * (round + 1) as f64;
            check(etd_scene_set_camera(host.scene, &raw const camera));
        }
    });
    edit("a transform", &|round| {
        let rows = [1.0, 0.0, 0.0, 0.01 * (round + 1) as f64, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0];
        // SAFETY: all pointers are to what they say.
        check(unsafe { etd_scene_set_transform(host.scene, 0, rows.as_ptr()) });
    });
    edit("one more sphere", &|round| {
        let surface = etd_surface { material: 0, ..sized() };
        let mut number = 0;
        // SAFETY: all pointers are to what they say.
        check(unsafe {
            let centre = [0.1 * round as f64, 2.0, 0.0];
            etd_scene_add_sphere(host.scene, centre.as_ptr(), 0.05, &raw const surface, &raw mut number)
        });
    });
    // SAFETY: given back once.
    unsafe { etd_film_release(film) };
}

/// What an edit of a scene of many small surfaces costs, in milliseconds with the commit: the move of one of a hundred instances, a
/// material and the camera, beside a build.
fn many_surfaces(triangles: bool) {
    let what = if triangles { "triangles" } else { "spheres" };
    println!(
        "100 instances and single {what}: build, move of an instance, of a {}, material, camera [ms]",
        &what[..what.len() - 1]
    );
    for count in [0_u32, 1000, 10_000, 50_000, 200_000] {
        let mut host = Host { device: null_mut(), scene: null_mut() };
        let options = etd_device_options { threads: 0, ..sized() };
        let scene_options = etd_scene_options { usage: ETD_USAGE_DYNAMIC as u32, ..sized() };
        let mut number = 0;
        // SAFETY: all pointers are to what they say.
        unsafe {
            check(etd_device_new(&raw const options, &raw mut host.device));
            check(etd_scene_new(host.device, &raw const scene_options, &raw mut host.scene));
            let material = etd_material { bsdf: ETD_BSDF_LAMBERT as u32, color: [0.5; 3], ..sized() };
            check(etd_scene_add_material(host.scene, c"grey".as_ptr(), &raw const material, &raw mut number));
            let side = 20_u32;
            let positions: Vec<[f32; 3]> =
                (0..=side * side).map(|i| [(i % side) as f32 * 0.05, (i / side) as f32 * 0.05, 0.0]).collect();
            let indices: Vec<[u32; 3]> = (0..side * (side - 1) - 1).map(|i| [i, i + 1, i + side]).collect();
            let mesh = etd_mesh {
                positions: positions.as_ptr().cast(),
                vertex_count: positions.len(),
                indices: indices.as_ptr().cast(),
                triangle_count: indices.len(),
                ..sized()
            };
            let mut mesh_number = 0;
            check(etd_scene_add_mesh(host.scene, &raw const mesh, &raw mut mesh_number));
            let mut surface = etd_surface { material: 0, ..sized() };
            surface.transform = [1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0];
            for i in 0..100 {
                surface.transform[3] = 2.0 * f64::from(i);
                check(etd_scene_add_mesh_surface(host.scene, mesh_number, 0, &raw const surface, &raw mut number));
            }
            surface.transform[3] = 0.0;
            let mut rng = Rng::new(3, 0);
            for _ in 0..count {
                let mut next = || f64::from(rng.next_f32());
                let centre = [200.0 * next(), 20.0 * next(), -1.0 - 20.0 * next()];
                if triangles {
                    let [x, y, z] = centre;
                    let corners = [[x, y, z], [x + 0.1, y, z], [x, y + 0.1, z]];
                    let corners = corners.as_ptr().cast();
                    check(etd_scene_add_triangle(host.scene, corners, &raw const surface, &raw mut number));
                } else {
                    check(etd_scene_add_sphere(host.scene, centre.as_ptr(), 0.05, &raw const surface, &raw mut number));
                }
            }
            let start = Instant::now();
            host.commit();
            let build = 1e3 * start.elapsed().as_secs_f64();
            let edit = |change: &dyn Fn(usize)| {
                let time = |round| {
                    let start = Instant::now();
                    change(round);
                    host.commit();
                    1e3 * start.elapsed().as_secs_f64()
                };
                median((0..ROUNDS).map(time).collect())
            };
            let shifted = |number: u32| {
                move |round: usize| {
                    let rows = [1.0, 0.0, 0.0, 0.01 * (round + 1) as f64, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0];
                    check(etd_scene_set_transform(host.scene, number, rows.as_ptr()));
                }
            };
            let instance = edit(&shifted(0));
            let small = if count > 0 { edit(&shifted(100 + count / 2)) } else { f64::NAN };
            let material = edit(&|round| {
                let color = [0.1 + 0.05 * round as f32; 3];
                let material = etd_material { bsdf: ETD_BSDF_LAMBERT as u32, color, ..sized() };
                check(etd_scene_set_material(host.scene, 0, &raw const material));
            });
            let camera = edit(&|round| {
                let mut camera: etd_camera = sized();
                check(etd_scene_get_camera(host.scene, &raw mut camera));
                camera.origin = [1.0 + 0.01 * round as f64, 0.0, 5.0];
                check(etd_scene_set_camera(host.scene, &raw const camera));
            });
            println!("  {count:7}: {build:8.2} {instance:8.3} {small:8.3} {material:8.3} {camera:8.3}");
        }
    }
}

fn cancelling(scenes: &[&str]) {
    let mut rng = Rng::new(9, 0);
    let mut building = Vec::new();
    let mut rendering = Vec::new();
    while building.len() + rendering.len() < TRIES {
        let number = building.len() + rendering.len();
        let path = scenes[number % scenes.len()];
        let host = Host::new(path, 0);
        let film = host.film(512, 512);
        let options = etd_render_options {
            samples: 1 << 20,
            integrator: (number / scenes.len() % 3) as u32,
            shadow_rays: if number % 7 == 0 { 1024 } else { 1 },
            ..sized()
        };
        let mut task = null_mut();
        let mut progress: etd_progress = sized();
        // SAFETY: all pointers are to what they say.
        unsafe {
            check(etd_render_start(host.scene, film, &raw const options, &raw mut task));
            let delay = f64::from(rng.next_f32()) * if number % 2 == 0 { 0.8 } else { 0.3 };
            std::thread::sleep(Duration::from_secs_f64(delay));
            assert_eq!(etd_task_poll(task, &raw mut progress), ETD_RUNNING);
            let start = Instant::now();
            check(etd_task_cancel(task));
            assert_eq!(etd_task_wait(task, -1.0), ETD_CANCELLED);
            let latency = 1e3 * start.elapsed().as_secs_f64();
            if progress.phase == ETD_PHASE_BUILD {
                building.push(latency)
            } else {
                rendering.push(latency)
            }
            etd_task_release(task);
            etd_film_release(film);
        }
    }
    let largest = |values: &[f64]| values.iter().copied().fold(0.0, f64::max);
    let all: Vec<f64> = building.iter().chain(&rendering).copied().collect();
    for (name, values) in [("while building", building), ("while rendering", rendering), ("together", all)] {
        if !values.is_empty() {
            let (count, largest) = (values.len(), largest(&values));
            println!(
                "cancelled {name:<16} {count:4} tries: median {:6.2} ms, largest {largest:6.2} ms",
                median(values)
            );
        }
    }
}

fn main() {
    // `cargo test --benches` runs this too: nothing is to be timed then.
    if !std::env::args().any(|argument| argument == "--bench") {
        return;
    }
    let million = "scenes/million.json";
    let has_million = std::path::Path::new("out/million.obj").exists();
    if !has_million {
        println!("out/million.obj is missing, what needs it is left out: run `make meshes`");
    }
    queries("scenes/room.json");
    if has_million {
        queries(million);
    }
    mapping();
    many_surfaces(false);
    many_surfaces(true);
    edits("scenes/room.json");
    if has_million {
        edits(million);
    }
    let scenes: &[&str] = if has_million {
        &["scenes/room.json", million, "scenes/cornell.json", "scenes/caustic.json"]
    } else {
        &["scenes/room.json", "scenes/cornell.json", "scenes/caustic.json"]
    };
    cancelling(scenes);
}
