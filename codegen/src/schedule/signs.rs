//! Sign assignment: chooses the values to be computed with the opposite sign, minimising negations.
//!
//! A difference can be computed in either order, and so can a product with a number or with such a
//! difference. Addition and subtraction in a sum cost the same. A result or function argument of
//! the opposite sign costs a negation.

use std::collections::BTreeSet;

use super::dag::{Dag, Id, Item, Op};

/// Costs of undesired signs.
const NEGATION: usize = 4;
/// A value whose sign differs from that of its name is negated or renamed.
const WRONG_SIGN: usize = 5;
/// A product with a negative number is less readable than one with a positive number.
const MINUS_IN_NAME: usize = 10;

/// So is a number whose minus cancels that of a factor, at less than the cost of a negation.
const MINUS: usize = 1;

/// Passes over all candidates: an early flip may be worth undoing after later ones.
const ROUNDS: usize = 2;

/// For every node, whether minus its value is to be computed.
pub(super) fn choose_signs(dag: &Dag, order: &[Id]) -> Vec<bool> {
    let mut signs = Signs::new(dag, order);
    for _ in 0..ROUNDS {
        let before = signs.cost;
        for candidate in signs.candidates() {
            signs.flip_if_cheaper(candidate);
        }
        if signs.cost == 0 || signs.cost == before {
            break;
        }
    }
    signs.wanted
}

/// Whether a value is negated to keep its name: a sum, or a product that its factors alone do not
/// identify.
pub(super) fn keeps_its_name(dag: &Dag, id: Id) -> bool {
    match dag.op(id) {
        Op::Sum(_) => true,
        Op::Product(factors) => factors
            .iter()
            .any(|factor| matches!(dag.op(factor.id), Op::Number(_) | Op::Sum(_))),
        _ => false,
    }
}

/// Whether a product has a numeric factor, which can absorb any sign.
fn has_number(dag: &Dag, id: Id) -> bool {
    matches!(dag.op(id), Op::Product(factors) if factors.iter().any(|f| dag.as_number(f.id).is_some()))
}

struct Signs<'a> {
    dag: &'a Dag,
    order: &'a [Id],
    /// Position of each node in the order.
    places: Vec<usize>,
    /// The users of each node.
    users: Vec<Vec<Id>>,
    /// By node: how many results require it with its own sign, and how many with the opposite sign.
    results: Vec<[usize; 2]>,
    wanted: Vec<bool>,
    /// The state that the requested signs imply for each node.
    states: Vec<State>,
    /// The sign in which the first result requires a node.
    labels: Vec<Option<bool>>,
    /// Total over all nodes.
    cost: usize,
}

/// The state that the requested signs imply for a node.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
struct State {
    /// Whether minus its value is computed.
    built: bool,
    /// Whether its sign differed from that of its name.
    wrong: bool,
    /// Whether it is a product whose number is written with a minus.
    minus: bool,
    cost: usize,
}

impl<'a> Signs<'a> {
    fn new(dag: &'a Dag, order: &'a [Id]) -> Self {
        let mut signs = Self {
            dag,
            order,
            places: vec![0; dag.len()],
            users: vec![Vec::new(); dag.len()],
            results: vec![[0; 2]; dag.len()],
            wanted: vec![false; dag.len()],
            states: vec![State::default(); dag.len()],
            labels: vec![None; dag.len()],
            cost: 0,
        };
        for result in &dag.results {
            let place = result.id.index();
            signs.wanted[place] = *signs.labels[place].get_or_insert(result.flip);
            signs.results[place][usize::from(result.flip)] += 1;
        }
        for (place, &id) in order.iter().enumerate() {
            if let Some(name) = dag.names[id.index()] {
                signs.wanted[id.index()] = name.negative;
            }
            signs.places[id.index()] = place;
            dag.for_each_part(id, |part| signs.users[part.id.index()].push(id));
        }
        for &id in order {
            let state = signs.state(id);
            signs.cost += state.cost;
            signs.states[id.index()] = state;
        }
        signs
    }

