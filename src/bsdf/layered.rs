//! A surface under a coat or under fibres.

use std::sync::Arc;

use super::coat::Coat;
use super::lobes::{Lobes, TransportMode};
use super::memo::memo;
use super::microfacet::choose;
use super::mix::{Mix, add_lobes};
use super::model::{BsdfSample, Model, SpecularLobes};
use super::sheen::Sheen;
use super::{Black, Bsdf, Lambert, Parts};
use crate::math::Vec3;
use crate::spectrum::{Rgb, Spectrum};

/// What lies on top of a surface.
#[derive(Clone, Debug, PartialEq)]
pub enum Layer<C: Spectrum = Rgb> {
    /// A clear or tinted coat.
    Coat(Coat),
    /// Fibres.
    Sheen(Sheen<C>),
}

/// A surface of which a share is covered by a layer.
///
/// The layer lets the share T(w) = 1 - E(w) pass, where E is its albedo, and sends some of what the base reflects back to it. With
/// this, f = f_layer + g(wo, wi) f_base where g is symmetric, so that the sum is reciprocal:
///
/// - over a diffuse base, g = T(wo) T(wi) / T_mean (1 - r) / (1 - rho r), where rho is the albedo of the base and r the share of
///   diffuse light inside that the layer reflects back: all bounces, and exact for a Lambertian base;
/// - over any other base, g = T(wo) T(wi) / (1 - rho (1 - max(T(wo), T(wi)))): all bounces where light leaves the base as it came,
///   and never more light than arrives.
///
/// Source: the closed form of the diffuse base is that of Wolff 1994, "Diffuse-Reflectance Model for Smooth Dielectric
/// Surfaces", with r from the symmetry of refraction, 1 - r = T_mean / eta^2 (Egan and Hilgeman 1973).
#[derive(Clone, Debug, PartialEq)]
pub struct Layered<C: Spectrum = Rgb> {
    layer: Arc<Layer<C>>,
    base: Arc<Bsdf<C>>,
    /// Share of the surface that the layer covers.
    coverage: f32,
    coupling: Coupling<C>,
    /// What is left of white light that passes the layer once along the normal.
    tint: Option<Rgb>,
    wavelengths: C::Wavelengths,
    /// Whether the layer lies on the inner side of the surface too.
    on_both_sides: bool,
    /// Whether the light that the layer itself scatters counts: not so in a part of the surface to which the layer does not belong.
    keeps_layer: bool,
    /// Mean of T over directions, weighed by the cosine.
    mean_passage: f32,
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Coupling<C> {
    /// The constant factor of g.
    Diffuse(C),
    /// rho of g.
    Other(C),
}

/// A layer and the surface under it.
#[derive(Clone, Debug)]
pub struct LayeredParts {
    /// What lies on top.
    pub layer: Layer,
    /// What lies under it.
    pub base: Bsdf,
    /// Share of the surface that is covered, in [0, 1].
    pub coverage: f32,
    /// What is left of white light that passes the layer once along the normal, in [0, 1].
    pub tint: Rgb,
    /// How much of the light that bounces inside is lost as it really is, in [0, 1]: 1 for a real layer, 0 for one that
    /// does not darken its base.
    pub darkening: f32,
    /// Whether the base is one of many of the same shape, of which textures vary the colours.
    pub varies: bool,
    /// Whether the base is a thin sheet, with a layer on either side. A base that does not transmit is always covered on both
    /// sides.
    pub is_thin: bool,
}

impl Layered {
    /// A covered surface, as one model or as a sum of two.
    ///
    /// Where the base has diffuse and other lobes, g is not the same for all of them: the sum has one model for the diffuse ones under
    /// the layer, and one for all others under a layer that only lets light pass.
    pub fn cover(parts: LayeredParts) -> Bsdf {
        /// Any width will do: all lobes that are not diffuse go together.
        const NARROW_BELOW: f32 = 1.0;
        let LayeredParts { base, coverage, .. } = &parts;
        let diffuse = base.part(Parts::DIFFUSE, NARROW_BELOW);
        let others = base.part(Parts::GLOSSY | Parts::NARROW, NARROW_BELOW);
        match (diffuse, others) {
            (Some(diffuse), Some(others)) if *coverage > 0.0 => {
                let of = |base: Bsdf, keeps_layer: bool| {
                    let layer = parts.layer.clone();
                    let whole = &parts.base;
                    Bsdf::Layered(Self { keeps_layer, ..Self::new(LayeredParts { layer, base, ..parts }, whole) })
                };
                Bsdf::Mix(Mix::sum([of(diffuse, true), of(others, false)]))
            }
            _ => {
                let whole = parts.base.clone();
                Bsdf::Layered(Self::new(parts, &whole))
            }
        }
    }

