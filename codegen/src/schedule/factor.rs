//! Factors sums: `m·R·x + m·R·y` becomes `m·R·(x + y)`.

use super::dag::{Dag, Id, Item, Op};
use super::preference::Preference;

/// Extracts common factors from all sums, the most frequent first. Only single-use products are
/// opened, so every step saves multiplications. Returns whether anything was extracted.
pub(super) fn factor(dag: &mut Dag, order: &[Id], preference: Preference, least: u32) -> bool {
    let mut any = false;
    let mut uses = dag.uses(order);
    for &id in order {
        let mut sums = vec![id];
        while let Some(sum) = sums.pop() {
            while let Some((factor, members)) = best_factor(dag, &uses, sum, preference, least) {
                sums.extend(take_out(dag, &mut uses, sum, factor, &members));
                any = true;
            }
        }
    }
    any
}

/// The factor common to most terms, and the indices of these terms. `None` if no two terms have a
/// common factor.
fn best_factor(
    dag: &Dag,
    uses: &[u32],
    sum: Id,
    preference: Preference,
    least: u32,
) -> Option<(Item, Vec<usize>)> {
    let Op::Sum(terms) = dag.op(sum) else {
        return None;
    };
    let mut occurrences: Vec<(Item, usize)> = Vec::new();
    for (position, term) in terms.iter().enumerate() {
        if let Some(factors) = opened(dag, uses, term.id) {
            occurrences.extend(factors.iter().map(|&factor| (factor, position)));
        }
    }
    occurrences.sort_unstable();
    // A square counts once.
    occurrences.dedup();
    let best = occurrences
        .chunk_by(|a, b| a.0 == b.0)
        .filter(|group| group.len() >= least.max(2) as usize)
        .max_by_key(|group| (group.len(), preference.rank(group[0].0)))?;
    Some((
        best[0].0,
        best.iter().map(|&(_, position)| position).collect(),
    ))
}

/// The factors of a product that is used by a single sum.
fn opened<'a>(dag: &'a Dag, uses: &[u32], id: Id) -> Option<&'a [Item]> {
    match dag.op(id) {
        Op::Product(factors)
            if factors.len() >= 2
                && uses.get(id.index()).is_none_or(|&uses| uses <= 1)
                && dag.names[id.index()].is_none() =>
        {
            Some(factors)
        }
        _ => None,
    }
}

/// Rewrites `sum` with `factor` extracted from `members`, and returns the sum in the parentheses.
fn take_out(
    dag: &mut Dag,
    uses: &mut Vec<u32>,
    sum: Id,
    factor: Item,
    members: &[usize],
) -> Option<Id> {
    let Op::Sum(terms) = dag.op(sum).clone() else {
        return None;
    };
    let mut inner = Vec::with_capacity(members.len());
    let mut outer = Vec::with_capacity(terms.len());
    for (position, term) in terms.iter().enumerate() {
        if members.contains(&position) {
            let rest = match dag.op(term.id) {
                Op::Product(factors) => without(factors, factor),
                _ => Vec::new(),
            };
            let rest = dag.product(rest);
            note_use(uses, rest.id);
            inner.push(rest.flipped_if(term.flip));
        } else {
            outer.push(*term);
        }
    }
    let inner = dag.sum(inner);
    note_use(uses, inner.id);
    let product = dag.product(vec![factor, Item::plain(inner.id)]);
    note_use(uses, product.id);
    outer.push(product.flipped_if(inner.flip));
    dag.replace(sum, Op::Sum(outer));
    Some(inner.id)
}

/// The factors without one occurrence of `factor`.
pub(super) fn without(factors: &[Item], factor: Item) -> Vec<Item> {
    let mut rest = factors.to_vec();
    if let Some(position) = rest.iter().position(|&other| other == factor) {
        rest.remove(position);
    }
    rest
}

/// Counts one more use of a node that may be new.
fn note_use(uses: &mut Vec<u32>, id: Id) {
    if uses.len() <= id.index() {
        uses.resize(id.index() + 1, 0);
    }
    uses[id.index()] += 1;
}
