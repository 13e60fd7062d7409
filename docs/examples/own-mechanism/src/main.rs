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
use furuta::{Coordinates, Furuta, Parameters};

fn main() -> Result<(), SimulationError> {
    // Every emitted function can be called alone; its arguments have names.
    let hanging = Coordinates {
        alpha: 0.0,
        beta: 0.0,
    };
    let state = furuta::State {
        omega_a: 0.0,
        omega_p: 0.0,
        alpha: hanging.alpha,
        beta: hanging.beta,
    };
    let rest = furuta::Inputs { tau: 0.0 };
    let mass_matrix = furuta::mass_matrix(&Parameters::default(), &state, &rest);
    println!("mass matrix, pendulum hanging, in kg m²: {mass_matrix:.5?}");

    // The type `Furuta` puts all of them behind the trait `Model`, which simulations take.
    let push = |t: f64, _: &[f64], inputs: &mut [f64]| inputs[0] = 0.02 * (5.0 * t).sin();
    let motion = swing(&push)?;
    println!("   t     arm   pendulum   energy");
    println!("   s     deg      deg        J");
    for row in (0..motion.len()).step_by(10) {
        let [.., alpha, beta] = motion.state(row) else {
            continue;
        };
        let (alpha, beta) = (alpha.to_degrees(), beta.to_degrees());
        let t = motion.times()[row];
        println!(
            "{t:5.1} {alpha:8.2} {beta:8.2} {:10.5}",
            energy(&motion, row)
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
        simulation.parameters = <[f64; 7]>::from(parameters).to_vec();
        simulation.extras.energies = true;
        let motion = simulation.run()?;
        let lost = energy(&motion, motion.len() - 1) - energy(&motion, 0);
        // Ten seconds at the default tolerance of nine digits.
        assert!(lost.abs() < 1e-8, "{lost}");
        Ok(())
    }
}
