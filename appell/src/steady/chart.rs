//! Stability charts for programs: JSON in SI, CSV in the units of the spec.

use std::io::{self, Write};

use appell_analysis::{Axis, Boundary, Cell, Chart, Edge, Kind};
use serde_json::{Value, json};

use super::{Resolved, export};

/// All of the chart.
pub fn json(asked: &Resolved<'_>, chart: &Chart) -> Value {
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
        "schema": "stability-chart/1",
        "mechanism": info.name,
        "axes": chart.axes.iter().map(axis).collect::<Vec<_>>(),
        "unknowns": unknowns.collect::<Vec<_>>(),
        "boundaries": chart.boundaries.iter().map(boundary_json).collect::<Vec<_>>(),
        "edges": chart.edges.iter().map(edge).collect::<Vec<_>>(),
        "cells": chart.cells.iter().map(place).collect::<Vec<_>>(),
    })
}

fn boundary_json(boundary: &Boundary) -> Value {
    let folds = boundary.folds.iter();
    let folds =
        folds.map(|fold| json!({ "axis": fold.axis, "at": fold.at, "decides": fold.decides }));
    json!({
        "kind": export::kind(Kind::Critical(boundary.change)),
        "decides": boundary.decides,
        "points": boundary.points,
        "folds": folds.collect::<Vec<_>>(),
    })
}

/// A row for every motion: the two quantities, growth, verdict.
pub fn csv(asked: &Resolved<'_>, chart: &Chart, to: &mut dyn Write) -> io::Result<()> {
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
