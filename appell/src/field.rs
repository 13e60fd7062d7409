//! The parts of a request, named in errors.

use std::fmt;

macro_rules! fields {
    ($($field:ident $name:literal $about:literal,)*) => {
        /// A part of a request.
        #[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
        #[non_exhaustive]
        pub enum Field {
            $(#[doc = $about] $field,)*
        }

        impl Field {
            /// All of them.
            pub const ALL: &[Self] = &[$(Self::$field),*];

            /// Its name.
            pub fn name(self) -> &'static str {
                match self {
                    $(Self::$field => $name,)*
                }
            }
        }
    };
}

fields! {
    Model "model" "Name or path of a mechanism.",
    Engine "engine" "What evaluates the equations.",
    Set "set" "Values of parameters.",
    Initial "initial" "Initial values.",
    Input "input" "Inputs as expressions.",
    Recorded "recorded inputs" "Inputs from a file.",
    Interpolation "interpolation" "How recorded inputs run from row to row.",
    Feedback "feedback" "Feedback laws.",
    End "end" "Final time of a motion.",
    Interval "interval" "Output interval of a motion.",
    Fix "fix" "Prescribed values of a steady motion.",
    Free "free" "Quantities to solve for, or parameters to estimate.",
    Along "along" "Continuation parameter.",
    Require "require" "Lower bounds of feasible motions.",
    Chart "chart" "Axes of a stability chart.",
    Grid "grid" "Grid of a stability chart.",
    Equation "equation" "Equations of motion typed by hand.",
    About "about" "Steady motion of a symbolic linearisation.",
    At "at" "Steady motion about which a law is designed.",
    Inputs "inputs" "Inputs of a law.",
    Outputs "outputs" "States that are fed back.",
    Poles "poles" "Closed-loop poles.",
    Weights "weights" "Weights of a linear-quadratic regulator.",
    Sampling "sampling" "Sampling period and delay.",
    Schedule "schedule" "Scheduling variable and its values.",
    Attraction "attraction" "Grid of disturbances.",
    Duration "duration" "Duration of the disturbed motions.",
    Plot "plot" "A figure.",
    Recordings "recordings" "Recordings of a mechanism.",
    Also "also" "Lags, delays, biases and scales to estimate.",
    Drifting "drifting" "Parameters that drift, with their rates.",
    Effects "effects" "Library of effects.",
    Effect "effect" "An effect by its name.",
    Hypothesis "hypothesis" "Hypothesis of a gap report.",
    Sources "sources" "Sources of an FMU without machine code.",
    Bias "bias" "Columns with a constant bias.",
    Letters "parameters" "Numbers of a robot that become parameters.",
    Lock "lock" "Joints of a robot that become rigid.",
    Study "study" "Study of an ensemble.",
    Chunk "chunk" "Cases of a chunk of an ensemble.",
    Jobs "jobs" "Threads of an ensemble.",
    Device "device" "What computes the motions of an ensemble.",
}

impl fmt::Display for Field {
    fn fmt(&self, to: &mut fmt::Formatter<'_>) -> fmt::Result {
        to.write_str(self.name())
    }
}
