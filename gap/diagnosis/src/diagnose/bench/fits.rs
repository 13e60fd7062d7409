//! Fits of hypotheses.

use appell_estimate::{Effort, EstimateError, Estimation, Fit, Free};

use super::super::DiagnoseError;
use super::super::evidence::{Evidence, Fitted};
use super::super::feedback::for_kicks;
use super::{Bench, COARSE, EFFORT, FINELY};

/// An optimisation method.
type Search = fn(&Estimation<'_>, &[f64], &[Free], Effort) -> Result<Fit, EstimateError>;

impl Bench<'_> {
    /// Fits a hypothesis from initial values.
    pub(in super::super) fn fit(
        &self,
        effort: Effort,
        members: &[usize],
        estimation: &Estimation<'_>,
        start: &[f64],
    ) -> Result<Fitted, DiagnoseError> {
        self.fit_by(Fit::quick, effort, members, estimation, start)
    }

    /// The effort of a fit.
    pub(in super::super) fn effort(&self) -> Effort {
        if self.is_over_windows() {
            COARSE
        } else {
            EFFORT
        }
    }

    /// The effort of a fit that is given up where it stays far below a log posterior.
    pub(in super::super) fn above(&self, floor: f64) -> Effort {
        Effort {
            floor,
            ..self.effort()
        }
    }

    /// The effort of a fit to a twentieth of a standard deviation, for values that are reported alone.
    pub(in super::super) fn finely(&self) -> Effort {
        Effort {
            gain: FINELY * self.effort().gain,
            ..self.effort()
        }
    }

    /// Fits a hypothesis by an optimisation method.
    pub(in super::super) fn fit_by(
        &self,
        search: Search,
        effort: Effort,
        members: &[usize],
        estimation: &Estimation<'_>,
        start: &[f64],
    ) -> Result<Fitted, DiagnoseError> {
        let free = self.free(members, estimation.setup());
        let fit = if self.is_over_windows() && self.is_late(members) {
            // With the delay the states at the beginnings of the windows change.
            let mut start = start.to_vec();
            self.begin_later(estimation, &mut start)?;
            start = self
                .weighed(estimation, &start, &free, search, effort)?
                .values;
            self.begin_later(estimation, &mut start)?;
            self.weighed(estimation, &start, &free, search, effort)?
        } else {
            self.weighed(estimation, start, &free, search, effort)?
        };
        let by_inputs = for_kicks(&self.input_innovations, self.weight, estimation, &fit)?;
        let evidence = Evidence::of(self, members, &fit, by_inputs);
        Ok(Fitted {
            members: members.to_vec(),
            layout: estimation.layout(),
            fit,
            evidence,
            coloured: 0.0,
        })
    }

    /// A fit with weighted rows: the objective is divided by the weight, so that the prior is scaled instead.
    pub(in super::super) fn weighed(
        &self,
        estimation: &Estimation<'_>,
        start: &[f64],
        free: &[Free],
        search: Search,
        effort: Effort,
    ) -> Result<Fit, DiagnoseError> {
        let firm = free.iter().map(|one| Free {
            prior: (one.prior).map(|[value, deviation]| [value, deviation * self.weight.sqrt()]),
            ..*one
        });
        let effort = Effort {
            gain: effort.gain / self.weight,
            floor: effort.floor / self.weight,
            ..effort
        };
        let fit = search(estimation, start, &firm.collect::<Vec<_>>(), effort)?;
        Ok(Fit {
            free: free.to_vec(),
            log_likelihood: self.weight * fit.log_likelihood,
            log_posterior: self.weight * fit.log_posterior,
            information: self.weight * fit.information,
            curvature: self.weight * fit.curvature,
            gain: self.weight * fit.gain,
            ..fit
        })
    }
}
