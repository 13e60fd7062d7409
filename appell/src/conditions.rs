//! Conditions of the steady motion about which equations are linearised.

use appell_codegen::mechanics::Derivation;
use appell_codegen::symbolic::Expr;
use appell_spec::Scope;
use appell_spec::expr::Expr as SpecExpr;
use appell_spec::mechanism::Mechanism;
use appell_spec::units::{self, Unit};

use crate::setup::{Assignment, bracketed, expression, listed, unknown};
use crate::{Error, Field};

/// Symbols with their values, from texts such as `theta=0, dot(psi)=0`.
pub(crate) fn conditions(
    spec: &str,
    mechanism: &Mechanism,
    derivation: &mut Derivation,
    texts: &[String],
) -> Result<Vec<(Expr, Expr)>, Error> {
    let mut conditions = Vec::new();
    for text in texts.iter().flat_map(|text| listed(text)) {
        let Assignment { name, value } = text
            .parse()
            .map_err(|help| Error::request(Field::About, format!("{text}: {help}")))?;
        let (symbol, unit) = quantity(mechanism, derivation, &name)?;
        let expr = expression(spec, Field::About, &name, &value, Scope::Motion, &unit)?;
        let lowered = lowered(derivation, &expr).ok_or_else(|| {
            let message = format!("{name}: `{}` divides by zero", bracketed(&value));
            Error::request(Field::About, message)
        })?;
        conditions.push((symbol, lowered));
    }
    Ok(conditions)
}

/// An expression in the graph of a derivation; `None` if it divides by zero.
pub(crate) fn lowered(derivation: &mut Derivation, expr: &SpecExpr) -> Option<Expr> {
    let graph = &mut derivation.algebra.graph;
    derivation.symbols.lower(graph, expr).ok()
}

/// Symbol and unit of a state, an input, or a rate: `psi_dot` or `dot(psi)`.
fn quantity(
    mechanism: &Mechanism,
    derivation: &Derivation,
    name: &str,
) -> Result<(Expr, Unit), Error> {
    let symbols = &derivation.symbols;
    let speeds = mechanism.pseudo_velocities.iter().map(|w| &w.label);
    let coordinates = || mechanism.coordinates.iter().map(|q| &q.label);
    let inputs = mechanism.inputs.iter().map(|u| &u.label);
    let named = speeds.zip(&symbols.speeds);
    let named = named.chain(coordinates().zip(&symbols.coordinates));
    let named = named.chain(inputs.zip(&symbols.inputs));
    if let Some((label, &symbol)) = named.clone().find(|(label, _)| label.name == name) {
        return Ok((symbol, label.unit.clone()));
    }
    let inner = name.strip_prefix("dot(").and_then(|n| n.strip_suffix(')'));
    let inner = inner.or_else(|| name.strip_suffix("_dot")).map(str::trim);
    let rate = coordinates()
        .zip(&symbols.rates)
        .find(|(label, _)| Some(label.name.as_str()) == inner);
    if let Some((label, &symbol)) = rate {
        return Ok((symbol, per_second(&label.unit)));
    }
    let rates: Vec<String> = coordinates()
        .map(|label| format!("dot({})", label.name))
        .collect();
    let known: Vec<&str> = named
        .map(|(label, _)| label.name.as_str())
        .chain(rates.iter().map(String::as_str))
        .collect();
    let message = unknown(name, "state, rate or input", known.into_iter());
    Err(Error::request(Field::About, message))
}

/// The unit of a rate: that of its coordinate per second.
pub(crate) fn per_second(unit: &Unit) -> Unit {
    let written = format!("({})/s", unit.text);
    units::parse(&written).unwrap_or_else(|_| unit.clone())
}
