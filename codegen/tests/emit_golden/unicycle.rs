/// The spec this module is made from.
pub const SPEC: &str = r##"# A spec with "quotes" and "#.
name = 'unicycle'
"##;

use ::appell_runtime::Real;
use ::appell_runtime::model;

/// Parameters p, in SI.
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

/// State x: pseudo-velocities, then coordinates. In SI.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
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

impl State<f64> {
    /// The initial state of the spec; the default is zero.
    #[must_use]
    pub fn initial() -> Self {
        Self {
            omega_1: 0.0,
            omega_2: 0.0,
            omega_3: 0.0,
            sigma: 0.0,
            theta: 0.0,
            r: 0.0,
            psi: 0.0,
            phi: 0.0,
            x_G: 0.0,
            y_G: 0.0,
        }
    }
}

/// Inputs u, in SI.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Inputs<T> {
    /// Force on the moving mass, in `N`.
    pub u: T,
}

/// Outputs y, in SI.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Outputs {}

/// Rates ẋ of the [`State`]: pseudo-accelerations, then generalised velocities. In SI.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Rates<T> {
    /// Rate of `omega_1`, in `rad/s^2`.
    pub omega_1_dot: T,
    /// Rate of `omega_2`, in `rad/s^2`.
    pub omega_2_dot: T,
    /// Rate of `omega_3`, in `rad/s^2`.
    pub omega_3_dot: T,
    /// Rate of `sigma`, in `m/s^2`.
    pub sigma_dot: T,
    /// Rate of `theta`, in `rad/s`.
    pub theta_dot: T,
    /// Rate of `r`, in `m/s`.
    pub r_dot: T,
    /// Rate of `psi`, in `rad/s`.
    pub psi_dot: T,
    /// Rate of `phi`, in `rad/s`.
    pub phi_dot: T,
    /// Rate of `x_G`, in `m/s`.
    pub x_G_dot: T,
    /// Rate of `y_G`, in `m/s`.
    pub y_G_dot: T,
}

impl<T> Rates<T> {
    /// ω̇, the first part.
    #[must_use]
    pub fn accelerations(self) -> Accelerations<T> {
        Accelerations {
            omega_1_dot: self.omega_1_dot,
            omega_2_dot: self.omega_2_dot,
            omega_3_dot: self.omega_3_dot,
            sigma_dot: self.sigma_dot,
        }
    }

    /// q̇, the second part.
    #[must_use]
    pub fn coordinate_rates(self) -> CoordinateRates<T> {
        CoordinateRates {
            theta_dot: self.theta_dot,
            r_dot: self.r_dot,
            psi_dot: self.psi_dot,
            phi_dot: self.phi_dot,
            x_G_dot: self.x_G_dot,
            y_G_dot: self.y_G_dot,
        }
    }
}

/// Pseudo-accelerations ω̇, in SI.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Accelerations<T> {
    /// Rate of `omega_1`, in `rad/s^2`.
    pub omega_1_dot: T,
    /// Rate of `omega_2`, in `rad/s^2`.
    pub omega_2_dot: T,
    /// Rate of `omega_3`, in `rad/s^2`.
    pub omega_3_dot: T,
    /// Rate of `sigma`, in `m/s^2`.
    pub sigma_dot: T,
}

/// Generalised velocities q̇, in SI.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct CoordinateRates<T> {
    /// Rate of `theta`, in `rad/s`.
    pub theta_dot: T,
    /// Rate of `r`, in `m/s`.
    pub r_dot: T,
    /// Rate of `psi`, in `rad/s`.
    pub psi_dot: T,
    /// Rate of `phi`, in `rad/s`.
    pub phi_dot: T,
    /// Rate of `x_G`, in `m/s`.
    pub x_G_dot: T,
    /// Rate of `y_G`, in `m/s`.
    pub y_G_dot: T,
}

/// Pseudo-forces, such as Π or b: power per pseudo-velocity, in SI.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct GeneralizedForces<T> {
    /// Along `omega_1`, in `N*m`.
    pub omega_1: T,
    /// Along `omega_2`, in `N*m`.
    pub omega_2: T,
    /// Along `omega_3`, in `N*m`.
    pub omega_3: T,
    /// Along `sigma`, in `N`.
    pub sigma: T,
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
    pub bias: GeneralizedForces<T>,
}

