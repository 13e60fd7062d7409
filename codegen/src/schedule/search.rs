//! Tries several orders of rewriting and keeps the cheapest result.

use super::dag::{Dag, Item};
use super::divide::share_reciprocals;
use super::factor::factor;
use super::rebuild::{Dissolve, rebuild};
use super::share::{Within, share};

/// Which of two equally frequent candidates goes first.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Preference {
    /// The one nearer to the arguments.
    Early,
    /// The one nearer to the results.
    Late,
}

impl Preference {
    /// The higher rank goes first.
    pub(super) fn rank(self, item: Item) -> u64 {
        let position = 2 * item.id.index() as u64 + u64::from(item.flip);
        match self {
            Self::Early => u64::MAX - position,
            Self::Late => position,
        }
    }
}

/// One kind of rewriting.
#[derive(Debug, Clone, Copy)]
enum Pass {
    Factor,
    Products,
    Sums,
}

/// A division takes about as long as so many other operations.
const DIVISION: usize = 4;
/// Rounds of all passes; later rounds find almost nothing.
const ROUNDS: usize = 4;


pub(super) fn cheapest(derived: &Dag) -> Dag {
    use Pass::{Factor, Products, Sums};
    const ORDERS: [[Pass; 3]; 3] =
        [[Factor, Products, Sums], [Products, Factor, Sums], [Sums, Products, Factor]];
    const LEVELS: [&[u32]; 5] = [&[2], &[3, 2], &[4, 3, 2], &[6, 4, 3, 2], &[8, 6, 5, 4, 3, 2]];
    let mut best = finish(&rebuild(derived, Dissolve::Unnamed));
    let mut least = best.weight(DIVISION);
    let dbg = std::env::var("DBG").is_ok();
    if dbg { eprintln!("{least}"); }
    for dissolve in [Dissolve::Unnamed, Dissolve::Named] {
        let mut start = rebuild(derived, dissolve);
        if std::env::var("NOCANCEL").is_err() {
        super::cancel::cancel(&mut start);
        start = rebuild(&start, dissolve);
        }
        if std::env::var("NOSCALE").is_err() {
        super::scale::scale(&mut start);
        start = rebuild(&start, dissolve);
        }
        for passes in ORDERS {
            for preference in [Preference::Early, Preference::Late] {
              if dbg { eprint!("{dissolve:?} {passes:?} {preference:?}"); }
              for levels in LEVELS {
                let candidate = finish(&rewritten(&start, passes, preference, levels));
                let weight = candidate.weight(DIVISION);
                if dbg { eprint!(" {weight}"); }
                if weight < least {
                    (best, least) = (candidate, weight);
                }
              }
              if dbg { eprintln!(); }
            }
        }
    }
    best
}

/// All passes, again and again while they help.
fn rewritten(start: &Dag, passes: [Pass; 3], preference: Preference, levels: &[u32]) -> Dag {
    let mut dag = start.clone();
    for &level in levels {
    for _ in 0..ROUNDS {
        let before = dag.weight(1);
        for pass in passes {
            match pass {
                Pass::Factor => factor(&mut dag, preference, level as usize),
                Pass::Products => share(&mut dag, Within::Products, preference, level),
                Pass::Sums => share(&mut dag, Within::Sums, preference, level),
            }
            dag = rebuild(&dag, Dissolve::Unnamed);
        }
        if dag.weight(1) >= before { break; }
    }
    }
    dag
}

fn finish(dag: &Dag) -> Dag {
    let mut dag = dag.clone();
    share_reciprocals(&mut dag);
    rebuild(&dag, Dissolve::Unnamed)
}
