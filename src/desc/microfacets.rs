//! Descriptions of rough surfaces: the facets, and what a metal's facets reflect.

use crate::spectrum::Rgb;

/// How the slopes of facets are distributed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Distribution {
    /// Trowbridge and Reitz, called GGX by Walter et al. 2007: with long tails, as most measured surfaces have.
    #[default]
    Ggx,
    /// Beckmann's: a normal distribution of slopes.
    Beckmann,
}

/// Which facets are hidden by others.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Masking {
    /// Smith's, for facets whose heights do not depend on their slopes. A facet that is seen from one side is high, and so is
    /// rarely hidden from the other (height-correlated).
    #[default]
    Smith,
    /// Smith's, as if the two sides knew nothing of each other; this is how many renderers have it.
    SmithSeparable,
    /// Torrance and Sparrow's long symmetric grooves.
    VCavity,
}

/// The facets of a rough surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MicrofacetsDesc {
    /// Perceptual roughness in [0, 1]; its square is the width alpha of the distribution. 0 is a smooth surface.
    pub roughness: f32,
    /// In [0, 1): how much narrower the facets are spread across the tangent than along it; 0 for no difference.
    pub anisotropy: f32,
    /// Angle from the surface's tangent to the direction of the larger spread, radians, counter-clockwise about the normal.
    pub rotation: f32,
    /// See [`Distribution`].
    pub distribution: Distribution,
    /// See [`Masking`].
    pub masking: Masking,
    /// Whether the light that facets reflect more than once is made up for. Not possible with [`Masking::VCavity`].
    pub multiple_scattering: bool,
}

impl Default for MicrofacetsDesc {
    fn default() -> Self {
        Self {
            roughness: 0.0,
            anisotropy: 0.0,
            rotation: 0.0,
            distribution: Distribution::Ggx,
            masking: Masking::Smith,
            multiple_scattering: true,
        }
    }
}

impl MicrofacetsDesc {
    /// Facets of this perceptual roughness, with the library's defaults.
    pub fn rough(roughness: f32) -> Self {
        Self { roughness, ..Self::default() }
    }

    /// Whether the facets are so narrow that the surface counts as smooth: directions in single precision cannot tell the difference.
    pub fn are_smooth(&self) -> bool {
        self.alphas().iter().all(|alpha| *alpha < Self::SMOOTHEST)
    }

    /// The width alpha below which a surface counts as smooth.
    pub const SMOOTHEST: f32 = 1e-4;

    /// The widths alpha along the direction of the larger spread and across it.
    ///
    /// This is the only place where roughness is squared. The mean of the squared widths does not change with the anisotropy
    /// (OpenPBR Surface 1.1, "Microfacet model").
    pub fn alphas(&self) -> [f32; 2] {
        let alpha = self.roughness * self.roughness;
        let narrower = 1.0 - self.anisotropy;
        let along = alpha * (2.0 / (1.0 + narrower * narrower)).sqrt();
        [along, narrower * along]
    }

    /// Facets that lean by these and by further slopes of this variance along any direction, `round` to the nearest of some values but
    /// not narrower or more uneven than these; smooth surfaces stay smooth.
    ///
    /// The squares of the widths grow by twice the variance. This is exact for Beckmann's facets and normally distributed slopes,
    /// whose sums are such slopes again (Olano and Baker 2010, "LEAN Mapping"). GGX has slopes without a variance, and the same is
    /// an approximation.
    pub(crate) fn widened(self, variance: f32, round: impl Fn(f32) -> f32) -> Self {
        if self.are_smooth() {
            return self;
        }
        let [along, across] = self.alphas().map(|alpha| alpha * alpha + 2.0 * variance);
        let roughness = (0.5 * (along + across)).powf(0.25);
        let anisotropy = 1.0 - (across / along).sqrt();
        let roughness = round(roughness.min(1.0)).max(self.roughness);
        Self { roughness, anisotropy: round(anisotropy.max(0.0)).min(self.anisotropy), ..self }
    }
}

/// What the facets of a metal reflect.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ConductorDesc {
    /// By the complex index of refraction, per channel.
    Index {
        /// Index of refraction n, > 0.
        eta: Rgb,
        /// Extinction coefficient k, >= 0.
        k: Rgb,
    },
    /// By the colour at normal incidence and a tint of the edge, from which an index is made.
    Reflectance {
        /// Reflectance at normal incidence, in [0, 1].
        normal: Rgb,
        /// Tint of the edge, in [0, 1]: at 1 the reflectance rises steadily towards the edge, at 0 it dips before.
        edge: Rgb,
    },
}

impl ConductorDesc {
    /// The complex index (n, k) in one channel; `None` for a perfect reflector, which has none.
    ///
    /// Source: Gulbrandsen 2014, "Artist Friendly Metallic Fresnel".
    pub fn index(&self, channel: usize) -> Option<[f32; 2]> {
        match self {
            Self::Index { eta, k } => Some([eta.to_array()[channel], k.to_array()[channel]]),
            Self::Reflectance { normal, edge } => {
                let (r, g) = (f64::from(normal.to_array()[channel]), f64::from(edge.to_array()[channel]));
                if r >= 1.0 {
                    return None;
                }
                let root = r.sqrt();
                let n = g * (1.0 - r) / (1.0 + r) + (1.0 - g) * (1.0 + root) / (1.0 - root);
                let k2 = (r * (n + 1.0) * (n + 1.0) - (n - 1.0) * (n - 1.0)) / (1.0 - r);
                Some([n as f32, k2.max(0.0).sqrt() as f32])
            }
        }
    }
}