    /// A covered surface whose base is the `whole` one, or a part of it.
    fn new(parts: LayeredParts, whole: &Bsdf) -> Self {
        let LayeredParts { layer, base, coverage, tint, darkening, varies, is_thin } = parts;
        let lobes = base.lobes();
        let mean_passage = 1.0 - layer.mean_albedo();
        let is_diffuse = !lobes.is_empty() && Lobes::DIFFUSE_REFLECTION.contains(lobes);
        let albedo = whole.albedo() * darkening + Rgb::splat(1.0 - darkening);
        let coupling = if is_diffuse {
            // 1 - r, which is too near to 0 for high indices to be told from a rounded r.
            let leaves = match &layer {
                Layer::Coat(coat) => (f64::from(mean_passage) / (coat.eta() * coat.eta())).min(1.0),
                // Between fibres and the base nothing bounces: there is no interface.
                Layer::Sheen(_) => 1.0,
            };
            let greatest =
                if varies { greatest_passage_of_shape(&layer, &base) } else { greatest_passage(&layer, &base) };
            let most = f64::from(greatest.max(mean_passage).max(1e-6));
            let factor = |rho: f32| {
                let rho = f64::from(rho);
                if leaves > 0.0 { (leaves / ((1.0 - rho + rho * leaves) * most)) as f32 } else { 0.0 }
            };
            Coupling::Diffuse(Rgb::from_array(albedo.to_array().map(factor)))
        } else {
            Coupling::Other(albedo)
        };
        let tint = (tint != Rgb::ONE).then_some(tint);
        let on_both_sides = is_thin || !whole.lobes().intersects(Lobes::TRANSMISSION);
        Self {
            layer: Arc::new(layer),
            base: Arc::new(base),
            coverage,
            coupling,
            tint,
            wavelengths: (),
            on_both_sides,
            keeps_layer: true,
            mean_passage,
        }
    }

