//! Moves numeric factors between sums and their cofactors.
//!
//! `x/(4·a + 12·b)·8` has three multiplications by numbers; `2·x/(a + 3·b)` has two. From every sum
//! the factor is extracted that minimises the number of numeric factors in its terms and uses.

use super::dag::{Dag, Id, Item, Op, System};
use crate::symbolic::Rational;

/// Extracts a number from every unnamed sum where that saves multiplications. Returns whether
/// anything changed.
pub(super) fn scale(dag: &mut Dag, order: &[Id]) -> bool {
    let scales = Scales::choose(dag, order);
    if scales.taken_out.iter().all(Option::is_none) {
        return false;
    }
    // The sums are about to change their values. Hash consing must not return a node that is yet to
    // be rewritten: the number would be extracted from it twice.
    let compound = |op: &Op| !matches!(op, Op::Number(_) | Op::Argument(_) | Op::Solution { .. });
    let derived: Vec<(Id, Op)> = order
        .iter()
        .map(|&id| (id, dag.op(id).clone()))
        .filter(|(_, op)| compound(op))
        .collect();
    for (id, _) in &derived {
        dag.replace(*id, Op::Sum(Vec::new()));
    }
    for (id, op) in derived {
        if scales.taken_out(id).is_some() {
            // The name does not denote the remaining factor.
            dag.names[id.index()] = None;
        }
        let new = scales.rewritten(dag, id, op);
        dag.replace(id, new);
    }
    for index in 0..dag.systems.len() {
        let System { matrix, right } = dag.systems[index].clone();
        let mut whole = |items: Vec<Item>| -> Vec<Item> {
            items
                .into_iter()
                .map(|item| scales.whole(dag, item))
                .collect()
        };
        let (matrix, right) = (whole(matrix), whole(right));
        dag.systems[index] = System { matrix, right };
    }
    for place in 0..dag.results.len() {
        let result = dag.results[place];
        dag.results[place] = scales.whole(dag, result);
    }
    true
}

struct Scales {
    /// The number extracted from a sum: the sum is this number times its replacement.
    taken_out: Vec<Option<Rational>>,
}

impl Scales {
    fn choose(dag: &Dag, order: &[Id]) -> Self {
        let mut taken_out = vec![None; dag.len()];
        let mut coefficients: Vec<Rational> = vec![Rational::ONE; dag.len()];
        let mut wholes: Vec<Vec<Id>> = vec![Vec::new(); dag.len()];
        for &id in order {
            if let Some(value) = coefficient(dag, id) {
                coefficients[id.index()] = value.clone();
            }
            dag.for_each_part(id, |part| wholes[part.id.index()].push(id));
        }
        for result in &dag.results {
            // As a result, a sum has no cofactors.
            wholes[result.id.index()].push(result.id);
        }
        for &id in order {
            let Op::Sum(terms) = dag.op(id) else { continue };
            if dag.names[id.index()].is_some_and(|name| !name.automatic) {
                continue;
            }
            let inside: Vec<&Rational> = terms
                .iter()
                .map(|term| &coefficients[term.id.index()])
                .collect();
            let mut around: Vec<(Rational, i32)> = Vec::new();
            let mut wholes_once = wholes[id.index()].clone();
            wholes_once.dedup();
            for whole in &wholes_once {
                around.push((
                    coefficients[whole.index()].clone(),
                    exponent(dag, *whole, id),
                ));
            }
            let cost = |taken: &Rational| {
                let inverse = taken.recip();
                let inside = inside.iter().filter(|&&value| value != taken).count();
                let outside = around.iter().filter(|(value, exponent)| match exponent {
                    0 => !value.is_one(),
                    1 => *value != inverse,
                    -1 => value != taken,
                    _ => !times(value, taken, *exponent).is_one(),
                });
                inside + outside.count()
            };
            let mut best = (cost(&Rational::ONE), Rational::ONE);
            let candidates = inside.iter().map(|&value| value.clone());
            let inverses = around
                .iter()
                .filter(|(_, e)| e.abs() == 1)
                .map(|(value, exponent)| {
                    if *exponent > 0 {
                        value.recip()
                    } else {
                        value.clone()
                    }
                });
            let possible = candidates
                .chain(inverses)
                .filter(|number| !number.is_zero());
            for candidate in possible {
                let cost = cost(&candidate);
                if cost < best.0 {
                    best = (cost, candidate);
                }
            }
            if !best.1.is_one() {
                for (whole, (value, exponent)) in wholes_once.iter().zip(&around) {
                    if *exponent != 0 {
                        coefficients[whole.index()] = times(value, &best.1, *exponent);
                    }
                }
                taken_out[id.index()] = Some(best.1);
            }
        }
        Self { taken_out }
    }