    fn built(&self, id: Id) -> bool {
        self.states[id.index()].built
    }

    /// Requests the opposite sign of a node and propagates this to its users; reverted unless the
    /// cost decreases.
    fn flip_if_cheaper(&mut self, candidate: Id) {
        let before = self.cost;
        let mut undone = Vec::new();
        self.wanted[candidate.index()] ^= true;
        // In topological order, so that the operands of a node are final before it.
        let mut open = BTreeSet::from([self.places[candidate.index()]]);
        while let Some(place) = open.pop_first() {
            let id = self.order[place];
            let (old, new) = (self.states[id.index()], self.state(id));
            if old == new {
                continue;
            }
            undone.push((id, old));
            self.cost = self.cost - old.cost + new.cost;
            self.states[id.index()] = new;
            if old.built != new.built {
                open.extend(
                    self.users[id.index()]
                        .iter()
                        .map(|user| self.places[user.index()]),
                );
            }
        }
        if self.cost >= before {
            self.wanted[candidate.index()] ^= true;
            for (id, old) in undone {
                self.states[id.index()] = old;
            }
            self.cost = before;
        }
    }

    /// The state of a node, given those of its operands.
    fn state(&self, id: Id) -> State {
        let (dag, place) = (self.dag, id.index());
        let negative = |item: &Item| item.flip != self.built(item.id);
        let mut state = State::default();
        if matches!(dag.op(id), Op::Number(_)) {
            return state;
        }
        state.built = match dag.op(id) {
            Op::Number(_) | Op::Argument(_) => false,
            Op::Sum(terms) => {
                let minus = terms.iter().filter(|term| negative(term)).count();
                if self.wanted[place] {
                    minus > 0
                } else {
                    minus == terms.len()
                }
            }
            Op::Product(factors) => {
                let built = factors.iter().filter(|f| self.built(f.id));
                let natural = built.count() % 2 == 1;
                if has_number(dag, id) {
                    // The number is written with a minus.
                    state.minus = self.wanted[place] != natural && self.sign(id).is_none();
                    state.cost += match (state.minus, natural) {
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
                dag.for_each_part(id, |part| {
                    if negative(&part) && dag.as_number(part.id).is_none() {
                        state.cost += NEGATION;
                    }
                });
                false
            }
        };
        let is_value = !matches!(dag.op(id), Op::Argument(_));
        if is_value && self.sign(id).is_some_and(|sign| sign != state.built) {
            state.wrong = true;
            state.cost += WRONG_SIGN;
            // It is negated, or loses its name.
            state.built ^= dag.names[place].is_some() || keeps_its_name(dag, id);
        }
        let [as_it_is, opposite] = self.results[place];
        state.cost += NEGATION * if state.built { as_it_is } else { opposite };
        state
    }

    /// Whether the name of a node denotes minus its value.
    fn sign(&self, id: Id) -> Option<bool> {
        let derived = self.dag.names[id.index()];
        derived
            .map(|name| name.negative)
            .or(self.labels[id.index()])
    }

    /// Nodes whose opposite could save a negation.
    fn candidates(&self) -> Vec<Id> {
        let dag = self.dag;
        let mut seen = vec![false; dag.len()];
        let mut candidates = Vec::new();
        let mut roots = Vec::new();
        let negative = |item: Item| item.flip != self.built(item.id);
        for &id in self.order {
            if !matches!(dag.op(id), Op::Sum(_) | Op::Product(_)) {
                dag.for_each_part(id, |part| roots.extend(negative(part).then_some(part.id)));
            }
        }
        for &id in self.order {
            // A named sum of the wrong sign can also be fixed in one of its terms.
            if self.states[id.index()].wrong {
                dag.for_each_part(id, |part| roots.push(part.id));
                roots.push(id);
            }
            roots.extend(self.states[id.index()].minus.then_some(id));
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
