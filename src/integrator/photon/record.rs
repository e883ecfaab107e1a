//! The stored form of a photon.

use crate::math::Vec3;
use crate::spectrum::{Rgb, Spectrum};

/// A direction in 32 bits: the octahedron's faces folded into a square, with 16 bits for each axis. The error is at most
/// 5e-5 radians.
///
/// Source: Cigolle et al. 2014, "A Survey of Efficient Representations for Independent Unit Vectors".
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Octahedral(u32);

impl Octahedral {
    /// Packs a unit vector.
    #[inline]
    pub fn new(direction: Vec3) -> Self {
        let sum = direction.abs().element_sum();
        let (mut x, mut y) = (direction.x / sum, direction.y / sum);
        if direction.z < 0.0 {
            (x, y) = ((1.0 - y.abs()).copysign(x), (1.0 - x.abs()).copysign(y));
        }
        // Values are rounded to the nearest of 65535 steps, so that 0 is exact.
        let pack = |v: f32| (v.clamp(-1.0, 1.0) * 32767.0).round() as i32 as u32 & 0xffff;
        Self(pack(x) << 16 | pack(y))
    }

    /// The unit vector.
    #[inline]
    pub fn get(self) -> Vec3 {
        let unpack = |bits: u32| f32::from(bits as u16 as i16) * (1.0 / 32767.0);
        let (x, y) = (unpack(self.0 >> 16), unpack(self.0));
        let z = 1.0 - x.abs() - y.abs();
        let fold = (-z).max(0.0);
        Vec3::new(x - fold.copysign(x), y - fold.copysign(y), z).normalize()
    }
}

/// Light that arrived at a surface: 32 bytes for three channels.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Photon<C: Spectrum = Rgb> {
    /// Position, scene frame.
    pub p: [f32; 3],
    /// Geometric normal on the side from which the light arrived.
    pub normal: Octahedral,
    /// The photon's share of the light's power (W); 0 for a shadow photon, which marks where a surface occludes the light.
    pub power: C::Packed,
    /// Direction from which the light arrived.
    pub wi: Octahedral,
}

impl<C: Spectrum> Photon<C> {
    /// Creates a photon of this power that arrived at `p` along `-wi`, on the side of the unit normal `normal`.
    #[inline]
    pub fn new(p: Vec3, normal: Vec3, wi: Vec3, power: C) -> Self {
        Self::of_path(p, normal, wi, power, C::Alone::default())
    }

    /// As [`Self::new`], for a light path that may have its first wavelength alone.
    #[inline]
    pub(super) fn of_path(p: Vec3, normal: Vec3, wi: Vec3, power: C, alone: C::Alone) -> Self {
        Self { p: p.to_array(), normal: Octahedral::new(normal), power: power.pack(alone), wi: Octahedral::new(wi) }
    }

    /// The photon's position.
    #[inline]
    pub fn position(&self) -> Vec3 {
        Vec3::from_array(self.p)
    }

    /// The photon's power (W).
    #[inline]
    pub fn power(&self) -> C {
        C::unpack(self.power, C::Alone::default())
    }

    /// The photon's power (W) as a factor on the weight of a path that asks for it. Where both have their first wavelength alone, it
    /// stands for all wavelengths once.
    #[inline]
    pub(super) fn power_for(&self, alone: C::Alone) -> C {
        C::unpack(self.power, alone)
    }

    /// With this factor on its power.
    pub(super) fn scale(&mut self, factor: f64) {
        self.power = C::scale_packed(self.power, factor);
    }

    /// Whether the photon is a shadow photon.
    #[inline]
    pub fn is_shadow(&self) -> bool {
        self.power() == C::ZERO
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sampling::{Rng, warps};

    #[test]
    fn directions_survive_packing() {
        let mut rng = Rng::new(1, 1);
        for _ in 0..100_000 {
            let direction = warps::uniform_sphere(rng.next_2d());
            assert!(Octahedral::new(direction).get().distance(direction) < 1e-4, "{direction}");
        }
        for axis in [Vec3::X, Vec3::Y, Vec3::Z, -Vec3::X, -Vec3::Y, -Vec3::Z] {
            assert_eq!(Octahedral::new(axis).get(), axis);
        }
    }
}
