//! `appell stability --chart`: a stability chart over two quantities.

use std::fmt::Write as _;
use std::io::{self, Write};
use std::str::FromStr;

use appell_analysis::{Axis, Boundary, Cell, Chart, Edge, Verdict};
use appell_report::figure::Map;
use serde_json::{Value, json};

use super::StabilityCommand;
use crate::failure::Error;
use crate::motions::{self, text};
use crate::output;
use crate::picture;
use appell::setup::Setup;
use appell::steady::Span;
use appell::steady::regions::{self, Shown};
use appell::steady::{Resolved, export};
use appell::{Field, files};

/// `X=FROM..TO,Y=FROM..TO` as it was given.
#[derive(Debug, Clone)]
pub(super) struct Plane([Span; 2]);

impl FromStr for Plane {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let (x, y) = text
            .split_once(',')
            .ok_or("write X=FROM..TO,Y=FROM..TO, such as theta=-30deg..30deg,psi_dot=1..8")?;
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
        let chart = motions::chart(asked, *axes)?;
        let question = &self.question;
        if let Some(path) = &question.json {
            files::write_json(path, &json(asked, &chart))?;
        }
        if let Some(path) = &question.csv {
            files::write_with(path, |to| csv(asked, &chart, to))?;
        }
        if let Some(path) = &question.plot {
            picture::write(path, &map(asked, &chart).to_svg())?;
        }
        let text = text::structure(asked) + &text(asked, &chart);
        output::print_beside(&text, &[&question.csv, &question.json, &question.plot])
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

fn boundary_json(boundary: &Boundary) -> Value {
    let folds = boundary.folds.iter();
    let folds =
        folds.map(|fold| json!({ "axis": fold.axis, "at": fold.at, "decides": fold.decides }));
    json!({
        "kind": export::kind(appell_analysis::Kind::Critical(boundary.change)),
        "decides": boundary.decides,
        "points": boundary.points,
        "folds": folds.collect::<Vec<_>>(),
    })
}

fn json(asked: &Resolved<'_>, chart: &Chart) -> Value {
    let info = asked.problem.model().info();
    let axis = |axis: &Axis| json!({ "name": axis.term.name(info), "range": axis.range, "count": axis.count });
    let unknowns = chart.unknowns.iter().map(|term| term.name(info));
    let motion = |cell: &Cell| {
        json!({
            "unknowns": cell.unknowns,
            "eigenvalues": cell.eigenvalues.iter().map(|z| [z.re, z.im]).collect::<Vec<_>>(),
            "verdict": export::verdict(cell.verdict),
            "feasible": cell.feasible,
        })
    };
    let place = |cells: &Vec<Cell>| json!(cells.iter().map(motion).collect::<Vec<_>>());
    let edge = |edge: &Edge| json!({ "requirement": edge.requirement, "points": edge.points });
    json!({
        "mechanism": info.name,
        "axes": chart.axes.iter().map(axis).collect::<Vec<_>>(),
        "unknowns": unknowns.collect::<Vec<_>>(),
        "boundaries": chart.boundaries.iter().map(boundary_json).collect::<Vec<_>>(),
        "edges": chart.edges.iter().map(edge).collect::<Vec<_>>(),
        "cells": chart.cells.iter().map(place).collect::<Vec<_>>(),
    })
}

/// A row for every motion: the two quantities, growth, verdict.
fn csv(asked: &Resolved<'_>, chart: &Chart, to: &mut dyn Write) -> io::Result<()> {
    let info = asked.problem.model().info();
    let [x, y] = chart.axes.map(|axis| axis.term.quantity(info));
    writeln!(
        to,
        "# mechanism: {}\n# units: {} {}, {} {}, growth 1/s",
        info.name, x.name, x.unit, y.name, y.unit
    )?;
    writeln!(to, "{},{},growth,verdict,feasible", x.name, y.name)?;
    for j in 0..chart.axes[1].count {
        for i in 0..chart.axes[0].count {
            for cell in chart.motions(i, j) {
                let growth = cell.eigenvalues.first().map_or(f64::NEG_INFINITY, |z| z.re);
                writeln!(
                    to,
                    "{},{},{growth},{},{}",
                    x.to_unit(chart.axes[0].value(i)),
                    y.to_unit(chart.axes[1].value(j)),
                    export::verdict(cell.verdict),
                    cell.feasible,
                )?;
            }
        }
    }
    Ok(())
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