/// Result of [`jacobians`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Jacobians<T> {
    /// ẋ, the rates of the state.
    pub rates: Rates<T>,
    /// Derivatives.
    pub a: Rates<State<T>>,
    /// Derivatives.
    pub b: Rates<Inputs<T>>,
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
/// ```text
/// coordinate_rates₀ = ω₁
/// coordinate_rates₁ = σ
/// coordinate_rates₂ = ω₃/cos θ
/// coordinate_rates₃ = ω₂ − ω₃ tan θ
/// coordinate_rates₄ = R ω₁ cos θ sin ψ + R ω₂ cos ψ
/// coordinate_rates₅ = R ω₂ sin ψ − R ω₁ cos θ cos ψ
/// ```
///
/// From `mechanisms/unicycle.toml`.
/// Operations: 12 (3 +, 8 ×, 1 ÷), sine or cosine of 2 angles.
#[must_use]
#[inline]
pub fn kinematics<T: Real>(
    parameters: &Parameters<T>,
    state: &State<T>,
    _inputs: &Inputs<T>,
) -> CoordinateRates<T> {
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

    CoordinateRates {
        theta_dot: omega_1,
        r_dot: sigma,
        psi_dot: coordinate_rates_2,
        phi_dot: coordinate_rates_3,
        x_G_dot: coordinate_rates_4,
        y_G_dot: coordinate_rates_5,
    }
}

/// Acceleration energy S (Gibbs function) at the actual motion, without the terms ½ ω²(ω·Jω) of the bodies, which no pseudo-acceleration enters.
///
/// ```text
/// S = Σ ½ m a² + ½ α·J α + α·(ω × J ω)
/// ```
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

/// Mass matrix M = ∂²S/∂ω̇², symmetric. Rows and columns follow [`Accelerations`].
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

/// Bias b: ∂S/∂ω̇ at zero pseudo-accelerations.
///
/// ```text
/// b_ω₁ = ¼ m R² ω₃² tan θ − 3/2 m R² ω₂ ω₃ − m₀ R² ω₂ ω₃ − m₀ R ω₂ ω₃ r tan θ + m₀ R ω₃² r
///     + 2 m₀ ω₁ σ r + m₀ ω₃² r² tan θ
/// b_ω₂ = m R² ω₁ ω₃ + m₀ R² ω₁ ω₃ + m₀ R ω₁ ω₃ r tan θ − 2 m₀ R ω₃ σ
/// b_ω₃ = ½ m R² ω₁ ω₂ − ¼ m R² ω₁ ω₃ tan θ − m₀ R ω₁ ω₃ r − m₀ ω₁ ω₃ r² tan θ + 2 m₀ ω₃ σ r
/// b_σ = m₀ R ω₂ ω₃ − m₀ ω₁² r − m₀ ω₃² r
/// ```
///
/// From `mechanisms/unicycle.toml`.
/// Operations: 48 (14 +, 33 ×, 1 ÷), sine or cosine of 1 angle.
#[must_use]
#[inline]
pub fn bias<T: Real>(
    parameters: &Parameters<T>,
    state: &State<T>,
    _inputs: &Inputs<T>,
) -> GeneralizedForces<T> {
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

    GeneralizedForces {
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
        bias: GeneralizedForces {
            omega_1: bias_0,
            omega_2: bias_1,
            omega_3: bias_2,
            sigma: bias_3,
        },
    }
}

/// Pseudo-forces Π (generalised forces): virtual power of the loads per pseudo-velocity.
///
/// ```text
/// Π_ω₁ = m R g sin θ + m₀ R g sin θ − m₀ g r cos θ
/// Π_ω₂ = 0
/// Π_ω₃ = 0
/// Π_σ = u − m₀ g sin θ
/// ```
///
/// From `mechanisms/unicycle.toml`.
/// Operations: 10 (3 +, 7 ×), sine or cosine of 1 angle.
#[must_use]
#[inline]
pub fn generalized_forces<T: Real>(
    parameters: &Parameters<T>,
    state: &State<T>,
    inputs: &Inputs<T>,
) -> GeneralizedForces<T> {
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

    GeneralizedForces {
        omega_1: generalized_forces_0,
        omega_2: zero,
        omega_3: zero,
        sigma: generalized_forces_3,
    }
}

/// Rates ẋ of the state by Appell's equations M ω̇ + b = Π and kinematics.
///
/// ```text
/// θ̇ = ω₁
/// ṙ = σ
/// ψ̇ = ω₃/cos θ
/// φ̇ = ω₂ − ω₃ tan θ
/// ẋ_G = R ω₁ cos θ sin ψ + R ω₂ cos ψ
/// ẏ_G = R ω₂ sin ψ − R ω₁ cos θ cos ψ
/// ```
///
/// From `mechanisms/unicycle.toml`.
/// Operations: 99 (30 +, 65 ×, 4 ÷), sine or cosine of 2 angles.
#[must_use]
#[inline]
pub fn rates<T: Real>(
    parameters: &Parameters<T>,
    state: &State<T>,
    inputs: &Inputs<T>,
) -> Rates<T> {
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

    Rates {
        omega_1_dot,
        omega_2_dot,
        omega_3_dot,
        sigma_dot,
        theta_dot: omega_1,
        r_dot: sigma,
        psi_dot,
        phi_dot,
        x_G_dot,
        y_G_dot,
    }
}