    pub(super) fn in_spectrum<C: Spectrum>(&self, wavelengths: &C::Wavelengths) -> Layered<C> {
        // A factor may exceed 1, so it is converted as a colour times its largest channel.
        let factor = |factor: Rgb| {
            let most = factor.max_element().max(f32::MIN_POSITIVE);
            C::from_reflectance(factor / most, wavelengths) * most
        };
        Layered {
            layer: Arc::new(match &*self.layer {
                Layer::Coat(coat) => Layer::Coat(coat.clone()),
                Layer::Sheen(sheen) => Layer::Sheen(sheen.in_spectrum::<C>(wavelengths)),
            }),
            base: Arc::new(self.base.in_spectrum::<C>(wavelengths)),
            coverage: self.coverage,
            coupling: match self.coupling {
                Coupling::Diffuse(it) => Coupling::Diffuse(factor(it)),
                Coupling::Other(it) => Coupling::Other(factor(it)),
            },
            tint: self.tint,
            wavelengths: *wavelengths,
            on_both_sides: self.on_both_sides,
            keeps_layer: self.keeps_layer,
            mean_passage: self.mean_passage,
        }
    }
}

/// The greatest share of the light that a diffuse base sends up, from any direction, that passes the layer. It is the mean share
/// for a Lambertian base. A rough one sends more light back to where it came from, where the layer lets more pass than elsewhere.
fn greatest_passage(layer: &Layer, base: &Bsdf) -> f32 {
    if base.constant_f().is_some() {
        return 0.0;
    }
    /// Views, and the angles to the normal and azimuths of the directions that are summed up for each.
    const VIEWS: usize = 16;
    const ANGLES: usize = 64;
    const AZIMUTHS: usize = 12;
    let at = |mu: f32, phi: f32| {
        let sin = (1.0 - mu * mu).sqrt();
        Vec3::new(sin * phi.cos(), sin * phi.sin(), mu)
    };
    let share = |i: usize, n: usize| (i as f32 + 0.5) / n as f32;
    let passage = |wo: Vec3| {
        let (mut sent, mut passed) = (0.0, 0.0);
        for (i, j) in (0..ANGLES).flat_map(|i| (0..AZIMUTHS).map(move |j| (i, j))) {
            let wi = at(share(i, ANGLES).sqrt(), std::f32::consts::PI * share(j, AZIMUTHS));
            let f = base.f(wo, wi, TransportMode::Radiance).max_element();
            sent += f;
            passed += f * (1.0 - layer.directional_albedo(wi));
        }
        passed / sent.max(f32::MIN_POSITIVE)
    };
    (0..VIEWS).map(|i| passage(at(share(i, VIEWS), 0.0))).fold(0.0, f32::max)
}

memo!(
    /// See [`greatest_passage_of_shape`].
    PASSAGES: Vec<u64> => f32, 4096
);

/// At least the [`greatest_passage`] of all bases of this shape, whatever their colours: these mix what the base scatters once and what
/// it scatters more often, and the greatest share of the mixture is none greater than that of either.
fn greatest_passage_of_shape(layer: &Layer, base: &Bsdf) -> f32 {
    if base.constant_f().is_some() {
        return 0.0;
    }
    let mut key = Vec::new();
    layer.put_shape(&mut key);
    if !put_shape(base, &mut key) {
        return greatest_passage(layer, base);
    }
    PASSAGES.get(&key, || uncoloured(base).iter().map(|base| greatest_passage(layer, base)).fold(0.0, f32::max))
}

/// Appends the parameters of a diffuse model but its colours; `false` where it is of another kind.
fn put_shape(base: &Bsdf, key: &mut Vec<u64>) -> bool {
    let put = |key: &mut Vec<u64>, kind: u64, [a, b]: [f32; 2]| {
        key.extend([kind, u64::from(a.to_bits()) << 32 | u64::from(b.to_bits())]);
        true
    };
    match base {
        Bsdf::Black(_) => put(key, 9, [0.0; 2]),
        Bsdf::Lambert(_) => put(key, 10, [0.0; 2]),
        Bsdf::OrenNayar(it) => put(key, 11, it.shape()),
        Bsdf::OrenNayarQualitative(it) => put(key, 12, it.shape()),
        Bsdf::Eon(it) => put(key, 13, it.shape()),
        Bsdf::Layered(it) => {
            if it.keeps_layer && matches!(*it.layer, Layer::Sheen(_)) {
                return false;
            }
            let [r, g, b] = darkened(it.tint).to_array();
            put(key, 14, [r, g]);
            put(key, u64::from(it.on_both_sides), [b, 0.0]);
            it.layer.put_shape(key);
            put_shape(&it.base, key)
        }
        // The greatest share of a sum is none greater than that of either part, whatever their weights.
        Bsdf::Mix(it) => {
            put(key, 15, [0.0; 2]);
            it.models().iter().all(|part| put_shape(part, key))
        }
        _ => false,
    }
}

/// The tint of a layer in few steps, so that there are few shapes. A darker one lets more of the light pass along the normal, where
/// most passes the layer above.
fn darkened(tint: Option<Rgb>) -> Rgb {
    const STEPS: f32 = 16.0;
    Rgb::from_array(tint.unwrap_or(Rgb::ONE).to_array().map(|t| (t * STEPS).floor().max(1.0) / STEPS))
}

/// The white model that scatters once and the one that scatters more often, where they are not the same.
fn uncoloured(base: &Bsdf) -> Vec<Bsdf> {
    match base {
        Bsdf::OrenNayar(it) => vec![Bsdf::OrenNayar(it.white())],
        Bsdf::OrenNayarQualitative(it) => vec![Bsdf::OrenNayarQualitative(it.white())],
        Bsdf::Eon(it) => vec![Bsdf::OrenNayar(it.once_white()), Bsdf::Eon(it.white())],
        Bsdf::Layered(it) => {
            // Between no layer and a whole one, whose coupling is a constant factor, lie all that cover a share.
            let whole = |base: &Bsdf| {
                let (tint, base) = (Some(darkened(it.tint)), Arc::new(base.clone()));
                let coupling = Coupling::Diffuse(Rgb::ONE);
                Bsdf::Layered(Layered { tint, base, coupling, coverage: 1.0, keeps_layer: false, ..it.clone() })
            };
            let bases = uncoloured(&it.base);
            bases.iter().map(whole).chain(bases.iter().cloned()).collect()
        }
        Bsdf::Mix(it) => it.models().iter().flat_map(uncoloured).collect(),
        Bsdf::Black(_) => Vec::new(),
        _ => vec![Bsdf::Lambert(Lambert::new(Rgb::ONE))],
    }
}

impl Layer {
    /// Appends the parameters but the colours.
    fn put_shape(&self, key: &mut Vec<u64>) {
        match self {
            Self::Coat(coat) => coat.put_shape(key),
            Self::Sheen(sheen) => key.extend([2, sheen.shape().into()]),
        }
    }
}

impl<C: Spectrum> Layer<C> {
    fn directional_albedo(&self, w: Vec3) -> f32 {
        match self {
            Self::Coat(coat) => coat.directional_albedo(w),
            Self::Sheen(sheen) => sheen.white_albedo(w),
        }
    }

