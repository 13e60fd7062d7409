//! Solves constraints and definitions of the pseudo-velocities for the generalised velocities.

use appell_spec::Code;
use appell_spec::mechanism::{CoordinateId, Mechanism, SpeedId};

use super::algebra::{Algebra, scalar_product};
use super::constraints::Constraints;
use super::cramer::{self, Block};
use super::equation_count::check_count;
use super::expressions::Setting;
use super::finding::{Finding, Item, Outcome, listed};
use super::kinematics::{Effort, Kinematics};
use super::motions::motions;
use super::open_system::Equation;
pub use super::open_system::OpenSystem;
use super::quaternion::{is_norm, quaternions, rates as rates_of};
use super::rank::{LinearRow, Standing, standings};
use super::symbols::{Symbols, ids};
use crate::symbolic::{Expr, Graph, Intervals, Node, Substitution, SymbolId, vector};

/// The generalised velocities in terms of the pseudo-velocities.
#[derive(Debug, Clone)]
pub struct GeneralizedVelocities {
    /// q̇ in the admissible motions.
    pub rates: Vec<Expr>,
    /// q̇ when every constraint row may be violated at a rate of its own.
    pub violating: Violation,
    /// Coordinates whose rates need a pivoted solve at run time.
    pub solved_numerically: Vec<usize>,
    /// The unknowns of that solve: these rates, or angular velocities instead of quaternion rates.
    pub solved: Vec<Expr>,
}

/// Motions that violate the constraints, for their reactions.
#[derive(Debug, Clone)]
pub struct Violation {
    /// Rate at which each row is violated, a symbol per row.
    pub rates: Vec<Expr>,
    /// q̇ in terms of pseudo-velocities and those rates.
    pub coordinate_rates: Vec<Expr>,
    /// Rates of the auxiliary motions, in their order.
    pub carried_rates: Vec<Expr>,
}

/// The explicitly solved unknowns in terms of those of the open system.
#[derive(Debug, Clone)]
pub struct Elimination {
    /// q̇ in terms of the pseudo-velocities and of the unknowns of the open system.
    pub rates: Vec<Expr>,
    /// The system of the remaining unknowns in the admissible motions.
    pub open: OpenSystem,
    /// The motions that violate constraint rows, likewise.
    violating: Violation,
    /// The right-hand side of the open system in these motions.
    violated_right: Vec<Expr>,
}

