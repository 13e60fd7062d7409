/// The spec this module is made from.
pub const SPEC: &str = r##"# A spec with "quotes" and "#.
name = 'unicycle'
"##;

use ::appell_runtime::Real;
use ::appell_runtime::model;

/// Parameters, in SI.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Parameters<T> {
    /// Mass of the wheel, in `kg`.
    pub m: T,
    /// Moving mass, in `kg`.
    pub m0: T,
    /// Radius of the wheel, in `m`.
    pub R: T,
    /// Gravity, in `m/s²`.
    pub g: T,
}

impl Default for Parameters<f64> {
    /// The values of the spec.
    fn default() -> Self {
        Self {
            m: 10.0,
            m0: 5.0,
            R: 0.3,
            g: 9.81,
        }
    }
}

/// One number per pseudo-velocity, in SI. Where it is a force: in W over the unit.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Speeds<T> {
    /// Tilt rate of the wheel, in `rad/s`.
    pub omega_1: T,
    /// Spin of the wheel about its axle, in `rad/s`.
    pub omega_2: T,
    /// Turn rate about the wheel's vertical, in `rad/s`.
    pub omega_3: T,
    /// Speed of the mass along its guide, in `m/s`.
    pub sigma: T,
}

/// One number per coordinate, in SI. Where it is a rate: in the unit per second.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Coordinates<T> {
    /// Tilt, in `rad`.
    pub theta: T,
    /// Position of the mass on its guide, in `m`.
    pub r: T,
    /// Yaw, in `rad`.
    pub psi: T,
    /// Rotation of the wheel, in `rad`.
    pub phi: T,
    /// Position of the wheel's centre, in `m`.
    pub x_G: T,
    /// Position of the wheel's centre, in `m`.
    pub y_G: T,
}

/// The state, or its rates: pseudo-velocities, then coordinates. In SI.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct State<T> {
    /// Tilt rate of the wheel, in `rad/s`.
    pub omega_1: T,
    /// Spin of the wheel about its axle, in `rad/s`.
    pub omega_2: T,
    /// Turn rate about the wheel's vertical, in `rad/s`.
    pub omega_3: T,
    /// Speed of the mass along its guide, in `m/s`.
    pub sigma: T,
    /// Tilt, in `rad`.
    pub theta: T,
    /// Position of the mass on its guide, in `m`.
    pub r: T,
    /// Yaw, in `rad`.
    pub psi: T,
    /// Rotation of the wheel, in `rad`.
    pub phi: T,
    /// Position of the wheel's centre, in `m`.
    pub x_G: T,
    /// Position of the wheel's centre, in `m`.
    pub y_G: T,
}

/// Inputs, in SI.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Inputs<T> {
    /// Force on the moving mass, in `N`.
    pub u: T,
}

/// Result of [`acceleration_energy`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AccelerationEnergy<T> {
    /// The total.
    pub total: T,
    /// The wheel.
    pub wheel: T,
    /// The mass.
    pub mass: T,
}

/// Result of [`mass_matrix_and_bias`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MassMatrixAndBias<T> {
    /// The mass_matrix.
    pub mass_matrix: [[T; 4]; 4],
    /// The bias.
    pub bias: Speeds<T>,
}

/// Result of [`jacobians`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Jacobians<T> {
    /// ẋ, the rates of the state.
    pub rates: State<T>,
    /// Derivatives.
    pub a: [[T; 10]; 10],
    /// Derivatives.
    pub b: [[T; 1]; 10],
}

/// Result of [`energies`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Energies<T> {
    /// The kinetic.
    pub kinetic: T,
    /// The potential.
    pub potential: T,
    /// The power.
    pub power: T,
}

/// Generalised velocities q̇ of pseudo-velocities and coordinates.
///
/// From `mechanisms/unicycle.toml`.
/// Operations: 12 (3 +, 8 ×, 1 ÷), sine or cosine of 2 angles.
#[must_use]
#[inline]
pub fn kinematics<T: Real>(
    parameters: &Parameters<T>,
    state: &State<T>,
    _inputs: &Inputs<T>,
) -> Coordinates<T> {
    let &Parameters { R, .. } = parameters;
    let &State { omega_1, omega_2, omega_3, sigma, theta, psi, .. } = state;

    // Sines and cosines.
    let (sin_theta, cos_theta) = theta.sin_cos();
    let (sin_psi, cos_psi) = psi.sin_cos();

    // coordinate_rates
    let coordinate_rates_2 = omega_3 / cos_theta;
    let coordinate_rates_3 = omega_2 - sin_theta * coordinate_rates_2;
    let R_omega_2 = R * omega_2;
    let R_cos_theta_omega_1 = R * cos_theta * omega_1;
    let coordinate_rates_4 = cos_psi * R_omega_2 + sin_psi * R_cos_theta_omega_1;
    let coordinate_rates_5 = sin_psi * R_omega_2 - cos_psi * R_cos_theta_omega_1;

    Coordinates {
        theta: omega_1,
        r: sigma,
        psi: coordinate_rates_2,
        phi: coordinate_rates_3,
        x_G: coordinate_rates_4,
        y_G: coordinate_rates_5,
    }
}

/// Acceleration energy S (Gibbs function) at the actual motion.
///
/// From `mechanisms/unicycle.toml`.
/// Operations: 47 (14 +, 31 ×, 2 ÷), sine or cosine of 1 angle.
#[must_use]
#[inline]
pub fn acceleration_energy<T: Real>(
    parameters: &Parameters<T>,
    state: &State<T>,
    inputs: &Inputs<T>,
) -> AccelerationEnergy<T> {
    let &Parameters { m, m0, R, g } = parameters;
    let &State { omega_1, omega_2, omega_3, sigma, theta, r, .. } = state;
    let &Inputs { u } = inputs;
    let zero = T::constant(0.0);
    let quarter = T::constant(0.25);
    let five_eighths = T::constant(0.625);
    let one = T::constant(1.0);
    let five_quarters = T::constant(1.25);
    let three_halves = T::constant(1.5);
    let two = T::constant(2.0);

    // Sines and cosines.
    let (sin_theta, cos_theta) = theta.sin_cos();

    // Combinations of parameters.
    let m_R_squared = m * R * R;

    // total
    let m0_r = m0 * r;
    let omega_1_dot_part_1 = one / (five_quarters * m_R_squared + m0_r * r);
    let omega_3_squared = omega_3 * omega_3;
    let R_omega_3 = R * omega_3;
    let R_omega_2_omega_3 = R_omega_3 * omega_2;
    let g_sin_theta = g * sin_theta;
    let f_4_part_1 = R_omega_2_omega_3 + g_sin_theta;
    let f_4 = u + m0 * (r * (omega_3_squared + omega_1 * omega_1) - f_4_part_1);
    let tan_theta_omega_3 = sin_theta * omega_3 / cos_theta;
    let omega_1_dot_part_2 = g_sin_theta + three_halves * R_omega_2_omega_3;
    let omega_1_dot_part_3 = quarter * R_omega_3 * tan_theta_omega_3;
    let omega_1_dot_part_4 = f_4 + m * (omega_1_dot_part_2 - omega_1_dot_part_3);
    let omega_1_dot_part_5 = omega_1_dot_part_4 + m0 * f_4_part_1;
    let omega_1_dot_part_6 = m0_r * (omega_3_squared - tan_theta_omega_3 * omega_2);
    let omega_1_dot_part_7 = g * cos_theta + tan_theta_omega_3 * omega_3 * r;
    let omega_1_dot_part_8 = R * (omega_1_dot_part_5 - omega_1_dot_part_6);
    let omega_1_dot_part_9 = m0_r * (omega_1_dot_part_7 + two * omega_1 * sigma);
    let omega_1_dot = omega_1_dot_part_1 * (omega_1_dot_part_8 - omega_1_dot_part_9);
    let s_wheel = five_eighths * m_R_squared * omega_1_dot * omega_1_dot;

    AccelerationEnergy {
        total: s_wheel,
        wheel: s_wheel,
        mass: zero,
    }
}

