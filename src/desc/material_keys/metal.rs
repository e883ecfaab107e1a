//! Keys of metals and mirrors.

use super::super::builder::Builder;
use super::super::json::{self, join};
use super::super::numbers::{self, unless_color};
use super::super::{BsdfDesc, ConductorDesc, METALS, Metal, MicrofacetsDesc, ThinFilmDesc, validate};
use super::facets::{FacetDistribution, FacetKeys, FacetMasking};
use super::{Kind, SharedKeys, color, film, keys, material, tags};
use crate::spectrum::Rgb;
use crate::{Error, Result};

material!(
    /// A perfect mirror.
    Reflective, Reflective, {
    /// Reflectance, [0, 1] per channel. Default [1, 1, 1].
    color: Option<[f64; 3]>,
});

material!(
    /// A metal, smooth or rough.
    #[serde(rename_all = "camelCase")]
    Conductor, Metal, facets, {
    /// Symbol of a measured metal: Ag, Al, Au, Cr, Cu, Fe, Hg, Ir, Ni, Rh, TiN or W.
    metal: Option<String>,
    /// Index of refraction per channel, > 0, instead of `metal`.
    eta: Option<[f64; 3]>,
    /// Extinction coefficient per channel, >= 0, with `eta`.
    k: Option<[f64; 3]>,
    /// Reflectance at normal incidence, [0, 1] per channel, instead of `metal`.
    reflectance: Option<[f64; 3]>,
    /// With `reflectance`: tint of the edge, [0, 1] per channel. Default [1, 1, 1].
    edge_tint: Option<[f64; 3]>,
    /// A thin film on the outer side, whose two faces reflect light that interferes. Default: none.
    #[cfg_attr(feature = "schema", schemars(with = "Option<super::film::ThinFilm>"))]
    film: Option<Box<serde_json::value::RawValue>>,
    /// Whether light that facets reflect more than once is made up for. Default true, except with `v-cavity`.
    multiple_scattering: Option<bool>,
});

/// What a metal reflects: a metal's name, an index, or colours.
#[derive(Clone, Copy)]
struct MetalKeys<'a> {
    metal: &'a Option<String>,
    eta: Option<[f64; 3]>,
    k: Option<[f64; 3]>,
    reflectance: Option<[f64; 3]>,
    edge_tint: Option<[f64; 3]>,
}

impl Reflective {
    /// The keys of a mirror.
    pub(super) fn of(shared: SharedKeys, reflectance: Rgb) -> Self {
        let color = unless_color(reflectance, Rgb::ONE);
        keys!(Self, tags::Reflective::Reflective, shared, { color: color, })
    }
}

impl Conductor {
    /// The keys of a metal.
    pub(super) fn of(
        shared: SharedKeys,
        conductor: &ConductorDesc,
        microfacets: &MicrofacetsDesc,
        film: Option<&ThinFilmDesc>,
    ) -> Result<Self> {
        let facets = FacetKeys::of(microfacets);
        let film = film.map(film::write).transpose()?;
        let measured = METALS.iter().find(|metal| metal.conductor() == *conductor);
        let ([eta, k], [reflectance, edge_tint]) = match *conductor {
            ConductorDesc::Index { .. } if measured.is_some() => ([None; 2], [None; 2]),
            ConductorDesc::Index { eta, k } => ([eta, k].map(|it| Some(numbers::color(it))), [None; 2]),
            ConductorDesc::Reflectance { normal, edge } => {
                ([None; 2], [Some(numbers::color(normal)), unless_color(edge, Rgb::ONE)])
            }
        };
        Ok(keys!(Self, tags::Metal::Conductor, shared, facets facets, {
            metal: measured.map(|metal| metal.symbol.to_owned()),
            eta: eta,
            k: k,
            reflectance: reflectance,
            edge_tint: edge_tint,
            film: film,
            multiple_scattering: facets.multiple_scattering,
        }))
    }
}

impl Kind for Reflective {
    fn bsdf(&self, path: &str, _: &Builder<'_>) -> Result<BsdfDesc> {
        Ok(BsdfDesc::Mirror { reflectance: color(&join(path, "color"), self.color, 1.0)? })
    }
}

