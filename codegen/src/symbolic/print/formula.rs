//! Typesets expressions of the graph as formulas.

use rustc_hash::FxHashMap;

use super::letter::Letter;
use super::math::Math;
use crate::symbolic::{Expr, Factor, Function, Graph, Node, Rational, Relation, SymbolId, Term};

/// A subexpression that would print wider than this is replaced by a letter and defined separately.
const WIDEST_PART: usize = 160;
/// A subexpression nested deeper than this is replaced by a letter and defined separately.
const DEEPEST_PART: usize = 12;
/// A root or another function wider than this is replaced by a letter, if requested.
const WIDEST_FUNCTION: usize = 24;

/// Letters of symbols and names, and their order in a product.
pub trait Vocabulary {
    /// Letter of a symbol or of a named quantity.
    fn letter(&self, graph: &Graph, expr: Expr) -> Letter {
        match graph.node(expr) {
            Node::Symbol(id) => Letter::of(graph.symbol_name(*id)),
            Node::Named(id) => Letter::of(&graph.definition(*id).name),
            _ => Letter::plain("?"),
        }
    }

    /// Sort key of a symbol in a product: before the names up to 4, after them from 6 on. Symbols of equal
    /// key are ordered by creation.
    fn place(&self, _graph: &Graph, _symbol: Expr) -> u8 {
        1
    }
}

/// Letters spelled as their names.
#[derive(Debug, Clone, Copy, Default)]
pub struct Spelled;

impl Vocabulary for Spelled {}

/// A formula and the quantities that it refers to.
#[derive(Debug, Clone)]
pub struct Formula {
    /// The formula.
    pub math: Math,
    /// Named quantities and lettered subexpressions that occur in it, in order of appearance.
    pub wants: Vec<Expr>,
    width: usize,
    depth: usize,
}

/// Sets expressions as formulas.
#[derive(Debug, Clone)]
pub struct Setter<V> {
    vocabulary: V,
    /// Whether names are replaced by their definitions.
    inline: bool,
    /// Whether wide functions are replaced by letters.
    functions_apart: bool,
    /// Lettered subexpressions, by first use.
    parts: FxHashMap<Expr, usize>,
    /// Letters of subexpressions and of unknowns, once they are chosen.
    bases: Option<[&'static str; 2]>,
}

/// Letters of subexpressions, in order of preference.
const PARTS: [&str; 4] = ["c", "k", "e", "a"];
/// Letters of the unknowns of linear systems.
const UNKNOWNS: [&str; 4] = ["s", "y", "w", "u"];

impl<V: Vocabulary> Setter<V> {
    /// A setter that writes named quantities by their names.
    pub fn new(vocabulary: V) -> Self {
        Self {
            vocabulary,
            inline: false,
            functions_apart: false,
            parts: FxHashMap::default(),
            bases: None,
        }
    }

    /// The letters of subexpressions and of unknowns of linear systems: none that a symbol has.
    pub fn bases(&mut self, graph: &Graph) -> [&'static str; 2] {
        *self.bases.get_or_insert_with(|| {
            let symbols = (0u32..).take(graph.symbol_count()).map(SymbolId);
            let taken: Vec<String> = symbols
                .map(|symbol| Letter::of(graph.symbol_name(symbol)).base)
                .collect();
            [PARTS, UNKNOWNS].map(|letters| {
                let free = letters.into_iter().find(|&l| !taken.iter().any(|t| t == l));
                free.unwrap_or(letters[0])
            })
        })
    }

    /// Replaces named quantities by their definitions.
    #[must_use]
    pub fn with_definitions_inline(mut self) -> Self {
        self.inline = true;
        self
    }

    /// Replaces wide roots and other functions by letters.
    #[must_use]
    pub fn with_functions_apart(mut self, apart: bool) -> Self {
        self.functions_apart = apart;
        self
    }

    /// Letters of symbols and names.
    pub fn vocabulary(&self) -> &V {
        &self.vocabulary
    }

    /// Letter of a symbol, a name, an unknown or a lettered subexpression.
    pub fn letter(&mut self, graph: &Graph, expr: Expr) -> Letter {
        match graph.node(expr) {
            Node::Named(_) | Node::Symbol(_) => self.vocabulary.letter(graph, expr),
            Node::Solution { system, row } => Letter::plain(self.bases(graph)[1])
                .below(&(system + 1).to_string())
                .below(&(row + 1).to_string()),
            _ => {
                let next = self.parts.len() + 1;
                let number = *self.parts.entry(expr).or_insert(next);
                Letter::plain(self.bases(graph)[0]).below(&number.to_string())
            }
        }
    }

    /// The formula of an expression; large subexpressions are replaced by letters.
    pub fn set(&mut self, graph: &Graph, expr: Expr) -> Formula {
        let mut known: FxHashMap<Expr, Formula> = FxHashMap::default();
        for part in written(graph, expr, self.inline) {
            let set = self.step(graph, part, &known);
            let is_function = matches!(graph.node(part), Node::Function(..));
            let widest = if is_function && self.functions_apart {
                WIDEST_FUNCTION
            } else {
                WIDEST_PART
            };
            let large = part != expr && (set.width > widest || set.depth > DEEPEST_PART);
            let set = if large {
                self.leaf(graph, part, true)
            } else {
                set
            };
            known.insert(part, set);
        }
        known
            .remove(&expr)
            .unwrap_or_else(|| self.leaf(graph, expr, false))
    }

