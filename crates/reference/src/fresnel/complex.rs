//! Complex numbers, as far as Fresnel's equations take them.

use std::ops::{Add, Div, Mul, Sub};

#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Complex {
    pub re: f64,
    pub im: f64,
}

impl Complex {
    /// |z|².
    pub fn norm2(self) -> f64 {
        self.re * self.re + self.im * self.im
    }

    /// The root whose argument is half of this one's, which is in (−π, π].
    pub fn sqrt(self) -> Self {
        let (sin, cos) = (0.5 * self.im.atan2(self.re)).sin_cos();
        let size = self.re.hypot(self.im).sqrt();
        Self { re: size * cos, im: size * sin }
    }
}

impl From<f64> for Complex {
    fn from(re: f64) -> Self {
        Self { re, im: 0.0 }
    }
}

impl Add for Complex {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        Self { re: self.re + other.re, im: self.im + other.im }
    }
}

impl Sub for Complex {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        Self { re: self.re - other.re, im: self.im - other.im }
    }
}

impl Mul for Complex {
    type Output = Self;
    fn mul(self, other: Self) -> Self {
        let Self { re, im } = other;
        Self { re: self.re * re - self.im * im, im: self.re * im + self.im * re }
    }
}

impl Div for Complex {
    type Output = Self;
    fn div(self, other: Self) -> Self {
        let over = self * Self { re: other.re, im: -other.im };
        Self { re: over.re / other.norm2(), im: over.im / other.norm2() }
    }
}
