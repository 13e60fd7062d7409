//! Texts that would take long or much: the page goes on, and the next save is shown.

use std::fmt::Write as _;
use std::time::{Duration, Instant};

use serde_json::json;

use crate::client::{Served, shipped};

/// Longer than anything that is bounded takes in an unoptimised build.
const LONG: Duration = Duration::from_mins(1);

/// Saves a text, asks meanwhile, and then saves a good one.
fn survives(text: &str) {
    let served = Served::new(&shipped("pendulum"));
    served.state(|state| !state["model"].is_null());
    let start = Instant::now();
    served.save(text);
    let motion = served.motion(&json!({ "window": 1, "end": 1 }));
    assert_eq!(motion.status, 200, "{}", motion.body);
    served.state(|state| state["findings"]["broken"] == true);
    let good = shipped("pendulum").replace("value = 1,", "value = 1.5,");
    served.save(&good);
    served.state(|state| state["text"]["text"] == good && state["findings"]["broken"] == false);
    assert!(start.elapsed() < LONG, "{:?}", start.elapsed());
}

#[test]
fn a_huge_text_is_refused() {
    survives(&"a".repeat(3 << 20));
}

#[test]
fn many_lines_and_names_are_survived() {
    let mut text = "[mechanism]\nname = 'x'\n[parameters]\n".to_owned();
    for k in 0..9000 {
        let _ = writeln!(text, "p{k} = {{ value = 1, unit = 'kq' }}");
    }
    survives(&text);
}

#[test]
fn deep_nesting_is_refused() {
    let deep = format!(
        "[parameters]\na = {}{}",
        "[".repeat(50_000),
        "]".repeat(50_000)
    );
    survives(&deep);
    let brackets = format!("{}1{}", "(".repeat(20_000), ")".repeat(20_000));
    let expression = shipped("pendulum").replace("dot(theta)", &format!("dot(theta)*{brackets}"));
    survives(&expression);
}

/// The range of the angle is left out, so that it spins ever faster.
#[test]
fn a_motion_that_never_ends_is_bounded() {
    let served = Served::new(&shipped("double_pendulum"));
    served.state(|state| !state["model"].is_null());
    let start = Instant::now();
    let wild = json!({ "window": 1, "end": 600, "initial": { "omega1": "1e6", "omega2": "-1e6" } });
    let answer = served.motion(&wild);
    assert!([200, 422].contains(&answer.status), "{}", answer.body);
    assert!(start.elapsed() < LONG / 4, "{:?}", start.elapsed());
}
