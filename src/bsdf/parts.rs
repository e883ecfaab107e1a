//! Parts of a Bsdf, as methods that store light on surfaces take it apart.

#[cfg(test)]
use super::Lobes;
use super::{Bsdf, Model};
use crate::spectrum::Spectrum;

bitflags::bitflags! {
    /// Parts of a Bsdf. The sum of all parts is the whole.
    #[derive(Clone, Copy, Debug, PartialEq, Eq)]
    pub struct Parts: u8 {
        /// Diffuse lobes: light on them can be stored and gathered.
        const DIFFUSE = 1;
        /// Glossy lobes that are not narrow.
        const GLOSSY = 1 << 1;
        /// Delta lobes, and glossy lobes that are so narrow that they count as delta lobes.
        const NARROW = 1 << 2;
    }
}

impl Parts {
    /// The part to which a model belongs that cannot be taken apart. Glossy lobes are narrow below the width `narrow_below`.
    pub(super) fn of_model<C: Spectrum>(model: &(impl Model<C> + ?Sized), narrow_below: f32) -> Self {
        let lobes = model.lobes();
        if lobes.have_diffuse() {
            Self::DIFFUSE
        } else if lobes.is_empty() {
            Self::empty()
        } else if model.narrowest() < narrow_below {
            Self::NARROW
        } else {
            Self::GLOSSY
        }
    }
}

impl<C: Spectrum> Bsdf<C> {
    /// The parts that the Bsdf has. Glossy lobes are narrow if their width ([`Model::narrowest`]) is below `narrow_below`, which is
    /// above 0.
    pub fn parts(&self, narrow_below: f32) -> Parts {
        match self {
            _ if self.is_black() => Parts::empty(),
            Self::Layered(layered) => layered.parts(narrow_below),
            Self::Mix(mix) => mix.parts(narrow_below),
            Self::TwoSided(two_sided) => two_sided.parts(narrow_below),
            #[cfg(test)]
            Self::LobeMixture(mixture) => mixture.parts(narrow_below),
            whole => Parts::of_model::<C>(whole, narrow_below),
        }
    }

    /// Only one part of the Bsdf, with f and densities of its own; `None` where there is no such part.
    pub fn part(&self, part: Parts, narrow_below: f32) -> Option<Self> {
        match self {
            _ if self.is_black() => None,
            Self::Layered(layered) => layered.part(part, narrow_below).map(Self::Layered),
            Self::Mix(mix) => mix.part(part, narrow_below).map(Self::Mix),
            Self::TwoSided(two_sided) => two_sided.part(part, narrow_below).map(Self::TwoSided),
            #[cfg(test)]
            Self::LobeMixture(mixture) => mixture.part(part, narrow_below).map(Self::LobeMixture),
            whole => part.intersects(Parts::of_model::<C>(whole, narrow_below)).then(|| whole.clone()),
        }
    }
}

