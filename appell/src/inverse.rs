//! The inputs of recorded motions, and parameters from input-free equations.

use appell_gap::inverse;
use appell_recordings::DataSet;

pub use appell_gap::inverse::{Answer, Estimate, Options, RelationError};

use crate::{Error, Model, recording};

impl Model {
    /// Computes the inputs of recorded motions, and estimates parameters from the combinations of the
    /// equations that hold whatever the inputs were.
    pub fn inverse(&self, set: &DataSet, options: &Options) -> Result<Answer, Error> {
        recording::check(set)?;
        Ok(inverse::find(set, self.all_equations()?, options)?)
    }
}
