//! Gain schedules over a state or a parameter.
//!
//! ```toml
//! over = "omega_2"                         # linear interpolation between the values
//! [[at]]
//! value = 3.3                              # in the unit of the quantity
//! gains = [40, 12]                         # in SI, as above
//! offset = [0.98]                          # the inputs on the steady motion, in their units
//! steady = { theta = 0.02 }                # the states on it; 0 where none is given
//! ```

use appell_analysis::control::schedule::{GainSchedule, OperatingLaw};
use appell_codegen::symbolic::Relation;
use appell_codegen::tape::{Argument, Arithmetic, Operation, Tape, Value};
use appell_runtime::model::Quantity;
use appell_spec::Code;
use appell_spec::expr::Expr;
use nalgebra::{DMatrix, DVector};
use toml::Spanned;
use toml::de::{DeTable, DeValue};

use super::reading::Reader;
use crate::inputs::law::{self, Law, Moment, Stage};

/// A gain-scheduled law.
#[derive(Debug)]
pub(super) struct Schedule {
    over: SchedulingVariable,
    laws: GainSchedule,
    inputs: Vec<usize>,
    /// The states, with their desired deviations from the steady motions.
    states: Vec<(usize, Option<Expr>)>,
}

/// A scheduling variable.
#[derive(Debug, Clone, Copy)]
enum SchedulingVariable {
    State(usize),
    Parameter(usize),
}

impl Schedule {
    /// States, less the desired deviations where there are some.
    fn deviations<V: Copy>(
        &self,
        states: impl IntoIterator<Item = V>,
        desired: &[V],
        mut less: impl FnMut(V, V) -> V,
    ) -> Vec<V> {
        let mut desired = desired.iter();
        let states = self.states.iter().zip(states);
        let deviations =
            states.map(
                |((_, expr), state)| match expr.as_ref().and_then(|_| desired.next()) {
                    Some(desired) => less(state, *desired),
                    None => state,
                },
            );
        deviations.collect()
    }
}

impl Law for Schedule {
    fn desired(&self) -> Vec<&Expr> {
        let states = self.states.iter();
        states.filter_map(|(_, expr)| expr.as_ref()).collect()
    }

    fn stage(&self) -> Stage {
        Stage::Schedule
    }

    fn add(&self, at: &Moment<'_>, u: &mut [f64]) {
        let over = match self.over {
            SchedulingVariable::State(state) => at.x[state],
            SchedulingVariable::Parameter(parameter) => at.p[parameter],
        };
        let states = self.states.iter().map(|(state, _)| at.x[*state]);
        let y = self.deviations(states, at.desired, |y, desired| y - desired);
        let asked = self.laws.at(over).asked(&DVector::from_vec(y));
        for (&input, asked) in self.inputs.iter().zip(asked.iter()) {
            u[input] += asked;
        }
    }

    /// u₀ − K (y − y₀), with all three interpolated over the condition.
    fn write(&self, desired: &[Value], tape: &mut Tape, inputs: &mut [Value]) {
        let states = self.states.iter();
        let states: Vec<Value> = states.map(|(place, _)| law::state(tape, *place)).collect();
        let y = self.deviations(states, desired, |y, desired| {
            tape.binary(Arithmetic::Subtract, y, desired)
        });
        let over = match self.over {
            SchedulingVariable::State(place) => law::state(tape, place),
            SchedulingVariable::Parameter(place) => {
                tape.argument(Argument::Parameter(law::index(place)))
            }
        };
        let nodes: Vec<_> = self.laws.laws().collect();
        let along = |of: &dyn Fn(usize) -> f64| -> Vec<(f64, f64)> {
            let all = nodes.iter().enumerate();
            all.map(|(node, (value, _))| (*value, of(node))).collect()
        };
        let mut off = Vec::new();
        for (column, &y) in y.iter().enumerate() {
            let steady = interpolated(tape, over, &along(&|node| nodes[node].1.states[column]));
            off.push(tape.binary(Arithmetic::Subtract, y, steady));
        }
        for (row, &to) in self.inputs.iter().enumerate() {
            let mut asked = interpolated(tape, over, &along(&|node| nodes[node].1.inputs[row]));
            for (column, &off) in off.iter().enumerate() {
                let gain = along(&|node| nodes[node].1.gain[(row, column)]);
                let gain = interpolated(tape, over, &gain);
                let term = tape.binary(Arithmetic::Multiply, gain, off);
                asked = tape.binary(Arithmetic::Subtract, asked, term);
            }
            inputs[to] = tape.binary(Arithmetic::Add, inputs[to], asked);
        }
    }
}

/// The polygon through points, constant before the first and after the last.
fn interpolated(tape: &mut Tape, over: Value, points: &[(f64, f64)]) -> Value {
    let Some(&(_, last)) = points.last() else {
        return law::number(tape, 0.0);
    };
    let mut polygon = law::number(tape, last);
    if points
        .iter()
        .all(|(_, value)| value.to_bits() == last.to_bits())
    {
        return polygon;
    }
    for pair in points.windows(2).rev() {
        let [(from, low), (to, high)] = [pair[0], pair[1]];
        let [start, length, rise, first] =
            [from, to - from, high - low, low].map(|number| law::number(tape, number));
        let since = tape.binary(Arithmetic::Subtract, over, start);
        let part = tape.binary(Arithmetic::Divide, since, length);
        let more = tape.binary(Arithmetic::Multiply, rise, part);
        let inside = tape.binary(Arithmetic::Add, first, more);
        polygon = before(tape, over, to, [inside, polygon]);
    }
    let (start, first) = points[0];
    let first = law::number(tape, first);
    before(tape, over, start, [first, polygon])
}

