//! Expressions for people: plain text, `LaTeX` and `MathML`.
//!
//! One walk over the graph decides what is written: the order of terms and factors, what becomes a
//! fraction, where parentheses are needed. A [`Notation`] decides how.

mod latex;
mod mathml;
mod name;
mod order;
mod text;

use rustc_hash::FxHashMap;

use super::{Expr, Factor, Function, Graph, Node, Rational, Relation, SymbolId};

pub use latex::Latex;
pub use mathml::MathMl;
pub use name::{GREEK, Name};
pub use text::Text;

/// Longer parts are cut: shared parts can grow beyond all bounds when they are written out.
const MOST_BYTES: usize = 1 << 18;
/// Bytes for all parts of one expression together; beyond, only short ones are written.
const MOST_BYTES_TOGETHER: usize = 1 << 26;
/// What is short.
const FEW_BYTES: usize = 1 << 8;

/// How tightly the outermost operation of a piece binds; what binds less needs parentheses.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Level {
    /// `a + b`, `-a`
    Sum,
    /// `a/b` on one line
    Fraction,
    /// `a b`
    Product,
    /// `sin a`
    Prefix,
    /// `a²`
    Power,
    /// A name, or anything in brackets of its own.
    Atom,
}

/// A written part of an expression.
#[derive(Debug, Clone)]
pub struct Piece {
    /// What is written.
    pub text: String,
    /// What parentheses it needs.
    pub level: Level,
    /// Rank of the symbol in it that comes first.
    first: u32,
}

impl Piece {
    /// A piece about which nothing else is known.
    pub fn new(text: String, level: Level) -> Self {
        Self {
            text,
            level,
            first: u32::MAX,
        }
    }
}

/// A way of writing. Pieces come with the level of their outermost operation; the methods add
/// parentheses where their notation needs them.
pub trait Notation {
    /// In parentheses.
    fn group(&self, text: &str) -> String;
    /// A name.
    fn name(&self, name: &Name) -> Piece;
    /// Digits, perhaps with a decimal point.
    fn digits(&self, digits: &str) -> String;
    /// Terms, each with whether it is subtracted.
    fn sum(&self, terms: &[(bool, Piece)]) -> String;
    /// At least two factors.
    fn product(&self, factors: &[Piece]) -> String;
    /// A quotient of two products; neither is empty.
    fn fraction(&self, over: &[Piece], under: &[Piece]) -> Piece;
    /// An integer power.
    fn power(&self, base: &Piece, exponent: u32) -> Piece;
    /// Any other power.
    fn general_power(&self, base: &Piece, exponent: &Piece) -> Piece;
    /// A function, to a power from 1 on.
    fn function(&self, function: Function, exponent: u32, argument: &Piece) -> Piece;
    /// A function of several arguments.
    fn call(&self, function: &str, arguments: &[Piece]) -> Piece;
    /// Two cases.
    fn choice(&self, relation: Relation, compared: [&Piece; 2], branches: [&Piece; 2]) -> Piece;
    /// `left = right`, broken where it is longer than `width` columns.
    fn equation(&self, left: &Piece, terms: &[(bool, Piece)], width: usize) -> String;
    /// Equations below each other.
    fn list(&self, equations: &[String]) -> String;
}

/// Writes the expressions of a graph.
#[derive(Debug)]
pub struct Printer<'a, N> {
    graph: &'a Graph,
    notation: N,
    names: FxHashMap<SymbolId, Name>,
    ranks: Vec<u32>,
    inline: bool,
}

impl<'a, N: Notation> Printer<'a, N> {
    /// A printer that writes symbols and named quantities by their names.
    pub fn new(graph: &'a Graph, notation: N) -> Self {
        Self {
            graph,
            notation,
            names: FxHashMap::default(),
            ranks: Vec::new(),
            inline: false,
        }
    }

