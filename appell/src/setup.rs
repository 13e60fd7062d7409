//! Values of a mechanism with units: parameters, initial values, inputs.

use std::borrow::Cow;

use appell_runtime::model::{ModelInfo, Quantity, tidy};
use appell_spec::expr::Expr;
pub use appell_spec::mechanism::InputId;
use appell_spec::mechanism::{CoordinateId, ParameterId, SpeedId};
pub use appell_spec::units::Unit;
use appell_spec::units::{self, UnitError};
use appell_spec::{Mechanism, Scope, Snippet, did_you_mean, formula};

use crate::formula::Workbench;
use crate::source::Robot;
use crate::{Error, Field};

/// A name with the text of its value, such as `R=30cm`.
#[derive(Debug, Clone)]
pub struct Assignment {
    /// Left side.
    pub name: String,
    /// Right side.
    pub value: String,
}

impl Assignment {
    /// A name with a value: a number in the unit that the spec declares, a number with a unit, or an
    /// expression.
    #[expect(
        clippy::needless_pass_by_value,
        reason = "a number or a text is given as it stands"
    )]
    pub fn new(name: &str, value: impl ToString) -> Self {
        Self {
            name: name.to_owned(),
            value: value.to_string(),
        }
    }
}

/// Methods of a request that add an assignment to one of its lists.
macro_rules! assigning {
    ($($(#[$about:meta])* $method:ident to $list:ident;)*) => {$(
        $(#[$about])*
        #[must_use]
        pub fn $method(mut self, name: &str, value: impl ToString) -> Self {
            self.$list.push($crate::setup::Assignment::new(name, value));
            self
        }
    )*};
}
pub(crate) use assigning;

impl std::str::FromStr for Assignment {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let (name, value) = text
            .split_once('=')
            .ok_or("write NAME=VALUE, such as R=0.3 or R=30cm")?;
        let (name, value) = (name.trim().to_owned(), value.trim().to_owned());
        if name.is_empty() || value.is_empty() {
            return Err("write NAME=VALUE, with something on both sides".to_owned());
        }
        Ok(Self { name, value })
    }
}

/// A spec, its mechanism, and values that override those of the spec.
pub struct Setup<'a> {
    /// Text of the spec.
    pub spec: &'a str,
    /// The mechanism.
    pub mechanism: Mechanism,
    /// Names, units and sizes of its equations.
    pub info: &'a ModelInfo,
    /// Parameters in SI.
    pub parameters: Vec<f64>,
    /// Initial state in SI.
    pub initial: Vec<f64>,
    /// Whether states must stay in their declared ranges.
    pub watch_ranges: bool,
    /// The robot file of which it is the spec.
    pub robot: Option<&'a Robot>,
}

impl<'a> Setup<'a> {
    /// The values of the spec.
    pub fn new(file: &str, spec: &'a str, info: &'a ModelInfo) -> Result<Self, Error> {
        let checked = appell_spec::load(file, spec)?;
        let (parameters, initial) = (info.default_parameters(), info.initial_state());
        Ok(Self {
            spec,
            mechanism: checked.mechanism,
            info,
            parameters,
            initial,
            watch_ranges: true,
            robot: None,
        })
    }

    /// The name in the spec of a quantity, which a robot file may call otherwise.
    pub fn in_spec<'n>(&'n self, name: &'n str) -> &'n str {
        let of_file = (self.robot).and_then(|robot| robot.imported.dictionary.in_spec(name));
        of_file.unwrap_or(name)
    }

    /// Sets parameters; an expression may use parameters set before it.
    pub fn set(&mut self, assignments: &[Assignment]) -> Result<(), Error> {
        self.set_with(Field::Set, assignments)
    }

    /// Sets parameters that another part of a request gives.
    pub fn set_with(&mut self, field: Field, assignments: &[Assignment]) -> Result<(), Error> {
        unique(assignments, field)?;
        for assignment in assignments {
            let Assignment { name, value } = assignment;
            let index = known(
                field,
                self.in_spec(name),
                "parameter",
                &self.info.parameters,
            )?;
            let unit = self.unit_of_parameter(index);
            let value = self.value(field, name, value, unit)?;
            inside(name, value, self.limits_of_parameter(index), unit)
                .map_err(|message| Error::request(field, message))?;
            self.parameters[index] = value;
        }
        Ok(())
    }

    /// Sets initial values; an expression may use parameters.
    pub fn start(&mut self, assignments: &[Assignment]) -> Result<(), Error> {
        self.start_with(Field::Initial, assignments)
    }

