//! A stability chart as a map, with its boundaries as curves.

use appell_analysis::{Boundary, Cell, Chart, Verdict};
use appell_report::figure::{Curve, Map, Series, Stroke};

use super::export::in_words;

/// Kinds of grid points.
const KINDS: [&str; 6] = [
    in_words(Verdict::Asymptotic),
    in_words(Verdict::Neutral),
    in_words(Verdict::Unstable),
    "not feasible",
    "stable and unstable",
    "several stable",
];

/// Label and unit of an axis.
pub struct Shown {
    /// Its name and unit.
    pub label: String,
    /// Factor from SI to that unit.
    pub scale: f64,
}

/// The map of a chart; its legend lists the kinds that occur.
pub fn map(title: &str, chart: &Chart, axes: [Shown; 2]) -> Map {
    let cells: Vec<Option<usize>> = chart.cells.iter().map(|cells| kind(cells)).collect();
    let name = |(kind, name): (usize, &&str)| {
        let occurs = cells.contains(&Some(kind));
        if occurs {
            (*name).to_owned()
        } else {
            String::new()
        }
    };
    let scales = [axes[0].scale, axes[1].scale];
    let ranges = [0, 1].map(|k: usize| chart.axes[k].range.map(|value| value * scales[k]));
    Map {
        title: title.to_owned(),
        ranges,
        labels: axes.map(|axis| axis.label),
        counts: chart.axes.map(|axis| axis.count),
        kinds: KINDS.iter().enumerate().map(name).collect(),
        curves: borders(chart, scales),
        cells,
    }
}

/// The kind of a grid point, from its feasible motions.
fn kind(cells: &[Cell]) -> Option<usize> {
    let feasible = || cells.iter().filter(|cell| cell.feasible);
    let unstable = feasible().filter(|cell| cell.verdict == Verdict::Unstable);
    match (feasible().count(), unstable.count()) {
        (0, _) if cells.is_empty() => None,
        (0, _) => Some(3),
        (all, unstable) if unstable == all => Some(2),
        (_, 1..) => Some(4),
        (2.., _) => Some(5),
        _ if feasible().any(|cell| cell.verdict == Verdict::Asymptotic) => Some(0),
        _ => Some(1),
    }
}

/// Stability boundaries, and thin limits of feasibility.
fn borders(chart: &Chart, scales: [f64; 2]) -> Vec<Curve> {
    let curve = |label: &str, points: &[[f64; 2]], stroke| Curve {
        line: Series {
            label: label.to_owned(),
            x: points.iter().map(|at| at[0] * scales[0]).collect(),
            y: points.iter().map(|at| at[1] * scales[1]).collect(),
        },
        stroke,
    };
    let deciding = chart.boundaries.iter().flat_map(Boundary::deciding);
    let first = |number: usize, label| if number == 0 { label } else { "" };
    let boundaries = deciding
        .enumerate()
        .map(|(k, part)| curve(first(k, "stability boundary"), part, Stroke::Solid));
    let edges = chart.edges.iter().enumerate();
    let edges =
        edges.map(|(k, edge)| curve(first(k, "limit of feasibility"), &edge.points, Stroke::Thin));
    boundaries.chain(edges).collect()
}
