//! Cancels denominators: `(d·a + b)/d` becomes `a + b/d`.

use super::dag::{Dag, Id, Item, Op};

/// Distributes a division over a sum where this cancels a factor of a term. The reciprocal replaces
/// the product, so no new divisor is introduced. Returns whether anything changed.
pub(super) fn cancel(dag: &mut Dag, order: &[Id]) -> bool {
    let mut any = false;
    let uses = dag.uses(order);
    for &id in order {
        while let Some((sum, divisor, terms)) = candidate(dag, &uses, id) {
            distribute(dag, id, sum, divisor, &terms);
            any = true;
        }
    }
    any
}

/// A product with a single-use sum among its factors: the sum, a divisor of the product, and the
/// positions of the terms that contain the divisor as a factor.
fn candidate(dag: &Dag, uses: &[u32], id: Id) -> Option<(Id, Id, Vec<usize>)> {
    let private = |id: Id| {
        uses.get(id.index()).is_none_or(|&uses| uses == 1) && dag.names[id.index()].is_none()
    };
    let Op::Product(factors) = dag.op(id) else {
        return None;
    };
    for divisor in factors.iter().filter(|factor| factor.flip) {
        for sum in factors
            .iter()
            .filter(|factor| !factor.flip && private(factor.id))
        {
            let Op::Sum(terms) = dag.op(sum.id) else {
                continue;
            };
            let divisible = |term: &Item| match dag.op(term.id) {
                Op::Product(factors) => {
                    private(term.id) && factors.contains(&Item::plain(divisor.id))
                }
                _ => term.id == divisor.id,
            };
            let positions: Vec<usize> = terms
                .iter()
                .enumerate()
                .filter(|(_, term)| divisible(term))
                .map(|(i, _)| i)
                .collect();
            if !positions.is_empty() {
                return Some((sum.id, divisor.id, positions));
            }
        }
    }
    None
}

fn distribute(dag: &mut Dag, product: Id, sum: Id, divisor: Id, positions: &[usize]) {
    let (Op::Product(factors), Op::Sum(terms)) = (dag.op(product).clone(), dag.op(sum).clone())
    else {
        return;
    };
    let reciprocal = Item {
        id: divisor,
        flip: true,
    };
    let (mut whole, mut rest) = (Vec::new(), Vec::new());
    for (position, term) in terms.into_iter().enumerate() {
        if positions.contains(&position) {
            let mut factors = match dag.op(term.id) {
                Op::Product(factors) if term.id != divisor => factors.clone(),
                _ => vec![Item::plain(term.id)],
            };
            factors.push(reciprocal);
            whole.push(dag.product(factors).flipped_if(term.flip));
        } else {
            rest.push(term);
        }
    }
    if !rest.is_empty() {
        let rest = dag.sum(rest);
        whole.push(
            dag.product(vec![Item::plain(rest.id), reciprocal])
                .flipped_if(rest.flip),
        );
    }
    let inner = dag.sum(whole);
    let mut outer: Vec<Item> = factors;
    for gone in [Item::plain(sum), reciprocal] {
        if let Some(position) = outer.iter().position(|&factor| factor == gone) {
            outer.remove(position);
        }
    }
    outer.push(Item::plain(inner.id));
    let new = dag.product(outer).flipped_if(inner.flip);
    dag.replace(product, Op::Sum(vec![new]));
}
