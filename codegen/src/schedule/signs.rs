//! Chooses which values are computed with the opposite sign, so that few are negated.
//!
//! A difference can be written either way round, and so can a product with a number or with such a
//! difference. What a sum subtracts or adds costs the same. A result or an argument of a function
//! that is wanted negative costs a negation.

use super::dag::{Dag, Id, Item, Op};

/// Costs of what is to be avoided.
const NEGATION: usize = 4;
/// A value that comes out with the other sign than its name's is negated or loses its name.
const WRONG_SIGN: usize = 5;
/// A product with a negative number reads worse than one with a positive number.
const MINUS_IN_NAME: usize = 10;

/// So does a number whose minus takes back that of a factor, but less than a negation costs.
const MINUS: usize = 1;

/// How often all candidates are tried: what is flipped first may be better flipped back later.
const ROUNDS: usize = 2;

/// For every node, whether minus its value is wanted.
pub(super) fn choose_signs(dag: &Dag, order: &[Id]) -> Vec<bool> {
    let mut signs = Signs {
        dag,
        order,
        wanted: vec![false; dag.len()],
        built: vec![false; dag.len()],
        wrong: vec![false; dag.len()],
        minus: vec![false; dag.len()],
        labels: vec![None; dag.len()],
    };
    for result in &dag.results {
        let sign = *signs.labels[result.id.index()].get_or_insert(result.flip);
        signs.wanted[result.id.index()] = sign;
    }
    for &id in order {
        if let Some(name) = dag.names[id.index()] {
            signs.wanted[id.index()] = name.negative;
        }
    }
    let mut cost = signs.cost();
    for _ in 0..ROUNDS {
        let before = cost;
        for candidate in signs.candidates() {
            let place = candidate.index();
            signs.wanted[place] = !signs.wanted[place];
            let now = signs.cost();
            if now < cost {
                cost = now;
            } else {
                signs.wanted[place] = !signs.wanted[place];
            }
        }
        if cost == 0 || cost == before {
            break;
        }
        // The signs in `built` are those of the last trial.
        cost = signs.cost();
    }
    signs.wanted
}

/// Whether a value is worth a negation for the sake of its name: a sum, or a product that cannot be
/// told by its factors.
pub(super) fn keeps_its_name(dag: &Dag, id: Id) -> bool {
    match dag.op(id) {
        Op::Sum(_) => true,
        Op::Product(factors) => factors
            .iter()
            .any(|factor| matches!(dag.op(factor.id), Op::Number(_) | Op::Sum(_))),
        _ => false,
    }
}

/// Whether a product has a number, which takes any sign.
fn has_number(dag: &Dag, id: Id) -> bool {
    matches!(dag.op(id), Op::Product(factors) if factors.iter().any(|f| dag.as_number(f.id).is_some()))
}

struct Signs<'a> {
    dag: &'a Dag,
    order: &'a [Id],
    wanted: Vec<bool>,
    /// What the wishes lead to.
    built: Vec<bool>,
    /// What came out with the other sign than its name's.
    wrong: Vec<bool>,
    /// Products whose number is written with a minus.
    minus: Vec<bool>,
    /// The first sign in which a result wants a node.
    labels: Vec<Option<bool>>,
}

impl Signs<'_> {
    fn cost(&mut self) -> usize {
        let dag = self.dag;
        let mut cost = 0;
        for &id in self.order {
            let place = id.index();
            let negative = |item: &Item| item.flip != self.built[item.id.index()];
            let built = match dag.op(id) {
                Op::Number(_) | Op::Argument(_) => continue,
                Op::Sum(terms) => {
                    let minus = terms.iter().filter(|term| negative(term)).count();
                    if self.wanted[place] {
                        minus > 0
                    } else {
                        minus == terms.len()
                    }
                }
                Op::Product(factors) => {
                    let built = factors.iter().filter(|f| self.built[f.id.index()]);
                    let natural = built.count() % 2 == 1;
                    if has_number(dag, id) {
                        // The number is written with a minus.
                        self.minus[place] =
                            self.wanted[place] != natural && self.sign(id).is_none();
                        cost += match (self.minus[place], natural) {
                            (false, _) => 0,
                            (true, true) => MINUS,
                            (true, false) => MINUS_IN_NAME,
                        };
                        self.wanted[place]
                    } else {
                        natural
                    }
                }
                _ => {
                    let mut negations = 0;
                    dag.for_each_part(id, |part| {
                        negations +=
                            usize::from(negative(&part) && dag.as_number(part.id).is_none());
                    });
                    cost += NEGATION * negations;
                    false
                }
            };
            self.built[place] = built;
            self.wrong[place] = self.sign(id).is_some_and(|sign| sign != built);
            if self.wrong[place] {
                cost += WRONG_SIGN;
                // It is negated, or it gives up its name.
                self.built[place] =
                    built != (dag.names[id.index()].is_some() || keeps_its_name(dag, id));
            }
        }
        let results = dag.results.iter().filter(|result| {
            result.flip != self.built[result.id.index()] && dag.as_number(result.id).is_none()
        });
        cost + NEGATION * results.count()
    }

    /// The sign in which a value has its name.
    fn sign(&self, id: Id) -> Option<bool> {
        let derived = self.dag.names[id.index()];
        derived
            .map(|name| name.negative)
            .or(self.labels[id.index()])
    }

    /// Nodes whose opposite could save a negation, those that decide more than one last.
    fn candidates(&self) -> Vec<Id> {
        let dag = self.dag;
        let mut seen = vec![false; dag.len()];
        let mut candidates = Vec::new();
        let mut roots = Vec::new();
        let negative = |item: Item| item.flip != self.built[item.id.index()];
        for &id in self.order {
            if !matches!(dag.op(id), Op::Sum(_) | Op::Product(_)) {
                dag.for_each_part(id, |part| roots.extend(negative(part).then_some(part.id)));
            }
        }
        for &id in self.order {
            // A named sum of the wrong sign is mended by one of its terms, too.
            if self.wrong[id.index()] {
                dag.for_each_part(id, |part| roots.push(part.id));
                roots.push(id);
            }
            roots.extend(self.minus[id.index()].then_some(id));
        }
        roots.extend(
            dag.results
                .iter()
                .filter(|&&result| negative(result))
                .map(|result| result.id),
        );
        while let Some(id) = roots.pop() {
            if std::mem::replace(&mut seen[id.index()], true) {
                continue;
            }
            match dag.op(id) {
                Op::Sum(_) => candidates.push(id),
                Op::Product(factors) => {
                    candidates.push(id);
                    roots.extend(factors.iter().map(|factor| factor.id));
                }
                _ => {}
            }
        }
        candidates
    }
}
