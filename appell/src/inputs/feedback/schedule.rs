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
use appell_runtime::model::Quantity;
use appell_spec::Code;
use nalgebra::{DMatrix, DVector};
use toml::Spanned;
use toml::de::{DeTable, DeValue};

use super::reading::Reader;

/// A scheduling variable.
#[derive(Debug, Clone, Copy)]
pub enum SchedulingVariable {
    /// A state.
    State(usize),
    /// A parameter.
    Parameter(usize),
}

impl SchedulingVariable {
    /// Its value in SI.
    pub fn value(self, x: &[f64], p: &[f64]) -> f64 {
        match self {
            Self::State(state) => x[state],
            Self::Parameter(parameter) => p[parameter],
        }
    }
}

const KEYS: &[&str] = &["value", "gains", "offset", "steady"];

/// The schedule of a law; invalid entries are reported.
pub(super) fn read(
    reader: &mut Reader<'_>,
    table: &DeTable<'_>,
    inputs: &[usize],
    states: &[usize],
) -> Option<(SchedulingVariable, GainSchedule)> {
    for key in ["gains", "offset", "sampled_ms"] {
        if let Some(value) = table.get(key) {
            let message = format!("a law with `over` has no `{key}` of its own");
            let help = "remove it; gains and offsets belong under `[[at]]`";
            reader.tell(Code::UnknownKey, message, value.span(), help);
        }
    }
    let (Some(over), Some(at)) = (table.get("over"), table.get("at")) else {
        let help = "write over = \"NAME\", and a table [[at]] for each value";
        reader.tell(
            Code::MissingKey,
            "a schedule needs `over` and `[[at]]`",
            0..0,
            help,
        );
        return None;
    };
    let (varied, quantity) = varied(reader, over)?;
    let DeValue::Array(nodes) = at.get_ref() else {
        let help = "write [[at]] with two brackets";
        reader.tell(Code::WrongType, "`at` must be a list", at.span(), help);
        return None;
    };
    let nodes: Vec<_> = (nodes.iter())
        .map(|node| law(reader, node, &quantity, inputs, states))
        .collect();
    let laws = nodes.into_iter().collect::<Option<Vec<_>>>()?;
    match GainSchedule::new(laws) {
        Ok(schedule) => Some((varied, schedule)),
        Err(error) => {
            reader.tell(Code::WrongType, error.to_string(), at.span(), "");
            None
        }
    }
}

/// The state or parameter of a name.
fn varied(
    reader: &mut Reader<'_>,
    over: &Spanned<DeValue<'_>>,
) -> Option<(SchedulingVariable, Quantity)> {
    let (name, at) = reader.string(over)?;
    let info = reader.setup.info;
    let lists = [&info.states, &info.parameters].map(|list| list.iter());
    let names: Vec<String> = (lists.into_iter().flatten())
        .map(|quantity| quantity.name.to_string())
        .collect();
    let place = reader.find(&name, "state or parameter", &names, at)?;
    Some(match place.checked_sub(info.states.len()) {
        None => (SchedulingVariable::State(place), info.states[place].clone()),
        Some(parameter) => (
            SchedulingVariable::Parameter(parameter),
            info.parameters[parameter].clone(),
        ),
    })
}

/// The law at one value.
fn law(
    reader: &mut Reader<'_>,
    node: &Spanned<DeValue<'_>>,
    over: &Quantity,
    inputs: &[usize],
    states: &[usize],
) -> Option<(f64, OperatingLaw)> {
    let DeValue::Table(table) = node.get_ref() else {
        reader.tell(Code::WrongType, "expected a table", node.span(), "");
        return None;
    };
    for key in table
        .keys()
        .filter(|key| !KEYS.contains(&key.get_ref().as_ref()))
    {
        let message = format!("unknown key `{}`", key.get_ref());
        let help = format!("the keys are {}", KEYS.join(", "));
        reader.tell(Code::UnknownKey, message, key.span(), &help);
    }
    let (Some(value), Some(_)) = (table.get("value"), table.get("gains")) else {
        let message = "a law of a schedule needs `value` and `gains`";
        reader.tell(Code::MissingKey, message, node.span(), "");
        return None;
    };
    let value = reader.number(value)? * over.scale;
    let gains = reader.gains(table, "gains")?;
    reader.count_gains(table, "gains", &gains, inputs.len(), states.len());
    let info = reader.setup.info;
    let mut law = OperatingLaw {
        gain: DMatrix::zeros(inputs.len(), states.len()),
        states: DVector::zeros(states.len()),
        inputs: DVector::zeros(inputs.len()),
    };
    for (i, row) in gains.iter().enumerate().take(inputs.len()) {
        for (j, gain) in row.iter().enumerate().take(states.len()) {
            law.gain[(i, j)] = *gain;
        }
    }
    if let Some(offset) = table.get("offset") {
        let offsets = reader.numbers(offset)?;
        reader.count(
            "offset",
            offsets.len(),
            "input",
            inputs.len(),
            offset.span(),
        );
        for ((place, &input), offset) in law.inputs.iter_mut().zip(inputs).zip(&offsets) {
            *place = offset * info.inputs[input].scale;
        }
    }
    if let Some(steady) = table.get("steady") {
        let DeValue::Table(values) = steady.get_ref() else {
            let help = "write steady = { STATE = VALUE }";
            reader.tell(
                Code::WrongType,
                "`steady` must be a table",
                steady.span(),
                help,
            );
            return None;
        };
        for (name, value) in values {
            let names = reader.states();
            let state = reader.find(name.get_ref(), "state", &names, name.span())?;
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
