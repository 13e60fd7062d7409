use ::appell_runtime::Real;
use ::appell_runtime::dense::{lu_factor, lu_solve};

/// Parameters p, in SI.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Parameters<T> {
    /// The name of a static.
    pub INFO_: T,
    /// Stiffness, in `N/m`.
    pub K: T,
}

impl Default for Parameters<f64> {
    /// The values of the spec.
    fn default() -> Self {
        Self { INFO_: 2.0, K: 3.0 }
    }
}

/// State x: pseudo-velocities, then coordinates. In SI.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct State<T> {
    /// A keyword, in `m/s`.
    pub type_: T,
    /// The name of an argument, in `m`.
    pub p: T,
    /// The name of a number, in `m`.
    pub half: T,
}

impl State<f64> {
    /// The initial state of the spec; the default is zero.
    #[must_use]
    pub fn initial() -> Self {
        Self {
            type_: 0.0,
            p: 0.25,
            half: 0.5,
        }
    }
}

/// Inputs u, in SI.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Inputs {}

/// Outputs y, in SI.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Outputs<T> {
    /// A choice, in `m`.
    pub switch: T,
    /// A power.
    pub self_: T,
    /// An angle, in `rad`.
    pub angle: T,
}

/// Rates ẋ of the [`State`]: pseudo-accelerations, then generalised velocities. In SI.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Rates<T> {
    /// Rate of `type`, in `m/s^2`.
    pub type_dot: T,
    /// Rate of `p`, in `m/s`.
    pub p_dot: T,
    /// Rate of `half`, in `m/s`.
    pub half_dot: T,
}

impl<T> Rates<T> {
    /// ω̇, the first part.
    #[must_use]
    pub fn accelerations(self) -> Accelerations<T> {
        Accelerations {
            type_dot: self.type_dot,
        }
    }

    /// q̇, the second part.
    #[must_use]
    pub fn coordinate_rates(self) -> CoordinateRates<T> {
        CoordinateRates {
            p_dot: self.p_dot,
            half_dot: self.half_dot,
        }
    }
}

/// Pseudo-accelerations ω̇, in SI.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Accelerations<T> {
    /// Rate of `type`, in `m/s^2`.
    pub type_dot: T,
}

/// Generalised velocities q̇, in SI.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct CoordinateRates<T> {
    /// Rate of `p`, in `m/s`.
    pub p_dot: T,
    /// Rate of `half`, in `m/s`.
    pub half_dot: T,
}

/// Result of [`jacobians`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Jacobians<T> {
    /// ẋ, the rates of the state.
    pub rates: Rates<T>,
    /// Derivatives.
    pub a: Rates<State<T>>,
    /// Derivatives.
    pub b: Rates<Inputs>,
}

/// Rates ẋ of the state by Appell's equations M ω̇ + b = Π and kinematics.
///
/// ```text
/// ṗ = type
/// ```
///
/// From `mechanisms/type.toml`.
/// Operations: 25 (16 +, 8 ×, 1 ÷), sine or cosine of 1 angle, 13 functions, 2 choices, 2 linear systems.
#[must_use]
#[inline]
pub fn rates<T: Real>(
    t: T,
    parameters: &Parameters<T>,
    state: &State<T>,
    _inputs: &Inputs,
) -> Rates<T> {
    let &Parameters { INFO_, K } = parameters;
    let &State { type_, p, half } = state;
    let c_17_over_35 = T::constant(17.0 / 35.0);
    let number_half = T::constant(0.5);
    let one = T::constant(1.0);

    // Combinations of parameters.
    let K_squared = K * K;
    let type_dot_part_1 = K_squared * K_squared;
    let type_dot_part_2 = type_dot_part_1 * type_dot_part_1;

    // Generalised velocities.
    let p_minus_half = p - half;
    let crate_ = half.ln() + half.sign() + half.abs() + half.sqrt() + half.exp()
        + half.tanh() + half.cosh() + half.sinh() + half.atan() + half.acos()
        + half.asin() + half.sin();
    let lu_1 = lu_factor([
        [K, p, half],
        [p, INFO_, number_half],
        [c_17_over_35, half, K],
    ]);
    let [_, _, solution_2_3] = lu_solve(&lu_1, [p, crate_, half]);
    let half_dot = solution_2_3 - p_minus_half.atan2(K.powf(p));

    // Appell's equations, solved.
    let [solution_1_1, _, _] = lu_solve(&lu_1, [type_, t, p]);
    let type_dot = one / (p_minus_half * p_minus_half * p_minus_half)
        + K * K_squared * type_dot_part_2 * type_dot_part_2
        + T::if_less_or_equal(t, K, p, type_)
        + T::if_less(p, p_minus_half, solution_1_1, crate_);

    Rates {
        type_dot,
        p_dot: type_,
        half_dot,
    }
}

