//! Errors as exceptions of the package, with the positions of the findings.

use appell::check::findings;
use appell::{Class, Error, Field, Report};
use pyo3::prelude::*;

/// The exception of an error: `appell.SpecError`, `RequestError`, `DataError` or `ComputationError`.
pub(crate) fn exception(py: Python<'_>, error: &Error) -> PyErr {
    let found = match error {
        Error::Report(report) => found_in(report),
        Error::Expression(error) => {
            let place = format!("{} {}", argument(error.field), error.name);
            found_in(&error.report(&place))
        }
        _ => "[]".to_owned(),
    };
    let class = match (error, error.class()) {
        (Error::Report(_), _) => "SpecError",
        (_, Class::Request) => "RequestError",
        (_, Class::Data) => "DataError",
        (_, Class::Computation) => "ComputationError",
    };
    let field = error.field().map(argument);
    let text = match error {
        // Its argument is one, the pair of both.
        Error::Request {
            field: Field::Sampling,
            ..
        } => error.to_string(),
        Error::Request { field, message } => format!("{}: {message}", argument(*field)),
        other => other.to_string(),
    };
    made(py, class, (text, found, field))
}

/// The Python argument of a part of a request.
fn argument(field: Field) -> &'static str {
    match field {
        Field::Set | Field::Letters => "parameters",
        Field::Input => "inputs",
        Field::Recorded => "recorded",
        Field::End => "t_end",
        Field::Interval => "dt",
        Field::Sampling => "sampled_ms, delay_ms",
        other => other.name(),
    }
}

fn found_in(report: &Report) -> String {
    serde_json::Value::from(findings(report)).to_string()
}

/// An internal error.
pub(crate) fn mistake(py: Python<'_>) -> PyErr {
    let message = "a mistake in appell: this cannot be computed";
    made(
        py,
        "ComputationError",
        (message.to_owned(), "[]".to_owned(), None),
    )
}

fn made(py: Python<'_>, class: &str, arguments: (String, String, Option<&str>)) -> PyErr {
    let make = || {
        let class = py.import("appell._errors")?.getattr(class)?;
        class.call1(arguments)
    };
    match make() {
        Ok(value) => PyErr::from_value(value),
        Err(error) => error,
    }
}

/// A result with the exception of its error.
pub(crate) trait Raise<T> {
    fn raise(self, py: Python<'_>) -> PyResult<T>;
}

impl<T, E: Into<Error>> Raise<T> for Result<T, E> {
    fn raise(self, py: Python<'_>) -> PyResult<T> {
        self.map_err(|error| exception(py, &error.into()))
    }
}
