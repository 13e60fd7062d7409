//! Compiles tapes to machine code in this process.
//!
//! [`NativeFunction`] is one compiled [`Tape`](crate::tape::Tape), [`JitModel`] a whole
//! [`Program`](crate::program::Program) behind the trait of all models. The code executes the operations of the
//! tape without fusing or reordering arithmetic, and calls the elementary functions of the Rust standard
//! library. Its results are bit-identical to those of the emitted Rust and of the interpreter.
//!
//! The crate `appell-vector` evaluates a tape at eight points at once, with bit-identical results.
//!
//! The stages: `check` verifies that a tape can be compiled, `translate` lowers it, `native` calls the
//! machine code, `memory` owns it. `elementary` and `dense` are run-time routines of the code.

// Machine code is reached by pointers. Only `native`, `memory`, `elementary` and `dense` use unsafe
// blocks; the interface of the module is safe.
#![allow(unsafe_code)]

mod check;
mod dense;
mod elementary;
mod error;
mod host;
mod memory;
mod model;
mod native;
mod on_demand;
mod translate;

pub use check::{Checked, MOST_OPERATIONS, MOST_ROWS, Sizes, check};
pub use elementary::Elementary;
pub use error::JitError;
pub use model::JitModel;
pub use native::NativeFunction;
