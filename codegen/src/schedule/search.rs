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

/// The cheapest equivalent graph found. What is cheaper by nothing stays as derived.
pub(super) fn cheapest(derived: &Dag) -> Dag {
    use Pass::{Factor, Products, Sums};
    const ORDERS: [[Pass; 3]; 3] =
        [[Factor, Products, Sums], [Products, Factor, Sums], [Factor, Sums, Products]];
    let mut best = finish(&rebuild(derived, Dissolve::Unnamed));
    let mut least = best.weight(DIVISION);
    for dissolve in [Dissolve::Unnamed, Dissolve::Named] {
        let start = rebuild(derived, dissolve);
        for passes in ORDERS {
            for preference in [Preference::Early, Preference::Late] {
                let candidate = finish(&rewritten(&start, passes, preference));
                let weight = candidate.weight(DIVISION);
                if weight < least {
                    (best, least) = (candidate, weight);
                }
            }
        }
    }
    best
}

/// All passes, again and again while they help.
fn rewritten(start: &Dag, passes: [Pass; 3], preference: Preference) -> Dag {
    let mut dag = start.clone();
    let mut weight = dag.weight(DIVISION);
    for _ in 0..ROUNDS {
        for pass in passes {
            match pass {
                Pass::Factor => factor(&mut dag, preference),
                Pass::Products => share(&mut dag, Within::Products, preference),
                Pass::Sums => share(&mut dag, Within::Sums, preference),
            }
            dag = rebuild(&dag, Dissolve::Unnamed);
        }
        let now = dag.weight(DIVISION);
        if now >= weight {
            break;
        }
        weight = now;
    }
    dag
}

fn finish(dag: &Dag) -> Dag {
    let mut dag = dag.clone();
    share_reciprocals(&mut dag);
    rebuild(&dag, Dissolve::Unnamed)
}
