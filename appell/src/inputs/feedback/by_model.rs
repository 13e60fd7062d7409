//! Laws that compute inputs by inverse dynamics.
//!
//! ```toml
//! law = "computed torque"                  # or "gravity compensation", with `inputs` alone
//! inputs = ["tau_1", "tau_2"]
//! follow = { q_1 = "0.5*sin(t)", q_2 = 0 } # as many coordinates, each the integral of a pseudo-velocity
//! natural_frequency = 10                   # of the errors, in rad/s
//! damping_ratio = 1
//! believes = { m_load = "2kg" }            # parameters of the law's model; the others are those of the motion
//! sampled_ms = 2                           # sampling period; inputs are held in between
//! delay_ms = 1                             # from a measurement to its effect
//! ```
//!
//! Appell's equations are linear in the inputs, M ω̇ + b − Π₀ = E u. Gravity compensation solves them for the
//! inputs at rest, ω = ω̇ = 0; computed torque for those of desired accelerations (B. R. Markiewicz, 1973;
//! J. Y. S. Luh, M. W. Walker, R. P. C. Paul, 1980). Accelerations without a desired value are unknowns like the
//! inputs; an overdetermined system is solved by least squares.

use appell_analysis::control::sampled::Sampling;
use appell_estimate::inverse::InputEquations;
use appell_runtime::model::{At, Model};
use appell_spec::expr::Expr;
use appell_spec::mechanism::{CoordinateId, SpeedId};
use appell_spec::{Code, Scope};
use toml::de::{DeTable, DeValue};

use super::reading::{Reader, Value};
use crate::inputs::law::{Law, Moment, Stage};

/// A law that computes its inputs from the equations of motion.
#[derive(Debug)]
pub(super) struct ModelLaw {
    inputs: Vec<usize>,
    aim: Aim,
    /// Parameters of its model that differ from those of the motion, in SI.
    believed: Vec<(usize, f64)>,
    sampling: Option<Sampling>,
}

/// Control law by inverse dynamics.
#[derive(Debug)]
enum Aim {
    /// Inputs that would hold the mechanism at rest in its present position.
    GravityCompensation,
    /// Inputs that let coordinates follow desired motions: `q̈ = q̈_d − 2ζω (q̇ − q̇_d) − ω² (q − q_d)`.
    ComputedTorque {
        /// The coordinates, with their desired motions.
        followed: Vec<Followed>,
        /// ω² in 1/s².
        stiffness: f64,
        /// 2ζω in 1/s.
        damping: f64,
    },
}

/// A coordinate whose rate is a pseudo-velocity.
#[derive(Debug)]
struct Followed {
    /// The coordinate, as a state.
    coordinate: usize,
    /// The pseudo-velocity.
    speed: usize,
    /// The desired coordinate over time.
    desired: Expr,
}

impl Law for ModelLaw {
    fn desired(&self) -> Vec<&Expr> {
        match &self.aim {
            Aim::GravityCompensation => Vec::new(),
            Aim::ComputedTorque { followed, .. } => {
                followed.iter().map(|followed| &followed.desired).collect()
            }
        }
    }

    fn derivatives(&self) -> usize {
        2
    }

    fn stage(&self) -> Stage {
        Stage::Model
    }

    fn sampling(&self) -> Option<Sampling> {
        self.sampling
    }

    fn add(&self, at: &Moment<'_>, u: &mut [f64]) {
        let measure = || {
            let mut all = vec![0.0; at.model.info().input_len()];
            let (declared, signals) = all.split_at_mut(u.len());
            at.function.fill_signals(at.t, signals);
            declared.copy_from_slice(u);
            self.asked(at, &all)
        };
        let acting = match at.sampler {
            Some(sampler) => sampler.acting(at.t, |_| measure()),
            None => Some(measure()),
        };
        for (&input, acting) in self.inputs.iter().zip(acting.iter().flatten()) {
            u[input] += acting;
        }
    }
}

impl ModelLaw {
    /// Its inputs, given the other inputs and the signals; not finite if the equations do not determine them.
    fn asked(&self, moment: &Moment<'_>, u: &[f64]) -> Vec<f64> {
        let mut p = moment.p.to_vec();
        for &(parameter, value) in &self.believed {
            p[parameter] = value;
        }
        let at = At {
            t: moment.t,
            x: moment.x,
            u,
            p: &p,
        };
        let found = self.inputs_at(moment.model, at, moment.desired);
        found.unwrap_or_else(|| vec![f64::NAN; self.inputs.len()])
    }

    fn inputs_at(&self, model: &dyn Model, at: At<'_>, desired: &[f64]) -> Option<Vec<f64>> {
        let speeds = model.info().speeds;
        let mut x = at.x.to_vec();
        let accelerations = match &self.aim {
            Aim::GravityCompensation => {
                x[..speeds].fill(0.0);
                vec![Some(0.0); speeds]
            }
            Aim::ComputedTorque {
                followed,
                stiffness,
                damping,
            } => {
                let mut accelerations = vec![None; speeds];
                let (desired, _) = desired.as_chunks::<3>();
                for (followed, [q, rate, acceleration]) in followed.iter().zip(desired) {
                    let error = at.x[followed.coordinate] - q;
                    let error_rate = at.x[followed.speed] - rate;
                    let asked = acceleration - damping * error_rate - stiffness * error;
                    accelerations[followed.speed] = Some(asked);
                }
                accelerations
            }
        };
        let mut equations = InputEquations::at(model, At { x: &x, ..at }).ok()?;
        for (input, column) in equations.inputs.column_iter().enumerate() {
            if !self.inputs.contains(&input) {
                equations.free -= column * at.u[input];
            }
        }
        equations.inputs = equations.inputs.select_columns(&self.inputs);
        let rows: Vec<usize> = (0..speeds).collect();
        equations.solve(&accelerations, &rows).ok()
    }
}

