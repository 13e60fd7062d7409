//! Actuators as inputs, and numbers of the file as parameters.

use appell_robots::{ActuatorName, Imported, Letters, Options, import};

fn arm(letters: Letters) -> Imported {
    let text = r#"<mujoco model="arm"><compiler angle="radian"/>
      <default><default class="servo"><position kp="20" kv="1" forcerange="-3 3"/></default></default>
      <worldbody><body name="upper">
        <inertial pos="0.1 0 0" mass="2" diaginertia="0.01 0.02 0.03"/>
        <joint name="shoulder" axis="0 1 0" damping="0.1" pos="0.02 0 0"/>
        <body name="fore" pos="0.4 0 0">
          <inertial pos="0.1 0 0.05" mass="1" diaginertia="0.01 0.02 0.03"/>
          <joint name="elbow" axis="0 0.6 0.8" armature="0.3"/>
        </body></body></worldbody>
      <actuator><position name="s" class="servo" joint="shoulder" timeconst="0.02" ctrlrange="-1 1"/>
        <motor name="elbow" joint="elbow" gear="9" ctrlrange="-4 4"/></actuator></mujoco>"#;
    let options = Options {
        actuators: true,
        letters,
        ..Options::default()
    };
    import("arm.xml", text, &options).unwrap()
}

#[test]
fn actuators_are_inputs_with_their_laws() {
    let arm = arm(Letters::None);
    for line in [
        "s          = { unit = \"rad\"",
        "ctrl_elbow = { unit = \"N*m\"",
        "force = \"min(max(20 [N*m]*(min(max(s, -1), 1) - shoulder) - 1 [N*m*s]*dot(shoulder), -3 [N*m]), 3 [N*m])\"",
        "force = \"9*min(max(ctrl_elbow, -4 [N*m]), 4 [N*m])\"",
        "torque_elbow    = { value = \"force(ctrl_elbow)\"",
        "# - s lags by 0.02 s",
    ] {
        assert!(arm.spec.contains(line), "{line}\n{}", arm.spec);
    }
    assert!(!arm.spec.contains("tau_"), "{}", arm.spec);
    let [servo, motor] = arm.dictionary.actuators.as_slice() else {
        panic!("{:?}", arm.dictionary);
    };
    let expected = ActuatorName {
        name: "s".to_owned(),
        input: "s".to_owned(),
        load: "s".to_owned(),
        joint: Some("shoulder".to_owned()),
        lag: 0.02,
        delay: 0.0,
        is_servo: true,
    };
    assert_eq!(*servo, expected);
    assert_eq!(motor.input, "ctrl_elbow");
    assert!(!motor.is_servo);
}
