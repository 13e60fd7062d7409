//! Results as JSON, in SI.

use appell_analysis::control::controllability::Controllability;
use appell_analysis::control::sampled::Sampling;
use appell_ensemble::rows::{Column, Role};
use appell_ensemble::statistics::order::Quantile;
use appell_ensemble::statistics::sensitivity::Index;
use appell_ensemble::summary::{Number, PARTS, Summary};
use appell_gap::{identify, inverse};
use appell_recordings::DataSet;
use appell_report::recording::{part, role, severity};
use appell_robots::Imported;
use appell_runtime::Trajectory;
use appell_runtime::model::{ModelInfo, Quantity};
use appell_runtime::simulate::{Breach, Limit};
use nalgebra::{Complex, DMatrix};
use serde_json::{Value, json};

use crate::check::findings;
use crate::control::Schedule;
use crate::control::design::{Design, DesignedGains};

pub use crate::gap_report::json as diagnosis;
pub use crate::steady::chart::json as chart;
pub use crate::steady::export::json as steady;

/// A result about a data set, with numbers of a robot under the names of its file.
pub fn in_names_of(set: &DataSet, value: Value) -> Value {
    match value {
        Value::String(text) => set.named(&text).into(),
        Value::Array(values) => values
            .into_iter()
            .map(|value| in_names_of(set, value))
            .collect(),
        Value::Object(fields) => {
            let fields = fields.into_iter();
            object(fields.map(|(key, value)| (key, in_names_of(set, value))))
        }
        other => other,
    }
}

/// Fields by their keys.
pub(crate) fn object<K: ToString>(fields: impl IntoIterator<Item = (K, Value)>) -> Value {
    let fields = fields.into_iter();
    Value::Object(
        fields
            .map(|(key, value)| (key.to_string(), value))
            .collect(),
    )
}

/// Values by the names of their quantities.
pub(crate) fn named(quantities: &[Quantity], values: &[f64]) -> Value {
    let pairs = quantities.iter().zip(values);
    object(pairs.map(|(quantity, &value)| (&quantity.name, json!(value))))
}

/// The rows of a matrix.
pub(crate) fn rows(matrix: &DMatrix<f64>) -> Value {
    let rows = matrix.row_iter();
    rows.map(|row| row.iter().copied().collect::<Value>())
        .collect()
}

/// The names of quantities.
pub fn names(quantities: &[Quantity]) -> Vec<&str> {
    let names = quantities.iter().map(|quantity| quantity.name.as_ref());
    names.collect()
}

/// The summary of a motion; `failure` is the reason of an early end.
pub fn motion(trajectory: &Trajectory, failure: Option<&str>) -> Value {
    let info = trajectory.info();
    let last = trajectory.len().saturating_sub(1);
    let row = |row: usize| {
        if trajectory.is_empty() {
            &[][..]
        } else {
            trajectory.row(row)
        }
    };
    let states = info.state_len();
    let all = trajectory.columns();
    let extrema = all.iter().enumerate().map(|(column, quantity)| {
        let [min, max] = extrema(trajectory, column);
        let max_abs = max.abs().max(min.abs());
        let told = json!({ "min": min, "max": max, "max_abs": max_abs });
        (&quantity.name, told)
    });
    json!({
        "schema": "simulated/1",
        "mechanism": info.name,
        "parameters": named(&info.parameters, trajectory.parameters()),
        "t_end_s": trajectory.times().last(),
        "rows": trajectory.len(),
        "failure": failure,
        "events": breaches(trajectory),
        "initial_state": named(&all[..states], row(0)),
        "final_state": named(&all[..states], row(last)),
        "final_values": named(&all[states..], row(last).get(states..).unwrap_or_default()),
        "extrema": object(extrema),
        "statistics": {
            "steps": trajectory.statistics.steps,
            "rejected": trajectory.statistics.rejected,
            "evaluations": trajectory.statistics.evaluations,
        },
    })
}

/// Smallest and largest value of a recorded column, in SI.
pub fn extrema(trajectory: &Trajectory, column: usize) -> [f64; 2] {
    let values = (0..trajectory.len()).map(|row| trajectory.row(row)[column]);
    values.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], value| {
        [low.min(value), high.max(value)]
    })
}

