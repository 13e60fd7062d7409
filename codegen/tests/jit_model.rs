//! A program in machine code behaves like every model.
#![allow(clippy::float_cmp, reason = "agreement is bit for bit")]
#![allow(clippy::unwrap_used, reason = "a test that cannot go on fails")]

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::Arc;
use std::thread;

use appell_codegen::interpreted::InterpretedModel;
use appell_codegen::jit::{JitError, JitModel};
use appell_codegen::program::{Arguments, Array, Function, FunctionKind, Layout, Program};
use appell_codegen::schedule::schedule;
use appell_codegen::symbolic::{Expr, Graph};
use appell_codegen::tape::interpret;
use appell_runtime::model::{At, Model, ModelInfo, Quantity};

/// A driven pendulum ẇ = (u - g l sin θ - c w |w|) / l², θ̇ = w. Its derivatives are written out.
#[expect(clippy::too_many_lines, reason = "one mechanism, equation by equation")]
fn pendulum() -> Program {
    let mut graph = Graph::new();
    let g = &mut graph;
    let [t, w, theta, u, l, c] = ["t", "w", "theta", "u", "l", "c"].map(|name| g.symbol(name));
    let (sin, cos) = (g.sin(theta), g.cos(theta));
    let speed = g.function(appell_codegen::symbolic::Function::Abs, w);
    let drag = g.product(&[c, w, speed]);
    let weight = g.mul(l, sin);
    let force = g.sum(&[u]);
    let loads = g.sub(force, drag);
    let loads = g.sub(loads, weight);
    let inertia = g.square(l);
    let w_dot = g.div(loads, inertia);
    let a_ww = {
        let twice = g.integer(-2);
        let slope = g.product(&[twice, c, speed]);
        g.div(slope, inertia)
    };
    let a_wt = {
        let slope = g.div(cos, l);
        g.neg(slope)
    };
    let b_w = g.pow(l, -2);
    let p_wl = {
        let cube = g.pow(l, -3);
        let twice = g.integer(-2);
        let first = g.product(&[twice, loads, cube]);
        let second = g.div(sin, inertia);
        g.sub(first, second)
    };
    let p_wc = {
        let square = g.mul(w, speed);
        let slope = g.div(square, inertia);
        g.neg(slope)
    };
    let (zero, one) = (Graph::ZERO, Graph::ONE);
    let kinetic = {
        let square = g.square(w);
        let twice = g.mul(inertia, square);
        let half = g.fraction(1, 2);
        g.mul(half, twice)
    };
    let total = {
        let square = g.square(w_dot);
        let twice = g.mul(inertia, square);
        let half = g.fraction(1, 2);
        g.mul(half, twice)
    };
    let potential = {
        let height = g.mul(l, cos);
        g.neg(height)
    };
    let power = g.mul(u, w);
    let function = |kind, results: Vec<(&str, Vec<Expr>)>| {
        let array = |(name, entries): (&str, Vec<Expr>)| {
            Array::new(name, "", Layout::List(entries.len()), entries)
        };
        Function::new(kind, results.into_iter().map(array).collect())
    };
    let rates = ("rates", vec![w_dot, w]);
    let (a, b) = (("a", vec![a_ww, a_wt, one, zero]), ("b", vec![b_w, zero]));
    let p = ("p", vec![p_wl, p_wc, zero, zero]);
    let functions = vec![
        function(
            FunctionKind::Kinematics,
            vec![("coordinate_rates", vec![w])],
        ),
        function(
            FunctionKind::AccelerationEnergy,
            vec![("total", vec![total]), ("bob", vec![total])],
        ),
        function(
            FunctionKind::MassMatrixAndBias,
            vec![("mass_matrix", vec![inertia]), ("bias", vec![zero])],
        ),
        function(
            FunctionKind::GeneralizedForces,
            vec![("generalized_forces", vec![loads])],
        ),
        function(FunctionKind::Rates, vec![rates.clone()]),
        function(FunctionKind::Jacobians, vec![rates, a, b]),
        function(FunctionKind::ParameterJacobian, vec![p]),
        function(
            FunctionKind::Energies,
            vec![
                ("kinetic", vec![kinetic]),
                ("potential", vec![potential]),
                ("power", vec![power]),
            ],
        ),
        function(FunctionKind::Outputs, vec![("outputs", vec![sin])]),
    ];
    let symbol = |expr| graph.as_symbol(expr).unwrap();
    let arguments = Arguments {
        time: symbol(t),
        pi: None,
        states: vec![symbol(w), symbol(theta)],
        inputs: vec![symbol(u)],
        parameters: vec![symbol(l), symbol(c)],
    };
    let quantities = |names: &[&str]| -> Vec<Quantity> {
        let quantity = |name: &&str| Quantity {
            name: (*name).to_owned().into(),
            about: "".into(),
            unit: "1".into(),
            scale: 1.0,
            value: 0.0,
            range: [f64::NEG_INFINITY, f64::INFINITY],
        };
        names.iter().map(quantity).collect()
    };
    let info = ModelInfo {
        name: "pendulum".into(),
        title: "A driven pendulum.".into(),
        source: "".into(),
        states: quantities(&["w", "theta"]).into(),
        speeds: 1,
        inputs: quantities(&["u"]).into(),
        declared_inputs: 1,
        signals: vec![].into(),
        signal_inputs: vec![].into(),
        parameters: quantities(&["l", "c"]).into(),
        outputs: quantities(&["height"]).into(),
        constraint_rows: vec![].into(),
        reactions: vec![].into(),
        contacts: vec![].into(),
        explicit_time: false,
    };
    let graph = Arc::new(graph);
    Program {
        info,
        file: "pendulum.toml".to_owned(),
        arguments,
        dependent: Vec::new(),
        systems: Vec::new(),
        hints: Arc::default(),
        functions: (functions.into_iter())
            .map(|function| function.over(graph.clone(), Vec::new()))
            .collect(),
    }
}

