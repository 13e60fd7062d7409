//! What a data set lacks, once it is read.

use crate::channel::{Channel, Role};
use crate::finding::{Finding, FindingKind};
use crate::{DataSet, noise, stretches};

impl DataSet {
    /// The set with its runs cut at gaps, the noise of its channels, and doubts about it.
    pub(crate) fn judged(mut self) -> Self {
        let runs = std::mem::take(&mut self.runs);
        self.runs = stretches::uninterrupted(runs, &self.channels, &mut self.findings);
        noise::find(&mut self);
        self.tell_what_lacks();
        self.tell_smooth_inputs();
        self.findings.sort_by_key(Finding::order);
        self
    }

    /// Inputs without a column, and parameters without a tolerance.
    fn tell_what_lacks(&mut self) {
        for (index, input) in self.mechanism.inputs.iter().enumerate() {
            let recorded = |channel: &Channel| channel.role == Role::Input(index);
            if !self.channels.iter().any(recorded) {
                let message = format!(
                    "no column is the input `{}`, so zero is taken for it",
                    input.label.name
                );
                self.findings
                    .push(Finding::new(FindingKind::NoInput, message));
            }
        }
        if !self.parameters.is_empty() && self.parameters.iter().all(|own| own.std.is_none()) {
            let message = "no parameter has a tolerance `std`, so all are taken as exact: an effect has to make up for \
                           whatever differs";
            self.findings
                .push(Finding::new(FindingKind::NoTolerance, message));
        }
    }
}
