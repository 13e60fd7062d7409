//! What the derivation hands to scheduling and emission: arguments, functions, expressions.

use appell_runtime::model::ModelInfo;

use crate::symbolic::{Expr, Graph, SymbolId};

/// The functions of one mechanism.
#[derive(Debug, Clone)]
pub struct Program {
    /// Names, units, defaults; the emitted model and the in-process model return exactly this.
    pub info: ModelInfo,
    /// Name of the spec file, for comments.
    pub file: String,
    /// Owner of all expressions.
    pub graph: Graph,
    /// The symbols that expressions may contain, in the order of `info`.
    pub arguments: Arguments,
    /// Functions, in the order in which a reader wants them.
    pub functions: Vec<Function>,
}

impl Program {
    /// How many values time alone switches.
    pub fn switch_len(&self) -> usize {
        let mut functions = self.functions.iter();
        let switches = functions.find(|function| function.kind == FunctionKind::Switches);
        switches.map_or(0, |function| {
            function
                .results
                .iter()
                .map(|array| array.entries.len())
                .sum()
        })
    }
}

/// Symbols of the arguments.
#[derive(Debug, Clone)]
pub struct Arguments {
    /// Time.
    pub time: SymbolId,
    /// States: pseudo-velocities, then coordinates.
    pub states: Vec<SymbolId>,
    /// Inputs, then signals and their rates.
    pub inputs: Vec<SymbolId>,
    /// Parameters.
    pub parameters: Vec<SymbolId>,
}

/// A function to emit or compile.
#[derive(Debug, Clone)]
pub struct Function {
    /// Which one.
    pub kind: FunctionKind,
    /// What it returns, at least one array.
    pub results: Vec<Array>,
}

/// The functions every model has. The order is the order in emitted code.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum FunctionKind {
    /// q̇(q, ω): results `coordinate_rates`.
    Kinematics,
    /// S split by body at the actual accelerations: results `total`, then one per body.
    AccelerationEnergy,
    /// M: result `mass_matrix`.
    MassMatrix,
    /// b: result `bias`.
    Bias,
    /// Π: result `generalized_forces`.
    GeneralizedForces,
    /// ẋ: result `rates`.
    Rates,
    /// ẋ, A, B: results `rates`, `a`, `b`.
    Jacobians,
    /// ẋ, A, B, P: results `rates`, `a`, `b`, `p`.
    AllJacobians,
    /// Results `kinetic`, `potential`, `power`.
    Energies,
    /// Constraint rows with the generalised velocities put in: result `residual`.
    ConstraintResidual,
    /// Reactions in the ground: result `forces`, three columns.
    ConstraintForces,
    /// Outputs of the spec: result `outputs`.
    Outputs,
    /// What time alone switches, where anything does: result `switches`.
    Switches,
}

/// An array of expressions.
#[derive(Debug, Clone)]
pub struct Array {
    /// Its name.
    pub name: String,
    /// How its entries are labelled.
    pub layout: Layout,
    /// Entries, row by row.
    pub entries: Vec<Expr>,
}

/// The shape of an array, and what labels its entries.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Layout {
    /// One number.
    Scalar,
    /// One number per state.
    State,
    /// One number per pseudo-velocity.
    Speeds,
    /// One number per coordinate.
    Coordinates,
    /// One number per output.
    Outputs,
    /// A plain vector.
    Vector(usize),
    /// A plain matrix of so many rows and columns.
    Matrix(usize, usize),
}
