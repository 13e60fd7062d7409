use ::appell_runtime::Real;
use ::appell_runtime::dense::{lu_factor, lu_solve};

/// Parameters, in SI.
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

/// One number per pseudo-velocity, in SI. Where it is a force: in W over the unit.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Speeds<T> {
    /// A keyword, in `m/s`.
    pub type_: T,
}

/// One number per coordinate, in SI. Where it is a rate: in the unit per second.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Coordinates<T> {
    /// The name of an argument, in `m`.
    pub p: T,
    /// The name of a number, in `m`.
    pub half: T,
}

/// The state, or its rates: pseudo-velocities, then coordinates. In SI.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct State<T> {
    /// A keyword, in `m/s`.
    pub type_: T,
    /// The name of an argument, in `m`.
    pub p: T,
    /// The name of a number, in `m`.
    pub half: T,
}

/// Inputs, in SI.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Inputs<T>(pub core::marker::PhantomData<T>);

/// Outputs, in SI.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Outputs<T> {
    /// A choice, in `m`.
    pub switch: T,
    /// A power.
    pub self_: T,
    /// An angle, in `rad`.
    pub angle: T,
}

/// Result of [`jacobians`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Jacobians<T> {
    /// ẋ, the rates of the state.
    pub rates: State<T>,
    /// Derivatives.
    pub a: [[T; 3]; 3],
    /// Derivatives.
    pub b: [[T; 0]; 3],
}

/// Rates ẋ of the state by Appell's equations M ω̇ + b = Π and kinematics.
///
/// From `mechanisms/type.toml`.
/// Operations: 25 (16 +, 8 ×, 1 ÷), sine or cosine of 1 angle, 13 functions, 2 choices, 2 linear systems.
#[must_use]
#[inline]
pub fn rates<T: Real>(
    t: T,
    parameters: &Parameters<T>,
    state: &State<T>,
    _inputs: &Inputs<T>,
) -> State<T> {
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

    State {
        type_: type_dot,
        p: type_,
        half: half_dot,
    }
}

/// Rates ẋ with their derivatives by state and inputs.
///
/// From `mechanisms/type.toml`.
/// Operations: 61 (32 +, 18 ×, 5 ÷, 6 sign), sine or cosine of 1 angle, 14 functions, 7 choices, 7 linear systems.
#[must_use]
#[inline]
pub fn jacobians<T: Real>(
    t: T,
    parameters: &Parameters<T>,
    state: &State<T>,
    _inputs: &Inputs<T>,
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
    let type_dot_part_3 = inv_p_minus_half * inv_p_minus_half;
    let [solution_1_1, solution_1_2, solution_1_3] = lu_solve(&lu_1, [type_, t, p]);
    let type_dot = inv_p_minus_half * type_dot_part_3
        + K * K_squared * type_dot_part_2 * type_dot_part_2
        + T::if_less_or_equal(t, K, p, type_)
        + T::if_less(p, p_minus_half, solution_1_1, crate_);

    // Row `type` of A.
    let [solution_3_1, _, _] = lu_solve(&lu_1, [one, zero, zero]);
    let A_type_type = T::if_less(p, p_minus_half, solution_3_1, zero)
        + T::if_less_or_equal(t, K, zero, one);
    let [solution_4_1, _, _] = lu_solve(&lu_1, [-solution_1_2, -solution_1_1, one]);
    let A_type_p_part_1 = three * type_dot_part_3 * type_dot_part_3;
    let A_type_p = T::if_less(p, p_minus_half, solution_4_1, zero)
        + T::if_less_or_equal(t, K, one, zero) - A_type_p_part_1;
    let [solution_5_1, _, _] = lu_solve(&lu_1, [-solution_1_3, zero, -solution_1_2]);
    let one_over_one_plus_half_squared = one / (one + half * half);
    let inv_half = one / half;
    let d_crate_d_half = cos_half + number_half / sqrt_half + crate_part_1
        + one_over_one_plus_half_squared + one + inv_half - tanh_half * tanh_half;
    let A_type_half = A_type_p_part_1
        + T::if_less(p, p_minus_half, solution_5_1, d_crate_d_half);

    // Row `half` of A.
    let one_minus_solution_2_2 = one - solution_2_2;
    let [_, _, solution_6_3] = lu_solve(
        &lu_1,
        [one_minus_solution_2_2, -solution_2_1, zero],
    );
    let A_half_p_part_1 = p_minus_half * p_minus_half;
    let A_half_p_part_2 = one / (A_half_p_part_1 + half_dot_part_1 * half_dot_part_1);
    let A_half_p_part_3 = half_dot_part_1 - p_minus_half * half_dot_part_1 * K.ln();
    let A_half_p = solution_6_3 - A_half_p_part_2 * A_half_p_part_3;
    let [_, _, solution_7_3] = lu_solve(
        &lu_1,
        [-solution_2_3, d_crate_d_half, one_minus_solution_2_2],
    );
    let A_half_half = solution_7_3 + half_dot_part_1 * A_half_p_part_2;

    Jacobians {
        rates: State {
            type_: type_dot,
            p: type_,
            half: half_dot,
        },
        a: [
            [A_type_type, A_type_p, A_type_half],
            [one, zero, zero],
            [zero, A_half_p, A_half_half],
        ],
        b: [[], [], []],
    }
}