    /// Writes a symbol by another name, such as `omega_1_dot`; see [`Name::parse`].
    #[must_use]
    pub fn with_name(mut self, symbol: SymbolId, name: &str) -> Self {
        self.names.insert(symbol, Name::parse(name));
        self
    }

    /// Puts these symbols first, in this order, in products and sums. The others follow in the order
    /// of their creation.
    #[must_use]
    pub fn with_order(mut self, first: &[SymbolId]) -> Self {
        let listed = u32::try_from(first.len()).unwrap_or(u32::MAX);
        self.ranks = (0..self.graph.symbol_count())
            .map(|id| u32::try_from(id).unwrap_or(u32::MAX).saturating_add(listed))
            .collect();
        for (rank, symbol) in (0..listed).zip(first) {
            if let Some(place) = self.ranks.get_mut(symbol.0 as usize) {
                *place = rank;
            }
        }
        self
    }

    /// Writes the definitions of named quantities in their places.
    #[must_use]
    pub fn with_definitions_inline(mut self) -> Self {
        self.inline = true;
        self
    }

    /// An expression on one line.
    pub fn expression(&self, expr: Expr) -> String {
        let pieces = self.pieces(expr);
        pieces
            .get(&expr)
            .map_or_else(String::new, |piece| piece.text.clone())
    }

    /// A name in this notation; see [`Name::parse`].
    pub fn name(&self, name: &str) -> String {
        self.notation.name(&Name::parse(name)).text
    }

    /// `name = expression`, broken into lines where it is longer than `width` columns.
    pub fn equation(&self, name: &str, expr: Expr, width: usize) -> String {
        let left = self.notation.name(&Name::parse(name));
        let pieces = self.pieces(expr);
        let terms = match self.graph.node(expr) {
            Node::Sum(terms) if terms.len() > 1 => self.terms(expr, &pieces),
            _ => pieces
                .get(&expr)
                .map(|piece| vec![(false, piece.clone())])
                .unwrap_or_default(),
        };
        self.notation.equation(&left, &terms, width)
    }

    /// Equations below each other.
    pub fn equations(&self, list: &[(&str, Expr)], width: usize) -> String {
        let equations: Vec<String> = list
            .iter()
            .map(|(name, expr)| self.equation(name, *expr, width))
            .collect();
        self.notation.list(&equations)
    }

    /// The definitions of all named quantities in `roots`, parts before wholes.
    pub fn definitions(&self, roots: &[Expr], width: usize) -> String {
        let definitions =
            self.graph
                .in_order(roots)
                .into_iter()
                .filter_map(|e| match self.graph.node(e) {
                    Node::Named(id) => Some(self.graph.definition(*id)),
                    _ => None,
                });
        let list: Vec<(&str, Expr)> = definitions.map(|d| (d.name.as_str(), d.value)).collect();
        self.equations(&list, width)
    }

    /// The equations behind [`Node::Solution`], one per row. Unknown `k` of system `n` is written
    /// `solution_n_k`, both counted from 1.
    pub fn system(&self, index: u32, width: usize) -> String {
        let system = self.graph.system(index);
        let size = system.right.len();
        let mut rows = Vec::with_capacity(size);
        for (i, &right) in system.right.iter().enumerate() {
            let mut terms = Vec::new();
            for (j, &entry) in system.matrix[i * size..(i + 1) * size].iter().enumerate() {
                if entry == Graph::ZERO {
                    continue;
                }
                let unknown = self.unknown(index, u32::try_from(j).unwrap_or(u32::MAX));
                let piece = if entry == Graph::ONE {
                    unknown
                } else {
                    let coefficient = self.whole(entry);
                    Piece::new(
                        self.notation.product(&[coefficient, unknown]),
                        Level::Product,
                    )
                };
                terms.push((false, piece));
            }
            if terms.is_empty() {
                terms.push((false, self.number(&Rational::ZERO)));
            }
            let left = Piece::new(self.notation.sum(&terms), Level::Sum);
            rows.push(
                self.notation
                    .equation(&left, &[(false, self.whole(right))], width),
            );
        }
        self.notation.list(&rows)
    }