    fn taken_out(&self, id: Id) -> Option<&Rational> {
        self.taken_out.get(id.index()).and_then(Option::as_ref)
    }

    /// An operand whose flip is a sign, multiplied by the number extracted from it.
    fn whole(&self, dag: &mut Dag, item: Item) -> Item {
        let Some(scale) = self.taken_out(item.id) else {
            return item;
        };
        let number = dag.number(scale);
        dag.product(vec![number, Item::plain(item.id)])
            .flipped_if(item.flip)
    }

    /// The operation of a node whose operands were scaled; the number of the node itself is
    /// extracted, too.
    fn rewritten(&self, dag: &mut Dag, id: Id, op: Op) -> Op {
        match op {
            Op::Number(_) | Op::Argument(_) | Op::Solution { .. } => op,
            Op::Sum(terms) => {
                let own = self.taken_out(id).map(Rational::recip);
                let mut sum = Vec::with_capacity(terms.len());
                for term in terms {
                    let mut item = self.whole(dag, term);
                    if let Some(own) = &own {
                        item = multiplied(dag, item, own);
                    }
                    sum.push(item);
                }
                Op::Sum(sum)
            }
            Op::Product(factors) => {
                let scaled = factors
                    .iter()
                    .filter(|factor| self.taken_out(factor.id).is_some());
                let mut number = Rational::ONE;
                for factor in scaled {
                    if let Some(scale) = self.taken_out(factor.id) {
                        number = &number
                            * &if factor.flip {
                                scale.recip()
                            } else {
                                scale.clone()
                            };
                    }
                }
                if number.is_one() {
                    return Op::Product(factors);
                }
                let number = dag.number(&number);
                let mut factors = factors;
                factors.push(number);
                Op::Sum(vec![dag.product(factors)])
            }
            Op::Function(function, argument) => Op::Function(function, self.whole(dag, argument)),
            // Named sums are not scaled, and opaque values are named.
            Op::Kept(inner) => Op::Kept(inner),
            Op::Atan2(items) => Op::Atan2(items.map(|item| self.whole(dag, item))),
            Op::Power(items) => Op::Power(items.map(|item| self.whole(dag, item))),
            Op::Choice(relation, items) => {
                Op::Choice(relation, items.map(|item| self.whole(dag, item)))
            }
        }
    }
}

/// The number among the factors of a product, or the number that a node represents.
fn coefficient(dag: &Dag, id: Id) -> Option<&Rational> {
    match dag.op(id) {
        Op::Product(factors) => factors.iter().find_map(|factor| dag.as_number(factor.id)),
        Op::Number(value) => Some(value),
        _ => None,
    }
}

/// How often `part` is a factor of `whole`.
fn exponent(dag: &Dag, whole: Id, part: Id) -> i32 {
    let Op::Product(factors) = dag.op(whole) else {
        return 1;
    };
    let same = factors.iter().filter(|factor| factor.id == part);
    same.map(|factor| if factor.flip { -1 } else { 1 }).sum()
}

/// `value · base^exponent`, if the power is short enough to write.
fn times(value: &Rational, base: &Rational, exponent: i32) -> Rational {
    match base.checked_pow(exponent) {
        Some(power) => value * &power,
        None => value.clone(),
    }
}

/// `number · item`, with the number as a factor of a product.
fn multiplied(dag: &mut Dag, item: Item, number: &Rational) -> Item {
    let number = dag.number(number);
    let mut factors = vec![number];
    match dag.op(item.id) {
        Op::Product(inner) if dag.names[item.id.index()].is_none_or(|name| name.automatic) => {
            factors.extend(inner);
        }
        _ => factors.push(Item::plain(item.id)),
    }
    dag.product(factors).flipped_if(item.flip)
}
