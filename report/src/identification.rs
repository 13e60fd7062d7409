//! Results of an identification: text, and a page with a figure.

use std::fmt::Write as _;

use appell_gap::identify::{AHEAD, Answer, Estimate, HeldOut, Known};
use appell_recordings::{Channel, DataSet};
use maud::{PreEscaped, html};

use crate::figure::{Figure, Panel, Series};
use crate::page_shell::PageShell;
use crate::recording;
use crate::text::{Table, horizon, number, short};

/// Smaller coefficients of a direction are not shown.
const NEGLIGIBLE: f64 = 0.1;
/// Deviation from the prior, in prior standard deviations, beyond which a value probably
/// compensates for a missing effect.
const FAR: f64 = 3.0;
/// Ratio of prediction errors above which the fit counts as biased.
const WORSE: f64 = 1.2;
/// The note shown in that case.
const BENT: &str = "On the held-out runs the fitted model predicts worse than the nominal one, one \
second ahead: an effect missing from the model has biased the parameters. `appell diagnose` searches \
for it.";
/// Prediction errors in units of the noise: up to the first a good fit, up to the second explicable by disturbances.
const GOOD: f64 = 1.5;
const FAIR: f64 = 10.0;
/// Posterior standard deviation, in units of the prior one, above which a direction is undetermined.
const UNKNOWN: f64 = 100.0;

/// The report as text tables.
pub fn text(set: &DataSet, answer: &Answer) -> String {
    let mut text = recording::text(set);
    for warning in warnings(answer) {
        // Writing to a string cannot fail.
        let _ = writeln!(text, "\n{warning}");
    }
    for part in parts(set, answer) {
        let rows = part.text();
        let _ = write!(text, "\n{}\n\n{rows}", part.heading);
        for note in &part.notes {
            let _ = writeln!(text, "\n{note}");
        }
    }
    if answer.held_out.is_empty() {
        text.push_str(
            "\nNo run was held out, so the predictions of the model cannot be assessed.\n",
        );
    }
    text
}

fn parts(set: &DataSet, answer: &Answer) -> Vec<Table> {
    let has_several = answer.parameters.len() > 1;
    let parts = [
        Some(parameters(answer)),
        has_several.then(|| correlation(answer)),
        Some(repeatability(answer)).filter(Table::has_rows),
        Some(combinations(answer)),
        Some(levels(set, answer)),
        Some(residuals(answer)),
        Some(courses(answer)).filter(Table::has_rows),
        Some(held_out(set, answer)).filter(Table::has_rows),
    ];
    parts.into_iter().flatten().collect()
}

fn in_unit(estimate: &Estimate, value: f64) -> String {
    number(value / estimate.quantity.scale)
}

fn parameters(answer: &Answer) -> Table {
    let columns = "parameter | nominal | tolerance | found | from | to | unit | ";
    let mut part = Table::new("95 % intervals", columns, 1..6);
    for estimate in &answer.parameters {
        let ends = estimate.interval95().map(|end| in_unit(estimate, end));
        let [low, high] = if estimate.at_limit {
            Default::default()
        } else {
            ends
        };
        let tolerance = estimate.tolerance.map(|std| in_unit(estimate, std));
        part.rows.push(vec![
            estimate.quantity.name.to_string(),
            in_unit(estimate, estimate.nominal),
            tolerance.unwrap_or_default(),
            in_unit(estimate, estimate.value),
            low,
            high,
            estimate.quantity.unit.to_string(),
            remark(estimate).to_owned(),
        ]);
    }
    let is_bent = |(error, _): &(&HeldOut, String)| error.fitted > WORSE * error.nominal;
    let bent = ahead(answer).filter(is_bent);
    part.notes.extend(bent.map(|_| BENT.to_owned()));
    part
}

fn remark(estimate: &Estimate) -> &'static str {
    let moved = (estimate.value - estimate.nominal).abs();
    match (estimate.at_limit, estimate.tolerance, estimate.left) {
        (true, ..) => "at the limit of its range",
        (_, Some(tolerance), _) if moved > FAR * tolerance => "far beyond its tolerance",
        (.., Some(left)) if left > 0.5 => "hardly determined by the recordings",
        _ => "",
    }
}

