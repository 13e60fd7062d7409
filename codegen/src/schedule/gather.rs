//! Takes a factor out of two terms where what remains of one of them is known already: with `l x`
//! at hand, `h l x - h y` becomes `h (l x - y)`.
//!
//! [`super::factor`] opens a product only where nothing else uses it. Here `h l` may be shared: it
//! is the quotient that counts, and quotients are known by their values.

use rustc_hash::FxHashMap;

use super::dag::{Dag, Id, Item, Op};
use super::factor::without;
use super::meet::{Value, over, values, without_sign};

/// Takes factors out. Tells whether there were any; every one saves a multiplication.
pub(super) fn gather(dag: &mut Dag, order: &[Id]) -> bool {
    let quotients = Quotients::of(dag, order);
    let mut found = Vec::new();
    for &sum in order {
        if let Op::Sum(terms) = dag.op(sum)
            && let Some(common) = quotients.common(terms)
        {
            found.push((sum, common));
        }
    }
    for (sum, common) in &found {
        take_out(dag, *sum, common);
    }
    !found.is_empty()
}

/// Two terms with a common factor.
struct Common {
    factor: Item,
    /// What is known once the factor is taken out of it.
    term: Item,
    quotient: Item,
    /// What has the factor in sight.
    other: Item,
}

/// The nodes by their values, which tell what is known without a factor.
struct Quotients<'d> {
    dag: &'d Dag,
    uses: Vec<u32>,
    values: Vec<Option<Value>>,
    known: FxHashMap<Value, (Id, bool)>,
}

impl<'d> Quotients<'d> {
    fn of(dag: &'d Dag, order: &[Id]) -> Self {
        let values = values(dag, order);
        let mut known = FxHashMap::default();
        for &id in order {
            if let Some((value, sign)) = values[id.index()].map(without_sign) {
                known.entry(value).or_insert((id, sign));
            }
        }
        Self {
            dag,
            uses: dag.uses(order),
            values,
            known,
        }
    }

    /// The first two products of a sum with a common factor, one of which is known without it.
    fn common(&self, terms: &[Item]) -> Option<Common> {
        let products = || terms.iter().filter(|term| self.factors(**term).is_some());
        let pairs = products().flat_map(|term| products().map(move |other| (*term, *other)));
        let mut pairs = pairs.filter(|(term, other)| term != other);
        pairs.find_map(|(term, other)| {
            let mut factors = self.factors(other)?.iter().filter(|factor| !factor.flip);
            factors.find_map(|&factor| {
                Some(Common {
                    factor,
                    term,
                    quotient: self.quotient(term, factor.id)?,
                    other,
                })
            })
        })
    }

    /// The factors of a product that one sum alone needs: its multiplication goes.
    fn factors(&self, term: Item) -> Option<&'d [Item]> {
        match self.dag.op(term.id) {
            Op::Product(factors) if self.uses[term.id.index()] == 1 => Some(factors),
            _ => None,
        }
    }

    /// What is known of a term without a factor that is somewhere inside it.
    fn quotient(&self, term: Item, factor: Id) -> Option<Item> {
        if !is_inside(self.dag, factor, term.id) {
            return None;
        }
        let quotient = over(self.values[term.id.index()]?, self.values[factor.index()]?)?;
        let (value, sign) = without_sign(quotient);
        let &(id, other) = self.known.get(&value)?;
        let flip = term.flip ^ (sign != other);
        Some(Item { id, flip })
    }
}

fn take_out(dag: &mut Dag, sum: Id, common: &Common) {
    let (Op::Sum(terms), Op::Product(factors)) = (dag.op(sum), dag.op(common.other.id)) else {
        return;
    };
    let mut outer = terms.clone();
    outer.retain(|term| *term != common.term && *term != common.other);
    let rest = without(factors, common.factor);
    let rest = dag.product(rest).flipped_if(common.other.flip);
    let inner = dag.sum(vec![common.quotient, rest]);
    let product = dag.product(vec![common.factor, Item::plain(inner.id)]);
    outer.push(product.flipped_if(inner.flip));
    dag.replace(sum, Op::Sum(outer));
}

/// Whether a factor is one of the factors of a product, or of the products it is made of.
fn is_inside(dag: &Dag, factor: Id, product: Id) -> bool {
    match dag.op(product) {
        Op::Product(factors) => factors
            .iter()
            .any(|item| !item.flip && (item.id == factor || is_inside(dag, factor, item.id))),
        _ => false,
    }
}
