//! Inputs within a step of co-simulation.

/// The inputs within a communication step of co-simulation.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum InputsOfStep {
    /// Their values at its start, as a drive holds a command.
    #[default]
    Held,
    /// Lines through their values at its start and at the start of the step before, for samples of continuous signals.
    /// In the first step they are held, and so is what is not set again.
    Lines,
}
