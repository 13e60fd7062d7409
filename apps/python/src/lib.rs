//! The native part of the Python package `appell`. It converts arrays and texts, and calls the crate `appell`; names,
//! results and pictures are made in Python on top of it.

#![allow(
    clippy::needless_pass_by_value,
    reason = "arguments come from Python as values"
)]

mod arrays;
mod card;
mod ensemble;
mod errors;
mod model;
mod motion;
mod recordings;
mod robot;
mod watched;

use pyo3::prelude::*;

#[pymodule]
mod _appell {
    use pyo3::prelude::*;

    #[pymodule_init]
    #[expect(clippy::unnecessary_wraps, reason = "the form that the macro takes")]
    fn init(_module: &Bound<'_, PyModule>) -> PyResult<()> {
        if let Some(cache) = appell::cache::Cache::of_user() {
            cache.use_from_now_on();
        }
        Ok(())
    }

    #[pymodule_export]
    use super::card::{CardMemory, OnCard};
    #[pymodule_export]
    use super::ensemble::Study;
    #[pymodule_export]
    use super::model::{Model, shipped};
    #[pymodule_export]
    use super::motion::{Simulated, restored, simulate};
    #[pymodule_export]
    use super::recordings::{DataSet, Gap, Identified, apply, sample};
    #[pymodule_export]
    use super::robot::{corrected_robot, import_robot, sample_robot};
}
