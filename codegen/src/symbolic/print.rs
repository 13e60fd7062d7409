//! Typesets expressions as Unicode text, `LaTeX` and `MathML`.
//!
//! A [`Setter`] converts an expression to a formula: it orders terms and factors, forms quotients and inserts
//! brackets. [`text()`], [`latex()`] and [`mathml()`] write a formula.

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
