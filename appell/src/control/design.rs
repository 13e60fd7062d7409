//! Controllability about a steady motion, and gains.

use appell_analysis::control::controllability::Controllability;
use appell_analysis::control::operating_point::{
    MotionEquations, OperatingPoint, OperatingPointError,
};
use appell_analysis::control::reduction::{ReductionError, Subsystem, independent_states, reduce};
use appell_analysis::control::sampled::Sampling;
use appell_analysis::control::{lqr, placement};
use appell_analysis::{Point, Structure};
use appell_runtime::model::Model;
use nalgebra::{Complex, DMatrix};

use super::parse::GivenInputs;
use super::remedies;
use crate::setup::Setup;
use crate::{Error, Field};

/// A request with its names resolved.
#[derive(Debug, Clone)]
pub struct Goal {
    /// The inputs of the law.
    pub inputs: Vec<usize>,
    /// The states that are fed back; empty if they are to be chosen.
    pub outputs: Vec<usize>,
    /// The design method.
    pub method: Method,
    /// Sampling and delay of a discrete-time controller.
    pub sampling: Option<Sampling>,
}

/// The design method.
#[derive(Debug, Clone)]
pub enum Method {
    /// No law is designed.
    None,
    /// Closed-loop poles in 1/s.
    Poles(Vec<Complex<f64>>),
    /// Diagonal weights.
    Weights {
        /// Q.
        outputs: Vec<f64>,
        /// R.
        inputs: Vec<f64>,
    },
}

/// A design, in SI.
#[derive(Debug)]
pub struct Design {
    /// State on the steady motion.
    pub x: Vec<f64>,
    /// Declared inputs on the steady motion.
    pub u: Vec<f64>,
    /// Parameters.
    pub p: Vec<f64>,
    /// Rates of the states: ignorable ones advance uniformly.
    pub rates: Vec<f64>,
    /// A and B about it.
    pub equations: MotionEquations,
    /// Controllability.
    pub controllability: Controllability,
    /// The states that are fed back, by their index in the model.
    pub outputs: Vec<usize>,
    /// Their closed subsystem.
    pub subsystem: Subsystem,
    /// The gains.
    pub law: Option<DesignedGains>,
}

/// Gains and the closed loop.
#[derive(Debug)]
pub struct DesignedGains {
    /// A row for each input, a column for each output and then for each pending input.
    pub gain: DMatrix<f64>,
    /// Closed-loop poles: in 1/s, or z of a sampled loop.
    pub poles: Vec<Complex<f64>>,
    /// Sampling and delay of a discrete-time controller.
    pub sampling: Option<Sampling>,
    /// Residual of the design equations.
    pub residual: f64,
    /// Condition number of the eigenvectors, for pole placement.
    pub condition: Option<f64>,
}

impl DesignedGains {
    /// Closed-loop poles that do not decay, perhaps for want of a sign.
    pub fn growing(&self) -> usize {
        let grows = |pole: &&Complex<f64>| match self.sampling {
            None => pole.re >= 0.0,
            Some(_) => pole.norm() >= 1.0,
        };
        self.poles.iter().filter(grows).count()
    }
}

/// A state with a larger rate, in SI, advances along the motion.
const RUNS: f64 = 1e-6;

impl Design {
    /// The rate of a state that advances along the motion; 0 for the others.
    pub fn running(&self, state: usize) -> f64 {
        let rate = self.rates[state];
        if rate.abs() > RUNS { rate } else { 0.0 }
    }

    /// Value of a state on the steady motion at time `t` in s.
    pub fn desired(&self, state: usize, t: f64) -> f64 {
        self.x[state] + t * self.running(state)
    }
}

/// Designs a law about a steady motion; without a method, determines controllability only.
pub fn design(
    model: &dyn Model,
    setup: &Setup<'_>,
    given: &GivenInputs,
    request: &Goal,
) -> Result<Design, Error> {
    let mut point = OperatingPoint::new(model);
    point.x.clone_from(&setup.initial);
    point.p.clone_from(&setup.parameters);
    let named = |input: &usize| given.iter().any(|(other, _)| other == input);
    for &(input, value) in given {
        point.u[input] = value;
    }
    let open: Vec<usize> = (0..point.u.len()).filter(|input| !named(input)).collect();
    let unsteady = |error| remedies::operating_point(error, setup);
    point.assemble().map_err(unsteady)?;
    point.hold(&open).map_err(unsteady)?;
    let equations = point.equations(&request.inputs).map_err(unsteady)?;
    let controllability = Controllability::of(&equations.system).map_err(Error::computation)?;
    let at = place(model, &point);
    let rates = at.rates(model);
    let outputs = match &request.outputs[..] {
        [] => closed_choice(setup, &equations, &rates)?,
        asked => places(setup, &equations, asked)?,
    };
    if let Some(&varying) = outputs.iter().find(|at| equations.varying.contains(at)) {
        let advancing = advancing(model, &at, &rates).map(unsteady);
        return Err(advancing.unwrap_or_else(|| varies(setup, &equations, varying, request)));
    }
    if let Some(&turning) = outputs.iter().find(|at| equations.turning.contains(at)) {
        return Err(turns(setup, &equations, turning));
    }
    let subsystem = reduce(&equations.system, &outputs)
        .map_err(|error| remedies::reduction(&error, &equations, setup))?;
    let law = law(&subsystem, request)?;
    Ok(Design {
        x: point.x,
        u: point.u,
        p: point.p,
        rates,
        controllability,
        outputs: outputs
            .iter()
            .map(|&place| equations.states[place])
            .collect(),
        equations,
        subsystem,
        law,
    })
}

