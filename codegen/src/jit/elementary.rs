//! The elementary functions that machine code calls.
//!
//! Each has a fixed address and a C calling convention.

use appell_runtime::lanes::Blocks;
use appell_runtime::real::{Own, Standard};

use crate::symbolic::Function;

/// The elementary functions called by machine code.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Elementary {
    /// Those of the Rust standard library, which emitted Rust calls for `f64`.
    #[default]
    Standard,
    /// Those of [`appell_runtime::elementary`], bit-identical on every machine; a vector of numbers takes
    /// little longer than one.
    Own,
}

/// `f64 -> f64`
pub(super) type Unary = extern "C" fn(f64) -> f64;
/// `(f64, f64) -> f64`
pub(super) type Binary = extern "C" fn(f64, f64) -> f64;
/// Writes two numbers for one argument.
pub(super) type Pair = unsafe extern "C" fn(f64, *mut [f64; 2]);

/// The routines of a set of elementary functions.
pub(super) struct Routines {
    /// The function to call. `None` if inline instructions compute it.
    pub(super) unary: fn(Function) -> Option<Unary>,
    /// Angle of the point (second, first).
    pub(super) atan2: Binary,
    /// Power with a real exponent.
    pub(super) powf: Binary,
    /// Sine and cosine.
    pub(super) sin_cos: Pair,
}

impl Routines {
    fn of<F: Blocks>() -> Self {
        Self {
            unary: unary::<F>,
            atan2: atan2::<F>,
            powf: powf::<F>,
            sin_cos: sin_cos::<F>,
        }
    }
}

impl Elementary {
    pub(super) fn routines(self) -> Routines {
        match self {
            Self::Standard => Routines::of::<Standard>(),
            Self::Own => Routines::of::<Own>(),
        }
    }
}

// A block of one number, so that the processor's vector instructions with fused multiply-adds are used.
macro_rules! shims {
    ($($function:ident $name:ident),+) => {
        $(
            extern "C" fn $name<F: Blocks>(x: f64) -> f64 {
                let mut value = [0.0];
                <F as Blocks>::$name(&[x], &mut value);
                value[0]
            }
        )+

        fn unary<F: Blocks>(function: Function) -> Option<Unary> {
            Some(match function {
                $(Function::$function => $name::<F>,)+
                Function::Sqrt | Function::Abs | Function::Sign => return None,
            })
        }
    };
}

shims!(
    Sin sin, Cos cos, Asin asin, Acos acos, Atan atan, Sinh sinh, Cosh cosh, Tanh tanh, Exp exp,
    Ln ln
);

extern "C" fn atan2<F: Blocks>(y: f64, x: f64) -> f64 {
    let mut value = [0.0];
    <F as Blocks>::atan2(&[y], &[x], &mut value);
    value[0]
}

extern "C" fn powf<F: Blocks>(base: f64, exponent: f64) -> f64 {
    let mut value = [0.0];
    <F as Blocks>::powf(&[base], &[exponent], &mut value);
    value[0]
}

/// # Safety
///
/// `out` must point to two numbers that nothing else uses.
unsafe extern "C" fn sin_cos<F: Blocks>(angle: f64, out: *mut [f64; 2]) {
    let mut both = [[0.0]; 2];
    <F as Blocks>::sin_cos(&[angle], &mut both);
    let [[sin], [cos]] = both;
    // SAFETY: the caller provides the memory.
    unsafe { out.write([sin, cos]) }
}