/// Where the motion leaves the range of validity of its model.
fn breaches(trajectory: &Trajectory) -> Value {
    let info = trajectory.info();
    let contact = |index: usize| {
        info.contacts
            .get(index)
            .map(|contact| contact.name.as_ref())
    };
    let breach = |breach: &Breach| {
        let (kind, place) = match breach.limit {
            Limit::Range { state } => {
                let name = info.states.get(state).map(|state| state.name.as_ref());
                ("out_of_range", json!({ "state": name }))
            }
            Limit::Contact { contact: index } => {
                ("contact_lost", json!({ "contact": contact(index) }))
            }
            Limit::Friction { contact: index } => ("slip", json!({ "contact": contact(index) })),
            Limit::Condition { of } => {
                let name = trajectory.conditions().get(of);
                ("ill_conditioned", json!({ "of": name }))
            }
        };
        json!({
            "t_s": breach.t,
            "kind": kind,
            "where": place,
            "value": breach.value,
            "state": named(&info.states, &breach.state),
        })
    };
    trajectory.breaches.iter().map(breach).collect()
}

/// Controllability about a steady motion, and the gains.
pub fn design(info: &ModelInfo, design: &Design) -> Value {
    let states = chosen(&info.states, &design.equations.states);
    let outputs = chosen(&info.states, &design.outputs);
    let substituted = design.subsystem.substituted.iter();
    let substituted = substituted.map(|(state, factors)| {
        let factors = outputs.iter().zip(factors.iter().map(|f| json!(f)));
        (&states[*state], object(factors))
    });
    json!({
        "schema": "control/1",
        "mechanism": info.name,
        "parameters": named(&info.parameters, &design.p),
        "state": named(&info.states, &design.x),
        "inputs": named(&info.inputs, &design.u),
        "state_order": states,
        "input_order": chosen(&info.inputs, &design.equations.inputs),
        "A": rows(&design.equations.system.a),
        "B": rows(&design.equations.system.b),
        "varying": design.equations.varying.iter().map(|&v| &states[v]).collect::<Vec<_>>(),
        "controllability": reach_json(&design.controllability),
        "outputs": {
            "order": outputs,
            "A": rows(&design.subsystem.system.a),
            "B": rows(&design.subsystem.system.b),
            "substituted": object(substituted),
        },
        "law": design.law.as_ref().map(law_json),
    })
}

/// The designs of a schedule.
pub fn schedule(info: &ModelInfo, schedule: &Schedule) -> Value {
    let designs = schedule.designs.iter();
    let designs = designs
        .map(|(value, design)| json!({ "value": value, "design": self::design(info, design) }));
    json!({ "schema": "control-schedule/1", "over": schedule.over.name, "designs": designs.collect::<Vec<_>>() })
}

fn reach_json(controllability: &Controllability) -> Value {
    let modes = controllability.modes.iter().map(|mode| {
        json!({
            "value": complex(&mode.value),
            "multiplicity": mode.multiplicity,
            "distance": mode.distance,
            "lost": mode.lost,
        })
    });
    json!({
        "rank": controllability.rank,
        "singular_values": controllability.singular_values,
        "lost": controllability.lost.iter().map(complex).collect::<Vec<_>>(),
        "untouched": rows(&controllability.untouched),
        "modes": modes.collect::<Vec<_>>(),
        "stabilisable": controllability.kept().next().is_none(),
    })
}

fn law_json(law: &DesignedGains) -> Value {
    json!({
        "gains": rows(&law.gain),
        "poles": law.poles.iter().map(complex).collect::<Vec<_>>(),
        "stable": law.growing() == 0,
        "sampled_s": law.sampling.map(Sampling::period),
        "delay_s": law.sampling.map(Sampling::delay),
        "residual": law.residual,
        "condition": law.condition,
    })
}

fn complex(value: &Complex<f64>) -> Value {
    json!([value.re, value.im])
}

fn chosen(quantities: &[Quantity], places: &[usize]) -> Vec<String> {
    let names = places.iter().map(|&place| &quantities[place].name);
    names.map(ToString::to_string).collect()
}

