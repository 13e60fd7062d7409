//! Figure 6: stability of the turning motions for eight sliding masses.

use appell_analysis::{Cell, Verdict};

use super::figure_3::unstable;
use super::figure_5::{farthest_from_41, turning_motions};
use crate::book::steady_motions::{Mechanism, WHEEL_MASS, shown};
use crate::book::{Part, Result, Section};
use appell::steady::regions;

/// In kg. Without it, the unicycle is the rolling wheel.
const MASSES: [f64; 8] = [0.0, 1.0, 2.0, 5.0, 10.0, 15.0, 20.0, 30.0];

/// A chart for each mass.
pub(super) fn section(grid: usize) -> Result<Section> {
    let mut part = Part::read(include_str!("figure_6.toml"))?;
    for mass in MASSES {
        part.set("mass", mass);
        part.set("ratio", mass / WHEEL_MASS);
        chart(&mut part, mass, grid)?;
    }
    part.found("without_mass", "computed with the rolling wheel", true)?;
    Ok(part.section())
}

fn chart(part: &mut Part, mass: f64, grid: usize) -> Result<()> {
    let with_mass = mass > 0.0;
    let (name, given, least) = if with_mass {
        ("unicycle", vec![("m0", mass)], vec![("z_A", 0.0)])
    } else {
        ("rolling_wheel", Vec::new(), Vec::new())
    };
    let mechanism = Mechanism::shipped(name)?;
    let chart = turning_motions(mechanism, grid, &given, &least)?;
    let worst = if with_mass {
        farthest_from_41(mechanism, &chart, mass)?
    } else {
        0.0
    };
    let found: Vec<&Cell> = chart.cells.iter().flatten().collect();
    let wrong = found.iter().filter(|cell| disagrees(cell)).count();
    let cells = chart.cells.iter();
    let unstable: usize = cells.map(|cells| unstable(cells)).sum();
    let stable = found.len() - unstable;
    let infeasible = found.iter().filter(|cell| !cell.feasible).count();
    let ours = format!(
        "{} motions on {} grid points: {stable} stable, {unstable} unstable; {infeasible} of them not feasible. Place of \
         the mass within {worst:.0e} of (41); {wrong} verdicts that contradict (49)",
        found.len(),
        chart.cells.len(),
    );
    let enough = found.len() * 100 > chart.cells.len() * 90;
    let holds = worst < 1e-6 && wrong == 0 && enough && stable > 0 && unstable > 0;
    part.found(name, ours, holds)?;
    let axes = ["theta", "psi_dot"].map(shown);
    let map = regions::map(&format!("m₀ = {mass} kg"), &chart, axes);
    part.picture("map", map.to_svg())
}

/// Whether the verdict contradicts the roots q = λ² of (49): stable where they are real and negative.
fn disagrees(cell: &Cell) -> bool {
    /// Fraction of the largest root within which the boundary lies.
    const NEAR: f64 = 1e-4;
    let squares: Vec<_> = cell.eigenvalues.iter().map(|z| z * z).collect();
    let sizes = squares.iter().map(|q| q.norm());
    let near = NEAR * sizes.fold(f64::MIN_POSITIVE, f64::max);
    let grows = squares.iter().any(|q| q.re > near || q.im.abs() > near);
    let border = squares.iter().any(|q| q.norm() < near);
    !border && grows != (cell.verdict == Verdict::Unstable)
}
