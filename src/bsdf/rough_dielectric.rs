//! Rough interface between two dielectrics.

use std::f32::consts::FRAC_1_PI;

use super::dispersive::{Index, Indices};
use super::fresnel::fresnel_dielectric;
use super::lobes::{Lobes, TransportMode};
use super::local::{outward, refract_about};
use super::memo::memo;
use super::microfacet::{FacetShares, Microfacets, MissingEnergy, average, choose};
use super::model::{BsdfSample, Model};
use super::thin_film::{FilmedInterface, Shares};
use crate::math::Vec3;
use crate::sampling::warps;
use crate::spectrum::{Rgb, Spectrum};

/// A colourless interface of facets, each of which reflects by Fresnel's equations and refracts by Snell's law, and what
/// facets scatter more than once.
///
/// What single scattering loses is spread over both sides, as for metals by (1 - E(wo)) (1 - E(wi)). The shares of the two sides
/// are those that keep f(i -> o) / n_o^2 = f(o -> i) / n_i^2, so that photons and paths from the camera agree.
///
/// Where a medium disperses light, a path takes its direction from its first wavelength, as at a [`super::Dispersive`] interface.
/// What facets scatter more than once is that of the line d for all wavelengths.
///
/// With a film, a facet reflects what interference leaves, and chooses by one probability for all channels. What facets scatter more
/// than once has no colour: its share is worked out with the luminance of what the film reflects.
///
/// Sources: Walter et al. 2007, "Microfacet Models for Refraction through Rough Surfaces"; Kulla and Conty 2017.
#[derive(Clone, Debug, PartialEq)]
pub struct RoughDielectric<C: Spectrum = Rgb> {
    /// Index on the inner side over index on the outer side.
    eta: f64,
    facets: Microfacets,
    multiple: Option<Multiple>,
    /// What makes channels differ.
    by_channel: Option<Box<ByChannel>>,
    wavelengths: C::Wavelengths,
}

/// What makes the reflectance of facets depend on the channel.
#[derive(Clone, Debug, PartialEq)]
enum ByChannel {
    /// The indices on both sides, of which one depends on the wavelength.
    Dispersion(Indices),
    /// A film.
    Film(FilmedInterface),
}

/// What is scattered more than once: for light from the outer side, and from the inner side.
#[derive(Clone, Debug, PartialEq)]
struct Multiple {
    missing: [MissingEnergy; 2],
    /// The share of it that is transmitted.
    transmitted: [f32; 2],
}

impl RoughDielectric {
    /// A rough interface. `ior`: index of refraction on the inner side, `exterior_ior`: on the outer side, different from
    /// `ior`. `is_compensated`: whether light that is scattered more than once is included.
    pub fn new(ior: f32, exterior_ior: f32, facets: Microfacets, is_compensated: bool) -> Self {
        let eta = f64::from(ior) / f64::from(exterior_ior);
        let multiple = is_compensated.then(|| Multiple::new(eta, &facets)).flatten();
        Self { eta, facets, multiple, by_channel: None, wavelengths: () }
    }

    /// The same interface with a film.
    pub(super) fn filmed(self, film: FilmedInterface) -> Self {
        let multiple = self.multiple.and_then(|_| Multiple::of_film(&film, &self.facets));
        Self { multiple, by_channel: Some(Box::new(ByChannel::Film(film))), ..self }
    }

    /// The same interface between media whose indices depend on the wavelength.
    pub(super) fn dispersing(self, inner: Index, outer: Index) -> Self {
        if let Some(ByChannel::Film(film)) = self.by_channel.as_deref() {
            let film = film.dispersing(inner, outer);
            return self.filmed(film);
        }
        Self { by_channel: Some(Box::new(ByChannel::Dispersion(Indices::new(inner, outer)))), ..self }
    }

    #[inline(always)]
    pub(super) fn in_spectrum<C: Spectrum>(&self, wavelengths: &C::Wavelengths) -> RoughDielectric<C> {
        let Self { facets, multiple, by_channel, .. } = self.clone();
        let first = C::first_wavelength(wavelengths);
        let eta = match by_channel.as_deref() {
            None => self.eta,
            Some(ByChannel::Dispersion(indices)) => indices.eta(first),
            Some(ByChannel::Film(film)) => film.eta(first),
        };
        RoughDielectric { eta, facets, multiple, by_channel, wavelengths: *wavelengths }
    }
}

memo!(
    /// Mean share that smooth interfaces let pass, by their relative index.
    PASSES: u64 => f64, 1024
);

