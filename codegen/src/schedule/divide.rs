//! Reduces the cost of divisions: a divisor of several products gets one shared reciprocal,
//! independent denominators share one division, and a division on the critical path is started
//! early.

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

/// Most denominators that share a division. Their product must stay far from overflow, in single
/// precision too.
const MOST: usize = 3;

/// Computes the reciprocals of up to three denominators from one: with `j = 1/(a·b)`, `1/a = j·b`
/// and `1/b = j·a`. Three multiplications replace a division, which takes longer.
///
/// Sines, cosines and other functions are excluded. Where one of them vanishes, a coordinate is
/// singular, and this must not affect values that do not depend on the coordinate.
pub(super) fn join_divisions(dag: &mut Dag, order: &[Id]) {
    let bases = independent_denominators(dag, order);
    for group in bases.chunks(MOST) {
        if group.len() >= 2 {
            let reciprocals = joint_reciprocals(dag, group);
            for &id in order {
                put_in(dag, id, &reciprocals);
            }
        }
    }
}

/// Denominators that may share a division: none of them depends on another division.
fn independent_denominators(dag: &Dag, order: &[Id]) -> Vec<Id> {
    let mut divided = vec![false; dag.len()];
    let mut bases = Vec::new();
    for &id in order {
        let mut needs_division = false;
        dag.for_each_part(id, |part| needs_division |= divided[part.id.index()]);
        let below = denominators(dag, id);
        divided[id.index()] = needs_division || !below.is_empty();
        bases.extend(below);
    }
    bases.retain(|&base| {
        let function = !matches!(dag.op(base), Op::Sum(_) | Op::Product(_) | Op::Argument(_));
        !function && !divided[base.index()]
    });
    // Each once, in order of first use.
    let mut seen = vec![false; dag.len()];
    bases.retain(|base| !std::mem::replace(&mut seen[base.index()], true));
    bases
}

/// Each denominator with its reciprocal, all from one division.
fn joint_reciprocals(dag: &mut Dag, group: &[Id]) -> Vec<(Id, Id)> {
    let mut products = vec![group[0]];
    for &base in &group[1..] {
        let last = products[products.len() - 1];
        products.push(dag.product(vec![Item::plain(last), Item::plain(base)]).id);
    }
    let last = products[products.len() - 1];
    let mut rest = dag.intern(Op::Product(vec![Item {
        id: last,
        flip: true,
    }]));
    let mut reciprocals = Vec::with_capacity(group.len());
    for position in (1..group.len()).rev() {
        let others = Item::plain(products[position - 1]);
        let reciprocal = dag.product(vec![Item::plain(rest), others]).id;
        reciprocals.push((group[position], reciprocal));
        rest = dag
            .product(vec![Item::plain(rest), Item::plain(group[position])])
            .id;
    }
    reciprocals.push((group[0], rest));
    reciprocals
}

/// Replaces divisions of a product by multiplications with the reciprocals.
fn put_in(dag: &mut Dag, id: Id, reciprocals: &[(Id, Id)]) {
    let Op::Product(factors) = dag.op(id) else {
        return;
    };
    let new: Vec<Item> = factors
        .iter()
        .map(|&factor| {
            let found = reciprocals
                .iter()
                .find(|(base, _)| factor.flip && *base == factor.id);
            found.map_or(factor, |&(_, reciprocal)| Item::plain(reciprocal))
        })
        .collect();
    if new != *factors {
        // A lone reciprocal becomes an alias of the shared one.
        dag.replace(
            id,
            if let [only] = new[..] {
                Op::Sum(vec![only])
            } else {
                Op::Product(new)
            },
        );
    }
}
