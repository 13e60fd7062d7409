//! Taylor series from the schedule of the rates.
#![allow(clippy::unwrap_used, reason = "a test that cannot go on fails")]

use appell_codegen::compile;
use appell_codegen::interpreted::InterpretedModel;
use appell_codegen::jit::JitModel;
use appell_codegen::program::{FunctionKind, Program};
use appell_codegen::schedule::{
    Argument, Operation, ResultArray, Schedule, Step, Tree, Value, schedule,
};
use appell_codegen::symbolic::Rational;
use appell_codegen::taylor::{InterpretedSeries, Lengths, expand, expand_under};
use appell_runtime::Simulation;
use appell_runtime::integrate::{Expanded, Taylor};
use appell_runtime::model::Model;
use appell_runtime::series::Series;
use appell_runtime::simulate::{Method, SimulationError};

/// Rounding of a recurrence: coefficients of neighbouring orders cancel.
const ROUNDING: f64 = 2e-13;

/// A mass of 1 kg under a force in N, with `T` for the time in s.
fn carriage(force: &str) -> Program {
    let force = force.replace('T', "(rate*t)");
    let text = format!(
        "[mechanism]\nname = 'carriage'\ntitle = 'carriage'\n\
         [parameters]\nm = {{ value = 1, unit = 'kg' }}\nF_0 = {{ value = 1, unit = 'N' }}\n\
         X = {{ value = 1, unit = 'm' }}\nV = {{ value = 1, unit = 'm/s' }}\n\
         rate = {{ value = 1, unit = '1/s' }}\n\
         [coordinates]\nx = {{ unit = 'm' }}\n\
         [points]\nC = {{ from = 'O', in = 'ground', at = ['x', 0, 0] }}\n\
         [bodies]\nb = {{ centre = 'C', mass = 'm' }}\n\
         [pseudo_velocities]\nv = {{ value = 'dot(x)', unit = 'm/s' }}\n\
         [loads]\npush = {{ kind = 'force', on = 'C', in = 'ground', vector = ['F_0*({force})', 0, 0] }}\n"
    );
    compile("carriage.toml", &text, &FunctionKind::STANDARD)
        .unwrap_or_else(|report| panic!("{}", report.plain()))
}

/// Coefficients of the motion, `n` numbers an order.
fn coefficients(series: &dyn Series, p: &[f64], x: &[f64], order: usize) -> Vec<f64> {
    let equations = Expanded {
        series,
        parameters: p,
        inputs: Box::new(|_, _, _| {}),
    };
    let mut taylor = Taylor::new();
    taylor
        .coefficients(&equations, 0.0, x, order)
        .unwrap()
        .to_vec()
}

fn assert_close(found: &[f64], expected: &[f64], what: &str) {
    let size = expected.iter().fold(1.0, |size: f64, c| size.max(c.abs()));
    for (order, (found, expected)) in found.iter().zip(expected).enumerate() {
        // Coefficients grow with the inverse radius of convergence, and with them their rounding.
        let off = (found - expected).abs();
        assert!(
            off <= ROUNDING * size,
            "{what}, order {order}: {found} {expected}"
        );
    }
}

#[test]
fn every_operation_has_the_coefficients_of_fifty_digits() {
    let mut lines = include_str!("taylor_coefficients.txt").lines().skip(2);
    while let (Some(expression), Some(numbers)) = (lines.next(), lines.next()) {
        let expected: Vec<f64> = numbers
            .split_whitespace()
            .map(|c| c.parse().unwrap())
            .collect();
        let program = carriage(expression);
        let p = program.info.default_parameters();
        let (jit, interpreted) = (
            JitModel::new(&program).unwrap(),
            InterpretedModel::new(program),
        );
        let models: [&dyn Model; 2] = [&jit, &interpreted];
        let [compiled, interpreted] = models.map(|model| {
            let series = model.series().unwrap();
            let motion = coefficients(series, &p, &[0.0, 0.0], expected.len());
            let velocity = motion.iter().step_by(2).skip(1).enumerate();
            velocity
                .map(|(k, c)| c * (k + 1) as f64)
                .collect::<Vec<_>>()
        });
        assert_close(&compiled, &expected, expression);
        assert_eq!(compiled, interpreted, "{expression}");
    }
}

/// A schedule of one state.
struct Written(Schedule);

impl Written {
    fn new() -> Self {
        Self(Schedule {
            arguments: Vec::new(),
            steps: Vec::new(),
            results: Vec::new(),
            names: Vec::new(),
        })
    }

    fn value(&mut self) -> Value {
        let value = Value(u32::try_from(self.0.names.len()).unwrap());
        self.0.names.push(format!("v_{}", value.0));
        value
    }

