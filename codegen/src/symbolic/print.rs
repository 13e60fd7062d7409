//! Expressions for people: Unicode text, `LaTeX` and `MathML`.
//!
//! A [`Setter`] makes a formula of an expression: the order of terms and factors, what becomes a
//! quotient, where brackets are needed. [`text()`], [`latex()`] and [`mathml()`] write a formula.

mod formula;
mod latex;
mod letter;
mod math;
pub(crate) mod mathml;
mod text;

pub use formula::{Formula, Setter, Spelled, Vocabulary};
pub use latex::latex;
pub use letter::Letter;
pub use math::Math;
pub use mathml::mathml;
pub use text::text;

pub(crate) use formula::{assemble, visible};
pub(crate) use latex::latex_text;
pub(crate) use letter::superscript;
pub(crate) use text::{clean, columns};