const LAWS: [&str; 2] = ["computed torque", "gravity compensation"];

const KEYS: [&str; 12] = [
    "about",
    "mechanism",
    "law",
    "inputs",
    "believes",
    "sampled_ms",
    "delay_ms",
    "switching_times_s",
    "initial",
    // Of computed torque.
    "follow",
    "natural_frequency",
    "damping_ratio",
];

/// The law of a file with the key `law`; invalid entries are reported.
pub(super) fn read(
    reader: &mut Reader<'_>,
    table: &DeTable<'_>,
    law: &Value<'_>,
) -> Option<ModelLaw> {
    let (name, at) = reader.string(law)?;
    let Some(place) = LAWS.iter().position(|law| *law == name) else {
        let message = format!("there is no law `{name}`");
        let help = format!("the laws are {}", LAWS.join(", "));
        reader.tell(Code::UnknownWord, message, at, &help);
        return None;
    };
    let follows = place == 0;
    let known = if follows { &KEYS[..] } else { &KEYS[..9] };
    reader.known_keys(table, known);
    reader.right_mechanism(table);
    let inputs = reader.list(table, "inputs", Reader::input);
    if table.get("inputs").is_none() {
        reader.missing("inputs", "name the inputs that the law computes");
    }
    let believed = believed(reader, table);
    let aim = if follows {
        computed_torque(reader, table, inputs.as_ref()?.len())?
    } else {
        Aim::GravityCompensation
    };
    let inputs = inputs?;
    Some(ModelLaw {
        inputs,
        aim,
        believed,
        sampling: reader.sampling(table),
    })
}

fn computed_torque(reader: &mut Reader<'_>, table: &DeTable<'_>, inputs: usize) -> Option<Aim> {
    let Some(follow) = table.get("follow") else {
        let help = "write follow = { q = \"0.1*sin(t)\" }, with as many coordinates as inputs";
        reader.missing("follow", help);
        return None;
    };
    let desired = reader.by_state(table, "follow", Scope::Schedule, "the desired motion");
    let mut followed = Vec::new();
    for (coordinate, desired, at) in desired {
        let Some(speed) = speed_of(reader, coordinate) else {
            let name = &reader.setup.info.states[coordinate].name;
            let message = format!("no pseudo-velocity is the rate of `{name}`");
            let help = "computed torque follows coordinates q with a pseudo-velocity \"dot(q)\"";
            reader.tell(Code::UnknownReference, message, at, help);
            continue;
        };
        followed.push(Followed {
            coordinate,
            speed,
            desired,
        });
    }
    reader.count("coordinate", followed.len(), "input", inputs, follow.span());
    let mut positive = |key: &str, default: Option<f64>| {
        let Some(value) = table.get(key) else {
            if default.is_none() {
                let help = "give the natural frequency of the errors in rad/s, such as 10";
                reader.missing(key, help);
            }
            return default;
        };
        let number = reader.number(value)?;
        if number <= 0.0 {
            reader.wrong_type(value, format!("`{key}` must be positive"), "");
            return None;
        }
        Some(number)
    };
    let frequency = positive("natural_frequency", None);
    let damping_ratio = positive("damping_ratio", Some(1.0));
    let (frequency, damping_ratio) = frequency.zip(damping_ratio)?;
    Some(Aim::ComputedTorque {
        followed,
        stiffness: frequency * frequency,
        damping: 2.0 * damping_ratio * frequency,
    })
}

/// The pseudo-velocity that is the rate of a coordinate.
fn speed_of(reader: &Reader<'_>, coordinate: usize) -> Option<usize> {
    let setup = reader.setup;
    let coordinate = CoordinateId::new(coordinate.checked_sub(setup.info.speeds)?);
    setup.mechanism.speed_of(coordinate).map(SpeedId::index)
}

/// Values of parameters by name, in SI.
fn believed(reader: &mut Reader<'_>, table: &DeTable<'_>) -> Vec<(usize, f64)> {
    let Some(value) = table.get("believes") else {
        return Vec::new();
    };
    let DeValue::Table(entries) = value.get_ref() else {
        let help = "write `name = value` for each parameter";
        reader.wrong_type(value, "`believes` must be a table", help);
        return Vec::new();
    };
    let setup = reader.setup;
    let mut believed = Vec::new();
    for (name, value) in entries {
        let parameters = setup.info.parameters.iter();
        let found = reader.find(name.get_ref(), "parameter", parameters, name.span());
        let Some(parameter) = found else { continue };
        let unit = setup.unit_of_parameter(parameter);
        let expr = reader.expression(value, Scope::Constant, "the parameter", unit);
        let Some(expr) = expr else { continue };
        let number = setup.constant(&expr);
        if number.is_none() {
            let message = "this is not a finite number";
            reader.tell(Code::NotFinite, message, value.span(), "");
        }
        believed.extend(number.map(|number| (parameter, number)));
    }
    believed
}
