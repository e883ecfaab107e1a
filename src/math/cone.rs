//! Ray cones: how wide a path's view is where it meets a surface.
//!
//! Source: Akenine-Möller, Crassin, Boksansky, Belcour, Panteleev, Wright 2021, "Improved Shader and Texture Level of Detail
//! Using Ray Cones".

/// A cone around a ray, through which a pixel sees: its diameter at the ray's origin, and the growth of its diameter with
/// distance. Both are stored with 8 significant bits, which are plenty for the choice of a filter's width; a ray carries the
/// cone in bytes that were padding. The default is no cone at all, of diameter 0 everywhere.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct RayCone(
    /// The upper halves of two numbers: the width in the upper 16 bits, the spread in the lower ones.
    u32,
);

/// The upper half of a number's bits, rounded to the nearest; NaN becomes 0.
#[inline]
fn pack(x: f32) -> u32 {
    if x == 0.0 || x.is_nan() { 0 } else { (x.clamp(-f32::MAX / 2.0, f32::MAX / 2.0).to_bits() + (1 << 15)) >> 16 }
}

impl RayCone {
    /// A cone with this diameter >= 0 at the ray's origin, which grows by `spread` for each unit of length (twice the tangent of
    /// half the cone's angle). A negative spread is that of a cone that narrows to a focus, and widens behind it.
    #[inline]
    pub fn new(width: f32, spread: f32) -> Self {
        Self(pack(width.max(0.0)) << 16 | pack(spread))
    }

    /// The diameter at the ray's origin.
    #[inline]
    pub fn width(self) -> f32 {
        f32::from_bits(self.0 & 0xffff_0000)
    }

    /// The growth of the diameter for each unit of length.
    #[inline]
    pub fn spread(self) -> f32 {
        f32::from_bits(self.0 << 16)
    }

    /// Whether there is no cone.
    #[inline]
    pub fn is_none(self) -> bool {
        self == Self::default()
    }

    /// The cone that begins at this distance along the ray.
    #[inline]
    #[must_use]
    pub fn after(self, distance: f32) -> Self {
        let (width, spread) = (self.width() + self.spread() * distance, self.spread());
        // Behind a focus it widens.
        if width < 0.0 { Self::new(-width, -spread) } else { Self::new(width, spread) }
    }

    /// The cone after scattering by a lobe of this width parameter alpha, in [0, 1]: it widens or narrows no less than the lobe. Slopes
    /// of the facets are about `alpha`, so directions lie within about 2 `alpha` of the middle; half of that is taken on either side.
    #[inline]
    #[must_use]
    pub fn scattered(self, alpha: f32) -> Self {
        if self.spread().abs() < 2.0 * alpha { Self::new(self.width(), 2.0 * alpha) } else { self }
    }

    /// The cone after reflection by a surface of this mean curvature, positive where it bends away from the side on which the ray is:
    /// from one edge of the cone to the other the surface turns by curvature times width, and the reflection by twice that. Seen at
    /// an angle, a ball reflects wider cones in the plane of incidence and narrower ones across it; their mean stays.
    #[must_use]
    pub fn reflected(self, curvature: f32) -> Self {
        Self::new(self.width(), self.spread() + 2.0 * curvature * self.width())
    }

    /// The cone after refraction into a medium of this index over that of the medium around, by Snell's law for small angles.
    #[must_use]
    pub fn refracted(self, curvature: f32, eta: f32) -> Self {
        let turn = curvature * self.width();
        Self::new(self.width(), (self.spread() + turn) / eta - turn)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn diameters_are_kept_to_eight_bits() {
        for (width, spread) in [(0.0, 1e-3), (3.7, 0.0), (1e-20, 1e20), (1e30, 12.0)] {
            let cone = RayCone::new(width, spread);
            for (kept, given) in [(cone.width(), width), (cone.spread(), spread)] {
                assert!((kept - given).abs() <= given / 256.0, "{kept}, {given}");
            }
            let grown = cone.after(2.0).width();
            assert!((grown / (width + 2.0 * spread) - 1.0).abs() < 0.01, "{grown}");
        }
        assert!(RayCone::new(0.0, 0.0).is_none() && RayCone::new(-1.0, f32::NAN).is_none());
        assert!(RayCone::new(1.0, f32::NEG_INFINITY).spread().is_finite() && RayCone::new(0.0, -0.0).is_none());
        assert!(RayCone::new(f32::INFINITY, f32::MAX).width().is_finite());
    }

    /// A mirror of radius 2 has its focus at half of that; a ball of glass has its own behind it, by the formula of the thick lens.
    #[test]
    fn curved_surfaces_turn_cones() {
        let parallel = RayCone::new(1.0, 0.0);
        let hollow = parallel.reflected(-0.5);
        assert!(hollow.after(1.0).width() < 0.02 && (hollow.after(2.0).width() - 1.0).abs() < 0.02);
        assert!((parallel.reflected(0.5).after(2.0).width() - 3.0).abs() < 0.02);
        let (radius, eta) = (1.5_f32, 1.5_f32);
        let inside = parallel.refracted(1.0 / radius, eta).after(2.0 * radius);
        let behind = inside.refracted(-1.0 / radius, 1.0 / eta);
        let focus = eta * 2.0 * radius / (4.0 * (eta - 1.0)) - radius;
        assert!((behind.width() + behind.spread() * focus).abs() < 0.02, "{behind:?}");
        // A plate turns rays back to where they came from.
        let plate = RayCone::new(1.0, 0.25).refracted(0.0, 1.5).refracted(0.0, 1.0 / 1.5);
        assert!((plate.spread() - 0.25).abs() < 0.01);
    }

    #[test]
    fn lobes_widen_cones() {
        let cone = RayCone::new(1.0, 0.01);
        assert_eq!(cone.scattered(0.0), cone);
        assert_eq!(cone.scattered(0.25), RayCone::new(1.0, 0.5));
        assert_eq!(cone.scattered(1.0), RayCone::new(1.0, 2.0));
        assert_eq!(RayCone::new(1.0, -0.5).scattered(0.1), RayCone::new(1.0, -0.5));
    }
}
