//! Every numbered equation.

use appell_recordings::motion_capture::Axes;

use crate::book::equations::{misprint, typed};
use crate::book::{Part, Result, Section};
use crate::errata::{ERRATA, Source};
use crate::euc::EQUATIONS;

use super::laboratory::Laboratory;

/// Rounding of products of sines and cosines.
const ROUNDING: f64 = 1e-14;

pub(super) fn section(_: &Laboratory) -> Result<Section> {
    let mut part = Part::read(include_str!("equations.toml"))?;
    let off = transformations();
    let ours = format!("the axes of the moving frame differ by {off:.0e}");
    part.found("transformations", ours, off < ROUNDING)?;
    part.define("put to use in");
    part.claims.extend(EQUATIONS.iter().map(typed));
    let errata = ERRATA
        .iter()
        .filter(|erratum| erratum.source == Source::Euc);
    part.claims.extend(errata.map(misprint));
    Ok(part.section())
}

/// (1) and (2), compared with the axes that the pipeline uses.
fn transformations() -> f64 {
    let (psi, theta): (f64, f64) = (0.7, -0.3);
    let (s, c, u, d) = (psi.sin(), psi.cos(), theta.sin(), theta.cos());
    // T_ψ T_ϑ, column by column.
    let typed = [[c, s, 0.0], [-s * d, c * d, u], [s * u, -c * u, d]];
    let axes = Axes::turned([psi, theta, 0.0]);
    let used = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]].map(|unit| axes.to_ground(unit));
    let pairs = used.as_flattened().iter().zip(typed.as_flattened());
    pairs
        .map(|(used, typed)| (used - typed).abs())
        .fold(0.0, f64::max)
}
