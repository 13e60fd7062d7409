/// The spec this module is made from.
pub const SPEC: &str = r##"# A spec with "quotes" and "#.
name = 'unicycle'
"##;

use ::appell_runtime::Real;
use ::appell_runtime::model;

/// Parameters p, in SI.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Parameters<T> {
    /// Mass of the rod, in `kg`.
    pub m: T,
    /// Distance from the pivot to the centre of mass, in `m`.
    pub l: T,
    /// Inertia about the centre of mass, in `kg*m^2`.
    pub I: T,
    /// Gravitational acceleration, in `m/s^2`.
    pub g: T,
}

impl Default for Parameters<f64> {
    /// The values of the spec.
    fn default() -> Self {
        Self {
            m: 1.0,
            l: 0.5,
            I: 0.02,
            g: 9.81,
        }
    }
}

/// State x: pseudo-velocities, then coordinates. In SI.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct State<T> {
    /// Angular velocity, in `rad/s`.
    pub omega: T,
    /// Angle from the hanging position, positive towards +x, in `rad`.
    pub theta: T,
}

impl State<f64> {
    /// The initial state of the spec; the default is zero.
    #[must_use]
    pub fn initial() -> Self {
        Self { omega: 0.0, theta: 0.0 }
    }
}

/// Inputs u, in SI.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Inputs<T> {
    /// Torque at the pivot, positive in the sense of theta, in `N*m`.
    pub tau: T,
}

/// Outputs y, in SI.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Outputs<T> {
    /// Centre of mass along the ground axis x, in `m`.
    pub x_G: T,
    /// Height of the centre of mass above the pivot, in `m`.
    pub z_G: T,
    /// Energy above the hanging position, in `J`.
    pub energy: T,
}

/// Rates ẋ of the [`State`]: pseudo-accelerations, then generalised velocities. In SI.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Rates<T> {
    /// Rate of `omega`, in `rad/s^2`.
    pub omega_dot: T,
    /// Rate of `theta`, in `rad/s`.
    pub theta_dot: T,
}

impl<T> Rates<T> {
    /// ω̇, the first part.
    #[must_use]
    pub fn accelerations(self) -> Accelerations<T> {
        Accelerations {
            omega_dot: self.omega_dot,
        }
    }

    /// q̇, the second part.
    #[must_use]
    pub fn coordinate_rates(self) -> CoordinateRates<T> {
        CoordinateRates {
            theta_dot: self.theta_dot,
        }
    }
}

/// Pseudo-accelerations ω̇, in SI.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Accelerations<T> {
    /// Rate of `omega`, in `rad/s^2`.
    pub omega_dot: T,
}

/// Generalised velocities q̇, in SI.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct CoordinateRates<T> {
    /// Rate of `theta`, in `rad/s`.
    pub theta_dot: T,
}

/// Pseudo-forces, such as Π or b: power per pseudo-velocity, in SI.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct GeneralizedForces<T> {
    /// Along `omega`, in `N*m`.
    pub omega: T,
}

/// What the constraint rows are off by: zero up to rounding. In SI.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct ConstraintResidual {}

/// Reactions in the ground: forces on points along x, y, z in N; a multiplier of a constraint stands in the x component.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct ConstraintForces {}

/// Result of [`acceleration_energy`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AccelerationEnergy<T> {
    /// Sum over the bodies, in W/s.
    pub total: T,
    /// Of `rod`, in W/s.
    pub rod: T,
}

/// Result of [`mass_matrix_and_bias`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MassMatrixAndBias<T> {
    /// M.
    pub mass_matrix: [[T; 1]; 1],
    /// Bias.
    pub bias: GeneralizedForces<T>,
}

/// Result of [`jacobians`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Jacobians<T> {
    /// ẋ, the rates of the state.
    pub rates: Rates<T>,
    /// A = ∂ẋ/∂x: one row per rate, one column per state.
    pub a: Rates<State<T>>,
    /// B = ∂ẋ/∂u: one row per rate, one column per input.
    pub b: Rates<Inputs<T>>,
}

/// Result of [`energies`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Energies<T> {
    /// Kinetic energy, in J.
    pub kinetic: T,
    /// Potential energy, in J.
    pub potential: T,
    /// Power of the loads without a potential, in W.
    pub power: T,
}