    fn unknown(&self, system: u32, row: u32) -> Piece {
        let (system, row) = (u64::from(system) + 1, u64::from(row) + 1);
        self.notation
            .name(&Name::parse(&format!("solution_{system}_{row}")))
    }

    fn whole(&self, expr: Expr) -> Piece {
        let cut = || Piece::new(self.notation.digits("…"), Level::Atom);
        self.pieces(expr).remove(&expr).unwrap_or_else(cut)
    }

    /// The written parts of an expression and the expression itself.
    fn pieces(&self, root: Expr) -> FxHashMap<Expr, Piece> {
        let mut pieces: FxHashMap<Expr, Piece> = FxHashMap::default();
        let mut stack = vec![(root, false)];
        let mut written = 0;
        while let Some((expr, parts_done)) = stack.pop() {
            if pieces.contains_key(&expr) {
                continue;
            }
            if parts_done {
                let mut piece = self.piece(expr, &pieces);
                written += piece.text.len();
                let most = if written > MOST_BYTES_TOGETHER {
                    FEW_BYTES
                } else {
                    MOST_BYTES
                };
                if piece.text.len() > most {
                    piece = Piece {
                        level: Level::Atom,
                        text: self.notation.digits("…"),
                        ..piece
                    };
                }
                pieces.insert(expr, piece);
                continue;
            }
            stack.push((expr, true));
            let is_leaf = match self.graph.node(expr) {
                Node::Named(_) => !self.inline,
                Node::Solution { .. } => true,
                _ => false,
            };
            if !is_leaf {
                self.graph
                    .for_each_part(expr, |part| stack.push((part, false)));
            }
        }
        pieces
    }

    /// One node, whose parts are written.
    fn piece(&self, expr: Expr, pieces: &FxHashMap<Expr, Piece>) -> Piece {
        let at = |e: &Expr| &pieces[e];
        let mut piece = match self.graph.node(expr) {
            Node::Number(n) => self.number(n),
            Node::Symbol(symbol) => {
                let mut piece = match self.names.get(symbol) {
                    Some(name) => self.notation.name(name),
                    None => self
                        .notation
                        .name(&Name::parse(self.graph.symbol_name(*symbol))),
                };
                piece.first = self
                    .ranks
                    .get(symbol.0 as usize)
                    .copied()
                    .unwrap_or(symbol.0);
                return piece;
            }
            Node::Named(id) => {
                let definition = self.graph.definition(*id);
                if self.inline {
                    return at(&definition.value).clone();
                }
                self.notation.name(&Name::parse(&definition.name))
            }
            Node::Sum(terms) if terms.len() > 1 => {
                Piece::new(self.notation.sum(&self.terms(expr, pieces)), Level::Sum)
            }
            Node::Sum(_) => match self.terms(expr, pieces).pop() {
                Some((false, piece)) => piece,
                Some(term) => Piece::new(self.notation.sum(&[term]), Level::Sum),
                None => self.number(&Rational::ZERO),
            },
            Node::Product(factors) => self.product(&Rational::ONE, factors, pieces),
            Node::Function(function, x) => self.notation.function(*function, 1, at(x)),
            Node::Atan2(y, x) => self.notation.call("atan2", &[at(y).clone(), at(x).clone()]),
            Node::Power(base, exponent) => self.notation.general_power(at(base), at(exponent)),
            Node::Choice {
                relation,
                compared,
                branches,
            } => {
                let ([a, b], [c, d]) = (compared, branches);
                self.notation
                    .choice(*relation, [at(a), at(b)], [at(c), at(d)])
            }
            Node::Solution { system, row } => self.unknown(*system, *row),
        };
        self.graph.for_each_part(expr, |part| {
            let first = pieces.get(&part).map_or(u32::MAX, |p| p.first);
            piece.first = piece.first.min(first);
        });
        piece
    }

