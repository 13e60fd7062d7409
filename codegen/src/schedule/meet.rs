//! Global value numbering modulo commutativity, associativity and distributivity: merges `sin θ (m a - n b)`
//! and `m a sin θ - n b sin θ`, which different passes produce, and restores the names of the derivation.
//!
//! Value numbers are evaluations at two random points of a prime field of 61 bits. Different sums
//! and products of degree `d` collide with probability at most `(d/p)²`; other functions are
//! treated as independent unknowns, so no identity between them is used.

use std::hash::{Hash, Hasher};

use rustc_hash::{FxHashMap, FxHasher};

use super::dag::{Dag, Id, Item, Name, Op};
use crate::symbolic::field::Element;

/// A value at both points, up to sign.
pub(super) type Value = [Element; 2];

/// What is known by value, up to sign.
pub(super) struct Known<T>(FxHashMap<Value, (T, bool)>);

impl<T: Copy> Known<T> {
    /// The first of these for each value; each with whether it is of minus its value.
    fn of(all: impl IntoIterator<Item = (Option<Value>, T, bool)>) -> Self {
        let mut known = FxHashMap::default();
        for (value, what, negative) in all {
            if let Some((value, sign)) = value.map(without_sign) {
                known.entry(value).or_insert((what, sign != negative));
            }
        }
        Self(known)
    }

    /// What is known of a value, and whether it is of minus the value.
    fn get(&self, value: Value) -> Option<(T, bool)> {
        let (value, sign) = without_sign(value);
        let &(what, other) = self.0.get(&value)?;
        Some((what, sign != other))
    }
}

impl Known<Id> {
    /// The first nodes of all values.
    pub(super) fn nodes<'a>(
        ids: impl IntoIterator<Item = &'a Id>,
        values: &[Option<Value>],
    ) -> Self {
        Self::of(ids.into_iter().map(|&id| (values[id.index()], id, false)))
    }

    /// The node of a value.
    pub(super) fn node(&self, value: Value) -> Option<Item> {
        let (id, flip) = self.get(value)?;
        Some(Item { id, flip })
    }
}

/// Positions of the nodes in the order.
fn places(dag: &Dag, order: &[Id]) -> Vec<usize> {
    let mut places = vec![0; dag.len()];
    for (position, id) in order.iter().enumerate() {
        places[id.index()] = position;
    }
    places
}

/// Merges nodes of equal value into the first of them. Returns whether any were merged.
pub(super) fn meet(dag: &mut Dag, order: &[Id]) -> bool {
    let values = values(dag, order);
    let (place, known) = (places(dag, order), Known::nodes(order, &values));
    let mut any = false;
    for &id in order {
        let Some(first) = values[id.index()].and_then(|value| known.node(value)) else {
            continue;
        };
        if first.id == id || !can_give_way(dag, id) {
            continue;
        }
        // The shorter form is used if its operands precede the first node.
        let mut before = true;
        dag.for_each_part(id, |part| {
            before &= place[part.id.index()] < place[first.id.index()];
        });
        if before && !first.flip && parts(dag, id) < parts(dag, first.id) {
            let shorter = dag.op(id).clone();
            dag.replace(first.id, shorter);
        }
        dag.replace(id, Op::Sum(vec![first]));
        any = true;
    }
    any
}

/// Longer sums and products are skipped: the number of pairs is quadratic in the length.
const LONGEST: usize = 12;

/// Replaces two factors, or two terms, by their product, or sum, where that is available. Returns
/// whether anything changed.
pub(super) fn meet_in_parts(dag: &mut Dag, order: &[Id]) -> bool {
    let values = values(dag, order);
    let (place, known) = (places(dag, order), Known::nodes(order, &values));
    // A replaced node no longer represents its value.
    let mut gone = vec![false; dag.len()];
    let mut any = false;
    for (position, &id) in order.iter().enumerate() {
        let (items, product) = match dag.op(id) {
            Op::Product(items) => (items, true),
            Op::Sum(items) => (items, false),
            _ => continue,
        };
        if gone[id.index()] || !(3..=LONGEST).contains(&items.len()) {
            continue;
        }
        let items = items.clone();
        let found = pairs(items.len()).find_map(|(i, j)| {
            let whole = whole_of([items[i], items[j]], product, &values)?;
            let whole = known.node(whole)?;
            let (other, place) = (whole.id, place[whole.id.index()]);
            let usable = other != id
                && !gone[other.index()]
                && (place < position || can_give_way(dag, other));
            usable.then_some((i, j, whole))
        });
        let Some((i, j, mut together)) = found else {
            continue;
        };
        let Item { id: other, flip } = together;
        if place[other.index()] > position {
            // The other node comes later: both use a new node.
            let pair = vec![items[i], items[j]];
            let node = if product {
                dag.product(pair)
            } else {
                dag.sum(pair)
            };
            if node.id != other {
                dag.replace(other, Op::Sum(vec![node.flipped_if(flip)]));
                gone[other.index()] = true;
            }
            together = node;
        }
        let mut rest = items;
        rest.remove(j);
        rest.remove(i);
        let new = if product {
            rest.push(Item::plain(together.id));
            dag.product(rest).flipped_if(together.flip)
        } else {
            rest.push(together);
            dag.sum(rest)
        };
        dag.replace(id, Op::Sum(vec![new]));
        gone[id.index()] = true;
        any = true;
    }
    any
}