/// Solves for q̇. Pivots must not vanish in the declared ranges; unknowns without such a pivot form a small
/// system that is solved with pivoting at run time.
pub fn eliminate(
    algebra: &mut Algebra,
    setting: Setting<'_>,
    constraints: &Constraints,
    intervals: &mut Intervals,
) -> Outcome<Elimination> {
    let (mechanism, symbols) = (setting.mechanism, setting.symbols);
    let violation_rates: Vec<Expr> = constraints
        .rows
        .iter()
        .map(|row| algebra.graph.symbol(&format!("violation_{}", row.name)))
        .collect();
    let mut carried_rates = Vec::with_capacity(constraints.auxiliary.motions.len());
    for motion in &constraints.auxiliary.motions {
        carried_rates.push(scalar_product(
            &mut algebra.graph,
            &motion.rate,
            &violation_rates,
        ));
    }

    let mut equations = Vec::new();
    let definitions = definitions(algebra, setting)?;
    for (index, value) in definitions.into_iter().enumerate() {
        equations.push(definition(algebra, symbols, index, value));
    }
    for (index, row) in constraints.rows.iter().enumerate() {
        if !row.is_active() {
            continue;
        }
        // Σ C q̇ = violation - rest - contribution of the auxiliary motions
        let mut parts = vec![violation_rates[index], algebra.graph.neg(row.rest)];
        for (motion, &rate) in constraints.auxiliary.motions.iter().zip(&carried_rates) {
            let contribution = algebra.graph.mul(motion.gains[index], rate);
            parts.push(algebra.graph.neg(contribution));
        }
        let right = algebra.graph.sum(&parts);
        equations.push(Equation {
            row: Some(index),
            coefficients: row.coefficients.clone(),
            right,
        });
    }
    check_count(mechanism, constraints, equations.len())?;
    let quaternions: Vec<[usize; 4]> = quaternions(mechanism).collect();
    equations.retain(|equation| {
        equation
            .row
            .is_none_or(|row| !is_norm(mechanism, constraints.rows[row].constraint))
    });
    for equation in &mut equations {
        turn_unknowns(algebra, symbols, &quaternions, &mut equation.coefficients);
    }

    let given = equations
        .iter()
        .map(|e| LinearRow::homogeneous(e.coefficients.clone()));
    let given: Vec<LinearRow> = given.collect();
    // The four rates of a quaternion are replaced by three unknowns: the angular velocity, in the columns of
    // the vector part.
    let open = (0..mechanism.coordinates.len())
        .filter(|column| !quaternions.iter().any(|[scalar, ..]| scalar == column));
    let solved = solve(algebra, equations, open.collect(), symbols, intervals);
    let Some((mut violating, violated)) = solved else {
        let (speeds, rows) = given.split_at(mechanism.pseudo_velocities.len());
        let names = constraints.rows.iter().filter(|row| row.is_active());
        let names: Vec<&str> = names.map(|row| row.name.as_str()).collect();
        return Err(untold_velocities(algebra, mechanism, &names, rows, speeds));
    };
    for places in &quaternions {
        let [_, x, y, z] = *places;
        let omega = [violating[x], violating[y], violating[z]];
        let e = places.map(|place| symbols.coordinates[place]);
        for (place, rate) in places.iter().zip(rates_of(&mut algebra.graph, e, omega)) {
            violating[*place] = rate;
        }
    }
    let mut no_violation = Substitution::by_zero(&algebra.graph, &violation_rates);
    let mut allowed = |exprs: &[Expr]| -> Outcome<Vec<Expr>> {
        let allowed = algebra.apply(&mut no_violation, exprs)?;
        Ok(allowed.into_iter().map(|e| algebra.shortest(e)).collect())
    };
    let (rates, right) = (allowed(&violating)?, allowed(&violated.right)?);
    let rates = rates.into_iter();
    Ok(Elimination {
        rates: rates.map(|e| algebra.with_fewest_divisors(e)).collect(),
        open: OpenSystem {
            right,
            ..violated.clone()
        },
        violating: Violation {
            rates: violation_rates,
            coordinate_rates: violating,
            carried_rates,
        },
        violated_right: violated.right,
    })
}

impl Elimination {
    /// Recombines equations of the open system: the equation at each of `places` becomes its row of `turned`,
    /// the sum of them all with the factors of that row.
    pub fn turn(&mut self, algebra: &mut Algebra, places: &[usize], turned: &[TurnedRow]) {
        let before = places.iter().map(|&place| self.violated_right[place]);
        let before: Vec<Expr> = before.collect();
        for (&place, row) in places.iter().zip(turned) {
            // The contribution of a violation is linear in it.
            let mut parts = vec![row.right];
            for (&factor, &right) in row.factors.iter().zip(&before) {
                for &violation in &self.violating.rates {
                    let slope = algebra.derivative(right, violation);
                    parts.push(algebra.graph.product(&[factor, slope, violation]));
                }
            }
            self.violated_right[place] = algebra.graph.sum(&parts);
            self.open.right[place] = row.right;
            let start = place * self.open.unknowns.len();
            self.open.matrix.splice(
                start..start + row.coefficients.len(),
                row.coefficients.iter().copied(),
            );
        }
    }

    /// q̇ with the solution of the open system.
    pub fn closed(
        self,
        algebra: &mut Algebra,
        mechanism: &Mechanism,
    ) -> Outcome<GeneralizedVelocities> {
        let open = self.open;
        let mut values = open.solved_for(&mut algebra.graph, &open.right);
        let in_quaternion: Vec<usize> = quaternions(mechanism).flatten().collect();
        for (value, &q) in values.iter_mut().zip(&open.coordinates) {
            let coordinate = &mechanism.coordinates[CoordinateId::new(q)].label.name;
            let name = if in_quaternion.contains(&q) {
                format!("omega_{coordinate}")
            } else {
                format!("{coordinate}_dot")
            };
            *value = algebra.graph.name(&name, *value);
        }
        let rates = open.put_in(algebra, &values, &self.rates)?;
        let solved = values;
        let values = open.solved_for(&mut algebra.graph, &self.violated_right);
        let violating = self.violating;
        Ok(GeneralizedVelocities {
            rates,
            violating: Violation {
                coordinate_rates: open.put_in(algebra, &values, &violating.coordinate_rates)?,
                ..violating
            },
            solved_numerically: if open.by_division {
                Vec::new()
            } else {
                open.coordinates
            },
            solved,
        })
    }
}

