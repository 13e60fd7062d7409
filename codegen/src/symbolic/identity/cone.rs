//! Dependencies of an expression: its symbols and square roots.

use rustc_hash::FxHashMap;

use super::super::{Expr, Function, Graph, Node};
use super::point::symbol_bit;

/// By expression: a superset of its symbols and the set of its radicands. Sets of radicands are numbered,
/// since most expressions share a few of them.
#[derive(Debug, Clone)]
pub(super) struct Cones {
    symbols: Vec<u64>,
    roots: Vec<u32>,
    sets: Vec<Box<[Expr]>>,
    set_index: FxHashMap<Box<[Expr]>, u32>,
    unions: FxHashMap<(u32, u32), u32>,
}

impl Default for Cones {
    fn default() -> Self {
        Self {
            symbols: Vec::new(),
            roots: Vec::new(),
            sets: vec![Box::default()],
            set_index: std::iter::once((Box::default(), Self::NO_ROOTS)).collect(),
            unions: FxHashMap::default(),
        }
    }
}

impl Cones {
    /// The empty set of radicands.
    pub(super) const NO_ROOTS: u32 = 0;

    /// Adds the expressions that are new in the graph, which stores operands before users.
    pub(super) fn extend(&mut self, g: &Graph) {
        for index in self.symbols.len()..g.len() {
            let Ok(id) = u32::try_from(index) else { return };
            let expr = Expr(id);
            let (mut symbols, mut roots) = (0, Self::NO_ROOTS);
            g.for_each_part(expr, |part| {
                symbols |= self.symbols[part.0 as usize];
                roots = self.union(roots, self.roots[part.0 as usize]);
            });
            match g.node(expr) {
                Node::Symbol(symbol) => symbols |= symbol_bit(*symbol),
                // The exponent may be a half behind names. Roots of numbers are constants.
                Node::Function(Function::Sqrt, base) | Node::Power(base, _)
                    if g.as_number(*base).is_none() =>
                {
                    let own = self.set([*base].into());
                    roots = self.union(roots, own);
                }
                _ => {}
            }
            self.symbols.push(symbols);
            self.roots.push(roots);
        }
    }

    /// A superset of the symbols of an expression, as bits.
    pub(super) fn symbols(&self, expr: Expr) -> u64 {
        self.symbols[expr.0 as usize]
    }

    /// [`Cones::symbols`] of all expressions.
    pub(super) fn all_symbols(&self) -> &[u64] {
        &self.symbols
    }

    /// The index of an expression's set of radicands.
    pub(super) fn roots(&self, expr: Expr) -> u32 {
        self.roots[expr.0 as usize]
    }

    /// A set of radicands, operands before users.
    pub(super) fn radicands(&self, set: u32) -> &[Expr] {
        &self.sets[set as usize]
    }

    /// The union of two sets.
    pub(super) fn union(&mut self, a: u32, b: u32) -> u32 {
        if a == b || b == Self::NO_ROOTS {
            return a;
        }
        if a == Self::NO_ROOTS {
            return b;
        }
        let pair = (a.min(b), a.max(b));
        if let Some(&known) = self.unions.get(&pair) {
            return known;
        }
        let mut all = [self.radicands(a), self.radicands(b)].concat();
        all.sort_unstable();
        all.dedup();
        let union = self.set(all.into());
        self.unions.insert(pair, union);
        union
    }

    fn set(&mut self, radicands: Box<[Expr]>) -> u32 {
        if let Some(&known) = self.set_index.get(&radicands) {
            return known;
        }
        let id = u32::try_from(self.sets.len()).unwrap_or(u32::MAX);
        self.sets.push(radicands.clone());
        self.set_index.insert(radicands, id);
        id
    }
}
