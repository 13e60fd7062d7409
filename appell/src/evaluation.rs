//! The equations evaluated at given states.

use std::cell::RefCell;
use std::collections::BTreeSet;
use std::io::{self, Write};

use appell_codegen::program::FunctionKind;
use appell_runtime::condition::Conditions;
use appell_runtime::contact::ContactForces;
use appell_runtime::inputs::{ModelInputs, ZeroInputs};
use appell_runtime::model::{At, Model as Equations, ModelInfo};
use serde::ser::{Serialize, SerializeMap as _, Serializer};
use serde_json::{Map, Value, json};

use crate::cases::Case;
use crate::json::{named, names, object};
use crate::{Error, Model};

/// Quantities of the equations that are evaluated together.
struct Group {
    /// Their keys in JSON.
    keys: &'static [&'static str],
    /// The functions that give them.
    functions: &'static [FunctionKind],
    /// Their values in SI, matrices as lists of rows; none for a place without what they need.
    values: fn(&Place<'_>) -> Vec<Value>,
}

const fn group(
    keys: &'static [&'static str],
    functions: &'static [FunctionKind],
    values: fn(&Place<'_>) -> Vec<Value>,
) -> Group {
    Group {
        keys,
        functions,
        values,
    }
}

/// A place at which the equations are evaluated.
struct Place<'a> {
    model: &'a dyn Equations,
    info: &'a ModelInfo,
    at: At<'a>,
    /// Pseudo-accelerations, where there are some.
    accelerations: Option<&'a [f64]>,
}

/// All quantities, in the order of the answer.
const QUANTITIES: [Group; 11] = {
    use FunctionKind as F;
    [
        group(&["rates"], &[F::Rates], |of| {
            let rates = filled(of.info.state_len(), |rates| of.model.rates(of.at, rates));
            vec![named(&of.info.states, &rates)]
        }),
        group(
            &["mass_matrix", "bias", "generalized_forces"],
            &[F::MassMatrixAndBias, F::GeneralizedForces],
            |of| {
                let s = of.info.speeds;
                let (mut mass, mut bias, mut forces) =
                    (vec![0.0; s * s], vec![0.0; s], vec![0.0; s]);
                of.model.appell(of.at, &mut mass, &mut bias, &mut forces);
                vec![rows(&mass, [s, s]), json!(bias), json!(forces)]
            },
        ),
        group(&["A", "B"], &[F::Jacobians], |of| {
            let (n, m) = (of.info.state_len(), of.info.input_len());
            let (mut a, mut b) = (vec![0.0; n * n], vec![0.0; n * m]);
            of.model.jacobians(of.at, &mut vec![0.0; n], &mut a, &mut b);
            vec![rows(&a, [n, n]), rows(&b, [n, m])]
        }),
        group(&["P"], &[F::ParameterJacobian], |of| {
            let (n, k) = (of.info.state_len(), of.info.parameter_len());
            let p = filled(n * k, |p| of.model.parameter_jacobian(of.at, p));
            vec![rows(&p, [n, k])]
        }),
        group(
            &[
                "acceleration_energy",
                "kinetic_energy",
                "potential_energy",
                "power",
            ],
            &[F::AccelerationEnergy, F::Energies],
            |of| {
                let all = of.model.energies(of.at);
                [all.acceleration, all.kinetic, all.potential, all.power]
                    .map(Value::from)
                    .to_vec()
            },
        ),
        group(&["constraint_residual"], &[F::ConstraintResidual], |of| {
            let count = of.info.constraint_rows.len();
            let residual = filled(count, |rows| of.model.constraint_residual(of.at, rows));
            vec![json!(residual)]
        }),
        group(&["constraint_forces"], &[F::ConstraintForces], |of| {
            let reactions = &of.info.reactions;
            let forces = filled(3 * reactions.len(), |forces| {
                of.model.constraint_forces(of.at, forces);
            });
            let all = reactions.iter().zip(forces.chunks(3));
            vec![object(all.map(|(one, force)| (&one.name, json!(force))))]
        }),
        group(&["contacts"], &[F::ConstraintForces, F::Contacts], |of| {
            vec![contacts(of)]
        }),
        group(&["conditions"], &[F::MassMatrixAndBias, F::Systems], |of| {
            let found = Conditions::of(of.model, of.at);
            vec![json!({
                "mass_matrix": found.mass_matrix,
                "velocities": found.velocities,
                "systems": found.systems,
            })]
        }),
        group(&["outputs"], &[F::Outputs], |of| {
            let outputs = filled(of.info.output_len(), |y| of.model.outputs(of.at, y));
            vec![named(&of.info.outputs, &outputs)]
        }),
        group(&["inverse_dynamics"], &[F::InverseDynamics], |of| {
            let demand = of.accelerations.map(|given| {
                filled(of.info.speeds, |demand| {
                    of.model.inverse_dynamics(of.at, given, demand);
                })
            });
            demand.into_iter().map(Value::from).collect()
        }),
    ]
};