/// Result of [`inverse_dynamics_jacobians`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct InverseDynamicsJacobians<T> {
    /// M ω̇ + b − Π.
    pub demand: GeneralizedForces<T>,
    /// ∂(M ω̇ + b − Π)/∂x, ω̇ held.
    pub by_state: GeneralizedForces<State<T>>,
    /// −∂Π/∂u.
    pub by_inputs: GeneralizedForces<Inputs<T>>,
    /// M.
    pub mass_matrix: [[T; 1]; 1],
}

/// Result of [`adjoint`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Adjoint<T> {
    /// With respect to the state.
    pub x: State<T>,
    /// With respect to the inputs.
    pub u: Inputs<T>,
    /// With respect to the parameters.
    pub p: Parameters<T>,
}

/// Result of [`output_jacobians`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct OutputJacobians<T> {
    /// Outputs.
    pub outputs: Outputs<T>,
    /// C = ∂y/∂x.
    pub c: Outputs<State<T>>,
    /// D = ∂y/∂u.
    pub d: Outputs<Inputs<T>>,
}

/// Result of [`output_adjoint`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct OutputAdjoint<T> {
    /// With respect to the state.
    pub x: State<T>,
    /// With respect to the inputs.
    pub u: Inputs<T>,
    /// With respect to the parameters.
    pub p: Parameters<T>,
}

/// Generalised velocities q̇ of pseudo-velocities and coordinates.
///
/// ```text
/// θ̇ = ω
/// ```
///
/// From `pendulum.toml`.
/// Operations: 0.
#[must_use]
#[inline]
pub fn kinematics<T: Real>(
    _parameters: &Parameters<T>,
    state: &State<T>,
    _inputs: &Inputs<T>,
) -> CoordinateRates<T> {
    let &State { omega, .. } = state;

    CoordinateRates {
        theta_dot: omega,
    }
}

/// Acceleration energy S (Gibbs function) at the actual motion, without the terms ½ ω²(ω·Jω) of the bodies, which no pseudo-acceleration enters.
///
/// ```text
/// S = Σ ½ m a² + ½ α·J α + α·(ω × J ω)
/// ```
///
/// - `a0_G`: acceleration of `G` where ω̇ = 0, along `rod`.
/// - `rhs`: `Π − b` after elimination, times the common denominator in `pivot`.
/// - `pivot`: what divides `rhs`: `ω̇ = rhs/pivot`, plus terms that need no division.
///
/// From `pendulum.toml`.
/// Operations: 20 (4 +, 15 ×, 1 ÷), sine or cosine of 1 angle.
#[must_use]
#[inline]
pub fn acceleration_energy<T: Real>(
    parameters: &Parameters<T>,
    state: &State<T>,
    inputs: &Inputs<T>,
) -> AccelerationEnergy<T> {
    let &Parameters { m, l, I, g } = parameters;
    let &State { omega, theta } = state;
    let &Inputs { tau } = inputs;
    let half = T::constant(0.5);
    let one = T::constant(1.0);

    // Combinations of parameters.
    let m_l = m * l;
    let pivot_omega = l * m_l + I;
    let inv_pivot_omega = one / pivot_omega;

    // Unknown `omega_dot`.
    let rhs_omega = tau - g * m_l * theta.sin();
    let omega_dot = inv_pivot_omega * rhs_omega;

    // Motion of `rod` with ω̇ = 0.
    let a0_G_z = l * omega * omega;

    // Acceleration of `G`, along `rod`.
    let a_G_x = l * omega_dot;

    // Body `rod`, pendulum.toml:29.
    let s_moving_rod = half * m * (a0_G_z * a0_G_z + a_G_x * a_G_x);
    let s_turning_rod = half * I * omega_dot * omega_dot;

    let s_rod = s_moving_rod + s_turning_rod;

    AccelerationEnergy {
        total: s_rod,
        rod: s_rod,
    }
}

/// Mass matrix M = ∂²S/∂ω̇², symmetric. Rows and columns follow [`Accelerations`].
///
/// ```text
/// M = [ m l² + I ]
/// ```
///
/// From `pendulum.toml`.
/// Operations: 3 (1 +, 2 ×).
#[must_use]
#[inline]
pub fn mass_matrix<T: Real>(
    parameters: &Parameters<T>,
    _state: &State<T>,
    _inputs: &Inputs<T>,
) -> [[T; 1]; 1] {
    let &Parameters { m, l, I, .. } = parameters;

    // Combinations of parameters.
    let M_omega_omega = m * l * l + I;

    [[M_omega_omega]]
}

