//! The light transport loop allocates nothing.

mod common;

use std::alloc::{GlobalAlloc, Layout, System};
use std::cell::Cell;

use common::scenes::{box_inside, camera, scene};
use etendue::camera::Camera;
use etendue::desc::{BsdfDesc, SceneDesc, ShapeDesc};
use etendue::integrator::reuse::PathReuse;
use etendue::integrator::{Direct, Integrator, Path, Sample, SceneTracer, Whitted};
use etendue::math::DVec3;
use etendue::sampling::{Pattern, PatternSampler, Sampler, SobolSampler};
use etendue::scene::{BuildOptions, Scene};
use etendue::spectrum::Rgb;

/// Counts what the current thread allocates.
struct Counting;

thread_local! {
    static ALLOCATIONS: Cell<usize> = const { Cell::new(0) };
}

// SAFETY: all calls are passed on unchanged.
#[allow(unsafe_code)]
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        ALLOCATIONS.set(ALLOCATIONS.get() + 1);
        // SAFETY: as the caller promised.
        unsafe { System.alloc(layout) }
    }

    unsafe fn dealloc(&self, pointer: *mut u8, layout: Layout) {
        // SAFETY: as the caller promised.
        unsafe { System.dealloc(pointer, layout) }
    }
}

#[global_allocator]
static ALLOCATOR: Counting = Counting;

/// A quad at this height.
fn flat_mirror(y: f64) -> ShapeDesc {
    ShapeDesc::Quad([[-0.5, -0.5], [0.5, -0.5], [0.5, 0.5], [-0.5, 0.5]].map(|[x, z]| DVec3::new(x, y, z)))
}

/// Diffuse emitting walls, a mirror ball, a glass ball, flat mirrors: every kind of event.
fn room() -> SceneDesc {
    let sphere = |x: f64| ShapeDesc::Sphere { centre: DVec3::new(x, 0.0, -0.8), radius: 0.3 };
    let mut desc = scene(
        camera(DVec3::ZERO, DVec3::NEG_Z, 90.0),
        vec![
            (
                ShapeDesc::Mesh { mesh: 0, smooth: true },
                BsdfDesc::OrenNayar { albedo: Rgb::splat(0.7), roughness: 0.3 },
                Some(Rgb::ONE),
            ),
            (sphere(-0.4), BsdfDesc::Mirror { reflectance: Rgb::splat(0.9) }, None),
            (sphere(0.4), BsdfDesc::Dielectric { ior: 1.5, exterior_ior: 1.0 }, None),
            (flat_mirror(-0.99), BsdfDesc::Mirror { reflectance: Rgb::splat(0.9) }, None),
            (flat_mirror(0.99), BsdfDesc::Mirror { reflectance: Rgb::splat(0.9) }, None),
        ],
    );
    desc.meshes.push(box_inside(DVec3::splat(-1.0), DVec3::ONE).into());
    desc
}

fn count<I: Integrator, S: Sampler>(scene: &Scene, integrator: &I, sampler: &mut S) -> (usize, u64) {
    let camera = Camera::new(scene.camera(), [64, 64], scene.centre()).unwrap();
    let mut tracer = SceneTracer::new(scene);
    let before = ALLOCATIONS.get();
    let mut sum = Rgb::ZERO;
    for pixel in 0..64 * 64 {
        for sample in 0..4 {
            sampler.start(pixel, sample);
            let [x, y] = sampler.pixel_2d();
            let ray = camera.ray((pixel % 64) as f32 + x, (pixel / 64) as f32 + y);
            sum += integrator.radiance(scene, ray, sampler, &mut tracer, &mut |_| ());
        }
    }
    assert!(sum.is_finite() && sum.min_element() > 0.0);
    (ALLOCATIONS.get() - before, tracer.rays)
}

/// Samples of a row of 64 pixels.
fn begin_row<S: Sampler>(samples: &mut [Sample<S>], camera: &Camera, row: u32) {
    for (x, sample) in (0..).zip(samples) {
        sample.sampler.start(64 * row + x, 0);
        let [dx, dy] = sample.sampler.pixel_2d();
        sample.ray = camera.ray(x as f32 + dx, row as f32 + dy);
    }
}

/// The same for rows of samples in groups, of which the first row takes the memory.
fn count_in_rows<I: Integrator, S: Sampler + Clone>(scene: &Scene, integrator: &I, sampler: &S) -> (usize, u64) {
    let camera = Camera::new(scene.camera(), [64, 64], scene.centre()).unwrap();
    let mut tracer = SceneTracer::new(scene);
    let (mut memory, mut samples) = (I::Memory::default(), vec![Sample::new(sampler.clone()); 64]);
    let (mut before, mut sum) = (0, Rgb::ZERO);
    for row in 0..64 {
        begin_row(&mut samples, &camera, row);
        integrator.radiance_of_many(scene, &mut samples, &[16, 32, 48, 64], &mut memory, &mut tracer);
        sum += samples.iter().map(|sample| sample.radiance).sum::<Rgb>();
        if row == 0 {
            before = ALLOCATIONS.get();
        }
    }
    assert!(sum.is_finite() && sum.min_element() > 0.0);
    (ALLOCATIONS.get() - before, tracer.rays)
}

#[test]
fn no_allocation_per_sample() {
    // The counter counts.
    let before = ALLOCATIONS.get();
    drop(std::hint::black_box(vec![1_u8; 100]));
    assert_eq!(ALLOCATIONS.get() - before, 1);

    let scene = Scene::build(&room(), &BuildOptions { threads: 1, ..BuildOptions::default() }).unwrap();
    let mut sobol = SobolSampler::new(1, 4);
    // What a scene gathers when it is first asked.
    count(&scene, &Path::new(None, 1), &mut sobol);
    let mut pattern = PatternSampler::new(Pattern::Jittered, 1, 4);
    for (what, (allocations, rays)) in [
        ("path", count(&scene, &Path::new(None, 2), &mut sobol)),
        ("path, jittered", count(&scene, &Path::new(Some(7), 1), &mut pattern)),
        ("path, in waves", count_in_rows(&scene, &Path::new(None, 2), &sobol)),
        ("path, in groups", count_in_rows(&scene, &PathReuse::new(&scene, Path::new(None, 2)), &sobol)),
        (
            "path, in groups, more light samples first",
            count_in_rows(&scene, &PathReuse::new(&scene, Path::new(None, 1)).with_first_shadow_rays(4), &sobol),
        ),
        ("whitted", count(&scene, &Whitted { max_depth: None, shadow_rays: 1 }, &mut sobol)),
        ("direct", count(&scene, &Direct { shadow_rays: 1 }, &mut sobol)),
    ] {
        assert!(rays > 30_000, "{what}: {rays} rays");
        assert_eq!(allocations, 0, "{what}: {allocations} allocations in {rays} rays");
    }
}
