//! Changes of MJCF files: the bytes that they touch, and the numbers that they make.

use appell_robots::{Amount, Change, Corrected, Failure, JointNumber, corrected};

fn none(_: &str) -> Result<Vec<u8>, String> {
    Err("only this text is read".to_owned())
}

fn change(text: &str, changes: &[Change]) -> Result<Corrected, String> {
    corrected("robot.xml", text, changes, &[], &none).map_err(|failure| match failure {
        Failure::File(report) => report.plain(),
        Failure::Unknown { name, .. } | Failure::Lock(name) => name,
    })
}

fn joint(joint: &str, attribute: JointNumber, amount: Amount) -> Change {
    Change::Joint {
        joint: joint.to_owned(),
        attribute,
        amount,
    }
}

#[test]
fn without_changes_the_bytes_stay() {
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/robots");
    let mut count = 0;
    for file in std::fs::read_dir(folder).unwrap() {
        let path = file.unwrap().path();
        if path.extension().is_some_and(|end| end == "xml") {
            let text = std::fs::read_to_string(&path).unwrap();
            let same = change(&text, &[]).unwrap();
            assert_eq!((same.text, same.edits), (text, Vec::new()), "{path:?}");
            count += 1;
        }
    }
    assert!(count > 5);
}

#[test]
fn an_attribute_of_a_class_is_written_at_the_joint() {
    let text = r#"<mujoco><compiler angle="radian"/>
  <default><joint damping="0.5" axis="0 1 0"/></default>
  <worldbody><body name="arm"><inertial pos="0.1 0 0" mass="1" diaginertia="0.1 0.1 0.1"/>
    <joint  name='shoulder'   range='-1 1' /><!-- stays -->
  </body></worldbody></mujoco>
"#;
    let better = change(
        text,
        &[
            joint("shoulder", JointNumber::Damping, Amount::Times(2.0)),
            joint("shoulder", JointNumber::Damping, Amount::Add(0.1)),
            joint("shoulder", JointNumber::Frictionloss, Amount::To(0.2)),
        ],
    );
    let expected = text.replace(
        "range='-1 1' /",
        "range='-1 1' damping=\"1.1\" frictionloss=\"0.2\" /",
    );
    assert_eq!(better.unwrap().text, expected);
}
