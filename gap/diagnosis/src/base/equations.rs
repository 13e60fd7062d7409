//! Inverse dynamics as equations that are linear in parameters.

use appell_codegen::jit::{NativeFunction, Sizes};
use appell_codegen::mechanics::Regressor;
use appell_codegen::schedule::schedule;
use appell_codegen::tape::{Tape, interpret_weighted};
use appell_estimate::inverse::Moment;
use appell_runtime::model::At;
use nalgebra::{DMatrix, DVector};

/// Y, r and π at a motion.
pub(super) struct LinearEquations {
    pub(super) regressor: DMatrix<f64>,
    pub(super) rest: DVector<f64>,
    pub(super) values: Vec<f64>,
}

/// The regressor, compiled where that is possible.
pub(super) struct Equations {
    tape: Tape,
    native: Option<NativeFunction>,
    speeds: usize,
    count: usize,
}

impl Equations {
    pub(super) fn new(regressor: &Regressor) -> Self {
        let program = &regressor.program;
        let tape = schedule(program, &program.functions[0]);
        Self {
            native: NativeFunction::compile(&tape, Sizes::from(&program.info)).ok(),
            tape,
            speeds: program.info.speeds,
            count: regressor.parameters.len(),
        }
    }

    /// At a motion with other inputs.
    pub(super) fn at(&self, moment: &Moment, u: &[f64], p: &[f64]) -> LinearEquations {
        let (t, x, accelerations) = (moment.t, &moment.x, &moment.accelerations);
        let at = At { t, x, u, p };
        let (s, k) = (self.speeds, self.count);
        let (mut regressor, mut rest, mut values) = (vec![0.0; s * k], vec![0.0; s], vec![0.0; k]);
        let results = [&mut regressor[..], &mut rest, &mut values];
        if let Some(native) = &self.native {
            native.call_weighted(at, accelerations, results);
        } else {
            let computed = interpret_weighted(&self.tape, at, accelerations);
            for (to, from) in results.into_iter().zip(&computed) {
                to.copy_from_slice(from);
            }
        }
        LinearEquations {
            regressor: DMatrix::from_row_slice(s, k, &regressor),
            rest: DVector::from_vec(rest),
            values,
        }
    }
}
