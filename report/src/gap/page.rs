//! A gap report as a self-contained HTML page.

use std::collections::BTreeSet;

use appell_codegen::derived;
use appell_gap::diagnose::{AHEAD, GapVerdict, HowFar, Hypothesis, Report, Share, Trace, Where};
use appell_recordings::{DataSet, Part};
use maud::{Markup, PreEscaped, html};

use super::budget::{budget, closes};
use super::doubt::doubts;
use super::elements::{bar, cells, code, figure, separated, table};
use super::headline::Headline;
use super::law::law;
use super::numbers::{is_determined, percent};
use super::plots;
use super::words::{
    alternatives, events, hints, joined, left_out, next_best, percent_of, said, statement, values,
};
use crate::drawing::marked;
use crate::page_shell::PageShell;
use crate::text::{capitalised, horizon, short, with_unit};

const STYLE: &str = include_str!("page.css");
/// Relative improvement of predictions below which an effect is of no practical importance.
const MATTERS: f64 = 0.05;
/// Less probable hypotheses are folded away.
const TOLD: f64 = 0.001;

/// The page.
///
/// `lines` are those of the spec or of the robot file that change, as a difference.
pub fn page(set: &DataSet, report: &Report, lines: &str) -> String {
    let name = &set.mechanism.name;
    let title = format!("{name}: the gap");
    PageShell::new(&title, STYLE).around(&html! {
        main {
            h1 { (name) ": model against recordings" }
            p class="faint" { (set.description) }
            p class="verdict" { (capitalised(&statement(report))) "." }
            (reading(report))
            (changes(set, lines))
            @if let Some(far) = &report.how_far {
                (budget(report, far))
            }
            (place(set, report))
            (which(report))
            (how_far(report))
            (next(set, report))
            (detectable(report))
            (recordings(set, report))
        }
    })
}

/// The lines that change.
fn changes(set: &DataSet, lines: &str) -> Markup {
    let file = set
        .robot
        .as_ref()
        .map_or(&set.spec.file, |robot| &robot.file);
    let of = |line: &str| match line.as_bytes().first() {
        Some(b'+') => "new",
        Some(b'-') => "old",
        _ => "",
    };
    html! {
        @if !lines.is_empty() {
            details {
                summary { "The lines of " (code(file)) " that change, as " (code("appell apply")) " writes them" }
                pre class="lines" {
                    @for line in lines.lines() { span class=(of(line)) { (line) } "\n" }
                }
            }
        }
    }
}

/// Below the verdict: size, change, error, and how sure it is.
fn reading(report: &Report) -> Markup {
    let headline = Headline::of(report);
    html! {
        ul class="reading" {
            @if !headline.sizes.is_empty() {
                li { b { "Size" } " (± 95 %): " (headline.sizes.join(", ")) "." }
            }
            @if !headline.refit.is_empty() {
                li { b { "Re-fitted without effects" } ": " (headline.refit.join(", ")) "." }
            }
            li { b { "What to change" } ": " (in_sentences(&headline.change)) }
            @if let Some(error) = headline.error {
                li { b { "Error" } ", " (error) "." }
            }
            @if let Some((probability, same, rivals)) = alternatives(report) {
                li { "Probability " (percent_of(probability)) "."
                @if let Some(next) = next_best(report).filter(|_| report.verdict == GapVerdict::Explained) { " Next: " (next) "." }
                @for phrase in same { " " (capitalised(&phrase)) "." }
                @if !rivals.is_empty() { " Not ruled out: " (codes(&rivals)) "." } }
            }
            @if let Some(far) = &report.how_far {
                @if let Some(note) = worth(far) { li { (note) } }
            }
        }
    }
}

fn in_sentences(lines: &[String]) -> String {
    let lines = lines.iter();
    let lines = lines.map(|line| format!("{}.", capitalised(&line.replace('`', ""))));
    lines.collect::<Vec<_>>().join(" ")
}

fn codes(names: &[String]) -> Markup {
    separated(names, |name| code(name), &html! { ", " })
}

/// Warnings about the leading hypothesis from held-out runs.
fn worth(far: &HowFar) -> Option<&'static str> {
    let is_slight =
        far.budget.iter().any(Share::is_effect) && far.with_effect > (1.0 - MATTERS) * far.refitted;
    let is_determined = is_determined(far.closed, far.closed_ci95);
    let note = if far.is_worse {
        "Predictions become worse with it: the fit does not generalise to the held-out runs."
    } else if is_determined && far.closed_ci95[0] <= 0.0 {
        "The interval of what closes includes zero: these runs leave it open whether anything does."
    } else if is_determined && is_slight {
        "Beyond re-fitted parameters, predictions of the held-out runs hardly improve."
    } else {
        return None;
    };
    Some(note)
}