/// An equation that replaces others of the open system as a linear combination of them.
#[derive(Debug, Clone)]
pub struct TurnedRow {
    /// Coefficients of the unknowns.
    pub coefficients: Vec<Expr>,
    /// Right-hand side in the admissible motions.
    pub right: Expr,
    /// Its factors as a linear combination of the replaced equations.
    pub factors: Vec<Expr>,
}

/// The defining expressions of the pseudo-velocities, with symbols for q̇.
fn definitions(algebra: &mut Algebra, setting: Setting<'_>) -> Outcome<Vec<Expr>> {
    let symbols = setting.symbols;
    let speeds = setting.mechanism.pseudo_velocities.entries();
    let lowered = speeds.map(|(id, speed)| {
        let item = Item::PseudoVelocity(id);
        setting.lower_in(&mut algebra.graph, item, &speed.definition)
    });
    let values = lowered.collect::<Outcome<Vec<Expr>>>()?;
    if !symbols.motions.iter().any(|&(_, named)| {
        values.iter().any(|&value| {
            algebra
                .graph
                .mentions(value, &ids(&algebra.graph, &[named]))
        })
    }) {
        return Ok(values);
    }
    let kinematics = Kinematics::new(algebra, setting, &[], Effort::Plain)?;
    let mut told = motions(algebra, symbols, &kinematics);
    algebra.apply(&mut told, &values)
}

/// Converts coefficients of quaternion rates to those of angular velocities, in the columns of the vector
/// parts.
fn turn_unknowns(
    algebra: &mut Algebra,
    symbols: &Symbols,
    quaternions: &[[usize; 4]],
    coefficients: &mut [Expr],
) {
    for places in quaternions {
        let of_rates = places.map(|place| coefficients[place]);
        if of_rates == [Graph::ZERO; 4] {
            continue;
        }
        let e = places.map(|place| symbols.coordinates[place]);
        coefficients[places[0]] = Graph::ZERO;
        for axis in 0..3 {
            let unit = rates_of(&mut algebra.graph, e, vector::IDENTITY[axis]);
            let sum = scalar_product(&mut algebra.graph, &of_rates, &unit);
            coefficients[places[axis + 1]] = algebra.shortest(sum);
        }
    }
}

/// The definition of a pseudo-velocity as an equation for q̇.
fn definition(algebra: &mut Algebra, symbols: &Symbols, index: usize, value: Expr) -> Equation {
    let mut coefficients = Vec::with_capacity(symbols.rates.len());
    let mut parts = vec![symbols.speeds[index], algebra.graph.neg(value)];
    for &rate in &symbols.rates {
        let coefficient = algebra.derivative(value, rate);
        coefficients.push(algebra.shortest(coefficient));
        parts.push(algebra.graph.mul(coefficient, rate));
    }
    // ω minus the terms of the definition without generalised velocities.
    let right = algebra.graph.sum(&parts);
    let right = algebra.shortest(right);
    Equation {
        row: None,
        coefficients,
        right,
    }
}

/// A solved unknown: `q̇_column = right - Σ coefficient · q̇_later`.
struct Solved {
    column: usize,
    coefficients: Vec<(usize, Expr)>,
    right: Expr,
    /// The equation that it solves, if the quotient may remain a symbol.
    whole: Option<Equation>,
}

impl Solved {
    /// Eliminates the unknown from the other equations.
    fn take_out_of(&self, algebra: &mut Algebra, equations: &mut [Equation]) {
        for equation in equations {
            let factor = equation.coefficients[self.column];
            if factor == Graph::ZERO {
                continue;
            }
            for &(other, ratio) in &self.coefficients {
                let change = algebra.graph.mul(factor, ratio);
                let value = algebra.graph.sub(equation.coefficients[other], change);
                equation.coefficients[other] = algebra.shortest(value);
            }
            let change = algebra.graph.mul(factor, self.right);
            equation.right = algebra.graph.sub(equation.right, change);
            equation.coefficients[self.column] = Graph::ZERO;
        }
    }
}

