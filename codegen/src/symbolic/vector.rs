//! Vectors of three components and their products.

use super::Graph;
use super::node::Expr;

/// Three components in a frame.
pub type Vec3 = [Expr; 3];
/// A 3×3 matrix, row by row.
pub type Mat3 = [[Expr; 3]; 3];

/// The zero vector.
pub const ZERO: Vec3 = [Graph::ZERO; 3];
/// The unit matrix.
pub const IDENTITY: Mat3 = [
    [Graph::ONE, Graph::ZERO, Graph::ZERO],
    [Graph::ZERO, Graph::ONE, Graph::ZERO],
    [Graph::ZERO, Graph::ZERO, Graph::ONE],
];

impl Graph {
    /// `a + b`
    pub fn add3(&mut self, a: Vec3, b: Vec3) -> Vec3 {
        [
            self.add(a[0], b[0]),
            self.add(a[1], b[1]),
            self.add(a[2], b[2]),
        ]
    }

    /// `a - b`
    pub fn sub3(&mut self, a: Vec3, b: Vec3) -> Vec3 {
        [
            self.sub(a[0], b[0]),
            self.sub(a[1], b[1]),
            self.sub(a[2], b[2]),
        ]
    }

    /// `-a`
    pub fn neg3(&mut self, a: Vec3) -> Vec3 {
        a.map(|c| self.neg(c))
    }

    /// `s a`
    pub fn scale3(&mut self, s: Expr, a: Vec3) -> Vec3 {
        a.map(|c| self.mul(s, c))
    }

    /// `a · b`
    pub fn dot(&mut self, a: Vec3, b: Vec3) -> Expr {
        let products = [
            self.mul(a[0], b[0]),
            self.mul(a[1], b[1]),
            self.mul(a[2], b[2]),
        ];
        self.sum(&products)
    }

    /// `a × b`
    pub fn cross(&mut self, a: Vec3, b: Vec3) -> Vec3 {
        let mut minor = |i: usize, j: usize| {
            let (first, second) = (self.mul(a[i], b[j]), self.mul(a[j], b[i]));
            self.sub(first, second)
        };
        [minor(1, 2), minor(2, 0), minor(0, 1)]
    }

    /// `A v`
    pub fn mat_vec(&mut self, a: &Mat3, v: Vec3) -> Vec3 {
        [self.dot(a[0], v), self.dot(a[1], v), self.dot(a[2], v)]
    }

    /// `Aᵀ v`
    pub fn transposed_mat_vec(&mut self, a: &Mat3, v: Vec3) -> Vec3 {
        self.mat_vec(&transpose(a), v)
    }

    /// `A B`
    pub fn mat_mat(&mut self, a: &Mat3, b: &Mat3) -> Mat3 {
        let columns = transpose(b);
        let mut product = IDENTITY;
        for (i, row) in product.iter_mut().enumerate() {
            for (j, entry) in row.iter_mut().enumerate() {
                *entry = self.dot(a[i], columns[j]);
            }
        }
        product
    }
}

/// `Aᵀ`
pub fn transpose(a: &Mat3) -> Mat3 {
    [0, 1, 2].map(|j| [a[0][j], a[1][j], a[2][j]])
}
