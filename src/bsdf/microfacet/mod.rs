//! Surfaces of facets: how the facets of a rough surface are distributed, and which share of them is seen.
//!
//! A rough surface is a field of facets, each a perfect mirror or a smooth interface. [`Microfacets`] is the statistics of
//! their normals; the models of metals, dielectrics and coats differ in what a facet does.
//!
//! The width parameter `alpha` is that of the distributions in Walter et al. 2007. Descriptions give a perceptual roughness
//! instead, alpha = roughness^2 ([`MicrofacetsDesc::alphas`]); it is squared there and nowhere else.

mod albedo;
mod beckmann;
mod missing;

pub(super) use albedo::{AlbedoCurve, FacetShares, average, average_of};
pub(super) use missing::MissingEnergy;

use std::f32::consts::{PI, TAU};

use crate::desc::{Distribution, Masking, MicrofacetsDesc};
use crate::math::Vec3;

/// The statistics of a rough surface's facets. Directions are in the local frame of the Bsdf, on the outer side (z > 0), and
/// `m` is the normal of a facet.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Microfacets {
    distribution: Distribution,
    masking: Masking,
    /// Width along the facets' own x and y axis, >= [`MicrofacetsDesc::SMOOTHEST`].
    alpha: [f32; 2],
    /// Cosine and sine of the angle by which the facets' x axis is turned from the local one, counter-clockwise.
    turn: [f32; 2],
}

impl Microfacets {
    /// The facets of a checked description; `None` where it is so smooth that it has none.
    pub fn new(desc: &MicrofacetsDesc) -> Option<Self> {
        if desc.are_smooth() {
            return None;
        }
        let alpha = desc.alphas();
        let (sin, cos) = if alpha[0] == alpha[1] { (0.0, 1.0) } else { desc.rotation.sin_cos() };
        let (distribution, masking) = (desc.distribution, desc.masking);
        Some(Self {
            distribution,
            masking,
            alpha: alpha.map(|alpha| alpha.max(MicrofacetsDesc::SMOOTHEST)),
            turn: [cos, sin],
        })
    }

    /// Appends the parameters.
    pub fn put_shape(&self, key: &mut Vec<u64>) {
        let pair = |[a, b]: [f32; 2]| u64::from(a.to_bits()) << 32 | u64::from(b.to_bits());
        key.extend([self.distribution as u64 | (self.masking as u64) << 8, pair(self.alpha), pair(self.turn)]);
    }

    /// The larger and the smaller width.
    pub fn widths(&self) -> [f32; 2] {
        [self.alpha[0].max(self.alpha[1]), self.alpha[0].min(self.alpha[1])]
    }

    /// Whether the surface looks different when it is turned about its normal.
    pub fn is_anisotropic(&self) -> bool {
        self.alpha[0] != self.alpha[1]
    }

    /// The same facets, turned counter-clockwise by the angle with this cosine and sine.
    #[must_use]
    pub fn turned(&self, [cos, sin]: [f32; 2]) -> Self {
        let [c, s] = self.turn;
        Self { turn: [cos * c - sin * s, sin * c + cos * s], ..*self }
    }

    #[inline]
    fn in_facets(&self, w: Vec3) -> Vec3 {
        let [cos, sin] = self.turn;
        Vec3::new(cos * w.x + sin * w.y, cos * w.y - sin * w.x, w.z)
    }

    #[inline]
    fn out_of_facets(&self, w: Vec3) -> Vec3 {
        let [cos, sin] = self.turn;
        Vec3::new(cos * w.x - sin * w.y, cos * w.y + sin * w.x, w.z)
    }

    /// Squared tangential part of a direction, stretched by the widths, over the squared cosine: alpha^2 tan^2.
    #[inline]
    fn stretched_slope2(&self, w: Vec3) -> f32 {
        let [x, y, z] = self.in_facets(w).to_array();
        let [ax, ay] = self.alpha;
        let (x, y) = (ax * x / z, ay * y / z);
        x * x + y * y
    }

    /// Density of facets by solid angle, per area of the surface: D(m) (sr^-1), for m.z > 0.
    ///
    /// In terms of slopes, which do not cancel near the normal for any width. Walter et al. 2007, Eq. 25 and 33.
    #[inline]
    pub fn d(&self, m: Vec3) -> f32 {
        let [x, y, z] = self.in_facets(m).to_array();
        let [ax, ay] = self.alpha;
        let (x, y) = (x / ax, y / ay);
        match self.distribution {
            Distribution::Ggx => {
                let t = x * x + y * y + z * z;
                1.0 / (PI * ax * ay * t * t)
            }
            Distribution::Beckmann => {
                let z2 = z * z;
                let slope2 = (x * x + y * y) / z2;
                if slope2 > 80.0 { 0.0 } else { (-slope2).exp() / (PI * ax * ay * z2 * z2) }
            }
        }
    }

    /// Smith's function Lambda of a direction: the facets that are hidden for each that is seen. Heitz 2014, Eq. 68 and 72.
    #[inline]
    fn lambda(&self, w: Vec3) -> f32 {
        let slope2 = self.stretched_slope2(w);
        match self.distribution {
            Distribution::Ggx => 0.5 * slope2 / ((1.0 + slope2).sqrt() + 1.0),
            Distribution::Beckmann => beckmann::lambda(slope2),
        }
    }