memo!(
    /// Mean share that smooth interfaces with a film let pass, by the numbers of the film and the relative index.
    PASSES_FILM: ([u64; 2], u64) => f64, 1024
);

impl Multiple {
    /// `None` where nothing worth mentioning is scattered more than once.
    fn new(eta: f64, facets: &Microfacets) -> Option<Self> {
        let missing = [eta, 1.0 / eta].map(|eta| {
            MissingEnergy::new(facets, (eta, true), |cos| {
                let reflected = fresnel_dielectric(cos, eta);
                FacetShares { reflected, transmitted: Some((1.0 - reflected, eta)) }
            })
        });
        Self::balanced(eta, missing, |eta| {
            PASSES.get(&eta.to_bits(), || 1.0 - average(|mu| fresnel_dielectric(mu, eta)))
        })
    }

    /// As [`Self::new`], for facets with a film.
    fn of_film(film: &FilmedInterface, facets: &Microfacets) -> Option<Self> {
        let (eta, film) = (film.eta(None), film.rounded());
        let missing = [(0, eta), (1, 1.0 / eta)].map(|(side, eta)| {
            MissingEnergy::of_film(facets, (eta, true), film.layer(), |cos| {
                let reflected = film.grey(side, cos);
                FacetShares { reflected, transmitted: Some((1.0 - reflected, eta)) }
            })
        });
        Self::balanced(eta, missing, |of| {
            let key = (film.layer(), of.to_bits());
            PASSES_FILM.get(&key, || 1.0 - average(|mu| film.grey(usize::from(of != eta), mu)))
        })
    }

    /// The shares of the sides, by what single scattering loses and by what a smooth interface of a relative index lets pass.
    fn balanced(eta: f64, missing: [MissingEnergy; 2], passes: impl Fn(f64) -> f64) -> Option<Self> {
        let means = [0, 1].map(|side: usize| f64::from(missing[side].mean()));
        if means[0].min(means[1]) < 1e-7 {
            return None;
        }
        // Of the light that comes from one side, the share t = kappa n^2 (1 - E_mean) of the other is transmitted, which is
        // the reciprocal form; kappa is as large as can be without more than a smooth interface transmits.
        let passes = [eta, 1.0 / eta].map(passes);
        let own = [means[1] * eta * eta, means[0]];
        let kappa = (passes[0] / own[0]).min(passes[1] / own[1]);
        Some(Self { missing, transmitted: own.map(|own| (kappa * own) as f32) })
    }
}

impl<C: Spectrum> RoughDielectric<C> {
    /// With its facets turned.
    pub(super) fn turned(&self, turn: [f32; 2]) -> Self {
        Self { facets: self.facets.turned(turn), ..self.clone() }
    }

    /// 0 on the outer side, 1 on the inner side.
    #[inline]
    fn side(wo: Vec3) -> usize {
        usize::from(wo.z < 0.0)
    }

    /// Index on the far side over index on `wo`'s side.
    #[inline]
    fn relative_eta(&self, wo: Vec3) -> f64 {
        if wo.z > 0.0 { self.eta } else { 1.0 / self.eta }
    }

    /// What single scattering loses of light from `wo`, which is the probability with which a cosine-distributed direction is
    /// drawn instead of a facet; 0 without compensation.
    #[inline]
    fn several(&self, wo: Vec3) -> f32 {
        self.multiple.as_ref().map_or(0.0, |multiple| multiple.missing[Self::side(wo)].at(&self.facets, wo))
    }

    /// Of what is scattered more than once: f in terms of power, and the probability of `wi`'s side. `wo` is on this side and loses
    /// the share `several`; the directions are on one side if `reflects`.
    #[inline]
    fn multiple(&self, side: usize, several: f32, wi: Vec3, reflects: bool) -> (f32, f32) {
        let Some(Multiple { missing, transmitted }) = &self.multiple else { return (0.0, 0.0) };
        let other = if reflects { side } else { 1 - side };
        let share = if reflects { 1.0 - transmitted[side] } else { transmitted[side] };
        let arriving = missing[other].at(&self.facets, wi);
        (share * several * arriving * FRAC_1_PI / missing[other].mean(), share)
    }

    /// Factor from f in terms of power to f of what is carried, for light that is transmitted.
    #[inline]
    fn transmission_scale(eta: f64, mode: TransportMode) -> f32 {
        match mode {
            TransportMode::Radiance => (1.0 / (eta * eta)) as f32,
            TransportMode::Importance => 1.0,
        }
    }