    fn define(&mut self, tree: Tree) -> Tree {
        let value = self.value();
        self.0.steps.push(Step::Let { value, tree });
        Tree::Value(value)
    }

    fn binary(&mut self, operation: Operation, a: &Tree, b: &Tree) -> Tree {
        self.define(Tree::Binary(
            operation,
            Box::new(a.clone()),
            Box::new(b.clone()),
        ))
    }

    fn finish(mut self, entries: Vec<Tree>) -> Schedule {
        let name = "rates".to_owned();
        self.0.results.push(ResultArray { name, entries });
        self.0
    }
}

fn number(value: i64) -> Tree {
    Tree::Constant(Rational::new(value, 1))
}

/// Entries of a matrix and a right-hand side that depend on time and on the state.
fn system(written: &mut Written) -> [Tree; 6] {
    let (t, x) = (
        Tree::Argument(Argument::Time),
        Tree::Argument(Argument::State(0)),
    );
    let square = written.binary(Operation::Multiply, &x, &x);
    let sum = written.binary(Operation::Add, &t, &square);
    let first = written.binary(Operation::Add, &sum, &number(3));
    let product = written.binary(Operation::Multiply, &t, &x);
    let last = written.binary(Operation::Subtract, &x, &number(2));
    [first, x, product, number(2), t, last]
}

#[test]
fn a_linear_system_has_the_coefficients_of_its_solution_by_determinants() {
    let lengths = Lengths {
        states: 2,
        inputs: 0,
        parameters: 0,
    };
    let solved = {
        let mut written = Written::new();
        let [a, b, c, d, e, f] = system(&mut written);
        let values = vec![written.value(), written.value()];
        let entries = values.iter().map(|&value| Tree::Value(value)).collect();
        written.0.steps.push(Step::Factor {
            factorisation: 0,
            size: 2,
            matrix: vec![a, b, c, d],
        });
        written.0.steps.push(Step::Solve {
            factorisation: 0,
            values,
            right: vec![e, f],
        });
        written.finish(entries)
    };
    let by_determinants = {
        let mut written = Written::new();
        let [a, b, c, d, e, f] = system(&mut written);
        let mut determinant = |a: &Tree, b: &Tree, c: &Tree, d: &Tree| {
            let left = written.binary(Operation::Multiply, a, d);
            let right = written.binary(Operation::Multiply, b, c);
            written.binary(Operation::Subtract, &left, &right)
        };
        let whole = determinant(&a, &b, &c, &d);
        let (first, second) = (determinant(&e, &b, &f, &d), determinant(&a, &e, &c, &f));
        let first = written.binary(Operation::Divide, &first, &whole);
        let second = written.binary(Operation::Divide, &second, &whole);
        written.finish(vec![first, second])
    };
    let [solved, expected] = [solved, by_determinants].map(|schedule| {
        let series = InterpretedSeries(expand(&schedule, lengths));
        coefficients(&series, &[], &[0.5, 0.0], 12)
    });
    assert_close(&solved, &expected, "system");
    assert!(expected[11].abs() > 1e-3, "{expected:?}");
}

#[test]
fn a_law_in_front_gives_the_coefficients_of_equations_that_contain_it() {
    // ẋ = x u with u = t − x², and the same written out.
    let (t, x) = (
        Tree::Argument(Argument::Time),
        Tree::Argument(Argument::State(0)),
    );
    let law = {
        let mut law = Written::new();
        let square = law.binary(Operation::Multiply, &x, &x);
        let u = law.binary(Operation::Subtract, &t, &square);
        law.finish(vec![u])
    };
    let rates = |u: Option<Tree>, mut written: Written| {
        let u = u.unwrap_or(Tree::Argument(Argument::Input(0)));
        let product = written.binary(Operation::Multiply, &x, &u);
        written.finish(vec![product])
    };
    let whole = {
        let mut written = Written::new();
        let square = written.binary(Operation::Multiply, &x, &x);
        let u = written.binary(Operation::Subtract, &t, &square);
        rates(Some(u), written)
    };
    let lengths = Lengths {
        states: 1,
        inputs: 0,
        parameters: 0,
    };
    let composed = expand_under(&law, &rates(None, Written::new()), &[], lengths);
    let [composed, expected] = [composed, expand(&whole, lengths)]
        .map(|program| coefficients(&InterpretedSeries(program), &[], &[0.7], 12));
    assert_eq!(composed, expected);
}

