//! How the light of a surface is divided between maps and paths: which part of its Bsdf is gathered from maps, and which parts
//! paths follow.
//!
//! - Diffuse lobes are gathered from maps. Photons are stored for them.
//! - Glossy lobes are followed, and light samples find light for them. A photon that such a lobe scattered counts as scattered
//!   diffusely: maps of indirect light hold it.
//! - Delta lobes are followed, and light that they alone brought to a diffuse surface belongs to the caustic map. Narrow glossy
//!   lobes are treated in the same way: light samples would meet so narrow a lobe rarely and be very bright there.
//!
//! A photon, and an eye path whose diffuse part has been gathered, draws one part and then has the density of this part alone.
//! Materials are taken apart when maps are made, except those that differ from hit to hit.

use super::super::vertex::Vertex;
use crate::bsdf::{Bsdf, Model as _, Parts};
use crate::scene::{Material, Scene};
use crate::spectrum::{Rgb, Spectrum};

/// Width below which glossy lobes count as delta lobes where no map has a radius yet: such a lobe spreads the light of a point over
/// less than a thousandth of the sphere, which is this width squared. Paths find so small a light by chance too rarely.
pub const NARROW: f32 = 0.031;

/// Least and greatest width below which glossy lobes count as delta lobes.
const LEAST_WIDTH: f32 = 0.01;
const GREATEST_WIDTH: f32 = 0.25;

/// The width below which glossy lobes count as delta lobes, where estimates of indirect light have this first radius, and light
/// travels this far between surfaces.
///
/// A lobe of width alpha blurs light over alpha times the distance. A map with a wider kernel would blur the light more than the
/// lobe does, so that light belongs to the caustic map, whose kernel is narrower.
pub(super) fn narrow_below(radius: f32, distance: f32) -> f32 {
    let width = radius / distance;
    if width.is_nan() { LEAST_WIDTH } else { width.clamp(LEAST_WIDTH, GREATEST_WIDTH) }
}

/// The Bsdf of a material, taken apart.
#[derive(Clone, Debug)]
pub(super) struct Apart<C: Spectrum>([Option<Bsdf<C>>; 3]);

/// All parts.
pub(super) const PARTS: [Parts; 3] = [Parts::DIFFUSE, Parts::GLOSSY, Parts::NARROW];

impl<C: Spectrum> Apart<C> {
    fn new(bsdf: &Bsdf<C>, narrow_below: f32) -> Self {
        Self(PARTS.map(|part| bsdf.part(part, narrow_below)))
    }
}

impl Apart<Rgb> {
    fn in_spectrum<C: Spectrum>(&self, wavelengths: &C::Wavelengths) -> Apart<C> {
        Apart(self.0.each_ref().map(|part| part.as_ref().map(|bsdf| bsdf.in_spectrum::<C>(wavelengths))))
    }
}

/// How the light of a material is divided.
#[derive(Clone, Debug)]
enum Kind<C: Spectrum> {
    /// All of it belongs to one part, or there is none.
    Whole(Parts),
    Apart(Box<Apart<C>>),
    /// The Bsdf is known at hits only.
    AtHit,
}

/// How the light of each material is divided.
#[derive(Clone, Debug)]
pub(super) struct Division<C: Spectrum> {
    of_material: Vec<Kind<C>>,
    narrow_below: f32,
}

impl<C: Spectrum> Division<C> {
    /// Takes the materials of a scene apart, in the channels of paths with these wavelengths. Glossy lobes below the width
    /// `narrow_below` count as delta lobes.
    pub fn new(scene: &Scene, narrow_below: f32, wavelengths: &C::Wavelengths) -> Self {
        let kind = |(index, material): (u32, &Material)| {
            if material.is_varying() || scene.has_media() && scene.bounds_medium(index) {
                return Kind::AtHit;
            }
            let bsdf = material.mean();
            let parts = bsdf.parts(narrow_below);
            if parts.iter().count() > 1 {
                Kind::Apart(Box::new(Apart::new(bsdf, narrow_below).in_spectrum(wavelengths)))
            } else {
                Kind::Whole(parts)
            }
        };
        Self { of_material: (0..).zip(scene.materials()).map(kind).collect(), narrow_below }
    }

    /// How the light of a vertex is divided. `slot` holds the parts of a Bsdf that is known at hits only.
    #[inline]
    pub fn at<'a>(&'a self, vertex: &Vertex<'_, C>, slot: &'a mut Option<Apart<C>>) -> Divided<'a, C> {
        match &self.of_material[vertex.surface.material as usize] {
            Kind::Whole(parts) => Divided::Whole(*parts),
            Kind::Apart(parts) => Divided::Apart(parts),
            Kind::AtHit => {
                let parts = vertex.bsdf.parts(self.narrow_below);
                if parts.iter().count() > 1 {
                    Divided::Apart(slot.insert(Apart::new(vertex.bsdf, self.narrow_below)))
                } else {
                    Divided::Whole(parts)
                }
            }
        }
    }
}

/// How the light of a vertex is divided.
#[derive(Clone, Copy)]
pub(super) enum Divided<'a, C: Spectrum> {
    Whole(Parts),
    Apart(&'a Apart<C>),
}

impl<'a, C: Spectrum> Divided<'a, C> {
    /// The vertex with the lobes of each of [`PARTS`] only; `None` where there are none. `slots` hold the vertices of parts that are
    /// not all of it.
    #[inline]
    pub fn parts<'s>(
        &self,
        vertex: &'s Vertex<'a, C>,
        slots: &'s mut [Option<Vertex<'a, C>>; 3],
    ) -> [Option<&'s Vertex<'a, C>>; 3] {
        match *self {
            Self::Whole(parts) => PARTS.map(|part| parts.contains(part).then_some(vertex)),
            Self::Apart(Apart(parts)) => {
                for (slot, bsdf) in slots.iter_mut().zip(parts) {
                    *slot = bsdf.as_ref().map(|bsdf| vertex.with_bsdf(bsdf));
                }
                slots.each_ref().map(Option::as_ref)
            }
        }
    }
}

/// What each of the parts that are there scatters, as they are chosen by it.
#[inline]
pub(super) fn shares<C: Spectrum>(parts: [Option<&Vertex<'_, C>>; 3]) -> [f32; 3] {
    parts.map(|part| part.map_or(0.0, |vertex| vertex.bsdf.share(vertex.wo).max(0.0)))
}

/// Chooses one of the parts that are there, in proportion to what they scatter, by `u` in [0, 1), and returns its number and its
/// probability; `None` where nothing is scattered.
#[inline]
pub(super) fn choose_part<C: Spectrum>(parts: [Option<&Vertex<'_, C>>; 3], u: f32) -> Option<(usize, f32)> {
    let shares = shares(parts);
    let total: f32 = shares.iter().sum();
    if total.is_nan() || total <= 0.0 {
        return None;
    }
    let mut left = u * total;
    let mut chosen = None;
    for (index, share) in shares.into_iter().enumerate().filter(|(_, share)| *share > 0.0) {
        chosen = Some((index, share / total));
        if left < share {
            break;
        }
        left -= share;
    }
    chosen
}
