//! What a user asks a controller for, read from flags.

use appell_analysis::control::sampled::Sampling;
use appell_analysis::{Point, SteadyProblem, Term};
use appell_runtime::model::{Model, Quantity};
use nalgebra::Complex;

use super::design::Method;
use crate::failure::Failure;
use crate::motions::{refused, term, value_of};
use crate::setup::{Assignment, Setup, unique, unknown};

/// Inputs on the steady motion that were given; the others are chosen.
pub(crate) type GivenInputs = Vec<(usize, f64)>;

/// Most designs of a schedule.
const MOST_STEPS: usize = 10_000;

/// Reads `--at`: states go to the setup, inputs are returned. Where a rate or an output is given,
/// the other states follow from it.
pub(crate) fn point(
    model: &dyn Model,
    setup: &mut Setup<'_>,
    assignments: &[Assignment],
) -> Result<GivenInputs, Failure> {
    unique(assignments, "--at")?;
    let info = setup.info;
    let follows = |a: &Assignment| {
        let term = Term::named(info, &a.name);
        matches!(term, Some(Term::Rate(_) | Term::Output(_)))
    };
    if assignments.iter().any(follows) {
        return motion(model, setup, assignments);
    }
    let declared = &info.inputs[..info.declared_inputs];
    let is_input = |a: &&Assignment| declared.iter().any(|input| input.name == a.name);
    let (inputs, states): (Vec<_>, Vec<_>) = assignments.iter().partition(is_input);
    let states: Vec<Assignment> = states.into_iter().cloned().collect();
    let names = info.states.iter().chain(declared);
    let names = || names.clone().map(|quantity| quantity.name.as_ref());
    if let Some(other) = states.iter().find(|a| !names().any(|name| name == a.name)) {
        let text = unknown(&other.name, "state or input", names());
        return Err(Failure::Usage(text));
    }
    setup.start_with("--at", &states)?;
    let value = |a: &Assignment| setup.input_value("--at", a);
    inputs.into_iter().map(value).collect()
}

/// The steady motion with quantities as given; states go to the setup, all inputs are returned.
fn motion(
    model: &dyn Model,
    setup: &mut Setup<'_>,
    assignments: &[Assignment],
) -> Result<GivenInputs, Failure> {
    /// Points from which it is sought.
    const STARTS: usize = 40;
    let base = Point {
        x: setup.initial.clone(),
        p: setup.parameters.clone(),
        ..Point::initial(model)
    };
    let mut problem = SteadyProblem::new(model, base).map_err(|error| refused(&error))?;
    for input in 0..setup.info.declared_inputs {
        let freed = problem.free(Term::Input(input));
        freed.map_err(|error| refused(&error))?;
    }
    for Assignment { name, value } in assignments {
        let term = term(setup, name)?;
        let value = value_of(setup, term, value, &format!("--at {name}"))?;
        problem.fix(term, value).map_err(|error| refused(&error))?;
    }
    let found = problem.solve_isolated(STARTS);
    let found = found.map_err(|error| refused(&error))?;
    // The nearest comes first.
    let point = found.into_iter().next().map(|motion| motion.point);
    let point = point.unwrap_or_else(|| problem.base().clone());
    setup.initial = point.x;
    // What is less than rounding of a newton is nothing.
    let clean = |u: f64| if u.abs() < f64::EPSILON { 0.0 } else { u };
    let inputs = point.u.into_iter().take(setup.info.declared_inputs);
    Ok(inputs.map(clean).enumerate().collect())
}

/// Names in a list, each once.
pub(crate) fn distinct(
    flag: &str,
    names: &[String],
    find: impl Fn(&str) -> Result<usize, Failure>,
) -> Result<Vec<usize>, Failure> {
    let mut found = Vec::new();
    for name in names {
        let place = find(name.trim())?;
        if found.contains(&place) {
            return Err(Failure::Usage(format!("{flag}: `{name}` is given twice")));
        }
        found.push(place);
    }
    Ok(found)
}

