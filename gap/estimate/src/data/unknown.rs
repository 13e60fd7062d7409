//! The values on which a likelihood depends.

/// One of the values, all in SI.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Unknown {
    /// A parameter of the model.
    Parameter(usize),
    /// Level of a disturbance, see [`Disturbance`](crate::Disturbance).
    Disturbance(usize),
    /// Standard deviation of the noise of a channel.
    Noise(usize),
    /// Bias of a channel.
    Bias(usize),
    /// Scale of a channel.
    Scale(usize),
    /// Delay of a channel in s; only if the setup admits one.
    SensorDelay(usize),
    /// Time constant in s of a lagging input, by its index in the setup, or of a lagging channel, see
    /// [`Setup::lag_of_channel`](crate::Setup::lag_of_channel).
    Lag(usize),
    /// Delay in s of an input, by its index in the setup.
    InputDelay(usize),
    /// Expected state at the first row of a run; states of lags and drifting parameters come last.
    Initial {
        /// The run.
        run: usize,
        /// The state.
        state: usize,
    },
    /// Standard deviation of the state at the first row of a run.
    Spread {
        /// The run.
        run: usize,
        /// The state.
        state: usize,
    },
}

impl Unknown {
    /// Whether it affects the variances of innovations and not their mean.
    pub fn is_level(self) -> bool {
        matches!(
            self,
            Self::Disturbance(_) | Self::Noise(_) | Self::Spread { .. }
        )
    }
}
