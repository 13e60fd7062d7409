//! A gap report as a self-contained HTML page.

use std::fmt::Write as _;

use appell_codegen::{Derived, derived};
use appell_gap::data::{DataSet, Part};
use appell_gap::diagnose::{Ahead, GapVerdict, HowFar, Hypothesis, Report, Where};
use appell_report::drawing::marked;

use super::doubt::doubts;
use super::numbers::{measured, percent, short};
use super::{hinted, joined, left_out, plots, sentence};
use appell_report::text::with_unit;

const STYLE: &str = include_str!("page.css");
/// Relative improvement of predictions below which an effect is of no practical importance.
const MATTERS: f64 = 0.05;

/// The page.
pub(crate) fn page(set: &DataSet, report: &Report) -> String {
    let name = escaped(&set.mechanism.name);
    let sections = [
        place(set, report),
        which(report),
        how_far(report),
        next(set, report),
        detectable(report),
        recordings(set, report),
    ];
    format!(
        "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n\
         <meta name=\"viewport\" content=\"width=device-width,initial-scale=1\">\n\
         <title>{name}: the gap</title>\n<style>\n{STYLE}</style>\n</head>\n<body>\n<main>\n\
         <h1>{name}: model against recordings</h1>\n<p class=\"faint\">{about}</p>\n\
         <p class=\"verdict\">{verdict}</p>\n{sections}</main>\n</body>\n</html>\n",
        about = escaped(&set.description),
        verdict = escaped(&verdict(report)),
        sections = sections.concat(),
    )
}

/// The verdict, with the size of the effect and the part of the gap that it closes.
fn verdict(report: &Report) -> String {
    let mut text = capital(&sentence(report));
    let top = report.which.iter().find(|h| !h.parameters.is_empty());
    let is_named = matches!(
        report.verdict,
        GapVerdict::Explained | GapVerdict::Ambiguous
    );
    if let Some(top) = top.filter(|_| is_named) {
        let _ = write!(text, ": {}", values(top).join(", "));
    }
    text.push('.');
    if let (Some(far), true) = (&report.how_far, is_named) {
        let _ = write!(
            text,
            " On held-out runs it closes {} [{}, {}] of the gap, and {} of the gap that remains after \
            re-fitting the parameters.",
            percent(far.closed),
            percent(far.closed_ci95[0]),
            percent(far.closed_ci95[1]),
            percent(far.closed_vs_refitted),
        );
        if far.with_effect > far.refitted {
            text += " Predictions become worse with it: the fit does not generalise to these runs.";
        } else if far.with_effect > (1.0 - MATTERS) * far.refitted {
            text += " The effect is significant but unimportant: predictions hardly improve.";
        }
    }
    text
}

/// `force = 0.412 ± 0.021 N`
fn values(hypothesis: &Hypothesis) -> Vec<String> {
    let values = hypothesis.parameters.iter().map(|value| {
        let (effect, short) = value.name.rsplit_once('.').unwrap_or(("", &value.name));
        let number = with_unit(&measured(value.value, value.std), &value.unit);
        // Several effects may have values of one name.
        let site = effect
            .split_once('@')
            .filter(|_| hypothesis.effects.len() > 1);
        let site = site.map_or_else(String::new, |(_, site)| format!(" ({site})"));
        format!("{}{site} = {number}", short.replace('_', " "))
    });
    values.collect()
}

fn place(set: &DataSet, report: &Report) -> String {
    let mut html = "<h2>Where</h2>\n".to_owned();
    if report.verdict == GapVerdict::NoGap {
        html += "<p>No equation disagrees with the recordings beyond measurement and process noise.</p>\n";
    } else if report.verdict == GapVerdict::Unexplained {
        if let Some(left) = &report.left {
            let _ = writeln!(html, "<p>{}.</p>", escaped(&capital(&left.about)));
        }
    } else if report.place.equations.is_empty() {
        html += "<p>The gap lies in the structure of the model: an alternative model fits the recordings.</p>\n";
    } else {
        let domain = report.place.domain;
        // Writing to a string cannot fail.
        let _ = writeln!(
            html,
            "<p>The gap lies in the <b>{domain}s</b> of the model.</p>"
        );
    }
    for hint in &report.hints {
        let _ = writeln!(html, "<p>{}.</p>", escaped(&capital(&hinted(hint))));
    }
    if let Some(svg) = drawing(set, report) {
        let caption = if svg.contains("class=\"ring") {
            "The mechanism at its initial state. A ring marks the site of the gap."
        } else {
            "The mechanism at its initial state."
        };
        html += &figure(&svg, caption);
    }
    if let (Some(pictures), true) = (&report.pictures, report.verdict != GapVerdict::NoGap) {
        let caption = format!(
            "Missing force of each equation in windows of {} s of the training runs: the stronger the \
            colour, the larger the force. The maximum is given beside the name.",
            short(pictures.force_history.part)
        );
        html += &figure(&plots::over_time(&pictures.force_history), &caption);
    }
    html += &windows(&report.place);
    // A sensor error is not a missing force.
    if !report
        .place
        .equations
        .iter()
        .any(|equation| equation.share > 0.0)
    {
        return html;
    }
    html += &equations(set, &report.place);
    if let Some(law) = report.pictures.as_ref().and_then(|p| p.force_law.as_ref()) {
        let caption = if law.law.is_empty() {
            "Missing force, estimated from the recordings without a force law, against the variable on \
            which it depends most."
        } else {
            "Missing force, estimated from the recordings without a force law, with the identified law."
        };
        html += &figure(&plots::law(law), caption);
    }
    html
}

