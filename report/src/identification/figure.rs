//! Held-out runs with their predictions.

use crate::figure::{Figure, Panel, Series};
use appell_gap::identify::{AHEAD, Answer, HALF_WIDTH_95};
use appell_recordings::DataSet;

/// Number of runs drawn.
const DRAWN_RUNS: usize = 2;

/// Drifting parameters with their 95 % bands, a panel for each run.
fn courses(answer: &Answer) -> impl Iterator<Item = Panel> + '_ {
    answer.courses.iter().map(|course| {
        let moved = |sign: f64| -> Vec<f64> {
            (course.values.iter().zip(&course.deviations))
                .map(|(value, std)| value + sign * HALF_WIDTH_95 * std)
                .map(|value| course.quantity.to_unit(value))
                .collect()
        };
        let label = format!("{}, {}", course.quantity.name, course.run);
        let lines = [
            (label, 0.0),
            ("from".to_owned(), -1.0),
            ("to".to_owned(), 1.0),
        ];
        let series = lines.map(|(label, sign)| Series {
            label,
            x: course.times.clone(),
            y: moved(sign),
        });
        Panel {
            unit: course.quantity.unit.to_string(),
            series: series.to_vec(),
        }
    })
}

/// The first held-out runs: for each channel a panel of values and one of errors.
pub fn figure(set: &DataSet, answer: &Answer) -> Figure {
    let mut runs: Vec<&str> = answer
        .traces
        .iter()
        .map(|trace| trace.run.as_str())
        .collect();
    runs.dedup();
    runs.truncate(DRAWN_RUNS);
    let traces = answer.traces.iter();
    let shown = traces.filter(|trace| runs.contains(&trace.run.as_str()));
    let panels = shown.flat_map(|trace| {
        let channel = set.channels.iter().find(|c| c.column == trace.column);
        let in_unit = |values: &[f64]| -> Vec<f64> {
            let converted =
                |&value: &f64| channel.map_or(value, |channel| channel.unit.from_si(value));
            values.iter().map(converted).collect()
        };
        let series = |label: String, y: &[f64]| Series {
            label,
            x: trace.times.clone(),
            y: in_unit(y),
        };
        let unit = channel.map_or_else(String::new, |channel| channel.unit.text.clone());
        let error = |predicted: &[f64]| -> Vec<f64> {
            (trace.measured.iter().zip(predicted))
                .map(|(measured, predicted)| measured - predicted)
                .collect()
        };
        let name = format!("{}, {}", trace.column, trace.run);
        let motion = vec![
            series(name.clone(), &trace.measured),
            series(format!("nominal, {AHEAD} s ahead"), &trace.nominal),
            series(format!("fitted, {AHEAD} s ahead"), &trace.fitted),
        ];
        let errors = vec![
            series(format!("{name}: error, nominal"), &error(&trace.nominal)),
            series("error, fitted".to_owned(), &error(&trace.fitted)),
        ];
        [motion, errors].map(|series| Panel {
            unit: unit.clone(),
            series,
        })
    });
    Figure {
        title: format!("{}: held-out runs", set.mechanism.name),
        x_label: "t [s]".to_owned(),
        panels: panels.chain(courses(answer)).collect(),
        marks: Vec::new(),
        equal_axes: false,
    }
}
