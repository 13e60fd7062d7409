//! Loads that depend on reactions, such as friction proportional to the normal force.
//!
//! Such loads F change the reactions λ on which they depend. Accelerations and reactions are linear in forces,
//! so
//!
//! `λ = λ₀ + K F(λ)`,
//!
//! with the reactions λ₀ at F = 0 and K = ∂λ/∂F. Newton's method solves it: in one step if F is linear in λ,
//! otherwise in a fixed number of steps from λ₀. Strong friction makes 1 − K ∂F/∂λ singular, and beyond that
//! there can be several solutions or none (P. Painlevé, 1895).

use appell_spec::expr::Response;
use appell_spec::mechanism::Mechanism;

use super::Derivation;
use super::algebra::{Algebra, replacing, scalar_product};
use super::creep::per_mass;
use super::finding::{Item, Outcome, division_by_zero};
use super::gibbs_appell::named_parts;
use super::loads::{self, AppliedLoad, generalized_forces, settle};
use super::motion;
use super::responses::named_in;
use super::symbols::ids;
use crate::symbolic::{Expr, Graph, Substitution};

/// Newton steps if forces are nonlinear in reactions. Each squares the relative error, initially of the order
/// of the coefficient of friction.
const STEPS: usize = 4;

impl Derivation {
    /// Applies all loads to a motion derived without those that depend on reactions. `all` contain symbols for
    /// these expressions and for the dependent speeds.
    pub(super) fn let_all_loads_act(
        &mut self,
        mechanism: &Mechanism,
        mut all: Vec<AppliedLoad>,
    ) -> Outcome<()> {
        let reactions = self.reactions_with(mechanism, &all)?;
        if reactions.is_empty() {
            return Ok(());
        }
        settle(&mut all, &mut self.algebra.graph, mechanism, &reactions)?;
        let (unbound, forces) = self.forces_of(&mut all)?;
        let Self {
            algebra, dependent, ..
        } = self;
        let parts = named_parts(&mut algebra.graph, &self.bodies);
        let way = dependent.way();
        self.motion = motion::solve(algebra, mechanism, &self.gibbs, &forces, &parts, way)?;
        self.recursion = None;
        self.unbound.forces = unbound;
        self.forces = forces;
        self.loads = all;
        self.reactions_in_loads = reactions;
        Ok(())
    }

    /// Π of loads along all speeds and along the pseudo-velocities; symbols for the dependent speeds are
    /// substituted in the loads.
    fn forces_of(&mut self, loads: &mut [AppliedLoad]) -> Outcome<(Vec<Expr>, Vec<Expr>)> {
        let (algebra, dependent) = (&mut self.algebra, &self.dependent);
        let directions = [self.symbols.speeds.as_slice(), &dependent.system.unknowns].concat();
        let unbound = generalized_forces(algebra, loads, &directions);
        let mut actual = dependent.actual(&algebra.graph);
        loads::replace(loads, &mut algebra.graph, &mut actual)?;
        let forces = algebra.apply(&mut actual, &unbound)?;
        let mut forces = dependent.along_allowed(&mut algebra.graph, &forces);
        self.given.put_into_forces(&mut forces);
        Ok((unbound, forces))
    }

    /// The reactions in loads, with their values in the motion under all loads.
    fn reactions_with(
        &mut self,
        mechanism: &Mechanism,
        all: &[AppliedLoad],
    ) -> Outcome<Vec<(Expr, Expr)>> {
        let loads = mechanism.loads.iter();
        let exprs = loads.flat_map(|load| load.kind.expressions());
        let mut wanted = named_in(&self.symbols, exprs);
        wanted.retain(|(response, _)| !matches!(response, Response::Force(..)));
        if wanted.is_empty() {
            return Ok(Vec::new());
        }
        let names = wanted.iter();
        let names: Vec<String> = names.map(|&(named, _)| name(mechanism, named)).collect();
        let mut all = all.to_vec();
        let (_, forces) = self.forces_of(&mut all)?;
        let order = mechanism.loads_after_what_they_name().into_iter();
        let loads: Vec<(Expr, Expr)> = order
            .flat_map(|load| all[load.index()].of_reactions.clone())
            .collect();
        let accelerations = self.motion.accelerations.clone();
        let without = self.answers(mechanism, &wanted, &accelerations, &[])?;
        let response = self.response_to(mechanism, &loads, &forces, &wanted)?;
        let fixed = FixedPoint {
            unknowns: without.iter().map(|&(symbol, _)| symbol).collect(),
            without: without.into_iter().map(|(_, value)| value).collect(),
            response,
            loads,
        };
        let values = fixed.solved(&mut self.algebra, &names)?;
        Ok(fixed.unknowns.into_iter().zip(values).collect())
    }

