//! Reactions of rows that are satisfied by geometry or implied by other rows.
//!
//! Such a row `r = Σ factor · other` does not affect the motion, but it has a reaction. The reaction does work
//! in an auxiliary motion outside the coordinates: a virtual translation of the connected part along the force.
//! In that motion the row is independent, `r - Σ factor · other = D c` for the rates c of the auxiliary
//! motions. If D is invertible, each row can be violated alone and its reaction follows. If D is singular,
//! there are more reactions than equations of equilibrium: the mechanism is statically indeterminate, and the
//! individual forces are not reported.

use appell_spec::Code;
use appell_spec::expr::Quantity;
use appell_spec::mechanism::{ConstraintId, CoordinateId, Mechanism, ORIGIN, PointId};

use super::algebra::{Algebra, scalar_product};
use super::finding::{Finding, Item};
use super::frames::{FrameVector, Frames};
use super::kinematics::{Carried, root_of};
use super::rank::{LinearRow, Standing, standings};
use super::row::{Reaction, Row};
use crate::symbolic::vector::Vec3;
use crate::symbolic::{Expr, Graph, Intervals};

/// A motion outside the coordinates, with its own auxiliary speed.
#[derive(Debug, Clone)]
pub struct AuxiliaryMotion {
    /// The points adjacent to the origin whose subtrees move.
    roots: Vec<PointId>,
    /// Its velocity per unit rate.
    along: FrameVector,
    /// The rate at which each row is violated, per unit rate.
    pub gains: Vec<Expr>,
    /// Its rate as a linear combination of the violation rates of the rows.
    pub rate: Vec<Expr>,
}

impl AuxiliaryMotion {
    /// The velocities of the moving subtrees for a given rate.
    pub fn at(&self, graph: &mut Graph, rate: Expr) -> Vec<Carried> {
        let v = graph.scale3(rate, self.along.v);
        let v = FrameVector::new(self.along.frame, v);
        let carried = |&root| Carried { root, v };
        self.roots.iter().map(carried).collect()
    }

    /// The rate at which a row is violated, per unit rate.
    fn gain(&self, algebra: &mut Algebra, frames: &Frames, row: &Row) -> Expr {
        if row.root.is_none_or(|root| !self.roots.contains(&root)) {
            return Graph::ZERO;
        }
        let frame = self.along.frame;
        let direction = frames.express(&mut algebra.graph, row.along, frame);
        let gain = algebra.graph.dot(direction, self.along.v);
        algebra.shortest(gain)
    }
}

/// Rows whose individual reactions are indeterminate.
#[derive(Debug, Clone)]
struct Indeterminate {
    /// The last of the rows.
    row: usize,
    /// Places whose reactions depend on the indeterminate distribution.
    places: Vec<usize>,
}

/// The auxiliary motions for the rows that follow from others.
#[derive(Debug, Clone, Default)]
pub struct AuxiliaryMotions {
    /// Motions that violate them.
    pub motions: Vec<AuxiliaryMotion>,
    indeterminate: Vec<Indeterminate>,
    /// Places of position constraints that a contact satisfies: the reaction is the contact's.
    silent: Vec<usize>,
}

/// A row of `D c = violations`.
struct Equation {
    gains: Vec<Expr>,
    violations: Vec<Expr>,
}

impl AuxiliaryMotions {
    /// Determines an auxiliary motion for each row that follows from others.
    pub fn new(
        algebra: &mut Algebra,
        mechanism: &Mechanism,
        frames: &Frames,
        intervals: &mut Intervals,
        rows: &[Row],
    ) -> Self {
        let mut auxiliary = Self::default();
        let following: Vec<usize> = (0..rows.len()).filter(|&r| !rows[r].is_active()).collect();
        for &row in &following {
            let Some(root) = rows[row].root else { continue };
            let mut motion = AuxiliaryMotion {
                roots: tied_to(mechanism, root),
                along: rows[row].along,
                gains: Vec::new(),
                rate: Vec::new(),
            };
            for row in rows {
                let gain = motion.gain(algebra, frames, row);
                motion.gains.push(gain);
            }
            auxiliary.motions.push(motion);
        }
        let mut solved: Vec<(usize, Equation)> = Vec::new();
        for &row in &following {
            let factors = factors(algebra, rows, row);
            let kept = |other: usize| factors[other] != Graph::ZERO && !rows[other].of_position;
            if rows[row].of_position && (0..rows.len()).any(kept) {
                auxiliary.silent.push(rows[row].reaction.place);
                continue;
            }
            let mut equation = auxiliary.equation(algebra, row, factors);
            for (motion, known) in &solved {
                equation.less(algebra, known, *motion);
            }
            match equation.pivot(algebra, intervals) {
                Some(motion) => {
                    equation.divide(algebra, motion);
                    for (_, known) in &mut solved {
                        known.less(algebra, &equation, motion);
                    }
                    solved.push((motion, equation));
                }
                None => auxiliary.indeterminate.push(Indeterminate {
                    row,
                    places: loaded_places(algebra, rows, &equation.violations),
                }),
            }
        }
        solved.sort_by_key(|(motion, _)| *motion);
        auxiliary.motions = solved
            .into_iter()
            .map(|(motion, equation)| AuxiliaryMotion {
                rate: equation.violations,
                ..auxiliary.motions[motion].clone()
            })
            .collect();
        auxiliary
    }

