//! A gap report as text.

use std::fmt::Write as _;
use std::path::Path;

use appell::fleet::Rig;
use appell_gap::diagnose::{Ahead, Experiment, GapVerdict, Hypothesis, Report};

use appell_report::gap::{
    Headline, before_sentence, divided, doubts, events, hints, is_determined, joined, law_sentence,
    left_of_forces, left_out, percent, ranges, said, share, short,
};
use appell_report::row;
use appell_report::text::number;

/// Widest cell of a table that others are aligned with.
const WIDEST: usize = 60;
/// Number of hypotheses in the summary.
const LISTED: usize = 3;

/// Fits that did not converge, if they may have changed the verdict.
fn failures(text: &mut String, report: &Report) {
    let is_listed = |effects: &[String]| {
        let mut listed = report.which.iter().take(LISTED);
        listed.any(|one| one.effects == effects)
    };
    let shows_failures = report.verdict == GapVerdict::Unexplained
        || report.failed.iter().any(|(effects, _)| is_listed(effects));
    if shows_failures && !report.failed.is_empty() {
        let names: Vec<String> = (report.failed.iter().take(LISTED))
            .map(|(effects, _)| joined(effects))
            .collect();
        let _ = writeln!(
            text,
            "  failed    {} {} not converge, among them {}; see the gap report for the reasons",
            report.failed.len(),
            if report.failed.len() == 1 {
                "fit did"
            } else {
                "fits did"
            },
            names.join(", ")
        );
    }
}

/// The summary, about ten lines; the commands `apply` write the diagnosed effect into the spec.
pub(crate) fn text(report: &Report, next: Option<&Path>, apply: &[String]) -> String {
    let mut text = String::new();
    let Headline {
        cause,
        sizes,
        refit,
        change,
        applied,
        error,
    } = Headline::of(report);
    // Writing to a string cannot fail.
    let _ = writeln!(text, "{}: {cause}", report.mechanism);
    if !sizes.is_empty() {
        let _ = writeln!(text, "  size      {} (± 95 %)", sizes.join(", "));
    }
    if !refit.is_empty() {
        let _ = writeln!(text, "  refit     without effects: {}", refit.join(", "));
    }
    let _ = writeln!(text, "  change    {}", change.join("\n            "));
    if let Some(number) = applied {
        let _ = write!(text, "            {}", apply.join("\n            "));
        if number > 1 {
            let _ = write!(text, " --hypothesis {number}");
        }
        text.push('\n');
    }
    if let Some(error) = error {
        let _ = writeln!(text, "  error     {error}");
    }
    if let Some(change) = &report.change {
        let _ = writeln!(text, "  before    {}", before_sentence(change));
    }
    if !report.place.equations.is_empty() {
        let shares: Vec<String> = report
            .place
            .equations
            .iter()
            .filter(|equation| equation.share >= 0.05)
            .map(|e| format!("{} {:.0} %", e.name, 100.0 * e.share))
            .collect();
        let _ = writeln!(
            text,
            "  where     {} ({})",
            report.place.domain,
            shares.join(", ")
        );
    }
    for hypothesis in report.which.iter().take(LISTED) {
        let _ = writeln!(text, "  which     {}", line(report, hypothesis));
    }
    for doubt in doubts(report) {
        let _ = writeln!(text, "  unit?     {doubt}");
    }
    // Equivalent hypotheses are no rivals.
    let is_rival = |effects: &&Vec<String>| {
        let mut which = report.which.iter();
        which.any(|one| one.effects == **effects && one.same_as.is_none())
    };
    let tied = report.tied.iter();
    for group in tied.filter(|group| group.iter().filter(is_rival).count() > 1) {
        let names: Vec<String> = group.iter().map(|effects| joined(effects)).collect();
        let _ = writeln!(text, "  tied      {}", names.join(" | "));
    }
    for hint in hints(report) {
        let _ = writeln!(text, "  hint      {hint}");
    }
    if let Some(events) = events(report) {
        let _ = writeln!(text, "  events    {events}");
    }
    if let Some(law) = law_sentence(report) {
        let _ = writeln!(text, "  left      {law}");
    } else if let Some(left) = report.left.as_ref().filter(|left| left.is_there()) {
        let _ = writeln!(text, "  left      {}", left.about);
    }
    failures(&mut text, report);
    if let Some(experiment) = &report.experiment {
        let _ = writeln!(text, "  next      {}", experiment_sentence(experiment));
    }
    if let Some(path) = next {
        let _ = writeln!(text, "            written to {}", path.display());
    }
    if let Some(rows) = left_out(report) {
        let _ = writeln!(text, "  rows      {rows}");
    }
    text += &how_far(report);
    let levels: Vec<String> = report
        .disturbances
        .iter()
        .map(|(name, before, after)| format!("{name} {} -> {}", number(*before), number(*after)))
        .collect();
    if !levels.is_empty() {
        let what = if report.is_by_forces {
            "missing forces (rms)"
        } else {
            "process noise"
        };
        let _ = writeln!(
            text,
            "  {what}, nominal -> with the effect: {}",
            levels.join(", ")
        );
    }
    text
}

