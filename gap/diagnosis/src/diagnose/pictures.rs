//! Data of the plots of a gap report.

/// Data of the plots.
#[derive(Debug, Clone, PartialEq)]
pub struct Pictures {
    /// The missing force of each equation.
    pub force_history: ForceHistory,
    /// Channels of the first held-out run.
    pub traces: Vec<Trace>,
    /// The missing force; `None` without a gap in the equations.
    pub force_law: Option<ForceLaw>,
    /// Of a robot, the missing torque of each joint over its rate and over its position.
    pub joints: Vec<[ForceLaw; 2]>,
}

/// The missing force of each equation over time.
#[derive(Debug, Clone, PartialEq)]
pub struct ForceHistory {
    /// Length of a part in s.
    pub part: f64,
    /// Runs: file, begin in s, parts.
    pub runs: Vec<(String, f64, usize)>,
    /// Equations.
    pub equations: Vec<MissingForce>,
}

/// The missing force of one equation.
#[derive(Debug, Clone, PartialEq)]
pub struct MissingForce {
    /// Pseudo-velocity.
    pub name: String,
    /// Unit of the force.
    pub unit: String,
    /// Median of its absolute value in each part of the runs, one after the other.
    pub medians: Vec<f64>,
}

/// A channel of a run with its predictions, [`AHEAD`](super::AHEAD) seconds ahead, in the unit of the channel.
#[derive(Debug, Clone, PartialEq)]
pub struct Trace {
    /// File of the run.
    pub run: String,
    /// Column.
    pub column: String,
    /// Unit.
    pub unit: String,
    /// Times in s.
    pub times: Vec<f64>,
    /// Measured values.
    pub measured: Vec<f64>,
    /// Prediction with the parameters stated by the data set.
    pub nominal: Vec<f64>,
    /// Prediction with fitted parameters.
    pub refitted: Vec<f64>,
    /// Prediction of the best hypothesis.
    pub with_effect: Vec<f64>,
    /// Expected standard deviation of the errors of the best hypothesis.
    pub deviation: f64,
}

/// Data and law over a variable: the force in SI, the variable in the unit of the spec.
#[derive(Debug, Clone, PartialEq)]
pub struct ForceLaw {
    /// The pseudo-velocity whose equation lacks the force.
    pub equation: String,
    /// Unit of the force.
    pub unit: String,
    /// A state or an input.
    pub variable: String,
    /// Its unit.
    pub variable_unit: String,
    /// Points along the recordings: variable, force.
    pub points: Vec<[f64; 2]>,
    /// Median of the force in each part of the variable.
    pub medians: Vec<[f64; 2]>,
    /// The law of the best hypothesis; empty if none acts in the equations.
    pub law: Vec<[f64; 2]>,
}
