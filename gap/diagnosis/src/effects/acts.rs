//! How an effect acts: in the equations, or on an input or a channel.

use appell_estimate::Unknown;

/// How a candidate acts.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Acts {
    /// By items of the spec, with parameters of its own.
    #[default]
    Items,
    /// By the value of a parameter that the spec has.
    Parameter(usize),
    /// By a lag of an input.
    Lag(usize),
    /// By a delay of an input.
    Delay(usize),
    /// By the bias of a channel.
    Bias(usize),
    /// By the scale of a channel.
    Scale(usize),
    /// By the delay of a channel.
    Late(usize),
    /// By the lag of a channel.
    Slow(usize),
}

impl Acts {
    /// The value of the nominal model that is in error.
    pub(crate) const fn in_error(self) -> Option<Unknown> {
        match self {
            Self::Parameter(index) => Some(Unknown::Parameter(index)),
            Self::Scale(channel) => Some(Unknown::Scale(channel)),
            _ => None,
        }
    }

    /// The imperfect channel, for an effect of a sensor.
    pub(crate) const fn channel(self) -> Option<usize> {
        match self {
            Self::Bias(channel)
            | Self::Scale(channel)
            | Self::Late(channel)
            | Self::Slow(channel) => Some(channel),
            Self::Items | Self::Parameter(_) | Self::Lag(_) | Self::Delay(_) => None,
        }
    }
}
