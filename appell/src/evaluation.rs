//! The equations evaluated at given states.

use std::cell::RefCell;
use std::collections::BTreeSet;
use std::io::{self, Write};

use appell_codegen::program::FunctionKind;
pub use appell_runtime::condition::Conditions;
pub use appell_runtime::contact::ContactForce;
use appell_runtime::contact::ContactForces;
use appell_runtime::inputs::{ModelInputs, ZeroInputs};
pub use appell_runtime::model::Energies;
use appell_runtime::model::{At, Model as Equations, ModelInfo};
use serde::ser::{Serialize, SerializeMap as _, Serializer};
use serde_json::{Map, Value, json};

use crate::cases::Case;
use crate::json::{named, names};
use crate::{Error, Model};

/// The quantities of the equations, by their keys in JSON, with the functions that give them.
const QUANTITIES: [(&[&str], &[FunctionKind]); 11] = {
    use FunctionKind as F;
    [
        (&["rates"], &[F::Rates]),
        (
            &["mass_matrix", "bias", "generalized_forces"],
            &[F::MassMatrixAndBias, F::GeneralizedForces],
        ),
        (&["A", "B"], &[F::Jacobians]),
        (&["P"], &[F::ParameterJacobian]),
        (
            &[
                "acceleration_energy",
                "kinetic_energy",
                "potential_energy",
                "power",
            ],
            &[F::AccelerationEnergy, F::Energies],
        ),
        (&["constraint_residual"], &[F::ConstraintResidual]),
        (&["constraint_forces"], &[F::ConstraintForces]),
        (&["contacts"], &[F::ConstraintForces, F::Contacts]),
        (&["conditions"], &[F::MassMatrixAndBias, F::Systems]),
        (&["outputs"], &[F::Outputs]),
        (&["inverse_dynamics"], &[F::InverseDynamics]),
    ]
};

/// The keys of all quantities.
pub fn quantities() -> impl Iterator<Item = &'static str> + Clone {
    QUANTITIES.iter().flat_map(|(keys, _)| keys.iter().copied())
}

/// Quantities of the equations at one state, in SI; matrices are stored by rows. Those that were not asked for are empty
/// or zero.
#[derive(Debug, Clone)]
pub struct Values {
    /// Rates of the states.
    pub rates: Vec<f64>,
    /// ∂ẋ/∂x.
    pub a: Vec<f64>,
    /// ∂ẋ/∂u.
    pub b: Vec<f64>,
    /// ∂ẋ/∂p.
    pub p: Vec<f64>,
    /// Mass matrix M.
    pub mass_matrix: Vec<f64>,
    /// Bias b.
    pub bias: Vec<f64>,
    /// Pseudo-forces Π.
    pub forces: Vec<f64>,
    /// Energies and power.
    pub energies: Energies,
    /// Residuals of the constraint rows.
    pub residual: Vec<f64>,
    /// Constraint forces, three components each.
    pub reactions: Vec<f64>,
    /// Forces at the contacts.
    pub contacts: Vec<ContactForce>,
    /// Condition numbers of the linear systems.
    pub conditions: Option<Conditions>,
    /// Outputs.
    pub outputs: Vec<f64>,
    /// M ω̇ + b − Π for the pseudo-accelerations of the case, where it has some.
    pub inverse_dynamics: Option<Vec<f64>>,
}

/// The equations of a model, to be evaluated at cases.
pub struct Evaluation<'a> {
    model: &'a Model,
    inputs: ModelInputs<'a>,
    wanted: BTreeSet<&'static str>,
}

