//! Forward-mode automatic differentiation.

use super::Real;
use core::array::from_fn;
use core::ops::{Add, AddAssign, Div, Mul, Neg, Sub};

/// A value with its partial derivatives in `N` directions.
///
/// The partials follow the chain rule exactly, so a function of [`Real`] numbers evaluated on
/// duals returns its directional derivatives to rounding (Griewank and Walther, *Evaluating
/// Derivatives*, section 3.1). The inner scalar may itself be a dual: `Dual<Dual<f64, 1>, 1>`
/// carries second derivatives.
///
/// At a kink the derivative of the branch taken is returned; the derivatives of [`Real::sign`] everywhere and of
/// `abs` at zero are zero.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Dual<T, const N: usize> {
    /// The value.
    pub value: T,
    /// Its derivatives in the `N` seeded directions.
    pub partials: [T; N],
}

impl<T: Real, const N: usize> Dual<T, N> {
    /// A number that does not depend on the seeded directions.
    #[inline]
    pub fn fixed(value: T) -> Self {
        Self {
            value,
            partials: [T::constant(0.0); N],
        }
    }

    /// The variable of direction `direction`. A direction outside `0..N` gives a fixed number.
    #[inline]
    pub fn variable(value: T, direction: usize) -> Self {
        let partials = from_fn(|i| T::constant(if i == direction { 1.0 } else { 0.0 }));
        Self { value, partials }
    }

    /// One variable per component: the seed of a full Jacobian.
    #[inline]
    pub fn variables(values: [T; N]) -> [Self; N] {
        from_fn(|i| Self::variable(values[i], i))
    }

    /// f(self), given f and f′ at the value.
    #[inline]
    fn chain(self, value: T, slope: T) -> Self {
        Self {
            value,
            partials: self.partials.map(|partial| slope * partial),
        }
    }
}

impl<T: Real, const N: usize> Add for Dual<T, N> {
    type Output = Self;
    #[inline]
    fn add(self, other: Self) -> Self {
        Self {
            value: self.value + other.value,
            partials: from_fn(|i| self.partials[i] + other.partials[i]),
        }
    }
}

impl<T: Real, const N: usize> AddAssign for Dual<T, N> {
    #[inline]
    fn add_assign(&mut self, other: Self) {
        *self = *self + other;
    }
}

impl<T: Real, const N: usize> Sub for Dual<T, N> {
    type Output = Self;
    #[inline]
    fn sub(self, other: Self) -> Self {
        Self {
            value: self.value - other.value,
            partials: from_fn(|i| self.partials[i] - other.partials[i]),
        }
    }
}

impl<T: Real, const N: usize> Neg for Dual<T, N> {
    type Output = Self;
    #[inline]
    fn neg(self) -> Self {
        Self {
            value: -self.value,
            partials: self.partials.map(|partial| -partial),
        }
    }
}

impl<T: Real, const N: usize> Mul for Dual<T, N> {
    type Output = Self;
    // The product rule.
    #[allow(clippy::suspicious_arithmetic_impl)]
    #[inline]
    fn mul(self, other: Self) -> Self {
        Self {
            value: self.value * other.value,
            partials: from_fn(|i| self.partials[i] * other.value + self.value * other.partials[i]),
        }
    }
}

impl<T: Real, const N: usize> Div for Dual<T, N> {
    type Output = Self;
    // The quotient rule, with one division for all partials.
    #[allow(clippy::suspicious_arithmetic_impl)]
    #[inline]
    fn div(self, other: Self) -> Self {
        let value = self.value / other.value;
        let reciprocal = T::constant(1.0) / other.value;
        Self {
            value,
            partials: from_fn(|i| (self.partials[i] - value * other.partials[i]) * reciprocal),
        }
    }
}

