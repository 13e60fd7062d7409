//! Reduces the cost of divisions: a divisor of several products gets one shared reciprocal, and a division on the critical
//! path is started early.

use super::dag::{Dag, Id, Item, Op};

/// Replaces divisions by multiplications with shared reciprocals. A denominator of a single product
/// remains a division, combined with the other denominators of that product.
pub(super) fn share_reciprocals(dag: &mut Dag, order: &[Id]) {
    let mut wholes = vec![0_u32; dag.len()];
    for &id in order {
        for base in denominators(dag, id) {
            wholes[base.index()] += 1;
        }
    }
    for &id in order {
        let shared = |base: Id| wholes.get(base.index()).is_some_and(|&count| count >= 2);
        let Op::Product(factors) = dag.op(id) else {
            continue;
        };
        if factors.len() < 2
            || !factors
                .iter()
                .any(|factor| factor.flip && shared(factor.id))
        {
            continue;
        }
        let factors = factors.clone();
        let product = factors
            .into_iter()
            .map(|factor| {
                if factor.flip && shared(factor.id) {
                    Item::plain(dag.intern(Op::Product(vec![factor])))
                } else {
                    factor
                }
            })
            .collect();
        dag.replace(id, Op::Product(product));
    }
}

/// The distinct divisors of a node.
fn denominators(dag: &Dag, id: Id) -> Vec<Id> {
    let Op::Product(factors) = dag.op(id) else {
        return Vec::new();
    };
    let mut below: Vec<Id> = factors
        .iter()
        .filter(|factor| factor.flip)
        .map(|factor| factor.id)
        .collect();
    below.dedup();
    below
}

/// Starts divisions early. Where the dividend is available only after the denominator, computing
/// the reciprocal first costs one more multiplication and removes a division from the critical
/// path.
pub(super) fn divide_early(dag: &mut Dag, order: &[Id], division: usize) {
    let depths = depths(dag, order, division);
    for &id in order {
        let Op::Product(factors) = dag.op(id) else {
            continue;
        };
        let (below, above): (Vec<Item>, Vec<Item>) = factors.iter().partition(|factor| factor.flip);
        let ([denominator], Some(dividend)) = (
            below.as_slice(),
            above.iter().map(|factor| depths[factor.id.index()]).max(),
        ) else {
            continue;
        };
        if depths[denominator.id.index()] + division < dividend {
            let denominator = *denominator;
            let reciprocal = Item::plain(dag.intern(Op::Product(vec![denominator])));
            let product = std::iter::once(reciprocal).chain(above).collect();
            dag.replace(id, Op::Product(product));
        }
    }
}

/// Length of the longest path to each node, in operations.
fn depths(dag: &Dag, order: &[Id], division: usize) -> Vec<usize> {
    let mut depths = vec![0; dag.len()];
    for &id in order {
        let mut deepest = 0;
        dag.for_each_part(id, |part| deepest = deepest.max(depths[part.id.index()]));
        depths[id.index()] = deepest
            + match dag.op(id) {
                Op::Number(_) | Op::Argument(_) | Op::Kept(_) => 0,
                Op::Product(factors) if factors.iter().any(|factor| factor.flip) => division,
                Op::Sum(_) | Op::Product(_) | Op::Choice(..) => 1,
                Op::Function(..) | Op::Atan2(_) | Op::Power(_) | Op::Solution { .. } => FUNCTION,
            };
    }
    depths
}

/// Approximate latency of a function or a linear solve, in operations.
const FUNCTION: usize = 10;