/// P = ∂ẋ/∂p. Rows follow [`State`], columns [`Parameters`].
///
/// Rows: `type`, `p`, `half`. Columns: `INFO`, `K`.
///
/// From `mechanisms/type.toml`.
/// Operations: 33 (15 +, 11 ×, 1 ÷, 6 sign), sine or cosine of 1 angle, 12 functions, 2 choices, 6 linear systems.
#[must_use]
#[inline]
pub fn parameter_jacobian<T: Real>(
    t: T,
    parameters: &Parameters<T>,
    state: &State<T>,
    _inputs: &Inputs<T>,
) -> [[T; 2]; 3] {
    let &Parameters { INFO_, K } = parameters;
    let &State { type_, p, half } = state;
    let zero = T::constant(0.0);
    let c_17_over_35 = T::constant(17.0 / 35.0);
    let number_half = T::constant(0.5);
    let nineteen = T::constant(19.0);

    // Combinations of parameters.
    let K_squared = K * K;
    let P_type_K_part_1 = K_squared * K_squared;
    let P_type_K_part_2 = P_type_K_part_1 * P_type_K_part_1;

    // Row `type` of P.
    let p_minus_half = p - half;
    let lu_1 = lu_factor([
        [K, p, half],
        [p, INFO_, number_half],
        [c_17_over_35, half, K],
    ]);
    let [solution_1_1, solution_1_2, solution_1_3] = lu_solve(&lu_1, [type_, t, p]);
    let [solution_2_1, _, _] = lu_solve(&lu_1, [zero, -solution_1_2, zero]);
    let P_type_INFO = T::if_less(p, p_minus_half, solution_2_1, zero);
    let [solution_3_1, _, _] = lu_solve(&lu_1, [-solution_1_1, zero, -solution_1_3]);
    let P_type_K = T::if_less(p, p_minus_half, solution_3_1, zero)
        + nineteen * K_squared * P_type_K_part_2 * P_type_K_part_2;

    // Row `half` of P.
    let crate_ = half.ln() + half.sign() + half.abs() + half.sqrt() + half.exp()
        + half.tanh() + half.cosh() + half.sinh() + half.atan() + half.acos()
        + half.asin() + half.sin();
    let [solution_4_1, solution_4_2, solution_4_3] = lu_solve(&lu_1, [p, crate_, half]);
    let [_, _, P_half_INFO] = lu_solve(&lu_1, [zero, -solution_4_2, zero]);
    let [_, _, solution_6_3] = lu_solve(&lu_1, [-solution_4_1, zero, -solution_4_3]);
    let P_half_K_part_1 = K.powf(p);
    let P_half_K_part_2 = p_minus_half * p_minus_half;
    let P_half_K_part_3 = p_minus_half * P_half_K_part_1 * p;
    let P_half_K_part_4 = K * (P_half_K_part_2 + P_half_K_part_1 * P_half_K_part_1);
    let P_half_K = solution_6_3 + P_half_K_part_3 / P_half_K_part_4;

    [[P_type_INFO, P_type_K], [zero, zero], [P_half_INFO, P_half_K]]
}

/// Outputs of the spec.
///
/// From `mechanisms/type.toml`.
/// Operations: 1 (1 +), 2 functions, 1 choice.
#[must_use]
#[inline]
pub fn outputs<T: Real>(
    t: T,
    parameters: &Parameters<T>,
    state: &State<T>,
    _inputs: &Inputs<T>,
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

impl<T> From<[T; 2]> for Parameters<T> {
    fn from([INFO_, K]: [T; 2]) -> Self {
        Self { INFO_, K }
    }
}

impl<T> From<Parameters<T>> for [T; 2] {
    fn from(Parameters { INFO_, K }: Parameters<T>) -> Self {
        [INFO_, K]
    }
}

impl<T> From<[T; 1]> for Speeds<T> {
    fn from([type_]: [T; 1]) -> Self {
        Self { type_ }
    }
}

impl<T> From<Speeds<T>> for [T; 1] {
    fn from(Speeds { type_ }: Speeds<T>) -> Self {
        [type_]
    }
}

impl<T> From<[T; 2]> for Coordinates<T> {
    fn from([p, half]: [T; 2]) -> Self {
        Self { p, half }
    }
}

impl<T> From<Coordinates<T>> for [T; 2] {
    fn from(Coordinates { p, half }: Coordinates<T>) -> Self {
        [p, half]
    }
}

impl<T> From<[T; 3]> for State<T> {
    fn from([type_, p, half]: [T; 3]) -> Self {
        Self { type_, p, half }
    }
}

impl<T> From<State<T>> for [T; 3] {
    fn from(State { type_, p, half }: State<T>) -> Self {
        [type_, p, half]
    }
}

impl<T> From<[T; 0]> for Inputs<T> {
    fn from([]: [T; 0]) -> Self {
        Self(core::marker::PhantomData)
    }
}

impl<T> From<Inputs<T>> for [T; 0] {
    fn from(Inputs(_): Inputs<T>) -> Self {
        []
    }
}

impl<T> From<[T; 3]> for Outputs<T> {
    fn from([switch, self_, angle]: [T; 3]) -> Self {
        Self { switch, self_, angle }
    }
}

impl<T> From<Outputs<T>> for [T; 3] {
    fn from(Outputs { switch, self_, angle }: Outputs<T>) -> Self {
        [switch, self_, angle]
    }
}
