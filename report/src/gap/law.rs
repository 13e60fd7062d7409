//! A measured law: a figure with its band, the closest analytic forms, and a sentence.

use appell_gap::diagnose::{Hypothesis, Law, Report, Share};
use maud::{Markup, html};

use super::elements::{cells, code, figure, table};
use super::numbers::{percent, share};
use crate::figure::{Layer, Look, Plot};
use crate::text::short;

/// Standard deviations to both sides of the band.
const BAND: f64 = 2.0;

/// `depends on theta; measured, it closes 90 % [85 %, 100 %]; as sin(12*theta + phase) (98 % of it)`, where there
/// is a law.
pub fn law_sentence(report: &Report) -> Option<String> {
    let law = report.law.as_ref()?;
    let closes = part_of_law(report).map(|part| {
        let closed = share(part.closed, part.interval);
        if part.closed > 0.0 {
            format!("; measured, it closes {closed} of the gap")
        } else {
            "; measured, it does not better predictions of held-out runs".to_owned()
        }
    });
    let form = law.forms.first();
    let form = form.map(|form| format!("; {} is {} of it", form.text, percent(form.share)));
    let [closes, form] = [closes, form].map(Option::unwrap_or_default);
    let (equation, depends_on) = (&law.equation, &law.depends_on);
    Some(format!(
        "a force in the equation of {equation} that depends on {depends_on}{closes}{form}"
    ))
}

/// The number of the hypothesis with which `appell apply` writes the measured law, if it does and the law does not
/// make predictions worse.
pub(super) fn written(report: &Report) -> Option<usize> {
    let betters = part_of_law(report).is_none_or(|part| part.closed > 0.0);
    report.law.as_ref().filter(|_| betters)?;
    let holds = |one: &Hypothesis| {
        let changes = one.changes.as_ref();
        one.is_unknown() && changes.is_some_and(|changes| !changes.items.trim().is_empty())
    };
    Some(report.which.iter().position(holds)? + 1)
}

/// The part that the measured law closes.
pub(super) fn part_of_law(report: &Report) -> Option<&Share> {
    let far = report.how_far.as_ref()?;
    far.budget.iter().find(|part| part.is_law())
}

/// The section of the page.
pub(super) fn law(report: &Report) -> Markup {
    let Some(law) = &report.law else {
        return html! {};
    };
    let rows = law.forms.iter().map(|form| {
        let [share, bayes] = cells([percent(form.share), short(form.log_bayes_factor)]);
        [code(&form.text), share, bayes]
    });
    html! {
        h3 { "The force that nothing in the library explains" }
        @if let Some(sentence) = law_sentence(report) {
            p {
                "It is " (sentence) "."
                " " code { "appell apply" }
                @match written(report) {
                    Some(1) => { " writes it into the spec." }
                    Some(number) => { ", given hypothesis " (number) ", writes it into the spec." }
                    None => { " does not write it." }
                }
            }
        }
        (figure(curve(law), "The law and its band of two standard deviations, found in the training runs. Elsewhere \
                             it is not known."))
        @if !law.forms.is_empty() {
            (table(["form, up to factors", "share of the law", "log Bayes factor"], rows, 1))
        }
    }
}

fn curve(law: &Law) -> String {
    let curve = law.curve.iter();
    let x: Vec<f64> = curve.clone().map(|[x, ..]| *x).collect();
    let at = |deviations: f64| -> Vec<f64> {
        let values = curve.clone();
        values
            .map(|[_, force, std]| force + deviations * std)
            .collect()
    };
    let force = match &law.factor {
        Some(factor) => format!("force over {factor}"),
        None => "force".to_owned(),
    };
    let plot = Plot {
        labels: [
            format!("{} [{}]", law.variable, law.variable_unit),
            format!("{force}, equation of {} [{}]", law.equation, law.unit),
        ],
        height: 260.0,
        layers: vec![
            Layer::new("95 % band", Look::Band(at(BAND)), 2, &x, at(-BAND)),
            Layer::new("measured law", Look::Line, 0, &x, at(0.0)),
        ],
    };
    plot.to_svg()
}
