//! From expressions to a [`Tape`] of few operations with readable names; it knows no target language.
//!
//! | file | pass |
//! |---|---|
//! | `lower.rs`, `dag.rs` | the symbolic graph as a working graph of n-ary sums and products |
//! | `search.rs`, `preference.rs` | several orders of the rewriting passes; the cheapest result |
//! | `factor.rs`, `gather.rs` | common factors; distribution where the parts are available |
//! | `share.rs` | common-subexpression elimination inside sums and products |
//! | `cancel.rs`, `divide.rs` | cancelled denominators; shared reciprocals |
//! | `scale.rs`, `signs.rs` | positions of numeric factors and signs |
//! | `meet.rs` | global value numbering at random points of the prime field; names of the derivation restored |
//! | `rebuild.rs` | dead-code elimination and merging, after every pass |
//! | `names.rs`, `monomial.rs` | identifiers of arguments, constants, values and products |
//! | `bind.rs`, `outline.rs`, `piece.rs` | named values, their order, paragraphs and width |
//! | `pi.rs` | numbers that are multiples of π |

mod bind;
mod cancel;
mod dag;
mod divide;
mod factor;
mod gather;
mod lower;
mod meet;
mod monomial;
pub(crate) mod names;
mod outline;
pub(crate) mod pi;
pub(crate) mod piece;
mod preference;
mod rebuild;
mod scale;
mod search;
mod share;
mod signs;

pub use pi::pi;

use crate::program::{self, Program};
use crate::tape::Tape;

/// The operations of one function of a program, their number minimised heuristically.
///
/// # Panics
/// If an expression contains a symbol that is not an argument of the program, which would be a bug of the
/// derivation.
pub fn schedule(program: &Program, function: &program::Function) -> Tape {
    let derived = lower::lower(program, function);
    let cheapest = search::cheapest(&derived);
    let hints = meet::known_values(&cheapest, &lower::hints(program, function));
    bind::bind(program, function, &cheapest, hints)
}
