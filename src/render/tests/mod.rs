//! Renders of what no scene description can ask for yet: glossy lobes, mixtures of lobes, transmission with a density, and
//! environments. All integrators whose row of the table allows it are compared with closed forms, or with path tracing.

mod environments;
mod lobes;
mod mattes;
mod refused;
mod reuse;
mod rooms;

use std::ops::ControlFlow;

use super::{Render, RenderSettings};
use crate::bsdf::{Bsdf, LobeMixture, Lobes};
use crate::desc::{
    BsdfDesc, CameraDesc, FilmDesc, FovAxis, IntegratorDesc, PhotonDesc, RenderDesc, SceneDesc, ShapeDesc, SurfaceLook,
};
use crate::emitter::{Emitter, EmitterSet, EnvironmentEmitter, InfiniteBall};
use crate::math::{DAffine3, DVec3};
use crate::scene::{BuildOptions, Scene};
use crate::spectrum::Rgb;

/// Lobes for short.
const DIFFUSE: Lobes = Lobes::DIFFUSE_REFLECTION;
const GLOSSY: Lobes = Lobes::GLOSSY_REFLECTION;
const MIRROR: Lobes = Lobes::SPECULAR_REFLECTION;
const THROUGH: Lobes = Lobes::DIFFUSE_TRANSMISSION;
const HAZE: Lobes = Lobes::GLOSSY_TRANSMISSION;
const HOLE: Lobes = Lobes::SPECULAR_TRANSMISSION;

/// Radiance of emitters: another one in each channel.
const RADIANCE: Rgb = Rgb::new(0.5, 1.0, 2.0);

/// A mixture of lobes of these grey weights; glossy lobes have the exponent 20.
fn mixture(weights: &[(Lobes, f32)]) -> Bsdf {
    let weights: Vec<(Lobes, Rgb)> = weights.iter().map(|&(lobe, weight)| (lobe, Rgb::splat(weight))).collect();
    Bsdf::LobeMixture(LobeMixture::new(&weights, 20.0))
}

/// A scene whose materials have any Bsdf and whose light may come from infinity.
#[derive(Default)]
struct Stage {
    desc: SceneDesc,
    bsdfs: Vec<Bsdf>,
    environment: Option<Rgb>,
}

impl Stage {
    /// A scene around which the same radiance comes from all directions.
    fn in_environment() -> Self {
        Self { environment: Some(RADIANCE), ..Self::default() }
    }

    fn material(&mut self, bsdf: Bsdf) -> usize {
        // The description has a stand-in, which `build` replaces.
        let stand_in = BsdfDesc::Lambert { albedo: Rgb::splat(0.5) };
        self.bsdfs.push(bsdf);
        self.desc.add_material(&format!("{}", self.bsdfs.len()), stand_in, None).unwrap()
    }

    fn add(&mut self, shape: (ShapeDesc, DAffine3), material: usize, emission: Option<Rgb>) {
        let look = SurfaceLook { material: Some(material), emission, ..SurfaceLook::default() };
        self.desc.add_surface(shape.0, shape.1, look).unwrap();
    }

    fn quad(&mut self, corners: [[f64; 3]; 4], material: usize, emission: Option<Rgb>) {
        self.add(ShapeDesc::quad(corners.map(DVec3::from_array)).unwrap(), material, emission);
    }

    fn sphere(&mut self, centre: [f64; 3], radius: f64, material: usize) {
        self.add(ShapeDesc::sphere(DVec3::from_array(centre), radius).unwrap(), material, None);
    }

    /// The six sides of a cube of side 2 about the origin, with their normals inwards.
    fn cube(&mut self, material: usize, emission: Option<Rgb>) {
        for axis in 0..3 {
            for side in [-1.0, 1.0] {
                let corner = |a: f64, b: f64| {
                    let mut corner = [side; 3];
                    corner[(axis + 1) % 3] = a;
                    corner[(axis + 2) % 3] = -side * b;
                    corner
                };
                self.quad(
                    [corner(-1.0, -1.0), corner(1.0, -1.0), corner(1.0, 1.0), corner(-1.0, 1.0)],
                    material,
                    emission,
                );
            }
        }
    }

    fn camera(&mut self, eye: [f64; 3], look_at: [f64; 3], fov_deg: f64) {
        let (eye, look_at) = (DVec3::from_array(eye), DVec3::from_array(look_at));
        let up = if (look_at - eye).cross(DVec3::Y).length() > 1e-3 { DVec3::Y } else { DVec3::X };
        self.desc.camera = CameraDesc::Perspective {
            eye,
            look_at,
            up,
            fov_deg,
            fov_axis: FovAxis::Horizontal,
            film: FilmDesc::default(),
        };
    }

