//! `appell list`

use std::path::{Path, PathBuf};

use appell_models::{ALL, Shipped};
use serde_json::{Map, Value, json};

use crate::failure::Error;
use crate::{output, progress};
use appell::robot::{self, Format, Imported, Options};
use appell::{check, files};
use appell_report::row;
use appell_report::text::table;

/// Lists the shipped mechanisms, or the robot files of a folder.
#[derive(Debug, clap::Args)]
#[command(after_long_help = "\
Examples:
  appell list
  appell list --json mechanisms.json
  appell list --robots robot")]
pub(crate) struct List {
    /// List the robot files of a folder and of the folders in it, with what `appell import` makes of them
    #[arg(long, value_name = "DIR")]
    robots: Option<PathBuf>,
    /// Write the list as JSON; `-` is standard output
    #[arg(long, value_name = "FILE")]
    json: Option<PathBuf>,
}

impl List {
    pub(super) fn run(&self) -> Result<(), Error> {
        match &self.robots {
            Some(folder) => self.robots(folder),
            None => self.mechanisms(),
        }
    }

    fn robots(&self, folder: &Path) -> Result<(), Error> {
        let found = robot::find(folder)?;
        if found.is_empty() {
            let folder = folder.display();
            let message = "no file ends in `.urdf`, or in `.xml` and begins with `<mujoco`";
            return Err(appell::Error::data(folder, message).into());
        }
        let mut rows = vec![row![
            "file", "robot", "format", "bodies", "joints", "remarks"
        ]];
        let mut entries = Vec::new();
        let bar = progress::cases(found.len() as u64, "robot files");
        for (path, format) in found {
            let robot = robot::read(&path, Some(folder), &Options::default());
            let file = path.strip_prefix(folder).unwrap_or(&path).display();
            rows.push(row_of(&file.to_string(), format, &robot));
            let file = path.to_string_lossy();
            entries.push(match &robot {
                Ok(robot) => appell::json::robot(&file, robot),
                Err(failure) => check::failed(&file, failure),
            });
            bar.inc(1);
        }
        bar.finish_and_clear();
        if let Some(path) = &self.json {
            files::write_json(path, &json!({ "schema": "robots/1", "robots": entries }))?;
            if files::is_stdout(path) {
                return Ok(());
            }
        }
        output::print(&table(&rows, 3..5))
    }

    fn mechanisms(&self) -> Result<(), Error> {
        if let Some(path) = &self.json {
            let entries = ALL.iter().map(entry).collect::<Result<Vec<_>, _>>()?;
            files::write_json(path, &json!({ "schema": "list/1", "mechanisms": entries }))?;
            if files::is_stdout(path) {
                return Ok(());
            }
        }
        let mut rows = vec![row!["mechanism", "dof", "constraints", "title"]];
        for shipped in ALL {
            let info = shipped.model.info();
            let constraints = constraints(shipped)?;
            rows.push(row![shipped.name, info.speeds, constraints, info.title]);
        }
        if let Some(columns) = output::columns() {
            fit(&mut rows, columns);
        }
        let note = "`--json` has sources, names and costs; `appell effects` lists the effects that a diagnosis looks for\n";
        output::print(&(table(&rows, 1..2) + note))
    }
}

/// The row of a robot file.
fn row_of(file: &str, format: Format, robot: &Result<Imported, appell::Error>) -> Vec<String> {
    let format = format.word();
    match robot {
        Ok(robot) => {
            let findings = robot
                .warnings
                .iter()
                .map(|report| report.diagnostics().len());
            let remarks = match findings.sum() {
                0 => String::new(),
                1 => "1 warning".to_owned(),
                count => format!("{count} warnings"),
            };
            row![
                file,
                robot.name,
                format,
                robot.bodies,
                robot.joints,
                remarks
            ]
        }
        Err(error) => {
            let told = error.to_string();
            // Warnings may precede the error.
            let wrong = told.lines().find(|line| line.starts_with("error["));
            let first = wrong.or(told.lines().next()).unwrap_or_default();
            row![file, "-", format, "-", "-", first]
        }
    }
}

/// Cuts the last column where a table is wider than a terminal.
fn fit(rows: &mut [Vec<String>], columns: usize) {
    /// Between two columns of a table.
    const GAP: usize = 2;
    /// A shorter title is useless.
    const LEAST: usize = 12;
    let Some(last) = rows.first().and_then(|row| row.len().checked_sub(1)) else {
        return;
    };
    let used: usize = (0..last).map(|column| width(rows, column) + GAP).sum();
    let room = columns.saturating_sub(used + GAP).max(LEAST);
    for row in rows {
        row[last] = cut(&row[last], room);
    }
}

fn width(rows: &[Vec<String>], column: usize) -> usize {
    let widths = rows.iter().map(|row| row[column].chars().count());
    widths.max().unwrap_or(0)
}

/// A text in the room that is left.
fn cut(text: &str, room: usize) -> String {
    if text.chars().count() <= room {
        return text.to_owned();
    }
    let kept: String = text.chars().take(room - 1).collect();
    format!("{}…", kept.trim_end())
}

/// Word of the spec and number of scalar rows of each constraint.
fn kinds(shipped: &Shipped) -> Result<Vec<(String, &'static str, usize)>, Error> {
    let mechanism = appell_spec::load(shipped.file, shipped.spec)?.mechanism;
    let named = mechanism.constraints.into_iter().map(|constraint| {
        let (word, rows) = (constraint.kind.word(), constraint.kind.rows());
        (constraint.name, word, rows)
    });
    Ok(named.collect())
}

/// Kinds of the constraints.
fn constraints(shipped: &Shipped) -> Result<String, Error> {
    let kinds = kinds(shipped)?;
    let mut words: Vec<&str> = kinds.iter().map(|(_, word, _)| *word).collect();
    words.sort_unstable();
    words.dedup();
    Ok(if words.is_empty() {
        "-".to_owned()
    } else {
        words.join(", ")
    })
}

fn entry(shipped: &Shipped) -> Result<Value, Error> {
    let info = shipped.model.info();
    let costs = shipped.costs.iter();
    let costs: Map<String, Value> = costs
        .map(|(function, cost)| ((*function).to_owned(), json!(cost)))
        .collect();
    let constraints: Vec<Value> = kinds(shipped)?
        .into_iter()
        .map(|(name, kind, rows)| json!({ "name": name, "kind": kind, "rows": rows }))
        .collect();
    Ok(json!({
        "name": shipped.name,
        "title": info.title,
        "source": info.source,
        "degrees_of_freedom": info.speeds,
        "constraints": constraints,
        "constraint_rows": info.constraint_rows,
        "pseudo_velocities": appell::json::names(info.speed_quantities()),
        "coordinates": appell::json::names(info.coordinate_quantities()),
        "inputs": appell::json::names(&info.inputs[..info.declared_inputs]),
        "parameters": appell::json::names(&info.parameters),
        "outputs": appell::json::names(&info.outputs),
        "operations": costs,
    }))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_list_fits_the_terminal() {
        let title = "a title of forty letters, more or less";
        let row = || row!["mechanism", "3", "rolling", title];
        for columns in [20, 50, 60, 200] {
            let mut rows = vec![row(), row()];
            fit(&mut rows, columns);
            let text = table(&rows, 1..2);
            let widest = text.lines().map(|line| line.chars().count()).max();
            assert!(widest <= Some(columns.max(42)), "{text}");
            assert_eq!(text.contains(title), columns == 200, "{text}");
        }
    }
}