    /// The terms of a sum in the order in which people write them.
    fn terms(&self, sum: Expr, pieces: &FxHashMap<Expr, Piece>) -> Vec<(bool, Piece)> {
        let Node::Sum(terms) = self.graph.node(sum) else {
            return Vec::new();
        };
        let mut terms: Vec<_> = terms
            .iter()
            .map(|term| {
                let factors = order::factors(self.graph, term.expr, pieces);
                (
                    order::term_key(self.graph, term, &factors, pieces),
                    term,
                    factors,
                )
            })
            .collect();
        terms.sort_by(|a, b| a.0.cmp(&b.0));
        terms
            .into_iter()
            .map(|(_, term, factors)| {
                let negative = term.coefficient.is_negative();
                let mut piece = self.product(&term.coefficient.abs(), &factors, pieces);
                if piece.level == Level::Sum {
                    piece = Piece::new(self.notation.group(&piece.text), Level::Atom);
                }
                (negative, piece)
            })
            .collect()
    }

    /// `coefficient · Π base^exponent` as a product or a fraction; the coefficient is positive.
    fn product(
        &self,
        coefficient: &Rational,
        factors: &[Factor],
        pieces: &FxHashMap<Expr, Piece>,
    ) -> Piece {
        let (mut over, mut under) = (Vec::new(), Vec::new());
        if let Some(decimal) = decimal(coefficient) {
            over.push(Piece::new(self.notation.digits(&decimal), Level::Atom));
        } else {
            let value = coefficient.to_big();
            for (side, digits) in [(&mut over, value.numer()), (&mut under, value.denom())] {
                let digits = digits.to_string();
                if digits != "1" {
                    side.push(Piece::new(self.notation.digits(&digits), Level::Atom));
                }
            }
        }
        let mut factors = factors.to_vec();
        order::sort_factors(self.graph, &mut factors, pieces);
        for factor in &factors {
            let power = self.power(factor, pieces);
            if factor.exponent < 0 {
                under.push(power);
            } else {
                over.push(power);
            }
        }
        if over.is_empty() {
            over.push(Piece::new(self.notation.digits("1"), Level::Atom));
        }
        if !under.is_empty() {
            return self.notation.fraction(&over, &under);
        }
        match over.as_slice() {
            [single] => single.clone(),
            _ => Piece::new(self.notation.product(&over), Level::Product),
        }
    }

    /// `base^|exponent|`
    fn power(&self, factor: &Factor, pieces: &FxHashMap<Expr, Piece>) -> Piece {
        let exponent = factor.exponent.unsigned_abs();
        match self.graph.node(factor.base) {
            _ if exponent == 1 => pieces[&factor.base].clone(),
            Node::Function(function, x)
                if *function != Function::Sqrt && *function != Function::Abs =>
            {
                self.notation.function(*function, exponent, &pieces[x])
            }
            _ => self.notation.power(&pieces[&factor.base], exponent),
        }
    }

    fn number(&self, value: &Rational) -> Piece {
        let piece = self.product(&value.abs(), &[], &FxHashMap::default());
        if value.is_zero() {
            Piece::new(self.notation.digits("0"), Level::Atom)
        } else if value.is_negative() {
            Piece::new(self.notation.sum(&[(true, piece)]), Level::Sum)
        } else {
            piece
        }
    }
}

/// A number that people write with a decimal point, such as 9.81. Simple fractions are no such
/// numbers.
fn decimal(value: &Rational) -> Option<String> {
    const MOST_DIGITS: u32 = 9;
    let (n, d) = value.as_small().filter(|&(n, d)| d >= 10 && n > 0)?;
    let digits = (1..=MOST_DIGITS).find(|&k| 10i64.pow(k) % d == 0)?;
    let scaled = n.checked_mul(10i64.pow(digits) / d)?;
    let one = 10i64.pow(digits);
    Some(format!(
        "{}.{:0width$}",
        scaled / one,
        scaled % one,
        width = digits as usize
    ))
}
