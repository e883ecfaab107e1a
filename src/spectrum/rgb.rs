//! Colour in three channels.

use std::fmt;
use std::iter::Sum;
use std::ops::{Add, AddAssign, Div, DivAssign, Index, Mul, MulAssign, Neg, Sub, SubAssign};

use crate::math::{DVec3, Vec3};

/// A scene-linear colour, or a radiometric quantity per channel (the context gives its unit), in Rec. 709 primaries.
///
/// Arithmetic is per channel. The three channels lie in one vector register.
#[derive(Clone, Copy, Default, PartialEq)]
#[repr(transparent)]
pub struct Rgb(Vec3);

impl Rgb {
    /// Black.
    pub const ZERO: Self = Self(Vec3::ZERO);
    /// One in every channel.
    pub const ONE: Self = Self(Vec3::ONE);

    /// NaN in every channel.
    pub const NAN: Self = Self(Vec3::NAN);
    /// Infinity in every channel.
    pub const INFINITY: Self = Self(Vec3::INFINITY);

    /// A colour of these channels.
    #[inline(always)]
    pub const fn new(r: f32, g: f32, b: f32) -> Self {
        Self(Vec3::new(r, g, b))
    }

    /// The same value in every channel.
    #[inline(always)]
    pub const fn splat(value: f32) -> Self {
        Self(Vec3::splat(value))
    }

    /// A colour of the channels red, green, blue.
    #[inline(always)]
    pub const fn from_array(channels: [f32; 3]) -> Self {
        Self(Vec3::from_array(channels))
    }

    /// Red, green and blue.
    #[inline(always)]
    pub const fn to_array(self) -> [f32; 3] {
        self.0.to_array()
    }

    /// The colour whose channels are these numbers rounded to single precision.
    #[inline(always)]
    pub fn from_f64(channels: DVec3) -> Self {
        Self(channels.as_vec3a())
    }

    /// The channels in double precision, for sums of many colours.
    #[inline(always)]
    pub fn to_f64(self) -> DVec3 {
        self.0.as_dvec3()
    }

    /// The red channel.
    #[inline(always)]
    pub fn r(self) -> f32 {
        self.0.x
    }

    /// The green channel.
    #[inline(always)]
    pub fn g(self) -> f32 {
        self.0.y
    }

    /// The blue channel.
    #[inline(always)]
    pub fn b(self) -> f32 {
        self.0.z
    }

    /// The sum of the channels.
    #[inline(always)]
    pub fn element_sum(self) -> f32 {
        self.0.element_sum()
    }

    /// The largest channel.
    #[inline(always)]
    pub fn max_element(self) -> f32 {
        self.0.max_element()
    }

    /// The smallest channel.
    #[inline(always)]
    pub fn min_element(self) -> f32 {
        self.0.min_element()
    }

    /// Whether no channel is infinite or NaN.
    #[inline(always)]
    pub fn is_finite(self) -> bool {
        self.0.is_finite()
    }

    /// The absolute value of every channel.
    #[inline(always)]
    #[must_use]
    pub fn abs(self) -> Self {
        Self(self.0.abs())
    }

    /// The larger value of each channel.
    #[inline(always)]
    #[must_use]
    pub fn max(self, other: Self) -> Self {
        Self(self.0.max(other.0))
    }

    /// The smaller value of each channel.
    #[inline(always)]
    #[must_use]
    pub fn min(self, other: Self) -> Self {
        Self(self.0.min(other.0))
    }

    /// The sum of the products of the channels.
    #[inline(always)]
    pub fn dot(self, other: Self) -> f32 {
        self.0.dot(other.0)
    }
}

impl fmt::Debug for Rgb {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [r, g, b] = self.to_array();
        f.debug_tuple("Rgb").field(&r).field(&g).field(&b).finish()
    }
}

impl fmt::Display for Rgb {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.0.fmt(f)
    }
}

impl From<[f32; 3]> for Rgb {
    fn from(channels: [f32; 3]) -> Self {
        Self::from_array(channels)
    }
}

impl From<Rgb> for [f32; 3] {
    fn from(color: Rgb) -> Self {
        color.to_array()
    }
}

/// Operators per channel: `$op` with another colour and with a number.
macro_rules! operators {
    ($($op:ident $f:ident $assign:ident $g:ident;)*) => {$(
        impl $op for Rgb {
            type Output = Self;
            #[inline(always)]
            fn $f(self, other: Self) -> Self {
                Self($op::$f(self.0, other.0))
            }
        }
        impl $op<f32> for Rgb {
            type Output = Self;
            #[inline(always)]
            fn $f(self, factor: f32) -> Self {
                Self($op::$f(self.0, factor))
            }
        }
        impl $op<Rgb> for f32 {
            type Output = Rgb;
            #[inline(always)]
            fn $f(self, color: Rgb) -> Rgb {
                Rgb($op::$f(self, color.0))
            }
        }
        impl $assign for Rgb {
            #[inline(always)]
            fn $g(&mut self, other: Self) {
                $assign::$g(&mut self.0, other.0);
            }
        }
        impl $assign<f32> for Rgb {
            #[inline(always)]
            fn $g(&mut self, factor: f32) {
                $assign::$g(&mut self.0, factor);
            }
        }
    )*};
}

operators! {
    Add add AddAssign add_assign;
    Sub sub SubAssign sub_assign;
    Mul mul MulAssign mul_assign;
    Div div DivAssign div_assign;
}

/// A channel by its number: 0 is red, 1 green, 2 blue.
impl Index<usize> for Rgb {
    type Output = f32;
    #[inline(always)]
    fn index(&self, channel: usize) -> &f32 {
        &self.0[channel]
    }
}

impl Neg for Rgb {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        Self(-self.0)
    }
}

impl Sum for Rgb {
    fn sum<I: Iterator<Item = Self>>(colors: I) -> Self {
        colors.fold(Self::ZERO, |sum, color| sum + color)
    }
}