/// The mechanism with the sites of the gap ringed; `None` if it cannot be drawn.
fn drawing(set: &DataSet, report: &Report) -> Option<String> {
    let sites = report
        .found
        .iter()
        .filter_map(|found| found.effect.split_once('@'));
    // A channel is marked at the quantity that it measures.
    let name = |site: &str| {
        let channel = set.channels.iter().find(|channel| channel.column == site);
        let label = channel.and_then(|channel| channel.role.label(&set.mechanism));
        label.map_or_else(|| site.to_owned(), |label| label.name.clone())
    };
    let mut names: Vec<String> = match report.verdict {
        GapVerdict::NoGap => Vec::new(),
        GapVerdict::Unexplained => {
            let left = report.left.iter();
            left.map(|left| name(&left.place)).collect()
        }
        _ => sites.map(|(_, site)| name(site)).collect(),
    };
    names.dedup();
    let names: Vec<&str> = names.iter().map(String::as_str).collect();
    let Derived {
        mechanism,
        derivation,
        ..
    } = derived(&set.spec.file, &set.spec.text).ok()?;
    marked(&mechanism, derivation, &names).ok()
}

fn equations(set: &DataSet, place: &Where) -> String {
    if place.equations.is_empty() {
        return String::new();
    }
    let speeds = &set.mechanism.pseudo_velocities;
    let rows = place.equations.iter().map(|equation| {
        let label = speeds
            .iter()
            .map(|s| &s.label)
            .find(|l| l.name == equation.name);
        let about = label.map_or("", |label| label.about.as_str());
        vec![
            format!(
                "{}<br><span class=\"faint\">{}</span>",
                code(&equation.name),
                escaped(about)
            ),
            bar(equation.share),
            format!("{} {}", short(equation.rms), escaped(&equation.unit)),
            short(equation.p_value),
        ]
    });
    table(
        [
            "equation of",
            "share of the gap",
            "missing force (rms)",
            "p-value",
        ],
        rows,
        2,
    )
}

fn windows(place: &Where) -> String {
    let mut html = String::new();
    if !place.windows.is_empty() {
        let rows = place.windows.iter().map(|w| {
            let time = format!("{} to {} s", short(w.from), short(w.to));
            vec![escaped(&w.run), time, code(&w.equation), short(w.z)]
        });
        let table = table(["run", "when", "equation of", "z-score"], rows, 3);
        let _ = writeln!(
            html,
            "<details><summary>{} significant windows</summary>{table}</details>",
            place.windows.len()
        );
    }
    if !place.region.is_empty() {
        let rows = place
            .region
            .iter()
            .map(|r| vec![code(&r.variable), escaped(&r.description), short(r.z)]);
        html += &table(["depends on", "where", "z-score"], rows, 2);
    }
    html
}

