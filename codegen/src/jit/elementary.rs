//! The elementary functions that machine code calls.
//!
//! Each is the function of the standard library, the one that emitted Rust calls for `f64`, under
//! an address and a calling convention that machine code knows.

use crate::symbolic::Function;

/// `f64 -> f64`
pub(super) type Unary = extern "C" fn(f64) -> f64;

macro_rules! shims {
    ($($name:ident),+) => {
        $(
            extern "C" fn $name(x: f64) -> f64 {
                x.$name()
            }
        )+
    };
}

shims!(sin, cos, asin, acos, atan, sinh, cosh, tanh, exp, ln);

/// The function to call. `None` where instructions do it.
pub(super) fn unary(function: Function) -> Option<Unary> {
    Some(match function {
        Function::Sin => sin,
        Function::Cos => cos,
        Function::Asin => asin,
        Function::Acos => acos,
        Function::Atan => atan,
        Function::Sinh => sinh,
        Function::Cosh => cosh,
        Function::Tanh => tanh,
        Function::Exp => exp,
        Function::Ln => ln,
        Function::Sqrt | Function::Abs | Function::Sign => return None,
    })
}

/// Angle of the point (`x`, `y`).
pub(super) extern "C" fn atan2(y: f64, x: f64) -> f64 {
    y.atan2(x)
}

/// Power with a real exponent.
pub(super) extern "C" fn powf(base: f64, exponent: f64) -> f64 {
    base.powf(exponent)
}

/// Writes sine and cosine of an angle.
///
/// # Safety
///
/// `out` must point to two numbers that nothing else uses.
pub(super) unsafe extern "C" fn sin_cos(angle: f64, out: *mut [f64; 2]) {
    let (sin, cos) = angle.sin_cos();
    // SAFETY: the caller provides the place.
    unsafe { out.write([sin, cos]) }
}
