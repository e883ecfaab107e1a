//! What a clear coat reflects.

use super::fresnel::fresnel_dielectric;
use super::lobes::{Lobes, TransportMode};
use super::local::{outward, reflect, same_side};
use super::memo::memo;
use super::microfacet::{FacetShares, Microfacets, MissingEnergy, average};
use super::model::{BsdfSample, Model, SpecularLobes};
use crate::math::Vec3;
use crate::spectrum::Spectrum;

/// The reflection of a dielectric coat, smooth or rough, without what passes it: the upper layer of
/// [`Layered`](super::Layered). It reflects on both sides of the surface, of which each is an outer side of the coat.
#[derive(Clone, Debug, PartialEq)]
pub struct Coat {
    /// Index of the coat over index outside.
    eta: f64,
    rough: Option<(Microfacets, MissingEnergy)>,
    mean: f32,
}

memo!(
    /// Mean share that smooth coats reflect, by their relative index.
    SMOOTH: u64 => f32, 1024
);

impl Coat {
    /// A coat. `eta`: its index of refraction over the index outside, > 0. `facets`: those of its surface, if it is rough.
    pub fn new(eta: f64, facets: Option<Microfacets>) -> Self {
        let reflected = move |cos: f64| fresnel_dielectric(cos, eta);
        let rough = facets.map(|facets| {
            let shares = |cos| FacetShares { reflected: reflected(cos), transmitted: None };
            (facets, MissingEnergy::new(&facets, (eta, false), shares))
        });
        let mean = match &rough {
            Some((_, missing)) => 1.0 - missing.mean(),
            None => SMOOTH.get(&eta.to_bits(), || average(reflected) as f32),
        };
        Self { eta, rough, mean }
    }

    /// With its facets turned.
    pub(super) fn turned(&self, turn: [f32; 2]) -> Self {
        let rough = self.rough.as_ref().map(|(facets, missing)| (facets.turned(turn), missing.clone()));
        Self { rough, ..self.clone() }
    }

    /// Appends the parameters.
    pub(super) fn put_shape(&self, key: &mut Vec<u64>) {
        key.extend([1, self.eta.to_bits()]);
        if let Some((facets, _)) = &self.rough {
            facets.put_shape(key);
        }
    }

    /// Index of the coat over index outside.
    pub(super) fn eta(&self) -> f64 {
        self.eta
    }

    /// The share of the light from `w` that the coat reflects.
    #[inline]
    pub(super) fn directional_albedo(&self, w: Vec3) -> f32 {
        match &self.rough {
            Some((facets, missing)) => 1.0 - missing.at(facets, w),
            None => fresnel_dielectric(f64::from(w.z), self.eta) as f32,
        }
    }

    /// The mean share, for light from all sides.
    pub(super) fn mean_albedo(&self) -> f32 {
        self.mean
    }

    /// f cos and the density of a facet's reflection; both directions are on the outer side.
    #[inline]
    fn facet(&self, facets: &Microfacets, wo: Vec3, wi: Vec3, m: Vec3) -> (f32, f32) {
        let reflected = fresnel_dielectric(f64::from(wo.dot(m)), self.eta) as f32;
        let (f_cos, pdf) = facets.reflection(wo, wi, m);
        (reflected * f_cos, pdf)
    }
}

impl<C: Spectrum> Model<C> for Coat {
    fn lobes(&self) -> Lobes {
        if self.rough.is_some() { Lobes::GLOSSY_REFLECTION } else { Lobes::SPECULAR_REFLECTION }
    }

    fn albedo(&self) -> C {
        C::splat(self.mean)
    }

    fn is_anisotropic(&self) -> bool {
        self.rough.as_ref().is_some_and(|(facets, _)| facets.is_anisotropic())
    }

    fn narrowest(&self) -> f32 {
        self.rough.as_ref().map_or(0.0, |(facets, _)| facets.widths()[1].min(1.0))
    }

    fn share(&self, wo: Vec3) -> f32 {
        self.directional_albedo(wo)
    }

    fn f(&self, wo: Vec3, wi: Vec3, mode: TransportMode) -> C {
        Model::<C>::f_pdf(self, wo, wi, mode).0
    }

    fn pdf(&self, wo: Vec3, wi: Vec3) -> f32 {
        Model::<C>::f_pdf(self, wo, wi, TransportMode::Radiance).1
    }

    #[inline(never)]
    fn f_pdf(&self, wo: Vec3, wi: Vec3, _: TransportMode) -> (C, f32) {
        let Some((facets, _)) = self.rough.as_ref().filter(|_| same_side(wo, wi)) else { return (C::ZERO, 0.0) };
        let (wo, wi) = (outward(wo), outward(wi));
        let (f_cos, pdf) = self.facet(facets, wo, wi, (wo + wi).normalize());
        (C::splat(f_cos / wi.z), pdf)
    }

    #[inline(never)]
    fn sample(&self, wo: Vec3, mut u: [f32; 3], mode: TransportMode) -> Option<BsdfSample<C>> {
        let Some((facets, _)) = &self.rough else { return Model::<C>::specular_lobes(self, wo, mode)[0] };
        let o = outward(wo);
        let m = facets.reflecting_normal(o, &mut u);
        let wi = (2.0 * o.dot(m) * m - o).normalize();
        if wi.z <= 0.0 {
            return None;
        }
        let (f_cos, pdf) = self.facet(facets, o, wi, m);
        let weight = C::splat(f_cos / pdf);
        let wi = Vec3::new(wi.x, wi.y, wi.z.copysign(wo.z));
        let lobe = Lobes::GLOSSY_REFLECTION;
        (pdf > 0.0 && weight.is_finite()).then_some(BsdfSample { wi, weight, pdf, lobe, eta: 1.0 })
    }

    fn specular_lobes(&self, wo: Vec3, _: TransportMode) -> SpecularLobes<C> {
        if self.rough.is_some() {
            return [None; 3];
        }
        let weight = C::splat(self.directional_albedo(wo));
        [Some(BsdfSample { wi: reflect(wo), weight, pdf: 0.0, lobe: Lobes::SPECULAR_REFLECTION, eta: 1.0 }), None, None]
    }
}
