//! `appell stability`

use appell_analysis::{Branch, Stability};
use appell_report::figure::Figure;

mod plane;

use plane::{Grid, Plane};

use crate::failure::Error;
use crate::motions::{Question, text};
use appell::steady::Resolved;
use appell_report::row;
use appell_report::text::table;

/// Eigenvalues of steady motions, and where their stability changes.
///
/// The motions are given as for `appell steady`. Zero eigenvalues that belong to a family of steady
/// motions are counted and ignored in the verdict. With `--along` critical values are exact to
/// rounding: they are zeros of smooth functions of the characteristic polynomial.
#[derive(Debug, clap::Args)]
#[command(after_long_help = "\
Examples:
  appell stability bicycle --along speed=0.5..10 --plot eigenvalues.svg
  appell stability rolling_wheel --chart theta=-60deg..60deg,psi_dot=0.5..8 --grid 40x40 --plot chart.svg")]
pub(crate) struct StabilityCommand {
    #[command(flatten)]
    question: Question,
    /// Stability chart over two quantities, such as theta=-30deg..30deg,psi_dot=1..8
    #[arg(
        long,
        value_name = "X=FROM..TO,Y=FROM..TO",
        allow_hyphen_values = true,
        conflicts_with = "along"
    )]
    chart: Option<Plane>,
    /// Grid of the chart
    #[arg(
        long,
        value_name = "NxM",
        default_value = "100x100",
        requires = "chart"
    )]
    grid: Grid,
}

impl StabilityCommand {
    pub(super) fn run(&self) -> Result<(), Error> {
        if self.chart.is_none() {
            self.question.needs_abscissa()?;
        }
        self.question.with(|asked, setup| {
            if let Some(chart) = &self.chart {
                return self.draw(asked, &chart.axes(setup, self.grid)?);
            }
            let figure = |along, branches: &[Branch]| {
                Figure::of_eigenvalues(asked.problem.model().info(), along, branches)
            };
            self.question
                .answer(asked, |stability| modes(asked, stability), figure)
        })
    }
}

/// Eigenvalues with the dominant states of their eigenvectors.
fn modes(asked: &Resolved<'_>, stability: &Stability) -> String {
    let info = asked.problem.model().info();
    let mut rows = Vec::new();
    for &place in &stability.deciding {
        let mode = &stability.spectrum.modes[place];
        if mode.value.im < 0.0 {
            continue;
        }
        let mut parts: Vec<(f64, &str)> = stability
            .states
            .iter()
            .zip(mode.right.iter())
            .map(|(&state, part)| (part.norm(), info.states[state].name.as_ref()))
            .collect();
        parts.sort_by(|a, b| b.0.total_cmp(&a.0));
        let leading: Vec<&str> = parts
            .iter()
            .filter(|p| p.0 > 0.1)
            .map(|p| p.1)
            .take(4)
            .collect();
        let value = text::eigenvalue(mode.value);
        let value = if mode.value.im > 0.0 {
            value.replace('+', "±")
        } else {
            value
        };
        rows.push(row![value, "1/s", leading.join(", ")]);
    }
    if stability.zeros == 0 {
        return format!("eigenvalues\n{}", table(&rows, 0..1));
    }
    let neutral = format!(
        "{} zero eigenvalue{} of {}: the family of neighbouring steady motions has {} dimension{}",
        stability.zeros,
        if stability.zeros == 1 { "" } else { "s" },
        stability.states.len(),
        stability.family,
        if stability.family == 1 { "" } else { "s" },
    );
    rows.push(row!["0", "1/s", neutral]);
    format!("eigenvalues\n{}", table(&rows, 0..1))
}