/// One value before a limit of the condition, another from there on.
fn before(tape: &mut Tape, over: Value, limit: f64, branches: [Value; 2]) -> Value {
    let limit = law::number(tape, limit);
    tape.push(Operation::Choice {
        relation: Relation::Less,
        compared: [over, limit],
        branches,
    })
}

const KEYS: &[&str] = &["value", "gains", "offset", "steady"];

/// The schedule of a law; invalid entries are reported.
pub(super) fn read(
    reader: &mut Reader<'_>,
    table: &DeTable<'_>,
    inputs: Vec<usize>,
    states: Vec<usize>,
    desired: impl Fn(usize) -> (usize, Option<Expr>),
) -> Option<Schedule> {
    for key in ["gains", "offset", "sampled_ms"] {
        if let Some(value) = table.get(key) {
            let message = format!("a law with `over` has no `{key}` of its own");
            let help = "remove it; gains and offsets belong under `[[at]]`";
            reader.tell(Code::UnknownKey, message, value.span(), help);
        }
    }
    let (Some(over), Some(at)) = (table.get("over"), table.get("at")) else {
        let message = "a schedule needs `over` and `[[at]]`";
        let help = "write over = \"NAME\", and a table [[at]] for each value";
        reader.tell(Code::MissingKey, message, 0..0, help);
        return None;
    };
    let (over, quantity) = scheduling_variable(reader, over)?;
    let DeValue::Array(nodes) = at.get_ref() else {
        reader.wrong_type(at, "`at` must be a list", "write [[at]] with two brackets");
        return None;
    };
    let nodes: Vec<_> = (nodes.iter())
        .map(|node| operating_law(reader, node, &quantity, &inputs, &states))
        .collect();
    let laws = nodes.into_iter().collect::<Option<Vec<_>>>()?;
    match GainSchedule::new(laws) {
        Ok(laws) => Some(Schedule {
            over,
            laws,
            inputs,
            states: states.into_iter().map(desired).collect(),
        }),
        Err(error) => {
            reader.wrong_type(at, error.to_string(), "");
            None
        }
    }
}

/// The state or parameter of a name.
fn scheduling_variable(
    reader: &mut Reader<'_>,
    over: &Spanned<DeValue<'_>>,
) -> Option<(SchedulingVariable, Quantity)> {
    let (name, at) = reader.string(over)?;
    let info = reader.setup.info;
    let quantities = info.states.iter().chain(info.parameters.iter());
    let place = reader.find(&name, "state or parameter", quantities.clone(), at)?;
    let variable = match place.checked_sub(info.states.len()) {
        None => SchedulingVariable::State(place),
        Some(parameter) => SchedulingVariable::Parameter(parameter),
    };
    Some((variable, quantities.clone().nth(place)?.clone()))
}

/// The law at one value.
fn operating_law(
    reader: &mut Reader<'_>,
    node: &Spanned<DeValue<'_>>,
    over: &Quantity,
    inputs: &[usize],
    states: &[usize],
) -> Option<(f64, OperatingLaw)> {
    let DeValue::Table(table) = node.get_ref() else {
        reader.wrong_type(node, "expected a table", "");
        return None;
    };
    reader.known_keys(table, KEYS);
    let (Some(value), Some(_)) = (table.get("value"), table.get("gains")) else {
        let message = "a law of a schedule needs `value` and `gains`";
        reader.tell(Code::MissingKey, message, node.span(), "");
        return None;
    };
    let value = reader.number(value)? * over.scale;
    let gains = reader.gains(table, "gains")?;
    reader.count_gains(table, "gains", &gains, inputs.len(), states.len());
    let info = reader.setup.info;
    let gain = |i: usize, j: usize| gains.get(i).and_then(|row| row.get(j)).copied();
    let mut law = OperatingLaw {
        gain: DMatrix::from_fn(inputs.len(), states.len(), |i, j| gain(i, j).unwrap_or(0.0)),
        states: DVector::zeros(states.len()),
        inputs: DVector::zeros(inputs.len()),
    };
    if let Some(offset) = table.get("offset") {
        let offsets = reader.numbers(offset)?;
        let at = offset.span();
        reader.count("offset", offsets.len(), "input", inputs.len(), at);
        for ((place, &input), offset) in law.inputs.iter_mut().zip(inputs).zip(&offsets) {
            *place = offset * info.inputs[input].scale;
        }
    }
    if let Some(steady) = table.get("steady") {
        let DeValue::Table(values) = steady.get_ref() else {
            let help = "write steady = { STATE = VALUE }";
            reader.wrong_type(steady, "`steady` must be a table", help);
            return None;
        };
        for (name, value) in values {
            let state = reader.find(name.get_ref(), "state", info.states.iter(), name.span())?;
            let Some(place) = states.iter().position(|&other| other == state) else {
                let message = "a value of a state without a gain";
                let help = "add the state to `states`, with its gain";
                reader.tell(Code::UnknownReference, message, name.span(), help);
                return None;
            };
            law.states[place] = reader.number(value)? * info.states[state].scale;
        }
    }
    Some((value, law))
}