    /// The share of the facets with normal `m` that is seen from `w`, which faces them.
    #[inline]
    fn g1(&self, w: Vec3, m: Vec3) -> f32 {
        match self.masking {
            Masking::Smith | Masking::SmithSeparable => 1.0 / (1.0 + self.lambda(w)),
            Masking::VCavity => (2.0 * m.z * w.z / w.dot(m)).abs().min(1.0),
        }
    }

    /// The share of the facets with normal `m` that is seen from `wo`, and the share that is seen from both directions, which are on
    /// one side of the surface.
    ///
    /// Smith's masking is correlated by height, Heitz 2014, Eq. 99, or taken as independent. Torrance and Sparrow's grooves
    /// hide the larger of both shadows.
    #[inline]
    pub fn reflection_masking(&self, wo: Vec3, wi: Vec3, m: Vec3) -> (f32, f32) {
        if self.masking == Masking::VCavity {
            let g1 = self.g1(wo, m);
            return (g1, g1.min(self.g1(wi, m)));
        }
        let [o, i] = [wo, wi].map(|w| self.lambda(w));
        let g2 = match self.masking {
            Masking::SmithSeparable => 1.0 / ((1.0 + o) * (1.0 + i)),
            _ => 1.0 / (1.0 + o + i),
        };
        (1.0 / (1.0 + o), g2)
    }

    /// As [`Self::reflection_masking`], for directions on two sides of the surface; `wi` is given mirrored to the outer side.
    ///
    /// Of facets at one height, those that are rarely hidden from above are often hidden from below: the mean over heights is
    /// the beta function B(1 + Lambda_o, 1 + Lambda_i).
    #[inline]
    pub fn transmission_masking(&self, wo: Vec3, wi: Vec3, m: Vec3) -> (f32, f32) {
        if self.masking == Masking::VCavity {
            // The groove of wi is that of the other side, whose facets are the same seen from behind.
            let g1 = self.g1(wo, m);
            return (g1, g1.min(self.g1(wi, Vec3::new(-m.x, -m.y, m.z))));
        }
        let [o, i] = [wo, wi].map(|w| self.lambda(w));
        let g2 = match self.masking {
            Masking::SmithSeparable => 1.0 / ((1.0 + o) * (1.0 + i)),
            _ => beta(1.0 + o, 1.0 + i),
        };
        (1.0 / (1.0 + o), g2)
    }

    /// Density of the normals that [`Self::visible_normal`] draws: D(m) G1 cos(wo, m) / cos(wo) (sr^-1).
    #[inline]
    pub fn visible_pdf(&self, wo: Vec3, m: Vec3) -> f32 {
        self.g1(wo, m) * self.d(m) * wo.dot(m).max(0.0) / wo.z
    }

    /// Draws the normal of a facet that is seen from `wo`, with `u` uniform in [0, 1)^3; the third number
    /// is replaced by another one where it was used.
    ///
    /// Source: Dupuy and Benyoub 2023, "Sampling Visible GGX Normals with Spherical Caps"; Heitz and d'Eon 2014, "Importance
    /// Sampling Microfacet-Based BSDFs using the Distribution of Visible Normals", for Beckmann's facets and for grooves.
    #[inline]
    pub fn visible_normal(&self, wo: Vec3, u: &mut [f32; 3]) -> Vec3 {
        let wo = self.in_facets(wo);
        let m = match (self.masking, self.distribution) {
            (Masking::VCavity, distribution) => grooved_normal(distribution, self.alpha, wo, u),
            (_, Distribution::Ggx) => {
                let standard = self.stretched(wo);
                let z = (1.0 - u[1]) * (1.0 + standard.z) - standard.z;
                self.unstretched(cap(z, u[0]) + standard)
            }
            (_, Distribution::Beckmann) => beckmann::visible_normal(self.alpha, wo, [u[0], u[1]]),
        };
        self.out_of_facets(m)
    }

    /// Draws the normal of a facet for a reflection of `wo`. Reflections below the horizon are rarer than with
    /// [`Self::visible_normal`]. Reflected directions have the density that
    /// [`Self::reflection`] returns.
    ///
    /// Source: Eto and Tokuyoshi 2023, "Bounded VNDF Sampling for Smith-GGX Reflections".
    #[inline]
    pub fn reflecting_normal(&self, wo: Vec3, u: &mut [f32; 3]) -> Vec3 {
        if self.masking == Masking::VCavity || self.distribution != Distribution::Ggx {
            return self.visible_normal(wo, u);
        }
        let wo = self.in_facets(wo);
        let standard = self.stretched(wo);
        let bound = self.bound(wo) * standard.z;
        let z = (1.0 - u[1]) * (1.0 + bound) - bound;
        self.out_of_facets(self.unstretched(cap(z, u[0]) + standard))
    }