    /// Sets states that another part of a request gives.
    pub(crate) fn start_with(
        &mut self,
        field: Field,
        assignments: &[Assignment],
    ) -> Result<(), Error> {
        unique(assignments, field)?;
        for Assignment { name, value } in assignments {
            let index = self.state(field, name)?;
            let value = self.value(field, name, value, self.unit_of_state(index))?;
            self.place(index, value)
                .map_err(|message| Error::request(field, message))?;
        }
        Ok(())
    }

    /// Index of a state.
    pub fn state(&self, field: Field, name: &str) -> Result<usize, Error> {
        known(field, self.in_spec(name), "state", &self.info.states)
    }

    /// The declared inputs.
    pub(crate) fn declared_inputs(&self) -> &'a [Quantity] {
        &self.info.inputs[..self.info.declared_inputs]
    }

    /// Index of a declared input.
    pub fn input(&self, field: Field, name: &str) -> Result<usize, Error> {
        known(field, self.in_spec(name), "input", self.declared_inputs())
    }

    /// A constant value of a declared input, with its index.
    pub(crate) fn input_value(
        &self,
        field: Field,
        Assignment { name, value }: &Assignment,
    ) -> Result<(usize, f64), Error> {
        let input = self.input(field, name)?;
        let unit = self.unit_of_input(input);
        Ok((input, self.value(field, name, value, unit)?))
    }

    /// Unit of a parameter.
    pub(crate) fn unit_of_parameter(&self, index: usize) -> &Unit {
        &self.mechanism.parameters[ParameterId::new(index)]
            .label
            .unit
    }

    /// Limits of a parameter in SI.
    pub(crate) fn limits_of_parameter(&self, index: usize) -> [f64; 2] {
        let parameter = &self.mechanism.parameters[ParameterId::new(index)];
        [
            parameter.at_least.unwrap_or(f64::NEG_INFINITY),
            parameter.at_most.unwrap_or(f64::INFINITY),
        ]
    }

    /// Unit of a declared input.
    pub(crate) fn unit_of_input(&self, index: usize) -> &Unit {
        &self.mechanism.inputs[InputId::new(index)].label.unit
    }

    /// Unit of a state.
    pub fn unit_of_state(&self, index: usize) -> &Unit {
        let speeds = &self.mechanism.pseudo_velocities;
        match index.checked_sub(speeds.len()) {
            None => &speeds[SpeedId::new(index)].label.unit,
            Some(coordinate) => {
                &self.mechanism.coordinates[CoordinateId::new(coordinate)]
                    .label
                    .unit
            }
        }
    }

    /// A value in SI of the quantity `name`: a number in its unit, a number with a unit, or an
    /// expression in the parameters.
    pub fn value(&self, field: Field, name: &str, text: &str, unit: &Unit) -> Result<f64, Error> {
        let expr = expression(self.spec, field, name, text, Scope::Constant, unit)?;
        self.constant(&expr).ok_or_else(|| {
            let message = format!("{name}: `{}` is not a finite number", bracketed(text));
            Error::request(field, message)
        })
    }

    /// The finite value of an expression in parameters.
    pub(crate) fn constant(&self, expr: &Expr) -> Option<f64> {
        let mut bench = Workbench::new(&self.mechanism);
        let lowered = bench.lower(expr)?;
        let value = bench.constants(&[lowered], &self.parameters)[0];
        value.is_finite().then_some(value)
    }

    /// Sets an initial value, which must lie in its range if ranges are watched.
    pub(crate) fn place(&mut self, state: usize, value: f64) -> Result<(), String> {
        if self.watch_ranges {
            self.state_within(state, value)?;
        }
        self.initial[state] = value;
        Ok(())
    }

    /// Whether a value of a state lies in its range.
    pub(crate) fn state_within(&self, state: usize, value: f64) -> Result<(), String> {
        let quantity = &self.info.states[state];
        inside(
            &quantity.name,
            value,
            quantity.range,
            self.unit_of_state(state),
        )
    }
}

/// The expression of a request for a quantity, with the names of a spec.
pub(crate) fn expression(
    spec: &str,
    field: Field,
    name: &str,
    text: &str,
    scope: Scope,
    unit: &Unit,
) -> Result<Expr, Error> {
    let what = match scope {
        Scope::Law => "the input",
        Scope::Equation => "the equation",
        _ => "the value",
    };
    let text = bracketed(text);
    let expr = formula(spec, &Snippet::alone(&text), what, scope, unit);
    expr.map_err(Error::expression(field, name, &text))
}

