//! Run-time routines called by machine code with addresses of blocks.

use appell_runtime::dense::lu_solve_in_place;
use appell_runtime::real::{Own, Standard};

use super::super::elementary::Elementary;
use super::blocks::Blocks;
use super::encode::Width;
use super::line::Routine;
use crate::symbolic::Function;

/// From a block to a block. The last address is that of the result.
type Unary<const N: usize> = unsafe extern "C" fn(*const [f64; N], *mut [f64; N]);
/// From two blocks to a block.
type Binary<const N: usize> = unsafe extern "C" fn(*const [f64; N], *const [f64; N], *mut [f64; N]);
/// From a block to two adjacent blocks.
type Pair<const N: usize> = unsafe extern "C" fn(*const [f64; N], *mut [[f64; N]; 2]);
/// From the blocks of a matrix and a right-hand side to those of the solution, for a number of rows.
type System<const N: usize> = unsafe extern "C" fn(*const [f64; N], *mut [f64; N], usize);

/// The address of a routine.
pub(super) fn address(routine: Routine, elementary: Elementary, width: Width) -> usize {
    match (elementary, width) {
        (Elementary::Standard, Width::Ymm) => of::<Standard, 4>(routine),
        (Elementary::Standard, Width::Zmm) => of::<Standard, 8>(routine),
        (Elementary::Own, Width::Ymm) => of::<Own, 4>(routine),
        (Elementary::Own, Width::Zmm) => of::<Own, 8>(routine),
    }
}

fn of<B: Blocks, const N: usize>(routine: Routine) -> usize {
    let sin_cos: Pair<N> = sin_cos::<B, N>;
    let [atan2, powf]: [Binary<N>; 2] = [atan2::<B, N>, powf::<B, N>];
    let system: System<N> = system::<N>;
    match routine {
        Routine::Unary(function) => unary::<B, N>(function).map_or(0, |routine| routine as usize),
        Routine::SinCos => sin_cos as usize,
        Routine::Atan2 => atan2 as usize,
        Routine::Power => powf as usize,
        Routine::System(_) => system as usize,
    }
}

macro_rules! unary_routines {
    ($($function:ident $name:ident),+) => {
        fn unary<B: Blocks, const N: usize>(function: Function) -> Option<Unary<N>> {
            Some(match function {
                $(Function::$function => $name::<B, N>,)+
                // Computed by instructions.
                Function::Sqrt | Function::Abs | Function::Sign => return None,
            })
        }
        $(
            /// # Safety
            ///
            /// `from` points to a block, `to` to one that nothing else uses.
            unsafe extern "C" fn $name<B: Blocks, const N: usize>(
                from: *const [f64; N],
                to: *mut [f64; N],
            ) {
                // SAFETY: the caller's promise.
                unsafe { <B as Blocks>::$name(&*from, &mut *to) }
            }
        )+
    };
}

unary_routines!(
    Sin sin, Cos cos, Asin asin, Acos acos, Atan atan, Sinh sinh, Cosh cosh, Tanh tanh, Exp exp,
    Ln ln
);

macro_rules! binary_routines {
    ($($name:ident),+) => {
        $(
            /// # Safety
            ///
            /// `first` and `second` point to blocks, `to` to one that nothing else uses.
            unsafe extern "C" fn $name<B: Blocks, const N: usize>(
                first: *const [f64; N],
                second: *const [f64; N],
                to: *mut [f64; N],
            ) {
                // SAFETY: the caller's promise.
                unsafe { <B as Blocks>::$name(&*first, &*second, &mut *to) }
            }
        )+
    };
}

binary_routines!(atan2, powf);

/// # Safety
///
/// `from` points to a block, `to` to two that nothing else uses.
unsafe extern "C" fn sin_cos<B: Blocks, const N: usize>(
    from: *const [f64; N],
    to: *mut [[f64; N]; 2],
) {
    // SAFETY: the caller's promise.
    unsafe { <B as Blocks>::sin_cos(&*from, &mut *to) }
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