/// A metal whose index of refraction was measured.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Metal {
    /// Chemical symbol, as in files.
    pub symbol: &'static str,
    /// English name.
    pub name: &'static str,
    /// Index of refraction at 650, 550 and 450 nm.
    pub eta: [f32; 3],
    /// Extinction coefficient at these wavelengths.
    pub k: [f32; 3],
}

/// Metals by their symbols, at 650, 550 and 450 nm.
///
/// Sources: iron from Johnson and Christy 1974, "Optical Constants of Transition Metals"; all others interpolated linearly in the
/// optical constants of IMD (Windt 1998), which for most of them are those of Palik 1985, *Handbook of Optical Constants of
/// Solids*.
pub const METALS: [Metal; 12] = [
    metal("Ag", "silver", [0.1394, 0.1248, 0.1517], [4.1288, 3.3396, 2.4704]),
    metal("Al", "aluminium", [1.4748, 0.9586, 0.618], [7.7941, 6.687, 5.4694]),
    metal("Au", "gold", [0.1678, 0.3504, 1.5085], [3.1378, 2.7141, 1.8788]),
    metal("Cr", "chromium", [3.6375, 3.1158, 1.9277], [4.3644, 4.4228, 4.1675]),
    metal("Cu", "copper", [0.2166, 0.9582, 1.1658], [3.6377, 2.5771, 2.3939]),
    metal("Fe", "iron", [2.9114, 2.9497, 2.5845], [3.0893, 2.9318, 2.767]),
    metal("Hg", "mercury", [2.0734, 1.5519, 1.0607], [5.3388, 4.6518, 3.863]),
    metal("Ir", "iridium", [2.5646, 2.2292, 1.8276], [4.6715, 4.3137, 3.6628]),
    metal("Ni", "nickel", [2.014, 1.7724, 1.6288], [3.8079, 3.2526, 2.654]),
    metal("Rh", "rhodium", [2.1938, 1.9668, 1.7507], [5.7406, 5.016, 4.4523]),
    metal("TiN", "titanium nitride", [1.3928, 1.2523, 1.5], [2.8531, 2.1036, 1.3111]),
    metal("W", "tungsten", [3.6925, 3.5, 3.309], [2.937, 2.7291, 2.5258]),
];

const fn metal(symbol: &'static str, name: &'static str, eta: [f32; 3], k: [f32; 3]) -> Metal {
    Metal { symbol, name, eta, k }
}

impl Metal {
    /// The metal with this symbol.
    pub fn by_symbol(symbol: &str) -> Option<&'static Self> {
        METALS.iter().find(|metal| metal.symbol == symbol)
    }

    /// What its facets reflect.
    pub fn conductor(&self) -> ConductorDesc {
        ConductorDesc::Index { eta: Rgb::from_array(self.eta), k: Rgb::from_array(self.k) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn slopes_widen_facets_by_twice_their_variance() {
        for (roughness, anisotropy, variance) in [(0.5, 0.0, 0.01), (0.3, 0.8, 0.002), (0.9, 0.5, 0.0), (0.1, 0.2, 0.4)]
        {
            let before = MicrofacetsDesc { anisotropy, ..MicrofacetsDesc::rough(roughness) };
            let widened = before.widened(variance, |x| x).alphas();
            for (after, before) in widened.into_iter().zip(before.alphas()) {
                let expected = (before * before + 2.0 * variance).sqrt();
                assert!((after - expected).abs() < 1e-5, "{after}, not {expected}");
            }
        }
        assert_eq!(MicrofacetsDesc::rough(0.0).widened(0.1, |x| x), MicrofacetsDesc::rough(0.0));
        assert_eq!(MicrofacetsDesc::rough(0.9).widened(5.0, |x| x).roughness, 1.0);
        let quarters = |x: f32| (4.0 * x).round() / 4.0;
        assert_eq!(MicrofacetsDesc::rough(0.5).widened(0.02, quarters).roughness, 0.5);
        assert_eq!(MicrofacetsDesc::rough(0.6).widened(1e-6, quarters).roughness, 0.6);
    }

    #[test]
    fn roughness_is_squared_once() {
        assert_eq!(MicrofacetsDesc::rough(0.5).alphas(), [0.25, 0.25]);
        let [along, across] = MicrofacetsDesc { anisotropy: 0.75, ..MicrofacetsDesc::rough(0.5) }.alphas();
        assert!((across / along - 0.25).abs() < 1e-6);
        assert!((along * along + across * across - 2.0 * 0.0625).abs() < 1e-6);
    }

    #[test]
    fn an_index_made_from_colours_reflects_them() {
        for (r, g) in [(0.0, 0.3), (0.2, 0.0), (0.5, 0.5), (0.9, 1.0), (0.999, 0.2)] {
            let conductor = ConductorDesc::Reflectance { normal: Rgb::splat(r), edge: Rgb::splat(g) };
            let [n, k] = conductor.index(0).unwrap().map(f64::from);
            let found = ((n - 1.0).powi(2) + k * k) / ((n + 1.0).powi(2) + k * k);
            assert!((found - f64::from(r)).abs() < 1e-6, "{r} {g}: {found}");
        }
        assert_eq!(ConductorDesc::Reflectance { normal: Rgb::ONE, edge: Rgb::ONE }.index(1), None);
    }
}
