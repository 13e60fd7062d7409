//! Eigenvalues along branches of steady motions.

use appell_analysis::{Branch, Term, loci};
use appell_runtime::model::ModelInfo;

use super::branches::{frame, parameter};
use super::{Figure, Panel, Series};

/// Largest number of branches drawn.
const MOST_BRANCHES: usize = 4;

impl Figure {
    /// Real and imaginary parts against the quantity along which motions were continued, two panels for
    /// each of the first branches.
    pub fn of_eigenvalues(info: &ModelInfo, along: Term, branches: &[Branch]) -> Self {
        let drawn = branches.iter().take(MOST_BRANCHES).enumerate();
        let panels = drawn.flat_map(|(number, branch)| {
            let x = parameter(info, along, branch);
            let [mut re, mut im] = [Vec::new(), Vec::new()];
            let loci = loci(branch.points.iter().map(|at| &at.stability));
            for (mode, locus) in loci.iter().enumerate() {
                let series = |part: &str, y| Series {
                    label: match mode {
                        0 if branches.len() > 1 => format!("branch {}: {part} 1", number + 1),
                        _ => format!("{part} {}", mode + 1),
                    },
                    x: x.clone(),
                    y,
                };
                re.push(series("re", locus.iter().map(|value| value.re).collect()));
                im.push(series("im", locus.iter().map(|value| value.im).collect()));
            }
            [re, im].map(|series| Panel {
                unit: "1/s".to_owned(),
                series,
            })
        });
        Self {
            panels: panels.collect(),
            ..frame(info, along, branches)
        }
    }
}
