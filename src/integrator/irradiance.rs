//! Irradiance of small parts of surfaces, such as the texels of a light map or the surroundings of a vertex.
//!
//! The irradiance [W m^-2] of a surface does not depend on how the surface itself scatters. A sample is pi times the
//! radiance that a white Lambert surface at the same place would send along its normal. This radiance is estimated as in
//! [`Path`]: by light samples and a cosine-distributed path, combined by multiple importance sampling. The estimate is
//! unbiased for every scene.
//!
//! The cosine is measured from the shading normal, as in images, and light does not pass through the face. A Lambert surface
//! of albedo a therefore sends albedo / pi times the irradiance that is estimated here.

use std::f32::consts::PI;
use std::sync::Arc;

use super::vertex::Vertex;
use super::walk::scattered_light;
use super::{Context, Path, Tracer};
use crate::bsdf::{Bsdf, Lambert};
use crate::sampling::Sampler;
use crate::scene::{Facet, Scene};
use crate::spectrum::Rgb;

/// A triangle inside a facet: the part of the facet that belongs to a site.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Piece {
    /// The facet's index.
    pub facet: u32,
    /// Its corners, each as the weights of the facet's second and third corner.
    pub corners: [[f32; 2]; 3],
    /// Cumulative share of the site's area, up to and including this piece; 1 for the last piece.
    pub until: f32,
}

impl Piece {
    /// A point of the piece as weights of the facet's second and third corner, uniform by area for `u` uniform in [0, 1)^2.
    #[inline]
    pub fn point(&self, u: [f32; 2]) -> [f32; 2] {
        let root = u[0].sqrt();
        let weights = [1.0 - root, root * (1.0 - u[1]), root * u[1]];
        let [a, b, c] = self.corners;
        let mix = |i: usize| weights[0] * a[i] + weights[1] * b[i] + weights[2] * c[i];
        let [b1, b2] = [mix(0).max(0.0), mix(1).max(0.0)];
        // The point must stay in the facet in spite of rounding.
        let sum = b1 + b2;
        if sum > 1.0 { [b1 / sum, b2 / sum] } else { [b1, b2] }
    }
}

/// Parts of surfaces, each of one or more pieces.
#[derive(Clone, Debug, Default)]
pub struct Sites {
    facets: Vec<Facet>,
    pieces: Vec<Piece>,
    /// Index of the first piece of each site, and at the end the number of pieces.
    starts: Vec<u32>,
}

impl Sites {
    /// Creates sites of these pieces. `starts` holds the index of the first piece of each site, and at the end the number of
    /// pieces; each site has at least one piece.
    pub fn new(facets: Vec<Facet>, pieces: Vec<Piece>, starts: Vec<u32>) -> Self {
        debug_assert!(starts.last().is_some_and(|&end| end as usize == pieces.len()));
        debug_assert!(starts.is_sorted_by(|a, b| a < b));
        Self { facets, pieces, starts }
    }

    /// Number of sites.
    pub fn len(&self) -> usize {
        self.starts.len().saturating_sub(1)
    }

    /// Whether there are no sites.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// The pieces of a site.
    pub fn pieces(&self, site: usize) -> &[Piece] {
        &self.pieces[self.starts[site] as usize..self.starts[site + 1] as usize]
    }

    /// The facets that the pieces belong to.
    pub fn facets(&self) -> &[Facet] {
        &self.facets
    }

    /// A point of a site, uniform by area for `u` uniform in [0, 1)^2, as a facet and the weights of the facet's second and
    /// third corner.
    #[inline]
    pub fn point(&self, site: usize, u: [f32; 2]) -> (&Facet, [f32; 2]) {
        let pieces = self.pieces(site);
        let mut number = 0;
        while number + 1 < pieces.len() && u[0] >= pieces[number].until {
            number += 1;
        }
        let piece = &pieces[number];
        let begin = if number == 0 { 0.0 } else { pieces[number - 1].until };
        let within = ((u[0] - begin) / (piece.until - begin)).clamp(0.0, 1.0);
        (&self.facets[piece.facet as usize], piece.point([within, u[1]]))
    }
}

/// Estimates the irradiance of sites.
#[derive(Clone, Debug)]
pub struct Irradiance {
    sites: Arc<Sites>,
    path: Path,
    front: bool,
}

impl Irradiance {
    /// Creates an estimator for these sites (at least one), on the outer side (`front`) or on the inner side.
    ///
    /// `path.max_depth` counts the site itself as the first hit, so 1 gives direct light alone.
    pub fn new(sites: Arc<Sites>, path: Path, front: bool) -> Self {
        Self { sites, path, front }
    }

    /// One sample of a site's irradiance [W m^-2]. `place` chooses the point in the site, uniform in [0, 1)^2. Site numbers
    /// past the last site wrap around to the first.
    #[inline]
    pub fn estimate<S: Sampler, T: Tracer>(
        &self,
        scene: &Scene,
        site: usize,
        place: [f32; 2],
        sampler: &mut S,
        tracer: &mut T,
    ) -> Rgb {
        let (facet, [b1, b2]) = self.sites.point(site % self.sites.len(), place);
        let mut surface = scene.facet_point(facet, b1, b2);
        if scene.uses_time() {
            [surface.point.time, _] = sampler.next_2d();
        }
        let white = Bsdf::Lambert(Lambert::new(Rgb::ONE));
        let vertex = Vertex::seen_along_normal(scene, surface, &white, self.front);
        let Path { max_depth, shadow_rays, .. } = self.path;
        let mut context = Context { scene, sampler, tracer, wavelengths: () };
        let max_depth = max_depth.map_or(u32::MAX, |depth| depth.saturating_sub(1));
        PI * scattered_light(&vertex, &mut context, max_depth, shadow_rays, ())
    }
}