impl Kind for Conductor {
    fn bsdf(&self, path: &str, _: &Builder<'_>) -> Result<BsdfDesc> {
        let facets = self.facet_keys(self.multiple_scattering);
        // The two historical models are named by what they fix.
        let facets = match self._type {
            tags::Metal::Conductor => facets,
            tags::Metal::TorranceSparrow | tags::Metal::CookTorrance => {
                let is_beckmann = matches!(self._type, tags::Metal::CookTorrance);
                let fixed = [
                    ("masking", self.masking.is_some()),
                    ("multipleScattering", self.multiple_scattering.is_some()),
                    ("distribution", is_beckmann && self.distribution.is_some()),
                ];
                if let Some((key, _)) = fixed.into_iter().find(|(_, given)| *given) {
                    let message = "the model says this already; only type 'conductor' has this key";
                    return Err(Error::invalid(join(path, key), message));
                }
                let distribution = if is_beckmann { Some(FacetDistribution::Beckmann) } else { self.distribution };
                FacetKeys { distribution, masking: Some(FacetMasking::VCavity), ..facets }
            }
        };
        let keys = MetalKeys {
            metal: &self.metal,
            eta: self.eta,
            k: self.k,
            reflectance: self.reflectance,
            edge_tint: self.edge_tint,
        };
        let by_spectrum = |key: &str| self.spectra.as_ref().is_some_and(|spectra| spectra.contains_key(key));
        let by_index = [by_spectrum("eta"), by_spectrum("k")];
        let conductor = match (by_index, &keys) {
            ([false, false], _) => metal(keys, path, by_spectrum("reflectance"))?,
            // What is by the wavelength is set later.
            (_, MetalKeys { metal: Some(_), .. }) => metal(keys, path, false)?,
            (_, MetalKeys { eta, k, .. }) => metal(
                MetalKeys {
                    eta: eta.or(by_index[0].then_some([1.0; 3])),
                    k: k.or(by_index[1].then_some([1.0; 3])),
                    ..keys
                },
                path,
                false,
            )?,
        };
        Ok(BsdfDesc::Conductor { conductor, microfacets: facets.read(path)? })
    }

    fn film(&self, path: &str) -> Result<Option<ThinFilmDesc>> {
        self.film.as_deref().map(|value| film::read(value, &join(path, "film"))).transpose()
    }
}

/// What the facets of a metal reflect, from one of three groups of keys. `by_spectrum`: whether spectra say it later.
fn metal(keys: MetalKeys<'_>, path: &str, by_spectrum: bool) -> Result<ConductorDesc> {
    let at = |key: &str| join(path, key);
    let vector = |key: &str, value: [f64; 3]| validate::vector(&at(key), value).map(Rgb::from_f64);
    match keys {
        MetalKeys { metal: Some(symbol), eta: None, k: None, reflectance: None, edge_tint: None } => {
            Metal::by_symbol(symbol).map(Metal::conductor).ok_or_else(|| {
                let known: Vec<&str> = METALS.iter().map(|metal| metal.symbol).collect();
                let message = format!("unknown metal '{}', expected one of {}", json::elided(symbol), known.join(", "));
                Error::invalid(at("metal"), message)
            })
        }
        MetalKeys { metal: None, eta: Some(eta), k: Some(k), reflectance: None, edge_tint: None } => {
            Ok(ConductorDesc::Index { eta: vector("eta", eta)?, k: vector("k", k)? })
        }
        MetalKeys { metal: None, eta: None, k: None, reflectance: Some(normal), edge_tint } => {
            let normal = validate::reflectance(&at("reflectance"), normal)?;
            Ok(ConductorDesc::Reflectance { normal, edge: color(&at("edgeTint"), edge_tint, 1.0)? })
        }
        MetalKeys { metal: None, eta: None, k: None, reflectance: None, edge_tint } if by_spectrum => {
            Ok(ConductorDesc::Reflectance { normal: Rgb::ONE, edge: color(&at("edgeTint"), edge_tint, 1.0)? })
        }
        _ => {
            let message = "expected one of: `metal`, `eta` with `k`, or `reflectance` with or without `edgeTint`";
            Err(Error::invalid(path, message))
        }
    }
}