/// Mass matrix M = ∂²S/∂ω̇², symmetric. Rows and columns follow [`Speeds`].
///
/// ```text
///     ⎡ 5/4 m R² + m₀ R² + m₀ r²   ·                  ·                −m₀ R ⎤
///     ⎢ ·                          3/2 m R² + m₀ R²   −m₀ R r          ·     ⎥
/// M = ⎢ ·                          −m₀ R r            ¼ m R² + m₀ r²   ·     ⎥
///     ⎣ −m₀ R                      ·                  ·                m₀    ⎦
/// ```
///
/// From `mechanisms/unicycle.toml`.
/// Operations: 18 (4 +, 10 ×, 4 sign).
#[must_use]
#[inline]
pub fn mass_matrix<T: Real>(
    parameters: &Parameters<T>,
    state: &State<T>,
    _inputs: &Inputs<T>,
) -> [[T; 4]; 4] {
    let &Parameters { m, m0, R, .. } = parameters;
    let &State { r, .. } = state;
    let zero = T::constant(0.0);
    let quarter = T::constant(0.25);
    let five_quarters = T::constant(1.25);
    let three_halves = T::constant(1.5);

    // Combinations of parameters.
    let R_squared = R * R;
    let m0_R_squared = m0 * R_squared;
    let m_R_squared = m * R_squared;
    let m0_R = m0 * R;
    let mass_matrix_5 = three_halves * m_R_squared + m0_R_squared;

    // mass_matrix
    let m0_r = m0 * r;
    let m0_r_squared = m0_r * r;
    let mass_matrix_0 = five_quarters * m_R_squared + m0_R_squared + m0_r_squared;
    let m0_R_r = R * m0_r;
    let mass_matrix_10 = quarter * m_R_squared + m0_r_squared;

    [
        [mass_matrix_0, zero, zero, -m0_R],
        [zero, mass_matrix_5, -m0_R_r, zero],
        [zero, -m0_R_r, mass_matrix_10, zero],
        [-m0_R, zero, zero, m0],
    ]
}

/// Bias b: what is left of ∂S/∂ω̇ where the pseudo-accelerations vanish.
///
/// From `mechanisms/unicycle.toml`.
/// Operations: 48 (14 +, 33 ×, 1 ÷), sine or cosine of 1 angle.
#[must_use]
#[inline]
pub fn bias<T: Real>(
    parameters: &Parameters<T>,
    state: &State<T>,
    _inputs: &Inputs<T>,
) -> Speeds<T> {
    let &Parameters { m, m0, R, .. } = parameters;
    let &State { omega_1, omega_2, omega_3, sigma, theta, r, .. } = state;
    let quarter = T::constant(0.25);
    let half = T::constant(0.5);
    let three_halves = T::constant(1.5);
    let two = T::constant(2.0);

    // Sines and cosines.
    let (sin_theta, cos_theta) = theta.sin_cos();

    // bias
    let m0_r = m0 * r;
    let m0_omega_1_r = m0_r * omega_1;
    let two_sigma = two * sigma;
    let tan_theta = sin_theta / cos_theta;
    let m0_omega_3_r = m0_r * omega_3;
    let R_omega_3 = R * omega_3;
    let R_omega_2 = R * omega_2;
    let bias_0_part_1 = tan_theta * (m0_r * omega_2 - quarter * m * R_omega_3);
    let bias_0_part_2 = m0_omega_3_r - bias_0_part_1;
    let m0_tan_theta_omega_3_r_squared = tan_theta * m0_omega_3_r * r;
    let bias_0_part_3 = R * (bias_0_part_2 - R_omega_2 * (three_halves * m + m0));
    let bias_0 = m0_omega_1_r * two_sigma
        + omega_3 * (m0_tan_theta_omega_3_r_squared + bias_0_part_3);
    let R_omega_1 = R * omega_1;
    let m_R_omega_1 = m * R_omega_1;
    let two_sigma_minus_R_omega_1 = two_sigma - R_omega_1;
    let bias_1_part_1 = m0_omega_1_r * tan_theta + m_R_omega_1;
    let bias_1 = R_omega_3 * (bias_1_part_1 - m0 * two_sigma_minus_R_omega_1);
    let bias_2_part_1 = m0_r * two_sigma_minus_R_omega_1;
    let bias_2_part_2 = tan_theta * (m0_omega_1_r * r + quarter * R * m_R_omega_1);
    let bias_2 = half * R_omega_2 * m_R_omega_1
        + omega_3 * (bias_2_part_1 - bias_2_part_2);
    let bias_3 = omega_3 * (m0 * R_omega_2 - m0_omega_3_r) - m0_omega_1_r * omega_1;

    Speeds {
        omega_1: bias_0,
        omega_2: bias_1,
        omega_3: bias_2,
        sigma: bias_3,
    }
}

/// Mass matrix M and bias b together: what both need is computed once.
///
/// From `mechanisms/unicycle.toml`.
/// Operations: 63 (18 +, 40 ×, 1 ÷, 4 sign), sine or cosine of 1 angle.
#[must_use]
#[inline]
pub fn mass_matrix_and_bias<T: Real>(
    parameters: &Parameters<T>,
    state: &State<T>,
    _inputs: &Inputs<T>,
) -> MassMatrixAndBias<T> {
    let &Parameters { m, m0, R, .. } = parameters;
    let &State { omega_1, omega_2, omega_3, sigma, theta, r, .. } = state;
    let zero = T::constant(0.0);
    let quarter = T::constant(0.25);
    let half = T::constant(0.5);
    let five_quarters = T::constant(1.25);
    let three_halves = T::constant(1.5);
    let two = T::constant(2.0);

    // Sines and cosines.
    let (sin_theta, cos_theta) = theta.sin_cos();

    // Combinations of parameters.
    let m0_R = m0 * R;
    let m0_R_squared = R * m0_R;
    let m_R = m * R;
    let m_R_squared = R * m_R;
    let mass_matrix_5 = three_halves * m_R_squared + m0_R_squared;

    // mass_matrix
    let m0_r = m0 * r;
    let m0_r_squared = m0_r * r;
    let mass_matrix_0 = five_quarters * m_R_squared + m0_R_squared + m0_r_squared;
    let m0_R_r = R * m0_r;
    let mass_matrix_10 = quarter * m_R_squared + m0_r_squared;

    // bias
    let tan_theta = sin_theta / cos_theta;
    let tan_theta_r = tan_theta * r;
    let m0_omega_3_r = m0_r * omega_3;
    let m0_omega_3_squared_r = m0_omega_3_r * omega_3;
    let two_sigma = two * sigma;
    let m0_omega_1_r = m0_r * omega_1;
    let R_omega_3 = R * omega_3;
    let R_omega_2_omega_3 = R_omega_3 * omega_2;
    let m0_R_plus_m0_tan_theta_r = m0_R + m0_r * tan_theta;
    let bias_0_part_1 = three_halves * m_R + m0_R_plus_m0_tan_theta_r;
    let quarter_tan_theta = quarter * tan_theta;
    let bias_0 = tan_theta_r * m0_omega_3_squared_r + two_sigma * m0_omega_1_r
        + R_omega_3 * (m0_omega_3_r + m * R_omega_3 * quarter_tan_theta)
        - R_omega_2_omega_3 * bias_0_part_1;
    let R_omega_1_omega_3 = R_omega_3 * omega_1;
    let m_R_squared_omega_1_omega_3 = m_R * R_omega_1_omega_3;
    let bias_1 = m_R_squared_omega_1_omega_3
        + m0_R_plus_m0_tan_theta_r * R_omega_1_omega_3 - m0 * two_sigma * R_omega_3;
    let bias_2 = half * m_R_squared * omega_1 * omega_2
        + m0_omega_3_r * (two_sigma - tan_theta_r * omega_1) - m0_r * R_omega_1_omega_3
        - quarter_tan_theta * m_R_squared_omega_1_omega_3;
    let bias_3 = m0 * R_omega_2_omega_3 - m0_omega_3_squared_r - m0_omega_1_r * omega_1;

    MassMatrixAndBias {
        mass_matrix: [
            [mass_matrix_0, zero, zero, -m0_R],
            [zero, mass_matrix_5, -m0_R_r, zero],
            [zero, -m0_R_r, mass_matrix_10, zero],
            [-m0_R, zero, zero, m0],
        ],
        bias: Speeds {
            omega_1: bias_0,
            omega_2: bias_1,
            omega_3: bias_2,
            sigma: bias_3,
        },
    }
}