/// Values of the single runs, and their spread.
fn repeatability(answer: &Answer) -> Table {
    let columns = "parameter | lowest | highest | spread | relative to its interval | unit | ";
    let mut part = Table::new("Repeatability from run to run", columns, 1..5);
    for (one, estimate) in answer.repeatability.iter().zip(&answer.parameters) {
        let values = one.runs.iter().map(|(_, [value, _])| *value);
        let lowest = values.clone().fold(f64::INFINITY, f64::min);
        let highest = values.fold(f64::NEG_INFINITY, f64::max);
        let relative = one.spread / estimate.wider_std();
        let remark = if one.differs {
            "differs from run to run"
        } else {
            ""
        };
        part.rows.push(vec![
            one.name.clone(),
            in_unit(estimate, lowest),
            in_unit(estimate, highest),
            in_unit(estimate, one.spread),
            number(relative),
            estimate.quantity.unit.to_string(),
            remark.to_owned(),
        ]);
    }
    let note = "The spread is a standard deviation between the runs, beyond that of the single values. An interval holds for \
     the value that all runs share; another run may have one that differs by the spread. A parameter differs from run \
     to run where values as far apart would be found in less than 5 % of such tables if all runs shared one (Q test, \
     Bonferroni).";
    part.notes.push(note.to_owned());
    part
}

/// Correlation matrix of the parameter errors.
fn correlation(answer: &Answer) -> Table {
    let names = answer
        .parameters
        .iter()
        .map(|one| one.quantity.name.to_string());
    let names: Vec<String> = names.collect();
    let numbers = 1..1 + names.len();
    let mut part = Table::new("Correlation of the parameter errors", "", numbers);
    part.is_heat = true;
    part.rows[0].extend(names.clone());
    for (name, row) in names.into_iter().zip(answer.correlation.row_iter()) {
        // Avoids a negative zero.
        let rounded = row
            .iter()
            .map(|value| (100.0 * value).round() / 100.0 + 0.0);
        let cells = rounded.map(|value| format!("{value:.2}"));
        part.rows.push([name].into_iter().chain(cells).collect());
    }
    part
}

/// Parameter directions, with the posterior standard deviation relative to the prior.
fn combinations(answer: &Answer) -> Table {
    let all = answer.combinations.iter();
    let known = all.filter(|known| known.deviation < 1.0).count();
    let heading = format!(
        "The data improve on prior knowledge in {known} of {} parameter directions",
        answer.combinations.len()
    );
    let columns = "posterior / prior std | direction, in units of the prior std";
    let mut part = Table::new(&heading, columns, 0..1);
    for combination in &answer.combinations {
        let known_to = if combination.deviation < UNKNOWN {
            number(combination.deviation)
        } else {
            "undetermined".to_owned()
        };
        part.rows.push(vec![known_to, sum(answer, combination)]);
    }
    part
}

/// `0.8 m + 0.6 l`
fn sum(answer: &Answer, combination: &Known) -> String {
    let mut text = String::new();
    let parts = combination.parts.iter().zip(&answer.parameters);
    for (part, estimate) in parts.filter(|(part, _)| part.abs() >= NEGLIGIBLE) {
        let sign = match (part.is_sign_negative(), text.is_empty()) {
            (true, true) => "-",
            (false, true) => "",
            (true, false) => " - ",
            (false, false) => " + ",
        };
        let _ = write!(text, "{sign}{:.2} {}", part.abs(), estimate.quantity.name);
    }
    text
}

fn levels(set: &DataSet, answer: &Answer) -> Table {
    let heading = "Measurement noise and process noise (standard deviations)";
    let columns = "level | of | nominal model | fitted model | unit";
    let mut part = Table::new(heading, columns, 2..4);
    let noise = answer.noise.iter().map(|level| (level, true));
    let process = answer.disturbances.iter().map(|level| (level, false));
    for (level, is_measured) in noise.chain(process) {
        let channel = channel(set, &level.name).filter(|_| is_measured);
        let what = if is_measured {
            "measurement"
        } else {
            "process"
        };
        let unit = channel.map_or("SI", |channel| &channel.unit.text);
        let shown = |value| {
            let value = channel.map_or(value, |channel| channel.unit.from_si(value));
            format!("{value:.3e}")
        };
        part.rows.push(vec![
            format!("{what} noise"),
            level.name.clone(),
            shown(level.nominal),
            shown(level.fitted),
            unit.to_owned(),
        ]);
    }
    part
}

fn channel<'s>(set: &'s DataSet, column: &str) -> Option<&'s Channel> {
    set.channels.iter().find(|channel| channel.column == column)
}

/// Whiteness of the innovations.
fn residuals(answer: &Answer) -> Table {
    let heading = "One-step residuals on the training runs";
    let columns = "channel | lag-1 autocorrelation | white-noise bound | ";
    let mut part = Table::new(heading, columns, 1..3);
    for (column, consistency) in &answer.whiteness {
        let remark = if consistency.is_white() {
            ""
        } else {
            "not white: unmodelled dynamics or sensor error"
        };
        part.rows.push(vec![
            column.clone(),
            number(consistency.correlation),
            number(consistency.correlation_band[1]),
            remark.to_owned(),
        ]);
    }
    part
}