/// `-8,-2+3i,-2-3i`
pub(crate) fn poles(text: &str) -> Result<Vec<Complex<f64>>, Failure> {
    let pole = |text: &str| {
        complex(text.trim()).ok_or_else(|| {
            Failure::Usage(format!(
                "--poles: `{}` is not a pole; write numbers such as -8, or pairs such as -2+3i,-2-3i",
                text.trim()
            ))
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
    // The sign of the imaginary part, which is not that of an exponent.
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

/// `Q=1,10,R=0.1`
pub(crate) fn weights(text: &str) -> Result<Method, Failure> {
    let wrong = |what: &str| {
        Failure::Usage(format!(
            "--lqr: {what}; write Q=1,10,R=0.1, with a weight for each output in Q and for each \
             input in R, or a single one for all"
        ))
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

/// `--sampled-ms` and `--delay-ms`
pub(crate) fn sampling(
    period_ms: Option<f64>,
    delay_ms: Option<f64>,
) -> Result<Option<Sampling>, Failure> {
    let sampling = |period_ms: f64| Sampling::new(period_ms / 1e3, delay_ms.unwrap_or(0.0) / 1e3);
    let sampling = period_ms.map(sampling).transpose();
    sampling.map_err(|error| Failure::Usage(format!("--sampled-ms, --delay-ms: {error}")))
}

/// `FROM..TO` of `NAME=FROM..TO/STEPS`
fn ends<'a>(flag: &str, range: &'a Assignment) -> Result<[&'a str; 2], Failure> {
    let parts = range.value.split_once("..").and_then(|(from, rest)| {
        let (to, _) = rest.rsplit_once('/')?;
        Some([from, to])
    });
    parts.ok_or_else(|| no_range(flag, range))
}

/// `STEPS` of `NAME=FROM..TO/STEPS`
fn steps(flag: &str, range: &Assignment) -> Result<usize, Failure> {
    let steps = range
        .value
        .rsplit_once('/')
        .and_then(|(_, steps)| steps.trim().parse().ok());
    match steps.ok_or_else(|| no_range(flag, range))? {
        steps if (1..=MOST_STEPS).contains(&steps) => Ok(steps),
        steps => Err(Failure::Usage(format!(
            "{flag}: {steps} intervals; between 1 and {MOST_STEPS} are possible"
        ))),
    }
}

fn no_range(flag: &str, range: &Assignment) -> Failure {
    Failure::Usage(format!(
        "{flag}: `{}` is not a range; write {}=1..5/8 for eight intervals from 1 to 5",
        range.value, range.name
    ))
}

/// Values from end to end.
fn spread([from, to]: [f64; 2], steps: usize) -> Vec<f64> {
    let part = |step: usize| step as f64 / steps as f64;
    (0..=steps)
        .map(|step| from + (to - from) * part(step))
        .collect()
}

/// `NAME=FROM..TO/STEPS`: a state, and by how much it is off its value on the motion.
pub(crate) fn disturbances(setup: &Setup<'_>, text: &str) -> Result<(usize, Vec<f64>), Failure> {
    const FLAG: &str = "--attraction";
    let range = text.parse::<Assignment>();
    let range = range.map_err(|text| Failure::Usage(format!("{FLAG}: {text}")))?;
    let state = setup.state(&range.name)?;
    let unit = setup.unit_of_state(state);
    let label = format!("{FLAG} {}", range.name);
    let value = |text: &str| setup.value(text.trim(), unit, &label);
    let [from, to] = ends(FLAG, &range)?;
    let ends = [value(from)?, value(to)?];
    Ok((state, spread(ends, steps(FLAG, &range)?)))
}

/// What a schedule varies.
#[derive(Debug, Clone, Copy)]
enum Varied {
    State(usize),
    Input(usize),
    Parameter(usize),
}

/// Values of a schedule.
pub(crate) struct Values {
    varied: Varied,
    name: String,
    /// In SI.
    pub(crate) si: Vec<f64>,
}

/// `NAME=FROM..TO/STEPS`
pub(crate) fn values(setup: &mut Setup<'_>, schedule: &Assignment) -> Result<Values, Failure> {
    let [from, to] = ends("--schedule", schedule)?;
    let steps = steps("--schedule", schedule)?;
    let (name, info) = (&schedule.name, setup.info);
    let varied = if let Some(state) = info.state_index(name) {
        Varied::State(state)
    } else if let Some(input) = info.input_index(name).filter(|i| *i < info.declared_inputs) {
        Varied::Input(input)
    } else if let Some(parameter) = info.parameter_index(name) {
        Varied::Parameter(parameter)
    } else {
        let names = info
            .states
            .iter()
            .chain(info.inputs.iter())
            .chain(info.parameters.iter());
        let names = names.map(|quantity| quantity.name.as_ref());
        let text = unknown(name, "state, input or parameter", names);
        return Err(Failure::Usage(text));
    };
    let mut end = |text: &str| -> Result<f64, Failure> {
        let assignment = Assignment {
            name: name.clone(),
            value: text.trim().to_owned(),
        };
        match varied {
            Varied::State(state) => {
                setup.start_with("--schedule", &[assignment])?;
                Ok(setup.initial[state])
            }
            Varied::Input(_) => Ok(setup.input_value("--schedule", &assignment)?.1),
            Varied::Parameter(parameter) => {
                setup.set(&[assignment])?;
                Ok(setup.parameters[parameter])
            }
        }
    };
    let (from, to) = (end(from)?, end(to)?);
    Ok(Values {
        varied,
        name: name.clone(),
        si: spread([from, to], steps),
    })
}

impl Values {
    /// The quantity, where a law can read it: not an input.
    pub(crate) fn readable<'q>(&self, setup: &'q Setup<'_>) -> Option<&'q Quantity> {
        match self.varied {
            Varied::State(state) => setup.info.states.get(state),
            Varied::Parameter(parameter) => setup.info.parameters.get(parameter),
            Varied::Input(_) => None,
        }
    }

    /// Puts a value in its place.
    pub(crate) fn place(&self, setup: &mut Setup<'_>, inputs: &mut GivenInputs, value: f64) {
        match self.varied {
            Varied::State(state) => setup.initial[state] = value,
            Varied::Parameter(parameter) => setup.parameters[parameter] = value,
            Varied::Input(input) => {
                inputs.retain(|(other, _)| *other != input);
                inputs.push((input, value));
            }
        }
    }

    /// A failure with the value at which it happened.
    pub(crate) fn at(&self, setup: &Setup<'_>, value: f64, failure: &Failure) -> Failure {
        let info = setup.info;
        let quantity = match self.varied {
            Varied::State(state) => &info.states[state],
            Varied::Input(input) => &info.inputs[input],
            Varied::Parameter(parameter) => &info.parameters[parameter],
        };
        let [shown, unit] = [
            quantity.to_unit(value).to_string(),
            quantity.unit.to_string(),
        ];
        let text = format!("at {} = {shown} {unit}: {failure}", self.name);
        if failure.status() == 4 {
            Failure::Computation(text)
        } else {
            Failure::Usage(text)
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
