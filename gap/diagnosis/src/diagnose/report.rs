//! The gap report, with the names of its format.

use appell_recordings::{DataSet, Spec};
use nalgebra::DMatrix;
use serde::Serialize;

pub use super::advice::{Advice, Open};
use super::calibration::TIED;
use super::changes::{Changes, Refitted};
pub use super::verdict::GapVerdict;
pub use super::yardstick::{QUANTILE, Value, Yardstick};

/// Name of the hypothesis that nothing in the library explains the gap.
pub(super) const UNKNOWN: &str = "unknown";
/// The re-fitted parameters in the budget.
pub(super) const REFIT: &str = "refit";
/// The measured law in the budget.
pub(super) const LAW: &str = "law";
/// The unexplained remainder in the budget.
pub(super) const REST: &str = "unexplained";

/// A hypothesis with its probability.
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
pub struct Hypothesis {
    /// Names of its effects; none for the nominal model, `unknown` for none of the library.
    pub effects: Vec<String>,
    /// Probability; zero for one that is equivalent to another.
    pub probability: f64,
    /// The equivalent hypothesis, which includes its probability.
    pub same_as: Option<Vec<String>>,
    /// Logarithm of the Bayes factor against the nominal model.
    pub log_bayes_factor: Option<f64>,
    /// Estimates of its effects.
    pub parameters: Vec<Value>,
    /// Its changes of the spec; for `unknown` the measured law, if there is one.
    pub changes: Option<Changes>,
}

impl Hypothesis {
    /// The hypothesis that no effect of the library explains the gap.
    pub(super) fn unknown(probability: f64) -> Self {
        Self {
            effects: vec![UNKNOWN.to_owned()],
            probability,
            ..Self::default()
        }
    }

    /// Whether it is the hypothesis that no effect of the library explains the gap.
    pub fn is_unknown(&self) -> bool {
        self.effects == [UNKNOWN]
    }

    /// The values of an effect.
    pub fn values_of(&self, effect: &str) -> impl Iterator<Item = &Value> {
        let own = self.parameters.iter();
        own.filter(move |value| value.effect() == effect)
    }

    /// The size of an effect that is implausibly large, if one is.
    pub fn implausible(&self, effect: &str) -> Option<&Yardstick> {
        let determined = self.values_of(effect).filter(|value| value.is_determined);
        let mut known = determined.filter_map(|value| value.yardstick.as_ref());
        known.find(|known| known.is_large)
    }

    /// The parameter whose wrong value an effect describes, if it is one.
    pub fn wrong_parameter(&self, effect: &str) -> Option<&Refitted> {
        let (_, site) = effect.split_once('@')?;
        let mut parameters = self.changes.as_ref()?.parameters.iter();
        parameters.find(|one| one.name == site)
    }
}

/// An equation and its part in the gap.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ShareOf {
    /// Pseudo-velocity.
    pub name: String,
    /// Part of the whitened energy of the gap.
    pub share: f64,
    /// Probability of such a gap by chance.
    pub p_value: f64,
    /// Root of the mean square of the missing force.
    pub rms: f64,
    /// Its unit.
    pub unit: String,
}

/// A window of time in which the gap shows.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Window {
    /// File of the run.
    pub run: String,
    /// Begin in s.
    #[serde(rename = "from_s")]
    pub from: f64,
    /// End in s.
    #[serde(rename = "to_s")]
    pub to: f64,
    /// Pseudo-velocity; empty for a channel whose predictions fail.
    pub equation: String,
    /// Size in standard deviations.
    pub z: f64,
    /// The channel whose predictions also fail there under the best hypothesis; `None` if that explains the gap.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub unexplained: Option<String>,
}

/// A region of the state space in which the gap shows.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Region {
    /// Variable.
    pub variable: String,
    /// Where it is.
    pub description: String,
    /// Size in standard deviations.
    pub z: f64,
}

/// Where the gap lies.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Where {
    /// Force, parameter, actuator, constraint, sensor or none.
    pub domain: &'static str,
    /// Equations, the greatest share first.
    pub equations: Vec<ShareOf>,
    /// Windows of time.
    pub windows: Vec<Window>,
    /// Regions.
    pub region: Vec<Region>,
}