    /// Whether the reaction at a place is determined.
    pub fn tells(&self, place: usize) -> bool {
        let mut untold = self.indeterminate.iter().flat_map(|rows| &rows.places);
        untold.all(|&other| other != place) && !self.silent.contains(&place)
    }

    /// Warnings, one for each group of interdependent reactions.
    pub fn findings(&self, mechanism: &Mechanism, rows: &[Row], places: &[String]) -> Vec<Finding> {
        let mut groups: Vec<Indeterminate> = Vec::new();
        for indeterminate in &self.indeterminate {
            let mut joined = indeterminate.clone();
            groups.retain(|group| {
                let meets = group.places.iter().any(|p| joined.places.contains(p));
                if meets {
                    joined.places.extend(&group.places);
                }
                !meets
            });
            joined.places.sort_unstable();
            joined.places.dedup();
            groups.push(joined);
        }
        // Constraints that always hold are reported separately.
        groups.retain(|group| group.places.len() > 1);
        let finding = |group: Indeterminate| {
            let shares = |row: &&Row| group.places.contains(&row.reaction.place);
            let mut sharing: Vec<ConstraintId> = rows
                .iter()
                .filter(shares)
                .map(|row| row.constraint)
                .collect();
            sharing.dedup();
            let sharing = sharing.iter().map(|&c| &mechanism.constraints[c].name);
            let forces = group.places.iter().map(|&place| &places[place]);
            Finding {
                code: Code::UndeterminedReaction,
                message: format!(
                    "the reactions of {} are statically indeterminate: there are more of them than \
                     equations; {} are not reported",
                    listed(sharing),
                    listed(forces)
                ),
                item: Item::Constraint(rows[group.row].constraint),
                help: "the motion is not affected; to get the reactions keep one constraint for \
                       each prevented motion, or add a coordinate, such as a clearance or a \
                       deflection, that separates them"
                    .to_owned(),
            }
        };
        groups.into_iter().map(finding).collect()
    }

    /// `Σ gain · c = Σ violation` for a row that is a combination of others with `factors`.
    fn equation(&self, algebra: &mut Algebra, row: usize, factors: Vec<Expr>) -> Equation {
        let graph = &mut algebra.graph;
        let mut violations: Vec<Expr> = factors.into_iter().map(|f| graph.neg(f)).collect();
        violations[row] = Graph::ONE;
        let motions = self.motions.iter();
        let gains = motions.map(|motion| scalar_product(graph, &motion.gains, &violations));
        let gains: Vec<Expr> = gains.collect();
        Equation {
            gains: gains.into_iter().map(|e| algebra.shortest(e)).collect(),
            violations,
        }
    }
}

impl Equation {
    /// The simplest pivot that cannot vanish in the declared ranges.
    fn pivot(&self, algebra: &Algebra, intervals: &mut Intervals) -> Option<usize> {
        let graph = &algebra.graph;
        let candidates = (0..self.gains.len()).filter(|&k| self.gains[k] != Graph::ZERO);
        let safe = candidates.filter(|&k| intervals.cannot_vanish(graph, self.gains[k]));
        safe.min_by_key(|&k| (graph.operations(&[self.gains[k]]), k))
    }

    /// Eliminates a motion by an equation that is solved for it.
    fn less(&mut self, algebra: &mut Algebra, solved: &Self, motion: usize) {
        let share = self.gains[motion];
        if share == Graph::ZERO {
            return;
        }
        let own = self.gains.iter_mut().chain(&mut self.violations);
        for (value, &other) in own.zip(solved.gains.iter().chain(&solved.violations)) {
            let part = algebra.graph.mul(share, other);
            let rest = algebra.graph.sub(*value, part);
            *value = algebra.shortest(rest);
        }
    }