/// Bias b: ∂S/∂ω̇ at zero pseudo-accelerations.
///
/// ```text
/// b_ω = 0
/// ```
///
/// From `pendulum.toml`.
/// Operations: 0.
#[must_use]
#[inline]
pub fn bias<T: Real>(
    _parameters: &Parameters<T>,
    _state: &State<T>,
    _inputs: &Inputs<T>,
) -> GeneralizedForces<T> {
    let zero = T::constant(0.0);

    GeneralizedForces { omega: zero }
}

/// Mass matrix M and bias b together: what both need is computed once.
///
/// From `pendulum.toml`.
/// Operations: 3 (1 +, 2 ×).
#[must_use]
#[inline]
pub fn mass_matrix_and_bias<T: Real>(
    parameters: &Parameters<T>,
    _state: &State<T>,
    _inputs: &Inputs<T>,
) -> MassMatrixAndBias<T> {
    let &Parameters { m, l, I, .. } = parameters;
    let zero = T::constant(0.0);

    // Combinations of parameters.
    let M_omega_omega = m * l * l + I;

    MassMatrixAndBias {
        mass_matrix: [[M_omega_omega]],
        bias: GeneralizedForces { omega: zero },
    }
}

/// Pseudo-forces Π (generalised forces): virtual power of the loads per pseudo-velocity.
///
/// ```text
/// Π_ω = τ − m l g sin θ
/// ```
///
/// From `pendulum.toml`.
/// Operations: 4 (1 +, 3 ×), sine or cosine of 1 angle.
#[must_use]
#[inline]
pub fn generalized_forces<T: Real>(
    parameters: &Parameters<T>,
    state: &State<T>,
    inputs: &Inputs<T>,
) -> GeneralizedForces<T> {
    let &Parameters { m, l, g, .. } = parameters;
    let &State { theta, .. } = state;
    let &Inputs { tau } = inputs;

    // Pseudo-forces.
    let force_omega = tau - m * l * g * theta.sin();

    GeneralizedForces {
        omega: force_omega,
    }
}

/// Rates ẋ of the state by Appell's equations M ω̇ + b = Π and kinematics.
///
/// ```text
/// (m l² + I) ω̇ = τ − m l g sin θ
/// θ̇ = ω
/// ```
///
/// - `rhs`: `Π − b` after elimination, times the common denominator in `pivot`.
/// - `pivot`: what divides `rhs`: `ω̇ = rhs/pivot`, plus terms that need no division.
///
/// From `pendulum.toml`.
/// Operations: 8 (2 +, 5 ×, 1 ÷), sine or cosine of 1 angle.
#[must_use]
#[inline]
pub fn rates<T: Real>(
    parameters: &Parameters<T>,
    state: &State<T>,
    inputs: &Inputs<T>,
) -> Rates<T> {
    let &Parameters { m, l, I, g } = parameters;
    let &State { omega, theta } = state;
    let &Inputs { tau } = inputs;
    let one = T::constant(1.0);

    // Combinations of parameters.
    let m_l = m * l;
    let pivot_omega = l * m_l + I;
    let inv_pivot_omega = one / pivot_omega;

    // Unknown `omega_dot`.
    let rhs_omega = tau - g * m_l * theta.sin();
    let omega_dot = inv_pivot_omega * rhs_omega;

    Rates {
        omega_dot,
        theta_dot: omega,
    }
}

