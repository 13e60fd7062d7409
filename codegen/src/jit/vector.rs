//! Compiles tapes to vector instructions, for eight points at once.
//!
//! A *block* is one number for each of eight points, `[f64; 8]`; arguments and results are arrays of blocks.
//! With AVX-512 a block is one register. With AVX it is two halves: the code processes four points and runs
//! twice. Without these, or if a tape is too long, the points are evaluated individually with scalar code.
//! Lanes are independent, so results do not depend on the method.
//!
//! Cranelift lacks vectors of that width, hence this small compiler. The stages:
//!
//! | file | from | to |
//! |---|---|---|
//! | `lower.rs`, `line.rs` | tape | values in straight-line code; linear systems of up to 12 rows unrolled |
//! | `order.rs` | values | actions: calls early, results stored at their definition |
//! | `registers.rs`, `slots.rs`, `instruction.rs` | actions | instructions with registers and blocks of the frame |
//! | `assemble.rs`, `encode.rs` | instructions | machine code, followed by constants |
//! | `machine.rs` | machine code | a callable function in executable memory |
//!
//! `routines.rs` contains run-time routines: elementary functions (`blocks.rs`) and large systems.
//! `function.rs` chooses between vector and scalar code.

mod assemble;
mod blocks;
mod encode;
mod function;
mod instruction;
mod line;
mod lower;
mod machine;
mod order;
mod registers;
mod routines;
mod slots;

pub(super) use blocks::Blocks;
pub use function::VectorFunction;
pub use machine::{Instructions, Target};
