//! Motions by Taylor series under everything that can drive them, beside the same by Runge-Kutta steps.

use appell::control::Request;
use appell::setup::Assignment;
use appell::{Error, Model, Motion};
use appell_runtime::inputs::TabulatedInputs;
use appell_runtime::simulate::{Method, SimulationError};

/// Tolerances are 1e-11; motions under feedback forget errors.
const CLOSE: f64 = 2e-8;

/// The motion by both methods, with the same columns.
fn assert_agree(model: &Model, motion: &Motion, what: &str) {
    let [taylor, expected] = [Method::Taylor, Method::Dop853].map(|method| {
        let motion = Motion {
            method,
            ..motion.clone()
        };
        let simulated = model.simulate(&motion).unwrap();
        assert_eq!(simulated.failure, None, "{what}");
        simulated.trajectory
    });
    let states = model.info().states.iter();
    let inputs = model.info().inputs.iter();
    for name in states.chain(inputs).map(|quantity| quantity.name.as_ref()) {
        let [found, expected] = [&taylor, &expected].map(|of| of.column(name).unwrap());
        let size = expected.iter().fold(1.0, |size: f64, x| size.max(x.abs()));
        for (row, (found, expected)) in found.iter().zip(&expected).enumerate() {
            let off = (found - expected).abs();
            assert!(
                off < CLOSE * size,
                "{what}, {name}, row {row}: {found} {expected}"
            );
        }
    }
    let (cost, known) = (taylor.statistics, expected.statistics);
    assert!(
        cost.evaluations < known.evaluations,
        "{what}: {cost:?} {known:?}"
    );
}

#[test]
fn expressions_and_laws_are_expanded_along() {
    let model = Model::shipped("cart_pole").unwrap();
    let pushed = Motion::new(2.0)
        .initial("theta", "20deg")
        .input("F", "3*sin(2*t) - 0.2*x*exp(-t) + if(t < 0.7, 1, 0)");
    assert_agree(&model, &pushed, "expression");
    let design = model.control(&Request::default().poles("-3")).unwrap();
    let law = model.law(&design).unwrap();
    let balanced = Motion::new(3.0).initial("theta", "10deg").feedback(&law);
    assert_agree(&model, &balanced, "law");
}

#[test]
fn the_lane_change_ends_where_the_paper_says() {
    let law = include_str!("../../docs/examples/feedback/lane_change_5_m_s.toml");
    let model = Model::shipped("unicycle").unwrap();
    assert_agree(&model, &Motion::new(10.0).feedback(law), "lane change");
}

#[test]
fn sampled_and_scheduled_laws_act() {
    let model = Model::shipped("cart_pole").unwrap();
    let design = model.control(&Request::default().poles("-3")).unwrap();
    let law = model.law(&design).unwrap();
    let sampled = format!("sampled_ms = 20\ndelay_ms = 5\n{law}");
    let balanced = Motion::new(2.0).initial("theta", "5deg").feedback(&sampled);
    assert_agree(&model, &balanced, "sampled");
    let scheduled = "\
inputs = ['F']
states = ['x', 'theta', 'v', 'omega']
over = 'theta'
[[at]]
value = -0.1
gains = [1, 2, 1, 0.5]
[[at]]
value = 0.1
gains = [2, 3, 1.5, 0.7]
offset = [0.1]
steady = { x = 0.02 }
";
    let motion = Motion::new(2.0)
        .initial("theta", "12deg")
        .feedback(scheduled);
    assert_agree(&model, &motion, "scheduled");
    let over = Assignment::new("l", "0.3..0.6/3");
    let schedule = model
        .schedule(&Request::default().poles("-3"), &over)
        .unwrap();
    let law = model.scheduled_law(&schedule).unwrap();
    let motion = Motion::new(1.0).initial("theta", "12deg").feedback(&law);
    assert_agree(&model, &motion, "scheduled over a parameter");
}

#[test]
fn tables_of_a_program_act_and_its_functions_are_refused() {
    let model = Model::shipped("cart_pole").unwrap();
    let times: Vec<f64> = (0..20).map(|k| 0.1 * f64::from(k)).collect();
    let values = times.iter().map(|t| 3.0 * (4.0 * t).sin()).collect();
    let table = TabulatedInputs::held(&times, &[values]).unwrap();
    assert_agree(&model, &Motion::new(2.0).drive(&["F"], table), "table");
    let push = |t: f64, _: &[f64], u: &mut [f64]| u[0] = t.sin();
    let motion = Motion {
        method: Method::Taylor,
        ..Motion::new(1.0).drive(&["F"], push)
    };
    let error = model.simulate(&motion).unwrap_err();
    let known = matches!(error, Error::Simulate(SimulationError::NoSeries { .. }));
    assert!(known, "{error}");
}
