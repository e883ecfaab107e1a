//! Albedos of surfaces under even light from all sides.

use crate::bsdf::{Bsdf, Model as _};
use crate::math::DVec3;

/// The fraction of the irradiance that the diffuse lobes of a surface reflect where the incident radiance is uniform, on
/// its outer and on its inner side; 0 for mirrors and glass.
pub(super) fn mean_albedos(bsdf: &Bsdf) -> [DVec3; 2] {
    mean_albedos_by(bsdf, 4096)
}

/// [`mean_albedos`], where the surface is not Lambertian by so many angles.
pub(super) fn mean_albedos_by(bsdf: &Bsdf, steps: u32) -> [DVec3; 2] {
    [(true, 1.0), (false, -1.0)].map(|(is_front, z)| mean_albedo(&bsdf.on_side(is_front), z, steps))
}

/// One of [`mean_albedos`], on the side where directions have a third component of this sign.
fn mean_albedo(bsdf: &Bsdf, side: f64, steps: u32) -> DVec3 {
    if !bsdf.lit_lobes().have_diffuse() {
        return DVec3::ZERO;
    }
    if bsdf.constant_f().is_some() {
        return bsdf.diffuse_albedo().to_f64();
    }
    // Cosine-weighted mean of the directional albedo, by the midpoint rule in the squared cosine.
    let at = |i: u32| {
        let cos2 = (f64::from(i) + 0.5) / f64::from(steps);
        let wo = DVec3::new((1.0 - cos2).sqrt(), 0.0, side * cos2.sqrt()).as_vec3a();
        bsdf.mean_f(wo).map_or(DVec3::ZERO, |f| f.to_f64() * std::f64::consts::PI)
    };
    (0..steps).map(at).sum::<DVec3>() / f64::from(steps)
}