/// The unknowns in terms of those that need a pivoted solve, and the system of the latter. `None` if the
/// equations are dependent everywhere.
fn solve(
    algebra: &mut Algebra,
    mut equations: Vec<Equation>,
    mut open: Vec<usize>,
    symbols: &Symbols,
    intervals: &mut Intervals,
) -> Option<(Vec<Expr>, OpenSystem)> {
    let count = symbols.rates.len();
    let mut solved: Vec<Solved> = Vec::new();
    while let Some((row, column)) = safest_pivot(algebra, &equations, &open, intervals) {
        let Equation {
            row: at,
            coefficients,
            right,
        } = equations.swap_remove(row);
        let pivot = coefficients[column];
        let whole = keeps_letter(algebra, pivot, symbols).then(|| Equation {
            row: at,
            coefficients: coefficients.clone(),
            right,
        });
        let right = algebra.graph.div(right, pivot);
        let right = algebra.shortest(right);
        let mut rest = Vec::new();
        for &other in open
            .iter()
            .filter(|&&c| c != column && coefficients[c] != Graph::ZERO)
        {
            let ratio = algebra.graph.div(coefficients[other], pivot);
            rest.push((other, algebra.shortest(ratio)));
        }
        open.retain(|&c| c != column);
        let unknown = Solved {
            column,
            coefficients: rest,
            right,
            whole,
        };
        unknown.take_out_of(algebra, &mut equations);
        solved.push(unknown);
    }
    if !are_independent(algebra, &equations, &open) {
        return None;
    }

    let mut rates = vec![Graph::ZERO; count];
    let positions = ids(&algebra.graph, &symbols.coordinates);
    let mut kept: Vec<usize> = Vec::new();
    let matrix: Vec<&[Expr]> = equations.iter().map(|e| &*e.coefficients).collect();
    for Block {
        equations: places,
        unknowns,
    } in cramer::blocks(&matrix, &open)
    {
        let row = |&place: &usize| unknowns.iter().map(|&q| matrix[place][q]).collect();
        let rows: Vec<Vec<Expr>> = places.iter().map(row).collect();
        let right: Vec<Expr> = places.iter().map(|&place| equations[place].right).collect();
        let held: &[SymbolId] = if open.len() == 2 { &[] } else { &positions };
        match cramer::solve(algebra, &rows, &right, held, intervals) {
            Some(values) => {
                for (&column, value) in unknowns.iter().zip(values) {
                    rates[column] = value;
                }
                open.retain(|column| !unknowns.contains(column));
            }
            None => kept.extend(places),
        }
    }
    kept.sort_unstable();
    let mut system = OpenSystem::default();
    if !open.is_empty() {
        system.unknowns = open.iter().map(|&column| symbols.rates[column]).collect();
        for &column in &open {
            rates[column] = symbols.rates[column];
        }
        for equation in kept.iter().map(|&place| &equations[place]) {
            let row = open.iter().map(|&c| equation.coefficients[c]);
            system.matrix.extend(row);
            system.right.push(equation.right);
            system.rows.push(equation.row);
        }
    }
    let may_keep = open.is_empty();
    for Solved {
        column,
        coefficients,
        right,
        whole,
    } in solved.into_iter().rev()
    {
        if let Some(whole) = whole.filter(|_| may_keep)
            && system.keep(algebra, column, &rates, &whole)
        {
            rates[column] = symbols.rates[column];
            system.unknowns.push(rates[column]);
            open.push(column);
            continue;
        }
        let mut parts = vec![right];
        for (other, coefficient) in coefficients {
            let part = algebra.graph.mul(coefficient, rates[other]);
            parts.push(algebra.graph.neg(part));
        }
        let rate = algebra.graph.sum(&parts);
        rates[column] = algebra.shortest(rate);
    }
    system.coordinates = open;
    Some((rates, system))
}

