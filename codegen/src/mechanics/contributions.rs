//! Which bodies and loads enter which equations of motion; there is one equation for each
//! pseudo-velocity.

use super::Derivation;
use super::algebra::Algebra;
use super::gibbs_appell::BodyMotion;
use super::loads::generalized_forces;
use crate::symbolic::vector;

/// By load: whether its generalised force enters the equation of each pseudo-velocity.
pub fn of_loads(derivation: &mut Derivation) -> Vec<Vec<bool>> {
    let Derivation {
        algebra,
        symbols,
        loads,
        ..
    } = derivation;
    let enters = |load| {
        let forces = generalized_forces(algebra, std::slice::from_ref(load), &symbols.speeds);
        let Algebra { graph, test, .. } = &mut *algebra;
        let enters = forces.iter().map(|&force| !test.is_zero(graph, force));
        enters.collect()
    };
    loads.iter().map(enters).collect()
}

/// By body: whether each pseudo-velocity moves it.
pub fn of_bodies(derivation: &Derivation) -> Vec<Vec<bool>> {
    let speeds = 0..derivation.symbols.speeds.len();
    let bodies = derivation.bodies.iter();
    bodies
        .map(|motion| speeds.clone().map(|speed| moves(motion, speed)).collect())
        .collect()
}

fn moves(motion: &BodyMotion, speed: usize) -> bool {
    let turns = motion.rotation.as_ref().map(|rotation| &rotation.partial);
    let all = [Some(&motion.centre.partial), turns].into_iter().flatten();
    all.filter_map(|partial| partial.get(speed))
        .any(|partial| *partial != vector::ZERO)
}
