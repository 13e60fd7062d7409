//! The statistics of an ensemble.

use appell_ensemble::rows::{Column, Role};
use appell_ensemble::statistics::order::Quantile;
use appell_ensemble::statistics::sensitivity::Index;
use appell_ensemble::summary::{Number, PARTS, Summary};
use serde_json::{Value, json};

use super::object;

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