/// Whether a quotient by a pivot may remain a symbol: the pivot is a sum that depends on the position.
fn keeps_letter(algebra: &Algebra, pivot: Expr, symbols: &Symbols) -> bool {
    let graph = &algebra.graph;
    let is_sum = matches!(graph.node(pivot), Node::Sum(terms) if terms.len() > 1);
    algebra.in_letters && is_sum && graph.mentions(pivot, &ids(graph, &symbols.coordinates))
}

/// The pivot with the least fill-in among those that cannot vanish.
fn safest_pivot(
    algebra: &mut Algebra,
    equations: &[Equation],
    open: &[usize],
    intervals: &mut Intervals,
) -> Option<(usize, usize)> {
    let filled = |coefficients: &[Expr]| {
        open.iter()
            .filter(|&&c| coefficients[c] != Graph::ZERO)
            .count()
    };
    let mut best: Option<((usize, usize), (usize, usize))> = None;
    for (row, equation) in equations.iter().enumerate() {
        let in_row = filled(&equation.coefficients);
        for &column in open {
            let pivot = equation.coefficients[column];
            if pivot == Graph::ZERO || !intervals.cannot_vanish(&algebra.graph, pivot) {
                continue;
            }
            let in_column = equations
                .iter()
                .filter(|e| e.coefficients[column] != Graph::ZERO)
                .count();
            let fill = (in_row - 1) * (in_column - 1);
            let cost = (fill, algebra.graph.operations(&[pivot]));
            if best.is_none_or(|(least, _)| cost < least) {
                best = Some((cost, (row, column)));
            }
        }
    }
    best.map(|(_, place)| place)
}

/// Whether the equations are generically independent as equations for the unknowns `open`.
fn are_independent(algebra: &mut Algebra, equations: &[Equation], open: &[usize]) -> bool {
    let row =
        |e: &Equation| LinearRow::homogeneous(open.iter().map(|&c| e.coefficients[c]).collect());
    let rows: Vec<LinearRow> = equations.iter().map(row).collect();
    let standings = standings(algebra, &rows);
    standings.iter().all(|s| *s == Standing::Independent)
}

/// The pseudo-velocities that depend on constraints and on earlier pseudo-velocities; `definitions` are their
/// equations, `rows` those of the constraints.
fn untold_velocities(
    algebra: &mut Algebra,
    mechanism: &Mechanism,
    names: &[&str],
    rows: &[LinearRow],
    definitions: &[LinearRow],
) -> Vec<Finding> {
    let speeds = mechanism.pseudo_velocities.iter().map(|w| &*w.label.name);
    let names: Vec<&str> = names.iter().copied().chain(speeds).collect();
    let all = [rows, definitions].concat();
    let coordinates = mechanism.coordinates.entries();
    let untold: Vec<String> = coordinates
        .filter(|(q, _)| (all.iter()).all(|row| row.coefficients[q.index()] == Graph::ZERO))
        .map(|(_, coordinate)| format!("`dot({})`", coordinate.label.name))
        .collect();
    let help = if untold.is_empty() {
        "define it independently of the constraints and of the others".to_owned()
    } else {
        let untold = untold.join(", ");
        format!("include {untold}, which nothing determines")
    };
    let consequence =
        "constraints and pseudo-velocities do not determine all generalised velocities";
    let finding = |message, item| Finding {
        code: Code::SingularPseudoVelocities,
        message,
        item,
        help: help.clone(),
    };
    let mut findings = Vec::new();
    for (index, standing) in standings(algebra, &all).into_iter().enumerate() {
        if let Standing::Redundant(sum) = standing
            && let Some(speed) = index.checked_sub(rows.len())
        {
            let reason = if sum.is_empty() {
                "is always zero".to_owned()
            } else {
                format!(
                    "follows from {}",
                    listed(sum.iter().map(|&(i, _)| names[i]))
                )
            };
            let message = format!("`{}` {reason}: {consequence}", names[index]);
            findings.push(finding(message, Item::PseudoVelocity(SpeedId::new(speed))));
        }
    }
    if findings.is_empty() {
        // The equations do not show which one is dependent.
        findings.push(finding(consequence.to_owned(), Item::Mechanism));
    }
    findings
}