fn place(set: &DataSet, report: &Report) -> Markup {
    let place = &report.place;
    // A sensor error is not a missing force.
    let is_force = place.equations.iter().any(|e| e.share > 0.0);
    let pictures = report.pictures.as_ref();
    let law = pictures.and_then(|pictures| pictures.force_law.as_ref());
    let history = pictures.filter(|_| report.verdict != GapVerdict::NoGap);
    html! {
        h2 { "Where" }
        (locus(report))
        @for hint in hints(report) {
            p { (capitalised(&hint)) "." }
        }
        @if let Some(events) = events(report) {
            p { (capitalised(&events)) "." }
        }
        @if let Some(svg) = drawing(set, report) {
            @let caption = if svg.contains("class=\"ring") {
                "The mechanism at its initial state. A ring marks the site of the gap."
            } else {
                "The mechanism at its initial state."
            };
            (figure(svg, caption))
        }
        @if let Some(pictures) = history {
            @let caption = format!(
                "Missing force of each equation in windows of {} s of the training runs: the stronger the \
                 colour, the larger the force. The maximum is given beside the name.",
                short(pictures.force_history.part)
            );
            (figure(plots::over_time(&pictures.force_history), &caption))
        }
        (windows(place))
        @if is_force {
            (equations(set, place))
            @if let Some(law) = law {
                @let caption = if law.law.is_empty() {
                    "Missing force, estimated without assuming a law, over the variable on which it \
                     depends most."
                } else {
                    "Missing force, estimated without assuming a law, and the law found for it."
                };
                (figure(plots::law(law), caption))
            }
        }
        @if let Some(pictures) = history.filter(|pictures| !pictures.joints.is_empty()) {
            figure {
                div class="pairs" {
                    @for svg in plots::joints(&pictures.joints) { (PreEscaped(svg)) }
                }
                figcaption { "Missing torque or force of each joint over its rate and over its position." }
            }
        }
    }
}

/// The location of the gap in the model.
fn locus(report: &Report) -> Markup {
    match report.verdict {
        GapVerdict::NoGap => html! {
            p { "No equation disagrees with the recordings beyond noise and disturbance." }
        },
        GapVerdict::Unexplained => html! {
            @if let Some(left) = &report.left {
                p { (capitalised(&left.about)) "." }
            }
        },
        _ if report.place.equations.is_empty() => html! {
            p { "In the structure of the model: another one fits the recordings." }
        },
        _ => html! {
            p { "The gap lies in the " b { (report.place.domain) "s" } " of the model." }
        },
    }
}

/// The mechanism with the sites of the gap ringed; `None` if it cannot be drawn.
fn drawing(set: &DataSet, report: &Report) -> Option<String> {
    let sites = report.found.iter().flat_map(|found| &found.sites);
    // A channel is marked at the quantity that it measures.
    let name = |site: &str| {
        let channel = set.channels.iter().find(|channel| channel.column == site);
        let label = channel.and_then(|channel| channel.role.label(&set.mechanism));
        label.map_or_else(|| site.to_owned(), |label| label.name.clone())
    };
    let names: Vec<String> = match report.verdict {
        GapVerdict::NoGap => Vec::new(),
        GapVerdict::Unexplained => report.left.iter().map(|left| name(&left.place)).collect(),
        _ => sites.map(|site| name(site)).collect(),
    };
    let mut known = BTreeSet::new();
    let names = names.iter().map(String::as_str);
    let names: Vec<&str> = names.filter(|name| known.insert(*name)).collect();
    let derived = derived(&set.spec.file, &set.spec.text).ok()?;
    marked(&derived.mechanism, derived.derivation, &names).ok()
}

fn equations(set: &DataSet, place: &Where) -> Markup {
    let speeds = &set.mechanism.pseudo_velocities;
    let rows = place.equations.iter().map(|equation| {
        let mut labels = speeds.iter().map(|speed| &speed.label);
        let label = labels.find(|label| label.name == equation.name);
        let about = label.map_or("", |label| label.about.as_str());
        [
            html! { (code(&equation.name)) br; span class="faint" { (about) } },
            bar(equation.share),
            html! { (short(equation.rms)) " " (equation.unit) },
        ]
    });
    let heading = ["equation of", "share of the gap", "missing force (rms)"];
    html! {
        @if !place.equations.is_empty() {
            (table(heading, rows, 2))
        }
    }
}