impl Default for Where {
    /// No gap.
    fn default() -> Self {
        Self {
            domain: "none",
            equations: Vec::new(),
            windows: Vec::new(),
            region: Vec::new(),
        }
    }
}

/// A part of the gap.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Share {
    /// `refit`, an effect, `law` for a force that was measured, or `unexplained`.
    #[serde(rename = "effect")]
    pub name: String,
    /// Part of the gap of the nominal model, on the held-out runs.
    pub closed: f64,
    /// Its interval of 95 %, over blocks of time.
    pub interval: [f64; 2],
    /// Whether it is large enough to name a cause: above the tolerance, relative to the gap of the re-fitted
    /// model.
    #[serde(rename = "material")]
    pub is_material: bool,
}

impl Share {
    /// Whether it is that of the re-fitted parameters.
    pub fn is_refit(&self) -> bool {
        self.name == REFIT
    }

    /// Whether it is that of a measured law.
    pub fn is_law(&self) -> bool {
        self.name == LAW
    }

    /// Whether it is that of an effect.
    pub fn is_effect(&self) -> bool {
        !(self.is_refit() || self.is_law() || self.is_rest())
    }

    /// Whether it is the unexplained remainder.
    pub fn is_rest(&self) -> bool {
        self.name == REST
    }
}

/// Prediction errors on held-out runs, in units of the noise.
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
#[expect(missing_docs, reason = "the words of the contract")]
pub struct HowFar {
    pub horizon_s: f64,
    pub nominal: f64,
    pub refitted: f64,
    pub with_effect: f64,
    pub noise_floor: f64,
    pub closed: f64,
    pub closed_ci95: [f64; 2],
    pub closed_vs_refitted: f64,
    /// Error of the nominal model on earlier recordings, scaled by the ratio of its expected errors.
    pub before: Option<f64>,
    /// Relative reduction of the mean square error of the nominal model by the leading hypothesis, and of that of the
    /// re-fitted one, between quantiles of 2.5 and 97.5 %.
    pub bettered_ci95: [[f64; 2]; 2],
    /// The shares of the gap.
    pub budget: Vec<Share>,
    /// The same errors of each channel, or of each force, in its unit.
    pub channels: Vec<ErrorOf>,
    /// Whether the leading hypothesis predicts significantly worse than the re-fitted model.
    #[serde(skip)]
    pub is_worse: bool,
    pub runs: Vec<String>,
}

/// Prediction errors of a channel, root of the mean square over the horizon.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[expect(missing_docs, reason = "the words of the contract")]
pub struct ErrorOf {
    pub name: String,
    pub unit: String,
    pub nominal: f64,
    pub refitted: f64,
    pub with_effect: f64,
}

/// The smallest detectable size of an effect.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Detectable {
    /// Effect.
    pub effect: String,
    /// Size.
    pub smallest: f64,
    /// Its unit.
    pub unit: String,
}

/// Root of the mean square of the errors at a horizon, in units of the noise.
#[derive(Debug, Clone, PartialEq)]
#[expect(missing_docs, reason = "the words of the contract")]
pub struct Ahead {
    /// In s: 0 is one step, infinity the free run to the end.
    pub horizon: f64,
    pub nominal: f64,
    pub refitted: f64,
    pub with_effect: f64,
    /// Expected by the filter; `None` for the free run.
    pub noise_floor: Option<f64>,
}

/// The residual of the best hypothesis as a nonparametric law: a force or an error of a channel.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Left {
    /// Pseudo-velocity of the equation with the force, or channel with the error.
    pub place: String,
    /// Its variable.
    pub variable: String,
    /// Both in words.
    pub about: String,
    /// Logarithm of the Bayes factor for it.
    pub log_bayes_factor: f64,
    /// Its gain in log likelihood.
    pub gain: f64,
    /// Gain of the best hypothesis over the nominal model.
    pub explained: f64,
}

impl Left {
    /// Whether its odds are twenty or more.
    pub fn is_there(&self) -> bool {
        self.log_bayes_factor > TIED
    }
}