/// The lobes of a part, among these single lobes of which the glossy ones have this width.
#[cfg(test)]
pub(super) fn lobes_of(part: Parts, glossy_is_narrow: bool) -> Lobes {
    let mut lobes = Lobes::empty();
    if part.contains(Parts::DIFFUSE) {
        lobes |= Lobes::DIFFUSE;
    }
    if part.contains(if glossy_is_narrow { Parts::NARROW } else { Parts::GLOSSY }) {
        lobes |= Lobes::GLOSSY;
    }
    if part.contains(Parts::NARROW) {
        lobes |= Lobes::SPECULAR;
    }
    lobes
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bsdf::TransportMode;
    use crate::desc::{BsdfDesc, ConductorDesc, MicrofacetsDesc, PrincipledDesc};
    use crate::math::Vec3;
    use crate::sampling::Rng;
    use crate::sampling::warps;
    use crate::spectrum::Rgb;

    fn facets(roughness: f32) -> MicrofacetsDesc {
        MicrofacetsDesc { roughness, ..MicrofacetsDesc::default() }
    }

    fn models() -> Vec<(&'static str, Bsdf, Parts)> {
        let albedo = Rgb::new(0.7, 0.4, 0.2);
        let coated = |roughness| {
            Bsdf::new(&BsdfDesc::CoatedDiffuse { albedo, ior: 1.5, exterior_ior: 1.0, microfacets: facets(roughness) })
        };
        let metal = |roughness| {
            let conductor = ConductorDesc::Reflectance { normal: albedo, edge: Rgb::ONE };
            Bsdf::new(&BsdfDesc::Conductor { conductor, microfacets: facets(roughness) })
        };
        let frosted = |roughness| {
            let microfacets = facets(roughness);
            Bsdf::new(&BsdfDesc::ThinDielectric { ior: 1.5, exterior_ior: 1.0, transmittance: albedo, microfacets })
        };
        let paint = PrincipledDesc {
            base_color: albedo,
            base_metalness: 0.3,
            specular_roughness: 0.7,
            coat_weight: 0.6,
            coat_roughness: 0.2,
            fuzz_weight: 0.4,
            ..PrincipledDesc::default()
        };
        let lambert = || Bsdf::new(&BsdfDesc::Lambert { albedo });
        vec![
            ("lambert", lambert(), Parts::DIFFUSE),
            ("mirror", Bsdf::new(&BsdfDesc::Mirror { reflectance: albedo }), Parts::NARROW),
            ("black", Bsdf::new(&BsdfDesc::Black), Parts::empty()),
            ("narrow metal", metal(0.2), Parts::NARROW),
            ("metal", metal(0.5), Parts::GLOSSY),
            ("smooth coat", coated(0.0), Parts::DIFFUSE | Parts::NARROW),
            ("narrow coat", coated(0.2), Parts::DIFFUSE | Parts::NARROW),
            ("rough coat", coated(0.6), Parts::DIFFUSE | Parts::GLOSSY),
            ("frosted sheet", frosted(0.5), Parts::GLOSSY),
            ("narrow sheet", frosted(0.2), Parts::NARROW),
            ("paint", Bsdf::new(&BsdfDesc::Principled(paint)), Parts::all()),
            ("faces", Bsdf::TwoSided(crate::bsdf::TwoSided::new([coated(0.2), metal(0.5)])), Parts::all()),
            ("mix", Bsdf::Mix(crate::bsdf::Mix::new([lambert(), metal(0.2)], 0.3)), Parts::DIFFUSE | Parts::NARROW),
        ]
    }

    /// Between 0.04 and 0.25, the widths of roughnesses of 0.2 and 0.5.
    const NARROW_BELOW: f32 = 0.1;

    #[test]
    fn the_parts_of_a_bsdf_sum_up_to_it() {
        const MODE: TransportMode = TransportMode::Radiance;
        let mut rng = Rng::new(1, 0);
        for (name, bsdf, expected) in models() {
            let parts = bsdf.parts(NARROW_BELOW);
            assert_eq!(parts, expected, "{name}");
            let alone = Parts::all().iter().map(|part| (part, bsdf.part(part, NARROW_BELOW))).collect::<Vec<_>>();
            for (part, alone) in &alone {
                assert_eq!(alone.is_some(), parts.contains(*part), "{name}: {part:?}");
                let Some(alone) = alone else { continue };
                assert_eq!(alone.parts(NARROW_BELOW), *part, "{name}: {part:?}");
            }
            let sum = |f: &dyn Fn(&Bsdf) -> Rgb| {
                alone.iter().filter_map(|(_, part)| part.as_ref()).fold(Rgb::ZERO, |sum, part| sum + f(part))
            };
            let near = |what: &str, got: Rgb, expected: Rgb| {
                let error = (got - expected).to_f64().abs().max_element();
                let size = f64::from(expected.max_element());
                assert!(error <= 1e-5 * size, "{name}, {what}: {got:?} and not {expected:?}");
            };
            for _ in 0..200 {
                let [a, b, c, d] = rng.next_4d();
                let (mut wo, wi) = (warps::cosine_hemisphere([a, b]), warps::cosine_hemisphere([c, d]));
                for side in [1.0, -1.0] {
                    (wo.x, wo.y) = (wo.x * side, wo.y * side);
                    let (wo, wi) = (side * wo, side * wi);
                    near("f", sum(&|part| part.f(wo, wi, MODE)), bsdf.f(wo, wi, MODE));
                    let specular = |bsdf: &Bsdf| {
                        let lobes = bsdf.specular_lobes(wo, MODE);
                        lobes.iter().flatten().fold(Rgb::ZERO, |sum, lobe| sum + lobe.weight)
                    };
                    near("delta lobes", sum(&specular), specular(&bsdf));
                    let mean = |bsdf: &Bsdf| bsdf.mean_f(wo).unwrap_or(Rgb::ZERO);
                    near("mean of f", sum(&mean), mean(&bsdf));
                }
            }
            // A part has the densities of its own samples.
            for (part, alone) in alone.iter().filter_map(|(part, alone)| Some((part, alone.as_ref()?))) {
                for _ in 0..200 {
                    let [a, b, c, d] = rng.next_4d();
                    let wo: Vec3 = warps::cosine_hemisphere([a, d]);
                    let Some(sample) = alone.sample(wo, [a, b, c], MODE).filter(|sample| !sample.is_specular()) else {
                        continue;
                    };
                    let pdf = alone.pdf(wo, sample.wi);
                    assert!((sample.pdf - pdf).abs() <= 2e-3 * pdf, "{name}, {part:?}: {} {pdf}", sample.pdf);
                    let weight = alone.f(wo, sample.wi, MODE) * (sample.wi.z.abs() / pdf);
                    let error = (weight - sample.weight).to_f64().abs().max_element();
                    assert!(error <= 5e-3 * f64::from(weight.max_element()), "{name}, {part:?}: {weight:?}");
                }
            }
        }
    }
}
