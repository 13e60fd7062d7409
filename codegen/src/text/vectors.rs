//! Names of the vectors of a model and of their entries; shapes of result arrays.

use crate::program::{Layout, Program, Space};
use crate::schedule::names::{ArgumentNames, Names};
use crate::tape::Argument;

/// The vectors among the arguments of all functions, with the first entry of each.
pub(crate) const GROUPS: [(Space, Argument); 3] = [
    (Space::Parameters, Argument::Parameter(0)),
    (Space::State, Argument::State(0)),
    (Space::Inputs, Argument::Input(0)),
];

/// Unique identifiers of the entries of all vectors.
pub(crate) struct Vectors {
    pub(crate) names: ArgumentNames,
    /// `x_dot` for every state.
    rates: Vec<String>,
    outputs: Vec<String>,
    constraint_rows: Vec<String>,
    reactions: Vec<String>,
    speeds: usize,
}

impl Vectors {
    pub(crate) fn of(program: &Program) -> Self {
        let names = ArgumentNames::of(program);
        let info = &program.info;
        Self {
            rates: names.states.iter().map(|x| format!("{x}_dot")).collect(),
            outputs: distinct(info.outputs.iter().map(|output| &*output.name)),
            constraint_rows: distinct(info.constraint_rows.iter().map(|row| &**row)),
            reactions: distinct(info.reactions.iter().map(|reaction| &*reaction.name)),
            speeds: info.speeds.min(names.states.len()),
            names,
        }
    }

    /// The entries of a vector.
    pub(crate) fn entries(&self, space: Space) -> &[String] {
        match space {
            Space::Parameters => &self.names.parameters,
            Space::State => &self.names.states,
            Space::Inputs => &self.names.inputs,
            Space::Outputs => &self.outputs,
            Space::Rates => &self.rates,
            Space::Accelerations => &self.rates[..self.speeds],
            Space::CoordinateRates => &self.rates[self.speeds..],
            Space::GeneralizedForces => &self.names.states[..self.speeds],
            Space::ConstraintRows => &self.constraint_rows,
            Space::Reactions => &self.reactions,
        }
    }

    /// The entries that are not arguments of functions.
    pub(crate) fn results(&self) -> impl Iterator<Item = &String> {
        let lists = [
            &self.rates,
            &self.outputs,
            &self.constraint_rows,
            &self.reactions,
        ];
        lists.into_iter().flatten()
    }
}

/// Unique identifiers of names.
fn distinct<'a>(names: impl Iterator<Item = &'a str>) -> Vec<String> {
    let mut taken = Names::default();
    names.map(|name| taken.fresh(name)).collect()
}

/// Name of the struct of a vector.
pub(crate) fn type_name(space: Space) -> &'static str {
    match space {
        Space::Parameters => "Parameters",
        Space::State => "State",
        Space::Inputs => "Inputs",
        Space::Outputs => "Outputs",
        Space::Rates => "Rates",
        Space::Accelerations => "Accelerations",
        Space::CoordinateRates => "CoordinateRates",
        Space::GeneralizedForces => "GeneralizedForces",
        Space::ConstraintRows => "ConstraintResidual",
        Space::Reactions => "ConstraintForces",
    }
}

/// Rows and columns of an array; only columns for a list, neither for a number.
pub(crate) fn shape(program: &Program, layout: Layout) -> Vec<usize> {
    let len = |space: Space| match space {
        Space::ConstraintRows => program.info.constraint_rows.len(),
        Space::Reactions => program.info.reactions.len(),
        _ => space.quantities(&program.info).len(),
    };
    match layout {
        Layout::Scalar => Vec::new(),
        Layout::List(n) => vec![n],
        Layout::Vector(space) => vec![len(space)],
        Layout::Matrix(rows, columns) => vec![rows, columns],
        Layout::Rows(space, columns) => vec![len(space), columns],
        Layout::Jacobian(rows, columns) => vec![len(rows), len(columns)],
    }
}