/// Values of drifting parameters at the start and end of each run.
fn courses(answer: &Answer) -> Table {
    let columns = "parameter | run | at start | at end | std | unit";
    let mut part = Table::new("Drifting parameters, smoothed over each run", columns, 2..5);
    for course in &answer.courses {
        let shown = |value: Option<&f64>| {
            value.map_or_else(String::new, |value| number(course.quantity.to_unit(*value)))
        };
        part.rows.push(vec![
            course.quantity.name.to_string(),
            course.run.clone(),
            shown(course.values.first()),
            shown(course.values.last()),
            shown(course.deviations.get(course.deviations.len() / 2)),
            course.quantity.unit.to_string(),
        ]);
    }
    part
}

/// Prediction errors in the units of the channels, and relative to the measurement noise.
fn held_out(set: &DataSet, answer: &Answer) -> Table {
    let columns =
        "ahead | channel | unit | nominal model | fitted model | nominal / noise | fitted / noise";
    let heading = "RMS prediction errors on held-out runs";
    let mut part = Table::new(heading, columns, 3..7);
    for error in &answer.held_out {
        let column = error.column.as_deref();
        let noise = column.and_then(|name| answer.noise.iter().find(|level| level.name == name));
        let channel = column.and_then(|name| channel(set, name));
        let in_channel_unit = |part: f64| match (noise, channel) {
            (Some(level), Some(channel)) => size(channel.unit.from_si(part * level.fitted)),
            _ => String::new(),
        };
        part.rows.push(vec![
            horizon(error.horizon),
            column.unwrap_or("all").to_owned(),
            channel.map_or_else(String::new, |channel| channel.unit.text.clone()),
            in_channel_unit(error.nominal),
            in_channel_unit(error.fitted),
            size(error.nominal),
            size(error.fitted),
        ]);
    }
    part.notes.extend(verdict(answer));
    part
}

/// Warnings against relying on the values, for the first lines.
fn warnings(answer: &Answer) -> Vec<String> {
    let mut warnings = Vec::new();
    if !answer.is_optimum {
        warnings.push(
            "The search ended before an optimum: do not rely on the parameters or their intervals. The likelihood is \
             rough, or a combination of parameters changes nothing: free fewer of them, state tolerances, or begin \
             nearer to the truth."
                .to_owned(),
        );
    }
    if let Some((error, times)) = ahead(answer)
        && error.fitted > FAIR
    {
        let when = horizon(error.horizon);
        warnings.push(format!(
            "The fitted model misses the held-out runs by {times} times the noise, {when} ahead: do not rely on its \
             parameters, whatever their intervals. An effect is missing, a unit is wrong, or the search began too far \
             from the truth: `appell diagnose` searches for an effect."
        ));
    }
    warnings
}

/// The error of all channels about a second ahead, and its size.
fn ahead(answer: &Answer) -> Option<(&HeldOut, String)> {
    let mut errors = answer.held_out.iter();
    let ahead = errors.find(|error| error.column.is_none() && error.horizon >= AHEAD)?;
    Some((ahead, size(ahead.fitted)))
}

/// The meaning of that error, if [`warnings`] does not cover it.
fn verdict(answer: &Answer) -> Option<String> {
    let (error, times) = ahead(answer)?;
    let when = horizon(error.horizon);
    let size = match error.fitted {
        size if size <= GOOD => format!("within the noise ({times} times it, {when} ahead)"),
        size if size <= FAIR => format!(
            "{times} times the noise, {when} ahead: disturbances may explain that, or a small effect is missing"
        ),
        _ => return None,
    };
    Some(format!(
        "The fitted model predicts the held-out runs to {size}."
    ))
}

/// Size of a prediction error; a prediction that overflowed has diverged.
fn size(error: f64) -> String {
    if error.is_finite() {
        short(error)
    } else {
        "diverged".to_owned()
    }
}

/// Light and dark, as the figure inside.
const STYLE: &str = include_str!("identification/page.css");

/// The self-contained HTML page.
pub fn page(set: &DataSet, answer: &Answer) -> String {
    let name = &set.mechanism.name;
    let title = format!("{name}: parameters");
    PageShell::new(&title, STYLE).around(&html! {
        h1 { (name) ": parameters from recordings" }
        @for warning in warnings(answer) {
            p { strong { (warning) } }
        }
        @for (index, part) in parts(set, answer).iter().enumerate() {
            (part.html())
            @if index == 0 && !answer.traces.is_empty() {
                h2 { "The runs that were held out" }
                (PreEscaped(figure(set, answer).to_svg()))
            }
        }
        h2 { "The recordings" }
        pre { (recording::text(set)) }
    })
}

/// Number of runs drawn.
const DRAWN_RUNS: usize = 2;

/// Drifting parameters with their 95 % bands, a panel for each run.
fn drifting(answer: &Answer) -> impl Iterator<Item = Panel> + '_ {
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
        [motion, errors].map(|series| Panel::new(unit, series))
    });
    let title = format!("{}: held-out runs", set.mechanism.name);
    Figure::new(title, "t [s]", panels.chain(drifting(answer)).collect())
}