/// Rates ẋ and their Jacobians with respect to state and inputs.
///
/// ```text
/// M ∂ω̇/∂x = ∂(Π − b)/∂x − ∂M/∂x ω̇
/// ```
///
/// - `rhs`: `Π − b` after elimination, times the common denominator in `pivot`.
/// - `pivot`: what divides `rhs`: `ω̇ = rhs/pivot`, plus terms that need no division.
///
/// From `pendulum.toml`.
/// Operations: 11 (2 +, 7 ×, 1 ÷, 1 sign), sine or cosine of 1 angle.
#[must_use]
#[inline]
pub fn jacobians<T: Real>(
    parameters: &Parameters<T>,
    state: &State<T>,
    inputs: &Inputs<T>,
) -> Jacobians<T> {
    let &Parameters { m, l, I, g } = parameters;
    let &State { omega, theta } = state;
    let &Inputs { tau } = inputs;
    let zero = T::constant(0.0);
    let one = T::constant(1.0);

    // Sines and cosines.
    let (sin_theta, cos_theta) = theta.sin_cos();

    // Combinations of parameters.
    let m_l = m * l;
    let m_l_g = g * m_l;
    let pivot_omega = l * m_l + I;
    let inv_pivot_omega = one / pivot_omega;

    // Unknown `omega_dot`.
    let rhs_omega = tau - sin_theta * m_l_g;
    let omega_dot = inv_pivot_omega * rhs_omega;

    // Row `omega_dot` of A.
    let d_omega_dot_d_theta = -cos_theta * m_l_g * inv_pivot_omega;

    Jacobians {
        rates: Rates {
            omega_dot,
            theta_dot: omega,
        },
        a: Rates {
            omega_dot: State {
                omega: zero,
                theta: d_omega_dot_d_theta,
            },
            theta_dot: State { omega: one, theta: zero },
        },
        b: Rates {
            omega_dot: Inputs { tau: inv_pivot_omega },
            theta_dot: Inputs { tau: zero },
        },
    }
}

/// P = ∂ẋ/∂p.
///
/// ```text
/// M ∂ω̇/∂p = ∂(Π − b)/∂p − ∂M/∂p ω̇
/// ```
///
/// - `rhs`: `Π − b` after elimination, times the common denominator in `pivot`.
/// - `pivot`: what divides `rhs`: `ω̇ = rhs/pivot`, plus terms that need no division.
///
/// From `pendulum.toml`.
/// Operations: 22 (4 +, 14 ×, 1 ÷, 3 sign), sine or cosine of 1 angle.
#[must_use]
#[inline]
pub fn parameter_jacobian<T: Real>(
    parameters: &Parameters<T>,
    state: &State<T>,
    inputs: &Inputs<T>,
) -> Rates<Parameters<T>> {
    let &Parameters { m, l, I, g } = parameters;
    let &State { theta, .. } = state;
    let &Inputs { tau } = inputs;
    let zero = T::constant(0.0);
    let one = T::constant(1.0);
    let two = T::constant(2.0);

    // Sines and cosines.
    let sin_theta = theta.sin();

    // Combinations of parameters.
    let m_l = m * l;
    let pivot_omega = l * m_l + I;
    let inv_pivot_omega = one / pivot_omega;

    // Unknown `omega_dot`.
    let g_sin_theta = g * sin_theta;
    let rhs_omega = tau - m_l * g_sin_theta;
    let omega_dot = inv_pivot_omega * rhs_omega;

    // Column `m` of P.
    let l_omega_dot = l * omega_dot;
    let d_omega_dot_d_m = -l * inv_pivot_omega * (g_sin_theta + l_omega_dot);

    // Column `l` of P.
    let d_omega_dot_d_l = m * inv_pivot_omega * (-two * l_omega_dot - g_sin_theta);

    // Column `I` of P.
    let d_omega_dot_d_I = -inv_pivot_omega * omega_dot;

    // Column `g` of P.
    let d_omega_dot_d_g = -sin_theta * m_l * inv_pivot_omega;

    Rates {
        omega_dot: Parameters {
            m: d_omega_dot_d_m,
            l: d_omega_dot_d_l,
            I: d_omega_dot_d_I,
            g: d_omega_dot_d_g,
        },
        theta_dot: Parameters::splat(zero),
    }
}

/// Energies and power.
///
/// ```text
/// T = ½ (m l² + I) ω²
/// V = −m l g cos θ
/// P = ω τ
/// ```
///
/// From `pendulum.toml`.
/// Operations: 10 (1 +, 8 ×, 1 sign), sine or cosine of 1 angle.
#[must_use]
#[inline]
pub fn energies<T: Real>(
    parameters: &Parameters<T>,
    state: &State<T>,
    inputs: &Inputs<T>,
) -> Energies<T> {
    let &Parameters { m, l, I, g } = parameters;
    let &State { omega, theta } = state;
    let &Inputs { tau } = inputs;
    let half = T::constant(0.5);

    // Combinations of parameters.
    let m_l = m * l;

    // Body `rod`, pendulum.toml:29.
    let T_rod = half * omega * omega * (l * m_l + I);

    // Potential energy, in J.
    let potential = -g * m_l * theta.cos();

    // Power of the loads without a potential, in W.
    let power = omega * tau;

    Energies {
        kinetic: T_rod,
        potential,
        power,
    }
}

