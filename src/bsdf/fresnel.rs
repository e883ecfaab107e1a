//! Fresnel's and Snell's laws for smooth interfaces: between two dielectrics, and of a metal.

use crate::math::Vec3;

/// g^2 = eta^2 - 1 + cos^2(theta_i), where g = eta cos(theta_t); negative under total internal reflection.
///
/// Formed from the cosine, which is exact at grazing incidence, and from a product that does not cancel near eta = 1.
#[inline]
fn refraction_radicand(cos_theta_i: f64, eta: f64) -> f64 {
    (eta - 1.0) * (eta + 1.0) + cos_theta_i * cos_theta_i
}

/// Share of unpolarised light that a smooth dielectric interface reflects, in [0, 1], never NaN.
///
/// `cos_theta_i`: cosine of the angle of incidence, in [0, 1] (its sign does not matter). `eta`: index of refraction
/// behind the interface over that in front of it, > 0. Exactly 1 under total internal reflection and exactly 0 for
/// eta = 1.
///
/// With c = cos(theta_i) and g = eta cos(theta_t) the amplitudes are
/// r_s = (1 - eta^2) / (c + g)^2 and r_p = (eta^2 - 1) ((eta^2 + 1) c^2 - 1) / (eta^2 c + g)^2: the textbook forms with
/// their differences of nearly equal terms multiplied out, so that small reflectances (eta near 1) keep their digits too.
///
/// Source: Born and Wolf, *Principles of Optics*, Sec. 1.5.2.
#[inline]
pub fn fresnel_dielectric(cos_theta_i: f64, eta: f64) -> f64 {
    let [r_s2, r_p2] = fresnel_polarised(cos_theta_i, eta);
    (0.5 * (r_s2 + r_p2)).min(1.0)
}

/// [`fresnel_dielectric`] for light that is polarised across the plane of incidence (s), and in it (p).
#[inline]
pub fn fresnel_polarised(cos_theta_i: f64, eta: f64) -> [f64; 2] {
    if eta == 1.0 {
        return [0.0; 2];
    }
    let c = cos_theta_i.abs().min(1.0);
    let radicand = refraction_radicand(c, eta);
    if radicand.is_nan() || radicand <= 0.0 {
        return [1.0; 2];
    }
    let g = radicand.sqrt();
    let eta2 = eta * eta;
    let difference = (eta - 1.0) * (eta + 1.0);
    let r_s = difference / ((c + g) * (c + g));
    let r_p = difference * ((eta2 + 1.0) * c * c - 1.0) / ((eta2 * c + g) * (eta2 * c + g));
    [r_s * r_s, r_p * r_p]
}

/// Share of unpolarised light that a smooth metal reflects, in [0, 1]. `n` and `k`: its complex index of refraction over the
/// index of what is in front of it; 1 for an infinite `k`, which stands for a perfect reflector.
///
/// Source: Born and Wolf, *Principles of Optics*, Sec. 14.2.
#[inline]
pub fn fresnel_conductor(cos_theta_i: f32, n: f32, k: f32) -> f32 {
    fresnel_conductors(cos_theta_i, Vec3::splat(n), Vec3::splat(k)).x
}

/// [`fresnel_conductor`] for three metals at once, or for three channels of one.
#[inline]
pub fn fresnel_conductors(cos_theta_i: f32, n: Vec3, k: Vec3) -> Vec3 {
    let cos = cos_theta_i.abs().min(1.0);
    let cos2 = cos * cos;
    let sin2 = 1.0 - cos2;
    let (n2, k2) = (n * n, k * k);
    let difference = n2 - k2 - Vec3::splat(sin2);
    let product = 4.0 * n2 * k2;
    let sum = (difference * difference + product).sqrt();
    // a^2 = (sum + difference) / 2, of which metals would cancel all digits: with b^2 = (sum - difference) / 2, (a b)^2 is product / 4.
    let larger = 0.5 * (sum + difference.abs());
    let a2 = Vec3::select(difference.cmplt(Vec3::ZERO), 0.25 * product / larger, larger);
    let t2 = 2.0 * cos * a2.sqrt();
    let (t1, t3, t4) = (sum + Vec3::splat(cos2), cos2 * sum + Vec3::splat(sin2 * sin2), t2 * sin2);
    let r_s = (t1 - t2) / (t1 + t2);
    let r_p = r_s * ((t3 - t4) / (t3 + t4));
    let reflectance = (0.5 * (r_s + r_p)).max(Vec3::ZERO).min(Vec3::ONE);
    Vec3::select(k.cmplt(Vec3::INFINITY), reflectance, Vec3::ONE)
}

/// Cosine of the angle of refraction by Snell's law, or `None` under total internal reflection. Arguments as in
/// [`fresnel_dielectric`].
#[inline]
pub fn refracted_cosine(cos_theta_i: f64, eta: f64) -> Option<f64> {
    let radicand = refraction_radicand(cos_theta_i, eta);
    (radicand > 0.0).then(|| (radicand.sqrt() / eta).min(1.0))
}