    fn build(&self) -> Scene {
        let mut scene = Scene::build(&self.desc, &BuildOptions::default()).unwrap();
        for (material, bsdf) in self.bsdfs.iter().enumerate() {
            scene.set_bsdf(material, bsdf.clone());
        }
        if let Some(radiance) = self.environment {
            let bounds = scene.info().bounds;
            let (centre, radius) = (bounds.centre(), 0.55 * (bounds.max - bounds.min).length());
            let mut emitters = scene.emitters().emitters().to_vec();
            let environment =
                EnvironmentEmitter::new(radiance, InfiniteBall::new(scene.to_scene(centre), radius as f32));
            emitters.push(Emitter::Environment(environment));
            scene.set_emitters(EmitterSet::new(emitters));
        }
        scene
    }
}

/// The mean of an image over its pixels, by renders of several seeds, and its standard error.
#[derive(Clone, Copy, Debug)]
struct Estimate {
    mean: DVec3,
    error: DVec3,
}

impl Estimate {
    /// The mean of results that are independent of each other.
    fn of(results: impl Iterator<Item = DVec3>) -> Self {
        let (mut sum, mut squares, mut count) = (DVec3::ZERO, DVec3::ZERO, 0.0);
        for result in results {
            sum += result;
            squares += result * result;
            count += 1.0;
        }
        let mean = sum / count;
        let variance = (squares / count - mean * mean).max(DVec3::ZERO) / (count - 1.0);
        Self { mean, error: DVec3::from_array(variance.to_array().map(f64::sqrt)) }
    }
}

/// How much is rendered.
#[derive(Clone)]
struct Effort {
    seeds: u64,
    desc: RenderDesc,
}

impl Effort {
    /// So many seeds, samples per pixel and light paths of a map. Pixels share no hits.
    fn new(seeds: u64, samples: u32, photons: u32) -> Self {
        let photons = PhotonDesc { count: Some(photons), caustic_count: Some(photons), ..PhotonDesc::default() };
        let reuse = Some(false);
        Self { seeds, desc: RenderDesc { resolution: [12; 2], samples, photons, reuse, ..RenderDesc::default() } }
    }
}

fn render(scene: &Scene, integrator: IntegratorDesc, effort: &Effort) -> Estimate {
    let one = |seed: u64| {
        let desc = RenderDesc { integrator, seed: 100 + seed, ..effort.desc.clone() };
        let mut render = Render::new(scene, RenderSettings { desc, threads: 1, ..RenderSettings::default() }).unwrap();
        let summary = render.run(&mut |_| ControlFlow::Continue(())).unwrap();
        assert_eq!(summary.non_finite, 0, "{}", integrator.name());
        DVec3::from_array(render.image().mean())
    };
    Estimate::of((0..effort.seeds).map(one))
}

/// What a test found.
#[derive(Default)]
struct Findings {
    failures: Vec<String>,
}

/// The largest difference from a closed form that still counts as noise, in standard errors, and what rounding may add as a
/// share of the closed form.
const STANDARD_ERRORS: f64 = 4.0;
const ROUNDING: f64 = 1e-4;

/// The tolerance must be smaller than this share of what is expected, so that a factor that is wrong by 2 % is found.
const SHARP: f64 = 0.015;

impl Findings {
    fn check(&mut self, what: &str, found: Estimate, exact: DVec3) {
        self.compare_biased(what, found, Estimate { mean: exact, error: DVec3::ZERO }, ROUNDING);
    }

    /// `bias`: a share of what is expected that the methods' own errors may add.
    fn compare_biased(&mut self, what: &str, found: Estimate, expected: Estimate, bias: f64) {
        let both = found.error * found.error + expected.error * expected.error;
        let error = DVec3::from_array(both.to_array().map(f64::sqrt));
        let tolerance = STANDARD_ERRORS * error + bias * expected.mean;
        let line = format!("{what}: {:.5} ± {:.5}, expected {:.5}", found.mean, error, expected.mean);
        println!("{line}");
        if !((found.mean - expected.mean).abs().cmple(tolerance).all()) {
            self.failures.push(line.clone());
        }
        let is_sharp = expected.mean.max_element() == 0.0 || tolerance.cmplt(SHARP * expected.mean).all();
        if !is_sharp {
            self.failures.push(format!("{line}: shows nothing of 2 %"));
        }
    }
}

impl Drop for Findings {
    fn drop(&mut self) {
        if !std::thread::panicking() {
            assert!(self.failures.is_empty(), "\n{}", self.failures.join("\n"));
        }
    }
}