    /// K: the derivatives of reactions with respect to the symbols of forces that depend on them.
    fn response_to(
        &mut self,
        mechanism: &Mechanism,
        loads: &[(Expr, Expr)],
        forces: &[Expr],
        wanted: &[(Response, Expr)],
    ) -> Outcome<Vec<Vec<Expr>>> {
        let symbols = loads.iter().map(|&(symbol, _)| symbol);
        let symbols: Vec<Expr> = symbols.collect();
        let held: Vec<(Expr, Expr)> = symbols.iter().map(|&f| (f, f)).collect();
        let unknown = self.symbols.accelerations.clone();
        let answers = self.answers(mechanism, wanted, &unknown, &held)?;
        // The loads with these symbols only.
        let mut absent = Substitution::by_zero(&self.algebra.graph, &symbols);
        let rest = self.algebra.apply(&mut absent, forces)?;
        let graph = &mut self.algebra.graph;
        let push = forces.iter().zip(&rest);
        let push: Vec<Expr> = push.map(|(&all, &rest)| graph.sub(all, rest)).collect();
        let pushed = per_mass(self, mechanism, &push)?;
        let algebra = &mut self.algebra;
        let mut response = vec![Vec::with_capacity(loads.len()); answers.len()];
        for &symbol in &symbols {
            for (row, &(_, answer)) in response.iter_mut().zip(&answers) {
                let mut parts = vec![algebra.derivative(answer, symbol)];
                for (&unknown, &pushed) in unknown.iter().zip(&pushed) {
                    let slope = algebra.derivative(answer, unknown);
                    let pushed = algebra.derivative(pushed, symbol);
                    parts.push(algebra.graph.mul(slope, pushed));
                }
                let entry = algebra.graph.sum(&parts);
                row.push(algebra.unless_zero(entry));
            }
        }
        Ok(response)
    }
}

/// `λ = λ₀ + K F(λ)`
struct FixedPoint {
    /// Symbols of λ.
    unknowns: Vec<Expr>,
    /// λ₀.
    without: Vec<Expr>,
    /// K, a row for each reaction.
    response: Vec<Vec<Expr>>,
    /// Symbols of F, and values with symbols for λ and for earlier ones.
    loads: Vec<(Expr, Expr)>,
}