/// Runs, channels, noise, parameters and findings of a data set.
pub fn recording(set: &DataSet) -> Value {
    let runs = set.runs.iter().map(|run| {
        let differences = run.differences.iter();
        let differences = differences.map(|own| json!({ "name": own.parameter, "by": own.by }));
        json!({
            "run": run.name, "part": part(run), "rows": run.times.len(),
            "from_s": run.times.first(), "to_s": run.times.last(),
            "step_s": run.sampling.step, "shortest_step_s": run.sampling.shortest,
            "longest_step_s": run.sampling.longest, "gaps_s": run.sampling.gaps,
            "differences": differences.collect::<Vec<_>>(),
        })
    });
    let channels = set.channels.iter().map(|channel| {
        let label = channel.role.label(&set.mechanism);
        let noise = channel.noise;
        json!({
            "channel": channel.column, "role": role(channel.role),
            "quantity": label.map(|label| &label.name), "unit": channel.unit.text,
            "noise_std": noise.map(|noise| noise.std),
            "noise_from": noise.map(|noise| noise.source.word()),
            "noise_stated": channel.stated_noise,
            "noise_found": noise.and_then(|noise| noise.found),
            "quantum": noise.and_then(|noise| noise.quantum),
        })
    });
    let own = set.mechanism.parameters.iter();
    let parameters = own.zip(&set.parameters).map(|(own, parameter)| {
        json!({
            "name": own.label.name, "value": parameter.value, "std": parameter.std,
        })
    });
    let findings = set.findings.iter().map(|finding| {
        json!({
            "kind": finding.kind.word(), "severity": severity(finding), "run": finding.run,
            "line": finding.line, "channel": finding.channel, "message": finding.message,
        })
    });
    json!({
        "schema": "recording/1",
        "mechanism": set.mechanism.name,
        "description": set.description,
        "runs": runs.collect::<Vec<_>>(),
        "channels": channels.collect::<Vec<_>>(),
        "parameters": parameters.collect::<Vec<_>>(),
        "findings": findings.collect::<Vec<_>>(),
    })
}

/// The result of an identification.
pub fn identification(set: &DataSet, answer: &identify::Answer) -> Value {
    let parameters = answer.parameters.iter().map(|estimate| {
        json!({
            "name": estimate.quantity.name, "unit": estimate.quantity.unit,
            "nominal": estimate.nominal, "tolerance": estimate.tolerance,
            "value": estimate.value, "std": estimate.std, "robust_std": estimate.robust_std,
            "interval95": estimate.interval95(), "at_limit": estimate.at_limit,
        })
    });
    let whiteness = answer.whiteness.iter().map(|(column, consistency)| {
        json!({
            "channel": column, "count": consistency.count,
            "normalised_square": consistency.squares / consistency.count as f64,
            "band99": consistency.band.map(|end| end / consistency.count as f64),
            "correlation": consistency.correlation,
            "correlation_band99": consistency.correlation_band,
        })
    });
    let courses = answer.courses.iter().map(|course| {
        json!({
            "parameter": course.quantity.name, "run": course.run, "t_s": course.times,
            "value": course.values, "std": course.deviations,
        })
    });
    let held_out = answer.held_out.iter().map(|error| {
        let horizon = error.horizon.is_finite().then_some(error.horizon);
        json!({
            "horizon_s": horizon, "free_run": horizon.is_none(), "channel": error.column,
            "nominal": error.nominal, "fitted": error.fitted,
        })
    });
    let repeatability = answer.repeatability.iter().map(|one| {
        let runs = one
            .runs
            .iter()
            .map(|(run, [value, std])| json!({ "run": run, "value": value, "std": std }));
        json!({
            "name": one.name, "spread": one.spread, "p_value": one.p_value, "differs": one.differs,
            "runs": runs.collect::<Vec<_>>(),
        })
    });
    json!({
        "schema": "identified/1",
        "mechanism": set.mechanism.name,
        "is_optimum": answer.is_optimum,
        "parameters": parameters.collect::<Vec<_>>(),
        "correlation": rows(&answer.correlation),
        "combinations": answer.combinations,
        "noise": answer.noise,
        "disturbances": answer.disturbances,
        "innovations": whiteness.collect::<Vec<_>>(),
        "log_likelihood": { "nominal": answer.log_likelihoods[0], "fitted": answer.log_likelihoods[1] },
        "repeatability": repeatability.collect::<Vec<_>>(),
        "drifting": courses.collect::<Vec<_>>(),
        "held_out": held_out.collect::<Vec<_>>(),
    })
}

