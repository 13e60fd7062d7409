//! Inputs from a CSV file: held from each row to the next.

use std::path::Path;

use appell_runtime::Signal;
use appell_runtime::inputs::TabulatedInputs;
use appell_runtime::model::{Interpolation, SignalTable};
use appell_spec::{Code, Diagnostic, Report};

use crate::failure::Failure;
use crate::files;
use crate::setup::{Setup, unknown};

/// The inputs in a CSV file, and which inputs it has.
///
/// The header names `t` in s and inputs in the units of the spec; columns of the mechanism's other
/// quantities are left aside, so that a trajectory written by `appell simulate` can be fed back.
pub(crate) fn read(
    path: &Path,
    setup: &Setup<'_>,
) -> Result<(TabulatedInputs, Vec<usize>), Failure> {
    let text = files::read(path)?;
    let mut findings = Vec::new();
    let columns = columns(&text, setup, &mut findings);
    let file = path.to_string_lossy();
    if !findings.is_empty() {
        return Err(Failure::Reports(vec![Report::new(file, text, findings)]));
    }
    let mut signals = Vec::new();
    for (index, input) in setup.mechanism.inputs.iter().enumerate() {
        let given = columns.inputs.iter().position(|&other| other == index);
        let scale = input.label.unit.scale;
        let values = given.map(|column| {
            columns.values[column]
                .iter()
                .map(|v| v * scale)
                .collect::<Vec<_>>()
        });
        let table = SignalTable {
            name: input.label.name.clone().into(),
            times: if given.is_some() {
                columns.times.clone()
            } else {
                vec![0.0]
            }
            .into(),
            values: values.unwrap_or_else(|| vec![0.0]).into(),
            interpolation: Interpolation::Hold,
        };
        let signal =
            Signal::new(&table).map_err(|error| Failure::Data(format!("{file}: {error}")))?;
        signals.push(signal);
    }
    Ok((TabulatedInputs::new(signals), columns.inputs))
}

/// Most findings told for one file.
const MOST: usize = 20;

#[derive(Default)]
struct Columns {
    times: Vec<f64>,
    /// Index of the input of each column of values.
    inputs: Vec<usize>,
    values: Vec<Vec<f64>>,
}

fn columns(text: &str, setup: &Setup<'_>, findings: &mut Vec<Diagnostic>) -> Columns {
    let mut columns = Columns::default();
    // Line by line instead of a CSV reader: numbers need no quotes, and places are exact.
    let mut lines = rows(text);
    let Some(header) = lines.next() else {
        findings.push(
            Diagnostic::error(Code::MissingKey, "the file is empty")
                .at(0..0, "")
                .help("begin with a header: `t`, then the inputs"),
        );
        return columns;
    };
    let mut time = None;
    let mut places = Vec::new();
    let count = header.len();
    for (position, (at, name)) in header.into_iter().enumerate() {
        let span = at..at + name.len();
        let input = setup
            .mechanism
            .inputs
            .iter()
            .position(|input| input.label.name == name);
        if name == "t" {
            time = Some(position);
        } else if let Some(input) = input {
            if columns.inputs.contains(&input) {
                findings.push(
                    Diagnostic::error(
                        Code::DuplicateName,
                        format!("the column `{name}` stands here twice"),
                    )
                    .at(span, ""),
                );
            }
            columns.inputs.push(input);
            places.push(position);
        } else if !is_other_quantity(name, setup) {
            let inputs = setup
                .mechanism
                .inputs
                .iter()
                .map(|input| input.label.name.as_str());
            findings.push(
                Diagnostic::error(Code::UnknownName, unknown(name, "input", inputs)).at(span, ""),
            );
        }
    }
    columns.values = vec![Vec::new(); columns.inputs.len()];
    let Some(time) = time else {
        findings.push(
            Diagnostic::error(Code::MissingKey, "there is no column `t`")
                .at(0..0, "")
                .help("name the column of times in seconds `t`"),
        );
        return columns;
    };
    for row in lines {
        if findings.len() >= MOST {
            break;
        }
        let start = row.first().map_or(0, |(at, _)| *at);
        let end = row.last().map_or(start, |(at, cell)| at + cell.len());
        if row.len() != count {
            let message = format!("{} cells under {count} columns", row.len());
            findings.push(Diagnostic::error(Code::WrongType, message).at(start..end, ""));
            continue;
        }
        let mut number = |position: usize| {
            let (at, cell) = row[position];
            let number = cell.parse::<f64>().ok().filter(|number| number.is_finite());
            if number.is_none() {
                findings.push(
                    Diagnostic::error(Code::WrongType, format!("`{cell}` is not a finite number"))
                        .at(at..at + cell.len(), "")
                        .help("an input needs a value in every row"),
                );
            }
            number.unwrap_or(0.0)
        };
        let t = number(time);
        for (column, &position) in columns.values.iter_mut().zip(&places) {
            column.push(number(position));
        }
        if columns.times.last().is_some_and(|last| *last >= t) {
            findings.push(
                Diagnostic::error(Code::SignalTable, "the time does not increase")
                    .at(start..end, ""),
            );
        }
        columns.times.push(t);
    }
    if columns.times.is_empty() && findings.is_empty() {
        findings.push(Diagnostic::error(Code::SignalTable, "there are no rows").at(0..0, ""));
    }
    columns
}

/// Cells of each line with their places, without comments and empty lines.
fn rows(text: &str) -> impl Iterator<Item = Vec<(usize, &str)>> {
    let lines = text.split_inclusive('\n').scan(0, |at, line| {
        let start = *at;
        *at += line.len();
        Some((start, line))
    });
    lines
        .filter(|(_, line)| !line.trim().is_empty() && !line.starts_with('#'))
        .map(|(start, line)| {
            let mut at = start;
            line.split(',')
                .map(|cell| {
                    let place = at + (cell.len() - cell.trim_start().len());
                    at += cell.len() + 1;
                    (place, cell.trim().trim_start_matches('\u{feff}'))
                })
                .collect()
        })
}

/// Columns that `appell simulate` writes besides the inputs.
fn is_other_quantity(name: &str, setup: &Setup<'_>) -> bool {
    let info = setup.info;
    info.state_index(name).is_some()
        || info.input_index(name).is_some()
        || info.output_index(name).is_some()
        || matches!(name, "kinetic_energy" | "potential_energy" | "power")
        || name.starts_with("reaction_")
        || name.starts_with("residual_")
}