/// The motion as a point of the model.
fn place(model: &dyn Model, point: &OperatingPoint<'_>) -> Point {
    let mut at = Point {
        x: point.x.clone(),
        p: point.p.clone(),
        ..Point::initial(model)
    };
    at.u[..point.u.len()].copy_from_slice(&point.u);
    at
}

/// A state on which accelerations depend and which advances: the motion is not steady.
fn advancing(model: &dyn Model, at: &Point, rates: &[f64]) -> Option<OperatingPointError> {
    let structure = Structure::of(model, at).ok()?;
    let mut essential = structure.essential.iter().copied();
    let rates = structure.still(&at.x, rates);
    let state = essential.find(|&state| rates[state].abs() > RUNS)?;
    let rate = rates[state];
    Some(OperatingPointError::Unsteady { state, rate })
}

/// A row that varies along a motion whose accelerations do not.
fn varies(setup: &Setup<'_>, equations: &MotionEquations, place: usize, request: &Goal) -> Error {
    let name = &setup.info.states[equations.states[place]].name;
    let message = format!(
        "the linearised equation of `{name}` varies along this motion, so that constant gains cannot be \
         designed for it"
    );
    if request.outputs.is_empty() {
        Error::request(Field::At, format!("{message}; prescribe another motion"))
    } else {
        Error::request(Field::Outputs, format!("{message}; remove it"))
    }
}

/// A component of a quaternion that turns: its difference from the motion is no departure.
fn turns(setup: &Setup<'_>, equations: &MotionEquations, place: usize) -> Error {
    let name = &setup.info.states[equations.states[place]].name;
    let message = format!(
        "`{name}` turns along this motion, so that constant gains of it are no law; feed back pseudo-velocities, or \
         write the attitude by angles of which those that matter are constant"
    );
    Error::request(Field::Outputs, message)
}

/// A controllable set of states with closed equations, by their indices among those of the equations.
fn closed_choice(
    setup: &Setup<'_>,
    equations: &MotionEquations,
    rates: &[f64],
) -> Result<Vec<usize>, Error> {
    // Constant states before advancing ones; coordinates on which accelerations depend, other
    // coordinates, pseudo-velocities.
    let (states, a) = (&equations.states, &equations.system.a);
    let is_speed = |place: usize| states[place] < setup.info.speeds;
    let is_felt = |place: usize| {
        let mut speeds = (0..states.len()).filter(|&row| is_speed(row));
        speeds.any(|row| a[(row, place)] != 0.0)
    };
    let mut candidates: Vec<usize> = (0..states.len()).collect();
    candidates
        .retain(|place| !equations.varying.contains(place) && !equations.turning.contains(place));
    let runs = |place: usize| rates[states[place]].abs() > RUNS;
    candidates.sort_by_key(|&place| (runs(place), is_speed(place), !is_felt(place)));
    let mut chosen = independent_states(&equations.system, &candidates);
    if let Err(ReductionError::Open { missing, .. }) = reduce(&equations.system, &chosen) {
        chosen.extend(missing);
    }
    chosen.sort_unstable();
    if chosen.is_empty() {
        let message = "the inputs affect no state at this operating point";
        return Err(Error::request(Field::At, message));
    }
    Ok(chosen)
}

/// The requested outputs, by their indices among the states of the equations.
fn places(
    setup: &Setup<'_>,
    equations: &MotionEquations,
    asked: &[usize],
) -> Result<Vec<usize>, Error> {
    let place = |&state: &usize| {
        let place = equations.states.iter().position(|&other| other == state);
        place.ok_or_else(|| {
            let message = format!(
                "`{}` is determined by other coordinates through the position constraints; feed \
                 those back",
                setup.info.states[state].name
            );
            Error::request(Field::Outputs, message)
        })
    };
    asked.iter().map(place).collect()
}

fn law(subsystem: &Subsystem, request: &Goal) -> Result<Option<DesignedGains>, Error> {
    let (system, sampling) = (&subsystem.system, request.sampling);
    let (n, m) = (system.order(), system.inputs());
    let (gain, poles, residual, condition) = match &request.method {
        Method::None => return Ok(None),
        Method::Poles(poles) => {
            let poles = match poles[..] {
                [single] if single.im.abs() <= 0.0 => vec![single; n],
                _ => poles.clone(),
            };
            let placed = match sampling {
                None => placement::place(system, &poles),
                Some(sampling) => sampling.place(system, &poles),
            };
            let placed = placed.map_err(remedies::placement)?;
            let condition = Some(placed.condition);
            (placed.gain, placed.poles, placed.residual, condition)
        }
        Method::Weights { outputs, inputs } => {
            let (q, r) = (diagonal("Q", outputs, n)?, diagonal("R", inputs, m)?);
            let regulator = match sampling {
                None => lqr::continuous(system, &q, &r),
                Some(sampling) => sampling.regulate(system, &q, &r),
            };
            let regulator = regulator.map_err(remedies::riccati)?;
            (regulator.gain, regulator.poles, regulator.residual, None)
        }
    };
    Ok(Some(DesignedGains {
        gain,
        poles,
        sampling,
        residual,
        condition,
    }))
}

fn diagonal(name: &str, weights: &[f64], count: usize) -> Result<DMatrix<f64>, Error> {
    let weights = match weights {
        [single] => vec![*single; count],
        _ => weights.to_vec(),
    };
    if weights.len() == count {
        return Ok(lqr::weights(&weights));
    }
    let each = if name == "Q" { "outputs" } else { "inputs" };
    let message = format!(
        "{} weights in {name} for {count} {each}; write one for each, or a single one for all",
        weights.len()
    );
    Err(Error::request(Field::Weights, message))
}