/// Rates ẋ and their Jacobians with respect to state and inputs.
///
/// ```text
/// M ∂ω̇/∂x = ∂(Π − b)/∂x − ∂M/∂x ω̇
/// ```
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
    let f_2_per_R_omega_3 = m0 * (two_sigma - R_omega_1)
        - m_R_plus_m0_tan_theta_r * omega_1;
    let f_2 = R_omega_3 * f_2_per_R_omega_3;
    let D_2 = M_22 * M_33 - m0_R_r * m0_R_r;
    let inv_D_2 = one / D_2;
    let omega_2_dot = inv_D_2 * (m0_R_r * f_3 + M_33 * f_2);
    let omega_3_dot = inv_D_2 * (m0_R_r * f_2 + M_22 * f_3);
    let sigma_dot = inv_m0 * f_4 + R * omega_1_dot;

    // Row `omega_1_dot` of A.
    let m0_sigma_r_minus_m0_R_omega_1_r = m0_r * sigma - m0_R_omega_1_r;
    let d_omega_1_dot_d_omega_1_part_1 = -two * omega_1_dot_part_1;
    let d_omega_1_dot_d_omega_1 = m0_sigma_r_minus_m0_R_omega_1_r
        * d_omega_1_dot_d_omega_1_part_1;
    let d_omega_1_dot_d_omega_2_part_1 = three_halves_m_R + m0_tan_theta_r;
    let d_omega_1_dot_d_omega_2_part_2 = R_omega_3 * d_omega_1_dot_d_omega_2_part_1;
    let d_omega_1_dot_d_omega_2 = omega_1_dot_part_1 * d_omega_1_dot_d_omega_2_part_2;
    let tan_theta_omega_3_r = tan_theta_omega_3 * r;
    let half_m_R_tan_theta_omega_3 = half * m * R_tan_theta_omega_3;
    let d_omega_1_dot_d_omega_3_part_1 = d_omega_1_dot_d_omega_2_part_1 * omega_2;
    let d_omega_1_dot_d_omega_3_part_2 = half_m_R_tan_theta_omega_3
        - d_omega_1_dot_d_omega_3_part_1;
    let d_omega_1_dot_d_omega_3_part_3 = two_m0_r * tan_theta_omega_3_r
        + R * d_omega_1_dot_d_omega_3_part_2;
    let d_omega_1_dot_d_omega_3 = -omega_1_dot_part_1 * d_omega_1_dot_d_omega_3_part_3;
    let m0_omega_1_r = m0_r * omega_1;
    let d_omega_1_dot_d_sigma = d_omega_1_dot_d_omega_1_part_1 * m0_omega_1_r;
    let inv_cos_theta_squared = inv_cos_theta * inv_cos_theta;
    let d_omega_1_dot_d_theta_part_1 = R_omega_3 * inv_cos_theta_squared;
    let d_omega_1_dot_d_theta_part_2 = omega_3_squared_r - R_omega_2_omega_3;
    let d_omega_1_dot_d_theta_part_3 = inv_cos_theta_squared
        * d_omega_1_dot_d_theta_part_2;
    let d_omega_1_dot_d_theta_part_4 = g_sin_theta - d_omega_1_dot_d_theta_part_3;
    let d_omega_1_dot_d_theta_part_5 = m_R * g_cos_theta
        + m0_r * d_omega_1_dot_d_theta_part_4
        - quarter_m_R_omega_3 * d_omega_1_dot_d_theta_part_1;
    let d_omega_1_dot_d_theta = omega_1_dot_part_1 * d_omega_1_dot_d_theta_part_5;
    let d_omega_1_dot_d_r_part_1 = omega_1 * omega_1 + omega_3 * omega_3;
    let d_omega_1_dot_d_r_part_2 = f_1_part_1 + two * tan_theta_omega_3_squared_r;
    let d_omega_1_dot_d_r_part_3 = m0_R * d_omega_1_dot_d_r_part_1;
    let d_omega_1_dot_d_r_part_4 = m0 * d_omega_1_dot_d_r_part_2;
    let d_omega_1_dot_d_r_part_5 = d_omega_1_dot_d_r_part_3 - d_omega_1_dot_d_r_part_4;
    let d_omega_1_dot_d_r = omega_1_dot_part_1
        * (d_omega_1_dot_d_r_part_5 - omega_1_dot * two_m0_r);

    // Row `omega_2_dot` of A.
    let d_f_2_d_omega_1 = -R_omega_3 * (m0_R + m_R_plus_m0_tan_theta_r);
    let d_f_3_d_omega_1 = quarter_m_R * R_tan_theta_omega_3 + minus_half_m_R * R_omega_2
        + m0_r * (R_omega_3 + tan_theta_omega_3_r);
    let M_33_d_f_2_d_omega_1 = M_33 * d_f_2_d_omega_1;
    let m0_R_d_f_3_d_omega_1_r = m0_R_r * d_f_3_d_omega_1;
    let d_omega_2_dot_d_omega_1 = inv_D_2
        * (M_33_d_f_2_d_omega_1 + m0_R_d_f_3_d_omega_1_r);
    let d_omega_2_dot_d_omega_2_part_1 = minus_half_m_R_squared_omega_1 * inv_D_2;
    let d_omega_2_dot_d_omega_2 = m0_R_r * d_omega_2_dot_d_omega_2_part_1;
    let d_f_2_d_omega_3 = R * f_2_per_R_omega_3;
    let M_33_d_f_2_d_omega_3 = M_33 * d_f_2_d_omega_3;
    let m0_R_d_f_3_d_omega_3_r = m0_R_r * d_f_3_d_omega_3;
    let d_omega_2_dot_d_omega_3 = inv_D_2
        * (M_33_d_f_2_d_omega_3 + m0_R_d_f_3_d_omega_3_r);
    let m0_R_omega_3 = m0 * R_omega_3;
    let two_over_D_2 = two * inv_D_2;
    let d_omega_2_dot_d_sigma = two_over_D_2
        * (M_33 * m0_R_omega_3 - m0_r * m0_r * R_omega_3);
    let d_f_3_d_r = m0_R_omega_3 * omega_1 + two * tan_theta_omega_3 * m0_omega_1_r
        - m0 * two_sigma * omega_3;
    let d_omega_2_dot_d_r_part_1 = R_tan_theta_omega_3 * M_33_omega_1 - two * f_2 * r;
    let R_f_3_plus_d_f_3_d_r_r = R * (f_3 + d_f_3_d_r * r);
    let d_omega_2_dot_d_r_part_2 = d_omega_2_dot_d_r_part_1 - R_f_3_plus_d_f_3_d_r_r;
    let d_D_2_d_r = M_22 * two_m0_r - two * m0_R * m0_R_r;
    let d_omega_2_dot_d_r_part_3 = m0 * d_omega_2_dot_d_r_part_2;
    let d_omega_2_dot_d_r = -inv_D_2
        * (d_omega_2_dot_d_r_part_3 + omega_2_dot * d_D_2_d_r);

    // Row `omega_3_dot` of A.
    let M_22_d_f_3_d_omega_1 = M_22 * d_f_3_d_omega_1;
    let m0_R_d_f_2_d_omega_1_r = m0_R_r * d_f_2_d_omega_1;
    let d_omega_3_dot_d_omega_1 = inv_D_2
        * (M_22_d_f_3_d_omega_1 + m0_R_d_f_2_d_omega_1_r);
    let d_omega_3_dot_d_omega_2 = M_22 * d_omega_2_dot_d_omega_2_part_1;
    let M_22_d_f_3_d_omega_3 = M_22 * d_f_3_d_omega_3;
    let m0_R_d_f_2_d_omega_3_r = m0_R_r * d_f_2_d_omega_3;
    let d_omega_3_dot_d_omega_3 = inv_D_2
        * (M_22_d_f_3_d_omega_3 + m0_R_d_f_2_d_omega_3_r);
    let d_omega_3_dot_d_sigma = two_over_D_2
        * (m0_R_r * m0_R_omega_3 - M_22 * m0_r * omega_3);
    let m0_omega_1_omega_3_r_squared = omega_3_r * m0_omega_1_r;
    let d_omega_3_dot_d_theta_part_1 = quarter_m_R * d_omega_1_dot_d_theta_part_1;
    let d_omega_3_dot_d_theta_part_2 = m0_omega_1_omega_3_r_squared
        * inv_cos_theta_squared;
    let d_omega_3_dot_d_theta_part_3 = d_omega_3_dot_d_theta_part_1 * omega_1;
    let d_omega_3_dot_d_theta_part_4 = d_omega_3_dot_d_theta_part_2
        + d_omega_3_dot_d_theta_part_3;
    let m0_squared_R_omega_1_r_squared = m0_R_r * m0_omega_1_r;
    let d_omega_3_dot_d_theta_part_5 = M_22 * d_omega_3_dot_d_theta_part_4;
    let d_omega_3_dot_d_theta_part_6 = m0_squared_R_omega_1_r_squared
        * d_omega_1_dot_d_theta_part_1;
    let d_omega_3_dot_d_theta = inv_D_2
        * (d_omega_3_dot_d_theta_part_5 - d_omega_3_dot_d_theta_part_6);
    let M_22_d_f_3_d_r_plus_m0_R_f_2 = M_22 * d_f_3_d_r + m0_R * f_2;
    let d_omega_3_dot_d_r_part_1 = m0 * R_tan_theta_omega_3 * m0_R_omega_1_r;
    let d_omega_3_dot_d_r_part_2 = M_22_d_f_3_d_r_plus_m0_R_f_2
        - d_omega_3_dot_d_r_part_1;
    let d_omega_3_dot_d_r = inv_D_2
        * (d_omega_3_dot_d_r_part_2 - omega_3_dot * d_D_2_d_r);

    // Row `sigma_dot` of A.
    let d_omega_1_dot_d_u = R * omega_1_dot_part_1;
    let d_sigma_dot_d_omega_1_part_1 = m0_sigma_r_minus_m0_R_omega_1_r
        * d_omega_1_dot_d_u;
    let d_sigma_dot_d_omega_1 = two * (omega_1_r - d_sigma_dot_d_omega_1_part_1);
    let d_sigma_dot_d_omega_2 = d_omega_1_dot_d_omega_2_part_2 * d_omega_1_dot_d_u
        - R_omega_3;
    let d_sigma_dot_d_omega_3 = inv_m0 * (two_m0_r * omega_3 - m0_R * omega_2)
        - d_omega_1_dot_d_omega_3_part_3 * d_omega_1_dot_d_u;
    let d_sigma_dot_d_sigma = m0_R_omega_1_r * d_omega_1_dot_d_omega_1_part_1;
    let d_sigma_dot_d_theta = d_omega_1_dot_d_theta_part_5 * d_omega_1_dot_d_u
        - g_cos_theta;
    let d_sigma_dot_d_r = d_omega_1_dot_d_r_part_1 + R * d_omega_1_dot_d_r;

    // Row `psi_dot` of A.
    let d_psi_dot_d_theta = inv_cos_theta * tan_theta_omega_3;

    // Row `phi_dot` of A.
    let d_phi_dot_d_theta = -inv_cos_theta_squared * omega_3;

    // Row `x_G_dot` of A.
    let R_cos_theta = R * cos_theta;
    let d_x_G_dot_d_omega_1 = sin_psi * R_cos_theta;
    let d_x_G_dot_d_omega_2 = R * cos_psi;
    let R_sin_theta_omega_1 = sin_theta * R_omega_1;
    let d_x_G_dot_d_theta = -sin_psi * R_sin_theta_omega_1;

    // Row `y_G_dot` of A.
    let d_y_G_dot_d_omega_1 = -cos_psi * R_cos_theta;
    let d_y_G_dot_d_omega_2 = R * sin_psi;
    let d_y_G_dot_d_theta = cos_psi * R_sin_theta_omega_1;

    // Row `sigma_dot` of B.
    let d_sigma_dot_d_u = inv_m0 + R * d_omega_1_dot_d_u;

    Jacobians {
        rates: Rates {
            omega_1_dot,
            omega_2_dot,
            omega_3_dot,
            sigma_dot,
            theta_dot: omega_1,
            r_dot: sigma,
            psi_dot,
            phi_dot,
            x_G_dot,
            y_G_dot,
        },
        a: Rates {
            omega_1_dot: State {
                omega_1: d_omega_1_dot_d_omega_1,
                omega_2: d_omega_1_dot_d_omega_2,
                omega_3: d_omega_1_dot_d_omega_3,
                sigma: d_omega_1_dot_d_sigma,
                theta: d_omega_1_dot_d_theta,
                r: d_omega_1_dot_d_r,
                ..State::splat(zero)
            },
            omega_2_dot: State {
                omega_1: d_omega_2_dot_d_omega_1,
                omega_2: d_omega_2_dot_d_omega_2,
                omega_3: d_omega_2_dot_d_omega_3,
                sigma: d_omega_2_dot_d_sigma,
                r: d_omega_2_dot_d_r,
                ..State::splat(zero)
            },
            omega_3_dot: State {
                omega_1: d_omega_3_dot_d_omega_1,
                omega_2: d_omega_3_dot_d_omega_2,
                omega_3: d_omega_3_dot_d_omega_3,
                sigma: d_omega_3_dot_d_sigma,
                theta: d_omega_3_dot_d_theta,
                r: d_omega_3_dot_d_r,
                ..State::splat(zero)
            },
            sigma_dot: State {
                omega_1: d_sigma_dot_d_omega_1,
                omega_2: d_sigma_dot_d_omega_2,
                omega_3: d_sigma_dot_d_omega_3,
                sigma: d_sigma_dot_d_sigma,
                theta: d_sigma_dot_d_theta,
                r: d_sigma_dot_d_r,
                ..State::splat(zero)
            },
            theta_dot: State {
                omega_1: one,
                ..State::splat(zero)
            },
            r_dot: State {
                sigma: one,
                ..State::splat(zero)
            },
            psi_dot: State {
                omega_3: inv_cos_theta,
                theta: d_psi_dot_d_theta,
                ..State::splat(zero)
            },
            phi_dot: State {
                omega_2: one,
                omega_3: -tan_theta,
                theta: d_phi_dot_d_theta,
                ..State::splat(zero)
            },
            x_G_dot: State {
                omega_1: d_x_G_dot_d_omega_1,
                omega_2: d_x_G_dot_d_omega_2,
                theta: d_x_G_dot_d_theta,
                psi: -y_G_dot,
                ..State::splat(zero)
            },
            y_G_dot: State {
                omega_1: d_y_G_dot_d_omega_1,
                omega_2: d_y_G_dot_d_omega_2,
                theta: d_y_G_dot_d_theta,
                psi: x_G_dot,
                ..State::splat(zero)
            },
        },
        b: Rates {
            omega_1_dot: Inputs { u: d_omega_1_dot_d_u },
            omega_2_dot: Inputs { u: zero },
            omega_3_dot: Inputs { u: zero },
            sigma_dot: Inputs { u: d_sigma_dot_d_u },
            theta_dot: Inputs { u: zero },
            r_dot: Inputs { u: zero },
            psi_dot: Inputs { u: zero },
            phi_dot: Inputs { u: zero },
            x_G_dot: Inputs { u: zero },
            y_G_dot: Inputs { u: zero },
        },
    }
}

