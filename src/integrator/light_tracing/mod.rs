//! Light paths to the camera, for what lamps send by way of mirrors and glass onto surfaces that the camera sees: caustics, and the
//! light that a mirror throws on a wall.
//!
//! A path from the camera finds such light where the direction that it draws at the surface happens to lead to the lamp by way of the
//! mirror. A path from the lamp, aimed at what is perfectly specular, is connected with the camera where it arrives, and adds light to
//! the pixel that sees the place. Both are weighted by the balance heuristic (Veach 1997, Sec. 9.2), so that the sum is unbiased and
//! each counts where it finds light with less noise.
//!
//! Their densities are compared without following the chain of mirrors and glass between them: n^2 cos dA dw, the étendue, is the same
//! at both of its ends. The density of a camera path is the one by area at the place that the camera sees times that of its direction
//! there, and that of a light path the one by area on the lamp times that of its direction, each over n^2 cos. Both techniques compute
//! the weight from the same numbers, so that it is exact whatever interpolated normals and roulette do in between.
//!
//! The light paths of a sample are a picture of their own: a pure function of the sample's index, of which each pixel takes its part
//! with its own sample of this index. A film therefore knows nothing of them, and pixels stay independent of each other.
//!
//! `"integrator": { "type": "path", "lightPaths": true }`.
//!
//! Sources: Veach 1997, *Robust Monte Carlo Methods for Light Transport Simulation*, Sec. 8.2 and 10; Grittmann, Yazici, Georgiev,
//! Slusallek 2022, "Efficiency-Aware Multiple Importance Sampling for Bidirectional Rendering Algorithms" (whether to use them).

mod picture;

use std::sync::Arc;

pub use picture::LightPictures;
pub(crate) use picture::PATHS_A_BLOCK;

use super::aim::Aims;
use super::vertex::Vertex;
use crate::camera::Camera;
use crate::emitter::Emitter;
use crate::math::{Ray, Vec3};
use crate::sampling::Distribution1D;
use crate::scene::Scene;
use crate::spectrum::{LUMINANCE_WEIGHTS, Rgb, Spectrum};

/// Most parts of the perfectly specular surfaces that light paths are aimed at apart from each other.
const MOST_AIMS: usize = 3;

/// Number of pixels for each light path of a sample, where no pilot has said how many there are to be. Where they pay, twice or half as
/// many change the time to the same error by a tenth.
const PIXELS_A_PATH: u64 = 8;

/// Share of the light paths that lamps get by power alone, in case a lamp's centre sees less of the specular surfaces than the rest
/// of the lamp.
const BY_POWER: f64 = 0.1;

/// The light paths of a render: where they begin, and their weights against paths from the camera.
#[derive(Clone, Debug)]
pub struct LightPaths {
    camera: Camera,
    aims: Aims,
    /// What rays of paths from the camera are aimed at as well, where pixels share hits.
    camera_aims: Option<Aims>,
    /// The choice of an emitter.
    choice: Arc<Distribution1D>,
    /// For each emitter the probability of its choice over its area, in units of 1 / `scale2`; 0 of those from which no light paths start.
    densities: Arc<[f32]>,
    /// Square of the scene's size. Densities by area are in units of its inverse, so that none leaves single precision.
    scale2: f32,
    /// Number of light paths for each sample of all pixels.
    count: u32,
}

/// Where a light path begins.
struct Start {
    ray: Ray,
    /// Density of the start, over its cosine, times the number of light paths.
    density: f32,
    radiance: Rgb,
}

impl LightPaths {
    /// The light paths of a scene for this camera with a picture of this resolution; `None` where no surface is perfectly specular, or
    /// no lamp is one that light paths start from: triangles, spheres and disks with the same radiance everywhere.
    ///
    /// Points and parallel light are left to photon maps: no path from the camera meets them, and a picture is to show the same whether
    /// it is rendered with light paths or without.
    pub fn new(scene: &Scene, camera: &Camera, resolution: [u32; 2]) -> Option<Self> {
        let aims = Aims::of_few(scene, f32::MIN_POSITIVE, MOST_AIMS);
        if aims.is_empty() || !camera.is_pinhole() {
            return None;
        }
        let emitters = scene.emitters().emitters();
        let power =
            |emitter: &Emitter| if can_start(emitter) { emitter.power().dot(LUMINANCE_WEIGHTS.to_f64()) } else { 0.0 };
        let seen = |emitter: &Emitter| power(emitter) * f64::from(aims.weight(emitter.centre(), emitter.normal()));
        let weights: Vec<[f64; 2]> = emitters.iter().map(|emitter| [power(emitter), seen(emitter)]).collect();
        let [all, aimed] = [0, 1].map(|which| weights.iter().map(|weights| weights[which]).sum::<f64>());
        let even = BY_POWER * if aimed > 0.0 { aimed / all } else { 1.0 };
        let choice = Distribution1D::new(&weights.iter().map(|[power, seen]| seen + even * power).collect::<Vec<_>>())?;
        let bounds = scene.info().bounds;
        let size = (bounds.max - bounds.min).length();
        let density = |(index, emitter): (usize, &Emitter)| {
            let by_area = f64::from(choice.pmf(index)) * size * size / emitter.area();
            if can_start(emitter) { by_area as f32 } else { 0.0 }
        };
        let densities = emitters.iter().enumerate().map(density).collect();
        let pixels = resolution.map(u64::from).iter().product::<u64>();
        let (scale2, count) = ((size * size) as f32, (pixels / PIXELS_A_PATH).clamp(1, u64::from(u32::MAX)) as u32);
        Some(Self { camera: *camera, aims, camera_aims: None, choice: Arc::new(choice), densities, scale2, count })
    }

