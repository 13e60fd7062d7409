//! Changes of URDF files: the bytes that they touch.

use appell_robots::{Amount, Change, Failure, Number, Options, corrected, import};

const ARM: &str = r#"<?xml version="1.0"?>
<robot name="arm">
  <link name="base"/>
  <link name="upper">
    <inertial>
      <origin xyz="0.1 0 0" rpy="0 0 0.3"/>
      <mass value="2.0"/>   <!-- weighed -->
      <inertia ixx="0.01" ixy="0" ixz="0" iyy="0.02" iyz="0" izz="0.02"/>
    </inertial>
  </link>
  <joint name="shoulder" type="continuous">
    <parent link="base"/> <child link="upper"/>
    <axis xyz="0 1 0"/>
    <dynamics damping="0.5"/>
  </joint>
  <link name="hand"/>
  <joint name="wrist" type="revolute">
    <parent link="upper"/> <child link="hand"/>
    <origin xyz="0.4 0 0"/>
    <axis xyz="0 1 0"/>
    <limit lower="-1" upper="1" effort="5" velocity="3"/>
  </joint>
  <link name="tool">
    <inertial><mass value="0.2"/><inertia ixx="1e-4" ixy="0" ixz="0" iyy="1e-4" iyz="0" izz="1e-4"/></inertial>
  </link>
  <joint name="flange" type="fixed"><parent link="hand"/><child link="tool"/><origin xyz="0.1 0 0"/></joint>
</robot>
"#;

fn change(changes: &[Change]) -> Result<String, String> {
    let none = |_: &str| Err("only this text is read".to_owned());
    let corrected = corrected("arm.urdf", ARM, changes, &[], &none);
    corrected.map(|one| one.text).map_err(|why| match why {
        Failure::File(report) => report.plain(),
        Failure::Unknown { name, .. } | Failure::Lock(name) => name,
    })
}

fn replaces(changes: &[Change], parts: &[(&str, &str)]) {
    let mut expected = ARM.to_owned();
    for (before, after) in parts {
        assert_eq!(expected.matches(before).count(), 1, "{before}");
        expected = expected.replace(before, after);
    }
    assert_eq!(change(changes).unwrap(), expected, "{changes:?}");
}

fn joint(name: &str, attribute: Number, amount: Amount) -> Change {
    Change::number(name, attribute, amount)
}

fn mass(body: &str, amount: Amount) -> Change {
    Change::number(body, Number::Mass, amount)
}

#[test]
fn numbers_are_replaced_where_they_stand() {
    replaces(&[], &[]);
    replaces(&[mass("upper", Amount::Times(1.0))], &[]);
    let changes = [
        mass("upper", Amount::To(2.1)),
        Change::Centre {
            body: "upper".to_owned(),
            amounts: [Amount::Add(0.01), Amount::Add(0.0), Amount::Add(0.0)],
        },
        Change::number("upper", Number::Inertia, Amount::Times(1.5)),
        joint("shoulder", Number::Damping, Amount::Add(0.1)),
        joint("shoulder", Number::Frictionloss, Amount::Add(0.2)),
    ];
    replaces(
        &changes,
        &[
            (
                "xyz=\"0.1 0 0\" rpy=\"0 0 0.3\"",
                "xyz=\"0.11 0 0\" rpy=\"0 0 0.3\"",
            ),
            ("value=\"2.0\"", "value=\"2.1\""),
            ("ixx=\"0.01\"", "ixx=\"0.015\""),
            ("iyy=\"0.02\"", "iyy=\"0.03\""),
            ("izz=\"0.02\"", "izz=\"0.03\""),
            ("damping=\"0.5\"", "damping=\"0.6\" friction=\"0.2\""),
        ],
    );
}

#[test]
fn what_is_missing_is_inserted() {
    let limit = "<limit lower=\"-1\" upper=\"1\" effort=\"5\" velocity=\"3\"/>";
    let dynamics = format!("{limit}\n    <dynamics damping=\"0.3\" friction=\"0.1\"/>");
    let changes = [
        joint("wrist", Number::Frictionloss, Amount::Add(0.1)),
        joint("wrist", Number::Damping, Amount::To(0.3)),
    ];
    replaces(&changes, &[(limit, &dynamics)]);
    let payload = Change::Payload {
        body: "tool".to_owned(),
        mass: 0.5,
        at: [0.0, 0.01, 0.05],
    };
    let text = change(&[payload]).unwrap();
    let link = "\n  <link name=\"payload\"><inertial><origin xyz=\"0 0 0\" rpy=\"0 0 0\"/><mass value=\"0.5\"/>";
    assert!(text.contains(link), "{text}");
    let fixed = "\n  <joint name=\"payload_joint\" type=\"fixed\"><parent link=\"tool\"/><child link=\"payload\"/>\
                 <origin xyz=\"0 0.01 0.05\" rpy=\"0 0 0\"/></joint>\n";
    assert!(text.contains(fixed), "{text}");
    let after = import("arm.urdf", &text, &Options::default()).unwrap();
    assert!(after.spec.contains("mass = \"0.7 [kg]\""), "{}", after.spec);
}

#[test]
fn links_that_are_fixed_together_have_one_inertia() {
    let text = change(&[mass("hand", Amount::Times(2.0))]).unwrap();
    let hand = "<link name=\"hand\">\n    <inertial><origin xyz=\"0.1 0 0\" rpy=\"0 0 0\"/><mass value=\"0.2\"/>";
    assert!(text.contains(hand), "{text}");
    let after = import("arm.urdf", &text, &Options::default()).unwrap();
    assert!(after.spec.contains("mass = \"0.4 [kg]\""), "{}", after.spec);
}

#[test]
fn what_a_urdf_cannot_express_is_refused() {
    let armature = joint("wrist", Number::Armature, Amount::Add(0.1));
    let refusal = change(&[armature]).unwrap_err();
    assert!(
        refusal.contains("URDF cannot express this change"),
        "{refusal}"
    );
}
