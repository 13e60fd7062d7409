//! The shared graph: every distinct expression is stored once.

use rustc_hash::FxHashMap;

use super::Rational;
use super::expand::operations_of;
use super::node::{Definition, Expr, Node, SymbolId, System};
use super::support::{Support, Supports};

/// Owner of all expressions of a derivation.
#[derive(Debug, Clone)]
pub struct Graph {
    nodes: Vec<Node>,
    /// Symbols on which each node depends.
    supports: Vec<Support>,
    sets: Supports,
    /// Operations of each node without its operands.
    costs: Vec<u32>,
    index: FxHashMap<Node, Expr>,
    symbols: Vec<String>,
    definitions: Vec<Definition>,
    names: FxHashMap<Expr, Expr>,
    systems: Vec<System>,
    system_index: FxHashMap<System, u32>,
    /// Term counts that the expansion of these expressions is known to exceed.
    pub(super) too_long: FxHashMap<Expr, usize>,
}

impl Default for Graph {
    fn default() -> Self {
        Self::new()
    }
}

impl Graph {
    /// The number 0.
    pub const ZERO: Expr = Expr(0);
    /// The number 1.
    pub const ONE: Expr = Expr(1);

    /// A graph that holds the numbers 0 and 1.
    pub fn new() -> Self {
        let mut graph = Self {
            nodes: Vec::new(),
            supports: Vec::new(),
            sets: Supports::default(),
            costs: Vec::new(),
            index: FxHashMap::default(),
            symbols: Vec::new(),
            definitions: Vec::new(),
            names: FxHashMap::default(),
            systems: Vec::new(),
            system_index: FxHashMap::default(),
            too_long: FxHashMap::default(),
        };
        graph.intern(Node::Number(Rational::ZERO));
        graph.intern(Node::Number(Rational::ONE));
        graph
    }

    /// The expression of a node that is already canonical.
    pub(super) fn intern(&mut self, node: Node) -> Expr {
        if let Some(&expr) = self.index.get(&node) {
            return expr;
        }
        let id =
            u32::try_from(self.nodes.len()).expect("fewer than 2^32 expressions fit in memory");
        self.nodes.push(node.clone());
        let support = self.support_of_new(Expr(id));
        self.supports.push(support);
        self.costs.push(operations_of(&node));
        self.index.insert(node, Expr(id));
        Expr(id)
    }

    /// The node of an expression.
    pub fn node(&self, expr: Expr) -> &Node {
        &self.nodes[expr.0 as usize]
    }

    /// The number of expressions in the graph.
    pub fn len(&self) -> usize {
        self.nodes.len()
    }

    /// Never: a graph contains at least two numbers.
    pub fn is_empty(&self) -> bool {
        self.nodes.is_empty()
    }

    /// A new symbol. Two symbols of the same name are different symbols.
    #[expect(clippy::missing_panics_doc, reason = "memory ends before the indices")]
    pub fn symbol(&mut self, name: &str) -> Expr {
        let id = u32::try_from(self.symbols.len()).expect("fewer than 2^32 symbols fit in memory");
        self.symbols.push(name.to_owned());
        self.intern(Node::Symbol(SymbolId(id)))
    }

    /// Name of a symbol.
    pub fn symbol_name(&self, symbol: SymbolId) -> &str {
        &self.symbols[symbol.0 as usize]
    }

    /// The number of symbols; their ids count from 0.
    pub fn symbol_count(&self) -> usize {
        self.symbols.len()
    }

    /// The symbol that an expression consists of, if any.
    pub fn as_symbol(&self, expr: Expr) -> Option<SymbolId> {
        match self.node(expr) {
            Node::Symbol(id) => Some(*id),
            _ => None,
        }
    }

    /// The number that an expression consists of, if any.
    pub fn as_number(&self, expr: Expr) -> Option<&Rational> {
        match self.node(expr) {
            Node::Number(value) => Some(value),
            _ => None,
        }
    }

    /// Gives an intermediate quantity a name, which emitted code and printed equations use.
    ///
    /// Numbers, symbols and multiples of them are returned unchanged, and a quantity that has a name keeps
    /// it, so that no two names denote the same value.
    pub fn name(&mut self, name: &str, value: Expr) -> Expr {
        self.define(name, value, false)
    }

    /// [`Graph::name`] for a generated intermediate quantity, such as a derivative.
    pub fn name_automatically(&mut self, name: &str, value: Expr) -> Expr {
        self.define(name, value, true)
    }

