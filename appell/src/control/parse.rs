//! The texts of a control request: steady motion, poles, weights, ranges.

use appell_analysis::control::sampled::Sampling;
use appell_analysis::{Point, SteadyProblem, Term};
use appell_runtime::model::Model;
use nalgebra::Complex;

use super::design::Method;
use crate::setup::{Assignment, Setup, unique, unknown};
use crate::steady::{term, value_of};
use crate::{Error, Field};

/// Prescribed inputs on the steady motion; the others are solved for.
pub(crate) type GivenInputs = Vec<(usize, f64)>;

/// Maximum number of intervals of a range.
const MOST_STEPS: usize = 10_000;

/// The steady motion: states go to the setup, inputs are returned. A rate or an output determines the other
/// states, given the value of a scheduling variable.
pub(crate) fn point(
    model: &dyn Model,
    setup: &mut Setup<'_>,
    assignments: &[Assignment],
    scheduled: Option<(Term, f64)>,
) -> Result<GivenInputs, Error> {
    unique(assignments, Field::At)?;
    let info = setup.info;
    let follows = |a: &Assignment| {
        let term = Term::named(info, &a.name);
        matches!(term, Some(Term::Rate(_) | Term::Output(_)))
    };
    if assignments.iter().any(follows) {
        return motion(model, setup, assignments, scheduled);
    }
    let declared = setup.declared_inputs();
    let is_input = |a: &&Assignment| declared.iter().any(|input| input.name == a.name);
    let (inputs, states): (Vec<_>, Vec<_>) = assignments.iter().partition(is_input);
    let states: Vec<Assignment> = states.into_iter().cloned().collect();
    let names = info.states.iter().chain(declared);
    let names = || names.clone().map(|quantity| quantity.name.as_ref());
    if let Some(other) = states.iter().find(|a| !names().any(|name| name == a.name)) {
        let message = unknown(&other.name, "state or input", names());
        return Err(Error::request(Field::At, message));
    }
    setup.start_with(Field::At, &states)?;
    let value = |a: &Assignment| setup.input_value(Field::At, a);
    inputs.into_iter().map(value).collect()
}

/// The steady motion with prescribed quantities; states go to the setup, all inputs are returned.
fn motion(
    model: &dyn Model,
    setup: &mut Setup<'_>,
    assignments: &[Assignment],
    scheduled: Option<(Term, f64)>,
) -> Result<GivenInputs, Error> {
    /// Number of starting points of the search.
    const STARTS: usize = 40;
    let base = Point {
        x: setup.initial.clone(),
        p: setup.parameters.clone(),
        ..Point::initial(model)
    };
    let mut problem = SteadyProblem::new(model, base)?;
    let mut given: Vec<Term> = scheduled.iter().map(|(term, _)| *term).collect();
    for fixed in assignments {
        let term = term(setup, Field::At, &fixed.name)?;
        given.push(term);
        if scheduled.is_none_or(|(scheduled, _)| scheduled != term) {
            problem.fix(term, value_of(setup, term, Field::At, fixed)?)?;
        }
    }
    if let Some((term @ (Term::State(_) | Term::Input(_)), value)) = scheduled {
        problem.fix(term, value)?;
    }
    // Inputs that are not given are zero where that determines a motion.
    let found = problem.solve_isolated(STARTS).or_else(|_| {
        for input in 0..setup.info.declared_inputs {
            if !given.contains(&Term::Input(input)) {
                problem.free(Term::Input(input))?;
            }
        }
        problem.solve_isolated(STARTS)
    })?;
    // The nearest one is first.
    let point = found.into_iter().next().map(|motion| motion.point);
    let point = point.unwrap_or_else(|| problem.base().clone());
    setup.initial = point.x;
    // Inputs below rounding, in SI, are zero.
    let clean = |u: f64| if u.abs() < f64::EPSILON { 0.0 } else { u };
    let inputs = point.u.into_iter().take(setup.info.declared_inputs);
    Ok(inputs.map(clean).enumerate().collect())
}

/// Indices of the names of a list, each of which may be given once.
pub(crate) fn distinct(
    field: Field,
    names: &[String],
    find: impl Fn(&str) -> Result<usize, Error>,
) -> Result<Vec<usize>, Error> {
    let mut found = Vec::new();
    for name in names {
        let place = find(name.trim())?;
        if found.contains(&place) {
            return Err(Error::request(field, format!("`{name}` is given twice")));
        }
        found.push(place);
    }
    Ok(found)
}

/// Poles such as `-8,-2+3i,-2-3i`.
pub(crate) fn poles(text: &str) -> Result<Vec<Complex<f64>>, Error> {
    let pole = |text: &str| {
        complex(text.trim()).ok_or_else(|| {
            let message = format!(
                "`{}` is not a pole; write numbers such as -8, or pairs such as -2+3i,-2-3i",
                text.trim()
            );
            Error::request(Field::Poles, message)
        })
    };
    text.split(',').map(pole).collect()
}