/// Quantities that may be infinite at a regular place: friction demands, condition numbers.
const UNBOUNDED: [&str; 2] = ["contacts", "conditions"];

/// The keys of all quantities.
pub fn quantities() -> impl Iterator<Item = &'static str> + Clone {
    QUANTITIES.iter().flat_map(|group| group.keys).copied()
}

/// Quantities at one state.
#[derive(Debug, Clone)]
pub struct Values {
    /// The wanted ones by their keys, in SI; numbers that are not finite are `null`.
    pub fields: Map<String, Value>,
    /// Whether all that were evaluated are finite, apart from friction demands and condition numbers.
    pub is_finite: bool,
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
    ///     assert!(evaluation.at(&case).fields["rates"]["omega"].as_f64() < Some(0.0));
    /// }
    /// # Ok::<(), appell::Error>(())
    /// ```
    pub fn evaluation(&self, wanted: BTreeSet<&'static str>) -> Result<Evaluation<'_>, Error> {
        let functions = groups(&wanted).flat_map(|group| group.functions);
        self.require(&functions.copied().collect::<Vec<_>>())?;
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
        let place = Place {
            model: self.model.equations(),
            info: self.model.info(),
            at,
            accelerations: case.accelerations.as_deref(),
        };
        let (mut fields, mut all_finite) = (Map::new(), true);
        for group in groups(&self.wanted) {
            for (&key, value) in group.keys.iter().zip((group.values)(&place)) {
                all_finite &= UNBOUNDED.contains(&key) || is_finite(&value);
                if self.wanted.contains(key) {
                    fields.insert(key.to_owned(), value);
                }
            }
        }
        Values {
            fields,
            is_finite: all_finite,
        }
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
            values.fields
        });
        map.serialize_entry("cases", &List(RefCell::new(cases)))?;
        map.end()?;
        to.write_all(b"\n")
    }
}

/// A list whose items are made while it is written.
struct List<I>(RefCell<I>);

impl<I: Iterator<Item: Serialize>> Serialize for List<I> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_seq(&mut *self.0.borrow_mut())
    }
}

/// The groups with a wanted quantity.
fn groups(wanted: &BTreeSet<&str>) -> impl Iterator<Item = &'static Group> {
    QUANTITIES
        .iter()
        .filter(|group| group.keys.iter().any(|key| wanted.contains(key)))
}

/// So many numbers, written by a function.
fn filled(count: usize, fill: impl FnOnce(&mut [f64])) -> Vec<f64> {
    let mut values = vec![0.0; count];
    fill(&mut values);
    values
}

/// A matrix as a list of rows.
fn rows(values: &[f64], [rows, columns]: [usize; 2]) -> Value {
    (0..rows)
        .map(|row| json!(&values[row * columns..][..columns]))
        .collect()
}

/// The contact forces. An infinite friction demand is `null`.
fn contacts(of: &Place<'_>) -> Value {
    let mut forces = ContactForces::new();
    let contacts = of.info.contacts.iter().zip(forces.at(of.model, of.at));
    object(contacts.map(|(contact, force)| {
        let mut entry = json!({ "normal_force": force.normal });
        if contact.grips {
            entry["tangential_force"] = json!(force.tangential);
            entry["friction_demand"] = json!(force.demand());
            entry["friction"] = json!(force.friction);
        }
        (&contact.name, entry)
    }))
}

/// Whether all numbers in a value are finite; others are `null`.
fn is_finite(value: &Value) -> bool {
    match value {
        Value::Null => false,
        Value::Array(values) => values.iter().all(is_finite),
        Value::Object(fields) => fields.values().all(is_finite),
        _ => true,
    }
}
