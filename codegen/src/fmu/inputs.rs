//! Inputs within a step of co-simulation.

/// The inputs within a communication step of co-simulation.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum InputsOfStep {
    /// Held at their values at its start, as a drive holds a command.
    #[default]
    Held,
    /// Extrapolated linearly from their values at its start and at the start of the previous step, for samples
    /// of continuous signals. In the first step they are held, and so are inputs that are not set again.
    Lines,
}
