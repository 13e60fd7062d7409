//! Remedies for a failed design, in the names of the mechanism.

use appell_analysis::control::lqr::RiccatiError;
use appell_analysis::control::operating_point::{MotionEquations, OperatingPointError};
use appell_analysis::control::placement::PlacementError;
use appell_analysis::control::reduction::ReductionError;
use appell_report::text::number;
use nalgebra::Complex;

use crate::setup::Setup;
use crate::{Error, Field};

/// About the steady motion.
pub(super) fn operating_point(error: OperatingPointError, setup: &Setup<'_>) -> Error {
    let (state, rate) = match error {
        OperatingPointError::Unsteady { state, rate } => (state, rate),
        OperatingPointError::Inconsistent(nowhere) => {
            let message = nowhere.describe(setup.info);
            return Error::request(Field::At, message);
        }
        _ => return Error::computation(error),
    };
    let quantity = &setup.info.states[state];
    let message = format!(
        "the motion is not steady: `{}` changes by {} {} per second; prescribe a steady motion",
        quantity.name,
        number(quantity.to_unit(rate)),
        quantity.unit
    );
    Error::request(Field::At, message)
}

/// About the outputs.
pub(super) fn reduction(
    error: &ReductionError,
    equations: &MotionEquations,
    setup: &Setup<'_>,
) -> Error {
    let name = |place: &usize| setup.info.states[equations.states[*place]].name.as_ref();
    let message = match error {
        ReductionError::Unmoved => {
            "the inputs affect none of the outputs at this operating point".to_owned()
        }
        ReductionError::Dependent { state, factors } if factors.iter().all(|f| *f == 0.0) => {
            format!(
                "output `{}` is not affected by the inputs at this operating point; remove it",
                name(state)
            )
        }
        ReductionError::Dependent { state, .. } => format!(
            "output `{}` depends linearly on the preceding outputs in the controllable subspace; \
             remove it",
            name(state)
        ),
        ReductionError::Open {
            chosen,
            order,
            missing,
        } => {
            let missing: Vec<&str> = missing.iter().map(name).collect();
            format!(
                "the {chosen} outputs do not form a closed subsystem, which has order {order}; add {}",
                missing.join(", ")
            )
        }
    };
    Error::request(Field::Outputs, message)
}

/// About poles.
pub(super) fn placement(error: PlacementError) -> Error {
    let text = pole_text;
    let message = match &error {
        PlacementError::Spectrum(_) => return Error::computation(error),
        PlacementError::Count { order, .. } => {
            format!("{error}; write {order} poles for the {order} outputs, or a single one for all")
        }
        PlacementError::Unpaired { pole } => format!(
            "the pole {} lacks its complex conjugate; add {}",
            text(*pole),
            text(pole.conj())
        ),
        PlacementError::Multiple {
            pole,
            wanted,
            inputs,
        } => format!(
            "the pole {} is requested {wanted} times, but its multiplicity is at most {inputs}, the \
             number of inputs; spread the poles, such as {} and {}",
            text(*pole),
            text(*pole),
            text(*pole * 1.1)
        ),
        PlacementError::Uncontrollable { .. } => format!("{error}; choose other outputs"),
        PlacementError::DependentInputs { .. } => format!("{error}; use fewer inputs"),
        PlacementError::Defective => format!("{error}; spread the poles"),
    };
    Error::request(Field::Poles, message)
}

/// About weights.
pub(super) fn riccati(error: RiccatiError) -> Error {
    let message = match &error {
        RiccatiError::InputWeight => "every weight in R must be positive".to_owned(),
        RiccatiError::StateWeight { .. } => "no weight in Q may be negative".to_owned(),
        RiccatiError::NoStabilisingSolution => {
            format!("{error}; give all outputs a positive weight")
        }
        _ => return Error::computation(error),
    };
    Error::request(Field::Weights, message)
}

/// A complex number in the format of a request.
pub fn pole_text(pole: Complex<f64>) -> String {
    if pole.im == 0.0 {
        return number(pole.re);
    }
    let sign = if pole.im < 0.0 { '-' } else { '+' };
    format!("{}{sign}{}i", number(pole.re), number(pole.im.abs()))
}
