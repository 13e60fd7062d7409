//! Evaluation of a graph at one random point of the field.

use rustc_hash::FxHashMap;

use super::super::field::{Element, PRIME, Rotation, keyed};
use super::super::{Expr, Function, Graph, Node, Rational, Relation, SymbolId};
use super::elimination::solve;
use super::tag;

/// Angles are multiples of `atom / ANGLE_PARTS`, which makes fractions of angles exact.
const ANGLE_PARTS: u64 = 2304;
/// Largest `n d` of a coefficient `n / d` of an angle for which addition theorems are modelled.
const MOST_TURNS: u64 = 1 << 24;
/// The angle π in units of [`Rotation::PI_OVER_24`].
const HALF_TURN: i64 = 24;
/// Exponents are multiples of `atom / EXPONENT_PARTS`.
const EXPONENT_PARTS: i64 = 720;
/// Largest such multiple for which `exp(a + b) = exp a exp b` is modelled.
const MOST_EXPONENT_PARTS: i64 = 1 << 24;

/// A memoised value.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
struct Cell(u64);

impl Cell {
    const UNKNOWN: Self = Self(u64::MAX);
    const UNDEFINED: Self = Self(u64::MAX - 1);

    fn value(self) -> Option<Element> {
        (self.0 < PRIME).then(|| Element::new(self.0))
    }
}

impl From<Option<Element>> for Cell {
    fn from(value: Option<Element>) -> Self {
        value.map_or(Self::UNDEFINED, |v| Self(v.get()))
    }
}

/// Values by expression.
#[derive(Debug, Clone)]
enum Cells {
    /// For most expressions of the graph.
    All(Vec<Cell>),
    /// For the few expressions that depend on one symbol.
    Few(FxHashMap<Expr, Cell>),
}

impl Cells {
    fn get(&self, expr: Expr) -> Cell {
        let known = match self {
            Self::All(cells) => cells.get(expr.0 as usize),
            Self::Few(cells) => cells.get(&expr),
        };
        known.copied().unwrap_or(Cell::UNKNOWN)
    }

    fn set(&mut self, g: &Graph, expr: Expr, cell: Cell) {
        match self {
            Self::All(cells) => {
                if cells.len() < g.len() {
                    cells.resize(g.len(), Cell::UNKNOWN);
                }
                cells[expr.0 as usize] = cell;
            }
            Self::Few(cells) => {
                cells.insert(expr, cell);
            }
        }
    }
}

/// One random point with the values of all expressions evaluated so far.
#[derive(Debug, Clone)]
pub(super) struct Point {
    key: u64,
    /// The symbol of π.
    pi: Option<SymbolId>,
    /// Symbols that are components of unit quaternions.
    quaternions: Vec<[SymbolId; 4]>,
    cells: Cells,
    rotations: FxHashMap<Expr, Option<Rotation>>,
    solutions: FxHashMap<u32, Option<Box<[Element]>>>,
    inverses: FxHashMap<i64, Element>,
    stack: Vec<Expr>,
    parts: Vec<(Rational, Expr)>,
}

/// A reference point from which another one differs in one symbol.
#[derive(Debug, Clone, Copy)]
pub(super) struct Redraw<'a> {
    /// The original, at which all subexpressions are evaluated already.
    pub(super) original: &'a Point,
    /// The symbol with another value.
    pub(super) symbol: SymbolId,
    /// By node: a superset of the symbols on which it depends.
    pub(super) symbols: &'a [u64],
}

/// The bit of a symbol in a set of symbols; symbols whose ids differ by 64 share one.
pub(super) fn symbol_bit(symbol: SymbolId) -> u64 {
    1 << (symbol.0 % 64)
}

impl Point {
    pub(super) fn new(key: u64, pi: Option<SymbolId>, quaternions: Vec<[SymbolId; 4]>) -> Self {
        Self {
            key,
            pi,
            quaternions,
            cells: Cells::All(Vec::new()),
            rotations: FxHashMap::default(),
            solutions: FxHashMap::default(),
            inverses: FxHashMap::default(),
            stack: Vec::new(),
            parts: Vec::new(),
        }
    }