/// Pseudo-forces Π (generalised forces): virtual power of the loads per pseudo-velocity.
///
/// From `mechanisms/unicycle.toml`.
/// Operations: 10 (3 +, 7 ×), sine or cosine of 1 angle.
#[must_use]
#[inline]
pub fn generalized_forces<T: Real>(
    parameters: &Parameters<T>,
    state: &State<T>,
    inputs: &Inputs<T>,
) -> Speeds<T> {
    let &Parameters { m, m0, R, g } = parameters;
    let &State { theta, r, .. } = state;
    let &Inputs { u } = inputs;
    let zero = T::constant(0.0);

    // Sines and cosines.
    let (sin_theta, cos_theta) = theta.sin_cos();

    // Combinations of parameters.
    let m0_g = m0 * g;

    // generalized_forces
    let R_sin_theta = R * sin_theta;
    let generalized_forces_0 = m * g * R_sin_theta
        + m0_g * (R_sin_theta - cos_theta * r);
    let generalized_forces_3 = u - sin_theta * m0_g;

    Speeds {
        omega_1: generalized_forces_0,
        omega_2: zero,
        omega_3: zero,
        sigma: generalized_forces_3,
    }
}

/// Rates ẋ of the state by Appell's equations M ω̇ + b = Π and kinematics.
///
/// From `mechanisms/unicycle.toml`.
/// Operations: 99 (30 +, 65 ×, 4 ÷), sine or cosine of 2 angles.
#[must_use]
#[inline]
pub fn rates<T: Real>(
    parameters: &Parameters<T>,
    state: &State<T>,
    inputs: &Inputs<T>,
) -> State<T> {
    let &Parameters { m, m0, R, g } = parameters;
    let &State { omega_1, omega_2, omega_3, sigma, theta, r, psi, .. } = state;
    let &Inputs { u } = inputs;
    let quarter = T::constant(0.25);
    let half = T::constant(0.5);
    let one = T::constant(1.0);
    let five_quarters = T::constant(1.25);
    let three_halves = T::constant(1.5);
    let two = T::constant(2.0);

    // Sines and cosines.
    let (sin_theta, cos_theta) = theta.sin_cos();
    let (sin_psi, cos_psi) = psi.sin_cos();

    // Combinations of parameters.
    let m_R = m * R;
    let m_R_squared = R * m_R;
    let three_halves_m_R = three_halves * m_R;
    let m0_R = m0 * R;
    let M_22 = R * (three_halves_m_R + m0_R);
    let inv_m0 = one / m0;

    // Generalised velocities.
    let inv_cos_theta = one / cos_theta;
    let psi_dot = inv_cos_theta * omega_3;
    let tan_theta = sin_theta * inv_cos_theta;
    let phi_dot = omega_2 - tan_theta * omega_3;
    let R_omega_2 = R * omega_2;
    let R_cos_theta_omega_1 = R * cos_theta * omega_1;
    let x_G_dot = cos_psi * R_omega_2 + sin_psi * R_cos_theta_omega_1;
    let y_G_dot = sin_psi * R_omega_2 - cos_psi * R_cos_theta_omega_1;

    // Appell's equations, solved.
    let m0_r = m0 * r;
    let m0_r_squared = m0_r * r;
    let omega_1_dot_part_1 = one / (five_quarters * m_R_squared + m0_r_squared);
    let m0_omega_3_r = m0_r * omega_3;
    let m0_omega_3_squared_r = m0_omega_3_r * omega_3;
    let m0_omega_1_r = m0_r * omega_1;
    let g_sin_theta = g * sin_theta;
    let R_omega_3 = R * omega_3;
    let R_omega_2_omega_3 = R_omega_3 * omega_2;
    let f_4 = m0_omega_3_squared_r + m0_omega_1_r * omega_1 + u
        - m0 * (g_sin_theta + R_omega_2_omega_3);
    let tan_theta_r = tan_theta * r;
    let two_sigma = two * sigma;
    let m0_R_plus_m0_tan_theta_r = m0_R + tan_theta * m0_r;
    let quarter_tan_theta = quarter * tan_theta;
    let f_1_part_1 = R_omega_2_omega_3 * (three_halves_m_R + m0_R_plus_m0_tan_theta_r)
        + g_sin_theta * (m_R + m0_R) - g * cos_theta * m0_r
        - m0_omega_3_squared_r * tan_theta_r - m0_omega_1_r * two_sigma;
    let f_1 = f_1_part_1
        - R_omega_3 * (m0_omega_3_r + m * R_omega_3 * quarter_tan_theta);
    let omega_1_dot = omega_1_dot_part_1 * (f_1 + R * f_4);
    let R_omega_1_omega_3 = R_omega_3 * omega_1;
    let m_R_squared_omega_1_omega_3 = m_R * R_omega_1_omega_3;
    let f_3 = m0_r * R_omega_1_omega_3 + quarter_tan_theta * m_R_squared_omega_1_omega_3
        - half * m_R_squared * omega_1 * omega_2
        - m0_omega_3_r * (two_sigma - tan_theta_r * omega_1);
    let m0_R_r = R * m0_r;
    let f_2 = m0 * R_omega_3 * two_sigma - m_R_squared_omega_1_omega_3
        - m0_R_plus_m0_tan_theta_r * R_omega_1_omega_3;
    let M_33 = quarter * m_R_squared + m0_r_squared;
    let D_2 = M_22 * M_33 - m0_R_r * m0_R_r;
    let inv_D_2 = one / D_2;
    let omega_2_dot = inv_D_2 * (f_3 * m0_R_r + f_2 * M_33);
    let omega_3_dot = inv_D_2 * (m0_R_r * f_2 + M_22 * f_3);
    let sigma_dot = inv_m0 * f_4 + R * omega_1_dot;

    State {
        omega_1: omega_1_dot,
        omega_2: omega_2_dot,
        omega_3: omega_3_dot,
        sigma: sigma_dot,
        theta: omega_1,
        r: sigma,
        psi: psi_dot,
        phi: phi_dot,
        x_G: x_G_dot,
        y_G: y_G_dot,
    }
}

