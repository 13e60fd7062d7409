//! Steady motions of the shipped mechanisms.

use appell_analysis::{Point, SteadyProblem, Term};
use appell_models::Shipped;
use appell_runtime::model::Model;

/// A shipped model.
pub fn shipped(name: &str) -> &'static dyn Model {
    Shipped::find(name).unwrap().model
}

/// A quantity of a model.
pub fn term(model: &dyn Model, name: &str) -> Term {
    Term::named(model.info(), name).unwrap_or_else(|| panic!("no `{name}`"))
}

/// Steady motions with quantities as given.
pub fn problem<'a>(model: &'a dyn Model, given: &[(&str, f64)]) -> SteadyProblem<'a> {
    let mut problem = SteadyProblem::new(model, Point::initial(model)).unwrap();
    for (name, value) in given {
        problem.fix(term(model, name), *value).unwrap();
    }
    problem
}
