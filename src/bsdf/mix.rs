//! Sums of two models, and models for the two sides of a surface.

use std::sync::Arc;

use super::dispersive::Index;
use super::lobes::{Lobes, TransportMode};
use super::microfacet::choose;
use super::model::{BsdfSample, Model, SpecularLobes};
use super::{Black, Bsdf, Parts};
use crate::math::Vec3;
use crate::spectrum::{Rgb, Spectrum};

/// A weighted sum of two models: (1 - weight) of the first and `weight` of the second.
///
/// A direction is drawn from one of the parts, in proportion to what they scatter, and has the density of both.
#[derive(Clone, Debug, PartialEq)]
pub struct Mix<C: Spectrum = Rgb> {
    parts: Arc<[Bsdf<C>; 2]>,
    weights: [f32; 2],
    /// What paths ask for at every hit.
    lobes: Lobes,
    albedo: C,
}

impl Mix {
    /// As [`Bsdf::dispersing`].
    pub(super) fn dispersing(&self, inner: Index, outer: Index) -> Self {
        Self::of_weights(self.parts.each_ref().map(|part| part.clone().dispersing(inner, outer)), self.weights)
    }
}

impl<C: Spectrum> Mix<C> {
    /// A sum. `weight`: the share of the second part, in [0, 1].
    pub fn new(parts: [Bsdf<C>; 2], weight: f32) -> Self {
        Self::of_weights(parts, [1.0 - weight, weight])
    }

    /// The two models.
    pub(super) fn models(&self) -> &[Bsdf<C>; 2] {
        &self.parts
    }

    /// The sum of two models, which scatter no more than all light together.
    pub(super) fn sum(parts: [Bsdf<C>; 2]) -> Self {
        Self::of_weights(parts, [1.0; 2])
    }

    fn of_weights(parts: [Bsdf<C>; 2], weights: [f32; 2]) -> Self {
        let lobes = |i: usize| {
            if weights[i] > 0.0 { parts[i].lit_lobes() } else { Lobes::empty() }
        };
        let lobes = lobes(0) | lobes(1);
        let albedo = parts[0].albedo() * weights[0] + parts[1].albedo() * weights[1];
        Self { parts: Arc::new(parts), weights, lobes, albedo }
    }

    /// As [`Bsdf::parts`].
    pub(super) fn parts(&self, narrow_below: f32) -> Parts {
        let of = |i: usize| if self.weights[i] > 0.0 { self.parts[i].parts(narrow_below) } else { Parts::empty() };
        of(0) | of(1)
    }

    /// As [`Bsdf::part`].
    pub(super) fn part(&self, part: Parts, narrow_below: f32) -> Option<Self> {
        let parts = one_part(&self.parts, part, narrow_below)?;
        Some(Self::of_weights(parts, self.weights))
    }

    /// As [`Bsdf::on_side`].
    pub(super) fn on_side(&self, front: bool) -> Self {
        Self::of_weights(self.parts.each_ref().map(|part| part.on_side(front)), self.weights)
    }

    /// With all facets turned.
    pub(super) fn turned(&self, turn: [f32; 2]) -> Self {
        Self { parts: Arc::new(self.parts.each_ref().map(|part| part.turned(turn))), ..self.clone() }
    }

    /// The probability of the first part.
    #[inline]
    fn first(&self, wo: Vec3) -> f32 {
        let [a, b] = self.shares(wo);
        if a + b > 0.0 { a / (a + b) } else { 0.5 }
    }

    #[inline]
    fn shares(&self, wo: Vec3) -> [f32; 2] {
        [0, 1].map(|i: usize| if self.weights[i] > 0.0 { self.weights[i] * self.parts[i].share(wo) } else { 0.0 })
    }

    fn weighted(&self, f: impl Fn(&Bsdf<C>) -> C) -> C {
        f(&self.parts[0]) * self.weights[0] + f(&self.parts[1]) * self.weights[1]
    }
}

impl Mix {
    pub(super) fn in_spectrum<C: Spectrum>(&self, wavelengths: &C::Wavelengths) -> Mix<C> {
        let parts = self.parts.each_ref().map(|part| part.in_spectrum::<C>(wavelengths));
        Mix::of_weights(parts, self.weights)
    }
}

