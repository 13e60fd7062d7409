//! Compiles tapes to vector instructions, for eight points at once.
//!
//! A *block* is one number for each of eight points, `[f64; 8]`; arguments and results are arrays of blocks.
//! With AVX-512 a block is one register. With AVX it is two halves: the code processes four points and runs
//! twice. Without these, or if a tape is too long, the points are evaluated individually with scalar code.
//! Lanes are independent, so results do not depend on the method.
//!
//! Cranelift lacks vectors of that width, hence this small compiler. A value of the tape is a virtual register:
//!
//! | file | from | to |
//! |---|---|---|
//! | `unroll.rs` | tape | tape without linear systems of up to 12 rows |
//! | `order.rs` | tape | actions: calls early, results stored at their definition |
//! | `registers.rs`, `uses.rs`, `slots.rs` | actions | registers and blocks of the frame |
//! | `assemble.rs`, `instruction_set.rs` | operations on registers and memory | machine code, after its constants |
//! | `machine.rs` | machine code | a callable function in executable memory |
//!
//! `routines.rs` contains run-time routines: elementary functions and large systems. `function.rs` chooses
//! between vector and scalar code.

mod assemble;
mod error;
mod function;
mod instruction_set;
mod machine;
mod order;
mod registers;
mod routines;
mod slots;
mod unroll;
mod uses;

pub use assemble::MachineCode;
pub use error::VectorError;
pub use function::VectorFunction;
pub use machine::{Instructions, Target, machine_code};
