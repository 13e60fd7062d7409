//! The share of the gap that closes, judged by the forces of recorded motions.

use appell_gap::diagnose::{HowFar, Report};
use maud::{Markup, html};

use super::budget::closes;
use super::page::{disturbances, traces};
use super::short;

/// The section of the page.
pub(super) fn how_far(report: &Report, far: &HowFar) -> Markup {
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
