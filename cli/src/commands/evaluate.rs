//! `appell evaluate`

use std::path::PathBuf;

use appell_runtime::condition::Conditions;
use appell_runtime::contact::ContactForces;
use appell_runtime::inputs::{ModelInputs, ZeroInputs};
use appell_runtime::model::{At, Model, Quantity};
use serde_json::{Map, Value, json};

use crate::engine::{self, Engine};
use appell::Error;
use appell::cases::{Case, read_cases};
use appell::files;

/// Evaluates the equations at given states.
///
/// Computes rates, Appell's equations, Jacobians, energies, constraint forces and outputs, in SI. A
/// case reads {"state": {"theta": 0.1, …}, "inputs": {…}, "parameters": {…}, "t": 0}; only the state
/// must be complete.
#[derive(Debug, clap::Args)]
pub(crate) struct Evaluate {
    /// Name of a shipped mechanism or path of a spec
    model: String,
    /// JSON file with states, inputs and parameters; `-` is standard input
    #[arg(long, value_name = "IN.json")]
    cases: PathBuf,
    /// Output file; `-` is standard output
    #[arg(long, value_name = "OUT.json", default_value = "-")]
    json: PathBuf,
    /// How the equations are evaluated
    #[arg(long, value_enum, default_value_t = Engine::Jit)]
    engine: Engine,
}

impl Evaluate {
    pub(super) fn run(&self) -> Result<(), Error> {
        let text = files::read(&self.cases, files::MAX_DATA)?;
        let model = engine::model(&self.model, Some(self.engine))?;
        let model = model.equations();
        let info = model.info();
        let cases = read_cases(&self.cases.to_string_lossy(), &text, info)?;

        let inputs = ModelInputs::new(info, &ZeroInputs)
            .map_err(|error| Error::Computation(error.to_string()))?;
        let mut answers = Vec::with_capacity(cases.len());
        let mut singular = Vec::new();
        for (index, case) in cases.iter().enumerate() {
            let mut u = vec![0.0; info.input_len()];
            inputs.fill(case.t, &case.x, &mut u);
            for (u, given) in u.iter_mut().zip(&case.u) {
                *u = given.unwrap_or(*u);
            }
            let at = At {
                t: case.t,
                x: &case.x,
                u: &u,
                p: &case.p,
            };
            let (answer, finite) = answer(model, at);
            answers.push(answer);
            if !finite {
                singular.push(describe(index, case, &info.states));
            }
        }
        let names = |list: &[Quantity]| -> Vec<String> {
            list.iter().map(|q| q.name.to_string()).collect()
        };
        files::write_json(
            &self.json,
            &json!({
                "mechanism": info.name,
                "state_order": names(&info.states),
                "input_order": names(&info.inputs),
                "speed_order": names(info.speed_quantities()),
                "parameter_order": names(&info.parameters),
                "output_order": names(&info.outputs),
                "constraint_order": info.constraint_rows,
                "cases": answers,
            }),
        )?;
        if singular.is_empty() {
            return Ok(());
        }
        Err(Error::Computation(format!(
            "the equations are not finite at these cases; the numbers affected are written as `null`\n{}",
            singular.join("\n")
        )))
    }
}

fn describe(index: usize, case: &Case, states: &[Quantity]) -> String {
    let state: Vec<String> = states
        .iter()
        .zip(&case.x)
        .map(|(state, value)| format!("{} = {value}", state.name))
        .collect();
    format!("  case {index}, t = {} s: {}", case.t, state.join(", "))
}

/// All quantities at one state, and whether they are all finite.
fn answer(model: &dyn Model, at: At<'_>) -> (Value, bool) {
    let info = model.info();
    let (n, s, m, k) = (
        info.state_len(),
        info.speeds,
        info.input_len(),
        info.parameter_len(),
    );
    let mut rates = vec![0.0; n];
    let (mut a, mut b, mut p) = (vec![0.0; n * n], vec![0.0; n * m], vec![0.0; n * k]);
    model.rates(at, &mut rates);
    model.jacobians(at, &mut vec![0.0; n], &mut a, &mut b);
    model.parameter_jacobian(at, &mut p);
    let (mut mass, mut bias, mut forces) = (vec![0.0; s * s], vec![0.0; s], vec![0.0; s]);
    model.appell(at, &mut mass, &mut bias, &mut forces);
    let energies = model.energies(at);
    let mut residual = vec![0.0; info.constraint_rows.len()];
    model.constraint_residual(at, &mut residual);
    let mut reactions = vec![0.0; 3 * info.reactions.len()];
    model.constraint_forces(at, &mut reactions);
    let mut outputs = vec![0.0; info.output_len()];
    model.outputs(at, &mut outputs);

    let scalars = [
        energies.kinetic,
        energies.potential,
        energies.power,
        energies.acceleration,
    ];
    let all = [
        &rates, &a, &b, &p, &mass, &bias, &forces, &residual, &reactions, &outputs,
    ];
    let finite = all
        .iter()
        .flat_map(|list| list.iter())
        .chain(&scalars)
        .all(|value| value.is_finite());
    let named = |list: &[Quantity], values: &[f64]| -> Map<String, Value> {
        list.iter()
            .zip(values)
            .map(|(q, &value)| (q.name.to_string(), json!(value)))
            .collect()
    };
    let rows = |values: &[f64], rows: usize, columns: usize| -> Value {
        (0..rows)
            .map(|row| json!(&values[row * columns..][..columns]))
            .collect()
    };
    let reactions: Map<String, Value> = info
        .reactions
        .iter()
        .zip(reactions.chunks(3))
        .map(|(reaction, force)| (reaction.name.to_string(), json!(force)))
        .collect();
    let contacts = contacts(model, at);
    let conditions = Conditions::of(model, at);
    let value = json!({
        "rates": named(&info.states, &rates),
        "mass_matrix": rows(&mass, s, s),
        "bias": bias,
        "generalized_forces": forces,
        "A": rows(&a, n, n),
        "B": rows(&b, n, m),
        "P": rows(&p, n, k),
        "acceleration_energy": energies.acceleration,
        "kinetic_energy": energies.kinetic,
        "potential_energy": energies.potential,
        "power": energies.power,
        "constraint_residual": residual,
        "constraint_forces": reactions,
        "contacts": contacts,
        "conditions": {
            "mass_matrix": conditions.mass_matrix,
            "velocities": conditions.velocities,
            "systems": conditions.systems,
        },
        "outputs": named(&info.outputs, &outputs),
    });
    (value, finite)
}

/// The contact forces. An infinite friction demand is `null`.
fn contacts(model: &dyn Model, at: At<'_>) -> Map<String, Value> {
    let mut forces = ContactForces::new();
    let forces = forces.at(model, at).iter();
    let contacts = model.info().contacts.iter().zip(forces);
    contacts
        .map(|(contact, force)| {
            let mut told = json!({ "normal_force": force.normal });
            if contact.grips {
                told["tangential_force"] = json!(force.tangential);
                told["friction_demand"] = json!(force.demand());
                told["friction"] = json!(force.friction);
            }
            (contact.name.to_string(), told)
        })
        .collect()
}
