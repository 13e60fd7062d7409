//! The embedded pairs of Dormand and Prince.

use super::dop853_coefficients as dop853;
use super::step_size::Control;
use super::tableau::{Row, Tableau};

/// The coefficients of an embedded pair. Sealed: implemented by [`Dopri5`] and [`Dop853`].
#[allow(private_interfaces)]
pub trait EmbeddedPair: sealed::Sealed {
    /// Nodes, rows and weights.
    #[doc(hidden)]
    const TABLEAU: Tableau;
    /// Stages including the rates at the new state and those of the interpolant.
    #[doc(hidden)]
    const ALL_STAGES: usize;
    /// Coefficients of the interpolant.
    #[doc(hidden)]
    const INTERIOR_COEFFICIENTS: usize;
    /// Whether the error estimate needs the rates at the new state.
    #[doc(hidden)]
    const ERROR_USES_NEW_RATES: bool;
    /// Order used in the choice of the first step.
    #[doc(hidden)]
    const ORDER: f64;
    /// Constants of the step-size control.
    #[doc(hidden)]
    const CONTROL: Control;
    /// Nodes and rows of the stages of the interpolant alone.
    #[doc(hidden)]
    const INTERIOR_STAGES: &[(f64, Row)];
    /// Its coefficients over h, after those of the cubic Hermite polynomial.
    #[doc(hidden)]
    const INTERIOR: &[Row];
    /// The weighted errors of steps, at most 1 for a step to be accepted; `mean_square` is the weighted mean square
    /// of a combination of the stages.
    #[doc(hidden)]
    fn errors<const N: usize>(mean_square: impl Fn(Row) -> [f64; N], h: &[f64; N]) -> [f64; N];
}

mod sealed {
    pub trait Sealed {}
    impl Sealed for super::Dopri5 {}
    impl Sealed for super::Dop853 {}
}

/// Order 5(4) with an interpolant of order 4 (Hairer, Nørsett and Wanner, table II.5.2, equation
/// II.6.11 and the authors' program). For tolerances down to about 1e-6.
#[derive(Debug, Clone, Copy)]
pub struct Dopri5;

const DOPRI5_WEIGHTS: Row = &[
    (0, 35.0 / 384.0),
    (2, 500.0 / 1113.0),
    (3, 125.0 / 192.0),
    (4, -2187.0 / 6784.0),
    (5, 11.0 / 84.0),
];

/// Solution of order 5 minus the embedded one of order 4.
const DOPRI5_ERROR: Row = &[
    (0, 71.0 / 57600.0),
    (2, -71.0 / 16695.0),
    (3, 71.0 / 1920.0),
    (4, -17253.0 / 339_200.0),
    (5, 22.0 / 525.0),
    (6, -1.0 / 40.0),
];

/// The last coefficient of the interpolant over h.
const DOPRI5_INTERIOR: Row = &[
    (0, -12_715_105_075.0 / 11_282_082_432.0),
    (2, 87_487_479_700.0 / 32_700_410_799.0),
    (3, -10_690_763_975.0 / 1_880_347_072.0),
    (4, 701_980_252_875.0 / 199_316_789_632.0),
    (5, -1_453_857_185.0 / 822_651_844.0),
    (6, 69_997_945.0 / 29_380_423.0),
];

#[allow(private_interfaces)]
impl EmbeddedPair for Dopri5 {
    const TABLEAU: Tableau = Tableau {
        nodes: &[1.0 / 5.0, 3.0 / 10.0, 4.0 / 5.0, 8.0 / 9.0, 1.0],
        rows: &[
            &[(0, 1.0 / 5.0)],
            &[(0, 3.0 / 40.0), (1, 9.0 / 40.0)],
            &[(0, 44.0 / 45.0), (1, -56.0 / 15.0), (2, 32.0 / 9.0)],
            &[
                (0, 19372.0 / 6561.0),
                (1, -25360.0 / 2187.0),
                (2, 64448.0 / 6561.0),
                (3, -212.0 / 729.0),
            ],
            &[
                (0, 9017.0 / 3168.0),
                (1, -355.0 / 33.0),
                (2, 46732.0 / 5247.0),
                (3, 49.0 / 176.0),
                (4, -5103.0 / 18656.0),
            ],
        ],
        weights: DOPRI5_WEIGHTS,
    };
    const ALL_STAGES: usize = 7;
    const INTERIOR_COEFFICIENTS: usize = 5;
    const ERROR_USES_NEW_RATES: bool = true;
    const ORDER: f64 = 5.0;
    const CONTROL: Control = Control {
        exponent: 0.2,
        integral_gain: 0.04,
        integral_correction: 0.75,
        safety: 0.9,
        smallest_factor: 0.2,
        largest_factor: 10.0,
    };