impl<C: Spectrum> Model<C> for Mix<C> {
    fn lobes(&self) -> Lobes {
        self.lobes
    }

    fn albedo(&self) -> C {
        self.albedo
    }

    fn diffuse_albedo(&self) -> C {
        self.weighted(Model::diffuse_albedo)
    }

    fn disperses(&self) -> bool {
        self.parts.iter().any(Model::disperses)
    }

    fn is_anisotropic(&self) -> bool {
        self.parts.iter().any(Model::is_anisotropic)
    }

    fn narrowest(&self) -> f32 {
        let of =
            |i: usize| if self.weights[i] > 0.0 && !self.parts[i].is_black() { self.parts[i].narrowest() } else { 1.0 };
        of(0).min(of(1))
    }

    fn share(&self, wo: Vec3) -> f32 {
        let [a, b] = self.shares(wo);
        a + b
    }

    fn f(&self, wo: Vec3, wi: Vec3, mode: TransportMode) -> C {
        self.weighted(|part| part.f(wo, wi, mode))
    }

    fn pdf(&self, wo: Vec3, wi: Vec3) -> f32 {
        let first = self.first(wo);
        first * self.parts[0].pdf(wo, wi) + (1.0 - first) * self.parts[1].pdf(wo, wi)
    }

    fn f_pdf(&self, wo: Vec3, wi: Vec3, mode: TransportMode) -> (C, f32) {
        let first = self.first(wo);
        let [(f0, pdf0), (f1, pdf1)] = self.parts.each_ref().map(|part| part.f_pdf(wo, wi, mode));
        (f0 * self.weights[0] + f1 * self.weights[1], first * pdf0 + (1.0 - first) * pdf1)
    }

    fn sample(&self, wo: Vec3, mut u: [f32; 3], mode: TransportMode) -> Option<BsdfSample<C>> {
        let first = self.first(wo);
        let (chosen, probability) = if choose(first, &mut u[2]) { (0, first) } else { (1, 1.0 - first) };
        let sample = self.parts[chosen].sample(wo, u, mode)?;
        if sample.is_specular() {
            return Some(BsdfSample { weight: sample.weight * (self.weights[chosen] / probability), ..sample });
        }
        // The part that was not chosen could have drawn this direction too.
        let own = sample.weight * (self.weights[chosen] * sample.pdf);
        let (f, other_pdf) = self.parts[1 - chosen].f_pdf(wo, sample.wi, mode);
        let others = f * (self.weights[1 - chosen] * sample.wi.z.abs());
        let pdf = probability * sample.pdf + (1.0 - probability) * other_pdf;
        Some(BsdfSample { weight: (own + others) / pdf, pdf, ..sample })
    }

    fn mean_f(&self, wo: Vec3) -> Option<C> {
        let of = |i: usize| self.parts[i].mean_f(wo).map(|f| f * self.weights[i]);
        match (of(0), of(1)) {
            (Some(a), Some(b)) => Some(a + b),
            (one, other) => one.or(other),
        }
    }

    fn is_even(&self) -> bool {
        self.parts.iter().all(Model::is_even)
    }

    fn specular_lobes(&self, wo: Vec3, mode: TransportMode) -> SpecularLobes<C> {
        let of = |i: usize| {
            self.parts[i].specular_lobes(wo, mode).map(|lobe| {
                lobe.map(|lobe| BsdfSample { weight: lobe.weight * self.weights[i], ..lobe })
                    .filter(|lobe| lobe.weight != C::ZERO)
            })
        };
        add_lobes(of(0), of(1))
    }
}

/// One part of each of two models, black where a model has no such part; `None` where neither has.
fn one_part<C: Spectrum>(models: &[Bsdf<C>; 2], part: Parts, narrow_below: f32) -> Option<[Bsdf<C>; 2]> {
    let models = models.each_ref().map(|model| model.part(part, narrow_below));
    let is_left = models.iter().any(Option::is_some);
    is_left.then(|| models.map(|model| model.unwrap_or(Bsdf::Black(Black))))
}

