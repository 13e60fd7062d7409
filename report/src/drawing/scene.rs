//! Points, axes of frames and bodies: as expressions in the ground, and at one state.

use appell_codegen::interpreted::InterpretedModel;
use appell_codegen::mechanics::algebra::Algebra;
use appell_codegen::mechanics::expressions::Setting;
use appell_codegen::mechanics::finding::{Item, Outcome};
use appell_codegen::mechanics::frames::FrameVector;
use appell_codegen::mechanics::initial::InitialState;
use appell_codegen::mechanics::kinematics::Kinematics;
use appell_codegen::mechanics::{Derivation, assemble};
use appell_codegen::program::{FunctionKind, Program};
use appell_codegen::symbolic::vector::{IDENTITY, Vec3};
use appell_codegen::symbolic::{Expr, Graph, SymbolId, evaluate};
use appell_runtime::positions::{Moving, Positions};
use appell_spec::mechanism::{BodyId, FrameId, GROUND, List, Mechanism, PointId};

use super::space::{Matrix, Vector};

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

pub(super) fn set(values: &mut [f64], symbols: &[SymbolId], numbers: &[f64]) {
    for (symbol, number) in symbols.iter().zip(numbers) {
        values[index(*symbol)] = *number;
    }
}

fn index(symbol: SymbolId) -> usize {
    symbol.0 as usize
}

/// Largest distance that is drawn, so that squares of lengths stay finite.
const FARTHEST: f64 = 1e100;

/// Points and frames as expressions.
pub(super) struct Placement {
    points: List<PointId, Vec3>,
    /// By frame: its three axes.
    frames: List<FrameId, [Vec3; 3]>,
    /// By frame: the angles of its turns.
    pub(super) turns: List<FrameId, Vec<Expr>>,
    /// By body: mass and, of rigid bodies, inertia.
    bodies: List<BodyId, (Expr, Option<Tensor>)>,
}

/// A matrix with the frame of its components.
type Tensor = (FrameId, [Vec3; 3]);

/// Inertia about the centre of mass.
pub(super) struct Inertia {
    /// The axes of the components.
    pub(super) axes: Matrix,
    /// Components.
    pub(super) matrix: Matrix,
}

impl Placement {
    pub(super) fn new(
        algebra: &mut Algebra,
        setting: Setting<'_>,
        kinematics: &Kinematics,
    ) -> Outcome<Self> {
        let (mechanism, graph) = (setting.mechanism, &mut algebra.graph);
        let points = mechanism.points.ids();
        let points = points.map(|point| kinematics.position(graph, point));
        let points = points.collect();
        let axes = |frame| {
            IDENTITY.map(|v| {
                let axis = FrameVector { frame, v };
                kinematics.frames.express(graph, axis, GROUND)
            })
        };
        let frames = mechanism.frames.ids().map(axes).collect();
        let mut turns = List::default();
        for (id, frame) in mechanism.frames.entries() {
            let angles = frame.turns.iter();
            let angles = angles.map(|turn| setting.lower_in(graph, Item::Frame(id), &turn.angle));
            turns.push(angles.collect::<Outcome<Vec<_>>>()?);
        }
        let mut bodies = List::default();
        for (index, body) in mechanism.bodies.entries() {
            let item = Item::Body(index);
            let mass = setting.lower_in(graph, item, &body.mass)?;
            let mut lowered = None;
            if let Some(inertia) = &body.inertia {
                let mut matrix = [[Graph::ZERO; 3]; 3];
                for (to, row) in matrix.iter_mut().zip(&inertia.matrix) {
                    *to = setting.lower_all_in(graph, item, row)?;
                }
                lowered = Some((inertia.frame, matrix));
            }
            bodies.push((mass, lowered));
        }
        Ok(Self {
            points,
            frames,
            turns,
            bodies,
        })
    }

    /// The first axis along which all positions vanish identically; y first, as most planar motions
    /// are written in x and z.
    pub(super) fn flat_across(&self, algebra: &mut Algebra) -> Option<usize> {
        let mut vanishes = |v: &Vec3, axis: usize| {
            v[axis] == Graph::ZERO || algebra.test.is_zero(&algebra.graph, v[axis])
        };
        [1, 0, 2]
            .into_iter()
            .find(|&axis| self.points.iter().all(|v| vanishes(v, axis)))
    }

    /// Three components a point.
    pub(super) fn point_exprs(&self) -> &[Expr] {
        self.points.as_flattened()
    }

    /// Three axes a frame.
    pub(super) fn frame_exprs(&self) -> &[Expr] {
        self.frames.as_flattened().as_flattened()
    }

    /// Values by body: mass and inertia, with these axes of frames.
    pub(super) fn bodies_at(
        &self,
        graph: &Graph,
        values: &[f64],
        frames: &List<FrameId, Option<Matrix>>,
    ) -> List<BodyId, (f64, Option<Inertia>)> {
        let value = |(mass, inertia): &(Expr, Option<Tensor>)| {
            let mass = evaluate(graph, values, &[*mass])[0];
            let inertia = inertia.as_ref().and_then(|(frame, components)| {
                Some(Inertia {
                    axes: frames[*frame]?,
                    matrix: matrix(&evaluate(graph, values, components.as_flattened()))?,
                })
            });
            (mass, inertia)
        };
        self.bodies.iter().map(value).collect()
    }
}

/// From the values of [`Placement::point_exprs`].
pub(super) fn points(numbers: &[f64]) -> List<PointId, Option<Vector>> {
    triples(numbers).collect()
}

/// From the values of [`Placement::frame_exprs`].
pub(super) fn frames(numbers: &[f64]) -> List<FrameId, Option<Matrix>> {
    numbers.chunks_exact(9).map(matrix).collect()
}

/// Vectors that are near enough to be drawn.
fn triples(numbers: &[f64]) -> impl Iterator<Item = Option<Vector>> {
    numbers.chunks_exact(3).map(|v| {
        let near = v.iter().all(|number| number.abs() < FARTHEST);
        near.then(|| [v[0], v[1], v[2]])
    })
}

fn matrix(numbers: &[f64]) -> Option<Matrix> {
    let mut rows = triples(numbers);
    let mut row = || rows.next().flatten();
    Some([row()?, row()?, row()?])
}
