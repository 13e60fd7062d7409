//! Divisions are dear: what divides more than one product gets one reciprocal.

use super::dag::{Dag, Id, Item, Op};

/// Replaces divisions by multiplications with shared reciprocals. A denominator that only one
/// product has stays a division, together with the other denominators of that product.
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

/// What a node divides by, each once.
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
