//! `appell inverse`

use std::fmt::Write as _;
use std::path::PathBuf;

use appell::inverse::{Answer, Estimate, Options};
use appell_report::figure::Figure;
use appell_report::row;
use appell_report::text::{number, table};

use crate::failure::Error;
use crate::output;
use crate::{engine, picture, progress};

/// Computes the inputs of recorded motions, and parameters from input-free equations.
///
/// If a mechanism has more equations of motion than inputs, some combinations of them hold whatever
/// the inputs were. They are weighted by the noise of the recordings, through splines and exact
/// derivatives. All coordinates that enter the equations must be measured; inputs need not be.
#[derive(Debug, clap::Args)]
#[command(after_long_help = "\
Examples:
  appell motion capture/skeleton.toml capture/ride_1.csv capture/ride_2.csv --out rides
  appell inverse euc_3dof --data rides --free h --bias phi --plot torque.svg")]
pub(crate) struct Inverse {
    /// Name of a shipped mechanism, or path of a spec or a robot file
    model: String,
    /// Folder with a `recording.toml`, or CSV files with columns of the spec's names
    #[arg(long, required = true, num_args = 1.., value_name = "DIR")]
    data: Vec<PathBuf>,
    /// Parameters to estimate
    #[arg(long, value_delimiter = ',', value_name = "NAMES")]
    free: Vec<String>,
    /// Columns that may have a constant bias
    #[arg(long, value_delimiter = ',', value_name = "COLUMNS")]
    bias: Vec<String>,
    /// Write the results as JSON, in SI; `-` is standard output
    #[arg(long, value_name = "FILE")]
    json: Option<PathBuf>,
    /// Draw the inputs of the first runs with 95 % bands
    #[arg(long, value_name = "FILE.svg|png")]
    plot: Option<PathBuf>,
}

impl Inverse {
    pub(super) fn run(&self) -> Result<(), Error> {
        let set = appell::recording::read(&self.data, Some(&self.model))?;
        let model = engine::model_of(appell::recording::source(&set))?;
        let options = Options {
            free: self.free.clone(),
            biased: self.bias.clone(),
        };
        let answer = progress::during("evaluating the equations of motion", |_| {
            model.inverse(&set, &options)
        })?;
        let info = model.info();
        output::json(self.json.as_deref(), || {
            appell::json::inverse(info, &answer)
        })?;
        if let Some(path) = &self.plot {
            picture::write(path, &Figure::of_inputs(info, &answer).to_svg())?;
        }
        output::print_beside(&text(&answer), &[&self.json, &self.plot])
    }
}

/// The report as text tables.
fn text(answer: &Answer) -> String {
    let mut text = format!(
        "{} input-free relation{}, spline knots every {:.0} ms\n",
        answer.relations,
        if answer.relations == 1 { "" } else { "s" },
        1e3 * answer.spacing,
    );
    // Writing to a string cannot fail.
    let _ = writeln!(
        text,
        "mean square residual relative to the noise {} (1 if model and noise are right)\n",
        number(answer.normalised_square)
    );
    if !answer.estimates.is_empty() {
        let _ = writeln!(text, "95 % intervals\n\n{}", estimates(&answer.estimates));
    }
    let mut rows = vec![row!["column", "noise"]];
    for (column, std) in &answer.noise {
        rows.push(row![column, format!("{std:.3e}")]);
    }
    text + &table(&rows, 1..2)
}

fn estimates(estimates: &[Estimate]) -> String {
    let mut rows = vec![row!["value", "nominal", "found", "from", "to", "unit", ""]];
    for estimate in estimates {
        let quantity = &estimate.quantity;
        let bias = if estimate.is_bias { "bias of " } else { "" };
        let shown = |si: f64| number(quantity.to_unit(si));
        let [low, high] = estimate.interval95.map(shown);
        rows.push(row![
            format!("{bias}{}", quantity.name),
            shown(estimate.nominal),
            shown(estimate.value),
            low,
            high,
            quantity.unit,
            remark(estimate)
        ]);
    }
    table(&rows, 1..5)
}

/// A remark on parameters that the motions do not determine.
fn remark(estimate: &Estimate) -> &'static str {
    match estimate.interval95 {
        [low, high] if low.is_infinite() && high.is_infinite() => "not determined by these motions",
        [_, high] if high.is_infinite() => "not bounded from above by these motions",
        [low, _] if low.is_infinite() => "not bounded from below by these motions",
        _ => "",
    }
}
