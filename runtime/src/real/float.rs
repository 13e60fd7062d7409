//! `f32` and `f64`: the standard library where there is one, `libm` elsewhere.

use super::Real;

macro_rules! real_float {
    ($float:ident, $constant:expr, $atan2:expr, $powf:expr, $sin_cos:expr, $($method:ident => $call:expr),+ $(,)?) => {
        impl Real for $float {
            #[inline]
            fn constant(value: f64) -> Self {
                $constant(value)
            }
            #[inline]
            fn sin_cos(self) -> (Self, Self) {
                $sin_cos(self)
            }
            $(
                #[inline]
                fn $method(self) -> Self {
                    $call(self)
                }
            )+
            #[inline]
            fn atan2(self, x: Self) -> Self {
                $atan2(self, x)
            }
            #[inline]
            fn powf(self, exponent: Self) -> Self {
                $powf(self, exponent)
            }
            #[inline]
            fn sign(self) -> Self {
                if self > 0.0 {
                    1.0
                } else if self < 0.0 {
                    -1.0
                } else {
                    // Zeros stay zero, NaN stays NaN.
                    self
                }
            }
            #[inline]
            fn if_less(a: Self, b: Self, then: Self, otherwise: Self) -> Self {
                if a < b { then } else { otherwise }
            }
            #[inline]
            fn if_less_or_equal(a: Self, b: Self, then: Self, otherwise: Self) -> Self {
                if a <= b { then } else { otherwise }
            }
        }
    };
}

#[cfg(feature = "std")]
macro_rules! real_float_std {
    ($float:ident, $constant:expr) => {
        real_float!(
            $float, $constant, $float::atan2, $float::powf, $float::sin_cos,
            sin => $float::sin, cos => $float::cos, tan => $float::tan,
            asin => $float::asin, acos => $float::acos, atan => $float::atan,
            sinh => $float::sinh, cosh => $float::cosh, tanh => $float::tanh,
            exp => $float::exp, ln => $float::ln, sqrt => $float::sqrt, abs => $float::abs,
        );
    };
}

#[cfg(feature = "std")]
real_float_std!(f64, core::convert::identity);
#[cfg(feature = "std")]
real_float_std!(f32, nearest_f32);

#[cfg(not(feature = "std"))]
real_float!(
    f64, core::convert::identity, libm::atan2, libm::pow, libm::sincos,
    sin => libm::sin, cos => libm::cos, tan => libm::tan,
    asin => libm::asin, acos => libm::acos, atan => libm::atan,
    sinh => libm::sinh, cosh => libm::cosh, tanh => libm::tanh,
    exp => libm::exp, ln => libm::log, sqrt => libm::sqrt, abs => libm::fabs,
);
#[cfg(not(feature = "std"))]
real_float!(
    f32, nearest_f32, libm::atan2f, libm::powf, libm::sincosf,
    sin => libm::sinf, cos => libm::cosf, tan => libm::tanf,
    asin => libm::asinf, acos => libm::acosf, atan => libm::atanf,
    sinh => libm::sinhf, cosh => libm::coshf, tanh => libm::tanhf,
    exp => libm::expf, ln => libm::logf, sqrt => libm::sqrtf, abs => libm::fabsf,
);

/// Rounds to the nearest `f32`; the loss of precision is intended.
#[allow(clippy::cast_possible_truncation)]
#[inline]
fn nearest_f32(value: f64) -> f32 {
    value as f32
}
