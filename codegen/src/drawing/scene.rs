//! Where everything is at the initial state: points, axes of frames, bodies.

use appell_runtime::positions::{Moving, Positions};
use appell_spec::mechanism::{GROUND, Mechanism};

use super::space::{Matrix, Vector};
use crate::interpreted::InterpretedModel;
use crate::mechanics::Derivation;
use crate::mechanics::assemble;
use crate::mechanics::finding::Outcome;
use crate::mechanics::frames::FrameVector;
use crate::mechanics::initial::InitialState;
use crate::program::{FunctionKind, Program};
use crate::symbolic::vector::{IDENTITY, Vec3};
use crate::symbolic::{Graph, SymbolId, evaluate};

/// Farther away nothing is drawn: squares of lengths stay finite.
const FARTHEST: f64 = 1e100;

/// A mechanism at its initial state, in the ground and in SI.
pub(super) struct Scene {
    /// By point; `None` where the position is not finite.
    pub(super) points: Vec<Option<Vector>>,
    /// By frame: its three axes; `None` where an angle is not finite.
    pub(super) frames: Vec<Option<Matrix>>,
    /// By body: mass and, of rigid bodies, inertia with the axes of its components.
    pub(super) bodies: Vec<(f64, Option<Inertia>)>,
    /// The axis of the ground that no point ever leaves the plane across, if there is one.
    pub(super) flat_across: Option<usize>,
    /// Whether the position constraints hold.
    pub(super) consistent: bool,
}

/// Inertia about the centre of mass.
pub(super) struct Inertia {
    /// Axes of its components.
    pub(super) axes: Matrix,
    /// Components.
    pub(super) matrix: Matrix,
}

/// The same as expressions.
struct Expressions {
    points: Vec<Vec3>,
    frames: Vec<[Vec3; 3]>,
}

impl Scene {
    /// Evaluates positions and turns where a simulation would start.
    pub(super) fn new(mechanism: &Mechanism, mut derivation: Derivation) -> Outcome<Self> {
        let expressions = Expressions::new(mechanism, &mut derivation);
        let flat_across = expressions.flat_across(&mut derivation);
        let bodies = derivation.bodies.clone();
        let symbols = derivation.symbols.clone();
        let kinds = [FunctionKind::PositionConstraints];
        let program = assemble::program(derivation, mechanism, &kinds)?;
        let graph = program.graph.clone();
        let state = InitialState::new(&graph, mechanism, &symbols);
        let mut values = state.values().to_vec();
        let consistent = close(program, &mut values);

        let vector = |v: Vec3| -> Option<Vector> {
            let numbers = evaluate(&graph, &values, &v);
            let near = numbers.iter().all(|number| number.abs() < FARTHEST);
            near.then(|| [numbers[0], numbers[1], numbers[2]])
        };
        let matrix = |[a, b, c]: [Vec3; 3]| Some([vector(a)?, vector(b)?, vector(c)?]);
        let frames: Vec<Option<Matrix>> = expressions.frames.into_iter().map(matrix).collect();
        let bodies = bodies.iter().map(|body| {
            let mass = evaluate(&graph, &values, &[body.mass])[0];
            let inertia = body.rotation.as_ref().and_then(|rotation| {
                Some(Inertia {
                    axes: frames[rotation.velocity.frame]?,
                    matrix: matrix(rotation.inertia)?,
                })
            });
            (mass, inertia)
        });
        Ok(Self {
            bodies: bodies.collect(),
            points: expressions.points.into_iter().map(vector).collect(),
            frames,
            flat_across,
            consistent,
        })
    }
}

impl Expressions {
    fn new(mechanism: &Mechanism, derivation: &mut Derivation) -> Self {
        let (kinematics, graph) = (&derivation.kinematics, &mut derivation.algebra.graph);
        let points = (0..mechanism.points.len())
            .map(|point| kinematics.position(graph, mechanism, point))
            .collect();
        let axes = |frame| {
            IDENTITY.map(|v| {
                let axis = FrameVector { frame, v };
                kinematics.frames.express(graph, axis, GROUND)
            })
        };
        let frames = (0..mechanism.frames.len()).map(axes).collect();
        Self { points, frames }
    }

    /// The first axis along which all positions vanish identically. Across y comes first: most
    /// planar motions are written in x and z.
    fn flat_across(&self, derivation: &mut Derivation) -> Option<usize> {
        let algebra = &mut derivation.algebra;
        let mut vanishes = |v: &Vec3, axis: usize| {
            v[axis] == Graph::ZERO || algebra.test.is_zero(&algebra.graph, v[axis])
        };
        [1, 0, 2]
            .into_iter()
            .find(|&axis| self.points.iter().all(|v| vanishes(v, axis)))
    }
}

/// Moves the dependent coordinates until the position constraints hold, as a simulation does before
/// it starts; false, with the values as they were, where it cannot.
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
        for (symbol, value) in arguments.states.iter().zip(x) {
            values[index(*symbol)] = value;
        }
    }
    closed.is_ok()
}

fn index(symbol: SymbolId) -> usize {
    symbol.0 as usize
}
