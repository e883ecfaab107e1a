//! Path tracing in which neighbouring pixels share the second hits of their paths.
//!
//! Pixels are taken in groups. The first surface of each path that is not perfectly specular, and the surface that the path meets
//! next, are its first and its second vertex. Each first vertex of a group is connected with the second vertices of all paths of
//! the group that it sees, and gathers what these reflect. A sample of a pixel then contains as many paths as the group has, for the
//! price of one path and some shadow rays.
//!
//! The estimate is unbiased. The second vertices of a group are samples of several techniques, one for each first vertex, and are
//! weighted by the balance heuristic over all first vertices that see them. A first vertex that does not see a second vertex could not
//! have sampled it, so that visibility belongs to the density. The light that a second vertex itself emits, and what it reflects
//! perfectly, are its own path's alone.
//!
//! Where the second vertex scatters by direction, its light is kept apart by the direction that it comes from and scattered anew
//! towards each first vertex: light samples, the emission at the next hit, and what that hit reflects. The last of these is weighted
//! by the densities of both directions together, so that no sample is scattered with more than its Bsdf's greatest weight.
//!
//! What first vertices see in perfectly specular surfaces cannot be shared. One more ray of each path is aimed at these surfaces by their
//! solid angle, and weighted against the path's own bounce.
//!
//! `"integrator": { "type": "path", "reuse": true }`.
//!
//! Source: Bekaert, Sbert, Halton 2002, "Accelerating Path Tracing by Re-Using Paths".

mod connect;
mod groups;
mod kept;
mod paths;

pub use groups::Groups;

use super::aim::Aims;
use super::light_tracing::LightPaths;
use super::walk::Limits;
use super::wave::Sample;
use super::{Context, FirstHit, Path, Tracer, Transport};
use crate::math::Ray;
use crate::sampling::Sampler;
use crate::scene::Scene;
use crate::spectrum::Spectrum;

/// Greatest number of pixels in a group.
pub const GROUP: usize = 16;

/// Most parts of the perfectly specular surfaces that rays are aimed at apart from each other. With more, rays find lamps in them more
/// often, but choosing a part takes as long as tracing the rays.
const MOST_AIMS: usize = 3;

/// Fraction of its throughput after the first hit with which a path survives for certain, in scenes with something to aim at. What a first
/// hit sees in perfectly specular surfaces is most of the noise there, and no other pixel's.
const CERTAIN_FRACTION: f32 = 0.25;

/// The same after a second hit that is shared, whose noise is a sixteenth of each pixel's.
const CERTAIN_FRACTION_SHARED: f32 = 1.0;

/// Path tracing with shared second hits.
#[derive(Clone, Debug)]
pub struct PathReuse {
    path: Path,
    aims: Aims,
    light_paths: Option<Box<LightPaths>>,
}

impl PathReuse {
    /// Path tracing of a scene with the settings of `path`.
    pub fn new(scene: &Scene, path: Path) -> Self {
        Self { path, aims: Aims::of_few(scene, f32::MIN_POSITIVE, MOST_AIMS), light_paths: None }
    }

    /// What rays from first vertices are aimed at.
    pub(crate) fn aims(&self) -> &Aims {
        &self.aims
    }

    /// Where paths in a scene end.
    fn limits<'l>(&'l self, scene: &'l Scene) -> Limits<'l> {
        let limits = Limits { light_paths: self.light_paths.as_deref(), ..self.path.limits_in(scene) };
        if self.aims.is_empty() {
            return limits;
        }
        Limits { certain_fraction: CERTAIN_FRACTION, certain_fraction_shared: CERTAIN_FRACTION_SHARED, ..limits }
    }

    /// The same with so many light samples at the hits that the camera sees.
    #[must_use]
    pub fn with_first_shadow_rays(self, first_shadow_rays: u32) -> Self {
        Self { path: Path { first_shadow_rays, ..self.path }, ..self }
    }

    /// The same beside light paths, if there are any.
    #[must_use]
    pub fn beside(self, light_paths: Option<LightPaths>) -> Self {
        Self { light_paths: light_paths.map(Box::new), ..self }
    }
}

impl<C: Spectrum> Transport<C> for PathReuse {
    type Memory = Groups<C>;

    /// A path by itself.
    #[inline]
    fn li<S: Sampler, T: Tracer>(
        &self,
        ray: Ray,
        context: &mut Context<'_, S, T, C>,
        first: &mut impl FnMut(FirstHit),
    ) -> C {
        self.path.li(ray, context, first)
    }

    const IN_WAVES: bool = true;
    const IN_GROUPS: bool = true;

    #[inline(always)]
    fn li_of_many<S: Sampler, T: Tracer>(
        &self,
        scene: &Scene,
        samples: &mut [Sample<S, C>],
        ends: &[usize],
        groups: &mut Groups<C>,
        tracer: &mut T,
    ) {
        groups.trace(scene, samples, ends, tracer, (&self.limits(scene), &self.aims));
    }
}
