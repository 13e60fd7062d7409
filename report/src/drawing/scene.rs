//! Points, axes of frames and bodies at one state.

use appell_runtime::positions::{Moving, Positions};
use appell_spec::mechanism::{BodyId, FrameId, List, Mechanism, PointId};

use super::placement::{Inertia, Placement, frames, points};
use super::space::{Matrix, Vector};
use appell_codegen::interpreted::InterpretedModel;
use appell_codegen::mechanics::Derivation;
use appell_codegen::mechanics::assemble;
use appell_codegen::mechanics::expressions::Setting;
use appell_codegen::mechanics::finding::Outcome;
use appell_codegen::mechanics::initial::InitialState;
use appell_codegen::program::{FunctionKind, Program};
use appell_codegen::symbolic::{Expr, Graph, SymbolId, evaluate};

/// Values that replace those of the spec, in SI.
pub struct Moment {
    /// Parameters.
    pub parameters: Vec<f64>,
    /// The state.
    pub states: Vec<f64>,
    /// The given values, for the caption.
    pub given: String,
}

/// A mechanism at one state, in the ground and in SI.
pub(super) struct Scene {
    /// By point; `None` where the position is not finite.
    pub(super) points: List<PointId, Option<Vector>>,
    /// By frame: its three axes; `None` where an angle is not finite.
    pub(super) frames: List<FrameId, Option<Matrix>>,
    /// By frame: the angles of its turns.
    pub(super) turns: List<FrameId, Vec<f64>>,
    /// By body: mass and, of rigid bodies, inertia with the axes of its components.
    pub(super) bodies: List<BodyId, (f64, Option<Inertia>)>,
    /// The axis of the ground normal to the plane of motion, if the motion is planar.
    pub(super) flat_across: Option<usize>,
    /// Whether the position constraints hold.
    pub(super) consistent: bool,
}

impl Scene {
    /// At the start of a simulation, with the values of the spec or others.
    pub(super) fn initial(
        mechanism: &Mechanism,
        mut derivation: Derivation,
        moment: Option<&Moment>,
    ) -> Outcome<Self> {
        let symbols = derivation.symbols.clone();
        let placement = {
            let (algebra, kinematics) = (&mut derivation.algebra, &derivation.kinematics);
            Placement::new(algebra, Setting::free(mechanism, &symbols), kinematics)?
        };
        let flat_across = placement.flat_across(&mut derivation.algebra);
        let kinds = [FunctionKind::PositionConstraints];
        let graph = derivation.algebra.graph.clone();
        let program = assemble::program(derivation, mechanism, &kinds)?;
        let state = InitialState::new(&graph, mechanism, &symbols);
        let mut values = state.values().to_vec();
        if let Some(moment) = moment {
            set(&mut values, &program.arguments.states, &moment.states);
            set(
                &mut values,
                &program.arguments.parameters,
                &moment.parameters,
            );
        }
        let consistent = close(program, &mut values);
        let scene = Self::at(&placement, &graph, &values, flat_across);
        Ok(Self {
            consistent,
            ..scene
        })
    }

    /// The scene for these values of the symbols, at which the position constraints hold.
    pub(super) fn at(
        placement: &Placement,
        graph: &Graph,
        values: &[f64],
        flat_across: Option<usize>,
    ) -> Self {
        let of = |exprs: &[Expr]| evaluate(graph, values, exprs);
        let frames = frames(&of(placement.frame_exprs()));
        Self {
            points: points(&of(placement.point_exprs())),
            turns: placement.turns.iter().map(|turns| of(turns)).collect(),
            bodies: placement.bodies_at(graph, values, &frames),
            frames,
            flat_across,
            consistent: true,
        }
    }
}

/// Solves the position constraints for the dependent coordinates, as a simulation does at its
/// start; false, with unchanged values, if it fails.
fn close(program: Program, values: &mut [f64]) -> bool {
    let arguments = program.arguments.clone();
    let model = InterpretedModel::new(program);
    let Some(mut positions) = Positions::of(&model) else {
        return true;
    };
    let [mut x, u, p] = [&arguments.states, &arguments.inputs, &arguments.parameters]
        .map(|symbols| -> Vec<f64> { symbols.iter().map(|s| values[index(*s)]).collect() });
    let closed = positions.restore(&model, 0.0, &mut x, &u, &p, Moving::Dependent);
    if closed.is_ok() {
        set(values, &arguments.states, &x);
    }
    closed.is_ok()
}

fn set(values: &mut [f64], symbols: &[SymbolId], numbers: &[f64]) {
    for (symbol, number) in symbols.iter().zip(numbers) {
        values[index(*symbol)] = *number;
    }
}

fn index(symbol: SymbolId) -> usize {
    symbol.0 as usize
}