    /// The facet that connects two directions, on the outer side; `wo` is on the outer side. `None` where there is none.
    #[inline]
    fn facet(wo: Vec3, wi: Vec3, eta: f64) -> Option<Vec3> {
        if wi.z > 0.0 {
            return Some((wo + wi).normalize());
        }
        let h = wo.as_dvec3() + eta * wi.as_dvec3();
        let m = h.normalize_or_zero().as_vec3a();
        let m = if m.z < 0.0 { -m } else { m };
        (wo.dot(m) > 0.0 && wi.dot(m) < 0.0).then_some(m)
    }

    /// The film of the facets, if there is one.
    #[inline]
    fn film(&self) -> Option<&FilmedInterface> {
        match self.by_channel.as_deref() {
            Some(ByChannel::Film(film)) => Some(film),
            _ => None,
        }
    }

    /// What a facet with a film does with light between two directions. `wo` is on the outer side, whose own side is the outer one if
    /// `front`.
    fn shares(&self, film: &FilmedInterface, (wo, wi): (Vec3, Vec3), m: Vec3, eta: f64, front: bool) -> Shares<C> {
        // As without a film, the angle in the thinner medium tells more; but where media disperse light, it is another one for each
        // wavelength.
        if wi.z < 0.0 && eta < 1.0 && !film.disperses() {
            film.shares(wi.dot(m), !front, &self.wavelengths)
        } else {
            film.shares(wo.dot(m), front, &self.wavelengths)
        }
    }

    /// The reflectance of a facet without a film for light between two directions.
    #[inline]
    fn reflectance(wo: Vec3, wi: Vec3, m: Vec3, eta: f64) -> f32 {
        // Of light that is transmitted, the angle in the thinner medium is the one that tells the reflectance to all digits: in the
        // other one, angles are crowded below the critical angle.
        if wi.z < 0.0 && eta < 1.0 {
            fresnel_dielectric(f64::from(wi.dot(m)), 1.0 / eta) as f32
        } else {
            fresnel_dielectric(f64::from(wo.dot(m)), eta) as f32
        }
    }

    /// f |cos(wi)| in terms of power and the density of single scattering, by the facet that connects the directions and its
    /// reflectance. `wo` is on the outer side, `wi` on its own.
    #[inline]
    fn once(&self, wo: Vec3, wi: Vec3, m: Vec3, eta: f64, reflectance: f32) -> (f32, f32) {
        let cos = wo.dot(m);
        if wi.z > 0.0 {
            let (g1, g2) = self.facets.reflection_masking(wo, wi, m);
            let once = reflectance * self.facets.d(m) / (4.0 * wo.z);
            (once * g2, once * g1)
        } else {
            let (g1, g2) = self.facets.transmission_masking(wo, outward(wi), m);
            let (cos_o, cos_i) = (f64::from(cos), f64::from(wi.dot(m)));
            let sum = cos_o + eta * cos_i;
            let jacobian = (eta * eta * -cos_i / (sum * sum)) as f32;
            let once = (1.0 - reflectance) * self.facets.d(m) * cos.max(0.0) * jacobian / wo.z;
            (once * g2, once * g1)
        }
    }

    /// f |cos(wi)| for what is carried, and the density, by the facet if there is one. `wo` is on the outer side, `side` is the
    /// sign of its own cosine, and `several` is what it loses.
    #[inline]
    fn evaluate(
        &self,
        wo: Vec3,
        wi: Vec3,
        m: Option<Vec3>,
        (side, several): (f32, f32),
        mode: TransportMode,
    ) -> (C, f32) {
        let axis = Vec3::new(0.0, 0.0, side);
        let eta = self.relative_eta(axis);
        let reflects = wi.z > 0.0;
        let film = self.film().zip(m).map(|(film, m)| self.shares(film, (wo, wi), m, eta, side > 0.0));
        let (once, pdf_once) = m.map_or((0.0, 0.0), |m| {
            let reflectance = film.map_or_else(|| Self::reflectance(wo, wi, m, eta), |shares| shares.probability);
            self.once(wo, wi, m, eta, reflectance)
        });
        let own = outward(wi);
        let (f_several, share) = self.multiple(Self::side(axis), several, wi, reflects);
        let pdf = (1.0 - several) * pdf_once + several * share * warps::cosine_hemisphere_pdf(own.z);
        let scale = if reflects { 1.0 } else { Self::transmission_scale(eta, mode) };
        // At the edge of what single precision holds, a density can be 0 times infinity.
        let once = if once.is_finite() { once } else { 0.0 };
        let pdf = if pdf.is_finite() { pdf } else { 0.0 };
        let f_several = f_several * own.z;
        if let Some(shares) = film {
            let weight = if reflects { shares.reflected_weight() } else { shares.transmitted_weight() };
            return ((weight * once + C::splat(f_several)) * scale, pdf);
        }
        if let Some(ByChannel::Dispersion(indices)) = self.by_channel.as_deref()
            && let Some(m) = m.filter(|_| reflects && C::HAS_WAVELENGTHS)
        {
            let shares = indices.reflected::<C>(wo.dot(m), side > 0.0, &self.wavelengths);
            return (shares * once + C::splat(f_several), pdf);
        }
        (C::splat(scale * (once + f_several)), pdf)
    }

