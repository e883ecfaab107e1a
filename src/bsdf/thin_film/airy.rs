//! The reflectance of one film by Airy's sum.

use std::f64::consts::TAU;

use super::complex::Complex;

/// A film as light of one wavelength meets it, in terms of the medium that the light comes from.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stack {
    /// Index of refraction of the film over that in front of it, > 0.
    film: f64,
    /// Complex index n + ik of what is behind the film over the index in front of it.
    behind: Complex,
    /// 2 pi times the thickness over the wavelength in front of the film.
    phase: f64,
}

impl Stack {
    /// A film of this index and thickness \[nm\] between a medium of the index `front` and what is behind it, for light of this
    /// wavelength in vacuum \[nm\].
    pub fn new(front: f64, [film, thickness]: [f64; 2], behind: Complex, nanometres: f64) -> Self {
        let phase = TAU * front * thickness / nanometres;
        Self { film: film / front, behind: behind * (1.0 / front), phase }
    }

    /// Share of unpolarised light that is reflected, in [0, 1], never NaN; 1 at grazing incidence and under total reflection.
    /// `cos`: cosine of the angle of incidence, whose sign does not matter.
    ///
    /// Airy's sum r = (r01 + r12 E) / (1 + r01 r12 E) with E = exp(2 i beta), where the amplitudes r01 and r12 of the film's two faces
    /// are quotients (p - p') / (p + p'). Multiplied out and divided by what numerator and denominator have in common, it is
    ///
    /// r = ((p0 - p2) (1 + E) + (p0 p2 m - q^2 / m) F) / ((p0 + p2) (1 + E) + (p0 p2 m + q^2 / m) F),  F = (1 - E) / q,
    ///
    /// where q = n cos(theta) in the film, p is n cos(theta) of the other two media for light that is polarised across the plane of
    /// incidence, and that over n^2 for the other polarisation, with m = 1 and m = n^2 of the film. The form stays finite at the
    /// critical angle of the film (q = 0, where r01 = 1, r12 = -1 and E = 1), and for evanescent waves in the film (q imaginary), in
    /// which E decays.
    ///
    /// Source: Born and Wolf, *Principles of Optics*, Sec. 1.6.4 (Eq. 55 to 58) and 14.4.1.
    pub fn reflectance(&self, cos: f64) -> f64 {
        let c = cos.abs().min(1.0);
        let behind = self.behind;
        if c == 0.0 || behind.re.is_infinite() || behind.im.is_infinite() {
            return 1.0;
        }
        // (n - 1) (n + 1) + c^2 is exact at grazing incidence, and does not cancel for indices near 1.
        let unit = Complex::real(1.0);
        let q2_squared = (behind - unit) * (behind + unit) + Complex::real(c * c);
        if behind.im == 0.0 && q2_squared.re <= 0.0 {
            return 1.0;
        }
        let q2 = q2_squared.upper_root();
        let squared = (self.film - 1.0) * (self.film + 1.0) + c * c;
        // E and F.
        let (echo, rest) = if squared > 0.0 {
            let q = squared.sqrt();
            // E = exp(2 i beta) by the sine and cosine of beta.
            let (sin, cos) = (self.phase * q).sin_cos();
            let (real, imaginary) = (2.0 * sin * sin, 2.0 * sin * cos);
            (Complex::new(1.0 - real, imaginary), Complex::new(real / q, -imaginary / q))
        } else if squared < 0.0 {
            let q = (-squared).sqrt();
            let decay = -2.0 * self.phase * q;
            (Complex::real(decay.exp()), Complex::new(0.0, decay.exp_m1() / q))
        } else {
            (unit, Complex::new(0.0, -2.0 * self.phase))
        };
        let sum = unit + echo;
        let polarised = |p2: Complex, m: f64| {
            let p0 = Complex::real(c);
            let (product, own) = (p2 * (c * m), Complex::real(squared / m));
            let numerator = (p0 - p2) * sum + (product - own) * rest;
            let denominator = (p0 + p2) * sum + (product + own) * rest;
            numerator.norm2() / denominator.norm2()
        };
        let reflectance = 0.5 * (polarised(q2, 1.0) + polarised(q2 / (behind * behind), self.film * self.film));
        // Numbers beyond double precision are those of media that no light enters.
        if reflectance.is_nan() { 1.0 } else { reflectance.min(1.0) }
    }

    /// What of the reflectance does not depend on the thickness; `None` where everything is reflected.
    pub fn fringes(&self, cos: f64) -> Option<Fringes> {
        let c = cos.abs().min(1.0);
        let behind = self.behind;
        let unit = Complex::real(1.0);
        let q2_squared = (behind - unit) * (behind + unit) + Complex::real(c * c);
        let is_closed = behind.im == 0.0 && q2_squared.re <= 0.0;
        if c == 0.0 || behind.re.is_infinite() || behind.im.is_infinite() || is_closed {
            return None;
        }
        let q2 = q2_squared.upper_root();
        // Next to the critical angle of the film for that angle itself, where amplitudes have no quotients.
        const NEXT: f64 = 1e-12;
        let squared = (self.film - 1.0) * (self.film + 1.0) + c * c;
        let squared = if squared.abs() < NEXT { NEXT } else { squared };
        let q = Complex::real(squared.abs()).upper_root();
        let q = if squared < 0.0 { Complex::new(0.0, q.re) } else { q };
        let polarised = |p2: Complex, m: f64| {
            let p0 = Complex::real(c);
            let (product, own) = (p2 * (c * m), Complex::real(squared / m));
            let [less, more] = [(product - own) / q, (product + own) / q];
            [p0 - p2 + less, p0 - p2 - less, p0 + p2 + more, p0 + p2 - more]
        };
        let amplitudes = [polarised(q2, 1.0), polarised(q2 / (behind * behind), self.film * self.film)];
        Some(Fringes { rate: Complex::new(0.0, 2.0 * self.phase) * q, amplitudes })
    }
}

/// A film of any thickness at one angle and wavelength: r = (a + b E) / (c + d E) for both polarisations, where E = exp(t times a
/// rate) and t is the thickness over that of the [`Stack`] it was made from.
#[derive(Clone, Copy, Debug)]
pub struct Fringes {
    rate: Complex,
    amplitudes: [[Complex; 4]; 2],
}

impl Fringes {
    /// E of a film that is `t` times as thick.
    pub fn echo(&self, t: f64) -> Complex {
        let (sin, cos) = (self.rate.im * t).sin_cos();
        Complex::new(cos, sin) * (self.rate.re * t).exp()
    }

    /// The reflectance of a film with this E, as [`Stack::reflectance`].
    pub fn reflectance(&self, echo: Complex) -> f64 {
        let [across, along] = self.amplitudes.map(|[a, b, c, d]| (a + b * echo).norm2() / (c + d * echo).norm2());
        let reflectance = 0.5 * (across + along);
        if reflectance.is_nan() { 1.0 } else { reflectance.min(1.0) }
    }
}
