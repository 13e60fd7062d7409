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
pub(crate) struct List {
    /// Write the list as JSON; `-` is standard output
    #[arg(long, value_name = "FILE")]
    json: Option<PathBuf>,
}

impl List {
    pub(super) fn run(&self) -> Result<(), Error> {
        if let Some(path) = &self.json {
            let entries = ALL.iter().map(entry).collect::<Result<Vec<_>, _>>()?;
            files::write_json(path, &json!({ "mechanisms": entries }))?;
            if files::is_stdout(path) {
                return Ok(());
            }
        }
        let heading = ["mechanism", "dof", "constraints", "title", "source"];
        let mut rows = vec![heading.map(str::to_owned).to_vec()];
        for shipped in ALL {
            let info = shipped.model.info();
            rows.push(vec![
                shipped.name.to_owned(),
                info.speeds.to_string(),
                constraints(shipped)?,
                info.title.to_string(),
                short(&info.source),
            ]);
        }
        output::print(&table(&rows, 1..2))
    }
}

/// The cited work, without sections and equation numbers, which the spec gives.
fn short(source: &str) -> String {
    let work = source.split(", ").next().unwrap_or_default();
    if work.is_empty() {
        "-".to_owned()
    } else {
        work.to_owned()
    }
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

/// The constraints: rows solved by the equations, and rows that the coordinates satisfy identically.
fn constraints(shipped: &Shipped) -> Result<String, Error> {
    let kinds = kinds(shipped)?;
    let all: usize = kinds.iter().map(|(.., rows)| rows).sum();
    let held = all.saturating_sub(shipped.model.info().constraint_rows.len());
    let mut words: Vec<&str> = kinds.iter().map(|(_, word, _)| *word).collect();
    words.dedup();
    Ok(match (all, held) {
        (0, _) => "-".to_owned(),
        (_, 0) => format!("{}: {all} rows", words.join(", ")),
        _ => format!(
            "{}: {all} rows, {held} embedded in geometry",
            words.join(", ")
        ),
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