    /// Number of light paths for each sample of all pixels.
    pub fn count(&self) -> u32 {
        self.count
    }

    /// The same with another number of light paths for each sample of all pixels, above 0.
    #[must_use]
    pub fn with_count(self, count: u32) -> Self {
        Self { count, ..self }
    }

    /// The same beside paths from the camera of which one more ray is aimed at these surfaces from what the camera sees.
    #[must_use]
    pub(crate) fn beside_aims(self, aims: &Aims) -> Self {
        Self { camera_aims: (!aims.is_empty()).then(|| aims.clone()), ..self }
    }

    /// Density (sr^-1) with which the rays of paths from the camera that are aimed leave a place, on the side of the unit normal `n`, into
    /// the unit direction `w`.
    #[inline]
    fn aimed_pdf(&self, [p, n, w]: [Vec3; 3]) -> f32 {
        self.camera_aims.as_ref().map_or(0.0, |aims| aims.pdf(p, n, w))
    }

    /// Density with which camera rays find a place, times the square of the scene's size: pixels that a unit of its area fills.
    #[inline]
    fn seen_density(&self, p: Vec3, ng: Vec3) -> f32 {
        let to = p - self.camera.eye();
        let distance2 = to.length_squared();
        let direction = to / distance2.sqrt();
        self.camera.pixels_a_steradian(direction) * ng.dot(direction).abs() * (self.scale2 / distance2)
    }

    /// Density with which paths from the camera find a vertex that the camera sees and leave it into `wi` (scene frame), where its
    /// Bsdf and what else may choose the direction have this density (sr^-1).
    #[inline]
    pub(super) fn density<C: Spectrum>(&self, vertex: &Vertex<'_, C>, wi: Vec3, pdf: f32) -> f32 {
        let ng = vertex.surface.ng;
        self.seen_density(vertex.surface.point.p, ng) * pdf / ng.dot(wi).abs()
    }

    /// The weight of a path from the camera that has this density and that came by a perfectly specular chain to a vertex that emits.
    #[inline(never)]
    pub(super) fn weight<C: Spectrum>(&self, density: f32, scene: &Scene, vertex: &Vertex<'_, C>) -> f32 {
        let side = vertex.surface.emitter;
        let Some(emitter) =
            side.and_then(|emitter| scene.emitters().on_side(emitter, vertex.surface.ng, vertex.wo_scene()))
        else {
            return 1.0;
        };
        let (p, n, w) = (vertex.surface.point.p, vertex.facing(), vertex.wo_scene());
        let start = self.start_density(emitter, n.dot(w), || self.aims.pdf(p, n, w));
        let weight = density / (density + start);
        // Both are far beyond what has any meaning.
        if weight.is_nan() { 0.5 } else { weight }
    }

    /// Density with which light paths begin at a point of an emitter into a direction that has this cosine and this density (sr^-1), over
    /// the cosine, times the number of light paths and the square of the scene's size.
    #[inline]
    fn start_density(&self, emitter: u32, cosine: f32, pdf: impl FnOnce() -> f32) -> f32 {
        let by_area = self.densities.get(emitter as usize).copied().unwrap_or(0.0);
        if by_area == 0.0 || cosine <= 0.0 {
            return 0.0;
        }
        self.count as f32 * by_area * pdf() / cosine
    }

    /// Samples the start of a light path. `u` and `d` are uniform in [0, 1)^4. `None` for a path that carries nothing.
    #[inline]
    fn start(&self, scene: &Scene, u: [f32; 4], d: [f32; 4]) -> Option<Start> {
        let choice = f64::from(u[0]) + f64::from(d[3]) * (-24_f64).exp2();
        let (index, _, _) = self.choice.sample(choice);
        let departure = scene.emitters().emitters()[index].sample_departure([u[1], u[2]]);
        let (p, n) = (departure.point.p, departure.normal?);
        let (w, pdf) = self.aims.sample(p, n, u[3], [d[0], d[1]])?;
        let w = w.normalize();
        let emitter = index as u32;
        let density = self.start_density(emitter, n.dot(w), || pdf);
        if density <= 0.0 || !density.is_finite() {
            return None;
        }
        let radiance = scene.emitters().radiance(emitter, w, p);
        Some(Start { ray: departure.point.leave(n, w), density, radiance })
    }
}

/// Most specular surfaces between a lamp and what the camera sees, for light paths to find the light.
const MOST_SPECULAR: u32 = 32;

/// Whether light paths may be reflected or refracted perfectly at a vertex that is the specular surface with this number on their way,
/// from either end. They may not where a normal that faces away is replaced: from the other end it does not face away.
#[inline]
pub(super) fn is_of_chain<C: Spectrum>(vertex: &Vertex<'_, C>, number: u32) -> bool {
    number <= MOST_SPECULAR && vertex.has_own_normal()
}

/// Whether light paths start from an emitter: from a surface that paths from the camera meet, with the same radiance everywhere, whose
/// points are sampled uniformly by area.
fn can_start(emitter: &Emitter) -> bool {
    matches!(emitter, Emitter::Triangle(_) | Emitter::Sphere(_) | Emitter::Disk(_))
}