/// A measured law.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Law {
    /// The pseudo-velocity whose equation has the force.
    pub equation: String,
    /// Unit of the force, or of the curve that the factor multiplies.
    pub unit: String,
    /// Its variable and factor, in words.
    pub depends_on: String,
    /// The variable of the curve.
    pub variable: String,
    /// Its unit.
    pub variable_unit: String,
    /// Its factor, in the language of a spec, if any.
    pub factor: Option<String>,
    /// The variable, the force, its standard deviation.
    pub curve: Vec<[f64; 3]>,
    /// Logarithm of the Bayes factor for it.
    pub log_bayes_factor: f64,
    /// Closed forms close to it, the most probable first.
    pub forms: Vec<Form>,
}

/// A form with its evidence.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Form {
    /// With the names of the spec, up to factors: `omega*abs(omega)`.
    #[serde(rename = "form")]
    pub text: String,
    /// Its gain relative to that of the law.
    pub share: f64,
    /// Logarithm of the Bayes factor for it.
    pub log_bayes_factor: f64,
}

/// A channel outside the model on which the gap of the nominal model depends.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Hint {
    /// The channel, or its rate.
    pub variable: String,
    /// Pseudo-velocity of the equation whose missing force depends on it most.
    pub equation: String,
    /// Gain of such a force in log likelihood.
    pub gain: f64,
    /// Logarithm of the Bayes factor for it.
    pub log_bayes_factor: f64,
}

/// Stated tolerances that the re-fitted parameters contradict.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Tolerances {
    /// The most probable factor on all of them.
    pub factor: f64,
    /// Logarithm of the Bayes factor for it.
    pub log_bayes_factor: f64,
}

/// A held input for which linear interpolation between rows fits better.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Interpolated {
    /// Channel.
    pub input: String,
    /// Increase of the log likelihood under the best hypothesis.
    pub log_likelihood: f64,
}

/// Changes since the earlier recordings.
#[derive(Debug, Clone, PartialEq)]
pub struct Change {
    /// Whether there is a material change.
    pub is_changed: bool,
    /// The earlier diagnosis: its verdict, and the effects that were added to the spec.
    pub before: (GapVerdict, Vec<String>),
    /// Estimates of the parameters from the earlier recordings.
    pub parameters: Vec<Before>,
}

/// An earlier estimate of a parameter.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Before {
    /// Name.
    pub name: String,
    /// Value in SI.
    pub value: f64,
    /// Its standard deviation in SI.
    pub std: f64,
    /// Standard deviation from run to run in SI, in excess of that.
    pub spread: f64,
}

/// A limit stated by the user, in SI: a column with its smallest and largest value.
pub type Limit = (String, [f64; 2]);

/// Options of a diagnosis.
#[derive(Debug, Clone, Default)]
pub struct Options {
    /// Whether to include the data of the plots: traces, and the missing force over its variable.
    pub pictures: bool,
    /// Limits of the next experiment; by default it stays near the recorded ranges.
    pub limits: Vec<Limit>,
    /// Other specs of the same rig, each a hypothesis of its own.
    pub alternatives: Vec<Spec>,
    /// Horizon in s at which the gap is reported; by default 1 s, limited by the length of the runs.
    pub horizon: Option<f64>,
    /// Share of the gap of the re-fitted model below which an effect is not reported as a cause; by default 0.02.
    pub tolerance: Option<f64>,
    /// Names of effects that the spec contains already, which are no hypotheses.
    pub present: Vec<String>,
}

/// An input that separates two hypotheses.
#[derive(Debug, Clone, PartialEq)]
pub struct Experiment {
    /// The effects of both.
    pub separates: [Vec<String>; 2],
    /// The input, in words.
    pub about: String,
    /// Their separation by the present recordings, in standard deviations.
    pub separation_now: f64,
    /// Their separation by a recording of this experiment.
    pub separation_then: f64,
    /// Times in s.
    pub times: Vec<f64>,
    /// Inputs of the spec with their values in SI, each held until the next time.
    pub inputs: Vec<(String, Vec<f64>)>,
}