    /// Another point with the same pseudo-random functions, to differ in one symbol.
    pub(super) fn sibling(&self) -> Self {
        Self {
            cells: Cells::Few(FxHashMap::default()),
            ..Self::new(self.key, self.pi, self.quaternions.clone())
        }
    }

    /// The number of memoised values.
    pub(super) fn len(&self) -> usize {
        match &self.cells {
            Cells::All(cells) => cells.len(),
            Cells::Few(cells) => cells.len(),
        }
    }

    /// The value of an expression; `None` if it is undefined at this point.
    pub(super) fn evaluate(
        &mut self,
        g: &Graph,
        root: Expr,
        redraw: Option<Redraw<'_>>,
    ) -> Option<Element> {
        let mut stack = std::mem::take(&mut self.stack);
        stack.push(root);
        while let Some(&expr) = stack.last() {
            if self.cell(expr, redraw) != Cell::UNKNOWN {
                stack.pop();
                continue;
            }
            let height = stack.len();
            g.for_each_part(expr, |part| {
                if self.cell(part, redraw) == Cell::UNKNOWN {
                    stack.push(part);
                }
            });
            if stack.len() == height {
                let value = self.step(g, expr, redraw);
                self.cells.set(g, expr, value.into());
                stack.pop();
            }
        }
        self.stack = stack;
        self.part(root, redraw)
    }

    /// The memoised value of an expression, from the original point if the redrawn symbol does not affect it.
    fn cell(&self, expr: Expr, redraw: Option<Redraw<'_>>) -> Cell {
        let stays =
            |redraw: &Redraw<'_>| redraw.symbols[expr.0 as usize] & symbol_bit(redraw.symbol) == 0;
        let known = redraw
            .filter(stays)
            .map(|redraw| redraw.original.cells.get(expr));
        known
            .filter(|&cell| cell != Cell::UNKNOWN)
            .unwrap_or_else(|| self.cells.get(expr))
    }

    /// The value of an operand.
    fn part(&self, expr: Expr, redraw: Option<Redraw<'_>>) -> Option<Element> {
        self.cell(expr, redraw).value()
    }

    fn drawn(&self, tag: u64, symbol: SymbolId) -> Element {
        keyed(self.key, tag, [u64::from(symbol.0), 0])
    }

    /// A component of a unit quaternion: (1 − s, 2 u) / (1 + s) with s = u · u for a random vector u.
    fn on_sphere(&self, quaternion: &[SymbolId; 4], symbol: SymbolId) -> Option<Element> {
        let [scalar, vector @ ..] = *quaternion;
        let mut square = Element::ZERO;
        for component in vector {
            let u = self.drawn(tag::SYMBOL, component);
            square = square + u * u;
        }
        let scale = (Element::ONE + square).inverse()?;
        let numerator = if symbol == scalar {
            Element::ONE - square
        } else {
            let u = self.drawn(tag::SYMBOL, symbol);
            u + u
        };
        Some(numerator * scale)
    }

