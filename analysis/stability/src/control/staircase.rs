//! The controllability staircase form, by orthogonal transformations.
//!
//! Q ᵀ A Q and Qᵀ B show from the top the states driven by the inputs directly, those driven by
//! these, and so on; the states below are uncontrollable:
//!
//! ```text
//! Qᵀ [B  A] Q = ⎡ B₁ │ A₁₁ A₁₂ … A₁ᵤ ⎤
//!               ⎢  0 │ A₂₁ A₂₂ … A₂ᵤ ⎥
//!               ⎢  0 │  0  A₃₂ … A₃ᵤ ⎥
//!               ⎣  0 │  0   0  … Aᵤᵤ ⎦
//! ```
//!
//! P. Van Dooren, *The generalized eigenstructure problem in linear system theory*, IEEE
//! Transactions on Automatic Control 26, 1981. Each rank is decided by Householder reflections with
//! column pivoting.

use nalgebra::{DMatrix, DVector};

use super::LinearSystem;

/// Entries below this, relative to the largest entry of a balanced system, count as rounding.
/// Equations of motion are exact to about 1e-14; weaker couplings cannot be used.
pub const NEGLIGIBLE: f64 = 1e-11;

/// A system in staircase form.
#[derive(Debug, Clone, PartialEq)]
pub struct Staircase {
    /// Q, orthogonal: the old states are Q times the new ones.
    pub q: DMatrix<f64>,
    /// Qᵀ A Q and Qᵀ B. Entries below the stairs are zero.
    pub system: LinearSystem,
    /// Heights of the stairs; their sum is the dimension of the controllable subspace.
    pub stairs: Vec<usize>,
}

impl Staircase {
    /// The staircase form of a system, which should be balanced.
    pub fn of(system: &LinearSystem) -> Self {
        let n = system.order();
        let mut form = Self {
            q: DMatrix::identity(n, n),
            system: system.clone(),
            stairs: Vec::new(),
        };
        let size = system.a.amax().max(system.b.amax());
        let mut stair = form.compress(From::Inputs, 0, NEGLIGIBLE * size);
        while stair > 0 {
            form.stairs.push(stair);
            let done = form.controllable();
            if done == n {
                break;
            }
            stair = form.compress(From::States(done - stair), done, NEGLIGIBLE * size);
        }
        form
    }

    /// Dimension of the controllable subspace.
    pub fn controllable(&self) -> usize {
        self.stairs.iter().sum()
    }

    /// An orthonormal basis of the controllable subspace, as columns.
    #[must_use]
    pub fn basis(&self) -> DMatrix<f64> {
        self.q.columns(0, self.controllable()).into_owned()
    }

    /// The controllable part.
    #[must_use]
    pub fn controllable_part(&self) -> LinearSystem {
        let r = self.controllable();
        LinearSystem {
            a: self.system.a.view((0, 0), (r, r)).into_owned(),
            b: self.system.b.rows(0, r).into_owned(),
        }
    }

    /// A of the uncontrollable part.
    #[must_use]
    pub fn uncontrollable_part(&self) -> DMatrix<f64> {
        let (r, rest) = (self.controllable(), self.q.ncols() - self.controllable());
        self.system.a.view((r, r), (rest, rest)).into_owned()
    }

    /// Reflects the rows from `top` on so that the columns between them and the stair above end in
    /// an upper triangle; its height is the rank of the coupling.
    fn compress(&mut self, from: From, top: usize, negligible: f64) -> usize {
        let mut columns: Vec<usize> = match from {
            From::Inputs => (0..self.system.inputs()).collect(),
            From::States(start) => (start..top).collect(),
        };
        let mut lead = top;
        while lead < self.q.ncols() {
            let below = |column: usize| from.matrix(&self.system).view_range(lead.., column).norm();
            let largest = columns.iter().copied().enumerate();
            let largest = largest.max_by(|a, b| below(a.1).total_cmp(&below(b.1)));
            let Some((place, column)) = largest.filter(|&(_, column)| below(column) > negligible)
            else {
                break;
            };
            columns.remove(place);
            let direction = from.matrix(&self.system).view_range(lead.., column);
            let direction = direction.column(0).into_owned();
            self.reflect(lead, &direction);
            from.matrix_mut(&mut self.system)
                .view_range_mut(lead + 1.., column)
                .fill(0.0);
            lead += 1;
        }
        // The remainder of the other columns is negligible.
        for column in columns {
            from.matrix_mut(&mut self.system)
                .view_range_mut(lead.., column)
                .fill(0.0);
        }
        lead - top
    }

    /// The Householder reflection of the states from `lead` on that turns `direction` into the
    /// first of them.
    fn reflect(&mut self, lead: usize, direction: &DVector<f64>) {
        let mut v = direction.clone();
        v[0] += v.norm().copysign(v[0]);
        let v = v.normalize();
        let LinearSystem { a, b } = &mut self.system;
        for matrix in [&mut *a, b] {
            let mut rows = matrix.rows_mut(lead, v.len());
            let along = rows.tr_mul(&v);
            rows.ger(-2.0, &v, &along, 1.0);
        }
        for matrix in [a, &mut self.q] {
            let mut columns = matrix.columns_mut(lead, v.len());
            let along = &columns * &v;
            columns.ger(-2.0, &along, &v, 1.0);
        }
    }
}

/// What drives the rows that are being compressed.
#[derive(Debug, Clone, Copy)]
enum From {
    Inputs,
    /// The states of the stair above, which begins here.
    States(usize),
}

impl From {
    fn matrix(self, system: &LinearSystem) -> &DMatrix<f64> {
        match self {
            Self::Inputs => &system.b,
            Self::States(_) => &system.a,
        }
    }

    fn matrix_mut(self, system: &mut LinearSystem) -> &mut DMatrix<f64> {
        match self {
            Self::Inputs => &mut system.b,
            Self::States(_) => &mut system.a,
        }
    }
}
