//! Errors of compilation.

use cranelift_codegen::CodegenError;
use cranelift_codegen::settings::SetError;
use cranelift_module::ModuleError;
use thiserror::Error;

use crate::program::FunctionKind;

/// A tape or program that could not be compiled.
#[derive(Debug, Error)]
pub enum JitError {
    /// No code can be generated for this processor.
    #[error("no machine code for this processor: {reason}")]
    Host {
        /// The compiler's message.
        reason: &'static str,
    },
    /// The compiler refused its settings.
    #[error("the compiler refused its settings")]
    Settings(#[from] SetError),
    /// The compiler refused this processor.
    #[error("the compiler refused this processor")]
    Target(#[from] CodegenError),
    /// The function is too long to be compiled in reasonable time and stack.
    #[error("the function has {operations} operations; at most {most} are compiled")]
    TooManyOperations {
        /// Operations counted, at least.
        operations: usize,
        /// The limit.
        most: usize,
    },
    /// A linear system is too large for the stack.
    #[error("a linear system has {rows} unknowns; at most {most} are compiled")]
    TooManyRows {
        /// Unknowns of the system.
        rows: usize,
        /// The limit.
        most: usize,
    },
    /// A value is used that no earlier operation computes as a number.
    #[error("value {value} is not defined where it is used")]
    UndefinedValue {
        /// Number of the value.
        value: u32,
    },
    /// A system is solved without the factorisation of its matrix.
    #[error("value {value} is no factorisation of a matrix")]
    NotAFactorisation {
        /// Number of the value.
        value: u32,
    },
    /// The parts of an operation do not follow it directly.
    #[error(
        "value {value}: parts follow the operation that computes them, all of them and in their order"
    )]
    MisplacedPart {
        /// Number of the value.
        value: u32,
    },
    /// A system whose numbers of entries, unknowns and right-hand sides do not fit.
    #[error("system {value}: {found} entries where {expected} belong")]
    SystemShape {
        /// Number of the factorisation or solution.
        value: u32,
        /// Entries that fit its size.
        expected: usize,
        /// Entries found.
        found: usize,
    },
    /// An argument that the model does not have.
    #[error("the function uses {what} {index}, but the model has {len}")]
    UnknownArgument {
        /// State, input or parameter.
        what: &'static str,
        /// Its index.
        index: usize,
        /// How many there are.
        len: usize,
    },
    /// The program lacks the rates.
    #[error("the program has no function {kind:?}")]
    MissingFunction {
        /// Which one.
        kind: FunctionKind,
    },
    /// The compiler failed, or the system gave no memory for code.
    #[error("compilation failed")]
    Compilation(#[from] Box<ModuleError>),
}