/// The delta lobes of two parts of one surface. Lobes at the same place have the same direction.
pub(super) fn add_lobes<C: Spectrum>(a: SpecularLobes<C>, b: SpecularLobes<C>) -> SpecularLobes<C> {
    std::array::from_fn(|i| match (a[i], b[i]) {
        (Some(a), Some(b)) => Some(BsdfSample { weight: a.weight + b.weight, ..a }),
        (one, other) => one.or(other),
    })
}

/// One model on the outer side of a surface and another one on the inner side. Neither transmits.
#[derive(Clone, Debug, PartialEq)]
pub struct TwoSided<C: Spectrum = Rgb> {
    /// The models of the outer and of the inner side.
    faces: Arc<[Bsdf<C>; 2]>,
    lobes: Lobes,
}

impl<C: Spectrum> TwoSided<C> {
    /// A surface that has these models on its outer and on its inner side.
    pub fn new(faces: [Bsdf<C>; 2]) -> Self {
        Self { lobes: faces[0].lit_lobes() | faces[1].lit_lobes(), faces: Arc::new(faces) }
    }

    /// As [`Bsdf::parts`].
    pub(super) fn parts(&self, narrow_below: f32) -> Parts {
        self.faces[0].parts(narrow_below) | self.faces[1].parts(narrow_below)
    }

    /// As [`Bsdf::part`].
    pub(super) fn part(&self, part: Parts, narrow_below: f32) -> Option<Self> {
        one_part(&self.faces, part, narrow_below).map(Self::new)
    }

    /// With all facets turned.
    pub(super) fn turned(&self, turn: [f32; 2]) -> Self {
        Self { faces: Arc::new(self.faces.each_ref().map(|face| face.turned(turn))), ..self.clone() }
    }

    /// The model of the outer side (`front`) or of the inner one.
    pub(super) fn face(&self, front: bool) -> &Bsdf<C> {
        &self.faces[usize::from(!front)]
    }

    #[inline]
    fn seen(&self, wo: Vec3) -> &Bsdf<C> {
        &self.faces[usize::from(wo.z < 0.0)]
    }
}

impl TwoSided {
    pub(super) fn in_spectrum<C: Spectrum>(&self, wavelengths: &C::Wavelengths) -> TwoSided<C> {
        TwoSided::new(self.faces.each_ref().map(|face| face.in_spectrum::<C>(wavelengths)))
    }
}

impl<C: Spectrum> Model<C> for TwoSided<C> {
    fn lobes(&self) -> Lobes {
        self.lobes
    }

    fn albedo(&self) -> C {
        (self.faces[0].albedo() + self.faces[1].albedo()) * 0.5
    }

    fn diffuse_albedo(&self) -> C {
        (self.faces[0].diffuse_albedo() + self.faces[1].diffuse_albedo()) * 0.5
    }

    fn disperses(&self) -> bool {
        self.faces.iter().any(Model::disperses)
    }

    fn is_anisotropic(&self) -> bool {
        self.faces.iter().any(Model::is_anisotropic)
    }

    fn narrowest(&self) -> f32 {
        self.faces[0].narrowest().min(self.faces[1].narrowest())
    }

    fn share(&self, wo: Vec3) -> f32 {
        self.seen(wo).share(wo)
    }

    fn f(&self, wo: Vec3, wi: Vec3, mode: TransportMode) -> C {
        self.seen(wo).f(wo, wi, mode)
    }

    fn pdf(&self, wo: Vec3, wi: Vec3) -> f32 {
        self.seen(wo).pdf(wo, wi)
    }

    fn f_pdf(&self, wo: Vec3, wi: Vec3, mode: TransportMode) -> (C, f32) {
        self.seen(wo).f_pdf(wo, wi, mode)
    }

    fn sample(&self, wo: Vec3, u: [f32; 3], mode: TransportMode) -> Option<BsdfSample<C>> {
        self.seen(wo).sample(wo, u, mode)
    }

    fn mean_f(&self, wo: Vec3) -> Option<C> {
        self.seen(wo).mean_f(wo)
    }

    fn is_even(&self) -> bool {
        self.faces.iter().all(Model::is_even)
    }

    fn specular_lobes(&self, wo: Vec3, mode: TransportMode) -> SpecularLobes<C> {
        self.seen(wo).specular_lobes(wo, mode)
    }
}