#[test]
fn what_does_not_move_is_left_to_order_zero() {
    // A constant force: the sweep only divides by the order.
    let program = carriage("X/X + V*rate/(rate*V)");
    let rates = program.function(FunctionKind::Rates).unwrap();
    let series = expand(&schedule(&program, rates), Lengths::from(&program.info));
    assert_eq!((series.shape.products, series.shape.kept), (0, 0));
    assert!(series.sweep.steps.len() <= 1, "{:?}", series.sweep.steps);
    // Equal products are summed once, squares with themselves.
    let program = carriage("x*v/(X*V) + (x*v/(X*V))^2 + sin(x*v/(X*V))");
    let rates = program.function(FunctionKind::Rates).unwrap();
    let series = expand(&schedule(&program, rates), Lengths::from(&program.info));
    assert_eq!(series.shape.products, 4, "x v, its square, sine and cosine");
}

/// The motion for a second by Taylor series.
fn by_series(
    model: &dyn Model,
    state: [f64; 2],
) -> Result<appell_runtime::Trajectory, SimulationError> {
    Simulation {
        method: Method::Taylor,
        span: [0.0, 1.0],
        initial_state: state.to_vec(),
        ..Simulation::new(model)
    }
    .run()
}

#[test]
fn steps_end_where_a_state_changes_what_the_equations_are() {
    // Uniform up to x = X/2, then braked by 2 N: v² falls by 4 (x − 1/2).
    let model = JitModel::new(&carriage("if(x < X/2, 0, -2)")).unwrap();
    let motion = by_series(&model, [1.0, 0.0]).unwrap();
    let expected = [1.0 - 2.0 * 0.5, 0.5 + 0.5 - 0.25];
    for (found, expected) in motion.last_state().iter().zip(expected) {
        assert!((found - expected).abs() < 1e-14, "{found} {expected}");
    }
    let hits = motion.times().iter().filter(|t| (*t - 0.5).abs() < 1e-14);
    assert_eq!(hits.count(), 1, "{:?}", motion.times());
    assert!(motion.times().len() <= 5, "{:?}", motion.times());
}

#[test]
fn a_kink_at_the_start_is_left_on_the_right_side() {
    for (force, velocity) in [("1 + abs(v)/V", 1f64.exp() - 1.0), ("sign(v) - 2", -3.0)] {
        let model = JitModel::new(&carriage(force)).unwrap();
        let found = by_series(&model, [0.0, 0.0]).unwrap().last_state()[0];
        assert!(
            (found - velocity).abs() < 1e-10,
            "{force}: {found} {velocity}"
        );
    }
}

#[test]
fn dry_friction_brings_a_mass_to_rest() {
    let model = JitModel::new(&carriage("-sign(v)")).unwrap();
    let motion = by_series(&model, [0.5, 0.0]).unwrap();
    let [v, x] = motion.last_state() else {
        panic!("two states")
    };
    assert!(*v == 0.0 && (x - 0.125).abs() < 1e-15, "{v} {x}");
}

#[test]
fn a_place_to_which_both_branches_lead_is_told() {
    let model = JitModel::new(&carriage("if(v < 0*V, 1, -1)")).unwrap();
    let Err(SimulationError::Integration { failure, .. }) = by_series(&model, [0.5, 0.0]) else {
        panic!("it went on")
    };
    assert!((failure.t - 0.5).abs() < 1e-9, "{failure}");
    assert!(failure.to_string().contains("the step shrank"), "{failure}");
}

#[test]
fn a_root_without_a_series_is_told() {
    let model = JitModel::new(&carriage("sqrt(abs(x)/X)")).unwrap();
    let Err(SimulationError::Integration { failure, .. }) = by_series(&model, [1.0, 0.0]) else {
        panic!("it went on")
    };
    assert!(
        failure.to_string().contains("has no Taylor series"),
        "{failure}"
    );
}

#[test]
fn every_shipped_mechanism_moves_as_by_runge_kutta() {
    for (name, text) in appell_test_kit::shipped() {
        let program = compile(&name, &text, &FunctionKind::STANDARD).unwrap();
        let model = JitModel::new(&program).unwrap();
        let initial_state: Vec<f64> = model
            .info()
            .initial_state()
            .iter()
            .map(|x| x + 0.01)
            .collect();
        let [taylor, expected] = [Method::Taylor, Method::Dop853].map(|method| {
            let motion = Simulation {
                method,
                span: [0.0, 0.4],
                initial_state: initial_state.clone(),
                ..Simulation::new(&model)
            }
            .run();
            motion.unwrap_or_else(|error| panic!("{name}: {error}"))
        });
        assert_eq!(model.interpreted().count(), 0, "{name}");
        for (found, expected) in taylor.last_state().iter().zip(expected.last_state()) {
            let off = (found - expected).abs() / expected.abs().max(1.0);
            assert!(off < 1e-8, "{name}: {found} {expected}");
        }
        let (cost, known) = (taylor.statistics, expected.statistics);
        assert!(cost.steps < known.steps, "{name}: {cost:?} {known:?}");
    }
}
