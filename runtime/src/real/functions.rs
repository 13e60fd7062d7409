//! Elementary functions of lanes.

// All functions must be inlined to be vectorised over lanes.
#![allow(clippy::inline_always)]

use super::Real;
use crate::elementary;

/// A choice of elementary functions; the methods are those of [`Real`] for one lane.
#[allow(missing_docs)]
pub trait Functions: Copy {
    fn sin_cos(x: f64) -> (f64, f64);
    fn sin(x: f64) -> f64;
    fn cos(x: f64) -> f64;
    fn tan(x: f64) -> f64;
    fn asin(x: f64) -> f64;
    fn acos(x: f64) -> f64;
    fn atan(x: f64) -> f64;
    fn atan2(y: f64, x: f64) -> f64;
    fn sinh(x: f64) -> f64;
    fn cosh(x: f64) -> f64;
    fn tanh(x: f64) -> f64;
    fn exp(x: f64) -> f64;
    fn ln(x: f64) -> f64;
    fn powf(x: f64, exponent: f64) -> f64;
}

/// The functions of `f64`: those of the standard library, or of `libm` where there is none.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Standard;

/// The functions of [`crate::elementary`], with the same bits on every machine.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Own;

macro_rules! functions {
    ($choice:ident from $source:ident: $($name:ident($($x:ident),+)),+) => {
        impl Functions for $choice {
            #[inline(always)]
            fn sin_cos(x: f64) -> (f64, f64) {
                $source::sin_cos(x)
            }
            $(
                #[inline(always)]
                fn $name($($x: f64),+) -> f64 {
                    $source::$name($($x),+)
                }
            )+
        }
    };
    ($choice:ident from $source:ident) => {
        functions!(
            $choice from $source:
            sin(x), cos(x), tan(x), asin(x), acos(x), atan(x), atan2(y, x), sinh(x), cosh(x),
            tanh(x), exp(x), ln(x), powf(x, exponent)
        );
    };
}

functions!(Own from elementary);
functions!(Standard from Real);