const AT: At<'static> = At {
    t: 0.0,
    x: &[-0.8, 0.6],
    u: &[0.3],
    p: &[1.7, 0.2],
};

/// A function of the program, step by step.
fn interpreted(program: &Program, kind: FunctionKind) -> Vec<Vec<f64>> {
    let function = program
        .functions
        .iter()
        .find(|function| function.kind == kind)
        .unwrap();
    interpret(&schedule(program, function), AT.t, AT.x, AT.u, AT.p)
}

#[test]
fn every_method_agrees_with_the_interpreter() {
    let program = pendulum();
    let model = JitModel::new(&program).unwrap();
    assert_eq!(model.info(), &program.info);

    let mut rates = [9.0; 2];
    model.rates(AT, &mut rates);
    assert_eq!(
        vec![rates.to_vec()],
        interpreted(&program, FunctionKind::Rates)
    );

    let (mut rates, mut a, mut b) = ([9.0; 2], [9.0; 4], [9.0; 2]);
    model.jacobians(AT, &mut rates, &mut a, &mut b);
    let found = vec![rates.to_vec(), a.to_vec(), b.to_vec()];
    assert_eq!(found, interpreted(&program, FunctionKind::Jacobians));

    let mut p = [9.0; 4];
    model.parameter_jacobian(AT, &mut p);
    assert_eq!(
        p.to_vec(),
        interpreted(&program, FunctionKind::ParameterJacobian)[0]
    );

    let (mut mass, mut bias, mut forces) = ([9.0; 1], [9.0; 1], [9.0; 1]);
    model.appell(AT, &mut mass, &mut bias, &mut forces);
    assert_eq!(
        vec![mass.to_vec(), bias.to_vec()],
        interpreted(&program, FunctionKind::MassMatrixAndBias)
    );
    assert_eq!(
        vec![forces.to_vec()],
        interpreted(&program, FunctionKind::GeneralizedForces)
    );

    let energies = model.energies(AT);
    let expected = interpreted(&program, FunctionKind::Energies);
    let found = [energies.kinetic, energies.potential, energies.power];
    assert_eq!(found.map(|energy| vec![energy]).to_vec(), expected);
    let total = interpreted(&program, FunctionKind::AccelerationEnergy)[0][0];
    assert_eq!(energies.acceleration.to_bits(), total.to_bits());

    let mut outputs = [9.0; 1];
    model.outputs(AT, &mut outputs);
    assert_eq!(
        vec![outputs.to_vec()],
        interpreted(&program, FunctionKind::Outputs)
    );
}