    fn mean_albedo(&self) -> f32 {
        match self {
            Self::Coat(coat) => coat.mean_albedo(),
            Self::Sheen(sheen) => sheen.white_mean(),
        }
    }

    /// As a model.
    fn model(&self) -> &dyn Model<C> {
        match self {
            Self::Coat(coat) => coat,
            Self::Sheen(sheen) => sheen,
        }
    }
}

impl<C: Spectrum> Layered<C> {
    /// As [`Bsdf::parts`].
    pub(super) fn parts(&self, narrow_below: f32) -> Parts {
        self.part_of_layer(narrow_below) | self.base.parts(narrow_below)
    }

    fn part_of_layer(&self, narrow_below: f32) -> Parts {
        if self.has_layer() { Parts::of_model(self.layer.model(), narrow_below) } else { Parts::empty() }
    }

    /// As [`Bsdf::part`].
    pub(super) fn part(&self, part: Parts, narrow_below: f32) -> Option<Self> {
        let base = self.base.part(part, narrow_below);
        let keeps_layer = self.part_of_layer(narrow_below).intersects(part);
        (base.is_some() || keeps_layer).then(|| Self {
            base: Arc::new(base.unwrap_or(Bsdf::Black(Black))),
            keeps_layer,
            ..self.clone()
        })
    }

    /// With all facets turned.
    pub(super) fn turned(&self, turn: [f32; 2]) -> Self {
        let layer = match &*self.layer {
            Layer::Coat(coat) => Layer::Coat(coat.turned(turn)),
            Layer::Sheen(sheen) => Layer::Sheen(*sheen),
        };
        Self { layer: Arc::new(layer), base: Arc::new(self.base.turned(turn)), ..self.clone() }
    }

    /// Whether the layer itself scatters.
    fn has_layer(&self) -> bool {
        self.coverage > 0.0 && self.keeps_layer
    }

    /// Whether `w` is on a side that the layer covers.
    #[inline]
    fn is_covered(&self, w: Vec3) -> bool {
        self.on_both_sides || w.z > 0.0
    }

    /// T of a direction.
    #[inline]
    fn passes(&self, w: Vec3) -> f32 {
        if self.is_covered(w) { 1.0 - self.layer.directional_albedo(w) } else { 1.0 }
    }

    /// What is left of light that passes the layer along these directions.
    fn tinted(&self, ways: &[Vec3]) -> C {
        let Some(tint) = self.tint else { return C::ONE };
        let eta = match &*self.layer {
            Layer::Coat(coat) => coat.eta() as f32,
            Layer::Sheen(_) => 1.0,
        };
        let length: f32 = ways
            .iter()
            .filter(|w| self.is_covered(**w))
            .map(|w| {
                let sin2 = (1.0 - w.z * w.z).max(0.0);
                1.0 / (1.0 - sin2 / (eta * eta)).max(1e-4).sqrt()
            })
            .sum();
        C::from_reflectance(Rgb::from_array(tint.to_array().map(|left| left.powf(length))), &self.wavelengths)
    }

