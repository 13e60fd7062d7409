//! Points, axes of frames and inertias of bodies, as expressions in the ground.

use appell_spec::mechanism::{BodyId, FrameId, GROUND, List, Mechanism, PointId};

use super::space::{Matrix, Vector};
use appell_codegen::mechanics::algebra::Algebra;
use appell_codegen::mechanics::expressions::Setting;
use appell_codegen::mechanics::finding::{Item, Outcome};
use appell_codegen::mechanics::frames::FrameVector;
use appell_codegen::mechanics::kinematics::Kinematics;
use appell_codegen::symbolic::vector::{IDENTITY, Vec3};
use appell_codegen::symbolic::{Expr, Graph, evaluate};

/// Largest distance that is drawn, so that squares of lengths stay finite.
const FARTHEST: f64 = 1e100;

/// Points and frames as expressions.
pub(super) struct Placement {
    /// By point.
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
