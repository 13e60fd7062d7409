//! The equations of steady motions: the rates of the essential states are zero, but for quaternions that turn, and
//! the conditions hold.

use nalgebra::{DMatrix, DVector};

use super::cyclic::Structure;
use super::newton::Equations;
use super::{Condition, differences};
use crate::point::Point;
use crate::term::Term;
use appell_runtime::model::Model;

/// F(z) = 0 for the unknowns z, each in units of its scale.
#[derive(Clone)]
pub(crate) struct SteadyEquations<'a> {
    pub(crate) model: &'a dyn Model,
    pub(crate) structure: &'a Structure,
    /// Values of the known quantities.
    pub(crate) base: Point,
    /// Essential states, then inputs and parameters that are left free.
    pub(crate) unknowns: Vec<Term>,
    pub(crate) scales: Vec<f64>,
    pub(crate) conditions: Vec<Condition>,
}

/// Derivatives of a model at a point.
struct Derivatives {
    rates: Vec<f64>,
    a: Vec<f64>,
    b: Vec<f64>,
    p: Vec<f64>,
}

impl<'a> SteadyEquations<'a> {
    pub(crate) fn new(
        model: &'a dyn Model,
        structure: &'a Structure,
        base: Point,
        free: &[Term],
        conditions: Vec<Condition>,
    ) -> Self {
        let states = structure.essential.iter().map(|&state| Term::State(state));
        let unknowns: Vec<Term> = states.chain(free.iter().copied()).collect();
        let scale = |term: &Term| term.scale(model.info(), &base);
        let scales = unknowns.iter().map(scale).collect();
        Self {
            model,
            structure,
            base,
            unknowns,
            scales,
            conditions,
        }
    }

    pub(crate) fn unknowns_of(&self, point: &Point) -> DVector<f64> {
        let scaled = |(term, scale): (&Term, &f64)| term.value(self.model, point) / scale;
        let values = self.unknowns.iter().zip(&self.scales).map(scaled);
        DVector::from_iterator(self.unknowns.len(), values)
    }

    /// The point of given unknowns.
    pub(crate) fn point(&self, z: &DVector<f64>) -> Point {
        let mut point = self.base.clone();
        for ((term, scale), z) in self.unknowns.iter().zip(&self.scales).zip(z.iter()) {
            if let Some(place) = term.place(&mut point) {
                *place = z * scale;
            }
        }
        point
    }

    /// Value and gradient of a term in the unknowns.
    pub(crate) fn term(&self, term: Term, z: &DVector<f64>) -> (f64, DVector<f64>) {
        let point = self.point(z);
        let derivatives = self.derivatives(&point);
        self.term_at(term, &point, &derivatives)
    }

    fn derivatives(&self, point: &Point) -> Derivatives {
        let info = self.model.info();
        let (n, m, k) = (info.state_len(), info.input_len(), info.parameter_len());
        let mut d = Derivatives {
            rates: vec![0.0; n],
            a: vec![0.0; n * n],
            b: vec![0.0; n * m],
            p: Vec::new(),
        };
        self.model
            .jacobians(point.at(), &mut d.rates, &mut d.a, &mut d.b);
        let in_parameters = |term: &Term| matches!(term, Term::Parameter(_));
        if self.unknowns.iter().any(in_parameters) {
            d.p = vec![0.0; n * k];
            self.model.parameter_jacobian(point.at(), &mut d.p);
        }
        self.hold(point, &mut d);
        d
    }

    /// Takes out of the rates that quaternions may turn. What this leaves out of the derivatives vanishes with the
    /// rates.
    fn hold(&self, point: &Point, d: &mut Derivatives) {
        let turning = &self.structure.turning;
        if turning.len() == 0 {
            return;
        }
        let n = d.rates.len();
        let turn = turning.turn(&point.x, &d.rates);
        d.rates = turning.still(&point.x, &d.rates);
        for (entry, turned) in d.a.iter_mut().zip(turn.transpose().iter()) {
            *entry -= turned;
        }
        for matrix in [&mut d.a, &mut d.b, &mut d.p] {
            let mut columns = DMatrix::from_row_slice(n, matrix.len() / n, matrix);
            turning.across(&point.x, &mut columns);
            matrix.copy_from_slice(columns.transpose().as_slice());
        }
    }

