//! Expressions for people: Unicode text, `LaTeX` and `MathML`.
//!
//! A [`Setter`] makes a formula of an expression: the order of terms and factors, what becomes a
//! quotient, where brackets are needed. [`text()`], [`latex()`] and [`mathml()`] write a formula.

mod formula;
mod latex;
mod letter;
mod math;
pub mod mathml;
mod text;

pub use formula::{Formula, Setter, Spelled, Vocabulary, assemble, visible};
pub use latex::{latex, latex_text};
pub use letter::{Letter, superscript};
pub use math::Math;
pub use mathml::mathml;
pub use text::{columns, text};
