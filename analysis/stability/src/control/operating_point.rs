//! A steady motion of a model, and its linear equations.

use nalgebra::{DMatrix, DVector};

use super::LinearSystem;
use crate::point::Point;
use crate::stability::independent;
use crate::steady::cyclic::Structure;
use appell_runtime::inputs::{ModelInputs, ZeroInputs};
use appell_runtime::linearise::{Linearisation, Undetermined};
use appell_runtime::model::{At, Model};
use appell_runtime::positions::{Inconsistent, Moving, Positions};
use appell_runtime::signal::SignalError;
use appell_spectra::singular::Singular;

/// Pseudo-accelerations in SI up to which a motion counts as steady: typed values have about eight
/// digits.
const STEADY: f64 = 1e-6;
/// Time along the motion after which the equations are compared, in s. It must not be a multiple of
/// the period of a prescribed motion, which is more often a whole or half second than this.
const AHEAD: f64 = 0.7;
/// Entries of A and B that differ by less than this, relative to the largest, are equal: the
/// difference is rounding along the motion.
const SAME_ENTRY: f64 = 1e-9;
/// Singular values that count as zero, relative to the largest: such combinations of inputs do not
/// act on the motion.
const INPUT_RANK: f64 = 1e-9;
/// A Newton step that is shorter, relative to the inputs, ends the search: it converges
/// quadratically.
const CONVERGED_STEP: f64 = 1e-9;
/// Newton steps for the inputs that maintain a motion.
const MOST_STEPS: usize = 20;

/// Where a model is linearised. All in SI.
pub struct OperatingPoint<'a> {
    /// The equations of motion.
    pub model: &'a dyn Model,
    /// State.
    pub x: Vec<f64>,
    /// Declared inputs.
    pub u: Vec<f64>,
    /// Parameters.
    pub p: Vec<f64>,
}

/// ẋ, A and B of a model, row by row.
type Jacobians = (Vec<f64>, Vec<f64>, Vec<f64>);

/// δẋ = A δx + B δu about a steady motion. Where quaternions turn in it, δx are departures after that turning was
/// undone.
#[derive(Debug, Clone, PartialEq)]
pub struct MotionEquations {
    /// The independent states, by their index in the model: rows and columns of A.
    pub states: Vec<usize>,
    /// The inputs, by their index in the model: columns of B.
    pub inputs: Vec<usize>,
    /// A and B.
    pub system: LinearSystem,
    /// Rows that change along the motion, such as those of positions in the ground while the
    /// heading turns. States on which no other row depends may be left out.
    pub varying: Vec<usize>,
    /// Rows of quaternions that turn: their departures are no differences of states.
    pub turning: Vec<usize>,
}