fn windows(place: &Where) -> Markup {
    let explained = place.windows.iter().filter(|w| w.unexplained.is_none());
    let count = explained.clone().count();
    let windows = explained.map(|w| {
        let when = format!("{} to {} s", short(w.from), short(w.to));
        let [run, when, size] = cells([w.run.clone(), when, short(w.z)]);
        [run, when, code(&w.equation), size]
    });
    let regions = place.region.iter().map(|r| {
        let [range, size] = cells([r.description.clone(), short(r.z)]);
        [code(&r.variable), range, size]
    });
    html! {
        @if count > 0 {
            details {
                summary { (count) (if count == 1 { " window" } else { " windows" }) " with a significant gap" }
                (table(["run", "when", "equation of", "size in deviations"], windows, 3))
            }
        }
        @if !place.region.is_empty() {
            (table(["depends on", "where", "size in deviations"], regions, 2))
        }
    }
}

fn hypotheses(report: &Report, list: &[&Hypothesis]) -> Markup {
    let rows = list.iter().map(|hypothesis| {
        let name = match hypothesis.effects.first().map(String::as_str) {
            None => html! { "no effect: the model with its parameters within tolerance" },
            Some("unknown") => {
                let beside = said(report, hypothesis);
                let beside = beside.split_once(" in addition to ").map(|(_, effects)| code(effects));
                html! { "none of the library" @if let Some(effects) = beside { ", in addition to " (effects) } }
            }
            Some(_) => code(&joined(&hypothesis.effects)),
        };
        let sizes = values(hypothesis);
        let bayes = hypothesis.log_bayes_factor.map_or_else(String::new, short);
        let probability = match &hypothesis.same_as {
            Some(_) => html! { span class="faint" { "the same" } },
            None => bar(hypothesis.probability),
        };
        [
            probability,
            html! { (name) br; (separated(&sizes, |size| html! { (size) }, &html! { br; })) },
            html! { (bayes) },
        ]
    });
    let heading = [
        "probability",
        "hypothesis, values ± 95 %",
        "log Bayes factor",
    ];
    table(heading, rows, 2)
}

fn which(report: &Report) -> Markup {
    let is_told =
        |hypothesis: &&Hypothesis| hypothesis.probability >= TOLD || hypothesis.same_as.is_some();
    let (told, others): (Vec<&Hypothesis>, Vec<&Hypothesis>) =
        report.which.iter().partition(is_told);
    html! {
        h2 { "Which" }
        (hypotheses(report, &told))
        @if !others.is_empty() {
            details {
                summary { (others.len()) " of less than " (percent(TOLD)) }
                (hypotheses(report, &others))
            }
        }
        @for doubt in doubts(report) {
            p { b { "A unit?" } " " (capitalised(&doubt.replace('`', ""))) }
        }
        @for group in &report.tied {
            p {
                b { "Tied." } " These recordings cannot tell "
                (separated(group, |effects| code(&joined(effects)), &html! { " and " }))
                " apart."
            }
        }
        // A measured law has its own section.
        @if let Some(left) = report.left.as_ref().filter(|left| left.is_there() && report.law.is_none()) {
            p {
                b { "Left." } " In addition to the first hypothesis, the recordings support "
                (left.about) " (log Bayes factor " (short(left.log_bayes_factor)) ")."
            }
        }
        (law(report))
        @if !report.failed.is_empty() {
            details {
                @let fits = if report.failed.len() == 1 { "fit" } else { "fits" };
                summary { (report.failed.len()) " " (fits) " did not converge" }
                ul {
                    @for (effects, reason) in &report.failed {
                        li { (code(&joined(effects))) ": " (reason) }
                    }
                }
            }
        }
    }
}

fn how_far(report: &Report) -> Markup {
    let Some(far) = &report.how_far else {
        return html! {
            h2 { "How far" }
            p { "No run was held out, so the closed part of the gap cannot be assessed." }
        };
    };
    if report.is_by_forces {
        return by_forces(report, far);
    }
    let rows = report.horizons.iter().map(|ahead| {
        let floor = ahead.noise_floor.map_or_else(|| "–".to_owned(), short);
        let [nominal, refitted, effect] =
            [ahead.nominal, ahead.refitted, ahead.with_effect].map(short);
        cells([horizon(ahead.horizon), nominal, refitted, effect, floor])
    });
    let heading = [
        "ahead",
        "as stated",
        "parameters re-fitted",
        "with the effect",
        "noise floor",
    ];
    html! {
        h2 { "How far" }
        (closed(far))
        (table(heading, rows, 1))
        p class="faint" {
            "Root mean square error of predictions, in units of the noise. The floor is what the filter \
             expects if the hypothesis is right."
        }
        (traces(report, |trace| format!(
            "{} of {} (held out): measurement, prediction {AHEAD} s ahead, and prediction error. The band shows two \
             standard deviations of the error expected if the hypothesis is true.",
            trace.column, trace.run,
        )))
        @if !report.disturbances.is_empty() {
            p {
                "Disturbance that the filter needs to follow the recordings: an effect that is missing \
                 shows as disturbance."
            }
            (disturbances(report, ["equation of", "without the effect", "with it"]))
        }
    }
}