fn which(report: &Report) -> String {
    let rows = report.which.iter().map(|hypothesis| {
        let name = match hypothesis.effects.first().map(String::as_str) {
            None => "no effect: nominal model, parameters within tolerance".to_owned(),
            Some("unknown") => "no effect of the library".to_owned(),
            Some(_) => code(&joined(&hypothesis.effects)),
        };
        let values = values(hypothesis)
            .iter()
            .map(|value| escaped(value))
            .collect::<Vec<_>>();
        let bayes = hypothesis.log_bayes_factor.map_or_else(String::new, short);
        vec![
            bar(hypothesis.probability),
            format!("{name}<br>{}", values.join("<br>")),
            bayes,
        ]
    });
    let mut html = "<h2>Which</h2>\n".to_owned();
    html += &table(
        [
            "probability",
            "hypothesis, values ± 1 standard deviation",
            "log Bayes factor",
        ],
        rows,
        2,
    );
    for doubt in doubts(report) {
        let doubt = escaped(&capital(&doubt.replace('`', "")));
        let _ = writeln!(html, "<p><b>Unit error?</b> {doubt}</p>");
    }
    for group in &report.tied {
        let names: Vec<String> = group.iter().map(|effects| code(&joined(effects))).collect();
        let _ = writeln!(
            html,
            "<p><b>Tied.</b> These recordings cannot distinguish {}.</p>",
            names.join(" and ")
        );
    }
    if let Some(left) = report.left.as_ref().filter(|left| left.is_there()) {
        let part = left.gain / (left.gain + left.explained.max(0.0));
        let _ = writeln!(
            html,
            "<p><b>Unexplained remainder.</b> Beyond the first hypothesis the recordings support {} \
            (log Bayes factor {}), {} of the gap.</p>",
            escaped(&left.about),
            short(left.log_bayes_factor),
            percent(part),
        );
    }
    if !report.failed.is_empty() {
        let failed = report.failed.iter().map(|(effects, reason)| {
            format!("<li>{}: {}</li>", code(&joined(effects)), escaped(reason))
        });
        let _ = writeln!(
            html,
            "<details><summary>{} fits did not converge</summary><ul>{}</ul></details>",
            report.failed.len(),
            failed.collect::<String>()
        );
    }
    html
}

fn how_far(report: &Report) -> String {
    let mut html = "<h2>How far</h2>\n".to_owned();
    let Some(far) = &report.how_far else {
        return html
            + "<p>No run was held out, so the closed part of the gap cannot be assessed.</p>\n";
    };
    html += &closed(far);
    let rows = report.horizons.iter().map(|ahead| {
        let floor = ahead.noise_floor.map_or_else(|| "–".to_owned(), short);
        vec![
            horizon(ahead),
            short(ahead.nominal),
            short(ahead.refitted),
            short(ahead.with_effect),
            floor,
        ]
    });
    html += &table(
        [
            "ahead",
            "as stated",
            "parameters re-fitted",
            "with the effect",
            "noise floor",
        ],
        rows,
        1,
    );
    html += "<p class=\"faint\">RMS prediction error relative to the measurement noise. The noise \
    floor is the error that the filter predicts if the hypothesis is true.</p>\n";
    let traces = report.pictures.iter().flat_map(|pictures| &pictures.traces);
    for trace in plots::most_bettered(traces) {
        let caption = format!(
            "{} of the held-out {} with predictions {} s ahead, and the prediction errors. The band \
            shows two standard deviations of the error expected if the hypothesis is true.",
            trace.column,
            trace.run,
            appell_gap::diagnose::AHEAD
        );
        let [motion, errors] = plots::trace(trace);
        html += &figure(&(motion + &errors), &caption);
    }
    if !report.disturbances.is_empty() {
        let rows = report
            .disturbances
            .iter()
            .map(|(name, before, after)| vec![code(name), short(*before), short(*after)]);
        html += "<p>Process noise that the filter needs to follow the recordings: a missing effect \
        appears as process noise.</p>\n";
        html += &table(["equation of", "without the effect", "with it"], rows, 1);
    }
    html
}

fn closed(far: &HowFar) -> String {
    format!(
        "<p>{} s ahead the error falls from {} to {} times the noise; the noise floor is {}. This \
        closes <b>{}</b> of the gap (95 % interval {} to {}), and <b>{}</b> of the gap that remains \
        after re-fitting the parameters. \
         Runs: {}.</p>\n",
        far.horizon_s,
        short(far.nominal),
        short(far.with_effect),
        short(far.noise_floor),
        percent(far.closed),
        percent(far.closed_ci95[0]),
        percent(far.closed_ci95[1]),
        percent(far.closed_vs_refitted),
        escaped(&far.runs.join(", "))
    )
}

fn horizon(ahead: &Ahead) -> String {
    match ahead.horizon {
        horizon if horizon <= 0.0 => "one step".to_owned(),
        horizon if horizon.is_finite() => format!("{horizon} s"),
        _ => "free run".to_owned(),
    }
}

fn is_alternative(hypothesis: &Hypothesis) -> bool {
    let mut effects = hypothesis.effects.iter();
    effects.any(|effect| effect.starts_with("alternative:"))
}