/// Constraint rows at the generalised velocities of the state: zero up to rounding.
///
/// From `pendulum.toml`.
/// Operations: 0.
#[must_use]
#[inline]
pub fn constraint_residual<T: Real>(
    _parameters: &Parameters<T>,
    _state: &State<T>,
    _inputs: &Inputs<T>,
) -> ConstraintResidual {
    ConstraintResidual {}
}

/// Reactions: forces on what is held, in N.
///
/// From `pendulum.toml`.
/// Operations: 0.
#[must_use]
#[inline]
pub fn constraint_forces<T: Real>(
    _parameters: &Parameters<T>,
    _state: &State<T>,
    _inputs: &Inputs<T>,
) -> ConstraintForces {
    ConstraintForces {}
}

/// Outputs of the spec.
///
/// ```text
/// x_G = l sin θ
/// z_G = −l cos θ
/// energy = ½ (m l² + I) ω² + (1 − cos θ) m l g
/// ```
///
/// From `pendulum.toml`.
/// Operations: 13 (3 +, 9 ×, 1 sign), sine or cosine of 1 angle.
#[must_use]
#[inline]
pub fn outputs<T: Real>(
    parameters: &Parameters<T>,
    state: &State<T>,
    _inputs: &Inputs<T>,
) -> Outputs<T> {
    let &Parameters { m, l, I, g } = parameters;
    let &State { omega, theta } = state;
    let half = T::constant(0.5);
    let one = T::constant(1.0);

    // Sines and cosines.
    let (sin_theta, cos_theta) = theta.sin_cos();

    // Combinations of parameters.
    let m_l = m * l;

    // Outputs.
    let x_G = l * sin_theta;
    let z_G = -l * cos_theta;
    let energy = half * omega * omega * (l * m_l + I) - g * m_l * (cos_theta - one);

    Outputs { x_G, z_G, energy }
}

/// Inverse dynamics: the pseudo-forces M ω̇ + b − Π that a motion takes beyond the loads. With inputs of zero they are what drives along the pseudo-velocities have to bring.
///
/// From `pendulum.toml`.
/// Operations: 8 (3 +, 5 ×), sine or cosine of 1 angle.
#[must_use]
#[inline]
pub fn inverse_dynamics<T: Real>(
    parameters: &Parameters<T>,
    state: &State<T>,
    inputs: &Inputs<T>,
    accelerations: &Accelerations<T>,
) -> GeneralizedForces<T> {
    let &Parameters { m, l, I, g } = parameters;
    let &State { theta, .. } = state;
    let &Inputs { tau } = inputs;
    let omega_dot = accelerations.omega_dot;

    // Combinations of parameters.
    let m_l = m * l;

    // M ω̇ + b − Π.
    let demand_omega = omega_dot * (l * m_l + I) + g * m_l * theta.sin() - tau;

    GeneralizedForces {
        omega: demand_omega,
    }
}

/// Inverse dynamics with its Jacobians with respect to state, inputs and pseudo-accelerations; the last is the mass matrix M.
///
/// From `pendulum.toml`.
/// Operations: 9 (3 +, 6 ×), sine or cosine of 1 angle.
#[must_use]
#[inline]
pub fn inverse_dynamics_jacobians<T: Real>(
    parameters: &Parameters<T>,
    state: &State<T>,
    inputs: &Inputs<T>,
    accelerations: &Accelerations<T>,
) -> InverseDynamicsJacobians<T> {
    let &Parameters { m, l, I, g } = parameters;
    let &State { theta, .. } = state;
    let &Inputs { tau } = inputs;
    let omega_dot = accelerations.omega_dot;
    let zero = T::constant(0.0);
    let one = T::constant(1.0);

    // Sines and cosines.
    let (sin_theta, cos_theta) = theta.sin_cos();

    // Combinations of parameters.
    let m_l = m * l;
    let M_omega_omega = l * m_l + I;
    let m_l_g = g * m_l;

    // M ω̇ + b − Π.
    let demand_omega = M_omega_omega * omega_dot + sin_theta * m_l_g - tau;

    // Row `omega` of `by_state`.
    let d_omega_d_theta = cos_theta * m_l_g;

    InverseDynamicsJacobians {
        demand: GeneralizedForces {
            omega: demand_omega,
        },
        by_state: GeneralizedForces {
            omega: State {
                omega: zero,
                theta: d_omega_d_theta,
            },
        },
        by_inputs: GeneralizedForces {
            omega: Inputs { tau: -one },
        },
        mass_matrix: [[M_omega_omega]],
    }
}