/// The table of several rigs.
pub(crate) fn table(rigs: &[Rig], reports: &Path) -> String {
    let mut rows = vec![row!["rig", "verdict", "which", "P", "closed", "budget"]];
    rows.extend(rigs.iter().map(|rig| match &rig.outcome {
        Ok(report) => {
            let (first, probability) = report.first();
            let closed = report.how_far.as_ref().and_then(|far| far.closed);
            row![
                rig.name,
                report.verdict.replace('_', " "),
                first,
                format!("{:.1} %", 100.0 * probability),
                closed.map_or_else(|| "-".to_owned(), |c| format!("{:.1} %", 100.0 * c)),
                report.budget()
            ]
        }
        Err(reason) => {
            let reason = reason.lines().next().unwrap_or_default();
            row![rig.name, "error", reason, "", "", ""]
        }
    }));
    let wide = |column: usize| {
        let cells = rows.iter().map(|row| row[column].chars().count());
        // An error spans the columns that follow.
        cells.filter(|&cells| cells <= WIDEST).max().unwrap_or(0)
    };
    let widths: Vec<usize> = (0..6).map(wide).collect();
    let mut text = String::new();
    for row in &rows {
        let cells = row
            .iter()
            .zip(&widths)
            .map(|(cell, &width)| format!("{cell:width$}"));
        let line = cells.collect::<Vec<_>>().join("  ");
        text += line.trim_end();
        text.push('\n');
    }
    let known = rigs.iter().filter(|rig| rig.is_known).count();
    let failed = rigs.iter().filter(|rig| rig.outcome.is_err()).count();
    // Writing to a string cannot fail.
    let _ = writeln!(
        text,
        "{} rigs, {known} of them known from before, {failed} without a diagnosis; reports in {}",
        rigs.len(),
        reports.display()
    );
    text
}

/// Prediction errors, and the share of the gap that closes.
fn how_far(report: &Report) -> String {
    let Some(far) = &report.how_far else {
        return "  how far   no run was held out\n".to_owned();
    };
    let mut text = if report.is_by_forces {
        format!("  how far   {}\n", left_of_forces(far))
    } else {
        format!(
            "  how far   error {} s ahead: nominal {}, re-fitted {}, with effect {}, floor {} (relative to the \
             noise)\n",
            short(far.horizon_s),
            short(far.nominal),
            short(far.refitted),
            short(far.with_effect),
            short(far.noise_floor),
        )
    };
    let is_other = |ahead: &&Ahead| {
        let is_finite = ahead.horizon > 0.0 && ahead.horizon.is_finite();
        is_finite && (ahead.horizon - far.horizon_s).abs() > 1e-9
    };
    // Writing to a string cannot fail.
    for ahead in report.horizons.iter().filter(is_other) {
        let _ = writeln!(
            text,
            "            {} s ahead: nominal {}, re-fitted {}, with effect {}",
            short(ahead.horizon),
            short(ahead.nominal),
            short(ahead.refitted),
            short(ahead.with_effect),
        );
    }
    let _ = if is_determined(far.closed, far.closed_ci95) {
        let closed = share(far.closed, far.closed_ci95);
        let refitted = percent(far.closed_vs_refitted);
        writeln!(
            text,
            "            closed {closed} of the gap; of the gap that re-fitted parameters leave, {refitted}"
        )
    } else {
        let [low, high] = far.closed_ci95.map(percent);
        writeln!(
            text,
            "            the closed share is not determined: the held-out runs leave it between {low} and {high}"
        )
    };
    if let Some(parts) = divided(report) {
        let _ = writeln!(text, "  budget    {parts}");
    }
    if report.verdict != GapVerdict::NoGap && far.closed_ci95[0] <= 0.0 {
        text.push_str(
            "            no significant improvement on held-out runs: the interval leaves it open whether anything \
             closes\n",
        );
    }
    text
}

fn line(report: &Report, hypothesis: &Hypothesis) -> String {
    let probability = match &hypothesis.same_as {
        Some(_) => "the same".to_owned(),
        None => format!("{:6.1} %", 100.0 * hypothesis.probability),
    };
    format!(
        "{probability}  {}  {}",
        said(report, hypothesis),
        ranges(hypothesis).join(", ")
    )
}

/// The proposed experiment as a sentence.
fn experiment_sentence(experiment: &Experiment) -> String {
    let seconds = experiment.times.last().copied().unwrap_or(0.0);
    format!(
        "{} for {} s: would separate the first two by {} sigma (now {})",
        experiment.about,
        short(seconds),
        short(experiment.separation_then),
        short(experiment.separation_now),
    )
}