    /// The factor on f of the base.
    fn factor(&self, wo: Vec3, wi: Vec3) -> C {
        if !self.is_covered(wo) && !self.is_covered(wi) {
            return C::ONE;
        }
        let (a, b) = (self.passes(wo), self.passes(wi));
        let g = match self.coupling {
            Coupling::Diffuse(factor) => factor * (a * b),
            Coupling::Other(rho) => {
                let back = rho * (1.0 - a.max(b));
                (C::ONE - back).recip() * (a * b)
            }
        };
        C::splat(1.0 - self.coverage) + g * self.tinted(&[wo, wi]) * self.coverage
    }

    /// What the layer and the base scatter, for the choice between them.
    fn shares(&self, wo: Vec3) -> [f32; 2] {
        let layer = if self.has_layer() && self.is_covered(wo) {
            self.coverage * self.layer.model().share(wo).max(1e-4)
        } else {
            0.0
        };
        let base = if self.base.is_black() {
            0.0
        } else {
            (1.0 - self.coverage + self.coverage * self.passes(wo).max(1e-3)) * self.base.share(wo)
        };
        [layer, base]
    }

    fn first(&self, wo: Vec3) -> f32 {
        let [layer, base] = self.shares(wo);
        if layer + base > 0.0 { layer / (layer + base) } else { 0.5 }
    }

    /// The mean of the factor over directions of light.
    fn mean_factor(&self, wo: Vec3) -> C {
        let mut sum = C::ZERO;
        const N: usize = 16;
        for i in 0..N {
            // Equal shares of the irradiance.
            let mu = ((i as f32 + 0.5) / N as f32).sqrt();
            let wi = Vec3::new((1.0 - mu * mu).sqrt(), 0.0, mu.copysign(wo.z));
            sum += self.factor(wo, wi);
        }
        sum / N as f32
    }
}

impl<C: Spectrum> Model<C> for Layered<C> {
    fn lobes(&self) -> Lobes {
        let layer = if self.has_layer() { self.layer.model().lobes() } else { Lobes::empty() };
        layer | self.base.lit_lobes()
    }

    fn albedo(&self) -> C {
        let layer = if self.has_layer() { self.layer.model().albedo() * self.coverage } else { C::ZERO };
        let through = self.mean_passage;
        let base = match self.coupling {
            Coupling::Diffuse(factor) => factor * (through * through),
            Coupling::Other(_) => C::splat(through),
        };
        layer + self.base.albedo() * (C::splat(1.0 - self.coverage) + base * self.coverage)
    }

    fn diffuse_albedo(&self) -> C {
        let layer = match &*self.layer {
            Layer::Sheen(sheen) if self.has_layer() => Model::<C>::albedo(sheen) * self.coverage,
            _ => C::ZERO,
        };
        // The mean over the view of the mean over the light.
        const N: usize = 16;
        let mut factor = C::ZERO;
        for i in 0..N {
            let mu = ((i as f32 + 0.5) / N as f32).sqrt();
            factor += self.mean_factor(Vec3::new((1.0 - mu * mu).sqrt(), 0.0, mu));
        }
        layer + self.base.diffuse_albedo() * (factor / N as f32)
    }

    fn is_anisotropic(&self) -> bool {
        self.base.is_anisotropic() || self.layer.model().is_anisotropic()
    }

    fn narrowest(&self) -> f32 {
        let layer = if self.has_layer() { self.layer.model().narrowest() } else { 1.0 };
        if self.base.is_black() { layer } else { layer.min(self.base.narrowest()) }
    }

    fn share(&self, wo: Vec3) -> f32 {
        let [layer, base] = self.shares(wo);
        layer + base
    }

    #[inline(never)]
    fn f(&self, wo: Vec3, wi: Vec3, mode: TransportMode) -> C {
        let base = self.base.f(wo, wi, mode);
        let base = if base == C::ZERO { base } else { base * self.factor(wo, wi) };
        if self.has_layer() && self.is_covered(wo) {
            base + self.layer.model().f(wo, wi, mode) * self.coverage
        } else {
            base
        }
    }

