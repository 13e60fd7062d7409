/// The spec this module is made from.
pub const SPEC: &str = r##"# A spec with "quotes" and "#.
name = 'unicycle'
"##;

use ::appell_runtime::Real;
use ::appell_runtime::model;

/// Parameters p, in SI.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Parameters<T> {
    /// In `kg`.
    pub m: T,
    /// In `rad`.
    pub beta: T,
    /// In `1`.
    pub mu: T,
    /// In `m/s`.
    pub eps: T,
    /// In `m/s^2`.
    pub g: T,
    /// In `N/m`.
    pub k: T,
}

impl Default for Parameters<f64> {
    /// The values of the spec.
    fn default() -> Self {
        Self {
            m: 2.0,
            beta: 0.3,
            mu: 0.4,
            eps: 0.05,
            g: 9.81,
            k: 30.0,
        }
    }
}

/// State x: pseudo-velocities, then coordinates. In SI.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct State<T> {
    /// In `m/s`.
    pub v: T,
    /// In `m`.
    pub s: T,
}

impl State<f64> {
    /// The initial state of the spec; the default is zero.
    #[must_use]
    pub fn initial() -> Self {
        Self { v: 0.0, s: 0.0 }
    }
}

/// Inputs u, in SI.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Inputs<T> {
    /// In `N`.
    pub F: T,
}

/// Outputs y, in SI.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Outputs<T> {
    /// In `N`.
    pub n: T,
    /// In `N`.
    pub across: T,
    /// In `N`.
    pub rubbing: T,
    /// In `N`.
    pub pulling: T,
    /// In `N`.
    pub pushing: T,
    /// In `m/s^2`.
    pub a: T,
}

/// Rates ẋ of the [`State`]: pseudo-accelerations, then generalised velocities. In SI.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Rates<T> {
    /// Rate of `v`, in `m/s^2`.
    pub v_dot: T,
    /// Rate of `s`, in `m/s`.
    pub s_dot: T,
}

impl<T> Rates<T> {
    /// ω̇, the first part.
    #[must_use]
    pub fn accelerations(self) -> Accelerations<T> {
        Accelerations { v_dot: self.v_dot }
    }

    /// q̇, the second part.
    #[must_use]
    pub fn coordinate_rates(self) -> CoordinateRates<T> {
        CoordinateRates {
            s_dot: self.s_dot,
        }
    }
}

/// Pseudo-accelerations ω̇, in SI.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Accelerations<T> {
    /// Rate of `v`, in `m/s^2`.
    pub v_dot: T,
}

/// Generalised velocities q̇, in SI.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct CoordinateRates<T> {
    /// Rate of `s`, in `m/s`.
    pub s_dot: T,
}

/// Pseudo-forces, such as Π or b: power per pseudo-velocity, in SI.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct GeneralizedForces<T> {
    /// Along `v`, in `N`.
    pub v: T,
}

/// What the constraint rows are off by: zero up to rounding. In SI.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct ConstraintResidual {}

/// Reactions in the ground: forces on points along x, y, z in N; a multiplier of a constraint stands in the x component.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct ConstraintForces<T> {
    /// At `C`, in `N`.
    pub C: T,
}

/// Result of [`acceleration_energy`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AccelerationEnergy<T> {
    /// Sum over the bodies, in W/s.
    pub total: T,
    /// Of `block`, in W/s.
    pub block: T,
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

/// Result of [`crossings`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Crossings<T> {
    /// Their zeros switch.
    pub crossings: [T; 0],
    /// They rise and fall.
    pub pulses: [T; 1],
}

/// Result of [`contacts`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Contacts<T> {
    /// Normals in the ground.
    pub normals: [[T; 3]; 1],
    /// Coefficients of friction.
    pub friction: [T; 1],
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
/// ṡ = v
/// ```
///
/// From `block.toml`.
/// Operations: 0.
#[must_use]
#[inline]
pub fn kinematics<T: Real>(
    _parameters: &Parameters<T>,
    state: &State<T>,
    _inputs: &Inputs<T>,
) -> CoordinateRates<T> {
    let &State { v, .. } = state;

    CoordinateRates { s_dot: v }
}

/// Acceleration energy S (Gibbs function) at the actual motion, without the terms ½ ω²(ω·Jω) of the bodies, which no pseudo-acceleration enters.
///
/// ```text
/// S = Σ ½ m a² + ½ α·J α + α·(ω × J ω)
/// ```
///
/// - `rhs`: `Π − b` after elimination, times the common denominator in `pivot`.
///
/// From `block.toml`.
/// Operations: 18 (4 +, 12 ×, 2 ÷), sine or cosine of 1 angle, 1 function.
#[must_use]
#[inline]
pub fn acceleration_energy<T: Real>(
    parameters: &Parameters<T>,
    state: &State<T>,
    inputs: &Inputs<T>,
) -> AccelerationEnergy<T> {
    let &Parameters { m, beta, mu, eps, g, k } = parameters;
    let &State { v, s } = state;
    let &Inputs { F } = inputs;
    let half = T::constant(0.5);
    let one = T::constant(1.0);

    // Sines and cosines.
    let (sin_beta, cos_beta) = beta.sin_cos();

    // Combinations of parameters.
    let inv_m = one / m;
    let m_g = m * g;

    // Unknown `v_dot`.
    let normal_force_ground = sin_beta * F + cos_beta * m_g;
    let rhs_v = cos_beta * F - mu * normal_force_ground * (v / eps).tanh() - k * s
        - sin_beta * m_g;
    let v_dot = inv_m * rhs_v;

    // Body `block`, block.toml:22.
    let s_block = half * m * v_dot * v_dot;

    AccelerationEnergy {
        total: s_block,
        block: s_block,
    }
}