/// A number such as `-2`, `3i` or `-2+3i`.
fn complex(text: &str) -> Option<Complex<f64>> {
    let finite = |text: &str| text.parse::<f64>().ok().filter(|number| number.is_finite());
    let Some(text) = text.strip_suffix(['i', 'j']) else {
        return finite(text).map(Complex::from);
    };
    // The sign of the imaginary part, not that of an exponent.
    let sign = text
        .char_indices()
        .rev()
        .find(|&(at, c)| matches!(c, '+' | '-') && !text[..at].ends_with(['e', 'E']));
    let (real, imaginary) = text.split_at(sign.map_or(0, |(at, _)| at));
    let imaginary = match imaginary {
        "" | "+" => 1.0,
        "-" => -1.0,
        number => finite(number)?,
    };
    let real = if real.is_empty() { 0.0 } else { finite(real)? };
    Some(Complex::new(real, imaginary))
}

/// Weights such as `Q=1,10,R=0.1`.
pub(crate) fn weights(text: &str) -> Result<Method, Error> {
    let wrong = |what: &str| {
        let message = format!(
            "{what}; write Q=1,10,R=0.1, with a weight for each output in Q and for each input in R, \
             or a single one for all"
        );
        Error::request(Field::Weights, message)
    };
    let [mut q, mut r]: [Option<Vec<f64>>; 2] = [None, None];
    let mut into: Option<&mut Vec<f64>> = None;
    for part in text.split(',').map(str::trim) {
        let number = match part.split_once('=') {
            None => part,
            Some((name, number)) => {
                let list = match name.trim() {
                    "Q" => &mut q,
                    "R" => &mut r,
                    other => return Err(wrong(&format!("there is no weight `{other}`"))),
                };
                if list.is_some() {
                    return Err(wrong(&format!("`{}` is given twice", name.trim())));
                }
                into = Some(list.insert(Vec::new()));
                number.trim()
            }
        };
        let value = number.parse::<f64>().ok().filter(|value| value.is_finite());
        let value = value.ok_or_else(|| wrong(&format!("`{number}` is not a number")))?;
        into.as_mut()
            .ok_or_else(|| wrong(&format!("`{number}` stands before Q= or R=")))?
            .push(value);
    }
    Ok(Method::Weights {
        outputs: q.ok_or_else(|| wrong("Q is missing"))?,
        inputs: r.ok_or_else(|| wrong("R is missing"))?,
    })
}

/// Sampling period and delay.
pub(crate) fn sampling(
    period_ms: Option<f64>,
    delay_ms: Option<f64>,
) -> Result<Option<Sampling>, Error> {
    if let (None, Some(_)) = (period_ms, delay_ms) {
        let message = "a delay needs a sampling period";
        return Err(Error::request(Field::Sampling, message));
    }
    let sampling = |period_ms: f64| Sampling::new(period_ms / 1e3, delay_ms.unwrap_or(0.0) / 1e3);
    let sampling = period_ms.map(sampling).transpose();
    sampling.map_err(|error| Error::request(Field::Sampling, error.to_string()))
}

/// `FROM..TO` of `NAME=FROM..TO/STEPS`
fn ends(field: Field, range: &Assignment) -> Result<[&str; 2], Error> {
    let parts = range.value.split_once("..").and_then(|(from, rest)| {
        let (to, _) = rest.rsplit_once('/')?;
        Some([from, to])
    });
    parts.ok_or_else(|| no_range(field, range))
}

/// `STEPS` of `NAME=FROM..TO/STEPS`
fn steps(field: Field, range: &Assignment) -> Result<usize, Error> {
    let steps = range
        .value
        .rsplit_once('/')
        .and_then(|(_, steps)| steps.trim().parse().ok());
    match steps.ok_or_else(|| no_range(field, range))? {
        steps if (1..=MOST_STEPS).contains(&steps) => Ok(steps),
        steps => Err(Error::request(
            field,
            format!("{steps} intervals; between 1 and {MOST_STEPS} are possible"),
        )),
    }
}

fn no_range(field: Field, range: &Assignment) -> Error {
    let message = format!(
        "`{}` is not a range; write {}=1..5/8 for eight intervals from 1 to 5",
        range.value, range.name
    );
    Error::request(field, message)
}

/// Equidistant values, ends included.
fn spread([from, to]: [f64; 2], steps: usize) -> Vec<f64> {
    let part = |step: usize| step as f64 / steps as f64;
    (0..=steps)
        .map(|step| from + (to - from) * part(step))
        .collect()
}