/// Rates ẋ and their Jacobians with respect to state and inputs.
///
/// ```text
/// M ∂ω̇/∂x = ∂(Π − b)/∂x − ∂M/∂x ω̇
/// ```
///
/// From `mechanisms/type.toml`.
/// Operations: 61 (32 +, 18 ×, 5 ÷, 6 sign), sine or cosine of 1 angle, 14 functions, 7 choices, 7 linear systems.
#[must_use]
#[inline]
pub fn jacobians<T: Real>(
    t: T,
    parameters: &Parameters<T>,
    state: &State<T>,
    _inputs: &Inputs,
) -> Jacobians<T> {
    let &Parameters { INFO_, K } = parameters;
    let &State { type_, p, half } = state;
    let zero = T::constant(0.0);
    let c_17_over_35 = T::constant(17.0 / 35.0);
    let number_half = T::constant(0.5);
    let one = T::constant(1.0);
    let three = T::constant(3.0);

    // Sines and cosines.
    let (sin_half, cos_half) = half.sin_cos();

    // Combinations of parameters.
    let K_squared = K * K;
    let type_dot_part_1 = K_squared * K_squared;
    let type_dot_part_2 = type_dot_part_1 * type_dot_part_1;

    // Generalised velocities.
    let p_minus_half = p - half;
    let half_dot_part_1 = K.powf(p);
    let sqrt_half = half.sqrt();
    let tanh_half = half.tanh();
    let crate_part_1 = half.sign() + half.exp() + half.cosh() + half.sinh();
    let crate_ = sin_half + sqrt_half + tanh_half + crate_part_1 + half.ln() + half.abs()
        + half.atan() + half.acos() + half.asin();
    let lu_1 = lu_factor([
        [K, p, half],
        [p, INFO_, number_half],
        [c_17_over_35, half, K],
    ]);
    let [solution_2_1, solution_2_2, solution_2_3] = lu_solve(&lu_1, [p, crate_, half]);
    let half_dot = solution_2_3 - p_minus_half.atan2(half_dot_part_1);

    // Appell's equations, solved.
    let inv_p_minus_half = one / p_minus_half;
    let type_dot_per_inv_p_minus_half = inv_p_minus_half * inv_p_minus_half;
    let [solution_1_1, solution_1_2, solution_1_3] = lu_solve(&lu_1, [type_, t, p]);
    let type_dot = inv_p_minus_half * type_dot_per_inv_p_minus_half
        + K * K_squared * type_dot_part_2 * type_dot_part_2
        + T::if_less_or_equal(t, K, p, type_)
        + T::if_less(p, p_minus_half, solution_1_1, crate_);

    // Row `type_dot` of A.
    let [solution_3_1, _, _] = lu_solve(&lu_1, [one, zero, zero]);
    let d_type_dot_d_type = T::if_less(p, p_minus_half, solution_3_1, zero)
        + T::if_less_or_equal(t, K, zero, one);
    let [solution_4_1, _, _] = lu_solve(&lu_1, [-solution_1_2, -solution_1_1, one]);
    let d_type_dot_d_p_part_1 = three * type_dot_per_inv_p_minus_half
        * type_dot_per_inv_p_minus_half;
    let d_type_dot_d_p = T::if_less(p, p_minus_half, solution_4_1, zero)
        + T::if_less_or_equal(t, K, one, zero) - d_type_dot_d_p_part_1;
    let [solution_5_1, _, _] = lu_solve(&lu_1, [-solution_1_3, zero, -solution_1_2]);
    let one_over_one_plus_half_squared = one / (one + half * half);
    let inv_half = one / half;
    let d_crate_d_half = cos_half + number_half / sqrt_half + crate_part_1
        + one_over_one_plus_half_squared + one + inv_half - tanh_half * tanh_half;
    let d_type_dot_d_half = d_type_dot_d_p_part_1
        + T::if_less(p, p_minus_half, solution_5_1, d_crate_d_half);

    // Row `half_dot` of A.
    let one_minus_solution_2_2 = one - solution_2_2;
    let [_, _, solution_6_3] = lu_solve(
        &lu_1,
        [one_minus_solution_2_2, -solution_2_1, zero],
    );
    let d_half_dot_d_p_part_1 = p_minus_half * half_dot_part_1 * K.ln();
    let d_half_dot_d_p_part_2 = p_minus_half * p_minus_half;
    let d_half_dot_d_p_part_3 = half_dot_part_1 * half_dot_part_1;
    let d_half_dot_d_p_part_4 = one / (d_half_dot_d_p_part_2 + d_half_dot_d_p_part_3);
    let d_half_dot_d_p_part_5 = half_dot_part_1 - d_half_dot_d_p_part_1;
    let d_half_dot_d_p = solution_6_3 - d_half_dot_d_p_part_4 * d_half_dot_d_p_part_5;
    let [_, _, solution_7_3] = lu_solve(
        &lu_1,
        [-solution_2_3, d_crate_d_half, one_minus_solution_2_2],
    );
    let d_half_dot_d_half = solution_7_3 + half_dot_part_1 * d_half_dot_d_p_part_4;

    Jacobians {
        rates: Rates {
            type_dot,
            p_dot: type_,
            half_dot,
        },
        a: Rates {
            type_dot: State {
                type_: d_type_dot_d_type,
                p: d_type_dot_d_p,
                half: d_type_dot_d_half,
            },
            p_dot: State {
                type_: one,
                ..State::splat(zero)
            },
            half_dot: State {
                type_: zero,
                p: d_half_dot_d_p,
                half: d_half_dot_d_half,
            },
        },
        b: Rates {
            type_dot: Inputs {},
            p_dot: Inputs {},
            half_dot: Inputs {},
        },
    }
}