    /// Gradient of the rate of a state.
    fn rate_gradient<'d>(
        &'d self,
        state: usize,
        d: &'d Derivatives,
    ) -> impl Iterator<Item = f64> + 'd {
        let info = self.model.info();
        let (n, m, k) = (info.state_len(), info.input_len(), info.parameter_len());
        let slope = move |term: &Term| match *term {
            Term::State(i) => d.a[state * n + i],
            Term::Input(i) => d.b[state * m + i],
            Term::Parameter(i) => d.p[state * k + i],
            Term::Rate(_) | Term::Output(_) => 0.0,
        };
        let scaled = self.unknowns.iter().zip(&self.scales);
        scaled.map(move |(term, scale)| slope(term) * scale)
    }

    fn term_at(&self, term: Term, point: &Point, d: &Derivatives) -> (f64, DVector<f64>) {
        let len = self.unknowns.len();
        match term {
            Term::Rate(state) => {
                let gradient = DVector::from_iterator(len, self.rate_gradient(state, d));
                (d.rates[state], gradient)
            }
            Term::Output(output) => self.output(output, point),
            _ => {
                let derivative = |i: usize| {
                    if self.unknowns[i] == term {
                        self.scales[i]
                    } else {
                        0.0
                    }
                };
                let gradient = DVector::from_fn(len, |i, _| derivative(i));
                (term.value(self.model, point), gradient)
            }
        }
    }

    /// Value of an output, and its gradient by differences, as models do not provide it.
    fn output(&self, output: usize, point: &Point) -> (f64, DVector<f64>) {
        let z = self.unknowns_of(point);
        let gradient = DVector::from_fn(z.len(), |i, _| {
            differences::slope(|by| {
                let mut z = z.clone();
                z[i] += by;
                self.point(&z).outputs(self.model)[output]
            })
        });
        (point.outputs(self.model)[output], gradient)
    }
}

impl Equations for SteadyEquations<'_> {
    fn evaluate(&self, z: &DVector<f64>) -> (DVector<f64>, DMatrix<f64>) {
        let point = self.point(z);
        let d = self.derivatives(&point);
        let (info, len) = (self.model.info(), z.len());
        let constraints = self.model.dependent_coordinates().len();
        let essential = &self.structure.essential;
        // Newton steps are orthogonal to the symmetric rotations.
        let turned = self.structure.turning.directions(&point.x);
        let rows = essential.len() + constraints + turned.ncols() + self.conditions.len();
        let mut values = DVector::zeros(rows);
        let mut jacobian = DMatrix::zeros(rows, len);
        for (row, &state) in essential.iter().enumerate() {
            values[row] = d.rates[state];
            for (column, slope) in self.rate_gradient(state, &d).enumerate() {
                jacobian[(row, column)] = slope;
            }
        }
        if constraints > 0 {
            let coordinates = info.coordinate_quantities().len();
            let mut residual = vec![0.0; constraints];
            let mut slopes = vec![0.0; constraints * coordinates];
            self.model
                .position_constraints(point.at(), &mut residual, &mut slopes);
            for (i, value) in residual.iter().enumerate() {
                let row = essential.len() + i;
                values[row] = *value;
                for (column, term) in self.unknowns.iter().enumerate() {
                    if let Term::State(state) = *term
                        && let Some(q) = state.checked_sub(info.speeds)
                    {
                        jacobian[(row, column)] = slopes[i * coordinates + q] * self.scales[column];
                    }
                }
            }
        }
        for (i, direction) in turned.column_iter().enumerate() {
            for (column, term) in self.unknowns.iter().enumerate() {
                if let Term::State(state) = *term {
                    jacobian[(essential.len() + constraints + i, column)] =
                        direction[state] * self.scales[column];
                }
            }
        }
        for (i, condition) in self.conditions.iter().enumerate() {
            let row = essential.len() + constraints + turned.ncols() + i;
            let (value, gradient) = self.term_at(condition.term, &point, &d);
            values[row] = value - condition.value;
            jacobian.row_mut(row).tr_copy_from(&gradient);
        }
        (values, jacobian)
    }
}