/// Rates ẋ with their derivatives by state and inputs.
///
/// From `mechanisms/unicycle.toml`.
/// Operations: 261 (70 +, 179 ×, 4 ÷, 8 sign), sine or cosine of 2 angles.
#[must_use]
#[inline]
pub fn jacobians<T: Real>(
    parameters: &Parameters<T>,
    state: &State<T>,
    inputs: &Inputs<T>,
) -> Jacobians<T> {
    let &Parameters { m, m0, R, g } = parameters;
    let &State { omega_1, omega_2, omega_3, sigma, theta, r, psi, .. } = state;
    let &Inputs { u } = inputs;
    let zero = T::constant(0.0);
    let quarter = T::constant(0.25);
    let half = T::constant(0.5);
    let one = T::constant(1.0);
    let five_quarters = T::constant(1.25);
    let three_halves = T::constant(1.5);
    let two = T::constant(2.0);

    // Sines and cosines.
    let (sin_theta, cos_theta) = theta.sin_cos();
    let (sin_psi, cos_psi) = psi.sin_cos();

    // Combinations of parameters.
    let m_R = m * R;
    let three_halves_m_R = three_halves * m_R;
    let minus_half_m_R = -half * m_R;
    let quarter_m_R = quarter * m_R;
    let m0_R = m0 * R;
    let M_22 = R * (three_halves_m_R + m0_R);
    let inv_m0 = one / m0;

    // Generalised velocities.
    let inv_cos_theta = one / cos_theta;
    let psi_dot = inv_cos_theta * omega_3;
    let tan_theta = sin_theta * inv_cos_theta;
    let tan_theta_omega_3 = tan_theta * omega_3;
    let phi_dot = omega_2 - tan_theta_omega_3;
    let R_omega_2 = R * omega_2;
    let R_omega_1 = R * omega_1;
    let R_cos_theta_omega_1 = cos_theta * R_omega_1;
    let x_G_dot = cos_psi * R_omega_2 + sin_psi * R_cos_theta_omega_1;
    let y_G_dot = sin_psi * R_omega_2 - cos_psi * R_cos_theta_omega_1;

    // Appell's equations, solved.
    let m0_r = m0 * r;
    let m0_r_squared = m0_r * r;
    let omega_1_dot_part_1 = one / (five_quarters * R * m_R + m0_r_squared);
    let omega_3_r = omega_3 * r;
    let omega_3_squared_r = omega_3_r * omega_3;
    let omega_1_r = omega_1 * r;
    let g_sin_theta = g * sin_theta;
    let R_omega_3 = R * omega_3;
    let R_omega_2_omega_3 = R_omega_3 * omega_2;
    let f_4_part_1 = g_sin_theta + R_omega_2_omega_3;
    let f_4 = u + m0 * (omega_3_squared_r + omega_1_r * omega_1 - f_4_part_1);
    let R_tan_theta_omega_3 = tan_theta * R_omega_3;
    let quarter_m_R_omega_3 = quarter * m * R_omega_3;
    let tan_theta_omega_3_squared_r = tan_theta_omega_3 * omega_3_r;
    let g_cos_theta = g * cos_theta;
    let two_sigma = two * sigma;
    let f_1_part_1 = g_cos_theta + R_omega_3 * omega_3 + two_sigma * omega_1
        - R_tan_theta_omega_3 * omega_2;
    let f_1_part_2 = r * (f_1_part_1 + tan_theta_omega_3_squared_r) - R * f_4_part_1;
    let f_1 = m_R * g_sin_theta + three_halves_m_R * R_omega_2_omega_3
        - R_tan_theta_omega_3 * quarter_m_R_omega_3 - m0 * f_1_part_2;
    let omega_1_dot = omega_1_dot_part_1 * (f_1 + R * f_4);
    let m0_R_r = R * m0_r;
    let minus_half_m_R_squared_omega_1 = minus_half_m_R * R_omega_1;
    let m0_R_omega_1_r = m0_R_r * omega_1;
    let two_m0_r = two * m0_r;
    let M_33 = R * quarter_m_R + m0_r_squared;
    let M_33_omega_1 = M_33 * omega_1;
    let d_f_3_d_omega_3 = m0_R_omega_1_r + tan_theta * M_33_omega_1 - two_m0_r * sigma;
    let f_3 = minus_half_m_R_squared_omega_1 * omega_2 + d_f_3_d_omega_3 * omega_3;
    let m0_tan_theta_r = tan_theta * m0_r;
    let m_R_plus_m0_tan_theta_r = m_R + m0_tan_theta_r;
    let f_2_part_1 = m0 * (two_sigma - R_omega_1) - m_R_plus_m0_tan_theta_r * omega_1;
    let f_2 = R_omega_3 * f_2_part_1;
    let D_2 = M_22 * M_33 - m0_R_r * m0_R_r;
    let inv_D_2 = one / D_2;
    let omega_2_dot = inv_D_2 * (m0_R_r * f_3 + M_33 * f_2);
    let omega_3_dot = inv_D_2 * (m0_R_r * f_2 + M_22 * f_3);
    let sigma_dot = inv_m0 * f_4 + R * omega_1_dot;

    // Row `omega_1` of A.
    let m0_sigma_r_minus_m0_R_omega_1_r = m0_r * sigma - m0_R_omega_1_r;
    let A_omega_1_omega_1_part_1 = -two * omega_1_dot_part_1;
    let A_omega_1_omega_1 = m0_sigma_r_minus_m0_R_omega_1_r * A_omega_1_omega_1_part_1;
    let A_omega_1_omega_2_part_1 = three_halves_m_R + m0_tan_theta_r;
    let A_omega_1_omega_2_part_2 = R_omega_3 * A_omega_1_omega_2_part_1;
    let A_omega_1_omega_2 = omega_1_dot_part_1 * A_omega_1_omega_2_part_2;
    let tan_theta_omega_3_r = tan_theta_omega_3 * r;
    let half_m_R_tan_theta_omega_3 = half * m * R_tan_theta_omega_3;
    let A_omega_1_omega_3_part_1 = A_omega_1_omega_2_part_1 * omega_2;
    let A_omega_1_omega_3_part_2 = half_m_R_tan_theta_omega_3 - A_omega_1_omega_3_part_1;
    let A_omega_1_omega_3_part_3 = two_m0_r * tan_theta_omega_3_r
        + R * A_omega_1_omega_3_part_2;
    let A_omega_1_omega_3 = -omega_1_dot_part_1 * A_omega_1_omega_3_part_3;
    let m0_omega_1_r = m0_r * omega_1;
    let A_omega_1_sigma = A_omega_1_omega_1_part_1 * m0_omega_1_r;
    let inv_cos_theta_squared = inv_cos_theta * inv_cos_theta;
    let A_omega_1_theta_part_1 = R_omega_3 * inv_cos_theta_squared;
    let A_omega_1_theta_part_2 = omega_3_squared_r - R_omega_2_omega_3;
    let A_omega_1_theta_part_3 = inv_cos_theta_squared * A_omega_1_theta_part_2;
    let A_omega_1_theta_part_4 = m_R * g_cos_theta
        + m0_r * (g_sin_theta - A_omega_1_theta_part_3)
        - quarter_m_R_omega_3 * A_omega_1_theta_part_1;
    let A_omega_1_theta = omega_1_dot_part_1 * A_omega_1_theta_part_4;
    let A_omega_1_r_part_1 = omega_1 * omega_1 + omega_3 * omega_3;
    let A_omega_1_r_part_2 = m0_R * A_omega_1_r_part_1;
    let A_omega_1_r_part_3 = m0 * (f_1_part_1 + two * tan_theta_omega_3_squared_r);
    let A_omega_1_r_part_4 = A_omega_1_r_part_2 - A_omega_1_r_part_3;
    let A_omega_1_r = omega_1_dot_part_1 * (A_omega_1_r_part_4 - omega_1_dot * two_m0_r);

    // Row `omega_2` of A.
    let d_f_2_d_omega_1 = -R_omega_3 * (m0_R + m_R_plus_m0_tan_theta_r);
    let d_f_3_d_omega_1 = quarter_m_R * R_tan_theta_omega_3 + minus_half_m_R * R_omega_2
        + m0_r * (R_omega_3 + tan_theta_omega_3_r);
    let A_omega_2_omega_1 = inv_D_2
        * (M_33 * d_f_2_d_omega_1 + m0_R_r * d_f_3_d_omega_1);
    let A_omega_2_omega_2_part_1 = minus_half_m_R_squared_omega_1 * inv_D_2;
    let A_omega_2_omega_2 = m0_R_r * A_omega_2_omega_2_part_1;
    let d_f_2_d_omega_3 = R * f_2_part_1;
    let A_omega_2_omega_3 = inv_D_2
        * (M_33 * d_f_2_d_omega_3 + m0_R_r * d_f_3_d_omega_3);
    let m0_R_omega_3 = m0 * R_omega_3;
    let minus_two_over_D_2 = -two * inv_D_2;
    let A_omega_2_sigma = minus_two_over_D_2
        * (m0_r * m0_r * R_omega_3 - M_33 * m0_R_omega_3);
    let d_f_3_d_r = m0_R_omega_3 * omega_1 + two * tan_theta_omega_3 * m0_omega_1_r
        - m0 * two_sigma * omega_3;
    let A_omega_2_r_part_1 = R_tan_theta_omega_3 * M_33_omega_1 - two * f_2 * r;
    let d_D_2_d_r = M_22 * two_m0_r - two * m0_R * m0_R_r;
    let A_omega_2_r_part_2 = m0 * (A_omega_2_r_part_1 - R * (f_3 + d_f_3_d_r * r));
    let A_omega_2_r = -inv_D_2 * (A_omega_2_r_part_2 + omega_2_dot * d_D_2_d_r);

    // Row `omega_3` of A.
    let A_omega_3_omega_1 = inv_D_2
        * (M_22 * d_f_3_d_omega_1 + m0_R_r * d_f_2_d_omega_1);
    let A_omega_3_omega_2 = M_22 * A_omega_2_omega_2_part_1;
    let A_omega_3_omega_3 = inv_D_2
        * (M_22 * d_f_3_d_omega_3 + m0_R_r * d_f_2_d_omega_3);
    let A_omega_3_sigma = minus_two_over_D_2
        * (M_22 * m0_r * omega_3 - m0_R_r * m0_R_omega_3);
    let A_omega_3_theta_part_1 = omega_3_r * m0_omega_1_r * inv_cos_theta_squared;
    let A_omega_3_theta_part_2 = quarter_m_R * A_omega_1_theta_part_1 * omega_1;
    let A_omega_3_theta_part_3 = A_omega_3_theta_part_1 + A_omega_3_theta_part_2;
    let A_omega_3_theta_part_4 = M_22 * A_omega_3_theta_part_3;
    let A_omega_3_theta_part_5 = m0_R_r * m0_omega_1_r * A_omega_1_theta_part_1;
    let A_omega_3_theta = inv_D_2 * (A_omega_3_theta_part_4 - A_omega_3_theta_part_5);
    let M_22_d_f_3_d_r_plus_m0_R_f_2 = M_22 * d_f_3_d_r + m0_R * f_2;
    let A_omega_3_r_part_1 = m0 * R_tan_theta_omega_3 * m0_R_omega_1_r;
    let A_omega_3_r_part_2 = M_22_d_f_3_d_r_plus_m0_R_f_2 - A_omega_3_r_part_1;
    let A_omega_3_r = inv_D_2 * (A_omega_3_r_part_2 - omega_3_dot * d_D_2_d_r);

    // Row `sigma` of A.
    let B_omega_1_u = R * omega_1_dot_part_1;
    let A_sigma_omega_1_part_1 = m0_sigma_r_minus_m0_R_omega_1_r * B_omega_1_u;
    let A_sigma_omega_1 = two * (omega_1_r - A_sigma_omega_1_part_1);
    let A_sigma_omega_2 = A_omega_1_omega_2_part_2 * B_omega_1_u - R_omega_3;
    let A_sigma_omega_3 = inv_m0 * (two_m0_r * omega_3 - m0_R * omega_2)
        - A_omega_1_omega_3_part_3 * B_omega_1_u;
    let A_sigma_sigma = m0_R_omega_1_r * A_omega_1_omega_1_part_1;
    let A_sigma_theta = A_omega_1_theta_part_4 * B_omega_1_u - g_cos_theta;
    let A_sigma_r = A_omega_1_r_part_1 + R * A_omega_1_r;

    // Row `psi` of A.
    let A_psi_theta = inv_cos_theta * tan_theta_omega_3;

    // Row `phi` of A.
    let A_phi_theta = -inv_cos_theta_squared * omega_3;

    // Row `x_G` of A.
    let R_cos_theta = R * cos_theta;
    let A_x_G_omega_1 = sin_psi * R_cos_theta;
    let A_x_G_omega_2 = R * cos_psi;
    let R_sin_theta_omega_1 = sin_theta * R_omega_1;
    let A_x_G_theta = -sin_psi * R_sin_theta_omega_1;

    // Row `y_G` of A.
    let A_y_G_omega_1 = -cos_psi * R_cos_theta;
    let A_y_G_omega_2 = R * sin_psi;
    let A_y_G_theta = cos_psi * R_sin_theta_omega_1;

    // Row `sigma` of B.
    let B_sigma_u = inv_m0 + R * B_omega_1_u;

    // Rows and columns: 0 omega_1, 1 omega_2, 2 omega_3, 3 sigma, 4 theta, 5 r, 6 psi, 7 phi,
    //   8 x_G, 9 y_G.
    let mut A = [[zero; 10]; 10];
    A[0][0] = A_omega_1_omega_1;
    A[0][1] = A_omega_1_omega_2;
    A[0][2] = A_omega_1_omega_3;
    A[0][3] = A_omega_1_sigma;
    A[0][4] = A_omega_1_theta;
    A[0][5] = A_omega_1_r;
    A[1][0] = A_omega_2_omega_1;
    A[1][1] = A_omega_2_omega_2;
    A[1][2] = A_omega_2_omega_3;
    A[1][3] = A_omega_2_sigma;
    A[1][5] = A_omega_2_r;
    A[2][0] = A_omega_3_omega_1;
    A[2][1] = A_omega_3_omega_2;
    A[2][2] = A_omega_3_omega_3;
    A[2][3] = A_omega_3_sigma;
    A[2][4] = A_omega_3_theta;
    A[2][5] = A_omega_3_r;
    A[3][0] = A_sigma_omega_1;
    A[3][1] = A_sigma_omega_2;
    A[3][2] = A_sigma_omega_3;
    A[3][3] = A_sigma_sigma;
    A[3][4] = A_sigma_theta;
    A[3][5] = A_sigma_r;
    A[4][0] = one;
    A[5][3] = one;
    A[6][2] = inv_cos_theta;
    A[6][4] = A_psi_theta;
    A[7][1] = one;
    A[7][2] = -tan_theta;
    A[7][4] = A_phi_theta;
    A[8][0] = A_x_G_omega_1;
    A[8][1] = A_x_G_omega_2;
    A[8][4] = A_x_G_theta;
    A[8][6] = -y_G_dot;
    A[9][0] = A_y_G_omega_1;
    A[9][1] = A_y_G_omega_2;
    A[9][4] = A_y_G_theta;
    A[9][6] = x_G_dot;

    // Rows: 0 omega_1, 1 omega_2, 2 omega_3, 3 sigma, 4 theta, 5 r, 6 psi, 7 phi,
    //   8 x_G, 9 y_G.
    // Columns: 0 u.
    let mut B = [[zero; 1]; 10];
    B[0][0] = B_omega_1_u;
    B[3][0] = B_sigma_u;

    Jacobians {
        rates: State {
            omega_1: omega_1_dot,
            omega_2: omega_2_dot,
            omega_3: omega_3_dot,
            sigma: sigma_dot,
            theta: omega_1,
            r: sigma,
            psi: psi_dot,
            phi: phi_dot,
            x_G: x_G_dot,
            y_G: y_G_dot,
        },
        a: A,
        b: B,
    }
}