/// P = ∂ẋ/∂p.
///
/// ```text
/// M ∂ω̇/∂p = ∂(Π − b)/∂p − ∂M/∂p ω̇
/// ```
///
/// From `mechanisms/type.toml`.
/// Operations: 33 (15 +, 11 ×, 1 ÷, 6 sign), sine or cosine of 1 angle, 12 functions, 2 choices, 6 linear systems.
#[must_use]
#[inline]
pub fn parameter_jacobian<T: Real>(
    t: T,
    parameters: &Parameters<T>,
    state: &State<T>,
    _inputs: &Inputs,
) -> Rates<Parameters<T>> {
    let &Parameters { INFO_, K } = parameters;
    let &State { type_, p, half } = state;
    let zero = T::constant(0.0);
    let c_17_over_35 = T::constant(17.0 / 35.0);
    let number_half = T::constant(0.5);
    let nineteen = T::constant(19.0);

    // Combinations of parameters.
    let K_squared = K * K;
    let d_type_dot_d_K_part_1 = K_squared * K_squared;
    let d_type_dot_d_K_part_2 = d_type_dot_d_K_part_1 * d_type_dot_d_K_part_1;

    // Column `INFO` of P.
    let p_minus_half = p - half;
    let lu_1 = lu_factor([
        [K, p, half],
        [p, INFO_, number_half],
        [c_17_over_35, half, K],
    ]);
    let [solution_1_1, solution_1_2, solution_1_3] = lu_solve(&lu_1, [type_, t, p]);
    let [solution_2_1, _, _] = lu_solve(&lu_1, [zero, -solution_1_2, zero]);
    let d_type_dot_d_INFO = T::if_less(p, p_minus_half, solution_2_1, zero);
    let crate_ = half.ln() + half.sign() + half.abs() + half.sqrt() + half.exp()
        + half.tanh() + half.cosh() + half.sinh() + half.atan() + half.acos()
        + half.asin() + half.sin();
    let [solution_4_1, solution_4_2, solution_4_3] = lu_solve(&lu_1, [p, crate_, half]);
    let [_, _, d_half_dot_d_INFO] = lu_solve(&lu_1, [zero, -solution_4_2, zero]);

    // Column `K` of P.
    let [solution_3_1, _, _] = lu_solve(&lu_1, [-solution_1_1, zero, -solution_1_3]);
    let d_type_dot_d_K_part_3 = nineteen * K_squared * d_type_dot_d_K_part_2;
    let d_type_dot_d_K = T::if_less(p, p_minus_half, solution_3_1, zero)
        + d_type_dot_d_K_part_3 * d_type_dot_d_K_part_2;
    let [_, _, solution_6_3] = lu_solve(&lu_1, [-solution_4_1, zero, -solution_4_3]);
    let d_half_dot_d_K_part_1 = K.powf(p);
    let d_half_dot_d_K_part_2 = p_minus_half * p_minus_half;
    let d_half_dot_d_K_part_3 = d_half_dot_d_K_part_1 * d_half_dot_d_K_part_1;
    let d_half_dot_d_K_part_4 = p_minus_half * d_half_dot_d_K_part_1 * p;
    let d_half_dot_d_K_part_5 = K * (d_half_dot_d_K_part_2 + d_half_dot_d_K_part_3);
    let d_half_dot_d_K = solution_6_3 + d_half_dot_d_K_part_4 / d_half_dot_d_K_part_5;

    Rates {
        type_dot: Parameters {
            INFO_: d_type_dot_d_INFO,
            K: d_type_dot_d_K,
        },
        p_dot: Parameters::splat(zero),
        half_dot: Parameters {
            INFO_: d_half_dot_d_INFO,
            K: d_half_dot_d_K,
        },
    }
}

