//! Schedules compiled to vector instructions, for eight places at once.
//!
//! A *block* is one number for each of eight places, `[f64; 8]`; arguments and results are arrays
//! of blocks. With AVX-512 a block is one register. With AVX it is two halves: the code works on
//! four places and runs twice. Elsewhere, and where a schedule is too long, places are evaluated one
//! by one with scalar code. Lanes do not know of each other, so results do not depend on the way.
//!
//! Cranelift has no vectors of that width, hence a small compiler of our own. The stages:
//!
//! | file | from | to |
//! |---|---|---|
//! | `lower.rs`, `line.rs` | schedule | values in a straight line; linear systems of up to 12 rows written out |
//! | `order.rs` | values | actions: calls first, results where they are known |
//! | `registers.rs`, `slots.rs`, `instruction.rs` | actions | instructions with registers and blocks of the frame |
//! | `assemble.rs`, `encode.rs` | instructions | bytes, constants behind them |
//! | `machine.rs` | bytes | code in executable memory; calls it |
//!
//! `routines.rs` has what the code calls: elementary functions (`blocks.rs`) and large systems. `function.rs`
//! chooses between machine code and scalar code.

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
