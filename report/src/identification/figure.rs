//! Held-out runs with their predictions.

use crate::figure::{Figure, Panel, Series};
use appell_gap::identify::{AHEAD, Answer};
use appell_recordings::DataSet;

/// Number of runs drawn.
const DRAWN_RUNS: usize = 2;

/// Drifting parameters with their 95 % bands, a panel for each run.
fn courses(answer: &Answer) -> impl Iterator<Item = Panel> + '_ {
    answer.courses.iter().map(|course| {
        let name = format!("{}, {}", course.quantity.name, course.run);
        Panel::with_band(
            [&name, "from", "to"],
            &course.quantity,
            &course.times,
            &course.values,
            &course.deviations,
        )
    })
}

/// The first held-out runs: for each channel a panel of values and one of errors.
pub fn figure(set: &DataSet, answer: &Answer) -> Figure {
    let traces = answer.traces.iter();
    let mut runs: Vec<&str> = traces.clone().map(|trace| trace.run.as_str()).collect();
    runs.dedup();
    runs.truncate(DRAWN_RUNS);
    let shown = traces.filter(|trace| runs.contains(&trace.run.as_str()));
    let panels = shown.flat_map(|trace| {
        let channel = set.channels.iter().find(|c| c.column == trace.column);
        let in_unit = |value: f64| channel.map_or(value, |channel| channel.unit.from_si(value));
        let series = |label: String, y: &mut dyn Iterator<Item = f64>| {
            Series::new(label, &trace.times, y.map(in_unit).collect())
        };
        let values = |label: String, y: &[f64]| series(label, &mut y.iter().copied());
        let errors = |label: String, predicted: &[f64]| {
            let both = trace.measured.iter().zip(predicted);
            series(
                label,
                &mut both.map(|(measured, predicted)| measured - predicted),
            )
        };
        let name = format!("{}, {}", trace.column, trace.run);
        let motion = vec![
            values(name.clone(), &trace.measured),
            values(format!("nominal, {AHEAD} s ahead"), &trace.nominal),
            values(format!("fitted, {AHEAD} s ahead"), &trace.fitted),
        ];
        let errors = vec![
            errors(format!("{name}: error, nominal"), &trace.nominal),
            errors("error, fitted".to_owned(), &trace.fitted),
        ];
        let unit = channel.map_or("", |channel| &channel.unit.text);
        [motion, errors].map(|series| Panel {
            unit: unit.to_owned(),
            series,
        })
    });
    Figure::over_t(
        format!("{}: held-out runs", set.mechanism.name),
        panels.chain(courses(answer)).collect(),
    )
}