impl Model {
    /// The equations, to be evaluated at given states; only functions that the wanted quantities need are derived.
    ///
    /// ```
    /// use appell::{Model, cases::Cases};
    ///
    /// let model = Model::shipped("pendulum")?;
    /// let cases = r#"{"cases": [{"state": {"theta": 0.1, "omega": 0}}]}"#;
    /// let cases = Cases::read("cases.json", cases, model.info())?;
    /// let evaluation = model.evaluation(cases.quantities())?;
    /// for case in cases.iter() {
    ///     assert!(evaluation.at(&case).rates[0] < 0.0);
    /// }
    /// # Ok::<(), appell::Error>(())
    /// ```
    pub fn evaluation(&self, wanted: BTreeSet<&'static str>) -> Result<Evaluation<'_>, Error> {
        let asked = |keys: &[&str]| keys.iter().any(|key| wanted.contains(key));
        let functions = QUANTITIES.iter().filter(|(keys, _)| asked(keys));
        let functions: Vec<FunctionKind> =
            functions.flat_map(|(_, of)| of.iter().copied()).collect();
        self.require(&functions)?;
        let inputs = ModelInputs::new(self.info(), &ZeroInputs)?;
        Ok(Evaluation {
            model: self,
            inputs,
            wanted,
        })
    }
}

impl Evaluation<'_> {
    /// The values at a case.
    pub fn at(&self, case: &Case) -> Values {
        let mut u = vec![0.0; self.model.info().input_len()];
        self.inputs.fill(case.t, &case.x, &mut u);
        for (u, given) in u.iter_mut().zip(&case.u) {
            *u = given.unwrap_or(*u);
        }
        let at = At {
            t: case.t,
            x: &case.x,
            u: &u,
            p: &case.p,
        };
        let accelerations = case.accelerations.as_deref();
        Values::at(self.model.equations(), at, accelerations, |keys| {
            keys.iter().any(|key| self.wanted.contains(key))
        })
    }

    /// Writes the values of cases as JSON, one by one, with their names; non-finite numbers are `null`. `see` is called with
    /// each case and its number.
    pub fn write(
        &self,
        cases: impl Iterator<Item = Case>,
        to: &mut dyn Write,
        mut see: impl FnMut(usize, &Case, &Values),
    ) -> io::Result<()> {
        let info = self.model.info();
        let head = [
            ("schema", json!("evaluation/1")),
            ("mechanism", json!(info.name)),
            ("state_order", json!(names(&info.states))),
            ("input_order", json!(names(&info.inputs))),
            ("speed_order", json!(names(info.speed_quantities()))),
            ("parameter_order", json!(names(&info.parameters))),
            ("output_order", json!(names(&info.outputs))),
            ("constraint_order", json!(info.constraint_rows)),
        ];
        let mut serializer = serde_json::Serializer::pretty(&mut *to);
        let mut map = serializer.serialize_map(None)?;
        for (key, value) in head {
            map.serialize_entry(key, &value)?;
        }
        let cases = cases.enumerate().map(|(index, case)| {
            let values = self.at(&case);
            see(index, &case, &values);
            values.to_json(info, &self.wanted)
        });
        map.serialize_entry("cases", &List(RefCell::new(cases)))?;
        map.end()?;
        to.write_all(b"\n")
    }
}

/// A list whose items are made while it is written.
struct List<I>(RefCell<I>);

impl<I: Iterator<Item = Value>> Serialize for List<I> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_seq(&mut *self.0.borrow_mut())
    }
}

impl Values {
    fn at(
        model: &dyn Equations,
        at: At<'_>,
        accelerations: Option<&[f64]>,
        asked: impl Fn(&[&str]) -> bool,
    ) -> Self {
        let info = model.info();
        let (n, s, m, k) = (
            info.state_len(),
            info.speeds,
            info.input_len(),
            info.parameter_len(),
        );
        let filled = |key: &str, count: usize, fill: &dyn Fn(&mut [f64])| {
            let mut values = Vec::new();
            if asked(&[key]) {
                values.resize(count, 0.0);
                fill(&mut values);
            }
            values
        };
        let [mut a, mut b, mut mass_matrix, mut bias, mut forces] = [(); 5].map(|()| Vec::new());
        if asked(&["A", "B"]) {
            (a, b) = (vec![0.0; n * n], vec![0.0; n * m]);
            model.jacobians(at, &mut vec![0.0; n], &mut a, &mut b);
        }
        if asked(&["mass_matrix", "bias", "generalized_forces"]) {
            (mass_matrix, bias, forces) = (vec![0.0; s * s], vec![0.0; s], vec![0.0; s]);
            model.appell(at, &mut mass_matrix, &mut bias, &mut forces);
        }
        let energies = [
            "acceleration_energy",
            "kinetic_energy",
            "potential_energy",
            "power",
        ];
        let (rows, reactions) = (info.constraint_rows.len(), info.reactions.len());
        Self {
            rates: filled("rates", n, &|rates| model.rates(at, rates)),
            a,
            b,
            p: filled("P", n * k, &|p| model.parameter_jacobian(at, p)),
            mass_matrix,
            bias,
            forces,
            energies: if asked(&energies) {
                model.energies(at)
            } else {
                Energies::default()
            },
            residual: filled("constraint_residual", rows, &|rows| {
                model.constraint_residual(at, rows);
            }),
            reactions: filled("constraint_forces", 3 * reactions, &|forces| {
                model.constraint_forces(at, forces);
            }),
            contacts: if asked(&["contacts"]) {
                ContactForces::new().at(model, at).to_vec()
            } else {
                Vec::new()
            },
            conditions: asked(&["conditions"]).then(|| Conditions::of(model, at)),
            outputs: filled("outputs", info.output_len(), &|outputs| {
                model.outputs(at, outputs);
            }),
            inverse_dynamics: accelerations.map(|given| {
                filled("inverse_dynamics", s, &|demand| {
                    model.inverse_dynamics(at, given, demand);
                })
            }),
        }
    }

