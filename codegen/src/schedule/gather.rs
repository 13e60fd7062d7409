//! Distributivity where parts are known already. With `l x` at hand, `h l x - h y` becomes
//! `h (l x - y)`; with `m a` and `m b` at hand, `m (a + b) + c` becomes `m a + m b + c`.
//!
//! [`super::factor`] opens a product only where nothing else uses it. Here `h l` may be shared: it
//! is the quotient that counts, and quotients are known by their values.

use rustc_hash::FxHashMap;

use super::dag::{Dag, Id, Item, Op};
use super::factor::without;
use super::meet::{Value, made_of, over, values, without_sign};

/// Takes factors out. Tells whether there were any; every one saves a multiplication.
pub(super) fn gather(dag: &mut Dag, order: &[Id]) -> bool {
    let known = Known::of(dag, order);
    let mut found = Vec::new();
    for &sum in order {
        if let Op::Sum(terms) = dag.op(sum)
            && let Some(common) = known.common(terms)
        {
            found.push((sum, common));
        }
    }
    let mut any = false;
    for (sum, common) in &found {
        if !made_of(dag, &[common.quotient.id], *sum) {
            take_out(dag, *sum, common);
            any = true;
        }
    }
    any
}

/// Multiplies products out whose terms are all known. Tells whether there were any; every one saves
/// a multiplication.
pub(super) fn scatter(dag: &mut Dag, order: &[Id]) -> bool {
    let known = Known::of(dag, order);
    let mut found = Vec::new();
    for &sum in order {
        if let Op::Sum(terms) = dag.op(sum)
            && let Some(scattered) = known.scattered(terms)
        {
            found.push((sum, scattered));
        }
    }
    let mut any = false;
    for (sum, terms) in found {
        let parts: Vec<Id> = terms.iter().map(|term| term.id).collect();
        if !made_of(dag, &parts, sum) {
            dag.replace(sum, Op::Sum(terms));
            any = true;
        }
    }
    any
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

/// The nodes by their values.
struct Known<'d> {
    dag: &'d Dag,
    uses: Vec<u32>,
    values: Vec<Option<Value>>,
    nodes: FxHashMap<Value, (Id, bool)>,
}

impl<'d> Known<'d> {
    fn of(dag: &'d Dag, order: &[Id]) -> Self {
        let values = values(dag, order);
        let mut nodes = FxHashMap::default();
        for &id in order {
            if let Some((value, sign)) = values[id.index()].map(without_sign) {
                nodes.entry(value).or_insert((id, sign));
            }
        }
        Self {
            dag,
            uses: dag.uses(order),
            values,
            nodes,
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
        Some(self.node(quotient)?.flipped_if(term.flip))
    }

    /// The terms with one product multiplied out.
    fn scattered(&self, terms: &[Item]) -> Option<Vec<Item>> {
        terms.iter().enumerate().find_map(|(place, &term)| {
            let [a, b] = self.factors(term)? else {
                return None;
            };
            let products = self.products(*a, *b).or_else(|| self.products(*b, *a))?;
            let mut scattered = terms.to_vec();
            scattered.remove(place);
            scattered.extend(products.into_iter().map(|item| item.flipped_if(term.flip)));
            Some(scattered)
        })
    }

    /// The products of a factor with all terms of a sum that nothing else needs.
    fn products(&self, factor: Item, sum: Item) -> Option<Vec<Item>> {
        let Op::Sum(terms) = self.dag.op(sum.id) else {
            return None;
        };
        if factor.flip || sum.flip || self.uses[sum.id.index()] != 1 {
            return None;
        }
        let [a, b] = self.values[factor.id.index()]?;
        let product = |term: &Item| {
            let [c, d] = self.values[term.id.index()]?;
            Some(self.node([a * c, b * d])?.flipped_if(term.flip))
        };
        terms.iter().map(product).collect()
    }

    fn node(&self, value: Value) -> Option<Item> {
        let (value, sign) = without_sign(value);
        let &(id, other) = self.nodes.get(&value)?;
        let flip = sign != other;
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
