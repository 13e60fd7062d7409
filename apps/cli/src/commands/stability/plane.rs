//! `appell stability --chart`: a stability chart over two quantities.

use std::fmt::Write as _;
use std::str::FromStr;

use appell_analysis::{Axis, Chart, Verdict};
use appell_report::figure::Map;

use super::StabilityCommand;
use crate::failure::Error;
use crate::motions::text;
use crate::progress;
use appell::Field;
use appell::setup::{Setup, listed};
use appell::steady::regions::{self, Shown};
use appell::steady::{Resolved, Span, chart};

/// `X=FROM..TO,Y=FROM..TO` as it was given.
#[derive(Debug, Clone)]
pub(super) struct Plane([Span; 2]);

impl FromStr for Plane {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let &[x, y] = &listed(text)[..] else {
            return Err(
                "write X=FROM..TO,Y=FROM..TO, such as theta=-30deg..30deg,psi_dot=1..8".to_owned(),
            );
        };
        Ok(Self([Span::from_str(x)?, Span::from_str(y)?]))
    }
}

/// `NxM` as it was given.
#[derive(Debug, Clone, Copy)]
pub(super) struct Grid([usize; 2]);

impl FromStr for Grid {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let parts = text
            .split_once(['x', '×'])
            .ok_or("write NxM, such as 400x400")?;
        let count = |part: &str| {
            part.trim()
                .parse()
                .map_err(|_| format!("`{part}` is no number"))
        };
        Ok(Self([count(parts.0)?, count(parts.1)?]))
    }
}

impl Plane {
    /// The axes in SI.
    pub(super) fn axes(&self, setup: &Setup<'_>, grid: Grid) -> Result<[Axis; 2], Error> {
        let axis = |k: usize| {
            let (term, range) = self.0[k].resolve(setup, Field::Chart)?;
            let count = grid.0[k];
            Ok::<_, Error>(Axis { term, range, count })
        };
        Ok([axis(0)?, axis(1)?])
    }
}

impl StabilityCommand {
    /// Computes the chart, prints a summary and writes its files.
    pub(super) fn draw(&self, asked: &Resolved<'_>, axes: &[Axis; 2]) -> Result<(), Error> {
        let chart = progress::during("computing the chart", |_| asked.chart(*axes))?;
        self.question.write(
            asked,
            &text(asked, &chart),
            || appell::json::chart(asked, &chart),
            |to| chart::csv(asked, &chart, to),
            || Some(map(asked, &chart).to_svg()),
        )
    }
}

/// The number of motions, and the boundaries with their turning points.
fn text(asked: &Resolved<'_>, chart: &Chart) -> String {
    let info = asked.problem.model().info();
    let quantities = chart.axes.map(|axis| axis.term.quantity(info));
    let found = chart.cells.iter().flatten();
    let count = |verdict: Verdict| found.clone().filter(|cell| cell.verdict == verdict).count();
    let mut text = format!(
        "{} steady motions at {} grid points: {} asymptotically stable, {} neutrally stable, {} \
        unstable; {} points without a motion, {} with several\n",
        found.clone().count(),
        chart.cells.len(),
        count(Verdict::Asymptotic),
        count(Verdict::Neutral),
        count(Verdict::Unstable),
        chart.cells.iter().filter(|cells| cells.is_empty()).count(),
        chart.cells.iter().filter(|cells| cells.len() > 1).count(),
    );
    for boundary in &chart.boundaries {
        let role = match boundary.deciding().count() {
            0 => "inside the unstable region",
            _ if boundary.decides.contains(&false) => "boundary, on parts of the curve",
            _ => "boundary",
        };
        // Writing to a string cannot fail.
        let _ = writeln!(text, "{role}: {}", text::change_text(boundary.change));
        for fold in &boundary.folds {
            let value = quantities[fold.axis].to_unit(fold.at[fold.axis]);
            let other = 1 - fold.axis;
            let _ = writeln!(
                text,
                "  turns back at {} = {} {} ({} = {:.6} {})",
                quantities[fold.axis].name,
                text::exact(value),
                quantities[fold.axis].unit,
                quantities[other].name,
                quantities[other].to_unit(fold.at[other]),
                quantities[other].unit,
            );
        }
    }
    text
}

fn map(asked: &Resolved<'_>, chart: &Chart) -> Map {
    let info = asked.problem.model().info();
    let shown = |axis: Axis| {
        let quantity = axis.term.quantity(info);
        Shown {
            label: format!("{} [{}]", quantity.name, quantity.unit),
            scale: quantity.to_unit(1.0),
        }
    };
    regions::map(&info.title, chart, chart.axes.map(shown))
}