#[test]
fn a_part_agrees_with_the_whole_where_its_parameters_are_zero_and_elsewhere() {
    let whole = Arc::new(JitModel::new(pendulum()).unwrap());
    let part = whole.without(&[1]);
    let (x, u) = ([0.7, -0.4], [1.3]);
    for c in [0.0, 0.25] {
        let at = At {
            t: 0.0,
            x: &x,
            u: &u,
            p: &[0.9, c],
        };
        let [mut own, mut all] = [[0.0; 12]; 2];
        for (model, to) in [(&part, &mut own), (&*whole, &mut all)] {
            let (rates, rest) = to.split_at_mut(2);
            let (a, rest) = rest.split_at_mut(4);
            let (b, p) = rest.split_at_mut(2);
            model.jacobians(at, rates, a, b);
            model.parameter_jacobian(at, p);
        }
        if c == 0.0 {
            // The model specialised for c = 0 omits the slope with respect to c.
            assert!(own[9] == 0.0 && all[9] != 0.0);
            all[9] = 0.0;
        }
        assert_eq!(own, all);
    }
}

#[test]
fn functions_without_entries_may_be_missing() {
    let model = JitModel::new(pendulum()).unwrap();
    model.constraint_residual(AT, &mut []);
    model.constraint_forces(AT, &mut []);
}

#[test]
fn slices_of_wrong_length_are_refused() {
    let model = JitModel::new(pendulum()).unwrap();
    let refused = |call: &dyn Fn()| catch_unwind(AssertUnwindSafe(call)).is_err();
    assert!(refused(&|| model.rates(AT, &mut [0.0; 1])));
    assert!(refused(
        &|| model.rates(At { x: &[0.0; 3], ..AT }, &mut [0.0; 2])
    ));
    assert!(refused(&|| model.jacobians(
        AT,
        &mut [0.0; 2],
        &mut [0.0; 4],
        &mut [0.0; 3]
    )));
}

#[test]
fn first_uses_from_several_threads_agree() {
    let program = pendulum();
    let model = JitModel::new(&program).unwrap();
    let expected = interpreted(&program, FunctionKind::ParameterJacobian).remove(0);
    thread::scope(|scope| {
        for _ in 0..4 {
            scope.spawn(|| {
                let mut p = [0.0; 4];
                model.parameter_jacobian(AT, &mut p);
                assert_eq!(p.to_vec(), expected);
            });
        }
    });
}

#[test]
fn functions_that_cannot_be_compiled_are_interpreted() {
    let mut program = pendulum();
    // More unknowns than machine code takes.
    let rows = 65;
    let entry = |kind: FunctionKind| {
        let function = program
            .functions
            .iter()
            .find(|function| function.kind == kind);
        function.unwrap().results[0].entries[0]
    };
    let (w, inertia) = (
        entry(FunctionKind::Kinematics),
        entry(FunctionKind::MassMatrixAndBias),
    );
    let matrix = (0..rows * rows).map(|k| {
        if k % (rows + 1) == 0 {
            inertia
        } else {
            Graph::ZERO
        }
    });
    let outputs = program.functions.last_mut().unwrap();
    let graph = Arc::make_mut(&mut outputs.graph);
    let unknowns = graph.solve_numerically(matrix.collect(), vec![w; rows]);
    outputs.results[0].entries[0] = unknowns[7];

    let model = JitModel::new(&program).unwrap();
    let mut outputs = [9.0; 1];
    model.outputs(AT, &mut outputs);
    assert_eq!(outputs, [AT.x[0] / (AT.p[0] * AT.p[0])]);
    let wrong = AssertUnwindSafe(|| model.outputs(AT, &mut []));
    assert!(catch_unwind(wrong).is_err());
}

#[test]
fn programs_that_contradict_themselves_are_refused() {
    let mut without_rates = pendulum();
    without_rates
        .functions
        .retain(|function| function.kind != FunctionKind::Rates);
    assert!(matches!(
        JitModel::new(&without_rates).unwrap_err(),
        JitError::MissingFunction {
            kind: FunctionKind::Rates
        }
    ));
    let mut short = pendulum();
    for array in short.functions.iter_mut().flat_map(|f| &mut f.results) {
        array.entries.truncate(3);
    }
    let model = JitModel::new(&short).unwrap();
    let call =
        AssertUnwindSafe(|| model.jacobians(AT, &mut [0.0; 2], &mut [0.0; 4], &mut [0.0; 2]));
    assert!(catch_unwind(call).is_err());
}

#[test]
fn functions_that_a_program_lacks_return_nan() {
    let mut program = pendulum();
    program
        .functions
        .retain(|function| function.kind != FunctionKind::Outputs);
    for model in [
        &JitModel::new(&program).unwrap() as &dyn Model,
        &InterpretedModel::new(program),
    ] {
        let mut outputs = [9.0; 1];
        model.outputs(AT, &mut outputs);
        assert!(outputs[0].is_nan());
    }
}