/// Gradient of ⟨λ, ẋ⟩ + ⟨Λ, A⟩ + ⟨Γ, B⟩ + ⟨K, M⟩; the weights are λ, Λ, Γ, K, row by row.
///
/// - `adjoint`: a derivative of the weighted sum with respect to an intermediate value.
///
/// From `pendulum.toml`.
/// Operations: 33 (9 +, 22 ×, 1 ÷, 1 sign), sine or cosine of 1 angle.
#[must_use]
#[inline]
pub fn adjoint<T: Real>(
    parameters: &Parameters<T>,
    state: &State<T>,
    inputs: &Inputs<T>,
    weights: &[T; 9],
) -> Adjoint<T> {
    let &Parameters { m, l, I, g } = parameters;
    let &State { theta, .. } = state;
    let &Inputs { tau } = inputs;
    let lambda_omega = weights[0];
    let lambda_theta = weights[1];
    let Lambda_omega_theta = weights[3];
    let Gamma_omega_tau = weights[6];
    let K_omega_omega = weights[8];
    let one = T::constant(1.0);
    let two = T::constant(2.0);

    // Sines and cosines.
    let (sin_theta, cos_theta) = theta.sin_cos();

    // Combinations of parameters.
    let m_l = m * l;
    let m_l_g = g * m_l;
    let pivot_omega = l * m_l + I;
    let inv_pivot_omega = one / pivot_omega;

    let by_tau = inv_pivot_omega * lambda_omega;
    let Lambda_omega_theta_over_pivot_omega = inv_pivot_omega * Lambda_omega_theta;
    let by_theta_part_1 = sin_theta * Lambda_omega_theta_over_pivot_omega;
    let by_theta = m_l_g * (by_theta_part_1 - cos_theta * by_tau);
    let rhs_omega = tau - sin_theta * m_l_g;
    let by_I_part_1 = cos_theta * m_l_g * Lambda_omega_theta - Gamma_omega_tau;
    let adjoint_pivot_omega = inv_pivot_omega * inv_pivot_omega
        * (by_I_part_1 - rhs_omega * lambda_omega);
    let by_I = adjoint_pivot_omega + K_omega_omega;
    let l_by_I = l * by_I;
    let by_m_part_1 = sin_theta * by_tau
        + cos_theta * Lambda_omega_theta_over_pivot_omega;
    let by_m_part_2 = g * by_m_part_1;
    let by_m = l * (l_by_I - by_m_part_2);
    let by_l = m * (two * l_by_I - by_m_part_2);
    let by_g = -m_l * by_m_part_1;

    Adjoint {
        x: State {
            omega: lambda_theta,
            theta: by_theta,
        },
        u: Inputs { tau: by_tau },
        p: Parameters {
            m: by_m,
            l: by_l,
            I: by_I,
            g: by_g,
        },
    }
}

/// Outputs of the spec and their Jacobians with respect to state and inputs.
///
/// From `pendulum.toml`.
/// Operations: 14 (3 +, 10 ×, 1 sign), sine or cosine of 1 angle.
#[must_use]
#[inline]
pub fn output_jacobians<T: Real>(
    parameters: &Parameters<T>,
    state: &State<T>,
    _inputs: &Inputs<T>,
) -> OutputJacobians<T> {
    let &Parameters { m, l, I, g } = parameters;
    let &State { omega, theta } = state;
    let zero = T::constant(0.0);
    let half = T::constant(0.5);
    let one = T::constant(1.0);

    // Sines and cosines.
    let (sin_theta, cos_theta) = theta.sin_cos();

    // Combinations of parameters.
    let m_l = m * l;
    let m_l_g = g * m_l;

    // Outputs.
    let x_G = l * sin_theta;
    let l_cos_theta = l * cos_theta;
    let C_energy_omega = omega * (l * m_l + I);
    let energy = half * C_energy_omega * omega - m_l_g * (cos_theta - one);

    let C_energy_theta = sin_theta * m_l_g;

    OutputJacobians {
        outputs: Outputs {
            x_G,
            z_G: -l_cos_theta,
            energy,
        },
        c: Outputs {
            x_G: State {
                omega: zero,
                theta: l_cos_theta,
            },
            z_G: State { omega: zero, theta: x_G },
            energy: State {
                omega: C_energy_omega,
                theta: C_energy_theta,
            },
        },
        d: Outputs {
            x_G: Inputs { tau: zero },
            z_G: Inputs { tau: zero },
            energy: Inputs { tau: zero },
        },
    }
}

