//! Names of a description in the spec.

use appell_spec::Mechanism;

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
}
