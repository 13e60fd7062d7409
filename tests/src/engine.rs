//! The executions of a schedule: interpreted, emitted, compiled in the process.

use appell_codegen::interpreted::InterpretedModel;
use appell_codegen::jit::JitModel;
use appell_codegen::program::Program;
use appell_codegen::schedule::schedule;
use appell_codegen::symbolic::evaluate;
use appell_codegen::tape::interpret_weighted;
use appell_models::Shipped;
use appell_runtime::model::{At, Model};
use appell_spec::Mechanism;

use crate::point::Point;
use crate::shipped;

/// A model and how it is executed.
pub struct Engine {
    /// For messages.
    pub name: &'static str,
    /// The model, for as long as the process lives.
    pub model: &'static dyn Model,
}

/// Every execution of a shipped mechanism.
pub fn engines(name: &str) -> Vec<Engine> {
    let emitted = Shipped::find(name).unwrap_or_else(|| panic!("`{name}` was not emitted"));
    vec![
        interpreted(shipped::model(name)),
        compiled(shipped::program(name)),
        Engine {
            name: "emitted",
            model: emitted.model,
        },
    ]
}

/// The executions that need no build: of any program.
pub fn in_process(program: Program) -> Vec<Engine> {
    let compiled = compiled(&program);
    let model = Box::leak(Box::new(InterpretedModel::new(program)));
    vec![interpreted(model), compiled]
}

fn interpreted(model: &'static InterpretedModel) -> Engine {
    Engine {
        name: "interpreted",
        model,
    }
}

fn compiled(program: &Program) -> Engine {
    let jit =
        JitModel::new(program).unwrap_or_else(|error| panic!("{}: {error}", program.info.name));
    Engine {
        name: "compiled in the process",
        model: Box::leak(Box::new(jit)),
    }
}

/// The interpreter of any mechanism.
pub fn interpreter(mechanism: &Mechanism) -> InterpretedModel {
    InterpretedModel::new(shipped::standard_program(mechanism))
}

/// Everything a model computes at a point.
#[derive(Debug, Clone)]
pub struct Evaluation {
    /// ẋ.
    pub rates: Vec<f64>,
    /// A, row by row.
    pub a: Vec<f64>,
    /// B, row by row.
    pub b: Vec<f64>,
    /// P, row by row.
    pub p: Vec<f64>,
    /// M, row by row.
    pub mass_matrix: Vec<f64>,
    /// b of Appell's equations.
    pub bias: Vec<f64>,
    /// Π.
    pub forces: Vec<f64>,
    /// Kinetic and potential energy, power, acceleration energy.
    pub energies: Vec<f64>,
    /// Constraint residual.
    pub residual: Vec<f64>,
    /// Reactions.
    pub reactions: Vec<f64>,
    /// Outputs.
    pub outputs: Vec<f64>,
    /// Normals of the contacts, then coefficients of friction.
    pub contacts: Vec<f64>,
    /// Matrices of the systems solved with pivoting.
    pub systems: Vec<f64>,
    /// M ω̇ + b − Π of some ω̇.
    pub demand: Vec<f64>,
    /// Its derivatives with respect to state, inputs and ω̇.
    pub demand_by: [Vec<f64>; 3],
}

impl Evaluation {
    /// Calls every function of a model.
    pub fn of(model: &dyn Model, at: At<'_>) -> Self {
        let info = model.info();
        let (n, m, k, s) = (
            info.state_len(),
            info.input_len(),
            info.parameter_len(),
            info.speeds,
        );
        let nan = |len: usize| vec![f64::NAN; len];
        let mut e = Self {
            rates: nan(n),
            a: nan(n * n),
            b: nan(n * m),
            p: nan(n * k),
            mass_matrix: nan(s * s),
            bias: nan(s),
            forces: nan(s),
            energies: Vec::new(),
            residual: nan(info.constraint_rows.len()),
            reactions: nan(3 * info.reactions.len()),
            outputs: nan(info.output_len()),
            contacts: nan(4 * info.contacts.len()),
            systems: nan(model.system_sizes().iter().map(|n| n * n).sum()),
            demand: nan(s),
            demand_by: [nan(s * n), nan(s * m), nan(s * s)],
        };
        model.jacobians(at, &mut e.rates, &mut e.a, &mut e.b);
        model.rates(at, &mut e.rates);
        model.parameter_jacobian(at, &mut e.p);
        model.appell(at, &mut e.mass_matrix, &mut e.bias, &mut e.forces);
        let energies = model.energies(at);
        e.energies = vec![
            energies.kinetic,
            energies.potential,
            energies.power,
            energies.acceleration,
        ];
        model.constraint_residual(at, &mut e.residual);
        model.constraint_forces(at, &mut e.reactions);
        model.outputs(at, &mut e.outputs);
        let (normals, friction) = e.contacts.split_at_mut(3 * info.contacts.len());
        model.contacts(at, normals, friction);
        model.systems(at, &mut e.systems);
        let given = some_accelerations(at.x, s);
        let [by_state, by_inputs, mass] = &mut e.demand_by;
        model.inverse_dynamics_jacobians(at, &given, &mut e.demand, by_state, by_inputs, mass);
        model.inverse_dynamics(at, &given, &mut e.demand);
        e
    }

