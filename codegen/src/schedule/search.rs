//! Tries several orderings of the passes and returns the cheapest result.

use super::cancel::cancel;
use super::dag::{Dag, Id};
use super::divide::{divide_early, share_reciprocals};
use super::factor::factor;
use super::gather::{gather, scatter};
use super::meet::{meet, meet_in_multiples, meet_in_parts, name_again, refer_to_kept};
use super::preference::Preference;
use super::rebuild::{Dissolve, rebuild};
use super::scale::scale;
use super::share::{Within, share};

/// A rewriting pass.
#[derive(Debug, Clone, Copy)]
enum Pass {
    Factor,
    Products,
    Sums,
}

/// An ordering of passes with its parameters.
#[derive(Debug, Clone, Copy)]
struct Plan {
    /// Which named values are flattened.
    dissolve: Dissolve,
    /// Whether numeric factors are moved first.
    scale: bool,
    /// Passes of a round.
    passes: [Pass; 3],
    preference: Preference,
    /// Minimum number of occurrences for a rewriting, per round.
    levels: &'static [u32],
}

const PRODUCTS_FIRST: Plan = Plan {
    dissolve: Dissolve::Unnamed,
    scale: true,
    passes: [Pass::Products, Pass::Factor, Pass::Sums],
    preference: Preference::Early,
    levels: &[2, 2],
};
const FACTOR_FIRST: Plan = Plan {
    passes: [Pass::Factor, Pass::Products, Pass::Sums],
    ..PRODUCTS_FIRST
};

/// The plans, the most promising ones first.
const PLANS: [Plan; 6] = [
    PRODUCTS_FIRST,
    Plan {
        levels: &[4, 3, 2],
        ..FACTOR_FIRST
    },
    Plan {
        levels: &[3, 2],
        scale: false,
        dissolve: Dissolve::Named,
        ..FACTOR_FIRST
    },
    Plan {
        levels: &[3, 2],
        ..FACTOR_FIRST
    },
    Plan {
        scale: false,
        ..FACTOR_FIRST
    },
    Plan {
        preference: Preference::Late,
        ..PRODUCTS_FIRST
    },
];

/// Cost in operations at which a name from the derivation is valued.
const NAME: usize = 1;

/// Most iterations of value numbering: merging nodes makes further ones equal.
const MEETINGS: usize = 4;

/// Cost of a division in operations.
const DIVISION: usize = 3;
/// Budget of nodes that the search processes: enough to try every plan on small functions; on large ones only the first two
/// plans are tried.
const EFFORT: usize = 400;

/// The cheapest equivalent graph found; on a tie the earlier plan wins.
pub(super) fn cheapest(derived: &Dag) -> Dag {
    let weigh = |dag: &Dag| dag.weight(&dag.order(), DIVISION);
    let mut best = finish(rebuild(derived, Dissolve::Unnamed));
    let mut least = weigh(&best);
    let mut effort = 0;
    for (number, plan) in PLANS.into_iter().enumerate() {
        effort += derived.len() * plan.levels.len();
        if number >= 2 && effort > EFFORT {
            break;
        }
        let candidate = finish(follow(derived, plan));
        let nameless = if plan.dissolve == Dissolve::Named {
            NAME
        } else {
            0
        };
        let weight = weigh(&candidate) + nameless;
        if weight < least {
            (best, least) = (candidate, weight);
        }
    }
    let mut best = merged(best);
    let order = best.order();
    divide_early(&mut best, &order, DIVISION);
    name_again(&mut best, derived);
    best
}

/// Merges nodes of equal value.
fn merged(mut dag: Dag) -> Dag {
    for pass in [refer_to_kept, meet_in_multiples] {
        let order = dag.order();
        if pass(&mut dag, &order) {
            dag = rebuild(&dag, Dissolve::Unnamed);
        }
    }
    for _ in 0..MEETINGS {
        let mut any = false;
        let products =
            |dag: &mut Dag, order: &[Id]| share(dag, order, Within::Products, Preference::Early, 2);
        let sums =
            |dag: &mut Dag, order: &[Id]| share(dag, order, Within::Sums, Preference::Early, 2);
        for pass in [meet, meet_in_parts, products, scatter, gather, sums] {
            let order = dag.order();
            if pass(&mut dag, &order) {
                dag = rebuild(&dag, Dissolve::Unnamed);
                any = true;
            }
        }
        if !any {
            break;
        }
    }
    dag
}

fn follow(derived: &Dag, plan: Plan) -> Dag {
    let mut dag = rebuild(derived, plan.dissolve);
    let mut order = dag.order();
    if cancel(&mut dag, &order) {
        dag = rebuild(&dag, plan.dissolve);
        order = dag.order();
    }
    if plan.scale && scale(&mut dag, &order) {
        dag = rebuild(&dag, plan.dissolve);
        order = dag.order();
    }
    for &level in plan.levels {
        for pass in plan.passes {
            let rewritten = match pass {
                Pass::Factor => factor(&mut dag, &order, plan.preference, level),
                Pass::Products => share(&mut dag, &order, Within::Products, plan.preference, level),
                Pass::Sums => share(&mut dag, &order, Within::Sums, plan.preference, level),
            };
            if rewritten {
                dag = rebuild(&dag, Dissolve::Unnamed);
                order = dag.order();
            }
        }
    }
    dag
}

/// Reciprocals are shared last: the other passes handle divisions directly.
fn finish(mut dag: Dag) -> Dag {
    let order = dag.order();
    share_reciprocals(&mut dag, &order);
    rebuild(&dag, Dissolve::Unnamed)
}