    /// Normalises the coefficient of a motion to 1.
    fn divide(&mut self, algebra: &mut Algebra, motion: usize) {
        let pivot = self.gains[motion];
        for value in self.gains.iter_mut().chain(&mut self.violations) {
            let quotient = algebra.graph.div(*value, pivot);
            *value = algebra.shortest(quotient);
        }
    }
}

/// A row as a combination of active rows: a factor for each of all rows.
fn factors(algebra: &mut Algebra, rows: &[Row], row: usize) -> Vec<Expr> {
    let mut factors = vec![Graph::ZERO; rows.len()];
    if rows[row].is_embedded() {
        return factors;
    }
    let mut places: Vec<usize> = (0..rows.len()).filter(|&r| rows[r].is_active()).collect();
    places.push(row);
    let linear: Vec<LinearRow> = places.iter().map(|&place| rows[place].linear()).collect();
    if let Some(Standing::Redundant(sum)) = standings(algebra, &linear).pop() {
        for (other, factor) in sum {
            factors[places[other]] = factor;
        }
    }
    factors
}

/// Places with a nonzero force if the rows react in the proportions `shares`.
fn loaded_places(algebra: &mut Algebra, rows: &[Row], shares: &[Expr]) -> Vec<usize> {
    let mut loads: Vec<(usize, Vec3)> = Vec::new();
    for (row, &share) in rows.iter().zip(shares) {
        let Reaction { place, direction } = &row.reaction;
        let force = algebra.graph.scale3(share, *direction);
        match loads.iter_mut().find(|(known, _)| known == place) {
            Some((_, sum)) => *sum = algebra.graph.add3(*sum, force),
            None => loads.push((*place, force)),
        }
    }
    let Algebra { graph, test, .. } = algebra;
    let loaded = loads
        .into_iter()
        .filter(|(_, force)| force.iter().any(|&c| !test.is_zero(graph, c)));
    loaded.map(|(place, _)| place).collect()
}

/// The points adjacent to the origin that are connected to `root`: a shared coordinate implies a connection
/// that no constraint states.
fn tied_to(mechanism: &Mechanism, root: PointId) -> Vec<PointId> {
    let all = mechanism
        .points
        .ids()
        .filter(|&p| mechanism.points[p].from == Some(ORIGIN));
    let mut apart: Vec<(PointId, Vec<CoordinateId>)> =
        all.map(|root| (root, moving(mechanism, root))).collect();
    let mut tied = vec![root];
    let mut coordinates = moving(mechanism, root);
    apart.retain(|(other, _)| *other != root);
    while let Some(place) = apart
        .iter()
        .position(|(_, own)| own.iter().any(|q| coordinates.contains(q)))
    {
        let (other, own) = apart.swap_remove(place);
        tied.push(other);
        coordinates.extend(own);
    }
    tied.sort_unstable();
    tied
}

/// The coordinates that move the subtree of `root`.
fn moving(mechanism: &Mechanism, root: PointId) -> Vec<CoordinateId> {
    let mut coordinates = Vec::new();
    let mut see = |quantity| {
        if let Quantity::Coordinate(q) = quantity {
            coordinates.push(q);
        }
    };
    let points = mechanism.points.entries();
    for (_, point) in points.filter(|(p, _)| *p != ORIGIN && root_of(mechanism, *p) == root) {
        point
            .at
            .iter()
            .for_each(|component| component.visit(&mut see));
        let mut frame = Some(point.frame);
        while let Some(turned) = frame.map(|frame| &mechanism.frames[frame]) {
            turned
                .turns
                .iter()
                .for_each(|turn| turn.angle.visit(&mut see));
            let quaternion = turned.quaternion.into_iter().flatten();
            quaternion.for_each(|q| see(Quantity::Coordinate(q)));
            frame = turned.parent;
        }
    }
    coordinates
}

/// `a`, `b` and `c`
fn listed<'a>(names: impl Iterator<Item = &'a String>) -> String {
    let mut names: Vec<String> = names.map(|name| format!("`{name}`")).collect();
    match names.pop() {
        Some(last) if !names.is_empty() => format!("{} and {last}", names.join(", ")),
        last => last.unwrap_or_default(),
    }
}
