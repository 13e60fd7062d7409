//! Names values by their cofactors on the path to the consumer.

use super::Binding;
use crate::schedule::dag::{Id, Item, Op};
use crate::schedule::names::joined;
use crate::tape::{Operation, Value};

impl Binding<'_> {
    /// `consumer_per_a_b`: a value whose only cofactors on the path to the consumer are `a` and
    /// `b`, with the sign of that contribution.
    pub(super) fn by_factors(&self, id: Id, mut negative: bool) -> Option<String> {
        let feed = self.outline.feeds[id.index()]?;
        let mut factors: Vec<&str> = Vec::new();
        let mut part = id;
        while part != feed {
            let whole = self.outline.wholes[part.index()]?;
            match self.dag.op(whole) {
                Op::Product(items) => {
                    for other in others(items, part)? {
                        let built = self.built[other.id.index()].as_ref()?;
                        negative ^= built.negative;
                        factors.push(self.name_of_factor(built.piece.value)?);
                    }
                }
                Op::Sum(items) => {
                    let mut same = items.iter().filter(|item| item.id == part);
                    negative ^= same.next()?.flip;
                    if same.next().is_some() {
                        return None;
                    }
                }
                Op::Kept(_) => {}
                _ => return None,
            }
            part = whole;
        }
        if factors.is_empty() || Some(negative) != self.sign_of_name(feed) {
            return None;
        }
        factors.reverse();
        joined(&[&self.given_name(feed)?, "per", &factors.join("_")])
            .filter(|name| !self.names.has(name))
    }

    /// The name of a factor, unless it is a number or itself a quotient of this kind.
    fn name_of_factor(&self, value: Value) -> Option<&str> {
        let name = match self.tape.unnamed(value) {
            None => self.tape.name(value)?,
            Some(Operation::Argument(argument)) => self.arguments.get(*argument),
            Some(_) => return None,
        };
        (!name.contains("_per_")).then_some(name)
    }
}

/// The cofactors of `part` in a product that has it once; `None` if the product has a divisor.
fn others(factors: &[Item], part: Id) -> Option<impl Iterator<Item = &Item>> {
    let once = factors.iter().filter(|factor| factor.id == part).count() == 1;
    let whole = factors.iter().all(|factor| !factor.flip);
    (once && whole).then(|| factors.iter().filter(move |factor| factor.id != part))
}
