//! Tables and sentences of a study.

use appell_ensemble::design::Sampling;
use appell_ensemble::rows::{Column, Role};
use appell_ensemble::statistics::moments::Moments;
use appell_ensemble::summary::{Number, Summary};

use crate::text::{Table, short};

/// A study with its statistics.
#[derive(Debug, Clone, Copy)]
pub struct About<'a> {
    /// Its title.
    pub title: &'a str,
    /// The study file.
    pub study: &'a str,
    /// The columns of the rows.
    pub columns: &'a [Column],
    /// Their statistics.
    pub summary: &'a Summary,
}

/// Name and unit of a column.
pub(super) fn labelled(column: &Column) -> String {
    in_brackets(&column.name, &column.unit)
}

/// `name [unit]`
pub(super) fn in_brackets(name: &str, unit: &str) -> String {
    match unit {
        "" | "1" => name.to_owned(),
        unit => format!("{name} [{unit}]"),
    }
}

/// How many cases there are, and how they ended.
pub(super) fn sentences(about: &About<'_>) -> Vec<String> {
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
    let early = summary.early.iter();
    let count: u64 = early.clone().map(|(_, count)| count).sum();
    if count > 0 {
        let reasons: Vec<String> = early
            .map(|(reason, count)| format!("{reason} ({count})"))
            .collect();
        told.push(format!("{count} ended early: {}", reasons.join("; ")));
    }
    told
}

/// The tables, those with rows.
pub(super) fn parts(about: &About<'_>) -> Vec<Table> {
    let mut parts = vec![
        factors(about),
        numbers(about),
        events(about),
        sensitivity(about),
    ];
    parts.retain(Table::has_rows);
    parts
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

fn factors(about: &About<'_>) -> Table {
    let columns = " | mean | deviation | 5 % | median | 95 %";
    let mut part = Table::new("Factors", columns, 1..6);
    for number in &about.summary.numbers {
        let column = &about.columns[number.column];
        match &column.role {
            Role::Factor(items) if items.is_empty() => part.rows.push(row(column, number)),
            Role::Factor(items) => {
                let note = format!("{}: one of {}", column.name, items.join(", "));
                part.notes.push(note);
            }
            _ => {}
        }
    }
    if !part.has_rows() && !part.notes.is_empty() {
        part.rows.push(vec!["files".to_owned()]);
    }
    part
}

fn numbers(about: &About<'_>) -> Table {
    let columns = " | mean | deviation | 5 % | median | 95 % | mean ± | missing";
    let mut part = Table::new("Kept quantities", columns, 1..8);
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
        part.rows.push(row);
    }
    let note = if about.summary.sampling == Sampling::Random {
        "± is half the 95 % interval."
    } else {
        "± is half the 95 % interval for independent cases; these are stratified, so that the mean is better known."
    };
    part.notes.push(note.to_owned());
    part
}

fn events(about: &About<'_>) -> Table {
    let columns = " | cases | of | probability | 95 % interval | median time [s]";
    let mut part = Table::new("What happened", columns, 1..6);
    for event in &about.summary.events {
        let when = about.summary.number(event.column + 1);
        let median = when.and_then(|when| when.quantiles.get(2));
        part.rows.push(vec![
            about.columns[event.column].name.clone(),
            event.happened.to_string(),
            event.of.to_string(),
            short(event.happened as f64 / event.of as f64),
            interval(event.wilson),
            median.map_or_else(String::new, |median| short(median.value)),
        ]);
    }
    part.notes
        .extend(about.summary.rare.iter().map(|(event, found)| {
            format!(
                "{event}: probability {:.2e} by splitting (95 %: {:.2e} … {:.2e}; {:.0} motions)",
                found.value, found.interval[0], found.interval[1], found.evaluations
            )
        }));
    part
}

fn sensitivity(about: &About<'_>) -> Table {
    let columns = " | factor | first order | 95 % | total | 95 %";
    let mut part = Table::new("Sensitivity (parts of the variance)", columns, 1..6);
    for effects in &about.summary.effects {
        for (factor, indices) in effects.indices.iter().flatten().enumerate() {
            let name = match factor {
                0 => about.columns[effects.column].name.clone(),
                _ => String::new(),
            };
            let mut row = vec![name, about.columns[factor].name.clone()];
            for index in [indices.first, indices.total] {
                row.extend([format!("{:.3}", index.value), interval(index.interval)]);
            }
            part.rows.push(row);
        }
    }
    part
}
