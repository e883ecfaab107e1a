//! Small scenes built in code, and renders of them.

use std::ops::ControlFlow;

use etendue::desc::{
    BsdfDesc, CameraDesc, FilmDesc, FilterDesc, FovAxis, IntegratorDesc, MaterialDesc, MeshDesc, PhotonDesc,
    PointLightDesc, RenderDesc, SceneDesc, ShapeDesc, SurfaceDesc,
};
use etendue::film::Image;
use etendue::math::{DAffine3, DVec3};
use etendue::render::{Render, RenderSettings, Summary};
use etendue::scene::{BuildOptions, Scene};
use etendue::spectrum::Rgb;

/// A short render by any method: a filter whose weights are summed, and few photons.
pub fn brief(integrator: IntegratorDesc) -> RenderDesc {
    let photons = PhotonDesc { count: Some(2000), caustic_count: Some(2000), ..PhotonDesc::default() };
    let filter = FilterDesc::Mitchell { b: 1.0 / 3.0, c: 1.0 / 3.0 };
    RenderDesc { samples: 16, integrator, photons, filter, ..RenderDesc::default() }
}

/// A scene of surfaces, each with its material.
pub fn scene(camera: CameraDesc, surfaces: Vec<(ShapeDesc, BsdfDesc, Option<Rgb>)>) -> SceneDesc {
    let mut desc = SceneDesc { camera, ..SceneDesc::default() };
    for (number, (shape, bsdf, emission)) in surfaces.into_iter().enumerate() {
        add(&mut desc, number, shape, bsdf, emission);
    }
    desc
}

/// Adds a surface with a material of its own.
pub fn add(desc: &mut SceneDesc, number: usize, shape: ShapeDesc, bsdf: BsdfDesc, emission: Option<Rgb>) {
    desc.materials.push(MaterialDesc {
        name: format!("material {number}"),
        path: format!("materials[{number}]"),
        bsdf,
        ..MaterialDesc::default()
    });
    desc.surfaces.push(SurfaceDesc {
        path: format!("surfaces[{number}]"),
        name: String::new(),
        shape,
        local: DAffine3::IDENTITY,
        transform: DAffine3::IDENTITY,
        material: Some(desc.materials.len() - 1),
        emission,
        emits_both: false,
        web: None,
        spectrum: None,
        hidden: false,
    });
}

/// The inside of an axis-aligned box as one mesh, normals inwards.
pub fn box_inside(min: DVec3, max: DVec3) -> MeshDesc {
    let corner = |i: usize| {
        let pick = |bit: usize, axis: usize| if i >> bit & 1 == 0 { min[axis] } else { max[axis] };
        DVec3::new(pick(0, 0), pick(1, 1), pick(2, 2))
    };
    let faces: [[u32; 4]; 6] = [[0, 4, 6, 2], [1, 3, 7, 5], [0, 1, 5, 4], [2, 6, 7, 3], [0, 2, 3, 1], [4, 5, 7, 6]];
    let mut triangles = Vec::new();
    let middle = 0.5 * (min + max);
    let positions: Vec<DVec3> = (0..8).map(corner).collect();
    for [a, b, c, d] in faces {
        for [a, b, c] in [[a, b, c], [a, c, d]] {
            let [p, q, r] = [a, b, c].map(|i| positions[i as usize]);
            let inwards = (q - p).cross(r - p).dot(middle - p) > 0.0;
            triangles.push(if inwards { [a, b, c] } else { [a, c, b] });
        }
    }
    MeshDesc { name: "box".into(), path: "meshes[0]".into(), positions, triangles, ..MeshDesc::default() }
}

/// A camera at `eye` that looks at `look_at`, with the field of view `fov_deg` in degrees.
pub fn camera(eye: DVec3, look_at: DVec3, fov_deg: f64) -> CameraDesc {
    let up = if (look_at - eye).normalize().y.abs() < 0.9 { DVec3::Y } else { DVec3::X };
    CameraDesc::Perspective { eye, look_at, up, fov_deg, fov_axis: FovAxis::Horizontal, film: FilmDesc::default() }
}

/// A point light.
pub fn point_light(position: DVec3, intensity: f32) -> PointLightDesc {
    PointLightDesc { path: "lights[0]".into(), ..PointLightDesc::even(position, Rgb::splat(intensity)) }
}

/// Render settings of a test.
#[derive(Clone, Debug)]
pub struct Job {
    pub resolution: [u32; 2],
    pub samples: u32,
    pub integrator: IntegratorDesc,
    pub max_depth: Option<u32>,
    pub seed: u64,
}

impl Default for Job {
    fn default() -> Self {
        Self { resolution: [32, 32], samples: 64, integrator: IntegratorDesc::Path, max_depth: None, seed: 1 }
    }
}

impl Job {
    pub fn desc(&self) -> RenderDesc {
        RenderDesc {
            resolution: self.resolution,
            samples: self.samples,
            integrator: self.integrator,
            max_depth: self.max_depth,
            seed: self.seed,
            ..RenderDesc::default()
        }
    }
}

/// Builds and renders.
pub fn render(desc: &SceneDesc, job: &Job) -> (Image, Summary) {
    let scene = Scene::build(desc, &BuildOptions::default()).expect("a scene of the test");
    render_scene(&scene, job.desc())
}

/// Renders a built scene with two threads. Pixels share hits and light paths only where the settings say so, since [`mean_and_error`] needs pixels
/// that are independent.
pub fn render_scene(scene: &Scene, desc: RenderDesc) -> (Image, Summary) {
    let (reuse, light_paths) = (desc.reuse.or(Some(false)), desc.light_paths.or(Some(false)));
    let desc = RenderDesc { reuse, light_paths, ..desc };
    let settings = RenderSettings { desc, threads: 2, ..RenderSettings::default() };
    let mut render = Render::new(scene, settings).expect("settings of the test");
    let summary = render.run(&mut |_| ControlFlow::Continue(())).expect("no worker panics");
    assert_eq!(summary.non_finite, 0, "NaN or infinite samples");
    (render.image(), summary)
}

/// Mean over all pixels and channels, and its standard error by the variance layer (pixels are independent).
pub fn mean_and_error(image: &Image) -> (f64, f64) {
    let mean = image.mean().iter().sum::<f64>() / 3.0;
    let variance = image.layer("variance").expect("always there");
    // Channels of a pixel are fully correlated in grey scenes: add up standard errors, not variances, over them.
    let sum: f64 =
        variance.data.chunks_exact(3).map(|v| v.iter().map(|&v| f64::from(v).sqrt()).sum::<f64>().powi(2)).sum();
    (mean, sum.sqrt() / image.rgb.len() as f64)
}