/// The channels whose predictions change most, with their captions.
pub(super) fn traces(report: &Report, caption: impl Fn(&Trace) -> String) -> Markup {
    let traces = report.pictures.iter().flat_map(|pictures| &pictures.traces);
    html! {
        @for trace in plots::most_bettered(traces) {
            (figure(plots::trace(trace).concat(), &caption(trace)))
        }
    }
}

/// Disturbances, or missing forces, before and after.
pub(super) fn disturbances(report: &Report, heading: [&str; 3]) -> Markup {
    let rows = report.disturbances.iter().map(|(name, before, after)| {
        let [before, after] = cells([*before, *after].map(short));
        [code(name), before, after]
    });
    table(heading, rows, 1)
}

fn closed(far: &HowFar) -> Markup {
    html! {
        p {
            (short(far.horizon_s)) " s ahead the RMS prediction error, in units of the noise, falls from "
            (short(far.nominal)) " to " (short(far.with_effect)) " (noise floor "
            (short(far.noise_floor)) "). "
            (closes(far))
        }
    }
}

/// Recommended actions.
fn next(set: &DataSet, report: &Report) -> Markup {
    html! {
        h2 { "Next" }
        p { (in_sentences(&Headline::of(report).change)) }
        @if report.verdict == GapVerdict::NoGap && !report.detectable.is_empty() {
            p { "The table below tells how small an effect these recordings would have shown." }
        }
        @if let Some(experiment) = &report.experiment {
            @let [first, second] = experiment.separates.each_ref().map(|side| code(&joined(side)));
            p {
                "This experiment tells " (first) " from " (second) ": " (experiment.about)
                ". The two are " (short(experiment.separation_now)) " standard deviations apart now, and "
                (short(experiment.separation_then)) " with its recording. The input is also written \
                 as a table, where a file is given for it or for the gap report."
            }
            @for plot in plots::experiment(experiment, &set.mechanism) {
                (figure(plot, "The input of the next experiment."))
            }
        } @else if report.verdict == GapVerdict::Ambiguous && !report.tied.is_empty() {
            p {
                "None of the inputs tried separates the tied hypotheses within the limits of the motion. Widen \
                 the limits, or record under feedback."
            }
        }
    }
}

fn detectable(report: &Report) -> Markup {
    let rows = report.detectable.iter().map(|limit| {
        let [smallest] = cells([with_unit(&short(limit.smallest), &limit.unit)]);
        [code(&limit.effect), smallest]
    });
    html! {
        @if !report.detectable.is_empty() {
            h2 { "What these recordings would show" }
            details open[report.verdict == GapVerdict::NoGap] {
                summary {
                    "The smallest size of each effect that would be found with near certainty"
                }
                (table(["effect", "smallest size"], rows, 1))
            }
        }
    }
}

fn recordings(set: &DataSet, report: &Report) -> Markup {
    let rows = set.runs.iter().map(|run| {
        let part = match run.part {
            Part::Fit => "training",
            Part::Test => "held out",
        };
        let length = format!("{} s", short(run.duration()));
        let rows = run.times.len().to_string();
        cells([run.name.clone(), part.to_owned(), rows, length])
    });
    html! {
        h2 { "Recordings" }
        (table(["run", "used", "rows", "length"], rows, 2))
        @if let Some(rows) = left_out(report) {
            p class="faint" { (rows) "." }
        }
        @for line in crate::recording::sentences(&set.findings) {
            p class="faint" { (line) }
        }
    }
}

/// The section of the page.
pub(super) fn by_forces(report: &Report, far: &HowFar) -> Markup {
    html! {
        h2 { "How far" }
        p {
            "The RMS of the forces that the model misses on the held-out runs falls from "
            (short(far.nominal)) " to " (short(far.with_effect)) " times their noise. "
            (closes(far))
        }
        p class="faint" {
            "Forces that the recorded motions take by the model, M ω̇ + b − Π with splines through the coordinates, are \
             compared with those of the recorded inputs. No motion is simulated."
        }
        (traces(report, |trace| format!(
            "Equation of {} in {} (held out): force of the inputs, force that the motion takes by each model, and \
             the difference. The band shows two standard deviations of what is left of the training runs.",
            trace.column, trace.run,
        )))
        p { "RMS of the missing forces in the training runs, in SI units." }
        (disturbances(report, ["equation of", "parameters re-fitted", "with the effect"]))
    }
}

/// The lines of a summary.
pub fn left_of_forces(far: &HowFar) -> String {
    let [nominal, refitted, effect] = [far.nominal, far.refitted, far.with_effect].map(short);
    format!(
        "forces missed on held-out runs, relative to their noise: nominal {nominal}, re-fitted {refitted}, with \
         effect {effect}"
    )
}