    fn leaf(&mut self, graph: &Graph, expr: Expr, wanted: bool) -> Formula {
        let math = Math::letter(self.letter(graph, expr));
        let width = math.width();
        Formula {
            math,
            wants: if wanted { vec![expr] } else { Vec::new() },
            width,
            depth: 0,
        }
    }

    fn step(&mut self, graph: &Graph, expr: Expr, known: &FxHashMap<Expr, Formula>) -> Formula {
        let math = |e: Expr| known[&e].math.clone();
        let formula = match graph.node(expr) {
            Node::Symbol(_) => return self.leaf(graph, expr, false),
            Node::Named(id) if self.inline => return known[&graph.definition(*id).value].clone(),
            Node::Named(_) | Node::Solution { .. } => return self.leaf(graph, expr, true),
            Node::Number(n) => signed(n),
            Node::Sum(terms) => self.sum(graph, terms, known),
            Node::Product(factors) => self.product(graph, &Rational::ONE, factors, known),
            Node::Function(Function::Sqrt, a) => Math::Root(Box::new(math(*a))),
            Node::Function(Function::Abs, a) => Math::Size(Box::new(math(*a))),
            Node::Function(f, a) => Math::Call(function_name(*f), 1, Box::new(math(*a))),
            Node::Atan2(y, x) => Math::Call(
                "atan2",
                1,
                Box::new(Math::Vector {
                    components: vec![math(*y), math(*x)],
                    frame: None,
                    column: false,
                }),
            ),
            Node::Power(base, exponent) => power(math(*base), math(*exponent)),
            Node::Choice {
                relation,
                compared,
                branches,
            } => {
                let sign = match relation {
                    Relation::Less => "<",
                    Relation::LessOrEqual => "≤",
                };
                let condition =
                    Math::Row(vec![math(compared[0]), Math::Sign(sign), math(compared[1])]);
                Math::Cases {
                    value: Box::new(math(branches[0])),
                    condition: Box::new(condition),
                    otherwise: Box::new(math(branches[1])),
                }
            }
        };
        let mut wants: Vec<Expr> = Vec::new();
        let mut depth = 0;
        each_written_part(graph, expr, self.inline, |part| {
            depth = depth.max(known[&part].depth + 1);
            for &want in &known[&part].wants {
                if !wants.contains(&want) {
                    wants.push(want);
                }
            }
        });
        let width = formula.width();
        Formula {
            math: formula,
            wants,
            width,
            depth,
        }
    }

    fn sum(&self, graph: &Graph, terms: &[Term], known: &FxHashMap<Expr, Formula>) -> Math {
        let mut ordered: Vec<&Term> = terms.iter().collect();
        ordered.sort_by_cached_key(|term| self.reading_key(graph, term.expr));
        let mut signed_terms: Vec<(bool, Math)> = ordered
            .into_iter()
            .map(|term| {
                let minus = term.coefficient.is_negative();
                let size = term.coefficient.abs();
                let math = match graph.node(term.expr) {
                    Node::Number(_) => signed(&size),
                    Node::Product(factors) => self.product(graph, &size, factors, known),
                    _ if size.is_one() => known[&term.expr].math.clone(),
                    _ => {
                        let factor = [Factor {
                            base: term.expr,
                            exponent: 1,
                        }];
                        self.product(graph, &size, &factor, known)
                    }
                };
                (minus, math)
            })
            .collect();
        // A positive term comes first if there is one.
        if signed_terms[0].0
            && let Some(place) = signed_terms.iter().position(|(minus, _)| !minus)
        {
            let first = signed_terms.remove(place);
            signed_terms.insert(0, first);
        }
        Math::Sum(signed_terms)
    }

    fn product(
        &self,
        graph: &Graph,
        coefficient: &Rational,
        factors: &[Factor],
        known: &FxHashMap<Expr, Formula>,
    ) -> Math {
        let mut factors: Vec<Factor> = factors.to_vec();
        let tangents = take_tangents(graph, &mut factors);
        let mut ordered: Vec<(Place, i32, Math)> = factors
            .iter()
            .map(|f| {
                (
                    self.place(graph, f.base),
                    f.exponent,
                    known[&f.base].math.clone(),
                )
            })
            .collect();
        ordered.sort_by_key(|row| row.0);
        let (mut above, mut below) = (Vec::new(), Vec::new());
        for (_, exponent, base) in ordered {
            let target = if exponent > 0 { &mut above } else { &mut below };
            target.push(raised(base, exponent.unsigned_abs()));
        }
        for (angle, exponent) in tangents {
            above.push(Math::Call(
                "tan",
                exponent,
                Box::new(known[&angle].math.clone()),
            ));
        }
        assemble(coefficient, above, below)
    }

