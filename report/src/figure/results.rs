//! Figures of results: branches of steady motions, their eigenvalues, inputs computed from recorded motions.

use appell_analysis::{Branch, Term, loci};
use appell_gap::inverse::Answer;
use appell_runtime::model::{Model, ModelInfo};

use super::{Figure, Mark, Panel, Series};

/// A term below this size on all branches is zero, and not drawn.
const ZERO: f64 = 1e-12;
/// Largest number of branches of which eigenvalues are drawn.
const MOST_BRANCHES: usize = 4;

impl Figure {
    /// Steady motions against the quantity along which they were continued, a panel for each term.
    pub fn of_branches(
        model: &dyn Model,
        along: Term,
        terms: &[Term],
        branches: &[Branch],
    ) -> Self {
        let info = model.info();
        let values = |term: Term, branch: &Branch| -> Vec<f64> {
            let points = branch.points.iter();
            points.map(|at| term.value(model, &at.point)).collect()
        };
        let drawn = |term: &&Term| {
            let all = branches.iter().flat_map(|branch| values(**term, branch));
            **term != along && all.into_iter().any(|value| value.abs() > ZERO)
        };
        let panel = |term: &Term| {
            let quantity = term.quantity(info);
            let series = branches.iter().enumerate().map(|(i, branch)| {
                let label = match i {
                    0 => quantity.name.to_string(),
                    _ => format!("branch {}", i + 1),
                };
                let y = values(*term, branch).into_iter();
                let y = y.map(|value| quantity.to_unit(value)).collect();
                Series::new(label, &parameter(info, along, branch), y)
            });
            Panel::new(quantity.unit.as_ref(), series.collect())
        };
        let panels = terms.iter().filter(drawn).map(panel).collect();
        along_branches(info, along, branches, panels)
    }

    /// Real and imaginary parts of eigenvalues against the quantity along which motions were continued, two
    /// panels for each of the first branches.
    pub fn of_eigenvalues(info: &ModelInfo, along: Term, branches: &[Branch]) -> Self {
        let drawn = branches.iter().take(MOST_BRANCHES).enumerate();
        let panels = drawn.flat_map(|(number, branch)| {
            let x = parameter(info, along, branch);
            let [mut re, mut im] = [Vec::new(), Vec::new()];
            let loci = loci(branch.points.iter().map(|at| &at.stability));
            for (mode, locus) in loci.iter().enumerate() {
                let label = |part: &str| match mode {
                    0 if branches.len() > 1 => format!("branch {}: {part} 1", number + 1),
                    _ => format!("{part} {}", mode + 1),
                };
                let values = locus.iter();
                let y = values.clone().map(|value| value.re).collect();
                re.push(Series::new(label("re"), &x, y));
                let y = values.map(|value| value.im).collect();
                im.push(Series::new(label("im"), &x, y));
            }
            [re, im].map(|series| Panel::new("1/s", series))
        });
        along_branches(info, along, branches, panels.collect())
    }
}

/// The continuation parameter along a branch, in its unit.
fn parameter(info: &ModelInfo, along: Term, branch: &Branch) -> Vec<f64> {
    let quantity = along.quantity(info);
    let points = branch.points.iter();
    points.map(|at| quantity.to_unit(at.value)).collect()
}

/// Panels over the continuation parameter, with a mark at every special point.
fn along_branches(
    info: &ModelInfo,
    along: Term,
    branches: &[Branch],
    panels: Vec<Panel>,
) -> Figure {
    let quantity = along.quantity(info);
    let specials = branches.iter().flat_map(|branch| &branch.specials);
    let marks = specials.map(|special| {
        let x = quantity.to_unit(special.motion.value);
        // All digits: the value is exact to rounding.
        let about = format!("{} = {x:.14} {}", quantity.name, quantity.unit);
        Mark { x, about }
    });
    let x_label = format!("{} [{}]", quantity.name, quantity.unit);
    Figure {
        marks: marks.collect(),
        ..Figure::new(info.title.as_ref(), x_label, panels)
    }
}

/// Number of runs drawn.
const DRAWN_RUNS: usize = 3;

impl Figure {
    /// The inputs of the first runs, each with its 95 % band.
    pub fn of_inputs(info: &ModelInfo, answer: &Answer) -> Self {
        let panels = answer.inputs.iter().take(DRAWN_RUNS).flat_map(|run| {
            let inputs = info.inputs.iter().take(info.declared_inputs).enumerate();
            inputs.map(|(input, quantity)| {
                let name = format!("{}, {}", quantity.name, run.run);
                let (values, stds) = (&run.values[input], &run.stds[input]);
                Panel::with_band(
                    [&name, "95 % from", "to"],
                    quantity,
                    &run.times,
                    values,
                    stds,
                )
            })
        });
        let title = format!("{}: inputs of recorded motions", info.name);
        Self::new(title, "t [s]", panels.collect())
    }
}