/// P = ∂ẋ/∂p. Rows follow [`State`], columns [`Parameters`].
///
/// Rows: `omega_1`, `omega_2`, `omega_3`, `sigma`, `theta`, `r`, `psi`, `phi`, `x_G`, `y_G`. Columns: `m`, `m0`, `R`, `g`.
///
/// From `mechanisms/unicycle.toml`.
/// Operations: 252 (86 +, 162 ×, 4 ÷), sine or cosine of 2 angles.
#[must_use]
#[inline]
pub fn parameter_jacobian<T: Real>(
    parameters: &Parameters<T>,
    state: &State<T>,
    inputs: &Inputs<T>,
) -> [[T; 4]; 10] {
    let &Parameters { m, m0, R, g } = parameters;
    let &State { omega_1, omega_2, omega_3, sigma, theta, r, psi, .. } = state;
    let &Inputs { u } = inputs;
    let zero = T::constant(0.0);
    let quarter = T::constant(0.25);
    let half = T::constant(0.5);
    let one = T::constant(1.0);
    let five_quarters = T::constant(1.25);
    let three_halves = T::constant(1.5);
    let two = T::constant(2.0);
    let five_halves = T::constant(2.5);
    let three = T::constant(3.0);
    let four = T::constant(4.0);

    // Sines and cosines.
    let (sin_theta, cos_theta) = theta.sin_cos();
    let (sin_psi, cos_psi) = psi.sin_cos();

    // Combinations of parameters.
    let R_squared = R * R;
    let m_R_squared = m * R_squared;
    let three_halves_R_squared = three_halves * R_squared;
    let quarter_R_squared = quarter * R_squared;
    let m0_R = m0 * R;
    let m_R = m * R;
    let quarter_m_R_squared = quarter * m_R_squared;
    let three_halves_m_R_squared = three_halves * m_R_squared;
    let half_m_R = half * m_R;
    let d_M_22_d_R = three * m_R + two * m0_R;
    let M_22 = three_halves_m_R_squared + m0 * R_squared;
    let inv_m0 = one / m0;

    // Row `omega_1` of P.
    let m0_r = m0 * r;
    let m0_r_squared = m0_r * r;
    let P_omega_1_m_part_1 = one / (five_quarters * m_R_squared + m0_r_squared);
    let g_sin_theta = g * sin_theta;
    let R_g_sin_theta = R * g_sin_theta;
    let omega_2_omega_3 = omega_2 * omega_3;
    let tan_theta = sin_theta / cos_theta;
    let omega_3_squared = omega_3 * omega_3;
    let tan_theta_omega_3_squared = tan_theta * omega_3_squared;
    let d_f_1_d_m = R_g_sin_theta + three_halves_R_squared * omega_2_omega_3
        - quarter_R_squared * tan_theta_omega_3_squared;
    let m0_R_omega_2_omega_3 = m0_R * omega_2_omega_3;
    let omega_1_squared = omega_1 * omega_1;
    let f_4_part_1 = m0 * g_sin_theta - m0_r * omega_3_squared;
    let f_4 = m0_r * omega_1_squared + u - f_4_part_1 - m0_R_omega_2_omega_3;
    let two_sigma = two * sigma;
    let r_squared = r * r;
    let R_r = R * r;
    let d_f_1_d_m0 = R_g_sin_theta + omega_2_omega_3 * (R_squared + tan_theta * R_r)
        - two_sigma * omega_1 * r - tan_theta_omega_3_squared * r_squared
        - omega_3_squared * R_r - g * cos_theta * r;
    let f_1 = m_R * g_sin_theta + three_halves_m_R_squared * omega_2_omega_3
        + m0 * d_f_1_d_m0 - quarter_m_R_squared * tan_theta_omega_3_squared;
    let omega_1_dot = P_omega_1_m_part_1 * (f_1 + R * f_4);
    let P_omega_1_m_part_2 = P_omega_1_m_part_1 * omega_1_dot;
    let P_omega_1_m = P_omega_1_m_part_1 * d_f_1_d_m
        - five_quarters * R_squared * P_omega_1_m_part_2;
    let d_f_4_d_m0 = r * (omega_3_squared + omega_1_squared) - g_sin_theta
        - R * omega_2_omega_3;
    let P_omega_1_m0 = P_omega_1_m_part_1 * (d_f_1_d_m0 + R * d_f_4_d_m0)
        - r_squared * P_omega_1_m_part_2;
    let half_m_R_tan_theta_omega_3 = half_m_R * tan_theta * omega_3;
    let P_omega_1_R_part_1 = omega_2 * (d_M_22_d_R + m0_r * tan_theta);
    let P_omega_1_R_part_2 = half_m_R_tan_theta_omega_3 - P_omega_1_R_part_1;
    let P_omega_1_R_part_3 = m0_R_omega_2_omega_3 + omega_3 * P_omega_1_R_part_2;
    let P_omega_1_R_part_4 = P_omega_1_R_part_3 - f_4_part_1 - f_4 - m * g_sin_theta;
    let P_omega_1_R = -five_halves * m_R * P_omega_1_m_part_2
        - P_omega_1_m_part_1 * P_omega_1_R_part_4;
    let P_omega_1_g = P_omega_1_m_part_1 * (sin_theta * m_R - cos_theta * m0_r);

    // Row `omega_2` of P.
    let M_33 = quarter_m_R_squared + m0_r_squared;
    let d_D_2_d_m = three_halves_R_squared * M_33 + quarter_R_squared * M_22;
    let m0_R_r = R * m0_r;
    let omega_1_omega_2 = omega_1 * omega_2;
    let f_3_part_1 = omega_1 * (m0_R_r + tan_theta * M_33) - m0_r * two_sigma;
    let f_3 = omega_3 * f_3_part_1 - half * m_R_squared * omega_1_omega_2;
    let omega_1_omega_3 = omega_1 * omega_3;
    let tan_theta_omega_1_omega_3 = tan_theta * omega_1_omega_3;
    let m0_tan_theta_omega_1_omega_3_r = m0_r * tan_theta_omega_1_omega_3;
    let two_omega_3_sigma = two_sigma * omega_3;
    let omega_1_omega_3_m_R_plus_m0_R = omega_1_omega_3 * (m_R + m0_R);
    let f_2_part_1 = m0 * two_omega_3_sigma - omega_1_omega_3_m_R_plus_m0_R;
    let f_2 = R * (f_2_part_1 - m0_tan_theta_omega_1_omega_3_r);
    let D_2 = M_22 * M_33 - R_squared * m0_r * m0_r;
    let inv_D_2 = one / D_2;
    let inv_D_2_squared = inv_D_2 * inv_D_2;
    let P_omega_2_m_part_1 = inv_D_2_squared * (m0_R_r * f_3 + M_33 * f_2);
    let P_omega_2_m_part_2 = R_squared
        * (tan_theta_omega_1_omega_3 - two * omega_1_omega_2);
    let R_squared_omega_1_omega_3 = R_squared * omega_1_omega_3;
    let P_omega_2_m_part_3 = four * M_33 * R_squared_omega_1_omega_3 - R_squared * f_2;
    let minus_quarter_over_D_2 = -quarter * inv_D_2;
    let P_omega_2_m_part_4 = P_omega_2_m_part_3 - m0_R_r * P_omega_2_m_part_2;
    let P_omega_2_m = minus_quarter_over_D_2 * P_omega_2_m_part_4
        - d_D_2_d_m * P_omega_2_m_part_1;
    let d_f_2_d_m0 = R * two_omega_3_sigma - R_squared_omega_1_omega_3
        - R_r * tan_theta_omega_1_omega_3;
    let d_f_3_d_m0 = r_squared * tan_theta_omega_1_omega_3 + R_r * omega_1_omega_3
        - two_omega_3_sigma * r;
    let P_omega_2_m0_part_1 = M_33 * d_f_2_d_m0 + r_squared * f_2;
    let P_omega_2_m0_part_2 = P_omega_2_m0_part_1 + m0_R_r * d_f_3_d_m0 + R_r * f_3;
    let d_D_2_d_m0 = M_22 * r_squared + R_squared * (M_33 - two * m0_r_squared);
    let P_omega_2_m0 = inv_D_2 * P_omega_2_m0_part_2 - P_omega_2_m_part_1 * d_D_2_d_m0;
    let two_m0_R_r = two * m0_R_r;
    let d_D_2_d_R = d_M_22_d_R * M_33 + half_m_R * M_22 - m0_r * two_m0_R_r;
    let d_f_3_d_R = m0_r * omega_1_omega_3 + half_m_R * tan_theta_omega_1_omega_3
        - m_R * omega_1_omega_2;
    let P_omega_2_R_part_1 = omega_1_omega_3_m_R_plus_m0_R
        + half * m0_tan_theta_omega_1_omega_3_r - m0 * omega_3 * sigma;
    let P_omega_2_R_part_2 = half_m_R * f_2 + m0_r * f_3 + m0_R_r * d_f_3_d_R;
    let P_omega_2_R_part_3 = P_omega_2_R_part_2 - two * M_33 * P_omega_2_R_part_1;
    let P_omega_2_R = inv_D_2 * P_omega_2_R_part_3 - P_omega_2_m_part_1 * d_D_2_d_R;

    // Row `omega_3` of P.
    let P_omega_3_m_part_1 = inv_D_2_squared * (m0_R_r * f_2 + M_22 * f_3);
    let three_halves_R_squared_f_3 = three_halves_R_squared * f_3;
    let P_omega_3_m_part_2 = quarter * M_22 * P_omega_2_m_part_2;
    let P_omega_3_m_part_3 = three_halves_R_squared_f_3 + P_omega_3_m_part_2;
    let P_omega_3_m_part_4 = P_omega_3_m_part_3 - m0_R_r * R_squared_omega_1_omega_3;
    let P_omega_3_m = inv_D_2 * P_omega_3_m_part_4 - d_D_2_d_m * P_omega_3_m_part_1;
    let P_omega_3_m0_part_1 = R_squared * f_3 + M_22 * d_f_3_d_m0;
    let P_omega_3_m0_part_2 = P_omega_3_m0_part_1 + m0_R_r * d_f_2_d_m0 + R_r * f_2;
    let P_omega_3_m0 = inv_D_2 * P_omega_3_m0_part_2 - d_D_2_d_m0 * P_omega_3_m_part_1;
    let P_omega_3_R_part_1 = M_22 * d_f_3_d_R + d_M_22_d_R * f_3 + m0_r * f_2;
    let P_omega_3_R_part_2 = P_omega_3_R_part_1 - two_m0_R_r * P_omega_2_R_part_1;
    let P_omega_3_R = inv_D_2 * P_omega_3_R_part_2 - d_D_2_d_R * P_omega_3_m_part_1;

    // Row `sigma` of P.
    let P_sigma_m = R * P_omega_1_m;
    let P_sigma_m0 = R * P_omega_1_m0 - inv_m0 * (inv_m0 * f_4 - d_f_4_d_m0);
    let P_sigma_R = omega_1_dot + R * P_omega_1_R - omega_2_omega_3;
    let P_sigma_g = R * P_omega_1_g - sin_theta;

    // Row `x_G` of P.
    let cos_theta_omega_1 = cos_theta * omega_1;
    let P_x_G_R = sin_psi * cos_theta_omega_1 + cos_psi * omega_2;

    // Row `y_G` of P.
    let P_y_G_R = sin_psi * omega_2 - cos_psi * cos_theta_omega_1;

    // Rows: 0 omega_1, 1 omega_2, 2 omega_3, 3 sigma, 4 theta, 5 r, 6 psi, 7 phi,
    //   8 x_G, 9 y_G.
    // Columns: 0 m, 1 m0, 2 R, 3 g.
    let mut P = [[zero; 4]; 10];
    P[0][0] = P_omega_1_m;
    P[0][1] = P_omega_1_m0;
    P[0][2] = P_omega_1_R;
    P[0][3] = P_omega_1_g;
    P[1][0] = P_omega_2_m;
    P[1][1] = P_omega_2_m0;
    P[1][2] = P_omega_2_R;
    P[2][0] = P_omega_3_m;
    P[2][1] = P_omega_3_m0;
    P[2][2] = P_omega_3_R;
    P[3][0] = P_sigma_m;
    P[3][1] = P_sigma_m0;
    P[3][2] = P_sigma_R;
    P[3][3] = P_sigma_g;
    P[8][2] = P_x_G_R;
    P[9][2] = P_y_G_R;

    P
}

