//! Many motions that differ in their initial states, eight at a time.

use appell_runtime::integrate::{BlockSolver, Dop853, Dopri5};
use appell_runtime::simulate::{Method, Prepared, Sampling, run_together};
use appell_runtime::{Trajectory, simulate::SimulationError};

use crate::inputs::closed_loop::ClosedLoop;
use crate::inputs::controller::Controller;
use crate::motion::{MOST_ROWS, Motion, Ready, Simulated};
use crate::{Error, Field, Model, ModelInputs};

/// Motions integrated together, and recorded before the next ones start.
const TOGETHER: usize = 64;

/// Maximum number of rows of all motions.
const MOST_ROWS_TOGETHER: f64 = 10.0 * MOST_ROWS;

impl Model {
    /// The motions from many initial states in SI, one after the other in `starts`; the other initial values of the
    /// request do not matter. Each is, up to the rounding of elementary functions, the one that [`Model::simulate`]
    /// gives. `go_on` is called regularly.
    ///
    /// ```
    /// use appell::{Model, Motion};
    ///
    /// let model = Model::shipped("pendulum")?;
    /// let starts = vec![vec![0.0, 0.1], vec![0.0, 0.2]];
    /// let motions = model.simulate_batch(&Motion::new(1.0), &starts, || true)?;
    /// assert_eq!(motions.len(), 2);
    /// # Ok::<(), appell::Error>(())
    /// ```
    pub fn simulate_batch(
        &self,
        motion: &Motion,
        starts: &[Vec<f64>],
        go_on: impl Fn() -> bool,
    ) -> Result<Vec<Simulated>, Error> {
        let mut ready = motion.ready(self.equations(), self.setup()?, self.name())?;
        let rows = motion.t_end / ready.interval * starts.len() as f64;
        if rows > MOST_ROWS_TOGETHER {
            let message = format!(
                "{rows:.0} rows of all motions are too many; choose a longer interval or fewer motions (at most \
                 {MOST_ROWS_TOGETHER:.0} rows)"
            );
            return Err(Error::request(Field::Interval, message));
        }
        let mut all = Vec::with_capacity(starts.len());
        if let Method::Rk4 { .. } = motion.method {
            // Fixed steps are not integrated together.
            for start in starts.iter().take_while(|_| go_on()) {
                ready.initial.clone_from(start);
                #[expect(
                    clippy::redundant_closure_for_method_calls,
                    reason = "the method is that of one lifetime"
                )]
                let run = motion.simulate(self.equations(), &ready, |s| s.run())?;
                all.push(run);
            }
        } else {
            let info = self.info();
            let closed = ready.wiring.closed_loop(self.rates()?, info, &[])?;
            for starts in starts.chunks(TOGETHER).take_while(|_| go_on()) {
                all.extend(self.together(motion, &ready, &closed, starts)?);
            }
        }
        if all.len() < starts.len() {
            return Err(Error::request(
                Field::Initial,
                "the computation was interrupted",
            ));
        }
        Ok(all)
    }

    fn together(
        &self,
        motion: &Motion,
        ready: &Ready,
        closed: &ClosedLoop,
        starts: &[Vec<f64>],
    ) -> Result<Vec<Simulated>, Error> {
        let model = self.equations();
        let controllers = starts.iter().map(|_| {
            let parameters = ready.parameters.clone();
            ready.wiring.controller(model, parameters, motion.t_end)
        });
        let controllers: Vec<Controller<'_>> = controllers.collect();
        let inputs = controllers
            .iter()
            .map(|controller| ModelInputs::new(model.info(), controller));
        let inputs: Vec<ModelInputs<'_>> = inputs.collect::<Result<_, _>>()?;
        let simulations = starts.iter().zip(&controllers);
        let simulations: Vec<_> = simulations
            .map(|(start, controller)| motion.simulation(ready, model, controller, start.clone()))
            .collect();
        let prepared = simulations.iter().zip(&inputs);
        let prepared = prepared.map(|(simulation, inputs)| Prepared::new(simulation, inputs));
        let prepared: Vec<Prepared<'_>> = prepared.collect::<Result<_, SimulationError>>()?;
        let motions = integrate(motion, ready, closed, &controllers, &prepared);
        motions
            .into_iter()
            .map(|motion| ready.simulated(motion))
            .collect()
    }
}

fn integrate<'w>(
    motion: &Motion,
    ready: &Ready,
    closed: &ClosedLoop,
    controllers: &[Controller<'_>],
    prepared: &'w [Prepared<'w>],
) -> Vec<Result<Trajectory, SimulationError>> {
    let (p, options) = (&ready.parameters, &ready.options);
    let (sampling, extras) = (Sampling::Every(ready.interval), motion.extras);
    let mut rates = closed.rates_of(|which, t, x, u| controllers[which].fill_outside(p, t, x, u));
    run_together(prepared, sampling, extras, |motions| match motion.method {
        Method::Dopri5 => BlockSolver::<Dopri5>::new().integrate(&mut rates, motions, options),
        _ => BlockSolver::<Dop853>::new().integrate(&mut rates, motions, options),
    })
}
