//! A Furuta pendulum under a torque of its motor: equations from `mechanisms/furuta.toml`.

mod furuta {
    #![doc = include_str!(concat!(env!("OUT_DIR"), "/furuta.md"))]
    #![allow(
        non_snake_case,
        dead_code,
        unreachable_pub,
        clippy::all,
        clippy::pedantic
    )]
    include!(concat!(env!("OUT_DIR"), "/furuta.rs"));
}

use appell_runtime::simulate::{Sampling, SimulationError};
use appell_runtime::{Simulation, Trajectory};
use furuta::{Furuta, Inputs, Parameters, State};

fn main() -> Result<(), SimulationError> {
    // Every emitted function can be called alone; its arguments have names.
    let parameters = Parameters::default();
    let rest = Inputs { tau: 0.0 };
    let mass_matrix = furuta::mass_matrix(&parameters, &State::default(), &rest);
    println!("mass matrix, pendulum hanging, in kg m²: {mass_matrix:.5?}");
    let slopes = furuta::jacobians(&parameters, &State::default(), &rest).a;
    let stiffness = slopes.omega_p_dot.beta;
    println!("∂ω̇_p/∂β there, in 1/s²: {stiffness:.3}");

    // States and rates are vectors: a step of an integrator is one line.
    let start = State::initial();
    let soon = start + furuta::rates(&parameters, &start, &rest) * 1e-3;
    println!("arm after a millisecond, in rad/s: {:.5}", soon.omega_a);

    // The type `Furuta` puts all of them behind the trait `Model`, which simulations take.
    let push = |t: f64, _: &[f64], inputs: &mut [f64]| inputs[0] = 0.02 * (5.0 * t).sin();
    let motion = swing(&push)?;
    println!("   t     arm   pendulum   energy");
    println!("   s     deg      deg        J");
    let rows = motion.named(&Furuta).into_iter().flatten();
    for (place, row) in rows.enumerate().step_by(10) {
        let (alpha, beta) = (row.state.alpha.to_degrees(), row.state.beta.to_degrees());
        println!(
            "{:5.1} {alpha:8.2} {beta:8.2} {:10.5}",
            row.t,
            energy(&motion, place)
        );
    }
    Ok(())
}

/// Five seconds from the initial state of the spec.
fn swing(push: &dyn appell_runtime::inputs::InputSource) -> Result<Trajectory, SimulationError> {
    let mut simulation = Simulation::new(&Furuta);
    simulation.inputs = push;
    simulation.span = [0.0, 5.0];
    simulation.sampling = Sampling::Every(0.05);
    simulation.extras.energies = true;
    simulation.run()
}

/// Kinetic and potential energy in J.
fn energy(motion: &Trajectory, row: usize) -> f64 {
    ["kinetic_energy", "potential_energy"]
        .iter()
        .filter_map(|name| motion.column_index(name))
        .map(|column| motion.row(row)[column])
        .sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_energy_stays_without_motor_and_friction() -> Result<(), SimulationError> {
        let parameters = Parameters {
            c: 0.0,
            ..Parameters::default()
        };
        let mut simulation = Simulation::new(&Furuta);
        simulation.parameters = parameters.to_array().to_vec();
        simulation.extras.energies = true;
        let motion = simulation.run()?;
        let lost = energy(&motion, motion.len() - 1) - energy(&motion, 0);
        // Ten seconds at the default tolerance of nine digits.
        assert!(lost.abs() < 1e-8, "{lost}");
        Ok(())
    }

    #[test]
    fn rows_of_a_motion_have_names() -> Result<(), SimulationError> {
        let motion = Simulation::new(&Furuta).run()?;
        let last = motion.named(&Furuta).and_then(Iterator::last);
        let last = last.map(|row| row.state.to_array());
        assert_eq!(
            last.as_ref().map(<[f64; 4]>::as_slice),
            Some(motion.last_state())
        );
        Ok(())
    }
}