/// `NAME=FROM..TO/STEPS`: a state, and its deviations from the steady motion.
pub(crate) fn disturbances(setup: &Setup<'_>, text: &str) -> Result<(usize, Vec<f64>), Error> {
    const FIELD: Field = Field::Attraction;
    let range = text.parse::<Assignment>();
    let range = range.map_err(|message| Error::request(FIELD, message))?;
    let state = setup.state(FIELD, &range.name)?;
    let unit = setup.unit_of_state(state);
    let value = |text: &str| setup.value(FIELD, &range.name, text.trim(), unit);
    let [from, to] = ends(FIELD, &range)?;
    let ends = [value(from)?, value(to)?];
    Ok((state, spread(ends, steps(FIELD, &range)?)))
}

/// Scheduling variable, a state, input or parameter, with its values.
pub(crate) struct Values {
    pub(crate) term: Term,
    /// In SI.
    pub(crate) si: Vec<f64>,
}

/// Values of a scheduling variable: `NAME=FROM..TO/STEPS`.
pub(crate) fn values(setup: &mut Setup<'_>, schedule: &Assignment) -> Result<Values, Error> {
    let [from, to] = ends(Field::Schedule, schedule)?;
    let steps = steps(Field::Schedule, schedule)?;
    let (name, info) = (&schedule.name, setup.info);
    let is_varied = |term: &Term| match *term {
        Term::State(_) | Term::Parameter(_) => true,
        Term::Input(input) => input < info.declared_inputs,
        Term::Output(_) | Term::Rate(_) => false,
    };
    let term = Term::named(info, name).filter(is_varied).ok_or_else(|| {
        let names = (info.states.iter())
            .chain(setup.declared_inputs())
            .chain(info.parameters.iter());
        let names = names.map(|quantity| quantity.name.as_ref());
        let message = unknown(name, "state, input or parameter", names);
        Error::request(Field::Schedule, message)
    })?;
    let mut end = |text: &str| -> Result<f64, Error> {
        let assignment = Assignment {
            name: name.clone(),
            value: text.trim().to_owned(),
        };
        match term {
            Term::State(state) => {
                setup.start_with(Field::Schedule, &[assignment])?;
                Ok(setup.initial[state])
            }
            Term::Parameter(parameter) => {
                setup.set_with(Field::Schedule, &[assignment])?;
                Ok(setup.parameters[parameter])
            }
            _ => Ok(setup.input_value(Field::Schedule, &assignment)?.1),
        }
    };
    let (from, to) = (end(from)?, end(to)?);
    Ok(Values {
        term,
        si: spread([from, to], steps),
    })
}

impl Values {
    /// Sets the variable.
    pub(crate) fn place(&self, setup: &mut Setup<'_>, inputs: &mut GivenInputs, value: f64) {
        match self.term {
            Term::State(state) => setup.initial[state] = value,
            Term::Parameter(parameter) => setup.parameters[parameter] = value,
            Term::Input(input) => {
                inputs.retain(|(other, _)| *other != input);
                inputs.push((input, value));
            }
            Term::Output(_) | Term::Rate(_) => {}
        }
    }

    /// A failure at a value of the variable.
    pub(crate) fn at(&self, setup: &Setup<'_>, value: f64, failure: Error) -> Error {
        let quantity = self.term.quantity(setup.info);
        let (shown, unit) = (quantity.to_unit(value), &quantity.unit);
        Error::At {
            place: format!("{} = {shown} {unit}", quantity.name),
            source: Box::new(failure),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn poles_are_read_with_and_without_imaginary_part() {
        for (text, re, im) in [
            ("-8", -8.0, 0.0),
            ("-2+3i", -2.0, 3.0),
            ("-2-3.5j", -2.0, -3.5),
            ("1e-3-2e+1i", 1e-3, -20.0),
            ("i", 0.0, 1.0),
            ("-1-i", -1.0, -1.0),
            ("4i", 0.0, 4.0),
        ] {
            assert_eq!(complex(text), Some(Complex::new(re, im)), "{text}");
        }
        for text in ["", "a", "-2+", "1+2", "inf", "2ii", "+-1i"] {
            assert_eq!(complex(text), None, "{text}");
        }
    }

    #[test]
    fn weights_are_read_by_their_names() {
        let Ok(Method::Weights { outputs, inputs }) = weights("Q=1,10,R=0.1") else {
            panic!("these are weights");
        };
        assert_eq!((outputs, inputs), (vec![1.0, 10.0], vec![0.1]));
        for text in [
            "1,2",
            "Q=1",
            "R=1",
            "Q=1,Q=2,R=1",
            "Q=x,R=1",
            "S=1",
            "Q=,R=1",
        ] {
            assert!(weights(text).is_err(), "{text}");
        }
    }
}
