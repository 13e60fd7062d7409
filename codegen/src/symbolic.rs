//! Exact symbolic algebra on a shared graph; it knows no mechanics.
//!
//! Expressions are canonical: equal sums and products of the same operands are the same node, so equality is
//! comparison of two indices. Nothing is expanded, and the local identities that are applied never make an
//! expression larger. Equality of different forms is decided by evaluation in a finite field ([`identity`]).

mod canonical;
mod common_factors;
mod differentiate;
pub mod dissolve;
mod evaluate;
mod expand;
pub(crate) mod field;
mod fraction;
mod gradient;
mod graph;
pub mod identity;
mod interval;
mod inverse;
mod node;
pub mod print;
mod rational;
mod substitute;
mod support;
pub mod vector;

pub use differentiate::Derivatives;
pub use evaluate::{Evaluation, evaluate};
pub use gradient::gradient;
pub use graph::Graph;
pub use identity::IdentityTest;
pub use interval::{Interval, Intervals};
pub(crate) use node::applied;
pub use node::{Definition, Expr, Factor, Function, Node, Relation, SymbolId, System, Term};
pub use rational::Rational;
pub use substitute::Substitution;