    /// Both directions with `wo` on the outer side; `None` where one lies in the surface.
    #[inline]
    fn outwards(wo: Vec3, wi: Vec3) -> Option<(Vec3, Vec3)> {
        let flip = 1.0_f32.copysign(wo.z);
        let wi = Vec3::new(wi.x, wi.y, wi.z * flip);
        (wo.z * wi.z != 0.0).then_some((outward(wo), wi))
    }
}

impl<C: Spectrum> Model<C> for RoughDielectric<C> {
    fn lobes(&self) -> Lobes {
        Lobes::GLOSSY
    }

    fn albedo(&self) -> C {
        C::ONE
    }

    fn is_anisotropic(&self) -> bool {
        self.facets.is_anisotropic()
    }

    fn disperses(&self) -> bool {
        match self.by_channel.as_deref() {
            None => false,
            Some(ByChannel::Dispersion(_)) => true,
            Some(ByChannel::Film(film)) => film.disperses(),
        }
    }

    fn narrowest(&self) -> f32 {
        self.facets.widths()[1].min(1.0)
    }

    fn f(&self, wo: Vec3, wi: Vec3, mode: TransportMode) -> C {
        self.f_pdf(wo, wi, mode).0
    }

    fn pdf(&self, wo: Vec3, wi: Vec3) -> f32 {
        let (_, pdf): (C, f32) = self.f_pdf(wo, wi, TransportMode::Importance);
        pdf
    }

    #[inline(never)]
    fn f_pdf(&self, wo: Vec3, wi: Vec3, mode: TransportMode) -> (C, f32) {
        let Some((o, i)) = Self::outwards(wo, wi) else { return (C::ZERO, 0.0) };
        let m = Self::facet(o, i, self.relative_eta(wo));
        let (f_cos, pdf) = self.evaluate(o, i, m, (wo.z, self.several(wo)), mode);
        (f_cos / i.z.abs(), pdf)
    }

    #[inline(never)]
    fn sample(&self, wo: Vec3, mut u: [f32; 3], mode: TransportMode) -> Option<BsdfSample<C>> {
        let eta = self.relative_eta(wo);
        let (o, side) = (outward(wo), wo.z);
        let several = self.several(wo);
        let (wi, m) = if several > 0.0 && choose(several, &mut u[2]) {
            let transmitted = self.multiple.as_ref().map_or(0.0, |multiple| multiple.transmitted[Self::side(wo)]);
            let up = warps::cosine_hemisphere([u[0], u[1]]);
            let wi = if u[2] < transmitted { -up } else { up };
            (wi, Self::facet(o, wi, eta))
        } else {
            let m = self.facets.visible_normal(o, &mut u);
            let cos = o.dot(m);
            let reflectance = match self.film() {
                None => fresnel_dielectric(f64::from(cos), eta) as f32,
                Some(film) => film.shares::<C>(cos, side > 0.0, &self.wavelengths).probability,
            };
            let reflects = u[2] < reflectance;
            let wi = if reflects { 2.0 * cos * m - o } else { refract_about(o, m, eta)? };
            // What a facet scatters to the wrong side meets another one: the light that is made up for.
            if (wi.z > 0.0) != reflects || wi.z == 0.0 {
                return None;
            }
            (wi.normalize(), Some(m))
        };
        let (f_cos, pdf) = self.evaluate(o, wi, m, (side, several), mode);
        let weight = f_cos / pdf;
        let (lobe, eta) =
            if wi.z > 0.0 { (Lobes::GLOSSY_REFLECTION, 1.0) } else { (Lobes::GLOSSY_TRANSMISSION, eta as f32) };
        let wi = Vec3::new(wi.x, wi.y, wi.z * 1.0_f32.copysign(side));
        (pdf > 0.0 && weight.is_finite()).then_some(BsdfSample { wi, weight, pdf, lobe, eta })
    }
}
