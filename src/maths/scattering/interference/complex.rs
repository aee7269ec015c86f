//! The few operations on complex numbers that thin films need.

use std::ops::{Add, Div, Mul, Neg, Sub};

/// A complex number in double precision.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Complex {
    /// Real part.
    pub re: f64,
    /// Imaginary part.
    pub im: f64,
}

impl Complex {
    /// From both parts.
    #[inline]
    pub const fn new(re: f64, im: f64) -> Self {
        Self { re, im }
    }

    /// Square of the absolute value.
    #[inline]
    pub fn norm2(self) -> f64 {
        self.re * self.re + self.im * self.im
    }

    /// The square root in the upper half plane: for refractive indices, the wave that fades on its way.
    #[inline]
    pub fn root(self) -> Self {
        let size = self.norm2().sqrt();
        let re = (0.5 * (size + self.re)).max(0.0).sqrt();
        let im = (0.5 * (size - self.re)).max(0.0).sqrt();
        Self::new(if self.im < 0.0 { -re } else { re }, im)
    }

    /// A real power of a number in the right half plane.
    pub fn power(self, exponent: f64) -> Self {
        let size = self.norm2().powf(0.5 * exponent);
        let (sin, cos) = (self.im.atan2(self.re) * exponent).sin_cos();
        Self::new(size * cos, size * sin)
    }

    /// Sine and cosine.
    #[inline]
    pub fn sin_cos(self) -> (Self, Self) {
        let (s, c) = self.re.sin_cos();
        let (up, down) = (self.im.exp(), (-self.im).exp());
        let (cosh, sinh) = (0.5 * (up + down), 0.5 * (up - down));
        (
            Self::new(s * cosh, c * sinh),
            Self::new(c * cosh, -s * sinh),
        )
    }

    /// Times i.
    #[inline]
    pub fn turned(self) -> Self {
        Self::new(-self.im, self.re)
    }

    /// Times a real number.
    #[inline]
    pub fn scaled(self, factor: f64) -> Self {
        Self::new(self.re * factor, self.im * factor)
    }
}

impl Add for Complex {
    type Output = Self;
    #[inline]
    fn add(self, other: Self) -> Self {
        Self::new(self.re + other.re, self.im + other.im)
    }
}

impl Sub for Complex {
    type Output = Self;
    #[inline]
    fn sub(self, other: Self) -> Self {
        Self::new(self.re - other.re, self.im - other.im)
    }
}

impl Mul for Complex {
    type Output = Self;
    #[inline]
    fn mul(self, other: Self) -> Self {
        Self::new(
            self.re * other.re - self.im * other.im,
            self.re * other.im + self.im * other.re,
        )
    }
}

impl Div for Complex {
    type Output = Self;
    #[inline]
    fn div(self, other: Self) -> Self {
        let scale = 1.0 / other.norm2();
        Self::new(
            (self.re * other.re + self.im * other.im) * scale,
            (self.im * other.re - self.re * other.im) * scale,
        )
    }
}

impl Neg for Complex {
    type Output = Self;
    #[inline]
    fn neg(self) -> Self {
        Self::new(-self.re, -self.im)
    }
}
