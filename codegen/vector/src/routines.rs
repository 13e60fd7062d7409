//! Run-time routines called by machine code with addresses of blocks.

// Machine code passes addresses.
#![allow(unsafe_code)]

use std::slice;

use appell_codegen::jit::Elementary;
use appell_codegen::symbolic::Function;
use appell_codegen::tape::Operation;
use appell_runtime::dense::lu_solve_in_place;
use appell_runtime::lanes::Blocks;
use appell_runtime::real::{Own, Standard};

/// From one or two blocks to adjacent blocks; for systems, from the blocks of a matrix with the right-hand side, and
/// the number of rows.
type Routine<const N: usize> =
    unsafe extern "C" fn(*const [f64; N], *const [f64; N], *mut [f64; N], usize);

/// The address of the routine of an operation, for blocks of four or eight lanes; 0 if instructions compute it.
pub(crate) fn address(operation: &Operation, elementary: Elementary, lanes: u8) -> usize {
    let address = match (elementary, lanes) {
        (Elementary::Standard, 4) => of::<Standard, 4>(operation).map(|routine| routine as usize),
        (Elementary::Standard, _) => of::<Standard, 8>(operation).map(|routine| routine as usize),
        (Elementary::Own, 4) => of::<Own, 4>(operation).map(|routine| routine as usize),
        (Elementary::Own, _) => of::<Own, 8>(operation).map(|routine| routine as usize),
    };
    address.unwrap_or(0)
}

fn of<B: Blocks, const N: usize>(operation: &Operation) -> Option<Routine<N>> {
    Some(match operation {
        Operation::Function(function, _) => return unary::<B, N>(*function),
        Operation::SinCos(_) => sin_cos::<B, N>,
        Operation::Atan2(..) => atan2::<B, N>,
        Operation::Power(..) => powf::<B, N>,
        Operation::Solve { .. } => system::<N>,
        _ => return None,
    })
}

macro_rules! routine {
    ($name:ident($first:ident, $second:ident): $($given:ident),+) => {
        /// # Safety
        ///
        /// The addresses of operands are those of blocks, `to` that of one that nothing else uses.
        unsafe extern "C" fn $name<B: Blocks, const N: usize>(
            $first: *const [f64; N],
            $second: *const [f64; N],
            to: *mut [f64; N],
            _: usize,
        ) {
            let _ = $second;
            // SAFETY: the caller's promise.
            unsafe { <B as Blocks>::$name($(&*$given,)+ &mut *to) }
        }
    };
}

macro_rules! unary {
    ($($function:ident $name:ident),+) => {
        $(routine!($name(first, second): first);)+

        fn unary<B: Blocks, const N: usize>(function: Function) -> Option<Routine<N>> {
            Some(match function {
                $(Function::$function => $name::<B, N>,)+
                Function::Sqrt | Function::Abs | Function::Sign => return None,
            })
        }
    };
}

unary!(
    Sin sin, Cos cos, Asin asin, Acos acos, Atan atan, Sinh sinh, Cosh cosh, Tanh tanh, Exp exp,
    Ln ln
);
routine!(atan2(first, second): first, second);
routine!(powf(first, second): first, second);

/// # Safety
///
/// `from` points to a block, `to` to two that nothing else uses.
unsafe extern "C" fn sin_cos<B: Blocks, const N: usize>(
    from: *const [f64; N],
    _: *const [f64; N],
    to: *mut [f64; N],
    _: usize,
) {
    // SAFETY: the caller's promise; adjacent blocks are an array.
    unsafe { <B as Blocks>::sin_cos(&*from, &mut *to.cast::<[[f64; N]; 2]>()) }
}

/// # Safety
///
/// `from` points to `rows * (rows + 1)` blocks, `to` to `rows` that nothing else uses.
unsafe extern "C" fn system<const N: usize>(
    from: *const [f64; N],
    _: *const [f64; N],
    to: *mut [f64; N],
    rows: usize,
) {
    // SAFETY: the caller's promise.
    let (from, to) = unsafe {
        (
            slice::from_raw_parts(from, rows * (rows + 1)),
            slice::from_raw_parts_mut(to, rows),
        )
    };
    for lane in 0..N {
        let mut matrix: Vec<f64> = from.iter().map(|block| block[lane]).collect();
        let mut right = matrix.split_off(rows * rows);
        lu_solve_in_place(&mut matrix, &mut right, rows);
        for (block, unknown) in to.iter_mut().zip(right) {
            block[lane] = unknown;
        }
    }
}
