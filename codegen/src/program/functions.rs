//! The functions that a model can have, as one table.

/// What a function is for. The functions for a purpose are those of its rows and of all later purposes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Purpose {
    /// A program of its own.
    Separate,
    /// Estimation: as long as all other functions together.
    Estimation,
    /// Every model.
    Standard,
}

/// A row of the table.
struct Row {
    kind: FunctionKind,
    name: &'static str,
    structure: &'static str,
    purpose: Purpose,
    results: &'static [&'static str],
    about: &'static str,
}

/// Each row: documentation, kind, name of the emitted function, name of its result struct, purpose, the results
/// that [`Model`](appell_runtime::model::Model) has, a sentence.
macro_rules! functions {
    ($($(#[$doc:meta])* $kind:ident = $name:literal $structure:literal $purpose:ident
        [$($result:literal),*] $about:literal;)*) => {
        /// The functions that a model can have, in the order of emitted code; empty ones may be missing.
        #[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
        pub enum FunctionKind {
            $($(#[$doc])* $kind,)*
        }

        const ROWS: &[Row] = &[$(Row {
            kind: FunctionKind::$kind,
            name: $name,
            structure: $structure,
            purpose: Purpose::$purpose,
            results: &[$($result),*],
            about: $about,
        },)*];
    };
}

functions! {
    /// q̇(q, ω): result `coordinate_rates`.
    Kinematics = "kinematics" "Kinematics" Standard []
        "Generalised velocities q̇ of pseudo-velocities and coordinates.";
    /// S at the actual accelerations: results `total`, then one per body.
    AccelerationEnergy = "acceleration_energy" "AccelerationEnergy" Standard ["total"]
        "Acceleration energy S (Gibbs function) at the actual motion, without the terms ½ ω²(ω·Jω) of \
         the bodies, which no pseudo-acceleration enters.";
    /// M: result `mass_matrix`.
    MassMatrix = "mass_matrix" "MassMatrix" Standard []
        "Mass matrix M = ∂²S/∂ω̇², symmetric. Rows and columns follow [`Accelerations`].";
    /// b: result `bias`.
    Bias = "bias" "Bias" Standard []
        "Bias b: ∂S/∂ω̇ at zero pseudo-accelerations.";
    /// M and b, sharing subexpressions: results `mass_matrix`, `bias`.
    MassMatrixAndBias = "mass_matrix_and_bias" "MassMatrixAndBias" Standard ["mass_matrix", "bias"]
        "Mass matrix M and bias b together: what both need is computed once.";
    /// Π: result `generalized_forces`.
    GeneralizedForces = "generalized_forces" "GeneralizedForces" Standard ["generalized_forces"]
        "Pseudo-forces Π (generalised forces): virtual power of the loads per pseudo-velocity.";
    /// ẋ: result `rates`.
    Rates = "rates" "Rates" Standard ["rates"]
        "Rates ẋ of the state by Appell's equations M ω̇ + b = Π and kinematics.";
    /// ẋ, A, B: results `rates`, `a`, `b`.
    Jacobians = "jacobians" "Jacobians" Standard ["rates", "a", "b"]
        "Rates ẋ and their Jacobians with respect to state and inputs.";
    /// P: result `p`.
    ParameterJacobian = "parameter_jacobian" "ParameterJacobian" Standard ["p"]
        "P = ∂ẋ/∂p.";
    /// Results `kinetic`, `potential`, `power`.
    Energies = "energies" "Energies" Standard ["kinetic", "potential", "power"]
        "Energies and power.";
    /// Constraint rows at the generalised velocities: result `residual`.
    ConstraintResidual = "constraint_residual" "ConstraintResidual" Standard ["residual"]
        "Constraint rows at the generalised velocities of the state: zero up to rounding.";
    /// Reactions in the ground: result `forces`, three columns.
    ConstraintForces = "constraint_forces" "ConstraintForces" Standard ["forces"]
        "Reactions: forces on what is held, in N.";
    /// Outputs of the spec: result `outputs`.
    Outputs = "outputs" "OutputArrays" Standard ["outputs"]
        "Outputs of the spec.";
    /// Switching values that depend on time alone, if any: result `switches`.
    Switches = "switches" "Switches" Standard ["switches"]
        "Switching functions of time alone: 1 where a relation holds, 0 elsewhere; or a sign.";
    /// Functions of time alone, if any: results `functions`, whose signs are the switches, and `shapes`, which
    /// vary continuously.
    TimeFunctions = "time_functions" "TimeFunctions" Standard ["functions", "shapes"]
        "Functions of time alone: those whose signs the switches are, and those that rise and fall.";
    /// Switching functions that depend on the state, if any: result `crossings`.
    Crossings = "crossings" "Crossings" Standard ["crossings", "pulses"]
        "Functions at whose zeros the state switches the equations, and those that rise and fall with it.";
    /// Position constraints, if any: results `residual`, and `jacobian` with respect to the coordinates.
    PositionConstraints = "position_constraints" "PositionConstraints" Standard ["residual", "jacobian"]
        "Position constraints f(q, t) = 0 and their Jacobian with respect to the coordinates.";
    /// Surfaces at the contacts, unless they are constant: results `normals`, three columns, and `friction`.
    Contacts = "contacts" "Contacts" Standard ["normals", "friction"]
        "Surfaces at the contacts: normals in the ground, coefficients of friction.";
    /// Systems that are solved with pivoting, if any: result `matrices`, one after the other.
    Systems = "systems" "Systems" Standard ["matrices"]
        "Matrices of the systems that are solved with pivoting, row by row.";
    /// M ω̇ + b − Π for given ω̇: result `demand`.
    InverseDynamics = "inverse_dynamics" "InverseDynamics" Standard ["demand"]
        "Inverse dynamics: the pseudo-forces M ω̇ + b − Π that a motion takes beyond the loads. With \
         inputs of zero they are what drives along the pseudo-velocities have to bring.";
    /// The same with its derivatives: results `demand`, `by_state`, `by_inputs`, and `mass_matrix`, with
    /// respect to ω̇.
    InverseDynamicsJacobians = "inverse_dynamics_jacobians" "InverseDynamicsJacobians" Standard ["demand", "by_state", "by_inputs", "mass_matrix"]
        "Inverse dynamics with its Jacobians with respect to state, inputs and pseudo-accelerations; \
         the last is the mass matrix M.";
    /// Gradient of ⟨λ, ẋ⟩ + ⟨Λ, A⟩ + ⟨Γ, B⟩ + ⟨K, M⟩: results `x`, `u`, `p`.
    Adjoint = "adjoint" "Adjoint" Estimation ["x", "u", "p"]
        "Gradient of ⟨λ, ẋ⟩ + ⟨Λ, A⟩ + ⟨Γ, B⟩ + ⟨K, M⟩; the weights are λ, Λ, Γ, K, row by row.";
    /// Outputs, C, D: results `outputs`, `c`, `d`.
    OutputJacobians = "output_jacobians" "OutputJacobians" Estimation ["outputs", "c", "d"]
        "Outputs of the spec and their Jacobians with respect to state and inputs.";
    /// Gradient of ⟨μ, y⟩ + ⟨Γ, C⟩ + ⟨Δ, D⟩: results `x`, `u`, `p`.
    OutputAdjoint = "output_adjoint" "OutputAdjoint" Estimation ["x", "u", "p"]
        "Gradient of ⟨μ, y⟩ + ⟨Γ, C⟩ + ⟨Δ, D⟩; the weights are μ, Γ, Δ, row by row.";
    /// M ω̇ + b − Π = Y π + r: results `regressor`, `rest`, `parameters`. It belongs to a program of its own,
    /// [`regressor`](crate::mechanics::regressor), and so not to [`Self::ALL`].
    Regressor = "regressor" "Regressor" Separate []
        "Inverse dynamics as a linear function of inertial parameters π and parameters of loads: \
         M ω̇ + b − Π = Y π + r. First moments and inertia of a body are about the point from which its \
         centre is placed, if both are fixed in the body, and about its centre else.";
}

/// An argument in addition to time, parameters, state and inputs.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Own {
    /// Weights of the rates and their derivatives.
    Weights,
    /// Weights of the outputs and their derivatives.
    OutputWeights,
    /// Pseudo-accelerations.
    Accelerations,
}

impl Own {
    /// Name of the argument.
    pub fn name(self) -> &'static str {
        match self {
            Self::Weights | Self::OutputWeights => "weights",
            Self::Accelerations => "accelerations",
        }
    }
}

impl FunctionKind {
    /// The number of kinds.
    pub(crate) const COUNT: usize = ROWS.len();

    /// All functions that the program of a model can have, in the order of emitted code.
    pub const ALL: [Self; 24] = those(Purpose::Estimation);

    /// The functions of every model. The others, required for estimation, are as long as all of these together.
    pub const STANDARD: [Self; 21] = those(Purpose::Standard);

    /// [`Self::STANDARD`] for a mechanism with a number of parameters: with more than 64, derivatives with
    /// respect to them are omitted unless requested.
    pub fn standard(parameters: usize) -> Vec<Self> {
        const MOST_PARAMETERS: usize = 64;
        let is_made =
            |kind: &Self| parameters <= MOST_PARAMETERS || *kind != Self::ParameterJacobian;
        Self::STANDARD.into_iter().filter(is_made).collect()
    }

    /// Whether a mechanism may have no such results.
    pub fn may_lack(self) -> bool {
        matches!(
            self,
            Self::Outputs
                | Self::Switches
                | Self::TimeFunctions
                | Self::Crossings
                | Self::PositionConstraints
                | Self::Contacts
                | Self::Systems
                | Self::OutputJacobians
                | Self::OutputAdjoint
                | Self::Regressor
        )
    }

    /// The argument in addition to time, parameters, state and inputs.
    pub fn takes(self) -> Option<Own> {
        match self {
            Self::Adjoint => Some(Own::Weights),
            Self::OutputAdjoint => Some(Own::OutputWeights),
            Self::InverseDynamics | Self::InverseDynamicsJacobians | Self::Regressor => {
                Some(Own::Accelerations)
            }
            _ => None,
        }
    }

    /// Name of the emitted function.
    pub fn name(self) -> &'static str {
        self.row().name
    }

    /// Name of the result struct, if it returns several arrays.
    pub fn result_struct(self) -> &'static str {
        self.row().structure
    }

    /// Its results, one sentence.
    pub fn about(self) -> &'static str {
        self.row().about
    }

    /// The results that [`Model`](appell_runtime::model::Model) has, in its order.
    pub fn model_results(self) -> &'static [&'static str] {
        self.row().results
    }

    fn row(self) -> &'static Row {
        &ROWS[self as usize]
    }
}

/// The functions for a purpose. Their number is checked by the compiler.
const fn those<const N: usize>(purpose: Purpose) -> [FunctionKind; N] {
    let mut kinds = [FunctionKind::Rates; N];
    let mut count = 0;
    let mut row = 0;
    while row < ROWS.len() {
        if ROWS[row].purpose as u8 >= purpose as u8 {
            kinds[count] = ROWS[row].kind;
            count += 1;
        }
        row += 1;
    }
    assert!(count == N, "the number of functions for this purpose");
    kinds
}