/// Mass matrix M = ∂²S/∂ω̇², symmetric. Rows and columns follow [`Accelerations`].
///
/// ```text
/// M = [ m ]
/// ```
///
/// From `block.toml`.
/// Operations: 0.
#[must_use]
#[inline]
pub fn mass_matrix<T: Real>(
    parameters: &Parameters<T>,
    _state: &State<T>,
    _inputs: &Inputs<T>,
) -> [[T; 1]; 1] {
    let &Parameters { m, .. } = parameters;

    [[m]]
}

/// Bias b: ∂S/∂ω̇ at zero pseudo-accelerations.
///
/// ```text
/// b_v = 0
/// ```
///
/// From `block.toml`.
/// Operations: 0.
#[must_use]
#[inline]
pub fn bias<T: Real>(
    _parameters: &Parameters<T>,
    _state: &State<T>,
    _inputs: &Inputs<T>,
) -> GeneralizedForces<T> {
    let zero = T::constant(0.0);

    GeneralizedForces { v: zero }
}

/// Mass matrix M and bias b together: what both need is computed once.
///
/// From `block.toml`.
/// Operations: 0.
#[must_use]
#[inline]
pub fn mass_matrix_and_bias<T: Real>(
    parameters: &Parameters<T>,
    _state: &State<T>,
    _inputs: &Inputs<T>,
) -> MassMatrixAndBias<T> {
    let &Parameters { m, .. } = parameters;
    let zero = T::constant(0.0);

    MassMatrixAndBias {
        mass_matrix: [[m]],
        bias: GeneralizedForces { v: zero },
    }
}

/// Pseudo-forces Π (generalised forces): virtual power of the loads per pseudo-velocity.
///
/// ```text
/// Π_v = F cos β − m g sin β − μ normal_force_ground tanh(v/eps) − k s
/// ```
///
/// From `block.toml`.
/// Operations: 13 (4 +, 8 ×, 1 ÷), sine or cosine of 1 angle, 1 function.
#[must_use]
#[inline]
pub fn generalized_forces<T: Real>(
    parameters: &Parameters<T>,
    state: &State<T>,
    inputs: &Inputs<T>,
) -> GeneralizedForces<T> {
    let &Parameters { m, beta, mu, eps, g, k } = parameters;
    let &State { v, s } = state;
    let &Inputs { F } = inputs;

    // Sines and cosines.
    let (sin_beta, cos_beta) = beta.sin_cos();

    // Combinations of parameters.
    let m_g = m * g;

    // Pseudo-forces.
    let normal_force_ground = sin_beta * F + cos_beta * m_g;
    let force_v = cos_beta * F - mu * normal_force_ground * (v / eps).tanh() - k * s
        - sin_beta * m_g;

    GeneralizedForces { v: force_v }
}

/// Rates ẋ of the state by Appell's equations M ω̇ + b = Π and kinematics.
///
/// ```text
/// m v̇ = F cos β − m g sin β − μ normal_force_ground tanh(v/eps) − k s
/// ṡ = v
/// ```
///
/// - `rhs`: `Π − b` after elimination, times the common denominator in `pivot`.
///
/// From `block.toml`.
/// Operations: 15 (4 +, 9 ×, 2 ÷), sine or cosine of 1 angle, 1 function.
#[must_use]
#[inline]
pub fn rates<T: Real>(
    parameters: &Parameters<T>,
    state: &State<T>,
    inputs: &Inputs<T>,
) -> Rates<T> {
    let &Parameters { m, beta, mu, eps, g, k } = parameters;
    let &State { v, s } = state;
    let &Inputs { F } = inputs;
    let one = T::constant(1.0);

    // Sines and cosines.
    let (sin_beta, cos_beta) = beta.sin_cos();

    // Combinations of parameters.
    let inv_m = one / m;
    let m_g = m * g;

    // Unknown `v_dot`.
    let normal_force_ground = sin_beta * F + cos_beta * m_g;
    let rhs_v = cos_beta * F - mu * normal_force_ground * (v / eps).tanh() - k * s
        - sin_beta * m_g;
    let v_dot = inv_m * rhs_v;

    Rates { v_dot, s_dot: v }
}

