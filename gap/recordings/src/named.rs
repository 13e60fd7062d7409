//! Names of a description in the spec.

use appell_spec::Mechanism;

use crate::channel::{Measured, Role};
use crate::fields::Value;
use crate::robot::Robot;

/// The names that a description may use: those of the spec, or those of a robot file.
#[derive(Clone, Copy)]
pub(crate) struct Named<'m> {
    pub(crate) mechanism: &'m Mechanism,
    pub(crate) robot: Option<&'m Robot>,
}

impl Named<'_> {
    /// The parameters that a key names, each with the value that is one in the spec: of a factor the number that it
    /// multiplies.
    pub(crate) fn parameters(self, key: &str) -> Vec<(usize, f64)> {
        let parameters = &self.mechanism.parameters;
        let index = |name: &str| parameters.iter().position(|own| own.label.name == name);
        let Some(robot) = self.robot else {
            return index(key).map(|index| (index, 1.0)).into_iter().collect();
        };
        let numbers = robot.numbers(key).filter_map(|number| {
            let one = if number.relative { number.value } else { 1.0 };
            Some((index(&number.parameter)?, one))
        });
        numbers.collect()
    }

    /// Whether the name in a line of a pattern, filled, is a quantity that may be measured, or an input. A line that
    /// names none is of a column that is only recorded.
    pub(crate) fn is_known(self, line: &Value<'_>, filling: &str) -> bool {
        let name = |key: &str| filled(line.get_ref().as_table()?.get(key)?, filling);
        match (name("measures"), name("input")) {
            (Some(name), _) => self.measured(&name).is_some(),
            (None, Some(name)) => self.commanded(&name).is_some(),
            (None, None) => true,
        }
    }

    /// The quantity of a name that is measured.
    pub(crate) fn measured(self, name: &str) -> Option<Measured> {
        let own = self.robot.and_then(|robot| robot.measured(name));
        Measured::named(own.unwrap_or(name), self.mechanism)
    }

    /// The input of a name.
    pub(crate) fn commanded(self, name: &str) -> Option<Role> {
        let own = self.robot.and_then(|robot| robot.input(name));
        Role::input(own.unwrap_or(name), self.mechanism)
    }
}

/// A name with `*` in it filled; of a list, the filling itself.
pub(crate) fn filled(name: &Value<'_>, filling: &str) -> Option<String> {
    match name.get_ref().as_str() {
        Some(text) => Some(text.replace('*', filling)),
        None => name.get_ref().as_array().map(|_| filling.to_owned()),
    }
}
