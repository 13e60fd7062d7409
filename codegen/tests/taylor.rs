//! Taylor series of the rates of shipped mechanisms.
#![allow(clippy::unwrap_used, reason = "a test that cannot go on fails")]

use appell_codegen::compile;
use appell_codegen::interpreted::InterpretedModel;
use appell_codegen::jit::JitModel;
use appell_codegen::program::FunctionKind;
use appell_runtime::Simulation;
use appell_runtime::integrate::Options;
use appell_runtime::model::Model;
use appell_runtime::simulate::Method;

#[test]
fn every_shipped_mechanism_moves_as_by_runge_kutta() {
    for (name, text) in appell_test_kit::shipped() {
        let program = compile(&name, &text, &FunctionKind::STANDARD).unwrap();
        let jit = JitModel::new(&program).unwrap();
        let interpreted = InterpretedModel::new(program);
        let shape = jit.series().unwrap().shape().clone();
        println!(
            "{name}: states {} kept {} products {} guards {:?}",
            shape.states, shape.kept, shape.products, shape.guards
        );
        let run = |model: &dyn Model, method| {
            let mut initial_state = model.info().initial_state();
            for (i, x) in initial_state.iter_mut().enumerate() {
                let _ = i;
                if *x == 0.0 {
                    *x += 0.01;
                }
            }
            Simulation {
                method,
                span: [0.0, 2.0],
                initial_state,
                options: Options::with_tolerances(1e-12, 1e-12),
                ..Simulation::new(model)
            }
            .run()
        };
        let (dop, taylor) = (run(&jit, Method::Dop853), run(&jit, Method::Taylor));
        match (dop, taylor) {
            (Ok(dop), Ok(taylor)) => {
                let off = dop
                    .last_state()
                    .iter()
                    .zip(taylor.last_state())
                    .map(|(a, b)| (a - b).abs() / (1.0 + a.abs()))
                    .fold(0.0, f64::max);
                println!(
                    "   {:?} {:?} off {off:e}",
                    dop.statistics, taylor.statistics
                );
            }
            (a, b) => println!(
                "   {:?} {:?}",
                a.map(|_| ()).map_err(|e| e.to_string()),
                b.map(|_| ()).map_err(|e| e.to_string())
            ),
        }
        let _ = interpreted;
    }
}