    /// Terms are sorted by their first letters; a number comes last.
    fn reading_key(&self, graph: &Graph, term: Expr) -> Vec<(Place, i32)> {
        let mut key: Vec<(Place, i32)> = match graph.node(term) {
            Node::Product(factors) => factors
                .iter()
                .map(|f| (self.place(graph, f.base), -f.exponent))
                .collect(),
            Node::Number(_) => return vec![(Place(u8::MAX, term), 0)],
            _ => vec![(self.place(graph, term), -1)],
        };
        key.sort_unstable();
        key
    }

    /// Sort key of a factor: sums, then symbols by rank, names, functions.
    fn place(&self, graph: &Graph, base: Expr) -> Place {
        let group = match graph.node(base) {
            Node::Sum(_) => 0,
            Node::Symbol(_) => self.vocabulary.place(graph, base),
            Node::Named(_) | Node::Solution { .. } => 5,
            _ => 7,
        };
        Place(group, base)
    }
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
struct Place(u8, Expr);

/// `coefficient · above / below`
pub fn assemble(coefficient: &Rational, mut above: Vec<Math>, mut below: Vec<Math>) -> Math {
    if below.is_empty() {
        if !coefficient.is_one() || above.is_empty() {
            above.insert(0, signed(coefficient));
        }
        return Math::product(above);
    }
    let number = coefficient.to_big();
    let (n, d) = (number.numer().to_string(), number.denom().to_string());
    if n != "1" || above.is_empty() {
        above.insert(0, Math::Integer(n));
    }
    if d != "1" {
        below.insert(0, Math::Integer(d));
    }
    Math::fraction(Math::product(above), Math::product(below))
}

/// A number. Only a number that is the whole formula can be negative.
fn signed(number: &Rational) -> Math {
    let big = number.abs().to_big();
    let size = if big.is_integer() {
        Math::Integer(big.numer().to_string())
    } else {
        Math::Ratio(big.numer().to_string(), big.denom().to_string())
    };
    if number.is_negative() {
        Math::Sum(vec![(true, size)])
    } else {
        size
    }
}

fn raised(base: Math, exponent: u32) -> Math {
    match base {
        base if exponent == 1 => base,
        Math::Call(name, 1, argument) => Math::Call(name, exponent, argument),
        base => power(base, Math::Integer(exponent.to_string())),
    }
}

fn power(base: Math, exponent: Math) -> Math {
    let base = match base {
        simple @ (Math::Letter(_) | Math::Integer(_) | Math::Root(_) | Math::Size(_)) => simple,
        other => Math::Brackets(Box::new(other)),
    };
    Math::Power(Box::new(base), Box::new(exponent))
}

/// Combines `sin^a cos^-b` of the same angle: angles with the exponents of their tangents.
fn take_tangents(graph: &Graph, factors: &mut Vec<Factor>) -> Vec<(Expr, u32)> {
    let angle = |base: Expr, kind: Function| match graph.node(base) {
        Node::Function(function, angle) if *function == kind => Some(*angle),
        _ => None,
    };
    let mut tangents = Vec::new();
    for i in 0..factors.len() {
        let Some(of) = angle(factors[i].base, Function::Sin).filter(|_| factors[i].exponent > 0)
        else {
            continue;
        };
        let cosine = |f: &Factor| f.exponent < 0 && angle(f.base, Function::Cos) == Some(of);
        let Some(j) = factors.iter().position(cosine) else {
            continue;
        };
        let shared = factors[i].exponent.min(-factors[j].exponent);
        factors[i].exponent -= shared;
        factors[j].exponent += shared;
        tangents.push((of, shared.unsigned_abs()));
    }
    factors.retain(|f| f.exponent != 0);
    tangents
}

/// The operands that are printed with an expression: not those of linear systems, and the definitions of
/// names only if `inline`.
fn each_written_part(graph: &Graph, expr: Expr, inline: bool, visit: impl FnMut(Expr)) {
    let stands_alone = match graph.node(expr) {
        Node::Named(_) => !inline,
        Node::Solution { .. } => true,
        _ => false,
    };
    if !stands_alone {
        graph.for_each_part(expr, visit);
    }
}

/// The printed subexpressions of an expression, operands before users.
fn written(graph: &Graph, root: Expr, inline: bool) -> Vec<Expr> {
    let mut order = Vec::new();
    let mut seen = rustc_hash::FxHashSet::default();
    let mut stack = vec![(root, false)];
    while let Some((expr, parts_done)) = stack.pop() {
        if parts_done {
            order.push(expr);
        } else if seen.insert(expr) {
            stack.push((expr, true));
            each_written_part(graph, expr, inline, |part| stack.push((part, false)));
        }
    }
    order
}

/// The subexpressions of an expression, without looking into names.
pub fn visible(graph: &Graph, root: Expr) -> Vec<Expr> {
    written(graph, root, false)
}

fn function_name(function: Function) -> &'static str {
    match function {
        Function::Asin => "arcsin",
        Function::Acos => "arccos",
        Function::Atan => "arctan",
        Function::Sign => "sgn",
        other => other.name(),
    }
}
