//! Loads that depend on reactions, such as friction that grows with the normal force.
//!
//! The reaction in a load is that of the motion without all loads that depend on reactions. What such a
//! load changes of the reaction that it depends on is of second order: with a coefficient of friction μ,
//! a share μ of what is a share μ already. So the equations are solved twice, as for a contact that
//! creeps, and nothing has to be solved for force and motion at once, which can have several solutions or
//! none (P. Painlevé, 1895).

use appell_spec::expr::Response;
use appell_spec::mechanism::Mechanism;

use super::Derivation;
use super::dependent;
use super::finding::Outcome;
use super::gibbs_appell::named_parts;
use super::loads::{self, AppliedLoad, generalized_forces, settle};
use super::motion;
use super::responses::{Answering, named_in};
use crate::symbolic::Expr;

impl Derivation {
    /// Lets all loads act on a motion that knows only those without reactions. `all` hold symbols for the
    /// reactions and for the dependent speeds.
    pub(super) fn let_all_loads_act(
        &mut self,
        mechanism: &Mechanism,
        mut all: Vec<AppliedLoad>,
    ) -> Outcome<()> {
        let derivation = self;
        let reactions = reactions(derivation, mechanism)?;
        if reactions.is_empty() {
            return Ok(());
        }
        let Derivation {
            algebra,
            symbols,
            dependent,
            ..
        } = derivation;
        settle(&mut all, &mut algebra.graph, mechanism, &reactions)?;
        let directions = [symbols.speeds.as_slice(), &dependent.system.unknowns].concat();
        let unbound = generalized_forces(algebra, &all, &directions);
        let mut actual = dependent.actual(&algebra.graph);
        loads::replace(&mut all, &mut algebra.graph, &mut actual)?;
        let forces = dependent::apply(&mut actual, algebra, &unbound)?;
        let mut forces = dependent.along_allowed(&mut algebra.graph, &forces);
        derivation.given.put_into_forces(&mut forces);
        let parts = named_parts(&mut algebra.graph, &derivation.bodies);
        let way = dependent.way();
        let gibbs = &derivation.gibbs;
        derivation.motion = motion::solve(algebra, mechanism, gibbs, &forces, &parts, way)?;
        derivation.recursion = None;
        derivation.unbound.forces = unbound;
        derivation.forces = forces;
        derivation.loads = all;
        derivation.reactions_in_loads = reactions;
        Ok(())
    }
}

/// The reactions that loads name, with their values in the motion as it is known.
fn reactions(derivation: &mut Derivation, mechanism: &Mechanism) -> Outcome<Vec<(Expr, Expr)>> {
    let loads = mechanism.loads.iter();
    let exprs = loads.flat_map(|load| load.kind.expressions());
    let mut wanted = named_in(&derivation.symbols, exprs);
    wanted.retain(|(response, _)| !matches!(response, Response::Force(..)));
    if wanted.is_empty() {
        return Ok(Vec::new());
    }
    let bodies = derivation.bodies_in_ground(mechanism);
    let answering = Answering {
        mechanism,
        symbols: &derivation.symbols,
        constraints: &derivation.constraints,
        contacts: &derivation.contacts,
        violation: &derivation.velocities.violating,
        kinematics: &derivation.kinematics,
        rates: &derivation.coordinate_rates,
        creeps: false,
        bodies: &bodies,
        accelerations: &derivation.motion.accelerations,
        loads: &derivation.loads,
        reactions_in_loads: &[],
        given: &derivation.given,
    };
    let mut values = answering.values(&mut derivation.algebra, &wanted)?;
    let graph = &mut derivation.algebra.graph;
    for ((response, _), (_, value)) in wanted.iter().zip(&mut values) {
        *value = graph.name(&named(mechanism, *response), *value);
    }
    Ok(values)
}

/// Its name in equations.
fn named(mechanism: &Mechanism, response: Response) -> String {
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
        // They are no reactions.
        Response::Acceleration(..)
        | Response::AngularAcceleration(..)
        | Response::Force(..)
        | Response::DriveForce(_) => String::new(),
    }
}