/// `30cm` and `30 cm` become `30[cm]`; any other text is already an expression.
pub(crate) fn bracketed(text: &str) -> Cow<'_, str> {
    let (number, rest) = text.split_at(number_length(text));
    let unit = rest.trim();
    let begins = |c: char| c.is_alphabetic() || c == '%';
    if number.is_empty() || !unit.starts_with(begins) || !meant(unit) {
        return Cow::Borrowed(text);
    }
    Cow::Owned(format!("{number}[{unit}]"))
}

/// Whether a text is a unit, or the word for one: the error then names its symbol.
fn meant(unit: &str) -> bool {
    match units::parse(unit) {
        Ok(_) => true,
        Err(UnitError::Unknown { at, similar, .. }) => at == (0..unit.len()) && similar.is_some(),
        Err(_) => false,
    }
}

/// Length in bytes of the number at the start of a text. An `e` without digits begins a unit.
fn number_length(text: &str) -> usize {
    let is_number = |end: &usize| {
        let number = text.get(..*end).unwrap_or_default();
        // Not `inf` nor `nan`.
        let is_finite = number.ends_with(|c: char| c.is_ascii_digit() || c == '.');
        is_finite && number.parse::<f64>().is_ok()
    };
    (1..=text.len()).rev().find(is_number).unwrap_or(0)
}

/// Position of a name, or an error that suggests another.
pub(crate) fn known(
    field: Field,
    name: &str,
    what: &str,
    among: &[Quantity],
) -> Result<usize, Error> {
    let names = among.iter().map(|quantity| quantity.name.as_ref());
    let mut places = names.clone();
    places
        .position(|other| other == name)
        .ok_or_else(|| Error::request(field, unknown(name, what, names)))
}

/// The message for an unknown name.
pub(crate) fn unknown<'n>(
    name: &str,
    what: &str,
    names: impl Iterator<Item = &'n str> + Clone,
) -> String {
    format!("there is no {what} `{name}`; {}", instead(name, names))
}

/// A suggestion for an unknown name.
pub(crate) fn instead<'n>(name: &str, names: impl Iterator<Item = &'n str> + Clone) -> String {
    did_you_mean(name, names.clone(), || {
        let list = names.collect::<Vec<_>>();
        if list.is_empty() {
            "the mechanism has none".to_owned()
        } else {
            format!("there are {}", list.join(", "))
        }
    })
}

/// The parts of a list separated by commas outside brackets.
pub fn listed(text: &str) -> Vec<&str> {
    let mut depth = 0_usize;
    let between = |c: char| {
        match c {
            '(' | '[' => depth += 1,
            ')' | ']' => depth = depth.saturating_sub(1),
            _ => {}
        }
        c == ',' && depth == 0
    };
    text.split(between).map(str::trim).collect()
}

/// Refuses a name that is given twice.
pub(crate) fn unique(assignments: &[Assignment], field: Field) -> Result<(), Error> {
    for (i, assignment) in assignments.iter().enumerate() {
        if assignments[..i]
            .iter()
            .any(|other| other.name == assignment.name)
        {
            let message = format!("`{}` is given twice", assignment.name);
            return Err(Error::request(field, message));
        }
    }
    Ok(())
}

fn inside(name: &str, value: f64, [low, high]: [f64; 2], unit: &Unit) -> Result<(), String> {
    if (low..=high).contains(&value) {
        return Ok(());
    }
    // A number that fits as an angle in degrees was likely meant to be one.
    let degrees = unit.from_si(value);
    let fits = unit.text == "rad" && (low..=high).contains(&value.to_radians());
    let instead = if fits {
        format!("; `{degrees}deg` is inside them")
    } else {
        String::new()
    };
    let [value, low, high] = [value, low, high].map(|si| tidy(unit.from_si(si)));
    Err(format!(
        "`{name}` = {value} {unit} is outside its limits {low} … {high} {unit}{instead}",
        unit = unit.text
    ))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn commas_in_brackets_do_not_separate() {
        let text = "a=0, b=atan2(1, c[m]),d=2";
        assert_eq!(listed(text), ["a=0", "b=atan2(1, c[m])", "d=2"]);
    }

    #[test]
    fn units_right_after_a_number_get_brackets() {
        for (text, expected) in [
            ("0.3", "0.3"),
            ("-1e-3", "-1e-3"),
            ("30cm", "30[cm]"),
            ("-.5 cm", "-.5[cm]"),
            ("1e3mm", "1e3[mm]"),
            ("2eV", "2[eV]"),
            ("2 apples", "2 apples"),
            ("3%", "3[%]"),
            ("2*l", "2*l"),
            ("2 l", "2[l]"),
            ("5[m]", "5[m]"),
            ("l", "l"),
            ("", ""),
            (".m", ".m"),
        ] {
            assert_eq!(bracketed(text), expected);
        }
    }
}