/// Energies and power.
///
/// From `mechanisms/unicycle.toml`.
/// Operations: 8 (8 ×), sine or cosine of 1 angle.
#[must_use]
#[inline]
pub fn energies<T: Real>(
    parameters: &Parameters<T>,
    state: &State<T>,
    inputs: &Inputs<T>,
) -> Energies<T> {
    let &Parameters { m, R, g, .. } = parameters;
    let &State { omega_2, sigma, theta, .. } = state;
    let &Inputs { u } = inputs;
    let three_quarters = T::constant(0.75);

    // Combinations of parameters.
    let m_R = m * R;

    // kinetic
    let kinetic = three_quarters * R * m_R * omega_2 * omega_2;

    // potential
    let potential = g * m_R * theta.cos();

    // power
    let power = sigma * u;

    Energies {
        kinetic,
        potential,
        power,
    }
}

/// The mechanism unicycle.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Unicycle;

const _: () = {
    use model::At;

    const N: usize = 10;
    const S: usize = 4;
    const M: usize = 1;
    const K: usize = 4;

    /// The first numbers of a slice that holds at least as many.
    fn first<const LEN: usize>(numbers: &[f64]) -> [f64; LEN] {
        core::array::from_fn(|i| numbers[i])
    }

    fn parameters(at: &At<'_>) -> Parameters<f64> {
        first::<K>(at.p).into()
    }

    fn state(at: &At<'_>) -> State<f64> {
        first::<N>(at.x).into()
    }

    fn inputs(at: &At<'_>) -> Inputs<f64> {
        first::<M>(at.u).into()
    }

    fn write(to: &mut [f64], from: &[f64]) {
        to.copy_from_slice(from);
    }

    impl model::Model for Unicycle {
        fn info(&self) -> &model::ModelInfo {
            &INFO
        }

        fn rates(&self, at: At<'_>, rates: &mut [f64]) {
            write(
                rates,
                &<[f64; N]>::from(
                    self::rates(&parameters(&at), &state(&at), &inputs(&at)),
                ),
            );
        }

        fn jacobians(
            &self,
            at: At<'_>,
            rates: &mut [f64],
            a: &mut [f64],
            b: &mut [f64],
        ) {
            let all = jacobians(&parameters(&at), &state(&at), &inputs(&at));
            write(rates, &<[f64; N]>::from(all.rates));
            write(a, all.a.as_flattened());
            write(b, all.b.as_flattened());
        }

        fn parameter_jacobian(&self, at: At<'_>, p: &mut [f64]) {
            write(
                p,
                self::parameter_jacobian(&parameters(&at), &state(&at), &inputs(&at))
                    .as_flattened(),
            );
        }

        fn appell(
            &self,
            at: At<'_>,
            mass: &mut [f64],
            bias: &mut [f64],
            forces: &mut [f64],
        ) {
            let left = mass_matrix_and_bias(&parameters(&at), &state(&at), &inputs(&at));
            write(mass, left.mass_matrix.as_flattened());
            write(bias, &<[f64; S]>::from(left.bias));
            write(
                forces,
                &<[f64; S]>::from(
                    generalized_forces(&parameters(&at), &state(&at), &inputs(&at)),
                ),
            );
        }

        fn energies(&self, at: At<'_>) -> model::Energies {
            let all = energies(&parameters(&at), &state(&at), &inputs(&at));
            model::Energies {
                kinetic: all.kinetic,
                potential: all.potential,
                power: all.power,
                acceleration: acceleration_energy(
                        &parameters(&at),
                        &state(&at),
                        &inputs(&at),
                    )
                    .total,
            }
        }

        fn constraint_residual(&self, _at: At<'_>, _none: &mut [f64]) {}

        fn constraint_forces(&self, _at: At<'_>, _none: &mut [f64]) {}

        fn outputs(&self, _at: At<'_>, _none: &mut [f64]) {}
    }
};

/// Pseudo-velocities and coordinates.
static STATES: [model::Quantity; 10] = [
    model::Quantity::new("omega_1", "Tilt rate of the wheel.", "rad/s"),
    model::Quantity::new("omega_2", "Spin of the wheel about its axle.", "rad/s"),
    model::Quantity::new("omega_3", "Turn rate about the wheel's vertical.", "rad/s"),
    model::Quantity::new("sigma", "Speed of the mass along its guide.", "m/s"),
    model::Quantity::new("theta", "Tilt.", "rad"),
    model::Quantity::new("r", "Position of the mass on its guide.", "m"),
    model::Quantity::new("psi", "Yaw.", "rad"),
    model::Quantity::new("phi", "Rotation of the wheel.", "rad"),
    model::Quantity::new("x_G", "Position of the wheel's centre.", "m"),
    model::Quantity::new("y_G", "Position of the wheel's centre.", "m"),
];

/// Inputs and signals.
static INPUTS: [model::Quantity; 1] = [
    model::Quantity::new("u", "Force on the moving mass.", "N"),
];

/// Parameters.
static PARAMETERS: [model::Quantity; 4] = [
    model::Quantity::new("m", "Mass of the wheel.", "kg").valued(10.0),
    model::Quantity::new("m0", "Moving mass.", "kg").valued(5.0),
    model::Quantity::new("R", "Radius of the wheel.", "m").valued(0.3),
    model::Quantity::new("g", "Gravity.", "m/s²").valued(9.81),
];

/// Outputs.
static OUTPUTS: [model::Quantity; 0] = [];

/// Tabulated functions of time.
static SIGNALS: [model::SignalTable; 0] = [];

/// Signal and order of derivative behind the inputs that are signals.
static SIGNAL_INPUTS: [(usize, u8); 0] = [];

/// Constraint rows.
static CONSTRAINT_ROWS: [model::Text; 0] = [];

/// Reactions in the ground.
static REACTIONS: [model::Reaction; 0] = [];

/// Contacts, which can only push.
static CONTACTS: [model::Contact; 0] = [];

/// Names, units and sizes of the model.
pub static INFO: model::ModelInfo = model::ModelInfo {
    name: model::Text::Borrowed("unicycle"),
    title: model::Text::Borrowed("The mechanism unicycle."),
    source: model::Text::Borrowed(""),
    states: model::List::Borrowed(&STATES),
    speeds: 4,
    inputs: model::List::Borrowed(&INPUTS),
    declared_inputs: 1,
    signals: model::List::Borrowed(&SIGNALS),
    signal_inputs: model::List::Borrowed(&SIGNAL_INPUTS),
    parameters: model::List::Borrowed(&PARAMETERS),
    outputs: model::List::Borrowed(&OUTPUTS),
    constraint_rows: model::List::Borrowed(&CONSTRAINT_ROWS),
    reactions: model::List::Borrowed(&REACTIONS),
    contacts: model::List::Borrowed(&CONTACTS),
    explicit_time: false,
};

impl<T> From<[T; 4]> for Parameters<T> {
    fn from([m, m0, R, g]: [T; 4]) -> Self {
        Self { m, m0, R, g }
    }
}

impl<T> From<Parameters<T>> for [T; 4] {
    fn from(Parameters { m, m0, R, g }: Parameters<T>) -> Self {
        [m, m0, R, g]
    }
}

impl<T> From<[T; 4]> for Speeds<T> {
    fn from([omega_1, omega_2, omega_3, sigma]: [T; 4]) -> Self {
        Self {
            omega_1,
            omega_2,
            omega_3,
            sigma,
        }
    }
}

impl<T> From<Speeds<T>> for [T; 4] {
    fn from(Speeds { omega_1, omega_2, omega_3, sigma }: Speeds<T>) -> Self {
        [omega_1, omega_2, omega_3, sigma]
    }
}

impl<T> From<[T; 6]> for Coordinates<T> {
    fn from([theta, r, psi, phi, x_G, y_G]: [T; 6]) -> Self {
        Self {
            theta,
            r,
            psi,
            phi,
            x_G,
            y_G,
        }
    }
}

impl<T> From<Coordinates<T>> for [T; 6] {
    fn from(Coordinates { theta, r, psi, phi, x_G, y_G }: Coordinates<T>) -> Self {
        [theta, r, psi, phi, x_G, y_G]
    }
}

impl<T> From<[T; 10]> for State<T> {
    fn from(
        [omega_1,
        omega_2,
        omega_3,
        sigma,
        theta,
        r,
        psi,
        phi,
        x_G,
        y_G,
        ]: [T; 10],
    ) -> Self {
        Self {
            omega_1,
            omega_2,
            omega_3,
            sigma,
            theta,
            r,
            psi,
            phi,
            x_G,
            y_G,
        }
    }
}

impl<T> From<State<T>> for [T; 10] {
    fn from(
        State {
            omega_1,
            omega_2,
            omega_3,
            sigma,
            theta,
            r,
            psi,
            phi,
            x_G,
            y_G,
        }: State<T>,
    ) -> Self {
        [omega_1, omega_2, omega_3, sigma, theta, r, psi, phi, x_G, y_G]
    }
}

impl<T> From<[T; 1]> for Inputs<T> {
    fn from([u]: [T; 1]) -> Self {
        Self { u }
    }
}

impl<T> From<Inputs<T>> for [T; 1] {
    fn from(Inputs { u }: Inputs<T>) -> Self {
        [u]
    }
}
