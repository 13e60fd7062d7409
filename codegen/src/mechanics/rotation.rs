//! One rotation between the axes of two frames: components of vectors and of symmetric tensors in both, and
//! their derivatives.

use super::algebra::Algebra;
use super::quaternion::Attitude;
use crate::symbolic::vector::{self, Mat3, Vec3, transpose};
use crate::symbolic::{Expr, Graph};

/// From the parent axes to the child axes.
#[derive(Debug, Clone)]
pub(super) enum Rotation {
    /// About a coordinate axis.
    Turn(Turn),
    /// By a quaternion.
    Attitude(Attitude),
}

/// A rotation about a coordinate axis.
#[derive(Debug, Clone, Copy)]
pub(super) struct Turn {
    /// Which axis.
    pub(super) axis: usize,
    /// The angle.
    pub(super) angle: Expr,
    /// Rate of the angle.
    pub(super) rate: Expr,
    /// Sine of the angle.
    pub(super) sin: Expr,
    /// Its cosine.
    pub(super) cos: Expr,
}

impl Rotation {
    /// R v: the components in the parent.
    pub(super) fn in_parent(&self, graph: &mut Graph, v: Vec3) -> Vec3 {
        match self {
            Self::Turn(turn) => turn.rotate(graph, v, turn.sin, turn.cos),
            Self::Attitude(attitude) => graph.mat_vec(&attitude.matrix, v),
        }
    }

    /// Rᵀ v: the components in the child.
    pub(super) fn in_child(&self, graph: &mut Graph, v: Vec3) -> Vec3 {
        match self {
            Self::Turn(turn) => {
                let sin = graph.neg(turn.sin);
                turn.rotate(graph, v, sin, turn.cos)
            }
            Self::Attitude(attitude) => graph.transposed_mat_vec(&attitude.matrix, v),
        }
    }

    /// R T Rᵀ: the components of a tensor in the parent.
    pub(super) fn tensor_in_parent(&self, graph: &mut Graph, t: &Mat3) -> Mat3 {
        match self {
            Self::Turn(turn) => turn.rotate_tensor(graph, t),
            Self::Attitude(attitude) => {
                let half = graph.mat_mat(&attitude.matrix, t);
                graph.mat_mat(&half, &transpose(&attitude.matrix))
            }
        }
    }

    /// Angular velocity of the rotation, in the child.
    pub(super) fn rate(&self) -> Vec3 {
        match self {
            Self::Turn(turn) => {
                let mut w = vector::ZERO;
                w[turn.axis] = turn.rate;
                w
            }
            Self::Attitude(attitude) => attitude.w,
        }
    }

    /// The components of its angular velocity.
    pub(super) fn rates(&mut self) -> &mut [Expr] {
        match self {
            Self::Turn(turn) => std::slice::from_mut(&mut turn.rate),
            Self::Attitude(attitude) => &mut attitude.w,
        }
    }

    /// `(∂R/∂z) v`
    pub(super) fn change_in_parent(&self, algebra: &mut Algebra, v: Vec3, z: Expr) -> Vec3 {
        self.change(algebra, z).in_parent(&mut algebra.graph, v)
    }

    /// `(∂Rᵀ/∂z) v`
    pub(super) fn change_in_child(&self, algebra: &mut Algebra, v: Vec3, z: Expr) -> Vec3 {
        self.change(algebra, z).in_child(&mut algebra.graph, v)
    }

    /// ∂R/∂z in the same representation as a rotation.
    fn change(&self, algebra: &mut Algebra, z: Expr) -> Change {
        match self {
            Self::Turn(turn) => Change::Turn(Turn {
                sin: algebra.derivative(turn.sin, z),
                cos: algebra.derivative(turn.cos, z),
                ..*turn
            }),
            Self::Attitude(attitude) => {
                let row = |row: Vec3| row.map(|entry| algebra.derivative(entry, z));
                Change::Matrix(attitude.matrix.map(row))
            }
        }
    }
}

/// The derivative of a rotation.
enum Change {
    Turn(Turn),
    Matrix(Mat3),
}

impl Change {
    fn in_parent(self, graph: &mut Graph, v: Vec3) -> Vec3 {
        match self {
            Self::Turn(turn) => turn.rotate_plane(graph, v, turn.sin, turn.cos),
            Self::Matrix(matrix) => graph.mat_vec(&matrix, v),
        }
    }

    fn in_child(self, graph: &mut Graph, v: Vec3) -> Vec3 {
        match self {
            Self::Turn(turn) => {
                let sin = graph.neg(turn.sin);
                turn.rotate_plane(graph, v, sin, turn.cos)
            }
            Self::Matrix(matrix) => graph.transposed_mat_vec(&matrix, v),
        }
    }
}

impl Turn {
    /// The two axes that change, in cyclic order.
    fn plane(&self) -> [usize; 2] {
        [(self.axis + 1) % 3, (self.axis + 2) % 3]
    }

    fn rotate(&self, graph: &mut Graph, v: Vec3, sin: Expr, cos: Expr) -> Vec3 {
        let mut rotated = self.rotate_plane(graph, v, sin, cos);
        rotated[self.axis] = v[self.axis];
        rotated
    }

    /// Rotates the components perpendicular to the axis.
    fn rotate_plane(&self, graph: &mut Graph, v: Vec3, sin: Expr, cos: Expr) -> Vec3 {
        let [i, j] = self.plane();
        let mut rotated = vector::ZERO;
        let (ci, sj) = (graph.mul(cos, v[i]), graph.mul(sin, v[j]));
        rotated[i] = graph.sub(ci, sj);
        let (si, cj) = (graph.mul(sin, v[i]), graph.mul(cos, v[j]));
        rotated[j] = graph.add(si, cj);
        rotated
    }

    /// With `k = s (Tᵢᵢ − Tⱼⱼ) + c (Tᵢⱼ + Tⱼᵢ)`: `Tᵢᵢ − s k`, `Tⱼⱼ + s k`, `c k − Tⱼᵢ` and `c k − Tᵢⱼ`.
    fn rotate_tensor(&self, graph: &mut Graph, t: &Mat3) -> Mat3 {
        let [i, j] = self.plane();
        let difference = graph.sub(t[i][i], t[j][j]);
        let along = graph.mul(self.sin, difference);
        let sum = graph.add(t[i][j], t[j][i]);
        let across = graph.mul(self.cos, sum);
        let k = graph.add(along, across);
        let (sk, ck) = (graph.mul(self.sin, k), graph.mul(self.cos, k));
        let row = self.rotate(graph, t[self.axis], self.sin, self.cos);
        let column = self.rotate(graph, t.map(|row| row[self.axis]), self.sin, self.cos);
        let mut rotated = *t;
        rotated[self.axis] = row;
        for (row, entry) in rotated.iter_mut().zip(column) {
            row[self.axis] = entry;
        }
        rotated[i][i] = graph.sub(t[i][i], sk);
        rotated[j][j] = graph.add(t[j][j], sk);
        rotated[i][j] = graph.sub(ck, t[j][i]);
        rotated[j][i] = graph.sub(ck, t[i][j]);
        rotated
    }
}
