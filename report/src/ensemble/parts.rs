//! Tables and sentences of a study.

use appell_ensemble::design::Sampling;
use appell_ensemble::rows::{Column, Role};
use appell_ensemble::statistics::moments::Moments;
use appell_ensemble::statistics::sensitivity::Index;
use appell_ensemble::summary::{Effects, Event, Number};

use super::about::About;
use crate::text::short;

/// A table.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Part {
    /// Its heading.
    pub heading: &'static str,
    /// Its rows, the first one with the column headings.
    pub rows: Vec<Vec<String>>,
    /// Notes below the table.
    pub notes: Vec<String>,
}

/// Name and unit of a column.
pub(super) fn labelled(column: &Column) -> String {
    match column.unit.as_str() {
        "" | "1" => column.name.clone(),
        unit => format!("{} [{unit}]", column.name),
    }
}

/// How many cases there are, and how they ended.
pub fn sentences(about: &About<'_>) -> Vec<String> {
    let summary = about.summary;
    let how = match summary.sampling {
        Sampling::Random => "random",
        Sampling::Latin => "Latin hypercube",
        Sampling::Sobol => "Sobol points",
        Sampling::Sensitivity => "Sobol points for sensitivity indices",
    };
    let mut told = vec![if summary.done < summary.cases {
        format!("{} of {} cases so far ({how})", summary.done, summary.cases)
    } else {
        format!("{} cases ({how})", summary.cases)
    }];
    let early: u64 = summary.early.iter().map(|(_, count)| count).sum();
    if early > 0 {
        let reasons = summary
            .early
            .iter()
            .map(|(reason, count)| format!("{reason} ({count})"));
        told.push(format!(
            "{early} ended early: {}",
            reasons.collect::<Vec<_>>().join("; ")
        ));
    }
    told
}

/// The tables, those with rows.
pub fn parts(about: &About<'_>) -> Vec<Part> {
    let mut parts = vec![factors(about), numbers(about), events(about)];
    parts.extend(sensitivity(about));
    parts.retain(|part| part.rows.len() > 1);
    parts
}

fn heads(words: &[&str]) -> Vec<String> {
    words.iter().map(ToString::to_string).collect()
}

fn interval(ends: [f64; 2]) -> String {
    format!("{} … {}", short(ends[0]), short(ends[1]))
}

fn row(column: &Column, number: &Number) -> Vec<String> {
    let shown = |si: f64| short(column.to_unit(si));
    let quantile = |place: usize| number.quantiles.get(place).map(|q| q.value);
    let at = |place: usize| quantile(place).map_or_else(String::new, shown);
    let of_some = |known: bool, si: f64| {
        if known { shown(si) } else { String::new() }
    };
    let Moments { count, mean, .. } = number.moments;
    vec![
        labelled(column),
        of_some(count > 0, mean),
        of_some(count > 1, number.moments.deviation()),
        at(0),
        at(2),
        at(4),
    ]
}

fn factors(about: &About<'_>) -> Part {
    let heading = "Factors";
    let mut rows = vec![heads(&["", "mean", "deviation", "5 %", "median", "95 %"])];
    let mut notes = Vec::new();
    for number in &about.summary.numbers {
        let column = &about.columns[number.column];
        match &column.role {
            Role::Factor(items) if items.is_empty() => rows.push(row(column, number)),
            Role::Factor(items) => {
                notes.push(format!("{}: one of {}", column.name, items.join(", ")));
            }
            _ => {}
        }
    }
    if rows.len() == 1 && !notes.is_empty() {
        rows.push(vec!["files".to_owned()]);
    }
    Part {
        heading,
        rows,
        notes,
    }
}

fn numbers(about: &About<'_>) -> Part {
    let mut rows = vec![heads(&[
        "",
        "mean",
        "deviation",
        "5 %",
        "median",
        "95 %",
        "mean ±",
        "missing",
    ])];
    for number in &about.summary.numbers {
        let column = &about.columns[number.column];
        let Moments { count, missing, .. } = number.moments;
        if column.role != Role::Value || count + missing == 0 {
            continue;
        }
        let mut row = row(column, number);
        let half = number
            .moments
            .interval()
            .map(|[low, high]| 0.5 * (high - low));
        row.push(half.map_or_else(String::new, |half| short(column.to_unit(half))));
        row.push(match missing {
            0 => String::new(),
            missing => missing.to_string(),
        });
        rows.push(row);
    }
    let mut notes = Vec::new();
    if about.summary.sampling == Sampling::Random {
        notes.push("± is half the 95 % interval.".to_owned());
    } else {
        notes.push(
            "± is half the 95 % interval for independent cases; these are stratified, so that the mean is better known."
                .to_owned(),
        );
    }
    Part {
        heading: "Kept quantities",
        rows,
        notes,
    }
}

fn events(about: &About<'_>) -> Part {
    let mut rows = vec![heads(&[
        "",
        "cases",
        "of",
        "probability",
        "95 % interval",
        "median time [s]",
    ])];
    for Event {
        column,
        of,
        happened,
        wilson,
        ..
    } in &about.summary.events
    {
        let when = about.summary.number(column + 1);
        let median = when.and_then(|when| when.quantiles.get(2));
        rows.push(vec![
            about.columns[*column].name.clone(),
            happened.to_string(),
            of.to_string(),
            short(*happened as f64 / *of as f64),
            interval(*wilson),
            median.map_or_else(String::new, |median| short(median.value)),
        ]);
    }
    let mut notes = Vec::new();
    if let Some((event, found)) = &about.summary.rare {
        notes.push(format!(
            "{event}: probability {:.2e} by splitting (95 %: {:.2e} … {:.2e}; {:.0} motions)",
            found.value, found.interval[0], found.interval[1], found.evaluations
        ));
    }
    Part {
        heading: "What happened",
        rows,
        notes,
    }
}

fn sensitivity(about: &About<'_>) -> Vec<Part> {
    let mut rows = vec![heads(&[
        "",
        "factor",
        "first order",
        "95 %",
        "total",
        "95 %",
    ])];
    for Effects {
        column, indices, ..
    } in &about.summary.effects
    {
        for (factor, indices) in indices.iter().flatten().enumerate() {
            let index = |index: Index| [format!("{:.3}", index.value), interval(index.interval)];
            let mut row = vec![
                if factor == 0 {
                    about.columns[*column].name.clone()
                } else {
                    String::new()
                },
                about.columns[factor].name.clone(),
            ];
            row.extend(index(indices.first));
            row.extend(index(indices.total));
            rows.push(row);
        }
    }
    vec![Part {
        heading: "Sensitivity (parts of the variance)",
        rows,
        notes: Vec::new(),
    }]
}
