//! Names where they stand, and other names in their places.

use appell_spec::occurrences::{Namespace, Occurrence, occurrences};
use appell_spec::outline::Outline;
use appell_spec::rename::{RenameError, rename};
use appell_spec::{load, parse};
use appell_test_kit::shipped;

fn found(text: &str) -> Vec<Occurrence> {
    occurrences(text, &parse::parse(text).0, &Outline::new(text))
}

/// The text with another name.
fn renamed(text: &str, namespace: Namespace, old: &str, new: &str) -> Result<String, RenameError> {
    let mut whole = text.to_owned();
    for (place, word) in rename(text, namespace, old, new)?.into_iter().rev() {
        whole.replace_range(place, &word);
    }
    Ok(whole)
}

#[test]
fn every_name_of_every_shipped_spec_has_a_definition_and_stands_where_it_says() {
    for (file, text) in shipped() {
        let all = found(&text);
        for place in &all {
            assert_eq!(text.get(place.span.clone()), Some(place.name.as_str()));
            let is_same = |other: &&Occurrence| {
                other.namespace == place.namespace && other.name == place.name
            };
            let is_defined = all.iter().filter(is_same).any(|other| other.defines);
            let is_supplied = matches!(place.name.as_str(), "ground" | "O");
            assert!(is_defined || is_supplied, "{file}: {place:?}");
        }
    }
}

#[test]
fn every_item_of_every_shipped_spec_can_be_renamed_there_and_back() {
    const NEW: &str = "never_seen_before";
    for (file, text) in shipped() {
        let mut seen = Vec::new();
        for place in found(&text) {
            let key = (place.namespace, place.name);
            if !place.defines || seen.contains(&key) {
                continue;
            }
            let (namespace, old) = &key;
            let there = renamed(&text, *namespace, old, NEW).expect("another name");
            let checked = load(&file, &there).expect("a valid spec");
            assert!(checked.warnings.is_empty(), "{file}: {old}");
            let back = renamed(&there, *namespace, NEW, old).expect("the old name");
            assert_eq!(back, text, "{file}: {old}");
            seen.push(key);
        }
        assert!(seen.len() > 5, "{file}");
    }
}

const FREE: &str = r#"
[mechanism]
name = 'free'
title = 'a mass with a name in many headers'
[parameters]
'm'.value = 1
m.unit = 'kg'
[coordinates.x]
unit = 'm'
[points.P]
from = 'O'
in = "ground"
at = ['''x''', 0, "\u0078"]
[bodies.P]
centre = "P"
mass = "m"
[pseudo_velocities]
v = 'dot(x)'
"#;

#[test]
fn a_name_that_stands_in_several_keys_is_renamed_in_all_of_them() {
    let text = renamed(FREE, Namespace::Quantity, "m", "mass").expect("another name");
    assert!(text.contains("'mass'.value = 1\nmass.unit"), "{text}");
    assert!(load("free.toml", &text).is_ok(), "{text}");
}

#[test]
fn namespaces_are_apart() {
    let text = renamed(FREE, Namespace::Point, "P", "Q").expect("another name");
    assert!(text.contains("[bodies.P]\ncentre = \"Q\""), "{text}");
}

#[test]
fn refusals_name_their_reason() {
    let refused = |old, new| rename(FREE, Namespace::Quantity, old, new).expect_err("a refusal");
    assert_eq!(refused("x", "y"), RenameError::Escaped("x".to_owned()));
    assert_eq!(refused("m", "v"), RenameError::Taken("v".to_owned()));
    assert_eq!(refused("m", "pi"), RenameError::Reserved("pi".to_owned()));
    assert_eq!(refused("m", "m-1"), RenameError::Invalid("m-1".to_owned()));
    assert_eq!(refused("t", "time"), RenameError::Supplied("t".to_owned()));
    let broken = FREE.replace("'dot(x)'", "'dot(x'");
    let told = rename(&broken, Namespace::Quantity, "m", "mass");
    assert!(matches!(told, Err(RenameError::Broken(_))), "{told:?}");
    let signal = FREE.replace(
        "[points.P]",
        "[signals]\ns = { t = [0, 1], value = [0, 1], unit = '1' }\n[points.P]",
    );
    let told = rename(&signal, Namespace::Quantity, "m", "s_dot");
    assert!(matches!(told, Err(RenameError::Refused(_))), "{told:?}");
}

const JOINTS: &str = r"
[mechanism]
name = 'arm'
title = 'two joints'
[parameters]
m = { value = 1, unit = 'kg' }
[joints]
slide = { kind = 'prismatic', axis = 'x', speed = 'v' }
arm = { kind = 'revolute', parent = 'slide', axis = 'y' }
[bodies]
b = { frame = 'arm', centre = 'arm', mass = 'm', inertia = { in = 'arm', diagonal = ['m*1 [m^2]', 0, 0] } }
[loads]
s = { kind = 'damper', coordinate = 'q_arm', damping = '1 [N*m*s]*cos(q_arm)*v/(1 [m/s])' }
";

#[test]
fn a_joint_is_renamed_with_all_that_is_named_after_it() {
    assert!(load("arm.toml", JOINTS).is_ok());
    for namespace in [Namespace::Frame, Namespace::Point] {
        let text = renamed(JOINTS, namespace, "arm", "boom").expect("another name");
        let expected = JOINTS
            .replace("arm =", "boom =")
            .replace("'arm', c", "'boom', c")
            .replace("centre = 'arm'", "centre = 'boom'")
            .replace("in = 'arm'", "in = 'boom'")
            .replace("q_arm", "q_boom");
        assert_eq!(text, expected);
        assert!(load("arm.toml", &text).is_ok());
    }
    let text = renamed(JOINTS, Namespace::Quantity, "v", "v_x").expect("another name");
    assert!(
        text.contains("speed = 'v_x'") && text.contains("*v_x/"),
        "{text}"
    );
    let told = rename(JOINTS, Namespace::Quantity, "q_arm", "theta").expect_err("a refusal");
    let expected = "`q_arm` is named after the joint `arm`; rename the joint, or name it with a key of the joint";
    assert_eq!(told.to_string(), expected);
}
