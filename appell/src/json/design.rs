//! Control designs.

use appell_analysis::control::controllability::Controllability;
use appell_analysis::control::sampled::Sampling;
use appell_runtime::model::{ModelInfo, Quantity};
use nalgebra::Complex;
use serde_json::{Value, json};

use super::{named, object, rows};
use crate::control::Schedule;
use crate::control::design::{Design, DesignedGains};

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
