//! Random expressions from short programs, which shrink well.

use appell_codegen::symbolic::{Expr, Function, Graph, Rational, Relation, SymbolId};
use proptest::prelude::*;
use proptest::test_runner::{Config, RngAlgorithm, TestRng, TestRunner};

/// How many symbols random expressions use.
pub(crate) const SYMBOLS: u32 = 3;

/// One step: which operation, on which earlier results, with which small number.
pub(crate) type Step = (u8, u8, u8, i8);

const FUNCTIONS: [Function; 13] = [
    Function::Sin,
    Function::Cos,
    Function::Asin,
    Function::Acos,
    Function::Atan,
    Function::Sinh,
    Function::Cosh,
    Function::Tanh,
    Function::Exp,
    Function::Ln,
    Function::Sqrt,
    Function::Abs,
    Function::Sign,
];

/// Which operations a program may use.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(crate) enum Kind {
    /// Sums, products, quotients.
    Rational,
    /// Sine and cosine in addition.
    Circular,
    /// Every node there is.
    Any,
}

pub(crate) fn programs(longest: usize) -> impl Strategy<Value = Vec<Step>> {
    prop::collection::vec(any::<Step>(), 1..longest)
}

/// Runs the same cases every time.
pub(crate) fn check<S: Strategy>(
    cases: u32,
    strategy: &S,
    test: impl Fn(S::Value) -> Result<(), TestCaseError>,
) where
    S::Value: std::fmt::Debug,
{
    let config = Config {
        cases,
        failure_persistence: None,
        ..Config::default()
    };
    let rng = TestRng::deterministic_rng(RngAlgorithm::ChaCha);
    if let Err(error) = TestRunner::new_with_rng(config, rng).run(strategy, test) {
        panic!("{error}");
    }
}

/// A graph with the symbols x, y, z, which have the ids 0, 1, 2.
pub(crate) fn graph() -> (Graph, Vec<Expr>) {
    let mut g = Graph::new();
    let symbols = ["x", "y", "z"].iter().map(|n| g.symbol(n)).collect();
    (g, symbols)
}

pub(crate) fn symbol(index: u32) -> SymbolId {
    SymbolId(index)
}

/// Runs a program on the symbols; its value is that of the last step.
pub(crate) fn build(g: &mut Graph, symbols: &[Expr], kind: Kind, program: &[Step]) -> Expr {
    let mut pool = symbols.to_vec();
    for &(operation, a, b, number) in program {
        let pick = |i: u8| pool[pool.len() - 1 - usize::from(i) % pool.len()];
        let (a, b, third) = (pick(a), pick(b), pick(a ^ b));
        let small = number % 5;
        let operations = match kind {
            Kind::Rational => 8,
            Kind::Circular => 10,
            Kind::Any => 18,
        };
        let result = match operation % operations {
            0 => g.add(a, b),
            1 => g.sub(a, b),
            2 | 3 => g.mul(a, b),
            4 if b != Graph::ZERO => g.div(a, b),
            5 if a != Graph::ZERO || small >= 0 => g.pow(a, small.into()),
            6 => g.scale(&Rational::new(number.into(), 4), a),
            7 => {
                let sum = g.add(a, b);
                g.name("named", sum)
            }
            8 => g.sin(a),
            9 => g.cos(a),
            10 | 11 => g.function(FUNCTIONS[usize::from(number.unsigned_abs()) % 13], a),
            12 => g.atan2(a, b),
            13 => {
                let exponent = g.fraction(number.into(), 3);
                if a == Graph::ZERO {
                    a
                } else {
                    g.power(a, exponent)
                }
            }
            14 if a != Graph::ZERO => g.power(a, b),
            15 => g.choice(Relation::Less, [a, b], [b, third]),
            16 => g.choice(Relation::LessOrEqual, [third, b], [a, b]),
            17 => {
                let three = g.integer(3);
                let diagonal = g.add(three, b);
                g.solve_numerically(vec![three, a, Graph::ONE, diagonal], vec![b, third])
                    [usize::from(number > 0)]
            }
            _ => a,
        };
        pool.push(result);
    }
    pool[pool.len() - 1]
}

/// An expression for a failure message.
pub(crate) fn show(g: &Graph, e: Expr) -> String {
    use appell_codegen::symbolic::Node;
    match g.node(e) {
        Node::Number(n) => n.to_string(),
        Node::Symbol(s) => g.symbol_name(*s).to_owned(),
        Node::Named(id) => format!("[{}]", show(g, g.definition(*id).value)),
        Node::Sum(terms) => {
            let parts: Vec<String> = terms
                .iter()
                .map(|t| format!("{}*{}", t.coefficient, show(g, t.expr)))
                .collect();
            format!("({})", parts.join(" + "))
        }
        Node::Product(factors) => {
            let parts: Vec<String> = factors
                .iter()
                .map(|f| format!("{}^{}", show(g, f.base), f.exponent))
                .collect();
            format!("({})", parts.join(" "))
        }
        Node::Function(f, x) => format!("{f:?}({})", show(g, *x)),
        Node::Power(a, b) => format!("({} ** {})", show(g, *a), show(g, *b)),
        Node::Atan2(a, b) => format!("atan2({}, {})", show(g, *a), show(g, *b)),
        Node::Choice {
            relation,
            compared: [a, b],
            branches: [c, d],
        } => {
            let [a, b, c, d] = [a, b, c, d].map(|e| show(g, *e));
            format!("({a} {relation:?} {b} ? {c} : {d})")
        }
        Node::Solution { system, row } => {
            let system = g.system(*system);
            let show = |all: &[Expr]| {
                all.iter()
                    .map(|&e| show(g, e))
                    .collect::<Vec<_>>()
                    .join(", ")
            };
            format!(
                "solve({} | {})[{row}]",
                show(&system.matrix),
                show(&system.right)
            )
        }
    }
}
