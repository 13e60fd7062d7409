//! The description of a model.

use crate::common::{in_unit, si};
use appell_runtime::model::{Interpolation, ModelInfo, Quantity, SignalTable};
use std::borrow::Cow;

/// As an emitted model states it: without any allocation.
const INFO: ModelInfo = ModelInfo {
    name: Cow::Borrowed("cart"),
    title: Cow::Borrowed("A cart"),
    source: Cow::Borrowed(""),
    states: Cow::Borrowed(const { &[si("v", "m/s", 0.5), in_unit("x", "mm", 1e-3, 0.25)] }),
    speeds: 1,
    inputs: Cow::Borrowed(const { &[si("F", "N", 0.0), si("w_dot", "m/s", 0.0)] }),
    declared_inputs: 1,
    signals: Cow::Borrowed(
        const {
            &[SignalTable {
                name: Cow::Borrowed("w"),
                times: Cow::Borrowed(&[0.0, 1.0]),
                values: Cow::Borrowed(&[2.0, 3.0]),
                interpolation: Interpolation::Linear,
            }]
        },
    ),
    signal_inputs: Cow::Borrowed(&[(0, 1)]),
    parameters: Cow::Borrowed(const { &[si("m", "kg", 2.0)] }),
    outputs: Cow::Borrowed(&[]),
    constraint_rows: Cow::Borrowed(&[]),
    reactions: Cow::Borrowed(&[]),
    contacts: Cow::Borrowed(&[]),
    explicit_time: false,
};

#[test]
fn a_model_can_be_described_in_constants() {
    let info = &INFO;
    let sizes = [
        info.state_len(),
        info.input_len(),
        info.parameter_len(),
        info.output_len(),
        info.speeds,
    ];
    assert_eq!(sizes, [2, 2, 1, 0, 1]);
    assert_eq!(format!("{:?}", info.initial_state()), "[0.5, 0.25]");
    assert_eq!(format!("{:?}", info.default_parameters()), "[2.0]");
    let names = |quantities: &[Quantity]| quantities[0].name.to_string();
    assert_eq!(names(info.speed_quantities()), "v");
    assert_eq!(names(info.coordinate_quantities()), "x");
}

#[test]
fn names_lead_to_positions_and_units_to_numbers() {
    let info = &INFO;
    assert_eq!(
        (info.state_index("x"), info.state_index("y")),
        (Some(1), None)
    );
    assert_eq!(
        (info.input_index("w_dot"), info.parameter_index("m")),
        (Some(1), Some(0))
    );
    assert_eq!(info.output_index("x"), None);
    let x = &info.states[1];
    assert_eq!(
        (x.to_unit(0.25).to_string(), x.to_si(250.0).to_string()),
        ("250".into(), "0.25".into())
    );
}