/// Input-free relations, estimated parameters and the inputs of recorded motions.
pub fn inverse(info: &ModelInfo, answer: &inverse::Answer) -> Value {
    let end = |end: f64| end.is_finite().then_some(end);
    let estimates = answer.estimates.iter().map(|estimate| {
        json!({
            "name": estimate.quantity.name, "unit": estimate.quantity.unit,
            "bias": estimate.is_bias, "nominal": estimate.nominal, "value": estimate.value,
            "std": estimate.std, "robust_std": estimate.robust_std,
            "interval95": estimate.interval95.map(end), "told": estimate.is_bounded(),
            "profile": estimate.profile,
        })
    });
    let names = names(&info.inputs);
    let inputs = |run: &inverse::Inputs| {
        json!({
            "run": run.run, "inputs": &names[..info.declared_inputs], "t": run.times,
            "values": run.values, "stds": run.stds,
        })
    };
    let noise = answer.noise.iter();
    let noise = noise.map(|(column, std)| json!({ "column": column, "std": std }));
    json!({
        "schema": "inverse/1",
        "mechanism": info.name,
        "relations": answer.relations,
        "normalised_square": answer.normalised_square,
        "spacing_s": answer.spacing,
        "estimates": estimates.collect::<Vec<_>>(),
        "noise": noise.collect::<Vec<_>>(),
        "noise_correlation": rows(&answer.correlation),
        "runs": answer.inputs.iter().map(inputs).collect::<Vec<_>>(),
    })
}

/// The result of importing a robot file, as JSON.
pub fn robot(file: &str, robot: &Imported) -> Value {
    let left_out = robot.left_out.iter();
    let left_out = left_out
        .map(|one| json!({ "what": one.what, "file": one.file, "lines": one.lines, "effect": one.effect }))
        .collect::<Vec<_>>();
    let warnings = robot.warnings.iter();
    let warnings = warnings
        .map(|report| json!({ "file": report.file(), "findings": findings(report) }))
        .collect::<Vec<_>>();
    json!({
        "file": file, "ok": true, "name": robot.name, "format": robot.format.word(), "bodies": robot.bodies,
        "joints": robot.joints, "nearly_right_angles": robot.nearly_right, "warnings": warnings, "left_out": left_out,
    })
}

/// Statistics in SI; `columns` are those of the rows.
pub fn ensemble(columns: &[Column], summary: &Summary) -> Value {
    let name = |column: usize| columns[column].name.as_str();
    let of = |is: fn(&Role) -> bool| {
        let numbers = summary.numbers.iter();
        let own = numbers.filter(|number| is(&columns[number.column].role));
        object(own.map(|n| (name(n.column), number(n))))
    };
    let events = summary.events.iter().map(|event| {
        let told = json!({
            "cases": event.happened,
            "of": event.of,
            "probability": event.happened as f64 / event.of as f64,
            "wilson_95": event.wilson,
            "exact_95": event.exact,
        });
        (name(event.column), told)
    });
    let courses = summary.courses.iter().map(|course| {
        let told = json!({
            "t_s": course.times,
            "mean": course.mean,
            "quantiles": PARTS,
            "bands": course.bands,
        });
        (&course.name, told)
    });
    let effects = summary.effects.iter().map(|effect| {
        let index = |index: Index| json!({ "value": index.value, "interval_95": index.interval });
        let own = effect.ends.iter().enumerate().map(|(factor, ends)| {
            let mut told = json!({ "quarters": ends });
            if let Some(indices) = effect.indices.as_ref().and_then(|all| all.get(factor)) {
                told["first"] = index(indices.first);
                told["total"] = index(indices.total);
            }
            (name(factor), told)
        });
        (name(effect.column), object(own))
    });
    let early: Vec<Value> = summary
        .early
        .iter()
        .map(|(reason, cases)| json!({ "reason": reason, "cases": cases }))
        .collect();
    json!({
        "schema": "ensemble/1",
        "cases": summary.cases,
        "done": summary.done,
        "sampling": summary.sampling.word(),
        "ended_early": early,
        "factors": of(|role| matches!(role, Role::Factor(_))),
        "kept": of(|role| matches!(role, Role::Value | Role::When)),
        "events": object(events),
        "courses": object(courses),
        "effects": object(effects),
        "rare": summary.rare.as_ref().map(|(event, found)| json!({
            "event": event,
            "probability": found.value,
            "interval_95": found.interval,
            "motions": found.evaluations,
        })),
    })
}

fn number(number: &Number) -> Value {
    let moments = &number.moments;
    let has_any = moments.count > 0;
    let quantile =
        |q: &Quantile| json!({ "part": q.part, "value": q.value, "interval_95": q.interval });
    json!({
        "count": moments.count,
        "missing": moments.missing,
        "mean": has_any.then_some(moments.mean),
        "mean_interval_95": moments.interval(),
        "deviation": Some(moments.deviation()).filter(|d| d.is_finite()),
        "min": has_any.then_some(moments.min),
        "max": has_any.then_some(moments.max),
        "quantiles": number.quantiles.iter().map(quantile).collect::<Vec<_>>(),
    })
}
