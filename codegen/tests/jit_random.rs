//! Random tapes: machine code and interpreter agree bit for bit.
#![allow(clippy::unwrap_used, reason = "a test that cannot go on fails")]

use appell_codegen::symbolic::{Function, Rational, Relation};
use appell_codegen::tape::{Argument, Arithmetic, Tape};
use proptest::prelude::*;

use crate::jit_support::{Point, Step, Tree, agrees, tape, value};

/// A step whose trees name values by any number; [`assemble`] makes them earlier values.
#[derive(Debug, Clone)]
enum Plan {
    Let(Tree),
    SinCos(Tree),
    /// A matrix of 1 to 4 rows and two right-hand sides, cut from one list.
    System(usize, Vec<Tree>),
}

fn leaf() -> impl Strategy<Value = Tree> {
    prop_oneof![
        3 => any::<u32>().prop_map(value),
        1 => Just(Tree::Argument(Argument::Time)),
        3 => (0..3_u32).prop_map(|index| Tree::Argument(Argument::State(index))),
        1 => (0..2_u32).prop_map(|index| Tree::Argument(Argument::Input(index))),
        1 => (0..2_u32).prop_map(|index| Tree::Argument(Argument::Parameter(index))),
        2 => (-40..40_i64, 1..9_i64).prop_map(|(n, d)| Tree::Constant(Rational::new(n, d))),
    ]
}

fn function() -> impl Strategy<Value = Function> {
    prop::sample::select(vec![
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
    ])
}

fn operation() -> impl Strategy<Value = Arithmetic> {
    prop::sample::select(vec![
        Arithmetic::Add,
        Arithmetic::Subtract,
        Arithmetic::Multiply,
        Arithmetic::Divide,
    ])
}

fn tree() -> impl Strategy<Value = Tree> {
    leaf().prop_recursive(4, 24, 4, |part| {
        let boxed = || part.clone().prop_map(Box::new);
        let pair = || [part.clone(), part.clone()].prop_map(Box::new);
        prop_oneof![
            1 => boxed().prop_map(Tree::Negate),
            6 => (operation(), boxed(), boxed()).prop_map(|(o, a, b)| Tree::Binary(o, a, b)),
            2 => (function(), boxed()).prop_map(|(f, a)| Tree::Function(f, a)),
            1 => (boxed(), boxed()).prop_map(|(y, x)| Tree::Atan2(y, x)),
            1 => (boxed(), boxed()).prop_map(|(b, e)| Tree::Power(b, e)),
            1 => (any::<bool>(), pair(), pair()).prop_map(|(strict, compared, branches)| {
                let relation = if strict { Relation::Less } else { Relation::LessOrEqual };
                Tree::Choice { relation, compared, branches }
            }),
        ]
    })
}

fn plan() -> impl Strategy<Value = Plan> {
    prop_oneof![
        6 => tree().prop_map(Plan::Let),
        2 => tree().prop_map(Plan::SinCos),
        1 => (1..=4_usize, prop::collection::vec(tree(), 24)).prop_map(|(n, t)| Plan::System(n, t)),
    ]
}

/// Gives values their numbers and returns all of them.
fn assemble(plans: Vec<Plan>) -> Tape {
    let mut steps = Vec::new();
    let mut defined = 0_u32;
    let mut factorisations = 0..;
    for plan in plans {
        let known = defined;
        let mut define = || {
            defined += 1;
            defined - 1
        };
        match plan {
            Plan::Let(tree) => steps.push(Step::Let {
                value: define(),
                tree: bound(tree, known),
            }),
            Plan::SinCos(angle) => steps.push(Step::SinCos {
                sin: define(),
                cos: define(),
                angle: bound(angle, known),
            }),
            Plan::System(size, trees) => {
                let factorisation = factorisations.next().unwrap();
                let mut trees = trees.into_iter().map(|tree| bound(tree, known));
                let matrix = trees.by_ref().take(size * size).collect();
                steps.push(Step::Factor {
                    factorisation,
                    matrix,
                });
                for _ in 0..2 {
                    let right = trees.by_ref().take(size).collect();
                    let values = (0..size).map(|_| define()).collect();
                    steps.push(Step::Solve {
                        factorisation,
                        values,
                        right,
                    });
                }
            }
        }
    }
    tape(steps, (0..defined).map(value).collect())
}

/// The tree with its values reduced to the first `known`; time replaces them if there are none.
fn bound(tree: Tree, known: u32) -> Tree {
    let into = |tree: Box<Tree>| Box::new(bound(*tree, known));
    match tree {
        Tree::Value(_) if known == 0 => Tree::Argument(Argument::Time),
        Tree::Value(index) => value(index % known),
        leaf @ (Tree::Argument(_) | Tree::Constant(_)) => leaf,
        Tree::Negate(a) => Tree::Negate(into(a)),
        Tree::Binary(operation, a, b) => Tree::Binary(operation, into(a), into(b)),
        Tree::Function(function, a) => Tree::Function(function, into(a)),
        Tree::Atan2(y, x) => Tree::Atan2(into(y), into(x)),
        Tree::Power(base, exponent) => Tree::Power(into(base), into(exponent)),
        Tree::Choice {
            relation,
            compared,
            branches,
        } => Tree::Choice {
            relation,
            compared: Box::new(compared.map(|tree| bound(tree, known))),
            branches: Box::new(branches.map(|tree| bound(tree, known))),
        },
    }
}

fn coordinate() -> impl Strategy<Value = f64> + Clone {
    prop_oneof![
        8 => -4.0..4.0_f64,
        1 => prop::sample::select(vec![0.0, -0.0, 1.0, -1.0, 1.0e-12, 1.0e30]),
    ]
}

fn point() -> impl Strategy<Value = Point> {
    let pair = || [coordinate(), coordinate()];
    (
        coordinate(),
        [coordinate(), coordinate(), coordinate()],
        pair(),
        pair(),
    )
        .prop_map(|(t, x, u, p)| Point { t, x, u, p })
}

proptest! {
    #![proptest_config(ProptestConfig {
        cases: 256,
        failure_persistence: None,
        ..ProptestConfig::default()
    })]

    #[test]
    fn random_schedules_agree(plans in prop::collection::vec(plan(), 1..24), point in point()) {
        agrees(&assemble(plans), &point);
    }
}