/// Rates ẋ and their Jacobians with respect to state and inputs.
///
/// ```text
/// M ∂ω̇/∂x = ∂(Π − b)/∂x − ∂M/∂x ω̇
/// ```
///
/// - `rhs`: `Π − b` after elimination, times the common denominator in `pivot`.
///
/// From `block.toml`.
/// Operations: 27 (6 +, 18 ×, 2 ÷, 1 sign), sine or cosine of 1 angle, 1 function.
#[must_use]
#[inline]
pub fn jacobians<T: Real>(
    parameters: &Parameters<T>,
    state: &State<T>,
    inputs: &Inputs<T>,
) -> Jacobians<T> {
    let &Parameters { m, beta, mu, eps, g, k } = parameters;
    let &State { v, s } = state;
    let &Inputs { F } = inputs;
    let zero = T::constant(0.0);
    let one = T::constant(1.0);

    // Sines and cosines.
    let (sin_beta, cos_beta) = beta.sin_cos();

    // Combinations of parameters.
    let inv_m = one / m;
    let inv_eps = one / eps;
    let m_g = m * g;
    let d_v_dot_d_s = -k * inv_m;

    // Unknown `v_dot`.
    let tanh_v_over_eps = (inv_eps * v).tanh();
    let normal_force_ground = sin_beta * F + cos_beta * m_g;
    let mu_normal_force_ground = mu * normal_force_ground;
    let rhs_v = cos_beta * F - tanh_v_over_eps * mu_normal_force_ground - k * s
        - sin_beta * m_g;
    let v_dot = inv_m * rhs_v;

    // Row `v_dot` of A.
    let d_v_dot_d_v = inv_m * inv_eps * mu_normal_force_ground
        * (tanh_v_over_eps * tanh_v_over_eps - one);

    // Row `v_dot` of B.
    let d_v_dot_d_F = inv_m * (cos_beta - mu * sin_beta * tanh_v_over_eps);

    Jacobians {
        rates: Rates { v_dot, s_dot: v },
        a: Rates {
            v_dot: State {
                v: d_v_dot_d_v,
                s: d_v_dot_d_s,
            },
            s_dot: State { v: one, s: zero },
        },
        b: Rates {
            v_dot: Inputs { F: d_v_dot_d_F },
            s_dot: Inputs { F: zero },
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
///
/// From `block.toml`.
/// Operations: 37 (8 +, 23 ×, 2 ÷, 4 sign), sine or cosine of 1 angle, 1 function.
#[must_use]
#[inline]
pub fn parameter_jacobian<T: Real>(
    parameters: &Parameters<T>,
    state: &State<T>,
    inputs: &Inputs<T>,
) -> Rates<Parameters<T>> {
    let &Parameters { m, beta, mu, eps, g, k } = parameters;
    let &State { v, s } = state;
    let &Inputs { F } = inputs;
    let zero = T::constant(0.0);
    let one = T::constant(1.0);

    // Sines and cosines.
    let (sin_beta, cos_beta) = beta.sin_cos();

    // Combinations of parameters.
    let inv_m = one / m;
    let inv_eps = one / eps;
    let m_g = m * g;

    // Unknown `v_dot`.
    let v_over_eps = inv_eps * v;
    let tanh_v_over_eps = v_over_eps.tanh();
    let mu_tanh_v_over_eps = mu * tanh_v_over_eps;
    let normal_force_ground = sin_beta * F + cos_beta * m_g;
    let d_normal_force_ground_d_beta = cos_beta * F - sin_beta * m_g;
    let rhs_v = d_normal_force_ground_d_beta - mu_tanh_v_over_eps * normal_force_ground
        - k * s;
    let v_dot = inv_m * rhs_v;

    // Column `m` of P.
    let d_v_dot_d_g = -(sin_beta + cos_beta * mu_tanh_v_over_eps);
    let d_v_dot_d_m = inv_m * (g * d_v_dot_d_g - v_dot);

    // Column `beta` of P.
    let d_v_dot_d_beta_part_1 = mu_tanh_v_over_eps * d_normal_force_ground_d_beta;
    let d_v_dot_d_beta = -inv_m * (normal_force_ground + d_v_dot_d_beta_part_1);

    // Column `mu` of P.
    let normal_force_ground_over_m = inv_m * normal_force_ground;
    let d_v_dot_d_mu = -tanh_v_over_eps * normal_force_ground_over_m;

    // Column `eps` of P.
    let d_v_dot_d_eps = mu * inv_eps * v_over_eps * normal_force_ground_over_m
        * (one - tanh_v_over_eps * tanh_v_over_eps);

    // Column `k` of P.
    let d_v_dot_d_k = -inv_m * s;

    Rates {
        v_dot: Parameters {
            m: d_v_dot_d_m,
            beta: d_v_dot_d_beta,
            mu: d_v_dot_d_mu,
            eps: d_v_dot_d_eps,
            g: d_v_dot_d_g,
            k: d_v_dot_d_k,
        },
        s_dot: Parameters::splat(zero),
    }
}

/// Energies and power.
///
/// ```text
/// T = ½ m v²
/// V = m g s sin β + ½ k s²
/// P = v F cos β − μ v normal_force_ground tanh(v/eps)
/// ```
///
/// From `block.toml`.
/// Operations: 18 (3 +, 14 ×, 1 ÷), sine or cosine of 1 angle, 1 function.
#[must_use]
#[inline]
pub fn energies<T: Real>(
    parameters: &Parameters<T>,
    state: &State<T>,
    inputs: &Inputs<T>,
) -> Energies<T> {
    let &Parameters { m, beta, mu, eps, g, k } = parameters;
    let &State { v, s } = state;
    let &Inputs { F } = inputs;
    let half = T::constant(0.5);

    // Sines and cosines.
    let (sin_beta, cos_beta) = beta.sin_cos();

    // Combinations of parameters.
    let m_g = m * g;

    // Body `block`, block.toml:22.
    let T_block = half * m * v * v;

    // Potential energy, in J.
    let potential = s * (sin_beta * m_g + half * k * s);

    // Power of the loads without a potential, in W.
    let normal_force_ground = sin_beta * F + cos_beta * m_g;
    let power = v * (cos_beta * F - mu * normal_force_ground * (v / eps).tanh());

    Energies {
        kinetic: T_block,
        potential,
        power,
    }
}

/// Constraint rows at the generalised velocities of the state: zero up to rounding.
///
/// `ground` has no row: the coordinates satisfy it identically.
///
/// From `block.toml`.
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
/// From `block.toml`.
/// Operations: 7 (1 +, 5 ×, 1 sign), sine or cosine of 1 angle.
#[must_use]
#[inline]
pub fn constraint_forces<T: Real>(
    parameters: &Parameters<T>,
    _state: &State<T>,
    inputs: &Inputs<T>,
) -> ConstraintForces<[T; 3]> {
    let &Parameters { m, beta, g, .. } = parameters;
    let &Inputs { F } = inputs;
    let zero = T::constant(0.0);

    // Sines and cosines.
    let (sin_beta, cos_beta) = beta.sin_cos();

    // Reaction `C`.
    let sin_beta_F_plus_m_g_cos_beta = sin_beta * F + m * g * cos_beta;
    let reaction_C_x = -sin_beta * sin_beta_F_plus_m_g_cos_beta;
    let reaction_C_z = cos_beta * sin_beta_F_plus_m_g_cos_beta;

    ConstraintForces {
        C: [reaction_C_x, zero, reaction_C_z],
    }
}

/// Outputs of the spec.
///
/// ```text
/// n = m g cos β + m a_C,z cos β − m a_C,x sin β + F sin β
/// across = m g cos β + m a_C,z cos β − m a_C,x sin β + F sin β
/// rubbing = −μ normal_force_ground tanh(v/eps)
/// pulling = k s
/// pushing = F cos β
/// a = rhs_v/m
/// ```
///
/// - `rhs`: `Π − b` after elimination, times the common denominator in `pivot`.
///
/// From `block.toml`.
/// Operations: 16 (4 +, 9 ×, 2 ÷, 1 sign), sine or cosine of 1 angle, 1 function.
#[must_use]
#[inline]
pub fn outputs<T: Real>(
    parameters: &Parameters<T>,
    state: &State<T>,
    inputs: &Inputs<T>,
) -> Outputs<T> {
    let &Parameters { m, beta, mu, eps, g, k } = parameters;
    let &State { v, s } = state;
    let &Inputs { F } = inputs;
    let one = T::constant(1.0);

    // Sines and cosines.
    let (sin_beta, cos_beta) = beta.sin_cos();

    // Combinations of parameters.
    let m_g = m * g;
    let inv_m = one / m;

    // Unknown `v_dot`.
    let normal_force_ground = sin_beta * F + cos_beta * m_g;
    let rubbing = -mu * normal_force_ground * (v / eps).tanh();
    let pulling = k * s;
    let pushing = cos_beta * F;
    let rhs_v = rubbing + pushing - pulling - sin_beta * m_g;
    let v_dot = inv_m * rhs_v;

    Outputs {
        n: normal_force_ground,
        across: normal_force_ground,
        rubbing,
        pulling,
        pushing,
        a: v_dot,
    }
}

/// Functions at whose zeros the state switches the equations, and those that rise and fall with it.
///
/// From `block.toml`.
/// Operations: 1 (1 ÷), 1 function.
#[must_use]
#[inline]
pub fn crossings<T: Real>(
    parameters: &Parameters<T>,
    state: &State<T>,
    _inputs: &Inputs<T>,
) -> Crossings<T> {
    let &Parameters { eps, .. } = parameters;
    let &State { v, .. } = state;

    let pulses = (v / eps).tanh();

    Crossings {
        crossings: [],
        pulses: [pulses],
    }
}

/// Surfaces at the contacts: normals in the ground, coefficients of friction.
///
/// From `block.toml`.
/// Operations: 1 (1 sign), sine or cosine of 1 angle.
#[must_use]
#[inline]
pub fn contacts<T: Real>(
    parameters: &Parameters<T>,
    _state: &State<T>,
    _inputs: &Inputs<T>,
) -> Contacts<T> {
    let &Parameters { beta, .. } = parameters;
    let zero = T::constant(0.0);

    // Sines and cosines.
    let (sin_beta, cos_beta) = beta.sin_cos();

    Contacts {
        normals: [[-sin_beta, zero, cos_beta]],
        friction: [zero],
    }
}

/// Inverse dynamics: the pseudo-forces M ω̇ + b − Π that a motion takes beyond the loads. With inputs of zero they are what drives along the pseudo-velocities have to bring.
///
/// From `block.toml`.
/// Operations: 15 (5 +, 9 ×, 1 ÷), sine or cosine of 1 angle, 1 function.
#[must_use]
#[inline]
pub fn inverse_dynamics<T: Real>(
    parameters: &Parameters<T>,
    state: &State<T>,
    inputs: &Inputs<T>,
    accelerations: &Accelerations<T>,
) -> GeneralizedForces<T> {
    let &Parameters { m, beta, mu, eps, g, k } = parameters;
    let &State { v, s } = state;
    let &Inputs { F } = inputs;
    let v_dot = accelerations.v_dot;

    // Sines and cosines.
    let (sin_beta, cos_beta) = beta.sin_cos();

    // Combinations of parameters.
    let m_g = m * g;

    // M ω̇ + b − Π.
    let normal_force_ground = sin_beta * F + cos_beta * m_g;
    let demand_v = m * v_dot + mu * normal_force_ground * (v / eps).tanh() + k * s
        + sin_beta * m_g - cos_beta * F;

    GeneralizedForces { v: demand_v }
}

/// Inverse dynamics with its Jacobians with respect to state, inputs and pseudo-accelerations; the last is the mass matrix M.
///
/// From `block.toml`.
/// Operations: 23 (7 +, 15 ×, 1 ÷), sine or cosine of 1 angle, 1 function.
#[must_use]
#[inline]
pub fn inverse_dynamics_jacobians<T: Real>(
    parameters: &Parameters<T>,
    state: &State<T>,
    inputs: &Inputs<T>,
    accelerations: &Accelerations<T>,
) -> InverseDynamicsJacobians<T> {
    let &Parameters { m, beta, mu, eps, g, k } = parameters;
    let &State { v, s } = state;
    let &Inputs { F } = inputs;
    let v_dot = accelerations.v_dot;
    let one = T::constant(1.0);

    // Sines and cosines.
    let (sin_beta, cos_beta) = beta.sin_cos();

    // Combinations of parameters.
    let inv_eps = one / eps;
    let m_g = m * g;

    // M ω̇ + b − Π.
    let tanh_v_over_eps = (inv_eps * v).tanh();
    let normal_force_ground = sin_beta * F + cos_beta * m_g;
    let mu_normal_force_ground = mu * normal_force_ground;
    let demand_v = m * v_dot + tanh_v_over_eps * mu_normal_force_ground + k * s
        + sin_beta * m_g - cos_beta * F;

    // Row `v` of `by_state`.
    let d_v_d_v = inv_eps * mu_normal_force_ground
        * (one - tanh_v_over_eps * tanh_v_over_eps);

    // Row `v` of `by_inputs`.
    let d_v_d_F = mu * sin_beta * tanh_v_over_eps - cos_beta;

    InverseDynamicsJacobians {
        demand: GeneralizedForces { v: demand_v },
        by_state: GeneralizedForces {
            v: State { v: d_v_d_v, s: k },
        },
        by_inputs: GeneralizedForces {
            v: Inputs { F: d_v_d_F },
        },
        mass_matrix: [[m]],
    }
}

/// Gradient of ⟨λ, ẋ⟩ + ⟨Λ, A⟩ + ⟨Γ, B⟩ + ⟨K, M⟩; the weights are λ, Λ, Γ, K, row by row.
///
/// - `adjoint`: a derivative of the weighted sum with respect to an intermediate value.
///
/// From `block.toml`.
/// Operations: 82 (25 +, 53 ×, 2 ÷, 2 sign), sine or cosine of 1 angle, 1 function.
#[must_use]
#[inline]
pub fn adjoint<T: Real>(
    parameters: &Parameters<T>,
    state: &State<T>,
    inputs: &Inputs<T>,
    weights: &[T; 9],
) -> Adjoint<T> {
    let &Parameters { m, beta, mu, eps, g, k } = parameters;
    let &State { v, s } = state;
    let &Inputs { F } = inputs;
    let lambda_v = weights[0];
    let lambda_s = weights[1];
    let Lambda_v_v = weights[2];
    let Lambda_v_s = weights[3];
    let Gamma_v_F = weights[6];
    let K_v_v = weights[8];
    let one = T::constant(1.0);
    let two = T::constant(2.0);

    // Sines and cosines.
    let (sin_beta, cos_beta) = beta.sin_cos();

    // Combinations of parameters.
    let inv_eps = one / eps;
    let m_g = m * g;
    let inv_m = one / m;
    let mu_over_m = mu * inv_m;

    let normal_force_ground = sin_beta * F + cos_beta * m_g;
    let normal_force_ground_Lambda_v_v = normal_force_ground * Lambda_v_v;
    let by_v_part_1 = inv_eps * normal_force_ground_Lambda_v_v;
    let v_over_eps = inv_eps * v;
    let tanh_v_over_eps = v_over_eps.tanh();
    let mu_tanh_v_over_eps_over_m = mu_over_m * tanh_v_over_eps;
    let lambda_v_over_m = inv_m * lambda_v;
    let Gamma_v_F_over_m = inv_m * Gamma_v_F;
    let by_v_part_2 = normal_force_ground * lambda_v_over_m
        + sin_beta * Gamma_v_F_over_m;
    let by_v_part_3 = inv_eps * (tanh_v_over_eps * tanh_v_over_eps - one);
    let by_v_part_4 = by_v_part_3
        * (two * by_v_part_1 * mu_tanh_v_over_eps_over_m - mu * by_v_part_2);
    let by_v = lambda_s - by_v_part_4;
    let by_s = -k * lambda_v_over_m;
    let mu_tanh_v_over_eps = mu * tanh_v_over_eps;
    let by_F_per_sin_beta_Lambda_v_v = mu_over_m * by_v_part_3;
    let adjoint_normal_force_ground = by_F_per_sin_beta_Lambda_v_v * Lambda_v_v
        - lambda_v_over_m * mu_tanh_v_over_eps;
    let by_F = sin_beta * adjoint_normal_force_ground + cos_beta * lambda_v_over_m;
    let by_m_part_1 = inv_m * normal_force_ground_Lambda_v_v;
    let rhs_v = cos_beta * F - normal_force_ground * mu_tanh_v_over_eps - k * s
        - sin_beta * m_g;
    let Lambda_v_s_over_m = inv_m * Lambda_v_s;
    let by_m_part_2 = k * Lambda_v_s_over_m - lambda_v_over_m * rhs_v;
    let by_m_part_3 = Gamma_v_F_over_m * (cos_beta - sin_beta * mu_tanh_v_over_eps);
    let by_m_per_g = cos_beta * adjoint_normal_force_ground - sin_beta * lambda_v_over_m;
    let by_m = K_v_v + inv_m * (by_m_part_2 - by_m_part_3) + g * by_m_per_g
        - by_F_per_sin_beta_Lambda_v_v * by_m_part_1;
    let adjoint = adjoint_normal_force_ground * F - g * lambda_v
        - mu_tanh_v_over_eps_over_m * Gamma_v_F;
    let adjoint_2 = Gamma_v_F_over_m + m_g * adjoint_normal_force_ground
        + lambda_v_over_m * F;
    let by_beta = cos_beta * adjoint - sin_beta * adjoint_2;
    let by_mu = by_v_part_3 * by_m_part_1 - tanh_v_over_eps * by_v_part_2;
    let by_eps = v_over_eps * by_v_part_4 - by_v_part_1 * by_F_per_sin_beta_Lambda_v_v;
    let by_g = m * by_m_per_g;
    let by_k = -(Lambda_v_s_over_m + lambda_v_over_m * s);

    Adjoint {
        x: State { v: by_v, s: by_s },
        u: Inputs { F: by_F },
        p: Parameters {
            m: by_m,
            beta: by_beta,
            mu: by_mu,
            eps: by_eps,
            g: by_g,
            k: by_k,
        },
    }
}

/// Outputs of the spec and their Jacobians with respect to state and inputs.
///
/// - `rhs`: `Π − b` after elimination, times the common denominator in `pivot`.
///
/// From `block.toml`.
/// Operations: 29 (6 +, 18 ×, 2 ÷, 3 sign), sine or cosine of 1 angle, 1 function.
#[must_use]
#[inline]
pub fn output_jacobians<T: Real>(
    parameters: &Parameters<T>,
    state: &State<T>,
    inputs: &Inputs<T>,
) -> OutputJacobians<T> {
    let &Parameters { m, beta, mu, eps, g, k } = parameters;
    let &State { v, s } = state;
    let &Inputs { F } = inputs;
    let zero = T::constant(0.0);
    let one = T::constant(1.0);

    // Sines and cosines.
    let (sin_beta, cos_beta) = beta.sin_cos();

    // Combinations of parameters.
    let m_g = m * g;
    let inv_eps = one / eps;
    let inv_m = one / m;
    let C_a_s = -k * inv_m;

    // Unknown `v_dot`.
    let tanh_v_over_eps = (inv_eps * v).tanh();
    let normal_force_ground = sin_beta * F + cos_beta * m_g;
    let mu_normal_force_ground = mu * normal_force_ground;
    let rubbing_part_1 = tanh_v_over_eps * mu_normal_force_ground;
    let pulling = k * s;
    let pushing = cos_beta * F;
    let rhs_v = pushing - rubbing_part_1 - pulling - sin_beta * m_g;
    let v_dot = inv_m * rhs_v;

    let C_rubbing_v = inv_eps * mu_normal_force_ground
        * (tanh_v_over_eps * tanh_v_over_eps - one);
    let C_a_v = inv_m * C_rubbing_v;
    let mu_sin_beta_tanh_v_over_eps = mu * sin_beta * tanh_v_over_eps;
    let D_a_F = inv_m * (cos_beta - mu_sin_beta_tanh_v_over_eps);

    OutputJacobians {
        outputs: Outputs {
            n: normal_force_ground,
            across: normal_force_ground,
            rubbing: -rubbing_part_1,
            pulling,
            pushing,
            a: v_dot,
        },
        c: Outputs {
            n: State::splat(zero),
            across: State::splat(zero),
            rubbing: State { v: C_rubbing_v, s: zero },
            pulling: State { v: zero, s: k },
            pushing: State::splat(zero),
            a: State { v: C_a_v, s: C_a_s },
        },
        d: Outputs {
            n: Inputs { F: sin_beta },
            across: Inputs { F: sin_beta },
            rubbing: Inputs {
                F: -mu_sin_beta_tanh_v_over_eps,
            },
            pulling: Inputs { F: zero },
            pushing: Inputs { F: cos_beta },
            a: Inputs { F: D_a_F },
        },
    }
}

/// Gradient of ⟨μ, y⟩ + ⟨Γ, C⟩ + ⟨Δ, D⟩; the weights are μ, Γ, Δ, row by row.
///
/// - `adjoint`: a derivative of the weighted sum with respect to an intermediate value.
///
/// From `block.toml`.
/// Operations: 94 (35 +, 55 ×, 2 ÷, 2 sign), sine or cosine of 1 angle, 1 function.
#[must_use]
#[inline]
pub fn output_adjoint<T: Real>(
    parameters: &Parameters<T>,
    state: &State<T>,
    inputs: &Inputs<T>,
    weights: &[T; 24],
) -> OutputAdjoint<T> {
    let &Parameters { m, beta, mu, eps, g, k } = parameters;
    let &State { v, s } = state;
    let &Inputs { F } = inputs;
    let mu_n = weights[0];
    let mu_across = weights[1];
    let mu_rubbing = weights[2];
    let mu_pulling = weights[3];
    let mu_pushing = weights[4];
    let mu_a = weights[5];
    let Gamma_rubbing_v = weights[10];
    let Gamma_pulling_s = weights[13];
    let Gamma_a_v = weights[16];
    let Gamma_a_s = weights[17];
    let Delta_n_F = weights[18];
    let Delta_across_F = weights[19];
    let Delta_rubbing_F = weights[20];
    let Delta_pushing_F = weights[22];
    let Delta_a_F = weights[23];
    let one = T::constant(1.0);
    let two = T::constant(2.0);

    // Sines and cosines.
    let (sin_beta, cos_beta) = beta.sin_cos();

    // Combinations of parameters.
    let inv_m = one / m;
    let m_g = m * g;
    let inv_eps = one / eps;

    let mu_a_over_m = inv_m * mu_a;
    let adjoint = -(mu_a_over_m + mu_rubbing);
    let normal_force_ground = sin_beta * F + cos_beta * m_g;
    let mu_normal_force_ground = mu * normal_force_ground;
    let Delta_a_F_over_m = inv_m * Delta_a_F;
    let adjoint_2 = -(Delta_a_F_over_m + Delta_rubbing_F);
    let sin_beta_adjoint_2 = sin_beta * adjoint_2;
    let adjoint_3 = inv_m * Gamma_a_v + Gamma_rubbing_v;
    let v_over_eps = inv_eps * v;
    let tanh_v_over_eps = v_over_eps.tanh();
    let mu_normal_force_ground_over_eps = inv_eps * mu_normal_force_ground;
    let two_adjoint_3_tanh_v_over_eps = two * adjoint_3 * tanh_v_over_eps;
    let adjoint_4 = adjoint * mu_normal_force_ground + mu * sin_beta_adjoint_2
        + two_adjoint_3_tanh_v_over_eps * mu_normal_force_ground_over_eps;
    let by_v_per_adjoint_4 = inv_eps * (one - tanh_v_over_eps * tanh_v_over_eps);
    let by_v = adjoint_4 * by_v_per_adjoint_4;
    let adjoint_5 = mu_pulling - mu_a_over_m;
    let by_s = k * adjoint_5;
    let adjoint_3_by_v_per_adjoint_4 = adjoint_3 * by_v_per_adjoint_4;
    let by_F_per_sin_beta_mu = adjoint * tanh_v_over_eps - adjoint_3_by_v_per_adjoint_4;
    let adjoint_6 = mu_across + mu_n + mu * by_F_per_sin_beta_mu;
    let adjoint_7 = mu_a_over_m + mu_pushing;
    let by_F = sin_beta * adjoint_6 + cos_beta * adjoint_7;
    let rhs_v = cos_beta * F - mu_normal_force_ground * tanh_v_over_eps - k * s
        - sin_beta * m_g;
    let mu_tanh_v_over_eps = mu * tanh_v_over_eps;
    let by_m_part_1 = mu_normal_force_ground * by_v_per_adjoint_4 * Gamma_a_v;
    let by_m_part_2 = by_m_part_1 + k * Gamma_a_s - rhs_v * mu_a;
    let by_m_part_3 = Delta_a_F * (cos_beta - sin_beta * mu_tanh_v_over_eps);
    let cos_beta_adjoint_6 = cos_beta * adjoint_6;
    let by_m = inv_m * inv_m * (by_m_part_2 - by_m_part_3)
        + g * (cos_beta_adjoint_6 - sin_beta * mu_a_over_m);
    let adjoint_8 = adjoint_6 * F + adjoint_2 * mu_tanh_v_over_eps + Delta_across_F
        + Delta_n_F - g * mu_a;
    let adjoint_9 = Delta_a_F_over_m + m_g * adjoint_6 + adjoint_7 * F + Delta_pushing_F;
    let by_beta = cos_beta * adjoint_8 - sin_beta * adjoint_9;
    let by_mu = sin_beta_adjoint_2 * tanh_v_over_eps
        + normal_force_ground * by_F_per_sin_beta_mu;
    let by_eps = mu_normal_force_ground_over_eps * adjoint_3_by_v_per_adjoint_4
        - v_over_eps * by_v;
    let by_g = m * cos_beta_adjoint_6 - sin_beta * mu_a;
    let by_k = adjoint_5 * s + Gamma_pulling_s - inv_m * Gamma_a_s;

    OutputAdjoint {
        x: State { v: by_v, s: by_s },
        u: Inputs { F: by_F },
        p: Parameters {
            m: by_m,
            beta: by_beta,
            mu: by_mu,
            eps: by_eps,
            g: by_g,
            k: by_k,
        },
    }
}

/// A block on a rough slope.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Block;

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

    impl model::Model for Block {
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

        fn constraint_forces(&self, at: At<'_>, forces: &mut [f64]) {
            write(
                forces,
                self::constraint_forces(&parameters(&at), &state(&at), &inputs(&at))
                    .to_array()
                    .as_flattened(),
            );
        }

        fn outputs(&self, at: At<'_>, outputs: &mut [f64]) {
            write(
                outputs,
                &self::outputs(&parameters(&at), &state(&at), &inputs(&at)).to_array(),
            );
        }

        fn switching(&self) -> Option<&dyn model::Switching> {
            Some(self)
        }

        fn contacts(&self, at: At<'_>, normals: &mut [f64], friction: &mut [f64]) {
            let all = self::contacts(&parameters(&at), &state(&at), &inputs(&at));
            write(normals, all.normals.as_flattened());
            write(friction, &all.friction);
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
    use ::appell_runtime::Enclosure;
    use ::appell_runtime::model::Along;
    use ::appell_runtime::switching::Counts;

    impl model::Switching for Block {
        fn counts(&self) -> Counts {
            Counts {
                answers: 0,
                shapes: 0,
                crossings: 0,
                pulses: 1,
            }
        }

        fn answers(&self, at: At<'_>, switches: &mut [f64]) {
            let _ = (at, switches);
        }

        fn within(&self, time: Enclosure, p: &[f64], functions: &mut [Enclosure]) {
            let _ = (time, p, functions);
        }

        fn crossings(&self, at: At<'_>, crossings: &mut [f64]) {
            let (crossings, pulses) = crossings.split_at_mut(0);
            let all = self::crossings(&parameters(&at), &state(&at), &inputs(&at));
            let _ = crossings;
            write(pulses, &all.pulses);
        }

        fn crossings_within(&self, along: &Along<'_>, crossings: &mut [Enclosure]) {
            let all = self::crossings(
                &Parameters::from(first(along.p).map(Enclosure::constant)),
                &State::from(core::array::from_fn(|i| along.x[i])),
                &Inputs::from(core::array::from_fn(|i| along.u[i])),
            );
            for (to, from) in crossings
                .iter_mut()
                .zip(all.crossings.into_iter().chain(all.pulses))
            {
                *to = from;
            }
        }
    }

    impl model::Named for Block {
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
    model::Quantity::new("v", "", "m/s"),
    model::Quantity::new("s", "", "m"),
];

/// Inputs and signals.
static INPUTS: [model::Quantity; 1] = [model::Quantity::new("F", "", "N")];

/// Parameters.
static PARAMETERS: [model::Quantity; 6] = [
    model::Quantity::new("m", "", "kg").valued(2.0),
    model::Quantity::new("beta", "", "rad").valued(0.3),
    model::Quantity::new("mu", "", "1").valued(0.4),
    model::Quantity::new("eps", "", "m/s").valued(0.05),
    model::Quantity::new("g", "", "m/s^2").valued(9.81),
    model::Quantity::new("k", "", "N/m").valued(30.0),
];

/// Outputs.
static OUTPUTS: [model::Quantity; 6] = [
    model::Quantity::new("n", "", "N"),
    model::Quantity::new("across", "", "N"),
    model::Quantity::new("rubbing", "", "N"),
    model::Quantity::new("pulling", "", "N"),
    model::Quantity::new("pushing", "", "N"),
    model::Quantity::new("a", "", "m/s^2"),
];

/// Tabulated functions of time.
static SIGNALS: [model::SignalTable; 0] = [];

/// Signal and order of derivative behind the inputs that are signals.
static SIGNAL_INPUTS: [(usize, u8); 0] = [];

/// Constraint rows.
static CONSTRAINT_ROWS: [model::Text; 0] = [];

/// Reactions in the ground.
static REACTIONS: [model::Reaction; 1] = [
    model::Reaction::on_point(model::Text::Borrowed("C")),
];

/// Contacts, which can only push.
static CONTACTS: [model::Contact; 1] = [
    model::Contact {
        name: model::Text::Borrowed("C"),
        reaction: 0,
        normal: [-0.29552020666133955, 0.0, 0.955336489125606],
        grips: false,
        friction: None,
    },
];

/// Names, units and sizes of the model.
pub static INFO: model::ModelInfo = model::ModelInfo {
    name: model::Text::Borrowed("block"),
    title: model::Text::Borrowed("A block on a rough slope"),
    source: model::Text::Borrowed(""),
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

::appell_runtime::vector!(Parameters { m, beta, mu, eps, g, k });

::appell_runtime::vector!(State { v, s }, Rates);

::appell_runtime::vector!(Inputs { F });

::appell_runtime::vector!(Outputs { n, across, rubbing, pulling, pushing, a });

::appell_runtime::vector!(Rates { v_dot, s_dot });

::appell_runtime::vector!(Accelerations { v_dot });

::appell_runtime::vector!(CoordinateRates { s_dot });

::appell_runtime::vector!(GeneralizedForces { v });

::appell_runtime::vector!(ConstraintResidual {});

::appell_runtime::vector!(ConstraintForces { C });
