//! The closed loops of the paper on the nonlinear unicycle.

use crate::book::{Result, failed};
use crate::steering::OUTPUTS;
use appell_runtime::integrate::Options;
use appell_runtime::simulate::{Sampling, SimulationError};
use appell_runtime::trajectory::Extras;
use appell_runtime::{Simulation, Trajectory};

use super::tables::placed;
use appell::engine::Equations;
use appell::inputs::controller::Plan;
use appell::inputs::feedback;
use appell::setup::Setup;
use appell::source::Source;

/// A path from 2 s to 7 s: half its length, and its end.
#[derive(Debug, Clone, Copy)]
pub(super) struct Path {
    /// Whether the yaw angle follows it; else the lateral position does.
    pub(super) turn: bool,
    /// Of the cosine.
    pub(super) amplitude: f64,
    /// From 7 s on.
    pub(super) end: f64,
}

impl Path {
    /// A lane change over a width in m to the right, as corrected: (66).
    pub(super) const fn lane(width: f64) -> Self {
        Self {
            turn: false,
            amplitude: width / 2.0,
            end: -width,
        }
    }

    /// The same as printed: it jumps.
    pub(super) fn printed_lane(width: f64) -> Self {
        Self {
            amplitude: width,
            ..Self::lane(width)
        }
    }

    /// A right turn by 90°, as corrected: (71).
    pub(super) const TURN: Self = Self {
        turn: true,
        amplitude: std::f64::consts::FRAC_PI_4,
        end: -std::f64::consts::FRAC_PI_2,
    };

    /// The desired value.
    fn at(self, t: f64) -> f64 {
        if t < 2.0 {
            0.0
        } else if t < 7.0 {
            self.amplitude * ((std::f64::consts::PI * (t - 2.0) / 5.0).cos() - 1.0)
        } else {
            self.end
        }
    }

    /// The desired values at the times of a motion.
    pub(super) fn along(self, motion: &Trajectory) -> Vec<f64> {
        motion.times().iter().map(|t| self.at(*t)).collect()
    }

    /// Its jump at 7 s.
    pub(super) fn jump(self) -> f64 {
        (self.at(7.0) - self.at(7.0_f64.next_down())).abs()
    }

    fn outputs(self) -> &'static [&'static str] {
        if self.turn { &OUTPUTS[..5] } else { &OUTPUTS }
    }
}

/// A closed loop with the gains of one speed, run at another.
#[derive(Debug, Clone, Copy)]
pub(super) struct Run {
    pub(super) path: Path,
    /// Speed of the gains in m/s.
    pub(super) gains_at: f64,
    /// Speed of the run in m/s.
    pub(super) speed: f64,
}

impl Run {
    /// Gains of the speed of the run.
    pub(super) const fn new(path: Path, speed: f64) -> Self {
        Self {
            path,
            gains_at: speed,
            speed,
        }
    }

    /// Ten seconds, recorded every `interval` seconds; shorter if the motion ends early.
    pub(super) fn motion(self, interval: f64) -> Result<(Trajectory, Option<String>)> {
        let source = Source::find("unicycle")?;
        let equations = Equations::at_hand(&source)?;
        let mut setup = Setup::new(&source.file, &source.text, equations.model().info())?;
        let law = feedback::parse("law.toml", &self.law()?, &setup)?;
        law.start(&mut setup)?;
        let mut plan = Plan::new(&setup);
        plan.feedback(law)?;
        let wiring = plan.wiring(&setup, 10.0)?;
        let controller = wiring.controller(equations.model(), setup.parameters.clone(), 10.0);
        let simulation = Simulation {
            parameters: setup.parameters.clone(),
            initial_state: setup.initial.clone(),
            inputs: &controller,
            options: Options::with_tolerances(1e-12, 1e-12),
            sampling: Sampling::Every(interval),
            extras: Extras {
                contacts: true,
                ..Extras::default()
            },
            ..Simulation::new(equations.model())
        };
        match simulation.run() {
            Ok(motion) => Ok((motion, None)),
            Err(error) => {
                let reason = error.to_string();
                match error {
                    SimulationError::Integration { trajectory, .. } => {
                        Ok((*trajectory, Some(reason)))
                    }
                    _ => Err(failed(&reason)),
                }
            }
        }
    }

    /// The law as a file for `simulate --feedback`.
    fn law(self) -> Result<String> {
        let outputs = self.path.outputs();
        let gains = placed(self.gains_at, outputs)?;
        let gains: Vec<String> = gains.iter().map(|gain| format!("{gain:?}")).collect();
        let followed = outputs.last().copied().unwrap_or_default();
        let Path { amplitude, end, .. } = self.path;
        Ok(format!(
            "mechanism = \"unicycle\"\ninput = \"u\"\nstates = {outputs:?}\ngains = [{}]\n\
             switching_times_s = [2, 7]\n[desired]\n{followed} = \"if(t < 2, 0, if(t < 7, \
             {amplitude:?}*(cos(pi*(t - 2)/5) - 1), {end:?}))\"\n[initial]\nomega_2 = \"{:?}[m/s]/R\"\n",
            gains.join(", "),
            self.speed
        ))
    }
}

/// The largest absolute value of a column, in SI.
pub(super) fn largest(motion: &Trajectory, name: &str) -> f64 {
    let column = motion.column(name).unwrap_or_default();
    column
        .into_iter()
        .fold(0.0, |most, value| value.abs().max(most))
}
