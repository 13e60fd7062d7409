//! Normalises a rewritten graph: eliminates dead nodes, merges identical ones, and flattens nested
//! single-use sums and products.

use super::dag::{Dag, Id, Item, Name, Op, System};

/// Which named values are flattened like unnamed ones.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Dissolve {
    /// Unnamed ones only.
    Unnamed,
    /// Named ones too, if they have one use.
    Named,
}

/// The same results in a normalised graph.
pub(super) fn rebuild(dag: &Dag, dissolve: Dissolve) -> Dag {
    let order = dag.order();
    let mut rebuilding = Rebuilding {
        old: dag,
        uses: dag.uses(&order),
        dissolve,
        new: Dag::with_capacity(dag.len()),
        known: vec![None; dag.len()],
        systems: vec![None; dag.systems.len()],
    };
    for id in order {
        let item = rebuilding.node(id);
        rebuilding.known[id.index()] = Some(item);
        rebuilding.hand_on_name(id, item);
    }
    let results = dag
        .results
        .iter()
        .map(|&result| rebuilding.item(result))
        .collect();
    let mut new = rebuilding.new;
    new.results = results;
    new
}

struct Rebuilding<'a> {
    old: &'a Dag,
    uses: Vec<u32>,
    dissolve: Dissolve,
    new: Dag,
    known: Vec<Option<Item>>,
    systems: Vec<Option<u32>>,
}

impl Rebuilding<'_> {
    /// The new operand of an old one whose flip is a sign.
    fn item(&self, old: Item) -> Item {
        self.known[old.id.index()]
            .unwrap_or(old)
            .flipped_if(old.flip)
    }

    /// Whether an operand is flattened into its user. A name prevents this only if the operand is
    /// large enough to be displayed by itself.
    fn dissolves(&self, id: Id) -> bool {
        let small = || matches!(self.old.op(id), Op::Product(factors) if factors.len() <= 2);
        let named = self.old.names[id.index()].is_some_and(|name| !name.automatic);
        self.uses[id.index()] == 1 && (self.dissolve == Dissolve::Named || !named || small())
    }

    fn node(&mut self, id: Id) -> Item {
        let op = match self.old.op(id) {
            Op::Number(value) => return self.new.number(value),
            Op::Argument(argument) => Op::Argument(*argument),
            Op::Sum(terms) => {
                let mut sum = Vec::with_capacity(terms.len());
                for &term in terms {
                    let item = self.item(term);
                    match self.new.op(item.id) {
                        Op::Sum(inner) if self.dissolves(term.id) => {
                            sum.extend(inner.iter().map(|part| part.flipped_if(item.flip)));
                        }
                        _ => sum.push(item),
                    }
                }
                return self.new.sum(sum);
            }
            Op::Product(factors) => {
                let mut negative = false;
                let mut product = Vec::with_capacity(factors.len());
                for factor in factors {
                    let item = self.item(Item::plain(factor.id));
                    negative ^= item.flip;
                    match self.new.op(item.id) {
                        Op::Product(inner) if self.dissolves(factor.id) => {
                            product.extend(inner.iter().map(|part| part.flipped_if(factor.flip)));
                        }
                        _ => product.push(Item {
                            id: item.id,
                            flip: factor.flip,
                        }),
                    }
                }
                return self.new.product(product).flipped_if(negative);
            }
            Op::Function(function, argument) => {
                let argument = self.item(*argument);
                return self.new.function(*function, argument);
            }
            Op::Kept(inner) => return self.kept(*inner),
            Op::Atan2(items) => Op::Atan2(items.map(|item| self.item(item))),
            Op::Power(items) => Op::Power(items.map(|item| self.item(item))),
            Op::Choice(relation, items) => Op::Choice(*relation, items.map(|item| self.item(item))),
            Op::Solution { system, row } => Op::Solution {
                system: self.system(*system),
                row: *row,
            },
        };
        Item::plain(self.new.intern(op))
    }

    fn kept(&mut self, inner: Id) -> Item {
        let item = self.item(Item::plain(inner));
        self.new.kept(item)
    }

    fn system(&mut self, index: u32) -> u32 {
        if let Some(known) = self.systems[index as usize] {
            return known;
        }
        let old = &self.old.systems[index as usize];
        let items = |parts: &[Item]| parts.iter().map(|&part| self.item(part)).collect();
        let system = System {
            matrix: items(&old.matrix),
            right: items(&old.right),
        };
        let known = self.new.systems.iter().position(|other| *other == system);
        let position = known.unwrap_or_else(|| {
            self.new.systems.push(system);
            self.new.systems.len() - 1
        });
        let number = u32::try_from(position).unwrap_or(u32::MAX);
        self.systems[index as usize] = Some(number);
        number
    }

    fn hand_on_name(&mut self, old: Id, new: Item) {
        let Some(name) = self.old.names[old.index()] else {
            return;
        };
        // A function node needs no generated name.
        let says_itself = name.automatic && matches!(self.new.op(new.id), Op::Function(..));
        let place = &mut self.new.names[new.id.index()];
        if place.is_none() && !says_itself {
            *place = Some(Name {
                definition: name.definition,
                automatic: name.automatic,
                negative: name.negative != new.flip,
            });
        }
    }
}
