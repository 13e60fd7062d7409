//! Comparison of equations of motion entered by the user with the derived ones.

use std::fmt;

use appell_codegen::formulations::compare_typed;
use appell_codegen::symbolic::Expr;
use appell_spec::Scope;
use appell_spec::mechanism::Mechanism;
use appell_spec::units::Unit;
use serde_json::{Value, json};

pub use appell_codegen::formulations::Agreement;

use crate::conditions::{lowered, per_second};
use crate::setup::{Assignment, expression, unknown};
use crate::source::Source;
use crate::{Error, Field};

/// Typed equations, compared.
#[derive(Debug, Clone)]
pub struct Compared {
    /// The states whose rates were typed, each with the result.
    pub equations: Vec<(String, Agreement)>,
    /// Bound on the probability that any equation was taken for identical though it is not.
    pub error_bound: f64,
}

impl Source {
    /// Compares typed equations of motion with the derived ones. The name of an assignment is that of a
    /// pseudo-velocity or coordinate, as in `theta` or `dot(theta)`; its value is the rate as an expression in
    /// time, states, inputs and parameters.
    ///
    /// Equality is proved by the identity test, exact arithmetic at random points of a finite field, where that
    /// applies, and checked at random points in the declared ranges elsewhere.
    ///
    /// ```
    /// use appell::Source;
    /// use appell::comparison::Agreement;
    ///
    /// let pendulum = Source::shipped("pendulum")?;
    /// let typed = "dot(omega) = (tau - m*g*l*sin(theta))/(I + m*l^2)".parse().unwrap();
    /// let compared = pendulum.compare(&[typed])?;
    /// assert_eq!(compared.equations[0].1, Agreement::Identical);
    /// # Ok::<(), appell::Error>(())
    /// ```
    pub fn compare(&self, equations: &[Assignment]) -> Result<Compared, Error> {
        let (mechanism, mut derivation) = self.derived()?;
        let mut typed: Vec<(usize, Expr)> = Vec::with_capacity(equations.len());
        let mut names = Vec::with_capacity(equations.len());
        for Assignment { name, value } in equations {
            let (state, name, unit) = rate(&mechanism, name)?;
            let (spec, scope) = (&self.text, Scope::Equation);
            let expr = expression(spec, Field::Equation, name, value, scope, &unit)?;
            let lowered = lowered(&mut derivation, &expr).ok_or_else(|| {
                let message = format!("{name}: `{value}` divides by zero");
                Error::request(Field::Equation, message)
            })?;
            typed.push((state, lowered));
            names.push(name.to_owned());
        }
        let compared = compare_typed(&mechanism, &derivation, &typed);
        Ok(Compared {
            equations: names.into_iter().zip(compared.agreements).collect(),
            error_bound: compared.error_bound,
        })
    }
}

/// Index and name of a state, and the unit of its rate.
fn rate<'m>(mechanism: &'m Mechanism, written: &str) -> Result<(usize, &'m str, Unit), Error> {
    let inner = written
        .strip_prefix("dot(")
        .and_then(|rest| rest.strip_suffix(')'));
    let name = inner.unwrap_or(written).trim();
    let speeds = mechanism.pseudo_velocities.iter().map(|w| &w.label);
    let coordinates = mechanism.coordinates.iter().map(|q| &q.label);
    let mut states = speeds.chain(coordinates).enumerate();
    let names = states.clone().map(|(_, label)| label.name.as_str());
    match states.find(|(_, label)| label.name == name) {
        Some((state, label)) => Ok((state, &label.name, per_second(&label.unit))),
        None => Err(Error::request(
            Field::Equation,
            unknown(name, "state", names),
        )),
    }
}

impl Compared {
    /// Whether all equations agree with the derived ones.
    pub fn agrees(&self) -> bool {
        let mut all = self.equations.iter();
        all.all(|(_, agreement)| word(agreement).0)
    }

    /// The error of a comparison in which something does not agree.
    pub fn failure(&self) -> Option<Error> {
        (!self.agrees())
            .then(|| Error::computation("a typed equation is not the derived one".to_owned()))
    }

    /// The results as JSON.
    pub fn json(&self) -> Value {
        let equation = |(name, agreement): &(String, Agreement)| {
            let (agrees, result) = word(agreement);
            let mut entry = json!({ "rate": name, "agrees": agrees, "result": result });
            if let Agreement::Different { values, .. } = agreement {
                entry["values"] = json!(values);
            }
            entry
        };
        let equations: Vec<Value> = self.equations.iter().map(equation).collect();
        json!({ "agrees": self.agrees(), "equations": equations, "error_bound": self.error_bound })
    }
}

/// Whether the two agree, and the word for it.
pub fn word(agreement: &Agreement) -> (bool, &'static str) {
    match agreement {
        Agreement::Identical => (true, "identical"),
        Agreement::AtPoints { .. } => (true, "equal"),
        Agreement::Different { .. } => (false, "different"),
        Agreement::Undefined | Agreement::NotReached => (false, "undefined"),
    }
}

/// One line per equation.
impl fmt::Display for Compared {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(f, "  typed equations")?;
        for (name, agreement) in &self.equations {
            let name = format!("dot({name})");
            match agreement {
                Agreement::Identical => writeln!(f, "    {name:<18}identical")?,
                Agreement::AtPoints { points, deviation } => writeln!(
                    f,
                    "    {name:<18}equal at {points} random points, deviation {deviation:.0e}"
                )?,
                Agreement::Different {
                    values: [derived, typed],
                    ..
                } => writeln!(
                    f,
                    "    {name:<18}DIFFERENT: at a random point the derived one is {derived:.6e}, the typed one {typed:.6e}"
                )?,
                Agreement::Undefined | Agreement::NotReached => {
                    writeln!(f, "    {name:<18}no value at any random point")?;
                }
            }
        }
        Ok(())
    }
}