/// Writes a sum as a multiple of an available node: `a (b c) + d (b e)` becomes `b` times the
/// available sum `a c + d e`. Returns whether anything changed.
pub(super) fn meet_in_multiples(dag: &mut Dag, order: &[Id]) -> bool {
    let values = values(dag, order);
    let sums = || order.iter().filter(|&&id| matches!(dag.op(id), Op::Sum(_)));
    let known = Known::nodes(sums(), &values);
    let mut multiples = Vec::new();
    for &id in sums() {
        let Some(whole) = values[id.index()] else {
            continue;
        };
        let found = factors_inside(dag, id).into_iter().find_map(|factor| {
            let other = known.node(over(whole, values[factor.index()]?)?)?;
            (other.id != id).then_some((id, factor, other))
        });
        multiples.extend(found);
    }
    let mut any = false;
    for (id, factor, other) in multiples {
        if made_of(dag, &[other.id, factor], id) {
            continue;
        }
        let product = dag.product(vec![Item::plain(factor), Item::plain(other.id)]);
        dag.replace(id, Op::Sum(vec![product.flipped_if(other.flip)]));
        any = true;
    }
    any
}

/// Whether `nodes` depend on `part`; rewriting `part` in terms of them would then create a cycle.
pub(super) fn made_of(dag: &Dag, nodes: &[Id], part: Id) -> bool {
    let (mut seen, mut found) = (vec![false; dag.len()], false);
    dag.visit_from(nodes, &mut seen, |node| found |= node == part);
    found
}

/// Candidates for a factor common to all terms of a sum: factors nested in its first term.
fn factors_inside(dag: &Dag, sum: Id) -> Vec<Id> {
    let Op::Sum(terms) = dag.op(sum) else {
        return Vec::new();
    };
    let mut factors = Vec::new();
    let mut open: Vec<Id> = terms.iter().take(1).map(|term| term.id).collect();
    while let Some(id) = open.pop() {
        factors.push(id);
        if let Op::Product(inner) = dag.op(id)
            && open.len() + factors.len() < LONGEST
        {
            open.extend(inner.iter().filter(|item| !item.flip).map(|item| item.id));
        }
    }
    factors
}

/// Redirects uses of displayed values to their opaque nodes, so that equal expressions have equal
/// operands. Returns whether there are opaque nodes.
pub(super) fn refer_to_kept(dag: &mut Dag, order: &[Id]) -> bool {
    let mut kept: FxHashMap<Id, Id> = FxHashMap::default();
    for &id in order {
        if let Op::Kept(inner) = dag.op(id) {
            kept.insert(*inner, id);
        }
    }
    if kept.is_empty() {
        return false;
    }
    for &id in order {
        let (Op::Sum(items) | Op::Product(items)) = dag.op(id) else {
            continue;
        };
        if !items.iter().any(|item| kept.contains_key(&item.id)) {
            continue;
        }
        let items = items.iter().map(|item| Item {
            id: kept.get(&item.id).copied().unwrap_or(item.id),
            flip: item.flip,
        });
        let items = items.collect();
        let op = match dag.op(id) {
            Op::Sum(_) => Op::Sum(items),
            _ => Op::Product(items),
        };
        dag.replace(id, op);
    }
    true
}

/// Index pairs of a list.
fn pairs(length: usize) -> impl Iterator<Item = (usize, usize)> {
    (1..length).flat_map(|j| (0..j).map(move |i| (i, j)))
}

/// Value of the product or the sum of two operands.
fn whole_of([a, b]: [Item; 2], product: bool, values: &[Option<Value>]) -> Option<Value> {
    let part = |item: Item| {
        let value = values[item.id.index()]?;
        Some(match (item.flip, product) {
            (false, _) => value,
            (true, false) => value.map(|v| -v),
            (true, true) => inverse(value)?,
        })
    };
    let ([a, b], [c, d]) = (part(a)?, part(b)?);
    Some(if product {
        [a * c, b * d]
    } else {
        [a + c, b + d]
    })
}

fn can_give_way(dag: &Dag, id: Id) -> bool {
    matches!(dag.op(id), Op::Sum(_) | Op::Product(_))
}