/// Outputs of the spec.
///
/// ```text
/// outputs₀ = (p if t ≤ K, else type)
/// outputs₁ = K^(p)
/// outputs₂ = atan2(p − half, K^(p))
/// ```
///
/// From `mechanisms/type.toml`.
/// Operations: 1 (1 +), 2 functions, 1 choice.
#[must_use]
#[inline]
pub fn outputs<T: Real>(
    t: T,
    parameters: &Parameters<T>,
    state: &State<T>,
    _inputs: &Inputs,
) -> Outputs<T> {
    let &Parameters { K, .. } = parameters;
    let &State { type_, p, half } = state;

    // outputs
    let outputs_0 = T::if_less_or_equal(t, K, p, type_);
    let outputs_1 = K.powf(p);
    let outputs_2 = (p - half).atan2(outputs_1);

    Outputs {
        switch: outputs_0,
        self_: outputs_1,
        angle: outputs_2,
    }
}

::appell_runtime::vector!(Parameters { INFO_, K });

::appell_runtime::vector!(State { type_, p, half }, Rates);

::appell_runtime::vector!(Inputs {});

::appell_runtime::vector!(Outputs { switch, self_, angle });

::appell_runtime::vector!(Rates { type_dot, p_dot, half_dot });

::appell_runtime::vector!(Accelerations { type_dot });

::appell_runtime::vector!(CoordinateRates { p_dot, half_dot });