    /// Gives a quantity the name of an existing definition.
    pub(super) fn name_like(&mut self, definition: u32, value: Expr) -> Expr {
        let Definition {
            name, automatic, ..
        } = self.definition(definition).clone();
        self.define(&name, value, automatic)
    }

    fn define(&mut self, name: &str, value: Expr, automatic: bool) -> Expr {
        let plain = |graph: &Self, expr: Expr| {
            matches!(
                graph.node(expr),
                Node::Number(_) | Node::Symbol(_) | Node::Named(_)
            )
        };
        let core = match self.node(value) {
            Node::Sum(terms) if terms.len() == 1 => terms[0].expr,
            _ => value,
        };
        if plain(self, core) {
            return value;
        }
        if let Some(&named) = self.names.get(&value) {
            return named;
        }
        let id =
            u32::try_from(self.definitions.len()).expect("fewer than 2^32 names fit in memory");
        self.definitions.push(Definition {
            name: name.to_owned(),
            value,
            automatic,
        });
        let named = self.intern(Node::Named(id));
        self.names.insert(value, named);
        named
    }

    /// Definition behind the index of [`Node::Named`].
    pub fn definition(&self, index: u32) -> &Definition {
        &self.definitions[index as usize]
    }

    /// The named expression that denotes `value`, if it has a name.
    pub fn name_of(&self, value: Expr) -> Option<Expr> {
        self.names.get(&value).copied()
    }

    /// The definition of a named expression.
    pub fn named_value(&self, expr: Expr) -> Option<Expr> {
        match self.node(expr) {
            Node::Named(id) => Some(self.definition(*id).value),
            _ => None,
        }
    }

    /// Unknowns of `matrix · unknowns = right`, solved with pivoting when evaluated.
    ///
    /// # Panics
    ///
    /// If the matrix has not as many rows and columns as there are right-hand sides.
    pub fn solve_numerically(&mut self, matrix: Vec<Expr>, right: Vec<Expr>) -> Vec<Expr> {
        assert_eq!(
            matrix.len(),
            right.len() * right.len(),
            "the system is square"
        );
        if right.iter().all(|&r| r == Self::ZERO) {
            return right;
        }
        let rows = u32::try_from(right.len()).expect("a system is small");
        let system = System {
            matrix: matrix.into(),
            right: right.into(),
        };
        let id = if let Some(&id) = self.system_index.get(&system) {
            id
        } else {
            let id =
                u32::try_from(self.systems.len()).expect("fewer than 2^32 systems fit in memory");
            self.systems.push(system.clone());
            self.system_index.insert(system, id);
            id
        };
        (0..rows)
            .map(|row| self.intern(Node::Solution { system: id, row }))
            .collect()
    }

    /// System behind the index of [`Node::Solution`].
    pub fn system(&self, index: u32) -> &System {
        &self.systems[index as usize]
    }

    /// All unknowns of a system.
    pub(super) fn unknowns(&mut self, system: u32) -> Vec<Expr> {
        let rows = (0..).take(self.system(system).right.len());
        rows.map(|row| self.intern(Node::Solution { system, row }))
            .collect()
    }

    /// Calls `visit` with every direct operand of `expr`. Definitions of names and the entries of the systems
    /// of solutions count as operands.
    pub fn for_each_part(&self, expr: Expr, mut visit: impl FnMut(Expr)) {
        match self.node(expr) {
            Node::Number(_) | Node::Symbol(_) => {}
            Node::Named(id) => visit(self.definition(*id).value),
            Node::Sum(terms) => terms.iter().for_each(|t| visit(t.expr)),
            Node::Product(factors) => factors.iter().for_each(|f| visit(f.base)),
            Node::Function(_, a) => visit(*a),
            Node::Atan2(a, b) | Node::Power(a, b) => [*a, *b].into_iter().for_each(visit),
            Node::Choice {
                compared, branches, ..
            } => {
                compared.iter().chain(branches).for_each(|&e| visit(e));
            }
            Node::Solution { system, .. } => {
                let system = self.system(*system);
                system
                    .matrix
                    .iter()
                    .chain(&system.right)
                    .for_each(|&e| visit(e));
            }
        }
    }

    /// All subexpressions of `roots`, operands before users, each once.
    pub fn in_order(&self, roots: &[Expr]) -> Vec<Expr> {
        self.in_order_where(roots, |_| true)
    }