/// Gradient of ⟨μ, y⟩ + ⟨Γ, C⟩ + ⟨Δ, D⟩; the weights are μ, Γ, Δ, row by row.
///
/// - `adjoint`: a derivative of the weighted sum with respect to an intermediate value.
///
/// From `pendulum.toml`.
/// Operations: 37 (14 +, 23 ×), sine or cosine of 1 angle.
#[must_use]
#[inline]
pub fn output_adjoint<T: Real>(
    parameters: &Parameters<T>,
    state: &State<T>,
    _inputs: &Inputs<T>,
    weights: &[T; 12],
) -> OutputAdjoint<T> {
    let &Parameters { m, l, I, g } = parameters;
    let &State { omega, theta } = state;
    let mu_x_G = weights[0];
    let mu_z_G = weights[1];
    let mu_energy = weights[2];
    let Gamma_x_G_theta = weights[4];
    let Gamma_z_G_theta = weights[6];
    let Gamma_energy_omega = weights[7];
    let Gamma_energy_theta = weights[8];
    let zero = T::constant(0.0);
    let half = T::constant(0.5);
    let one = T::constant(1.0);
    let two = T::constant(2.0);

    // Sines and cosines.
    let (sin_theta, cos_theta) = theta.sin_cos();

    // Combinations of parameters.
    let m_l = m * l;
    let m_l_g = g * m_l;

    let omega_mu_energy = omega * mu_energy;
    let by_omega = (l * m_l + I) * (Gamma_energy_omega + omega_mu_energy);
    let adjoint = Gamma_z_G_theta + mu_x_G;
    let adjoint_2 = Gamma_x_G_theta - mu_z_G;
    let by_theta = cos_theta * (l * adjoint + m_l_g * Gamma_energy_theta)
        - sin_theta * (l * adjoint_2 - m_l_g * mu_energy);
    let by_I = omega * (Gamma_energy_omega + half * omega_mu_energy);
    let l_by_I = l * by_I;
    let by_m_per_l_g = sin_theta * Gamma_energy_theta - mu_energy * (cos_theta - one);
    let g_by_m_per_l_g = g * by_m_per_l_g;
    let by_m = l * (l_by_I + g_by_m_per_l_g);
    let by_l = sin_theta * adjoint + cos_theta * adjoint_2
        + m * (g_by_m_per_l_g + two * l_by_I);
    let by_g = m_l * by_m_per_l_g;

    OutputAdjoint {
        x: State {
            omega: by_omega,
            theta: by_theta,
        },
        u: Inputs { tau: zero },
        p: Parameters {
            m: by_m,
            l: by_l,
            I: by_I,
            g: by_g,
        },
    }
}