    /// Whether all quantities are finite, apart from friction demands and condition numbers.
    pub fn is_finite(&self) -> bool {
        let energies = [
            self.energies.kinetic,
            self.energies.potential,
            self.energies.power,
            self.energies.acceleration,
        ];
        let demand = self.inverse_dynamics.as_deref();
        let lists: [&[f64]; 12] = [
            &self.rates,
            &self.a,
            &self.b,
            &self.p,
            &self.mass_matrix,
            &self.bias,
            &self.forces,
            &self.residual,
            &self.reactions,
            &self.outputs,
            &energies,
            demand.unwrap_or_default(),
        ];
        lists.into_iter().flatten().all(|value| value.is_finite())
    }

    fn to_json(&self, info: &ModelInfo, wanted: &BTreeSet<&str>) -> Value {
        let rows = |values: &[f64], columns: usize| -> Value {
            let rows = values
                .len()
                .checked_div(columns)
                .unwrap_or(info.state_len());
            (0..rows)
                .map(|row| json!(&values[row * columns..][..columns]))
                .collect()
        };
        let reactions: Map<String, Value> = info
            .reactions
            .iter()
            .zip(self.reactions.chunks(3))
            .map(|(reaction, force)| (reaction.name.to_string(), json!(force)))
            .collect();
        let mut all = json!({
            "rates": named(&info.states, &self.rates),
            "mass_matrix": rows(&self.mass_matrix, info.speeds),
            "bias": self.bias,
            "generalized_forces": self.forces,
            "A": rows(&self.a, info.state_len()),
            "B": rows(&self.b, info.input_len()),
            "P": rows(&self.p, info.parameter_len()),
            "acceleration_energy": self.energies.acceleration,
            "kinetic_energy": self.energies.kinetic,
            "potential_energy": self.energies.potential,
            "power": self.energies.power,
            "constraint_residual": self.residual,
            "constraint_forces": reactions,
            "contacts": self.contacts(info),
            "conditions": self.conditions.as_ref().map(|conditions| json!({
                "mass_matrix": conditions.mass_matrix,
                "velocities": conditions.velocities,
                "systems": conditions.systems,
            })),
            "outputs": named(&info.outputs, &self.outputs),
        });
        if let Some(demand) = &self.inverse_dynamics {
            all["inverse_dynamics"] = json!(demand);
        }
        if let Value::Object(all) = &mut all {
            all.retain(|key, _| wanted.contains(key.as_str()));
        }
        all
    }

    /// The contact forces. An infinite friction demand is `null`.
    fn contacts(&self, info: &ModelInfo) -> Map<String, Value> {
        let contacts = info.contacts.iter().zip(&self.contacts);
        contacts
            .map(|(contact, force)| {
                let mut entry = json!({ "normal_force": force.normal });
                if contact.grips {
                    entry["tangential_force"] = json!(force.tangential);
                    entry["friction_demand"] = json!(force.demand());
                    entry["friction"] = json!(force.friction);
                }
                (contact.name.to_string(), entry)
            })
            .collect()
    }
}