    /// [`Graph::in_order`] without the expressions that fail `wanted` and their subexpressions.
    pub(super) fn in_order_where(
        &self,
        roots: &[Expr],
        wanted: impl Fn(Expr) -> bool,
    ) -> Vec<Expr> {
        // Operands are older than users, so no index exceeds the roots'.
        let newest = roots.iter().max().map_or(0, |root| root.0 as usize);
        let mut visited = Marks(vec![0; newest / 64 + 1]);
        let mut order = Vec::new();
        // Explicit stack: deep expressions must not overflow the call stack.
        let mut stack: Vec<(Expr, bool)> = roots.iter().rev().map(|&r| (r, false)).collect();
        while let Some((expr, parts_done)) = stack.pop() {
            if parts_done {
                order.push(expr);
            } else if wanted(expr) && visited.set(expr) {
                stack.push((expr, true));
                self.for_each_part(expr, |part| {
                    if !visited.holds(part) {
                        stack.push((part, false));
                    }
                });
            }
        }
        order
    }

    /// Whether any of `symbols` occurs in `expr` syntactically.
    pub fn mentions(&self, expr: Expr, symbols: &[SymbolId]) -> bool {
        let support = self.support(expr);
        symbols
            .iter()
            .any(|&symbol| self.sets.holds(support, symbol))
    }

    /// Whether a node is a part of another one.
    pub fn has_as_part(&self, expr: Expr) -> bool {
        let mut found = false;
        for whole in (0..).map(Expr).take(self.nodes.len()) {
            self.for_each_part(whole, |part| found |= part == expr);
        }
        found
    }

    /// Whether an expression may contain a subexpression with this support.
    pub(super) fn may_hold(&self, expr: Expr, part: Support) -> bool {
        self.sets.contains(self.support(expr), part)
    }

    /// The symbols on which an expression depends.
    pub(super) fn support(&self, expr: Expr) -> Support {
        self.supports[expr.0 as usize]
    }

    /// The number of additions, multiplications, divisions and function calls that compute `roots`, with
    /// shared subexpressions counted once. Names cost nothing and are transparent. Signs are free, a
    /// comparison counts as one.
    pub fn operations(&self, roots: &[Expr]) -> usize {
        let newest = roots.iter().max().map_or(0, |root| root.0 as usize);
        let mut visited = Marks(vec![0; newest / 64 + 1]);
        let mut systems: Vec<u32> = Vec::new();
        let mut stack: Vec<Expr> = roots.to_vec();
        let mut count = 0;
        while let Some(expr) = stack.pop() {
            if !visited.set(expr) {
                continue;
            }
            count += self.costs[expr.0 as usize] as usize;
            // Elimination and back substitution, counted once per system.
            if let Node::Solution { system, .. } = self.node(expr)
                && !systems.contains(system)
            {
                systems.push(*system);
                let n = self.system(*system).right.len();
                count += (2 * n * n * n).div_ceil(3) + 2 * n * n;
            }
            self.for_each_part(expr, |part| {
                if !visited.holds(part) {
                    stack.push(part);
                }
            });
        }
        count
    }

    /// Whether an expression needs no operations: a number, a symbol, or a name or the negative of one.
    pub fn is_free(&self, mut expr: Expr) -> bool {
        loop {
            expr = match self.node(expr) {
                Node::Number(_) | Node::Symbol(_) => return true,
                Node::Named(id) => self.definition(*id).value,
                Node::Sum(terms) if self.costs[expr.0 as usize] == 0 => terms[0].expr,
                _ => return false,
            };
        }
    }

    fn support_of_new(&mut self, expr: Expr) -> Support {
        if let Node::Symbol(symbol) = self.node(expr) {
            return self.sets.of(*symbol);
        }
        let mut parts = Vec::new();
        self.for_each_part(expr, |part| parts.push(self.support(part)));
        let sets = &mut self.sets;
        parts
            .into_iter()
            .fold(Support::default(), |all, part| sets.union(all, part))
    }
}

/// A set of expressions as a bit vector.
struct Marks(Vec<u64>);

impl Marks {
    fn holds(&self, Expr(index): Expr) -> bool {
        self.0[index as usize / 64] >> (index % 64) & 1 == 1
    }

    /// Adds an expression; false if it was already present.
    fn set(&mut self, expr: Expr) -> bool {
        let fresh = !self.holds(expr);
        self.0[expr.0 as usize / 64] |= 1 << (expr.0 % 64);
        fresh
    }
}
