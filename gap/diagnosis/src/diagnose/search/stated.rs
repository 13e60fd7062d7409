//! The begin of a search for a robot: about the model as stated.

use std::collections::BTreeSet;

use super::super::DiagnoseError;
use super::super::calibration::TIED;
use super::super::prior::names;
use super::super::scan::scanned;
use super::super::sets::{Set, Sets};
use super::{IMITATED, LEADING, STRONG, Search};

impl Search<'_, '_> {
    /// Fits sets about the model as stated: refitted parameters may imitate a large effect, far from its optimum.
    pub(super) fn start_from_stated(&mut self) -> Result<(), DiagnoseError> {
        let stated = self.bench.stated()?;
        let [nominal, from] = [&self.fits[0], &stated].map(|fitted| fitted.fit.log_likelihood);
        self.stated = Some(from);
        let scanned = scanned(self.bench, &stated)?;
        let all = scanned.iter().map(|set| set.log_posterior);
        let most = all.fold(nominal, f64::max);
        for set in scanned {
            // What explains less than the tolerances or another effect needs no start of its own.
            if set.log_posterior - from > IMITATED * (most - from) {
                self.take_from(&stated, &set);
            }
        }
        let without = self.log_posterior(&stated);
        let sets = Sets::about(self.bench, &stated, without)?;
        for set in self.strong_singles(&sets, without) {
            self.take_from(&stated, set);
        }
        for effects in [None, Some(1), Some(2)] {
            for set in self.worth_a_fit(&sets, LEADING, effects) {
                self.take_from(&stated, set);
            }
        }
        Ok(())
    }

    /// The single effects that promise at least a part of what the best of them promises: to first order another effect
    /// at the same place may imitate a large one.
    fn strong_singles<'s>(&self, sets: &'s [Set], without: f64) -> Vec<&'s Set> {
        let mut told = BTreeSet::new();
        // Biases and scales of channels are linear.
        let is_of_channel = |&own: &usize| self.bench.candidate(own).acts.channel().is_some();
        let singles = sets.iter().filter(|set| {
            if set.members.iter().any(is_of_channel) {
                return false;
            }
            let names = names(self.bench.effects, &set.members);
            names.len() == 1 && told.insert(names)
        });
        let singles: Vec<&Set> = singles.take(STRONG).collect();
        let most = singles
            .first()
            .map_or(0.0, |set| set.log_posterior - without);
        let is_strong = |set: &&Set| set.log_posterior - without > IMITATED * most.max(TIED);
        singles.into_iter().filter(is_strong).collect()
    }
}