/// P = ∂ẋ/∂p.
///
/// ```text
/// M ∂ω̇/∂p = ∂(Π − b)/∂p − ∂M/∂p ω̇
/// ```
///
/// From `mechanisms/unicycle.toml`.
/// Operations: 252 (86 +, 162 ×, 4 ÷), sine or cosine of 2 angles.
#[must_use]
#[inline]
pub fn parameter_jacobian<T: Real>(
    parameters: &Parameters<T>,
    state: &State<T>,
    inputs: &Inputs<T>,
) -> Rates<Parameters<T>> {
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

    // Column `m` of P.
    let m0_r = m0 * r;
    let m0_r_squared = m0_r * r;
    let d_omega_1_dot_d_m_part_1 = one / (five_quarters * m_R_squared + m0_r_squared);
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
    let omega_1_dot = d_omega_1_dot_d_m_part_1 * (f_1 + R * f_4);
    let d_omega_1_dot_d_m_part_2 = d_omega_1_dot_d_m_part_1 * omega_1_dot;
    let five_quarters_R_squared = five_quarters * R_squared;
    let d_omega_1_dot_d_m = d_omega_1_dot_d_m_part_1 * d_f_1_d_m
        - five_quarters_R_squared * d_omega_1_dot_d_m_part_2;
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
    let d_omega_2_dot_d_m_part_1 = inv_D_2_squared * (m0_R_r * f_3 + M_33 * f_2);
    let d_omega_2_dot_d_m_part_2 = R_squared
        * (tan_theta_omega_1_omega_3 - two * omega_1_omega_2);
    let R_squared_omega_1_omega_3 = R_squared * omega_1_omega_3;
    let d_omega_2_dot_d_m_part_3 = R_squared * f_2 + m0_R_r * d_omega_2_dot_d_m_part_2;
    let d_omega_2_dot_d_m_part_4 = four * M_33 * R_squared_omega_1_omega_3;
    let quarter_over_D_2 = quarter * inv_D_2;
    let d_omega_2_dot_d_m_part_5 = d_omega_2_dot_d_m_part_3 - d_omega_2_dot_d_m_part_4;
    let d_omega_2_dot_d_m = quarter_over_D_2 * d_omega_2_dot_d_m_part_5
        - d_D_2_d_m * d_omega_2_dot_d_m_part_1;
    let d_omega_3_dot_d_m_part_1 = inv_D_2_squared * (m0_R_r * f_2 + M_22 * f_3);
    let three_halves_R_squared_f_3 = three_halves_R_squared * f_3;
    let d_omega_3_dot_d_m_part_2 = quarter * M_22 * d_omega_2_dot_d_m_part_2;
    let d_omega_3_dot_d_m_part_3 = three_halves_R_squared_f_3 + d_omega_3_dot_d_m_part_2;
    let m0_R_cubed_omega_1_omega_3_r = m0_R_r * R_squared_omega_1_omega_3;
    let d_omega_3_dot_d_m_part_4 = d_omega_3_dot_d_m_part_3
        - m0_R_cubed_omega_1_omega_3_r;
    let d_omega_3_dot_d_m = inv_D_2 * d_omega_3_dot_d_m_part_4
        - d_D_2_d_m * d_omega_3_dot_d_m_part_1;
    let d_sigma_dot_d_m = R * d_omega_1_dot_d_m;

    // Column `m0` of P.
    let d_f_4_d_m0 = r * (omega_3_squared + omega_1_squared) - g_sin_theta
        - R * omega_2_omega_3;
    let d_f_1_d_m0_plus_R_d_f_4_d_m0 = d_f_1_d_m0 + R * d_f_4_d_m0;
    let d_omega_1_dot_d_m0 = d_omega_1_dot_d_m_part_1 * d_f_1_d_m0_plus_R_d_f_4_d_m0
        - r_squared * d_omega_1_dot_d_m_part_2;
    let d_f_2_d_m0 = R * two_omega_3_sigma - R_squared_omega_1_omega_3
        - R_r * tan_theta_omega_1_omega_3;
    let d_f_3_d_m0 = r_squared * tan_theta_omega_1_omega_3 + R_r * omega_1_omega_3
        - two_omega_3_sigma * r;
    let d_omega_2_dot_d_m0_part_1 = M_33 * d_f_2_d_m0 + r_squared * f_2;
    let d_omega_2_dot_d_m0_part_2 = d_omega_2_dot_d_m0_part_1 + m0_R_r * d_f_3_d_m0;
    let d_D_2_d_m0 = M_22 * r_squared + R_squared * (M_33 - two * m0_r_squared);
    let d_omega_2_dot_d_m0 = inv_D_2 * (d_omega_2_dot_d_m0_part_2 + R_r * f_3)
        - d_omega_2_dot_d_m_part_1 * d_D_2_d_m0;
    let d_omega_3_dot_d_m0_part_1 = R_squared * f_3 + M_22 * d_f_3_d_m0;
    let d_omega_3_dot_d_m0_part_2 = d_omega_3_dot_d_m0_part_1 + m0_R_r * d_f_2_d_m0;
    let d_omega_3_dot_d_m0 = inv_D_2 * (d_omega_3_dot_d_m0_part_2 + R_r * f_2)
        - d_omega_3_dot_d_m_part_1 * d_D_2_d_m0;
    let d_sigma_dot_d_m0 = R * d_omega_1_dot_d_m0 - inv_m0 * (inv_m0 * f_4 - d_f_4_d_m0);

    // Column `R` of P.
    let half_m_R_tan_theta_omega_3 = half_m_R * tan_theta * omega_3;
    let d_omega_1_dot_d_R_part_1 = omega_2 * (d_M_22_d_R + m0_r * tan_theta);
    let d_omega_1_dot_d_R_part_2 = half_m_R_tan_theta_omega_3 - d_omega_1_dot_d_R_part_1;
    let d_omega_1_dot_d_R_part_3 = omega_3 * d_omega_1_dot_d_R_part_2;
    let d_omega_1_dot_d_R_part_4 = m0_R_omega_2_omega_3 + d_omega_1_dot_d_R_part_3;
    let d_omega_1_dot_d_R_part_5 = d_omega_1_dot_d_R_part_4 - f_4_part_1 - f_4;
    let d_omega_1_dot_d_R_part_6 = d_omega_1_dot_d_R_part_5 - m * g_sin_theta;
    let d_omega_1_dot_d_R = -five_halves * m_R * d_omega_1_dot_d_m_part_2
        - d_omega_1_dot_d_m_part_1 * d_omega_1_dot_d_R_part_6;
    let two_m0_R_r = two * m0_R_r;
    let d_D_2_d_R = d_M_22_d_R * M_33 + half_m_R * M_22 - m0_r * two_m0_R_r;
    let d_f_3_d_R = m0_r * omega_1_omega_3 + half_m_R * tan_theta_omega_1_omega_3
        - m_R * omega_1_omega_2;
    let d_omega_2_dot_d_R_part_1 = omega_1_omega_3_m_R_plus_m0_R
        + half * m0_tan_theta_omega_1_omega_3_r - m0 * omega_3 * sigma;
    let d_omega_2_dot_d_R_part_2 = half_m_R * f_2 + m0_r * f_3 + m0_R_r * d_f_3_d_R;
    let d_omega_2_dot_d_R_part_3 = two * M_33 * d_omega_2_dot_d_R_part_1;
    let d_omega_2_dot_d_R_part_4 = d_omega_2_dot_d_R_part_2 - d_omega_2_dot_d_R_part_3;
    let d_omega_2_dot_d_R = inv_D_2 * d_omega_2_dot_d_R_part_4
        - d_omega_2_dot_d_m_part_1 * d_D_2_d_R;
    let d_omega_3_dot_d_R_part_1 = M_22 * d_f_3_d_R + d_M_22_d_R * f_3 + m0_r * f_2;
    let d_omega_3_dot_d_R_part_2 = two_m0_R_r * d_omega_2_dot_d_R_part_1;
    let d_omega_3_dot_d_R_part_3 = d_omega_3_dot_d_R_part_1 - d_omega_3_dot_d_R_part_2;
    let d_omega_3_dot_d_R = inv_D_2 * d_omega_3_dot_d_R_part_3
        - d_omega_3_dot_d_m_part_1 * d_D_2_d_R;
    let d_sigma_dot_d_R = omega_1_dot + R * d_omega_1_dot_d_R - omega_2_omega_3;
    let cos_theta_omega_1 = cos_theta * omega_1;
    let d_x_G_dot_d_R = sin_psi * cos_theta_omega_1 + cos_psi * omega_2;
    let d_y_G_dot_d_R = sin_psi * omega_2 - cos_psi * cos_theta_omega_1;

    // Column `g` of P.
    let d_omega_1_dot_d_g = d_omega_1_dot_d_m_part_1
        * (sin_theta * m_R - cos_theta * m0_r);
    let d_sigma_dot_d_g = R * d_omega_1_dot_d_g - sin_theta;

    Rates {
        omega_1_dot: Parameters {
            m: d_omega_1_dot_d_m,
            m0: d_omega_1_dot_d_m0,
            R: d_omega_1_dot_d_R,
            g: d_omega_1_dot_d_g,
        },
        omega_2_dot: Parameters {
            m: d_omega_2_dot_d_m,
            m0: d_omega_2_dot_d_m0,
            R: d_omega_2_dot_d_R,
            g: zero,
        },
        omega_3_dot: Parameters {
            m: d_omega_3_dot_d_m,
            m0: d_omega_3_dot_d_m0,
            R: d_omega_3_dot_d_R,
            g: zero,
        },
        sigma_dot: Parameters {
            m: d_sigma_dot_d_m,
            m0: d_sigma_dot_d_m0,
            R: d_sigma_dot_d_R,
            g: d_sigma_dot_d_g,
        },
        theta_dot: Parameters::splat(zero),
        r_dot: Parameters::splat(zero),
        psi_dot: Parameters::splat(zero),
        phi_dot: Parameters::splat(zero),
        x_G_dot: Parameters {
            R: d_x_G_dot_d_R,
            ..Parameters::splat(zero)
        },
        y_G_dot: Parameters {
            R: d_y_G_dot_d_R,
            ..Parameters::splat(zero)
        },
    }
}

