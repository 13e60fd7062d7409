//! Derivatives of the rates by dual numbers on the graph, for comparison with derived Jacobians.

use std::collections::BTreeMap;

use appell_codegen::program::{FunctionKind, Program};
use appell_codegen::symbolic::{Expr, Function, Graph, Node, Relation, SymbolId};
use appell_runtime::{Dual, Real};

use crate::point::Point;

type D = Dual<f64, 1>;

/// A, B and P of a program, each row by row.
pub fn jacobians(program: &Program, point: &Point) -> [Vec<f64>; 3] {
    let arguments = &program.arguments;
    let function = program.function(FunctionKind::Rates).unwrap();
    let (graph, rates) = (&*function.graph, &function.results[0].entries);
    let pi = program.info.parameters.iter().position(|p| p.name == "pi");
    assert!(pi.is_none(), "`pi` is reserved");
    let mut values = vec![D::fixed(std::f64::consts::PI); graph.symbol_count()];
    let groups = [
        (&arguments.states, &point.x),
        (&arguments.inputs, &point.u),
        (&arguments.parameters, &point.p),
    ];
    for (symbols, numbers) in groups {
        for (symbol, &number) in symbols.iter().zip(numbers) {
            values[symbol.0 as usize] = D::fixed(number);
        }
    }
    values[arguments.time.0 as usize] = D::fixed(point.t);
    let order = graph.in_order(rates);
    let mut column = |symbol: &SymbolId| -> Vec<f64> {
        let place = symbol.0 as usize;
        values[place].partials = [1.0];
        let results = evaluate(graph, &order, &values, rates);
        values[place].partials = [0.0];
        results.iter().map(|d| d.partials[0]).collect()
    };
    [&arguments.states, &arguments.inputs, &arguments.parameters].map(|symbols| {
        let columns: Vec<Vec<f64>> = symbols.iter().map(&mut column).collect();
        (0..rates.len())
            .flat_map(|row| columns.iter().map(move |column| column[row]))
            .collect()
    })
}

fn evaluate(g: &Graph, order: &[Expr], symbols: &[D], roots: &[Expr]) -> Vec<D> {
    let mut known: BTreeMap<Expr, D> = BTreeMap::new();
    let mut solutions: BTreeMap<u32, Vec<D>> = BTreeMap::new();
    let one = D::fixed(1.0);
    for &expr in order {
        let of = |e: &Expr| known[e];
        let value = match g.node(expr) {
            Node::Number(n) => D::fixed(n.to_f64()),
            Node::Symbol(symbol) => symbols[symbol.0 as usize],
            Node::Named(id) => of(&g.definition(*id).value),
            Node::Sum(terms) => terms.iter().fold(D::fixed(0.0), |sum, t| {
                sum + D::fixed(t.coefficient.to_f64()) * of(&t.expr)
            }),
            Node::Product(factors) => factors.iter().fold(one, |product, f| {
                let base = of(&f.base);
                let power = (0..f.exponent.unsigned_abs()).fold(one, |power, _| power * base);
                if f.exponent < 0 {
                    product / power
                } else {
                    product * power
                }
            }),
            Node::Function(function, x) => apply(*function, of(x)),
            Node::Atan2(y, x) => of(y).atan2(of(x)),
            Node::Power(base, exponent) => of(base).powf(of(exponent)),
            Node::Choice {
                relation,
                compared,
                branches,
            } => {
                let [[left, right], [then, otherwise]] =
                    [compared, branches].map(|pair| [of(&pair[0]), of(&pair[1])]);
                match relation {
                    Relation::Less => D::if_less(left, right, then, otherwise),
                    Relation::LessOrEqual => D::if_less_or_equal(left, right, then, otherwise),
                }
            }
            Node::Solution { system, row } => {
                let unknowns = solutions.entry(*system).or_insert_with(|| {
                    let system = g.system(*system);
                    solve(
                        system.matrix.iter().map(of).collect(),
                        system.right.iter().map(of).collect(),
                    )
                });
                unknowns[*row as usize]
            }
        };
        known.insert(expr, value);
    }
    roots.iter().map(|root| known[root]).collect()
}

fn apply(function: Function, x: D) -> D {
    match function {
        Function::Sin => x.sin(),
        Function::Cos => x.cos(),
        Function::Asin => x.asin(),
        Function::Acos => x.acos(),
        Function::Atan => x.atan(),
        Function::Sinh => x.sinh(),
        Function::Cosh => x.cosh(),
        Function::Tanh => x.tanh(),
        Function::Exp => x.exp(),
        Function::Ln => x.ln(),
        Function::Sqrt => x.sqrt(),
        Function::Abs => x.abs(),
        Function::Sign => x.sign(),
    }
}

/// Elimination with the largest pivot of each column.
fn solve(mut a: Vec<D>, mut b: Vec<D>) -> Vec<D> {
    let n = b.len();
    for k in 0..n {
        let size = |i: usize| a[i * n + k].value.abs();
        let pivot = (k..n).max_by(|&i, &j| size(i).total_cmp(&size(j))).unwrap();
        for j in 0..n {
            a.swap(k * n + j, pivot * n + j);
        }
        b.swap(k, pivot);
        for i in k + 1..n {
            let factor = a[i * n + k] / a[k * n + k];
            for j in k..n {
                a[i * n + j] = a[i * n + j] - factor * a[k * n + j];
            }
            b[i] = b[i] - factor * b[k];
        }
    }
    for k in (0..n).rev() {
        let known = (k + 1..n).fold(D::fixed(0.0), |sum, j| sum + a[k * n + j] * b[j]);
        b[k] = (b[k] - known) / a[k * n + k];
    }
    b
}