    const INTERIOR_STAGES: &[(f64, Row)] = &[];
    const INTERIOR: &[Row] = &[DOPRI5_INTERIOR];

    fn errors<const N: usize>(mean_square: impl Fn(Row) -> [f64; N], h: &[f64; N]) -> [f64; N] {
        let mut errors = mean_square(DOPRI5_ERROR);
        for l in 0..N {
            errors[l] = h[l] * errors[l].sqrt();
        }
        errors
    }
}

/// Order 8 with embedded errors of order 5 and 3 and an interpolant of order 7 (Hairer, Nørsett and Wanner, section
/// II.10). Recommended for smooth motions at tolerances below 1e-6.
#[derive(Debug, Clone, Copy)]
pub struct Dop853;

/// The coefficients of an embedded pair, for code generation in other languages. A row is a list of stages with their
/// weights; stages count from 0.
#[derive(Debug, Clone, Copy)]
pub struct Coefficients {
    /// Nodes of the stages after the first.
    pub nodes: &'static [f64],
    /// Their rows.
    pub stages: &'static [Row],
    /// Weights of the new state.
    pub weights: Row,
    /// The new state minus the embedded ones: of order 4, or of order 5 and 3.
    pub errors: &'static [Row],
    /// Whether the error needs the rates at the new state.
    pub error_uses_new_rates: bool,
    /// Nodes and rows of further stages of the interpolant, after that of the rates at the new state.
    pub interior_stages: &'static [(f64, Row)],
    /// Its coefficients over h, after those of the cubic Hermite polynomial.
    pub interior: &'static [Row],
    /// The order, which the first step depends on.
    pub order: f64,
    /// Step-size control.
    pub control: Control,
}

impl Coefficients {
    const fn of<P: EmbeddedPair>(errors: &'static [Row]) -> Self {
        Self {
            nodes: P::TABLEAU.nodes,
            stages: P::TABLEAU.rows,
            weights: P::TABLEAU.weights,
            errors,
            error_uses_new_rates: P::ERROR_USES_NEW_RATES,
            interior_stages: P::INTERIOR_STAGES,
            interior: P::INTERIOR,
            order: P::ORDER,
            control: P::CONTROL,
        }
    }
}

impl Dopri5 {
    /// The coefficients.
    pub const fn coefficients() -> Coefficients {
        Coefficients::of::<Self>(&[DOPRI5_ERROR])
    }
}

impl Dop853 {
    /// The coefficients.
    pub const fn coefficients() -> Coefficients {
        Coefficients::of::<Self>(&[dop853::ERROR_5, dop853::ERROR_3])
    }
}

#[allow(private_interfaces)]
impl EmbeddedPair for Dop853 {
    const TABLEAU: Tableau = dop853::TABLEAU;
    const ALL_STAGES: usize = 16;
    const INTERIOR_COEFFICIENTS: usize = 8;
    const ERROR_USES_NEW_RATES: bool = false;
    const ORDER: f64 = 8.0;
    const CONTROL: Control = Control {
        exponent: 0.125,
        integral_gain: 0.0,
        integral_correction: 0.2,
        safety: 0.9,
        smallest_factor: 0.333,
        largest_factor: 6.0,
    };

    const INTERIOR_STAGES: &[(f64, Row)] = dop853::INTERIOR_STAGES;
    const INTERIOR: &[Row] = dop853::INTERIOR;

    /// Equation (10.17): E₅² / √(E₅² + 0.01 E₃²), an estimate of order 8 that vanishes only if both differences do.
    fn errors<const N: usize>(mean_square: impl Fn(Row) -> [f64; N], h: &[f64; N]) -> [f64; N] {
        let (mut errors, square_3) = (mean_square(dop853::ERROR_5), mean_square(dop853::ERROR_3));
        for l in 0..N {
            let denominator = errors[l] + 0.01 * square_3[l];
            errors[l] = if denominator == 0.0 {
                0.0
            } else {
                h[l] * errors[l] / denominator.sqrt()
            };
        }
        errors
    }
}
