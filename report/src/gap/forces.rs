//! The share of the gap that closes, judged by the forces of recorded motions.

use appell_gap::diagnose::{HowFar, Report};
use maud::{Markup, html};

use super::budget::closes;
use super::elements::{code, figure, table};
use super::plots;
use super::short;

/// The section of the page.
pub(super) fn how_far(report: &Report, far: &HowFar) -> Markup {
    let left = report.disturbances.iter().map(|(name, before, after)| {
        [
            code(name),
            html! { (short(*before)) },
            html! { (short(*after)) },
        ]
    });
    let traces = report.pictures.iter().flat_map(|pictures| &pictures.traces);
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
        @for trace in plots::most_bettered(traces) {
            @let caption = format!(
                "Equation of {} in {} (held out): force of the inputs, force that the motion takes by each model, and \
                 the difference. The band shows two standard deviations of what is left of the training runs.",
                trace.column,
                trace.run,
            );
            (figure(plots::trace(trace).concat(), &caption))
        }
        p { "RMS of the missing forces in the training runs, in SI units." }
        (table(["equation of", "parameters re-fitted", "with the effect"], left, 1))
    }
}

/// The lines of a summary.
pub fn left_of_forces(far: &HowFar) -> String {
    format!(
        "forces missed on held-out runs, relative to their noise: nominal {}, re-fitted {}, with effect {}",
        short(far.nominal),
        short(far.refitted),
        short(far.with_effect),
    )
}
