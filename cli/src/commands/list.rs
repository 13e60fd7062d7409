//! `appell list`

use std::path::PathBuf;

use appell_models::{ALL, Shipped};
use serde_json::{Value, json};

use crate::failure::Error;
use crate::output;
use appell::files;
use appell_report::text::table;

/// Lists the shipped mechanisms.
#[derive(Debug, clap::Args)]
#[command(after_long_help = "\
Examples:
  appell list
  appell list --json mechanisms.json")]
pub(crate) struct List {
    /// Write the list as JSON; `-` is standard output
    #[arg(long, value_name = "FILE")]
    json: Option<PathBuf>,
}

impl List {
    pub(super) fn run(&self) -> Result<(), Error> {
        if let Some(path) = &self.json {
            let entries = ALL.iter().map(entry).collect::<Result<Vec<_>, _>>()?;
            files::write_json(path, &json!({ "schema": "list/1", "mechanisms": entries }))?;
            if files::is_stdout(path) {
                return Ok(());
            }
        }
        let heading = ["mechanism", "dof", "constraints", "title"];
        let mut rows = vec![heading.map(str::to_owned).to_vec()];
        for shipped in ALL {
            let info = shipped.model.info();
            rows.push(vec![
                shipped.name.to_owned(),
                info.speeds.to_string(),
                constraints(shipped)?,
                info.title.to_string(),
            ]);
        }
        let used: usize = (0..3).map(|column| width(&rows, column) + GAP).sum();
        let room = WIDTH - used - GAP;
        for row in &mut rows {
            row[3] = cut(&row[3], room);
        }
        let note = "`--json` has sources, names and costs\n";
        output::print(&(table(&rows, 1..2) + note))
    }
}

/// Columns of a terminal, and those between two columns of a table.
const WIDTH: usize = 80;
const GAP: usize = 2;

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
    let names = |list: &[appell_runtime::model::Quantity]| -> Vec<String> {
        list.iter()
            .map(|quantity| quantity.name.to_string())
            .collect()
    };
    let costs: serde_json::Map<String, Value> = shipped
        .costs
        .iter()
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
        "pseudo_velocities": names(info.speed_quantities()),
        "coordinates": names(info.coordinate_quantities()),
        "inputs": names(&info.inputs[..info.declared_inputs]),
        "parameters": names(&info.parameters),
        "outputs": names(&info.outputs),
        "operations": costs,
    }))
}