    /// f cos(wi) of facets that reflect everything (sr^-1), D G2 / (4 cos(wo)), and the density of the direction `wi` in which a facet
    /// drawn by [`Self::reflecting_normal`] reflects `wo` (sr^-1). `m` is the normal between the two.
    #[inline]
    pub fn reflection(&self, wo: Vec3, wi: Vec3, m: Vec3) -> (f32, f32) {
        let d = self.d(m);
        if self.masking == Masking::VCavity || self.distribution != Distribution::Ggx {
            let (g1, g2) = self.reflection_masking(wo, wi, m);
            let once = d / (4.0 * wo.z);
            return (once * g2, once * g1);
        }
        // With the lengths of the stretched directions, 1 + 2 Lambda is a length over a cosine, and the cosines cancel.
        let own = self.in_facets(wo);
        let (o, i) = (self.stretched_length(own), self.stretched_length(self.in_facets(wi)));
        let seen = match self.masking {
            Masking::SmithSeparable => (o + wo.z) * (i + wi.z),
            _ => 2.0 * (o * wi.z + i * wo.z),
        };
        (d * wi.z / seen, d / (2.0 * (self.bound(own) * wo.z + o)))
    }

    /// Length of a direction in the facets' frame, stretched to the frame in which they are those of a hemisphere.
    #[inline]
    fn stretched_length(&self, w: Vec3) -> f32 {
        let (x, y) = (self.alpha[0] * w.x, self.alpha[1] * w.y);
        (x * x + y * y + w.z * w.z).sqrt()
    }

    /// The factor by which the cap of normals that reflect above the horizon is lower. `wo` is in the facets' frame.
    #[inline]
    fn bound(&self, wo: Vec3) -> f32 {
        let a = self.alpha[0].min(self.alpha[1]).min(1.0);
        let s = 1.0 + (wo.x * wo.x + wo.y * wo.y).sqrt();
        let (a2, s2) = (a * a, s * s);
        (1.0 - a2) * s2 / (s2 + a2 * wo.z * wo.z)
    }

    /// The direction in the frame in which the facets are those of a hemisphere.
    #[inline]
    fn stretched(&self, w: Vec3) -> Vec3 {
        Vec3::new(self.alpha[0] * w.x, self.alpha[1] * w.y, w.z).normalize()
    }

    #[inline]
    fn unstretched(&self, m: Vec3) -> Vec3 {
        // Seen from exactly the side, the lowest point of the cap lies in the surface.
        Vec3::new(self.alpha[0] * m.x, self.alpha[1] * m.y, m.z.max(1e-7)).normalize()
    }
}

/// The point of the unit sphere at this height and share of a turn.
#[inline]
fn cap(z: f32, u: f32) -> Vec3 {
    let sin = (1.0 - z * z).max(0.0).sqrt();
    let (s, c) = (TAU * u).sin_cos();
    Vec3::new(sin * c, sin * s, z)
}

/// Draws a facet of a symmetric groove: a groove by D(m) cos, then one of its two facets, by how much of each is seen.
///
/// Source: Heitz and d'Eon 2014, Algorithm 1.
#[inline]
fn grooved_normal(distribution: Distribution, [ax, ay]: [f32; 2], wo: Vec3, u: &mut [f32; 3]) -> Vec3 {
    let slope = match distribution {
        Distribution::Ggx => (u[1] / (1.0 - u[1])).sqrt(),
        Distribution::Beckmann => (-(-u[1]).ln_1p()).sqrt(),
    };
    let (s, c) = (TAU * u[0]).sin_cos();
    let m = Vec3::new(slope * ax * c, slope * ay * s, 1.0).normalize();
    let opposite = Vec3::new(-m.x, -m.y, m.z);
    let (seen, other) = (wo.dot(m).max(0.0), wo.dot(opposite).max(0.0));
    if choose(seen / (seen + other), &mut u[2]) { m } else { opposite }
}

/// Chooses with this probability, and leaves another number uniform in [0, 1) in `u`.
#[inline]
pub(super) fn choose(probability: f32, u: &mut f32) -> bool {
    let chosen = *u < probability;
    let rest = if chosen { *u / probability } else { (*u - probability) / (1.0 - probability) };
    *u = rest.clamp(0.0, 1.0_f32.next_down());
    chosen
}

/// Euler's beta function for x, y >= 1, to a part in 10^6 of it and of the exponent.
#[inline]
fn beta(x: f32, y: f32) -> f32 {
    // Stirling's series at x + 1 and y + 1.
    let shift = (x + y) * (x + y + 1.0) / (x * y);
    let (large, small) = (x.max(y) + 1.0, x.min(y) + 1.0);
    let s = large + small;
    let series = |x: f32| {
        let r = 1.0 / x;
        r * (1.0 / 12.0 - r * r * (1.0 / 360.0 - r * r * (1.0 / 1260.0)))
    };
    // The logarithm that has a large factor is that of a number near 1.
    let share = small / s;
    let power = (large - 0.5) * (-share).ln_1p() + (small - 0.5) * share.ln() - 0.5 * s.ln();
    const ROOT: f32 = 2.506_628_3;
    shift * ROOT * (power + series(large) + series(small) - series(s)).exp()
}