    /// The value of a node whose operands are evaluated.
    fn step(&mut self, g: &Graph, expr: Expr, redraw: Option<Redraw<'_>>) -> Option<Element> {
        match g.node(expr) {
            Node::Number(n) => Element::from_rational(n),
            Node::Symbol(symbol) => {
                let tag = match redraw {
                    Some(redraw) if redraw.symbol == *symbol => tag::REDRAWN,
                    _ => tag::SYMBOL,
                };
                match self.quaternions.iter().find(|e| e.contains(symbol)) {
                    Some(quaternion) if tag == tag::SYMBOL => self.on_sphere(quaternion, *symbol),
                    _ => Some(self.drawn(tag, *symbol)),
                }
            }
            Node::Named(id) => self.part(g.definition(*id).value, redraw),
            Node::Sum(terms) => {
                let mut sum = Element::ZERO;
                for term in terms {
                    let value = self.part(term.expr, redraw)?;
                    sum = sum + self.scaled(&term.coefficient, value)?;
                }
                Some(sum)
            }
            Node::Product(factors) => {
                let (mut over, mut under) = (Element::ONE, Element::ONE);
                for factor in factors {
                    let value = self.part(factor.base, redraw)?;
                    let side = if factor.exponent < 0 {
                        &mut under
                    } else {
                        &mut over
                    };
                    *side = *side
                        * match factor.exponent.unsigned_abs() {
                            1 => value,
                            2 => value * value,
                            n => value.pow(n.into()),
                        };
                }
                Some(if under == Element::ONE {
                    over
                } else {
                    over * under.inverse()?
                })
            }
            Node::Function(function, argument) => self.function(g, *function, *argument, redraw),
            Node::Atan2(y, x) => {
                let (y, x) = (self.part(*y, redraw)?, self.part(*x, redraw)?);
                Some(keyed(self.key, tag::ATAN2, [y.get(), x.get()]))
            }
            Node::Power(base, exponent) => self.power(g, *base, *exponent, redraw),
            Node::Choice {
                relation,
                compared,
                branches,
            } => {
                let [left, right] = [
                    self.part(compared[0], redraw)?,
                    self.part(compared[1], redraw)?,
                ];
                let [then, otherwise] = [
                    self.part(branches[0], redraw)?,
                    self.part(branches[1], redraw)?,
                ];
                // A weight instead of a branch: expressions that differ in the branch not taken must not
                // appear equal.
                let positive = |key, d: Element| keyed(key, tag::CONDITION, [d.get(), 0]);
                let holds = match relation {
                    Relation::Less => positive(self.key, right - left),
                    Relation::LessOrEqual => Element::ONE - positive(self.key, left - right),
                };
                Some(otherwise + holds * (then - otherwise))
            }
            Node::Solution { system, row } => self.solution(g, *system, *row, redraw),
        }
    }

    /// `coefficient · value`
    fn scaled(&mut self, coefficient: &Rational, value: Element) -> Option<Element> {
        match coefficient.as_small() {
            Some((1, 1)) => Some(value),
            Some((-1, 1)) => Some(-value),
            Some((n, d)) => {
                let numerator = value * Element::from_signed(n);
                Some(match d {
                    1 => numerator,
                    2 => numerator * Element::HALF,
                    _ => {
                        if let Some(&inverse) = self.inverses.get(&d) {
                            return Some(numerator * inverse);
                        }
                        let inverse = Element::from_signed(d).inverse()?;
                        self.inverses.insert(d, inverse);
                        numerator * inverse
                    }
                })
            }
            None => Some(value * Element::from_rational(coefficient)?),
        }
    }

    fn function(
        &mut self,
        g: &Graph,
        function: Function,
        x: Expr,
        redraw: Option<Redraw<'_>>,
    ) -> Option<Element> {
        let value = self.part(x, redraw)?;
        match function {
            Function::Sin => self.rotation(g, x, redraw).map(|r| r.sin),
            Function::Cos => self.rotation(g, x, redraw).map(|r| r.cos),
            Function::Exp => self.growth(g, x, 0, redraw),
            Function::Sinh | Function::Cosh | Function::Tanh => {
                let up = self.growth(g, x, 0, redraw)?;
                let down = up.inverse()?;
                match function {
                    Function::Sinh => Some((up - down) * Element::HALF),
                    Function::Cosh => Some((up + down) * Element::HALF),
                    _ => Some((up - down) * (up + down).inverse()?),
                }
            }
            Function::Sqrt => self.square_root(g, x, value),
            // x| = x sign x; the sign is an uninterpreted odd function.
            Function::Asin | Function::Atan | Function::Sign => Some(self.odd(function, value)),
            Function::Abs => Some(value * self.odd(Function::Sign, value)),
            Function::Acos | Function::Ln => Some(keyed(
                self.key,
                tag::FUNCTION + function as u64,
                [value.get(), 0],
            )),
        }
    }

    /// The root that is a square itself. A number without one in this field gets a transcendental stand-in,
    /// so the identity √n² = n is not modelled for it.
    fn square_root(&self, g: &Graph, radicand: Expr, value: Element) -> Option<Element> {
        value.square_root().or_else(|| {
            let number = g.as_number(radicand).filter(|n| !n.is_negative())?;
            let stand_in = keyed(self.key, tag::ROOT_OF_NUMBER, [value.get(), 0]);
            (!number.is_zero()).then_some(stand_in)
        })
    }