impl FixedPoint {
    /// λ, under names.
    fn solved(&self, algebra: &mut Algebra, names: &[String]) -> Outcome<Vec<Expr>> {
        let graph = &mut algebra.graph;
        // Reactions independent of such loads are known.
        let is_open = |&i: &usize| self.response[i].iter().any(|&k| k != Graph::ZERO);
        let open: Vec<usize> = (0..names.len()).filter(is_open).collect();
        let mut values: Vec<Expr> = self.without.clone();
        for (i, (value, name)) in values.iter_mut().zip(names).enumerate() {
            *value = if open.contains(&i) {
                graph.name_automatically(&format!("{name}_0"), *value)
            } else {
                graph.name(name, *value)
            };
        }
        if open.is_empty() {
            return Ok(values);
        }
        let mut known = Substitution::default();
        for (i, &unknown) in self.unknowns.iter().enumerate() {
            if !open.contains(&i) {
                known.replace(graph, unknown, values[i]);
            }
        }
        let mut forces = Vec::with_capacity(self.loads.len());
        for &(symbol, value) in &self.loads {
            let value = algebra.apply(&mut known, &[value])?[0];
            known.replace(&algebra.graph, symbol, value);
            forces.push(value);
        }
        let unknowns: Vec<Expr> = open.iter().map(|&i| self.unknowns[i]).collect();
        let mut residual = Vec::with_capacity(open.len());
        for &i in &open {
            let graph = &mut algebra.graph;
            let change = scalar_product(graph, &self.response[i], &forces);
            let less = graph.sub(values[i], self.unknowns[i]);
            residual.push(graph.add(less, change));
        }
        let mut slopes = Vec::with_capacity(open.len() * open.len());
        for &residual in &residual {
            for &unknown in &unknowns {
                let slope = algebra.derivative(residual, unknown);
                let slope = algebra.unless_zero(slope);
                slopes.push(algebra.graph.neg(slope));
            }
        }
        let (start, steps) = if is_linear(algebra, &residual, &slopes, &unknowns) {
            (vec![Graph::ZERO; open.len()], 1)
        } else {
            (open.iter().map(|&i| values[i]).collect(), STEPS)
        };
        let mut at: Vec<Expr> = start;
        for step in 1..=steps {
            let mut here = replacing(&algebra.graph, &unknowns, &at);
            let right = algebra.apply(&mut here, &residual)?;
            let matrix = algebra.apply(&mut here, &slopes)?;
            let changes = quotient(algebra, matrix, right)?;
            for ((at, change), &i) in at.iter_mut().zip(changes).zip(&open) {
                let graph = &mut algebra.graph;
                let next = graph.add(*at, change);
                *at = if step == steps {
                    graph.name(&names[i], next)
                } else {
                    graph.name_automatically(&format!("{}_{step}", names[i]), next)
                };
            }
        }
        for (i, at) in open.into_iter().zip(at) {
            values[i] = at;
        }
        Ok(values)
    }
}

/// Whether a residual is affine in the unknowns with this matrix: a jump also has zero slope but is not.
fn is_linear(algebra: &mut Algebra, residual: &[Expr], matrix: &[Expr], unknowns: &[Expr]) -> bool {
    let symbols = ids(&algebra.graph, unknowns);
    let changes = |&entry: &Expr| algebra.graph.mentions(entry, &symbols);
    if matrix.iter().any(changes) {
        return false;
    }
    let mut none = Substitution::by_zero(&algebra.graph, unknowns);
    let mut rows = residual.iter().zip(matrix.chunks(unknowns.len()));
    rows.all(|(&residual, row)| {
        let Some(constant) = none.apply(&mut algebra.graph, residual) else {
            return false;
        };
        let along = scalar_product(&mut algebra.graph, row, unknowns);
        let rest = algebra.graph.sub(constant, along);
        algebra.test.are_equal(&algebra.graph, residual, rest)
    })
}

/// Solution of a system; a single equation is divided by its coefficient.
fn quotient(algebra: &mut Algebra, matrix: Vec<Expr>, right: Vec<Expr>) -> Outcome<Vec<Expr>> {
    let [coefficient] = matrix[..] else {
        return Ok(algebra.graph.solve_numerically(matrix, right));
    };
    if algebra.test.is_zero(&algebra.graph, coefficient) {
        return Err(vec![division_by_zero(Item::Mechanism)]);
    }
    let divide = |value: Expr| algebra.graph.div(value, coefficient);
    Ok(right.into_iter().map(divide).collect())
}

/// The name of a reaction in equations.
fn name(mechanism: &Mechanism, response: Response) -> String {
    let axes = ["x", "y", "z"];
    match response {
        Response::Reaction(c, along) => {
            let name = &mechanism.constraints[c].name;
            let along = along.map(|(axis, frame)| {
                format!("_{}_{}", axes[axis.index()], mechanism.frames[frame].name)
            });
            format!("reaction_{name}{}", along.unwrap_or_default())
        }
        Response::NormalForce(c) => format!("normal_force_{}", mechanism.constraints[c].name),
        // These are not reactions.
        Response::Acceleration(..)
        | Response::AngularAcceleration(..)
        | Response::Force(..)
        | Response::DriveForce(_) => String::new(),
    }
}
