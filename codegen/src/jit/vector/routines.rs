//! The routines that machine code calls with addresses of blocks.

use appell_runtime::dense::lu_solve_in_place;
use appell_runtime::real::Real;

use super::encode::Width;
use super::line::Routine;
use crate::symbolic::Function;

/// Which elementary functions are called.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Elementary {
    /// Those of the Rust standard library, lane by lane: every lane has the bits of scalar code.
    #[default]
    Standard,
}

/// The addresses of routines.
#[derive(Debug, Clone, Copy)]
pub(super) struct Routines {
    pub(super) elementary: Elementary,
}

impl Routines {
    pub(super) fn address(self, routine: Routine, width: Width) -> usize {
        let Elementary::Standard = self.elementary;
        match width {
            Width::Ymm => standard::<4>(routine),
            Width::Zmm => standard::<8>(routine),
        }
    }
}

/// From a block to a block. The last address is that of the result.
type Unary<const N: usize> = unsafe extern "C" fn(*const [f64; N], *mut [f64; N]);
/// From two blocks to a block.
type Binary<const N: usize> = unsafe extern "C" fn(*const [f64; N], *const [f64; N], *mut [f64; N]);
/// From a block to two in a row.
type Pair<const N: usize> = unsafe extern "C" fn(*const [f64; N], *mut [[f64; N]; 2]);
/// From the blocks of a matrix and a right-hand side to those of the unknowns, for so many rows.
type System<const N: usize> = unsafe extern "C" fn(*const [f64; N], *mut [f64; N], usize);

fn standard<const N: usize>(routine: Routine) -> usize {
    let sin_cos: Pair<N> = sin_cos::<N>;
    let [atan2, power]: [Binary<N>; 2] = [atan2::<N>, power::<N>];
    let system: System<N> = system::<N>;
    match routine {
        Routine::Unary(function) => unary::<N>(function) as usize,
        Routine::SinCos => sin_cos as usize,
        Routine::Atan2 => atan2 as usize,
        Routine::Power => power as usize,
        Routine::System(_) => system as usize,
    }
}

macro_rules! unary {
    ($($function:ident $name:ident),+) => {
        fn unary<const N: usize>(function: Function) -> Unary<N> {
            match function {
                $(Function::$function => $name::<N>,)+
            }
        }
        $(
            /// # Safety
            ///
            /// `from` points to a block, `to` to one that nothing else uses.
            unsafe extern "C" fn $name<const N: usize>(from: *const [f64; N], to: *mut [f64; N]) {
                // SAFETY: the caller's promise.
                unsafe { to.write(from.read().map(<f64 as Real>::$name)) }
            }
        )+
    };
}

unary!(
    Sin sin, Cos cos, Asin asin, Acos acos, Atan atan, Sinh sinh, Cosh cosh, Tanh tanh, Exp exp,
    Ln ln, Sqrt sqrt, Abs abs, Sign sign
);

/// # Safety
///
/// `y` and `x` point to blocks, `to` to one that nothing else uses.
unsafe extern "C" fn atan2<const N: usize>(
    y: *const [f64; N],
    x: *const [f64; N],
    to: *mut [f64; N],
) {
    // SAFETY: the caller's promise.
    let (y, x) = unsafe { (y.read(), x.read()) };
    let lanes = std::array::from_fn(|lane| Real::atan2(y[lane], x[lane]));
    // SAFETY: the caller's promise.
    unsafe { to.write(lanes) }
}

/// # Safety
///
/// `base` and `exponent` point to blocks, `to` to one that nothing else uses.
unsafe extern "C" fn power<const N: usize>(
    base: *const [f64; N],
    exponent: *const [f64; N],
    to: *mut [f64; N],
) {
    // SAFETY: the caller's promise.
    let (base, exponent) = unsafe { (base.read(), exponent.read()) };
    let lanes = std::array::from_fn(|lane| Real::powf(base[lane], exponent[lane]));
    // SAFETY: the caller's promise.
    unsafe { to.write(lanes) }
}

/// # Safety
///
/// `from` points to a block, `to` to two that nothing else uses.
unsafe extern "C" fn sin_cos<const N: usize>(from: *const [f64; N], to: *mut [[f64; N]; 2]) {
    // SAFETY: the caller's promise.
    let pairs = unsafe { from.read() }.map(<f64 as Real>::sin_cos);
    let lanes = [pairs.map(|(sin, _)| sin), pairs.map(|(_, cos)| cos)];
    // SAFETY: the caller's promise.
    unsafe { to.write(lanes) }
}

/// # Safety
///
/// `from` points to `rows * (rows + 1)` blocks, `to` to `rows` that nothing else uses.
unsafe extern "C" fn system<const N: usize>(from: *const [f64; N], to: *mut [f64; N], rows: usize) {
    // SAFETY: the caller's promise.
    let (from, to) = unsafe {
        (
            std::slice::from_raw_parts(from, rows * (rows + 1)),
            std::slice::from_raw_parts_mut(to, rows),
        )
    };
    for lane in 0..N {
        let numbers = from.iter().map(|block| block[lane]);
        let mut matrix: Vec<f64> = numbers.collect();
        let mut right = matrix.split_off(rows * rows);
        lu_solve_in_place(&mut matrix, &mut right, rows);
        for (block, unknown) in to.iter_mut().zip(right) {
            block[lane] = unknown;
        }
    }
}
