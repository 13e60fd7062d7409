//! How the gap divides, as a table and as a sentence.

use appell_gap::diagnose::{HowFar, Report, Share};
use maud::{Markup, html};

use super::elements::{bare_bar, code, table};
use super::numbers::{is_determined, percent, share};

/// `coulomb_friction@theta 66 % [24 %, 77 %], ... ; 8 % [4 %, 9 %] stays`, the largest part first; `None` where no
/// run was held out, or where these do not determine the shares.
pub fn divided(report: &Report) -> Option<String> {
    let far = report.how_far.as_ref();
    let far = far.filter(|far| is_determined(far.closed, far.closed_ci95))?;
    let (stays, mut parts): (Vec<&Share>, Vec<&Share>) =
        far.budget.iter().partition(|part| part.is_rest());
    parts.sort_by(|a, b| b.closed.total_cmp(&a.closed));
    let all = parts.into_iter().chain(stays).map(|part| {
        let closed = share(part.closed, part.interval);
        match (part.is_rest(), part.is_material) {
            (true, _) => format!("{closed} stays"),
            (false, true) => format!("{} {closed}", name(part)),
            (false, false) => format!("{} {closed} (immaterial)", name(part)),
        }
    });
    all.reduce(|all, one| format!("{all}, {one}"))
}

/// Display name of a part.
fn name(part: &Share) -> &str {
    if part.is_refit() {
        "re-fitted parameters"
    } else if part.is_rest() {
        "what stays"
    } else if part.is_law() {
        "measured law"
    } else {
        &part.name
    }
}

/// The table, with a bar for each part.
pub(super) fn budget(report: &Report, far: &HowFar) -> Markup {
    let rows = far.budget.iter().map(|part| {
        let added = !(part.is_refit() || part.is_rest());
        [
            html! { @if part.is_effect() { (code(name(part))) } @else { (name(part)) } },
            bare_bar(part.closed),
            html! {
                (share(part.closed, part.interval))
                @if part.is_refit() && far.refitted > far.nominal {
                    span class="faint" { " worse than as stated: no base" }
                }
                @if added && !part.is_material { span class="faint" { " immaterial" } }
            },
        ]
    });
    html! {
        @if !far.budget.is_empty() && is_determined(far.closed, far.closed_ci95) {
            (table(["part", "of the gap", "share, with 95 % interval"], rows, 2))
            p class="faint" {
                @if report.is_by_forces { "Shares of the mean square of the missing forces" } @else {
                    "Shares of the mean square prediction error " (far.horizon_s) " s ahead"
                }
                " on the held-out runs, beyond the noise. The share of an effect is the mean over all orders in which the effects can be added."
                @if far.budget.iter().any(is_against_others) {
                    " A share below zero: together with the others the effect makes predictions worse."
                }
            }
        }
    }
}

/// How far the gap closes on the held-out runs.
pub(super) fn closes(far: &HowFar) -> Markup {
    let [low, high] = far.closed_ci95.map(percent);
    html! {
        @if is_determined(far.closed, far.closed_ci95) {
            "Of the gap of the model as stated " b { (percent(far.closed)) } " closes, with 95 % between " (low) " and "
            (high) "; of the gap that re-fitted parameters leave, " b { (percent(far.closed_vs_refitted)) } ". "
        } @else {
            "The held-out runs leave it open what closes: between " (low) " and " (high) ". "
        }
        "Runs: " (far.runs.join(", ")) "."
    }
}

/// Whether a part makes predictions significantly worse.
fn is_against_others(part: &Share) -> bool {
    part.is_effect() && part.interval[1] < 0.0
}