    /// An uninterpreted odd function.
    fn odd(&self, function: Function, value: Element) -> Element {
        if value.is_zero() {
            return value;
        }
        let (magnitude, negative) = value.without_sign();
        let image = keyed(
            self.key,
            tag::FUNCTION + function as u64,
            [magnitude.get(), 0],
        );
        if negative { -image } else { image }
    }

    /// Splits an expression into `Σ coefficient · atom`, where no atom is a sum or a name.
    fn split(&mut self, g: &Graph, expr: Expr) -> Vec<(Rational, Expr)> {
        let mut atoms = std::mem::take(&mut self.parts);
        atoms.clear();
        atoms.push((Rational::ONE, expr));
        let mut next = 0;
        while next < atoms.len() {
            let (factor, part) = atoms[next].clone();
            match g.node(part) {
                Node::Named(id) => atoms[next].1 = g.definition(*id).value,
                Node::Sum(terms) => {
                    atoms.swap_remove(next);
                    atoms.extend(terms.iter().map(|t| (&factor * &t.coefficient, t.expr)));
                }
                Node::Number(n) if *n != Rational::ONE => {
                    atoms[next] = (&factor * n, Graph::ONE);
                }
                _ => next += 1,
            }
        }
        atoms
    }

    /// Cosine and sine of an angle, by the addition theorems from those of its atoms.
    fn rotation(&mut self, g: &Graph, angle: Expr, redraw: Option<Redraw<'_>>) -> Option<Rotation> {
        if let Some(&known) = self.rotations.get(&angle) {
            return known;
        }
        let atoms = self.split(g, angle);
        let mut total = Some(Rotation::NONE);
        for (coefficient, atom) in &atoms {
            let turn = self.turn(g, coefficient, *atom, redraw);
            total = total.zip(turn).map(|(sum, turn)| sum.then(turn));
        }
        self.parts = atoms;
        self.rotations.insert(angle, total);
        total
    }

    /// Cosine and sine of `coefficient · atom`.
    fn turn(
        &mut self,
        g: &Graph,
        coefficient: &Rational,
        atom: Expr,
        redraw: Option<Redraw<'_>>,
    ) -> Option<Rotation> {
        if self.pi.is_some() && g.as_symbol(atom) == self.pi {
            let steps = (coefficient * &HALF_TURN.into()).as_integer();
            if let Some(steps) = steps.and_then(|n| u64::try_from(n.rem_euclid(2 * HALF_TURN)).ok())
            {
                return Some(Rotation::PI_OVER_24.times(steps));
            }
        }
        let value = self.part(atom, redraw)?;
        // A coefficient without modelled multiples becomes part of the atom.
        let (value, multiple, backwards) = match turns(coefficient) {
            Some((multiple, backwards)) => (value, multiple, backwards),
            None => (self.scaled(coefficient, value)?, ANGLE_PARTS, false),
        };
        if value.is_zero() {
            return Some(Rotation::NONE);
        }
        let (magnitude, negative) = value.without_sign();
        let unit = Rotation::from_parameter(keyed(self.key, tag::ANGLE, [magnitude.get(), 0]));
        let turn = unit.times(multiple);
        Some(if negative == backwards {
            turn
        } else {
            turn.reversed()
        })
    }

    /// `Π growth(base, atom)^coefficient` over the atoms of the exponent; `exp` has the base 0.
    fn growth(
        &mut self,
        g: &Graph,
        exponent: Expr,
        base: u64,
        redraw: Option<Redraw<'_>>,
    ) -> Option<Element> {
        let atoms = self.split(g, exponent);
        let mut product = Some(Element::ONE);
        for (coefficient, atom) in &atoms {
            // The caller handles the numeric part of a power's exponent.
            if base != 0 && *atom == Graph::ONE {
                continue;
            }
            let power = self.growth_of_atom(coefficient, *atom, base, redraw);
            product = product.zip(power).map(|(a, b)| a * b);
        }
        self.parts = atoms;
        product
    }