/// Recommended next steps.
fn next(set: &DataSet, report: &Report) -> String {
    let text = match report.verdict {
        GapVerdict::NoGap => {
            "<p>The model needs no addition. The table below lists the smallest effects that these \
            recordings would have revealed.</p>\n"
        }
        _ if is_alternative(&report.which[0]) => {
            "<p>Adopt the alternative model and run the diagnosis on it.</p>\n"
        }
        GapVerdict::Explained | GapVerdict::Ambiguous => {
            "<p>Add the effect to the spec, using the report written by <code>--json report.json</code>:</p>\n<pre>appell apply MODEL --report report.json -o improved.toml</pre>\n"
        }
        GapVerdict::Unexplained => {
            "<p>Examine what the missing force depends on, write that effect in the spec language, and \
            try it: <code>appell diagnose --effects own.toml</code>.</p>\n"
        }
    };
    let mut html = format!("<h2>Next</h2>\n{text}");
    if let Some(experiment) = &report.experiment {
        let names = experiment
            .separates
            .each_ref()
            .map(|effects| code(&joined(effects)));
        let _ = writeln!(
            html,
            "<p>This experiment separates {} from {}: {}. The separation is {} sigma now and would be \
            {} sigma with the new recording. The command writes the input as a table beside the gap \
            report.</p>",
            names[0],
            names[1],
            escaped(&experiment.about),
            short(experiment.separation_now),
            short(experiment.separation_then),
        );
        for plot in plots::experiment(experiment, &set.mechanism) {
            html += &figure(&plot, "Input of the proposed experiment.");
        }
    } else if report.verdict == GapVerdict::Ambiguous {
        html += "<p>None of the inputs tried separates the tied hypotheses while keeping the motion \
        within its limits. Give wider limits with <code>--limit</code>, or record under feedback.</p>\n";
    }
    html
}

fn detectable(report: &Report) -> String {
    let rows = report.detectable.iter().map(|one| {
        let smallest = with_unit(&short(one.smallest), &one.unit);
        vec![code(&one.effect), escaped(&smallest)]
    });
    let rows: Vec<Vec<String>> = rows.collect();
    if rows.is_empty() {
        return String::new();
    }
    format!(
        "<h2>Detection limits of these recordings</h2>\n<details{}><summary>Smallest size of each \
        effect that would be detected almost surely</summary>\n{}</details>\n",
        if report.verdict == GapVerdict::NoGap {
            " open"
        } else {
            ""
        },
        table(["effect", "smallest size"], rows.into_iter(), 1)
    )
}

fn recordings(set: &DataSet, report: &Report) -> String {
    let rows = set.runs.iter().map(|run| {
        let part = match run.part {
            Part::Fit => "training",
            Part::Test => "held out",
        };
        vec![
            escaped(&run.name),
            part.to_owned(),
            run.times.len().to_string(),
            format!("{} s", short(run.duration())),
        ]
    });
    let mut html = "<h2>Recordings</h2>\n".to_owned();
    html += &table(["run", "used", "rows", "length"], rows, 2);
    if let Some(rows) = left_out(report) {
        let _ = writeln!(html, "<p class=\"faint\">{}.</p>", escaped(&rows));
    }
    for finding in &set.findings {
        let told = escaped(&appell::recording::sentence(finding));
        let _ = writeln!(html, "<p class=\"faint\">{told}</p>");
    }
    html
}

/// A table; the columns from `numbers` on are right-aligned. Cells are HTML.
fn table<const N: usize>(
    heading: [&str; N],
    rows: impl Iterator<Item = Vec<String>>,
    numbers: usize,
) -> String {
    let class = |column: usize| {
        if column >= numbers {
            " class=\"number\""
        } else {
            ""
        }
    };
    let mut html = "<table>\n<tr>".to_owned();
    for (column, text) in heading.iter().enumerate() {
        let _ = write!(html, "<th{}>{text}</th>", class(column));
    }
    html += "</tr>\n";
    for row in rows {
        html += "<tr>";
        for (column, cell) in row.iter().enumerate() {
            let _ = write!(html, "<td{}>{cell}</td>", class(column));
        }
        html += "</tr>\n";
    }
    html + "</table>\n"
}

/// A share as a bar beside its number.
fn bar(part: f64) -> String {
    let width = 100.0 * part.clamp(0.0, 1.0);
    format!(
        "<span class=\"share\"><span class=\"bar\"><i style=\"width:{width:.1}%\"></i></span> {}</span>",
        percent(part)
    )
}

fn figure(svg: &str, caption: &str) -> String {
    format!(
        "<figure>{svg}<figcaption>{}</figcaption></figure>\n",
        escaped(caption)
    )
}

fn code(text: &str) -> String {
    format!("<code>{}</code>", escaped(text))
}

fn capital(text: &str) -> String {
    let mut letters = text.chars();
    let first = letters.next().map(char::to_uppercase);
    first.into_iter().flatten().chain(letters).collect()
}

pub(super) fn escaped(text: &str) -> String {
    text.replace('&', "&amp;")
        .replace('<', "&lt;")
        .replace('>', "&gt;")
}