    /// Its arrays with their names.
    pub fn arrays(&self) -> [(&'static str, &[f64]); 17] {
        [
            ("rates", &self.rates),
            ("A", &self.a),
            ("B", &self.b),
            ("P", &self.p),
            ("mass matrix", &self.mass_matrix),
            ("bias", &self.bias),
            ("forces", &self.forces),
            ("energies", &self.energies),
            ("residual", &self.residual),
            ("reactions", &self.reactions),
            ("outputs", &self.outputs),
            ("contacts", &self.contacts),
            ("systems", &self.systems),
            ("demand", &self.demand),
            ("demand by state", &self.demand_by[0]),
            ("demand by inputs", &self.demand_by[1]),
            ("demand by accelerations", &self.demand_by[2]),
        ]
    }
}

/// Pseudo-accelerations that no motion has.
pub fn some_accelerations(x: &[f64], speeds: usize) -> Vec<f64> {
    x.iter().take(speeds).map(|w| 1.5 - w).collect()
}

/// Two orders of a thousand operations round differently.
const SCHEDULES: f64 = 1e-11;

/// Demands that the schedules of a program compute what was derived: every result against the
/// graph, evaluated expression by expression.
pub fn assert_schedules(program: &Program, points: &[Point]) {
    let schedules: Vec<_> = program
        .functions
        .iter()
        .map(|f| (f, schedule(program, f)))
        .collect();
    for point in points {
        let arguments = &program.arguments;
        let given = some_accelerations(&point.x, program.info.speeds);
        for (function, schedule) in &schedules {
            // The circle constant is a symbol that is no argument.
            let mut values = vec![std::f64::consts::PI; function.graph.symbol_count()];
            let symbols = [&arguments.states, &arguments.inputs, &arguments.parameters];
            for (symbols, numbers) in symbols.into_iter().zip([&point.x, &point.u, &point.p]) {
                for (symbol, &number) in symbols.iter().zip(numbers) {
                    values[symbol.0 as usize] = number;
                }
            }
            values[arguments.time.0 as usize] = point.t;
            for (symbol, &number) in function.own.iter().zip(&given) {
                values[symbol.0 as usize] = number;
            }
            let results = interpret_weighted(schedule, point.at(), &given);
            for (array, scheduled) in function.results.iter().zip(results) {
                let derived = evaluate(&function.graph, &values, &array.entries);
                let what = format!("{}, {:?}, {}", program.info.name, function.kind, array.name);
                assert_close(&what, &scheduled, &derived, SCHEDULES, 1e-3);
            }
        }
    }
}

/// Demands that two arrays agree up to `tolerance` of their largest entry, or of `floor` where all
/// entries are smaller.
///
/// # Panics
///
/// Where they do not, with the entry.
pub fn assert_close(what: &str, got: &[f64], wanted: &[f64], tolerance: f64, floor: f64) {
    assert_eq!(got.len(), wanted.len(), "{what}: lengths");
    let scale = got
        .iter()
        .chain(wanted)
        .fold(floor, |scale, x| scale.max(x.abs()));
    for (i, (got, wanted)) in got.iter().zip(wanted).enumerate() {
        let error = (got - wanted).abs();
        // A difference that is no number fails as well.
        let close = error <= tolerance * scale;
        assert!(
            close,
            "{what}, entry {i}: {got:e} against {wanted:e}, off by {error:.2e} at a scale of {scale:.2e}"
        );
    }
}