/// A member of a hypothesis in a sentence.
#[derive(Debug, Clone, PartialEq)]
pub struct Found {
    /// Name.
    pub effect: String,
    /// Sentence.
    pub about: String,
    /// Its sites in the mechanism.
    pub sites: Vec<String>,
}

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

/// The whole report.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Report {
    /// Name of the mechanism.
    pub mechanism: String,
    /// The format of the robot file that is the mechanism, if it is one.
    pub robot: Option<&'static str>,
    /// Joints of that robot that the description locks.
    pub locked: Vec<String>,
    /// The result in one word.
    pub verdict: GapVerdict,
    /// Whether simulations over windows rank the hypotheses, as they did not confirm the one-step predictions.
    pub is_by_simulation: bool,
    /// Whether forces of the recorded motions rank them; then errors are those of forces, without a horizon, and
    /// disturbances are residual forces.
    pub is_by_forces: bool,
    /// Rows of the training runs: those that were fitted, and all.
    pub rows: [usize; 2],
    /// Where the gap lies.
    pub place: Where,
    /// Hypotheses, the most probable first.
    pub which: Vec<Hypothesis>,
    /// Hypotheses that cannot be distinguished, each a list of effects.
    pub tied: Vec<Vec<Vec<String>>>,
    /// How far the gap closes; `None` without held-out runs.
    pub how_far: Option<HowFar>,
    /// The smallest detectable sizes.
    pub detectable: Vec<Detectable>,
    /// Hypotheses whose fit failed or ended before an optimum, with the reason.
    pub failed: Vec<(Vec<String>, String)>,
    /// Process noise: name, level under the nominal model and under the best one.
    pub disturbances: Vec<(String, f64, f64)>,
    /// The residual of the best hypothesis; `None` if no law generalises to other runs.
    pub left: Option<Left>,
    /// Effective sample size relative to the number of samples; less than one if the innovations of
    /// the best hypothesis are autocorrelated.
    pub independent: f64,
    /// The measured law of that residual; `None` if it is no force that depends on quantities of the model.
    pub law: Option<Law>,
    /// Changes; `None` without earlier recordings.
    pub change: Option<Change>,
    /// Channels outside the model on which the gap depends, the most probable first.
    pub hints: Vec<Hint>,
    /// Tolerances that are too small, under the best hypothesis.
    pub tolerances: Option<Tolerances>,
    /// Inputs for which linear interpolation fits better, under the best hypothesis.
    pub interpolated: Vec<Interpolated>,
    /// Effects of the best hypothesis in words.
    pub found: Vec<Found>,
    /// Errors over horizons; empty without held-out runs.
    pub horizons: Vec<Ahead>,
    /// Data of the plots, if requested.
    pub pictures: Option<Pictures>,
    /// An experiment that separates the first two tied hypotheses.
    pub experiment: Option<Experiment>,
}

impl Report {
    /// Without results, of a rig.
    pub(super) fn of(set: &DataSet) -> Self {
        let robot = set.robot.as_ref();
        Self {
            mechanism: set.mechanism.name.clone(),
            robot: robot.map(|robot| robot.format.word()),
            locked: robot.map_or_else(Vec::new, |robot| robot.locked.clone()),
            ..Self::default()
        }
    }

    /// The most probable hypothesis of the library.
    pub fn leading(&self) -> Option<&Hypothesis> {
        self.which.iter().find(|one| !one.is_unknown())
    }

    /// The tied hypotheses that are not equivalent, the most probable first.
    pub(super) fn rivals(&self) -> Vec<&[String]> {
        let says_its_own = |effects: &&Vec<String>| {
            let mut which = self.which.iter();
            which.any(|one| one.effects == **effects && one.same_as.is_none())
        };
        let tied = self.tied.first().into_iter().flatten();
        tied.filter(says_its_own).map(Vec::as_slice).collect()
    }
}

/// Estimates of parameters.
pub(super) struct Told {
    pub(super) parameters: Vec<Before>,
    /// Covariance of their errors, plus the variance from run to run.
    pub(super) covariance: DMatrix<f64>,
}