    fn growth_of_atom(
        &mut self,
        coefficient: &Rational,
        atom: Expr,
        base: u64,
        redraw: Option<Redraw<'_>>,
    ) -> Option<Element> {
        let value = self.part(atom, redraw)?;
        let parts = (coefficient * &EXPONENT_PARTS.into())
            .as_integer()
            .filter(|parts| parts.abs() <= MOST_EXPONENT_PARTS);
        let (value, parts) = match parts {
            Some(parts) => (value, parts),
            None => (self.scaled(coefficient, value)?, EXPONENT_PARTS),
        };
        if value.is_zero() {
            return Some(Element::ONE);
        }
        let (magnitude, negative) = value.without_sign();
        let unit = keyed(self.key, tag::EXPONENT, [magnitude.get(), base]);
        let power = unit.pow(parts.unsigned_abs());
        if negative == (parts < 0) {
            Some(power)
        } else {
            power.inverse()
        }
    }

    /// `base^exponent`: the numeric part of the exponent is applied to the base, the rest is an uninterpreted
    /// homomorphism of the exponent.
    fn power(
        &mut self,
        g: &Graph,
        base: Expr,
        exponent: Expr,
        redraw: Option<Redraw<'_>>,
    ) -> Option<Element> {
        let value = self.part(base, redraw)?;
        if value.is_zero() {
            return None;
        }
        let atoms = self.split(g, exponent);
        let constant = atoms
            .iter()
            .filter(|(_, atom)| *atom == Graph::ONE)
            .fold(Rational::ZERO, |sum, (c, _)| &sum + c);
        self.parts = atoms;
        // Shifted by one, since base 0 denotes the exponential.
        let symbolic = self.growth(g, exponent, value.get() + 1, redraw)?;
        Some(symbolic * self.rational_power(g, base, value, &constant)?)
    }

    fn rational_power(
        &self,
        g: &Graph,
        base: Expr,
        value: Element,
        exponent: &Rational,
    ) -> Option<Element> {
        let Some((n, d)) = exponent.as_small() else {
            let exponent = Element::from_rational(exponent)?;
            return Some(keyed(self.key, tag::ROOT, [value.get(), exponent.get()]));
        };
        let root = match d {
            1 => value,
            2 => self.square_root(g, base, value)?,
            // An uninterpreted root: (x^(1/d))^d = x is not modelled, but integer powers of x are extracted
            // first.
            _ => keyed(self.key, tag::ROOT, [value.get(), d.unsigned_abs()]),
        };
        let (whole, rest) = (n.div_euclid(d), n.rem_euclid(d));
        let whole_power = value.pow(whole.unsigned_abs());
        let whole_power = if whole < 0 {
            whole_power.inverse()?
        } else {
            whole_power
        };
        Some(whole_power * root.pow(rest.unsigned_abs()))
    }

    fn solution(
        &mut self,
        g: &Graph,
        system: u32,
        row: u32,
        redraw: Option<Redraw<'_>>,
    ) -> Option<Element> {
        if !self.solutions.contains_key(&system) {
            let equations = g.system(system);
            let values = |exprs: &[Expr]| -> Option<Vec<Element>> {
                exprs.iter().map(|&e| self.part(e, redraw)).collect()
            };
            let solved = match (values(&equations.matrix), values(&equations.right)) {
                (Some(matrix), Some(right)) => solve(matrix, right),
                _ => None,
            };
            self.solutions.insert(system, solved);
        }
        self.solutions[&system]
            .as_ref()
            .map(|unknowns| unknowns[row as usize])
    }
}

/// `|coefficient| · ANGLE_PARTS` modulo the order `p + 1` of the circle, and whether the coefficient is
/// negative.
///
/// Denominators without factors 2 and 3 are units modulo the order, so a fifth of an angle is exact.
fn turns(coefficient: &Rational) -> Option<(u64, bool)> {
    use num_integer::Integer;
    let (n, d) = coefficient.as_small()?;
    let (count, d) = (n.unsigned_abs(), d.unsigned_abs());
    if count.checked_mul(d)? > MOST_TURNS {
        return None;
    }
    let shared = d.gcd(&ANGLE_PARTS);
    let multiple = count * (ANGLE_PARTS / shared);
    let rest = d / shared;
    if rest == 1 {
        return Some((multiple, n < 0));
    }
    let order = i128::from(PRIME) + 1;
    let divisor = i128::from(rest).extended_gcd(&order);
    if divisor.gcd != 1 {
        return None;
    }
    let quotient = (i128::from(multiple) * divisor.x.rem_euclid(order)).rem_euclid(order);
    Some((u64::try_from(quotient).ok()?, n < 0))
}
