//! Motions with the values of the sliders.

use serde_json::{Value, json};

use crate::client::{Served, shipped};

/// A pendulum that starts aside.
fn request(parameters: &Value) -> Value {
    json!({ "window": 7, "end": 2, "parameters": parameters, "initial": { "theta": "30deg" } })
}

fn served(name: &str) -> Served {
    let served = Served::new(&shipped(name));
    served.state(|state| !state["model"].is_null());
    served
}

#[test]
fn a_changed_parameter_changes_the_motion() {
    let served = served("pendulum");
    let before = served.motion(&request(&json!({}))).json();
    let same = served.motion(&request(&json!({}))).json();
    let after = served.motion(&request(&json!({ "l": "2m" }))).json();
    assert!(before["film"]["values"].as_str().expect("values").len() > 1000);
    assert_eq!(before["film"], same["film"]);
    assert_ne!(before["film"]["values"], after["film"]["values"]);
    assert_eq!(before["film"]["columns"], after["film"]["columns"]);
    assert!(before["figure"].as_str().expect("SVG").starts_with("<svg"));
}

#[test]
fn what_cannot_be_computed_is_told() {
    let served = served("cart_pole");
    for (request, told) in [
        (json!({ "window": 1, "end": 0 }), "0 s"),
        (json!({ "window": 1, "end": 1e9 }), "600"),
        (
            json!({ "window": 1, "end": 1, "parameters": { "nope": "1" } }),
            "nope",
        ),
        (
            json!({ "window": 1, "end": 1, "initial": { "theta": "1kg" } }),
            "theta",
        ),
    ] {
        let answer = served.motion(&request);
        assert_eq!(answer.status, 422, "{request}");
        assert!(answer.body.contains(told), "{}", answer.body);
    }
    let unknown = json!({ "window": 1, "end": 1, "file": "/etc/passwd" });
    assert_eq!(served.motion(&unknown).status, 400);
}

#[test]
fn inputs_are_expressions() {
    let served = served("cart_pole");
    let state = served.get("state").json();
    let input = state["model"]["knobs"]["inputs"][0]["name"].as_str();
    let input = input.expect("an input").to_owned();
    let with = |text: &str| json!({ "window": 1, "end": 1, "inputs": { (&input): text } });
    let rest = served.motion(&json!({ "window": 1, "end": 1 })).json();
    let driven = served.motion(&with("2*sin(3*t)")).json();
    assert_ne!(rest["film"]["values"], driven["film"]["values"]);
    assert_eq!(served.motion(&with("2*sin(")).status, 422);
}

#[test]
fn the_newest_request_of_a_window_wins() {
    let served = served("double_pendulum");
    let long = json!({ "window": 3, "end": 600, "initial": { "theta1": "3" } });
    let short = json!({ "window": 3, "end": 1 });
    std::thread::scope(|scope| {
        let slow = scope.spawn(|| served.motion(&long).status);
        std::thread::sleep(std::time::Duration::from_millis(100));
        assert_eq!(served.motion(&short).status, 200);
        // It has been replaced, unless it was done by then.
        assert!([409, 200].contains(&slow.join().expect("an answer")));
    });
}
