//! Why a controller cannot be designed, in the names of the mechanism.

use appell_analysis::control::operating_point::{MotionEquations, OperatingPointError};
use appell_analysis::control::placement::PlacementError;
use appell_analysis::control::reduction::ReductionError;
use appell_analysis::control::riccati::RiccatiError;
use nalgebra::Complex;

use crate::failure::Failure;
use crate::setup::Setup;
use crate::table::number;

/// About the motion.
pub(crate) fn operating_point(error: &OperatingPointError, setup: &Setup<'_>) -> Failure {
    match error {
        OperatingPointError::Unsteady { state, rate } => {
            let quantity = &setup.info.states[*state];
            Failure::Usage(format!(
                "the motion is not steady: `{}` changes by {} {} per second; give values of a \
                 steady motion with `--at`",
                quantity.name,
                number(quantity.to_unit(*rate)),
                quantity.unit
            ))
        }
        other => Failure::Computation(other.to_string()),
    }
}

/// About the outputs.
pub(crate) fn reduction(
    error: &ReductionError,
    equations: &MotionEquations,
    setup: &Setup<'_>,
) -> Failure {
    let name = |place: &usize| setup.info.states[equations.states[*place]].name.as_ref();
    Failure::Usage(match error {
        ReductionError::Unmoved => "the inputs move none of the outputs here".to_owned(),
        ReductionError::Dependent { state, factors } if factors.iter().all(|f| *f == 0.0) => {
            format!(
                "--outputs: the inputs do not move `{}` here; leave it out",
                name(state)
            )
        }
        ReductionError::Dependent { state, .. } => format!(
            "--outputs: on all motions that the inputs can make `{}` follows from the outputs before \
             it; leave it out",
            name(state)
        ),
        ReductionError::Open {
            chosen,
            order,
            missing,
        } => {
            let missing: Vec<&str> = missing.iter().map(name).collect();
            format!(
                "--outputs: the equations of these {chosen} outputs have order {order}; add {}",
                missing.join(", ")
            )
        }
    })
}

/// About poles.
pub(crate) fn placement(error: &PlacementError) -> Failure {
    let help = match error {
        PlacementError::Count { order, .. } => {
            format!("; write {order} poles for the {order} outputs, or a single one for all")
        }
        PlacementError::Unpaired { pole } => format!("; add {}", pole_text(pole.conj())),
        PlacementError::Multiple { pole, .. } => format!(
            "; spread them, such as {} and {}",
            pole_text(*pole),
            pole_text(*pole * 1.1)
        ),
        PlacementError::Uncontrollable { .. } => "; choose other outputs".to_owned(),
        PlacementError::DependentInputs { .. } => "; name fewer with `--inputs`".to_owned(),
        PlacementError::Defective => "; spread the poles".to_owned(),
        PlacementError::Spectrum(_) => return Failure::Computation(error.to_string()),
    };
    // The number format of complex numbers is that of the flag.
    let told = match error {
        PlacementError::Unpaired { pole } => {
            format!(
                "the pole {} needs its conjugate beside it",
                pole_text(*pole)
            )
        }
        PlacementError::Multiple {
            pole,
            wanted,
            inputs,
        } => format!(
            "the pole {} is wanted {wanted} times, but {inputs} inputs allow it {inputs} times",
            pole_text(*pole)
        ),
        other => other.to_string(),
    };
    Failure::Usage(format!("--poles: {told}{help}"))
}

/// About weights.
pub(crate) fn riccati(error: &RiccatiError) -> Failure {
    match error {
        RiccatiError::InputWeight => {
            Failure::Usage("--lqr: every weight in R must be positive".to_owned())
        }
        RiccatiError::StateWeight { .. } => {
            Failure::Usage("--lqr: no weight in Q may be negative".to_owned())
        }
        RiccatiError::NoStabilisingSolution => Failure::Usage(format!(
            "--lqr: {error}; give all outputs a positive weight"
        )),
        other => Failure::Computation(other.to_string()),
    }
}

/// A complex number as the flag reads it.
pub(crate) fn pole_text(pole: Complex<f64>) -> String {
    if pole.im == 0.0 {
        return number(pole.re);
    }
    let sign = if pole.im < 0.0 { '-' } else { '+' };
    format!("{}{sign}{}i", number(pole.re), number(pole.im.abs()))
}
