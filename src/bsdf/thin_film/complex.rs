//! Complex numbers, as far as films need them.

use std::ops::{Add, Div, Mul, Sub};

/// A complex number.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Complex {
    /// Real part.
    pub re: f64,
    /// Imaginary part.
    pub im: f64,
}

impl Complex {
    /// A complex number.
    pub const fn new(re: f64, im: f64) -> Self {
        Self { re, im }
    }

    /// A real number.
    pub const fn real(re: f64) -> Self {
        Self::new(re, 0.0)
    }

    /// The square of the absolute value.
    pub fn norm2(self) -> f64 {
        self.re * self.re + self.im * self.im
    }

    /// The square root in the upper half plane, for a number whose imaginary part is >= 0: that of a wave that decays.
    pub fn upper_root(self) -> Self {
        let length = self.re.hypot(self.im);
        // Of the two parts, the larger one is found without a difference.
        let larger = (0.5 * (length + self.re.abs())).sqrt();
        if larger == 0.0 {
            return Self::real(0.0);
        }
        let smaller = 0.5 * self.im.abs() / larger;
        if self.re >= 0.0 { Self::new(larger, smaller) } else { Self::new(smaller, larger) }
    }
}

impl Add for Complex {
    type Output = Self;
    fn add(self, right: Self) -> Self {
        Self::new(self.re + right.re, self.im + right.im)
    }
}

impl Sub for Complex {
    type Output = Self;
    fn sub(self, right: Self) -> Self {
        Self::new(self.re - right.re, self.im - right.im)
    }
}

impl Mul for Complex {
    type Output = Self;
    fn mul(self, right: Self) -> Self {
        Self::new(self.re * right.re - self.im * right.im, self.re * right.im + self.im * right.re)
    }
}

impl Mul<f64> for Complex {
    type Output = Self;
    fn mul(self, right: f64) -> Self {
        Self::new(self.re * right, self.im * right)
    }
}

impl Div for Complex {
    type Output = Self;
    fn div(self, right: Self) -> Self {
        let scale = 1.0 / right.norm2();
        let conjugate = Self::new(right.re, -right.im);
        self * conjugate * scale
    }
}