    #[inline(never)]
    fn pdf(&self, wo: Vec3, wi: Vec3) -> f32 {
        let first = self.first(wo);
        let layer = if first > 0.0 { first * self.layer.model().pdf(wo, wi) } else { 0.0 };
        let base = if first < 1.0 { (1.0 - first) * self.base.pdf(wo, wi) } else { 0.0 };
        layer + base
    }

    #[inline(never)]
    fn f_pdf(&self, wo: Vec3, wi: Vec3, mode: TransportMode) -> (C, f32) {
        let first = self.first(wo);
        let (base, base_pdf) = self.base.f_pdf(wo, wi, mode);
        let (mut f, mut pdf) = (base, if first < 1.0 { (1.0 - first) * base_pdf } else { 0.0 });
        if base != C::ZERO {
            f *= self.factor(wo, wi);
        }
        if self.has_layer() && self.is_covered(wo) {
            let (layer, layer_pdf) = self.layer.model().f_pdf(wo, wi, mode);
            f += layer * self.coverage;
            pdf += first * layer_pdf;
        }
        (f, pdf)
    }

    #[inline(never)]
    fn sample(&self, wo: Vec3, mut u: [f32; 3], mode: TransportMode) -> Option<BsdfSample<C>> {
        let first = self.first(wo);
        if choose(first, &mut u[2]) {
            let sample = self.layer.model().sample(wo, u, mode)?;
            let weight = sample.weight * self.coverage;
            if sample.is_specular() {
                return Some(BsdfSample { weight: weight / first, ..sample });
            }
            let (mut f_cos, mut pdf) = (weight * sample.pdf, first * sample.pdf);
            if first < 1.0 {
                let (base, base_pdf) = self.base.f_pdf(wo, sample.wi, mode);
                f_cos += base * sample.wi.z.abs() * self.factor(wo, sample.wi);
                pdf += (1.0 - first) * base_pdf;
            }
            Some(BsdfSample { weight: f_cos / pdf, pdf, ..sample })
        } else {
            let sample = self.base.sample(wo, u, mode)?;
            let weight = sample.weight * self.factor(wo, sample.wi);
            let probability = 1.0 - first;
            if sample.is_specular() {
                return Some(BsdfSample { weight: weight / probability, ..sample });
            }
            let (mut f_cos, mut pdf) = (weight * sample.pdf, probability * sample.pdf);
            if first > 0.0 {
                let (layer, layer_pdf) = self.layer.model().f_pdf(wo, sample.wi, mode);
                f_cos += layer * (self.coverage * sample.wi.z.abs());
                pdf += first * layer_pdf;
            }
            Some(BsdfSample { weight: f_cos / pdf, pdf, ..sample })
        }
    }

    fn mean_f(&self, wo: Vec3) -> Option<C> {
        let layer = match &*self.layer {
            Layer::Sheen(sheen) if self.has_layer() => sheen.mean_f(wo).map(|f: C| f * self.coverage),
            _ => None,
        };
        match (layer, self.base.mean_f(wo).map(|f| f * self.mean_factor(wo))) {
            (Some(a), Some(b)) => Some(a + b),
            (one, other) => one.or(other),
        }
    }

    fn is_even(&self) -> bool {
        let is_sheen = matches!(&*self.layer, Layer::Sheen(_));
        self.base.is_even() && (!is_sheen || !self.keeps_layer || self.coverage == 0.0)
    }

    fn specular_lobes(&self, wo: Vec3, mode: TransportMode) -> SpecularLobes<C> {
        let base = self
            .base
            .specular_lobes(wo, mode)
            .map(|lobe| lobe.map(|lobe| BsdfSample { weight: lobe.weight * self.factor(wo, lobe.wi), ..lobe }));
        if !self.has_layer() || !self.is_covered(wo) {
            return base;
        }
        let layer = self.layer.model().specular_lobes(wo, mode);
        add_lobes(layer.map(|lobe| lobe.map(|lobe| BsdfSample { weight: lobe.weight * self.coverage, ..lobe })), base)
    }
}