/// Restores the derivation's names of nodes by value number.
pub(super) fn name_again(dag: &mut Dag, derived: &Dag) {
    let order = derived.order();
    let known = values(derived, &order);
    let names = order.into_iter().filter_map(|id| {
        let name = derived.names[id.index()]?;
        Some((known[id.index()], name, name.negative))
    });
    let names = Known::of(names);
    let order = dag.order();
    let values = values(dag, &order);
    for id in order {
        if dag.names[id.index()].is_none()
            && can_give_way(dag, id)
            && let Some((name, negative)) = values[id.index()].and_then(|value| names.get(value))
        {
            dag.names[id.index()] = Some(Name { negative, ..name });
        }
    }
}

/// For each node that equals a result of another graph up to sign: the result's index, and whether
/// it is minus the node.
pub(super) fn known_values(dag: &Dag, hints: &Dag) -> Vec<Option<(usize, bool)>> {
    let hinted = values(hints, &hints.order());
    let results = hints.results.iter().enumerate();
    let results = results.filter(|(_, item)| can_give_way(hints, item.id));
    let known =
        Known::of(results.map(|(number, item)| (hinted[item.id.index()], number, item.flip)));
    let order = dag.order();
    let values = values(dag, &order);
    let mut found = vec![None; dag.len()];
    for id in order.into_iter().filter(|&id| can_give_way(dag, id)) {
        found[id.index()] = values[id.index()].and_then(|value| known.get(value));
    }
    found
}

/// Number of operands of a sum or a product; 0 for other nodes.
fn parts(dag: &Dag, id: Id) -> usize {
    match dag.op(id) {
        Op::Sum(items) | Op::Product(items) => items.len(),
        _ => 0,
    }
}

/// The one of `±value` whose first component is in the lower half, and whether the sign changed.
fn without_sign([first, second]: Value) -> (Value, bool) {
    let (first, flip) = first.without_sign();
    ([first, if flip { -second } else { second }], flip)
}

/// The quotient of two values.
pub(super) fn over([a, b]: Value, other: Value) -> Option<Value> {
    let [c, d] = inverse(other)?;
    Some([a * c, b * d])
}

/// An inverse costs some seventy multiplications: one is shared by both points.
fn inverse([a, b]: Value) -> Option<Value> {
    let both = (a * b).inverse()?;
    Some([both * b, both * a])
}

/// Values of the nodes; `None` where a point gives a division by zero.
pub(super) fn values(dag: &Dag, order: &[Id]) -> Vec<Option<Value>> {
    let mut values: Vec<Option<Value>> = vec![None; dag.len()];
    for &id in order {
        values[id.index()] = value(dag, id, &values);
    }
    values
}

fn value(dag: &Dag, id: Id, values: &[Option<Value>]) -> Option<Value> {
    let signed = |item: &Item| {
        let value = values[item.id.index()]?;
        Some(if item.flip { value.map(|v| -v) } else { value })
    };
    let unknown = |tag: u64, items: &[Item]| {
        let parts: Option<Vec<Value>> = items.iter().map(signed).collect();
        Some(draw((tag, parts?)))
    };
    match dag.op(id) {
        Op::Number(number) => Element::from_rational(number).map(|value| [value; 2]),
        Op::Argument(argument) => Some(draw(argument)),
        Op::Sum(terms) => terms.iter().try_fold([Element::ZERO; 2], |[a, b], term| {
            let [c, d] = signed(term)?;
            Some([a + c, b + d])
        }),
        Op::Product(factors) => factors
            .iter()
            .try_fold([Element::ONE; 2], |[a, b], factor| {
                let value = values[factor.id.index()]?;
                let [c, d] = if factor.flip { inverse(value)? } else { value };
                Some([a * c, b * d])
            }),
        // Opaque.
        Op::Kept(inner) => values[inner.index()].map(|inner| draw((4_u64, inner))),
        Op::Function(function, argument) => {
            let argument = signed(argument)?;
            Some(draw((function, argument)))
        }
        Op::Atan2(items) => unknown(0, items),
        Op::Power(items) => unknown(1, items),
        Op::Choice(relation, items) => {
            let [left, right, then, otherwise] = items.each_ref().map(signed);
            Some(draw((relation, [left?, right?, then?, otherwise?])))
        }
        Op::Solution { system, row } => {
            let system = &dag.systems[*system as usize];
            let matrix = unknown(2, &system.matrix)?;
            let right = unknown(3, &system.right)?;
            Some(draw((matrix, right, row)))
        }
    }
}

/// The pseudo-random value of an unknown, identical in every run.
fn draw(of: impl Hash) -> Value {
    [1_u64, 2].map(|point| {
        let mut hasher = FxHasher::default();
        (point, &of).hash(&mut hasher);
        // The finaliser of MurmurHash3 improves the distribution of the hash bits.
        let mut bits = hasher.finish();
        bits = (bits ^ (bits >> 33)).wrapping_mul(0xff51_afd7_ed55_8ccd);
        bits = (bits ^ (bits >> 33)).wrapping_mul(0xc4ce_b9fe_1a85_ec53);
        Element::new(bits ^ (bits >> 33))
    })
}
