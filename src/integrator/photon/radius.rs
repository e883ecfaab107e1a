//! Radii of density estimates: their first values, and how they shrink.

use super::super::media::arrive;
use super::super::vertex::Vertex;
use super::super::{SceneTracer, Tracer as _};
use super::{Nearest, PhotonMap};
use crate::camera::Camera;
use crate::scene::Scene;
use crate::spectrum::{Rgb, Spectrum};

/// Number of photons that the median first radius of a map of indirect light holds, where no radius is given.
const INDIRECT_PHOTONS: usize = 150;

/// Number of photons at which the radius is measured.
const MEASURED: usize = 257;

/// Factor by which a radius has shrunk after `passes` passes: the square root of the product of (i + alpha) / (i + 1).
///
/// Source: Knaus and Zwicker 2011, "Progressive Photon Mapping: A Probabilistic Approach", Eq. 18 to 20.
pub fn shrunk(passes: u32, alpha: f64) -> f32 {
    // For many passes the product falls as n^(alpha - 1).
    let few = passes.min(4096);
    let product: f64 = (1..=few).map(|i| (f64::from(i) + alpha) / (f64::from(i) + 1.0)).product();
    let (n, m) = (f64::from(passes) + 1.0, f64::from(few) + 1.0);
    let rest = if passes > few { (n / m).powf(alpha - 1.0) } else { 1.0 };
    (product * rest).sqrt() as f32
}

/// The median of the radii that hold [`INDIRECT_PHOTONS`] around photons of a map; `otherwise` where the map has too few
/// photons.
pub(super) fn middle_radius<C: Spectrum>(map: &PhotonMap<C>, otherwise: f32) -> f32 {
    let mut nearest = Nearest::default();
    let stride = map.len().div_ceil(MEASURED).max(1);
    let mut radii = Vec::new();
    for photon in map.photons().iter().step_by(stride) {
        map.nearest(photon.position(), INDIRECT_PHOTONS, f32::INFINITY, &mut nearest);
        match nearest.found() {
            [.., (distance2, _)] if nearest.found().len() == INDIRECT_PHOTONS && *distance2 > 0.0 => {
                radii.push(distance2.sqrt());
            }
            _ => {}
        }
    }
    if radii.is_empty() {
        return otherwise;
    }
    let middle = radii.len() / 2;
    *radii.select_nth_unstable_by(middle, f32::total_cmp).1
}

/// Number of rows and of columns of the grid of pixels whose size is measured.
const LOOKS: u32 = 32;

/// Greatest number of successive mirrors and glass surfaces through which a pixel is followed.
const MOST_SPECULAR: u32 = 16;

/// Lengths by which radii are chosen.
#[derive(Clone, Copy, Debug)]
pub(super) struct Lengths {
    /// The median size of a pixel on the diffuse surfaces that are seen: distance times the angle of a pixel. Where no diffuse
    /// surface is seen, a thousandth of the scene's extent.
    pub pixel: f32,
    /// The median distance from these surfaces to the next ones, in random directions. Where there is none, the scene's extent.
    pub distance: f32,
}

/// Measures a scene as a camera sees it.
pub(super) fn measure(scene: &Scene, camera: &Camera, resolution: [u32; 2]) -> Lengths {
    let [width, height] = resolution.map(|n| n as f32);
    let mut tracer = SceneTracer::new(scene);
    let (mut sizes, mut distances) = (Vec::new(), Vec::new());
    for i in 0..LOOKS * LOOKS {
        let at = |k: u32, size: f32| (k as f32 + 0.5) / LOOKS as f32 * size;
        let (x, y) = (at(i % LOOKS, width), at(i / LOOKS, height));
        let pixel = camera.pixel_width(x, y);
        let mut ray = camera.ray(x, y);
        let mut way = 0.0;
        let mut media = scene.media_at(&ray);
        for _ in 0..MOST_SPECULAR {
            let Some(hit) = arrive(scene, &mut tracer, &ray, &mut media) else { break };
            way += hit.t;
            let mut slot = None;
            let vertex = Vertex::<Rgb>::new(scene, &ray, &hit, (), media, &mut slot);
            let lobes = vertex.lobes;
            if lobes.have_diffuse() || !lobes.have_specular() {
                if lobes.have_diffuse() {
                    sizes.push(pixel.at(way));
                    let u =
                        [i, i.wrapping_mul(0x9e37_79b9)].map(|i| (i.reverse_bits() >> 8) as f32 * 2.0_f32.powi(-24));
                    if let Some(bounce) = vertex.sample_bounce([u[0], u[1], 0.5, 0.0])
                        && let Some(next) = tracer.intersect(&bounce.ray)
                    {
                        distances.push(next.t);
                    }
                }
                break;
            }
            // The path passes through glass.
            let Some(bounce) = vertex.sample_bounce([0.5, 0.5, 0.999, 0.0]) else { break };
            ray = bounce.ray;
            media = vertex.media_beyond(scene, &ray);
        }
    }
    let bounds = &scene.info().bounds;
    let extent = if bounds.is_empty() { 1.0 } else { (bounds.max - bounds.min).length() };
    let median = |mut lengths: Vec<f32>, otherwise: f64| match lengths.len() / 2 {
        0 if lengths.is_empty() => otherwise as f32,
        middle => *lengths.select_nth_unstable_by(middle, f32::total_cmp).1,
    };
    Lengths { pixel: median(sizes, 1e-3 * extent), distance: median(distances, extent) }
}