/// Energies and power.
///
/// ```text
/// T = ¾ m R² ω₂²
/// V = m R g cos θ
/// P = σ u
/// ```
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

    /// The first numbers of a slice that holds at least as many.
    fn first<const LEN: usize>(numbers: &[f64]) -> [f64; LEN] {
        core::array::from_fn(|i| numbers[i])
    }

    fn parameters(at: &At<'_>) -> Parameters<f64> {
        first(at.p).into()
    }

    fn state(at: &At<'_>) -> State<f64> {
        first(at.x).into()
    }

    fn inputs(at: &At<'_>) -> Inputs<f64> {
        first(at.u).into()
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
                &self::rates(&parameters(&at), &state(&at), &inputs(&at)).to_array(),
            );
        }

        fn jacobians(
            &self,
            at: At<'_>,
            rates: &mut [f64],
            a: &mut [f64],
            b: &mut [f64],
        ) {
            let all = self::jacobians(&parameters(&at), &state(&at), &inputs(&at));
            write(rates, &all.rates.to_array());
            write(a, all.a.map(State::to_array).to_array().as_flattened());
            write(b, all.b.map(Inputs::to_array).to_array().as_flattened());
        }

        fn parameter_jacobian(&self, at: At<'_>, p: &mut [f64]) {
            write(
                p,
                self::parameter_jacobian(&parameters(&at), &state(&at), &inputs(&at))
                    .map(Parameters::to_array)
                    .to_array()
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
            let all = self::mass_matrix_and_bias(
                &parameters(&at),
                &state(&at),
                &inputs(&at),
            );
            write(mass, all.mass_matrix.as_flattened());
            write(bias, &all.bias.to_array());
            write(
                forces,
                &self::generalized_forces(&parameters(&at), &state(&at), &inputs(&at))
                    .to_array(),
            );
        }

        fn energies(&self, at: At<'_>) -> model::Energies {
            let all = self::energies(&parameters(&at), &state(&at), &inputs(&at));
            model::Energies {
                kinetic: all.kinetic,
                potential: all.potential,
                power: all.power,
                acceleration: self::acceleration_energy(
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

    impl model::Named for Unicycle {
        type State = State<f64>;
        type Inputs = Inputs<f64>;
        type Outputs = Outputs;

        fn named(&self, at: At<'_>) -> model::Row<Self> {
            model::Row {
                t: at.t,
                state: state(&at),
                inputs: inputs(&at),
                outputs: Outputs {},
            }
        }
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

::appell_runtime::vector!(Parameters { m, m0, R, g });

::appell_runtime::vector!(
    State { omega_1, omega_2, omega_3, sigma, theta, r, psi, phi, x_G, y_G }, Rates
);

::appell_runtime::vector!(Inputs { u });

::appell_runtime::vector!(Outputs {});

::appell_runtime::vector!(
    Rates { omega_1_dot, omega_2_dot, omega_3_dot, sigma_dot, theta_dot, r_dot, psi_dot,
    phi_dot, x_G_dot, y_G_dot }
);

::appell_runtime::vector!(
    Accelerations { omega_1_dot, omega_2_dot, omega_3_dot, sigma_dot }
);

::appell_runtime::vector!(
    CoordinateRates { theta_dot, r_dot, psi_dot, phi_dot, x_G_dot, y_G_dot }
);

::appell_runtime::vector!(GeneralizedForces { omega_1, omega_2, omega_3, sigma });