impl<T: Real, const N: usize> Real for Dual<T, N> {
    #[inline]
    fn constant(value: f64) -> Self {
        Self::fixed(T::constant(value))
    }
    #[inline]
    fn sin_cos(self) -> (Self, Self) {
        let (sin, cos) = self.value.sin_cos();
        (self.chain(sin, cos), self.chain(cos, -sin))
    }
    #[inline]
    fn sin(self) -> Self {
        self.sin_cos().0
    }
    #[inline]
    fn cos(self) -> Self {
        self.sin_cos().1
    }
    #[inline]
    fn tan(self) -> Self {
        let tan = self.value.tan();
        self.chain(tan, T::constant(1.0) + tan * tan)
    }
    #[inline]
    fn asin(self) -> Self {
        let slope = T::constant(1.0) / (T::constant(1.0) - self.value * self.value).sqrt();
        self.chain(self.value.asin(), slope)
    }
    #[inline]
    fn acos(self) -> Self {
        let slope = T::constant(-1.0) / (T::constant(1.0) - self.value * self.value).sqrt();
        self.chain(self.value.acos(), slope)
    }
    #[inline]
    fn atan(self) -> Self {
        let slope = T::constant(1.0) / (T::constant(1.0) + self.value * self.value);
        self.chain(self.value.atan(), slope)
    }
    #[inline]
    fn atan2(self, x: Self) -> Self {
        let squared_radius = self.value * self.value + x.value * x.value;
        let along_y = x.value / squared_radius;
        let along_x = -self.value / squared_radius;
        Self {
            value: self.value.atan2(x.value),
            partials: from_fn(|i| along_y * self.partials[i] + along_x * x.partials[i]),
        }
    }
    #[inline]
    fn sinh(self) -> Self {
        self.chain(self.value.sinh(), self.value.cosh())
    }
    #[inline]
    fn cosh(self) -> Self {
        self.chain(self.value.cosh(), self.value.sinh())
    }
    #[inline]
    fn tanh(self) -> Self {
        let tanh = self.value.tanh();
        self.chain(tanh, T::constant(1.0) - tanh * tanh)
    }
    #[inline]
    fn exp(self) -> Self {
        let exp = self.value.exp();
        self.chain(exp, exp)
    }
    #[inline]
    fn ln(self) -> Self {
        self.chain(self.value.ln(), T::constant(1.0) / self.value)
    }
    #[inline]
    fn sqrt(self) -> Self {
        let sqrt = self.value.sqrt();
        self.chain(sqrt, T::constant(0.5) / sqrt)
    }
    #[inline]
    fn abs(self) -> Self {
        self.chain(self.value.abs(), self.value.sign())
    }
    #[inline]
    fn sign(self) -> Self {
        Self::fixed(self.value.sign())
    }
    /// For a base that is not positive only the derivative with respect to the base is taken, as `x^2` needs at
    /// negative `x`; the logarithm is undefined there.
    #[inline]
    fn powf(self, exponent: Self) -> Self {
        let (zero, one) = (T::constant(0.0), T::constant(1.0));
        let (a, b) = (self.value, exponent.value);
        let value = a.powf(b);
        let slope = b * a.powf(b - one);
        // 0 · 0⁻¹ at a = b = 0, where a⁰ = 1 for every a.
        let slope = T::if_less(zero, a.abs(), slope, T::if_less(zero, b.abs(), slope, zero));
        let exponent_slope = T::if_less(zero, a, value * a.ln(), zero);
        Self {
            value,
            partials: from_fn(|i| slope * self.partials[i] + exponent_slope * exponent.partials[i]),
        }
    }
    #[inline]
    fn if_less(a: Self, b: Self, then: Self, otherwise: Self) -> Self {
        Self {
            value: T::if_less(a.value, b.value, then.value, otherwise.value),
            partials: from_fn(|i| {
                T::if_less(a.value, b.value, then.partials[i], otherwise.partials[i])
            }),
        }
    }
    #[inline]
    fn if_less_or_equal(a: Self, b: Self, then: Self, otherwise: Self) -> Self {
        Self {
            value: T::if_less_or_equal(a.value, b.value, then.value, otherwise.value),
            partials: from_fn(|i| {
                T::if_less_or_equal(a.value, b.value, then.partials[i], otherwise.partials[i])
            }),
        }
    }
}
