//! Size limits of a spec, which may come from an untrusted source.

/// Largest file, in bytes.
pub const MAX_FILE: usize = 1 << 20;
/// Most items in one section: those of a robot with hundreds of joints.
pub const MAX_ITEMS: usize = 4096;
/// Most parameters: ten for each of many bodies, and their places.
pub const MAX_PARAMETERS: usize = 4096;
/// Most samples of one signal.
pub const MAX_SAMPLES: usize = 100_000;
/// Longest name, in characters.
pub const MAX_NAME: usize = 64;
/// Longest sentence, in bytes.
pub const MAX_SENTENCE: usize = 500;
/// Most rotations of one frame.
pub const MAX_TURNS: usize = 16;
/// Longest expression, in bytes.
pub const MAX_EXPRESSION: usize = 4096;
/// Deepest expression, in nested operations.
pub const MAX_DEPTH: usize = 128;
/// Maximum number of terms from expanded definitions.
pub const MAX_DEFINED: usize = 1 << 17;
/// Most digits of a number.
pub const MAX_DIGITS: usize = 40;
/// Largest power of ten of a number.
pub const MAX_TEN: i32 = 300;
/// Largest exponent in an expression.
pub const MAX_EXPONENT: i32 = 64;
/// Largest total degree of an expression.
pub const MAX_DEGREE: u32 = 1024;
