//! `appell list`

use std::path::PathBuf;

use appell_models::ALL;
use serde_json::{Value, json};

use crate::failure::Failure;
use crate::files;
use crate::table::table;

/// Shows the shipped mechanisms.
#[derive(Debug, clap::Args)]
pub(crate) struct List {
    /// Write the list as JSON; `-` is standard output
    #[arg(long, value_name = "FILE")]
    json: Option<PathBuf>,
}

impl List {
    pub(super) fn run(&self) -> Result<(), Failure> {
        if let Some(path) = &self.json {
            files::write_json(
                path,
                &json!({ "mechanisms": ALL.iter().map(entry).collect::<Vec<_>>() }),
            )?;
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
                info.constraint_rows.len().to_string(),
                info.title.to_string(),
                short(&info.source),
            ]);
        }
        files::print(&table(&rows, 1..3))
    }
}

/// The work itself, without sections and equation numbers, which the spec tells.
fn short(source: &str) -> String {
    let work = source.split(", ").next().unwrap_or_default();
    if work.is_empty() {
        "-".to_owned()
    } else {
        work.to_owned()
    }
}

fn entry(shipped: &appell_models::Shipped) -> Value {
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
    json!({
        "name": shipped.name,
        "title": info.title,
        "source": info.source,
        "degrees_of_freedom": info.speeds,
        "constraint_rows": info.constraint_rows,
        "pseudo_velocities": names(info.speed_quantities()),
        "coordinates": names(info.coordinate_quantities()),
        "inputs": names(&info.inputs[..info.declared_inputs]),
        "parameters": names(&info.parameters),
        "outputs": names(&info.outputs),
        "operations": costs,
    })
}
