//! Position constraints: residuals, Jacobian and dependent coordinates.

use appell_spec::Code;
use appell_spec::mechanism::{ConstraintId, ConstraintKind, CoordinateId, Mechanism};

use super::algebra::Algebra;
use super::expressions::Setting;
use super::finding::{Finding, Item, Outcome, defined, listed, unless_any};
use super::kinematics::Kinematics;
use super::motions::told;
use super::rank::{LinearRow, Standing, is_finite, standings};
use super::redundancy::omission;
use crate::symbolic::{Expr, Graph, Intervals};

/// The position constraints `f(q, t) = 0` of a mechanism.
#[derive(Debug, Clone, Default)]
pub struct Positions {
    /// The constraints, without redundant ones.
    pub constraints: Vec<ConstraintId>,
    /// Their names.
    pub names: Vec<String>,
    /// `f`, one per constraint.
    pub residual: Vec<Expr>,
    /// `∂f/∂q`, row by row.
    pub jacobian: Vec<Vec<Expr>>,
    /// The dependent coordinate of each constraint, no two equal.
    pub dependent: Vec<usize>,
    /// Omitted constraints.
    pub warnings: Vec<Finding>,
}

impl Positions {
    /// The constraints with their derivatives.
    pub fn new(
        algebra: &mut Algebra,
        setting: Setting<'_>,
        kinematics: &Kinematics,
        intervals: &mut Intervals,
    ) -> Outcome<Self> {
        let (mechanism, symbols) = (setting.mechanism, setting.symbols);
        let (mut positions, mut findings) = (Self::default(), Vec::new());
        for (index, constraint) in mechanism.constraints.entries() {
            let ConstraintKind::Position {
                zero, dependent, ..
            } = &constraint.kind
            else {
                continue;
            };
            let item = Item::Constraint(index);
            let residual = setting.lower_in(&mut algebra.graph, item, zero)?;
            let residual = defined(told(algebra, symbols, kinematics, residual), item)?;
            let row: Vec<Expr> = symbols
                .coordinates
                .iter()
                .map(|&q| algebra.derivative(residual, q))
                .collect();
            if let Some(others) = positions.repeated(algebra, intervals, residual, &row) {
                let reason = format!("follows from {}", listed(others));
                let warning = omission(&constraint.name, index, &reason);
                positions.warnings.push(warning);
                continue;
            }
            let named = dependent.map(CoordinateId::index);
            match positions.dependent_of(algebra, intervals, &row, named) {
                Some(coordinate) => positions.dependent.push(coordinate),
                None => findings.push(undetermined(mechanism, index, *dependent)),
            }
            positions.constraints.push(index);
            positions.names.push(constraint.name.clone());
            positions.residual.push(residual);
            positions.jacobian.push(row);
        }
        unless_any(findings)?;
        Ok(positions)
    }

    /// The names of the constraints of which this one, with its Jacobian row, is a linear combination in every
    /// configuration.
    fn repeated(
        &self,
        algebra: &Algebra,
        intervals: &mut Intervals,
        residual: Expr,
        slopes: &[Expr],
    ) -> Option<Vec<&str>> {
        let row = |(coefficients, &rest): (&[Expr], &Expr)| LinearRow {
            coefficients: coefficients.to_vec(),
            rest,
        };
        let before = self.jacobian.iter().map(Vec::as_slice).zip(&self.residual);
        let rows: Vec<LinearRow> = before.chain([(slopes, &residual)]).map(row).collect();
        // A copy, so that this test does not change the form of the equations.
        let mut algebra = algebra.clone();
        let Some(Standing::Redundant(sum)) = standings(&mut algebra, &rows).pop() else {
            return None;
        };
        let finite = |&(_, factor): &(usize, Expr)| is_finite(&algebra.graph, intervals, factor);
        if sum.is_empty() || !sum.iter().all(finite) {
            return None;
        }
        let names = sum.iter().map(|&(place, _)| self.names[place].as_str());
        Some(names.collect())
    }

    /// The coordinate named in the spec, or the free one with the safest coefficient.
    fn dependent_of(
        &self,
        algebra: &mut Algebra,
        intervals: &mut Intervals,
        row: &[Expr],
        named: Option<usize>,
    ) -> Option<usize> {
        let mut free = |&q: &usize| {
            let zero = row[q] == Graph::ZERO || algebra.test.is_zero(&algebra.graph, row[q]);
            !zero && !self.dependent.contains(&q)
        };
        if let Some(named) = named {
            return Some(named).filter(&mut free);
        }
        let candidates: Vec<usize> = (0..row.len()).filter(free).collect();
        let safe = |&&q: &&usize| intervals.cannot_vanish(&algebra.graph, row[q]);
        candidates.iter().find(safe).or(candidates.first()).copied()
    }
}

fn undetermined(
    mechanism: &Mechanism,
    index: ConstraintId,
    dependent: Option<CoordinateId>,
) -> Finding {
    let constraint = &mechanism.constraints[index].name;
    let (message, help) = match dependent {
        Some(q) => (
            format!(
                "`{constraint}` does not determine `{}`",
                mechanism.coordinates[q].label.name
            ),
            "name a coordinate that appears in the constraint, a different one for each constraint",
        ),
        None => (
            format!("`{constraint}` determines no further coordinate"),
            "remove the constraint, or use a coordinate in it",
        ),
    };
    Finding {
        code: Code::DependentConstraints,
        message,
        item: Item::Constraint(index),
        help: help.to_owned(),
    }
}