/// Physical pendulum with a torque at its pivot.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Pendulum;

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

    impl model::Model for Pendulum {
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

        fn outputs(&self, at: At<'_>, outputs: &mut [f64]) {
            write(
                outputs,
                &self::outputs(&parameters(&at), &state(&at), &inputs(&at)).to_array(),
            );
        }

        fn inverse_dynamics(
            &self,
            at: At<'_>,
            accelerations: &[f64],
            demand: &mut [f64],
        ) {
            let accelerations = Accelerations::from(first(accelerations));
            write(
                demand,
                &self::inverse_dynamics(
                        &parameters(&at),
                        &state(&at),
                        &inputs(&at),
                        &accelerations,
                    )
                    .to_array(),
            );
        }

        fn inverse_dynamics_jacobians(
            &self,
            at: At<'_>,
            accelerations: &[f64],
            demand: &mut [f64],
            by_state: &mut [f64],
            by_inputs: &mut [f64],
            mass: &mut [f64],
        ) {
            let accelerations = Accelerations::from(first(accelerations));
            let all = self::inverse_dynamics_jacobians(
                &parameters(&at),
                &state(&at),
                &inputs(&at),
                &accelerations,
            );
            write(demand, &all.demand.to_array());
            write(by_state, all.by_state.map(State::to_array).to_array().as_flattened());
            write(
                by_inputs,
                all.by_inputs.map(Inputs::to_array).to_array().as_flattened(),
            );
            write(mass, all.mass_matrix.as_flattened());
        }

        fn has_adjoint(&self) -> bool {
            true
        }

        fn adjoint(&self, at: At<'_>, weights: &[f64], by: model::Gradient<'_>) {
            let weights = first(weights);
            let all = self::adjoint(
                &parameters(&at),
                &state(&at),
                &inputs(&at),
                &weights,
            );
            write(by.x, &all.x.to_array());
            write(by.u, &all.u.to_array());
            write(by.p, &all.p.to_array());
        }

        fn output_jacobians(
            &self,
            at: At<'_>,
            outputs: &mut [f64],
            c: &mut [f64],
            d: &mut [f64],
        ) {
            let all = self::output_jacobians(
                &parameters(&at),
                &state(&at),
                &inputs(&at),
            );
            write(outputs, &all.outputs.to_array());
            write(c, all.c.map(State::to_array).to_array().as_flattened());
            write(d, all.d.map(Inputs::to_array).to_array().as_flattened());
        }

        fn output_adjoint(&self, at: At<'_>, weights: &[f64], by: model::Gradient<'_>) {
            let weights = first(weights);
            let all = self::output_adjoint(
                &parameters(&at),
                &state(&at),
                &inputs(&at),
                &weights,
            );
            write(by.x, &all.x.to_array());
            write(by.u, &all.u.to_array());
            write(by.p, &all.p.to_array());
        }
    }

    impl model::Named for Pendulum {
        type State = State<f64>;
        type Inputs = Inputs<f64>;
        type Outputs = Outputs<f64>;

        fn named(&self, at: At<'_>) -> model::Row<Self> {
            model::Row {
                t: at.t,
                state: state(&at),
                inputs: inputs(&at),
                outputs: self::outputs(&parameters(&at), &state(&at), &inputs(&at)),
            }
        }
    }
};

/// Pseudo-velocities and coordinates.
static STATES: [model::Quantity; 2] = [
    model::Quantity::new("omega", "angular velocity", "rad/s"),
    model::Quantity::new(
        "theta",
        "angle from the hanging position, positive towards +x",
        "rad",
    ),
];

/// Inputs and signals.
static INPUTS: [model::Quantity; 1] = [
    model::Quantity::new(
        "tau",
        "torque at the pivot, positive in the sense of theta",
        "N*m",
    ),
];

/// Parameters.
static PARAMETERS: [model::Quantity; 4] = [
    model::Quantity::new("m", "mass of the rod", "kg")
        .valued(1.0)
        .within(0.0, f64::INFINITY),
    model::Quantity::new("l", "distance from the pivot to the centre of mass", "m")
        .valued(0.5)
        .within(0.0, f64::INFINITY),
    model::Quantity::new("I", "inertia about the centre of mass", "kg*m^2")
        .valued(0.02)
        .within(0.0, f64::INFINITY),
    model::Quantity::new("g", "gravitational acceleration", "m/s^2")
        .valued(9.81)
        .within(0.0, f64::INFINITY),
];

/// Outputs.
static OUTPUTS: [model::Quantity; 3] = [
    model::Quantity::new("x_G", "centre of mass along the ground axis x", "m"),
    model::Quantity::new("z_G", "height of the centre of mass above the pivot", "m"),
    model::Quantity::new("energy", "energy above the hanging position", "J"),
];

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
    name: model::Text::Borrowed("pendulum"),
    title: model::Text::Borrowed("Physical pendulum with a torque at its pivot"),
    source: model::Text::Borrowed(
        "Textbook: (I + m l^2) theta'' = tau - m g l sin(theta)",
    ),
    states: model::List::Borrowed(&STATES),
    speeds: 1,
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

::appell_runtime::vector!(Parameters { m, l, I, g });

::appell_runtime::vector!(State { omega, theta }, Rates);

::appell_runtime::vector!(Inputs { tau });

::appell_runtime::vector!(Outputs { x_G, z_G, energy });

::appell_runtime::vector!(Rates { omega_dot, theta_dot });

::appell_runtime::vector!(Accelerations { omega_dot });

::appell_runtime::vector!(CoordinateRates { theta_dot });

::appell_runtime::vector!(GeneralizedForces { omega });

::appell_runtime::vector!(ConstraintResidual {});

::appell_runtime::vector!(ConstraintForces {});
