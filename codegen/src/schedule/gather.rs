//! Factoring and distribution with available expressions. If `l x` is available, `h l x - h y` becomes
//! `h (l x - y)`; if `m a` and `m b` are available, `m (a + b) + c` becomes `m a + m b + c`.
//!
//! [`super::factor`] opens only single-use products. Here `h l` may be shared: the quotient has to
//! be available, which is looked up by its value number.

use super::dag::{Dag, Id, Item, Op};
use super::factor::without;
use super::meet::{Known, Value, made_of, over, values};

/// Factors sums. Returns whether anything changed; every step saves a multiplication.
pub(super) fn gather(dag: &mut Dag, order: &[Id]) -> bool {
    let known = Available::of(dag, order);
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

/// Distributes products whose expanded terms are all available. Returns whether anything changed;
/// every step saves a multiplication.
pub(super) fn scatter(dag: &mut Dag, order: &[Id]) -> bool {
    let known = Available::of(dag, order);
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
    /// The available quotient of one term by the factor.
    term: Item,
    quotient: Item,
    /// The term in which the factor is explicit.
    other: Item,
}

/// The nodes by value number.
struct Available<'d> {
    dag: &'d Dag,
    uses: Vec<u32>,
    values: Vec<Option<Value>>,
    nodes: Known<Id>,
}

impl<'d> Available<'d> {
    fn of(dag: &'d Dag, order: &[Id]) -> Self {
        let values = values(dag, order);
        Self {
            dag,
            uses: dag.uses(order),
            nodes: Known::nodes(order, &values),
            values,
        }
    }

    /// The first two products of a sum with a common factor, one of them with an available
    /// quotient.
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

    /// The factors of a product used by one sum only, whose multiplication is then saved.
    fn factors(&self, term: Item) -> Option<&'d [Item]> {
        match self.dag.op(term.id) {
            Op::Product(factors) if self.uses[term.id.index()] == 1 => Some(factors),
            _ => None,
        }
    }

    /// The available quotient of a term by a factor nested in it.
    fn quotient(&self, term: Item, factor: Id) -> Option<Item> {
        if !is_inside(self.dag, factor, term.id) {
            return None;
        }
        let quotient = over(self.values[term.id.index()]?, self.values[factor.index()]?)?;
        Some(self.nodes.node(quotient)?.flipped_if(term.flip))
    }

    /// The terms with one product distributed.
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

    /// The products of a factor with all terms of a single-use sum.
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
            Some(self.nodes.node([a * c, b * d])?.flipped_if(term.flip))
        };
        terms.iter().map(product).collect()
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

/// Whether a factor occurs in a product, directly or through nested products.
fn is_inside(dag: &Dag, factor: Id, product: Id) -> bool {
    match dag.op(product) {
        Op::Product(factors) => factors
            .iter()
            .any(|item| !item.flip && (item.id == factor || is_inside(dag, factor, item.id))),
        _ => false,
    }
}
