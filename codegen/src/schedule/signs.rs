//! Chooses which values are computed with the opposite sign, so that few are negated.
//!
//! A difference can be written either way round, and so can a product with a number or with such a
//! difference. What a sum subtracts or adds costs the same. A result or an argument of a function
//! that is wanted negative costs a negation.

use super::dag::{Dag, Id, Item, Op};

/// Costs of what is to be avoided.
const NEGATION: usize = 4;
/// A named value computed negative has to be called minus its name.
const MINUS_NAME: usize = 1;

/// For every node, whether minus its value is wanted.
pub(super) fn choose_signs(dag: &Dag, order: &[Id]) -> Vec<bool> {
    let mut signs = Signs {
        dag,
        order,
        wanted: vec![false; dag.len()],
        built: vec![false; dag.len()],
    };
    for &id in order {
        if let Some(name) = dag.names[id.index()] {
            signs.wanted[id.index()] = name.negative;
        }
    }
    let mut cost = signs.cost();
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
    signs.wanted
}

struct Signs<'a> {
    dag: &'a Dag,
    order: &'a [Id],
    wanted: Vec<bool>,
    /// What the wishes lead to.
    built: Vec<bool>,
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
                    let numbers = factors
                        .iter()
                        .any(|factor| dag.as_number(factor.id).is_some());
                    if numbers {
                        self.wanted[place]
                    } else {
                        factors
                            .iter()
                            .filter(|factor| self.built[factor.id.index()])
                            .count()
                            % 2
                            == 1
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
            if dag.names[place].is_some_and(|name| name.negative != built) {
                cost += MINUS_NAME;
            }
            self.built[place] = built;
        }
        let results = dag.results.iter().filter(|result| {
            result.flip != self.built[result.id.index()] && dag.as_number(result.id).is_none()
        });
        cost + NEGATION * results.count()
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
