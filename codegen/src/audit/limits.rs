//! Parameter limits with which the rates have an explicit formula instead of a pivoted solve.

use appell_spec::Code;
use appell_spec::mechanism::{CoordinateId, Mechanism, Parameter, ParameterId};

use super::bench::{Audit, Bench, Limits};
use super::determination::divisors;
use crate::mechanics::finding::{Finding, Item, listed};

/// Ratios of the limits to the values, the widest first.
const FACTORS: [f64; 4] = [2.0, 1.5, 1.2, 1.1];

/// The widest limits of the parameters in divisors that make all pivoted solves unnecessary.
pub(super) fn limits(bench: &mut Bench) -> Option<Limits> {
    let derivation = bench.derivation;
    let positions = &derivation.positions.names;
    if derivation.velocities.solved_numerically.is_empty() || !positions.is_empty() {
        return None;
    }
    let divisors = divisors(bench);
    let graph = &bench.algebra.graph;
    let matrix = &derivation.dependent.system.matrix;
    let occurs = |&(id, parameter): &(ParameterId, &Parameter)| {
        let symbol = graph.as_symbol(derivation.symbols.parameters[id.index()]);
        let in_matrix = symbol.is_some_and(|s| matrix.iter().any(|&e| graph.mentions(e, &[s])));
        in_matrix && parameter.value != 0.0
    };
    let parameters: Vec<_> = bench
        .mechanism
        .parameters
        .entries()
        .filter(occurs)
        .collect();
    FACTORS.into_iter().find_map(|factor| {
        let mut limited = bench.mechanism.clone();
        let mut written = Vec::new();
        for &(id, parameter) in &parameters {
            let ends = missing(parameter, factor);
            let limited = &mut limited.parameters[id];
            let scale = parameter.label.unit.scale;
            limited.at_least = limited.at_least.or(ends[0].map(|end| end * scale));
            limited.at_most = limited.at_most.or(ends[1].map(|end| end * scale));
            written.push((id, ends));
        }
        written.retain(|(_, ends)| ends.iter().any(Option::is_some));
        let holds = bench.pivoted(&limited).is_some_and(|open| open.is_empty());
        (holds && !written.is_empty()).then(|| Limits {
            divisors: divisors.clone(),
            parameters: written,
        })
    })
}

/// The missing limits of a parameter, in its unit, rounded towards its value.
fn missing(parameter: &Parameter, factor: f64) -> [Option<f64>; 2] {
    let value = parameter.value / parameter.label.unit.scale;
    let ends = [value / factor, value * factor];
    let [least, most] = if value < 0.0 {
        [ends[1], ends[0]]
    } else {
        ends
    };
    let (bounded_below, bounded_above) =
        (parameter.at_least.is_some(), parameter.at_most.is_some());
    [
        (!bounded_below).then(|| two_digits(least, f64::ceil)),
        (!bounded_above).then(|| two_digits(most, f64::floor)),
    ]
}

fn two_digits(value: f64, round: impl Fn(f64) -> f64) -> f64 {
    let power = 10.0_f64.powf(1.0 - value.abs().log10().floor());
    round(value * power) / power
}

/// One note that lists the divisors, and the limits that keep them nonzero.
pub(super) fn audit(bench: &mut Bench, told: &mut Audit) {
    let Some(limits) = &bench.limits else {
        return;
    };
    let mechanism = bench.mechanism;
    let names = |q: &usize| &*mechanism.coordinates[CoordinateId::new(*q)].label.name;
    let solved = &bench.derivation.velocities.solved_numerically;
    let rates = listed(solved.iter().map(names));
    let divisors = limits.divisors.iter();
    let divisors: Vec<String> = divisors.filter_map(|&d| bench.readable(d)).collect();
    let because = if divisors.is_empty() {
        String::new()
    } else {
        let divisors = listed(divisors.iter().map(String::as_str));
        format!(", as their divisor {divisors} may vanish")
    };
    let Some(&(first, _)) = limits.parameters.first() else {
        return;
    };
    told.notes.push(Finding {
        code: Code::SingularPseudoVelocities,
        message: format!("the rates of {rates} are solved with pivoting{because}"),
        item: Item::Parameter(first),
        help: format!(
            "write {}: they keep the divisor off zero in the declared ranges, and formulas then give the rates",
            limits.written(mechanism)
        ),
    });
}

impl Limits {
    /// The limits in the syntax of a spec.
    fn written(&self, mechanism: &Mechanism) -> String {
        let of = |(id, ends): &(ParameterId, [Option<f64>; 2])| {
            let keys = ["at_least", "at_most"].into_iter().zip(ends);
            let keys = keys.filter_map(|(key, end)| Some(format!("{key} = {}", (*end)?)));
            let keys: Vec<String> = keys.collect();
            format!(
                "`{}` for `{}`",
                keys.join(", "),
                mechanism.parameters[*id].label.name
            )
        };
        let all: Vec<String> = self.parameters.iter().map(of).collect();
        all.join(" and ")
    }
}