/// Why a model has no linear equations with constant coefficients at this motion.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum OperatingPointError {
    /// A vector does not fit the model.
    #[error("{what}: {found} numbers given, {expected} needed")]
    Length {
        /// Which vector.
        what: &'static str,
        /// Length of the model's vector.
        expected: usize,
        /// Length that was given.
        found: usize,
    },
    /// The motion is not steady.
    #[error("the motion is not steady: state {state} changes by {rate:e} in SI per second")]
    Unsteady {
        /// The pseudo-velocity that changes most.
        state: usize,
        /// Its rate in SI.
        rate: f64,
    },
    /// The equations cannot be evaluated here.
    #[error("the equations have no finite value at this state")]
    NotFinite,
    /// No dependent coordinates satisfy the position constraints.
    #[error(transparent)]
    Inconsistent(#[from] Inconsistent),
    /// The position constraints do not determine the dependent coordinates.
    #[error(transparent)]
    Undetermined(#[from] Undetermined),
    /// A table of the model is not a function of time.
    #[error(transparent)]
    Signal(#[from] SignalError),
}

impl<'a> OperatingPoint<'a> {
    /// The initial state and the parameters of the spec, inputs zero.
    pub fn new(model: &'a dyn Model) -> Self {
        let info = model.info();
        Self {
            model,
            x: info.initial_state(),
            u: vec![0.0; info.declared_inputs],
            p: info.default_parameters(),
        }
    }

    /// Sets the dependent coordinates so that the position constraints hold, from their present values as guesses.
    pub fn assemble(&mut self) -> Result<(), OperatingPointError> {
        self.check()?;
        if let Some(mut positions) = Positions::of(self.model) {
            let (u, moving) = (self.inputs_at(0.0)?, Moving::Dependent);
            positions.restore(self.model, 0.0, &mut self.x, &u, &self.p, moving)?;
        }
        Ok(())
    }

    /// Sets the inputs so that the pseudo-accelerations become as small as possible, by Newton's
    /// method; of many solutions the one nearest to the present inputs.
    pub fn hold(&mut self, inputs: &[usize]) -> Result<(), OperatingPointError> {
        let (n, m) = (self.x.len(), self.model.info().input_len());
        let speeds = self.model.info().speeds;
        for _ in 0..MOST_STEPS {
            let (rates, _, b) = self.jacobians()?;
            let slopes = DMatrix::from_row_slice(n, m, &b)
                .rows(0, speeds)
                .select_columns(inputs);
            let singular = Singular::of(&slopes);
            let wanted = DVector::from_iterator(speeds, rates[..speeds].iter().map(|rate| -rate));
            let step = singular.solve(&wanted, singular.rank(INPUT_RANK));
            for (&input, step) in inputs.iter().zip(step.iter()) {
                self.u[input] += step;
            }
            if step.amax() <= CONVERGED_STEP * self.u.iter().fold(1.0, |most, u| u.abs().max(most))
            {
                break;
            }
        }
        Ok(())
    }

    /// The linear equations for some of the inputs.
    pub fn equations(&self, inputs: &[usize]) -> Result<MotionEquations, OperatingPointError> {
        self.check()?;
        let rates = self.jacobians()?.0;
        let speeds = rates[..self.model.info().speeds].iter().enumerate();
        let fastest = speeds.max_by(|a, b| a.1.abs().total_cmp(&b.1.abs()));
        if let Some((state, &rate)) = fastest.filter(|(_, rate)| rate.abs() > STEADY) {
            return Err(OperatingPointError::Unsteady { state, rate });
        }
        let (turn, still) = self.turn(&rates)?;
        let (states, system) = self.linearise(0.0, &self.x, inputs, &turn)?;
        let mut ahead = self.x.clone();
        for (x, rate) in ahead.iter_mut().zip(&still) {
            *x += AHEAD * rate;
        }
        if let Some(mut positions) = Positions::of(self.model) {
            let u = self.inputs_at(AHEAD)?;
            // Without a configuration there the rows differ, which is reported.
            let _ = positions.restore(
                self.model,
                AHEAD,
                &mut ahead,
                &u,
                &self.p,
                Moving::Dependent,
            );
        }
        let later = self.linearise(AHEAD, &ahead, inputs, &turn)?.1;
        let size = system.a.amax().max(system.b.amax());
        let differs = |row: &usize| {
            let a = (system.a.row(*row) - later.a.row(*row)).amax();
            let b = (system.b.row(*row) - later.b.row(*row)).amax();
            a.max(b).is_nan() || a.max(b) > SAME_ENTRY * size
        };
        Ok(MotionEquations {
            varying: (0..states.len()).filter(differs).collect(),
            turning: (0..states.len())
                .filter(|&row| turn.row(states[row]).amax() > STEADY)
                .collect(),
            inputs: inputs.to_vec(),
            states,
            system,
        })
    }

    /// The turning of quaternions, as a matrix of all states, and the rates without it.
    fn turn(&self, rates: &[f64]) -> Result<(DMatrix<f64>, Vec<f64>), OperatingPointError> {
        let n = rates.len();
        let u = self.inputs_at(0.0)?;
        let (x, p) = (self.x.clone(), self.p.clone());
        // Equations that depend on time have no symmetric rotations here.
        if !self.model.dependent_coordinates().is_empty()
            && let Ok(Structure { turning, .. }) = Structure::of(self.model, &Point { x, u, p })
        {
            return Ok((turning.turn(&self.x, rates), turning.still(&self.x, rates)));
        }
        Ok((DMatrix::zeros(n, n), rates.to_vec()))
    }

    fn check(&self) -> Result<(), OperatingPointError> {
        let info = self.model.info();
        for (what, expected, found) in [
            ("state", info.state_len(), self.x.len()),
            ("inputs", info.declared_inputs, self.u.len()),
            ("parameters", info.parameter_len(), self.p.len()),
        ] {
            if expected != found {
                return Err(OperatingPointError::Length {
                    what,
                    expected,
                    found,
                });
            }
        }
        Ok(())
    }

    /// Declared inputs and signals at a time.
    fn inputs_at(&self, t: f64) -> Result<Vec<f64>, OperatingPointError> {
        let info = self.model.info();
        let mut u = vec![0.0; info.input_len()];
        ModelInputs::new(info, &ZeroInputs)?.fill(t, &self.x, &mut u);
        u[..info.declared_inputs].copy_from_slice(&self.u);
        Ok(u)
    }

    fn jacobians(&self) -> Result<Jacobians, OperatingPointError> {
        self.check()?;
        let (n, u) = (self.x.len(), self.inputs_at(0.0)?);
        let (mut rates, mut a) = (vec![0.0; n], vec![0.0; n * n]);
        let mut b = vec![0.0; n * u.len()];
        let at = At {
            t: 0.0,
            x: &self.x,
            u: &u,
            p: &self.p,
        };
        self.model.jacobians(at, &mut rates, &mut a, &mut b);
        let finite = [&rates, &a, &b]
            .into_iter()
            .flatten()
            .all(|value| value.is_finite());
        if finite {
            Ok((rates, a, b))
        } else {
            Err(OperatingPointError::NotFinite)
        }
    }

    fn linearise(
        &self,
        t: f64,
        x: &[f64],
        inputs: &[usize],
        turn: &DMatrix<f64>,
    ) -> Result<(Vec<usize>, LinearSystem), OperatingPointError> {
        let u = self.inputs_at(t)?;
        let at = At {
            t,
            x,
            u: &u,
            p: &self.p,
        };
        let linear = Linearisation::about(self.model, at)?;
        let n = linear.states.len();
        let b = DMatrix::from_row_slice(n, u.len(), &linear.b);
        let a = DMatrix::from_row_slice(n, n, &linear.a);
        let system = LinearSystem {
            a: a - independent(&linear, self.model.info().speeds, turn),
            b: b.select_columns(inputs),
        };
        Ok((linear.states, system))
    }
}
